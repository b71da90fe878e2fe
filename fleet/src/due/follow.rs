//! A tendon that may come near its limit, by the trend of `sinew trend`.

use super::{screen, state};
use crate::beside::{Beside, tendon_of};
use crate::folder::sides::Fitted;
use crate::sessions::{Sessions, thinned};
use sinew_model::Gaussian;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_trend::{ForecastPoint, JointTrend, Passage, SessionRecord, TrendVerdict};
use std::cmp::Ordering;

/// A drift with temperature somewhat beyond what robot.toml allows for surprises nobody.
const DRIFT_FACTOR: f64 = 1.25;

/// A tendon that was followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Robot.
    pub robot: String,
    /// Joint.
    pub joint: String,
    /// Site, rope and batch, where they are known.
    pub site: Option<String>,
    /// Rope and batch.
    pub fit: Fitted,
    /// What to do.
    pub verdict: TrendVerdict,
    /// Offset since the last tensioning.
    pub offset_rad: Gaussian,
    /// The same as elongation.
    pub elongation_m: Option<Gaussian>,
    /// Last session, s since 1970.
    pub last_utc_s: f64,
    /// Offset at the end of the days asked for; `None`: beyond a year after the last session.
    pub ahead: Option<ForecastPoint>,
    /// Its limits.
    pub passages: Vec<Passage>,
}

impl Followed {
    fn of(
        trend: &JointTrend,
        sessions: &Sessions,
        fit: Fitted,
        site: Option<String>,
        ahead: Option<ForecastPoint>,
    ) -> Self {
        let (robot, joint) = sessions.tendon.clone();
        Self {
            robot,
            joint,
            site,
            fit,
            verdict: trend.verdict,
            offset_rad: trend.offset_rad,
            elongation_m: trend.elongation_m,
            last_utc_s: trend.last_utc_s,
            ahead,
            passages: Passage::all(trend),
        }
    }

    /// The limit that is passed first.
    pub fn worst(&self) -> Option<&Passage> {
        Passage::first(&self.passages)
    }

    /// What has passed its limit comes first, the farthest beyond it before the others; then the earlier, the worse.
    pub(super) fn worse_first(&self, other: &Self) -> Ordering {
        let key = |of: &Self| {
            let worst = of.worst();
            worst.map_or((true, f64::INFINITY), Passage::rank)
        };
        let ((waits, mine), (other_waits, others)) = (key(self), key(other));
        waits.cmp(&other_waits).then(mine.total_cmp(&others))
    }
}

/// What became of a tendon.
pub(super) enum Outcome {
    OutOfReach,
    NoLimit,
    UnknownType(String),
    Refused(String, String, String),
    Followed {
        found: Box<Followed>,
        /// To go on from, for who keeps it.
        kept: Vec<u8>,
        /// Whether it went on from what was kept.
        went_on: bool,
        /// Whether a fleet says how fast its rope creeps.
        creep_known: bool,
    },
}

/// Screens tendons and follows them.
pub(super) struct Followers<'a> {
    pub(super) beside: &'a Beside,
    pub(super) now_utc_s: f64,
    pub(super) within_s: f64,
    pub(super) screen: bool,
    /// Whether trends are kept.
    pub(super) keeps: bool,
}

