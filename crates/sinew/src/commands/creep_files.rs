//! Test files and what is said about them on the command line.

use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, complain};
use crate::text::plain;
use clap::Args;
use sinew_creep::{Analysis, AnalyzeOptions, Conditions, PrepareOptions, Prepared, Source};
use sinew_log::{ColumnChoice, Specimen, TestOptions, TestQuantity, read_test};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct TestFiles {
    /// Test recordings: CSV, XLSX or Parquet
    #[arg(required = true, value_name = "FILES")]
    pub(crate) files: Vec<PathBuf>,
    /// What a column is, such as force=Kraft:N (may be repeated)
    #[arg(long, value_name = "QUANTITY=COLUMN[:UNIT]", help_heading = "Reading")]
    column: Vec<ColumnChoice>,
    /// Column that tells specimens apart (may be repeated)
    #[arg(long, value_name = "COLUMN", help_heading = "Reading")]
    specimen: Vec<String>,
    /// Sheet of a workbook
    #[arg(long, value_name = "NAME", help_heading = "Reading")]
    sheet: Option<String>,
    /// Gauge length, mm, for elongations of files that don't say it
    #[arg(long, value_name = "MM", help_heading = "Reading")]
    gauge_length_mm: Option<f64>,
    /// Cross-section, mm², for the creep modulus
    #[arg(long, value_name = "MM2", help_heading = "Reading")]
    area_mm2: Option<f64>,
    /// Temperature, °C, of files that don't record it
    #[arg(
        long,
        value_name = "C",
        allow_negative_numbers = true,
        help_heading = "Reading"
    )]
    temperature_c: Option<f64>,
    /// Keep grip slips and outliers instead of taking them out
    #[arg(long, help_heading = "Reading")]
    keep_faults: bool,
    /// Column or line of the head that names a group of repeats (may be repeated)
    #[arg(long, value_name = "COLUMN", help_heading = "Reading")]
    pub(crate) group: Vec<String>,
    /// Start of the straight line of m_E, min after the load
    #[arg(long, value_name = "MIN", default_value_t = 20.0)]
    slope_from_min: f64,
    /// Level of the intervals
    #[arg(long, value_name = "SHARE", default_value_t = 0.95)]
    pub(crate) level: f64,
    /// Seed of the draws behind the intervals
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,

    /// Write a table, one line per specimen
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) csv: Option<PathBuf>,
    /// Write a report with plots as one HTML file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) report: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long, help_heading = "Output")]
    pub(crate) json: bool,
    /// Nothing on stderr
    #[arg(long, help_heading = "Output")]
    pub(crate) quiet: bool,
    /// Standard the report cites
    #[arg(
        long,
        value_name = "TEXT",
        default_value = "ISO 899-1 (tensile creep), evaluation",
        help_heading = "Output"
    )]
    standard: String,
    /// Preconditioning the report states
    #[arg(long, value_name = "TEXT", help_heading = "Output")]
    preconditioning: Option<String>,
    /// Atmosphere, grips and extension measurement the report states
    #[arg(long, value_name = "TEXT", help_heading = "Output")]
    conditions: Option<String>,
}

/// What was read and analysed.
pub(crate) struct Tests {
    pub(crate) sources: Vec<Source>,
    pub(crate) prepared: Vec<Prepared>,
    pub(crate) analyses: Vec<Analysis>,
    pub(crate) groups: Vec<String>,
    pub(crate) failures: Vec<String>,
}

impl TestFiles {
    /// What the laboratory states.
    pub(crate) fn conditions(&self) -> Conditions {
        Conditions {
            standard: self.standard.clone(),
            preconditioning: self.preconditioning.clone(),
            conditions: self.conditions.clone(),
        }
    }

    /// Reads the files only: specimens with their group.
    pub(crate) fn specimens(&self) -> Result<(Vec<Source>, Vec<Specimen>), Failure> {
        let inputs: Vec<_> = self.files.iter().map(|f| ("FILES", f.as_path())).collect();
        let outputs: Vec<_> = [("--csv", &self.csv), ("--report", &self.report)]
            .into_iter()
            .filter_map(|(name, path)| Some((name, path.as_deref()?)))
            .collect();
        check_outputs(&outputs, &inputs)?;
        let within = |name: &str, value: f64, low: f64, high: f64| {
            if value > low && value < high {
                Ok(())
            } else {
                Err(Failure::Refused(format!(
                    "--{name} {value}: must lie between {low} and {high}"
                )))
            }
        };
        within("level", self.level, 0.5, 0.9999)?;
        within("slope-from-min", self.slope_from_min, -1e-9, 1e9)?;
        if let Some(mm) = self.gauge_length_mm {
            within("gauge-length-mm", mm, 0.0, 1e9)?;
        }
        if let Some(mm2) = self.area_mm2 {
            within("area-mm2", mm2, 0.0, 1e12)?;
        }
        let options = TestOptions {
            columns: self.column.clone(),
            specimen_columns: self.specimen.clone(),
            sheet: self.sheet.clone(),
        };
        let mut sources = Vec::new();
        let mut specimens: Vec<Specimen> = Vec::new();
        for path in &self.files {
            let file = read_test(path, &options)?;
            if !self.quiet {
                for note in &file.notes {
                    complain("note", &plain(&format!("{}: {note}", file.file)));
                }
            }
            sources.push(Source {
                file: file.file.clone(),
                sha256: file.sha256,
                columns: file
                    .columns
                    .iter()
                    .map(|c| {
                        [
                            c.quantity.name().to_owned(),
                            c.column.clone(),
                            c.unit.clone(),
                        ]
                    })
                    .collect(),
                notes: file.notes,
            });
            for mut specimen in file.specimens {
                // The same name in two files is two specimens.
                if specimens.iter().any(|s| s.name == specimen.name) {
                    specimen.name = format!("{} ({})", specimen.name, file.file);
                }
                specimens.push(specimen);
            }
        }
        Ok((sources, specimens))
    }

