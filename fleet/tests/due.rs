//! What is due: the screen rules out no tendon that the whole trend would list, and dates hold against the truth.

use crate::support::{fleet, open, session, source, write};
use sinew_fleet::args::Due;
use sinew_fleet::due::{DueList, due};
use std::collections::BTreeSet;
use std::path::Path;

/// What is asked of a folder.
fn asked(folder: &Path, follow_all: bool) -> Due {
    Due {
        source: source(folder),
        robots: Vec::new(),
        within_days: 30.0,
        rows: 40,
        csv: None,
        follow_all,
    }
}

fn list(folder: &Path, follow_all: bool) -> DueList {
    due(&mut open(folder), &asked(folder, follow_all)).unwrap()
}

fn names(list: &DueList) -> BTreeSet<(String, String)> {
    let due = list.due(30.0);
    due.map(|f| (f.robot.clone(), f.joint.clone())).collect()
}

#[test]
fn the_screen_drops_no_tendon_that_the_whole_trend_lists() {
    let folder = tempfile::tempdir().unwrap();
    let made = fleet(folder.path(), 5, 90);
    let (screened, all) = (list(folder.path(), false), list(folder.path(), true));
    assert_eq!(
        (screened.tendons, all.tendons),
        (made.tendons, made.tendons)
    );
    assert_eq!(all.followed.len(), made.tendons);
    let (listed, whole) = (names(&screened), names(&all));
    assert!(whole.is_subset(&listed), "{:?}", whole.difference(&listed));
    // Else this test would show nothing.
    assert!(
        !whole.is_empty() && screened.out_of_reach > made.tendons / 4,
        "{screened:?}"
    );
    assert_eq!(
        screened.out_of_reach + screened.followed.len(),
        made.tendons
    );
}

#[test]
fn a_tendon_that_has_passed_its_limit_is_listed_first() {
    let folder = tempfile::tempdir().unwrap();
    fleet(folder.path(), 5, 90);
    let list = list(folder.path(), false);
    let truth = std::fs::read_to_string(folder.path().join("truth/tendons.csv")).unwrap();
    let passed: Vec<Vec<&str>> = (truth.lines().skip(1))
        .map(|line| line.split(',').collect::<Vec<_>>())
        .filter(|cell| cell[2] == "passed")
        .collect();
    assert!(!passed.is_empty());
    for cell in passed {
        let found = list
            .due(30.0)
            .any(|f| (f.robot.as_str(), f.joint.as_str()) == (cell[0], cell[1]));
        assert!(found, "{cell:?} is not listed");
    }
    let states: Vec<bool> = (list.due(30.0))
        .map(|f| f.worst().unwrap().is_passed())
        .collect();
    assert!(states.is_sorted_by(|a, b| a >= b), "{states:?}");
}

#[test]
fn robots_of_a_type_nobody_described_are_counted_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<_> = (0..30).map(|day| session("arm-1", "elbow", day)).collect();
    write(&folder.path().join("records/a.parquet"), &rows);
    let list = list(folder.path(), false);
    assert_eq!(
        (list.tendons, list.without_limit, list.followed.len()),
        (1, 1, 0)
    );
    assert_eq!(list.unknown_types, ["arm"]);
}
