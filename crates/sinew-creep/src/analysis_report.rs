//! Analysis report: groups, preparation and measurements of specimens.

use super::analyze::{Analysis, AnalyzeOptions, analyze};
use super::error::{CreepError, Failure};
use super::isochronous::{Isochrone, isochrones};
use super::parallel::each;
use super::record::{PrepareOptions, Prepared, prepare};
use super::scatter::{Scatter, scatter};
use super::test_file::Specimen;
use super::test_file::{Conditions, Source};
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_files::number::three_digits;

/// Options of an analysis of creep tests.
#[derive(Debug, Clone, Default)]
pub struct AnalyzeRequest {
    /// Properties that files may lack.
    pub prepare: PrepareOptions,
    /// Options of the analysis of each specimen.
    pub analyze: AnalyzeOptions,
    /// Columns or head lines that name a group of repeats.
    pub group_by: Vec<String>,
}

/// Error of an option outside its range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{name} is {value}; it must be between {low} and {high}")]
pub struct OutOfRange {
    /// Name of the option, with its unit.
    pub name: &'static str,
    /// Value of the option.
    pub value: f64,
    /// Lower limit of the range.
    pub low: f64,
    /// Upper limit of the range.
    pub high: f64,
}

impl AnalyzeRequest {
    /// Checks that all options are within their ranges.
    ///
    /// # Errors
    /// Returns the first [`OutOfRange`] option.
    pub fn check(&self) -> Result<(), OutOfRange> {
        let PrepareOptions {
            gauge_length_m,
            area_m2,
            ..
        } = self.prepare;
        let within = |name, value: Option<f64>, low: f64, high: f64| match value {
            Some(value) if !(value > low && value < high) => Err(OutOfRange {
                name,
                value,
                low,
                high,
            }),
            _ => Ok(()),
        };
        within("level", Some(self.analyze.level), 0.5, 0.9999)?;
        within("slope_from_s", Some(self.analyze.slope_from_s), -1e-9, 1e11)?;
        within("gauge_length_m", gauge_length_m, 0.0, 1e6)?;
        within("area_m2", area_m2, 0.0, 1e6)
    }
}

/// Analysed creep tests with their sources.
#[derive(Debug, Clone)]
pub struct Tests {
    /// Raw data files of the tests.
    pub sources: Vec<Source>,
    /// Specimens that could be analysed, prepared for fits.
    pub prepared: Vec<Prepared>,
    /// Analyses of these specimens, in the same order.
    pub analyses: Vec<Analysis>,
    /// Specimens that could not be analysed.
    pub failures: Vec<Failure>,
    /// Confidence level of the intervals.
    pub level: f64,
}

/// Report of an analysis without a creep law except a straight line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AnalyzeReport {
    /// Raw data files of the tests.
    pub sources: Vec<Source>,
    /// Test conditions stated by the laboratory.
    pub conditions: Conditions,
    /// Analysis of each specimen.
    pub specimens: Vec<Analysis>,
    /// Repeats by group.
    pub groups: Vec<Scatter>,
    /// Strain against load at the same times.
    pub isochrones: Vec<Isochrone>,
    /// Specimens that could not be analysed.
    pub failures: Vec<Failure>,
}

impl JsonDocument for AnalyzeReport {
    const SCHEMA: &'static str = "sinew/creep-analyze/2";
}

/// Prepares and analyses specimens on all processors; an invalid one is a failure with its reason.
/// `done` is called with the number of specimens finished, and of all.
///
/// # Errors
/// Returns [`CreepError::NoGroupColumn`] for an unknown group column, and
/// [`CreepError::NothingAnalysed`] if every specimen failed.
pub fn analyze_tests(
    sources: Vec<Source>,
    specimens: &[Specimen],
    request: &AnalyzeRequest,
    done: impl Fn(usize, usize) + Sync,
) -> Result<Tests, CreepError> {
    check_groups(&sources, specimens, &request.group_by)?;
    let results = each(
        specimens,
        |specimen| {
            let mut prepared = prepare(specimen, &request.prepare)?;
            prepared.group = group_of(specimen, &sources, &request.group_by);
            let analysis = analyze(&prepared, &request.analyze)?;
            Ok((prepared, analysis))
        },
        |finished| done(finished, specimens.len()),
    );
    let mut tests = Tests {
        sources,
        prepared: Vec::new(),
        analyses: Vec::new(),
        failures: Vec::new(),
        level: request.analyze.level,
    };
    for result in results {
        match result {
            Ok((prepared, analysis)) => {
                tests.prepared.push(prepared);
                tests.analyses.push(analysis);
            }
            Err(reason) => tests.failures.push(Failure { name: None, reason }),
        }
    }
    if tests.analyses.is_empty() {
        return Err(CreepError::NothingAnalysed {
            failures: tests.failures.iter().map(ToString::to_string).collect(),
        });
    }
    Ok(tests)
}

impl Tests {
    /// Creates the report of analyses with their groups and isochrones.
    pub fn report(&self, conditions: Conditions) -> AnalyzeReport {
        AnalyzeReport {
            sources: self.sources.clone(),
            conditions,
            specimens: self.analyses.clone(),
            groups: scatter(&self.analyses),
            isochrones: isochrones(&self.analyses, self.level),
            failures: self.failures.clone(),
        }
    }
}

/// Checks that every group column labels some specimen.
fn check_groups(
    sources: &[Source],
    specimens: &[Specimen],
    columns: &[String],
) -> Result<(), CreepError> {
    for column in columns {
        let unknown = |s| label(s, sources, column).is_none();
        if specimens.iter().all(unknown) {
            let available = specimens.first().map(|s| {
                let named = sources.iter().flat_map(|s| &s.columns).map(|c| &c.column);
                let attributes = s.attributes.iter().map(|a| &a.0);
                attributes
                    .chain(named.filter(|c| label(s, sources, c).is_some()))
                    .cloned()
                    .collect()
            });
            return Err(CreepError::NoGroupColumn {
                column: column.clone(),
                available: available.unwrap_or_default(),
            });
        }
    }
    Ok(())
}

fn group_of(specimen: &Specimen, sources: &[Source], columns: &[String]) -> Option<String> {
    let labels: Vec<String> = columns
        .iter()
        .filter_map(|column| label(specimen, sources, column))
        .collect();
    (!labels.is_empty()).then(|| labels.join(" / "))
}

/// Label of a whole specimen by a column: its text, or its only number in the unit of the file.
fn label(specimen: &Specimen, sources: &[Source], column: &str) -> Option<String> {
    if let Some(text) = specimen.attribute(column) {
        return Some(text.to_owned());
    }
    let used = sources
        .iter()
        .flat_map(|s| &s.columns)
        .find(|c| c.column.eq_ignore_ascii_case(column))?;
    let value = specimen.constant(used.quantity)?;
    let unit = used.quantity.unit();
    Some(if unit == used.unit {
        format!("{value}")
    } else {
        format!("{} {unit}", three_digits(value))
    })
}
