//! Warnings of a session estimate.

use super::context::Context;
use super::inflation::Inflation;
use super::late_step::LASTING_S;
use super::poses::MIN_POSES;
use super::recorder::Recorded;
use super::rest_phase::RestPhase;
use super::result::{SessionEstimate, TendonEstimate, Verdict};
use super::warning::Warning;
use sinew_model::tendons::{Routing, TendonKind};

/// Minimum range of the spring deflection, rad: below it, stiffness and offset are not separable.
const MIN_DEFLECTION_RANGE_RAD: f64 = 10e-3;
/// Maximum distance of a position from the limits of the URDF without a warning, relative to their range: overshoot of the
/// controller and error of the encoder zero. Engineering estimate.
const MAX_BEYOND_LIMITS_RATIO: f64 = 0.05;
/// Maximum residual without a warning, robust standard deviation, rad.
const MAX_RESIDUAL_RAD: f64 = 1e-3;
/// Maximum travel of a seized joint, rad; its motor travels more than ten times that of the joint.
const MAX_SEIZED_TRAVEL_RAD: f64 = 5e-3;
/// Minimum distance of a negative payload from zero to be reported, in half-widths of its 95 % interval.
const NEGATIVE_PAYLOAD_HALF_WIDTHS: f64 = 2.0;
/// Maximum share of rejected time without a warning, 0 to 1: the breakdown point of the median that estimates the
/// noise.
const MAX_REJECTED_SHARE: f64 = 0.5;
/// Minimum probability of creep to be reported.
const MIN_CREEP_PROBABILITY: f64 = 0.3;
/// Minimum probability of a stiffness change to be reported; its prior probability is 0.23.
const MIN_STIFFNESS_CHANGE_PROBABILITY: f64 = 0.3;

/// Warnings for loops of `[[tendons]]` whose torque exceeded twice the pretension, so that one strand was slack.
fn beyond_pretension(context: &Context<'_>, joints: &[TendonEstimate]) -> Vec<Warning> {
    let of = |joint: &TendonEstimate| {
        let index = context.robot.tendon_index(&joint.name)?;
        let transmission = context.robot.transmissions.get(index)?.as_ref()?;
        let routing = transmission.routing.as_ref();
        let is_loop = |routing: &&Routing| {
            let pull = routing.pull.as_ref();
            pull.is_none_or(|pull| pull.kind == TendonKind::Loop)
        };
        let tendon = routing.filter(is_loop).and(transmission.tendon.as_ref())?;
        let limit_nm = 2.0 * tendon.joint_pulley_radius_m * tendon.pretension_n?;
        let torque_nm = joint.torque_nm.min.abs().max(joint.torque_nm.max.abs());
        (torque_nm > limit_nm).then(|| Warning::BeyondPretension {
            joint: joint.name.clone(),
            torque_nm,
            limit_nm,
        })
    };
    joints.iter().filter_map(of).collect()
}

/// Warnings for joints with positions beyond the limits of the URDF.
fn beyond_limits(context: &Context<'_>) -> Vec<Warning> {
    let of = |joint: usize| {
        let limits = context.robot.limits.get(joint)?;
        let positions = || context.recorded.blocks.iter().map(|b| b.turned[joint]);
        let min_rad = positions().fold(f64::INFINITY, f64::min);
        let max_rad = positions().fold(f64::NEG_INFINITY, f64::max);
        let margin_rad = MAX_BEYOND_LIMITS_RATIO * (limits.upper - limits.lower);
        let is_within = |min: f64, max: f64| {
            min >= limits.lower - margin_rad && max <= limits.upper + margin_rad
        };
        let is_limited = margin_rad.is_finite() && margin_rad > 0.0;
        (is_limited && !is_within(min_rad, max_rad)).then(|| Warning::BeyondLimits {
            joint: context.robot.joint_names()[joint].clone(),
            min_rad,
            max_rad,
            lower_rad: limits.lower,
            upper_rad: limits.upper,
            opposite_is_within: is_within(-max_rad, -min_rad),
        })
    };
    (0..context.robot.joint_names().len())
        .filter_map(of)
        .collect()
}

