//! Due list: completeness of the bound, dates against the truth, and resumption from stored state.

use crate::support::{change, cut, fleet, numbers, open, repository, session, source, write};
use datafusion::arrow::array::{ArrayRef, AsArray as _, Float64Array, RecordBatch};
use sinew_estimate::robot_dir;
use sinew_fleet::FleetError;
use sinew_fleet::args::Due;
use sinew_fleet::due::{DueList, StateUnused, due};
use sinew_rope::Catalogue;
use sinew_watch_core::due::DueList as MonitorsList;
use sinew_watch_core::{History, Instant, Monitor, MonitorConfig, Record, RobotSnapshot, Stored};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Request for a folder.
fn request(folder: &Path, follow_all: bool) -> Due {
    Due {
        source: source(folder),
        robots: Vec::new(),
        within_days: 30.0,
        rows: 40,
        csv: None,
        state: None,
        creep: None,
        follow_all,
    }
}

fn list(folder: &Path, follow_all: bool) -> DueList {
    due(&mut open(folder), &request(folder, follow_all)).unwrap()
}

fn names(list: &DueList) -> BTreeSet<(String, String)> {
    let due = list.due(30.0);
    due.map(|f| (f.robot.clone(), f.joint.clone())).collect()
}

#[test]
fn screen_keeps_every_due_tendon() {
    let folder = tempfile::tempdir().unwrap();
    let made = fleet(folder.path(), 5, 90);
    let (screened, all) = (list(folder.path(), false), list(folder.path(), true));
    assert_eq!(
        (screened.tendons, all.tendons),
        (made.tendons, made.tendons)
    );
    assert_eq!(all.followed.len(), made.tendons);
    let (listed, whole) = (names(&screened), names(&all));
    assert!(whole.is_subset(&listed), "{:?}", whole.difference(&listed));
    // Else this test would show nothing.
    assert!(
        !whole.is_empty() && screened.out_of_reach > made.tendons / 4,
        "{screened:?}"
    );
    assert_eq!(
        screened.out_of_reach + screened.followed.len(),
        made.tendons
    );
}

#[test]
fn due_exceeded_limits_come_first() {
    let folder = tempfile::tempdir().unwrap();
    fleet(folder.path(), 5, 90);
    let list = list(folder.path(), false);
    let truth = std::fs::read_to_string(folder.path().join("truth/tendons.csv")).unwrap();
    let passed: Vec<Vec<&str>> = (truth.lines().skip(1))
        .map(|line| line.split(',').collect::<Vec<_>>())
        .filter(|cell| cell[2] == "passed")
        .collect();
    assert!(!passed.is_empty());
    for cell in passed {
        let found = list
            .due(30.0)
            .any(|f| (f.robot.as_str(), f.joint.as_str()) == (cell[0], cell[1]));
        assert!(found, "{cell:?} is not listed");
    }
    let states: Vec<bool> = (list.due(30.0))
        .map(|f| f.worst().unwrap().is_passed())
        .collect();
    assert!(states.is_sorted_by(|a, b| a >= b), "{states:?}");
}

#[test]
fn due_unknown_robot_type_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<_> = (0..30).map(|day| session("arm-1", "elbow", day)).collect();
    write(&folder.path().join("records/a.parquet"), &rows);
    let list = list(folder.path(), false);
    assert_eq!(
        (list.tendons, list.without_limit, list.followed.len()),
        (1, 1, 0)
    );
    assert_eq!(list.unknown_types, ["arm"]);
}

/// The same request with a state file.
fn list_from(folder: &Path, state: &Path) -> Result<DueList, FleetError> {
    let request = Due {
        state: Some(state.into()),
        ..request(folder, false)
    };
    due(&mut open(folder), &request)
}

