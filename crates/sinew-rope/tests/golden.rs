//! Golden test of the rope creep law: two ropes under constant load, ramps, heat and constant length.

use crate::answers::Answers;
use crate::rope_reference::{aramid, sk99};
use sinew_rope::law::strung::{RELAXATION_TOLERANCE, Strand, StrandAssembly};
use sinew_rope::law::{Law, Parameters, REFERENCE_K, RopeLoad, State, ramp};

const DAY_S: f64 = 86_400.0;
/// Tension over breaking load, temperature above the reference (K), duration (s), whether it is a ramp.
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

fn record(law: &Law, state: &State, load: RopeLoad, answers: &mut Answers) {
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
    for (k, (share, temperature_difference_k, lasts_s, is_ramp)) in HISTORY.into_iter().enumerate()
    {
        let to = RopeLoad {
            tension_n: share * parameters.breaking_load_n,
            temperature_k: REFERENCE_K + temperature_difference_k,
        };
        match is_ramp {
            true => ramp(&law, &mut state, load, to, lasts_s),
            false => law.hold(&mut state, to, lasts_s),
        }
        .expect("a load");
        load = to;
        answers.about(&format!("{name}, after {k},"));
        record(&law, &state, load, answers);
    }
}

/// Relaxation immediately, or after two minutes at constant tension.
fn left(
    name: &str,
    parameters: Parameters,
    (temperature_difference_k, held_s): (f64, f64),
    answers: &mut Answers,
) {
    let law = Law::new(parameters).expect("a rope");
    let strand = |length_m: f64, extra_n: f64| Strand {
        extra_n,
        series_compliance_m_per_n: 2e-6,
        ..Strand::straight(law, length_m, State::default())
    };
    let strands = vec![strand(0.7, 0.0), strand(0.5, 40.0)];
    let tension_n = 0.08 * parameters.breaking_load_n;
    let strung = StrandAssembly::new(
        strands,
        tension_n,
        REFERENCE_K + temperature_difference_k,
        held_s,
    );
    let mut strung = strung.expect("a load");
    for (k, days) in [0.01, 1.0, 30.0, 300.0].into_iter().enumerate() {
        let left = strung.leave(days * DAY_S, None, RELAXATION_TOLERANCE, |_, _| {});
        left.expect("a load");
        if k == 2 {
            strung.tension_again(tension_n, 60.0).expect("a load");
        }
        answers.about(&format!(
            "{name} left at {temperature_difference_k} K after {held_s} s, {k},"
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
fn creep_law_matches_golden() {
    let mut answers = Answers::default();
    held("sk99", sk99(), 0.0, &mut answers);
    held("sk99 over guides", sk99(), 2.0, &mut answers);
    held("aramid", aramid(), 0.0, &mut answers);
    for how in [(0.0, 120.0), (30.0, 120.0), (30.0, 0.0)] {
        left("sk99", sk99(), how, &mut answers);
        left("aramid", aramid(), how, &mut answers);
    }
    answers.hold("golden.csv");
}
