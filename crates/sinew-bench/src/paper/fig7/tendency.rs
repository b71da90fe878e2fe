//! Causes of the decrease of the estimate while the elbow rises: each model error alone, both, neither, and errors of
//! the opposite sign.

use super::super::PaperError;
use super::super::analytic::Analytic;
use super::super::sentence::{Sentence, Unit, below};
use super::super::staircase::STEPS;
use super::super::trial::{Estimator, Trial};
use super::plant::{Day, LIGHTER, STIFFER, scenario};
use super::sentences::{ENCODER_STEP_MRAD, rests};
use rayon::prelude::*;
use sinew_model::robot::Robot;

/// Ratios of true to described stiffness and masses, and the resulting description.
const VARIANTS: [(&str, f64, f64); 5] = [
    ("both", STIFFER, LIGHTER),
    ("torque overestimated", 1.0, LIGHTER),
    ("stiffness underestimated", STIFFER, 1.0),
    ("neither", 1.0, 1.0),
    ("opposite sign", 1.0 / STIFFER, 1.0 / LIGHTER),
];

/// First run of a variant.
pub(super) struct Variant {
    pub(super) name: &'static str,
    pub(super) curve: Vec<f64>,
    rests: [f64; STEPS],
}

impl Variant {
    /// The estimate falls from every rest to the next.
    fn falls(&self) -> bool {
        self.rests.windows(2).all(|pair| pair[1] < pair[0])
    }

    /// Estimate of the last rest minus the first, mrad.
    fn change_mrad(&self) -> f64 {
        1e3 * (self.rests[STEPS - 1] - self.rests[0])
    }
}

pub(super) struct Tendency {
    variants: Vec<Variant>,
}

impl Tendency {
    pub(super) fn run(
        robot: &Robot,
        elbow: usize,
        estimator: &Estimator,
    ) -> Result<Self, PaperError> {
        let variants = VARIANTS
            .par_iter()
            .map(|&(name, stiffness_factor, mass_factor)| {
                let day = Day {
                    stiffness_factor,
                    mass_factor,
                    ..Day::default()
                };
                let trial = Trial::run(robot, &scenario(robot, &day))?;
                let curve = estimator.estimate(&trial, elbow, 0.0)?;
                Ok(Variant {
                    name,
                    rests: rests(&trial, &curve),
                    curve,
                })
            })
            .collect::<Vec<Result<Variant, PaperError>>>()
            .into_iter()
            .collect::<Result<_, _>>()?;
        Ok(Self { variants })
    }

    pub(super) fn variants(&self) -> &[Variant] {
        &self.variants
    }

    pub(super) fn sentences(&self, analytic: &Analytic<'_>) -> Result<Vec<Sentence>, PaperError> {
        let [both, torque, stiffness, neither, opposite] = &self.variants[..] else {
            return Ok(Vec::new());
        };
        let explained = [torque, stiffness, both].iter().all(|v| v.falls());
        let analytic_mrad = self.opposite_analytic_mrad(analytic)?;
        Ok(vec![
            Sentence::added(
                "The estimate decreases while the elbow rises.",
                "the first run's estimate falls from each of the four rests to the next; found: last minus first",
                both.change_mrad(),
                Unit::Rad,
                both.falls(),
            )
            .of_paper(),
            Sentence::added(
                "The joint torque is overestimated, the stiffness underestimated, or both.",
                format!(
                    "each of the three alone makes the estimate fall from rest to rest: torque {}, stiffness {}, both {} mrad from the first to the last; found: the smallest of these falls",
                    number(torque.change_mrad()),
                    number(stiffness.change_mrad()),
                    number(both.change_mrad())
                ),
                [torque, stiffness, both].iter().map(|v| v.change_mrad()).fold(f64::NEG_INFINITY, f64::max),
                Unit::Rad,
                explained,
            )
            .of_paper(),
            Sentence::added(
                "With errors of the opposite sign the estimate increases.",
                format!("the estimate rises from each rest to the next; last minus first, analytic {} mrad and the effect of friction", number(analytic_mrad)),
                opposite.change_mrad(),
                Unit::Rad,
                opposite.rests.windows(2).all(|pair| pair[1] > pair[0]),
            ),
            below(
                "The two causes are not separable from this motion: both are proportional to the torque.",
                "residual at the four rests of one cause's part after a fit of the other's by scaling; one step of the joint encoder",
                left_mrad(torque, stiffness, neither),
                ENCODER_STEP_MRAD,
                Unit::Rad,
            ),
        ])
    }

    /// `Δ(τ/K_true − τ_described/K)` from the first rest to the last, mrad.
    fn opposite_analytic_mrad(&self, analytic: &Analytic<'_>) -> Result<f64, PaperError> {
        use super::super::staircase::rest_angle_rad;
        let torque =
            analytic.gravity_nm(rest_angle_rad(STEPS))? - analytic.gravity_nm(rest_angle_rad(1))?;
        let true_over_described = STIFFER / LIGHTER;
        Ok(1e3 * torque / analytic.stiffness_nm_per_rad * (true_over_described - 1.0))
    }
}

fn number(mrad: f64) -> String {
    sinew_figure::rounded(mrad, 3)
}

/// Residual of one cause's part after the other's was scaled onto it (least squares), mrad.
fn left_mrad(a: &Variant, b: &Variant, neither: &Variant) -> f64 {
    let part = |v: &Variant| -> Vec<f64> {
        let pairs = v.rests.iter().zip(&neither.rests);
        pairs.map(|(with, without)| with - without).collect()
    };
    let (a, b) = (part(a), part(b));
    let cross: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
    let own: f64 = b.iter().map(|b| b * b).sum();
    let left = a.iter().zip(&b).map(|(a, b)| (a - cross / own * b).abs());
    1e3 * left.fold(0.0, f64::max)
}
