//! Access token for other hosts: created at the first start, readable by its owner only.

use crate::config::WebSettings;
use crate::hex::hex;
use sinew_files::{Temporary, folder_of};
use std::io::{ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};

/// Number of random bytes of a created token.
const TOKEN_BYTES: usize = 32;
/// Minimum length of a token written by the user, characters, against guessing.
pub const MIN_CHARS: usize = 16;
/// Maximum length of a token, characters.
const MAX_CHARS: u64 = 4096;

/// Returns the path of the token file.
pub fn place(settings: &WebSettings, store: &Path) -> PathBuf {
    let own = settings.token_file.clone();
    own.unwrap_or_else(|| default_place(store))
}

/// Returns the default path of the token file.
pub fn default_place(store: &Path) -> PathBuf {
    store.join("web-token")
}

/// Reads the token of a file, which is created if missing.
///
/// # Errors
/// Returns the reason as text if the file cannot be read or the token is invalid.
pub fn read_or_create(path: &Path) -> Result<String, String> {
    match read(path)? {
        Some(token) => Ok(token),
        None => create(path).map_err(|e| format!("{}: {e}", path.display())),
    }
}

/// Reads the token of a file; `None`: the file does not exist.
///
/// # Errors
/// Returns the reason as text if the file cannot be read or the token is invalid.
pub fn read(path: &Path) -> Result<Option<String>, String> {
    let invalid = |reason: String| format!("{}: {reason}", path.display());
    match std::fs::File::open(path) {
        Ok(file) => {
            let mut text = String::new();
            let read = file.take(MAX_CHARS + 1).read_to_string(&mut text);
            read.map_err(|e| invalid(e.to_string()))?;
            let token = text.trim();
            match token.len() {
                0..MIN_CHARS => Err(invalid(format!(
                    "token has {} characters, expected at least {MIN_CHARS}; remove the file to create a new one",
                    token.len()
                ))),
                n if n as u64 > MAX_CHARS => Err(invalid(format!(
                    "token has more than {MAX_CHARS} characters; remove the file to create a new one"
                ))),
                _ => Ok(Some(token.to_owned())),
            }
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(invalid(error.to_string())),
    }
}

fn create(path: &Path) -> std::io::Result<String> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes).map_err(std::io::Error::other)?;
    let token = hex(&bytes);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (mut file, temporary) = Temporary::create(folder_of(path), &name)?;
    // Permissions are restricted before the content is written.
    #[cfg(unix)]
    file.set_permissions(std::os::unix::fs::PermissionsExt::from_mode(0o600))?;
    writeln!(file, "{token}")?;
    file.sync_all()?;
    temporary.rename(&file, path)?;
    Ok(token)
}
