//! Forecasts that were rehearsed: each law forecasts the end of its own record first, and where it
//! missed, its interval is widened.
//!
//! What a law's own interval can't know is how wrong the law is. With `z_k` the root mean square
//! of the rehearsals' errors over what the interval allows, an interval `±q σ` becomes
//!
//! ```text
//! ± t_ν q' σ s,   s² = (ν₀ + Σ z_k²)/(ν₀ + K),   ν = ν₀ + K
//! ```
//!
//! the quantile of Student's distribution for a scale known from `K` rehearsals and a prior of
//! [`PRIOR_FREEDOM`] degrees of freedom that trusts the law's own `σ`.

use super::ahead::Ahead;
use super::curve::Curve;
use super::error::CreepError;
use super::fit::{Fit, fit};
use super::forecast::Forecast;
use super::law::Law;
use super::options::FitOptions;
use super::student::{normal_quantile, student_quantile};

/// Degrees of freedom of the trust in a law's own interval, ν₀: a choice of ours; how often
/// forecasts then hold is measured in docs/src/science/creep.md.
pub const PRIOR_FREEDOM: f64 = 2.0;
/// Rehearsals, each from where the one before began to be hidden.
const REHEARSALS: usize = 2;
/// Smallest and largest ratio of times of a rehearsal.
const RATIO: (f64, f64) = (1.5, 3.0);
/// Readings that must be left to fit, and to forecast.
const FEWEST: (usize, usize) = (10, 2);

/// Forecasts of one curve by several laws, and by all of them.
#[derive(Debug, Clone)]
pub struct Outlook {
    /// Laws that could be fitted, in the order asked for, then the others.
    pub laws: Vec<(Law, Result<Forecast, CreepError>)>,
    /// All that could be fitted, with their Akaike weights; `None` without any.
    pub combined: Option<Forecast>,
    /// Factor by which the combined interval was widened.
    pub widened: f64,
    /// Rehearsals that the record had readings for.
    pub rehearsals: usize,
}

/// What the forecasts of one rehearsal missed: z² per law, and of all together.
struct Missed {
    laws: Vec<(Law, f64)>,
    combined: Option<f64>,
}

impl Outlook {
    /// Fits `laws` to curves and forecasts the one with index `index` at rising times after its
    /// last reading.
    pub fn new(
        laws: &[Law],
        curves: &[Curve],
        index: usize,
        options: &FitOptions,
        time_s: &[f64],
    ) -> Outlook {
        let (mut fits, mut failed) = (Vec::new(), Vec::new());
        for law in laws {
            match fit(*law, curves, options) {
                Ok(fit) => fits.push(fit),
                Err(error) => failed.push((*law, Err(error))),
            }
        }
        let mut outlook = Outlook::of(&fits, curves, index, options, time_s);
        outlook.laws.extend(failed);
        outlook
    }

    /// The same for laws that are fitted already.
    pub fn of(
        fits: &[Fit],
        curves: &[Curve],
        index: usize,
        options: &FitOptions,
        time_s: &[f64],
    ) -> Outlook {
        Outlook::under(fits, curves, index, Ahead::AsRecorded, options, time_s)
    }

    /// The same under other loads.
    pub(super) fn under(
        fits: &[Fit],
        curves: &[Curve],
        index: usize,
        ahead: Ahead,
        options: &FitOptions,
        time_s: &[f64],
    ) -> Outlook {
        let laws: Vec<Law> = fits.iter().map(|f| f.law).collect();
        let mut rehearsed = curves.to_vec();
        if let Some(curve) = rehearsed.get_mut(index) {
            *curve = ahead.rehearsed(curve);
        }
        let missed = rehearse(&laws, &rehearsed, index, options, time_s);
        let of_law = |law: Law| {
            let own = missed
                .iter()
                .filter_map(|m| m.laws.iter().find(|l| l.0 == law));
            factor(&own.map(|l| l.1).collect::<Vec<_>>(), options.level)
        };
        let together: Vec<f64> = missed.iter().filter_map(|m| m.combined).collect();
        let widened = factor(&together, options.level);
        let beyond = rehearsed.get(index);
        let beyond = beyond.and_then(|curve| Beyond::of(curve, ahead, options.level));
        let far = |fits: &[Fit], factor: f64| {
            let forecast = Forecast::under(fits, index, ahead, time_s).widened(factor);
            match &beyond {
                Some(beyond) => beyond.widened(forecast),
                None => forecast,
            }
        };
        let alone = fits.chunks(1).zip(&laws);
        Outlook {
            laws: alone
                .map(|(fit, law)| (*law, Ok(far(fit, of_law(*law)))))
                .collect(),
            combined: (!fits.is_empty()).then(|| far(fits, widened)),
            widened,
            rehearsals: together.len(),
        }
    }
}

