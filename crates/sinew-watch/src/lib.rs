//! Monitor of running robots: receives messages, estimates, stores, raises alarms and shows the results.
//!
//! The state of a robot is kept by the state machine of [`sinew_watch_core`]; this crate adds the clock, threads,
//! store and web page.
//!
//! Reading order: [`args`], [`config`] (configuration), [`check`], [`store`] (storage), [`runtime`] (threads),
//! [`words`] (texts), [`web`] and [`webhooks`] (output), [`months`], [`service`] (the program).

pub mod args;
pub mod check;
pub mod config;
pub mod demo;
pub mod discover;
mod hex;
pub mod months;
pub mod notify;
pub mod runtime;
pub mod service;
pub mod store;
pub mod token;
pub mod web;
pub mod webhooks;
pub mod words;

use args::{Args, Command};
use config::Config;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use store::{Place, Reader, StoreError};

/// Runs the program with its arguments.
///
/// # Errors
/// Returns the reason as text if an argument, file or address is invalid.
pub fn run(args: &Args) -> Result<ExitCode, String> {
    if let Some(Command::Backup { target, config }) = &args.command {
        return backup(config, target);
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

fn backup(config: &Path, target: &Path) -> Result<ExitCode, String> {
    let config = Config::read(config).map_err(|e| e.to_string())?;
    let place = Place::Folder(config.store);
    let file = place.file();
    let error = |e: StoreError| format!("{file}: {e}");
    let reader = Reader::open(&place).map_err(error)?;
    reader.check().map_err(error)?;
    let length = reader.backup(target).map_err(error)?;
    println!("{}: {:.1} MB", target.display(), 1e-6 * length as f64);
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
