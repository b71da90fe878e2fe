//! Host of a microcontroller that computes blocks (`examples/microcontroller`).
//!
//! ```text
//! microcontroller prepare ROBOT LOG|motion SECONDS OUT    OUT/robot.image, OUT/samples.bin, and the expected output of the chip:
//!                                                         OUT/desktop.line, OUT/desktop.offsets
//! microcontroller estimate ROBOT LINE [BASELINE]          offsets of the blocks on a line: a serial port, a pipe, a file
//! microcontroller rounded ROBOT LOG SECONDS               effect of single precision of samples and blocks on the offsets
//! microcontroller figures FILE                            counters of the program on the chip
//! ```
//!
//! ROBOT is a robot's folder, or a URDF whose joints all get a spring of 40 N·m/rad. `motion` generates a smooth motion
//! instead of a recording.

use sinew_estimate::baseline::Baseline;
use sinew_estimate::feeder::{Feeder, FeederOptions};
use sinew_estimate::online::Window;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{Recorded, Recorder, SessionOptions, estimate_recorded};
use sinew_log::{Frame, OpenOptions};
use sinew_model::Gaussian;
use sinew_model::arm::Arm;
use sinew_model::arm::urdf::{self, UrdfOptions};
use sinew_model::offset::{Block, FeatureConfig, FeatureObserver, OffsetConfig, OffsetObserver};
use sinew_model::robot::Robot;
use sinew_model::transmission::Transmission;
use sinew_model::wire::{BlockReceiver, BlockSender, RobotImage};
use std::error::Error;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;
type Springs = Vec<Option<Transmission>>;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        ["prepare", robot, log, seconds, out] => prepare(robot, log, seconds, Path::new(out)),
        ["estimate", robot, line, rest @ ..] => estimate(robot, line, rest.first().copied()),
        ["rounded", robot, log, seconds] => rounded(robot, log, seconds),
        ["figures", file] => figures(file),
        _ => {
            Err("usage: microcontroller prepare|estimate|rounded|figures …; see its source".into())
        }
    };
    if let Err(error) = done {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

/// Writes the input of a chip and its expected output.
fn prepare(place: &str, log: &str, seconds: &str, out: &Path) -> Outcome {
    let seconds: f64 = seconds.parse()?;
    let (arm, springs, frames) = match log {
        "motion" => {
            let (arm, springs) = robot(place, None)?;
            let frames = motion(arm.dof(), seconds);
            (arm, springs, frames)
        }
        log => recorded(place, log, seconds)?,
    };
    std::fs::create_dir_all(out)?;
    let image = RobotImage::new(&arm, &springs).write();
    std::fs::write(out.join("robot.image"), image)?;
    let samples: Vec<u8> = frames.iter().flat_map(sample).collect();
    std::fs::write(out.join("samples.bin"), samples)?;
    let [offsets, line] = desktop(&arm, &springs, &frames)?;
    std::fs::write(out.join("desktop.offsets"), offsets)?;
    std::fs::write(out.join("desktop.line"), line)?;
    println!("{} samples of {} joints", frames.len(), arm.dof());
    Ok(())
}

fn robot(place: &str, description: Option<&str>) -> Outcome<(Arm, Springs)> {
    if Path::new(place).extension().is_some_and(|e| e == "urdf") {
        let arm = urdf::parse(&std::fs::read_to_string(place)?, &UrdfOptions::default())?.arm;
        let springs = vec![Some(Transmission::spring(40.0)); arm.dof()];
        return Ok((arm, springs));
    }
    let robot = robot_dir::load(Path::new(place), description)?.robot;
    Ok((robot.arm, robot.transmissions))
}

/// The first seconds of a recording.
fn recorded(place: &str, log: &str, seconds: f64) -> Outcome<(Arm, Springs, Vec<Frame>)> {
    let mut recording = sinew_log::open(Path::new(log), &OpenOptions::default())?;
    let (arm, springs) = robot(place, recording.robot_description())?;
    let names: Vec<&str> = arm.joint_names().iter().map(String::as_str).collect();
    recording.select(&names)?;
    let mut frames: Vec<Frame> = Vec::new();
    while let Some(frame) = recording.next_frame()? {
        let start_ns = frames.first().map_or(frame.time_ns, |first| first.time_ns);
        if (frame.time_ns - start_ns) as f64 * 1e-9 > seconds {
            break;
        }
        frames.push(frame.clone());
    }
    Ok((arm, springs, frames))
}

/// Smooth motion at 250 Hz, with occasional samples without a joint position, and one gap.
fn motion(n: usize, seconds: f64) -> Vec<Frame> {
    const PERIOD_S: f64 = 4e-3;
    const PAUSE_NS: i64 = 700_000_000;
    let count = (seconds / PERIOD_S) as i64;
    let frames = (0..count).map(|k| {
        let t = PERIOD_S * k as f64;
        let mut frame = Frame::new(n);
        let pause = if 2 * k > count { PAUSE_NS } else { 0 };
        frame.time_ns = 4_000_000 * k + pause;
        for i in 0..n {
            let rate = 1.0 + 0.3 * i as f64;
            frame.q[i] = 0.5 * (rate * t).sin();
            frame.theta[i] = frame.q[i] + 0.005 + 1e-4 * (7.0 * rate * t).sin();
        }
        if k % 97 == 96 {
            frame.q[0] = f64::NAN;
        }
        frame.temperature_c = 20.0;
        frame
    });
    frames.collect()
}

/// Encodes a sample for the bench on the chip.
fn sample(frame: &Frame) -> Vec<u8> {
    let mut bytes = frame.time_ns.to_le_bytes().to_vec();
    bytes.extend(frame.segment.to_le_bytes());
    let values = [&frame.q, &frame.theta, &frame.tau_m].into_iter().flatten();
    for value in std::iter::once(&frame.temperature_c).chain(values) {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

/// Computes the expected output from the frames: the paper's offsets, NaN for a rejected frame, and the bytes of the
/// line.
fn desktop(arm: &Arm, springs: &Springs, frames: &[Frame]) -> Outcome<[Vec<u8>; 2]> {
    let observer = OffsetObserver::new(arm, springs, OffsetConfig::default())?;
    let mut observer = Feeder::new(observer, springs, FeederOptions::default());
    let features = FeatureObserver::new(arm, FeatureConfig::default());
    let mut sender = BlockSender::new(&features);
    let mut features = Feeder::new(features, springs, FeederOptions::default());
    let (mut offsets, mut line) = (Vec::new(), Vec::new());
    for frame in frames {
        let taken = observer.frame(frame).output().is_some();
        for offset in observer.observer().delta_e() {
            let offset = if taken { *offset } else { f64::NAN };
            offsets.extend(offset.to_le_bytes());
        }
        if features.frame(frame).output() == Some(true) {
            sender.put(features.observer().block())?;
        }
        line.extend(sender.pending());
        sender.sent(usize::MAX);
    }
    Ok([offsets, line])
}

/// Estimates offsets from the blocks on a line.
fn estimate(place: &str, line: &str, baseline: Option<&str>) -> Outcome {
    /// Number of blocks between two printed lines.
    const BLOCKS_PER_LINE: u64 = 50;
    let robot = robot_dir::load(Path::new(place), None)?.robot;
    let baseline = match baseline {
        None => None,
        Some(file) => Some((Baseline::read(Path::new(file))?, file.to_owned())),
    };
    let mut window = Window::new(robot.clone(), baseline, &SessionOptions::default(), line)?;
    let mut receiver = BlockReceiver::new(&robot.arm, &FeatureConfig::default());
    // Start time of the chip on the window's clock.
    let mut start_s = 0.0;
    for byte in BufReader::new(File::open(line)?).bytes() {
        match receiver.push(byte?) {
            Ok(None) => {}
            Ok(Some(received)) => {
                if received.restarted {
                    start_s = window.answer().time_s.max(0.0);
                    eprintln!(
                        "the chip restarted: encoders that lose their zero without power must be zeroed again"
                    );
                }
                if received.lost_before > 0 {
                    eprintln!("{} blocks were lost", received.lost_before);
                }
                window.push(&part(received.block, start_s));
                if window.is_due() {
                    window.solve();
                }
                if receiver.counts().blocks.is_multiple_of(BLOCKS_PER_LINE) {
                    print_offsets(robot.joint_names(), &window);
                }
            }
            Err(reason) => eprintln!("block rejected: {reason}"),
        }
    }
    let counts = receiver.counts();
    println!(
        "{} blocks used, {} lost, {} rejected",
        counts.blocks, counts.lost, counts.rejected
    );
    print_offsets(robot.joint_names(), &window);
    Ok(())
}

/// Converts a block of a chip that started at `start_s` to the input of a window.
fn part(mut block: Block, start_s: f64) -> Recorded {
    block.time_s += start_s;
    let half_s = 0.5 * FeatureConfig::default().block_s;
    let time_ns = |s: f64| (s * 1e9).round() as i64;
    Recorded {
        start_time_ns: time_ns(block.time_s - half_s),
        end_time_ns: time_ns(block.time_s + half_s),
        blocks: vec![block],
        ..Recorded::default()
    }
}

fn print_offsets(names: &[String], window: &Window) {
    let answer = window.answer();
    if let Some(reason) = window.error() {
        println!("not solved: {reason}");
    }
    if window.estimate().is_none() {
        println!("{:5} blocks, no window solved yet", answer.blocks);
        return;
    }
    let offsets = answer.joints.iter().map(|own| {
        let (name, offset) = (&names[own.joint], own.offset_rad.scaled(1e3));
        let half_width = offset.half_width_95();
        format!("  {name} {:+.3} ± {half_width:.3}", offset.mean)
    });
    let offsets: String = offsets.collect();
    let provisional = match answer.is_provisional() {
        true => ", provisional",
        false => "",
    };
    println!("{:5} blocks{offsets} mrad{provisional}", answer.blocks);
}

/// Prints the change of the offsets if samples, or blocks, are rounded to single precision: a lower bound of its cost.
fn rounded(place: &str, log: &str, seconds: &str) -> Outcome {
    let (.., frames) = recorded(place, log, seconds.parse()?)?;
    let robot = robot_dir::load(Path::new(place), None)?.robot;
    let single = |x: &mut f64| *x = f64::from(*x as f32);
    let mut coarse = frames.clone();
    for frame in &mut coarse {
        let values = [&mut frame.q, &mut frame.theta, &mut frame.tau_m];
        values.into_iter().flatten().for_each(single);
    }
    let exact = offsets(&robot, &frames, |_| ())?;
    let of_samples = offsets(&robot, &coarse, |_| ())?;
    let of_blocks = offsets(&robot, &frames, |block| {
        let own = [&mut block.q, &mut block.y, &mut block.y_slow];
        let own = own
            .into_iter()
            .chain([&mut block.y_square, &mut block.y_cube]);
        let own = own.chain([&mut block.phi, &mut block.turned, &mut block.encoder]);
        let own = own.chain([&mut block.z, &mut block.z_unknown, &mut block.dq]);
        let own = own.chain([&mut block.z_load, &mut block.motor_torque]);
        let own = own.chain([&mut block.motor_acceleration, &mut block.motor_velocity]);
        let own = own.chain([&mut block.motor_z, &mut block.motor_z_load]);
        let own = own.chain([&mut block.motor_stood]);
        own.flatten().for_each(single);
    })?;
    let names = robot.joint_names().iter().zip(&robot.transmissions);
    let elastic = names.filter(|(_, spring)| spring.is_some());
    for (i, (name, _)) in elastic.enumerate() {
        let apart = |other: &[Gaussian]| 1e6 * (other[i].mean - exact[i].mean).abs();
        println!(
            "{name}: rounded samples move the offset by {:.5} µrad, rounded blocks by {:.5} µrad",
            apart(&of_samples),
            apart(&of_blocks)
        );
    }
    Ok(())
}

/// Estimates the offsets of a recording whose blocks are modified by `change`.
fn offsets(robot: &Robot, frames: &[Frame], change: impl Fn(&mut Block)) -> Outcome<Vec<Gaussian>> {
    let gap_s = FeederOptions::default().gap_s;
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), gap_s);
    let start_ns = frames.first().map_or(0, |frame| frame.time_ns);
    for frame in frames {
        recorder.push(frame, (frame.time_ns - start_ns) as f64 * 1e-9);
    }
    let mut recorded = recorder.finish();
    recorded.blocks.iter_mut().for_each(change);
    let options = SessionOptions::default();
    let (estimate, _) = estimate_recorded(robot, &recorded, "rounded", None, &options)?;
    Ok(estimate.joints.iter().map(|own| own.offset_rad).collect())
}

/// Prints the counters of the program on the chip. A tick is 40 ns of virtual time, an instruction 128 ns (`-icount
/// shift=7`), so that instructions are counted exactly.
fn figures(file: &str) -> Outcome {
    const INSTRUCTIONS_PER_TICK: f64 = 40.0 / 128.0;
    let bytes = std::fs::read(file)?;
    let words = bytes.chunks_exact(4).map(|word| word.try_into());
    let words: Vec<u32> = words
        .map(|w| w.map(u32::from_le_bytes))
        .collect::<Result<_, _>>()?;
    let [
        joints,
        flash,
        image,
        statics,
        heap,
        heap_most,
        calls,
        stack_start,
        stack,
        empty,
        observe_mean,
        observe_most,
        collect_mean,
        collect_most,
        blocks,
        left_out,
        frame,
    ] = words[..]
    else {
        return Err(format!("{file} contains {} values, expected 17", words.len()).into());
    };
    let instructions =
        |ticks: u32| f64::from(ticks.saturating_sub(empty)) * INSTRUCTIONS_PER_TICK * 1e-3;
    println!("joints {joints}");
    println!("flash {flash} bytes, of which the robot {image}");
    println!(
        "memory: statics {statics} bytes, heap {heap} bytes, {heap_most} at most while it starts"
    );
    println!("stack: {stack_start} bytes while it starts, {stack} in the loop");
    println!("calls of the allocator in the loop: {calls}");
    println!(
        "observer, thousand instructions a sample: {:.1} in the mean, {:.1} at most",
        instructions(observe_mean),
        instructions(observe_most)
    );
    println!(
        "block, thousand instructions a sample: {:.1} in the mean, {:.1} at most",
        instructions(collect_mean),
        instructions(collect_most)
    );
    println!("blocks {blocks}, skipped {left_out}, at most {frame} bytes each");
    if calls > 0 || left_out > 0 {
        return Err("the loop must not allocate or skip a block".into());
    }
    Ok(())
}
