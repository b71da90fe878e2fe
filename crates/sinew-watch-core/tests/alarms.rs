//! Property tests of the alarms: latched alarms are cleared only by permitted commands, every shelving ends, errors are
//! never hidden, and every transition is reported once.

use proptest::prelude::*;
use sinew_watch_core::Instant;
use sinew_watch_core::alarm::{
    Alarm, AlarmCause, AlarmKey, AlarmState, Alarms, AlarmsStored, Condition, Delays, Level,
    LimitOrigin, StepKind, TransitionReason,
};
use sinew_watch_core::command::{Command, CommandError, CommandKind, MAX_SHELF_S};
use sinew_watch_core::incident::{Evidence, Finding, IncidentPhase, Incidents};
use std::collections::BTreeMap;

/// Operation on the alarms of a robot.
#[derive(Debug, Clone)]
enum Op {
    Condition(AlarmKey, Option<bool>),
    Say(Command),
    /// Elapsed time, s.
    Pass(f64),
    /// Step of the civil clock, s.
    Step(f64),
    /// Restart of the monitor after a delay, s.
    Restart(f64),
}

const JOINTS: [&str; 2] = ["elbow", "wrist"];

fn key() -> impl Strategy<Value = AlarmKey> {
    let joint = prop_oneof![
        Just(None),
        prop::sample::select(JOINTS.as_slice()).prop_map(|j| Some(j.to_string()))
    ];
    let condition = prop::sample::select(Condition::ALL.as_slice());
    (joint, condition).prop_map(|(joint, condition)| AlarmKey { joint, condition })
}

fn what() -> impl Strategy<Value = CommandKind> {
    let joints = || prop::sample::subsequence(JOINTS.map(String::from).to_vec(), 1..=2);
    let joint = prop::sample::select(JOINTS.as_slice());
    let finding = prop::sample::select(vec![Finding::StrandFailure, Finding::Nothing]);
    let for_s = prop_oneof![
        0.1..100.0,
        1.0..2.0 * MAX_SHELF_S,
        Just(f64::NAN),
        Just(-1.0)
    ];
    prop_oneof![
        joints().prop_map(|joints| CommandKind::Tensioned { joints }),
        joints().prop_map(|joints| CommandKind::Replaced { joints }),
        key().prop_map(|alarm| CommandKind::Acknowledge { alarm }),
        (key(), for_s).prop_map(|(alarm, for_s)| CommandKind::Shelve { alarm, for_s }),
        key().prop_map(|alarm| CommandKind::Unshelve { alarm }),
        key().prop_map(|alarm| CommandKind::Reset { alarm }),
        (joint, finding).prop_map(|(joint, finding)| CommandKind::Finding {
            joint: joint.into(),
            finding,
        }),
        Just(CommandKind::Note),
    ]
}

fn op() -> impl Strategy<Value = Op> {
    let note = prop_oneof![Just(String::new()), Just("looked at it".to_string())];
    let update = (what(), note).prop_map(|(what, note)| {
        Op::Say(Command {
            who: "ada".into(),
            note,
            what,
        })
    });
    let holds = prop_oneof![Just(None), Just(Some(true)), Just(Some(false))];
    prop_oneof![
        4 => (key(), holds).prop_map(|(key, holds)| Op::Condition(key, holds)),
        4 => update,
        2 => (0.0..2000.0).prop_map(Op::Pass),
        1 => (-1e5..1e5).prop_map(Op::Step),
        1 => (0.0..1e5).prop_map(Op::Restart),
    ]
}

/// Alarms, their clock, and the reported transitions.
struct World {
    alarms: Alarms,
    now: Instant,
    /// States according to the transitions.
    reported: BTreeMap<AlarmKey, AlarmState>,
}

fn states(alarms: &Alarms) -> BTreeMap<AlarmKey, AlarmState> {
    let all = alarms.iter().map(|alarm| (alarm.key.clone(), alarm.state));
    all.collect()
}

fn cause() -> AlarmCause {
    AlarmCause::Provisional { for_s: 600.0 }
}

impl World {
    fn new() -> Self {
        Self {
            alarms: Alarms::default(),
            now: Instant {
                monotonic_ns: 0,
                utc_ns: 1_793_606_400_000_000_000,
            },
            reported: BTreeMap::new(),
        }
    }

