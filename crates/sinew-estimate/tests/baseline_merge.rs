//! Merging of baselines from several recordings.

use crate::support;

use sinew_estimate::baseline::{Baseline, MergeOptions, merge};
use sinew_estimate::session;
use sinew_estimate::session::{Recorded, Recorder};
use sinew_model::arm::BodyInertia;
use sinew_model::offset::{
    FeatureConfig, JointParameter, Payload, Prior, StateEstimate, UNKNOWN_OFFSET_RAD,
    state_estimates,
};
use sinew_model::robot::Robot;
use sinew_sim::{Scenario, Simulation};
use support::{biorob_like, repository};

const ROBOT: MergeOptions = MergeOptions {
    fleet: false,
    scatter: 0.01,
};
const FLEET: MergeOptions = MergeOptions {
    fleet: true,
    scatter: 0.01,
};

fn prior(robot: &Robot) -> Prior {
    session::estimator(robot, &session::SessionOptions::default())
        .prior()
        .clone()
}

/// Updates the state estimate with a scalar measurement of noise 1, by the text-book equations.
fn measure(state_estimate: &mut StateEstimate, row: &[f64], value: f64) {
    let d = state_estimate.mean.len();
    let gain: Vec<f64> = state_estimate
        .covariance
        .chunks_exact(d)
        .map(|line| line.iter().zip(row).map(|(p, h)| p * h).sum())
        .collect();
    let spread: f64 = 1.0 + gain.iter().zip(row).map(|(g, h)| g * h).sum::<f64>();
    let residual = value
        - row
            .iter()
            .zip(&state_estimate.mean)
            .map(|(h, x)| h * x)
            .sum::<f64>();
    for (x, g) in state_estimate.mean.iter_mut().zip(&gain) {
        *x += g * residual / spread;
    }
    for i in 0..d {
        for k in 0..d {
            state_estimate.covariance[i * d + k] -= gain[i] * gain[k] / spread;
        }
    }
}

/// Updates the state estimate with measurements of many entries, each changed by about one standard deviation;
/// reproducible by `seed`.
fn learn(prior: &Prior, state_estimate: &mut StateEstimate, seed: u64) {
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let mut state = 0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(seed + 1);
    let mut draw = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for _ in 0..40 {
        let row: Vec<f64> = (0..prior.dimension())
            .map(|k| 2.0 * draw() / fresh.entry(k).std)
            .map(|h| if h.abs() > 1e7 { 0.0 } else { h })
            .collect();
        measure(state_estimate, &row, 3.0 * draw());
    }
}

fn open(prior: &Prior, state_estimate: &mut StateEstimate) {
    prior.reset_offsets(state_estimate, UNKNOWN_OFFSET_RAD);
    prior.reset_zero(state_estimate);
    prior.reset_payload(state_estimate, Payload::Unknown);
}

fn baseline(
    robot: &Robot,
    state_estimate: &StateEstimate,
    recordings: &[&str],
    end_s: i64,
) -> Baseline {
    let d = state_estimate.mean.len();
    let simplest = Recorder::new(robot, &FeatureConfig::default(), 0.5).finish();
    assert!(
        session::learn_recorded(robot, &simplest, "empty", &session::Learning::default()).is_err()
    );
    Baseline {
        temperature_std_k: 0.0,
        change_std_k: 0.0,
        model_error: None,
        anchors: Vec::new(),
        cables: Vec::new(),
        zero_time_ns: None,
        format: "sinew-baseline".into(),
        version: 5,
        robot: robot.name.clone(),
        joints: robot.joint_names().to_vec(),
        stiffness_nm_per_rad: robot
            .transmissions
            .iter()
            .map(|t| t.as_ref().map_or(0.0, |t| t.stiffness_nm_per_rad))
            .collect(),
        inertial: robot.arm.inertial_parameters(),
        recordings: recordings.iter().map(|r| (*r).into()).collect(),
        before: Vec::new(),
        end_time_ns: end_s * 1_000_000_000,
        temperature_c: state_estimate
            .temperature_c
            .is_finite()
            .then_some(state_estimate.temperature_c),
        mean: state_estimate.mean.clone(),
        covariance_lower: (0..d)
            .flat_map(|i| state_estimate.covariance[i * d..=i * d + i].to_vec())
            .collect(),
        noise_rad: vec![3e-4; robot.joint_names().len()],
        motor_noise_nm: vec![0.04; robot.joint_names().len()],
    }
}