/// A fleet of 90 days as it was on day 88, a list of that day with its file of trends, and the whole fleet.
fn two_days(folder: &Path) -> (DueList, PathBuf, PathBuf) {
    let [before, now, state] = ["before", "now", "due.state"].map(|name| folder.join(name));
    for fleet_of in [&before, &now] {
        std::fs::create_dir(fleet_of).unwrap();
        fleet(fleet_of, 5, 90);
    }
    cut(&before, 1.5);
    (list_from(&before, &state).unwrap(), state, now)
}

#[test]
fn due_resumed_equals_full_run() {
    let folder = tempfile::tempdir().unwrap();
    let (first, state, now) = two_days(folder.path());
    assert_eq!(first.resumed, 0);
    let full = list(&now, false);
    let list = list_from(&now, &state).unwrap();
    assert_eq!(list.followed, full.followed);
    assert_ne!(list.followed, first.followed);
    let known = |f: &&sinew_fleet::due::TrackedTendon| {
        let key = (&f.robot, &f.joint);
        first
            .followed
            .iter()
            .any(|other| (&other.robot, &other.joint) == key)
    };
    let resumed = list.followed.iter().filter(known).count();
    assert!(resumed > 2, "{resumed} of {}", list.followed.len());
    assert_eq!((list.resumed, list.state_unused), (resumed, None));
    // A repeated query finds no new sessions.
    let again = list_from(&now, &state).unwrap();
    assert_eq!(
        (again.resumed, again.followed),
        (full.followed.len(), full.followed)
    );
}

#[test]
fn due_corrected_history_restarts_one_tendon() {
    let folder = tempfile::tempdir().unwrap();
    let (_, state, now) = two_days(folder.path());
    let before = list_from(&now, &state).unwrap();
    let one = before.followed[0].clone();
    // Half a millirad more, thirty days back.
    let day = one.last_utc_s - 30.0 * 86_400.0;
    change(&now, |batch| {
        let texts = |name: &str| {
            batch
                .column_by_name(name)
                .unwrap()
                .as_string::<i32>()
                .clone()
        };
        let (robots, joints) = (texts("robot"), texts("joint"));
        let (times, offsets) = (numbers(&batch, "time_utc_s"), numbers(&batch, "offset_rad"));
        let corrected = |i: usize| -> Option<f64> {
            let its = (robots.value(i), joints.value(i)) == (&one.robot, &one.joint);
            let that = its && (times.value(i) - day).abs() < 3.0 * 86_400.0;
            let offset = offsets.iter().nth(i).flatten()?;
            Some(offset + if that { 0.5e-3 } else { 0.0 })
        };
        let column: Float64Array = (0..batch.num_rows()).map(corrected).collect();
        let mut columns = batch.columns().to_vec();
        columns[batch.schema().index_of("offset_rad").unwrap()] = Arc::new(column) as ArrayRef;
        RecordBatch::try_new(batch.schema(), columns).unwrap()
    });
    let full = list(&now, false);
    let list = list_from(&now, &state).unwrap();
    assert_eq!(list.followed, full.followed);
    assert_ne!(list.followed, before.followed);
    assert_eq!(list.resumed, before.followed.len() - 1);
}

#[test]
fn due_changed_pretension_restarts_all() {
    let folder = tempfile::tempdir().unwrap();
    let (_, state, now) = two_days(folder.path());
    let path = now.join("types/biorob-like/robot.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("pretension_n = ", "pretension_n = 1")).unwrap();
    let full = list(&now, false);
    let list = list_from(&now, &state).unwrap();
    assert_eq!((list.resumed, list.followed), (0, full.followed));
}

#[test]
fn due_damaged_or_old_state_is_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let (_, state, now) = two_days(folder.path());
    let full = list(&now, false);
    let good = std::fs::read(&state).unwrap();
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 1;
    let older = [
        b"sinew-fleet due 1 0.0.9\n",
        &good[good.iter().position(|b| *b == b'\n').unwrap() + 1..],
    ]
    .concat();
    let version = StateUnused::Version("0.0.9".into());
    for (bytes, unused) in [
        (flipped, StateUnused::Damaged),
        (good[..good.len() - 3].to_vec(), StateUnused::Damaged),
        (older, version),
    ] {
        std::fs::write(&state, bytes).unwrap();
        let list = list_from(&now, &state).unwrap();
        assert_eq!(
            (list.state_unused, list.followed),
            (Some(unused), full.followed.clone())
        );
        // It is whole again.
        assert_eq!(
            list_from(&now, &state).unwrap().resumed,
            full.followed.len()
        );
    }
    let other = folder.path().join("notes.txt");
    std::fs::write(&other, "tension arm 7 on Friday\n").unwrap();
    let error = list_from(&now, &other).unwrap_err();
    assert!(matches!(error, FleetError::NoState(_)), "{error}");
    assert_eq!(
        std::fs::read_to_string(&other).unwrap(),
        "tension arm 7 on Friday\n"
    );
}

