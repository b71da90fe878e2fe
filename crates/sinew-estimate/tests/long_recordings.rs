//! Recordings in several parts, compared with the estimate of all blocks at once.

use crate::support;

use sinew_estimate::baseline::Baseline;
use sinew_estimate::feeder::Injection;
use sinew_estimate::robot_dir;
use sinew_estimate::session::{
    self, Learning, Payload, Recorded, Recorder, SessionEstimate, SessionOptions, Window,
};
use sinew_estimate::{Given, Request};
use sinew_log::{Arrays, Frame, Quantities, Quantity, Recording};
use sinew_model::offset::FeatureConfig;
use sinew_model::robot::Robot;
use sinew_sim::{Scenario, Simulation};
use std::sync::Arc;

const RATE_HZ: f64 = 100.0;
/// Duration of a repeated minute with the gap after it, s.
const PERIOD_S: f64 = 61.0;

/// Frames that are repeated every [`PERIOD_S`].
#[derive(Clone)]
struct Repeated {
    robot: Arc<Robot>,
    frames: Arc<Vec<Frame>>,
    times: u64,
}

impl Repeated {
    fn time_ns(&self, row: u64) -> i64 {
        let n = self.frames.len() as u64;
        let time_s = (row / n) as f64 * PERIOD_S + (row % n) as f64 / RATE_HZ;
        (time_s * 1e9).round() as i64
    }

    fn frame(&self, row: u64) -> &Frame {
        &self.frames[(row % self.frames.len() as u64) as usize]
    }

    fn request(&self, injections: &[Injection]) -> Request {
        let arrays = self.clone();
        let mut request = Request::new("repeated".into());
        request.given = Given::default().with_recording(
            "repeated",
            Arc::new(move |options| {
                Recording::from_arrays(Box::new(arrays.clone()), "repeated", options)
            }),
        );
        let robot = robot_dir::load(&support::biorob_like_folder(), None).unwrap();
        request.given.robot = Some(Arc::new(robot));
        request.injections = injections.to_vec();
        request
    }

    /// All blocks in one part.
    fn recorded(&self, injections: &[Injection]) -> Recorded {
        let mut recorder = Recorder::new(&self.robot, &FeatureConfig::default(), 0.5)
            .with_injections(&self.robot, injections);
        for row in 0..self.rows() {
            let time_ns = self.time_ns(row);
            let frame = Frame {
                time_ns,
                segment: (row / self.frames.len() as u64) as u32,
                ..self.frame(row).clone()
            };
            recorder.push(&frame, time_ns as f64 * 1e-9);
        }
        recorder.finish()
    }
}

impl Arrays for Repeated {
    fn joints(&self) -> &[String] {
        self.robot.joint_names()
    }

    fn quantities(&self) -> Quantities {
        Quantities::positions()
    }

    fn rows(&self) -> u64 {
        self.times * self.frames.len() as u64
    }

    fn times_ns(&mut self, from: u64, into: &mut [i64]) -> Result<(), String> {
        let rows = from..;
        rows.zip(into).for_each(|(row, t)| *t = self.time_ns(row));
        Ok(())
    }

    fn values(&mut self, quantity: Quantity, from: u64, into: &mut [f64]) -> Result<(), String> {
        let axes = self.robot.axes();
        for (row, into) in (from..).zip(into.chunks_exact_mut(axes)) {
            into.copy_from_slice(self.frame(row).get(quantity));
        }
        Ok(())
    }
}

/// The first two minutes of the work session of the examples: after tensioning, and weeks later with a payload.
fn minutes(times: u64) -> [Repeated; 2] {
    let robot = Arc::new(support::biorob_like());
    let place = support::repository().join("examples/scenarios/work-session.toml");
    let text = std::fs::read_to_string(place).unwrap();
    let text = text.replace("sample_rate_hz = 250", "sample_rate_hz = 100");
    let scenario = Scenario::from_toml(&text, "work-session.toml").unwrap();
    let mut simulation = Simulation::new(&robot, &scenario).unwrap();
    [(); 2].map(|()| {
        let frames = (0..6000).map(|_| {
            let frame = simulation.next_frame().unwrap().expect("three minutes");
            Frame {
                q: frame.q.clone(),
                theta: frame.theta.clone(),
                ..Frame::new(frame.q.len())
            }
        });
        Repeated {
            frames: Arc::new(frames.collect()),
            robot: robot.clone(),
            times,
        }
    })
}

/// Offsets of a result with their 95 % half-widths, mrad.
fn offsets(estimate: &SessionEstimate) -> Vec<(f64, f64)> {
    let of = |x: sinew_model::Gaussian| (1e3 * x.mean, 1e3 * x.half_width_95());
    estimate
        .joints
        .iter()
        .map(|joint| of(joint.offset_rad))
        .collect()
}

