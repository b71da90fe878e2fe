//! `sinew bench read-camera`: elongation from images of a graduated scale.

use crate::files::{check_outputs, write_text};
use crate::quantity::{Force, Length, Temperature, above_zero};
use crate::terminal::{Bar, Failure, Finish, Word, answer_as, complain};
use clap::Args;
use sinew_camera::{Conditions, ReadOptions, Region, Request, Summary, Times};
use sinew_report::text::plain;
use std::path::PathBuf;

/// Measure the carriage position in images of a half-millimetre scale
///
/// The scale is detected automatically and measured by its graduation; no calibration is required.
/// The first frame with a scale defines the zero. Unusable frames (dark, blurred, covered, ambiguous,
/// damaged) are rejected and listed; the exit code is then 3.
///
/// The recording (--out) has one row per used frame, with the columns time_s, elongation_mm,
/// elongation_std_mm, quality, contrast, in_sight, residual_mm, lines, frame; it is an input of sinew
/// creep. Check the overlay before using a series.
#[derive(Debug, Args)]
#[command(
    after_help = "Times from file names: a number with a unit at the end (frame_12.5s.png; \
    also ms, us, ns), a date with time of day (20261121_143000_250.png, \
    2026-11-21T14-30-00.25.png), or s, ms, us, ns since 1970 (1795271400250.png).\n\n\
    The displacement between frames may reach 2.5 mm if the lines at 1, 5 and 10 mm are longer, and \
    0.2 mm if all lines have equal length.\n\n\
    Example:\n  sinew bench read-camera frames --frame-rate 0.5 --out creep.csv --overlay check.png"
)]
pub(crate) struct ReadCamera {
    /// Folder of PNG or JPEG frames, or a video (needs ffmpeg)
    input: PathBuf,
    /// Frame rate, Hz, of frames in the order of their names
    #[arg(
        long,
        value_name = "HZ",
        conflicts_with = "times",
        allow_negative_numbers = true
    )]
    frame_rate: Option<f64>,
    /// CSV with the columns file,time_s
    #[arg(long, value_name = "FILE")]
    times: Option<PathBuf>,
    /// Write the recording, CSV
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write all frames with their measurement or the reason for rejection, CSV
    #[arg(long, value_name = "FILE")]
    frames: Option<PathBuf>,
    /// Write the first used frame with the detected scale drawn on it, PNG
    #[arg(long, value_name = "FILE")]
    overlay: Option<PathBuf>,
    /// Frame of the overlay [default: first used frame]
    #[arg(long, value_name = "NAME", requires = "overlay")]
    overlay_frame: Option<String>,
    /// Write an HTML report
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Print one JSON document instead of a table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scale: ScaleOptions,
    #[command(flatten)]
    test: TestOptions,
}

/// Properties of the scale in the image.
#[derive(Debug, Args)]
#[command(next_help_heading = "Scale")]
struct ScaleOptions {
    /// Distance between lines, mm [default: 0.5, rejected if inconsistent with the longer lines]
    #[arg(
        long,
        alias = "pitch-mm",
        value_name = "LENGTH",
        allow_hyphen_values = true
    )]
    pitch: Option<Length>,
    /// Evaluated region of the image, px: left,top,width,height
    #[arg(long, value_name = "X,Y,W,H", value_parser = region)]
    region: Option<Region>,
    /// Scale is vertical [default: detected]
    #[arg(long, conflicts_with = "lying")]
    upright: bool,
    /// Scale is horizontal [default: detected]
    #[arg(long)]
    lying: bool,
    /// Maximum standard deviation of a used frame, mm
    #[arg(long, alias = "std-most-mm", value_name = "LENGTH", default_value = "0.02mm", value_parser = above_zero::<Length>,
          allow_hyphen_values = true)]
    max_std: Length,
}

