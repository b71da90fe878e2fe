//! Tendons whose creep is known.

use sinew_fleet::creep::Creep;
use sinew_fleet::folder::sides::Fitted;
use sinew_fleet::gather::CreepingTendon;

/// A number that looks drawn: about normal, the same for the same place.
pub(crate) fn scatter(i: usize) -> f64 {
    let uniform = |k: usize| {
        let x = (12.9898 * (i * 12 + k) as f64).sin() * 43_758.545_3;
        x - x.floor()
    };
    (0..12).map(uniform).sum::<f64>() - 6.0
}

/// A tendon whose rope creeps by 300 µm/m per decade, times `factor`, times a scatter of 40 %.
pub(crate) fn tendon(i: usize, batch: &str, site: &str, factor: f64) -> CreepingTendon {
    let strain = 3e-4 * factor * (0.4 * scatter(i)).exp();
    CreepingTendon {
        robot: format!("arm-{i:04}"),
        joint: "elbow".into(),
        robot_type: "arm".into(),
        fit: Fitted {
            rope: Some("hemp".into()),
            batch: Some(batch.into()),
        },
        site: Some(site.into()),
        creep: Creep {
            per_decade_rad: strain / 0.05,
            std_rad: 0.05 * 3e-4 / 0.05,
            temperature_c: Some(21.0 + 0.1 * (i % 7) as f64),
            age_days: [1.0, 30.0],
            sessions: 30,
            steps: 0,
            is_dated: true,
        },
        strain_per_rad: Some(0.05),
    }
}
