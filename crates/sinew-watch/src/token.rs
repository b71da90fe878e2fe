//! Access tokens for other hosts, created at the first start and readable by their owner only, and the secrets of receivers.

use crate::config::{Role, WebSettings};
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

/// Access token with its name and role.
#[derive(Clone, PartialEq, Eq)]
pub struct Token {
    /// Name of the token in the configuration; `web-token`: the one without a name.
    pub name: String,
    /// Permission of its holders.
    pub role: Role,
    /// Text of the token.
    pub secret: String,
}

impl std::fmt::Debug for Token {
    /// Formats the token without its text.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Token")
            .field("name", &self.name)
            .field("role", &self.role)
            .finish_non_exhaustive()
    }
}

/// Reads all tokens of the page, which are created if missing; returns them with the paths of their files.
///
/// # Errors
/// Returns the reason as text if a file cannot be read, or two tokens are the same.
pub fn all(settings: &WebSettings, store: &Path) -> Result<Vec<(Token, PathBuf)>, String> {
    let mut tokens: Vec<(Token, PathBuf)> = Vec::new();
    for (name, role, path) in files(settings, store) {
        let secret = read_or_create(&path)?;
        if let Some((other, _)) = tokens.iter().find(|(other, _)| other.secret == secret) {
            let (path, other) = (path.display(), &other.name);
            return Err(format!(
                "{path}: same text as the token {other}; remove one of the files"
            ));
        }
        tokens.push((Token { name, role, secret }, path));
    }
    Ok(tokens)
}

/// Returns name, role and file of every token of the page.
pub fn files(settings: &WebSettings, store: &Path) -> Vec<(String, Role, PathBuf)> {
    let own = settings.token_file.clone();
    let own = own.unwrap_or_else(|| default_place(store));
    let named = settings.tokens.iter().map(|token| {
        let usual = || store.join(format!("web-token-{}", token.name));
        let file = token.file.clone().unwrap_or_else(usual);
        (token.name.clone(), token.role, file)
    });
    let first = ("web-token".to_owned(), Role::Operate, own);
    std::iter::once(first).chain(named).collect()
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

/// Reads a bearer token or a password from its file.
///
/// # Errors
/// Returns the reason as text if the file cannot be read or the token is invalid.
pub fn secret(path: &Path) -> Result<String, String> {
    let read = sinew_files::read_text(path, &sinew_files::Budget::SETTINGS);
    let text = read.map_err(|e| e.to_string())?;
    match text.trim() {
        "" => Err("the file is empty; write the token or password of the receiver into it".into()),
        token if token.len() as u64 > MAX_CHARS => Err(format!(
            "the text has {} characters, limit {MAX_CHARS}",
            token.len()
        )),
        token => Ok(token.to_owned()),
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
