//! Recordings around incidents: the last frames of a robot in a ring, written as MCAP when an incident begins.
//!
//! ```text
//! frame ─▶ ring ── change found ─▶ window around it ── incident ─▶ file
//! ```
//!
//! A change is found when its segment is estimated, within a minute; the incident begins at the end of the session. The
//! window is therefore copied at the first and written at the second. Without a change in the session, as after a change
//! while the robot was off, the window ends when the incident begins.

use super::health::Health;
use super::slot::Slot;
use crate::config::RecordingSettings;
use crate::words;
use sinew_log::live::LiveOptions;
use sinew_log::{Frame, FrameWriter as _, McapOptions, McapWriter, Quantities, Quantity};
use sinew_watch_core::Transaction;
use sinew_watch_core::alarm::AlarmCause;
use sinew_watch_core::incident::{Incident, IncidentPhase};
use sinew_watch_core::journal::Event;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;

/// Time in which a change is found, s: length of a segment and its estimate.
const FOUND_WITHIN_S: f64 = 60.0;
/// Maximum number of windows that wait for their incident, each at most as large as the ring; beyond it, the oldest are
/// discarded.
const MAX_WINDOWS: usize = 2;

/// Quantities of a frame, in the order of the ring.
const QUANTITIES: [Quantity; 8] = [
    Quantity::Q,
    Quantity::Theta,
    Quantity::Dq,
    Quantity::TauEl,
    Quantity::TauM,
    Quantity::TauExt,
    Quantity::Temperature,
    Quantity::Tension,
];

/// Time of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stamp {
    /// Time of reception, s since 1970 UTC.
    utc_s: f64,
    time_ns: i64,
    segment: u32,
}

/// Frames in the order of reception, limited in time and memory; only recorded quantities are kept.
#[derive(Debug, Default)]
struct Ring {
    /// Whether each quantity is recorded.
    mask: [bool; QUANTITIES.len()],
    axes: usize,
    /// Number of values of a frame.
    stride: usize,
    stamps: VecDeque<Stamp>,
    values: VecDeque<f64>,
}

impl Ring {
    /// Adds a frame.
    ///
    /// # Realtime
    /// Allocates only if a frame has a quantity that none had before.
    fn push(&mut self, frame: &Frame, utc_s: f64, max_s: f64, max_bytes: usize) {
        let mut is_new = frame.q.len() != self.axes;
        for (recorded, quantity) in self.mask.iter_mut().zip(QUANTITIES) {
            if !*recorded && frame.get(quantity).iter().any(|x| !x.is_nan()) {
                (*recorded, is_new) = (true, true);
            }
        }
        if is_new {
            self.axes = frame.q.len();
            self.stride = self.recorded().map(|q| frame.get(q).len()).sum();
        }
        let per_frame = self.stride * size_of::<f64>() + size_of::<Stamp>();
        let most = (max_bytes / per_frame).max(1);
        if is_new {
            // The memory is used as far as the ring is filled.
            self.stamps = VecDeque::with_capacity(most);
            self.values = VecDeque::with_capacity(most * self.stride);
        }
        let is_old = |stamp: &Stamp| utc_s - stamp.utc_s > max_s;
        while self.stamps.len() >= most || self.stamps.front().is_some_and(is_old) {
            self.stamps.pop_front();
            self.values.drain(..self.stride.min(self.values.len()));
        }
        self.stamps.push_back(Stamp {
            utc_s,
            time_ns: frame.time_ns,
            segment: frame.segment,
        });
        for (recorded, quantity) in self.mask.into_iter().zip(QUANTITIES) {
            if recorded {
                self.values.extend(frame.get(quantity));
            }
        }
    }

    fn recorded(&self) -> impl Iterator<Item = Quantity> {
        let all = self.mask.into_iter().zip(QUANTITIES);
        all.filter_map(|(recorded, quantity)| recorded.then_some(quantity))
    }

    /// Returns a copy of the frames between two times, s since 1970 UTC.
    fn window(&self, from_utc_s: f64, to_utc_s: f64) -> Self {
        let start = self.stamps.partition_point(|s| s.utc_s < from_utc_s);
        let end = self.stamps.partition_point(|s| s.utc_s <= to_utc_s);
        let end = end.max(start);
        let values = start * self.stride..end * self.stride;
        Self {
            mask: self.mask,
            axes: self.axes,
            stride: self.stride,
            stamps: self.stamps.range(start..end).copied().collect(),
            values: self.values.range(values).copied().collect(),
        }
    }

