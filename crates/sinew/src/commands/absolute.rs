//! What `sinew baseline` and `sinew estimate --baseline` share: options and the answer as text.

use crate::terminal::Failure;
use crate::text::{paragraph, plain, table};
use clap::Args;
use sinew_estimate::absolute;
use sinew_estimate::absolute::{Absolute, AbsoluteError, Baseline, Payload, WatchOptions, Window};
use sinew_estimate::estimate::{Estimate, EstimateError, Progress, Request};
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

/// Options of the absolute estimate.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Absolute estimate")]
pub(crate) struct Watching {
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

impl Watching {
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

    /// Watches a recording beside the paper's estimate, and saves what it taught where asked to.
    pub(crate) fn watch(
        &self,
        request: &Request,
        baseline: Option<&Path>,
        explain: impl Fn(EstimateError) -> Failure,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(Estimate, Absolute), Failure> {
        let refused = |error: AbsoluteError| match error {
            AbsoluteError::Estimate(error) => explain(error),
            other => Failure::Refused(other.to_string()),
        };
        let window = self.part.window()?;
        let options = WatchOptions {
            payload: match (self.empty, self.payload_kg) {
                (true, _) => Payload::Empty,
                (false, Some(known)) => known,
                (false, None) => Payload::Unknown,
            },
            motor_torque: !self.no_motor_torque,
            ..WatchOptions::default()
        };
        let read = baseline
            .map(|path| Ok((Baseline::read(path)?, path.display().to_string())))
            .transpose()
            .map_err(&refused)?;
        let since = read.as_ref().map(|(b, name)| (b, name.as_str()));
        let (paper, watched, next) =
            absolute::watch_beside_paper(request, window, since, &options, progress)
                .map_err(&refused)?;
        if let Some(path) = &self.save {
            next.write(path)?;
        }
        Ok((paper, watched))
    }
}

/// An absolute estimate as text of at most 80 columns.
pub(crate) fn told(said: &Absolute, nuisance: bool) -> String {
    let since = if said.baseline.is_some() {
        "since the baseline"
    } else {
        "against the encoders' zero, without a baseline"
    };
    let mut text = format!("\nAbsolute, all joints together, {since}:\n");
    let head = [
        "joint",
        "offset\nmrad",
        "± (95 %)\nmrad",
        "stretch\nmm",
        "± (95 %)\nmm",
        "verdict",
    ];
    let optional = |v: Option<f64>| v.map_or("–".to_string(), |v| sinew_figure::rounded(v, 2));
    let rows = said
        .joints
        .iter()
        .map(|j| {
            vec![
                plain(&j.name),
                sinew_figure::rounded(j.offset_mrad, 3),
                sinew_figure::rounded(j.interval_95_mrad, 2),
                optional(j.elongation_mm),
                optional(j.interval_95_mm),
                j.verdict.clone(),
            ]
        })
        .collect();
    text.push_str(&table(&head, rows, 1));
    text.push('\n');
    for line in said.sentences() {
        text.push_str(&paragraph(&plain(&line), 2));
    }
    if nuisance {
        text.push('\n');
        text.push_str(&nuisance_table(said));
    }
    text
}

/// Everything estimated along.
fn nuisance_table(said: &Absolute) -> String {
    let shown = |[mean, deviation]: [f64; 2]| {
        format!(
            "{} ± {}",
            sinew_figure::rounded(mean, 2),
            sinew_figure::rounded(deviation, 2)
        )
    };
    let rows = said
        .nuisance
        .iter()
        .map(|m| {
            vec![
                plain(&m.joint),
                format!("{} {}", m.name, m.unit).trim_end().to_string(),
                shown(m.prior),
                shown(m.posterior),
                if m.moved { "yes" } else { "no" }.into(),
            ]
        })
        .collect();
    table(
        &[
            "joint",
            "parameter",
            "before\n± 1 sd",
            "after\n± 1 sd",
            "moved",
        ],
        rows,
        2,
    )
}