impl Followers<'_> {
    /// Screens a tendon and follows it, if it isn't out of reach, from where it was kept.
    pub(super) fn look(&self, sessions: &Sessions, kept: Option<&Vec<u8>>) -> Outcome {
        let (name, joint) = &sessions.tendon;
        let Some(robot) = self.beside.robot(sessions) else {
            return Outcome::UnknownType(sessions.robot_type.clone());
        };
        let tendon = tendon_of(robot, joint);
        let Some(tendon) = tendon.filter(|t| t.retension_at_m.or(t.replace_at_strain).is_some())
        else {
            return Outcome::NoLimit;
        };
        if sessions.rows.is_empty()
            || (self.screen && self.is_out_of_reach(robot, tendon, sessions))
        {
            return Outcome::OutOfReach;
        }
        let rows = thinned(&sessions.rows);
        let refused = |why: String| Outcome::Refused(name.clone(), joint.clone(), why);
        let kept = kept.and_then(|bytes| state::trend_of(bytes));
        let followed = match self.beside.trend(sessions, Some(robot), rows, kept) {
            Ok(followed) => followed,
            Err(error) => return refused(error.to_string()),
        };
        let kept = match self.keeps.then(|| state::encoded(&followed.kept)) {
            None => Vec::new(),
            Some(Ok(bytes)) => bytes,
            Some(Err(error)) => return refused(error.to_string()),
        };
        let fit = self.beside.fit(&sessions.tendon);
        let site = self.beside.sites.get(name).cloned();
        let until_utc_s = self.now_utc_s + self.within_s;
        let ahead = followed.offset_after((until_utc_s - followed.trend.last_utc_s).max(0.0));
        Outcome::Followed {
            found: Box::new(Followed::of(&followed.trend, sessions, fit, site, ahead)),
            kept,
            went_on: followed.went_on,
            creep_known: self.beside.is_creep_known(sessions, robot),
        }
    }

    /// Whether no limit can be passed within the days asked for.
    fn is_out_of_reach(&self, robot: &Robot, tendon: &Tendon, sessions: &Sessions) -> bool {
        let drift = DRIFT_FACTOR * robot.tolerances.drift_rad_per_k();
        let bound = screen::bound_rad(&sessions.rows, self.now_utc_s, self.within_s, drift);
        let Some(bound_rad) = bound else {
            return false;
        };
        let radius_m = tendon.joint_pulley_radius_m;
        let near = |limit_rad: f64, bound_rad: f64| bound_rad >= limit_rad;
        let retension = tendon.retension_at_m.map(|m| near(m / radius_m, bound_rad));
        let replace = (tendon.replace_at_strain).map(|s| {
            near(
                s * tendon.length_m / radius_m,
                bound_rad + before_rad(&sessions.rows),
            )
        });
        !retension.unwrap_or(false) && !replace.unwrap_or(false)
    }
}

/// What earlier baselines had come to at most, rad: a strain counts from the first.
fn before_rad(rows: &[SessionRecord]) -> f64 {
    let mut largest: Vec<(&Option<String>, f64)> = Vec::new();
    for row in rows {
        let offset = row.offset_rad.map_or(0.0, |o| o.mean + 3.0 * o.deviation);
        match largest.last_mut() {
            Some(last) if *last.0 == row.baseline => last.1 = last.1.max(offset),
            _ => largest.push((&row.baseline, offset.max(0.0))),
        }
    }
    largest.pop();
    largest.iter().map(|l| l.1).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_files::date::DAY_S;
    use sinew_trend::{Limit, LimitState};

    #[test]
    fn the_farthest_beyond_its_limit_is_the_worst() {
        let of = |robot: &str, state, mrad: f64, day: Option<f64>| Followed {
            robot: robot.into(),
            joint: "elbow".into(),
            site: None,
            fit: Fitted::default(),
            verdict: TrendVerdict::Wait,
            offset_rad: Gaussian::new(1e-3 * mrad, 1e-4),
            elongation_m: None,
            last_utc_s: 0.0,
            ahead: None,
            passages: vec![Passage {
                limit: Limit::Retension { elongation_m: 5e-4 },
                limit_rad: 20e-3,
                beyond_rad: 1e-3 * mrad - 20e-3,
                state,
                passed_probability: 0.5,
                at_utc_s: [day.map(|day| day * DAY_S); 3],
            }],
        };
        let mut all = [
            of("never", LimitState::NotWithinHorizon, 1.0, None),
            of("soon", LimitState::Forecast, 19.0, Some(3.0)),
            of("just", LimitState::Passed, 20.1, Some(0.0)),
            of("later", LimitState::Forecast, 19.9, Some(30.0)),
            of("far", LimitState::Passed, 46.0, Some(0.5)),
        ];
        all.sort_by(Followed::worse_first);
        let names = all.map(|f| f.robot);
        assert_eq!(names, ["far", "just", "soon", "later", "never"]);
    }
}
