//! Results through C are bitwise identical to those of the libraries.

use crate::support::{N, Opened, Why, biorob_like, recorded, repository, text};
use sinew_c::momentum::{sinew_arm_free, sinew_arm_momentum, sinew_arm_new};
use sinew_c::observer::*;
use sinew_c::offsets::*;
use sinew_c::robot::*;
use sinew_c::status::Status;
use sinew_estimate::online::{OnlineEstimator, Provisional, StepOutcome};
use sinew_estimate::session::SessionOptions;
use sinew_log::Frame;
use sinew_model::arm::ArmWorkspace;
use sinew_model::offset::{OffsetConfig, OffsetObserver, Sample, VelocityFilter};
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};

/// Time since the previous sample, s.
fn step_s(frames: &[Frame], at: usize) -> f64 {
    let before = frames[at.saturating_sub(1)].time_ns;
    (frames[at].time_ns - before) as f64 * 1e-9
}

#[test]
fn robot_equals_library() {
    let known = biorob_like();
    let opened = Opened::biorob_like();
    let folder = repository().join("robots/biorob-like");
    let read = |name: &str| text(&std::fs::read_to_string(folder.join(name)).unwrap());
    let (toml, urdf) = (read("robot.toml"), read("biorob-like.urdf"));
    let mut of_texts = null_mut();
    // SAFETY: texts, a place and handles that are there.
    unsafe {
        let made = sinew_robot_new(toml.as_ptr(), urdf.as_ptr(), &mut of_texts, null_mut(), 0);
        assert_eq!(made, Status::Ok);
        for robot in [opened.0, of_texts] {
            assert_eq!(sinew_robot_joints(robot), N);
            for (i, name) in known.joint_names().iter().enumerate() {
                let name_of = CStr::from_ptr(sinew_robot_joint_name(robot, i));
                assert_eq!(name_of.to_str().unwrap(), name);
                let mut index = 99;
                let asked = sinew_robot_joint_index(robot, name_of.as_ptr(), &mut index);
                assert_eq!((asked, index), (Status::Ok, i));
                let tendon = known.transmissions[i].as_ref().unwrap().tendon.as_ref();
                let elongation_m = sinew_robot_elongation_m(robot, i, 0.01);
                assert_eq!(elongation_m, tendon.unwrap().elongation_m(0.01));
                assert!(sinew_robot_is_elastic(robot, i));
            }
        }
        sinew_robot_free(of_texts);
    }
}

#[test]
fn joint_without_transmission_is_rigid() {
    let folder = repository().join("robots/biorob-like");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let all = read("robot.toml");
    let (before, rest) = all.split_once("[joints.wrist]").unwrap();
    let (_, after) = rest.split_once("[tolerances]").unwrap();
    let toml = text(&format!(
        "{before}[joints.wrist]\nrigid = true\n[tolerances]{after}"
    ));
    let urdf = text(&read("biorob-like.urdf"));
    let (mut robot, mut reason) = (null_mut(), Why::new());
    // SAFETY: texts, a place, room, a handle that is there.
    unsafe {
        let made = sinew_robot_new(
            toml.as_ptr(),
            urdf.as_ptr(),
            &mut robot,
            reason.at(),
            reason.room(),
        );
        assert_eq!(made, Status::Ok, "{}", reason.text());
        let elastic: Vec<bool> = (0..N).map(|i| sinew_robot_is_elastic(robot, i)).collect();
        assert_eq!(elastic, [true, true, true, false]);
        assert!(sinew_robot_elongation_m(robot, 3, 0.01).is_nan());
        sinew_robot_free(robot);
    }
}

/// Bits of the values, because NaN does not equal itself.
fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Creates the offsets of the arm.
fn made(robot: &Opened, baseline: *const c_char) -> *mut SinewOffsets {
    let mut offsets = null_mut();
    let mut reason = Why::new();
    // SAFETY: a robot, a text or null, places.
    let status = unsafe {
        sinew_offsets_new(
            robot.0,
            baseline,
            null(),
            &mut offsets,
            reason.at(),
            reason.room(),
        )
    };
    assert_eq!(status, Status::Ok, "{}", reason.text());
    offsets
}