    /// Sets a frame to that at an index.
    fn read(&self, index: usize, frame: &mut Frame) {
        let Some(stamp) = self.stamps.get(index) else {
            return;
        };
        (frame.time_ns, frame.segment) = (stamp.time_ns, stamp.segment);
        let mut at = index * self.stride;
        for quantity in self.recorded() {
            for value in frame.get_mut(quantity) {
                *value = self.values.get(at).copied().unwrap_or(f64::NAN);
                at += 1;
            }
        }
    }

    /// Writes the frames.
    fn write(&self, path: &Path, mut options: McapOptions) -> Result<(), sinew_log::LogError> {
        let has = |quantity| self.recorded().any(|q| q == quantity);
        options.quantities = Quantities {
            q: has(Quantity::Q),
            theta: has(Quantity::Theta),
            dq: has(Quantity::Dq),
            tau_el: has(Quantity::TauEl),
            tau_m: has(Quantity::TauM),
            tau_ext: has(Quantity::TauExt),
            temperature: has(Quantity::Temperature),
            tension: has(Quantity::Tension),
        };
        let mut writer = Box::new(McapWriter::create(path, &options)?);
        let mut frame = Frame::new(self.axes);
        for index in 0..self.stamps.len() {
            self.read(index, &mut frame);
            writer.write(&frame)?;
        }
        writer.finish()
    }
}

/// Window around a change.
#[derive(Debug)]
struct Window {
    joint: String,
    /// Time of the change, s since 1970 UTC.
    time_utc_s: f64,
    /// Number of the incident; `None`: none yet.
    incident: Option<u64>,
    /// Frames; `None`: the window is not over.
    frames: Option<Ring>,
}

/// Recorder of the incidents of a robot.
#[derive(Debug)]
pub struct Recorder {
    settings: RecordingSettings,
    /// Folder of the recordings of the robot; `None`: none are written.
    folder: Option<PathBuf>,
    options: McapOptions,
    ring: Ring,
    windows: Vec<Window>,
    /// Number of the last incident that has begun; a transaction that could not be stored comes again with the same one.
    last_begun: u64,
    writing: Vec<JoinHandle<()>>,
}

impl Recorder {
    /// Creates a recorder of a robot with this name; `store`: folder of the store, `None`: nothing is recorded.
    pub fn new(
        settings: RecordingSettings,
        store: Option<&Path>,
        robot: &str,
        live: &LiveOptions,
    ) -> Self {
        let store = store.filter(|_| settings.is_on);
        let name = |name: &Option<String>| name.clone();
        let own = live.axes.iter().any(|axis| axis.motor.is_some());
        let motors = live.axes.iter().map(|axis| {
            let name = axis.motor.as_ref().or(axis.joint.as_ref());
            name.cloned().unwrap_or_default()
        });
        Self {
            settings,
            folder: store.map(|store| folder(store, robot)),
            options: McapOptions {
                joints: (live.axes.iter()).filter_map(|a| name(&a.joint)).collect(),
                motors: motors.filter(|_| own).collect(),
                tendons: live.axes.iter().map(|axis| name(&axis.tendon)).collect(),
                ..McapOptions::default()
            },
            ring: Ring::default(),
            windows: Vec::new(),
            last_begun: 0,
            writing: Vec::new(),
        }
    }

    /// Adds a frame received at a time, s since 1970 UTC.
    pub(super) fn frame(&mut self, frame: &Frame, utc_s: f64) {
        if self.folder.is_some() {
            let RecordingSettings {
                before_s,
                after_s,
                memory_bytes,
                ..
            } = self.settings;
            let max_s = before_s + after_s + FOUND_WITHIN_S;
            self.ring.push(frame, utc_s, max_s, memory_bytes);
        }
    }

    /// Notes a change of a tendon, s since 1970 UTC.
    pub(super) fn change(&mut self, joint: &str, time_utc_s: f64, now_utc_s: f64) {
        self.add(joint, time_utc_s, None);
        self.copy(now_utc_s);
    }

