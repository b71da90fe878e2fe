//! Creep tests: analysis, fits, hold-out, comparison, time-temperature shift.

use crate::document::{Concern, Document, Shown};
use crate::failure::Failure;
use crate::recording::one_of;
use crate::work::work;
use pyo3::prelude::*;
use sinew_creep::{
    AnalyzeOptions, AnalyzeRequest, ColumnChoice, Conditions, FitOptions, FitRequest, FitStep,
    ForecastRequest, IntervalKind, Joint, Law, NoiseKind, PrepareOptions, RopeBase, Source,
    Specimen, TestFileError, TestOptions, Tests, read_test, read_test_bytes,
};
use sinew_report::creep;
use std::path::PathBuf;
use std::sync::Arc;

/// Source of a creep test: a file, or a text with a name.
#[derive(FromPyObject)]
enum TestArg {
    #[pyo3(annotation = "(name, text)")]
    Text(String, String),
    #[pyo3(annotation = "path")]
    File(PathBuf),
}

/// Information missing from files, and options of the analysis.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct AnalysisArgs {
    columns: Vec<String>,
    specimen_columns: Vec<String>,
    sheet: Option<String>,
    gauge_length_m: Option<f64>,
    area_m2: Option<f64>,
    temperature_c: Option<f64>,
    keep_artefacts: bool,
    group_by: Vec<String>,
    slope_from_s: f64,
    level: f64,
    seed: u64,
    standard: String,
    preconditioning: Option<String>,
    conditions: Option<String>,
}

/// Loaded tests with their options.
struct Held {
    tests: Tests,
    specimens: Vec<Specimen>,
    sources: Vec<Source>,
    conditions: Conditions,
    has_groups: bool,
    level: f64,
    seed: u64,
    notes: Vec<String>,
}

impl Held {
    /// Returns the failures of the analysis and the notes of the reader.
    fn warnings(&self, failures: &[sinew_creep::Failure]) -> Vec<String> {
        let failed = failures.iter().map(ToString::to_string);
        self.notes.iter().cloned().chain(failed).collect()
    }
}

/// Creep tests, read and analysed.
#[pyclass(frozen, module = "pysinew._core")]
pub(crate) struct CreepTests(Arc<Held>);

const JOINTS: [(&str, Joint); 3] = [
    ("none", Joint::None),
    ("shape", Joint::Shape),
    ("group", Joint::Group),
];

const NOISES: [(&str, NoiseKind); 2] = [
    ("correlated", NoiseKind::Correlated),
    ("white", NoiseKind::White),
];

const INTERVALS: [(&str, IntervalKind); 3] = [
    ("draws", IntervalKind::Draws),
    ("profile", IntervalKind::Profile),
    ("bootstrap", IntervalKind::Bootstrap),
];

/// Options of a fit.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct FitArgs {
    laws: Vec<String>,
    joint: String,
    noise: String,
    intervals: String,
    rope: Option<String>,
    ropes: Vec<PathBuf>,
    forecast_s: Option<f64>,
    forecast_load_n: Option<f64>,
    forecast_temperature_c: Option<f64>,
}

impl FitArgs {
    fn request(&self, held: &Held) -> Result<FitRequest, Failure> {
        let law = |name: &String| name.parse::<Law>().map_err(|e| Failure::new(e.to_string()));
        let laws = self.laws.iter().map(law).collect::<Result<Vec<_>, _>>()?;
        let base = match &self.rope {
            None if laws.contains(&Law::Rope) => {
                return Err(Failure::new(
                    "the law 'rope' requires the option rope: a catalogue rope with its breaking load and the parameters that the records do not determine",
                ));
            }
            None => None,
            Some(name) => {
                let catalogue = crate::catalogue::with_folders(&self.ropes)?;
                let entry = catalogue.find(name)?.entry.clone();
                Some(Arc::new(RopeBase::new(entry)?))
            }
        };
        if self.forecast_s.is_some_and(|s| !(s > 0.0)) {
            return Err(Failure::new("forecast_s must be above 0 s"));
        }
        Ok(FitRequest {
            laws,
            joint: one_of("joint", &self.joint, &JOINTS)?,
            options: FitOptions {
                noise: one_of("noise", &self.noise, &NOISES)?,
                level: held.level,
                kind: one_of("intervals", &self.intervals, &INTERVALS)?,
                seed: held.seed,
                rope: base,
                ..FitOptions::default()
            },
            forecast: self.forecast_s.map(|until_s| ForecastRequest {
                until_s,
                load_n: self.forecast_load_n,
                temperature_c: self.forecast_temperature_c,
            }),
        })
    }
}

