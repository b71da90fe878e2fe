//! The tables of docs/src/validation.md against their data.

use crate::support;
use sinew_bench::validation::{STUDIES, Validation, render};

#[test]
fn validation_page_matches_data() {
    let read = |name: &str| std::fs::read_to_string(support::repository().join(name)).unwrap();
    let data: Validation = serde_json::from_str(&read("docs/src/validation.json")).unwrap();
    let page = read("docs/src/validation.md");
    let remedy = "write the tables with `sinew-bench validation --render-only`";
    assert!(render(&page, &data).unwrap() == page, "{remedy}");
    let changed = page.replacen("| S5 | 0.13,", "| S5 | 0.12,", 1);
    assert_ne!(changed, page);
    assert_eq!(render(&changed, &data).unwrap(), page);
    // Each study has a table, and each measurement names the command of today.
    for study in &STUDIES {
        let measured = &data.0[study.name];
        assert_eq!(
            measured.commands,
            study.commands(measured.n),
            "{}",
            study.name
        );
        assert!(page.contains(&measured.commands[0]), "{}", study.name);
    }
    assert_eq!(data.0.len(), STUDIES.len());
}

#[test]
fn table_without_data_returns_error() {
    let error = |page: &str| {
        render(page, &Validation::default())
            .unwrap_err()
            .to_string()
    };
    let missing = error("<!-- generated table: slips -->\n<!-- end of generated -->");
    assert!(missing.contains("--only slips"), "{missing}");
    let unclosed = error("<!-- generated table: slips -->");
    assert!(unclosed.contains("end mark"), "{unclosed}");
}
