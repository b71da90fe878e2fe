//! Motor positions that are a constant multiple of their joint positions: another unit, a missing gear ratio, a wrong sign.

use serde::{Deserialize, Serialize};

/// Range of the slope of the motor position over the joint position of a tendon: it differs from one by the change of the
/// deflection over the travel of the joint.
const PLAUSIBLE_SLOPES: std::ops::Range<f64> = 0.5..2.0;
/// Minimum share of the variance of the motor position that the joint position explains for a constant ratio.
const MIN_EXPLAINED_SHARE: f64 = 0.99;
/// Minimum standard deviation of the joint position for its ratio to be tested, rad.
const MIN_TRAVEL_STD_RAD: f64 = 0.05;
/// Minimum number of samples for a ratio; about four seconds of the blocks of an estimate.
const MIN_SAMPLES: f64 = 20.0;

/// Motor whose position is proportional to the position of its joint with a factor that is not near one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MotorRatio {
    /// Name of the joint.
    pub joint: String,
    /// Slope of the motor position over the joint position.
    pub slope: f64,
}

impl MotorRatio {
    /// Line of the mapping file with which the slope is near one.
    #[must_use]
    pub fn remedy(&self) -> String {
        /// Maximum relative distance of a slope from the factor between two units: deflections of the spring.
        const MAX_FACTOR_ERROR: f64 = 0.1;
        let is = |factor: f64| (self.slope.abs() / factor - 1.0).abs() < MAX_FACTOR_ERROR;
        let sign = if self.slope < 0.0 { ", sign = -1" } else { "" };
        let degrees_per_rad = 180.0 / std::f64::consts::PI;
        let name = &self.joint;
        if is(1.0) {
            format!("[joints.{name}] theta = {{ …{sign} }}")
        } else if is(degrees_per_rad) {
            format!("[joints.{name}] theta = {{ …, unit = \"deg\"{sign} }}")
        } else if is(1.0 / degrees_per_rad) {
            format!("[joints.{name}] q = {{ …, unit = \"deg\"{sign} }}")
        } else {
            let ratio = self.slope.abs();
            format!("[joints.{name}] theta = {{ …, gear_ratio = {ratio:.4}{sign} }}")
        }
    }
}

/// Running sums of the line `theta = intercept + slope · q` of a motor and its joint.
#[derive(Debug, Clone, Copy, Default)]
pub struct RatioSums {
    count: f64,
    origin: (f64, f64),
    q: f64,
    theta: f64,
    qq: f64,
    q_theta: f64,
    theta_theta: f64,
    /// Smallest and largest motor position, relative to the first one.
    theta_range: [f64; 2],
}

impl RatioSums {
    /// Adds a joint position and a motor position, rad; a sample that is not finite is ignored.
    pub fn push(&mut self, q: f64, theta: f64) {
        if !(q.is_finite() && theta.is_finite()) {
            return;
        }
        if self.count == 0.0 {
            self.origin = (q, theta);
        }
        let (q, theta) = (q - self.origin.0, theta - self.origin.1);
        self.count += 1.0;
        self.q += q;
        self.theta += theta;
        self.qq += q * q;
        self.q_theta += q * theta;
        self.theta_theta += theta * theta;
        let [low, high] = self.theta_range;
        self.theta_range = [low.min(theta), high.max(theta)];
    }

    /// Slope by least squares; `None` with too few samples, if the joint hardly moves and its motor travels less than
    /// `held_rad` (travel of a motor whose joint is held, rad), or if the relation is not linear.
    #[must_use]
    pub fn constant_slope(&self, held_rad: f64) -> Option<f64> {
        let n = self.count;
        let qq = self.qq - self.q * self.q / n;
        let q_theta = self.q_theta - self.q * self.theta / n;
        let theta_theta = self.theta_theta - self.theta * self.theta / n;
        let [low, high] = self.theta_range;
        let moves = (qq / n).sqrt() > MIN_TRAVEL_STD_RAD || high - low > held_rad;
        let is_tested = n >= MIN_SAMPLES && moves;
        let is_linear = q_theta * q_theta > MIN_EXPLAINED_SHARE * qq * theta_theta;
        (is_tested && is_linear).then(|| q_theta / qq)
    }

