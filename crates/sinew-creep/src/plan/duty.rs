//! Elongation under a duty, and its sensitivity to every parameter.

use super::PlanRequest;
use super::coordinate::moved;
use crate::error::CreepError;
use crate::rope_base::RopeBase;
use sinew_rope::CatalogueRope;
use sinew_rope::law::entry::Uncertainty;
use sinew_rope::law::tested_range::TestedRange;
use sinew_rope::law::{Parameter, Parameters};
use sinew_rope::predict::{Request, predict};

/// Step of the differences, in coordinates.
const STEP: f64 = 0.05;

/// Duty with the elongation since tensioning as its result.
pub(super) struct Duty {
    request: Request,
    rope: CatalogueRope,
    /// Time of the elongation, s.
    pub(super) time_s: f64,
    /// Mean and largest tension over breaking load; lowest and highest temperature, °C.
    load_share: [f64; 2],
    temperature_c: [f64; 2],
}

/// Slopes of the logarithm of the elongation with every parameter's coordinate.
pub(super) struct Slopes {
    pub(super) slopes: Vec<f64>,
    /// Whether the base reports an interval.
    pub(super) stated: Vec<bool>,
}

impl Duty {
    pub(super) fn new(request: &PlanRequest) -> Result<Self, CreepError> {
        let rope = request.base.rope();
        let time_s = request.duty.times_s.last().copied().unwrap_or(0.0);
        let prediction_request = Request {
            times_s: vec![time_s],
            draws: 0,
            ..request.duty.clone()
        };
        let prediction = predict(&rope, &prediction_request).map_err(|e| CreepError::NoPlan {
            reason: e.to_string(),
        })?;
        if prediction.readings.is_empty() {
            return Err(CreepError::NoPlan {
                reason: "the rope breaks under this duty before the requested time".into(),
            });
        }
        let summary = request.duty.duty.summary();
        let mbl = request.base.parameters.breaking_load_n;
        Ok(Self {
            request: prediction_request,
            rope,
            time_s,
            load_share: [summary.tension_mean_n / mbl, summary.tension_max_n / mbl],
            temperature_c: [summary.temperature_min_c, summary.temperature_max_c],
        })
    }

    /// Elongation since tensioning of a rope with these values, m; `None` if it breaks or does not
    /// elongate.
    pub(super) fn stretch_m(&self, p: &Parameters) -> Option<f64> {
        let mut rope = self.rope.clone();
        for (parameter, value) in &mut rope.entry.law {
            value.value = p.get(*parameter);
        }
        let prediction = predict(&rope, &self.request).ok()?;
        let found = prediction.readings.first()?.since_tensioned_m.value;
        (found > 0.0).then_some(found)
    }

    pub(super) fn slopes(&self, p: &Parameters, base: &RopeBase) -> Option<Slopes> {
        self.stretch_m(p)?;
        let slope = |parameter: &Parameter| {
            let ends = [STEP, -STEP].map(|by| self.stretch_m(&moved(p, base, *parameter, by)));
            match ends {
                [Some(up), Some(down)] => (up / down).ln() / (2.0 * STEP),
                _ => 0.0,
            }
        };
        let stated = |parameter: &Parameter| {
            let entry = base.entry.law.get(parameter);
            entry.is_some_and(|v| v.uncertainty != Uncertainty::NotSpecified)
        };
        Some(Slopes {
            slopes: Parameter::ALL.iter().map(slope).collect(),
            stated: Parameter::ALL.iter().map(stated).collect(),
        })
    }

    /// Standard deviation of the logarithm due to the model error outside the tested range.
    pub(super) fn beyond(&self, tested_range: &TestedRange) -> f64 {
        let extrapolation = tested_range.extrapolation(self.load_share, self.temperature_c);
        extrapolation.std_after(tested_range.decades_beyond(self.time_s))
    }
}

impl Slopes {
    /// Variance of the logarithm as the base leaves it.
    pub(super) fn variance_now(&self) -> f64 {
        self.variance_without(&[])
    }

    /// Variance due to parameters other than these.
    pub(super) fn variance_without(&self, touched: &[usize]) -> f64 {
        (0..self.slopes.len())
            .filter(|i| self.stated[*i] && !touched.contains(i))
            .map(|i| self.slopes[i].powi(2))
            .sum()
    }
}
