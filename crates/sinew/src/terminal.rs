//! What goes to stdout and stderr, and how a command ends.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sinew_files::JsonDocument;
use std::error::Error;
use std::io::{ErrorKind, IsTerminal as _, Write as _, stderr, stdout};

/// How a command that finished has finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Finish {
    /// Exit code 0.
    Complete,
    /// Exit code 3: data was lost, or a threshold was passed.
    Lossy,
}

impl Finish {
    /// `Lossy` if so.
    pub(crate) fn lossy(lossy: bool) -> Self {
        if lossy { Self::Lossy } else { Self::Complete }
    }
}

/// Why a command did not finish.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Exit code 1, with one message.
    Refused(String),
    /// Whoever read our output has closed it.
    ReaderGone,
}

impl<E: Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Refused(error.to_string())
    }
}

/// Writes the result to stdout.
pub(crate) fn answer(text: &str) -> Result<(), Failure> {
    let mut out = stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .map_err(|e| match e.kind() {
            ErrorKind::BrokenPipe => Failure::ReaderGone,
            _ => Failure::Refused(format!("can't write to stdout: {e}")),
        })
}

/// Writes the result to stdout: one JSON document where that was asked for, else words.
pub(crate) fn answer_as<D: JsonDocument>(
    json: bool,
    document: &D,
    words: impl FnOnce(&D) -> String,
) -> Result<(), Failure> {
    answer(&match json {
        true => document.to_json()?,
        false => words(document),
    })
}

/// Writes `word: text` to stderr; a closed stderr is nobody's loss.
pub(crate) fn complain(word: &str, text: &str) {
    let _ = writeln!(stderr(), "{word}: {text}");
}

/// Progress on stderr, only where somebody watches.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// A bar over `0..1` with a word in front.
    pub(crate) fn new(word: &str, quiet: bool) -> Self {
        const STEPS: u64 = 1000;
        let target = if quiet || !stderr().is_terminal() {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(STEPS), target);
        if let Ok(style) = ProgressStyle::with_template("{msg} [{bar:30}] {percent} %, {eta} left")
        {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(word.to_string());
        Self(bar)
    }

    /// Shows how much is done.
    pub(crate) fn set(&self, done: f64, total: f64) {
        let length = self.0.length().unwrap_or(0) as f64;
        let share = (done / total).clamp(0.0, 1.0);
        if share.is_finite() {
            self.0.set_position((share * length) as u64);
        }
    }

    /// Changes the word in front.
    pub(crate) fn say(&self, word: &str) {
        if self.0.message() != word {
            self.0.set_message(word.to_string());
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
