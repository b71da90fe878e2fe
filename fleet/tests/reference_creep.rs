//! Reference creep: recovery of simulated values, and its effect on forecasts of new robots.

use crate::support::tendons::tendon;
use crate::support::{cut, open, repository, small, source};
use sinew_fleet::args::{Due, Pool, Simulate};
use sinew_fleet::due::{TrackedTendon, due};
use sinew_fleet::pool::command;
use sinew_fleet::pool::creep::{learn, reference_creeps};
use sinew_fleet::reference_creep::{CreepKind, ReferenceCreeps, read, write};
use sinew_fleet::simulate::simulate;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Kind of elbows of a batch, or of any batch.
fn elbows(batch: Option<&str>) -> CreepKind {
    CreepKind {
        robot_type: "arm".into(),
        joint: "elbow".into(),
        rope: Some("hemp".into()),
        batch: batch.map(str::to_owned),
        site: None,
    }
}

#[test]
fn reference_creep_of_batch_and_of_any_batch() {
    // 300 µm/m per decade, 40 % from tendon to tendon, 6 mrad on this pulley; one batch of five creeps twice as much.
    let of = |i: usize| {
        let (batch, factor) = (
            ["a", "b", "c", "d", "bad"][i % 5],
            [1.0, 1.0, 1.0, 1.0, 2.0][i % 5],
        );
        tendon(i, batch, "hall", factor)
    };
    let tendons: Vec<_> = (0..300).map(of).collect();
    let found = reference_creeps(&tendons).unwrap();
    let [good, bad, any] = [Some("a"), Some("bad"), None].map(|batch| found[&elbows(batch)]);
    assert!((good.median_rad / 6e-3).ln().abs() < 0.15, "{good:?}");
    assert!((bad.median_rad / 12e-3).ln().abs() < 0.2, "{bad:?}");
    assert!((0.3..0.5).contains(&good.spread), "{good:?}");
    // ln 2 in one of five: 0.31 between batches.
    assert!(
        any.spread > good.spread + 0.05 && any.spread < 0.65,
        "{any:?}"
    );
    assert!(any.median_rad > good.median_rad && any.median_rad < bad.median_rad);
    assert_eq!((bad.tendons, any.tendons), (60, 300));
    let here = CreepKind {
        site: Some("hall".into()),
        ..elbows(None)
    };
    assert_eq!(found[&here], any);
}

/// A robot type without known ropes, whose tendons exceed no limit.
fn unknown_ropes(folder: &Path) -> PathBuf {
    let from = repository("robots/biorob-like");
    let to = folder.join("biorob-like");
    std::fs::create_dir(&to).unwrap();
    std::fs::copy(from.join("biorob-like.urdf"), to.join("biorob-like.urdf")).unwrap();
    let text = std::fs::read_to_string(from.join("robot.toml")).unwrap();
    let line = |line: &str| match line.starts_with("retension_at_mm = ") {
        true => "retension_at_mm = 100.0".to_owned(),
        false => line.to_owned(),
    };
    let text: Vec<String> = text.lines().map(line).collect();
    std::fs::write(to.join("robot.toml"), text.join("\n")).unwrap();
    to
}

/// Removes the ropes from the description of a fleet.
fn forget_ropes(folder: &Path) {
    let path = folder.join("types/biorob-like/robot.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let kept: Vec<&str> = text.lines().filter(|l| !l.starts_with("rope = ")).collect();
    assert!(kept.len() < text.lines().count());
    std::fs::write(&path, kept.join("\n")).unwrap();
    std::fs::remove_file(folder.join("tendons.csv")).unwrap();
}

/// True offsets on the last day, of tendons without a failed strand, rad.
fn truth(folder: &Path) -> BTreeMap<(String, String), f64> {
    let text = std::fs::read_to_string(folder.join("truth/tendons.csv")).unwrap();
    let rows = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>());
    rows.filter(|cell| cell[7].is_empty())
        .map(|cell| ((cell[0].into(), cell[1].into()), cell[4].parse().unwrap()))
        .collect()
}

