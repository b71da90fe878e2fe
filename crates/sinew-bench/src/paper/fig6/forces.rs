//! External forces that are unknown to the estimator: a payload, and contact forces from all directions.

use super::super::PaperError;
use super::super::analytic::Analytic;
use super::super::sentence::{Sentence, Unit, below, near};
use super::super::staircase::{STEPS, rest_angle_rad};
use super::super::trial::{Estimator, Trial, mean};
use super::{config, scenario};
use rayon::prelude::*;
use sinew_figure::Table;
use sinew_model::robot::Robot;
use sinew_sim::Scenario;
use sinew_sim::scenario::{Contact, Draw, Payload};

const TOOL: &str = "tool";
const PAYLOAD_KG: f64 = 0.1;
const PUSH_N: f64 = 2.0;
/// Standard gravity, m/s².
const STANDARD_GRAVITY: f64 = 9.81;
/// Directions in the plane in which the joint moves, degrees from forward to up.
const DIRECTIONS: usize = 8;

/// External force in one direction, with the estimates at the four rests.
struct Push {
    degrees: f64,
    /// Estimated offset, rad.
    found_rad: [f64; STEPS],
    /// Analytic value `−tau_ext/K`, rad.
    analytic_rad: [f64; STEPS],
}

pub(super) struct Forces {
    payload_rad: f64,
    payload_analytic_rad: f64,
    pushes: Vec<Push>,
}

impl Forces {
    pub(super) fn run(
        robot: &Robot,
        shoulder: usize,
        analytic: &Analytic<'_>,
    ) -> Result<Self, PaperError> {
        let nominal = Estimator::of(robot, config());
        let mut loaded = scenario(robot);
        loaded.payloads.push(Payload {
            link: TOOL.into(),
            line: 0,
            mass_kg: Draw::Fixed(PAYLOAD_KG),
            com_m: [0.0; 3],
            com_spread_m: [0.0; 3],
            attach_s: 0.0,
            release_s: f64::INFINITY,
        });
        let trial = Trial::run(robot, &loaded)?;
        let curve = nominal.estimate(&trial, shoulder, 0.0)?;
        let rests: Vec<f64> = (1..=STEPS).map(|k| trial.at_rest(&curve, k)).collect();
        let weight = [0.0, 0.0, -PAYLOAD_KG * STANDARD_GRAVITY];
        let held = (1..=STEPS)
            .map(|k| analytic.torque_of_force_nm(&trial.pose_at_rest(k), TOOL, weight))
            .collect::<Result<Vec<f64>, _>>()?;
        let pushes = (0..DIRECTIONS)
            .into_par_iter()
            .map(|i| push(robot, shoulder, &nominal, analytic, i))
            .collect::<Vec<_>>()
            .into_iter()
            .collect::<Result<_, _>>()?;
        Ok(Self {
            payload_rad: mean(&rests),
            payload_analytic_rad: -mean(&held) / analytic.stiffness_nm_per_rad,
            pushes,
        })
    }

    pub(super) fn sentences(&self) -> Vec<Sentence> {
        let cases = || self.pushes.iter().flat_map(Push::cases);
        let share = |holds: &dyn Fn(&(f64, f64)) -> bool| {
            cases().filter(holds).count() as f64 / cases().count().max(1) as f64
        };
        let over = share(&|(found, _)| *found > 0.0);
        let as_analytic = cases().map(|(found, hand)| (found - hand).abs());
        let largest = cases().map(|(_, hand)| hand.abs()).fold(0.0, f64::max);
        let agree = cases().all(|(found, hand)| {
            // Across the joint's axis nothing is left to have a sign.
            hand.abs() < 0.02 * largest || (found > 0.0) == (hand > 0.0)
        });
        vec![
            Sentence::added(
                "If the external forces are not known, the position offset is overestimated.",
                format!("for each of {} forces of {PUSH_N} N at the tool ({DIRECTIONS} directions, four rests). A force that pulls the joint back is overestimated, one that pushes it on is underestimated: the statement of the paper is correct for suspended loads", cases().count()),
                100.0 * over,
                Unit::ShareOfCases,
                over == 1.0,
            )
            .of_paper(),
            Sentence::added(
                "The sign of the error is that of −tau_ext.",
                "for each of these forces whose torque is at least a fiftieth of the largest",
                100.0 * f64::from(u8::from(agree)),
                Unit::ShareOfCases,
                agree,
            ),
            below(
                "An unknown external torque appears as an offset of −tau_ext/K.",
                "largest difference over these forces, of torques at the deflected pose of the arm; a fiftieth of the largest",
                1e3 * as_analytic.fold(0.0, f64::max),
                0.02e3 * largest,
                Unit::Rad,
            ),
            near(
                format!("An unknown payload of {PAYLOAD_KG} kg appears as an offset of its gravity torque over K."),
                "mean over the four rests; analytic: its gravity torque at the deflected pose of the arm, over K. The heavier arm still oscillates slightly at the end of a rest",
                1e3 * self.payload_rad,
                1e3 * self.payload_analytic_rad,
                0.05,
                Unit::Rad,
            ),
        ]
    }

    pub(super) fn table(&self) -> Table {
        let cell = |rad: f64| sinew_figure::rounded(1e3 * rad, 3);
        let rows = self.pushes.iter().map(|p| {
            let mut row = vec![format!("{:.0}", p.degrees)];
            row.extend(p.found_rad.iter().map(|rad| cell(*rad)));
            row
        });
        let mut head = vec!["direction, °".to_owned()];
        head.extend(
            (1..=STEPS).map(|k| format!("at {:.1}°, mrad", rest_angle_rad(k).to_degrees())),
        );
        Table {
            caption: format!(
                "Offset estimate due to an unknown force of {PUSH_N} N at the tool, by its direction (0°: forward, 90°: up) and the shoulder's angle. The true offset is 0"
            ),
            head,
            rows: rows.collect(),
            ..Table::default()
        }
    }
}

impl Push {
    fn cases(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.found_rad.iter().copied().zip(self.analytic_rad)
    }
}

fn push(
    robot: &Robot,
    shoulder: usize,
    nominal: &Estimator,
    analytic: &Analytic<'_>,
    i: usize,
) -> Result<Push, PaperError> {
    let degrees = 360.0 * i as f64 / DIRECTIONS as f64;
    let (up, forward) = degrees.to_radians().sin_cos();
    let force_n = [PUSH_N * forward, 0.0, PUSH_N * up];
    let trial = Trial::run(robot, &pushed(robot, force_n))?;
    let curve = nominal.estimate(&trial, shoulder, 0.0)?;
    let mut found_rad = [0.0; STEPS];
    let mut analytic_rad = [0.0; STEPS];
    for k in 1..=STEPS {
        found_rad[k - 1] = trial.at_rest(&curve, k);
        let tau = analytic.torque_of_force_nm(&trial.pose_at_rest(k), TOOL, force_n)?;
        analytic_rad[k - 1] = -tau / analytic.stiffness_nm_per_rad;
    }
    Ok(Push {
        degrees,
        found_rad,
        analytic_rad,
    })
}

fn pushed(robot: &Robot, force_n: [f64; 3]) -> Scenario {
    let mut scenario = scenario(robot);
    scenario.contacts.push(Contact {
        start_s: 0.0,
        duration_s: f64::MAX,
        link: TOOL.into(),
        line: 0,
        point_m: [0.0; 3],
        force_n,
        rise_s: 0.1,
    });
    scenario
}
