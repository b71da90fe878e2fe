//! One strand of rope along its route: portion by portion through a duty.

use super::history::History;
use super::route::Request;
use sinew_model::rope::routing::{self, RoutingError};
use sinew_model::rope::{Law, LoadError, RopeLoad, State};

/// Strand averages at one time: strain, irreversible strain, %.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mean {
    pub(super) strain: f64,
    pub(super) irreversible: f64,
}

/// Why a strand could not be followed.
pub(super) enum StrandError {
    Load(LoadError),
    Routing(RoutingError),
}

/// Means over the portions of a strand at the times asked for.
pub(super) fn strand(
    law: &Law,
    request: &Request,
    read_at: RopeLoad,
    times_s: &[f64],
) -> Result<Vec<Mean>, StrandError> {
    let route = &request.route;
    let portions = routing::portions(route.length_m, route.stroke_m, &route.pulleys)
        .map_err(StrandError::Routing)?;
    let mut out = vec![Mean::default(); times_s.len()];
    for portion in portions {
        let law = law.passed_by(portion.guides as f64);
        // A rope at rest keeps whatever friction has left it: only a moving one is sure to be
        // pulled both ways.
        let duty = if route.stroke_m > 0.0 {
            let share = routing::tension_share(
                &route.pulleys,
                law.parameters().friction,
                portion.middle_m,
                0.5 * route.stroke_m,
                false,
            );
            request.duty.with_friction(share.ln())
        } else {
            request.duty.clone()
        };
        let weight = portion.length_m / route.length_m;
        let mut history = History::new(&law, &duty, State::default());
        for (mean, &time_s) in out.iter_mut().zip(times_s) {
            let state = history.at(time_s).map_err(StrandError::Load)?;
            let strain = law.strain(&state, read_at).map_err(StrandError::Load)?;
            mean.strain += weight * strain.total_percent();
            mean.irreversible += weight * strain.irreversible_percent();
        }
    }
    Ok(out)
}
