//! Absolute offsets of a real arm: the KUKA LWR4+ recording with added offsets.
//!
//! The recording has no motor positions; they are built as its own `q + tau/K` for several true `K`.
//! The baseline is estimated from one half, offsets are added in the other, and the
//! estimate with that baseline is compared with them. Masses are those of the identified model;
//! the estimator uses the torque sensors only through the simulated springs. Their zero offsets (up to
//! 2 N·m) act as encoder zero offsets, which `[tolerances] zero_mrad` covers.
//!
//! `SINEW_LONG=1 cargo test --release -p sinew-estimate --test all real_absolute:: -- --nocapture` prints the
//! table of docs/src/validation.md.

use crate::support;

use sinew_estimate::Request;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::feeder::Injection;
use sinew_estimate::session;
use sinew_estimate::session::{Payload, SessionEstimate, SessionOptions, Window};
use sinew_log::Mapping;
use std::path::Path;
use support::{repository, shared};

const JOINTS: usize = 7;
const MIDDLE_S: f64 = 12.5;
const FIRST: Window = Window {
    from_s: 0.0,
    to_s: MIDDLE_S,
};
const SECOND: Window = Window {
    from_s: MIDDLE_S,
    to_s: f64::INFINITY,
};

/// Arm described with stiffness `described` and tolerance `zero_mrad`; the true stiffness is `k_nm_per_rad`.
struct Arm {
    request: Request,
    _folder: tempfile::TempDir,
}

impl Arm {
    fn new(shared: &Path, k_nm_per_rad: f64, described: f64, zero_mrad: f64) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let robot =
            std::fs::read_to_string(repository().join("examples/03-real-arm/robot.toml")).unwrap();
        let stated = "stiffness_nm_per_rad = 200.0";
        assert_eq!(robot.matches(stated).count(), JOINTS);
        let robot = robot.replace(stated, &format!("stiffness_nm_per_rad = {described:?}"));
        let zero = "zero_mrad = 30.0";
        assert_eq!(robot.matches(zero).count(), 1);
        let robot = robot.replace(zero, &format!("zero_mrad = {zero_mrad:?}"));
        std::fs::write(folder.path().join("robot.toml"), robot).unwrap();
        let urdf = "kuka_lwr4_identified.urdf";
        std::fs::copy(shared.join("models").join(urdf), folder.path().join(urdf)).unwrap();
        let place = repository().join("examples/mappings/lwr4.toml");
        let mapping = std::fs::read_to_string(&place).unwrap();
        let scale = "scale = 0.005 }";
        assert_eq!(mapping.matches(scale).count(), JOINTS);
        let mapping = mapping.replace(scale, &format!("scale = {:?} }}", 1.0 / k_nm_per_rad));
        let log = shared.join("data/lwr4_flobaroid/lwr4_hw_measurements_1.csv");
        let mut request = Request::new(log);
        request.open.mapping =
            Some(Mapping::from_toml(&mapping, &place.display().to_string()).unwrap());
        request.robot = Some(folder.path().to_path_buf());
        Self {
            request,
            _folder: folder,
        }
    }

    fn learn(&mut self, part: Window) -> Baseline {
        self.request.injections.clear();
        let (baseline, estimate) = session::learn(
            &self.request,
            part,
            &session::Learning::default(),
            &mut |_| {},
        )
        .unwrap();
        // All joints move all the time.
        assert!(
            estimate.poses > 15 && estimate.rejected_share < 0.05,
            "{estimate:?}"
        );
        baseline
    }

    /// Estimates a part with these added offsets, mrad.
    fn watch(
        &mut self,
        part: Window,
        baseline: &Baseline,
        offsets_mrad: [f64; JOINTS],
    ) -> SessionEstimate {
        let added = offsets_mrad.iter().enumerate().map(|(i, mrad)| Injection {
            joint: format!("lwr_{i}_joint"),
            offset_rad: 1e-3 * mrad,
            from_s: None,
        });
        self.request.injections = added.collect();
        let options = SessionOptions {
            payload: Payload::Empty,
            ..SessionOptions::default()
        };
        let with = Some((baseline, "baseline"));
        let (estimate, _) =
            session::estimate(&self.request, part, with, &options, &mut |_| {}).unwrap();
        assert_eq!(estimate.joints.len(), JOINTS);
        estimate
    }
}

/// Added offsets in the second half, mrad.
const ADDED: [[f64; JOINTS]; 6] = [
    [10.0; JOINTS],
    [2.0, -4.0, 6.0, -8.0, 10.0, -12.0, 14.0],
    [0.0; JOINTS],
    [-10.0; JOINTS],
    [0.0, 15.0, 0.0, 15.0, 0.0, 0.0, 0.0],
    [5.0, -5.0, 5.0, -5.0, 5.0, -5.0, 5.0],
];

