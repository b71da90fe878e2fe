//! Opening a recording of any format and reading it frame by frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::chain::Chain;
use super::lerobot::ListNames;
use super::mcap::{GivenMessages, GivenReader};
use super::opener::{open_file, open_reader};
use super::parts::files;
use super::read_seek::ReadSeek;
use super::reader::{Format, Progress, Reader};
use super::spool::Spool;
use super::table::{ArrayReader, Arrays};
use crate::assemble::Joiner;

use crate::error::LogError;
use crate::frame::{Axis, AxisNames, Channels, Frame};
use crate::health::Health;
use crate::options::{OpenOptions, check_options};
use crate::sources::{SignalSource, TopicInfo};
use sinew_files::names::{hint, list};

/// Recording that is being read: frames in the order of their time stamps.
///
/// Memory is bounded by one chunk (MCAP), row (CSV) or row-group page
/// (Parquet) and the reorder window, never by the file.
pub struct Recording {
    reader: Box<dyn Reader>,
    file: String,
    options: OpenOptions,
    /// Joints of the recording and the recorded quantities of each.
    found: (Vec<String>, Channels),
    joints: Vec<String>,
    axes: Vec<AxisNames>,
    channels: Channels,
    joiner: Joiner,
    health: Health,
    started: bool,
    ended: bool,
    finished: bool,
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording")
            .field("file", &self.file)
            .field("format", &self.format())
            .field("joints", &self.joints)
            .finish_non_exhaustive()
    }
}

/// Opens a recording; the format is detected from the content, then from the extension.
///
/// `path` is a file; a folder, whose recordings are its parts (those that the `metadata.yaml` of a ROS 2 bag
/// names, where there is one); a pattern with `*` or `?` in the file's name; or `-`, standard input. A file
/// packed with zstd is unpacked first. Parts follow each other in the order of their times.
///
/// # Errors
/// Returns [`LogError`] if the file cannot be read, is not a recording, or lacks a requested topic, joint or
/// column. Damage is not an error; see [`Recording::health`].
pub fn open(path: &Path, options: &OpenOptions) -> Result<Recording, LogError> {
    let name = path.display().to_string();
    check_options(options, &name)?;
    if name == "-" {
        let most = options.budget.unpacked.value();
        let spool = Spool::of(std::io::stdin().lock(), most);
        let spool = spool.map_err(|source| LogError::io("standard input", "read", source))?;
        return Recording::from_reader(Box::new(spool), "standard input", options);
    }
    let reader: Box<dyn Reader> = match &files(path)?[..] {
        [file] => open_file(file, options)?,
        parts => Box::new(Chain::open(parts, options)?),
    };
    Ok(Recording::new(reader, &name, options))
}

/// Opens the files of one recording, in any order. Each may have any format that [`open`] accepts, except standard
/// input.
///
/// # Errors
/// Returns the errors of [`open`], and an error for files of different formats or topics and for a duplicate file.
pub fn open_parts(paths: &[PathBuf], options: &OpenOptions) -> Result<Recording, LogError> {
    if let [path] = paths {
        return open(path, options);
    }
    let mut all = Vec::new();
    for path in paths {
        all.extend(files(path)?);
    }
    let Some(first) = paths.first() else {
        return Err(LogError::request("", "no file is specified"));
    };
    let name = format!("{} and {} more", first.display(), paths.len() - 1);
    check_options(options, &name)?;
    let reader = Box::new(Chain::open(&all, options)?);
    Ok(Recording::new(reader, &name, options))
}

impl Recording {
    /// Opens a recording from any readable source, such as bytes in memory.
    ///
    /// `name` is used in messages, and its extension if the content does not determine the format.
    ///
    /// # Errors
    /// As [`open`].
    pub fn from_reader(
        reader: Box<dyn ReadSeek>,
        name: &str,
        options: &OpenOptions,
    ) -> Result<Recording, LogError> {
        check_options(options, name)?;
        Ok(Self::new(
            open_reader(reader, name, options, &ListNames::default(), None)?,
            name,
            options,
        ))
    }

