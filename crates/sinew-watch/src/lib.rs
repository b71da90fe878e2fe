//! The monitor of running robots: listens, learns, keeps, alarms, shows.
//!
//! What is known of a robot is [`sinew_watch_core`]'s, a state machine; here are its clock, its threads, its disk
//! and its web page.
//!
//! Reading order: [`args`], [`config`] (what the owner asks for), [`check`], [`store`] (what is kept), [`runtime`]
//! (threads), [`words`] (what is said), [`web`] and [`webhooks`] (to whom), [`months`], [`service`] (all of it).

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

use args::Args;
use config::Config;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Does what the program is asked for.
///
/// # Errors
/// What is wrong, in words.
pub fn run(args: &Args) -> Result<ExitCode, String> {
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
                "name the configuration to check; {} isn't there",
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
        println!("{}: {robots}, nothing is wrong", file.display());
    }
    Ok(ExitCode::from(u8::from(!faults.is_empty())))
}
