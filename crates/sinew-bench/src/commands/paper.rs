//! `sinew paper`: the paper's evaluation, done again.

use clap::Args;
use sinew::terminal::{Failure, Finish, Word, answer_as, complain};
use sinew_bench::paper::{self, FigureName};
use sinew_estimate::robot_dir;
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use std::path::{Path, PathBuf};

/// Reproduce a figure of the paper and assess its statements with the data
///
/// Writes NAME.svg, NAME.html and NAME.png (if the build supports PNG). Exit code 3 if a statement does not hold.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew paper fig6 --out figures")]
pub(crate) struct Paper {
    /// Name of the figure
    #[arg(value_enum)]
    figure: FigureName,
    /// Robot's folder, for fig6, fig7 and control [default: the BioRob-like arm]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Folder with ropes that replace shipped ones of their names, for fig1 to fig5 and table1
    #[arg(long = "ropes", value_name = "DIR")]
    ropes: Vec<PathBuf>,
    /// Folder for the files, created if missing
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Print one JSON document (curves and statements) instead of the statements
    #[arg(long)]
    json: bool,
}

impl Paper {
    /// Returns an error for an option without effect.
    fn check(&self) -> Result<(), Failure> {
        let name = self.figure;
        let robot = matches!(
            name,
            FigureName::Fig6 | FigureName::Fig7 | FigureName::Control
        );
        if robot && !self.ropes.is_empty() {
            return Err(Failure::Error(format!(
                "--ropes: {name} uses the tendons of a robot, not the rope catalogue; remove the option"
            )));
        }
        if !robot && self.robot.is_some() {
            return Err(Failure::Error(format!(
                "--robot: {name} uses ropes only; remove the option"
            )));
        }
        Ok(())
    }

    fn folders(&self) -> Vec<&Path> {
        self.ropes.iter().map(PathBuf::as_path).collect()
    }

    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        self.check()?;
        let robot = || -> Result<Robot, Failure> {
            Ok(match &self.robot {
                Some(folder) => robot_dir::load(folder, None)?.robot,
                None => paper::shipped_robot()?,
            })
        };
        let catalogue = || Catalogue::with_folders(&self.folders());
        std::fs::create_dir_all(&self.out).map_err(|e| {
            Failure::Error(format!("cannot create folder {}: {e}", self.out.display()))
        })?;
        let mut figure = match self.figure {
            FigureName::Fig1 => paper::fig1(&catalogue()?)?,
            FigureName::Fig2 => paper::fig2(&catalogue()?)?,
            FigureName::Fig3 => paper::fig3()?,
            FigureName::Fig4 => paper::fig4(&catalogue()?)?,
            FigureName::Fig5 => paper::fig5(&catalogue()?)?,
            FigureName::Table1 => paper::table1(&catalogue()?)?,
            FigureName::Fig6 => paper::fig6(&robot()?)?,
            FigureName::Fig7 => paper::fig7(&robot()?)?,
            FigureName::Control => paper::control(&robot()?, paper::Effort::default())?,
        };
        paper::write(&mut figure, &self.out)?;
        answer_as(self.json, &figure, paper::render)?;
        let fails = |s: &&paper::Sentence| s.verdict == paper::Verdict::Fails;
        let failed = figure.sentences.iter().filter(fails).count();
        Ok(finish(failed, figure.sentences.len()))
    }
}

/// Warns of statements that do not hold.
fn finish(failed: usize, of: usize) -> Finish {
    if failed > 0 {
        let text = format!("{failed} of {of} statements do not hold");
        complain(Word::Warning, &text);
    }
    Finish::lossy(failed > 0)
}
