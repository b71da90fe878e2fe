//! Recordings of tendon-driven robots as frames: MCAP/ROS 2, CSV, Parquet, NumPy; SQLite bags with the feature `db3`.
//!
//! Measured data only: no physics, no clock, no network. Layers: [`decode`] (bytes to messages), [`assemble`]
//! (samples to frames, time as an argument), [`live`] (messages to frames online), and the files on top.
//!
//! ```no_run
//! use sinew_log::{OpenOptions, open};
//!
//! # fn main() -> Result<(), sinew_log::LogError> {
//! let mut recording = open("run.mcap".as_ref(), &OpenOptions::default())?;
//! recording.select(&["shoulder", "elbow"])?;
//! while let Some(frame) = recording.next_frame()? {
//!     // Reset filters where `frame.segment` changes.
//!     let twist_rad = frame.theta[1] - frame.q[1];
//!     println!("{} ns: {twist_rad} rad", frame.time_ns);
//! }
//! if recording.health().is_damaged() {
//!     eprintln!("{:?}", recording.health().damage);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # From messages to frames
//!
//! * A frame exists for each time stamp of the joint side (`sensor_msgs/msg/JointState`), or for each row of
//!   a table. The time stamp is `header.stamp`, or the log time in a topic whose stamps are zero. A single stamp of
//!   zero in a topic with stamps is the start of a simulated clock, or replaced by the log time on the clock of the
//!   other stamps and counted.
//! * Values are found by joint *name*. A message may hold a subset of the joints, another order, or more; two
//!   messages with one stamp and different joints make one frame.
//! * The motor side (`control_msgs/msg/DynamicJointState`, or a second `JointState` topic) and the external
//!   torque are taken at the same stamp, or else interpolated linearly between their neighbours, both of
//!   which must lie within [`OpenOptions::interpolate_s`] (0.05 s); otherwise they are NaN. A joint that is missing in
//!   these neighbours is interpolated between the nearest samples that contain it within the same interval.
//! * Samples are sorted within [`OpenOptions::reorder_s`] (0.25 s) or 16 384 samples (32 MiB), whichever is
//!   less. A joint-side sample waits for a stalled motor side four times that long.
//! * Tensions of tendons (a column `tension.TENDON_n`, or a topic that the mapping names) are treated as the
//!   motor side. An axis without a joint has a `q` of 0, see [`Axis`].
//! * NaN means "not recorded"; a frame holds no infinities.
//!
//! # Wrap-around
//!
//! `q` and `theta` are unwrapped per joint with a period of 2π, or the mapping's `wrap_period` (a motor turn
//! behind a gear is 2π/ratio). A change of more than half a period from one frame to the next is moved to the
//! nearest turn. After a gap the turn count is kept the same way, and `theta` is moved to the turn at which
//! `theta − q` changes least, so that both sides are on the same turn. A signal whose values span more than
//! one period does not come from a wrapping encoder and is not changed; neither are lengths (`_m` columns,
//! units of length).
//!
//! # What happens with bad input
//!
//! | input | decision |
//! |---|---|
//! | folder, pattern, several files | parts of one recording, in the order of their times; of different topics: rejected |
//! | file packed with zstd | unpacked to a temporary file |
//! | empty file, other format, binary, broken header | rejected: [`LogError::NotARecording`], with the content found |
//! | MCAP without joint states, or cut off before the first | rejected, with the existing topics and the damage |
//! | MCAP without index or summary | read; nothing depends on them |
//! | MCAP not closed (no footer) | read to the end; damage of 0 bytes is reported |
//! | MCAP cut off inside a record or chunk | read up to the cut: the compressed blocks that are complete are unpacked and used; the rest is damage |
//! | chunk whose checksum, size or compression is wrong, framing intact | that chunk is skipped as a whole, the next is read, a new segment starts, damage |
//! | framing broken (no record, length beyond the file) | reading stops there; the rest is damage |
//! | first chunk lost | channels are known from the summary; without one: rejected |
//! | wrong length field (record, chunk, string, sequence) | never allocated for: compared with the bytes that are there, [`OpenOptions::budget`], and what the compression can expand to |
//! | message that cannot be decoded, XCDR2 | skipped and counted; the first 16 are described |
//! | big-endian CDR | read |
//! | fewer values than names | the missing ones are NaN; counted |
//! | more values than names; a name twice | surplus ignored; the first counts |
//! | joint that appears later than the others | frames before have NaN; its start is in [`Health::late_starts`] |
//! | joints that appear later than the first 16 384 messages of a topic | named in [`Health::unknown_joints`] and ignored |
//! | requested joint is not recorded | rejected, with the names and the nearest |
//! | several topics could be the joint side, or the motor side | rejected, with the candidates |
//! | one topic or column for both sides; a requested interface that is missing | rejected |
//! | motor side missing, or not near in time | frames without it (NaN); counted |
//! | out of order within the window | reordered; counted |
//! | later than the window | discarded; counted. Eight in a row are a clock step |
//! | duplicate time stamp | the first is kept; counted |
//! | rows or messages of a second publisher between those of the first | excluded; counted |
//! | clock that steps back permanently, or ahead while the log times continue | new segment; counted; the time of the frames continues by the log times, else by the last period |
//! | pause longer than [`OpenOptions::gap_s`] (0.5 s) | new segment; counted, the longest kept |
//! | NaN or infinity recorded | NaN in the frame; counted per signal |
//! | signal all NaN, constant (100 frames, 1 s) | reported as implausible |
//! | joint position beyond 2π | reported as "looks like degrees"; not converted |
//! | times in a unit that gives an unusual rate | reported, with the unit that gives a usual one |
//! | `theta` a constant multiple of `q`, with a factor outside 0.5 to 2 | reported in [`Health::motor_ratios`], with the line of the mapping that corrects unit, gear ratio or sign |
//! | table in UTF-16 with its mark, or in code page 1252; `;`, tab or blanks; decimal comma | read |
//! | table without a time or joint column, column twice | rejected |
//! | CSV line that begins with `#`, `%`, `//` or, without `;` between cells, `;` | a comment, or the header where numbers follow |
//! | names and values above the header of a table, units below it | skipped |
//! | table without a header | rejected, unless the mapping names columns by numbers |
//! | arrays of NumPy | columns by the names of an archive, or by numbers; arrays of another length are ignored |
//! | array cut off | a `.npy` array is read up to there; an archive is rejected |
//! | compressed array whose checksum or size is wrong | rejected; never unpacked beyond the size that its shape states |
//! | ROS 1 bag, MATLAB, HDF5 | rejected, with the command that converts it |
//! | clock times and dates as times | read; a clock continues after midnight |
//! | PLC scope export | read, if its channels have the same times |
//! | MCAP with messages of ROS 1 | joint states are read |
//! | non-numeric CSV cell | rejected with line, column and value; empty, `nan`, `null`, `n/a` are NaN |
//! | CSV row with too few or too many cells | padded, or cut; counted |
//! | CSV last line without line end and with too few cells or half a number | discarded; damage. A number truncated to a shorter number is not detected |
//! | CSV or Parquet row without a time | discarded; counted |
//! | table whose clock runs backwards, or most of whose rows have the time of the row before | rejected |
//! | CSV row or unclosed quote over 4 MiB | rejected |
//! | Parquet with lists of numbers | each element is a column: `list.0`, or by the name that a LeRobot data set gives it |
//! | Parquet without its footer | rejected: it cannot be recovered |
//! | SQLite bag with a damaged page | read up to there; the rest is damage |
//! | Parquet page that cannot be decoded | reading stops there; the rest is damage |
//! | mapping with an unknown key, unit or impossible factor | rejected with file and line |
//!
//! A damaged or lossy recording is never an error of a call: see [`Health::is_damaged`].

