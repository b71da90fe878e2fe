//! Estimators that are stepped sample by sample.

use crate::estimate::{Baseline, BaselineArg, Stated, external_force, payload, temperature};
use crate::failure::Failure;
use crate::recording::one_of;
use crate::robot::RobotArg;
use crate::work::pool;
use numpy::{AllowTypeChange, PyArray1, PyArrayLike1};
use pyo3::prelude::*;
use sinew_estimate::feeder::RejectionReason;
use sinew_estimate::online::{
    OnlineEstimator as Estimator, OnlineJoint, OnlineWorker, StepOutcome,
};
use sinew_estimate::session::SessionOptions;
use sinew_model::Gaussian;
use sinew_model::offset::{self, Comparison, OffsetConfig, Sample, VelocityFilter};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Name of the session in messages until it is saved.
const NAME: &str = "live offsets";

/// A value per joint; lists and other numbers are converted.
type PerJoint<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;

/// Probability, mean and standard deviation.
type OnlineForce<'py> = (f64, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Returns the values in order, for any stride of the array.
fn values(array: &PerJoint<'_>) -> Vec<f64> {
    array.as_array().to_vec()
}

fn rejection(reason: RejectionReason) -> &'static str {
    match reason {
        RejectionReason::JointPosition => "rejected: a joint position is missing",
        RejectionReason::JointVelocity => "rejected: a joint velocity is missing",
        RejectionReason::MotorPosition => "rejected: a motor position is missing",
        RejectionReason::Torque => "rejected: a torque is missing",
        RejectionReason::ExternalTorque => "rejected: an external torque is missing",
        RejectionReason::TimeStep => "rejected: the time step is invalid",
        RejectionReason::Range => "rejected: a value is too large or beyond reach",
    }
}

/// Creates an object of a class of the package from JSON data.
fn record<'py>(
    py: Python<'py>,
    (module, class): (&str, &str),
    json: serde_json::Result<String>,
) -> PyResult<Bound<'py, PyAny>> {
    let data = (py.import("json")?).call_method1("loads", (json.map_err(Failure::from)?,))?;
    py.import(module)?.getattr(class)?.call1((data,))
}

/// Online estimator of the tendon offsets of a running robot: ``delta_e = (theta_measured − q) − tau_el / K``.
///
/// ``step`` belongs in the control loop: it averages samples over blocks of 0.2 s and solves nothing. A worker solves the blocks of
/// the last 120 s every 2 s with the estimator of ``estimate``, and compares every later block with the prediction of that solution.
/// It is a separate thread with ``worker=True``; otherwise the caller calls ``work()`` outside the loop.
///
/// Objects are thread-safe.
///
/// Parameters
/// ----------
/// robot
///     Folder of the robot or a ``Robot``.
/// baseline
///     Reference of the offsets, a file or a ``Baseline``. ``None``: the encoder zero.
/// empty, payload_kg
///     Mass in the gripper, kg, with a standard deviation of 2 % or as ``(mean, std)``.
/// temperature_c
///     Temperature of samples without one, °C, with a standard deviation of 2 K or as ``(mean, std)``.
/// external_force_n
///     Constant external force at the tool, as ``((x, y, z), std)`` in the base frame, N.
/// motor_torque
///     Whether the motor torque of the samples is used.
/// creep
///     Whether ropes may creep within the session; ``False`` for steel.
/// worker
///     Whether an internal thread solves. Threads do not survive a fork: create the object in the child process.
///
/// Raises
/// ------
/// SinewError
///     If the baseline belongs to another robot or a value is out of range.
#[pyclass(frozen, module = "pysinew._core")]
pub(crate) struct OnlineEstimator {
    names: Vec<String>,
    /// Never locked while Python code runs.
    online: Mutex<Estimator>,
    /// `None` if an internal thread owns the worker.
    worker: Option<Mutex<Box<OnlineWorker>>>,
}

