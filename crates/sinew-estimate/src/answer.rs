//! One recording, by the method asked for.

use crate::baseline::Baseline;
use crate::document::{EstimateDocument, Method};
use crate::error::SessionError;
use crate::online::trajectory;
use crate::replay;
use crate::request::{Progress, Request};
use crate::session::{self, Recorded, SessionEstimate, SessionOptions, Window};
use sinew_model::robot::Robot;

/// How recordings are estimated.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Which estimate answers.
    pub method: Method,
    /// Which part of the recording; for the absolute method, as all below.
    pub window: Window,
    /// Baseline, with its file's name.
    pub baseline: Option<(&'a Baseline, &'a str)>,
    /// What is known of the session.
    pub options: SessionOptions,
    /// Whether the online estimate goes over the recording, too ([`crate::online::replay`]).
    pub live: bool,
}

/// Estimates a recording; with it comes what is known afterwards, where the absolute method answers.
///
/// # Errors
/// [`SessionError`]; no file has been written then.
pub fn estimate(
    request: &Request,
    plan: &Plan<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(EstimateDocument, Option<Baseline>), SessionError> {
    let (method, session, reading, next) = match plan.method {
        Method::Paper => (Method::Paper, None, replay::run(request, progress)?, None),
        Method::Absolute => {
            let (baseline, options) = (plan.baseline, &plan.options);
            let also = |robot: &Robot, recorded: &Recorded, session: &mut SessionEstimate| {
                let name = &session.recording;
                let course = || trajectory(robot, recorded, baseline, options, name);
                session.live = plan.live.then(course).transpose()?;
                Ok(())
            };
            let (reading, session, next) = session::estimate_with_replay(
                request,
                plan.window,
                baseline,
                options,
                &also,
                progress,
            )?;
            (Method::Absolute, Some(session), reading, Some(next))
        }
    };
    let document = EstimateDocument {
        method,
        session,
        reading,
    };
    Ok((document, next))
}
