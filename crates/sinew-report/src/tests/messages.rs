//! Golden list of all warnings, notes and verdicts with example values.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-report messages` rewrites `tests/golden/messages.txt`.

use super::{made_up, of_strands, with_difference};
use crate::message::Message;
use crate::session::messages as session;
use crate::trend::messages as trend;
use crate::trend::survival;
use crate::trend::survival::messages as lifetimes;
use crate::{creep, diagnostics, robot, rope, tables, uncorrected, warnings};
use sinew_creep::{
    Artefact, ConditionSource, ForecastConditions, NotIdentifiable, NotIdentifiableReason,
    StrainZero,
};
use sinew_estimate::cable::CableLimit;
use sinew_estimate::replay::{JointError, LossReason};
use sinew_estimate::robot_check::{Finding, FindingKind, Location, RangeCheck, Severity, UnitHint};
use sinew_estimate::session::*;
use sinew_estimate::{Cause, RecordingWarning, UnknownCause};
use sinew_figure::probability;
use sinew_log::StreamRole;
use sinew_model::offset::ForceEstimate;
use sinew_model::transmission::AnchorKind;
use sinew_model::{Bounded, Gaussian, Interval95};
use sinew_rope::law::validity::LimitViolation;
use sinew_rope::select::Rejection;
use sinew_rope::{BreakCause, Caution, Namesake, RopeLifetime, RopeTermination};
use sinew_trend::survival::{
    AgeReplacement, AgeUnit, FittedWeibull, LifeForecast, LifeQuantile, ReplacementVerdict,
    SurvivalGroup, SurvivalNote,
};
use sinew_trend::{
    JointTrend, LifeNotUsed, Limit, LimitForecast, MissingFromRobot, PriorBasis, StepCause,
    SuspectedStep, TrendEvent, TrendEventKind, TrendNote, TrendVerdict,
};
use std::path::Path;

/// Path of the list.
const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/messages.txt");

const ELBOW: &str = "elbow";
const MAY_2026_S: f64 = 1_777_939_200.0;
const DAY_S: f64 = 86_400.0;

/// List with headings.
#[derive(Default)]
struct List(String);

impl List {
    fn section(&mut self, heading: &str) {
        let space = if self.0.is_empty() { "" } else { "\n" };
        self.0 += &format!("{space}# {heading}\n\n");
    }

    fn line(&mut self, text: impl AsRef<str>) {
        self.0 += &format!("{}\n", text.as_ref());
    }

    fn warning(&mut self, message: &Message) {
        self.line(format!("warning{}", message.tag()));
    }

    fn note(&mut self, message: &Message) {
        self.line(format!("note{}", message.tag()));
    }
}

/// Gaussian in thousandths, with the half-width of its 95 % interval.
fn milli(mean: f64, half_width: f64) -> Gaussian {
    Gaussian::new(1e-3 * mean, 1e-3 * half_width / sinew_model::Z95)
}

fn plain(mean: f64, half_width: f64) -> Gaussian {
    Gaussian::new(mean, half_width / sinew_model::Z95)
}

#[test]
fn messages_match_golden() {
    let mut list = List::default();
    recording_warnings(&mut list);
    session_warnings(&mut list);
    verdicts(&mut list);
    session_results(&mut list);
    uncorrected_results(&mut list);
    trend_results(&mut list);
    lifetime_results(&mut list);
    creep_results(&mut list);
    rope_results(&mut list);
    robot_results(&mut list);
    list.section("Probabilities");
    for p in [0.0, 0.0042, 0.5, 0.9849, 0.996, 1.0] {
        list.line(probability(p));
    }
    let path = Path::new(GOLDEN);
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("writable");
        std::fs::write(path, &list.0).expect("writable");
    }
    let golden = std::fs::read_to_string(path).unwrap_or_default();
    for (line, (found, expected)) in (1..).zip(list.0.lines().zip(golden.lines())) {
        assert_eq!(found, expected, "line {line}; rewrite with SINEW_WRITE=1");
    }
    assert_eq!(list.0, golden, "rewrite with SINEW_WRITE=1");
}

