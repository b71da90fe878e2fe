//! The robots of the benches: our own models of 4 to 32 joints, and a smooth motion of each.

use sinew_model::arm::{Arm, urdf};

/// Names in `tests/reference/models`, by number of joints.
const MODELS: [(usize, &str); 4] = [
    (4, include_str!("../../tests/reference/models/serial4.urdf")),
    (7, include_str!("../../tests/reference/models/serial7.urdf")),
    (
        17,
        include_str!("../../tests/reference/models/torso17.urdf"),
    ),
    (
        32,
        include_str!("../../tests/reference/models/humanoid32.urdf"),
    ),
];

/// Number of samples of a motion at 1 kHz; it exceeds the memory of branch predictors.
const SAMPLES: usize = 1024;

/// `(q, dq)`, sample by sample.
pub(crate) type Motion = Vec<(Vec<f64>, Vec<f64>)>;

/// An arm and `(q, dq)` at 1 kHz, joints moving ±1 rad with frequencies of 0.3 Hz and up.
pub(crate) fn moving_arms() -> impl Iterator<Item = (usize, Arm, Motion)> {
    MODELS.iter().map(|(n, text)| {
        let arm = urdf::parse(text, &urdf::UrdfOptions::default())
            .expect("our own model")
            .arm;
        assert_eq!(arm.dof(), *n);
        let at = |k: usize| {
            let t = 1e-3 * k as f64;
            let rate = |i: usize| 2.0 + 0.7 * i as f64;
            let q = (0..*n).map(|i| (rate(i) * t + i as f64).sin());
            let dq = (0..*n).map(|i| rate(i) * (rate(i) * t + i as f64).cos());
            (q.collect(), dq.collect())
        };
        (*n, arm, (0..SAMPLES).map(at).collect())
    })
}

/// The URDF of one of them, by its number of joints.
#[allow(dead_code, reason = "not every bench needs the text")]
pub(crate) fn urdf_of(joints: usize) -> Option<&'static str> {
    let mut models = MODELS.iter();
    models.find(|(n, _)| *n == joints).map(|(_, text)| *text)
}
