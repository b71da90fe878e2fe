//! Duty of a rope: tension and temperature over time, usually periodic. As text it is a table of blocks
//! ([`Duty::from_toml`], [`Duty::from_csv`]).

use crate::law::RopeLoad;
use serde::{Deserialize, Serialize};
use sinew_files::{Fault, Located};

/// Maximum number of segments of a duty: one week of seconds.
const STRETCHES_MAX: usize = 604_800;

/// Segment of a duty with linear change between two loads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Load at the start of the segment.
    pub from: RopeLoad,
    /// Load at the end of the segment.
    pub to: RopeLoad,
    /// Duration of the segment, s, above 0.
    pub duration_s: f64,
}

impl Stretch {
    /// Segment of constant tension and temperature.
    pub fn hold(load: RopeLoad, duration_s: f64) -> Self {
        Self {
            from: load,
            to: load,
            duration_s,
        }
    }
}

/// Tension and temperature of a rope over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Duty {
    /// Description of the duty in words.
    pub about: String,
    /// Segments in order, at least one.
    pub stretches: Vec<Stretch>,
    /// Whether the duty repeats; otherwise its last load persists.
    pub repeat: bool,
}

/// Extremes and means of a duty over one cycle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DutySummary {
    /// Duration of one cycle, s.
    pub duration_s: f64,
    /// Mean tension over time, N.
    pub tension_mean_n: f64,
    /// Smallest tension, N.
    pub tension_min_n: f64,
    /// Largest tension, N.
    pub tension_max_n: f64,
    /// Mean temperature over time, °C.
    pub temperature_mean_c: f64,
    /// Lowest temperature, °C.
    pub temperature_min_c: f64,
    /// Highest temperature, °C.
    pub temperature_max_c: f64,
}

impl Duty {
    /// Constant tension and temperature without end.
    pub fn constant(tension_n: f64, temperature_c: f64) -> Self {
        /// Period for splitting by friction, s: one stroke of a robot.
        const CYCLE_S: f64 = 10.0;
        Self {
            about: format!("{tension_n} N at {temperature_c} °C"),
            stretches: vec![Stretch::hold(
                RopeLoad::celsius(tension_n, temperature_c),
                CYCLE_S,
            )],
            repeat: true,
        }
    }

    /// Whether the load never changes.
    pub fn is_constant(&self) -> bool {
        let first = self.stretches[0].from;
        self.stretches
            .iter()
            .all(|s| s.from == first && s.to == first)
    }

    /// Duty of 1 to `STRETCHES_MAX` segments; `file` is its name.
    ///
    /// # Errors
    /// Returns [`Located`] with `file` for a duty without segments or with too many.
    pub fn checked(stretches: Vec<Stretch>, repeat: bool, file: &str) -> Result<Self, Located> {
        if stretches.is_empty() || stretches.len() > STRETCHES_MAX {
            let blocks = stretches.len();
            let problem = format!("{blocks} blocks; a duty has 1 to {STRETCHES_MAX}");
            return Err(Located::new(file, Fault::TooLarge, problem));
        }
        Ok(Self {
            about: file.into(),
            stretches,
            repeat,
        })
    }

    /// Sums over one cycle.
    pub fn summary(&self) -> DutySummary {
        let mut out = DutySummary {
            duration_s: 0.0,
            tension_mean_n: 0.0,
            tension_min_n: f64::INFINITY,
            tension_max_n: f64::NEG_INFINITY,
            temperature_mean_c: 0.0,
            temperature_min_c: f64::INFINITY,
            temperature_max_c: f64::NEG_INFINITY,
        };
        const ZERO_C_K: f64 = crate::law::CELSIUS_ZERO_K;
        for s in &self.stretches {
            out.duration_s += s.duration_s;
            for load in [s.from, s.to] {
                let (t, c) = (load.tension_n, load.temperature_k - ZERO_C_K);
                out.tension_mean_n += 0.5 * t * s.duration_s;
                out.temperature_mean_c += 0.5 * c * s.duration_s;
                out.tension_min_n = out.tension_min_n.min(t);
                out.tension_max_n = out.tension_max_n.max(t);
                out.temperature_min_c = out.temperature_min_c.min(c);
                out.temperature_max_c = out.temperature_max_c.max(c);
            }
        }
        out.tension_mean_n /= out.duration_s;
        out.temperature_mean_c /= out.duration_s;
        out
    }

    /// Duty whose tension is multiplied by friction along the routing: half of each segment with the rope
    /// running one way, half with the other.
    #[must_use]
    pub fn with_friction(&self, mu_phi: f64) -> Self {
        if mu_phi == 0.0 {
            return self.clone();
        }
        let times = |load: RopeLoad, factor: f64| RopeLoad {
            tension_n: load.tension_n * factor,
            ..load
        };
        let half = |s: &Stretch, factor: f64| Stretch {
            from: times(s.from, factor),
            to: times(s.to, factor),
            duration_s: 0.5 * s.duration_s,
        };
        let stretches = self
            .stretches
            .iter()
            .flat_map(|s| [half(s, mu_phi.exp()), half(s, (-mu_phi).exp())])
            .collect();
        Self {
            stretches,
            ..self.clone()
        }
    }
}
