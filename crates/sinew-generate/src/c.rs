//! C99 output: a header and a source file that need only `math.h`.

use crate::write::{Body, momentum, number};
use crate::{File, Language, Subject, turn};
use std::fmt::Write as _;

pub(crate) fn files(subject: &Subject<'_>) -> Vec<File> {
    let name = &subject.name;
    vec![
        File {
            name: format!("{name}.h"),
            text: header(subject),
        },
        File {
            name: format!("{name}.c"),
            text: source(subject),
        },
    ]
}

/// Puts the robot's own words into a text.
fn filled(text: &str, subject: &Subject<'_>) -> String {
    text.replace("@name@", &subject.name)
        .replace("@upper@", &subject.name.to_ascii_uppercase())
        .replace("@n@", &subject.joints().to_string())
        .replace("@gain@", &number(subject.gain_per_s))
        .replace("@cutoff@", &number(subject.cutoff_rad_per_s))
        .replace("@settling@", &number(subject.settling_s()))
        .replace("@precision@", subject.precision.name())
        .replace("@LARGEST@", subject.precision.largest())
        .replace("@version@", env!("CARGO_PKG_VERSION"))
        .replace("@robot@", &comment(&subject.robot.name))
}

/// Returns a name for a comment, which it cannot close.
fn comment(name: &str) -> String {
    let name = name.replace(|c: char| c.is_control(), " ");
    name.replace("*/", "* /")
}

/// Returns a name as a C99 string literal: bytes other than plain ASCII are octal.
fn quoted(name: &str) -> String {
    let mut out = String::from("\"");
    for byte in name.bytes() {
        match byte {
            // `?` too: two of them and another sign are a trigraph.
            b' '..=b'~' if !matches!(byte, b'"' | b'\\' | b'?') => out.push(char::from(byte)),
            _ => {
                let _ = write!(out, "\\{byte:03o}");
            }
        }
    }
    out + "\""
}

fn header(subject: &Subject<'_>) -> String {
    let mut joints = String::new();
    for (i, joint) in subject.robot.joint_names().iter().enumerate() {
        let stiffness = subject.stiffness(i);
        let drive = stiffness.map_or("rigid: no offset".to_owned(), |k| format!("{k} N m/rad"));
        let _ = writeln!(joints, " *   {i}  {}, {drive}", comment(joint));
    }
    filled(HEADER, subject).replace("@LIST@\n", &joints)
}

