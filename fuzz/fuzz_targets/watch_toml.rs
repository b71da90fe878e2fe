//! Any text as the monitor's configuration: no panic; an accepted one can be monitored.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_watch::config::Config;
use std::collections::BTreeSet;
use std::path::Path;

fuzz_target!(|text: &str| {
    let Ok(config) = Config::parse(text, "watch.toml", Path::new("/etc/sinew")) else {
        return;
    };
    let names: BTreeSet<&str> = config.robots.iter().map(|r| r.name.as_str()).collect();
    assert!(!names.is_empty() && names.len() == config.robots.len());
    let elsewhere = config.web.bind.is_some_and(|bind| !bind.ip().is_loopback());
    assert!(!elsewhere || config.web.needs_token());
    for robot in &config.robots {
        // The name is part of addresses and file names.
        assert!(!robot.name.contains(['/', '\\']) && !robot.name.starts_with('.'));
        assert!(!robot.transport.source().is_empty());
        let celsius = robot.estimate.temperature_c;
        assert!(celsius.is_none_or(|c| c.mean.is_finite() && c.std > 0.0));
        let times = robot.times;
        for time_s in [
            times.stale_after_s,
            times.session_motion_s,
            times.session_pause_s,
        ] {
            assert!(time_s.is_finite() && time_s > 0.0);
        }
    }
});
