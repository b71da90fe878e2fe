//! Baseline file: posterior of a robot from its recordings.

use crate::anchored::ReferenceMeasurement;
use crate::cable::CableBaseline;
use crate::error::SessionError;
use serde::{Deserialize, Serialize};
use sinew_files::{Budget, OutputError, read_text, write_file};
use sinew_model::arm::PARAMETERS_PER_BODY;
use sinew_model::offset::{ModelError, Prior, StateEstimate};
use sinew_model::robot::Robot;
use std::path::Path;

/// Posterior from the recordings since tensioning, as versioned JSON, about 1 MB for seven joints.
///
/// `sinew baseline` writes the first one; `sinew estimate --save` writes the next of the chain. The file contains
/// the posterior of the whole state, including offsets and payload at the end of the last recording. A recording that
/// continues the last one is therefore estimated as if both were one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// Name of the file format, always "sinew-baseline".
    pub format: String,
    /// Version of the file format.
    pub version: u32,
    /// Name of the robot.
    pub robot: String,
    /// Names of the joints of the robot, in order.
    pub joints: Vec<String>,
    /// Nominal stiffness in the estimation of the baseline, N·m/rad, one per axis; 0 for rigid joints.
    pub stiffness_nm_per_rad: Vec<f64>,
    /// Nominal inertial parameters in the estimation of the baseline, ten per joint
    /// ([`PARAMETERS_PER_BODY`](sinew_model::arm::PARAMETERS_PER_BODY)); the state contains
    /// differences from these.
    pub inertial: Vec<f64>,
    /// Names of the recordings of the baseline; the first one was made directly after tensioning.
    pub recordings: Vec<String>,
    /// Names of earlier recordings, from before the ropes were tensioned, that the prior is based on (`--start`).
    pub before: Vec<String>,
    /// End of the last recording, ns on its own clock.
    pub end_time_ns: i64,
    /// End of the first recording, when every offset was zero, ns on its own clock; `None` if there is only one
    /// recording.
    #[serde(default)]
    pub zero_time_ns: Option<i64>,
    /// Reference temperature of the offsets, °C; `None` if neither recorded nor specified.
    pub temperature_c: Option<f64>,
    /// Standard deviation of a specified reference temperature, K; 0 if recorded.
    #[serde(default)]
    #[serde(alias = "temperature_deviation_k")]
    pub temperature_std_k: f64,
    /// Standard deviation of the temperature change since the baseline in the last recording, K; a continued recording
    /// has the same one.
    #[serde(default)]
    #[serde(alias = "change_deviation_k")]
    pub change_std_k: f64,
    /// Model error in the recording of the baseline, with which the evidence about causes is compared; `None` in files
    /// before version 6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_error: Option<ModelError>,
    /// Reference measurements (end stops and index marks) directly after tensioning.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub anchors: Vec<ReferenceMeasurement>,
    /// Parameters of the tendons with friction along their path.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cables: Vec<CableBaseline>,
    /// Mean of the state vector.
    pub mean: Vec<f64>,
    /// Lower triangle of the covariance of the state, row by row.
    pub covariance_lower: Vec<f64>,
    /// Residual noise of the link equation of each joint in the last recording, rad; empty if unknown. Not used by
    /// estimates.
    pub noise_rad: Vec<f64>,
    /// Residual noise of the motor equation of each joint in the last recording, N·m; empty if unknown.
    pub motor_noise_nm: Vec<f64>,
}

impl Baseline {
    const FORMAT: &'static str = "sinew-baseline";
    const VERSION: u32 = 6;
    /// Oldest version that is still read: its standard deviations are called deviations.
    const MIN_VERSION: u32 = 4;

