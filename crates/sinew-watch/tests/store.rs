//! Stored data are restored, completely or not at all.

use sinew_model::Gaussian;
use sinew_trend::survival::{EventColumns, LifeEnd, read_lives};
use sinew_watch::store::{
    COLUMNS, JournalFilter, Place, Reader, RecordQuery, SeriesQuery, Store, StoreError, VERSION,
    write_lives,
};
use sinew_watch_core::alarm::{Alarm, AlarmCause, AlarmKey, AlarmState, AlarmsStored, Condition};
use sinew_watch_core::command::{Command, CommandKind};
use sinew_watch_core::incident::{Finding, Incident, IncidentPhase, Incidents};
use sinew_watch_core::journal::{Correction, Entry, Event, Maintenance, SessionEnd};
use sinew_watch_core::record::{Clock, NoOffset};
use sinew_watch_core::transaction::{BaselineAcquisition, TendonState};
use sinew_watch_core::{MonitorState, Record, Transaction};
use std::path::Path;
use std::sync::Arc;

fn record(robot: &str, joint: &str, time_utc_s: f64) -> Record {
    Record {
        robot: robot.into(),
        robot_type: "biorob-like".into(),
        joint: joint.into(),
        time_utc_s,
        duration_s: 600.0,
        offset_rad: Some(0.012),
        offset_std_rad: Some(0.0005),
        elongation_m: Some(3.0e-4),
        elongation_std_m: Some(1.25e-5),
        strain_ratio: Some(4.3e-4),
        strain_std_ratio: Some(1.8e-5),
        temperature_c: Some(23.5),
        stiffness_ratio: Some(-0.01),
        stiffness_std_ratio: Some(0.004),
        baseline: Some("2026-11-01".into()),
        source: "dds:0/arm7".into(),
        clock: Clock::Utc,
        provisional: false,
        reason: None,
        poses: 46,
        frames: 150_000,
        frames_lost: 12,
        sinew_version: "0.1.0".into(),
    }
}

fn state_estimate(mean: f64) -> MonitorState {
    MonitorState {
        version: MonitorState::VERSION,
        baseline: None,
        end_utc_s: None,
        learns: Some(BaselineAcquisition {
            joints: vec!["elbow".into()],
            duration_s: 12.5,
            poses_rad: vec![0.1 + 0.2, -1.0],
        }),
        sessions: 7,
        tendons: vec![TendonState {
            joint: "elbow".into(),
            since: Some("tensioned 2026-11-01".into()),
            tensioned_utc_s: vec![1_793_500_000.25],
            replaced_utc_s: None,
            before_m: Gaussian::new(mean, 0.1 + 0.2),
            last_rad: None,
            last_utc_s: None,
            last_from_utc_s: None,
            last_stiffness_ratio: None,
            suspected: None,
        }],
        incidents: Incidents::default(),
        maintenance: Vec::new(),
        without: None,
    }
}

fn alarm() -> Alarm {
    Alarm {
        key: AlarmKey {
            joint: Some("elbow".into()),
            condition: Condition::SuspectedStep,
        },
        state: AlarmState::Active,
        acknowledged: false,
        raised_utc_s: 1_793_600_000.0,
        cause: AlarmCause::Provisional { for_s: 601.5 },
        shelved_until_utc_s: None,
        shelved_for_s: None,
    }
}

fn transaction(robot: &str, id: u64) -> Transaction {
    let time_utc_s = 1_793_600_000.0 + 600.0 * id as f64;
    let mut inconclusive = record(robot, "wrist", time_utc_s);
    (inconclusive.offset_rad, inconclusive.offset_std_rad) = (None, None);
    inconclusive.reason = Some(NoOffset::TooWide);
    Transaction {
        id,
        robot: robot.into(),
        records: vec![record(robot, "elbow", time_utc_s), inconclusive],
        state: Some(Arc::new(state_estimate(id as f64))),
        alarms: Some(AlarmsStored {
            alarms: vec![alarm()],
        }),
        replaced_from_utc_s: None,
        journal: vec![Entry {
            time_utc_s,
            event: Event::Session {
                duration_s: 600.0,
                end: SessionEnd::Full,
            },
        }],
    }
}

