//! Real and independent recordings in the optional folder next to the checkout.

use crate::skipped::shared;
use std::path::Path;

use sinew_log::{Format, Mapping, OpenOptions, Quantity, Recording, open};

fn mapping(name: &str) -> Mapping {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples/mappings")
        .join(name);
    Mapping::read(&path).unwrap()
}

fn open_mapped(path: &Path, name: &str) -> Recording {
    let options = OpenOptions {
        mapping: Some(mapping(name)),
        ..OpenOptions::default()
    };
    open(path, &options).unwrap()
}

#[test]
fn hebi_effort_is_forty_times_the_deflection() {
    let Some(path) = shared("data/hebi_x_series/exampleLog_all_fields.csv") else {
        return;
    };
    let mut recording = open_mapped(&path, "hebi.toml");
    assert_eq!(recording.joints(), ["actuator"]);
    let (mut xx, mut xy, mut frames) = (0.0, 0.0, 0);
    let mut first_ns = None;
    let mut worst: f64 = 0.0;
    while let Some(frame) = recording.next_frame().unwrap() {
        first_ns.get_or_insert(frame.time_ns);
        let twist = frame.theta[0] - frame.q[0];
        xx += twist * twist;
        xy += twist * frame.tau_el[0];
        worst = worst.max((frame.tau_el[0] - 40.0 * twist).abs());
        frames += 1;
    }
    let stiffness = xy / xx;
    println!(
        "HEBI: K = {stiffness:.6} N·m/rad over {frames} frames, worst residual {worst:.2e} N·m"
    );
    // Effort and deflection are stored as single precision (24 bit mantissa, 6e-8).
    assert!((stiffness - 40.0).abs() < 40.0 * 2e-7, "{stiffness}");
    assert!(frames > 900, "{frames}");
    // Microseconds of the epoch time survive: the first transmit_time is 1530821160.114326.
    assert_eq!(first_ns, Some(1_530_821_160_114_326_000));
    let health = recording.health();
    assert!(
        !health.is_damaged() && health.non_finite.is_empty(),
        "{health:?}"
    );
}

#[test]
fn lwr4_has_its_seven_joints_and_the_stated_spring() {
    let Some(path) = shared("data/lwr4_flobaroid/lwr4_hw_measurements_1.csv") else {
        return;
    };
    let mut recording = open_mapped(&path, "lwr4.toml");
    let names: Vec<String> = (0..7).map(|k| format!("lwr_{k}_joint")).collect();
    assert_eq!(recording.joints(), names);
    for quantity in [Quantity::Q, Quantity::Theta, Quantity::Dq, Quantity::TauEl] {
        assert!(recording.channels().all_have(quantity), "{quantity:?}");
    }
    let mut last_ns = 0;
    let (mut shortest, mut longest) = (i64::MAX, 0);
    while let Some(frame) = recording.next_frame().unwrap() {
        for joint in 0..7 {
            let residual = 200.0 * (frame.theta[joint] - frame.q[joint]) - frame.tau_el[joint];
            // 200 N·m/rad times the rounding of a position of 3 rad.
            assert!(
                residual.abs() < 200.0 * 4.0 * f64::EPSILON * 3.0,
                "{residual}"
            );
        }
        if last_ns > 0 {
            shortest = shortest.min(frame.time_ns - last_ns);
            longest = longest.max(frame.time_ns - last_ns);
        }
        last_ns = frame.time_ns;
    }
    let health = recording.health();
    println!(
        "LWR4+: {} frames, {:.1} to {:.1} ms",
        health.frames,
        shortest as f64 * 1e-6,
        longest as f64 * 1e-6
    );
    assert!(health.frames > 4900 && health.gaps == 0, "{health:?}");
    assert!(
        health.implausible_signals.is_empty(),
        "{:?}",
        health.implausible_signals
    );
    // As decimal arithmetic on the file's own text gives them.
    assert_eq!((shortest, longest), (3_444_000, 6_535_000));
}

#[test]
fn offset_scenarios_open_as_they_are() {
    let Some(folder) = shared("data/offset_scenarios") else {
        return;
    };
    let mut read = 0;
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "parquet"))
        .collect();
    files.sort();
    for path in files {
        let mut recording = open(&path, &OpenOptions::default()).unwrap();
        assert_eq!(recording.format(), Format::Parquet);
        assert_eq!(
            recording.joints(),
            ["shoulder_yaw", "shoulder_pitch", "elbow", "wrist"]
        );
        let channels = recording.channels().union();
        assert!(channels.q && channels.theta && channels.tau_m && channels.temperature);
        assert!(!channels.dq && !channels.tau_el && !channels.tau_ext);
        recording.select(&["elbow", "shoulder_pitch"]).unwrap();
        let mut first = None;
        let mut last_ns = 0;
        while let Some(frame) = recording.next_frame().unwrap() {
            first.get_or_insert_with(|| frame.clone());
            last_ns = frame.time_ns;
        }
        let first = first.unwrap();
        assert_eq!(first.time_ns, 0);
        assert_eq!(last_ns, 179_996_000_000);
        assert_eq!(recording.health().frames, 45_000);
        assert_eq!(recording.health().gaps, 0);
        if path.ends_with("S5-900001.parquet") {
            // As another Parquet reader shows them.
            assert_eq!(first.q, [0.016_873_788_666_742_05, 0.961_805_954_004_297]);
            assert_eq!(first.theta, [0.071_34, 1.057_68]);
            assert_eq!(
                first.tau_m,
                [1.124_568_255_471_671, 2.077_016_676_828_234_3]
            );
            assert_eq!(first.temperature_c, 22.0);
        }
        assert!(!recording.health().is_damaged());
        read += 1;
    }
    println!("offset scenarios: {read} recordings");
    assert!(read > 0);
}
