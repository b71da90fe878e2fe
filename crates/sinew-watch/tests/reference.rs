//! The reference pages list exactly the existing keys, metrics, columns and addresses.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-watch --all-features reference` regenerates their tables.

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Value, json};
use sinew_watch::config::Config;
use sinew_watch::store::COLUMNS;
use sinew_watch::web::metrics::ABOUT;
use sinew_watch::web::routes::API;
use sinew_watch::webhooks::Post;
use sinew_watch_core::Record;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn page(name: &str) -> PathBuf {
    root().join("docs/src/reference").join(name)
}

/// Key that does not exist.
const UNKNOWN: &str = "zzz";

/// Keys that a section lists when it rejects an unknown one.
fn listed(text: &str) -> BTreeSet<String> {
    let error = Config::parse(text, "watch.toml", Path::new("/"))
        .unwrap_err()
        .to_string();
    assert!(error.contains(UNKNOWN), "{text}: {error}");
    let list = error.rsplit("valid keys: ").next().unwrap();
    list.split(", ").map(str::to_owned).collect()
}

#[test]
fn reference_lists_every_configuration_key() {
    let robot = "[[robot]]\nname = \"a\"\ndir = \"a\"\n";
    let sections = [
        ("", format!("{UNKNOWN} = 1\n{robot}dds = {{}}\n")),
        ("web.", format!("[web]\n{UNKNOWN} = 1\n{robot}dds = {{}}\n")),
        (
            "store.",
            format!("[store]\n{UNKNOWN} = 1\n{robot}dds = {{}}\n"),
        ),
        (
            "recording.",
            format!("[recording]\n{UNKNOWN} = 1\n{robot}dds = {{}}\n"),
        ),
        (
            "publish.",
            format!("[publish]\n{UNKNOWN} = 1\n{robot}dds = {{}}\n"),
        ),
        (
            "webhook[].",
            format!("[[webhook]]\nurl = \"http://a/\"\n{UNKNOWN} = 1\n{robot}dds = {{}}\n"),
        ),
        (
            "mail[].",
            format!(
                "[[mail]]\nserver = \"a\"\nfrom = \"a@b\"\nto = [\"a@b\"]\n{UNKNOWN} = 1\n{robot}dds = {{}}\n"
            ),
        ),
        (
            "mqtt.",
            format!("[mqtt]\nbroker = \"a\"\n{UNKNOWN} = 1\n{robot}dds = {{}}\n"),
        ),
        (
            "web.token[].",
            format!(
                "[[web.token]]\nname = \"a\"\nrole = \"read\"\n{UNKNOWN} = 1\n{robot}dds = {{}}\n"
            ),
        ),
        ("robot[].", format!("{robot}dds = {{}}\n{UNKNOWN} = 1\n")),
        (
            "robot[].dds.",
            format!("{robot}dds = {{ {UNKNOWN} = 1 }}\n"),
        ),
        (
            "robot[].zenoh.",
            format!("{robot}zenoh = {{ {UNKNOWN} = 1 }}\n"),
        ),
        (
            "robot[].mcap.",
            format!("{robot}mcap = {{ path = \"a\", {UNKNOWN} = 1 }}\n"),
        ),
        (
            "robot[].times.",
            format!("{robot}dds = {{}}\ntimes = {{ {UNKNOWN} = 1 }}\n"),
        ),
        (
            "robot[].alarm.",
            format!("{robot}dds = {{}}\nalarm = {{ {UNKNOWN} = 1 }}\n"),
        ),
        (
            "robot[].alarm.CONDITION.",
            format!("{robot}dds = {{}}\nalarm = {{ step_change = {{ {UNKNOWN} = 1 }} }}\n"),
        ),
    ];
    let conditions = [
        "replace_limit",
        "transmission_lost",
        "strand_failure",
        "step_change",
        "store",
        "transport",
        "retension_limit",
        "limit_near",
        "suspected_step",
        "data",
        "no_data",
    ];
    let text = std::fs::read_to_string(page("watch.md")).unwrap();
    let mut known = BTreeSet::new();
    for (prefix, toml) in sections {
        // Former names of conditions are still read, but not documented.
        let present = |key: &String| {
            !["door", "suspicion", "jump", "strand_failed", "doubt_s"].contains(&key.as_str())
        };
        for key in listed(&toml).into_iter().filter(present) {
            let key = match prefix == "robot[].alarm." && conditions.contains(&key.as_str()) {
                true => {
                    assert!(text.contains(&format!("`{key}`")), "{key} is not listed");
                    "CONDITION".into()
                }
                false => key,
            };
            known.insert(format!("{prefix}{key}"));
        }
    }
    let rows = text
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    let documented: BTreeSet<String> = rows.map(str::to_owned).collect();
    assert_eq!(documented, known);
}

/// Writes a table between the markers of a page, or compares it with the present one.
fn table(name: &str, table: &str) {
    const BEGIN: &str = "<!-- made by a test: begin -->\n";
    const END: &str = "<!-- made by a test: end -->\n";
    let text = std::fs::read_to_string(page(name)).unwrap();
    let (before, rest) = text.split_once(BEGIN).expect("a page with markers");
    let (_, after) = rest.split_once(END).expect("a page with markers");
    published(&page(name), &format!("{before}{BEGIN}{table}{END}{after}"));
}

fn published(path: &Path, text: &str) {
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::write(path, text).unwrap();
    }
    let committed = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        committed == text,
        "{}: outdated; regenerate it with SINEW_WRITE=1",
        path.display()
    );
}

#[test]
fn reference_lists_every_metric() {
    let mut out = String::from("| metric | kind | meaning |\n|---|---|---|\n");
    for (name, kind, about) in ABOUT {
        writeln!(
            out,
            "| `{name}` | {kind} | {} |",
            about.trim_end_matches('.')
        )
        .unwrap();
    }
    table("metrics.md", &out);
}

#[test]
fn reference_lists_every_address() {
    let mut out = String::from("| address | what |\n|---|---|\n");
    for endpoint in API {
        let method = endpoint.method.to_uppercase();
        writeln!(
            out,
            "| `{method} {}` | {} |",
            endpoint.path, endpoint.summary
        )
        .unwrap();
    }
    table("watch-api.md", &out);
}

/// Schema of a type as a separate document.
fn schema<T: JsonSchema>(title: &str) -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    schema.insert("title".into(), json!(title));
    serde_json::to_value(schema).unwrap()
}

fn write_schema<T: JsonSchema>(title: &str, file: &str) -> Value {
    let schema = schema::<T>(title);
    let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
    published(&root().join("docs/schema").join(file), &text);
    schema
}

#[test]
fn reference_lists_every_record_column() {
    let schema = write_schema::<Record>(Record::SCHEMA, "record-2.json");
    let mut out = String::from("| column | type | meaning |\n|---|---|---|\n");
    for column in COLUMNS {
        let of = &schema["properties"][column];
        let kind = match column {
            "poses" | "frames" | "frames_lost" => "whole number",
            "provisional" => "true or false",
            _ if of["type"] == "number" || of["type"] == json!(["number", "null"]) => "number",
            _ => "text",
        };
        let may = of["type"].is_array() || of["anyOf"].is_array();
        let kind = if may {
            format!("{kind}, may be missing")
        } else {
            kind.into()
        };
        let about = of["description"].as_str().unwrap().replace('\n', " ");
        writeln!(
            out,
            "| `{column}` | {kind} | {} |",
            about.trim_end_matches('.')
        )
        .unwrap();
    }
    table("records.md", &out);
    write_schema::<Post>("sinew-webhook/2", "webhook-2.json");
}
