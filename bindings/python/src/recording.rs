//! Recordings: files, arrays, messages.

use crate::arrays::{Held, Reader};
use crate::document::{Document, Shown};
use crate::failure::Failure;
use crate::robot::hash_of;
use crate::table::{Reduced, Table};
use crate::work::work;
use arrow_array::{ArrayRef, Float64Array, Int64Array};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyIterator, PyTuple};
use sinew_estimate::{Given, Opener};
use sinew_log::{
    Channels, Format, Frame, GivenMessages, JointEffort, LogError, Mapping, OpenOptions,
    Quantities, Quantity, RecordingInfo,
};
use std::path::PathBuf;
use std::sync::Arc;

/// Source of the samples.
#[derive(Clone)]
enum Source {
    /// Files, and the owner of temporary ones, which deletes them when it is dropped.
    Files(PathBuf, Option<Arc<Py<PyAny>>>),
    Arrays(Arc<Held>),
    Messages(Arc<GivenMessages>),
}

impl Source {
    fn open(&self, name: &str, options: &OpenOptions) -> Result<sinew_log::Recording, LogError> {
        match self {
            Self::Files(path, _) => sinew_log::open(path, options),
            Self::Arrays(held) => {
                let reader = Box::new(Reader(held.clone()));
                sinew_log::Recording::from_arrays(reader, name, options)
            }
            Self::Messages(given) => {
                sinew_log::Recording::from_messages(given.clone(), name, options)
            }
        }
    }
}

/// A recording: joint and motor positions over time.
///
/// Two recordings are equal if they have the same joints, quantities and frames, in any format; the comparison
/// reads both.
///
/// Parameters
/// ----------
/// path
///     File, folder of a ROS 2 bag, open file or bytes of a file.
/// mapping
///     File with the names, units and signs of the recording.
/// joint_topic, motor_topic
///     Topics of the joint side and the motor side.
/// motor_interface
///     Interface of ``DynamicJointState`` with the motor position.
/// joint_effort
///     Quantity of the joint side's effort: ``"tau-el"``, ``"tau-m"`` or ``"ignore"``.
/// gap_s
///     Maximum time between frames of one segment, s.
///
/// Raises
/// ------
/// SinewError
///     For an invalid or missing recording.
#[pyclass(frozen, module = "pysinew._core")]
pub(crate) struct Recording {
    name: String,
    source: Source,
    opening: Opening,
    options: OpenOptions,
    joints: Vec<String>,
    channels: Channels,
    format: Format,
    description: Option<String>,
}

/// Recording, or the path of one.
#[derive(FromPyObject)]
pub(crate) enum LogArg<'py> {
    #[pyo3(annotation = "Recording")]
    Recording(Bound<'py, Recording>),
    #[pyo3(annotation = "path")]
    Path(PathBuf),
}

impl LogArg<'_> {
    /// Name of the recording in a request.
    pub(crate) fn name(&self) -> PathBuf {
        match self {
            Self::Recording(recording) => PathBuf::from(&recording.get().name),
            Self::Path(path) => path.clone(),
        }
    }

    /// Options for reading the recording.
    pub(crate) fn options(&self) -> OpenOptions {
        match self {
            Self::Recording(recording) => recording.get().options.clone(),
            Self::Path(_) => OpenOptions::default(),
        }
    }

    /// Adds a recording in memory to the inputs; a path has no effect.
    pub(crate) fn give(&self, given: Given) -> Given {
        match self {
            Self::Recording(recording) => {
                let recording = recording.get();
                given.with_recording(&recording.name, recording.opener())
            }
            Self::Path(_) => given,
        }
    }
}

const EFFORTS: [(&str, JointEffort); 3] = [
    ("tau-el", JointEffort::TauEl),
    ("tau-m", JointEffort::TauM),
    ("ignore", JointEffort::Ignore),
];