/// Adds a sample.
///
/// # Safety
/// `offsets` are not used concurrently.
unsafe fn stepped(offsets: *mut SinewOffsets, frames: &[Frame], at: usize) -> SinewStepped {
    let (frame, dt_s) = (&frames[at], step_s(frames, at));
    let mut became = SinewStepped::OutOfRange;
    let (q, theta, tau_m) = (&frame.q, &frame.theta, &frame.tau_m);
    // SAFETY: arrays of four numbers.
    let status = unsafe {
        sinew_offsets_step(
            offsets,
            dt_s,
            q.as_ptr(),
            theta.as_ptr(),
            tau_m.as_ptr(),
            frame.temperature_c,
            N,
            &mut became,
        )
    };
    assert_eq!(status, Status::Ok, "frame {at}");
    became
}

/// Reads the latest answer.
///
/// # Safety
/// `offsets` are not used concurrently.
unsafe fn read(offsets: *mut SinewOffsets) -> (SinewAnswer, [SinewOffset; N]) {
    let mut answer = MaybeUninit::uninit();
    let mut of_joints = MaybeUninit::<[SinewOffset; N]>::uninit();
    // SAFETY: handles and places, which are written where the status is OK.
    unsafe {
        let read = sinew_offsets_read(
            offsets,
            answer.as_mut_ptr(),
            of_joints.as_mut_ptr().cast(),
            N,
        );
        assert_eq!(read, Status::Ok);
        (answer.assume_init(), of_joints.assume_init())
    }
}

/// Compares an answer with that of the library.
fn compare((answer, of_joints): &(SinewAnswer, [SinewOffset; N]), rust: &mut OnlineEstimator) {
    let (behind, dropped) = (rust.blocks_behind(), rust.blocks_dropped());
    let known = rust.answer();
    assert_eq!(
        [answer.blocks, answer.blocks_behind, answer.blocks_dropped],
        [known.blocks, behind, dropped]
    );
    assert_eq!(
        bits(&[answer.time_s, answer.solved_s, answer.contact_probability]),
        bits(&[known.time_s, known.solved_s, known.contact_probability])
    );
    match &known.external_force {
        Some(force) => {
            assert_eq!(answer.external_force_probability, force.probability);
            let [mean, std] = [force.force_n.map(|n| n.mean), force.force_n.map(|n| n.std)];
            assert_eq!(answer.external_force_n, mean);
            assert_eq!(answer.external_force_std_n, std);
        }
        None => assert!(
            answer.external_force_probability.is_nan() && answer.external_force_n[2].is_nan()
        ),
    }
    for own in &known.joints {
        let of = &of_joints[own.joint];
        let changed = own.stiffness_changed_probability.unwrap_or(f64::NAN);
        assert_eq!(
            bits(&[
                of.offset_rad,
                of.offset_std_rad,
                of.unknown_temperature_rad,
                of.stiffness_changed_probability
            ]),
            bits(&[
                own.offset_rad.mean,
                own.offset_rad.std,
                own.unknown_temperature_rad,
                changed
            ])
        );
        let nan = f64::NAN;
        let (provisional, since) = match own.provisional {
            None => (SinewProvisional::None, [nan; 2]),
            Some(Provisional::Starting) => (SinewProvisional::Starting, [nan; 2]),
            Some(Provisional::Step {
                since_s,
                probability,
            }) => (SinewProvisional::Step, [since_s, probability]),
            Some(Provisional::ChangeNearEnd { since_s }) => {
                (SinewProvisional::ChangeNearEnd, [since_s, nan])
            }
            Some(Provisional::Rejected { .. }) => (SinewProvisional::Rejected, [nan; 2]),
            Some(Provisional::NotSolved) => (SinewProvisional::NotSolved, [nan; 2]),
        };
        assert_eq!(of.provisional, provisional);
        assert_eq!(bits(&[of.since_s, of.step_probability]), bits(&since));
    }
}

