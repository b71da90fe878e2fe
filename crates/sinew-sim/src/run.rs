//! Simulation of a scenario to a recording and its truth file.

use super::error::SimulateError;
use super::faults::{FaultCounts, FaultyLine};
use super::scenario::Scenario;
use super::simulation::Simulation;
use super::truth::Truth;
use sinew_files::AtomicFile;
use sinew_log::{
    Axis, Compression, Format, Frame, FrameWriter, LogError, McapOptions, McapWriter, Quantities,
    RecordedNames, RowWriter,
};
use sinew_model::robot::Robot;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Output options of a simulation.
#[derive(Debug, Clone)]
pub struct SimulateOptions {
    /// Path of the recording.
    pub out: PathBuf,
    /// MCAP or CSV; `None`: by the name's ending.
    pub format: Option<Format>,
    /// Compression of an MCAP.
    pub compression: Compression,
    /// URDF to put into an MCAP as `/robot_description`.
    pub robot_description: Option<String>,
}

impl SimulateOptions {
    /// Creates options for a recording at `out`, with the format of its file extension, zstd, without description.
    pub fn new(out: impl Into<PathBuf>) -> Self {
        Self {
            out: out.into(),
            format: None,
            compression: Compression::default(),
            robot_description: None,
        }
    }
}

/// Progress of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated time, s.
    pub done_s: f64,
    /// Total time to simulate, s.
    pub total_s: f64,
    /// Number of frames written.
    pub frames: u64,
}

/// Files written by a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Path of the recording.
    pub out: PathBuf,
    /// Path of the truth file.
    pub truth_file: PathBuf,
    /// Content of the truth file.
    pub truth: Truth,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Numbers of written frames and of transmission errors.
    pub frames: FaultCounts,
    /// Size of the recording.
    pub bytes: u64,
    /// Time it took, s.
    pub wall_s: f64,
}

/// Returns the path of the truth file of a recording: `NAME.truth.json` in the folder of `NAME.mcap`.
pub fn truth_path(out: &Path) -> PathBuf {
    out.with_extension("truth.json")
}

/// Simulates `scenario` on `robot` and writes the recording and its truth file in the same folder.
///
/// Frames are written as they are computed: memory does not grow with the recording, except for the list of contacts
/// in the truth. The files appear only when both are complete. The same robot, scenario and format yield identical
/// bytes.
///
/// # Errors
/// Returns a [`SimulateError`] if simulation or writing fails; no incomplete file remains.
pub fn run(
    robot: &Robot,
    scenario: &Scenario,
    options: &SimulateOptions,
    progress: &mut dyn FnMut(Progress),
) -> Result<Summary, SimulateError> {
    let begun = Instant::now();
    let simulation = Simulation::new(robot, scenario)?;
    let total_s = simulation.duration_s();
    let mut writer = writer(robot, scenario, options)?;
    let (truth, counts) = record(simulation, scenario, &mut |f| writer.write(f), progress)?;
    let truth_file = truth_path(&options.out);
    let text = serde_json::to_string_pretty(&truth).map_err(|e| SimulateError::Truth {
        file: truth_file.display().to_string(),
        message: e.to_string(),
    })?;
    // The truth is written before the recording is renamed: a recording without its truth would
    // pass for a real one.
    let mut truth_output = AtomicFile::create(&truth_file)?;
    truth_output.append((text + "\n").as_bytes())?;
    truth_output.sync()?;
    // Concurrent runs with one output path: both files come from the same run. On a system without such locks the run
    // continues without one.
    let folder = File::open(sinew_files::folder_of(&options.out));
    let _pair = folder.and_then(|folder| folder.lock().map(|()| folder));
    writer.finish()?;
    truth_output.finish()?;
    let bytes = std::fs::metadata(&options.out).map_or(0, |m| m.len());
    Ok(Summary {
        out: options.out.clone(),
        truth_file,
        truth,
        duration_s: total_s,
        frames: counts,
        bytes,
        wall_s: begun.elapsed().as_secs_f64(),
    })
}

