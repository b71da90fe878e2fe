//! Every JSON document has a published schema made from its type, every command's output agrees with it, and
//! every key is in the reference.
//!
//! `SINEW_WRITE=1 cargo test -p sinew --all-features schemas` rewrites `docs/schema/` and the reference.

use crate::checker::check;
use crate::skipped::skipped;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Value, json};
use sinew_files::JsonDocument;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Name and schema of a document.
struct Published {
    name: &'static str,
    /// Name of the type.
    of: String,
    schema: Value,
}

impl Published {
    fn of<D: JsonDocument + JsonSchema>() -> Self {
        let settings = SchemaSettings::draft2020_12().for_serialize();
        let root = settings.into_generator().into_root_schema_for::<D>();
        let mut schema = serde_json::to_value(root).unwrap();
        let top = schema.as_object_mut().unwrap();
        top.insert("title".into(), json!(D::SCHEMA));
        let properties = top.entry("properties").or_insert_with(|| json!({}));
        let about = "Name and number of this schema.";
        let named = json!({ "description": about, "const": D::SCHEMA });
        properties
            .as_object_mut()
            .unwrap()
            .insert("schema".into(), named);
        let required = top.entry("required").or_insert_with(|| json!([]));
        required.as_array_mut().unwrap().insert(0, json!("schema"));
        Self {
            name: D::SCHEMA,
            of: D::schema_name().into_owned(),
            schema,
        }
    }

    /// `sinew/estimate/2` is in `estimate-2.json`.
    fn file(&self) -> PathBuf {
        let name = self.name.trim_start_matches("sinew/").replace('/', "-");
        repository().join("docs/schema").join(name + ".json")
    }
}

/// All of them.
fn documents() -> Vec<Published> {
    vec![
        Published::of::<sinew_log::RecordingInfo>(),
        Published::of::<sinew_estimate::init::Init>(),
        Published::of::<sinew_estimate::robot_check::RobotCheck>(),
        Published::of::<sinew_estimate::EstimateDocument>(),
        Published::of::<sinew_estimate::EachDocument>(),
        Published::of::<sinew_estimate::BaselineDocument>(),
        Published::of::<sinew_estimate::baseline::MergeSummary>(),
        Published::of::<sinew_trend::TrendReport>(),
        Published::of::<sinew_trend::survival::SurvivalReport>(),
        Published::of::<sinew_camera::Summary>(),
        Published::of::<sinew_rope::RopeList>(),
        Published::of::<sinew_rope::RopeDescription>(),
        Published::of::<sinew_rope::predict::Prediction>(),
        Published::of::<sinew_rope::select::Selection>(),
        Published::of::<sinew_rope::pretension::Plan>(),
        Published::of::<sinew_rope::bench::BenchRun>(),
        Published::of::<sinew_creep::AnalyzeReport>(),
        Published::of::<sinew_creep::FitReport>(),
        Published::of::<sinew_creep::HoldOutReport>(),
        Published::of::<sinew_creep::ShiftReport>(),
        Published::of::<sinew_creep::CompareReport>(),
        Published::of::<sinew_creep::Plan>(),
        Published::of::<sinew_estimate::excitation::Proposal>(),
        Published::of::<sinew_bench::paper::PaperFigure>(),
        Published::of::<sinew_bench::year::YearReport>(),
        Published::of::<sinew_bench::scenarios::ScenarioReport>(),
        Published::of::<sinew_bench::scenarios::TrajectoryReport>(),
        Published::of::<sinew_sim::control::Simulated>(),
    ]
}

