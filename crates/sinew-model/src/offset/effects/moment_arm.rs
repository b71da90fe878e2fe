//! Errors of the moment arms of tendons at joints other than their own.

use super::{Description, Effect, Lifetime, Parameter};

pub(crate) struct MomentArm;

impl Effect for MomentArm {
    const DESCRIPTION: Description = Description {
        title: "Moment arm error",
        text: "A tendon that crosses several joints runs over pulleys whose radii differ from robot.toml. At a joint other than that of the tendon, the error changes the path length with the position of that joint, and the distribution of the torque over all tendons there. There is one parameter for each such tendon and joint.",
        equation: "deflection   ρ_ij ε_ij LP[q_j]\ntorque   −B_lj ρ_ij ε_ij K_i (y_i − Δ_e − y₀) of every tendon l",
        parameters: &[Parameter {
            name: "moment arm error",
            symbol: "ε_ij",
            unit: "",
            prior_text: "0 ± `moment_arm_percent`",
            source: "0.1 to 0.3 mm of rope and pulley on a radius of 10 to 30 mm; engineering judgement",
            lifetime: Lifetime::Months,
            ..Parameter::CARRIED
        }],
    };
}
