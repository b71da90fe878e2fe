//! `sinew creep plan`.

use super::super::rope::{DutyArgs, Ropes, celsius, duration, find};
use crate::args::positive;
use crate::files::{Named, check_outputs, write_table};
use crate::terminal::{Bar, Failure, Finish, Word, answer_as, complain};
use crate::text::plain;
use clap::Args;
use sinew_creep::{
    BenchTest, PlanRequest, PrepareOptions, RopeBase, TestOptions, check_plan, prepare,
};
use sinew_report::creep;
use std::path::PathBuf;
use std::sync::Arc;

/// Which creep test next: load, temperature and duration that shrink a duty's interval most
///
/// The rope law is fitted, on paper, to tests of ropes as the catalogue leaves them open, and the duty predicted from the
/// fit. --check carries the plan out on virtual ropes: whether its promise comes true.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew creep plan liros-dc000-0301 --tension 100 --at 1year\n  \
    sinew creep plan liros-dc000-0301 --tension 100 --at 1year --with mine.csv --bench-hours 8\n  \
    sinew creep plan liros-dc000-0301 --tension 300 --temperature 40 --at 30d --check 20 --csv programme.csv")]
pub(crate) struct Plan {
    /// Rope that the fits start from
    name: String,
    #[command(flatten)]
    duty: DutyArgs,
    #[command(flatten)]
    ropes: Ropes,
    /// Recordings of tests there are already: they are fitted along (may be repeated)
    #[arg(long = "with", value_name = "FILE", help_heading = "Tests")]
    known: Vec<PathBuf>,
    /// Loads that the bench can hold, N [default: from 1 to 15 % of the breaking load, and the duty's]
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = positive("N"), help_heading = "Tests")]
    loads: Vec<f64>,
    /// Temperatures it can hold, °C [default: 23 and the duty's]
    #[arg(long, value_name = "C,…", value_delimiter = ',', value_parser = celsius, allow_negative_numbers = true, help_heading = "Tests")]
    temperatures: Vec<f64>,
    /// How long a load may be held
    #[arg(long, value_name = "TIMES", value_delimiter = ',', value_parser = duration, default_value = "85min,8h,24h", help_heading = "Tests")]
    durations: Vec<f64>,
    /// Tension before and after a test, N
    #[arg(long, value_name = "N", value_parser = positive("N"), default_value = "2", help_heading = "Tests")]
    preload: f64,
    /// Tests to plan at most; one that tells nothing more is left out
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8), help_heading = "Tests")]
    tests: u8,
    /// Time on the bench for all of them, h
    #[arg(long, value_name = "H", default_value = "48", value_parser = positive("h"), help_heading = "Tests")]
    bench_hours: f64,
    /// Standard deviation of a reading, % of the length
    #[arg(long, value_name = "PERCENT", default_value = "0.002", value_parser = positive("%"), help_heading = "Tests")]
    reading_percent: f64,
    /// Carry the plan out on so many virtual ropes
    #[arg(long, value_name = "ROPES", value_parser = clap::value_parser!(u16).range(1..=1000))]
    check: Option<u16>,
    /// Write the bench's programme: load and temperature over time, with the times to read; .csv or .parquet
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
    /// Nothing on stderr
    #[arg(long)]
    quiet: bool,
}

/// Ropes that a plan goes through the work with, unless --draws says otherwise: their mean is known to a fifth of how they
/// differ.
const TRUTHS: usize = 24;
/// A load of no more than so many preloads shows too little beside it.
const LEAST_OF_PRELOAD: f64 = 1.5;

