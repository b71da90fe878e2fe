//! What was measured at one instant, and which quantities a recording holds.

use serde::{Deserialize, Serialize};

/// The quantities of a joint, in the order used inside the crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Link-side joint position, rad.
    Q,
    /// Motor position reflected to the joint, as measured, rad.
    Theta,
    /// Link-side joint velocity, rad/s.
    Dq,
    /// Elastic joint torque from a torque sensor, N·m.
    TauEl,
    /// Motor torque reflected to the joint, N·m.
    TauM,
    /// Known external torque, positive when applied to the robot, N·m.
    TauExt,
    /// Temperature, °C.
    Temperature,
}

impl Quantity {
    /// Every quantity that exists per joint, in storage order.
    pub const PER_JOINT: [Quantity; 6] = [
        Quantity::Q,
        Quantity::Theta,
        Quantity::Dq,
        Quantity::TauEl,
        Quantity::TauM,
        Quantity::TauExt,
    ];

    /// The symbol as used in column names and messages.
    pub fn symbol(self) -> &'static str {
        match self {
            Quantity::Q => "q",
            Quantity::Theta => "theta",
            Quantity::Dq => "dq",
            Quantity::TauEl => "tau_el",
            Quantity::TauM => "tau_m",
            Quantity::TauExt => "tau_ext",
            Quantity::Temperature => "temperature",
        }
    }

    /// The unit suffix of the column that stores it.
    pub fn suffix(self) -> &'static str {
        match self {
            Quantity::Q | Quantity::Theta => "_rad",
            Quantity::Dq => "_rad_s",
            Quantity::TauEl | Quantity::TauM | Quantity::TauExt => "_nm",
            Quantity::Temperature => "_c",
        }
    }

    pub(crate) fn index(self) -> usize {
        self as usize
    }

    /// Whether it is measured at the motor, and recorded under the name of the motor.
    pub(crate) fn is_of_motor(self) -> bool {
        matches!(self, Quantity::Theta | Quantity::TauM)
    }
}

/// Joint of the frames, with the motor whose position and torque the frames hold for it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct DrivenJoint {
    /// Name of the joint in the recording.
    pub(crate) joint: String,
    /// Name of the motor in the recording.
    pub(crate) motor: String,
    /// Whether the position of the motor is reflected to the joint, so that both move alike; otherwise it is that at its shaft.
    pub(crate) is_reflected: bool,
}

impl DrivenJoint {
    /// Joints with motors of their own names, reflected to them.
    pub(crate) fn of_joints(joints: &[String]) -> Vec<Self> {
        joints.iter().map(|joint| Self::new(joint, None)).collect()
    }

    /// Joint with the motor at whose shaft is measured; `None`: a motor of the joint's name, reflected to it.
    pub(crate) fn new(joint: &str, motor: Option<&str>) -> Self {
        Self {
            joint: joint.to_owned(),
            motor: motor.unwrap_or(joint).to_owned(),
            is_reflected: motor.is_none(),
        }
    }

    /// Name under which a quantity is recorded.
    pub(crate) fn recorded(&self, quantity: Quantity) -> &str {
        if quantity.is_of_motor() {
            &self.motor
        } else {
            &self.joint
        }
    }
}

/// How many blocks of `n` values a wide row has: six per joint and temperature.
pub(crate) const BLOCKS: usize = 7;

/// "Not recorded", told apart from a NaN that *was* recorded by its payload.
///
/// Both reach the user as NaN; only the recorded one is counted as a bad sample.
pub const ABSENT: f64 = f64::from_bits(0x7ff8_5349_4e45_5701);

#[inline]
pub(crate) fn is_absent(value: f64) -> bool {
    value.to_bits() == ABSENT.to_bits()
}

/// One instant of a recording: all joints, SI units.
///
/// Every vector has the length `n` of the joints selected (see
/// [`Recording::select`](crate::Recording::select)); NaN means "not recorded in
/// this frame". Infinite values never appear: they are counted and become NaN.
/// For a prismatic joint read rad as m and N·m as N.
#[derive(Debug, PartialEq, Default)]
pub struct Frame {
    /// Time since the epoch of the recording's clock, ns.
    pub time_ns: i64,
    /// Increases after each gap, clock jump or damage: reset filters there.
    pub segment: u32,
    /// Link-side joint position, rad, unwrapped.
    pub q: Vec<f64>,
    /// Motor position reflected to the joint, as measured, rad, unwrapped.
    pub theta: Vec<f64>,
    /// Link-side joint velocity, rad/s.
    pub dq: Vec<f64>,
    /// Elastic joint torque from a sensor, N·m, positive when it drives the link.
    pub tau_el: Vec<f64>,
    /// Motor torque reflected to the joint, N·m.
    pub tau_m: Vec<f64>,
    /// Known external torque, N·m, positive when applied to the robot.
    pub tau_ext: Vec<f64>,
    /// Temperature, °C.
    pub temperature_c: f64,
}

/// A copy over another frame takes its room: readers hand on millions.
impl Clone for Frame {
    fn clone(&self) -> Self {
        let mut copy = Frame::default();
        copy.clone_from(self);
        copy
    }

    fn clone_from(&mut self, of: &Self) {
        self.time_ns = of.time_ns;
        self.segment = of.segment;
        self.q.clone_from(&of.q);
        self.theta.clone_from(&of.theta);
        self.dq.clone_from(&of.dq);
        self.tau_el.clone_from(&of.tau_el);
        self.tau_m.clone_from(&of.tau_m);
        self.tau_ext.clone_from(&of.tau_ext);
        self.temperature_c = of.temperature_c;
    }
}

