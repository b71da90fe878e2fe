//! `sinew rope predict`.

use super::duty_args::DutyArgs;
use super::values::newtons;
use super::{Ropes, find};
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::Args;
use sinew_figure::rounded;
use sinew_files::{JsonDocument, write_file};
use sinew_report::rope::{bracketed, caution, predicted, spoken};
use sinew_rope::predict::{self, Prediction};
use std::path::PathBuf;

/// How far a rope stretches under a duty: after an hour, a day, a month, a year
///
/// "since tensioned" counts from a minute after the first loading: what is left to re-tension.
/// "from slack" counts from the new, slack rope. Brackets are 95 % intervals from draws of the
/// rope's parameters within their stated uncertainty.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  sinew rope predict liros-dc000-0301 --tension 60 --length 700\n  \
    sinew rope predict --robot robots/biorob-like --joint elbow --stroke 80\n  \
    sinew rope predict --recording monday.mcap --robot robots/biorob-like --joint elbow"
)]
pub(crate) struct Predict {
    /// Rope [default: the one of the joint's tendon]
    name: Option<String>,
    #[command(flatten)]
    duty: DutyArgs,
    /// Tension the readings refer to, N [default: mean of the duty]
    #[arg(long, value_name = "N", value_parser = newtons)]
    read_at: Option<f64>,
    #[command(flatten)]
    ropes: Ropes,
    /// HTML page
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
    /// Nothing on stderr
    #[arg(long)]
    quiet: bool,
}

impl Predict {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        if let Some(path) = &self.report {
            check_outputs(&[("--report", path)], &[])?;
        }
        let catalogue = self.ropes.catalogue()?;
        let mut resolved = self.duty.resolve(self.quiet)?;
        let Some(name) = self.name.as_ref().or(resolved.rope.as_ref()) else {
            return Err(Failure::Refused(
                "which rope? name it; sinew rope list shows all".into(),
            ));
        };
        let rope = find(&catalogue, name)?;
        resolved.request.read_at = DutyArgs::read_at(self.read_at, self.duty.temperature());
        let draws = resolved.request.draws as f64;
        let bar = Bar::new("draws", self.quiet);
        let found = predict::predict_with_progress(rope, &resolved.request, &|done| {
            bar.set(done as f64, draws);
        })?;
        drop(bar);
        if let Some(path) = &self.report {
            write_file(path, predicted(&found).html().as_bytes())?;
        }
        if self.json {
            answer(&found.to_json()?)?;
        } else {
            answer(&text(&found))?;
        }
        Ok(Finish::Complete)
    }
}

fn text(p: &Prediction) -> String {
    let mut out = paragraph(&plain(&format!("{}: {}", p.rope, p.duty)), 2);
    let s = &p.summary;
    if s.tension_min_n != s.tension_max_n || s.temperature_min_c != s.temperature_max_c {
        let text = format!(
            "one cycle of {}: {} to {} N, mean {} N; {} to {} °C",
            spoken(s.duration_s),
            rounded(s.tension_min_n, 3),
            rounded(s.tension_max_n, 3),
            rounded(s.tension_mean_n, 3),
            rounded(s.temperature_min_c, 3),
            rounded(s.temperature_max_c, 3)
        );
        out.push_str(&paragraph(&text, 2));
    }
    let text = format!(
        "strand of {} mm, read at {} N and {} °C\n",
        rounded(1e3 * p.length_m, 4),
        rounded(p.read_at_n, 3),
        rounded(p.read_at_c, 3)
    );
    out.push_str(&paragraph(&text, 2));
    out.push('\n');
    let head = [
        "after",
        "since tensioned\nmm",
        "from slack\nmm",
        "from slack\n%",
        "stays, mm",
    ];
    let rows = p
        .readings
        .iter()
        .map(|r| {
            vec![
                spoken(r.time_s),
                bracketed(r.since_tensioned_m.scaled(1e3), 2),
                bracketed(r.elongation_m.scaled(1e3), 2),
                rounded(100.0 * r.strain_ratio.value, 2),
                rounded(1e3 * r.irreversible_m.value, 2),
            ]
        })
        .collect();
    out.push_str(&table(&head, rows, 1));
    if let Some(left) = p.strength_left_share {
        let text = format!(
            "strength left after bending: {} % of new ({} to {} %)",
            rounded(100.0 * left.value, 2),
            rounded(100.0 * left.low, 2),
            rounded(100.0 * left.high, 2)
        );
        out.push_str(&paragraph(&text, 2));
    }
    if p.broken_share > 0.0 {
        let text = format!(
            "the rope breaks in {} % of the draws, which are left out above",
            rounded(100.0 * p.broken_share, 2)
        );
        out.push_str(&paragraph(&text, 2));
    }
    out.push('\n');
    let text = format!(
        "95 % intervals from {} draws (seed {}); {} of {} parameters are starting guesses",
        p.draws, p.seed, p.starting_guesses, p.parameters
    );
    out.push_str(&paragraph(&text, 2));
    for what in &p.cautions {
        out.push_str(&paragraph(&format!("warning: {}", caution(*what)), 2));
    }
    out
}
