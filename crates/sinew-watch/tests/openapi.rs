//! The API description matches endpoints and types, and every response matches the description.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-watch --all-features openapi` regenerates it.

use crate::checker::check;
use crate::http::get;
use crate::web::Running;
use serde_json::{Value, json};
use sinew_watch::web::openapi::document;
use sinew_watch::web::routes::API;
use std::path::Path;

#[test]
fn openapi_matches_endpoints_and_types() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("openapi.json");
    let text = serde_json::to_string_pretty(&document()).unwrap() + "\n";
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(
        committed == text,
        "openapi.json is outdated: regenerate it with SINEW_WRITE=1"
    );
}

/// Schema of a response in the description.
fn schema(document: &Value, path: &str) -> Option<Value> {
    let content = &document["paths"][path]["get"]["responses"]["200"]["content"];
    let schema = content["application/json"].get("schema")?.clone();
    let whole = json!({ "allOf": [schema], "$defs": document["components"]["schemas"] });
    let text = whole
        .to_string()
        .replace("#/components/schemas/", "#/$defs/");
    serde_json::from_str(&text).ok()
}

#[test]
fn openapi_responses_match_schemas() {
    let running = Running::shared();
    let document = document();
    running.until(|r| get(r.at, "/api/v1/alarms").text().contains("limit-near"));
    let mut checked = 0;
    for endpoint in API.iter().filter(|e| e.method == "get") {
        let Some(schema) = schema(&document, endpoint.path) else {
            continue;
        };
        let path = endpoint
            .path
            .replace("{robot}", "demo-1")
            .replace("{joint}", "elbow");
        let answer = get(running.at, &path);
        assert_eq!(answer.status, 200, "{path}");
        let faults = check(&schema, &answer.json());
        assert!(faults.is_empty(), "{path}: {faults:#?}");
        checked += 1;
    }
    assert_eq!(checked, 8);
}
