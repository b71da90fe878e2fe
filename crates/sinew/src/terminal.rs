//! Output to stdout and stderr, and exit states of commands.

use crate::text::{plain, plain_lines};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sinew_files::JsonDocument;
use sinew_report::Message;
use sinew_report::text::{Look, Tone, WIDTH, painted, set_look};
use std::error::Error;
use std::ffi::OsString;
use std::io::{ErrorKind, IsTerminal as _, Write as _, stderr, stdout};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

/// Output options of all commands.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Terminal")]
pub struct Style {
    /// Print data sources and computation times to stderr
    #[arg(long, short, global = true)]
    verbose: bool,
    /// Suppress notes, warnings and progress on stderr
    #[arg(long, global = true)]
    quiet: bool,
    /// Use of colour [default: auto, i.e. on a terminal unless NO_COLOR is set]
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        hide_default_value = true
    )]
    color: Colour,
}

/// Use of colour.
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
static QUIET: AtomicBool = AtomicBool::new(false);
static COLOUR_STDERR: AtomicBool = AtomicBool::new(false);

impl Style {
    /// Applies the options to the whole process.
    pub fn apply(self) {
        let _ = STYLE.set(self);
        VERBOSE.store(self.verbose, Ordering::Relaxed);
        QUIET.store(self.quiet, Ordering::Relaxed);
        let disabled = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        let on_stderr = self.color.on(!disabled && console::colors_enabled_stderr());
        COLOUR_STDERR.store(on_stderr, Ordering::Relaxed);
        let specified = std::env::var("COLUMNS").ok();
        let specified = specified.and_then(|n| n.parse().ok());
        let detected = || console::Term::stdout().size_checked();
        set_look(Look {
            columns: specified.unwrap_or_else(|| detected().map_or(WIDTH, |(_, n)| usize::from(n))),
            colour: self.color.on(!disabled && console::colors_enabled()),
        });
    }
}

static STYLE: OnceLock<Style> = OnceLock::new();

/// Returns the output options as arguments for another program.
pub(crate) fn style_arguments() -> Vec<OsString> {
    let mut arguments = Vec::new();
    let Some(style) = STYLE.get() else {
        return arguments;
    };
    if style.verbose {
        arguments.push("--verbose".into());
    }
    if style.quiet {
        arguments.push("--quiet".into());
    }
    if let Some(colour) = style.color.to_possible_value() {
        arguments.extend(["--color".into(), colour.get_name().into()]);
    }
    arguments
}

/// Exit state of a finished command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finish {
    /// Exit code 0.
    Complete,
    /// Exit code 3: data lost, or limit exceeded.
    Lossy,
    /// Exit code 1: the result is shown, but the input is invalid.
    InvalidInput,
}

impl Finish {
    /// Returns `Lossy` if data was lost or a limit exceeded, else `Complete`.
    pub fn lossy(lossy: bool) -> Self {
        if lossy { Self::Lossy } else { Self::Complete }
    }
}

/// Reason for which a command did not finish.
#[derive(Debug)]
pub enum Failure {
    /// Exit code 1 with an error message.
    Error(String),
    /// The reader closed the output.
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
        Self::Error(error.to_string())
    }
}

static ARGUMENTS: OnceLock<Vec<OsString>> = OnceLock::new();

/// Stores the arguments of the program.
pub fn set_arguments(arguments: Vec<OsString>) {
    // Later calls have no effect.
    let _ = ARGUMENTS.set(arguments);
}

/// Whether an option is specified on the command line.
pub fn is_specified(option: &str) -> bool {
    let arguments = ARGUMENTS.get();
    arguments.is_some_and(|all| all.iter().any(|argument| argument == option))
}

/// Arguments of the command line, without those of the output options: values of other options and positional ones.
pub(crate) fn inputs_on_command_line(outputs: &[(&str, Option<&Path>)]) -> Vec<PathBuf> {
    let is_output = |option: &str| outputs.iter().any(|(output, _)| *output == option);
    let mut inputs = Vec::new();
    // Without the program and the subcommand, which a folder may be named after.
    let mut arguments = ARGUMENTS.get().into_iter().flatten().skip(2);
    while let Some(argument) = arguments.next() {
        let text = argument.to_string_lossy();
        match text.split_once('=') {
            _ if is_output(&text) => drop(arguments.next()),
            Some((option, _)) if is_output(option) => (),
            Some((option, value)) if option.starts_with("--") => inputs.push(value.into()),
            _ => inputs.push(argument.into()),
        }
    }
    inputs
}

