//! `sinew creep fit --withhold`: forecasts held against the hidden end of each test.

use super::super::creep_files::{Tests, csv_line, write_csv};
use super::Fit;
use crate::terminal::{Bar, Failure, Finish, answer};
use crate::text::{paragraph, table};
use sinew_creep::{Curve, FitOptions};

impl Fit {
    pub(super) fn withheld(
        &self,
        tests: &Tests,
        share: f64,
        options: &FitOptions,
    ) -> Result<Finish, Failure> {
        let curves: Vec<Curve> = tests.prepared.iter().map(|p| p.curve.clone()).collect();
        let bar = Bar::new("forecasting", self.files.quiet);
        let total = curves.len() as f64;
        let rows =
            sinew_creep::withhold_all(&curves, share, options, |done| bar.set(done as f64, total));
        drop(bar);
        if let Some(path) = &self.files.report {
            let page = sinew_creep::page(self.contents(tests, &[], &[], &rows, &tests.failures));
            sinew_files::write_file(path, page.html().as_bytes())?;
        }
        if let Some(path) = &self.files.csv {
            let mut text = csv_line(&[
                "law",
                "tests",
                "failed",
                "readings_percent",
                "end_percent",
                "end_error_percent",
                "end_half_width_percent",
            ]);
            for r in &rows {
                text.push_str(&csv_line(&[
                    r.law.clone(),
                    r.tests.to_string(),
                    r.failed.to_string(),
                    r.readings_percent.to_string(),
                    r.end_percent.to_string(),
                    r.end_error_percent.to_string(),
                    r.end_half_width_percent.to_string(),
                ]));
            }
            write_csv(path, &text)?;
        }
        if self.files.json {
            let document = serde_json::json!({ "sources": tests.sources, "withheld": rows, "failures": tests.failures });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            let head = [
                "law",
                "tests",
                "too few",
                "readings inside",
                "ends inside",
                "error",
                "half width",
            ];
            let lines = rows
                .iter()
                .map(|r| {
                    vec![
                        r.law.clone(),
                        r.tests.to_string(),
                        r.failed.to_string(),
                        format!("{:.1} %", r.readings_percent),
                        format!("{:.1} %", r.end_percent),
                        format!("{:.1} %", r.end_error_percent),
                        format!("{:.1} %", r.end_half_width_percent),
                    ]
                })
                .collect();
            answer(&format!(
                "{}\n{}",
                paragraph(
                    &format!(
                        "Last {:.0} % of the time hidden; {:.0} % intervals for readings. Error and half width: median at the end, in % of the test's creep.",
                        100.0 * share,
                        100.0 * options.level
                    ),
                    0
                ),
                table(&head, lines, 1)
            ))?;
        }
        Ok(Finish::lossy(!tests.failures.is_empty()))
    }
}
