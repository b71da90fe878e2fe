//! All tests of sinew-estimate in one binary: one link, one start.

mod absolute;
mod absolute_events;
mod anchor;
#[path = "../../sinew-model/tests/model/answers.rs"]
mod answers;
mod bad_input;
mod baseline_merge;
mod coupled;
mod external_force;
mod feeder;
mod given;
mod honest;
mod known;
mod motor_current;
mod offset_map;
mod offset_scenarios;
mod online;
mod real_absolute;
mod real_data;
mod robot_check;
mod simulated_recordings;
mod slip_cause;
mod slips;
mod stands;
mod support;
mod tendons;
mod warmth;
