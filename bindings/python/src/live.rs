//! Estimators that are stepped sample by sample.

use crate::estimate::{Baseline, BaselineArg, Stated, external_force, payload, temperature};
use crate::failure::Failure;
use crate::recording::one_of;
use crate::robot::RobotArg;
use numpy::{AllowTypeChange, PyArray1, PyArrayLike1};
use pyo3::prelude::*;
use sinew_estimate::feeder::Refusal;
use sinew_estimate::live::{self, Stepped};
use sinew_estimate::session::SessionOptions;
use sinew_model::Gaussian;
use sinew_model::offset::{self, Comparison, OffsetConfig, Sample, VelocityFilter};
use std::sync::Arc;

/// A value per joint; lists and other numbers are converted.
type PerJoint<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;

/// Probability, mean and standard deviation.
type LiveForce<'py> = (f64, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// The values in order, whatever the array's steps are.
fn values(array: &PerJoint<'_>) -> Vec<f64> {
    array.as_array().to_vec()
}

/// Absolute offsets beside a running robot, sample by sample.
#[pyclass(module = "pysinew._core")]
pub(crate) struct LiveOffsets {
    live: live::LiveOffsets,
    names: Vec<String>,
}

fn refusal(why: Refusal) -> &'static str {
    match why {
        Refusal::JointPosition => "refused: a joint position is missing",
        Refusal::JointVelocity => "refused: a joint velocity is missing",
        Refusal::MotorPosition => "refused: a motor position is missing",
        Refusal::Torque => "refused: a torque is missing",
        Refusal::ExternalTorque => "refused: an external torque is missing",
        Refusal::TimeStep => "refused: the time step is no time step",
        Refusal::Range => "refused: a value is too large to be one",
    }
}

impl LiveOffsets {
    fn index(&self, joint: &str) -> Result<usize, Failure> {
        let found = self.names.iter().position(|name| name == joint);
        found.ok_or_else(|| {
            let hint = sinew_files::names::hint(joint, &self.names);
            let known = self.names.join(", ");
            Failure::new(format!("no joint '{joint}'{hint} joints are {known}"))
        })
    }
}

#[pymethods]
impl LiveOffsets {
    #[new]
    #[pyo3(signature = (
        robot, baseline, *, empty=false, payload_kg=None, temperature_c=None, external_force_n=None, motor_torque=true,
        creep_rad_per_s=None
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn new(
        robot: RobotArg<'_>,
        baseline: BaselineArg<'_>,
        empty: bool,
        payload_kg: Option<Stated>,
        temperature_c: Option<Stated>,
        external_force_n: Option<([f64; 3], f64)>,
        motor_torque: bool,
        creep_rad_per_s: Option<f64>,
    ) -> PyResult<Self> {
        let loaded = robot.load()?;
        let (known, file) = baseline.read()?;
        let options = SessionOptions {
            payload: payload(empty, payload_kg)?,
            motor_torque,
            temperature_c: temperature(temperature_c)?,
            external_force_n: external_force(external_force_n)?,
            ..SessionOptions::default()
        };
        let known = (baseline_of(&known), file.as_str());
        let live = live::LiveOffsets::new(loaded.robot.clone(), known, &options);
        let mut live = live.map_err(Failure::from)?;
        if let Some(deviation) = creep_rad_per_s {
            let expected = live.expect_creep(deviation);
            expected.map_err(|_| {
                Failure::new(format!(
                    "creep_rad_per_s = {deviation}: how fast offsets may move, a standard deviation of at least 0 rad/s"
                ))
            })?;
        }
        Ok(Self {
            live,
            names: loaded.robot.joint_names().to_vec(),
        })
    }

