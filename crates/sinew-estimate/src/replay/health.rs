//! Warnings of an estimate: implausible values and errors of the recording.

use super::result::{JointEstimate, Loss, LossReason};
use crate::warning::RecordingWarning as Warning;
use sinew_log::Health;

/// Maximum share of lost samples of a stream without a warning, 0 to 1: every network loses some.
const MAX_LOST_SHARE: f64 = 0.005;

/// Adds warnings for implausible offsets and for torque ranges that are too small.
pub(super) fn check_estimates(joints: &[JointEstimate], warnings: &mut Vec<Warning>) {
    // Offsets in the paper are about 10 mrad; 200 mrad on a pulley of 25 mm radius is an elongation of 5 mm.
    const IMPLAUSIBLE_RAD: f64 = 0.2;
    for joint in joints {
        if let Some(offset_rad) = joint.offset_rad.filter(|x| x.abs() > IMPLAUSIBLE_RAD) {
            warnings.push(Warning::ImplausibleOffset {
                joint: joint.name.clone(),
                offset_rad,
            });
        }
        // An error of the stiffness hides an offset in proportion to the torque range.
        let torque = joint.tau_el_nm.zip(joint.stiffness_nm_per_rad);
        if let Some((tau, stiffness)) = torque
            && joint.reason.is_none()
            && joint.scatter_rad.is_some()
            && (tau.max - tau.min) / stiffness < 1e-3
        {
            warnings.push(Warning::TorqueRangeSmall {
                joint: joint.name.clone(),
                min_nm: tau.min,
                max_nm: tau.max,
            });
        }
    }
}

pub(super) fn health_losses(health: &Health, frames: u64, losses: &mut Vec<Loss>) {
    let counts = [
        (LossReason::Duplicate, health.duplicates),
        (LossReason::Late, health.late),
        (LossReason::Undecodable, health.undecodable),
        (LossReason::WithoutTime, health.rows_without_time),
    ];
    let counts = counts.into_iter().filter(|(_, count)| *count > 0);
    losses.extend(counts.map(|(reason, count)| Loss {
        reason,
        frames: count,
        share: count as f64 / (frames + count) as f64,
    }));
}

pub(super) fn health_warnings(health: &Health, warnings: &mut Vec<Warning>) {
    warnings.extend(health.damage.iter().map(|damage| Warning::Damaged {
        offset: damage.offset,
        reason: damage.reason.clone(),
        bytes: damage.bytes,
    }));
    if health.gaps > 0 {
        warnings.push(Warning::Gaps {
            count: health.gaps,
            longest_s: health.longest_gap_s,
        });
    }
    if health.clock_steps > 0 {
        warnings.push(Warning::ClockJumps {
            count: health.clock_steps,
        });
    }
    if health.out_of_order > 0 {
        warnings.push(Warning::OutOfOrder {
            count: health.out_of_order,
        });
    }
    for stream in &health.streams {
        if stream.lost_share() > MAX_LOST_SHARE {
            warnings.push(Warning::SamplesLost {
                stream: stream.role,
                missing: stream.missing.unwrap_or(0),
                repeated: stream.repeated,
                share: stream.lost_share(),
            });
        }
    }
    for second in &health.second_publishers {
        warnings.push(Warning::SecondPublisher {
            stream: second.stream,
            samples: second.samples,
        });
    }
    for late in &health.late_starts {
        warnings.push(Warning::LateStart {
            quantity: late.quantity.symbol().into(),
            joint: late.joint.clone(),
            after_s: late.after_s,
        });
    }
    if health.unstamped > 0 {
        warnings.push(Warning::NoTimeStamp {
            count: health.unstamped,
        });
    }
    for signal in &health.non_finite {
        warnings.push(Warning::NonFinite {
            quantity: signal.quantity.symbol().into(),
            joint: signal.joint.clone(),
            count: signal.count,
        });
    }
    for signal in &health.unwrapped {
        warnings.push(Warning::Unwrapped {
            quantity: signal.quantity.symbol().into(),
            joint: signal.joint.clone(),
            count: signal.count,
        });
    }
    let implausible_signals = health.implausible_signals.iter().cloned();
    warnings.extend(implausible_signals.map(|text| Warning::ImplausibleSignal { text }));
}
