//! A whole series: frames in, a recording out.

use super::error::CameraError;
use super::frames::{self, Times};
use super::overlay;
use super::picture::Picture;
use super::reader::{ReadOptions, Reading, Scale, ScaleReader, stretched};
use super::rejection::Rejection;
use super::video::{Video, VideoTools};
use crate::output::write_file;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Decoded frames that wait to be read. More would only cost memory.
const AHEAD: usize = 3;

/// What to read and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Folder of PNG or JPEG frames, or a video.
    pub input: PathBuf,
    /// What tells when frames were taken; a video has its own times unless a rate is given.
    pub times: Times,
    /// How the scale is read.
    pub read: ReadOptions,
    /// Elongation per movement of the scale; negative where the rope stretches while the scale
    /// moves left or up.
    pub elongation_per_movement: f64,
    /// What the test was; becomes columns of the recording.
    pub conditions: Conditions,
    /// PNG of the reference frame with what was found drawn on it.
    pub overlay: Option<PathBuf>,
    /// Another frame for the overlay.
    pub overlay_frame: Option<String>,
    /// Programs for videos.
    pub tools: VideoTools,
}

impl Request {
    /// Reads `input` with times from file names.
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

/// Constants of a test.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct Conditions {
    /// Tension of the rope, N.
    pub force_n: Option<f64>,
    /// Length of the rope that stretches, mm.
    pub gauge_length_mm: Option<f64>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
}

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

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Frames read.
    pub done: usize,
    /// All frames.
    pub total: usize,
}

struct Arrival {
    name: String,
    time_s: f64,
    picture: Result<Picture, String>,
}

