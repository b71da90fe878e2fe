//! The token that other computers need: made at the first start, readable by its owner alone.

use crate::config::WebSettings;
use crate::hex::hex;
use sinew_files::{Temporary, folder_of};
use std::io::{ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};

/// Bytes of a token that is made.
const BYTES: usize = 32;
/// A token that somebody wrote has at least so many characters, so that nobody guesses it.
pub const SHORTEST: usize = 16;
/// Characters of a token at most.
const LONGEST: u64 = 4096;

/// Where the token is.
pub fn place(settings: &WebSettings, store: &Path) -> PathBuf {
    let own = settings.token_file.clone();
    own.unwrap_or_else(|| usual_place(store))
}

/// Where it is when nothing is said.
pub fn usual_place(store: &Path) -> PathBuf {
    store.join("web-token")
}

/// The token of a file, which is made where it isn't there.
///
/// # Errors
/// What is wrong with it, in words.
pub fn read_or_make(path: &Path) -> Result<String, String> {
    match read(path)? {
        Some(token) => Ok(token),
        None => make(path).map_err(|e| format!("{}: {e}", path.display())),
    }
}

/// The token of a file; `None`: there is no such file.
///
/// # Errors
/// What is wrong with it, in words.
pub fn read(path: &Path) -> Result<Option<String>, String> {
    let refuse = |why: String| format!("{}: {why}", path.display());
    match std::fs::File::open(path) {
        Ok(file) => {
            let mut text = String::new();
            let read = file.take(LONGEST + 1).read_to_string(&mut text);
            read.map_err(|e| refuse(e.to_string()))?;
            let token = text.trim();
            match token.len() {
                0..SHORTEST => Err(refuse(format!(
                    "the token has {} characters; it needs {SHORTEST} at least. Remove the file, and one is made",
                    token.len()
                ))),
                n if n as u64 > LONGEST => Err(refuse("too long for a token".into())),
                _ => Ok(Some(token.to_owned())),
            }
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(refuse(error.to_string())),
    }
}

fn make(path: &Path) -> std::io::Result<String> {
    let mut bytes = [0; BYTES];
    getrandom::fill(&mut bytes).map_err(std::io::Error::other)?;
    let token = hex(&bytes);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (mut file, temporary) = Temporary::create(folder_of(path), &name)?;
    // Before there is anything to read.
    #[cfg(unix)]
    file.set_permissions(std::os::unix::fs::PermissionsExt::from_mode(0o600))?;
    writeln!(file, "{token}")?;
    file.sync_all()?;
    temporary.rename(&file, path)?;
    Ok(token)
}
