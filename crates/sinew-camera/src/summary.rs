//! A series in a few numbers.

use super::outcome::Outcome;
use super::reader::Scale;
use super::request::Conditions;

/// What `--json` prints.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Summary {
    /// Frames found.
    pub frames: usize,
    /// Frames with a reading.
    pub frames_used: usize,
    /// Frames without, by reason.
    pub rejected: Vec<Rejected>,
    /// Frame whose position is zero.
    pub reference_frame: String,
    /// The scale in it.
    pub scale: Scale,
    /// Pixels per millimetre in the middle of the scale.
    pub px_per_mm: f64,
    /// Elongation per movement of the scale.
    pub elongation_per_movement: f64,
    /// First and last time used, s.
    pub time_from_s: f64,
    /// Last time used, s.
    pub time_to_s: f64,
    /// Elongation of the last frame used, mm.
    pub elongation_last_mm: f64,
    /// Smallest elongation, mm.
    pub elongation_min_mm: f64,
    /// Largest elongation, mm.
    pub elongation_max_mm: f64,
    /// Root mean square of the frames' standard deviations, mm.
    pub elongation_std_rms_mm: f64,
    /// Worst quality of a frame used, 0 to 1.
    pub quality_min: f64,
    /// Longest step between frames used, mm.
    pub step_max_mm: f64,
    /// Steps counted by longer lines and numbers.
    pub steps_jumped: usize,
    /// Constants of the test.
    pub conditions: Conditions,
    /// What a person should know.
    pub notes: Vec<String>,
}

/// Frames without a reading for one reason.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Rejected {
    /// One word.
    pub reason: String,
    /// Frames.
    pub frames: usize,
    /// First of them with its message.
    pub first: String,
}

impl Summary {
    /// Of an outcome.
    pub fn of(outcome: &Outcome) -> Self {
        let values: Vec<(f64, f64, f64)> = outcome
            .used()
            .map(|(_, frame, reading)| {
                let (elongation, std) = outcome.elongation_mm(reading);
                (frame.time_s, elongation, std)
            })
            .collect();
        let elongations = || values.iter().map(|v| v.1);
        let squares: f64 = values.iter().map(|v| v.2 * v.2).sum();
        let steps = values.windows(2).map(|w| (w[1].1 - w[0].1).abs());
        Self {
            frames: outcome.frames.len(),
            frames_used: values.len(),
            rejected: outcome
                .rejected()
                .into_iter()
                .map(|(word, frames, first)| Rejected {
                    reason: word.to_owned(),
                    frames,
                    first,
                })
                .collect(),
            reference_frame: outcome.reference.clone(),
            px_per_mm: outcome.scale.pitch_px / outcome.scale.pitch_mm,
            scale: outcome.scale.clone(),
            elongation_per_movement: outcome.elongation_per_movement,
            time_from_s: values.first().map_or(0.0, |v| v.0),
            time_to_s: values.last().map_or(0.0, |v| v.0),
            elongation_last_mm: values.last().map_or(0.0, |v| v.1),
            elongation_min_mm: elongations().fold(f64::MAX, f64::min),
            elongation_max_mm: elongations().fold(f64::MIN, f64::max),
            elongation_std_rms_mm: (squares / values.len().max(1) as f64).sqrt(),
            quality_min: outcome.used().map(|u| u.2.quality).fold(1.0, f64::min),
            step_max_mm: steps.fold(0.0, f64::max),
            steps_jumped: outcome.used().filter(|u| u.2.jumped).count(),
            conditions: outcome.conditions,
            notes: outcome.notes.clone(),
        }
    }
}
