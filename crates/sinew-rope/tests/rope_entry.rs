//! Parser of catalogue entries, the location of its errors, and the tables of the manual.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-rope --test all rope_entry::` regenerates the tables.

use proptest::prelude::*;
use sinew_rope::Catalogue;
use sinew_rope::law::Parameter;
use sinew_rope::law::endurance::EnduranceKey;
use sinew_rope::law::entry::{CatalogueEntry, Origin, Uncertainty, Value};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

const ROPE: &str = include_str!("../ropes/liros-dc000-0301.toml");

fn changed(from: &str, to: &str) -> String {
    assert!(ROPE.contains(from), "{from}");
    ROPE.replacen(from, to, 1)
}

#[test]
fn entry_values_have_origin() {
    let rope = CatalogueEntry::parse(ROPE, "rope.toml").expect("a rope");
    let b = &rope.law[&Parameter::Bedding];
    assert_eq!((b.value, b.origin), (0.42, Origin::Assumed));
    assert_eq!(b.uncertainty, Uncertainty::Factor(1.5));
    assert!((b.at(1.959_963_984_540_054) - 0.63).abs() < 1e-12);
    assert!((b.at(-1.959_963_984_540_054) - 0.28).abs() < 1e-12);
    let load = rope.breaking_load_n.as_ref().expect("published");
    assert_eq!((load.value, load.origin), (4450.0, Origin::Published));
    assert!(rope.sources.contains_key(&load.source));
    // One parameter has a default: 0.5 ± 0.5 (95 %), at least 0.
    assert_eq!(rope.law.len() + 1, Parameter::ALL.len());
    assert!(!rope.law.contains_key(&Parameter::PassPressureExponent));
    let exponent = |z: f64| {
        let drawn = rope.parameters_at(|_| z).expect("complete");
        drawn.pass_pressure_exponent
    };
    assert_eq!([exponent(0.0), exponent(-3.0)], [0.5, 0.0]);
    assert!((exponent(1.959_963_984_540_054) - 1.0).abs() < 1e-12);
    let stated = ROPE.to_owned()
        + "pass_pressure_exponent = { value = 0.2, origin = \"measured\", source = \"hand\" }\n";
    let rope = CatalogueEntry::parse(&stated, "rope.toml").expect("a rope");
    let stated = rope.parameters_at(|_| 1.0).expect("complete");
    assert_eq!(stated.pass_pressure_exponent, 0.2);
}

#[test]
fn entry_older_origin_is_accepted_as_assumed() {
    const ASSUMED: &str = "origin = \"assumed\"";
    const OLDER: &str = "origin = \"starting-guess\"";
    assert!(ROPE.contains(ASSUMED) && !ROPE.contains(OLDER));
    let rope = CatalogueEntry::parse(ROPE, "rope.toml").expect("a rope");
    let older = CatalogueEntry::parse(&ROPE.replace(ASSUMED, OLDER), "rope.toml").expect("a rope");
    assert_eq!(older, rope);
    assert_eq!(older.law[&Parameter::Bedding].origin, Origin::Assumed);
    assert!(!older.to_toml().contains(OLDER));
    let unknown = ROPE.replacen(ASSUMED, "origin = \"guess\"", 1);
    let error = CatalogueEntry::parse(&unknown, "rope.toml").expect_err("an unknown origin");
    assert!(!error.to_string().contains("starting-guess"), "{error}");
}

#[test]
fn missing_parameters_are_reported() {
    let rope =
        CatalogueEntry::parse(&changed("jamming =", "# jamming ="), "rope.toml").expect("a rope");
    assert_eq!(rope.parameters(), Err(vec!["jamming"]));
    let text = changed("weight_g_per_m =", "# weight_g_per_m =");
    let rope = CatalogueEntry::parse(&text, "rope.toml").expect("a rope");
    assert_eq!(rope.weight_g_per_m, None);
}

#[test]
fn invalid_entry_error_names_file_and_line() {
    let line = 1 + ROPE
        .lines()
        .position(|l| l.starts_with("jamming"))
        .expect("there");
    let at = format!("rope.toml, line {line}");
    for (from, to, words) in [
        (
            "jamming = { value = 3.0",
            "jamming = { value = -3.0",
            "must be between 0 and 30",
        ),
        (
            "jamming = { value = 3.0",
            "jamming = { value = nan",
            "must be between 0 and 30",
        ),
        (
            "jamming = { value = 3.0",
            "jaming = { value = 3.0",
            "unknown key 'jaming'",
        ),
        ("plus_minus = 1.0", "plus_minus = 0.0", "must be above 0"),
        (
            "plus_minus = 1.0",
            "plus_minus = 1.0, factor = 2.0",
            "not both",
        ),
    ] {
        let error = CatalogueEntry::parse(&changed(from, to), "rope.toml")
            .expect_err(to)
            .to_string();
        assert!(
            error.contains(words) && error.contains(&at),
            "{to}: {error}"
        );
    }
    for (from, to, words) in [
        ("source = \"table1\"", "source = \"nobody\"", "[sources]"),
        ("origin = \"published\"", "origin = \"fitted\"", "date"),
        (
            "origin = \"published\"",
            "origin = \"invented\"",
            "\"measured\"",
        ),
        ("material = \"HMPE\"", "material = \"silk\"", "must be HMPE"),
        ("name = \"liros", "name = \"Liros ", "lower case"),
        ("value = 1.50", "value = 0.0", "must be above 0"),
    ] {
        let error = CatalogueEntry::parse(&changed(from, to), "rope.toml")
            .expect_err(to)
            .to_string();
        assert!(
            error.contains(words) && error.contains("rope.toml"),
            "{to}: {error}"
        );
    }
}

