//! Geometry and programme of a test bench.

use crate::law::routing::{self, Pulley, RoutingError};
use sinew_files::{Bound, Fields as _, Located, Section, TomlFile};

/// Strand between drive pulley and joint pulley.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Strand {
    /// Guiding pulleys, from the drive on.
    pub pulleys: Vec<Pulley>,
}

/// Phase of a bench programme: a constant force on the carriage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Force on the carriage, N; without friction each strand carries half of it.
    pub force_n: f64,
    /// Temperature during the phase, °C.
    pub temperature_c: f64,
    /// Duration of the phase, s.
    pub duration_s: f64,
    /// Whether the motor moves.
    pub moving: bool,
}

/// A bench with its programme.
#[derive(Debug, Clone, PartialEq)]
pub struct Bench {
    /// Name of the bench.
    pub name: String,
    /// Length of each strand, m.
    pub strand_m: f64,
    /// Rope unrolled and taken up, m.
    pub stroke_m: f64,
    /// Time of one sinusoid, s.
    pub period_s: f64,
    /// The two strands: while one is paid out, the other is taken up.
    pub strands: [Strand; 2],
    /// Logarithm of the tension ratio that turns the joint pulley on its bearing; 0: without friction.
    pub joint_friction: f64,
    /// The programme, in order.
    pub phases: Vec<Phase>,
}

/// Error of an invalid bench description.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// Invalid file, with the location of the error.
    #[error(transparent)]
    File(#[from] Located),
    /// Guiding pulleys conflict with the strand.
    #[error("{file}, strand {strand}: {error}")]
    Routing {
        /// File or name.
        file: String,
        /// Strand, 1 or 2.
        strand: usize,
        /// Cause of the conflict.
        error: RoutingError,
    },
}

impl Bench {
    /// Reads a bench:
    ///
    /// ```toml
    /// name = "mine"
    /// strand_mm = 600.0            # each of the two strands
    /// stroke_mm = 100.0
    /// period_s = 10.0
    /// joint_friction = 0.02        # optional: logarithm of the tension ratio that turns the joint pulley
    /// [[guide]]                    # one for each pulley and strand
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
        let bench = TomlFile::parse(text, file)?
            .root()
            .whole(|s| Self::of(s, file))?;
        bench.check(file)?;
        Ok(bench)
    }

    fn of(s: &Section<'_>, file: &str) -> Result<Self, Located> {
        let mut strands = [Strand::default(), Strand::default()];
        for (second, pulley) in s.each("guide", guide)? {
            strands[usize::from(second)].pulleys.push(pulley);
        }
        let bench = Self {
            name: s.text("name")?.unwrap_or_else(|| file.into()),
            strand_m: MM * s.need("strand_mm", LENGTH_MM, "length of each strand")?,
            stroke_m: MM * s.need("stroke_mm", FROM_0, "rope unrolled and taken up")?,
            period_s: s.need("period_s", Bound::Within(1e-3, 1e6), "of one stroke")?,
            strands,
            joint_friction: s.number_or("joint_friction", Bound::Within(0.0, 10.0), 0.0)?,
            phases: s.each("phase", phase)?,
        };
        if bench.stroke_m >= bench.strand_m {
            let must = "shorter than strand_mm: rope has to stay between the ends";
            return Err(s.invalid("stroke_mm", must));
        }
        if bench.phases.is_empty() {
            return Err(s.missing("[[phase]]", "at least one load phase is required"));
        }
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

    /// Logarithm `X = Σ μφ` (both strands) plus [`Bench::joint_friction`] of the ratio of the tensions at the drive
    /// while the motor moves. `friction`: `μ` of pulleys without their own.
    #[must_use]
    pub fn log_ratio(&self, friction: f64) -> f64 {
        let strands = self.strands.iter();
        let wraps = strands.map(|s| routing::wrap_friction(&s.pulleys, friction));
        wraps.sum::<f64>() + self.joint_friction
    }

    /// Length of the programme, s.
    pub fn duration_s(&self) -> f64 {
        self.phases.iter().map(|p| p.duration_s).sum()
    }
}

const MM: f64 = 1e-3;
/// At most a kilometre.
const LENGTH_MM: Bound = Bound::Within(1e-3, 1e6);
const FROM_0: Bound = Bound::Within(0.0, 1e6);

/// Whether it guides the second strand, and the pulley.
fn guide(s: &Section<'_>) -> Result<(bool, Pulley), Located> {
    let which = s.need("strand", Bound::Within(1.0, 2.0), "1 or 2")?;
    let wrap_deg = s.need("wrap_deg", FROM_0, "angle by which the rope is deflected")?;
    let pulley = Pulley {
        at_m: MM
            * s.need(
                "at_mm",
                FROM_0,
                "position along the strand at which the rope meets it",
            )?,
        radius_m: MM * s.need("radius_mm", LENGTH_MM, "of the pulley")?,
        wrap_rad: wrap_deg.to_radians(),
        friction: s.number("friction", FROM_0)?,
    };
    Ok((which >= 1.5, pulley))
}

fn phase(s: &Section<'_>) -> Result<Phase, Located> {
    // At most ten years.
    let minutes = s.need("duration_min", Bound::Within(1e-3, 6e6), "how long")?;
    Ok(Phase {
        force_n: s.need("force_n", FROM_0, "on the carriage")?,
        temperature_c: s.number_or("temperature_c", Bound::Within(-100.0, 200.0), 23.0)?,
        duration_s: 60.0 * minutes,
        moving: s.flag_or("moving", true)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stroke_equal_to_strand_error_names_location() {
        let bench = |stroke: f64| {
            let text = format!(
                "strand_mm = 600.0\nstroke_mm = {stroke}\nperiod_s = 10.0\n\
                 [[phase]]\nforce_n = 200.0\nduration_min = 10.0\n"
            );
            Bench::parse(&text, "bench.toml")
        };
        let read = bench(599.0).expect("some rope stays");
        assert_eq!(read.joint_friction, 0.0);
        let error = bench(600.0).expect_err("none stays").to_string();
        assert!(
            error.contains("bench.toml, line 2") && error.contains("shorter"),
            "{error}"
        );
    }

    /// Everything that a drawing of the paper's Fig. 3 would add can be entered: wraps, strands, friction.
    #[test]
    fn bench_file_has_pulleys_of_both_strands() {
        let text = "strand_mm = 600.0\nstroke_mm = 100.0\nperiod_s = 10.0\njoint_friction = 0.03\n\
            [[guide]]\nstrand = 1\nat_mm = 140.0\nradius_mm = 8.0\nwrap_deg = 100.0\nfriction = 0.1\n\
            [[guide]]\nstrand = 2\nat_mm = 280.0\nradius_mm = 8.0\nwrap_deg = 200.0\n\
            [[phase]]\nforce_n = 200.0\nduration_min = 240.0\n";
        let bench = Bench::parse(text, "bench.toml").expect("a bench");
        let expected = 0.1 * 100f64.to_radians() + 0.05 * 200f64.to_radians() + 0.03;
        assert!((bench.log_ratio(0.05) - expected).abs() < 1e-15);
    }
}
