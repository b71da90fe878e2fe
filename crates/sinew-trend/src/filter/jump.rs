//! Size estimate of a step change.

use super::bank::Bank;
use super::component::STATES;
use super::gauss::LogSum;
use super::prior::Prior;
use super::record::{Record, TrendConfig, TrendEntry};
use sinew_model::Gaussian;

/// Estimates the size of a step change just before the first of `entries`, rad, with prior standard
/// deviation `std_rad`.
///
/// Per filter the innovations respond to a unit step by `d_k`, found by passing a unit of level
/// through the same gains: precision `1/V + Σ d_k²/S_k`, mean `Σ d_k ν_k/S_k` over that.
pub(super) fn jump_size(
    bank: &Bank,
    prior: &Prior,
    entries: &[TrendEntry],
    std_rad: f64,
    config: &TrendConfig,
) -> Gaussian {
    let records: Vec<&Record> = entries
        .iter()
        .filter_map(|e| match e {
            TrendEntry::Record(r) if r.offset_rad.is_some() => Some(r),
            _ => None,
        })
        .collect();
    let inverse = 1.0 / (std_rad * std_rad);
    let mut bank = bank.clone();
    bank.forget_stiffness();
    let mut answers: Vec<[f64; STATES]> = bank.components.iter().map(|_| UNIT).collect();
    let mut sums: Vec<[f64; 2]> = bank.components.iter().map(|_| [inverse, 0.0]).collect();
    for record in records {
        let passing = bank.passing(prior, record.time_s);
        for (c, answer) in bank.components.iter().zip(&mut answers) {
            passing.apply(c, answer);
        }
        bank.advance(prior, record.time_s);
        bank.answer(prior, record, config, &mut answers, &mut sums);
    }
    let mut all = LogSum::new();
    let weights: Vec<f64> = bank
        .components
        .iter()
        .zip(&sums)
        .map(|(c, [precision, dv])| {
            // Evidence of the step change under this filter: its Gaussian integral over the size.
            c.log_weight + 0.5 * (dv * dv / precision - libm::log(*precision))
        })
        .collect();
    weights.iter().for_each(|w| all.add(*w));
    let (mut mean, mut square) = (0.0, 0.0);
    for (w, [precision, dv]) in weights.iter().zip(&sums) {
        let share = libm::exp(w - all.value());
        let size = dv / precision;
        mean += share * size;
        square += share * (size * size + 1.0 / precision);
    }
    Gaussian::new(mean, libm::sqrt((square - mean * mean).max(0.0)))
}

/// State vector with a unit of level.
const UNIT: [f64; STATES] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
