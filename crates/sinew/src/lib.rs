//! Command line of Sinew.
//!
//! Exit codes: 0 success, 1 invalid input, 2 invalid usage, 3 success with lost data or an exceeded limit. Results are
//! written to stdout, everything else to stderr. The program `sinew` and the command of the Python package call [`run`].
//! The public modules parse options, check files and write results for all programs of the project.

pub mod args;
mod commands;
pub mod files;
mod quantity;
pub mod terminal;

use clap::{CommandFactory as _, Parser, Subcommand};
use commands::external::Arguments;
use sinew_report::text;
use std::ffi::OsString;
use terminal::{Failure, Finish};

/// Estimate the elongation of the rope tendons of a robot from its encoders
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 80,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 success, 1 invalid input, 2 invalid usage, 3 success, but data\n\
                  lost or limit exceeded.\n\n\
                  Values may have a unit: 60N, 700mm, 3weeks, 22degC, 80%. Without one, the unit\n\
                  in the description of the option applies.\n\n\
                  Example:\n  sinew estimate monday.mcap --robot robots/biorob-like --report monday.html"
)]
struct Cli {
    #[command(flatten)]
    style: terminal::Style,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Init(commands::init::InitCommand),
    Estimate(Box<commands::estimate::Estimate>),
    Baseline(Box<commands::baseline::Baseline>),
    Trend(Box<commands::trend::Trend>),
    /// Monitor running robots: estimates, records, alarms, web page (runs sinew-watch)
    #[command(
        disable_help_flag = true,
        after_help = "Examples:\n  sinew watch --demo\n  sinew watch /etc/sinew/watch.toml"
    )]
    Watch(Arguments),
    /// Query the records of a fleet: tables, comparison, maintenance due (runs sinew-fleet)
    #[command(
        disable_help_flag = true,
        after_help = "Examples:\n  sinew fleet rows /srv/records\n  sinew fleet query /srv/records \"SELECT count(*) FROM records\"\n  sinew fleet due /srv/records --within 30"
    )]
    Fleet(Arguments),
    Excitation(commands::excitation::Excitation),
    Simulate(commands::simulate::Simulate),
    /// Validate the absolute offset on simulated recordings with known truth (runs sinew-bench)
    #[command(
        disable_help_flag = true,
        after_help = "Examples:\n  sinew scenarios run --scenario S7 --n 200 --out s7.jsonl\n  sinew scenarios show S7"
    )]
    Scenarios(Arguments),
    /// Reproduce a figure of the paper from simulations (runs sinew-bench)
    #[command(
        disable_help_flag = true,
        after_help = "Example:\n  sinew paper fig6 --out figures"
    )]
    Paper(Arguments),
    #[command(subcommand)]
    Bench(commands::bench::BenchCommand),
    #[command(subcommand)]
    Rope(commands::rope::Rope),
    #[command(subcommand)]
    Creep(Box<commands::creep::Creep>),
    #[command(subcommand)]
    Robot(commands::robot::Robot),
    #[command(subcommand)]
    Log(commands::log::Log),
    Completions(commands::shell::Completions),
    Man(commands::shell::Man),
}

impl Command {
    fn run(self) -> Result<Finish, Failure> {
        match self {
            Self::Init(command) => command.run(),
            Self::Estimate(command) => command.run(),
            Self::Baseline(command) => command.run(),
            Self::Trend(command) => command.run(),
            Self::Watch(arguments) => arguments.watch(),
            Self::Fleet(arguments) => arguments.fleet(),
            Self::Excitation(command) => command.run(),
            Self::Simulate(command) => command.run(),
            Self::Scenarios(arguments) => arguments.bench("scenarios"),
            Self::Paper(arguments) => arguments.bench("paper"),
            Self::Bench(command) => command.run(),
            Self::Rope(command) => command.run(),
            Self::Creep(command) => command.run(),
            Self::Robot(command) => command.run(),
            Self::Log(command) => command.run(),
            Self::Completions(command) => command.run(Cli::command()),
            Self::Man(command) => command.run(Cli::command()),
        }
    }
}

