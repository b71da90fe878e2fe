//! Frames of a video, decoded by an installed `ffmpeg`.

use super::error::CameraError;
use super::picture::Picture;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

/// Programs that decode videos.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VideoTools {
    /// Program that decodes frames.
    pub ffmpeg: PathBuf,
    /// Program that reports size and times.
    pub ffprobe: PathBuf,
}

impl Default for VideoTools {
    fn default() -> Self {
        Self {
            ffmpeg: "ffmpeg".into(),
            ffprobe: "ffprobe".into(),
        }
    }
}

/// Video decoder with 8-bit grey levels.
#[derive(Debug)]
pub(crate) struct Video {
    path: PathBuf,
    child: Child,
    out: ChildStdout,
    width: usize,
    height: usize,
    /// Times of the frames, s.
    pub(crate) times: Vec<f64>,
    done: usize,
}

impl Video {
    /// Starts the decoder of a video.
    pub(crate) fn open(
        path: &Path,
        tools: &VideoTools,
        rate: Option<f64>,
    ) -> Result<Self, CameraError> {
        let video_error = |reason: String| CameraError::Video {
            path: path.to_path_buf(),
            reason,
        };
        // A missing file is reported before the decoder starts.
        std::fs::metadata(path).map_err(|error| CameraError::Io {
            path: path.to_path_buf(),
            error,
        })?;
        let (width, height, mut times) = probe(path, &tools.ffprobe).map_err(video_error)?;
        if let Some(rate) = rate {
            times = (0..times.len()).map(|i| i as f64 / rate).collect();
        }
        let mut child = Command::new(&tools.ffmpeg)
            .args(["-v", "error", "-nostdin", "-noautorotate", "-i"])
            .arg(path)
            .args(["-map", "0:v:0", "-vsync", "passthrough", "-f", "rawvideo"])
            .args(["-pix_fmt", "gray", "-"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|e| video_error(missing(&tools.ffmpeg, &e)))?;
        let out = child
            .stdout
            .take()
            .ok_or_else(|| video_error("no output from the decoder".into()))?;
        Ok(Self {
            path: path.to_path_buf(),
            child,
            out,
            width,
            height,
            times,
            done: 0,
        })
    }

    /// Returns the next frame with its number and time, s; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<(String, f64, Picture)>, CameraError> {
        let video_error = |reason: String| CameraError::Video {
            path: self.path.clone(),
            reason,
        };
        let mut levels = vec![0_u8; self.width * self.height];
        match self.out.read_exact(&mut levels) {
            Ok(()) => {}
            Err(e) if e.kind() == ErrorKind::UnexpectedEof => {
                let status = self.child.wait().map_err(|e| video_error(e.to_string()))?;
                if !status.success() {
                    return Err(video_error(format!(
                        "the decoder stopped after {} frames ({status})",
                        self.done
                    )));
                }
                return Ok(None);
            }
            Err(e) => return Err(video_error(format!("reading from the decoder: {e}"))),
        }
        let Some(time_s) = self.times.get(self.done).copied() else {
            return Err(video_error(format!(
                "more frames than times ({}); set --frame-rate HZ",
                self.times.len()
            )));
        };
        self.done += 1;
        let picture = Picture::from_luma8(self.width, self.height, levels).map_err(video_error)?;
        Ok(Some((format!("frame {}", self.done), time_s, picture)))
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn missing(program: &Path, error: &std::io::Error) -> String {
    if error.kind() == ErrorKind::NotFound {
        format!(
            "a video needs '{}', which is not installed; install ffmpeg, or use a folder of PNG or JPEG frames",
            program.display()
        )
    } else {
        format!("cannot start '{}': {error}", program.display())
    }
}

/// Returns width, height and times of the frames in display order.
fn probe(path: &Path, ffprobe: &Path) -> Result<(usize, usize, Vec<f64>), String> {
    let output = Command::new(ffprobe)
        .args(["-v", "error", "-select_streams", "v:0", "-of", "csv=p=1"])
        .args(["-show_entries", "stream=width,height:packet=pts_time"])
        .arg(path)
        .stdin(Stdio::null())
        .output()
        .map_err(|e| missing(ffprobe, &e))?;
    let messages = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        let first = messages.lines().next().unwrap_or("no message");
        return Err(format!("is not a video supported by ffmpeg: {first}"));
    }
    let mut size = None;
    let mut times = Vec::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let cells: Vec<&str> = line.trim().split(',').collect();
        match cells.as_slice() {
            ["stream", width, height, ..] => {
                size = width.parse().ok().zip(height.parse().ok());
            }
            ["packet", time, ..] => times.extend(time.parse::<f64>().ok()),
            _ => {}
        }
    }
    let (width, height) = size.ok_or("ffmpeg finds no video stream in it")?;
    // Packets have decoding order.
    times.sort_unstable_by(f64::total_cmp);
    let zero = times.first().copied().unwrap_or(0.0);
    for time in &mut times {
        *time -= zero;
    }
    Ok((width, height, times))
}