fn source(subject: &Subject<'_>) -> String {
    let n = subject.joints();
    let Body {
        lines,
        turns,
        p,
        ct_dq,
        g,
    } = momentum(&subject.pass, Language::C);
    let mut results = String::new();
    for (array, texts) in [("p", &p), ("ct_dq", &ct_dq), ("g", &g)] {
        for (i, text) in texts.iter().enumerate() {
            let _ = writeln!(results, "    {array}[{i}] = {text};");
        }
    }
    let each = |line: &dyn Fn(usize) -> String| (0..n).map(line).collect::<String>();
    let elastic = |i: usize| subject.stiffness(i);
    let names = subject.robot.joint_names().iter();
    let names: Vec<String> = names.map(|name| quoted(name)).collect();
    let finite = each(&|i| {
        let theta = elastic(i).map_or(String::new(), |_| format!(" + fabs(theta[{i}])"));
        format!("    sum += fabs(q[{i}]){theta};\n")
    });
    let external = each(&|i| format!("        sum += fabs(tau_ext[{i}]);\n"));
    let starts = each(&|i| {
        let mut out = format!("        start(&o->q[{i}], q[{i}]);\n");
        if elastic(i).is_some() {
            let _ = writeln!(out, "        start(&o->theta[{i}], theta[{i}]);");
        }
        let _ = writeln!(
            out,
            "        start(&o->tau_ext[{i}], tau_ext ? tau_ext[{i}] : 0.0);"
        );
        out
    });
    let filters = each(&|i| {
        let mut out = format!("        smooth(&o->q[{i}], &o->weights, q[{i}]);\n");
        if elastic(i).is_some() {
            let _ = writeln!(
                out,
                "        smooth(&o->theta[{i}], &o->weights, theta[{i}]);"
            );
        }
        let _ = writeln!(
            out,
            "        smooth(&o->tau_ext[{i}], &o->weights, tau_ext ? tau_ext[{i}] : 0.0);"
        );
        out
    });
    let values =
        each(&|i| format!("    smooth_q[{i}] = o->q[{i}].x;\n    o->dq[{i}] = o->q[{i}].dx;\n"));
    let drives = each(&|i| {
        let friction =
            subject.friction_terms(i, &format!("o->dq[{i}]"), |x| format!("within_one({x})"));
        format!(
            "    drive[{i}] = ct_dq[{i}] - g[{i}]{friction} + (tau_ext ? o->tau_ext[{i}].x : 0.0);\n"
        )
    });
    let observes = each(&|i| {
        format!(
            "        o->tau_el[{i}] = w->a * o->tau_el[{i}] + (1.0 - w->a) * (p[{i}] - o->p[{i}]) * w->per_step\n            - w->w0 * o->drive[{i}] - w->w1 * drive[{i}];\n"
        )
    });
    let rests = each(&|i| format!("        o->tau_el[{i}] = -drive[{i}];\n"));
    let keeps = each(&|i| format!("    o->p[{i}] = p[{i}];\n    o->drive[{i}] = drive[{i}];\n"));
    let compares = each(&|i| match elastic(i) {
        None => String::new(),
        Some(k) => format!(
            "    o->delta_e[{i}] = lag(&o->deflection[{i}], w, started, o->theta[{i}].x - o->q[{i}].x) - o->tau_el[{i}] * {};\n",
            number(1.0 / k)
        ),
    });
    let unknown = each(&|i| match elastic(i) {
        None => format!("    o->delta_e[{i}] = NAN;\n"),
        Some(_) => String::new(),
    });
    let turn = match turns {
        true => turn::filled(TURN, subject.precision),
        false => String::new(),
    };
    filled(SOURCE, subject)
        .replace("@TURN@\n", &turn)
        .replace("@NAMES@", &names.join(", "))
        .replace("@PASS@\n", &lines)
        .replace("@RESULTS@\n", &results)
        .replace("@FINITE@\n", &finite)
        .replace("@EXTERNAL@\n", &external)
        .replace("@STARTS@\n", &starts)
        .replace("@FILTERS@\n", &filters)
        .replace("@VALUES@\n", &values)
        .replace("@DRIVES@\n", &drives)
        .replace("@OBSERVES@\n", &observes)
        .replace("@RESTS@\n", &rests)
        .replace("@KEEPS@\n", &keeps)
        .replace("@COMPARES@\n", &compares)
        .replace("@UNKNOWN@\n", &unknown)
}

const HEADER: &str = r#"/* @robot@: momentum pass and offset observer, written by Sinew @version@ (sinew robot generate).
 *
 * Masses, geometry, stiffness and friction are those of its robot.toml and URDF when this was written: generate it
 * again when they change. Positions are rad (m of a sliding joint), torques N m (N), time s; in @precision@ precision.
 *
 *   joint
@LIST@
 *
 * Realtime: nothing here allocates, locks, loops, reads a clock or calls anything but math.h.
 */
#ifndef SINEW_@upper@_H
#define SINEW_@upper@_H

