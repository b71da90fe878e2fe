//! Implausible value of a robot's description.

use serde::Serialize;
use sinew_files::{Fault, Located, Place};

/// Kind of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// Value that an estimate needs is missing.
    Gap,
    /// Joint of robot.toml that is not in the URDF.
    UnknownJoint,
    /// Two conflicting values.
    Contradiction,
    /// Value outside the usual range of its key.
    Range,
    /// Distance of a joint or a centre of mass from its link's origin, m.
    Distance,
    /// Moving mass relative to the arm's reach (compared: mass over the cube of the reach).
    ArmMass,
    /// Link that is much heavier than all others together (compared: ratio of the masses).
    HeavyLink,
    /// Long link of very small mass (compared: share of the moving mass).
    LightLink,
    /// Link denser than any material (compared: density of a ball of the same mass and inertia).
    Density,
    /// Inertia too large for the size of the link (compared: radius of gyration).
    InertiaSize,
    /// Mass and inertia that are probably placeholders (compared: radius of gyration, or density of a ball).
    InertiaPlaceholder,
    /// Inertia that is not positive definite.
    InertiaNotDefinite,
    /// Principal moments that violate the triangle inequality.
    InertiaTriangle,
    /// Natural frequency of the link on the joint's spring.
    Frequency,
    /// Deflection of the spring by gravity.
    Sag,
    /// Stiffness so large that `theta − q` is not measurable.
    TooStiff,
    /// Stiffness larger than that of the tendon's rope (compared: ratio of both).
    StifferThanRope,
    /// Ratio of motor inertia to link inertia.
    MotorInertia,
    /// Ratio of Coulomb friction to stiffness.
    Friction,
    /// Rope that is not in the catalogue.
    UnknownRope,
    /// Ratio of pretension to the rope's breaking load.
    Pretension,
    /// Ratio of the strand's tension under gravity to the rope's breaking load.
    HoldingPull,
    /// Ratio of the tension at the joint's maximum torque to the rope's breaking load.
    LargestPull,
    /// Ratio of the diameter of the rope's path on a pulley to the rope's diameter.
    PulleyDiameter,
    /// Ratio of the elongation limit to the strand's length.
    ElongationLimit,
    /// Joint range of zero width.
    RangeWidth,
    /// Joint range whose upper limit is below its lower limit.
    RangeReversed,
    /// Ratio of the joint's maximum torque to its gravity torque.
    EffortLimit,
    /// Negative torque or speed limit.
    NegativeLimit,
    /// Maximum speed of the joint.
    SpeedLimit,
    /// Magnitude of gravity.
    Gravity,
    /// Gravity that points upwards.
    GravityUp,
}

/// Severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Implausible, but possible.
    Implausible,
    /// Missing, and needed by an estimate.
    Missing,
    /// Impossible for any robot.
    Impossible,
}

/// Comparison of a value with its usual range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RangeCheck {
    /// Compared value, in `unit`.
    pub value: f64,
    /// Unit; empty for a ratio.
    pub unit: &'static str,
    /// Lower limit of the usual range; none if unbounded.
    pub low: Option<f64>,
    /// Upper limit of the usual range; none if unbounded.
    pub high: Option<f64>,
}

/// Unit in which the value would be plausible.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnitHint {
    /// Probable unit of the value in the file.
    pub unit: &'static str,
    /// Value converted to the expected unit.
    pub value: f64,
}

/// Location of a value in a file.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Location {
    /// Name of the file.
    pub file: String,
    /// Line number, from 1.
    pub line: Option<u64>,
    /// Key of a TOML file, or element of a URDF.
    pub key: String,
}

/// Implausible, missing or impossible value.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// Kind of the finding.
    pub kind: FindingKind,
    /// Severity of the finding.
    pub severity: Severity,
    /// Location of the value.
    pub at: Location,
    /// Value in the file, in `unit`.
    pub value: Option<f64>,
    /// Unit of the value in the file.
    pub unit: &'static str,
    /// Compared value and its usual range.
    pub assessed: Option<RangeCheck>,
    /// Unit in which the value may have been written.
    pub slip: Option<UnitHint>,
    /// Unknown name, or message of the file's parser.
    pub text: Option<String>,
    /// Available names, most similar first.
    pub names: Vec<String>,
}

