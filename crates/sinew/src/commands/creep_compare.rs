//! `sinew creep compare`.

use super::creep_analyze::plotted;
use super::creep_files::{TestFiles, csv_line, short, write_csv};
use crate::terminal::{Failure, Finish, answer};
use crate::text::{plain, table};
use clap::Args;
use sinew_lab::creep::{self, Contents};
use sinew_lab::output;
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
}

impl Compare {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let tests = self.files.read()?;
        let ranks = creep::rank(
            &tests.prepared,
            &tests.analyses,
            &tests.groups,
            self.files.level,
        );
        let figure = creep::figure("", &plotted(&tests), false);
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
            output::write_file(path, &bytes)?;
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
            ]);
            for r in &ranks {
                let slope = |pick: fn(&creep::Interval) -> f64| {
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
                ]));
            }
            write_csv(path, &text)?;
        }
        if let Some(path) = &self.files.report {
            let named: Vec<(String, &creep::Analysis)> =
                tests.groups.iter().cloned().zip(&tests.analyses).collect();
            let page = creep::page(Contents {
                title: "Creep of ropes compared".to_owned(),
                sources: &tests.sources,
                conditions: self.files.conditions(),
                analyses: &tests.analyses,
                groups: &creep::scatter(&named),
                failures: &tests.failures,
                figures: vec![(figure, String::new())],
                ..Contents::default()
            });
            output::write_file(path, page.html().as_bytes())?;
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
                "strain after {} min, least first\n\n{}",
                short(at),
                table(&head, rows(&short), 2)
            ))?;
        }
        Ok(Finish::lossy(!tests.failures.is_empty()))
    }
}
