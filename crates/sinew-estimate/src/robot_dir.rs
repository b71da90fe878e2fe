//! A robot's folder: `robot.toml` and the URDF it names.

use sinew_files::{Located, limits, names, read_text};
use sinew_model::arm::JointKind;
use sinew_model::robot::{Robot, RobotFile};
use sinew_model::transmission::{Tendon, Transmission};
use sinew_rope::task::Drive;
use std::path::{Path, PathBuf};

/// A robot and where it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedRobot {
    /// The robot.
    pub robot: Robot,
    /// `robot.toml` as opened.
    pub file: PathBuf,
    /// Its text.
    pub file_text: String,
    /// Where the URDF came from, in words.
    pub urdf: String,
    /// Text of the URDF.
    pub urdf_text: String,
}

impl LoadedRobot {
    /// The tendon of a joint.
    ///
    /// # Errors
    /// [`RobotDirError::NoJoint`], [`RobotDirError::NoTendon`].
    pub fn tendon(&self, joint: &str) -> Result<&Tendon, RobotDirError> {
        Ok(self.tendon_drive(joint)?.1)
    }

    /// What holds a joint that has a tendon.
    ///
    /// # Errors
    /// [`RobotDirError::NoJoint`], [`RobotDirError::NoTendon`].
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

    /// The transmission of a joint that has a tendon, and the tendon.
    fn tendon_drive(&self, joint: &str) -> Result<(&Transmission, &Tendon), RobotDirError> {
        let names = self.robot.tendon_names();
        let Some(i) = names.iter().position(|n| n == joint) else {
            return Err(RobotDirError::NoJoint {
                path: self.file.clone(),
                joint: joint.to_owned(),
                known: names.join(", "),
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

/// Why a robot could not be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotDirError {
    /// No robot was named and none lies where one is looked for.
    #[error(
        "no robot.toml beside the recording nor in the current folder; name the robot's folder with --robot DIR (it holds robot.toml with stiffness_nm_per_rad per joint; robots/biorob-like is an example)"
    )]
    NotFound,
    /// A URDF stands where `robot.toml` belongs.
    #[error(
        "{path} is a URDF, which knows no stiffness; name the folder of robot.toml instead: {cure}", path = path.display()
    )]
    Urdf {
        /// The URDF.
        path: PathBuf,
        /// Which folder, or how to get one.
        cure: String,
    },
    /// Neither the robot's folder nor the recording has a URDF.
    #[error(
        "{path} names no urdf and the recording has no /robot_description; add urdf = \"NAME.urdf\"", path = path.display()
    )]
    NoUrdf {
        /// `robot.toml`.
        path: PathBuf,
    },
    /// A joint that the robot hasn't.
    #[error("{path}: no joint '{joint}'; it has {known}{hint}", path = path.display())]
    NoJoint {
        /// `robot.toml`.
        path: PathBuf,
        /// Joint asked for.
        joint: String,
        /// Joints there are.
        known: String,
        /// The one that may have been meant, as the end of a sentence.
        hint: String,
    },
    /// A joint without a tendon.
    #[error("{path}: joint '{joint}' has no tendon; add [joints.{joint}.tendon]", path = path.display())]
    NoTendon {
        /// `robot.toml`.
        path: PathBuf,
        /// The joint.
        joint: String,
    },
    /// The description, with the place of what is wrong.
    #[error(transparent)]
    File(#[from] Located),
}

/// Loads a robot from `place` (its folder, or `robot.toml` itself).
///
/// `description` is the recording's own URDF; it is used where `robot.toml` names none.
///
/// # Errors
/// [`RobotDirError`].
pub fn load(place: &Path, description: Option<&str>) -> Result<LoadedRobot, RobotDirError> {
    let (loaded, gaps) = draft(place, description)?;
    gaps.into_iter()
        .next()
        .map_or(Ok(loaded), |gap| Err(gap.into()))
}

/// Loads a robot as far as its folder describes it, with what keeps it from being used
/// ([`RobotFile::draft`]).
///
/// # Errors
/// As [`load`], less the gaps.
pub fn draft(
    place: &Path,
    description: Option<&str>,
) -> Result<(LoadedRobot, Vec<Located>), RobotDirError> {
    let file = if place.is_dir() {
        place.join("robot.toml")
    } else {
        place.to_path_buf()
    };
    let file_text = read_text(&file, &limits::DESCRIPTION)?;
    if file_text.trim_start().starts_with('<') {
        return Err(urdf_as_robot(file));
    }
    let parsed = RobotFile::parse(&file_text, &file.display().to_string())?;
    let (urdf_text, urdf) = match (parsed.urdf(), description) {
        (Some(name), _) => {
            let path = file.parent().unwrap_or(Path::new("")).join(name);
            (
                read_text(&path, &limits::DESCRIPTION)?,
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

/// What to say where a URDF was named as the robot.
fn urdf_as_robot(path: PathBuf) -> RobotDirError {
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    let cure = match folder.join("robot.toml").is_file() {
        true => folder.display().to_string(),
        false => format!("sinew init {} writes one", path.display()),
    };
    RobotDirError::Urdf { path, cure }
}

/// Where a robot is looked for when none is named: beside the recording, then here.
///
/// # Errors
/// [`RobotDirError::NotFound`].
pub fn find(log: &Path) -> Result<PathBuf, RobotDirError> {
    let beside = log.parent().unwrap_or(Path::new("")).join("robot.toml");
    [beside, PathBuf::from("robot.toml")]
        .into_iter()
        .find(|p| p.is_file())
        .ok_or(RobotDirError::NotFound)
}