/// Writes the result to stdout, or to stderr if an output file uses stdout.
///
/// # Errors
///
/// Returns [`Failure`] if stdout cannot be written.
pub fn answer(text: &str) -> Result<(), Failure> {
    let fail = |e: std::io::Error| match e.kind() {
        ErrorKind::BrokenPipe => Failure::ReaderGone,
        _ => Failure::Error(format!("cannot write to stdout: {e}")),
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

/// Reserves stdout for an output file; results go to stderr.
pub fn take_stdout() {
    STDOUT_TAKEN.store(true, Ordering::Relaxed);
}

static STDOUT_TAKEN: AtomicBool = AtomicBool::new(false);

/// Writes the result to stdout, as JSON document or as text.
///
/// # Errors
///
/// Returns [`Failure`] if stdout cannot be written.
pub fn answer_as<D: JsonDocument>(
    json: bool,
    document: &D,
    text: impl FnOnce(&D) -> String,
) -> Result<(), Failure> {
    answer(&match json {
        true => document.to_json()?,
        false => text(document),
    })
}

/// Kind of a message on stderr.
#[derive(Debug, Clone, Copy)]
pub enum Word {
    /// The command failed.
    Error,
    /// The result may be affected.
    Warning,
    /// Additional information.
    Note,
}

/// Writes a message with its code to stderr, `warning[few-poses]: text`.
pub fn complain_coded(word: Word, message: &Message) {
    print_message(word, &plain(&message.tag()));
}

/// Maximum length of a message, characters: a message may quote a long cell of a file.
const MESSAGE_CHARACTERS: usize = 8_000;

/// Writes a message without a code to stderr, `warning: text`; control characters are replaced.
pub fn complain(word: Word, text: &str) {
    let mut text = plain_lines(text);
    if let Some((end, _)) = text.char_indices().nth(MESSAGE_CHARACTERS) {
        let left = text[end..].chars().count();
        text.truncate(end);
        text += &format!("… ({left} more characters)");
    }
    print_message(word, &format!(": {text}"));
}

/// Writes a message to stderr, except with `--quiet` anything but an error; a closed stderr is ignored.
///
/// * `text`: text after the word, starting with the code or the colon.
fn print_message(word: Word, text: &str) {
    if QUIET.load(Ordering::Relaxed) && !matches!(word, Word::Error) {
        return;
    }
    let (word, tone) = match word {
        Word::Error => ("error", Tone::Alarm),
        Word::Warning => ("warning", Tone::Caution),
        Word::Note => ("note", Tone::Head),
    };
    let word = match COLOUR_STDERR.load(Ordering::Relaxed) {
        true => painted(tone, word),
        false => word.to_owned(),
    };
    let _ = writeln!(stderr(), "{word}{text}");
}

static OUTPUTS: Mutex<Vec<(String, PathBuf)>> = Mutex::new(Vec::new());

/// Stores the option of an output file, for the message that it replaced a file.
pub fn name_output(option: &str, path: &Path) {
    if let Ok(mut outputs) = OUTPUTS.lock() {
        outputs.push((option.to_owned(), path.to_path_buf()));
    }
}

/// Prints which files were replaced.
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
                    &format!("{option} replaced the existing file {shown}"),
                );
            }
            // A file written in addition to a specified one.
            None => complain(Word::Note, &format!("replaced the existing file {shown}")),
        }
    }
}

/// Prints a note if `--verbose` is specified.
pub fn note(text: impl FnOnce() -> String) {
    if VERBOSE.load(Ordering::Relaxed) {
        complain(Word::Note, &text());
    }
}

/// Progress bar on stderr, shown on a terminal only.
#[derive(Debug)]
pub struct Bar(ProgressBar, Instant);

impl Bar {
    /// Makes a bar with a label.
    pub fn new(word: &str) -> Self {
        const STEPS: u64 = 1000;
        let target = if QUIET.load(Ordering::Relaxed) || !stderr().is_terminal() {
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

    /// Sets the completed part of the total.
    pub fn set(&self, done: f64, total: f64) {
        let length = self.0.length().unwrap_or(0) as f64;
        let share = (done / total).clamp(0.0, 1.0);
        if share.is_finite() {
            self.0.set_position((share * length) as u64);
        }
    }

    /// Changes the label.
    pub fn set_label(&self, word: &str) {
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
