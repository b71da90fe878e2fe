//! `outliers`: which tendons depart from those of their kind, and how many would by chance.

mod show;

use crate::FleetError;
use crate::args::Outliers;
use crate::compare::CreepUnit;
use crate::compare::design::Design;
use crate::compare::values::usual_widths;
use crate::creep::Ages;
use crate::engine::Engine;
use crate::folder::sides::Fitted;
use crate::gather::{CreepingTendon, FleetTable, gather};
use crate::hierarchy::{Draws, sample};
use crate::rows::report_rejected;
use std::process::ExitCode;

/// Maximum expected number of equal deviations by chance in the whole fleet for a significant outlier.
const MAX_EXPECTED_BY_CHANCE: f64 = 0.05;
/// Half-width of a 95 % interval in standard deviations.
const Z95: f64 = 1.959_963_984_540_054;

/// Tendon that deviates from its kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlier {
    /// Name of the robot.
    pub robot: String,
    /// Name of the joint.
    pub joint: String,
    /// Site of the robot, if specified.
    pub site: Option<String>,
    /// Rope and batch, if specified.
    pub fit: Fitted,
    /// Creep per decade in the unit of the list, and its standard deviation.
    pub creep: [f64; 2],
    /// Ratio of the creep to the usual creep for its kind, temperature, site and batch: value and 95 % interval. Negative for a
    /// shrinking tendon.
    pub ratio: [f64; 3],
    /// Expected number of tendons of the fleet that deviate as far by chance.
    pub by_chance: f64,
}

impl Outlier {
    /// Whether the creep is significantly larger than usual.
    pub fn is_significantly_more(&self) -> bool {
        self.ratio[0] > 1.0 && self.by_chance <= MAX_EXPECTED_BY_CHANCE
    }
}

/// Deviating tendons of a fleet.
#[derive(Debug, Clone, PartialEq)]
pub struct OutlierList {
    /// Outliers, the least probable first.
    pub outliers: Vec<Outlier>,
    /// Expected number of outliers by chance, if tendons are normally distributed.
    pub expected_by_chance: f64,
    /// Number of evaluated tendons.
    pub tendons: usize,
    /// Number of tendons with too few sessions at these ages.
    pub too_few: usize,
    /// Ages of the ropes over which they were.
    pub ages: Ages,
    /// Unit of the creep.
    pub unit: CreepUnit,
}

/// Looks through a fleet.
///
/// # Errors
/// [`FleetError`].
pub fn outliers(engine: &mut Engine, request: &Outliers) -> Result<OutlierList, FleetError> {
    let gathered = gather(engine, &request.robots, request.ages)?;
    departing(&gathered, request)
}

