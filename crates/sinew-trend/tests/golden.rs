//! Golden test: results of trends and of rope lifetimes, compared exactly.

#[path = "../../sinew-creep/tests/golden/flat.rs"]
mod flat;

use crate::answers::Answers;
use crate::support::{DAY_S, biorob_like, repository, session_record, utc};
use flat::document;
use sinew_rope::{Catalogue, Duty};
use sinew_trend::prior::rope_prior;
use sinew_trend::survival::{EventColumns, LifePrior, analyze_lives, read_lives};
use sinew_trend::{
    Stated, TrendRequest, analyze, analyze_joint, mean_temperature_c, read_sessions, resume_joint,
    sort,
};

const LOG: &str = "date,unit,kind,hall,event\n\
    2024-01-01,a,lift,1,installed\n2024-09-03,a,lift,1,broken\n2024-09-05,a,lift,1,replaced\n\
    2024-01-08,b,lift,1,installed\n2025-02-01,b,lift,1,broken\n2025-02-01,b,lift,1,replaced\n2025-11-11,b,lift,1,broken\n\
    2024-03-01,c,turn,2,installed\n2024-05-01,c,turn,2,oiled\n2025-01-01,c,turn,2,tensioned\n2025-03-01,c,turn,2,broken\n\
    2024-03-01,d,turn,2,painted\n2025-06-01,,turn,2,broken\n2025-06-02,d,turn,2,broken\n2025-08-01,d,turn,2,removed\n";

#[test]
fn months_of_sessions_match_golden() {
    let mut answers = Answers::default();
    let (robot, catalogue) = (biorob_like(), Catalogue::shipped().unwrap());
    let examples = repository().join("examples");
    let events = examples.join("12-survival/events.csv");
    let columns = EventColumns {
        group: Some("robot_type".into()),
        ..EventColumns::default()
    };
    let lives = read_lives(&events, &columns).unwrap();
    document(&mut answers, "lives", &analyze_lives(&lives, "events"));
    let asked = |robot, life| TrendRequest {
        robot,
        catalogue: &catalogue,
        stated: vec![Stated {
            joint: None,
            time_utc_s: utc("2026-03-02"),
            replaced: false,
        }],
        duty: None,
        life,
        horizon_days: 400.0,
        seed: 1,
    };
    let files = [examples.join("10-trend/sessions.csv")];
    let sorted = read_sessions(&files, Some(&robot), None).unwrap();
    let said = analyze(sorted, &asked(Some(&robot), None)).unwrap();
    document(&mut answers, "months", &said);
    // Robot without a description, warmer days, a step change, and a rope lifetime.
    let records = (1..60).map(|day| {
        let t = f64::from(day);
        let jump = if day > 40 { 9.0 } else { 0.0 };
        let mut record =
            session_record(2.0 + t, 2.0 * (1.0 + t).ln() + 0.3 * (7.0 * t).sin() + jump);
        record.temperature_c = Some(21.0 + 4.0 * (t / 9.0).sin());
        record.duration_s = Some(60.0 + t);
        record
    });
    let life = LifePrior::new(&lives, "events", 0.1, 3).unwrap();
    let sorted = sort(records.collect(), None).unwrap();
    let said = analyze(sorted, &asked(None, Some(life))).unwrap();
    document(&mut answers, "days", &said);
    // The same tendon under a specified duty, with its forecast and its limit exceedances.
    let sorted = read_sessions(&files, Some(&robot), None).unwrap();
    let (name, records) = sorted.joints.first().unwrap();
    let mut request = asked(Some(&robot), None);
    request.duty = Some(Duty::constant(75.0, 31.0));
    let (said, times) = analyze_joint(name, records, &request).unwrap();
    document(&mut answers, "duty", &said);
    for (k, times) in times.iter().enumerate() {
        for days in [3.0, 40.0, 200.0] {
            let by = times.probability_by(days * DAY_S).unwrap_or(-1.0);
            answers.probability(&format!("limit {k} passed after {days} days"), by);
        }
    }
    let tendon = robot.transmissions[2].as_ref().unwrap().tendon.as_ref();
    let duty = request.duty.as_ref();
    let rope = rope_prior(tendon, &catalogue, duty, mean_temperature_c(records), 1).unwrap();
    let resumed = resume_joint(name, records, &rope, &request, None).unwrap();
    for days in [0.3, 11.0, 77.7, 399.0, 500.0] {
        document(
            &mut answers,
            &format!("after {days} days"),
            &resumed.offset_after(days * DAY_S),
        );
    }
    // Lifetimes from a log with unclassified texts, rows without a location, and locations observed
    // separately.
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    std::fs::write(&log, LOG).unwrap();
    for (repaired, until) in [(false, None), (true, Some(utc("2026-01-01")))] {
        let columns = EventColumns {
            group: Some("kind".into()),
            monitored: Some("hall".into()),
            until_utc_s: until,
            repaired,
            ..EventColumns::default()
        };
        let lives = read_lives(&log, &columns).unwrap();
        document(&mut answers, "log", &analyze_lives(&lives, "log"));
    }
    answers.hold("golden_months.csv");
}
