//! Steps allocate nothing after construction: counted, over many steps of every kind.
//!
//! A binary of its own: the counting allocator would be that of every other test too, and counts by
//! thread, so that nothing else may run in the thread of a test.

// A global allocator is an unsafe trait; this one only counts and forwards to the system's.
#![allow(unsafe_code)]

use sinew_model::Gaussian;
use sinew_model::StepError;
use sinew_model::arm::{Arm, ArmWorkspace, urdf};
use sinew_model::correction::{
    ContactConfig, ContactDetector, ContactTolerances, ExternalTorqueConfig,
    ExternalTorqueObserver, JointCorrection, SetPoint,
};
use sinew_model::observer::MomentumObserver;
use sinew_model::offset::{
    Comparison, FeatureConfig, FeatureObserver, OffsetConfig, OffsetObserver, Sample, TorqueSource,
    VelocityFilter,
};
use sinew_model::tendons::{Coupling, CouplingDescription, CouplingState, Input, Output};
use sinew_model::transmission::Transmission;
#[path = "support/routed.rs"]
mod routed;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    /// Allocations of this thread: tests run side by side.
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

fn count_one() {
    // Threads that are terminating have no counter any more; theirs is not needed.
    let _ = COUNT.try_with(|c| c.set(c.get() + 1));
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_one();
        // SAFETY: the caller's promise is passed to the system allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // Freeing takes the same lock as allocating: not in a step either.
        count_one();
        // SAFETY: as above.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count_one();
        // SAFETY: as above.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocator calls made by `f`.
fn allocations(f: impl FnOnce()) -> u64 {
    let before = COUNT.get();
    f();
    COUNT.get() - before
}

const STEPS: usize = 200;

fn arm() -> Arm {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/reference/models/branching9.urdf"
    );
    let text = std::fs::read_to_string(path).unwrap();
    urdf::parse(&text, &urdf::UrdfOptions::default())
        .unwrap()
        .arm
}

/// A smooth motion, filled into the caller's storage.
fn motion(k: usize, q: &mut [f64], dq: &mut [f64]) {
    for (i, (q, dq)) in q.iter_mut().zip(dq).enumerate() {
        let (rate, t) = (1.0 + 0.3 * i as f64, 1e-3 * k as f64);
        *q = 0.2 * (rate * t).sin();
        *dq = 0.2 * rate * (rate * t).cos();
    }
}

#[test]
fn allocation_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1.0; 100]))) >= 2);
}

#[test]
fn dynamics_allocate_nothing() {
    let arm = arm();
    let n = arm.dof();
    let mut ws = ArmWorkspace::new(&arm);
    let (mut q, mut dq, ddq) = (vec![0.0; n], vec![0.0; n], vec![0.3; n]);
    let mut out = vec![0.0; n];
    let count = allocations(|| {
        for k in 0..STEPS {
            motion(k, &mut q, &mut dq);
            arm.momentum(&mut ws, &q, &dq).unwrap();
            arm.mass_matrix(&mut ws, &q).unwrap();
            arm.bias_torque(&mut ws, &q, &dq).unwrap();
            let tau = arm.inverse_dynamics(&mut ws, &q, &dq, &ddq).unwrap();
            out.copy_from_slice(tau);
            let tau = out.as_slice();
            let mut acceleration = [0.0; 9];
            arm.forward_dynamics(&mut ws, &q, &dq, tau, &mut acceleration)
                .unwrap();
            arm.kinetic_energy(&mut ws, &q, &dq).unwrap();
            arm.potential_energy(&mut ws, &q).unwrap();
            arm.link_pose(&mut ws, &q, "left_tip").unwrap();
            let force = [1.0, 2.0, 3.0];
            arm.add_point_force(&mut ws, &q, "left_tip", [0.0; 3], force, &mut out)
                .unwrap();
        }
    });
    assert_eq!(count, 0, "{STEPS} steps made {count} allocator calls");
}

#[test]
fn observer_allocates_nothing() {
    let arm = arm();
    let n = arm.dof();
    let mut ws = ArmWorkspace::new(&arm);
    let mut observer = MomentumObserver::new(&vec![20.0; n]).unwrap();
    let (mut q, mut dq, mut alpha) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let tau_ext = vec![0.5; n];
    let count = allocations(|| {
        for k in 0..STEPS {
            motion(k, &mut q, &mut dq);
            let terms = arm.momentum(&mut ws, &q, &dq).unwrap();
            for (alpha, (c, g)) in alpha.iter_mut().zip(terms.ct_dq.iter().zip(terms.g)) {
                *alpha = c - g;
            }
            // Every third step is longer: the weights of the pole are recomputed.
            let dt = if k % 3 == 0 { 2e-3 } else { 1e-3 };
            observer.step(dt, terms.p, &alpha, Some(&tau_ext)).unwrap();
            if k == STEPS / 2 {
                observer.set_gain(0, 50.0).unwrap();
            }
            if k == STEPS * 3 / 4 {
                observer.reset();
            }
        }
    });
    assert_eq!(count, 0, "{STEPS} steps made {count} allocator calls");
}

