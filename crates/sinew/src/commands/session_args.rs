//! Options common to `sinew baseline` and `sinew estimate --baseline`.

use crate::args::number;
use crate::quantity::{Force, Mass, Temperature, Time, parse, with_std};
use crate::terminal::Failure;
use clap::Args;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{Payload, SessionError, SessionOptions, Touch, Window, stated};
use sinew_files::date::parse_utc_s;
use sinew_model::Gaussian;
use std::path::{Path, PathBuf};

/// Evaluated part of the recording.
#[derive(Debug, Clone, Args)]
pub(crate) struct Part {
    /// Start of the evaluated interval, s
    #[arg(
        long = "from",
        value_name = "TIME",
        default_value = "0s",
        allow_hyphen_values = true
    )]
    from: Time,
    /// End of the evaluated interval, s [default: end of the recording]
    #[arg(long = "to", value_name = "TIME", allow_hyphen_values = true)]
    to: Option<Time>,
    /// Time at which a joint passes an index mark of robot.toml, s (repeatable); stop contacts are
    /// detected automatically
    #[arg(long = "touch", value_name = "JOINT@TIME", value_parser = crate::args::touch)]
    pub(crate) touches: Vec<Touch>,
}

impl Part {
    /// Returns the evaluated interval.
    ///
    /// # Errors
    ///
    /// Returns [`Failure`] if the interval is empty or starts before the recording.
    pub(crate) fn window(&self) -> Result<Window, Failure> {
        let (from_s, to_s) = (self.from.0, self.to.map(|time| time.0));
        stated::window(from_s, to_s).map_err(|_| {
            Failure::Error(format!(
                "--from {from_s} s --to {} s: invalid interval; it must start at 0 s or later and end after its start",
                to_s.unwrap_or(f64::INFINITY)
            ))
        })
    }
}

/// Options of the session estimate.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Absolute estimate")]
pub(crate) struct SessionArgs {
    /// Gripper is empty [default: payload estimated]
    #[arg(long, conflicts_with = "payload")]
    empty: bool,
    /// Payload in the gripper, kg, ± standard deviation [default: 2 %]
    #[arg(long, alias = "payload-kg", value_name = "MASS[±MASS]", value_parser = specified_payload)]
    payload: Option<Payload>,
    /// Temperature during the recording if not recorded, °C, ± standard deviation [default: 2 °C]
    #[arg(long, alias = "temperature-c", value_name = "TEMPERATURE[±K]", value_parser = temperature, allow_hyphen_values = true)]
    temperature: Option<Gaussian>,
    /// Constant external force at the tool along x, y and z of the base, N, ± standard deviation per
    /// axis; 0±2 if unknown [default: estimated if detected]
    #[arg(long, alias = "external-force-n", value_name = "FORCE[,FORCE,FORCE]±FORCE", value_parser = external_force, allow_hyphen_values = true)]
    external_force: Option<ForceVector>,
    /// Ignore a recorded motor torque
    #[arg(long)]
    no_motor_torque: bool,
    /// Date of the recording for `sinew trend`, such as 2026-11-29 or 2026-11-29T08:30Z
    /// [default: clock of the recording]
    #[arg(long, value_name = "DATE", value_parser = date, conflicts_with = "each")]
    pub(crate) date: Option<f64>,
    /// Write the posterior as --baseline of the next session
    #[arg(long, value_name = "FILE")]
    pub(crate) save: Option<PathBuf>,
    /// List prior and posterior of all nuisance parameters
    #[arg(long)]
    pub(crate) nuisance: bool,
    #[command(flatten)]
    part: Part,
}

/// Force along the axes of the base, N; a separate type, because clap does not parse arrays.
#[derive(Debug, Clone, Copy)]
struct ForceVector([Gaussian; 3]);

