//! Creep curves on a common logarithmic clock.

/// Time of the first node, s.
pub(super) const FIRST_S: f64 = 100.0;
/// Nodes per decade of time: a straight line over time has an error of 0.5 % between two nodes, a
/// straight line over its logarithm none.
const PER_DECADE: usize = 12;
/// Number of decades from the first node: to 100 years.
const DECADES: usize = 8;
/// Number of nodes of every curve.
pub const NODES: usize = PER_DECADE * DECADES + 1;
/// Duration of a year of 365.25 days, s.
const YEAR_S: f64 = 31_557_600.0;

/// Creep curve of a rope after tensioning, and its prior probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Offset at [`node_times_s`] for an amplitude of 1, rad; rising.
    pub values: Vec<f64>,
    /// Additional offset at [`node_times_s`] after a re-tensioning of a tendon that has lost all of its
    /// tension, for an amplitude of 1, rad; `None` for a linear viscoelastic rope, of which it is
    /// `values` by superposition.
    pub retensioned: Option<Vec<f64>>,
    /// Mean of the amplitude's prior (a normal distribution truncated at 0).
    pub amplitude: f64,
    /// Standard deviation of the amplitude's prior before truncation.
    pub amplitude_std: f64,
    /// Logarithm of the prior probability, up to a constant.
    pub log_weight: f64,
}

/// Node times of the curves, s after tensioning.
#[must_use]
pub fn node_times_s() -> Vec<f64> {
    (0..NODES)
        .map(|i| FIRST_S * libm::pow(10.0, i as f64 / PER_DECADE as f64))
        .collect()
}

/// Position of a time among the nodes, common to all curves: its logarithm is computed once.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    /// At or before tensioning.
    NotYet,
    /// Before the first node.
    BeforeFirst { time_s: f64 },
    /// After node `below`, by this share of the interval to the next.
    After { below: usize, share: f64 },
}

impl Place {
    pub(super) fn of(time_s: f64) -> Self {
        if !(time_s > 0.0) {
            return Self::NotYet;
        }
        if time_s <= FIRST_S {
            return Self::BeforeFirst { time_s };
        }
        let at = libm::log10(time_s / FIRST_S) * PER_DECADE as f64;
        let below = at as usize;
        Self::After {
            below,
            share: at - below as f64,
        }
    }
}

impl Curve {
    /// Value at `time_s` after tensioning: linear over the logarithm of time between nodes, linear
    /// over time before the first, constant after the last; 0 at and before tensioning.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        self.between(Place::of(time_s))
    }

    /// Value at a position among the nodes.
    pub(super) fn between(&self, place: Place) -> f64 {
        between(&self.values, place)
    }

    /// Additional offset after a re-tensioning, at a position among the nodes of the time since then.
    pub(super) fn added_between(&self, place: Place) -> f64 {
        between(self.retensioned.as_ref().unwrap_or(&self.values), place)
    }

    /// Whether the curve is valid: as many finite, rising values as nodes, and a valid prior.
    #[must_use]
    pub fn is_possible(&self) -> bool {
        let added = self.retensioned.as_ref();
        let finite = self.values.iter().all(|v| v.is_finite())
            && added.is_none_or(|a| a.len() == NODES && a.iter().all(|v| v.is_finite()));
        // A rope that retracts while warming up falls a little; a larger fall is not a creep curve.
        let range = self.values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let rising = self.values.windows(2).all(|w| w[1] >= w[0] - 0.05 * range);
        self.values.len() == NODES
            && finite
            && rising
            && self.amplitude.is_finite()
            && self.amplitude_std > 0.0
            && self.amplitude_std.is_finite()
            && self.log_weight.is_finite()
    }
}

/// Value at a position among nodes.
fn between(values: &[f64], place: Place) -> f64 {
    let (Some(first), Some(last)) = (values.first(), values.last()) else {
        return 0.0;
    };
    match place {
        Place::NotYet => 0.0,
        Place::BeforeFirst { time_s } => first * time_s / FIRST_S,
        Place::After { below, share } => match (values.get(below), values.get(below + 1)) {
            (Some(a), Some(b)) => a + (b - a) * share,
            _ => *last,
        },
    }
}

/// Creep curves for an unspecified rope: retardation times from a minute to a cut-off, `c(t) ∝ ∫
/// τ^n (1 − exp(−t/τ)) d ln τ`, for `n` of −0.3, 0 (a straight line over the logarithm of time) and
/// 0.3 and cut-offs from three days to twenty years, and a straight line over time. Each is 1 after
/// a year.
///
/// * `amplitude_std_rad`: standard deviation of the half-normal prior of the creep of the first
///   year, rad.
#[must_use]
pub fn generic_curves(amplitude_std_rad: f64) -> Vec<Curve> {
    const DAY_S: f64 = 86_400.0;
    const POWERS: [f64; 3] = [-0.3, 0.0, 0.3];
    const CUT_OFFS_D: [f64; 7] = [3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 7000.0];
    let times = node_times_s();
    let mut out = Vec::with_capacity(POWERS.len() * CUT_OFFS_D.len() + 1);
    let mut push = |values: Vec<f64>| {
        let mut curve = Curve {
            values,
            retensioned: None,
            amplitude: 0.0,
            amplitude_std: amplitude_std_rad,
            log_weight: 0.0,
        };
        let year = curve.at(YEAR_S);
        curve.values.iter_mut().for_each(|v| *v /= year);
        out.push(curve);
    };
    for n in POWERS {
        for cut_off_d in CUT_OFFS_D {
            push(
                times
                    .iter()
                    .map(|&t| spread(t, n, cut_off_d * DAY_S))
                    .collect(),
            );
        }
    }
    push(times);
    out
}

/// `∫ τ^n (1 − exp(−t/τ)) d ln τ` from a minute to `cut_off_s`, by the trapezoidal rule over ln τ.
fn spread(t: f64, n: f64, cut_off_s: f64) -> f64 {
    const SHORTEST_S: f64 = 60.0;
    const STEP: f64 = 0.1;
    let length = libm::log(cut_off_s / SHORTEST_S);
    let steps = libm::ceil(length / STEP).max(1.0);
    let h = length / steps;
    let mut sum = 0.0;
    for i in 0..=steps as usize {
        let tau = SHORTEST_S * libm::exp(h * i as f64);
        let weight = if i == 0 || i == steps as usize {
            0.5
        } else {
            1.0
        };
        sum += weight * h * libm::pow(tau, n) * -libm::expm1(-t / tau);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_may_fall_by_five_percent_of_range() {
        for whole in [1e-3, 1.0, 1e3] {
            let falls_by = |share: f64| {
                let mut values: Vec<f64> = (0..NODES)
                    .map(|i| whole * i as f64 / (NODES - 1) as f64)
                    .collect();
                values[NODES / 2] = values[NODES / 2 - 1] - share * whole;
                Curve {
                    values,
                    retensioned: None,
                    amplitude: 1.0,
                    amplitude_std: 0.5,
                    log_weight: 0.0,
                }
            };
            assert!(falls_by(0.04).is_possible(), "{whole}");
            assert!(!falls_by(0.06).is_possible(), "{whole}");
        }
    }
}
