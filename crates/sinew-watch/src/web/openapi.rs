//! OpenAPI description, generated from the list of endpoints and the types.

use super::api::ErrorBody;
use super::describe::{Described, Maker};
use super::routes::{API, Endpoint};
use serde_json::{Map, Value, json};

/// Returns the parameters of the path, then those of the query.
fn parameters(path: &str, query: Option<&Value>) -> Vec<Value> {
    let in_path = path
        .split('{')
        .skip(1)
        .filter_map(|rest| rest.split('}').next());
    let mut out: Vec<Value> = in_path
        .map(|name| {
            json!({ "name": name, "in": "path", "required": true, "schema": { "type": "string" } })
        })
        .collect();
    let properties = query.and_then(|schema| schema.get("properties")?.as_object());
    for (name, schema) in properties.into_iter().flatten() {
        let mut schema = schema.clone();
        let about = schema.as_object_mut().and_then(|s| s.remove("description"));
        out.push(json!({ "name": name, "in": "query", "description": about, "schema": schema }));
    }
    out
}

fn operation(endpoint: &Endpoint, described: &Described, rejection: &Value) -> Value {
    let path = endpoint.path;
    let id: String = path
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|part| !part.is_empty() && *part != "api" && *part != "v1")
        .collect::<Vec<_>>()
        .join("_");
    let is_open = !(path.starts_with("/api/") || path == "/metrics");
    let mut parameters = parameters(path, described.query.as_ref());
    if endpoint.method == "post" {
        parameters.push(json!({
            "name": "x-sinew", "in": "header", "required": true, "schema": { "type": "string" },
            "description": "Any value; protects against requests from other sites.",
        }));
    }
    let mut out = json!({
        "operationId": format!("{}_{id}", endpoint.method),
        "summary": endpoint.summary,
        "parameters": parameters,
        "responses": {
            "200": { "description": "Executed.", "content": described.gives },
            "default": {
                "description": "Rejected, with the reason.",
                "content": { "application/json": { "schema": rejection } },
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

/// Generates the description.
pub fn document() -> Value {
    let mut maker = Maker::new();
    let rejection = maker.gives.subschema_for::<ErrorBody>().to_value();
    let mut paths = Map::new();
    for endpoint in API {
        let described = (endpoint.describe)(&mut maker);
        let operation = operation(endpoint, &described, &rejection);
        let item = paths.entry(endpoint.path).or_insert_with(|| json!({}));
        item[endpoint.method] = operation;
    }
    let schemas = maker.gives.take_definitions(true);
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "Sinew watch",
            "version": "1",
            "description": "State of rope tendons in a monitor. SI units; …_std is one standard deviation. \
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
