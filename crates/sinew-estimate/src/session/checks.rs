//! What the reader of a session's estimate should know.

use super::context::Context;
use super::inflation::Inflation;
use super::late_step::LASTING_S;
use super::recorder::Recorded;
use super::result::{SessionEstimate, TendonEstimate, Verdict};
use super::stand::Stand;
use super::warning::Warning;

/// Less change of torque than this, of the spring's deflection, leaves stiffness and offset one, rad.
const POOR_RAD: f64 = 10e-3;
/// More than this left unexplained is worth a word, rad.
const NOISY_RAD: f64 = 1e-3;
/// A joint that moved less than this while its motor turned ten times as far is stuck, rad.
const STUCK_RAD: f64 = 5e-3;
/// A payload so many half intervals below nothing is none.
const LIGHTER: f64 = 2.0;
/// A share left out above this makes what is left suspect: the breakdown point of the median that noise is found by.
const MUCH: f64 = 0.5;
/// Creep that is no likelier than this isn't worth a word.
const CREEPS: f64 = 0.3;
/// A change of stiffness that is no likelier than this isn't worth a word: 0.23 is believed before the
/// data is seen.
const LIKELY: f64 = 0.3;

/// Loops of `[[tendons]]` that carried more than both of their strands do.
fn beyond_pretension(context: &Context<'_>, joints: &[TendonEstimate]) -> Vec<Warning> {
    let of = |joint: &TendonEstimate| {
        let index = context.robot.tendon_index(&joint.name)?;
        let transmission = context.robot.transmissions.get(index)?.as_ref()?;
        let tendon = (transmission.routing.as_ref()).and(transmission.tendon.as_ref())?;
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

/// Warnings for an estimate; `far` are those of parameters far from what was believed, `stands` says of every elastic
/// joint how it stands at the end.
pub(super) fn warnings(
    context: &Context<'_>,
    estimate: &SessionEstimate,
    inflations: &[Inflation],
    far: Vec<Warning>,
    stands: &[Option<Stand>],
) -> Vec<Warning> {
    let recorded = context.recorded;
    let joints = &estimate.joints;
    let mut out = Vec::new();
    if estimate.poses < 3 {
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
        out.extend(late.map(|change| Warning::ChangeMayEnd {
            joint: joint.name.clone(),
            time_s: change.time_s,
            before_end_s: recorded.end_s() - change.time_s,
        }));
    }
    out.extend(beyond_pretension(context, joints));
    out.extend(stands_at_end(joints, stands));
    for (joint, inflation) in joints.iter().zip(inflations) {
        if inflation.creep_95_rad > 0.0 {
            out.push(Warning::RopeCreeps {
                joint: joint.name.clone(),
                half_width_95_rad: inflation.creep_95_rad,
            });
        }
    }
    out.extend(joints.iter().filter_map(|j| creeps(j, recorded.duration_s)));
    // What its owner stated is no news to him.
    let force = (estimate.external_force).filter(|f| f.is_worth_a_word() && !f.is_stated);
    out.extend(force.map(|force| Warning::ExternalForce {
        probability: force.probability,
        force_n: force.force_n,
    }));
    let unexplained = joints.iter().filter(|joint| joint.noise_rad > NOISY_RAD);
    out.extend(unexplained.map(|joint| Warning::Unexplained {
        joint: joint.name.clone(),
        noise_rad: joint.noise_rad,
    }));
    for (joint, travel) in joints.iter().zip(travels(recorded)) {
        if travel.joint < STUCK_RAD && travel.motor > 10.0 * travel.joint.max(1e-3) {
            out.push(Warning::Stuck {
                joint: joint.name.clone(),
                joint_travel_rad: travel.joint,
                motor_travel_rad: travel.motor,
            });
        }
    }
    let payload_kg = estimate.payload_kg;
    if payload_kg.mean + LIGHTER * payload_kg.half_width_95() < 0.0 {
        out.push(Warning::NegativePayload { payload_kg });
    }
    let long = |from_s: f64, to_s: f64| to_s - from_s > LASTING_S;
    let left_out = estimate.left_out.iter();
    out.extend(
        left_out
            .filter(|l| long(l.from_s, l.to_s))
            .map(|l| Warning::NothingFits {
                from_s: l.from_s,
                to_s: l.to_s,
            }),
    );
    if estimate.left_out_share > MUCH {
        out.push(Warning::MuchLeftOut {
            share: estimate.left_out_share,
        });
    }
    if estimate.baseline.is_none() {
        out.push(Warning::NoBaseline);
    }
    out.extend(far);
    if recorded.frames_missing > 0 {
        out.push(Warning::FramesMissing {
            frames: recorded.frames_missing,
        });
    }
    out.extend(joints.iter().filter_map(stiffness_before));
    out
}

fn torque_hardly_changed(joint: &TendonEstimate, deflection_rad: f64) -> Option<Warning> {
    (joint.verdict == Verdict::CannotTell && deflection_rad < POOR_RAD).then(|| {
        Warning::TorqueHardlyChanged {
            joint: joint.name.clone(),
            torque_nm: joint.torque_nm,
        }
    })
}

/// What friction may hide where the arm stands at the end, of the joint where that is most; and every joint that reads more than
/// friction can hold.
fn stands_at_end(joints: &[TendonEstimate], stands: &[Option<Stand>]) -> Vec<Warning> {
    let own = || {
        joints
            .iter()
            .zip(stands)
            .filter_map(|(j, s)| Some((j, (*s)?)))
    };
    let hides = own().filter(|(joint, stand)| stand.hidden_rad > joint.offset_rad.half_width_95());
    let most = hides.max_by(|a, b| a.1.hidden_rad.total_cmp(&b.1.hidden_rad));
    let hides = most.map(|(joint, stand)| Warning::StandsAtEnd {
        joint: joint.name.clone(),
        from_s: stand.from_s,
        hidden_rad: stand.hidden_rad,
    });
    let off = own().filter(|(_, stand)| stand.is_more_than_friction());
    let off = off.map(|(joint, stand)| Warning::StandReadsOff {
        joint: joint.name.clone(),
        from_s: stand.from_s,
        off_rad: stand.off_rad,
        hidden_rad: stand.hidden_rad,
    });
    hides.into_iter().chain(off).collect()
}

/// An offset that moved, or may have.
fn creeps(joint: &TendonEstimate, duration_s: f64) -> Option<Warning> {
    let creep = joint.creep?;
    (creep.probability > CREEPS).then(|| Warning::TendonCreeps {
        joint: joint.name.clone(),
        probability: creep.probability,
        moved_rad: creep.moved_rad,
        duration_s,
    })
}

/// Stiffness that has, or may have, changed before the recording began.
fn stiffness_before(joint: &TendonEstimate) -> Option<Warning> {
    let since = joint.stiffness_since_before?;
    (since.probability > LIKELY).then(|| Warning::StiffnessChangedBefore {
        joint: joint.name.clone(),
        probability: since.probability,
        change_ratio: since.change_ratio,
    })
}

/// How far a joint, its motor and its spring moved, rad.
struct Travel {
    joint: f64,
    motor: f64,
    deflection: f64,
}

/// Of every elastic joint.
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