fn open(folder: &Path) -> Store {
    Store::open(Place::Folder(folder.into())).unwrap()
}

#[test]
fn committed_data_survive_reopening() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = open(folder.path());
    store
        .commit(&[transaction("a", 1), transaction("b", 7)])
        .unwrap();
    store.commit(&[transaction("a", 2)]).unwrap();
    drop(store);
    let reader = open(folder.path()).reader().unwrap();
    let restored = reader.stored("a").unwrap();
    assert_eq!(restored.last_id, 2);
    assert_eq!(restored.state, Some(state_estimate(2.0)));
    assert_eq!(restored.alarms.alarms, [alarm()]);
    let query = RecordQuery {
        robot: Some("a".into()),
        ..RecordQuery::default()
    };
    let mut both = transaction("a", 1).records;
    both.extend(transaction("a", 2).records);
    assert_eq!(reader.records(&query).unwrap(), both);
    assert_eq!(reader.robots().unwrap(), ["a", "b"]);
    let never = reader.stored("c").unwrap();
    assert_eq!((never.state, never.last_id), (None, 0));
}

#[test]
fn stored_alarm_of_former_condition_is_read() {
    let former = r#"{
        "key": { "joint": null, "condition": "door" }, "state": "active", "acknowledged": false, "raised_utc_s": 1.0,
        "cause": { "kind": "door", "door": "dds:0", "why": "no network" },
        "shelved_until_utc_s": null, "shelved_for_s": null
    }"#;
    let alarm: Alarm = serde_json::from_str(former).unwrap();
    assert_eq!(alarm.key.condition, Condition::Transport);
    assert!(
        matches!(alarm.cause, AlarmCause::Transport { transport, reason } if transport == "dds:0" && reason == "no network")
    );
}

#[test]
fn duplicate_transaction_is_stored_once() {
    for place in [None, Some(Place::Memory(1))] {
        let folder = tempfile::tempdir().unwrap();
        let place = place.unwrap_or(Place::Folder(folder.path().into()));
        let mut store = Store::open(place).unwrap();
        store.commit(&[transaction("a", 1)]).unwrap();
        store
            .commit(&[transaction("a", 1), transaction("a", 2)])
            .unwrap();
        let reader = store.reader().unwrap();
        assert_eq!(reader.records(&RecordQuery::default()).unwrap().len(), 4);
        let journal = reader
            .journal(&JournalFilter {
                most: 10,
                ..JournalFilter::default()
            })
            .unwrap();
        assert_eq!(journal.len(), 2);
        assert!(journal[0].id > journal[1].id);
    }
}

#[test]
fn records_query_filters_and_limits_to_newest() {
    let mut store = Store::open(Place::Memory(2)).unwrap();
    for id in 1..=20 {
        store
            .commit(&[transaction("a", id), transaction("b", id)])
            .unwrap();
    }
    let reader = store.reader().unwrap();
    let of = |query: &RecordQuery| -> Vec<f64> {
        let records = reader.records(query).unwrap();
        records
            .iter()
            .map(|r| (r.time_utc_s - 1_793_600_000.0) / 600.0)
            .collect()
    };
    let mut query = RecordQuery {
        robot: Some("a".into()),
        joint: Some("elbow".into()),
        from_utc_s: Some(1_793_600_000.0 + 600.0 * 5.0),
        to_utc_s: Some(1_793_600_000.0 + 600.0 * 9.0),
        before: None,
        most: None,
    };
    assert_eq!(of(&query), [5.0, 6.0, 7.0, 8.0]);
    query.most = Some(2);
    assert_eq!(of(&query), [7.0, 8.0]);
}

