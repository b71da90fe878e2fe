//! Who stands where since when, with which ropes.

use crate::FleetError;
use crate::args::Simulate;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use sinew_files::date::{DAY_S, day_number};
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_rope::Catalogue;

/// Batches of each rope.
const BATCHES: usize = 6;
/// Share of robots that are there from the first day; the others come later.
const FIRST_SHARE: f64 = 0.7;
/// Days before the end on which the last robot comes, at the latest.
const LAST_DAYS: u32 = 20;

/// A place robots stand at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Name.
    pub name: &'static str,
    /// Mean temperature, °C.
    pub mean_c: f64,
    /// Half of what summer and winter differ by, K.
    pub season_k: f64,
}

/// Sites of a simulated fleet.
pub(super) const SITES: [Site; 4] = [
    Site {
        name: "cold-store",
        mean_c: 8.0,
        season_k: 2.0,
    },
    Site {
        name: "laboratory",
        mean_c: 21.0,
        season_k: 2.0,
    },
    Site {
        name: "hall",
        mean_c: 19.0,
        season_k: 7.0,
    },
    Site {
        name: "foundry",
        mean_c: 31.0,
        season_k: 5.0,
    },
];

/// A batch of a rope.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// Rope.
    pub rope: String,
    /// Name.
    pub name: String,
    /// How much more than the rope's law it creeps.
    pub factor: f64,
}

/// A tendon of the type.
#[derive(Debug, Clone, PartialEq)]
pub struct TypeTendon {
    /// Joint.
    pub joint: String,
    /// Geometry, pretension and limit.
    pub tendon: Tendon,
    /// Offset at which it is to be tensioned again, rad.
    pub limit_rad: f64,
}

/// A robot of the fleet.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRobot {
    /// Name.
    pub name: String,
    /// Its seed.
    pub seed: u64,
    /// Place in [`SITES`].
    pub site: usize,
    /// Day it began on, from the fleet's first.
    pub since_day: usize,
    /// Of each tendon its batch, as a place in [`Plan::batches`].
    pub batches: Vec<usize>,
}

/// A fleet before anything happens.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Type of the robots.
    pub robot_type: String,
    /// Its tendons, by name.
    pub tendons: Vec<TypeTendon>,
    /// Batches of all ropes.
    pub batches: Vec<Batch>,
    /// Robots, by name.
    pub robots: Vec<PlannedRobot>,
    /// Days that are recorded.
    pub days: usize,
    /// First day, s since 1970.
    pub start_utc_s: f64,
}

impl Plan {
    /// Draws who stands where with which ropes.
    ///
    /// # Errors
    /// [`FleetError::NoTendon`], or a rope that the catalogue doesn't have.
    pub fn draw(
        asked: &Simulate,
        robot: &Robot,
        catalogue: &Catalogue,
    ) -> Result<Self, FleetError> {
        let mut tendons: Vec<TypeTendon> = (robot.joint_names().iter())
            .zip(&robot.transmissions)
            .filter_map(|(joint, transmission)| {
                let tendon = transmission.as_ref()?.tendon.clone()?;
                let limit_rad = tendon.retension_at_m? / tendon.joint_pulley_radius_m;
                (tendon.rope.is_some() && tendon.pretension_n.is_some()).then(|| TypeTendon {
                    joint: joint.clone(),
                    tendon,
                    limit_rad,
                })
            })
            .collect();
        if tendons.is_empty() {
            let robot = asked.robot.display().to_string();
            return Err(FleetError::NoTendon { robot });
        }
        tendons.sort_by(|a, b| a.joint.cmp(&b.joint));
        let mut rng = ChaCha8Rng::seed_from_u64(asked.seed);
        let mut ropes: Vec<&str> = (tendons.iter())
            .filter_map(|t| t.tendon.rope.as_deref())
            .chain(asked.ropes.iter().map(String::as_str))
            .collect();
        ropes.sort_unstable();
        ropes.dedup();
        let mut batches = Vec::new();
        for rope in &ropes {
            catalogue.find(rope)?;
            for i in 1..=BATCHES {
                let normal: f64 = StandardNormal.sample(&mut rng);
                batches.push(Batch {
                    rope: (*rope).to_owned(),
                    name: format!("{rope}/{i:02}"),
                    factor: (asked.batch_spread * normal).exp(),
                });
            }
        }
        // The same place whatever the seed: who looks for it knows where it is.
        batches[2].factor = asked.bad_batch;
        let width = asked.robots.to_string().len().max(4);
        let robots = (1..=asked.robots)
            .map(|i| {
                let seed = rng.random();
                let other = rng.random_range(0..=asked.ropes.len());
                let since_day = match rng.random::<f64>() < FIRST_SHARE {
                    true => 0,
                    false => rng.random_range(0..asked.days.saturating_sub(LAST_DAYS).max(1)),
                };
                let site = rng.random_range(0..SITES.len());
                let delivered = rng.random_range(0..BATCHES);
                let batch_of = |tendon: &TypeTendon| {
                    let own = tendon.tendon.rope.as_deref();
                    let rope = (asked.ropes.get(other).map(String::as_str)).or(own);
                    let first = batches.iter().position(|b| Some(b.rope.as_str()) == rope);
                    first.unwrap_or(0) + delivered
                };
                PlannedRobot {
                    name: format!("arm-{i:0width$}"),
                    seed,
                    site,
                    since_day: since_day as usize,
                    batches: tendons.iter().map(batch_of).collect(),
                }
            })
            .collect();
        Ok(Self {
            robot_type: robot.name.clone(),
            tendons,
            batches,
            robots,
            days: asked.days as usize,
            start_utc_s: day_number(2024, 1, 1).unwrap_or(0) as f64 * DAY_S,
        })
    }
}
