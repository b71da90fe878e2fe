//! Errors of the tension sensors of tendons.

use super::{Description, Effect, Lifetime, Parameter};

pub(crate) struct TensionSensor;

impl Effect for TensionSensor {
    const DESCRIPTION: Description = Description {
        title: "Tension sensor error",
        text: "A recorded tension is a measurement of the tendon force, with errors of gain and zero.",
        equation: "tension   LP[t] = (1 + g) LP[f] + b",
        parameters: &[
            Parameter {
                name: "tension sensor gain",
                symbol: "g",
                unit: "",
                prior_text: "0 ± `tension_sensor_percent`",
                source: "data sheets of strain gauge load cells",
                lifetime: Lifetime::Months,
                ..Parameter::CARRIED
            },
            Parameter {
                name: "tension sensor zero",
                symbol: "b",
                unit: "N·m",
                prior_text: "0 ± `tension_sensor_percent` of the pretension, at least of 20 mrad × K",
                source: "data sheets of strain gauge load cells",
                lifetime: Lifetime::Days,
                ..Parameter::CARRIED
            },
        ],
    };
}
