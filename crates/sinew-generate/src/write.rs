//! A graph as lines of code.

use crate::graph::{Graph, Input, Node, Operation};
use crate::pass::Pass;
use crate::{Language, Operations};
use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;

/// Formats a number so that both languages read it back bitwise identical.
pub(crate) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Counts the arithmetic of a pass.
pub(crate) fn operations(pass: &Pass) -> Operations {
    let (order, _) = pass.graph.needed(&pass.wanted());
    let mut out = Operations {
        sums: 0,
        products: 0,
        turns: turned(&pass.graph, &order).len(),
    };
    for node in order {
        match pass.graph.operation(node) {
            Operation::Sum(..) | Operation::Difference(..) => out.sums += 1,
            Operation::Product(..) => out.products += 1,
            _ => {}
        }
    }
    out
}

/// Joints whose sine or cosine is needed, in order.
fn turned(graph: &Graph, order: &[Node]) -> Vec<usize> {
    let mut joints: Vec<usize> = (order.iter())
        .filter_map(|node| match graph.operation(*node) {
            Operation::Input(Input::Sine(i) | Input::Cosine(i)) => Some(i),
            _ => None,
        })
        .collect();
    joints.sort_unstable();
    joints.dedup();
    joints
}

/// The momentum pass as code.
pub(crate) struct Body {
    /// Lines, indented by four.
    pub(crate) lines: String,
    /// Whether they call `turn`.
    pub(crate) turns: bool,
    /// Names of the results, per joint.
    pub(crate) p: Vec<String>,
    pub(crate) ct_dq: Vec<String>,
    pub(crate) g: Vec<String>,
}

/// Generates the statements of the pass from the inputs `q` and `dq`.
pub(crate) fn momentum(pass: &Pass, language: Language) -> Body {
    /// Maximum line length up to which a value that is used once is written inline, characters.
    const READABLE: usize = 90;
    let wanted = pass.wanted();
    let (order, uses) = pass.graph.needed(&wanted);
    let mut lines = String::new();
    let turned = turned(&pass.graph, &order);
    for &joint in &turned {
        lines += &turn(joint, pass.angles[joint], language);
    }
    let results: HashSet<Node> = wanted.iter().copied().collect();
    let mut texts: HashMap<Node, String> = HashMap::new();
    let mut names = 0;
    for node in order {
        let operation = pass.graph.operation(node);
        let expression = expression(operation, &texts);
        let text = match operation {
            Operation::Constant(_) | Operation::Input(_) => expression,
            _ if uses.get(&node) == Some(&1)
                && !results.contains(&node)
                && expression.len() < READABLE =>
            {
                format!("({expression})")
            }
            _ => {
                let name = format!("t{names}");
                names += 1;
                let keyword = match language {
                    Language::C => "const double",
                    Language::Rust => "let",
                };
                let _ = writeln!(lines, "    {keyword} {name} = {expression};");
                name
            }
        };
        texts.insert(node, text);
    }
    let named = |nodes: &[Node]| {
        let text = |node: &Node| texts.get(node).cloned().unwrap_or_default();
        nodes.iter().map(text).collect()
    };
    Body {
        p: named(&pass.p),
        ct_dq: named(&pass.ct_dq),
        g: named(&pass.g),
        lines,
        turns: !turned.is_empty(),
    }
}

/// The line that takes a joint's sine and cosine, of its position plus a constant angle.
fn turn(joint: usize, angle: f64, language: Language) -> String {
    let of = match angle {
        0.0 => format!("q[{joint}]"),
        angle => format!("q[{joint}] + {}", number(angle)),
    };
    match language {
        Language::C => {
            format!("    double s{joint}, c{joint};\n    turn({of}, &s{joint}, &c{joint});\n")
        }
        Language::Rust => format!("    let (s{joint}, c{joint}) = turn({of});\n"),
    }
}

/// A value from the texts of its parts.
fn expression(operation: Operation, texts: &HashMap<Node, String>) -> String {
    let of = |node: Node| texts.get(&node).map_or("", String::as_str);
    match operation {
        Operation::Constant(bits) => {
            let value = f64::from_bits(bits);
            match value < 0.0 {
                true => format!("({})", number(value)),
                false => number(value),
            }
        }
        Operation::Input(Input::Q(i)) => format!("q[{i}]"),
        Operation::Input(Input::Dq(i)) => format!("dq[{i}]"),
        Operation::Input(Input::Sine(i)) => format!("s{i}"),
        Operation::Input(Input::Cosine(i)) => format!("c{i}"),
        Operation::Sum(a, b) => format!("{} + {}", of(a), of(b)),
        Operation::Difference(a, b) => format!("{} - {}", of(a), of(b)),
        Operation::Product(a, b) => format!("{} * {}", of(a), of(b)),
        Operation::Negative(a) => format!("-{}", of(a)),
    }
}
