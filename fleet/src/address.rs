//! Addresses of folders in a bucket.

use std::path::{Path, PathBuf};

/// What an address begins with.
pub(crate) const SCHEME: &str = "s3://";

/// A folder in a bucket.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Address {
    /// Name of the bucket.
    pub bucket: String,
    /// Folder in it, without `/` at its ends; empty: all of it.
    pub prefix: String,
}

impl std::fmt::Display for Address {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { bucket, prefix } = self;
        write!(f, "{SCHEME}{bucket}")?;
        match prefix.is_empty() {
            true => Ok(()),
            false => write!(f, "/{prefix}"),
        }
    }
}

impl Address {
    /// What a folder's name says: `None` where it is one of this computer's.
    pub(crate) fn of(folder: &Path) -> Option<Self> {
        let (bucket, prefix) = {
            let rest = folder.to_str()?.strip_prefix(SCHEME)?;
            rest.split_once('/').unwrap_or((rest, ""))
        };
        Some(Self {
            bucket: bucket.to_owned(),
            prefix: prefix.trim_matches('/').to_owned(),
        })
    }
}

/// A folder as an argument; an address of another kind, or without a bucket, is none.
pub(crate) fn folder_or_address(path: PathBuf) -> Result<PathBuf, String> {
    match Address::of(&path) {
        Some(address) if address.bucket.is_empty() => {
            Err(format!("write {SCHEME}BUCKET/FOLDER: a bucket is missing"))
        }
        Some(_) => Ok(path),
        None => match path.to_str().and_then(|text| text.split_once("://")) {
            Some((scheme, _)) if scheme.bytes().all(|b| b.is_ascii_alphanumeric()) => Err(format!(
                "reads folders and {SCHEME}BUCKET/FOLDER, not {scheme}://; copy it here with that store's program"
            )),
            _ => Ok(path),
        },
    }
}
