//! From a request to an estimate.

use super::replay::{FrameOutcome, JointSummary, Replay};
use super::request::{EstimateError, Progress, Request};
use super::result::{
    Basis, Difference, Estimate, JointEstimate, Loss, RecordingInfo, RobotInfo, Series, Settings,
};
use crate::output::AtomicFile;
use crate::robot_dir::{self, LoadedRobot};
use sinew_log::{Channels, Format, Health, Recording};
use sinew_model::offset::{Comparison, OffsetConfig, OffsetObserver, TorqueSource, VelocityFilter};
use sinew_model::transmission::Transmission;
use std::fmt::Write as _;
use std::path::Path;

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
        csv.file.finish()?;
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

/// Every moving joint needs a position; others of the recording are left alone, with a word.
fn match_joints(
    file: &str,
    names: &[String],
    recording: &Recording,
    warnings: &mut Vec<String>,
) -> Result<(), EstimateError> {
    let known = recording.joints();
    let missing: Vec<&str> = names
        .iter()
        .filter(|n| !known.contains(n))
        .map(String::as_str)
        .collect();
    if !missing.is_empty() {
        return Err(EstimateError::Mismatch {
            file: file.into(),
            why: format!(
                "has no position of joint {}, which the robot has; it has {}. Name it in a mapping file (--mapping), or hold it with locked_at_rad in robot.toml",
                quoted(&missing),
                quoted(&known.iter().map(String::as_str).collect::<Vec<_>>()),
            ),
        });
    }
    let extra: Vec<&str> = known
        .iter()
        .filter(|k| !names.contains(k))
        .map(String::as_str)
        .collect();
    if !extra.is_empty() {
        warnings.push(format!(
            "joint {} of the recording is not in the robot and was left out",
            quoted(&extra)
        ));
    }
    Ok(())
}

/// Why a joint gets no estimate, one entry per joint; an error when none gets one.
fn refusals(
    file: &str,
    config: &OffsetConfig,
    loaded: &LoadedRobot,
    channels: &Channels,
) -> Result<Vec<Option<String>>, EstimateError> {
    let mut refused = Vec::new();
    for (transmission, channel) in loaded.robot.transmissions.iter().zip(&channels.joints) {
        refused.push(match transmission {
            None => Some("rigid in robot.toml: it has no elastic transmission".to_string()),
            Some(_) if !channel.theta => Some("its motor position is not recorded".into()),
            Some(_) if config.source == TorqueSource::TorqueSensor && !channel.tau_el => {
                Some("its joint torque is not recorded".into())
            }
            Some(_) if config.source == TorqueSource::Motor && !channel.tau_m => {
                Some("its motor torque is not recorded".into())
            }
            Some(t) if config.source == TorqueSource::Motor && t.motor_inertia_kg_m2.is_none() => {
                Some("motor_inertia_kg_m2 is missing in robot.toml".into())
            }
            Some(_) => None,
        });
    }
    if refused.iter().all(Option::is_some) {
        let mut why = "no joint can be estimated".to_string();
        for (name, reason) in loaded.robot.joint_names().iter().zip(&refused) {
            if let Some(reason) = reason {
                let _ = write!(why, "; {name}: {reason}");
            }
        }
        if !channels.any_has(sinew_log::Quantity::Theta) {
            why.push_str(
                ". Name the motor side with --motor-topic, --motor-interface or --mapping",
            );
        }
        return Err(EstimateError::Mismatch {
            file: file.into(),
            why,
        });
    }
    if config.velocity == VelocityFilter::Recorded && !channels.all_have(sinew_log::Quantity::Dq) {
        return Err(EstimateError::Mismatch {
            file: file.into(),
            why: "has no velocity for every joint; use --velocity-filter RAD_PER_S".into(),
        });
    }
    Ok(refused)
}

