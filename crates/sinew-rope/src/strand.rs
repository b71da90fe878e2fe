//! Simulation of one strand along its route, section by section.

use super::draws::Draw;
use super::history::History;
use super::life::{LIFE_MOST_S, felt_by};
use super::route::Request;
use crate::law::routing::{self, RoutingError};
use crate::law::tested_range::AddedStrain;
use crate::law::{Law, LoadError, RopeLoad, State, damage};

/// Strand averages at one time, %.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Mean {
    /// Strain since new and slack.
    pub(super) strain: f64,
    /// Irreversible part of the strain.
    pub(super) irreversible: f64,
    /// `B'`: full bedding-in of the construction.
    pub(super) full_bedding: f64,
}

impl Mean {
    /// Adds the strain of a section with its share of the length.
    pub(super) fn add(
        &mut self,
        weight: f64,
        law: &Law,
        state: &State,
        read_at: RopeLoad,
    ) -> Result<(), LoadError> {
        let strain = law.strain(state, read_at)?;
        self.strain += weight * strain.total_percent();
        self.irreversible += weight * strain.irreversible_percent();
        self.full_bedding += weight * law.bedding_percent();
        Ok(())
    }
}

/// Strains of one draw up to the break of its rope.
pub(super) struct Trajectory {
    /// Strains at the requested times before the break; the first time is a minute after tensioning.
    pub(super) means: Vec<Mean>,
    /// Strains at a break after the first time.
    at_break: Option<Mean>,
    /// Time of the break, s, at most [`LIFE_MOST_S`].
    pub(super) life_s: f64,
}

impl Trajectory {
    /// Simulates one draw with its model error: of the immediate strain, that of the first time, and of the strain
    /// added later.
    ///
    /// The rope breaks where its damage reaches 1, and where its strain exceeds `ε_r + B'` and the recoverable strain
    /// of the law: beyond, the model error would stretch its fibres more than up to their rupture.
    ///
    /// * `life_s`: lifetime at which the damage of the law reaches 1, s.
    /// * `load_share`: share of the breaking load that the strains refer to.
    /// * `simulate`: strains of the law at rising times.
    pub(super) fn new(
        draw: &Draw<'_>,
        life_s: f64,
        load_share: f64,
        times_s: &[f64],
        simulate: impl FnOnce(&[f64]) -> Option<Vec<Mean>>,
    ) -> Self {
        let life_s = draw.error.life_s(life_s).min(LIFE_MOST_S);
        let lasting = times_s.iter().filter(|t| **t < life_s).count();
        let breaks = lasting > 0 && lasting < times_s.len();
        let mut nodes_s = times_s.to_vec();
        nodes_s.extend(breaks.then_some(life_s));
        nodes_s.extend(draw.error.nodes_s(times_s.last().copied().unwrap_or(0.0)));
        nodes_s.sort_by(f64::total_cmp);
        nodes_s.dedup();
        nodes_s.retain(|t| *t < life_s || breaks && *t == life_s);
        let raw = simulate(&nodes_s).unwrap_or_default();
        let start = raw.first().copied().unwrap_or_default();
        let immediate = draw.error.immediate_factor(load_share);
        let (mut added, mut irreversible) = (AddedStrain::default(), AddedStrain::default());
        let mut means = Vec::with_capacity(raw.len());
        for (mean, &time_s) in raw.iter().zip(&nodes_s) {
            added = draw.error.next(added, time_s, mean.strain - start.strain);
            irreversible = draw.error.next(irreversible, time_s, mean.irreversible);
            let widened = Mean {
                strain: immediate * start.strain + added.widened,
                irreversible: irreversible.widened,
                ..*mean
            };
            let recoverable = mean.strain - mean.irreversible;
            let limit = draw.endurance.rupture_percent + mean.full_bedding + recoverable;
            if widened.strain > limit {
                let at_break = Mean {
                    strain: limit,
                    irreversible: limit - recoverable,
                    ..*mean
                };
                return Self {
                    at_break: (!means.is_empty()).then_some(at_break),
                    means,
                    life_s: time_s.min(life_s),
                };
            }
            if times_s.contains(&time_s) || breaks && time_s == life_s {
                means.push(widened);
            }
        }
        Self {
            at_break: if breaks { means.pop() } else { None },
            means,
            life_s,
        }
    }

    /// Strains at a requested time, or at the break before it; `None` for a rope that breaks before the first time.
    pub(super) fn at(&self, i: usize) -> Option<&Mean> {
        self.means.get(i).or(self.at_break.as_ref())
    }

    /// Start of the strains added after tensioning.
    pub(super) fn start(&self) -> Option<&Mean> {
        self.means.first()
    }
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
            let added = mean.add(weight, &law, &state, read_at);
            added.map_err(StrandError::Load)?;
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::endurance::Endurance;
    use crate::law::tested_range::{Extrapolation, ModelError};
    use crate::{Catalogue, Draws};

    /// Flow of 1e-4 % per second on a recoverable strain of 1 %, with rupture at 10 %, by hand.
    #[test]
    fn draw_breaks_at_rupture_strain_and_keeps_it() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let law = Draws::new(rope, 0, 1).expect("complete").nominal;
        let endurance = Endurance {
            rupture_percent: 10.0,
            ..Endurance::default()
        };
        let trajectory = |load_efolds: f64| {
            let extrapolation = Extrapolation {
                load_efolds,
                ..Extrapolation::default()
            };
            let draw = Draw {
                law: &law,
                error: ModelError {
                    extrapolation,
                    error_z: 4.0,
                    ..ModelError::default()
                },
                endurance: &endurance,
            };
            let flow = |time_s: &f64| Mean {
                strain: 1.0 + 1e-4 * time_s,
                irreversible: 1e-4 * time_s,
                full_bedding: 0.0,
            };
            Trajectory::new(&draw, 1e5, 0.5, &[60.0, 1e4, 1e6], |times_s| {
                Some(times_s.iter().map(flow).collect())
            })
        };
        // A day lies within the data.
        let inside = trajectory(0.0);
        assert_eq!(inside.means.len(), 2);
        let decades = (1e5_f64 / 86_400.0).log10();
        let life_s = 1e5 / (4.0 * 0.3 * decades.sqrt()).exp();
        assert!((inside.life_s / life_s - 1.0).abs() < 1e-12);
        let at_break = inside.at(2).expect("broken after the first").strain;
        assert!(
            (at_break - (1.0 + 1e-4 * life_s)).abs() < 1e-9,
            "{at_break}"
        );
        // One e-fold: 25 % and four standard deviations, a factor of e; the immediate strain at most doubles.
        let beyond = trajectory(1.0);
        let second = 2.0 * 1.006 + std::f64::consts::E * (1.0 - 0.006);
        assert!((beyond.means[1].strain - second).abs() < 1e-9);
        assert!(beyond.life_s < 1e5 / std::f64::consts::E);
        assert_eq!(beyond.at(2).expect("broken").strain, 11.0);
        assert!(trajectory(20.0).start().is_none());
    }
}
