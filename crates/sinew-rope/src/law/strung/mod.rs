//! Ropes strung in a machine and held at constant length: decay of their tension.
//!
//! ```text
//! each strand       ℓ(T) = Σ_k L_k ε_k/100 + c T           pieces of rope, series compliance
//! one strand        ℓ(T) = u                               u: its tied-off length
//! joint with two    ℓ₊(T + τ/r) + ℓ₋(T) = u₊ + u₋          motor fixed, torque τ balanced:
//!                   r δ = ℓ₊(T + τ/r) − u₊                 r (T₊ − T₋) = τ; δ is how far it sags
//! slack             T = 0 where the ropes are longer than that
//! ```
//!
//! The rope law adds its memory to this. A step solves for the final tension together with all elements (`piece`), so
//! that the delayed compliance may exceed the elastic one. The step is symmetric in time: two extrapolations over
//! halved steps yield sixth order, and the difference from fourth order determines the next step size.
//!
//! Not modelled: static friction of a rope on its guides, varying temperatures, a compliant motor.

mod piece;

pub use piece::Piece;

use super::tested_range::{AddedStrain, ModelError};
use super::{LoadError, RopeLoad, State};
use piece::Lags;

/// Relative error of the tension, and of the strain under it, in one step: the result of a year with several hundred
/// steps is accurate to 1e-6.
pub const RELAXATION_TOLERANCE: f64 = 1e-8;

/// First step, s.
const FIRST_S: f64 = 0.1;
/// Minimum step size, s; all time constants of the law are longer.
const SHORTEST_S: f64 = 1e-7;
/// Maximum number of steps; a year with every change of regime takes several hundred.
const STEPS_MAX: usize = 1_000_000;

/// Strand between its two terminations.
#[derive(Debug, Clone, PartialEq)]
pub struct Strand {
    /// Pieces of the rope, in order.
    pub pieces: Vec<Piece>,
    /// `c`: series compliance (frame, spring, mounts), m/N.
    pub series_compliance_m_per_n: f64,
    /// Tension above the lower tension of the pair, N: `τ/r` in the loaded strand.
    pub extra_n: f64,
}

/// The strands that hold one joint, at one temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct StrandAssembly {
    strands: Vec<Strand>,
    temperature_k: f64,
    /// Tension of the strand that pulls least, N.
    tension_n: f64,
    /// Tied-off length `u` of each strand, m.
    tied_m: Vec<f64>,
    /// Creep of each strand when it was tied off, m.
    tied_creep_m: Vec<f64>,
    /// Creep of each strand since then, m.
    added_m: Vec<AddedStrain>,
    /// Time since stringing, s.
    time_s: f64,
    /// Model error of the creep since the ropes were tied off.
    error: ModelError,
}

