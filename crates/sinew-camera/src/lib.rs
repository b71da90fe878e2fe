//! Position of the carriage from pictures of a graduated scale, as in the elongation measurement of the paper.
//!
//! ```no_run
//! use sinew_camera::{Request, Summary, Times};
//! let mut request = Request::new("frames");
//! request.times = Times::Rate(0.5);
//! let outcome = sinew_camera::run(&request, &mut |_| {})?;
//! println!("{:.4} mm", 1e3 * Summary::of(&outcome).elongation_last_m);
//! outcome.write_recording("bench.csv".as_ref())?;
//! # Ok::<(), sinew_camera::CameraError>(())
//! ```
//!
//! Processing of a frame: [`Picture`] (grey levels) → strips of rows → blocks with a phase (`strips`) → in the first
//! frame the region of the scale (`find`, `spectrum`) and the map of its phases (`phase_map`) → in all frames the shift
//! relative to that map by robust least squares (`phase`, `robust`) → whole graduations from the longer lines and
//! numbers (`marks`, `line_index`) → [`ScaleMeasurement`] or [`Rejection`] (`reference`). [`run`] processes a folder or a video.
//!
//! Assumptions: camera and rail are stationary, the scale moves along itself within a few degrees, a graduation has 4
//! to 250 px, and the lines are tilted by at most 12°. Steps between frames may have any length if longer lines or
//! numbers identify the lines; otherwise they must be below 0.4 graduations.
//!
//! Not modelled: errors of the print, an angle between scale and movement (1 − cos, 0.015 % at 1°), a rolling shutter
//! (a moving scale appears tilted).

mod decode;
mod error;
mod find;
mod frames;
mod line_index;
mod marks;
mod outcome;
mod overlay;
mod phase;
mod phase_map;
mod picture;
mod reader;
mod reading;
mod reference;
mod rejection;
mod report;
mod request;
mod robust;
mod run;
mod spectrum;
mod strips;
mod summary;
mod times;
mod video;
mod visibility;

pub use decode::decode;
pub use error::CameraError;
pub use find::{MAX_PITCH_PX, MAX_TILT_DEG, MIN_PITCH_PX};
pub use frames::Times;
pub use outcome::{Frame, Outcome, Rejected};
pub use picture::Picture;
pub use reader::ScaleReader;
pub use reading::{DEFAULT_PITCH_M, ReadOptions, Scale, ScaleMeasurement};
pub use rejection::{Rejection, RejectionKind, WrongPitch};
pub use report::html;
pub use request::{Conditions, Request};
pub use run::{Progress, run};
pub use strips::Region;
pub use summary::Summary;
pub use video::VideoTools;
