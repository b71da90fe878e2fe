//! What the trend knows at every session, and ahead, as one table in SI.

use sinew_files::date::day_of;
use sinew_log::{Cell, CellKind, Table};
use sinew_model::Gaussian;
use sinew_trend::{JointTrend, TrendReport};

/// Levels and forecast of every tendon: a row per joint and session, then per joint and time to come (`kind`).
///
/// `level_rad` with its 95 % interval is what the trend knew at a session, and the median of the forecast.
pub fn trend_series(report: &TrendReport) -> Table {
    let mut table = Table::new(&[
        ("joint", CellKind::Text),
        ("kind", CellKind::Text),
        ("day", CellKind::Text),
        ("time_s", CellKind::Number),
        ("time_utc_ns", CellKind::Integer),
        ("cycle", CellKind::Number),
        ("level_rad", CellKind::Number),
        ("level_low_rad", CellKind::Number),
        ("level_high_rad", CellKind::Number),
        ("offset_rad", CellKind::Number),
        ("offset_interval_95_rad", CellKind::Number),
        ("at_reference_rad", CellKind::Number),
        ("temperature_c", CellKind::Number),
        ("jump_probability", CellKind::Number),
        ("is_off", CellKind::Flag),
    ]);
    for joint in &report.joints {
        sessions(&mut table, joint);
        forecast(&mut table, joint);
    }
    table
}

/// What every row begins with; `time_s` counts from the joint's first session.
fn time(joint: &JointTrend, kind: &str, time_utc_s: f64, cycle: Option<f64>) -> Vec<Cell> {
    vec![
        joint.name.as_str().into(),
        kind.into(),
        day_of(time_utc_s).into(),
        (time_utc_s - joint.first_utc_s).into(),
        ((1e9 * time_utc_s).round() as i64).into(),
        cycle.into(),
    ]
}

fn sessions(table: &mut Table, joint: &JointTrend) {
    for s in &joint.series {
        let level = s.tracked_rad.interval_95();
        let mut row = time(joint, "session", s.time_utc_s, s.cycle);
        row.extend::<[Cell; 9]>([
            s.tracked_rad.mean.into(),
            level.low.into(),
            level.high.into(),
            s.offset_rad.map(|y| y.mean).into(),
            s.offset_rad.map(Gaussian::half_width_95).into(),
            s.at_reference_rad.into(),
            s.temperature_c.into(),
            s.jump_probability.into(),
            s.is_off.into(),
        ]);
        table.push(row);
    }
}

fn forecast(table: &mut Table, joint: &JointTrend) {
    for ahead in &joint.forecast {
        let cycle = joint
            .cycles
            .and_then(|c| Some(c.last + c.per_s? * (ahead.time_utc_s - joint.last_utc_s)));
        let mut row = time(joint, "forecast", ahead.time_utc_s, cycle);
        row.extend::<[Cell; 3]>([
            ahead.offset_rad.into(),
            ahead.interval_95_rad.low.into(),
            ahead.interval_95_rad.high.into(),
        ]);
        row.resize(table.columns.len(), Cell::Empty);
        table.push(row);
    }
}
