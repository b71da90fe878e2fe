//! Tables and sentences about specimens and groups, for terminal and report.

use super::messages::{bracketed, duration, group, measurement_time, short, slope, zero};
use crate::text::{self, or_dash, yes_no};
use sinew_creep::{Analysis, PERCENT_PER_H, Scatter};
use sinew_figure::{Columns, Headline, Level, Table};

/// Builds the columns of the specimens.
///
/// * `strain`: format of a strain in %.
pub(super) fn specimens(
    analyses: &[Analysis],
    strain: impl Fn(f64) -> String,
) -> Columns<&Analysis> {
    Columns::of(analyses)
        .words("specimen", |a| &a.name)
        .column("load (N)", |a| or_dash(a.force_n, text::short))
        .column("final strain (%)", |a| strain(100.0 * a.end_strain_ratio))
        .column("creep (%)", |a| strain(100.0 * a.creep_strain_ratio))
        .columns(["m_E (%/h)", "95 % interval"], |a| slope(a.slope_per_s))
        .column("saturated", |a| a.saturated.map_or("–", yes_no))
}

/// Builds the columns with means of groups and scatter between their specimens.
pub(super) fn groups(groups: &[Scatter]) -> Columns<&Scatter> {
    let percent = |v: Option<f64>, unit: f64| or_dash(v, |v| text::short(unit * v));
    Columns::of(groups)
        .words("group", |g| group(&g.group))
        .column("specimens", |g| g.specimens)
        .column("final strain (%)", |g| {
            text::short(100.0 * g.end_strain_ratio)
        })
        .column("scatter (%)", |g| percent(g.end_std_ratio, 100.0))
        .column("m_E (%/h)", |g| percent(g.slope_per_s, PERCENT_PER_H))
        .column("scatter (%/h)", |g| {
            percent(g.slope_std_per_s, PERCENT_PER_H)
        })
}

/// Tabulates the measurements of a specimen at the times of the standard.
pub(super) fn readings(a: &Analysis) -> Table {
    Columns::of(&a.readings)
        .words("time", |r| measurement_time(r.time_s))
        .column("strain (%)", |r| format!("{:.4}", 100.0 * r.strain_ratio))
        .column("creep modulus (MPa)", |r| {
            or_dash(r.modulus_pa, |m| text::short(m * 1e-6))
        })
        .captioned(format!("{}; zero of the strain: {}", a.name, zero(a.zero)))
}

/// States the recovery after a reduction of the load.
pub(super) fn recovery(a: &Analysis) -> impl Iterator<Item = String> + '_ {
    a.recovery.iter().map(|r| {
        let [before, after, minutes] =
            [r.force_before_n, r.force_after_n, r.duration_s / 60.0].map(text::short);
        let ratios = [r.immediate_strain_ratio, r.delayed_strain_ratio, r.residual_strain_ratio];
        let [immediate, delayed, permanent] = ratios.map(|ratio| 100.0 * ratio);
        format!(
            "unloaded from {before} N to {after} N: immediate recovery {immediate:.4} %, delayed recovery {delayed:.4} % within {minutes} min, remaining strain {permanent:.4} %"
        )
    })
}

/// States the final strain of a specimen, its slope, and whether it is saturated.
pub(super) fn answer(a: &Analysis) -> Headline {
    let load = (a.force_n).map_or(String::new(), |n| format!(" under {} N", short(n)));
    let slope = a.slope_per_s.map_or(String::new(), |s| {
        format!("; creep rate {} %/h", bracketed(s.scaled(PERCENT_PER_H)))
    });
    let (level, saturation) = match a.saturated {
        Some(true) => (Level::Good, "; saturated"),
        Some(false) => (Level::Plain, "; not saturated"),
        None => (Level::Plain, ""),
    };
    let (name, end) = (&a.name, short(100.0 * a.end_strain_ratio));
    let after = duration(a.duration_s);
    Headline::new(
        level,
        format!("{name}: strain {end} % after {after}{load}{slope}{saturation}"),
    )
}