#[test]
fn offsets_and_saved_baseline_equal_library() {
    let known = biorob_like();
    let (frames, baseline) = recorded(&known);
    let saved = text(&baseline.to_text());
    let baseline = Some((baseline, "baseline".into()));
    let mut rust =
        OnlineEstimator::new(known, baseline, &SessionOptions::default(), "session").unwrap();
    let robot = Opened::biorob_like();
    let offsets = made(&robot, saved.as_ptr());
    // The offsets remain valid without the robot.
    drop(robot);
    // SAFETY: a handle.
    compare(&unsafe { read(offsets) }, &mut rust);
    let (mut blocks, mut reasons) = (0, Vec::new());
    for (i, frame) in frames.iter().enumerate() {
        let (q, theta, tau_m) = (&frame.q, &frame.theta, &frame.tau_m);
        let outcome = rust
            .step(step_s(&frames, i), q, theta, tau_m, frame.temperature_c)
            .unwrap();
        // SAFETY: a handle.
        let became = unsafe { stepped(offsets, &frames, i) };
        let as_c = match outcome {
            StepOutcome::Accepted => SinewStepped::Accepted,
            StepOutcome::Restarted => SinewStepped::Restarted,
            StepOutcome::Block => SinewStepped::Block,
            StepOutcome::Rejected(reason) => panic!("{reason:?}"),
        };
        assert_eq!(became, as_c, "frame {i}");
        if outcome == StepOutcome::Block {
            rust.work();
            // SAFETY: a handle.
            let now = unsafe {
                assert_eq!(sinew_offsets_work(offsets), Status::Ok);
                read(offsets)
            };
            compare(&now, &mut rust);
            blocks += 1;
            let reason = now.1[0].provisional;
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
    }
    assert!(blocks > 100 && reasons.len() > 1, "{blocks} {reasons:?}");
    let end_ns = frames.last().unwrap().time_ns;
    let next = rust.save("run", end_ns).unwrap().to_text();
    let mut length = 0;
    let mut written = vec![1_u8; 1 << 20];
    // SAFETY: room as stated.
    unsafe {
        let name = c"run".as_ptr();
        let asked = sinew_offsets_save(offsets, name, end_ns, null_mut(), 0, &mut length);
        assert_eq!((asked, length), (Status::Short, next.len() + 1));
        let short = written.as_mut_ptr().cast();
        let asked = sinew_offsets_save(offsets, name, end_ns, short, length - 1, null_mut());
        assert_eq!(
            (asked, written[0]),
            (Status::Short, 1),
            "nothing half written"
        );
        let into = written.as_mut_ptr().cast();
        let done = sinew_offsets_save(offsets, name, end_ns, into, length, null_mut());
        assert_eq!(done, Status::Ok);
        sinew_offsets_free(offsets);
    }
    let text = CStr::from_bytes_until_nul(&written).unwrap();
    assert_eq!(text.to_str().unwrap(), next);
}

/// Handle that is sent to another thread.
struct Sent(*mut SinewWorker);
// SAFETY: a worker may be used by any thread, one at a time.
unsafe impl Send for Sent {}

#[test]
fn worker_thread_is_bitwise_identical() {
    let (mut frames, baseline) = recorded(&biorob_like());
    frames.truncate(10_000);
    let baseline = text(&baseline.to_text());
    let robot = Opened::biorob_like();
    let [alone, beside, started] = [0; 3].map(|_| made(&robot, baseline.as_ptr()));
    let mut worker = null_mut();
    // SAFETY: handles and a place.
    unsafe {
        assert_eq!(
            sinew_offsets_take_worker(beside, null_mut()),
            Status::Null,
            "it is not taken"
        );
        assert_eq!(sinew_offsets_take_worker(beside, &mut worker), Status::Ok);
        assert_eq!(sinew_offsets_start_worker(started), Status::Ok);
        for offsets in [beside, started] {
            let mut again = null_mut();
            let taken = sinew_offsets_take_worker(offsets, &mut again);
            assert_eq!((taken, again), (Status::WorkerTaken, null_mut()));
            assert_eq!(sinew_offsets_start_worker(offsets), Status::WorkerTaken);
            assert_eq!(sinew_offsets_work(offsets), Status::WorkerTaken);
        }
    }
    let ends = AtomicBool::new(false);
    let sent = Sent(worker);
    std::thread::scope(|scope| {
        let ends = &ends;
        scope.spawn(move || {
            let worker = { sent }.0;
            while !ends.load(Ordering::Acquire) {
                // SAFETY: this thread's alone.
                let worked = unsafe { sinew_worker_work(worker) };
                assert_eq!(worked, Status::Ok);
                std::thread::yield_now();
            }
        });
        for at in 0..frames.len() {
            // SAFETY: this thread's alone.
            unsafe {
                let became = stepped(alone, &frames, at);
                for offsets in [beside, started] {
                    assert_eq!(stepped(offsets, &frames, at), became);
                }
                if became != SinewStepped::Block {
                    continue;
                }
                assert_eq!(sinew_offsets_work(alone), Status::Ok);
                // The test waits for the answers once per second; in between they may be late. Of more than eight blocks
                // the loop passes the last ones together with a later block.
                if !read(alone).0.blocks.is_multiple_of(5) {
                    continue;
                }
                let known = format!("{:?}", read(alone));
                for offsets in [beside, started] {
                    while read(offsets).0.blocks_behind > 0 {
                        std::thread::yield_now();
                    }
                    assert_eq!(format!("{:?}", read(offsets)), known);
                }
            }
        }
        ends.store(true, Ordering::Release);
    });
    // A worker may be freed before or after its offsets.
    // SAFETY: each is freed once.
    unsafe {
        sinew_offsets_free(beside);
        assert_eq!(sinew_worker_work(worker), Status::Ok);
        sinew_worker_free(worker);
        assert_eq!(sinew_offsets_take_worker(alone, &mut worker), Status::Ok);
        sinew_worker_free(worker);
        // The last position again: an earlier one is not reachable within a sample period.
        stepped(alone, &frames, frames.len() - 1);
        sinew_offsets_free(alone);
        sinew_offsets_free(started);
    }
}

#[test]
fn observer_and_momentum_equal_model() {
    let known = biorob_like();
    let (frames, _) = recorded(&known);
    let velocity = VelocityFilter::StateVariable {
        cutoff_rad_per_s: 40.0,
    };
    let config = OffsetConfig {
        gain_per_s: 20.0,
        velocity,
        ..OffsetConfig::default()
    };
    let mut rust = OffsetObserver::new(&known.arm, &known.transmissions, config).unwrap();
    let robot = Opened::biorob_like();
    let mut observer = null_mut();
    // SAFETY: handles and arrays of four numbers.
    unsafe {
        let made = sinew_observer_new(robot.0, 20.0, 40.0, &mut observer, null_mut(), 0);
        assert_eq!(made, Status::Ok);
        for (i, frame) in frames[..5000].iter().enumerate() {
            let dt_s = if i == 0 { f64::NAN } else { step_s(&frames, i) };
            let sample = Sample {
                q: &frame.q,
                theta_measured: &frame.theta,
                ..Sample::default()
            };
            let stepped = rust.step(dt_s, &sample);
            let (q, theta) = (frame.q.as_ptr(), frame.theta.as_ptr());
            let status = sinew_observer_step(observer, dt_s, q, theta, null(), N);
            assert_eq!(status, stepped.map_or_else(Status::from, |()| Status::Ok));
        }
        let (mut delta_e, mut tau_el) = ([0.0; N], [0.0; N]);
        assert_eq!(
            sinew_observer_delta_e(observer, delta_e.as_mut_ptr(), N),
            Status::Ok
        );
        assert_eq!(
            sinew_observer_tau_el(observer, tau_el.as_mut_ptr(), N),
            Status::Ok
        );
        assert_eq!(delta_e, rust.delta_e());
        assert_eq!(tau_el, rust.tau_el());
        assert!(sinew_observer_is_settled(observer) && rust.is_settled());
        assert_eq!(sinew_observer_reset(observer), Status::Ok);
        assert!(!sinew_observer_is_settled(observer));
        sinew_observer_free(observer);

        let mut arm = null_mut();
        assert_eq!(sinew_arm_new(robot.0, &mut arm, null_mut(), 0), Status::Ok);
        let (q, dq) = ([0.3, -0.7, 1.1, 0.2], [1.0, -2.0, 0.5, 3.0]);
        let [mut p, mut ct_dq, mut g] = [[0.0; N]; 3];
        let (at_p, at_ct, at_g) = (p.as_mut_ptr(), ct_dq.as_mut_ptr(), g.as_mut_ptr());
        let status = sinew_arm_momentum(arm, q.as_ptr(), dq.as_ptr(), at_p, at_ct, at_g, N);
        assert_eq!(status, Status::Ok);
        let mut workspace = ArmWorkspace::new(&known.arm);
        let terms = known.arm.momentum(&mut workspace, &q, &dq).unwrap();
        assert_eq!(
            (&p[..], &ct_dq[..], &g[..]),
            (terms.p, terms.ct_dq, terms.g)
        );
        sinew_arm_free(arm);
    }
}
