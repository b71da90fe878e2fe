//! Replay compared with reading of one simulated recording, in the same run.
//!
//! `cargo bench -p sinew-estimate --bench replay` prints samples/s and MB/s of the paper's estimate and of
//! reading and decompressing the same MCAP with both readers of the `mcap` crate, and the ratios: `LinearReader`, the
//! faster one, returns raw records without checksums; `MessageStream` returns messages with their channels.

use mcap::records::op::MESSAGE;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader};
use sinew_estimate::Request;
use sinew_estimate::replay;
use sinew_estimate::robot_dir;
use sinew_log::{Compression, FrameWriter, McapOptions, McapWriter};
use sinew_sim::{Scenario, Simulation};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn main() {
    // `cargo test --benches` only checks that it runs.
    let quick = std::env::args().any(|a| a == "--test");
    let rounds = if quick { 1 } else { 9 };
    let seconds = if quick { 2.0 } else { 300.0 };
    let folder = tempfile::tempdir().expect("temporary folder");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let robot = root.join("robots/biorob-like");
    for (name, compression) in [
        ("zstd", Compression::Zstd),
        ("lz4", Compression::Lz4),
        ("none", Compression::None),
    ] {
        let log = folder.path().join(format!("{name}.mcap"));
        let frames = record(&root, &robot, &log, compression, seconds);
        let bytes = std::fs::metadata(&log).expect("recording").len();
        let (mut records, mut messages, mut estimated) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..rounds {
            records.push(time(|| read_records(&log)));
            messages.push(time(|| read_messages(&log)));
            estimated.push(time(|| run(&log, &robot)));
        }
        let [records, messages, estimated] = [records, messages, estimated].map(median);
        let speed = |s: f64| {
            format!(
                "{:7.2} M samples/s {:7.1} MB/s of file",
                frames as f64 / s * 1e-6,
                bytes as f64 / s * 1e-6
            )
        };
        println!("{name:5} LinearReader  {}", speed(records));
        println!("{name:5} MessageStream {}", speed(messages));
        println!("{name:5} estimate      {}", speed(estimated));
        println!(
            "{name:5} speed of estimate over LinearReader {:.2}, over MessageStream {:.2}",
            records / estimated,
            messages / estimated
        );
    }
}

fn record(root: &Path, robot: &Path, log: &Path, compression: Compression, seconds: f64) -> u64 {
    let file = root.join("examples/scenarios/stretched-arm.toml");
    let text = std::fs::read_to_string(&file).expect("scenario");
    let mut scenario = Scenario::from_toml(&text, "stretched-arm.toml").expect("scenario");
    scenario.duration_s = Some(seconds);
    scenario.sample_rate_hz = 1000.0;
    let robot = robot_dir::load(robot, None).expect("robot");
    let mut simulation = Simulation::new(&robot.robot, &scenario).expect("simulation");
    let options = McapOptions {
        joints: simulation.joint_names().to_vec(),
        compression,
        robot_description: Some(robot.urdf_text.clone()),
        ..McapOptions::default()
    };
    let mut writer = McapWriter::create(log, &options).expect("recording");
    let mut frames = 0;
    while let Some(frame) = simulation.next_frame().expect("frame") {
        writer.write(frame).expect("frame");
        frames += 1;
    }
    Box::new(writer).finish().expect("recording");
    frames
}

/// Reads and decompresses every record without using it.
fn read_records(log: &Path) -> u64 {
    let bytes = std::fs::read(log).expect("recording");
    let mut file = bytes.as_slice();
    let mut reader = LinearReader::new();
    let mut count = 0;
    while let Some(event) = reader.next_event() {
        match event.expect("mcap") {
            LinearReadEvent::ReadRequest(need) => {
                let read = file.read(reader.insert(need)).expect("recording");
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => {
                count += u64::from(opcode == MESSAGE && !data.is_empty());
            }
        }
    }
    count
}

/// Reads and decompresses every message without using it.
fn read_messages(log: &Path) -> u64 {
    let bytes = std::fs::read(log).expect("recording");
    let mut count = 0;
    for message in mcap::MessageStream::new(&bytes).expect("mcap") {
        count += u64::from(!message.expect("message").data.is_empty());
    }
    count
}

fn run(log: &Path, robot: &Path) -> u64 {
    let mut request = Request::new(log.to_path_buf());
    request.robot = Some(PathBuf::from(robot));
    replay::run(&request, &mut |_| {})
        .expect("estimate")
        .recording
        .frames
}

fn time(f: impl Fn() -> u64) -> f64 {
    let start = Instant::now();
    assert!(f() > 0);
    start.elapsed().as_secs_f64()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