/// Finds the value of a keyword.
pub(crate) fn one_of<T: Clone>(
    what: &str,
    word: &str,
    words: &[(&'static str, T)],
) -> Result<T, Failure> {
    let found = words.iter().find(|(name, _)| *name == word);
    found.map(|(_, value)| value.clone()).ok_or_else(|| {
        let names: Vec<&str> = words.iter().map(|(name, _)| *name).collect();
        let names = names.join("', '");
        Failure::new(format!("{what} is '{word}'; it can be '{names}'"))
    })
}

impl Recording {
    fn of(name: String, source: Source, opening: Opening) -> Result<Self, Failure> {
        let options = opening.options()?;
        let reader = source.open(&name, &options)?;
        Ok(Self {
            joints: reader.joints().to_vec(),
            channels: reader.channels().clone(),
            format: reader.format(),
            description: reader.robot_description().map(str::to_owned),
            name,
            source,
            opening,
            options,
        })
    }

    /// Opens the recording again from its start, with the options of the first opening; a reference has its own mapping.
    fn opener(&self) -> Opener {
        let (name, source) = (self.name.clone(), self.source.clone());
        let options = self.options.clone();
        Arc::new(move |_| source.open(&name, &options))
    }

    /// Reads all frames into columns.
    fn columns(
        &self,
        py: Python<'_>,
        joints: Option<Vec<String>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(Vec<String>, Columns)> {
        let joints = joints.unwrap_or_else(|| self.joints.clone());
        let (opener, options, selected) = (self.opener(), self.options.clone(), joints.clone());
        let columns = work(py, "reading", progress, move |tracker| {
            let mut recording = opener(&options)?;
            let names: Vec<&str> = selected.iter().map(String::as_str).collect();
            recording.select(&names)?;
            let mut columns = Columns::new(recording.channels().union());
            while let Some(frame) = recording.next_frame()? {
                columns.push(frame);
                if columns.time_ns.len().is_multiple_of(8192) {
                    let at = recording.progress();
                    tracker.at(at.bytes_done as f64, at.bytes_total as f64);
                }
            }
            Ok(columns)
        })?;
        Ok((joints, columns))
    }
}

/// Frames as columns.
pub(crate) struct Columns {
    pub(crate) time_ns: Vec<i64>,
    segment: Vec<u32>,
    /// Values in row-major order.
    pub(crate) by_joint: Vec<(Quantity, Vec<f64>)>,
    pub(crate) temperature_c: Option<Vec<f64>>,
}

impl Columns {
    pub(crate) fn new(quantities: Quantities) -> Self {
        let joints = quantities.iter().filter(|q| *q != Quantity::Temperature);
        Self {
            time_ns: Vec::new(),
            segment: Vec::new(),
            by_joint: joints.map(|quantity| (quantity, Vec::new())).collect(),
            temperature_c: quantities.temperature.then(Vec::new),
        }
    }

    pub(crate) fn push(&mut self, frame: &Frame) {
        self.time_ns.push(frame.time_ns);
        self.segment.push(frame.segment);
        for (quantity, values) in &mut self.by_joint {
            values.extend_from_slice(frame.get(*quantity));
        }
        if let Some(values) = &mut self.temperature_c {
            values.push(frame.temperature_c);
        }
    }

    /// Returns the NumPy arrays by name without a copy.
    pub(crate) fn arrays<'py>(
        self,
        py: Python<'py>,
        joints: &[String],
    ) -> PyResult<Bound<'py, PyDict>> {
        let rows = self.time_ns.len();
        let out = PyDict::new(py);
        out.set_item("joints", joints)?;
        out.set_item("time_ns", PyArray1::from_vec(py, self.time_ns))?;
        for (quantity, values) in self.by_joint {
            let array = PyArray1::from_vec(py, values).reshape([rows, joints.len()])?;
            out.set_item(quantity.symbol(), array)?;
        }
        if let Some(values) = self.temperature_c {
            out.set_item("temperature_c", PyArray1::from_vec(py, values))?;
        }
        out.set_item("segment", PyArray1::from_vec(py, self.segment))?;
        Ok(out)
    }
}

/// Converts a message of `rosbags`, or a tuple of topic, type, time and bytes.
fn message(item: &Bound<'_, PyAny>) -> PyResult<(String, String, u64, Vec<u8>)> {
    let invalid = "expected messages (connection, timestamp, rawdata) of rosbags, or (topic, type, time_ns, data)";
    let parts = item
        .cast::<PyTuple>()
        .map_err(|_| PyTypeError::new_err(invalid))?;
    let bytes = |part: &Bound<'_, PyAny>| -> PyResult<Vec<u8>> {
        match part.cast::<PyBytes>() {
            Ok(bytes) => Ok(bytes.as_bytes().to_vec()),
            // memoryview, bytearray
            Err(_) => part
                .call_method0("tobytes")
                .or_else(|_| part.call_method0("__bytes__"))?
                .extract(),
        }
    };
    match parts.len() {
        3 => {
            let connection = parts.get_item(0)?;
            let topic = connection.getattr("topic")?.extract()?;
            let kind = connection.getattr("msgtype")?.extract()?;
            let time = parts.get_item(1)?.extract()?;
            Ok((topic, kind, time, bytes(&parts.get_item(2)?)?))
        }
        4 => Ok((
            parts.get_item(0)?.extract()?,
            parts.get_item(1)?.extract()?,
            parts.get_item(2)?.extract()?,
            bytes(&parts.get_item(3)?)?,
        )),
        _ => Err(PyTypeError::new_err(invalid)),
    }
}

