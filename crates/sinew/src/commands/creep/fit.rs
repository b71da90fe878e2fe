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

/// Fit creep laws, compare them, and list parameters that are not identifiable
///
/// Laws: log-time, findley, burgers, kelvin-voigt, stretched; rope with --rope. --joint fits several
/// loads, temperatures and unloading together.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew creep fit rope.csv --gauge-length-mm 350 --forecast-h 8760\n  \
    sinew creep fit tests.csv --joint group --group rope\n  \
    sinew creep fit rope.csv --rope liros-dc000-0301 --law rope --write-rope ropes/mine.toml\n  \
    sinew creep fit tests.csv --hold-out 0.33")]
pub(crate) struct Fit {
    #[command(flatten)]
    files: TestFiles,
    /// Law to fit (repeatable) [default: all]
    #[arg(long, value_name = "LAW")]
    law: Vec<Law>,
    /// Specimens fitted together
    #[arg(long, value_parser = choice(&JOINTS), default_value = "none")]
    joint: Joint,
    /// Model of the measurement errors
    #[arg(long, value_parser = choice(&NOISES), default_value = "correlated")]
    noise: NoiseKind,
    /// Method of the parameter intervals
    #[arg(long, value_parser = choice(&INTERVALS), default_value = "draws")]
    intervals: IntervalKind,
    /// Catalogue rope with breaking load and parameters that records do not identify
    #[arg(long, value_name = "NAME", help_heading = "Rope law")]
    rope: Option<String>,
    #[command(flatten)]
    ropes: Ropes,
    /// Write the fitted rope as catalogue entry, named after the file
    #[arg(
        long,
        value_name = "FILE.toml",
        requires = "rope",
        conflicts_with_all = ["hold_out", "shift_c"],
        help_heading = "Rope law"
    )]
    write_rope: Option<PathBuf>,
    /// Forecast horizon after loading, h
    #[arg(long, value_name = "H", value_parser = positive("h"))]
    forecast_h: Option<f64>,
    /// Load of the forecast, N, on a new specimen [default: longest load of the test, continued]
    #[arg(long, value_name = "N", requires = "forecast_h", value_parser = positive("N"))]
    forecast_load_n: Option<f64>,
    /// Temperature of the forecast, °C, of a new specimen [default: of the test]
    #[arg(
        long,
        value_name = "C",
        requires = "forecast_h",
        allow_negative_numbers = true
    )]
    forecast_temperature_c: Option<f64>,
    /// Hold out this last share of every test, and report the coverage of the forecast
    #[arg(long, value_name = "SHARE", conflicts_with_all = ["forecast_h", "shift_c"])]
    hold_out: Option<f64>,
    /// Reference temperature, °C: estimate shift factors of isotherms (strain or modulus) instead of
    /// laws
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    shift_c: Option<f64>,
}

const JOINTS: [Choice<Joint>; 3] = [
    ("none", "Every specimen individually", Joint::None),
    (
        "shape",
        "Specimens of a group share the shape of the law, not its amplitude",
        Joint::Shape,
    ),
    (
        "group",
        "Specimens of a group share all parameters except the strain zero",
        Joint::Group,
    ),
];

const NOISES: [Choice<NoiseKind>; 2] = [
    (
        "correlated",
        "Independent and correlated errors, both estimated",
        NoiseKind::Correlated,
    ),
    ("white", "Independent errors", NoiseKind::White),
];

const INTERVALS: [Choice<IntervalKind>; 3] = [
    ("draws", "Quantiles of posterior draws", IntervalKind::Draws),
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
        if let Some(share) = self.hold_out {
            return self.hold_out(share, &tests, &request);
        }
        let bar = Bar::new("fitting", self.files.quiet);
        let report = sinew_creep::fit_tests(&tests, &request, |step, done, of| {
            if step == FitStep::Forecasting {
                bar.set_label("forecasting");
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
                .map_err(|reason| Failure::Error(format!("--write-rope: {reason}")))?;
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
                return Err(Failure::Error(
                    "--law rope requires --rope NAME: catalogue rope with breaking load and parameters \
                     that the records do not identify (see sinew rope list)"
                        .into(),
                ));
            }
            return Ok(None);
        };
        let catalogue = self.ropes.catalogue(self.files.quiet)?;
        let base = RopeBase::new(find(&catalogue, name)?.entry.clone())?;
        Ok(Some(Arc::new(base)))
    }

    fn hold_out(&self, share: f64, tests: &Tests, request: &FitRequest) -> Result<Finish, Failure> {
        if !(0.01..=0.9).contains(&share) {
            return Err(Failure::Error(format!(
                "--hold-out {share}: must be between 0.01 and 0.9"
            )));
        }
        let bar = Bar::new("forecasting", self.files.quiet);
        let report = sinew_creep::hold_out_tests(tests, share, request, |done, of| {
            bar.set(done as f64, of as f64);
        });
        drop(bar);
        let page = || creep::hold_out_page(&report, tests, &self.files.conditions());
        self.files.answer(
            &report,
            creep::hold_out_csv,
            Some(&page),
            creep::hold_out_table,
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