    fn add(&mut self, joint: &str, time_utc_s: f64, incident: Option<u64>) {
        if self.folder.is_none() {
            return;
        }
        if self.windows.len() >= MAX_WINDOWS {
            let without = self.windows.iter().position(|w| w.incident.is_none());
            self.windows.remove(without.unwrap_or(0));
        }
        self.windows.push(Window {
            joint: joint.into(),
            time_utc_s,
            incident,
            frames: None,
        });
    }

    /// Notes the incidents that begin with a transaction, and the end of the session that it records.
    pub(super) fn transaction(&mut self, transaction: &Transaction, now_utc_s: f64) {
        for entry in &transaction.journal {
            if let Event::Incident { incident } = &entry.event
                && incident.number > self.last_begun
                && incident.evidence.len() == 1
                && matches!(
                    incident.phase,
                    IncidentPhase::Suspected | IncidentPhase::Confirmed
                )
            {
                self.last_begun = incident.number;
                self.begin(incident, transaction, now_utc_s);
            }
        }
        if !transaction.records.is_empty() {
            self.windows.retain(|window| window.incident.is_some());
        }
    }

    fn begin(&mut self, incident: &Incident, transaction: &Transaction, now_utc_s: f64) {
        let alarms = transaction.alarms.iter().flat_map(|of| &of.alarms);
        let mut times = alarms.filter_map(|alarm| match alarm.cause {
            AlarmCause::StepChange { time_utc_s, .. }
                if alarm.key.joint.as_ref() == Some(&incident.joint) =>
            {
                Some(time_utc_s)
            }
            _ => None,
        });
        let time_utc_s = times.next_back().unwrap_or(now_utc_s);
        let apart_s = |window: &&mut Window| (window.time_utc_s - time_utc_s).abs();
        let of_joint = self.windows.iter_mut();
        let of_joint = of_joint.filter(|w| w.incident.is_none() && w.joint == incident.joint);
        match of_joint.min_by(|a, b| apart_s(a).total_cmp(&apart_s(b))) {
            Some(window) => window.incident = Some(incident.number),
            None => self.add(&incident.joint, now_utc_s, Some(incident.number)),
        }
    }

    /// Copies the frames of windows that are over.
    fn copy(&mut self, now_utc_s: f64) {
        let RecordingSettings {
            before_s, after_s, ..
        } = self.settings;
        for window in &mut self.windows {
            let [from, to] = [window.time_utc_s - before_s, window.time_utc_s + after_s];
            if window.frames.is_none() && now_utc_s >= to {
                window.frames = Some(self.ring.window(from, to));
            }
        }
    }

    /// Writes the windows of incidents in a thread. If `ends`, windows that are not over are written as well.
    pub(super) fn tick(
        &mut self,
        now_utc_s: f64,
        description: Option<&str>,
        (slot, health): (&Arc<Slot>, &Arc<Health>),
        ends: bool,
    ) {
        self.copy(if ends { f64::INFINITY } else { now_utc_s });
        self.writing.retain(|thread| !thread.is_finished());
        let is_ready = |window: &mut Window| window.incident.is_some() && window.frames.is_some();
        for window in self.windows.extract_if(.., is_ready) {
            let (Some(number), Some(frames), Some(folder)) =
                (window.incident, window.frames, self.folder.clone())
            else {
                continue;
            };
            if frames.stamps.is_empty() {
                continue;
            }
            let options = McapOptions {
                robot_description: description.map(str::to_owned),
                ..self.options.clone()
            };
            let (settings, slot, health) = (self.settings, Arc::clone(slot), Arc::clone(health));
            let thread = std::thread::Builder::new().name("recording".into());
            let work = move || {
                let path = file(&folder, number);
                let written = create(&folder).map_err(|e| e.to_string());
                let written =
                    written.and_then(|()| frames.write(&path, options).map_err(|e| e.to_string()));
                if let Err(reason) = written {
                    health.log(&words::log::recording_not_written(path.display(), &reason));
                }
                slot.set_recordings(retain(&folder, &settings));
            };
            // Without a thread the recording is lost; the incident is stored in any case.
            self.writing.extend(thread.spawn(work));
        }
    }