    /// Opens arrays in memory; `name` is used in messages.
    ///
    /// # Errors
    /// Returns [`LogError`] if there is no joint or a duplicate one; errors of the times are returned during
    /// reading.
    pub fn from_arrays(
        arrays: Box<dyn Arrays>,
        name: &str,
        options: &OpenOptions,
    ) -> Result<Recording, LogError> {
        check_options(options, name)?;
        let reader = ArrayReader::open(arrays, name, options)?;
        Ok(Self::new(Box::new(reader), name, options))
    }

    /// Opens messages in memory, topics chosen as in a file; `name` is used in messages.
    ///
    /// # Errors
    /// As [`open`].
    pub fn from_messages(
        messages: Arc<GivenMessages>,
        name: &str,
        options: &OpenOptions,
    ) -> Result<Recording, LogError> {
        check_options(options, name)?;
        let reader = GivenReader::open(messages, name, options)?;
        Ok(Self::new(Box::new(reader), name, options))
    }

    fn new(reader: Box<dyn Reader>, name: &str, options: &OpenOptions) -> Self {
        let (joints, channels) = reader.found();
        let axes = AxisNames::of_joints(&joints);
        Recording {
            joiner: reader.joiner(&axes, options),
            axes,
            reader,
            file: name.to_owned(),
            options: options.clone(),
            found: (joints.clone(), channels.clone()),
            joints,
            channels,
            health: Health::default(),
            started: false,
            ended: false,
            finished: false,
        }
    }

    /// Name with which the recording was opened.
    pub fn name(&self) -> &str {
        &self.file
    }

    /// The format found.
    pub fn format(&self) -> Format {
        self.reader.format()
    }

    /// Source of each quantity: topic and field or interface, or the columns.
    pub fn sources(&self) -> Vec<SignalSource> {
        self.reader.sources()
    }

    /// Topics of the recording and their roles; counts are complete after the last frame.
    pub fn topics(&self) -> Vec<TopicInfo> {
        self.reader.topics()
    }

    /// Columns of a table that are not used.
    pub fn unused_columns(&self) -> Vec<String> {
        self.reader.unused_columns()
    }

    /// Joints of the frames: all found, in the order of the recording, or those selected. Motors are among
    /// those found if they have names of their own; tendons are not, see [`Self::tendons`].
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// Tendons with a recorded tension, N, independent of the selection.
    pub fn tendons(&self) -> &[String] {
        self.reader.tendons()
    }

