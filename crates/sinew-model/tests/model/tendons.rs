//! Tendons against reference values, closed forms and differences of the energy.

use crate::random::Random;
use crate::skipped::shared;
use serde_json::Value;
use sinew_model::correction::Spring;
use sinew_model::tendons::*;
use sinew_model::transmission::{Tendon, Transmission};

/// Joints as `a b=0.6@-0.3` (spring stiffness and rest position), motors as `m1 m2`, tendons as
/// `loop both 50e3 80: m1 0.02 m2 -0.015 > a 0.01` (kind, name, stiffness, pretension, drums, moment arms).
fn robot(joints: &str, motors: &str, tendons: &[&str]) -> CouplingDescription {
    let number = |text: &str| text.parse::<f64>().unwrap();
    let joint = |text: &str| {
        let (name, spring) = text.split_once('=').unwrap_or((text, ""));
        JointDescription {
            name: name.into(),
            is_rigid: false,
            spring: spring.split_once('@').map(|(k, rest)| JointSpring {
                stiffness_nm_per_rad: number(k),
                rest_rad: number(rest),
            }),
        }
    };
    let pairs = |text: &str| -> Vec<(String, f64)> {
        let words: Vec<&str> = text.split_whitespace().collect();
        words
            .chunks(2)
            .map(|w| (w[0].into(), number(w[1])))
            .collect()
    };
    let tendon = |text: &&str| {
        let (head, rest) = text.split_once(':').unwrap();
        let (drums, arms) = rest.split_once('>').unwrap();
        let head: Vec<&str> = head.split_whitespace().collect();
        let constant = |(joint, arm)| (joint, MomentArm::Constant(arm));
        TendonDescription {
            name: head[1].into(),
            kind: match head[0] {
                "loop" => TendonKind::Loop,
                _ => TendonKind::Strand,
            },
            coordinate: Coordinate::Metres,
            drums: pairs(drums),
            moment_arms: pairs(arms).into_iter().map(constant).collect(),
            stiffness: number(head[2]),
            pretension: Some(number(head[3])),
        }
    };
    CouplingDescription {
        joints: joints.split_whitespace().map(joint).collect(),
        motors: motors.split_whitespace().map(String::from).collect(),
        tendons: tendons.iter().map(tendon).collect(),
    }
}

/// Loops on both motors, strands, a table, springs, and a tendon that is tied to the base.
fn mixed() -> Coupling {
    let tendons = [
        "loop both 50e3 80: m1 0.02 m2 -0.015 > a 0.01 c 0.02",
        "strand flexor 20e3 60: m1 0.01 > b 0.007",
        "strand extensor 22e3 50: m2 0.01 > a -0.02 b -0.006",
        "strand tied 5e3 1: > b 0.005 c 0.004",
    ];
    let mut mixed = robot("a b=0.6@-0.3 c=0.4@0.2", "m1 m2", &tendons);
    let table = MomentArm::Table(rope_table());
    mixed.tendons[1].moment_arms.push(("a".into(), table));
    Coupling::new(mixed).unwrap()
}

fn antagonist() -> CouplingDescription {
    let flexor = "strand flexor 20e3 60: flexor 0.01 > elbow 0.02";
    let extensor = "strand extensor 20e3 60: extensor 0.01 > elbow -0.02";
    robot("elbow", "flexor extensor", &[flexor, extensor])
}

/// Motors in the base: the elbow's rope runs over the shoulder, the wrist's over both.
fn coupled_arm() -> CouplingDescription {
    let tendons = [
        "loop shoulder 64e3 0: m1 0.025 > shoulder 0.025",
        "loop elbow 50e3 0: m2 0.02 > shoulder 0.01 elbow 0.02",
        "loop wrist 36e3 0: m3 0.015 > shoulder 0.006 elbow -0.009 wrist 0.015",
    ];
    robot("shoulder elbow wrist", "m1 m2 m3", &tendons)
}

/// Tensions of 1 : 1 : 2 : 4 turn no joint.
fn finger() -> CouplingDescription {
    let tendons = [
        "strand deep 22e3 6: m1 0.005 > mcp 0.008 pip 0.007 dip 0.006",
        "strand dip 22e3 6: m2 0.005 > mcp 0.008 pip 0.007 dip -0.006",
        "strand pip 24e3 12: m3 0.005 > mcp 0.008 pip -0.007",
        "strand mcp 25e3 24: m4 0.005 > mcp -0.008",
    ];
    robot("mcp pip dip", "m1 m2 m3 m4", &tendons)
}

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
/// Sum of the two strands of [`TendonKind::Strand`] with drums and moment arms `±r`.
struct StrandPair {
    /// Stiffness `k` of each strand, N/m.
    stiffness_n_per_m: f64,
    /// Radius `r` of drum and pulley, m.
    radius_m: f64,
    /// Pretension `f0` of each strand, N.
    pretension_n: f64,
}

impl StrandPair {
    /// Stiffness `K = 2 k r²` at the joint, N·m/rad.
    fn joint_stiffness_nm_per_rad(&self) -> f64 {
        2.0 * self.stiffness_n_per_m * self.radius_m * self.radius_m
    }

