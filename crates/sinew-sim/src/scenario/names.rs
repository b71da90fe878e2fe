//! Joints, tendons, motors and links named in a scenario.

use super::*;

/// Owner of a named value. On a robot without multi-joint tendons, all three have the name of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// Joint, with the body that it carries and its encoder.
    Joint,
    /// Tendon with the given name.
    Tendon,
    /// Motor, with its encoder.
    Motor,
}

impl PerJoint {
    fn named(&self) -> impl Iterator<Item = (&str, u64)> {
        self.by_joint
            .iter()
            .map(|(name, line, _)| (name.as_str(), *line))
    }
}

impl FrictionSpec {
    fn all(&self) -> [&PerJoint; 4] {
        [
            &self.coulomb_nm,
            &self.torque_fraction,
            &self.viscous_nm_s_per_rad,
            &self.presliding_rad,
        ]
    }
}

impl TorqueChannel {
    fn all(&self) -> [&PerJoint; 3] {
        [&self.scale_error, &self.offset_nm, &self.ripple_nm]
    }
}

impl Scenario {
    /// Every owner of a value by name, with its line; those of offsets are not among them.
    pub fn owners_named(&self) -> Vec<(Owner, &str, u64)> {
        let t = &self.truth;
        let mut of_joints: Vec<&PerJoint> = vec![
            &t.mass_factor,
            &t.com_factor,
            &t.com_across_fraction,
            &t.inertia_factor,
            &self.encoder.once_per_turn_rad,
            &self.encoder.twice_per_turn_rad,
            &self.contact_detection.noise_nm,
        ];
        of_joints.extend(self.joint_friction.all());
        of_joints.extend(self.torque_sensor.all());
        let mut of_tendons: Vec<&PerJoint> = vec![
            &t.stiffness_factor,
            &t.stiffness_later_factor,
            &t.pretension_factor,
            &t.spring_cubic_per_rad2,
            &t.viscoelastic_fraction,
            &t.viscoelastic_time_s,
            &self.tension_sensor.scale_error,
            &self.tension_sensor.offset_n,
            &self.temperature.stiffness_per_k,
            &self.temperature.zero_drift_rad_per_k,
        ];
        of_tendons.extend(self.correction.all());
        let mut of_motors: Vec<&PerJoint> = vec![
            &self.controller.stiffness_nm_per_rad,
            &self.controller.damping_nm_s_per_rad,
            &t.motor_inertia_factor,
            &self.encoder.motor_scale_error,
        ];
        of_motors.extend(self.motor_friction.all());
        of_motors.extend(self.motor_torque.all());
        let mut names: Vec<(Owner, &str, u64)> = Vec::new();
        match &self.motion {
            Motion::Hold { pose_rad } => of_joints.push(pose_rad),
            Motion::Waypoints {
                start_rad,
                waypoints,
                ..
            } => {
                of_joints.push(start_rad);
                of_joints.extend(waypoints.iter().map(|w| &w.pose_rad));
            }
            Motion::Random { range_rad, .. } => of_joints.push(range_rad),
            Motion::Staircase {
                joint,
                line,
                pose_rad,
                ..
            } => {
                of_joints.push(pose_rad);
                names.push((Owner::Joint, joint, *line));
            }
        }
        for (owner, of) in [
            (Owner::Joint, of_joints),
            (Owner::Tendon, of_tendons),
            (Owner::Motor, of_motors),
        ] {
            let named = of.into_iter().flat_map(PerJoint::named);
            names.extend(named.map(|(name, line)| (owner, name, line)));
        }
        let jams = self.jams.iter().map(|j| (j.joint.as_str(), j.line));
        let stops = self.stops.iter().map(|s| (s.joint.as_str(), s.line));
        let joints = jams.chain(stops);
        names.extend(joints.map(|(name, line)| (Owner::Joint, name, line)));
        names
    }

    /// Every link named, with its line.
    pub fn links_named(&self) -> Vec<(&str, u64)> {
        let payloads = self.payloads.iter().map(|p| (p.link.as_str(), p.line));
        let contacts = self.contacts.iter().map(|c| (c.link.as_str(), c.line));
        let random = self
            .random_contacts
            .iter()
            .map(|c| (c.link.as_str(), c.line));
        payloads.chain(contacts).chain(random).collect()
    }
}
