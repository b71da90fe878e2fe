//! `sinew creep plan`.

use super::super::rope::{DutyArgs, Ropes, find};
use crate::files::{Named, check_outputs, write_table};
use crate::quantity::{Force, Share, Temperature, Time, above_zero, duration, rope_temperature};
use crate::terminal::{Bar, Failure, Finish, Word, answer_as, complain};
use crate::text::plain;
use clap::Args;
use sinew_creep::{
    BenchTest, PlanRequest, PrepareOptions, RopeBase, TestOptions, check_plan, prepare,
};
use sinew_report::creep;
use std::path::PathBuf;
use std::sync::Arc;

/// Plan creep tests: load, temperature and duration that reduce the prediction interval most
///
/// The expected interval of the duty is computed from linearised fits of the rope law to simulated tests. --check validates
/// the plan with full fits on simulated ropes.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew creep plan liros-dc000-0301 --tension 100 --at 1year\n  \
    sinew creep plan liros-dc000-0301 --tension 100 --at 1year --with mine.csv --bench-time 8h\n  \
    sinew creep plan liros-dc000-0301 --tension 300N --temperature 40°C --at 30d --check 20 --csv programme.csv")]
pub(crate) struct Plan {
    /// Catalogue rope
    name: String,
    #[command(flatten)]
    duty: DutyArgs,
    #[command(flatten)]
    ropes: Ropes,
    /// Existing test recordings, included in the fits (repeatable)
    #[arg(long = "with", value_name = "FILE", help_heading = "Tests")]
    existing: Vec<PathBuf>,
    /// Available loads, N [default: 1 to 15 % of the breaking load, and the loads of the duty]
    #[arg(long, value_name = "FORCES", value_delimiter = ',', value_parser = above_zero::<Force>, help_heading = "Tests")]
    loads: Vec<Force>,
    /// Available temperatures, °C [default: 23 and those of the duty]
    #[arg(long, value_name = "TEMPERATURES", value_delimiter = ',', value_parser = rope_temperature, allow_hyphen_values = true, help_heading = "Tests")]
    temperatures: Vec<Temperature>,
    /// Available durations under load, s
    #[arg(long, value_name = "TIMES", value_delimiter = ',', value_parser = duration, default_value = "85min,8h,24h", help_heading = "Tests")]
    durations: Vec<Time>,
    /// Tension before and after a test, N
    #[arg(long, value_name = "FORCE", value_parser = above_zero::<Force>, default_value = "2N", help_heading = "Tests")]
    preload: Force,
    /// Maximum number of tests; tests without benefit are omitted
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8), help_heading = "Tests")]
    tests: u8,
    /// Maximum total time on the bench, s
    #[arg(long, value_name = "TIME", default_value = "48h", value_parser = duration, help_heading = "Tests")]
    bench_time: Time,
    /// Standard deviation of a measurement, ratio to the length
    #[arg(long, value_name = "SHARE", default_value = "0.002%", value_parser = above_zero::<Share>, help_heading = "Tests")]
    reading_error: Share,
    /// Validate the plan on this number of simulated ropes
    #[arg(long, value_name = "ROPES", value_parser = clap::value_parser!(u16).range(1..=1000))]
    check: Option<u16>,
    /// Write the bench programme: load, temperature and measurement times; .csv or .parquet
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

/// Default number of simulated ropes of a plan; their mean is accurate to one fifth of their standard deviation.
const DEFAULT_ROPES: usize = 24;
/// Minimum load of a test over its preload.
const MIN_LOAD_OVER_PRELOAD: f64 = 1.5;

