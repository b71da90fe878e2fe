//! Robot from a folder or from texts: properties, checks and dynamics.

use crate::document::{Document, Shown};
use crate::failure::Failure;
use crate::table::Reduced;
use numpy::{
    AllowTypeChange, PyArray1, PyArrayDyn, PyArrayLikeDyn, PyArrayMethods, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use sinew_estimate::robot_check::RobotCheck;
use sinew_estimate::robot_dir::{self, LoadedRobot};
use sinew_files::{Budget, read_text};
use sinew_log::Mapping;
use sinew_model::arm::ArmWorkspace;
use sinew_model::robot::RobotFile;
use sinew_model::transmission::Tendon;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::PathBuf;
use std::sync::Arc;

/// Floats of any shape; lists and other numbers are converted.
pub(crate) type Floats<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;

/// A robot: joints, masses, stiffness, tendons.
///
/// Parameters
/// ----------
/// place
///     Folder of the robot, or the path of ``robot.toml``.
///
/// Raises
/// ------
/// LocatedError
///     For an invalid description, with its line.
#[pyclass(frozen, module = "pysinew._core")]
pub(crate) struct Robot(Arc<LoadedRobot>);

/// Robot, or the path of one.
#[derive(FromPyObject)]
pub(crate) enum RobotArg<'py> {
    #[pyo3(annotation = "Robot")]
    Loaded(Bound<'py, Robot>),
    #[pyo3(annotation = "path")]
    Place(PathBuf),
}

impl RobotArg<'_> {
    /// Loads the robot and keeps it.
    pub(crate) fn load(&self) -> Result<Arc<LoadedRobot>, Failure> {
        Ok(match self {
            Self::Loaded(robot) => robot.get().loaded().clone(),
            Self::Place(place) => Arc::new(robot_dir::load(place, None)?),
        })
    }
}

impl Robot {
    pub(crate) fn loaded(&self) -> &Arc<LoadedRobot> {
        &self.0
    }

    fn tendon(&self, joint: &str) -> Result<&Tendon, Failure> {
        Ok(self.0.tendon(joint)?)
    }
}

/// Hash of a text, equal for equal texts.
pub(crate) fn hash_of(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

/// Three arrays of the shape of `q`.
type Terms<'py> = (
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
    Bound<'py, PyArrayDyn<f64>>,
);

#[pymethods]
impl Robot {
    #[new]
    fn new(place: PathBuf) -> PyResult<Self> {
        let loaded = robot_dir::load(&place, None).map_err(Failure::from)?;
        Ok(Self(Arc::new(loaded)))
    }

    /// A robot of the texts of its description.
    ///
    /// Parameters
    /// ----------
    /// robot_toml
    ///     Text of ``robot.toml``.
    /// urdf
    ///     Text of the URDF that it belongs to.
    /// file
    ///     Name of the description in messages.
    ///
    /// Returns
    /// -------
    /// Robot
    ///     The robot.
    ///
    /// Raises
    /// ------
    /// LocatedError
    ///     For an invalid text, with its line.
    #[staticmethod]
    #[pyo3(signature = (robot_toml, urdf, *, file="robot.toml"))]
    fn from_text(robot_toml: &str, urdf: &str, file: &str) -> PyResult<Self> {
        let parsed = RobotFile::parse(robot_toml, file).map_err(Failure::from)?;
        let robot = parsed.build(urdf).map_err(Failure::from)?;
        Ok(Self(Arc::new(LoadedRobot {
            robot,
            file: file.into(),
            file_text: robot_toml.into(),
            urdf: parsed.urdf().unwrap_or("given as text").into(),
            urdf_text: urdf.into(),
        })))
    }

    /// Whether both descriptions are the same, wherever they lie.
    fn __eq__(&self, other: &Self) -> bool {
        self.0.file_text == other.0.file_text && self.0.urdf_text == other.0.urdf_text
    }

    fn __hash__(&self) -> u64 {
        hash_of(&self.0.file_text)
    }

    #[staticmethod]
    #[pyo3(name = "_restore")]
    fn restore(robot_toml: &str, urdf: &str, file: &str) -> PyResult<Self> {
        Self::from_text(robot_toml, urdf, file)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, Bound<'py, PyTuple>>> {
        let class = py.get_type::<Self>();
        let file = self.0.file.display().to_string();
        let parsed = RobotFile::parse(&self.0.file_text, &file).map_err(Failure::from)?;
        // Tables of their own files are read again.
        if !parsed.tables().is_empty() {
            return Ok((class.into_any(), PyTuple::new(py, [file])?));
        }
        let parts = [self.0.file_text.clone(), self.0.urdf_text.clone(), file];
        Ok((class.getattr("_restore")?, PyTuple::new(py, parts)?))
    }

    /// Name of the robot.
    #[getter]
    fn name(&self) -> &str {
        &self.0.robot.name
    }

