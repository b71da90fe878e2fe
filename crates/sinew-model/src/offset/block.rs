//! Block of averaged samples, 0.2 s long.

use super::effects::ENCODER;
use alloc::vec::Vec;

/// Signals that are averaged.
const SUMS: usize = 20;
/// Motion of a joint below this is a rest phase, rad: well above the encoder resolution and the presliding displacement
/// of friction.
pub(crate) const REST_RAD: f64 = 0.01;
/// Minimum duration of a long rest phase, s; a shorter one counts as motion.
const LONG_REST_S: f64 = 3.0;

/// Averages over one block.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Block {
    /// Middle of the block, s since the first sample.
    pub time_s: f64,
    /// Time at rest up to the end of the block, s, in which no joint has moved by 10 mrad.
    pub stood_s: f64,
    /// Number of passages through a similar motion in the recording; 1 if they are not counted.
    pub visits: f64,
    /// Filtered joint position at the end of the block, `n`, rad.
    pub q: Vec<f64>,
    /// Filtered `theta_measured − q`, `n`, rad.
    pub y: Vec<f64>,
    /// `y` with a memory of half a minute, which the viscoelastic part of the deflection follows, `n`, rad.
    pub y_slow: Vec<f64>,
    /// `(theta_measured − q)²`, filtered like `y`, `n`, rad².
    pub y_square: Vec<f64>,
    /// `(theta_measured − q)³`, filtered like `y`, `n`, rad³: a spring that stiffens.
    pub y_cube: Vec<f64>,
    /// Regressor `Φ` of the base parameters ([`crate::arm::BaseParameters`]), row-major `n × r`, N·m per parameter
    /// unit.
    pub phi: Vec<f64>,
    /// Joint position like `y`, `n`, rad.
    pub turned: Vec<f64>,
    /// Friction state, −1…1, `n`, where it is determined.
    pub z: Vec<f64>,
    /// Half-width of the possible range of `z`: 1 until the joint has moved, 0 once it has slid, `n`.
    pub z_unknown: Vec<f64>,
    /// Joint velocity, `n`, rad/s.
    pub dq: Vec<f64>,
    /// Friction state times the size of the spring's torque over its stiffness, `n`, rad.
    pub z_load: Vec<f64>,
    /// Sine and cosine of `q` and `2q`, `n × 4`.
    pub encoder: Vec<f64>,
    /// Temperature, °C; NaN where not recorded.
    pub temperature_c: f64,
    /// Filtered motor torque, `n`, N·m; NaN where not recorded.
    pub motor_torque: Vec<f64>,
    /// Filtered motor acceleration, `n`, rad/s².
    pub motor_acceleration: Vec<f64>,
    /// Motor velocity, `n`, rad/s.
    pub motor_velocity: Vec<f64>,
    /// Friction state of the drive, −1…1, `n`.
    pub motor_z: Vec<f64>,
    /// Friction state of the drive times the size of the spring's torque over its stiffness,
    /// `n`, rad.
    pub motor_z_load: Vec<f64>,
    /// Share of the time in which the motor was at rest, 0…1, `n`; its friction is unknown at rest.
    pub motor_stood: Vec<f64>,
    /// Filtered torque of each tendon by its tension sensor, `n` where a group has one equation per joint, N·m; NaN where not recorded.
    pub tension_nm: Vec<f64>,
    /// Moment arms that vary with the position, filtered like `y`, one entry each, rad of the tendon's coordinate per rad of the joint.
    pub arm: Vec<f64>,
    /// Variable moment arms multiplied by the deflection of their tendon, rad.
    pub arm_y: Vec<f64>,
}

