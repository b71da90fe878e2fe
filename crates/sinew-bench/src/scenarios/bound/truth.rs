//! Point at which the model is differentiated, and its derivatives.

use super::noise::Autocovariance;
use super::{COLUMNS, PER_BODY, PER_JOINT};
use sinew_estimate::session::Recorded;
use sinew_model::arm::{Arm, BodyInertia};
use sinew_model::offset::{Block, FeatureConfig};
use sinew_sim::Simulation;
use sinew_sim::protocol::Plan;

/// True values of a joint.
pub(super) struct Joint {
    pub(super) stiffness: f64,
    cubic: f64,
    coulomb: f64,
    viscous: f64,
    load: f64,
    drift: f64,
    thermal: f64,
}

/// Point at which the model is differentiated.
pub(super) struct Truth {
    pub(super) joints: Vec<Joint>,
    /// Base parameters per session, `r`, payload included.
    inertial: [Vec<f64>; 2],
    /// Their change per draw of each body: `n × 5`, `r` each.
    per_draw: Vec<Vec<f64>>,
    /// Their change per kg of payload, `r`.
    per_kg: Vec<f64>,
    change_k: f64,
}

impl Truth {
    pub(super) fn of(plan: &Plan, simulation: &Simulation) -> Option<Self> {
        let n = plan.robot.arm.dof();
        let arm = simulation.true_empty_arm();
        let temperature = simulation.temperature();
        let joints = simulation
            .drives()
            .iter()
            .enumerate()
            .map(|(i, drive)| Joint {
                stiffness: drive.stiffness_nm_per_rad,
                cubic: drive.cubic_per_rad2,
                coulomb: drive.joint_friction.coulomb_nm,
                viscous: drive.joint_friction.viscous_nm_s_per_rad,
                load: drive.joint_friction.torque_fraction,
                drift: temperature.drift_rad_per_k[i],
                thermal: -temperature.stiffness_per_k[i],
            })
            .collect();
        let empty = arm.inertial_parameters();
        let (mut loaded, mut per_kg) = (empty.clone(), vec![0.0; n * COLUMNS]);
        let begin_s = plan.scenario.sessions[1].from_s;
        for p in simulation
            .payloads()
            .iter()
            .filter(|p| p.attach_s <= begin_s)
        {
            let unit = arm
                .with_payload(&p.link, BodyInertia::point(1.0, p.com_m))
                .ok()??;
            for ((kg, with), without) in per_kg
                .iter_mut()
                .zip(unit.inertial_parameters())
                .zip(&empty)
            {
                *kg = with - without;
            }
            for (x, kg) in loaded.iter_mut().zip(&per_kg) {
                *x += p.mass_kg * kg;
            }
        }
        let base = plan.robot.arm.base_parameters();
        let mut draws = Vec::new();
        for b in 0..n {
            for change in per_draw(arm, b)? {
                let mut all = vec![0.0; n * COLUMNS];
                all[b * COLUMNS..(b + 1) * COLUMNS].copy_from_slice(&change);
                draws.push(base.of(&all));
            }
        }
        Some(Self {
            joints,
            inertial: [base.of(&empty), base.of(&loaded)],
            per_draw: draws,
            per_kg: base.of(&per_kg),
            change_k: temperature.change_k,
        })
    }

