//! Arithmetic as a graph: every value once, constants folded, zeros removed.

use std::collections::HashMap;

/// A value of the graph.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Node(u32);

/// Input quantity of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Input {
    /// Joint position q.
    Q(usize),
    /// Joint velocity dq.
    Dq(usize),
    /// Sine of the position, plus a constant angle where there is one.
    Sine(usize),
    /// Cosine of it.
    Cosine(usize),
}

/// Operation that computes a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Operation {
    /// Bits of a number.
    Constant(u64),
    /// Input of the pass.
    Input(Input),
    /// `a + b`
    Sum(Node, Node),
    /// `a − b`
    Difference(Node, Node),
    /// Product `a b`
    Product(Node, Node),
    /// Negative value `−a`
    Negative(Node),
}

/// Operations in the order of evaluation: each follows its operands.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    operations: Vec<Operation>,
    node_by_operation: HashMap<Operation, Node>,
}

impl Graph {
    fn add(&mut self, operation: Operation) -> Node {
        *self.node_by_operation.entry(operation).or_insert_with(|| {
            self.operations.push(operation);
            Node(self.operations.len() as u32 - 1)
        })
    }

    /// Operation that computes a value.
    pub(crate) fn operation(&self, node: Node) -> Operation {
        self.operations[node.0 as usize]
    }

    /// The number a value is, if it is one.
    pub(crate) fn value(&self, node: Node) -> Option<f64> {
        match self.operation(node) {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    pub(crate) fn constant(&mut self, value: f64) -> Node {
        // One zero.
        let value = if value == 0.0 { 0.0 } else { value };
        self.add(Operation::Constant(value.to_bits()))
    }

    pub(crate) fn input(&mut self, input: Input) -> Node {
        self.add(Operation::Input(input))
    }

    pub(crate) fn sum(&mut self, a: Node, b: Node) -> Node {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x + y),
            (Some(0.0), _) => return b,
            (_, Some(0.0)) => return a,
            _ => {}
        }
        match (self.operation(a), self.operation(b)) {
            (_, Operation::Negative(b)) => self.difference(a, b),
            (Operation::Negative(a), _) => self.difference(b, a),
            _ => self.add(Operation::Sum(a.min(b), a.max(b))),
        }
    }

