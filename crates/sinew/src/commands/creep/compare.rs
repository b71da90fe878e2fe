//! `sinew creep compare`.

use super::files::TestFiles;
use crate::terminal::{Failure, Finish};
use clap::Args;
use sinew_report::creep;
use std::path::PathBuf;

/// Compare ropes by strain and slope, ranked with intervals
///
/// Ranks by strain at the longest common time; specimens of one --group are repeats.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew creep compare *.csv --gauge-length-mm 350 --group rope --plot ropes.png")]
pub(crate) struct Compare {
    #[command(flatten)]
    files: TestFiles,
    /// Write a plot; .svg or .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    plot: Option<PathBuf>,
    /// Standard deviation between specimens as share of the value, for ropes with one specimen
    /// [default: from repeats of the other ropes, else 0.1 (assumed)]
    #[arg(long, value_name = "SHARE")]
    scatter: Option<f64>,
}

impl Compare {
    /// Runs the command.
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        if let Some(share) = self.scatter
            && !(share > 0.0 && share < 10.0)
        {
            return Err(Failure::Error(format!(
                "--scatter {share}: must be above 0 and below 10"
            )));
        }
        let tests = self.files.tests()?;
        let report = sinew_creep::compare(&tests, self.scatter);
        if let Some(path) = &self.plot {
            creep::figure("", &creep::plotted(&tests), false).write(path)?;
        }
        let page = || creep::compare_page(&report, &tests, &self.files.conditions());
        self.files.answer(
            &report,
            creep::compare_csv,
            Some(&page),
            creep::compare_table,
        )?;
        Ok(Finish::lossy(!report.failures.is_empty()))
    }
}
