//! Many recordings, each on its own.

use crate::answer::{Plan, estimate};
use crate::document::{EstimateDocument, Method};
use crate::replay::Series;
use crate::request::Request;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;

/// Many recordings, each on its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EachDocument {
    /// Which estimate answers.
    pub method: Method,
    /// One entry per recording, in the order they were named.
    pub recordings: Vec<RecordingOutcome>,
}

impl JsonDocument for EachDocument {
    const SCHEMA: &'static str = "sinew/estimate-each/1";
}

impl EachDocument {
    /// How many recordings gave no estimate.
    pub fn failed(&self) -> usize {
        let failed = self.recordings.iter().filter(|r| !r.is_estimated());
        failed.count()
    }
}

/// One recording of many.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingOutcome {
    /// The recording as it was named.
    pub recording: String,
    /// Why it couldn't be estimated; `None`: it was.
    pub error: Option<String>,
    /// Its estimate, as `sinew estimate` has it, without the series over time.
    pub estimate: Option<EstimateDocument>,
}

impl RecordingOutcome {
    /// Whether any joint has an estimate.
    pub fn is_estimated(&self) -> bool {
        self.estimate.as_ref().is_some_and(|document| {
            let mut readings = document.reading.joints.iter();
            document.session.is_some() || readings.any(|j| j.refused.is_none())
        })
    }
}

/// Estimates every recording on its own, on all processors: none knows of another. One that can't be estimated
/// doesn't stop the others. `done` is called with each that is finished.
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

/// Thousands of points of every recording would fill the memory.
fn without_series(mut document: EstimateDocument) -> EstimateDocument {
    for joint in &mut document.reading.joints {
        joint.series = Series::default();
    }
    if let Some(session) = &mut document.session {
        session.blocks.clear();
    }
    document
}
