//! `sinew creep fit`.

use super::super::rope::{Ropes, find};
use super::files::TestFiles;
use super::write_rope::{rope_name, write_rope};
use crate::args::{Choice, choice, positive};
use crate::files::write_table;
use crate::terminal::{Bar, Failure, Finish};
use clap::Args;
use sinew_creep::{
    FitOptions, FitRequest, FitStep, ForecastRequest, IntervalKind, Joint, Law, NoiseKind,
    RopeBase, Tests,
};
use sinew_report::creep;
use std::path::PathBuf;
use std::sync::Arc;

/// Fit laws of creep, say which one the record supports and what it can't tell
///
/// Laws: log-time, findley, burgers, kelvin-voigt, stretched; rope with --rope. Loads,
/// temperatures and unloading are fitted together with --joint.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew creep fit rope.csv --gauge-length-mm 350 --forecast-h 8760\n  \
    sinew creep fit tests.csv --joint group --group rope\n  \
    sinew creep fit rope.csv --rope liros-dc000-0301 --law rope --write-rope ropes/mine.toml\n  \
    sinew creep fit tests.csv --withhold 0.33")]
pub(crate) struct Fit {
    #[command(flatten)]
    files: TestFiles,
    /// Law to fit (may be repeated) [default: all]
    #[arg(long, value_name = "LAW")]
    law: Vec<Law>,
    /// What is fitted together
    #[arg(long, value_parser = choice(&JOINTS), default_value = "none")]
    joint: Joint,
    /// What is assumed of the readings' errors
    #[arg(long, value_parser = choice(&NOISES), default_value = "correlated")]
    noise: NoiseKind,
    /// How intervals of parameters are made
    #[arg(long, value_parser = choice(&INTERVALS), default_value = "draws")]
    intervals: IntervalKind,
    /// Catalogue rope that the rope law starts from: its breaking load, and what records can't tell
    #[arg(long, value_name = "NAME", help_heading = "Rope law")]
    rope: Option<String>,
    #[command(flatten)]
    ropes: Ropes,
    /// Write the fitted rope as a catalogue entry; its name is that of the file
    #[arg(
        long,
        value_name = "FILE.toml",
        requires = "rope",
        conflicts_with_all = ["withhold", "shift_c"],
        help_heading = "Rope law"
    )]
    write_rope: Option<PathBuf>,
    /// Forecast to this time after the load, h
    #[arg(long, value_name = "H", value_parser = positive("h"))]
    forecast_h: Option<f64>,
    /// Load of the forecast, N, on a new specimen [default: the one held longest, as if it had stayed]
    #[arg(long, value_name = "N", requires = "forecast_h", value_parser = positive("N"))]
    forecast_load_n: Option<f64>,
    /// Temperature of the forecast, °C, of a new specimen [default: the test's own]
    #[arg(
        long,
        value_name = "C",
        requires = "forecast_h",
        allow_negative_numbers = true
    )]
    forecast_temperature_c: Option<f64>,
    /// Hide this last share of every test and count how often the forecast's interval holds it
    #[arg(long, value_name = "SHARE", conflicts_with_all = ["forecast_h", "shift_c"])]
    withhold: Option<f64>,
    /// Shift factors of isotherms (strain or modulus) to this temperature, °C, instead of laws
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    shift_c: Option<f64>,
}

const JOINTS: [Choice<Joint>; 3] = [
    ("none", "Every specimen alone", Joint::None),
    (
        "shape",
        "Specimens of a group share the law's shape, not its amplitude",
        Joint::Shape,
    ),
    (
        "group",
        "Specimens of a group share all but their strain zero",
        Joint::Group,
    ),
];

const NOISES: [Choice<NoiseKind>; 2] = [
    (
        "correlated",
        "Independent plus slow errors, both fitted",
        NoiseKind::Correlated,
    ),
    ("white", "Independent errors", NoiseKind::White),
];

const INTERVALS: [Choice<IntervalKind>; 3] = [
    (
        "draws",
        "Quantiles of draws from what the readings leave open",
        IntervalKind::Draws,
    ),
    ("profile", "Profile likelihood", IntervalKind::Profile),
    (
        "bootstrap",
        "Parametric bootstrap with correlated errors",
        IntervalKind::Bootstrap,
    ),
];

