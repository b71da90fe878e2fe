//! One odd value of a robot's description.

use serde::Serialize;
use sinew_files::{Fault, Located, Place};

/// What looks odd.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// Something an estimate needs is not there.
    Gap,
    /// A joint of robot.toml that the URDF lacks.
    UnknownJoint,
    /// Two values exclude each other.
    Contradiction,
    /// A value outside what such a key usually holds.
    Range,
    /// A joint's place or a centre of mass, by its distance.
    Distance,
    /// The mass that moves, for the arm's reach (judged: mass over the reach cubed).
    ArmMass,
    /// A link that is much heavier than all the others together (judged: the ratio).
    HeavyLink,
    /// A long link that weighs next to nothing (judged: its share of the moving mass).
    LightLink,
    /// A link denser than a material (judged: density of a ball of its mass and inertia).
    Density,
    /// An inertia too large for the link's size (judged: radius of gyration).
    InertiaSize,
    /// An inertia no body has: not positive definite.
    InertiaNotDefinite,
    /// Principal moments that break the triangle inequality.
    InertiaTriangle,
    /// Natural frequency of the link on the joint's spring.
    Frequency,
    /// How far gravity deflects the spring.
    Sag,
    /// So stiff that theta − q never shows.
    TooStiff,
    /// Stiffer than the tendon's own rope (judged: ratio of the two).
    StifferThanRope,
    /// Motor inertia over the link's.
    MotorInertia,
    /// Coulomb friction over stiffness.
    Friction,
    /// A rope that the catalogue doesn't hold.
    UnknownRope,
    /// Pretension over the rope's breaking load.
    Pretension,
    /// Pull of the strand that holds the arm up, over the rope's breaking load.
    HoldingPull,
    /// Pull at the joint's largest torque, over the rope's breaking load.
    LargestPull,
    /// Diameter of the rope's path on a pulley over the rope's diameter.
    PulleyDiameter,
    /// A limit of elongation over the strand's length.
    ElongationLimit,
    /// A joint whose range has no width.
    RangeWidth,
    /// A joint whose upper end lies below its lower one.
    RangeReversed,
    /// Joint's largest torque over what gravity asks of it.
    EffortLimit,
    /// A torque or speed below 0.
    NegativeLimit,
    /// Joint's largest speed.
    SpeedLimit,
    /// Size of gravity.
    Gravity,
    /// Gravity that points up.
    GravityUp,
}

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Seldom right, but it may be.
    Odd,
    /// Not there, and an estimate needs it.
    Missing,
    /// No robot has it.
    Impossible,
}

/// What was compared with what is usual.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Judged {
    /// Value, in `unit`.
    pub value: f64,
    /// Unit; empty for a ratio.
    pub unit: &'static str,
    /// Least that is usual.
    pub low: Option<f64>,
    /// Most that is usual.
    pub high: Option<f64>,
}

/// Another unit in which the value would be usual.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnitSlip {
    /// The unit it looks as if it were in.
    pub unit: &'static str,
    /// The value in the unit that is meant.
    pub value: f64,
}

/// Where a value stands.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct At {
    /// File.
    pub file: String,
    /// Line, from 1.
    pub line: Option<u64>,
    /// Key of a TOML file, element of a URDF.
    pub key: String,
}

/// One odd value.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// What looks odd.
    pub kind: FindingKind,
    /// How bad it is.
    pub severity: Severity,
    /// Where it stands.
    pub at: At,
    /// The value as the file has it, in `unit`.
    pub value: Option<f64>,
    /// Unit of the file's value.
    pub unit: &'static str,
    /// What was compared, and what is usual.
    pub judged: Option<Judged>,
    /// The unit it may have been written in.
    pub slip: Option<UnitSlip>,
    /// A name that isn't there, or what a reader of the file says.
    pub text: Option<String>,
    /// Names that may have been meant, the nearest first.
    pub names: Vec<String>,
}

impl Finding {
    /// A finding without a number.
    pub(super) fn new(kind: FindingKind, severity: Severity, at: At) -> Self {
        Self {
            kind,
            severity,
            at,
            value: None,
            unit: "",
            judged: None,
            slip: None,
            text: None,
            names: Vec::new(),
        }
    }

    /// What keeps a robot from being built.
    pub(super) fn of_gap(gap: &Located) -> Self {
        let (kind, severity) = match gap.fault {
            Fault::UnknownName => (FindingKind::UnknownJoint, Severity::Impossible),
            Fault::MissingKey => (FindingKind::Gap, Severity::Missing),
            _ => (FindingKind::Contradiction, Severity::Impossible),
        };
        let at = At {
            file: gap.file.clone(),
            line: gap.line,
            key: match &gap.place {
                Place::Key(key) | Place::Column(key) | Place::Element(key) => key.clone(),
                Place::Whole => String::new(),
            },
        };
        let cure = gap.cure.iter().map(|cure| format!("; {cure}"));
        Self {
            text: Some(gap.problem.clone() + &cure.collect::<String>()),
            ..Self::new(kind, severity, at)
        }
    }
}

/// Two ends; infinite where there is none.
pub(super) type Range = (f64, f64);

/// What is usual, and what is possible at all.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub(super) usual: Range,
    pub(super) possible: Range,
}

