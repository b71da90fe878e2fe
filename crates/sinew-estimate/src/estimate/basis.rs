//! What an estimate was made with, and what each number rests on.

use super::request::Request;
use super::result::{Basis, Settings};
use crate::robot_dir::LoadedRobot;
use sinew_model::offset::{Comparison, OffsetConfig, TorqueSource, VelocityFilter};

pub(super) fn settings(request: &Request, config: &OffsetConfig) -> Settings {
    Settings {
        source: match config.source {
            TorqueSource::Observer => "observer",
            TorqueSource::TorqueSensor => "torque-sensor",
            TorqueSource::Motor => "motor",
        }
        .into(),
        comparison: match config.comparison {
            Comparison::Matched => "matched",
            Comparison::Paper => "paper",
        }
        .into(),
        gain_per_s: config.gain_per_s,
        velocity_filter_rad_per_s: match config.velocity {
            VelocityFilter::StateVariable { cutoff_rad_per_s } => Some(cutoff_rad_per_s),
            VelocityFilter::Recorded => None,
        },
        tau_ext: request.use_tau_ext,
        injected: request.injections.clone(),
        reference: None,
    }
}

pub(super) fn basis(request: &Request, config: &OffsetConfig, loaded: &LoadedRobot) -> Vec<Basis> {
    let row = |quantity: &str, rests_on: String| Basis {
        quantity: quantity.into(),
        rests_on,
    };
    let file = loaded.file.display();
    let mut rows = vec![row(
        "motor and joint positions, rad",
        "measured, in the recording".into(),
    )];
    rows.push(match config.source {
        TorqueSource::Observer => row(
            "elastic torque, N·m",
            format!(
                "computed by the momentum observer from the positions and the masses of {}; not measured",
                loaded.urdf
            ),
        ),
        TorqueSource::TorqueSensor => row(
            "elastic torque, N·m",
            "measured by the joint torque sensors, in the recording".into(),
        ),
        TorqueSource::Motor => row(
            "elastic torque, N·m",
            format!("computed from the recorded motor torque, motor inertia and friction of {file}"),
        ),
    });
    rows.push(row(
        "stiffness, N·m/rad; friction; tendon geometry, mm",
        format!("as stated in {file}; not fitted to this recording"),
    ));
    if request.use_tau_ext {
        rows.push(row(
            "external torque, N·m",
            "as recorded, taken as known".into(),
        ));
    }
    rows.push(row(
        "offset, mrad; elongation, mm; strain, %",
        "the estimate; its standard error covers the scatter within this recording, not an error of stiffness, masses or payload: differences between recordings of like motion are surer than absolute values".into(),
    ));
    rows
}