    /// The axes of the frames: one per entry of their arrays, in that order.
    pub fn axes(&self) -> impl Iterator<Item = Axis<'_>> {
        self.axes.iter().map(AxisNames::axis)
    }

    /// Recorded quantities of each of [`Self::axes`], which are [`Self::joints`] unless axes without a joint
    /// were selected.
    ///
    /// For MCAP they are determined from the first messages; a topic that starts later is only listed in the summary.
    pub fn channels(&self) -> &Channels {
        &self.channels
    }

    /// Robot description (URDF) in the recording's `/robot_description`, if there is one.
    pub fn robot_description(&self) -> Option<&str> {
        self.reader.robot_description()
    }

    /// Chooses the joints of the frames and their order. Call before the first frame.
    ///
    /// # Errors
    /// Returns an error for a name that is not recorded, with the recorded names and the most similar one, for a
    /// duplicate name, and for a call after the first frame. The selection is then unchanged.
    pub fn select(&mut self, joints: &[&str]) -> Result<(), LogError> {
        let axes = joints.iter().map(|joint| Axis::of_joint(joint));
        self.select_axes(&Vec::from_iter(axes))
    }

    /// Selects the axes of the frames and their order: for each a joint, the motor at whose shaft position
    /// and torque are measured (`theta.MOTOR_rad`, `tau_m.MOTOR_nm`), and the tendon whose tension is
    /// measured (`tension.TENDON_n`). Call it before the first frame.
    ///
    /// A motor or tendon that is not recorded has no values. Without a joint, `q` is 0 rad in every frame,
    /// and `dq` is 0 rad/s in every frame in which any joint has one. In arrays in memory the values of a
    /// motor and a tendon are at the index of the axis, under its [name](Axis::name).
    ///
    /// The position of a motor at its shaft moves with several joints, or by a ratio: its turns are counted
    /// from one sample to the next, and it is not compared with that of the joint.
    ///
    /// # Errors
    /// As `select`; an axis without any name.
    pub fn select_axes(&mut self, axes: &[Axis<'_>]) -> Result<(), LogError> {
        let request = |reason: String| LogError::request(&self.file, reason);
        if self.started {
            return Err(request(
                "joints can only be selected before the first frame".to_owned(),
            ));
        }
        let (found, has) = &self.found;
        let find = |name: &str| {
            let place = found.iter().position(|known| known == name)?;
            has.joints.get(place).copied()
        };
        let is_arrays = self.format() == Format::Arrays;
        let tendons = self.reader.tendons();
        let mut channels = Channels {
            joints: Vec::with_capacity(axes.len()),
            temperature: has.temperature,
        };
        let mut recorded = Vec::with_capacity(axes.len());
        for (place, axis) in axes.iter().enumerate() {
            let of_joint = axis.joint.map(|joint| {
                find(joint).ok_or_else(|| {
                    let (hint, names) = (hint(joint, found), list(found));
                    request(format!("no joint '{joint}'{hint} joints are {names}"))
                })
            });
            let mut own = of_joint.transpose()?.unwrap_or_default();
            if let Some((what, name)) = axis.taken(&axes[..place]) {
                return Err(request(format!("{what} '{name}' is selected twice")));
            }
            if axis.is_nameless() {
                return Err(request(format!(
                    "axis {place} has no name: specify a joint, a motor or a tendon"
                )));
            }
            let mut names = AxisNames::new(*axis);
            if is_arrays {
                let name = || Some(axis.name().to_owned());
                names.motor = name();
                names.tendon = axis.tendon.and_then(|_| name());
            }
            let is_other = names.motor != names.joint;
            if let Some(motor) = names.motor.as_deref().filter(|_| is_other) {
                own.take_motor(find(motor).unwrap_or_default());
            }
            // A missing tendon is not searched for.
            names.tendon = names.tendon.filter(|tendon| tendons.contains(tendon));
            own.tension = names.tendon.is_some();
            channels.joints.push(own);
            recorded.push(names);
        }
        let joints = axes.iter().filter_map(|axis| axis.joint);
        self.joints = joints.map(str::to_owned).collect();
        self.axes = axes.iter().copied().map(AxisNames::new).collect();
        self.channels = channels;
        self.reader.select(&recorded);
        self.joiner = self.reader.joiner(&recorded, &self.options);
        Ok(())
    }

    /// The next frame, or `None` at the end. The frame is lent until the next call.
    ///
    /// # Errors
    /// The operating system fails, or a table holds a cell that is no number. The
    /// recording has then ended: further calls return `None`.
    pub fn next_frame(&mut self) -> Result<Option<&Frame>, LogError> {
        self.started = true;
        while !self.joiner.is_ready() {
            if self.ended {
                self.finish();
                return Ok(None);
            }
            match self.reader.pull(&mut self.joiner, &mut self.health) {
                Ok(true) => {}
                Ok(false) => {
                    self.ended = true;
                    self.joiner.end();
                }
                Err(error) => {
                    self.ended = true;
                    self.joiner = self.reader.joiner(&[], &self.options);
                    return Err(error);
                }
            }
        }
        Ok(Some(self.joiner.compose(&mut self.health)))
    }

    fn finish(&mut self) {
        if !self.finished {
            self.finished = true;
            self.joiner.finish(&mut self.health);
        }
    }

    /// Losses and repairs with their reasons; complete after the last frame.
    pub fn health(&self) -> &Health {
        &self.health
    }

    /// Progress of reading the file.
    pub fn progress(&self) -> Progress {
        self.reader.progress()
    }
}
