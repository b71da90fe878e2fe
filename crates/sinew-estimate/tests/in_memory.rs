//! Estimates of inputs in memory, compared with the same inputs in files.

use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir;
use sinew_estimate::session::SessionOptions;
use sinew_estimate::{EstimateDocument, Given, Method, Opener, Plan, Request, estimate};
use sinew_log::{Arrays, Axis, Frame, OpenOptions, Quantities, Quantity, Recording};
use sinew_sim::{Scenario, SimulateOptions};
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

struct Held {
    joints: Vec<String>,
    quantities: Quantities,
    frames: Arc<Vec<Frame>>,
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
        let frames = self.frames[from as usize..].iter();
        into.iter_mut()
            .zip(frames)
            .for_each(|(t, f)| *t = f.time_ns);
        Ok(())
    }

    fn values(&mut self, quantity: Quantity, from: u64, into: &mut [f64]) -> Result<(), String> {
        let frames = self.frames[from as usize..].iter();
        let values = frames.flat_map(|frame| frame.get(quantity));
        into.iter_mut().zip(values).for_each(|(v, x)| *v = *x);
        Ok(())
    }
}

/// Opener of the frames of a file from memory.
fn held(file: &Path) -> Opener {
    held_as(sinew_log::open(file, &OpenOptions::default()).unwrap())
}

fn held_as(mut recording: Recording) -> Opener {
    let joints = recording.joints().to_vec();
    let quantities = recording.channels().union();
    let mut frames = Vec::new();
    while let Some(frame) = recording.next_frame().unwrap() {
        frames.push(frame.clone());
    }
    let frames = Arc::new(frames);
    Arc::new(move |options| {
        let held = Held {
            joints: joints.clone(),
            quantities,
            frames: frames.clone(),
        };
        Recording::from_arrays(Box::new(held), "memory", options)
    })
}

fn answered(request: &Request, method: Method) -> (EstimateDocument, Option<Baseline>) {
    let plan = Plan {
        method,
        window: Default::default(),
        baseline: None,
        options: SessionOptions::default(),
        online: false,
    };
    estimate(request, &plan, &mut |_| {}).unwrap()
}

#[test]
fn in_memory_inputs_equal_files() {
    let file = root().join("examples/01-stretched-arm/stretched-arm.mcap");
    let mut request = Request::new(file.clone());
    request.robot = Some(root().join("robots/biorob-like"));
    let robot = robot_dir::load(request.robot.as_ref().unwrap(), None).unwrap();
    let mut in_memory = Request::new("memory".into());
    in_memory.given = Given::default().with_recording("memory", held(&file));
    in_memory.given.robot = Some(Arc::new(robot));
    // The recording is used twice, also as the reference.
    for method in [Method::Absolute, Method::Paper] {
        request.reference = (method == Method::Paper).then(|| file.clone());
        in_memory.reference = (method == Method::Paper).then(|| "memory".into());
        let (of_file, _) = answered(&request, method);
        let (of_memory, _) = answered(&in_memory, method);
        // Compared as text, in which NaN equals NaN, for parts of the series without an estimate.
        let joints = |d: &EstimateDocument| format!("{:?}", d.reading.joints);
        assert!(joints(&of_memory) == joints(&of_file), "other numbers");
        assert_eq!(of_memory.reading.recording.path, "memory");
        let joints = |d: &EstimateDocument| d.session.as_ref().map(|s| s.joints.clone());
        assert_eq!(joints(&of_memory), joints(&of_file));
    }
    let text = format!("{:?}", in_memory.given);
    assert!(
        text.contains("biorob-like") && text.contains("memory"),
        "{text}"
    );
}

// Without a specified robot, the folder of the recording is searched, which does not exist.
#[test]
fn in_memory_recording_without_robot_returns_error() {
    let file = root().join("examples/01-stretched-arm/stretched-arm.mcap");
    let mut request = Request::new("memory/none".into());
    request.given = Given::default().with_recording("memory/none", held(&file));
    let plan = Plan {
        method: Method::Paper,
        window: Default::default(),
        baseline: None,
        options: SessionOptions::default(),
        online: false,
    };
    let error = estimate(&request, &plan, &mut |_| {}).unwrap_err();
    assert!(
        error.to_string().contains("robot.toml not found"),
        "{error}"
    );
}

// Arrays have motors in the order of the joints, independent of the motor names.
#[test]
fn array_motors_follow_joint_order() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wrist.mcap");
    let place = root().join("robots/differential-wrist");
    let robot = robot_dir::load(&place, None).unwrap();
    let text = std::fs::read_to_string(root().join("examples/scenarios/differential-wrist.toml"));
    let scenario = Scenario::from_toml(&text.unwrap(), "wrist").unwrap();
    sinew_sim::run(
        &robot.robot,
        &scenario,
        &SimulateOptions::new(&file),
        &mut |_| {},
    )
    .unwrap();
    let mut recording = sinew_log::open(&file, &OpenOptions::default()).unwrap();
    let (joints, motors) = (
        robot.robot.joint_names().to_vec(),
        robot.robot.motor_names(),
    );
    assert_ne!(joints, motors);
    let axes = joints
        .iter()
        .zip(robot.robot.motors_at_shaft())
        .map(|(joint, motor)| Axis {
            motor,
            ..Axis::of_joint(joint)
        });
    recording.select_axes(&Vec::from_iter(axes)).unwrap();
    let mut of_file = Request::new(file);
    of_file.robot = Some(place);
    let mut in_memory = Request::new("memory".into());
    in_memory.given = Given::default().with_recording("memory", held_as(recording));
    in_memory.given.robot = Some(Arc::new(robot));
    let [of_file, of_memory] = [&of_file, &in_memory].map(|request| {
        let (document, _) = answered(request, Method::Absolute);
        document.session.map(|session| session.joints)
    });
    assert_eq!(of_memory, of_file);
    assert_eq!(of_file.unwrap().len(), 2);
}
