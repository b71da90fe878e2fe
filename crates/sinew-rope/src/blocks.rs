//! Tables of blocks: TOML and CSV.

use super::duty::{DUTY_BYTES_MAX, Duty, DutyError, Stretch};
use serde::Deserialize;
use sinew_model::rope::Load;
use std::path::Path;
use toml::Spanned;

impl Duty {
    /// Opens a block table, TOML or CSV by the end of its name.
    ///
    /// # Errors
    /// [`DutyError`] with file, place, key and value.
    pub fn open(path: &Path) -> Result<Self, DutyError> {
        let read = |error| DutyError::Read {
            path: path.to_path_buf(),
            error,
        };
        let bytes = std::fs::metadata(path).map_err(read)?.len();
        if bytes > DUTY_BYTES_MAX {
            return Err(DutyError::TooLarge {
                path: path.to_path_buf(),
                bytes,
            });
        }
        let text = std::fs::read_to_string(path).map_err(read)?;
        let file = path.display().to_string();
        match path.extension().and_then(|e| e.to_str()) {
            Some("toml") => Self::from_toml(&text, &file),
            Some("csv") => Self::from_csv(&text, &file),
            _ => Err(DutyError::Kind {
                path: path.to_path_buf(),
            }),
        }
    }

    /// Reads a block table in TOML:
    ///
    /// ```toml
    /// repeat = true                # optional, true: the blocks come over and over
    /// [[block]]
    /// duration_h = 8.0             # or duration_s, duration_min, duration_d
    /// tension_n = 60.0             # at its start
    /// tension_to_n = 90.0          # optional: linear to this; else constant
    /// temperature_c = 23.0         # optional, 23
    /// temperature_to_c = 40.0      # optional
    /// ```
    ///
    /// # Errors
    /// [`DutyError`].
    pub fn from_toml(text: &str, file: &str) -> Result<Self, DutyError> {
        let raw: RawDuty = toml::from_str(text).map_err(|e| DutyError::Parse {
            file: file.into(),
            message: e.to_string().trim_end().into(),
        })?;
        let mut stretches = Vec::with_capacity(raw.block.len());
        for block in &raw.block {
            let before = &text.as_bytes()[..block.span().start.min(text.len())];
            let line = 1 + before.iter().filter(|b| **b == b'\n').count();
            stretches.push(block.as_ref().stretch(file, &format!("line {line}"))?);
        }
        Self::checked(stretches, raw.repeat, file)
    }

