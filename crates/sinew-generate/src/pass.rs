//! The momentum pass of one arm as a graph: [`Arm::momentum`] specialised for its structure.

use crate::frames::{Link, Turn, gravity, links};
use crate::graph::{Graph, Input, Node};
use sinew_model::arm::{Arm, JointKind};

type Vector = [Node; 3];

/// The pass of an arm.
pub(crate) struct Pass {
    pub(crate) graph: Graph,
    /// `p = M(q) dq`.
    pub(crate) p: Vec<Node>,
    /// Coriolis term `Cᵀ dq` of each joint.
    pub(crate) ct_dq: Vec<Node>,
    /// Gravity term `g` of each joint.
    pub(crate) g: Vec<Node>,
    /// Constant angle that is added to a joint's position before its sine is taken, rad.
    pub(crate) angles: Vec<f64>,
}

/// Angular velocity, velocity of the origin and gravity, in body axes.
#[derive(Clone, Copy)]
struct Motion {
    w: Vector,
    v: Vector,
    gamma: Vector,
}

/// Momentum of a subtree about a body's origin, and its first moment.
#[derive(Clone, Copy)]
struct Carried {
    force: Vector,
    moment: Vector,
    first: Vector,
}

/// A turn whose cosine and sine are values.
#[derive(Clone, Copy)]
struct Turned {
    cosine: Node,
    sine: Node,
}

impl Pass {
    pub(crate) fn of(arm: &Arm) -> Self {
        let links = links(arm);
        let mut build = Build {
            graph: Graph::default(),
            angles: vec![0.0; links.len()],
        };
        let zero = build.graph.constant(0.0);
        let gamma = gravity(arm).map(|g| build.graph.constant(g));
        let base = Motion {
            w: [zero; 3],
            v: [zero; 3],
            gamma,
        };
        // Base to tip.
        let mut motions: Vec<Motion> = Vec::with_capacity(links.len());
        let mut turns: Vec<Turned> = Vec::with_capacity(links.len());
        for (i, link) in links.iter().enumerate() {
            let parent = link.parent.map_or(base, |p| motions[p]);
            let turn = build.turn(i, link);
            motions.push(build.carried_on(i, link, turn, &parent));
            turns.push(turn);
        }
        // Tip to base.
        let mut carried: Vec<Carried> = (links.iter().zip(&motions))
            .map(|(link, motion)| build.own(link, motion))
            .collect();
        let n = links.len();
        let (mut p, mut ct_dq, mut g) = (vec![zero; n], vec![zero; n], vec![zero; n]);
        for (i, link) in links.iter().enumerate().rev() {
            (p[i], ct_dq[i], g[i]) = build.project(link, &motions[i], &carried[i]);
            if let Some(parent) = link.parent {
                let handed = build.handed(i, link, turns[i], &carried[i]);
                carried[parent] = Carried {
                    force: build.add(carried[parent].force, handed.force),
                    moment: build.add(carried[parent].moment, handed.moment),
                    first: build.add(carried[parent].first, handed.first),
                };
            }
        }
        Self {
            graph: build.graph,
            p,
            ct_dq,
            g,
            angles: build.angles,
        }
    }

    /// All results, joint by joint within each.
    pub(crate) fn wanted(&self) -> Vec<Node> {
        [&self.p[..], &self.ct_dq, &self.g].concat()
    }
}

struct Build {
    graph: Graph,
    angles: Vec<f64>,
}

impl Build {
    /// Cosine and sine of a joint's whole angle.
    fn turn(&mut self, i: usize, link: &Link) -> Turned {
        let g = &mut self.graph;
        let Turn { cosine, sine } = link.angle;
        match link.kind {
            JointKind::Prismatic => Turned {
                cosine: g.constant(cosine),
                sine: g.constant(sine),
            },
            JointKind::Revolute => {
                let (c, s) = (g.input(Input::Cosine(i)), g.input(Input::Sine(i)));
                // Both are tested: the cosine of 3e-9 is 1.
                match (cosine, sine) {
                    (1.0, 0.0) => Turned { cosine: c, sine: s },
                    (-1.0, 0.0) => Turned {
                        cosine: g.negative(c),
                        sine: g.negative(s),
                    },
                    (0.0, 1.0) => Turned {
                        cosine: g.negative(s),
                        sine: c,
                    },
                    (0.0, -1.0) => Turned {
                        cosine: s,
                        sine: g.negative(c),
                    },
                    // One addition before the sine is cheaper than four products after it.
                    _ => {
                        self.angles[i] = sine.atan2(cosine);
                        Turned { cosine: c, sine: s }
                    }
                }
            }
        }
    }

