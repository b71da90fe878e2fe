//! Predictive check: comparison of the newest blocks with the prediction of a posterior.

use super::detector::{ChangeDetector, Innovations, Noise, SuspectedStep};
use super::result::OUTLIER;
use sinew_model::offset::{
    Block, FeatureConfig, Innovation, MapEstimate, MapEstimator, Prediction,
};
use sinew_model::statistics::{DEVIATION_PER_MEDIAN, upper_median};

/// Probability outside a 95 % interval; events of smaller probability are negligible.
pub(crate) const NEGLIGIBLE: f64 = 0.05;

/// Posterior with the change detection on the blocks after it.
#[derive(Debug, Clone)]
pub(crate) struct PredictiveCheck {
    prediction: Prediction,
    detector: ChangeDetector,
    /// Indices of the joints with an elastic transmission, in the order of the detector.
    elastic: Vec<usize>,
    /// Noise of the motor equation of each joint, N·m; NaN if the blocks of the posterior have no valid motor torque.
    motor_noise_nm: Vec<f64>,
}

impl PredictiveCheck {
    /// Creates a check against the posterior `map` of `blocks`; `elastic` has the joints with an elastic transmission.
    pub(crate) fn new(
        estimator: &MapEstimator,
        map: &MapEstimate,
        blocks: &[Block],
        elastic: &[usize],
    ) -> Self {
        let noise = noise(estimator, map, blocks, elastic);
        let is_used = |i: usize| blocks.iter().any(|b| b.motor_torque[i].is_finite());
        let motor_noise_nm = map.motor_noise_nm.iter().enumerate();
        Self {
            prediction: estimator.prediction(map),
            detector: ChangeDetector::new(noise, &FeatureConfig::default()),
            elastic: elastic.to_vec(),
            motor_noise_nm: motor_noise_nm
                .map(|(i, noise)| if is_used(i) { *noise } else { f64::NAN })
                .collect(),
        }
    }

    /// Updates the check with the last `count` of `blocks`.
    pub(crate) fn take(&mut self, estimator: &MapEstimator, blocks: &[Block], count: usize) {
        /// Number of preceding blocks in which the low-pass filter of a force settles.
        const SETTLING_BLOCKS: usize = 10;
        let from = blocks.len() - count;
        let before = from.saturating_sub(SETTLING_BLOCKS);
        let n = estimator.prior().joints();
        let innovations = estimator.innovations(&self.prediction, &blocks[before..]);
        let block_s = FeatureConfig::default().block_s;
        for (k, own) in innovations.chunks_exact(n).enumerate().skip(from - before) {
            let block = &blocks[before + k];
            let last = (before + k).checked_sub(1).map(|k| blocks[k].time_s);
            let of = |f: &dyn Fn(&Innovation) -> f64| -> Vec<f64> {
                let elastic = self.elastic.iter();
                elastic.map(|i| own[*i].as_ref().map_or(0.0, f)).collect()
            };
            self.detector.step(&Innovations {
                time_s: block.time_s,
                residual_rad: &of(&|e| e.residual_rad / e.offset_gain),
                unknown_rad2: &of(&|e| {
                    (e.parameter_variance_rad2 + e.held_rad.powi(2)) / e.offset_gain.powi(2)
                }),
                motor: &self.motor(own),
                renewed: estimator.information_share(block),
                after_gap: last.is_none_or(|last| block.time_s - last > 1.5 * block_s),
            });
        }
    }

    /// Innovations of the motor equations in the unit of the link equations, rad, with their variances, rad².
    fn motor(&self, own: &[Option<Innovation>]) -> Vec<Option<(f64, f64)>> {
        let of = |i: &usize| {
            let link = own[*i].as_ref()?;
            let motor = link.motor?;
            let gain = motor.rad_per_nm / link.offset_gain;
            let noise_nm = self.motor_noise_nm[*i];
            let variance_rad2 = (motor.variance_nm2 + noise_nm * noise_nm) * gain * gain;
            let is_valid = variance_rad2.is_finite() && motor.residual_nm.is_finite();
            is_valid.then_some((motor.residual_nm * gain, variance_rad2))
        };
        self.elastic.iter().map(of).collect()
    }

    /// Returns the suspected step of the `k`-th elastic joint; `None` if there is none.
    pub(crate) fn suspected(&self, k: usize) -> Option<SuspectedStep> {
        self.detector.suspected(k)
    }

    /// Returns the most probable step, with the index of its joint among the elastic ones.
    pub(crate) fn most_suspected(&self) -> Option<(usize, SuspectedStep)> {
        let all = (0..self.elastic.len()).filter_map(|k| Some((k, self.suspected(k)?)));
        all.max_by(|a, b| a.1.probability.total_cmp(&b.1.probability))
    }

    /// Probability of a contact in the last block.
    pub(crate) fn contact_probability(&self) -> f64 {
        (1.0 - self.detector.free()).clamp(0.0, 1.0)
    }
}

/// Estimates the noise of the link equations of the elastic joints from the blocks of a posterior that were not
/// rejected.
fn noise(
    estimator: &MapEstimator,
    map: &MapEstimate,
    blocks: &[Block],
    elastic: &[usize],
) -> Noise {
    /// Minimum white noise relative to the whole noise, if the noise of a joint is almost all slow.
    const MIN_WHITE_RATIO: f64 = 0.1;
    let n = map.noise_rad.len();
    let rho = estimator.noise_autocorrelation();
    let stationary = (1.0 - rho * rho).sqrt();
    let block_s = FeatureConfig::default().block_s;
    let residuals = estimator.residuals(map, blocks);
    let is_used = |k: &usize| {
        let follows = blocks[*k].time_s - blocks[k - 1].time_s < 1.5 * block_s;
        follows && map.weights[k - 1..=*k].iter().all(|w| *w >= OUTLIER)
    };
    let used: Vec<usize> = (1..blocks.len()).filter(is_used).collect();
    // Equation that contains the offset, and its share of the offset.
    let routings = estimator.prior().routings();
    let rows = elastic.iter().map(|i| match routings {
        None => (*i, 1.0),
        Some(routings) => routings.shown_at(*i),
    });
    let rows: Vec<(usize, f64)> = rows.collect();
    let white_rad: Vec<f64> = (rows.iter())
        .map(|(i, share)| {
            let whole = map.noise_rad[*i] * stationary;
            let white = |k: &usize| residuals[k * n + i] - rho * residuals[(k - 1) * n + i];
            let mut sizes: Vec<f64> = used.iter().map(|k| white(k).abs()).collect();
            let found = upper_median(&mut sizes).map(|median| DEVIATION_PER_MEDIAN * median);
            found.map_or(whole, |found| found.max(MIN_WHITE_RATIO * whole)) / share.abs()
        })
        .collect();
    let slow_rad2 = (rows.iter().zip(&white_rad))
        .map(|((i, share), white)| {
            let noise_rad = map.noise_rad[*i] / share.abs();
            (noise_rad.powi(2) - (white / stationary).powi(2)).max(0.0)
        })
        .collect();
    Noise {
        rho,
        white_rad,
        slow_rad2,
    }
}
