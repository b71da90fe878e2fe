//! Causes of a healthy real arm from day to day, and of one that lost stiffness.
//!
//! Two recordings of one KUKA LWR4+ with different motions, in which nothing changed. The motor positions are
//! `q + tau/K` with the torque sensors of the arm; a joint with a loss has a smaller `K` in the session.

use crate::support;

use sinew_estimate::Request;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{self, Payload, SessionEstimate, SessionOptions, Window};
use sinew_log::Mapping;
use std::path::Path;
use support::{repository, shared};

const JOINTS: usize = 7;
/// First and last joint with a load by gravity; those beyond the last one have no informative prior of the stiffness.
const LOADED: (usize, usize) = (1, 3);
/// Stiffness of all joints, N·m/rad.
const K_NM_PER_RAD: f64 = 200.0;
const WHOLE: Window = Window {
    from_s: 0.0,
    to_s: f64::INFINITY,
};

/// A recording of the arm, `lost` of whose stiffness at a joint is gone.
fn request(shared: &Path, folder: &Path, recording: u32, lost: Option<(usize, f64)>) -> Request {
    let urdf = "kuka_lwr4_identified.urdf";
    let robot = repository().join("examples/03-real-arm/robot.toml");
    std::fs::copy(robot, folder.join("robot.toml")).unwrap();
    std::fs::copy(shared.join("models").join(urdf), folder.join(urdf)).unwrap();
    let place = repository().join("examples/mappings/lwr4.toml");
    let mapping = std::fs::read_to_string(&place).unwrap();
    let mut joint = 0;
    let lines = mapping.lines().map(|line| {
        let scale = "scale = 0.005 }";
        if !line.contains(scale) {
            return line.to_owned();
        }
        let ratio = lost
            .filter(|(k, _)| *k == joint)
            .map_or(1.0, |(_, lost)| 1.0 - lost);
        joint += 1;
        line.replace(
            scale,
            &format!("scale = {:?} }}", 1.0 / (ratio * K_NM_PER_RAD)),
        )
    });
    let mapping = lines.collect::<Vec<_>>().join("\n");
    assert_eq!(joint, JOINTS);
    let name = format!("data/lwr4_flobaroid/lwr4_hw_measurements_{recording}.csv");
    let mut request = Request::new(shared.join(name));
    request.open.mapping =
        Some(Mapping::from_toml(&mapping, &place.display().to_string()).unwrap());
    request.robot = Some(folder.to_path_buf());
    request
}

fn baseline(shared: &Path, recording: u32) -> Baseline {
    let folder = tempfile::tempdir().unwrap();
    let request = request(shared, folder.path(), recording, None);
    let learning = session::Learning::default();
    session::learn(&request, WHOLE, &learning, &mut |_| {})
        .unwrap()
        .0
}

fn session_of(
    shared: &Path,
    recording: u32,
    baseline: &Baseline,
    lost: Option<(usize, f64)>,
) -> SessionEstimate {
    let folder = tempfile::tempdir().unwrap();
    let request = request(shared, folder.path(), recording, lost);
    let options = SessionOptions {
        payload: Payload::Empty,
        ..SessionOptions::default()
    };
    let with = Some((baseline, "baseline"));
    session::estimate(&request, WHOLE, with, &options, &mut |_| {})
        .unwrap()
        .0
}

/// Probabilities of a change of the stiffness by more than 5 %.
fn probabilities(estimate: &SessionEstimate) -> Vec<f64> {
    let joints = estimate.joints.iter();
    joints
        .map(|j| j.stiffness_change.map_or(f64::NAN, |c| c.probability))
        .collect()
}

#[test]
fn model_error_of_real_arm_is_no_cause_and_hides_no_loss() {
    let Some(shared) = shared("data").map(|data| data.join("..")) else {
        return;
    };
    for (first, second) in [(1, 3), (3, 1)] {
        let baseline = baseline(&shared, first);
        println!("baseline of {} bytes", baseline.to_text().len());
        let healthy = session_of(&shared, second, &baseline, None);
        let found = probabilities(&healthy);
        let force = healthy.external_force.map(|force| force.probability);
        println!("{first} to {second}, nothing lost: {found:.3?}, force {force:?}");
        let healthy_ones = &found[LOADED.0..=LOADED.1];
        assert!(healthy_ones.iter().all(|p| *p < 0.3), "{found:?}");
        // The vertical axis carries torques of inertia only; no event is reported.
        assert!(found[0] < 0.95, "{found:?}");
        assert!(force.is_none_or(|p| p < 0.3), "{force:?}");
        for joint in [1, 3] {
            let broken = session_of(&shared, second, &baseline, Some((joint, 0.1)));
            let found = probabilities(&broken);
            let change = broken.joints[joint].stiffness_change.unwrap();
            println!("{first} to {second}, joint {joint}: {found:.3?} {change:?}");
            assert!(found[joint] > 0.9, "{found:?}");
            let error = change.change_ratio.mean + 0.1;
            assert!(error.abs() < 2.5 * change.change_ratio.std, "{change:?}");
            let others = (LOADED.0..=LOADED.1).filter(|k| *k != joint);
            assert!(others.map(|k| found[k]).all(|p| p < 0.5), "{found:?}");
        }
    }
}
