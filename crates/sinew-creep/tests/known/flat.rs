//! A document as numbers with names: what a report says, whole.

use crate::answers::Answers;
use serde::Serialize;
use serde_json::Value;

/// Arrays of numbers that are longer than this are told by their sums.
const LISTED: usize = 3;

/// Everything a document says: numbers as they are, words as part of their name.
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
            answers.usually(&name, number.as_f64().expect("a number"), 1.0);
        }
        Value::Number(number) => answers.number(&name, number.as_f64().expect("a number")),
        Value::String(text) => {
            let text = text.replace([',', '\n'], " ");
            answers.number(&format!("{name} {text}"), 1.0);
        }
        Value::Array(items) => match numbers(items) {
            Some(numbers) => sums(answers, &name, &numbers),
            None => {
                for (i, item) in items.iter().enumerate() {
                    tell(answers, format!("{name} {i}"), item);
                }
                answers.number(&format!("{name} count"), items.len() as f64);
            }
        },
        Value::Object(fields) => {
            for (field, value) in fields {
                tell(answers, format!("{name} {field}"), value);
            }
        }
    }
}

fn numbers(items: &[Value]) -> Option<Vec<f64>> {
    let all: Option<Vec<f64>> = items.iter().map(Value::as_f64).collect();
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