impl Plan {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let inputs: Vec<Named<'_>> = self
            .existing
            .iter()
            .map(|f| ("--with", Some(f.as_path())))
            .collect();
        check_outputs(&[("--csv", self.csv.as_deref())], &inputs)?;
        /// Minimum duration of a test, s: more than ten times the time of the first measurement (5 s).
        const MIN_DURATION_S: f64 = 60.0;
        if let Some(Time(short)) = self.durations.iter().find(|time| time.0 < MIN_DURATION_S) {
            return Err(Failure::Error(format!(
                "--durations {short} s: must be at least {MIN_DURATION_S} s, because the first measurement is 5 s after loading"
            )));
        }
        let request = self.request()?;
        let bar = Bar::new("ropes");
        let mut plan = sinew_creep::plan(&request, |done, of| bar.set(done as f64, of as f64))?;
        drop(bar);
        if let Some(ropes) = self.check {
            let ropes = usize::from(ropes);
            let bar = Bar::new("validating");
            let check = check_plan(&plan, &request, ropes, |done| {
                bar.set(done as f64, ropes as f64)
            })?;
            plan.check = Some(check);
        }
        write_table(self.csv.as_deref(), || creep::plan_programme(&plan))?;
        answer_as(self.json, &plan, creep::plan_table)?;
        // A validation without a successful fit is a failure.
        Ok(match &plan.check {
            Some(check) if check.ropes == 0 => Finish::InvalidInput,
            _ => Finish::Complete,
        })
    }

    fn request(&self) -> Result<PlanRequest, Failure> {
        let catalogue = self.ropes.catalogue()?;
        let rope = find(&catalogue, &self.name)?;
        let base = Arc::new(RopeBase::new(rope.entry.clone())?);
        self.check_loads(base.breaking_load_n())?;
        let duty = self.duty.resolve()?.request;
        let seed = duty.seed;
        let existing = self.existing()?;
        Ok(PlanRequest {
            candidates: self.candidates(&duty.duty.summary(), base.breaking_load_n()),
            base,
            duty,
            tests: usize::from(self.tests),
            bench_s: self.bench_time.0,
            existing,
            reading_ratio: self.reading_error.0,
            truths: self.duty.draws().unwrap_or(DEFAULT_ROPES),
            seed,
        })
    }

    /// Checks that all specified loads are between preload and breaking load.
    fn check_loads(&self, breaking_load_n: f64) -> Result<(), Failure> {
        let min_n = MIN_LOAD_OVER_PRELOAD * self.preload.0;
        for Force(load_n) in &self.loads {
            let reason = match *load_n {
                n if n >= breaking_load_n => {
                    format!(
                        "exceeds the breaking load of {} ({breaking_load_n} N)",
                        self.name
                    )
                }
                n if n <= min_n => format!(
                    "is too close to the preload of {} N; specify more than {min_n} N, or reduce --preload",
                    self.preload.0
                ),
                _ => continue,
            };
            return Err(Failure::Error(format!("--loads: {load_n} N {reason}")));
        }
        Ok(())
    }

    fn existing(&self) -> Result<Vec<sinew_creep::Curve>, Failure> {
        if self.existing.is_empty() {
            return Ok(Vec::new());
        }
        let mut note = |text: &str| complain(Word::Note, &plain(text));
        let options = TestOptions::default();
        let (_, specimens) = sinew_creep::read_specimens(&self.existing, &options, &mut note)?;
        let curves = specimens.iter().map(|specimen| {
            Ok(prepare(specimen, &PrepareOptions::default())?
                .curve
                .thinned())
        });
        curves
            .collect::<Result<Vec<_>, sinew_creep::CreepError>>()
            .map_err(Into::into)
    }

    fn candidates(
        &self,
        duty: &sinew_rope::duty::DutySummary,
        breaking_load_n: f64,
    ) -> Vec<BenchTest> {
        /// Default loads as shares of the breaking load: a braid is slack below, bench capacity ends above.
        const SHARES: [f64; 5] = [0.01, 0.02, 0.04, 0.08, 0.15];
        let mut loads: Vec<f64> = self.loads.iter().map(|load| load.0).collect();
        if loads.is_empty() {
            loads.extend(SHARES.map(|share| two_digits(share * breaking_load_n)));
            loads.extend([duty.tension_mean_n, duty.tension_max_n]);
            distinct(&mut loads, |n| 0.05 * n);
        }
        let mut celsius: Vec<f64> = self.temperatures.iter().map(|t| t.0).collect();
        if celsius.is_empty() {
            celsius.extend([23.0, duty.temperature_mean_c, duty.temperature_max_c]);
            distinct(&mut celsius, |_| 2.0);
        }
        distinct(&mut loads, |_| 0.0);
        distinct(&mut celsius, |_| 0.0);
        let mut out = Vec::new();
        for &load_n in loads
            .iter()
            .filter(|n| **n > MIN_LOAD_OVER_PRELOAD * self.preload.0)
        {
            for &temperature_c in &celsius {
                for &Time(loaded_s) in &self.durations {
                    // Without recovery, or with a recovery of half the duration.
                    for recovery_s in [0.0, 0.5 * loaded_s] {
                        out.push(BenchTest {
                            preload_n: self.preload.0,
                            preloaded_s: 60.0,
                            load_n,
                            temperature_c,
                            loaded_s,
                            recovery_s,
                        });
                    }
                }
            }
        }
        out
    }
}

/// Rounds a load to two significant digits.
fn two_digits(n: f64) -> f64 {
    let unit = 10f64.powf(n.log10().floor() - 1.0);
    (n / unit).round() * unit
}

/// Sorts values, and removes those closer than `apart` to their predecessor.
fn distinct(values: &mut Vec<f64>, apart: impl Fn(f64) -> f64) {
    values.sort_unstable_by(f64::total_cmp);
    values.dedup_by(|b, a| (*b - *a).abs() <= apart(*a));
}
