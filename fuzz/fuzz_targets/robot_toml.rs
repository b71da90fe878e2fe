//! Any text as `robot.toml`: no panic, and a robot that is built makes an estimator.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_model::offset::{OffsetConfig, OffsetObserver};
use sinew_model::robot::RobotFile;

const URDF: &str = include_str!("../../crates/sinew-model/robots/biorob-like/biorob-like.urdf");

fuzz_target!(|text: &str| {
    let Ok(file) = RobotFile::parse(text, "robot.toml") else {
        return;
    };
    if let Ok(robot) = file.build(URDF) {
        OffsetObserver::new(&robot.arm, &robot.transmissions, OffsetConfig::default())
            .expect("what robot.toml lets through makes an estimator");
    }
});