/// Parses a force, `0±2` (all axes) or `1,0,-3±0.5`; a single mean must be zero.
fn external_force(text: &str) -> Result<ForceVector, String> {
    let error = || format!("'{text}' is not a force; expected e.g. 0±2N or 1N,0N,-3N±0.5N");
    let (mean, std) = text
        .split_once('±')
        .or_else(|| text.split_once("+-"))
        .ok_or_else(error)?;
    let number = |text: &str| parse(text).map(|Force(n)| n).map_err(|_| error());
    let means = mean
        .split(',')
        .map(number)
        .collect::<Result<Vec<f64>, _>>()?;
    let mean_n = match means[..] {
        [0.0] => [0.0; 3],
        [x, y, z] => [x, y, z],
        _ => return Err(error()),
    };
    let force = stated::external_force(mean_n, number(std)?);
    force.map(ForceVector).map_err(|e| e.to_string())
}

/// Parses a payload with optional standard deviation, kg.
fn specified_payload(text: &str) -> Result<Payload, String> {
    let (mass_kg, std_kg) = with_std::<Mass>(text, |std| Ok(parse::<Mass>(std)?.0))?;
    stated::payload(mass_kg, std_kg).map_err(|e| e.to_string())
}

/// Parses a temperature with optional standard deviation, °C.
pub(crate) fn temperature(text: &str) -> Result<Gaussian, String> {
    let kelvin = |std: &str| {
        let std = std.trim();
        let bare = ["K", "°C", "degC"]
            .iter()
            .find_map(|unit| std.strip_suffix(unit));
        number(bare.unwrap_or(std), "K")
    };
    let (c, std_k) = with_std::<Temperature>(text, kelvin)?;
    stated::temperature(c, std_k).map_err(|e| e.to_string())
}

/// Parses a date, s since 1970 UTC.
fn date(text: &str) -> Result<f64, String> {
    parse_utc_s(text).ok_or_else(|| {
        "expected a date between 2000 and 2200 such as 2026-11-29 or 2026-11-29T08:30Z".to_owned()
    })
}

impl SessionArgs {
    /// Checks that no option of the absolute estimate is specified for the uncorrected one.
    ///
    /// # Errors
    ///
    /// Returns [`Failure`] with the first such option.
    pub(crate) fn check_unused(&self, online: bool) -> Result<(), Failure> {
        let options = [
            ("--empty", self.empty),
            ("--payload", self.payload.is_some()),
            ("--temperature", self.temperature.is_some()),
            ("--external-force", self.external_force.is_some()),
            ("--no-motor-torque", self.no_motor_torque),
            ("--date", self.date.is_some()),
            ("--save", self.save.is_some()),
            ("--nuisance", self.nuisance),
            ("--from", self.part.from.0 != 0.0),
            ("--to", self.part.to.is_some()),
            ("--touch", !self.part.touches.is_empty()),
            ("--online", online),
        ];
        match options.into_iter().find(|(_, is_set)| *is_set) {
            None => Ok(()),
            Some((option, _)) => Err(Failure::Error(format!(
                "{option} conflicts with the uncorrected (paper) estimate; add --method absolute, or remove {option}"
            ))),
        }
    }

    /// Returns the evaluated interval.
    ///
    /// # Errors
    ///
    /// Returns [`Failure`] if the interval is empty or starts before the recording.
    pub(crate) fn window(&self) -> Result<Window, Failure> {
        self.part.window()
    }

    /// Index marks with their times.
    pub(crate) fn touches(&self) -> &[Touch] {
        &self.part.touches
    }

    /// Returns the options of the session estimate.
    pub(crate) fn options(&self) -> SessionOptions {
        SessionOptions {
            payload: match (self.empty, self.payload) {
                (true, _) => Payload::Empty,
                (false, Some(payload)) => payload,
                (false, None) => Payload::Unknown,
            },
            motor_torque: !self.no_motor_torque,
            temperature_c: self.temperature,
            external_force_n: self.external_force.map(|force| force.0),
            ..SessionOptions::default()
        }
    }
}

/// Reads the baseline, if one is specified, and returns it with the name of its file.
pub(crate) fn read_baseline(
    path: Option<&Path>,
) -> Result<Option<(Baseline, String)>, SessionError> {
    let read = |path: &Path| Ok((Baseline::read(path)?, path.display().to_string()));
    path.map(read).transpose()
}
