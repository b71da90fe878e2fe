//! Values that are given or drawn, and the random streams they are drawn from.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use sinew_files::{Bound, Fields as _, Located, Section, Value};

/// Number of a scenario: fixed, or drawn once per recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Draw {
    /// Value without random variation.
    Fixed(f64),
    /// Anything between two ends, equally likely.
    Uniform {
        /// Lower end of the range.
        min: f64,
        /// Upper end of the range.
        max: f64,
    },
    /// Normal distribution, truncated to the range of the quantity.
    Normal {
        /// Mean of the distribution.
        mean: f64,
        /// Standard deviation of the distribution.
        std: f64,
        /// Bound of valid values of the quantity.
        bound: Bound,
    },
}

impl Draw {
    /// One value. Always takes numbers from `rng`, so that giving one value instead of drawing
    /// it leaves the others as they were.
    pub fn sample(&self, rng: &mut ChaCha8Rng) -> f64 {
        let u: f64 = rng.random();
        match *self {
            Self::Fixed(v) => v,
            Self::Uniform { min, max } => min + (max - min) * u,
            Self::Normal { mean, std, bound } => {
                // A separate stream: the number of redraws must not change the values after it.
                let mut own = ChaCha8Rng::seed_from_u64(u.to_bits());
                const MAX_DRAWS: usize = 1000;
                for _ in 0..MAX_DRAWS {
                    let z: f64 = StandardNormal.sample(&mut own);
                    let v = mean + std * z;
                    if bound.allows(v) {
                        return v;
                    }
                }
                mean
            }
        }
    }
}

/// One draw for all joints, or one by joint name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PerJoint {
    /// Value for every joint that is not named.
    pub all: Option<Draw>,
    /// Joint, its line in the file (0 when made in code), and its draw.
    pub by_joint: Vec<(String, u64, Draw)>,
}

impl PerJoint {
    /// Creates the same value for every joint.
    pub fn fixed(value: f64) -> Self {
        Self {
            all: Some(Draw::Fixed(value)),
            by_joint: Vec::new(),
        }
    }

    /// Creates a value for one joint, with the default for the others.
    pub fn one(joint: &str, value: f64) -> Self {
        Self {
            all: None,
            by_joint: vec![(joint.into(), 0, Draw::Fixed(value))],
        }
    }

    /// Draws one value per joint of `names`; uses `defaults` if the scenario specifies none.
    pub fn sample(&self, names: &[String], defaults: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
        names
            .iter()
            .zip(defaults)
            .map(|(name, &default)| {
                let own = self.by_joint.iter().find(|(n, _, _)| n == name);
                own.map(|(_, _, d)| *d)
                    .or(self.all)
                    .unwrap_or(Draw::Fixed(default))
                    .sample(rng)
            })
            .collect()
    }
}

/// Purpose of a random stream. Each purpose has a stream of its own, so that disabling one leaves all the others
/// unchanged.
#[derive(Debug, Clone, Copy)]
pub enum Stream {
    /// True parameters of the robot.
    Truth = 1,
    /// Motion of the robot.
    Motion = 2,
    /// Contacts with the environment.
    Contacts = 3,
    /// Noise of its sensors.
    Sensors = 4,
    /// Transmission faults of the recording.
    Faults = 5,
    /// Draws added in later versions, which must not change earlier ones.
    Later = 6,
    /// Errors of a correction.
    Correction = 7,
    /// Grip position of the payload.
    Grip = 8,
    /// Masses of the payloads.
    Payloads = 9,
    /// Sizes of the offsets.
    OffsetSizes = 10,
    /// Delays of the offsets.
    OffsetDelays = 11,
}

/// The stream of a seed.
pub fn rng(seed: u64, stream: Stream) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream as u64);
    rng
}

/// Draws a standard normal number.
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// The scenario's own ways to write a value.
pub(super) trait Keys {
    /// Reads a number, `{ min, max }` (uniform) or `{ mean, std }` (normal).
    fn draw(&self, key: &'static str, bound: Bound) -> Result<Option<Draw>, Located>;

    /// One draw for all joints, or `{ joint = draw, … }`.
    fn per_joint(&self, key: &'static str, bound: Bound) -> Result<Option<PerJoint>, Located>;

    /// `[[time, value], …]` with times that rise.
    fn pairs(&self, key: &'static str, bound: Bound) -> Result<Option<Vec<(f64, f64)>>, Located>;
}

/// Reads one draw for all joints, or one per joint; as described if the key is missing.
pub(super) fn per(s: &Section<'_>, key: &'static str, bound: Bound) -> Result<PerJoint, Located> {
    Ok(s.per_joint(key, bound)?.unwrap_or_default())
}

impl Keys for Section<'_> {
    fn draw(&self, key: &'static str, bound: Bound) -> Result<Option<Draw>, Located> {
        self.value(key).map(|v| draw_of(&v, bound)).transpose()
    }

    fn per_joint(&self, key: &'static str, bound: Bound) -> Result<Option<PerJoint>, Located> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        let entries = match value.is_table() {
            true => value.section()?.entries(),
            false => Vec::new(),
        };
        let is_draw = |name: &str| matches!(name, "min" | "max" | "mean" | "std");
        if !value.is_table() || entries.iter().any(|(name, ..)| is_draw(name)) {
            return Ok(Some(PerJoint {
                all: Some(draw_of(&value, bound)?),
                by_joint: Vec::new(),
            }));
        }
        let mut by_joint = Vec::new();
        for (name, line, value) in entries {
            by_joint.push((name.to_owned(), line, draw_of(&value, bound)?));
        }
        Ok(Some(PerJoint {
            all: None,
            by_joint,
        }))
    }

    fn pairs(&self, key: &'static str, bound: Bound) -> Result<Option<Vec<(f64, f64)>>, Located> {
        let Some(value) = self.value(key) else {
            return Ok(None);
        };
        let must = "a list of pairs [time, value]";
        let mut out: Vec<(f64, f64)> = Vec::new();
        for entry in value.list(must)? {
            let pair = entry.list(must)?;
            let [time, number] = pair.as_slice() else {
                return Err(entry.invalid(must));
            };
            let t = time.number(Bound::NotNegative)?;
            if out.last().is_some_and(|&(before, _)| t <= before) {
                return Err(entry.invalid("later than the pair before it"));
            }
            out.push((t, number.number(bound)?));
        }
        if out.is_empty() {
            return Err(value.invalid(must));
        }
        Ok(Some(out))
    }
}

fn draw_of(value: &Value<'_>, bound: Bound) -> Result<Draw, Located> {
    if !value.is_table() {
        return value.number(bound).map(Draw::Fixed);
    }
    value.section()?.whole(|s| {
        if s.has("std") {
            let mean = s.number_or("mean", bound, 0.0)?;
            let std = s.need("std", Bound::NotNegative, "the standard deviation")?;
            return Ok(Draw::Normal { mean, std, bound });
        }
        let reason = "a drawn value is { min = …, max = … } or { mean = …, std = … }";
        let min = s.need("min", bound, reason)?;
        let max = s.need("max", bound, reason)?;
        if max < min {
            return Err(s.invalid("max", "at least min"));
        }
        Ok(Draw::Uniform { min, max })
    })
}
