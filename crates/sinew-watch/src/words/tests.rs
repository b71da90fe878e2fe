//! Golden list of all texts of the monitor with example values.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-watch --lib messages` rewrites `tests/golden/messages.txt`.

use super::{advice, entry, log, observation, response, robot, robots, tendon, title};
use crate::config::Config;
use crate::store::StoreError;
use jiff::tz::TimeZone;
use sinew_estimate::online::Provisional;
use sinew_estimate::{Cause, UnknownCause};
use sinew_model::Gaussian;
use sinew_trend::{Limit, LimitForecast, LimitState};
use sinew_watch_core::alarm::{
    Alarm, AlarmCause, AlarmKey, AlarmState, Condition, DataFault, Level, LimitOrigin, StepKind,
    StoreFault, Transition, TransitionReason,
};
use sinew_watch_core::command::{Command, CommandKind};
use sinew_watch_core::incident::{
    CauseProbability, Evidence, Finding, Incident, IncidentCause, IncidentPhase,
};
use sinew_watch_core::journal::{BaselineWaits, Correction, Event, Maintenance, SessionEnd};
use sinew_watch_core::record::{Clock, NoOffset};
use sinew_watch_core::snapshot::{
    Freshness, Learning, NoEstimateReason, RobotSnapshot, TendonSnapshot, Validity,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Path of the list.
const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/messages.txt");

const ELBOW: &str = "elbow";
/// 2026-05-05 00:00 UTC, s since 1970.
const MAY_2026_S: f64 = 1_777_939_200.0;
const DAY_S: f64 = 86_400.0;

/// Lists values of an enum; a variant without a value does not compile.
macro_rules! every {
    ($enum:ident { $($variant:ident $(($($item:expr),+))? $({ $($field:ident: $value:expr),+ $(,)? })?),+ $(,)? }) => {{
        // A variant with several values is repeated.
        #[allow(unreachable_patterns)]
        let _every_variant_has_a_value = |value: &$enum| match value {
            $($enum::$variant { .. } => (),)+
        };
        vec![$($enum::$variant $(($($item),+))? $({ $($field: $value),+ })?),+]
    }};
}

/// List with headings.
#[derive(Default)]
struct List(String);

impl List {
    fn section(&mut self, heading: &str) {
        let space = if self.0.is_empty() { "" } else { "\n" };
        self.0 += &format!("{space}# {heading}\n\n");
    }

    fn line(&mut self, text: impl AsRef<str>) {
        self.0 += &format!("{}\n", text.as_ref().trim_end());
    }

    fn alarm(&mut self, alarm: &Alarm) {
        let (title, observation) = (title(alarm), observation(alarm));
        let advice = advice(alarm).unwrap_or("(no advice)");
        self.line(format!("{title}: {observation} {advice}"));
    }
}

/// `TZ=Europe/Berlin date -d @1793606400`; summer time ends on 2026-10-25, 01:00 UTC.
#[test]
fn times_are_in_the_named_zone() {
    let zone = |name: &str| TimeZone::get(name).unwrap();
    let text = |utc_s: f64, name: &str| super::in_zone(utc_s, "%Y-%m-%d %H:%M %Z", zone(name));
    assert_eq!(text(1_793_606_400.0, "UTC"), "2026-11-02 08:00 UTC");
    assert_eq!(
        text(1_793_606_400.0, "Europe/Berlin"),
        "2026-11-02 09:00 CET"
    );
    for (utc_s, expected) in [
        (1_792_889_999.0, "2026-10-25 02:59 CEST"),
        (1_792_890_000.0, "2026-10-25 02:00 CET"),
    ] {
        assert_eq!(text(utc_s, "Europe/Berlin"), expected);
    }
    assert_eq!(text(7e11, "UTC"), "–");
}

#[test]
fn messages_match_golden() {
    let mut list = List::default();
    alarms(&mut list);
    journal(&mut list);
    of_robots(&mut list);
    of_tendons(&mut list);
    log_lines(&mut list);
    responses(&mut list);
    configurations(&mut list);
    store_errors(&mut list);
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

fn alarm(joint: Option<&str>, condition: Condition, cause: AlarmCause) -> Alarm {
    Alarm {
        key: AlarmKey {
            joint: joint.map(Into::into),
            condition,
        },
        state: AlarmState::Active,
        acknowledged: false,
        raised_utc_s: MAY_2026_S,
        cause,
        shelved_until_utc_s: None,
        shelved_for_s: None,
    }
}

fn step(what: StepKind, cause: Option<Cause>, stiffness_ratio: Option<f64>) -> AlarmCause {
    AlarmCause::StepChange {
        time_utc_s: MAY_2026_S,
        size_rad: 5.12e-3,
        std_rad: 0.2e-3,
        what,
        cause,
        stiffness_ratio,
    }
}

/// Returns every condition with an example of its cause. A new cause does not compile without an example.
fn examples() -> Vec<(Condition, AlarmCause)> {
    let causes = every!(AlarmCause {
        Limit {
            mean: 0.61e-3,
            std: 0.02e-3,
            limit: 0.5e-3,
            probability: 0.998,
            origin: LimitOrigin::RobotToml,
        },
        Soon {
            limit: Some(Limit::Retension {
                elongation_m: 0.5e-3,
            }),
            at_low_utc_s: Some(MAY_2026_S + 9.0 * DAY_S),
            at_utc_s: Some(MAY_2026_S + 30.0 * DAY_S),
            at_high_utc_s: None,
        },
        StepChange {
            time_utc_s: MAY_2026_S,
            size_rad: 5.12e-3,
            std_rad: 0.2e-3,
            what: StepKind::Slip,
            cause: Some(Cause::Rope),
            stiffness_ratio: None,
        },
        Provisional { for_s: 720.0 },
        Data {
            trouble: DataFault::OneSignal,
        },
        Store {
            fault: StoreFault::Full,
            reason: "the disk is full".into(),
        },
        Transport {
            transport: "dds:0".into(),
            reason: "no network".into(),
        },
        Silence {
            since_utc_s: Some(MAY_2026_S),
        },
    });
    let conditions = |cause: &AlarmCause| match cause {
        AlarmCause::Limit { .. } => vec![Condition::RetensionLimit],
        AlarmCause::Soon { .. } => vec![Condition::LimitNear],
        AlarmCause::StepChange { .. } => vec![Condition::StepChange, Condition::SuspectedStep],
        AlarmCause::Provisional { .. } => vec![Condition::SuspectedStep],
        AlarmCause::Data { .. } => vec![Condition::Data],
        AlarmCause::Store { .. } => vec![Condition::Store],
        AlarmCause::Transport { .. } => vec![Condition::Transport],
        AlarmCause::Silence { .. } => vec![Condition::NoData],
    };
    let pairs = causes.into_iter().flat_map(|cause| {
        let conditions = conditions(&cause);
        conditions
            .into_iter()
            .map(move |condition| (condition, cause.clone()))
    });
    let strain = AlarmCause::Limit {
        mean: 0.0102,
        std: 0.0004,
        limit: 0.01,
        probability: 0.96,
        origin: LimitOrigin::Catalogue,
    };
    let failure = step(StepKind::StrandFailure, None, Some(-0.055));
    let lost = step(StepKind::TransmissionLost, None, None);
    let others = [
        (Condition::TransmissionLost, lost),
        (Condition::ReplaceLimit, strain),
        (Condition::StrandFailure, failure),
    ];
    let all: Vec<_> = others.into_iter().chain(pairs).collect();
    for condition in Condition::ALL {
        assert!(all.iter().any(|(of, _)| *of == condition), "{condition:?}");
    }
    all
}

fn alarms(list: &mut List) {
    list.section("Alarms: title, observation and recommended action");
    for (condition, cause) in examples() {
        list.alarm(&alarm(Some(ELBOW), condition, cause));
    }
    let soon = AlarmCause::Soon {
        limit: Some(Limit::Replace { strain_ratio: 0.01 }),
        at_low_utc_s: Some(MAY_2026_S + 9.0 * DAY_S),
        at_utc_s: None,
        at_high_utc_s: None,
    };
    list.alarm(&alarm(Some(ELBOW), Condition::LimitNear, soon));
    let silence = AlarmCause::Silence { since_utc_s: None };
    list.alarm(&alarm(None, Condition::NoData, silence));

    list.section("Alarms: step changes");
    let kinds = every!(StepKind {
        TransmissionLost,
        Slip,
        StrandFailure,
        SlipOrStrandFailure,
        WhileOff,
        Retensioned,
    });
    for kind in kinds {
        let cause = step(kind, None, Some(-0.055));
        let condition = match kind {
            StepKind::TransmissionLost => Condition::TransmissionLost,
            _ => Condition::StepChange,
        };
        list.alarm(&alarm(Some(ELBOW), condition, cause));
    }
    let mut causes = every!(Cause {
        Rope,
        MotorEncoder,
        JointEncoder,
        Unknown(UnknownCause::Missing),
    });
    let unknown = every!(UnknownCause {
        Missing,
        Noise,
        Rate,
        Both,
    });
    causes.pop();
    causes.extend(unknown.into_iter().map(Cause::Unknown));
    for cause in causes {
        let cause = step(StepKind::Slip, Some(cause), None);
        list.alarm(&alarm(Some(ELBOW), Condition::SuspectedStep, cause));
    }

    list.section("Alarms: invalid data");
    let faults = every!(DataFault {
        NotFinite { share: 0.12 },
        Lost { share: 0.052 },
        Dead { motor: true },
        Dead { motor: false },
        OneSignal,
        FarApart { apart_rad: 57.3 },
        Swapped {
            with: "wrist".into(),
        },
        NonMonotonicTime { share: 0.9 },
        Qos {
            topic: "/joint_states".into(),
            offered: "best effort".into(),
            requested: "reliable".into(),
        },
        Decode {
            topic: "/joint_states".into(),
            reason: super::unsupported_type("std_msgs/msg/String"),
        },
        Decode {
            topic: "/joint_states".into(),
            reason: super::message_too_long(2_000_000, 1_000_000),
        },
        Decode {
            topic: "motor side".into(),
            reason: super::ambiguous_topics("/motors, /motors_raw", "motor_topic"),
        },
        Decode {
            topic: "joint side".into(),
            reason: super::topic_not_found("/joints", "joint_topic", "/joint_states"),
        },
        Missing {
            joint: ELBOW.into(),
            motor: true,
        },
        Rejected {
            reason: "reason of the estimator".into(),
        },
    });
    for trouble in faults {
        let cause = AlarmCause::Data { trouble };
        list.alarm(&alarm(None, Condition::Data, cause));
    }

    list.section("Alarms: storage failures");
    let faults = every!(StoreFault {
        Full,
        ReadOnly,
        Disk,
        Damaged,
        Other,
    });
    for fault in faults {
        let reason = "reason of the store".into();
        let cause = AlarmCause::Store { fault, reason };
        list.alarm(&alarm(None, Condition::Store, cause));
    }
}

fn key(joint: Option<&str>) -> AlarmKey {
    AlarmKey {
        joint: joint.map(Into::into),
        condition: Condition::RetensionLimit,
    }
}

fn commands() -> Vec<CommandKind> {
    every!(CommandKind {
        Tensioned { joints: Vec::new() },
        Tensioned {
            joints: vec![ELBOW.into()],
        },
        Replaced {
            joints: vec![ELBOW.into(), "wrist".into()],
        },
        Withdraw { entry: 3 },
        Correct {
            entry: 3,
            joints: vec![ELBOW.into()],
            time_utc_s: MAY_2026_S,
        },
        Acknowledge {
            alarm: key(Some(ELBOW)),
        },
        Shelve {
            alarm: key(Some(ELBOW)),
            for_s: 7200.0,
        },
        Unshelve {
            alarm: key(Some(ELBOW)),
        },
        Reset {
            alarm: key(Some(ELBOW)),
        },
        Finding {
            joint: ELBOW.into(),
            finding: Finding::ClampSlip,
        },
        Note,
    })
}

fn journal(list: &mut List) {
    list.section("Journal: events");
    let ends = every!(SessionEnd {
        Full,
        Stood,
        Lost,
        Shutdown,
        ClockStep,
        Command,
        Baseline,
    });
    let waits = every!(BaselineWaits { FewPoses, Rejected });
    let transition = |from, to, reason| Transition {
        key: key(Some(ELBOW)),
        from,
        to,
        time_utc_s: MAY_2026_S,
        reason,
    };
    let command = |what, note: &str| Command {
        who: "Anna".into(),
        note: note.into(),
        what,
    };
    let events = every!(Event {
        Started { restored: false },
        Started { restored: true },
        Back {
            after_s: Some(4000.0),
        },
        Back { after_s: None },
        Silent,
        Session {
            duration_s: 480.0,
            end: SessionEnd::Stood,
        },
        Baseline { poses: 12 },
        BaselinePending {
            reason: BaselineWaits::FewPoses,
        },
        ClockStep { by_s: -3.2 },
        StampsNotTime { rate: 0.5 },
        Dropped { messages: 310 },
        Behind { motion_s: 40.0 },
        StoredStateIgnored {
            reason: "reason of the monitor".into(),
        },
        GivenUp {
            entries: 12,
            records: 3,
        },
        Alarm {
            transition: transition(
                AlarmState::Normal,
                AlarmState::Active,
                TransitionReason::ShelfEnded,
            ),
        },
        Incident {
            incident: incident(IncidentPhase::Suspected),
        },
        Command {
            command: command(CommandKind::Note, "rope looks worn"),
        },
        Maintenance {
            maintenance: corrected(true),
        },
        Maintenance {
            maintenance: corrected(false),
        },
        Reloaded,
    });
    for event in events {
        list.line(entry(&event));
    }
    let phases = every!(IncidentPhase {
        Suspected,
        Confirmed,
        Acknowledged,
        Repaired,
        Closed,
    });
    for phase in phases {
        let incident = incident(phase);
        list.line(entry(&Event::Incident { incident }));
    }
    let findings = every!(Finding {
        StrandFailure,
        Slip,
        ClampSlip,
        EncoderMoved,
        Nothing,
        Other,
    });
    for finding in findings {
        let mut incident = incident(IncidentPhase::Closed);
        incident.finding = Some(finding);
        list.line(entry(&Event::Incident { incident }));
    }
    for end in ends {
        let duration_s = 480.0;
        list.line(entry(&Event::Session { duration_s, end }));
    }
    for reason in waits {
        list.line(entry(&Event::BaselinePending { reason }));
    }

    list.section("Journal and webhooks: transitions of alarms");
    let from = every!(AlarmState {
        Active,
        Acknowledged,
        Cleared,
        Latched,
        Normal,
    });
    let condition_met = || TransitionReason::Condition {
        cause: AlarmCause::Silence { since_utc_s: None },
    };
    let mut transitions = vec![transition(
        AlarmState::Normal,
        AlarmState::Active,
        condition_met(),
    )];
    transitions.extend(
        from.into_iter()
            .map(|to| transition(AlarmState::Cleared, to, condition_met())),
    );
    let reasons = every!(TransitionReason {
        Condition {
            cause: AlarmCause::Silence { since_utc_s: None },
        },
        Command {
            who: "Anna".into(),
            what: CommandKind::Note,
            note: "inspected".into(),
        },
        Superseded {
            alarm: key(Some(ELBOW)),
        },
        Withdrawn,
        ShelfEnded,
    });
    transitions.extend(
        (reasons.into_iter())
            .map(|reason| transition(AlarmState::Acknowledged, AlarmState::Normal, reason)),
    );
    transitions.extend(commands().into_iter().map(|what| {
        let (who, note) = ("Anna".into(), String::new());
        let reason = TransitionReason::Command { who, what, note };
        transition(AlarmState::Active, AlarmState::Acknowledged, reason)
    }));
    for transition in transitions {
        list.line(entry(&Event::Alarm { transition }));
    }

    for condition in Condition::ALL {
        let joint = condition.latches().then(|| ELBOW.into());
        let transition = Transition {
            key: AlarmKey { joint, condition },
            ..transition(AlarmState::Normal, AlarmState::Active, condition_met())
        };
        list.line(entry(&Event::Alarm { transition }));
    }

    list.section("Journal: commands of operators");
    for what in commands() {
        for note in ["", "rope looks worn"] {
            if what == CommandKind::Note && note.is_empty() {
                continue;
            }
            let command = command(what.clone(), note);
            list.line(entry(&Event::Command { command }));
        }
    }
}

fn corrected(withdrawn: bool) -> Maintenance {
    Maintenance {
        number: 3,
        joints: vec![ELBOW.into()],
        replaced: withdrawn,
        time_utc_s: MAY_2026_S - 3600.0,
        recorded_utc_s: MAY_2026_S,
        after_utc_s: None,
        who: "Anna".into(),
        correction: Some(Correction {
            who: "Ben".into(),
            time_utc_s: MAY_2026_S + 600.0,
            withdrawn,
        }),
    }
}

fn incident(phase: IncidentPhase) -> Incident {
    let causes = every!(IncidentCause {
        StrandFailure,
        Slip,
        Encoder,
        SlipOrEncoder,
        TransmissionLost,
        Retensioned,
        NoChange,
    });
    let mut probability = 1.0;
    Incident {
        joint: ELBOW.into(),
        number: 3,
        opened_utc_s: MAY_2026_S,
        phase,
        closed_utc_s: None,
        evidence: vec![Evidence {
            time_utc_s: MAY_2026_S,
            offset_rad: Some(Gaussian::new(9.8e-3, 0.4e-3)),
            stiffness_ratio: Some(Gaussian::new(-0.12, 0.015)),
            probability: 0.5,
        }],
        causes: (causes.into_iter())
            .map(|cause| {
                probability *= 0.5;
                CauseProbability { cause, probability }
            })
            .collect(),
        finding: None,
        note: String::new(),
    }
}

fn tendon_snapshot() -> TendonSnapshot {
    TendonSnapshot {
        joint: ELBOW.into(),
        level: Level::Ok,
        offset_rad: Some(Gaussian::new(9.8e-3, 0.4e-3)),
        validity: Validity::Valid,
        provisional: None,
        unknown_temperature_rad: None,
        elongation_m: Some(Gaussian::new(0.246e-3, 0.011e-3)),
        strain_ratio: None,
        reason: None,
        tensioned_utc_s: Some(MAY_2026_S),
        last: None,
        limits: Vec::new(),
        rope: None,
        trend: None,
        passages: Arc::new([]),
    }
}

fn robot_snapshot(freshness: Freshness, learning: Learning) -> RobotSnapshot {
    RobotSnapshot {
        robot: "arm-7".into(),
        robot_type: "arm".into(),
        source: "dds:0/arm7".into(),
        time_utc_s: MAY_2026_S,
        level: Level::Ok,
        freshness,
        rate_hz: 500.0,
        frames: 1000,
        frames_lost: 0,
        learning,
        session: None,
        clock: Clock::Utc,
        temperature_c: None,
        external_force: None,
        tendons: vec![tendon_snapshot()],
        alarms: Vec::new(),
        incidents: Vec::new(),
        maintenance: Vec::new(),
        withdrawable: None,
        waiting_to_be_stored: 0,
    }
}

fn of_robots(list: &mut List) {
    list.section("Pages and /diagnostics: robots");
    let all = every!(Freshness {
        Never,
        Fresh,
        Stale { for_s: 4000.0 },
    });
    for freshness in all {
        list.line(robot(&robot_snapshot(freshness, Learning::Following)));
    }
    let all = every!(Learning {
        Following,
        NoBaseline,
        Baseline {
            duration_s: 40.0,
            poses: 5,
            poses_needed: 12,
        },
    });
    for learning in all {
        let mut snapshot = robot_snapshot(Freshness::Fresh, learning);
        snapshot.tendons.push(tendon_snapshot());
        list.line(robot(&snapshot));
    }
    let mut snapshot = robot_snapshot(Freshness::Fresh, Learning::Following);
    snapshot.level = Level::Stale;
    list.line(robot(&snapshot));
    for (condition, cause) in examples() {
        let alarm = alarm(
            condition.latches().then_some(ELBOW),
            condition,
            cause.clone(),
        );
        snapshot.level = alarm.level();
        snapshot.alarms = vec![alarm];
        list.line(robot(&snapshot));
    }
    snapshot.alarms.push(snapshot.alarms[0].clone());
    list.line(robot(&snapshot));

    list.section("Pages: robots that are not monitored");
    list.line(super::waits_for_urdf());
    list.line(super::disconnected("dds:0", "no network"));
    list.line(super::is_being_stored());
    list.line(super::has_failed());
    list.line(super::resumes(std::time::Duration::from_secs(8)));
}

fn of_tendons(list: &mut List) {
    list.section("Pages and /diagnostics: tendons");
    list.line(tendon(&tendon_snapshot(), &[]));
    let mut snapshot = tendon_snapshot();
    snapshot.elongation_m = None;
    list.line(tendon(&snapshot, &[]));
    let all = every!(Provisional {
        Starting,
        Step {
            since_s: MAY_2026_S,
            probability: 0.62,
        },
        ChangeNearEnd {
            since_s: MAY_2026_S,
        },
        Rejected { share: 0.56 },
        NotSolved,
    });
    for provisional in all {
        snapshot.provisional = Some(provisional);
        list.line(tendon(&snapshot, &[]));
    }
    (snapshot.provisional, snapshot.offset_rad) = (None, None);
    let no_offset = every!(NoOffset {
        TooWide,
        TooShort,
        Rejected,
    });
    let mut reasons = every!(NoEstimateReason {
        NoData,
        Starting,
        BaselineAcquisition,
        Inconclusive {
            reason: NoOffset::TooWide,
        },
    });
    reasons.pop();
    reasons.extend(
        no_offset
            .into_iter()
            .map(|reason| NoEstimateReason::Inconclusive { reason }),
    );
    for reason in reasons {
        snapshot.reason = Some(reason);
        list.line(tendon(&snapshot, &[]));
    }
    let failure = step(StepKind::StrandFailure, None, Some(-0.055));
    let mut alarm = alarm(Some(ELBOW), Condition::StrandFailure, failure);
    list.line(tendon(&tendon_snapshot(), std::slice::from_ref(&alarm)));
    alarm.state = AlarmState::Latched;
    list.line(tendon(&tendon_snapshot(), &[alarm]));

    list.section("Pages and /diagnostics: forecasts of a tendon");
    let limits = every!(Limit {
        Retension {
            elongation_m: 0.5e-3,
        },
        Replace { strain_ratio: 0.01 },
    });
    for limit in limits {
        let states = every!(LimitState {
            Passed,
            Forecast,
            NotBefore,
            NotWithinHorizon,
            TooFewSessions,
        });
        for state in states {
            let in_days = |days: f64| Some(days * DAY_S);
            let mut forecast = LimitForecast {
                limit,
                limit_rad: 0.02,
                state,
                passed_probability: 0.1,
                after_s: in_days(60.0),
                after_low_s: in_days(30.0),
                after_high_s: in_days(120.0),
                at_utc_s: None,
                at_low_utc_s: None,
                at_high_utc_s: None,
            };
            list.line(robots::forecast(&forecast, MAY_2026_S));
            if state == LimitState::Forecast {
                forecast.after_high_s = None;
                list.line(robots::forecast(&forecast, MAY_2026_S));
            }
        }
    }
}

fn log_lines(list: &mut List) {
    list.section("Log");
    let reason = "reason of the failure";
    for line in [
        log::store_recovered(),
        log::store_failed(reason),
        log::transaction_rejected("arm-7", reason),
        log::last_data_lost("arm-7"),
        log::month_not_exported(reason),
        log::export_not_recorded("2026-05", reason),
        log::not_thinned("arm-7", reason),
        log::recording_not_written(
            "/var/lib/sinew/incidents/arm-7/incident-000012.mcap",
            reason,
        ),
        log::token_file("web-token", "/var/lib/sinew/web-token"),
        log::wrong_token("192.0.2.7"),
        log::too_many_tokens("192.0.2.7"),
        log::logins_not_stored(reason),
        log::not_reloaded(reason),
        log::reloaded(),
        log::needs_restart("[web] and [store]"),
        log::robot_fault("arm-7", reason),
        log::robot_restarted("arm-7", sinew_watch_core::MonitorError::AnotherRobot),
        log::connected("dds:0"),
        log::disconnected("dds:0", reason),
        log::mqtt_disconnected("broker.example.org", reason),
        log::notification_discarded("http://127.0.0.1:9000/hook", 6, reason),
    ] {
        list.line(line);
    }
}

fn responses(list: &mut List) {
    list.section("HTTP responses");
    for line in [
        response::STORE_NOT_READ,
        response::NOT_FOUND,
        response::INVALID_TOKEN,
        response::TOKEN_REQUIRED,
        response::UNKNOWN_HOST,
        response::HEADER_REQUIRED,
        response::JSON_REQUIRED,
        response::CROSS_SITE,
        response::READ_ONLY,
        response::EXPORTS_BUSY,
        response::TOO_MANY_PAGES,
        response::IS_STARTING,
        response::IS_GONE,
        response::NO_RESULT,
        response::TEST_NOTIFICATION,
        response::NO_RECEIVER,
        response::TOO_MANY_TOKENS,
        response::NO_CURSOR,
        response::WORKS,
        response::HANGS,
    ] {
        list.line(line);
    }
    let reason = "reason of the failure";
    for line in [
        response::not_monitored("arm-7", reason),
        response::no_robot("arm-7"),
        response::no_tendon("arm-7", "knee", "shoulder, elbow"),
        response::no_recording("arm-7", 3),
        response::invalid_period(1095.0),
        response::invalid_body(reason),
        response::not_stored(reason),
    ] {
        list.line(line);
    }
}

/// Lists the errors of invalid configurations, one for every check of the configuration module.
fn configurations(list: &mut List) {
    list.section("Invalid configurations");
    let robot = "[[robot]]\nname = \"arm-7\"\ndir = \"arm-7\"\n";
    let with = |lines: &str| format!("{robot}dds = {{}}\n{lines}\n");
    let head = |lines: &str| format!("{lines}\n{robot}dds = {{}}\n");
    for text in [
        String::new(),
        "[[robot]]\ndir = \"arm-7\"\ndds = {}\n".into(),
        "[[robot]]\nname = \"arm 7\"\ndir = \"arm-7\"\ndds = {}\n".into(),
        "[[robot]]\nname = \"arm-7\"\ndds = {}\n".into(),
        robot.into(),
        with("zenoh = {}"),
        format!("{robot}dds = {{}}\n{robot}dds = {{}}\n"),
        format!("{robot}dds = {{ domain = 233 }}\n"),
        format!("{robot}dds = {{ namespace = \"arm 7\" }}\n"),
        format!("{robot}dds = {{ interfaces = \"eth0\" }}\n"),
        format!("{robot}dds = {{ interfaces = [\"eth0\"] }}\n"),
        format!("{robot}zenoh = {{ connect = [\"127.0.0.1\"] }}\n"),
        format!("{robot}mcap = {{}}\n"),
        format!("{robot}mcap = {{ path = \"runs\", from = \"end\" }}\n"),
        with("temperature_std_k = 1"),
        with("temperature_c = 400"),
        with("stamps = \"fast\""),
        with("times = { stale_after_s = 0 }"),
        with("alarm = { step_change = { raise_after_s = 60 } }"),
        with("alarm = { clear_below = 2 }"),
        with("colour = \"red\""),
        head("time_zone = \"Mars/Olympus\""),
        head("recording = { before_s = 0 }"),
        head("[web]\nbind = \"localhost\""),
        head("[web]\nhost_names = [\"cell 3\"]"),
        head("[[webhook]]"),
        head("[[webhook]]\nurl = \"ftp://example.org\""),
        head("[[webhook]]\nurl = \"http://example.org\"\nseverity_min = 1001"),
        head("[[mail]]\nserver = \"mail.example.org\"\nfrom = \"a@b.org\""),
        head("[[mail]]\nserver = \"mail:x\"\nfrom = \"a@b.org\"\nto = [\"c@d.org\"]"),
        head("[[mail]]\nserver = \"mail\"\nfrom = \"a@b.org\"\nto = [\"Ada <c@d.org>\"]"),
        head("[[mail]]\nserver = \"mail\"\nfrom = \"a@b.org\"\nto = [\"c@d.org\"]\nuser = \"a\""),
        head(
            "[[mail]]\nserver = \"mail\"\nfrom = \"a@b.org\"\nto = [\"c@d.org\"]\nuser = \"a\"\npassword_file = \"p\"\ntls = \"off\"",
        ),
        head("[web]\nurl = \"cell-3\""),
        head("[[web.token]]\nname = \"hall\""),
        head("[[web.token]]\nname = \"a b\"\nrole = \"read\""),
        head(
            "[[web.token]]\nname = \"a\"\nrole = \"read\"\n[[web.token]]\nname = \"a\"\nrole = \"read\"",
        ),
        head("[store]\nthin_after_d = 0"),
        head("[mqtt]\nbroker = \"a b\""),
        head("[mqtt]\nbroker = \"a\"\nprefix = \"#\""),
        head("[mqtt]\nbroker = \"a\"\nca_file = \"ca.pem\""),
        head("[[webhook]]\nurl = \"http://example.org\"\nca_file = \"ca.pem\""),
        head("[web]\ntoken = [{ name = \"a\", role = \"read\" }]"),
        head("[recording]\nmax_files = 0"),
    ] {
        match Config::parse(&text, "watch.toml", Path::new("/etc/sinew")) {
            Ok(_) => panic!("no error:\n{text}"),
            Err(error) => list.line(error.to_string()),
        }
    }
}

/// Lists the errors of the store, except those of SQLite and of files.
fn store_errors(list: &mut List) {
    list.section("Store errors");
    let (folder, file) = (PathBuf::from("/var/lib/sinew"), "/var/lib/sinew/watch.db");
    let all = [
        StoreError::Held {
            folder: folder.clone(),
            holder: "process 4711".into(),
        },
        StoreError::Folder {
            folder,
            source: std::io::Error::other("permission denied"),
        },
        StoreError::Foreign { file: file.into() },
        StoreError::Lost {
            file: file.into(),
            what: "is empty",
            remains: file.into(),
        },
        StoreError::Newer {
            file: file.into(),
            version: 9,
            supported: 3,
        },
        StoreError::Damaged {
            file: file.into(),
            reason: "database disk image is malformed".into(),
        },
        StoreError::Document {
            what: "an entry of the journal",
            robot: "arm-7".into(),
            reason: "missing field `event`".into(),
        },
    ];
    let position = |error: &StoreError| match error {
        StoreError::Held { .. } => 0,
        StoreError::Folder { .. } => 1,
        StoreError::Foreign { .. } => 2,
        StoreError::Lost { .. } => 3,
        StoreError::Newer { .. } => 4,
        StoreError::Damaged { .. } => 5,
        StoreError::Document { .. } => 6,
        StoreError::Sqlite(_) | StoreError::File(_) => unreachable!("{error}"),
    };
    assert!(all.iter().map(position).eq(0..7));
    for error in all {
        list.line(error.to_string());
    }
}
