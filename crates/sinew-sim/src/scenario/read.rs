//! The keys of a scenario file.

use super::correction::{contact_detection, correction};
use super::draw::{Draw, Keys as _, per};
use super::events::{
    contact, faults, jam, offset, payload, random_contacts, record, session, stop,
};
use super::*;
use crate::error::SimulateError;
use sinew_files::{Bound, Budget, Fields as _, Located, Section, TomlFile, read_text};
use std::f64::consts::PI;
use std::path::Path;

/// Bound of a joint angle, rad: ten turns; a larger value is probably in degrees.
const ANGLE: Bound = Bound::Within(-63.0, 63.0);

impl Scenario {
    /// Reads a scenario; `file` is its name for messages.
    ///
    /// Unknown keys are rejected. Joints and links are checked against the robot later, by
    /// [`Simulation::new`](crate::Simulation::new).
    ///
    /// # Errors
    /// With file, line, key, value and unit.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, Located> {
        let doc = TomlFile::parse(text, file)?;
        let scenario = doc.root().whole(|root| Self::of(root, file))?;
        scenario.check_rates(&doc.root())?;
        Ok(scenario)
    }

    /// Reads a scenario file, and the estimate that its correction names in the same folder.
    ///
    /// # Errors
    /// Returns a [`SimulateError`] if a file cannot be read or is invalid.
    pub fn open(path: &Path) -> Result<Self, SimulateError> {
        let text = read_text(path, &Budget::SETTINGS)?;
        let mut scenario = Self::from_toml(&text, &path.display().to_string())?;
        let folder = path.parent().unwrap_or(Path::new(""));
        scenario.correction.read_estimate(folder)?;
        Ok(scenario)
    }

    fn of(root: &Section<'_>, file: &str) -> Result<Self, Located> {
        let plain = Self::default();
        let motion = root
            .read("motion", motion)?
            .ok_or_else(|| root.missing("[motion]", "commanded motion of the arm"))?;
        Ok(Self {
            file: file.into(),
            name: root.text("name")?.unwrap_or_else(|| {
                let stem = std::path::Path::new(file).file_stem();
                stem.map_or(plain.name, |s| s.to_string_lossy().into_owned())
            }),
            robot: root.text("robot")?,
            duration_s: root.number("duration_s", Bound::Positive)?,
            settle_s: root
                .number("settle_s", Bound::NotNegative)?
                .unwrap_or(plain.settle_s),
            seed: root.count("seed")?.unwrap_or(plain.seed),
            robot_seed: root.count("robot_seed")?,
            sample_rate_hz: root
                .number("sample_rate_hz", Bound::Positive)?
                .unwrap_or(plain.sample_rate_hz),
            integration_step_s: root
                .number("integration_step_s", Bound::Within(1e-6, 2e-3))?
                .unwrap_or(plain.integration_step_s),
            control_rate_hz: root
                .number("control_rate_hz", Bound::Positive)?
                .unwrap_or(plain.control_rate_hz),
            start_time_ns: match root.count("start_time_ns")? {
                None => plain.start_time_ns,
                Some(ns) => i64::try_from(ns)
                    .map_err(|_| root.invalid("start_time_ns", "a time before the year 2262"))?,
            },
            controller: root.read("controller", controller)?.unwrap_or_default(),
            correction: root.read("correction", correction)?.unwrap_or_default(),
            contact_detection: root
                .read("contact_detection", contact_detection)?
                .unwrap_or_default(),
            motion,
            co_contraction: root.read("co_contraction", co_contraction)?,
            truth: root.read("truth", truth)?.unwrap_or_default(),
            joint_friction: root.read("joint_friction", friction)?.unwrap_or_default(),
            motor_friction: root.read("motor_friction", friction)?.unwrap_or_default(),
            encoder: root.read("encoder", encoder)?.unwrap_or_default(),
            motor_torque: root
                .read("motor_torque", torque_channel)?
                .unwrap_or_default(),
            torque_sensor: root
                .read("torque_sensor", torque_channel)?
                .unwrap_or_default(),
            tension_sensor: root
                .read("tension_sensor", tension_channel)?
                .unwrap_or_default(),
            velocity_noise_rad_per_s: root
                .number("velocity_noise_rad_per_s", Bound::NotNegative)?
                .unwrap_or(0.0),
            temperature: root.read("temperature", temperature)?.unwrap_or_default(),
            payloads: root.each("payloads", payload)?,
            contacts: root.each("contacts", contact)?,
            random_contacts: root.read("random_contacts", random_contacts)?,
            offsets: root.each("offsets", offset)?,
            jams: root.each("jams", jam)?,
            stops: root.each("stops", stop)?,
            sessions: root.each("sessions", session)?,
            record: root.read("record", record)?.unwrap_or_default(),
            faults: root.read("faults", faults)?.unwrap_or_default(),
        })
    }

    fn check_rates(&self, root: &Section<'_>) -> Result<(), Located> {
        let whole = |rate: f64| self.steps_per(rate).is_some();
        let must = "a rate whose period is a multiple of integration_step_s";
        if !whole(self.control_rate_hz) {
            return Err(root.invalid("control_rate_hz", must));
        }
        if !whole(self.sample_rate_hz) {
            return Err(root.invalid("sample_rate_hz", must));
        }
        Ok(())
    }

    /// Integration steps in a period of `rate_hz`, if that is a whole number.
    pub fn steps_per(&self, rate_hz: f64) -> Option<u64> {
        let steps = 1.0 / (rate_hz * self.integration_step_s);
        // Rates and steps are decimal numbers with a few digits; 1e-6 separates a multiple from a near miss and is
        // far above rounding.
        ((steps - steps.round()).abs() < 1e-6 * steps && steps.round() >= 1.0)
            .then_some(steps.round() as u64)
    }
}

