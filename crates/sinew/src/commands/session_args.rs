//! Options that `sinew baseline` and `sinew estimate --baseline` share.

use crate::terminal::Failure;
use clap::Args;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{Payload, SessionError, SessionOptions, Touch, Window, stated};
use sinew_model::Gaussian;
use std::path::{Path, PathBuf};

/// Which part of the recording.
#[derive(Debug, Clone, Args)]
pub(crate) struct Part {
    /// Use the recording from here on, s
    #[arg(long = "from", value_name = "S", default_value_t = 0.0)]
    from_s: f64,
    /// Use the recording up to here, s
    #[arg(long = "to", value_name = "S")]
    to_s: Option<f64>,
    /// A mark of robot.toml's anchors is passed then, s (repeatable); end stops are found by themselves
    #[arg(long = "touch", value_name = "JOINT@S", value_parser = crate::args::touch)]
    pub(crate) touches: Vec<Touch>,
}

impl Part {
    /// The window, if it has a length.
    pub(crate) fn window(&self) -> Result<Window, Failure> {
        stated::window(self.from_s, self.to_s).map_err(|_| {
            Failure::Refused(format!(
                "--from {} s --to {} s: the part must start at 0 s or later and end after its start",
                self.from_s,
                self.to_s.unwrap_or(f64::INFINITY)
            ))
        })
    }
}

/// Options of the session estimate.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Absolute estimate")]
pub(crate) struct SessionArgs {
    /// The gripper holds nothing (otherwise a payload is estimated along)
    #[arg(long, conflicts_with = "payload_kg")]
    empty: bool,
    /// The gripper holds this, kg, known to 2 % or as stated
    #[arg(long, value_name = "KG[±KG]", value_parser = known_payload)]
    payload_kg: Option<Payload>,
    /// Temperature during the recording, where it isn't recorded; ± one standard deviation, 2 °C if
    /// not stated
    #[arg(long, value_name = "C[±C]", value_parser = temperature, allow_negative_numbers = true)]
    temperature_c: Option<Gaussian>,
    /// A constant force from outside at the tool, along x, y and z of the base; ± one standard deviation of each.
    /// 0±2: there may be one. Otherwise one is estimated where the recording shows it
    #[arg(long, value_name = "N[,N,N]±N", value_parser = external_force, allow_hyphen_values = true)]
    external_force_n: Option<Force>,
    /// Leave a recorded motor torque out
    #[arg(long)]
    no_motor_torque: bool,
    /// Write what is known after this recording: the --baseline of the next one
    #[arg(long, value_name = "FILE")]
    pub(crate) save: Option<PathBuf>,
    /// List everything estimated along, believed before and after
    #[arg(long)]
    pub(crate) nuisance: bool,
    #[command(flatten)]
    part: Part,
}

/// `0.5`, `0.5±0.02` or `0.5+-0.02`: mean and deviation, if one is given.
fn with_deviation(text: &str) -> Result<(f64, Option<f64>), String> {
    let number = |text: &str| {
        let read = text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        read.ok_or_else(|| format!("'{text}' is no number, as in 0.5±0.02"))
    };
    match text.split_once('±').or_else(|| text.split_once("+-")) {
        Some((mean, deviation)) => Ok((number(mean)?, Some(number(deviation)?))),
        None => Ok((number(text)?, None)),
    }
}

/// A force along the axes of the base, N. A type of its own: an argument's value is not an array's.
#[derive(Debug, Clone, Copy)]
struct Force([Gaussian; 3]);

/// `0±2`, or `1,0,-3±0.5`: along all three axes alike only where that is nothing.
fn external_force(text: &str) -> Result<Force, String> {
    let refuse = || format!("'{text}' is no force, as in 0±2 or 1,0,-3±0.5 (N)");
    let (mean, deviation) = text
        .split_once('±')
        .or_else(|| text.split_once("+-"))
        .ok_or_else(refuse)?;
    let number = |text: &str| {
        let read = text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        read.ok_or_else(refuse)
    };
    let means = mean
        .split(',')
        .map(number)
        .collect::<Result<Vec<f64>, _>>()?;
    let mean_n = match means[..] {
        [0.0] => [0.0; 3],
        [x, y, z] => [x, y, z],
        _ => return Err(refuse()),
    };
    let force = stated::external_force(mean_n, number(deviation)?);
    force.map(Force).map_err(|e| e.to_string())
}

fn known_payload(text: &str) -> Result<Payload, String> {
    let (mass_kg, deviation_kg) = with_deviation(text)?;
    stated::payload(mass_kg, deviation_kg).map_err(|e| e.to_string())
}

/// A temperature as a room thermometer tells it.
pub(crate) fn temperature(text: &str) -> Result<Gaussian, String> {
    let (c, deviation_k) = with_deviation(text)?;
    stated::temperature(c, deviation_k).map_err(|e| e.to_string())
}

impl SessionArgs {
    /// All of it is for the absolute estimate alone; nothing asked for is ignored.
    pub(crate) fn refuse_all(&self, live: bool) -> Result<(), Failure> {
        let asked = [
            ("--empty", self.empty),
            ("--payload-kg", self.payload_kg.is_some()),
            ("--temperature-c", self.temperature_c.is_some()),
            ("--external-force-n", self.external_force_n.is_some()),
            ("--no-motor-torque", self.no_motor_torque),
            ("--save", self.save.is_some()),
            ("--nuisance", self.nuisance),
            ("--from", self.part.from_s != 0.0),
            ("--to", self.part.to_s.is_some()),
            ("--touch", !self.part.touches.is_empty()),
            ("--live", live),
        ];
        match asked.into_iter().find(|(_, asked)| *asked) {
            None => Ok(()),
            Some((option, _)) => Err(Failure::Refused(format!(
                "{option} is for the absolute estimate, and the paper's knows nothing of it: add --method absolute, or leave {option} out"
            ))),
        }
    }

    /// The window, if it has a length.
    pub(crate) fn window(&self) -> Result<Window, Failure> {
        self.part.window()
    }

    /// Marks that are passed.
    pub(crate) fn touches(&self) -> &[Touch] {
        &self.part.touches
    }

    /// What is known of the session besides its recording.
    pub(crate) fn options(&self) -> SessionOptions {
        SessionOptions {
            payload: match (self.empty, self.payload_kg) {
                (true, _) => Payload::Empty,
                (false, Some(known)) => known,
                (false, None) => Payload::Unknown,
            },
            motor_torque: !self.no_motor_torque,
            temperature_c: self.temperature_c,
            external_force_n: self.external_force_n.map(|force| force.0),
            ..SessionOptions::default()
        }
    }
}

/// A baseline with its file's name, where one was given.
pub(crate) fn read_baseline(
    path: Option<&Path>,
) -> Result<Option<(Baseline, String)>, SessionError> {
    let read = |path: &Path| Ok((Baseline::read(path)?, path.display().to_string()));
    path.map(read).transpose()
}
