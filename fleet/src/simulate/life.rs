//! Simulated history of a tendon, and the records of its monitor.

use super::plan::{Plan, PlannedRobot, SITES, TypeTendon};
use crate::FleetError;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use sinew_files::date::{DAY_S, day_of};
use sinew_rope::Catalogue;
use sinew_sim::year::surrogate::{Failure, SessionErrors, records};
use sinew_sim::year::truth;
use sinew_trend::filter::Record as Session;
use sinew_watch_core::Record;
use sinew_watch_core::record::{Clock, NoOffset};
use std::f64::consts::TAU;

/// Number of days after the last record with known ground truth.
pub(super) const LOOK_AHEAD_DAYS: usize = 365;
/// Expected number of strand failures of a tendon per year.
const FAILURES_PER_YEAR: f64 = 0.03;
/// Share of days without a session.
const IDLE_SHARE: f64 = 0.05;
/// Share of sessions in which the computer's clock stepped.
const STEPPED_SHARE: f64 = 1e-3;
/// Minimum number of days of the year simulator.
const MIN_DAYS: usize = 302;

/// Time at which a limit is exceeded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LookAhead {
    /// Exceeded before the last day.
    Passed,
    /// Exceeded this number of days after the last.
    In(usize),
    /// Not exceeded within the known ground truth.
    Later,
}

/// History of a tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct TendonHistory {
    /// Index in [`Plan::tendons`].
    pub tendon: usize,
    /// Days of tensioning, counted from the robot's first; the first is 0.
    pub tensioned_days: Vec<usize>,
    /// Day of a strand failure, and its step change of the offset, rad.
    pub failure: Option<(usize, f64)>,
    /// True offset since the last tensioning on the last day, rad.
    pub offset_rad: f64,
    /// Time at which the limit is exceeded, without later failures.
    pub passes: LookAhead,
    /// Records of its monitor.
    pub records: Vec<Record>,
}

impl Plan {
    /// Lifetimes of a robot's tendons.
    ///
    /// # Errors
    /// A rope without a complete law.
    pub fn lives(
        &self,
        robot: &PlannedRobot,
        catalogue: &Catalogue,
    ) -> Result<Vec<TendonHistory>, FleetError> {
        let mut rng = ChaCha8Rng::seed_from_u64(robot.seed);
        let days = self.days - robot.since_day;
        let total = (days + LOOK_AHEAD_DAYS).max(MIN_DAYS);
        let temperature_c = temperatures_c(robot, total, &mut rng);
        // Idle days are common to all tendons of a robot.
        let works: Vec<(bool, f64, bool)> = (0..=days)
            .map(|_| {
                let (idle, hour, stepped) = (rng.random::<f64>(), rng.random(), rng.random());
                let stepped: f64 = stepped;
                (idle >= IDLE_SHARE, hour, stepped < STEPPED_SHARE)
            })
            .collect();
        let mut lives = Vec::with_capacity(self.tendons.len());
        for (i, own) in self.tendons.iter().enumerate() {
            let seed = robot.seed ^ (7919 * (i as u64 + 1));
            let batch = &self.batches[robot.batches[i]];
            let rope = catalogue.find(&batch.rope)?;
            let year = truth::draw(rope, &own.tendon, &temperature_c, seed, false)?;
            let creep_rad: Vec<f64> = year.creep_rad.iter().map(|c| batch.factor * c).collect();
            let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5e55_1011);
            let mut life = history(i, own, &creep_rad, days, &mut rng);
            let recording = Recording {
                plan: self,
                robot,
                own,
                creep_rad: &creep_rad,
                temperature_c: &temperature_c,
                works: &works,
            };
            life.records = recording.of(&life, days, &mut rng);
            lives.push(life);
        }
        Ok(lives)
    }
}

/// Air temperature on each morning of a robot, °C.
fn temperatures_c(robot: &PlannedRobot, days: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    /// Standard deviation between days, K.
    const DAILY_STD_K: f64 = 1.5;
    /// Coldest day of the year.
    const COLDEST: f64 = 20.0;
    let site = SITES[robot.site];
    (0..=days)
        .map(|day| {
            let normal: f64 = StandardNormal.sample(rng);
            let of_year = (robot.since_day + day) as f64 - COLDEST;
            site.mean_c - site.season_k * (TAU * of_year / 365.25).cos() + DAILY_STD_K * normal
        })
        .collect()
}