#[test]
fn columns_match_record_keys() {
    let value = serde_json::to_value(record("a", "elbow", 0.0)).unwrap();
    let mut keys: Vec<&str> = value
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    let mut columns = COLUMNS.to_vec();
    keys.sort_unstable();
    columns.sort_unstable();
    assert_eq!(keys, columns);
}

#[test]
fn second_monitor_error_names_process() {
    let folder = tempfile::tempdir().unwrap();
    let _first = open(folder.path());
    let error = Store::open(Place::Folder(folder.path().into())).unwrap_err();
    assert!(matches!(error, StoreError::Held { .. }), "{error}");
    if cfg!(target_os = "linux") {
        let process = format!("in use by process {}", std::process::id());
        assert!(error.to_string().contains(&process), "{error}");
    }
}

#[test]
fn changed_byte_of_stored_state_is_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("watch.db");
    let mut store = open(folder.path());
    store.commit(&[transaction("a", 1)]).unwrap();
    drop(store);
    let state = || {
        let reader = Reader::open(&Place::Folder(folder.path().into())).unwrap();
        reader
            .stored("a")
            .map(|stored| format!("{:?}", stored.state))
    };
    let before = state().unwrap();
    let database = rusqlite::Connection::open(&file).unwrap();
    let text = "SELECT document FROM belief";
    let packed: Vec<u8> = database.query_row(text, [], |row| row.get(0)).unwrap();
    for at in (4..packed.len()).step_by(7) {
        let mut changed = packed.clone();
        changed[at] ^= 0x10;
        let update = "UPDATE belief SET document = ?1";
        database.execute(update, [changed]).unwrap();
        // Unused bits of the header change nothing.
        let is_noticed = state().map_or(true, |after| after == before);
        assert!(is_noticed, "byte {at}");
    }
}

#[test]
fn damaged_foreign_or_newer_store_is_left_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("watch.db");
    let mut store = open(folder.path());
    for id in 1..=50 {
        store.commit(&[transaction("a", id)]).unwrap();
    }
    drop(store);
    let whole = std::fs::read(&file).unwrap();
    let refused = |bytes: &[u8]| {
        std::fs::write(&file, bytes).unwrap();
        let error = Store::open(Place::Folder(folder.path().into())).unwrap_err();
        assert_eq!(std::fs::read(&file).unwrap(), bytes, "{error}");
        error
    };
    let mut damaged = whole.clone();
    damaged[4096 * 3..4096 * 6].fill(0x5a);
    let error = refused(&damaged);
    assert!(
        error.is_damaged() && error.to_string().contains("watch.db is damaged"),
        "{error}"
    );
    assert!(refused(b"not a database, but long enough for a header of one: 0123456789 0123456789 0123456789").is_damaged());
    let mut newer = whole.clone();
    // user_version is at byte 60 of the header.
    newer[60..64].copy_from_slice(&(VERSION as u32 + 1).to_be_bytes());
    assert!(matches!(
        refused(&newer),
        StoreError::Newer {
            version: 3,
            supported: 2,
            ..
        }
    ));
    let mut foreign = whole.clone();
    foreign[68..72].fill(0x11);
    assert!(matches!(refused(&foreign), StoreError::Foreign { .. }));
    std::fs::write(&file, &whole).unwrap();
    assert_eq!(
        open(folder.path())
            .reader()
            .unwrap()
            .stored("a")
            .unwrap()
            .last_id,
        50
    );
}

#[test]
fn failed_commit_stores_nothing_and_can_repeat() {
    let mut store = Store::open(Place::Memory(3)).unwrap();
    store.commit(&[transaction("a", 1)]).unwrap();
    let reader = store.reader().unwrap();
    // A reader blocks the in-memory database for longer than the writer waits.
    let before = reader.records(&RecordQuery::default()).unwrap();
    let error = reader.each_record(&RecordQuery::default(), |record| {
        Err(StoreError::Document {
            what: "a record",
            robot: record.robot,
            reason: "refused".into(),
        })
    });
    assert!(matches!(error, Err(StoreError::Document { .. })));
    store.commit(&[transaction("a", 2)]).unwrap();
    assert_eq!(
        before.len() + 2,
        reader.records(&RecordQuery::default()).unwrap().len()
    );
}

