//! Plausibility checks of the received data.

use crate::alarm::DataFault;
use crate::instant::Instant;
use sinew_estimate::feeder::{FeedOutcome, RejectionReason};
use sinew_log::Frame;
use sinew_model::tendons::Routing;
use sinew_model::transmission::Transmission;

/// Evaluation period of the checks, s.
const EVALUATION_PERIOD_S: f64 = 10.0;
/// Maximum share of lost frames without a fault, 0…1.
const MAX_LOST_SHARE: f64 = 0.05;
/// Maximum share of frames with non-increasing time stamps without a fault, 0…1.
const MAX_NON_INCREASING_SHARE: f64 = 0.5;
/// Maximum travel of a side that counts as constant, rad.
const MAX_CONSTANT_TRAVEL_RAD: f64 = 1e-9;
/// Minimum travel of a side that counts as moving, rad.
const MIN_MOVING_TRAVEL_RAD: f64 = 0.05;
/// Maximum plausible mean difference of motor and joint position, rad; degrees, counts or a missing gear ratio exceed
/// it.
const MAX_DIFFERENCE_RAD: f64 = 0.5;

/// Number of frames between two comparisons of all motor positions with all joint positions.
const COMPARISON_PERIOD_FRAMES: u64 = 16;
/// Minimum ratio of distances at which a motor position is attributed to another joint.
const MIN_SWAP_DISTANCE_RATIO: f64 = 10.0;
/// Minimum distance of a motor position from its joint for a swap, rad; elongation and deflection stay below it.
const MIN_SWAP_DISTANCE_RAD: f64 = 0.1;

/// Range of the values of a signal, rad.
#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    const EMPTY: Self = Self {
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

/// Statistics of the signals of a tendon's joint.
#[derive(Debug, Clone, Copy)]
struct SignalStats {
    joint: Range,
    motor: Range,
    /// Difference of motor and joint position, rad.
    spring: Range,
    apart_rad: f64,
    apart_frames: u64,
}

impl SignalStats {
    const EMPTY: Self = Self {
        joint: Range::EMPTY,
        motor: Range::EMPTY,
        spring: Range::EMPTY,
        apart_rad: 0.0,
        apart_frames: 0,
    };
}

/// Motor position reflected to the joint side, rad.
fn reflected(frame: &Frame, i: usize, routing: &Option<Routing>) -> Option<f64> {
    let theta = *frame.theta.get(i)?;
    Some(match routing {
        None => theta,
        Some(routing) => routing.reflected(i, theta, &frame.q),
    })
}

/// Counts faulty frames over the evaluation period. Allocates at construction only.
#[derive(Debug, Clone)]
pub(super) struct Health {
    elastic: Vec<usize>,
    /// Routing of each elastic joint whose tendon crosses several joints.
    routings: Vec<Option<Routing>>,
    from: Option<Instant>,
    frames: u64,
    rejected: u64,
    dropped: u64,
    signals: Vec<SignalStats>,
    /// Sum of the distances of each motor position from each joint position, row-major by motor, rad.
    apart_rad: Vec<f64>,
    compared: u64,
    /// Number of frames with non-increasing time stamps.
    non_increasing: u64,
    /// Frame rate over the last period, Hz.
    rate_hz: f64,
    last: Option<Verdict>,
}

/// Faults of the robot and of each tendon; `None`: no fault.
#[derive(Debug, Clone)]
pub(super) struct Verdict {
    pub(super) robot: Option<DataFault>,
    /// Fault of each elastic joint.
    pub(super) tendons: Vec<Option<DataFault>>,
}

impl Health {
    pub(super) fn new(elastic: Vec<usize>, transmissions: &[Option<Transmission>]) -> Self {
        let routing = |i: &usize| transmissions.get(*i)?.as_ref()?.routing.clone();
        Self {
            routings: elastic.iter().map(routing).collect(),
            signals: vec![SignalStats::EMPTY; elastic.len()],
            apart_rad: vec![0.0; elastic.len() * elastic.len()],
            compared: 0,
            elastic,
            from: None,
            frames: 0,
            rejected: 0,
            dropped: 0,
            non_increasing: 0,
            rate_hz: 0.0,
            last: None,
        }
    }

    /// Returns the last verdict; `None`: none since data arrived.
    pub(super) fn last(&self) -> Option<&Verdict> {
        self.last.as_ref()
    }

    pub(super) fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Resets the checks because no more data arrive.
    pub(super) fn silent(&mut self) {
        self.rate_hz = 0.0;
        self.last = None;
        self.begin(None);
    }

