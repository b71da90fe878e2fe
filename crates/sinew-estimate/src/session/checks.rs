//! What the reader of a session's estimate should know.

use super::inflation::{Inflation, LASTING_S, may_end};
use super::recorder::Recorded;
use super::result::{SessionEstimate, TendonEstimate, Verdict};
use super::warning::Warning;

/// Less change of torque than this, of the spring's deflection, leaves stiffness and offset one, rad.
const POOR_RAD: f64 = 10e-3;
/// More than this left unexplained is worth a word, rad.
const NOISY_RAD: f64 = 1e-3;
/// A joint that moved less than this while its motor turned ten times as far is stuck, rad.
const STUCK_RAD: f64 = 5e-3;
/// A payload so many half intervals below nothing is none.
const LIGHTER: f64 = 2.0;
/// A share left out above this makes what is left suspect.
const MUCH: f64 = 0.35;
/// A change of stiffness that is no likelier than this isn't worth a word: 0.23 is believed before the
/// data is seen.
const LIKELY: f64 = 0.3;

/// Warnings for an estimate; `far` are those of parameters far from what was believed, `hidden_rad` what the friction of
/// every elastic joint may hide in a stand.
pub(super) fn warnings(
    estimate: &SessionEstimate,
    inflations: &[Inflation],
    recorded: &Recorded,
    far: Vec<Warning>,
    hidden_rad: &[f64],
) -> Vec<Warning> {
    let joints = &estimate.joints;
    let mut out = Vec::new();
    if estimate.poses < 3 {
        out.push(Warning::FewPoses {
            poses: estimate.poses,
        });
    }
    for (joint, travel) in joints.iter().zip(travels(recorded)) {
        out.extend(of_torque_and_changes(joint, travel.deflection, recorded));
    }
    out.extend(stands_at_end(joints, recorded, hidden_rad));
    for (joint, inflation) in joints.iter().zip(inflations) {
        if inflation.creep_95_rad > 0.0 {
            out.push(Warning::RopeCreeps {
                joint: joint.name.clone(),
                half_width_95_rad: inflation.creep_95_rad,
            });
        }
    }
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

fn of_torque_and_changes(
    joint: &TendonEstimate,
    deflection_rad: f64,
    recorded: &Recorded,
) -> Vec<Warning> {
    let mut out = Vec::new();
    if joint.verdict == Verdict::CannotTell && deflection_rad < POOR_RAD {
        out.push(Warning::TorqueHardlyChanged {
            joint: joint.name.clone(),
            torque_nm: joint.torque_nm,
        });
    }
    let late = joint.changes.iter().filter(|c| may_end(c, recorded));
    out.extend(late.map(|change| Warning::ChangeMayEnd {
        joint: joint.name.clone(),
        time_s: change.time_s,
        before_end_s: recorded.end_s() - change.time_s,
    }));
    out
}

/// Where the arm stood until the end, and friction may hold more there than the interval says of the joint.
///
/// A joint that stands is held by up to its friction `F`, on either side, so a slip of up to `2 F/K` may move nothing.
fn stands_at_end(
    joints: &[TendonEstimate],
    recorded: &Recorded,
    hidden_rad: &[f64],
) -> Option<Warning> {
    /// A shorter stand at the end is usual, and a change so late is left to the next session anyway, s.
    const LONG_S: f64 = 5.0;
    let last = recorded.blocks.last()?;
    if last.stood_s < LONG_S {
        return None;
    }
    let own = recorded.elastic.iter().zip(joints).zip(hidden_rad);
    let worst = own
        // One that never slid is unknown anyway.
        .filter(|((i, _), _)| last.z_unknown[**i] < 0.5)
        .map(|((_, joint), hidden)| (joint, *hidden))
        .filter(|(joint, hidden)| *hidden > joint.offset_rad.half_width_95())
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let (joint, hidden_rad) = worst?;
    Some(Warning::StandsAtEnd {
        joint: joint.name.clone(),
        from_s: (recorded.end_s() - last.stood_s).max(0.0),
        hidden_rad,
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