    /// Offset `delta_e`, rad, by the elongations of the strand that pulls positively and of the other one, m.
    fn delta_e(&self, elongation_m: [f64; 2]) -> f64 {
        (elongation_m[0] - elongation_m[1]) / (2.0 * self.radius_m)
    }

    /// Remaining pretension `f0'`, N, by the elongations of both strands, m; negative where both are slack at rest.
    fn remaining_pretension_n(&self, elongation_m: [f64; 2]) -> f64 {
        self.pretension_n - 0.5 * self.stiffness_n_per_m * (elongation_m[0] + elongation_m[1])
    }

    /// Largest torque `2 r f0'` at which both strands are taut, N·m; 0 where none is.
    fn torque_limit_nm(&self, elongation_m: [f64; 2]) -> f64 {
        2.0 * self.radius_m * self.remaining_pretension_n(elongation_m).max(0.0)
    }

    /// Half width `−f0'/(k r)` of the dead zone, rad; 0 while pretension remains.
    fn dead_zone_rad(&self, elongation_m: [f64; 2]) -> f64 {
        (-self.remaining_pretension_n(elongation_m)).max(0.0)
            / (self.stiffness_n_per_m * self.radius_m)
    }
}

const PAIR: StrandPair = StrandPair {
    stiffness_n_per_m: 32e3,
    radius_m: 0.025,
    pretension_n: 60.0,
};

/// Shortening, moment arm and its slope of a rope from A = (−20, 30) mm to B = (45, 12) mm, which
/// turns with `q`, by the law of cosines.
fn straight_rope(q: f64) -> [f64; 3] {
    let (a, b) = (0.030_f64.hypot(0.020), 0.045_f64.hypot(0.012));
    let at_zero = 12_f64.atan2(45.0) - 30_f64.atan2(-20.0);
    let length = |q: f64| (a * a + b * b - 2.0 * a * b * (q + at_zero).cos()).sqrt();
    let l = length(q);
    let (sine, cosine) = (q + at_zero).sin_cos();
    let arm = -a * b * sine / l;
    [length(0.0) - l, arm, (arm * arm - a * b * cosine) / l]
}

fn rope_table() -> ShorteningTable {
    let q: Vec<f64> = (-12..=30).map(|i| 0.05 * f64::from(i)).collect();
    let l: Vec<f64> = q.iter().map(|q| straight_rope(*q)[0]).collect();
    ShorteningTable::new(&q, &l).unwrap()
}

fn evaluated(coupling: &Coupling, theta: &[f64], q: &[f64], delta: &[f64]) -> CouplingState {
    let mut state = CouplingState::new(coupling);
    coupling.evaluate(&mut state, theta, q, delta).unwrap();
    state
}

fn at_zero(description: CouplingDescription) -> (Coupling, CouplingState) {
    let coupling = Coupling::new(description).unwrap();
    let [theta, q, delta] = [
        coupling.motor_names().len(),
        coupling.joints().len(),
        coupling.tendon_names().len(),
    ]
    .map(|length| vec![0.0; length]);
    let state = evaluated(&coupling, &theta, &q, &delta);
    (coupling, state)
}

/// Agreement to `tolerance` of the largest entry or of 1e-3, whichever is larger.
#[track_caller]
fn close(what: &str, ours: &[f64], reference: &[f64], tolerance: f64) {
    assert_eq!(ours.len(), reference.len(), "{what}");
    let size = reference.iter().fold(1e-3_f64, |size, x| size.max(x.abs()));
    for (ours, reference) in ours.iter().zip(reference) {
        let off = (ours - reference).abs() / size;
        assert!(off <= tolerance, "{what}: {ours}, not {reference}: {off:e}");
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().flat_map(numbers).collect(),
        value => vec![value.as_f64().expect("a number")],
    }
}

/// Robot of a case of the reference file; the table is made of the closed form of its path.
fn reference_coupling(case: &Value) -> Coupling {
    let words = |values: &Value| -> String {
        let words = values
            .as_array()
            .unwrap()
            .iter()
            .map(|name| name.as_str().unwrap());
        words.collect::<Vec<_>>().join(" ")
    };
    let map = |values: &Value| -> String {
        let entries = values.as_object().into_iter().flatten();
        entries
            .map(|(name, value)| format!("{name} {value} "))
            .collect()
    };
    let tendon = |t: &Value| {
        let (k, f0) = (&t["stiffness_n_per_m"], &t["pretension_n"]);
        let (drums, mut arms) = (map(&t["drum_m"]), map(&t["moment_arm_m"]));
        if arms.is_empty() {
            arms = "elbow -0.02".into();
        }
        let (kind, name) = (t["kind"].as_str().unwrap(), t["name"].as_str().unwrap());
        format!("{kind} {name} {k} {f0}: {drums} > {arms}")
    };
    let tendons: Vec<String> = case["tendons"]
        .as_array()
        .unwrap()
        .iter()
        .map(tendon)
        .collect();
    let tendons: Vec<&str> = tendons.iter().map(String::as_str).collect();
    let mut description = robot(&words(&case["joints"]), &words(&case["motors"]), &tendons);
    if case["name"] == "moment-arm-of-q" {
        description.tendons[0].moment_arms[0].1 = MomentArm::Table(rope_table());
    }
    Coupling::new(description).unwrap()
}

