//! ARCHITECTURE.md lists all crates, and the dependencies between them follow the layers.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

#[test]
fn architecture_lists_every_crate_and_valid_paths() {
    let page = read("ARCHITECTURE.md");
    for entry in std::fs::read_dir(root().join("crates")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(
            page.contains(&format!("`{name}`")),
            "{name} is not mentioned"
        );
    }
    // Words in backquotes that look like paths of the repository.
    let mut paths = 0;
    for word in page.split('`').skip(1).step_by(2) {
        let top = word.split('/').next().unwrap_or("");
        let is_path = word.contains('/')
            && !word.contains(' ')
            && [
                "crates", "robots", "ropes", "examples", "benches", "fuzz", "docs", ".ci",
            ]
            .contains(&top);
        if is_path {
            assert!(root().join(word).exists(), "{word} is not there");
            paths += 1;
        }
    }
    assert!(paths >= 5, "{paths} paths found");
    let lines = page.lines().count();
    assert!(lines <= 110, "one page, not {lines} lines");
}

#[test]
fn crate_dependencies_follow_layers() {
    const BELOW: [(&str, &[&str]); 17] = [
        ("sinew-files", &[]),
        ("sinew-model", &["sinew-files"]),
        ("sinew-log", &["sinew-files"]),
        ("sinew-generate", &["sinew-model"]),
        ("sinew-figure", &["sinew-files"]),
        ("sinew-camera", &["sinew-files", "sinew-figure"]),
        ("sinew-rope", &["sinew-files", "sinew-model"]),
        ("sinew-trend", &["sinew-files", "sinew-model", "sinew-rope"]),
        ("sinew-creep", &["sinew-files", "sinew-model", "sinew-rope"]),
        (
            "sinew-estimate",
            &[
                "sinew-files",
                "sinew-model",
                "sinew-log",
                "sinew-figure",
                "sinew-rope",
            ],
        ),
        (
            "sinew-sim",
            &[
                "sinew-files",
                "sinew-model",
                "sinew-log",
                "sinew-rope",
                "sinew-trend",
            ],
        ),
        ("sinew-transport", &["sinew-files", "sinew-log"]),
        (
            "sinew-watch-core",
            &[
                "sinew-files",
                "sinew-model",
                "sinew-log",
                "sinew-rope",
                "sinew-trend",
                "sinew-estimate",
            ],
        ),
        (
            "sinew-watch",
            &[
                "sinew-files",
                "sinew-model",
                "sinew-log",
                "sinew-rope",
                "sinew-trend",
                "sinew-estimate",
                "sinew-transport",
                "sinew-watch-core",
            ],
        ),
        (
            "sinew-report",
            &[
                "sinew-files",
                "sinew-model",
                "sinew-log",
                "sinew-figure",
                "sinew-rope",
                "sinew-trend",
                "sinew-creep",
                "sinew-camera",
                "sinew-estimate",
            ],
        ),
        (
            "sinew-bench",
            &[
                "sinew",
                "sinew-files",
                "sinew-model",
                "sinew-log",
                "sinew-figure",
                "sinew-rope",
                "sinew-trend",
                "sinew-creep",
                "sinew-camera",
                "sinew-estimate",
                "sinew-report",
                "sinew-sim",
            ],
        ),
        (
            "sinew",
            &[
                "sinew-files",
                "sinew-model",
                "sinew-log",
                "sinew-figure",
                "sinew-generate",
                "sinew-rope",
                "sinew-trend",
                "sinew-creep",
                "sinew-camera",
                "sinew-estimate",
                "sinew-report",
                "sinew-sim",
            ],
        ),
    ];
    for entry in std::fs::read_dir(root().join("crates")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(
            BELOW.iter().any(|(known, _)| *known == name),
            "what may {name} see?"
        );
    }
    for (name, sees) in BELOW {
        let manifest = read(&format!("crates/{name}/Cargo.toml"));
        let dependencies = manifest
            .split("[dependencies]")
            .nth(1)
            .and_then(|s| s.split("\n[").next())
            .unwrap();
        for (other, _) in BELOW {
            let named = dependencies
                .lines()
                .any(|l| l.split(['.', ' ', '=']).next() == Some(other));
            assert!(!named || sees.contains(&other), "{name} sees {other}");
        }
    }
}

#[test]
fn file_access_is_in_one_crate() {
    // Unbounded reads, and writes that can be half done: `sinew-files` has what stands for them.
    const ONLY_THERE: [&str; 9] = [
        "fs::read(",
        "fs::read_to_string(",
        "fs::write(",
        "fs::rename(",
        "fs::copy(",
        "File::create(",
        "File::create_new(",
        ".truncate(true)",
        "create_new(true)",
    ];
    let mut folders = vec![root().join("crates")];
    let mut files = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let relative = path.strip_prefix(root()).unwrap().display().to_string();
            let of_tests = ["tests", "tests.rs", "benches", "examples"]
                .iter()
                .any(|name| path.ends_with(name));
            if of_tests || relative == "crates/sinew-files" {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else if relative.ends_with(".rs") {
                files += 1;
                let text = std::fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]").next().unwrap_or_default();
                let code = code.replace("AtomicFile::create(", "");
                for call in ONLY_THERE {
                    assert!(!code.contains(call), "{relative}: {call}");
                }
            }
        }
    }
    assert!(files > 100, "{files} files found");
}
