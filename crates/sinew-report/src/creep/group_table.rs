//! One line per group: what was fitted, which law won, what could not be.

use super::words::group;
use crate::text::{paragraph, plain, short, table};
use sinew_creep::{Analysis, Fit, FitSet, Law};

/// Groups of specimens that were fitted alone, by name.
pub fn group_table(analyses: &[Analysis], fits: &[FitSet], laws: &[Law]) -> String {
    let mut groups: Vec<&str> = analyses.iter().map(|a| group(&a.group)).collect();
    groups.sort_unstable();
    groups.dedup();
    let rows = groups.iter().map(|name| {
        let members: Vec<&Analysis> = analyses
            .iter()
            .filter(|a| group(&a.group) == *name)
            .collect();
        row(name, &members, fits, laws)
    });
    let names = laws.iter().map(|l| match l {
        Law::LogTime => "log",
        Law::Findley => "fin",
        Law::Burgers => "bur",
        Law::KelvinVoigt => "kv",
        Law::Stretched => "str",
        Law::Line | Law::Rope => "rope",
    });
    let mut head = vec!["group", "n", "not", "creep\n%"];
    head.extend(names);
    head.extend(["noise\n%", "un-\ntold"]);
    format!(
        "\n{}\n{}",
        paragraph(
            "Per group: tests, those not fitted, median creep; tests in which each law (log-time, findley, burgers, kelvin-voigt, stretched) has the smallest AICc; median noise of the readings about that law; tests in which a parameter of it can't be told.",
            0
        ),
        table(&head, rows.collect(), 1)
    )
}

fn row(name: &str, members: &[&Analysis], fits: &[FitSet], laws: &[Law]) -> Vec<String> {
    let best: Vec<&Fit> = members
        .iter()
        .filter_map(|a| fits.iter().find(|f| f.name == a.name))
        .filter_map(|f| f.laws.first())
        .collect();
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let undecided = |f: &&&Fit| f.parameters.iter().any(|p| p.not_identifiable.is_some());
    let creep = members.iter().map(|a| 100.0 * a.creep_strain_ratio);
    let noise = best.iter().map(|f| 100.0 * f.residual_strain_ratio);
    let mut cells = vec![
        plain(name),
        members.len().to_string(),
        (members.len() - best.len()).to_string(),
        strain(median(creep.collect())),
    ];
    for law in laws {
        let won = best.iter().filter(|f| f.law == *law).count();
        cells.push(won.to_string());
    }
    cells.push(strain(median(noise.collect())));
    cells.push(best.iter().filter(undecided).count().to_string());
    cells
}

/// A strain in a column of five.
fn strain(percent: f64) -> String {
    if percent.is_finite() && percent < 100.0 {
        format!("{percent:.3}")
    } else {
        short(percent)
    }
}
