//! From the messages of a recording that grows to records that are stored: the whole way, with its threads.

use sinew_watch::config::Config;
use sinew_watch::runtime::{Answer, Control, Runtime, Seen, Start};
use sinew_watch::store::{JournalEntry, JournalQuery, Place, Reader, RecordQuery};
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::alarm::{AlarmCause, AlarmKey, Condition};
use sinew_watch_core::command::{Command, What};
use sinew_watch_core::journal::Event;
use sinew_watch_core::snapshot::{Freshness, NotNow};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

const LONGEST: Duration = Duration::from_secs(120);

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// 40 s at 500 Hz of a stretched arm.
fn stretched() -> Vec<u8> {
    std::fs::read(repository().join("examples/01-stretched-arm/stretched-arm.mcap")).unwrap()
}

/// 24 s at 100 Hz of one that isn't.
fn recording() -> Vec<u8> {
    std::fs::read(repository().join("crates/sinew-watch/demo/arm.mcap")).unwrap()
}

/// A robot that is heard through a file of the folder.
fn config(folder: &Path, more: &str) -> Config {
    let robot = repository().join("robots/biorob-like");
    let text = format!(
        "[store]\ndir = \"store\"\n[[robot]]\nname = \"arm\"\ndir = {robot:?}\n\
         mcap = {{ path = \"run.mcap\", from = \"start\", look_every_s = 0.01 }}\n\
         times = {{ session_motion_s = 12, session_pause_s = 5 }}\n{more}"
    );
    Config::parse(&text, "watch.toml", folder).unwrap()
}

fn start(folder: &Path) -> Runtime {
    Runtime::new(Start::at(Place::Folder(folder.join("store"))))
        .unwrap()
        .0
}

fn seen(runtime: &Runtime) -> Option<Arc<RobotSnapshot>> {
    match runtime.board().get("arm")?.seen() {
        Seen::Watched(snapshot) => Some(snapshot),
        _ => None,
    }
}

fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < LONGEST, "never: {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn frames(runtime: &Runtime) -> u64 {
    seen(runtime).map_or(0, |robot| robot.frames)
}

/// Waits until no more frames come.
fn all_frames(runtime: &Runtime) -> u64 {
    let mut last = (0, Instant::now());
    until("the end of the frames", || {
        let now = frames(runtime);
        if now != last.0 {
            last = (now, Instant::now());
        }
        now > 0 && last.1.elapsed() > Duration::from_secs(3)
    });
    last.0
}

#[test]
fn a_recording_that_grows_becomes_records_that_outlive_the_monitor() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("run.mcap"), stretched()).unwrap();
    let mut runtime = start(folder.path());
    runtime.configure(&config(folder.path(), ""));
    let has_records =
        |r: &Runtime| seen(r).is_some_and(|robot| robot.tendons.iter().all(|t| t.last.is_some()));
    until("records", || has_records(&runtime));
    let robot = seen(&runtime).unwrap();
    // What is shown as recorded is on the disk.
    let place = Place::Folder(folder.path().join("store"));
    let stored = Reader::open(&place)
        .unwrap()
        .records(&RecordQuery::default())
        .unwrap();
    for tendon in &robot.tendons {
        assert!(stored.contains(tendon.last.as_ref().unwrap()));
    }
    // Truth: 14 mrad at the shoulder pitch; 9 at the elbow, 15 after a slip at 24 s.
    let pitch = robot
        .tendons
        .iter()
        .find(|t| t.joint == "shoulder_pitch")
        .unwrap();
    let offset = pitch.last.as_ref().unwrap().offset().unwrap();
    assert!(
        (offset.mean - 0.014).abs() < offset.half_width_95(),
        "{offset:?}"
    );
    runtime.end();
    // Nothing comes any more: an old number is not shown as a new one.
    std::fs::remove_file(folder.path().join("run.mcap")).unwrap();
    let mut runtime = start(folder.path());
    runtime.configure(&config(folder.path(), ""));
    until("records again", || has_records(&runtime));
    let again = seen(&runtime).unwrap();
    assert_eq!(again.freshness, Freshness::Never);
    for tendon in &again.tendons {
        assert_eq!(
            (tendon.offset_rad, tendon.reason),
            (None, Some(NotNow::NoData))
        );
    }
    let last = |robot: &RobotSnapshot| robot.tendons[1].last.clone().map(|r| r.time_utc_s);
    assert!(last(&again) >= last(&robot));
    runtime.end();
    let reader = Reader::open(&place).unwrap();
    assert!(reader.stored("arm").unwrap().belief.is_some());
}

