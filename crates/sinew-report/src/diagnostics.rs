//! A tendon as a status of ROS diagnostics.

use crate::estimate_table::per_rad;
use crate::reading::headline;
use crate::session::verdict;
use crate::units::of_joint;
use crate::words::plus_minus;
use sinew_estimate::replay::{Estimate, JointEstimate, JointRefusal};
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

/// A tendon whose offset was `offset_rad` then: OK where it is unchanged, ERROR past its limit, else WARN.
pub(crate) fn of_tendon(
    robot: &str,
    joint: &TendonEstimate,
    offset_rad: Gaussian,
) -> DiagnosticStatus {
    let then = Verdict::of(offset_rad);
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
    // What withholds the answer in the end withholds it before.
    let limit = joint.retension.filter(|r| r.state == LimitState::Passed);
    let beyond = |limit: f64| elongation_m.is_some_and(|m| m.interval_95().low > limit);
    let passed = limit.filter(|limit| beyond(limit.elongation_m));
    let past = passed.map_or(String::new(), |limit| {
        let mm = rounded(1e3 * limit.elongation_m, 2);
        format!("; past the {mm} mm at which to tension again")
    });
    let mut values = vec![
        pair("offset_rad", offset_rad.mean),
        pair("offset_interval_95_rad", offset_rad.half_width_95()),
    ];
    if let Some(m) = elongation_m {
        values.push(pair("elongation_m", m.mean));
        values.push(pair("elongation_interval_95_m", m.half_width_95()));
    }
    DiagnosticStatus {
        level: match then {
            _ if passed.is_some() => Level::Error,
            Verdict::Unchanged => Level::Ok,
            Verdict::Longer | Verdict::Shorter | Verdict::CannotTell => Level::Warn,
        },
        name: format!("sinew: tendon of {}", joint.name),
        message: format!("{}: {size}{past}", verdict(then)),
        hardware_id: robot.into(),
        values,
    }
}

/// A joint by the paper's reading: a reading is no verdict, so OK; ERROR where there should be one and is none.
pub(crate) fn of_reading(estimate: &Estimate, joint: &JointEstimate) -> DiagnosticStatus {
    let name = &joint.name;
    let said = headline(estimate, joint);
    let said = said.strip_prefix(&format!("{name}: ")).unwrap_or(&said);
    DiagnosticStatus {
        level: match joint.refused {
            None | Some(JointRefusal::Rigid) => Level::Ok,
            Some(_) => Level::Error,
        },
        name: format!("sinew: tendon of {name}"),
        message: said.into(),
        hardware_id: estimate.robot.name.clone(),
        values: (joint.offset_rad.iter())
            .map(|rad| pair("offset_rad", rad))
            .collect(),
    }
}