/// Largest difference of means and standard deviations, in standard deviations of `b`.
fn apart(a: &StateEstimate, b: &StateEstimate) -> f64 {
    (0..a.mean.len())
        .map(|k| {
            let (a, b) = (a.entry(k), b.entry(k));
            let further = ((a.mean - b.mean) / b.std).abs();
            further.max((a.std / b.std - 1.0).abs())
        })
        .fold(0.0, f64::max)
}

#[test]
fn merge_equals_joint_estimate_in_any_order() {
    let robot = biorob_like();
    let prior = prior(&robot);
    for reference_c in [f64::NAN, 21.0] {
        let mut start = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
        start.temperature_c = reference_c;
        let (mut a, mut b, mut c) = (start.clone(), start.clone(), start.clone());
        learn(&prior, &mut a, 1);
        learn(&prior, &mut b, 2);
        learn(&prior, &mut c, 3);
        // In sequence, each recording with its own offsets and payload.
        let mut both = start.clone();
        for seed in [1, 2, 3] {
            open(&prior, &mut both);
            learn(&prior, &mut both, seed);
        }
        open(&prior, &mut both);
        let files = [(&a, "a"), (&b, "b"), (&c, "c")]
            .map(|(state_estimate, name)| (baseline(&robot, state_estimate, &[name], 60), name));
        for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
            let parts: Vec<(&Baseline, &str)> =
                order.iter().map(|&k| (&files[k].0, files[k].1)).collect();
            let (merged, result) = merge(&robot, &parts, None, &ROBOT).unwrap();
            assert_eq!(merged.recordings.len(), 3);
            assert!((merged.noise_rad[0] - 3e-4).abs() < 1e-12);
            let state_estimate = merged.state_estimate(&robot, &prior, "merged").unwrap();
            let apart = apart(&state_estimate, &both);
            println!("order {order:?}: {apart:.1e} deviations from all together");
            assert!(apart < 1e-6, "{apart}");
            assert!(result.nuisance.iter().any(|m| m.moved));
        }
    }
}

#[test]
fn merge_counts_common_prior_once_and_aligns_temperature() {
    let robot = biorob_like();
    let prior = prior(&robot);
    let mut start = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    start.temperature_c = 20.0;
    learn(&prior, &mut start, 4);
    let common = baseline(&robot, &start, &["first"], 60);
    // Continuing from it resets the variances of the offsets and widens the others slightly.
    let mut aged = start.clone();
    state_estimates::age(&prior, &mut aged);
    open(&prior, &mut aged);
    let (mut a, mut b, mut both) = (aged.clone(), aged.clone(), aged.clone());
    learn(&prior, &mut a, 5);
    learn(&prior, &mut b, 6);
    learn(&prior, &mut both, 5);
    open(&prior, &mut both);
    learn(&prior, &mut both, 6);
    open(&prior, &mut both);
    let a = baseline(&robot, &a, &["first", "second"], 120);
    let b = baseline(&robot, &b, &["first", "third"], 180);
    let parts = [(&a, "a"), (&b, "b")];
    let (merged, _) = merge(&robot, &parts, Some((&common, "common")), &ROBOT).unwrap();
    assert_eq!(merged.recordings, ["first", "second", "third"]);
    let state_estimate = merged.state_estimate(&robot, &prior, "merged").unwrap();
    assert!(
        apart(&state_estimate, &both) < 1e-6,
        "{}",
        apart(&state_estimate, &both)
    );

    // Stiffness at 20 °C and at 30 °C lies on one line, to which both recordings contribute.
    let place = |p: JointParameter| prior.place(1, p);
    let (compliance, thermal) = (
        place(JointParameter::Compliance),
        place(JointParameter::Thermal),
    );
    let mut there = start.clone();
    state_estimates::refer_to(&prior, &mut there, 30.0);
    assert_eq!(there.temperature_c, 30.0);
    let expected = start.mean[compliance] + 10.0 * start.mean[thermal];
    assert!((there.mean[compliance] - expected).abs() < 1e-15);
    let mut back = there.clone();
    state_estimates::refer_to(&prior, &mut back, 20.0);
    assert!(apart(&back, &start) < 1e-9);
    // Without a temperature no reference is possible.
    state_estimates::refer_to(&prior, &mut back, f64::NAN);
    assert_eq!(back.temperature_c, 20.0);
}

