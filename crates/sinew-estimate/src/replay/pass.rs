//! Single pass of the estimator of the paper through a recording.

use super::basis::{basis, settings};
use super::checks::joint_errors;
use super::frame_table::FrameTable;
use super::frames::{JointSummary, Replay};
use super::health::{check_estimates, health_losses, health_warnings};
use super::result::{
    Estimate, JointError, JointEstimate, RecordingInfo, RobotInfo, Series, TorqueStatistics,
};
use crate::error::EstimateError;
use crate::recording::Opened;
use crate::request::Request;
use sinew_log::Frame;
use sinew_model::arm::JointKind;
use sinew_model::offset::{OffsetConfig, OffsetObserver};
use sinew_model::transmission::Transmission;

/// Estimate of a recording by the method of the paper, in progress.
pub(crate) struct Pass<'a> {
    request: &'a Request,
    config: OffsetConfig,
    replay: Replay,
    /// Reason why a joint cannot be estimated, per joint.
    errors: Vec<Option<JointError>>,
    csv: Option<FrameTable>,
}

impl<'a> Pass<'a> {
    /// Creates a pass before the first frame of an opened recording.
    pub(crate) fn new(request: &'a Request, opened: &Opened) -> Result<Self, EstimateError> {
        let config = request.config();
        let (file, loaded) = (request.name(), &opened.loaded);
        let names = loaded.robot.tendon_names();
        let channels = opened.recording.channels();
        let errors = joint_errors(&file, &config, loaded, (channels, &opened.without_encoder))?;
        if request.use_tau_ext && !channels.all_have(sinew_log::Quantity::TauExt) {
            return Err(EstimateError::Mismatch {
                file,
                reason:
                    "has no external torque of some joints; leave --tau-ext out, or record tau_ext"
                        .into(),
            });
        }
        let transmissions: Vec<Option<Transmission>> = loaded
            .robot
            .transmissions
            .iter()
            .zip(&errors)
            .map(|(t, error)| t.clone().filter(|_| error.is_none()))
            .collect();
        let observer = OffsetObserver::new(&loaded.robot.arm, &transmissions, config)?;
        let replay = Replay::new(
            &loaded.robot,
            observer,
            &transmissions,
            &request.injections,
            request.use_tau_ext,
            request.open.gap_s,
        );
        let csv = match &request.csv {
            None => None,
            Some(path) => Some(FrameTable::create(path, &names, &transmissions)?),
        };
        Ok(Self {
            request,
            config,
            replay,
            errors,
            csv,
        })
    }

    /// Processes the next frame.
    pub(crate) fn frame(&mut self, frame: &Frame) -> Result<(), EstimateError> {
        let outcome = self.replay.frame(frame);
        if let Some(csv) = &mut self.csv {
            csv.write(&outcome)?;
        }
        Ok(())
    }

    /// Returns the estimate after the last frame, and completes the CSV file.
    pub(crate) fn finish(self, opened: Opened) -> Result<Estimate, EstimateError> {
        let Opened {
            recording,
            loaded,
            mut warnings,
            ..
        } = opened;
        let Self {
            request,
            config,
            replay,
            errors,
            csv,
        } = self;
        let file = request.name();
        if replay.frames() == 0 {
            return Err(EstimateError::Mismatch {
                file,
                reason: "contains no frame: no sample with a time stamp and a joint position"
                    .into(),
            });
        }
        let info = RecordingInfo {
            path: file,
            format: recording.format(),
            sources: recording.sources(),
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
        let mut joints: Vec<JointEstimate> = replay
            .finish()
            .into_iter()
            .zip(errors)
            .zip(&loaded.robot.tendon_names())
            .zip(&loaded.robot.transmissions)
            .map(|(((summary, error), name), transmission)| {
                joint_estimate(name, transmission.as_ref(), error, summary, frames)
            })
            .collect();
        for (i, joint) in joints.iter_mut().enumerate() {
            joint.slides = loaded.robot.arm.joint_kind(i) == Some(JointKind::Prismatic);
        }
        check_estimates(&joints, &mut warnings);
        // Without any estimate no file is written.
        if let Some(csv) = csv.filter(|_| joints.iter().any(|j| j.reason.is_none())) {
            csv.finish()?;
        }
        Ok(Estimate {
            sinew_version: env!("CARGO_PKG_VERSION").into(),
            recording: info,
            settings: settings(request, &config),
            basis: basis(request, &config),
            robot: RobotInfo {
                joints: match loaded.robot.is_named_by_joints() {
                    true => Vec::new(),
                    false => loaded.robot.joint_names().to_vec(),
                },
                name: loaded.robot.name,
                file: loaded.file.display().to_string(),
                urdf: loaded.urdf,
            },
            joints,
            losses,
            damaged: health.is_damaged() || health.undecodable > 0 || health.has_lost_much(),
            warnings,
        })
    }
}

fn joint_estimate(
    name: &str,
    transmission: Option<&Transmission>,
    error: Option<JointError>,
    summary: JointSummary,
    frames: u64,
) -> JointEstimate {
    let JointSummary {
        delta_e,
        tau_el,
        series,
        losses,
    } = summary;
    let reason = error.or_else(|| {
        let main = losses.iter().max_by_key(|l| l.frames);
        let main = main.map(|loss| loss.reason);
        (delta_e.count() == 0).then_some(JointError::NoUsableFrame(main))
    });
    let finite = |x: f64| x.is_finite().then_some(x);
    let stiffness = transmission.map(|t| t.stiffness_nm_per_rad);
    let mean = delta_e.mean();
    let standard_error = delta_e.standard_error();
    let tendon = transmission
        .and_then(|t| t.tendon.as_ref())
        .filter(|_| reason.is_none());
    JointEstimate {
        name: name.into(),
        slides: false,
        offset_rad: finite(mean),
        scatter_rad: finite(delta_e.scatter()),
        standard_error_rad: finite(standard_error),
        elongation_m: tendon.map(|t| t.elongation_m(mean)),
        elongation_standard_error_m: tendon.and_then(|t| finite(t.elongation_m(standard_error))),
        strain_ratio: tendon.map(|t| t.strain(mean)),
        usable_frames: delta_e.count(),
        usable_share: delta_e.count() as f64 / frames.max(1) as f64,
        losses,
        stiffness_nm_per_rad: stiffness,
        tau_el_nm: (tau_el.count() > 0).then(|| TorqueStatistics {
            min: tau_el.min(),
            mean: tau_el.mean(),
            max: tau_el.max(),
        }),
        offset_per_stiffness_error_rad: stiffness.and_then(|k| finite(tau_el.mean() / k)),
        difference: None,
        series: if reason.is_some() {
            Series::default()
        } else {
            series
        },
        reason,
    }
}