    pub(crate) fn new(
        robot: &Robot,
        recordings: Vec<String>,
        end_time_ns: i64,
        state_estimate: &StateEstimate,
        [noise_rad, motor_noise_nm]: [Vec<f64>; 2],
    ) -> Self {
        let d = state_estimate.mean.len();
        let lower = (0..d)
            .flat_map(|i| state_estimate.covariance[i * d..=i * d + i].iter().copied())
            .collect();
        Self {
            format: Self::FORMAT.into(),
            version: Self::VERSION,
            robot: robot.name.clone(),
            joints: robot.joint_names().to_vec(),
            stiffness_nm_per_rad: stiffness(robot),
            inertial: robot.arm.inertial_parameters(),
            recordings,
            before: Vec::new(),
            end_time_ns,
            zero_time_ns: None,
            temperature_c: state_estimate
                .temperature_c
                .is_finite()
                .then_some(state_estimate.temperature_c),
            temperature_std_k: 0.0,
            change_std_k: 0.0,
            model_error: None,
            anchors: Vec::new(),
            cables: Vec::new(),
            mean: state_estimate.mean.clone(),
            covariance_lower: lower,
            noise_rad,
            motor_noise_nm,
        }
    }

    /// Time at which every offset was zero (end of the first recording), ns; `None` if the file does not contain it.
    pub(crate) fn zero_time(&self) -> Option<i64> {
        let is_first = self.recordings.len() == 1;
        self.zero_time_ns.or(is_first.then_some(self.end_time_ns))
    }

    /// Names of all recordings that the baseline is based on, in order.
    pub(crate) fn based_on(&self) -> Vec<String> {
        self.before
            .iter()
            .chain(&self.recordings)
            .cloned()
            .collect()
    }

