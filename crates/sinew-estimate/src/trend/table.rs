//! Every session of every tendon as a table.

use super::result::TrendReport;
use sinew_files::date::day_of;
use sinew_files::{OutputError, write_file};
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
    let cell = |v: f64| {
        if v.is_finite() {
            format!("{v:.6}")
        } else {
            String::new()
        }
    };
    for joint in &report.joints {
        let s = &joint.series;
        // A name with a comma or a quote is quoted.
        let name = if joint.name.contains([',', '"', '\n']) {
            format!("\"{}\"", joint.name.replace('"', "\"\""))
        } else {
            joint.name.clone()
        };
        for i in 0..s.time_utc_s.len() {
            let [tracked, interval] = s.tracked_mrad[i];
            let _ = writeln!(
                out,
                "{},{:.3},{name},{},{},{},{},{},{},{:.4},{}",
                day_of(s.time_utc_s[i]),
                s.time_utc_s[i],
                cell(s.offset_mrad[i]),
                cell(s.interval_95_mrad[i]),
                cell(s.temperature_c[i]),
                cell(s.at_reference_mrad[i]),
                cell(tracked),
                cell(interval),
                s.jump_probability[i],
                s.off[i]
            );
        }
    }
    write_file(path, out.as_bytes())
}
