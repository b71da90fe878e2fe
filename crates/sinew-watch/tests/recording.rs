//! From the messages of a growing recording to stored records, with all threads.

use sinew_estimate::Request;
use sinew_estimate::session::{SessionOptions, Window, estimate};
use sinew_watch::config::Config;
use sinew_watch::runtime::{Answer, Control, RobotState, Runtime, Start};
use sinew_watch::store::{JournalEntry, JournalFilter, Place, Reader, RecordQuery};
use sinew_watch_core::RobotSnapshot;
use sinew_watch_core::alarm::{AlarmCause, AlarmKey, Condition};
use sinew_watch_core::command::{Command, CommandKind};
use sinew_watch_core::journal::Event;
use sinew_watch_core::snapshot::{Freshness, NoEstimateReason};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

const LONGEST: Duration = Duration::from_secs(120);

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// 40 s at 500 Hz of an arm with elongated tendons.
fn stretched() -> Vec<u8> {
    std::fs::read(repository().join("examples/01-stretched-arm/stretched-arm.mcap")).unwrap()
}

/// 24 s at 100 Hz of an arm without elongation.
fn recording() -> Vec<u8> {
    std::fs::read(repository().join("crates/sinew-watch/demo/arm.mcap")).unwrap()
}

/// Configuration with a robot that is received through a file of the folder.
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
    match runtime.registry().get("arm")?.state() {
        RobotState::Monitored(snapshot) => Some(snapshot),
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

/// Waits until no further frames arrive.
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
fn recording_grows_and_records_survive_restart() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("run.mcap"), stretched()).unwrap();
    let mut runtime = start(folder.path());
    runtime.configure(&config(folder.path(), ""));
    let has_records =
        |r: &Runtime| seen(r).is_some_and(|robot| robot.tendons.iter().all(|t| t.last.is_some()));
    until("records", || has_records(&runtime));
    let robot = seen(&runtime).unwrap();
    // Records that are shown are on the disk.
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
    // Without data an old value is not shown as a present one.
    std::fs::remove_file(folder.path().join("run.mcap")).unwrap();
    let mut runtime = start(folder.path());
    runtime.configure(&config(folder.path(), ""));
    until("records again", || has_records(&runtime));
    let again = seen(&runtime).unwrap();
    assert_eq!(again.freshness, Freshness::Never);
    for tendon in &again.tendons {
        assert_eq!(
            (tendon.offset_rad, tendon.reason),
            (None, Some(NoEstimateReason::NoData))
        );
    }
    let last = |robot: &RobotSnapshot| robot.tendons[1].last.clone().map(|r| r.time_utc_s);
    assert!(last(&again) >= last(&robot));
    runtime.end();
    let reader = Reader::open(&place).unwrap();
    assert!(reader.stored("arm").unwrap().state.is_some());
}

