//! The three panels: model errors, and the error due to motion alone.

use super::super::PaperError;
use super::super::analytic::Analytic;
use super::super::sentence::{Sentence, Unit, below, near};
use super::super::staircase::{LENGTH_S, MOVE_S, STEPS, rest_end_s};
use super::super::trial::{Trial, difference, mean, peak, std};
use super::{Case, MASS_FACTOR, OFFSETS, STIFFNESS_FACTOR};

/// Maximum residual oscillation at the end of a rest, mrad.
const RINGING_MRAD: f64 = 0.1;
/// Error above which an estimate departs from the truth, mrad.
const DEPARTED_MRAD: f64 = 1.0;

pub(super) fn of_the_model(
    trial: &Trial,
    cases: &[Case; 3],
    analytic: &Analytic<'_>,
) -> Result<Vec<Sentence>, PaperError> {
    let [right, stiff, light] = cases;
    let mut out = vec![
        below(
            "Without model error the estimate shows the added offset.",
            "largest deviation over four rests and three offsets; the remainder is residual oscillation",
            1e3 * worst_at_rest(trial, right),
            RINGING_MRAD,
            Unit::Rad,
        )
        .of_paper(),
        accurate_after_start(trial, right).of_paper(),
    ];
    let departs = |case: &Case, text: &str| {
        let value = 1e3 * worst_at_rest(trial, case);
        let rule = format!("error of at least {DEPARTED_MRAD} mrad at one of four rests");
        Sentence::added(text, rule, value, Unit::Rad, value >= DEPARTED_MRAD).of_paper()
    };
    out.push(departs(
        stiff,
        "With the stiffness overestimated by 20 % the estimate departs from the added offset.",
    ));
    out.push(departs(
        light,
        "With M, C and g underestimated by 10 % the estimate departs from the added offset.",
    ));
    out.push(
        below(
            "The difference of two estimates still shows by how much the offset grew, in all three cases.",
            "largest deviation from 5 mrad from the end of the first move on: a hundredth. The torque estimate does not depend on theta, so that only rounding remains",
            1e3 * worst_difference(trial, cases),
            0.05,
            Unit::Rad,
        )
        .of_paper(),
    );
    let at_90 = |case: &Case| 1e3 * trial.at_rest(&case.paper[0], STEPS);
    let deflection_mrad = 1e3 * analytic.last_gravity_nm()? / analytic.stiffness_nm_per_rad;
    out.push(near(
        "With K overestimated by 20 % the estimate at 90° is too large by a sixth of the spring's deflection.",
        "analytic: g/K − g/(1.2 K) = g/(6 K)",
        at_90(stiff),
        deflection_mrad * (1.0 - 1.0 / STIFFNESS_FACTOR),
        0.02,
        Unit::Rad,
    ));
    out.push(near(
        "With M, C and g underestimated by 10 % it is too large by a tenth of the deflection.",
        "analytic: 0.1 g/K",
        at_90(light),
        deflection_mrad * (1.0 - MASS_FACTOR),
        0.02,
        Unit::Rad,
    ));
    Ok(out)
}

/// The offset is added only where the motor position exceeds it, and the arm starts at zero.
fn accurate_after_start(trial: &Trial, case: &Case) -> Sentence {
    let deviations = |k: usize| {
        let added = case.paper.iter().zip(OFFSETS).skip(1);
        added.map(move |(curve, offset)| (trial.at_rest(curve, k) - offset).abs() / offset)
    };
    let at_start = deviations(0).fold(f64::INFINITY, f64::min);
    let later = worst_at_rest(trial, case);
    Sentence::added(
        "The estimate is accurate except at the beginning.",
        format!(
            "before the first move the estimates deviate by at least half of the added 10 and 15 mrad (found: {:.0} %), because nothing is added where the motor position is not larger than the offset; at the four later rests by at most {RINGING_MRAD} mrad",
            100.0 * at_start
        ),
        1e3 * later,
        Unit::Rad,
        at_start >= 0.5 && 1e3 * later <= RINGING_MRAD,
    )
}

/// Largest deviation from the added offset over the rests after the first move, rad. Before it the motor position is
/// below the offset, and nothing is added.
fn worst_at_rest(trial: &Trial, case: &Case) -> f64 {
    let mut worst: f64 = 0.0;
    for (curve, offset) in case.paper.iter().zip(OFFSETS) {
        for k in 1..=STEPS {
            worst = worst.max((trial.at_rest(curve, k) - offset).abs());
        }
    }
    worst
}

fn worst_difference(trial: &Trial, cases: &[Case; 3]) -> f64 {
    let grown = OFFSETS[2] - OFFSETS[1];
    let mut worst: f64 = 0.0;
    for case in cases {
        let step = difference(&case.paper[2], &case.paper[1]);
        // From the end of the first move on both offsets are added.
        for value in trial.between(&step, rest_end_s(0) + MOVE_S, LENGTH_S) {
            worst = worst.max((value - grown).abs());
        }
    }
    worst
}

/// Effect of the lag of the observed torque during motion.
pub(super) fn of_motion(
    trial: &Trial,
    joint: usize,
    right: &Case,
    analytic: &Analytic<'_>,
) -> Result<Vec<Sentence>, PaperError> {
    let (paper, matched) = (&right.paper[0], &right.matched[0]);
    let tau = trial.torque(joint);
    let lag = analytic.lag_error_rad(&tau, trial.dt_s);
    let rule = "over the whole motion; analytic: (tau − LP[tau])/K of the true torque";
    let as_analytic = |text: &str, of: fn(&[f64]) -> f64| {
        near(text, rule, 1e3 * of(paper), 1e3 * of(&lag), 0.02, Unit::Rad)
    };
    Ok(vec![
        near(
            "In the paper's comparison motion alone causes an error: its mean,",
            "over the whole motion; analytic: the torque gained, g(90°)/(K_I K T)",
            1e3 * mean(paper),
            1e3 * analytic.mean_lag_error_rad()?,
            0.02,
            Unit::Rad,
        ),
        as_analytic("its standard deviation", std),
        as_analytic("and its peak are those of the torque's lag.", peak),
        below(
            "In the matched comparison motion causes no error.",
            "largest absolute value over the whole motion, without model error",
            1e3 * peak(matched),
            0.001,
            Unit::Rad,
        ),
    ])
}