fn check_injections(request: &Request, loaded: &LoadedRobot) -> Result<(), EstimateError> {
    for injection in &request.injections {
        let place = loaded.robot.arm.joint_index(&injection.joint);
        let Some(i) = place else {
            return Err(EstimateError::Injection(format!(
                "the robot has no joint '{}'; it has {}",
                injection.joint,
                loaded.robot.joint_names().join(", ")
            )));
        };
        if loaded.robot.transmissions[i].is_none() {
            return Err(EstimateError::Injection(format!(
                "joint '{}' is rigid",
                injection.joint
            )));
        }
        if !injection.offset_rad.is_finite() || injection.from_s.is_some_and(|t| !t.is_finite()) {
            return Err(EstimateError::Injection(format!(
                "offset {} rad at '{}' must be a finite number",
                injection.offset_rad, injection.joint
            )));
        }
    }
    Ok(())
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

/// What a reader should doubt.
fn judge(joints: &[JointEstimate], warnings: &mut Vec<String>) {
    // The paper looks for 10 mrad; a tendon pulley of 25 mm turns 200 mrad for 5 mm of rope.
    const IMPLAUSIBLE_MRAD: f64 = 200.0;
    for joint in joints {
        if joint.delta_e_mrad.abs() > IMPLAUSIBLE_MRAD {
            warnings.push(format!(
                "joint '{}': an offset of {:.0} mrad is no stretch of a rope; check units (degrees?), gear ratio, sign and zero of its positions",
                joint.name, joint.delta_e_mrad
            ));
        }
        let [low, _, high] = joint.tau_el_nm;
        // 1 % of stiffness times the torque range is what a wrong stiffness can hide.
        if joint.refused.is_none()
            && joint.scatter_mrad.is_finite()
            && (high - low) / joint.stiffness_nm_per_rad < 1e-3
        {
            warnings.push(format!(
                "joint '{}': its torque hardly changes ({low:.2} to {high:.2} N·m); a wrong stiffness or mass can't be told from stretch in this recording",
                joint.name
            ));
        }
    }
}

fn health_losses(health: &Health, frames: u64, losses: &mut Vec<Loss>) {
    let mut add = |reason: &str, count: u64| {
        if count > 0 {
            losses.push(Loss {
                reason: reason.into(),
                frames: count,
                share: count as f64 / (frames + count) as f64,
            });
        }
    };
    add("dropped: time stamp seen before", health.duplicates);
    add("dropped: came too late to be sorted in", health.late);
    add("dropped: could not be decoded", health.undecodable);
    add("dropped: a row without a time", health.rows_without_time);
}

fn health_warnings(health: &Health, warnings: &mut Vec<String>) {
    for damage in &health.damage {
        warnings.push(format!(
            "the file is damaged at byte {}: {}; {} bytes lost, everything before was used",
            damage.offset, damage.reason, damage.bytes
        ));
    }
    if health.gaps > 0 {
        warnings.push(format!(
            "{} in the recording, the longest {:.1} s; the observer started anew after each",
            count(health.gaps, "gap"),
            health.longest_gap_s
        ));
    }
    if health.clock_jumps > 0 {
        warnings.push(format!(
            "the clock went back {}; the observer started anew after each",
            count(health.clock_jumps, "time")
        ));
    }
    if health.out_of_order > 0 {
        warnings.push(format!(
            "{} came out of order, sorted in",
            count(health.out_of_order, "message")
        ));
    }
    for signal in &health.non_finite {
        warnings.push(format!(
            "{} of '{}' is NaN or infinite in {}, left out",
            signal.quantity.symbol(),
            signal.joint,
            count(signal.count, "sample")
        ));
    }
    for signal in &health.unwrapped {
        warnings.push(format!(
            "{} of '{}' wrapped around {} and was unwrapped",
            signal.quantity.symbol(),
            signal.joint,
            count(signal.count, "time")
        ));
    }
    warnings.extend(health.suspicions.iter().cloned());
}

/// "1 gap", "3 gaps".
fn count(number: u64, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

fn settings(request: &Request, config: &OffsetConfig) -> Settings {
    Settings {
        source: match config.source {
            TorqueSource::Observer => "observer",
            TorqueSource::TorqueSensor => "torque-sensor",
            TorqueSource::Motor => "motor",
        }
        .into(),
        comparison: match config.comparison {
            Comparison::Matched => "matched",
            Comparison::Paper => "paper",
        }
        .into(),
        gain_per_s: config.gain_per_s,
        velocity_filter_rad_per_s: match config.velocity {
            VelocityFilter::StateVariable { cutoff_rad_per_s } => Some(cutoff_rad_per_s),
            VelocityFilter::Recorded => None,
        },
        tau_ext: request.use_tau_ext,
        injected: request.injections.clone(),
        reference: None,
    }
}

fn basis(request: &Request, config: &OffsetConfig, loaded: &LoadedRobot) -> Vec<Basis> {
    let row = |quantity: &str, rests_on: String| Basis {
        quantity: quantity.into(),
        rests_on,
    };
    let file = loaded.file.display();
    let mut rows = vec![row(
        "motor and joint positions, rad",
        "measured, in the recording".into(),
    )];
    rows.push(match config.source {
        TorqueSource::Observer => row(
            "elastic torque, N·m",
            format!(
                "computed by the momentum observer from the positions and the masses of {}; not measured",
                loaded.urdf
            ),
        ),
        TorqueSource::TorqueSensor => row(
            "elastic torque, N·m",
            "measured by the joint torque sensors, in the recording".into(),
        ),
        TorqueSource::Motor => row(
            "elastic torque, N·m",
            format!("computed from the recorded motor torque, motor inertia and friction of {file}"),
        ),
    });
    rows.push(row(
        "stiffness, N·m/rad; friction; tendon geometry, mm",
        format!("as stated in {file}; not fitted to this recording"),
    ));
    if request.use_tau_ext {
        rows.push(row(
            "external torque, N·m",
            "as recorded, taken as known".into(),
        ));
    }
    rows.push(row(
        "offset, mrad; elongation, mm; strain, %",
        "the estimate; its standard error covers the scatter within this recording, not an error of stiffness, masses or payload: differences between recordings of like motion are surer than absolute values".into(),
    ));
    rows
}

fn quoted(names: &[&str]) -> String {
    const SHOWN: usize = 12;
    let mut text = names
        .iter()
        .take(SHOWN)
        .map(|n| format!("'{n}'"))
        .collect::<Vec<_>>()
        .join(", ");
    if names.len() > SHOWN {
        let _ = write!(text, " and {} more", names.len() - SHOWN);
    }
    if names.is_empty() {
        text.push_str("none");
    }
    text
}

/// `--csv`: every frame's estimate.
struct CsvSink {
    file: AtomicFile,
    elastic: Vec<usize>,
    line: String,
}

impl CsvSink {
    fn create(
        path: &Path,
        names: &[String],
        transmissions: &[Option<Transmission>],
    ) -> Result<Self, EstimateError> {
        let mut file = AtomicFile::create(path)?;
        let elastic: Vec<usize> = (0..names.len())
            .filter(|&i| transmissions[i].is_some())
            .collect();
        let mut line = "time_ns,time_s".to_string();
        for &i in &elastic {
            for (symbol, unit) in [("delta_e", "_rad"), ("tau_el", "_nm"), ("usable", "")] {
                let column = format!("{symbol}.{}{unit}", names[i]);
                if column.contains([',', '"', '\n', '\r']) {
                    let _ = write!(line, ",\"{}\"", column.replace('"', "\"\""));
                } else {
                    let _ = write!(line, ",{column}");
                }
            }
        }
        line.push('\n');
        file.write(line.as_bytes())?;
        Ok(Self {
            file,
            elastic,
            line,
        })
    }

    fn write(&mut self, outcome: &FrameOutcome<'_>) -> Result<(), EstimateError> {
        self.line.clear();
        let _ = write!(
            self.line,
            "{},{:.9}",
            outcome.time_ns,
            outcome.since_start_ns as f64 * 1e-9
        );
        for &i in &self.elastic {
            // A frame that could not be used has an empty estimate, not a stale one.
            if outcome.usable[i] {
                let _ = write!(
                    self.line,
                    ",{:.9},{:.6},1",
                    outcome.delta_e[i], outcome.tau_el[i]
                );
            } else {
                self.line.push_str(",,,0");
            }
        }
        self.line.push('\n');
        self.file.write(self.line.as_bytes())?;
        Ok(())
    }
}
