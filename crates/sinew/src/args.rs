//! Parsers of option values; errors name the unit.

use crate::quantity::{Angle, Time, parse};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use sinew_estimate::feeder::Injection;
use sinew_estimate::session::Touch;
use sinew_log::{JointEffort, LogError, Mapping, OpenOptions};
use sinew_model::offset::{Comparison, TorqueSource, VelocityFilter};
use sinew_model::transmission::AnchorKind;
use std::path::{Path, PathBuf};

/// Parses a finite number.
///
/// * `unit`: unit named in the error.
pub(crate) fn number(text: &str, unit: &str) -> Result<f64, String> {
    let value: f64 = text
        .trim()
        .parse()
        .map_err(|_| format!("'{text}' is not a number ({unit})"))?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{value} {unit} is not a finite number"))
    }
}

/// Returns a parser of numbers above 0.
pub(crate) fn positive(unit: &'static str) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match number(text, unit)? {
        value if value > 0.0 => Ok(value),
        value => Err(format!("{value} {unit} must be above 0")),
    }
}

/// Returns a parser of numbers of at least 0.
pub fn not_negative(unit: &'static str) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match number(text, unit)? {
        value if value >= 0.0 => Ok(value),
        value => Err(format!("{value} {unit} must be at least 0")),
    }
}

/// Value name, help text and value of an option.
pub(crate) type Choice<T> = (&'static str, &'static str, T);

/// Returns a parser of one of several value names.
pub(crate) fn choice<T: Clone + Send + Sync>(
    of: &'static [Choice<T>],
) -> impl TypedValueParser<Value = T> {
    let words = of.iter().map(|c| PossibleValue::new(c.0).help(c.1));
    PossibleValuesParser::new(words).try_map(|word| {
        let chosen = of.iter().find(|c| c.0 == word);
        chosen
            .map(|c| c.2.clone())
            .ok_or("is not one of the possible values")
    })
}

/// Parses `recorded` or a cut-off in rad/s.
pub(crate) fn velocity_filter(text: &str) -> Result<VelocityFilter, String> {
    if text.eq_ignore_ascii_case("recorded") {
        return Ok(VelocityFilter::Recorded);
    }
    let cutoff_rad_per_s = positive("rad/s")(text).map_err(|e| format!("{e}, or 'recorded'"))?;
    Ok(VelocityFilter::StateVariable { cutoff_rad_per_s })
}

/// Parses the time of an index mark, `JOINT@SECONDS` or `JOINT:motor-mark@SECONDS`.
pub(crate) fn touch(text: &str) -> Result<Touch, String> {
    let form = "expected JOINT@SECONDS or JOINT:motor-mark@SECONDS, e.g. elbow@12.35";
    let (joint, time) = text.rsplit_once('@').ok_or(form)?;
    let (joint, kind) = match joint.rsplit_once(':') {
        Some((joint, "joint-mark")) => (joint, Some(AnchorKind::JointMark)),
        Some((joint, "motor-mark")) => (joint, Some(AnchorKind::MotorMark)),
        _ => (joint, None),
    };
    if joint.is_empty() {
        return Err(form.into());
    }
    match parse(time)? {
        Time(time_s) if time_s < 0.0 => Err(format!("{time_s} s is before the recording")),
        Time(time_s) => Ok(Touch {
            joint: joint.into(),
            kind,
            time_s,
        }),
    }
}

/// Parses an injected offset, `JOINT=RAD` or `JOINT=RAD@SECONDS`.
pub(crate) fn injection(text: &str) -> Result<Injection, String> {
    let form = "expected JOINT=RAD or JOINT=RAD@SECONDS, e.g. elbow=0.01@20";
    let (joint, rest) = text.rsplit_once('=').ok_or(form)?;
    if joint.is_empty() {
        return Err(form.into());
    }
    let (offset, from) = match rest.split_once('@') {
        Some((offset, from)) => (offset, Some(from)),
        None => (rest, None),
    };
    let Angle(offset_rad) = parse(offset)?;
    // A larger offset is implausible; probably degrees were specified.
    if offset_rad.abs() > std::f64::consts::PI {
        return Err(format!(
            "{offset_rad} rad is more than half a turn; degrees need their unit, e.g. 0.5deg"
        ));
    }
    let from_s = match from.map(parse).transpose()? {
        Some(Time(t)) if t < 0.0 => return Err(format!("{t} s is before the recording")),
        from => from.map(|Time(t)| t),
    };
    Ok(Injection {
        joint: joint.into(),
        offset_rad,
        from_s,
    })
}

/// Method of the estimate.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Method {
    /// Absolute offsets; the interval covers errors of stiffness, masses, friction, payload and
    /// contact; relative to the encoder zero without a baseline
    Absolute,
    /// Uncorrected estimate of the paper without verdict; accurate for differences between
    /// recordings with comparable motion
    Paper,
}

impl From<Method> for sinew_estimate::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::Absolute => Self::Absolute,
            Method::Paper => Self::Paper,
        }
    }
}

/// Sources of the elastic torque.
pub(crate) const SOURCES: [Choice<TorqueSource>; 3] = [
    (
        "observer",
        "Momentum observer: positions and masses of the robot",
        TorqueSource::Observer,
    ),
    (
        "torque-sensor",
        "Recorded joint torque sensors",
        TorqueSource::TorqueSensor,
    ),
    (
        "motor",
        "Recorded motor torque, motor inertia and friction",
        TorqueSource::Motor,
    ),
];