#[test]
fn what_is_held_of_a_silent_robot_is_no_news_when_the_monitor_ends() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("run.mcap"), recording()).unwrap();
    let mut runtime = start(folder.path());
    let mut asked = config(folder.path(), "");
    asked.robots[0].times.stale_after_s = 1.0;
    runtime.configure(&asked);
    until("silence", || {
        seen(&runtime).is_some_and(|robot| matches!(robot.freshness, Freshness::Stale { .. }))
    });
    runtime.end();
    let place = Place::Folder(folder.path().join("store"));
    let asked = JournalQuery {
        most: 1000,
        ..JournalQuery::default()
    };
    let newest_first = Reader::open(&place).unwrap().journal(&asked).unwrap();
    let silent = newest_first
        .iter()
        .position(|e| matches!(e.entry.event, Event::Silent))
        .unwrap();
    let back = |e: &JournalEntry| matches!(e.entry.event, Event::Back { .. });
    assert!(!newest_first[..silent].iter().any(back), "{newest_first:?}");
}

#[test]
fn a_configuration_that_is_read_again_loses_no_sample() {
    let folder = tempfile::tempdir().unwrap();
    let (file, bytes) = (folder.path().join("run.mcap"), stretched());
    std::fs::write(&file, &bytes).unwrap();
    let mut runtime = start(folder.path());
    runtime.configure(&config(folder.path(), ""));
    let undisturbed = all_frames(&runtime);
    runtime.end();
    std::fs::remove_dir_all(folder.path().join("store")).unwrap();

    std::fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    let mut runtime = start(folder.path());
    runtime.configure(&config(folder.path(), ""));
    until("half of it", || frames(&runtime) > undisturbed / 3);
    let mut end = std::fs::File::options().append(true).open(&file).unwrap();
    end.write_all(&bytes[bytes.len() / 2..]).unwrap();
    for round in 0..10 {
        let more = format!("alarm = {{ clear_below = 0.{round}5 }}\n");
        runtime.configure(&config(folder.path(), &more));
    }
    assert_eq!(all_frames(&runtime), undisturbed);
    // A robot that is taken out ends its session, and is stored.
    let other = config(
        folder.path(),
        "[[robot]]\nname = \"b\"\ndir = \"nowhere\"\ndds = {}\n",
    );
    let mut only_b = other.clone();
    only_b.robots.remove(0);
    runtime.configure(&only_b);
    assert!(runtime.board().get("arm").is_none());
    assert!(
        matches!(runtime.board().get("b").unwrap().seen(), Seen::NotWatched(why) if why.contains("nowhere"))
    );
    runtime.end();
    let place = Place::Folder(folder.path().join("store"));
    let stored = Reader::open(&place)
        .unwrap()
        .records(&RecordQuery::default())
        .unwrap();
    assert!(!stored.is_empty());
}

