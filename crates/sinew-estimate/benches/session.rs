//! Absolute estimate compared with reading the log: one simulated minute with payload and contacts, and three minutes
//! with a payload change, six slips and contacts.
//!
//! `cargo bench -p sinew-estimate --bench session` prints, for 250 Hz and 1 kHz, CSV and MCAP (and
//! Parquet, 250 Hz, if `../shared` exists), the processor time and the elapsed time of every stage of
//! `sinew estimate LOG --baseline FILE`, and their ratio to reading
//! the log; then the cost of a feature step, of the batch, and of the online estimate. A word after `--` selects the
//! recordings with that name (`-- eventful`).

use cpu_time::ProcessTime;
use sinew_estimate::Request;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::online;
use sinew_estimate::replay;
use sinew_estimate::robot_dir;
use sinew_estimate::session;
use sinew_estimate::session::{Recorded, Recorder, SessionOptions, Window};
use sinew_log::{CsvWriter, Frame, FrameWriter, McapOptions, McapWriter, OpenOptions, Quantities};
use sinew_model::offset::{FeatureConfig, FeatureObserver};
use sinew_model::robot::Robot;
use sinew_sim::{Scenario, Simulation};
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Duration of a session, s.
const SESSION_S: f64 = 60.0;

fn main() {
    // `cargo test --benches` only checks that it runs.
    let quick = std::env::args().any(|a| a == "--test");
    let (rounds, rates): (usize, &[f64]) = if quick {
        (1, &[250.0])
    } else {
        (11, &[250.0, 1000.0])
    };
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let wanted = |name: &str| {
        only.as_ref()
            .is_none_or(|only| name.contains(only.as_str()))
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let place = root.join("robots/biorob-like");
    let robot = robot_dir::load(&place, None).expect("robot").robot;
    let folder = tempfile::tempdir().expect("temporary folder");
    for &rate_hz in rates {
        let all = frames(&root, &robot, rate_hz);
        let sessions: Vec<&[Frame]> = all.chunks((rate_hz * SESSION_S) as usize).collect();
        let (a, b) = (sessions[0], sessions[1]);
        let (baseline, _) = session::learn_recorded(
            &robot,
            &recorded(&robot, a),
            "A",
            &session::Learning::default(),
        )
        .expect("baseline");
        let whole = Window::default();
        for (name, frames, rounds) in [
            ("a minute", b, rounds),
            ("eventful", &all, rounds.div_ceil(2)),
        ] {
            if !wanted(name) {
                continue;
            }
            let seconds = (frames.len() as f64 / rate_hz).round();
            println!(
                "{name}: {seconds} s at {rate_hz} Hz, {} frames",
                frames.len()
            );
            let csv = folder.path().join("b.csv");
            let mcap = folder.path().join("b.mcap");
            write_csv(&csv, &robot, frames);
            write_mcap(&mcap, &robot, frames);
            stages("CSV", &csv, &place, &robot, whole, &baseline, rounds);
            stages("MCAP", &mcap, &place, &robot, whole, &baseline, rounds);
        }
        if wanted("a minute") {
            if rate_hz == 250.0 {
                parquet(&root, &place, &robot, rounds);
            }
            steps(&robot, b, &baseline, rounds);
        }
    }
}

/// Frames of the example's work session: A, B and C.
fn frames(root: &Path, robot: &Robot, rate_hz: f64) -> Vec<Frame> {
    let file = root.join("examples/scenarios/work-session.toml");
    let text = std::fs::read_to_string(file).expect("scenario");
    let mut scenario = Scenario::from_toml(&text, "work-session.toml").expect("scenario");
    scenario.sample_rate_hz = rate_hz;
    let mut simulation = Simulation::new(robot, &scenario).expect("simulation");
    let mut frames = Vec::new();
    while let Some(frame) = simulation.next_frame().expect("frame") {
        frames.push(frame.clone());
    }
    frames
}

fn recorded(robot: &Robot, frames: &[Frame]) -> Recorded {
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let start = frames.first().map_or(0, |f| f.time_ns);
    for frame in frames {
        recorder.push(frame, (frame.time_ns - start) as f64 * 1e-9);
    }
    recorder.finish()
}

/// Writes the format of `sinew simulate --out FILE.csv`.
fn write_csv(path: &Path, robot: &Robot, frames: &[Frame]) {
    let mut writer = CsvWriter::create(path, robot.joint_names(), quantities()).expect("recording");
    for frame in frames {
        writer.write(frame).expect("frame");
    }
    Box::new(writer).finish().expect("recording");
}

fn quantities() -> Quantities {
    Quantities {
        tau_m: true,
        temperature: true,
        ..Quantities::positions()
    }
}

fn write_mcap(path: &Path, robot: &Robot, frames: &[Frame]) {
    let options = McapOptions {
        joints: robot.joint_names().to_vec(),
        quantities: quantities(),
        ..McapOptions::default()
    };
    let mut writer = McapWriter::create(path, &options).expect("recording");
    for frame in frames {
        writer.write(frame).expect("frame");
    }
    Box::new(writer).finish().expect("recording");
}

/// Durations of a stage, s: processor time of all threads, and elapsed time.
#[derive(Default)]
struct Stage(Vec<[f64; 2]>);

impl Stage {
    fn run(&mut self, f: impl FnOnce()) {
        let (processor, clock) = (ProcessTime::now(), Instant::now());
        f();
        let elapsed = clock.elapsed().as_secs_f64();
        self.0.push([processor.elapsed().as_secs_f64(), elapsed]);
    }

    /// Median of processor time and elapsed time, s.
    fn median(&self) -> [f64; 2] {
        [0, 1].map(|which| {
            let mut all: Vec<f64> = self.0.iter().map(|times| times[which]).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        })
    }
}

/// Times every stage of a command on one file and prints its share.
fn stages(
    name: &str,
    log: &Path,
    place: &Path,
    robot: &Robot,
    window: Window,
    baseline: &Baseline,
    rounds: usize,
) {
    let mut request = Request::new(log.to_path_buf());
    request.robot = Some(PathBuf::from(place));
    let with = Some((baseline, "A"));
    let options = SessionOptions::default();
    let mut stage: [Stage; 6] = Default::default();
    for _ in 0..rounds {
        let mut kept = Recorded::default();
        stage[0].run(|| {
            black_box(read(log, robot, window));
        });
        stage[1].run(|| kept = features(log, robot, window));
        stage[2].run(|| {
            let said = session::estimate_recorded(robot, &kept, "B", with, &options);
            drop(black_box(said.expect("estimate")));
        });
        stage[3].run(|| {
            drop(black_box(
                replay::run(&request, &mut |_| {}).expect("estimate"),
            ))
        });
        stage[4].run(|| {
            let said = session::estimate(&request, window, with, &options, &mut |_| {});
            drop(black_box(said.expect("estimate")));
        });
        stage[5].run(|| {
            let said = session::estimate_with_replay(
                &request,
                window,
                with,
                &options,
                &mut |_, _| {},
                &mut |_| {},
            );
            drop(black_box(said.expect("estimate")));
        });
    }
    let [read, features, watch, paper, absolute, both] = stage.each_ref().map(Stage::median);
    let features = [features[0] - read[0], features[1] - read[1]];
    println!(
        "{name:8} {:38} processor, of reading   elapsed, of reading",
        ""
    );
    for (what, [processor, elapsed]) in [
        ("reading the log", read),
        ("features beside reading", features),
        ("the batch estimate of the blocks", watch),
        ("reading, features and batch: the whole", absolute),
        ("the paper's estimate, reading included", paper),
        ("the whole and the paper's", both),
    ] {
        println!(
            "{name:8} {what:38} {:6.2} ms {:6.2}       {:6.2} ms {:6.2}",
            1e3 * processor,
            processor / read[0],
            1e3 * elapsed,
            elapsed / read[1]
        );
    }
}

/// Reads every frame of a part without using it.
fn read(log: &Path, robot: &Robot, window: Window) -> u64 {
    let mut count = 0;
    each(log, robot, window, |_, _| count += 1);
    count
}

fn features(log: &Path, robot: &Robot, window: Window) -> Recorded {
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), 0.5);
    each(log, robot, window, |frame, t| {
        recorder.push(frame, t);
    });
    recorder.finish()
}