/// Reads all frames. Decoding runs in a thread of its own.
///
/// Frames that can't be used are part of the outcome with their reasons; the rest goes on.
///
/// # Errors
/// [`CameraError`] where nothing can be read at all: no frames, no times, no scale in any frame, a
/// pitch that the scale contradicts, a video without `ffmpeg`.
pub fn run(
    request: &Request,
    on_progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, CameraError> {
    check(request)?;
    if request.input.is_dir() {
        let list = frames::list(&request.input, &request.times)?;
        let total = list.frames.len();
        let (sender, receiver) = sync_channel(AHEAD);
        return std::thread::scope(|scope| {
            scope.spawn(move || {
                for file in list.frames {
                    let picture = std::fs::read(&file.path)
                        .map_err(|e| e.to_string())
                        .and_then(|bytes| Picture::decode(&bytes));
                    let (name, time_s) = (file.name, file.time_s);
                    if sender
                        .send(Ok(Arrival {
                            name,
                            time_s,
                            picture,
                        }))
                        .is_err()
                    {
                        return;
                    }
                }
            });
            read_all(request, receiver, total, list.notes, on_progress)
        });
    }
    let rate = match &request.times {
        Times::Names => None,
        Times::Rate(rate) => Some(*rate),
        Times::Table(_) => {
            return Err(CameraError::Option(
                "a video has its own times; a table of times goes with a folder of frames".into(),
            ));
        }
    };
    let mut video = Video::open(&request.input, &request.tools, rate)?;
    let total = video.times.len();
    let (sender, receiver) = sync_channel(AHEAD);
    std::thread::scope(|scope| {
        scope.spawn(move || decode_video(&mut video, &sender));
        read_all(request, receiver, total, Vec::new(), on_progress)
    })
}

fn decode_video(video: &mut Video, sender: &SyncSender<Result<Arrival, CameraError>>) {
    loop {
        let arrival = match video.next() {
            Ok(None) => return,
            Ok(Some((name, time_s, picture))) => Ok(Arrival {
                name,
                time_s,
                picture: Ok(picture),
            }),
            Err(error) => Err(error),
        };
        let stop = arrival.is_err();
        if sender.send(arrival).is_err() || stop {
            return;
        }
    }
}

fn check(request: &Request) -> Result<(), CameraError> {
    let refuse = |text: String| Err(CameraError::Option(text));
    if let Some(pitch) = request.read.pitch_mm
        && !(pitch > 0.0 && pitch <= 100.0)
    {
        return refuse(format!(
            "a line every {pitch} mm can't be; above 0, at most 100 mm"
        ));
    }
    let ratio = request.elongation_per_movement;
    if !ratio.is_finite() || ratio == 0.0 {
        return refuse(format!(
            "an elongation of {ratio} mm per mm of movement can't be; say a number that is not 0"
        ));
    }
    if request.read.std_most_mm.is_nan() || request.read.std_most_mm <= 0.0 {
        return refuse(format!(
            "a largest deviation of {} mm can't be; above 0",
            request.read.std_most_mm
        ));
    }
    for (name, unit, value) in [
        ("force", "N", request.conditions.force_n),
        ("gauge length", "mm", request.conditions.gauge_length_mm),
    ] {
        if let Some(value) = value
            && !(value > 0.0 && value.is_finite())
        {
            return refuse(format!("a {name} of {value} {unit} can't be; above 0"));
        }
    }
    Ok(())
}

fn read_all(
    request: &Request,
    arrivals: Receiver<Result<Arrival, CameraError>>,
    total: usize,
    notes: Vec<String>,
    on_progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, CameraError> {
    let mut reader = ScaleReader::new(request.read.clone());
    let mut frames: Vec<Frame> = Vec::with_capacity(total);
    let mut reference: Option<String> = None;
    let mut drawn = false;
    for arrival in arrivals {
        let Arrival {
            name,
            time_s,
            picture,
        } = arrival?;
        // Only the first of several frames of one time is read: which would be right?
        let twin = frames.last().filter(|last| last.time_s == time_s);
        let looked = match (twin, &picture) {
            (Some(twin), _) => Err(Rejection::Time(twin.name.clone())),
            (None, Err(reason)) => Err(Rejection::Unreadable(reason.clone())),
            (None, Ok(picture)) => check_region(&request.read, picture)
                .map_err(Rejection::NoScale)
                .and_then(|()| reader.look(picture)),
        };
        if let (Ok((reading, sight)), Ok(picture)) = (&looked, &picture) {
            if reference.is_none() {
                reference = Some(name.clone());
                reader
                    .check_pitch()
                    .map_err(|error| CameraError::WrongPitch {
                        frame: name.clone(),
                        error,
                    })?;
            }
            let wanted = request.overlay_frame.as_ref().is_none_or(|w| *w == name);
            if let (Some(path), true, false, Some(scale)) =
                (&request.overlay, wanted, drawn, reader.scale())
            {
                let caption = overlay::Caption {
                    frame: &name,
                    scale,
                    reading,
                };
                let png = overlay::draw(picture, sight, &caption).map_err(|reason| {
                    CameraError::Overlay {
                        path: path.clone(),
                        reason,
                    }
                })?;
                write_file(path, &png)?;
                drawn = true;
            }
        }
        frames.push(Frame {
            name,
            time_s,
            result: looked.map(|(reading, _)| reading),
        });
        on_progress(Progress {
            done: frames.len(),
            total: total.max(frames.len()),
        });
    }
    let (Some(scale), Some(reference)) = (reader.scale().cloned(), reference) else {
        let first = frames.first();
        return Err(CameraError::Nothing {
            input: request.input.clone(),
            count: frames.len(),
            name: first.map_or_else(String::new, |f| f.name.clone()),
            reason: first
                .and_then(|f| f.result.as_ref().err())
                .map_or_else(|| "no frame at all".into(), ToString::to_string),
        });
    };
    let mut outcome = Outcome {
        frames,
        scale,
        reference,
        elongation_per_movement: request.elongation_per_movement,
        conditions: request.conditions,
        notes,
    };
    outcome.remark(request, drawn);
    Ok(outcome)
}

fn check_region(options: &ReadOptions, picture: &Picture) -> Result<(), String> {
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

impl Outcome {
    /// Frames with a reading: number, frame, reading.
    pub fn used(&self) -> impl Iterator<Item = (usize, &Frame, &Reading)> {
        self.frames
            .iter()
            .enumerate()
            .filter_map(|(i, frame)| Some((i, frame, frame.result.as_ref().ok()?)))
    }

    /// Rejected frames by reason, most frequent first: word, count, first frame's message.
    pub fn rejected(&self) -> Vec<(&'static str, usize, String)> {
        let mut out: Vec<(&'static str, usize, String)> = Vec::new();
        for frame in &self.frames {
            if let Err(reason) = &frame.result {
                match out.iter_mut().find(|(word, ..)| *word == reason.word()) {
                    Some((_, count, _)) => *count += 1,
                    None => out.push((reason.word(), 1, format!("{}: {reason}", frame.name))),
                }
            }
        }
        out.sort_by_key(|(_, count, _)| std::cmp::Reverse(*count));
        out
    }

    fn remark(&mut self, request: &Request, drawn: bool) {
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
        let stretch = used.iter().filter(|r| stretched(r)).count();
        if stretch > 0 {
            notes.push(format!(
                "the lines' distance in the picture changes by more than 1 % in {stretch} frames: the scale comes nearer or turns, or the camera was moved"
            ));
        }
        match (self.scale.longer_every, request.read.pitch_mm) {
            (None, _) => notes.push(format!(
                "all lines look alike: a step between frames must stay below {:.2} mm",
                super::marks::STEP_MOST * self.scale.pitch_mm
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

    /// Elongation of a reading and its standard deviation, mm.
    pub fn elongation_mm(&self, reading: &Reading) -> (f64, f64) {
        let ratio = self.elongation_per_movement;
        (
            ratio * reading.position_mm,
            ratio.abs() * reading.position_std_mm,
        )
    }

    /// The recording as CSV: `time_s`, `elongation_mm` and what each frame was worth; one row per
    /// frame used. `sinew creep analyze` reads it.
    pub fn recording_csv(&self) -> String {
        use std::fmt::Write as _;
        let constants = [
            ("force_N", self.conditions.force_n),
            ("gauge_length_mm", self.conditions.gauge_length_mm),
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
                r.in_sight,
                r.residual_mm,
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
                Err(why) => writeln!(out, "0,,,,{},{}", why.word(), quoted(&why.to_string())),
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