    pub(super) fn frame(&mut self, frame: &Frame, fed: FeedOutcome<bool>, now: Instant) {
        self.from.get_or_insert(now);
        self.frames += 1;
        let rejected = matches!(
            fed,
            FeedOutcome::Rejected(
                RejectionReason::JointPosition
                    | RejectionReason::MotorPosition
                    | RejectionReason::Range
            )
        );
        self.rejected += u64::from(rejected);
        self.non_increasing += u64::from(fed == FeedOutcome::Rejected(RejectionReason::TimeStep));
        if self.frames.is_multiple_of(COMPARISON_PERIOD_FRAMES) {
            self.compare(frame);
        }
        let elastic = self.elastic.iter().zip(&self.routings);
        for (signals, (i, routing)) in self.signals.iter_mut().zip(elastic) {
            let (Some(&q), Some(theta)) = (frame.q.get(*i), reflected(frame, *i, routing)) else {
                continue;
            };
            signals.joint.push(q);
            signals.motor.push(theta);
            signals.spring.push(theta - q);
            let apart_rad = (theta - q).abs();
            if apart_rad.is_finite() {
                signals.apart_rad += apart_rad;
                signals.apart_frames += 1;
            }
        }
    }

    /// Accumulates the distances of all motor positions from all joint positions.
    fn compare(&mut self, frame: &Frame) {
        let n = self.elastic.len();
        let finite = |values: &[f64]| {
            let mut elastic = self.elastic.iter().map(|&i| values.get(i));
            elastic.all(|x| x.is_some_and(|x| x.is_finite()))
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

    /// Returns the tendon with which this one has swapped motor positions.
    fn swapped_with(&self, i: usize) -> Option<usize> {
        let n = self.elastic.len();
        let mean = |motor: usize, joint: usize| {
            self.apart_rad[motor * n + joint] / self.compared.max(1) as f64
        };
        let follows = |motor: usize, joint: usize| {
            let to_own_joint = mean(motor, motor);
            to_own_joint > MIN_SWAP_DISTANCE_RAD
                && mean(motor, joint) * MIN_SWAP_DISTANCE_RATIO < to_own_joint
        };
        (0..n).find(|&k| k != i && follows(i, k) && follows(k, i))
    }

    pub(super) fn dropped(&mut self, frames: u64) {
        self.dropped = self.dropped.saturating_add(frames);
    }

    /// Evaluates the faults of the last period once it is over; returns whether it did.
    pub(super) fn verdict(&mut self, names: &[String], now: Instant) -> bool {
        let waited_s = self.from.map_or(0.0, |from| now.since_s(from));
        if waited_s < EVALUATION_PERIOD_S || self.frames == 0 {
            return false;
        }
        self.rate_hz = self.frames as f64 / waited_s;
        let share = |part: u64| part as f64 / (self.frames.max(part)) as f64;
        let missing = self
            .signals
            .iter()
            .enumerate()
            .find_map(|(place, signals)| {
                let motor = !signals.joint.is_empty();
                (signals.joint.is_empty() || signals.motor.is_empty()).then(|| DataFault::Missing {
                    joint: names[place].clone(),
                    motor,
                })
            });
        let non_increasing = share(self.non_increasing);
        let lost = self.dropped as f64 / (self.frames + self.dropped) as f64;
        let robot = match (missing, share(self.rejected)) {
            (Some(missing), _) => Some(missing),
            (None, share) if share > MAX_LOST_SHARE => Some(DataFault::NotFinite { share }),
            _ if non_increasing > MAX_NON_INCREASING_SHARE => Some(DataFault::NonMonotonicTime {
                share: non_increasing,
            }),
            _ if lost > MAX_LOST_SHARE => Some(DataFault::Lost { share: lost }),
            _ => None,
        };
        let tendons = self.signals.iter().enumerate().map(|(i, signals)| {
            if let Some(other) = self.swapped_with(i) {
                let with = names[other].clone();
                return Some(DataFault::Swapped { with });
            }
            let apart_rad = signals.apart_rad / signals.apart_frames.max(1) as f64;
            let (joint, motor) = (signals.joint.travel(), signals.motor.travel());
            if joint <= MAX_CONSTANT_TRAVEL_RAD && motor > MIN_MOVING_TRAVEL_RAD {
                Some(DataFault::Dead { motor: false })
            } else if motor <= MAX_CONSTANT_TRAVEL_RAD && joint > MIN_MOVING_TRAVEL_RAD {
                Some(DataFault::Dead { motor: true })
            } else if joint > MIN_MOVING_TRAVEL_RAD
                && signals.spring.travel() <= MAX_CONSTANT_TRAVEL_RAD
            {
                Some(DataFault::OneSignal)
            } else if apart_rad > MAX_DIFFERENCE_RAD {
                Some(DataFault::FarApart { apart_rad })
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
        (
            self.frames,
            self.rejected,
            self.dropped,
            self.non_increasing,
        ) = (0, 0, 0, 0);
        self.signals.fill(SignalStats::EMPTY);
        self.apart_rad.fill(0.0);
        self.compared = 0;
    }
}
