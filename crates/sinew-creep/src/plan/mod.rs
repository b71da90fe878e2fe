//! Planning of creep tests that reduce the uncertainty of a specified duty most.
//!
//! A test is evaluated by the reduction of the prediction's interval. The planner simulates the
//! work beforehand: a rope is drawn from the catalogue's uncertainty, tests of it are simulated,
//! the rope law is fitted to them, and the duty is predicted from the fit. All of this is
//! linearised about the drawn rope. [`check`](check::check) performs it completely.
//!
//! Reading order: `bench_test` (a test and its record), `design` (uncertainty after a fit of
//! records), `duty` (effect on the prediction), this file (selection of the next test), `check`.

mod bench_test;
mod check;
mod coordinate;
mod design;
mod duty;

pub use bench_test::BenchTest;
pub use check::{PlanCheck, check};

use super::curve::Curve;
use super::error::CreepError;
use super::parallel::each;
use super::rope_base::RopeBase;
use bench_test::virtual_record;
use design::{Design, Record};
use duty::Duty;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Z95;
use sinew_rope::Draws;
use sinew_rope::predict::Request;
use std::sync::Arc;

/// Inputs of a plan: rope, duty, candidate tests and limits.
#[derive(Debug, Clone)]
pub struct PlanRequest {
    /// Base rope: start of the fits, and its uncertainty.
    pub base: Arc<RopeBase>,
    /// Duty of the rope; its last time is the one that counts.
    pub duty: Request,
    /// Candidate tests for selection.
    pub candidates: Vec<BenchTest>,
    /// Maximum number of tests.
    pub tests: usize,
    /// Total time on the bench for all of them, s.
    pub bench_s: f64,
    /// Existing records, which are fitted together with the planned ones.
    pub existing: Vec<Curve>,
    /// Standard deviation of a measurement's strain, m/m.
    pub reading_ratio: f64,
    /// Number of ropes drawn for the simulation.
    pub truths: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// Candidate test of a step and its expected result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Test conditions and durations.
    pub test: BenchTest,
    /// Expected half-width of the 95 % interval after it, as a share of the elongation: `exp(1.96
    /// s) − 1`.
    pub half_width_share: f64,
}

/// Step of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlannedTest {
    /// Test to perform.
    pub test: BenchTest,
    /// Half-width expected after this and the previous tests, as a share of the elongation.
    pub half_width_share: f64,
    /// Part of it that no fit of these tests removes: model error outside their loads, temperatures
    /// and times.
    pub beyond_share: f64,
    /// Best candidates of this step, the best first.
    pub candidates: Vec<Candidate>,
}

/// Planned tests, the most informative first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plan {
    /// Name of the rope.
    pub rope: String,
    /// Description of the duty.
    pub duty: String,
    /// Time of the elongation, s.
    pub time_s: f64,
    /// Half-width of the interval before these tests, as a share of the elongation since
    /// tensioning: from the catalogue's entry, or from a fit of the existing records, whichever is
    /// narrower.
    pub half_width_share: f64,
    /// Part of it outside the tested range.
    pub beyond_share: f64,
    /// Tests in the order to perform them.
    pub tests: Vec<PlannedTest>,
    /// Total time of all tests on the bench, s.
    pub bench_s: f64,
    /// Standard deviation of a measurement's strain, m/m.
    pub reading_ratio: f64,
    /// Number of existing records.
    pub existing: usize,
    /// Half-width after a fit of the existing records alone, if it is wider than that of the
    /// catalogue's entry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prior_half_width_share: Option<f64>,
    /// Number of ropes drawn.
    pub truths: usize,
    /// Validation on virtual ropes, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<PlanCheck>,
}

impl JsonDocument for Plan {
    const SCHEMA: &'static str = "sinew/creep-plan/2";
}

/// Maximum number of candidates reported per step.
const MAX_CANDIDATES: usize = 8;
/// Maximum ratio of half-widths for which a shorter test is preferred.
const MAX_PREFERENCE_RATIO: f64 = 1.02;
/// Maximum ratio of half-widths for a further test; otherwise the plan ends.
const MAX_WIDTH_RATIO: f64 = 0.98;