fn controller(s: &Section<'_>) -> Result<Controller, Located> {
    Ok(Controller {
        stiffness_nm_per_rad: per(s, "stiffness_nm_per_rad", Bound::NotNegative)?,
        damping_nm_s_per_rad: per(s, "damping_nm_s_per_rad", Bound::NotNegative)?,
    })
}

fn co_contraction(s: &Section<'_>) -> Result<CoContraction, Located> {
    let tension_n = s.need(
        "tension_n",
        Bound::NotNegative,
        "minimum tension of every strand",
    )?;
    let varies_n = s.number_or("varies_n", Bound::NotNegative, 0.0)?;
    let period_s = s.number("period_s", Bound::Positive)?;
    if varies_n > 0.0 && period_s.is_none() {
        return Err(s.missing("period_s", "period of the tension"));
    }
    Ok(CoContraction {
        tension_n,
        varies_n,
        period_s: period_s.unwrap_or(1.0),
    })
}

fn motion(s: &Section<'_>) -> Result<Motion, Located> {
    let kinds = "\"hold\", \"waypoints\", \"random\" or \"staircase\"";
    Ok(match s.text("kind")?.as_deref() {
        Some("hold") => Motion::Hold {
            pose_rad: per(s, "pose_rad", ANGLE)?,
        },
        Some("waypoints") => {
            let waypoints = s.each("waypoints", |w| {
                Ok(Waypoint {
                    pose_rad: per(w, "pose_rad", ANGLE)?,
                    move_s: w
                        .draw("move_s", Bound::Positive)?
                        .ok_or_else(|| w.missing("move_s", "duration of the move"))?,
                    pause_s: w
                        .draw("pause_s", Bound::NotNegative)?
                        .unwrap_or(Draw::Fixed(0.0)),
                })
            })?;
            if waypoints.is_empty() {
                return Err(s.missing("[[motion.waypoints]]", "at least one target pose"));
            }
            Motion::Waypoints {
                start_rad: per(s, "start_rad", ANGLE)?,
                waypoints,
                repeat: s.flag("repeat")?,
            }
        }
        Some("random") => Motion::Random {
            range_rad: per(s, "range_rad", ANGLE)?,
            move_s: s
                .draw("move_s", Bound::Positive)?
                .unwrap_or(Draw::Uniform { min: 0.9, max: 1.6 }),
            pause_s: s
                .draw("pause_s", Bound::NotNegative)?
                .unwrap_or(Draw::Uniform { min: 0.5, max: 1.2 }),
        },
        Some("staircase") => {
            let steps = s.count("steps")?.unwrap_or(4);
            if !(1..=100_000).contains(&steps) {
                return Err(s.invalid("steps", "between 1 and 100000"));
            }
            Motion::Staircase {
                joint: s
                    .text("joint")?
                    .ok_or_else(|| s.missing("joint", "joint that moves"))?,
                line: s.line(),
                from_rad: s.number("from_rad", ANGLE)?.unwrap_or(0.0),
                to_rad: s.number("to_rad", ANGLE)?.unwrap_or(PI / 2.0),
                steps: steps as usize,
                move_s: s
                    .draw("move_s", Bound::Positive)?
                    .ok_or_else(|| s.missing("move_s", "duration of a move"))?,
                pause_s: s
                    .draw("pause_s", Bound::NotNegative)?
                    .ok_or_else(|| s.missing("pause_s", "rest after a move"))?,
                pose_rad: per(s, "pose_rad", ANGLE)?,
                there_and_back: s.flag("there_and_back")?,
                repeat: s.flag("repeat")?,
            }
        }
        _ => return Err(s.invalid("kind", kinds)),
    })
}