#[test]
fn shutdown_discards_pending_frames_of_silent_robot() {
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
    let asked = JournalFilter {
        most: 1000,
        ..JournalFilter::default()
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
fn reload_loses_no_sample() {
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
    // A removed robot ends its session, which is stored.
    let other = config(
        folder.path(),
        "[[robot]]\nname = \"b\"\ndir = \"nowhere\"\ndds = {}\n",
    );
    let mut only_b = other.clone();
    only_b.robots.remove(0);
    runtime.configure(&only_b);
    assert!(runtime.registry().get("arm").is_none());
    assert!(
        matches!(runtime.registry().get("b").unwrap().state(), RobotState::NotMonitored(reason) if reason.contains("nowhere"))
    );
    runtime.end();
    let place = Place::Folder(folder.path().join("store"));
    let stored = Reader::open(&place)
        .unwrap()
        .records(&RecordQuery::default())
        .unwrap();
    assert!(!stored.is_empty());
}

/// With another topic the robot restarts from its stored state, and a pending command is kept.
#[test]
fn restarted_robot_continues_from_last_session() {
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
    let asked = JournalFilter {
        most: 1000,
        ..JournalFilter::default()
    };
    let journal = Reader::open(&place).unwrap().journal(&asked).unwrap();
    let began = |e: &&JournalEntry| matches!(e.entry.event, Event::Started { .. });
    let restored = |e: &&JournalEntry| matches!(e.entry.event, Event::Started { restored: true });
    assert_eq!(journal.iter().filter(began).count(), 4, "{journal:?}");
    assert_eq!(journal.iter().filter(restored).count(), 3, "{journal:?}");
}

#[test]
fn completed_months_are_written_as_parquet() {
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
    assert!(write(time).is_empty(), "the month is not complete");
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
    until("the file is recorded", || {
        write(time + 40.0 * 86_400.0).is_empty()
    });
    runtime.end();
}

/// Transport and reason of the robot's disconnection, if there is such an alarm.
fn disconnection(runtime: &Runtime) -> Option<(String, String)> {
    let robot = seen(runtime)?;
    let alarm = robot
        .alarms
        .iter()
        .find(|a| a.key.condition == Condition::Transport)?;
    match &alarm.cause {
        AlarmCause::Transport { transport, reason } => Some((transport.clone(), reason.clone())),
        other => panic!("{other:?}"),
    }
}

/// Monitor whose recording is missing, which raises an alarm.
fn start_without_recording(folder: &Path) -> Runtime {
    let mut runtime = start(folder);
    runtime.configure(&config(folder, ""));
    until("the transport's alarm", || {
        runtime.look();
        disconnection(&runtime).is_some()
    });
    runtime
}

#[test]
fn missing_recording_raises_transport_alarm() {
    let folder = tempfile::tempdir().unwrap();
    let mut runtime = start_without_recording(folder.path());
    let (transport, reason) = disconnection(&runtime).unwrap();
    assert!(transport.ends_with("run.mcap") && reason.contains("No such file"));
    let transports = runtime.health().transports();
    assert!(
        transports.len() == 1 && transports[0].disconnected.as_deref() == Some(reason.as_str())
    );
    let metrics = sinew_watch::web::metrics::render(runtime.registry(), runtime.health());
    let line = format!("sinew_transport_connected{{transport=\"{transport}\"}} 0\n");
    assert!(metrics.contains(&line), "{metrics}");
    let robot = seen(&runtime).unwrap();
    let text = sinew_watch::words::robot(&robot);
    assert_eq!(text, "Transport disconnected");
    // The transport reconnects.
    std::fs::write(folder.path().join("run.mcap"), recording()).unwrap();
    until("frames", || frames(&runtime) > 100);
    until("the end of the alarm", || {
        runtime.look();
        disconnection(&runtime).is_none()
    });
    assert_eq!(runtime.health().transports()[0].disconnected, None);
    runtime.end();
}

#[test]
fn command_answer_follows_snapshot() {
    let folder = tempfile::tempdir().unwrap();
    let runtime = start_without_recording(folder.path());
    let (core, robot) = runtime.registry().address("arm").unwrap();
    let slot = runtime.registry().get("arm").unwrap();
    let alarm = AlarmKey {
        joint: None,
        condition: Condition::Transport,
    };
    let (sender, answers) = std::sync::mpsc::channel();
    core.send(Control::Command {
        robot,
        command: Command {
            who: "a test".into(),
            note: String::new(),
            what: CommandKind::Shelve {
                alarm,
                for_s: 3600.0,
            },
        },
        // Called by the answering thread before it continues.
        reply: Box::new(move |answer| sender.send((answer, slot.state())).unwrap()),
    });
    let (answer, seen) = answers.recv_timeout(LONGEST).unwrap();
    assert!(matches!(answer, Answer::Stored), "{answer:?}");
    let RobotState::Monitored(robot) = seen else {
        panic!("not watched");
    };
    let mut alarms = robot.alarms.iter();
    let transport = alarms
        .find(|a| a.key.condition == Condition::Transport)
        .unwrap();
    assert!(transport.shelved_until_utc_s.is_some(), "{transport:?}");
    runtime.end();
}

#[test]
fn transport_open_failure_reports_disconnected() {
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
    until("the transport's alarm", || {
        runtime.look();
        disconnection(&runtime).is_some()
    });
    let (transport, reason) = disconnection(&runtime).unwrap();
    assert!(
        transport == "zenoh:0" && reason.contains(crate::WITHOUT_ZENOH),
        "{transport}: {reason}"
    );
    // With another transport the fault ends.
    std::fs::write(folder.path().join("run.mcap"), recording()).unwrap();
    runtime.configure(&config);
    until("the end of the alarm", || {
        runtime.look();
        frames(&runtime) > 0 && disconnection(&runtime).is_none()
    });
    runtime.end();
}

/// Two robots, `arm` and `other`, each with a recording of its own.
fn two(folder: &Path) -> Config {
    let robot = repository().join("robots/biorob-like");
    let other = format!(
        "[[robot]]\nname = \"other\"\ndir = {robot:?}\n\
         mcap = {{ path = \"other.mcap\", from = \"start\", look_every_s = 0.01 }}\n"
    );
    config(folder, &other)
}

fn frames_of(runtime: &Runtime, robot: &str) -> u64 {
    match runtime.registry().get(robot).map(|slot| slot.state()) {
        Some(RobotState::Monitored(snapshot)) => snapshot.frames,
        _ => 0,
    }
}

#[test]
fn hostile_recording_is_alarm_of_its_robot_only() {
    let good = recording();
    let chunk =
        |bytes: u64, rest: &[u8]| [mcap::MAGIC, &[0x06], &bytes.to_le_bytes(), rest].concat();
    let mut cut = good.clone();
    cut[good.len() / 2..].fill(0xff);
    for (name, hostile) in [
        (
            "a length beyond the file",
            chunk(u64::MAX - 1, &[0xff; 4096]),
        ),
        ("a chunk of 4 GiB", chunk(40, &[0xff; 40])),
        ("no recording", vec![0x5a; 4096]),
        ("overwritten", cut),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("run.mcap"), hostile).unwrap();
        std::fs::write(folder.path().join("other.mcap"), &good).unwrap();
        let mut runtime = start(folder.path());
        runtime.configure(&two(folder.path()));
        until("frames of the other robot", || {
            runtime.look();
            frames_of(&runtime, "other") > 1000
        });
        until(name, || {
            runtime.look();
            disconnection(&runtime).is_some()
        });
        let transports = runtime.health().transports();
        let other = transports
            .iter()
            .find(|t| t.transport.ends_with("other.mcap"));
        assert_eq!(other.unwrap().disconnected, None, "{name}");
        runtime.end();
    }
}

#[test]
fn failed_robot_restarts_with_alarm_and_others_continue() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["run.mcap", "other.mcap"] {
        std::fs::write(folder.path().join(name), recording()).unwrap();
    }
    let mut runtime = start(folder.path());
    runtime.configure(&two(folder.path()));
    let both = |runtime: &Runtime| ["arm", "other"].map(|robot| frames_of(runtime, robot));
    until("frames", || {
        both(&runtime).iter().all(|frames| *frames > 1000)
    });
    let [_, before] = both(&runtime);
    // The reply to a rejected command is called among the robot's other work.
    let (core, robot) = runtime.registry().address("arm").unwrap();
    core.send(Control::Command {
        robot,
        command: Command {
            who: "a test".into(),
            note: String::new(),
            what: CommandKind::Tensioned { joints: Vec::new() },
        },
        reply: Box::new(|_| panic!("this panic belongs to the test")),
    });
    let slot = runtime.registry().get("arm").unwrap();
    until("the end of its monitoring", || {
        matches!(slot.state(), RobotState::NotMonitored(_))
    });
    until("the alarm of the robot", || {
        runtime.look();
        disconnection(&runtime).is_some_and(|(source, reason)| {
            source == "sinew-watch" && reason.contains("internal error")
        })
    });
    until("the end of the alarm, and new data", || {
        runtime.look();
        disconnection(&runtime).is_none() && frames(&runtime) > 100
    });
    assert!(frames_of(&runtime, "other") >= before);
    runtime.end();
}

