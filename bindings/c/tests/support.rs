//! Test data: an arm of the repository, its recording and its baseline.

use sinew_c::robot::{SinewRobot, sinew_robot_free, sinew_robot_open};
use sinew_c::status::Status;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{self, Recorder};
use sinew_log::{Frame, OpenOptions};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use std::ffi::{CStr, CString, c_char};
use std::path::{Path, PathBuf};
use std::ptr::null_mut;

/// Number of joints of the arm.
pub(crate) const N: usize = 4;

pub(crate) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Arm of the repository, loaded by the library.
pub(crate) fn biorob_like() -> Robot {
    let place = repository().join("robots/biorob-like");
    robot_dir::load(&place, None).unwrap().robot
}

/// Arm of the repository, loaded through C.
pub(crate) struct Opened(pub(crate) *mut SinewRobot);

impl Opened {
    pub(crate) fn biorob_like() -> Self {
        let place = repository().join("robots/biorob-like");
        let place = CString::new(place.to_str().unwrap()).unwrap();
        let mut robot = null_mut();
        let mut reason = Why::new();
        // SAFETY: a text, a place, room.
        let status =
            unsafe { sinew_robot_open(place.as_ptr(), &mut robot, reason.at(), reason.room()) };
        assert_eq!(status, Status::Ok, "{}", reason.text());
        Self(robot)
    }
}

impl Drop for Opened {
    fn drop(&mut self) {
        // SAFETY: made above, freed once.
        unsafe { sinew_robot_free(self.0) }
    }
}

/// Buffer for an error message.
pub(crate) struct Why([c_char; 512]);

impl Why {
    pub(crate) fn new() -> Self {
        Self([0; 512])
    }

    pub(crate) fn at(&mut self) -> *mut c_char {
        self.0.as_mut_ptr()
    }

    pub(crate) fn room(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn text(&self) -> String {
        // SAFETY: all zero, or written with a zero at its end.
        unsafe { CStr::from_ptr(self.0.as_ptr()) }
            .to_str()
            .unwrap()
            .to_owned()
    }
}

/// Frames of the recording and the baseline estimated from them.
pub(crate) fn recorded(robot: &Robot) -> (Vec<Frame>, Baseline) {
    let file = repository().join("examples/01-stretched-arm/stretched-arm.mcap");
    let mut recording = sinew_log::open(&file, &OpenOptions::default()).unwrap();
    let mut recorder = Recorder::new(robot, &FeatureConfig::default(), 0.5);
    let mut frames = Vec::new();
    while let Some(frame) = recording.next_frame().unwrap() {
        recorder.push(frame, 0.002 * frames.len() as f64);
        frames.push(frame.clone());
    }
    let learning = session::Learning::default();
    let (baseline, _) = session::learn_recorded(robot, &recorder.finish(), "A", &learning).unwrap();
    (frames, baseline)
}

/// Zero-terminated text for C.
pub(crate) fn text(text: &str) -> CString {
    CString::new(text).unwrap()
}
