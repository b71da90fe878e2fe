//! Tolerances of a robot's description, as on a data sheet.

use crate::Gaussian;

/// Tolerances, as standard deviations unless stated. `robot.toml` sets them under `[tolerances]`.
///
/// The defaults are assumed values for light rope-driven arms, not measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Relative standard deviation of the stiffness.
    pub stiffness: f64,
    /// Link mass, relative.
    pub mass: f64,
    /// First mass moment, relative to its size, along itself.
    pub first_moment: f64,
    /// First mass moment across, relative to its size.
    pub first_moment_across: f64,
    /// Relative standard deviation of the inertia.
    pub inertia: f64,
    /// Friction of joints and drives, relative to its nominal value.
    pub friction: f64,
    /// Torque-proportional joint friction.
    pub load_friction: Gaussian,
    /// Torque-proportional drive friction.
    pub drive_load_friction: Gaussian,
    /// Cubic stiffening `η`, 1/rad².
    pub stiffening_per_rad2: Gaussian,
    /// Encoder error in the first and second harmonic of the joint position, rad per component.
    pub encoder_rad: f64,
    /// Drift of the encoder zero offset with temperature in addition to rope and frame, rad/K;
    /// `None`: unspecified.
    pub drift_rad_per_k: Option<f64>,
    /// Compliance change with temperature, 1/K.
    pub stiffness_per_k: Gaussian,
    /// Payload mass, kg.
    pub payload_kg: Gaussian,
    /// Distance of the payload's centre of mass from its expected point, m.
    pub payload_reach_m: f64,
    /// Scale of the motor torque, relative.
    pub motor_torque: f64,
    /// Torque constant of motors whose current is recorded, relative: in the place of `motor_torque`.
    pub motor_current: f64,
    /// Share of the deflection that a rope creeps after within half a minute.
    pub viscoelastic: f64,
    /// Gear ratio, relative.
    pub gear: f64,
    /// Moment arm of a tendon at a joint other than its own, relative.
    pub moment_arm: f64,
    /// Encoder zero offset directly after tensioning, rad: `theta − q` of an unloaded spring; 0 if
    /// the encoders are zeroed then.
    pub zero_rad: f64,
    /// Temperature of a recording without temperature data, relative to the usual temperature, K.
    pub temperature_k: f64,
    /// Constant external force at the tool, along each axis, N; 0: none acts.
    pub external_force_n: f64,
    /// Pretension of a strand that only pulls, relative.
    pub pretension: f64,
    /// Stiffness of a joint's passive spring, relative.
    pub spring: f64,
    /// Rest position of a joint's passive spring, rad.
    pub spring_rest_rad: f64,
    /// Gain of a tension sensor, and its zero relative to the pretension.
    pub tension_sensor: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self {
            stiffness: 0.12,
            mass: 0.06,
            first_moment: 0.065,
            first_moment_across: 0.03,
            inertia: 0.15,
            friction: 0.5,
            load_friction: Gaussian::new(0.02, 0.01),
            drive_load_friction: Gaussian::new(0.1, 0.05),
            stiffening_per_rad2: Gaussian::new(1.0, 0.7),
            encoder_rad: 0.25e-3,
            drift_rad_per_k: None,
            stiffness_per_k: Gaussian::new(0.002, 0.001),
            payload_kg: Gaussian::new(0.25, 0.25),
            payload_reach_m: 0.05,
            motor_torque: 0.03,
            motor_current: 0.1,
            viscoelastic: 0.02,
            gear: 0.003,
            moment_arm: 0.01,
            zero_rad: 0.0,
            temperature_k: 5.0,
            external_force_n: 2.0,
            pretension: 0.2,
            spring: 0.1,
            spring_rest_rad: 0.05,
            tension_sensor: 0.02,
        }
    }
}

impl Tolerances {
    /// Drift of the zero with temperature where none is stated, rad/K.
    pub const DRIFT_RAD_PER_K: f64 = 0.1e-3;

    /// Returns the drift of the encoder zero offset with temperature in addition to rope and frame,
    /// rad/K.
    #[must_use]
    pub fn drift_rad_per_k(&self) -> f64 {
        self.drift_rad_per_k.unwrap_or(Self::DRIFT_RAD_PER_K)
    }

