//! SQL functions of Sinew agree with the commands.

use crate::support::{cells, fleet, open, session, source, write};
use sinew_fleet::FleetError;
use sinew_fleet::args::Due;
use sinew_fleet::due::due;
use sinew_fleet::engine::Engine;

const DAY_S: f64 = 86_400.0;

fn number(text: &str) -> Option<f64> {
    (!text.is_empty()).then(|| text.parse().unwrap())
}

fn error_of(engine: &mut Engine, sql: &str) -> FleetError {
    engine.query(sql).unwrap_err()
}

#[test]
fn elongation_requires_robot_type() {
    let folder = tempfile::tempdir().unwrap();
    fleet(folder.path(), 3, 30);
    write(
        &folder.path().join("other.parquet"),
        &[session("x", "elbow", 3)],
    );
    let sql = "SELECT count(mm), count(*) - count(mm), max(abs(mm - 1000 * elongation_m)) < 1e-9 FROM (SELECT \
               elongation_m, sinew_elongation_mm(offset_rad, robot_type, joint) AS mm FROM records \
               WHERE offset_rad IS NOT NULL)";
    let mut engine = open(folder.path());
    let described = "SELECT count(*) FROM records WHERE robot <> 'x' AND offset_rad IS NOT NULL";
    let described = cells(&mut engine, described)[0][0].clone();
    assert!(described.parse::<u32>().unwrap() > 100);
    assert_eq!(
        cells(&mut engine, sql),
        [[described, "1".into(), "true".into()]]
    );
}

#[test]
fn trend_functions_match_due() {
    let folder = tempfile::tempdir().unwrap();
    fleet(folder.path(), 2, 90);
    let request = Due {
        source: source(folder.path()),
        robots: Vec::new(),
        within_days: 30.0,
        rows: 40,
        csv: None,
        state: None,
        creep: None,
        follow_all: true,
    };
    let mut engine = open(folder.path());
    let list = due(&mut engine, &request).unwrap();
    let sql = "SELECT robot, joint, t.offset_rad, t.offset_std_rad, t.last_utc_s, d.days, \
               d.days_low, d.days_high, d.limit FROM (SELECT r.robot AS robot, r.joint AS joint, sinew_trend(r.*) AS t, \
               sinew_days_until(r.*) AS d FROM records r GROUP BY r.robot, r.joint)";
    let rows = cells(&mut engine, sql);
    assert_eq!(rows.len(), list.followed.len());
    let mut dated = 0;
    for found in &list.followed {
        let row = rows
            .iter()
            .find(|r| r[0] == found.robot && r[1] == found.joint);
        let numbers: Vec<Option<f64>> = row.unwrap()[2..8].iter().map(|t| number(t)).collect();
        let offset = found.offset_rad;
        assert_eq!(numbers[..2], [Some(offset.mean), Some(offset.std)]);
        assert_eq!(numbers[2], Some(found.last_utc_s));
        for (days, at) in numbers[3..].iter().zip(found.worst().unwrap().at_utc_s) {
            let expected = at.map(|at| (at - found.last_utc_s) / DAY_S);
            assert_eq!(*days, expected);
            dated += usize::from(at.is_some());
        }
    }
    assert!(dated > 0, "no limit is near: this shows nothing");
}

#[test]
fn days_until_increase_with_limit() {
    let folder = tempfile::tempdir().unwrap();
    fleet(folder.path(), 1, 60);
    let mut engine = open(folder.path());
    let days = |limit_mm: &str| {
        format!(
            "SELECT d.state, d.days FROM (SELECT sinew_days_until({limit_mm}, *) AS d FROM records WHERE joint = \
             'elbow' GROUP BY robot, joint)"
        )
    };
    let [small] = &cells(&mut engine, &days("0.0001"))[..] else {
        panic!("one tendon");
    };
    assert_eq!(small[0], "passed");
    let [large] = &cells(&mut engine, &days("50"))[..] else {
        panic!("one tendon");
    };
    assert_eq!(large[0], "not-within-horizon");
    let none = error_of(&mut engine, &days("0"));
    assert!(matches!(none, FleetError::NoLimit { .. }), "{none}");
}

#[test]
fn trend_of_several_tendons_is_error() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [session("a", "elbow", 1), session("a", "wrist", 1)];
    write(&folder.path().join("1.parquet"), &rows);
    let mut engine = open(folder.path());
    let several = error_of(&mut engine, "SELECT sinew_trend(*) FROM records");
    assert!(
        matches!(several, FleetError::SeveralTendons { .. }),
        "{several}"
    );
    assert!(
        several.to_string().contains("GROUP BY robot, joint"),
        "{several}"
    );
    let usage = error_of(&mut engine, "SELECT sinew_trend(offset_rad) FROM records");
    assert!(matches!(usage, FleetError::Usage { .. }), "{usage}");
}

#[test]
fn function_of_text_column_names_type() {
    let folder = tempfile::tempdir().unwrap();
    write(
        &folder.path().join("1.parquet"),
        &[session("a", "elbow", 1)],
    );
    let mut engine = open(folder.path());
    for sql in [
        "SELECT sum(robot) FROM records",
        "SELECT avg(r.robot) FROM records r",
    ] {
        let error = error_of(&mut engine, sql);
        let FleetError::WrongType { column, .. } = &error else {
            panic!("{error:?}");
        };
        assert_eq!(column, "robot");
    }
    // What a function takes is no fault of it.
    let other = error_of(&mut engine, "SELECT max(robot), nothing FROM records");
    assert!(matches!(other, FleetError::NoColumn { .. }), "{other:?}");
}

#[test]
fn invalid_robot_type_fails_own_functions_only() {
    let folder = tempfile::tempdir().unwrap();
    write(
        &folder.path().join("1.parquet"),
        &[session("a", "elbow", 1)],
    );
    std::fs::create_dir_all(folder.path().join("types/arm")).unwrap();
    std::fs::write(folder.path().join("types/arm/robot.toml"), "no robot").unwrap();
    let mut engine = open(folder.path());
    assert_eq!(cells(&mut engine, "SELECT count(*) FROM records"), [["1"]]);
    let sql = "SELECT sinew_elongation_mm(offset_rad, robot_type, joint) FROM records";
    let error = error_of(&mut engine, sql);
    assert!(matches!(error, FleetError::Robot(_)), "{error:?}");
}
