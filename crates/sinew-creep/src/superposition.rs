//! Time–temperature superposition: curves at several temperatures, shifted along the logarithm of
//! time until they coincide.

use super::error::CreepError;
use super::linear;
use serde::{Deserialize, Serialize};
use sinew_model::Gaussian;

/// Property over time at one temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct Isotherm {
    /// Temperature of the isotherm, °C.
    pub temperature_c: f64,
    /// Positive times, s.
    pub time_s: Vec<f64>,
    /// Positive strain, compliance or modulus.
    pub value: Vec<f64>,
}

/// Shift of one isotherm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Shift {
    /// Temperature of the isotherm, °C.
    pub temperature_c: f64,
    /// Decadic logarithm of a_T: time at the reference is time here divided by a_T. Its standard
    /// error follows from the residuals of the overlap and grows along the chain.
    pub log10_a_t: Gaussian,
    /// Overlap of the property's logarithm with the neighbour nearer the reference, as a share of
    /// this isotherm's own range; without overlap the shift is an extrapolation.
    pub overlap_share: f64,
}

/// Shift factors and their temperature dependence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Superposition {
    /// Reference temperature, which is not shifted, °C.
    pub reference_c: f64,
    /// Shifts by increasing temperature.
    pub shifts: Vec<Shift>,
    /// Arrhenius line through all temperatures.
    pub arrhenius: Option<Arrhenius>,
    /// Equation of Williams, Landel and Ferry over temperatures from the reference up.
    pub wlf: Option<Wlf>,
}

/// Arrhenius equation `ln a_T = E/R (1/T − 1/T_ref)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Arrhenius {
    /// Activation energy `E`, J/mol.
    pub energy_j_per_mol: f64,
    /// Root mean square residual of log10 a_T, decades.
    pub residual_rms_decades: f64,
}

/// Williams-Landel-Ferry equation `log a_T = −C₁ ΔT/(C₂ + ΔT)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Wlf {
    /// Dimensionless coefficient C₁.
    pub c1: f64,
    /// Temperature coefficient C₂, K.
    pub c2_k: f64,
    /// Root mean square residual of log10 a_T, decades.
    pub residual_rms_decades: f64,
}

