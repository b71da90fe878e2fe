//! Records of some robots, tendon by tendon.

use crate::FleetError;
use crate::engine::Engine;
use crate::folder::sides::Tendon;
use datafusion::arrow::array::{Array as _, AsArray as _, RecordBatch};
use datafusion::arrow::compute::cast;
use datafusion::arrow::datatypes::{DataType, Float64Type};
use sinew_estimate::trend::SessionRecord;
use sinew_files::date::DAY_S;
use sinew_model::Gaussian;

/// What a tendon's monitor recorded: of each day the session with the narrowest interval, as the monitor's own trend
/// takes them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sessions {
    pub(crate) tendon: Tendon,
    pub(crate) robot_type: String,
    pub(crate) rows: Vec<SessionRecord>,
}

/// What a session is made from, in this order.
pub(crate) const COLUMNS: [&str; 11] = [
    "robot",
    "joint",
    "robot_type",
    "baseline",
    "time_utc_s",
    "duration_s",
    "offset_rad",
    "offset_deviation_rad",
    "temperature_c",
    "stiffness_ratio",
    "stiffness_deviation_ratio",
];

impl Sessions {
    /// Reads those of robots whose names follow each other.
    pub(crate) fn read(engine: &mut Engine, robots: &[String]) -> Result<Vec<Self>, FleetError> {
        let (Some(first), Some(last)) = (robots.first(), robots.last()) else {
            return Ok(Vec::new());
        };
        let quoted = |name: &str| format!("'{}'", name.replace('\'', "''"));
        // What a civil clock didn't date is no part of a trend.
        let sql = format!(
            "SELECT {} FROM records WHERE robot >= {} AND robot <= {} AND clock = 'utc' AND offset_rad IS NOT NULL \
             AND offset_deviation_rad > 0 ORDER BY robot, joint, time_utc_s",
            COLUMNS.join(", "),
            quoted(first),
            quoted(last)
        );
        let mut out: Vec<Self> = Vec::new();
        for batch in engine.ask(&sql)?.batches {
            take(&batch, &mut out)?;
        }
        Ok(out)
    }

    /// Adds a session: a day's second counts only if it is the better one. A tensioning parts a day in two.
    fn push(&mut self, row: SessionRecord) {
        let day = |r: &SessionRecord| (r.time_utc_s / DAY_S).floor();
        let width = |r: &SessionRecord| r.offset_rad.map_or(f64::INFINITY, |o| o.deviation);
        match self.rows.last_mut() {
            Some(last) if day(last) == day(&row) && last.baseline == row.baseline => {
                if width(&row) < width(last) {
                    *last = row;
                }
            }
            Some(last) if row.time_utc_s <= last.time_utc_s => {}
            _ => self.rows.push(row),
        }
    }
}

/// Takes rows of [`COLUMNS`], by robot, joint and time.
pub(crate) fn take(batch: &RecordBatch, out: &mut Vec<Sessions>) -> Result<(), FleetError> {
    let wrong = |e: datafusion::arrow::error::ArrowError| FleetError::Engine(e.to_string());
    let texts = |i: usize| cast(batch.column(i), &DataType::Utf8).map_err(wrong);
    let [robots, joints, types, baselines] = [texts(0)?, texts(1)?, texts(2)?, texts(3)?];
    let text = |column: &datafusion::arrow::array::ArrayRef, row: usize| -> Option<String> {
        let column = column.as_string::<i32>();
        (!column.is_null(row)).then(|| column.value(row).to_owned())
    };
    let number = |i: usize, row: usize| -> Option<f64> {
        let column = batch.column(i).as_primitive::<Float64Type>();
        (!column.is_null(row))
            .then(|| column.value(row))
            .filter(|x| x.is_finite())
    };
    let gaussian = |i: usize, row: usize| {
        let deviation = number(i + 1, row).filter(|d| *d > 0.0)?;
        Some(Gaussian::new(number(i, row)?, deviation))
    };
    let (robot_names, joint_names) = (robots.as_string::<i32>(), joints.as_string::<i32>());
    for row in 0..batch.num_rows() {
        let key = (robot_names.value(row), joint_names.value(row));
        let same = out
            .last()
            .is_some_and(|s| (s.tendon.0.as_str(), s.tendon.1.as_str()) == key);
        if !same {
            out.push(Sessions {
                tendon: (key.0.to_owned(), key.1.to_owned()),
                robot_type: text(&types, row).unwrap_or_default(),
                rows: Vec::new(),
            });
        }
        let (Some(time_utc_s), Some(offset)) = (number(4, row), gaussian(6, row)) else {
            continue;
        };
        let session = SessionRecord {
            baseline: text(&baselines, row),
            time_utc_s,
            duration_s: number(5, row),
            joint: key.1.to_owned(),
            offset_rad: Some(offset),
            temperature_c: number(8, row),
            stiffness_ratio: gaussian(9, row),
            ..SessionRecord::default()
        };
        if let Some(tendon) = out.last_mut() {
            tendon.push(session);
        }
    }
    Ok(())
}
