//! Every session of every tendon as a table.

use sinew_estimate::trend::TrendReport;
use sinew_files::date::day_of;
use sinew_files::{OutputError, csv_cell, write_file};
use sinew_model::Z95;
use std::fmt::Write as _;
use std::path::Path;

/// Writes sessions as CSV: what was recorded, what the trend knew then. A cell is empty where
/// nothing is known.
///
/// # Errors
/// [`OutputError`].
pub fn write_csv(report: &TrendReport, path: &Path) -> Result<(), OutputError> {
    let mut out = String::from(
        "day,time_utc_s,joint,offset_mrad,interval_95_mrad,temperature_c,at_reference_mrad,\
         tracked_mrad,tracked_interval_95_mrad,jump_probability,off\n",
    );
    let cell = |v: Option<f64>| match v {
        Some(v) if v.is_finite() => format!("{v:.6}"),
        _ => String::new(),
    };
    for joint in &report.joints {
        let name = csv_cell(&joint.name);
        for s in &joint.series {
            let _ = writeln!(
                out,
                "{},{:.3},{name},{},{},{},{},{},{},{:.4},{}",
                day_of(s.time_utc_s),
                s.time_utc_s,
                cell(s.offset_rad.map(|y| 1e3 * y.mean)),
                cell(s.offset_rad.map(|y| 1e3 * Z95 * y.deviation)),
                cell(s.temperature_c),
                cell(s.at_reference_rad.map(|y| 1e3 * y)),
                cell(Some(1e3 * s.tracked_rad.mean)),
                cell(Some(1e3 * Z95 * s.tracked_rad.deviation)),
                s.jump_probability,
                s.is_off
            );
        }
    }
    write_file(path, out.as_bytes())
}
