//! Terminal tables of analyses, comparisons, withheld ends and shifts.

use super::words::{fault, group, reading_time, zero};
use crate::text::{paragraph, plain, short, table};
use sinew_creep::{
    Analysis, AnalyzeReport, CompareReport, Coverage, Isochrone, LoadQuantity, PERCENT_PER_H, Rank,
    Scatter, ScatterSource, ShiftReport, WithheldReport,
};
use sinew_model::Bounded;

/// Specimens beyond which the terminal shows groups only.
const SHOWN: usize = 24;
/// Specimens beyond which the terminal leaves readings to the table file.
const READINGS_OF: usize = 3;

fn dash() -> String {
    "–".into()
}

/// A slope in %/h, and its interval.
fn slope(slope_per_s: Option<Bounded>) -> [String; 2] {
    slope_per_s.map_or([dash(), dash()], |s| {
        let s = s.scaled(PERCENT_PER_H);
        [
            short(s.value),
            format!("{} … {}", short(s.low), short(s.high)),
        ]
    })
}

/// Specimens, groups, readings, faults and isochrones.
pub fn analyze_table(report: &AnalyzeReport) -> String {
    let analyses = &report.specimens;
    let mut out = String::new();
    if analyses.len() <= SHOWN {
        out.push_str(&specimens(analyses));
    }
    if report.groups.len() > 1 || analyses.len() > SHOWN {
        out.push('\n');
        out.push_str(&groups(&report.groups));
    }
    if analyses.len() <= READINGS_OF {
        for a in analyses {
            out.push_str(&readings(a));
        }
    }
    out + &faults(analyses) + &isochrones(&report.isochrones)
}

fn specimens(analyses: &[Analysis]) -> String {
    let rows = analyses.iter().map(|a| {
        let [slope, range] = slope(a.slope_per_s);
        vec![
            plain(&a.name),
            a.force_n.map_or_else(dash, short),
            short(100.0 * a.end_strain_ratio),
            short(100.0 * a.creep_strain_ratio),
            slope,
            range,
            a.saturated
                .map_or("–", |s| if s { "yes" } else { "no" })
                .into(),
        ]
    });
    let head = [
        "specimen",
        "load, N",
        "end, %",
        "creep, %",
        "m_E, %/h",
        "interval",
        "saturated",
    ];
    table(&head, rows.collect(), 1)
}

fn groups(groups: &[Scatter]) -> String {
    let percent_per_h = |v: Option<f64>| v.map_or_else(dash, |v| short(PERCENT_PER_H * v));
    let rows = groups.iter().map(|g| {
        vec![
            plain(group(&g.group)),
            g.specimens.to_string(),
            short(100.0 * g.end_strain_ratio),
            g.end_deviation_ratio
                .map_or_else(dash, |d| short(100.0 * d)),
            percent_per_h(g.slope_per_s),
            percent_per_h(g.slope_deviation_per_s),
            g.apart.len().to_string(),
        ]
    });
    let head = [
        "group",
        "specimens",
        "end, %",
        "scatter, %",
        "m_E, %/h",
        "scatter",
        "apart",
    ];
    table(&head, rows.collect(), 1)
}

fn readings(a: &Analysis) -> String {
    let title = format!("{}, strain from: {}", a.name, zero(a.zero));
    let mut out = format!("\n{}", paragraph(&plain(&title), 0));
    let rows = a.readings.iter().map(|r| {
        vec![
            reading_time(r.time_s),
            format!("{:.4}", 100.0 * r.strain_ratio),
            r.modulus_pa.map_or_else(dash, |m| short(m * 1e-6)),
        ]
    });
    out.push_str(&table(
        &["time", "strain, %", "creep modulus, MPa"],
        rows.collect(),
        1,
    ));
    for r in &a.recovery {
        out.push_str(&paragraph(
            &format!(
                "from {} N to {} N: {:.4} % at once, {:.4} % within {} min, {:.4} % left",
                short(r.force_before_n),
                short(r.force_after_n),
                100.0 * r.at_once_strain_ratio,
                100.0 * r.delayed_strain_ratio,
                short(r.duration_s / 60.0),
                100.0 * r.residual_strain_ratio
            ),
            2,
        ));
    }
    out
}

/// Faults; one that every record has is listed once.
fn faults(analyses: &[Analysis]) -> String {
    let mut listed: Vec<(String, usize)> = Vec::new();
    for a in analyses {
        for f in &a.faults {
            let text = match f.time_s() {
                None => fault(f),
                Some(_) => format!("{}: {}", a.name, fault(f)),
            };
            match listed.iter_mut().find(|(t, _)| *t == text) {
                Some((_, count)) => *count += 1,
                None => listed.push((text, 1)),
            }
        }
    }
    let mut out = String::new();
    if !listed.is_empty() {
        out.push('\n');
    }
    for (text, count) in listed.iter().take(20) {
        let times = if *count > 1 {
            format!(" ({count} specimens)")
        } else {
            String::new()
        };
        out.push_str(&paragraph(&plain(&format!("- {text}{times}")), 2));
    }
    if listed.len() > 20 {
        out.push_str(&format!(
            "- and {} more (--csv, --json)\n",
            listed.len() - 20
        ));
    }
    out
}

