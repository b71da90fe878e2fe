//! Forecasts of recently tensioned tendons, compared with the true creep of their ropes.

use super::YearError;
use crate::numbers::mean;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use serde::{Deserialize, Serialize};
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_model::statistics::upper_median;
use sinew_model::transmission::Tendon;
use sinew_rope::{Catalogue, CatalogueRope, Draws};
use sinew_sim::year::surrogate::{SessionErrors, records};
use sinew_sim::year::truth;
use sinew_trend::filter::{Paths, Prior, Trend, TrendConfig};
use sinew_trend::prior;

/// Days with a session.
const FORECAST_DAY: usize = 10;
/// Days that are forecast.
const TARGET_DAYS: [usize; 3] = [30, 60, 300];

/// Prior information on a tendon's rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RopePrior {
    /// Creep law of the rope.
    Law,
    /// Length and pulley of the tendon only.
    Tendon,
    /// Neither rope nor tendon.
    Nothing,
}

impl RopePrior {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Law, Self::Tendon, Self::Nothing];

    /// Label in tables.
    pub fn label(self) -> &'static str {
        match self {
            Self::Law => "creep law of the rope",
            Self::Tendon => "any rope of the catalogue",
            Self::Nothing => "none",
        }
    }
}

/// Accuracy of the forecasts with one prior.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Extrapolation {
    /// Prior information on the rope.
    pub prior: RopePrior,
    /// Number of tendons.
    pub tendons: u64,
    /// Results by the forecast day.
    pub days: Vec<ExtrapolationDay>,
}

/// Accuracy of the forecasts of one day.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExtrapolationDay {
    /// Days since tensioning.
    pub day: f64,
    /// Coverage of the 95 % interval.
    pub coverage_share: f64,
    /// Median of |error|, rad.
    pub median_error_rad: f64,
    /// Median half-width of the interval, rad.
    pub half_width_95_rad: f64,
}

/// Forecasts `tendons` of a robot after ten days of sessions.
///
/// # Errors
/// Returns a [`YearError`] for a tendon or rope that is not described.
pub fn extrapolate(
    robot: &Robot,
    catalogue: &Catalogue,
    rope_prior: RopePrior,
    tendons: u64,
) -> Result<Extrapolation, YearError> {
    let transmissions = robot.transmissions.iter().flatten();
    let own: Vec<&Tendon> = transmissions.filter_map(|t| t.tendon.as_ref()).collect();
    let ropes: Vec<&CatalogueRope> = (catalogue.ropes().iter())
        .filter(|rope| Draws::new(rope, 0, 1).is_ok())
        .collect();
    let mut covered = [const { Vec::new() }; 3];
    let mut errors_rad = covered.clone();
    let mut halves_rad = covered.clone();
    for seed in 0..tendons {
        let mut rng = ChaCha8Rng::seed_from_u64(77_000 + seed);
        let mut tendon = own[rng.random_range(0..own.len())].clone();
        let rope = match rope_prior {
            RopePrior::Law => catalogue.find(tendon.rope.as_deref().unwrap_or_default())?,
            RopePrior::Tendon | RopePrior::Nothing => {
                let rope = ropes[rng.random_range(0..ropes.len())];
                let law = Draws::new(rope, 0, 1)?.nominal;
                let share = 0.01 * 8.0_f64.powf(rng.random());
                tendon.pretension_n = Some(share * law.parameters().breaking_load_n);
                rope
            }
        };
        let celsius = truth::temperatures_c(&mut rng);
        let of_batch: f64 = StandardNormal.sample(&mut rng);
        let year = truth::draw(rope, &tendon, &celsius, rng.random(), false)?;
        let creep_rad: Vec<f64> = (year.creep_rad.iter())
            .map(|c| (0.15 * of_batch).exp() * c)
            .collect();
        // Like the records of a fleet: a session reports its total interval and no parts.
        let errors = SessionErrors {
            parts_specified: false,
            ..SessionErrors::work()
        };
        let sessions = records(
            &creep_rad[..=FORECAST_DAY],
            &celsius,
            None,
            &errors,
            &mut rng,
        );
        let prior = match (rope_prior, tendon.pretension_n) {
            (RopePrior::Law, Some(pretension_n)) => Prior::new(prior::rope_curves(
                rope,
                &tendon,
                pretension_n,
                None,
                21.0,
                1,
            )?),
            (RopePrior::Law, None) => {
                return Err(YearError::Joint(tendon.rope.unwrap_or_default()));
            }
            (RopePrior::Tendon, _) => prior::any_rope(catalogue.ropes(), Some(&tendon), 21.0, 1).0,
            (RopePrior::Nothing, _) => prior::any_rope(catalogue.ropes(), None, 21.0, 1).0,
        };
        let prior = Prior {
            temperature_ref_c: celsius[0],
            ..prior
        };
        let mut trend = Trend::new(prior, TrendConfig::default())?;
        for session in sessions {
            trend.add(session)?;
        }
        let times = TARGET_DAYS.map(|day| day as f64 * DAY_S);
        let mut drawn = ChaCha8Rng::seed_from_u64(5);
        let mut normal = || StandardNormal.sample(&mut drawn);
        let paths = Paths::draw(&trend, &times, 400, &mut normal);
        for (k, day) in TARGET_DAYS.into_iter().enumerate() {
            let mut at: Vec<f64> = paths.offset_rad.iter().map(|path| path[k]).collect();
            at.sort_by(f64::total_cmp);
            let inside = (at[10]..=at[389]).contains(&creep_rad[day]);
            covered[k].push(f64::from(u8::from(inside)));
            errors_rad[k].push((at[200] - creep_rad[day]).abs());
            halves_rad[k].push(0.5 * (at[389] - at[10]));
        }
    }
    let middle = |values: &mut Vec<f64>| upper_median(values).unwrap_or(f64::NAN);
    let day = |k: usize| ExtrapolationDay {
        day: TARGET_DAYS[k] as f64,
        coverage_share: mean(&covered[k]),
        median_error_rad: middle(&mut errors_rad[k]),
        half_width_95_rad: middle(&mut halves_rad[k]),
    };
    Ok(Extrapolation {
        prior: rope_prior,
        tendons,
        days: (0..TARGET_DAYS.len()).map(day).collect(),
    })
}
