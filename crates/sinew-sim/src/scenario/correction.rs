//! What a scenario says about correcting for the stretch: `[correction]`, `[contact_detection]`.

use super::draw::{Draw, PerJoint, per};
use crate::SimulateError;
use serde_json::Value;
use sinew_files::{Bound, Fields as _, Located, Section, limits, read_text};
use std::path::Path;

/// Which offset is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum KnownOffset {
    /// None: the robot works as if its ropes were new.
    #[default]
    Nothing,
    /// The true one at every moment.
    True,
    /// The one the scenario states, or an estimate it names.
    Stated,
}

/// Which set-point the controller follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SetPointKind {
    /// `q_d + x(g(q_d)) + delta_e`, right at rest.
    #[default]
    Static,
    /// With `M ddq_d + C dq_d` and joint friction, right in motion too.
    Dynamic,
}

/// What controller and contact detector know of the stretch, and how well.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Correction {
    /// Which offset.
    pub offset: KnownOffset,
    /// The offset stated, rad.
    pub offset_rad: PerJoint,
    /// Error on top of the true or stated offset, rad.
    pub offset_error_rad: PerJoint,
    /// Standard deviation the detector takes the offset to have, rad.
    pub offset_deviation_rad: PerJoint,
    /// True stiffness over described as far as known.
    pub stiffness_factor: PerJoint,
    /// Its standard deviation.
    pub stiffness_deviation: PerJoint,
    /// Stiffening as far as known, 1/rad².
    pub spring_cubic_per_rad2: PerJoint,
    /// Which set-point.
    pub set_point: SetPointKind,
    /// An answer of `sinew estimate --json`, relative to the scenario; becomes `Stated` when read.
    pub estimate: Option<String>,
    /// Line of `estimate` in the file.
    pub estimate_line: u64,
}

impl Correction {
    pub(super) fn all(&self) -> [&PerJoint; 6] {
        [
            &self.offset_rad,
            &self.offset_error_rad,
            &self.offset_deviation_rad,
            &self.stiffness_factor,
            &self.stiffness_deviation,
            &self.spring_cubic_per_rad2,
        ]
    }

    /// Takes what is known from an answer of `sinew estimate --json`; `file` is its name for
    /// messages.
    ///
    /// The session's offsets and their standard deviations; of an answer by the paper's method its
    /// reading, which rests on stiffness and masses; the standard error says nothing of that. Stiffness is left as described: a change seen together with the offset is
    /// partly the same thing.
    ///
    /// # Errors
    /// [`SimulateError::Estimate`] when the text isn't such an answer.
    pub fn take_estimate(&mut self, text: &str, file: &str) -> Result<(), SimulateError> {
        let refuse = |why: String| SimulateError::Estimate {
            file: file.into(),
            why,
        };
        let said: Value = serde_json::from_str(text).map_err(|e| refuse(e.to_string()))?;
        let session = said.pointer("/session/joints");
        let (joints, value, spread) = match session {
            Some(joints) => (joints, "/offset_rad/mean", "/offset_rad/deviation"),
            None => (
                said.pointer("/reading/joints").unwrap_or(&Value::Null),
                "/offset_rad",
                "/standard_error_rad",
            ),
        };
        let joints = joints
            .as_array()
            .filter(|j| !j.is_empty())
            .ok_or_else(|| refuse("there are no joints in it".into()))?;
        let mut offsets = PerJoint::fixed(0.0);
        let mut deviations = PerJoint::fixed(0.0);
        for joint in joints {
            let name = joint.get("name").and_then(Value::as_str);
            let name = name.ok_or_else(|| refuse("a joint has no name".into()))?;
            let number = |key: &str| {
                let value = joint.pointer(key).and_then(Value::as_f64);
                let words = || key.trim_start_matches('/').replace('/', ".");
                value.ok_or_else(|| refuse(format!("joint '{name}' has no number {}", words())))
            };
            let line = self.estimate_line;
            let offset = Draw::Fixed(number(value)?);
            let deviation = Draw::Fixed(number(spread)?);
            offsets.by_joint.push((name.into(), line, offset));
            deviations.by_joint.push((name.into(), line, deviation));
        }
        self.offset = KnownOffset::Stated;
        self.offset_rad = offsets;
        self.offset_deviation_rad = deviations;
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
        let text = read_text(&path, &limits::SESSIONS).map_err(|e| SimulateError::Estimate {
            file: file.clone(),
            why: e.problem.clone(),
        })?;
        self.take_estimate(&text, &file)
    }
}