/// Commands whose JSON is compared with its schema; OUT is an empty folder.
fn outputs() -> Vec<&'static str> {
    const ARM: &str = "examples/01-stretched-arm/stretched-arm.mcap --robot robots/biorob-like";
    let lines = "
        log info examples/01-stretched-arm/stretched-arm.mcap --json
        log info examples/05-your-own-robot/nod.csv --json
        init examples/01-stretched-arm/stretched-arm.mcap --out OUT/robot --json
        estimate ARM --json
        estimate ARM --method absolute --payload 0.2kg --json
        estimate --each ARM --json
        baseline ARM --to 20 --out OUT/arm.baseline --json
        baseline ARM --from 20 --out OUT/later.baseline --json
        estimate ARM --baseline OUT/arm.baseline --online --json
        baseline merge OUT/arm.baseline OUT/later.baseline --fleet --robot robots/biorob-like --out OUT/known --json
        trend examples/10-trend/sessions.csv --robot robots/biorob-like --tensioned 2026-03-02 --json
        trend examples/10-trend/sessions.csv --json
        trend examples/10-trend/sessions.csv --tensioned 2026-03-02 --life examples/12-survival/events.csv --json
        trend survival examples/12-survival/events.csv --group robot_type --json
        robot check robots/biorob-like --json
        bench read-camera examples/07-camera/frames --json
        rope list --json
        rope show liros-dc000-0301 --json
        rope predict liros-dc000-0301 --tension 60 --length 700 --at 8h --draws 20 --json
        rope select --tension 60 --length 700 --at 8h --draws 20 --json
        rope pretension liros-dc000-0701 --tension 90 --length 480 --horizon 30d --draws 20 --json
        bench simulate B --json
        creep analyze examples/06-creep-test/rope-A.csv --json
        creep fit examples/06-creep-test/rope-A.csv --json
        creep fit examples/06-creep-test/rope-A.csv --hold-out 0.33 --json
        creep compare examples/06-creep-test/rope-A.csv examples/06-creep-test/rope-B.csv --json
        creep plan liros-dc000-0301 --tension 60 --length 700 --at 30d --loads 60 --temperatures 23 --durations 85min --check 1 --json
        excitation --robot robots/biorob-like --poses 3 --candidates 2 --seed 4 --json
        simulate examples/scenarios/stretched-arm.toml --out OUT/a.mcap --duration 4 --json
        simulate examples/09-corrected/stretched-work.toml --out OUT/b.mcap --duration 8 --control --json
    ";
    let lines = lines.replace("ARM", ARM).leak();
    lines
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .collect()
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Compares a generated text with the file that publishes it, or writes it.
fn published(path: &Path, text: &str) {
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let found = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        found == text,
        "{} is not what the types say; SINEW_WRITE=1 writes it anew",
        path.display()
    );
}

#[test]
fn schemas_match_types() {
    let documents = documents();
    let names: BTreeSet<_> = documents.iter().map(|d| d.name).collect();
    assert_eq!(names.len(), documents.len(), "a name is there twice");
    for document in &documents {
        let text = serde_json::to_string_pretty(&document.schema).unwrap() + "\n";
        published(&document.file(), &text);
    }
    let files = std::fs::read_dir(repository().join("docs/schema")).unwrap();
    let files = files.map(|file| file.unwrap().path());
    let of_types: BTreeSet<_> = documents.iter().map(Published::file).collect();
    // The monitor's own types are checked by its tests: crates/sinew-watch/tests/reference.rs.
    let of_the_monitor = ["record-2.json", "webhook-2.json"];
    let nobodys: Vec<_> = files
        .filter(|file| {
            !of_types.contains(file) && !of_the_monitor.iter().any(|f| file.ends_with(f))
        })
        .collect();
    assert!(nobodys.is_empty(), "schemas nobody writes by: {nobodys:?}");
}

#[test]
fn every_key_is_in_the_reference() {
    let mut page = String::from(
        "# Keys of JSON documents\n\nMade from the program's types. [JSON](json.md) says how keys are named.\n",
    );
    for document in documents() {
        writeln!(
            page,
            "\n## {}\n\n| key | type | meaning |\n|---|---|---|",
            document.name
        )
        .unwrap();
        let mut rows = Vec::new();
        rows_of(
            &document.schema,
            &document.schema,
            "",
            &mut rows,
            &mut Vec::new(),
        );
        let mut seen = BTreeSet::new();
        for row in rows {
            if seen.insert(row.clone()) {
                page.push_str(&row);
            }
        }
    }
    published(&repository().join("docs/src/reference/json-keys.md"), &page);
}

/// Whether a named type is one of the documents.
fn is_document(name: &str) -> bool {
    static TYPES: OnceLock<BTreeSet<String>> = OnceLock::new();
    let types = TYPES.get_or_init(|| documents().into_iter().map(|d| d.of).collect());
    types.contains(name.trim_start_matches("#/$defs/"))
}

/// A row per key below a schema; `within` are the named types on the way, of which none is entered twice.
fn rows_of<'a>(
    schema: &'a Value,
    root: &'a Value,
    path: &str,
    rows: &mut Vec<String>,
    within: &mut Vec<&'a str>,
) {
    let name = schema["$ref"].as_str();
    // Documents have separate tables.
    if name.is_some_and(|name| within.contains(&name) || is_document(name)) {
        return;
    }
    within.extend(name);
    let schema = resolved(schema, root);
    for (key, value) in schema["properties"].as_object().into_iter().flatten() {
        let at = match path {
            "" => key.clone(),
            _ => format!("{path}.{key}"),
        };
        let descriptions = [value, resolved(value, root), schema];
        let about = descriptions.iter().find_map(|s| s["description"].as_str());
        let about = about
            .unwrap_or_default()
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ");
        assert!(!about.is_empty(), "{at} has no description");
        let kind = kind_of(value, root);
        rows.push(format!(
            "| `{at}` | {kind} | {} |\n",
            about.replace('|', "\\|")
        ));
        if kind != "mean and deviation" && kind != "interval" {
            rows_of(value, root, &at, rows, within);
        }
    }
    for list in ["oneOf", "anyOf", "allOf"] {
        for branch in schema[list].as_array().into_iter().flatten() {
            rows_of(branch, root, path, rows, within);
        }
    }
    for (inner, mark) in [("items", "[]"), ("additionalProperties", ".NAME")] {
        if schema[inner].is_object() {
            rows_of(&schema[inner], root, &format!("{path}{mark}"), rows, within);
        }
    }
    within.truncate(within.len() - usize::from(name.is_some()));
}