#[test]
fn reference_values_agree() {
    let Some(file) = shared("tendons/tendon-reference.json") else {
        return;
    };
    let file: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let mut states = 0;
    for case in file["cases"].as_array().unwrap() {
        let coupling = reference_coupling(case);
        // A table has 0.05 rad between its rows, so that its shortening is 1e-9 m off, times k over the tension.
        let has_table = case["name"] == "moment-arm-of-q";
        let tolerance = if has_table { 1e-6 } else { 1e-12 };
        for expected in case["states"].as_array().unwrap() {
            states += 1;
            let [theta, q, delta] =
                ["theta_rad", "q_rad", "elongation_m"].map(|key| numbers(&expected[key]));
            let state = evaluated(&coupling, &theta, &q, &delta);
            for (key, ours) in [
                ("stretch_m", state.extension()),
                ("moment_arm_m", state.moment_arms()),
                ("tension_n", state.tension()),
                ("energy_j", state.energy_j()),
                ("tau_el_nm", state.tau_el()),
                ("tau_motor_nm", state.tau_motor()),
            ] {
                let what = format!("{} {key}", case["name"]);
                close(&what, ours, &numbers(&expected[key]), tolerance);
            }
            if case["name"] == "two-strand-loop" {
                let delta = [delta[0], delta[1]];
                let offset = PAIR.delta_e(delta);
                let tau = PAIR.joint_stiffness_nm_per_rad() * (theta[0] - offset - q[0]);
                let ours = [offset, PAIR.remaining_pretension_n(delta), tau];
                let keys = [
                    "loop_delta_e_rad",
                    "loop_remaining_pretension_n",
                    "loop_tau_nm",
                ];
                let reference = keys.map(|key| expected[key].as_f64().unwrap());
                close("loop", &ours, &reference, 1e-12);
                let is_taut = tau.abs() <= PAIR.torque_limit_nm(delta);
                let holds = is_taut && PAIR.dead_zone_rad(delta) == 0.0;
                assert_eq!(Some(holds), expected["loop_holds"].as_bool());
            }
        }
    }
    assert_eq!(states, 26);
}

#[test]
fn diagonal_robot_has_bitwise_the_spring_torque() {
    let mut spring = Transmission::spring(37.3);
    spring.tendon = Some(Tendon {
        joint_pulley_radius_m: 0.025,
        pretension_n: Some(60.0),
        ..Default::default()
    });
    let transmissions = [Some(spring), None, Some(Transmission::spring(11.7))];
    let names = ["shoulder", "track", "elbow"].map(String::from);
    let diagonal = CouplingDescription::diagonal(&names, &transmissions).unwrap();
    let coupling = Coupling::new(diagonal).unwrap();
    assert!(coupling.tendon_names().eq(["shoulder", "elbow"]));
    let groups = coupling.groups();
    let equations: Vec<_> = groups
        .iter()
        .map(|g| (g.joints()[0], g.equations()))
        .collect();
    assert_eq!(
        equations,
        [(0, Equations::Diagonal), (2, Equations::Diagonal)]
    );
    let lengths = [0, 1, 2].map(|i| coupling.elongation_m(i, 0.01));
    assert_eq!(lengths, [Some(0.025 * 0.01), None, None]);
    let mut random = Random(1);
    for _ in 0..1000 {
        let mut draw = || random.normal();
        let (theta, q, delta) = ([draw(), draw()], [draw(), draw(), draw()], [draw(), draw()]);
        let state = evaluated(&coupling, &theta, &q, &delta);
        for (i, j, k) in [(0, 0, 37.3), (1, 2, 11.7)] {
            let today = Spring::new(k, 0.0)
                .unwrap()
                .torque(theta[i] - delta[i] - q[j]);
            assert_eq!(state.tau_el()[j].to_bits(), today.to_bits());
            assert_eq!(state.tau_motor()[i].to_bits(), today.to_bits());
        }
        // 60 N on 25 mm: one strand is slack beyond 3 N·m.
        let is_beyond = state.status()[0] == TendonStatus::BeyondPretension;
        assert_eq!(is_beyond, state.tau_el()[0].abs() > 3.0);
    }
    let error = CouplingDescription::diagonal(&names, &transmissions[..2]).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("2 transmissions for 3 joints")
    );
}

