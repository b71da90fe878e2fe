//! Conversion of Rust errors to exceptions, with the same message and the location, if any.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use sinew_creep::{CreepError, TestFileError};
use sinew_estimate::EstimateError;
use sinew_estimate::excitation::ExcitationError;
use sinew_estimate::robot_dir::RobotDirError;
use sinew_estimate::session::SessionError;
use sinew_files::located::Place;
use sinew_files::{Located, OutputError};
use sinew_log::LogError;
use sinew_rope::CatalogueError;
use sinew_rope::predict::PredictError;
use sinew_rope::task::TaskError;
use sinew_sim::SimulateError;
use sinew_sim::protocol::PlanError;
use sinew_trend::{AnalyzeError, RecordError};
use std::error::Error;

/// Error of an operation, before its conversion to a Python exception.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Error with a message only.
    Message(String),
    /// Error with file, line and column.
    Located(Located),
    /// Exception raised by Python code.
    Python(PyErr),
}

impl Failure {
    /// Creates an error with a message.
    pub(crate) fn new(reason: impl Into<String>) -> Self {
        Self::Message(reason.into())
    }
}

/// Error with an optional location in a file.
pub(crate) trait Blame: Error {
    /// Location of the error, if any.
    fn located(&self) -> Option<&Located> {
        None
    }
}

impl Blame for Located {
    fn located(&self) -> Option<&Located> {
        Some(self)
    }
}

impl Blame for LogError {
    fn located(&self) -> Option<&Located> {
        match self {
            Self::File(located) => Some(located),
            _ => None,
        }
    }
}

impl Blame for TestFileError {
    fn located(&self) -> Option<&Located> {
        match self {
            Self::File(located) => Some(located),
            _ => None,
        }
    }
}

impl Blame for RobotDirError {
    fn located(&self) -> Option<&Located> {
        match self {
            Self::File(located) => Some(located),
            _ => None,
        }
    }
}

impl Blame for EstimateError {
    fn located(&self) -> Option<&Located> {
        match self {
            Self::Log(error) => error.located(),
            Self::Robot(error) => error.located(),
            _ => None,
        }
    }
}

impl Blame for SessionError {
    fn located(&self) -> Option<&Located> {
        match self {
            Self::Estimate(error) => error.located(),
            _ => None,
        }
    }
}

impl Blame for RecordError {
    fn located(&self) -> Option<&Located> {
        match self {
            Self::File(located) => Some(located),
            _ => None,
        }
    }
}

impl Blame for SimulateError {
    fn located(&self) -> Option<&Located> {
        match self {
            Self::File(located) => Some(located),
            _ => None,
        }
    }
}

impl Blame for CatalogueError {
    fn located(&self) -> Option<&Located> {
        match self {
            Self::File(located) => Some(located),
            _ => None,
        }
    }
}

impl Blame for AnalyzeError {}
impl Blame for CreepError {}
impl Blame for ExcitationError {}
impl Blame for OutputError {}
impl Blame for PredictError {}
impl Blame for PlanError {}
impl Blame for TaskError {}
impl Blame for serde_json::Error {}
impl Blame for sinew_creep::NoEntry {}
impl Blame for sinew_estimate::session::stated::StatedError {}
impl Blame for sinew_creep::OutOfRange {}
impl Blame for sinew_model::StepError {}
impl Blame for sinew_model::offset::OffsetConfigError {}
impl Blame for sinew_rope::law::LoadError {}

impl<E: Blame> From<E> for Failure {
    fn from(error: E) -> Self {
        match error.located() {
            Some(located) => Self::Located(located.clone()),
            None => Self::Message(error.to_string()),
        }
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Python(error) => error,
            Failure::Message(reason) => Python::attach(|py| match class(py, "SinewError") {
                Ok(class) => PyErr::from_type(class.clone(), reason),
                Err(error) => error,
            }),
            Failure::Located(located) => {
                Python::attach(|py| located_error(py, &located).unwrap_or_else(|e| e))
            }
        }
    }
}

/// A `LocatedError` with its parts.
fn located_error(py: Python<'_>, located: &Located) -> PyResult<PyErr> {
    let parts = PyDict::new(py);
    parts.set_item("file", &located.file)?;
    parts.set_item("line", located.line)?;
    parts.set_item(
        "place",
        match &located.place {
            Place::Whole => None,
            Place::Key(at) | Place::Column(at) | Place::Element(at) => Some(at),
        },
    )?;
    parts.set_item("value", &located.value)?;
    parts.set_item("unit", located.unit)?;
    parts.set_item("problem", &located.problem)?;
    parts.set_item("cure", &located.cure)?;
    let class = class(py, "LocatedError")?;
    let error = class.call((located.to_string(),), Some(&parts))?;
    Ok(PyErr::from_value(error))
}

/// A class of `pysinew._errors`.
fn class<'py>(py: Python<'py>, name: &'static str) -> PyResult<&'py Bound<'py, PyType>> {
    static REFUSED: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    static LOCATED: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let place = match name {
        "LocatedError" => &LOCATED,
        _ => &REFUSED,
    };
    place.import(py, "pysinew._errors", name)
}