impl Frame {
    /// A frame of `n` joints at time zero in which nothing is recorded.
    pub fn new(n: usize) -> Self {
        let nothing = vec![f64::NAN; n];
        Frame {
            time_ns: 0,
            segment: 0,
            q: nothing.clone(),
            theta: nothing.clone(),
            dq: nothing.clone(),
            tau_el: nothing.clone(),
            tau_m: nothing.clone(),
            tau_ext: nothing,
            temperature_c: f64::NAN,
        }
    }

    /// The values of one quantity; temperature as a slice of one.
    pub fn get(&self, quantity: Quantity) -> &[f64] {
        match quantity {
            Quantity::Q => &self.q,
            Quantity::Theta => &self.theta,
            Quantity::Dq => &self.dq,
            Quantity::TauEl => &self.tau_el,
            Quantity::TauM => &self.tau_m,
            Quantity::TauExt => &self.tau_ext,
            Quantity::Temperature => std::slice::from_ref(&self.temperature_c),
        }
    }

    /// The values of one quantity, to be changed; temperature as a slice of one.
    pub fn get_mut(&mut self, quantity: Quantity) -> &mut [f64] {
        match quantity {
            Quantity::Q => &mut self.q,
            Quantity::Theta => &mut self.theta,
            Quantity::Dq => &mut self.dq,
            Quantity::TauEl => &mut self.tau_el,
            Quantity::TauM => &mut self.tau_m,
            Quantity::TauExt => &mut self.tau_ext,
            Quantity::Temperature => std::slice::from_mut(&mut self.temperature_c),
        }
    }
}

/// A set of quantities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Quantities {
    /// Link-side joint position.
    pub q: bool,
    /// Motor position reflected to the joint.
    pub theta: bool,
    /// Link-side joint velocity.
    pub dq: bool,
    /// Elastic joint torque.
    pub tau_el: bool,
    /// Motor torque.
    pub tau_m: bool,
    /// External torque.
    pub tau_ext: bool,
    /// Temperature of the rope.
    pub temperature: bool,
}

impl Quantities {
    /// Joint and motor position: the least an offset estimate needs.
    pub fn positions() -> Self {
        Quantities {
            q: true,
            theta: true,
            ..Quantities::default()
        }
    }

    fn place(&mut self, quantity: Quantity) -> &mut bool {
        match quantity {
            Quantity::Q => &mut self.q,
            Quantity::Theta => &mut self.theta,
            Quantity::Dq => &mut self.dq,
            Quantity::TauEl => &mut self.tau_el,
            Quantity::TauM => &mut self.tau_m,
            Quantity::TauExt => &mut self.tau_ext,
            Quantity::Temperature => &mut self.temperature,
        }
    }

    /// Takes what is measured at the motor from another set.
    pub(crate) fn take_motor(&mut self, of: Self) {
        for quantity in Quantity::PER_JOINT {
            if quantity.is_of_motor() {
                *self.place(quantity) = of.has(quantity);
            }
        }
    }

    /// Whether a quantity is in the set.
    pub fn has(mut self, quantity: Quantity) -> bool {
        *self.place(quantity)
    }

    /// Puts a quantity into the set.
    pub fn insert(&mut self, quantity: Quantity) {
        *self.place(quantity) = true;
    }

    /// The quantities in the set, in storage order.
    pub fn iter(&self) -> impl Iterator<Item = Quantity> + '_ {
        Quantity::PER_JOINT
            .into_iter()
            .chain([Quantity::Temperature])
            .filter(|quantity| self.has(*quantity))
    }
}

/// Which quantities are recorded for which joint.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Channels {
    /// One entry per joint, in the order of [`Recording::joints`](crate::Recording::joints)
    /// (after `select`: in the order selected). `temperature` is per recording, see below.
    pub joints: Vec<Quantities>,
    /// Whether the recording holds a temperature at all.
    pub temperature: bool,
}

impl Channels {
    /// Whether every joint has the quantity.
    pub fn all_have(&self, quantity: Quantity) -> bool {
        match quantity {
            Quantity::Temperature => self.temperature,
            _ => !self.joints.is_empty() && self.joints.iter().all(|joint| joint.has(quantity)),
        }
    }

    /// Whether any joint has the quantity.
    pub fn any_has(&self, quantity: Quantity) -> bool {
        match quantity {
            Quantity::Temperature => self.temperature,
            _ => self.joints.iter().any(|joint| joint.has(quantity)),
        }
    }

    /// The quantities that at least one joint has.
    pub fn union(&self) -> Quantities {
        let mut all = Quantities {
            temperature: self.temperature,
            ..Quantities::default()
        };
        for quantity in Quantity::PER_JOINT {
            if self.any_has(quantity) {
                all.insert(quantity);
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_over_a_frame_is_equal_and_takes_its_room() {
        let mut from = Frame::new(3);
        from.time_ns = 7;
        from.segment = 2;
        from.temperature_c = 21.0;
        for (k, quantity) in Quantity::PER_JOINT.into_iter().enumerate() {
            from.get_mut(quantity).fill(k as f64);
        }
        let mut to = Frame::new(3);
        let places = |frame: &Frame| Quantity::PER_JOINT.map(|q| frame.get(q).as_ptr());
        let before = places(&to);
        to.clone_from(&from);
        assert_eq!(to, from);
        assert_eq!(places(&to), before);
        assert_eq!(from.clone(), from);
    }
}