#[test]
fn reference_creep_round_trip_improves_forecast() {
    let folder = tempfile::tempdir().unwrap();
    let [old, new, file] = ["old", "new", "creep.csv"].map(|name| folder.path().join(name));
    let robot = unknown_ropes(folder.path());
    for (out, robots, seed) in [(&old, 20, 1), (&new, 8, 2)] {
        let request = Simulate {
            robot: robot.clone(),
            seed,
            ..small(out, robots, 40)
        };
        simulate(&request).unwrap();
        forget_ropes(out);
    }
    let pool = Pool {
        folder: old.clone(),
        robot: old.join("types/biorob-like"),
        creep: true,
        out: file.clone(),
    };
    command(&pool).unwrap();
    let learned: ReferenceCreeps = learn(&pool).unwrap().0;
    assert_eq!(read(&file).unwrap(), learned);
    let any = learned.keys().filter(|k| k.site.is_none());
    assert_eq!(any.count(), 4, "{learned:?}");
    let truth = truth(&new);
    cut(&new, 30.0);
    // Median error of the medians, rad; number of intervals that cover the truth; number of tendons.
    let forecast = |creep: Option<&Path>, within_days: f64| {
        let request = Due {
            source: source(&new),
            robots: Vec::new(),
            within_days,
            rows: 40,
            csv: None,
            state: None,
            creep: creep.map(Path::to_owned),
            follow_all: true,
        };
        let list = due(&mut open(&new), &request).unwrap();
        let ahead = |f: &TrackedTendon| {
            let true_rad = *truth.get(&(f.robot.clone(), f.joint.clone()))?;
            let ahead = f.ahead?;
            let within = ahead.interval_95_rad;
            let is_within = (within.low..=within.high).contains(&true_rad);
            Some(((ahead.offset_rad - true_rad).abs(), is_within))
        };
        let found: Vec<(f64, bool)> = list.followed.iter().filter_map(ahead).collect();
        assert!(found.len() >= 25, "{list:?}");
        let begun = creep.map_or(0, |_| list.followed.len());
        assert_eq!(list.with_reference_creep, begun);
        let mut off: Vec<f64> = found.iter().map(|f| f.0).collect();
        off.sort_by(f64::total_cmp);
        let held = found.iter().filter(|f| f.1).count();
        (off[off.len() / 2], held, found.len())
    };
    // Any rope of the catalogue is a good initial guess here; the reference creep is no worse.
    let (without, with) = (forecast(None, 30.0), forecast(Some(&file), 30.0));
    assert!(with.0 < 1.1 * without.0, "{with:?} {without:?}");
    assert!(
        with.1 + 1 >= without.1 && with.1 >= 25,
        "{with:?} {without:?}"
    );
    // A reference ten times as fast, 2.5 of its standard deviations, dominates two days of sessions, and ten days outweigh it.
    let mut wrong = learned.clone();
    wrong
        .values_mut()
        .for_each(|creep| creep.median_rad *= 10.0);
    write(&wrong, &file).unwrap();
    let outweighed = forecast(Some(&file), 30.0);
    assert!(outweighed.0 < 1.1 * with.0, "{outweighed:?} {with:?}");
    assert!(outweighed.1 >= 25, "{outweighed:?}");
    cut(&new, 8.0);
    let misled = forecast(Some(&file), 38.0);
    write(&learned, &file).unwrap();
    let with = forecast(Some(&file), 38.0);
    assert!(misled.0 > 2.0 * with.0, "{misled:?} {with:?}");
}

#[test]
fn reference_creep_invalid_table_names_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("creep.csv");
    let head = "robot_type,joint,rope,batch,site,creep_rad_per_decade,creep_spread_ln,from_days,to_days,tendons\n";
    for (row, message) in [
        (
            "arm,elbow,hemp,,,-0.001,0.5,1,30,40",
            "line 2, column 'creep_rad_per_decade'",
        ),
        // In mrad.
        (
            "arm,elbow,hemp,,,2.5,0.5,1,30,40",
            "must be between 0.000000001 and 1",
        ),
        (
            "arm,elbow,hemp,,,0.001,,1,30,40",
            "'creep_spread_ln' is empty",
        ),
        ("arm,elbow,hemp,,,0.001,0.5,30,1,40", "column 'to_days'"),
        (
            "arm,elbow,,,,0.001,0.5,1,30,40\narm,elbow,,,,0.002,0.5,1,30,40",
            "line 3",
        ),
    ] {
        std::fs::write(&file, format!("{head}{row}\n")).unwrap();
        let error = read(&file).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}