#[test]
fn misspelt_topic_alarm_lists_candidates() {
    for (named, key, there) in [
        (
            "joint_topic = \"/joint_state\"",
            "joint_topic",
            "/joint_states",
        ),
        // With both sides specified, no other topic is read.
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
            data.next().map(sinew_watch::words::observation)
        };
        until("an alarm of the data", || said().is_some());
        let said = said().unwrap();
        assert!(
            said.contains(&format!(" of {key} not found")) && said.contains(there),
            "{named}: {said}"
        );
        runtime.end();
    }
}

/// Offset and standard deviation of each tendon, rad, as by `sinew estimate`.
fn offsets(recording: &Path) -> Vec<[f64; 2]> {
    let request = Request {
        robot: Some(repository().join("robots/biorob-like")),
        ..Request::new(recording.into())
    };
    let whole = Window {
        from_s: 0.0,
        to_s: f64::INFINITY,
    };
    let options = SessionOptions::default();
    let (estimate, _) = estimate(&request, whole, None, &options, &mut |_| {}).unwrap();
    let joints = estimate.joints.iter();
    joints
        .map(|joint| [joint.offset_rad.mean, joint.offset_rad.std])
        .collect()
}

/// The elbow slips at 24 s: the recording of its incident yields the estimate of the robot's own recording.
#[test]
fn incident_is_recorded_and_estimated() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run.mcap");
    std::fs::write(&run, stretched()).unwrap();
    let mut runtime = start(folder.path());
    let mut asked = config(folder.path(), "");
    asked.robots[0].times.session_motion_s = 100.0;
    runtime.configure(&asked);
    let incident = || {
        let robot = seen(&runtime)?;
        let mut incidents = robot.incidents.iter();
        incidents.find(|i| i.joint == "elbow").map(|i| i.number)
    };
    until("an incident of the elbow", || incident().is_some());
    let number = incident().unwrap();
    // The rest of the window is not awaited.
    runtime.end();
    let name = format!("incident-{number:06}.mcap");
    let written = folder.path().join("store/incidents/arm").join(name);
    for (own, original) in offsets(&written).into_iter().zip(offsets(&run)) {
        let [mean, std] = own;
        assert!(
            (mean - original[0]).abs() < 0.1 * std && (std / original[1] - 1.0).abs() < 0.1,
            "{own:?} {original:?}"
        );
    }
}
