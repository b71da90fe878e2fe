//! What is said of specimens and of groups of them, on the terminal and on pages.

use super::words::{bracketed, duration, group, reading_time, short, slope, zero};
use crate::text::{self, or_dash, yes_no};
use sinew_creep::{Analysis, PERCENT_PER_H, Scatter};
use sinew_figure::{Columns, Headline, Level, Table};

/// Specimens; `strain` writes percent.
pub(super) fn specimens(
    analyses: &[Analysis],
    strain: impl Fn(f64) -> String,
) -> Columns<&Analysis> {
    Columns::of(analyses)
        .words("specimen", |a| &a.name)
        .column("load, N", |a| or_dash(a.force_n, text::short))
        .column("end, %", |a| strain(100.0 * a.end_strain_ratio))
        .column("creep, %", |a| strain(100.0 * a.creep_strain_ratio))
        .columns(["m_E, %/h", "interval"], |a| slope(a.slope_per_s))
        .column("saturated", |a| a.saturated.map_or("–", yes_no))
}

/// Means of groups and the scatter between their specimens.
pub(super) fn groups(groups: &[Scatter]) -> Columns<&Scatter> {
    let percent = |v: Option<f64>, unit: f64| or_dash(v, |v| text::short(unit * v));
    Columns::of(groups)
        .words("group", |g| group(&g.group))
        .column("specimens", |g| g.specimens)
        .column("end, %", |g| text::short(100.0 * g.end_strain_ratio))
        .column("scatter, %", |g| percent(g.end_deviation_ratio, 100.0))
        .column("m_E, %/h", |g| percent(g.slope_per_s, PERCENT_PER_H))
        .column("scatter", |g| {
            percent(g.slope_deviation_per_s, PERCENT_PER_H)
        })
}

/// Readings of a specimen at the times of the standard.
pub(super) fn readings(a: &Analysis) -> Table {
    Columns::of(&a.readings)
        .words("time", |r| reading_time(r.time_s))
        .column("strain, %", |r| format!("{:.4}", 100.0 * r.strain_ratio))
        .column("creep modulus, MPa", |r| {
            or_dash(r.modulus_pa, |m| text::short(m * 1e-6))
        })
        .captioned(format!("{}, strain from: {}", a.name, zero(a.zero)))
}

/// What came back when the load fell.
pub(super) fn recovery(a: &Analysis) -> impl Iterator<Item = String> + '_ {
    a.recovery.iter().map(|r| {
        let [before, after, minutes] =
            [r.force_before_n, r.force_after_n, r.duration_s / 60.0].map(text::short);
        let ratios = [r.at_once_strain_ratio, r.delayed_strain_ratio, r.residual_strain_ratio];
        let [at_once, delayed, left] = ratios.map(|ratio| 100.0 * ratio);
        format!(
            "from {before} N to {after} N: {at_once:.4} % at once, {delayed:.4} % within {minutes} min, {left:.4} % left"
        )
    })
}

/// How far a specimen stretched, and whether it goes on.
pub(super) fn answer(a: &Analysis) -> Headline {
    let load = (a.force_n).map_or(String::new(), |n| format!(" under {} N", short(n)));
    let slope = a.slope_per_s.map_or(String::new(), |s| {
        format!("; it creeps at {} %/h", bracketed(s.scaled(PERCENT_PER_H)))
    });
    let (level, settled) = match a.saturated {
        Some(true) => (Level::Good, ": it has settled"),
        Some(false) => (Level::Plain, ": it has not settled"),
        None => (Level::Plain, ""),
    };
    let (name, end) = (&a.name, short(100.0 * a.end_strain_ratio));
    let after = duration(a.duration_s);
    Headline::new(
        level,
        format!("{name}: {end} % after {after}{load}{slope}{settled}"),
    )
}
