//! One line per group: what was fitted, which law won, what could not be.

use super::super::creep_files::{Tests, short};
use super::{Fit, Joint};
use crate::text::{paragraph, plain, table};
use sinew_creep::Law;

impl Fit {
    /// The table of groups, where groups were asked for and specimens were fitted alone.
    pub(super) fn group_table(
        &self,
        tests: &Tests,
        fits: &[(String, Vec<sinew_creep::Fit>)],
    ) -> String {
        if self.files.group.is_empty() || self.joint != Joint::None {
            return String::new();
        }
        let laws = self.laws();
        let mut groups: Vec<&str> = tests.groups.iter().map(String::as_str).collect();
        groups.sort_unstable();
        groups.dedup();
        let rows = groups
            .iter()
            .map(|group| row(group, tests, fits, &laws))
            .collect();
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
            table(&head, rows, 1)
        )
    }
}

fn row(
    group: &str,
    tests: &Tests,
    fits: &[(String, Vec<sinew_creep::Fit>)],
    laws: &[Law],
) -> Vec<String> {
    let members: Vec<&sinew_creep::Analysis> = tests
        .groups
        .iter()
        .zip(&tests.analyses)
        .filter(|(g, _)| *g == group)
        .map(|(_, a)| a)
        .collect();
    let best: Vec<&sinew_creep::Fit> = members
        .iter()
        .filter_map(|a| fits.iter().find(|f| f.0 == a.name))
        .filter_map(|f| f.1.first())
        .collect();
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let untold = |f: &&&sinew_creep::Fit| f.parameters.iter().any(|p| p.not_identifiable.is_some());
    let mut cells = vec![
        plain(group),
        members.len().to_string(),
        (members.len() - best.len()).to_string(),
        strain(median(members.iter().map(|a| a.creep_percent).collect())),
    ];
    for law in laws {
        let won = best.iter().filter(|f| f.law == *law).count();
        cells.push(won.to_string());
    }
    cells.push(strain(median(
        best.iter().map(|f| f.residual_percent).collect(),
    )));
    cells.push(best.iter().filter(untold).count().to_string());
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
