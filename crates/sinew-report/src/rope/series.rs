//! A prediction as a curve.

use sinew_log::{Cell, CellKind, Table};
use sinew_model::Bounded;
use sinew_rope::predict::Prediction;

/// Points of a curve per tenfold of time.
const PER_DECADE: f64 = 20.0;

/// Times of a curve that ends at the last of `wanted`, evenly spread over the logarithm from a minute on, s;
/// `wanted` are among them. Those between lie at the ends of cycles of `cycle_s`, so that the curve shows how a
/// rope creeps, not where in its cycle it was looked at.
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

/// A row per time under the duty: strain and elongation with their 95 % intervals.
pub fn prediction_series(p: &Prediction) -> Table {
    let mut columns = vec![
        ("rope".to_owned(), CellKind::Text),
        ("time_s".to_owned(), CellKind::Number),
    ];
    for (name, unit) in [
        ("strain", "ratio"),
        ("elongation", "m"),
        ("since_tensioned", "m"),
        ("irreversible", "m"),
    ] {
        for part in ["", "_low", "_high"] {
            columns.push((format!("{name}{part}_{unit}"), CellKind::Number));
        }
    }
    columns.push(("broken_share".to_owned(), CellKind::Number));
    let mut table = Table {
        columns,
        rows: Vec::new(),
    };
    for r in &p.readings {
        let mut row: Vec<Cell> = vec![p.rope.as_str().into(), r.time_s.into()];
        for Bounded { value, low, high } in [
            r.strain_ratio,
            r.elongation_m,
            r.since_tensioned_m,
            r.irreversible_m,
        ] {
            row.extend([value, low, high].map(Cell::Number));
        }
        row.push(r.broken_share.into());
        table.push(row);
    }
    table
}
