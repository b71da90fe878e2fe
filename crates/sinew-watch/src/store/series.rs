//! Records of a tendon over any time, reduced to a number of points that a chart can draw.

use super::StoreError;
use super::read::Reader;
use rusqlite::params;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Time range and resolution of a series.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SeriesQuery {
    /// Start of the time range, s since 1970 UTC, inclusive; default: the first record.
    pub from_utc_s: Option<f64>,
    /// End of the time range, s since 1970 UTC, inclusive; default: the last record.
    pub to_utc_s: Option<f64>,
    /// Number of time intervals of equal length; default 300, limit 2000. Each yields at most three points.
    pub intervals: Option<u32>,
}

/// Records of a tendon, reduced where they are more than can be drawn: of each time interval those with the minimum, the
/// maximum and the last offset.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Series {
    /// Time of the first record of the tendon, s since 1970 UTC; `null`: none.
    pub first_utc_s: Option<f64>,
    /// Time of the last record of the tendon, s since 1970 UTC; `null`: none.
    pub last_utc_s: Option<f64>,
    /// Number of records in the time range.
    pub records: u64,
    /// Number of these records without an offset.
    pub inconclusive: u64,
    /// Length of a time interval, s; `null`: every record is a point.
    pub interval_s: Option<f64>,
    /// Points in chronological order.
    pub points: Vec<SeriesPoint>,
}

/// Record of a series.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SeriesPoint {
    /// Start of the session, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Offset, rad; `null`: inconclusive.
    pub offset_rad: Option<f64>,
    /// Standard deviation of the offset, rad.
    pub offset_std_rad: Option<f64>,
    /// Elongation since the tensioning, m.
    pub elongation_m: Option<f64>,
    /// Standard deviation of the elongation, m.
    pub elongation_std_m: Option<f64>,
}

/// Points of a time interval.
#[derive(Debug, Clone, Copy)]
struct Interval {
    min: SeriesPoint,
    max: SeriesPoint,
    last: SeriesPoint,
}

impl Interval {
    fn add(&mut self, point: SeriesPoint) {
        let Some(offset_rad) = point.offset_rad else {
            // An inconclusive record is drawn only where there is no other.
            if self.last.offset_rad.is_none() {
                *self = Self::of(point);
            }
            return;
        };
        if self.last.offset_rad.is_none() {
            *self = Self::of(point);
        }
        if self.min.offset_rad.is_none_or(|min| offset_rad < min) {
            self.min = point;
        }
        if self.max.offset_rad.is_none_or(|max| offset_rad > max) {
            self.max = point;
        }
        self.last = point;
    }

    fn of(point: SeriesPoint) -> Self {
        Self {
            min: point,
            max: point,
            last: point,
        }
    }

    /// Returns the different points in chronological order.
    fn points(self) -> impl Iterator<Item = SeriesPoint> {
        let mut points = vec![self.min, self.max, self.last];
        points.sort_by(|a, b| a.time_utc_s.total_cmp(&b.time_utc_s));
        points.dedup();
        points.into_iter()
    }
}

impl Reader {
    /// Returns the records of a tendon in a time range, reduced to at most three points per time interval.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn series(
        &self,
        robot: &str,
        joint: &str,
        query: &SeriesQuery,
        intervals: u32,
    ) -> Result<Series, StoreError> {
        let connection = self.connection();
        let ends = |order: &str| {
            let text =
                format!("SELECT {order}(time_utc_s) FROM record WHERE robot = ?1 AND joint = ?2");
            connection.query_row(&text, [robot, joint], |row| row.get::<_, Option<f64>>(0))
        };
        let (first_utc_s, last_utc_s) = (ends("min")?, ends("max")?);
        let from_utc_s = query.from_utc_s.or(first_utc_s).unwrap_or(0.0);
        let to_utc_s = query.to_utc_s.or(last_utc_s).unwrap_or(0.0);
        let range = params![robot, joint, from_utc_s, to_utc_s];
        let which = "FROM record INDEXED BY record_of_tendon \
                     WHERE robot = ?1 AND joint = ?2 AND time_utc_s >= ?3 AND time_utc_s <= ?4";
        let records: i64 =
            connection.query_row(&format!("SELECT count(*) {which}"), range, |row| row.get(0))?;
        let records = u64::try_from(records).unwrap_or(0);
        let is_whole = records <= 3 * u64::from(intervals);
        let interval_s = ((to_utc_s - from_utc_s) / f64::from(intervals.max(1))).max(1.0);
        let mut statement = connection.prepare_cached(&format!(
            "SELECT time_utc_s, offset_rad, offset_std_rad, elongation_m, elongation_std_m {which} ORDER BY time_utc_s, id"
        ))?;
        let mut rows = statement.query(range)?;
        let (mut points, mut inconclusive) = (Vec::new(), 0);
        let mut reduced: BTreeMap<u32, Interval> = BTreeMap::new();
        while let Some(row) = rows.next()? {
            let point = SeriesPoint {
                time_utc_s: row.get(0)?,
                offset_rad: row.get(1)?,
                offset_std_rad: row.get(2)?,
                elongation_m: row.get(3)?,
                elongation_std_m: row.get(4)?,
            };
            inconclusive += u64::from(point.offset_rad.is_none());
            if is_whole {
                points.push(point);
                continue;
            }
            let at = ((point.time_utc_s - from_utc_s) / interval_s) as u32;
            let at = at.min(intervals.saturating_sub(1));
            let interval = reduced.entry(at).or_insert(Interval::of(point));
            interval.add(point);
        }
        points.extend(reduced.into_values().flat_map(Interval::points));
        Ok(Series {
            first_utc_s,
            last_utc_s,
            records,
            inconclusive,
            interval_s: (!is_whole).then_some(interval_s),
            points,
        })
    }
}
