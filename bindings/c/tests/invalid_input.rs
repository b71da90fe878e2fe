//! Invalid input returns a status, and nothing is written beyond the end of a buffer.

use crate::support::{N, Opened, Why, biorob_like, recorded, text};
use sinew_c::momentum::{sinew_arm_free, sinew_arm_momentum, sinew_arm_new};
use sinew_c::observer::*;
use sinew_c::offsets::*;
use sinew_c::robot::*;
use sinew_c::status::{
    SINEW_ABI_VERSION, Status, sinew_abi_version, sinew_status_text, sinew_version,
};
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

#[test]
fn null_pointers_return_status() {
    let numbers = [0.0; N];
    let at = numbers.as_ptr();
    let mut room = [0.0; N];
    let into = room.as_mut_ptr();
    let (mut robot, mut offsets, mut observer, mut arm) =
        (null_mut(), null_mut(), null_mut(), null_mut());
    let opened = Opened::biorob_like();
    // SAFETY: null is allowed, and returns a status.
    unsafe {
        assert_eq!(
            sinew_robot_new(null(), null(), &mut robot, null_mut(), 0),
            Status::Null
        );
        assert_eq!(
            sinew_robot_open(null(), &mut robot, null_mut(), 9),
            Status::Null
        );
        assert_eq!(
            sinew_robot_open(c"x".as_ptr(), null_mut(), null_mut(), 0),
            Status::Null
        );
        assert!(robot.is_null());
        assert_eq!(sinew_robot_joints(null()), 0);
        assert!(sinew_robot_joint_name(null(), 0).is_null());
        assert!(sinew_robot_joint_name(opened.0, N).is_null());
        assert!(sinew_robot_elongation_m(null(), 0, 0.1).is_nan());
        assert!(sinew_robot_elongation_m(opened.0, N, 0.1).is_nan());
        assert!(!sinew_robot_is_elastic(null(), 0) && !sinew_robot_is_elastic(opened.0, N));
        assert_eq!(
            sinew_robot_joint_index(opened.0, null(), null_mut()),
            Status::Null
        );
        let no = sinew_robot_joint_index(opened.0, c"no".as_ptr(), null_mut());
        assert_eq!(no, Status::Length);

        let made = sinew_offsets_new(null(), c"".as_ptr(), null(), &mut offsets, null_mut(), 0);
        assert_eq!(made, Status::Null);
        let made = sinew_offsets_new(opened.0, null(), null(), null_mut(), null_mut(), 0);
        assert_eq!(made, Status::Null);
        assert!(offsets.is_null());
        let stepped = sinew_offsets_step(null_mut(), 0.1, at, at, null(), 0.0, N, null_mut());
        assert_eq!(stepped, Status::Null);
        assert_eq!(sinew_offsets_interrupt(null_mut()), Status::Null);
        let read = sinew_offsets_read(null_mut(), null_mut(), null_mut(), N);
        assert_eq!(read, Status::Null);
        assert_eq!(sinew_offsets_start_worker(null_mut()), Status::Null);
        assert_eq!(sinew_offsets_work(null_mut()), Status::Null);
        let mut worker = null_mut();
        let taken = sinew_offsets_take_worker(null_mut(), &mut worker);
        assert_eq!((taken, worker), (Status::Null, null_mut()));
        assert_eq!(sinew_worker_work(null_mut()), Status::Null);
        assert_eq!(sinew_offsets_error(null(), null_mut(), 0), Status::Null);
        let saved = sinew_offsets_save(null_mut(), c"".as_ptr(), 0, null_mut(), 0, null_mut());
        assert_eq!(saved, Status::Null);

        let made = sinew_observer_new(null(), 20.0, 40.0, &mut observer, null_mut(), 0);
        assert_eq!(made, Status::Null);
        assert_eq!(
            sinew_observer_step(null_mut(), 0.1, at, at, null(), N),
            Status::Null
        );
        assert_eq!(sinew_observer_reset(null_mut()), Status::Null);
        assert_eq!(sinew_observer_delta_e(null(), into, N), Status::Null);
        assert!(!sinew_observer_is_settled(null()));
        let made = sinew_observer_new(opened.0, 20.0, 40.0, &mut observer, null_mut(), 0);
        assert_eq!(made, Status::Ok);
        assert_eq!(
            sinew_observer_step(observer, 0.1, null(), at, null(), N),
            Status::Null
        );
        assert_eq!(
            sinew_observer_delta_e(observer, null_mut(), N),
            Status::Null
        );
        assert_eq!(sinew_observer_tau_el(observer, into, N + 1), Status::Length);

        assert_eq!(sinew_arm_new(null(), &mut arm, null_mut(), 0), Status::Null);
        assert_eq!(
            sinew_arm_momentum(null_mut(), at, at, into, into, into, N),
            Status::Null
        );
        assert_eq!(sinew_arm_new(opened.0, &mut arm, null_mut(), 0), Status::Ok);
        let none = null_mut();
        assert_eq!(
            sinew_arm_momentum(arm, at, at, into, none, into, N),
            Status::Null
        );
        assert_eq!(
            sinew_arm_momentum(arm, at, at, into, into, into, N - 1),
            Status::Length
        );

        sinew_robot_free(null_mut());
        sinew_offsets_free(null_mut());
        sinew_worker_free(null_mut());
        sinew_observer_free(null_mut());
        sinew_arm_free(null_mut());
        sinew_observer_free(observer);
        sinew_arm_free(arm);
    }
}

