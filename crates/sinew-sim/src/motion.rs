//! Commanded motion of the arm over time.

use super::error::SimulateError;
use super::scenario::{Draw, Motion, PerJoint};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// One minimum-jerk move and the rest after it.
#[derive(Debug, Clone, PartialEq)]
struct Segment {
    start_s: f64,
    move_s: f64,
    end_s: f64,
    from: Vec<f64>,
    to: Vec<f64>,
}

/// Generates desired positions and velocities in order of time, segment by segment.
#[derive(Debug, Clone)]
pub(crate) struct Trajectory {
    source: Source,
    now: Segment,
    rng: ChaCha8Rng,
}

#[derive(Debug, Clone)]
enum Source {
    /// Nothing more comes.
    Rest,
    List {
        segments: Vec<(Vec<f64>, Draw, Draw)>,
        next: usize,
        repeat: bool,
    },
    Random {
        ranges: Vec<(f64, f64)>,
        move_s: Draw,
        pause_s: Draw,
    },
}

impl Trajectory {
    /// * `limits`: lower and upper end of each joint, rad, for a random motion without specified ranges.
    pub(crate) fn new(
        motion: &Motion,
        names: &[String],
        limits: &[(f64, f64)],
        mut rng: ChaCha8Rng,
        unknown: impl Fn(u64, &str) -> SimulateError,
    ) -> Result<Self, SimulateError> {
        let n = names.len();
        let zero = vec![0.0; n];
        let mut first_rest = 0.0;
        let (start, source) = match motion {
            Motion::Hold { pose_rad } => (pose_rad.sample(names, &zero, &mut rng), Source::Rest),
            Motion::Waypoints {
                start_rad,
                waypoints,
                repeat,
            } => {
                let start = start_rad.sample(names, &zero, &mut rng);
                let mut at = start.clone();
                let mut segments = Vec::with_capacity(waypoints.len());
                for w in waypoints {
                    at = w.pose_rad.sample(names, &at, &mut rng);
                    segments.push((at.clone(), w.move_s, w.pause_s));
                }
                (start, list(segments, *repeat, &mut rng))
            }
            Motion::Random {
                range_rad,
                move_s,
                pause_s,
            } => {
                let ranges = ranges(range_rad, names, limits);
                let start: Vec<f64> = ranges.iter().map(|&(lo, hi)| 0.5 * (lo + hi)).collect();
                first_rest = 0.5;
                let source = Source::Random {
                    ranges,
                    move_s: *move_s,
                    pause_s: *pause_s,
                };
                (start, source)
            }
            Motion::Staircase {
                joint,
                line,
                from_rad,
                to_rad,
                steps,
                move_s,
                pause_s,
                pose_rad,
                there_and_back,
                repeat,
            } => {
                let climbing = names
                    .iter()
                    .position(|n| n == joint)
                    .ok_or_else(|| unknown(*line, joint))?;
                let mut at = pose_rad.sample(names, &zero, &mut rng);
                at[climbing] = *from_rad;
                let start = at.clone();
                first_rest = least(*pause_s);
                let up = 1..=*steps;
                let down = (0..*steps).rev();
                let sequence: Vec<usize> = if *there_and_back {
                    up.chain(down).collect()
                } else {
                    up.collect()
                };
                let segments = sequence
                    .into_iter()
                    .map(|step| {
                        let share = step as f64 / *steps as f64;
                        at[climbing] = from_rad + (to_rad - from_rad) * share;
                        (at.clone(), *move_s, *pause_s)
                    })
                    .collect();
                (start, list(segments, *repeat, &mut rng))
            }
        };
        Ok(Self {
            source,
            now: Segment {
                start_s: 0.0,
                move_s: 0.0,
                end_s: first_rest,
                from: start.clone(),
                to: start,
            },
            rng,
        })
    }

    /// Length of a motion that ends, s.
    pub(crate) fn length_s(&self) -> Option<f64> {
        match &self.source {
            Source::List {
                segments,
                repeat: false,
                ..
            } => {
                let length = |(_, m, p): &(Vec<f64>, Draw, Draw)| least(*m) + least(*p);
                Some(self.now.end_s + segments.iter().map(length).sum::<f64>())
            }
            _ => None,
        }
    }

    /// Returns the initial joint positions, rad.
    pub(crate) fn start(&self) -> &[f64] {
        &self.now.from
    }

    /// Computes the desired position, velocity and acceleration at `t`, s; the time may decrease by at most one
    /// segment.
    pub(crate) fn at(&mut self, t: f64, q_d: &mut [f64], dq_d: &mut [f64], ddq_d: &mut [f64]) {
        while t >= self.now.end_s && self.advance() {}
        let s = &self.now;
        let (share, rate, change) = if t <= s.start_s {
            (0.0, 0.0, 0.0)
        } else if s.move_s == 0.0 || t >= s.start_s + s.move_s {
            (1.0, 0.0, 0.0)
        } else {
            minimum_jerk((t - s.start_s) / s.move_s)
        };
        for i in 0..q_d.len() {
            let way = s.to[i] - s.from[i];
            q_d[i] = s.from[i] + way * share;
            dq_d[i] = if rate == 0.0 {
                0.0
            } else {
                way * rate / s.move_s
            };
            ddq_d[i] = if change == 0.0 {
                0.0
            } else {
                way * change / (s.move_s * s.move_s)
            };
        }
    }