    fn phi<'b>(&self, block: &'b Block, i: usize) -> &'b [f64] {
        let r = self.per_kg.len();
        &block.phi[i * r..(i + 1) * r]
    }

    /// Elastic torque over stiffness of joint `i` in a block, rad.
    fn deflection(&self, block: &Block, i: usize, session: usize) -> f64 {
        let joint = &self.joints[i];
        let phi = self.phi(block, i);
        let tau = dot(phi, &self.inertial[session])
            + joint.coulomb * block.z[i]
            + joint.viscous * block.dq[i]
            + joint.load * block.z_load[i] * joint.stiffness;
        tau / joint.stiffness
    }

    /// Effect of the sensors' errors on the residual of each joint, per block.
    pub(super) fn errors(
        &self,
        clean: &[Recorded],
        noisy: &[Recorded],
        n: usize,
    ) -> Vec<Autocovariance> {
        let residual = |block: &Block, i: usize, session: usize| {
            let d = self.deflection(block, i, session);
            block.y[i] - d + self.joints[i].cubic * d * d * d
        };
        (0..n)
            .map(|i| {
                let series: Vec<Vec<f64>> = clean
                    .iter()
                    .zip(noisy)
                    .enumerate()
                    .map(|(session, (clean, noisy))| {
                        clean
                            .blocks
                            .iter()
                            .zip(&noisy.blocks)
                            .map(|(c, m)| residual(m, i, session) - residual(c, i, session))
                            .collect()
                    })
                    .collect();
                Autocovariance::of(&series, FeatureConfig::default().block_s)
            })
            .collect()
    }

    /// Derivatives of `y` of joint `i` in a block, rad per unit of each parameter.
    pub(super) fn row(
        &self,
        block: &Block,
        i: usize,
        session: usize,
        n: usize,
        total: usize,
    ) -> Vec<f64> {
        let mut row = vec![0.0; total];
        let joint = &self.joints[i];
        let phi = self.phi(block, i);
        let d = self.deflection(block, i, session);
        let slope = 1.0 - 3.0 * joint.cubic * d * d;
        let per_torque = slope / joint.stiffness;
        let warmer = if session == 0 { 0.0 } else { self.change_k };
        let own = [
            slope * d,
            -d * d * d,
            per_torque * block.z[i],
            per_torque * block.dq[i],
            slope * block.z_load[i],
            warmer,
            slope * d * warmer,
        ];
        let at = i * PER_JOINT;
        row[at..at + own.len()].copy_from_slice(&own);
        row[at + own.len()..at + PER_JOINT].copy_from_slice(&block.encoder[i * 4..(i + 1) * 4]);
        let bodies = n * PER_JOINT;
        for (k, change) in self.per_draw.iter().enumerate() {
            row[bodies + k] = per_torque * dot(phi, change);
        }
        let rest = bodies + n * PER_BODY;
        if session == 1 {
            row[rest] = per_torque * dot(phi, &self.per_kg);
            row[rest + 1] = joint.drift + slope * d * joint.thermal;
            row[rest + 2 + i] = 1.0;
        }
        row
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// How the inertial parameters of body `b` change per draw, by central differences: they are at
/// most quadratic in each, so that the result is independent of the step.
fn per_draw(arm: &Arm, b: usize) -> Option<Vec<[f64; COLUMNS]>> {
    const STEP: f64 = 1e-2;
    let body = arm.body(b)?;
    let [x, y, z] = body.com;
    let length = (x * x + y * y + z * z).sqrt();
    // Two directions across the centre of mass's own.
    let least = (0..3).min_by(|&a, &c| body.com[a].abs().total_cmp(&body.com[c].abs()))?;
    let across = |turn: usize| -> [f64; 3] {
        let (p, q) = ((least + 1) % 3, (least + 2) % 3);
        let mut v = [0.0; 3];
        (v[p], v[q]) = (body.com[q], -body.com[p]);
        let w = [
            y * v[2] - z * v[1],
            z * v[0] - x * v[2],
            x * v[1] - y * v[0],
        ];
        let v = if turn == 0 { v } else { w };
        let norm = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|c| if norm > 0.0 { c / norm } else { 0.0 })
    };
    let drawn = |k: usize, step: f64| -> Option<Vec<f64>> {
        let mut changed = body;
        match k {
            0 => {
                changed.mass *= 1.0 + step;
                changed.inertia = changed.inertia.map(|r| r.map(|v| v * (1.0 + step)));
            }
            1 => changed.com = changed.com.map(|c| c * (1.0 + step)),
            2 | 3 => {
                let v = across(k - 2);
                changed.com = std::array::from_fn(|m| body.com[m] + step * length * v[m]);
            }
            _ => changed.inertia = changed.inertia.map(|r| r.map(|v| v * (1.0 + step))),
        }
        Some(arm.with_body(b, changed).ok()?.inertial_parameters())
    };
    (0..PER_BODY)
        .map(|k| {
            let (up, down) = (drawn(k, STEP)?, drawn(k, -STEP)?);
            let own = b * COLUMNS;
            Some(std::array::from_fn(|m| {
                (up[own + m] - down[own + m]) / (2.0 * STEP)
            }))
        })
        .collect()
}
