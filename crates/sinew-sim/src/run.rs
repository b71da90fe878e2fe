//! From a scenario to a recording and its truth.

use super::error::SimulateError;
use super::faults::{FaultCounts, FaultyLine};
use super::scenario::Scenario;
use super::simulation::Simulation;
use super::truth::Truth;
use sinew_files::AtomicFile;
use sinew_log::{
    Compression, Format, Frame, FrameWriter, LogError, McapOptions, McapWriter, Quantities,
    RecordedNames, RowWriter,
};
use sinew_model::robot::Robot;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Where a recording goes.
#[derive(Debug, Clone)]
pub struct SimulateOptions {
    /// The recording.
    pub out: PathBuf,
    /// MCAP or CSV; `None`: by the name's ending.
    pub format: Option<Format>,
    /// Compression of an MCAP.
    pub compression: Compression,
    /// URDF to put into an MCAP as `/robot_description`.
    pub robot_description: Option<String>,
}

impl SimulateOptions {
    /// A recording at `out`, format by its ending, zstd, without description.
    pub fn new(out: impl Into<PathBuf>) -> Self {
        Self {
            out: out.into(),
            format: None,
            compression: Compression::default(),
            robot_description: None,
        }
    }
}

/// How far a simulation is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Simulated, s.
    pub done_s: f64,
    /// Of so many, s.
    pub total_s: f64,
    /// Frames written.
    pub frames: u64,
}

/// What was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// The recording.
    pub out: PathBuf,
    /// Its truth.
    pub truth_file: PathBuf,
    /// What the truth file says.
    pub truth: Truth,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Frames written and gone wrong.
    pub frames: FaultCounts,
    /// Size of the recording.
    pub bytes: u64,
    /// Time it took, s.
    pub wall_s: f64,
}

/// Where the truth of a recording goes: `NAME.truth.json` beside `NAME.mcap`.
pub fn truth_path(out: &Path) -> PathBuf {
    out.with_extension("truth.json")
}

/// Simulates `scenario` on `robot` and writes the recording and, beside it, its truth.
///
/// Frames are written as they come: memory doesn't grow with the recording, but for the list of
/// contacts in the truth. Neither file is there unless both are complete. Same robot, scenario
/// and format: the same bytes.
///
/// # Errors
/// [`SimulateError`]; no half-written file is left.
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
    // Its bytes are there before the recording gets its name: a recording without its truth would
    // pass for a real one.
    let mut beside = AtomicFile::create(&truth_file)?;
    beside.append((text + "\n").as_bytes())?;
    beside.sync()?;
    // Two runs of one output: both names go to the same run. A system without such locks goes on.
    let folder = File::open(sinew_files::folder_of(&options.out));
    let _pair = folder.and_then(|folder| folder.lock().map(|()| folder));
    writer.finish()?;
    beside.finish()?;
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

/// Runs a simulation of `scenario` to its end: every frame goes through the faults of the line to `take`.
/// Returns the truth, and what became of the frames.
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

/// Which quantities frames of `scenario` hold.
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
    }
}

fn writer(
    robot: &Robot,
    scenario: &Scenario,
    options: &SimulateOptions,
) -> Result<Box<dyn FrameWriter>, SimulateError> {
    let quantities = recorded_quantities(scenario);
    let (joints, motors) = (robot.joint_names().to_vec(), robot.motor_names());
    let names = RecordedNames {
        joints: &joints,
        motors: &motors,
    };
    let ending = options.out.extension().and_then(|e| e.to_str());
    let format = options.format.or(match ending {
        Some("mcap") => Some(Format::Mcap),
        Some("csv") => Some(Format::Csv),
        Some("parquet") => Some(Format::Parquet),
        _ => None,
    });
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