    fn constant_turn(&mut self, turn: Turn) -> Turned {
        Turned {
            cosine: self.graph.constant(turn.cosine),
            sine: self.graph.constant(turn.sine),
        }
    }

    /// Distance along the joint's axis, with the travel of a prismatic joint.
    fn offset(&mut self, i: usize, link: &Link) -> Node {
        let offset = self.graph.constant(link.offset_m);
        match link.kind {
            JointKind::Revolute => offset,
            JointKind::Prismatic => {
                let q = self.graph.input(Input::Q(i));
                self.graph.sum(q, offset)
            }
        }
    }

    /// Motion of a body from that of its parent.
    fn carried_on(&mut self, i: usize, link: &Link, turn: Turned, parent: &Motion) -> Motion {
        let zero = self.graph.constant(0.0);
        let branch = self.constant_turn(link.branch);
        let twist = self.constant_turn(link.twist);
        let normal = self.graph.constant(link.normal_m);
        let across = self.graph.constant(link.across_m);
        let branch_m = self.graph.constant(link.branch_m);
        let offset = self.offset(i, link);
        // The motion of the base is constant and needs no operations.
        let mut v = self.at(parent.v, parent.w, [zero, zero, branch_m]);
        let (mut w, mut gamma) = (parent.w, parent.gamma);
        for vector in [&mut w, &mut v, &mut gamma] {
            *vector = self.back_about_z(branch, *vector);
            *vector = self.back_about_x(twist, *vector);
        }
        v = self.at(v, w, [normal, across, offset]);
        for vector in [&mut w, &mut v, &mut gamma] {
            *vector = self.back_about_z(turn, *vector);
        }
        let dq = self.graph.input(Input::Dq(i));
        match link.kind {
            JointKind::Revolute => w[2] = self.graph.sum(w[2], dq),
            JointKind::Prismatic => v[2] = self.graph.sum(v[2], dq),
        }
        Motion { w, v, gamma }
    }

    /// Momentum of a single body: `H = [I ω + h × v; m v + ω × h]`.
    fn own(&mut self, link: &Link, motion: &Motion) -> Carried {
        let (w, v) = (motion.w, motion.v);
        let mass = self.graph.constant(link.body.mass);
        let first = link.body.first.map(|h| self.graph.constant(h));
        let inertia = link
            .body
            .inertia
            .map(|row| row.map(|i| self.graph.constant(i)));
        let turning = self.cross(w, first);
        let going = v.map(|v| self.graph.product(mass, v));
        let lever = self.cross(first, v);
        let mut moment = lever;
        for (row, out) in inertia.iter().zip(&mut moment) {
            let spin = self.dot(*row, w);
            *out = self.graph.sum(spin, *out);
        }
        Carried {
            force: self.add(turning, going),
            moment,
            first,
        }
    }

    /// Projects the motion on a joint: `(p, Cᵀdq, g)`.
    fn project(&mut self, link: &Link, motion: &Motion, carried: &Carried) -> (Node, Node, Node) {
        let Motion { w, v, gamma } = *motion;
        let Carried {
            force: f,
            moment: n,
            first: s,
        } = *carried;
        match link.kind {
            JointKind::Revolute => {
                let spin = self.across(w, n);
                let slide = self.across(v, f);
                let ct_dq = self.graph.sum(spin, slide);
                // s_y γ_x − s_x γ_y
                (n[2], ct_dq, self.across(s, gamma))
            }
            JointKind::Prismatic => {
                let ct_dq = self.across(w, f);
                let mass = self.graph.constant(-link.subtree_kg);
                (f[2], ct_dq, self.graph.product(mass, gamma[2]))
            }
        }
    }