/// Another topic: the robot begins anew from what is stored, and what is said to it then is kept.
#[test]
fn a_robot_that_begins_anew_goes_on_from_its_last_session() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("run.mcap"), recording()).unwrap();
    let mut runtime = start(folder.path());
    runtime.configure(&config(folder.path(), ""));
    until("frames", || frames(&runtime) > 200);
    for round in 0..3 {
        let topic = ["/joint_states", "/other", "/joint_states"][round];
        runtime.configure(&config(
            folder.path(),
            &format!("joint_topic = \"{topic}\"\n"),
        ));
    }
    runtime.end();
    let place = Place::Folder(folder.path().join("store"));
    let asked = JournalQuery {
        most: 1000,
        ..JournalQuery::default()
    };
    let journal = Reader::open(&place).unwrap().journal(&asked).unwrap();
    let began = |e: &&JournalEntry| matches!(e.entry.event, Event::Started { .. });
    let restored = |e: &&JournalEntry| matches!(e.entry.event, Event::Started { restored: true });
    assert_eq!(journal.iter().filter(began).count(), 4, "{journal:?}");
    assert_eq!(journal.iter().filter(restored).count(), 3, "{journal:?}");
}

#[test]
fn months_that_are_over_become_parquet_that_others_read() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("run.mcap"), recording()).unwrap();
    let mut runtime = start(folder.path());
    runtime.configure(&config(folder.path(), ""));
    until("records", || {
        seen(&runtime).is_some_and(|robot| robot.tendons[1].last.is_some())
    });
    let place = Place::Folder(folder.path().join("store"));
    let records = folder.path().join("store/records");
    let time = seen(&runtime).unwrap().tendons[1]
        .last
        .as_ref()
        .unwrap()
        .time_utc_s;
    let write =
        |now_s: f64| sinew_watch::months::write(&place, &records, now_s, &runtime.store()).unwrap();
    assert!(write(time).is_empty(), "the month isn't over");
    let written = write(time + 40.0 * 86_400.0);
    let [file] = &written[..] else {
        panic!("{written:?}")
    };
    let name = file.strip_prefix(&records).unwrap().display().to_string();
    assert!(
        name.starts_with("robot_type=biorob-like/month=20") && name.ends_with("-1.parquet"),
        "{name}"
    );
    assert!(std::fs::read(file).unwrap().ends_with(b"PAR1"));
    until("that it is remembered", || {
        write(time + 40.0 * 86_400.0).is_empty()
    });
    runtime.end();
}

/// Why the robot's door is shut, if that is an alarm.
fn shut(runtime: &Runtime) -> Option<(String, String)> {
    let robot = seen(runtime)?;
    let alarm = robot
        .alarms
        .iter()
        .find(|a| a.key.condition == Condition::Door)?;
    match &alarm.cause {
        AlarmCause::Door { door, why } => Some((door.clone(), why.clone())),
        other => panic!("{other:?}"),
    }
}

/// A monitor whose recording isn't there: that is an alarm.
fn start_without_recording(folder: &Path) -> Runtime {
    let mut runtime = start(folder);
    runtime.configure(&config(folder, ""));
    until("the door's alarm", || {
        runtime.look();
        shut(&runtime).is_some()
    });
    runtime
}

#[test]
fn a_recording_that_is_not_there_is_a_fault_of_the_door_until_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let mut runtime = start_without_recording(folder.path());
    let (door, why) = shut(&runtime).unwrap();
    assert!(door.ends_with("run.mcap") && why.contains("No such file"));
    let doors = runtime.health().doors();
    assert!(doors.len() == 1 && doors[0].shut.as_deref() == Some(why.as_str()));
    let metrics = sinew_watch::web::metrics::render(runtime.board(), runtime.health());
    let line = format!("sinew_door_open{{door=\"{door}\"}} 0\n");
    assert!(metrics.contains(&line), "{metrics}");
    let robot = seen(&runtime).unwrap();
    let said = sinew_watch::words::robot(&robot);
    assert_eq!(said, "the monitor can't listen to it");
    // It is tried again.
    std::fs::write(folder.path().join("run.mcap"), recording()).unwrap();
    until("frames", || frames(&runtime) > 100);
    until("the end of the alarm", || {
        runtime.look();
        shut(&runtime).is_none()
    });
    assert_eq!(runtime.health().doors()[0].shut, None);
    runtime.end();
}