#[test]
fn readers_see_whole_transactions_during_writes() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = open(folder.path());
    store.commit(&[transaction("a", 1)]).unwrap();
    let place = Place::Folder(folder.path().into());
    let readers: Vec<_> = (0..4)
        .map(|_| {
            let reader = Reader::open(&place).unwrap();
            std::thread::spawn(move || {
                for _ in 0..50 {
                    let count = reader.records(&RecordQuery::default()).unwrap().len();
                    assert!(
                        count >= 2 && count.is_multiple_of(2),
                        "half a transaction: {count}"
                    );
                }
            })
        })
        .collect();
    for id in 2..=30 {
        store.commit(&[transaction("a", id)]).unwrap();
    }
    for reader in readers {
        reader.join().unwrap();
    }
}

#[test]
fn lost_database_is_not_created_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("watch.db");
    let place = || Place::Folder(folder.path().into());
    open(folder.path()).commit(&[transaction("a", 1)]).unwrap();
    std::fs::write(&file, b"").unwrap();
    let error = Store::open(place()).unwrap_err();
    assert!(matches!(error, StoreError::Lost { .. }), "{error}");
    assert_eq!(std::fs::metadata(&file).unwrap().len(), 0);
    let error = Reader::open(&place()).unwrap().check().unwrap_err();
    assert!(matches!(error, StoreError::Lost { .. }), "{error}");
    // Missing although there is its write-ahead log, which SQLite would remove.
    std::fs::remove_file(&file).unwrap();
    let log = folder.path().join("watch.db-wal");
    std::fs::write(&log, b"frames").unwrap();
    let error = Store::open(place()).unwrap_err();
    assert!(error.to_string().contains("watch.db-wal"), "{error}");
    // Removed by the operator: created again. The rest of an interrupted start does no harm.
    std::fs::remove_file(&log).unwrap();
    std::fs::write(folder.path().join("watch.db.new"), b"half").unwrap();
    drop(open(folder.path()));
    assert!(!folder.path().join("watch.db.new").exists());
}

#[cfg(unix)]
#[test]
fn store_is_readable_by_its_owner_only() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let store_folder = folder.path().join("sinew");
    let mut store = open(&store_folder);
    store.commit(&[transaction("a", 1)]).unwrap();
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode(&store_folder), 0o700);
    for entry in std::fs::read_dir(&store_folder).unwrap() {
        let path = entry.unwrap().path();
        assert_eq!(mode(&path), 0o600, "{}", path.display());
    }
}

#[test]
fn backup_of_written_store_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = open(folder.path());
    store.commit(&[transaction("a", 1)]).unwrap();
    let copies = tempfile::tempdir().unwrap();
    let target = copies.path().join("watch.db");
    let reader = store.reader().unwrap();
    reader.backup(&target).unwrap();
    store.commit(&[transaction("a", 2)]).unwrap();
    let records = |folder: &Path| {
        let reader = Reader::open(&Place::Folder(folder.into())).unwrap();
        reader.check().unwrap();
        reader.records(&RecordQuery::default()).unwrap().len()
    };
    assert_eq!((records(copies.path()), records(folder.path())), (2, 4));
    // A later copy replaces it, and can be used as a store.
    reader.backup(&target).unwrap();
    assert_eq!(
        open(copies.path())
            .reader()
            .unwrap()
            .stored("a")
            .unwrap()
            .last_id,
        2
    );
}

