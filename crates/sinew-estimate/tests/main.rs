//! All tests of sinew-estimate in one binary, which saves link time.

mod absolute;
mod absolute_events;
mod anchor;
#[path = "../../sinew-model/tests/model/answers.rs"]
mod answers;
mod bad_input;
mod baseline_merge;
mod cables;
mod coupled;
mod coverage;
mod external_force;
mod feeder;
mod golden;
mod in_memory;
mod long_recordings;
mod model_error;
mod motor_current;
mod offset_map;
mod offset_scenarios;
mod online;
mod real_absolute;
mod real_data;
mod rest_phases;
mod robot_check;
mod simulated_recordings;
mod slip_cause;
mod slips;
mod strands;
mod support;
mod tendons;
mod thermal;
mod transmission_loss;
mod wrong_channels;