fn recording_warnings(list: &mut List) {
    list.section("Warnings: recording");
    let joint = || ELBOW.to_owned();
    let gaps = RecordingWarning::Gaps {
        count: 2,
        longest_s: 3.2,
    };
    let all = [
        RecordingWarning::Robot {
            text: "text of the robot description".into(),
        },
        RecordingWarning::ImplausibleSignal {
            text: "text of the signal check".into(),
        },
        RecordingWarning::UnknownJoints {
            joints: vec!["gripper".into()],
        },
        RecordingWarning::UnknownJoints {
            joints: vec!["gripper".into(), "tool".into()],
        },
        RecordingWarning::UnusedTensions {
            tendons: vec!["flexor".into()],
        },
        RecordingWarning::ImplausibleOffset {
            joint: joint(),
            offset_rad: 0.412,
        },
        RecordingWarning::TorqueRangeSmall {
            joint: joint(),
            min_nm: -0.12,
            max_nm: 0.31,
        },
        RecordingWarning::Damaged {
            offset: 1_048_576,
            reason: "unexpected end of file".into(),
            bytes: 2048,
        },
        gaps.clone(),
        RecordingWarning::ClockJumps { count: 1 },
        RecordingWarning::OutOfOrder { count: 12 },
        RecordingWarning::SamplesLost {
            stream: StreamRole::MotorSide,
            missing: 310,
            repeated: 4,
            share: 0.0521,
        },
        RecordingWarning::SecondPublisher {
            stream: StreamRole::JointSide,
            samples: 417,
        },
        RecordingWarning::LateStart {
            quantity: "q".into(),
            joint: joint(),
            after_s: 4.0,
        },
        RecordingWarning::NoTimeStamp { count: 1 },
        RecordingWarning::NonFinite {
            quantity: "theta".into(),
            joint: joint(),
            count: 3,
        },
        RecordingWarning::Unwrapped {
            quantity: "theta".into(),
            joint: joint(),
            count: 2,
        },
        RecordingWarning::Reference {
            warning: Box::new(gaps),
        },
    ];
    let mut document = super::paper_document(made_up());
    document.reading.warnings = all.into();
    for message in warnings::recording_warnings(&document) {
        list.warning(&message);
    }
    for role in [
        StreamRole::BothSides,
        StreamRole::JointSide,
        StreamRole::ExternalTorque,
        StreamRole::Tension,
    ] {
        list.line(format!("stream: {}", warnings::stream_name(role)));
    }
}

fn session_warnings(list: &mut List) {
    list.section("Warnings: session");
    let joint = || ELBOW.to_owned();
    let force_n = [plain(0.0, 0.4), plain(-0.12, 0.4), plain(4.9, 0.4)];
    let faults = [
        MotorTorqueError::Constant,
        MotorTorqueError::Contradicts { slope: 0.22 },
        MotorTorqueError::Contradicts { slope: -0.98 },
        MotorTorqueError::NegativeWork { work_j: -7.31 },
        MotorTorqueError::Untested,
    ];
    let mut all = vec![
        Warning::FewPoses { poses: 1 },
        Warning::FewPoses { poses: 2 },
        Warning::FewPosesOfBaseline { poses: 3 },
        Warning::TorqueRangeSmall {
            joint: joint(),
            torque_nm: TorqueRange {
                min: -0.12,
                max: 0.31,
            },
        },
        Warning::ChangeNearEnd {
            joint: joint(),
            time_s: 55.2,
            before_end_s: 4.8,
        },
        Warning::AtRestAtEnd {
            joint: joint(),
            from_s: 31.0,
            stiction_bound_rad: 5.1e-3,
        },
        Warning::RestPhaseInconsistent {
            joint: joint(),
            from_s: 31.0,
            inconsistency_rad: 8.3e-3,
            stiction_bound_rad: 5.1e-3,
        },
        Warning::RopeMemory {
            joint: joint(),
            half_width_95_rad: 0.42e-3,
        },
        Warning::TendonCreep {
            joint: joint(),
            probability: 0.97,
            drift_rad: milli(1.8, 0.4),
            duration_s: 60.0,
        },
        Warning::ExternalForce {
            probability: 0.9996,
            force_n,
        },
        Warning::UnexplainedResidual {
            joint: joint(),
            noise_rad: 0.6099,
        },
        Warning::EncoderZeroOffset {
            joint: joint(),
            zero_rad: milli(4.2, 0.9),
        },
        Warning::NoJointEncoder { joint: joint() },
        Warning::BeyondPretension {
            joint: joint(),
            torque_nm: 3.12,
            limit_nm: 2.4,
        },
        Warning::JointSeized {
            joint: joint(),
            from_s: 12.0,
            joint_travel_rad: 1.2e-3,
            motor_travel_rad: 0.412,
        },
        Warning::BeyondLimits {
            joint: joint(),
            min_rad: -1.7,
            max_rad: 0.02,
            lower_rad: -0.3,
            upper_rad: 2.4,
            opposite_is_within: true,
        },
        Warning::BeyondLimits {
            joint: joint(),
            min_rad: 0.1,
            max_rad: 3.1,
            lower_rad: -0.3,
            upper_rad: 2.4,
            opposite_is_within: false,
        },
        Warning::MotorEncoderFrozen {
            joint: joint(),
            from_s: 27.2,
            motor_rad: 1.517,
            joint_travel_rad: 1.62,
        },
        Warning::NegativePayload {
            payload_kg: plain(-0.3, 0.1),
        },
        Warning::PayloadInconsistent {
            payload_kg: plain(0.52, 0.04),
            probability: 0.99,
        },
        Warning::ExternalForceInconsistent {
            force_n: Some(force_n),
        },
        Warning::ExternalForceInconsistent { force_n: None },
        Warning::UnmodelledInterval {
            from_s: 12.0,
            to_s: 20.0,
        },
        Warning::MuchRejected { share: 0.46 },
        Warning::NoBaseline,
        Warning::TemperatureUnknown {
            std_k: 7.0,
            joint: joint(),
            half_width_95_rad: 1.4e-3,
        },
    ];
    all.extend(
        [(8.2, false), (-8.2, true)].map(|(kelvin, is_specified)| Warning::ThermalEffect {
            joint: joint(),
            temperature_difference_k: kelvin,
            half_width_95_rad: 0.9e-3,
            frame_is_specified: is_specified,
        }),
    );
    all.push(Warning::ReferenceInconsistent {
        joint: joint(),
        by_push_rad: milli(9.8, 0.4),
        by_motion_rad: milli(12.6, 2.2),
    });
    all.extend([3.1, -3.1].map(|ms| Warning::EncoderDelay {
        motor_delay_s: milli(ms, 0.6),
    }));
    all.extend(faults.map(|fault| Warning::MotorTorqueRejected {
        joint: joint(),
        fault,
    }));
    all.extend(faults.map(|fault| Warning::TensionRejected {
        joint: "flexor".into(),
        fault,
    }));
    let learned_nm = [0.0113, 0.0466];
    let cable_limits = [
        CableLimit::NoBaseline,
        CableLimit::OneLoad {
            learned_nm: [0.0113, 0.0121],
            load_nm: 0.0466,
        },
        CableLimit::Load {
            learned_nm,
            load_nm: 0.0945,
        },
        CableLimit::Range {
            learned_rad: [0.393, 1.356],
            range_rad: [0.21, 1.3],
        },
        CableLimit::Reversals { reversals: 1 },
    ];
    all.extend(cable_limits.map(|reason| Warning::CableInconclusive {
        joint: joint(),
        reason,
    }));
    all.extend(
        [("compliance", false), ("motor torque scale", true)].map(|(name, is_scale)| {
            Warning::FarFromPrior {
                joint: Some(joint()),
                name: name.into(),
                is_motor_torque_scale: is_scale,
                stds: 13.54,
            }
        }),
    );
    all.push(Warning::FarFromPrior {
        joint: None,
        name: "payload".into(),
        is_motor_torque_scale: false,
        stds: 4.2,
    });
    all.push(Warning::FramesIncomplete { frames: 12 });
    all.extend([-0.055, 0.055].map(|ratio| Warning::StiffnessChanged {
        joint: joint(),
        probability: 0.97,
        change_ratio: plain(ratio, 0.01),
    }));
    all.push(Warning::DateInconsistent {
        recorded_utc_s: MAY_2026_S,
        specified_utc_s: MAY_2026_S + 100.0 * DAY_S,
    });
    let mut document = of_strands();
    let session = document.session.as_mut().expect("a session");
    session.warnings = all;
    for message in warnings::session_warnings(session) {
        list.warning(&message);
    }
}