/// Stores hourly records of one tendon of each robot, with two single outliers and a part without offsets.
fn hourly(store: &mut Store, robots: &[&str], count: u64) {
    for (at, robot) in robots.iter().enumerate() {
        let mut all = Transaction {
            records: Vec::new(),
            ..transaction(robot, 1)
        };
        for hour in 0..count {
            let mut one = record(
                robot,
                "elbow",
                1_793_600_000.0 + 3600.0 * hour as f64 + at as f64,
            );
            one.offset_rad = match hour {
                700 => Some(0.5),
                701 => Some(-0.5),
                // A part without conclusive records.
                900..1000 => None,
                _ => Some(1e-5 * hour as f64),
            };
            all.records.push(one);
        }
        store.commit(&[all]).unwrap();
    }
}

#[test]
fn records_are_read_in_pieces_and_by_cursor() {
    let mut store = Store::open(Place::Memory(4)).unwrap();
    hourly(&mut store, &["a", "b"], 1000);
    let reader = store.reader().unwrap();
    for (robot, joint) in [(None, None), (Some("a"), None), (Some("a"), Some("elbow"))] {
        let mut query = RecordQuery {
            robot: robot.map(str::to_owned),
            joint: joint.map(str::to_owned),
            most: Some(300),
            ..RecordQuery::default()
        };
        let whole = reader
            .records(&RecordQuery {
                most: None,
                ..query.clone()
            })
            .unwrap();
        // From the newest to the oldest, each page in pieces of 70.
        let mut pages = Vec::new();
        loop {
            let span = reader.span(&query).unwrap().unwrap();
            let (mut next, mut page) = (Some(span.first), Vec::new());
            while let Some(from) = next {
                let before = page.len();
                next = reader
                    .piece(&query, [from, span.last], 70, |record| page.push(record))
                    .unwrap();
                assert!(page.len() - before <= 70);
            }
            assert_eq!(page, reader.records(&query).unwrap());
            pages.push(page);
            if !span.has_older {
                break;
            }
            query.before = Some(span.first.id);
        }
        let read: Vec<Record> = pages.into_iter().rev().flatten().collect();
        assert_eq!(read, whole);
    }
    let none = RecordQuery {
        robot: Some("c".into()),
        ..RecordQuery::default()
    };
    assert_eq!(reader.span(&none).unwrap(), None);
}

#[test]
fn series_keeps_extremes_of_every_interval() {
    let mut store = Store::open(Place::Memory(5)).unwrap();
    hourly(&mut store, &["a"], 10_000);
    let reader = store.reader().unwrap();
    let all = SeriesQuery::default();
    let series = reader.series("a", "elbow", &all, 50).unwrap();
    assert_eq!((series.records, series.inconclusive), (10_000, 100));
    assert!(
        series.points.len() <= 150 && series.points.len() >= 50,
        "{}",
        series.points.len()
    );
    assert!(series.points.is_sorted_by_key(|p| p.time_utc_s));
    let offsets = || series.points.iter().filter_map(|p| p.offset_rad);
    // The short step of one record remains visible.
    assert!(offsets().any(|x| x == 0.5) && offsets().any(|x| x == -0.5));
    let last = series.points.last().unwrap();
    assert_eq!(Some(last.time_utc_s), series.last_utc_s);
    // A year inside is reached with its own resolution, down to every record.
    let from = 1_793_600_000.0 + 3600.0 * 5000.0;
    let some = SeriesQuery {
        from_utc_s: Some(from),
        to_utc_s: Some(from + 3600.0 * 99.0),
        intervals: None,
    };
    let series = reader.series("a", "elbow", &some, 50).unwrap();
    assert_eq!((series.points.len(), series.interval_s), (100, None));
    let none = reader.series("a", "knee", &all, 50).unwrap();
    assert_eq!((none.first_utc_s, none.points), (None, Vec::new()));
}

