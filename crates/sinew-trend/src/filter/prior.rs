//! Prior of a trend before the first record.

use super::curve::Curve;
use super::fingerprint::Fingerprint;
use sinew_model::offset::TENSIONED_OFFSET_RAD;

/// Error model of the records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// `σ_u`: standard deviation of the slow error of neighbouring sessions, rad.
    pub slow_std_rad: f64,
    /// `τ_u`: correlation time of the slow error, s.
    pub slow_time_s: f64,
    /// `w`: ratio of actual to reported standard deviation of a record's independent error; of the
    /// whole reported one if a record does not report its parts.
    pub white_scale: f64,
    /// `δ`: relative deviation of the creep rate from its curve per e-fold of time.
    pub creep_rate_rel_error: f64,
    /// Logarithm of the prior probability, up to a constant.
    pub log_weight: f64,
}

/// Prior of one tendon before its first record.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// Candidate creep curves.
    pub curves: Vec<Curve>,
    /// Candidate error models.
    pub noises: Vec<Noise>,
    /// Standard deviation of the level at the baseline, rad: zero by definition, up to the
    /// uncertainty of the baseline's time.
    pub level_std_rad: f64,
    /// Standard deviation of the drift with temperature, rad/K.
    pub temperature_std_rad_per_k: f64,
    /// Size of the steps of creep, rad: `Var[dJ] = step a dc`.
    pub step_rad: f64,
    /// Temperature of the baseline, °C.
    pub temperature_ref_c: f64,
    /// `t_b`: time of the baseline, s after tensioning.
    pub baseline_s: f64,
}

impl Prior {
    /// Creates a prior with default errors: level zero at the baseline, drift of 0.3 mrad/K,
    /// baseline one hour after tensioning at 23 °C.
    #[must_use]
    pub fn new(curves: Vec<Curve>) -> Self {
        Self {
            curves,
            noises: generic_noises(),
            level_std_rad: TENSIONED_OFFSET_RAD,
            temperature_std_rad_per_k: 0.3e-3,
            step_rad: 0.07e-3,
            temperature_ref_c: 23.0,
            baseline_s: 3600.0,
        }
    }

    /// Whether filters can be built from it.
    #[must_use]
    pub fn is_possible(&self) -> bool {
        let positive = |v: f64| v > 0.0 && v.is_finite();
        !self.curves.is_empty()
            && !self.noises.is_empty()
            && self.curves.iter().all(Curve::is_possible)
            && self.noises.iter().all(|n| {
                n.slow_std_rad >= 0.0
                    && n.slow_std_rad.is_finite()
                    && positive(n.slow_time_s)
                    && positive(n.white_scale)
                    && n.creep_rate_rel_error >= 0.0
                    && n.creep_rate_rel_error.is_finite()
                    && n.log_weight.is_finite()
            })
            && positive(self.level_std_rad)
            && self.temperature_std_rad_per_k >= 0.0
            && self.temperature_std_rad_per_k.is_finite()
            && self.step_rad >= 0.0
            && self.step_rad.is_finite()
            && self.temperature_ref_c.is_finite()
            && self.baseline_s >= 0.0
            && self.baseline_s.is_finite()
    }

    /// Hash of the prior: a stored state is valid only for the prior it was computed with.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let mut all = Fingerprint::new();
        let mut mix = |v: f64| all.take(v);
        for c in &self.curves {
            let added = c.retensioned.iter().flatten();
            c.values.iter().chain(added).for_each(|v| mix(*v));
            for v in [c.amplitude, c.amplitude_std, c.log_weight] {
                mix(v);
            }
        }
        for n in &self.noises {
            for v in [
                n.slow_std_rad,
                n.slow_time_s,
                n.white_scale,
                n.creep_rate_rel_error,
                n.log_weight,
            ] {
                mix(v);
            }
        }
        for v in [
            self.level_std_rad,
            self.temperature_std_rad_per_k,
            self.step_rad,
            self.temperature_ref_c,
            self.baseline_s,
        ] {
            mix(v);
        }
        all.value()
    }
}

/// Default error models: slow errors of 0.03 and 0.1 mrad over 10 days, of 0.4 and 1.2 mrad over 5
/// and 30 days; actual standard deviations of 0.2, 0.5 and 1.1 times the reported ones; relative
/// deviations of the creep rate of 0.2 or 0.7 per e-fold of time: 36 in total. Sessions since one
/// baseline share most of their error, so that they scatter by much less than they report; the
/// records determine the weights.
#[must_use]
pub fn generic_noises() -> Vec<Noise> {
    const DAY_S: f64 = 86_400.0;
    let mut out = Vec::new();
    const SLOW_MRAD_DAYS: [(f64, f64); 6] = [
        (0.03, 10.0),
        (0.1, 10.0),
        (0.4, 5.0),
        (0.4, 30.0),
        (1.2, 5.0),
        (1.2, 30.0),
    ];
    for (slow_mrad, slow_days) in SLOW_MRAD_DAYS {
        for white_scale in [0.2, 0.5, 1.1] {
            for creep_rate_rel_error in [0.2, 0.7] {
                out.push(Noise {
                    slow_std_rad: 1e-3 * slow_mrad,
                    slow_time_s: slow_days * DAY_S,
                    white_scale,
                    creep_rate_rel_error,
                    log_weight: 0.0,
                });
            }
        }
    }
    out
}
