//! Warnings of an estimate: what was found, how it affects the result, and what to do.

use crate::format::{counted, newtons, plus_minus};
use crate::message::Message;
use crate::units::{in_units, of_joint};
use sinew_estimate::cable::CableLimit;
use sinew_estimate::session::{MotorTorqueError, SessionEstimate, Warning};
use sinew_estimate::{EstimateDocument, RecordingWarning};
use sinew_figure::{probability as format_probability, rounded, with_interval};
use sinew_files::date::day_of;
use sinew_log::StreamRole;
use sinew_model::Z95;
use sinew_model::offset::excess_residual::excess_residual_rad;

/// Returns the warnings of an estimate: of the recording, then of the session.
pub fn document_warnings(document: &EstimateDocument) -> Vec<Message> {
    let of_session = document.session.iter().flat_map(session_warnings);
    recording_warnings(document)
        .into_iter()
        .chain(of_session)
        .collect()
}

/// Returns the warnings of [`of_recording`] with the units of their joints.
pub(crate) fn recording_warnings(document: &EstimateDocument) -> Vec<Message> {
    let joints = &document.reading.joints;
    let slides = |joint: &str| joints.iter().any(|j| j.name == joint && j.slides);
    of_recording(document)
        .map(|w| {
            let units = of_joint(recording_joint(w).is_some_and(slides));
            // A warning of the reference recording keeps its own code.
            let coded = match w {
                RecordingWarning::Reference { warning } => warning,
                own => own,
            };
            Message::of(coded, in_units(&recording_warning(w), units))
        })
        .collect()
}

/// Returns the warnings of a session.
pub fn session_warnings(session: &SessionEstimate) -> Vec<Message> {
    let joints = &session.joints;
    let slides = |joint: &str| joints.iter().any(|j| j.name == joint && j.slides);
    let warnings = session.warnings.iter();
    warnings
        .map(|w| {
            let units = of_joint(session_joint(w).is_some_and(slides));
            Message::of(w, in_units(&session_warning(w), units))
        })
        .collect()
}

/// Joint of a warning whose text contains a value in the units of the joint.
fn recording_joint(warning: &RecordingWarning) -> Option<&str> {
    match warning {
        RecordingWarning::ImplausibleOffset { joint, .. }
        | RecordingWarning::TorqueRangeSmall { joint, .. } => Some(joint),
        _ => None,
    }
}

/// Joint of a warning whose text contains a value in the units of the joint.
fn session_joint(warning: &Warning) -> Option<&str> {
    match warning {
        Warning::TorqueRangeSmall { joint, .. }
        | Warning::AtRestAtEnd { joint, .. }
        | Warning::RestPhaseInconsistent { joint, .. }
        | Warning::RopeMemory { joint, .. }
        | Warning::TendonCreep { joint, .. }
        | Warning::UnexplainedResidual { joint, .. }
        | Warning::BeyondPretension { joint, .. }
        | Warning::JointSeized { joint, .. }
        | Warning::BeyondLimits { joint, .. }
        | Warning::MotorEncoderFrozen { joint, .. }
        | Warning::TemperatureUnknown { joint, .. }
        | Warning::ThermalEffect { joint, .. }
        | Warning::ReferenceInconsistent { joint, .. } => Some(joint),
        _ => None,
    }
}

/// Returns the warnings of the recording, without those that affect only the uncorrected estimate if there is an absolute one.
pub(crate) fn of_recording(document: &EstimateDocument) -> impl Iterator<Item = &RecordingWarning> {
    document.reading.warnings.iter().filter(|warning| {
        document.session.is_none() || !matches!(warning, RecordingWarning::TorqueRangeSmall { .. })
    })
}

/// Name of a stream of samples.
pub(crate) fn stream_name(role: StreamRole) -> &'static str {
    match role {
        StreamRole::BothSides => "recording",
        StreamRole::JointSide => "joint side",
        StreamRole::MotorSide => "motor side",
        StreamRole::ExternalTorque => "external torque",
        StreamRole::Tension => "tensions",
    }
}

