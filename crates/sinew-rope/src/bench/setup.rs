//! What stands where on the bench, and what is done to it.

use serde::Deserialize;
use sinew_model::rope::routing::{self, Pulley, RoutingError};
use toml::Spanned;

/// One of the two strands between drive pulley and joint pulley.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strand {
    /// Guiding pulleys, from the drive on.
    pub pulleys: Vec<Pulley>,
}

/// A force on the carriage for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Force on the carriage, N; each strand carries half of it but for friction.
    pub force_n: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// How long, s.
    pub duration_s: f64,
    /// Whether the motor moves.
    pub moving: bool,
}

/// A bench with its programme.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    /// What it is called.
    pub name: String,
    /// Length of each strand, m.
    pub strand_m: f64,
    /// Rope unrolled and taken up, m.
    pub stroke_m: f64,
    /// Time of one sinusoid, s.
    pub period_s: f64,
    /// Both strands: as one gives, the other takes.
    pub strands: [Strand; 2],
    /// The programme, in order.
    pub phases: Vec<Phase>,
}

/// Why a bench was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// Not TOML, an unknown key, or a value of the wrong type.
    #[error("{file}: {message}")]
    Toml {
        /// File.
        file: String,
        /// What the parser says.
        message: String,
    },
    /// A value that can't be.
    #[error("{file}, line {line}: {key} = {value}: {why}")]
    Value {
        /// File.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Key with its unit.
        key: &'static str,
        /// What was found.
        value: f64,
        /// What it must be.
        why: &'static str,
    },
    /// No phase at all.
    #[error("{file}: no [[phase]]; the bench has nothing to do")]
    NoPhase {
        /// File.
        file: String,
    },
    /// The guiding pulleys don't fit.
    #[error("{file}, strand {strand}: {error}")]
    Routing {
        /// File or name.
        file: String,
        /// Strand, 1 or 2.
        strand: usize,
        /// Why.
        error: RoutingError,
    },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawBench {
    name: Option<String>,
    strand_mm: Spanned<f64>,
    stroke_mm: Spanned<f64>,
    period_s: Spanned<f64>,
    #[serde(default)]
    guide: Vec<RawGuide>,
    #[serde(default)]
    phase: Vec<RawPhase>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawGuide {
    strand: Spanned<f64>,
    at_mm: Spanned<f64>,
    radius_mm: Spanned<f64>,
    wrap_deg: Spanned<f64>,
    friction: Option<Spanned<f64>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPhase {
    force_n: Spanned<f64>,
    duration_min: Spanned<f64>,
    temperature_c: Option<Spanned<f64>>,
    #[serde(default = "yes")]
    moving: bool,
}

fn yes() -> bool {
    true
}

impl Bench {
    /// Reads a bench:
    ///
    /// ```toml
    /// name = "mine"
    /// strand_mm = 600.0            # each of the two strands
    /// stroke_mm = 100.0
    /// period_s = 10.0
    /// [[guide]]
    /// strand = 1                   # 1 or 2
    /// at_mm = 150.0                # where the rope meets it, from the drive
    /// radius_mm = 8.0
    /// wrap_deg = 20.0
    /// friction = 0.05              # optional: else the rope's
    /// [[phase]]
    /// force_n = 200.0              # on the carriage
    /// duration_min = 240.0
    /// temperature_c = 23.0         # optional
    /// moving = true                # optional
    /// ```
    ///
    /// # Errors
    /// [`BenchError`] with file, line, key and value.
    pub fn parse(text: &str, file: &str) -> Result<Self, BenchError> {
        let raw: RawBench = toml::from_str(text).map_err(|e| BenchError::Toml {
            file: file.into(),
            message: e.to_string().trim_end().into(),
        })?;
        let number = |key: &'static str, v: &Spanned<f64>, low: f64, high: f64, why| {
            let value = *v.as_ref();
            if (low..=high).contains(&value) {
                return Ok(value);
            }
            let before = &text.as_bytes()[..v.span().start.min(text.len())];
            Err(BenchError::Value {
                file: file.into(),
                line: 1 + before.iter().filter(|b| **b == b'\n').count(),
                key,
                value,
                why,
            })
        };
        const MM: f64 = 1e-3;
        let length = |key, v: &Spanned<f64>| {
            number(key, v, 1e-3, 1e6, "must be above 0 and at most a kilometre").map(|v| MM * v)
        };
        let from_zero = |key, v: &Spanned<f64>| number(key, v, 0.0, 1e6, "must be at least 0");
        let mut strands = [Strand::default(), Strand::default()];
        for g in &raw.guide {
            let which = number("strand", &g.strand, 1.0, 2.0, "must be 1 or 2")?;
            let friction = g.friction.as_ref();
            strands[usize::from(which >= 1.5)].pulleys.push(Pulley {
                at_m: MM * from_zero("at_mm", &g.at_mm)?,
                radius_m: length("radius_mm", &g.radius_mm)?,
                wrap_rad: from_zero("wrap_deg", &g.wrap_deg)?.to_radians(),
                friction: friction.map(|f| from_zero("friction", f)).transpose()?,
            });
        }
        let mut phases = Vec::with_capacity(raw.phase.len());
        for p in &raw.phase {
            let temperature_c = match &p.temperature_c {
                None => 23.0,
                Some(v) => number("temperature_c", v, -100.0, 200.0, "must be −100 to 200 °C")?,
            };
            let minutes = number(
                "duration_min",
                &p.duration_min,
                1e-3,
                6e6,
                "must be above 0 and at most ten years",
            )?;
            phases.push(Phase {
                force_n: from_zero("force_n", &p.force_n)?,
                temperature_c,
                duration_s: 60.0 * minutes,
                moving: p.moving,
            });
        }
        if phases.is_empty() {
            return Err(BenchError::NoPhase { file: file.into() });
        }
        let bench = Self {
            name: raw.name.clone().unwrap_or_else(|| file.into()),
            strand_m: length("strand_mm", &raw.strand_mm)?,
            stroke_m: MM * from_zero("stroke_mm", &raw.stroke_mm)?,
            period_s: number(
                "period_s",
                &raw.period_s,
                1e-3,
                1e6,
                "must be at least 0.001 s",
            )?,
            strands,
            phases,
        };
        bench.check(file)?;
        Ok(bench)
    }

    /// Whether the pulleys fit.
    ///
    /// # Errors
    /// [`BenchError::Routing`].
    pub fn check(&self, file: &str) -> Result<(), BenchError> {
        for (i, strand) in self.strands.iter().enumerate() {
            routing::portions(self.strand_m, self.stroke_m, &strand.pulleys).map_err(|error| {
                BenchError::Routing {
                    file: file.into(),
                    strand: i + 1,
                    error,
                }
            })?;
        }
        Ok(())
    }

    /// Length of the programme, s.
    pub fn duration_s(&self) -> f64 {
        self.phases.iter().map(|p| p.duration_s).sum()
    }
}
