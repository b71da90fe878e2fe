//! Random physical trees, and derivatives without truncation error.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use sinew_model::arm::{Arm, ArmBuilder, BodyInertia, BodySpec, JointKind, Pose};

/// Relative rounding error of an identity, as a share of the sum of the magnitudes added up.
///
/// A joint adds about 200 roundings to a value on the way out and back, twelve joints 2,400; half
/// an epsilon each when all go the same way.
pub(crate) const ROUNDING: f64 = 1200.0 * f64::EPSILON;

/// Returns a configuration with `cases` cases from a fixed seed, identical in every run and on every
/// machine.
pub(crate) fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(SEED),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Any number; change it to look elsewhere.
const SEED: u64 = 7_2018;

/// One joint and the particles that ride on it.
#[derive(Debug, Clone)]
pub(crate) struct Link {
    pub(crate) revolute: bool,
    /// Index of the earlier joint that carries this one; 0 is the base, 1 the previous joint.
    pub(crate) parent: f64,
    pub(crate) xyz: [f64; 3],
    pub(crate) rpy: [f64; 3],
    pub(crate) axis: [f64; 3],
    /// Mass and position of each particle, kg and m.
    pub(crate) particles: Vec<(f64, [f64; 3])>,
}

/// A tree and a state of it.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) links: Vec<Link>,
    pub(crate) gravity: [f64; 3],
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    /// Any other vector of one number per joint: an acceleration, a torque, an order.
    pub(crate) other: Vec<f64>,
}

fn vector(range: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-range..range)
}

fn link() -> impl Strategy<Value = Link> {
    // Square axes are most robots', oblique ones find more.
    let axis = prop_oneof![
        prop::sample::select(vec![[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]),
        vector(2.0).prop_filter("an axis has a direction", |a| norm(*a) > 0.1),
    ];
    // Four particles or more span a volume: a body with a definite inertia.
    let particles = prop::collection::vec((0.1..1.0f64, vector(0.3)), 4..7);
    (
        prop::bool::weighted(0.65),
        0.0..1.0f64,
        vector(0.4),
        vector(3.0),
        axis,
        particles,
    )
        .prop_map(|(revolute, parent, xyz, rpy, axis, particles)| Link {
            revolute,
            // Half of the joints continue the chain: deep trees as well as bushy ones.
            parent: (2.0 * parent).min(1.0),
            xyz,
            rpy,
            axis,
            particles,
        })
}

/// Trees of 2 to `most` joints in some state.
pub(crate) fn case(most: usize) -> impl Strategy<Value = Case> {
    (2..=most).prop_flat_map(|n| {
        let each = |range: f64| prop::collection::vec(-range..range, n);
        (
            prop::collection::vec(link(), n),
            vector(9.0),
            each(3.0),
            each(2.0),
            each(5.0),
        )
            .prop_map(|(links, gravity, q, dq, other)| Case {
                links,
                gravity,
                q,
                dq,
                other,
            })
    })
}

impl Link {
    pub(crate) fn kind(&self) -> JointKind {
        if self.revolute {
            JointKind::Revolute
        } else {
            JointKind::Prismatic
        }
    }

    pub(crate) fn placement(&self) -> Pose {
        Pose::from_xyz_rpy(self.xyz, self.rpy)
    }

    pub(crate) fn body(&self) -> BodyInertia {
        self.particles
            .iter()
            .fold(BodyInertia::ZERO, |sum, (m, x)| {
                sum.plus(&BodyInertia::point(*m, *x))
            })
    }
}

impl Case {
    pub(crate) fn dof(&self) -> usize {
        self.links.len()
    }

    /// Parent of link `i` as an index, `None` for the base.
    pub(crate) fn parent(&self, i: usize) -> Option<usize> {
        ((self.links[i].parent * i as f64).round() as usize).checked_sub(1)
    }

    pub(crate) fn spec(&self, i: usize) -> BodySpec {
        let link = &self.links[i];
        BodySpec {
            name: joint_name(i),
            kind: link.kind(),
            parent: self.parent(i),
            placement: link.placement(),
            axis: link.axis,
            body: link.body(),
        }
    }

    /// The builder with every body, and a link frame `link-i` on every joint frame.
    pub(crate) fn builder(&self) -> ArmBuilder {
        (0..self.dof()).fold(ArmBuilder::new().gravity(self.gravity), |builder, i| {
            builder
                .body(self.spec(i))
                .link(link_name(i), Some(i), Pose::IDENTITY)
        })
    }

    pub(crate) fn arm(&self) -> Arm {
        self.builder().build().expect("a physical tree")
    }
}

pub(crate) fn joint_name(i: usize) -> String {
    format!("joint-{i}")
}

pub(crate) fn link_name(i: usize) -> String {
    format!("link-{i}")
}

/// Derivative of `f` with respect to `q[i]`, and the magnitude of what was subtracted.
///
/// Positions, mass matrix, kinetic and potential energy are trigonometric polynomials of degree
/// two at most in a revolute coordinate, and polynomials of degree two at most in a prismatic one.
/// Pairs of values around `q` then give the derivative exactly, at any width: five values around
/// the circle (the derivative of the trigonometric interpolant), or one pair. Only rounding is left.
pub(crate) fn derivative(
    q: &[f64],
    i: usize,
    kind: JointKind,
    mut f: impl FnMut(&[f64]) -> f64,
) -> (f64, f64) {
    let steps: &[(f64, f64)] = match kind {
        // f' = Σ_k (−1)^(k+1) (f(q + θ_k) − f(q − θ_k)) / (2 sin(θ_k / 2)),  θ_k = 2πk/5
        JointKind::Revolute => {
            let angle = |k: f64| k * core::f64::consts::TAU / 5.0;
            let weight = |k: f64| 0.5 / (0.5 * angle(k)).sin();
            &[(angle(1.0), weight(1.0)), (angle(2.0), -weight(2.0))]
        }
        JointKind::Prismatic => &[(0.25, 2.0)],
    };
    let mut moved = q.to_vec();
    let (mut sum, mut size) = (0.0, 0.0);
    for (step, weight) in steps {
        moved[i] = q[i] + step;
        let plus = f(&moved);
        moved[i] = q[i] - step;
        let minus = f(&moved);
        sum += weight * (plus - minus);
        size += weight.abs() * (plus.abs() + minus.abs());
    }
    (sum, size)
}

pub(crate) fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
