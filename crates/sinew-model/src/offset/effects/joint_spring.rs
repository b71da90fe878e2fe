//! Errors of the passive springs of joints.

use super::{Description, Effect, Lifetime, Parameter};

pub(crate) struct JointSpring;

impl Effect for JointSpring {
    const DESCRIPTION: Description = Description {
        title: "Joint spring error",
        text: "A passive spring at a joint, e.g. one that opens a finger, acts in addition to the tendons. Its stiffness and its rest position differ from robot.toml. \
               A baseline determines both. Later sessions assume that springs do not age.",
        equation: "torque   −k_s (1 + e_k) (LP[q] − q_rest − e_q)",
        parameters: &[
            Parameter {
                name: "joint spring stiffness",
                symbol: "e_k",
                unit: "",
                prior_text: "0 ± `spring_percent`",
                source: "tolerance of wound and moulded springs; engineering judgement",
                lifetime: Lifetime::Months,
                ..Parameter::CARRIED
            },
            Parameter {
                name: "joint spring rest position",
                symbol: "e_q",
                unit: "rad",
                prior_text: "0 ± `spring_rest_mrad`",
                source: "accuracy of assembly by hand; engineering judgement",
                lifetime: Lifetime::Months,
                ..Parameter::CARRIED
            },
        ],
    };
}
