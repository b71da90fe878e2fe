//! Export of the lifetimes of ropes, the table that `sinew trend survival` reads.

use super::StoreError;
use super::read::{Reader, RecordQuery, document};
use sinew_log::{Cell, CellKind, TableWriter};
use sinew_watch_core::command::CommandKind;
use sinew_watch_core::incident::Finding;
use sinew_watch_core::journal::{Entry, Event, Maintenance};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Columns of the table: docs/src/reference/sessions.md.
const LIVES: [(&str, CellKind); 5] = [
    ("unit", CellKind::Text),
    ("group", CellKind::Text),
    ("age_hours", CellKind::Number),
    ("end", CellKind::Text),
    ("installed", CellKind::Number),
];
/// Tolerance of the time of an entry that is compared with its copy in a correction, s: a numerical bound.
const SAME_TIME_S: f64 = 1e-3;

/// Event in the life of a rope.
#[derive(Debug, Clone, Copy)]
struct Moment {
    /// Time of the event, s since 1970 UTC.
    utc_s: f64,
    /// Duration of motion of the robot in the sessions before its entry, s.
    motion_s: f64,
}

/// Recorded replacements and rope failures of a robot.
#[derive(Debug, Default)]
struct Repairs {
    /// Duration of motion in the sessions of the journal so far, s.
    motion_s: f64,
    /// Replacements in the order of their entries: the entry as recorded, and with its corrections.
    replaced: Vec<(Moment, Maintenance)>,
    /// Beginnings of the incidents, by joint and number.
    begun: BTreeMap<(String, u64), Moment>,
    /// Joint and number of the incidents whose finding is a failed strand or rope.
    failed: BTreeSet<(String, u64)>,
}

impl Repairs {
    /// Adds an entry of the journal, in the order of the entries.
    fn add(&mut self, entry: Entry) {
        let motion_s = self.motion_s;
        match entry.event {
            Event::Session { duration_s, .. } => self.motion_s += duration_s,
            Event::Command { command } => {
                if let CommandKind::Replaced { joints } = command.what {
                    let entered = Moment {
                        utc_s: entry.time_utc_s,
                        motion_s,
                    };
                    let recorded = Maintenance {
                        number: 0,
                        joints,
                        replaced: true,
                        time_utc_s: entry.time_utc_s,
                        recorded_utc_s: entry.time_utc_s,
                        after_utc_s: None,
                        who: command.who,
                        correction: None,
                    };
                    self.replaced.push((entered, recorded));
                }
            }
            Event::Maintenance { maintenance } => {
                let is_same = |(entered, _): &&mut (Moment, Maintenance)| {
                    (entered.utc_s - maintenance.recorded_utc_s).abs() < SAME_TIME_S
                };
                let of_entry = self.replaced.iter_mut().find(is_same);
                if let Some((_, own)) = of_entry.filter(|_| maintenance.replaced) {
                    *own = maintenance;
                }
            }
            Event::Incident { incident } => {
                let begun = Moment {
                    utc_s: incident.opened_utc_s,
                    motion_s,
                };
                let key = (incident.joint, incident.number);
                self.begun.entry(key.clone()).or_insert(begun);
                match incident.finding {
                    Some(Finding::StrandFailure) => {
                        self.failed.insert(key);
                    }
                    // Another finding corrects an earlier one.
                    Some(_) => {
                        self.failed.remove(&key);
                    }
                    None => {}
                }
            }
            _ => {}
        }
    }

    /// Returns the replacements of the rope of a joint in chronological order.
    fn installed(&self, joint: &str) -> Vec<Moment> {
        let own = self.replaced.iter().filter(|(_, entry)| {
            !entry.is_withdrawn() && entry.joints.iter().any(|name| name == joint)
        });
        let dated = own.map(|(entered, entry)| Moment {
            utc_s: entry.time_utc_s,
            ..*entered
        });
        let mut all: Vec<Moment> = dated.collect();
        all.sort_by(|a, b| a.utc_s.total_cmp(&b.utc_s));
        all
    }

