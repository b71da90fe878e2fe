//! Input and output options of creep tests.

use crate::files::{Named, check_outputs, write_table, write_text};
use crate::terminal::{Bar, Failure, Word, answer_as, complain};
use crate::text::{plain, plain_lines};
use clap::Args;
use sinew_creep::{
    AnalyzeOptions, AnalyzeRequest, ColumnChoice, Conditions, PrepareOptions, Source, Specimen,
    TestOptions, Tests,
};
use sinew_figure::Page;
use sinew_files::JsonDocument;
use sinew_log::Table;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct TestFiles {
    /// Test recordings: CSV, XLSX or Parquet
    #[arg(required = true, value_name = "FILES")]
    files: Vec<PathBuf>,
    /// Column mapping, e.g. force=Kraft:N (repeatable)
    #[arg(long, value_name = "QUANTITY=COLUMN[:UNIT]", help_heading = "Input")]
    column: Vec<ColumnChoice>,
    /// Column that identifies specimens (repeatable)
    #[arg(long, value_name = "COLUMN", help_heading = "Input")]
    specimen: Vec<String>,
    /// Sheet of a workbook
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    sheet: Option<String>,
    /// Gauge length, mm, for files with elongation and without gauge length
    #[arg(long, value_name = "MM", help_heading = "Input")]
    gauge_length_mm: Option<f64>,
    /// Cross-section, mm², for the creep modulus
    #[arg(long, value_name = "MM2", help_heading = "Input")]
    area_mm2: Option<f64>,
    /// Temperature, °C, for files without temperature
    #[arg(
        long,
        value_name = "C",
        allow_negative_numbers = true,
        help_heading = "Input"
    )]
    temperature_c: Option<f64>,
    /// Keep grip slips and outliers [default: removed]
    #[arg(long, help_heading = "Input")]
    keep_artefacts: bool,
    /// Column or header line with the group of repeats (repeatable)
    #[arg(long, value_name = "COLUMN", help_heading = "Input")]
    pub(super) group: Vec<String>,
    /// Start of the straight line of m_E, min after loading
    #[arg(long, value_name = "MIN", default_value_t = 20.0)]
    slope_from_min: f64,
    /// Probability of the intervals
    #[arg(long, value_name = "SHARE", default_value_t = 0.95)]
    pub(super) level: f64,
    /// Random seed of the intervals
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,

    /// Write a table, one row per specimen, law or parameter; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Write measurements and forecasts over time; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(super) series: Option<PathBuf>,
    /// Write a report with plots as one HTML file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Suppress messages on stderr
    #[arg(long, help_heading = "Output")]
    pub(super) quiet: bool,
    /// Standard cited in the report
    #[arg(
        long,
        value_name = "TEXT",
        default_value = "ISO 899-1 (tensile creep), evaluation",
        help_heading = "Output"
    )]
    standard: String,
    /// Preconditioning stated in the report
    #[arg(long, value_name = "TEXT", help_heading = "Output")]
    preconditioning: Option<String>,
    /// Atmosphere, grips and extension measurement stated in the report
    #[arg(long, value_name = "TEXT", help_heading = "Output")]
    conditions: Option<String>,
}

impl TestFiles {
    /// Conditions specified by the laboratory.
    pub(super) fn conditions(&self) -> Conditions {
        Conditions {
            standard: self.standard.clone(),
            preconditioning: self.preconditioning.clone(),
            conditions: self.conditions.clone(),
        }
    }

    /// Reads the files.
    pub(super) fn specimens(&self) -> Result<(Vec<Source>, Vec<Specimen>), Failure> {
        let outputs = [
            ("--csv", self.csv.as_deref()),
            ("--series", self.series.as_deref()),
            ("--report", self.report.as_deref()),
        ];
        let inputs: Vec<Named<'_>> = self
            .files
            .iter()
            .map(|f| ("FILES", Some(f.as_path())))
            .collect();
        check_outputs(&outputs, &inputs, self.quiet)?;
        let within = |name: &str, value: Option<f64>, low: f64, high: f64| match value {
            Some(v) if !(v > low && v < high) => Err(Failure::Error(format!(
                "--{name} {v}: must be between {low} and {high}"
            ))),
            _ => Ok(()),
        };
        within("level", Some(self.level), 0.5, 0.9999)?;
        within("slope-from-min", Some(self.slope_from_min), -1e-9, 1e9)?;
        within("gauge-length-mm", self.gauge_length_mm, 0.0, 1e9)?;
        within("area-mm2", self.area_mm2, 0.0, 1e12)?;
        let options = TestOptions {
            columns: self.column.clone(),
            specimen_columns: self.specimen.clone(),
            sheet: self.sheet.clone(),
        };
        let mut note = |text: &str| {
            if !self.quiet {
                complain(Word::Note, &plain(text));
            }
        };
        Ok(sinew_creep::read_specimens(
            &self.files,
            &options,
            &mut note,
        )?)
    }

    /// Reads, prepares and analyses the tests; failures are printed as warnings.
    pub(super) fn tests(&self) -> Result<Tests, Failure> {
        let (sources, specimens) = self.specimens()?;
        let request = AnalyzeRequest {
            prepare: PrepareOptions {
                gauge_length_m: self.gauge_length_mm.map(|mm| mm * 1e-3),
                area_m2: self.area_mm2.map(|mm2| mm2 * 1e-6),
                temperature_c: self.temperature_c,
                keep_artefacts: self.keep_artefacts,
            },
            analyze: AnalyzeOptions {
                slope_from_s: 60.0 * self.slope_from_min,
                level: self.level,
                seed: self.seed,
            },
            group_by: self.group.clone(),
        };
        let bar = Bar::new("analysing", self.quiet);
        let tests = sinew_creep::analyze_tests(sources, &specimens, &request, |done, of| {
            bar.set(done as f64, of as f64);
        });
        drop(bar);
        let tests = tests.map_err(|e| Failure::Error(plain_lines(&e.to_string())))?;
        self.warn(&tests.failures);
        Ok(tests)
    }

    /// Prints failures as warnings.
    pub(super) fn warn(&self, failures: &[sinew_creep::Failure]) {
        if !self.quiet {
            for failure in failures {
                complain(Word::Warning, &plain(&failure.to_string()));
            }
        }
    }

    /// Writes the requested files, and prints the document or the table.
    pub(super) fn answer<D: JsonDocument>(
        &self,
        document: &D,
        csv: impl FnOnce(&D) -> Table,
        page: Option<&dyn Fn() -> Page>,
        table: impl FnOnce(&D) -> String,
    ) -> Result<(), Failure> {
        write_table(self.csv.as_deref(), || csv(document))?;
        if let Some(page) = page {
            write_text(self.report.as_deref(), || page().html())?;
        }
        answer_as(self.json, document, table)
    }
}
