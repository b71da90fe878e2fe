//! Sessions of a simulated year through the whole chain: recorded, estimated, stored, resumed.

use crate::support;

use sinew_bench::year::chain::{ChainRequest, Session, SessionKind, statistics};
use sinew_bench::year::{RobotYear, YearError, YearRequest, run_chain};
use sinew_model::{Gaussian, Z95};
use sinew_rope::Catalogue;
use support::biorob_like;

/// Sessions of a robot whose tendons creep by their ropes' laws.
fn lived(chain: &ChainRequest, days: usize) -> Result<Vec<(Vec<Session>, RobotYear)>, YearError> {
    let robot = biorob_like();
    let catalogue = Catalogue::shipped().expect("ropes");
    let request = YearRequest {
        robots: 1,
        seed: 500,
        forecasters: Vec::new(),
        ..YearRequest::default()
    };
    let chain = ChainRequest {
        days,
        ..chain.clone()
    };
    let mut progress = |done, all| assert!(done <= all && all == days);
    run_chain(&robot, &catalogue, &request, &chain, &mut progress)
}

#[test]
fn chain_checks_track_offsets_and_resume() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sessions.jsonl");
    let mut chain = ChainRequest::new(SessionKind::Check);
    chain.out = Some(path.clone());
    let first = lived(&chain, 2).expect("two days").remove(0).0;
    assert_eq!(first.len(), 2);
    for session in &first {
        assert_eq!(session.payload_kg, 0.0);
        assert_eq!(session.joints.len(), 4);
        for joint in &session.joints {
            let offset = joint.offset_rad.expect("a check can tell").scaled(1e3);
            let (error, half) = (offset.mean - 1e3 * joint.truth_rad, offset.half_width_95());
            // Half a milliradian for the drift that a single session cannot identify.
            assert!(error.abs() < half + 0.5, "{session:?}");
        }
    }
    // Stopped in the middle of a line.
    let text = std::fs::read_to_string(&path).expect("a file");
    assert_eq!(text.lines().count(), 3);
    std::fs::write(&path, &text[..text.len() - 100]).expect("written");
    let again = lived(&chain, 2).expect("gone on").remove(0).0;
    assert_eq!(again, first);
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), text);
    // Files of another robot, of another estimator, or of a robot with another description are rejected.
    let refused = |from: &str, to: &str, reason: &str| {
        let other = text.replace(from, to);
        assert!(other != text, "{from}");
        std::fs::write(&path, &other).expect("written");
        let refused = lived(&chain, 2).expect_err(reason).to_string();
        assert!(refused.contains(reason), "{refused}");
        assert_eq!(std::fs::read_to_string(&path).expect("a file"), other);
    };
    let now = text.split_once("\"version\":").expect("a version").1;
    let now = &now[..now.find(|c: char| !c.is_ascii_digit()).expect("its end")];
    refused(
        &format!("\"version\":{now}"),
        "\"version\":1",
        &format!("estimator 1, now {now}"),
    );
    let (_, description) = text.split_once("\"description\":\"").expect("a checksum");
    refused(
        &description[..16],
        "0123456789abcdef",
        "another description",
    );
    std::fs::write(&path, &text).expect("written");
    chain.kind = SessionKind::Work;
    let refused = lived(&chain, 2).expect_err("other sessions").to_string();
    assert!(refused.contains("check sessions"), "{refused}");
    std::fs::write(&path, "time,joint\n1,2\n").expect("written");
    let refused = lived(&chain, 2).expect_err("no sessions").to_string();
    assert!(refused.contains("is not a file of"), "{refused}");
    assert_eq!(
        std::fs::read_to_string(&path).expect("still there"),
        "time,joint\n1,2\n"
    );
}

