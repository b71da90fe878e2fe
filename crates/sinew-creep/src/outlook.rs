//! Back-tested forecasts: each law first forecasts the end of its own record, and its interval is
//! widened by the observed error.
//!
//! The interval of a law does not include its model error. With `z_k` the root mean square of the
//! back-tests' errors over the standard deviation of the interval, an interval `±q σ` becomes
//!
//! ```text
//! ± t_ν q' σ s,   s² = (ν₀ + Σ z_k²)/(ν₀ + K),   ν = ν₀ + K
//! ```
//!
//! the quantile of Student's distribution for a scale estimated from `K` back-tests and a prior of
//! [`PRIOR_FREEDOM`] degrees of freedom that is centred on the law's own `σ`.

use super::curve::Curve;
use super::error::CreepError;
use super::fit::{Fit, fit};
use super::forecast::Forecast;
use super::forecast_request::Continuation;
use super::law::Law;
use super::options::FitOptions;
use super::student::{normal_quantile, student_quantile};

/// Degrees of freedom of the prior on a law's own interval, ν₀: chosen by convention; the resulting
/// coverage of forecasts is measured in docs/src/science/creep.md.
pub const PRIOR_FREEDOM: f64 = 2.0;
/// Maximum number of back-tests, each ending where the held-out part of the previous one started.
const MAX_BACKTESTS: usize = 2;
/// Smallest and largest time ratio of a back-test.
const TIME_RATIO: (f64, f64) = (1.5, 3.0);
/// Minimum number of measurements in the fitted part and in the held-out part.
const MIN_MEASUREMENTS: (usize, usize) = (10, 2);

/// Forecasts of one curve by several laws, and combined.
#[derive(Debug, Clone)]
pub struct ForecastSet {
    /// Forecast of each fitted law, in the requested order, then the failed ones.
    pub laws: Vec<(Law, Result<Forecast, CreepError>)>,
    /// Forecast of all fitted laws, weighted by their Akaike weights; `None` without any.
    pub combined: Option<Forecast>,
    /// Factor by which the combined interval was widened.
    pub widened: f64,
    /// Number of back-tests that the record had measurements for.
    pub backtests: usize,
}

/// Squared errors z² of one back-test per law, and of all combined.
struct BacktestErrors {
    laws: Vec<(Law, f64)>,
    combined: Option<f64>,
}

impl ForecastSet {
    /// Fits `laws` to curves and forecasts the one with index `index` at increasing times after its
    /// last measurement.
    pub fn new(
        laws: &[Law],
        curves: &[Curve],
        index: usize,
        options: &FitOptions,
        time_s: &[f64],
    ) -> ForecastSet {
        let (mut fits, mut failed) = (Vec::new(), Vec::new());
        for law in laws {
            match fit(*law, curves, options) {
                Ok(fit) => fits.push(fit),
                Err(error) => failed.push((*law, Err(error))),
            }
        }
        let mut outlook = ForecastSet::of(&fits, curves, index, options, time_s);
        outlook.laws.extend(failed);
        outlook
    }

    /// Forecasts with laws that are fitted already.
    pub fn of(
        fits: &[Fit],
        curves: &[Curve],
        index: usize,
        options: &FitOptions,
        time_s: &[f64],
    ) -> ForecastSet {
        ForecastSet::under(
            fits,
            curves,
            index,
            Continuation::AsRecorded,
            options,
            time_s,
        )
    }