    /// Names of the joints, in the order of `q`.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.names.clone()
    }

    /// Takes a sample, `dt` seconds after the one before, and says what became of it: `"taken"`, `"restarted"`,
    /// `"updated"` (the offsets are new), or `"refused: …"` with the reason (nothing has changed).
    ///
    /// `q`, `theta`, `tau_m`: `(n,)`, rad, rad, N·m; `celsius`: °C. What isn't known is NaN, or left out.
    #[pyo3(signature = (dt, q, theta, tau_m=None, celsius=f64::NAN))]
    fn step(
        &mut self,
        dt: f64,
        q: PerJoint<'_>,
        theta: PerJoint<'_>,
        tau_m: Option<PerJoint<'_>>,
        celsius: f64,
    ) -> PyResult<&'static str> {
        let (q, theta) = (values(&q), values(&theta));
        let tau_m = tau_m.as_ref().map(values).unwrap_or_default();
        let stepped = self.live.step(dt, &q, &theta, &tau_m, celsius);
        Ok(match stepped.map_err(Failure::from)? {
            Stepped::Taken => "taken",
            Stepped::Restarted => "restarted",
            Stepped::Updated => "updated",
            Stepped::Refused(why) => refusal(why),
        })
    }

    /// Bounds the work of every `step` that follows: a small, fixed part of a block's, so that the same offsets come one
    /// block, 0.2 s, later. Without it the sample that completes a block does all its work: milliseconds at seven joints.
    /// Returns how many slices of a block's work a step does.
    ///
    /// `period_max_s`: the longest time between samples while all is well, s. Where samples come at longer ones, a block
    /// that finds the one before undone is left out; `blocks_left_out` counts these. `ValueError`: no time step.
    fn bound_work(&mut self, period_max_s: f64) -> PyResult<usize> {
        Ok(self.live.bound_work(period_max_s).map_err(Failure::from)?)
    }

    /// Blocks left out because work on the one before wasn't done: 0 unless samples come at longer times than
    /// `bound_work` was told.
    #[getter]
    fn blocks_left_out(&self) -> u64 {
        self.live.blocks_left_out()
    }

    /// The next sample doesn't go on where the last one was: the filters start anew, what is known stays.
    fn interrupt(&mut self) {
        self.live.interrupt();
    }

    /// Offset of a joint since the baseline: mean and standard deviation, rad.
    fn offset(&self, joint: &str) -> PyResult<(f64, f64)> {
        let offset = self.live.offset(self.index(joint)?);
        Ok((offset.mean, offset.deviation))
    }

    /// Offsets of all joints: means and standard deviations, `(n,)` each, rad.
    fn offsets<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        let all = (0..self.names.len()).map(|joint| self.live.offset(joint));
        let (means, deviations): (Vec<f64>, Vec<f64>) =
            all.map(|offset| (offset.mean, offset.deviation)).unzip();
        (
            PyArray1::from_vec(py, means),
            PyArray1::from_vec(py, deviations),
        )
    }

    /// Whether the offsets are in doubt: the first half minute, a contact, a slip not settled yet.
    #[getter]
    fn in_doubt(&self) -> bool {
        self.live.is_provisional()
    }

    /// Probability, 0 to 1, that a joint's stiffness has changed since the baseline.
    fn stiffness_changed(&self, joint: &str) -> PyResult<f64> {
        Ok(self.live.stiffness_changed(self.index(joint)?))
    }

    /// What a temperature that isn't known, now or in the baseline, adds to the standard deviation of every joint's offset, `(n,)`,
    /// rad; 0 where both are known. The intervals hold it: it is the tolerance of robot.toml, so warmth far beyond that reads
    /// as stretch.
    #[getter]
    fn unknown_temperature_rad<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let joints = 0..self.names.len();
        PyArray1::from_iter(
            py,
            joints.map(|joint| self.live.unknown_temperature_rad(joint)),
        )
    }

    /// A constant force from outside at the tool, as far as it is known: probability that one acts, 0 to 1, then mean and
    /// standard deviation along the axes of the base, `(3,)` each, N, if one does. `None`: none is looked for
    /// (`external_force_n = 0` in robot.toml).
    #[getter]
    fn external_force<'py>(&self, py: Python<'py>) -> Option<LiveForce<'py>> {
        let force = self.live.external_force()?;
        let of = |part: fn(Gaussian) -> f64| PyArray1::from_iter(py, force.force_n.map(part));
        Some((force.probability, of(|f| f.mean), of(|f| f.deviation)))
    }

    /// What is known now, as the baseline of the next session; refused while in doubt.
    ///
    /// `recording` names this session, which ended at `end_time_ns` of its clock.
    fn save(&self, recording: &str, end_time_ns: i64) -> PyResult<Baseline> {
        let saved = self.live.save(recording, end_time_ns);
        Ok(Baseline {
            baseline: Arc::new(saved.map_err(Failure::from)?),
            name: recording.to_owned(),
        })
    }
}

