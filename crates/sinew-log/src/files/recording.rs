//! Opening a recording of any format and reading it frame by frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::chain::Chain;
use super::lerobot::ListNames;
use super::mcap::{GivenMessages, GivenReader};
use super::opener::{UNPACKED_LIMIT_BYTES, open_file, open_reader};
use super::parts::files;
use super::read_seek::ReadSeek;
use super::reader::{Format, Progress, Reader};
use super::spool::Spool;
use super::table::{ArrayReader, Arrays};
use crate::assemble::Joiner;

use crate::error::LogError;
use crate::frame::{Channels, DrivenJoint, Frame};
use crate::health::Health;
use crate::options::{OpenOptions, check_options};
use crate::sources::{SignalSource, TopicInfo};
use sinew_files::names::{hint, list};

/// A recording being read: frames in the order of their stamps.
///
/// Memory is bounded by one chunk (MCAP), row (CSV) or row-group page
/// (Parquet) and the reorder window, never by the file.
pub struct Recording {
    reader: Box<dyn Reader>,
    file: String,
    options: OpenOptions,
    /// All joints and what is recorded of them, as found.
    found: (Vec<String>, Channels),
    joints: Vec<String>,
    driven: Vec<DrivenJoint>,
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

/// Opens a recording; the format is told by the content, then by the extension.
///
/// `path` is a file; a folder, whose recordings are its parts (those that the `metadata.yaml` of a ROS 2 bag
/// names, where there is one); a pattern with `*` or `?` in the file's name; or `-`, standard input. A file
/// packed with zstd is unpacked first. Parts follow each other in the order of their times.
///
/// # Errors
/// [`LogError`] when the file cannot be read, is no recording, or lacks what the options ask
/// for. Damage is not an error; see [`Recording::health`].
pub fn open(path: &Path, options: &OpenOptions) -> Result<Recording, LogError> {
    let name = path.display().to_string();
    check_options(options, &name)?;
    if name == "-" {
        let spool = Spool::of(std::io::stdin().lock(), UNPACKED_LIMIT_BYTES);
        let spool = spool.map_err(|source| LogError::io("standard input", "read", source))?;
        return Recording::from_reader(Box::new(spool), "standard input", options);
    }
    let reader: Box<dyn Reader> = match &files(path)?[..] {
        [file] => open_file(file, options)?,
        parts => Box::new(Chain::open(parts, options)?),
    };
    Ok(Recording::new(reader, &name, options))
}

/// Opens files that are one recording, in whatever order they are given: each may be anything that [`open`]
/// takes but standard input.
///
/// # Errors
/// As [`open`]; files of different formats or topics, one that is there twice.
pub fn open_parts(paths: &[PathBuf], options: &OpenOptions) -> Result<Recording, LogError> {
    if let [path] = paths {
        return open(path, options);
    }
    let mut all = Vec::new();
    for path in paths {
        all.extend(files(path)?);
    }
    let Some(first) = paths.first() else {
        return Err(LogError::request("", "no file is named"));
    };
    let name = format!("{} and {} more", first.display(), paths.len() - 1);
    check_options(options, &name)?;
    let reader = Box::new(Chain::open(&all, options)?);
    Ok(Recording::new(reader, &name, options))
}

impl Recording {
    /// Opens a recording from anything readable, such as bytes in memory.
    ///
    /// `name` is used in messages, and its extension where the content does not tell the format.
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
    /// No joints, or one twice; what is wrong with the times is said when they are read.
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
        let driven = DrivenJoint::of_joints(&joints);
        Recording {
            joiner: reader.joiner(&driven, options),
            driven,
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

    /// What it was opened as.
    pub fn name(&self) -> &str {
        &self.file
    }

    /// The format found.
    pub fn format(&self) -> Format {
        self.reader.format()
    }

    /// Where each quantity found is read from: topic and field or interface, or the columns.
    pub fn sources(&self) -> Vec<SignalSource> {
        self.reader.sources()
    }

    /// The topics of the recording and what each is taken for; counts are complete after the last frame.
    pub fn topics(&self) -> Vec<TopicInfo> {
        self.reader.topics()
    }

    /// Columns of a table that nothing is read from.
    pub fn unused_columns(&self) -> Vec<String> {
        self.reader.unused_columns()
    }

    /// The joints of the frames: all found, in the recording's order, or those selected.
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// Which quantities are recorded for each of [`Self::joints`].
    ///
    /// For MCAP this is what the first messages hold; a topic that starts later
    /// than the part looked at is announced by the summary only.
    pub fn channels(&self) -> &Channels {
        &self.channels
    }

    /// The URDF in the recording's `/robot_description`, if there is one.
    pub fn robot_description(&self) -> Option<&str> {
        self.reader.robot_description()
    }

    /// Chooses the joints of the frames and their order. Call before the first frame.
    ///
    /// # Errors
    /// A name that is not recorded or given twice, with the names there are and the nearest
    /// one; or a call after the first frame. The selection is then unchanged.
    pub fn select(&mut self, joints: &[&str]) -> Result<(), LogError> {
        self.select_driven(joints, &vec![None; joints.len()])
    }

    /// Selects joints as [`select`](Self::select) does, with the motor at whose shaft position and torque are measured, `theta.MOTOR_rad` and
    /// `tau_m.MOTOR_nm`. `None`: those under the name of the joint, reflected to it. A motor that is not recorded has neither. Arrays in
    /// memory have motors in the order of the joints, whatever their names.
    ///
    /// The position of a motor at its shaft moves with several joints, or by a ratio: its turns are counted from one sample to the next, and it is not
    /// compared with the joint's.
    ///
    /// # Errors
    /// As `select`; a number of motors that is not that of the joints.
    pub fn select_driven(
        &mut self,
        joints: &[&str],
        motors: &[Option<&str>],
    ) -> Result<(), LogError> {
        let request = |reason: String| LogError::request(&self.file, reason);
        if self.started {
            return Err(request(
                "joints can be selected before the first frame only".to_owned(),
            ));
        }
        if motors.len() != joints.len() {
            let (motors, joints) = (motors.len(), joints.len());
            return Err(request(format!("{motors} motors for {joints} joints")));
        }
        let is_arrays = self.format() == Format::Arrays;
        let mut channels = Channels {
            joints: Vec::with_capacity(joints.len()),
            temperature: self.found.1.temperature,
        };
        let find = |name: &str| self.found.0.iter().position(|known| known == name);
        for (place, (joint, motor)) in joints.iter().zip(motors).enumerate() {
            let Some(index) = find(joint) else {
                let hint = hint(joint, &self.found.0);
                return Err(request(format!(
                    "no joint '{joint}'{hint} joints are {}",
                    list(&self.found.0)
                )));
            };
            if joints[..place].contains(joint) {
                return Err(request(format!("joint '{joint}' is selected twice")));
            }
            let mut own = self.found.1.joints[index];
            let other = motor.filter(|motor| motor != joint && !is_arrays);
            if let Some(motor) = other {
                let of_motor = find(motor).map(|index| self.found.1.joints[index]);
                own.take_motor(of_motor.unwrap_or_default());
            }
            channels.joints.push(own);
        }
        self.joints = joints.iter().map(|&joint| joint.to_owned()).collect();
        self.channels = channels;
        let pairs = joints.iter().zip(motors);
        let driven = pairs.map(|(joint, motor)| DrivenJoint {
            motor: motor.filter(|_| !is_arrays).unwrap_or(joint).to_owned(),
            ..DrivenJoint::new(joint, *motor)
        });
        self.driven = driven.collect();
        self.reader.select(&self.driven);
        self.joiner = self.reader.joiner(&self.driven, &self.options);
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

    /// What was lost or repaired, and why; complete after the last frame.
    pub fn health(&self) -> &Health {
        &self.health
    }

    /// How far the file has been read.
    pub fn progress(&self) -> Progress {
        self.reader.progress()
    }
}