/// Copies the common length of two slices; unlike `copy_from_slice` it cannot panic.
pub(crate) fn copy(to: &mut [f64], from: &[f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

impl Block {
    pub(crate) fn zero(n: usize, columns: usize) -> Self {
        let zero = || alloc::vec![0.0; n];
        Self {
            time_s: 0.0,
            stood_s: 0.0,
            visits: 1.0,
            q: zero(),
            y: zero(),
            y_slow: zero(),
            y_square: zero(),
            y_cube: zero(),
            phi: alloc::vec![0.0; n * columns],
            turned: zero(),
            z: zero(),
            z_unknown: zero(),
            dq: zero(),
            z_load: zero(),
            encoder: alloc::vec![0.0; n * ENCODER],
            temperature_c: 0.0,
            motor_torque: zero(),
            motor_acceleration: zero(),
            motor_velocity: zero(),
            motor_z: zero(),
            motor_z_load: zero(),
            motor_stood: zero(),
            tension_nm: Vec::new(),
            arm: Vec::new(),
            arm_y: Vec::new(),
        }
    }

    /// Whether the arm has been at rest for so long that friction may have reversed since the motion.
    ///
    /// A controller that settles slowly lets a joint creep back within the presliding displacement. Short rest phases
    /// count as motion: their effect is part of the noise.
    pub(crate) fn rests_long(&self) -> bool {
        self.stood_s >= LONG_REST_S
    }

    /// Excludes joint `i`, whose motor and joint do not drive each other: the block then has no equation of it.
    pub fn exclude(&mut self, i: usize) {
        for column in [&mut self.y, &mut self.motor_torque] {
            if let Some(value) = column.get_mut(i) {
                *value = f64::NAN;
            }
        }
    }

    /// Whether joint `i` is [excluded](Self::exclude).
    pub(crate) fn is_excluded(&self, i: usize) -> bool {
        self.y.get(i).is_none_or(|y| y.is_nan())
    }

    /// Memory it takes, bytes.
    pub fn bytes(&self) -> usize {
        let numbers: usize = self.columns().iter().map(|column| column.len()).sum();
        size_of::<Self>() + size_of::<f64>() * (numbers + self.q.len())
    }

    /// Whether it is of an arm of `joints` with `columns` base parameters.
    #[cfg(feature = "wire")]
    pub(crate) fn is_of(&self, joints: usize, columns: usize) -> bool {
        let n = joints;
        let mut expected = [n; SUMS];
        // Their places in `columns`.
        let [
            _,
            _,
            _,
            _,
            phi,
            _,
            _,
            _,
            _,
            _,
            encoder,
            ..,
            tension,
            arm,
            arm_y,
        ] = &mut expected;
        (*phi, *encoder) = (n * columns, n * ENCODER);
        // Blocks on a wire are of robots with an equation per tendon.
        (*tension, *arm, *arm_y) = (0, 0, 0);
        let mut lengths = self.columns().into_iter().zip(expected);
        self.q.len() == n && lengths.all(|(column, length)| column.len() == length)
    }

    /// Whether all values are finite, except a motor torque and a temperature that were not recorded.
    #[cfg(feature = "wire")]
    pub(crate) fn is_finite(&self) -> bool {
        let Self {
            time_s,
            stood_s,
            visits,
            q,
            y,
            y_slow,
            y_square,
            y_cube,
            phi,
            turned,
            z,
            z_unknown,
            dq,
            z_load,
            encoder,
            temperature_c: _,
            motor_torque: _,
            motor_acceleration,
            motor_velocity,
            motor_z,
            motor_z_load,
            motor_stood,
            tension_nm: _,
            arm,
            arm_y,
        } = self;
        let link = [
            q, y, y_slow, y_square, y_cube, phi, turned, z, z_unknown, dq, z_load, encoder, arm,
            arm_y,
        ];
        let motor = [
            motor_acceleration,
            motor_velocity,
            motor_z,
            motor_z_load,
            motor_stood,
        ];
        let mut values = link.into_iter().chain(motor).flatten();
        let own = [time_s, stood_s, visits];
        own.into_iter().all(|x| x.is_finite()) && values.all(|x| x.is_finite())
    }

    /// Makes this the same as `other`, which must be of an arm of the same size.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn copy_from(&mut self, other: &Self) {
        self.time_s = other.time_s;
        self.stood_s = other.stood_s;
        self.visits = other.visits;
        self.temperature_c = other.temperature_c;
        copy(&mut self.q, &other.q);
        for (to, from) in self.sums().into_iter().zip(other.columns()) {
            copy(to, from);
        }
    }

    /// Returns the columns of [`Block::sums`], read-only.
    fn columns(&self) -> [&[f64]; SUMS] {
        [
            &self.y,
            &self.y_slow,
            &self.y_square,
            &self.y_cube,
            &self.phi,
            &self.turned,
            &self.z,
            &self.z_unknown,
            &self.dq,
            &self.z_load,
            &self.encoder,
            &self.motor_torque,
            &self.motor_acceleration,
            &self.motor_velocity,
            &self.motor_z,
            &self.motor_z_load,
            &self.motor_stood,
            &self.tension_nm,
            &self.arm,
            &self.arm_y,
        ]
    }

    /// Returns the quantities that are averaged over a block.
    pub(crate) fn sums(&mut self) -> [&mut Vec<f64>; SUMS] {
        [
            &mut self.y,
            &mut self.y_slow,
            &mut self.y_square,
            &mut self.y_cube,
            &mut self.phi,
            &mut self.turned,
            &mut self.z,
            &mut self.z_unknown,
            &mut self.dq,
            &mut self.z_load,
            &mut self.encoder,
            &mut self.motor_torque,
            &mut self.motor_acceleration,
            &mut self.motor_velocity,
            &mut self.motor_z,
            &mut self.motor_z_load,
            &mut self.motor_stood,
            &mut self.tension_nm,
            &mut self.arm,
            &mut self.arm_y,
        ]
    }
}