#[test]
fn error_message_equals_library_and_is_truncated() {
    let mut robot = null_mut();
    let bad = text("[joint.elbow]\nstiffness = \"ü\"\n");
    let sentence = |room: usize| {
        let mut reason = [b'x' as c_char; 300];
        let mut robot = null_mut();
        // SAFETY: the buffer has the specified length.
        let status = unsafe {
            sinew_robot_new(
                bad.as_ptr(),
                c"<robot/>".as_ptr(),
                &mut robot,
                reason.as_mut_ptr(),
                room,
            )
        };
        assert_eq!(status, Status::Invalid);
        assert!(robot.is_null());
        assert!(
            reason[room..].iter().all(|c| *c == b'x' as c_char),
            "{room}: written beyond"
        );
        if room == 0 {
            return String::new();
        }
        // SAFETY: written with a zero.
        unsafe { CStr::from_ptr(reason.as_ptr()) }
            .to_str()
            .unwrap()
            .to_owned()
    };
    let whole = sentence(300);
    assert!(whole.starts_with("robot.toml"), "{whole}");
    for room in 0..300 {
        let cut = sentence(room);
        assert!(
            cut.len() < room.max(1) && whole.starts_with(&cut),
            "{room}: {cut}"
        );
    }
    // Invalid UTF-8 is rejected before parsing.
    // SAFETY: texts and a place.
    let status =
        unsafe { sinew_robot_new(c"\xff".as_ptr(), c"".as_ptr(), &mut robot, null_mut(), 0) };
    assert_eq!(status, Status::Encoding);
    let mut observer = null_mut();
    let mut reason = Why::new();
    let opened = Opened::biorob_like();
    // SAFETY: a robot, a place and room.
    let status = unsafe {
        sinew_observer_new(
            opened.0,
            -1.0,
            40.0,
            &mut observer,
            reason.at(),
            reason.room(),
        )
    };
    assert_eq!(status, Status::Invalid);
    assert!(reason.text().contains("gain"), "{}", reason.text());
}

#[test]
fn invalid_options_and_samples_return_status() {
    let (_, baseline) = recorded(&biorob_like());
    let baseline = text(&baseline.to_text());
    let robot = Opened::biorob_like();
    let make = |options: SinewOffsetsOptions, offsets: &mut *mut SinewOffsets| {
        let mut reason = Why::new();
        // SAFETY: a robot, a text, options, a place, room.
        let status = unsafe {
            sinew_offsets_new(
                robot.0,
                baseline.as_ptr(),
                &options,
                offsets,
                reason.at(),
                reason.room(),
            )
        };
        (status, reason.text())
    };
    let default = sinew_offsets_options_default();
    let mut offsets = null_mut();
    for (options, word) in [
        (
            SinewOffsetsOptions {
                payload: 7,
                ..default
            },
            "payload",
        ),
        (
            SinewOffsetsOptions {
                payload: 2,
                payload_kg: -1.0,
                ..default
            },
            "payload",
        ),
        (
            SinewOffsetsOptions {
                temperature_c: 4000.0,
                ..default
            },
            "4000",
        ),
    ] {
        let (status, reason) = make(options, &mut offsets);
        assert!(
            status == Status::Invalid && reason.contains(word),
            "{status:?} {reason}"
        );
        assert!(offsets.is_null());
    }
    let stated = SinewOffsetsOptions {
        payload: SinewPayload::Stated as u32,
        payload_kg: 0.5,
        temperature_c: 22.0,
        motor_torque: false,
        creep: false,
        ..default
    };
    assert_eq!(make(stated, &mut offsets), (Status::Ok, String::new()));

    let good = [0.1; N];
    let absent = [0.1, f64::NAN, 0.1, 0.1];
    let huge = [0.1, 1e200, 0.1, 0.1];
    let mut became = SinewStepped::Accepted;
    let mut step = |dt_s: f64, q: &[f64; N], theta: &[f64; N], joints: usize| {
        // SAFETY: arrays of four numbers, of which no more than `joints` are read.
        let status = unsafe {
            sinew_offsets_step(
                offsets,
                dt_s,
                q.as_ptr(),
                theta.as_ptr(),
                null(),
                f64::NAN,
                joints,
                &mut became,
            )
        };
        (status, became)
    };
    assert_eq!(
        step(0.0, &good, &good, N),
        (Status::Ok, SinewStepped::Restarted)
    );
    assert_eq!(
        step(0.01, &good, &good, N),
        (Status::Ok, SinewStepped::Accepted)
    );
    assert_eq!(step(0.0, &good, &good, N).0, Status::TimeStep);
    assert_eq!(step(f64::NAN, &good, &good, N).0, Status::TimeStep);
    assert_eq!(step(0.01, &good, &good, N - 1).0, Status::Length);
    let rejected = |reason| (Status::Rejected, reason);
    assert_eq!(
        step(0.01, &absent, &good, N),
        rejected(SinewStepped::NoJointPosition)
    );
    assert_eq!(
        step(0.01, &good, &absent, N),
        rejected(SinewStepped::NoMotorPosition)
    );
    assert_eq!(
        step(0.01, &huge, &good, N),
        rejected(SinewStepped::OutOfRange)
    );
    assert_eq!(
        step(0.01, &good, &good, N),
        (Status::Ok, SinewStepped::Accepted)
    );
    // SAFETY: handles, places, texts.
    unsafe {
        for joints in [0, N - 1, N + 1, usize::MAX] {
            let read = sinew_offsets_read(offsets, null_mut(), null_mut(), joints);
            assert_eq!(read, Status::Length, "{joints}");
        }
        let read = sinew_offsets_read(offsets, null_mut(), null_mut(), N);
        assert_eq!(read, Status::Ok);
        let saved = sinew_offsets_save(offsets, c"x".as_ptr(), 0, null_mut(), 0, null_mut());
        assert_eq!(saved, Status::Provisional);
        assert_eq!(sinew_offsets_interrupt(offsets), Status::Ok);
        assert_eq!(sinew_offsets_work(offsets), Status::Ok);
        let mut reason = Why::new();
        assert_eq!(
            sinew_offsets_error(offsets, reason.at(), reason.room()),
            Status::Ok
        );
        assert_eq!(reason.text(), "");
        sinew_offsets_free(offsets);
    }
}