fn verdicts(list: &mut List) {
    list.section("Verdicts of a session");
    let mut document = of_strands();
    let session = document.session.as_mut().expect("a session");
    for verdict in [
        Verdict::Elongated,
        Verdict::Shortened,
        Verdict::NoChangeDetected,
        Verdict::OffsetDetected,
        Verdict::NoneDetected,
        Verdict::Inconclusive,
        Verdict::TransmissionLost,
    ] {
        let joint = &mut session.joints[1];
        (joint.name, joint.verdict) = (ELBOW.into(), verdict);
        (joint.offset_rad, joint.elongation_m) = (milli(9.8, 0.8), Some(milli(0.246, 0.021)));
        list.line(format!(
            "{}: {}",
            session::verdict(verdict),
            session::headline(joint).text
        ));
    }
    let joint = &mut session.joints[1];
    joint.verdict = Verdict::Elongated;
    joint.retension = Some(RetensionLimit {
        elongation_m: 0.2e-3,
        state: LimitState::Passed,
    });
    list.line(session::headline(joint).text);
    joint.elongation_m = None;
    joint.retension = None;
    list.line(session::headline(joint).text);
    list.line(session::headline(&session.joints[0]).text);
    let joint = &session.joints[0];
    let status = diagnostics::of_tendon("arm", joint, joint.offset_rad, true);
    list.line(format!("ROS diagnostics: {}", status.message));
}

fn change(kind: TendonChangeKind, cause: Option<Cause>) -> TendonChange {
    TendonChange {
        kind,
        time_s: 34.2,
        interval_s: Some(Interval95::new(33.9, 34.6)),
        probability: Some(0.95),
        size_rad: Some(milli(5.12, 0.41)),
        stiffness_change_ratio: Some(plain(-0.04, 0.015)),
        cause,
    }
}

