//! Axes: entries of the frames that have a motor and a tendon, and not always a joint.

use crate::live::pushed;
use crate::skipped::shared;
use crate::support::*;
use sinew_log::live::LiveOptions;
use sinew_log::{
    Axis, Frame, FrameWriter, Mapping, McapOptions, McapWriter, OpenOptions, OwnedAxis, Quantities,
    Quantity, Recording, RowWriter,
};
use std::f64::consts::{PI, TAU};

const KNUCKLE: Axis<'_> = Axis {
    joint: Some("knuckle"),
    motor: Some("m_flexor"),
    tendon: Some("flexor"),
};
const BEYOND: Axis<'_> = Axis {
    joint: None,
    motor: Some("m_extensor"),
    tendon: Some("extensor"),
};

/// A joint of which every fifth position is not recorded, two motors at their shafts, two tensions.
fn finger() -> Vec<Frame> {
    let frame = |k: i64| {
        let t = 4e-3 * k as f64;
        let mut frame = Frame::new(2);
        frame.time_ns = START_NS + 4 * MS * k;
        frame.q = vec![0.3 * t.sin(), 0.0];
        if k % 5 == 4 {
            frame.q[0] = f64::NAN;
        }
        frame.dq = vec![0.3 * t.cos(), 0.0];
        // The second motor turns more than once.
        frame.theta = vec![2.0 + 1.2 * t.sin(), 4.0 * t];
        frame.tau_m = vec![0.1 * t, -0.2 * t];
        frame.tension = vec![20.0 + t, 30.0 - t];
        frame
    };
    (0..1000).map(frame).collect()
}

fn quantities() -> Quantities {
    Quantities {
        dq: true,
        tau_m: true,
        tension: true,
        ..Quantities::positions()
    }
}

fn write(path: &std::path::Path, axes: &[Axis<'_>], quantities: Quantities, frames: &[Frame]) {
    let mut writer = RowWriter::create_axes(path, axes, quantities).unwrap();
    frames.iter().for_each(|f| writer.write(f).unwrap());
    Box::new(writer).finish().unwrap();
}

fn endings() -> &'static [&'static str] {
    match cfg!(feature = "parquet") {
        true => &["a.csv", "a.parquet"],
        false => &["a.csv"],
    }
}

fn opened(text: &str, mapping: Option<&str>) -> Recording {
    let options = OpenOptions {
        mapping: mapping.map(|text| Mapping::from_toml(text, "map.toml").unwrap()),
        ..OpenOptions::default()
    };
    open_bytes(text.as_bytes(), "a.csv", &options).unwrap()
}

fn same(found: &[f64], want: &[f64]) -> bool {
    let mut pairs = found.iter().zip(want);
    let equal = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
    found.len() == want.len() && pairs.all(equal)
}

#[test]
fn axes_written_as_tables_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let written = finger();
    for name in endings() {
        let path = folder.path().join(name);
        write(&path, &[KNUCKLE, BEYOND], quantities(), &written);
        let mut recording = sinew_log::open(&path, &OpenOptions::default()).unwrap();
        assert_eq!(recording.joints(), ["knuckle", "m_flexor", "m_extensor"]);
        assert_eq!(recording.tendons(), ["flexor", "extensor"]);
        assert_eq!(recording.unused_columns(), [""; 0]);
        recording.select_axes(&[KNUCKLE, BEYOND]).unwrap();
        assert_eq!(recording.joints(), ["knuckle"]);
        assert!(recording.axes().eq([KNUCKLE, BEYOND]));
        let channels = &recording.channels().joints;
        assert_eq!(channels[0], quantities());
        let without_joint = Quantities {
            q: false,
            dq: false,
            ..quantities()
        };
        assert_eq!(channels[1], without_joint);
        for want in &written {
            let frame = recording.next_frame().unwrap().unwrap();
            for quantity in [
                Quantity::Q,
                Quantity::Dq,
                Quantity::Theta,
                Quantity::TauM,
                Quantity::Tension,
            ] {
                let (found, want) = (frame.get(quantity), want.get(quantity));
                assert!(same(found, want), "{name} {quantity:?}: {found:?} {want:?}");
            }
            assert!(
                frame
                    .tau_el
                    .iter()
                    .chain(&frame.tau_ext)
                    .all(|v| v.is_nan())
            );
        }
        assert!(recording.next_frame().unwrap().is_none());
        let health = recording.health();
        assert_eq!(health.implausible_signals, [""; 0], "{name}");
        assert!(health.non_finite.is_empty() && health.unwrapped.is_empty());
        // The axis without a joint hides no frame without joint positions.
        assert_eq!(health.frames_without_joint_side, 200, "{name}");
    }
    let text = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    assert_eq!(
        text.lines().next().unwrap(),
        "time_s,q.knuckle_rad,theta.m_flexor_rad,theta.m_extensor_rad,dq.knuckle_rad_s,\
         tau_m.m_flexor_nm,tau_m.m_extensor_nm,tension.flexor_n,tension.extensor_n"
    );
}