impl OnlineEstimator {
    fn online(&self) -> MutexGuard<'_, Estimator> {
        self.online.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the estimate of a joint; `None` for a rigid joint.
    fn joint(&self, joint: &str) -> Result<Option<OnlineJoint>, Failure> {
        let found = self.names.iter().position(|name| name == joint);
        let index = found.ok_or_else(|| {
            let hint = sinew_files::names::hint(joint, &self.names);
            let joints = self.names.join(", ");
            Failure::new(format!("no joint '{joint}'{hint} joints are {joints}"))
        })?;
        Ok(self.online().answer().joint(index).copied())
    }

    /// Returns a value of every joint, all from one estimate.
    fn each<T>(&self, value: impl Fn(Option<&OnlineJoint>) -> T) -> Vec<T> {
        let mut online = self.online();
        let answer = online.answer();
        (0..self.names.len())
            .map(|joint| value(answer.joint(joint)))
            .collect()
    }
}

/// Mean and standard deviation; NaN of a rigid joint.
fn offset_of(own: Option<&OnlineJoint>) -> (f64, f64) {
    own.map_or((f64::NAN, f64::NAN), |own| {
        (own.offset_rad.mean, own.offset_rad.std)
    })
}

#[pymethods]
impl OnlineEstimator {
    #[new]
    #[pyo3(signature = (
        robot, baseline=None, *, empty=false, payload_kg=None, temperature_c=None, external_force_n=None, motor_torque=true,
        creep=true, worker=false
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn new(
        robot: RobotArg<'_>,
        baseline: Option<BaselineArg<'_>>,
        empty: bool,
        payload_kg: Option<Stated>,
        temperature_c: Option<Stated>,
        external_force_n: Option<([f64; 3], f64)>,
        motor_torque: bool,
        creep: bool,
        worker: bool,
    ) -> PyResult<Self> {
        let loaded = robot.load()?;
        let baseline = baseline.as_ref().map(BaselineArg::read).transpose()?;
        let baseline = baseline.map(|(baseline, file)| (Arc::unwrap_or_clone(baseline), file));
        let options = SessionOptions {
            payload: payload(empty, payload_kg)?,
            motor_torque,
            temperature_c: temperature(temperature_c)?,
            external_force_n: external_force(external_force_n)?,
            creep,
            ..SessionOptions::default()
        };
        let online = Estimator::new(loaded.robot.clone(), baseline, &options, NAME);
        let mut online = online.map_err(Failure::from)?;
        if worker {
            online.start_worker()?;
        }
        Ok(Self {
            names: (0..loaded.robot.axes())
                .map(|axis| loaded.robot.axis_name(axis).to_owned())
                .collect(),
            worker: online.take_worker().map(Mutex::new),
            online: Mutex::new(online),
        })
    }

