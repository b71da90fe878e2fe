//! Tendons with friction along their path: the cable-driven da Vinci instruments of the shared folder.
//!
//! One joint with encoders and torque sensors at both ends, a sinusoid at the drive, a constant load per recording (O'Neill
//! et al. 2018, doi 10.1109/LRA.2018.2849862). Nothing was re-tensioned, so that every offset is zero.

use crate::support;

use sinew_estimate::Request;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::cable::CableLimit;
use sinew_estimate::feeder::Injection;
use sinew_estimate::session::{
    self, Learning, SessionEstimate, SessionOptions, TendonEstimate, Verdict, Warning, Window,
};
use sinew_log::Mapping;
use std::path::Path;
use support::shared;

/// Time of a step that is added, s: mid-run.
const STEP_S: f64 = 10.0;
/// A whole recording without a step.
const WHOLE: (f64, f64) = (0.0, f64::INFINITY);

const URDF: &str = r#"<robot name="instrument"><link name="base"/>
<link name="jaw"><inertial><origin xyz="0 0 0"/><mass value="0.01"/>
<inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/></inertial></link>
<joint name="jaw" type="continuous"><parent link="base"/><child link="jaw"/><axis xyz="0 0 1"/></joint></robot>"#;

/// The torque of the drive changes by ± 0.065 N·m at a reversal; with the stiffness, the prior of the friction state is 20 mrad.
const ROBOT: &str = r#"urdf = "instrument.urdf"
[joints.jaw]
stiffness_nm_per_rad = 0.8
motor_friction = { coulomb_nm = 0.065 }
friction_along_path = true
"#;

/// The sensor pushes against the jaw, so that its torque has the opposite sign; one turn of the drive is −0.92 of the jaw.
const MAPPING: &str = r#"[joints.jaw]
q = { column = "jaw_encoder_counts", unit = "count", counts_per_turn = 4000, wrap = false }
theta = { column = "drive_encoder_counts", unit = "count", counts_per_turn = 8192, scale = -0.92, wrap = false }
tau_el = { column = "jaw_torque_counts", unit = "N·m", scale = -0.000039811 }
"#;

/// Folder of the robot, and recordings by their names.
struct Instrument {
    folder: tempfile::TempDir,
    data: std::path::PathBuf,
}

impl Instrument {
    fn new(data: &Path) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("robot.toml"), ROBOT).unwrap();
        std::fs::write(folder.path().join("instrument.urdf"), URDF).unwrap();
        Self {
            folder,
            data: data.to_path_buf(),
        }
    }

    fn request(&self, name: &str) -> Request {
        let mut request = Request::new(self.data.join(format!("tool_4_l_{name}.parquet")));
        request.robot = Some(self.folder.path().to_path_buf());
        request.open.mapping = Some(Mapping::from_toml(MAPPING, "mapping.toml").unwrap());
        request
    }

    fn learn(&self, names: &[&str]) -> Baseline {
        let requests: Vec<Request> = names.iter().map(|name| self.request(name)).collect();
        let learning = Learning::default();
        session::learn_runs(&requests, Window::default(), &learning, &mut |_| {})
            .unwrap()
            .0
    }

    /// Estimates a recording up to `to_s` with a step of the offset, mrad.
    fn estimate(
        &self,
        name: &str,
        baseline: &Baseline,
        (step_mrad, to_s): (f64, f64),
    ) -> SessionEstimate {
        let mut request = self.request(name);
        if step_mrad != 0.0 {
            request.injections.push(Injection {
                joint: "jaw".into(),
                offset_rad: 1e-3 * step_mrad,
                from_s: Some(STEP_S),
            });
        }
        // As the program reads it from the file.
        let baseline = Baseline::parse(&baseline.to_text(), "b.json").unwrap();
        let window = Window { from_s: 0.0, to_s };
        let options = SessionOptions::default();
        let baseline = Some((&baseline, "b.json"));
        session::estimate(&request, window, baseline, &options, &mut |_| {})
            .unwrap()
            .0
    }
}

fn reasons(estimate: &SessionEstimate) -> Vec<CableLimit> {
    let reason = |warning: &Warning| match warning {
        Warning::CableInconclusive { reason, .. } => Some(*reason),
        _ => None,
    };
    estimate.warnings.iter().filter_map(reason).collect()
}

fn jaw(estimate: &SessionEstimate) -> &TendonEstimate {
    assert_eq!(estimate.joints.len(), 1);
    &estimate.joints[0]
}

/// Errors of a set of recordings, mrad.
#[derive(Default)]
struct Errors {
    offsets: Vec<f64>,
    half_widths: Vec<f64>,
    false_verdicts: usize,
    alarms: usize,
    sizes: Vec<f64>,
    /// Errors of the time of the step, s.
    errors_s: Vec<f64>,
    /// Number of steps found within two seconds.
    soon: usize,
}

impl Errors {
    fn of(instrument: &Instrument, baseline: &Baseline, names: &[String]) -> Self {
        let mut out = Self::default();
        for name in names {
            let estimate = instrument.estimate(name, baseline, WHOLE);
            assert_eq!(reasons(&estimate), [], "{name}");
            let joint = jaw(&estimate);
            out.offsets.push(1e3 * joint.offset_rad.mean);
            out.half_widths.push(1e3 * joint.offset_rad.half_width_95());
            let is_detected = matches!(
                joint.verdict,
                Verdict::Elongated | Verdict::Shortened | Verdict::OffsetDetected
            );
            out.false_verdicts += usize::from(is_detected);
            out.alarms += usize::from(!joint.changes.is_empty());
            // As the whole recording, and as a monitor after two seconds.
            let stepped = instrument.estimate(name, baseline, (10.0, f64::INFINITY));
            if let [change] = &jaw(&stepped).changes[..] {
                let size_rad = change.size_rad.expect("a size");
                out.sizes.push(1e3 * size_rad.mean);
                out.errors_s.push((change.time_s - STEP_S).abs());
            }
            let soon = instrument.estimate(name, baseline, (10.0, STEP_S + 2.0));
            out.soon += usize::from(!jaw(&soon).changes.is_empty());
        }
        println!("{}", out.summary());
        out
    }