fn session_results(list: &mut List) {
    list.section("Events of a session");
    let kinds = [
        (TendonChangeKind::TransmissionLost, None),
        (TendonChangeKind::Slip, Some(Cause::Rope)),
        (TendonChangeKind::Slip, Some(Cause::MotorEncoder)),
        (TendonChangeKind::Slip, Some(Cause::JointEncoder)),
        (TendonChangeKind::StrandFailure, None),
        (TendonChangeKind::SlipOrStrandFailure, None),
        (TendonChangeKind::Stiffer, None),
        (TendonChangeKind::Retensioned, None),
        (TendonChangeKind::StiffnessLoss, None),
        (TendonChangeKind::StiffnessIncrease, None),
    ];
    let unknown = [
        UnknownCause::Missing,
        UnknownCause::Noise,
        UnknownCause::Rate,
        UnknownCause::Both,
    ];
    let unknown = unknown.map(|cause| (TendonChangeKind::Slip, Some(Cause::Unknown(cause))));
    for (kind, cause) in kinds.into_iter().chain(unknown) {
        list.line(session::of_change(&change(kind, cause), "mrad"));
    }
    let without_slip = TendonChange {
        size_rad: None,
        probability: Some(0.9999),
        ..change(TendonChangeKind::StrandFailure, None)
    };
    list.line(session::of_change(&without_slip, "mrad"));

    list.section("Results of a session");
    let mut document = of_strands();
    let session = document.session.as_mut().expect("a session");
    let measurement = |kind, time_s| ReferenceMeasurement {
        joint: ELBOW.into(),
        kind,
        position_rad: 2.05,
        time_s,
        encoder_error_rad: milli(2.8, 0.4),
        offset_rad: None,
    };
    for (slack, since_baseline) in [(5.0, true), (-0.8, false)] {
        let joint = &mut session.joints[1];
        joint.name = ELBOW.into();
        joint.retension = Some(RetensionLimit {
            elongation_m: 0.2e-3,
            state: LimitState::Passed,
        });
        joint.slack_rad = Some(milli(slack, 2.0));
        joint.anchored = Some(ReferenceOffset {
            readings: vec![
                measurement(AnchorKind::Stop, 12.3),
                measurement(AnchorKind::JointMark, 20.1),
                measurement(AnchorKind::MotorMark, 31.5),
            ],
            since_baseline,
            correction_rad: milli(2.8, 0.4),
            by_motion_rad: milli(12.6, 2.2),
            by_push_rad: since_baseline.then(|| milli(9.8, 0.4)),
        });
        session.payload_changes = vec![PayloadChange {
            time_s: 18.0,
            interval_s: Some(Interval95::new(17.6, 18.3)),
            probability: Some(0.998),
            change_kg: plain(0.5, 0.04),
        }];
        session.external_force = Some(ForceEstimate {
            is_specified: true,
            probability: 1.0,
            force_n: [plain(0.0, 0.4), plain(-0.12, 0.4), plain(4.9, 0.4)],
        });
        (session.motor_torque, session.tension_used) = match since_baseline {
            true => (MotorTorque::Measured, true),
            false => (MotorTorque::FromCurrent, false),
        };
        for sentence in session::session_sentences(session) {
            list.line(sentence);
        }
    }
    list.line(session::of_slack(milli(-3.0, 1.0), "mrad"));
    session.joints[0].lower_bound_m = None;
    session.joints[0].lower_bound_rad = None;
    session.unobservable[0].std_m = None;
    session.unobservable[0].remedies = vec![Remedy::TensionSensors];
    session.payload_changes.clear();
    session.external_force = None;
    for sentence in session::session_sentences(session) {
        list.line(sentence);
    }
    list.line(session::reference(session));
    session.baseline = None;
    list.line(session::reference(session));
    for (is_specified, probability) in [(true, 1.0), (false, 0.97)] {
        list.line(session::external_force(&ForceEstimate {
            is_specified,
            probability,
            force_n: [plain(0.0, 0.4), plain(-0.12, 0.4), plain(4.9, 0.4)],
        }));
    }
    list.line(session::online_inconsistent(&[
        ELBOW.into(),
        "wrist".into(),
    ]));
    let online = |intervals: &[[f64; 2]], provisional| OnlineTrajectory {
        joints: Vec::new(),
        external_force: None,
        provisional,
        provisional_intervals: (intervals.iter())
            .map(|&[from_s, to_s]| ProvisionalInterval { from_s, to_s })
            .collect(),
        blocks: Vec::new(),
    };
    list.line(session::provisional_intervals(&online(&[], false)));
    let intervals = [[0.0, 20.2], [34.0, 64.0]];
    list.line(session::provisional_intervals(&online(&intervals, false)));
    list.line(session::provisional_intervals(&online(&intervals, true)));
    list.section("Table of a session");
    list.line(tables::document(&of_strands(), true).trim_end());
}

