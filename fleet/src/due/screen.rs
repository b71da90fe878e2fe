//! Which tendons can't come near a limit: a bound in closed form, so that only the others need the whole trend.
//!
//! Offsets of the last sessions since the present baseline are taken as a line, `y_i = a + b (t_i − t_n)`, each weighed by
//! its stated deviation. After `H` the offset is held to be below
//!
//! ```text
//! max(a + 3 σ_a, y of each of the last sessions) + 3 σ + (max(b, 0) + 3 σ_b + 3 σ_α |dT/dt|) H
//! σ_a, σ_b  deviations of level and slope, by the scatter about the line
//! σ         stated deviation of a session: what all sessions since a baseline share doesn't average out
//! σ_α       what isn't known of the drift with temperature: a season looks like creep, or hides it
//! ```
//!
//! The largest session is in it, so that what jumped yesterday is never called far. Creep slows down with time, so a line is
//! a bound; a robot that is used harder from tomorrow on isn't foreseen, by the whole trend neither.

use sinew_files::date::DAY_S;
use sinew_trend::SessionRecord;

/// Sessions looked at, and the days they may lie back.
const SESSIONS: usize = 28;
const DAYS: f64 = 45.0;
/// Fewer say nothing of a slope.
const LEAST_SESSIONS: usize = 10;
/// Days they must span.
const LEAST_SPAN_DAYS: f64 = 10.0;
/// Sessions whose largest counts.
const LARGEST_OF: usize = 10;
/// Deviations that are added to everything.
const FACTOR: f64 = 3.0;

/// The rule, for who reads a list.
pub const RULE: &str = "largest of the last 10 sessions or level of the last 28 by regression, plus slope times \
                        days, each with 3 standard deviations";

/// A bound on the offset after `horizon_s` from `now_utc_s`, rad; `None`: too little is known for one.
///
/// * `sessions`: of one tendon, in the order of time, of each day one.
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
    if own.len() < LEAST_SESSIONS || span_s < LEAST_SPAN_DAYS * DAY_S {
        return None;
    }
    let offsets: Vec<(f64, f64, f64)> = (own.iter())
        .filter_map(|s| {
            let offset = s.offset_rad?;
            Some((
                s.time_utc_s - last.time_utc_s,
                offset.mean,
                offset.deviation,
            ))
        })
        .collect();
    let line = Line::through(&offsets)?;
    let warmth: Option<Vec<(f64, f64, f64)>> = (own.iter())
        .map(|s| Some((s.time_utc_s - last.time_utc_s, s.temperature_c?, 1.0)))
        .collect();
    // Without temperatures a season is unknown: nothing is ruled out by what may be one.
    let warming = Line::through(&warmth?)?;
    let warming_per_s = warming.slope.abs() + warming.slope_deviation;
    let largest = offsets.iter().take(LARGEST_OF).map(|o| o.1);
    let level = largest.fold(line.level + FACTOR * line.level_deviation, f64::max);
    let widest = offsets.iter().map(|o| o.2).fold(0.0, f64::max);
    let pace =
        line.slope.max(0.0) + FACTOR * (line.slope_deviation + drift_rad_per_k * warming_per_s);
    let ahead_s = (now_utc_s - last.time_utc_s).max(0.0) + horizon_s;
    let bound = level + FACTOR * widest + pace * ahead_s;
    bound.is_finite().then_some(bound)
}

/// A weighted line, at time 0.
struct Line {
    level: f64,
    level_deviation: f64,
    slope: f64,
    slope_deviation: f64,
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
            level_deviation: (scatter * (1.0 / w + t * t / tt)).sqrt(),
            slope,
            slope_deviation: (scatter / tt).sqrt(),
        };
        let finite = [
            out.level,
            out.level_deviation,
            out.slope,
            out.slope_deviation,
        ];
        finite.iter().all(|x| x.is_finite()).then_some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_model::Gaussian;

    /// Thirty days at 2 mrad that grow by 0.01 mrad a day; `last`: what the last one says, rad.
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
    fn a_steady_line_goes_on_and_leaves_three_deviations_of_a_session() {
        // 2 mrad, 0.01 mrad a day for 30 days, 3 · 0.1 mrad: an exact line scatters by nothing.
        let found = bound(&month(2e-3), 30.0).unwrap();
        assert!((found - 2.6e-3).abs() < 1e-9, "{found}");
    }

    #[test]
    fn what_jumped_in_the_last_session_is_never_called_far() {
        assert!(bound(&month(16e-3), 30.0).unwrap() > 16e-3);
    }

    #[test]
    fn a_session_that_was_low_doesnt_pull_the_bound_below_the_others() {
        assert!(bound(&month(-20e-3), 30.0).unwrap() > 2e-3);
    }

    #[test]
    fn a_silent_robot_is_bounded_from_its_last_session_on() {
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
    fn a_season_that_may_hide_creep_widens_the_bound() {
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