    /// Advances to the next segment; `false` when the motion is over.
    fn advance(&mut self) -> bool {
        let (to, move_s, pause_s) = match &mut self.source {
            Source::Rest => return false,
            Source::List {
                segments,
                next,
                repeat,
            } => {
                let Some(segment) = segments.get(*next) else {
                    self.source = Source::Rest;
                    return false;
                };
                *next += 1;
                if *repeat && *next == segments.len() {
                    *next = 0;
                }
                let (to, move_s, pause_s) = segment;
                (
                    to.clone(),
                    move_s.sample(&mut self.rng),
                    pause_s.sample(&mut self.rng),
                )
            }
            Source::Random {
                ranges,
                move_s,
                pause_s,
            } => {
                let to = ranges
                    .iter()
                    .map(|&(lo, hi)| lo + (hi - lo) * self.rng.random::<f64>())
                    .collect();
                let move_s = move_s.sample(&mut self.rng);
                (to, move_s, pause_s.sample(&mut self.rng))
            }
        };
        let before = &mut self.now;
        before.start_s = before.end_s;
        before.end_s = before.start_s + move_s + pause_s;
        before.move_s = move_s;
        before.from = std::mem::replace(&mut before.to, to);
        true
    }
}

/// A finite motion draws its times immediately, because its length must be known.
fn list(mut segments: Vec<(Vec<f64>, Draw, Draw)>, repeat: bool, rng: &mut ChaCha8Rng) -> Source {
    if !repeat {
        for (_, move_s, pause_s) in &mut segments {
            for draw in [move_s, pause_s] {
                if !matches!(draw, Draw::Fixed(_)) {
                    *draw = Draw::Fixed(draw.sample(rng));
                }
            }
        }
    }
    Source::List {
        segments,
        next: 0,
        repeat,
    }
}

/// The least a draw may give; the mean of a normal one.
fn least(draw: Draw) -> f64 {
    match draw {
        Draw::Fixed(v) | Draw::Uniform { min: v, .. } | Draw::Normal { mean: v, .. } => v,
    }
}

/// Range of each joint: as specified in the scenario, else 80 % of the limits about their middle, else half a turn.
fn ranges(range: &PerJoint, names: &[String], limits: &[(f64, f64)]) -> Vec<(f64, f64)> {
    names
        .iter()
        .zip(limits)
        .map(|(name, &(lower, upper))| {
            let own = range.by_joint.iter().find(|(n, _, _)| n == name);
            match own.map(|(_, _, d)| *d).or(range.all) {
                Some(Draw::Uniform { min, max }) => (min, max),
                Some(Draw::Fixed(v)) => (v, v),
                Some(Draw::Normal { mean, std, .. }) => (mean - std, mean + std),
                None if (upper - lower).is_finite() && upper > lower => {
                    let (middle, half) = (0.5 * (lower + upper), 0.4 * (upper - lower));
                    (middle - half, middle + half)
                }
                None => (-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2),
            }
        })
        .collect()
}

/// Share of the way and its rate at the share `s` of the time: `10 s³ − 15 s⁴ + 6 s⁵`.
///
/// # Source
/// Flash, Hogan, *The coordination of arm movements*, J. Neuroscience 5, 1985.
fn minimum_jerk(s: f64) -> (f64, f64, f64) {
    let s2 = s * s;
    (
        s2 * s * (10.0 - 15.0 * s + 6.0 * s2),
        30.0 * s2 * (1.0 - s) * (1.0 - s),
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minimum_jerk_ends_at_rest_and_its_rate_is_its_slope() {
        assert_eq!(minimum_jerk(0.0), (0.0, 0.0, 0.0));
        assert_eq!(minimum_jerk(1.0), (1.0, 0.0, 0.0));
        // Central difference: error h²/6 of a third derivative of at most 60.
        let h = 1e-4;
        for s in [0.1, 0.37, 0.5, 0.9] {
            let slope = (minimum_jerk(s + h).0 - minimum_jerk(s - h).0) / (2.0 * h);
            assert!((slope - minimum_jerk(s).1).abs() < 10.0 * h * h);
            // The third derivative of the rate is 360 at most.
            let change = (minimum_jerk(s + h).1 - minimum_jerk(s - h).1) / (2.0 * h);
            assert!((change - minimum_jerk(s).2).abs() < 60.0 * h * h + 1e-11);
        }
    }
}
