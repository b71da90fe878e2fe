//! Simulation of one strand along its route, section by section.

use super::history::History;
use super::life::felt_by;
use super::route::Request;
use crate::law::routing::{self, RoutingError};
use crate::law::{Law, LoadError, RopeLoad, State, damage};

/// Strand averages at one time: strain, irreversible strain, %.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mean {
    pub(super) strain: f64,
    pub(super) irreversible: f64,
}

/// Error of a strand that cannot be simulated.
pub(super) enum StrandError {
    Load(LoadError),
    Routing(RoutingError),
}

/// Means over the sections of a strand at the requested times.
pub(super) fn strand(
    law: &Law,
    request: &Request,
    read_at: RopeLoad,
    rope_m: Option<f64>,
    times_s: &[f64],
) -> Result<Vec<Mean>, StrandError> {
    let route = &request.route;
    let tension_n = request.duty.summary().tension_mean_n;
    let portions = routing::portions(route.length_m, route.stroke_m, &route.pulleys)
        .map_err(StrandError::Routing)?;
    let mut out = vec![Mean::default(); times_s.len()];
    for portion in portions {
        let (pulleys, stroke_m) = (&route.pulleys, route.stroke_m);
        let passes = damage::passes(law, &portion, pulleys, stroke_m, rope_m, tension_n);
        let law = law.passed_by(passes);
        let duty = felt_by(&portion, &law, request);
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
