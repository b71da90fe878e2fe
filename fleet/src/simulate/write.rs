//! A simulated fleet as files.

use super::life::{LookAhead, TendonHistory};
use super::plan::{Plan, PlannedRobot, SITES};
use crate::FleetError;
use crate::folder::TYPES;
use rayon::prelude::*;
use sinew_estimate::robot_dir::LoadedRobot;
use sinew_files::date::{DAY_S, civil};
use sinew_log::{Cell, CellKind, Column, TableWriter};
use sinew_watch_core::Record;
use sinew_watch_core::table::{SCHEMA, row};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Makes the folder of a file.
fn folder_for(path: &Path) -> Result<(), FleetError> {
    let folder = sinew_files::folder_of(path);
    std::fs::create_dir_all(folder).map_err(|source| FleetError::Folder {
        path: folder.into(),
        source,
    })
}

/// Copies the robot type: its limits, geometry and ropes belong to the fleet.
pub(super) fn robot_type(out: &Path, loaded: &LoadedRobot) -> Result<(), FleetError> {
    let from = sinew_files::folder_of(&loaded.file);
    let to = out.join(TYPES).join(&loaded.robot.name);
    let wrong = |source| FleetError::Folder {
        path: to.clone(),
        source,
    };
    std::fs::create_dir_all(&to).map_err(wrong)?;
    for entry in std::fs::read_dir(from).map_err(wrong)? {
        let path = entry.map_err(wrong)?.path();
        if let (true, Some(name)) = (path.is_file(), path.file_name()) {
            std::fs::copy(&path, to.join(name)).map_err(wrong)?;
        }
    }
    Ok(())
}

/// Formats a month such as `2024-03`.
fn month_of(utc_s: f64) -> String {
    let (year, month, _) = civil((utc_s / DAY_S).floor() as i64);
    format!("{year:04}-{month:02}")
}

/// Writes the records of some robots, a file per month; how many records and files.
pub(super) fn months(
    out: &Path,
    plan: &Plan,
    number: usize,
    robots: &[PlannedRobot],
    lives: &[Vec<TendonHistory>],
) -> Result<(u64, usize), FleetError> {
    let mut by_month: BTreeMap<String, Vec<&Record>> = BTreeMap::new();
    // Robots and joints are in the order of their names, and so is a file.
    for record in lives.iter().flatten().flat_map(|life| &life.records) {
        let month = month_of(record.time_utc_s);
        by_month.entry(month).or_default().push(record);
    }
    debug_assert!(robots.is_sorted_by(|a, b| a.name < b.name));
    let of_type = out
        .join("records")
        .join(format!("robot_type={}", plan.robot_type));
    let months: Vec<(String, Vec<&Record>)> = by_month.into_iter().collect();
    let written: Vec<u64> = (months.par_iter())
        .map(|(month, records)| {
            let name = format!("simulated-{}.parquet", number + 1);
            file(
                &of_type.join(format!("month={month}")).join(name),
                records.iter().copied(),
            )
        })
        .collect::<Result<_, _>>()?;
    Ok((written.iter().sum(), written.len()))
}

/// Writes a file of records.
fn file<'r>(path: &Path, records: impl Iterator<Item = &'r Record>) -> Result<u64, FleetError> {
    folder_for(path)?;
    let mut writer = TableWriter::of_schema(path, &SCHEMA)?;
    let mut count = 0;
    for record in records {
        writer.row(&row(record))?;
        count += 1;
    }
    writer.finish()?;
    Ok(count)
}

/// Writers of the side tables and the ground truth.
pub(super) struct Sides {
    robots: TableWriter,
    tendons: TableWriter,
    events: TableWriter,
    truth: TableWriter,
}

fn text(of: &str) -> Cell {
    Cell::Text(of.to_owned())
}

impl Sides {
    /// Starts them, and writes the batches' truth.
    pub(super) fn create(out: &Path, plan: &Plan) -> Result<Self, FleetError> {
        let create = |name: &str, texts: &[&str], numbers: &[&str]| {
            let path: PathBuf = out.join(name);
            folder_for(&path)?;
            let of = |kind: CellKind| move |name: &&str| ((*name).to_owned(), kind);
            let columns: Vec<Column> = (texts.iter().map(of(CellKind::Text)))
                .chain(numbers.iter().map(of(CellKind::Number)))
                .collect();
            Ok::<_, FleetError>(TableWriter::create(&path, &columns)?)
        };
        let mut batches = create("truth/batches.csv", &["rope", "batch"], &["creep_factor"])?;
        for batch in &plan.batches {
            batches.row(&[
                text(&batch.rope),
                text(&batch.name),
                Cell::Number(batch.factor),
            ])?;
        }
        batches.finish()?;
        Ok(Self {
            robots: create("robots.csv", &["robot", "robot_type", "site"], &[])?,
            tendons: create("tendons.csv", &["robot", "joint", "rope", "batch"], &[])?,
            events: create("events.csv", &["robot", "joint", "event"], &["time_utc_s"])?,
            truth: create(
                "truth/tendons.csv",
                &["robot", "joint", "state"],
                &[
                    "end_utc_s",
                    "offset_rad",
                    "limit_rad",
                    "passes_utc_s",
                    "failure_utc_s",
                    "failure_rad",
                ],
            )?,
        })
    }

    /// Adds a robot.
    pub(super) fn robot(
        &mut self,
        plan: &Plan,
        robot: &PlannedRobot,
        lives: &[TendonHistory],
    ) -> Result<(), FleetError> {
        let name = &robot.name;
        let site = SITES[robot.site].name;
        self.robots
            .row(&[text(name), text(&plan.robot_type), text(site)])?;
        let at_utc_s =
            |day: usize| Cell::Number(plan.start_utc_s + (robot.since_day + day) as f64 * DAY_S);
        for life in lives {
            let own = &plan.tendons[life.tendon];
            let batch = &plan.batches[robot.batches[life.tendon]];
            let head = [text(name), text(&own.joint)];
            let [robot_cell, joint] = &head;
            self.tendons.row(&[
                robot_cell.clone(),
                joint.clone(),
                text(&batch.rope),
                text(&batch.name),
            ])?;
            for (i, day) in life.tensioned_days.iter().enumerate() {
                let event = if i == 0 { "replaced" } else { "tensioned" };
                self.events.row(&[
                    robot_cell.clone(),
                    joint.clone(),
                    text(event),
                    at_utc_s(*day),
                ])?;
            }
            let end = plan.days - robot.since_day;
            let (state, passes) = match life.passes {
                LookAhead::Passed => ("passed", Cell::Empty),
                LookAhead::In(days) => ("passes", at_utc_s(end + days)),
                LookAhead::Later => ("later", Cell::Empty),
            };
            self.truth.row(&[
                robot_cell.clone(),
                joint.clone(),
                text(state),
                at_utc_s(end),
                Cell::Number(life.offset_rad),
                Cell::Number(own.limit_rad),
                passes,
                life.failure.map_or(Cell::Empty, |f| at_utc_s(f.0)),
                life.failure.map_or(Cell::Empty, |f| Cell::Number(f.1)),
            ])?;
        }
        Ok(())
    }

    /// Gives the files their names.
    pub(super) fn finish(self) -> Result<(), FleetError> {
        for table in [self.robots, self.tendons, self.events, self.truth] {
            table.finish()?;
        }
        Ok(())
    }
}