#[test]
fn energy_and_torque_differences_are_torques_and_jacobians() {
    const H: f64 = 1e-6;
    let coupling = mixed();
    let mut random = Random(7);
    let (mut taut, mut slack) = (0, 0);
    for _ in 0..40 {
        // theta 0..2, q 2..5, delta 5..9.
        let mut at = [0.3, 0.3, 0.3, 0.3, 0.3, 3e-3, 3e-3, 3e-3, 3e-3];
        at.iter_mut().for_each(|x| *x *= random.normal());
        let of = |k: usize, step: f64| {
            let mut at = at;
            at[k] += step;
            evaluated(&coupling, &at[..2], &at[2..5], &at[5..])
        };
        let state = of(0, 0.0);
        slack += state
            .status()
            .iter()
            .filter(|s| **s == TendonStatus::Slack)
            .count();
        taut += state
            .status()
            .iter()
            .filter(|s| **s == TendonStatus::Taut)
            .count();
        let energy = |s: &CouplingState| s.energy_j().iter().sum::<f64>();
        for k in 0..9 {
            let (plus, minus) = (of(k, H), of(k, -H));
            if plus.status() != minus.status() {
                // Differences across the point where a strand becomes slack are no derivatives.
                continue;
            }
            let (input, column, width, minus_force) = match k {
                0 | 1 => (Input::MotorPosition, k, 2, state.tau_motor()[k]),
                2..5 => (Input::JointPosition, k - 2, 3, -state.tau_el()[k - 2]),
                _ => (Input::Elongation, k - 5, 4, -state.tension()[k - 5]),
            };
            let slope = (energy(&plus) - energy(&minus)) / (2.0 * H);
            let off = (slope - minus_force).abs();
            assert!(
                off < 1e-6 * (1.0 + energy(&state) + slope.abs()),
                "{k}: {off}"
            );
            type Values = fn(&CouplingState) -> &[f64];
            let outputs: [(Output, Values); 3] = [
                (Output::Tension, CouplingState::tension),
                (Output::JointTorque, CouplingState::tau_el),
                (Output::MotorTorque, CouplingState::tau_motor),
            ];
            for (output, values) in outputs {
                let (plus, minus) = (values(&plus), values(&minus));
                let slopes = plus.iter().zip(minus).map(|(p, m)| (p - m) / (2.0 * H));
                let slopes: Vec<f64> = slopes.collect();
                let mut jacobian = vec![f64::NAN; slopes.len() * width];
                coupling
                    .jacobian(&state, output, input, &mut jacobian)
                    .unwrap();
                let ours: Vec<f64> = jacobian.into_iter().skip(column).step_by(width).collect();
                close(&format!("{output:?} by {k}"), &ours, &slopes, 1e-6);
            }
        }
        // The joint stiffness adds the springs to −∂tau_el/∂q; they have an energy of their own.
        let (mut expected, mut ours) = ([0.0; 9], [0.0; 9]);
        let (output, input) = (Output::JointTorque, Input::JointPosition);
        coupling
            .jacobian(&state, output, input, &mut expected)
            .unwrap();
        expected = expected.map(|x| -x);
        expected[4] += 0.6;
        expected[8] += 0.4;
        coupling.joint_stiffness(&state, &mut ours).unwrap();
        assert_eq!(ours, expected);
        let [b, c] = [at[3] + 0.3, at[4] - 0.2];
        close(
            "springs",
            state.tau_spring(),
            &[0.0, 0.6 * b, 0.4 * c],
            1e-15,
        );
        let expected = 0.3 * b * b + 0.2 * c * c;
        close("springs", &[state.spring_energy_j()], &[expected], 1e-14);
    }
    assert!(taut > 40 && slack > 20, "{taut} taut, {slack} slack");
}

#[test]
fn virtual_work_of_torque_and_tension_is_equal() {
    let coupling = mixed();
    let mut random = Random(3);
    for _ in 0..100 {
        let [q, dq] = [(); 2].map(|()| [(); 3].map(|()| 0.3 * random.normal()));
        let moved = |h: f64| {
            let q = [q[0] + h * dq[0], q[1] + h * dq[1], q[2] + h * dq[2]];
            evaluated(&coupling, &[0.1, 0.2], &q, &[0.0; 4])
        };
        // The path shortens by what the extension loses.
        let (state, plus, minus) = (moved(0.0), moved(1e-6), moved(-1e-6));
        let dl = plus
            .extension()
            .iter()
            .zip(minus.extension())
            .map(|(p, m)| (m - p) / 2e-6);
        let of_tension: f64 = state.tension().iter().zip(dl).map(|(f, dl)| f * dl).sum();
        let of_torque: f64 = state
            .tau_el()
            .iter()
            .zip(dq)
            .map(|(tau, dq)| tau * dq)
            .sum();
        assert!((of_torque - of_tension).abs() < 1e-6 * (1.0 + of_torque.abs()));
    }
}

