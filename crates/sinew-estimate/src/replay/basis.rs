//! Settings of an estimate, and the origin of each quantity.

use super::result::{Basis, Origin, Quantity, Settings};
use crate::request::Request;
use sinew_model::offset::{OffsetConfig, TorqueSource, VelocityFilter};

pub(super) fn settings(request: &Request, config: &OffsetConfig) -> Settings {
    Settings {
        source: config.source,
        comparison: config.comparison,
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

pub(super) fn basis(request: &Request, config: &OffsetConfig) -> Vec<Basis> {
    let torque = match config.source {
        TorqueSource::Observer => Origin::Observed,
        TorqueSource::TorqueSensor => Origin::Measured,
        TorqueSource::Motor => Origin::MotorTorque,
    };
    let mut rows = vec![
        (Quantity::Positions, Origin::Measured),
        (Quantity::ElasticTorque, torque),
        (Quantity::Transmission, Origin::Stated),
    ];
    if request.use_tau_ext {
        rows.push((Quantity::ExternalTorque, Origin::AssumedExact));
    }
    rows.push((Quantity::Offset, Origin::Estimated));
    let row = |(quantity, based_on)| Basis { quantity, based_on };
    rows.into_iter().map(row).collect()
}
