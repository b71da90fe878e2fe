//! Folders in a bucket (S3): what a command needs of one is copied to this computer first.
//!
//! Every question reads the keys of all files, and most read all rows, some robots at a time. So a file is fetched once and whole,
//! not in ranges once per part of the question.

#[cfg(feature = "s3")]
mod fetch;

use crate::FleetError;
pub use crate::address::Address;
use crate::args::{Args, Command};
use std::path::PathBuf;
use tempfile::TempDir;

/// What a command needs of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Needed {
    /// Files of records, the tables beside them, and the robot types.
    Records,
    /// Baselines.
    Baselines,
}

/// The folder a command reads.
fn folder_of(command: &mut Command) -> Option<(&mut PathBuf, Needed)> {
    let source = match command {
        Command::Rows(asked) => &mut asked.source,
        Command::Query(asked) => &mut asked.source,
        Command::Due(asked) => &mut asked.source,
        Command::Compare(asked) => &mut asked.source,
        Command::Outliers(asked) => &mut asked.source,
        Command::Report(asked) => &mut asked.source,
        Command::Pool(asked) => {
            let needed = match asked.creep {
                true => Needed::Records,
                false => Needed::Baselines,
            };
            return Some((&mut asked.folder, needed));
        }
        Command::Simulate(_) => return None,
    };
    Some((&mut source.folder, Needed::Records))
}

/// Copies the folder of a command, where it lies in a bucket, and lets the command read the copy. It is gone when what is
/// returned is dropped.
///
/// # Errors
/// [`FleetError`].
pub(crate) fn copy(args: &mut Args) -> Result<Option<TempDir>, FleetError> {
    let Some((folder, needed)) = folder_of(&mut args.command) else {
        return Ok(None);
    };
    let Some(address) = Address::of(folder) else {
        return Ok(None);
    };
    #[cfg(feature = "s3")]
    {
        let fetched = fetch::fetch(&address, needed)?;
        *folder = fetched.folder.path().to_path_buf();
        eprintln!(
            "{address}: {} files, {:.1} MB, copied to {} while this runs",
            fetched.files,
            1e-6 * fetched.bytes as f64,
            folder.display()
        );
        Ok(Some(fetched.folder))
    }
    #[cfg(not(feature = "s3"))]
    {
        let _ = needed;
        Err(FleetError::NoS3(address))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::address::folder_or_address;
    use std::path::Path;

    #[test]
    fn an_address_is_read_as_it_is_written() {
        let read = |text: &str| Address::of(Path::new(text)).map(|a| a.to_string());
        assert_eq!(read("s3://fleet/a/b/").as_deref(), Some("s3://fleet/a/b"));
        assert_eq!(read("s3://fleet").as_deref(), Some("s3://fleet"));
        assert_eq!(read("fleet/s3"), None);
        for wrong in ["s3://", "s3:///a", "gs://fleet/a"] {
            let said = folder_or_address(wrong.into()).unwrap_err();
            assert!(said.contains("s3://BUCKET/FOLDER"), "{wrong}: {said}");
        }
        assert!(folder_or_address("a://b c".into()).is_err());
        assert!(folder_or_address("./a:/b".into()).is_ok());
    }
}
