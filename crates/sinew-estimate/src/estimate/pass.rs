//! One recording through the paper's estimate.

use super::basis::{basis, settings};
use super::checks::{check_injections, match_joints, refusals};
use super::csv::CsvSink;
use super::doubts::{health_losses, health_warnings, judge};
use super::replay::{JointSummary, Replay};
use super::request::{EstimateError, Progress, Request};
use super::result::{Estimate, JointEstimate, RecordingInfo, RobotInfo, Series};
use crate::robot_dir;
use crate::robot_dir::LoadedRobot;
use sinew_log::{Format, Frame, Recording};
use sinew_model::offset::{OffsetConfig, OffsetObserver};
use sinew_model::transmission::Transmission;
use std::ops::ControlFlow;

/// A recording and its robot, whose joints are those of the frames.
pub(crate) struct Opened {
    recording: Recording,
    pub(crate) loaded: LoadedRobot,
    warnings: Vec<String>,
}

impl Opened {
    /// Opens what a request names.
    pub(crate) fn new(request: &Request) -> Result<Self, EstimateError> {
        let mut recording = sinew_log::open(&request.log, &request.open)?;
        let place = match &request.robot {
            Some(place) => place.clone(),
            None => robot_dir::find(&request.log)?,
        };
        let loaded = robot_dir::load(&place, recording.robot_description())?;
        let mut warnings = loaded.robot.warnings.clone();
        let names = loaded.robot.joint_names();
        match_joints(&name_of(request), names, &recording, &mut warnings)?;
        check_injections(request, &loaded)?;
        let selection: Vec<&str> = names.iter().map(String::as_str).collect();
        recording.select(&selection)?;
        Ok(Self {
            recording,
            loaded,
            warnings,
        })
    }

    pub(crate) fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Hands every frame to `take` until it breaks, read ahead on another thread. `progress` is called
    /// every few thousand frames.
    pub(crate) fn each_frame(
        &mut self,
        is_reference: bool,
        progress: &mut dyn FnMut(Progress),
        mut take: impl FnMut(&Frame) -> Result<ControlFlow<()>, EstimateError>,
    ) -> Result<(), EstimateError> {
        let mut frames = 0u64;
        let stopped = self.recording.each_frame(|frame, at| {
            frames += 1;
            if frames.is_multiple_of(8192) {
                progress(Progress {
                    bytes_done: at.bytes_done,
                    bytes_total: at.bytes_total,
                    frames,
                    reference: is_reference,
                });
            }
            match take(frame) {
                Ok(ControlFlow::Continue(())) => ControlFlow::Continue(()),
                Ok(ControlFlow::Break(())) => ControlFlow::Break(Ok(())),
                Err(error) => ControlFlow::Break(Err(error)),
            }
        });
        stopped?.unwrap_or(Ok(()))
    }
}

/// The recording as messages name it.
fn name_of(request: &Request) -> String {
    request.log.display().to_string()
}

/// The paper's estimate of a recording under way.
pub(crate) struct Pass<'a> {
    request: &'a Request,
    config: OffsetConfig,
    replay: Replay,
    /// Why a joint gets no estimate.
    refused: Vec<Option<String>>,
    csv: Option<CsvSink>,
}

impl<'a> Pass<'a> {
    /// Before the first frame of what was opened.
    pub(crate) fn new(request: &'a Request, opened: &Opened) -> Result<Self, EstimateError> {
        let config = request.config();
        let (file, loaded) = (name_of(request), &opened.loaded);
        let names = loaded.robot.joint_names();
        let channels = opened.recording.channels();
        let refused = refusals(&file, &config, loaded, channels)?;
        if request.use_tau_ext && !channels.all_have(sinew_log::Quantity::TauExt) {
            return Err(EstimateError::Mismatch {
                file,
                why:
                    "has no external torque for every joint; leave --tau-ext out, or record tau_ext"
                        .into(),
            });
        }
        let transmissions: Vec<Option<Transmission>> = loaded
            .robot
            .transmissions
            .iter()
            .zip(&refused)
            .map(|(t, refused)| t.clone().filter(|_| refused.is_none()))
            .collect();
        let observer = OffsetObserver::new(&loaded.robot.arm, &transmissions, config)?;
        let replay = Replay::new(
            &loaded.robot.arm,
            observer,
            &transmissions,
            &request.injections,
            request.use_tau_ext,
            request.open.gap_s,
        );
        let csv = match &request.csv {
            None => None,
            Some(path) => Some(CsvSink::create(path, names, &transmissions)?),
        };
        Ok(Self {
            request,
            config,
            replay,
            refused,
            csv,
        })
    }