#[test]
fn slack_strand_has_neither_tension_nor_stiffness() {
    let coupling = Coupling::new(antagonist()).unwrap();
    let at = |flexor: f64| evaluated(&coupling, &[0.0, 0.0], &[0.0], &[flexor, 0.0]);
    // 60 N over 20 N/mm: slack from 3 mm on, continuous in tension.
    for (delta, tension, status, stiffness) in [
        (2.9e-3, 2.0, TendonStatus::Taut, 16.0),
        (3e-3 - 1e-12, 2e-8, TendonStatus::Taut, 16.0),
        (3e-3 + 1e-12, 0.0, TendonStatus::Slack, 8.0),
        (5e-3, 0.0, TendonStatus::Slack, 8.0),
    ] {
        let state = at(delta);
        let energy = 0.5 * tension * tension / 20e3;
        let ours = [state.tension()[0], state.energy_j()[0]];
        assert!(
            (ours[0] - tension).abs() < 1e-9 && (ours[1] - energy).abs() < 1e-12,
            "{ours:?}"
        );
        assert_eq!(state.status(), [status, TendonStatus::Taut]);
        let mut out = [0.0];
        coupling.joint_stiffness(&state, &mut out).unwrap();
        close("joint stiffness", &out, &[stiffness], 1e-12);
    }
    let (state, group) = (at(5e-3), &coupling.groups()[0]);
    let offset = coupling.joint_offset(&state, group, &[5e-3, 0.0]);
    assert_eq!(offset, Err(EvaluationError::Slack { tendon: 0 }));
    let observed = coupling.observability(&state, Sensors::default()).unwrap();
    assert_eq!(
        (observed.rank, observed.unobservable),
        (1, vec![vec![1.0, 0.0]])
    );
}

#[test]
fn table_agrees_with_the_closed_form() {
    let table = rope_table();
    for i in 0..=420 {
        let q = -0.6 + 0.005 * f64::from(i);
        let (ours, exact) = (table.evaluate(q), straight_rope(q));
        // Errors of a cubic spline fall by h⁴, of its derivatives by h³ and h²; they are largest at the ends.
        for (order, tolerance) in [3e-7, 2e-5, 2e-3].into_iter().enumerate() {
            let off = (ours[order] - exact[order]).abs();
            assert!(off < tolerance, "{q}, derivative {order}: {off:e}");
        }
    }
    // Straight on outside.
    let ([end, arm, _], beyond) = (table.evaluate(1.5), table.evaluate(1.7));
    close("beyond", &beyond, &[end + 0.2 * arm, arm, 0.0], 1e-14);
    let ([start, arm, _], before) = (table.evaluate(-0.6), table.evaluate(-0.7));
    close("before", &before, &[start - 0.1 * arm, arm, 0.0], 1e-14);
    let coupling = mixed();
    assert!(coupling.extrapolated(&[-0.7, 0.0, 0.0]).eq([(1, 0)]));
    assert_eq!(coupling.extrapolated(&[0.7, 9.0, 9.0]).count(), 0);
    let state = evaluated(&coupling, &[0.0; 2], &[0.7, 0.0, 0.0], &[0.0; 4]);
    assert_eq!(state.moment_arm_slopes()[3], table.evaluate(0.7)[2]);
}

