//! From a request to an estimate.

use super::basis::{basis, settings};
use super::checks::{check_injections, match_joints, refusals};
use super::csv::CsvSink;
use super::doubts::{health_losses, health_warnings, judge};
use super::replay::{JointSummary, Replay};
use super::request::{EstimateError, Progress, Request};
use super::result::{Difference, Estimate, JointEstimate, RecordingInfo, RobotInfo, Series};
use crate::robot_dir;
use sinew_log::Format;
use sinew_model::offset::OffsetObserver;
use sinew_model::transmission::Transmission;

/// Estimates the offset of every joint of a recording.
///
/// With a reference recording, that one is estimated first, with the same robot and settings but
/// without injected offsets. `progress` is called every few thousand frames.
///
/// # Errors
/// [`EstimateError`]; no file has been written then.
pub fn run(
    request: &Request,
    progress: &mut dyn FnMut(Progress),
) -> Result<Estimate, EstimateError> {
    let reference = match &request.reference {
        None => None,
        Some(log) => {
            let request = Request {
                log: log.clone(),
                robot: Some(match &request.robot {
                    Some(robot) => robot.clone(),
                    // The robot is that of the recording asked for, wherever the reference lies.
                    None => robot_dir::find(&request.log)?,
                }),
                injections: Vec::new(),
                reference: None,
                csv: None,
                ..request.clone()
            };
            Some(one(&request, true, progress)?)
        }
    };
    let mut estimate = one(request, false, progress)?;
    if let Some(reference) = reference {
        compare(&mut estimate, &reference);
    }
    Ok(estimate)
}

/// Estimates one recording.
fn one(
    request: &Request,
    is_reference: bool,
    progress: &mut dyn FnMut(Progress),
) -> Result<Estimate, EstimateError> {
    let config = request.config();
    let mut recording = sinew_log::open(&request.log, &request.open)?;
    let place = match &request.robot {
        Some(place) => place.clone(),
        None => robot_dir::find(&request.log)?,
    };
    let loaded = robot_dir::load(&place, recording.robot_description())?;
    let names = loaded.robot.joint_names().to_vec();
    let mut warnings = loaded.robot.warnings.clone();
    let file = request.log.display().to_string();
    match_joints(&file, &names, &recording, &mut warnings)?;
    check_injections(request, &loaded)?;
    let selection: Vec<&str> = names.iter().map(String::as_str).collect();
    recording.select(&selection)?;
    let refused = refusals(&file, &config, &loaded, recording.channels())?;
    if request.use_tau_ext && !recording.channels().all_have(sinew_log::Quantity::TauExt) {
        return Err(EstimateError::Mismatch {
            file,
            why: "has no external torque for every joint; leave --tau-ext out, or record tau_ext"
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
    let mut replay = Replay::new(
        observer,
        &transmissions,
        &names,
        &request.injections,
        request.use_tau_ext,
        request.open.gap_s,
    );
    let mut csv = match &request.csv {
        None => None,
        Some(path) => Some(CsvSink::create(path, &names, &transmissions)?),
    };
    while let Some(frame) = recording.next_frame()? {
        let outcome = replay.frame(frame);
        if let Some(csv) = &mut csv {
            csv.write(&outcome)?;
        }
        if replay.frames().is_multiple_of(8192) {
            let at = recording.progress();
            progress(Progress {
                bytes_done: at.bytes_done,
                bytes_total: at.bytes_total,
                frames: replay.frames(),
                reference: is_reference,
            });
        }
    }
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
        .enumerate()
        .map(|(i, summary)| {
            joint_estimate(
                &names[i],
                loaded.robot.transmissions[i].as_ref(),
                refused[i].clone(),
                summary,
                frames,
            )
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

/// Adds the difference to the reference recording.
fn compare(estimate: &mut Estimate, reference: &Estimate) {
    estimate.settings.reference = Some(reference.recording.path.clone());
    estimate.damaged |= reference.damaged;
    for warning in &reference.warnings {
        if !estimate.warnings.contains(warning) {
            estimate.warnings.push(format!("reference: {warning}"));
        }
    }
    for (now, then) in estimate.joints.iter_mut().zip(&reference.joints) {
        if now.refused.is_some() || then.refused.is_some() {
            continue;
        }
        let difference_mrad = now.delta_e_mrad - then.delta_e_mrad;
        now.difference = Some(Difference {
            reference_mrad: then.delta_e_mrad,
            difference_mrad,
            standard_error_mrad: now.standard_error_mrad.hypot(then.standard_error_mrad),
            elongation_mm: now
                .elongation_mm
                .filter(|_| now.delta_e_mrad != 0.0)
                .map(|mm| mm / now.delta_e_mrad * difference_mrad),
            stiffness_error_mrad_per_percent: now.stiffness_error_mrad_per_percent
                - then.stiffness_error_mrad_per_percent,
        });
    }
}
