//! Input and output options of creep tests.

use crate::files::{Named, check_outputs, write_table, write_text};
use crate::quantity::{Area, Length, Share, Temperature, Time, above_zero, at_least_zero, part};
use crate::terminal::{Bar, Failure, Word, answer_as, complain};
use crate::text::plain;
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
    #[arg(long, alias = "gauge-length-mm", value_name = "LENGTH", value_parser = above_zero::<Length>, help_heading = "Input")]
    gauge_length: Option<Length>,
    /// Cross-section, mm2, for the creep modulus
    #[arg(long, alias = "area-mm2", value_name = "AREA", value_parser = above_zero::<Area>, help_heading = "Input")]
    area: Option<Area>,
    /// Temperature, °C, for files without temperature
    #[arg(
        long,
        alias = "temperature-c",
        value_name = "TEMPERATURE",
        allow_hyphen_values = true,
        help_heading = "Input"
    )]
    temperature: Option<Temperature>,
    /// Keep grip slips and outliers [default: removed]
    #[arg(long, help_heading = "Input")]
    keep_artefacts: bool,
    /// Column or header line with the group of repeats (repeatable)
    #[arg(long, value_name = "COLUMN", help_heading = "Input")]
    pub(super) group: Vec<String>,
    /// Start of the straight line of m_E after loading, s
    #[arg(long, value_name = "TIME", default_value = "20min", value_parser = at_least_zero::<Time>)]
    slope_from: Time,
    /// Probability of the intervals, ratio
    #[arg(long, value_name = "SHARE", default_value = "95%", value_parser = part)]
    pub(super) level: Share,
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
    ///
    /// * `others`: output files of the command that are not options of all commands.
    pub(super) fn specimens(
        &self,
        others: &[Named<'_>],
    ) -> Result<(Vec<Source>, Vec<Specimen>), Failure> {
        let mut outputs = vec![
            ("--csv", self.csv.as_deref()),
            ("--series", self.series.as_deref()),
            ("--report", self.report.as_deref()),
        ];
        outputs.extend(others);
        let inputs: Vec<Named<'_>> = self
            .files
            .iter()
            .map(|f| ("FILES", Some(f.as_path())))
            .collect();
        check_outputs(&outputs, &inputs)?;
        let level = self.level.0;
        if !(level > 0.5 && level < 0.9999) {
            return Err(Failure::Error(format!(
                "--level {level}: must be between 0.5 and 0.9999"
            )));
        }
        let options = TestOptions {
            columns: self.column.clone(),
            specimen_columns: self.specimen.clone(),
            sheet: self.sheet.clone(),
        };
        let mut note = |text: &str| complain(Word::Note, &plain(text));
        Ok(sinew_creep::read_specimens(
            &self.files,
            &options,
            &mut note,
        )?)
    }

    /// Reads, prepares and analyses the tests; failures are printed as warnings.
    ///
    /// * `others`: as for [`TestFiles::specimens`].
    pub(super) fn tests(&self, others: &[Named<'_>]) -> Result<Tests, Failure> {
        let (sources, specimens) = self.specimens(others)?;
        let request = AnalyzeRequest {
            prepare: PrepareOptions {
                gauge_length_m: self.gauge_length.map(|length| length.0),
                area_m2: self.area.map(|area| area.0),
                temperature_c: self.temperature.map(|temperature| temperature.0),
                keep_artefacts: self.keep_artefacts,
            },
            analyze: AnalyzeOptions {
                slope_from_s: self.slope_from.0,
                level: self.level.0,
                seed: self.seed,
            },
            group_by: self.group.clone(),
        };
        let bar = Bar::new("analysing");
        let tests = sinew_creep::analyze_tests(sources, &specimens, &request, |done, of| {
            bar.set(done as f64, of as f64);
        });
        drop(bar);
        let tests = tests.map_err(|e| Failure::Error(e.to_string()))?;
        warn(&tests.failures);
        Ok(tests)
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

/// Prints failures as warnings.
pub(super) fn warn(failures: &[sinew_creep::Failure]) {
    for failure in failures {
        complain(Word::Warning, &plain(&failure.to_string()));
    }
}