fn uncorrected_results(list: &mut List) {
    list.section("Uncorrected estimate");
    let estimate = made_up();
    for joint in &estimate.joints {
        list.line(uncorrected::headline(&estimate, joint));
    }
    for change_mrad in [4.0, -4.0, 0.1] {
        let changed = with_difference(made_up(), change_mrad);
        list.line(uncorrected::headline(&changed, &changed.joints[1]));
        for text in (changed.joints.iter()).filter_map(uncorrected::equivalent_error) {
            list.line(text);
        }
    }
    let mut bare = with_difference(made_up(), 4.0);
    bare.joints[1].elongation_m = None;
    let difference = bare.joints[1].difference.as_mut().expect("a difference");
    (difference.elongation_m, difference.standard_error_rad) = (None, None);
    list.line(uncorrected::headline(&bare, &bare.joints[1]));
    bare.settings.reference = None;
    bare.joints[1].difference = None;
    bare.joints[1].standard_error_rad = None;
    list.line(uncorrected::headline(&bare, &bare.joints[1]));
    for text in uncorrected::losses(&estimate) {
        list.line(text);
    }
    for reason in [
        LossReason::Settling,
        LossReason::JointPosition,
        LossReason::JointVelocity,
        LossReason::MotorPosition,
        LossReason::Torque,
        LossReason::ExternalTorque,
        LossReason::Range,
        LossReason::Duplicate,
        LossReason::Late,
        LossReason::Undecodable,
        LossReason::WithoutTime,
    ] {
        list.line(format!(
            "excluded frames: {}",
            uncorrected::loss_reason(reason)
        ));
    }
    for error in [
        JointError::Rigid,
        JointError::NoJointPosition,
        JointError::NoMotorPosition,
        JointError::NoJointTorque,
        JointError::NoMotorTorque,
        JointError::NoMotorInertia,
        JointError::JointEquations,
        JointError::FrictionAlongPath,
        JointError::NoUsableFrame(None),
        JointError::NoUsableFrame(Some(LossReason::Range)),
    ] {
        list.line(format!("no estimate: {}", uncorrected::joint_error(error)));
    }
    let mut nothing = made_up();
    nothing.joints.retain(|j| j.reason.is_some());
    list.line(uncorrected::nothing_estimated(&nothing).unwrap_or_default());
}

fn limit(state: sinew_trend::LimitState, after_high_s: Option<f64>) -> LimitForecast {
    LimitForecast {
        limit: Limit::Retension { elongation_m: 5e-4 },
        limit_rad: 0.02,
        state,
        passed_probability: 0.9996,
        after_s: Some(85.0 * DAY_S),
        after_low_s: Some(18.0 * DAY_S),
        after_high_s,
        at_utc_s: None,
        at_low_utc_s: None,
        at_high_utc_s: None,
    }
}

fn joint_trend(verdict: TrendVerdict) -> JointTrend {
    JointTrend {
        name: ELBOW.into(),
        verdict,
        sessions: 80,
        without_information: 1,
        first_utc_s: MAY_2026_S,
        last_utc_s: MAY_2026_S + 100.0 * DAY_S,
        cycles: None,
        tensioned_utc_s: MAY_2026_S,
        tensioned_specified: true,
        offset_rad: milli(15.6, 0.98),
        elongation_m: Some(milli(0.467, 0.029)),
        strain_ratio: None,
        rate_rad_per_s: milli(1e-6, 3e-7),
        drift_rad_per_k: None,
        reference_c: 23.0,
        baseline_error_rad: milli(0.0, 0.78),
        systematic_error_rad: 1e-4,
        reported_width_ratio: 1.0,
        events: Vec::new(),
        suspected_step: None,
        limits: Vec::new(),
        life: None,
        basis: PriorBasis::Unknown {
            missing: MissingFromRobot::Tendon,
            ropes: 12,
        },
        series: Vec::new(),
        forecast: Vec::new(),
    }
}

