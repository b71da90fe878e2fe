//! Limits of a tendon, with where they come from, and whether one is passed.

use crate::alarm::{AlarmCause, LimitOrigin};
use crate::snapshot::LimitNow;
use sinew_model::Gaussian;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_rope::{Catalogue, CatalogueError};

/// A limit's alarm is raised from this probability on.
const RAISED: f64 = 0.95;
/// It may be cleared below this one.
const CLEARED: f64 = 0.5;

/// Limits of a tendon.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Limits {
    /// Elongation since the last tensioning, m.
    pub(super) retension_m: Option<(f64, LimitOrigin)>,
    /// Strain since the rope was new, as a fraction.
    pub(super) replace_ratio: Option<(f64, LimitOrigin)>,
}

impl Limits {
    /// What robot.toml says, else the rope's maker in the catalogue.
    pub(super) fn of(tendon: &Tendon, catalogue: &Catalogue) -> Result<Self, CatalogueError> {
        let toml = |limit: f64| (limit, LimitOrigin::RobotToml);
        let rope = tendon.rope.as_deref().map(|name| catalogue.find(name));
        let stated = rope
            .transpose()?
            .and_then(|rope| rope.entry.discard_strain());
        let maker = stated.map(|ratio| (ratio, LimitOrigin::Catalogue));
        Ok(Self {
            retension_m: tendon.retension_at_m.map(toml),
            replace_ratio: tendon.replace_at_strain.map(toml).or(maker),
        })
    }

    /// As they are shown.
    pub(super) fn now(&self) -> Vec<LimitNow> {
        let retension = self
            .retension_m
            .map(|(elongation_m, origin)| LimitNow::Retension {
                elongation_m,
                origin,
            });
        let replace = self
            .replace_ratio
            .map(|(strain_ratio, origin)| LimitNow::Replace {
                strain_ratio,
                origin,
            });
        retension.into_iter().chain(replace).collect()
    }
}

/// The limits of every joint's tendon, and the robot with them.
pub(super) fn with_limits(
    robot: &Robot,
    catalogue: &Catalogue,
) -> Result<(Robot, Vec<Limits>), CatalogueError> {
    let mut robot = robot.clone();
    let mut all = Vec::new();
    for transmission in &mut robot.transmissions {
        let tendon = transmission.as_mut().and_then(|t| t.tendon.as_mut());
        all.push(match tendon {
            Some(tendon) => {
                let limits = Limits::of(tendon, catalogue)?;
                tendon.replace_at_strain = limits.replace_ratio.map(|(ratio, _)| ratio);
                limits
            }
            None => Limits::default(),
        });
    }
    Ok((robot, all))
}

/// Whether a limit is passed, `None` between raising and clearing; and what that rests on.
pub(super) fn passed(
    value: Gaussian,
    (limit, origin): (f64, LimitOrigin),
    clear_below: f64,
) -> (Option<bool>, AlarmCause) {
    let probability = value.probability_above(limit);
    let holds = if probability >= RAISED {
        Some(true)
    } else if probability < CLEARED && value.mean < clear_below * limit {
        Some(false)
    } else {
        None
    };
    let cause = AlarmCause::Limit {
        mean: value.mean,
        deviation: value.deviation,
        limit,
        probability,
        origin,
    };
    (holds, cause)
}
