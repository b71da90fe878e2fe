//! Flattens a document to named numbers: the whole content of a report.

use crate::answers::Answers;
use serde::Serialize;
use serde_json::{Map, Value};
use sinew_model::Gaussian;
use std::collections::BTreeMap;

/// Maximum length of a listed array of numbers; longer ones are reported by their sums.
const LISTED: usize = 3;

/// Flattens a document: numbers as values, words as part of their name, without the program's
/// version.
pub(crate) fn document(answers: &mut Answers, about: &str, document: &impl Serialize) {
    answers.about(about);
    let value = serde_json::to_value(document).expect("a document");
    flatten(answers, String::new(), &value);
}

fn flatten(answers: &mut Answers, name: String, value: &Value) {
    match value {
        Value::Null => answers.number(&format!("{name} none"), 1.0),
        Value::Bool(is) => answers.number(&name, f64::from(*is)),
        // A share close to zero is compared except for its last digits.
        Value::Number(number) if name.ends_with("share") => {
            answers.probability(&name, number.as_f64().expect("a number"));
        }
        Value::Number(number) => answers.number(&name, number.as_f64().expect("a number")),
        Value::String(text) => {
            let is_path = text.starts_with('/');
            let file = text.rsplit('/').next().filter(|_| is_path);
            let text = file.unwrap_or(text).replace([',', '\n'], " ");
            answers.number(&format!("{name} {text}"), 1.0);
        }
        Value::Array(items) => match numbers(items) {
            Some(numbers) => sums(answers, &name, &numbers),
            None if items.len() > LISTED && items.iter().all(is_numeric_row) => {
                for (field, column) in columns(items) {
                    flatten(answers, format!("{name} {field}"), &Value::Array(column));
                }
            }
            None => {
                for (i, item) in items.iter().enumerate() {
                    flatten(answers, format!("{name} {i}"), item);
                }
                answers.number(&format!("{name} count"), items.len() as f64);
            }
        },
        Value::Object(fields) => {
            if let Some(of) = gaussian(fields) {
                return answers.gaussian(&name, of);
            }
            let fields = fields.iter().filter(|(field, _)| *field != "sinew_version");
            for (field, value) in fields {
                flatten(answers, format!("{name} {field}"), value);
            }
        }
    }
}

/// Whether a row contains no word: many such rows are reported by their columns.
fn is_numeric_row(item: &Value) -> bool {
    fn is_numeric(value: &Value) -> bool {
        match value {
            Value::Object(fields) => fields.values().all(is_numeric),
            Value::String(_) | Value::Array(_) => false,
            Value::Null | Value::Bool(_) | Value::Number(_) => true,
        }
    }
    item.is_object() && is_numeric(item)
}

fn columns(rows: &[Value]) -> BTreeMap<String, Vec<Value>> {
    let mut columns: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for (field, value) in rows.iter().filter_map(Value::as_object).flatten() {
        columns
            .entry(field.clone())
            .or_default()
            .push(value.clone());
    }
    columns
}

fn gaussian(fields: &Map<String, Value>) -> Option<Gaussian> {
    let number = |field| fields.get(field).and_then(Value::as_f64);
    let of = Gaussian::new(number("mean")?, number("std")?);
    (fields.len() == 2).then_some(of)
}

/// Numbers of a list that contains nothing else; a missing value counts as none.
fn numbers(items: &[Value]) -> Option<Vec<f64>> {
    let all: Option<Vec<f64>> = (items.iter())
        .map(|item| {
            if item.is_null() {
                Some(0.0)
            } else {
                item.as_f64()
            }
        })
        .collect();
    all.filter(|all| all.len() > LISTED)
}

/// First, last, count, and two sums of different weights, so that no single change goes unnoticed.
fn sums(answers: &mut Answers, name: &str, numbers: &[f64]) {
    let count = numbers.len() as f64;
    let size: f64 = numbers.iter().map(|n| n.abs()).sum::<f64>() / count;
    answers.number(&format!("{name} count"), count);
    answers.usually(&format!("{name} first"), numbers[0], size);
    answers.usually(&format!("{name} last"), numbers[numbers.len() - 1], size);
    let mean: f64 = numbers.iter().sum::<f64>() / count;
    answers.usually(&format!("{name} mean"), mean, size / count);
    let weighted = numbers
        .iter()
        .enumerate()
        .map(|(i, n)| n * (i as f64 + 1.0));
    let weighted: f64 = weighted.sum::<f64>() / (count * count);
    answers.usually(&format!("{name} weighted"), weighted, size / count);
}
