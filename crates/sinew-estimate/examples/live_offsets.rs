//! Absolute offsets sample by sample, as beside a running robot:
//!
//! `cargo run --release -p sinew-estimate --example live_offsets -- ROBOT_DIR BASELINE LOG [FROM_S [SAVE]]`
//!
//! SAVE is the next baseline file, written in the end.
//!
//! A recording stands in for the robot. What it has to do for every sample stands between the
//! comments "Sample" and "Output": nothing there allocates, locks, panics or prints, so that it may
//! stand in a control thread.

use sinew_estimate::baseline::Baseline;
use sinew_estimate::feeder::{Feeder, FeederOptions};
use sinew_estimate::robot_dir;
use sinew_estimate::session;
use sinew_estimate::session::SessionOptions;
use sinew_log::OpenOptions;
use sinew_model::Gaussian;
use sinew_model::offset::{FeatureConfig, FeatureObserver};
use std::error::Error;
use std::path::Path;

/// Samples of a block, at most 20 ms apart, less one: a sample does that part of a block's work, so that the offsets come a
/// block, 0.2 s, later. `sinew_estimate::live::LiveOffsets` counts them from a period.
const SAMPLES_OF_BLOCK: usize = 9;

/// Between two lines, s.
const SAY_S: f64 = 10.0;

fn main() {
    if let Err(error) = run() {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [place, file, log, rest @ ..] = arguments.as_slice() else {
        eprintln!("usage: live_offsets ROBOT_DIR BASELINE LOG [FROM_S [SAVE]]");
        std::process::exit(2);
    };
    let from = rest.first().map_or("0", String::as_str);
    let number = from.parse().ok().filter(|s: &f64| s.is_finite());
    let from_s = number.ok_or_else(|| format!("FROM_S: '{from}' is not a number of seconds"))?;

    // Construction.
    let mut recording = sinew_log::open(Path::new(log), &OpenOptions::default())?;
    let robot = robot_dir::load(Path::new(place), recording.robot_description())?.robot;
    let names: Vec<&str> = robot.joint_names().iter().map(String::as_str).collect();
    recording.select(&names)?;
    let baseline = Baseline::read(Path::new(file))?;
    let features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
    let mut feeder = Feeder::new(features, &robot.transmissions, FeederOptions::default());
    let mut offsets = session::live(&robot, (&baseline, file), &SessionOptions::default())?;

    let slices = offsets.slices_per_block().div_ceil(SAMPLES_OF_BLOCK);

    let mut first_ns = None;
    let mut last_ns = None;
    let mut say_s = SAY_S;
    while let Some(frame) = recording.next_frame()? {
        let t = (frame.time_ns - *first_ns.get_or_insert(frame.time_ns)) as f64 * 1e-9;
        if t < from_s {
            continue;
        }
        last_ns = Some(frame.time_ns);

        // Sample. What can't be used is refused, with a reason, and changes nothing.
        if feeder.frame(frame).output() == Some(true) {
            // A block that comes while the one before isn't done with is left out.
            let _taken = offsets.begin(feeder.observer().block())?;
        }
        offsets.advance(slices);

        // Output.
        if t - from_s >= say_s {
            say_s += SAY_S;
            print!("{:6.1} s", t - from_s);
            for (i, name) in names.iter().enumerate() {
                if robot.transmissions[i].is_some() {
                    let Gaussian {
                        mean: offset,
                        deviation,
                    } = offsets.offset(i).scaled(1e3);
                    print!("  {name} {offset:+.2} ± {:.2}", 1.96 * deviation);
                }
            }
            let doubts = if offsets.is_provisional() {
                ", in doubt"
            } else {
                ""
            };
            println!(" mrad{doubts}");
        }
    }
    let Some(end_ns) = last_ns else {
        return Err(format!("{log} has nothing from {from_s} s on").into());
    };
    if let Some(save) = rest.get(1) {
        let next = session::live_saved(&robot, &baseline, &offsets, (log, end_ns))?;
        next.write(Path::new(save))?;
        println!("{save}: what is known now");
    }
    if recording.health().is_damaged() {
        eprintln!("warning: {log} is damaged; `sinew log info {log}` says where");
    }
    Ok(())
}
