//! Warnings in words.

use crate::units::{in_units, of_joint};
use crate::words::{newtons, plus_minus};
use sinew_estimate::session::{SessionEstimate, Warning, WitnessFault};
use sinew_estimate::{EstimateDocument, RecordingWarning};
use sinew_figure::{rounded, with_interval};
use sinew_log::StreamRole;
use sinew_model::Z95;
use sinew_model::offset::misfit::misfit_rad;

/// What the reader of an estimate should know, a sentence each.
pub fn document_warnings(document: &EstimateDocument) -> Vec<String> {
    let of_session = document.session.iter().flat_map(session_warnings);
    reading_warnings(document)
        .into_iter()
        .chain(of_session)
        .collect()
}

/// Those of [`of_reading`] in words.
pub(crate) fn reading_warnings(document: &EstimateDocument) -> Vec<String> {
    let joints = &document.reading.joints;
    let slides = |joint: &str| joints.iter().any(|j| j.name == joint && j.slides);
    of_reading(document)
        .map(|w| {
            in_units(
                &recording_warning(w),
                of_joint(recording_joint(w).is_some_and(slides)),
            )
        })
        .collect()
}

/// What the reader of a session should know, a sentence each.
pub fn session_warnings(session: &SessionEstimate) -> Vec<String> {
    let joints = &session.joints;
    let slides = |joint: &str| joints.iter().any(|j| j.name == joint && j.slides);
    let warnings = session.warnings.iter();
    warnings
        .map(|w| {
            in_units(
                &session_warning(w),
                of_joint(session_joint(w).is_some_and(slides)),
            )
        })
        .collect()
}

/// The joint that a warning with a size is about.
fn recording_joint(warning: &RecordingWarning) -> Option<&str> {
    match warning {
        RecordingWarning::ImplausibleOffset { joint, .. }
        | RecordingWarning::TorqueHardlyChanges { joint, .. } => Some(joint),
        _ => None,
    }
}

/// The joint that a warning with a size is about.
fn session_joint(warning: &Warning) -> Option<&str> {
    match warning {
        Warning::TorqueHardlyChanged { joint, .. }
        | Warning::StandsAtEnd { joint, .. }
        | Warning::StandReadsOff { joint, .. }
        | Warning::RopeCreeps { joint, .. }
        | Warning::TendonCreeps { joint, .. }
        | Warning::Unexplained { joint, .. }
        | Warning::BeyondPretension { joint, .. }
        | Warning::Stuck { joint, .. }
        | Warning::TemperatureUnknown { joint, .. }
        | Warning::DriftUnknown { joint, .. }
        | Warning::AnchorDisagrees { joint, .. } => Some(joint),
        _ => None,
    }
}

/// Warnings of the recording; what only the paper's reading rests on is left out where the absolute method answers.
pub(crate) fn of_reading(document: &EstimateDocument) -> impl Iterator<Item = &RecordingWarning> {
    document.reading.warnings.iter().filter(|warning| {
        document.session.is_none()
            || !matches!(warning, RecordingWarning::TorqueHardlyChanges { .. })
    })
}

/// A stream of samples in words.
pub(crate) fn stream_name(role: StreamRole) -> &'static str {
    match role {
        StreamRole::BothSides => "the recording",
        StreamRole::JointSide => "the joint side",
        StreamRole::MotorSide => "the motor side",
        StreamRole::ExternalTorque => "the external torque",
    }
}