/// How contacts are looked for in the recording's own positions.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactDetection {
    /// Observer gain, 1/s.
    pub gain_per_s: f64,
    /// Cut-off of the velocity filter, rad/s.
    pub cutoff_rad_per_s: f64,
    /// Standard deviations from a false alarm.
    pub sigmas: f64,
    /// Noise of the estimate while nothing touches, N·m; measured in a run without contacts and
    /// model errors where left out.
    pub noise_nm: PerJoint,
    /// Relative standard deviation of the masses.
    pub mass_deviation: f64,
    /// Share of the Coulomb friction that counts as unknown.
    pub friction_share: f64,
    /// A contact ends below this share of the threshold.
    pub release_share: f64,
    /// It counts when it has lasted so long, s.
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
            mass_deviation: 0.0,
            friction_share: 1.0,
            release_share: 0.7,
            confirm_s: 0.01,
        }
    }
}

pub(super) fn correction(s: &Section<'_>) -> Result<Correction, Located> {
    let known = |given: bool| {
        if given {
            KnownOffset::Stated
        } else {
            KnownOffset::Nothing
        }
    };
    let (stated, estimate) = (s.has("offset_rad"), s.text("estimate")?);
    let offset = match s.text("offset")?.as_deref() {
        None => known(stated || estimate.is_some()),
        Some("none") => KnownOffset::Nothing,
        Some("true") => KnownOffset::True,
        Some("stated") => KnownOffset::Stated,
        Some(_) => return Err(s.refuse("offset", "\"none\", \"true\" or \"stated\"")),
    };
    if stated && offset != KnownOffset::Stated {
        return Err(s.refuse("offset_rad", "left out unless offset is \"stated\""));
    }
    if estimate.is_some() && (stated || offset != KnownOffset::Stated) {
        let must = "left out where offset_rad is given or offset isn't \"stated\"";
        return Err(s.refuse("estimate", must));
    }
    if offset == KnownOffset::Stated && !stated && estimate.is_none() {
        return Err(s.missing("offset_rad", "the offset that is known, or estimate"));
    }
    let angle = Bound::Within(-1.0, 1.0);
    Ok(Correction {
        offset,
        offset_rad: per(s, "offset_rad", angle)?,
        offset_error_rad: per(s, "offset_error_rad", angle)?,
        offset_deviation_rad: per(s, "offset_deviation_rad", Bound::Within(0.0, 1.0))?,
        stiffness_factor: per(s, "stiffness_factor", Bound::Within(0.05, 20.0))?,
        stiffness_deviation: per(s, "stiffness_deviation", Bound::Within(0.0, 1.0))?,
        spring_cubic_per_rad2: per(s, "spring_cubic_per_rad2", Bound::Within(0.0, 1e4))?,
        set_point: match s.text("set_point")?.as_deref() {
            None | Some("static") => SetPointKind::Static,
            Some("dynamic") => SetPointKind::Dynamic,
            Some(_) => return Err(s.refuse("set_point", "\"static\" or \"dynamic\"")),
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
        mass_deviation: number("mass_deviation", share, plain.mass_deviation)?,
        friction_share: number(
            "friction_share",
            Bound::Within(0.0, 10.0),
            plain.friction_share,
        )?,
        release_share: number("release_share", share, plain.release_share)?,
        confirm_s: number("confirm_s", Bound::Within(0.0, 60.0), plain.confirm_s)?,
    })
}