/// Returns the warnings of an estimate; `far` are those of parameters far from their prior, `rest_phases` has the final
/// rest phase of each elastic joint.
pub(super) fn warnings(
    context: &Context<'_>,
    estimate: &SessionEstimate,
    inflations: &[Inflation],
    far: Vec<Warning>,
    rest_phases: &[Option<RestPhase>],
) -> Vec<Warning> {
    let recorded = context.recorded;
    let joints = &estimate.joints;
    let mut out = Vec::new();
    if estimate.poses < MIN_POSES {
        out.push(Warning::FewPoses {
            poses: estimate.poses,
        });
    }
    let names = context.robot.joint_names();
    let without_encoder = recorded.without_encoder.iter();
    out.extend(without_encoder.map(|joint| Warning::NoJointEncoder {
        joint: names[*joint].clone(),
    }));
    let elastic = recorded.elastic.iter();
    for ((joint, travel), i) in joints.iter().zip(travels(recorded)).zip(elastic) {
        out.extend(torque_hardly_changed(joint, travel.deflection));
        let late = joint.changes.iter().filter(|c| context.may_end(*i, c));
        out.extend(late.map(|change| Warning::ChangeNearEnd {
            joint: joint.name.clone(),
            time_s: change.time_s,
            before_end_s: recorded.end_s() - change.time_s,
        }));
    }
    out.extend(beyond_limits(context));
    out.extend(beyond_pretension(context, joints));
    out.extend(at_rest_at_end(joints, rest_phases));
    for (joint, inflation) in joints.iter().zip(inflations) {
        if inflation.creep_95_rad > 0.0 {
            out.push(Warning::RopeMemory {
                joint: joint.name.clone(),
                half_width_95_rad: inflation.creep_95_rad,
            });
        }
    }
    out.extend(joints.iter().filter_map(|j| creeps(j, recorded.duration_s)));
    // A specified force needs no warning.
    let force = (estimate.external_force).filter(|f| f.is_reportable() && !f.is_specified);
    out.extend(force.map(|force| Warning::ExternalForce {
        probability: force.probability,
        force_n: force.force_n,
    }));
    let unexplained = joints
        .iter()
        .filter(|joint| joint.noise_rad > MAX_RESIDUAL_RAD);
    out.extend(unexplained.map(|joint| Warning::UnexplainedResidual {
        joint: joint.name.clone(),
        noise_rad: joint.noise_rad,
    }));
    // A motor of a single strand may change its tension without moving the joint.
    let own = recorded
        .elastic
        .iter()
        .map(|i| context.robot.pulling_tendon(*i).is_none());
    for ((joint, travel), has_own) in joints.iter().zip(travels(recorded)).zip(own) {
        if has_own
            && travel.joint < MAX_SEIZED_TRAVEL_RAD
            && travel.motor > 10.0 * travel.joint.max(1e-3)
        {
            out.push(Warning::JointSeized {
                joint: joint.name.clone(),
                from_s: 0.0,
                joint_travel_rad: travel.joint,
                motor_travel_rad: travel.motor,
            });
        }
    }
    let payload_kg = estimate.payload_kg;
    if payload_kg.mean + NEGATIVE_PAYLOAD_HALF_WIDTHS * payload_kg.half_width_95() < 0.0 {
        out.push(Warning::NegativePayload { payload_kg });
    }
    let long = |from_s: f64, to_s: f64| to_s - from_s > LASTING_S;
    let rejected = estimate.rejected_intervals.iter();
    out.extend(
        rejected
            .filter(|l| long(l.from_s, l.to_s))
            .map(|l| Warning::UnmodelledInterval {
                from_s: l.from_s,
                to_s: l.to_s,
            }),
    );
    if estimate.rejected_share > MAX_REJECTED_SHARE {
        out.push(Warning::MuchRejected {
            share: estimate.rejected_share,
        });
    }
    if estimate.baseline.is_none() {
        out.push(Warning::NoBaseline);
    }
    out.extend(far);
    if recorded.frames_missing > 0 {
        out.push(Warning::FramesIncomplete {
            frames: recorded.frames_missing,
        });
    }
    out.extend(joints.iter().filter_map(stiffness_before));
    out
}

