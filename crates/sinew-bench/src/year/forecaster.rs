//! Forecasters: with the rope, without it, or with the true creep law.

use super::result::Forecaster;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use sinew_files::date::DAY_S;
use sinew_model::offset::SharedError;
use sinew_model::transmission::Tendon;
use sinew_rope::{Catalogue, CatalogueError, CatalogueRope};
use sinew_sim::year::surrogate::{SessionErrors, mrad};
use sinew_sim::year::truth;
use sinew_trend::filter::{Curve, Noise, Prior, Record, node_times_s};
use sinew_trend::prior;

impl Forecaster {
    /// Returns the forecaster's prior for a tendon.
    pub(super) fn prior(
        self,
        rope: &CatalogueRope,
        tendon: &Tendon,
        errors: &SessionErrors,
        curves: usize,
    ) -> Result<Prior, CatalogueError> {
        let pretension_n = tendon.pretension_n.unwrap_or(60.0);
        const SEED: u64 = 1;
        /// Temperature drift of a robot whose tolerance of 0.1 mrad/K is the default.
        const DRIFT_RAD_PER_K: f64 = 1.25e-4;
        /// Prior standard deviation of the level at the baseline if every error is taken as independent, rad.
        const ALONE_RAD: f64 = 0.5e-3;
        /// Days of work differ, and so do days of creep.
        const MIN_SLOW_STD_RAD: f64 = 0.05e-3;
        /// Relative errors of the creep rate, which season and work make variable.
        const CREEP_RATE_REL_ERRORS: [f64; 2] = [0.15, 0.5];
        let curves_of_rope =
            || prior::rope_curves(rope, tendon, pretension_n, None, 21.0, SEED).map(Prior::new);
        let mut out = match self {
            Self::Rope => curves_of_rope()?,
            Self::Alone => Prior {
                level_std_rad: ALONE_RAD,
                ..curves_of_rope()?
            },
            Self::Generic => {
                let all = Catalogue::shipped()?;
                prior::any_rope(all.ropes(), Some(tendon), 21.0, SEED).0
            }
            Self::Oracle => Prior {
                noises: CREEP_RATE_REL_ERRORS
                    .map(|creep_rate_rel_error| Noise {
                        slow_std_rad: errors.slow_rad.max(MIN_SLOW_STD_RAD),
                        slow_time_s: errors.slow_time_s,
                        // The error of the thermometer adds to the drift of this robot.
                        white_scale: 1e-3
                            * (errors.white_std_mrad())
                                .hypot(mrad(errors.drift_rad_per_k) * errors.thermometer_k)
                            / errors.own_unit_rad(),
                        creep_rate_rel_error,
                        log_weight: 0.0,
                    })
                    .to_vec(),
                ..Prior::new(true_curves(rope, tendon, curves)?)
            },
        };
        // As derived by `sinew trend` from the tolerances of a robot.
        out.temperature_std_rad_per_k = DRIFT_RAD_PER_K;
        out.temperature_ref_c = 21.0;
        Ok(out)
    }
}

impl Forecaster {
    /// Converts a session for this forecaster.
    pub(super) fn takes(self, record: Record) -> Record {
        let all_own = SharedError::default();
        Record {
            shared: match self {
                // All of it is the session's own, and its next one has another.
                Self::Alone => Some(all_own),
                _ => record.shared,
            },
            ..record
        }
    }
}

/// Creep of tendons drawn as those of the simulated years are, but others.
fn true_curves(
    rope: &CatalogueRope,
    tendon: &Tendon,
    count: usize,
) -> Result<Vec<Curve>, CatalogueError> {
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
                // Mornings are an hour and a number of days after tensioning; beyond the year the last month
                // continues, halved from octave to octave as an arbitrary assumption.
                let day = (t / DAY_S).min(end as f64);
                let (below, rest) = (day as usize, day.fract());
                let next = year.creep_rad[(below + 1).min(end)];
                year.creep_rad[below] + (next - year.creep_rad[below]) * rest
            })
            .collect();
        out.push(Curve {
            values,
            retensioned: None,
            amplitude: 1.0,
            amplitude_std: 0.1,
            log_weight: 0.0,
        });
    }
    Ok(out)
}