    fn run(&mut self, op: &Op) -> Result<(), CommandError> {
        let mut result = Ok(());
        match op {
            Op::Condition(key, holds) => {
                let delays = Delays::of(key.condition);
                self.alarms
                    .condition(key, *holds, &cause(), delays, self.now);
            }
            Op::Say(command) => result = self.alarms.command(command, self.now),
            Op::Pass(s) => {
                self.now = self.now.after_s(*s);
                self.alarms.tick(self.now);
            }
            Op::Step(s) => self.now.utc_ns += (s * 1e9) as i64,
            Op::Restart(s) => {
                self.now = self.now.after_s(*s);
                self.now.monotonic_ns = 77;
                self.alarms = Alarms::restore(self.alarms.stored(), self.now);
            }
        }
        for transition in self.alarms.take_transitions() {
            let from = self.reported.remove(&transition.key);
            assert_eq!(
                from.unwrap_or(AlarmState::Normal),
                transition.from,
                "{transition:?}"
            );
            if transition.to != AlarmState::Normal {
                self.reported.insert(transition.key, transition.to);
            }
        }
        result
    }
}

/// Whether an operation may clear a latched alarm.
fn may_clear(op: &Op, key: &AlarmKey) -> bool {
    let Op::Say(command) = op else { return false };
    let named = |joints: &Vec<String>| {
        let joint = key.joint.as_ref();
        joint.is_some_and(|joint| joints.contains(joint))
    };
    match &command.what {
        CommandKind::Tensioned { joints } => {
            named(joints) && key.condition != Condition::ReplaceLimit
        }
        CommandKind::Replaced { joints } => named(joints),
        CommandKind::Reset { alarm } => alarm == key && !command.note.is_empty(),
        CommandKind::Finding { joint, finding } => {
            key.joint.as_ref() == Some(joint)
                && key.condition.is_change()
                && !finding.needs_repair()
        }
        _ => false,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn latched_alarm_cleared_only_by_permitted_command(ops in prop::collection::vec(op(), 1..60)) {
        let mut world = World::new();
        for op in &ops {
            let before: Vec<Alarm> = world.alarms.iter().cloned().collect();
            let rejected = world.run(op).is_err();
            for alarm in before.iter().filter(|alarm| alarm.key.condition.latches()) {
                if world.alarms.get(&alarm.key).is_none() {
                    prop_assert!(!rejected && may_clear(op, &alarm.key), "{op:?} cleared {alarm:?}");
                }
            }
            if rejected {
                let after: Vec<Alarm> = world.alarms.iter().cloned().collect();
                prop_assert_eq!(before, after, "a rejected command changes nothing");
            }
        }
    }

    #[test]
    fn shelving_ends_and_never_hides_errors(ops in prop::collection::vec(op(), 1..60)) {
        let mut world = World::new();
        for op in &ops {
            // An invalid duration of shelving is rejected.
            let _rejected = world.run(op);
            for alarm in world.alarms.iter() {
                let is_on = alarm.state != AlarmState::Cleared;
                if alarm.key.condition.level() == Level::Error && is_on {
                    prop_assert_eq!(alarm.level(), Level::Error, "{:?}", alarm);
                }
                prop_assert_eq!(alarm.shelved_for_s.is_some(), alarm.shelved_until_utc_s.is_some());
                prop_assert!(alarm.shelved_for_s.is_none_or(|s| s <= MAX_SHELF_S));
            }
        }
        // Seven days of the monotonic clock end every shelving, independent of the civil clock.
        world.now.monotonic_ns += (MAX_SHELF_S * 1e9) as i64;
        world.alarms.tick(world.now);
        prop_assert!(world.alarms.iter().all(|alarm| alarm.shelved_for_s.is_none()));
    }

    #[test]
    fn transitions_are_reported_once(ops in prop::collection::vec(op(), 1..60)) {
        let mut world = World::new();
        for op in &ops {
            let _rejected = world.run(op);
            prop_assert_eq!(&world.reported, &states(&world.alarms), "after {:?}", op);
        }
    }

    #[test]
    fn stored_alarms_restore_identically(ops in prop::collection::vec(op(), 1..60)) {
        let mut world = World::new();
        for op in &ops {
            let _rejected = world.run(op);
        }
        let text = serde_json::to_string(&world.alarms.stored()).unwrap();
        let again = Alarms::restore(serde_json::from_str(&text).unwrap(), world.now);
        let mut before: Vec<Alarm> = world.alarms.iter().cloned().collect();
        for alarm in &mut before {
            // A remaining time longer than the duration is only possible after a backward step of the civil clock.
            let left_s = alarm.shelved_until_utc_s.map(|until| until - world.now.utc_s());
            if left_s.is_some_and(|s| s <= 0.0 || Some(s) > alarm.shelved_for_s) {
                (alarm.shelved_until_utc_s, alarm.shelved_for_s) = (None, None);
            }
        }
        let after: Vec<Alarm> = again.iter().cloned().collect();
        prop_assert_eq!(before, after);
    }
}

#[test]
fn condition_follows_delays() {
    let key = AlarmKey {
        joint: Some("elbow".into()),
        condition: Condition::RetensionLimit,
    };
    let delays = Delays {
        raise_after_s: 600.0,
        clear_after_s: 300.0,
    };
    let mut world = World::new();
    let update = |world: &mut World, holds, s| {
        world.now = world.now.after_s(s);
        world
            .alarms
            .condition(&key, holds, &cause(), delays, world.now);
        world.alarms.get(&key).map(|alarm| alarm.state)
    };
    assert_eq!(update(&mut world, Some(true), 0.0), None);
    assert_eq!(update(&mut world, Some(true), 599.0), None);
    // Between the thresholds of raising and clearing the delays restart.
    assert_eq!(update(&mut world, None, 1.0), None);
    assert_eq!(update(&mut world, Some(true), 1.0), None);
    assert_eq!(
        update(&mut world, Some(true), 600.0),
        Some(AlarmState::Active)
    );
    assert_eq!(
        update(&mut world, Some(false), 1.0),
        Some(AlarmState::Active)
    );
    assert_eq!(
        update(&mut world, Some(true), 299.0),
        Some(AlarmState::Active)
    );
    assert_eq!(
        update(&mut world, Some(false), 1.0),
        Some(AlarmState::Active)
    );
    assert_eq!(
        update(&mut world, Some(false), 300.0),
        Some(AlarmState::Cleared)
    );
}

/// The alarm shows the newest cause; its time and the journal keep the raising.
#[test]
fn cause_follows_newest_and_journal_keeps_that_of_raising() {
    let key = AlarmKey {
        joint: Some("elbow".into()),
        condition: Condition::RetensionLimit,
    };
    let limit = |mean| AlarmCause::Limit {
        mean,
        std: 1e-5,
        limit: 5e-4,
        probability: 0.99,
        origin: LimitOrigin::RobotToml,
    };
    let mut world = World::new();
    let raised_utc_s = world.now.utc_s();
    let on = |alarms: &mut Alarms, cause: &AlarmCause, now| {
        alarms.condition(&key, Some(true), cause, Delays::NONE, now);
    };
    on(&mut world.alarms, &limit(5.3e-4), world.now);
    let transitions = world.alarms.take_transitions();
    assert!(!world.alarms.take_changed());
    world.now = world.now.after_s(86_400.0);
    on(&mut world.alarms, &limit(6.1e-4), world.now);
    assert!(world.alarms.take_changed() && world.alarms.take_transitions().is_empty());
    let alarm = world.alarms.get(&key).unwrap();
    assert_eq!(
        (alarm.raised_utc_s, &alarm.cause),
        (raised_utc_s, &limit(6.1e-4))
    );
    let cause = limit(5.3e-4);
    assert_eq!(transitions[0].reason, TransitionReason::Condition { cause });
    on(&mut world.alarms, &limit(6.1e-4), world.now);
    assert!(!world.alarms.take_changed());
}

#[test]
fn suspected_strand_failure_precedes_limits_of_elongation() {
    let alarm = |condition, cause| Alarm {
        key: AlarmKey {
            joint: Some("elbow".into()),
            condition,
        },
        state: AlarmState::Active,
        acknowledged: false,
        raised_utc_s: 0.0,
        cause,
        shelved_until_utc_s: None,
        shelved_for_s: None,
    };
    let suspected = |what| {
        let cause = AlarmCause::StepChange {
            time_utc_s: 0.0,
            size_rad: 5e-3,
            std_rad: 1e-3,
            what,
            cause: None,
            stiffness_ratio: None,
        };
        alarm(Condition::SuspectedStep, cause).severity()
    };
    let soon = AlarmCause::Soon {
        limit: None,
        at_low_utc_s: None,
        at_utc_s: None,
        at_high_utc_s: None,
    };
    let near = alarm(Condition::LimitNear, soon).severity();
    assert!(suspected(StepKind::StrandFailure) > Condition::RetensionLimit.severity());
    assert!(suspected(StepKind::SlipOrStrandFailure) > Condition::RetensionLimit.severity());
    assert!(suspected(StepKind::StrandFailure) < Condition::StepChange.severity());
    assert!(suspected(StepKind::Slip) > near);
    assert!(alarm(Condition::SuspectedStep, cause()).severity() < near);
}

/// A forecast stored by an earlier version has no dates until the next trend.
#[test]
fn alarms_of_earlier_version_are_read() {
    let text = r#"{"alarms": [{"key": {"joint": "elbow", "condition": "limit-near"}, "state": "active",
        "acknowledged": false, "raised_utc_s": 1.0, "shelved_until_utc_s": null, "shelved_for_s": null,
        "cause": {"kind": "soon", "after_low_s": 9.0, "after_s": null}}]}"#;
    let stored: AlarmsStored = serde_json::from_str(text).unwrap();
    let cause = &stored.alarms[0].cause;
    assert!(matches!(
        cause,
        AlarmCause::Soon {
            at_low_utc_s: None,
            ..
        }
    ));
}