    pub(crate) fn difference(&mut self, a: Node, b: Node) -> Node {
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x - y),
            (Some(0.0), _) => return self.negative(b),
            (_, Some(0.0)) => return a,
            _ if a == b => return self.constant(0.0),
            _ => {}
        }
        match (self.operation(a), self.operation(b)) {
            (_, Operation::Negative(b)) => self.sum(a, b),
            (Operation::Negative(a), _) => {
                let sum = self.sum(a, b);
                self.negative(sum)
            }
            _ => self.add(Operation::Difference(a, b)),
        }
    }

    pub(crate) fn product(&mut self, a: Node, b: Node) -> Node {
        // A constant is the first operand.
        let (a, b) = match self.value(b) {
            Some(_) => (b, a),
            None => (a, b),
        };
        match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => return self.constant(x * y),
            (Some(0.0), _) => return a,
            (Some(1.0), _) => return b,
            (Some(-1.0), _) => return self.negative(b),
            _ => {}
        }
        match (self.operation(a), self.operation(b)) {
            // Signs go outwards, where sums take them in.
            (_, Operation::Negative(b)) => {
                let product = self.product(a, b);
                self.negative(product)
            }
            (Operation::Negative(a), _) => {
                let product = self.product(a, b);
                self.negative(product)
            }
            (Operation::Constant(x), Operation::Product(c, d)) if self.value(c).is_some() => {
                let factor = f64::from_bits(x) * self.value(c).unwrap_or(1.0);
                let factor = self.constant(factor);
                self.product(factor, d)
            }
            (Operation::Constant(_), _) => self.add(Operation::Product(a, b)),
            _ => self.add(Operation::Product(a.min(b), a.max(b))),
        }
    }

    pub(crate) fn negative(&mut self, a: Node) -> Node {
        match self.operation(a) {
            Operation::Constant(bits) => self.constant(-f64::from_bits(bits)),
            Operation::Negative(a) => a,
            Operation::Difference(b, c) => self.difference(c, b),
            Operation::Product(b, c) if self.value(b).is_some() => {
                let factor = -self.value(b).unwrap_or(0.0);
                let factor = self.constant(factor);
                self.product(factor, c)
            }
            _ => self.add(Operation::Negative(a)),
        }
    }

    /// Returns the direct operands of a value.
    pub(crate) fn parts(&self, node: Node) -> impl Iterator<Item = Node> + use<> {
        let (a, b) = match self.operation(node) {
            Operation::Constant(_) | Operation::Input(_) => (None, None),
            Operation::Negative(a) => (Some(a), None),
            Operation::Sum(a, b) | Operation::Difference(a, b) | Operation::Product(a, b) => {
                (Some(a), Some(b))
            }
        };
        [a, b].into_iter().flatten()
    }

    /// Returns the operands of other values, each after its own operands, and the number of uses of
    /// each.
    pub(crate) fn needed(&self, wanted: &[Node]) -> (Vec<Node>, HashMap<Node, usize>) {
        let mut uses: HashMap<Node, usize> = HashMap::new();
        let mut open: Vec<Node> = wanted.to_vec();
        for node in wanted {
            *uses.entry(*node).or_default() += 1;
        }
        let mut seen = std::collections::HashSet::new();
        while let Some(node) = open.pop() {
            if seen.insert(node) {
                for part in self.parts(node) {
                    *uses.entry(part).or_default() += 1;
                    open.push(part);
                }
            }
        }
        let mut order: Vec<Node> = seen.into_iter().collect();
        order.sort_unstable();
        (order, uses)
    }

    /// Values at some inputs, in the order of the requested results.
    #[cfg(test)]
    pub(crate) fn evaluate(&self, wanted: &[Node], input: impl Fn(Input) -> f64) -> Vec<f64> {
        let (order, _) = self.needed(wanted);
        let mut values: HashMap<Node, f64> = HashMap::new();
        for node in order {
            let at = |n: Node| values[&n];
            let value = match self.operation(node) {
                Operation::Constant(bits) => f64::from_bits(bits),
                Operation::Input(which) => input(which),
                Operation::Sum(a, b) => at(a) + at(b),
                Operation::Difference(a, b) => at(a) - at(b),
                Operation::Product(a, b) => at(a) * at(b),
                Operation::Negative(a) => -at(a),
            };
            values.insert(node, value);
        }
        wanted.iter().map(|n| values[n]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_ones_and_signs_are_gone() {
        let mut g = Graph::default();
        let (x, y) = (g.input(Input::Q(0)), g.input(Input::Q(1)));
        let (zero, one, minus) = (g.constant(0.0), g.constant(1.0), g.constant(-1.0));
        assert_eq!(g.product(zero, x), zero);
        assert_eq!(g.product(x, one), x);
        assert_eq!(g.sum(x, zero), x);
        let negative = g.product(minus, x);
        assert_eq!(g.operation(negative), Operation::Negative(x));
        // x + (−1)y is x − y, and its negative y − x.
        let minus_y = g.negative(y);
        let d = g.sum(x, minus_y);
        assert_eq!(g.operation(d), Operation::Difference(x, y));
        let other = g.negative(d);
        assert_eq!(g.operation(other), Operation::Difference(y, x));
        // (−x)(−y) = xy, which is one value in any order.
        let p = g.product(negative, minus_y);
        assert_eq!(p, g.product(y, x));
        // 2(3x) = 6x.
        let (two, three) = (g.constant(2.0), g.constant(3.0));
        let inner = g.product(x, three);
        let six = g.product(two, inner);
        let (factor, of) = match g.operation(six) {
            Operation::Product(a, b) => (g.value(a), b),
            other => panic!("{other:?}"),
        };
        assert_eq!((factor, of), (Some(6.0), x));
        assert_eq!(g.difference(six, six), zero);
    }

    #[test]
    fn graph_keeps_only_used_operations() {
        let mut g = Graph::default();
        let (x, y) = (g.input(Input::Q(0)), g.input(Input::Q(1)));
        let _unused = g.product(x, y);
        let s = g.sum(x, y);
        let t = g.product(s, s);
        let (order, uses) = g.needed(&[t]);
        assert_eq!(order, [x, y, s, t]);
        assert_eq!(uses[&s], 2);
        assert_eq!(
            g.evaluate(&[t, s], |i| if i == Input::Q(0) { 2.0 } else { 3.0 }),
            [25.0, 5.0]
        );
    }
}