/// A copy to own.
fn baseline_of(
    shared: &Arc<sinew_estimate::baseline::Baseline>,
) -> sinew_estimate::baseline::Baseline {
    sinew_estimate::baseline::Baseline::clone(shared)
}

/// The paper's observer: elastic torque and offset of every joint, sample by sample.
#[pyclass(module = "pysinew._core")]
pub(crate) struct OffsetObserver(offset::OffsetObserver);

#[pymethods]
impl OffsetObserver {
    #[new]
    #[pyo3(signature = (robot, *, gain_per_s=None, cutoff_rad_per_s=None, comparison="matched"))]
    fn new(
        robot: RobotArg<'_>,
        gain_per_s: Option<f64>,
        cutoff_rad_per_s: Option<f64>,
        comparison: &str,
    ) -> PyResult<Self> {
        let words = [
            ("matched", Comparison::Matched),
            ("paper", Comparison::Paper),
        ];
        let plain = OffsetConfig::default();
        let config = OffsetConfig {
            gain_per_s: gain_per_s.unwrap_or(plain.gain_per_s),
            velocity: cutoff_rad_per_s.map_or(plain.velocity, |cutoff_rad_per_s| {
                VelocityFilter::StateVariable { cutoff_rad_per_s }
            }),
            comparison: one_of("comparison", comparison, &words)?,
            ..plain
        };
        let robot = &robot.load()?.robot;
        let observer = offset::OffsetObserver::new(&robot.arm, &robot.transmissions, config);
        Ok(Self(observer.map_err(Failure::from)?))
    }

    /// Steps by `dt`, s, to a sample; the first one starts the filters.
    ///
    /// `q`, `theta`, `tau_ext`: `(n,)`, rad, rad, N·m.
    #[pyo3(signature = (dt, q, theta, tau_ext=None))]
    fn step(
        &mut self,
        dt: f64,
        q: PerJoint<'_>,
        theta: PerJoint<'_>,
        tau_ext: Option<PerJoint<'_>>,
    ) -> PyResult<()> {
        let (q, theta) = (values(&q), values(&theta));
        let tau_ext = tau_ext.as_ref().map(values);
        let sample = Sample {
            q: &q,
            theta_measured: &theta,
            tau_ext: tau_ext.as_deref(),
            ..Sample::default()
        };
        Ok(self.0.step(dt, &sample).map_err(Failure::from)?)
    }

    /// The next sample starts anew.
    fn reset(&mut self) {
        self.0.reset();
    }

    /// Offset of every joint, `(n,)`, rad: `delta_e = (theta_measured − q) − tau_el / K`; NaN of a rigid joint.
    #[getter]
    fn delta_e<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.delta_e())
    }

    /// Elastic torque of every joint, `(n,)`, N·m.
    #[getter]
    fn tau_el<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.tau_el())
    }

    /// Velocity of every joint as filtered, `(n,)`, rad/s.
    #[getter]
    fn dq<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.dq())
    }

    /// Whether the filters have forgotten how they began.
    #[getter]
    fn is_settled(&self) -> bool {
        self.0.is_settled()
    }

    /// How long that takes, s.
    #[getter]
    fn settling_time_s(&self) -> f64 {
        self.0.settling_time_s()
    }
}
