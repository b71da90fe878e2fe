//! Sections of a rope by the pulleys that pass over them, and its tension with friction.
//!
//! Capstan equation: over a wrap of `φ` the tension changes by `exp(±μ φ)`, against the motion of the rope. A
//! pulley touches the rope within its wrap; while the drive moves the rope by a stroke, the touched section
//! grows by it. Sections that several pulleys touch count all of them.

/// A guiding pulley along a strand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulley {
    /// Point of first contact with the drive at rest, m from the drive along the rope.
    pub at_m: f64,
    /// Radius of the rope's path, m.
    pub radius_m: f64,
    /// Wrap angle, rad.
    pub wrap_rad: f64,
    /// Coefficient of friction; `None`: that of the rope.
    pub friction: Option<f64>,
}

impl Pulley {
    /// Contact length of the rope on the pulley, m.
    #[must_use]
    pub fn contact_m(&self) -> f64 {
        self.radius_m * self.wrap_rad
    }

    /// Whether the rope point `point_m` from the drive touches the pulley within a stroke.
    #[must_use]
    pub fn touches(&self, point_m: f64, stroke_m: f64) -> bool {
        let from = (self.at_m - stroke_m).max(0.0);
        (from..=self.at_m + self.contact_m()).contains(&point_m)
    }
}

/// Section of a strand that the same pulleys pass over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RopeSection {
    /// Length of the section, m.
    pub length_m: f64,
    /// Middle of the section, m from the drive with the drive at rest.
    pub middle_m: f64,
    /// Number of guiding pulleys that pass over the section.
    pub guides: usize,
}

/// Error of an invalid routing.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RoutingError {
    /// A length, angle or friction that is negative, NaN or infinite, or a strand of no length.
    #[error("guiding pulley {pulley}: lengths, wrap angle and friction must be at least 0")]
    Pulley {
        /// Number of the pulley, from 1.
        pulley: usize,
    },
    /// Strand without length, or negative stroke.
    #[error("a strand needs a length above 0 and a stroke of at least 0")]
    Strand,
    /// Pulley outside the strand.
    #[error("guiding pulley {pulley} at {at_m} m does not fit on a strand of {length_m} m")]
    Beyond {
        /// Number of the pulley, from 1.
        pulley: usize,
        /// Position of the pulley, m.
        at_m: f64,
        /// Length of the strand, m.
        length_m: f64,
    },
}

/// Capstan equation: tension after a wrap, on the side to which the rope moves, `T exp(μ φ)`.
#[must_use]
pub fn capstan(tension_n: f64, friction: f64, wrap_rad: f64) -> f64 {
    tension_n * libm::exp(friction * wrap_rad)
}

/// Divides a strand of `length_m`, whose rope moves back and forth by `stroke_m` away from the drive, into
/// sections, in order from the drive. Their lengths sum to `length_m`.
///
/// A pulley at `p` with contact `c` touches the rope points from `p − stroke` to `p + c`.
///
/// # Errors
/// Returns [`RoutingError`] if strand, stroke or a pulley is invalid.
pub fn portions(
    length_m: f64,
    stroke_m: f64,
    pulleys: &[Pulley],
) -> Result<Vec<RopeSection>, RoutingError> {
    let good = |v: f64| v >= 0.0 && v.is_finite();
    if !(good(length_m) && length_m > 0.0 && good(stroke_m)) {
        return Err(RoutingError::Strand);
    }
    let mut edges = Vec::with_capacity(2 + 2 * pulleys.len());
    edges.extend([0.0, length_m]);
    for (i, p) in pulleys.iter().enumerate() {
        let pulley = i + 1;
        let numbers = [p.at_m, p.radius_m, p.wrap_rad, p.friction.unwrap_or(0.0)];
        if !numbers.into_iter().all(good) {
            return Err(RoutingError::Pulley { pulley });
        }
        let to = p.at_m + p.contact_m();
        if to > length_m {
            return Err(RoutingError::Beyond {
                pulley,
                at_m: p.at_m,
                length_m,
            });
        }
        let from = (p.at_m - stroke_m).max(0.0);
        edges.extend([from, to]);
    }
    edges.sort_unstable_by(f64::total_cmp);
    let mut out: Vec<RopeSection> = Vec::with_capacity(edges.len());
    for pair in edges.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if to <= from {
            continue;
        }
        let middle_m = 0.5 * (from + to);
        let touching = pulleys.iter().filter(|p| p.touches(middle_m, stroke_m));
        let guides = touching.count();
        out.push(RopeSection {
            length_m: to - from,
            middle_m,
            guides,
        });
    }
    Ok(out)
}

/// Ratio of the tension at a point of the rope to the tension at the drive.
///
/// * `point_m`: point of the rope, m from the drive with the drive at rest; `paid_out_m`: displacement of the
///   rope away from the drive, 0 to stroke.
/// * `towards_drive`: whether the rope runs towards the drive now. If so, the tension decreases after every pulley;
///   otherwise it increases.
/// * `friction`: of the rope, for pulleys without a value of their own.
#[must_use]
pub fn tension_share(
    pulleys: &[Pulley],
    friction: f64,
    point_m: f64,
    paid_out_m: f64,
    towards_drive: bool,
) -> f64 {
    let at = point_m + paid_out_m;
    let mut mu_phi = 0.0;
    for p in pulleys {
        // Only the part of the wrap between drive and point counts.
        let contact = p.contact_m();
        let behind = at - p.at_m;
        let share = if contact > 0.0 {
            (behind / contact).clamp(0.0, 1.0)
        } else if behind > 0.0 {
            1.0
        } else {
            0.0
        };
        mu_phi += p.friction.unwrap_or(friction) * p.wrap_rad * share;
    }
    libm::exp(if towards_drive { -mu_phi } else { mu_phi })
}

/// `exp(∓Σ μφ)` over the whole strand, as seen at its far end.
#[must_use]
pub fn far_share(pulleys: &[Pulley], friction: f64, towards_drive: bool) -> f64 {
    tension_share(pulleys, friction, f64::MAX, 0.0, towards_drive)
}