fn resolved<'a>(schema: &'a Value, root: &'a Value) -> &'a Value {
    match schema["$ref"].as_str() {
        Some(place) => root.pointer(place.trim_start_matches('#')).unwrap(),
        None => schema,
    }
}

/// The type in a word or two.
fn kind_of(schema: &Value, root: &Value) -> String {
    if let Some(place) = schema["$ref"].as_str() {
        if place.ends_with("/Gaussian") {
            return "mean and deviation".into();
        }
        if place.ends_with("/Interval95") {
            return "interval".into();
        }
    }
    let schema = resolved(schema, root);
    if let Some(word) = schema["const"].as_str() {
        return format!("`{word}`");
    }
    if let Some(words) = schema["enum"].as_array() {
        let words: Vec<String> = words
            .iter()
            .map(|w| format!("`{}`", w.as_str().unwrap_or("null")))
            .collect();
        return words.join(", ");
    }
    for list in ["oneOf", "anyOf"] {
        if let Some(branches) = schema[list].as_array() {
            let mut kinds: Vec<String> = branches.iter().map(|b| kind_of(b, root)).collect();
            kinds.dedup();
            return kinds.join(" or ");
        }
    }
    match &schema["type"] {
        Value::String(word) if word == "array" => match &schema["items"] {
            Value::Null => "list".into(),
            items => format!("list of {}", kind_of(items, root)),
        },
        Value::String(word) => word.clone(),
        Value::Array(words) => {
            let words: Vec<&str> = words.iter().filter_map(Value::as_str).collect();
            words.join(" or ")
        }
        _ => "value".into(),
    }
}

#[test]
fn command_json_matches_schema() {
    let documents = documents();
    let folder = tempfile::tempdir().unwrap();
    let mut seen = BTreeSet::new();
    let mut lines = outputs();
    let isotherms = "../shared/data/creep/pyvisco/time_user_raw.csv";
    let shift = format!("creep fit {isotherms} --shift-to 3degC --json");
    if repository().join(isotherms).exists() {
        lines.push(&shift);
    }
    for line in lines {
        let line = line.replace("OUT", folder.path().to_str().unwrap());
        let words: Vec<&str> = line.split_whitespace().collect();
        let mut command = Command::new(env!("CARGO_BIN_EXE_sinew"));
        let output = command
            .args(&words)
            .current_dir(repository())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        let text = String::from_utf8(output.stdout).unwrap();
        let value: Value =
            serde_json::from_str(&text).unwrap_or_else(|e| panic!("{line}: {e}\n{said}"));
        let name = value["schema"]
            .as_str()
            .unwrap_or_else(|| panic!("{line}: names no schema"));
        let document = documents.iter().find(|d| d.name == name);
        let document = document.unwrap_or_else(|| panic!("{line}: {name} is not published"));
        let faults = check(&document.schema, &value);
        assert!(faults.is_empty(), "sinew {line}: {faults:#?}");
        // The check sees a key that is missing and one that is too many.
        let mut spoiled = value.clone();
        spoiled
            .as_object_mut()
            .unwrap()
            .insert("surplus".into(), json!(1));
        spoiled.as_object_mut().unwrap().remove("schema");
        assert_eq!(check(&document.schema, &spoiled).len(), 2, "sinew {line}");
        seen.insert(document.name);
    }
    // Creep at several temperatures comes with ../shared only.
    if !seen.contains("sinew/creep-shift/2") {
        skipped("creep-shift needs ../shared");
        seen.insert("sinew/creep-shift/2");
    }
    // The laboratory's own are checked by its tests: crates/sinew-bench/tests/command.rs.
    seen.extend([
        "sinew/paper/2",
        "sinew/scenarios/2",
        "sinew/trajectory/2",
        "sinew/trend-simulate/2",
    ]);
    let unobservable: Vec<_> = documents
        .iter()
        .map(|d| d.name)
        .filter(|n| !seen.contains(n))
        .collect();
    assert!(
        unobservable.is_empty(),
        "no command was tried for {unobservable:?}"
    );
}
