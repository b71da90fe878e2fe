//! Upper bound of an offset in closed form, which rules out tendons far from a limit without a full trend.
//!
//! Offsets of the last sessions since the present baseline are fitted by a line, `y_i = a + b (t_i − t_n)`, weighted by their
//! reported standard deviations. After `H` the offset is bounded by
//!
//! ```text
//! max(a + 3 σ_a, y of each of the last sessions) + 3 σ + (max(b, 0) + 3 σ_b + 3 σ_α |dT/dt|) H
//! σ_a, σ_b  standard deviations of level and slope, from the scatter about the line
//! σ         reported standard deviation of a session: the error common to all sessions since a baseline does not average out
//! σ_α       standard deviation of the drift with temperature: seasonal drift resembles or hides creep
//! ```
//!
//! The bound contains the largest session, so that it covers a recent step change. Creep slows down with time; a line is therefore a
//! bound. Heavier use in future is not foreseen, nor is it by the full trend.

use sinew_files::date::DAY_S;
use sinew_trend::SessionRecord;

/// Sessions looked at, and the days they may lie back.
const SESSIONS: usize = 28;
const DAYS: f64 = 45.0;
/// Minimum number of sessions of a slope.
const MIN_SESSIONS: usize = 10;
/// Minimum time span of these sessions, days.
const LEAST_SPAN_DAYS: f64 = 10.0;
/// Number of recent sessions whose largest offset is used.
const LARGEST_OF: usize = 10;
/// Number of standard deviations that are added to each term.
const FACTOR: f64 = 3.0;

/// Text of the bound in the output.
pub const RULE: &str = "the larger of the largest offset of the last 10 sessions and the regression level of the \
                        last 28, plus slope times days; each term with 3 standard deviations";

/// Returns an upper bound of the offset `horizon_s` after `now_utc_s`, rad; `None` if the data are insufficient.
///
/// * `sessions`: of one tendon, in chronological order, one per day.
/// * `drift_rad_per_k`: standard deviation of the drift with temperature.
pub fn bound_rad(
    sessions: &[SessionRecord],
    now_utc_s: f64,
    horizon_s: f64,
    drift_rad_per_k: f64,
) -> Option<f64> {
    let last = sessions.last()?;
    let own: Vec<&SessionRecord> = (sessions.iter().rev())
        .take_while(|s| s.baseline == last.baseline)
        .take_while(|s| last.time_utc_s - s.time_utc_s <= DAYS * DAY_S)
        .take(SESSIONS)
        .collect();
    let span_s = last.time_utc_s - own.last()?.time_utc_s;
    if own.len() < MIN_SESSIONS || span_s < LEAST_SPAN_DAYS * DAY_S {
        return None;
    }
    let offsets: Vec<(f64, f64, f64)> = (own.iter())
        .filter_map(|s| {
            let offset = s.offset_rad?;
            Some((s.time_utc_s - last.time_utc_s, offset.mean, offset.std))
        })
        .collect();
    let line = Line::through(&offsets)?;
    let temperatures: Option<Vec<(f64, f64, f64)>> = (own.iter())
        .map(|s| Some((s.time_utc_s - last.time_utc_s, s.temperature_c?, 1.0)))
        .collect();
    // Without temperatures a season is unknown: nothing is ruled out by what may be one.
    let warming = Line::through(&temperatures?)?;
    let warming_per_s = warming.slope.abs() + warming.slope_std;
    let largest = offsets.iter().take(LARGEST_OF).map(|o| o.1);
    let level = largest.fold(line.level + FACTOR * line.level_std, f64::max);
    let widest = offsets.iter().map(|o| o.2).fold(0.0, f64::max);
    let creep_rate =
        line.slope.max(0.0) + FACTOR * (line.slope_std + drift_rad_per_k * warming_per_s);
    let ahead_s = (now_utc_s - last.time_utc_s).max(0.0) + horizon_s;
    let bound = level + FACTOR * widest + creep_rate * ahead_s;
    bound.is_finite().then_some(bound)
}

/// A weighted line, at time 0.
struct Line {
    level: f64,
    level_std: f64,
    slope: f64,
    slope_std: f64,
}

