//! Records of some robots, tendon by tendon.

use crate::FleetError;
use crate::folder::sides::Tendon;
use datafusion::arrow::array::{Array as _, AsArray as _, RecordBatch};
use datafusion::arrow::compute::cast;
use datafusion::arrow::datatypes::{DataType, Float64Type};
use sinew_model::Gaussian;
use sinew_trend::SessionRecord;
use sinew_trend::fleet::best_of_days;
use std::collections::HashMap;

/// Sessions of a tendon: the one with the narrowest interval of each day, as in the trend of the monitor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sessions {
    pub(crate) tendon: Tendon,
    pub(crate) robot_type: String,
    pub(crate) rows: Vec<SessionRecord>,
}

/// Columns of a session, in the order of evaluation.
pub(crate) const COLUMNS: [&str; 11] = [
    "robot",
    "joint",
    "robot_type",
    "baseline",
    "time_utc_s",
    "duration_s",
    "offset_rad",
    "offset_std_rad",
    "temperature_c",
    "stiffness_ratio",
    "stiffness_std_ratio",
];

/// Sessions of rows of [`COLUMNS`] in any order, by robot and joint.
///
/// Files hold most rows of a tendon one after the other, so these are put in order, and not all rows by three keys.
pub(crate) fn sessions(batches: &[RecordBatch]) -> Result<Vec<Sessions>, FleetError> {
    let mut taken = SessionTable::default();
    for batch in batches {
        taken.add(batch)?;
    }
    let mut out = taken.tendons;
    out.sort_by(|a, b| a.tendon.cmp(&b.tendon));
    for tendon in &mut out {
        let mut rows = std::mem::take(&mut tendon.rows);
        rows.sort_by(|a, b| a.time_utc_s.total_cmp(&b.time_utc_s));
        tendon.rows = best_of_days(rows);
    }
    Ok(out)
}

/// Sessions read so far, in the order of their rows.
#[derive(Default)]
struct SessionTable {
    tendons: Vec<Sessions>,
    /// Time of the earliest row of each tendon, s since 1970; it determines the robot type.
    begun_utc_s: Vec<f64>,
    /// Indices by robot and joint.
    places: HashMap<String, HashMap<String, usize>>,
}

impl SessionTable {
    /// Returns the index of a tendon.
    fn place(&mut self, robot: &str, joint: &str) -> usize {
        let index = self.places.get(robot).and_then(|joints| joints.get(joint));
        if let Some(&at) = index {
            return at;
        }
        let at = self.tendons.len();
        self.tendons.push(Sessions {
            tendon: (robot.to_owned(), joint.to_owned()),
            robot_type: String::new(),
            rows: Vec::new(),
        });
        self.begun_utc_s.push(f64::INFINITY);
        let joints = self.places.entry(robot.to_owned()).or_default();
        joints.insert(joint.to_owned(), at);
        at
    }

    /// Adds the rows of a batch.
    fn add(&mut self, batch: &RecordBatch) -> Result<(), FleetError> {
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
            let std = number(i + 1, row).filter(|d| *d > 0.0)?;
            Some(Gaussian::new(number(i, row)?, std))
        };
        let (robot_names, joint_names) = (robots.as_string::<i32>(), joints.as_string::<i32>());
        let mut last: Option<((&str, &str), usize)> = None;
        for row in 0..batch.num_rows() {
            let key = (robot_names.value(row), joint_names.value(row));
            let (Some(time_utc_s), Some(offset)) = (number(4, row), gaussian(6, row)) else {
                continue;
            };
            let at = match last {
                Some((before, at)) if before == key => at,
                _ => self.place(key.0, key.1),
            };
            last = Some((key, at));
            let tendon = &mut self.tendons[at];
            if time_utc_s < self.begun_utc_s[at] {
                self.begun_utc_s[at] = time_utc_s;
                tendon.robot_type = text(&types, row).unwrap_or_default();
            }
            tendon.rows.push(SessionRecord {
                baseline: text(&baselines, row),
                time_utc_s,
                duration_s: number(5, row),
                joint: key.1.to_owned(),
                offset_rad: Some(offset),
                temperature_c: number(8, row),
                stiffness_ratio: gaussian(9, row),
                ..SessionRecord::default()
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use datafusion::arrow::array::{ArrayRef, Float64Array, StringArray};
    use sinew_files::date::DAY_S;
    use std::sync::Arc;

    /// Robot, joint, day, offset in mrad, standard deviation in mrad.
    type Row = (&'static str, &'static str, f64, f64, f64);

    fn batch(rows: &[Row]) -> RecordBatch {
        let text = |of: fn(&Row) -> &'static str| -> ArrayRef {
            Arc::new(rows.iter().map(|r| Some(of(r))).collect::<StringArray>())
        };
        let number = |of: fn(&Row) -> f64| -> ArrayRef {
            Arc::new(rows.iter().map(|r| Some(of(r))).collect::<Float64Array>())
        };
        let columns = [
            text(|r| r.0),
            text(|r| r.1),
            text(|r| if r.2 < 3.0 { "old" } else { "new" }),
            text(|_| "march"),
            number(|r| 1.75e9 + r.2 * DAY_S),
            number(|_| 120.0),
            number(|r| 1e-3 * r.3),
            number(|r| 1e-3 * r.4),
            number(|_| 21.0),
            number(|_| 0.0),
            number(|_| 0.01),
        ];
        RecordBatch::try_from_iter(COLUMNS.into_iter().zip(columns)).unwrap()
    }

    #[test]
    fn rows_in_any_order_and_of_any_file_are_the_same_sessions() {
        let rows: [Row; 7] = [
            ("a", "elbow", 1.0, 1.0, 0.3),
            ("a", "elbow", 2.0, 2.0, 0.3),
            ("a", "elbow", 2.1, 2.5, 0.1),
            ("a", "elbow", 4.0, 4.0, 0.3),
            ("a", "wrist", 1.0, 5.0, 0.3),
            ("b", "elbow", 2.0, 6.0, 0.3),
            ("b", "elbow", 3.0, 7.0, 0.3),
        ];
        let sorted = sessions(&[batch(&rows)]).unwrap();
        let names: Vec<(&str, &str)> = (sorted.iter())
            .map(|s| (s.tendon.0.as_str(), s.tendon.1.as_str()))
            .collect();
        assert_eq!(names, [("a", "elbow"), ("a", "wrist"), ("b", "elbow")]);
        // Of the second day the narrower one.
        let mrad = sorted[0].rows.iter().filter_map(|r| r.offset_rad);
        let mrad: Vec<f64> = mrad.map(|o| (1e4 * o.mean).round() / 10.0).collect();
        assert_eq!(mrad, [1.0, 2.5, 4.0]);
        assert_eq!(sorted[0].robot_type, "old");
        let mut other = rows;
        other.reverse();
        other.swap(1, 5);
        let (one, two) = other.split_at(3);
        assert_eq!(sessions(&[batch(one), batch(two)]).unwrap(), sorted);
    }
}
