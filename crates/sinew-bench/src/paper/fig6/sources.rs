//! Other sources of the torque than the observer: a sensor, the motor's equation.

use super::super::PaperError;
use super::super::analytic::Analytic;
use super::super::sentence::{Sentence, Unit, below};
use super::super::staircase::STEPS;
use super::super::trial::{Estimator, Trial, peak};
use super::{OFFSETS, config, scenario};
use sinew_model::offset::{OffsetConfig, TorqueSource, VelocityFilter};
use sinew_model::robot::Robot;
use sinew_model::transmission::Friction;
use sinew_sim::injected;
use sinew_sim::scenario::FrictionSpec;

pub(super) fn sentences(
    robot: &Robot,
    trial: &Trial,
    shoulder: usize,
    analytic: &Analytic<'_>,
) -> Result<[Sentence; 2], PaperError> {
    Ok([
        sensor(robot, trial, shoulder)?,
        motor(robot, shoulder, analytic)?,
    ])
}

/// Eq. (5) with a measured torque: at every sample, in motion too.
fn sensor(robot: &Robot, trial: &Trial, shoulder: usize) -> Result<Sentence, PaperError> {
    let offset = OFFSETS[1];
    let config = OffsetConfig {
        source: TorqueSource::TorqueSensor,
        ..config()
    };
    let curve = Estimator::of(robot, config).estimate(trial, shoulder, offset)?;
    let errors: Vec<f64> = (curve.iter().zip(&trial.theta))
        .map(|(found, theta)| found - (injected(theta[shoulder], offset) - theta[shoulder]))
        .collect();
    let rule = "largest error over the whole motion, at every sample, with a perfect sensor";
    Ok(below(
        "With a joint torque sensor, eq. (5) and (6) give the offset directly.",
        rule,
        1e3 * peak(&errors),
        1e-3,
        Unit::Rad,
    )
    .of_paper())
}

/// Eq. (2) without the friction of the drive, which the robot has.
fn motor(robot: &Robot, shoulder: usize, analytic: &Analytic<'_>) -> Result<Sentence, PaperError> {
    let mut rubbing = scenario(robot);
    rubbing.motor_friction = FrictionSpec::default();
    let trial = Trial::run(robot, &rubbing)?;
    let config = OffsetConfig {
        source: TorqueSource::Motor,
        velocity: VelocityFilter::StateVariable {
            cutoff_rad_per_s: 40.0,
        },
        ..config()
    };
    let mut blind = robot.clone();
    for t in blind.transmissions.iter_mut().flatten() {
        t.motor_friction = Friction::default();
    }
    let curve = Estimator::of(&blind, config).estimate(&trial, shoulder, 0.0)?;
    let worst = (1..=STEPS)
        .map(|k| trial.at_rest(&curve, k).abs())
        .fold(0.0, f64::max);
    let coulomb_nm = robot.transmissions[shoulder]
        .as_ref()
        .map_or(0.0, |t| t.motor_friction.coulomb_nm);
    let most_mrad = 1e3 * coulomb_nm / analytic.stiffness_nm_per_rad;
    let rule = format!(
        "without it the estimate at one of four rests has an error of at least a tenth of the deflection that the drive's {coulomb_nm} N·m can hide, {most_mrad:.1} mrad"
    );
    let holds = 1e3 * worst >= 0.1 * most_mrad && most_mrad > 0.0;
    Ok(Sentence::added(
        "The motor equation (2) would require the friction of the motor.",
        rule,
        1e3 * worst,
        Unit::Rad,
        holds,
    )
    .of_paper())
}
