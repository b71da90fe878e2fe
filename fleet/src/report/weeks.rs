//! Work by week: how many tendons pass a limit in each, by the median and by the ends of their intervals.

use crate::due::DueList;
use sinew_files::date::DAY_S;

/// Work of a week.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Week {
    /// Tendons whose limit is passed in it, by the median.
    pub(super) likely: usize,
    /// Tendons that surely have passed by its end: so says the upper end of the interval.
    pub(super) surely_by: usize,
    /// Tendons that have by its end, by the median.
    pub(super) likely_by: usize,
    /// Tendons that may have by its end: so says the lower end.
    pub(super) maybe_by: usize,
}

/// What is overdue, and the work of each week to come.
pub(super) fn weeks(list: &DueList, count: usize) -> (usize, Vec<Week>) {
    let mut out = vec![Week::default(); count];
    let mut overdue = 0;
    for passage in list.followed.iter().filter_map(|f| f.worst()) {
        if passage.is_passed() {
            overdue += 1;
            continue;
        }
        // 0 in the first week; what isn't known to end, later than all.
        let week = |at: Option<f64>| {
            let days = at.map_or(f64::INFINITY, |at| (at - list.now_utc_s) / DAY_S);
            (days / 7.0).max(0.0).floor()
        };
        let [median, low, high] = passage.at_utc_s.map(week);
        for (i, out) in out.iter_mut().enumerate() {
            let i = i as f64;
            out.likely += usize::from(median == i);
            out.likely_by += usize::from(median <= i);
            out.maybe_by += usize::from(low <= i);
            out.surely_by += usize::from(high <= i);
        }
    }
    (overdue, out)
}