#[test]
fn merge_inconsistent_baselines_returns_error() {
    let robot = biorob_like();
    let prior = prior(&robot);
    let mut state_estimate = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    state_estimate.temperature_c = 20.0;
    learn(&prior, &mut state_estimate, 7);
    let a = baseline(&robot, &state_estimate, &["a"], 60);
    let b = baseline(&robot, &state_estimate, &["b"], 60);
    let error_of = |parts: &[(&Baseline, &str)], common: Option<(&Baseline, &str)>| {
        merge(&robot, parts, common, &ROBOT)
            .unwrap_err()
            .to_string()
    };
    let alone = error_of(&[(&a, "a")], None);
    assert!(alone.contains("two files"), "{alone}");
    let twice = error_of(&[(&a, "a"), (&a, "copy")], None);
    assert!(twice.contains("count twice"), "{twice}");
    let stranger = Baseline {
        joints: vec!["hip".into()],
        ..b.clone()
    };
    let stranger = error_of(&[(&a, "a"), (&stranger, "hip.baseline")], None);
    assert!(
        stranger.contains("hip.baseline: belongs to robot"),
        "{stranger}"
    );
    let mut stiffer = b.clone();
    stiffer.stiffness_nm_per_rad[0] *= 1.1;
    let stiffer = error_of(&[(&a, "a"), (&stiffer, "b")], None);
    assert!(stiffer.contains("another stiffness"), "{stiffer}");
    let chain = baseline(&robot, &state_estimate, &["a", "c"], 60);
    let chain_said = error_of(&[(&b, "b"), (&chain, "chain")], None);
    assert!(chain_said.contains("--common"), "{chain_said}");
    let again = Baseline {
        before: vec!["a".into()],
        ..b.clone()
    };
    let again = error_of(&[(&a, "a"), (&again, "again")], None);
    assert!(again.contains("--common"), "{again}");
    let fleet = merge(&robot, &[(&a, "a"), (&b, "b")], Some((&a, "a")), &FLEET);
    assert!(
        fleet
            .unwrap_err()
            .to_string()
            .contains("leave --common out")
    );
    let unrelated = error_of(&[(&chain, "chain"), (&b, "b")], Some((&a, "a")));
    assert!(unrelated.contains("does not continue a"), "{unrelated}");
    let cold = Baseline {
        temperature_c: None,
        ..b
    };
    let cold = error_of(&[(&a, "a"), (&cold, "cold")], None);
    assert!(cold.contains("without a temperature"), "{cold}");
}

