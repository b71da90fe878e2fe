//! Addresses of folders in a bucket.

use std::path::{Path, PathBuf};

/// URL scheme of bucket addresses.
pub(crate) const SCHEME: &str = "s3://";

/// A folder in a bucket.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Address {
    /// Name of the bucket.
    pub bucket: String,
    /// Folder in the bucket, without leading and trailing `/`; empty for the whole bucket.
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
    /// Parses the name of a folder; `None` for a local folder.
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

/// Parses a folder argument; rejects other URL schemes and addresses without a bucket.
pub(crate) fn folder_or_address(path: PathBuf) -> Result<PathBuf, String> {
    match Address::of(&path) {
        Some(address) if address.bucket.is_empty() => {
            Err(format!("bucket missing, expected {SCHEME}BUCKET/FOLDER"))
        }
        Some(_) => Ok(path),
        None => match path.to_str().and_then(|text| text.split_once("://")) {
            Some((scheme, _)) if scheme.bytes().all(|b| b.is_ascii_alphanumeric()) => Err(format!(
                "unsupported scheme {scheme}://, expected a folder or {SCHEME}BUCKET/FOLDER; copy the folder to this computer first"
            )),
            _ => Ok(path),
        },
    }
}
