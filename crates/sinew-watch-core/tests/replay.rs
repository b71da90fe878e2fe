//! A recording that comes live says what the recording says, to the last digit.

use crate::support::{
    HZ, Watched, biorob_like, config, frames, nothing_happens, recorded, seconds, tensioned,
};
use sinew_estimate::online::{self, OnlineAnswer, Provisional};
use sinew_estimate::session::{self, Learning, SessionOptions};
use sinew_watch_core::snapshot::NotNow;

#[test]
fn a_session_s_record_is_what_estimate_says_of_the_recording() {
    let robot = biorob_like();
    let all = frames(&robot, 41, 110.0, |text| text);
    let (a, b) = all.split_at(60 * 250);
    let (baseline, _) =
        session::learn_recorded(&robot, &recorded(&robot, a), "A", &Learning::default()).unwrap();
    let options = SessionOptions::default();
    let b_recorded = recorded(&robot, b);
    let with = Some((&baseline, "A"));
    let (said, next) =
        session::estimate_recorded(&robot, &b_recorded, "B", with, &options).unwrap();

    let mut config = config(&robot);
    config.baseline = Some(baseline);
    let mut watched = Watched::new(config);
    watched.play(b);
    watched.monitor.shutdown(watched.now);
    watched.settle();
    let records = &watched.store.records;
    assert_eq!(records.len(), said.joints.len());
    for (record, joint) in records.iter().zip(&said.joints) {
        assert_eq!(record.joint, joint.name);
        assert_eq!(record.offset(), Some(joint.offset_rad), "{record:?}");
        let stiffness = record.stiffness_ratio.zip(record.stiffness_deviation_ratio);
        let change = joint.stiffness_change_ratio;
        assert_eq!(stiffness, Some((change.mean, change.deviation)));
        assert_eq!(record.temperature_c, said.temperature_c);
    }
    // So is what the next session goes on from.
    let belief = watched.store.stored.belief.as_ref().unwrap();
    let kept = belief.baseline.as_ref().unwrap();
    assert_eq!(kept.mean, next.mean);
    assert_eq!(kept.covariance_lower, next.covariance_lower);
}

/// A hose that pulls at the tool is said, and is in no offset.
#[test]
fn a_force_that_stays_is_said_with_its_size() {
    const PULLS_N: [f64; 3] = [0.0, 1.2, 0.0];
    let hose = format!(
        "\n[[contacts]]\nlink = \"tool\"\nstart_s = 60.0\nduration_s = 200.0\nforce_n = {PULLS_N:?}\n"
    );
    let pulled = frames(&biorob_like(), 51, 125.0, |text| {
        nothing_happens(text) + &hose
    });
    for (session, is_pulled) in [(&pulled[60 * HZ..], true), (seconds(60, 120), false)] {
        let mut watched = Watched::new(tensioned());
        watched.play(session);
        watched.now = watched.now.after_s(0.004);
        let snapshot = watched.snapshot();
        assert_eq!(snapshot.external_force.is_some(), is_pulled, "{snapshot:?}");
        for (along, pulls_n) in snapshot
            .external_force
            .iter()
            .flat_map(|f| f.force_n)
            .zip(PULLS_N)
        {
            assert!(along.deviation < 0.1, "{along:?}");
            assert!(
                (along.mean - pulls_n).abs() < 3.0 * along.deviation,
                "{along:?}"
            );
        }
        // Nothing has stretched.
        for tendon in &snapshot.tendons {
            let is_zero = tendon
                .offset_rad
                .is_none_or(|x| x.mean.abs() < 3.0 * x.deviation);
            assert!(is_zero, "{tendon:?}");
        }
    }
}

#[test]
fn the_offsets_of_now_are_the_online_estimate_s() {
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
    let mut watched = Watched::new(config);
    let (mut settled, mut provisional, mut without) = (0, 0, 0);
    for tenth in b.chunks(HZ / 10) {
        watched.play(tenth);
        // The next frame comes a sample later.
        watched.now = watched.now.after_s(0.004);
        watched.tick();
        let tendons = watched.snapshot().tendons;
        let offsets = |answer: &OnlineAnswer| -> Vec<_> {
            let joints = answer.joints.iter();
            joints.map(|own| Some(own.offset_rad)).collect()
        };
        let shown: Vec<_> = tendons.iter().map(|tendon| tendon.offset_rad).collect();
        if shown.iter().all(Option::is_some) {
            let same = answers.iter().find(|answer| offsets(answer) == shown);
            let same = same.expect("an answer of the replay");
            for (tendon, own) in tendons.iter().zip(&same.joints) {
                assert_eq!(tendon.provisional.is_some(), own.provisional.is_some());
                let unknown_rad = Some(own.unknown_temperature_rad).filter(|added| *added > 0.0);
                assert_eq!(tendon.unknown_temperature_rad, unknown_rad);
                match tendon.provisional {
                    None => settled += 1,
                    Some(Provisional::Step { since_s, .. }) => {
                        let ago_s = watched.now.utc_s() - since_s;
                        assert!((0.0..20.0).contains(&ago_s), "{ago_s}");
                        provisional += 1;
                    }
                    Some(_) => provisional += 1,
                }
            }
        }
        for tendon in tendons.iter().filter(|tendon| tendon.offset_rad.is_none()) {
            let can_not_tell = |why| matches!(why, NotNow::Starting | NotNow::CannotTell { .. });
            assert!(tendon.reason.is_some_and(can_not_tell), "{tendon:?}");
            without += 1;
        }
    }
    println!("{settled} settled, {provisional} provisional, {without} without");
    assert!(settled > 1000 && provisional > 20 && without > 20);
}

/// Blocks that no job has taken for ten seconds: the answer of before is none of now.
#[test]
fn an_answer_that_is_late_is_not_shown() {
    let mut watched = Watched::new(tensioned());
    watched.play(seconds(60, 80));
    let offsets = |watched: &Watched| {
        let tendons = watched.snapshot().tendons;
        tendons.iter().filter(|t| t.offset_rad.is_some()).count()
    };
    assert!(offsets(&watched) > 0);
    for frame in seconds(80, 92) {
        watched.now = watched.now.after_s(1.0 / HZ as f64);
        watched.monitor.frame(frame, watched.now);
        watched.monitor.tick(watched.now);
    }
    assert_eq!(offsets(&watched), 0);
    let reason = watched.snapshot().tendons[0].reason;
    assert_eq!(reason, Some(NotNow::Starting));
    watched.tick();
    assert!(offsets(&watched) > 0);
}
