//! Comparison of groups of tendons: significant differences, inconclusive and confounded groups.

use crate::support::tendons::{scatter, tendon};
use crate::support::{open, session, source, write};
use sinew_fleet::FleetError;
use sinew_fleet::args::{By, Compare};
use sinew_fleet::compare::{Comparison, CreepUnit, Factor, Group, Verdict, compare, compared};
use sinew_fleet::creep::Ages;
use sinew_fleet::gather::{CreepingTendon, FleetTable};
use std::path::Path;

const AGES: Ages = Ages {
    from_days: 1.0,
    to_days: 30.0,
};

fn request(folder: &Path, by: By) -> Compare {
    Compare {
        source: source(folder),
        by,
        robots: Vec::new(),
        ages: AGES,
        least: 0.05,
        seed: 1,
        csv: None,
    }
}

fn found(tendons: Vec<CreepingTendon>, by: By) -> Comparison {
    let gathered = FleetTable {
        tendons,
        ..FleetTable::default()
    };
    compared(&gathered, &request(Path::new("."), by)).unwrap()
}

fn group<'c>(found: &'c Comparison, name: &str) -> &'c Group {
    found.groups.iter().find(|g| g.key.name == name).unwrap()
}

/// Four batches of 60 at two sites; the third creeps by `factor` as much.
fn batches(factor: f64) -> Vec<CreepingTendon> {
    (0..240)
        .map(|i| {
            let batch = ["a", "b", "c", "d"][i % 4];
            let site = ["hall", "yard"][i / 4 % 2];
            tendon(i, batch, site, if batch == "c" { factor } else { 1.0 })
        })
        .collect()
}

#[test]
fn compare_worse_batch_is_found_with_ratio() {
    let found = found(batches(1.7), By::Batch);
    let names: Vec<&str> = found.worse().map(|g| g.key.name.as_str()).collect();
    assert_eq!(names, ["c"], "{found:?}");
    let bad = group(&found, "c");
    assert!(bad.ratio[1] < 1.7 && 1.7 < bad.ratio[2], "{bad:?}");
    // 300 µm/m times 1.7, of a typical tendon.
    assert!(bad.creep[1] < 5.1e-4 && 5.1e-4 < bad.creep[2], "{bad:?}");
    assert_eq!((found.unit, found.tendons), (CreepUnit::Strain, 240));
    // Scatter of 40 %.
    assert!((1.35..1.65).contains(&found.tendon_factor), "{found:?}");
}

#[test]
fn compare_equal_batches_are_inconclusive() {
    let found = found(batches(1.0), By::Batch);
    for group in &found.groups {
        assert_eq!(group.verdict, Verdict::Inconclusive, "{group:?}");
        assert!(group.ratio[1] < 1.0 && 1.0 < group.ratio[2], "{group:?}");
    }
}

#[test]
fn compare_batch_of_three_is_inconclusive() {
    let mut tendons = batches(1.0);
    tendons.extend((300..303).map(|i| tendon(i, "e", "hall", 1.6)));
    let found = found(tendons, By::Batch);
    let few = group(&found, "e");
    assert_eq!(few.verdict, Verdict::Inconclusive, "{few:?}");
    let width = |g: &Group| (g.ratio[2] / g.ratio[1]).ln();
    assert!(width(few) > 1.3 * width(group(&found, "a")), "{few:?}");
}

#[test]
fn compare_batch_at_single_site_is_confounded() {
    let mut tendons = batches(1.0);
    tendons.extend((300..360).map(|i| tendon(i, "e", "roof", 2.0)));
    let found = found(tendons, By::Batch);
    let tied = &group(&found, "e").verdict;
    let Verdict::TiedTo(ties) = tied else {
        panic!("{tied:?}");
    };
    assert_eq!(ties[0].0, Factor::SiteOfRope);
    assert!(ties[0].1.contains("roof"), "{ties:?}");
    let confounded = group(&found, "e");
    assert!(
        confounded.ratio[0].is_nan() && confounded.creep[0].is_nan(),
        "{confounded:?}"
    );
    assert_eq!(found.worse().count(), 0);
}

#[test]
fn compare_adjusts_for_site() {
    // Batch c is at the bad site three times of four, the others once of four.
    let tendons = (0..320).map(|i| {
        let batch = ["a", "b", "c", "d"][i % 4];
        let often = i / 4 % 4 != 0;
        let site = if (batch == "c") == often {
            "yard"
        } else {
            "hall"
        };
        tendon(i, batch, site, if site == "yard" { 2.0 } else { 1.0 })
    });
    let found = found(tendons.collect(), By::Batch);
    assert_eq!(found.worse().count(), 0, "{:?}", found.groups);
}

#[test]
fn compare_single_batch_is_alone() {
    let mut tendons = batches(1.0);
    tendons.extend((300..330).map(|i| {
        let mut other = tendon(i, "z", "hall", 3.0);
        other.fit.rope = Some("silk".into());
        other
    }));
    let found = found(tendons, By::Batch);
    assert_eq!(group(&found, "z").verdict, Verdict::Alone);
}

/// Twenty robots whose elbows creep by 4 mrad per decade, those of the second site by 8.
fn records(folder: &Path) {
    let mut rows = Vec::new();
    let (mut robots, mut events) = (
        String::from("robot,site\n"),
        String::from("robot,joint,time_utc_s,event\n"),
    );
    for i in 0..20 {
        let robot = format!("arm-{i:02}");
        let site = ["hall", "yard"][i % 2];
        let rate = 4e-3 * (1.0 + (i % 2) as f64) * (0.1 * scatter(i)).exp();
        robots += &format!("{robot},{site}\n");
        events += &format!("{robot},elbow,1750000000,replaced\n");
        rows.extend((1..=40).map(|day| {
            let mut record = session(&robot, "elbow", day);
            let read = rate * f64::from(day).log10() + 1e-4 * scatter(100 * i + day as usize);
            record.offset_rad = Some(read);
            record
        }));
    }
    write(&folder.join("records/a.parquet"), &rows);
    std::fs::write(folder.join("robots.csv"), robots).unwrap();
    std::fs::write(folder.join("events.csv"), events).unwrap();
}

#[test]
fn compare_without_robot_type_uses_offset() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path());
    let found = compare(&mut open(folder.path()), &request(folder.path(), By::Site)).unwrap();
    assert_eq!(found.unit, CreepUnit::Offset);
    let yard = group(&found, "yard");
    assert_eq!((yard.tendons, yard.robots), (10, 10));
    assert_eq!(yard.verdict, Verdict::Worse, "{yard:?}");
    assert!((7e-3..9e-3).contains(&yard.creep[0]), "{yard:?}");
    assert!(yard.ratio[1] < 2.0 && 2.0 < yard.ratio[2], "{yard:?}");
}

#[test]
fn compare_unspecified_batches_is_error() {
    let folder = tempfile::tempdir().unwrap();
    records(folder.path());
    let result = compare(&mut open(folder.path()), &request(folder.path(), By::Batch));
    let Err(FleetError::NoGroups {
        groups, tendons, ..
    }) = &result
    else {
        panic!("{result:?}");
    };
    assert_eq!((*groups, *tendons), (0, 20));
    let mut old = request(folder.path(), By::Site);
    old.ages = Ages {
        from_days: 100.0,
        to_days: 300.0,
    };
    let result = compare(&mut open(folder.path()), &old);
    assert!(matches!(
        result,
        Err(FleetError::NoGroups {
            tendons: 0,
            too_few: 20,
            ..
        })
    ));
}