#[test]
fn axis_without_joint_may_be_first_or_alone() {
    let folder = tempfile::tempdir().unwrap();
    let written = finger();
    for name in endings() {
        let path = folder.path().join(name);
        write(&path, &[KNUCKLE, BEYOND], quantities(), &written);
        for axes in [&[BEYOND, KNUCKLE][..], &[BEYOND]] {
            let mut recording = sinew_log::open(&path, &OpenOptions::default()).unwrap();
            recording.select_axes(axes).unwrap();
            for want in &written {
                let frame = recording.next_frame().unwrap().unwrap();
                assert_eq!(frame.q[0].to_bits(), 0.0_f64.to_bits());
                assert_eq!(
                    (frame.theta[0], frame.tension[0]),
                    (want.theta[1], want.tension[1])
                );
                // Without any joint no velocity is recorded.
                let still = frame.dq[0];
                assert!(if axes.len() == 2 {
                    still == 0.0
                } else {
                    still.is_nan()
                });
                let q = frame.q.get(1).map_or(want.q[0], |q| *q);
                assert!(same(&[q], &want.q[..1]));
            }
            let lacking = if axes.len() == 2 { 200 } else { 0 };
            assert_eq!(recording.health().frames_without_joint_side, lacking);
        }
    }
}

/// The encoder of a motor without a joint is counted from sample to sample, as that of any motor at its shaft.
#[test]
fn motor_without_joint_keeps_turn() {
    let shown = |k: i64| (5.0 + 0.04 * k as f64 + PI).rem_euclid(TAU) - PI;
    let mut text = String::from("time_s,q.a_rad,theta.m_rad\n");
    for k in 0..500 {
        text.push_str(&format!("{}.{:02},0.1,{}\n", k / 100, k % 100, shown(k)));
    }
    let mut recording = opened(&text, None);
    let beyond = Axis {
        motor: Some("m"),
        ..Axis::default()
    };
    recording
        .select_axes(&[Axis::of_joint("a"), beyond])
        .unwrap();
    for k in 0..500 {
        let frame = recording.next_frame().unwrap().unwrap();
        let expected = shown(0) + 0.04 * k as f64;
        assert!((frame.theta[1] - expected).abs() < 1e-9, "{k}");
        // No velocity is recorded, no tendon is named.
        assert!(frame.dq[1].is_nan() && frame.tension[1].is_nan());
        assert_eq!(frame.q, [0.1, 0.0]);
    }
    assert!(recording.next_frame().unwrap().is_none());
    assert_eq!(recording.health().unwrapped.len(), 1);
    assert_eq!(recording.health().unwrapped[0].joint, "m");
    // Only what was recorded is found to be constant.
    let implausible_signals = &recording.health().implausible_signals;
    assert_eq!(implausible_signals.len(), 1, "{implausible_signals:?}");
    assert!(implausible_signals[0].contains("q.a is constant"));
}

#[test]
fn motors_and_tendons_that_are_not_recorded_have_no_values() {
    let text = "time_s,q.a_rad,theta.m_rad,tension.t_n\n0,0.1,0.2,9\n0.01,0.1,0.2,9\n";
    let mut recording = opened(text, None);
    assert_eq!(recording.tendons(), ["t"]);
    assert_eq!(recording.joints(), ["a", "m"]);
    let missing = Axis {
        joint: None,
        motor: Some("n"),
        tendon: Some("u"),
    };
    recording
        .select_axes(&[Axis::of_joint("a"), missing])
        .unwrap();
    let channels = &recording.channels().joints;
    assert!(channels[0].q && !channels[0].theta && !channels[0].tension);
    assert_eq!(channels[1], Quantities::default());
    let frame = recording.next_frame().unwrap().unwrap();
    assert!(frame.theta.iter().chain(&frame.tension).all(|v| v.is_nan()));
    assert_eq!((frame.tension.len(), frame.q[1]), (2, 0.0));
}

