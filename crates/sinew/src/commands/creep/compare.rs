//! `sinew creep compare`.

use super::files::TestFiles;
use crate::quantity::{Share, above_zero};
use crate::terminal::{Failure, Finish};
use clap::Args;
use sinew_report::creep;
use std::path::PathBuf;

/// Compare ropes by strain and slope, ranked with intervals
///
/// Ranks by strain at the longest common time; specimens of one --group are repeats.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew creep compare *.csv --gauge-length 350mm --group rope --plot ropes.png")]
pub(crate) struct Compare {
    #[command(flatten)]
    files: TestFiles,
    /// Write a plot; .svg or .png
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    plot: Option<PathBuf>,
    /// Standard deviation between specimens as ratio to the value, for ropes with one specimen
    /// [default: from repeats of the other ropes, else 10% (assumed)]
    #[arg(long, value_name = "SHARE", value_parser = above_zero::<Share>)]
    scatter: Option<Share>,
}

impl Compare {
    /// Runs the command.
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let scatter = self.scatter.map(|share| share.0);
        if let Some(ratio) = scatter.filter(|ratio| *ratio >= 10.0) {
            return Err(Failure::Error(format!(
                "--scatter {ratio}: must be below 10 (1000 %)"
            )));
        }
        let tests = self.files.tests(&[("--plot", self.plot.as_deref())])?;
        let report = sinew_creep::compare(&tests, scatter);
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
