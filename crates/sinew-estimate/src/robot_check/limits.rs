//! Checks of the ranges, speeds and torques of a URDF's joints.

use super::finding::{Bounds, Finding, FindingKind, Measure, Severity, Written, check_range};
use super::loads::Load;
use super::masses::Outline;
use sinew_model::arm::urdf::{JointType, UrdfJoint};
use std::f64::consts::TAU;

/// Whether a limit is a placeholder; published URDFs contain 100, 1000, 50 000 and 1e16.
fn is_placeholder(limit: f64) -> bool {
    limit == 100.0 || limit >= 1_000.0
}

/// Returns the implausible limits of a joint. `load`: load of the arm on the joint, if the masses are plausible.
pub(super) fn findings(
    outline: &Outline<'_>,
    joint: &UrdfJoint,
    load: Option<&Load>,
) -> Vec<Finding> {
    let slides = joint.joint_type == JointType::Prismatic;
    if !slides && joint.joint_type != JointType::Revolute {
        return Vec::new();
    }
    let unit = |turning, sliding| if slides { sliding } else { turning };
    let at = |what: &str| outline.at(&format!("joint '{}'", joint.name), what);
    let [lower, upper, effort, velocity] = joint.limit;
    let plain = |kind, severity, what: &str, value, unit| Finding {
        value: Some(value),
        unit,
        ..Finding::new(kind, severity, at(what))
    };
    let range = |what: &'static str, value: f64| {
        let written = Written {
            value,
            unit: unit("rad", "m"),
        };
        let measure = Measure {
            value: value.abs(),
            unit: unit("rad", "m"),
            power: 1.0,
        };
        let bounds = Bounds::usual(0.0, if slides { 20.0 } else { 4.0 * TAU });
        if is_placeholder(value.abs()) {
            return None;
        }
        check_range(FindingKind::Range, || at(what), written, measure, bounds)
    };
    let mut out = Vec::new();
    let width = unit("rad", "m");
    if joint.range_stated && lower == upper {
        let kind = FindingKind::RangeWidth;
        out.push(plain(
            kind,
            Severity::Implausible,
            "upper limit",
            upper,
            width,
        ));
    } else if joint.range_stated && upper < lower {
        let kind = FindingKind::RangeReversed;
        out.push(plain(
            kind,
            Severity::Implausible,
            "upper limit",
            upper,
            width,
        ));
    }
    out.extend(range("upper limit", upper).or_else(|| range("lower limit", lower)));
    for (what, value, unit) in [
        ("effort limit", effort, unit("N·m", "N")),
        ("velocity limit", velocity, unit("rad/s", "m/s")),
    ] {
        if value < 0.0 {
            let kind = FindingKind::NegativeLimit;
            out.push(plain(kind, Severity::Impossible, what, value, unit));
        }
    }
    // 600 rpm; light hands reach 60 rpm.
    if velocity > 0.0 && !is_placeholder(velocity) {
        let written = Written {
            value: velocity,
            unit: unit("rad/s", "m/s"),
        };
        let measure = Measure {
            value: velocity,
            unit: unit("rad/s", "m/s"),
            power: 1.0,
        };
        let bounds = Bounds::usual(0.0, 60.0);
        let at = || at("velocity limit");
        out.extend(check_range(
            FindingKind::SpeedLimit,
            at,
            written,
            measure,
            bounds,
        ));
    }
    if let Some(load) = load.filter(|load| effort > 0.0 && load.gravity_nm > 0.0) {
        // The effort limit may be below the gravity torque of the outstretched arm, but not below a tenth of it.
        let written = Written {
            value: effort,
            unit: unit("N·m", "N"),
        };
        let measure = Measure {
            value: effort / load.gravity_nm,
            unit: "",
            power: 1.0,
        };
        let bounds = Bounds::usual(0.1, f64::INFINITY);
        let at = || at("effort limit");
        out.extend(check_range(
            FindingKind::EffortLimit,
            at,
            written,
            measure,
            bounds,
        ));
    }
    out
}
