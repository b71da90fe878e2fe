//! What became of a series of frames.

use super::error::CameraError;
use super::line_index::STEP_MOST;
use super::reading::{Reading, Scale};
use super::rejection::{Rejection, RejectionKind, millimetres};
use super::request::{Conditions, Request};
use sinew_files::write_file;
use std::path::Path;

/// One frame and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// File name, or number within a video.
    pub name: String,
    /// Time, s.
    pub time_s: f64,
    /// Reading, or why there is none.
    pub result: Result<Reading, Rejection>,
}

/// Frames without a reading for one reason.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rejected {
    /// Reason of the rejection.
    pub reason: RejectionKind,
    /// Number of frames.
    pub frames: usize,
    /// Name of the first of them with its message.
    pub first: String,
}

/// A series, read.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Every frame in order of time.
    pub frames: Vec<Frame>,
    /// The scale in the reference frame.
    pub scale: Scale,
    /// Name of the reference frame.
    pub reference: String,
    /// Elongation per movement of the scale.
    pub elongation_per_movement: f64,
    /// Constants of the test.
    pub conditions: Conditions,
    /// What a person should know.
    pub notes: Vec<String>,
}

impl Outcome {
    /// Frames with a reading: number, frame, reading.
    pub fn used(&self) -> impl Iterator<Item = (usize, &Frame, &Reading)> {
        self.frames
            .iter()
            .enumerate()
            .filter_map(|(i, frame)| Some((i, frame, frame.result.as_ref().ok()?)))
    }

    /// Rejected frames by kind, most frequent first.
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
        let used: Vec<&Reading> = self.used().map(|(_, _, reading)| reading).collect();
        if used.len() == 1 {
            notes.push("one frame only: it is the zero, so there is no elongation yet".into());
        }
        let jumps = used.iter().filter(|r| r.jumped).count();
        if jumps > 0 {
            notes.push(format!(
                "{jumps} steps were longer than half a graduation and were counted by the longer lines and numbers"
            ));
        }
        let stretch = used.iter().filter(|r| r.is_stretched()).count();
        if stretch > 0 {
            notes.push(format!(
                "the lines' distance in the picture changes by more than 1 % in {stretch} frames: the scale comes nearer or turns, or the camera was moved"
            ));
        }
        match (self.scale.longer_every, request.read.pitch_m) {
            (None, _) => notes.push(format!(
                "all lines look alike: a step between frames must stay below {:.2} mm",
                1e3 * STEP_MOST * self.scale.pitch_m
            )),
            (Some(every @ (4 | 5 | 20)), None) => notes.push(format!(
                "every {every}th line is longer, which a half-millimetre scale seldom has; check --pitch-mm"
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

    /// Elongation of a reading and its standard deviation, m.
    pub fn elongation_m(&self, reading: &Reading) -> (f64, f64) {
        let ratio = self.elongation_per_movement;
        (
            ratio * reading.position_m,
            ratio.abs() * reading.position_deviation_m,
        )
    }

    /// The same, mm.
    fn elongation_mm(&self, reading: &Reading) -> (f64, f64) {
        let (elongation_m, deviation_m) = self.elongation_m(reading);
        (1e3 * elongation_m, 1e3 * deviation_m)
    }

    /// The recording as CSV: `time_s`, `elongation_mm` and what each frame was worth; one row per
    /// frame used. `sinew creep analyze` reads it.
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

    /// Every frame as CSV: file, time, and reading or reason.
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
                Err(why) => writeln!(out, "0,,,,{},{}", why.kind(), quoted(&why.to_string())),
            };
        }
        out
    }

    /// Writes [`recording_csv`](Self::recording_csv).
    ///
    /// # Errors
    /// [`CameraError::Output`] with the path; nothing half-written.
    pub fn write_recording(&self, path: &Path) -> Result<(), CameraError> {
        Ok(write_file(path, self.recording_csv().as_bytes())?)
    }

    /// Writes [`frames_csv`](Self::frames_csv).
    ///
    /// # Errors
    /// As [`write_recording`](Self::write_recording).
    pub fn write_frames(&self, path: &Path) -> Result<(), CameraError> {
        Ok(write_file(path, self.frames_csv().as_bytes())?)
    }
}
