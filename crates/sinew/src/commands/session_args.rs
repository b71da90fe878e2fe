//! Options that `sinew baseline` and `sinew estimate --baseline` share.

use crate::terminal::Failure;
use clap::Args;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{Payload, SessionError, SessionOptions, Window};
use sinew_model::Gaussian;
use std::path::{Path, PathBuf};

/// Which part of the recording.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct Part {
    /// With a baseline: use the recording from here on, s
    #[arg(long = "from", value_name = "S", default_value_t = 0.0)]
    from_s: f64,
    /// With a baseline: use the recording up to here, s
    #[arg(long = "to", value_name = "S")]
    to_s: Option<f64>,
}

impl Part {
    /// The window, if it has a length.
    pub(crate) fn window(self) -> Result<Window, Failure> {
        let window = Window {
            from_s: self.from_s,
            to_s: self.to_s.unwrap_or(f64::INFINITY),
        };
        if window.from_s >= 0.0 && window.from_s < window.to_s {
            return Ok(window);
        }
        Err(Failure::Refused(format!(
            "--from {} s --to {} s: the part must start at 0 s or later and end after its start",
            window.from_s, window.to_s
        )))
    }
}

/// Options of the session estimate.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Absolute estimate")]
pub(crate) struct SessionArgs {
    /// The gripper holds nothing (otherwise a payload is estimated along)
    #[arg(long, conflicts_with = "payload_kg", requires = "since")]
    empty: bool,
    /// The gripper holds this, kg, known to 2 % or as stated
    #[arg(long, value_name = "KG[±KG]", value_parser = known_payload, requires = "since")]
    payload_kg: Option<Payload>,
    /// Leave a recorded motor torque out
    #[arg(long, requires = "since")]
    no_motor_torque: bool,
    /// Write what is known after this recording: the --baseline of the next one
    #[arg(long, value_name = "FILE", requires = "since")]
    pub(crate) save: Option<PathBuf>,
    /// List everything estimated along, believed before and after
    #[arg(long, requires = "since")]
    pub(crate) nuisance: bool,
    #[command(flatten)]
    part: Part,
}

/// `0.5`, `0.5±0.02` or `0.5+-0.02`.
fn known_payload(text: &str) -> Result<Payload, String> {
    let (mass, deviation) = match text.split_once('±').or_else(|| text.split_once("+-")) {
        Some((mass, deviation)) => (mass, Some(deviation)),
        None => (text, None),
    };
    let number = |what: &str, text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|v| v.is_finite() && *v >= 0.0)
            .ok_or_else(|| {
                format!("{what} '{text}' is no mass in kg of at least 0, as in 0.5±0.02")
            })
    };
    let mass_kg = number("the payload", mass)?;
    let deviation_kg = match deviation {
        Some(text) => number("its deviation", text)?,
        None => 0.02 * mass_kg,
    };
    Ok(Payload::Known {
        mass_kg: Gaussian::new(mass_kg, deviation_kg),
    })
}

impl SessionArgs {
    /// All of it is for the absolute estimate alone; nothing asked for is ignored.
    pub(crate) fn refuse_all(&self) -> Result<(), Failure> {
        let asked = [
            ("--empty", self.empty),
            ("--payload-kg", self.payload_kg.is_some()),
            ("--no-motor-torque", self.no_motor_torque),
            ("--save", self.save.is_some()),
            ("--nuisance", self.nuisance),
            ("--from", self.part.from_s != 0.0),
            ("--to", self.part.to_s.is_some()),
        ];
        match asked.into_iter().find(|(_, asked)| *asked) {
            None => Ok(()),
            Some((option, _)) => Err(Failure::Refused(format!(
                "{option} is for the absolute estimate, and the paper's knows nothing of it: give --baseline FILE or --method absolute, or leave {option} out"
            ))),
        }
    }

    /// The window, if it has a length.
    pub(crate) fn window(&self) -> Result<Window, Failure> {
        self.part.window()
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
