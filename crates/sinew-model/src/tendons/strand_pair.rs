//! Two pretensioned strands of one motor as one loop.

/// Loop of one motor and two strands on pulleys of one radius.
///
/// While both strands are taut the loop is exactly one spring that pulls both ways, `tau_el = K (theta − delta_e − q)`:
///
/// ```text
/// K = 2 k r²,   delta_e = (delta_a − delta_b)/(2 r),   |tau_el| ≤ 2 r f0',   f0' = f0 − k (delta_a + delta_b)/2
/// ```
///
/// So `r delta_e` is half of what one strand alone has grown by. An elongation that both share turns no joint: it lowers the
/// remaining pretension `f0'` and has an effect only beyond `2 r f0'`, where one strand is slack and the stiffness is
/// `K/2`.
///
/// # Source
/// Sum of the two strands of [`TendonKind::Strand`](super::TendonKind::Strand) with drums and moment arms `±r`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrandPair {
    /// Stiffness `k` of each strand, N/m.
    pub stiffness_n_per_m: f64,
    /// Radius `r` of drum and pulley, m.
    pub radius_m: f64,
    /// Pretension `f0` of each strand, N.
    pub pretension_n: f64,
}

impl StrandPair {
    /// Stiffness `K = 2 k r²` at the joint, N·m/rad.
    pub fn joint_stiffness_nm_per_rad(&self) -> f64 {
        2.0 * self.stiffness_n_per_m * self.radius_m * self.radius_m
    }

    /// Offset `delta_e`, rad, by the elongations of the strand that pulls positively and of the other one, m.
    pub fn delta_e(&self, elongation_m: [f64; 2]) -> f64 {
        (elongation_m[0] - elongation_m[1]) / (2.0 * self.radius_m)
    }

    /// Remaining pretension `f0'`, N, by the elongations of both strands, m; negative where both are slack at rest.
    pub fn remaining_pretension_n(&self, elongation_m: [f64; 2]) -> f64 {
        self.pretension_n - 0.5 * self.stiffness_n_per_m * (elongation_m[0] + elongation_m[1])
    }

    /// Largest torque `2 r f0'` at which both strands are taut, N·m; 0 where none is.
    pub fn torque_limit_nm(&self, elongation_m: [f64; 2]) -> f64 {
        2.0 * self.radius_m * self.remaining_pretension_n(elongation_m).max(0.0)
    }

    /// Half width `−f0'/(k r)` of the dead zone, rad; 0 while pretension remains.
    pub fn dead_zone_rad(&self, elongation_m: [f64; 2]) -> f64 {
        (-self.remaining_pretension_n(elongation_m)).max(0.0)
            / (self.stiffness_n_per_m * self.radius_m)
    }
}