/// Treatments of the lag of the observed torque.
pub(crate) const LAGS: [Choice<Comparison>; 2] = [
    (
        "matched",
        "theta - q filtered like the torque",
        Comparison::Matched,
    ),
    (
        "paper",
        "theta - q unfiltered, as in the paper",
        Comparison::Paper,
    ),
];

/// Meanings of `effort` of the joint side.
const EFFORTS: [Choice<JointEffort>; 3] = [
    (
        "tau-el",
        "Elastic joint torque from a sensor",
        JointEffort::TauEl,
    ),
    (
        "tau-m",
        "Motor torque, reflected to the joint",
        JointEffort::TauM,
    ),
    ("ignore", "Not used", JointEffort::Ignore),
];

/// Options for reading a recording.
#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub(crate) struct Opening {
    /// Mapping file (TOML): names, units and gear ratios of the recording
    #[arg(long, value_name = "FILE")]
    mapping: Option<PathBuf>,
    /// Joint-side topic (sensor_msgs/JointState) [default: /joint_states]
    #[arg(long, value_name = "TOPIC")]
    joint_topic: Option<String>,
    /// Motor-side topic (control_msgs/DynamicJointState or JointState)
    /// [default: /dynamic_joint_states]
    #[arg(long, value_name = "TOPIC")]
    motor_topic: Option<String>,
    /// Interface with the motor position [default: motor_position]
    #[arg(long, value_name = "NAME")]
    motor_interface: Option<String>,
    /// Meaning of the effort of the joint side [default: tau-el]
    #[arg(long, value_name = "WHAT", value_parser = choice(&EFFORTS))]
    joint_effort: Option<JointEffort>,
}

impl Opening {
    /// Path of the mapping file.
    pub(crate) fn mapping(&self) -> Option<&Path> {
        self.mapping.as_deref()
    }

    /// Returns the options as specified on the command line.
    pub(crate) fn given(&self) -> Vec<String> {
        let mapping = self.mapping.as_ref().map(|m| m.display().to_string());
        let words = [
            ("--mapping", mapping.as_ref()),
            ("--joint-topic", self.joint_topic.as_ref()),
            ("--motor-topic", self.motor_topic.as_ref()),
            ("--motor-interface", self.motor_interface.as_ref()),
        ];
        let given = words
            .iter()
            .filter_map(|(name, value)| Some((name, (*value)?)));
        let mut out: Vec<String> = given
            .map(|(name, value)| format!("{name} {value}"))
            .collect();
        let effort = EFFORTS.iter().find(|e| Some(e.2) == self.joint_effort);
        out.extend(effort.map(|(word, ..)| format!("--joint-effort {word}")));
        out
    }

    /// Returns the options for opening a recording, with the mapping file read.
    pub(crate) fn options(&self) -> Result<OpenOptions, LogError> {
        let mut options = OpenOptions {
            mapping: self.mapping.as_deref().map(Mapping::read).transpose()?,
            joint_state_topic: self.joint_topic.clone(),
            motor_topic: self.motor_topic.clone(),
            ..OpenOptions::default()
        };
        if let Some(name) = &self.motor_interface {
            options.motor_interface.clone_from(name);
        }
        options.joint_effort = self.joint_effort.unwrap_or(options.joint_effort);
        Ok(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn injection_parses_joint_offset_and_time() {
        let i = injection("left=elbow=-0.01@20.5").unwrap();
        assert_eq!(
            (i.joint.as_str(), i.offset_rad, i.from_s),
            ("left=elbow", -0.01, Some(20.5))
        );
        assert_eq!(injection("elbow=1e-2").unwrap().from_s, None);
        let i = injection("elbow=10mrad@1min").unwrap();
        assert_eq!((i.offset_rad, i.from_s), (0.01, Some(60.0)));
        for (bad, word) in [
            ("elbow", "JOINT=RAD"),
            ("=0.1", "JOINT=RAD"),
            ("elbow=", "without a unit: rad"),
            ("elbow=nan", "finite"),
            ("elbow=10", "half a turn"),
            ("elbow=0.01@", "without a unit: s"),
            ("elbow=0.01@-3", "before the recording"),
        ] {
            let error = injection(bad).unwrap_err();
            assert!(error.contains(word), "{bad}: {error}");
        }
    }

    #[test]
    fn touch_parses_joint_and_time() {
        let t = touch("left@elbow@20.5").unwrap();
        assert_eq!((t.joint.as_str(), t.time_s), ("left@elbow", 20.5));
        let t = touch("elbow:motor-mark@3").unwrap();
        assert_eq!(
            (t.joint.as_str(), t.kind),
            ("elbow", Some(AnchorKind::MotorMark))
        );
        for (bad, word) in [
            ("elbow", "JOINT@SECONDS"),
            ("@3", "JOINT@SECONDS"),
            ("elbow@x", "without a unit: s"),
            ("elbow@-1", "before"),
        ] {
            let error = touch(bad).unwrap_err();
            assert!(error.contains(word), "{bad}: {error}");
        }
    }

    #[test]
    fn invalid_value_error_names_unit() {
        for bad in ["-3", "0", "nan", "inf", "fast", ""] {
            assert!(positive("1/s")(bad).unwrap_err().contains("1/s"), "{bad}");
            assert!(velocity_filter(bad).unwrap_err().contains("rad/s"), "{bad}");
        }
        assert_eq!(velocity_filter("Recorded"), Ok(VelocityFilter::Recorded));
    }
}
