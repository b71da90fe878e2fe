//! An estimate as topics of ROS 2, for viewers of recordings.

use crate::diagnostics::{of_reading, of_tendon};
use crate::estimate_table::{per_rad, time_ns};
use sinew_estimate::EstimateDocument;
use sinew_estimate::replay::Estimate;
use sinew_estimate::session::SessionEstimate;
use sinew_log::encode::{
    DiagnosticArray, DiagnosticStatus, DynamicJointState, Header, InterfaceValue,
};
use sinew_log::{LogError, Packing, Topic, TopicWriter};
use std::collections::BTreeMap;
use std::path::Path;

/// The answer over time.
pub const TENDONS: &str = "/sinew/tendons";
/// The paper's reading over time, where another method answers.
pub const READING: &str = "/sinew/reading";
/// One status per tendon.
pub const DIAGNOSTICS: &str = "/diagnostics";

/// Interfaces of a tendon: rad, rad, m, m/m.
pub const INTERFACES: [&str; 4] = ["offset", "offset_interval_95", "elongation", "strain"];
/// One of [`DIAGNOSTICS`] every so often, ns.
const DIAGNOSTICS_EVERY_NS: i64 = 1_000_000_000;

/// Tendons at one time: joints and a value per interface.
type Tendons = (Vec<String>, Vec<[f64; INTERFACES.len()]>);

/// What is sent at one time.
enum Event {
    Tendons(Topic, Tendons),
    Diagnostics(Vec<DiagnosticStatus>),
}

/// Writes an estimate as an MCAP with the recording's own times, to be opened beside it.
///
/// * [`TENDONS`], `control_msgs/msg/DynamicJointState` with [`INTERFACES`]: the answer, every 0.2 s by the absolute
///   method, in up to 2000 intervals by the paper's, whose `offset_interval_95` is NaN: a reading has none;
/// * [`READING`], the same of the paper's reading, where the absolute method answers;
/// * [`DIAGNOSTICS`], `diagnostic_msgs/msg/DiagnosticArray`, one status per tendon, every second and at the end.
///
/// # Errors
/// [`LogError`]; no file is left.
pub fn write_topics(document: &EstimateDocument, path: &Path) -> Result<(), LogError> {
    let mut out = TopicWriter::create(path, Packing::default())?;
    let tendons = out.topic::<DynamicJointState<'_>>(TENDONS)?;
    let mut events: Vec<(i64, Event)> = Vec::new();
    let reading = &document.reading;
    let mut add = |topic: Topic, of: BTreeMap<i64, Tendons>| {
        let all = of.into_iter();
        events.extend(all.map(|(at, tendons)| (at, Event::Tendons(topic, tendons))));
    };
    match &document.session {
        Some(session) => {
            add(tendons, absolute(reading, session));
            let topic = out.topic::<DynamicJointState<'_>>(READING)?;
            add(topic, paper(reading));
        }
        None => add(tendons, paper(reading)),
    }
    let diagnostics = out.topic::<DiagnosticArray<'_>>(DIAGNOSTICS)?;
    events.extend(statuses(document).map(|(at, status)| (at, Event::Diagnostics(status))));
    // In the order of times, as a recorder would have written them.
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

/// The absolute estimate, a message per block.
fn absolute(reading: &Estimate, session: &SessionEstimate) -> BTreeMap<i64, Tendons> {
    let names: Vec<String> = session.joints.iter().map(|j| j.name.clone()).collect();
    let factors: Vec<[Option<f64>; 2]> = (session.joints.iter())
        .map(|j| [j.elongation_m, j.strain_ratio].map(|of| per_rad(of, j.offset_rad)))
        .collect();
    let blocks = session.blocks.iter().map(|block| {
        let values = block.offset_rad.iter().zip(&factors);
        let values = values.map(|(offset, factors)| {
            let [m, strain] = factors.map(|f| f.map_or(f64::NAN, |f| f * offset.mean));
            [offset.mean, offset.half_width_95(), m, strain]
        });
        let at = time_ns(reading, block.time_s);
        (at, (names.clone(), values.collect()))
    });
    blocks.collect()
}

/// The paper's reading; a message holds the joints that have one then.
fn paper(reading: &Estimate) -> BTreeMap<i64, Tendons> {
    let mut out: BTreeMap<i64, Tendons> = BTreeMap::new();
    for joint in reading.joints.iter().filter(|j| j.refused.is_none()) {
        let factor = |of: Option<f64>| {
            let mean = joint.offset_rad.filter(|x| *x != 0.0);
            of.zip(mean).map_or(f64::NAN, |(of, mean)| of / mean)
        };
        let [m, strain] = [joint.elongation_m, joint.strain_ratio].map(factor);
        let series = joint.series.time_s.iter().zip(&joint.series.offset_rad);
        for (time_s, offset) in series.filter(|(_, offset)| offset.is_finite()) {
            let (names, values) = out.entry(time_ns(reading, *time_s)).or_default();
            names.push(joint.name.clone());
            values.push([*offset, f64::NAN, m * offset, strain * offset]);
        }
    }
    out
}

/// What is said of every tendon, every second and at the end.
fn statuses(
    document: &EstimateDocument,
) -> impl Iterator<Item = (i64, Vec<DiagnosticStatus>)> + '_ {
    let reading = &document.reading;
    let end_ns = time_ns(reading, reading.recording.duration_s);
    let mut next_ns = i64::MIN;
    let session = document.session.as_ref();
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
        let all = pairs.map(|(joint, offset)| of_tendon(robot, joint, *offset));
        Some((at, all.collect()))
    });
    often.chain(std::iter::once_with(move || {
        let robot = reading.robot.name.as_str();
        let all = match session {
            Some(session) => (session.joints.iter())
                .map(|joint| of_tendon(robot, joint, joint.offset_rad))
                .collect(),
            None => (reading.joints.iter())
                .map(|j| of_reading(reading, j))
                .collect(),
        };
        (end_ns, all)
    }))
}