#[test]
fn table_of_a_cubic_is_exact_from_four_rows_on() {
    let cubic = |q: f64| 0.5 + q * (2.0 + q * (-1.5 + 0.7 * q));
    for q in [vec![-1.0, -0.2, 0.5, 2.0], vec![0.3, 0.4, 1.0, 1.1, 2.5]] {
        let l: Vec<f64> = q.iter().map(|q| cubic(*q)).collect();
        let table = ShorteningTable::new(&q, &l).unwrap();
        let shift = table.evaluate(q[0])[0] - l[0];
        for x in [0.35, 0.9, 1.7] {
            let exact = [cubic(x) + shift, 2.0 + x * (-3.0 + 2.1 * x), -3.0 + 4.2 * x];
            close("cubic", &table.evaluate(x), &exact, 1e-12);
        }
        assert!(table.evaluate(0.0)[0].abs() < 1e-15, "l(0) = 0");
    }
    for (q, l, message) in [
        (
            [0.0, 1.0, 2.0, 3.0],
            &[0.0; 3][..],
            "4 positions and 3 shortenings",
        ),
        (
            [0.0, 1.0, 1.0, 2.0],
            &[0.0; 4],
            "row 2 has position 1 rad: positions must increase",
        ),
        (
            [0.0, 1.0, f64::NAN, 2.0],
            &[0.0; 4],
            "row 2 is (NaN rad, 0)",
        ),
    ] {
        let error = ShorteningTable::new(&q, l).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn strand_pair_is_the_sum_of_two_strands() {
    let upper = "strand upper 32e3 60: m 0.025 > elbow 0.025";
    let lower = "strand lower 32e3 60: m -0.025 > elbow -0.025";
    let coupling = Coupling::new(robot("elbow", "m", &[upper, lower])).unwrap();
    let torque =
        |theta: f64, delta: [f64; 2]| evaluated(&coupling, &[theta], &[0.0], &delta).tau_el()[0];
    // One strand alone grows by 1 mm: r delta_e is half of it.
    let one = [1e-3, 0.0];
    let offset = PAIR.delta_e(one);
    close(
        "half",
        &[0.025 * offset, torque(offset, one)],
        &[0.5e-3, 0.0],
        1e-12,
    );
    // Within 2 r f0' the stiffness is K, beyond it half of that.
    let delta = [0.9e-3, 0.3e-3];
    let limit = PAIR.torque_limit_nm(delta);
    close(
        "limit",
        &[limit],
        &[2.0 * 0.025 * (60.0 - 32e3 * 0.6e-3)],
        1e-12,
    );
    let edge = PAIR.delta_e(delta) + limit / PAIR.joint_stiffness_nm_per_rad();
    for (beyond, more) in [(0.0, 0.0), (-0.01, -0.4), (0.01, 0.2)] {
        close(
            "torque",
            &[torque(edge + beyond, delta)],
            &[limit + more],
            1e-11,
        );
    }
    // An elongation that both share turns no joint until the pretension is gone: then there is a dead zone.
    close("shared", &[torque(0.01, [1e-3; 2])], &[0.4], 1e-12);
    let lost = [3e-3, 2e-3];
    let (middle, half) = (PAIR.delta_e(lost), PAIR.dead_zone_rad(lost));
    close(
        "dead zone",
        &[half, PAIR.dead_zone_rad(delta)],
        &[20.0 / 800.0, 0.0],
        1e-12,
    );
    for (theta, tau) in [(0.99 * half, 0.0), (-0.99 * half, 0.0), (half + 0.01, 0.2)] {
        close("dead zone", &[torque(middle + theta, lost)], &[tau], 1e-11);
    }
}

#[test]
fn groups_have_the_equations_of_their_tendons() {
    type Change = fn(&mut CouplingDescription);
    let groups = |change: Change| {
        let mut arm = coupled_arm();
        change(&mut arm);
        Coupling::new(arm).unwrap().groups()
    };
    let joints = |groups: &[Group]| {
        groups
            .iter()
            .map(|g| g.joints().to_vec())
            .collect::<Vec<_>>()
    };
    let condition = |groups: &[Group]| match groups[0].equations() {
        Equations::Tendon { condition } => condition,
        other => panic!("{other:?}"),
    };
    let whole = groups(|_| ());
    assert_eq!(joints(&whole), [[0, 1, 2]]);
    // A rigid shoulder is part of the path only. Two unit columns with the cosine c have √((1 + c)/(1 − c)).
    let rigid = groups(|arm| arm.joints[0].is_rigid = true);
    assert_eq!(
        (joints(&rigid), rigid[0].tendons()),
        (vec![vec![1, 2]], &[1, 2][..])
    );
    let (wrist, elbow) = (9.0 * 36_f64.sqrt(), 20.0 * 50_f64.sqrt());
    let c = wrist / elbow.hypot(wrist);
    let expected = ((1.0 + c) / (1.0 - c)).sqrt();
    close("condition", &[condition(&rigid)], &[expected], 1e-12);
    // Joints that no rope connects are groups of their own.
    let split = groups(|arm| drop(arm.tendons[2].moment_arms.drain(..2)));
    assert_eq!(joints(&split), [vec![0, 1], vec![2]]);
    assert_eq!(split[1].equations(), Equations::Tendon { condition: 1.0 });
    // The condition does not depend on the coordinate.
    let in_radians = groups(|arm| {
        let (drum, arms) = (0.025, &mut arm.tendons[0]);
        arms.coordinate = Coordinate::MotorRadians { drum_m: Some(drum) };
        arms.stiffness *= drum * drum;
        arms.moment_arms[0].1 = MomentArm::Constant(1.0);
    });
    close(
        "coordinate",
        &[condition(&in_radians)],
        &[condition(&whole)],
        1e-12,
    );
    let ill: Change = |arm| {
        let over_both = arm.tendons[1].moment_arms.clone();
        arm.tendons[0].moment_arms = over_both;
        arm.tendons[1].moment_arms[0].1 = MomentArm::Constant(0.010_001);
    };
    let cases: [(Change, &str); 4] = [
        (|arm| *arm = antagonist(), "Joint(NotSquare)"),
        (
            |arm| arm.tendons[1].kind = TendonKind::Strand,
            "Joint(Strand(1))",
        ),
        (
            |arm| arm.tendons[2].moment_arms[1].1 = MomentArm::Table(rope_table()),
            "Joint(VariableMomentArm(2))",
        ),
        (ill, "Joint(IllConditioned("),
    ];
    for (change, reason) in cases {
        let found = format!("{:?}", groups(change)[0].equations());
        assert!(found.starts_with(reason), "{found}");
    }
}

#[test]
fn offsets_elongations_and_torques_convert_into_each_other() {
    // Square: R⁻¹ and back, and the elongation from the torque alone.
    let (coupling, arm_state) = at_zero(coupled_arm());
    let (theta, q, delta) = (
        [0.5, 1.1, 0.2],
        [0.45, 0.75, 0.35],
        [0.2e-3, -0.3e-3, 0.1e-3],
    );
    let arm_group = &coupling.groups()[0];
    let state = evaluated(&coupling, &theta, &q, &delta);
    let offset = coupling.joint_offset(&state, arm_group, &delta).unwrap();
    close(
        "elbow",
        &offset[..2],
        &[0.008, (-0.3e-3 - 0.01 * 0.008) / 0.02],
        1e-12,
    );
    let back = coupling
        .elongation_from_joint_offset(&state, arm_group, &offset)
        .unwrap();
    close("back", &back, &delta, 1e-12);
    let f = coupling
        .tension_from_torque(&state, arm_group, state.tau_el())
        .unwrap();
    close("tension", &f, state.tension(), 1e-12);
    let y = evaluated(&coupling, &theta, &q, &[0.0; 3]);
    let paper = [0, 1, 2].map(|i| y.extension()[i] - f[i] / [64e3, 50e3, 36e3][i]);
    close("paper's estimate", &paper, &delta, 1e-12);
    // More tendons than joints: what co-contraction loses, 1 : 1 : 2 : 4 over stiffness, is no offset.
    let (coupling, state) = at_zero(finger());
    let group = &coupling.groups()[0];
    let (lost, offset) = (
        [1.0 / 22e3, 1.0 / 22e3, 2.0 / 24e3, 4.0 / 25e3],
        [0.01, -0.02, 0.03],
    );
    let mut delta = coupling
        .elongation_from_joint_offset(&state, group, &offset)
        .unwrap();
    delta
        .iter_mut()
        .zip(lost)
        .for_each(|(delta, lost)| *delta += 3.0 * lost);
    let ours = coupling.joint_offset(&state, group, &delta).unwrap();
    close("finger", &ours, &offset, 1e-11);
    let error = coupling.tension_from_torque(&state, group, &[0.0; 3]);
    let (tendons, joints) = (4, 3);
    assert_eq!(error, Err(EvaluationError::NotSquare { tendons, joints }));
    // Fewer tendons than joints have no offset of each.
    let flexor = "loop flexor 22e3 0: m 0.005 > pip 0.007 dip 0.005";
    let (coupling, state) = at_zero(robot("pip=0.06@-0.6 dip=0.04@-0.6", "m", &[flexor]));
    let group = &coupling.groups()[0];
    let error = coupling.joint_offset(&state, group, &[1e-3]);
    assert_eq!(error, Err(EvaluationError::Singular { joint: 0 }));
    // A group or a state of another robot.
    let error = coupling
        .joint_offset(&state, arm_group, &[1e-3])
        .unwrap_err();
    assert_eq!(error.to_string(), "group.joints has 3 entries, expected 2");
    assert!(
        coupling
            .observability(&arm_state, Sensors::default())
            .is_err()
    );
}

#[test]
fn observability_finds_what_no_sensor_shows() {
    let of = |d: CouplingDescription, motor_torque: &[usize], tension: &[usize]| {
        let (coupling, state) = at_zero(d);
        let sensors = Sensors {
            motor_torque,
            tension,
        };
        let found = coupling.observability(&state, sensors).unwrap();
        (found.rank, found.unobservable)
    };
    assert_eq!(of(coupled_arm(), &[], &[]), (3, vec![]));
    // The common tension of flexor and extensor; a motor's torque or a tension sensor shows it.
    let (rank, unobservable) = of(antagonist(), &[], &[]);
    close(
        "common tension",
        &unobservable.concat(),
        &[0.5_f64.sqrt(); 2],
        1e-12,
    );
    let ranks = [
        rank,
        of(antagonist(), &[1], &[]).0,
        of(antagonist(), &[], &[0]).0,
    ];
    assert_eq!(ranks, [1, 2, 2]);
    let (rank, unobservable) = of(finger(), &[], &[]);
    let common = [1.0 / 22.0, 1.0 / 22.0, 2.0 / 24.0, 4.0 / 25.0];
    let norm = common.iter().map(|x: &f64| x * x).sum::<f64>().sqrt();
    close(
        "finger",
        &unobservable.concat(),
        &common.map(|x| x / norm),
        1e-12,
    );
    assert_eq!((rank, of(finger(), &[3], &[]).0), (3, 4));
    // The torque of a motor with two strands adds nothing.
    let mut pair = antagonist();
    pair.motors.pop();
    pair.tendons[1].drums = vec![("flexor".into(), -0.01)];
    assert_eq!(
        (of(pair.clone(), &[0], &[]).0, of(pair, &[0], &[1]).0),
        (1, 2)
    );
    // A strand that is slack in one of two positions is seen in the other.
    let (coupling, taut) = at_zero(antagonist());
    let mut slack = CouplingState::new(&coupling);
    coupling
        .evaluate(&mut slack, &[0.0; 2], &[0.0], &[0.01, 0.0])
        .unwrap();
    let of_states = |states: &[&CouplingState]| {
        let found = coupling.observability_over(states, Sensors::default());
        found.unwrap().rank
    };
    assert_eq!(of_states(&[&slack]), 1);
    assert_eq!(of_states(&[&taut, &taut]), 1);
    assert_eq!(of_states(&[&taut, &slack]), 2);
    // A rigid joint shows nothing.
    let mut rigid = antagonist();
    rigid.joints[0].is_rigid = true;
    assert_eq!(of(rigid, &[], &[]).0, 0);
}

#[test]
fn invalid_description_names_element_and_value() {
    fn spring(k: f64, rest_rad: f64) -> Option<JointSpring> {
        let stiffness_nm_per_rad = k;
        Some(JointSpring {
            stiffness_nm_per_rad,
            rest_rad,
        })
    }
    fn arm(d: &mut CouplingDescription) -> &mut (String, MomentArm) {
        &mut d.tendons[0].moment_arms[0]
    }
    const NO_DRUM: Coordinate = Coordinate::MotorRadians { drum_m: Some(0.0) };
    type Change = fn(&mut CouplingDescription);
    let cases: [(Change, &str); 17] = [
        (
            |d| d.motors[1] = "flexor".into(),
            "motor name 'flexor' is empty or occurs twice",
        ),
        (
            |d| d.joints[0].name.clear(),
            "joint name '' is empty or occurs twice",
        ),
        (
            |d| d.tendons[1].name = "flexor".into(),
            "tendon name 'flexor' is empty or occurs",
        ),
        (
            |d| d.tendons[0].drums[0].0 = "m9".into(),
            "tendon 'flexor' names motor 'm9', which",
        ),
        (
            |d| arm(d).0 = "knee".into(),
            "names joint 'knee', which does not exist; choose one of: elbow",
        ),
        (
            |d| d.tendons[0].moment_arms = vec![arm(d).clone(); 2],
            "names joint 'elbow' twice",
        ),
        (
            |d| d.tendons[1].moment_arms.clear(),
            "tendon 'extensor' crosses no joint",
        ),
        (
            |d| d.tendons[0].drums[0].1 = f64::NAN,
            "drum of motor 'flexor' of tendon 'flexor' is NaN",
        ),
        (
            |d| arm(d).1 = MomentArm::Constant(0.0),
            "at joint 'elbow' of tendon 'flexor' is 0 m/rad",
        ),
        (
            |d| d.tendons[0].stiffness = -20.0,
            "stiffness of tendon 'flexor' is -20 N/m",
        ),
        (
            |d| d.tendons[0].pretension = Some(-1.0),
            "pretension of tendon 'flexor' is -1 N",
        ),
        (
            |d| d.tendons[0].coordinate = NO_DRUM,
            "drum radius of tendon 'flexor' is 0 m: it must",
        ),
        (
            |d| d.joints[0].spring = spring(0.0, 0.0),
            "spring stiffness of joint 'elbow' is 0 N·m/rad",
        ),
        (
            |d| d.joints[0].spring = spring(1.0, 1e7),
            "rest position of the spring of joint 'elbow'",
        ),
        (
            |d| d.tendons[1].pretension = None,
            "'extensor' pulls against 'flexor' at joint 'elbow'",
        ),
        (
            |d| d.tendons[1].moment_arms = vec![("wrist".into(), arm(d).1.clone())],
            "'wrist', which",
        ),
        (
            |d| d.tendons.truncate(1),
            "all strands pull joint 'elbow' the same way",
        ),
    ];
    for (change, message) in cases {
        let mut description = antagonist();
        change(&mut description);
        let error = Coupling::new(description).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
    let error = Coupling::new(robot("wrist", "", &[])).unwrap_err();
    assert!(error.to_string().starts_with("joint 'wrist' is not driven"));
    // A spring needs no second strand, and no pretension.
    let mut one = antagonist();
    one.tendons.truncate(1);
    one.tendons[0].pretension = None;
    one.joints[0].spring = spring(0.1, -1.0);
    assert!(Coupling::new(one).is_ok());
}

#[test]
fn rejected_evaluation_keeps_the_state() {
    let coupling = mixed();
    let drums = [0.02, -0.015, 0.01, 0.0, 0.0, 0.01, 0.0, 0.0];
    assert_eq!(
        (coupling.drums(), coupling.elongation_m(1, 0.1)),
        (&drums[..], Some(0.1))
    );
    let mut state = evaluated(&coupling, &[0.1, 0.2], &[0.3, 0.1, -0.2], &[1e-3; 4]);
    let (before, zero) = (state.clone(), [0.0; 4]);
    for (m, n, tendons, message) in [
        (1, 3, 4, "theta has 1 entries, expected 2"),
        (2, 4, 4, "q has 4 entries, expected 3"),
        (2, 3, 0, "delta has 0 entries, expected 4"),
    ] {
        let found = coupling.evaluate(&mut state, &zero[..m], &zero[..n], &zero[..tendons]);
        assert_eq!(found.unwrap_err().to_string(), message);
    }
    for bad in [f64::NAN, f64::NEG_INFINITY, 1e61] {
        let found = coupling.evaluate(&mut state, &zero[..2], &[0.0, bad, 0.0], &zero);
        assert_eq!(found, Err(EvaluationError::NotFinite { input: "q" }));
    }
    let other = Coupling::new(antagonist()).unwrap();
    assert!(
        other
            .evaluate(&mut state, &zero[..2], &zero[..1], &zero[..2])
            .is_err()
    );
    assert_eq!(state, before);
    let mut out = [1.0; 8];
    assert!(coupling.joint_stiffness(&state, &mut out).is_err());
    assert_eq!(out, [1.0; 8]);
}