    /// Whether the motor moves with the joint in a constant ratio near one.
    #[must_use]
    pub fn is_direct(&self) -> bool {
        let slope = self.constant_slope(f64::INFINITY);
        slope.is_some_and(|slope| PLAUSIBLE_SLOPES.contains(&slope))
    }

    /// Ratio of the motor of `joint` if it is constant and not near one; `held_rad` as in
    /// [`constant_slope`](Self::constant_slope).
    #[must_use]
    pub fn implausible(&self, joint: &str, held_rad: f64) -> Option<MotorRatio> {
        let slope = self.constant_slope(held_rad)?;
        (!PLAUSIBLE_SLOPES.contains(&slope)).then(|| MotorRatio {
            joint: joint.to_owned(),
            slope,
        })
    }
}

/// Sentence about motors with an implausible ratio, with the lines of the mapping file that correct it.
#[must_use]
pub fn describe_ratios(ratios: &[MotorRatio]) -> String {
    let slopes: Vec<String> = (ratios.iter())
        .map(|r| format!("{:.4} at '{}'", r.slope, r.joint))
        .collect();
    let lines: Vec<String> = ratios.iter().map(MotorRatio::remedy).collect();
    format!(
        "motor positions are a multiple of the joint positions, by a factor of {}; expected 1: a unit, the gear ratio or a sign is wrong; specify it in a mapping (--mapping): {}",
        slopes.join(", "),
        lines.join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums(theta: impl Fn(f64, f64) -> f64) -> RatioSums {
        let mut sums = RatioSums::default();
        for k in 0..200 {
            let q = (0.1 * f64::from(k)).sin();
            sums.push(q, theta(q, f64::from(k)));
        }
        sums
    }

    #[test]
    fn constant_slope_is_found_only_for_linear_motion() {
        for ratio in [-1.0, 1.0, 6.0, 57.3] {
            let sums = sums(|q, k| ratio * q + 0.01 * (0.7 * k).sin());
            let found = sums.constant_slope(f64::INFINITY).unwrap();
            assert!((found / ratio - 1.0).abs() < 0.01, "{found} {ratio}");
            assert_eq!(sums.implausible("a", f64::INFINITY).is_none(), ratio == 1.0);
        }
        // A motor that does not drive its joint, and a joint at rest.
        let unrelated = sums(|_, k| 3.0 * (0.23 * k).sin());
        assert_eq!(unrelated.constant_slope(f64::INFINITY), None);
        let mut at_rest = RatioSums::default();
        for k in 0..200 {
            let q = 1e-3 * (0.1 * f64::from(k)).sin();
            at_rest.push(q, 200.0 * q);
        }
        assert_eq!(at_rest.constant_slope(f64::INFINITY), None);
        // A motor that travels farther than a spring can be bent moves its joint.
        assert_eq!(at_rest.constant_slope(0.5), None);
        let slope = at_rest.constant_slope(0.3).unwrap();
        assert!((slope / 200.0 - 1.0).abs() < 1e-9, "{slope}");
        assert_eq!(RatioSums::default().constant_slope(0.0), None);
    }

    #[test]
    fn remedy_names_the_key_of_the_mapping() {
        let remedy = |slope: f64| {
            let joint = "a".to_owned();
            MotorRatio { joint, slope }.remedy()
        };
        assert_eq!(remedy(57.3), "[joints.a] theta = { …, unit = \"deg\" }");
        assert_eq!(remedy(0.0175), "[joints.a] q = { …, unit = \"deg\" }");
        assert_eq!(remedy(-1.03), "[joints.a] theta = { …, sign = -1 }");
        assert!(remedy(-6.0).contains("gear_ratio = 6.0000, sign = -1"));
    }
}