    /// Forecasts under other loads.
    pub(super) fn under(
        fits: &[Fit],
        curves: &[Curve],
        index: usize,
        continuation: Continuation,
        options: &FitOptions,
        time_s: &[f64],
    ) -> ForecastSet {
        let laws: Vec<Law> = fits.iter().map(|f| f.law).collect();
        let mut tested = curves.to_vec();
        if let Some(curve) = tested.get_mut(index) {
            *curve = continuation.backtest_curve(curve);
        }
        let missed = backtest(&laws, &tested, index, options, time_s);
        let of_law = |law: Law| {
            let own = missed
                .iter()
                .filter_map(|m| m.laws.iter().find(|l| l.0 == law));
            factor(&own.map(|l| l.1).collect::<Vec<_>>(), options.level)
        };
        let together: Vec<f64> = missed.iter().filter_map(|m| m.combined).collect();
        let widened = factor(&together, options.level);
        let extrapolation = tested.get(index);
        let extrapolation =
            extrapolation.and_then(|curve| Extrapolation::of(curve, continuation, options.level));
        let far = |fits: &[Fit], factor: f64| {
            let forecast = Forecast::under(fits, index, continuation, time_s).widened(factor);
            match &extrapolation {
                Some(extrapolation) => extrapolation.widened(forecast),
                None => forecast,
            }
        };
        let alone = fits.chunks(1).zip(&laws);
        ForecastSet {
            laws: alone
                .map(|(fit, law)| (*law, Ok(far(fit, of_law(*law)))))
                .collect(),
            combined: (!fits.is_empty()).then(|| far(fits, widened)),
            widened,
            backtests: together.len(),
        }
    }
}

/// Widening of a forecast far beyond the record.
///
/// Back-tests cover up to three times the record. Beyond that, retardation times longer than the
/// record may appear: a decade may add or remove as much creep as a decade of the record did on
/// average (one standard deviation), fully correlated between decades.
struct Extrapolation {
    start_s: f64,
    span_s: f64,
    /// Strain at the record's end, m/m: under constant load creep does not reverse.
    end_strain: f64,
    /// Half-width of the interval per decade beyond, m/m.
    per_decade: f64,
    /// Whether another load is requested: then creep is proportional to the strain.
    instead: bool,
}

impl Extrapolation {
    /// Computes the widening; `None` for a curve without measurements under load.
    fn of(curve: &Curve, continuation: Continuation, level: f64) -> Option<Self> {
        let start_s = curve.steps.first().map_or(0.0, |s| s.0);
        let mut under_load = (curve.time_s.iter().zip(&curve.strain)).filter(|r| *r.0 > start_s);
        let (first_s, first) = under_load.next()?;
        let (last_s, last) = under_load.next_back().unwrap_or((first_s, first));
        let span_s = last_s - start_s;
        let decades = (span_s / (first_s - start_s)).log10().max(1.0);
        Some(Self {
            start_s,
            span_s,
            end_strain: *last,
            per_decade: normal_quantile(0.5 + 0.5 * level) * (last - first).abs() / decades,
            instead: matches!(continuation, Continuation::Instead { .. }),
        })
    }

    fn widened(&self, mut forecast: Forecast) -> Forecast {
        for (i, t) in forecast.time_s.iter().enumerate() {
            let decades = ((t - self.start_s) / self.span_s).log10() - TIME_RATIO.1.log10();
            if !(decades > 0.0) {
                continue;
            }
            let middle = forecast.strain_ratio[i];
            let (share, end) = match self.instead {
                true => ((middle / self.end_strain).abs(), f64::NEG_INFINITY),
                false => (1.0, self.end_strain),
            };
            let more = decades * share * self.per_decade;
            for low in [
                &mut forecast.low_strain_ratio[i],
                &mut forecast.reading_low_strain_ratio[i],
            ] {
                let least = low.min(end);
                *low = (middle - (middle - *low).hypot(more)).max(least);
            }
            for high in [
                &mut forecast.high_strain_ratio[i],
                &mut forecast.reading_high_strain_ratio[i],
            ] {
                *high = middle + (*high - middle).hypot(more);
            }
        }
        forecast
    }
}

/// Factor by which an interval is widened, from the squared errors of the back-tests.
fn factor(squares: &[f64], level: f64) -> f64 {
    let freedom = PRIOR_FREEDOM + squares.len() as f64;
    let scale = (PRIOR_FREEDOM + squares.iter().sum::<f64>()) / freedom;
    let own = normal_quantile(0.5 + 0.5 * level);
    student_quantile(freedom, level) / own * scale.sqrt()
}