    /// A subtree's momentum about the parent's origin, in the parent's axes.
    fn handed(&mut self, i: usize, link: &Link, turn: Turned, carried: &Carried) -> Carried {
        let zero = self.graph.constant(0.0);
        let branch = self.constant_turn(link.branch);
        let twist = self.constant_turn(link.twist);
        let normal = self.graph.constant(link.normal_m);
        let across = self.graph.constant(link.across_m);
        let branch_m = self.graph.constant(link.branch_m);
        let offset = self.offset(i, link);
        let mass = self.graph.constant(link.subtree_kg);
        let Carried {
            mut force,
            mut moment,
            mut first,
        } = *carried;
        for vector in [&mut force, &mut moment, &mut first] {
            *vector = self.about_z(turn, *vector);
        }
        (moment, first) = self.seen_from(moment, first, force, mass, [normal, across, offset]);
        for vector in [&mut force, &mut moment, &mut first] {
            *vector = self.about_x(twist, *vector);
            *vector = self.about_z(branch, *vector);
        }
        (moment, first) = self.seen_from(moment, first, force, mass, [zero, zero, branch_m]);
        Carried {
            force,
            moment,
            first,
        }
    }

    /// Moment and first moment about a point from which the origin lies at `r`.
    fn seen_from(
        &mut self,
        moment: Vector,
        first: Vector,
        force: Vector,
        mass: Node,
        r: Vector,
    ) -> (Vector, Vector) {
        let lever = self.cross(r, force);
        let moved = r.map(|r| self.graph.product(mass, r));
        (self.add(moment, lever), self.add(first, moved))
    }

    /// Velocity at `r`: `v + ω × r`.
    fn at(&mut self, v: Vector, w: Vector, r: Vector) -> Vector {
        let turning = self.cross(w, r);
        self.add(v, turning)
    }

    fn about_z(&mut self, turn: Turned, a: Vector) -> Vector {
        let (x, y) = self.turned(turn, a[0], a[1]);
        [x, y, a[2]]
    }

    fn back_about_z(&mut self, turn: Turned, a: Vector) -> Vector {
        let (x, y) = self.turned_back(turn, a[0], a[1]);
        [x, y, a[2]]
    }

    fn about_x(&mut self, turn: Turned, a: Vector) -> Vector {
        let (y, z) = self.turned(turn, a[1], a[2]);
        [a[0], y, z]
    }

    fn back_about_x(&mut self, turn: Turned, a: Vector) -> Vector {
        let (y, z) = self.turned_back(turn, a[1], a[2]);
        [a[0], y, z]
    }

    /// `(c a − s b, s a + c b)`
    fn turned(&mut self, turn: Turned, a: Node, b: Node) -> (Node, Node) {
        let g = &mut self.graph;
        let (ca, sb) = (g.product(turn.cosine, a), g.product(turn.sine, b));
        let (sa, cb) = (g.product(turn.sine, a), g.product(turn.cosine, b));
        (g.difference(ca, sb), g.sum(sa, cb))
    }

    /// `(c a + s b, c b − s a)`
    fn turned_back(&mut self, turn: Turned, a: Node, b: Node) -> (Node, Node) {
        let g = &mut self.graph;
        let (ca, sb) = (g.product(turn.cosine, a), g.product(turn.sine, b));
        let (cb, sa) = (g.product(turn.cosine, b), g.product(turn.sine, a));
        (g.sum(ca, sb), g.difference(cb, sa))
    }

    /// `a_y b_x − a_x b_y`
    fn across(&mut self, a: Vector, b: Vector) -> Node {
        let g = &mut self.graph;
        let (left, right) = (g.product(a[1], b[0]), g.product(a[0], b[1]));
        g.difference(left, right)
    }

    fn add(&mut self, a: Vector, b: Vector) -> Vector {
        [0, 1, 2].map(|i| self.graph.sum(a[i], b[i]))
    }

