//! Result of a series of frames.

use super::error::CameraError;
use super::line_index::MAX_STEP;
use super::reading::{Scale, ScaleMeasurement};
use super::rejection::{Rejection, RejectionKind, millimetres};
use super::request::{Conditions, Request};
use sinew_files::write_file;
use std::path::Path;

/// Frame and its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// File name, or number within a video.
    pub name: String,
    /// Time of the frame, s.
    pub time_s: f64,
    /// Measurement, or the reason for its rejection.
    pub result: Result<ScaleMeasurement, Rejection>,
}

/// Frames rejected for one reason.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rejected {
    /// Reason for the rejection.
    pub reason: RejectionKind,
    /// Number of frames rejected for this reason.
    pub frames: usize,
    /// Name of the first of these frames with its message.
    pub first: String,
}

/// Result of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// All frames in chronological order.
    pub frames: Vec<Frame>,
    /// Scale in the reference frame.
    pub scale: Scale,
    /// Name of the reference frame.
    pub reference: String,
    /// Elongation per movement of the scale, mm/mm.
    pub elongation_per_movement: f64,
    /// Constant conditions of the test.
    pub conditions: Conditions,
    /// Notes for the user.
    pub notes: Vec<String>,
}

impl Outcome {
    /// Iterates over the used frames: number, frame, measurement.
    pub fn used(&self) -> impl Iterator<Item = (usize, &Frame, &ScaleMeasurement)> {
        self.frames
            .iter()
            .enumerate()
            .filter_map(|(i, frame)| Some((i, frame, frame.result.as_ref().ok()?)))
    }

    /// Returns the rejected frames by kind, most frequent first.
    pub fn rejected(&self) -> Vec<Rejected> {
        let mut out: Vec<Rejected> = Vec::new();
        for frame in &self.frames {
            if let Err(reason) = &frame.result {
                match out.iter_mut().find(|r| r.reason == reason.kind()) {
                    Some(rejected) => rejected.frames += 1,
                    None => out.push(Rejected {
                        reason: reason.kind(),
                        frames: 1,
                        first: format!("{}: {reason}", frame.name),
                    }),
                }
            }
        }
        out.sort_by_key(|r| std::cmp::Reverse(r.frames));
        out
    }

    pub(super) fn remark(&mut self, request: &Request, drawn: bool) {
        let mut notes = Vec::new();
        let used: Vec<&ScaleMeasurement> = self.used().map(|(_, _, reading)| reading).collect();
        if used.len() == 1 {
            notes.push("one frame only: it is the reference, so no elongation is available".into());
        }
        let jumps = used.iter().filter(|r| r.jumped).count();
        if jumps > 0 {
            notes.push(format!(
                "{jumps} steps longer than half a graduation were resolved by the longer lines and numbers"
            ));
        }
        let pitch_changes = used.iter().filter(|r| r.is_stretched()).count();
        if pitch_changes > 0 {
            notes.push(format!(
                "pitch in the picture changes by more than 1 % in {pitch_changes} frames: the distance or angle of the scale changes, or the camera was moved"
            ));
        }
        match (self.scale.longer_every, request.read.pitch_m) {
            (None, _) => notes.push(format!(
                "all lines of the scale are identical, so that the displacement between two frames must be below {:.2} mm",
                1e3 * MAX_STEP * self.scale.pitch_m
            )),
            (Some(every @ (4 | 5 | 20)), None) => notes.push(format!(
                "every {every}th line is longer, which is unusual for a half-millimetre scale; check --pitch"
            )),
            _ => {}
        }
        if request.overlay.is_some() && !drawn {
            notes.push(format!(
                "no overlay: frame '{}' is not among the frames used",
                request.overlay_frame.as_deref().unwrap_or("")
            ));
        }
        self.notes.extend(notes);
    }

    /// Returns the elongation of a measurement and its standard deviation, m.
    pub fn elongation_m(&self, reading: &ScaleMeasurement) -> (f64, f64) {
        let ratio = self.elongation_per_movement;
        (
            ratio * reading.position_m,
            ratio.abs() * reading.position_std_m,
        )
    }

    /// Returns the elongation of a measurement and its standard deviation, mm.
    fn elongation_mm(&self, reading: &ScaleMeasurement) -> (f64, f64) {
        let (elongation_m, std_m) = self.elongation_m(reading);
        (1e3 * elongation_m, 1e3 * std_m)
    }

    /// Returns the recording as CSV: `time_s`, `elongation_mm` and the quality of each frame; one row per used frame.
    /// `sinew creep analyze` reads it.
    pub fn recording_csv(&self) -> String {
        use std::fmt::Write as _;
        let constants = [
            ("force_N", self.conditions.force_n),
            (
                "gauge_length_mm",
                self.conditions.gauge_length_m.map(millimetres),
            ),
            ("temperature_C", self.conditions.temperature_c),
        ];
        let mut out = String::from(
            "time_s,elongation_mm,elongation_std_mm,quality,contrast,in_sight,residual_mm,lines,frame",
        );
        let mut tail = String::new();
        for (name, value) in constants {
            if let Some(value) = value {
                let _ = write!(out, ",{name}");
                let _ = write!(tail, ",{value}");
            }
        }
        out.push('\n');
        for (i, frame, r) in self.used() {
            let (elongation, std) = self.elongation_mm(r);
            let _ = writeln!(
                out,
                "{},{elongation:.6},{std:.6},{:.3},{:.4},{:.3},{:.6},{},{}{tail}",
                frame.time_s,
                r.quality,
                r.contrast,
                r.visible_share,
                1e3 * r.residual_m,
                r.lines,
                i + 1
            );
        }
        out
    }

    /// Returns all frames as CSV: file, time, and measurement or reason.
    pub fn frames_csv(&self) -> String {
        use std::fmt::Write as _;
        let mut out = String::from(
            "frame,file,time_s,used,elongation_mm,elongation_std_mm,quality,reason,message\n",
        );
        let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
        for (i, frame) in self.frames.iter().enumerate() {
            let _ = write!(out, "{},{},{},", i + 1, quoted(&frame.name), frame.time_s);
            let _ = match &frame.result {
                Ok(r) => {
                    let (elongation, std) = self.elongation_mm(r);
                    writeln!(out, "1,{elongation:.6},{std:.6},{:.3},,", r.quality)
                }
                Err(reason) => writeln!(
                    out,
                    "0,,,,{},{}",
                    reason.kind(),
                    quoted(&reason.to_string())
                ),
            };
        }
        out
    }

    /// Writes [`recording_csv`](Self::recording_csv).
    ///
    /// # Errors
    /// Returns [`CameraError::Output`] with the path if the file cannot be written; no partial file remains.
    pub fn write_recording(&self, path: &Path) -> Result<(), CameraError> {
        Ok(write_file(path, self.recording_csv().as_bytes())?)
    }

    /// Writes [`frames_csv`](Self::frames_csv).
    ///
    /// # Errors
    /// Returns [`CameraError::Output`] like [`write_recording`](Self::write_recording).
    pub fn write_frames(&self, path: &Path) -> Result<(), CameraError> {
        Ok(write_file(path, self.frames_csv().as_bytes())?)
    }
}
