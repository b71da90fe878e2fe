//! Correction for the stretch in a scenario: `[correction]`, `[contact_detection]`.

use super::draw::{Draw, PerJoint, per};
use crate::SimulateError;
use serde_json::Value;
use sinew_files::{Bound, Budget, Fields as _, Located, Section, read_text};
use std::path::Path;

/// Kind of the offset used for correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SpecifiedOffset {
    /// None: the robot works as if its ropes were new.
    #[default]
    Nothing,
    /// The true one at every moment.
    True,
    /// The one the scenario states, or an estimate it names.
    Stated,
}

/// Set-point that the controller follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SetPointKind {
    /// `q_d + x(g(q_d)) + delta_e`, right at rest.
    #[default]
    Static,
    /// Set-point with `M ddq_d + C dq_d` and joint friction, exact in motion too.
    Dynamic,
}

/// Stretch assumed by controller and contact detector, with its errors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Correction {
    /// Kind of the offset.
    pub offset: SpecifiedOffset,
    /// Specified offset, rad.
    pub offset_rad: PerJoint,
    /// Error added to the true or specified offset, rad.
    pub offset_error_rad: PerJoint,
    /// Standard deviation of the offset assumed by the detector, rad.
    pub offset_std_rad: PerJoint,
    /// Assumed ratio of true to described stiffness.
    pub stiffness_factor: PerJoint,
    /// Relative standard deviation of the stiffness.
    pub stiffness_std: PerJoint,
    /// Assumed cubic stiffening, 1/rad².
    pub spring_cubic_per_rad2: PerJoint,
    /// Kind of the set-point.
    pub set_point: SetPointKind,
    /// Path of a result of `sinew estimate --json`, relative to the scenario; becomes `Stated` when read.
    pub estimate: Option<String>,
    /// Line of `estimate` in the file.
    pub estimate_line: u64,
}

impl Correction {
    pub(super) fn all(&self) -> [&PerJoint; 6] {
        [
            &self.offset_rad,
            &self.offset_error_rad,
            &self.offset_std_rad,
            &self.stiffness_factor,
            &self.stiffness_std,
            &self.spring_cubic_per_rad2,
        ]
    }

    /// Reads the correction from the output of `sinew estimate --json`; `file` is its name for messages.
    ///
    /// Uses the session's offsets and their standard deviations; of a result of the paper's method its uncorrected
    /// estimate, which depends on stiffness and masses (the standard error does not include these). The stiffness
    /// remains that of the description, because its estimate is correlated with that of the offset.
    ///
    /// # Errors
    /// Returns [`SimulateError::Estimate`] if the text is not such a result.
    pub fn take_estimate(&mut self, text: &str, file: &str) -> Result<(), SimulateError> {
        let estimate_error = |reason: String| SimulateError::Estimate {
            file: file.into(),
            reason,
        };
        let document: Value =
            serde_json::from_str(text).map_err(|e| estimate_error(e.to_string()))?;
        let session = document.pointer("/session/joints");
        let (joints, value, spread) = match session {
            // Schema version 1 calls the standard deviation `deviation`.
            Some(joints) if joints.pointer("/0/offset_rad/std").is_none() => {
                (joints, "/offset_rad/mean", "/offset_rad/deviation")
            }
            Some(joints) => (joints, "/offset_rad/mean", "/offset_rad/std"),
            None => (
                document.pointer("/reading/joints").unwrap_or(&Value::Null),
                "/offset_rad",
                "/standard_error_rad",
            ),
        };
        let joints = joints
            .as_array()
            .filter(|j| !j.is_empty())
            .ok_or_else(|| estimate_error("it contains no joints".into()))?;
        let mut offsets = PerJoint::fixed(0.0);
        let mut stds = PerJoint::fixed(0.0);
        for joint in joints {
            let name = joint.get("name").and_then(Value::as_str);
            let name = name.ok_or_else(|| estimate_error("a joint has no name".into()))?;
            let number = |key: &str| {
                let value = joint.pointer(key).and_then(Value::as_f64);
                let words = || key.trim_start_matches('/').replace('/', ".");
                value.ok_or_else(|| {
                    estimate_error(format!("joint '{name}' has no number {}", words()))
                })
            };
            let line = self.estimate_line;
            let offset = Draw::Fixed(number(value)?);
            let std = Draw::Fixed(number(spread)?);
            offsets.by_joint.push((name.into(), line, offset));
            stds.by_joint.push((name.into(), line, std));
        }
        self.offset = SpecifiedOffset::Stated;
        self.offset_rad = offsets;
        self.offset_std_rad = stds;
        self.estimate = None;
        Ok(())
    }

    /// Reads the estimate the scenario names, if it names one; paths are relative to `folder`.
    ///
    /// # Errors
    /// [`SimulateError::Estimate`].
    pub fn read_estimate(&mut self, folder: &Path) -> Result<(), SimulateError> {
        let Some(named) = self.estimate.clone() else {
            return Ok(());
        };
        let path = folder.join(named);
        let file = path.display().to_string();
        let text = read_text(&path, &Budget::TABLE).map_err(|e| SimulateError::Estimate {
            file: file.clone(),
            reason: e.problem.clone(),
        })?;
        self.take_estimate(&text, &file)
    }
}

