//! What is read and simulated at most: no file makes a program ask for memory without end.
//!
//! The manual shows this list as a table.

/// A bound, checked before memory is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// Of what.
    pub of: &'static str,
    /// The largest value that is accepted.
    pub most: u64,
    /// Its unit.
    pub unit: &'static str,
    /// Why so many and no more.
    pub reason: &'static str,
}

impl Limit {
    /// [`most`](Self::most) as a length.
    pub const fn length(&self) -> usize {
        self.most as usize
    }

    /// Refuses what is above the bound, in words.
    ///
    /// # Errors
    /// What was found and what is allowed.
    pub fn check(&self, found: u64) -> Result<(), String> {
        match found > self.most {
            true => Err(format!("{found} {}; {self}", self.unit)),
            false => Ok(()),
        }
    }
}

/// "a robot has at most 256 moving joints".
impl std::fmt::Display for Limit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} at most {} {}", self.of, self.most, self.unit)
    }
}

macro_rules! limits {
    ($($(#[$doc:meta])* $name:ident = $most:expr, $unit:literal, $of:literal, $reason:literal;)*) => {
        $($(#[$doc])* pub const $name: Limit = Limit { of: $of, most: $most, unit: $unit, reason: $reason };)*

        /// All of them, in the order of the manual's table.
        pub const ALL: &[Limit] = &[$($name),*];
    };
}

const MIB: u64 = 1 << 20;

limits! {
    /// A description or a table that a person writes or exports.
    DESCRIPTION = 64 * MIB, "bytes", "robot.toml, a URDF, a duty or a table of times has",
        "the largest URDFs have some 10 MB";
    /// A file of settings.
    SETTINGS = 4 * MIB, "bytes", "a scenario, a bench, a mapping or a bag's metadata.yaml has",
        "written by hand";
    /// A rope of a catalogue.
    ROPE_ENTRY = MIB, "bytes", "a rope entry has", "written by hand";
    /// `meta/info.json` of a data set.
    DATA_SET_INFO = 16 * MIB, "bytes", "meta/info.json of a data set has", "names of columns";
    /// A table of sessions, or a document of an estimate.
    SESSIONS = 256 * MIB, "bytes", "a table of sessions has", "25,000 sessions of 32 joints";
    /// A baseline.
    BASELINE = 256 * MIB, "bytes", "a baseline has", "60 joints take 27 MB, and it grows with their square";
    /// Results that a stopped study goes on with.
    STUDY = 512 * MIB, "bytes", "the file of a study has", "100,000 simulated years";
    /// Elements and texts of a URDF.
    URDF_NODES = 1_000_000, "nodes", "a URDF has", "the largest robots have some ten thousand; depth needs no bound of its own";
    /// Moving joints of a URDF.
    URDF_JOINTS = 256, "moving joints", "a robot has", "the work of a check grows with the cube; a humanoid with hands has 100";
    /// A creep test.
    TEST_FILE = 256 * MIB, "bytes", "a creep test has", "16 bytes for each cell allowed";
    /// Cells of a creep test, a row as four at least.
    TEST_CELLS = 16_000_000, "cells", "a creep test has",
        "32 bytes of memory each; a day at 10 Hz with ten columns is half of it";
    /// What a workbook holds beside its sheets.
    WORKBOOK_PARTS = 128 * MIB, "bytes", "a workbook's texts and styles have", "unpacked; kept in memory";
    /// The sheets of a workbook.
    WORKBOOK_SHEETS = 2048 * MIB, "bytes", "a workbook's sheets have", "unpacked; read piece by piece";
    /// A text of a workbook.
    WORKBOOK_TEXT = MIB, "bytes", "a cell or an element of a workbook has", "spreadsheet programs allow 32,767 characters";
    /// A recording that is unpacked or comes through a pipe, on the disk.
    UNPACKED = 64 << 30, "bytes", "a recording unpacked has", "kept in the folder for temporary files, not in memory";
    /// A chunk of an MCAP or a message.
    CHUNK = 256 * MIB, "bytes", "a chunk or message of a recording has", "recorders write 1 to 8 MB; a length in a file is compared with the bytes there before";
    /// A summary of an MCAP.
    SUMMARY = 64 * MIB, "bytes", "the summary of an MCAP has", "a longer one is left aside and the file read from its start";
    /// A line of a recording.
    CSV_LINE = 4 * MIB, "bytes", "a row or header of a CSV recording has", "65,536 columns of 64 bytes";
    /// Columns of a recording.
    COLUMNS = 65_536, "columns", "a recording has", "a thousand joints with 60 quantities";
    /// A page of a Parquet file.
    PARQUET_PIECE = 256 * MIB, "bytes", "a piece of a Parquet file has", "writers make pages of 1 MB; compared with the bytes there before";
    /// A picture's file.
    PICTURE_FILE = 256 * MIB, "bytes", "a picture has", "not compressed, 100 megapixels";
    /// A picture's side.
    PICTURE_SIDE = 20_000, "px", "a side of a picture has", "the largest sensors have 15,000";
    /// Memory for a picture's pixels.
    PICTURE_MEMORY = 1024 * MIB, "bytes", "a picture unpacked has", "20,000 px square in grey is 400 MB";
    /// Steps of a simulation.
    SIMULATED_STEPS = 10_000_000_000, "integration steps", "a simulation takes",
        "58 days at 0.5 ms; a recording has no more samples than steps";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_says_what_was_found_and_what_is_allowed() {
        assert_eq!(URDF_JOINTS.check(256), Ok(()));
        assert_eq!(
            URDF_JOINTS.check(257).unwrap_err(),
            "257 moving joints; a robot has at most 256 moving joints"
        );
        assert!(ALL.iter().all(|limit| limit.most > 0));
    }
}
