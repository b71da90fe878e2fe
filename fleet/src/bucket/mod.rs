//! Folders in a bucket (S3): the files a command needs are copied to this computer first.
//!
//! Every query reads the keys of all files, and most queries read all rows, a few robots at a time. A file is therefore
//! fetched once and whole, not in ranges for each part of the query.

#[cfg(feature = "s3")]
mod fetch;

use crate::FleetError;
pub use crate::address::Address;
use crate::args::{Args, Command};
use std::path::PathBuf;
use tempfile::TempDir;

/// Set of files that a command needs from a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Needed {
    /// Files of records, side tables and robot types.
    Records,
    /// Baseline files only.
    Baselines,
}

/// Returns the folder that a command reads.
fn folder_of(command: &mut Command) -> Option<(&mut PathBuf, Needed)> {
    let source = match command {
        Command::Rows(request) => &mut request.source,
        Command::Query(request) => &mut request.source,
        Command::Due(request) => &mut request.source,
        Command::Compare(request) => &mut request.source,
        Command::Outliers(request) => &mut request.source,
        Command::Report(request) => &mut request.source,
        Command::Pool(request) => {
            let needed = match request.creep {
                true => Needed::Records,
                false => Needed::Baselines,
            };
            return Some((&mut request.folder, needed));
        }
        Command::Simulate(_) => return None,
    };
    Some((&mut source.folder, Needed::Records))
}

/// Copies the folder of a command from a bucket and redirects the command to the copy, which is deleted when the returned
/// value is dropped.
///
/// # Errors
///
/// Returns [`FleetError`] if the bucket cannot be read or the program was built without S3 support.
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
    fn address_round_trip() {
        let read = |text: &str| Address::of(Path::new(text)).map(|a| a.to_string());
        assert_eq!(read("s3://fleet/a/b/").as_deref(), Some("s3://fleet/a/b"));
        assert_eq!(read("s3://fleet").as_deref(), Some("s3://fleet"));
        assert_eq!(read("fleet/s3"), None);
        for wrong in ["s3://", "s3:///a", "gs://fleet/a"] {
            let message = folder_or_address(wrong.into()).unwrap_err();
            assert!(message.contains("s3://BUCKET/FOLDER"), "{wrong}: {message}");
        }
        assert!(folder_or_address("a://b c".into()).is_err());
        assert!(folder_or_address("./a:/b".into()).is_ok());
    }
}
