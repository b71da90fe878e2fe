//! The part of JSON Schema that schemas made from our types use. A keyword that it does not support is a failed test,
//! and a key that no schema names is a fault.

use serde_json::{Map, Value};

/// Lists the errors of a value with their locations.
pub(crate) fn check(schema: &Value, value: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    Checker { root: schema }.value(schema, value, "", &mut faults);
    faults
}

struct Checker<'a> {
    root: &'a Value,
}

impl Checker<'_> {
    fn value(&self, schema: &Value, value: &Value, at: &str, faults: &mut Vec<String>) {
        let Some(schema) = schema.as_object() else {
            if schema == &Value::Bool(false) {
                faults.push(format!("{at}: nothing may stand here"));
            }
            return;
        };
        for (keyword, rule) in schema {
            self.keyword(schema, (keyword, rule), value, at, faults);
        }
        if let (Some(keys), Some(object)) = (self.keys(schema), value.as_object()) {
            let surplus = object.keys().filter(|key| !keys.contains(key));
            faults.extend(surplus.map(|key| format!("{at}/{key}: no schema names it")));
        }
    }

    fn keyword(
        &self,
        schema: &Map<String, Value>,
        (keyword, rule): (&str, &Value),
        value: &Value,
        at: &str,
        faults: &mut Vec<String>,
    ) {
        let mut wrong = |holds: bool| {
            if !holds {
                faults.push(format!("{at}: {value} is not {keyword} {rule}"));
            }
        };
        match keyword {
            "$schema" | "$defs" | "title" | "description" | "default" | "format" => {}
            "unevaluatedProperties" => assert_eq!(rule, &Value::Bool(false)),
            "type" => wrong(match rule {
                Value::Array(kinds) => kinds.iter().any(|kind| is(kind, value)),
                kind => is(kind, value),
            }),
            "const" => wrong(rule == value),
            "enum" => wrong(rule.as_array().is_some_and(|all| all.contains(value))),
            "minimum" => wrong(value.as_f64().is_none_or(|v| Some(v) >= rule.as_f64())),
            "maximum" => wrong(value.as_f64().is_none_or(|v| Some(v) <= rule.as_f64())),
            "minItems" => wrong(length(value).is_none_or(|n| Some(n) >= rule.as_u64())),
            "maxItems" => wrong(length(value).is_none_or(|n| Some(n) <= rule.as_u64())),
            "required" => {
                let Some(object) = value.as_object() else {
                    return;
                };
                let keys = rule
                    .as_array()
                    .into_iter()
                    .flatten()
                    .filter_map(Value::as_str);
                let missing = keys.filter(|key| !object.contains_key(*key));
                faults.extend(missing.map(|key| format!("{at}/{key}: is missing")));
            }
            "properties" => {
                for (key, rule) in rule.as_object().into_iter().flatten() {
                    if let Some(value) = value.get(key) {
                        self.value(rule, value, &format!("{at}/{key}"), faults);
                    }
                }
            }
            "additionalProperties" => {
                let named = schema.get("properties").and_then(Value::as_object);
                for (key, value) in value.as_object().into_iter().flatten() {
                    if named.is_none_or(|named| !named.contains_key(key)) {
                        self.value(rule, value, &format!("{at}/{key}"), faults);
                    }
                }
            }
            "items" | "prefixItems" => {
                let first = schema.get("prefixItems").and_then(Value::as_array);
                for (i, value) in value.as_array().into_iter().flatten().enumerate() {
                    let own = first.and_then(|first| first.get(i));
                    let rule = match keyword {
                        "prefixItems" => own,
                        _ if own.is_none() => Some(rule),
                        _ => None,
                    };
                    if let Some(rule) = rule {
                        self.value(rule, value, &format!("{at}/{i}"), faults);
                    }
                }
            }
            "$ref" => self.value(self.named(rule), value, at, faults),
            "allOf" => {
                for rule in rule.as_array().into_iter().flatten() {
                    self.value(rule, value, at, faults);
                }
            }
            "oneOf" | "anyOf" => {
                let mut nearest: Option<Vec<String>> = None;
                // Keys outside the branches are listed next to them.
                let beside = schema.get("properties").and_then(Value::as_object);
                let value = &without(value, beside);
                for rule in rule.as_array().into_iter().flatten() {
                    let mut own = Vec::new();
                    self.value(rule, value, at, &mut own);
                    if nearest.as_ref().is_none_or(|n| own.len() < n.len()) {
                        nearest = Some(own);
                    }
                }
                faults.extend(nearest.unwrap_or_default());
            }
            other => panic!("{at}: the keyword {other} is not checked"),
        }
    }

    fn named(&self, place: &Value) -> &Value {
        let place = place.as_str().unwrap_or_default().trim_start_matches('#');
        let found = self.root.pointer(place);
        found.unwrap_or_else(|| panic!("{place} is not in the schema"))
    }

    /// Keys an object may have, where a schema names them all itself.
    fn keys<'s>(&'s self, schema: &'s Map<String, Value>) -> Option<Vec<&'s String>> {
        let composed = ["$ref", "allOf", "anyOf", "oneOf", "additionalProperties"];
        if composed.iter().any(|keyword| schema.contains_key(*keyword)) {
            return None;
        }
        Some(schema.get("properties")?.as_object()?.keys().collect())
    }
}

/// An object without some keys.
fn without(value: &Value, keys: Option<&Map<String, Value>>) -> Value {
    let mut value = value.clone();
    if let (Some(object), Some(keys)) = (value.as_object_mut(), keys) {
        object.retain(|key, _| !keys.contains_key(key));
    }
    value
}

fn length(value: &Value) -> Option<u64> {
    value.as_array().map(|list| list.len() as u64)
}

fn is(kind: &Value, value: &Value) -> bool {
    match kind.as_str() {
        Some("null") => value.is_null(),
        Some("boolean") => value.is_boolean(),
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_u64() || value.is_i64(),
        Some("array") => value.is_array(),
        Some("object") => value.is_object(),
        _ => false,
    }
}
