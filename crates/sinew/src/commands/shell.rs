//! `sinew completions` and `sinew man`: shell completions and manual pages.

use crate::files::create_folder;
use crate::terminal::{Failure, Finish, answer};
use clap::{Args, Command};
use clap_complete::Shell;
use std::path::PathBuf;

/// Print shell completions
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew completions bash > ~/.local/share/bash-completion/completions/sinew\n  \
    sinew completions zsh > ~/.zfunc/_sinew\n  \
    sinew completions fish > ~/.config/fish/completions/sinew.fish")]
pub(crate) struct Completions {
    /// Shell for which completions are generated
    shell: Shell,
}

impl Completions {
    /// Runs the command.
    pub(crate) fn run(&self, mut cli: Command) -> Result<Finish, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut cli, "sinew", &mut script);
        answer(&String::from_utf8_lossy(&script))?;
        Ok(Finish::Complete)
    }
}

/// Print the manual page, or write one page per command
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew man | man -l -\n  \
    sinew man --out ~/.local/share/man/man1")]
pub(crate) struct Man {
    /// Folder for one manual page per command, created if missing
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Man {
    /// Runs the command.
    pub(crate) fn run(&self, mut cli: Command) -> Result<Finish, Failure> {
        let Some(folder) = &self.out else {
            answer(&String::from_utf8_lossy(&page(cli)?))?;
            return Ok(Finish::Complete);
        };
        create_folder("--out", folder)?;
        cli.build();
        let mut left = vec![cli];
        while let Some(command) = left.pop() {
            left.extend(
                command
                    .get_subcommands()
                    .filter(|c| c.get_name() != "help")
                    .cloned(),
            );
            let name = command.get_display_name().unwrap_or(command.get_name());
            let path = folder.join(format!("{name}.1"));
            sinew_files::write_file(&path, &page(command)?)?;
        }
        Ok(Finish::Complete)
    }
}

/// Renders the manual page of a command.
fn page(command: Command) -> Result<Vec<u8>, Failure> {
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page)?;
    Ok(page)
}