/// Runs a simulation of `scenario`, and passes every frame to `take` after the transmission errors are applied.
/// Returns the truth and the numbers of frames and errors.
///
/// # Errors
/// [`SimulateError`].
pub fn record(
    mut simulation: Simulation,
    scenario: &Scenario,
    take: &mut dyn FnMut(&Frame) -> Result<(), LogError>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Truth, FaultCounts), SimulateError> {
    let mut line = FaultyLine::new(&scenario.faults, scenario.seed, scenario.start_time_ns);
    // Ten times a simulated second is smooth for an eye and costs nothing.
    let every = (scenario.sample_rate_hz / 10.0).max(1.0) as u64;
    let total_s = simulation.duration_s();
    let mut frames = 0;
    while let Some(frame) = simulation.next_frame()? {
        line.pass(frame, take)?;
        frames += 1;
        if frames % every == 0 {
            progress(Progress {
                done_s: frames as f64 / scenario.sample_rate_hz,
                total_s,
                frames,
            });
        }
    }
    line.flush(take)?;
    Ok((Truth::of(&simulation, line.counts()), line.counts()))
}

/// Returns the quantities that frames of `scenario` contain.
pub fn recorded_quantities(scenario: &Scenario) -> Quantities {
    let record = scenario.record;
    Quantities {
        q: true,
        theta: true,
        dq: record.dq,
        tau_el: record.tau_el,
        tau_m: record.tau_m,
        tau_ext: record.tau_ext,
        temperature: record.temperature,
        tension: record.tension,
    }
}

fn writer(
    robot: &Robot,
    scenario: &Scenario,
    options: &SimulateOptions,
) -> Result<Box<dyn FrameWriter>, SimulateError> {
    let quantities = recorded_quantities(scenario);
    let ending = options.out.extension().and_then(|e| e.to_str());
    let format = options.format.or(match ending {
        Some("mcap") => Some(Format::Mcap),
        Some("csv") => Some(Format::Csv),
        Some("parquet") => Some(Format::Parquet),
        _ => None,
    });
    if robot.has_joint_equations() || quantities.tension {
        return axes_writer(robot, options, format, quantities);
    }
    let (joints, motors) = (robot.joint_names().to_vec(), robot.motor_names());
    let names = RecordedNames {
        joints: &joints,
        motors: &motors,
    };
    Ok(match format {
        Some(Format::Mcap) => Box::new(McapWriter::create(
            &options.out,
            &McapOptions {
                joints,
                motors,
                quantities,
                robot_description: options.robot_description.clone(),
                compression: options.compression,
                ..McapOptions::default()
            },
        )?),
        Some(Format::Csv) => Box::new(RowWriter::create(&options.out, names, quantities)?),
        Some(Format::Parquet) => {
            Box::new(RowWriter::create_parquet(&options.out, names, quantities)?)
        }
        _ => {
            return Err(SimulateError::Format {
                file: options.out.display().to_string(),
            });
        }
    })
}

/// Writer of motors beyond the joints and of tensions.
fn axes_writer(
    robot: &Robot,
    options: &SimulateOptions,
    format: Option<Format>,
    quantities: Quantities,
) -> Result<Box<dyn FrameWriter>, SimulateError> {
    let (tendons, motors) = (robot.tendon_names(), robot.motors_at_shaft());
    let axes = (0..robot.axes()).map(|i| Axis {
        joint: robot.joint_names().get(i).map(String::as_str),
        // A motor with several tendons has one column.
        motor: motors[i].filter(|motor| !motors[..i].contains(&Some(*motor))),
        tendon: robot.transmissions[i].as_ref().map(|_| tendons[i].as_str()),
    });
    let is_parquet = options.out.extension().is_some_and(|e| e == "parquet");
    match format {
        // The file extension selects between the two formats.
        Some(Format::Csv | Format::Parquet) if is_parquet == (format == Some(Format::Parquet)) => {
            let axes = Vec::from_iter(axes);
            Ok(Box::new(RowWriter::create_axes(
                &options.out,
                &axes,
                quantities,
            )?))
        }
        Some(Format::Mcap) => Err(SimulateError::Axes {
            file: options.out.display().to_string(),
        }),
        _ => Err(SimulateError::Format {
            file: options.out.display().to_string(),
        }),
    }
}
