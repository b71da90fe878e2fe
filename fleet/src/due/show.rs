//! Output of `due`: text and table.

use super::{DueList, Passage, StateUnused, TrackedTendon, rope_of, screen};
use crate::FleetError;
use crate::args::Due;
use sinew_files::date::{DAY_S, day_of};
use sinew_files::plain;
use sinew_log::{Cell, CellKind, SchemaColumn, TableSchema, TableWriter};
use sinew_report::text::{paragraph, table};
use sinew_trend::{Limit, LimitState, TrendVerdict};
use std::path::Path;

/// Columns of [`row`].
pub(crate) const HEAD: [&str; 7] = [
    "robot",
    "joint",
    "action",
    "limit (mm)",
    "elongation (mm)",
    "days",
    "95 % (days)",
];

/// Days from the fleet's last session, for people.
fn days(at_utc_s: Option<f64>, now_utc_s: f64) -> String {
    let days = at_utc_s.map(|at| ((at - now_utc_s) / DAY_S).max(0.0));
    days.map_or("> 365".into(), |days| format!("{days:.0}"))
}

/// Recommended action at a limit.
fn action(followed: &TrackedTendon, passage: &Passage) -> &'static str {
    match (followed.verdict, passage.limit) {
        (TrendVerdict::Inspect, _) => "inspect",
        (_, Limit::Retension { .. }) => "re-tension",
        (_, Limit::Replace { .. }) => "replace",
    }
}

pub(crate) fn row(followed: &TrackedTendon, passage: &Passage, now_utc_s: f64) -> Vec<String> {
    let radius_m = followed
        .elongation_m
        .map(|e| e.mean / followed.offset_rad.mean);
    let millimetres = followed.elongation_m.map_or("–".into(), |e| {
        format!("{:.2} ± {:.2}", 1e3 * e.mean, 1e3 * e.half_width_95())
    });
    let limit = radius_m.filter(|r| r.is_finite());
    let [median, low, high] = passage.at_utc_s.map(|at| days(at, now_utc_s));
    let (median, interval) = match passage.state {
        LimitState::Passed => ("exceeded".into(), "–".into()),
        _ => (median, format!("{low} … {high}")),
    };
    vec![
        plain(&followed.robot),
        plain(&followed.joint),
        action(followed, passage).into(),
        limit.map_or("–".into(), |r| {
            format!("{:.2}", 1e3 * r * passage.limit_rad)
        }),
        millimetres,
        median,
        interval,
    ]
}

/// Formats the list as text.
pub(super) fn text(list: &DueList, request: &Due) -> String {
    let due: Vec<&TrackedTendon> = list.due(request.within_days).collect();
    let rows = due
        .iter()
        .take(request.rows)
        .filter_map(|f| Some(row(f, f.worst()?, list.now_utc_s)));
    let mut out = match due.is_empty() {
        true => String::new(),
        false => table(&HEAD, rows.collect(), 3) + "\n",
    };
    if due.len() > request.rows {
        out += &format!(
            "… {} more; --rows N shows more, --csv FILE writes all\n\n",
            due.len() - request.rows
        );
    }
    let within = format!("{} days of {}", request.within_days, day_of(list.now_utc_s));
    out += &paragraph(
        &format!(
            "{} of {} tendons may exceed a limit within {within}: exceeded already, or the lower end of the interval is earlier.",
            due.len(),
            list.tendons
        ),
        2,
    );
    let mut from = match (&request.state, list.resumed) {
        (Some(path), n) => format!(", {n} of them resumed from {}", path.display()),
        (None, _) => String::new(),
    };
    if let Some(path) = &request.creep {
        from += &match list.with_reference_creep {
            0 => format!(
                ", none of them with the reference creep of {}: no row has their type, joint and rope",
                path.display()
            ),
            n => format!(
                ", {n} of them with the reference creep of {}",
                path.display()
            ),
        };
    }
    out += &paragraph(
        &format!(
            "{} were tracked by the full trend{}. {} cannot reach a limit within these days, because an upper bound is below it: {}.",
            list.followed.len(),
            plain(&from),
            list.out_of_reach,
            screen::RULE
        ),
        2,
    );
    if list.without_limit > 0 {
        let types = match list.unknown_types.is_empty() {
            true => "robot.toml specifies none".to_owned(),
            false => format!(
                "specify {} with --robot DIR or in types/",
                plain(&list.unknown_types.join(", "))
            ),
        };
        out += &paragraph(
            &format!("{} have no limit: {types}.", list.without_limit),
            2,
        );
    }
    for (robot, joint, reason) in &list.failed {
        out += &paragraph(&plain(&format!("{robot}, {joint}: no trend: {reason}")), 2);
    }
    out
}

