//! The paper's routings (A) to (D) and its programmes of changing force (E) and (F), as we read its words.
//!
//! Stated in the paper: a carriage pulled with 200 N; about 100 mm of rope unrolled sinusoidally for 240 min, each
//! routing twice; (A) no guiding pulley; (B) three with a small wrap each, spaced wider than the stroke; (C) the same
//! three, one of them wrapped by more than 180°; (D) three so close that the same portion passes each; (E) and (F) 200
//! and 120 N, changed after 80 min.
//!
//! Its drawing (Fig. 3) was not available: wraps, positions, radius, friction and whether one strand is guided or both
//! are assumed. [`Geometry::AS_READ`] is the middle of the ranges, [`Geometry::drawn`] draws from them.
//! A bench file ([`Bench::parse`]) replaces them.

use super::{Bench, Phase, Strand};
use crate::law::routing::Pulley;
use rand::{Rng, RngExt as _};

/// Length of each strand, m: room for three pulleys further apart than the stroke.
pub const STRAND_M: f64 = 0.600;
/// Rope unrolled, m (the paper: about 100 mm).
pub const STROKE_M: f64 = 0.100;
/// Time of one sinusoid, s.
pub const PERIOD_S: f64 = 10.0;
/// Radius of the guiding pulleys, m.
pub const RADIUS_M: f64 = 0.008;
/// Force on the carriage, N.
pub const FORCE_N: f64 = 200.0;
/// Range of the small wrap angles of (B), degrees.
pub const SMALL_WRAP_DEG: [f64; 2] = [10.0, 30.0];
/// Range of the wrap angles of the two other pulleys of (C), degrees.
pub const SIDE_WRAP_DEG: [f64; 2] = [60.0, 90.0];
/// Range of the wrap angle of more than 180° of (C), degrees.
pub const LARGE_WRAP_DEG: [f64; 2] = [200.0, 230.0];
/// Range of the wrap angles of the close pulleys of (D), degrees.
pub const CLOSE_WRAP_DEG: [f64; 2] = [60.0, 120.0];
/// Range of the friction of rope on guide, log-uniform: from a pulley on a good bearing to a fixed pin.
pub const FRICTION: [f64; 2] = [0.02, 0.2];
/// Range of [`Bench::joint_friction`].
pub const JOINT_FRICTION: [f64; 2] = [0.0, 0.04];
/// Distances of the pulleys of (B), (C) and (D) from the drive, m.
pub const AT_M: [[f64; 3]; 3] = [
    [0.160, 0.300, 0.440],
    [0.140, 0.280, 0.440],
    [0.280, 0.300, 0.320],
];

/// Names of the paper's cases.
pub const NAMES: [&str; 6] = ["A", "B", "C", "D", "E", "F"];

/// Wraps, friction and strands of the guiding pulleys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// Wrap angles of (B), (C) and (D), from the drive on, degrees.
    pub wraps_deg: [[f64; 3]; 3],
    /// Whether both strands are guided; otherwise the first one alone.
    pub is_on_both_strands: bool,
    /// Friction of the guiding pulleys; `None`: that of the rope.
    pub friction: Option<f64>,
    /// Friction of the joint's bearing, see [`Bench::joint_friction`].
    pub joint_friction: f64,
}

impl Geometry {
    /// Middle of the ranges, on both strands, with the friction of the rope.
    pub const AS_READ: Self = Self {
        wraps_deg: [[20.0; 3], [75.0, 215.0, 75.0], [90.0; 3]],
        is_on_both_strands: true,
        friction: None,
        joint_friction: 0.0,
    };

    /// Draws a geometry from the ranges; each of the three pulleys of (C) is as likely the one with the large wrap.
    pub fn drawn(rng: &mut impl Rng) -> Self {
        let large = rng.random_range(0..3);
        let mut within = |[low, high]: [f64; 2]| rng.random_range(low..high);
        let mut three = |range| [0; 3].map(|_| within(range));
        let (small, mut side, close) = (
            three(SMALL_WRAP_DEG),
            three(SIDE_WRAP_DEG),
            three(CLOSE_WRAP_DEG),
        );
        for (i, wrap_deg) in side.iter_mut().enumerate() {
            if i == large {
                *wrap_deg = within(LARGE_WRAP_DEG);
            }
        }
        Self {
            wraps_deg: [small, side, close],
            friction: Some(within(FRICTION.map(f64::ln)).exp()),
            joint_friction: within(JOINT_FRICTION),
            is_on_both_strands: rng.random(),
        }
    }

