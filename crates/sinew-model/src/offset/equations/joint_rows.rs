//! A block's equations of a group with an equation per joint: one per joint, per motor with a torque, and per tension sensor.
//!
//! ```text
//! Σ_i rho_ij f_i = tau_j + tau_spring_j                            joint, divided by K_j = Σ_i rho_ij² K_i
//! u_k = (1 + k) (Σ_i s_ik f_i + J LP[ddtheta] + drive friction) + b        motor
//! t_i = (1 + g) f_i + b                                            tension sensor
//! f = f0 + K (x + η x³) / (1 + Σ compliance),   x = y − Σ deflection
//! ```
//!
//! A strand only pulls. Its extension varies within the memory of the low-pass with a standard deviation `σ_y² = LP[y²] − LP[y]²`, so that its mean tension is
//! that of a normal distribution cut off at zero, with `m` the tension above if it could push:
//!
//! ```text
//! f = m Φ(m/σ) + σ φ(m/σ),   ∂f/∂m = Φ(m/σ),   σ = K σ_y
//! ```

use super::equation::{Equation, Equations, Side};
use super::loaded::Common;
use super::pull_state::PullState;
use super::reduced_model::ReducedModel;
use crate::cholesky::dot;
use crate::offset::block::Block;
use crate::offset::change::ChangeKind;
use crate::offset::effects::{
    AllEffects, ENCODER, Effect, FORCE, Factors, JointParameter as P, JointRow, Measured,
    PER_JOINT, Point, total,
};
use crate::routings::Routings;
use crate::tendons::TendonKind;

/// Inputs common to the equations of a block.
struct Rows<'a> {
    model: &'a ReducedModel,
    routes: &'a Routings,
    block: &'a Block,
    measured: &'a [Option<Measured>],
    common: &'a Common<'a>,
}

/// Adds the equations of all groups with an equation per joint. Never allocates.
pub(super) fn linearise(
    model: &ReducedModel,
    routes: &Routings,
    block: &Block,
    measured: &[Option<Measured>],
    common: &Common<'_>,
    out: &mut Equations,
) {
    let rows = Rows {
        model,
        routes,
        block,
        measured,
        common,
    };
    let mut pulls = core::mem::take(&mut out.pulls);
    for (i, pull) in pulls.iter_mut().enumerate() {
        *pull = rows.pull(i, out).unwrap_or(PullState::NONE);
    }
    for i in 0..pulls.len() {
        rows.joint(i, &pulls, out);
        rows.motor(i, &pulls, out);
        rows.tension(i, &pulls, out);
    }
    out.pulls = pulls;
}

