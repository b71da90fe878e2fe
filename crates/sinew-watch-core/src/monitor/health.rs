//! Whether the data can be what they should.

use crate::alarm::Trouble;
use crate::instant::Instant;
use sinew_estimate::feeder::{Fed, Refusal};
use sinew_log::Frame;
use sinew_model::tendons::Routing;
use sinew_model::transmission::Transmission;

/// Data are judged over so long, s.
const OVER_S: f64 = 10.0;
/// More lost than this is worth a word.
const LOST: f64 = 0.05;
/// More that came twice, or backwards, is no clock.
const STOOD: f64 = 0.5;
/// A side that moved by less has not moved, rad.
const STILL_RAD: f64 = 1e-9;
/// A side that moved by more has, rad.
const MOVED_RAD: f64 = 0.05;
/// A rope is never stretched by more, rad: degrees, counts or a missing gear ratio are.
const APART_RAD: f64 = 0.5;

/// A joint is compared with the others' motor positions every so many frames.
const COMPARED: u64 = 16;
/// A motor position that is nearer to another joint by this factor belongs to that one.
const NEARER: f64 = 10.0;
/// Closer than this both may be its own, rad: a rope stretches and a spring gives.
const CLOSE_RAD: f64 = 0.1;

/// Travel of a reading.
#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    const NOTHING: Self = Self {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    fn push(&mut self, x: f64) {
        if x.is_finite() {
            self.low = self.low.min(x);
            self.high = self.high.max(x);
        }
    }

    fn is_empty(self) -> bool {
        self.low > self.high
    }

    fn travel(self) -> f64 {
        (self.high - self.low).max(0.0)
    }
}

/// What was seen of a tendon's joint.
#[derive(Debug, Clone, Copy)]
struct Seen {
    joint: Range,
    motor: Range,
    /// Motor less joint.
    spring: Range,
    apart_rad: f64,
    apart_frames: u64,
}

impl Seen {
    const NOTHING: Self = Self {
        joint: Range::NOTHING,
        motor: Range::NOTHING,
        spring: Range::NOTHING,
        apart_rad: 0.0,
        apart_frames: 0,
    };
}

/// Motor position as the joint sees it.
fn reflected(frame: &Frame, i: usize, routing: &Option<Routing>) -> Option<f64> {
    let theta = *frame.theta.get(i)?;
    Some(match routing {
        None => theta,
        Some(routing) => routing.reflected(i, theta, &frame.q),
    })
}

/// Counts what is wrong with the frames of some seconds. Allocates at construction only.
#[derive(Debug, Clone)]
pub(super) struct Health {
    elastic: Vec<usize>,
    /// Routings of tendons that cross several joints, of every elastic joint.
    routings: Vec<Option<Routing>>,
    from: Option<Instant>,
    frames: u64,
    refused: u64,
    dropped: u64,
    seen: Vec<Seen>,
    /// Distance of every tendon's motor position from every tendon's joint position, row by row, rad, summed.
    apart_rad: Vec<f64>,
    compared: u64,
    /// Frames whose stamps didn't rise.
    stood: u64,
    /// Frames a second, over the last count.
    rate_hz: f64,
    last: Option<Verdict>,
}

/// What is wrong, of the robot and of every tendon; `None`: nothing.
#[derive(Debug, Clone)]
pub(super) struct Verdict {
    pub(super) robot: Option<Trouble>,
    /// Of every elastic joint.
    pub(super) tendons: Vec<Option<Trouble>>,
}

impl Health {
    pub(super) fn new(elastic: Vec<usize>, transmissions: &[Option<Transmission>]) -> Self {
        let routing = |i: &usize| transmissions.get(*i)?.as_ref()?.routing.clone();
        Self {
            routings: elastic.iter().map(routing).collect(),
            seen: vec![Seen::NOTHING; elastic.len()],
            apart_rad: vec![0.0; elastic.len() * elastic.len()],
            compared: 0,
            elastic,
            from: None,
            frames: 0,
            refused: 0,
            dropped: 0,
            stood: 0,
            rate_hz: 0.0,
            last: None,
        }
    }

    /// The last verdict; `None`: none since data came.
    pub(super) fn last(&self) -> Option<&Verdict> {
        self.last.as_ref()
    }

    pub(super) fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Nothing comes any more.
    pub(super) fn silent(&mut self) {
        self.rate_hz = 0.0;
        self.last = None;
        self.begin(None);
    }