    fn cross(&mut self, a: Vector, b: Vector) -> Vector {
        [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
            let g = &mut self.graph;
            let (left, right) = (g.product(a[i], b[j]), g.product(a[j], b[i]));
            g.difference(left, right)
        })
    }

    fn dot(&mut self, a: Vector, b: Vector) -> Node {
        let g = &mut self.graph;
        let [x, y, z] = [0, 1, 2].map(|i| g.product(a[i], b[i]));
        let sum = g.sum(x, y);
        g.sum(sum, z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::operations;
    use sinew_model::arm::{ArmBuilder, ArmWorkspace, BodyInertia, BodySpec, Pose, urdf};
    use std::io::Write as _;
    use std::path::Path;

    /// Values of the graph and of the generic pass, the largest difference over the largest value of each.
    fn apart(arm: &Arm, q: &[f64], dq: &[f64]) -> f64 {
        let pass = Pass::of(arm);
        let values = pass.graph.evaluate(&pass.wanted(), |input| match input {
            Input::Q(i) => q[i],
            Input::Dq(i) => dq[i],
            Input::Sine(i) => (q[i] + pass.angles[i]).sin(),
            Input::Cosine(i) => (q[i] + pass.angles[i]).cos(),
        });
        let mut ws = ArmWorkspace::new(arm);
        let terms = arm.momentum(&mut ws, q, dq).unwrap();
        let n = arm.dof();
        let mut worst = 0.0f64;
        for (ours, theirs) in values.chunks(n).zip([terms.p, terms.ct_dq, terms.g]) {
            let size = theirs.iter().fold(1e-3f64, |m, v| m.max(v.abs()));
            for (a, b) in ours.iter().zip(theirs) {
                worst = worst.max((a - b).abs() / size);
            }
        }
        worst
    }

    /// Numbers between −1 and 1 that are the same on every machine.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            // xorshift64*, Vigna 2016: enough for test values.
            self.0 ^= self.0 >> 12;
            self.0 ^= self.0 << 25;
            self.0 ^= self.0 >> 27;
            (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self) -> [f64; 3] {
            [(); 3].map(|()| self.next())
        }
    }

    /// Relative rounding error of several thousand operations.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn models_give_what_the_generic_pass_gives() {
        let folder =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../sinew-model/tests/reference/models");
        if !folder.is_dir() {
            // In the package alone; past the capture of a passing test's output.
            let skipped = format!("SKIPPED: {} is not there\n", folder.display());
            std::io::stderr().write_all(skipped.as_bytes()).unwrap();
            return;
        }
        let mut files: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect();
        files.sort();
        assert!(files.len() >= 6);
        let mut numbers = Numbers(7);
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            let arm = urdf::parse(&text, &urdf::UrdfOptions::default())
                .unwrap()
                .arm;
            let count = operations(&Pass::of(&arm));
            let mut worst = 0.0f64;
            for _ in 0..20 {
                let q: Vec<f64> = (0..arm.dof()).map(|_| 3.0 * numbers.next()).collect();
                let dq: Vec<f64> = (0..arm.dof()).map(|_| 2.0 * numbers.next()).collect();
                worst = worst.max(apart(&arm, &q, &dq));
            }
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            println!("{name}: {worst:.1e} apart, {count:?}");
            assert!(worst < ROUNDING, "{name}: {worst:e}");
        }
    }

    #[test]
    fn random_trees_give_what_the_generic_pass_gives() {
        let mut numbers = Numbers(2018);
        for case in 0..200 {
            let n = 1 + case % 9;
            let mut builder = ArmBuilder::new().gravity(numbers.vector().map(|g| 9.81 * g));
            for i in 0..n {
                let axis = match case % 3 {
                    // Parallel and orthogonal axes, as most arms have them.
                    0 => [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]][i % 3],
                    _ => numbers.vector(),
                };
                let rpy = match case % 2 {
                    0 => numbers
                        .vector()
                        .map(|a| std::f64::consts::FRAC_PI_2 * (2.0 * a).round()),
                    _ => numbers.vector(),
                };
                let parent = match case % 4 {
                    0 if i > 1 => Some(i - 2),
                    1 if i > 0 => Some((numbers.next().abs() * i as f64) as usize),
                    _ => i.checked_sub(1),
                };
                let xyz = match case % 5 {
                    0 => [0.0, 0.0, 0.3],
                    _ => numbers.vector(),
                };
                let kind = match numbers.next() > 0.5 && case % 2 == 1 {
                    true => JointKind::Prismatic,
                    false => JointKind::Revolute,
                };
                let m = 1.0 + numbers.next().abs();
                let body = BodyInertia {
                    mass: m,
                    com: numbers.vector(),
                    inertia: [[0.3, 0.02, -0.01], [0.02, 0.4, 0.03], [-0.01, 0.03, 0.25]],
                };
                builder = builder.body(BodySpec {
                    name: format!("joint_{i}"),
                    kind,
                    parent,
                    placement: Pose::from_xyz_rpy(xyz, rpy),
                    axis,
                    body,
                });
            }
            let arm = builder.build().unwrap();
            let q: Vec<f64> = (0..n).map(|_| 3.0 * numbers.next()).collect();
            let dq: Vec<f64> = (0..n).map(|_| 2.0 * numbers.next()).collect();
            let apart = apart(&arm, &q, &dq);
            assert!(apart < ROUNDING, "case {case}: {apart:e}");
        }
    }
}
