//! Plan of a simulated fleet: sites, start days and ropes of the robots.

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
/// Share of robots in operation from the first day; the others start later.
const FIRST_SHARE: f64 = 0.7;
/// Minimum number of days before the end at which the last robot starts.
const LAST_DAYS: u32 = 20;

/// Site of robots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Name of the site.
    pub name: &'static str,
    /// Mean temperature, °C.
    pub mean_c: f64,
    /// Half of the difference between summer and winter, K.
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

/// Production batch of a rope.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// Name of the rope.
    pub rope: String,
    /// Name of the batch.
    pub name: String,
    /// Creep relative to the rope's creep law.
    pub factor: f64,
}

/// Tendon of the robot type.
#[derive(Debug, Clone, PartialEq)]
pub struct TypeTendon {
    /// Name of the joint.
    pub joint: String,
    /// Geometry, pretension and limit.
    pub tendon: Tendon,
    /// Offset at which the tendon is re-tensioned, rad.
    pub limit_rad: f64,
}

/// Planned robot of the fleet.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRobot {
    /// Name of the robot.
    pub name: String,
    /// Seed of the robot.
    pub seed: u64,
    /// Index in [`SITES`].
    pub site: usize,
    /// First day of the robot, counted from that of the fleet.
    pub since_day: usize,
    /// Index in [`Plan::batches`] of each tendon.
    pub batches: Vec<usize>,
}

/// Plan of a fleet.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Type of the robots.
    pub robot_type: String,
    /// Tendons of the type, by name.
    pub tendons: Vec<TypeTendon>,
    /// Batches of all ropes.
    pub batches: Vec<Batch>,
    /// Robots of the fleet, by name.
    pub robots: Vec<PlannedRobot>,
    /// Number of recorded days.
    pub days: usize,
    /// First day, s since 1970.
    pub start_utc_s: f64,
}

impl Plan {
    /// Draws sites, start days and ropes of the robots.
    ///
    /// # Errors
    /// Returns [`FleetError::NoTendon`], or an error of the catalogue for an unknown rope.
    pub fn draw(
        request: &Simulate,
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
            let robot = request.robot.display().to_string();
            return Err(FleetError::NoTendon { robot });
        }
        tendons.sort_by(|a, b| a.joint.cmp(&b.joint));
        let mut rng = ChaCha8Rng::seed_from_u64(request.seed);
        let mut ropes: Vec<&str> = (tendons.iter())
            .filter_map(|t| t.tendon.rope.as_deref())
            .chain(request.ropes.iter().map(String::as_str))
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
                    factor: (request.batch_spread * normal).exp(),
                });
            }
        }
        // The same place whatever the seed: who looks for it knows where it is.
        batches[2].factor = request.bad_batch;
        let width = request.robots.to_string().len().max(4);
        let robots = (1..=request.robots)
            .map(|i| {
                let seed = rng.random();
                let other = rng.random_range(0..=request.ropes.len());
                let since_day = match rng.random::<f64>() < FIRST_SHARE {
                    true => 0,
                    false => rng.random_range(0..request.days.saturating_sub(LAST_DAYS).max(1)),
                };
                let site = rng.random_range(0..SITES.len());
                let delivered = rng.random_range(0..BATCHES);
                let batch_of = |tendon: &TypeTendon| {
                    let own = tendon.tendon.rope.as_deref();
                    let rope = (request.ropes.get(other).map(String::as_str)).or(own);
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
            days: request.days as usize,
            start_utc_s: day_number(2024, 1, 1).unwrap_or(0) as f64 * DAY_S,
        })
    }
}