#[pymethods]
impl CreepTests {
    #[new]
    fn new(
        py: Python<'_>,
        files: Vec<TestArg>,
        args: AnalysisArgs,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        if files.is_empty() {
            return Err(Failure::new("no creep test specified; pass at least one file").into());
        }
        let column = |text: &String| text.parse::<ColumnChoice>().map_err(Failure::new);
        let options = TestOptions {
            columns: (args.columns.iter().map(column)).collect::<Result<_, _>>()?,
            specimen_columns: args.specimen_columns,
            sheet: args.sheet,
        };
        let request = AnalyzeRequest {
            prepare: PrepareOptions {
                gauge_length_m: args.gauge_length_m,
                area_m2: args.area_m2,
                temperature_c: args.temperature_c,
                keep_artefacts: args.keep_artefacts,
            },
            analyze: AnalyzeOptions {
                slope_from_s: args.slope_from_s,
                level: args.level,
                seed: args.seed,
            },
            group_by: args.group_by,
        };
        request.check().map_err(Failure::from)?;
        let conditions = Conditions {
            standard: args.standard,
            preconditioning: args.preconditioning,
            conditions: args.conditions,
        };
        let held = work(py, "analysing", progress.as_ref(), move |tracker| {
            let read = |source: TestArg| match source {
                TestArg::File(path) => read_test(&path, &options),
                TestArg::Text(name, text) => read_test_bytes(text.into_bytes(), &name, &options),
            };
            let files = files.into_iter().map(read);
            let files = files.collect::<Result<Vec<_>, TestFileError>>()?;
            let mut notes = Vec::new();
            let mut note = |text: &str| notes.push(text.to_owned());
            let (sources, specimens) = sinew_creep::specimens_of(files, &mut note);
            let report = |done: usize, of: usize| tracker.at(done as f64, of as f64);
            let tests = sinew_creep::analyze_tests(sources.clone(), &specimens, &request, report)?;
            Ok(Held {
                tests,
                specimens,
                sources,
                conditions,
                has_groups: !request.group_by.is_empty(),
                level: request.analyze.level,
                seed: request.analyze.seed,
                notes,
            })
        })?;
        Ok(Self(Arc::new(held)))
    }

    /// Readings, moduli, slope, saturation, recovery and artefacts.
    fn analyze(&self) -> Document {
        let held = self.0.clone();
        let report = held.tests.report(held.conditions.clone());
        let warnings = held.warnings(&report.failures);
        let is_lossy = !report.failures.is_empty();
        let (of_page, of_series) = (held.clone(), held);
        Shown::new(report, creep::analyze_table)
            .page(move |report| creep::analyze_page(report, &of_page.tests))
            .table("specimens", creep::analyze_csv)
            .table("series", move |_| creep::readings_series(&of_series.tests))
            .warnings(Concern::Recording.texts(warnings))
            .lossy(is_lossy)
            .into()
    }

