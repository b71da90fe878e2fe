//! The OpenAPI description, made of the list of addresses and of the types.

use super::api::{
    AlarmList, Done, DueAsked, EventsAsked, Fleet, Journal, JournalAsked, Login, Records,
    RecordsAsked, Refusal, RobotNow, TendonNow,
};
use super::routes::{API, Endpoint};
use schemars::JsonSchema;
use schemars::generate::{SchemaGenerator, SchemaSettings};
use serde_json::{Map, Value, json};
use sinew_watch_core::command::Command;
use sinew_watch_core::due::DueList;

/// What an address takes and gives.
struct Described {
    asked: Option<Value>,
    body: Option<Value>,
    gives: Value,
}

struct Maker {
    /// Of what is given.
    gives: SchemaGenerator,
    /// Of what is taken: without references, as the same type may be another when read.
    takes: SchemaGenerator,
}

impl Maker {
    fn json<T: JsonSchema>(&mut self) -> Value {
        let schema = self.gives.subschema_for::<T>();
        json!({ "application/json": { "schema": schema } })
    }

    fn take<T: JsonSchema>(&mut self) -> Option<Value> {
        Some(self.takes.subschema_for::<T>().to_value())
    }

    fn describe(&mut self, path: &str) -> Described {
        let mut described = Described {
            asked: None,
            body: None,
            gives: json!({}),
        };
        described.gives = match path {
            "/api/v1/fleet" => self.json::<Fleet>(),
            "/api/v1/robots/{robot}" => self.json::<RobotNow>(),
            "/api/v1/robots/{robot}/tendons/{joint}" => self.json::<TendonNow>(),
            "/api/v1/robots/{robot}/commands" => {
                described.body = self.take::<Command>();
                self.json::<Done>()
            }
            "/api/v1/due" => {
                described.asked = self.take::<DueAsked>();
                self.json::<DueList>()
            }
            "/api/v1/alarms" => self.json::<AlarmList>(),
            "/api/v1/journal" => {
                described.asked = self.take::<JournalAsked>();
                self.json::<Journal>()
            }
            "/api/v1/records" => {
                described.asked = self.take::<RecordsAsked>();
                self.json::<Records>()
            }
            "/api/v1/records.csv" => {
                described.asked = self.take::<RecordsAsked>();
                json!({ "text/csv": {} })
            }
            "/api/v1/robots/{robot}/sessions.csv" => json!({ "text/csv": {} }),
            "/api/v1/records.parquet" => {
                described.asked = self.take::<RecordsAsked>();
                json!({ "application/vnd.apache.parquet": {} })
            }
            "/api/v1/events" => {
                described.asked = self.take::<EventsAsked>();
                json!({ "text/event-stream": {} })
            }
            "/login" => {
                described.body = self.take::<Login>();
                self.json::<Done>()
            }
            "/logout" => {
                described.body = Some(json!({ "type": "object" }));
                self.json::<Done>()
            }
            "/api/v1/openapi.json" => json!({ "application/json": {} }),
            "/metrics" | "/healthz" => json!({ "text/plain": {} }),
            other => json!({ "undescribed": other }),
        };
        described
    }
}

/// Parameters in the path, then those behind the question mark.
fn parameters(path: &str, asked: Option<&Value>) -> Vec<Value> {
    let in_path = path
        .split('{')
        .skip(1)
        .filter_map(|rest| rest.split('}').next());
    let mut out: Vec<Value> = in_path
        .map(|name| {
            json!({ "name": name, "in": "path", "required": true, "schema": { "type": "string" } })
        })
        .collect();
    let properties = asked.and_then(|schema| schema.get("properties")?.as_object());
    for (name, schema) in properties.into_iter().flatten() {
        let mut schema = schema.clone();
        let about = schema.as_object_mut().and_then(|s| s.remove("description"));
        out.push(json!({ "name": name, "in": "query", "description": about, "schema": schema }));
    }
    out
}

fn operation(endpoint: &Endpoint, described: &Described, refusal: &Value) -> Value {
    let path = endpoint.path;
    let id: String = path
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|part| !part.is_empty() && *part != "api" && *part != "v1")
        .collect::<Vec<_>>()
        .join("_");
    let is_open = !(path.starts_with("/api/") || path == "/metrics");
    let mut parameters = parameters(path, described.asked.as_ref());
    if endpoint.method == "post" {
        parameters.push(json!({
            "name": "x-sinew", "in": "header", "required": true, "schema": { "type": "string" },
            "description": "Any value: another site's form can't send it.",
        }));
    }
    let mut out = json!({
        "operationId": format!("{}_{id}", endpoint.method),
        "summary": endpoint.summary,
        "parameters": parameters,
        "responses": {
            "200": { "description": "It was done.", "content": described.gives },
            "default": {
                "description": "It was refused, and why.",
                "content": { "application/json": { "schema": refusal } },
            },
        },
    });
    if is_open {
        out["security"] = json!([]);
    }
    if let Some(body) = &described.body {
        out["requestBody"] =
            json!({ "required": true, "content": { "application/json": { "schema": body } } });
    }
    out
}

/// The description.
pub fn document() -> Value {
    let mut maker = Maker {
        gives: SchemaSettings::draft2020_12()
            .for_serialize()
            .with(|settings| {
                settings.definitions_path = "/components/schemas".into();
                settings.meta_schema = None;
            })
            .into_generator(),
        takes: SchemaSettings::draft2020_12()
            .for_deserialize()
            .with(|settings| {
                settings.inline_subschemas = true;
                settings.meta_schema = None;
            })
            .into_generator(),
    };
    let refusal = maker.gives.subschema_for::<Refusal>().to_value();
    let mut paths = Map::new();
    for endpoint in API {
        let described = maker.describe(endpoint.path);
        let operation = operation(endpoint, &described, &refusal);
        let item = paths.entry(endpoint.path).or_insert_with(|| json!({}));
        item[endpoint.method] = operation;
    }
    let schemas = maker.gives.take_definitions(true);
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "Sinew watch",
            "version": "1",
            "description": "What a monitor knows of rope tendons. SI units; …_deviation is one standard deviation. \
                            It never commands a robot.",
            "license": { "name": "MIT OR Apache-2.0" },
        },
        "servers": [{ "url": "/" }],
        "security": [{ "token": [] }, { "login": [] }],
        "paths": paths,
        "components": {
            "schemas": schemas,
            "securitySchemes": {
                "token": { "type": "http", "scheme": "bearer" },
                "login": { "type": "apiKey", "in": "cookie", "name": "sinew_watch" },
            },
        },
    })
}
