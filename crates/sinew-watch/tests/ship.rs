//! Shipped files are consistent with the program.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-watch ship` regenerates the manual page.

use clap::CommandFactory as _;
use sinew_watch::args::Args;
use sinew_watch::config::Config;
use sinew_watch::web::metrics::ABOUT;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("ship")
}

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).unwrap()
}

#[test]
fn manual_page_matches_program() {
    let mut page = Vec::new();
    clap_mangen::Man::new(Args::command())
        .render(&mut page)
        .unwrap();
    let path = folder().join("sinew-watch.1");
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let found = std::fs::read(&path).unwrap_or_default();
    assert!(found == page, "regenerate it with SINEW_WRITE=1");
}

#[test]
fn dashboard_and_alerts_use_existing_metrics() {
    let known: BTreeSet<&str> = ABOUT.iter().map(|(name, ..)| *name).collect();
    for name in ["grafana.json", "prometheus-alerts.yml"] {
        let text = text(name);
        let is_part = |c: char| c.is_ascii_lowercase() || c == '_';
        let asked: BTreeSet<&str> = text
            .match_indices("sinew_")
            .map(|(at, _)| text[at..].split(|c| !is_part(c)).next().unwrap())
            .collect();
        let unknown: Vec<_> = asked.difference(&known).collect();
        assert!(unknown.is_empty() && asked.len() > 4, "{name}: {unknown:?}");
    }
}

#[test]
fn dashboard_panels_do_not_overlap() {
    let registry: serde_json::Value = serde_json::from_str(&text("grafana.json")).unwrap();
    let mut taken = BTreeSet::new();
    let mut ids = BTreeSet::new();
    for panel in registry["panels"].as_array().unwrap() {
        assert!(ids.insert(panel["id"].as_u64().unwrap()), "{panel}");
        let of = |name: &str| panel["gridPos"][name].as_u64().unwrap();
        assert!(of("x") + of("w") <= 24, "{panel}");
        for x in of("x")..of("x") + of("w") {
            for y in of("y")..of("y") + of("h") {
                assert!(
                    taken.insert((x, y)),
                    "{} overlaps another panel",
                    panel["title"]
                );
            }
        }
    }
}

#[test]
fn shipped_configuration_is_valid() {
    let config = Config::parse(&text("watch.toml"), "watch.toml", Path::new("/etc/sinew")).unwrap();
    assert_eq!(config.robots.len(), 1);
    assert!(!config.web.needs_token());
}

#[test]
fn debian_package_contains_shipped_files() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let manifest = std::fs::read_to_string(manifest).unwrap();
    for entry in std::fs::read_dir(folder()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let of_its_own = ["Containerfile", "sinew-watch.service"].contains(&name.as_str());
        assert!(
            of_its_own || manifest.contains(&format!("\"ship/{name}\"")),
            "{name}: missing in the Debian package"
        );
    }
}