fn trend_results(list: &mut List) {
    use sinew_trend::LimitState as State;
    list.section("Notes: trend");
    let joint = || ELBOW.to_owned();
    let source = || "sessions.csv:12".to_owned();
    let notes = [
        TrendNote::Repeated {
            source: source(),
            more: 0,
        },
        TrendNote::Overlapping {
            source: source(),
            more: 3,
        },
        TrendNote::TensioningNotSpecified { joint: joint() },
        TrendNote::LongBefore {
            joint: joint(),
            time_utc_s: MAY_2026_S,
            days: 400.0,
        },
        TrendNote::LifeNotUsed {
            joint: joint(),
            reason: LifeNotUsed::AgeUnknown,
        },
        TrendNote::LifeNotUsed {
            joint: joint(),
            reason: LifeNotUsed::StrainLimit,
        },
        TrendNote::OtherBaseline {
            joint: joint(),
            time_utc_s: MAY_2026_S,
        },
    ];
    for note in &notes {
        list.note(&trend::note_message(note));
    }

    list.section("Verdicts of a trend");
    let verdict = |list: &mut List, joint: &JointTrend| {
        list.line(format!("{}: {}", joint.name, trend::format_verdict(joint)));
    };
    let mut trend_of = joint_trend(TrendVerdict::NoLimit);
    verdict(list, &trend_of);
    trend_of.verdict = TrendVerdict::Wait;
    for (state, high_s) in [
        (State::TooFewSessions, None),
        (State::NotWithinHorizon, None),
        (State::NotBefore, None),
        (State::Forecast, Some(300.0 * DAY_S)),
        (State::Forecast, None),
    ] {
        trend_of.limits = vec![limit(state, high_s)];
        verdict(list, &trend_of);
    }
    trend_of.limits = vec![limit(State::Passed, None)];
    trend_of.verdict = TrendVerdict::Retension;
    verdict(list, &trend_of);
    list.line(trend::limit_line(&trend_of.limits[0], &trend_of));
    trend_of.limits[0].limit = Limit::Replace { strain_ratio: 0.01 };
    trend_of.verdict = TrendVerdict::Replace;
    verdict(list, &trend_of);
    list.line(trend::limit_line(&trend_of.limits[0], &trend_of));
    trend_of.verdict = TrendVerdict::Watch;
    trend_of.suspected_step = Some(SuspectedStep {
        time_utc_s: MAY_2026_S,
        probability: 0.62,
    });
    verdict(list, &trend_of);
    trend_of.verdict = TrendVerdict::ReplaceByAge;
    for passed_probability in [0.9996, 0.2] {
        trend_of.life = Some(LifeForecast {
            broken_ratio: 0.1,
            age_s: 400.0 * DAY_S,
            broken_by_now_ratio: 0.13,
            passed_probability,
            after_s: 20.0 * DAY_S,
            after_low_s: 5.0 * DAY_S,
            after_high_s: 60.0 * DAY_S,
            ropes: 108,
            broke: 40,
            source: "events.csv".into(),
        });
        verdict(list, &trend_of);
    }

    list.section("Events of a trend");
    let event = |kind, size_mrad, sessions| TrendEvent {
        kind,
        time_utc_s: MAY_2026_S,
        size_rad: Some(milli(size_mrad, 0.5)),
        confirmed_utc_s: MAY_2026_S,
        probability: 0.9996,
        sessions,
        stiffness_change_ratio: Some(plain(-0.055, 0.01)),
    };
    let jump = |cause| TrendEventKind::StepChange { cause };
    trend_of.verdict = TrendVerdict::Inspect;
    for event in [
        event(TrendEventKind::Tensioned { stated: true }, -9.0, 0),
        event(TrendEventKind::Tensioned { stated: false }, -3.68, 2),
        event(jump(StepCause::Slip), -3.68, 2),
        event(jump(StepCause::StrandFailure), 3.68, 2),
        event(jump(StepCause::Slip), 3.68, 2),
        event(jump(StepCause::Unknown), 3.68, 1),
    ] {
        list.line(trend::event_line(&event, &trend_of));
        trend_of.events = vec![event];
        if trend_of.events[0].is_jump() {
            verdict(list, &trend_of);
        }
    }

    list.section("Basis of a forecast");
    list.line(trend::sessions(&trend_of));
    list.line(trend::format_systematic(&trend_of).unwrap_or_default());
    for missing in [
        MissingFromRobot::Tendon,
        MissingFromRobot::Rope,
        MissingFromRobot::Pretension,
    ] {
        list.line(trend::format_basis(&PriorBasis::Unknown {
            missing,
            ropes: 12,
        }));
    }
    for duty in [Some("duty.toml".to_owned()), None] {
        list.line(trend::format_basis(&PriorBasis::Rope {
            rope: "liros-dc000-0301".into(),
            parameters: 26,
            assumed: 20,
            draws: 200,
            duty,
        }));
    }
}

fn lifetime_results(list: &mut List) {
    list.section("Notes: rope lifetimes");
    let words = || vec!["cable snapped".to_owned(), "rope torn".to_owned()];
    let notes = [
        SurvivalNote::AgeUnknown { breaks: 4 },
        SurvivalNote::NoNewRope { places: 1 },
        SurvivalNote::WithoutPlace { events: 2 },
        SurvivalNote::TakenForBroken {
            events: 2,
            words: words(),
        },
        SurvivalNote::NoEnd {
            events: 7,
            words: vec!["inspected".into(), "cleaned".into()],
        },
        SurvivalNote::SameDay { ropes: 1 },
        SurvivalNote::ObservationEnd {
            utc_s: MAY_2026_S,
            by: None,
        },
        SurvivalNote::ObservationEnd {
            utc_s: MAY_2026_S,
            by: Some("robot".into()),
        },
    ];
    for note in &notes {
        list.note(&survival::note_message(note));
    }

    list.section("Results: rope lifetimes");
    let quantile = |broken_ratio, days: f64| LifeQuantile {
        broken_ratio,
        age: Some(days * DAY_S),
        age_low: Some(0.5 * days * DAY_S),
        age_high: None,
    };
    let weibull = FittedWeibull {
        shape: 2.1,
        shape_interval_95: [Some(1.4), Some(3.0)],
        scale: 500.0 * DAY_S,
        scale_interval_95: [Some(400.0 * DAY_S), None],
        log_likelihood: -1.0,
        broken_by: vec![quantile(0.05, 120.0), quantile(0.1, 180.0)],
        curve: Vec::new(),
        outside_band: 3,
    };
    let replacement = |verdict, wear_probability, further_failures, age| AgeReplacement {
        verdict,
        wear_probability,
        required_probability: 0.95,
        shape_prior_95: [0.2, 5.0],
        further_failures,
        age,
    };
    let group = |replacement, broke, weibull: Option<&FittedWeibull>| SurvivalGroup {
        name: None,
        ropes: 108,
        broke,
        exposure_age: 4e9,
        curve: Vec::new(),
        median: quantile(0.5, 420.0),
        weibull: weibull.cloned(),
        replacement,
    };
    let by_age = Some(quantile(0.1, 180.0));
    let helps = replacement(ReplacementVerdict::Helps, Some(0.998), None, by_age);
    for group in [
        (helps, 40),
        (
            replacement(ReplacementVerdict::DoesNotHelp, Some(0.02), None, None),
            40,
        ),
        (
            replacement(ReplacementVerdict::Inconclusive, Some(0.82), Some(3), None),
            2,
        ),
        (
            replacement(ReplacementVerdict::Inconclusive, Some(0.51), None, None),
            40,
        ),
        (
            replacement(ReplacementVerdict::Inconclusive, None, None, None),
            0,
        ),
    ]
    .map(|(replacement, broke)| group(replacement, broke, Some(&weibull)))
    {
        list.line(lifetimes::format_wear(&group, AgeUnit::Seconds));
    }
    let fitted = group(helps, 40, Some(&weibull));
    list.line(lifetimes::format_law(&weibull, AgeUnit::Seconds));
    list.line(lifetimes::format_misfit(&fitted).unwrap_or_default());
}