/// Minutes A and B of the example's work session for robot `robot_seed`, whose links are all heavier by the same
/// factor; `short`: A has only three poses.
fn sessions(robot: &Robot, robot_seed: u64, seed: u64) -> ([Recorded; 2], Vec<f64>) {
    let place = repository().join("examples/scenarios");
    let text = std::fs::read_to_string(place.join("work-session.toml")).unwrap();
    let text = text
        .replace(
            "mass_factor = { min = 0.9, max = 1.1 }",
            "mass_factor = 1.08",
        )
        .replace(
            "com_factor = { min = 0.95, max = 1.05 }",
            "com_factor = 0.96",
        )
        .replace(
            "com_across_fraction = { std = 0.03 }",
            "com_across_fraction = 0.0",
        )
        .replace(
            "inertia_factor = { min = 0.7, max = 1.3 }",
            "inertia_factor = 1.2",
        )
        .replace("fraction = 0.1\n", "fraction = 0.0\n")
        .replace("duration_s = 180.0", "duration_s = 120.0")
        .replace("    to_s = 180.0", "    to_s = 120.0");
    assert_eq!(
        text.matches("= 1.08").count() + text.matches("= 0.96").count(),
        2
    );
    let mut scenario = Scenario::from_toml(&text, "work-session.toml").unwrap();
    scenario.seed = seed;
    scenario.robot_seed = Some(robot_seed);
    let mut simulation = Simulation::new(robot, &scenario).unwrap();
    let recorder = || Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let (mut a, mut b) = (recorder(), recorder());
    let mut truth = Vec::new();
    let mut k = 0;
    while let Some(frame) = simulation.next_frame().unwrap() {
        let t = f64::from(k) / 250.0;
        k += 1;
        if t < 60.0 {
            a.push(frame, t);
        } else {
            b.push(frame, t);
            truth = simulation.true_state().delta_e.clone();
        }
    }
    let truth = truth.iter().map(|x| 1e3 * x).collect();
    ([a.finish(), b.finish()], truth)
}

#[test]
fn merge_two_recordings_agrees_with_chain() {
    let robot = biorob_like();
    let prior = prior(&robot);
    let ([first, _], _) = sessions(&robot, 5, 51);
    let ([second, _], _) = sessions(&robot, 5, 52);
    let (a, _) =
        session::learn_recorded(&robot, &first, "a", &session::Learning::default()).unwrap();
    let (b, _) =
        session::learn_recorded(&robot, &second, "b", &session::Learning::default()).unwrap();
    let (merged, _) = merge(&robot, &[(&a, "a"), (&b, "b")], None, &ROBOT).unwrap();
    let going_on = session::Learning {
        prior: Some((&a, "a")),
        ..session::Learning::default()
    };
    let (chained, _) = session::learn_recorded(&robot, &second, "b", &going_on).unwrap();
    let [merged, mut chained] =
        [merged, chained].map(|m| m.state_estimate(&robot, &prior, "merged").unwrap());
    open(&prior, &mut chained);
    let mut off: Vec<f64> = (0..prior.payload_place())
        .filter(|&k| merged.entry(k).std > 1e-8)
        .map(|k| (merged.entry(k).mean - chained.entry(k).mean).abs() / merged.entry(k).std)
        .collect();
    off.sort_by(f64::total_cmp);
    println!(
        "means apart by {:.2} (median), {:.2} (worst) deviations",
        off[off.len() / 2],
        off[off.len() - 1]
    );
    // Noise and weights are estimated per recording, and the variance of friction grows in between.
    assert!(off[off.len() / 2] < 0.1 && off[off.len() - 1] < 1.0);
}