impl Fit {
    /// Runs the command.
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        if let Some(reference_c) = self.shift_c {
            return self.shift(reference_c);
        }
        let tests = self.files.tests()?;
        let request = self.request()?;
        if let Some(share) = self.withhold {
            return self.withhold(share, &tests, &request);
        }
        let bar = Bar::new("fitting", self.files.quiet);
        let report = sinew_creep::fit_tests(&tests, &request, |step, done, of| {
            if step == FitStep::Forecasting {
                bar.say("forecasting");
            }
            bar.set(done as f64, of as f64);
        });
        drop(bar);
        if let (Some(path), Some(base)) = (&self.write_rope, &request.options.rope) {
            let today = sinew_files::date::today();
            let entry = rope_name(path)
                .and_then(|name| {
                    let entry = report.rope_entry(request.joint, base, name, today);
                    entry.map_err(|e| e.to_string())
                })
                .map_err(|why| Failure::Refused(format!("--write-rope: {why}")))?;
            write_rope(path, &entry.to_toml())?;
        }
        let series = || creep::fit_series(&report, &tests);
        write_table(self.files.series.as_deref(), series)?;
        let page = || creep::fit_page(&report, &tests, request.joint, &self.files.conditions());
        let table = |report: &_| {
            let mut out = creep::fit_table(report);
            if !self.files.group.is_empty() && self.joint == Joint::None {
                let laws = request.laws();
                out += &creep::group_table(&tests.analyses, &report.fits, &laws);
            }
            out
        };
        self.files
            .answer(&report, creep::fit_csv, Some(&page), table)?;
        Ok(Finish::lossy(!report.failures.is_empty()))
    }

    fn request(&self) -> Result<FitRequest, Failure> {
        Ok(FitRequest {
            laws: self.law.clone(),
            joint: self.joint,
            options: FitOptions {
                noise: self.noise,
                level: self.files.level,
                kind: self.intervals,
                seed: self.files.seed,
                rope: self.base()?,
                ..FitOptions::default()
            },
            forecast: self.forecast_h.map(|hours| ForecastRequest {
                until_s: 3600.0 * hours,
                load_n: self.forecast_load_n,
                temperature_c: self.forecast_temperature_c,
            }),
        })
    }

    fn base(&self) -> Result<Option<Arc<RopeBase>>, Failure> {
        let Some(name) = &self.rope else {
            if self.law.contains(&Law::Rope) {
                return Err(Failure::Refused(
                    "--law rope needs --rope NAME: a catalogue rope with the breaking load, and \
                     for what the records can't tell; sinew rope list shows them"
                        .into(),
                ));
            }
            return Ok(None);
        };
        let catalogue = self.ropes.catalogue(self.files.quiet)?;
        let base = RopeBase::new(find(&catalogue, name)?.entry.clone())?;
        Ok(Some(Arc::new(base)))
    }

    fn withhold(&self, share: f64, tests: &Tests, request: &FitRequest) -> Result<Finish, Failure> {
        if !(0.01..=0.9).contains(&share) {
            return Err(Failure::Refused(format!(
                "--withhold {share}: must lie between 0.01 and 0.9"
            )));
        }
        let bar = Bar::new("forecasting", self.files.quiet);
        let report = sinew_creep::withhold_tests(tests, share, request, |done, of| {
            bar.set(done as f64, of as f64);
        });
        drop(bar);
        let page = || creep::withhold_page(&report, tests, &self.files.conditions());
        self.files.answer(
            &report,
            creep::withhold_csv,
            Some(&page),
            creep::withhold_table,
        )?;
        let lossy = !report.failures.is_empty() || !report.forecasts_any();
        Ok(Finish::lossy(lossy))
    }

    fn shift(&self, reference_c: f64) -> Result<Finish, Failure> {
        let (sources, specimens) = self.files.specimens()?;
        let report = sinew_creep::shift(sources, &specimens, reference_c)?;
        self.files.warn(&report.failures);
        self.files
            .answer(&report, creep::shift_csv, None, creep::shift_table)?;
        Ok(Finish::lossy(!report.failures.is_empty()))
    }
}
