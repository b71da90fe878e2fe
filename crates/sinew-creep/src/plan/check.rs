//! Validation of a plan: its tests on virtual ropes, with complete fits and predictions.

use super::bench_test::virtual_record;
use super::duty::Duty;
use super::{Plan, PlanRequest};
use crate::artefacts::median;
use crate::error::CreepError;
use crate::fit::fit;
use crate::law::Law;
use crate::options::{FitOptions, NoiseKind};
use crate::parallel::each;
use crate::rope_entry::{EntrySource, rope_entry};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};
use sinew_rope::law::Law as RopeLaw;
use sinew_rope::predict::{Request, predict};
use sinew_rope::{CatalogueRope, Draws};

/// Plan carried out on virtual ropes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlanCheck {
    /// Number of ropes drawn from the catalogue's uncertainty, tested and fitted.
    pub ropes: usize,
    /// Median half-width of the prediction's 95 % interval after the tests, as a share of the
    /// elongation.
    pub half_width_share: f64,
    /// Number of ropes whose elongation lay within the interval.
    pub inside: usize,
    /// Number of ropes whose tests could not be fitted or whose duty could not be predicted.
    pub failed: usize,
}

/// Carries out a plan on `ropes` virtual ropes. Existing records belong to a real rope and are
/// excluded.
///
/// # Errors
/// Returns [`CreepError::NoPlan`] if the rope or its duty is invalid.
pub fn check(
    plan: &Plan,
    request: &PlanRequest,
    ropes: usize,
    progress: impl Fn(usize) + Sync,
) -> Result<PlanCheck, CreepError> {
    let duty = Duty::new(request)?;
    let rope = request.base.rope();
    // Ropes independent of those used for planning.
    let draws =
        Draws::new(&rope, ropes, request.seed ^ 0xc4ec).map_err(|e| CreepError::NoPlan {
            reason: e.to_string(),
        })?;
    let jobs: Vec<(u64, &RopeLaw)> = (1..).zip(&draws.laws).collect();
    let rows = each(
        &jobs,
        |(seed, law)| carried_out(plan, request, &duty, law, *seed),
        progress,
    );
    let done: Vec<(f64, bool)> = rows.into_iter().flatten().collect();
    let widths: Vec<f64> = done.iter().map(|d| d.0).collect();
    Ok(PlanCheck {
        ropes: done.len(),
        half_width_share: if widths.is_empty() {
            f64::NAN
        } else {
            median(&widths)
        },
        inside: done.iter().filter(|d| d.1).count(),
        failed: ropes - done.len(),
    })
}

/// One rope: half-width of its prediction as a share, and whether that contains its own elongation.
fn carried_out(
    plan: &Plan,
    request: &PlanRequest,
    duty: &Duty,
    law: &RopeLaw,
    seed: u64,
) -> Option<(f64, bool)> {
    let truth = law.parameters();
    let stretch_m = duty.stretch_m(truth)?;
    let mut random = ChaCha8Rng::seed_from_u64(request.seed ^ seed << 8);
    let mut curves = Vec::new();
    for planned in &plan.tests {
        let mut curve = virtual_record(truth, &planned.test)?;
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let zero = request.reading_ratio / curve.zero_count.sqrt() * normal();
        for strain in &mut curve.strain {
            *strain += request.reading_ratio * normal() - zero;
        }
        curves.push(curve);
    }
    let options = FitOptions {
        noise: NoiseKind::White,
        seed,
        rope: Some(request.base.clone()),
        ..FitOptions::default()
    };
    let found = fit(Law::Rope, &curves, &options).ok()?;
    let from = EntrySource {
        name: "planned".into(),
        data: "virtual".into(),
        date: "2026-01-01".into(),
    };
    let entry = rope_entry(&found, &request.base, &from).ok()?;
    let prediction_request = Request {
        times_s: vec![plan.time_s],
        draws: 400,
        seed,
        ..request.duty.clone()
    };
    let prediction = predict(&CatalogueRope { entry, file: None }, &prediction_request).ok()?;
    let interval = prediction.readings.first()?.since_tensioned_m;
    let half = 0.5 * (interval.high / interval.low).ln();
    let inside = (interval.low..=interval.high).contains(&stretch_m);
    half.is_finite().then(|| (half.exp_m1(), inside))
}