fn creep_results(list: &mut List) {
    list.section("Artefacts of creep tests");
    for kept in [false, true] {
        list.line(creep::messages::artefact(&Artefact::Slip {
            time_s: 812.0,
            strain_ratio: 4.2e-4,
            kept,
        }));
        list.line(creep::messages::artefact(&Artefact::Outlier {
            time_s: 812.0,
            kept,
        }));
    }
    for fault in [
        Artefact::LoadDrift {
            time_s: 0.0,
            load_n: 60.0,
            drift_share: 0.031,
        },
        Artefact::NoForce,
        Artefact::NoRamp,
        Artefact::SlowRamp {
            time_s: 0.0,
            ramp_s: 12.0,
        },
        Artefact::DuplicateTimestamps { readings: 3 },
        Artefact::NonMonotonicTime { readings: 1 },
        Artefact::Gap { readings: 5 },
        Artefact::Interpolated {
            readings: 3590,
            recorded: 12,
            kept: false,
        },
        Artefact::ImplausibleStrain { strain_ratio: 0.8 },
        Artefact::Shortens {
            strain_ratio: -1.2e-4,
        },
        Artefact::ImplausibleTime { duration_s: 1.5 },
    ] {
        list.line(creep::messages::artefact(&fault));
    }

    list.section("Results of creep tests");
    use NotIdentifiableReason as Reason;
    for reason in [
        Reason::NoChangeOfLoad,
        Reason::FewerThanThreeLoads,
        Reason::FewerThanFiveLoads,
        Reason::OneLoad,
        Reason::OneTemperature,
        Reason::FewerThanThreeTemperatures,
        Reason::TooLittleFlow,
        Reason::NoRetraction,
        Reason::NoneWarm,
        Reason::WithRateOfFlow,
    ] {
        let reason = creep::messages::fixed_reason(reason);
        list.line(format!("parameter fixed at 0.1: {reason}"));
    }
    for range in [
        NotIdentifiable::Anything {
            low: 1e-3,
            high: 1e2,
        },
        NotIdentifiable::Below { high: 1e2 },
        NotIdentifiable::Above { low: 1e-3 },
    ] {
        let range = creep::messages::unidentified_range(range, "s");
        list.line(format!(
            "parameter not identifiable from this record: {range}"
        ));
    }
    for zero in [
        StrainZero::BeforeLoad { readings: 12 },
        StrainZero::AsRecorded,
    ] {
        let zero = creep::messages::zero(zero);
        list.line(format!("zero of the strain: {zero}"));
    }
    for (load_n, temperature_c, source) in [
        (Some(60.0), Some(23.0), ConditionSource::Held),
        (None, None, ConditionSource::Stated),
    ] {
        let conditions = creep::messages::forecast_conditions(&ForecastConditions {
            load_n,
            temperature_c,
            source,
        });
        list.line(format!("forecast under {conditions}"));
    }
}