impl StrandAssembly {
    /// Strings them up: each strand is held at `tension_n` and its own extra tension for a time, and
    /// then tied off at the length it has.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn new(
        strands: Vec<Strand>,
        tension_n: f64,
        temperature_k: f64,
        duration_s: f64,
    ) -> Result<Self, LoadError> {
        let mut out = Self {
            tied_m: Vec::new(),
            tied_creep_m: Vec::new(),
            added_m: Vec::new(),
            time_s: 0.0,
            error: ModelError::default(),
            strands,
            temperature_k,
            tension_n,
        };
        out.tension_again(tension_n, duration_s)?;
        Ok(out)
    }

    /// Re-tensions the strands as [`StrandAssembly::new`], with their present state.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn tension_again(&mut self, tension_n: f64, duration_s: f64) -> Result<(), LoadError> {
        for strand in &mut self.strands {
            let load = RopeLoad {
                tension_n: tension_n + strand.extra_n,
                temperature_k: self.temperature_k,
            };
            for piece in &mut strand.pieces {
                piece.law.hold(&mut piece.state, load, duration_s)?;
            }
        }
        self.tension_n = tension_n;
        self.time_s += duration_s;
        self.tied_creep_m = self.strands.iter().map(Strand::creep_m).collect();
        let tied = AddedStrain {
            time_s: self.time_s,
            ..AddedStrain::default()
        };
        self.added_m = vec![tied; self.strands.len()];
        let strands = self.strands.iter().enumerate();
        self.tied_m = strands.map(|(i, s)| self.length_m(i, s)).collect();
        Ok(())
    }

    /// Applies a model error to the creep since the ropes were tied off.
    #[must_use]
    pub fn with_model_error(mut self, error: ModelError) -> Self {
        self.error = error;
        self
    }

    /// Tension of the strand that pulls least, N; 0 when it is slack.
    #[must_use]
    pub fn tension_n(&self) -> f64 {
        self.tension_n
    }

    /// How much longer the first strand is than when it was tied off, m: a joint of radius `r` has
    /// sagged by this over `r`.
    #[must_use]
    pub fn sag_m(&self) -> f64 {
        match (self.strands.first(), self.tied_m.first()) {
            (Some(strand), Some(tied)) => self.length_m(0, strand) - tied,
            _ => 0.0,
        }
    }

    /// Strands of the assembly.
    #[must_use]
    pub fn strands(&self) -> &[Strand] {
        &self.strands
    }

    /// Simulates the relaxation for a time, or until the smallest tension has decreased to `until_n`.
    ///
    /// * `tolerance`: relative error of tension and strain in one step, such as [`RELAXATION_TOLERANCE`].
    /// * `seen`: called after each step with the time since the call, s.
    /// * Returns the time that has passed, s.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn leave(
        &mut self,
        duration_s: f64,
        until_n: Option<f64>,
        tolerance: f64,
        mut seen: impl FnMut(f64, &Self),
    ) -> Result<f64, LoadError> {
        super::rope_law::check_duration(duration_s)?;
        let (mut at, mut h) = (0.0, FIRST_S);
        for _ in 0..STEPS_MAX {
            if duration_s - at <= 1e-15 * duration_s {
                break;
            }
            h = f64::min(h, duration_s - at);
            let (next, error) = self.stepped(h)?;
            let share = error / tolerance;
            if share <= 1.0 || h <= SHORTEST_S {
                if let Some(low) = until_n
                    && next.tension_n < low
                {
                    let (h, next) = self.falls_to(low, h, next)?;
                    *self = next;
                    seen(at + h, self);
                    return Ok(at + h);
                }
                *self = next;
                at += h;
                seen(at, self);
            }
            // Fourth order: the error of a step goes with h⁵.
            let wish = 0.85 * libm::pow(share.max(1e-12), -0.2);
            h = (h * wish.clamp(0.1, 4.0)).max(SHORTEST_S);
        }
        Ok(at)
    }

    /// Within a step of `h` the least tension falls to `low`: when, and how it is then.
    fn falls_to(&self, low: f64, h: f64, end: Self) -> Result<(f64, Self), LoadError> {
        let (mut a, mut b) = ((0.0, self.tension_n - low), (h, end.tension_n - low));
        let mut found = (h, end);
        // Regula falsi with the Illinois rule; tension is smooth within a step.
        for _ in 0..40 {
            let x = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
            let next = self.stepped(x)?.0;
            let y = next.tension_n - low;
            found = (x, next);
            if y.abs() <= 1e-11 * low || b.0 - a.0 <= 1e-12 * h {
                break;
            }
            if y > 0.0 {
                a = (x, y);
                b.1 *= 0.5;
            } else {
                b = (x, y);
                a.1 *= 0.5;
            }
        }
        Ok(found)
    }

    /// After a step of sixth order, and its error as a share of tension and strain.
    fn stepped(&self, h: f64) -> Result<(Self, f64), LoadError> {
        let coarse = self.in_steps(h, 1)?;
        let middle = self.in_steps(h, 2)?;
        let fine = self.in_steps(h, 4)?;
        let mut out = fine.clone();
        let mut error = 0.0f64;
        for (i, strand) in out.strands.iter_mut().enumerate() {
            for (j, piece) in strand.pieces.iter_mut().enumerate() {
                let of = |s: &Self| s.strands[i].pieces[j].state;
                let (state, percent) =
                    super::ramp::extrapolate(&of(self), &of(&coarse), &of(&middle), &of(&fine));
                piece.state = state;
                let tension_n = self.tension_n + strand.extra_n;
                let kink = piece.kink_percent(&of(self), tension_n, self.temperature_k, h);
                if kink > 0.0 && piece.is_bedded(&of(&fine), fine.tension_n + strand.extra_n) {
                    // Extrapolation is blind to where the bedding-in ends.
                    piece.state.bedding_percent = of(&fine).bedding_percent;
                    error = error.max(kink / piece.strain_scale_percent(tension_n));
                }
                error = error.max(percent / piece.strain_scale_percent(tension_n));
            }
        }
        // The extrapolated states differ from those of the fine steps by rounding and the error of the step.
        let slope = out.error.creep_factor(out.time_s);
        for ((added, strand), tied_m) in
            (out.added_m.iter_mut().zip(&out.strands)).zip(&out.tied_creep_m)
        {
            let law = strand.creep_m() - tied_m;
            added.widened += slope * (law - added.law);
            added.law = law;
        }
        out.tension_n =
            out.balanced(|i, strand, tension_n| strand.elastic_m(tension_n) + out.crept_m(i))?;
        let [ab, bc] = [
            middle.tension_n + (middle.tension_n - coarse.tension_n) / 3.0,
            fine.tension_n + (fine.tension_n - middle.tension_n) / 3.0,
        ];
        let abc = bc + (bc - ab) / 15.0;
        error = error.max((abc - bc).abs() / self.largest_n());
        Ok((out, error))
    }

    fn in_steps(&self, h: f64, steps: u32) -> Result<Self, LoadError> {
        let dt = h / f64::from(steps);
        let lags: Vec<Vec<Lags>> = self
            .strands
            .iter()
            .map(|s| {
                s.pieces
                    .iter()
                    .map(|p| p.lags(self.temperature_k, dt))
                    .collect()
            })
            .collect();
        let mut out = self.clone();
        for _ in 0..steps {
            let from_n = out.tension_n;
            out.time_s += dt;
            let lines = out.added_m.iter().map(|a| out.error.step(*a, out.time_s));
            let lines: Vec<(f64, f64)> = lines.collect();
            let after = |i: usize, strand: &Strand, tension_n: f64| {
                let span = (from_n + strand.extra_n, tension_n);
                let pieces = strand.pieces.iter().zip(&lags[i]);
                let creep_m = pieces.map(|(p, lags)| p.creep_m(&p.after(lags, span)));
                let ((offset_m, slope), tied_m) = (lines[i], out.tied_creep_m[i]);
                let added_m = offset_m + slope * (creep_m.sum::<f64>() - tied_m);
                strand.elastic_m(tension_n) + tied_m + added_m
            };
            let to_n = out.balanced(after)?;
            for (strand, lags) in out.strands.iter_mut().zip(&lags) {
                let span = (from_n + strand.extra_n, to_n + strand.extra_n);
                for (piece, lags) in strand.pieces.iter_mut().zip(lags) {
                    piece.state = piece.after(lags, span);
                }
            }
            out.tension_n = to_n;
            for ((added, strand), tied_m) in
                (out.added_m.iter_mut().zip(&out.strands)).zip(&out.tied_creep_m)
            {
                let law = strand.creep_m() - tied_m;
                *added = out.error.next(*added, out.time_s, law);
            }
        }
        Ok(out)
    }

    /// Least tension at which the strands are together as long as they were tied off, N; 0 when
    /// they are longer even so. `length` of a strand rises with the tension it is given.
    fn balanced(&self, length: impl Fn(usize, &Strand, f64) -> f64) -> Result<f64, LoadError> {
        let tied: f64 = self.tied_m.iter().sum();
        let excess = |tension_n: f64| {
            let strands = self.strands.iter().enumerate();
            let lengths = strands.map(|(i, s)| length(i, s, tension_n + s.extra_n));
            lengths.sum::<f64>() - tied
        };
        let strongest = |s: &Strand| {
            let weakest = s.pieces.iter().map(Piece::breaking_load_n);
            weakest.fold(f64::INFINITY, f64::min) - s.extra_n
        };
        let top = self.strands.iter().map(strongest);
        let top = top.fold(f64::INFINITY, f64::min);
        // Secant iteration from the present tension, within a bracket of the root.
        let (mut low, mut high) = (None, f64::INFINITY);
        let mut x = self.tension_n;
        let mut y = excess(x);
        let mut slope = self.compliance_m_per_n();
        for _ in 0..200 {
            if y == 0.0 {
                return Ok(x);
            }
            if y > 0.0 {
                if x <= 0.0 {
                    return Ok(0.0);
                }
                high = x;
            } else {
                if x >= top {
                    return Err(LoadError::Broken {
                        tension_n: x,
                        breaking_load_n: top,
                    });
                }
                low = Some(x);
            }
            let mut next = (x - y / slope).clamp(0.0, top);
            if low.is_some_and(|low| next <= low) || next >= high {
                next = if high.is_finite() {
                    0.5 * (low.unwrap_or(0.0) + high)
                } else {
                    f64::min(2.0 * x + 1.0, top)
                };
            }
            let moved = next - x;
            // The last slope is good to some 1e-6 by then: what is left is rounding.
            let done = moved.abs() <= 1e-9 * x.abs().max(1e-3);
            let before = (x, y);
            x = next;
            if done {
                return Ok(x);
            }
            y = excess(x);
            let secant = (y - before.1) / (x - before.0);
            if secant > 0.0 && secant.is_finite() {
                slope = secant;
            }
        }
        Ok(x)
    }

    /// Length of strand `i` under its tension, m.
    fn length_m(&self, i: usize, strand: &Strand) -> f64 {
        strand.elastic_m(self.tension_n + strand.extra_n) + self.crept_m(i)
    }

    /// Creep of strand `i` with the model error, m.
    fn crept_m(&self, i: usize) -> f64 {
        self.tied_creep_m[i] + self.added_m[i].widened
    }

    /// Compliance of all strands together for a small, fast change, m/N.
    fn compliance_m_per_n(&self) -> f64 {
        let of = |s: &Strand| {
            let n = self.tension_n + s.extra_n;
            let ropes: f64 = s.pieces.iter().map(|p| p.compliance_m_per_n(n)).sum();
            ropes + s.series_compliance_m_per_n
        };
        self.strands.iter().map(of).sum()
    }

    /// Largest tension of a strand, at least 1e-4 of the weakest rope's breaking load, N.
    fn largest_n(&self) -> f64 {
        let of = |s: &Strand| {
            let least = s.pieces.iter().map(Piece::breaking_load_n);
            let least = 1e-4 * least.fold(f64::INFINITY, f64::min);
            f64::max(self.tension_n + s.extra_n, least)
        };
        self.strands.iter().map(of).fold(0.0, f64::max)
    }
}

impl Strand {
    /// Elastic elongation of rope and series compliance, m.
    fn elastic_m(&self, tension_n: f64) -> f64 {
        let ropes = self.pieces.iter().map(|p| p.elastic_m(tension_n));
        ropes.sum::<f64>() + self.series_compliance_m_per_n * tension_n
    }

    /// Creep of the rope, m.
    fn creep_m(&self) -> f64 {
        self.pieces.iter().map(|p| p.creep_m(&p.state)).sum()
    }

    /// Strand of one rope without guides or series compliance.
    #[must_use]
    pub fn straight(law: super::Law, length_m: f64, state: State) -> Self {
        Self {
            pieces: vec![Piece {
                law,
                length_m,
                state,
            }],
            series_compliance_m_per_n: 0.0,
            extra_n: 0.0,
        }
    }
}