/// Settings of the contact detection from the recorded positions.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactDetection {
    /// Observer gain, 1/s.
    pub gain_per_s: f64,
    /// Cut-off of the velocity filter, rad/s.
    pub cutoff_rad_per_s: f64,
    /// Standard deviations from a false alarm.
    pub sigmas: f64,
    /// Noise of the estimate without contact, N·m; measured in a run without contacts and model errors if not
    /// specified.
    pub noise_nm: PerJoint,
    /// Relative standard deviation of the masses.
    pub mass_std: f64,
    /// Share of the Coulomb friction that counts as unknown.
    pub friction_share: f64,
    /// A contact ends below this share of the threshold.
    pub release_share: f64,
    /// Minimum duration of a detection, s.
    pub confirm_s: f64,
}

impl Default for ContactDetection {
    fn default() -> Self {
        // Those of `sinew_model::correction`, except that a single sample of noise is no contact.
        Self {
            gain_per_s: 30.0,
            cutoff_rad_per_s: 60.0,
            sigmas: 4.0,
            noise_nm: PerJoint::default(),
            mass_std: 0.0,
            friction_share: 1.0,
            release_share: 0.7,
            confirm_s: 0.01,
        }
    }
}

pub(super) fn correction(s: &Section<'_>) -> Result<Correction, Located> {
    let offset_kind = |given: bool| {
        if given {
            SpecifiedOffset::Stated
        } else {
            SpecifiedOffset::Nothing
        }
    };
    let (stated, estimate) = (s.has("offset_rad"), s.text("estimate")?);
    let offset = match s.text("offset")?.as_deref() {
        None => offset_kind(stated || estimate.is_some()),
        Some("none") => SpecifiedOffset::Nothing,
        Some("true") => SpecifiedOffset::True,
        Some("stated") => SpecifiedOffset::Stated,
        Some(_) => return Err(s.invalid("offset", "\"none\", \"true\" or \"stated\"")),
    };
    if stated && offset != SpecifiedOffset::Stated {
        return Err(s.invalid("offset_rad", "omitted unless offset is \"stated\""));
    }
    if estimate.is_some() && (stated || offset != SpecifiedOffset::Stated) {
        let must = "omitted if offset_rad is given or offset is not \"stated\"";
        return Err(s.invalid("estimate", must));
    }
    if offset == SpecifiedOffset::Stated && !stated && estimate.is_none() {
        return Err(s.missing("offset_rad", "offset to correct, or estimate"));
    }
    let angle = Bound::Within(-1.0, 1.0);
    Ok(Correction {
        offset,
        offset_rad: per(s, "offset_rad", angle)?,
        offset_error_rad: per(s, "offset_error_rad", angle)?,
        offset_std_rad: per(s, "offset_std_rad", Bound::Within(0.0, 1.0))?,
        stiffness_factor: per(s, "stiffness_factor", Bound::Within(0.05, 20.0))?,
        stiffness_std: per(s, "stiffness_std", Bound::Within(0.0, 1.0))?,
        spring_cubic_per_rad2: per(s, "spring_cubic_per_rad2", Bound::Within(0.0, 1e4))?,
        set_point: match s.text("set_point")?.as_deref() {
            None | Some("static") => SetPointKind::Static,
            Some("dynamic") => SetPointKind::Dynamic,
            Some(_) => return Err(s.invalid("set_point", "\"static\" or \"dynamic\"")),
        },
        estimate,
        estimate_line: s.line(),
    })
}

pub(super) fn contact_detection(s: &Section<'_>) -> Result<ContactDetection, Located> {
    let plain = ContactDetection::default();
    let number = |key, bound, plain: f64| -> Result<f64, Located> {
        Ok(s.number(key, bound)?.unwrap_or(plain))
    };
    let share = Bound::Within(0.0, 1.0);
    Ok(ContactDetection {
        gain_per_s: number("gain_per_s", Bound::Within(1e-3, 1e5), plain.gain_per_s)?,
        cutoff_rad_per_s: number(
            "cutoff_rad_per_s",
            Bound::Within(1e-3, 1e5),
            plain.cutoff_rad_per_s,
        )?,
        sigmas: number("sigmas", Bound::Within(0.0, 100.0), plain.sigmas)?,
        noise_nm: per(s, "noise_nm", Bound::NotNegative)?,
        mass_std: number("mass_std", share, plain.mass_std)?,
        friction_share: number(
            "friction_share",
            Bound::Within(0.0, 10.0),
            plain.friction_share,
        )?,
        release_share: number("release_share", share, plain.release_share)?,
        confirm_s: number("confirm_s", Bound::Within(0.0, 60.0), plain.confirm_s)?,
    })
}