/// Stores days of a robot with four tendons: 48 sessions of ten minutes a day, with intervals that vary, a tensioning in the
/// middle of a day, inconclusive sessions and a simulated one.
fn days_of_sessions(store: &mut Store, robot: &str, days: u64) {
    let (first_utc_s, sessions) = (1_793_577_600.0, 48);
    let mut waiting = Vec::new();
    for number in 0..days * sessions {
        let (day, session) = (number / sessions, number % sessions);
        let time_utc_s = first_utc_s + 86_400.0 * day as f64 + 600.0 * session as f64;
        let records = ["shoulder_yaw", "shoulder_pitch", "elbow", "wrist"]
            .into_iter()
            .enumerate();
        let records = records.map(|(at, joint)| {
            let mut one = record(robot, joint, time_utc_s);
            // Equal intervals occur: the first of them counts.
            one.offset_std_rad = Some(1e-4 * (2 + (7 * number + at as u64) % 11) as f64);
            one.offset_rad = Some(1e-5 * number as f64);
            if number >= 3 * sessions + 20 {
                one.baseline = Some("2026-11-04".into());
            }
            if session == 5 {
                (one.offset_rad, one.offset_std_rad) = (None, None);
                one.reason = Some(NoOffset::TooWide);
            }
            if session == 6 {
                one.clock = Clock::Stamp;
                one.offset_std_rad = Some(1e-6);
            }
            one
        });
        waiting.push(Transaction {
            records: records.collect(),
            state: None,
            alarms: None,
            ..transaction(robot, number + 1)
        });
        if session + 1 == sessions {
            store.commit(&waiting).unwrap();
            waiting.clear();
        }
    }
}

#[test]
fn thinning_changes_neither_trend_nor_state() {
    let mut store = Store::open(Place::Memory(6)).unwrap();
    days_of_sessions(&mut store, "a", 40);
    days_of_sessions(&mut store, "b", 40);
    let reader = store.reader().unwrap();
    let of = |robot: &str| {
        let stored = reader.stored(robot).unwrap();
        let history = stored.history;
        let rows: Vec<_> = history.joints().map(|joint| history.rows(joint)).collect();
        // The last record of every tendon belongs to the history.
        (format!("{history:?}"), rows)
    };
    let count = |robot: &str| {
        let query = RecordQuery {
            robot: Some(robot.into()),
            ..RecordQuery::default()
        };
        reader.records(&query).unwrap().len()
    };
    let before = of("a");
    assert_eq!(before.1.len(), 4);
    // One record a day, and two on the day of the tensioning.
    assert_eq!(before.1[0].len(), 41);
    let at = |day: f64| 1_793_577_600.0 + 86_400.0 * day;
    // Records that are in no monthly file are kept.
    assert_eq!(store.thin("a", at(40.0)).unwrap(), 0);
    for pending in reader.not_exported().unwrap() {
        store.exported(&pending).unwrap();
    }
    let deleted = store.thin("a", at(30.0)).unwrap();
    assert_eq!(deleted, 30 * 48 * 4 - 31 * 4);
    assert_eq!(count("a"), 40 * 48 * 4 - deleted);
    assert_eq!(of("a"), before);
    // All of them, the newest included; again, which changes nothing.
    store.thin("a", at(50.0)).unwrap();
    assert_eq!(count("a"), 41 * 4 + 4);
    assert_eq!(store.thin("a", at(50.0)).unwrap(), 0);
    assert_eq!(of("a"), before);
    assert_eq!(count("b"), 40 * 48 * 4);
}