/// Formats a warning of a recording.
pub fn recording_warning(warning: &RecordingWarning) -> String {
    match warning {
        RecordingWarning::Robot { text } | RecordingWarning::ImplausibleSignal { text } => {
            text.clone()
        }
        RecordingWarning::UnknownJoints { joints } => {
            let (noun, verb) = match joints.len() {
                1 => ("joint", "is"),
                _ => ("joints", "are"),
            };
            format!(
                "{noun} {} of the recording {verb} not in the robot description; ignored",
                quoted(joints)
            )
        }
        RecordingWarning::UnusedTensions { tendons } => format!(
            "tension of {} recorded but not used: robot.toml has no coupled tendon of that name; rename it with [tendons.NAME] in the mapping file (--mapping)",
            quoted(tendons)
        ),
        RecordingWarning::ImplausibleOffset { joint, offset_rad } => format!(
            "'{joint}': offset of {} mrad is implausible for a rope; check unit (degrees?), gear ratio, sign and zero of its positions",
            rounded(1e3 * offset_rad, 3)
        ),
        RecordingWarning::TorqueRangeSmall {
            joint,
            min_nm,
            max_nm,
        } => format!(
            "'{joint}': torque range {} to {} N·m is too small to separate offset from stiffness or mass error; record a motion that varies the gravity load",
            signed(*min_nm),
            signed(*max_nm)
        ),
        RecordingWarning::Damaged {
            offset,
            reason,
            bytes,
        } => format!(
            "file damaged at byte {offset} ({reason}); {bytes} bytes lost, earlier data used; check disk and recorder"
        ),
        RecordingWarning::Gaps { count, longest_s } => format!(
            "{}, longest {longest_s:.1} s; filters re-initialised after each; check queue and disk of the recorder",
            counted(*count, "gap")
        ),
        RecordingWarning::ClockJumps { count } => format!(
            "clock of the time stamps stepped {}; time continued over each step, filters re-initialised; use one clock, synchronised before recording",
            counted(*count, "time")
        ),
        RecordingWarning::OutOfOrder { count } => {
            format!("{} reordered by time stamp", counted(*count, "message"))
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
                (*repeated, "with duplicate time stamps excluded"),
            ];
            let lost = lost.iter().filter(|(count, _)| *count > 0);
            let lost = lost.map(|(count, what)| format!("{} {what}", counted(*count, "sample")));
            let lost = Vec::from_iter(lost).join(", ");
            format!(
                "{of}: {lost} ({:.1} %); check the network, the recorder queue and the source of the time stamps",
                100.0 * share
            )
        }
        RecordingWarning::SecondPublisher { stream, samples } => format!(
            "{}: {} of a second publisher excluded; stop the node that publishes the same joints on this topic (ros2 topic info --verbose)",
            stream_name(*stream),
            counted(*samples, "sample")
        ),
        RecordingWarning::NoTimeStamp { count } => format!(
            "{} without a time stamp, timed by the clock of the recorder; set header.stamp in the driver",
            counted(*count, "message")
        ),
        RecordingWarning::LateStart {
            quantity,
            joint,
            after_s,
        } => format!(
            "{quantity} of '{joint}' from {after_s:.1} s on; earlier frames excluded; start the driver before the recorder"
        ),
        RecordingWarning::NonFinite {
            quantity,
            joint,
            count,
        } => format!(
            "{quantity} of '{joint}': {count} NaN or infinite {} excluded; check the driver",
            if *count == 1 { "sample" } else { "samples" }
        ),
        RecordingWarning::Unwrapped {
            quantity,
            joint,
            count,
        } => format!(
            "{quantity} of '{joint}': {} corrected",
            counted(*count, "encoder wrap-around")
        ),
        RecordingWarning::Reference { warning } => {
            format!("reference recording: {}", recording_warning(warning))
        }
    }
}

