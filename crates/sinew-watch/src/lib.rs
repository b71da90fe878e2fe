//! Monitor of running robots: receives messages, estimates, stores, raises alarms and shows the results.
//!
//! The state of a robot is kept by the state machine of [`sinew_watch_core`]; this crate adds the clock, threads,
//! store and web page.
//!
//! Reading order: [`args`], [`config`] (configuration), [`check`], [`store`] (storage), [`runtime`] (threads),
//! [`words`] (texts), [`web`], [`webhooks`] and [`mqtt`] (output), [`months`], [`operate`] (commands), [`service`] (the program).

pub mod args;
pub mod check;
pub mod config;
pub mod demo;
pub mod discover;
mod hex;
mod mail;
pub mod months;
pub mod mqtt;
pub mod notify;
pub mod operate;
pub mod runtime;
pub mod service;
pub mod store;
mod stream;
pub mod token;
pub mod web;
pub mod webhooks;
pub mod words;

use args::{Args, Command};
use config::Config;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Runs the program with its arguments.
///
/// # Errors
/// Returns the reason as text if an argument, file or address is invalid.
pub fn run(args: &Args) -> Result<ExitCode, String> {
    match &args.command {
        Some(Command::Backup { target, config }) => return operate::backup(config, target),
        Some(Command::Disk { config }) => return operate::disk(config),
        Some(Command::Notify { config }) => return operate::notify(config),
        Some(Command::Acknowledge(alarm)) => return operate::acknowledge(alarm),
        Some(Command::Survival { table, config }) => return operate::survival(config, table),
        None => {}
    }
    if args.demo {
        let mut web = config::WebSettings::default();
        if let Some(bind) = args.bind {
            web.bind = Some(bind);
        }
        demo::run(web)?;
        return Ok(ExitCode::SUCCESS);
    }
    let usual = || Some(PathBuf::from(config::PLACE)).filter(|path| path.is_file());
    let Some(file) = args.config.clone().or_else(usual) else {
        if args.check {
            return Err(format!(
                "no configuration to check: {} not found",
                config::PLACE
            ));
        }
        let found = discover::listen(|line| eprintln!("{line}"))?;
        print!("{}", discover::render(&found));
        return Ok(ExitCode::SUCCESS);
    };
    if args.check {
        return check_file(&file);
    }
    service::run(&file)?;
    Ok(ExitCode::SUCCESS)
}

fn check_file(file: &Path) -> Result<ExitCode, String> {
    let config = Config::read(file).map_err(|e| e.to_string())?;
    let faults = check::faults(&config);
    for fault in &faults {
        eprintln!("error: {}: {fault}", file.display());
    }
    let robots = match config.robots.len() {
        1 => "1 robot".into(),
        n => format!("{n} robots"),
    };
    if faults.is_empty() {
        println!("{}: {robots}, no faults found", file.display());
    }
    Ok(ExitCode::from(u8::from(!faults.is_empty())))
}