fn each(log: &Path, robot: &Robot, window: Window, mut take: impl FnMut(&Frame, f64)) {
    let mut recording = sinew_log::open(log, &OpenOptions::default()).expect("recording");
    let names: Vec<&str> = robot.joint_names().iter().map(String::as_str).collect();
    recording.select(&names).expect("joints");
    let mut start = None;
    while let Some(frame) = recording.next_frame().expect("frame") {
        let start: i64 = *start.get_or_insert(frame.time_ns);
        let t = (frame.time_ns - start) as f64 * 1e-9;
        if t >= window.to_s {
            break;
        }
        if t >= window.from_s {
            take(frame, t);
        }
    }
}

/// Measures session B of a shared recording; reading includes session A.
fn parquet(root: &Path, place: &Path, robot: &Robot, rounds: usize) {
    let shared = std::env::var_os("SINEW_SHARED")
        .map_or_else(|| root.join("../shared"), PathBuf::from)
        .join("data/offset_scenarios");
    let found = std::fs::read_dir(&shared).ok().and_then(|files| {
        let mut files: Vec<PathBuf> = files
            .filter_map(|f| Some(f.ok()?.path()))
            .filter(|p| p.extension().is_some_and(|e| e == "parquet"))
            .filter(|p| p.to_string_lossy().contains("S7"))
            .collect();
        files.sort();
        files.into_iter().next()
    });
    let Some(log) = found else {
        println!(
            "SKIPPED: Parquet, no recording of S7 at {}",
            shared.display()
        );
        return;
    };
    let part = |from_s, to_s| Window { from_s, to_s };
    let a = features(&log, robot, part(0.0, SESSION_S));
    let (baseline, _) =
        session::learn_recorded(robot, &a, "A", &session::Learning::default()).expect("baseline");
    let b = part(SESSION_S, 2.0 * SESSION_S);
    stages("Parquet", &log, place, robot, b, &baseline, rounds);
}

