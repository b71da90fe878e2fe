//! What the rope law says of two ropes that are held, ramped, warmed and left at one length, number by number.

use crate::answers::Answers;
use crate::rope_reference::{aramid, sk99};
use sinew_rope::law::strung::{RELAXATION_TOLERANCE, Strand, Strung};
use sinew_rope::law::{Law, Parameters, REFERENCE_K, RopeLoad, State, ramp};

const DAY_S: f64 = 86_400.0;
/// Tension over the breaking load, temperature less that of reference (K), how long, and whether it gets there by a ramp.
const HISTORY: [(f64, f64, f64, bool); 9] = [
    (0.02, 0.0, 600.0, false),
    (0.10, 0.0, 300.0, true),
    (0.10, 25.0, 7200.0, false),
    (0.30, 25.0, 60.0, true),
    (0.05, 10.0, 900.0, true),
    (0.00, 0.0, DAY_S, false),
    (0.00, 40.0, 3600.0, true),
    (0.18, -10.0, 5.0, true),
    (0.18, -10.0, 20.0 * DAY_S, false),
];

fn say(law: &Law, state: &State, load: RopeLoad, answers: &mut Answers) {
    let strain = law.strain(state, load).expect("a load");
    answers.number("elastic", strain.elastic_percent);
    answers.number("bedding", strain.bedding_percent);
    answers.number("delayed", strain.delayed_percent);
    for (k, percent) in state.delayed_percent.iter().enumerate() {
        answers.number(&format!("delayed {k}"), *percent);
    }
    answers.number("flow", strain.flow_percent);
    answers.number("retraction", state.retraction_percent);
    answers.number("retraction kept", state.retraction_kept_percent);
    answers.number("thermal", strain.thermal_percent);
    let gives = law.compliance_percent_per_n(load).expect("a load");
    answers.number("gives", gives);
}

fn held(name: &str, parameters: Parameters, guides: f64, answers: &mut Answers) {
    let law = Law::new(parameters).expect("a rope").passed_by(guides);
    let (mut state, mut load) = (State::default(), RopeLoad::at_reference(0.0));
    for (k, (share, warmer_k, lasts_s, is_ramp)) in HISTORY.into_iter().enumerate() {
        let to = RopeLoad {
            tension_n: share * parameters.breaking_load_n,
            temperature_k: REFERENCE_K + warmer_k,
        };
        match is_ramp {
            true => ramp(&law, &mut state, load, to, lasts_s),
            false => law.hold(&mut state, to, lasts_s),
        }
        .expect("a load");
        load = to;
        answers.about(&format!("{name}, after {k},"));
        say(&law, &state, load, answers);
    }
}

/// At once, or after it was held at its tension for two minutes.
fn left(name: &str, parameters: Parameters, (warmer_k, held_s): (f64, f64), answers: &mut Answers) {
    let law = Law::new(parameters).expect("a rope");
    let strand = |length_m: f64, extra_n: f64| Strand {
        extra_n,
        give_m_per_n: 2e-6,
        ..Strand::straight(law, length_m, State::default())
    };
    let strands = vec![strand(0.7, 0.0), strand(0.5, 40.0)];
    let tension_n = 0.08 * parameters.breaking_load_n;
    let strung = Strung::new(strands, tension_n, REFERENCE_K + warmer_k, held_s);
    let mut strung = strung.expect("a load");
    for (k, days) in [0.01, 1.0, 30.0, 300.0].into_iter().enumerate() {
        let left = strung.leave(days * DAY_S, None, RELAXATION_TOLERANCE, |_, _| {});
        left.expect("a load");
        if k == 2 {
            strung.tension_again(tension_n, 60.0).expect("a load");
        }
        answers.about(&format!(
            "{name} left at {warmer_k} K after {held_s} s, {k},"
        ));
        answers.number("tension", strung.tension_n());
        answers.number("sag", strung.sag_m());
        for strand in strung.strands() {
            let state = &strand.pieces[0].state;
            answers.number("bedding", state.bedding_percent);
            answers.number("flow", state.flow_percent);
            answers.number("retraction", state.retraction_percent);
            answers.number("delayed", state.delayed_percent.iter().sum());
        }
    }
}

#[test]
fn what_ropes_do_is_what_they_did() {
    let mut answers = Answers::default();
    held("sk99", sk99(), 0.0, &mut answers);
    held("sk99 over guides", sk99(), 2.0, &mut answers);
    held("aramid", aramid(), 0.0, &mut answers);
    for how in [(0.0, 120.0), (30.0, 120.0), (30.0, 0.0)] {
        left("sk99", sk99(), how, &mut answers);
        left("aramid", aramid(), how, &mut answers);
    }
    answers.hold("known_rope.csv");
}
