//! A block's equations where tendons cross several joints: one per tendon, and one per motor.
//!
//! The equation of tendon `i` is that of a joint with a tendon of its own, with the torque and the joint positions of all joints that it crosses:
//!
//! ```text
//! tau_i = Σ_j B_ij tau_j,     deflection_i = own + Σ_j rho_ij e_j(q_j)
//! ```
//!
//! In addition to the tendon's own parameters the equation has the friction and the encoder of every joint, which are parameters of that joint.

use super::equation::{Equations, Side};
use super::joint_rows;
use super::loaded::{Common, Loaded};
use super::reduced_model::ReducedModel;
use crate::cholesky::dot;
use crate::offset::block::Block;
use crate::offset::change::ChangeKind;
use crate::offset::effects::{
    AllEffects, ENCODER, Effect, FORCE, Factors, JointParameter as P, JointRow, Measured,
    PER_JOINT, Point, total,
};
use crate::routings::Routings;

/// Fills `out` with the equations of `block` around the state in `common`. Never allocates.
pub(super) fn linearise(
    model: &ReducedModel,
    routes: &Routings,
    block: &Block,
    joints: impl Iterator<Item = Option<Measured>>,
    common: &Common<'_>,
    out: &mut Equations,
) {
    let mut measured = core::mem::take(&mut out.measured);
    measured.clear();
    measured.extend(joints.take(model.joints.len().min(measured.capacity())));
    let mut others = core::mem::take(&mut out.of_others);
    let has_own = |i: &usize| routes.pull(*i).is_none() && routes.pulled(*i).is_none();
    for i in (0..measured.len()).filter(has_own) {
        linearise_tendon(i, model, routes, block, &measured, common, &mut others, out);
    }
    out.of_others = others;
    if routes.has_pulls() {
        joint_rows::linearise(model, routes, block, &measured, common, out);
    }
    out.measured = measured;
}

/// The equations of the tendon that is paired with joint `i`.
#[allow(clippy::too_many_arguments)]
fn linearise_tendon(
    i: usize,
    model: &ReducedModel,
    routes: &Routings,
    block: &Block,
    measured: &[Option<Measured>],
    common: &Common<'_>,
    others: &mut [JointRow],
    out: &mut Equations,
) {
    let state =
        |j: usize| -> Option<&JointRow> { common.x.get(model.layout.own(j))?.first_chunk() };
    let joint = |j: usize| model.joints.get(j).and_then(Option::as_ref);
    let (Some(own_joint), Some(Some(is)), Some(own)) = (joint(i), measured.get(i), state(i)) else {
        return;
    };
    let Some(phi) = model.phi(block, i) else {
        return;
    };
    let rows = common.is_rows();
    let mut own = *own;
    own[P::Offset as usize] = out.sum(common.x, ChangeKind::Offset(i), 0);
    own[P::Compliance as usize] = out.sum(common.x, ChangeKind::Compliance(i), 0);
    let point = Point {
        x: &own,
        joint: own_joint,
        measured: is,
        temperature_difference_k: common.warmer,
    };
    let mut derivatives = [0.0; PER_JOINT];
    let bodies = common.x.get(model.layout.carried()).unwrap_or_default();
    let (load_nm, load) = is.load.torque(&common.payload);
    let mut tau = is.tau + dot(phi, bodies.get(..phi.len()).unwrap_or_default()) + load_nm;
    let mut slope = [0.0; FORCE];
    if let Some((applied, torques)) = &common.force {
        for (share, torque) in routes.torque_shares(i).iter().zip(*torques) {
            let (torque, own_slope) = torque.torque(applied);
            tau += share * torque;
            for (to, x) in slope.iter_mut().zip(own_slope) {
                *to += share * x;
            }
        }
    }
    if rows {
        let force = common.force.is_some().then_some(&slope);
        out.carry(i, phi, &load, force);
    }
    let (mut unknown_nm2, mut others_rad) = (0.0, 0.0);
    for (j, of_other) in others.iter_mut().enumerate() {
        *of_other = [0.0; PER_JOINT];
        let (Some(Some(other)), Some(nominal), Some(x)) = (measured.get(j), joint(j), state(j))
        else {
            continue;
        };
        let share = routes.torque_shares(i).get(j).copied().unwrap_or(0.0);
        if share != 0.0 {
            let at = Point {
                x: if j == i { &own } else { x },
                joint: nominal,
                measured: other,
                temperature_difference_k: common.warmer,
            };
            let mut torque = [0.0; PER_JOINT];
            tau += share
                * total(0.0, &mut torque, |sum| {
                    AllEffects::joint_torque(&at, sum);
                });
            let unknown = share * AllEffects::unknown_torque(&at);
            unknown_nm2 += unknown * unknown;
            let to = if j == i {
                &mut derivatives
            } else {
                &mut *of_other
            };
            for (to, x) in to.iter_mut().zip(torque) {
                *to += share * x;
            }
        }
        // The encoder of the paired joint is in `measured` as this tendon sees it.
        let arm = routes.moment_arm(i, j) / routes.moment_arm(j, j);
        if j != i && arm != 0.0 {
            let first = P::Encoder as usize;
            for (k, wave) in other.encoder.iter().enumerate().take(ENCODER) {
                others_rad += x[first + k] * arm * wave;
                of_other[first + k] = arm * wave;
            }
        }
    }
    let arms = ArmErrors {
        i,
        model,
        routes,
        measured,
        turned: &block.turned,
        x: common.x,
    };
    for (error, [torque, deflection]) in arms.state().zip(arms.columns()) {
        tau += error * torque;
        others_rad += error * deflection;
    }
    let loaded = Loaded {
        joint: i,
        rows,
        tau,
        unknown_nm: libm::sqrt(unknown_nm2),
        others_rad,
    };
    let (link, factors) = loaded.link_side(&point, &mut derivatives);
    let is_loaded = link.torque_gain > 0.0;
    out.push(link);
    if rows {
        let of_arms = arms.rows(&factors);
        out.cross_rows(
            (i, Side::Link),
            others.iter().map(|d| factors.row(d)),
            of_arms,
        );
    }
    if let (Some(drive), true) = (&is.drive, common.motor && is_loaded) {
        let (motor, factors) = loaded.motor_side(&point, drive, &mut derivatives);
        out.push(motor);
        if rows {
            let of_arms = arms.rows(&factors);
            out.cross_rows(
                (i, Side::Motor),
                others.iter().map(|d| factors.row(d)),
                of_arms,
            );
        }
    }
}

