//! `sinew creep fit`.

use super::super::rope::{Ropes, find};
use super::files::{TestFiles, warn};
use super::write_rope::rope_name;
use crate::args::{Choice, choice};
use crate::files::write_table;
use crate::quantity::{Force, Share, Temperature, Time, above_zero, duration, part};
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
    sinew creep fit rope.csv --gauge-length 350mm --forecast 1year\n  \
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
        conflicts_with_all = ["hold_out", "shift_to"],
        help_heading = "Rope law"
    )]
    write_rope: Option<PathBuf>,
    /// Forecast horizon after loading, s, e.g. 1year
    #[arg(long, value_name = "TIME", value_parser = duration)]
    forecast: Option<Time>,
    /// Load of the forecast, N, on a new specimen [default: longest load of the test, continued]
    #[arg(long, alias = "forecast-load-n", value_name = "FORCE", requires = "forecast", value_parser = above_zero::<Force>)]
    forecast_load: Option<Force>,
    /// Temperature of the forecast, °C, of a new specimen [default: of the test]
    #[arg(
        long,
        alias = "forecast-temperature-c",
        value_name = "TEMPERATURE",
        requires = "forecast",
        allow_hyphen_values = true
    )]
    forecast_temperature: Option<Temperature>,
    /// Hold out this last share of every test, ratio, and report the coverage of the forecast
    #[arg(long, value_name = "SHARE", value_parser = part, conflicts_with_all = ["forecast", "shift_to"])]
    hold_out: Option<Share>,
    /// Reference temperature, °C: estimate shift factors of isotherms (strain or modulus) instead of
    /// laws
    #[arg(
        long,
        alias = "shift-c",
        value_name = "TEMPERATURE",
        allow_hyphen_values = true
    )]
    shift_to: Option<Temperature>,
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
        if let Some(Temperature(reference_c)) = self.shift_to {
            return self.shift(reference_c);
        }
        let tests = self
            .files
            .tests(&[("--write-rope", self.write_rope.as_deref())])?;
        let request = self.request()?;
        if let Some(Share(share)) = self.hold_out {
            return self.hold_out(share, &tests, &request);
        }
        let bar = Bar::new("fitting");
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
            sinew_files::write_file(path, entry.to_toml().as_bytes())?;
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
                level: self.files.level.0,
                kind: self.intervals,
                seed: self.files.seed,
                rope: self.base()?,
                ..FitOptions::default()
            },
            forecast: self.forecast.map(|horizon| ForecastRequest {
                until_s: horizon.0,
                load_n: self.forecast_load.map(|load| load.0),
                temperature_c: self.forecast_temperature.map(|temperature| temperature.0),
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
        let catalogue = self.ropes.catalogue()?;
        let base = RopeBase::new(find(&catalogue, name)?.entry.clone())?;
        Ok(Some(Arc::new(base)))
    }

    fn hold_out(&self, share: f64, tests: &Tests, request: &FitRequest) -> Result<Finish, Failure> {
        if !(0.01..=0.9).contains(&share) {
            return Err(Failure::Error(format!(
                "--hold-out {share}: must be between 0.01 and 0.9"
            )));
        }
        let bar = Bar::new("forecasting");
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
        let (sources, specimens) = self.files.specimens(&[])?;
        let report = sinew_creep::shift(sources, &specimens, reference_c)?;
        warn(&report.failures);
        self.files
            .answer(&report, creep::shift_csv, None, creep::shift_table)?;
        Ok(Finish::lossy(!report.failures.is_empty()))
    }
}
