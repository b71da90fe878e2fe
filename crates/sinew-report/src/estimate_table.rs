//! The estimate over time as a table, for plots elsewhere.

use sinew_estimate::EstimateDocument;
use sinew_estimate::replay::{Estimate, JointEstimate};
use sinew_estimate::session::TendonEstimate;
use sinew_log::{Cell, CellKind, Table};
use sinew_model::Gaussian;

/// Clocks before the year 2000 don't tell the date.
const YEAR_2000_NS: i64 = 946_684_800_000_000_000;

const COLUMNS: [(&str, CellKind); 15] = [
    ("method", CellKind::Text),
    ("joint", CellKind::Text),
    ("time_s", CellKind::Number),
    ("time_utc_ns", CellKind::Integer),
    ("offset_rad", CellKind::Number),
    ("offset_interval_95_rad", CellKind::Number),
    ("elongation_m", CellKind::Number),
    ("elongation_interval_95_m", CellKind::Number),
    ("strain_ratio", CellKind::Number),
    ("block_offset_rad", CellKind::Number),
    ("block_weight", CellKind::Number),
    ("offset_min_rad", CellKind::Number),
    ("offset_max_rad", CellKind::Number),
    ("tau_el_nm", CellKind::Number),
    ("usable_share", CellKind::Number),
];

/// Time of the recording, ns since 1970 UTC, where its clock tells the date.
pub(crate) fn time_ns(reading: &Estimate, time_s: f64) -> i64 {
    reading.recording.start_time_ns + (1e9 * time_s).round() as i64
}

/// [`time_ns`] where the recording's clock tells the date.
fn time_utc_ns(reading: &Estimate, time_s: f64) -> Option<i64> {
    Some(time_ns(reading, time_s)).filter(|ns| *ns > YEAR_2000_NS)
}

/// What an offset of 1 rad comes to in another quantity of the same tendon.
pub(crate) fn per_rad(of: Option<Gaussian>, offset_rad: Gaussian) -> Option<f64> {
    of.map(|of| of.deviation / offset_rad.deviation)
}

/// The estimate of a recording over time: a row per joint and time, of the absolute method every 0.2 s and of the
/// paper's in at most [`Series::POINTS`](sinew_estimate::replay::Series::POINTS) intervals, told apart by `method`. With `--live` the rows
/// of the form beside a running robot are `live`; while it is in doubt its interval is wide.
///
/// `time_s` counts from the start of the recording. Intervals are half a 95 % interval; the paper's reading has none.
pub fn estimate_series(document: &EstimateDocument) -> Table {
    let mut table = Table::new(&COLUMNS);
    if let Some(session) = &document.session {
        for (at, joint) in session.joints.iter().enumerate() {
            let blocks = session.blocks.iter().map(|block| Known {
                method: "absolute",
                time_s: block.time_s,
                offset_rad: block.offset_rad[at],
                block_rad: Some(block.block_rad[at]),
                weight: block.weight,
            });
            known(&mut table, &document.reading, joint, blocks);
        }
        for (at, joint) in session.joints.iter().enumerate() {
            let blocks = session.live.iter().flat_map(|course| &course.blocks);
            let blocks = blocks.map(|block| Known {
                method: "live",
                time_s: block.time_s,
                offset_rad: block.offset_rad[at],
                block_rad: None,
                weight: block.weight,
            });
            known(&mut table, &document.reading, joint, blocks);
        }
    }
    for joint in &document.reading.joints {
        paper(&mut table, &document.reading, joint);
    }
    table
}

/// The estimate at one time, of a method that knows a tendon's interval then.
struct Known {
    method: &'static str,
    time_s: f64,
    offset_rad: Gaussian,
    block_rad: Option<f64>,
    weight: f64,
}

/// A row for every time.
fn known(
    table: &mut Table,
    reading: &Estimate,
    joint: &TendonEstimate,
    times: impl Iterator<Item = Known>,
) {
    let m_per_rad = per_rad(joint.elongation_m, joint.offset_rad);
    let strain_per_rad = per_rad(joint.strain_ratio, joint.offset_rad);
    for at in times {
        let offset = at.offset_rad;
        let elongation_m = m_per_rad.map(|factor| offset.scaled(factor));
        let mut row: Vec<Cell> = vec![
            at.method.into(),
            joint.name.as_str().into(),
            at.time_s.into(),
            time_utc_ns(reading, at.time_s).into(),
            offset.mean.into(),
            offset.half_width_95().into(),
            elongation_m.map(|m| m.mean).into(),
            elongation_m.map(Gaussian::half_width_95).into(),
            strain_per_rad.map(|factor| factor * offset.mean).into(),
            at.block_rad.into(),
            at.weight.into(),
        ];
        row.resize(COLUMNS.len(), Cell::Empty);
        table.push(row);
    }
}

fn paper(table: &mut Table, reading: &Estimate, joint: &JointEstimate) {
    let factor = |of: Option<f64>| Some(of? / joint.offset_rad.filter(|x| *x != 0.0)?);
    let m_per_rad = factor(joint.elongation_m);
    let strain_per_rad = factor(joint.strain_ratio);
    let s = &joint.series;
    for (k, &time_s) in s.time_s.iter().enumerate() {
        let offset = s.offset_rad[k];
        table.push(vec![
            "paper".into(),
            joint.name.as_str().into(),
            time_s.into(),
            time_utc_ns(reading, time_s).into(),
            offset.into(),
            Cell::Empty,
            m_per_rad.map(|factor| factor * offset).into(),
            Cell::Empty,
            strain_per_rad.map(|factor| factor * offset).into(),
            Cell::Empty,
            Cell::Empty,
            s.offset_min_rad[k].into(),
            s.offset_max_rad[k].into(),
            s.tau_el_nm[k].into(),
            s.usable_share[k].into(),
        ]);
    }
}
