//! `sinew init`: template of robot.toml.

use crate::args::Opening;
use crate::files::create_folder;
use crate::terminal::{Failure, Finish, answer_as};
use clap::Args;
use sinew_estimate::init::{Init, InitChoice};
use sinew_estimate::robot_toml::robot_toml;
use sinew_files::{read_text, write_file};
use sinew_log::{LogError, MappingProposal, Recording};
use sinew_model::transmission_map::TransmissionMap;
use sinew_report::init::{mapping_toml, render};
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Write a template of robot.toml from a recording or a URDF
///
/// Joints, sides, topics and rate are read from the recording, masses and axes from its
/// /robot_description or a URDF. Missing values are comments with unit, usual range and source. If
/// topics or columns are ambiguous, a template of mapping.toml is written first (exit code 3).
#[derive(Debug, Args)]
#[command(
    name = "init",
    after_help = "Example:\n  sinew init monday.mcap --out my-robot\n  sinew init my-robot.urdf\n  sinew init my-robot.urdf --transmissions my-robot.urdf"
)]
pub(crate) struct InitCommand {
    /// Recording or URDF
    source: PathBuf,
    /// Output folder, created if missing [default: folder of the recording or URDF]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// URDF of the robot if the recording contains none
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
    /// Coupling of motors and joints: URDF with `<transmission>`, MuJoCo model, or table of ratios
    ///
    /// Reads ros_control and ros2_control (simple, differential, four-bar linkage), fixed tendons of MuJoCo, and a CSV
    /// with joints in its header and one motor per row (motor rad per joint rad). Writes [motors.NAME] and [[tendons]];
    /// stiffness and radii must be completed.
    #[arg(long, value_name = "FILE")]
    transmissions: Option<PathBuf>,
    /// Replace existing files
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    opening: Opening,
}

/// Path and content of a file to write.
type Planned = (PathBuf, String);

impl InitCommand {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let source = self.source.display().to_string();
        let folder = self
            .out
            .clone()
            .unwrap_or_else(|| match self.source.parent() {
                Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
                _ => PathBuf::from("."),
            });
        let is_urdf = is_urdf(&self.source);
        let opened = match is_urdf {
            true => Ok(None),
            false => sinew_log::open(&self.source, &self.opening.options()?).map(Some),
        };
        let (mut init, planned) = match opened {
            Ok(recording) => self.describe(&source, &folder, is_urdf, recording)?,
            Err(error) => choose(&source, &folder, error)?,
        };
        init.options = self.opening.given();
        let there = planned.iter().filter(|(path, _)| path.exists());
        init.replaced = there.map(|(path, _)| path.display().to_string()).collect();
        if let (false, Some(file)) = (self.force, init.replaced.first()) {
            return Err(Failure::Error(format!(
                "{file} already exists; replace it with --force, or use --out DIR"
            )));
        }
        create_folder("--out", &folder)?;
        for (path, text) in &planned {
            write_file(path, text.as_bytes())?;
            init.written.push(path.display().to_string());
        }
        let folder = folder.display().to_string();
        answer_as(self.json, &init, |init| render(init, &folder))?;
        Ok(Finish::lossy(init.choice.is_some()))
    }

    /// Returns robot.toml, and the URDF unless it is in the folder already.
    fn describe(
        &self,
        source: &str,
        folder: &Path,
        is_urdf: bool,
        mut recording: Option<Recording>,
    ) -> Result<(Init, Vec<Planned>), Failure> {
        let file = self.urdf.as_ref().or(is_urdf.then_some(&self.source));
        let description = recording.as_ref().and_then(Recording::robot_description);
        let (name, text) = match (file, description) {
            (Some(file), _) => {
                let name = file.file_name().map(|n| n.to_string_lossy().into_owned());
                (
                    name,
                    Some(read_text(file, &sinew_files::Budget::DESCRIPTION)?),
                )
            }
            (None, Some(text)) => (Some("robot.urdf".to_owned()), Some(text.to_owned())),
            (None, None) => (None, None),
        };
        let urdf = name.as_deref().zip(text.as_deref());
        let mut init = Init::of(source, urdf, recording.as_mut())?;
        if let Some(path) = &self.transmissions {
            let file = path.display().to_string();
            let text = read_text(path, &sinew_files::Budget::DESCRIPTION)?;
            init.couple(TransmissionMap::parse(&text, &file)?, &file)?;
        }
        let mut planned = vec![(folder.join("robot.toml"), robot_toml(&init))];
        if let Some((name, text)) = urdf {
            let path = folder.join(name);
            let lies_there =
                file.is_some_and(|f| f.canonicalize().ok() == path.canonicalize().ok());
            if !(lies_there && path.exists()) {
                planned.push((path, text.to_owned()));
            }
        }
        Ok((init, planned))
    }
}

/// Returns the mapping template for ambiguous topics or columns.
fn choose(source: &str, folder: &Path, error: LogError) -> Result<(Init, Vec<Planned>), Failure> {
    let init = Init::undecided(source, error)?;
    let proposal = match &init.choice {
        Some(InitChoice::Columns(_)) => MappingProposal::of_file(Path::new(source)),
        _ => MappingProposal::default(),
    };
    let choice = init.choice.as_ref();
    let text = choice.map(|choice| mapping_toml(source, choice, &proposal));
    let planned = text.map(|text| (folder.join("mapping.toml"), text));
    Ok((init, planned.into_iter().collect()))
}

/// Whether a file is a URDF, by its extension or first bytes.
fn is_urdf(path: &Path) -> bool {
    let named = path
        .extension()
        .is_some_and(|e| e == "urdf" || e == "xacro");
    let mut start = Vec::new();
    let opened = path
        .is_file()
        .then(|| std::fs::File::open(path).ok())
        .flatten();
    let read = opened.map(|file| file.take(4096).read_to_end(&mut start));
    let text = String::from_utf8_lossy(&start);
    let is_xml = matches!(read, Some(Ok(_))) && text.trim_start().starts_with('<');
    named || (is_xml && text.contains("<robot"))
}
