//! Every session of every tendon as a table.

use sinew_files::date::{DAY_S, day_of};
use sinew_log::{CellKind, Table};
use sinew_model::Z95;
use sinew_trend::TrendReport;

/// Sessions as people read them, mrad: what was recorded, what the trend knew then. `days` count since the tensioning.
pub fn trend_table(report: &TrendReport) -> Table {
    let mut table = Table::new(&[
        ("day", CellKind::Text),
        ("days", CellKind::Number),
        ("time_utc_s", CellKind::Number),
        ("cycle", CellKind::Number),
        ("joint", CellKind::Text),
        ("offset_mrad", CellKind::Number),
        ("interval_95_mrad", CellKind::Number),
        ("temperature_c", CellKind::Number),
        ("at_reference_mrad", CellKind::Number),
        ("tracked_mrad", CellKind::Number),
        ("tracked_interval_95_mrad", CellKind::Number),
        ("jump_probability", CellKind::Number),
        ("off", CellKind::Flag),
    ]);
    for joint in &report.joints {
        for s in &joint.series {
            table.push(vec![
                day_of(s.time_utc_s).into(),
                ((s.time_utc_s - joint.tensioned_utc_s) / DAY_S).into(),
                s.time_utc_s.into(),
                s.cycle.into(),
                joint.name.as_str().into(),
                s.offset_rad.map(|y| 1e3 * y.mean).into(),
                s.offset_rad.map(|y| 1e3 * Z95 * y.deviation).into(),
                s.temperature_c.into(),
                s.at_reference_rad.map(|y| 1e3 * y).into(),
                (1e3 * s.tracked_rad.mean).into(),
                (1e3 * Z95 * s.tracked_rad.deviation).into(),
                s.jump_probability.into(),
                s.is_off.into(),
            ]);
        }
    }
    table
}
