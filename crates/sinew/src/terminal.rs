//! What goes to stdout and stderr, and how a command ends.

use crate::text::plain;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sinew_files::JsonDocument;
use sinew_report::text::{Look, Tone, WIDTH, painted, set_look};
use std::error::Error;
use std::ffi::OsString;
use std::io::{ErrorKind, IsTerminal as _, Write as _, stderr, stdout};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

/// How every command speaks.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Terminal")]
pub struct Style {
    /// Say on stderr what was read from where, and how long each part took
    #[arg(long, short, global = true)]
    verbose: bool,
    /// Colour [default: auto: on a terminal, unless NO_COLOR is set]
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        hide_default_value = true
    )]
    color: Colour,
}

/// When to colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "lower")]
enum Colour {
    Auto,
    Always,
    Never,
}

impl Colour {
    fn on(self, auto: bool) -> bool {
        match self {
            Self::Auto => auto,
            Self::Always => true,
            Self::Never => false,
        }
    }
}

static VERBOSE: AtomicBool = AtomicBool::new(false);
static COLOUR_STDERR: AtomicBool = AtomicBool::new(false);

impl Style {
    /// Takes hold for the rest of the run.
    pub fn apply(self) {
        let _ = STYLE.set(self);
        VERBOSE.store(self.verbose, Ordering::Relaxed);
        let unwanted = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        let on_stderr = self.color.on(!unwanted && console::colors_enabled_stderr());
        COLOUR_STDERR.store(on_stderr, Ordering::Relaxed);
        let stated = std::env::var("COLUMNS").ok();
        let stated = stated.and_then(|n| n.parse().ok());
        let seen = || console::Term::stdout().size_checked();
        set_look(Look {
            columns: stated.unwrap_or_else(|| seen().map_or(WIDTH, |(_, n)| usize::from(n))),
            colour: self.color.on(!unwanted && console::colors_enabled()),
        });
    }
}

static STYLE: OnceLock<Style> = OnceLock::new();

/// How this program speaks, as another one is told.
pub(crate) fn style_arguments() -> Vec<OsString> {
    let mut arguments = Vec::new();
    let Some(style) = STYLE.get() else {
        return arguments;
    };
    if style.verbose {
        arguments.push("--verbose".into());
    }
    if let Some(colour) = style.color.to_possible_value() {
        arguments.extend(["--color".into(), colour.get_name().into()]);
    }
    arguments
}

/// How a command that finished has finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finish {
    /// Exit code 0.
    Complete,
    /// Exit code 3: data was lost, or a threshold was passed.
    Lossy,
    /// Exit code 1: what was asked for is shown, and the input can't be used.
    Refused,
}

impl Finish {
    /// `Lossy` if so.
    pub fn lossy(lossy: bool) -> Self {
        if lossy { Self::Lossy } else { Self::Complete }
    }
}

/// Why a command did not finish.
#[derive(Debug)]
pub enum Failure {
    /// Exit code 1, with one message.
    Refused(String),
    /// Whoever read our output has closed it.
    ReaderGone,
}

impl<E: Error> From<E> for Failure {
    fn from(error: E) -> Self {
        let gone = |e: &std::io::Error| e.kind() == ErrorKind::BrokenPipe;
        let mut source = error.source();
        while let Some(error) = source {
            if error.downcast_ref().is_some_and(gone) {
                return Self::ReaderGone;
            }
            source = error.source();
        }
        Self::Refused(error.to_string())
    }
}

static ARGUMENTS: OnceLock<Vec<OsString>> = OnceLock::new();

/// What the program was called with.
pub fn set_arguments(arguments: Vec<OsString>) {
    // The first call counts.
    let _ = ARGUMENTS.set(arguments);
}

/// Whether an option was given, for what is the same in every command.
pub fn asked(option: &str) -> bool {
    let arguments = ARGUMENTS.get();
    arguments.is_some_and(|all| all.iter().any(|argument| argument == option))
}

