//! Golden results of the estimators for six recordings of one arm.
//!
//! Other tests compare with closed forms, truths and identities, with tolerances of some standard deviations.

use crate::answers::Answers;
use crate::synthetic_arm::{CALM, DT_S, LASTS_S, Motion, N, Plant, STRETCHED_RAD, Truth, robot};
use sinew_model::offset::excess_residual::tempered;
use sinew_model::offset::shared_parameters::{learn_type, pool_bodies};
use sinew_model::offset::{
    Block, ExternalForce, FeatureConfig, FeatureObserver, MapEstimate, MapEstimator, Payload,
    Prior, SearchScope, StateEstimate, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD, shared_errors,
    state_estimates,
};
use sinew_model::robot::Robot;

fn record(robot: &Robot, truth: Truth) -> Vec<Block> {
    let mut features = FeatureObserver::new(&robot.arm, FeatureConfig::default());
    let motion = Motion::new(truth.seed, truth.reach);
    let mut plant = Plant::new(robot, truth);
    let mut blocks = Vec::new();
    let [from_c, to_c] = truth.temperature_c;
    for k in 0..(LASTS_S / DT_S) as usize {
        let time_s = k as f64 * DT_S;
        let found = plant.sample(time_s, &motion);
        let celsius = from_c + (to_c - from_c) * time_s / LASTS_S;
        if features.step(DT_S, &found.q, &found.theta, &found.tau_m, celsius) == Ok(true) {
            blocks.push(features.block().clone());
        }
    }
    blocks
}

fn estimator(robot: &Robot, force_n: f64) -> MapEstimator {
    let at = robot.arm.body(N - 1).expect("a hand").com.map(|c| 1.5 * c);
    let prior = Prior::new(
        &robot.arm,
        &robot.transmissions,
        N - 1,
        at,
        robot.tolerances,
    );
    MapEstimator::new(prior, &FeatureConfig::default())
        .with_external_force(&robot.arm, ExternalForce::possible(force_n))
}

impl Answers {
    fn state_estimate(&mut self, prior: &Prior, state_estimate: &StateEstimate) {
        for k in 0..prior.dimension() {
            self.gaussian(&format!("entry {k}"), state_estimate.entry(k));
        }
        // What goes together: the first entry with all others.
        let d = prior.dimension();
        let row: f64 = state_estimate.covariance[..d].iter().map(|c| c.abs()).sum();
        self.number("first row", row);
    }

    fn map(&mut self, prior: &Prior, map: &MapEstimate) {
        for i in 0..N {
            self.gaussian(&format!("offset {i}"), map.offset(prior, i));
            self.gaussian(
                &format!("offset {i} at 20 s"),
                map.offset_at(prior, i, 20.0),
            );
            self.number(&format!("noise {i}"), map.noise_rad[i]);
            self.number(&format!("motor noise {i}"), map.motor_noise_nm[i]);
            if let Some(change) = map.stiffness_changes.get(i).copied().flatten() {
                self.probability(&format!("stiffness changed {i}"), change.probability);
                self.gaussian(
                    &format!("compliance_increase {i}"),
                    change.compliance_increase,
                );
            }
            if let Some(creep) = map.creep.get(i).copied().flatten() {
                self.probability(&format!("creeps {i}"), creep.probability);
                self.gaussian(&format!("rate {i}"), creep.rate_rad_per_s);
            }
        }
        for (k, change) in map.changes.iter().enumerate() {
            let name = format!("{:?}", change.kind);
            self.number(&format!("{name} at"), change.at_s);
            self.gaussian(&name, map.change(prior, k));
            if let Some(found) = map.posterior(change) {
                self.number(&format!("{name} happened at"), found.time_s);
                self.number(&format!("{name} from"), found.interval_s.low);
                self.number(&format!("{name} to"), found.interval_s.high);
                self.probability(&format!("{name} happened"), found.probability);
                self.probability(&format!("{name} no noise"), found.probability_not_noise);
            }
        }
        if let Some(force) = &map.force {
            self.probability("force acts", force.probability);
            for (axis, n) in ["x", "y", "z"].iter().zip(force.force_n) {
                self.gaussian(&format!("force {axis}"), n);
            }
        }
        self.number("weights", map.weights.iter().sum());
        self.number("cost", map.convergence.cost);
        self.number("steps", map.convergence.iterations as f64);
    }
}

