//! Creep rate of a tendon's rope: elongation per decade of time, from its sessions.
//!
//! The creep of ropes from day 1 to day 10 is about that from day 10 to day 100, but not exactly. Ropes are therefore compared over
//! the same range of ages; the growth per decade within that range requires no creep law.

mod line;
mod steps;

use line::Bin;
use sinew_files::date::DAY_S;
use sinew_model::statistics::quantile;
use sinew_trend::SessionRecord;

/// Largest share of the age range, in decades, without sessions at its beginning and at its end.
const MISSING_SHARES: [f64; 2] = [0.3, 0.15];
/// Minimum number of sessions of an estimate.
const MIN_SESSIONS: usize = 10;
/// Bins per decade of age. Equal weights of the bins keep the last months from outweighing the first weeks.
const BINS_PER_DECADE: f64 = 10.0;
/// Standard deviation of a mean of many sessions that does not average out, rad; creep proceeds in steps of work.
const BIN_RAD: f64 = 0.07e-3;

/// Range of rope ages, days since installation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ages {
    /// Lower limit of the range, days.
    pub from_days: f64,
    /// Upper limit of the range, days.
    pub to_days: f64,
}

impl Ages {
    /// Whether sessions from `first` to `last`, decimal logarithms of the age, cover nearly the whole range.
    fn are_covered(&self, first: f64, last: f64) -> bool {
        let [from, to] = [self.from_days.log10(), self.to_days.log10()];
        let [begin, end] = MISSING_SHARES.map(|share| share * (to - from));
        first <= from + begin && last >= to - end
    }
}

/// Creep rate of a rope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Creep {
    /// Offset per decade of time since the rope was fitted, rad.
    pub per_decade_rad: f64,
    /// Standard deviation of the creep per decade, rad.
    pub std_rad: f64,
    /// Mean temperature, °C; `None`: not recorded.
    pub temperature_c: Option<f64>,
    /// Age of the rope at the first and last session, days.
    pub age_days: [f64; 2],
    /// Number of sessions.
    pub sessions: usize,
    /// Number of excluded step changes.
    pub steps: usize,
    /// Whether the installation date of the rope is known; otherwise the age counts from the first session.
    pub is_dated: bool,
}

/// Data point of the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    /// Logarithm to the base of 10 of the rope's age in days.
    log_age: f64,
    offset_rad: f64,
    /// Difference to the mean temperature, K; 0 if not recorded.
    temperature_difference_k: f64,
    /// Piece with a common zero; a tensioning or a step change begins the next piece.
    piece: usize,
}

/// Elongation per decade of a tendon.
///
/// `y = c_p + s·log₁₀ t + α (T − T̄) + e`: a zero `c_p` for each piece between tensionings and sudden changes, `t` the
/// age of the rope, `α` a drift with temperature that is 0 ± `drift_rad_per_k` before. Medians of bins of a tenth of
/// a decade, weighted; the deviation is by their scatter about the line, or what sessions scatter by if that is more.
///
/// * `fitted_utc_s`: installation time of the rope; `None`: one day before the first session.
///
/// Returns `None` if fewer than 10 sessions have these ages or if they leave too large a part of the range uncovered.
pub fn creep(
    sessions: &[SessionRecord],
    fitted_utc_s: Option<f64>,
    ages: Ages,
    drift_rad_per_k: f64,
) -> Option<Creep> {
    let since = fitted_utc_s.unwrap_or(f64::NEG_INFINITY);
    let begins = fitted_utc_s.unwrap_or(sessions.first()?.time_utc_s - DAY_S);
    let age_days = |s: &SessionRecord| (s.time_utc_s - begins) / DAY_S;
    let within = |s: &&SessionRecord| {
        s.time_utc_s > since && (ages.from_days..=ages.to_days).contains(&age_days(s))
    };
    let sessions: Vec<&SessionRecord> = sessions.iter().filter(within).collect();
    let temperatures: Vec<f64> = sessions.iter().filter_map(|s| s.temperature_c).collect();
    let temperature_c = (2 * temperatures.len() > sessions.len())
        .then(|| temperatures.iter().sum::<f64>() / temperatures.len() as f64);
    let mut points = Vec::with_capacity(sessions.len());
    let (mut piece, mut baseline) = (0, None::<&Option<String>>);
    for session in &sessions {
        if baseline.is_some_and(|b| *b != session.baseline) {
            piece += 1;
        }
        baseline = Some(&session.baseline);
        let Some(offset) = session.offset_rad else {
            continue;
        };
        let difference = session.temperature_c.zip(temperature_c);
        points.push(Point {
            log_age: age_days(session).log10(),
            offset_rad: offset.mean,
            temperature_difference_k: difference.map_or(0.0, |(t, mean)| t - mean),
            piece,
        });
    }
    let (first, last) = (points.first()?.log_age, points.last()?.log_age);
    if points.len() < MIN_SESSIONS || !ages.are_covered(first, last) {
        return None;
    }
    let scatter_rad = scatter(&points)?;
    let steps = steps::part(&mut points, scatter_rad);
    let line = line::fit(&bins(&points, scatter_rad), drift_rad_per_k)?;
    Some(Creep {
        per_decade_rad: line.slope,
        std_rad: line.slope_std,
        temperature_c,
        age_days: [first, last].map(|log| 10.0_f64.powf(log)),
        sessions: points.len(),
        steps,
        is_dated: fitted_utc_s.is_some(),
    })
}

/// Standard deviation of a single session, rad, from the median difference of consecutive sessions.
fn scatter(points: &[Point]) -> Option<f64> {
    /// A normal distribution's standard deviation over its median absolute deviation.
    const NORMAL: f64 = 1.4826;
    let pairs = points.windows(2).filter(|w| w[0].piece == w[1].piece);
    let mut apart: Vec<f64> = pairs
        .map(|w| (w[1].offset_rad - w[0].offset_rad).abs())
        .collect();
    apart.sort_by(f64::total_cmp);
    let middle = quantile(&apart, 0.5);
    (middle > 0.0).then_some(NORMAL * middle * std::f64::consts::FRAC_1_SQRT_2)
}

/// Medians of a piece's sessions of about one age.
fn bins(points: &[Point], scatter_rad: f64) -> Vec<Bin> {
    /// Ratio of the variance of a median to that of a mean.
    const MEDIAN: f64 = 1.57;
    let place = |p: &Point| (p.piece, (p.log_age * BINS_PER_DECADE).floor());
    let together = points.chunk_by(|a, b| place(a) == place(b));
    together
        .map(|of| {
            let n = of.len() as f64;
            let mean = |f: fn(&Point) -> f64| of.iter().map(f).sum::<f64>() / n;
            let mut offsets: Vec<f64> = of.iter().map(|p| p.offset_rad).collect();
            offsets.sort_by(f64::total_cmp);
            Bin {
                log_age: mean(|p| p.log_age),
                offset_rad: quantile(&offsets, 0.5),
                temperature_difference_k: mean(|p| p.temperature_difference_k),
                variance: BIN_RAD * BIN_RAD + MEDIAN.min(n) * scatter_rad * scatter_rad / n,
                piece: of[0].piece,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests;
