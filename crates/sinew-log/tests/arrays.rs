//! Arrays in memory give the same frames as the columns of a table.

use crate::support::*;
use sinew_log::{
    Arrays, Format, Frame, FrameWriter, OpenOptions, Quantities, Quantity, Recording, RowWriter,
    open,
};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// More than two blocks.
const ROWS: usize = 2500;

#[derive(Clone)]
struct Held {
    joints: Vec<String>,
    quantities: Quantities,
    frames: Arc<Vec<Frame>>,
    /// Maximum number of values requested in one call.
    most: Arc<AtomicUsize>,
}

impl Arrays for Held {
    fn joints(&self) -> &[String] {
        &self.joints
    }

    fn quantities(&self) -> Quantities {
        self.quantities
    }

    fn rows(&self) -> u64 {
        self.frames.len() as u64
    }

    fn times_ns(&mut self, from: u64, into: &mut [i64]) -> Result<(), String> {
        for (into, frame) in into.iter_mut().zip(&self.frames[from as usize..]) {
            *into = frame.time_ns;
        }
        Ok(())
    }

    fn values(&mut self, quantity: Quantity, from: u64, into: &mut [f64]) -> Result<(), String> {
        if quantity == Quantity::TauExt {
            return Err("'tau_ext' has gone".into());
        }
        self.most.fetch_max(into.len(), Ordering::Relaxed);
        let all = self.frames[from as usize..].iter();
        let all = all.flat_map(|frame| frame.get(quantity));
        for (into, value) in into.iter_mut().zip(all) {
            *into = *value;
        }
        Ok(())
    }
}

fn frames() -> Vec<Frame> {
    let frame = |index: usize| {
        let mut frame = Frame::new(2);
        frame.time_ns = START_NS + 4 * MS * index as i64;
        let t = 4e-3 * index as f64;
        // The first joint turns past half a turn: its encoder wraps.
        let turn = 0.7 * t;
        let pi = std::f64::consts::PI;
        frame.q = vec![(turn + pi).rem_euclid(2.0 * pi) - pi, 0.3 * t.sin()];
        frame.theta = vec![0.1 + 1e-3 * t, 0.3 * t.sin() + 0.01];
        frame.tau_m = vec![t.cos(), -t.cos()];
        frame.temperature_c = 22.0 + 0.1 * t;
        if index % 7 == 3 {
            frame.theta[0] = f64::NAN;
        }
        frame
    };
    (0..ROWS).map(frame).collect()
}

fn held(frames: Vec<Frame>) -> Held {
    let mut quantities = Quantities::positions();
    quantities.tau_m = true;
    quantities.temperature = true;
    Held {
        joints: vec!["a.b".into(), "elbow".into()],
        quantities,
        frames: Arc::new(frames),
        most: Arc::default(),
    }
}

fn opened(held: Held) -> Result<Recording, sinew_log::LogError> {
    Recording::from_arrays(Box::new(held), "arrays", &OpenOptions::default())
}

fn csv(path: &Path, held: &Held) -> Recording {
    let mut writer = RowWriter::create(path, &held.joints, held.quantities).unwrap();
    for frame in held.frames.iter() {
        writer.write(frame).unwrap();
    }
    Box::new(writer).finish().unwrap();
    open(path, &OpenOptions::default()).unwrap()
}

#[test]
fn arrays_give_frames_and_health_of_equal_table() {
    let held = held(frames());
    let folder = tempfile::tempdir().unwrap();
    let table = csv(&folder.path().join("same.csv"), &held);
    let arrays = opened(held.clone()).unwrap();
    assert_eq!(arrays.format(), Format::Arrays);
    assert_eq!(arrays.joints(), table.joints());
    assert_eq!(arrays.channels(), table.channels());
    let total = arrays.progress().bytes_total;
    assert_eq!(total, ((1 + 3 * 2 + 1) * 8 * ROWS) as u64);
    let (from_arrays, health) = read_all(arrays);
    let (from_table, of_table) = read_all(table);
    assert_eq!(health, of_table);
    assert!(health.unwrapped.iter().any(|s| s.joint == "a.b"));
    assert_eq!(from_arrays.len(), from_table.len());
    for (a, b) in from_arrays.iter().zip(&from_table) {
        // The text distinguishes NaN.
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }
    // Arrays are read in blocks, never whole.
    let most = held.most.load(Ordering::Relaxed);
    assert!(most <= 2 * 1024, "{most} values at once");
}

#[test]
fn joints_are_selected_and_ordered() {
    let mut recording = opened(held(frames())).unwrap();
    recording.select(&["elbow"]).unwrap();
    let frame = recording.next_frame().unwrap().unwrap();
    assert_eq!((frame.q.len(), frame.theta[0]), (1, 0.01));
    assert_eq!(frame.temperature_c, 22.0);
}

#[test]
fn invalid_array_error_names_cause() {
    let error = |held: Held| match opened(held) {
        Err(error) => error.to_string(),
        Ok(mut recording) => loop {
            match recording.next_frame() {
                Ok(Some(_)) => {}
                Ok(None) => panic!("it was read"),
                Err(error) => break error.to_string(),
            }
        },
    };
    let mut none = held(frames());
    none.joints.clear();
    assert!(error(none).contains("no column like q.<joint>_rad"));
    let mut twice = held(frames());
    twice.joints[1] = twice.joints[0].clone();
    assert!(error(twice).contains("duplicate column 'q.a.b_rad'"));
    let mut gone = held(frames());
    gone.quantities.tau_ext = true;
    assert_eq!(error(gone), "arrays: 'tau_ext' has gone");
    let mut backwards = frames();
    backwards.reverse();
    let reason = error(held(backwards));
    assert!(
        reason.contains("time_ns") && reason.contains("backwards"),
        "{reason}"
    );
    // No rows are no frames, and no error.
    let (frames, _) = read_all(opened(held(Vec::new())).unwrap());
    assert!(frames.is_empty());
}
