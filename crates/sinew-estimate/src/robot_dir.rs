//! Folder of a robot: `robot.toml` and its URDF.

use sinew_files::{Budget, Located, names, read_text};
use sinew_model::arm::JointKind;
use sinew_model::robot::{Robot, RobotFile};
use sinew_model::transmission::{Tendon, Transmission};
use sinew_rope::task::Drive;
use std::path::{Path, PathBuf};

/// Robot and the files from which it was loaded.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedRobot {
    /// Robot model and transmissions.
    pub robot: Robot,
    /// Path of `robot.toml`.
    pub file: PathBuf,
    /// Text of `robot.toml`.
    pub file_text: String,
    /// Source of the URDF: its path, or the recording's `/robot_description`.
    pub urdf: String,
    /// Text of the URDF.
    pub urdf_text: String,
}

impl LoadedRobot {
    /// Returns the tendon of a joint.
    ///
    /// # Errors
    /// Returns [`RobotDirError::NoJoint`] for an unknown name and [`RobotDirError::NoTendon`] for a joint without
    /// tendon.
    pub fn tendon(&self, joint: &str) -> Result<&Tendon, RobotDirError> {
        Ok(self.tendon_drive(joint)?.1)
    }

    /// Returns the drive of a joint that has a tendon.
    ///
    /// # Errors
    /// Returns [`RobotDirError::NoJoint`] for an unknown name and [`RobotDirError::NoTendon`] for a joint without
    /// tendon.
    pub fn drive(&self, joint: &str) -> Result<Drive, RobotDirError> {
        let (transmission, tendon) = self.tendon_drive(joint)?;
        let kind = self.robot.tendon_index(joint);
        let kind = kind.and_then(|i| self.robot.arm.joint_kind(i));
        Ok(Drive {
            stiffness_nm_per_rad: transmission.stiffness_nm_per_rad,
            tendon: tendon.clone(),
            slides: kind == Some(JointKind::Prismatic),
        })
    }

    /// Returns the transmission and the tendon of a joint that has a tendon.
    fn tendon_drive(&self, joint: &str) -> Result<(&Transmission, &Tendon), RobotDirError> {
        let names = self.robot.tendon_names();
        let Some(i) = names.iter().position(|n| n == joint) else {
            return Err(RobotDirError::NoJoint {
                path: self.file.clone(),
                joint: joint.to_owned(),
                available: names.join(", "),
                hint: names::did_you_mean(joint, &names),
            });
        };
        let transmission = self.robot.transmissions[i].as_ref();
        transmission
            .and_then(|t| Some((t, t.tendon.as_ref()?)))
            .ok_or_else(|| RobotDirError::NoTendon {
                path: self.file.clone(),
                joint: joint.to_owned(),
            })
    }
}

/// Error of loading a robot.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotDirError {
    /// No robot was specified and none was found in the searched folders.
    #[error(
        "robot.toml not found next to the recording or in the current folder; specify the robot's folder with --robot DIR (it contains robot.toml with stiffness_nm_per_rad per joint; example: robots/biorob-like)"
    )]
    NotFound,
    /// A URDF was specified instead of `robot.toml`.
    #[error(
        "{path} is a URDF, which contains no stiffness; specify the folder of robot.toml instead: {cure}", path = path.display()
    )]
    Urdf {
        /// Path of the URDF.
        path: PathBuf,
        /// Folder of robot.toml, or the command that creates one.
        cure: String,
    },
    /// Neither the robot's folder nor the recording has a URDF.
    #[error(
        "{path}: key urdf is missing and the recording has no /robot_description; add urdf = \"NAME.urdf\"", path = path.display()
    )]
    NoUrdf {
        /// Path of `robot.toml`.
        path: PathBuf,
    },
    /// The robot has no joint of this name.
    #[error("{path}: joint '{joint}' not found; available: {available}{hint}", path = path.display())]
    NoJoint {
        /// Path of `robot.toml`.
        path: PathBuf,
        /// Name of the requested joint.
        joint: String,
        /// Names of the available joints.
        available: String,
        /// Suggestion of a similar name, as the end of a sentence.
        hint: String,
    },
    /// The joint has no tendon.
    #[error("{path}: joint '{joint}' has no tendon; add [joints.{joint}.tendon]", path = path.display())]
    NoTendon {
        /// Path of `robot.toml`.
        path: PathBuf,
        /// Name of the joint.
        joint: String,
    },
    /// The description is invalid, with the location of the fault.
    #[error(transparent)]
    File(#[from] Located),
}

/// Loads a robot from `place` (its folder, or `robot.toml` itself).
///
/// `description` is the URDF of the recording; it is used if `robot.toml` names none.
///
/// # Errors
/// Returns [`RobotDirError`] if a file cannot be read, the description is invalid or a value is missing.
pub fn load(place: &Path, description: Option<&str>) -> Result<LoadedRobot, RobotDirError> {
    let (loaded, gaps) = draft(place, description)?;
    gaps.into_iter()
        .next()
        .map_or(Ok(loaded), |gap| Err(gap.into()))
}

/// Loads a robot as far as its folder describes it, with the gaps that prevent its use
/// ([`RobotFile::draft`]).
///
/// # Errors
/// Returns the errors of [`load`], except for gaps.
pub fn draft(
    place: &Path,
    description: Option<&str>,
) -> Result<(LoadedRobot, Vec<Located>), RobotDirError> {
    let file = if place.is_dir() {
        place.join("robot.toml")
    } else {
        place.to_path_buf()
    };
    let file_text = read_text(&file, &Budget::DESCRIPTION)?;
    if file_text.trim_start().starts_with('<') {
        return Err(urdf_as_robot(file));
    }
    let mut parsed = RobotFile::parse(&file_text, &file.display().to_string())?;
    let in_folder = |name: &str| file.parent().unwrap_or(Path::new("")).join(name);
    let tables: Vec<String> = parsed.tables().into_iter().map(str::to_owned).collect();
    for name in tables {
        let path = in_folder(&name);
        let text = read_text(&path, &Budget::DESCRIPTION)?;
        parsed = parsed.with_table(&name, &path.display().to_string(), &text)?;
    }
    let (urdf_text, urdf) = match (parsed.urdf(), description) {
        (Some(name), _) => {
            let path = in_folder(name);
            (
                read_text(&path, &Budget::DESCRIPTION)?,
                path.display().to_string(),
            )
        }
        (None, Some(text)) => (
            text.to_string(),
            "the recording's /robot_description".into(),
        ),
        (None, None) => return Err(RobotDirError::NoUrdf { path: file }),
    };
    let (robot, gaps) = parsed.draft(&urdf_text)?;
    let loaded = LoadedRobot {
        robot,
        file,
        file_text,
        urdf,
        urdf_text,
    };
    Ok((loaded, gaps))
}

/// Creates the error for a URDF that was specified as the robot.
fn urdf_as_robot(path: PathBuf) -> RobotDirError {
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    let cure = match folder.join("robot.toml").is_file() {
        true => folder.display().to_string(),
        false => format!("sinew init {} creates one", path.display()),
    };
    RobotDirError::Urdf { path, cure }
}

/// Searches robot.toml in the folder of the recording, then in the current folder.
///
/// # Errors
/// Returns [`RobotDirError::NotFound`] if neither folder contains robot.toml.
pub fn find(log: &Path) -> Result<PathBuf, RobotDirError> {
    let with_log = log.parent().unwrap_or(Path::new("")).join("robot.toml");
    [with_log, PathBuf::from("robot.toml")]
        .into_iter()
        .find(|p| p.is_file())
        .ok_or(RobotDirError::NotFound)
}