pub mod assemble;
pub mod decode;
pub mod encode;
mod error;
mod files;
mod frame;
mod health;
mod info;
pub mod live;
mod mapping;
mod motor_ratio;
mod options;
mod sources;

pub use error::{Ambiguity, LogError};
pub use files::{
    Arrays, Cell, CellKind, Column, Compression, CsvWriter, Format, FrameWriter, GivenMessages,
    MappingProposal, McapOptions, McapWriter, Packing, Progress, ProposedJoint, ProposedSource,
    ProposedTime, ReadSeek, RecordedNames, Recording, RowWriter, SchemaColumn, Table, TableColumn,
    TableSchema, TableWriter, Topic, TopicWriter, open, open_parts, parse_mcap_record,
    recordings_of,
};
pub use frame::{Axis, Channels, Frame, OwnedAxis, Quantities, Quantity};
pub use health::{
    Damage, EVENT_LIMIT, Event, EventKind, Health, LateStart, MUCH_LOST, SecondPublisher,
    SignalCount, SignalCoverage, StreamRole, StreamTiming,
};
pub use info::{FrameCounter, RecordingInfo};
pub use live::JointInfo;
pub use mapping::{JointEffort, Mapping};
pub use motor_ratio::{MotorRatio, RatioSums, describe_ratios};
pub use options::OpenOptions;
pub use sinew_files::Budget;
pub use sources::{SignalSource, TopicInfo, TopicUse};
