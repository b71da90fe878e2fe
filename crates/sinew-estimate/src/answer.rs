//! Estimate of one recording by the requested method.

use crate::baseline::Baseline;
use crate::document::{EstimateDocument, Method};
use crate::error::SessionError;
use crate::online::TrajectoryBuilder;
use crate::replay;
use crate::request::{Progress, Request};
use crate::session::{self, Recorded, SessionEstimate, SessionOptions, Warning, Window};
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;

/// Settings with which recordings are estimated.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Method of the estimate.
    pub method: Method,
    /// Evaluated part of the recording; this and the following fields apply to the absolute method only.
    pub window: Window,
    /// Baseline and the name of its file.
    pub baseline: Option<(&'a Baseline, &'a str)>,
    /// Options of the session.
    pub options: SessionOptions,
    /// Whether the online estimate is also computed over the recording ([`crate::online::replay`]).
    pub online: bool,
}

/// Estimates a recording; the absolute method also returns the posterior as the next baseline.
///
/// # Errors
/// Returns [`SessionError`] if recording, robot or baseline cannot be used; no file has been written then.
pub fn estimate(
    request: &Request,
    plan: &Plan<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(EstimateDocument, Option<Baseline>), SessionError> {
    let (method, session, reading, next) = match plan.method {
        Method::Paper => (Method::Paper, None, replay::run(request, progress)?, None),
        Method::Absolute => {
            let (baseline, options) = (plan.baseline, &plan.options);
            let mut online: Option<Result<TrajectoryBuilder, SessionError>> = None;
            let mut each = |robot: &Robot, recorded: &Recorded| {
                if !plan.online {
                    return;
                }
                let start = || TrajectoryBuilder::new(robot, baseline, options, &request.name());
                if let Ok(online) = online.get_or_insert_with(start) {
                    online.push(recorded);
                }
            };
            let (reading, mut session, next) = session::estimate_with_replay(
                request,
                plan.window,
                baseline,
                options,
                &mut each,
                progress,
            )?;
            if let Some(online) = online {
                session.online = Some(online?.finish()?);
            }
            let session = match request.date_utc_s {
                Some(date_utc_s) => dated(session, date_utc_s),
                None => session,
            };
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

/// Result of a recording whose date is specified, with a warning if its clock contradicts it.
fn dated(mut session: SessionEstimate, specified_utc_s: f64) -> SessionEstimate {
    let recorded_utc_s = session.start_time_utc_s.replace(specified_utc_s);
    // A date without a time of day, in any time zone, is within a day of the recording.
    let is_contradicted = |recorded_utc_s: &f64| (specified_utc_s - recorded_utc_s).abs() > DAY_S;
    if let Some(recorded_utc_s) = recorded_utc_s.filter(is_contradicted) {
        session.warnings.push(Warning::DateInconsistent {
            recorded_utc_s,
            specified_utc_s,
        });
    }
    session
}