/// Operation on the incidents of two tendons.
#[derive(Debug, Clone)]
enum IncidentOp {
    Suspect,
    Confirm,
    Refute,
    Acknowledge,
    Repair,
    Find(Finding),
    Reset,
}

fn incident_op() -> impl Strategy<Value = (usize, IncidentOp)> {
    let findings = vec![Finding::StrandFailure, Finding::ClampSlip, Finding::Nothing];
    let op = prop_oneof![
        3 => Just(IncidentOp::Suspect),
        2 => Just(IncidentOp::Confirm),
        2 => Just(IncidentOp::Refute),
        1 => Just(IncidentOp::Acknowledge),
        1 => Just(IncidentOp::Repair),
        1 => prop::sample::select(findings).prop_map(IncidentOp::Find),
        1 => Just(IncidentOp::Reset),
    ];
    (0..JOINTS.len(), op)
}

proptest! {
    #[test]
    fn tendon_has_at_most_one_open_incident(ops in prop::collection::vec(incident_op(), 1..400)) {
        let mut incidents = Incidents::default();
        for (k, (tendon, op)) in ops.iter().enumerate() {
            let (joint, utc_s) = (JOINTS[*tendon], k as f64);
            let evidence = Evidence {
                time_utc_s: utc_s,
                offset_rad: None,
                stiffness_ratio: None,
                probability: 0.5,
            };
            let before = incidents.open(joint).cloned();
            match op {
                IncidentOp::Suspect => {
                    incidents.suspect(joint, evidence, Vec::new(), utc_s);
                }
                IncidentOp::Confirm => {
                    incidents.confirm(joint, evidence, Vec::new(), utc_s);
                }
                IncidentOp::Refute => {
                    incidents.refute(joint, evidence, Vec::new(), utc_s);
                }
                IncidentOp::Acknowledge => {
                    incidents.acknowledge(joint);
                }
                IncidentOp::Repair => {
                    incidents.repair(joint, utc_s);
                }
                IncidentOp::Find(finding) => {
                    incidents.find(joint, *finding, "", utc_s);
                }
                IncidentOp::Reset => {
                    incidents.reset(joint, "", utc_s);
                }
            }
            let open = |joint: &str| {
                let of = incidents.iter().filter(|i| i.joint == joint && i.is_open());
                of.count()
            };
            for joint in JOINTS {
                prop_assert!(open(joint) <= 1, "{joint} after {op:?}");
            }
            // New evidence for a change always has an open incident; a confirmed one is not closed by evidence.
            let now = incidents.open(joint);
            match (op, before.map(|incident| incident.phase)) {
                (IncidentOp::Suspect | IncidentOp::Confirm, _) => prop_assert!(now.is_some()),
                (IncidentOp::Refute, Some(IncidentPhase::Suspected)) => prop_assert!(now.is_none()),
                (IncidentOp::Refute, Some(phase)) => prop_assert_eq!(now.map(|i| i.phase), Some(phase)),
                _ => {}
            }
            prop_assert!(incidents.iter().all(|i| i.is_open() == i.closed_utc_s.is_none()));
            prop_assert!(incidents.iter().all(|i| i.evidence.len() <= 64));
            let numbers: Vec<u64> = incidents.iter().map(|i| i.number).collect();
            prop_assert!(numbers.windows(2).all(|w| w[0] < w[1]) && numbers.len() <= 52);
        }
    }
}

#[test]
fn no_data_alarm_clears_without_acknowledgement() {
    let mut world = World::new();
    let key = AlarmKey {
        joint: None,
        condition: Condition::NoData,
    };
    world.run(&Op::Condition(key.clone(), Some(true))).unwrap();
    assert_eq!(world.reported[&key], AlarmState::Active);
    world.run(&Op::Condition(key, Some(false))).unwrap();
    assert_eq!(world.reported.len(), 0);
}

#[test]
fn condition_severities_match_table() {
    let latching = Condition::ALL.iter().filter(|c| c.latches()).count();
    assert_eq!(latching, 4);
    assert!(
        Condition::ALL
            .windows(2)
            .all(|w| w[0].severity() >= w[1].severity())
    );
    let errors: Vec<Condition> = (Condition::ALL.into_iter())
        .filter(|c| c.level() == Level::Error)
        .collect();
    assert_eq!(
        errors,
        [
            Condition::TransmissionLost,
            Condition::ReplaceLimit,
            Condition::StrandFailure,
            Condition::StepChange,
            Condition::Store,
            Condition::Transport
        ]
    );
}