#ifdef __cplusplus
extern "C" {
#endif

enum { @upper@_JOINTS = @n@ };

/* Checksum of this code: of the robot, the settings of the observer and the precision. */
#define @upper@_CHECKSUM @CHECKSUM@ULL

/* Status of a step. A rejected sample changes nothing. */
enum {
    @upper@_OK = 0,
    /* An input is NaN, infinite or larger than any robot. */
    @upper@_NOT_FINITE = 1,
    /* The time step is not between 1e-9 s and 1e9 s. */
    @upper@_TIME_STEP = 2,
    /* The state is that of other code, such as one that was stored for another robot, or was never reset. */
    @upper@_OTHER_STATE = 3
};

extern const char *const @name@_joint_names[@upper@_JOINTS];

/* Momentum terms of the arm: p = M(q) dq, C(q, dq)^T dq, g(q). */
void @name@_momentum(const double q[@upper@_JOINTS], const double dq[@upper@_JOINTS], double p[@upper@_JOINTS],
                   double ct_dq[@upper@_JOINTS], double g[@upper@_JOINTS]);

/* A smoothed signal and its derivative. */
typedef struct {
    double input, x, dx;
} @name@_filter;

/* Filter weights for one length of the time step. */
typedef struct {
    double dt_s, per_step, x_e, x_f, dx_e, dx_f, a, w0, w1;
} @name@_weights;

/* Observer state: read the first members, do not write any. */
typedef struct {
    /* Offset (theta_measured - q) - tau_el / K, rad; NaN of a rigid joint. */
    double delta_e[@upper@_JOINTS];
    /* Elastic torque, N m. */
    double tau_el[@upper@_JOINTS];
    /* Joint velocity as filtered, rad/s. */
    double dq[@upper@_JOINTS];
    /* Time since the first sample, s. */
    double since_start_s;

    unsigned long long checksum;
    int started;
    @name@_weights weights;
    @name@_filter q[@upper@_JOINTS], theta[@upper@_JOINTS], tau_ext[@upper@_JOINTS];
    @name@_filter deflection[@upper@_JOINTS];
    double p[@upper@_JOINTS], drive[@upper@_JOINTS];
} @name@_observer;

/* Before the first step, and after a gap: the next sample is a start. */
void @name@_reset(@name@_observer *o);

/* Steps by dt_s to a sample; the first one only initialises the filters and ignores dt_s. theta of a rigid joint is
 * ignored. tau_ext is the measured or specified external torque, or NULL.
 * Observer gain @gain@ 1/s, filter @cutoff@ rad/s. */
int @name@_step(@name@_observer *o, double dt_s, const double q[@upper@_JOINTS], const double theta[@upper@_JOINTS],
              const double *tau_ext);

/* Whether the start has faded to a thousandth: @settling@ s after it. */
int @name@_is_settled(const @name@_observer *o);

#ifdef __cplusplus
}
#endif

#endif
"#;

const TURN: &str = r#"/* Sine and cosine: x is an integer number of quarter turns plus a remainder, whose sine and cosine are polynomials.
 * Accurate to rounding; beyond @FAR@ rad math.h computes them. */
static inline void turn(double x, double *s, double *c)
{
    if (fabs(x) <= @FAR@) {
        const double turns = x * @PER_RAD@;
        const int k = (int)(turns + (turns < 0.0 ? -0.5 : 0.5));
        const double n = (double)k;
        const double r = x - n * @P0@ - n * @P1@ - n * @P2@;
        const double z = r * r, h = 0.5 * z, w = 1.0 - h;
        const double sine = r + r * z * (@SINE@);
        const double cosine = w + (1.0 - w - h + z * z * (@COSINE@));
        *s = (k & 1 ? cosine : sine) * (double)(1 - (k & 2));
        *c = (k & 1 ? sine : cosine) * (double)(1 - ((k + 1) & 2));
    } else {
        *s = sin(x);
        *c = cos(x);
    }
}
"#;

const SOURCE: &str = r#"/* @robot@: momentum pass and offset observer, written by Sinew @version@ (sinew robot generate). */
#include "@name@.h"

#include <math.h>
#include <stddef.h>

const char *const @name@_joint_names[@upper@_JOINTS] = {@NAMES@};

@TURN@
void @name@_momentum(const double q[@upper@_JOINTS], const double dq[@upper@_JOINTS], double p[@upper@_JOINTS],
                   double ct_dq[@upper@_JOINTS], double g[@upper@_JOINTS])
{
@PASS@
@RESULTS@
    (void)q;
}

