//! Live replay of a recording: bitwise identical results.

use crate::support::{
    HZ, Harness, biorob_like, config, frames, recorded, seconds, tensioned, without_events,
};
use sinew_estimate::online::{self, OnlineAnswer, Provisional};
use sinew_estimate::session::{self, Learning, SessionOptions};
use sinew_watch_core::snapshot::NoEstimateReason;

#[test]
fn session_record_equals_offline_estimate() {
    let robot = biorob_like();
    let all = frames(&robot, 41, 110.0, |text| text);
    let (a, b) = all.split_at(60 * 250);
    let (baseline, _) =
        session::learn_recorded(&robot, &recorded(&robot, a), "A", &Learning::default()).unwrap();
    let options = SessionOptions::default();
    let b_recorded = recorded(&robot, b);
    let with = Some((&baseline, "A"));
    let (estimate, next) =
        session::estimate_recorded(&robot, &b_recorded, "B", with, &options).unwrap();

    let mut config = config(&robot);
    config.baseline = Some(baseline);
    let mut harness = Harness::new(config);
    harness.play(b);
    harness.monitor.shutdown(harness.now);
    harness.settle();
    let records = &harness.store.records;
    assert_eq!(records.len(), estimate.joints.len());
    for (record, joint) in records.iter().zip(&estimate.joints) {
        assert_eq!(record.joint, joint.name);
        assert_eq!(record.offset(), Some(joint.offset_rad), "{record:?}");
        let stiffness = record.stiffness_ratio.zip(record.stiffness_std_ratio);
        let change = joint.stiffness_change_ratio;
        assert_eq!(stiffness, Some((change.mean, change.std)));
        assert_eq!(record.temperature_c, estimate.temperature_c);
    }
    // The posterior for the next session is identical too.
    let state = harness.store.stored.state.as_ref().unwrap();
    let kept = state.baseline.as_ref().unwrap();
    assert_eq!(kept.mean, next.mean);
    assert_eq!(kept.covariance_lower, next.covariance_lower);
}

/// A hose at the tool is reported as an external force and does not bias the offsets.
#[test]
fn constant_external_force_is_reported_with_size() {
    const PULLS_N: [f64; 3] = [0.0, 1.2, 0.0];
    let hose = format!(
        "\n[[contacts]]\nlink = \"tool\"\nstart_s = 60.0\nduration_s = 200.0\nforce_n = {PULLS_N:?}\n"
    );
    let pulled = frames(&biorob_like(), 51, 125.0, |text| {
        without_events(text) + &hose
    });
    for (session, is_pulled) in [(&pulled[60 * HZ..], true), (seconds(60, 120), false)] {
        let mut harness = Harness::new(tensioned());
        harness.play(session);
        harness.now = harness.now.after_s(0.004);
        let snapshot = harness.snapshot();
        assert_eq!(snapshot.external_force.is_some(), is_pulled, "{snapshot:?}");
        for (along, pulls_n) in snapshot
            .external_force
            .iter()
            .flat_map(|f| f.force_n)
            .zip(PULLS_N)
        {
            assert!(along.std < 0.1, "{along:?}");
            assert!((along.mean - pulls_n).abs() < 3.0 * along.std, "{along:?}");
        }
        // No tendon is elongated.
        for tendon in &snapshot.tendons {
            let is_zero = tendon.offset_rad.is_none_or(|x| x.mean.abs() < 3.0 * x.std);
            assert!(is_zero, "{tendon:?}");
        }
    }
}

#[test]
fn snapshot_offsets_equal_online_estimate() {
    let robot = biorob_like();
    let all = frames(&robot, 42, 125.0, |text| text);
    let (a, b) = all.split_at(60 * HZ);
    let (baseline, _) =
        session::learn_recorded(&robot, &recorded(&robot, a), "A", &Learning::default()).unwrap();
    let options = SessionOptions::default();
    let mut answers = Vec::new();
    let with = Some((&baseline, "A"));
    online::replay(
        &robot,
        &recorded(&robot, b),
        with,
        &options,
        "B",
        &mut |window| answers.push(window.answer().clone()),
    )
    .unwrap();

    let mut config = config(&robot);
    config.baseline = Some(baseline.clone());
    let mut harness = Harness::new(config);
    let (mut settled, mut provisional, mut without) = (0, 0, 0);
    for tenth in b.chunks(HZ / 10) {
        harness.play(tenth);
        // The next frame arrives one sample period later.
        harness.now = harness.now.after_s(0.004);
        harness.tick();
        let tendons = harness.snapshot().tendons;
        let offsets = |answer: &OnlineAnswer| -> Vec<_> {
            let joints = answer.joints.iter();
            joints.map(|joint| Some(joint.offset_rad)).collect()
        };
        let shown: Vec<_> = tendons.iter().map(|tendon| tendon.offset_rad).collect();
        if shown.iter().all(Option::is_some) {
            let same = answers.iter().find(|answer| offsets(answer) == shown);
            let same = same.expect("an answer of the replay");
            for (tendon, joint) in tendons.iter().zip(&same.joints) {
                assert_eq!(tendon.provisional.is_some(), joint.provisional.is_some());
                let unknown_rad = Some(joint.unknown_temperature_rad).filter(|added| *added > 0.0);
                assert_eq!(tendon.unknown_temperature_rad, unknown_rad);
                match tendon.provisional {
                    None => settled += 1,
                    Some(Provisional::Step { since_s, .. }) => {
                        let ago_s = harness.now.utc_s() - since_s;
                        assert!((0.0..20.0).contains(&ago_s), "{ago_s}");
                        provisional += 1;
                    }
                    Some(_) => provisional += 1,
                }
            }
        }
        for tendon in tendons.iter().filter(|tendon| tendon.offset_rad.is_none()) {
            let is_not_available = |reason| {
                matches!(
                    reason,
                    NoEstimateReason::Starting | NoEstimateReason::Inconclusive { .. }
                )
            };
            assert!(tendon.reason.is_some_and(is_not_available), "{tendon:?}");
            without += 1;
        }
    }
    println!("{settled} settled, {provisional} provisional, {without} without");
    assert!(settled > 1000 && provisional > 20 && without > 20);
}

/// Blocks waiting for 10 s without a job make the answer outdated.
#[test]
fn outdated_answer_is_not_shown() {
    let mut harness = Harness::new(tensioned());
    harness.play(seconds(60, 80));
    let offsets = |harness: &Harness| {
        let tendons = harness.snapshot().tendons;
        tendons.iter().filter(|t| t.offset_rad.is_some()).count()
    };
    assert!(offsets(&harness) > 0);
    for frame in seconds(80, 92) {
        harness.now = harness.now.after_s(1.0 / HZ as f64);
        harness.monitor.frame(frame, harness.now);
        harness.monitor.tick(harness.now);
    }
    assert_eq!(offsets(&harness), 0);
    let reason = harness.snapshot().tendons[0].reason;
    assert_eq!(reason, Some(NoEstimateReason::Starting));
    harness.tick();
    assert!(offsets(&harness) > 0);
}