impl Line {
    /// Through `(t, y, σ)`, deviations by the scatter about it.
    fn through(points: &[(f64, f64, f64)]) -> Option<Self> {
        let weighed = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            points.iter().map(|(t, y, s)| f(*t, *y) / (s * s)).sum()
        };
        let w = weighed(&|_, _| 1.0);
        let (t, y) = (weighed(&|t, _| t) / w, weighed(&|_, y| y) / w);
        let tt = weighed(&|ti, _| (ti - t) * (ti - t));
        let slope = weighed(&|ti, yi| (ti - t) * (yi - y)) / tt;
        let chi = weighed(&|ti, yi| (yi - y - slope * (ti - t)).powi(2));
        let freedom = points.len().checked_sub(2).filter(|n| *n > 0)?;
        let scatter = chi / freedom as f64;
        let out = Self {
            level: y - slope * t,
            level_std: (scatter * (1.0 / w + t * t / tt)).sqrt(),
            slope,
            slope_std: (scatter / tt).sqrt(),
        };
        let finite = [out.level, out.level_std, out.slope, out.slope_std];
        finite.iter().all(|x| x.is_finite()).then_some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_model::Gaussian;

    /// Thirty days at 2 mrad that grow by 0.01 mrad a day; `last_rad`: offset of the last one, rad.
    fn month(last_rad: f64) -> Vec<SessionRecord> {
        (0..30)
            .map(|day| {
                let days = f64::from(day);
                let line = 2e-3 + 0.01e-3 * (days - 29.0);
                let offset = if day == 29 { last_rad } else { line };
                SessionRecord {
                    time_utc_s: 1.75e9 + days * DAY_S,
                    offset_rad: Some(Gaussian::new(offset, 0.1e-3)),
                    temperature_c: Some(21.0),
                    ..SessionRecord::default()
                }
            })
            .collect()
    }

    fn bound(sessions: &[SessionRecord], days: f64) -> Option<f64> {
        let now = sessions.last().map_or(0.0, |s| s.time_utc_s);
        bound_rad(sessions, now, days * DAY_S, 0.1e-3)
    }

    #[test]
    fn bound_steady_line_extrapolates_plus_three_std() {
        // 2 mrad, 0.01 mrad a day for 30 days, 3 · 0.1 mrad: an exact line scatters by nothing.
        let found = bound(&month(2e-3), 30.0).unwrap();
        assert!((found - 2.6e-3).abs() < 1e-9, "{found}");
    }

    #[test]
    fn bound_covers_step_in_last_session() {
        assert!(bound(&month(16e-3), 30.0).unwrap() > 16e-3);
    }

    #[test]
    fn bound_is_not_below_other_sessions() {
        assert!(bound(&month(-20e-3), 30.0).unwrap() > 2e-3);
    }

    #[test]
    fn bound_counts_from_last_session() {
        let sessions = month(2e-3);
        let last = sessions.last().unwrap().time_utc_s;
        let [now, later] = [0.0, 100.0]
            .map(|d| bound_rad(&sessions, last + d * DAY_S, 30.0 * DAY_S, 0.1e-3).unwrap());
        assert!((later - now - 1e-3).abs() < 1e-9, "{now} {later}");
    }

    #[test]
    fn few_sessions_since_a_tensioning_rule_nothing_out() {
        let mut sessions = month(2e-3);
        for session in &mut sessions[22..] {
            session.baseline = Some("new".into());
        }
        assert_eq!(bound(&sessions, 30.0), None);
    }

    #[test]
    fn bound_includes_seasonal_drift() {
        let steady = bound(&month(2e-3), 30.0).unwrap();
        let mut sessions = month(2e-3);
        for (day, session) in sessions.iter_mut().enumerate() {
            session.temperature_c = Some(21.0 - 0.1 * day as f64);
        }
        let cooling = bound(&sessions, 30.0).unwrap();
        // 3 · 0.1 mrad/K · 0.1 K/day · 30 days.
        assert!(
            (cooling - steady - 0.9e-3).abs() < 1e-9,
            "{cooling} {steady}"
        );
    }
}