#[test]
fn invalid_axis_selection_is_error() {
    let text = "time_s,q.a_rad,theta.m_rad,tension.t_n\n0,0.1,0.2,9\n";
    let motor = Axis {
        motor: Some("m"),
        ..Axis::default()
    };
    let tendon = Axis {
        tendon: Some("t"),
        ..Axis::default()
    };
    let a = Axis::of_joint("a");
    for (axes, words) in [
        (&[a, a][..], "joint 'a' is selected twice"),
        (&[motor, motor], "motor 'm' is selected twice"),
        (&[tendon, tendon], "tendon 't' is selected twice"),
        (&[a, Axis::default()], "axis 1 has no name"),
        (&[Axis::of_joint("t")], "no joint 't'"),
    ] {
        let mut recording = opened(text, None);
        let error = recording.select_axes(axes).unwrap_err().to_string();
        assert!(
            error.starts_with("a.csv: ") && error.contains(words),
            "{error}"
        );
    }
}

#[test]
fn mapping_names_columns_and_units_of_tensions() {
    let text =
        "time_s,q.a_rad,cell 1,cell 2,cell 3,tension.left_n\n0,0.1,7,8,2,5\n0.1,0.1,inf,,2,5\n";
    let mapping = r#"
        [tendons.left]
        tension = "cell 1"
        [tendons.right]
        tension = { column = "cell 2", unit = "N", scale = 0.5, sign = -1, offset = 10 }
        [tendons.both]
        tension = { sum = [ { column = "cell 1" }, { column = "cell 3", unit = "N·m", scale = 100 } ] }
    "#;
    let mut recording = opened(text, Some(mapping));
    assert_eq!(recording.joints(), ["a"]);
    assert_eq!(recording.tendons(), ["left", "right", "both"]);
    assert_eq!(recording.unused_columns(), ["tension.left_n"]);
    let told = recording.sources();
    let told = told.iter().find(|s| s.quantity == Quantity::Tension);
    assert_eq!(told.unwrap().source, "cell 1, cell 2, cell 1, cell 3");
    let axis = |tendon| Axis {
        tendon: Some(tendon),
        ..Axis::default()
    };
    let a = Axis {
        tendon: Some("both"),
        ..Axis::of_joint("a")
    };
    recording
        .select_axes(&[axis("right"), a, axis("left")])
        .unwrap();
    assert!(recording.channels().all_have(Quantity::Tension));
    let frame = recording.next_frame().unwrap().unwrap();
    assert_eq!(frame.tension, [6.0, 207.0, 7.0]);
    let frame = recording.next_frame().unwrap().unwrap();
    assert!(frame.tension.iter().all(|tension| tension.is_nan()));
    assert!(recording.next_frame().unwrap().is_none());
    let bad = recording.health().non_finite.iter();
    let bad = Vec::from_iter(bad.map(|s| (s.quantity, s.joint.as_str(), s.count)));
    let tension = Quantity::Tension;
    assert_eq!(bad, [(tension, "both", 1), (tension, "left", 1)]);
}

#[test]
fn invalid_tension_mapping_is_error() {
    for (text, words) in [
        ("[tendons.t]\ntension = 0\n", "its number from 1"),
        ("[tendons.t]\ntensoin = \"x\"\n", "unknown key"),
        (
            "[tendons.t]\ntension = { column = \"x\", unit = \"rad\" }\n",
            "a unit of tension (n)",
        ),
        (
            "[tendons.t]\ntension = { column = \"x\", gear_ratio = 2 }\n",
            "without a gear",
        ),
        (
            "[tendons.t]\ntension = { column = \"x\", wrap_period = 2 }\n",
            "only positions wrap",
        ),
    ] {
        let error = Mapping::from_toml(text, "map.toml").unwrap_err();
        let error = error.to_string();
        assert!(
            error.starts_with("map.toml, line 2") && error.contains(words),
            "{error}"
        );
    }
    let text = "time_s,q.a_rad,load\n0,0.1,7\n";
    let mapping = Mapping::from_toml("[tendons.t]\ntension = \"laod\"\n", "map.toml");
    let options = OpenOptions {
        mapping: Some(mapping.unwrap()),
        ..OpenOptions::default()
    };
    let error = error_of(text.as_bytes(), "a.csv", &options);
    assert!(
        error.contains("map.toml, line 2: no column 'laod' in a.csv; did you mean 'load'?"),
        "{error}"
    );
}

