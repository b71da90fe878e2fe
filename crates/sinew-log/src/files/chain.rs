//! Several files as one recording, one after the other.

use super::opener::open_file;
use super::reader::{Format, Progress, Reader};
use crate::assemble::Joiner;
use crate::error::LogError;
use crate::frame::{AxisNames, Channels};
use crate::health::Health;
use crate::options::OpenOptions;
use crate::sources::{SignalSource, TopicInfo};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A file of the recording.
struct Part {
    path: PathBuf,
    bytes: u64,
    starts_ns: Option<i64>,
}

/// Chain of files that are opened one after the other.
pub(super) struct Chain {
    parts: Vec<Part>,
    at: usize,
    reader: Box<dyn Reader>,
    options: OpenOptions,
    joints: Vec<String>,
    tendons: Vec<String>,
    channels: Channels,
    selected: Vec<AxisNames>,
    robot_description: Option<String>,
    /// Topics of the files that have been read.
    read: Vec<TopicInfo>,
}

impl Chain {
    /// Looks into every file, and puts them in the order of their times.
    pub(super) fn open(paths: &[PathBuf], options: &OpenOptions) -> Result<Self, LogError> {
        let mut parts: Vec<Part> = Vec::with_capacity(paths.len());
        let mut first: Option<(String, String)> = None;
        let mut joints: Vec<String> = Vec::new();
        let mut tendons: Vec<String> = Vec::new();
        let mut channels = Channels::default();
        let mut robot_description = None;
        for path in paths {
            let name = path.display().to_string();
            if parts.iter().any(|part| part.path == *path) {
                return Err(LogError::request(&name, "is listed twice"));
            }
            let mut reader = open_file(path, options)?;
            let (first_name, layout) = first.get_or_insert_with(|| (name.clone(), reader.layout()));
            if *layout != reader.layout() {
                let (own, layout) = (reader.layout(), layout.as_str());
                let reason = format!(
                    "is read from {own}, {first_name} from {layout}; all parts of a recording must have the same format"
                );
                return Err(LogError::request(&name, reason));
            }
            let (own, has) = reader.found();
            for (joint, has) in own.into_iter().zip(has.joints) {
                match joints.iter().position(|known| *known == joint) {
                    Some(index) => has.iter().for_each(|q| channels.joints[index].insert(q)),
                    None => {
                        joints.push(joint);
                        channels.joints.push(has);
                    }
                }
            }
            for tendon in reader.tendons() {
                if !tendons.contains(tendon) {
                    tendons.push(tendon.clone());
                }
            }
            channels.temperature |= has.temperature;
            robot_description =
                robot_description.or_else(|| reader.robot_description().map(str::to_owned));
            parts.push(Part {
                path: path.clone(),
                bytes: reader.progress().bytes_total,
                starts_ns: reader.starts_ns()?,
            });
        }
        // Stable: files without a time stay where they were put.
        parts.sort_by_key(|part| part.starts_ns);
        let reader = open_file(&parts[0].path, options)?;
        let mut chain = Chain {
            parts,
            at: 0,
            reader,
            options: options.clone(),
            selected: AxisNames::of_joints(&joints),
            joints,
            tendons,
            channels,
            robot_description,
            read: Vec::new(),
        };
        chain.reader.select(&chain.selected);
        Ok(chain)
    }
}

impl Reader for Chain {
    fn format(&self) -> Format {
        self.reader.format()
    }

    fn layout(&self) -> String {
        self.reader.layout()
    }

    fn starts_ns(&mut self) -> Result<Option<i64>, LogError> {
        Ok(self.parts[0].starts_ns)
    }

    fn found(&self) -> (Vec<String>, Channels) {
        (self.joints.clone(), self.channels.clone())
    }

    fn tendons(&self) -> &[String] {
        &self.tendons
    }

    fn select(&mut self, axes: &[AxisNames]) {
        self.selected = axes.to_vec();
        self.reader.select(axes);
    }

    fn joiner(&self, axes: &[AxisNames], options: &OpenOptions) -> Joiner {
        self.reader.joiner(axes, options)
    }

    fn pull(&mut self, joiner: &mut Joiner, health: &mut Health) -> Result<bool, LogError> {
        loop {
            let before = health.damage.len();
            let more = self.reader.pull(joiner, health)?;
            for damage in &mut health.damage[before..] {
                let file = self.parts[self.at].path.display();
                damage.reason = format!("{file}: {}", damage.reason);
            }
            if more || self.at + 1 == self.parts.len() {
                return Ok(more);
            }
            self.read = self.topics();
            self.at += 1;
            self.reader = open_file(&self.parts[self.at].path, &self.options)?;
            self.reader.select(&self.selected);
        }
    }

    fn progress(&self) -> Progress {
        let bytes = |parts: &[Part]| parts.iter().map(|part| part.bytes).sum::<u64>();
        Progress {
            bytes_done: bytes(&self.parts[..self.at]) + self.reader.progress().bytes_done,
            bytes_total: bytes(&self.parts),
        }
    }

    fn sources(&self) -> Vec<SignalSource> {
        self.reader.sources()
    }

    fn topics(&self) -> Vec<TopicInfo> {
        let mut topics: BTreeMap<String, TopicInfo> = BTreeMap::new();
        for topic in self.read.iter().cloned().chain(self.reader.topics()) {
            match topics.get_mut(&topic.name) {
                Some(known) => known.add(&topic),
                None => {
                    topics.insert(topic.name.clone(), topic);
                }
            }
        }
        topics.into_values().collect()
    }

    fn unused_columns(&self) -> Vec<String> {
        self.reader.unused_columns()
    }

    fn robot_description(&self) -> Option<&str> {
        self.robot_description.as_deref()
    }
}
