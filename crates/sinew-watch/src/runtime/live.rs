//! Live series of tendons at 10 Hz, recorded only while a browser shows them.

use super::lock;
use serde::Serialize;
use sinew_watch_core::snapshot::LiveTendon;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, Weak};

/// Duration of a sample, ns: 10 Hz.
const SAMPLE_NS: i64 = 100_000_000;
/// Number of samples that are kept: one minute, the width of the chart.
const MAX_SAMPLES: usize = 600;

/// Sample of a live series.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LiveSample {
    /// End of the sample by the monotonic clock of the monitor, s from an arbitrary zero.
    pub time_s: f64,
    /// Values of the tendon: `motor_minus_joint_rad` is the mean over the sample, the others are those at its end.
    #[serde(flatten)]
    pub values: LiveTendon,
}

/// Frames of the sample in progress.
#[derive(Debug)]
struct Progress {
    /// Number of the interval of the monotonic clock.
    interval: i64,
    /// Sum of `motor_minus_joint_rad`, rad, over `frames` frames.
    sum_rad: f64,
    frames: u32,
    /// Values at the last frame.
    last: LiveTendon,
}

/// Samples of the last minute, and the sample in progress.
#[derive(Debug, Default)]
struct Recording {
    progress: Option<Progress>,
    samples: VecDeque<LiveSample>,
    /// Number of samples that have been discarded.
    discarded: u64,
}

/// Live series of one tendon.
#[derive(Debug)]
pub struct LiveSeries {
    tendon: usize,
    recording: Mutex<Recording>,
}

impl LiveSeries {
    /// Returns the samples from number `from` on, and the number of the next one.
    pub fn since(&self, from: u64) -> (Vec<LiveSample>, u64) {
        let recording = lock(&self.recording);
        let skip = usize::try_from(from.saturating_sub(recording.discarded)).unwrap_or(usize::MAX);
        let samples = recording.samples.iter().skip(skip).copied().collect();
        (
            samples,
            recording.discarded + recording.samples.len() as u64,
        )
    }

    /// Adds the values at a frame that arrived at `now_ns` by the monotonic clock.
    fn add(&self, values: LiveTendon, now_ns: i64) {
        let recording = &mut *lock(&self.recording);
        let interval = now_ns.div_euclid(SAMPLE_NS);
        let complete = recording.progress.take_if(|p| p.interval != interval);
        if let Some(complete) = complete {
            if recording.samples.len() == MAX_SAMPLES {
                recording.samples.pop_front();
                recording.discarded += 1;
            }
            recording.samples.push_back(LiveSample {
                time_s: (complete.interval + 1) as f64 * SAMPLE_NS as f64 * 1e-9,
                values: LiveTendon {
                    motor_minus_joint_rad: complete.sum_rad / f64::from(complete.frames),
                    ..complete.last
                },
            });
        }
        let progress = recording.progress.get_or_insert(Progress {
            interval,
            sum_rad: 0.0,
            frames: 0,
            last: values,
        });
        progress.sum_rad += values.motor_minus_joint_rad;
        progress.frames += 1;
        progress.last = values;
    }
}

/// Live series of a robot that browsers show.
#[derive(Debug, Default)]
pub struct LiveBoard {
    /// Whether there may be a series: all that a frame of a robot without subscribers costs.
    has_series: AtomicBool,
    series: Mutex<Vec<Weak<LiveSeries>>>,
}

impl LiveBoard {
    /// Returns the series of a tendon, by its index in the snapshot. It is recorded until the last clone is dropped.
    pub fn subscribe(&self, tendon: usize) -> Arc<LiveSeries> {
        let mut all = lock(&self.series);
        all.retain(|series| series.strong_count() > 0);
        let mut present = all.iter().filter_map(Weak::upgrade);
        if let Some(series) = present.find(|series| series.tendon == tendon) {
            return series;
        }
        let series = Arc::new(LiveSeries {
            tendon,
            recording: Mutex::default(),
        });
        all.push(Arc::downgrade(&series));
        self.has_series.store(true, Ordering::Relaxed);
        series
    }

    /// Adds a frame that arrived at `now_ns` by the monotonic clock, with the values that `of` returns for a tendon.
    pub(super) fn add(&self, of: impl Fn(usize) -> Option<LiveTendon>, now_ns: i64) {
        if !self.has_series.load(Ordering::Relaxed) {
            return;
        }
        let mut all = lock(&self.series);
        all.retain(|series| {
            let Some(series) = series.upgrade() else {
                return false;
            };
            if let Some(values) = of(series.tendon) {
                series.add(values, now_ns);
            }
            true
        });
        self.has_series.store(!all.is_empty(), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_model::Gaussian;

    /// Frames at 250 Hz for `duration_s`, whose `theta − q` is the time in seconds.
    fn play(board: &LiveBoard, duration_s: usize) {
        for k in 0..250 * duration_s as i64 {
            let of = |_| {
                Some(LiveTendon {
                    motor_minus_joint_rad: k as f64 / 250.0,
                    offset_rad: Some(Gaussian::new(1e-3, 1e-4)),
                    valid: k < 250,
                })
            };
            board.add(of, 4_000_000 * k);
        }
    }

    #[test]
    fn live_series_is_bounded_mean_of_tenths_of_second() {
        let board = LiveBoard::default();
        let series = board.subscribe(2);
        assert!(Arc::ptr_eq(&series, &board.subscribe(2)));
        play(&board, 2);
        let (samples, next) = series.since(0);
        // The last interval is still in progress.
        assert_eq!((samples.len(), next), (19, 19));
        for (k, sample) in samples.iter().enumerate() {
            // Mean of 25 frames of an arithmetic series: its middle.
            let middle_s = 0.1 * k as f64 + 12.0 / 250.0;
            assert!((sample.values.motor_minus_joint_rad - middle_s).abs() < 1e-9);
            assert!((sample.time_s - 0.1 * (k as f64 + 1.0)).abs() < 1e-9);
            assert_eq!(sample.values.valid, k < 10, "{k}");
        }
        assert!(series.since(next).0.is_empty());
        let board = LiveBoard::default();
        let series = board.subscribe(0);
        play(&board, 70);
        let (samples, next) = series.since(0);
        assert_eq!((samples.len(), next), (MAX_SAMPLES, 699));
        assert_eq!(series.since(690).0.len(), 9);
    }

    #[test]
    fn live_series_without_reader_costs_nothing() {
        let board = LiveBoard::default();
        let never = |_| -> Option<LiveTendon> { panic!("nobody reads") };
        board.add(never, 0);
        let (first, second) = (board.subscribe(0), board.subscribe(1));
        drop(first);
        let tendons = Mutex::new(Vec::new());
        let of = |tendon| {
            lock(&tendons).push(tendon);
            None
        };
        board.add(of, 0);
        assert_eq!(*lock(&tendons), [1]);
        drop(second);
        board.add(never, 0);
        assert!(!board.has_series.load(Ordering::Relaxed) && lock(&board.series).is_empty());
    }
}