/// Formats a warning of a session.
pub fn session_warning(warning: &Warning) -> String {
    match warning {
        Warning::FewPoses { poses } => format!(
            "{}: payload, mass error and offset are not separable; record at least 4 poses that change the torque of every joint",
            counted(*poses as u64, "distinct pose")
        ),
        Warning::FewPosesOfBaseline { poses } => format!(
            "baseline has {}: every later session inherits its uncertainty; record the baseline again with 12 poses over the range of every joint",
            counted(*poses as u64, "distinct pose")
        ),
        Warning::TorqueRangeSmall { joint, torque_nm } => format!(
            "{joint}: torque range {} to {} N·m is too small to separate offset from stiffness or payload; record poses that change the load of this joint",
            signed(torque_nm.min),
            signed(torque_nm.max)
        ),
        Warning::ChangeNearEnd {
            joint,
            time_s,
            before_end_s,
        } => format!(
            "{joint}: change at {time_s:.0} s is only {before_end_s:.0} s before the end; slip and ongoing contact are indistinguishable, the interval covers both; record at least 8 s more"
        ),
        Warning::AtRestAtEnd {
            joint,
            from_s,
            stiction_bound_rad,
        } => format!(
            "arm at rest from {from_s:.0} s to the end: stiction can hide a slip of up to {:.1} mrad at {joint}; end the recording with motion",
            1e3 * stiction_bound_rad
        ),
        Warning::RestPhaseInconsistent {
            joint,
            from_s,
            inconsistency_rad,
            stiction_bound_rad,
        } => format!(
            "{joint}: offset differs by {:.1} mrad in the final rest phase (from {from_s:.0} s); stiction explains at most {:.1} mrad; slip or ongoing contact, the interval covers both; continue the motion and record again",
            1e3 * inconsistency_rad,
            1e3 * stiction_bound_rad
        ),
        Warning::RopeMemory {
            joint,
            half_width_95_rad,
        } => format!(
            "{joint}: rope has a relaxation time of 30 s; unknown load history contributes ± {:.2} mrad; hold the arm still for 1 min before recording",
            1e3 * half_width_95_rad
        ),
        Warning::TendonCreep {
            joint,
            probability,
            drift_rad,
            duration_s,
        } => format!(
            "{joint}: offset drifted by {} mrad in {duration_s:.0} s (probability {}): creep after tensioning, or temperature; the value at the end is reported; record again after settling",
            plus_minus(*drift_rad, 1e3),
            format_probability(*probability)
        ),
        Warning::ExternalForce {
            probability,
            force_n,
        } => format!(
            "constant external force of {} N at the tool along x, y and z of the base (probability {}); estimated as a nuisance parameter; remove the cable, hose or balancer, or specify --external-force",
            newtons(*force_n),
            format_probability(*probability)
        ),
        Warning::UnexplainedResidual { joint, noise_rad } => format!(
            "{joint}: residual of {:.1} mrad not explained by the model{}; check gear ratio, axis, encoder zero (zero_mrad), clocks and rope viscosity",
            1e3 * noise_rad,
            if excess_residual_rad(*noise_rad) > 0.0 { "; interval widened accordingly" } else { "" }
        ),
        Warning::EncoderZeroOffset { joint, zero_rad } => format!(
            "{joint}: encoder zero offset of {} mrad is inconsistent with zero_mrad in robot.toml; estimate used; set zero_mrad, or zero the encoders on the slack rope and record the baseline again",
            plus_minus(*zero_rad, 1e3)
        ),
        Warning::NoJointEncoder { joint } => format!(
            "{joint}: joint position not recorded: elongation of its tendon not estimated, motor position used for the other joints; record the joint position"
        ),
        Warning::BeyondPretension {
            joint,
            torque_nm,
            limit_nm,
        } => format!(
            "{joint}: loop torque of up to {} N·m exceeds {} N·m (2 r f0): one strand slack, stiffness halved, not modelled; increase the pretension, or record a motion with lower torque",
            rounded(*torque_nm, 3),
            rounded(*limit_nm, 3)
        ),
        Warning::JointSeized {
            joint,
            from_s,
            joint_travel_rad,
            motor_travel_rad,
        } => format!(
            "{joint}: joint moved {:.1} mrad from {from_s:.1} s on while its motor moved {:.0} mrad: joint or joint encoder seized; inspect both",
            1e3 * joint_travel_rad,
            1e3 * motor_travel_rad
        ),
        Warning::BeyondLimits {
            joint,
            min_rad,
            max_rad,
            lower_rad,
            upper_rad,
            opposite_is_within,
        } => format!(
            "{joint}: positions of {} to {} mrad are beyond the limits of the URDF ({} to {} mrad){}; check sign, encoder zero, unit and joint of the channel, or the limits",
            signed_integer(1e3 * min_rad),
            signed_integer(1e3 * max_rad),
            signed_integer(1e3 * lower_rad),
            signed_integer(1e3 * upper_rad),
            match opposite_is_within {
                true => ", and within them with the opposite sign",
                false => "",
            }
        ),
        Warning::MotorEncoderFrozen {
            joint,
            from_s,
            motor_rad,
            joint_travel_rad,
        } => format!(
            "{joint}: motor position constant at {:.0} mrad from {from_s:.1} s on while the joint moved {:.0} mrad: motor encoder or its channel frozen; phase excluded; check encoder and driver",
            1e3 * motor_rad,
            1e3 * joint_travel_rad
        ),
        Warning::NegativePayload { payload_kg } => format!(
            "payload estimate {} kg is negative: tool lighter than described, or wrong unit or sign of the positions; check gripper mass, units and signs (sinew log info) before using the offsets",
            plus_minus(*payload_kg, 1.0)
        ),
        Warning::ExternalForceInconsistent { force_n } => format!(
            "external force specified with --external-force is inconsistent with the data: {}; estimate used; check its direction (base frame)",
            match force_n {
                Some(force_n) => format!("estimated {} N", newtons(*force_n)),
                None => "no force detected".into(),
            }
        ),
        Warning::PayloadInconsistent {
            payload_kg,
            probability,
        } => format!(
            "specified payload is inconsistent with the data (probability {}): estimated {} kg; estimate used; check the gripper",
            format_probability(*probability),
            plus_minus(*payload_kg, 1.0)
        ),
        Warning::UnmodelledInterval { from_s, to_s } => format!(
            "{from_s:.0} to {to_s:.0} s is inconsistent with the model (ongoing contact or unmodelled effect); excluded; check what happened in this interval"
        ),
        Warning::MuchRejected { share } => format!(
            "{:.0} % of the time rejected as disturbance: the robot probably differs from its description by more than the tolerances; check the masses, or record a new baseline",
            100.0 * share
        ),
        Warning::NoBaseline => {
            "no baseline: offsets refer to the encoder zero and the interval relies on data-sheet tolerances; record a baseline directly after tensioning (sinew baseline LOG --out FILE) for an interval up to 4 times narrower"
                .into()
        }
        Warning::TemperatureUnknown {
            std_k,
            joint,
            half_width_95_rad,
        } => format!(
            "temperature of recording or baseline unknown: change assumed 0 ± {:.0} K (95 %), contributes ± {} mrad at {joint}; record it, or specify --temperature",
            Z95 * std_k,
            rounded(1e3 * half_width_95_rad, 2)
        ),
        Warning::ThermalEffect {
            joint,
            temperature_difference_k,
            half_width_95_rad,
            frame_is_specified,
        } => format!(
            "{} K {} the baseline: thermal effect contributes ± {} mrad at {joint}; {}",
            rounded(temperature_difference_k.abs(), 1),
            if *temperature_difference_k > 0.0 { "above" } else { "below" },
            rounded(1e3 * half_width_95_rad, 2),
            if *frame_is_specified {
                "record at a comparable temperature, or record a baseline at this one"
            } else {
                "set frame_expansion_per_k in robot.toml, or record at a comparable temperature"
            }
        ),
        Warning::ReferenceInconsistent {
            joint,
            by_push_rad,
            by_motion_rad,
        } => format!(
            "{joint}: offset by stop contact ({} mrad) and by motion ({} mrad) disagree: stop moved, obstacle, wrong mass or payload; the interval covers both; inspect the stop and check the payload",
            plus_minus(*by_push_rad, 1e3),
            plus_minus(*by_motion_rad, 1e3)
        ),
        Warning::EncoderDelay { motor_delay_s } => format!(
            "motor encoder {} by {} ms relative to the joint encoder, or friction differs from robot.toml; the interval covers it; stamp both encoders at the sensor",
            if motor_delay_s.mean > 0.0 { "delayed" } else { "early" },
            with_interval(1e3 * motor_delay_s.mean.abs(), 1e3 * motor_delay_s.std)
        ),
        Warning::MotorTorqueRejected { joint, fault } => match fault {
            MotorTorqueError::Constant => {
                format!("{joint}: motor torque is constant; not used; check the channel")
            }
            MotorTorqueError::Contradicts { slope } => format!(
                "{joint}: motor torque is {} % of the spring torque (expected 100 %); not used; check {}unit, torque constant and gear ratio",
                rounded(100.0 * slope, 2),
                match *slope < 0.0 {
                    true => "the sign of the torque and that of both positions, ",
                    false => "",
                }
            ),
            MotorTorqueError::NegativeWork { work_j } => format!(
                "{joint}: motor torque does a work of {} J over the recording (a drive with friction does positive work); not used; check the sign of the torque and that of both positions",
                rounded(*work_j, 2)
            ),
            MotorTorqueError::Untested => format!(
                "{joint}: motor torque cannot be verified, and that of another joint is inconsistent with its spring; not used"
            ),
        },
        Warning::TensionRejected { joint, fault } => match fault {
            MotorTorqueError::Constant => {
                format!("{joint}: tension is constant; not used; check the sensor")
            }
            MotorTorqueError::Contradicts { slope } => format!(
                "{joint}: tension is {} % of the tension expected from the extension (expected 100 %); not used; check unit (N), sign and tendon of the sensor",
                rounded(100.0 * slope, 2)
            ),
            MotorTorqueError::NegativeWork { .. } => {
                format!("{joint}: tension does negative work; not used; check its sign")
            }
            MotorTorqueError::Untested => format!(
                "{joint}: tension cannot be verified, and that of another tendon is inconsistent with its extension; not used"
            ),
        },
        Warning::CableInconclusive { joint, reason } => {
            format!("{joint}: {}", cable_limit(*reason))
        }
        Warning::FarFromPrior {
            joint,
            name,
            is_motor_torque_scale,
            stds,
        } => format!(
            "{}{name}: {stds:.1} σ from its prior; {}",
            joint.as_ref().map_or(String::new(), |joint| format!("{joint}: ")),
            match is_motor_torque_scale {
                true => {
                    "check unit, torque constant and gear ratio of the recorded torque or current, or the tolerance in robot.toml"
                }
                false => "check the value in robot.toml, or its tolerance",
            }
        ),
        Warning::FramesIncomplete { frames } => format!(
            "{} excluded: a position is missing; check the channels with sinew log info",
            counted(*frames, "frame")
        ),
        Warning::StiffnessChanged {
            joint,
            probability,
            change_ratio,
        } => {
            let lower = change_ratio.mean < 0.0;
            format!(
                "{joint}: stiffness {:.1} ± {:.1} % {} the prior before this recording (probability {}){}",
                100.0 * change_ratio.mean.abs(),
                100.0 * change_ratio.half_width_95(),
                if lower { "below" } else { "above" },
                format_probability(*probability),
                if lower { ": strands may have failed; inspect the rope" } else { "" },
            )
        }
        Warning::DateInconsistent {
            recorded_utc_s,
            specified_utc_s,
        } => format!(
            "date {} specified, but the clock of the recording starts on {}; the specified date is used: remove --date if the clock is right",
            day_of(*specified_utc_s),
            day_of(*recorded_utc_s)
        ),
    }
}

