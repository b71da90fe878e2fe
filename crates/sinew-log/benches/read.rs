//! Computing time of reading frames, compared with reading and decompressing the same file with the `mcap` crate.
//!
//! The recording: seven joints at 1 kHz, joint side (q, dq, tau_el) and motor
//! side (theta, tau_m), encoders of 16 bits and noise, so that it compresses as
//! real ones do. The ratio printed is (time to count the messages) / (time to
//! consume every frame), best of several runs each, taken alternately, file in
//! the page cache; on Linux in CPU time of the thread, so that a busy machine
//! does not decide. `decode/serde` is what `cdr-encoding` takes for one joint
//! state; the reader's own share is the difference of the two times per message.

use std::fs::File;
use std::hint::black_box;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader};
use sinew_log::{
    Compression, Frame, FrameWriter, McapOptions, McapWriter, OpenOptions, Quantities, open,
};

const JOINTS: usize = 7;
const FRAMES: usize = 100_000;
const RUNS: usize = 7;

fn record(path: &Path, compression: Compression) {
    let options = McapOptions {
        joints: (1..=JOINTS)
            .map(|joint| format!("panda_joint{joint}"))
            .collect(),
        quantities: Quantities {
            q: true,
            theta: true,
            dq: true,
            tau_el: true,
            tau_m: true,
            ..Quantities::default()
        },
        compression,
        ..McapOptions::default()
    };
    let mut writer = Box::new(McapWriter::create(path, &options).expect("create"));
    let mut frame = Frame::new(JOINTS);
    let tick = std::f64::consts::TAU / 65_536.0;
    let mut noise = 1_u64;
    for index in 0..FRAMES {
        frame.time_ns = 1_700_000_000_000_000_000 + index as i64 * 1_000_000;
        let time = index as f64 * 1e-3;
        for joint in 0..JOINTS {
            noise = noise
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let ripple = (noise >> 40) as f64 / (1 << 24) as f64 - 0.5;
            let phase = time * (0.3 + 0.1 * joint as f64);
            let torque = 5.0 * phase.cos() + 0.02 * ripple;
            frame.q[joint] = (phase.sin() / tick).round() * tick;
            frame.dq[joint] = phase.cos() + 0.01 * ripple;
            frame.theta[joint] = ((phase.sin() + torque / 200.0) / tick).round() * tick;
            frame.tau_el[joint] = torque;
            frame.tau_m[joint] = torque + 0.1 * ripple;
        }
        writer.write(&frame).expect("write");
    }
    writer.finish().expect("finish");
}

/// Counts the messages with the linear reader: reading and unpacking, nothing else.
fn count_linear(path: &Path) -> u64 {
    let mut file = File::open(path).expect("open");
    let mut reader = LinearReader::new();
    let mut messages = 0;
    while let Some(event) = reader.next_event() {
        match event.expect("intact") {
            LinearReadEvent::ReadRequest(need) => {
                let read = file.read(reader.insert(need.max(256 << 10))).expect("read");
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => {
                messages += u64::from(opcode == op::MESSAGE);
                black_box(data);
            }
        }
    }
    messages
}

/// Counts the messages with the message stream over the whole file in memory.
fn count_stream(path: &Path) -> u64 {
    let bytes = std::fs::read(path).expect("read");
    let mut messages = 0;
    for message in mcap::MessageStream::new(&bytes).expect("open") {
        black_box(message.expect("intact").data.len());
        messages += 1;
    }
    messages
}

fn consume_frames(path: &Path) -> f64 {
    let mut recording = open(path, &OpenOptions::default()).expect("open");
    let mut sum = 0.0;
    while let Some(frame) = recording.next_frame().expect("read") {
        for joint in 0..JOINTS {
            sum += frame.theta[joint] - frame.q[joint];
        }
    }
    assert_eq!(recording.health().frames, FRAMES as u64);
    sum
}

/// CPU time of this thread if the system provides it, otherwise wall time.
fn now() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    let start = START.get_or_init(Instant::now);
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split_ascii_whitespace().next()?.parse().ok())
        .map_or_else(|| start.elapsed(), Duration::from_nanos)
}

fn best(work: impl Fn() -> f64, best: &mut Duration) {
    let start = now();
    black_box(work());
    *best = (*best).min(now() - start);
}

fn print_ratio(name: &str, path: &Path) {
    let bytes = std::fs::metadata(path).expect("stat").len() as f64;
    let [mut linear, mut stream, mut frames] = [Duration::MAX; 3];
    for _ in 0..RUNS {
        best(|| count_linear(path) as f64, &mut linear);
        best(|| consume_frames(path), &mut frames);
        best(|| count_stream(path) as f64, &mut stream);
    }
    let merely = linear.min(stream).as_secs_f64();
    let frames = frames.as_secs_f64();
    let messages = 2.0 * FRAMES as f64;
    println!(
        "{name:>5}: frames {:.0} MB/s, {:.2} million frames/s; merely reading {:.0} MB/s \
         (linear reader {:.1} ms, message stream {:.1} ms); ratio {:.2}; {:+.0} ns per message",
        bytes / frames * 1e-6,
        FRAMES as f64 / frames * 1e-6,
        bytes / merely * 1e-6,
        linear.as_secs_f64() * 1e3,
        stream.as_secs_f64() * 1e3,
        merely / frames,
        (frames - merely) / messages * 1e9,
    );
}

#[derive(serde::Serialize, serde::Deserialize)]
struct JointState {
    sec: i32,
    nanosec: u32,
    frame_id: String,
    name: Vec<String>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    effort: Vec<f64>,
}

fn decode(criterion: &mut Criterion) {
    let message = JointState {
        sec: 1,
        nanosec: 2,
        frame_id: String::new(),
        name: (1..=JOINTS)
            .map(|joint| format!("panda_joint{joint}"))
            .collect(),
        position: vec![1.0; JOINTS],
        velocity: vec![2.0; JOINTS],
        effort: vec![3.0; JOINTS],
    };
    let bytes = cdr_encoding::to_vec::<_, byteorder::LittleEndian>(&message).expect("encode");
    criterion.bench_function("decode/serde", |bencher| {
        bencher.iter(|| {
            cdr_encoding::from_bytes::<JointState, byteorder::LittleEndian>(black_box(&bytes))
                .expect("decode")
        });
    });
}

fn read(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("folder");
    // SINEW_BENCH_FILES keeps the recordings for a profiler.
    let kept = std::env::var_os("SINEW_BENCH_FILES").map(PathBuf::from);
    let place = kept.as_deref().unwrap_or(folder.path());
    let file = |name: &str| -> PathBuf { place.join(format!("{name}.mcap")) };
    for (name, compression) in [
        ("zstd", Compression::Zstd),
        ("lz4", Compression::Lz4),
        ("none", Compression::None),
    ] {
        let path = file(name);
        record(&path, compression);
        print_ratio(name, &path);
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10);
        group.throughput(Throughput::Elements(FRAMES as u64));
        group.bench_function("merely", |bencher| bencher.iter(|| count_linear(&path)));
        group.bench_function("frames", |bencher| bencher.iter(|| consume_frames(&path)));
        group.finish();
    }
}

criterion_group!(benches, read, decode);
criterion_main!(benches);