    /// Reads, prepares and analyses; a specimen that can't be is a failure with its reason.
    pub(crate) fn read(&self) -> Result<Tests, Failure> {
        let (sources, specimens) = self.specimens()?;
        let prepare = PrepareOptions {
            gauge_length_m: self.gauge_length_mm.map(|mm| mm * 1e-3),
            area_m2: self.area_mm2.map(|mm2| mm2 * 1e-6),
            temperature_c: self.temperature_c,
            keep_faults: self.keep_faults,
        };
        let analyze = AnalyzeOptions {
            slope_from_s: 60.0 * self.slope_from_min,
            level: self.level,
            seed: self.seed,
        };
        for column in &self.group {
            if specimens
                .iter()
                .all(|s| label(s, &sources, column).is_none())
            {
                let known: Vec<&str> = specimens
                    .first()
                    .map(|s| {
                        let attributes = s.attributes.iter().map(|a| a.0.as_str());
                        let columns = sources.iter().flat_map(|s| &s.columns);
                        let named = columns.map(|c| c[1].as_str());
                        attributes
                            .chain(named.filter(|c| label(s, &sources, c).is_some()))
                            .collect()
                    })
                    .unwrap_or_default();
                return Err(Failure::Refused(plain(&format!(
                    "--group {column}: no such column; there are {}",
                    known.join(", ")
                ))));
            }
        }
        let bar = Bar::new("analysing", self.quiet);
        let total = specimens.len() as f64;
        let results = sinew_creep::each(
            &specimens,
            |specimen| {
                let prepared = sinew_creep::prepare(specimen, &prepare)?;
                let analysis = sinew_creep::analyze(&prepared, &analyze)?;
                Ok((prepared, analysis))
            },
            |done| bar.set(done as f64, total),
        );
        let mut tests = Tests {
            sources,
            prepared: Vec::new(),
            analyses: Vec::new(),
            groups: Vec::new(),
            failures: Vec::new(),
        };
        for (specimen, result) in specimens.iter().zip(results) {
            match result {
                Ok((prepared, analysis)) => {
                    tests.prepared.push(prepared);
                    tests.analyses.push(analysis);
                    let group = self.group_of(specimen, &tests.sources);
                    tests.groups.push(group);
                }
                Err(error) => {
                    let error: sinew_creep::CreepError = error;
                    tests.failures.push(error.to_string());
                }
            }
        }
        if tests.analyses.is_empty() {
            return Err(Failure::Refused(plain(&tests.failures.join("\n"))));
        }
        if !self.quiet {
            for failure in &tests.failures {
                complain("warning", &plain(failure));
            }
        }
        Ok(tests)
    }

    fn group_of(&self, specimen: &Specimen, sources: &[Source]) -> String {
        let words: Vec<String> = self
            .group
            .iter()
            .filter_map(|column| label(specimen, sources, column))
            .collect();
        if words.is_empty() {
            "all".to_owned()
        } else {
            words.join(" / ")
        }
    }
}

/// What a column says of a whole specimen: its text, or its only number in its file's own unit.
fn label(specimen: &Specimen, sources: &[Source], column: &str) -> Option<String> {
    if let Some(text) = specimen.attribute(column) {
        return Some(text.to_owned());
    }
    let used = sources
        .iter()
        .flat_map(|s| &s.columns)
        .find(|c| c[1].eq_ignore_ascii_case(column))?;
    let quantity: TestQuantity = used[0].parse().ok()?;
    let value = specimen.constant(quantity)?;
    Some(if quantity.unit() == used[2] {
        format!("{value}")
    } else {
        format!("{} {}", short(value), quantity.unit())
    })
}

/// One line of a CSV file, quoted where needed.
pub(crate) fn csv_line<S: AsRef<str>>(cells: &[S]) -> String {
    let quoted: Vec<String> = cells
        .iter()
        .map(|cell| {
            let cell = cell.as_ref();
            if cell.contains([',', '"', '\n', '\r']) {
                format!("\"{}\"", cell.replace('"', "\"\""))
            } else {
                cell.to_owned()
            }
        })
        .collect();
    quoted.join(",") + "\n"
}

/// Writes the table of specimens.
pub(crate) fn write_csv(path: &std::path::Path, text: &str) -> Result<(), Failure> {
    sinew_files::write_file(path, text.as_bytes())?;
    Ok(())
}

/// A number to three digits.
pub(crate) fn short(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}
