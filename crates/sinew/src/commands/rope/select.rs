//! `sinew rope select`.

use super::Ropes;
use super::duty_args::DutyArgs;
use super::values::{millimetres, ratio};
use crate::files::check_outputs;
use crate::terminal::{Failure, Finish, answer};
use crate::text::{indented, paragraph, plain, table};
use clap::Args;
use sinew_figure::rounded;
use sinew_files::{JsonDocument, write_file};
use sinew_report::rope::{bracketed, caution, figure, reasons, selected, shared_cautions, spoken};
use sinew_rope::select::{self, Constraints, Selection};
use std::path::{Path, PathBuf};

/// Which ropes meet the constraints, ranked by elongation, and why the others don't
///
/// Elongation counts from a minute after tensioning to the last time of --at. A constraint on
/// something a rope's maker does not publish rejects it: it can't be shown to meet it. Exit code 3
/// when no rope is left.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  sinew rope select --tension 60 --length 700 --at 1year --max-diameter 1.8 \\\n      --pulley-diameter 16 --min-bend-ratio 8 --min-safety-factor 20 --plot choice.png"
)]
pub(crate) struct Select {
    #[command(flatten)]
    duty: DutyArgs,
    /// Largest diameter, mm
    #[arg(long, value_name = "MM", value_parser = millimetres, help_heading = "Constraints")]
    max_diameter: Option<f64>,
    /// Smallest diameter, mm
    #[arg(long, value_name = "MM", value_parser = millimetres, help_heading = "Constraints")]
    min_diameter: Option<f64>,
    /// Diameter of the smallest pulley, mm
    #[arg(long, value_name = "MM", value_parser = millimetres, help_heading = "Constraints")]
    pulley_diameter: Option<f64>,
    /// Smallest pulley diameter over rope diameter (D/d)
    #[arg(long, value_name = "RATIO", value_parser = ratio, requires = "pulley_diameter", help_heading = "Constraints")]
    min_bend_ratio: Option<f64>,
    /// Smallest breaking load over largest tension
    #[arg(long, value_name = "RATIO", value_parser = ratio, help_heading = "Constraints")]
    min_safety_factor: Option<f64>,
    /// Largest elongation, mm, held against the upper end of the interval
    #[arg(long, value_name = "MM", value_parser = millimetres, help_heading = "Constraints")]
    max_elongation: Option<f64>,
    /// Smallest stiffness of the strand, N/mm
    #[arg(long, value_name = "N/MM", value_parser = ratio, help_heading = "Constraints")]
    min_stiffness: Option<f64>,
    /// Largest weight, g/m
    #[arg(long, value_name = "G/M", value_parser = ratio, help_heading = "Constraints")]
    max_weight: Option<f64>,
    /// Pareto plot, .svg or .png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// HTML page
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
    /// Nothing on stderr
    #[arg(long)]
    quiet: bool,
}

impl Select {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let outputs: Vec<(&str, &Path)> = [("--plot", &self.plot), ("--report", &self.report)]
            .into_iter()
            .filter_map(|(option, path)| Some((option, path.as_deref()?)))
            .collect();
        check_outputs(&outputs, &[])?;
        let catalogue = self.ropes.catalogue()?;
        let request = self.duty.resolve(self.quiet)?.request;
        let constraints = Constraints {
            diameter_max_mm: self.max_diameter,
            diameter_min_mm: self.min_diameter,
            bend_ratio_min: self.min_bend_ratio,
            pulley_diameter_mm: self.pulley_diameter,
            safety_factor_min: self.min_safety_factor,
            elongation_max_mm: self.max_elongation,
            stiffness_min_n_per_mm: self.min_stiffness,
            weight_max_g_per_m: self.max_weight,
        };
        let found = select::select(&catalogue, &request, &constraints)?;
        if let Some(plot) = &self.plot {
            let figure = figure(&found, &spoken(found.time_s));
            let png = plot.extension().is_some_and(|e| e == "png");
            let bytes = if png {
                figure.png(2.0)?
            } else {
                figure.svg().into_bytes()
            };
            write_file(plot, &bytes)?;
        }
        if let Some(path) = &self.report {
            write_file(path, selected(&found, &constraints).html().as_bytes())?;
        }
        if self.json {
            answer(&found.to_json()?)?;
        } else {
            answer(&text(&found))?;
        }
        Ok(Finish::lossy(found.candidates.is_empty()))
    }
}

/// A long name on two lines, cut at a hyphen.
fn in_two(name: &str) -> String {
    /// What the numbers leave of 80 columns.
    const ROOM: usize = 26;
    let cut = name
        .char_indices()
        .filter(|(_, c)| *c == '-')
        .map(|(at, _)| at + 1)
        .rfind(|at| name[..*at].chars().count() <= ROOM);
    match cut {
        Some(at) if name.chars().count() > ROOM => format!("{}\n{}", &name[..at], &name[at..]),
        _ => name.to_owned(),
    }
}

fn text(s: &Selection) -> String {
    let mut out = paragraph(
        &plain(&format!(
            "{}; elongation from a minute after tensioning to {}",
            s.duty,
            spoken(s.time_s)
        )),
        2,
    );
    out.push('\n');
    let none = || "–".to_string();
    let head = [
        "rope",
        "elongation\nmm",
        "least",
        "N/mm",
        "d\nmm",
        "g/m",
        "load",
    ];
    let rows = s
        .candidates
        .iter()
        .map(|c| {
            let mark = if c.pareto { " *" } else { "" };
            vec![
                in_two(&(plain(&c.rope) + mark)),
                bracketed(c.elongation_m.scaled(1e3), 2).replace(" to ", "–"),
                format!("{:.0} %", 100.0 * c.least_share),
                rounded(1e-3 * c.stiffness_n_per_m.value, 2),
                c.diameter_m.map_or_else(none, |v| rounded(1e3 * v, 3)),
                c.weight_kg_per_m.map_or_else(none, |v| rounded(1e3 * v, 3)),
                c.safety_factor_ratio.map_or_else(none, |v| rounded(v, 2)),
            ]
        })
        .collect();
    if s.candidates.is_empty() {
        out.push_str("no rope meets every constraint\n");
    } else {
        out.push_str(&table(&head, rows, 1));
        out.push_str(&paragraph(
            "* no rope is both thinner and stretches less. least: share of the draws in \
             which it stretches least of these; N/mm: stiffness; load: breaking load over \
             largest tension.",
            2,
        ));
    }
    if !s.rejected.is_empty() {
        out.push_str("\nfell out\n");
        for r in &s.rejected {
            let text = format!("{}: {}", r.rope, reasons(r));
            out.push_str(&indented(&plain(&text), 2, 4));
        }
    }
    let warnings = shared_cautions(s);
    if !warnings.is_empty() {
        out.push('\n');
    }
    for (what, ropes) in warnings {
        let text = caution(what);
        let text = if ropes.len() == s.candidates.len() {
            format!("warning: {text}")
        } else {
            format!("warning: {}: {text}", ropes.join(", "))
        };
        out.push_str(&indented(&plain(&text), 2, 4));
    }
    out
}
