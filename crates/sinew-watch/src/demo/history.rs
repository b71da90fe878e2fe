//! Records of the days before the start of the demonstration.

use super::alter::Random;
use super::arms::{Arm, SimulatedTendon};
use sinew_estimate::baseline::Baseline;
use sinew_files::date::{DAY_S, utc_text};
use sinew_model::Gaussian;
use sinew_model::robot::Robot;
use sinew_watch_core::command::{Command, CommandKind};
use sinew_watch_core::incident::Incidents;
use sinew_watch_core::journal::{Entry, Event, SessionEnd};
use sinew_watch_core::record::Clock;
use sinew_watch_core::transaction::TendonState;
use sinew_watch_core::{MonitorState, Record, Transaction};
use std::sync::Arc;

/// Standard deviation of the offset of a session, rad, as in the sessions of the demonstration.
const OFFSET_RAD: f64 = 1.5e-4;
/// Standard deviation of the stiffness of a session, relative.
const STIFFNESS: f64 = 0.004;
/// Motion per daily session, s.
const SESSION_S: f64 = 600.0;
/// Interval of days on which the arm is not used.
const REST_EVERY: u32 = 7;

/// Returns the content of an arm's store when the demonstration begins at `start_utc_s`.
pub(super) fn transactions(
    arm: &Arm,
    robot: &Robot,
    baseline: &Baseline,
    start_utc_s: f64,
) -> Vec<Transaction> {
    let mut random = Random(arm.name.bytes().map(u64::from).sum());
    let mut out = Vec::new();
    let mut tensionings = tensionings(arm, start_utc_s);
    for day in (0..arm.days).rev() {
        if day % REST_EVERY == REST_EVERY - 1 {
            continue;
        }
        // In the morning, at a varying minute.
        let time_s = -DAY_S * f64::from(day) - DAY_S * (0.6 + 0.05 * random.uniform());
        let celsius = 22.0 + 2.5 * (time_s / (90.0 * DAY_S)).sin() + 0.7 * random.normal();
        let tendons = (arm.tendons.iter()).filter(|life| life.since_s(time_s).is_finite());
        let records = tendons.map(|life| Record {
            robot: arm.name.into(),
            robot_type: robot.name.clone(),
            temperature_c: Some(celsius),
            ..record(life, time_s, start_utc_s, &mut random)
        });
        let records = records.collect();
        let is_due = |entry: &mut Entry| entry.time_utc_s <= start_utc_s + time_s;
        let mut journal: Vec<Entry> = std::iter::from_fn(|| tensionings.pop_if(is_due)).collect();
        journal.push(Entry {
            time_utc_s: start_utc_s + time_s + SESSION_S,
            event: Event::Session {
                duration_s: SESSION_S,
                end: SessionEnd::Full,
            },
        });
        out.push(Transaction {
            id: out.len() as u64 + 1,
            robot: arm.name.into(),
            records,
            replaced_from_utc_s: None,
            state: None,
            alarms: None,
            journal,
        });
    }
    if let Some(last) = out.last_mut() {
        last.state = Some(Arc::new(state_estimate(arm, robot, baseline, start_utc_s)));
    }
    out
}

/// Returns the journal entries of tensionings, the last first.
fn tensionings(arm: &Arm, start_utc_s: f64) -> Vec<Entry> {
    let of = |life: &SimulatedTendon, time_s: f64| Entry {
        time_utc_s: start_utc_s + time_s,
        event: Event::Command {
            command: Command {
                who: "Demo".into(),
                note: String::new(),
                what: CommandKind::Tensioned {
                    joints: vec![life.joint.into()],
                },
            },
        },
    };
    let tendons = arm.tendons.iter();
    let all = tendons.flat_map(|life| life.tensioned_s.iter().map(move |t| of(life, *t)));
    let mut all: Vec<Entry> = all.collect();
    all.sort_by(|a, b| b.time_utc_s.total_cmp(&a.time_utc_s));
    all
}

/// Returns the name of the offset reference.
fn since(life: &SimulatedTendon, time_s: f64, start_utc_s: f64) -> Option<String> {
    let utc_s = start_utc_s + life.since_s(time_s);
    Some(format!("tensioned {}", utc_text((utc_s * 1e9) as i64)?))
}

/// Creates the record of a session of a tendon, without the robot.
fn record(life: &SimulatedTendon, time_s: f64, start_utc_s: f64, random: &mut Random) -> Record {
    let offset_rad = life.offset_rad(time_s) + OFFSET_RAD * random.normal();
    let stiffness = life.stiffness_factor(time_s) - 1.0 + STIFFNESS * random.normal();
    let radius_m = life.tendon.joint_pulley_radius_m;
    let strain_per_rad = radius_m / life.tendon.length_m;
    Record {
        robot: String::new(),
        robot_type: String::new(),
        joint: life.joint.into(),
        time_utc_s: start_utc_s + time_s,
        duration_s: SESSION_S,
        offset_rad: Some(offset_rad),
        offset_std_rad: Some(OFFSET_RAD),
        elongation_m: Some(radius_m * offset_rad),
        elongation_std_m: Some(radius_m * OFFSET_RAD),
        strain_ratio: Some(strain_per_rad * (life.before_rad(time_s) + offset_rad)),
        strain_std_ratio: Some(strain_per_rad * OFFSET_RAD),
        temperature_c: None,
        stiffness_ratio: Some(stiffness),
        stiffness_std_ratio: Some(STIFFNESS),
        baseline: since(life, time_s, start_utc_s),
        source: "demo".into(),
        clock: Clock::Utc,
        provisional: false,
        reason: None,
        poses: 40,
        frames: 60_000,
        frames_lost: 0,
        sinew_version: env!("CARGO_PKG_VERSION").into(),
    }
}

/// Returns the stored state from which the monitor of the arm continues.
fn state_estimate(arm: &Arm, robot: &Robot, baseline: &Baseline, start_utc_s: f64) -> MonitorState {
    let elastic = robot.joint_names().iter().zip(&robot.transmissions);
    let elastic = elastic.filter(|(_, transmission)| transmission.is_some());
    let tendons = elastic.map(|(joint, _)| {
        let life = arm.tendons.iter().find(|life| life.joint == joint);
        let before_m = life.map(|life| {
            let radius_m = life.tendon.joint_pulley_radius_m;
            Gaussian::new(radius_m * life.before_rad(0.0), radius_m * OFFSET_RAD)
        });
        let tensioned = life.map(|life| life.tensioned_s.iter().map(|t| start_utc_s + t).collect());
        TendonState {
            joint: joint.clone(),
            since: life.and_then(|life| since(life, 0.0, start_utc_s)),
            tensioned_utc_s: tensioned.unwrap_or_default(),
            replaced_utc_s: None,
            before_m: before_m.unwrap_or_default(),
            last_rad: life.map(|life| Gaussian::new(life.offset_rad(0.0), OFFSET_RAD)),
            last_utc_s: Some(start_utc_s),
            last_from_utc_s: None,
            last_stiffness_ratio: life
                .map(|life| Gaussian::new(life.stiffness_factor(0.0) - 1.0, STIFFNESS)),
            suspected: None,
        }
    });
    MonitorState {
        version: MonitorState::VERSION,
        baseline: Some(baseline.clone()),
        end_utc_s: Some(start_utc_s),
        learns: None,
        sessions: u64::from(arm.days),
        tendons: tendons.collect(),
        incidents: Incidents::default(),
        maintenance: Vec::new(),
        without: None,
    }
}
