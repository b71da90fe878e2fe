//! The page of a fleet agrees with the commands.

use crate::support::{fleet, open, source};
use sinew_fleet::args::Report;
use sinew_fleet::creep::Ages;
use sinew_fleet::report::{command, find};

/// Whether a table has a row with this head and a cell with this text.
fn has_row(html: &str, head: &str, cell: &str) -> bool {
    let (head, cell) = (
        format!("<th scope=\"row\">{head}</th>"),
        format!(">{cell}</td>"),
    );
    let mut rows = html.split("<tr");
    rows.any(|row| row.contains(&head) && row.contains(&cell))
}

#[test]
fn page_counts_match_due_and_compare() {
    let folder = tempfile::tempdir().unwrap();
    let fleet_folder = folder.path().join("fleet");
    fleet(&fleet_folder, 12, 60);
    let request = Report {
        source: source(&fleet_folder),
        out: folder.path().join("fleet.html"),
        robots: Vec::new(),
        weeks: 8,
        state: None,
        ages: Ages {
            from_days: 1.0,
            to_days: 30.0,
        },
        seed: 1,
    };
    command(&request).unwrap();
    let html = std::fs::read_to_string(&request.out).unwrap();
    let found = find(&mut open(&fleet_folder), &request).unwrap();
    let due: Vec<_> = found.due.due(56.0).collect();
    assert!(!due.is_empty(), "nothing is due: this shows nothing");
    for followed in due.iter().take(40) {
        let (robot, joint) = (&followed.robot, &followed.joint);
        assert!(has_row(&html, robot, joint), "{robot}, {joint}");
    }
    for group in found.compared.iter().flatten().flat_map(|c| &c.groups) {
        assert!(html.contains(&group.key.name), "{}", group.key.name);
    }
    let overdue = due
        .iter()
        .filter(|f| f.worst().unwrap().is_passed())
        .count();
    assert!(has_row(&html, "overdue", &overdue.to_string()));
}