fn assert_agree(parts: &SessionEstimate, at_once: &SessionEstimate) {
    let (parts_mrad, once_mrad) = (offsets(parts), offsets(at_once));
    println!("parts   {parts_mrad:.2?}\nat once {once_mrad:.2?}");
    for ((a, a95), (b, b95)) in parts_mrad.iter().zip(&once_mrad) {
        assert!((a - b).abs() < 0.25 * b95, "{a} and {b} ± {b95}");
        assert!((0.8..1.25).contains(&(a95 / b95)), "± {a95} and ± {b95}");
    }
    for (a, b) in parts.joints.iter().zip(&at_once.joints) {
        assert_eq!(
            a.changes.len(),
            b.changes.len(),
            "{:?}\n{:?}",
            a.changes,
            b.changes
        );
        for (a, b) in a.changes.iter().zip(&b.changes) {
            assert_eq!(a.kind, b.kind);
            assert!((a.time_s - b.time_s).abs() < 1.0, "{a:?}\n{b:?}");
        }
        assert!((a.torque_nm.max - b.torque_nm.max).abs() < 0.05 * b.torque_nm.max.abs());
    }
    assert_eq!(parts.segments.len(), at_once.segments.len());
    assert_eq!(parts.poses, at_once.poses);
    assert_eq!(parts.start_time_utc_s, at_once.start_time_utc_s);
    assert!((parts.duration_s - at_once.duration_s).abs() < 1.0);
    assert!((parts.rejected_share - at_once.rejected_share).abs() < 0.02);
    assert_eq!(parts.blocks.len(), at_once.blocks.len());
    let kinds = |estimate: &SessionEstimate| {
        let mut kinds: Vec<String> = (estimate.warnings.iter())
            .map(|warning| {
                let text = format!("{warning:?}");
                text.split_once(' ')
                    .map_or(text.clone(), |(kind, _)| kind.into())
            })
            .collect();
        kinds.sort();
        kinds.dedup();
        kinds
    };
    assert_eq!(kinds(parts), kinds(at_once));
}

fn baseline_at_once(minute: &Repeated) -> (Baseline, SessionEstimate) {
    let recorded = minute.recorded(&[]);
    session::learn_recorded(&minute.robot, &recorded, "repeated", &Learning::default()).unwrap()
}

// 42 minutes with a slip in each part.
#[test]
fn estimate_in_parts_agrees_with_all_blocks_at_once() {
    let [after_tensioning, work] = minutes(1);
    let (baseline, _) = baseline_at_once(&after_tensioning);
    let work = Repeated { times: 42, ..work };
    let slip = |joint: &str, from_s| Injection {
        joint: joint.into(),
        offset_rad: 6e-3,
        from_s: Some(from_s),
    };
    let slips = [slip("elbow", 700.5), slip("wrist", 2030.5)];
    let options = SessionOptions {
        payload: Payload::Unknown,
        ..SessionOptions::default()
    };
    let since = Some((&baseline, "baseline"));
    let (parts, next) = session::estimate(
        &work.request(&slips),
        Window::default(),
        since,
        &options,
        &mut |_| {},
    )
    .unwrap();
    let recorded = work.recorded(&slips);
    let (at_once, next_at_once) =
        session::estimate_recorded(&work.robot, &recorded, "repeated", since, &options).unwrap();
    assert!(recorded.blocks.len() > 11_000, "one part");
    assert_agree(&parts, &at_once);
    let changes = |name: &str| {
        let mut joints = parts.joints.iter();
        joints
            .find(|joint| joint.name == name)
            .unwrap()
            .changes
            .len()
    };
    assert_eq!((changes("elbow"), changes("wrist")), (1, 1));
    assert_eq!(next.recordings, next_at_once.recordings);
    assert_eq!(next.end_time_ns, next_at_once.end_time_ns);
}

// The model errors of a motion that repeats are the same in all parts: the interval is that of the last part.
#[test]
fn repeated_motion_in_parts_does_not_narrow_interval() {
    let [after_tensioning, _] = minutes(1);
    let (baseline, _) = baseline_at_once(&after_tensioning);
    for since in [None, Some((&baseline, "baseline"))] {
        check_width_after_parts(since);
    }
}

fn check_width_after_parts(since: Option<(&Baseline, &str)>) {
    let [_, work] = minutes(42);
    let options = SessionOptions::default();
    let estimate = |work: &Repeated| {
        let request = work.request(&[]);
        let whole = Window::default();
        session::estimate(&request, whole, since, &options, &mut |_| {})
            .unwrap()
            .0
    };
    let long = offsets(&estimate(&work));
    let short = offsets(&estimate(&Repeated { times: 20, ..work }));
    println!("42 min {long:.2?}\n20 min {short:.2?}");
    for ((_, long), (_, short)) in long.iter().zip(&short) {
        assert!(
            *long > 0.9 * short,
            "± {long} after 42 min, ± {short} after 20 min"
        );
    }
}

#[test]
fn baseline_in_parts_agrees_with_all_blocks_at_once() {
    let [after_tensioning, work] = minutes(42);
    let request = after_tensioning.request(&[]);
    let learning = Learning::default();
    let (in_parts, parts) =
        session::learn(&request, Window::default(), &learning, &mut |_| {}).unwrap();
    let (at_once, once) = baseline_at_once(&after_tensioning);
    assert_agree(&parts, &once);
    assert_eq!(in_parts.recordings, at_once.recordings);
    let recorded = Repeated { times: 1, ..work }.recorded(&[]);
    let [a, b] = [&in_parts, &at_once].map(|baseline| {
        let since = Some((baseline, "baseline"));
        let options = SessionOptions::default();
        let (estimate, _) =
            session::estimate_recorded(&after_tensioning.robot, &recorded, "B", since, &options)
                .unwrap();
        offsets(&estimate)
    });
    println!("parts   {a:.2?}\nat once {b:.2?}");
    for ((a, a95), (b, b95)) in a.iter().zip(&b) {
        assert!((a - b).abs() < 0.25 * b95, "{a} and {b} ± {b95}");
        assert!((0.8..1.25).contains(&(a95 / b95)), "± {a95} and ± {b95}");
    }
}
