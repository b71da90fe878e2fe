//! Golden list of the texts of this crate: reasons for which a command or a configuration is rejected, and for which
//! the stored state is ignored.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-watch-core messages` rewrites `tests/golden/messages.txt`. The texts of alarms,
//! journal and states are listed by `sinew-watch`.

use crate::MonitorError;
use crate::command::{CommandError, MAX_SHELF_S};
use crate::journal::STATE_OF_ANOTHER_ROBOT;
use std::path::Path;

/// Path of the list.
const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/messages.txt");

/// Returns one error of every kind; a new kind does not compile without a name here.
fn command_errors() -> Vec<CommandError> {
    let all = vec![
        CommandError::Joint {
            joint: "knee".into(),
            available: "shoulder, elbow".into(),
        },
        CommandError::NoJoints {
            available: "shoulder, elbow".into(),
        },
        CommandError::NoIncident {
            joint: "elbow".into(),
        },
        CommandError::NoEntry { entry: 3 },
        CommandError::TooLate {
            entry: 3,
            most: 2000,
        },
        CommandError::Date {
            time_utc_s: 1_793_606_400.0,
            after_utc_s: 1_793_610_000.0,
            recorded_utc_s: 1_793_613_600.0,
        },
        CommandError::NoAlarm,
        CommandError::Shelf {
            for_s: MAX_SHELF_S + 1.0,
        },
        CommandError::StillActive,
        CommandError::NoNote,
        CommandError::NoName,
        CommandError::TooLong {
            field: "note",
            length: 4001,
            most: 4000,
        },
    ];
    let position = |error: &CommandError| match error {
        CommandError::Joint { .. } => 0,
        CommandError::NoJoints { .. } => 1,
        CommandError::NoIncident { .. } => 2,
        CommandError::NoEntry { .. } => 3,
        CommandError::TooLate { .. } => 4,
        CommandError::Date { .. } => 5,
        CommandError::NoAlarm => 6,
        CommandError::Shelf { .. } => 7,
        CommandError::StillActive => 8,
        CommandError::NoNote => 9,
        CommandError::NoName => 10,
        CommandError::TooLong { .. } => 11,
    };
    assert!(all.iter().map(position).eq(0..12));
    all
}

/// Returns one error of every kind, except those of the catalogue and of the estimator.
fn monitor_errors() -> Vec<MonitorError> {
    let all = vec![
        MonitorError::Time {
            key: "stretch_s",
            value_s: 5.0,
            must: "20 to 120 s",
        },
        MonitorError::NoTendon,
        MonitorError::AnotherRobot,
    ];
    let position = |error: &MonitorError| match error {
        MonitorError::Time { .. } => 0,
        MonitorError::NoTendon => 1,
        MonitorError::AnotherRobot => 2,
        MonitorError::Catalogue(_) | MonitorError::Baseline(_) => unreachable!("{error}"),
    };
    assert!(all.iter().map(position).eq(0..3));
    all
}

#[test]
fn messages_match_golden() {
    let lines = |errors: Vec<String>| errors.join("\n");
    let commands = command_errors().iter().map(ToString::to_string).collect();
    let monitor = monitor_errors().iter().map(ToString::to_string).collect();
    let list = format!(
        "# Rejected commands\n\n{}\n\n# Invalid configurations of a robot\n\n{}\n\n# Ignored stored state\n\n{STATE_OF_ANOTHER_ROBOT}\n",
        lines(commands),
        lines(monitor)
    );
    let path = Path::new(GOLDEN);
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("writable");
        std::fs::write(path, &list).expect("writable");
    }
    let golden = std::fs::read_to_string(path).unwrap_or_default();
    assert_eq!(list, golden, "rewrite with SINEW_WRITE=1");
}
