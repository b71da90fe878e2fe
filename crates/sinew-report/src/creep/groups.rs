//! Fits per group of specimens.

use super::messages::group;
use crate::text::{TerminalText, short};
use sinew_creep::{Analysis, Fit, FitSet, Law};
use sinew_figure::Columns;

/// Renders the fits per group of specimens that were fitted individually.
pub fn group_table(analyses: &[Analysis], fits: &[FitSet], laws: &[Law]) -> String {
    let mut groups: Vec<&str> = analyses.iter().map(|a| group(&a.group)).collect();
    groups.sort_unstable();
    groups.dedup();
    let rows = groups.iter().map(|name| {
        let members: Vec<&Analysis> = (analyses.iter())
            .filter(|a| group(&a.group) == *name)
            .collect();
        let fits = members
            .iter()
            .filter_map(|a| fits.iter().find(|f| f.name == a.name));
        let best: Vec<&Fit> = fits.filter_map(|f| f.laws.first()).collect();
        (*name, members, best)
    });
    let unidentified = |f: &&&Fit| f.parameters.iter().any(|p| p.not_identifiable.is_some());
    let mut table = Columns::of(rows)
        .words("group", |(name, ..)| *name)
        .column("n", |(_, members, _)| members.len())
        .column("failed", |(_, members, best)| members.len() - best.len())
        .column("creep\n(%)", |(_, members, _)| {
            median(members.iter().map(|a| 100.0 * a.creep_strain_ratio))
        });
    for law in laws {
        let name = match law {
            Law::LogTime => "log",
            Law::Findley => "fin",
            Law::Burgers => "bur",
            Law::KelvinVoigt => "kv",
            Law::Stretched => "str",
            Law::Line | Law::Rope => "rope",
        };
        table = table.column(name, |(_, _, best)| {
            best.iter().filter(|f| f.law == *law).count()
        });
    }
    let table = table
        .column("noise\n(%)", |(_, _, best)| {
            median(best.iter().map(|f| 100.0 * f.residual_strain_ratio))
        })
        .column("not\nid.", |(_, _, best)| {
            best.iter().filter(unidentified).count()
        });
    let mut out = TerminalText("\n".into());
    out.flat("n: tests; failed: not fitted; creep: median; log, fin, bur, kv, str: tests in which log-time, findley, burgers, kelvin-voigt or stretched has the smallest AICc; noise: median residual of that law; not id.: tests with a parameter that is not identifiable.");
    out.add("\n");
    out.table(table.table());
    out.0
}

/// Formats the median of strains in %.
fn median(percent: impl Iterator<Item = f64>) -> String {
    let mut values: Vec<f64> = percent.collect();
    values.sort_by(f64::total_cmp);
    match values.get(values.len() / 2) {
        Some(percent) if percent.is_finite() && *percent < 100.0 => format!("{percent:.3}"),
        percent => short(percent.copied().unwrap_or(f64::NAN)),
    }
}
