//! Tables of blocks: TOML and CSV.

use super::duty::{Duty, Stretch};
use crate::law::RopeLoad;
use sinew_files::csv::Table;
use sinew_files::{Bound, Budget, Fault, Fields, Located, Section, TomlFile, read_text};
use std::path::Path;

impl Duty {
    /// Opens a block table, TOML or CSV by the end of its name.
    ///
    /// # Errors
    /// Returns [`Located`] with file, line, key and value.
    pub fn open(path: &Path) -> Result<Self, Located> {
        let file = path.display().to_string();
        let read = match path.extension().and_then(|e| e.to_str()) {
            Some("toml") => Self::from_toml,
            Some("csv") => Self::from_csv,
            _ => {
                let problem = "a duty is a .toml or .csv file";
                return Err(Located::new(&file, Fault::Syntax, problem));
            }
        };
        read(&read_text(path, &Budget::DESCRIPTION)?, &file)
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
    /// As [`Duty::open`].
    pub fn from_toml(text: &str, file: &str) -> Result<Self, Located> {
        let read = |s: &Section<'_>| -> Result<_, Located> {
            let repeat = s.flag_or("repeat", true)?;
            Ok((s.each("block", stretch)?, repeat))
        };
        let (stretches, repeat) = TomlFile::parse(text, file)?.root().whole(read)?;
        Self::checked(stretches, repeat, file)
    }

    /// Reads a block table in CSV with a header line: the columns of [`Duty::from_toml`], with empty cells
    /// for omitted keys. The duty repeats.
    ///
    /// # Errors
    /// As [`Duty::open`].
    pub fn from_csv(text: &str, file: &str) -> Result<Self, Located> {
        let table = Table::parse(text, file)?;
        table.only(&COLUMNS)?;
        let rows = table.rows().map(|row| stretch(&row));
        Self::checked(rows.collect::<Result<_, _>>()?, true, file)
    }
}

const COLUMNS: [&str; 8] = [
    "duration_s",
    "duration_min",
    "duration_h",
    "duration_d",
    "tension_n",
    "tension_to_n",
    "temperature_c",
    "temperature_to_c",
];
/// Keys of a length, and their seconds.
const DURATIONS: [(&str, f64); 4] = [
    ("duration_s", 1.0),
    ("duration_min", 60.0),
    ("duration_h", 3600.0),
    ("duration_d", 86_400.0),
];
/// A hundred years.
const DURATION_S_MAX: f64 = 3.2e9;
/// Permitted tension of a block, N.
const TENSION: Bound = Bound::Within(0.0, 1e9);
const TEMPERATURE: Bound = Bound::Within(-100.0, 200.0);

fn stretch(block: &impl Fields) -> Result<Stretch, Located> {
    let mut given = Vec::new();
    for (key, unit) in DURATIONS {
        if let Some(v) = block.number(key, Bound::Positive)? {
            given.push((key, v * unit));
        }
    }
    let t0 = block.need("tension_n", TENSION, "the tension at its start")?;
    let t1 = block.number_or("tension_to_n", TENSION, t0)?;
    let c0 = block.number_or("temperature_c", TEMPERATURE, 23.0)?;
    let c1 = block.number_or("temperature_to_c", TEMPERATURE, c0)?;
    let [(key, duration_s)] = given[..] else {
        let reason = "give one of duration_s, duration_min, duration_h, duration_d";
        return Err(block.missing("duration", reason));
    };
    if duration_s > DURATION_S_MAX {
        return Err(block.invalid(key, "at most 100 years"));
    }
    Ok(Stretch {
        from: RopeLoad::celsius(t0, c0),
        to: RopeLoad::celsius(t1, c1),
        duration_s,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn duty_toml_and_csv_give_same_blocks() {
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
    fn invalid_block_error_names_location() {
        for (text, words) in [
            ("", "0 blocks"),
            ("[[block]]\ntension_n = 1\n", "duration"),
            (
                "[[block]]\nduration_s = 1\nduration_h = 1\ntension_n = 1\n",
                "give one",
            ),
            (
                "repeat = true\n\n[[block]]\nduration_s = -1\ntension_n = 1\n",
                "line 4",
            ),
            (
                "[[block]]\nduration_s = 1\ntension_n = -5\n",
                "between 0 and 1000000000 N",
            ),
            (
                "[[block]]\nduration_s = 1\ntension_n = nan\n",
                "between 0 and 1000000000 N",
            ),
            (
                "[[block]]\nduration_s = 1\ntension_n = 1\ntemperature_c = 900\n",
                "200 °C",
            ),
            ("[[block]]\nduration_s = 1\ntension = 1\n", "unknown key"),
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
