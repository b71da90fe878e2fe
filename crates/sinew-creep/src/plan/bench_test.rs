//! A test on the bench, and the record that a rope would make of it.

use crate::curve::{Curve, Tension};
use crate::rope_walk::Walk;
use serde::{Deserialize, Serialize};
use sinew_rope::law::{Law, Parameters};

/// Preload, load, and what comes after it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BenchTest {
    /// Tension before and after, N.
    pub preload_n: f64,
    /// How long it is held before, s.
    pub preloaded_s: f64,
    /// Tension of the test, N.
    pub load_n: f64,
    /// °C.
    pub temperature_c: f64,
    /// How long the load is held, s.
    pub loaded_s: f64,
    /// How long the rope is watched after it, s; 0: not at all.
    pub recovery_s: f64,
}

/// Readings of a stage, even in the logarithm of its time.
const READINGS: [usize; 2] = [60, 40];
/// The first of them, s after the step.
const FIRST_S: f64 = 5.0;
/// Readings whose mean is the zero.
const ZERO: f64 = 20.0;

impl BenchTest {
    /// Time on the bench, s.
    pub fn bench_s(&self) -> f64 {
        self.preloaded_s + self.loaded_s + self.recovery_s
    }

    /// Times of its readings, s after the load.
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

    /// Its load, without readings.
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

/// What a rope shows in a test, without errors; none where the test breaks it.
pub(super) fn virtual_record(parameters: &Parameters, test: &BenchTest) -> Option<Curve> {
    let mut curve = test.curve();
    curve.time_s = test.readings_s();
    curve.count = vec![1.0; curve.time_s.len()];
    curve.strain = strain(parameters, &curve)?;
    Some(curve)
}

/// Strain of a rope at a curve's readings, m/m, from its state under the preload.
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
    // Where a fit takes the zero to have been read: in the middle of the preload.
    let middle_s = -0.5 * curve.tension?.preloaded_s;
    let zero = total(&Walk::waiting(&law, curve, &curve.steps, middle_s));
    let at = |t: &f64| {
        walk.go_to(*t);
        total(&walk) - zero
    };
    Some(curve.time_s.iter().map(at).collect())
}
