//! `sinew creep compare`.

use super::creep_analyze::plotted;
use super::creep_files::{TestFiles, csv_line, short, write_csv};
use crate::terminal::{Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::Args;
use sinew_creep::{Contents, ScatterSource};
use std::path::PathBuf;

/// All ropes in one figure, with slopes, ranked with intervals
///
/// Ranks by strain at the longest time that all reach; specimens of one --group are repeats.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew creep compare *.csv --gauge-length-mm 350 --group rope --plot ropes.png")]
pub(crate) struct Compare {
    #[command(flatten)]
    files: TestFiles,
    /// Write the figure (.svg or .png)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    plot: Option<PathBuf>,
    /// Standard deviation between specimens as a share of the value, for ropes with one specimen
    /// [default: that of the other ropes' repeats, else 0.1, a starting guess]
    #[arg(long, value_name = "SHARE")]
    scatter: Option<f64>,
}

impl Compare {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        if let Some(share) = self.scatter
            && !(share > 0.0 && share < 10.0)
        {
            return Err(Failure::Refused(format!(
                "--scatter {share}: a share of the value, above 0 and below 10"
            )));
        }
        let tests = self.files.read()?;
        let ranks = sinew_creep::rank(
            &tests.prepared,
            &tests.analyses,
            &tests.groups,
            self.files.level,
            self.scatter,
        );
        let figure = sinew_creep::figure("", &plotted(&tests), false);
        if let Some(path) = &self.plot {
            let bytes = match path.extension().and_then(|e| e.to_str()) {
                Some("png") => figure.png(2.0)?,
                Some("svg") => figure.svg().into_bytes(),
                _ => {
                    return Err(Failure::Refused(format!(
                        "--plot {}: the name must end in .svg or .png",
                        path.display()
                    )));
                }
            };
            sinew_files::write_file(path, &bytes)?;
        }
        let fine = |v: f64| format!("{v:.4}");
        let rows = |number: &dyn Fn(f64) -> String| -> Vec<Vec<String>> {
            ranks
                .iter()
                .map(|r| {
                    vec![
                        r.rank.to_string(),
                        plain(&r.name),
                        r.specimens.to_string(),
                        format!("{:.4}", r.strain_percent.value),
                        format!(
                            "{} … {}",
                            fine(r.strain_percent.low),
                            fine(r.strain_percent.high)
                        ),
                        r.slope_percent_per_h
                            .map_or("–".into(), |s| number(s.value)),
                        r.slope_percent_per_h.map_or("–".into(), |s| {
                            format!("{} … {}", number(s.low), number(s.high))
                        }),
                    ]
                })
                .collect()
        };
        let head = [
            "rank",
            "rope",
            "n",
            "strain, %",
            "interval",
            "m_E, %/h",
            "interval",
        ];
        if let Some(path) = &self.files.csv {
            let mut text = csv_line(&[
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
            ]);
            for r in &ranks {
                let slope = |pick: fn(&sinew_creep::Interval) -> f64| {
                    r.slope_percent_per_h
                        .as_ref()
                        .map_or(String::new(), |s| pick(s).to_string())
                };
                text.push_str(&csv_line(&[
                    r.rank.to_string(),
                    r.name.clone(),
                    r.specimens.to_string(),
                    r.strain_percent.value.to_string(),
                    r.strain_percent.low.to_string(),
                    r.strain_percent.high.to_string(),
                    slope(|s| s.value),
                    slope(|s| s.low),
                    slope(|s| s.high),
                    r.scatter.to_string(),
                    r.scatter_source.words().to_owned(),
                ]));
            }
            write_csv(path, &text)?;
        }
        if let Some(path) = &self.files.report {
            // Specimens of no group are ropes of their own, not repeats.
            let named: Vec<(String, &sinew_creep::Analysis)> = tests
                .groups
                .iter()
                .cloned()
                .zip(&tests.analyses)
                .filter(|(group, _)| group != "all")
                .collect();
            let page = sinew_creep::page(Contents {
                title: "Creep of ropes compared".to_owned(),
                sources: &tests.sources,
                conditions: self.files.conditions(),
                analyses: &tests.analyses,
                ranks: &ranks,
                groups: &sinew_creep::scatter(&named),
                failures: &tests.failures,
                figures: vec![(figure, String::new())],
                ..Contents::default()
            });
            sinew_files::write_file(path, page.html().as_bytes())?;
        }
        if self.files.json {
            let document = serde_json::json!({
                "sources": tests.sources,
                "ranks": ranks,
                "failures": tests.failures,
            });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            let at = ranks.first().map_or(f64::NAN, |r| r.at_s / 60.0);
            answer(&format!(
                "strain after {} min, least first\n\n{}{}",
                short(at),
                table(&head, rows(&short), 2),
                scatter_told(&ranks)
            ))?;
        }
        Ok(Finish::lossy(!tests.failures.is_empty()))
    }
}

/// What the intervals of single specimens rest on.
fn scatter_told(ranks: &[sinew_creep::Rank]) -> String {
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
        short(100.0 * single.scatter)
    );
    format!("\n{}", paragraph(&text, 0))
}
