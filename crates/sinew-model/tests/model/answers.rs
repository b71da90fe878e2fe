//! Golden results: numbers are compared with stored values to a millionth of their standard deviation, so that every
//! change of the results is detected. For an intended change, `SINEW_WRITE=1 cargo test -p PACKAGE golden` updates the
//! files; `git diff` shows the changed values.

#![allow(dead_code, reason = "each crate uses its own part")]

use sinew_model::Gaussian;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Numbers with their names, and how exactly each is held.
#[derive(Default)]
pub(crate) struct Answers {
    about: String,
    rows: Vec<(String, f64, f64)>,
}

impl Answers {
    pub(crate) fn about(&mut self, of: &str) {
        self.about = of.into();
    }

    /// A number that is held to a millionth of itself.
    pub(crate) fn number(&mut self, name: &str, value: f64) {
        self.rows
            .push((format!("{} {name}", self.about), value, value.abs()));
    }

    /// Compares a number to a millionth of its standard deviation.
    pub(crate) fn gaussian(&mut self, name: &str, value: Gaussian) {
        let name = format!("{} {name}", self.about);
        self.rows.push((name.clone(), value.mean, value.std.abs()));
        self.rows
            .push((format!("{name} ±"), value.std, value.std.abs()));
    }

    /// Compares a number to a millionth of its usual size.
    pub(crate) fn usually(&mut self, name: &str, value: f64, usual: f64) {
        self.rows
            .push((format!("{} {name}", self.about), value, usual));
    }

    /// One from 0 to 1.
    pub(crate) fn probability(&mut self, name: &str, value: f64) {
        self.rows
            .push((format!("{} {name}", self.about), value, 1.0));
    }

    /// Compares the numbers with those stored in a file, or updates the file.
    pub(crate) fn hold(&self, file: &str) {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
            .join("tests/reference")
            .join(file);
        let mut text = String::from("name,value\n");
        for (name, value, _) in &self.rows {
            let _written = writeln!(text, "{name},{value:.12e}");
        }
        if std::env::var_os("SINEW_WRITE").is_some() {
            std::fs::write(&path, text).expect("written");
            return;
        }
        let kept = std::fs::read_to_string(&path).expect("kept numbers");
        let kept: Vec<(&str, f64)> = (kept.lines().skip(1))
            .filter_map(|line| line.rsplit_once(','))
            .map(|(name, value)| (name, value.parse().expect("a number")))
            .collect();
        let names: Vec<&str> = self.rows.iter().map(|row| row.0.as_str()).collect();
        let kept_names: Vec<&str> = kept.iter().map(|row| row.0).collect();
        assert_eq!(names, kept_names, "other numbers than in {file}");
        let moved: Vec<String> = (self.rows.iter().zip(&kept))
            .filter(|((_, found, scale), (_, kept))| {
                !((found - kept).abs() <= 1e-6 * scale.max(1e-9) || found.is_nan() && kept.is_nan())
            })
            .map(|((name, found, _), (_, kept))| format!("{name}: {found:.8e}, was {kept:.8e}"))
            .collect();
        assert!(
            moved.is_empty(),
            "{} of {} numbers moved, among them\n{}",
            moved.len(),
            self.rows.len(),
            moved[..moved.len().min(12)].join("\n")
        );
    }
}
