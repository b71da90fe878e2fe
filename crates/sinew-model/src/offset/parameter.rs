//! The parameters of a state, by name.

/// Amplitudes of a joint's encoder error: sine and cosine once and twice per turn.
pub(crate) const ENCODER: usize = 4;

/// A joint's parameters, in their order in the state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum JointParameter {
    /// Offset `delta_e`, rad.
    Offset,
    /// Compliance over nominal, less one.
    Compliance,
    /// Cubic stiffening `η`, 1/rad².
    Stiffening,
    /// Coulomb friction of the joint, N·m.
    Coulomb,
    /// Viscous friction of the joint, N·m·s/rad.
    Viscous,
    /// Torque-proportional friction of the joint.
    LoadFriction,
    /// Drift of the zero with temperature, rad/K.
    Drift,
    /// Compliance change with temperature, 1/K.
    Thermal,
    /// First of the encoder's sine and cosine once and twice per turn, rad.
    Encoder,
    /// Scale error of the motor torque.
    MotorScale = Self::Encoder as usize + ENCODER,
    /// Offset of the motor torque, N·m.
    MotorBias,
    /// Coulomb friction of the drive, N·m.
    MotorCoulomb,
    /// Viscous friction of the drive, N·m·s/rad.
    MotorViscous,
    /// Torque-proportional friction of the drive.
    MotorLoadFriction,
    /// Half the dead zone of a slack antagonistic pair, rad.
    Slack,
    /// Where in −1…1 the friction of a joint stood when the recording began.
    Stuck,
    /// Share of the deflection that follows with a memory of half a minute.
    Viscoelastic,
    /// Error of the gear ratio, relative.
    Gear,
    /// What `theta_measured − q` shows of an unloaded spring right after tensioning, rad: where the
    /// encoders were zeroed.
    Zero,
}

/// Entries per joint.
pub(crate) const PER_JOINT: usize = JointParameter::Zero as usize + 1;
/// Payload: mass, and three first moments beside where it is expected.
pub(crate) const PAYLOAD: usize = 4;
/// A force from outside: along the axes of the base, and how far from where it is expected it acts.
pub(crate) const FORCE: usize = 6;