impl Rows<'_> {
    fn axis(&self, i: usize) -> Option<&Measured> {
        self.measured.get(i)?.as_ref()
    }

    /// Parameters of an axis, with the changes up to the block's time in them.
    fn state(&self, i: usize, out: &Equations) -> Option<JointRow> {
        let x = self.common.x;
        let mut own = *x.get(self.model.layout.own(i))?.first_chunk()?;
        own[P::Offset as usize] = out.sum(x, ChangeKind::Offset(i), 0);
        own[P::Compliance as usize] = out.sum(x, ChangeKind::Compliance(i), 0);
        Some(own)
    }

    /// Error of a moment arm at a joint other than the axis' own, relative.
    fn arm_error(&self, crossing: usize) -> f64 {
        let place = self.model.layout.arm_start() + crossing;
        self.common.x.get(place).copied().unwrap_or(0.0)
    }

    /// Crossings of a tendon: their numbers and joints.
    fn crossings(&self, i: usize) -> impl Iterator<Item = (usize, usize)> {
        let all = self.routes.crossings().iter().enumerate();
        all.filter(move |(_, (tendon, _))| *tendon == i)
            .map(|(k, (_, joint))| (k, *joint))
    }

    /// Returns the entries of the encoder error of a joint.
    fn waves(&self, j: usize) -> &[f64] {
        let own = self.block.encoder.get(j * ENCODER..(j + 1) * ENCODER);
        own.unwrap_or_default()
    }

    fn turned(&self, j: usize) -> f64 {
        self.block.turned.get(j).copied().unwrap_or(0.0)
    }

    /// Joints with an equation of their own that a tendon crosses, with its moment arms.
    fn joints_of(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let arms = self.routes.moment_arms(i).iter().copied().enumerate();
        arms.filter(|(j, arm)| *arm != 0.0 && self.routes.pulled(*j).is_some())
    }

    /// Tension of the tendon on an axis.
    fn pull(&self, i: usize, out: &Equations) -> Option<PullState> {
        /// Resolution of an encoder of 16 bits, rad: no extension is steadier.
        const RESOLUTION_RAD: f64 = 0.1e-3;
        let pull = self.routes.pull(i)?;
        let (joint, is) = (self.model.joints.get(i)?.as_ref()?, self.axis(i)?);
        let own = self.state(i, out)?;
        // The encoders of all joints that it crosses are added below.
        let is = Measured {
            encoder: [0.0; ENCODER],
            ..*is
        };
        let point = Point {
            x: &own,
            joint,
            measured: &is,
            temperature_difference_k: self.common.warmer,
        };
        let mut others_rad = 0.0;
        for (j, arm) in self.joints_of(i) {
            let amplitudes = self.common.x.get(self.model.layout.own(j));
            let amplitudes = amplitudes.and_then(|own| own.get(P::Encoder as usize..));
            let waves = amplitudes.unwrap_or_default().iter().zip(self.waves(j));
            others_rad += arm * waves.map(|(x, wave)| x * wave).sum::<f64>();
        }
        for (crossing, j) in self.crossings(i) {
            let arm = self.routes.moment_arm(i, j);
            others_rad += self.arm_error(crossing) * arm * self.turned(j);
        }
        let mut derivatives = [0.0; PER_JOINT];
        let soft = total(1.0, &mut derivatives, |sum| {
            AllEffects::compliance(&point, sum)
        });
        let inelastic = total(others_rad, &mut derivatives, |sum| {
            AllEffects::deflection(&point, 0.0, sum);
        });
        let cubic = total(0.0, &mut derivatives, |sum| {
            AllEffects::stiffening(&point, sum)
        });
        let (y, y2, y3) = (is.y, is.y_square, is.y_cube);
        let square = y2 - inelastic * (2.0 * y - inelastic);
        let cube = y3 - inelastic * (3.0 * y2 - inelastic * (3.0 * y - inelastic));
        let stiffness = joint.stiffness_nm_per_rad / soft;
        let elastic = y - inelastic + cubic * cube;
        let mean = pull.pretension_nm + stiffness * elastic;
        let (f, taut) = match pull.kind {
            TendonKind::Loop => (mean, 1.0),
            TendonKind::Strand => {
                let varies_rad2 = (y2 - y * y).max(0.0) + RESOLUTION_RAD * RESOLUTION_RAD;
                cut_off(mean, stiffness.abs() * libm::sqrt(varies_rad2))
            }
        };
        let slope = taut * stiffness * (1.0 + 3.0 * cubic * square);
        let factors = Factors {
            compliance: -taut * stiffness * elastic / soft,
            deflection: -slope,
            stiffening: taut * stiffness * cube,
            ..Factors::default()
        };
        Some(PullState {
            f,
            slope,
            y,
            row: factors.row(&derivatives),
        })
    }

    /// Adds `factor` times how the tension of a tendon moves with the state to a row over axes and moment arms.
    fn add_pull(&self, i: usize, pull: &PullState, factor: f64, row: &mut [f64]) {
        let layout = self.model.layout;
        let mut add = |place: usize, x: f64| {
            if let Some(to) = row.get_mut(place) {
                *to += factor * x;
            }
        };
        for (place, x) in layout.own(i).zip(&pull.row) {
            add(place, *x);
        }
        for (j, arm) in self.joints_of(i) {
            let first = layout.place(j, P::Encoder);
            for (k, wave) in self.waves(j).iter().enumerate() {
                add(first + k, -pull.slope * arm * wave);
            }
        }
        for (crossing, j) in self.crossings(i) {
            let arm = self.routes.moment_arm(i, j);
            add(
                layout.arm_start() + crossing,
                -pull.slope * arm * self.turned(j),
            );
        }
    }

    /// Moves the entries of an axis from a row over all axes to a row of its own.
    fn take_own(&self, i: usize, row: &mut [f64]) -> JointRow {
        let mut own = [0.0; PER_JOINT];
        let from = row.get_mut(self.model.layout.own(i)).unwrap_or_default();
        for (to, from) in own.iter_mut().zip(from) {
            *to = core::mem::take(from);
        }
        own
    }

    /// The equation of a joint.
    fn joint(&self, j: usize, pulls: &[PullState], out: &mut Equations) -> Option<()> {
        let (pulled, is) = (self.routes.pulled(j)?, self.axis(j)?);
        let joint = crate::offset::joint_prior::JointPrior {
            stiffness_nm_per_rad: pulled.stiffness_nm_per_rad,
            ..*self.model.joints.get(j)?.as_ref()?
        };
        let own = self.state(j, out)?;
        let point = Point {
            x: &own,
            joint: &joint,
            measured: is,
            temperature_difference_k: self.common.warmer,
        };
        let phi = self.model.phi(self.block, j)?;
        let layout = self.model.layout;
        // Torque of bodies, load, force and friction.
        let bodies = self.common.x.get(layout.carried()).unwrap_or_default();
        let (load_nm, load) = is.load.torque(&self.common.payload);
        let mut tau = is.tau + dot(phi, bodies.get(..phi.len()).unwrap_or_default()) + load_nm;
        let mut force_slope: Option<[f64; FORCE]> = None;
        if let Some((applied, torques)) = &self.common.force
            && let Some(torque) = torques.get(j)
        {
            let (torque, slope) = torque.torque(applied);
            tau += torque;
            force_slope = Some(slope);
        }
        let mut derivatives = [0.0; PER_JOINT];
        tau += total(0.0, &mut derivatives, |sum| {
            AllEffects::joint_torque(&point, sum);
        });
        let unknown_nm = AllEffects::unknown_torque(&point);
        let per_torque = 1.0 / pulled.stiffness_nm_per_rad;
        let rows = self.common.is_rows();
        if rows {
            out.carry(j, phi, &load, force_slope.as_ref());
        }
        // Torque that the tendons pull with.
        let mut row = core::mem::take(&mut out.row);
        row.fill(0.0);
        let mut pull_nm = 0.0;
        for (i, pull) in pulls.iter().enumerate() {
            let nominal = self.routes.moment_arm(i, j);
            if self.routes.pull(i).is_none() || nominal == 0.0 {
                continue;
            }
            let mut crossings = self.crossings(i);
            let crossing = crossings.find(|(_, joint)| *joint == j).map(|(k, _)| k);
            let right = 1.0 + crossing.map_or(0.0, |k| self.arm_error(k));
            let mut varying = self.routes.varying().iter();
            let number = varying.position(|(tendon, joint, _)| (*tendon, *joint) == (i, j));
            let of = |column: &[f64], v: usize| column.get(v).copied().unwrap_or(f64::NAN);
            let (arm, torque) = match number {
                None => (nominal, nominal * pull.f),
                Some(v) => {
                    let arm = of(&self.block.arm, v);
                    // LP[R f] from LP[R] and LP[R y], for the tension is linear in y.
                    let together = of(&self.block.arm_y, v) - arm * pull.y;
                    (arm, arm * pull.f + pull.slope * together)
                }
            };
            pull_nm += right * torque;
            if rows {
                self.add_pull(i, pull, -per_torque * right * arm, &mut row);
                if let Some(to) = crossing.and_then(|k| row.get_mut(layout.arm_start() + k)) {
                    *to -= per_torque * torque;
                }
            }
        }
        if let Some(spring) = pulled.spring {
            let number = self.routes.sprung().iter().position(|joint| *joint == j);
            let place = layout.spring_start() + 2 * number.unwrap_or_default();
            let errors = self.common.x.get(place..place + 2).unwrap_or_default();
            let (stiffer, moved) = match errors {
                [stiffer, moved] => (*stiffer, *moved),
                _ => (0.0, 0.0),
            };
            let bent = self.turned(j) - spring.rest_rad - moved;
            pull_nm -= spring.stiffness_nm_per_rad * (1.0 + stiffer) * bent;
            if let (true, Some([of_stiffness, of_rest])) = (rows, row.get_mut(place..place + 2)) {
                *of_stiffness += per_torque * spring.stiffness_nm_per_rad * bent;
                *of_rest -= per_torque * spring.stiffness_nm_per_rad * (1.0 + stiffer);
            }
        }
        let friction = Factors {
            joint_torque: per_torque,
            ..Factors::default()
        };
        for (place, x) in layout.own(j).zip(friction.row(&derivatives)) {
            if let Some(to) = row.get_mut(place) {
                *to += x;
            }
        }
        let own = self.take_own(j, &mut row);
        crate::offset::block::copy(out.cross_row((j, Side::Link)), &row);
        out.row = row;
        out.push(Equation {
            joint: j,
            side: Side::Link,
            own,
            torque_gain: per_torque,
            residual: per_torque * (pull_nm - tau),
            added_std: per_torque * unknown_nm,
            stationary_share: if unknown_nm > 0.0 { 1.0 } else { 0.0 },
        });
        Some(())
    }

    /// The equation of the motor of an axis, at the first axis with that motor.
    fn motor(&self, i: usize, pulls: &[PullState], out: &mut Equations) -> Option<()> {
        let is_first = self.routes.pull(i)?.first_of_motor == i;
        let (joint, is) = (self.model.joints.get(i)?.as_ref()?, self.axis(i)?);
        let drive = is.drive.filter(|_| self.common.motor && is_first)?;
        let own = self.state(i, out)?;
        let point = Point {
            x: &own,
            joint,
            measured: is,
            temperature_difference_k: self.common.warmer,
        };
        let ratio = self.routes.drive_ratio(i);
        let same_motor = |k: &usize| {
            let pull = self.routes.pull(*k);
            pull.is_some_and(|pull| pull.first_of_motor == i)
        };
        let pulled_by = || (0..pulls.len()).filter(same_motor);
        let share = |k: usize| self.routes.drive_ratio(k) / ratio;
        let tension = pulled_by().fold(0.0, |sum, k| {
            sum + share(k) * pulls.get(k).map_or(0.0, |pull| pull.f)
        });
        let mut derivatives = [0.0; PER_JOINT];
        let torque = total(tension + drive.inertial, &mut derivatives, |sum| {
            AllEffects::drive_torque(&point, &drive, sum);
        });
        let scale = total(1.0, &mut derivatives, |sum| {
            AllEffects::motor_scale(&point, sum)
        });
        let bias = total(0.0, &mut derivatives, |sum| {
            AllEffects::motor_bias(&point, sum)
        });
        let factors = Factors {
            drive_torque: scale,
            motor_scale: torque,
            motor_bias: 1.0,
            ..Factors::default()
        };
        let mut row = core::mem::take(&mut out.row);
        row.fill(0.0);
        if self.common.is_rows() {
            for (k, pull) in pulled_by().filter_map(|k| Some((k, pulls.get(k)?))) {
                self.add_pull(k, pull, scale * share(k), &mut row);
            }
            for (place, x) in self.model.layout.own(i).zip(factors.row(&derivatives)) {
                if let Some(to) = row.get_mut(place) {
                    *to += x;
                }
            }
        }
        let own = self.take_own(i, &mut row);
        crate::offset::block::copy(out.cross_row((i, Side::Motor)), &row);
        out.row = row;
        out.push(Equation {
            joint: i,
            side: Side::Motor,
            own,
            torque_gain: 0.0,
            residual: drive.torque - scale * torque - bias,
            added_std: AllEffects::unknown_drive_torque(&point, &drive),
            stationary_share: drive.stood,
        });
        Some(())
    }

    /// The equation of the tension sensor of an axis.
    fn tension(&self, i: usize, pulls: &[PullState], out: &mut Equations) -> Option<()> {
        self.routes.pull(i)?;
        let tension_nm = self.axis(i)?.tension_nm;
        let pull = pulls.get(i).filter(|_| tension_nm.is_finite())?;
        let place = self.model.layout.sensor_start() + 2 * i;
        let errors = self.common.x.get(place..place + 2).unwrap_or_default();
        let [gain, zero] = errors else { return None };
        let mut row = core::mem::take(&mut out.row);
        row.fill(0.0);
        if self.common.is_rows() {
            self.add_pull(i, pull, 1.0 + gain, &mut row);
            if let Some([of_gain, of_zero]) = row.get_mut(place..place + 2) {
                (*of_gain, *of_zero) = (pull.f, 1.0);
            }
        }
        let own = self.take_own(i, &mut row);
        crate::offset::block::copy(out.cross_row((i, Side::Tension)), &row);
        out.row = row;
        out.push(Equation {
            joint: i,
            side: Side::Tension,
            own,
            torque_gain: 0.0,
            residual: tension_nm - (1.0 + gain) * pull.f - zero,
            added_std: 0.0,
            stationary_share: 0.0,
        });
        Some(())
    }
}