/// Deviating tendons of a fleet table.
///
/// The deviation of a tendon is `d = z − ẑ`: the logarithm of its creep minus the prediction for its kind, temperature, site and
/// batch. With the usual deviation `w` of its kind (half of the central 68 % range), the variance `v` of its measurement and `u`
/// of `ẑ`, `d / √(w² + v + u)` is compared with a standard normal distribution. Tendons are listed if fewer than the requested
/// number are expected by chance.
///
/// The interval of the ratio `c e^−ẑ` is logarithmic if `c` exceeds twice its standard deviation `s`. Otherwise it is
/// `(c ± 1.96 √(s² + c² u)) e^−ẑ`, because a shrinking tendon has no logarithm.
///
/// # Errors
/// [`FleetError::TooFewTendons`], [`FleetError::NoDraws`], [`FleetError::DrawsApart`].
pub fn departing(gathered: &FleetTable, request: &Outliers) -> Result<OutlierList, FleetError> {
    /// Minimum number of tendons.
    const MIN_TENDONS: usize = 20;
    let tendons = &gathered.tendons;
    if tendons.len() < MIN_TENDONS {
        return Err(FleetError::TooFewTendons {
            tendons: tendons.len(),
            needed: MIN_TENDONS,
            too_few: gathered.too_few,
            ages: request.ages,
        });
    }
    let design = Design::by_any_batch(tendons);
    let draws = sample(&design.hierarchy, request.seed).ok_or(FleetError::NoDraws)?;
    if !draws.have_converged() {
        return Err(FleetError::DrawsApart {
            ratio: draws.disagreement,
        });
    }
    let usual = usual(&design, &draws);
    let values = design.logarithms.iter().zip(&design.hierarchy.units);
    let departures: Vec<(f64, f64)> = values
        .zip(&usual)
        .map(|((value, unit), (mean, _))| (value - mean, unit.variance))
        .collect();
    let widths = usual_widths(&departures, tendons);
    let count = tendons.len() as f64;
    let mut outliers: Vec<Outlier> = Vec::new();
    for (i, tendon) in tendons.iter().enumerate() {
        let ((d, v), (_, u)) = (departures[i], usual[i]);
        let z = d / (widths[i] * widths[i] + v + u).sqrt();
        let by_chance = count * libm::erfc(z.abs() * std::f64::consts::FRAC_1_SQRT_2);
        if by_chance > request.by_chance {
            continue;
        }
        let [c, s] = creep_of(tendon, design.unit);
        let ratio = ratio([c, s], usual[i]);
        outliers.push(Outlier {
            robot: tendon.robot.clone(),
            joint: tendon.joint.clone(),
            site: tendon.site.clone(),
            fit: tendon.fit.clone(),
            creep: [c, s],
            ratio,
            by_chance,
        });
    }
    outliers.sort_by(|a, b| a.by_chance.total_cmp(&b.by_chance));
    Ok(OutlierList {
        outliers,
        expected_by_chance: request.by_chance,
        tendons: tendons.len(),
        too_few: gathered.too_few,
        ages: request.ages,
        unit: design.unit,
    })
}

/// Ratio of the creep `c ± s` to the usual creep, whose logarithm has a mean and a variance: value and 95 % interval.
fn ratio([c, s]: [f64; 2], (mean, variance): (f64, f64)) -> [f64; 3] {
    let usual = mean.exp();
    if c > 2.0 * s {
        let half = Z95 * ((s / c).powi(2) + variance).sqrt();
        return [0.0, -half, half].map(|x| c / usual * x.exp());
    }
    let half = Z95 * (s * s + c * c * variance).sqrt();
    [c, c - half, c + half].map(|x| x / usual)
}

fn creep_of(tendon: &CreepingTendon, unit: CreepUnit) -> [f64; 2] {
    let factor = match unit {
        CreepUnit::Strain => tendon.strain_per_rad.unwrap_or(f64::NAN),
        CreepUnit::Offset => 1.0,
    };
    [tendon.creep.per_decade_rad, tendon.creep.std_rad].map(|x| factor * x)
}

/// Mean and variance of the logarithm of the usual creep of each tendon.
pub(crate) fn usual(design: &Design, draws: &Draws) -> Vec<(f64, f64)> {
    let count = draws.coefficients.len() as f64;
    let of = |unit: &crate::hierarchy::Unit| {
        let values = draws
            .coefficients
            .iter()
            .map(|b| unit.columns.iter().map(|(c, x)| x * b[*c]).sum::<f64>());
        let (sum, squares) = values.fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
        let mean = sum / count;
        (mean, (squares / count - mean * mean).max(0.0))
    };
    design.hierarchy.units.iter().map(of).collect()
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(request: &Outliers) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::open(&request.source)?;
    let list = outliers(&mut engine, request)?;
    print!("{}", show::text(&list, request));
    if let Some(path) = &request.csv {
        show::csv(&list, path)?;
    }
    let rejected = report_rejected(&engine.folder);
    Ok(
        match list.outliers.iter().any(Outlier::is_significantly_more) {
            true => ExitCode::from(3),
            false => rejected,
        },
    )
}