/// Reports why the stored state was not used.
pub(crate) fn report_unused_state(list: &DueList, state: Option<&Path>) {
    let (Some(unused), Some(path)) = (&list.state_unused, state) else {
        return;
    };
    let path = plain(&path.display().to_string());
    match unused {
        StateUnused::Version(version) => eprintln!(
            "{path}: written by version {}; every trend was estimated again and the file replaced",
            plain(version)
        ),
        StateUnused::Damaged => eprintln!(
            "{path}: damaged; trends after the damage were estimated again and the file replaced"
        ),
    }
}

/// Table of every tracked tendon, one row per limit.
const DUE: TableSchema<'static> = TableSchema {
    name: "sinew-fleet-due/1",
    columns: &[
        SchemaColumn::plain("robot", CellKind::Text, "Name of the robot"),
        SchemaColumn::plain("joint", CellKind::Text, "Name of the joint"),
        SchemaColumn::plain("site", CellKind::Text, "Site of the robot"),
        SchemaColumn::plain("rope", CellKind::Text, "Rope of the tendon"),
        SchemaColumn::plain("batch", CellKind::Text, "Batch of the rope"),
        SchemaColumn::plain("limit", CellKind::Text, "Limit: retension or replace"),
        SchemaColumn::plain("state", CellKind::Text, "State of the limit"),
        SchemaColumn::number("last_utc_s", "s", "Last session, since 1970 UTC"),
        SchemaColumn::number("offset_rad", "rad", "Offset since the last tensioning"),
        SchemaColumn::number("offset_std_rad", "rad", "Standard deviation of the offset"),
        SchemaColumn::number("limit_rad", "rad", "Limit as an offset"),
        SchemaColumn::number("at_utc_s", "s", "Median time of the limit, since 1970 UTC"),
        SchemaColumn::number(
            "at_low_utc_s",
            "s",
            "2.5 % quantile of the time of the limit, since 1970 UTC",
        ),
        SchemaColumn::number(
            "at_high_utc_s",
            "s",
            "97.5 % quantile of the time of the limit, since 1970 UTC",
        ),
        SchemaColumn::number(
            "ahead_utc_s",
            "s",
            "End of the requested days, since 1970 UTC",
        ),
        SchemaColumn::number(
            "ahead_rad",
            "rad",
            "Median offset at the end of the requested days",
        ),
        SchemaColumn::number(
            "ahead_low_rad",
            "rad",
            "2.5 % quantile of the offset at the end of the requested days",
        ),
        SchemaColumn::number(
            "ahead_high_rad",
            "rad",
            "97.5 % quantile of the offset at the end of the requested days",
        ),
        SchemaColumn::plain(
            "is_due",
            CellKind::Flag,
            "Whether the limit may be exceeded within the requested days",
        ),
    ],
};

/// Writes every tracked tendon, one row per limit.
pub(super) fn csv(list: &DueList, request: &Due, path: &Path) -> Result<(), FleetError> {
    let mut writer = TableWriter::of_schema(path, &DUE)?;
    let text = |of: &str| Cell::Text(of.to_owned());
    let maybe = |of: Option<&str>| of.map_or(Cell::Empty, text);
    let until_utc_s = list.now_utc_s + request.within_days * DAY_S;
    for followed in &list.followed {
        for passage in &followed.passages {
            let [at, low, high] = passage.at_utc_s;
            let ahead = followed.ahead.map_or([f64::NAN; 4], |a| {
                let [low, high] = [a.interval_95_rad.low, a.interval_95_rad.high];
                [a.time_utc_s, a.offset_rad, low, high]
            });
            let [ahead_utc_s, ahead_rad, ahead_low_rad, ahead_high_rad] = ahead.map(Cell::from);
            writer.row(&[
                text(&followed.robot),
                text(&followed.joint),
                maybe(followed.site.as_deref()),
                maybe(rope_of(&followed.fit)),
                maybe(followed.fit.batch.as_deref()),
                text(passage.limit.name()),
                text(passage.state.name()),
                Cell::Number(followed.last_utc_s),
                Cell::Number(followed.offset_rad.mean),
                Cell::Number(followed.offset_rad.std),
                Cell::Number(passage.limit_rad),
                Cell::from(at.unwrap_or(f64::NAN)),
                Cell::from(low.unwrap_or(f64::NAN)),
                Cell::from(high.unwrap_or(f64::NAN)),
                ahead_utc_s,
                ahead_rad,
                ahead_low_rad,
                ahead_high_rad,
                Cell::Flag(passage.is_due(until_utc_s)),
            ])?;
        }
    }
    Ok(writer.finish()?)
}