    /// Returns the numbers of the incidents that have a recording.
    pub(super) fn recordings(&self) -> Vec<u64> {
        let all = self.folder.as_deref().map(files).unwrap_or_default();
        all.into_iter().map(|(number, _)| number).collect()
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        for thread in self.writing.drain(..) {
            let _panicked = thread.join();
        }
    }
}

/// Returns the folder of the recordings of a robot in that of the store.
pub(crate) fn folder(store: &Path, robot: &str) -> PathBuf {
    store.join("incidents").join(robot)
}

/// Returns the recording of an incident in the folder of its robot.
pub(crate) fn file(folder: &Path, number: u64) -> PathBuf {
    folder.join(format!("incident-{number:06}.mcap"))
}

fn create(folder: &Path) -> std::io::Result<()> {
    let mut builder = std::fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

/// Returns the recordings of a folder with their lengths, bytes, the oldest first.
fn files(folder: &Path) -> Vec<(u64, u64)> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let recordings = entries.filter_map(|entry| {
        let name = entry.file_name();
        let number = name.to_str()?.strip_prefix("incident-")?;
        let number = number.strip_suffix(".mcap")?.parse().ok()?;
        Some((number, entry.metadata().ok()?.len()))
    });
    let mut all: Vec<(u64, u64)> = recordings.collect();
    all.sort_unstable();
    all
}

/// Removes the oldest recordings beyond the limits; returns the numbers of those that remain.
fn retain(folder: &Path, settings: &RecordingSettings) -> Vec<u64> {
    let mut all = files(folder);
    let total = |all: &[(u64, u64)]| all.iter().map(|(_, bytes)| bytes).sum::<u64>();
    while all.len() > settings.max_files.max(1)
        || (all.len() > 1 && total(&all) > settings.max_bytes)
    {
        let (oldest, _) = all.remove(0);
        let _gone = std::fs::remove_file(file(folder, oldest));
    }
    all.into_iter().map(|(number, _)| number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(second: f64) -> Frame {
        let mut frame = Frame::new(2);
        frame.time_ns = (1e9 * second) as i64;
        (frame.q, frame.theta) = (vec![second, -second], vec![2.0 * second, 0.0]);
        frame
    }

    /// A frame has 4 values and a stamp of 24 bytes: 56 bytes.
    #[test]
    fn ring_is_limited_in_time_and_memory() {
        for (max_s, max_bytes, oldest) in [(20.0, 1 << 20, 80.0), (1e3, 56 * 11, 90.0)] {
            let mut ring = Ring::default();
            for second in 0..=100 {
                let second = f64::from(second);
                ring.push(&frame(second), second, max_s, max_bytes);
            }
            assert_eq!(ring.stamps.front().map(|s| s.utc_s), Some(oldest));
            assert_eq!(ring.values.len(), 4 * ring.stamps.len());
            let window = ring.window(92.0, 95.5);
            let mut read = Frame::new(2);
            window.read(3, &mut read);
            assert_eq!((window.stamps.len(), read.time_ns), (4, 95_000_000_000));
            assert_eq!((read.q, read.theta), (vec![95.0, -95.0], vec![190.0, 0.0]));
            assert!(read.dq.iter().all(|x| x.is_nan()));
        }
    }

    #[test]
    fn oldest_recordings_are_removed_beyond_limits() {
        let folder = tempfile::tempdir().unwrap();
        let options = McapOptions {
            joints: vec!["a".into(), "b".into()],
            ..McapOptions::default()
        };
        let mut ring = Ring::default();
        ring.push(&frame(1.0), 1.0, 10.0, 1 << 20);
        for number in 1..=5 {
            let path = file(folder.path(), number);
            ring.write(&path, options.clone()).unwrap();
        }
        let bytes = files(folder.path())[0].1;
        let mut settings = RecordingSettings {
            max_files: 4,
            ..RecordingSettings::default()
        };
        assert_eq!(retain(folder.path(), &settings), [2, 3, 4, 5]);
        settings.max_bytes = 2 * bytes;
        assert_eq!(retain(folder.path(), &settings), [4, 5]);
        settings.max_bytes = 1;
        assert_eq!(retain(folder.path(), &settings), [5]);
    }
}