    /// Names of the joints, in the order of `q`.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.0.robot.joint_names().to_vec()
    }

    /// Names of the tendons of the joints, in the order of `q`: the names of the joints, unless `robot.toml` has
    /// `[[tendons]]`.
    #[getter]
    fn tendons(&self) -> Vec<String> {
        self.0.robot.tendon_names()
    }

    /// Names of the motors of these tendons, in the order of `q`. Positions and torques of a separately named motor
    /// refer to its shaft.
    #[getter]
    fn motors(&self) -> Vec<String> {
        self.0.robot.motor_names()
    }

    /// Path of `robot.toml`.
    #[getter]
    fn file(&self) -> PathBuf {
        self.0.file.clone()
    }

    /// Text of `robot.toml`.
    #[getter]
    fn robot_toml(&self) -> &str {
        &self.0.file_text
    }

    /// Text of the URDF.
    #[getter]
    // The property `urdf` of Python is the text.
    #[allow(clippy::misnamed_getters)]
    fn urdf(&self) -> &str {
        &self.0.urdf_text
    }

    /// Warnings about implausible values of the description.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.robot.warnings.clone()
    }

    /// Stiffness of every joint, `(n,)`, N·m/rad; NaN of a rigid one.
    #[getter]
    fn stiffness_nm_per_rad<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let all = self.0.robot.transmissions.iter();
        let stiffness = all.map(|t| t.as_ref().map_or(f64::NAN, |t| t.stiffness_nm_per_rad));
        PyArray1::from_iter(py, stiffness)
    }

    /// Name of the rope of a joint's tendon.
    ///
    /// Parameters
    /// ----------
    /// joint
    ///     Name of the joint.
    ///
    /// Returns
    /// -------
    /// str or None
    ///     ``None`` where ``robot.toml`` names no rope.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     Where no such joint has a tendon.
    fn rope(&self, joint: &str) -> PyResult<Option<String>> {
        Ok(self.tendon(joint)?.rope.clone())
    }

    /// Elongation of a joint's tendon for an offset: `ΔL = r · offset`.
    ///
    /// Parameters
    /// ----------
    /// joint
    ///     Name of the joint.
    /// offset_rad
    ///     Offset, rad.
    ///
    /// Returns
    /// -------
    /// float
    ///     Elongation, m.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     Where no such joint has a tendon.
    fn elongation_m(&self, joint: &str, offset_rad: f64) -> PyResult<f64> {
        Ok(self.tendon(joint)?.elongation_m(offset_rad))
    }

    /// Strain of a joint's tendon for an offset: `ε = ΔL / L`.
    ///
    /// Parameters
    /// ----------
    /// joint
    ///     Name of the joint.
    /// offset_rad
    ///     Offset, rad.
    ///
    /// Returns
    /// -------
    /// float
    ///     Strain, m/m.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     Where no such joint has a tendon.
    fn strain(&self, joint: &str, offset_rad: f64) -> PyResult<f64> {
        Ok(self.tendon(joint)?.strain(offset_rad))
    }

    /// Momentum terms of the arm: `p = M(q) dq`, `C(q, dq)ᵀ dq` and `g(q)`.
    ///
    /// Parameters
    /// ----------
    /// q, dq
    ///     Joint positions, rad, and velocities, rad/s, ``(n,)`` or ``(..., n)``.
    ///
    /// Returns
    /// -------
    /// tuple of numpy.ndarray
    ///     Three arrays of that shape: kg·m²/s, N·m, N·m.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     Where the shapes differ or do not end in the number of joints.
    fn momentum<'py>(
        &self,
        py: Python<'py>,
        q: Floats<'py>,
        dq: Floats<'py>,
    ) -> PyResult<Terms<'py>> {
        let arm = &self.0.robot.arm;
        let shape = q.shape().to_vec();
        let n = arm.dof();
        if shape.last() != Some(&n) || shape != dq.shape() {
            let (q, dq) = (&shape, dq.shape());
            return Err(Failure::new(format!(
                "q has the shape {q:?} and dq {dq:?}; both must be equal and end in {n}, the number of joints"
            ))
            .into());
        }
        let (q, dq) = (q.as_array(), dq.as_array());
        let q: Vec<f64> = q.iter().copied().collect();
        let dq: Vec<f64> = dq.iter().copied().collect();
        let (mut p, mut ct_dq, mut g) = (Vec::new(), Vec::new(), Vec::new());
        let mut workspace = ArmWorkspace::new(arm);
        for (q, dq) in q.chunks_exact(n.max(1)).zip(dq.chunks_exact(n.max(1))) {
            let terms = arm.momentum(&mut workspace, q, dq).map_err(Failure::from)?;
            p.extend_from_slice(terms.p);
            ct_dq.extend_from_slice(terms.ct_dq);
            g.extend_from_slice(terms.g);
        }
        let shaped = |values: Vec<f64>| PyArray1::from_vec(py, values).reshape(&shape[..]);
        Ok((shaped(p)?, shaped(ct_dq)?, shaped(g)?))
    }

    /// Checks the description for implausible values; `ropes`: folders with additional ropes.
    #[pyo3(name = "_check", signature = (*, mapping=None, ropes=Vec::new()))]
    fn check(&self, mapping: Option<PathBuf>, ropes: Vec<PathBuf>) -> PyResult<Document> {
        let catalogue = crate::catalogue::with_folders(&ropes)?;
        let check = RobotCheck::of(&self.0, &[], &catalogue);
        let mut check = check.map_err(Failure::from)?;
        if let Some(file) = mapping {
            Mapping::read(&file).map_err(Failure::from)?;
            let text = read_text(&file, &Budget::SETTINGS).map_err(Failure::from)?;
            let name = file.display().to_string();
            check.add_mapping(&text, &name).map_err(Failure::from)?;
        }
        let is_lossy = check.worst().is_some();
        Ok(Shown::new(check, sinew_report::robot::render)
            .lossy(is_lossy)
            .into())
    }

    fn __repr__(&self) -> String {
        format!(
            "<pysinew.Robot '{}': {}>",
            self.name(),
            self.joints().join(", ")
        )
    }
}