fn rope_results(list: &mut List) {
    list.section("Warnings: ropes");
    let all = [
        Caution::LowLoad,
        Caution::HighLoad,
        Caution::Hot,
        Caution::BreakingLoadAssumed {
            breaking_load_n: 950.0,
        },
        Caution::Extrapolated { tests_s: 14_400.0 },
        Caution::CreepsApart {
            time_s: 200.0 * DAY_S,
        },
        Caution::WornOut {
            time_s: 200.0 * DAY_S,
        },
        Caution::Replace {
            strain_ratio: 0.01,
            time_s: Some(200.0 * DAY_S),
            share: 0.8,
        },
        Caution::Replace {
            strain_ratio: 0.01,
            time_s: None,
            share: 0.08,
        },
        Caution::TightBend {
            bend_ratio: 6.2,
            min_ratio: 8.0,
        },
        Caution::LoadShare {
            load_share: 0.31,
            max_share: 0.2,
        },
        Caution::TerminationNotSpecified {
            splice_share: 0.9,
            knot_share: 0.5,
        },
        Caution::BeyondData {
            tested_range: sinew_rope::law::tested_range::TestedRange {
                load_share: [0.013, 0.023],
                temperature_c: [23.0, 23.0],
                duration_s: 14_400.0,
            },
            load_share: [0.06, 0.06],
            temperature_c: [40.0, 40.0],
            duration_s: 365.25 * DAY_S,
            factor: 2.93,
        },
        Caution::AssumedParameters {
            assumed: 20,
            parameters: 26,
        },
    ];
    for caution in all {
        list.warning(&rope::messages::caution_message(caution));
    }
    list.line(
        LimitViolation {
            low_load: true,
            high_load: true,
            hot: true,
        }
        .to_string(),
    );
    for replaces in [true, false] {
        list.line(rope::namesake(&Namesake {
            name: "liros-dc000-0301".into(),
            file: "ropes/mine.toml".into(),
            replaces,
        }));
    }

    list.section("Rejected ropes");
    for rejection in [
        Rejection::TooThick {
            diameter_m: 2e-3,
            limit_m: 1.9e-3,
        },
        Rejection::TooThin {
            diameter_m: 1e-3,
            limit_m: 1.2e-3,
        },
        Rejection::TooHeavy {
            weight_kg_per_m: 3e-3,
            limit_kg_per_m: 2.5e-3,
        },
        Rejection::BendRatio {
            ratio: 6.2,
            limit_ratio: 8.0,
        },
        Rejection::SafetyFactor {
            ratio: 12.0,
            limit_ratio: 20.0,
        },
        Rejection::Elongation {
            elongation_m: Bounded::even(4.2e-3, 1e-3),
            limit_m: 3e-3,
        },
        Rejection::Stiffness {
            stiffness_n_per_m: Bounded::even(40e3, 5e3),
            limit_n_per_m: 50e3,
        },
        Rejection::DiameterNotPublished,
        Rejection::WeightNotPublished,
        Rejection::BendRatioUnknown,
        Rejection::BreakingLoadNotPublished,
        Rejection::Breaks {
            life_s: Some(Bounded::even(200.0 * DAY_S, 100.0 * DAY_S)),
            broken_share: 0.79,
            cause: BreakCause::BendingFatigue,
        },
        Rejection::Hot,
        Rejection::NotDetermined,
        Rejection::NotPredicted {
            reason: "reason of the prediction".into(),
        },
    ] {
        list.line(format!("rope: {}", rope::rejection(&rejection)));
    }

    list.section("Lifetime of a rope");
    let life = |breaks_after_s, cause, termination| RopeLifetime {
        breaks_after_s,
        cause,
        broken_share: 0.0,
        termination,
        termination_share: 0.9,
        abrasion_factor: 1.0,
        spots: Vec::new(),
    };
    let bounded = Some(Bounded {
        value: 800.0 * DAY_S,
        low: 500.0 * DAY_S,
        high: 1500.0 * DAY_S,
    });
    for life in [
        life(
            bounded,
            BreakCause::CreepRupture,
            RopeTermination::NotSpecified,
        ),
        life(
            bounded,
            BreakCause::BendingFatigue,
            RopeTermination::Spliced,
        ),
        life(None, BreakCause::CreepRupture, RopeTermination::Knotted),
    ] {
        list.line(rope::life::lifetime(&life));
    }
}

fn robot_results(list: &mut List) {
    use FindingKind as Kind;
    list.section("Findings in a robot description");
    for kind in [
        Kind::Gap,
        Kind::UnknownJoint,
        Kind::Contradiction,
        Kind::Range,
        Kind::Distance,
        Kind::ArmMass,
        Kind::HeavyLink,
        Kind::LightLink,
        Kind::Density,
        Kind::InertiaSize,
        Kind::InertiaPlaceholder,
        Kind::InertiaNotDefinite,
        Kind::InertiaTriangle,
        Kind::Frequency,
        Kind::Sag,
        Kind::TooStiff,
        Kind::StifferThanRope,
        Kind::MotorInertia,
        Kind::Friction,
        Kind::UnknownRope,
        Kind::Pretension,
        Kind::HoldingPull,
        Kind::LargestPull,
        Kind::PulleyDiameter,
        Kind::ElongationLimit,
        Kind::RangeWidth,
        Kind::RangeReversed,
        Kind::EffortLimit,
        Kind::NegativeLimit,
        Kind::SpeedLimit,
        Kind::Gravity,
        Kind::GravityUp,
    ] {
        let (value, unit, text, names) = match kind {
            Kind::Gap | Kind::Contradiction => (None, "", Some("text of the check"), vec![]),
            Kind::UnknownJoint => (None, "", Some("joint 'elbo' not found"), vec![ELBOW]),
            Kind::UnknownRope => (None, "", Some("liros"), vec!["liros-dc000-0301"]),
            _ => (Some(0.2), "m", None, vec![]),
        };
        let finding = Finding {
            kind,
            severity: match kind {
                Kind::Gap => Severity::Missing,
                Kind::UnknownJoint | Kind::RangeReversed => Severity::Impossible,
                _ => Severity::Implausible,
            },
            at: Location {
                file: "robot.toml".into(),
                line: Some(7),
                key: "joints.elbow".into(),
            },
            value,
            unit,
            assessed: value.map(|value| RangeCheck {
                value,
                unit: "",
                low: Some(0.3),
                high: Some(10.0),
            }),
            slip: (kind == Kind::Range).then_some(UnitHint {
                unit: "mm",
                value: 200.0,
            }),
            text: text.map(str::to_owned),
            names: names.into_iter().map(str::to_owned).collect(),
        };
        for sentence in robot::messages::diagnostics(&[finding]) {
            list.line(sentence);
        }
    }
}
