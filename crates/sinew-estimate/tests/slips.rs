//! Slips in the third session of the bench's scenarios: detected, separated from stiffness loss and noise, and
//! the final offset inside its interval.
//!
//! `SINEW_SEEDS=40 cargo test --release -p sinew-estimate --test all slips:: -- --nocapture` measures it.

use crate::support;

use sinew_estimate::session;
use sinew_estimate::session::{Recorded, Recorder, SessionEstimate};
use sinew_model::offset::FeatureConfig;
use sinew_sim::Simulation;
use sinew_sim::protocol::{Plan, plan_named};
use support::{requested_seeds, watching};

/// Joint name and time of a slip, s.
type Slip = (String, f64);

/// Estimate of session C, the true offsets at its end, mrad, and its slips.
fn third_session(plan: &Plan, seed: u64) -> (SessionEstimate, Vec<f64>, Vec<Slip>) {
    let mut scenario = plan.scenario.clone();
    scenario.seed = seed;
    let mut simulation = Simulation::new(&plan.simulated, &scenario).unwrap();
    let sessions = &scenario.sessions;
    let recorder = |_| Recorder::new(&plan.robot, &FeatureConfig::default(), 0.5);
    let mut recorders: Vec<Recorder> = sessions.iter().map(recorder).collect();
    let (mut truth, mut slips) = (Vec::new(), Vec::new());
    let mut k = 0.0;
    while let Some(frame) = simulation.next_frame().unwrap() {
        let t: f64 = k / scenario.sample_rate_hz;
        k += 1.0;
        let session = sessions
            .iter()
            .position(|s| (s.from_s..s.to_s).contains(&t));
        let Some(session) = session else { continue };
        recorders[session].push(frame, t);
        let now: Vec<f64> = (simulation.true_state().delta_e.iter())
            .map(|x| 1e3 * x)
            .collect();
        if session == 2 {
            for ((name, before), now) in plan.robot.joint_names().iter().zip(&truth).zip(&now) {
                if f64::abs(now - before) > 1.0 {
                    slips.push((name.clone(), t));
                }
            }
        }
        truth = now;
    }
    let sessions: Vec<Recorded> = recorders.into_iter().map(Recorder::finish).collect();
    let options = watching(plan);
    let (baseline, _) = session::learn_recorded(
        &plan.robot,
        &sessions[0],
        "A",
        &session::Learning::default(),
    )
    .unwrap();
    let watch = |part: &Recorded, with| {
        session::estimate_recorded(&plan.robot, part, "part", Some((with, "before")), &options)
    };
    let (_, next) = watch(&sessions[1], &baseline).unwrap();
    let (result, _) = watch(&sessions[2], &next).unwrap();
    (result, truth, slips)
}

#[test]
fn slips_are_separated_from_noise_and_stiffness_loss() {
    // With two thirds of a session after it, a slip was once classified as noise; with four poses as a strand failure.
    let ordinary = [("S7", vec![3020]), ("S9", vec![3007, 3014])];
    let requested = requested_seeds().map(|n| {
        let seeds: Vec<u64> = (3000..3000 + n).collect();
        ["S5", "S7", "S8", "S9"]
            .map(|name| (name, seeds.clone()))
            .to_vec()
    });
    for (name, seeds) in requested.clone().unwrap_or_else(|| ordinary.to_vec()) {
        let plan = plan_named(name).unwrap();
        let (mut found, mut slipped, mut inside, mut offsets) = (0, 0, 0, 0);
        let mut late_s = Vec::new();
        for seed in seeds {
            let (result, truth, slips) = third_session(&plan, seed);
            for (joint, truth) in result.joints.iter().zip(&truth) {
                let error = 1e3 * joint.offset_rad.mean - truth;
                let is_inside = error.abs() < 1e3 * joint.offset_rad.half_width_95();
                inside += usize::from(is_inside);
                offsets += 1;
                let own = slips.iter().filter(|(name, _)| *name == joint.name);
                for (_, at_s) in own {
                    slipped += 1;
                    let near = |s: &&session::TendonChange| (s.time_s - at_s).abs() < 5.0;
                    let step = joint.changes.iter().find(near);
                    let as_slip = step.is_some_and(|s| s.kind == session::TendonChangeKind::Slip);
                    found += usize::from(as_slip);
                    late_s.extend(step.map(|s| s.time_s - at_s));
                    if !(as_slip && is_inside) {
                        println!(
                            "{name} {seed} {}: {error:+.2} ± {:.2}, slip at {at_s:.1} s, {step:?}",
                            joint.name,
                            1e3 * joint.offset_rad.half_width_95()
                        );
                    }
                    assert!(
                        requested.is_some() || (as_slip && is_inside),
                        "{name} {seed}"
                    );
                }
            }
        }
        println!(
            "{name}: {found} of {slipped} slips called so, {inside} of {offsets} inside in the end"
        );
        late_s.sort_by(f64::total_cmp);
        let median_s = late_s[late_s.len() / 2];
        println!("{name}: {median_s:+.2} s late in the median");
        // Features lag by 0.26 s, which the estimated time must not.
        assert!(median_s.abs() < 0.15, "{median_s}");
        assert!(slipped > 0);
    }
}
