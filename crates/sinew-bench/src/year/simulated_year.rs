//! Simulated events of a robot's year: temperatures, creeping tendons, a strand failure.

use super::YearError;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_rope::{Catalogue, CatalogueRope};
use sinew_sim::year::surrogate::Failure;
use sinew_sim::year::truth::{self, DAYS, TendonYear};

/// Days records are taken for.
pub(super) const DAYS_PER_YEAR: usize = 365;

/// Tendon of the robot with its rope.
#[derive(Debug, Clone)]
pub(super) struct Roped<'a> {
    pub joint: String,
    pub tendon: &'a Tendon,
    pub rope: &'a CatalogueRope,
    /// Whether its forecasts are assessed, which requires sufficient creep.
    pub monitored: bool,
}

/// All tendons with a rope, those of `monitored` first and in that order.
///
/// # Errors
/// [`YearError::Joint`] for a joint of `monitored` without.
pub(super) fn roped<'a>(
    robot: &'a Robot,
    catalogue: &'a Catalogue,
    monitored: &[String],
) -> Result<Vec<Roped<'a>>, YearError> {
    let find = |joint: &str, monitored: bool| -> Result<Roped<'a>, YearError> {
        let missing = || YearError::Joint(joint.into());
        let tendon = robot
            .arm
            .joint_index(joint)
            .and_then(|i| robot.transmissions[i].as_ref())
            .and_then(|t| t.tendon.as_ref())
            .filter(|t| t.pretension_n.is_some())
            .ok_or_else(missing)?;
        let name = tendon.rope.as_ref().ok_or_else(missing)?;
        Ok(Roped {
            joint: joint.into(),
            tendon,
            rope: catalogue.find(name)?,
            monitored,
        })
    };
    let mut out = Vec::new();
    for joint in monitored {
        out.push(find(joint, true)?);
    }
    let others = robot
        .joint_names()
        .iter()
        .filter(|n| !monitored.contains(n));
    out.extend(others.filter_map(|joint| find(joint, false).ok()));
    Ok(out)
}

/// True year of a robot.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SimulatedYear {
    /// Seed of the year.
    pub seed: u64,
    /// True air temperature on each morning, °C; entry 0 is the baseline's.
    pub temperature_c: Vec<f64>,
    /// Joint whose strand fails.
    pub failed_joint: String,
    /// Failure of the year.
    pub failure: Failure,
    /// Joint and creep of every tendon, in the order of [`roped`].
    pub tendons: Vec<(String, TendonYear)>,
}

impl SimulatedYear {
    /// Draws the year of a seed; a strand of one of the monitored tendons fails.
    pub(super) fn draw(seed: u64, roped: &[Roped<'_>]) -> Result<Self, YearError> {
        // Seeds of neighbours and tendons must not be each other's.
        let base = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut rng = ChaCha8Rng::seed_from_u64(base);
        let temperature_c = truth::temperatures_c(&mut rng);
        let monitored = roped.iter().filter(|r| r.monitored).count().max(1);
        let failed = rng.random_range(0..monitored);
        let failure = Failure {
            day: rng.random_range(10..DAYS_PER_YEAR - 10),
            size_rad: 1e-3 * rng.random_range(2.0..4.0),
            stiffness_ratio: 0.01 * rng.random_range(2.0..8.0),
        };
        let mut tendons = Vec::with_capacity(roped.len());
        for (i, r) in roped.iter().enumerate() {
            let own = base ^ (7919 * (i as u64 + 1));
            let year = truth::draw(r.rope, r.tendon, &temperature_c, own, r.monitored)?;
            tendons.push((r.joint.clone(), year));
        }
        Ok(Self {
            seed,
            temperature_c,
            failed_joint: roped.get(failed).map_or(String::new(), |r| r.joint.clone()),
            failure,
            tendons,
        })
    }

    /// The failure of a joint, if it is the one.
    pub(super) fn failure_of(&self, joint: &str) -> Option<Failure> {
        (joint == self.failed_joint).then_some(self.failure)
    }

    /// True offset of a tendon on a morning, rad; 0 where it has none.
    pub(super) fn offset_rad(&self, joint: &str, day: usize) -> f64 {
        let creep = self.tendons.iter().find(|(name, _)| name == joint);
        let creep = creep.map_or(0.0, |(_, year)| year.creep_rad[day.min(DAYS)]);
        let failed = self.failure_of(joint).filter(|f| day >= f.day);
        creep + failed.map_or(0.0, |f| f.size_rad)
    }
}