    /// Keys of `robot.toml`, with the unit in the name; means where a value has one.
    pub const KEYS: [&'static str; 29] = [
        "stiffness_percent",
        "mass_percent",
        "first_moment_percent",
        "first_moment_across_percent",
        "inertia_percent",
        "friction_percent",
        "load_friction_mean_percent",
        "load_friction_percent",
        "drive_load_friction_mean_percent",
        "drive_load_friction_percent",
        "stiffening_mean_per_rad2",
        "stiffening_per_rad2",
        "encoder_mrad",
        "drift_mrad_per_k",
        "payload_mean_kg",
        "payload_kg",
        "payload_reach_mm",
        "motor_torque_percent",
        "motor_current_percent",
        "viscoelastic_percent",
        "gear_percent",
        "moment_arm_percent",
        "zero_mrad",
        "temperature_k",
        "external_force_n",
        "pretension_percent",
        "spring_percent",
        "spring_rest_mrad",
        "tension_sensor_percent",
    ];

    /// Returns the field of a key, and the factor of its unit.
    #[cfg(feature = "urdf")]
    pub(crate) fn slot(&mut self, key: &str) -> Option<(&mut f64, f64)> {
        const PERCENT: f64 = 0.01;
        const MILLI: f64 = 1e-3;
        Some(match key {
            "stiffness_percent" => (&mut self.stiffness, PERCENT),
            "mass_percent" => (&mut self.mass, PERCENT),
            "first_moment_percent" => (&mut self.first_moment, PERCENT),
            "first_moment_across_percent" => (&mut self.first_moment_across, PERCENT),
            "inertia_percent" => (&mut self.inertia, PERCENT),
            "friction_percent" => (&mut self.friction, PERCENT),
            "load_friction_mean_percent" => (&mut self.load_friction.mean, PERCENT),
            "load_friction_percent" => (&mut self.load_friction.std, PERCENT),
            "drive_load_friction_mean_percent" => (&mut self.drive_load_friction.mean, PERCENT),
            "drive_load_friction_percent" => (&mut self.drive_load_friction.std, PERCENT),
            "stiffening_mean_per_rad2" => (&mut self.stiffening_per_rad2.mean, 1.0),
            "stiffening_per_rad2" => (&mut self.stiffening_per_rad2.std, 1.0),
            "encoder_mrad" => (&mut self.encoder_rad, MILLI),
            "drift_mrad_per_k" => (self.drift_rad_per_k.get_or_insert_default(), MILLI),
            "payload_mean_kg" => (&mut self.payload_kg.mean, 1.0),
            "payload_kg" => (&mut self.payload_kg.std, 1.0),
            "payload_reach_mm" => (&mut self.payload_reach_m, MILLI),
            "viscoelastic_percent" => (&mut self.viscoelastic, PERCENT),
            "gear_percent" => (&mut self.gear, PERCENT),
            "moment_arm_percent" => (&mut self.moment_arm, PERCENT),
            "zero_mrad" => (&mut self.zero_rad, MILLI),
            "temperature_k" => (&mut self.temperature_k, 1.0),
            "external_force_n" => (&mut self.external_force_n, 1.0),
            "pretension_percent" => (&mut self.pretension, PERCENT),
            "spring_percent" => (&mut self.spring, PERCENT),
            "spring_rest_mrad" => (&mut self.spring_rest_rad, MILLI),
            "tension_sensor_percent" => (&mut self.tension_sensor, PERCENT),
            "motor_torque_percent" => (&mut self.motor_torque, PERCENT),
            "motor_current_percent" => (&mut self.motor_current, PERCENT),
            _ => return None,
        })
    }
}

#[cfg(all(test, feature = "urdf"))]
mod tests {
    use super::*;

    #[test]
    fn toml_key_sets_separate_field() {
        let mut tolerances = Tolerances::default();
        for (value, key) in (1_u8..).zip(Tolerances::KEYS) {
            let (slot, _) = tolerances.slot(key).unwrap();
            *slot = value.into();
        }
        for (value, key) in (1_u8..).zip(Tolerances::KEYS) {
            let (slot, _) = tolerances.slot(key).unwrap();
            assert_eq!(*slot, f64::from(value), "{key}");
        }
        assert!(tolerances.slot("stiffness").is_none());
    }
}
