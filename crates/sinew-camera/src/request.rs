//! Request for reading a series of frames.

use super::error::CameraError;
use super::frames::Times;
use super::picture::Picture;
use super::reading::ReadOptions;
use super::rejection::millimetres;
use super::video::VideoTools;
use std::path::PathBuf;

/// Request for reading a series of frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Folder of PNG or JPEG frames, or a video.
    pub input: PathBuf,
    /// Source of the frame times; a video has its own times unless a rate is specified.
    pub times: Times,
    /// Options for reading the scale.
    pub read: ReadOptions,
    /// Elongation per movement of the scale, mm/mm; negative if the rope elongates while the scale moves left or up.
    pub elongation_per_movement: f64,
    /// Conditions of the test, written as columns of the recording.
    pub conditions: Conditions,
    /// PNG of the reference frame with the detected features.
    pub overlay: Option<PathBuf>,
    /// Name of another frame for the overlay.
    pub overlay_frame: Option<String>,
    /// Programs that decode videos.
    pub tools: VideoTools,
}

impl Request {
    /// Creates a request for `input` with times from file names.
    pub fn new(input: impl Into<PathBuf>) -> Self {
        Self {
            input: input.into(),
            times: Times::Names,
            read: ReadOptions::default(),
            elongation_per_movement: 1.0,
            conditions: Conditions::default(),
            overlay: None,
            overlay_frame: None,
            tools: VideoTools::default(),
        }
    }
}

/// Constant conditions of a test.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Conditions {
    /// Tension of the rope, N.
    pub force_n: Option<f64>,
    /// Length of the loaded rope, m.
    pub gauge_length_m: Option<f64>,
    /// Temperature of the test, °C.
    pub temperature_c: Option<f64>,
}

/// Rejects invalid options before anything is read.
pub(super) fn check(request: &Request) -> Result<(), CameraError> {
    let invalid = |text: String| Err(CameraError::Option(text));
    if let Some(pitch) = request.read.pitch_m.map(millimetres)
        && !(pitch > 0.0 && pitch <= 100.0)
    {
        return invalid(format!(
            "a line every {pitch} mm is invalid; expected more than 0 and at most 100 mm"
        ));
    }
    if let Times::Rate(rate) = request.times
        && !(rate > 0.0 && rate.is_finite())
    {
        return invalid(format!(
            "a frame rate of {rate} 1/s is invalid; expected more than 0"
        ));
    }
    let ratio = request.elongation_per_movement;
    if !ratio.is_finite() || ratio == 0.0 {
        return invalid(format!(
            "an elongation of {ratio} mm per mm of movement is invalid; expected a finite number other than 0"
        ));
    }
    let most_m = request.read.std_most_m;
    if most_m.is_nan() || most_m <= 0.0 {
        return invalid(format!(
            "a maximum standard deviation of {} mm is invalid; expected more than 0",
            millimetres(most_m)
        ));
    }
    for (name, unit, value) in [
        ("force", "N", request.conditions.force_n),
        (
            "gauge length",
            "mm",
            request.conditions.gauge_length_m.map(millimetres),
        ),
    ] {
        if let Some(value) = value
            && !(value > 0.0 && value.is_finite())
        {
            return invalid(format!(
                "a {name} of {value} {unit} is invalid; expected more than 0"
            ));
        }
    }
    Ok(())
}

/// Rejects a region that lies outside a picture.
pub(super) fn check_region(options: &ReadOptions, picture: &Picture) -> Result<(), String> {
    let Some(r) = options.region else {
        return Ok(());
    };
    let fits = |from: usize, length: usize, side: usize| {
        length > 0 && from.checked_add(length).is_some_and(|end| end <= side)
    };
    if fits(r.x, r.width, picture.width()) && fits(r.y, r.height, picture.height()) {
        return Ok(());
    }
    Err(format!(
        "region {},{} {} × {} px lies outside the picture of {} × {} px",
        r.x,
        r.y,
        r.width,
        r.height,
        picture.width(),
        picture.height()
    ))
}