/// Returns the number before some words in the page on deployment.
fn documented(words: &str) -> f64 {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/manual/deploy.md");
    let page = std::fs::read_to_string(page).unwrap();
    let text = page.split_whitespace().collect::<Vec<_>>().join(" ");
    let (before, _) = text.split_once(words).expect("the words in the page");
    before
        .trim_end()
        .rsplit(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap()
}

#[test]
fn disk_usage_matches_the_documented_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = open(folder.path());
    days_of_sessions(&mut store, "a", 60);
    store.checkpoint().unwrap();
    let reader = store.reader().unwrap();
    let usage = reader.usage().unwrap();
    let [robot] = &usage[..] else {
        panic!("{usage:?}")
    };
    assert_eq!((robot.records, robot.days), (60 * 48 * 4, 60));
    // The whole file, which has little else.
    let file = std::fs::metadata(folder.path().join("watch.db"))
        .unwrap()
        .len() as f64;
    assert!(
        (0.95..=1.0).contains(&(robot.history_bytes / file)),
        "{robot:?} {file}"
    );
    let near = |bytes: f64, words: &str, unit: f64| {
        let stated = documented(words);
        let is_near = (0.9..1.1).contains(&(bytes / (unit * stated)));
        assert!(is_near, "{words}: {stated}, measured {}", bytes / unit);
    };
    near(robot.history_bytes / 60.0, "kB per robot and day", 1e3);
    near(
        robot.history_bytes / 60.0 * 365.25,
        "MB per robot and year",
        1e6,
    );
    for pending in reader.not_exported().unwrap() {
        store.exported(&pending).unwrap();
    }
    store.thin("a", 1_793_577_600.0 + 60.0 * 86_400.0).unwrap();
    let copy = folder.path().join("thinned.db");
    reader.backup(&copy).unwrap();
    let thinned = std::fs::metadata(copy).unwrap().len() as f64;
    near(
        thinned / 60.0 * 365.25,
        "MB per robot and year after thinning",
        1e6,
    );
}