/// Runs the command line and returns the exit code. Call it once per process.
///
/// * `arguments`: arguments, starting with the name of the program.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    sinew_files::protect_inputs(true);
    let code = run_program(arguments, |cli: Cli| {
        cli.style.apply();
        cli.command.run()
    });
    sinew_files::protect_inputs(false);
    code
}

/// Parses the command line of a program, runs it, and returns the exit code. Call it once per process.
///
/// * `arguments`: arguments, starting with the name of the program.
/// * `run`: the program; its error is printed to stderr.
pub fn run_program<P: Parser>(
    arguments: impl IntoIterator<Item = OsString>,
    run: impl FnOnce(P) -> Result<Finish, Failure>,
) -> u8 {
    let arguments = Vec::from_iter(arguments);
    terminal::set_arguments(arguments.clone());
    if let Err(message) = sinew_files::multiply_budgets() {
        terminal::complain(terminal::Word::Error, &message);
        return 2;
    }
    let result = match P::try_parse_from(arguments) {
        Ok(program) => run(program),
        // Invalid usage. A closed stderr is ignored.
        Err(error) if error.use_stderr() => {
            let _ = error.print();
            return 2;
        }
        // Output of --help and --version.
        Err(error) => terminal::answer(&error.to_string()).map(|()| Finish::Complete),
    };
    terminal::end();
    match result {
        Ok(Finish::Complete) => 0,
        Ok(Finish::Lossy) => 3,
        Ok(Finish::InvalidInput) => 1,
        // The reader closed the pipe (`sinew … | head`).
        Err(Failure::ReaderGone) => 0,
        Err(Failure::Error(message)) => {
            terminal::complain(terminal::Word::Error, &message);
            1
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::builder::ValueParser;
    use clap::{Arg, Command};
    use quantity::{Angle, Area, Force, Length, Mass, Quantity, Share, Temperature, Time, Torque};

    /// All commands with their names, parents first.
    fn commands() -> Vec<(String, Command)> {
        let mut cli = Cli::command();
        cli.build();
        let mut found = Vec::new();
        let mut open = vec![(String::new(), cli)];
        while let Some((parent, command)) = open.pop() {
            let name = format!("{parent} {}", command.get_name()).trim().to_owned();
            let parts = command.get_subcommands().cloned();
            open.extend(parts.map(|part| (name.clone(), part)));
            found.push((name, command));
        }
        found
    }

    /// Whether an option has values of a type.
    fn has_type<T: Send + Sync + Clone + 'static>(arg: &Arg) -> bool {
        fn none<T: Clone>(_: &str) -> Result<T, String> {
            Err(String::new())
        }
        arg.get_value_parser().type_id() == ValueParser::from(none::<T>).type_id()
    }

    #[test]
    fn quiet_is_an_option_of_all_commands() {
        let commands = commands();
        assert!(commands.len() > 25, "{}", commands.len());
        for (name, command) in commands {
            // The argument of `help` is the name of a command.
            if name.split(' ').any(|word| word == "help") {
                continue;
            }
            let mut options = command.get_arguments().filter_map(Arg::get_long);
            assert!(options.any(|option| option == "quiet"), "{name}");
        }
    }

    /// The parser of a quantity, its value name, and its unit in `--help`.
    #[test]
    fn options_of_a_quantity_accept_units() {
        type Row = (&'static str, fn(&Arg) -> bool, &'static str);
        fn row<Q: Quantity + Send + Sync + 'static>(name: &'static str) -> Row {
            (name, has_type::<Q>, Q::UNIT)
        }
        let quantities = [
            row::<Angle>("ANGLE"),
            row::<Area>("AREA"),
            row::<Force>("FORCE"),
            row::<Length>("LENGTH"),
            row::<Mass>("MASS"),
            row::<Share>("SHARE"),
            row::<Temperature>("TEMPERATURE"),
            row::<Time>("TIME"),
            row::<Torque>("TORQUE"),
        ];
        // Dates, and quantities whose unit is in the value name.
        let others = [
            "DATE",
            "1/H",
            "1/S",
            "FACTOR",
            "G/M",
            "HZ",
            "MM/MM",
            "N/MM",
            "PER_S",
            "RAD_PER_S",
            "RATIO",
        ];
        // Words of options that name a quantity, and the quantity; stiffness and the like end in other words.
        let words = [
            ("length", "LENGTH"),
            ("diameter", "LENGTH"),
            ("radius", "LENGTH"),
            ("stroke", "LENGTH"),
            ("elongation", "LENGTH"),
            ("pitch", "LENGTH"),
            ("area", "AREA"),
            ("tension", "FORCE"),
            ("force", "FORCE"),
            ("load", "FORCE"),
            ("loads", "FORCE"),
            ("preload", "FORCE"),
            ("torque", "TORQUE"),
            ("payload", "MASS"),
            ("temperature", "TEMPERATURE"),
            ("temperatures", "TEMPERATURE"),
            ("duration", "TIME"),
            ("durations", "TIME"),
            ("horizon", "TIME"),
            ("forecast", "TIME"),
            ("pause", "TIME"),
            ("cycle", "TIME"),
            ("at", "TIME"),
            ("from", "TIME"),
            ("to", "TIME"),
            ("level", "SHARE"),
            ("scatter", "SHARE"),
            ("share", "SHARE"),
            ("risk", "SHARE"),
        ];
        let mut seen = 0;
        for (name, command) in commands() {
            for arg in command
                .get_arguments()
                .filter(|arg| arg.get_long().is_some())
            {
                let long = arg.get_long().unwrap_or_default();
                let place = format!("{name} --{long}");
                let value = arg.get_value_names().and_then(|names| names.first());
                let value = value.map_or("", |value| value.as_str());
                if !arg.get_action().takes_values() {
                    continue;
                }
                for unit in [
                    "-mm", "-mm2", "-n", "-c", "-s", "-min", "-h", "-kg", "-percent",
                ] {
                    assert!(
                        !long.ends_with(unit),
                        "{place}: a value has the unit, not the option"
                    );
                }
                let is_plain = value.chars().all(|c| c.is_ascii_uppercase());
                let quantity = value.split(['[', '\u{b1}']).next().unwrap_or_default();
                let one = quantity.strip_suffix('S').unwrap_or(quantity);
                let named = |row: &&Row| row.0 == quantity || row.0 == one;
                let row = quantities.iter().find(named);
                // A sign, a list or a standard deviation has its own type, made by the same parser.
                let typed = quantities.iter().find(|row| (row.1)(arg));
                if let Some((quantity, ..)) = typed {
                    assert_eq!(row.map(|row| row.0), Some(*quantity), "{place} <{value}>");
                }
                if let Some((quantity, is_typed, unit)) = row {
                    seen += 1;
                    assert!(is_typed(arg) || !is_plain, "{place}: {quantity}");
                    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
                    let mut words = help.split(|c: char| c.is_whitespace() || ",:;()".contains(c));
                    assert!(
                        words.any(|word| word == *unit),
                        "{place}: no {unit} in '{help}'"
                    );
                }
                if has_type::<f64>(arg) {
                    assert!(
                        others.contains(&value),
                        "{place} <{value}> is a number without a unit"
                    );
                }
                // `--to` is a time, `--shift-to` is not.
                let last = long.rsplit('-').next().unwrap_or_default();
                let ends = ["at", "from", "to"];
                let named = |word: &str| word == long || word == last && !ends.contains(&word);
                if let Some((_, expected)) = words.iter().find(|(word, _)| named(word)) {
                    assert_eq!(row.map(|row| row.0), Some(*expected), "{place} <{value}>");
                }
            }
        }
        assert!(seen > 40, "{seen}");
    }
}
