//! Estimate over time as ROS 2 topics in an MCAP file.

use crate::diagnostics::{of_tendon, of_uncorrected};
use crate::estimate_table::{ABSOLUTE, PAPER, rows, time_ns};
use sinew_estimate::EstimateDocument;
use sinew_estimate::session::SessionEstimate;
use sinew_log::encode::{
    DiagnosticArray, DiagnosticStatus, DynamicJointState, Header, InterfaceValue,
};
use sinew_log::{LogError, Packing, Topic, TopicWriter};
use std::collections::BTreeMap;
use std::path::Path;

/// Topic of the estimate over time.
pub const TENDONS: &str = "/sinew/tendons";
/// Topic of the uncorrected estimate over time, if there is also an absolute one.
pub const READING: &str = "/sinew/reading";
/// Topic with one status per tendon.
pub const DIAGNOSTICS: &str = "/diagnostics";

/// Interfaces of a tendon, in rad, rad, m and m/m.
pub const INTERFACES: [&str; 4] = ["offset", "offset_std", "elongation", "strain"];
/// Period of [`DIAGNOSTICS`], ns.
const DIAGNOSTICS_EVERY_NS: i64 = 1_000_000_000;

/// Names of tendons, and their values per interface, at one time.
type Tendons = (Vec<String>, Vec<[f64; INTERFACES.len()]>);

/// Content of a message.
enum Event {
    Tendons(Topic, Tendons),
    Diagnostics(Vec<DiagnosticStatus>),
}

/// Writes an estimate as an MCAP file with the time stamps of the recording.
///
/// * [`TENDONS`], `control_msgs/msg/DynamicJointState` with [`INTERFACES`]: the absolute estimate every 0.2 s, or the
///   uncorrected one in at most 2000 intervals, with `offset_std` NaN;
/// * [`READING`], the same with the uncorrected estimate, if there is an absolute one;
/// * [`DIAGNOSTICS`], `diagnostic_msgs/msg/DiagnosticArray`, one status per tendon, every second and at the end.
///
/// # Errors
///
/// Returns [`LogError`] if the file cannot be written; no partial file remains.
pub fn write_topics(document: &EstimateDocument, path: &Path) -> Result<(), LogError> {
    let mut out = TopicWriter::create(path, Packing::default())?;
    let tendons = out.topic::<DynamicJointState<'_>>(TENDONS)?;
    let mut events: Vec<(i64, Event)> = Vec::new();
    let mut add = |topic: Topic, of: BTreeMap<i64, Tendons>| {
        let all = of.into_iter();
        events.extend(all.map(|(at, tendons)| (at, Event::Tendons(topic, tendons))));
    };
    match document.session {
        Some(_) => {
            add(tendons, over_time(document, ABSOLUTE));
            let topic = out.topic::<DynamicJointState<'_>>(READING)?;
            add(topic, over_time(document, PAPER));
        }
        None => add(tendons, over_time(document, PAPER)),
    }
    let diagnostics = out.topic::<DiagnosticArray<'_>>(DIAGNOSTICS)?;
    events.extend(statuses(document).map(|(at, status)| (at, Event::Diagnostics(status))));
    // Messages are written in the order of their times.
    events.sort_by_key(|(at, _)| *at);
    for (sequence, (at, event)) in (0_u32..).zip(&events) {
        let header = Header {
            stamp: out.stamp(*at)?,
            frame_id: "",
        };
        match event {
            Event::Tendons(topic, (joints, values)) => {
                let interface_values: Vec<_> = (values.iter())
                    .map(|values| InterfaceValue {
                        interface_names: &INTERFACES,
                        values,
                    })
                    .collect();
                let message = DynamicJointState {
                    header,
                    joint_names: joints,
                    interface_values: &interface_values,
                };
                out.send(*topic, *at, sequence, &message)?;
            }
            Event::Diagnostics(status) => {
                let message = DiagnosticArray { header, status };
                out.send(diagnostics, *at, sequence, &message)?;
            }
        }
    }
    out.finish()
}

/// Collects the estimates of a method by time; a message contains the joints with a finite offset.
fn over_time(document: &EstimateDocument, method: &str) -> BTreeMap<i64, Tendons> {
    let mut out: BTreeMap<i64, Tendons> = BTreeMap::new();
    let of_method = rows(document).filter(|r| r.method == method);
    for row in of_method.filter(|r| r.offset_rad.mean.is_finite()) {
        let at = time_ns(&document.reading, row.time_s);
        let (names, values) = out.entry(at).or_default();
        let offset = row.offset_rad;
        let [m, strain] = [row.m_per_rad, row.strain_per_rad]
            .map(|factor| factor.map_or(f64::NAN, |factor| factor * offset.mean));
        names.push(row.joint.to_owned());
        values.push([offset.mean, offset.std, m, strain]);
    }
    out
}

/// Makes the diagnostics of all tendons, every second and at the end.
fn statuses(
    document: &EstimateDocument,
) -> impl Iterator<Item = (i64, Vec<DiagnosticStatus>)> + '_ {
    let reading = &document.reading;
    let end_ns = time_ns(reading, reading.recording.duration_s);
    let mut next_ns = i64::MIN;
    let session = document.session.as_ref();
    let is_elongation = session.is_some_and(SessionEstimate::is_elongation);
    let blocks = session.into_iter().flat_map(|s| &s.blocks);
    let often = blocks.filter_map(move |block| {
        let at = time_ns(reading, block.time_s);
        if at < next_ns {
            return None;
        }
        next_ns = at + DIAGNOSTICS_EVERY_NS;
        let joints = document.session.iter().flat_map(|s| &s.joints);
        let pairs = joints.zip(&block.offset_rad);
        let robot = reading.robot.name.as_str();
        let all = pairs.map(|(joint, offset)| of_tendon(robot, joint, *offset, is_elongation));
        Some((at, all.collect()))
    });
    often.chain(std::iter::once_with(move || {
        let robot = reading.robot.name.as_str();
        let all = match session {
            Some(session) => (session.joints.iter())
                .map(|joint| of_tendon(robot, joint, joint.offset_rad, is_elongation))
                .collect(),
            None => (reading.joints.iter())
                .map(|j| of_uncorrected(reading, j))
                .collect(),
        };
        (end_ns, all)
    }))
}
