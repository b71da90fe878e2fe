//! One robot's year, assessed for every forecaster.

use super::chain::Session;
use super::result::{DayForecast, DayInterval, Forecaster, RobotYear, TendonResult};
use super::simulated_year::{DAYS_PER_YEAR, Roped, SimulatedYear, roped};
use super::{YearError, YearRequest};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_model::statistics::quantile;
use sinew_rope::Catalogue;
use sinew_sim::year::surrogate::{self, Failure};
use sinew_sim::year::truth::TendonYear;
use sinew_trend::filter::{Paths, Prior, Record, Trend, TrendConfig, TrendNow, first_passage};

/// Days of the forecasts.
const FORECAST_DAYS: [usize; 3] = [60, 90, 120];
/// Maximum distance of an alarm's record from a failure to be assigned to it, days.
const MAX_DISTANCE_DAYS: f64 = 3.0;

/// Data common to all years.
pub(super) struct Fleet<'a> {
    request: &'a YearRequest,
    roped: Vec<Roped<'a>>,
    /// Priors of each forecaster, per monitored tendon.
    priors: Vec<Vec<(Forecaster, Prior)>>,
}

impl<'a> Fleet<'a> {
    pub(super) fn new(
        robot: &'a Robot,
        catalogue: &'a Catalogue,
        request: &'a YearRequest,
    ) -> Result<Self, YearError> {
        let roped = roped(robot, catalogue, &request.joints)?;
        let mut priors = Vec::new();
        for r in roped.iter().filter(|r| r.monitored) {
            let mut own = Vec::new();
            for &who in &request.forecasters {
                let curves = request.oracle_curves;
                own.push((who, who.prior(r.rope, r.tendon, &request.errors, curves)?));
            }
            priors.push(own);
        }
        Ok(Self {
            request,
            roped,
            priors,
        })
    }

    /// Returns the true year of the robot with this seed.
    pub(super) fn life(&self, seed: u64) -> Result<SimulatedYear, YearError> {
        SimulatedYear::draw(seed, &self.roped)
    }

    /// The year of a seed, its sessions drawn.
    pub(super) fn year(&self, seed: u64) -> Result<RobotYear, YearError> {
        let life = self.life(seed)?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5e55_1011_0000_0000);
        let records: Vec<Vec<Record>> = life
            .tendons
            .iter()
            .take(self.priors.len())
            .map(|(joint, year)| {
                let own = life.failure_of(joint);
                let errors = &self.request.errors;
                let days = &year.creep_rad[..=DAYS_PER_YEAR];
                surrogate::records(days, &life.temperature_c, own, errors, &mut rng)
            })
            .collect();
        self.assess(&life, &records)
    }

    /// The year of a life whose sessions were simulated.
    pub(super) fn chained(
        &self,
        life: &SimulatedYear,
        sessions: &[Session],
    ) -> Result<RobotYear, YearError> {
        let records: Vec<Vec<Record>> = life
            .tendons
            .iter()
            .take(self.priors.len())
            .map(|(joint, _)| sessions.iter().filter_map(|s| record(s, joint)).collect())
            .collect();
        self.assess(life, &records)
    }

    /// Passes each monitored tendon's records to the forecasters.
    fn assess(
        &self,
        life: &SimulatedYear,
        records: &[Vec<Record>],
    ) -> Result<RobotYear, YearError> {
        let mut tendons = Vec::new();
        for (i, priors) in self.priors.iter().enumerate() {
            let (joint, year) = &life.tendons[i];
            let own = life.failure_of(joint);
            for (who, prior) in priors {
                let reference_c = life.temperature_c[0];
                let prior = Prior {
                    temperature_ref_c: reference_c,
                    ..prior.clone()
                };
                let mut result = TendonResult::new(*who, joint);
                follow(prior, &records[i], year, own, life.seed, &mut result)?;
                tendons.push(result);
            }
        }
        Ok(RobotYear {
            seed: life.seed,
            failed_joint: life.failed_joint.clone(),
            failure: life.failure,
            tendons,
        })
    }
}

/// Returns the record that the trend receives of a simulated session.
fn record(session: &Session, joint: &str) -> Option<Record> {
    let own = session.joints.iter().find(|j| j.name == joint)?;
    Some(Record {
        time_s: session.day as f64 * DAY_S,
        offset_rad: own.offset_rad,
        shared: own.systematic_error,
        temperature_c: Some(session.temperature_c),
        reference_c: None,
        stiffness: Some(own.stiffness_ratio),
    })
}