/// Snapshot of a monitor with these records in its store.
fn snapshot_of(records: &[Record]) -> RobotSnapshot {
    let robot = robot_dir::load(&repository("robots/biorob-like"), None).unwrap();
    let catalogue = Arc::new(Catalogue::shipped().unwrap());
    let last = records.last().unwrap();
    let config = MonitorConfig::new(&last.robot, "test", Arc::new(robot.robot), catalogue);
    let mut history = History::default();
    for record in records {
        history.push(record);
    }
    let stored = Stored {
        history,
        ..Stored::default()
    };
    let now = Instant {
        monotonic_ns: 0,
        utc_ns: (1e9 * last.time_utc_s) as i64,
    };
    let mut monitor = Monitor::new(config, stored, now).unwrap();
    monitor.tick(now);
    while let Some(job) = monitor.job() {
        monitor.done(job.run(), now);
    }
    monitor.snapshot(now)
}

#[test]
fn due_equals_list_of_monitor() {
    let life = |robot: &str, from_mrad: f64, daily_mrad: f64| -> Vec<Record> {
        let of_day = |day: u32| Record {
            robot_type: "biorob-like".into(),
            offset_rad: Some(1e-3 * (from_mrad + daily_mrad * f64::from(day))),
            ..session(robot, "elbow", day)
        };
        (0..40).map(of_day).collect()
    };
    // Their limit is 20 mrad.
    let lives = [
        life("far", 14.0, 0.4),
        life("never", 2.0, 0.01),
        life("soon", 15.0, 0.1),
        life("sooner", 16.0, 0.09),
    ];
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("records/a.parquet"), &lives.concat());
    let request = Due {
        robots: vec![repository("robots/biorob-like")],
        ..request(folder.path(), true)
    };
    let list = due(&mut open(folder.path()), &request).unwrap();
    let robots = lives.map(|records| snapshot_of(&records));
    let monitors = MonitorsList::of(&robots, list.now_utc_s, 30.0 * 86_400.0);
    let found: Vec<_> = list.due(30.0).collect();
    let names: Vec<&str> = found.iter().map(|f| f.robot.as_str()).collect();
    assert_eq!(names, ["far", "sooner", "soon"]);
    assert_eq!(
        names,
        monitors
            .due
            .iter()
            .map(|row| row.robot.as_str())
            .collect::<Vec<_>>()
    );
    for (followed, row) in found.iter().zip(&monitors.due) {
        let worst = followed.worst().unwrap();
        assert_eq!((worst.limit, worst.state), (row.limit, row.state));
        assert_eq!(
            (followed.offset_rad, followed.verdict),
            (row.offset_rad, row.verdict)
        );
        // Paths are drawn again, because the fleet's list covers one year and the monitor's three; an interval end is based on 50 of them.
        let [median, low, high] = worst.at_utc_s.map(Option::unwrap);
        let apart = |here: f64, there: Option<f64>, share: f64| {
            let apart_s = (here - there.unwrap()).abs();
            assert!(apart_s <= share * (high - low), "{followed:?}: {row:?}");
        };
        apart(median, row.at_utc_s, 0.05);
        apart(low, row.at_low_utc_s, 0.2);
        apart(high, row.at_high_utc_s, 0.2);
    }
}