    /// Names of the joints in the order of ``q``, then of tendons beyond these, whose ``q`` is 0.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.names.clone()
    }

    /// Adds a sample; only the clock advances where it is rejected.
    ///
    /// Parameters
    /// ----------
    /// dt_s
    ///     Time since the previous sample, s; ignored for the first sample.
    /// q, theta, tau_m
    ///     Joint positions, rad, motor positions, rad, and motor torques, N·m, ``(n,)``; missing values are NaN or omitted.
    /// temperature_c
    ///     Temperature, °C; NaN where it is not measured.
    ///
    /// Returns
    /// -------
    /// str
    ///     ``"accepted"``; ``"restarted"`` (the first sample, or the first after a gap); ``"block"`` (the sample completed a
    ///     block for the worker); or ``"rejected: …"`` with the reason.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For a wrong number of values or a time step that is not positive; the state is then unchanged.
    #[pyo3(signature = (dt_s, q, theta, tau_m=None, temperature_c=f64::NAN))]
    fn step(
        &self,
        dt_s: f64,
        q: PerJoint<'_>,
        theta: PerJoint<'_>,
        tau_m: Option<PerJoint<'_>>,
        temperature_c: f64,
    ) -> PyResult<&'static str> {
        let (q, theta) = (values(&q), values(&theta));
        let tau_m = tau_m.as_ref().map(values).unwrap_or_default();
        let mut online = self.online();
        let outcome = online.step(dt_s, &q, &theta, &tau_m, temperature_c);
        Ok(match outcome.map_err(Failure::from)? {
            StepOutcome::Accepted => "accepted",
            StepOutcome::Restarted => "restarted",
            StepOutcome::Block => "block",
            StepOutcome::Rejected(reason) => rejection(reason),
        })
    }

    /// Processes all completed blocks, and solves the window when due: some hundredths of a second every 2 s.
    ///
    /// Not for a control loop: call it after a ``"block"``, or from another thread. Other Python threads continue meanwhile. Blocks wait
    /// for ten seconds; then they are dropped. No effect with ``worker=True``.
    fn work(&self, py: Python<'_>) -> PyResult<()> {
        if let Some(worker) = &self.worker {
            // Is never interrupted: the estimate would be half updated.
            let pool = pool(&Arc::default())?;
            py.detach(|| {
                pool.install(|| {
                    let mut worker = worker.lock().unwrap_or_else(PoisonError::into_inner);
                    worker.work();
                });
            });
        }
        Ok(())
    }

    /// Marks a gap before the next sample: the filters are re-initialised, the estimates are kept.
    fn interrupt(&self) {
        self.online().interrupt();
    }

    /// Offset of a joint since the baseline: mean and standard deviation, rad; the 95 % interval is ± 1.96 standard deviations.
    ///
    /// Parameters
    /// ----------
    /// joint
    ///     Name of the joint.
    ///
    /// Returns
    /// -------
    /// tuple of float
    ///     Mean and standard deviation, rad; NaN before the first solution, and of a rigid joint.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     Where there is no such joint.
    fn offset(&self, joint: &str) -> PyResult<(f64, f64)> {
        Ok(offset_of(self.joint(joint)?.as_ref()))
    }

    /// Offsets of all joints at one time: means and standard deviations, ``(n,)`` each, rad; NaN as in ``offset``.
    fn offsets<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        let (means, stds) = self.each(offset_of).into_iter().unzip();
        (PyArray1::from_vec(py, means), PyArray1::from_vec(py, stds))
    }

    /// Reason for a provisional offset of a joint.
    ///
    /// Parameters
    /// ----------
    /// joint
    ///     Name of the joint.
    ///
    /// Returns
    /// -------
    /// Provisional or None
    ///     ``None``: the offset is settled, or the joint is rigid.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     Where there is no such joint.
    fn provisional<'py>(
        &self,
        py: Python<'py>,
        joint: &str,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let reason = self.joint(joint)?.and_then(|own| own.provisional);
        let class = ("pysinew._live", "Provisional");
        reason
            .map(|reason| record(py, class, serde_json::to_string(&reason)))
            .transpose()
    }

    /// Whether the offset of any joint is provisional.
    #[getter]
    fn is_provisional(&self) -> bool {
        self.online().answer().is_provisional()
    }

    /// Middle of the last block of the estimate, s since the first sample; NaN before the first block.
    #[getter]
    fn time_s(&self) -> f64 {
        self.online().answer().time_s
    }

    /// Middle of the last block of the solution, s since the first sample; NaN before the first solution.
    #[getter]
    fn solved_s(&self) -> f64 {
        self.online().answer().solved_s
    }

    /// Age of the solution, ``time_s − solved_s``, s; NaN before the first one. At most 2 while the arm moves; it grows in a
    /// long rest phase, whose blocks replace each other.
    #[getter]
    fn age_s(&self) -> f64 {
        let mut online = self.online();
        let answer = online.answer();
        answer.time_s - answer.solved_s
    }

    /// Number of blocks that the worker has processed.
    #[getter]
    fn blocks(&self) -> u64 {
        self.online().answer().blocks
    }

    /// Number of completed blocks that are neither in the estimate nor dropped. If the number grows, the worker is too slow or
    /// is not called, and the estimate is outdated.
    #[getter]
    fn blocks_behind(&self) -> u64 {
        self.online().blocks_behind()
    }

    /// Number of blocks dropped because the worker was late by more than ten seconds.
    #[getter]
    fn blocks_dropped(&self) -> u64 {
        self.online().blocks_dropped()
    }

    /// Probability, 0 to 1, that something touches the arm in the last block; 0 before the first solution.
    #[getter]
    fn contact_probability(&self) -> f64 {
        self.online().answer().contact_probability
    }

    /// Probability, 0 to 1, that the stiffness of a joint has changed since the baseline.
    ///
    /// Parameters
    /// ----------
    /// joint
    ///     Name of the joint.
    ///
    /// Returns
    /// -------
    /// float or None
    ///     ``None`` if it is not estimated.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     Where there is no such joint.
    fn stiffness_changed_probability(&self, joint: &str) -> PyResult<Option<f64>> {
        let own = self.joint(joint)?;
        Ok(own.and_then(|own| own.stiffness_changed_probability))
    }

    /// Contribution of an unknown temperature, now or in the baseline, to the standard deviation of every joint's offset, ``(n,)``, rad;
    /// 0 if both are known. The standard deviations include it. It covers the tolerance of robot.toml; a larger temperature
    /// difference biases the offset.
    #[getter]
    fn unknown_temperature_rad<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let unknown_rad = self.each(|own| own.map_or(0.0, |own| own.unknown_temperature_rad));
        PyArray1::from_vec(py, unknown_rad)
    }

    /// Constant external force at the tool: its posterior probability, 0 to 1, then mean and standard deviation in the base frame,
    /// ``(3,)`` each, N, given that it acts. ``None``: no force detected.
    #[getter]
    fn external_force<'py>(&self, py: Python<'py>) -> Option<OnlineForce<'py>> {
        let force = self.online().answer().external_force?;
        let of = |part: fn(Gaussian) -> f64| PyArray1::from_iter(py, force.force_n.map(part));
        Some((force.probability, of(|f| f.mean), of(|f| f.std)))
    }

    /// Reason why the last window could not be solved, or ``None``. After an error the offsets are those of the previous solution, and
    /// provisional.
    #[getter]
    fn error(&self) -> Option<String> {
        self.online().error().map(|reason| reason.to_string())
    }

    /// Last solution in the form of ``session`` of ``estimate``, for the blocks of the window: a ``SessionEstimate``.
    /// ``None`` before the first solution.
    fn result<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let estimate = self.online().estimate();
        let class = ("pysinew.results", "SessionEstimate");
        estimate
            .map(|estimate| record(py, class, serde_json::to_string(&estimate)))
            .transpose()
    }

    /// Last solution as the baseline of the next session.
    ///
    /// Parameters
    /// ----------
    /// recording
    ///     Name of this session.
    /// end_time_ns
    ///     End of this session by its clock, ns.
    ///
    /// Returns
    /// -------
    /// Baseline
    ///     The posterior of this session.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     While an offset is provisional.
    fn save(&self, recording: &str, end_time_ns: i64) -> PyResult<Baseline> {
        let saved = self.online().save(recording, end_time_ns);
        Ok(Baseline {
            baseline: Arc::new(saved.map_err(Failure::from)?),
            name: recording.to_owned(),
        })
    }
}

