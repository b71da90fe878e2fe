//! What the reader of an answer should know.

use super::answer::Absolute;
use super::blocks::Recorded;
use super::doubt::{Doubt, LASTING_S, may_end};
use sinew_figure::rounded;

/// Less change of torque than this, of the spring's deflection, leaves stiffness and offset one, mrad.
const POOR_MRAD: f64 = 10.0;
/// More than this left unexplained is more than encoders and friction do, mrad.
const NOISY_MRAD: f64 = 1.0;
/// A joint that moved less than this while its motor turned ten times as far is stuck, mrad.
const STUCK_MRAD: f64 = 5.0;
/// A payload so many half intervals below nothing is none.
const LIGHTER: f64 = 2.0;
/// A share left out above this makes what is left suspect.
const MUCH: f64 = 0.35;

/// Warnings for an answer.
pub(super) fn warnings(said: &Absolute, doubts: &[Doubt], recorded: &Recorded) -> Vec<String> {
    let mut out = Vec::new();
    if said.poses < 3 {
        out.push(format!(
            "only {} distinct pose(s): a payload or a wrong mass can't be told from stretch; three or four poses that change every joint's torque would help",
            said.poses
        ));
    }
    for (joint, range) in said.joints.iter().zip(deflections(said, recorded)) {
        if joint.verdict == "can't tell" && range < POOR_MRAD {
            out.push(format!(
                "{}: its torque hardly changed ({:.2} to {:.2} N·m), so stretch can't be told from a wrong stiffness or payload; poses that load it differently would help",
                joint.name, joint.torque_range_nm[0], joint.torque_range_nm[1]
            ));
        }
        for step in joint.steps.iter().filter(|s| may_end(s, recorded)) {
            out.push(format!(
                "{}: the change at {:.0} s came {:.0} s before the end; a contact that lasts looks the same, so the interval holds both",
                joint.name,
                step.time_s,
                recorded.end_s() - step.time_s
            ));
        }
    }
    for (joint, doubt) in said.joints.iter().zip(doubts) {
        if doubt.creeping_mrad > 0.0 {
            out.push(format!(
                "{}: its rope follows its load for half a minute; what it carried before the recordings isn't known, which is {:.2} mrad of the interval",
                joint.name, doubt.creeping_mrad
            ));
        }
    }
    for (joint, noise) in said.joints.iter().zip(&said.noise_mrad) {
        if *noise > NOISY_MRAD {
            out.push(format!(
                "{}: {noise:.1} mrad of the reading fits nothing: a gear ratio, an axis, the encoders' zero (zero_mrad), the clock between them or a viscoelastic rope may differ from the description",
                joint.name
            ));
        }
    }
    for (joint, (q, theta)) in said.joints.iter().zip(travel(recorded)) {
        if q < STUCK_MRAD && theta > 10.0 * q.max(1.0) {
            out.push(format!(
                "{}: the joint moved {q:.1} mrad while its motor turned {theta:.0}: stuck, or its encoder is",
                joint.name
            ));
        }
    }
    let [payload_kg, interval_kg] = said.payload_kg;
    if payload_kg + LIGHTER * interval_kg < 0.0 {
        out.push(format!(
            "payload {} ± {} kg: nothing weighs less than nothing. The tool may be lighter than robot.toml or the baseline say, or positions may be in another unit or direction: look at the gripper and at sinew log info before believing the offsets",
            rounded(payload_kg, 2),
            rounded(interval_kg, 2)
        ));
    }
    for left in said
        .left_out
        .iter()
        .filter(|l| l.to_s - l.from_s > LASTING_S)
    {
        out.push(format!(
            "from {:.0} to {:.0} s nothing fits: a contact that lasts, or a change this method doesn't know; nothing was learned there",
            left.from_s, left.to_s
        ));
    }
    if said.left_out_share > MUCH {
        out.push(format!(
            "{:.0} % of the time was left out as disturbed: the robot may differ from its description in a way no tolerance covers",
            100.0 * said.left_out_share
        ));
    }
    if said.baseline.is_none() {
        out.push(
            "without a baseline the offsets are against the encoders' zero and rest on data-sheet tolerances"
                .into(),
        );
    }
    for moved in &said.nuisance {
        let [before, deviation] = moved.prior;
        let off = (moved.posterior[0] - before).abs() / deviation;
        if off > 3.5 {
            // How a torque is scaled is no matter of robot.toml alone.
            let check = match moved.name.as_str() {
                "motor torque scale" => {
                    "check the recorded torque's or current's unit, constant and gear ratio, or the tolerance in robot.toml"
                }
                _ => "check robot.toml or its tolerance",
            };
            out.push(format!(
                "{} {}: {:.2} standard deviations from what was believed; {check}",
                moved.joint, moved.name, off
            ));
        }
    }
    if recorded.frames_missing > 0 {
        out.push(format!(
            "{} frames without every position were left out",
            recorded.frames_missing
        ));
    }
    out
}

/// How far every elastic joint and its motor moved, mrad.
fn travel(recorded: &Recorded) -> Vec<(f64, f64)> {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        1e3 * (most - least)
    };
    recorded
        .elastic
        .iter()
        .map(|&i| {
            let blocks = || recorded.blocks.iter();
            (
                range(&mut blocks().map(|b| b.turned[i])),
                range(&mut blocks().map(|b| b.turned[i] + b.y[i])),
            )
        })
        .collect()
}

/// Range of every elastic joint's deflection, mrad.
fn deflections(said: &Absolute, recorded: &Recorded) -> Vec<f64> {
    let elastic = &recorded.elastic;
    debug_assert_eq!(elastic.len(), said.joints.len());
    elastic
        .iter()
        .map(|&i| {
            let y = recorded.blocks.iter().map(|b| b.y[i]);
            let (least, most) = y.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| {
                (a.min(y), b.max(y))
            });
            1e3 * (most - least)
        })
        .collect()
}
