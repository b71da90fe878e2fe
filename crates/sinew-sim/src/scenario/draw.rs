//! Values that are given or drawn, and the random streams they are drawn from.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use sinew_files::{Bound, Fields as _, Located, Section, Value};

/// A number of a scenario: given, or drawn once per recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Draw {
    /// As given.
    Fixed(f64),
    /// Anything between two ends, equally likely.
    Uniform {
        /// Lower end.
        min: f64,
        /// Upper end.
        max: f64,
    },
    /// Normal, redrawn while outside of what the quantity allows.
    Normal {
        /// Mean of the distribution.
        mean: f64,
        /// Standard deviation.
        std: f64,
        /// What the quantity allows.
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
                // A stream of its own: how often it is redrawn must not move the values after it.
                let mut own = ChaCha8Rng::seed_from_u64(u.to_bits());
                const TRIES: usize = 1000;
                for _ in 0..TRIES {
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
    /// For every joint that isn't named.
    pub all: Option<Draw>,
    /// Joint, its line in the file (0 when made in code), and its draw.
    pub by_joint: Vec<(String, u64, Draw)>,
}

impl PerJoint {
    /// The same value for every joint.
    pub fn fixed(value: f64) -> Self {
        Self {
            all: Some(Draw::Fixed(value)),
            by_joint: Vec::new(),
        }
    }

    /// A value for one joint, the default for the others.
    pub fn one(joint: &str, value: f64) -> Self {
        Self {
            all: None,
            by_joint: vec![(joint.into(), 0, Draw::Fixed(value))],
        }
    }

    /// One value per joint of `names`; `defaults` where the scenario says nothing.
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

/// What a random stream is for. Each has a stream of its own, so that switching one thing off
/// leaves all the others as they were.
#[derive(Debug, Clone, Copy)]
pub enum Stream {
    /// What the robot truly is.
    Truth = 1,
    /// How it moves.
    Motion = 2,
    /// Who touches it.
    Contacts = 3,
    /// Noise of its sensors.
    Sensors = 4,
    /// What the recording loses.
    Faults = 5,
    /// Draws that came to the language later: those before them must not move.
    Later = 6,
    /// What a correction believes.
    Correction = 7,
    /// Where it grips what it picks up.
    Grip = 8,
    /// How heavy that is.
    Payloads = 9,
    /// By how much its tendons stretch.
    OffsetSizes = 10,
    /// How much later.
    OffsetDelays = 11,
}

/// The stream of a seed.
pub fn rng(seed: u64, stream: Stream) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream as u64);
    rng
}

/// A standard normal number.
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// The scenario's own ways to write a value.
pub(super) trait Keys {
    /// A number, `{ min, max }` (uniform) or `{ mean, std }` (normal).
    fn draw(&self, key: &'static str, bound: Bound) -> Result<Option<Draw>, Located>;

    /// One draw for all joints, or `{ joint = draw, … }`.
    fn per_joint(&self, key: &'static str, bound: Bound) -> Result<Option<PerJoint>, Located>;

    /// `[[time, value], …]` with times that rise.
    fn pairs(&self, key: &'static str, bound: Bound) -> Result<Option<Vec<(f64, f64)>>, Located>;
}

/// One draw for all joints, or one by joint; as described where the key is left out.
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
                return Err(entry.refuse(must));
            };
            let t = time.number(Bound::NotNegative)?;
            if out.last().is_some_and(|&(before, _)| t <= before) {
                return Err(entry.refuse("later than the pair before it"));
            }
            out.push((t, number.number(bound)?));
        }
        if out.is_empty() {
            return Err(value.refuse(must));
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
        let why = "a drawn value is { min = …, max = … } or { mean = …, std = … }";
        let min = s.need("min", bound, why)?;
        let max = s.need("max", bound, why)?;
        if max < min {
            return Err(s.refuse("max", "at least min"));
        }
        Ok(Draw::Uniform { min, max })
    })
}