    /// Writes the file atomically.
    ///
    /// # Errors
    /// Returns [`OutputError`] with the path if the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_file(path, self.to_text().as_bytes())
    }

    /// Returns the text of the file (JSON).
    pub fn to_text(&self) -> String {
        // Numbers and names always serialise.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Reads a baseline file.
    ///
    /// # Errors
    /// Returns [`SessionError::Baseline`] if the file cannot be read, has another format or version, or contains
    /// invalid numbers.
    pub fn read(path: &Path) -> Result<Self, SessionError> {
        let file = path.display().to_string();
        let text = read_text(path, &Budget::TABLE).map_err(|e| SessionError::Baseline {
            file: file.clone(),
            reason: e.problem.clone(),
        })?;
        Self::parse(&text, &file)
    }

    /// Parses the text of a baseline file; `file` is its name in messages.
    ///
    /// # Errors
    /// Returns [`SessionError::Baseline`] if the text has another format or version, or contains invalid numbers.
    pub fn parse(text: &str, file: &str) -> Result<Self, SessionError> {
        /// Format and version, read first because a file of another version has other fields.
        #[derive(Deserialize)]
        struct Head {
            format: String,
            version: u32,
        }
        let wrong = |reason: String| SessionError::Baseline {
            file: file.to_owned(),
            reason,
        };
        let not = |e: serde_json::Error| {
            wrong(format!(
                "not a baseline: {e}; create one with sinew baseline LOG --out FILE"
            ))
        };
        let head: Head = serde_json::from_str(text).map_err(not)?;
        if head.format != Self::FORMAT
            || !(Self::MIN_VERSION..=Self::VERSION).contains(&head.version)
        {
            return Err(wrong(format!(
                "unsupported format '{}' version {}, expected '{}' version {} to {}; create it again with sinew baseline LOG --out FILE",
                head.format,
                head.version,
                Self::FORMAT,
                Self::MIN_VERSION,
                Self::VERSION
            )));
        }
        let mut read: Self = serde_json::from_str(text).map_err(not)?;
        read.version = Self::VERSION;
        let d = read.mean.len();
        let noise = read.noise_rad.iter().chain(&read.motor_noise_nm);
        let numbers = read.mean.iter().chain(&read.covariance_lower).chain(noise);
        let is_valid = read.model_error.as_ref().is_none_or(ModelError::is_valid);
        let of_cables = read.cables.iter().flat_map(CableBaseline::numbers);
        if read.covariance_lower.len() != d * (d + 1) / 2
            || numbers.copied().chain(of_cables).any(|x| !x.is_finite())
            || !is_valid
        {
            return Err(wrong(
                "contains invalid numbers; create it again with sinew baseline LOG --out FILE"
                    .into(),
            ));
        }
        Ok(read)
    }

    /// Returns the state estimate, if the baseline belongs to `robot`; `file` is its name in messages.
    ///
    /// # Errors
    /// Returns [`SessionError::Baseline`] if the baseline belongs to another robot, or if the stiffness in robot.toml
    /// or a mass in the URDF has changed since it was estimated.
    pub fn state_estimate(
        &self,
        robot: &Robot,
        prior: &Prior,
        file: &str,
    ) -> Result<StateEstimate, SessionError> {
        let wrong = |reason: String| SessionError::Baseline {
            file: file.into(),
            reason,
        };
        let d = prior.dimension();
        if self.joints != robot.joint_names() || self.mean.len() != d {
            return Err(wrong(format!(
                "belongs to robot '{}' with joints {}; expected joints {}",
                self.robot,
                self.joints.join(", "),
                robot.joint_names().join(", ")
            )));
        }
        // A joint that is rigid now, such as one without a recorded encoder, is not compared: the others remain valid.
        let now = stiffness(robot);
        let pairs = self.stiffness_nm_per_rad.iter().zip(&now);
        let mut differs = pairs.map(|(then, now)| *now > 0.0 && then != now);
        if self.stiffness_nm_per_rad.len() != now.len() || differs.any(|differs| differs) {
            return Err(wrong(
                "was estimated with another stiffness_nm_per_rad in robot.toml; create it again with sinew baseline"
                    .into(),
            ));
        }
        self.check_masses(robot).map_err(wrong)?;
        let mut covariance = vec![0.0; d * d];
        let mut entries = self.covariance_lower.iter();
        for i in 0..d {
            for k in 0..=i {
                let value = entries.next().copied().unwrap_or(0.0);
                covariance[i * d + k] = value;
                covariance[k * d + i] = value;
            }
        }
        Ok(StateEstimate {
            mean: self.mean.clone(),
            covariance,
            temperature_c: self.temperature_c.unwrap_or(f64::NAN),
        })
    }

    /// Checks that the bodies in the URDF are those of the baseline.
    ///
    /// # Errors
    /// Returns a message if a mass, centre of mass or inertia differs.
    fn check_masses(&self, robot: &Robot) -> Result<(), String> {
        /// Maximum relative difference of the parameters of a body by rounding in files.
        const MAX_RELATIVE_DIFFERENCE: f64 = 1e-9;
        let now = robot.arm.inertial_parameters();
        if self.inertial.len() != now.len() {
            return Err(
                "contains other bodies than this robot; create it again with sinew baseline".into(),
            );
        }
        let bodies = |all: &[f64]| -> Vec<Vec<f64>> {
            let bodies = all.chunks_exact(PARAMETERS_PER_BODY);
            bodies.map(<[f64]>::to_vec).collect()
        };
        let names = robot.joint_names().iter();
        let pairs = bodies(&self.inertial).into_iter().zip(bodies(&now));
        for (joint, (then, now)) in names.zip(pairs) {
            let size = |x: &[f64]| x.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
            let difference: Vec<f64> = then.iter().zip(&now).map(|(a, b)| a - b).collect();
            if size(&difference) > MAX_RELATIVE_DIFFERENCE * size(&now) {
                let change = if (then[0] - now[0]).abs() > MAX_RELATIVE_DIFFERENCE * now[0] {
                    format!("{} kg in the baseline, {} kg now", then[0], now[0])
                } else {
                    format!("{} kg, centre of mass or inertia changed", now[0])
                };
                return Err(format!(
                    "was estimated with other masses in the URDF for the body of joint {joint} ({change}); create it again with sinew baseline"
                ));
            }
        }
        Ok(())
    }
}

fn stiffness(robot: &Robot) -> Vec<f64> {
    robot
        .transmissions
        .iter()
        .map(|t| t.as_ref().map_or(0.0, |t| t.stiffness_nm_per_rad))
        .collect()
}