/// Options for opening a recording.
#[derive(Clone, Default)]
struct Opening {
    mapping: Option<PathBuf>,
    joint_topic: Option<String>,
    motor_topic: Option<String>,
    motor_interface: Option<String>,
    joint_effort: Option<String>,
    gap_s: Option<f64>,
}

impl Opening {
    fn options(&self) -> Result<OpenOptions, Failure> {
        let mut options = OpenOptions {
            mapping: self.mapping.as_deref().map(Mapping::read).transpose()?,
            joint_state_topic: self.joint_topic.clone(),
            motor_topic: self.motor_topic.clone(),
            ..OpenOptions::default()
        };
        if let Some(name) = &self.motor_interface {
            options.motor_interface.clone_from(name);
        }
        if let Some(word) = &self.joint_effort {
            options.joint_effort = one_of("joint_effort", word, &EFFORTS)?;
        }
        options.gap_s = self.gap_s.unwrap_or(options.gap_s);
        Ok(options)
    }

    /// The specified options as keywords.
    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let out = PyDict::new(py);
        let texts = [
            ("joint_topic", &self.joint_topic),
            ("motor_topic", &self.motor_topic),
            ("motor_interface", &self.motor_interface),
            ("joint_effort", &self.joint_effort),
        ];
        for (name, text) in texts {
            if let Some(text) = text {
                out.set_item(name, text)?;
            }
        }
        if let Some(mapping) = &self.mapping {
            out.set_item("mapping", mapping)?;
        }
        if let Some(gap_s) = self.gap_s {
            out.set_item("gap_s", gap_s)?;
        }
        Ok(out)
    }
}

/// Whether two recordings have the same frames from here on; NaN equals NaN.
fn same_frames(
    one: &mut sinew_log::Recording,
    other: &mut sinew_log::Recording,
    quantities: Quantities,
) -> Result<bool, LogError> {
    let same = |a: &f64, b: &f64| a == b || a.is_nan() && b.is_nan();
    loop {
        let (one, other) = match (one.next_frame()?, other.next_frame()?) {
            (None, None) => return Ok(true),
            (Some(one), Some(other)) => (one, other),
            _ => return Ok(false),
        };
        let joints = quantities.iter().filter(|q| *q != Quantity::Temperature);
        let mut values = joints.flat_map(|q| one.get(q).iter().zip(other.get(q)));
        if (one.time_ns, one.segment) != (other.time_ns, other.segment)
            || !same(&one.temperature_c, &other.temperature_c)
            || !values.all(|(a, b)| same(a, b))
        {
            return Ok(false);
        }
    }
}

