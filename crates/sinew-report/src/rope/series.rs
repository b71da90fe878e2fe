//! Predicted elongation over time as a table.

use crate::data::Data;
use sinew_log::Table;
use sinew_model::Bounded;
use sinew_rope::predict::{PredictedElongation, Prediction};

/// Number of points of a curve per decade of time.
const PER_DECADE: f64 = 20.0;

/// Returns the times of a curve, s: logarithmically spaced from one minute to the last of `wanted`, including `wanted`.
///
/// Intermediate times are at ends of cycles of `cycle_s`, so that the curve shows creep and not the phase of the cycle.
pub fn curve_times(wanted: &[f64], cycle_s: f64) -> Vec<f64> {
    const FROM_S: f64 = 60.0;
    let last_s = wanted.iter().copied().fold(0.0, f64::max);
    let steps = (PER_DECADE * (last_s / FROM_S).log10()).floor().max(0.0) as usize;
    let grid = (0..=steps).map(|k| FROM_S * 10.0_f64.powf(k as f64 / PER_DECADE));
    let at_end = |t: f64| match t > 2.0 * cycle_s {
        true => (t / cycle_s).round() * cycle_s,
        false => t,
    };
    let mut times: Vec<f64> = grid.map(at_end).filter(|t| *t < last_s).collect();
    times.extend(wanted);
    times.sort_by(f64::total_cmp);
    times.dedup_by(|a, b| (*a - *b).abs() < 1e-6 * *b);
    times
}

/// Tabulates strain and elongation with 95 % intervals, one row per time under the duty.
pub fn prediction_series(p: &Prediction) -> Table {
    let names =
        |name: &str, unit: &str| ["", "_low", "_high"].map(|end| format!("{name}{end}_{unit}"));
    type Quantity = (
        &'static str,
        &'static str,
        fn(&PredictedElongation) -> Bounded,
    );
    let quantities: [Quantity; 4] = [
        ("strain", "ratio", |r| r.strain_ratio),
        ("elongation", "m", |r| r.elongation_m),
        ("since_tensioned", "m", |r| r.since_tensioned_m),
        ("irreversible", "m", |r| r.irreversible_m),
    ];
    let mut data = Data::of(&p.readings)
        .text("rope", |_| p.rope.as_str())
        .number("time_s", |r| r.time_s);
    for (name, unit, of) in quantities {
        let names = names(name, unit);
        data = data.bounded(names.each_ref().map(String::as_str), |r| Some(of(r)));
    }
    data.number("broken_share", |r| r.broken_share).table()
}