/// Shifts isotherms onto the one nearest to `reference_c`, neighbour by neighbour.
///
/// The shift between neighbours is the one at which a single parabola, on double logarithmic axes,
/// fits both best.
///
/// # Errors
/// Returns [`CreepError::OneTemperature`] if all temperatures are within 1 K, and
/// [`CreepError::Isotherm`] for a measurement that is not positive or fewer than three.
pub fn superpose(isotherms: &[Isotherm], reference_c: f64) -> Result<Superposition, CreepError> {
    let mut curves: Vec<(f64, Vec<(f64, f64)>)> = Vec::new();
    for isotherm in isotherms {
        let mut points: Vec<(f64, f64)> = isotherm
            .time_s
            .iter()
            .zip(&isotherm.value)
            .map(|(t, v)| (t.log10(), v.log10()))
            .collect();
        if points.len() < 3 || points.iter().any(|(t, v)| !t.is_finite() || !v.is_finite()) {
            return Err(CreepError::Isotherm {
                temperature_c: isotherm.temperature_c,
            });
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        curves.push((isotherm.temperature_c, points));
    }
    curves.sort_by(|a, b| a.0.total_cmp(&b.0));
    if curves.len() < 2 || curves[curves.len() - 1].0 - curves[0].0 < 1.0 {
        return Err(CreepError::OneTemperature);
    }
    // The property decreases (modulus) or increases (strain) with time, by the sum over all curves.
    let rise: f64 = curves.iter().map(|(_, p)| p[p.len() - 1].1 - p[0].1).sum();
    let sign = if rise < 0.0 { -1.0 } else { 1.0 };
    let rising: Vec<Vec<(f64, f64)>> = curves
        .iter()
        .map(|(_, p)| p.iter().map(|(t, v)| (*t, sign * v)).collect())
        .collect();
    let reference = (0..curves.len())
        .min_by(|a, b| {
            let apart = |i: usize| (curves[i].0 - reference_c).abs();
            apart(*a).total_cmp(&apart(*b))
        })
        .unwrap_or(0);
    let mut shifts: Vec<Shift> = curves
        .iter()
        .map(|(temperature_c, _)| Shift {
            temperature_c: *temperature_c,
            log10_a_t: Gaussian::default(),
            overlap_share: 1.0,
        })
        .collect();
    let chain = (reference + 1..curves.len())
        .map(|i| (i - 1, i))
        .chain((0..reference).rev().map(|i| (i + 1, i)));
    for (near, far) in chain {
        let (distance, error, overlap) = distance(&rising[near], &rising[far]);
        // A curve that reaches the same value earlier by d decades has log a_T smaller by d.
        let before = shifts[near].log10_a_t;
        shifts[far].log10_a_t = Gaussian::new(before.mean + distance, before.std.hypot(error));
        shifts[far].overlap_share = overlap;
    }
    let reference_c = curves[reference].0;
    Ok(Superposition {
        reference_c,
        arrhenius: arrhenius(&shifts, reference_c),
        wlf: wlf(&shifts, reference_c),
        shifts,
    })
}

/// Shift of `far` against `near` in decades, its standard error, and the overlap of their values.
///
/// The shift at which one parabola, on double logarithmic axes, fits both best. All measurements
/// count at every shift, so that a short overlap is not preferred; the error follows from the
/// curvature of the residual squares.
fn distance(near: &[(f64, f64)], far: &[(f64, f64)]) -> (f64, f64, f64) {
    /// Maximum shift between neighbours, decades.
    const MAX_SHIFT_DECADES: f64 = 8.0;
    const STEPS: i32 = 800;
    let low = near[0].1.max(far[0].1);
    let high = near[near.len() - 1].1.min(far[far.len() - 1].1);
    let own = (far[far.len() - 1].1 - far[0].1).max(1e-12);
    let overlap = ((high - low) / own).clamp(0.0, 1.0);
    let residual_squares = |d: f64| {
        let n = near.len() + far.len();
        let (x, mut y): (Vec<f64>, Vec<f64>) = near
            .iter()
            .copied()
            .chain(far.iter().map(|(t, v)| (t - d, *v)))
            .unzip();
        let mut columns = vec![1.0; n];
        columns.extend(&x);
        columns.extend(x.iter().map(|x| x * x));
        linear::solve(&mut columns, &mut y, &[false; 3]).squares
    };
    let step = MAX_SHIFT_DECADES / f64::from(STEPS);
    let best = (-STEPS..=STEPS)
        .map(|i| step * f64::from(i))
        .min_by(|a, b| residual_squares(*a).total_cmp(&residual_squares(*b)))
        .unwrap_or(0.0);
    let d = golden_section(best - step, best + step, 60, residual_squares);
    let bend = (residual_squares(d + step) - 2.0 * residual_squares(d)
        + residual_squares(d - step))
        / (step * step);
    // Three coefficients and the shift are fitted.
    let free = (near.len() + far.len()).saturating_sub(4).max(1) as f64;
    let error = (2.0 * residual_squares(d) / free / bend.max(1e-300)).sqrt();
    (d, error, overlap)
}

/// Position of the minimum of a function with one minimum between two positions.
fn golden_section(mut low: f64, mut high: f64, rounds: usize, cost: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..rounds {
        let a = high - golden * (high - low);
        let b = low + golden * (high - low);
        if cost(a) < cost(b) {
            high = b;
        } else {
            low = a;
        }
    }
    0.5 * (low + high)
}

fn arrhenius(shifts: &[Shift], reference_c: f64) -> Option<Arrhenius> {
    /// Value of R ln 10 / 1000: kJ/(mol K) per decade.
    const GAS_DECADE: f64 = 8.314_462_618e-3 * std::f64::consts::LN_10;
    let x = |t: f64| (1.0 / (t + 273.15) - 1.0 / (reference_c + 273.15)) / GAS_DECADE;
    let xx: f64 = shifts.iter().map(|s| x(s.temperature_c).powi(2)).sum();
    let xy: f64 = shifts
        .iter()
        .map(|s| x(s.temperature_c) * s.log10_a_t.mean)
        .sum();
    let energy = xy / xx;
    let rms = (shifts
        .iter()
        .map(|s| (s.log10_a_t.mean - energy * x(s.temperature_c)).powi(2))
        .sum::<f64>()
        / shifts.len() as f64)
        .sqrt();
    energy.is_finite().then_some(Arrhenius {
        energy_j_per_mol: 1e3 * energy,
        residual_rms_decades: rms,
    })
}

/// Fits the equation: for every C₂ the best C₁ is linear; C₂ by golden section.
fn wlf(shifts: &[Shift], reference_c: f64) -> Option<Wlf> {
    let above: Vec<(f64, f64)> = shifts
        .iter()
        .map(|s| (s.temperature_c - reference_c, s.log10_a_t.mean))
        .filter(|(d, _)| *d >= 0.0)
        .collect();
    if above.len() < 4 {
        return None;
    }
    let solve = |log_c2: f64| {
        let c2 = log_c2.exp();
        let (mut xx, mut xy) = (0.0, 0.0);
        for (d, a) in &above {
            let x = -d / (c2 + d);
            xx += x * x;
            xy += x * a;
        }
        let c1 = xy / xx;
        let left: f64 = above
            .iter()
            .map(|(d, a)| (a + c1 * d / (c2 + d)).powi(2))
            .sum();
        (c1, (left / above.len() as f64).sqrt())
    };
    let place = golden_section(1.0_f64.ln(), 1000.0_f64.ln(), 80, |place| solve(place).1);
    let (c1, rms) = solve(place);
    c1.is_finite().then_some(Wlf {
        c1,
        c2_k: place.exp(),
        residual_rms_decades: rms,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    // Same curve shifted by 1.2 decades, with repeated random errors: the scatter of the shift must
    // match its standard error.
    #[test]
    fn shift_std_error_matches_scatter() {
        const SHIFT_DECADES: f64 = 1.2;
        const DRAWS: u32 = 60;
        let mut at: u64 = 7;
        // Sum of twelve uniform numbers minus six: nearly normal.
        let mut normal = || {
            let mut even = || {
                at = at
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (at >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| even()).sum::<f64>() - 6.0
        };
        let mut curve = |later: f64| -> Vec<(f64, f64)> {
            let times = (0..20).map(|k| 0.2 * f64::from(k));
            times
                .map(|x| (x + later, 0.3 + 0.05 * x + 0.004 * x * x + 1e-3 * normal()))
                .collect()
        };
        let found: Vec<(f64, f64)> = (0..DRAWS)
            .map(|_| {
                let (shift, error, overlap) = distance(&curve(0.0), &curve(SHIFT_DECADES));
                assert!(overlap > 0.95, "{overlap}");
                (shift, error)
            })
            .collect();
        let n = f64::from(DRAWS);
        let mean = found.iter().map(|(shift, _)| shift).sum::<f64>() / n;
        let squares: f64 = found.iter().map(|(shift, _)| (shift - mean).powi(2)).sum();
        let spread = (squares / (n - 1.0)).sqrt();
        let error = found.iter().map(|(_, error)| error).sum::<f64>() / n;
        println!("{mean} ± {spread}, reported ± {error}");
        assert!((mean - SHIFT_DECADES).abs() < 4.0 * spread / n.sqrt());
        // The standard deviation of 60 draws is known to 9 %.
        assert!((error / spread - 1.0).abs() < 0.3, "{error} {spread}");
    }
}