// The offsets change their sign, so that no window can be solved.
#[test]
fn unsolvable_window_has_message() {
    let (frames, baseline) = recorded(&biorob_like());
    let baseline = text(&baseline.to_text());
    let robot = Opened::biorob_like();
    let mut offsets = null_mut();
    let mut reason = Why::new();
    // SAFETY: handles, places, room as stated.
    unsafe {
        let (file, no_room) = (baseline.as_ptr(), null_mut());
        let made = sinew_offsets_new(robot.0, file, null(), &mut offsets, no_room, 0);
        assert_eq!(made, Status::Ok);
        for (i, frame) in frames.iter().enumerate() {
            let [q, theta] = match i < frames.len() / 3 {
                true => [&frame.q, &frame.theta],
                false => [&frame.theta, &frame.q],
            };
            let (q, theta) = (q.as_ptr(), theta.as_ptr());
            sinew_offsets_step(offsets, 0.002, q, theta, null(), f64::NAN, N, null_mut());
            assert_eq!(sinew_offsets_work(offsets), Status::Ok);
        }
        let mut of_joints = [MaybeUninit::<SinewOffset>::uninit(); N];
        let read = sinew_offsets_read(offsets, null_mut(), of_joints.as_mut_ptr().cast(), N);
        assert_eq!(read, Status::Ok);
        let reasons = of_joints.map(|of| of.assume_init().provisional);
        assert!(
            reasons.contains(&SinewProvisional::NotSolved),
            "{reasons:?}"
        );
        assert!(!reasons.contains(&SinewProvisional::None), "{reasons:?}");
        assert_eq!(
            sinew_offsets_error(offsets, reason.at(), reason.room()),
            Status::Ok
        );
        assert!(reason.text().len() > 20, "{}", reason.text());
        let saved = sinew_offsets_save(offsets, c"x".as_ptr(), 0, null_mut(), 0, null_mut());
        assert_eq!(saved, Status::Provisional);
        sinew_offsets_free(offsets);
    }
}

#[test]
fn status_text_is_defined_for_every_status() {
    assert_eq!(sinew_abi_version(), SINEW_ABI_VERSION);
    // SAFETY: texts that are never freed.
    let words = |status| {
        unsafe { CStr::from_ptr(sinew_status_text(status)) }
            .to_str()
            .unwrap()
    };
    let none = Status::Thread as i32 + 1;
    for status in 0..none {
        let text = words(status);
        assert!(text == "done" || text.len() > 10, "{text}");
        assert_ne!(text, words(none));
    }
    assert_eq!(words(-1), words(none));
    // SAFETY: as above.
    let reason = |reason| unsafe { CStr::from_ptr(sinew_provisional_text(reason)) };
    assert_eq!(reason(SinewProvisional::None as i32), c"settled");
    assert_eq!(reason(SinewProvisional::NotSolved as i32), c"not solved");
    assert_eq!((reason(-1), reason(6)), (c"unknown", c"unknown"));
    // SAFETY: as above.
    let version = unsafe { CStr::from_ptr(sinew_version()) };
    assert_eq!(version.to_str().unwrap(), env!("CARGO_PKG_VERSION"));
}
