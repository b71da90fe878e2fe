//! Behaviour of the demonstration as described in the README, without threads and clocks: every run is identical.

use super::{MOTION, RATE, alter::Crept, arms::Arm, arms::arms, baseline, history, monitor, robot};
use sinew_log::decode::{MessageKind, set_stamp_ns};
use sinew_log::live::{Live, LiveOptions};
use sinew_rope::Catalogue;
use sinew_transport::replay::Alter as _;
use sinew_watch_core::alarm::{AlarmKey, Condition};
use sinew_watch_core::incident::{IncidentCause, IncidentPhase};
use sinew_watch_core::{History, Instant, Monitor, RobotSnapshot, Stored};
use std::sync::Arc;

/// 2026-11-02 08:00 UTC, ns.
const START_NS: i64 = 1_793_606_400_000_000_000;

/// Duration of one repetition of the motion, s: the last message of one has the time of the first of the next.
const TURN_S: f64 = 23.99;

fn at(since_s: f64) -> Instant {
    let ns = |rate: f64| START_NS + (1e9 * rate * since_s) as i64;
    Instant {
        monotonic_ns: ns(1.0),
        utc_ns: ns(RATE),
    }
}

/// Returns the state of an arm after a number of repetitions, and the time at which each alarm was first active, s. The
/// motion begins `delay_s` after the demonstration.
fn played(arm: &Arm, seed: u64, turns: u32, delay_s: f64) -> (RobotSnapshot, Vec<(AlarmKey, f64)>) {
    let robot = Arc::new(robot().unwrap());
    let catalogue = Arc::new(Catalogue::shipped().unwrap());
    let (mut stored, mut history) = (Stored::default(), History::default());
    let before = history::transactions(arm, &robot, &baseline(&robot).unwrap(), at(0.0).utc_s());
    for transaction in before {
        transaction.records.iter().for_each(|record| {
            history.push(record);
        });
        stored.last_id = transaction.id;
        stored.state = transaction.state.map(Arc::unwrap_or_clone).or(stored.state);
    }
    stored.history = history;
    let config = monitor(arm.name, &robot, &catalogue);
    let mut monitor = Monitor::new(config, stored, at(0.0)).unwrap();
    let mut live = Live::new(&LiveOptions::of_joints(robot.joint_names())).unwrap();
    let mut crept = Crept::new(arm.tendons.clone(), RATE, seed);
    let mut alarms: Vec<(AlarmKey, f64)> = Vec::new();
    let mut ticked_s = 0.0;
    for turn in 0..turns {
        let mut first_ns = None;
        for message in mcap::MessageStream::new(MOTION).unwrap() {
            let message = message.unwrap();
            let log_ns = message.log_time as i64;
            let within_ns = log_ns - *first_ns.get_or_insert(log_ns);
            let played_s = TURN_S * f64::from(turn) + within_ns as f64 * 1e-9;
            let since_s = delay_s + played_s;
            let schema = message
                .channel
                .schema
                .as_ref()
                .map_or("", |s| s.name.as_str());
            let Some(topic) = live.topic(&message.channel.topic, schema) else {
                continue;
            };
            let (mut cdr, now) = (message.data.to_vec(), at(since_s));
            if MessageKind::of_schema(schema).is_some() {
                set_stamp_ns(&mut cdr, now.monotonic_ns);
            }
            crept.alter(&message.channel.topic, schema, since_s, &mut cdr);
            live.push(topic, &cdr, now.monotonic_ns);
            while let Some(frame) = live.frame() {
                monitor.frame(frame, now);
            }
            if since_s - ticked_s >= 1.0 {
                ticked_s = since_s;
                monitor.tick(now);
                while let Some(job) = monitor.job() {
                    monitor.done(job.run(), now);
                }
                while let Some(transaction) = monitor.transaction() {
                    monitor.committed(transaction.id, now);
                }
                for alarm in monitor.snapshot(now).alarms {
                    if !alarms.iter().any(|(key, _)| *key == alarm.key) {
                        alarms.push((alarm.key, since_s));
                    }
                }
            }
        }
    }
    let end_s = delay_s + TURN_S * f64::from(turns);
    (monitor.snapshot(at(end_s)), alarms)
}

/// The events of the banner happen, whenever the motion begins.
#[test]
fn demo_strand_failure_suspected_then_confirmed_next_day() {
    let all = arms(&robot().unwrap(), &Catalogue::shipped().unwrap());
    assert_eq!(all.len(), 3, "three simulated arms");
    for delay_s in [0.0, 2.0] {
        let (snapshot, alarms) = played(&all[0], 1, 11, delay_s);
        let first = |condition| {
            let of_elbow = |key: &AlarmKey| key.joint.as_deref() == Some("elbow");
            let mut of =
                (alarms.iter()).filter(|(key, _)| key.condition == condition && of_elbow(key));
            of.next().map_or(f64::NAN, |(_, at_s)| *at_s - delay_s)
        };
        let seen_s = first(Condition::SuspectedStep);
        assert!((180.0..194.0).contains(&seen_s), "{delay_s}: {alarms:?}");
        let confirmed_s = first(Condition::StrandFailure);
        let waited_s = confirmed_s - seen_s;
        assert!((20.0..28.0).contains(&waited_s), "{delay_s}: {alarms:?}");
        let incidents = &snapshot.incidents;
        assert_eq!(incidents.len(), 1, "{delay_s}: {incidents:?}");
        assert_eq!(incidents[0].phase, IncidentPhase::Confirmed);
        assert_eq!(incidents[0].causes[0].cause, IncidentCause::StrandFailure);
        let is_change = |key: &AlarmKey| key.condition.is_change();
        let other =
            |(key, _): &&(AlarmKey, f64)| is_change(key) && key.joint.as_deref() != Some("elbow");
        assert_eq!(alarms.iter().find(other), None, "{delay_s}");
        let near = |(key, at_s): &(AlarmKey, f64)| {
            key.condition == Condition::LimitNear && *at_s < 30.0 + delay_s
        };
        assert!(alarms.iter().any(near), "{alarms:?}");
    }
    assert_eq!(
        played(&all[1], 2, 3, 0.0),
        played(&all[1], 2, 3, 0.0),
        "identical in every run"
    );
}
