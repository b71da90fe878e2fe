//! The creep test that would tell most about a stated duty.
//!
//! A test is worth what it takes from the interval of the prediction. So the command goes through the work before it is done:
//! a rope is drawn as the catalogue leaves it open, tests of it are made on paper, the rope law is fitted to them, and the
//! duty is predicted from the fit. All that is linearised about the drawn rope. [`check`](check::check) does it in full.
//!
//! Reading order: `bench_test` (a test and its record), `design` (what a fit of records would leave open), `duty` (what that
//! means for the prediction), this file (which test is next), `check`.

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

/// What is asked of a plan.
#[derive(Debug, Clone)]
pub struct PlanRequest {
    /// The rope: where fits start from, and what is open.
    pub base: Arc<RopeBase>,
    /// The duty; its last time is the one that counts.
    pub duty: Request,
    /// Tests that may be chosen.
    pub candidates: Vec<BenchTest>,
    /// Tests to plan at most.
    pub tests: usize,
    /// Time on the bench for all of them, s.
    pub bench_s: f64,
    /// Records there are already: they are fitted along.
    pub known: Vec<Curve>,
    /// Standard deviation of a reading's strain, m/m.
    pub reading_ratio: f64,
    /// Ropes drawn to go through the work with.
    pub truths: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// A test that was looked at.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// The test.
    pub test: BenchTest,
    /// Expected half width of the 95 % interval after it, as a share of the stretch: `exp(1.96 s) − 1`.
    pub half_width_share: f64,
}

/// One step of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlannedTest {
    /// The test to make.
    pub test: BenchTest,
    /// Half width expected after it and those before, as a share of the stretch.
    pub half_width_share: f64,
    /// Part of that which no fit of these tests removes: what the law may miss beyond their loads, temperatures and times.
    pub beyond_share: f64,
    /// The best of the tests looked at for this step, the best first.
    pub candidates: Vec<Candidate>,
}

/// Tests to make, the most telling first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plan {
    /// Rope.
    pub rope: String,
    /// The duty in words.
    pub duty: String,
    /// Time that counts, s.
    pub time_s: f64,
    /// Half width of the interval before these tests, as a share of the stretch since tensioned: what the catalogue's entry
    /// leaves, or a fit of the records taken as given, whichever is narrower.
    pub half_width_share: f64,
    /// Part of it beyond the data behind it.
    pub beyond_share: f64,
    /// Tests, in the order to make them.
    pub tests: Vec<PlannedTest>,
    /// Time of all of them on the bench, s.
    pub bench_s: f64,
    /// Standard deviation of a reading's strain, m/m.
    pub reading_ratio: f64,
    /// Records taken as given.
    pub known: usize,
    /// Half width that a fit of those records alone leaves, where it is wider than before them: the entry knows more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub known_half_width_share: Option<f64>,
    /// Ropes drawn.
    pub truths: usize,
    /// The plan carried out on virtual ropes, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<PlanCheck>,
}

impl JsonDocument for Plan {
    const SCHEMA: &'static str = "sinew/creep-plan/1";
}

/// Candidates shown of every step.
const SHOWN: usize = 8;
/// A shorter test is taken where it leaves at most so much more.
const AS_GOOD: f64 = 1.02;
/// A further test must leave at most so much of the interval; else the plan ends.
const WORTH: f64 = 0.98;

/// Plans tests.
///
/// # Errors
/// [`CreepError::NoPlan`] where the duty can't be predicted, no candidate fits the time, or none can be fitted.
pub fn plan(
    request: &PlanRequest,
    progress: impl Fn(usize, usize) + Sync,
) -> Result<Plan, CreepError> {
    let duty = Duty::new(request)?;
    let rope = request.base.rope();
    let refuse = |reason: String| CreepError::NoPlan { reason };
    let draws =
        Draws::new(&rope, request.truths, request.seed).map_err(|e| refuse(e.to_string()))?;
    // What each drawn rope would do on the bench and in the duty.
    let truths: Vec<Truth> = each(
        &draws.laws,
        |law| Truth::of(law.parameters(), request, &duty),
        |done| progress(done, request.truths),
    )
    .into_iter()
    .flatten()
    .collect();
    if truths.is_empty() {
        return Err(refuse(
            "the rope breaks under this duty in every draw".into(),
        ));
    }
    let holds_now = request
        .base
        .entry
        .holds
        .unwrap_or(sinew_rope::law::holds::Holds::NOT_STATED);
    let beyond_now = duty.beyond(&holds_now);
    let unknown = || {
        let left = truths.iter();
        mean(left.map(|t| t.duty.variance_now().sqrt().hypot(beyond_now)))
    };
    // Records that are there already are worth what a fit of them leaves, where that is less than the entry leaves open.
    let entry = (unknown(), beyond_now);
    let (mut now, mut beyond_now) = entry;
    let mut known_wider = None;
    if !request.known.is_empty() {
        let of_known = expected(request, &duty, &truths, &[]);
        let Some(of_known) = of_known.filter(|(width, _)| width.is_finite()) else {
            return Err(refuse(
                "the rope law can't be fitted to the records given: they need the force of every reading, and minutes under load".into(),
            ));
        };
        match of_known.0 <= now {
            true => (now, beyond_now) = of_known,
            false => known_wider = Some(share(of_known.0)),
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
        let as_good = found.iter().filter(|f| f.1 <= AS_GOOD * least);
        let best = as_good.min_by(|a, b| {
            let time = |i: usize| request.candidates[i].bench_s();
            time(a.0).total_cmp(&time(b.0))
        });
        let Some(&(best, width, beyond)) = best else {
            break;
        };
        let before = tests.last().map(|t: &PlannedTest| t.half_width_share);
        if before.is_some_and(|before| share(width) > WORTH * before) {
            break;
        }
        left_s -= request.candidates[best].bench_s();
        chosen.push(best);
        let shown = found.iter().take(SHOWN).map(|&(i, width, _)| Candidate {
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
        return Err(refuse(match (request.candidates.len(), fitting.count()) {
            (0, _) => "no load is 1.5 times the preload or more".into(),
            (_, 0) => format!("no test fits into {hours:.1} h on the bench"),
            _ => "the rope law can't be fitted to any of these tests: loads that break the rope, held too shortly, or readings \
                  finer than a double holds"
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
        known: request.known.len(),
        known_half_width_share: known_wider,
        truths: truths.len(),
        check: None,
    })
}

/// Half a 95 % interval of a logarithm, as a share.
fn share(deviation: f64) -> f64 {
    (Z95 * deviation).exp_m1()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let all: Vec<f64> = values.collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

/// A drawn rope: its records and its duty, each with how they go with every parameter.
struct Truth {
    /// By candidate; none where the test would break the rope.
    records: Vec<Option<Record>>,
    known: Vec<Record>,
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
            known: request.known.iter().map(record).collect(),
            duty: duty.slopes(parameters, base)?,
        })
    }
}

/// Deviation of the logarithm of the stretch that is expected after tests, and the part beyond them; none where a fit of them
/// is refused.
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
        let records: Vec<&Record> = truth.known.iter().chain(own?).collect();
        let design = Design::new(&records, &request.base)?;
        beyond = duty.beyond(&design.holds(&request.base));
        left.push(design.variance(&truth.duty).sqrt().hypot(beyond));
    }
    Some((mean(left.into_iter()), beyond))
}