/// Converts to a NumPy array of floats; an array of floats is returned itself. Masked values become NaN: not recorded.
fn floats<'py>(
    numpy: &Bound<'py, PyAny>,
    array: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let float64 = numpy.getattr("float64")?;
    let masks = numpy.getattr("ma")?;
    if masks.call_method1("isMaskedArray", (array,))?.is_truthy()? {
        let array = array.call_method1("astype", (float64,))?;
        return array.call_method1("filled", (f64::NAN,));
    }
    let array = numpy.call_method1("asarray", (array,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u") {
        let dtype = array.getattr("dtype")?.str()?;
        let reason = format!("an array of {dtype} contains no numbers; pass floats");
        return Err(PyTypeError::new_err(reason));
    }
    numpy.call_method1("asarray", (array, float64))
}

/// Maximum time in nanoseconds, in the year 2262.
const LAST_NS: f64 = 9.2e18;

/// Rejects invalid times and names the row of the first.
fn check_times(numpy: &Bound<'_, PyAny>, what: &str, ns: &Bound<'_, PyAny>) -> PyResult<()> {
    let within = numpy.call_method1("less_equal", (numpy.call_method1("abs", (ns,))?, LAST_NS))?;
    let invalid = numpy.call_method1(
        "flatnonzero",
        (numpy.call_method1("logical_not", (within,))?,),
    )?;
    if invalid.len()? == 0 {
        return Ok(());
    }
    let row: u64 = invalid.get_item(0)?.extract()?;
    let reason = format!("{what}: invalid time in row {row}; expected at most 9.2e18 ns from 1970");
    Err(Failure::new(reason).into())
}