#[test]
fn parts_with_and_without_tensions_are_one_recording() {
    let folder = tempfile::tempdir().unwrap();
    let written = finger();
    let (early, late) = written.split_at(500);
    for (name, own, frames) in [
        ("1.csv", quantities(), early),
        (
            "2.csv",
            Quantities {
                tension: false,
                ..quantities()
            },
            late,
        ),
    ] {
        write(&folder.path().join(name), &[KNUCKLE, BEYOND], own, frames);
    }
    for parts in [["1.csv", "2.csv"], ["2.csv", "1.csv"]] {
        let paths = parts.map(|name| folder.path().join(name));
        let mut recording = sinew_log::open_parts(&paths, &OpenOptions::default()).unwrap();
        assert_eq!(recording.tendons(), ["flexor", "extensor"]);
        recording.select_axes(&[KNUCKLE, BEYOND]).unwrap();
        for (k, want) in written.iter().enumerate() {
            let frame = recording.next_frame().unwrap().unwrap();
            assert_eq!(frame.theta, want.theta);
            match k < early.len() {
                true => assert_eq!(frame.tension, want.tension),
                false => assert!(frame.tension.iter().all(|tension| tension.is_nan())),
            }
        }
    }
}

const FROM_TOPIC: &str = "[mcap]\ntension_topic = \"/tendon_states\"\n[tendons.flexor]\nname = \"cell_1\"\ntension = { scale = 2 }\n[tendons.extensor]\n";

/// A joint, two motors, and load cells of half the rate.
fn tendon_states() -> Vec<u8> {
    let mut bag = Bag::new();
    for k in 0..100 {
        let at = START_NS + 10 * MS * k;
        bag.joint(at, &[("knuckle", 0.1)]);
        bag.motor(at, &[("m_extensor", 0.2 + k as f64), ("m_flexor", 0.3)]);
        if k % 2 == 0 {
            let mut message = joint_state(at, &[("extensor", 0.0), ("cell_1", 0.0)]);
            message.position.clear();
            message.effort = vec![k as f64, 10.0];
            bag.raw("/tendon_states", &little(&message));
        }
    }
    bag.bytes()
}

#[test]
fn axes_come_live_as_a_recording_gives_them() {
    let bytes = tendon_states();
    let open = OpenOptions {
        mapping: Some(Mapping::from_toml(FROM_TOPIC, "map.toml").unwrap()),
        ..OpenOptions::default()
    };
    let mut recording = open_bytes(&bytes, "a.mcap", &open).unwrap();
    recording.select_axes(&[BEYOND, KNUCKLE]).unwrap();
    let (read, health) = read_all(recording);
    let watched = LiveOptions {
        axes: [BEYOND, KNUCKLE].map(OwnedAxis::from).to_vec(),
        open,
        ..LiveOptions::default()
    };
    let (live, live_health) = pushed(&bytes, &watched);
    assert_eq!((live.len(), &live_health), (read.len(), &health));
    for (live, read) in live.iter().zip(&read) {
        assert_eq!((&live.q, &live.theta), (&read.q, &read.theta));
        assert!(same(&live.tension, &read.tension) && same(&live.dq, &read.dq));
    }
}

#[test]
fn tensions_come_from_a_topic_that_the_mapping_names() {
    let (bytes, mapping) = (tendon_states(), FROM_TOPIC);
    let with = |text: &str| OpenOptions {
        mapping: Some(Mapping::from_toml(text, "map.toml").unwrap()),
        ..OpenOptions::default()
    };
    let mut recording = open_bytes(&bytes, "a.mcap", &with(mapping)).unwrap();
    assert_eq!(recording.joints(), ["knuckle", "m_extensor", "m_flexor"]);
    assert_eq!(recording.tendons(), ["flexor", "extensor"]);
    recording.select_axes(&[BEYOND, KNUCKLE]).unwrap();
    let channels = &recording.channels().joints;
    assert!(channels.iter().all(|has| has.tension && has.theta));
    assert!(!channels[0].q && channels[1].q);
    let mut count = 0;
    while let Some(frame) = recording.next_frame().unwrap() {
        assert_eq!(frame.q, [0.0, 0.1]);
        assert_eq!(frame.theta[1], 0.3);
        // After the last message of the load cells there is nothing to interpolate to.
        match count < 99 {
            true => assert_eq!(frame.tension, [f64::from(count), 20.0]),
            false => assert!(frame.tension.iter().all(|tension| tension.is_nan())),
        }
        count += 1;
    }
    assert_eq!(count, 100);
    let health = recording.health();
    assert_eq!(health.unknown_joints, [""; 0]);
    assert_eq!(health.streams.len(), 3);
    let told = recording.sources();
    let told = told.iter().find(|s| s.quantity == Quantity::Tension);
    assert_eq!(told.unwrap().source, "/tendon_states effort");
    // Two topics could be the joint side if the mapping does not specify the other one; the default name
    // takes precedence.
    let plain = open_bytes(&bytes, "a.mcap", &OpenOptions::default()).unwrap();
    assert_eq!(plain.tendons(), [""; 0]);
    for (text, words) in [
        ("[tendons.flexor]\n", "no topic"),
        (
            "[mcap]\ntension_topic = \"/tendons\"\n",
            "no topic '/tendons'",
        ),
        (
            "[mcap]\ntension_topic = \"/joint_states\"\njoint_state_topic = \"/joint_states\"\n",
            "joint side and tensions are the same topic",
        ),
        (
            "[mcap]\ntension_topic = \"/tendon_states\"\n[tendons.cell_2]\n",
            "did you mean 'cell_1'",
        ),
        (
            "[mcap]\ntension_topic = \"/tendon_states\"\n[tendons.cell_1]\ntension = \"x\"\n",
            "not columns",
        ),
    ] {
        let error = error_of(&bytes, "a.mcap", &with(text));
        assert!(error.contains(words), "{text}: {error}");
    }
}

