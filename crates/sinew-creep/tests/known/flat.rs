//! A document as numbers with names: what a report says, whole.

use crate::answers::Answers;
use serde::Serialize;
use serde_json::{Map, Value};
use sinew_model::Gaussian;
use std::collections::BTreeMap;

/// Arrays of numbers that are longer than this are told by their sums.
const LISTED: usize = 3;

/// Everything a document says: numbers as they are, words as part of their name, the program's version left out.
pub(crate) fn document(answers: &mut Answers, about: &str, document: &impl Serialize) {
    answers.about(about);
    let value = serde_json::to_value(document).expect("a document");
    tell(answers, String::new(), &value);
}

fn tell(answers: &mut Answers, name: String, value: &Value) {
    match value {
        Value::Null => answers.number(&format!("{name} none"), 1.0),
        Value::Bool(is) => answers.number(&name, f64::from(*is)),
        // A share of nothing is nothing to the last digit but one.
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
            None if items.len() > LISTED && items.iter().all(is_wordless) => {
                for (field, column) in columns(items) {
                    tell(answers, format!("{name} {field}"), &Value::Array(column));
                }
            }
            None => {
                for (i, item) in items.iter().enumerate() {
                    tell(answers, format!("{name} {i}"), item);
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
                tell(answers, format!("{name} {field}"), value);
            }
        }
    }
}

/// Whether it is a row of a table, without a word: of many such the columns are told.
fn is_wordless(item: &Value) -> bool {
    fn wordless(value: &Value) -> bool {
        match value {
            Value::Object(fields) => fields.values().all(wordless),
            Value::String(_) | Value::Array(_) => false,
            Value::Null | Value::Bool(_) | Value::Number(_) => true,
        }
    }
    item.is_object() && wordless(item)
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
    let of = Gaussian::new(number("mean")?, number("deviation")?);
    (fields.len() == 2).then_some(of)
}

/// Those of a list that is nothing else; what isn't known counts as none.
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

/// The first, the last, how many, and two sums of different weights: none can change alone.
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