/// Plans tests.
///
/// # Errors
/// Returns [`CreepError::NoPlan`] if the duty cannot be predicted, no candidate fits the time, or
/// none can be fitted.
pub fn plan(
    request: &PlanRequest,
    progress: impl Fn(usize, usize) + Sync,
) -> Result<Plan, CreepError> {
    let duty = Duty::new(request)?;
    let rope = request.base.rope();
    let no_plan = |reason: String| CreepError::NoPlan { reason };
    let draws =
        Draws::new(&rope, request.truths, request.seed).map_err(|e| no_plan(e.to_string()))?;
    // Simulated results of each drawn rope on the bench and in the duty.
    let truths: Vec<Truth> = each(
        &draws.laws,
        |law| Truth::of(law.parameters(), request, &duty),
        |done| progress(done, request.truths),
    )
    .into_iter()
    .flatten()
    .collect();
    if truths.is_empty() {
        return Err(no_plan(
            "the rope breaks under this duty in every draw".into(),
        ));
    }
    let tested_range_now = request
        .base
        .entry
        .tested_range
        .unwrap_or(sinew_rope::law::tested_range::TestedRange::UNSPECIFIED);
    let beyond_now = duty.beyond(&tested_range_now);
    let unknown = || {
        let left = truths.iter();
        mean(left.map(|t| t.duty.variance_now().sqrt().hypot(beyond_now)))
    };
    // Existing records count with the uncertainty of their fit, if it is smaller than that of the
    // entry.
    let entry = (unknown(), beyond_now);
    let (mut now, mut beyond_now) = entry;
    let mut existing_wider = None;
    if !request.existing.is_empty() {
        let of_existing = expected(request, &duty, &truths, &[]);
        let Some(of_existing) = of_existing.filter(|(width, _)| width.is_finite()) else {
            return Err(no_plan(
                "the rope law cannot be fitted to the specified records; expected a force for every measurement, and several minutes under load".into(),
            ));
        };
        match of_existing.0 <= now {
            true => (now, beyond_now) = of_existing,
            false => existing_wider = Some(share(of_existing.0)),
        }
    }
    let mut chosen: Vec<usize> = Vec::new();
    let mut tests = Vec::new();
    let mut left_s = request.bench_s;
    for _ in 0..request.tests {
        let open: Vec<usize> = (0..request.candidates.len())
            .filter(|i| request.candidates[*i].bench_s() <= left_s)
            .collect();
        let mut found: Vec<(usize, f64, f64)> = each(
            &open,
            |&i| {
                let mut all = chosen.clone();
                all.push(i);
                expected(request, &duty, &truths, &all).map(|(width, beyond)| (i, width, beyond))
            },
            |_| {},
        )
        .into_iter()
        .flatten()
        .filter(|(_, width, _)| width.is_finite())
        .collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        let Some(&(_, least, _)) = found.first() else {
            break;
        };
        let equivalent = found.iter().filter(|f| f.1 <= MAX_PREFERENCE_RATIO * least);
        let best = equivalent.min_by(|a, b| {
            let time = |i: usize| request.candidates[i].bench_s();
            time(a.0).total_cmp(&time(b.0))
        });
        let Some(&(best, width, beyond)) = best else {
            break;
        };
        let before = tests.last().map(|t: &PlannedTest| t.half_width_share);
        if before.is_some_and(|before| share(width) > MAX_WIDTH_RATIO * before) {
            break;
        }
        left_s -= request.candidates[best].bench_s();
        chosen.push(best);
        let shown = found
            .iter()
            .take(MAX_CANDIDATES)
            .map(|&(i, width, _)| Candidate {
                test: request.candidates[i],
                half_width_share: share(width),
            });
        tests.push(PlannedTest {
            test: request.candidates[best],
            half_width_share: share(width),
            beyond_share: share(beyond),
            candidates: shown.collect(),
        });
    }
    if tests.is_empty() {
        let hours = request.bench_s / 3600.0;
        let fits = |test: &BenchTest| test.bench_s() <= request.bench_s;
        let fitting = request.candidates.iter().filter(|test| fits(test));
        return Err(no_plan(match (request.candidates.len(), fitting.count()) {
            (0, _) => "no load is 1.5 times the preload or more".into(),
            (_, 0) => format!("no test fits into {hours:.1} h on the bench"),
            _ => "the rope law cannot be fitted to any of these tests: the loads break the rope or act too briefly, or the \
                  standard deviation of a measurement is below the resolution of floating-point numbers"
                .into(),
        }));
    }
    Ok(Plan {
        rope: request.base.entry.name.clone(),
        duty: request.duty.duty.about.clone(),
        time_s: duty.time_s,
        half_width_share: share(now),
        beyond_share: share(beyond_now),
        bench_s: chosen
            .iter()
            .map(|i| request.candidates[*i].bench_s())
            .sum(),
        tests,
        reading_ratio: request.reading_ratio,
        existing: request.existing.len(),
        prior_half_width_share: existing_wider,
        truths: truths.len(),
        check: None,
    })
}

/// Half-width of a 95 % interval of a logarithm, as a share.
fn share(std: f64) -> f64 {
    (Z95 * std).exp_m1()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let all: Vec<f64> = values.collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

/// Drawn rope: its records and its duty, each with the sensitivity to every parameter.
struct Truth {
    /// Records by candidate; `None` if the test would break the rope.
    records: Vec<Option<Record>>,
    existing: Vec<Record>,
    duty: duty::Slopes,
}

impl Truth {
    fn of(
        parameters: &sinew_rope::law::Parameters,
        request: &PlanRequest,
        duty: &Duty,
    ) -> Option<Self> {
        let base = &request.base;
        let record = |curve: &Curve| Record::of(parameters, base, curve, request.reading_ratio);
        let candidate = |test: &BenchTest| virtual_record(parameters, test).map(|c| record(&c));
        Some(Self {
            records: request.candidates.iter().map(candidate).collect(),
            existing: request.existing.iter().map(record).collect(),
            duty: duty.slopes(parameters, base)?,
        })
    }
}

/// Expected standard deviation of the logarithm of the elongation after tests, and its part outside
/// the tested range; `None` if a fit of them is rejected.
fn expected(
    request: &PlanRequest,
    duty: &Duty,
    truths: &[Truth],
    tests: &[usize],
) -> Option<(f64, f64)> {
    let mut left = Vec::with_capacity(truths.len());
    let mut beyond = 0.0;
    for truth in truths {
        let own = tests.iter().map(|i| truth.records[*i].as_ref());
        let own: Option<Vec<&Record>> = own.collect();
        let records: Vec<&Record> = truth.existing.iter().chain(own?).collect();
        let design = Design::new(&records, &request.base)?;
        beyond = duty.beyond(&design.tested_range(&request.base));
        left.push(design.variance(&truth.duty).sqrt().hypot(beyond));
    }
    Some((mean(left.into_iter()), beyond))
}