fn backtest(
    laws: &[Law],
    curves: &[Curve],
    index: usize,
    options: &FitOptions,
    time_s: &[f64],
) -> Vec<BacktestErrors> {
    let Some(curve) = curves.get(index) else {
        return Vec::new();
    };
    let start = curve.steps.first().map_or(0.0, |s| s.0);
    let span = curve.time_s.last().map_or(0.0, |t| t - start);
    let requested = time_s.last().map_or(0.0, |t| t - start) / span;
    let ratio = requested.clamp(TIME_RATIO.0, TIME_RATIO.1);
    let mut missed = Vec::new();
    let mut end = span;
    for _ in 0..MAX_BACKTESTS {
        let cut = end / ratio;
        let parts: Vec<(Curve, Curve)> = curves
            .iter()
            .map(|c| {
                let (before, _) = c.split(start + end);
                before.split(start + cut)
            })
            .collect();
        end = cut;
        let hidden = &parts[index].1;
        if parts[index].0.time_s.len() < MIN_MEASUREMENTS.0
            || hidden.time_s.len() < MIN_MEASUREMENTS.1
        {
            break;
        }
        let seen: Vec<Curve> = parts
            .iter()
            .map(|p| p.0.clone())
            .filter(|c| !c.time_s.is_empty())
            .collect();
        // Index of the curve among those that had started.
        let own = parts[..index]
            .iter()
            .filter(|p| !p.0.time_s.is_empty())
            .count();
        let fits: Vec<Fit> = laws
            .iter()
            .filter_map(|law| fit(*law, &seen, options).ok())
            .collect();
        let squared_error = |fits: &[Fit]| {
            let forecast = Forecast::under(fits, own, Continuation::AsRecorded, &hidden.time_s);
            mean_square(&forecast, &hidden.strain, options.level)
        };
        missed.push(BacktestErrors {
            laws: fits
                .chunks(1)
                .map(|f| (f[0].law, squared_error(f)))
                .collect(),
            combined: (!fits.is_empty()).then(|| squared_error(&fits)),
        });
    }
    missed
}

/// Mean square of errors over the standard deviation of the measurements' interval.
fn mean_square(forecast: &Forecast, strain: &[f64], level: f64) -> f64 {
    let quantile = normal_quantile(0.5 + 0.5 * level);
    let square = |(i, truth): (usize, &f64)| {
        let apart = truth - forecast.strain_ratio[i];
        let side = if apart > 0.0 {
            forecast.reading_high_strain_ratio[i] - forecast.strain_ratio[i]
        } else {
            forecast.strain_ratio[i] - forecast.reading_low_strain_ratio[i]
        };
        (quantile * apart / side.max(f64::MIN_POSITIVE)).powi(2)
    };
    strain.iter().enumerate().map(square).sum::<f64>() / strain.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_widens_and_missing_backtest_is_widest() {
        let kept = factor(&[0.3, 0.3], 0.95);
        let missed = factor(&[9.0, 9.0], 0.95);
        // t₄ = 2.776; √((2 + 0.6)/4), √((2 + 18)/4).
        assert!((kept - 2.776_4 / 1.959_96 * 0.65_f64.sqrt()).abs() < 1e-3);
        assert!((missed - 2.776_4 / 1.959_96 * 5.0_f64.sqrt()).abs() < 1e-3);
        assert!(factor(&[], 0.95) > 2.0);
        // An exact back-test narrows by a hundredth at most.
        assert!(factor(&[0.0, 0.0], 0.95) > 0.99);
    }

    // A single held-out measurement does not determine the model error; two do.
    #[test]
    fn backtest_needs_two_held_out_measurements() {
        let backtests = |ends: &[f64]| {
            let seen = (1..=12).map(|k| 2.5 * f64::from(k));
            let time_s: Vec<f64> = seen.chain(ends.iter().copied()).collect();
            let strain = time_s.iter().map(|t| 1e-3 * (1.0 + t / 5.0).ln()).collect();
            let curve = Curve::constant_load("short", time_s, strain);
            let options = FitOptions::default();
            ForecastSet::new(&[Law::LogTime], &[curve], 0, &options, &[300.0]).backtests
        };
        assert_eq!(backtests(&[100.0]), 0);
        assert_eq!(backtests(&[98.0, 100.0]), 1);
    }
}
