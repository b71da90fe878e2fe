//! `sinew estimate --each`: several recordings, one row per recording and joint.

use super::estimate::Estimate;
use super::session_args::read_baseline;
use crate::files::{Named, check_outputs, write_table};
use crate::terminal::{Bar, Failure, Finish, answer_as};
use sinew_estimate::{Plan, estimate_each};
use sinew_report::{each_summary, each_table};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

impl Estimate {
    /// Estimates all recordings independently. Exit code 1 if all failed, 3 if some failed.
    pub(super) fn run_each(&self) -> Result<Finish, Failure> {
        let mut logs = Vec::new();
        for named in &self.logs {
            logs.extend(sinew_log::recordings_of(named)?);
        }
        let mut inputs: Vec<Named<'_>> = vec![
            ("the baseline", self.baseline.as_deref()),
            ("the mapping file", self.opening.mapping()),
        ];
        let named = |log| ("a recording", Some(PathBuf::as_path(log)));
        inputs.extend(logs.iter().map(named));
        check_outputs(&[("--table", self.table.as_deref())], &inputs)?;
        let requests = logs.iter().map(|log| self.request(log.clone()));
        let requests = requests.collect::<Result<Vec<_>, _>>()?;
        let read = read_baseline(self.baseline.as_deref())?;
        let plan = Plan {
            method: self.method(),
            window: self.session.window()?,
            baseline: read.as_ref().map(|(b, name)| (b, name.as_str())),
            options: self.session.options(),
            online: false,
        };
        let bar = Bar::new("recordings");
        let finished = AtomicUsize::new(0);
        let document = estimate_each(&requests, &plan, |_| {
            let done = 1 + finished.fetch_add(1, Ordering::Relaxed);
            bar.set(done as f64, requests.len() as f64);
        });
        drop(bar);
        write_table(self.table.as_deref(), || each_table(&document))?;
        answer_as(self.json, &document, each_summary)?;
        let failed = document.failed();
        if failed == document.recordings.len() {
            return Err(Failure::Error(format!(
                "no recording could be estimated ({failed} failed)"
            )));
        }
        let damaged = (document.recordings.iter())
            .filter_map(|r| r.estimate.as_ref())
            .any(|e| e.is_damaged() || e.lacks_encoder() || e.requires_action());
        Ok(Finish::lossy(failed > 0 || damaged))
    }
}