/// Returns the posterior of a recording directly after tensioning, ten days before the next.
fn learned(robot: &Robot, answers: &mut Answers) -> StateEstimate {
    let estimator = estimator(robot, 1.0);
    let prior = estimator.prior();
    let start = prior.state_estimate(Payload::Empty, TENSIONED_OFFSET_RAD);
    let scope = SearchScope {
        offsets: false,
        payload: false,
        creep: false,
        continues: false,
        onset: None,
    };
    let blocks = record(robot, CALM);
    let map = estimator.search(&start, &blocks, Payload::Empty, scope);
    let map = map.expect("an estimate");
    answers.about("baseline");
    answers.map(prior, &map);
    let mut state_estimate = tempered(prior, &start, map.state_estimate(prior), &map.noise_rad);
    answers.state_estimate(prior, &state_estimate);
    state_estimates::age_by(prior, &mut state_estimate, 10.0);
    prior.reset_offsets(&mut state_estimate, UNKNOWN_OFFSET_RAD);
    state_estimate
}

/// A recording estimated from what was learned before.
fn estimated(
    name: &str,
    truth: Truth,
    (payload, force_n): (Payload, f64),
    (before, answers): (&StateEstimate, &mut Answers),
) -> StateEstimate {
    let robot = robot();
    let estimator = estimator(&robot, force_n);
    let prior = estimator.prior();
    let mut start = before.clone();
    prior.reset_payload(&mut start, payload);
    let scope = SearchScope {
        offsets: true,
        payload: true,
        creep: true,
        continues: false,
        onset: None,
    };
    let blocks = record(&robot, truth);
    let map = estimator.search(&start, &blocks, payload, scope);
    let map = map.expect("an estimate");
    answers.about(&format!("{name}, at once,"));
    answers.map(prior, &map);
    let after = map.state_estimate(prior);
    answers.state_estimate(prior, &after);
    let shared = shared_errors(prior, before, &start, &after, false).expect("shared");
    for (i, shared) in shared.iter().enumerate() {
        answers.number(&format!("shared {i}"), shared.baseline_rad);
        answers.number(&format!("shared drift {i}"), shared.drift_rad);
    }
    after
}

#[test]
fn posteriors_of_six_recordings_match_golden() {
    let robot = robot();
    let mut answers = Answers::default();
    let before = learned(&robot, &mut answers);
    let stretched = Truth {
        offset_rad: STRETCHED_RAD,
        ..CALM
    };
    let slipped = Truth {
        seed: 2,
        slip: Some((2, 41.0, 5e-3)),
        push_at_s: Some(25.0),
        temperature_c: [24.0, 27.0],
        ..stretched
    };
    let strand = Truth {
        seed: 3,
        strand: Some((1, 45.0, 0.88)),
        motor_torque: false,
        ..stretched
    };
    let pulled = Truth {
        seed: 4,
        force_n: [0.0, 1.5, -1.0],
        ..stretched
    };
    let loaded = Truth {
        seed: 5,
        load: Some((30.0, 0.5)),
        stiffness_factor: [1.06, 0.93, 0.92, 0.9],
        ..stretched
    };
    // An external force on an arm that hardly moves is similar to a stiffness loss.
    let nearly_at_rest = Truth {
        reach: 0.05,
        seed: 7,
        force_n: [2.0, 0.0, -4.0],
        motor_torque: false,
        ..stretched
    };
    let creeping = Truth {
        seed: 6,
        creep_rad_per_s: 3e-3 / 60.0,
        temperature_c: [f64::NAN; 2],
        ..stretched
    };
    let all = &mut answers;
    let a = estimated("slip", slipped, (Payload::Unknown, 0.0), (&before, all));
    let b = estimated("strand", strand, (Payload::Empty, 1.0), (&before, all));
    estimated("force", pulled, (Payload::Unknown, 1.0), (&before, all));
    estimated(
        "nearly_at_rest",
        nearly_at_rest,
        (Payload::Empty, 1.0),
        (&before, all),
    );
    let load = Payload::Unknown;
    estimated("load", loaded, (load, 1.0), (&before, all));
    estimated("creep", creeping, (Payload::Empty, 1.0), (&before, all));

    let estimator = estimator(&robot, 1.0);
    let prior = estimator.prior();
    let mut both = state_estimates::merge(prior, &before, &a, &b).expect("merged");
    all.about("merged");
    all.state_estimate(prior, &both);
    state_estimates::refer_to(prior, &mut both, 30.0);
    all.about("merged, warmer");
    all.state_estimate(prior, &both);
    for (i, rad) in state_estimates::unknown_temperature(prior, &mut both, 5.0)
        .iter()
        .enumerate()
    {
        all.number(&format!("unknown temperature effect {i}"), *rad);
    }
    let start = prior.state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let parts = [[start.clone(), a], [start, b]];
    let (kind, alike) = learn_type(prior, &parts).expect("a type");
    all.about("type");
    all.state_estimate(prior, &kind);
    for (k, alike) in alike.iter().enumerate() {
        all.number(&format!("alike {k}"), alike.ratio);
    }
    all.about("bodies");
    all.state_estimate(prior, &pool_bodies(prior, &parts, 0.5).expect("pooled"));
    answers.hold("golden_offsets.csv");
}