impl Plan {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let inputs: Vec<Named<'_>> = self
            .known
            .iter()
            .map(|f| ("--with", Some(f.as_path())))
            .collect();
        check_outputs(&[("--csv", self.csv.as_deref())], &inputs, self.quiet)?;
        /// The first reading is 5 s after the load: a test is ten times as long and more.
        const SHORTEST_S: f64 = 60.0;
        if let Some(short) = self.durations.iter().find(|s| **s < SHORTEST_S) {
            return Err(Failure::Refused(format!(
                "--durations {short} s: hold a load for {SHORTEST_S} s or longer; the first reading is 5 s after it"
            )));
        }
        let request = self.request()?;
        let bar = Bar::new("ropes", self.quiet);
        let mut plan = sinew_creep::plan(&request, |done, of| bar.set(done as f64, of as f64))?;
        drop(bar);
        if let Some(ropes) = self.check {
            let ropes = usize::from(ropes);
            let bar = Bar::new("checking", self.quiet);
            let check = check_plan(&plan, &request, ropes, |done| {
                bar.set(done as f64, ropes as f64)
            })?;
            plan.check = Some(check);
        }
        write_table(self.csv.as_deref(), || creep::plan_programme(&plan))?;
        answer_as(self.json, &plan, creep::plan_table)?;
        // A check that could fit nothing has shown nothing.
        Ok(match &plan.check {
            Some(check) if check.ropes == 0 => Finish::Refused,
            _ => Finish::Complete,
        })
    }

    fn request(&self) -> Result<PlanRequest, Failure> {
        let catalogue = self.ropes.catalogue(self.quiet)?;
        let rope = find(&catalogue, &self.name)?;
        let base = Arc::new(RopeBase::new(rope.entry.clone())?);
        self.loads_are_possible(base.breaking_load_n())?;
        let duty = self.duty.resolve(self.quiet)?.request;
        let seed = duty.seed;
        let known = self.known()?;
        Ok(PlanRequest {
            candidates: self.candidates(&duty.duty.summary(), base.breaking_load_n()),
            base,
            duty,
            tests: usize::from(self.tests),
            bench_s: 3600.0 * self.bench_hours,
            known,
            reading_ratio: 0.01 * self.reading_percent,
            truths: self.duty.draws().unwrap_or(TRUTHS),
            seed,
        })
    }

    /// Whether a bench can hold every load that was asked for with this rope.
    fn loads_are_possible(&self, breaking_load_n: f64) -> Result<(), Failure> {
        let least_n = LEAST_OF_PRELOAD * self.preload;
        for load_n in &self.loads {
            let why = match *load_n {
                n if n >= breaking_load_n => {
                    format!(
                        "breaks {}, whose breaking load is {breaking_load_n} N",
                        self.name
                    )
                }
                n if n <= least_n => format!(
                    "shows too little beside the preload of {} N; ask for more than {least_n} N, or lower --preload",
                    self.preload
                ),
                _ => continue,
            };
            return Err(Failure::Refused(format!("--loads: {load_n} N {why}")));
        }
        Ok(())
    }

    fn known(&self) -> Result<Vec<sinew_creep::Curve>, Failure> {
        if self.known.is_empty() {
            return Ok(Vec::new());
        }
        let mut note = |text: &str| {
            if !self.quiet {
                complain(Word::Note, &plain(text));
            }
        };
        let options = TestOptions::default();
        let (_, specimens) = sinew_creep::read_specimens(&self.known, &options, &mut note)?;
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
        /// Shares of the breaking load: below, a braid is slack; above, a bench for robots' ropes ends.
        const SHARES: [f64; 5] = [0.01, 0.02, 0.04, 0.08, 0.15];
        let mut loads = self.loads.clone();
        if loads.is_empty() {
            loads.extend(SHARES.map(|share| two_digits(share * breaking_load_n)));
            loads.extend([duty.tension_mean_n, duty.tension_max_n]);
            distinct(&mut loads, |n| 0.05 * n);
        }
        let mut celsius = self.temperatures.clone();
        if celsius.is_empty() {
            celsius.extend([23.0, duty.temperature_mean_c, duty.temperature_max_c]);
            distinct(&mut celsius, |_| 2.0);
        }
        distinct(&mut loads, |_| 0.0);
        distinct(&mut celsius, |_| 0.0);
        let mut out = Vec::new();
        for &load_n in loads
            .iter()
            .filter(|n| **n > LEAST_OF_PRELOAD * self.preload)
        {
            for &temperature_c in &celsius {
                for &loaded_s in &self.durations {
                    // Not watched after it, or for half as long.
                    for recovery_s in [0.0, 0.5 * loaded_s] {
                        out.push(BenchTest {
                            preload_n: self.preload,
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

/// A load that somebody sets by hand.
fn two_digits(n: f64) -> f64 {
    let unit = 10f64.powf(n.log10().floor() - 1.0);
    (n / unit).round() * unit
}

/// Rising, without values that are the same: nearer than `apart` of one.
fn distinct(values: &mut Vec<f64>, apart: impl Fn(f64) -> f64) {
    values.sort_unstable_by(f64::total_cmp);
    values.dedup_by(|b, a| (*b - *a).abs() <= apart(*a));
}
