//! Tables for other programs: %, h and °C as laboratories write them, units in the column names.

use super::words::{fault, group, interval_kind, open, scatter_source};
use sinew_creep::{
    AnalyzeReport, CompareReport, FitReport, PERCENT_PER_H, ShiftReport, WithheldReport,
};
use sinew_log::{Cell, CellKind, Table};
use sinew_model::Bounded;

/// A table whose columns hold numbers unless they are among `text`, or among what is counted.
fn table(columns: &[&str], text: &[&str]) -> Table {
    const COUNTS: [&str; 4] = ["rank", "specimens", "tests", "failed"];
    let kind = |name| match name {
        name if text.contains(name) => CellKind::Text,
        name if COUNTS.contains(name) => CellKind::Integer,
        _ => CellKind::Number,
    };
    let columns: Vec<_> = columns.iter().map(|name| (*name, kind(name))).collect();
    Table::new(&columns)
}

/// Value and bounds.
fn bounded(x: Option<Bounded>) -> [Cell; 3] {
    [
        x.map(|x| x.value).into(),
        x.map(|x| x.low).into(),
        x.map(|x| x.high).into(),
    ]
}

/// A row from parts of several cells.
fn row<const N: usize>(parts: [&[Cell]; N]) -> Vec<Cell> {
    parts.concat()
}

/// One row per specimen.
pub fn analyze_csv(report: &AnalyzeReport) -> Table {
    let columns = [
        "specimen",
        "group",
        "force_n",
        "stress_mpa",
        "temperature_c",
        "humidity_percent",
        "duration_s",
        "end_percent",
        "creep_percent",
        "slope_percent_per_h",
        "slope_low",
        "slope_high",
        "saturation_s",
        "saturated",
        "faults",
    ];
    let mut out = table(&columns, &["specimen", "group", "saturated", "faults"]);
    for a in &report.specimens {
        let faults: Vec<String> = a.faults.iter().map(fault).collect();
        out.push(row([
            &[
                a.name.as_str().into(),
                group(&a.group).into(),
                a.force_n.into(),
                a.stress_pa.map(|s| s * 1e-6).into(),
                a.temperature_c.map(|t| t.mean).into(),
                a.humidity_percent.map(|h| h.mean).into(),
                a.duration_s.into(),
                (100.0 * a.end_strain_ratio).into(),
                (100.0 * a.creep_strain_ratio).into(),
            ],
            &bounded(a.slope_per_s.map(|s| s.scaled(PERCENT_PER_H))),
            &[
                a.saturation_s.into(),
                a.saturated.map(|s| s.to_string()).into(),
                faults.join("; ").into(),
            ],
        ]));
    }
    out
}

/// One row per rope.
pub fn compare_csv(report: &CompareReport) -> Table {
    let columns = [
        "rank",
        "rope",
        "specimens",
        "strain_percent",
        "strain_low",
        "strain_high",
        "slope_percent_per_h",
        "slope_low",
        "slope_high",
        "scatter_share",
        "scatter_source",
    ];
    let mut out = table(&columns, &["rope", "scatter_source"]);
    for r in &report.ranks {
        out.push(row([
            &[r.rank.into(), r.name.as_str().into(), r.specimens.into()],
            &bounded(Some(r.strain_ratio.scaled(100.0))),
            &bounded(r.slope_per_s.map(|s| s.scaled(PERCENT_PER_H))),
            &[
                r.scatter_share.into(),
                scatter_source(r.scatter_source).into(),
            ],
        ]));
    }
    out
}

/// One row per parameter of every law.
pub fn fit_csv(report: &FitReport) -> Table {
    let columns = [
        "name",
        "law",
        "aicc",
        "bic",
        "parameter",
        "specimen",
        "unit",
        "value",
        "std_error",
        "low",
        "high",
        "interval",
        "not_identifiable",
    ];
    let words = [
        "name",
        "law",
        "parameter",
        "specimen",
        "unit",
        "interval",
        "not_identifiable",
    ];
    let mut out = table(&columns, &words);
    for set in &report.fits {
        for f in &set.laws {
            for p in &f.parameters {
                out.push(vec![
                    set.name.as_str().into(),
                    f.law.name().into(),
                    f.aicc.into(),
                    f.bic.into(),
                    p.name.as_str().into(),
                    p.specimen.as_deref().into(),
                    p.unit.as_str().into(),
                    p.value.into(),
                    p.std_error.into(),
                    p.low.into(),
                    p.high.into(),
                    interval_kind(p.interval).into(),
                    p.not_identifiable.map(|what| open(what, &p.unit)).into(),
                ]);
            }
        }
    }
    out
}

/// One row per law.
pub fn withhold_csv(report: &WithheldReport) -> Table {
    let columns = [
        "law",
        "tests",
        "failed",
        "readings_percent",
        "end_percent",
        "end_error_percent",
        "end_half_width_percent",
    ];
    let mut out = table(&columns, &["law"]);
    for c in &report.withheld {
        let ends = c.ends_share();
        out.push(vec![
            c.forecaster.name().into(),
            c.tests.into(),
            c.failed.into(),
            c.readings_share().map(|s| 100.0 * s).into(),
            ends.map(|s| 100.0 * s).into(),
            ends.map(|_| 100.0 * c.end_error_ratio).into(),
            ends.map(|_| 100.0 * c.end_half_width_ratio).into(),
        ]);
    }
    out
}

/// One row per temperature.
pub fn shift_csv(report: &ShiftReport) -> Table {
    let columns = ["temperature_c", "log10_a_t", "std_error", "overlap"];
    let mut out = table(&columns, &[]);
    for s in &report.superposition.shifts {
        out.push(vec![
            s.temperature_c.into(),
            s.log10_a_t.mean.into(),
            s.log10_a_t.deviation.into(),
            s.overlap_share.into(),
        ]);
    }
    out
}
