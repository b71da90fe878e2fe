//! Rust output without the standard library: one module that needs only the crate `libm`.

use crate::write::{Body, momentum, number};
use crate::{File, Language, Subject, turn};
use std::fmt::Write as _;

pub(crate) fn files(subject: &Subject<'_>) -> Vec<File> {
    vec![File {
        name: format!("{}.rs", subject.name),
        text: source(subject),
    }]
}

fn filled(text: &str, subject: &Subject<'_>) -> String {
    text.replace(
        "@robot@",
        &subject.robot.name.replace(|c: char| c.is_control(), " "),
    )
    .replace("@version@", env!("CARGO_PKG_VERSION"))
    .replace("@gain@", &number(subject.gain_per_s))
    .replace("@cutoff@", &number(subject.cutoff_rad_per_s))
    .replace("@settling@", &number(subject.settling_s()))
    .replace("@precision@", subject.precision.name())
    .replace("@LARGEST@", subject.precision.largest())
}

fn source(subject: &Subject<'_>) -> String {
    let n = subject.joints();
    let Body {
        lines,
        turns,
        p,
        ct_dq,
        g,
    } = momentum(&subject.pass, Language::Rust);
    let elastic = |i: usize| subject.stiffness(i);
    let each = |line: &dyn Fn(usize) -> String| (0..n).map(line).collect::<String>();
    let names = subject.robot.joint_names().iter();
    let names: Vec<String> = names.map(|name| format!("{name:?}")).collect();
    let list = each(&|i| {
        let drive = elastic(i).map_or("rigid: no offset".to_owned(), |k| format!("{k} N·m/rad"));
        format!("//! * {i}: {}, {drive}\n", subject.robot.joint_names()[i])
    });
    let checked = each(&|i| match elastic(i) {
        Some(_) => {
            format!("        sum += q[{i}].abs() + theta[{i}].abs() + external[{i}].abs();\n")
        }
        None => format!("        sum += q[{i}].abs() + external[{i}].abs();\n"),
    });
    let filters = |call: &str| {
        each(&|i| {
            let mut out = format!("            self.q[{i}].{call}q[{i}]);\n");
            if elastic(i).is_some() {
                let _ = writeln!(out, "            self.theta[{i}].{call}theta[{i}]);");
            }
            let _ = writeln!(out, "            self.tau_ext[{i}].{call}external[{i}]);");
            out
        })
    };
    let drives = each(&|i| {
        let friction = subject.friction_terms(i, &format!("self.dq[{i}]"), |x| {
            format!("({x}).clamp(-1.0, 1.0)")
        });
        let external = format!("if known {{ self.tau_ext[{i}].x }} else {{ 0.0 }}");
        format!("            ct_dq[{i}] - g[{i}]{friction} + {external},\n")
    });
    let observes = each(&|i| {
        format!(
            "            self.tau_el[{i}] = w.a * self.tau_el[{i}] + (1.0 - w.a) * (p[{i}] - self.p[{i}]) * w.per_step\n                - w.w0 * self.drive[{i}] - w.w1 * drive[{i}];\n"
        )
    });
    let rests = each(&|i| format!("            self.tau_el[{i}] = -drive[{i}];\n"));
    let compares = each(&|i| match elastic(i) {
        None => String::new(),
        Some(k) => format!(
            "        let twist = self.theta[{i}].x - self.q[{i}].x;\n        self.delta_e[{i}] = self.deflection[{i}].lag(&w, started, twist) - self.tau_el[{i}] * {};\n",
            number(1.0 / k)
        ),
    });
    let of_filters = |part: &str| {
        let all: Vec<String> = (0..n).map(|i| format!("self.q[{i}].{part}")).collect();
        all.join(", ")
    };
    let turn = match turns {
        true => turn::filled(TURN, subject.precision),
        false => String::new(),
    };
    filled(SOURCE, subject)
        .replace("@TURN@\n", &turn)
        .replace("@LIST@\n", &list)
        .replace("@N@", &n.to_string())
        .replace("@NAMES@", &names.join(", "))
        .replace("@PASS@\n", &lines)
        .replace("@P@", &p.join(", "))
        .replace("@CT_DQ@", &ct_dq.join(", "))
        .replace("@G@", &g.join(", "))
        .replace("@CHECKED@\n", &checked)
        .replace("@FILTERS@\n", &filters("smooth(&w, "))
        .replace("@STARTS@\n", &filters("start("))
        .replace("@Q@", &of_filters("x"))
        .replace("@DQ@", &of_filters("dx"))
        .replace("@DRIVES@\n", &drives)
        .replace("@OBSERVES@\n", &observes)
        .replace("@RESTS@\n", &rests)
        .replace("@COMPARES@\n", &compares)
}

