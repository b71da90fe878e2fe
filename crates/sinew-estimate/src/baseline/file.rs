//! The baseline file: what recordings have taught about a robot.

use crate::anchored::AnchorReading;
use crate::error::SessionError;
use serde::{Deserialize, Serialize};
use sinew_files::{OutputError, limits, read_text, write_file};
use sinew_model::arm::PARAMETERS_PER_BODY;
use sinew_model::offset::{Belief, Prior};
use sinew_model::robot::Robot;
use std::path::Path;

/// What recordings since tensioning taught: JSON, versioned, a few hundred kilobytes.
///
/// The first is `sinew baseline`'s; `sinew estimate --save` writes the next of the chain. It holds
/// the posterior of the whole state, offsets and payload at the end of the last recording included,
/// so that a recording that goes on where the last one ended is estimated as if it were one.
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
    /// Nominal inertial parameters it was learned with, ten per joint
    /// ([`PARAMETERS_PER_BODY`](sinew_model::arm::PARAMETERS_PER_BODY)): what it holds are
    /// differences from these.
    pub inertial: Vec<f64>,
    /// Recordings it was learned from, the first right after tensioning.
    pub recordings: Vec<String>,
    /// Recordings from before the ropes were tensioned that it went on from (`--start`).
    pub before: Vec<String>,
    /// When the last recording ended, ns on its own clock.
    pub end_time_ns: i64,
    /// When the first recording ended, ns on its own clock, and every offset was zero; `None`: it is the last one.
    #[serde(default)]
    pub zero_time_ns: Option<i64>,
    /// Temperature the offsets refer to, °C; `None` where nobody said.
    pub temperature_c: Option<f64>,
    /// Its standard deviation, K, where it was stated instead of recorded.
    #[serde(default)]
    pub temperature_deviation_k: f64,
    /// What was unknown of the temperature's change in the last recording, standard deviation, K: a recording that
    /// goes on with it knows no more.
    #[serde(default)]
    pub change_deviation_k: f64,
    /// End stops and marks that were touched right after tensioning.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub anchors: Vec<AnchorReading>,
    /// Means of the state.
    pub mean: Vec<f64>,
    /// Lower triangle of their covariance, row by row.
    pub covariance_lower: Vec<f64>,
    /// Noise the last recording left at every joint, rad; empty: unknown. No estimate reads it.
    pub noise_rad: Vec<f64>,
    /// The same of the motor's torque, N·m.
    pub motor_noise_nm: Vec<f64>,
}

impl Baseline {
    const FORMAT: &'static str = "sinew-baseline";
    const VERSION: u32 = 4;