impl Bounds {
    /// Odd outside; nothing is impossible.
    pub(super) const fn usual(low: f64, high: f64) -> Self {
        Self {
            usual: (low, high),
            possible: (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Impossible outside these.
    pub(super) const fn possible(mut self, low: f64, high: f64) -> Self {
        self.possible = (low, high);
        self
    }
}

/// A file's value and its unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Written {
    pub(super) value: f64,
    pub(super) unit: &'static str,
}

/// A quantity to compare: it goes with the power `power` of the file's value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measure {
    pub(super) value: f64,
    pub(super) unit: &'static str,
    pub(super) power: f64,
}

/// A finding where `measure` lies outside its bounds.
pub(super) fn judge(
    kind: FindingKind,
    at: impl FnOnce() -> At,
    written: Written,
    measure: Measure,
    bounds: Bounds,
) -> Option<Finding> {
    let inside = |(low, high): Range, v: f64| (low..=high).contains(&v);
    if inside(bounds.usual, measure.value) {
        return None;
    }
    let severity = match inside(bounds.possible, measure.value) {
        true => Severity::Odd,
        false => Severity::Impossible,
    };
    // A little outside is no other unit.
    const FAR: f64 = 4.0;
    let (low, high) = bounds.usual;
    let is_far = measure.value < low / FAR || measure.value > high * FAR;
    let fits = |factor: f64| {
        let moved = measure.value * libm::pow(factor, measure.power);
        is_far && inside(bounds.usual, moved)
    };
    let end = |v: f64| Some(v).filter(|v| v.is_finite());
    Some(Finding {
        value: Some(written.value),
        unit: written.unit,
        judged: Some(Judged {
            value: measure.value,
            unit: measure.unit,
            low: end(bounds.usual.0),
            high: end(bounds.usual.1),
        }),
        slip: slip(written, |value| fits(value / written.value)),
        ..Finding::new(kind, severity, at())
    })
}

/// The first unit a value may have been written in so that the value it stands for fits.
pub(super) fn slip(written: Written, fits: impl Fn(f64) -> bool) -> Option<UnitSlip> {
    let (_, units) = SLIPS.iter().find(|(unit, _)| *unit == written.unit)?;
    let mut slips = units.iter().map(|&(unit, factor)| UnitSlip {
        unit,
        value: written.value * factor,
    });
    slips.find(|slip| fits(slip.value))
}

/// [`judge`] of the file's value itself.
pub(super) fn judge_value(
    kind: FindingKind,
    at: impl FnOnce() -> At,
    written: Written,
    bounds: Bounds,
) -> Option<Finding> {
    let measure = Measure {
        value: written.value,
        unit: written.unit,
        power: 1.0,
    };
    judge(kind, at, written, measure, bounds)
}

type Slips = (&'static str, &'static [(&'static str, f64)]);

/// Units that are mistaken for each other: unit meant, and unit written with its size in the first.
const SLIPS: [Slips; 14] = [
    ("mm", &[("m", 1e3), ("µm", 1e-3), ("cm", 10.0)]),
    ("m", &[("mm", 1e-3), ("cm", 1e-2), ("km", 1e3)]),
    ("kg", &[("g", 1e-3), ("t", 1e3)]),
    (
        "kg·m²",
        &[
            ("kg·cm²", 1e-4),
            ("kg·mm²", 1e-6),
            ("g·cm²", 1e-7),
            ("g·mm²", 1e-9),
            ("g·m²", 1e-3),
        ],
    ),
    (
        "N·m/rad",
        &[("N·mm/rad", 1e-3), ("kN·m/rad", 1e3), ("N·m/°", 57.295_78)],
    ),
    ("N·m", &[("N·mm", 1e-3), ("kN·m", 1e3)]),
    ("N·m/A", &[("mN·m/A", 1e-3), ("kN·m/A", 1e3)]),
    ("N", &[("mN", 1e-3), ("kN", 1e3), ("kg", 9.81)]),
    ("rad", &[("°", 0.017_453_29), ("mrad", 1e-3)]),
    ("rad/s", &[("°/s", 0.017_453_29), ("rpm", 0.104_719_8)]),
    ("m/s²", &[("mm/s²", 1e-3)]),
    ("%", &[("parts of 1", 100.0)]),
    ("mrad", &[("rad", 1e3), ("µrad", 1e-3)]),
    ("N·m·s/rad", &[("N·mm·s/rad", 1e-3), ("kN·m·s/rad", 1e3)]),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// What one of a unit is in SI, written from its definition.
    fn si(unit: &str) -> f64 {
        let degree = std::f64::consts::PI / 180.0;
        match unit {
            "parts of 1" | "m" | "kg" | "kg·m²" | "N·m/rad" | "N·m" | "N·m/A" | "N" | "rad"
            | "rad/s" | "m/s²" | "N·m·s/rad" => 1.0,
            "km" | "t" | "kN·m/rad" | "kN·m" | "kN·m/A" | "kN" | "kN·m·s/rad" => 1000.0,
            "mm" | "g" | "g·m²" | "N·mm/rad" | "N·mm" | "mN·m/A" | "mN" | "mrad" | "mm/s²"
            | "N·mm·s/rad" => 0.001,
            "cm" | "%" => 0.01,
            "µm" | "µrad" => 0.000_001,
            "kg·cm²" => 0.01 * 0.01,
            "kg·mm²" => 0.001 * 0.001,
            "g·cm²" => 0.001 * 0.01 * 0.01,
            "g·mm²" => 0.001 * 0.001 * 0.001,
            "N·m/°" => 1.0 / degree,
            "°" | "°/s" => degree,
            "rpm" => 6.0 * degree,
            other => panic!("{other}: say what it is"),
        }
    }

    #[test]
    fn units_that_are_mistaken_have_the_size_of_their_definitions() {
        for (meant, others) in SLIPS {
            for &(written, size) in others {
                // A mass written where a force is meant: its weight.
                let expected = match (meant, written) {
                    ("N", "kg") => 9.81,
                    _ => si(written) / si(meant),
                };
                assert!(
                    (size / expected - 1.0).abs() < 1e-6,
                    "{written} for {meant}: {size}"
                );
            }
        }
    }
}
