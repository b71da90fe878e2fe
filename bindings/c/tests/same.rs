//! Numbers through C are those of the libraries, to the last bit.

use crate::support::{N, Opened, Why, biorob_like, recorded, repository, text};
use sinew_c::momentum::{sinew_arm_free, sinew_arm_momentum, sinew_arm_new};
use sinew_c::observer::*;
use sinew_c::offsets::*;
use sinew_c::robot::*;
use sinew_c::status::Status;
use sinew_estimate::live::{LiveOffsets, Stepped};
use sinew_estimate::session::SessionOptions;
use sinew_log::Frame;
use sinew_model::arm::ArmWorkspace;
use sinew_model::offset::{OffsetConfig, OffsetObserver, Sample, VelocityFilter};
use std::ffi::CStr;
use std::ptr::{null, null_mut};

/// Time since the sample before, s.
fn step_s(frames: &[Frame], at: usize) -> f64 {
    let before = frames[at.saturating_sub(1)].time_ns;
    (frames[at].time_ns - before) as f64 * 1e-9
}

#[test]
fn a_robot_says_what_rust_says() {
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
                let said = CStr::from_ptr(sinew_robot_joint_name(robot, i));
                assert_eq!(said.to_str().unwrap(), name);
                let mut index = 99;
                let asked = sinew_robot_joint_index(robot, said.as_ptr(), &mut index);
                assert_eq!((asked, index), (Status::Ok, i));
                let tendon = known.transmissions[i].as_ref().unwrap().tendon.as_ref();
                let elongation_m = sinew_robot_elongation_m(robot, i, 0.01);
                assert_eq!(elongation_m, tendon.unwrap().elongation_m(0.01));
            }
        }
        sinew_robot_free(of_texts);
    }
}

#[test]
fn offsets_and_what_is_saved_are_those_of_the_libraries() {
    let known = biorob_like();
    let (frames, baseline) = recorded(&known);
    let options = SessionOptions::default();
    let saved = text(&baseline.to_text());
    let mut live = LiveOffsets::new(known, (baseline, "baseline"), &options).unwrap();
    let robot = Opened::biorob_like();
    let mut offsets = null_mut();
    let mut why = Why::new();
    // SAFETY: a robot, a text, places.
    let made = unsafe {
        sinew_offsets_new(
            robot.0,
            saved.as_ptr(),
            null(),
            &mut offsets,
            why.at(),
            why.room(),
        )
    };
    assert_eq!(made, Status::Ok, "{}", why.text());
    // What was made goes on without the robot.
    drop(robot);
    let mut updates = 0;
    for (i, frame) in frames.iter().enumerate() {
        let dt_s = step_s(&frames, i);
        let (q, theta) = (frame.q.as_slice(), frame.theta.as_slice());
        let stepped = live
            .step(dt_s, q, theta, &frame.tau_m, frame.temperature_c)
            .unwrap();
        updates += usize::from(stepped == Stepped::Updated);
        let mut became = SinewStepped::OutOfRange;
        // SAFETY: arrays of four numbers.
        let status = unsafe {
            sinew_offsets_step(
                offsets,
                dt_s,
                q.as_ptr(),
                theta.as_ptr(),
                frame.tau_m.as_ptr(),
                frame.temperature_c,
                N,
                &mut became,
            )
        };
        assert_eq!(status, Status::Ok);
        let as_c = match stepped {
            Stepped::Taken => SinewStepped::Taken,
            Stepped::Restarted => SinewStepped::Restarted,
            Stepped::Updated => SinewStepped::Updated,
            Stepped::Refused(why) => panic!("{why:?}"),
        };
        assert_eq!(became, as_c, "frame {i}");
    }
    assert!(updates > 100, "{updates}");
    // SAFETY: a handle.
    let late = unsafe { sinew_offsets_expect_creep(offsets, 1e-5) };
    assert_eq!(late, Status::Late);
    for joint in 0..N {
        let (mut mean, mut deviation, mut in_doubt, mut changed) = (0.0, 0.0, false, 0.0);
        // SAFETY: handles and places.
        unsafe {
            let read = sinew_offsets_read(offsets, joint, &mut mean, &mut deviation, &mut in_doubt);
            assert_eq!(read, Status::Ok);
            let read = sinew_offsets_stiffness_changed(offsets, joint, &mut changed);
            assert_eq!(read, Status::Ok);
        }
        let offset = live.offset(joint);
        assert_eq!((mean, deviation), (offset.mean, offset.deviation));
        assert_eq!(
            (in_doubt, changed),
            (live.is_provisional(), live.stiffness_changed(joint))
        );
        let mut unknown = f64::NAN;
        // SAFETY: handles and places.
        let read = unsafe { sinew_offsets_unknown_temperature(offsets, joint, &mut unknown) };
        assert_eq!(read, Status::Ok);
        assert_eq!(unknown, live.unknown_temperature_rad(joint));
    }
    let (mut likely, mut force_n, mut deviation_n) = (0.0, [0.0; 3], [0.0; 3]);
    let (to, and) = (force_n.as_mut_ptr(), deviation_n.as_mut_ptr());
    // SAFETY: handles and places.
    unsafe {
        let read = sinew_offsets_external_force(offsets, &mut likely, to, and);
        assert_eq!(read, Status::Ok);
        let read = sinew_offsets_external_force(offsets, null_mut(), null_mut(), null_mut());
        assert_eq!(read, Status::Ok);
    }
    let force = live.external_force().unwrap();
    assert_eq!(likely, force.probability);
    assert_eq!(force_n, force.force_n.map(|f| f.mean));
    assert_eq!(deviation_n, force.force_n.map(|f| f.deviation));
    let end_ns = frames.last().unwrap().time_ns;
    let next = live.save("run", end_ns).unwrap().to_text();
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

#[test]
fn the_observer_and_the_pass_are_those_of_the_model() {
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