/// Conditions of the test.
#[derive(Debug, Args)]
#[command(next_help_heading = "Test")]
struct TestOptions {
    /// Elongation per displacement of the scale; negative if the scale moves left or up during
    /// elongation
    #[arg(
        long,
        value_name = "MM/MM",
        default_value = "1",
        allow_negative_numbers = true
    )]
    elongation_per_movement: f64,
    /// Tension of the rope, N, written to the recording
    #[arg(
        long,
        alias = "force-n",
        value_name = "FORCE",
        allow_hyphen_values = true
    )]
    force: Option<Force>,
    /// Gauge length of the rope, mm, written to the recording
    #[arg(
        long,
        alias = "gauge-length-mm",
        value_name = "LENGTH",
        allow_hyphen_values = true
    )]
    gauge_length: Option<Length>,
    /// Temperature, °C, written to the recording
    #[arg(
        long,
        alias = "temperature-c",
        value_name = "TEMPERATURE",
        allow_hyphen_values = true
    )]
    temperature: Option<Temperature>,
}

/// Parses a region, `X,Y,W,H`.
fn region(text: &str) -> Result<Region, String> {
    let numbers: Result<Vec<usize>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    match numbers.as_deref() {
        Ok([x, y, width, height]) if *width > 0 && *height > 0 => Ok(Region {
            x: *x,
            y: *y,
            width: *width,
            height: *height,
        }),
        _ => Err("expected left,top,width,height in whole px, e.g. 0,400,1920,200".into()),
    }
}

impl ReadCamera {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let outputs = [
            ("--out", self.out.as_deref()),
            ("--frames", self.frames.as_deref()),
            ("--overlay", self.overlay.as_deref()),
            ("--report", self.report.as_deref()),
        ];
        let inputs = [
            ("the input", Some(self.input.as_path())),
            ("the table of times", self.times.as_deref()),
        ];
        check_outputs(&outputs, &inputs)?;
        let bar = Bar::new("reading");
        let outcome = sinew_camera::run(&self.request(), &mut |at| {
            bar.set(at.done as f64, at.total as f64);
        });
        drop(bar);
        let outcome = outcome?;
        if let Some(path) = &self.out {
            outcome.write_recording(path)?;
        }
        if let Some(path) = &self.frames {
            outcome.write_frames(path)?;
        }
        write_text(self.report.as_deref(), || {
            let name = self.input.file_name().unwrap_or(self.input.as_os_str());
            let title = format!("Camera measurement of {}", name.to_string_lossy());
            sinew_camera::html(&outcome, &title, env!("CARGO_PKG_VERSION"))
        })?;
        let summary = Summary::of(&outcome);
        for note in &summary.notes {
            complain(Word::Note, &plain(note));
        }
        let table = |summary: &Summary| sinew_report::camera::render(&outcome, summary);
        answer_as(self.json, &summary, table)?;
        Ok(Finish::lossy(summary.frames_used < summary.frames))
    }

    fn request(&self) -> Request {
        let mut request = Request::new(&self.input);
        request.times = match (&self.times, self.frame_rate) {
            (Some(path), _) => Times::Table(path.clone()),
            (None, Some(rate)) => Times::Rate(rate),
            (None, None) => Times::Names,
        };
        request.read = ReadOptions {
            pitch_m: self.scale.pitch.map(|pitch| pitch.0),
            region: self.scale.region,
            upright: match (self.scale.upright, self.scale.lying) {
                (true, _) => Some(true),
                (_, true) => Some(false),
                _ => None,
            },
            std_most_m: self.scale.max_std.0,
        };
        request.elongation_per_movement = self.test.elongation_per_movement;
        request.conditions = Conditions {
            force_n: self.test.force.map(|force| force.0),
            gauge_length_m: self.test.gauge_length.map(|length| length.0),
            temperature_c: self.test.temperature.map(|temperature| temperature.0),
        };
        request.overlay.clone_from(&self.overlay);
        request.overlay_frame.clone_from(&self.overlay_frame);
        request
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn region_parses_four_integers() {
        let want = Region {
            x: 0,
            y: 400,
            width: 1920,
            height: 200,
        };
        assert_eq!(region("0, 400,1920,200"), Ok(want));
        for bad in ["", "1,2,3", "0,0,-5,9", "0,0,0,9", "a,b,c,d", "1,2,3,4,5"] {
            assert!(region(bad).unwrap_err().contains("whole px"), "{bad}");
        }
    }
}
