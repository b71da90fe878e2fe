//! Whatever comes in whatever order: what is stored agrees with itself, and what is shown with what is stored.

use crate::support::{HZ, Store, Watched, plain, tensioned};
use proptest::prelude::*;
use sinew_watch_core::alarm::{
    Alarm, AlarmCause, AlarmKey, AlarmState, AlarmsStored, Condition, TransitionWhy, Trouble,
};
use sinew_watch_core::command::What;
use sinew_watch_core::journal::Event;
use sinew_watch_core::snapshot::Freshness;
use sinew_watch_core::{Instant, Monitor};
use std::collections::BTreeMap;

#[derive(Debug, Clone)]
enum Op {
    /// Frames come from here on, tenths of a second.
    Frames(usize, usize),
    Pass(f64),
    StepUtc(f64),
    Say(What, &'static str),
    Troubles(bool),
    Dropped(u64),
    StoreFails(bool),
    /// Jobs are left lying.
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
        joints().prop_map(|joints| What::Tensioned { joints }),
        joints().prop_map(|joints| What::Replaced { joints }),
        key().prop_map(|alarm| What::Acknowledge { alarm }),
        (key(), 1.0..1e5).prop_map(|(alarm, for_s)| What::Shelve { alarm, for_s }),
        key().prop_map(|alarm| What::Reset { alarm }),
        Just(What::Note),
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

/// Two alarms that latch, from before.
fn before() -> Store {
    let alarm = |joint: &str, condition, state| Alarm {
        key: AlarmKey {
            joint: Some(joint.into()),
            condition,
        },
        state,
        acknowledged: false,
        raised_utc_s: 1.79e9,
        cause: AlarmCause::InDoubt { for_s: 1.0 },
        shelved_until_utc_s: None,
        shelved_for_s: None,
    };
    let mut store = Store::default();
    store.stored.alarms = AlarmsStored {
        alarms: vec![
            alarm("elbow", Condition::Jump, AlarmState::Latched),
            alarm("wrist", Condition::ReplaceLimit, AlarmState::Active),
        ],
    };
    store
}

fn states(alarms: &[Alarm]) -> BTreeMap<AlarmKey, AlarmState> {
    let all = alarms.iter().map(|alarm| (alarm.key.clone(), alarm.state));
    all.collect()
}

/// The alarms that the journal makes of those before it.
fn replayed(store: &Store) -> BTreeMap<AlarmKey, AlarmState> {
    let mut states = states(&before().stored.alarms.alarms);
    for entry in &store.journal {
        let Event::Alarm { transition } = &entry.event else {
            continue;
        };
        let from = states.remove(&transition.key).unwrap_or(AlarmState::Normal);
        assert_eq!(from, transition.from, "{transition:?}");
        if from == AlarmState::Latched && transition.to == AlarmState::Normal {
            let TransitionWhy::Command { what, note, .. } = &transition.why else {
                panic!("{transition:?}");
            };
            match what {
                What::Tensioned { .. } | What::Replaced { .. } => {}
                What::Reset { .. } => assert!(!note.is_empty()),
                other => panic!("{other:?} cleared {transition:?}"),
            }
        }
        if transition.to != AlarmState::Normal {
            states.insert(transition.key.clone(), transition.to);
        }
    }
    states
}

fn check(watched: &Watched) {
    let stored = &watched.store.stored;
    assert_eq!(
        replayed(&watched.store),
        states(&stored.alarms.alarms),
        "every step once"
    );
    let snapshot = watched.snapshot();
    for tendon in &snapshot.tendons {
        assert_eq!(tendon.offset_rad.is_some(), tendon.reason.is_none());
        if snapshot.freshness != Freshness::Fresh {
            assert_eq!(tendon.offset_rad, None, "an old number is no new one");
        }
        let of_joint = watched.store.records.iter().rev();
        let last = of_joint.clone().find(|r| r.joint == tendon.joint);
        assert_eq!(tendon.last.as_ref(), last, "what is shown is stored");
    }
}

fn run(watched: Watched, op: &Op, works: &mut bool) -> Watched {
    let mut watched = watched;
    match op {
        Op::Frames(from, count) => {
            let tenth = HZ / 10;
            let all = plain();
            let from = from * tenth % (all.len() - 150 * tenth);
            let mut now = watched.now;
            for (k, frame) in all[from..from + count * tenth].iter().enumerate() {
                watched.now = now.after_s(1.0 / HZ as f64);
                now = watched.now;
                watched.monitor.frame(frame, now);
                if k % tenth == 0 {
                    watched.monitor.tick(now);
                }
            }
        }
        Op::Pass(s) => {
            watched.now = watched.now.after_s(*s);
            watched.monitor.tick(watched.now);
        }
        Op::StepUtc(s) => watched.now.utc_ns += (s * 1e9) as i64,
        Op::Say(what, note) => {
            let command = sinew_watch_core::command::Command {
                who: "ada".into(),
                note: (*note).into(),
                what: what.clone(),
            };
            let _refused = watched.monitor.command(command, watched.now);
        }
        Op::Troubles(there) => {
            let trouble = Trouble::Decode {
                topic: "/joint_states".into(),
                why: "cut off".into(),
            };
            let troubles = [trouble];
            let now: &[Trouble] = if *there { &troubles } else { &[] };
            watched.monitor.troubles(now, watched.now);
        }
        Op::Dropped(messages) => watched.monitor.dropped(*messages, watched.now),
        Op::StoreFails(fails) => watched.store.fails = *fails,
        Op::Idle(idle) => *works = !idle,
        Op::Restart(off_s) => {
            let stored = watched.store.stored.clone();
            watched = watched.restart(*off_s);
            assert_eq!(
                watched.store.stored.belief.is_some(),
                stored.belief.is_some()
            );
            if let (Some(now), Some(then)) = (&watched.store.stored.belief, &stored.belief) {
                assert_eq!(now.tendons, then.tendons, "a restart teaches nothing");
            }
        }
    }
    watched
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn what_is_stored_agrees_with_itself_and_what_is_shown_with_it(
        ops in prop::collection::vec(op(), 1..40)
    ) {
        let now = Instant { monotonic_ns: 0, utc_ns: crate::support::MONDAY_NS };
        let mut watched = Watched::restored(tensioned(), before(), now);
        let mut works = true;
        for op in &ops {
            watched = run(watched, op, &mut works);
            if works {
                watched.settle();
            } else {
                watched.store();
            }
            check(&watched);
        }
        // All that was left lying is done in the end, and it all ends.
        watched.store.fails = false;
        watched.monitor.shutdown(watched.now);
        watched.settle();
        check(&watched);
        prop_assert_eq!(watched.snapshot().waiting_to_be_stored, 0);
        prop_assert!(Monitor::job(&mut watched.monitor).is_none());
    }
}
