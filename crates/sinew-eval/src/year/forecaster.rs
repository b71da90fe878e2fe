//! Who forecasts: by the rope, without it, or knowing the true law.

use super::surrogate::SessionErrors;
use super::truth;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use sinew_estimate::trend::prior;
use sinew_model::transmission::Tendon;
use sinew_model::trend::{Curve, Noise, Prior, node_times_s};
use sinew_rope::{CatalogueError, CatalogueRope};

/// Who forecasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Forecaster {
    /// `sinew trend` with the rope named in the robot file.
    Rope,
    /// `sinew trend` without.
    Generic,
    /// Knows the law, how ropes, duties and errors are drawn, and lacks this tendon's numbers: what
    /// is reachable at all.
    Oracle,
}

impl Forecaster {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Rope, Self::Generic, Self::Oracle];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rope => "rope known",
            Self::Generic => "no rope",
            Self::Oracle => "true law known",
        }
    }

    /// Its prior for a tendon.
    pub(super) fn prior(
        self,
        rope: &CatalogueRope,
        tendon: &Tendon,
        errors: &SessionErrors,
        curves: usize,
    ) -> Result<Prior, CatalogueError> {
        let pretension_n = tendon.pretension_n.unwrap_or(60.0);
        const SEED: u64 = 1;
        /// Season and work leave the pace nowhere quite constant.
        const PACE_ERRORS: [f64; 2] = [0.15, 0.5];
        let mut out = match self {
            Self::Rope => Prior::new(prior::rope_curves(
                rope,
                tendon,
                pretension_n,
                None,
                21.0,
                SEED,
            )?),
            Self::Generic => Prior::new(prior::generic(Some(tendon))),
            Self::Oracle => Prior {
                noises: PACE_ERRORS
                    .map(|pace_error| Noise {
                        // Days of work differ, and so do days of creep.
                        slow_deviation_rad: 1e-3 * errors.slow_mrad.max(0.05),
                        slow_time_s: prior::days(errors.slow_days),
                        // What the thermometer's error adds is the drift's, of this robot.
                        white_scale: errors
                            .white_deviation_mrad()
                            .hypot(errors.drift_mrad_per_k * errors.thermometer_k)
                            / errors.stated_mrad,
                        pace_error,
                        log_weight: 0.0,
                    })
                    .to_vec(),
                temperature_deviation_rad_per_k: 1e-3 * errors.drift_mrad_per_k,
                level_deviation_rad: 1e-3 * errors.slow_mrad.hypot(errors.bias_mrad).max(0.05),
                ..Prior::new(true_curves(rope, tendon, curves)?)
            },
        };
        out.temperature_ref_c = 21.0;
        Ok(out)
    }
}

/// Creep of tendons drawn as those of the simulated years are, but others.
fn true_curves(
    rope: &CatalogueRope,
    tendon: &Tendon,
    count: usize,
) -> Result<Vec<Curve>, CatalogueError> {
    const DAY_S: f64 = 86_400.0;
    const SEED: u64 = 0x0dd5_0000;
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut out = Vec::with_capacity(count);
    for i in 0..count as u64 {
        let temperature_c = truth::temperatures_c(&mut rng);
        let year = truth::draw(rope, tendon, &temperature_c, SEED + 1 + i, true)?;
        let end = year.creep_rad.len() - 1;
        let values: Vec<f64> = node_times_s()
            .iter()
            .map(|&t| {
                // Mornings are an hour and so many days after tensioning; beyond the year the last
                // month goes on, halved from octave to octave by nobody's knowledge.
                let day = (t / DAY_S).min(end as f64);
                let (below, rest) = (day as usize, day.fract());
                let next = year.creep_rad[(below + 1).min(end)];
                year.creep_rad[below] + (next - year.creep_rad[below]) * rest
            })
            .collect();
        out.push(Curve {
            values,
            amplitude: 1.0,
            amplitude_deviation: 0.1,
            log_weight: 0.0,
        });
    }
    Ok(out)
}
