//! `sinew creep analyze`.

use super::files::TestFiles;
use crate::files::write_table;
use crate::terminal::{Failure, Finish};
use clap::Args;
use sinew_report::creep;

/// Analyse creep tests: strain, moduli, slope m_E, saturation, recovery, artefacts
///
/// Columns are identified by their headers, e.g. time_s, Force (N), Strain [%]. Exit code 3: a specimen
/// could not be analysed.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew creep analyze rope.csv --gauge-length 350mm --report rope.html\n  \
    sinew creep analyze tests.xlsx --column force=Kraft:N --group rope")]
pub(crate) struct Analyze {
    #[command(flatten)]
    files: TestFiles,
}

impl Analyze {
    /// Runs the command.
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let tests = self.files.tests(&[])?;
        let report = tests.report(self.files.conditions());
        write_table(self.files.series.as_deref(), || {
            creep::readings_series(&tests)
        })?;
        let page = || creep::analyze_page(&report, &tests);
        self.files.answer(
            &report,
            creep::analyze_csv,
            Some(&page),
            creep::analyze_table,
        )?;
        Ok(Finish::lossy(!report.failures.is_empty()))
    }
}
