//! True creep of a tendon in a simulated year.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use sinew_model::transmission::Tendon;
use sinew_rope::law::{Law, RopeLoad, State};
use sinew_rope::work::{Work, strand};
use sinew_rope::{CatalogueError, CatalogueRope, Draws};

/// A tendon that elongates by less than this from day 60 to day 180 has no day of limit exceedance
/// worth forecasting, rad.
const LEAST_GROWTH_RAD: f64 = 3e-3;
/// Days a year is simulated for: limits are passed by day 300 at the latest.
pub const DAYS: usize = 400;

/// One tendon's year.
#[derive(Debug, Clone, PartialEq)]
pub struct TendonYear {
    /// Creep since the baseline on each morning, rad; entry 0 is the baseline.
    pub creep_rad: Vec<f64>,
    /// Limit of this tendon, rad.
    pub limit_rad: f64,
    /// Tries until a rope and a duty were drawn that still creep after two months.
    pub tries: u32,
}

/// Air temperature on each morning, °C: a season of ± 6 K and days that differ by 1.5 K.
pub fn temperatures_c(rng: &mut ChaCha8Rng) -> Vec<f64> {
    let phase = std::f64::consts::TAU * rng.random::<f64>();
    (0..=DAYS)
        .map(|day| {
            let normal: f64 = StandardNormal.sample(rng);
            let season = (std::f64::consts::TAU * day as f64 / 365.25 + phase).sin();
            21.0 + 6.0 * season + 1.5 * normal
        })
        .collect()
}

/// Draws a simulated year of a tendon: a creep law from the uncertainty of the rope, and a typical duty. With
/// `creeping` the draw is repeated until the tendon creeps enough for a meaningful forecast.
///
/// # Errors
/// [`CatalogueError::NoLaw`].
pub fn draw(
    rope: &CatalogueRope,
    tendon: &Tendon,
    temperature_c: &[f64],
    seed: u64,
    creeping: bool,
) -> Result<TendonYear, CatalogueError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let pretension_n = tendon.pretension_n.unwrap_or(60.0);
    for tries in 1..=200 {
        let law = Draws::new(rope, 1, rng.random())?.laws[0];
        let work = Work::unknown(0.0, &mut rng);
        let Some(creep_rad) = live(&law, tendon, pretension_n, &work, temperature_c, &mut rng)
        else {
            continue;
        };
        if creeping && creep_rad[180] - creep_rad[60] < LEAST_GROWTH_RAD {
            continue;
        }
        let normal: f64 = StandardNormal.sample(&mut rng);
        let day = (180.0 * (0.2 * normal).exp()).clamp(120.0, 300.0);
        return Ok(TendonYear {
            limit_rad: creep_rad[day as usize],
            creep_rad,
            tries,
        });
    }
    Err(CatalogueError::NoLaw {
        name: rope.entry.name.clone(),
        missing: "any draw that still creeps after two months".into(),
    })
}

/// Day by day: eight hours of work with peaks of that day, sixteen hours of rest.
fn live(
    law: &Law,
    tendon: &Tendon,
    pretension_n: f64,
    work: &Work,
    temperature_c: &[f64],
    rng: &mut ChaCha8Rng,
) -> Option<Vec<f64>> {
    const HOUR_S: f64 = 3600.0;
    // The mean over the whole day is the work's; rest is at pretension.
    let working = 1.0 + 3.0 * (work.mean_factor - 1.0);
    let mut days = Vec::with_capacity(temperature_c.len());
    for _ in temperature_c {
        let (a, b): (f64, f64) = (StandardNormal.sample(rng), StandardNormal.sample(rng));
        let peak_s = 24.0 * HOUR_S * work.peak_share * (0.5 * a).exp();
        let peak = work.peak_factor * (1.0 + 0.05 * b).max(0.7);
        days.push((peak_s.min(4.0 * HOUR_S), peak));
    }
    let read = RopeLoad::at_reference(pretension_n);
    let mut out = vec![0.0; temperature_c.len()];
    for portion in strand(tendon) {
        let law = law.passed_by(portion.guides as f64);
        let per_percent = 0.01 * portion.length_m / tendon.joint_pulley_radius_m;
        let mut state = State::default();
        // Tensioned, and an hour until the baseline.
        law.hold(
            &mut state,
            RopeLoad::celsius(pretension_n, temperature_c[0]),
            HOUR_S,
        )
        .ok()?;
        for (day, (&celsius, &(peak_s, peak))) in temperature_c.iter().zip(&days).enumerate() {
            out[day] += per_percent * law.strain(&state, read).ok()?.total_percent();
            let load = |factor: f64| {
                RopeLoad::celsius(pretension_n * factor, celsius + work.temperature_c)
            };
            law.hold(&mut state, load(working), 8.0 * HOUR_S - peak_s)
                .ok()?;
            law.hold(&mut state, load(peak.max(working)), peak_s).ok()?;
            law.hold(&mut state, load(1.0), 16.0 * HOUR_S).ok()?;
        }
    }
    let first = out[0];
    out.iter_mut().for_each(|v| *v -= first);
    Some(out)
}
