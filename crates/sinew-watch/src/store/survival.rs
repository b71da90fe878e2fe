//! Export of the lifetimes of ropes, the table that `sinew trend survival` reads.

use super::StoreError;
use super::read::{Reader, RecordQuery, document};
use rusqlite::params;
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

/// Recorded replacements and rope failures of a robot.
#[derive(Debug, Default)]
struct Repairs {
    /// Replacements in the order of their entries: time of the entry, and the entry with its corrections.
    replaced: Vec<(f64, Maintenance)>,
    /// Times of the incidents whose finding is a failed strand or rope, by joint and number, s since 1970 UTC.
    failed: BTreeMap<(String, u64), f64>,
}

impl Repairs {
    fn add(&mut self, entry: Entry) {
        match entry.event {
            Event::Command { command } => {
                if let CommandKind::Replaced { joints } = command.what {
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
                    self.replaced.push((entry.time_utc_s, recorded));
                }
            }
            Event::Maintenance { maintenance } => {
                let is_same = |(utc_s, _): &&mut (f64, Maintenance)| {
                    (*utc_s - maintenance.recorded_utc_s).abs() < SAME_TIME_S
                };
                let of_entry = self.replaced.iter_mut().find(is_same);
                if let Some((_, own)) = of_entry.filter(|_| maintenance.replaced) {
                    *own = maintenance;
                }
            }
            Event::Incident { incident } => {
                let key = (incident.joint, incident.number);
                match incident.finding {
                    Some(Finding::StrandFailure) => {
                        self.failed.insert(key, incident.opened_utc_s);
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

    /// Returns the times at which the rope of a joint was replaced, s since 1970 UTC, in chronological order.
    fn installed(&self, joint: &str) -> Vec<f64> {
        let own = self.replaced.iter().filter(|(_, entry)| {
            !entry.is_withdrawn() && entry.joints.iter().any(|name| name == joint)
        });
        let mut times: Vec<f64> = own.map(|(_, entry)| entry.time_utc_s).collect();
        times.sort_by(f64::total_cmp);
        times
    }

    /// Returns the time of the first failure of the rope of a joint between two times, s since 1970 UTC.
    fn failed_within(&self, joint: &str, from_utc_s: f64, to_utc_s: f64) -> Option<f64> {
        let own = self.failed.iter().filter(|((name, _), _)| name == joint);
        let times = own.map(|(_, utc_s)| *utc_s);
        times
            .filter(|utc_s| (from_utc_s..to_utc_s).contains(utc_s))
            .reduce(f64::min)
    }
}

/// Writes the lifetimes of ropes as the table for `sinew trend survival`; returns their number.
///
/// A rope has a row if its installation was recorded as a replacement, and it moved since: the age of a rope that was
/// installed before is not known. The age is the duration of motion in recorded sessions, h. A rope ends as `broken` at
/// the incident whose finding is a failed strand or rope, as `replaced` at its replacement without such a finding, and is
/// `running` otherwise; the last two are censored.
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
            for (from_utc_s, replaced_utc_s) in installed.iter().copied().zip(next) {
                let to_utc_s = replaced_utc_s.unwrap_or(f64::INFINITY);
                let failed = repairs.failed_within(joint, from_utc_s, to_utc_s);
                let end = match (failed, replaced_utc_s) {
                    (Some(_), _) => "broken",
                    (None, Some(_)) => "replaced",
                    (None, None) => "running",
                };
                let to_utc_s = failed.unwrap_or(to_utc_s);
                let motion_s = reader.motion_s(&robot, joint, [from_utc_s, to_utc_s])?;
                if motion_s > 0.0 {
                    let text = |of: &str| Cell::Text(of.to_owned());
                    writer.row(&[
                        Cell::Text(format!("{robot} {joint}")),
                        text(&robot_type),
                        Cell::Number(motion_s / 3600.0),
                        text(end),
                        Cell::Number(from_utc_s),
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
    /// Returns the type of a robot with its recorded replacements and rope failures.
    fn repairs(&self, robot: &str) -> Result<(String, Repairs), StoreError> {
        let robot_type = self.connection().query_row(
            "SELECT robot_type FROM robot WHERE name = ?1",
            [robot],
            |row| row.get(0),
        )?;
        let mut repairs = Repairs::default();
        let mut statement = self.connection().prepare_cached(
            "SELECT document FROM journal WHERE robot = ?1
             AND event IN ('command', 'maintenance', 'incident') ORDER BY id",
        )?;
        let mut rows = statement.query([robot])?;
        while let Some(row) = rows.next()? {
            let text: String = row.get(0)?;
            repairs.add(document("an entry of the journal", robot, &text)?);
        }
        Ok((robot_type, repairs))
    }

    /// Returns the duration of motion of a tendon in the sessions that began between two times, s.
    fn motion_s(
        &self,
        robot: &str,
        joint: &str,
        [from_utc_s, to_utc_s]: [f64; 2],
    ) -> Result<f64, StoreError> {
        let sum = self.connection().query_row(
            "SELECT total(duration_s) FROM record INDEXED BY record_of_tendon
             WHERE robot = ?1 AND joint = ?2 AND time_utc_s >= ?3 AND time_utc_s < ?4",
            params![robot, joint, from_utc_s, to_utc_s],
            |row| row.get(0),
        )?;
        Ok(sum)
    }
}