impl Finding {
    /// Creates a finding without a value.
    pub(super) fn new(kind: FindingKind, severity: Severity, at: Location) -> Self {
        Self {
            kind,
            severity,
            at,
            value: None,
            unit: "",
            assessed: None,
            slip: None,
            text: None,
            names: Vec::new(),
        }
    }

    /// Creates the finding of a gap that prevents the use of a robot.
    pub(super) fn of_gap(gap: &Located) -> Self {
        let (kind, severity) = match gap.fault {
            Fault::UnknownName => (FindingKind::UnknownJoint, Severity::Impossible),
            Fault::MissingKey => (FindingKind::Gap, Severity::Missing),
            _ => (FindingKind::Contradiction, Severity::Impossible),
        };
        let at = Location {
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

/// Lower and upper limit; infinite if unbounded.
pub(super) type Range = (f64, f64);

/// Usual and possible range of a value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub(super) usual: Range,
    pub(super) possible: Range,
}

impl Bounds {
    /// Creates bounds of plausible values; none is impossible.
    pub(super) const fn usual(low: f64, high: f64) -> Self {
        Self {
            usual: (low, high),
            possible: (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Sets the range of possible values.
    pub(super) const fn possible(mut self, low: f64, high: f64) -> Self {
        self.possible = (low, high);
        self
    }
}

/// Value in a file and its unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Written {
    pub(super) value: f64,
    pub(super) unit: &'static str,
}

/// Quantity to compare, proportional to the file's value to the power of `power`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measure {
    pub(super) value: f64,
    pub(super) unit: &'static str,
    pub(super) power: f64,
}

/// Returns a finding if `measure` is outside its bounds.
pub(super) fn check_range(
    kind: FindingKind,
    at: impl FnOnce() -> Location,
    written: Written,
    measure: Measure,
    bounds: Bounds,
) -> Option<Finding> {
    let inside = |(low, high): Range, v: f64| (low..=high).contains(&v);
    if inside(bounds.usual, measure.value) {
        return None;
    }
    let severity = match inside(bounds.possible, measure.value) {
        true => Severity::Implausible,
        false => Severity::Impossible,
    };
    // Minimum factor beyond the usual range for a unit error.
    const MIN_UNIT_ERROR: f64 = 4.0;
    let (low, high) = bounds.usual;
    let is_far = measure.value < low / MIN_UNIT_ERROR || measure.value > high * MIN_UNIT_ERROR;
    let fits = |factor: f64| {
        let moved = measure.value * libm::pow(factor, measure.power);
        is_far && inside(bounds.usual, moved)
    };
    let end = |v: f64| Some(v).filter(|v| v.is_finite());
    Some(Finding {
        value: Some(written.value),
        unit: written.unit,
        assessed: Some(RangeCheck {
            value: measure.value,
            unit: measure.unit,
            low: end(bounds.usual.0),
            high: end(bounds.usual.1),
        }),
        slip: slip(written, |value| fits(value / written.value)),
        ..Finding::new(kind, severity, at())
    })
}

/// Returns the first unit in which the converted value satisfies `fits`.
pub(super) fn slip(written: Written, fits: impl Fn(f64) -> bool) -> Option<UnitHint> {
    let (_, units) = SLIPS.iter().find(|(unit, _)| *unit == written.unit)?;
    let mut slips = units.iter().map(|&(unit, factor)| UnitHint {
        unit,
        value: written.value * factor,
    });
    slips.find(|slip| fits(slip.value))
}

/// Applies [`check_range`] to the file's value itself.
pub(super) fn check_value(
    kind: FindingKind,
    at: impl FnOnce() -> Location,
    written: Written,
    bounds: Bounds,
) -> Option<Finding> {
    let measure = Measure {
        value: written.value,
        unit: written.unit,
        power: 1.0,
    };
    check_range(kind, at, written, measure, bounds)
}

type Slips = (&'static str, &'static [(&'static str, f64)]);

/// Units that are confused with each other: expected unit, and written unit with its size in the expected one.
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

    // Size of a unit in SI, from its definition.
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
            other => panic!("{other}: unknown unit"),
        }
    }

    #[test]
    fn unit_hints_match_si_definitions() {
        for (meant, others) in SLIPS {
            for &(written, size) in others {
                // A mass in place of a force: its weight.
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
