//! `sinew rope select`.

use super::Ropes;
use super::duty_args::DutyArgs;
use crate::args::positive;
use crate::files::{check_outputs, write_text};
use crate::quantity::{Length, above_zero};
use crate::terminal::{Bar, Failure, Finish, answer_as};
use clap::Args;
use sinew_report::rope::{figure, selected, selection_table, spoken};
use sinew_rope::select::{self, Constraints};
use std::path::PathBuf;

/// Select ropes that meet constraints, ranked by change of length, with reasons for rejected ropes
///
/// Elongation is from 1 min after pretensioning to the last time of --at. Ropes are ranked by its
/// magnitude that 95 % of the draws do not exceed. A rope is rejected if it violates a constraint in
/// more than 97.5 % of the draws, breaks in more than half of them, or if the manufacturer does not
/// publish a constrained property. Exit code 3: no rope left.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  sinew rope select --tension 60 --length 700 --at 1year --max-diameter 1.8 \\\n      --pulley-diameter 16 --min-bend-ratio 8 --min-safety-factor 20 --plot choice.png"
)]
pub(crate) struct Select {
    #[command(flatten)]
    duty: DutyArgs,
    /// Maximum diameter, mm
    #[arg(long, value_name = "LENGTH", value_parser = above_zero::<Length>, help_heading = "Constraints")]
    max_diameter: Option<Length>,
    /// Minimum diameter, mm
    #[arg(long, value_name = "LENGTH", value_parser = above_zero::<Length>, help_heading = "Constraints")]
    min_diameter: Option<Length>,
    /// Diameter of the smallest pulley, mm
    #[arg(long, value_name = "LENGTH", value_parser = above_zero::<Length>, help_heading = "Constraints")]
    pulley_diameter: Option<Length>,
    /// Minimum bending ratio D/d, pulley over rope diameter
    #[arg(long, value_name = "RATIO", value_parser = positive("(a ratio)"), requires = "pulley_diameter", help_heading = "Constraints")]
    min_bend_ratio: Option<f64>,
    /// Minimum safety factor, breaking load over largest tension
    #[arg(long, value_name = "RATIO", value_parser = positive("(a ratio)"), help_heading = "Constraints")]
    min_safety_factor: Option<f64>,
    /// Maximum elongation or shortening, mm
    #[arg(long, value_name = "LENGTH", value_parser = above_zero::<Length>, help_heading = "Constraints")]
    max_elongation: Option<Length>,
    /// Minimum stiffness of the strand, N/mm
    #[arg(long, value_name = "N/MM", value_parser = positive("N/mm"), help_heading = "Constraints")]
    min_stiffness: Option<f64>,
    /// Maximum weight, g/m
    #[arg(long, value_name = "G/M", value_parser = positive("g/m"), help_heading = "Constraints")]
    max_weight: Option<f64>,
    /// Write a Pareto plot; .svg or .png
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Write an HTML report
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
}

impl Select {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let outputs = [
            ("--plot", self.plot.as_deref()),
            ("--report", self.report.as_deref()),
        ];
        check_outputs(&outputs, &[])?;
        let catalogue = self.ropes.catalogue()?;
        let request = self.duty.resolve()?.request;
        // In decimals, so that a limit includes an equal value of the catalogue.
        let mm = |length: Length| (1e12 * length.0).round() / 1e9;
        let constraints = Constraints {
            diameter_max_mm: self.max_diameter.map(mm),
            diameter_min_mm: self.min_diameter.map(mm),
            bend_ratio_min: self.min_bend_ratio,
            pulley_diameter_mm: self.pulley_diameter.map(mm),
            safety_factor_min: self.min_safety_factor,
            elongation_max_mm: self.max_elongation.map(mm),
            stiffness_min_n_per_mm: self.min_stiffness,
            weight_max_g_per_m: self.max_weight,
        };
        let bar = Bar::new("draws");
        let found = select::select_with_progress(&catalogue, &request, &constraints, &|done| {
            bar.set(done, 1.0);
        })?;
        drop(bar);
        if let Some(plot) = &self.plot {
            figure(&found, &spoken(found.time_s)).write(plot)?;
        }
        let page = || selected(&found, &constraints).html();
        write_text(self.report.as_deref(), page)?;
        answer_as(self.json, &found, selection_table)?;
        Ok(Finish::lossy(found.candidates.is_empty()))
    }
}
