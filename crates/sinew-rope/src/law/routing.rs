//! Sections of a rope by the pulleys that pass over them, and its tension with friction.
//!
//! Capstan equation: over a wrap of `φ` the tension changes by `exp(±μ φ)`, against the motion of the rope. A
//! pulley touches the rope within its wrap; while the drive moves the rope by a stroke, the touched section
//! grows by it. A rope bends where it runs onto a pulley and straightens where it leaves: each of the two
//! lines counts half a pass of the rope that crosses it.

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

    /// Passes of the rope point `point_m` from the drive over the pulley within a stroke: ½ for the bend onto the
    /// pulley, ½ for the bend off it.
    ///
    /// A point that crosses both the entry and the exit line counts 1. A point that crosses one of them, or lies on
    /// the pulley, counts ½. With a stroke `S` above the contact length the sum over the rope is `S`, for any wrap.
    #[must_use]
    pub fn passes(&self, point_m: f64, stroke_m: f64) -> f64 {
        if !self.touches(point_m, stroke_m) {
            return 0.0;
        }
        let crosses_both = self.at_m + self.contact_m() - stroke_m..=self.at_m;
        if crosses_both.contains(&point_m) {
            1.0
        } else {
            0.5
        }
    }
}

/// Section of a strand that the same pulleys touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RopeSection {
    /// Length of the section, m.
    pub length_m: f64,
    /// Middle of the section, m from the drive with the drive at rest.
    pub middle_m: f64,
    /// Number of guiding pulleys that touch the section.
    pub guides: usize,
    /// Sum of [`Pulley::passes`] at the middle of the section.
    pub passes: f64,
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
    #[error(
        "guiding pulley {pulley} at {at_m} m has {contact_m:.3} m of rope on it and does not fit on a strand of {length_m} m; check its position, radius and wrap"
    )]
    Beyond {
        /// Number of the pulley, from 1.
        pulley: usize,
        /// Position of the pulley, m.
        at_m: f64,
        /// Length of rope on the pulley, m.
        contact_m: f64,
        /// Length of the strand, m.
        length_m: f64,
    },
}

/// Capstan equation: tension after a wrap, on the side to which the rope moves, `T exp(μ φ)`.
#[must_use]
pub fn capstan(tension_n: f64, friction: f64, wrap_rad: f64) -> f64 {
    tension_n * libm::exp(friction * wrap_rad)
}

/// Sum of `μ φ` over the pulleys of a strand; `friction` is the coefficient of those without their own.
#[must_use]
pub fn wrap_friction(pulleys: &[Pulley], friction: f64) -> f64 {
    let each = pulleys.iter();
    each.map(|p| p.friction.unwrap_or(friction) * p.wrap_rad)
        .sum()
}

/// Tensions at the drive of two strands over a joint pulley, N: of the strand that runs towards the drive, and of the
/// other.
///
/// `T = F/2 (1 ± tanh X/2)`, from `T₁ + T₂ = F` and `T₁/T₂ = exp X`.
///
/// * `force_n`: `F`, pull on the carriage, N. `log_ratio`: `X = Σ μφ` of both strands plus the logarithm of the tension
///   ratio that turns the joint pulley.
///
/// Holds while the rope slips on every pulley; after each reversal it sticks for the first millimetre.
#[must_use]
pub fn drive_tensions(force_n: f64, log_ratio: f64) -> [f64; 2] {
    let t = libm::tanh(0.5 * log_ratio);
    [0.5 * force_n * (1.0 + t), 0.5 * force_n * (1.0 - t)]
}

/// Work of friction in one cycle of two strokes, J: `2 S F tanh X/2`, with the symbols of [`drive_tensions`] and the
/// stroke `S`, m.
#[must_use]
pub fn friction_work_j(force_n: f64, stroke_m: f64, log_ratio: f64) -> f64 {
    2.0 * stroke_m * force_n * libm::tanh(0.5 * log_ratio)
}

/// Divides a strand of `length_m`, whose rope moves back and forth by `stroke_m` away from the drive, into
/// sections of equal [`Pulley::passes`], in order from the drive. Their lengths sum to `length_m`.
///
/// A pulley at `p` with contact `c` touches the rope points from `p − stroke` to `p + c`. Those up to `p` cross its
/// entry line, those from `p + c − stroke` its exit line.
///
/// # Errors
/// Returns [`RoutingError`] if strand, stroke or a pulley is invalid.
pub fn portions(
    length_m: f64,
    stroke_m: f64,
    pulleys: &[Pulley],
) -> Result<Vec<RopeSection>, RoutingError> {
    divided(length_m, stroke_m, pulleys, |p| {
        let to = p.at_m + p.contact_m();
        [p.at_m - stroke_m, to - stroke_m, p.at_m, to]
    })
}

/// Divides a strand as [`portions`], but only where the pulleys that touch it change.
///
/// # Errors
/// Returns [`RoutingError`] if strand, stroke or a pulley is invalid.
pub fn touched(
    length_m: f64,
    stroke_m: f64,
    pulleys: &[Pulley],
) -> Result<Vec<RopeSection>, RoutingError> {
    divided(length_m, stroke_m, pulleys, |p| {
        [p.at_m - stroke_m, p.at_m + p.contact_m()]
    })
}

fn divided<const N: usize>(
    length_m: f64,
    stroke_m: f64,
    pulleys: &[Pulley],
    lines: impl Fn(&Pulley) -> [f64; N],
) -> Result<Vec<RopeSection>, RoutingError> {
    let good = |v: f64| v >= 0.0 && v.is_finite();
    if !(good(length_m) && length_m > 0.0 && good(stroke_m)) {
        return Err(RoutingError::Strand);
    }
    let mut edges = Vec::with_capacity(2 + N * pulleys.len());
    edges.extend([0.0, length_m]);
    for (i, p) in pulleys.iter().enumerate() {
        let pulley = i + 1;
        let numbers = [p.at_m, p.radius_m, p.wrap_rad, p.friction.unwrap_or(0.0)];
        if !numbers.into_iter().all(good) {
            return Err(RoutingError::Pulley { pulley });
        }
        if p.at_m + p.contact_m() > length_m {
            return Err(RoutingError::Beyond {
                pulley,
                at_m: p.at_m,
                contact_m: p.contact_m(),
                length_m,
            });
        }
        edges.extend(lines(p).map(|at| at.max(0.0)));
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
        let passes = pulleys.iter().map(|p| p.passes(middle_m, stroke_m)).sum();
        out.push(RopeSection {
            length_m: to - from,
            middle_m,
            guides,
            passes,
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