fn truth(s: &Section<'_>) -> Result<Truth, Located> {
    // A factor outside this range indicates a wrong unit.
    let factor = Bound::Within(0.05, 20.0);
    Ok(Truth {
        stiffness_factor: per(s, "stiffness_factor", factor)?,
        // A factor of 0 is a torn tendon.
        stiffness_later_factor: per(s, "stiffness_later_factor", Bound::Within(0.0, 20.0))?,
        stiffness_later_from_s: s
            .number("stiffness_later_from_s", Bound::NotNegative)?
            .unwrap_or(0.0),
        mass_factor: per(s, "mass_factor", factor)?,
        com_factor: per(s, "com_factor", factor)?,
        com_across_fraction: per(s, "com_across_fraction", Bound::Within(-1.0, 1.0))?,
        inertia_factor: per(s, "inertia_factor", factor)?,
        motor_inertia_factor: per(s, "motor_inertia_factor", factor)?,
        pretension_factor: per(s, "pretension_factor", factor)?,
        spring_cubic_per_rad2: per(s, "spring_cubic_per_rad2", Bound::NotNegative)?,
        viscoelastic_fraction: per(s, "viscoelastic_fraction", Bound::Within(0.0, 1.0))?,
        viscoelastic_time_s: per(s, "viscoelastic_time_s", Bound::Positive)?,
    })
}

fn friction(s: &Section<'_>) -> Result<FrictionSpec, Located> {
    Ok(FrictionSpec {
        coulomb_nm: per(s, "coulomb_nm", Bound::NotNegative)?,
        torque_fraction: per(s, "torque_fraction", Bound::Within(0.0, 0.9))?,
        viscous_nm_s_per_rad: per(s, "viscous_nm_s_per_rad", Bound::NotNegative)?,
        presliding_rad: per(s, "presliding_rad", Bound::Within(1e-6, 1.0))?,
    })
}

fn encoder(s: &Section<'_>) -> Result<Encoder, Located> {
    let number =
        |key| -> Result<f64, Located> { Ok(s.number(key, Bound::NotNegative)?.unwrap_or(0.0)) };
    let joint_bits = match s.count("joint_bits")? {
        None => None,
        Some(bits @ 4..=40) => Some(bits as u32),
        Some(_) => return Err(s.invalid("joint_bits", "between 4 and 40")),
    };
    Ok(Encoder {
        joint_bits,
        once_per_turn_rad: per(s, "once_per_turn_rad", Bound::Any)?,
        twice_per_turn_rad: per(s, "twice_per_turn_rad", Bound::Any)?,
        joint_noise_rad: number("joint_noise_rad")?,
        motor_resolution_rad: number("motor_resolution_rad")?,
        motor_noise_rad: number("motor_noise_rad")?,
        // A larger error is not a plausible gear ratio error.
        motor_scale_error: per(s, "motor_scale_error", Bound::Within(-0.5, 0.5))?,
        motor_delay_s: s
            .number("motor_delay_s", Bound::Within(0.0, 10.0))?
            .unwrap_or(0.0),
    })
}

fn torque_channel(s: &Section<'_>) -> Result<TorqueChannel, Located> {
    Ok(TorqueChannel {
        scale_error: per(s, "scale_error", Bound::Any)?,
        offset_nm: per(s, "offset_nm", Bound::Any)?,
        ripple_nm: per(s, "ripple_nm", Bound::Any)?,
        ripple_per_rad: s
            .number("ripple_per_rad", Bound::NotNegative)?
            .unwrap_or(0.0),
        noise_nm: s.number("noise_nm", Bound::NotNegative)?.unwrap_or(0.0),
    })
}

fn tension_channel(s: &Section<'_>) -> Result<TensionChannel, Located> {
    Ok(TensionChannel {
        scale_error: per(s, "scale_error", Bound::Any)?,
        offset_n: per(s, "offset_n", Bound::Any)?,
        noise_n: s.number_or("noise_n", Bound::NotNegative, 0.0)?,
    })
}

fn temperature(s: &Section<'_>) -> Result<Temperature, Located> {
    let plain = Temperature::default();
    let celsius = Bound::Within(-60.0, 200.0);
    let from = s
        .number("change_from_s", Bound::NotNegative)?
        .unwrap_or(0.0);
    let to = s.number("change_to_s", Bound::NotNegative)?.unwrap_or(from);
    if to < from {
        return Err(s.invalid("change_to_s", "at least change_from_s"));
    }
    let zero = Draw::Fixed(0.0);
    Ok(Temperature {
        reference_c: s
            .number("reference_c", celsius)?
            .unwrap_or(plain.reference_c),
        profile_c: s.pairs("profile_c", celsius)?,
        change_k: s
            .draw("change_k", Bound::Within(-100.0, 100.0))?
            .unwrap_or(zero),
        change_from_to_s: (from, to),
        reading_error_k: s.draw("reading_error_k", Bound::Any)?.unwrap_or(zero),
        reading_error_from_s: s
            .number("reading_error_from_s", Bound::NotNegative)?
            .unwrap_or(0.0),
        // A larger value could change the sign of the stiffness within the allowed temperatures.
        stiffness_per_k: per(s, "stiffness_per_k", Bound::Within(-0.0035, 0.0035))?,
        zero_drift_rad_per_k: per(s, "zero_drift_rad_per_k", Bound::Any)?,
    })
}
