//! What a reader should doubt: implausible values, and what was wrong with the recording.

use super::result::{JointEstimate, Loss};
use sinew_log::Health;

/// What a reader should doubt.
pub(super) fn judge(joints: &[JointEstimate], warnings: &mut Vec<String>) {
    // The paper looks for 10 mrad; a tendon pulley of 25 mm turns 200 mrad for 5 mm of rope.
    const IMPLAUSIBLE_MRAD: f64 = 200.0;
    for joint in joints {
        if joint.delta_e_mrad.abs() > IMPLAUSIBLE_MRAD {
            warnings.push(format!(
                "joint '{}': an offset of {:.0} mrad is no stretch of a rope; check units (degrees?), gear ratio, sign and zero of its positions",
                joint.name, joint.delta_e_mrad
            ));
        }
        let [low, _, high] = joint.tau_el_nm;
        // 1 % of stiffness times the torque range is what a wrong stiffness can hide.
        if joint.refused.is_none()
            && joint.scatter_mrad.is_finite()
            && (high - low) / joint.stiffness_nm_per_rad < 1e-3
        {
            warnings.push(format!(
                "joint '{}': its torque hardly changes ({low:.2} to {high:.2} N·m); a wrong stiffness or mass can't be told from stretch in this recording",
                joint.name
            ));
        }
    }
}

pub(super) fn health_losses(health: &Health, frames: u64, losses: &mut Vec<Loss>) {
    let mut add = |reason: &str, count: u64| {
        if count > 0 {
            losses.push(Loss {
                reason: reason.into(),
                frames: count,
                share: count as f64 / (frames + count) as f64,
            });
        }
    };
    add("dropped: time stamp seen before", health.duplicates);
    add("dropped: came too late to be sorted in", health.late);
    add("dropped: could not be decoded", health.undecodable);
    add("dropped: a row without a time", health.rows_without_time);
}

pub(super) fn health_warnings(health: &Health, warnings: &mut Vec<String>) {
    for damage in &health.damage {
        warnings.push(format!(
            "the file is damaged at byte {}: {}; {} bytes lost, everything before was used",
            damage.offset, damage.reason, damage.bytes
        ));
    }
    if health.gaps > 0 {
        warnings.push(format!(
            "{} in the recording, the longest {:.1} s; the observer started anew after each",
            count(health.gaps, "gap"),
            health.longest_gap_s
        ));
    }
    if health.clock_jumps > 0 {
        warnings.push(format!(
            "the clock went back {}; the observer started anew after each",
            count(health.clock_jumps, "time")
        ));
    }
    if health.out_of_order > 0 {
        warnings.push(format!(
            "{} came out of order, sorted in",
            count(health.out_of_order, "message")
        ));
    }
    for signal in &health.non_finite {
        warnings.push(format!(
            "{} of '{}' is NaN or infinite in {}, left out",
            signal.quantity.symbol(),
            signal.joint,
            count(signal.count, "sample")
        ));
    }
    for signal in &health.unwrapped {
        warnings.push(format!(
            "{} of '{}' wrapped around {} and was unwrapped",
            signal.quantity.symbol(),
            signal.joint,
            count(signal.count, "time")
        ));
    }
    warnings.extend(health.suspicions.iter().cloned());
}

/// "1 gap", "3 gaps".
fn count(number: u64, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