/// Writes the result to stdout, or to stderr where a file was asked for on stdout.
pub fn answer(text: &str) -> Result<(), Failure> {
    let fail = |e: std::io::Error| match e.kind() {
        ErrorKind::BrokenPipe => Failure::ReaderGone,
        _ => Failure::Refused(format!("can't write to stdout: {e}")),
    };
    if STDOUT_TAKEN.load(Ordering::Relaxed) {
        let _ = stderr().write_all(text.as_bytes());
        return Ok(());
    }
    let mut out = stdout().lock();
    (out.write_all(text.as_bytes()))
        .and_then(|()| out.flush())
        .map_err(fail)
}

/// A file was asked for on stdout: answers go to stderr.
pub fn take_stdout() {
    STDOUT_TAKEN.store(true, Ordering::Relaxed);
}

static STDOUT_TAKEN: AtomicBool = AtomicBool::new(false);

/// Writes the result to stdout: one JSON document where that was asked for, else words.
pub fn answer_as<D: JsonDocument>(
    json: bool,
    document: &D,
    words: impl FnOnce(&D) -> String,
) -> Result<(), Failure> {
    answer(&match json {
        true => document.to_json()?,
        false => words(document),
    })
}

/// Why somebody is told something on stderr.
#[derive(Debug, Clone, Copy)]
pub enum Word {
    /// The command did not do it.
    Error,
    /// It did, but look at this.
    Warning,
    /// What else is known of it.
    Note,
}

/// Writes `word: text` to stderr; a closed stderr is nobody's loss.
pub fn complain(word: Word, text: &str) {
    let (word, tone) = match word {
        Word::Error => ("error:", Tone::Alarm),
        Word::Warning => ("warning:", Tone::Caution),
        Word::Note => ("note:", Tone::Head),
    };
    let word = match COLOUR_STDERR.load(Ordering::Relaxed) {
        true => painted(tone, word),
        false => word.to_owned(),
    };
    let _ = writeln!(stderr(), "{word} {text}");
}

static OUTPUTS: Mutex<Vec<(String, PathBuf)>> = Mutex::new(Vec::new());

/// What an output is called on the command line, for when it replaces a file.
pub fn name_output(option: &str, path: &Path) {
    if let Ok(mut outputs) = OUTPUTS.lock() {
        outputs.push((option.to_owned(), path.to_path_buf()));
    }
}

/// Says which files were replaced.
pub fn end() {
    let outputs = OUTPUTS.lock().map(|outputs| outputs.clone());
    let outputs = outputs.unwrap_or_default();
    for path in sinew_files::take_replaced() {
        let named = outputs.iter().find(|(_, output)| *output == path);
        let shown = plain(&path.display().to_string());
        match named {
            Some((option, _)) => {
                complain(
                    Word::Note,
                    &format!("{option} replaced {shown}, which was there"),
                );
            }
            // A file beside one that was asked for.
            None if !asked("--quiet") => {
                complain(Word::Note, &format!("replaced {shown}, which was there"));
            }
            None => {}
        }
    }
}

/// A note for who asked for more with `--verbose`.
pub fn note(text: impl FnOnce() -> String) {
    if VERBOSE.load(Ordering::Relaxed) {
        complain(Word::Note, &text());
    }
}

/// Progress on stderr, only where somebody watches.
#[derive(Debug)]
pub struct Bar(ProgressBar, Instant);

impl Bar {
    /// A bar over `0..1` with a word in front.
    pub fn new(word: &str, quiet: bool) -> Self {
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
        Self(bar, Instant::now())
    }

    /// Shows how much is done.
    pub fn set(&self, done: f64, total: f64) {
        let length = self.0.length().unwrap_or(0) as f64;
        let share = (done / total).clamp(0.0, 1.0);
        if share.is_finite() {
            self.0.set_position((share * length) as u64);
        }
    }

    /// Changes the word in front.
    pub fn say(&self, word: &str) {
        if self.0.message() != word {
            self.0.set_message(word.to_string());
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
        let (word, took_s) = (self.0.message(), self.1.elapsed().as_secs_f64());
        note(|| format!("{}: {took_s:.2} s", word.trim()));
    }
}
