//! Maintenance list: agreement with the trend of each tendon's records.

use crate::limits::record;
use crate::support::{Harness, MONDAY_NS, Store, biorob_like, config};
use sinew_model::robot::Robot;
use sinew_trend::{LimitForecast, LimitState, TrendRequest, analyze, sort};
use sinew_watch_core::due::{DueList, DueTendon};
use sinew_watch_core::{HORIZON_DAYS, History, Instant, RobotSnapshot};
use std::sync::Arc;

const DAY_S: f64 = 86_400.0;
const NOW_S: f64 = MONDAY_NS as f64 * 1e-9;

/// Shipped robot with limits at the elbow only: 20 mrad and 0.3 % strain (84 mrad).
fn robot() -> Robot {
    let mut robot = (*biorob_like()).clone();
    let joints = robot.joint_names().to_vec();
    for (joint, transmission) in joints.iter().zip(&mut robot.transmissions) {
        if let Some(tendon) = transmission.as_mut().and_then(|t| t.tendon.as_mut()) {
            let is_elbow = joint == "elbow";
            tendon.retension_at_m = tendon.retension_at_m.filter(|_| is_elbow);
            tendon.replace_at_strain = is_elbow.then_some(3e-3);
        }
    }
    robot
}

/// Daily records of the elbow up to yesterday, from an initial offset with a daily increase, mrad.
fn records(days: u32, from_mrad: f64, daily_mrad: f64) -> History {
    let mut history = History::default();
    for day in 0..days {
        let wobble = 0.1 * (12.9898 * f64::from(day)).sin();
        let offset_mrad = from_mrad + daily_mrad * f64::from(day) + wobble;
        history.push(&record(f64::from(days - day), 1e-3 * offset_mrad));
    }
    history
}

/// Snapshot of a monitor whose store contains these records.
fn snapshot_of(name: &str, robot: &Arc<Robot>, history: &History) -> RobotSnapshot {
    let mut config = config(robot);
    config.name = name.into();
    let mut store = Store::default();
    store.stored.history = history.clone();
    let now = Instant {
        monotonic_ns: 0,
        utc_ns: MONDAY_NS,
    };
    let mut snapshot_of = Harness::restored(config, store, now);
    snapshot_of.pass(1.0);
    snapshot_of.snapshot()
}

/// Limit forecasts of `sinew trend` for the same records.
fn trend(robot: &Robot, history: &History) -> Vec<LimitForecast> {
    let catalogue = &sinew_rope::Catalogue::shipped().unwrap();
    let request = TrendRequest {
        robot: Some(robot),
        catalogue,
        stated: Vec::new(),
        duty: None,
        life: None,
        horizon_days: HORIZON_DAYS,
        seed: 1,
    };
    let sorted = sort(history.rows("elbow"), None).unwrap();
    analyze(sorted, &request).unwrap().joints[0].limits.clone()
}

/// Asserts that a row agrees with a forecast; the difference of two dates loses digits.
fn assert_same(row: &DueTendon, limit: &LimitForecast) {
    let last = |at: Option<f64>| at.map(|at| at - row.last_utc_s);
    let pairs = [
        (last(row.at_utc_s), limit.after_s),
        (last(row.at_low_utc_s), limit.after_low_s),
        (last(row.at_high_utc_s), limit.after_high_s),
    ];
    for (found, wanted) in pairs {
        let difference = found.zip(wanted).map_or(0.0, |(a, b)| (a - b).abs());
        assert!(
            difference < 1e-3 && found.is_some() == wanted.is_some(),
            "{row:?}: {limit:?}"
        );
    }
    assert_eq!(
        (row.limit, row.limit_rad, row.state, row.passed_probability),
        (
            limit.limit,
            limit.limit_rad,
            limit.state,
            limit.passed_probability
        )
    );
}

