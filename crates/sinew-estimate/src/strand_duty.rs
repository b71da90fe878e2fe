//! Duty of a rope from the torques of a recording.

use crate::replay::{self, JointEstimate, Series};
use crate::{EstimateError, Progress, Request};
use sinew_model::transmission::Tendon;
use sinew_rope::law::RopeLoad;
use sinew_rope::{Duty, Stretch};

/// Strand between motor and joint pulley, by the sign of the torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strand {
    /// Strand that carries positive torque.
    Positive,
    /// Strand that carries negative torque.
    Negative,
}

/// Maximum number of duty sections per recording, which limits the time to evaluate hundreds of posterior draws.
const MAX_SECTIONS: usize = 128;

/// Returns the tension of a strand at an elastic torque, N.
///
/// While neither strand is slack, `T = T₀ ± τ/(2r)` with the pretension `T₀`. If the
/// other strand is slack (`|τ| > 2 r T₀`), one strand carries the torque: `T = |τ|/r`.
pub fn strand_tension_n(pretension_n: f64, radius_m: f64, tau_el: f64, strand: Strand) -> f64 {
    let pull = match strand {
        Strand::Positive => tau_el,
        Strand::Negative => -tau_el,
    } / radius_m;
    if pull.abs() <= 2.0 * pretension_n {
        pretension_n + 0.5 * pull
    } else {
        pull.max(0.0)
    }
}

/// Converts a joint's elastic torque over a recording into the periodic duty of a strand.
///
/// The recording is reduced to at most 128 sections: consecutive pieces, each split into the
/// mean of its lower and of its upper half, to preserve the peaks, which determine the bedding-in.
///
/// Returns `None` if the recording has no torque of the joint.
pub fn duty(
    joint: &JointEstimate,
    tendon: &Tendon,
    pretension_n: f64,
    temperature_c: f64,
    strand: Strand,
) -> Option<Duty> {
    let stretches = stretches(&joint.series, tendon, pretension_n, temperature_c, strand)?;
    Some(Duty {
        about: format!("torque of {} over the recording", joint.name),
        stretches,
        repeat: true,
    })
}

/// Computes the [`duty`] of a strand of `joint` over the recording of a request, from the torques of the paper's
/// estimate. A missing pretension is treated as 0.
///
/// # Errors
/// Returns [`EstimateError::Mismatch`] if the recording has no torque of the joint, and other variants of
/// [`EstimateError`] if recording or robot cannot be used.
pub fn recorded(
    request: &Request,
    joint: &str,
    tendon: &Tendon,
    temperature_c: f64,
    strand: Strand,
    on_progress: &mut dyn FnMut(Progress),
) -> Result<Duty, EstimateError> {
    let found = replay::run(request, on_progress)?;
    let pretension_n = tendon.pretension_n.unwrap_or(0.0);
    let estimate = found.joints.iter().find(|j| j.name == joint);
    estimate
        .and_then(|j| duty(j, tendon, pretension_n, temperature_c, strand))
        .ok_or_else(|| EstimateError::Mismatch {
            file: request.log.display().to_string(),
            reason: format!("torque of joint '{joint}' is not available"),
        })
}

fn stretches(
    series: &Series,
    tendon: &Tendon,
    pretension_n: f64,
    temperature_c: f64,
    strand: Strand,
) -> Option<Vec<Stretch>> {
    let spacing = series
        .time_s
        .windows(2)
        .map(|w| w[1] - w[0])
        .fold(f64::INFINITY, f64::min);
    let spacing = if spacing.is_finite() { spacing } else { 1.0 };
    let tensions: Vec<f64> = series
        .tau_el_nm
        .iter()
        .filter(|t| t.is_finite())
        .map(|&t| strand_tension_n(pretension_n, tendon.joint_pulley_radius_m, t, strand))
        .collect();
    if tensions.is_empty() {
        return None;
    }
    let piece = tensions.len().div_ceil(MAX_SECTIONS / 2);
    let mut stretches = Vec::with_capacity(MAX_SECTIONS);
    for chunk in tensions.chunks(piece) {
        let mut sorted = chunk.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let (low, high) = sorted.split_at(sorted.len() / 2);
        for half in [low, high] {
            if !half.is_empty() {
                let mean = half.iter().sum::<f64>() / half.len() as f64;
                let load = RopeLoad::celsius(mean, temperature_c);
                stretches.push(Stretch::hold(load, spacing * half.len() as f64));
            }
        }
    }
    Some(stretches)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strands_share_the_torque_until_one_is_slack() {
        let t = |tau, strand| strand_tension_n(60.0, 0.030, tau, strand);
        let close = |tau, strand, n: f64| assert!((t(tau, strand) - n).abs() < 1e-9, "{tau}");
        close(0.0, Strand::Positive, 60.0);
        close(1.8, Strand::Positive, 90.0);
        close(1.8, Strand::Negative, 30.0);
        // 2 r T₀ = 3.6 N·m: one strand alone above, without a step.
        close(3.6, Strand::Positive, 120.0);
        close(4.5, Strand::Positive, 150.0);
        close(4.5, Strand::Negative, 0.0);
        // The difference of the strands is always the torque.
        for tau in [-7.0, -2.0, 0.5, 3.0, 9.0] {
            let turn = 0.030 * (t(tau, Strand::Positive) - t(tau, Strand::Negative));
            assert!((turn - tau).abs() < 1e-9, "{tau}");
        }
    }

    #[test]
    fn duty_preserves_duration_mean_and_peaks_of_torque() {
        // Ten slow swings of 1.5 N·m about 0.5 N·m, in 5000 intervals of 0.1 s; a gap in between.
        let n = 5000;
        let tau: Vec<f64> = (0..n)
            .map(|i| 0.5 + 1.5 * (std::f64::consts::TAU * f64::from(i) / 500.0).sin())
            .map(|t| if (1.0..1.1).contains(&t) { f64::NAN } else { t })
            .collect();
        let used = tau.iter().filter(|t| t.is_finite()).count() as f64;
        let series = Series {
            time_s: (0..n).map(|i| 0.1 * f64::from(i)).collect(),
            tau_el_nm: tau.clone(),
            ..Series::default()
        };
        let tendon = Tendon {
            joint_pulley_radius_m: 0.025,
            ..Tendon::default()
        };
        let sections = |series: &Series| stretches(series, &tendon, 60.0, 30.0, Strand::Positive);
        let found = Duty {
            about: String::new(),
            stretches: sections(&series).expect("a duty"),
            repeat: true,
        };
        assert!(found.stretches.len() <= MAX_SECTIONS);
        let sum = found.summary();
        assert!((sum.duration_s - 0.1 * used).abs() < 1e-6, "{sum:?}");
        let finite = tau.iter().filter(|t| t.is_finite());
        let mean = 60.0 + 0.5 * finite.sum::<f64>() / used / 0.025;
        assert!((sum.tension_mean_n - mean).abs() < 1e-6, "{sum:?}");
        // T = T₀ ± τ/(2r): 60 + 40 N at the top, 60 − 20 N at the bottom. A piece is a seventh of
        // a swing, and its extreme half is within 3 % of the swing of the peak.
        assert!((sum.tension_max_n - 100.0).abs() < 1.8, "{sum:?}");
        assert!((sum.tension_min_n - 40.0).abs() < 1.8, "{sum:?}");
        assert!((sum.temperature_mean_c - 30.0).abs() < 1e-9, "{sum:?}");
        assert!(sections(&Series::default()).is_none());
    }
}