    /// Fitted laws; with `rope_name` also the fitted rope as a catalogue entry.
    fn fit(
        &self,
        py: Python<'_>,
        args: FitArgs,
        rope_name: Option<String>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<(Document, Option<String>)> {
        let request = args.request(&self.0)?;
        let (held, fitted) = (self.0.clone(), request.clone());
        let report = work(py, "fitting", progress.as_ref(), move |tracker| {
            Ok(sinew_creep::fit_tests(
                &held.tests,
                &fitted,
                |step, done, of| {
                    if step == FitStep::Forecasting {
                        tracker.set_stage("forecasting");
                    }
                    tracker.at(done as f64, of as f64);
                },
            ))
        })?;
        let entry = match (rope_name, &request.options.rope) {
            (None, _) => None,
            (Some(name), Some(base)) => {
                let today = sinew_files::date::today();
                let entry = report.rope_entry(request.joint, base, name, today);
                Some(entry.map_err(Failure::from)?.to_toml())
            }
            (Some(_), None) => {
                return Err(Failure::new("rope_name needs rope, the rope it starts from").into());
            }
        };
        let held = self.0.clone();
        let warnings = held.warnings(&report.failures);
        let is_lossy = !report.failures.is_empty();
        let laws = request.laws();
        let alone = held.has_groups && request.joint == Joint::None;
        let (of_page, of_series) = (held.clone(), held.clone());
        let document = Shown::new(report, move |report| {
            let groups = || creep::group_table(&held.tests.analyses, &report.fits, &laws);
            let own = creep::fit_table(report);
            if alone { own + &groups() } else { own }
        })
        .page(move |r| creep::fit_page(r, &of_page.tests, request.joint, &of_page.conditions))
        .table("parameters", creep::fit_csv)
        .table("series", move |report| {
            creep::fit_series(report, &of_series.tests)
        })
        .warnings(Concern::Recording.texts(warnings))
        .lossy(is_lossy);
        Ok((document.into(), entry))
    }

    /// Hides the last share of every test and returns the coverage of the forecast intervals.
    fn hold_out(
        &self,
        py: Python<'_>,
        share: f64,
        args: FitArgs,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Document> {
        if !(0.01..=0.9).contains(&share) {
            let reason = format!("share is {share}; it must lie between 0.01 and 0.9");
            return Err(Failure::new(reason).into());
        }
        let request = args.request(&self.0)?;
        let held = self.0.clone();
        let report = work(py, "forecasting", progress.as_ref(), move |tracker| {
            let report = |done: usize, of: usize| tracker.at(done as f64, of as f64);
            Ok(sinew_creep::hold_out_tests(
                &held.tests,
                share,
                &request,
                report,
            ))
        })?;
        let warnings = self.0.warnings(&report.failures);
        let is_lossy = !report.failures.is_empty() || !report.forecasts_any();
        let held = self.0.clone();
        Ok(Shown::new(report, creep::hold_out_table)
            .page(move |report| creep::hold_out_page(report, &held.tests, &held.conditions))
            .table("coverage", creep::hold_out_csv)
            .warnings(Concern::Recording.texts(warnings))
            .lossy(is_lossy)
            .into())
    }

    /// All ropes ranked, with intervals.
    #[pyo3(signature = (scatter=None))]
    fn compare(&self, scatter: Option<f64>) -> PyResult<Document> {
        if scatter.is_some_and(|share| !(share > 0.0 && share < 10.0)) {
            let reason = "scatter is a share of the value, above 0 and below 10";
            return Err(Failure::new(reason).into());
        }
        let report = sinew_creep::compare(&self.0.tests, scatter);
        let warnings = self.0.warnings(&report.failures);
        let is_lossy = !report.failures.is_empty();
        let held = self.0.clone();
        Ok(Shown::new(report, creep::compare_table)
            .page(move |report| creep::compare_page(report, &held.tests, &held.conditions))
            .table("ranks", creep::compare_csv)
            .warnings(Concern::Recording.texts(warnings))
            .lossy(is_lossy)
            .into())
    }

    /// Shift factors of isotherms to a temperature, °C.
    fn shift(&self, reference_c: f64) -> PyResult<Document> {
        let sources = self.0.sources.clone();
        let report = sinew_creep::shift(sources, &self.0.specimens, reference_c);
        let report = report.map_err(Failure::from)?;
        let warnings = self.0.warnings(&report.failures);
        let is_lossy = !report.failures.is_empty();
        Ok(Shown::new(report, creep::shift_table)
            .table("shifts", creep::shift_csv)
            .warnings(Concern::Recording.texts(warnings))
            .lossy(is_lossy)
            .into())
    }
}
