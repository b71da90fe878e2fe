//! Absolute offsets on the independent simulator's recordings: session A of each is the
//! baseline, B and C are estimated.

use crate::support;

use sinew_estimate::Request;
use sinew_estimate::session;
use sinew_estimate::session::{SessionOptions, Window};
use std::path::PathBuf;
use support::{biorob_like_folder, shared};

#[test]
fn offsets_since_baseline_lie_inside_intervals() {
    let Some(folder) = shared("data/offset_scenarios") else {
        return;
    };
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "parquet"))
        .collect();
    files.sort();
    let (mut inside, mut all) = (0, 0);
    for file in files {
        let truth: serde_json::Value = serde_json::from_str(
            &std::fs::read_to_string(file.with_extension("truth.json")).unwrap(),
        )
        .unwrap();
        let scenario = truth["scenario"].as_str().unwrap();
        let mut request = Request::new(file.clone());
        request.robot = Some(biorob_like_folder());
        let window = |from_s: f64, to_s: f64| Window { from_s, to_s };
        let (baseline, _) = session::learn(
            &request,
            window(0.0, 60.0),
            &session::Learning::default(),
            &mut |_| {},
        )
        .unwrap();
        let (estimate_b, _) = session::estimate(
            &request,
            window(60.0, 120.0),
            Some((&baseline, "baseline")),
            &SessionOptions::default(),
            &mut |_| {},
        )
        .unwrap();
        let mut line = format!("{scenario:4}");
        for joint in &estimate_b.joints {
            let error = 1e3 * joint.offset_rad.mean
                - 1e3 * truth["offset_rad"][&joint.name].as_f64().unwrap();
            let interval = 1e3 * joint.offset_rad.half_width_95();
            all += 1;
            inside += usize::from(error.abs() <= interval);
            line += &format!(" {} {error:+.2} ±{interval:.2}", joint.name);
            // With many poses the interval must also be narrow enough.
            if ["S5", "S6", "S7", "S8"].contains(&scenario) {
                assert!(error.abs() < 1.5 && interval < 2.0, "{line}");
            }
        }
        println!(
            "{line}; payload {:.3} kg, {:.0} % left out, {} poses",
            estimate_b.payload_kg.mean,
            100.0 * estimate_b.rejected_share,
            estimate_b.poses
        );
        if scenario == "S9c" {
            // At rest: nothing is identifiable, and no verdict may be given.
            for joint in &estimate_b.joints[1..] {
                assert_eq!(joint.verdict, session::Verdict::Inconclusive, "{joint:?}");
            }
            assert!(!estimate_b.warnings.is_empty());
        }
        // The slips of session C, in the recordings without contacts.
        if ["S5", "S6"].contains(&scenario) {
            let (late, _) = session::estimate(
                &request,
                window(60.0, 180.0),
                Some((&baseline, "baseline")),
                &SessionOptions::default(),
                &mut |_| {},
            )
            .unwrap();
            for joint in &late.joints {
                println!("     {}: steps {:?}", joint.name, joint.changes);
            }
        }
    }
    println!("{inside} of {all} offsets inside their 95 % interval");
    // With a coverage of 95 %, fewer than 28 of 32 are inside with a probability below 2 %.
    assert!(inside >= 28, "{inside} of {all}");
}
