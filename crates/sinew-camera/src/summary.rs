//! Summary of a series.

use super::outcome::{Outcome, Rejected};
use super::reading::Scale;
use super::request::Conditions;
use sinew_files::JsonDocument;

/// Summary of the frames, the scale and the elongation of a series.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// Number of frames found.
    pub frames: usize,
    /// Number of frames used.
    pub frames_used: usize,
    /// Rejected frames by reason.
    pub rejected: Vec<Rejected>,
    /// Name of the reference frame, with position zero.
    pub reference_frame: String,
    /// Scale in the reference frame.
    pub scale: Scale,
    /// Resolution in the middle of the scale, px/m.
    pub px_per_m: f64,
    /// Elongation per movement of the scale, mm/mm.
    pub elongation_per_movement: f64,
    /// Time of the first used frame, s.
    pub time_from_s: f64,
    /// Time of the last used frame, s.
    pub time_to_s: f64,
    /// Elongation of the last used frame, m.
    pub elongation_last_m: f64,
    /// Smallest elongation, m.
    pub elongation_min_m: f64,
    /// Largest elongation, m.
    pub elongation_max_m: f64,
    /// Root mean square of the standard deviations of the frames, m.
    pub elongation_std_rms_m: f64,
    /// Lowest quality of a used frame, 0 to 1.
    pub quality_min: f64,
    /// Longest step between used frames, m.
    pub step_max_m: f64,
    /// Number of steps resolved by longer lines and numbers.
    pub steps_jumped: usize,
    /// Constant conditions of the test.
    pub conditions: Conditions,
    /// Notes for the user.
    pub notes: Vec<String>,
}

impl JsonDocument for Summary {
    const SCHEMA: &'static str = "sinew/camera/2";
}

impl Summary {
    /// Summarises an outcome.
    pub fn of(outcome: &Outcome) -> Self {
        let values: Vec<(f64, f64, f64)> = outcome
            .used()
            .map(|(_, frame, reading)| {
                let (elongation_m, std_m) = outcome.elongation_m(reading);
                (frame.time_s, elongation_m, std_m)
            })
            .collect();
        let elongations = || values.iter().map(|v| v.1);
        let squares: f64 = values.iter().map(|v| v.2 * v.2).sum();
        let steps = values.windows(2).map(|w| (w[1].1 - w[0].1).abs());
        Self {
            frames: outcome.frames.len(),
            frames_used: values.len(),
            rejected: outcome.rejected(),
            reference_frame: outcome.reference.clone(),
            px_per_m: outcome.scale.pitch_px / outcome.scale.pitch_m,
            scale: outcome.scale.clone(),
            elongation_per_movement: outcome.elongation_per_movement,
            time_from_s: values.first().map_or(0.0, |v| v.0),
            time_to_s: values.last().map_or(0.0, |v| v.0),
            elongation_last_m: values.last().map_or(0.0, |v| v.1),
            elongation_min_m: elongations().fold(f64::MAX, f64::min),
            elongation_max_m: elongations().fold(f64::MIN, f64::max),
            elongation_std_rms_m: (squares / values.len().max(1) as f64).sqrt(),
            quality_min: outcome.used().map(|u| u.2.quality).fold(1.0, f64::min),
            step_max_m: steps.fold(0.0, f64::max),
            steps_jumped: outcome.used().filter(|u| u.2.jumped).count(),
            conditions: outcome.conditions,
            notes: outcome.notes.clone(),
        }
    }
}
