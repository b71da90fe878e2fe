//! What decides a sentence: the parameter on whose value its verdict hangs.

use serde::Serialize;
use sinew_rope::law::{Law, Parameter};

/// What a sentence hangs on.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Decider {
    /// A parameter of a rope, drawn from the catalogue's interval.
    Rope {
        /// Rope.
        rope: String,
        /// Name of the parameter in a rope entry.
        parameter: &'static str,
        /// Share of the draws in which the sentence holds: in the lowest, middle and highest third of the
        /// parameter.
        share_by_third: [f64; 3],
    },
    /// A quantity of the arm or of what acts on it.
    Arm {
        /// Which.
        quantity: ArmQuantity,
    },
    /// Nothing: plant and estimator share the equation.
    Identity,
}

/// What a sentence on the arm hangs on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ArmQuantity {
    /// Error of the described stiffness.
    StiffnessError,
    /// Error of the described masses.
    MassError,
    /// Friction of the drive.
    DriveFriction,
    /// What changes from run to run: friction, temperature, encoders.
    RunToRun,
    /// Radius of the joint's pulley.
    PulleyRadius,
    /// How well the tensioner comes back.
    Tensioner,
    /// Which way the force pushes.
    ForceDirection,
    /// The offset itself.
    Offset,
}

impl ArmQuantity {
    fn name(self) -> &'static str {
        match self {
            Self::StiffnessError => "error of the stiffness",
            Self::MassError => "error of the masses",
            Self::DriveFriction => "friction of the drive",
            Self::RunToRun => "what changes from run to run",
            Self::PulleyRadius => "radius of the pulley",
            Self::Tensioner => "how well the tensioner comes back",
            Self::ForceDirection => "direction of the force",
            Self::Offset => "the offset itself",
        }
    }
}

impl Decider {
    pub(super) fn arm(quantity: ArmQuantity) -> Self {
        Self::Arm { quantity }
    }

    /// For people, in a few words.
    pub fn name(&self) -> String {
        match self {
            Self::Rope {
                rope,
                parameter,
                share_by_third,
            } => {
                let [low, middle, high] = share_by_third.map(|s| format!("{:.0}", 100.0 * s));
                format!("{parameter} of {rope} ({low}, {middle}, {high} % from low to high)")
            }
            Self::Arm { quantity } => quantity.name().into(),
            Self::Identity => "nothing: plant and estimator share the equation".into(),
        }
    }
}

/// Parameters named at most.
const NAMED: usize = 3;
/// χ² of two degrees of freedom above which a parameter counts: 5 % for the best of 200 that do nothing, and twice that so
/// that what is named matters.
const CHI_SQUARED: f64 = 2.0 * 16.6;

/// Parameters of ropes on which a sentence hangs, the strongest first. `laws` has each rope's laws, nominal first;
/// `holds` the verdict in the same order.
pub(super) fn decide(laws: &[(&str, &[Law])], holds: impl Fn(usize) -> bool) -> Vec<Decider> {
    let count = laws
        .first()
        .map_or(0, |(_, laws)| laws.len().saturating_sub(1));
    if count == 0 {
        return Vec::new();
    }
    let held: Vec<bool> = (1..=count).map(holds).collect();
    let share = held.iter().filter(|h| **h).count() as f64 / count.max(1) as f64;
    let mut found: Vec<(f64, Decider)> = Vec::new();
    for (rope, laws) in laws {
        for parameter in Parameter::ALL {
            let values: Vec<f64> = laws[1..]
                .iter()
                .map(|law| law.parameters().get(*parameter))
                .collect();
            let Some(share_by_third) = by_third(&values, &held) else {
                continue;
            };
            let third = count as f64 / 3.0;
            let spread: f64 = share_by_third.iter().map(|s| (s - share).powi(2)).sum();
            let chi_squared = third * spread / (share * (1.0 - share));
            if chi_squared > CHI_SQUARED {
                let decider = Decider::Rope {
                    rope: (*rope).into(),
                    parameter: parameter.name(),
                    share_by_third,
                };
                found.push((chi_squared, decider));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().take(NAMED).map(|(_, d)| d).collect()
}

/// Share that holds in each third of the values; none where they don't differ.
fn by_third(values: &[f64], held: &[bool]) -> Option<[f64; 3]> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let (first, last) = (*order.first()?, *order.last()?);
    if values[first] == values[last] {
        return None;
    }
    let n = order.len();
    Some([0, 1, 2].map(|third| {
        let part = &order[third * n / 3..(third + 1) * n / 3];
        part.iter().filter(|i| held[**i]).count() as f64 / part.len().max(1) as f64
    }))
}

/// Their names, one after another; none where nothing decides.
pub(super) fn decided_by(deciders: &[Decider]) -> Option<String> {
    let names: Vec<String> = deciders.iter().map(Decider::name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::super::judge::laws;
    use super::*;
    use sinew_rope::Catalogue;

    #[test]
    fn what_a_sentence_hangs_on_is_found_and_nothing_else() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let name = "liros-dc000-0301";
        let laws = laws(&catalogue, name).expect("complete");
        let of = |i: usize| *laws[i].parameters();
        let middle = of(0).jamming;
        let found = decide(&[(name, &laws)], |i| of(i).jamming > middle);
        let [
            Decider::Rope {
                parameter,
                share_by_third,
                ..
            },
        ] = &found[..]
        else {
            panic!("{found:?}");
        };
        assert_eq!(*parameter, "jamming");
        assert!(
            share_by_third[0] == 0.0 && share_by_third[2] == 1.0,
            "{share_by_third:?}"
        );
        // A coin decides by itself.
        assert!(
            decide(&[(name, &laws)], |i| i.wrapping_mul(2_654_435_761) % 97
                < 48)
            .is_empty()
        );
        // What always holds hangs on nothing.
        assert!(decide(&[(name, &laws)], |_| true).is_empty());
    }
}
