//! Property tests: stored data are consistent, and snapshots agree with them, for any order of inputs.

use crate::support::{HZ, Harness, Store, plain, tensioned};
use proptest::prelude::*;
use sinew_watch_core::alarm::{
    Alarm, AlarmCause, AlarmKey, AlarmState, AlarmsStored, Condition, DataFault, TransitionReason,
};
use sinew_watch_core::command::CommandKind;
use sinew_watch_core::journal::Event;
use sinew_watch_core::snapshot::Freshness;
use sinew_watch_core::{Instant, Monitor};
use std::collections::BTreeMap;

#[derive(Debug, Clone)]
enum Op {
    /// Frames from this index, units of 0.1 s.
    Frames(usize, usize),
    Pass(f64),
    StepUtc(f64),
    Say(CommandKind, &'static str),
    Troubles(bool),
    Dropped(u64),
    StoreFails(bool),
    /// Jobs are not run.
    Idle(bool),
    Restart(f64),
}

fn key() -> impl Strategy<Value = AlarmKey> {
    let joint = prop::sample::select(vec![None, Some("elbow"), Some("wrist")]);
    let condition = prop::sample::select(Condition::ALL.as_slice());
    (joint, condition).prop_map(|(joint, condition)| AlarmKey {
        joint: joint.map(str::to_string),
        condition,
    })
}

fn say() -> impl Strategy<Value = Op> {
    let joints = || prop::sample::subsequence(vec!["elbow".to_string(), "wrist".into()], 0..=2);
    let what = prop_oneof![
        joints().prop_map(|joints| CommandKind::Tensioned { joints }),
        joints().prop_map(|joints| CommandKind::Replaced { joints }),
        key().prop_map(|alarm| CommandKind::Acknowledge { alarm }),
        (key(), 1.0..1e5).prop_map(|(alarm, for_s)| CommandKind::Shelve { alarm, for_s }),
        key().prop_map(|alarm| CommandKind::Reset { alarm }),
        Just(CommandKind::Note),
    ];
    let note = prop::sample::select(vec!["", "seen"]);
    (what, note).prop_map(|(what, note)| Op::Say(what, note))
}

fn op() -> impl Strategy<Value = Op> {
    prop_oneof![
        4 => (0..2000usize, 1..150usize).prop_map(|(from, count)| Op::Frames(from, count)),
        2 => (0.1..90.0).prop_map(Op::Pass),
        1 => (-8000.0..8000.0).prop_map(Op::StepUtc),
        3 => say(),
        1 => any::<bool>().prop_map(Op::Troubles),
        1 => (1..5000u64).prop_map(Op::Dropped),
        1 => any::<bool>().prop_map(Op::StoreFails),
        1 => any::<bool>().prop_map(Op::Idle),
        1 => (0.0..1e5).prop_map(Op::Restart),
    ]
}

/// Store with two latched alarms.
fn before() -> Store {
    let alarm = |joint: &str, condition, state| Alarm {
        key: AlarmKey {
            joint: Some(joint.into()),
            condition,
        },
        state,
        acknowledged: false,
        raised_utc_s: 1.79e9,
        cause: AlarmCause::Provisional { for_s: 1.0 },
        shelved_until_utc_s: None,
        shelved_for_s: None,
    };
    let mut store = Store::default();
    store.stored.alarms = AlarmsStored {
        alarms: vec![
            alarm("elbow", Condition::StepChange, AlarmState::Latched),
            alarm("wrist", Condition::ReplaceLimit, AlarmState::Active),
        ],
    };
    store
}

fn states(alarms: &[Alarm]) -> BTreeMap<AlarmKey, AlarmState> {
    let all = alarms.iter().map(|alarm| (alarm.key.clone(), alarm.state));
    all.collect()
}

/// Alarm states after replaying the journal.
fn replayed(store: &Store) -> BTreeMap<AlarmKey, AlarmState> {
    let mut states = states(&before().stored.alarms.alarms);
    for entry in &store.journal {
        let Event::Alarm { transition } = &entry.event else {
            continue;
        };
        let from = states.remove(&transition.key).unwrap_or(AlarmState::Normal);
        assert_eq!(from, transition.from, "{transition:?}");
        if from == AlarmState::Latched && transition.to == AlarmState::Normal {
            let TransitionReason::Command { what, note, .. } = &transition.reason else {
                panic!("{transition:?}");
            };
            match what {
                CommandKind::Tensioned { .. } | CommandKind::Replaced { .. } => {}
                CommandKind::Reset { .. } => assert!(!note.is_empty()),
                other => panic!("{other:?} cleared {transition:?}"),
            }
        }
        if transition.to != AlarmState::Normal {
            states.insert(transition.key.clone(), transition.to);
        }
    }
    states
}

fn check(harness: &Harness) {
    let stored = &harness.store.stored;
    assert_eq!(
        replayed(&harness.store),
        states(&stored.alarms.alarms),
        "every step once"
    );
    let snapshot = harness.snapshot();
    for tendon in &snapshot.tendons {
        assert_eq!(tendon.offset_rad.is_some(), tendon.reason.is_none());
        if snapshot.freshness != Freshness::Fresh {
            assert_eq!(tendon.offset_rad, None, "an old number is no new one");
        }
        let of_joint = harness.store.records.iter().rev();
        let last = of_joint.clone().find(|r| r.joint == tendon.joint);
        assert_eq!(tendon.last.as_ref(), last, "what is shown is stored");
    }
}

fn run(harness: Harness, op: &Op, works: &mut bool) -> Harness {
    let mut harness = harness;
    match op {
        Op::Frames(from, count) => {
            let tenth = HZ / 10;
            let all = plain();
            let from = from * tenth % (all.len() - 150 * tenth);
            let mut now = harness.now;
            for (k, frame) in all[from..from + count * tenth].iter().enumerate() {
                harness.now = now.after_s(1.0 / HZ as f64);
                now = harness.now;
                harness.monitor.frame(frame, now);
                if k % tenth == 0 {
                    harness.monitor.tick(now);
                }
            }
        }
        Op::Pass(s) => {
            harness.now = harness.now.after_s(*s);
            harness.monitor.tick(harness.now);
        }
        Op::StepUtc(s) => harness.now.utc_ns += (s * 1e9) as i64,
        Op::Say(what, note) => {
            let command = sinew_watch_core::command::Command {
                who: "ada".into(),
                note: (*note).into(),
                what: what.clone(),
            };
            let _refused = harness.monitor.command(command, harness.now);
        }
        Op::Troubles(there) => {
            let trouble = DataFault::Decode {
                topic: "/joint_states".into(),
                reason: "cut off".into(),
            };
            let troubles = [trouble];
            let now: &[DataFault] = if *there { &troubles } else { &[] };
            harness.monitor.transport_faults(now, harness.now);
        }
        Op::Dropped(messages) => harness.monitor.dropped(*messages, harness.now),
        Op::StoreFails(fails) => harness.store.fails = *fails,
        Op::Idle(idle) => *works = !idle,
        Op::Restart(off_s) => {
            let stored = harness.store.stored.clone();
            harness = harness.restart(*off_s);
            assert_eq!(harness.store.stored.state.is_some(), stored.state.is_some());
            if let (Some(now), Some(then)) = (&harness.store.stored.state, &stored.state) {
                assert_eq!(now.tendons, then.tendons, "a restart teaches nothing");
            }
        }
    }
    harness
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn stored_data_and_snapshot_are_consistent(
        ops in prop::collection::vec(op(), 1..40)
    ) {
        let now = Instant { monotonic_ns: 0, utc_ns: crate::support::MONDAY_NS };
        let mut harness = Harness::restored(tensioned(), before(), now);
        let mut works = true;
        for op in &ops {
            harness = run(harness, op, &mut works);
            if works {
                harness.settle();
            } else {
                harness.store();
            }
            check(&harness);
        }
        // All pending jobs are run at the end, and all sessions end.
        harness.store.fails = false;
        harness.monitor.shutdown(harness.now);
        harness.settle();
        check(&harness);
        prop_assert_eq!(harness.snapshot().waiting_to_be_stored, 0);
        prop_assert!(Monitor::job(&mut harness.monitor).is_none());
    }
}
