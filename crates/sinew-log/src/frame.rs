//! Measured values at one time stamp, and the quantities of a recording.

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
    /// Temperature of the rope, °C.
    Temperature,
    /// Tension of a tendon, N.
    Tension,
}

impl Quantity {
    /// All quantities, in storage order.
    pub(crate) const ALL: [Quantity; 8] = [
        Quantity::Q,
        Quantity::Theta,
        Quantity::Dq,
        Quantity::TauEl,
        Quantity::TauM,
        Quantity::TauExt,
        Quantity::Temperature,
        Quantity::Tension,
    ];

    /// All quantities of a joint and its motor, in storage order; the tension is that of a tendon.
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
            Quantity::Tension => "tension",
        }
    }

    /// The unit suffix of the column that stores it.
    pub fn suffix(self) -> &'static str {
        match self {
            Quantity::Q | Quantity::Theta => "_rad",
            Quantity::Dq => "_rad_s",
            Quantity::TauEl | Quantity::TauM | Quantity::TauExt => "_nm",
            Quantity::Temperature => "_c",
            Quantity::Tension => "_n",
        }
    }

    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

/// Names of one entry of a frame's arrays: a joint, its motor, and a tendon.
///
/// A robot with more tendons than joints has axes without a joint. There `q` is 0 rad in every frame and `dq`
/// is 0 rad/s in every frame with a `dq` of any joint, so that a motor moves relative to a fixed reference;
/// `tau_el` and `tau_ext` are absent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Axis<'a> {
    /// Joint under whose name `q`, rad, `dq`, rad/s, `tau_el` and `tau_ext`, N·m, are recorded.
    pub joint: Option<&'a str>,
    /// Motor at whose shaft position, rad, and torque, N·m, are measured, and under whose name they are
    /// recorded. `None` with a joint: those under the name of the joint, reflected to it.
    pub motor: Option<&'a str>,
    /// Tendon under whose name the tension, N, is recorded. `None`: the axis has no tension.
    pub tendon: Option<&'a str>,
}

impl<'a> Axis<'a> {
    /// A joint whose motor has its name and is reflected to it, without a tension.
    pub fn of_joint(joint: &'a str) -> Self {
        Self {
            joint: Some(joint),
            ..Self::default()
        }
    }

    /// Display name: the joint, otherwise the motor, otherwise the tendon; empty if the axis has no name.
    pub fn name(&self) -> &'a str {
        let names = [self.joint, self.motor, self.tendon];
        names.into_iter().flatten().next().unwrap_or_default()
    }
}

impl Axis<'_> {
    /// Kind and name of an entry that an earlier axis has too.
    pub(crate) fn taken(&self, before: &[Axis<'_>]) -> Option<(&'static str, &str)> {
        fn names<'n>(axis: &Axis<'n>) -> [(&'static str, Option<&'n str>); 3] {
            let joint = ("joint", axis.joint);
            [joint, ("motor", axis.motor), ("tendon", axis.tendon)]
        }
        let own = names(self).into_iter().enumerate();
        let mut own = own.filter_map(|(kind, (what, name))| Some((kind, what, name?)));
        let is_taken = |kind: usize, name| before.iter().any(|b| names(b)[kind].1 == Some(name));
        let (_, what, name) = own.find(|(kind, _, name)| is_taken(*kind, *name))?;
        Some((what, name))
    }

    pub(crate) fn is_nameless(&self) -> bool {
        *self == Self::default()
    }
}

/// An [`Axis`] that owns its names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct OwnedAxis {
    /// Joint under whose name `q`, rad, `dq`, rad/s, `tau_el` and `tau_ext`, N·m, are recorded.
    pub joint: Option<String>,
    /// Motor at whose shaft position, rad, and torque, N·m, are measured. `None` with a joint: one of the
    /// joint's name, reflected to it.
    pub motor: Option<String>,
    /// Tendon whose tension, N, is measured.
    pub tendon: Option<String>,
}

impl OwnedAxis {
    /// Returns the axis with borrowed names.
    pub fn axis(&self) -> Axis<'_> {
        Axis {
            joint: self.joint.as_deref(),
            motor: self.motor.as_deref(),
            tendon: self.tendon.as_deref(),
        }
    }
}

impl From<Axis<'_>> for OwnedAxis {
    fn from(axis: Axis<'_>) -> Self {
        let owned = |name: Option<&str>| name.map(str::to_owned);
        Self {
            joint: owned(axis.joint),
            motor: owned(axis.motor),
            tendon: owned(axis.tendon),
        }
    }
}

/// Names of one entry of the frames, as they are recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct AxisNames {
    pub(crate) joint: Option<String>,
    pub(crate) motor: Option<String>,
    pub(crate) tendon: Option<String>,
    /// Whether the motor position is reflected to the joint, so that both move equally; otherwise it is that
    /// at its shaft.
    pub(crate) is_reflected: bool,
}

impl AxisNames {
    /// Axes of joints whose motors have names of their own, reflected to them.
    pub(crate) fn of_joints(joints: &[String]) -> Vec<Self> {
        let axes = joints.iter().map(|joint| Axis::of_joint(joint));
        axes.map(Self::new).collect()
    }

