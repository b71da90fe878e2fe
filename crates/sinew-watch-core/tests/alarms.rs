//! Whatever happens in whatever order: nothing clears a latched alarm but who may, no shelf is endless, none hides an
//! error, every step is told once.

use proptest::prelude::*;
use sinew_watch_core::Instant;
use sinew_watch_core::alarm::{
    Alarm, AlarmCause, AlarmKey, AlarmState, Alarms, Condition, Delays, Level,
};
use sinew_watch_core::command::{Command, CommandError, LONGEST_SHELF_S, What};
use std::collections::BTreeMap;

/// What may happen to the alarms of a robot.
#[derive(Debug, Clone)]
enum Op {
    Condition(AlarmKey, Option<bool>),
    Say(Command),
    /// Time passes, s.
    Pass(f64),
    /// The civil clock steps, s.
    Step(f64),
    /// The monitor starts again, so many seconds later.
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

fn what() -> impl Strategy<Value = What> {
    let joints = || prop::sample::subsequence(JOINTS.map(String::from).to_vec(), 0..=2);
    let for_s = prop_oneof![
        0.1..100.0,
        1.0..2.0 * LONGEST_SHELF_S,
        Just(f64::NAN),
        Just(-1.0)
    ];
    prop_oneof![
        joints().prop_map(|joints| What::Tensioned { joints }),
        joints().prop_map(|joints| What::Replaced { joints }),
        key().prop_map(|alarm| What::Acknowledge { alarm }),
        (key(), for_s).prop_map(|(alarm, for_s)| What::Shelve { alarm, for_s }),
        key().prop_map(|alarm| What::Unshelve { alarm }),
        key().prop_map(|alarm| What::Reset { alarm }),
        Just(What::Note),
    ]
}

fn op() -> impl Strategy<Value = Op> {
    let note = prop_oneof![Just(String::new()), Just("looked at it".to_string())];
    let say = (what(), note).prop_map(|(what, note)| {
        Op::Say(Command {
            who: "ada".into(),
            note,
            what,
        })
    });
    let holds = prop_oneof![Just(None), Just(Some(true)), Just(Some(false))];
    prop_oneof![
        4 => (key(), holds).prop_map(|(key, holds)| Op::Condition(key, holds)),
        4 => say,
        2 => (0.0..2000.0).prop_map(Op::Pass),
        1 => (-1e5..1e5).prop_map(Op::Step),
        1 => (0.0..1e5).prop_map(Op::Restart),
    ]
}

/// The alarms, their clock, and what was told of them.
struct World {
    alarms: Alarms,
    now: Instant,
    /// As the transitions have it.
    told: BTreeMap<AlarmKey, AlarmState>,
}

fn states(alarms: &Alarms) -> BTreeMap<AlarmKey, AlarmState> {
    let all = alarms.iter().map(|alarm| (alarm.key.clone(), alarm.state));
    all.collect()
}

fn cause() -> AlarmCause {
    AlarmCause::InDoubt { for_s: 600.0 }
}

impl World {
    fn new() -> Self {
        Self {
            alarms: Alarms::default(),
            now: Instant {
                monotonic_ns: 0,
                utc_ns: 1_793_606_400_000_000_000,
            },
            told: BTreeMap::new(),
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
            let from = self.told.remove(&transition.key);
            assert_eq!(
                from.unwrap_or(AlarmState::Normal),
                transition.from,
                "{transition:?}"
            );
            if transition.to != AlarmState::Normal {
                self.told.insert(transition.key, transition.to);
            }
        }
        result
    }
}

/// Whether an operation may end a latched alarm.
fn may_clear(op: &Op, key: &AlarmKey) -> bool {
    let Op::Say(command) = op else { return false };
    let named = |joints: &Vec<String>| {
        let joint = key.joint.as_ref();
        joint.is_some_and(|joint| joints.is_empty() || joints.contains(joint))
    };
    match &command.what {
        What::Tensioned { joints } => named(joints) && key.condition != Condition::ReplaceLimit,
        What::Replaced { joints } => named(joints),
        What::Reset { alarm } => alarm == key && !command.note.is_empty(),
        _ => false,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn nothing_clears_a_latched_alarm_but_who_may(ops in prop::collection::vec(op(), 1..60)) {
        let mut world = World::new();
        for op in &ops {
            let before: Vec<Alarm> = world.alarms.iter().cloned().collect();
            let refused = world.run(op).is_err();
            for alarm in before.iter().filter(|alarm| alarm.key.condition.latches()) {
                if world.alarms.get(&alarm.key).is_none() {
                    prop_assert!(!refused && may_clear(op, &alarm.key), "{op:?} cleared {alarm:?}");
                }
            }
            if refused {
                let after: Vec<Alarm> = world.alarms.iter().cloned().collect();
                prop_assert_eq!(before, after, "what is refused changes nothing");
            }
        }
    }

    #[test]
    fn no_shelf_is_endless_and_none_hides_an_error(ops in prop::collection::vec(op(), 1..60)) {
        let mut world = World::new();
        for op in &ops {
            // A shelf that is too long, or none, is refused.
            let _refused = world.run(op);
            for alarm in world.alarms.iter() {
                let is_on = alarm.state != AlarmState::Cleared;
                if alarm.key.condition.level() == Level::Error && is_on {
                    prop_assert_eq!(alarm.level(), Level::Error, "{:?}", alarm);
                }
                prop_assert_eq!(alarm.shelved_for_s.is_some(), alarm.shelved_until_utc_s.is_some());
                prop_assert!(alarm.shelved_for_s.is_none_or(|s| s <= LONGEST_SHELF_S));
            }
        }
        // Whatever the civil clock did: a week of the clock that never steps ends every shelf.
        world.now.monotonic_ns += (LONGEST_SHELF_S * 1e9) as i64;
        world.alarms.tick(world.now);
        prop_assert!(world.alarms.iter().all(|alarm| alarm.shelved_for_s.is_none()));
    }

    #[test]
    fn every_step_is_told_once(ops in prop::collection::vec(op(), 1..60)) {
        let mut world = World::new();
        for op in &ops {
            let _refused = world.run(op);
            prop_assert_eq!(&world.told, &states(&world.alarms), "after {:?}", op);
        }
    }

    #[test]
    fn what_is_stored_is_what_is_restored(ops in prop::collection::vec(op(), 1..60)) {
        let mut world = World::new();
        for op in &ops {
            let _refused = world.run(op);
        }
        let text = serde_json::to_string(&world.alarms.stored()).unwrap();
        let again = Alarms::restore(serde_json::from_str(&text).unwrap(), world.now);
        let mut before: Vec<Alarm> = world.alarms.iter().cloned().collect();
        for alarm in &mut before {
            // Only a civil clock that stepped back can have a shelf last longer than it was made.
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
fn a_condition_waits_for_its_delays() {
    let key = AlarmKey {
        joint: Some("elbow".into()),
        condition: Condition::RetensionLimit,
    };
    let delays = Delays {
        raise_after_s: 600.0,
        clear_after_s: 300.0,
    };
    let mut world = World::new();
    let say = |world: &mut World, holds, s| {
        world.now = world.now.after_s(s);
        world
            .alarms
            .condition(&key, holds, &cause(), delays, world.now);
        world.alarms.get(&key).map(|alarm| alarm.state)
    };
    assert_eq!(say(&mut world, Some(true), 0.0), None);
    assert_eq!(say(&mut world, Some(true), 599.0), None);
    // Between raising and clearing nothing waits on.
    assert_eq!(say(&mut world, None, 1.0), None);
    assert_eq!(say(&mut world, Some(true), 1.0), None);
    assert_eq!(say(&mut world, Some(true), 600.0), Some(AlarmState::Active));
    assert_eq!(say(&mut world, Some(false), 1.0), Some(AlarmState::Active));
    assert_eq!(say(&mut world, Some(true), 299.0), Some(AlarmState::Active));
    assert_eq!(say(&mut world, Some(false), 1.0), Some(AlarmState::Active));
    assert_eq!(
        say(&mut world, Some(false), 300.0),
        Some(AlarmState::Cleared)
    );
}

#[test]
fn a_robot_that_is_switched_off_needs_no_look_in_the_morning() {
    let mut world = World::new();
    let key = AlarmKey {
        joint: None,
        condition: Condition::NoData,
    };
    world.run(&Op::Condition(key.clone(), Some(true))).unwrap();
    assert_eq!(world.told[&key], AlarmState::Active);
    world.run(&Op::Condition(key, Some(false))).unwrap();
    assert_eq!(world.told.len(), 0);
}

#[test]
fn severities_are_those_of_the_table() {
    let latching = Condition::ALL.iter().filter(|c| c.latches()).count();
    assert_eq!(latching, 3);
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
            Condition::ReplaceLimit,
            Condition::StrandFailed,
            Condition::Jump,
            Condition::Store,
            Condition::Door
        ]
    );
}
