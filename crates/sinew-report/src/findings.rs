//! What looks odd in a robot's description, in sentences.

use sinew_estimate::robot_check::{Finding, FindingKind, Judged, Severity};
use sinew_files::number::three_digits;

/// All of them, a sentence each; those that say the same of several places, one for all.
pub(crate) fn sentences(findings: &[Finding]) -> Vec<String> {
    let says_the_same = |a: &Finding, b: &Finding| {
        a.value.is_none()
            && (&a.text, &a.names) == (&b.text, &b.names)
            && (a.kind, a.severity, &a.at.file) == (b.kind, b.severity, &b.at.file)
    };
    let groups = findings.chunk_by(says_the_same);
    groups
        .filter_map(|group| match group {
            [] => None,
            [one] => Some(sentence(one)),
            [first, ..] => {
                let place = |f: &Finding| {
                    let line = f.at.line.map_or(String::new(), |n| format!(" (line {n})"));
                    f.at.key.clone() + &line
                };
                let places: Vec<String> = group.iter().map(place).collect();
                let (severity, file) = (severity(first.severity), &first.at.file);
                let places = places.join("; ");
                let (what, names) = (what(first), names(first));
                Some(format!("{severity}: {file}: {places}: {what}{names}"))
            }
        })
        .collect()
}

fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Impossible => "impossible",
        Severity::Missing => "missing",
        Severity::Odd => "odd",
    }
}

/// One finding: how bad, where, the value, what is wrong with it, what is usual, a likely unit.
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
    let usual = finding.judged.as_ref().map(|j| expected(finding.kind, j));
    let mut parts = vec![what(finding), usual.unwrap_or_default()];
    parts.retain(|part| !part.is_empty());
    let slip = finding.slip.as_ref().map_or(String::new(), |slip| {
        let meant = with_unit(slip.value, finding.unit);
        format!(". Was it meant in {}? Then write {meant}", slip.unit)
    });
    let (parts, names) = (parts.join("; "), names(finding));
    format!("{severity}: {file}{line}{key}{value}: {parts}{slip}{names}")
}

/// The names there are, as the end of a sentence.
fn names(finding: &Finding) -> String {
    match finding.names.as_slice() {
        [] => String::new(),
        names => format!("; it has {}", names.join(", ")),
    }
}

/// What is wrong.
fn what(finding: &Finding) -> String {
    use FindingKind as K;
    let text = finding.text.as_deref().unwrap_or_default();
    let judged = finding.judged.as_ref();
    let value = judged.map_or(String::new(), |j| with_unit(j.value, j.unit));
    let percent = judged.map_or(String::new(), |j| {
        format!("{} %", three_digits(100.0 * j.value))
    });
    match finding.kind {
        K::Gap | K::UnknownJoint | K::Contradiction => text.to_owned(),
        K::Range => String::new(),
        K::Distance => format!("{value} from the frame it is given in"),
        K::ArmMass => format!("the arm has {value} of its reach cubed, and this is its heaviest link"),
        K::HeavyLink => format!("{value} times as heavy as all other links together"),
        K::LightLink => format!("a long link with {percent} of the moving mass"),
        K::Density => format!(
            "with this mass and inertia the link has {value} even as a solid ball; lead has 11 340"
        ),
        K::InertiaSize => format!("its radius of gyration is {value}, far beyond its own joints"),
        K::InertiaNotDefinite => {
            "not positive definite, which no body has (identified models do); used as it stands".into()
        }
        K::InertiaTriangle => "one principal moment is larger than the other two together, which no body has (identified models do); used as it stands".into(),
        K::Frequency => format!("the arm swings at {value} on this spring with the motor held"),
        K::Sag => format!("gravity alone deflects this spring by {value}"),
        K::TooStiff => {
            format!("theta − q never exceeds {value}, which no encoder shows; rigid = true says the same")
        }
        K::StifferThanRope => {
            format!("{value} times as stiff as the two strands of its rope alone")
        }
        K::MotorInertia => {
            let much = format!("{value} times the inertia that the joint moves");
            match judged.is_some_and(|j| j.low.is_some_and(|low| j.value < low)) {
                true => much + " (is it the rotor's, without the gear ratio squared?)",
                false => much,
            }
        }
        K::Friction => format!("it deflects the spring by {value} before the joint moves"),
        K::UnknownRope => format!(
            "the catalogue has no '{text}'; name a folder of your own with --ropes DIR, or one of its ropes"
        ),
        K::Pretension => format!("{percent} of the rope's breaking load"),
        K::HoldingPull => {
            format!("on this radius, holding the arm up takes {percent} of the rope's breaking load")
        }
        K::LargestPull => {
            format!("on this radius, the joint's effort limit takes {percent} of the rope's breaking load")
        }
        K::PulleyDiameter => format!("the rope's path is {value} rope diameters wide"),
        K::ElongationLimit => format!("{percent} of the strand's length"),
        K::RangeWidth => "the same as the lower one: the joint can't move; make it fixed, or locked_at_rad".into(),
        K::RangeReversed => "below the lower one".into(),
        K::EffortLimit => format!("{percent} of the torque that gravity asks for"),
        K::NegativeLimit => "below 0".into(),
        K::SpeedLimit => "no arm moves so fast".into(),
        K::Gravity => "the gravity of no planet".into(),
        K::GravityUp => {
            "gravity points up; in the world frame z points up, base_rpy_rad says how the base hangs".into()
        }
    }
}

/// Whether a ratio is shown in percent.
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

/// What is usual.
fn expected(kind: FindingKind, judged: &Judged) -> String {
    let with_unit = |end: f64| match is_share(kind) {
        true => with_unit(100.0 * end, "%"),
        false => with_unit(end, judged.unit),
    };
    let number = |end: f64| three_digits(if is_share(kind) { 100.0 * end } else { end });
    match (judged.low.filter(|low| *low != 0.0), judged.high) {
        (Some(low), Some(high)) => {
            format!("usual are {} to {}", number(low), with_unit(high))
        }
        (Some(low), None) => format!("usual are {} and more", with_unit(low)),
        (None, Some(high)) => format!("usual are at most {}", with_unit(high)),
        (None, None) => "not usual".into(),
    }
}

fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "" => three_digits(value),
        unit => format!("{} {unit}", three_digits(value)),
    }
}