/// Cost of a step of the features, of the batch, and of the online estimate.
fn steps(robot: &Robot, frames: &[Frame], baseline: &Baseline, rounds: usize) {
    let options = SessionOptions::default();
    let blocks = recorded(robot, frames);
    let dt_s = SESSION_S / frames.len() as f64;
    let mut stage: [Stage; 3] = Default::default();
    for _ in 0..rounds {
        stage[0].run(|| {
            let mut observer = FeatureObserver::new(&robot.arm, FeatureConfig::default());
            for f in frames {
                let _ = black_box(observer.step(dt_s, &f.q, &f.theta, &f.tau_m, f.temperature_c));
            }
        });
        stage[1].run(|| {
            let with = Some((baseline, "A"));
            let window = online::replay(robot, &blocks, with, &options, "B", &mut |_| {});
            drop(black_box(window));
        });
        stage[2].run(|| {
            let with = Some((baseline, "A"));
            let said = session::estimate_recorded(robot, &blocks, "B", with, &options);
            drop(black_box(said.expect("estimate")));
        });
    }
    let [[features, _], [online, _], [batch, _]] = stage.each_ref().map(Stage::median);
    println!(
        "feature step {:.2} µs a frame; batch {:.1} ms a minute; online estimate {:.1} ms a minute, {:.1} times the batch, {:.2} % of a core",
        1e6 * features / frames.len() as f64,
        1e3 * batch,
        1e3 * online,
        online / batch,
        1e2 * online / SESSION_S
    );
}