/// Formats a whole number with a typographic minus.
fn signed_integer(value: f64) -> String {
    format!("{value:.0}").replace('-', "−")
}

/// Formats a torque with two decimals and a typographic minus.
fn signed(value: f64) -> String {
    format!("{value:.2}").replace('-', "−")
}

/// Formats at most a dozen names in quotes and the number of the others.
fn quoted(names: &[String]) -> String {
    const MAX_NAMES: usize = 12;
    let shown = names.iter().take(MAX_NAMES).map(|n| format!("'{n}'"));
    let text = shown.collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MAX_NAMES) {
        0 => text,
        more => format!("{text} and {more} more"),
    }
}

/// States why the elongation of a tendon with friction along its path is inconclusive.
fn cable_limit(reason: CableLimit) -> String {
    let interval = |[low, high]: [f64; 2]| format!("{} to {}", rounded(low, 3), rounded(high, 3));
    match reason {
        CableLimit::NoBaseline => "friction along the path of the tendon is not separable from elongation without a baseline of this joint; create one with sinew baseline from recordings of at least two loads".into(),
        CableLimit::OneLoad {
            learned_nm,
            load_nm,
        } => format!(
            "load {} N·m, but the baseline contains only {} N·m, which does not determine the compliance of the tendon; add a recording at {} N·m to the baseline",
            rounded(load_nm, 3),
            interval(learned_nm),
            rounded(load_nm, 3)
        ),
        CableLimit::Load {
            learned_nm,
            load_nm,
        } => format!(
            "load {} N·m is outside the loads of the baseline ({} N·m); add a recording at {} N·m to the baseline",
            rounded(load_nm, 3),
            interval(learned_nm),
            rounded(load_nm, 3)
        ),
        CableLimit::Range {
            learned_rad,
            range_rad,
        } => format!(
            "positions {} rad are outside those of the baseline ({} rad); add a recording over this range to the baseline",
            interval(range_rad),
            interval(learned_rad)
        ),
        CableLimit::Reversals { reversals } => format!(
            "{}, expected at least 2: friction along the path of the tendon is not separable from elongation; record motion to and fro",
            counted(reversals as u64, "complete reversal")
        ),
    }
}