/// Errors of moment arms in the equations of tendon `i`.
struct ArmErrors<'a> {
    i: usize,
    model: &'a ReducedModel,
    routes: &'a Routings,
    measured: &'a [Option<Measured>],
    /// Low-passed joint positions, rad.
    turned: &'a [f64],
    x: &'a [f64],
}

impl ArmErrors<'_> {
    /// Values in the state.
    fn state(&self) -> impl Iterator<Item = f64> {
        let layout = self.model.layout;
        let own = self.x.get(layout.arm_start()..layout.body_start());
        own.unwrap_or_default().iter().copied()
    }

    /// Torque and deflection by a unit of every error: `−B_ij ρ_tj f_t` with `f_t = K_t (y_t − Δ_e − y₀)`, and `ρ_ij LP[q_j]` of the tendon itself.
    fn columns(&self) -> impl Iterator<Item = [f64; 2]> {
        let shares = self.routes.torque_shares(self.i);
        self.routes.crossings().iter().map(move |(t, j)| {
            let arm = self.routes.moment_arm(*t, *j);
            let share = shares.get(*j).copied().unwrap_or(0.0);
            let deflection = match *t == self.i {
                true => arm * self.turned.get(*j).copied().unwrap_or(0.0),
                false => 0.0,
            };
            [-share * arm * self.tension(*t), deflection]
        })
    }

    /// Torque that tendon `t` carries, by its nominal stiffness, N·m.
    fn tension(&self, t: usize) -> f64 {
        let joint = self.model.joints.get(t).and_then(Option::as_ref);
        let (Some(joint), Some(Some(is))) = (joint, self.measured.get(t)) else {
            return 0.0;
        };
        let own = self.x.get(self.model.layout.own(t)).unwrap_or_default();
        let at = |parameter: P| own.get(parameter as usize).copied().unwrap_or(0.0);
        joint.stiffness_nm_per_rad * (is.y - at(P::Offset) - at(P::Zero))
    }

    /// Row of an equation over the errors.
    fn rows(&self, factors: &Factors) -> impl Iterator<Item = f64> {
        let Factors {
            joint_torque,
            deflection,
            ..
        } = *factors;
        let columns = self.columns();
        columns.map(move |[torque, path]| joint_torque * torque + deflection * path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::config::FeatureConfig;
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::equations::linearise::{Linearisation, linearise};
    use crate::offset::equations::loaded::Content;
    use crate::offset::fixtures::{random, slopes, tables};
    use crate::offset::prior::Prior;
    use crate::routing::Routing;
    use crate::tolerances::Tolerances;
    use crate::transmission::{Friction, Transmission};
    use alloc::vec::Vec;

    /// A differential: both tendons cross both joints, the second one the other way.
    fn differential() -> EstimationModel {
        let (a, b) = (0.6, 1.7);
        // rho = (1 a; −b −1), B = rho⁻ᵀ.
        let det = a * b - 1.0;
        let rows = [([1.0, a], [-1.0, b]), ([-b, -1.0], [-a, 1.0])];
        let mut joint = 0..2;
        let transmissions = rows.map(|(arms, shares): ([f64; 2], [f64; 2])| {
            let friction = Friction {
                coulomb_nm: 0.1,
                viscous_nm_s_per_rad: 0.05,
            };
            Some(Transmission {
                motor_inertia_kg_m2: Some(0.05),
                joint_friction: friction,
                motor_friction: friction,
                routing: Some(Routing {
                    tendon: "tendon".into(),
                    joint: joint.next().unwrap(),
                    motor: "motor".into(),
                    drive_ratio: 1.0,
                    moment_arms: arms.to_vec(),
                    torque_shares: shares.map(|x| x / det).to_vec(),
                    pull: None,
                }),
                ..Transmission::spring(40.0)
            })
        });
        let prior = Prior::new(
            &tables(2),
            &transmissions,
            1,
            [0.0; 3],
            Tolerances::default(),
        );
        EstimationModel::new(prior, &FeatureConfig::default())
    }

    /// Rows against differences of what is expected, of all parameters of both joints.
    #[test]
    fn rows_are_derivatives_of_what_is_expected() {
        let model = differential();
        let (reduced, layout) = (&model.reduced, model.reduced.layout);
        let mut seed = 8;
        let mut block = Block::zero(2, layout.bodies);
        let all = block.sums().into_iter().flatten();
        all.for_each(|x| *x = random(&mut seed));
        block.temperature_c = 26.0;
        let how = Linearisation {
            reference_c: 20.0,
            changes: &[],
            motor: true,
            force: None,
            content: Content::Rows,
        };
        let linearised = |x: &[f64]| {
            let mut out = Equations::new(layout, &[]);
            let measured = (0..2).map(|i| Measured::of(reduced, &block, i));
            linearise(reduced, &block, measured, &how, x, &mut out);
            out
        };
        let mut x: Vec<f64> = (0..layout.dimension())
            .map(|_| 0.2 * random(&mut seed))
            .collect();
        // Derivatives of one effect by a parameter of another are neglected.
        for joint in 0..2 {
            for none in [P::InitialFriction, P::Slack, P::Viscoelastic] {
                x[layout.place(joint, none)] = 0.0;
            }
        }
        x[layout.arm_start()..layout.body_start()].fill(0.0);
        x[layout.payload_place()..].fill(0.0);
        let at = linearised(&x);
        assert_eq!(at.list.len(), 4);
        let (mut crossed, mut of_arms) = (0, 0);
        for place in 0..layout.payload_place() {
            for (e, [slope, row]) in at.list.iter().zip(slopes(&at, &x, place, linearised)) {
                assert!(
                    (slope - row).abs() < 1e-7 * (1.0 + row.abs()),
                    "{place} of {:?}: {slope} {row}",
                    e.side
                );
                let is_of_other =
                    place < layout.arm_start() && !layout.own(e.joint).contains(&place);
                let is_of_arm = (layout.arm_start()..layout.body_start()).contains(&place);
                of_arms += usize::from(is_of_arm && row.abs() > 1e-6);
                crossed += usize::from(is_of_other && row.abs() > 1e-6);
                let mut whole = alloc::vec![0.0; x.len()];
                at.add_to(e, 1.0, &mut whole);
                assert!((whole[place] - row).abs() < 1e-12);
            }
        }
        // Friction, three numbers and stiction, in two equations, and the encoder in that of the link alone; of both joints.
        assert_eq!(crossed, 2 * (2 * 4 + ENCODER));
        // Both errors are in all four equations.
        assert_eq!(of_arms, 2 * 4);
    }
}