/// What no reading says of times far beyond the record.
///
/// Rehearsals speak for three times the record. From then on any retardation time may come that the record was too short to
/// show, so that a decade may bring as much creep more or less as the record's decades brought on average: one standard
/// deviation, and the decades go together.
struct Beyond {
    start_s: f64,
    span_s: f64,
    /// Strain at the record's end, m/m: under a load that stays, creep doesn't come back.
    end_strain: f64,
    /// Half an interval for every decade beyond, m/m.
    per_decade: f64,
    /// Whether it is another load that is asked for: then creep goes with the strain.
    instead: bool,
}

impl Beyond {
    /// None of a curve without readings under load.
    fn of(curve: &Curve, ahead: Ahead, level: f64) -> Option<Self> {
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
            instead: matches!(ahead, Ahead::Instead { .. }),
        })
    }

    fn widened(&self, mut forecast: Forecast) -> Forecast {
        for (i, t) in forecast.time_s.iter().enumerate() {
            let decades = ((t - self.start_s) / self.span_s).log10() - RATIO.1.log10();
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

/// How much wider an interval must be.
fn factor(squares: &[f64], level: f64) -> f64 {
    let freedom = PRIOR_FREEDOM + squares.len() as f64;
    let scale = (PRIOR_FREEDOM + squares.iter().sum::<f64>()) / freedom;
    let own = normal_quantile(0.5 + 0.5 * level);
    student_quantile(freedom, level) / own * scale.sqrt()
}

fn rehearse(
    laws: &[Law],
    curves: &[Curve],
    index: usize,
    options: &FitOptions,
    time_s: &[f64],
) -> Vec<Missed> {
    let Some(curve) = curves.get(index) else {
        return Vec::new();
    };
    let start = curve.steps.first().map_or(0.0, |s| s.0);
    let span = curve.time_s.last().map_or(0.0, |t| t - start);
    let asked = time_s.last().map_or(0.0, |t| t - start) / span;
    let ratio = asked.clamp(RATIO.0, RATIO.1);
    let mut missed = Vec::new();
    let mut end = span;
    for _ in 0..REHEARSALS {
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
        if parts[index].0.time_s.len() < FEWEST.0 || hidden.time_s.len() < FEWEST.1 {
            break;
        }
        let seen: Vec<Curve> = parts
            .iter()
            .map(|p| p.0.clone())
            .filter(|c| !c.time_s.is_empty())
            .collect();
        // The curve's own place among those that had begun.
        let own = parts[..index]
            .iter()
            .filter(|p| !p.0.time_s.is_empty())
            .count();
        let fits: Vec<Fit> = laws
            .iter()
            .filter_map(|law| fit(*law, &seen, options).ok())
            .collect();
        let judge = |fits: &[Fit]| {
            let forecast = Forecast::under(fits, own, Ahead::AsRecorded, &hidden.time_s);
            mean_square(&forecast, &hidden.strain, options.level)
        };
        missed.push(Missed {
            laws: fits.chunks(1).map(|f| (f[0].law, judge(f))).collect(),
            combined: (!fits.is_empty()).then(|| judge(&fits)),
        });
    }
    missed
}

/// Mean square of errors over the standard deviation that the interval for readings stands for.
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
    fn a_miss_widens_and_a_record_without_rehearsal_is_least_trusted() {
        let kept = factor(&[0.3, 0.3], 0.95);
        let missed = factor(&[9.0, 9.0], 0.95);
        // t₄ = 2.776; √((2 + 0.6)/4), √((2 + 18)/4).
        assert!((kept - 2.776_4 / 1.959_96 * 0.65_f64.sqrt()).abs() < 1e-3);
        assert!((missed - 2.776_4 / 1.959_96 * 5.0_f64.sqrt()).abs() < 1e-3);
        assert!(factor(&[], 0.95) > 2.0);
        // A rehearsal that came out exact never narrows by more than a hundredth.
        assert!(factor(&[0.0, 0.0], 0.95) > 0.99);
    }

    /// A single reading that is hidden says nothing of how wrong a law is; two do.
    #[test]
    fn a_rehearsal_has_two_readings_to_foretell() {
        let rehearsals = |ends: &[f64]| {
            let seen = (1..=12).map(|k| 2.5 * f64::from(k));
            let time_s: Vec<f64> = seen.chain(ends.iter().copied()).collect();
            let strain = time_s.iter().map(|t| 1e-3 * (1.0 + t / 5.0).ln()).collect();
            let curve = Curve::constant_load("short", time_s, strain);
            let options = FitOptions::default();
            Outlook::new(&[Law::LogTime], &[curve], 0, &options, &[300.0]).rehearsals
        };
        assert_eq!(rehearsals(&[100.0]), 0);
        assert_eq!(rehearsals(&[98.0, 100.0]), 1);
    }
}
