//! Online estimate of a running robot, updated per sample:
//!
//! `cargo run --release -p sinew-estimate --example live_offsets -- ROBOT_DIR BASELINE LOG [FROM_S [SAVE]]`
//!
//! SAVE is the next baseline file, written at the end.
//!
//! A recording replaces the robot. The code between the comments "Sample" and "Worker" belongs in the control loop; it
//! does not allocate, lock, panic or print. The code after "Worker" belongs in another thread, which
//! `OnlineEstimator::start_worker` starts.

use sinew_estimate::baseline::Baseline;
use sinew_estimate::online::{OnlineEstimator, StepOutcome};
use sinew_estimate::robot_dir;
use sinew_estimate::session::SessionOptions;
use sinew_log::OpenOptions;
use sinew_model::robot::Robot;
use std::error::Error;
use std::path::Path;

/// Time between two printed lines, s.
const PRINT_PERIOD_S: f64 = 10.0;

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
    let baseline = Some((Baseline::read(Path::new(file))?, file.clone()));
    let options = SessionOptions::default();
    let mut online = OnlineEstimator::new(robot.clone(), baseline, &options, log)?;

    let mut first_ns = None;
    let mut last = None;
    let mut print_s = PRINT_PERIOD_S;
    while let Some(frame) = recording.next_frame()? {
        let t = (frame.time_ns - *first_ns.get_or_insert(frame.time_ns)) as f64 * 1e-9;
        if t < from_s {
            continue;
        }
        let (last_ns, segment) = last.unwrap_or((frame.time_ns, frame.segment));
        last = Some((frame.time_ns, frame.segment));
        if segment != frame.segment {
            online.interrupt();
        }
        // Continue if the clock stepped back.
        let dt_s = (frame.time_ns - last_ns).max(1) as f64 * 1e-9;

        // Sample. An unusable one is rejected, with a reason.
        let (q, theta, tau_m) = (&frame.q, &frame.theta, &frame.tau_m);
        let outcome = online.step(dt_s, q, theta, tau_m, frame.temperature_c)?;

        // Worker. Every tenth block the window is solved.
        if outcome == StepOutcome::Block {
            online.work();
        }

        if t - from_s >= print_s {
            print_s += PRINT_PERIOD_S;
            print_offsets(&robot, t - from_s, &mut online);
        }
    }
    let Some((end_ns, _)) = last else {
        return Err(format!("{log} has no frame from {from_s} s on").into());
    };
    if let Some(save) = rest.get(1) {
        online.save(log, end_ns)?.write(Path::new(save))?;
        println!("{save}: baseline for the next session");
    }
    if recording.health().is_damaged() {
        eprintln!("warning: {log} is damaged; for details run `sinew log info {log}`");
    }
    Ok(())
}

fn print_offsets(robot: &Robot, t: f64, online: &mut OnlineEstimator) {
    print!("{t:6.1} s");
    for own in &online.answer().joints {
        let offset = own.offset_rad.scaled(1e3);
        let (name, mark) = (
            &robot.joint_names()[own.joint],
            if own.provisional.is_some() { "?" } else { "" },
        );
        let half_width = offset.half_width_95();
        print!("  {name} {:+.2} ± {half_width:.2}{mark}", offset.mean);
    }
    let provisional = match online.answer().is_provisional() {
        true => ", ? provisional",
        false => "",
    };
    println!(" mrad{provisional}");
    if let Some(reason) = online.error() {
        println!("         not solved: {reason}");
    }
}
