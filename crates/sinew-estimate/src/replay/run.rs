//! Estimation of a request.

use super::pass::Pass;
use super::result::{Difference, Estimate, JointEstimate};
use crate::error::EstimateError;
use crate::recording::Opened;
use crate::request::{Progress, Request};
use crate::robot_dir;
use crate::warning::RecordingWarning;
use std::ops::ControlFlow;

/// Estimates the offset of every joint of a recording.
///
/// A reference recording is estimated first, with the same robot and settings but
/// without injected offsets. `progress` is called every few thousand frames.
///
/// # Errors
/// Returns an [`EstimateError`] if the recording or robot cannot be read, if both do not match, or if an output file
/// cannot be written; no output file is left in that case.
pub fn run(
    request: &Request,
    progress: &mut dyn FnMut(Progress),
) -> Result<Estimate, EstimateError> {
    let reference = reference(request, progress)?;
    let mut estimate = one(request, false, progress)?;
    if let Some(reference) = reference {
        compare(&mut estimate, &reference);
    }
    Ok(estimate)
}

/// Estimates the reference recording; `None` if there is none.
pub(crate) fn reference(
    request: &Request,
    progress: &mut dyn FnMut(Progress),
) -> Result<Option<Estimate>, EstimateError> {
    let Some(log) = &request.reference else {
        return Ok(None);
    };
    let request = Request {
        log: log.clone(),
        robot: match (&request.robot, &request.given.robot) {
            // The robot is that of the requested recording, independent of the folder of the reference.
            (None, None) => Some(robot_dir::find(&request.log)?),
            (place, _) => place.clone(),
        },
        injections: Vec::new(),
        reference: None,
        csv: None,
        ..request.clone()
    };
    one(&request, true, progress).map(Some)
}

/// Estimates a single recording.
fn one(
    request: &Request,
    is_reference: bool,
    progress: &mut dyn FnMut(Progress),
) -> Result<Estimate, EstimateError> {
    let mut opened = Opened::new(request)?;
    let mut pass = Pass::new(request, &opened)?;
    opened.each_frame(is_reference, progress, |frame| {
        pass.frame(frame)?;
        Ok(ControlFlow::Continue(()))
    })?;
    pass.finish(opened)
}

/// Adds the differences from the reference recording, and its warnings, to an estimate.
pub(crate) fn compare(estimate: &mut Estimate, reference: &Estimate) {
    estimate.settings.reference = Some(reference.recording.path.clone());
    estimate.damaged |= reference.damaged;
    for warning in &reference.warnings {
        if !estimate.warnings.contains(warning) {
            estimate.warnings.push(RecordingWarning::Reference {
                warning: Box::new(warning.clone()),
            });
        }
    }
    for (now, then) in estimate.joints.iter_mut().zip(&reference.joints) {
        now.difference = difference(now, then);
    }
}

fn difference(now: &JointEstimate, then: &JointEstimate) -> Option<Difference> {
    if now.reason.is_some() || then.reason.is_some() {
        return None;
    }
    let (offset, reference_rad) = (now.offset_rad?, then.offset_rad?);
    let difference_rad = offset - reference_rad;
    let errors = now.standard_error_rad.zip(then.standard_error_rad);
    Some(Difference {
        reference_rad,
        difference_rad,
        standard_error_rad: errors.map(|(now, then)| now.hypot(then)),
        elongation_m: now
            .elongation_m
            .filter(|_| offset != 0.0)
            .map(|m| m / offset * difference_rad),
        offset_per_stiffness_error_rad: now.offset_per_stiffness_error_rad?
            - then.offset_per_stiffness_error_rad?,
    })
}