/// Ten years of records of 12 robots, one million, in the folder `SINEW_MILLION`: the store of the measurement of memory.
#[test]
fn million_records() {
    let Some(folder) = std::env::var_os("SINEW_MILLION") else {
        return;
    };
    let mut store = open(Path::new(&folder));
    let names: Vec<String> = (0..12).map(|n| format!("arm-{n}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    hourly(&mut store, &names, 83_334);
}

#[test]
fn withdrawn_entry_replaces_records_from_its_time() {
    let mut store = Store::open(Place::Memory(31)).unwrap();
    let all: Vec<Transaction> = (1..=4).map(|id| transaction("a", id)).collect();
    store.commit(&all).unwrap();
    store.commit(&[transaction("b", 3)]).unwrap();
    let replaced = Transaction {
        id: 5,
        replaced_from_utc_s: Some(all[2].records[0].time_utc_s),
        records: vec![record("a", "elbow", all[3].records[0].time_utc_s)],
        ..transaction("a", 5)
    };
    store.commit(std::slice::from_ref(&replaced)).unwrap();
    let of = |robot: &str| RecordQuery {
        robot: Some(robot.into()),
        ..RecordQuery::default()
    };
    let reader = store.reader().unwrap();
    let expected = [&all[0].records[..], &all[1].records, &replaced.records].concat();
    assert_eq!(reader.records(&of("a")).unwrap(), expected);
    assert_eq!(reader.records(&of("b")).unwrap().len(), 2);
    // A record in the place of one that is in a monthly file is in none yet.
    for pending in reader.not_exported().unwrap() {
        store.exported(&pending).unwrap();
    }
    store.commit(&[Transaction { id: 6, ..replaced }]).unwrap();
    assert_eq!(reader.not_exported().unwrap().len(), 1);
}

#[test]
fn states_of_earlier_versions_are_read() {
    let mut store = Store::open(Place::Memory(32)).unwrap();
    let mut old = transaction("a", 1);
    let mut state = state_estimate(1.0);
    state.version = 1;
    old.state = Some(Arc::new(state.clone()));
    store.commit(&[old]).unwrap();
    let stored = store.reader().unwrap().stored("a").unwrap();
    assert_eq!(stored.state, Some(state));
}

/// Sessions of half an hour of motion end every hour. Ropes are installed at 0.5 h, 6.5 h and 12.5 h; the first fails at
/// 3.75 h according to the inspection; an entry at 10.5 h is withdrawn, and one of the wrist at 12.5 h was the elbow's.
#[test]
fn survival_table_has_findings_and_censored_ropes() {
    const START_S: f64 = 1_793_600_000.0;
    let at = |hours: f64| START_S + 3600.0 * hours;
    let entry = |hours: f64, event: Event| Entry {
        time_utc_s: at(hours),
        event,
    };
    let replaced = |hours: f64, joint: &str| {
        let command = Command {
            who: "ada".into(),
            note: String::new(),
            what: CommandKind::Replaced {
                joints: vec![joint.into()],
            },
        };
        entry(hours, Event::Command { command })
    };
    let corrected = |hours: f64, joint: &str, withdrawn: bool| {
        let maintenance = Maintenance {
            number: 1,
            joints: vec![joint.into()],
            replaced: true,
            time_utc_s: at(hours),
            recorded_utc_s: at(hours),
            after_utc_s: None,
            who: "ada".into(),
            correction: Some(Correction {
                who: "ben".into(),
                time_utc_s: at(13.0),
                withdrawn,
            }),
        };
        entry(13.0, Event::Maintenance { maintenance })
    };
    let incident = |number: u64, hours: f64, finding| {
        let incident = Incident {
            joint: "elbow".into(),
            number,
            opened_utc_s: at(hours),
            phase: IncidentPhase::Acknowledged,
            closed_utc_s: None,
            evidence: Vec::new(),
            causes: Vec::new(),
            finding,
            note: String::new(),
        };
        entry(hours, Event::Incident { incident })
    };
    let session = |hour: u32| {
        let (duration_s, end) = (1800.0, SessionEnd::Stood);
        entry(f64::from(hour), Event::Session { duration_s, end })
    };
    let mut journal = vec![
        // Of the rope whose age is not known.
        incident(1, 0.2, Some(Finding::StrandFailure)),
        replaced(0.5, "elbow"),
        incident(2, 3.75, Some(Finding::Nothing)),
        incident(2, 3.75, Some(Finding::StrandFailure)),
        replaced(6.5, "elbow"),
        incident(3, 8.5, Some(Finding::ClampSlip)),
        replaced(10.5, "elbow"),
        replaced(12.5, "wrist"),
        corrected(10.5, "elbow", true),
        corrected(12.5, "elbow", false),
    ];
    journal.extend((1..=14).map(session));
    journal.sort_by(|a, b| a.time_utc_s.total_cmp(&b.time_utc_s));
    // The records of the sessions were thinned.
    let stored = Transaction {
        records: vec![record("arm", "elbow", at(1.0))],
        state: None,
        alarms: None,
        journal,
        ..transaction("arm", 1)
    };
    let mut store = Store::open(Place::Memory(33)).unwrap();
    store.commit(&[stored]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("survival.csv");
    let all = RecordQuery::default();
    let count = write_lives(&store.reader().unwrap(), &all, &path).unwrap();
    let columns = EventColumns {
        group: Some("group".into()),
        ..EventColumns::default()
    };
    let lives = read_lives(&path, &columns).unwrap();
    // Sessions at 1, 2, 3 h; at 7 to 12 h; at 13, 14 h: 1.5, 3 and 1 h of motion.
    let ages: Vec<_> = lives
        .lives
        .iter()
        .map(|life| (life.age, life.end))
        .collect();
    let expected = [
        (1.5 * 3600.0, LifeEnd::Broke),
        (3.0 * 3600.0, LifeEnd::Replaced),
        (3600.0, LifeEnd::Whole),
    ];
    assert_eq!((count, ages), (3, expected.to_vec()));
    assert_eq!(lives.lives[0].unit, "arm elbow");
    let group = lives.lives[0].group.as_deref();
    assert_eq!(group, Some(record("arm", "elbow", 0.0).robot_type.as_str()));
}