/// Mean of a normal distribution cut off at zero, `E[max(0, N(mean, std²))]`, and its derivative by the mean.
///
/// # Source
/// C. E. Clark, *The greatest of a finite set of random variables*, Operations Research 9 (1961).
fn cut_off(mean: f64, std: f64) -> (f64, f64) {
    /// Number of standard deviations beyond which the truncated part is below rounding.
    const MAX_SIGMA: f64 = 9.0;
    let u = mean / std;
    if u > MAX_SIGMA {
        return (mean, 1.0);
    }
    if u < -MAX_SIGMA {
        return (0.0, 0.0);
    }
    let above = 0.5 * libm::erfc(-u * core::f64::consts::FRAC_1_SQRT_2);
    let density = libm::exp(-0.5 * u * u) / libm::sqrt(core::f64::consts::TAU);
    (mean * above + std * density, above)
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
    use crate::routing::{Pull, PulledJoint, Routing};
    use crate::tendons::{JointSpring, MomentArm, ShorteningTable};
    use crate::tolerances::Tolerances;
    use crate::transmission::{Friction, Transmission};
    use alloc::vec::Vec;

    const FRICTION: Friction = Friction {
        coulomb_nm: 0.1,
        viscous_nm_s_per_rad: 0.05,
    };

    fn tendon(
        name: &str,
        motor: &str,
        kind: TendonKind,
        arms: &[(usize, MomentArm)],
    ) -> Option<Transmission> {
        let mut moment_arms = alloc::vec![0.0; 2];
        for (joint, arm) in arms {
            moment_arms[*joint] = arm.evaluate(0.0)[1];
        }
        let spring = |joint: usize| {
            let spring = JointSpring {
                stiffness_nm_per_rad: 3.0,
                rest_rad: -0.4,
            };
            (joint == 1).then_some(spring)
        };
        let joints = arms.iter().map(|(joint, arm)| PulledJoint {
            joint: *joint,
            arm: arm.clone(),
            friction: FRICTION,
            spring: spring(*joint),
        });
        Some(Transmission {
            motor_inertia_kg_m2: Some(0.05),
            joint_friction: FRICTION,
            motor_friction: FRICTION,
            routing: Some(Routing {
                tendon: name.into(),
                joint: arms[0].0,
                motor: motor.into(),
                drive_ratio: if name == "c" { 1.5 } else { 0.8 },
                moment_arms,
                torque_shares: Vec::new(),
                pull: Some(Pull {
                    kind,
                    pretension_nm: if kind == TendonKind::Strand {
                        60.0
                    } else {
                        0.0
                    },
                    metres_per_rad: Some(0.02),
                    joints: joints.collect(),
                }),
            }),
            ..Transmission::spring(40.0)
        })
    }

    /// Two joints, two strands and a loop that share two motors; the second strand's arm varies at the second joint, which has a spring.
    fn model() -> EstimationModel {
        let q = [-1.0, -0.3, 0.4, 1.0];
        let varying = ShorteningTable::new(&q, &q.map(|q: f64| -0.9 * q + 0.1 * q * q)).unwrap();
        let constant = MomentArm::Constant;
        let transmissions = [
            tendon(
                "a",
                "first",
                TendonKind::Strand,
                &[(0, constant(1.0)), (1, constant(0.4))],
            ),
            tendon(
                "b",
                "second",
                TendonKind::Strand,
                &[(0, constant(-0.7)), (1, MomentArm::Table(varying))],
            ),
            tendon("c", "first", TendonKind::Loop, &[(1, constant(1.0))]),
        ];
        let tolerances = Tolerances::default();
        let prior = Prior::new(&tables(2), &transmissions, 1, [0.0; 3], tolerances);
        EstimationModel::new(prior, &FeatureConfig::default())
    }

    fn block(model: &EstimationModel, seed: &mut u64) -> Block {
        let layout = model.reduced.layout;
        let mut block = Block::zero(layout.joints, layout.bodies);
        block.tension_nm = alloc::vec![0.0; layout.joints];
        block.arm = alloc::vec![0.0];
        block.arm_y = alloc::vec![0.0];
        let all = block.sums().into_iter().flatten();
        all.for_each(|x| *x = random(seed));
        for (square, y) in block.y_square.iter_mut().zip(&block.y) {
            *square = y * y + 1e-6;
        }
        // The arm does not vary together with the extension.
        block.arm_y[0] = block.arm[0] * block.y[1];
        block.temperature_c = 26.0;
        block
    }

    fn linearised(model: &EstimationModel, block: &Block, x: &[f64]) -> Equations {
        let reduced = &model.reduced;
        let how = Linearisation {
            reference_c: 20.0,
            changes: &[],
            motor: true,
            force: None,
            content: Content::Rows,
        };
        let mut out = Equations::new(reduced.layout, &[]);
        let measured = (0..reduced.layout.joints).map(|i| Measured::of(reduced, block, i));
        linearise(reduced, block, measured, &how, x, &mut out);
        out
    }

    /// Rows against differences of what is expected, of every parameter: two joints, two motors, three sensors.
    #[test]
    fn rows_are_derivatives_of_what_is_expected() {
        let model = model();
        let layout = model.reduced.layout;
        let mut seed = 8;
        let block = block(&model, &mut seed);
        let mut x: Vec<f64> = (0..layout.dimension())
            .map(|_| 0.1 * random(&mut seed))
            .collect();
        // Derivatives of one effect by a parameter of another are neglected.
        for axis in 0..layout.joints {
            for none in [P::InitialFriction, P::Slack, P::Viscoelastic] {
                x[layout.place(axis, none)] = 0.0;
            }
        }
        x[layout.payload_place()..].fill(0.0);
        let at = linearised(&model, &block, &x);
        let sides: Vec<(usize, Side)> = at.list.iter().map(|e| (e.joint, e.side)).collect();
        let expected = [
            (0, Side::Link),
            (0, Side::Motor),
            (0, Side::Tension),
            (1, Side::Link),
            (1, Side::Motor),
            (1, Side::Tension),
            (2, Side::Tension),
        ];
        assert_eq!(sides, expected);
        let mut moved_by = alloc::vec![0; at.list.len()];
        for place in 0..layout.payload_place() {
            let slopes = slopes(&at, &x, place, |x| linearised(&model, &block, x));
            for (k, (e, [slope, row])) in at.list.iter().zip(slopes).enumerate() {
                assert!(
                    (slope - row).abs() < 1e-6 * (1.0 + row.abs()),
                    "{place} of {:?} {}: {slope} {row}",
                    e.side,
                    e.joint
                );
                moved_by[k] += usize::from(row.abs() > 1e-6);
            }
        }
        // Every equation moves with parameters of several axes.
        assert!(moved_by.iter().all(|count| *count > 10), "{moved_by:?}");
        // An offset of the loop moves the equation of the joint it crosses, of its motor and of its own sensor.
        let offset = ChangeKind::Offset(2);
        let moves = at.list.iter().filter(|e| at.moves_with(e, offset));
        let moves: Vec<(usize, Side)> = moves.map(|e| (e.joint, e.side)).collect();
        assert_eq!(
            moves,
            [(0, Side::Motor), (1, Side::Link), (2, Side::Tension)]
        );
    }

    /// Torque of the tendons, from their tensions by hand.
    #[test]
    fn equations_are_those_of_the_tensions() {
        let model = model();
        let layout = model.reduced.layout;
        let mut seed = 3;
        let mut block = block(&model, &mut seed);
        block.phi.fill(0.0);
        let x = alloc::vec![0.0; layout.dimension()];
        block.y = alloc::vec![0.2, -0.3, 0.1];
        block.arm_y[0] = block.arm[0] * block.y[1];
        for i in 0..3 {
            (block.y_square[i], block.y_cube[i]) = (block.y[i].powi(2), block.y[i].powi(3));
        }
        let [a, b, c] = [60.0 + 40.0 * 0.2, 60.0 - 40.0 * 0.3, 40.0 * 0.1];
        let arm = block.arm[0];
        let spring = 3.0 * (block.turned[1] + 0.4);
        let torque = [a - 0.7 * b, 0.4 * a + arm * b + c - spring];
        let stiffness = [40.0 * (1.0 + 0.49), 40.0 * (0.16 + 0.81 + 1.0)];
        let list = linearised(&model, &block, &x).list;
        let of = |joint: usize, side: Side| {
            let mut found = list.iter().filter(|e| (e.joint, e.side) == (joint, side));
            found.next().unwrap().residual
        };
        for j in 0..2 {
            let expected = torque[j] / stiffness[j];
            let is = of(j, Side::Link);
            assert!((is - expected).abs() < 1e-9, "{j}: {is} {expected}");
        }
        for (i, f) in [a, b, c].into_iter().enumerate() {
            let is = block.tension_nm[i] - of(i, Side::Tension);
            assert!((is - f).abs() < 1e-9, "{i}: {is} {f}");
        }
        let inertial = 0.05 * block.motor_acceleration[0];
        let of_motor = block.motor_torque[0] - of(0, Side::Motor) - inertial;
        assert!((of_motor - (a + 1.5 / 0.8 * c)).abs() < 1e-9, "{of_motor}");
    }

    #[test]
    fn slack_strand_has_no_force_and_no_slope() {
        let model = model();
        let layout = model.reduced.layout;
        let mut seed = 5;
        let mut block = block(&model, &mut seed);
        (block.y[0], block.y_square[0]) = (-2.0, 4.0);
        let x = alloc::vec![0.0; layout.dimension()];
        let at = linearised(&model, &block, &x);
        let offset = ChangeKind::Offset(0);
        assert!(at.list.iter().all(|e| !at.moves_with(e, offset)));
    }

    /// Compared with the mean over a grid of the normal distribution.
    #[test]
    fn truncated_normal_mean_matches_grid() {
        for (mean, std) in [(0.3, 1.0), (-0.8, 0.5), (4.0, 1.5), (-20.0, 1.0)] {
            let average = |mean: f64| {
                let steps = (-8000..=8000).map(|k| f64::from(k) * 1e-3);
                steps.fold([0.0; 2], |[sum, weights], u| {
                    let weight = libm::exp(-0.5 * u * u);
                    let x: f64 = mean + std * u;
                    [sum + weight * x.max(0.0), weights + weight]
                })
            };
            let of = |mean| {
                let [sum, weights] = average(mean);
                sum / weights
            };
            let (f, slope) = cut_off(mean, std);
            assert!((f - of(mean)).abs() < 1e-6, "{mean}: {f} {}", of(mean));
            let difference = (of(mean + 1e-3) - of(mean - 1e-3)) / 2e-3;
            assert!((slope - difference).abs() < 1e-4, "{slope} {difference}");
        }
    }
}
