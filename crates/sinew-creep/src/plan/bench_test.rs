//! Bench test, and the record that a rope would give in it.

use crate::curve::{Curve, Tension};
use crate::rope_walk::Walk;
use serde::{Deserialize, Serialize};
use sinew_rope::law::{Law, Parameters};

/// Bench test: preload, load, and recovery.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BenchTest {
    /// Tension before and after the load, N.
    pub preload_n: f64,
    /// Duration of the preload, s.
    pub preloaded_s: f64,
    /// Tension of the test, N.
    pub load_n: f64,
    /// Temperature of the test, °C.
    pub temperature_c: f64,
    /// Duration of the load, s.
    pub loaded_s: f64,
    /// Duration of the recovery measured after the load, s; 0 for none.
    pub recovery_s: f64,
}

/// Number of measurements of each stage, uniform in the logarithm of its time.
const READINGS: [usize; 2] = [60, 40];
/// Time of the first measurement, s after the step.
const FIRST_S: f64 = 5.0;
/// Number of measurements whose mean is the zero.
const ZERO: f64 = 20.0;

impl BenchTest {
    /// Total time on the bench, s.
    pub fn bench_s(&self) -> f64 {
        self.preloaded_s + self.loaded_s + self.recovery_s
    }

    /// Times of the measurements, s after the load.
    pub fn readings_s(&self) -> Vec<f64> {
        let stage = |count: usize, last_s: f64| {
            (0..count)
                .map(move |i| FIRST_S * (last_s / FIRST_S).powf(i as f64 / (count - 1) as f64))
        };
        let mut times: Vec<f64> = stage(READINGS[0], self.loaded_s - 1.0).collect();
        if self.recovery_s > FIRST_S {
            times.extend(stage(READINGS[1], self.recovery_s).map(|t| self.loaded_s + t));
        }
        times
    }

    /// Load history of the test, without measurements.
    fn curve(&self) -> Curve {
        let mut steps = vec![(0.0, 1.0)];
        if self.recovery_s > FIRST_S {
            steps.push((self.loaded_s, 0.0));
        }
        Curve {
            steps,
            temperature_c: Some(self.temperature_c),
            tension: Some(Tension {
                preload_n: self.preload_n,
                per_step_n: self.load_n - self.preload_n,
                preloaded_s: self.preloaded_s,
            }),
            zero_count: ZERO,
            ..Curve::constant_load(
                format!("{} N, {} °C", self.load_n, self.temperature_c),
                Vec::new(),
                Vec::new(),
            )
        }
    }
}

/// Error-free record of a rope in a test; `None` if the test breaks it.
pub(super) fn virtual_record(parameters: &Parameters, test: &BenchTest) -> Option<Curve> {
    let mut curve = test.curve();
    curve.time_s = test.readings_s();
    curve.count = vec![1.0; curve.time_s.len()];
    curve.strain = strain(parameters, &curve)?;
    Some(curve)
}

/// Strain of a rope at the times of a curve, m/m, from its state under the preload.
pub(super) fn strain(parameters: &Parameters, curve: &Curve) -> Option<Vec<f64>> {
    let law = Law::new(*parameters).ok()?;
    let most = curve
        .steps
        .iter()
        .filter_map(|s| Some(curve.tension?.at(s.1)));
    if most.fold(0.0, f64::max) >= parameters.breaking_load_n {
        return None;
    }
    let mut walk = Walk::new(&law, curve, &curve.steps);
    let total = |walk: &Walk<'_>| walk.parts().iter().sum::<f64>();
    // A fit assumes the zero in the middle of the preload.
    let middle_s = -0.5 * curve.tension?.preloaded_s;
    let zero = total(&Walk::waiting(&law, curve, &curve.steps, middle_s));
    let at = |t: &f64| {
        walk.go_to(*t);
        total(&walk) - zero
    };
    Some(curve.time_s.iter().map(at).collect())
}