#[test]
fn correlations_are_checked() {
    let with = |matrix: &str| {
        let tail = format!(
            "\n[correlation]\nparameters = [\"toe_percent\", \"jamming\"]\nmatrix = {matrix}\n"
        );
        CatalogueEntry::parse(&(ROPE.to_string() + &tail), "rope.toml")
    };
    let rope = with("[[1.0, 0.6], [0.6, 1.0]]").expect("a rope");
    let c = rope.correlation.expect("read");
    assert!((c.cholesky[1][0] - 0.6).abs() < 1e-15 && (c.cholesky[1][1] - 0.8).abs() < 1e-12);
    for bad in [
        "[[1.0, 0.6], [0.5, 1.0]]",
        "[[1.0, 1.6], [1.6, 1.0]]",
        "[[1.0]]",
        "[[2.0, 0.0], [0.0, 1.0]]",
    ] {
        assert!(with(bad).is_err(), "{bad}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(2018),
        ..ProptestConfig::with_cases(400)
    })]

    /// Random deletions and insertions give an error or a rope, never a panic.
    #[test]
    fn damaged_entries_never_panic(at in 0..ROPE.len(), length in 0..200usize, put in "\\PC{0,12}") {
        let end = (at + length).min(ROPE.len());
        let mut bytes = ROPE.as_bytes()[..at].to_vec();
        bytes.extend(put.as_bytes());
        bytes.extend(&ROPE.as_bytes()[end..]);
        let text = String::from_utf8_lossy(&bytes);
        if let Ok(rope) = CatalogueEntry::parse(&text, "rope.toml") {
            let again = CatalogueEntry::parse(&rope.to_toml(), "again.toml");
            prop_assert_eq!(again, Ok(rope));
        }
    }
}

fn number(value: f64) -> String {
    let text: String = match value.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => value.to_string(),
        _ => format!("{value:e}"),
    };
    match text.strip_prefix('-') {
        Some(size) => format!("−{size}"),
        None => text,
    }
}

/// Row of a table of the manual: key, meaning, permitted values, value, 95 % interval, origin.
fn row(key: &str, meaning: &str, permitted: &str, value: &Value) -> String {
    let interval = match value.uncertainty {
        Uncertainty::NotSpecified => "exact".into(),
        Uncertainty::Factor(f) => format!("factor {}", number(f)),
        Uncertainty::PlusMinus(d) => format!("± {}", number(d)),
    };
    let (meaning, value, origin) = (
        meaning.trim_end_matches('.'),
        number(value.value),
        format!("{}, `{}`", value.origin.name(), value.source),
    );
    format!("| `{key}` | {meaning} | {permitted} | {value} | {interval} | {origin} |\n")
}

/// Table of the parameters, and the table of the sources that they name.
fn tables(rows: &str, used: &[&Value], sources: &BTreeMap<String, String>) -> String {
    let mut out = format!(
        "| key | meaning | permitted | value | 95 % | origin, source |\n|---|---|---|---|---|---|\n{rows}\n| source | text |\n|---|---|\n"
    );
    for (key, text) in sources {
        if used.iter().any(|value| value.source == *key) {
            writeln!(out, "| `{key}` | {text} |").expect("a string takes all");
        }
    }
    out
}

#[test]
fn manual_lists_parameters_with_origin() {
    let catalogue = Catalogue::shipped().expect("shipped ropes");
    let rope = catalogue.find("liros-dc000-0301").expect("there");
    let law = &rope.entry.law;
    let with_defaults = rope.entry.law_with_defaults();
    let described = rope.describe();
    let exponent = &described.law["pass_pressure_exponent"];
    assert_eq!((exponent.value, exponent.plus_minus), (0.5, Some(0.5)));
    assert!(described.sources.contains_key(&exponent.source));
    let rows: String = (Parameter::ALL.iter())
        .map(|p| {
            let key = format!("law.{}", p.name());
            let value = &with_defaults[p];
            row(&key, p.meaning(), p.must(), value)
        })
        .collect();
    let class = rope.endurance().expect("a shipped class");
    let endurance: String = (EnduranceKey::ALL.iter())
        .map(|k| {
            let (low, high) = k.range();
            let permitted = format!("{} to {}", number(low), number(high));
            let key = format!("endurance.{}", k.name());
            row(&key, k.meaning(), &permitted, &class.endurance[k])
        })
        .collect();
    let law: Vec<&Value> = law.values().collect();
    let of_class: Vec<&Value> = class.endurance.values().collect();
    let mut made = [
        tables(&rows, &law, &rope.entry.sources),
        tables(&endurance, &of_class, &class.sources),
    ]
    .into_iter();
    const BEGIN: &str = "<!-- made by a test: begin -->\n";
    const END: &str = "<!-- made by a test: end -->";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/reference/rope.md");
    let page = std::fs::read_to_string(&path).expect("the page");
    let mut parts = page.split(BEGIN);
    let mut wanted = parts.next().expect("text").to_owned();
    for part in parts {
        let (_, after) = part.split_once(END).expect("an end mark");
        let table = made.next().expect("two tables");
        wanted += &format!("{BEGIN}\n{table}\n{END}{after}");
    }
    assert_eq!(made.next(), None, "two marks");
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::write(&path, &wanted).expect("written");
    } else {
        assert!(page == wanted, "SINEW_WRITE=1 writes the tables anew");
    }
    // An assumed value has an interval unless it is zero.
    for value in law {
        let assumed = value.origin == Origin::Assumed && value.value != 0.0;
        assert!(
            !assumed || value.uncertainty != Uncertainty::NotSpecified,
            "{value:?}"
        );
    }
}
