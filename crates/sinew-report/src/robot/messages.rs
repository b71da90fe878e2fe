//! Sentences about implausible or missing values in a robot description.

use sinew_estimate::robot_check::{Finding, FindingKind, RangeCheck, Severity};
use sinew_files::number::three_digits;

/// Formats all findings, one sentence each; equal findings at several locations are merged.
pub(crate) fn diagnostics(findings: &[Finding]) -> Vec<String> {
    let is_same = |a: &Finding, b: &Finding| {
        a.value.is_none()
            && (&a.text, &a.names) == (&b.text, &b.names)
            && (a.kind, a.severity, &a.at.file) == (b.kind, b.severity, &b.at.file)
    };
    let groups = findings.chunk_by(is_same);
    groups
        .filter_map(|group| match group {
            [] => None,
            [one] => Some(sentence(one)),
            [first, ..] => {
                let location = |f: &Finding| {
                    let line = f.at.line.map_or(String::new(), |n| format!(" (line {n})"));
                    f.at.key.clone() + &line
                };
                let locations: Vec<String> = group.iter().map(location).collect();
                let (severity, file) = (severity(first.severity), &first.at.file);
                let locations = locations.join("; ");
                let (what, names) = (what(first), names(first));
                Some(format!("{severity}: {file}: {locations}: {what}{names}"))
            }
        })
        .collect()
}

fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Impossible => "impossible",
        Severity::Missing => "missing",
        Severity::Implausible => "implausible",
    }
}

/// Formats a finding: severity, location, value, reason, usual range, and probable unit.
fn sentence(finding: &Finding) -> String {
    let (severity, file) = (severity(finding.severity), &finding.at.file);
    let line = (finding.at.line).map_or(String::new(), |line| format!(", line {line}"));
    let key = match finding.at.key.as_str() {
        "" => String::new(),
        key => format!(": {key}"),
    };
    let value = finding.value.map_or(String::new(), |value| {
        let written = match value.abs() {
            size if (1e-4..1e7).contains(&size) || size == 0.0 => value.to_string(),
            _ => format!("{value:e}"),
        };
        format!(" = {written} {}", finding.unit)
            .trim_end()
            .to_owned()
    });
    let usual = finding.assessed.as_ref().map(|j| expected(finding.kind, j));
    let mut parts = vec![what(finding), usual.unwrap_or_default()];
    parts.retain(|part| !part.is_empty());
    let slip = finding.slip.as_ref().map_or(String::new(), |slip| {
        let meant = with_unit(slip.value, finding.unit);
        format!("; if specified in {}, write {meant}", slip.unit)
    });
    let (parts, names) = (parts.join("; "), names(finding));
    format!("{severity}: {file}{line}{key}{value}: {parts}{slip}{names}")
}

/// Lists similar valid names, as the end of a sentence.
fn names(finding: &Finding) -> String {
    match finding.names.as_slice() {
        [] => String::new(),
        names => format!("; similar: {}", names.join(", ")),
    }
}

