//! The baseline file.

use super::blocks::AbsoluteError;
use crate::output::{OutputError, write_file};
use serde::{Deserialize, Serialize};
use sinew_model::offset::Nuisance;
use std::path::Path;

/// What a recording after tensioning taught: JSON, versioned, a few hundred kilobytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// Always "sinew-baseline".
    pub format: String,
    /// Version of this format.
    pub version: u32,
    /// Name of the robot.
    pub robot: String,
    /// Its joints, in order.
    pub joints: Vec<String>,
    /// Nominal stiffness the baseline was learned with, N·m/rad; 0 for rigid joints.
    pub stiffness_nm_per_rad: Vec<f64>,
    /// Recording it was learned from.
    pub recording: String,
    /// Temperature the offsets refer to, °C.
    pub temperature_c: Option<f64>,
    /// Means of the nuisance parameters.
    pub mean: Vec<f64>,
    /// Lower triangle of their covariance, row by row.
    pub covariance_lower: Vec<f64>,
}

impl Baseline {
    const FORMAT: &'static str = "sinew-baseline";
    const VERSION: u32 = 1;

    pub(super) fn new(
        robot: &sinew_model::robot::Robot,
        recording: String,
        nuisance: &Nuisance,
    ) -> Self {
        let d = nuisance.mean.len();
        let lower = (0..d)
            .flat_map(|i| nuisance.covariance[i * d..=i * d + i].iter().copied())
            .collect();
        Self {
            format: Self::FORMAT.into(),
            version: Self::VERSION,
            robot: robot.name.clone(),
            joints: robot.joint_names().to_vec(),
            stiffness_nm_per_rad: stiffness(robot),
            recording,
            temperature_c: nuisance
                .temperature_c
                .is_finite()
                .then_some(nuisance.temperature_c),
            mean: nuisance.mean.clone(),
            covariance_lower: lower,
        }
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// [`OutputError`] with the path.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        // Numbers and names always serialise.
        let text = serde_json::to_string(self).unwrap_or_default();
        write_file(path, text.as_bytes())
    }

    /// Reads a file and checks that it belongs to `robot`.
    ///
    /// # Errors
    /// [`AbsoluteError::Baseline`] with the file and what doesn't fit.
    pub fn read(path: &Path) -> Result<Self, AbsoluteError> {
        let wrong = |why: String| AbsoluteError::Baseline {
            file: path.display().to_string(),
            why,
        };
        let text = std::fs::read_to_string(path).map_err(|e| wrong(format!("can't read: {e}")))?;
        let read: Self = serde_json::from_str(&text).map_err(|e| {
            wrong(format!(
                "not a baseline: {e}; make one with sinew baseline LOG --out FILE"
            ))
        })?;
        if read.format != Self::FORMAT || read.version != Self::VERSION {
            return Err(wrong(format!(
                "format '{}' version {}; this program reads '{}' version {}",
                read.format,
                read.version,
                Self::FORMAT,
                Self::VERSION
            )));
        }
        let d = read.mean.len();
        let numbers = read.mean.iter().chain(&read.covariance_lower);
        if read.covariance_lower.len() != d * (d + 1) / 2 || numbers.clone().any(|x| !x.is_finite())
        {
            return Err(wrong("its numbers are damaged; make it again".into()));
        }
        Ok(read)
    }

    /// The nuisance parameters, if the file belongs to `robot`.
    pub(super) fn nuisance(
        &self,
        robot: &sinew_model::robot::Robot,
        dimension: usize,
        file: &str,
    ) -> Result<Nuisance, AbsoluteError> {
        let wrong = |why: String| AbsoluteError::Baseline {
            file: file.into(),
            why,
        };
        if self.joints != robot.joint_names() || self.mean.len() != dimension {
            return Err(wrong(format!(
                "is of robot '{}' with joints {}; this one has {}",
                self.robot,
                self.joints.join(", "),
                robot.joint_names().join(", ")
            )));
        }
        if self.stiffness_nm_per_rad != stiffness(robot) {
            return Err(wrong(
                "was learned with another stiffness_nm_per_rad in robot.toml; learn it again"
                    .into(),
            ));
        }
        let d = dimension;
        let mut covariance = vec![0.0; d * d];
        let mut entries = self.covariance_lower.iter();
        for i in 0..d {
            for k in 0..=i {
                let value = entries.next().copied().unwrap_or(0.0);
                covariance[i * d + k] = value;
                covariance[k * d + i] = value;
            }
        }
        Ok(Nuisance {
            mean: self.mean.clone(),
            covariance,
            temperature_c: self.temperature_c.unwrap_or(f64::NAN),
        })
    }
}

fn stiffness(robot: &sinew_model::robot::Robot) -> Vec<f64> {
    robot
        .transmissions
        .iter()
        .map(|t| t.as_ref().map_or(0.0, |t| t.stiffness_nm_per_rad))
        .collect()
}