    /// Reads a block table in CSV with a header line: the columns of [`Duty::from_toml`], empty
    /// cells where a key would be left out. It repeats.
    ///
    /// # Errors
    /// [`DutyError`].
    pub fn from_csv(text: &str, file: &str) -> Result<Self, DutyError> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let mut stretches = Vec::new();
        for (i, row) in reader.deserialize::<RawBlock>().enumerate() {
            let block = row.map_err(|e| DutyError::Parse {
                file: file.into(),
                message: e.to_string(),
            })?;
            stretches.push(block.stretch(file, &format!("row {}", i + 1))?);
        }
        Self::checked(stretches, true, file)
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDuty {
    #[serde(default = "yes")]
    repeat: bool,
    #[serde(default)]
    block: Vec<Spanned<RawBlock>>,
}

fn yes() -> bool {
    true
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawBlock {
    duration_s: Option<f64>,
    duration_min: Option<f64>,
    duration_h: Option<f64>,
    duration_d: Option<f64>,
    tension_n: f64,
    tension_to_n: Option<f64>,
    temperature_c: Option<f64>,
    temperature_to_c: Option<f64>,
}

impl RawBlock {
    fn stretch(&self, file: &str, place: &str) -> Result<Stretch, DutyError> {
        let wrong = |key: &str, value: String, why| DutyError::Value {
            file: file.into(),
            place: place.into(),
            key: key.into(),
            value,
            why,
        };
        let durations = [
            ("duration_s", self.duration_s, 1.0),
            ("duration_min", self.duration_min, 60.0),
            ("duration_h", self.duration_h, 3600.0),
            ("duration_d", self.duration_d, 86_400.0),
        ];
        let mut given = durations
            .iter()
            .filter_map(|(key, value, unit)| value.map(|v| (*key, v, v * unit)));
        let (Some((key, value, duration_s)), None) = (given.next(), given.next()) else {
            return Err(wrong(
                "duration",
                "(none or several)".into(),
                "give one of duration_s, duration_min, duration_h, duration_d",
            ));
        };
        // A hundred years.
        if !(duration_s > 0.0 && duration_s <= 3.2e9) {
            return Err(wrong(
                key,
                value.to_string(),
                "must be above 0 and at most 100 years",
            ));
        }
        let tension = |key: &str, v: f64| {
            if (0.0..1e9).contains(&v) {
                Ok(v)
            } else {
                Err(wrong(key, v.to_string(), "must be at least 0 N"))
            }
        };
        let temperature = |key: &str, v: f64| {
            if (-100.0..=200.0).contains(&v) {
                Ok(v)
            } else {
                Err(wrong(key, v.to_string(), "must be −100 to 200 °C"))
            }
        };
        let t0 = tension("tension_n", self.tension_n)?;
        let t1 = tension("tension_to_n", self.tension_to_n.unwrap_or(t0))?;
        let c0 = temperature("temperature_c", self.temperature_c.unwrap_or(23.0))?;
        let c1 = temperature("temperature_to_c", self.temperature_to_c.unwrap_or(c0))?;
        Ok(Stretch {
            from: Load::celsius(t0, c0),
            to: Load::celsius(t1, c1),
            duration_s,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn toml_and_csv_say_the_same() {
        let toml = "[[block]]\nduration_h = 8\ntension_n = 60\ntension_to_n = 90.5\n\
                    temperature_c = 40\n[[block]]\nduration_min = 960\ntension_n = 30\n";
        let csv = "duration_h,duration_min,tension_n,tension_to_n,temperature_c\n\
                   8,,60,90.5,40\n,960,30,,\n";
        let a = Duty::from_toml(toml, "x").expect("toml");
        let b = Duty::from_csv(csv, "x").expect("csv");
        assert_eq!(a, b);
        let s = a.summary();
        assert_eq!(s.duration_s, 86_400.0);
        assert!((s.tension_mean_n - (75.25 + 2.0 * 30.0) / 3.0).abs() < 1e-9);
        assert_eq!((s.tension_min_n, s.tension_max_n), (30.0, 90.5));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        for (text, words) in [
            ("", "0 blocks"),
            ("[[block]]\ntension_n = 1\n", "duration"),
            (
                "[[block]]\nduration_s = 1\nduration_h = 1\ntension_n = 1\n",
                "give one",
            ),
            (
                "repeat = true\n\n[[block]]\nduration_s = -1\ntension_n = 1\n",
                "line 3",
            ),
            (
                "[[block]]\nduration_s = 1\ntension_n = -5\n",
                "at least 0 N",
            ),
            (
                "[[block]]\nduration_s = 1\ntension_n = nan\n",
                "at least 0 N",
            ),
            (
                "[[block]]\nduration_s = 1\ntension_n = 1\ntemperature_c = 900\n",
                "200 °C",
            ),
            ("[[block]]\nduration_s = 1\ntension = 1\n", "unknown field"),
        ] {
            let error = Duty::from_toml(text, "duty.toml")
                .expect_err(text)
                .to_string();
            assert!(
                error.contains(words) && error.contains("duty.toml"),
                "{text}: {error}"
            );
        }
        let error = Duty::from_csv("duration_s,tension_n\n1,x\n", "d.csv").expect_err("x");
        assert!(error.to_string().contains("d.csv"), "{error}");
    }
}
