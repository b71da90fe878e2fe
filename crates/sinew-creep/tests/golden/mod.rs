//! Golden test: complete reports of simulated creep tests, compared exactly.

mod benches;
mod flat;

use crate::answers::Answers;
use crate::plan::{request, test};
use crate::support::bench::{COLD, SIGMA, base, options, records};
use crate::support::laws::times;
use flat::document;
use sinew_creep::*;

/// Analysis of simulated bench records.
fn analysed(keep_artefacts: bool, analyze: AnalyzeOptions) -> Tests {
    let specimens = benches::specimens();
    let request = AnalyzeRequest {
        prepare: PrepareOptions {
            gauge_length_m: Some(0.35),
            area_m2: Some(2e-6),
            temperature_c: Some(21.0),
            keep_artefacts,
        },
        analyze,
        group_by: vec!["colour".into()],
    };
    let source = Source {
        file: "made.csv".into(),
        sha256: "abc".into(),
        columns: Vec::new(),
        notes: Vec::new(),
    };
    analyze_tests(vec![source], &specimens, &request, |_, _| {}).unwrap()
}

/// Subset of the tests, selected by name.
fn few(tests: &Tests, names: &[&str]) -> Tests {
    let mut few = tests.clone();
    few.prepared.retain(|p| names.contains(&p.name.as_str()));
    few.analyses.retain(|a| names.contains(&a.name.as_str()));
    few
}

#[test]
fn analysis_matches_golden() {
    let mut answers = Answers::default();
    let others = AnalyzeOptions {
        level: 0.8,
        seed: 7,
        slope_from_s: 500.0,
    };
    let kept = analysed(true, others);
    document(
        &mut answers,
        "kept",
        &few(&kept, &["A", "B"]).report(Conditions::default()),
    );
    let tests = analysed(false, AnalyzeOptions::default());
    document(&mut answers, "report", &tests.report(Conditions::default()));
    for prepared in &tests.prepared {
        answers.about(&prepared.name);
        let curve = &prepared.curve;
        answers.number("zero of", curve.zero_count);
        for (time_s, level) in &curve.steps {
            answers.number("step at", *time_s);
            answers.number("to", *level);
        }
        for window in &curve.windows {
            answers.number("from", window.from_s);
            answers.number("until", window.to_s);
        }
        let Some(tension) = curve.tension else {
            continue;
        };
        answers.number("preload", tension.preload_n);
        answers.number("a step", tension.per_step_n);
        answers.number("preloaded", tension.preloaded_s);
    }
    for scatter in [None, Some(0.07)] {
        document(&mut answers, "compared", &compare(&tests, scatter));
    }
    let shifted = shift(Vec::new(), &benches::isotherms(), 24.0).unwrap();
    document(&mut answers, "shifted", &shifted);
    answers.hold("golden_analysis.csv");
}

fn ask(laws: &[Law], joint: Joint, kind: IntervalKind, until: Option<(f64, f64)>) -> FitRequest {
    FitRequest {
        laws: laws.to_vec(),
        joint,
        options: FitOptions {
            kind,
            ..FitOptions::default()
        },
        forecast: until.map(|(until_s, load_n)| ForecastRequest {
            until_s,
            load_n: (load_n > 0.0).then_some(load_n),
            temperature_c: None,
        }),
    }
}

// Findley's law generated these records; fits of other laws depend on the last digit of the
// measurements.
#[test]
fn fits_match_golden() {
    let mut answers = Answers::default();
    let tests = analysed(false, AnalyzeOptions::default());
    let findley = [Law::Findley];
    for (about, of, joint, kind, until) in [
        (
            "alone",
            &["A", "B"],
            Joint::None,
            IntervalKind::Draws,
            (1e6, 0.0),
        ),
        (
            "group",
            &["A", "B"],
            Joint::Group,
            IntervalKind::Bootstrap,
            (3e5, 0.0),
        ),
        (
            "group of loads",
            &["C", "D"],
            Joint::Group,
            IntervalKind::Draws,
            (3e5, 100.0),
        ),
        (
            "shape",
            &["C", "D"],
            Joint::Shape,
            IntervalKind::Profile,
            (1e5, 0.0),
        ),
    ] {
        let asked = ask(&findley, joint, kind, Some(until));
        let report = fit_tests(&few(&tests, of), &asked, |_, _, _| {});
        document(&mut answers, about, &report);
    }
    answers.hold("golden_fits.csv");
}

// Each law fitted to the record it generated, alone and forecast from its first half.
#[test]
fn laws_on_own_records_match_golden() {
    let mut answers = Answers::default();
    for (law, curve) in benches::laws() {
        let options = |kind, noise| FitOptions {
            kind,
            noise,
            ..FitOptions::default()
        };
        let kinds = [
            (IntervalKind::Draws, NoiseKind::Correlated),
            (IntervalKind::Profile, NoiseKind::White),
            (IntervalKind::Bootstrap, NoiseKind::White),
        ];
        for (kind, noise) in kinds {
            let found = fit(law, std::slice::from_ref(&curve), &options(kind, noise)).unwrap();
            document(&mut answers, &format!("{} {kind:?}", law.name()), &found);
            let strain = found.strain(0, &times(9, 9000.0));
            document(&mut answers, &format!("{} strain", law.name()), &strain);
        }
        let options = options(IntervalKind::Draws, NoiseKind::White);
        let later = [7e3, 2e4, 1e6];
        let outlook = ForecastSet::new(&[law], &[curve], 0, &options, &later);
        answers.about(&format!("{} later", law.name()));
        answers.number("widened", outlook.widened);
        answers.number("backtests", outlook.backtests as f64);
        document(
            &mut answers,
            &format!("{} later", law.name()),
            &outlook.combined,
        );
    }
    answers.hold("golden_laws.csv");
}

#[test]
fn rope_law_matches_golden() {
    let mut answers = Answers::default();
    let found = fit(Law::Rope, &records(&COLD, SIGMA, 7), &options(7)).unwrap();
    document(&mut answers, "rope", &found);
    let source = EntrySource {
        name: "mine".into(),
        data: "made".into(),
        date: "2026-11-27".into(),
    };
    let entry = rope_entry(&found, &base(), &source).unwrap();
    for (parameter, value) in &entry.law {
        answers.about(&format!("entry {parameter:?} {:?}", value.origin));
        answers.number("value", value.value);
        answers.number("aside", value.at(1.0));
    }
    document(
        &mut answers,
        "correlation",
        &entry.correlation.unwrap().matrix,
    );
    for curve in 0..2 {
        let strain = found.strain(curve, &times(12, 8000.0));
        document(&mut answers, &format!("strain {curve}"), &strain);
    }
    answers.hold("golden_rope_fit.csv");
}

#[test]
fn plan_matches_golden() {
    let mut answers = Answers::default();
    let candidates = vec![
        test(100.0, 23.0, 5100.0),
        test(100.0, 45.0, 20_000.0),
        test(250.0, 23.0, 5100.0),
    ];
    let asked = PlanRequest {
        tests: 2,
        existing: records(&COLD[..1], SIGMA, 3),
        truths: 3,
        ..request(80.0, 30.0, candidates)
    };
    let planned = plan(&asked, |_, _| {}).unwrap();
    document(&mut answers, "plan", &planned);
    answers.hold("golden_plan.csv");
}