#[test]
fn chain_work_session_with_unknown_payload_covers_truth() {
    let work = ChainRequest::new(SessionKind::Work);
    let (sessions, year) = lived(&work, 2).expect("two days").remove(0);
    assert!(year.tendons.is_empty());
    let carried: Vec<f64> = sessions.iter().map(|s| s.payload_kg).collect();
    assert!(carried[0] != carried[1], "{carried:?}");
    for joint in sessions.iter().flat_map(|s| &s.joints) {
        let Some(offset) = joint.offset_rad.map(|y| y.scaled(1e3)) else {
            continue;
        };
        let (error, half) = (offset.mean - 1e3 * joint.truth_rad, offset.half_width_95());
        assert!(error.abs() < 2.0 * half + 0.5, "{joint:?}");
    }
    // Two sessions are too few for statistics.
    let (errors, failures) = statistics(&[sessions]);
    assert_eq!(errors[0].robots, 0);
    assert_eq!(errors[0].sessions, 2);
    assert!(failures.is_empty());
}

/// Sessions with specified errors.
fn made(fails: Option<usize>) -> Vec<Session> {
    use sinew_bench::year::chain::SessionJoint;
    (1..=40)
        .map(|day| {
            let warm = 6.0 * (0.3 * day as f64).sin();
            let lost = f64::from(u8::from(fails.is_some_and(|f| day >= f)));
            let left = if day % 2 == 0 { 0.1 } else { -0.1 };
            let truth = 0.05 * day as f64 + 3.0 * lost;
            Session {
                seed: 1,
                day,
                true_temperature_c: 21.0 + warm,
                temperature_c: 21.0 + warm,
                payload_kg: 0.0,
                rejected_share: 0.0,
                joints: vec![SessionJoint {
                    name: "elbow".into(),
                    truth_rad: 1e-3 * truth,
                    offset_rad: Some(Gaussian::new(
                        1e-3 * (truth + 0.4 - 0.2 * warm + left + 2.0 * lost),
                        1e-3 / Z95,
                    )),
                    systematic_error: None,
                    true_stiffness_ratio: -0.06 * lost,
                    stiffness_ratio: Gaussian::new(0.01 * (0.1 * warm - 1.5 * lost), 0.02 / Z95),
                    steps: 0,
                }],
            }
        })
        .collect()
}

#[test]
fn statistics_recover_specified_errors() {
    let (errors, failures) = statistics(&[made(None), made(None)]);
    let e = &errors[0];
    assert_eq!((e.robots, e.sessions), (2, 80));
    // A mean over days that are not quite symmetric in temperature: 0.4 − 0.2 · mean(warm).
    let mean = (1..=40)
        .map(|d| 6.0 * (0.3 * f64::from(d)).sin())
        .sum::<f64>()
        / 40.0;
    assert!(
        (1e3 * e.bias_rad.unwrap() - (0.4 - 0.2 * mean).abs()).abs() < 0.02,
        "{e:?}"
    );
    assert!(
        (1e3 * e.drift_rad_per_k.unwrap() - 0.2).abs() < 0.01,
        "{e:?}"
    );
    assert!((1e3 * e.scatter_rad.unwrap() - 0.1).abs() < 0.01, "{e:?}");
    assert!((e.correlation[0].correlation + 1.0).abs() < 0.05, "{e:?}");
    assert!(
        (100.0 * e.stiffness_drift_ratio_per_k.unwrap() - 0.1).abs() < 1e-9,
        "{e:?}"
    );
    assert!(failures.is_empty());
    let (errors, failures) = statistics(&[made(Some(21))]);
    // Nothing after the failure counts as the session's error.
    assert_eq!(errors[0].sessions, 20);
    let f = &failures[0];
    assert!((1e3 * f.size_rad - 3.05).abs() < 1e-9, "{f:?}");
    assert!((100.0 * f.lost_ratio - 6.0).abs() < 1e-9, "{f:?}");
    // Ten sessions on either side of what also drifts: the sums are exact.
    let warm = |d: usize| 6.0 * (0.3 * d as f64).sin();
    let turn = ((21..31).map(warm).sum::<f64>() - (11..21).map(warm).sum::<f64>()) / 10.0;
    assert!(
        (1e3 * f.estimated_rise_rad - 5.05 + 0.2 * turn).abs() < 1e-9,
        "{f:?}"
    );
    assert!(
        (100.0 * f.estimated_loss_ratio - 1.5 + 0.1 * turn).abs() < 1e-9,
        "{f:?}"
    );
}