    pub(crate) fn new(
        robot: &Robot,
        recordings: Vec<String>,
        end_time_ns: i64,
        belief: &Belief,
        [noise_rad, motor_noise_nm]: [Vec<f64>; 2],
    ) -> Self {
        let d = belief.mean.len();
        let lower = (0..d)
            .flat_map(|i| belief.covariance[i * d..=i * d + i].iter().copied())
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
            temperature_c: belief
                .temperature_c
                .is_finite()
                .then_some(belief.temperature_c),
            temperature_deviation_k: 0.0,
            change_deviation_k: 0.0,
            anchors: Vec::new(),
            mean: belief.mean.clone(),
            covariance_lower: lower,
            noise_rad,
            motor_noise_nm,
        }
    }

    /// When every offset was zero, ns, as far as the file says: the end of the first recording.
    pub(crate) fn zero_time(&self) -> Option<i64> {
        let is_first = self.recordings.len() == 1;
        self.zero_time_ns.or(is_first.then_some(self.end_time_ns))
    }

    /// Every recording it rests on, in order.
    pub(crate) fn rests_on(&self) -> Vec<String> {
        self.before
            .iter()
            .chain(&self.recordings)
            .cloned()
            .collect()
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// [`OutputError`] with the path.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_file(path, self.to_text().as_bytes())
    }

    /// The file's text.
    pub fn to_text(&self) -> String {
        // Numbers and names always serialise.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`SessionError::Baseline`] with the file and what doesn't fit.
    pub fn read(path: &Path) -> Result<Self, SessionError> {
        let file = path.display().to_string();
        let text = read_text(path, &limits::BASELINE).map_err(|e| SessionError::Baseline {
            file: file.clone(),
            why: e.problem.clone(),
        })?;
        Self::parse(&text, &file)
    }

    /// Reads a file's text; `file` is its name for messages.
    ///
    /// # Errors
    /// As [`Baseline::read`].
    pub fn parse(text: &str, file: &str) -> Result<Self, SessionError> {
        /// Read first: a file of another version has other fields.
        #[derive(Deserialize)]
        struct Head {
            format: String,
            version: u32,
        }
        let wrong = |why: String| SessionError::Baseline {
            file: file.to_owned(),
            why,
        };
        let not = |e: serde_json::Error| {
            wrong(format!(
                "not a baseline: {e}; make one with sinew baseline LOG --out FILE"
            ))
        };
        let head: Head = serde_json::from_str(text).map_err(not)?;
        if head.format != Self::FORMAT || head.version != Self::VERSION {
            return Err(wrong(format!(
                "format '{}' version {}; this program reads '{}' version {}: make it again with sinew baseline LOG --out FILE",
                head.format,
                head.version,
                Self::FORMAT,
                Self::VERSION
            )));
        }
        let read: Self = serde_json::from_str(text).map_err(not)?;
        let d = read.mean.len();
        let noise = read.noise_rad.iter().chain(&read.motor_noise_nm);
        let numbers = read.mean.iter().chain(&read.covariance_lower).chain(noise);
        if read.covariance_lower.len() != d * (d + 1) / 2 || numbers.clone().any(|x| !x.is_finite())
        {
            return Err(wrong("its numbers are damaged; make it again".into()));
        }
        Ok(read)
    }

    /// What is believed, if the file (`file`, for the message) belongs to `robot`.
    ///
    /// # Errors
    /// [`SessionError::Baseline`] when it is of another robot, or robot.toml or URDF say another
    /// stiffness or mass than when it was learned.
    pub fn belief(&self, robot: &Robot, prior: &Prior, file: &str) -> Result<Belief, SessionError> {
        let wrong = |why: String| SessionError::Baseline {
            file: file.into(),
            why,
        };
        let d = prior.dimension();
        if self.joints != robot.joint_names() || self.mean.len() != d {
            return Err(wrong(format!(
                "is of robot '{}' with joints {}; this one has {}",
                self.robot,
                self.joints.join(", "),
                robot.joint_names().join(", ")
            )));
        }
        // A joint that is rigid now, as one whose encoder is not recorded, is left alone: what is known of the others holds.
        let now = stiffness(robot);
        let pairs = self.stiffness_nm_per_rad.iter().zip(&now);
        let mut differs = pairs.map(|(then, now)| *now > 0.0 && then != now);
        if self.stiffness_nm_per_rad.len() != now.len() || differs.any(|differs| differs) {
            return Err(wrong(
                "was learned with another stiffness_nm_per_rad in robot.toml; learn it again"
                    .into(),
            ));
        }
        self.same_masses(robot).map_err(wrong)?;
        let mut covariance = vec![0.0; d * d];
        let mut entries = self.covariance_lower.iter();
        for i in 0..d {
            for k in 0..=i {
                let value = entries.next().copied().unwrap_or(0.0);
                covariance[i * d + k] = value;
                covariance[k * d + i] = value;
            }
        }
        Ok(Belief {
            mean: self.mean.clone(),
            covariance,
            temperature_c: self.temperature_c.unwrap_or(f64::NAN),
        })
    }

    /// Whether the URDF has the bodies it was learned with; what doesn't fit otherwise.
    fn same_masses(&self, robot: &Robot) -> Result<(), String> {
        /// Share of a body's parameters that reading and writing may change.
        const SAME: f64 = 1e-9;
        let now = robot.arm.inertial_parameters();
        if self.inertial.len() != now.len() {
            return Err("its bodies are not those of this robot".into());
        }
        let bodies = |all: &[f64]| -> Vec<Vec<f64>> {
            let bodies = all.chunks_exact(PARAMETERS_PER_BODY);
            bodies.map(<[f64]>::to_vec).collect()
        };
        let names = robot.joint_names().iter();
        let pairs = bodies(&self.inertial).into_iter().zip(bodies(&now));
        for (joint, (then, now)) in names.zip(pairs) {
            let size = |x: &[f64]| x.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
            let apart: Vec<f64> = then.iter().zip(&now).map(|(a, b)| a - b).collect();
            if size(&apart) > SAME * size(&now) {
                let what = if (then[0] - now[0]).abs() > SAME * now[0] {
                    format!("{} kg there, now {} kg", then[0], now[0])
                } else {
                    format!("{} kg there, placed or spread otherwise now", now[0])
                };
                return Err(format!(
                    "was learned with other masses in the URDF at what joint {joint} carries ({what}); learn it again"
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
