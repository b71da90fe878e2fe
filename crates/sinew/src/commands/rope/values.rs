//! Parser of guiding pulleys.

use crate::args::not_negative;
use crate::quantity::{Length, above_zero, at_least_zero};
use sinew_rope::predict::Guide;

/// Parses a guiding pulley, `WRAP_DEG:RADIUS_MM[:FRICTION][@AT_MM]`.
pub(super) fn guide(text: &str) -> Result<Guide, String> {
    let form = "expected WRAP_DEG:RADIUS_MM[:FRICTION][@AT_MM], e.g. 90:8 or 60:8:0.05@250";
    let (rest, at) = match text.split_once('@') {
        Some((rest, at)) => (rest, Some(at)),
        None => (text, None),
    };
    let parts: Vec<&str> = rest.split(':').collect();
    let (wrap, radius, friction) = match parts[..] {
        [wrap, radius] => (wrap, radius, None),
        [wrap, radius, friction] => (wrap, radius, Some(friction)),
        _ => return Err(form.into()),
    };
    Ok(Guide {
        wrap_rad: not_negative("°")(wrap)?.to_radians(),
        radius_m: above_zero::<Length>(radius)?.0,
        friction: friction.map(not_negative("(friction)")).transpose()?,
        at_m: at.map(at_least_zero::<Length>).transpose()?.map(|at| at.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guide_parses_fields() {
        let g = guide("60:8:0.05@250").expect("a guide");
        assert_eq!((g.wrap_rad, g.radius_m), (60_f64.to_radians(), 0.008));
        assert_eq!((g.friction, g.at_m), (Some(0.05), Some(0.25)));
        let g = guide("180:10").expect("a guide");
        assert_eq!((g.friction, g.at_m), (None, None));
        for text in ["60", "60:0", "a:8", "60:8:1:2", "60:8@", "-5:8"] {
            assert!(guide(text).is_err(), "{text}");
        }
    }
}
