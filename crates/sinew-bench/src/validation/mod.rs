//! The measured tables of `docs/src/validation.md`: their studies, their data file `validation.json` and their text.

mod page;
mod rows;
mod study;

pub use page::{PageError, render};
pub use study::{STUDIES, Source, Study};

use rows::Rows;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Data file of the page: results by the name of the study.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Validation(pub BTreeMap<String, Measurement>);

impl Validation {
    /// Formats the data as JSON with one line per row.
    ///
    /// # Errors
    /// Returns an error for a value that JSON cannot represent.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        let mut studies = Vec::new();
        for (name, measurement) in &self.0 {
            let mut about = serde_json::to_value(measurement)?;
            let rows = about["rows"].take();
            for (kind, rows) in rows.as_object().into_iter().flatten() {
                let lines = rows.as_array().into_iter().flatten();
                let lines: Vec<String> = lines.map(Value::to_string).collect();
                about["rows"] = json!({ kind: [] });
                let text = format!("{}: {about}", json!(name));
                let rows = format!("[\n    {}\n  ]", lines.join(",\n    "));
                studies.push(text.replacen(
                    &format!("\"{kind}\":[]"),
                    &format!("\"{kind}\":{rows}"),
                    1,
                ));
            }
        }
        Ok(format!("{{\n  {}\n}}\n", studies.join(",\n  ")))
    }
}

/// Results of one study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Commands that reproduce the results.
    pub commands: Vec<String>,
    /// Git commit of the program that measured them.
    pub commit: String,
    /// Number of recordings per scenario, robots or tendons.
    pub n: Option<u64>,
    /// Seed of the first one; the others follow.
    pub first_seed: Option<u64>,
    rows: Rows,
}

impl Measurement {
    /// Returns the part of the results of `study` that the page shows.
    ///
    /// # Errors
    /// Returns an error if `results`, the entries of the documents, lack a value.
    pub fn new(
        study: &Study,
        n: Option<u64>,
        commit: &str,
        results: Vec<Value>,
    ) -> Result<Self, serde_json::Error> {
        Ok(Self {
            commands: study.commands(n),
            commit: commit.into(),
            n,
            first_seed: study.seed,
            rows: serde_json::from_value(json!({ study.rows: results }))?,
        })
    }
}
