//! What a rope has to do: tension and temperature over time, usually over and over.

use serde::{Deserialize, Serialize};
use sinew_model::rope::Load;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// Largest duty file read, bytes.
const DUTY_BYTES_MAX: u64 = 64 << 20;
/// Stretches a duty may have: a week of seconds.
const STRETCHES_MAX: usize = 604_800;

/// A stretch of a duty: linear from one load to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// At its start.
    pub from: Load,
    /// At its end.
    pub to: Load,
    /// s, above 0.
    pub duration_s: f64,
}

impl Stretch {
    /// Constant tension and temperature.
    pub fn hold(load: Load, duration_s: f64) -> Self {
        Self {
            from: load,
            to: load,
            duration_s,
        }
    }
}

/// A duty.
#[derive(Debug, Clone, PartialEq)]
pub struct Duty {
    /// What it is, in words.
    pub about: String,
    /// Its stretches in order, at least one.
    pub stretches: Vec<Stretch>,
    /// Whether it begins again when it has ended; otherwise its last load stays.
    pub repeat: bool,
}

/// Sums over a duty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DutySummary {
    /// Length of one cycle, s.
    pub duration_s: f64,
    /// Mean over time, N.
    pub tension_mean_n: f64,
    /// Smallest, N.
    pub tension_min_n: f64,
    /// Largest, N.
    pub tension_max_n: f64,
    /// Mean over time, °C.
    pub temperature_mean_c: f64,
    /// Smallest, °C.
    pub temperature_min_c: f64,
    /// Largest, °C.
    pub temperature_max_c: f64,
}

/// Why a duty was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DutyError {
    /// A file that can't be read.
    #[error("can't read {path}: {error}", path = path.display())]
    Read {
        /// File.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// A file too large to be a table of blocks.
    #[error("{path} has {bytes} bytes; a block table has at most {DUTY_BYTES_MAX}", path = path.display())]
    TooLarge {
        /// File.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// A file that is neither TOML nor CSV by its name.
    #[error("{path}: a duty is a .toml or .csv file", path = path.display())]
    Kind {
        /// File.
        path: PathBuf,
    },
    /// What the parser says, with its place.
    #[error("{file}: {message}")]
    Parse {
        /// File.
        file: String,
        /// What is wrong.
        message: String,
    },
    /// A value that can't be.
    #[error("{file}, {place}: {key} = {value}: {why}")]
    Value {
        /// File.
        file: String,
        /// Block or line.
        place: String,
        /// Key with its unit.
        key: String,
        /// What was found.
        value: String,
        /// What it must be.
        why: &'static str,
    },
    /// No block at all, or too many.
    #[error("{file}: {blocks} blocks; a duty has 1 to {STRETCHES_MAX}")]
    Blocks {
        /// File.
        file: String,
        /// Blocks found.
        blocks: usize,
    },
}

impl Duty {
    /// Constant tension and temperature for ever.
    pub fn constant(tension_n: f64, temperature_c: f64) -> Self {
        /// Where friction splits it, a stroke of a robot.
        const CYCLE_S: f64 = 10.0;
        Self {
            about: format!("{tension_n} N at {temperature_c} °C"),
            stretches: vec![Stretch::hold(
                Load::celsius(tension_n, temperature_c),
                CYCLE_S,
            )],
            repeat: true,
        }
    }

    /// Whether the load never changes.
    pub fn is_constant(&self) -> bool {
        let first = self.stretches[0].from;
        self.stretches
            .iter()
            .all(|s| s.from == first && s.to == first)
    }

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

    fn checked(stretches: Vec<Stretch>, repeat: bool, file: &str) -> Result<Self, DutyError> {
        if stretches.is_empty() || stretches.len() > STRETCHES_MAX {
            return Err(DutyError::Blocks {
                file: file.into(),
                blocks: stretches.len(),
            });
        }
        Ok(Self {
            about: file.into(),
            stretches,
            repeat,
        })
    }

    /// Sums over one cycle.
    pub fn summary(&self) -> DutySummary {
        let mut out = DutySummary {
            duration_s: 0.0,
            tension_mean_n: 0.0,
            tension_min_n: f64::INFINITY,
            tension_max_n: f64::NEG_INFINITY,
            temperature_mean_c: 0.0,
            temperature_min_c: f64::INFINITY,
            temperature_max_c: f64::NEG_INFINITY,
        };
        const ZERO_C_K: f64 = sinew_model::rope::CELSIUS_ZERO_K;
        for s in &self.stretches {
            out.duration_s += s.duration_s;
            for load in [s.from, s.to] {
                let (t, c) = (load.tension_n, load.temperature_k - ZERO_C_K);
                out.tension_mean_n += 0.5 * t * s.duration_s;
                out.temperature_mean_c += 0.5 * c * s.duration_s;
                out.tension_min_n = out.tension_min_n.min(t);
                out.tension_max_n = out.tension_max_n.max(t);
                out.temperature_min_c = out.temperature_min_c.min(c);
                out.temperature_max_c = out.temperature_max_c.max(c);
            }
        }
        out.tension_mean_n /= out.duration_s;
        out.temperature_mean_c /= out.duration_s;
        out
    }

    /// The same duty where friction along the routing multiplies the tension: half of each
    /// stretch with the rope running one way, half the other.
    #[must_use]
    pub fn with_friction(&self, mu_phi: f64) -> Self {
        if mu_phi == 0.0 {
            return self.clone();
        }
        let times = |load: Load, factor: f64| Load {
            tension_n: load.tension_n * factor,
            ..load
        };
        let half = |s: &Stretch, factor: f64| Stretch {
            from: times(s.from, factor),
            to: times(s.to, factor),
            duration_s: 0.5 * s.duration_s,
        };
        let stretches = self
            .stretches
            .iter()
            .flat_map(|s| [half(s, mu_phi.exp()), half(s, (-mu_phi).exp())])
            .collect();
        Self {
            stretches,
            ..self.clone()
        }
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