/// Whether `SINEW_LONG` is set: every case, and both orders of the halves.
fn long() -> bool {
    std::env::var_os("SINEW_LONG").is_some()
}

#[test]
fn added_offsets_lie_inside_their_interval() {
    let Some(shared) = shared("data").map(|data| data.join("..")) else {
        return;
    };
    let added = if long() { &ADDED[..] } else { &ADDED[..2] };
    let (mut inside, mut all) = (0, 0);
    let halves = [
        (FIRST, SECOND, "baseline from the first half"),
        (SECOND, FIRST, "in the second"),
    ];
    for (learn, watch, name) in halves.into_iter().take(if long() { 2 } else { 1 }) {
        println!("{name}: RMSE (mean half interval) in mrad, joints 1 to 7; inside");
        for (k, described) in [
            (100.0, 100.0),
            (200.0, 200.0),
            (400.0, 400.0),
            (800.0, 800.0),
            (200.0, 180.0),
            (200.0, 220.0),
        ] {
            let mut arm = Arm::new(&shared, k, described, 30.0);
            let baseline = arm.learn(learn);
            let (mut squares, mut widths) = ([0.0; JOINTS], [0.0; JOINTS]);
            let mut held = 0;
            for offsets in added {
                let estimate = arm.watch(watch, &baseline, *offsets);
                for (i, joint) in estimate.joints.iter().enumerate() {
                    let error = 1e3 * joint.offset_rad.mean - offsets[i];
                    squares[i] += error * error / added.len() as f64;
                    widths[i] += 1e3 * joint.offset_rad.half_width_95() / added.len() as f64;
                    held += usize::from(error.abs() < 1e3 * joint.offset_rad.half_width_95());
                    let useless = 1e3 * joint.offset_rad.half_width_95() > 5.0;
                    assert_eq!(
                        useless,
                        joint.verdict == session::Verdict::Inconclusive,
                        "{joint:?}"
                    );
                    assert!(joint.changes.is_empty(), "{:?}", joint.changes);
                }
            }
            print!("K {k}, described {described}:");
            for (square, width) in squares.iter().zip(widths) {
                print!(" {:.2} ({width:.2})", square.sqrt());
            }
            println!("; {held} of {}", JOINTS * added.len());
            // The unexplained residual of joint 5 does not affect the others.
            let others = || (widths.iter().enumerate()).filter(|(i, _)| *i != 4);
            assert!(others().all(|(_, w)| *w < 600.0 / k + 1.5), "{widths:?}");
            inside += held;
            all += JOINTS * added.len();
        }
    }
    println!("{inside} of {all} inside");
    assert!(20 * inside >= 19 * all, "{inside} of {all}");
}

#[test]
fn wrong_encoder_zero_is_reported_and_estimated() {
    let Some(shared) = shared("data").map(|data| data.join("..")) else {
        return;
    };
    // The zero offsets of the torque sensors act as encoder zero offsets: up to 10 mrad, with none specified in
    // robot.toml.
    let mut arm = Arm::new(&shared, 200.0, 200.0, 0.0);
    let baseline = arm.learn(FIRST);
    let estimate = arm.watch(SECOND, &baseline, [0.0; JOINTS]);
    let (_, learned) = session::learn(
        &arm.request,
        FIRST,
        &session::Learning::default(),
        &mut |_| {},
    )
    .unwrap();
    let named = learned.warnings.iter().filter_map(|w| match w {
        session::Warning::EncoderZeroOffset { joint, zero_rad } => {
            Some((joint.as_str(), *zero_rad))
        }
        _ => None,
    });
    let named: Vec<_> = named.collect();
    // The mean of the torque sensor of joint 1, whose axis is upright, is 0.9 N·m: 4.5 mrad of a spring of 200.
    let first = named.iter().find(|(joint, _)| *joint == "lwr_0_joint");
    let (_, zero_rad) = first.unwrap_or_else(|| panic!("{:?}", learned.warnings));
    assert!((1e3 * zero_rad.mean.abs() - 4.5).abs() < 1.0, "{named:?}");
    // Without added offsets the truth is zero. A specified unknown zero offset gives the same result.
    let mut stated = Arm::new(&shared, 200.0, 200.0, 30.0);
    let baseline = stated.learn(FIRST);
    let with_stated = stated.watch(SECOND, &baseline, [0.0; JOINTS]);
    for (joint, same) in estimate.joints.iter().zip(&with_stated.joints) {
        let offset = joint.offset_rad;
        assert!(!offset.is_nonzero_95(), "{}: {offset:?}", joint.name);
        let apart = (offset.mean - same.offset_rad.mean).abs();
        assert!(apart < 0.5 * offset.std, "{joint:?} {same:?}");
    }
}