const TURN: &str = r#"/// Sine and cosine: `x` is an integer number of quarter turns plus a remainder, whose sine and cosine are polynomials.
/// Accurate to rounding; beyond @FAR@ rad `libm` computes them.
#[inline(always)]
#[allow(clippy::excessive_precision, clippy::approx_constant)]
fn turn(x: f64) -> (f64, f64) {
    /// A number of this size has no room for a fraction: adding it rounds.
    const ROUNDING: f64 = @ROUNDING@;
    if x.abs() <= @FAR@ {
        let rounded = x * @PER_RAD@ + ROUNDING;
        let (k, quarter) = (rounded - ROUNDING, rounded.to_bits());
        let r = x - k * @P0@ - k * @P1@ - k * @P2@;
        let z = r * r;
        let h = 0.5 * z;
        let w = 1.0 - h;
        let sine = r + r * z * (@SINE@);
        let cosine = w + (1.0 - w - h + z * z * (@COSINE@));
        let (s, c) = if quarter & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
        let sign = |x: f64, of: u64| f64::from_bits(x.to_bits() ^ ((of & 2) << @SHIFT@));
        (sign(s, quarter), sign(c, quarter + 1))
    } else {
        libm::sincos(x)
    }
}

"#;

const SOURCE: &str = r#"//! @robot@: momentum pass and offset observer, written by Sinew @version@ (`sinew robot generate`).
//!
//! Masses, geometry, stiffness and friction are those of its `robot.toml` and URDF when this was written: generate it
//! again when they change. Positions are rad (m of a sliding joint), torques N·m (N), time s; in @precision@ precision. Needs
//! the crate `libm`, no standard library. Nothing here allocates, locks, panics, loops or reads a clock.
//!
@LIST@

/// Number of joints.
pub const JOINTS: usize = @N@;

/// Names of the joints, in the order of `q`.
pub const JOINT_NAMES: [&str; JOINTS] = [@NAMES@];

/// Momentum terms of the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Momentum {
    /// `p = M(q) dq`.
    pub p: [f64; JOINTS],
    /// `C(q, dq)ᵀ dq`.
    pub ct_dq: [f64; JOINTS],
    /// Gravity torque `g(q)`.
    pub g: [f64; JOINTS],
}

@TURN@
/// The momentum pass.
#[allow(unused_variables)]
#[rustfmt::skip]
pub fn momentum(q: &[f64; JOINTS], dq: &[f64; JOINTS]) -> Momentum {
@PASS@
    Momentum {
        p: [@P@],
        ct_dq: [@CT_DQ@],
        g: [@G@],
    }
}

/// Reason why a sample was rejected; a rejected sample changes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepError {
    /// An input is NaN, infinite or larger than any robot.
    NotFinite,
    /// The time step is not between 1e-9 s and 1e9 s.
    TimeStep,
}

/// A smoothed signal and its derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Filter {
    input: f64,
    x: f64,
    dx: f64,
}

/// Filter weights for one length of the time step.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Weights {
    dt_s: f64,
    per_step: f64,
    x_e: f64,
    x_f: f64,
    dx_e: f64,
    dx_f: f64,
    a: f64,
    w0: f64,
    w1: f64,
}

impl Weights {
    const NONE: Self = Self {
        dt_s: 0.0,
        per_step: 0.0,
        x_e: 0.0,
        x_f: 0.0,
        dx_e: 0.0,
        dx_f: 0.0,
        a: 1.0,
        w0: 0.0,
        w1: 0.0,
    };

    /// State-variable filter (critically damped) and first-order lag, both solved exactly for an input that is linear
    /// between samples.
    fn new(dt_s: f64) -> Self {
        let wt = @cutoff@ * dt_s;
        let decay = libm::exp(-wt);
        let x = @gain@ * dt_s;
        let fall = libm::expm1(-x);
        let a = 1.0 + fall;
        let mean = if x > 1e-12 { -fall / x } else { 1.0 };
        Self {
            dt_s,
            per_step: 1.0 / dt_s,
            x_e: decay * (1.0 + wt),
            x_f: decay * dt_s,
            dx_e: decay * @cutoff@ * wt,
            dx_f: decay * (1.0 - wt),
            a,
            w0: (mean - a).max(0.0),
            w1: (1.0 - mean).max(0.0),
        }
    }
}