/// Simulates failure and tensioning; a tendon that exceeds its limit is re-tensioned days later.
fn history(
    tendon: usize,
    own: &TypeTendon,
    creep_rad: &[f64],
    days: usize,
    rng: &mut ChaCha8Rng,
) -> TendonHistory {
    let fails = rng.random::<f64>() < FAILURES_PER_YEAR * days as f64 / 365.25;
    let failure =
        (fails && days > 1).then(|| (rng.random_range(1..days), 1e-3 * rng.random_range(2.0..4.0)));
    let offset_rad = |since: usize, day: usize| {
        let jump = failure.filter(|f| (since + 1..=day.min(days)).contains(&f.0));
        creep_rad[day] - creep_rad[since] + jump.map_or(0.0, |f| f.1)
    };
    let mut tensioned_days = vec![0];
    let mut since = 0;
    let passes = loop {
        let passed = (since..creep_rad.len()).find(|d| offset_rad(since, *d) >= own.limit_rad);
        let Some(passed) = passed else {
            break LookAhead::Later;
        };
        let serviced = passed + rng.random_range(2..30);
        if passed > days {
            break LookAhead::In(passed - days);
        }
        if serviced >= days {
            break LookAhead::Passed;
        }
        since = serviced;
        tensioned_days.push(since);
    };
    TendonHistory {
        tendon,
        offset_rad: offset_rad(since, days),
        tensioned_days,
        failure,
        passes,
        records: Vec::new(),
    }
}

/// Inputs of the monitor's records.
struct Recording<'a> {
    plan: &'a Plan,
    robot: &'a PlannedRobot,
    own: &'a TypeTendon,
    creep_rad: &'a [f64],
    temperature_c: &'a [f64],
    /// Whether the robot works, time of the session and whether the clock stepped, for each day.
    works: &'a [(bool, f64, bool)],
}

impl Recording<'_> {
    /// Returns the records of a history, at most one per day.
    fn of(&self, life: &TendonHistory, days: usize, rng: &mut ChaCha8Rng) -> Vec<Record> {
        // A record contains the width of its interval, not its systematic part.
        let errors = SessionErrors {
            parts_specified: false,
            inconclusive_share: 0.01,
            ..SessionErrors::work()
        };
        let mut out = Vec::new();
        let ends = life.tensioned_days.iter().skip(1).copied();
        for (&from, to) in life.tensioned_days.iter().zip(ends.chain([days])) {
            let since: Vec<f64> = (self.creep_rad[from..=to].iter())
                .map(|c| c - self.creep_rad[from])
                .collect();
            let failure = life.failure.filter(|f| (from + 1..=to).contains(&f.0));
            let failure = failure.map(|(day, size_rad)| Failure {
                day: day - from,
                size_rad,
                stiffness_ratio: 0.05,
            });
            let sessions = records(
                &since,
                &self.temperature_c[from..=to],
                failure,
                &errors,
                rng,
            );
            for (i, session) in sessions.iter().enumerate() {
                let day = from + i + 1;
                // On the day of a tensioning the new baseline is learned.
                let (works, hour, stepped) = self.works[day];
                if works && (day != to || to == days) {
                    out.push(self.record(session, from, day, hour, stepped, rng));
                }
            }
        }
        out
    }

    fn record(
        &self,
        session: &Session,
        from: usize,
        day: usize,
        hour: f64,
        stepped: bool,
        rng: &mut ChaCha8Rng,
    ) -> Record {
        let tendon = &self.own.tendon;
        let (radius_m, length_m) = (tendon.joint_pulley_radius_m, tendon.length_m);
        let at_utc_s = |day: usize, hour: f64| {
            let days = (self.robot.since_day + day) as f64;
            self.plan.start_utc_s + days * DAY_S + (7200.0 * hour + 21_600.0).round()
        };
        let offset = session.offset_rad;
        let before_rad = self.creep_rad[from];
        Record {
            robot: self.robot.name.clone(),
            robot_type: self.plan.robot_type.clone(),
            joint: self.own.joint.clone(),
            time_utc_s: at_utc_s(day, hour),
            duration_s: 120.0,
            offset_rad: offset.map(|o| o.mean),
            offset_std_rad: offset.map(|o| o.std),
            elongation_m: offset.map(|o| o.mean * radius_m),
            elongation_std_m: offset.map(|o| o.std * radius_m),
            strain_ratio: offset.map(|o| (before_rad + o.mean) * radius_m / length_m),
            strain_std_ratio: offset.map(|o| o.std * radius_m / length_m),
            temperature_c: session.temperature_c,
            stiffness_ratio: session.stiffness.map(|s| s.mean),
            stiffness_std_ratio: session.stiffness.map(|s| s.std),
            baseline: Some(format!("tensioned-{}", day_of(at_utc_s(from, 0.0)))),
            source: format!("dds:0/{}", self.robot.name),
            clock: if stepped { Clock::Stepped } else { Clock::Utc },
            provisional: false,
            reason: offset.is_none().then_some(NoOffset::TooWide),
            poses: rng.random_range(6..14),
            frames: 60_000,
            frames_lost: 0,
            sinew_version: env!("CARGO_PKG_VERSION").into(),
        }
    }
}