fn torque_hardly_changed(joint: &TendonEstimate, deflection_rad: f64) -> Option<Warning> {
    // A joint whose blocks are all excluded has no torque; another warning names the cause.
    let is_used = joint.torque_nm.min <= joint.torque_nm.max;
    let is_small = is_used && deflection_rad < MIN_DEFLECTION_RANGE_RAD;
    (joint.verdict == Verdict::Inconclusive && is_small).then(|| Warning::TorqueRangeSmall {
        joint: joint.name.clone(),
        torque_nm: joint.torque_nm,
    })
}

/// Warns of the largest slip that stiction can hide in the final rest phase, and of each joint whose residual there
/// exceeds what stiction explains.
fn at_rest_at_end(joints: &[TendonEstimate], rest_phases: &[Option<RestPhase>]) -> Vec<Warning> {
    let phases = || {
        joints
            .iter()
            .zip(rest_phases)
            .filter_map(|(joint, phase)| Some((joint, (*phase)?)))
    };
    let hidden = phases()
        .filter(|(joint, phase)| phase.stiction_bound_rad > joint.offset_rad.half_width_95());
    let most = hidden.max_by(|a, b| a.1.stiction_bound_rad.total_cmp(&b.1.stiction_bound_rad));
    let hidden = most.map(|(joint, phase)| Warning::AtRestAtEnd {
        joint: joint.name.clone(),
        from_s: phase.from_s,
        stiction_bound_rad: phase.stiction_bound_rad,
    });
    let inconsistent = phases().filter(|(_, phase)| phase.exceeds_stiction());
    let inconsistent = inconsistent.map(|(joint, phase)| Warning::RestPhaseInconsistent {
        joint: joint.name.clone(),
        from_s: phase.from_s,
        inconsistency_rad: phase.inconsistency_rad,
        stiction_bound_rad: phase.stiction_bound_rad,
    });
    hidden.into_iter().chain(inconsistent).collect()
}

/// Warning for an offset that drifted with sufficient probability.
fn creeps(joint: &TendonEstimate, duration_s: f64) -> Option<Warning> {
    let creep = joint.creep?;
    (creep.probability > MIN_CREEP_PROBABILITY).then(|| Warning::TendonCreep {
        joint: joint.name.clone(),
        probability: creep.probability,
        drift_rad: creep.drift_rad,
        duration_s,
    })
}

/// Warning for a stiffness that changed before the recording with sufficient probability.
fn stiffness_before(joint: &TendonEstimate) -> Option<Warning> {
    let since = joint.stiffness_change?;
    (since.probability > MIN_STIFFNESS_CHANGE_PROBABILITY).then(|| Warning::StiffnessChanged {
        joint: joint.name.clone(),
        probability: since.probability,
        change_ratio: since.change_ratio,
    })
}

/// Ranges of joint position, motor position and spring deflection, rad.
struct Travel {
    joint: f64,
    motor: f64,
    deflection: f64,
}

/// Travel of each elastic joint.
fn travels(recorded: &Recorded) -> impl Iterator<Item = Travel> {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        most - least
    };
    recorded.elastic.iter().map(move |&i| {
        let blocks = || recorded.blocks.iter();
        Travel {
            joint: range(&mut blocks().map(|b| b.turned[i])),
            motor: range(&mut blocks().map(|b| b.turned[i] + b.y[i])),
            deflection: range(&mut blocks().map(|b| b.y[i])),
        }
    })
}
