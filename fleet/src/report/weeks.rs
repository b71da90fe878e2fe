//! Work by week: number of tendons that exceed a limit, by the median and by the ends of their intervals.

use crate::due::DueList;
use sinew_files::date::DAY_S;

/// Number of due tendons of a week.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Week {
    /// Tendons that exceed their limit in the week, by the median.
    pub(super) median: usize,
    /// Tendons that exceed their limit by the end of the week, by the upper end of the interval.
    pub(super) upper_by: usize,
    /// Tendons that exceed their limit by the end of the week, by the median.
    pub(super) median_by: usize,
    /// Tendons that exceed their limit by the end of the week, by the lower end of the interval.
    pub(super) lower_by: usize,
}

/// Number of overdue tendons, and the work of each following week.
pub(super) fn weeks(list: &DueList, count: usize) -> (usize, Vec<Week>) {
    let mut out = vec![Week::default(); count];
    let mut overdue = 0;
    for passage in list.followed.iter().filter_map(|f| f.worst()) {
        if passage.is_passed() {
            overdue += 1;
            continue;
        }
        // 0 in the first week; an open end is later than all weeks.
        let week = |at: Option<f64>| {
            let days = at.map_or(f64::INFINITY, |at| (at - list.now_utc_s) / DAY_S);
            (days / 7.0).max(0.0).floor()
        };
        let [median, low, high] = passage.at_utc_s.map(week);
        for (i, out) in out.iter_mut().enumerate() {
            let i = i as f64;
            out.median += usize::from(median == i);
            out.median_by += usize::from(median <= i);
            out.lower_by += usize::from(low <= i);
            out.upper_by += usize::from(high <= i);
        }
    }
    (overdue, out)
}