    pub(super) fn frame(&mut self, frame: &Frame, fed: Fed<bool>, now: Instant) {
        self.from.get_or_insert(now);
        self.frames += 1;
        let refused = matches!(
            fed,
            Fed::Refused(Refusal::JointPosition | Refusal::MotorPosition | Refusal::Range)
        );
        self.refused += u64::from(refused);
        self.stood += u64::from(fed == Fed::Refused(Refusal::TimeStep));
        if self.frames.is_multiple_of(COMPARED) {
            self.compare(frame);
        }
        let elastic = self.elastic.iter().zip(&self.routings);
        for (seen, (i, routing)) in self.seen.iter_mut().zip(elastic) {
            let (Some(&q), Some(theta)) = (frame.q.get(*i), reflected(frame, *i, routing)) else {
                continue;
            };
            seen.joint.push(q);
            seen.motor.push(theta);
            seen.spring.push(theta - q);
            let apart_rad = (theta - q).abs();
            if apart_rad.is_finite() {
                seen.apart_rad += apart_rad;
                seen.apart_frames += 1;
            }
        }
    }

    /// Whose joint every motor follows.
    fn compare(&mut self, frame: &Frame) {
        let n = self.elastic.len();
        let finite = |values: &[f64]| {
            let mut own = self.elastic.iter().map(|&i| values.get(i));
            own.all(|x| x.is_some_and(|x| x.is_finite()))
        };
        if !(finite(&frame.q) && finite(&frame.theta)) {
            return;
        }
        let elastic = self.elastic.iter().zip(&self.routings);
        for (row, (&i, routing)) in self.apart_rad.chunks_exact_mut(n).zip(elastic) {
            let Some(theta) = reflected(frame, i, routing) else {
                continue;
            };
            for (apart_rad, &k) in row.iter_mut().zip(&self.elastic) {
                *apart_rad += (theta - frame.q[k]).abs();
            }
        }
        self.compared += 1;
    }

    /// The tendon whose motor position this one has, where two are swapped.
    fn swapped_with(&self, i: usize) -> Option<usize> {
        let n = self.elastic.len();
        let mean = |motor: usize, joint: usize| {
            self.apart_rad[motor * n + joint] / self.compared.max(1) as f64
        };
        let follows = |motor: usize, joint: usize| {
            let own = mean(motor, motor);
            own > CLOSE_RAD && mean(motor, joint) * NEARER < own
        };
        (0..n).find(|&k| k != i && follows(i, k) && follows(k, i))
    }

    pub(super) fn dropped(&mut self, frames: u64) {
        self.dropped = self.dropped.saturating_add(frames);
    }

    /// Makes a verdict of what was wrong since the last one, once that is long enough ago; whether it did.
    pub(super) fn verdict(&mut self, names: &[String], now: Instant) -> bool {
        let waited_s = self.from.map_or(0.0, |from| now.since_s(from));
        if waited_s < OVER_S || self.frames == 0 {
            return false;
        }
        self.rate_hz = self.frames as f64 / waited_s;
        let share = |part: u64| part as f64 / (self.frames.max(part)) as f64;
        let missing = self.seen.iter().enumerate().find_map(|(place, seen)| {
            let motor = !seen.joint.is_empty();
            (seen.joint.is_empty() || seen.motor.is_empty()).then(|| Trouble::Missing {
                joint: names[place].clone(),
                motor,
            })
        });
        let stood = share(self.stood);
        let lost = self.dropped as f64 / (self.frames + self.dropped) as f64;
        let robot = match (missing, share(self.refused)) {
            (Some(missing), _) => Some(missing),
            (None, share) if share > LOST => Some(Trouble::NotFinite { share }),
            _ if stood > STOOD => Some(Trouble::StampsStand { share: stood }),
            _ if lost > LOST => Some(Trouble::Lost { share: lost }),
            _ => None,
        };
        let tendons = self.seen.iter().enumerate().map(|(i, seen)| {
            if let Some(other) = self.swapped_with(i) {
                let with = names[other].clone();
                return Some(Trouble::Swapped { with });
            }
            let apart_rad = seen.apart_rad / seen.apart_frames.max(1) as f64;
            let (joint, motor) = (seen.joint.travel(), seen.motor.travel());
            if joint <= STILL_RAD && motor > MOVED_RAD {
                Some(Trouble::Dead { motor: false })
            } else if motor <= STILL_RAD && joint > MOVED_RAD {
                Some(Trouble::Dead { motor: true })
            } else if joint > MOVED_RAD && seen.spring.travel() <= STILL_RAD {
                Some(Trouble::OneSignal)
            } else if apart_rad > APART_RAD {
                Some(Trouble::FarApart { apart_rad })
            } else {
                None
            }
        });
        self.last = Some(Verdict {
            robot,
            tendons: tendons.collect(),
        });
        self.begin(Some(now));
        true
    }

    fn begin(&mut self, from: Option<Instant>) {
        self.from = from;
        (self.frames, self.refused, self.dropped, self.stood) = (0, 0, 0, 0);
        self.seen.fill(Seen::NOTHING);
        self.apart_rad.fill(0.0);
        self.compared = 0;
    }
}
