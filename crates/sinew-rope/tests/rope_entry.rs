//! Parser of catalogue entries, and the location of its errors.

use proptest::prelude::*;
use sinew_rope::law::Parameter;
use sinew_rope::law::entry::{CatalogueEntry, Origin, Uncertainty};

const ROPE: &str = include_str!("../../../ropes/liros-dc000-0301.toml");

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
    assert_eq!(rope.law.len(), Parameter::ALL.len());
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