/// What the reader of a recording's estimate should know, in a sentence.
pub fn recording_warning(warning: &RecordingWarning) -> String {
    match warning {
        RecordingWarning::Robot { text } | RecordingWarning::Suspicion { text } => text.clone(),
        RecordingWarning::UnknownJoints { joints } => format!(
            "joint {} of the recording is not in the robot and was left out",
            quoted(joints)
        ),
        RecordingWarning::ImplausibleOffset { joint, offset_rad } => format!(
            "joint '{joint}': an offset of {} mrad is no stretch of a rope; check units (degrees?), gear ratio, sign and zero of its positions",
            rounded(1e3 * offset_rad, 3)
        ),
        RecordingWarning::TorqueHardlyChanges {
            joint,
            min_nm,
            max_nm,
        } => format!(
            "joint '{joint}': its torque hardly changes ({min_nm:.2} to {max_nm:.2} N·m); a wrong stiffness or mass can't be told from stretch in this recording"
        ),
        RecordingWarning::Damaged {
            offset,
            reason,
            bytes,
        } => format!(
            "the file is damaged at byte {offset}: {reason}; {bytes} bytes lost, everything before was used"
        ),
        RecordingWarning::Gaps { count, longest_s } => format!(
            "{} in the recording, the longest {longest_s:.1} s; the observer started anew after each",
            counted(*count, "gap")
        ),
        RecordingWarning::ClockJumps { count } => format!(
            "the clock went back {}; the observer started anew after each",
            counted(*count, "time")
        ),
        RecordingWarning::OutOfOrder { count } => {
            format!(
                "{} came out of order, sorted in",
                counted(*count, "message")
            )
        }
        RecordingWarning::SamplesLost {
            stream,
            missing,
            repeated,
            share,
        } => {
            let of = stream_name(*stream);
            let lost = [
                (*missing, "missing"),
                (*repeated, "dropped, their stamp was there already"),
            ];
            let lost = lost.iter().filter(|(count, _)| *count > 0);
            let lost = lost.map(|(count, what)| format!("{} {what}", counted(*count, "sample")));
            let lost = Vec::from_iter(lost).join(", ");
            format!(
                "{of}: {lost} ({:.1} %); look at the network, the recorder's queue, and who stamps",
                100.0 * share
            )
        }
        RecordingWarning::NonFinite {
            quantity,
            joint,
            count,
        } => format!(
            "{quantity} of '{joint}' is NaN or infinite in {}, left out",
            counted(*count, "sample")
        ),
        RecordingWarning::Unwrapped {
            quantity,
            joint,
            count,
        } => format!(
            "{quantity} of '{joint}' wrapped around {} and was unwrapped",
            counted(*count, "time")
        ),
        RecordingWarning::Reference { warning } => {
            format!("reference: {}", recording_warning(warning))
        }
    }
}