/// Gives a year's records to a trend, day by day.
fn follow(
    prior: Prior,
    records: &[Record],
    year: &TendonYear,
    failure: Option<Failure>,
    seed: u64,
    out: &mut TendonResult,
) -> Result<(), YearError> {
    let mut trend = Trend::new(prior, TrendConfig::default())?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x00f0_7eca_5700);
    let true_rad = |day: usize, failed_by: usize| {
        let jump = failure.filter(|f| day >= f.day && f.day <= failed_by);
        year.creep_rad[day] + jump.map_or(0.0, |f| f.size_rad)
    };
    let (mut squares, mut half_widths) = (0.0, 0.0);
    for record in records {
        let day = (record.time_s / DAY_S).round() as usize;
        if let Some(event) = trend.add(out.forecaster.takes(*record))?.confirmed {
            let at = event.time_s / DAY_S;
            // A failure shows in the first conclusive session after it.
            match failure.filter(|f| (at - f.day as f64).abs() <= MAX_DISTANCE_DAYS) {
                Some(f) if out.found_after_days.is_none() => {
                    out.found_after_days = Some(event.confirmed_s / DAY_S - f.day as f64);
                }
                _ if sudden(&year.creep_rad, at.round() as usize) => {
                    out.sudden_creep_days.push(event.confirmed_s / DAY_S);
                }
                _ => out.false_alarm_days.push(event.confirmed_s / DAY_S),
            }
        }
        if day.is_multiple_of(15) {
            let found = TrendNow::of(&trend).offset_rad;
            let error = found.mean - true_rad(day, day);
            squares += error * error;
            half_widths += found.half_width_95();
            let days = match failure {
                Some(failure) if day >= failure.day => &mut out.failed,
                _ => &mut out.whole,
            };
            days.checked += 1;
            days.inside_95 += usize::from(error.abs() <= found.half_width_95());
        }
        if FORECAST_DAYS.contains(&day) {
            let path: Vec<f64> = (day..year.creep_rad.len())
                .map(|d| true_rad(d, day))
                .collect();
            let times: Vec<f64> = (day..year.creep_rad.len()).map(|d| d as f64).collect();
            let true_day = first_passage(&times, &[path], year.limit_rad)[0];
            if true_day > day as f64 && true_day.is_finite() {
                out.forecasts
                    .push(forecast(&trend, day, true_day, year.limit_rad, &mut rng));
            }
        }
    }
    let checked = out.whole.checked + out.failed.checked;
    let counted = f64::max(checked as f64, 1.0);
    out.error_rms_rad = (squares / counted).sqrt();
    out.half_width_95_rad = half_widths / counted;
    Ok(())
}

/// Whether the rope itself elongated, within a day of `day`, by at least the smallest reported step more than on the
/// adjacent days.
fn sudden(creep_rad: &[f64], day: usize) -> bool {
    let grown = |d: usize| match (
        d.checked_sub(1).and_then(|b| creep_rad.get(b)),
        creep_rad.get(d),
    ) {
        (Some(before), Some(then)) => then - before,
        _ => 0.0,
    };
    let least = TrendConfig::default().least_jump_rad;
    (day.saturating_sub(1).max(2)..=day + 1)
        .any(|d| grown(d) - grown(d - 1).max(grown(d + 1)) >= least)
}

fn forecast(
    trend: &Trend,
    day: usize,
    true_day: f64,
    limit_rad: f64,
    rng: &mut ChaCha8Rng,
) -> DayForecast {
    const PATHS: usize = 1000;
    const STEPS: i32 = 120;
    const HORIZON_DAYS: f64 = 3652.5;
    let ratio = (HORIZON_DAYS / day as f64).powf(1.0 / f64::from(STEPS));
    let times: Vec<f64> = (0..=STEPS)
        .map(|i| trend.time_s() * ratio.powi(i))
        .collect();
    let paths = Paths::draw(trend, &times, PATHS, &mut || StandardNormal.sample(rng));
    let mut found = first_passage(&paths.times_s, &paths.offset_rad, limit_rad);
    found.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| {
        let t = quantile(&found, share);
        t.is_finite().then_some(t / DAY_S)
    };
    DayForecast {
        made_day: day as f64,
        true_day,
        median_day: at(0.5),
        interval_90_day: DayInterval {
            low: at(0.05),
            high: at(0.95),
        },
        interval_95_day: DayInterval {
            low: at(0.025),
            high: at(0.975),
        },
    }
}