/// States the reason of a finding.
fn what(finding: &Finding) -> String {
    use FindingKind as K;
    let text = finding.text.as_deref().unwrap_or_default();
    let assessed = finding.assessed.as_ref();
    let value = assessed.map_or(String::new(), |j| with_unit(j.value, j.unit));
    let percent = assessed.map_or(String::new(), |j| {
        format!("{} %", three_digits(100.0 * j.value))
    });
    match finding.kind {
        K::Gap | K::UnknownJoint | K::Contradiction => text.to_owned(),
        K::Range => String::new(),
        K::Distance => format!("{value} from its reference frame"),
        K::ArmMass => format!("arm mass over cubed reach is {value}, and this is its heaviest link"),
        K::HeavyLink => format!("mass is {value} times that of all other links together"),
        K::LightLink => format!("long link with {percent} of the moving mass"),
        K::Density => format!(
            "mass and inertia imply a density of at least {value} (solid sphere); lead: 11 340"
        ),
        K::InertiaSize => format!("radius of gyration is {value}, far larger than the link"),
        K::InertiaPlaceholder => {
            let measure = match assessed.map_or("", |j| j.unit) {
                "m" => "radius of gyration",
                _ => "density of a solid sphere",
            };
            format!(
                "probably a placeholder ({measure} {value}); take mass and inertia from the CAD model, or remove <inertial> of a link of negligible mass"
            )
        }
        K::InertiaNotDefinite => {
            "inertia not positive definite, physically impossible (possible in identified models); used unchanged".into()
        }
        K::InertiaTriangle => "one principal moment exceeds the sum of the other two, physically impossible (possible in identified models); used unchanged".into(),
        K::Frequency => format!("natural frequency on this spring with locked motor is {value}"),
        K::Sag => format!("deflection of this spring under gravity is {value}"),
        K::TooStiff => {
            format!("theta − q never exceeds {value}, below encoder resolution; set rigid = true")
        }
        K::StifferThanRope => {
            format!("stiffness is {value} times that of the two strands of its rope")
        }
        K::MotorInertia => {
            let much = format!("motor inertia is {value} times the inertia moved by the joint");
            match assessed.is_some_and(|j| j.low.is_some_and(|low| j.value < low)) {
                true => much + "; probably the rotor inertia without the squared gear ratio",
                false => much,
            }
        }
        K::Friction => format!("friction deflects the spring by {value} before the joint moves"),
        K::UnknownRope => format!(
            "rope '{text}' not found in the catalogue; add a catalogue with --ropes DIR, or use a rope of sinew rope list"
        ),
        K::Pretension => format!("{percent} of the breaking load"),
        K::HoldingPull => {
            format!("holding the arm against gravity on this radius requires {percent} of the breaking load")
        }
        K::LargestPull => {
            format!("the effort limit of the joint on this radius corresponds to {percent} of the breaking load")
        }
        K::PulleyDiameter => format!("pulley diameter is {value} rope diameters"),
        K::ElongationLimit => format!("{percent} of the strand length"),
        K::RangeWidth => "upper limit equals the lower limit, joint cannot move; make it fixed, or set locked_at_rad".into(),
        K::RangeReversed => "upper limit below the lower limit".into(),
        K::EffortLimit => format!("{percent} of the gravity torque"),
        K::NegativeLimit => "negative limit".into(),
        K::SpeedLimit => "implausibly fast".into(),
        K::Gravity => "implausible gravity".into(),
        K::GravityUp => {
            "gravity points up; z of the world frame points up, set the orientation of the base with base_rpy_rad".into()
        }
    }
}

/// Whether the ratio of a finding is shown in percent.
fn is_share(kind: FindingKind) -> bool {
    use FindingKind as K;
    let shares = [
        K::LightLink,
        K::Pretension,
        K::HoldingPull,
        K::LargestPull,
        K::ElongationLimit,
        K::EffortLimit,
    ];
    shares.contains(&kind)
}

/// Formats the usual range.
fn expected(kind: FindingKind, assessed: &RangeCheck) -> String {
    let with_unit = |end: f64| match is_share(kind) {
        true => with_unit(100.0 * end, "%"),
        false => with_unit(end, assessed.unit),
    };
    let number = |end: f64| three_digits(if is_share(kind) { 100.0 * end } else { end });
    match (assessed.low.filter(|low| *low != 0.0), assessed.high) {
        (Some(low), Some(high)) => {
            format!("usual range {} to {}", number(low), with_unit(high))
        }
        (Some(low), None) => format!("usual at least {}", with_unit(low)),
        (None, Some(high)) => format!("usual at most {}", with_unit(high)),
        (None, None) => "unusual".into(),
    }
}

fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "" => three_digits(value),
        unit => format!("{} {unit}", three_digits(value)),
    }
}