#[test]
fn who_has_his_answer_finds_what_he_said() {
    let folder = tempfile::tempdir().unwrap();
    let runtime = start_without_recording(folder.path());
    let (core, robot) = runtime.board().address("arm").unwrap();
    let slot = runtime.board().get("arm").unwrap();
    let alarm = AlarmKey {
        joint: None,
        condition: Condition::Door,
    };
    let (sender, answers) = std::sync::mpsc::channel();
    core.tell(Control::Command {
        robot,
        command: Command {
            who: "a test".into(),
            note: String::new(),
            what: What::Shelve {
                alarm,
                for_s: 3600.0,
            },
        },
        // Called by who answers, before anything else goes on.
        reply: Box::new(move |answer| sender.send((answer, slot.seen())).unwrap()),
    });
    let (answer, seen) = answers.recv_timeout(LONGEST).unwrap();
    assert!(matches!(answer, Answer::Stored), "{answer:?}");
    let Seen::Watched(robot) = seen else {
        panic!("not watched");
    };
    let mut alarms = robot.alarms.iter();
    let door = alarms.find(|a| a.key.condition == Condition::Door).unwrap();
    assert!(door.shelved_until_utc_s.is_some(), "{door:?}");
    runtime.end();
}

#[test]
fn a_door_that_can_not_be_opened_is_shown_as_shut_with_why() {
    let folder = tempfile::tempdir().unwrap();
    let mut runtime = start(folder.path());
    let config = config(folder.path(), "");
    let mut other = config.clone();
    let text = format!(
        "[[robot]]\nname = \"arm\"\ndir = {:?}\nzenoh = {{ connect = [\"tcp/127.0.0.1:1\"] }}\n",
        repository().join("robots/biorob-like")
    );
    other.robots = Config::parse(&text, "watch.toml", folder.path())
        .unwrap()
        .robots;
    runtime.configure(&other);
    until("the door's alarm", || {
        runtime.look();
        shut(&runtime).is_some()
    });
    let (door, why) = shut(&runtime).unwrap();
    assert!(
        door == "zenoh:0" && why.contains(crate::WITHOUT_ZENOH),
        "{door}: {why}"
    );
    // Another door, and the fault is over.
    std::fs::write(folder.path().join("run.mcap"), recording()).unwrap();
    runtime.configure(&config);
    until("the end of the alarm", || {
        runtime.look();
        frames(&runtime) > 0 && shut(&runtime).is_none()
    });
    runtime.end();
}

#[test]
fn a_topic_that_is_named_wrong_is_told_with_those_that_are_there() {
    for (named, key, there) in [
        (
            "joint_topic = \"/joint_state\"",
            "joint_topic",
            "/joint_states",
        ),
        // With both sides named, no other topic is read.
        (
            "joint_topic = \"/joint_state\"\nmotor_topic = \"/dynamic_joint_states\"",
            "joint_topic",
            "/joint_states",
        ),
        (
            "joint_topic = \"/joint_states\"\nmotor_topic = \"/motors\"",
            "motor_topic",
            "/dynamic_joint_states",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("run.mcap"), recording()).unwrap();
        let mut runtime = start(folder.path());
        let soon = "alarm.data.raise_after_s = 0";
        runtime.configure(&config(folder.path(), &format!("{named}\n{soon}\n")));
        let said = || {
            let robot = seen(&runtime)?;
            let mut data = robot
                .alarms
                .iter()
                .filter(|a| a.key.condition == Condition::Data && a.key.joint.is_none());
            data.next().map(sinew_watch::words::said)
        };
        until("an alarm of the data", || said().is_some());
        let said = said().unwrap();
        assert!(
            said.contains(&format!("{key} asks for /")) && said.contains(there),
            "{named}: {said}"
        );
        runtime.end();
    }
}
