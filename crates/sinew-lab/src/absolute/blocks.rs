//! A recording as blocks of features.

use crate::estimate::{EstimateError, Progress, Request};
use crate::robot_dir::{self, LoadedRobot};
use sinew_model::offset::{Block, FeatureConfig, FeatureObserver, MapError};

/// Which part of a recording is used, s from its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// From here.
    pub from_s: f64,
    /// Up to here.
    pub to_s: f64,
}

impl Default for Window {
    fn default() -> Self {
        Self {
            from_s: 0.0,
            to_s: f64::INFINITY,
        }
    }
}

/// Why there is no absolute estimate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AbsoluteError {
    /// Recording or robot can't be used.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The estimator refused.
    #[error("{file}: {error}")]
    Map {
        /// The recording.
        file: String,
        /// Why.
        error: MapError,
    },
    /// The baseline file can't be used.
    #[error("{file}: {why}")]
    Baseline {
        /// The file.
        file: String,
        /// Why, and what to do.
        why: String,
    },
}

/// A recording's features and the robot they were made with.
#[derive(Debug)]
pub struct Recorded {
    /// The robot.
    pub loaded: LoadedRobot,
    /// Blocks in the order of time.
    pub blocks: Vec<Block>,
    /// Length of the part used, s.
    pub duration_s: f64,
    /// Frames left out because a position was missing.
    pub frames_missing: u64,
    /// Whether the file was damaged.
    pub damaged: bool,
}

/// Reads the blocks of a recording.
pub(super) fn read(
    request: &Request,
    window: Window,
    config: &FeatureConfig,
    progress: &mut dyn FnMut(Progress),
) -> Result<Recorded, AbsoluteError> {
    let mut recording =
        sinew_log::open(&request.log, &request.open).map_err(EstimateError::from)?;
    let place = match &request.robot {
        Some(place) => place.clone(),
        None => robot_dir::find(&request.log).map_err(EstimateError::from)?,
    };
    let loaded =
        robot_dir::load(&place, recording.robot_description()).map_err(EstimateError::from)?;
    let robot = &loaded.robot;
    let names: Vec<&str> = robot.joint_names().iter().map(String::as_str).collect();
    recording.select(&names).map_err(EstimateError::from)?;
    let mismatch = |why: String| {
        AbsoluteError::Estimate(EstimateError::Mismatch {
            file: request.log.display().to_string(),
            why,
        })
    };
    for ((name, transmission), channel) in names
        .iter()
        .zip(&robot.transmissions)
        .zip(&recording.channels().joints)
    {
        if !channel.q || (transmission.is_some() && !channel.theta) {
            return Err(mismatch(format!(
                "has no joint and motor position of '{name}', which the absolute estimate needs for every elastic joint; leave --baseline out"
            )));
        }
    }
    let mut features = FeatureObserver::new(&robot.arm, *config);
    let mut theta = vec![0.0; names.len()];
    let mut out = Recorded {
        blocks: Vec::new(),
        duration_s: 0.0,
        frames_missing: 0,
        damaged: false,
        loaded: loaded.clone(),
    };
    let (mut start_ns, mut last_ns, mut segment) = (None, None, 0);
    let mut frames = 0u64;
    while let Some(frame) = recording.next_frame().map_err(EstimateError::from)? {
        let start: i64 = *start_ns.get_or_insert(frame.time_ns);
        let t = (frame.time_ns - start) as f64 * 1e-9;
        if t < window.from_s {
            continue;
        }
        if t >= window.to_s {
            break;
        }
        frames += 1;
        // A rigid joint's motor doesn't matter; it may be missing.
        for (i, slot) in theta.iter_mut().enumerate() {
            *slot = if robot.transmissions[i].is_some() {
                frame.theta[i]
            } else {
                frame.q[i]
            };
        }
        if frame.q.iter().chain(&theta).any(|x| !x.is_finite()) {
            out.frames_missing += 1;
            continue;
        }
        let gap =
            last_ns.is_some_and(|l: i64| frame.time_ns - l > (request.open.gap_s * 1e9) as i64);
        if frame.segment != segment || gap {
            features.reset();
            segment = frame.segment;
        }
        let dt = last_ns.map_or(0.0, |l: i64| (frame.time_ns - l) as f64 * 1e-9);
        last_ns = Some(frame.time_ns);
        if matches!(
            features.step(dt, &frame.q, &theta, frame.temperature_c),
            Ok(true)
        ) {
            let mut block = features.block().clone();
            // On the recording's clock, gaps and all.
            block.time_s = t - 0.5 * config.block_s;
            out.blocks.push(block);
        }
        out.duration_s = t - window.from_s;
        if frames.is_multiple_of(8192) {
            let at = recording.progress();
            progress(Progress {
                bytes_done: at.bytes_done,
                bytes_total: at.bytes_total,
                frames,
                reference: false,
            });
        }
    }
    out.damaged = recording.health().is_damaged();
    if out.blocks.is_empty() {
        return Err(mismatch(format!(
            "has no {:.0} s of joint and motor positions in a row between {} and {} s, which the filters need to settle",
            7.0 / config.gain_per_s + 9.0 / config.cutoff_rad_per_s + config.block_s,
            window.from_s,
            window.to_s
        )));
    }
    Ok(out)
}
