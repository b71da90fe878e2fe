//! Creep tests over time as tables in SI.

use sinew_creep::{FitReport, Tests};
use sinew_log::{Cell, CellKind, Table};

/// Readings of every specimen as they are fitted: strain from its zero, time from the load on, faults taken out.
pub fn readings_series(tests: &Tests) -> Table {
    let mut table = Table::new(&[
        ("specimen", CellKind::Text),
        ("group", CellKind::Text),
        ("time_s", CellKind::Number),
        ("strain_ratio", CellKind::Number),
        ("force_n", CellKind::Number),
        ("temperature_c", CellKind::Number),
    ]);
    for test in &tests.prepared {
        let curve = &test.curve;
        for (time_s, strain) in curve.time_s.iter().zip(&curve.strain) {
            let step = curve.steps.iter().rev().find(|(from, _)| from <= time_s);
            let factor = step.map_or(0.0, |(_, factor)| *factor);
            let force_n = (curve.tension.as_ref()).map(|t| t.preload_n + t.per_step_n * factor);
            table.push(vec![
                test.name.as_str().into(),
                test.group.as_deref().into(),
                (*time_s).into(),
                (*strain).into(),
                force_n.into(),
                curve.temperature_c.into(),
            ]);
        }
    }
    table
}

/// Readings and forecasts (`kind`). A reading to come lies within `reading_low_ratio` and `reading_high_ratio`, the
/// law's strain within `strain_low_ratio` and `strain_high_ratio`.
pub fn fit_series(report: &FitReport, tests: &Tests) -> Table {
    let mut table = Table::new(&[
        ("name", CellKind::Text),
        ("kind", CellKind::Text),
        ("time_s", CellKind::Number),
        ("strain_ratio", CellKind::Number),
        ("strain_low_ratio", CellKind::Number),
        ("strain_high_ratio", CellKind::Number),
        ("reading_low_ratio", CellKind::Number),
        ("reading_high_ratio", CellKind::Number),
    ]);
    let width = table.columns.len();
    for test in &tests.prepared {
        for (time_s, strain) in test.curve.time_s.iter().zip(&test.curve.strain) {
            let mut row: Vec<Cell> = vec![
                test.name.as_str().into(),
                "reading".into(),
                (*time_s).into(),
                (*strain).into(),
            ];
            row.resize(width, Cell::Empty);
            table.push(row);
        }
    }
    for set in &report.fits {
        let Some(f) = &set.forecast else { continue };
        for (k, time_s) in f.time_s.iter().enumerate() {
            table.push(vec![
                set.name.as_str().into(),
                "forecast".into(),
                (*time_s).into(),
                f.strain_ratio[k].into(),
                f.low_strain_ratio[k].into(),
                f.high_strain_ratio[k].into(),
                f.reading_low_strain_ratio[k].into(),
                f.reading_high_strain_ratio[k].into(),
            ]);
        }
    }
    table
}