    /// Takes the next frame.
    pub(crate) fn frame(&mut self, frame: &Frame) -> Result<(), EstimateError> {
        let outcome = self.replay.frame(frame);
        if let Some(csv) = &mut self.csv {
            csv.write(&outcome)?;
        }
        Ok(())
    }

    /// The estimate, once the recording has ended; the CSV file is there then.
    pub(crate) fn finish(self, opened: Opened) -> Result<Estimate, EstimateError> {
        let Opened {
            recording,
            loaded,
            mut warnings,
        } = opened;
        let Self {
            request,
            config,
            replay,
            refused,
            csv,
        } = self;
        let file = name_of(request);
        if replay.frames() == 0 {
            return Err(EstimateError::Mismatch {
                file,
                why: "holds no frame: no sample with a time and a joint position".into(),
            });
        }
        let info = RecordingInfo {
            path: file,
            format: match recording.format() {
                Format::Mcap => "MCAP",
                Format::Csv => "CSV",
                Format::Parquet => "Parquet",
            }
            .into(),
            start_time_ns: replay.start_ns(),
            duration_s: replay.duration_s(),
            frames: replay.frames(),
            rate_hz: replay.rate_hz(),
            segments: replay.segments(),
        };
        let health = recording.health();
        let mut losses = replay.losses();
        health_losses(health, info.frames, &mut losses);
        health_warnings(health, &mut warnings);
        let frames = info.frames;
        let joints: Vec<JointEstimate> = replay
            .finish()
            .into_iter()
            .zip(refused)
            .zip(loaded.robot.joint_names())
            .zip(&loaded.robot.transmissions)
            .map(|(((summary, refused), name), transmission)| {
                joint_estimate(name, transmission.as_ref(), refused, summary, frames)
            })
            .collect();
        judge(&joints, &mut warnings);
        if let Some(csv) = csv {
            csv.finish()?;
        }
        Ok(Estimate {
            sinew_version: env!("CARGO_PKG_VERSION").into(),
            recording: info,
            settings: settings(request, &config),
            basis: basis(request, &config, &loaded),
            robot: RobotInfo {
                name: loaded.robot.name,
                file: loaded.file.display().to_string(),
                urdf: loaded.urdf,
            },
            joints,
            losses,
            damaged: health.is_damaged() || health.undecodable > 0,
            warnings,
        })
    }
}

fn joint_estimate(
    name: &str,
    transmission: Option<&Transmission>,
    refused: Option<String>,
    summary: JointSummary,
    frames: u64,
) -> JointEstimate {
    const MRAD: f64 = 1e3;
    const MM: f64 = 1e3;
    let JointSummary {
        delta_e,
        tau_el,
        series,
        losses,
        ..
    } = summary;
    let refused = refused.or_else(|| {
        (delta_e.count() == 0).then(|| {
            let main = losses.iter().max_by_key(|l| l.frames);
            match main {
                Some(loss) => format!("no frame could be used: {}", loss.reason),
                None => "no frame could be used".into(),
            }
        })
    });
    let stiffness = transmission.map_or(f64::NAN, |t| t.stiffness_nm_per_rad);
    let mean = delta_e.mean();
    let error = delta_e.standard_error();
    let tendon = transmission
        .and_then(|t| t.tendon.as_ref())
        .filter(|_| refused.is_none());
    JointEstimate {
        name: name.into(),
        delta_e_rad: mean,
        delta_e_mrad: MRAD * mean,
        scatter_mrad: MRAD * delta_e.scatter(),
        standard_error_mrad: MRAD * error,
        elongation_mm: tendon.map(|t| MM * t.elongation_m(mean)),
        elongation_standard_error_mm: tendon.map(|t| MM * t.elongation_m(error)),
        strain_percent: tendon.map(|t| 100.0 * t.strain(mean)),
        usable_frames: delta_e.count(),
        usable_share: delta_e.count() as f64 / frames.max(1) as f64,
        losses,
        stiffness_nm_per_rad: stiffness,
        tau_el_nm: [tau_el.min(), tau_el.mean(), tau_el.max()],
        stiffness_error_mrad_per_percent: MRAD * 0.01 * tau_el.mean() / stiffness,
        difference: None,
        series: if refused.is_some() {
            Series::default()
        } else {
            series
        },
        refused,
    }
}