/// What the reader of a session's estimate should know, in a sentence.
pub fn session_warning(warning: &Warning) -> String {
    match warning {
        Warning::FewPoses { poses } => format!(
            "only {poses} distinct pose(s): a payload or a wrong mass can't be told from stretch; three or four poses that change every joint's torque would help"
        ),
        Warning::FewPosesOfBaseline { poses } => format!(
            "only {poses} distinct poses: a baseline of few poses spoils what is compared with it; move every joint through its range in a dozen poses"
        ),
        Warning::TorqueHardlyChanged { joint, torque_nm } => format!(
            "{joint}: its torque hardly changed ({:.2} to {:.2} N·m), so stretch can't be told from a wrong stiffness or payload; poses that load it differently would help",
            torque_nm.min, torque_nm.max
        ),
        Warning::ChangeMayEnd {
            joint,
            time_s,
            before_end_s,
        } => format!(
            "{joint}: the change at {time_s:.0} s came {before_end_s:.0} s before the end; a contact that lasts looks the same, so the interval holds both"
        ),
        Warning::StandsAtEnd {
            joint,
            from_s,
            hidden_rad,
        } => format!(
            "the arm stands from {from_s:.0} s to the end: friction may hide a slip there, at {joint} one of up to {:.1} mrad; the next motion shows it",
            1e3 * hidden_rad
        ),
        Warning::StandReadsOff {
            joint,
            from_s,
            off_rad,
            hidden_rad,
        } => format!(
            "{joint}: it reads {:.1} mrad off where the arm stands, from {from_s:.0} s to the end; friction holds {:.1} mrad at most. A slip or a contact that lasts: the interval holds both, and the next motion shows which",
            1e3 * off_rad,
            1e3 * hidden_rad
        ),
        Warning::RopeCreeps {
            joint,
            half_width_95_rad,
        } => format!(
            "{joint}: its rope follows its load for half a minute; what it carried before the recordings isn't known, which is {:.2} mrad of the interval",
            1e3 * half_width_95_rad
        ),
        Warning::TendonCreeps {
            joint,
            probability,
            moved_rad,
            duration_s,
        } => format!(
            "{joint}: its offset moved by {} mrad in {duration_s:.0} s ({:.0} % likely): a rope that creeps, as after tensioning, or that warms. The offset is that at the end; record again later to see whether it settles",
            plus_minus(*moved_rad, 1e3),
            100.0 * probability
        ),
        Warning::ExternalForce {
            probability,
            force_n,
        } => format!(
            "a constant force from outside acts on the arm ({:.0} % likely): at the tool {} N along x, y and z of the base. It is estimated along; a cable that drags, a hose or a spring balancer does that. Take it off, or state it with --external-force-n",
            100.0 * probability,
            newtons(*force_n)
        ),
        Warning::Unexplained { joint, noise_rad } => format!(
            "{joint}: {:.1} mrad of the reading fits nothing{}: a gear ratio, an axis, the encoders' zero (zero_mrad), the clock between them or a viscoelastic rope may differ from the description",
            1e3 * noise_rad,
            if misfit_rad(*noise_rad) > 0.0 { ", and the interval is wider by that" } else { "" }
        ),
        Warning::NotZeroed { joint, zero_rad } => format!(
            "{joint}: its encoders were not zeroed on the unloaded rope, as zero_mrad in robot.toml says they were: they read {} mrad there. The zero was estimated instead; state zero_mrad",
            plus_minus(*zero_rad, 1e3)
        ),
        Warning::NoJointEncoder { joint } => format!(
            "{joint}: its position is not recorded, so the elongation of its tendon cannot be estimated. The position of its motor stands in for the estimate of the other joints"
        ),
        Warning::BeyondPretension {
            joint,
            torque_nm,
            limit_nm,
        } => format!(
            "{joint}: the loop carried up to {} N·m. Beyond {} N·m, 2 r f0, one of its strands is slack and the loop half as stiff, which the estimate does not model. Increase the pretension, or record a motion with lower torque",
            rounded(*torque_nm, 3),
            rounded(*limit_nm, 3)
        ),
        Warning::Stuck {
            joint,
            joint_travel_rad,
            motor_travel_rad,
        } => format!(
            "{joint}: the joint moved {:.1} mrad while its motor turned {:.0}: stuck, or its encoder is",
            1e3 * joint_travel_rad,
            1e3 * motor_travel_rad
        ),
        Warning::NegativePayload { payload_kg } => format!(
            "payload {} kg: nothing weighs less than nothing. The tool may be lighter than robot.toml or the baseline say, or positions may be in another unit or direction: look at the gripper and at sinew log info before believing the offsets",
            plus_minus(*payload_kg, 1.0)
        ),
        Warning::ExternalForceContradicted { force_n } => format!(
            "the recording contradicts the force that was stated with --external-force-n: {}; what it shows was used. Look at its direction (base axes) and at what pulls",
            match force_n {
                Some(force_n) => format!("it shows {} N", newtons(*force_n)),
                None => "it shows none".into(),
            }
        ),
        Warning::PayloadContradicted { payload_kg } => format!(
            "the recording contradicts the payload that was stated: it shows {} kg, and that was used; look at the gripper",
            plus_minus(*payload_kg, 1.0)
        ),
        Warning::NothingFits { from_s, to_s } => format!(
            "from {from_s:.0} to {to_s:.0} s nothing fits: a contact that lasts, or a change this method doesn't know; nothing was learned there"
        ),
        Warning::MuchLeftOut { share } => format!(
            "{:.0} % of the time was left out as disturbed: the robot may differ from its description in a way no tolerance covers",
            100.0 * share
        ),
        Warning::NoBaseline => {
            "without a baseline the offsets are against the encoders' zero and rest on data-sheet tolerances; a baseline right after tensioning (sinew baseline) makes the interval up to four times narrower"
                .into()
        }
        Warning::TemperatureUnknown {
            deviation_k,
            joint,
            half_width_95_rad,
        } => format!(
            "the temperature is not known here, in the baseline or in both: its change is taken as 0 ± {:.0} K (95 %), which is {} mrad of the interval at {joint}; record it, or state it with --temperature-c",
            Z95 * deviation_k,
            rounded(1e3 * half_width_95_rad, 2)
        ),
        Warning::DriftUnknown {
            joint,
            warmer_k,
            half_width_95_rad,
            frame_is_stated,
        } => format!(
            "{} K {} than the baseline: what that does to rope and frame is {} mrad of the interval at {joint}; {}",
            rounded(warmer_k.abs(), 1),
            if *warmer_k > 0.0 { "warmer" } else { "colder" },
            rounded(1e3 * half_width_95_rad, 2),
            if *frame_is_stated {
                "compare at like temperatures, or learn a baseline at this one"
            } else {
                "state frame_expansion_per_k in robot.toml, or compare at like temperatures"
            }
        ),
        Warning::AnchorDisagrees {
            joint,
            by_push_rad,
            by_motion_rad,
        } => format!(
            "{joint}: pushed against its stop its tendon shows {} mrad, by its motion {} mrad: the stop has moved or gives, something else was in the way, or masses or payload are wrong; the interval holds both",
            plus_minus(*by_push_rad, 1e3),
            plus_minus(*by_motion_rad, 1e3)
        ),
        Warning::SidesOutOfStep { motor_late_s } => format!(
            "the motor side looks {} ms {} against the joint side, or friction is that far from robot.toml: the interval holds it; stamp both sides where they are read",
            with_interval(1e3 * motor_late_s.mean.abs(), 1e3 * motor_late_s.deviation),
            if motor_late_s.mean > 0.0 { "late" } else { "early" }
        ),
        Warning::MotorTorqueLeftOut { joint, fault } => match fault {
            WitnessFault::Constant => {
                format!("{joint}: its motor torque never changes: it measures nothing and was left out")
            }
            WitnessFault::Contradicts { slope } => format!(
                "{joint}: its motor torque is {} times what the spring carries, where 1 is right: it was left out; check its sign, unit, torque constant and gear ratio",
                rounded(*slope, 2)
            ),
            WitnessFault::Untested => format!(
                "{joint}: its motor torque was left out too: another joint's contradicts its spring, and this one's can't be tested"
            ),
        },
        Warning::FarFromPrior {
            joint,
            name,
            is_motor_torque_scale,
            deviations,
        } => format!(
            "{} {name}: {deviations:.2} standard deviations from what was believed; {}",
            joint.as_deref().unwrap_or(""),
            match is_motor_torque_scale {
                true => {
                    "check the recorded torque's or current's unit, constant and gear ratio, or the tolerance in robot.toml"
                }
                false => "check robot.toml or its tolerance",
            }
        ),
        Warning::FramesMissing { frames } => {
            format!("{frames} frames without every position were left out")
        }
        Warning::StiffnessChangedBefore {
            joint,
            probability,
            change_ratio,
        } => {
            /// From here on it is said to have changed.
            const SURELY: f64 = 0.95;
            let lower = change_ratio.mean < 0.0;
            format!(
                "{joint}: stiffness {} {:.1} ± {:.1} % {} than what was known before this recording (probability {probability:.2}){}",
                if *probability > SURELY { "is" } else { "may be" },
                100.0 * change_ratio.mean.abs(),
                100.0 * change_ratio.half_width_95(),
                if lower { "lower" } else { "higher" },
                if lower { "; strands may have failed" } else { "" },
            )
        }
    }
}

/// "1 gap", "3 gaps".
fn counted(number: u64, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// Names in quotes, the first dozen of them.
fn quoted(names: &[String]) -> String {
    const SHOWN: usize = 12;
    let shown = names.iter().take(SHOWN).map(|n| format!("'{n}'"));
    let text = shown.collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => text,
        more => format!("{text} and {more} more"),
    }
}