    /// One of the cases of the paper by name, in upper or lower case.
    #[must_use]
    pub fn bench(&self, name: &str) -> Option<Bench> {
        let name = name.to_uppercase();
        let routing = match name.as_str() {
            "A" | "E" | "F" => None,
            "B" => Some(0),
            "C" => Some(1),
            "D" => Some(2),
            _ => return None,
        };
        let pulley = |(at_m, wrap_deg): (f64, f64)| Pulley {
            at_m,
            radius_m: RADIUS_M,
            wrap_rad: wrap_deg.to_radians(),
            friction: self.friction,
        };
        let guided = Strand {
            pulleys: routing.map_or_else(Vec::new, |i| {
                let places = AT_M[i].into_iter();
                places.zip(self.wraps_deg[i]).map(pulley).collect()
            }),
        };
        let phase = |force_n: f64, minutes: f64| Phase {
            force_n,
            temperature_c: 23.0,
            duration_s: 60.0 * minutes,
            moving: true,
        };
        let phases = match name.as_str() {
            "E" => vec![phase(FORCE_N, 80.0), phase(120.0, 80.0)],
            "F" => vec![phase(120.0, 80.0), phase(FORCE_N, 80.0)],
            _ => vec![phase(FORCE_N, 240.0)],
        };
        let other = match self.is_on_both_strands {
            true => guided.clone(),
            false => Strand::default(),
        };
        Some(Bench {
            name,
            strand_m: STRAND_M,
            stroke_m: STROKE_M,
            period_s: PERIOD_S,
            strands: [guided, other],
            joint_friction: self.joint_friction,
            phases,
        })
    }
}

/// One of the cases of the paper by name, with the geometry [`Geometry::AS_READ`].
pub fn paper(name: &str) -> Option<Bench> {
    Geometry::AS_READ.bench(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::routing::portions;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    /// Lengths of a guided strand by twice the passes: none, half, one, … three, mm.
    fn passed_mm(bench: &Bench) -> [f64; 7] {
        bench.check("bench").expect("it fits");
        let mut out = [0.0; 7];
        for p in portions(STRAND_M, STROKE_M, &bench.strands[0].pulleys).expect("it fits") {
            out[(2.0 * p.passes) as usize] += 1e3 * p.length_m;
        }
        out
    }

    /// Every geometry of the ranges is one that the paper describes: in (B) and (C) no portion passes two pulleys, in
    /// (D) the same portion passes all three.
    #[test]
    fn routings_match_paper_description() {
        assert!(paper("G").is_none());
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for k in 0..200 {
            let geometry = match k {
                0 => Geometry::AS_READ,
                _ => Geometry::drawn(&mut rng),
            };
            let of = |name: &str| passed_mm(&geometry.bench(name).expect("a case"));
            let straight = of("A");
            assert!((straight[0] - 600.0).abs() < 1e-9, "{straight:?}");
            for (name, i) in [("B", 0), ("C", 1)] {
                let (mm, wraps) = (of(name), geometry.wraps_deg[i]);
                let contact: f64 = wraps.iter().map(|w| 8.0 * w.to_radians()).sum();
                // Both lines: the stroke less the contact; one line: the contact at either end.
                assert!((mm[2] - (300.0 - contact)).abs() < 1e-9, "{name} {mm:?}");
                assert!((mm[1] - 2.0 * contact).abs() < 1e-9, "{name} {mm:?}");
                assert!(mm[3..].iter().all(|l| *l == 0.0), "{name} {mm:?}");
            }
            let (mm, wraps) = (of("D"), geometry.wraps_deg[2]);
            // The six lines lie within 40 mm and the last contact.
            let spread = 40.0 + 8.0 * wraps[2].to_radians();
            assert!((mm[6] - (100.0 - spread)).abs() < 1e-9, "{mm:?}");
            assert!((43.0..52.0).contains(&mm[6]), "{mm:?}");
            let large = geometry.wraps_deg[1].iter().filter(|w| **w > 180.0);
            assert_eq!(large.count(), 1);
        }
    }
}