/// One line per group and time, the times of a decade each.
fn isochrones(isochrones: &[Isochrone]) -> String {
    /// Readings of every group that the terminal shows.
    const TIMES: [f64; 5] = [60.0, 720.0, 3600.0, 36_000.0, 360_000.0];
    let rows: Vec<Vec<String>> = isochrones
        .iter()
        .filter(|i| TIMES.contains(&i.time_s))
        .map(|i| {
            vec![
                plain(group(&i.group)),
                reading_time(i.time_s),
                i.points.len().to_string(),
                secant(i, short),
                short(i.exponent.value),
                format!("{} … {}", short(i.exponent.low), short(i.exponent.high)),
            ]
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let head = ["group", "after", "n", "load per %", "p", "interval"];
    format!(
        "\nisochronous: strain against load at the same time, strain ∝ load^p\n\n{}",
        table(&head, rows, 1)
    )
}

/// Load per % of strain with its unit.
pub(super) fn secant(i: &Isochrone, number: fn(f64) -> String) -> String {
    match i.quantity {
        LoadQuantity::Stress => format!("{} MPa", number(1e-8 * i.secant)),
        LoadQuantity::Force => format!("{} N", number(0.01 * i.secant)),
    }
}

/// Ropes by their strain, and what the intervals of single specimens rest on.
pub fn compare_table(report: &CompareReport) -> String {
    let rows = report.ranks.iter().map(|r| {
        let strain = r.strain_ratio.scaled(100.0);
        let [slope, range] = slope(r.slope_per_s);
        vec![
            r.rank.to_string(),
            plain(&r.name),
            r.specimens.to_string(),
            format!("{:.4}", strain.value),
            format!("{:.4} … {:.4}", strain.low, strain.high),
            slope,
            range,
        ]
    });
    let head = [
        "rank",
        "rope",
        "n",
        "strain, %",
        "interval",
        "m_E, %/h",
        "interval",
    ];
    let at = report.ranks.first().map_or(f64::NAN, |r| r.at_s / 60.0);
    format!(
        "strain after {} min, least first\n\n{}{}",
        short(at),
        table(&head, rows.collect(), 2),
        scatter(&report.ranks)
    )
}

fn scatter(ranks: &[Rank]) -> String {
    let Some(single) = ranks.iter().find(|r| r.specimens == 1) else {
        return String::new();
    };
    let from = match single.scatter_source {
        ScatterSource::OtherRopes => "that of the other ropes' repeats",
        ScatterSource::Stated => "as stated",
        _ => "a starting guess; --scatter states your own, repeats measure it",
    };
    let text = format!(
        "One specimen can't tell how specimens differ: where n is 1 the interval takes {} % between specimens, {from}.",
        short(100.0 * single.scatter_share)
    );
    format!("\n{}", paragraph(&text, 0))
}

/// Said where no law could be held against anything.
pub(super) const NOTHING_FORECAST: &str = "Nothing was forecast: what is left before the hidden end is too short for every law. Hide a smaller share, or test for longer.";

/// Shares inside, error and half width in %, each with `unit`; a dash where nothing was forecast.
pub(super) fn coverage(c: &Coverage, unit: &str) -> [String; 4] {
    // A law may have had no interval to be half as wide as.
    let forecast = |ratio: f64| c.ends_share().map(|_| ratio).filter(|r| r.is_finite());
    [
        c.readings_share(),
        c.ends_share(),
        forecast(c.end_error_ratio),
        forecast(c.end_half_width_ratio),
    ]
    .map(|share| share.map_or("–".into(), |s| format!("{:.1}{unit}", 100.0 * s)))
}

/// How often forecasts held the hidden end.
pub fn withhold_table(report: &WithheldReport) -> String {
    let head = [
        "law",
        "tests",
        "too few",
        "readings inside",
        "ends inside",
        "error",
        "half width",
    ];
    let rows = report.withheld.iter().map(|c| {
        let [readings, ends, error, width] = coverage(c, " %");
        vec![
            c.forecaster.name().to_owned(),
            c.tests.to_string(),
            c.failed.to_string(),
            readings,
            ends,
            error,
            width,
        ]
    });
    let nothing = match report.forecasts_any() {
        true => String::new(),
        false => format!("\n{}", paragraph(NOTHING_FORECAST, 0)),
    };
    format!(
        "{}\n{}{nothing}",
        paragraph(
            &format!(
                "Last {:.0} % of the time hidden; {:.0} % intervals for readings. Error and half width: median at the end, in % of the test's creep.",
                100.0 * report.hidden_share,
                100.0 * report.level
            ),
            0
        ),
        table(&head, rows.collect(), 1)
    )
}

/// Shift factors and what they follow.
pub fn shift_table(report: &ShiftReport) -> String {
    let found = &report.superposition;
    let rows = found.shifts.iter().map(|s| {
        vec![
            format!("{:.1}", s.temperature_c),
            format!("{:.3}", s.log10_a_t.mean),
            format!("{:.3}", s.log10_a_t.deviation),
            format!("{:.0} %", 100.0 * s.overlap_share),
        ]
    });
    let mut out = table(
        &["°C", "log10 a_T", "std. error", "overlap"],
        rows.collect(),
        0,
    );
    if let Some(line) = found.arrhenius {
        out.push_str(&format!(
            "\nArrhenius: {} kJ/mol, misfit {:.2} decades\n",
            short(1e-3 * line.energy_j_per_mol),
            line.misfit_decades
        ));
    }
    if let Some(wlf) = found.wlf {
        out.push_str(&format!(
            "WLF from {:.1} °C up: C1 {}, C2 {} K, misfit {:.2} decades\n",
            found.reference_c,
            short(wlf.c1),
            short(wlf.c2_k),
            wlf.misfit_decades
        ));
    }
    out
}
