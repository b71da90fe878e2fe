//! From a request to an estimate.

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
/// With a reference recording, that one is estimated first, with the same robot and settings but
/// without injected offsets. `progress` is called every few thousand frames.
///
/// # Errors
/// [`EstimateError`]; no file has been written then.
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

/// The estimate of the reference recording, where there is one.
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
            // The robot is that of the recording asked for, wherever the reference lies.
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

/// Estimates one recording.
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

/// Adds the difference to the reference recording.
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
    if now.refused.is_some() || then.refused.is_some() {
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