#[test]
fn axes_written_as_topics_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let written = finger();
    let options = McapOptions {
        joints: vec!["knuckle".to_owned()],
        motors: ["m_flexor", "m_extensor"].map(str::to_owned).to_vec(),
        tendons: ["flexor", "extensor"].map(|t| Some(t.to_owned())).to_vec(),
        quantities: quantities(),
        ..McapOptions::default()
    };
    let mut writer = McapWriter::create(&path, &options).unwrap();
    written.iter().for_each(|f| writer.write(f).unwrap());
    Box::new(writer).finish().unwrap();
    let mapping = "[mcap]\ntension_topic = \"/tendon_states\"\n";
    let open = OpenOptions {
        mapping: Some(Mapping::from_toml(mapping, "map.toml").unwrap()),
        ..OpenOptions::default()
    };
    let mut recording = sinew_log::open(&path, &open).unwrap();
    assert_eq!(recording.joints(), ["knuckle", "m_flexor", "m_extensor"]);
    recording.select_axes(&[KNUCKLE, BEYOND]).unwrap();
    for want in &written {
        let frame = recording.next_frame().unwrap().unwrap();
        for quantity in quantities().iter() {
            let (found, want) = (frame.get(quantity), want.get(quantity));
            assert!(same(found, want), "{quantity:?}: {found:?} {want:?}");
        }
    }
    assert!(recording.next_frame().unwrap().is_none());
    let few = McapOptions {
        tendons: vec![None],
        ..options
    };
    let error = McapWriter::create(&path, &few).err().unwrap().to_string();
    assert!(error.contains("2 axes and 1 tendons"), "{error}");
}

#[test]
fn recording_with_more_tendons_than_joints_is_read() {
    let Some(folder) = shared("tendons/recordings") else {
        return;
    };
    let path = folder.join("n-plus-1-finger-baseline.parquet");
    if !cfg!(feature = "parquet") {
        return;
    }
    let mut recording = sinew_log::open(&path, &OpenOptions::default()).unwrap();
    let tendons = recording.tendons().to_vec();
    let (mut joints, mut motors) = (Vec::new(), Vec::new());
    let found = recording.joints().iter().zip(&recording.channels().joints);
    for (name, has) in found {
        let of = if has.q { &mut joints } else { &mut motors };
        of.push(name.clone());
    }
    println!("joints {joints:?}, motors {motors:?}, tendons {tendons:?}");
    assert_eq!(
        (motors.len(), tendons.len()),
        (joints.len() + 1, joints.len() + 1)
    );
    let axes = (0..motors.len()).map(|i| Axis {
        joint: joints.get(i).map(String::as_str),
        motor: Some(motors[i].as_str()),
        tendon: Some(tendons[i].as_str()),
    });
    recording.select_axes(&Vec::from_iter(axes)).unwrap();
    let mut frames = 0;
    while let Some(frame) = recording.next_frame().unwrap() {
        let all = [&frame.q, &frame.theta, &frame.tau_m, &frame.tension];
        assert!(all.into_iter().flatten().all(|value| value.is_finite()));
        assert_eq!(frame.q.last(), Some(&0.0));
        assert!(frame.tension.iter().all(|tension| *tension > 0.0));
        frames += 1;
    }
    assert!(frames > 100, "{frames}");
    assert_eq!(recording.health().implausible_signals, [""; 0]);
}