impl Filter {
    const NONE: Self = Self {
        input: 0.0,
        x: 0.0,
        dx: 0.0,
    };

    fn start(&mut self, u: f64) {
        *self = Self {
            input: u,
            x: u,
            dx: 0.0,
        };
    }

    fn smooth(&mut self, w: &Weights, u: f64) {
        let slope = (u - self.input) * w.per_step;
        let lag = slope * (2.0 / @cutoff@);
        let e = self.x - (self.input - lag);
        let v = self.dx - slope;
        self.x = u - lag + w.x_e * e + w.x_f * v;
        self.dx = slope + w.dx_f * v - w.dx_e * e;
        self.input = u;
    }

    /// Lags like the observed torque.
    fn lag(&mut self, w: &Weights, started: bool, u: f64) -> f64 {
        self.x = if started { w.a * self.x + w.w0 * self.input + w.w1 * u } else { u };
        self.input = u;
        self.x
    }
}

/// The observer of gain @gain@ 1/s and filter @cutoff@ rad/s.
#[derive(Debug, Clone, PartialEq)]
pub struct Observer {
    delta_e: [f64; JOINTS],
    tau_el: [f64; JOINTS],
    dq: [f64; JOINTS],
    since_start_s: f64,
    started: bool,
    weights: Weights,
    q: [Filter; JOINTS],
    theta: [Filter; JOINTS],
    tau_ext: [Filter; JOINTS],
    deflection: [Filter; JOINTS],
    p: [f64; JOINTS],
    drive: [f64; JOINTS],
}

impl Default for Observer {
    fn default() -> Self {
        Self::new()
    }
}

impl Observer {
    /// Creates an observer before its first sample.
    pub const fn new() -> Self {
        Self {
            delta_e: [f64::NAN; JOINTS],
            tau_el: [0.0; JOINTS],
            dq: [0.0; JOINTS],
            since_start_s: 0.0,
            started: false,
            weights: Weights::NONE,
            q: [Filter::NONE; JOINTS],
            theta: [Filter::NONE; JOINTS],
            tau_ext: [Filter::NONE; JOINTS],
            deflection: [Filter::NONE; JOINTS],
            p: [0.0; JOINTS],
            drive: [0.0; JOINTS],
        }
    }

    /// Marks a gap: the next sample re-initialises the filters.
    pub fn reset(&mut self) {
        self.started = false;
        self.since_start_s = 0.0;
    }

    /// Steps by `dt_s` to a sample. The first sample only initialises the filters and ignores `dt_s`. `theta` of a
    /// rigid joint is ignored. `tau_ext`: the external torque, if it is measured or specified.
    #[rustfmt::skip]
    pub fn step(
        &mut self,
        dt_s: f64,
        q: &[f64; JOINTS],
        theta: &[f64; JOINTS],
        tau_ext: Option<&[f64; JOINTS]>,
    ) -> Result<(), StepError> {
        let started = self.started;
        let known = tau_ext.is_some();
        let external = tau_ext.unwrap_or(&[0.0; JOINTS]);
        let mut sum = 0.0;
@CHECKED@
        if !(sum < @LARGEST@) {
            return Err(StepError::NotFinite);
        }
        if started && !(1e-9..=1e9).contains(&dt_s) {
            return Err(StepError::TimeStep);
        }
        if started {
            if dt_s != self.weights.dt_s {
                self.weights = Weights::new(dt_s);
            }
            let w = self.weights;
@FILTERS@
            self.since_start_s += dt_s;
        } else {
@STARTS@
        }
        let w = self.weights;
        self.dq = [@DQ@];
        let Momentum { p, ct_dq, g } = momentum(&[@Q@], &self.dq);
        let drive = [
@DRIVES@
        ];
        if started {
@OBSERVES@
        } else {
@RESTS@
        }
        self.p = p;
        self.drive = drive;
@COMPARES@
        self.started = true;
        Ok(())
    }

    /// Offset `(theta_measured − q) − tau_el / K` of every joint, rad; NaN of a rigid one.
    pub fn delta_e(&self) -> &[f64; JOINTS] {
        &self.delta_e
    }

    /// Elastic torque of every joint, N·m.
    pub fn tau_el(&self) -> &[f64; JOINTS] {
        &self.tau_el
    }

    /// Velocity of every joint as filtered, rad/s.
    pub fn dq(&self) -> &[f64; JOINTS] {
        &self.dq
    }

    /// Whether the start has faded to a thousandth: @settling@ s after it.
    pub fn is_settled(&self) -> bool {
        self.started && self.since_start_s >= @settling@
    }
}
"#;
