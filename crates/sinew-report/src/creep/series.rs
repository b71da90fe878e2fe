//! Creep tests over time as tables in SI units.

use crate::data::Data;
use sinew_creep::{FitReport, Tests};
use sinew_log::Table;

/// Tabulates the prepared measurements of every specimen: strain from its zero, time since loading, artefacts removed.
pub fn readings_series(tests: &Tests) -> Table {
    let tests = tests.prepared.iter();
    let readings = tests.flat_map(|test| {
        let curve = &test.curve;
        let readings = curve.time_s.iter().zip(&curve.strain);
        readings.map(move |(time_s, strain)| (test, *time_s, *strain))
    });
    Data::of(readings)
        .text("specimen", |(test, ..)| test.name.as_str())
        .text("group", |(test, ..)| test.group.as_deref())
        .number("time_s", |(_, time_s, _)| *time_s)
        .number("strain_ratio", |(_, _, strain)| *strain)
        .number("force_n", |(test, time_s, _)| {
            let curve = &test.curve;
            let step = curve.steps.iter().rev().find(|(from, _)| from <= time_s);
            let factor = step.map_or(0.0, |(_, factor)| *factor);
            let tension = curve.tension.as_ref();
            tension.map(|t| t.preload_n + t.per_step_n * factor)
        })
        .number("temperature_c", |(test, ..)| test.curve.temperature_c)
        .table()
}

/// Tabulates measurements and forecasts (`kind`).
///
/// `reading_low_ratio` and `reading_high_ratio` bound the 95 % prediction interval of a measurement, `strain_low_ratio`
/// and `strain_high_ratio` the 95 % interval of the strain of the law.
pub fn fit_series(report: &FitReport, tests: &Tests) -> Table {
    let readings = tests.prepared.iter().flat_map(|test| {
        let curve = test.curve.time_s.iter().zip(&test.curve.strain);
        curve.map(move |(time_s, strain)| (&test.name, *time_s, *strain, None))
    });
    let forecasts = report.fits.iter().flat_map(|set| {
        let forecasts = set.forecast.iter();
        forecasts.flat_map(move |f| {
            let times = f.time_s.iter().enumerate();
            times.map(move |(k, time_s)| (&set.name, *time_s, f.strain_ratio[k], Some((f, k))))
        })
    });
    Data::of(readings.chain(forecasts))
        .text("name", |row| row.0.as_str())
        .text("kind", |row| match row.3 {
            Some(_) => "forecast",
            None => "reading",
        })
        .number("time_s", |row| row.1)
        .number("strain_ratio", |row| row.2)
        .number("strain_low_ratio", |row| {
            row.3.map(|(f, k)| f.low_strain_ratio[k])
        })
        .number("strain_high_ratio", |row| {
            row.3.map(|(f, k)| f.high_strain_ratio[k])
        })
        .number("reading_low_ratio", |row| {
            row.3.map(|(f, k)| f.reading_low_strain_ratio[k])
        })
        .number("reading_high_ratio", |row| {
            row.3.map(|(f, k)| f.reading_high_strain_ratio[k])
        })
        .table()
}
