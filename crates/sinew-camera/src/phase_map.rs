//! The scale's coordinate at every pixel of the reference frame: a smooth map `s(x, y)`, in
//! graduations, of a plane (pitch and tilt), a bend and a twist (perspective) and a third power
//! along the scale (lens).

use super::robust::TERMS;

/// `s(x, y)`: graduations, whole on a dark line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PhaseMap {
    /// Where the terms have their origin, and the length they are scaled by, px.
    pub(crate) x0: f64,
    pub(crate) y0: f64,
    pub(super) half_width: f64,
    pub(super) half_height: f64,
    /// Of `1, u, v, u², uv, u³`.
    pub(super) c: [f64; TERMS],
}

impl PhaseMap {
    pub(super) fn row(&self, x: f64, y: f64) -> [f64; TERMS] {
        let (u, v) = (
            (x - self.x0) / self.half_width,
            (y - self.y0) / self.half_height,
        );
        [1.0, u, v, u * u, u * v, u * u * u]
    }

    /// Coordinate at a pixel, graduations.
    pub(crate) fn at(&self, x: f64, y: f64) -> f64 {
        self.row(x, y).iter().zip(&self.c).map(|(r, c)| r * c).sum()
    }

    /// The scaled coordinate that [`Shift::du`] goes with.
    pub(crate) fn at_u(&self, x: f64) -> f64 {
        (x - self.x0) / self.half_width
    }

    /// `(∂s/∂x, ∂s/∂y)`, graduations per pixel.
    pub(crate) fn slope(&self, x: f64, y: f64) -> (f64, f64) {
        let (u, v) = (
            (x - self.x0) / self.half_width,
            (y - self.y0) / self.half_height,
        );
        let c = &self.c;
        (
            (c[1] + 2.0 * c[3] * u + c[4] * v + 3.0 * c[5] * u * u) / self.half_width,
            (c[2] + c[4] * u) / self.half_height,
        )
    }

    /// Pixels between lines at the origin, across them.
    pub(crate) fn pitch_px(&self) -> f64 {
        let (a, b) = self.slope(self.x0, self.y0);
        1.0 / a.hypot(b)
    }

    /// Angle of the scale against the rows, rad; positive when it falls to the right.
    pub(crate) fn tilt_rad(&self) -> f64 {
        let (a, b) = self.slope(self.x0, self.y0);
        b.atan2(a)
    }
}
