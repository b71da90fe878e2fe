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
use crate::gather::{CreepingTendon, Gathered, gather};
use crate::hierarchy::{Draws, sample};
use crate::rows::tell_refused;
use std::process::ExitCode;

/// A tendon that departs is sure where fewer than this many would by chance in the whole fleet.
const SURE: f64 = 0.05;
/// Standard deviations of a 95 % interval.
const Z95: f64 = 1.959_963_984_540_054;

/// A tendon that departs from its kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlier {
    /// Robot.
    pub robot: String,
    /// Joint.
    pub joint: String,
    /// Site, if it is known.
    pub site: Option<String>,
    /// Rope and batch.
    pub fit: Fitted,
    /// Its creep per decade, in the list's unit, and the deviation of that.
    pub creep: [f64; 2],
    /// Its creep over what is usual for its kind, temperature, site and batch: the value and its 95 % interval. Below 0 where
    /// it shrinks.
    pub ratio: [f64; 3],
    /// How many tendons of the fleet would depart so far by chance, if all were usual.
    pub by_chance: f64,
}

impl Outlier {
    /// It creeps more than is usual, and chance hardly does that.
    pub fn is_surely_more(&self) -> bool {
        self.ratio[0] > 1.0 && self.by_chance <= SURE
    }
}

/// Tendons that depart.
#[derive(Debug, Clone, PartialEq)]
pub struct OutlierList {
    /// Those that do, the least probable first.
    pub outliers: Vec<Outlier>,
    /// How many of them are there by chance, on average, if tendons differ normally.
    pub expected_by_chance: f64,
    /// Tendons that were looked at.
    pub tendons: usize,
    /// Tendons with too few sessions of these ages.
    pub too_few: usize,
    /// Ages of the ropes over which they were.
    pub ages: Ages,
    /// What creep is given in.
    pub unit: CreepUnit,
}

/// Looks through a fleet.
///
/// # Errors
/// [`FleetError`].
pub fn outliers(engine: &mut Engine, asked: &Outliers) -> Result<OutlierList, FleetError> {
    let gathered = gather(engine, &asked.robots, asked.ages)?;
    departing(&gathered, asked)
}

/// Tendons that depart, of some that were gathered.
///
/// A tendon departs by `d = z − ẑ`: the logarithm of its creep less what its kind, temperature, site and batch say. With
/// `w`, what the tendons of its kind usually depart by (half of what the middle 68 % span), the variance `v` of its
/// measurement and `u` of `ẑ`, `d / √(w² + v + u)` is held against a normal distribution. Those are listed that fewer than
/// the number asked for would be by chance.
///
/// What it creeps by over what is usual, `c e^−ẑ`, has an interval over the logarithm where `c` is above twice its deviation `s`.
/// Else it has one over `c` itself, `(c ± 1.96 √(s² + c² u)) e^−ẑ`: a tendon that shrinks has no logarithm.
///
/// # Errors
/// [`FleetError::TooFewTendons`], [`FleetError::NoDraws`], [`FleetError::DrawsApart`].
pub fn departing(gathered: &Gathered, asked: &Outliers) -> Result<OutlierList, FleetError> {
    /// Below this nothing is usual.
    const LEAST: usize = 20;
    let tendons = &gathered.tendons;
    if tendons.len() < LEAST {
        return Err(FleetError::TooFewTendons {
            tendons: tendons.len(),
            needed: LEAST,
            too_few: gathered.too_few,
            ages: asked.ages,
        });
    }
    let design = Design::by_any_batch(tendons);
    let draws = sample(&design.hierarchy, asked.seed).ok_or(FleetError::NoDraws)?;
    if !draws.have_come_together() {
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
        if by_chance > asked.by_chance {
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
        expected_by_chance: asked.by_chance,
        tendons: tendons.len(),
        too_few: gathered.too_few,
        ages: asked.ages,
        unit: design.unit,
    })
}

/// Creep `c ± s` over what is usual, whose logarithm is `mean` with a variance: the value and its 95 % interval.
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
    [tendon.creep.per_decade_rad, tendon.creep.deviation_rad].map(|x| factor * x)
}

/// Of each tendon the mean and variance of what is usual for it.
pub(crate) fn usual(design: &Design, draws: &Draws) -> Vec<(f64, f64)> {
    let count = draws.coefficients.len() as f64;
    let of = |unit: &crate::hierarchy::Unit| {
        let said = draws
            .coefficients
            .iter()
            .map(|b| unit.columns.iter().map(|(c, x)| x * b[*c]).sum::<f64>());
        let (sum, squares) = said.fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
        let mean = sum / count;
        (mean, (squares / count - mean * mean).max(0.0))
    };
    design.hierarchy.units.iter().map(of).collect()
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(asked: &Outliers) -> Result<ExitCode, FleetError> {
    let mut engine = Engine::open(&asked.source)?;
    let list = outliers(&mut engine, asked)?;
    print!("{}", show::text(&list, asked));
    if let Some(path) = &asked.csv {
        show::csv(&list, path)?;
    }
    let refused = tell_refused(&engine.folder);
    Ok(match list.outliers.iter().any(Outlier::is_surely_more) {
        true => ExitCode::from(3),
        false => refused,
    })
}