    pub(crate) fn new(axis: Axis<'_>) -> Self {
        let owned = |name: Option<&str>| name.map(str::to_owned);
        Self {
            joint: owned(axis.joint),
            motor: owned(axis.motor.or(axis.joint)),
            tendon: owned(axis.tendon),
            is_reflected: axis.motor.is_none() && axis.joint.is_some(),
        }
    }

    pub(crate) fn axis(&self) -> Axis<'_> {
        let motor = self.motor.as_deref();
        Axis {
            joint: self.joint.as_deref(),
            motor: motor.filter(|_| !self.is_reflected),
            tendon: self.tendon.as_deref(),
        }
    }

    /// Name under which a quantity is recorded.
    pub(crate) fn recorded(&self, quantity: Quantity) -> Option<&str> {
        let name = match quantity {
            Quantity::Theta | Quantity::TauM => &self.motor,
            Quantity::Tension => &self.tendon,
            _ => &self.joint,
        };
        name.as_deref()
    }
}

/// Blocks of a wide row of these axes, each of one value per axis, in storage order: tensions only if an axis
/// has a tendon.
pub(crate) fn blocks(axes: &[AxisNames]) -> &'static [Quantity] {
    match axes.iter().any(|axis| axis.tendon.is_some()) {
        true => &Quantity::ALL,
        false => &Quantity::ALL[..Quantity::Tension as usize],
    }
}

/// "Not recorded", distinguished from a recorded NaN by its payload.
///
/// Both reach the user as NaN; only the recorded one is counted as a bad sample.
pub const ABSENT: f64 = f64::from_bits(0x7ff8_5349_4e45_5701);

#[inline]
pub(crate) fn is_absent(value: f64) -> bool {
    value.to_bits() == ABSENT.to_bits()
}

/// Frame of a recording at one time stamp: all axes, SI units.
///
/// Every vector has the length `n` of the joints or axes selected (see
/// [`Recording::select`](crate::Recording::select)); NaN means "not recorded in
/// this frame". If an axis has no joint, `q` is 0 (see [`Axis`]). Infinite values never occur: they are
/// counted and become NaN.
/// For a prismatic joint read rad as m and N·m as N.
#[derive(Debug, PartialEq, Default)]
pub struct Frame {
    /// Time since the epoch of the recording's clock, ns. In a recording it increases from frame to frame: after a
    /// step of the clock it continues from the frame before.
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
    /// Temperature of the rope, °C.
    pub temperature_c: f64,
    /// Tension of the tendon of each axis, N.
    pub tension: Vec<f64>,
}

/// Copying over another frame reuses its allocation, because readers return millions of frames.
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
        self.tension.clone_from(&of.tension);
    }
}

impl Frame {
    /// A frame of `n` axes at time zero in which nothing is recorded.
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
            tau_ext: nothing.clone(),
            temperature_c: f64::NAN,
            tension: nothing,
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
            Quantity::Tension => &self.tension,
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
            Quantity::Tension => &mut self.tension,
        }
    }
}

/// Set of recorded quantities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Quantities {
    /// Whether the joint position is recorded.
    pub q: bool,
    /// Whether the motor position, reflected to the joint, is recorded.
    pub theta: bool,
    /// Whether the joint velocity is recorded.
    pub dq: bool,
    /// Whether the elastic joint torque is recorded.
    pub tau_el: bool,
    /// Whether the motor torque is recorded.
    pub tau_m: bool,
    /// Whether the external torque is recorded.
    pub tau_ext: bool,
    /// Whether the temperature of the rope is recorded.
    pub temperature: bool,
    /// Whether the tension of the tendon is recorded.
    pub tension: bool,
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
            Quantity::Tension => &mut self.tension,
        }
    }

    /// Copies the quantities measured at the motor from another set.
    pub(crate) fn take_motor(&mut self, of: Self) {
        for quantity in [Quantity::Theta, Quantity::TauM] {
            *self.place(quantity) = of.has(quantity);
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
        let all = Quantity::ALL.into_iter();
        all.filter(|quantity| self.has(*quantity))
    }
}

/// Recorded quantities of each joint or axis.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Channels {
    /// One entry per joint, in the order of [`Recording::joints`](crate::Recording::joints) (after `select`
    /// or `select_axes`: one per axis, in the selected order). `temperature` is per recording, see below.
    pub joints: Vec<Quantities>,
    /// Whether the recording has a temperature.
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
        for quantity in Quantity::ALL {
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
    fn clone_from_equals_source_and_reuses_allocation() {
        let mut from = Frame::new(3);
        from.time_ns = 7;
        from.segment = 2;
        from.temperature_c = 21.0;
        for (k, quantity) in Quantity::PER_JOINT.into_iter().enumerate() {
            from.get_mut(quantity).fill(k as f64);
        }
        let mut to = Frame::new(3);
        from.tension.fill(40.0);
        let places = |frame: &Frame| Quantity::ALL.map(|q| frame.get(q).as_ptr());
        let before = places(&to);
        to.clone_from(&from);
        assert_eq!(to, from);
        assert_eq!(places(&to), before);
        assert_eq!(from.clone(), from);
    }
}
