//! The paper's routings (A) to (D) and its programmes of changing force (E) and (F), as geometry.
//!
//! The paper draws them (Fig. 3) without all dimensions. Stated there: a carriage pulled with
//! 200 N; about 100 mm of rope unrolled sinusoidally for 240 min; (A) no guiding pulley; (B) three
//! with a small wrap each, spaced wider than the stroke; (C) one wrapped more than 180°; (D) three
//! so close that the same section passes each; (E) and (F) 200 and 120 N, changed after 80 min.
//! The constants below are assumed.

use super::{Bench, Phase, Strand};
use crate::law::routing::Pulley;

/// Length of each strand, m: room for three pulleys further apart than the stroke.
pub const STRAND_M: f64 = 0.600;
/// Rope unrolled, m (the paper: about 100 mm).
pub const STROKE_M: f64 = 0.100;
/// Time of one sinusoid, s.
pub const PERIOD_S: f64 = 10.0;
/// Radius of the guiding pulleys, m.
pub const RADIUS_M: f64 = 0.008;
/// Small wrap angle, degrees.
pub const SMALL_WRAP_DEG: f64 = 20.0;
/// Wrap angle of more than 180°, degrees.
pub const LARGE_WRAP_DEG: f64 = 200.0;
/// Distance of pulleys that are spaced wider than the stroke, m; assumed.
pub const WIDE_SPACING_M: f64 = 0.140;
/// Distance of closely spaced pulleys, m: one pulley width; assumed.
pub const CLOSE_SPACING_M: f64 = 0.020;

/// Names of the paper's cases.
pub const NAMES: [&str; 6] = ["A", "B", "C", "D", "E", "F"];

/// One of the cases of the paper by name, in upper or lower case.
pub fn paper(name: &str) -> Option<Bench> {
    let pulley = |at_m: f64, wrap_deg: f64| Pulley {
        at_m,
        radius_m: RADIUS_M,
        wrap_rad: wrap_deg.to_radians(),
        friction: None,
    };
    let three = |distance_m: f64| {
        let middle = 0.5 * STRAND_M;
        [-1.0, 0.0, 1.0].map(|i| pulley(middle + i * distance_m, SMALL_WRAP_DEG))
    };
    let name = name.to_uppercase();
    let pulleys = match name.as_str() {
        "A" | "E" | "F" => Vec::new(),
        "B" => three(WIDE_SPACING_M).to_vec(),
        "C" => vec![pulley(0.5 * STRAND_M, LARGE_WRAP_DEG)],
        "D" => three(CLOSE_SPACING_M).to_vec(),
        _ => return None,
    };
    let phase = |force_n: f64, minutes: f64| Phase {
        force_n,
        temperature_c: 23.0,
        duration_s: 60.0 * minutes,
        moving: true,
    };
    let phases = match name.as_str() {
        "E" => vec![phase(200.0, 80.0), phase(120.0, 80.0)],
        "F" => vec![phase(120.0, 80.0), phase(200.0, 80.0)],
        _ => vec![phase(200.0, 240.0)],
    };
    Some(Bench {
        name,
        strand_m: STRAND_M,
        stroke_m: STROKE_M,
        period_s: PERIOD_S,
        strands: [Strand { pulleys }, Strand::default()],
        phases,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::routing::portions;

    /// Lengths of the guided strand that 0, 1, 2 and 3 pulleys pass over, mm.
    fn passed_mm(name: &str) -> [f64; 4] {
        let bench = paper(name).expect("a case");
        bench.check(name).expect("it fits");
        let mut out = [0.0; 4];
        for p in portions(STRAND_M, STROKE_M, &bench.strands[0].pulleys).expect("it fits") {
            out[p.guides] += 1e3 * p.length_m;
        }
        out
    }

    #[test]
    fn routings_match_paper_description() {
        assert!(paper("G").is_none());
        assert_eq!(passed_mm("A"), [600.0, 0.0, 0.0, 0.0]);
        // B: no portion passes two pulleys. Each touches stroke + contact (20° of 8 mm: 2.79 mm).
        let b = passed_mm("B");
        assert!(
            (b[1] - 3.0 * 102.79).abs() < 0.01 && b[2] == 0.0 && b[3] == 0.0,
            "{b:?}"
        );
        // C: one pulley, a longer contact (200° of 8 mm: 27.93 mm).
        let c = passed_mm("C");
        assert!((c[1] - 127.93).abs() < 0.01 && c[2] == 0.0, "{c:?}");
        // D: most of what is touched passes all three.
        let d = passed_mm("D");
        assert!((d[3] - (102.79 - 40.0)).abs() < 0.01, "{d:?}");
        assert!(
            (d[1] - 40.0).abs() < 0.01 && (d[2] - 40.0).abs() < 0.01,
            "{d:?}"
        );
    }
}
