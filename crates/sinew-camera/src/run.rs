//! Evaluation of a series: from frames to a recording.

use super::decode::decode;
use super::error::CameraError;
use super::frames::{self, FrameFile, Times};
use super::outcome::{Frame, Outcome};
use super::overlay;
use super::picture::Picture;
use super::reader::ScaleReader;
use super::rejection::Rejection;
use super::request::{Request, check, check_region};
use super::video::Video;
use sinew_files::{Budget, read_bytes, write_file};
use std::sync::mpsc::{Receiver, sync_channel};

/// Number of decoded frames waiting to be read; more would only use memory.
const MAX_QUEUED_FRAMES: usize = 3;

/// Progress of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Number of frames read.
    pub done: usize,
    /// Total number of frames.
    pub total: usize,
}

/// Name of a frame, its time, s, and the picture or the decoding error; an outer error ends the run.
type Arrival = Result<(String, f64, Result<Picture, String>), CameraError>;

/// Reads all frames. Decoding runs in a separate thread.
///
/// Rejected frames are part of the outcome with their reasons; the others are evaluated.
///
/// # Errors
/// Returns a [`CameraError`] if nothing can be read: no frames, no times, no scale in any frame, a pitch inconsistent
/// with the scale, or a video without `ffmpeg`.
pub fn run(
    request: &Request,
    on_progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, CameraError> {
    check(request)?;
    let (arrivals, total, notes): (Box<dyn Iterator<Item = Arrival> + Send>, _, _) =
        if request.input.is_dir() {
            let list = frames::list(&request.input, &request.times)?;
            let total = list.frames.len();
            (
                Box::new(list.frames.into_iter().map(decoded)),
                total,
                list.notes,
            )
        } else {
            let rate = match &request.times {
                Times::Names => None,
                Times::Rate(rate) => Some(*rate),
                Times::Table(_) => {
                    return Err(CameraError::Option(
                        "a video has its own times; a table of times requires a folder of frames"
                            .into(),
                    ));
                }
            };
            let mut video = Video::open(&request.input, &request.tools, rate)?;
            let total = video.times.len();
            let next = move || Some(video.next().transpose()?.map(|(n, t, p)| (n, t, Ok(p))));
            (Box::new(std::iter::from_fn(next)), total, Vec::new())
        };
    let (sender, receiver) = sync_channel(MAX_QUEUED_FRAMES);
    std::thread::scope(|scope| {
        scope.spawn(move || {
            for arrival in arrivals {
                let stop = arrival.is_err();
                if sender.send(arrival).is_err() || stop {
                    return;
                }
            }
        });
        read_all(request, receiver, total, notes, on_progress)
    })
}

fn decoded(file: FrameFile) -> Arrival {
    let picture = read_bytes(&file.path, &Budget::PICTURE)
        .map_err(|e| e.to_string())
        .and_then(|bytes| decode(&bytes));
    Ok((file.name, file.time_s, picture))
}

fn read_all(
    request: &Request,
    arrivals: Receiver<Arrival>,
    total: usize,
    notes: Vec<String>,
    on_progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, CameraError> {
    let mut reader = ScaleReader::new(request.read.clone());
    let mut frames: Vec<Frame> = Vec::with_capacity(total);
    let mut reference: Option<String> = None;
    let mut drawn = false;
    for arrival in arrivals {
        let (name, time_s, picture) = arrival?;
        // Only the first of several frames with the same time is read.
        let twin = frames.last().filter(|last| last.time_s == time_s);
        let looked = match (twin, &picture) {
            (Some(twin), _) => Err(Rejection::Time(twin.name.clone())),
            (None, Err(reason)) => Err(Rejection::Unreadable(reason.clone())),
            (None, Ok(picture)) => check_region(&request.read, picture)
                .map_err(Rejection::NoScale)
                .and_then(|()| reader.look(picture)),
        };
        if let (Ok((reading, view)), Ok(picture)) = (&looked, &picture) {
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
                let png = overlay::draw(picture, view, &caption).map_err(|reason| {
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
                .map_or_else(|| "no frames".into(), ToString::to_string),
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