#[test]
fn offset_steps_allocate_nothing_with_any_source() {
    let arm = arm();
    let n = arm.dof();
    let mut spring = Transmission::spring(40.0);
    spring.motor_inertia_kg_m2 = Some(0.1);
    let mut transmissions = vec![Some(spring); n];
    transmissions[1] = None;
    let (mut q, mut dq) = (vec![0.0; n], vec![0.0; n]);
    let (theta, torque, broken) = (vec![0.05; n], vec![0.4; n], vec![f64::NAN; n]);
    let filter = VelocityFilter::StateVariable {
        cutoff_rad_per_s: 40.0,
    };
    for (source, comparison, velocity) in [
        (TorqueSource::Observer, Comparison::Matched, filter),
        (TorqueSource::Observer, Comparison::Paper, filter),
        (
            TorqueSource::Observer,
            Comparison::Matched,
            VelocityFilter::Recorded,
        ),
        (TorqueSource::TorqueSensor, Comparison::Matched, filter),
        (TorqueSource::Motor, Comparison::Matched, filter),
    ] {
        let config = OffsetConfig {
            source,
            comparison,
            velocity,
            ..Default::default()
        };
        let mut offset = OffsetObserver::new(&arm, &transmissions, config).unwrap();
        let mut refused = 0;
        let count = allocations(|| {
            for k in 0..STEPS {
                motion(k, &mut q, &mut dq);
                let good = Sample {
                    q: &q,
                    theta_measured: &theta,
                    dq: Some(&dq),
                    tau_el: Some(&torque),
                    tau_m: Some(&torque),
                    tau_ext: Some(&torque),
                };
                offset.step(1e-3, &good).unwrap();
                // Refusing is part of a step's life.
                let bad = Sample { q: &broken, ..good };
                if offset.step(1e-3, &bad) == Err(StepError::NotFinite) {
                    refused += 1;
                }
            }
        });
        assert_eq!(refused, STEPS);
        assert_eq!(
            count, 0,
            "{source:?}, {comparison:?}: {count} allocator calls"
        );
    }
}

/// Springs, and the same with tendons that run over the joint before their own.
fn transmissions(n: usize) -> [Vec<Option<Transmission>>; 2] {
    [vec![Some(Transmission::spring(40.0)); n], routed::routed(n)]
}

#[test]
fn features_allocate_nothing() {
    for transmissions in transmissions(arm().dof()) {
        features_allocate_nothing_with(&transmissions);
    }
    features_allocate_nothing_with(&routed::antagonists(arm().dof()));
}

fn features_allocate_nothing_with(transmissions: &[Option<Transmission>]) {
    let arm = arm();
    let (n, dof) = (transmissions.len(), arm.dof());
    let mut features =
        FeatureObserver::new(&arm, FeatureConfig::default()).with_transmissions(transmissions);
    let (mut q, mut dq) = (vec![0.0; n], vec![0.0; n]);
    let (theta, torque, broken) = (vec![0.05; n], vec![0.4; n], vec![f64::NAN; n]);
    let tension = vec![20.0; n];
    let mut block = features.block().clone();
    let mut blocks = 0;
    let count = allocations(|| {
        for k in 0..40 * STEPS {
            motion(k, &mut q[..dof], &mut dq);
            let positions = [&q[..], &theta];
            let torques = [&torque[..], &tension];
            if features.step_with_tension(1e-3, positions, torques, 20.0) == Ok(true) {
                block.copy_from(features.block());
                blocks += 1;
            }
            assert!(features.step(1e-3, &broken, &theta, &torque, 20.0).is_err());
        }
    });
    assert!(blocks > 20, "{blocks}");
    assert_eq!(count, 0, "{blocks} blocks made {count} allocator calls");
}

#[test]
fn corrections_and_contacts_allocate_nothing() {
    for mut transmissions in transmissions(arm().dof()) {
        transmissions[1] = None;
        corrections_and_contacts_allocate_nothing_with(&transmissions);
    }
}

