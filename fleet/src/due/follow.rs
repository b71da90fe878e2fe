//! Trend of a tendon that may approach its limit, identical to that of `sinew trend`.

use super::{screen, state};
use crate::folder::sides::Fitted;
use crate::metadata::{FleetMetadata, tendon_of};
use crate::sessions::Sessions;
use sinew_model::Gaussian;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_trend::{ForecastPoint, JointTrend, Passage, SessionRecord, TrendVerdict};
use std::cmp::Ordering;

/// Tolerated drift with temperature relative to the tolerance of robot.toml.
const DRIFT_FACTOR: f64 = 1.25;

/// Result of a tracked tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackedTendon {
    /// Name of the robot.
    pub robot: String,
    /// Name of the joint.
    pub joint: String,
    /// Site of the robot, if specified.
    pub site: Option<String>,
    /// Rope and batch, if specified.
    pub fit: Fitted,
    /// Recommended action.
    pub verdict: TrendVerdict,
    /// Offset since the last tensioning.
    pub offset_rad: Gaussian,
    /// Elongation since the last tensioning, m.
    pub elongation_m: Option<Gaussian>,
    /// Last session, s since 1970.
    pub last_utc_s: f64,
    /// Offset at the end of the requested days; `None` if more than a year after the last session.
    pub ahead: Option<ForecastPoint>,
    /// First-passage times of the limits.
    pub passages: Vec<Passage>,
}

impl TrackedTendon {
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

    /// Returns the limit that is exceeded first.
    pub fn worst(&self) -> Option<&Passage> {
        Passage::first(&self.passages)
    }

    /// Orders exceeded limits first, by their exceedance, then the others by date.
    pub(super) fn worse_first(&self, other: &Self) -> Ordering {
        let key = |of: &Self| {
            let worst = of.worst();
            worst.map_or((true, f64::INFINITY), Passage::rank)
        };
        let ((waits, mine), (other_waits, others)) = (key(self), key(other));
        waits.cmp(&other_waits).then(mine.total_cmp(&others))
    }
}

/// Result of the evaluation of a tendon.
pub(super) enum Outcome {
    OutOfReach,
    NoLimit,
    UnknownType(String),
    Failed(String, String, String),
    Tracked {
        found: Box<TrackedTendon>,
        /// Stored state for the next run.
        kept: Vec<u8>,
        /// Whether the trend resumed from the stored state.
        is_resumed: bool,
        /// Whether a fleet provides the reference creep of the rope.
        has_reference_creep: bool,
    },
}

/// Evaluates tendons: bound first, trend only where necessary.
pub(super) struct Followers<'a> {
    pub(super) metadata: &'a FleetMetadata,
    pub(super) now_utc_s: f64,
    pub(super) within_s: f64,
    pub(super) screen: bool,
    /// Whether trends are stored.
    pub(super) keeps: bool,
}

impl Followers<'_> {
    /// Evaluates a tendon and tracks it, unless its limit is out of reach, from its stored state.
    pub(super) fn evaluate(&self, sessions: &Sessions, kept: Option<&Vec<u8>>) -> Outcome {
        let (name, joint) = &sessions.tendon;
        let Some(robot) = self.metadata.robot(sessions) else {
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
        let failed = |reason: String| Outcome::Failed(name.clone(), joint.clone(), reason);
        let kept = kept.and_then(|bytes| state::trend_of(bytes));
        let followed = match self.metadata.trend(sessions, Some(robot), kept) {
            Ok(followed) => followed,
            Err(error) => return failed(error.to_string()),
        };
        let kept = match self.keeps.then(|| state::encoded(&followed.kept)) {
            None => Vec::new(),
            Some(Ok(bytes)) => bytes,
            Some(Err(error)) => return failed(error.to_string()),
        };
        let fit = self.metadata.fit(&sessions.tendon);
        let site = self.metadata.sites.get(name).cloned();
        let until_utc_s = self.now_utc_s + self.within_s;
        let ahead = followed.offset_after((until_utc_s - followed.trend.last_utc_s).max(0.0));
        Outcome::Tracked {
            found: Box::new(TrackedTendon::of(
                &followed.trend,
                sessions,
                fit,
                site,
                ahead,
            )),
            kept,
            is_resumed: followed.is_resumed,
            has_reference_creep: self.metadata.has_reference_creep(sessions, robot),
        }
    }

    /// Whether no limit can be exceeded within the requested days.
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

/// Upper bound of the offsets accumulated with earlier baselines, rad; a strain counts from the first.
fn before_rad(rows: &[SessionRecord]) -> f64 {
    let mut largest: Vec<(&Option<String>, f64)> = Vec::new();
    for row in rows {
        let offset = row.offset_rad.map_or(0.0, |o| o.mean + 3.0 * o.std);
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
    fn worse_first_orders_by_exceedance_then_date() {
        let of = |robot: &str, state, mrad: f64, day: Option<f64>| TrackedTendon {
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
        all.sort_by(TrackedTendon::worse_first);
        let names = all.map(|f| f.robot);
        assert_eq!(names, ["far", "just", "soon", "later", "never"]);
    }
}