#[test]
fn due_list_matches_trend_of_each_tendon() {
    let robot = Arc::new(robot());
    let mut unknown_rope = (*robot).clone();
    for transmission in unknown_rope.transmissions.iter_mut().flatten() {
        if let Some(tendon) = &mut transmission.tendon {
            tendon.rope = None;
        }
    }
    let unknown_rope = Arc::new(unknown_rope);
    let lives = [
        ("difference", &robot, records(40, 12.0, 0.6)),
        ("just", &robot, records(40, 13.0, 0.2)),
        ("later", &robot, records(40, 12.0, 0.1)),
        ("near", &robot, records(40, 15.0, 0.1)),
        ("never", &robot, records(40, 2.0, 0.0)),
        ("too-few", &unknown_rope, records(2, 15.0, 0.1)),
        ("without-records", &robot, History::default()),
    ];
    let robots: Vec<RobotSnapshot> = lives
        .iter()
        .map(|(name, robot, history)| snapshot_of(name, robot, history))
        .collect();
    let within_s = 40.0 * DAY_S;
    let list = DueList::of(&robots, NOW_S, within_s);
    let names: Vec<&str> = list.due.iter().map(|row| row.robot.as_str()).collect();
    // The largest exceedance first, then by date.
    assert_eq!(names, ["difference", "just", "near", "later"]);
    assert_eq!(
        (list.time_utc_s, list.until_utc_s),
        (NOW_S, NOW_S + within_s)
    );
    let other_joints = 3 * lives.len();
    assert_eq!(
        (list.not_due, list.inconclusive, list.without_limit),
        (1, 2, other_joints)
    );
    for row in &list.due {
        let (_, robot, history) = lives.iter().find(|life| life.0 == row.robot).unwrap();
        let limits = trend(robot, history);
        // All of them exceed the elongation limit first.
        assert_same(row, &limits[0]);
        assert_eq!(
            (row.joint.as_str(), row.rope.as_deref()),
            ("elbow", Some("liros-dc000-0301"))
        );
        assert_eq!((row.sessions, row.last_utc_s), (40, NOW_S - DAY_S));
        let after = |at: Option<f64>| at.map(|at| at - NOW_S);
        assert_eq!(
            [row.after_s, row.after_low_s, row.after_high_s],
            [row.at_utc_s, row.at_low_utc_s, row.at_high_utc_s].map(after)
        );
        assert_eq!(
            row.state == LimitState::Passed,
            ["difference", "just"].contains(&&*row.robot)
        );
    }
    // Tendons not listed exceed no limit in that time, or have no forecast.
    let of = |name: &str| lives.iter().find(|life| life.0 == name).unwrap();
    let (_, robot, history) = of("never");
    let low = trend(robot, history)[0]
        .after_low_s
        .unwrap_or(f64::INFINITY);
    assert!(low > within_s + DAY_S, "{} days", low / DAY_S);
    let (_, robot, history) = of("too-few");
    assert_eq!(trend(robot, history)[0].state, LimitState::TooFewSessions);
}

#[test]
fn due_probability_matches_requested_date() {
    let robot = Arc::new(robot());
    let robots = [snapshot_of("near", &robot, &records(40, 15.0, 0.1))];
    let row = |within_s: f64, time_utc_s: f64| {
        DueList::of(&robots, time_utc_s, within_s)
            .due
            .first()
            .cloned()
    };
    let reference = row(60.0 * DAY_S, NOW_S).unwrap();
    let until = |after_s: Option<f64>| {
        let found = row(after_s.unwrap() + 1.0, NOW_S).unwrap();
        found.until_probability.unwrap()
    };
    for (after_s, share) in [
        (reference.after_low_s, 0.025),
        (reference.after_s, 0.5),
        (reference.after_high_s, 0.975),
    ] {
        assert!((until(after_s) - share).abs() < 2e-3, "{share}");
    }
    // One day before the start of its interval, the tendon is not listed.
    assert_eq!(row(reference.after_low_s.unwrap() - DAY_S, NOW_S), None);
    // Robot without data until after the median: the limit is probably exceeded already.
    let silent = row(DAY_S, reference.at_utc_s.unwrap() + 2.0 * DAY_S).unwrap();
    assert_eq!(silent.state, LimitState::Forecast);
    assert!(silent.after_s.unwrap() < -DAY_S && silent.until_probability.unwrap() > 0.5);
    // Beyond the forecast horizon there is no probability.
    let beyond = row(HORIZON_DAYS * DAY_S, NOW_S).unwrap();
    assert_eq!(beyond.until_probability, None);
}

#[test]
fn due_list_without_robots_is_empty() {
    let none: [RobotSnapshot; 0] = [];
    let list = DueList::of(&none, NOW_S, DAY_S);
    assert!(list.due.is_empty());
    assert_eq!(
        (list.not_due, list.inconclusive, list.without_limit),
        (0, 0, 0)
    );
}