fn corrections_and_contacts_allocate_nothing_with(transmissions: &[Option<Transmission>]) {
    let arm = arm();
    let n = arm.dof();
    let none = vec![JointCorrection::default(); n];
    let tolerances = ContactTolerances::new(vec![0.01; n]);
    let config = ExternalTorqueConfig::default();
    let mut observer =
        ExternalTorqueObserver::new(&arm, transmissions, &none, config, tolerances).unwrap();
    let mut detector = ContactDetector::new(n, ContactConfig::default()).unwrap();
    let mut set_point = SetPoint::new(&arm, transmissions, &none).unwrap();
    let (mut q, mut dq, ddq) = (vec![0.0; n], vec![0.0; n], vec![0.3; n]);
    let (push, broken) = (vec![0.5; n], vec![f64::NAN; n]);
    let mut theta = vec![0.0; n];
    let count = allocations(|| {
        for k in 0..STEPS {
            motion(k, &mut q, &mut dq);
            // The offset is followed while the robot runs.
            let stretched = JointCorrection::offset(Gaussian::new(1e-5 * k as f64, 1e-4));
            set_point.set(0, &stretched).unwrap();
            observer.set(0, &stretched).unwrap();
            set_point.hold(&q, Some(&push)).unwrap();
            let set = set_point.follow(&q, &dq, &ddq, None).unwrap();
            theta.copy_from_slice(set);
            assert_eq!(
                observer.step(1e-3, &q, &broken, None),
                Err(StepError::NotFinite)
            );
            observer.step(1e-3, &q, &theta, None).unwrap();
            detector
                .step(1e-3, observer.tau_ext(), observer.threshold())
                .unwrap();
        }
    });
    assert_eq!(count, 0, "{STEPS} steps made {count} allocator calls");
}

#[test]
fn tendons_allocate_nothing() {
    let names = ["a", "b", "c"].map(String::from);
    let springs = vec![Some(Transmission::spring(40.0)); 3];
    let description = CouplingDescription::diagonal(&names, &springs).unwrap();
    let coupling = Coupling::new(description).unwrap();
    let mut state = CouplingState::new(&coupling);
    let (mut q, mut dq, mut out) = ([0.0; 3], [0.0; 3], [0.0; 9]);
    let (theta, broken) = ([0.05; 3], [f64::NAN; 3]);
    let count = allocations(|| {
        for k in 0..STEPS {
            motion(k, &mut q, &mut dq);
            coupling
                .evaluate(&mut state, &theta, &q, &[1e-3; 3])
                .unwrap();
            assert!(coupling.evaluate(&mut state, &theta, &broken, &q).is_err());
            let (output, input) = (Output::MotorTorque, Input::JointPosition);
            coupling.jacobian(&state, output, input, &mut out).unwrap();
            coupling.joint_stiffness(&state, &mut out).unwrap();
            assert_eq!(coupling.extrapolated(&q).count(), 0);
        }
    });
    assert_eq!(out[0], 40.0);
    assert_eq!(count, 0, "{STEPS} steps made {count} allocator calls");
}

#[cfg(feature = "wire")]
#[test]
fn microcontroller_step_does_not_allocate() {
    for transmissions in transmissions(arm().dof()) {
        a_microcontroller_allocates_nothing_with(&transmissions);
    }
}

#[cfg(feature = "wire")]
fn a_microcontroller_allocates_nothing_with(transmissions: &[Option<Transmission>]) {
    use sinew_model::feeder::{Feeder, FeederOptions, RobotSample};
    use sinew_model::wire::BlockSender;

    let arm = arm();
    let n = arm.dof();
    let config = FeatureConfig::default();
    let options = FeederOptions::default();
    let observer = OffsetObserver::new(&arm, transmissions, OffsetConfig::default()).unwrap();
    let mut offset = Feeder::new(observer, transmissions, options);
    let features = FeatureObserver::new(&arm, config).with_transmissions(transmissions);
    let mut sender = BlockSender::new(&features);
    let mut features = Feeder::new(features, transmissions, options);
    let (mut q, mut dq) = (vec![0.0; n], vec![0.0; n]);
    let (theta, torque) = (vec![0.05; n], vec![0.4; n]);
    let (mut blocks, mut refused) = (0, 0);
    let count = allocations(|| {
        for k in 0..40 * STEPS {
            motion(k, &mut q, &mut dq);
            if k % 7 == 0 {
                q[0] = f64::NAN;
            }
            let reading = RobotSample {
                time_ns: 1_000_000 * k as i64,
                segment: 0,
                q: &q,
                theta: &theta,
                dq: &[],
                tau_el: &[],
                tau_m: &torque,
                tau_ext: &[],
                tension: &[],
                temperature_c: 20.0,
            };
            refused += usize::from(offset.take(&reading).output().is_none());
            // A line that takes 12 bytes a sample: some blocks find the one before unsent.
            sender.sent(12.min(sender.pending().len()));
            if features.take(&reading).output() == Some(true) {
                blocks += usize::from(sender.put(features.observer().block()).unwrap());
            }
        }
    });
    assert!(blocks > 10 && sender.skipped() > 0, "{blocks}");
    assert_eq!(refused, (40 * STEPS).div_ceil(7));
    assert_eq!(count, 0, "{count} allocator calls");
}