    fn rms(&self) -> f64 {
        let square: f64 = self.offsets.iter().map(|x| x * x).sum();
        (square / self.offsets.len() as f64).sqrt()
    }

    fn worst(&self) -> f64 {
        self.offsets.iter().fold(0.0, |worst, x| worst.max(x.abs()))
    }

    fn widest(&self) -> f64 {
        self.half_widths.iter().copied().fold(0.0, f64::max)
    }

    fn summary(&self) -> String {
        format!(
            "{} runs: RMS {:.2}, worst {:.2}, half-width up to {:.2} mrad, {} false verdicts, {} alarms; {} steps found, {} within 2 s",
            self.offsets.len(),
            self.rms(),
            self.worst(),
            self.widest(),
            self.false_verdicts,
            self.alarms,
            self.sizes.len(),
            self.soon
        )
    }

    /// Checks the steps: all found, of the right size, at the right time.
    #[track_caller]
    fn check_steps(&self) {
        assert_eq!(self.alarms, 0, "{}", self.summary());
        assert_eq!(self.sizes.len(), self.offsets.len(), "{}", self.summary());
        let near = |x: &&f64| (**x - 10.0).abs() <= 1.5;
        assert_eq!(self.sizes.iter().filter(near).count(), self.sizes.len());
        assert!(
            self.errors_s.iter().all(|x| *x <= 0.5),
            "{:?}",
            self.errors_s
        );
        let share = self.soon as f64 / self.offsets.len() as f64;
        assert!(share >= 0.9, "{}", self.summary());
    }
}

/// Names of the runs of a set beyond those of the baseline.
fn others(all: impl Iterator<Item = String>, baseline: &[&str]) -> Vec<String> {
    all.filter(|name| !baseline.contains(&name.as_str()))
        .collect()
}

#[test]
fn jaw_with_two_loads_has_no_elongation() {
    let Some(data) = shared("data/davinci_tools") else {
        return;
    };
    let instrument = Instrument::new(&data);
    // The lightest and the heaviest load at 0.1 Hz.
    let learned = ["2_00", "2_03"];
    let baseline = instrument.learn(&learned);
    let all = (0..5).flat_map(|speed| (0..4).map(move |load| format!("2_{speed}{load}")));
    let errors = Errors::of(&instrument, &baseline, &others(all, &learned));
    assert!(
        errors.rms() <= 2.5 && errors.worst() <= 4.0,
        "{}",
        errors.summary()
    );
    assert!(errors.widest() <= 9.0, "{}", errors.summary());
    assert_eq!(errors.false_verdicts, 0, "{}", errors.summary());
    errors.check_steps();
}

#[test]
fn pitched_jaw_with_two_ranges_has_no_elongation() {
    let Some(data) = shared("data/davinci_tools") else {
        return;
    };
    let instrument = Instrument::new(&data);
    // Two loads and two joint ranges at 0.3 Hz.
    let learned = ["pitch_1_000", "pitch_1_003", "pitch_1_100", "pitch_1_103"];
    let baseline = instrument.learn(&learned);
    let runs = (0..2).flat_map(|range| (0..2).map(move |speed| format!("{range}{speed}")));
    let all = runs.flat_map(|run| (0..4).map(move |load| format!("pitch_1_{run}{load}")));
    let errors = Errors::of(&instrument, &baseline, &others(all, &learned));
    assert!(
        errors.rms() <= 5.5 && errors.worst() <= 9.0,
        "{}",
        errors.summary()
    );
    let share = errors.false_verdicts as f64 / errors.offsets.len() as f64;
    assert!(share <= 0.1, "{}", errors.summary());
    errors.check_steps();
}

#[test]
fn unlearned_load_and_range_are_inconclusive() {
    let Some(data) = shared("data/davinci_tools") else {
        return;
    };
    let instrument = Instrument::new(&data);
    let one_load = instrument.learn(&["2_00"]);
    let estimate = instrument.estimate("2_02", &one_load, WHOLE);
    assert_eq!(jaw(&estimate).verdict, Verdict::Inconclusive);
    let found = reasons(&estimate);
    let [
        CableLimit::OneLoad {
            load_nm,
            learned_nm,
        },
    ] = found[..]
    else {
        panic!("{found:?}");
    };
    assert!((load_nm - 0.0352).abs() < 1e-3 && (learned_nm[1] - 0.0113).abs() < 1e-3);
    // A range of the joint that is not learned, and the joint without any baseline.
    let one_range = instrument.learn(&["pitch_1_000", "pitch_1_003"]);
    let estimate = instrument.estimate("pitch_1_101", &one_range, WHOLE);
    assert_eq!(jaw(&estimate).verdict, Verdict::Inconclusive);
    let found = reasons(&estimate);
    assert!(matches!(found[..], [CableLimit::Range { .. }]), "{found:?}");
    let (estimate, _) = session::estimate(
        &instrument.request("2_02"),
        Window::default(),
        None,
        &SessionOptions::default(),
        &mut |_| {},
    )
    .unwrap();
    assert_eq!(reasons(&estimate), [CableLimit::NoBaseline]);
    assert_eq!(jaw(&estimate).verdict, Verdict::Inconclusive);
}