/// The paper's observer: elastic torque and offset of every joint, sample by sample.
///
/// Parameters
/// ----------
/// robot
///     Folder of the robot or a ``Robot``.
/// gain_per_s
///     Gain of the observer, 1/s; the default is that of ``estimate``.
/// cutoff_rad_per_s
///     Cut-off of the velocity filter, rad/s; the default is that of ``estimate``.
/// comparison
///     ``"matched"``: both sides pass the same filter; ``"paper"``: as in the publication.
///
/// Raises
/// ------
/// SinewError
///     For invalid settings.
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

    /// Steps to a sample; the first one starts the filters.
    ///
    /// Parameters
    /// ----------
    /// dt_s
    ///     Time since the previous sample, s; ignored for the first sample.
    /// q, theta, tau_ext
    ///     Joint positions, rad, motor positions, rad, and measured external torques, N·m, ``(n,)``.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For an invalid sample, which leaves the observer unchanged.
    #[pyo3(signature = (dt_s, q, theta, tau_ext=None))]
    fn step(
        &mut self,
        dt_s: f64,
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
        Ok(self.0.step(dt_s, &sample).map_err(Failure::from)?)
    }

    /// Restarts the filters at the next sample.
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

    /// Whether the start-up transient of the filters has decayed.
    #[getter]
    fn is_settled(&self) -> bool {
        self.0.is_settled()
    }

    /// Settling time of the filters, s.
    #[getter]
    fn settling_time_s(&self) -> f64 {
        self.0.settling_time_s()
    }
}
