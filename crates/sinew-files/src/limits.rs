//! Maximum sizes of inputs and simulations: no file can make a program allocate unlimited memory.
//!
//! The manual shows this list as a table.

/// An upper bound, checked before memory is allocated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// Subject of the limit, as the start of a message.
    pub of: &'static str,
    /// The largest value that is accepted.
    pub most: u64,
    /// Unit of the limit.
    pub unit: &'static str,
    /// Reason for the value of the limit.
    pub reason: &'static str,
}

impl Limit {
    /// [`most`](Self::most) as a length.
    pub const fn length(&self) -> usize {
        self.most as usize
    }

    /// Checks a size against the bound; the error is a message.
    ///
    /// # Errors
    /// Returns the actual and the permitted size.
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
        "the largest URDFs have about 10 MB";
    /// A file of settings.
    SETTINGS = 4 * MIB, "bytes", "a scenario, a bench, a mapping or a bag's metadata.yaml has",
        "written by hand";
    /// A rope of a catalogue.
    ROPE_ENTRY = MIB, "bytes", "a rope entry has", "written by hand";
    /// The file `meta/info.json` of a data set.
    DATA_SET_INFO = 16 * MIB, "bytes", "meta/info.json of a data set has", "names of columns";
    /// A table of sessions, or a document of an estimate.
    SESSIONS = 256 * MIB, "bytes", "a table of sessions has", "25,000 sessions of 32 joints";
    /// A baseline file.
    BASELINE = 256 * MIB, "bytes", "a baseline has", "27 MB for 60 joints; the size grows with the square of their number";
    /// Results from which a stopped study resumes.
    STUDY = 512 * MIB, "bytes", "the file of a study has", "100,000 simulated years";
    /// Elements and texts of a URDF.
    URDF_NODES = 1_000_000, "nodes", "a URDF has", "the largest robots have about 10,000; the depth needs no separate bound";
    /// Moving joints of a URDF.
    URDF_JOINTS = 256, "moving joints", "a robot has", "the time of a check grows with the cube of the number; a humanoid with hands has 100";
    /// A creep test.
    TEST_FILE = 256 * MIB, "bytes", "a creep test has", "16 bytes for each permitted cell";
    /// Cells of a creep test, a row as four at least.
    TEST_CELLS = 16_000_000, "cells", "a creep test has",
        "32 bytes of memory per cell; a day at 10 Hz with ten columns has half as many";
    /// Contents of a workbook other than its sheets.
    WORKBOOK_PARTS = 128 * MIB, "bytes", "a workbook's texts and styles have", "unpacked; kept in memory";
    /// The sheets of a workbook.
    WORKBOOK_SHEETS = 2048 * MIB, "bytes", "a workbook's sheets have", "unpacked; read in parts";
    /// A text of a workbook.
    WORKBOOK_TEXT = MIB, "bytes", "a cell or an element of a workbook has", "spreadsheet programs allow 32,767 characters";
    /// Disk space of a recording that is unpacked or read from a pipe.
    UNPACKED = 64 << 30, "bytes", "an unpacked recording has", "stored in the folder for temporary files, not in memory";
    /// A chunk of an MCAP or a message.
    CHUNK = 256 * MIB, "bytes", "a chunk or message of a recording has", "recorders write 1 to 8 MB; a stated length is first compared with the remaining bytes";
    /// A summary of an MCAP.
    SUMMARY = 64 * MIB, "bytes", "the summary of an MCAP has", "a longer summary is ignored, and the file is read from its start";
    /// A line of a recording.
    CSV_LINE = 4 * MIB, "bytes", "a row or header of a CSV recording has", "65,536 columns of 64 bytes";
    /// Columns of a recording.
    COLUMNS = 65_536, "columns", "a recording has", "a thousand joints with 60 quantities";
    /// A page of a Parquet file.
    PARQUET_PIECE = 256 * MIB, "bytes", "a piece of a Parquet file has", "writers create pages of 1 MB; a stated length is first compared with the remaining bytes";
    /// A picture's file.
    PICTURE_FILE = 256 * MIB, "bytes", "a picture has", "100 megapixels without compression";
    /// A picture's side.
    PICTURE_SIDE = 20_000, "px", "a side of a picture has", "the largest sensors have 15,000";
    /// Memory for a picture's pixels.
    PICTURE_MEMORY = 1024 * MIB, "bytes", "an unpacked picture has", "20,000 px square in grey is 400 MB";
    /// Steps of a simulation.
    SIMULATED_STEPS = 10_000_000_000, "integration steps", "a simulation takes",
        "58 days at 0.5 ms; a recording has no more samples than steps";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limit_error_reports_found_and_permitted() {
        assert_eq!(URDF_JOINTS.check(256), Ok(()));
        assert_eq!(
            URDF_JOINTS.check(257).unwrap_err(),
            "257 moving joints; a robot has at most 256 moving joints"
        );
        assert!(ALL.iter().all(|limit| limit.most > 0));
    }
}
