//! Catalogue of ropes.

use crate::failure::Failure;
use std::path::{Path, PathBuf};

/// Shipped ropes, and those of the user's folders.
pub(crate) fn with_folders(folders: &[PathBuf]) -> Result<sinew_rope::Catalogue, Failure> {
    let folders: Vec<&Path> = folders.iter().map(PathBuf::as_path).collect();
    Ok(sinew_rope::Catalogue::with_folders(&folders)?)
}
