//! Results of tendons as ROS diagnostics.

use crate::estimate_table::per_rad;
use crate::format::plus_minus;
use crate::session::verdict;
use crate::uncorrected::headline;
use crate::units::of_joint;
use sinew_estimate::replay::{Estimate, JointError, JointEstimate};
use sinew_estimate::session::{LimitState, TendonEstimate, Verdict};
use sinew_figure::rounded;
use sinew_log::encode::{DiagnosticStatus, KeyValue, Level};
use sinew_model::Gaussian;

fn pair(key: &str, value: impl ToString) -> KeyValue {
    KeyValue {
        key: key.into(),
        value: value.to_string(),
    }
}

/// Makes the status of a tendon at a time: OK without a detected change, ERROR above its limit, else WARN.
///
/// * `offset_rad`: offset at that time, rad.
pub(crate) fn of_tendon(
    robot: &str,
    joint: &TendonEstimate,
    offset_rad: Gaussian,
    is_elongation: bool,
) -> DiagnosticStatus {
    let then = match joint.verdict {
        Verdict::TransmissionLost => Verdict::TransmissionLost,
        _ => Verdict::of(offset_rad, is_elongation),
    };
    let elongation_m =
        per_rad(joint.elongation_m, joint.offset_rad).map(|factor| offset_rad.scaled(factor));
    let size = match elongation_m {
        Some(m) => format!("{} mm", plus_minus(m, 1e3)),
        None => format!(
            "{} {}",
            plus_minus(offset_rad, 1e3),
            of_joint(joint.slides).offset
        ),
    };
    // A limit that is not exceeded at the end of the recording is not reported as exceeded before.
    let limit = joint.retension.filter(|r| r.state == LimitState::Passed);
    let beyond = |limit: f64| elongation_m.is_some_and(|m| m.interval_95().low > limit);
    let exceeded = limit.filter(|limit| beyond(limit.elongation_m));
    let limit_text = exceeded.map_or(String::new(), |limit| {
        let mm = rounded(1e3 * limit.elongation_m, 2);
        format!("; exceeds the limit of {mm} mm; re-tension")
    });
    let mut values = vec![
        pair("offset_rad", offset_rad.mean),
        pair("offset_std_rad", offset_rad.std),
    ];
    if let Some(m) = elongation_m {
        values.push(pair("elongation_m", m.mean));
        values.push(pair("elongation_std_m", m.std));
    }
    DiagnosticStatus {
        level: match then {
            _ if exceeded.is_some() => Level::Error,
            Verdict::TransmissionLost => Level::Error,
            Verdict::NoChangeDetected | Verdict::NoneDetected => Level::Ok,
            Verdict::Elongated
            | Verdict::Shortened
            | Verdict::OffsetDetected
            | Verdict::Inconclusive => Level::Warn,
        },
        name: format!("sinew: tendon of {}", joint.name),
        message: format!("{}: {size}{limit_text}", verdict(then)),
        hardware_id: robot.into(),
        values,
    }
}

/// Makes the status of a joint of the uncorrected estimate: OK, as it is no verdict; ERROR if a joint that is not rigid has no estimate.
pub(crate) fn of_uncorrected(estimate: &Estimate, joint: &JointEstimate) -> DiagnosticStatus {
    let name = &joint.name;
    let message = headline(estimate, joint);
    let message = (message.strip_prefix(&format!("{name}: "))).unwrap_or(&message);
    DiagnosticStatus {
        level: match joint.reason {
            None | Some(JointError::Rigid) => Level::Ok,
            Some(_) => Level::Error,
        },
        name: format!("sinew: tendon of {name}"),
        message: message.into(),
        hardware_id: estimate.robot.name.clone(),
        values: (joint.offset_rad.iter())
            .map(|rad| pair("offset_rad", rad))
            .collect(),
    }
}
