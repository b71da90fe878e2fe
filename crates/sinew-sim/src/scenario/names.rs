//! Which joints and links a scenario speaks of.

use super::*;

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
    /// Every joint named, with its line; offsets name tendons.
    pub fn joints_named(&self) -> Vec<(&str, u64)> {
        let t = &self.truth;
        let mut of: Vec<&PerJoint> = vec![
            &self.controller.stiffness_nm_per_rad,
            &self.controller.damping_nm_s_per_rad,
            &t.stiffness_factor,
            &t.stiffness_later_factor,
            &t.mass_factor,
            &t.com_factor,
            &t.com_across_fraction,
            &t.inertia_factor,
            &t.motor_inertia_factor,
            &t.spring_cubic_per_rad2,
            &t.viscoelastic_fraction,
            &t.viscoelastic_time_s,
            &self.encoder.once_per_turn_rad,
            &self.encoder.twice_per_turn_rad,
            &self.encoder.motor_scale_error,
            &self.temperature.stiffness_per_k,
            &self.temperature.zero_drift_rad_per_k,
        ];
        of.extend(self.joint_friction.all());
        of.extend(self.motor_friction.all());
        of.extend(self.motor_torque.all());
        of.extend(self.torque_sensor.all());
        of.extend(self.correction.all());
        of.push(&self.contact_detection.noise_nm);
        let mut names: Vec<(&str, u64)> = Vec::new();
        match &self.motion {
            Motion::Hold { pose_rad } => of.push(pose_rad),
            Motion::Waypoints {
                start_rad,
                waypoints,
                ..
            } => {
                of.push(start_rad);
                of.extend(waypoints.iter().map(|w| &w.pose_rad));
            }
            Motion::Random { range_rad, .. } => of.push(range_rad),
            Motion::Staircase {
                joint,
                line,
                pose_rad,
                ..
            } => {
                of.push(pose_rad);
                names.push((joint, *line));
            }
        }
        names.extend(of.into_iter().flat_map(PerJoint::named));
        names.extend(self.jams.iter().map(|j| (j.joint.as_str(), j.line)));
        names.extend(self.stops.iter().map(|s| (s.joint.as_str(), s.line)));
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