    /// Returns the first failure of the rope of a joint between two times, s since 1970 UTC.
    fn failed_within(&self, joint: &str, from_utc_s: f64, to_utc_s: f64) -> Option<Moment> {
        let own = self.failed.iter().filter(|(name, _)| name == joint);
        let begun = own.filter_map(|key| self.begun.get(key).copied());
        begun
            .filter(|begun| (from_utc_s..to_utc_s).contains(&begun.utc_s))
            .min_by(|a, b| a.utc_s.total_cmp(&b.utc_s))
    }
}

/// Writes the lifetimes of ropes as the table for `sinew trend survival`; returns their number.
///
/// A rope has a row if its installation is in the journal as a replacement, and it moved since: the age of a rope that was
/// installed before is not known. The age is the duration of motion in the sessions of the journal, h, which does not depend
/// on whether the records of the sessions were thinned. A rope ends as `broken` at the incident whose finding is a failed
/// strand or rope, as `replaced` at its replacement without such a finding, and is `running` otherwise; the last two are
/// censored.
///
/// # Errors
/// Returns a [`StoreError`] if reading or writing fails; no file remains.
pub fn write_lives(reader: &Reader, query: &RecordQuery, path: &Path) -> Result<u64, StoreError> {
    let columns: Vec<_> = LIVES.map(|(name, kind)| (name.to_owned(), kind)).into();
    let mut writer = TableWriter::create(path, &columns)?;
    let robots = reader.robots()?.into_iter();
    let mut count = 0;
    for robot in robots.filter(|name| query.robot.as_ref().is_none_or(|robot| robot == name)) {
        let (robot_type, repairs) = reader.repairs(&robot)?;
        let joints = repairs.replaced.iter().flat_map(|(_, entry)| &entry.joints);
        for joint in joints.collect::<BTreeSet<_>>() {
            let installed = repairs.installed(joint);
            let next = installed.iter().copied().skip(1).map(Some).chain([None]);
            for (from, replaced) in installed.iter().copied().zip(next) {
                let to_utc_s = replaced.map_or(f64::INFINITY, |at| at.utc_s);
                let failed = repairs.failed_within(joint, from.utc_s, to_utc_s);
                let end = match (failed, replaced) {
                    (Some(_), _) => "broken",
                    (None, Some(_)) => "replaced",
                    (None, None) => "running",
                };
                let to = failed.or(replaced);
                let motion_s = to.map_or(repairs.motion_s, |at| at.motion_s) - from.motion_s;
                if motion_s > 0.0 {
                    let text = |of: &str| Cell::Text(of.to_owned());
                    writer.row(&[
                        Cell::Text(format!("{robot} {joint}")),
                        text(&robot_type),
                        Cell::Number(motion_s / 3600.0),
                        text(end),
                        Cell::Number(from.utc_s),
                    ])?;
                    count += 1;
                }
            }
        }
    }
    writer.finish()?;
    Ok(count)
}

impl Reader {
    /// Returns the type of a robot with its recorded replacements, rope failures and motion.
    fn repairs(&self, robot: &str) -> Result<(String, Repairs), StoreError> {
        let robot_type = self.connection().query_row(
            "SELECT robot_type FROM robot WHERE name = ?1",
            [robot],
            |row| row.get(0),
        )?;
        let mut repairs = Repairs::default();
        let mut statement = self.connection().prepare_cached(
            "SELECT document FROM journal WHERE robot = ?1
             AND event IN ('command', 'maintenance', 'incident', 'session') ORDER BY id",
        )?;
        let mut rows = statement.query([robot])?;
        while let Some(row) = rows.next()? {
            let text: String = row.get(0)?;
            repairs.add(document("an entry of the journal", robot, &text)?);
        }
        Ok((robot_type, repairs))
    }
}