/// Times in integer nanoseconds, from nanoseconds or seconds.
fn times<'py>(
    numpy: &Bound<'py, PyAny>,
    time_ns: Option<Bound<'py, PyAny>>,
    time_s: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let whole = |array: Bound<'py, PyAny>| -> PyResult<Bound<'py, PyAny>> {
        array.call_method1("astype", (numpy.getattr("int64")?,))
    };
    let array = match (time_ns, time_s) {
        (Some(time_ns), None) => {
            let array = numpy.call_method1("asarray", (time_ns,))?;
            let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
            match kind.as_str() {
                // `datetime64` of any unit.
                "M" => {
                    let missing = numpy
                        .call_method1("flatnonzero", (numpy.call_method1("isnat", (&array,))?,))?;
                    if missing.len()? > 0 {
                        let row: u64 = missing.get_item(0)?.extract()?;
                        let reason = format!("time_ns: row {row} is NaT; every row needs a time");
                        return Err(Failure::new(reason).into());
                    }
                    whole(array.call_method1("astype", ("datetime64[ns]",))?)?
                }
                "u" => {
                    check_times(numpy, "time_ns", &floats(numpy, &array)?)?;
                    whole(array)?
                }
                "i" => numpy.call_method1("asarray", (array, numpy.getattr("int64")?))?,
                _ => {
                    let reason =
                        "time_ns must hold whole numbers or datetime64; give seconds as time_s";
                    return Err(PyTypeError::new_err(reason));
                }
            }
        }
        (None, Some(time_s)) => {
            let ns = floats(numpy, &time_s)?.mul(1e9)?;
            check_times(numpy, "time_s", &ns)?;
            whole(numpy.call_method1("rint", (ns,))?)?
        }
        _ => return Err(PyTypeError::new_err("specify either time_ns or time_s")),
    };
    let array = array.cast_into::<PyArray1<i64>>();
    array.map_err(|_| {
        Failure::new("times must be a one-dimensional array of numbers, one per sample").into()
    })
}

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (path, *, mapping=None, joint_topic=None, motor_topic=None, motor_interface=None, joint_effort=None, gap_s=None))]
    fn new(
        path: Bound<'_, PyAny>,
        mapping: Option<PathBuf>,
        joint_topic: Option<String>,
        motor_topic: Option<String>,
        motor_interface: Option<String>,
        joint_effort: Option<String>,
        gap_s: Option<f64>,
    ) -> PyResult<Self> {
        let opening = Opening {
            mapping,
            joint_topic,
            motor_topic,
            motor_interface,
            joint_effort,
            gap_s,
        };
        let frames = path.py().import("pysinew._frames")?;
        let (path, name, owner): (PathBuf, String, Option<Py<PyAny>>) =
            frames.call_method1("place", (path,))?.extract()?;
        let source = Source::Files(path, owner.map(Arc::new));
        Ok(Self::of(name, source, opening)?)
    }

    /// A recording from arrays, one row per sample: read block by block, never copied completely.
    ///
    /// Columns with names, as those of a data frame, are found by the names of ``joints``, which they may replace. Arrays of
    /// ``float64`` are used directly, with any strides; other types are converted. NaN means "not recorded".
    ///
    /// Parameters
    /// ----------
    /// q, theta
    ///     Joint and motor positions, rad, ``(rows, joints)``.
    /// joints
    ///     Names of the columns.
    /// time_ns, time_s
    ///     Times, ``(rows,)``: whole nanoseconds or ``datetime64``, or seconds.
    /// dq
    ///     Joint velocities, rad/s.
    /// tau_el, tau_m, tau_ext
    ///     Elastic, motor and external torques, N·m.
    /// temperature_c
    ///     Temperature, °C, ``(rows,)``.
    /// segment
    ///     As ``arrays()`` returns it; it follows from the gaps of the times.
    /// name
    ///     Name of the recording in results and messages.
    /// gap_s
    ///     Maximum time between frames of one segment, s.
    ///
    /// Returns
    /// -------
    /// Recording
    ///     The recording.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For arrays of different length or invalid times.
    #[staticmethod]
    #[pyo3(signature = (*, q, theta, joints=None, time_ns=None, time_s=None, dq=None, tau_el=None, tau_m=None, tau_ext=None, temperature_c=None, segment=None, name="arrays", gap_s=None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn from_arrays<'py>(
        py: Python<'py>,
        q: Bound<'py, PyAny>,
        theta: Bound<'py, PyAny>,
        joints: Option<Vec<String>>,
        time_ns: Option<Bound<'py, PyAny>>,
        time_s: Option<Bound<'py, PyAny>>,
        dq: Option<Bound<'py, PyAny>>,
        tau_el: Option<Bound<'py, PyAny>>,
        tau_m: Option<Bound<'py, PyAny>>,
        tau_ext: Option<Bound<'py, PyAny>>,
        temperature_c: Option<Bound<'py, PyAny>>,
        segment: Option<Bound<'py, PyAny>>,
        name: &str,
        gap_s: Option<f64>,
    ) -> PyResult<Self> {
        drop(segment);
        let numpy = py.import("numpy")?.into_any();
        let frames = py.import("pysinew._frames")?;
        let named = PyDict::new(py);
        let given = [Some(q), Some(theta), dq, tau_el, tau_m, tau_ext];
        for (quantity, array) in Quantity::PER_JOINT.into_iter().zip(given) {
            if let Some(array) = array {
                named.set_item(quantity.symbol(), array)?;
            }
        }
        let arranged = frames.call_method1("arranged", (joints, named))?;
        let (joints, index, named): (Vec<String>, Option<Bound<'py, PyAny>>, Bound<'py, PyDict>) =
            arranged.extract()?;
        let time_ns = match &time_s {
            Some(_) => time_ns,
            None => time_ns.or(index),
        };
        let time_ns = time_ns
            .map(|time_ns| frames.call_method1("clock", (time_ns,)))
            .transpose()?;
        let time_ns = times(&numpy, time_ns, time_s)?;
        let mut by_joint = Vec::new();
        for quantity in Quantity::PER_JOINT {
            let Some(array) = named.get_item(quantity.symbol())? else {
                continue;
            };
            let array = floats(&numpy, &array)?.cast_into::<PyArray2<f64>>();
            let array = array.map_err(|_| {
                let symbol = quantity.symbol();
                Failure::new(format!(
                    "{symbol} must have rows and columns: (instants, joints)"
                ))
            })?;
            by_joint.push((quantity, array));
        }
        let temperature_c = match temperature_c {
            None => None,
            Some(array) => {
                let array = floats(&numpy, &array)?.cast_into::<PyArray1<f64>>();
                let reason = "temperature_c must be one row of numbers, one per instant";
                Some(array.map_err(|_| Failure::new(reason))?)
            }
        };
        let held = Held::new(joints, &time_ns, by_joint, temperature_c)?;
        let opening = Opening {
            gap_s,
            ..Opening::default()
        };
        let source = Source::Arrays(Arc::new(held));
        Ok(Self::of(name.to_owned(), source, opening)?)
    }

    /// A recording from messages of ROS 2. The iterator is read to its end; only messages of joints are kept.
    ///
    /// Parameters
    /// ----------
    /// messages
    ///     Results of ``reader.messages()`` of the package ``rosbags``, or tuples of topic, type, time (ns) and bytes.
    /// name
    ///     Name of the recording in results and messages.
    /// mapping, joint_topic, motor_topic, motor_interface, joint_effort, gap_s
    ///     As for a file.
    ///
    /// Returns
    /// -------
    /// Recording
    ///     The recording. It cannot be pickled.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For an invalid message.
    #[staticmethod]
    #[pyo3(signature = (messages, *, name="messages", mapping=None, joint_topic=None, motor_topic=None, motor_interface=None, joint_effort=None, gap_s=None))]
    #[expect(clippy::too_many_arguments, reason = "they have names in Python")]
    fn from_messages(
        py: Python<'_>,
        messages: &Bound<'_, PyAny>,
        name: &str,
        mapping: Option<PathBuf>,
        joint_topic: Option<String>,
        motor_topic: Option<String>,
        motor_interface: Option<String>,
        joint_effort: Option<String>,
        gap_s: Option<f64>,
    ) -> PyResult<Self> {
        let opening = Opening {
            mapping,
            joint_topic,
            motor_topic,
            motor_interface,
            joint_effort,
            gap_s,
        };
        let mut given = GivenMessages::default();
        for (i, item) in PyIterator::from_object(messages)?.enumerate() {
            let (topic, kind, time_ns, data) = message(&item?)?;
            given
                .push(&topic, &kind, time_ns, &data)
                .map_err(Failure::from)?;
            // Reading of a long bag can be interrupted.
            if i.is_multiple_of(4096) {
                py.check_signals()?;
            }
        }
        let source = Source::Messages(Arc::new(given));
        Ok(Self::of(name.to_owned(), source, opening)?)
    }

    /// Name of the recording.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Format of the recording: `mcap`, `csv`, `parquet`, `db3`, `numpy`, `arrays` or `messages`.
    #[getter]
    fn format(&self) -> PyResult<String> {
        let json = serde_json::to_value(self.format).map_err(Failure::from)?;
        Ok(json.as_str().unwrap_or_default().to_owned())
    }

    /// Names of the joints, in the recording's order.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.joints.clone()
    }

    /// Quantities recorded of every joint.
    #[getter]
    fn channels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let out = PyDict::new(py);
        for (joint, has) in self.joints.iter().zip(&self.channels.joints) {
            let symbols: Vec<&str> = has.iter().map(Quantity::symbol).collect();
            out.set_item(joint, symbols)?;
        }
        Ok(out)
    }

    /// The robot's URDF, if it is recorded.
    #[getter]
    fn robot_description(&self) -> Option<&str> {
        self.description.as_deref()
    }

    /// Reads the recording completely and reports its content and losses.
    #[pyo3(name = "_info", signature = (*, progress=None))]
    fn info(&self, py: Python<'_>, progress: Option<Bound<'_, PyAny>>) -> PyResult<Document> {
        let (opener, options, name) = (self.opener(), self.options.clone(), self.name.clone());
        let files = match &self.source {
            Source::Files(path, _) => Some(path.clone()),
            _ => None,
        };
        let info = work(py, "reading", progress.as_ref(), move |tracker| {
            let mut at = |at: sinew_log::Progress| {
                tracker.at(at.bytes_done as f64, at.bytes_total as f64);
            };
            Ok(match files {
                Some(path) => RecordingInfo::of_files(&[path], &options, &mut at)?,
                None => RecordingInfo::of(&mut opener(&options)?, &name, &mut at)?,
            })
        })?;
        let is_lossy = info.lossy;
        Ok(Shown::new(info, sinew_report::log::render)
            .lossy(is_lossy)
            .into())
    }

    /// All frames as NumPy arrays by name.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Names of the joints; the default is all.
    /// progress
    ///     Called with the completed share and the step.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``time_ns`` ``(rows,)``; ``q``, ``theta`` and other recorded quantities ``(rows, joints)``, rad, rad/s and N·m.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For an invalid recording or an unknown joint.
    #[pyo3(signature = (*, joints=None, progress=None))]
    fn arrays<'py>(
        &self,
        py: Python<'py>,
        joints: Option<Vec<String>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (joints, columns) = self.columns(py, joints, progress.as_ref())?;
        columns.arrays(py, &joints)
    }

    /// All frames as a table, with the columns of a CSV recording.
    ///
    /// Parameters
    /// ----------
    /// joints
    ///     Names of the joints; the default is all.
    /// progress
    ///     Called with the completed share and the step.
    ///
    /// Returns
    /// -------
    /// Table
    ///     A row per frame.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     For an invalid recording or an unknown joint.
    #[pyo3(signature = (*, joints=None, progress=None))]
    fn table(
        &self,
        py: Python<'_>,
        joints: Option<Vec<String>>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Table> {
        let (joints, columns) = self.columns(py, joints, progress.as_ref())?;
        let mut out: Vec<(String, ArrayRef)> = vec![
            (
                "time_ns".into(),
                Arc::new(Int64Array::from(columns.time_ns)),
            ),
            (
                "segment".into(),
                Arc::new(Int64Array::from_iter_values(
                    columns.segment.into_iter().map(i64::from),
                )),
            ),
        ];
        for (quantity, values) in &columns.by_joint {
            for (i, joint) in joints.iter().enumerate() {
                let column = values.iter().skip(i).step_by(joints.len().max(1)).copied();
                let name = format!("{}.{joint}{}", quantity.symbol(), quantity.suffix());
                out.push((name, Arc::new(Float64Array::from_iter_values(column))));
            }
        }
        if let Some(values) = columns.temperature_c {
            out.push(("temperature_c".into(), Arc::new(Float64Array::from(values))));
        }
        Ok(Table::new(out)?)
    }

    /// The frames as an Arrow C stream.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let table = Bound::new(py, self.table(py, None, None)?)?;
        table.call_method1("__arrow_c_stream__", (requested_schema,))
    }

    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        if std::ptr::eq(self, other) {
            return Ok(true);
        }
        if self.joints != other.joints || self.channels != other.channels {
            return Ok(false);
        }
        let openers = [self, other].map(|own| (own.opener(), own.options.clone()));
        let quantities = self.channels.union();
        work(py, "reading", None, move |_| {
            let [(one, with), (other, other_with)] = openers;
            let (mut one, mut other) = (one(&with)?, other(&other_with)?);
            Ok(same_frames(&mut one, &mut other, quantities)?)
        })
    }

    fn __hash__(&self) -> u64 {
        hash_of(&self.joints.join("\n"))
    }

    /// A file is pickled by its path, and content or arrays by their values.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, Bound<'py, PyTuple>>> {
        let frames = py.import("pysinew._frames")?;
        let keywords = self.opening.keywords(py)?;
        let place = match &self.source {
            Source::Files(path, None) => path.into_pyobject(py)?.into_any(),
            Source::Files(path, Some(_)) => {
                let content = std::fs::read(path).map_err(|e| Failure::new(e.to_string()))?;
                PyBytes::new(py, &content).into_any()
            }
            Source::Arrays(held) => held.arrays(py)?.into_any(),
            Source::Messages(_) => {
                let reason = "a recording of messages cannot be pickled: pickle its arrays() or the messages";
                return Err(PyTypeError::new_err(reason));
            }
        };
        let parts = (place, &self.name, keywords).into_pyobject(py)?;
        Ok((frames.getattr("restored")?, parts))
    }

    fn __repr__(&self) -> PyResult<String> {
        let (name, format) = (&self.name, self.format()?);
        Ok(format!(
            "<pysinew.Recording '{name}' ({format}): {}>",
            self.joints.join(", ")
        ))
    }
}