#[test]
fn fleet_merge_shares_only_masses() {
    let robot = biorob_like();
    let prior = prior(&robot);
    let files: Vec<(Baseline, String)> = (0..6)
        .map(|k| {
            let ([a, _], _) = sessions(&robot, 60 + k, 160 + k);
            let (learned, _) = session::learn_recorded(
                &robot,
                &a,
                &format!("arm-{k}"),
                &session::Learning::default(),
            )
            .unwrap();
            (learned, format!("arm-{k}.baseline"))
        })
        .collect();
    let parts: Vec<(&Baseline, &str)> = files.iter().map(|(b, f)| (b, f.as_str())).collect();
    let (known, result) = merge(&robot, &parts, None, &FLEET).unwrap();
    let state_estimate = known.state_estimate(&robot, &prior, "known").unwrap();
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    for k in 0..prior.payload_place() {
        let body = prior.describe(k).unwrap().unit.starts_with("kg");
        if !body {
            assert_eq!(
                state_estimate.entry(k),
                fresh.entry(k),
                "{:?}",
                prior.describe(k)
            );
        }
    }
    let surer = result.nuisance.iter().filter(|m| m.moved).count();
    println!("{surer} parameters with smaller variance or another mean");
    assert!(surer > 3);
    let mut other = parts.clone();
    other.reverse();
    let (again, _) = merge(&robot, &other, None, &FLEET).unwrap();
    let again = again.state_estimate(&robot, &prior, "again").unwrap();
    assert!(apart(&again, &state_estimate) < 1e-6);

    // Another arm without a recording directly after tensioning: offsets relative to the encoder zero.
    let ([_, b], truth) = sessions(&robot, 70, 170);
    let options = session::SessionOptions::default();
    let with = Some((&known, "known"));
    let (taught, _) = session::estimate_recorded(&robot, &b, "B", with, &options).unwrap();
    let (alone, _) = session::estimate_recorded(&robot, &b, "B", None, &options).unwrap();
    let mut narrower = 0;
    for (i, (taught, alone)) in taught.joints.iter().zip(&alone.joints).enumerate() {
        println!(
            "{}: {:+.2} ± {:.2} mrad with the type's masses, {:+.2} ± {:.2} without",
            taught.name,
            1e3 * taught.offset_rad.mean - truth[i],
            1e3 * taught.offset_rad.half_width_95(),
            1e3 * alone.offset_rad.mean - truth[i],
            1e3 * alone.offset_rad.half_width_95()
        );
        assert!(
            (1e3 * taught.offset_rad.mean - truth[i]).abs()
                < 1.5 * 1e3 * taught.offset_rad.half_width_95()
        );
        narrower += usize::from(
            1e3 * taught.offset_rad.half_width_95() < 0.97 * 1e3 * alone.offset_rad.half_width_95(),
        );
    }
    assert!(narrower > 0);
}

#[test]
fn baseline_of_other_masses_or_stiffness_returns_error() {
    let robot = biorob_like();
    let prior = prior(&robot);
    let state_estimate = prior.state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let learned = baseline(&robot, &state_estimate, &["a"], 0);
    assert!(learned.state_estimate(&robot, &prior, "a").is_ok());
    let reason = |robot: &Robot| {
        learned
            .state_estimate(robot, &prior, "a.baseline")
            .unwrap_err()
            .to_string()
    };
    let mut heavier = robot.clone();
    let held = BodyInertia {
        mass: 0.05,
        com: [0.0; 3],
        inertia: [[0.0; 3]; 3],
    };
    let tool = heavier.arm.with_payload("tool", held);
    heavier.arm = tool.unwrap().unwrap();
    let result = reason(&heavier);
    assert!(
        result.contains("a.baseline")
            && result.contains("wrist")
            && result.contains("kg in the baseline, "),
        "{result}"
    );
    let mut softer = robot.clone();
    softer.transmissions[2]
        .as_mut()
        .unwrap()
        .stiffness_nm_per_rad += 1.0;
    assert!(
        reason(&softer).contains("stiffness_nm_per_rad"),
        "{}",
        reason(&softer)
    );
    // It is still accepted after a round trip through its file.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.baseline");
    learned.write(&path).unwrap();
    let read = Baseline::read(&path).unwrap();
    assert!(read.state_estimate(&robot, &prior, "a").is_ok());
}

#[test]
fn baseline_file_of_version_4_is_read() {
    let robot = biorob_like();
    let state_estimate = prior(&robot).state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
    let mut written = baseline(&robot, &state_estimate, &["a"], 0);
    written.version = 6;
    let text = written.to_text();
    let former = text
        .replace("\"version\":6", "\"version\":4")
        .replace("temperature_std_k", "temperature_deviation_k")
        .replace("change_std_k", "change_deviation_k");
    assert_eq!(former.matches("deviation_k").count(), 2, "{former}");
    assert_eq!(Baseline::parse(&former, "a").unwrap(), written);
    let oldest = text.replace("\"version\":6", "\"version\":3");
    let error = Baseline::parse(&oldest, "a").unwrap_err().to_string();
    assert!(error.contains("version 3, expected"), "{error}");
}
