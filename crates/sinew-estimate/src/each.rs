//! Independent estimates of several recordings.

use crate::answer::{Plan, estimate};
use crate::document::{EstimateDocument, Method};
use crate::replay::Series;
use crate::request::Request;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;

/// Independent estimates of several recordings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EachDocument {
    /// Estimation method of all recordings.
    pub method: Method,
    /// One entry per recording, in the order of the command line.
    pub recordings: Vec<RecordingOutcome>,
}

impl JsonDocument for EachDocument {
    const SCHEMA: &'static str = "sinew/estimate-each/2";
}

impl EachDocument {
    /// Number of recordings without an estimate.
    pub fn failed(&self) -> usize {
        let failed = self.recordings.iter().filter(|r| !r.is_estimated());
        failed.count()
    }
}

/// Outcome of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingOutcome {
    /// Recording as named on the command line.
    pub recording: String,
    /// Reason why the recording could not be estimated; none if it was.
    pub error: Option<String>,
    /// Estimate of the recording as printed by `sinew estimate`.
    pub estimate: Option<EstimateDocument>,
}

impl RecordingOutcome {
    /// Whether any joint has an estimate.
    pub fn is_estimated(&self) -> bool {
        self.estimate.as_ref().is_some_and(|document| {
            let mut readings = document.reading.joints.iter();
            document.session.is_some() || readings.any(|j| j.reason.is_none())
        })
    }
}

/// Estimates recordings independently of each other, on all processors. A recording that cannot be estimated does
/// not stop the others. `done` is called with each outcome.
pub fn estimate_each(
    requests: &[Request],
    plan: &Plan<'_>,
    done: impl Fn(&RecordingOutcome) + Sync,
) -> EachDocument {
    let one = |request: &Request| {
        let found = estimate(request, plan, &mut |_| {});
        let (error, estimate) = match found {
            Ok((document, _)) => (None, Some(without_series(document))),
            Err(error) => (Some(error.to_string()), None),
        };
        let outcome = RecordingOutcome {
            recording: request.name(),
            error,
            estimate,
        };
        done(&outcome);
        outcome
    };
    EachDocument {
        method: plan.method,
        recordings: requests.par_iter().map(one).collect(),
    }
}

/// Removes the time series, which would need too much memory for many recordings.
fn without_series(mut document: EstimateDocument) -> EstimateDocument {
    for joint in &mut document.reading.joints {
        joint.series = Series::default();
    }
    if let Some(session) = &mut document.session {
        session.blocks.clear();
    }
    document
}
