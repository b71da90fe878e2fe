//! Offsets of a real arm: the KUKA LWR4+ recording with added offsets.
//!
//! The recording has no motor positions, so they are calculated as `q + tau/K` with a specified
//! `K` of 200 N·m/rad (`examples/mappings/lwr4.toml`); 0.01 rad is added at joints 2 and 4 from
//! mid-recording. The observer does not use the torque: its estimate is based on the masses.

use crate::support;

use sinew_estimate::Request;
use sinew_estimate::feeder::Injection;
use sinew_estimate::replay;
use sinew_estimate::replay::Estimate;
use sinew_log::Mapping;
use support::{repository, shared};

fn lwr4(injections: Vec<Injection>) -> Option<Estimate> {
    let shared = shared("data")?.join("..");
    let example = repository().join("examples/03-real-arm");
    let robot = tempfile::tempdir().unwrap();
    std::fs::copy(example.join("robot.toml"), robot.path().join("robot.toml")).unwrap();
    std::fs::copy(
        shared.join("models/kuka_lwr4_identified.urdf"),
        robot.path().join("kuka_lwr4_identified.urdf"),
    )
    .unwrap();
    let mut request = Request::new(shared.join("data/lwr4_flobaroid/lwr4_hw_measurements_1.csv"));
    let mapping = repository().join("examples/mappings/lwr4.toml");
    request.open.mapping = Some(
        Mapping::from_toml(
            &std::fs::read_to_string(&mapping).unwrap(),
            &mapping.display().to_string(),
        )
        .unwrap(),
    );
    request.robot = Some(robot.path().to_path_buf());
    request.injections = injections;
    Some(replay::run(&request, &mut |_| {}).unwrap())
}

#[test]
fn lwr4_offsets_are_found() {
    const MIDDLE_S: f64 = 12.5;
    let inject = |joint: &str| Injection {
        joint: joint.into(),
        offset_rad: 0.01,
        from_s: Some(MIDDLE_S),
    };
    let Some(plain) = lwr4(Vec::new()) else {
        return;
    };
    let with = lwr4(vec![inject("lwr_1_joint"), inject("lwr_3_joint")]).unwrap();
    for w in &with.warnings {
        println!("warning: {}", sinew_report::recording_warning(w));
    }
    for (i, limit_bias_mrad) in [(1, 1.5), (3, 2.7)] {
        let (a, b) = (&plain.joints[i], &with.joints[i]);
        let offset_mrad = 1e3 * a.offset_rad.unwrap();
        let scatter_mrad = 1e3 * a.scatter_rad.unwrap();
        // The step of the means, from the averages over each half.
        let half = |late: bool| {
            let s = &b.series;
            let (mut sum, mut n) = (0.0, 0.0);
            for (t, d) in s.time_s.iter().zip(&s.offset_rad) {
                // The observer has 1 s to settle after the step.
                let inside = if late {
                    *t > MIDDLE_S + 1.0
                } else {
                    *t < MIDDLE_S
                };
                if inside && d.is_finite() {
                    sum += 1e3 * d;
                    n += 1.0;
                }
            }
            sum / n
        };
        let step = half(true) - half(false);
        println!(
            "{}: bias {:+.2} mrad, scatter {:.2} mrad, standard error {:.2} mrad, step of the means {:.2} mrad, usable {:.1} %",
            a.name,
            offset_mrad,
            scatter_mrad,
            1e3 * a.standard_error_rad.unwrap(),
            step,
            100.0 * a.usable_share
        );
        assert!(offset_mrad.abs() < limit_bias_mrad, "{offset_mrad}");
        assert!(scatter_mrad < 3.5);
        assert!((step - 10.0).abs() < 0.5, "{step}");
    }
}