/* Weights of a step: state-variable filter (critically damped) and first-order lag, both solved exactly for an input
 * that is linear between samples. */
static void set_step(@name@_weights *w, double dt_s)
{
    const double wt = @cutoff@ * dt_s, decay = exp(-wt);
    const double x = @gain@ * dt_s, fall = expm1(-x), a = 1.0 + fall;
    const double mean = x > 1e-12 ? -fall / x : 1.0;
    w->dt_s = dt_s;
    w->per_step = 1.0 / dt_s;
    w->x_e = decay * (1.0 + wt);
    w->x_f = decay * dt_s;
    w->dx_e = decay * @cutoff@ * wt;
    w->dx_f = decay * (1.0 - wt);
    w->a = a;
    w->w0 = fmax(mean - a, 0.0);
    w->w1 = fmax(1.0 - mean, 0.0);
}

static void start(@name@_filter *f, double u)
{
    f->input = u;
    f->x = u;
    f->dx = 0.0;
}

static void smooth(@name@_filter *f, const @name@_weights *w, double u)
{
    const double slope = (u - f->input) * w->per_step;
    const double lag = slope * (2.0 / @cutoff@);
    const double e = f->x - (f->input - lag);
    const double v = f->dx - slope;
    f->x = u - lag + w->x_e * e + w->x_f * v;
    f->dx = slope + w->dx_f * v - w->dx_e * e;
    f->input = u;
}

/* Lags like the observed torque. */
static double lag(@name@_filter *f, const @name@_weights *w, int started, double u)
{
    f->x = started ? w->a * f->x + w->w0 * f->input + w->w1 * u : u;
    f->input = u;
    return f->x;
}

static double within_one(double x)
{
    return x < -1.0 ? -1.0 : x > 1.0 ? 1.0 : x;
}

void @name@_reset(@name@_observer *o)
{
    o->checksum = @upper@_CHECKSUM;
    o->started = 0;
    o->since_start_s = 0.0;
    o->weights.dt_s = 0.0;
@UNKNOWN@
    (void)within_one;
}

int @name@_step(@name@_observer *o, double dt_s, const double q[@upper@_JOINTS], const double theta[@upper@_JOINTS],
              const double *tau_ext)
{
    const int started = o->started;
    @name@_weights *const w = &o->weights;
    double smooth_q[@upper@_JOINTS], p[@upper@_JOINTS], ct_dq[@upper@_JOINTS], g[@upper@_JOINTS], drive[@upper@_JOINTS];
    double sum = 0.0;

    if (o->checksum != @upper@_CHECKSUM) {
        return @upper@_OTHER_STATE;
    }
@FINITE@
    if (tau_ext) {
@EXTERNAL@
    }
    if (!(sum < @LARGEST@)) {
        return @upper@_NOT_FINITE;
    }
    if (started && !(dt_s >= 1e-9 && dt_s <= 1e9)) {
        return @upper@_TIME_STEP;
    }
    if (started) {
        if (dt_s != w->dt_s) {
            set_step(w, dt_s);
        }
@FILTERS@
        o->since_start_s += dt_s;
    } else {
@STARTS@
    }
@VALUES@
    @name@_momentum(smooth_q, o->dq, p, ct_dq, g);
@DRIVES@
    if (started) {
@OBSERVES@
    } else {
@RESTS@
    }
@KEEPS@
@COMPARES@
    o->started = 1;
    return @upper@_OK;
}

int @name@_is_settled(const @name@_observer *o)
{
    return o->checksum == @upper@_CHECKSUM && o->started && o->since_start_s >= @settling@;
}
"#;

#[cfg(test)]
mod tests {
    use super::{comment, quoted};

    #[test]
    fn comment_cannot_be_closed_by_name() {
        assert_eq!(comment("a */ int x; /* b\nc"), "a * / int x; /* b c");
        assert_eq!(quoted("j\u{200b}1?\"\\"), r#""j\342\200\2131\077\042\134""#);
    }
}
