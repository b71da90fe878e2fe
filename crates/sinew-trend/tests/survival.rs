//! Lifetimes of ropes from tables of ropes and of events.

use sinew_files::JsonDocument as _;
use sinew_files::date::{day_of, parse_utc_s};
use sinew_report::trend::survival::{format_note, html, render_table};
use sinew_trend::survival::{
    AgeUnit, EventColumns, LifeEnd, LifePrior, ReplacementVerdict, SurvivalNote, SurvivalReport,
    analyze_lives, read_lives,
};
use std::path::PathBuf;

/// Writes a table to a temporary folder.
fn table(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("events.csv");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

const EVENTS: &str = "date,unit,kind,event\n\
    2024-01-01,a,lift,installed\n\
    2024-04-10,a,lift,broken (crimp let go)\n\
    2024-05-01,a,lift,loose; tensioned again\n\
    2024-07-19,a,lift,replaced at the service\n\
    2024-02-01,b,reach,broken\n\
    2024-02-01,b,reach,torn again on the same day\n\
    2024-03-02,c,reach,installed\n\
    2024-12-31,c,reach,almost torn\n\
    2024-11-01,d,lift,installed\n\
    2024-11-11,d,lift,retired\n";

#[test]
fn events_at_locations_are_rope_lifetimes() {
    let (_folder, path) = table(EVENTS);
    let lives = read_lives(&path, &EventColumns::default()).unwrap();
    assert_eq!(lives.age_unit, AgeUnit::Seconds);
    let found: Vec<(&str, f64, LifeEnd)> = (lives.lives.iter())
        .map(|l| (l.unit.as_str(), l.age / 86_400.0, l.end))
        .collect();
    assert_eq!(
        found,
        [
            ("a", 100.0, LifeEnd::Broke),
            ("a", 100.0, LifeEnd::Replaced),
            ("a", 165.0, LifeEnd::Whole),
            ("b", 0.5, LifeEnd::Broke),
            ("c", 304.0, LifeEnd::Whole),
            ("d", 10.0, LifeEnd::Replaced),
        ]
    );
    assert!(
        lives
            .notes
            .contains(&SurvivalNote::AgeUnknown { breaks: 1 })
    );
    assert!(lives.notes.contains(&SurvivalNote::SameDay { ropes: 1 }));
    let without = SurvivalNote::NoNewRope { places: 1 };
    assert!(lives.notes.contains(&without), "{:?}", lives.notes);
    let notes: Vec<String> = lives.notes.iter().map(format_note).collect();
    for words in [
        "half a day",
        "loose; tensioned again",
        "2024-12-31",
        "first failure",
    ] {
        assert!(
            notes.iter().any(|n| n.contains(words)),
            "{words}: {notes:?}"
        );
    }
    // Observed until the last event of the same kind, or until a day.
    let of = |columns: EventColumns| read_lives(&path, &columns).unwrap().lives[2].age / 86_400.0;
    let by_kind = EventColumns {
        monitored: Some("kind".into()),
        ..EventColumns::default()
    };
    assert_eq!(of(by_kind), 115.0);
    let until = EventColumns {
        until_utc_s: Some(1_735_689_600.0 + 86_400.0),
        ..EventColumns::default()
    };
    assert_eq!(of(until), 167.0);
}

#[test]
fn rope_table_is_read_in_days_hours_and_cycles() {
    for (column, factor) in [
        ("age_days", 86_400.0),
        ("age_hours", 3600.0),
        ("age_cycles", 1.0),
    ] {
        let (_folder, path) = table(&format!("{column},end,group\n10,broken,x\n12.5,Running,\n"));
        let columns = EventColumns {
            group: Some("group".into()),
            ..EventColumns::default()
        };
        let lives = read_lives(&path, &columns).unwrap();
        assert_eq!(lives.lives[1].age, 12.5 * factor);
        assert_eq!(lives.lives[1].end, LifeEnd::Whole);
        assert_eq!(lives.lives[0].group.as_deref(), Some("x"));
    }
}

#[test]
fn invalid_tables_are_rejected_with_location_and_fix() {
    let refused = |text: &str, columns: &EventColumns, words: &[&str]| {
        let (_folder, path) = table(text);
        let error = read_lives(&path, columns).unwrap_err().to_string();
        for word in words.iter().chain(&["events.csv"]) {
            assert!(error.contains(word), "{word}: {error}");
        }
    };
    let plain = EventColumns::default();
    refused(
        "date,unit,event\nspring,a,broken\n",
        &plain,
        &["line 2", "not a date", "spring"],
    );
    refused(
        "day,unit,event\n2024-01-01,a,broken\n",
        &plain,
        &["date", "--date"],
    );
    refused(
        "date,robot,event\n2024-01-01,a,broken\n",
        &plain,
        &["unit", "--unit"],
    );
    refused(
        "date,unit,what\n2024-01-01,a,broken\n",
        &plain,
        &["event", "--event"],
    );
    refused(
        "date,unit,event\n2024-01-01,a,broken\n",
        &plain,
        &["installed", "age_days"],
    );
    refused(
        "age_days,end\n-3,broken\n",
        &plain,
        &["line 2", "age_days", "above 0"],
    );
    refused(
        "age_days,end\n3,gone\n",
        &plain,
        &["line 2", "broken, replaced"],
    );
    refused("age_days,end\n,broken\n", &plain, &["line 2", "age_days"]);
    let until = EventColumns {
        until_utc_s: Some(1_672_531_200.0),
        ..plain
    };
    refused(
        EVENTS,
        &until,
        &["2023-01-01", "after the end of observation"],
    );
}

/// Table of ages at which ropes of a Weibull law break, at its quantiles; every fourth is replaced
/// at 0.7 of it.
fn ropes(shape: f64, count: usize) -> String {
    let mut text = String::from("age_days,end\n");
    for i in 0..count {
        let share = (i as f64 + 0.5) / count as f64;
        let age = 200.0 * (-(1.0 - share).ln()).powf(1.0 / shape);
        let (age, end) = match i % 4 {
            3 => (0.7 * age, "replaced"),
            _ => (age, "broken"),
        };
        text.push_str(&format!("{age},{end}\n"));
    }
    text
}

#[test]
fn age_dependence_of_breaks_is_classified() {
    for (text, verdict, words) in [
        (
            ropes(2.5, 40),
            ReplacementVerdict::Helps,
            "preventive replacement reduces failures; 10 % failed by",
        ),
        (
            ropes(0.5, 40),
            ReplacementVerdict::DoesNotHelp,
            "preventive replacement does not help",
        ),
        (
            ropes(1.0, 20),
            ReplacementVerdict::Inconclusive,
            "no age of replacement",
        ),
        (
            "age_days,end\n5,running\n9,running\n".into(),
            ReplacementVerdict::Inconclusive,
            "too few",
        ),
        // Two of four: P(shape > 1) is 0.827 by a double integral, see the test of sinew-rope.
        (
            "age_days,end\n300,broken\n340,broken\n250,running\n305,running\n".into(),
            ReplacementVerdict::Inconclusive,
            "probability of 0.83, a verdict needs 95 %",
        ),
    ] {
        let (_folder, path) = table(&text);
        let lives = read_lives(&path, &EventColumns::default()).unwrap();
        let report = analyze_lives(&lives, "ropes.csv");
        let [group] = report.groups.as_slice() else {
            panic!("{:?}", report.groups);
        };
        let found = group.replacement;
        assert_eq!(found.verdict, verdict, "{group:?}");
        let helps = verdict == ReplacementVerdict::Helps;
        assert_eq!(found.age.is_some(), helps, "{found:?}");
        assert!(found.further_failures.is_none() || !helps, "{found:?}");
        let shown = render_table(&report);
        let one_line = shown.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(one_line.contains(words), "{shown}");
        assert!(shown.lines().all(|l| l.chars().count() <= 80), "{shown}");
        let page = html(&report);
        assert!(
            page.contains("<svg") && !page.contains("NaN"),
            "{verdict:?}"
        );
        // Results are data: deserialisation restores them.
        let read: SurvivalReport = serde_json::from_str(&report.to_json().unwrap()).unwrap();
        assert_eq!(read.groups.len(), 1);
    }
}

#[test]
fn groups_are_separate_and_poor_fit_is_reported() {
    // Half break within a week, half after 300 days.
    let mut text = String::from("age_days,end,kind\n");
    for i in 0..30 {
        text.push_str(&format!("{},broken,early\n", 3.0 + 0.2 * f64::from(i)));
        text.push_str(&format!("{},broken,late\n", 300.0 + 3.0 * f64::from(i)));
    }
    let (_folder, path) = table(&text);
    let columns = EventColumns {
        group: Some("kind".into()),
        ..EventColumns::default()
    };
    let report = analyze_lives(&read_lives(&path, &columns).unwrap(), "ropes.csv");
    let names: Vec<Option<&str>> = report.groups.iter().map(|g| g.name.as_deref()).collect();
    assert_eq!(names, [None, Some("early"), Some("late")]);
    assert_eq!(report.groups[0].ropes, 60);
    assert!(report.groups[0].weibull.as_ref().unwrap().outside_band > 5);
    assert!(render_table(&report).contains("outside the 95 % band"));
    let late = &report.groups[2];
    assert_eq!(late.replacement.verdict, ReplacementVerdict::Helps);
    assert!(
        (late.median.age.unwrap() / 86_400.0 - 342.0).abs() < 4.0,
        "{:?}",
        late.median
    );
}

#[test]
fn negated_or_partial_words_end_no_lifetime() {
    let spared = [
        "not broken",
        "it isn't broken",
        "still not broken",
        "unbroken",
        "nothing tore",
        "tension restored",
        "almost snapped",
        "not replaced",
    ];
    for words in spared {
        let (_folder, path) = table(&format!(
            "date,unit,event\n2024-01-01,a,installed\n2024-02-01,a,{words}\n2024-03-01,a,seen\n"
        ));
        let lives = read_lives(&path, &EventColumns::default()).unwrap().lives;
        let found: Vec<_> = lives.iter().map(|l| (l.age / 86_400.0, l.end)).collect();
        assert_eq!(found, [(60.0, LifeEnd::Whole)], "{words}");
    }
    // Breaks of other parts are listed in a note.
    let (_folder, path) = table(
        "date,unit,event\n2024-01-01,a,installed\n2024-02-01,a,housing broken\n2024-03-01,a,broken\n",
    );
    let notes = read_lives(&path, &EventColumns::default()).unwrap().notes;
    assert!(notes.contains(&SurvivalNote::TakenForBroken {
        events: 1,
        words: vec!["housing broken".into()],
    }));
}

// A break and the new installation are on one day in most logs, in either order.
#[test]
fn break_and_installation_on_one_day_are_separate_lifetimes() {
    let ends = |text: &str| {
        let (_folder, path) = table(&format!("date,unit,event\n{text}"));
        let lives = read_lives(&path, &EventColumns::default()).unwrap().lives;
        let days = lives.iter().map(|l| (l.age / 86_400.0, l.end));
        days.collect::<Vec<_>>()
    };
    let expected = [(335.0, LifeEnd::Broke), (31.0, LifeEnd::Whole)];
    for day in [
        "2024-12-01,a,broken\n2024-12-01,a,installed\n",
        "2024-12-01,a,installed\n2024-12-01,a,broken\n",
        "2024-12-01,a,broken\n2024-12-01,a,replaced\n",
    ] {
        let text = format!("2024-01-01,a,installed\n{day}2025-01-01,a,seen\n");
        assert_eq!(ends(&text), expected, "{day}");
    }
    // First row of a log: a rope of unknown age broke, and another was installed. The latter did
    // not break on that day.
    let text = "2024-12-01,a,broken\n2024-12-01,a,installed\n2025-01-01,a,seen\n";
    assert_eq!(ends(text), [(31.0, LifeEnd::Whole)]);
    let text = "2024-12-01,a,installed\n2024-12-01,a,broken\n2025-01-01,z,seen\n";
    assert_eq!(ends(text), [(0.5, LifeEnd::Broke)]);
    // Without a rope for 19 days: no lifetime.
    let text =
        "2024-01-01,a,installed\n2024-06-01,a,broken\n2024-06-20,a,installed\n2024-07-20,a,seen\n";
    assert_eq!(
        ends(text),
        [(152.0, LifeEnd::Broke), (30.0, LifeEnd::Whole)]
    );
}

// Between a break and the end of observation there may have been no rope at all: a lifetime that
// did not exist makes ropes look stronger than they are.
#[test]
fn location_without_new_rope_is_censored_at_break() {
    let of = |events: &str| {
        let (_folder, path) = table(&format!(
            "date,unit,event\n2024-01-01,a,installed\n{events}2025-01-01,z,seen\n"
        ));
        let lives = read_lives(&path, &EventColumns::default()).unwrap();
        let out = lives.notes.iter().find_map(|note| match note {
            SurvivalNote::NoNewRope { places } => Some(*places),
            _ => None,
        });
        let days = lives.lives.iter().map(|l| (l.age / 86_400.0, l.end));
        (days.collect::<Vec<_>>(), out)
    };
    let broke = (31.0, LifeEnd::Broke);
    assert_eq!(of("2024-02-01,a,broken\n"), (vec![broke], Some(1)));
    // Another one was installed, as recorded.
    let installed = "2024-02-01,a,broken\n2024-02-11,a,installed\n";
    let whole = (325.0, LifeEnd::Whole);
    assert_eq!(of(installed), (vec![broke, whole], None));
    // Not recorded, but there was one to be tensioned: intact until then.
    let seen = "2024-02-01,a,broken\n2024-02-21,a,tensioned again\n";
    assert_eq!(of(seen), (vec![broke, (20.0, LifeEnd::Whole)], None));
    // A rope that broke again was installed; since then there is none.
    let again = "2024-02-01,a,broken\n2024-03-02,a,broken\n";
    assert_eq!(of(again), (vec![broke, (30.0, LifeEnd::Broke)], Some(1)));
}

// If every break was repaired, a log of breaks contains only the short lifetimes: those that ended
// by another break. Ropes that were installed and lasted must count, or ropes look weaker than they
// are.
#[test]
fn repaired_ropes_count_as_censored_lifetimes() {
    const MEAN_DAYS: f64 = 1000.0;
    let begin = parse_utc_s("2024-01-01").unwrap();
    // Quantiles of lifetimes with a constant hazard, at a hundred locations.
    let mut rows = String::from("date,unit,event\n");
    for place in 0..100 {
        let life_days = -MEAN_DAYS * (1.0 - (f64::from(place) + 0.5) / 100.0).ln();
        rows.push_str(&format!("2024-01-01,p{place},broken\n"));
        if life_days < 500.0 {
            let day = day_of(begin + 86_400.0 * life_days.round());
            rows.push_str(&format!("{day},p{place},broken\n"));
        }
    }
    let (_folder, path) = table(&rows);
    let law = |repaired: bool| {
        let columns = EventColumns {
            until_utc_s: parse_utc_s("2025-05-15"),
            repaired,
            ..EventColumns::default()
        };
        let report = analyze_lives(&read_lives(&path, &columns).unwrap(), "log");
        let law = report.groups[0].weibull.clone().unwrap();
        law.scale_interval_95.map(|s| s.unwrap() / 86_400.0)
    };
    let ([low, high], seen) = (law(true), law(false));
    assert!((low..high).contains(&MEAN_DAYS), "{low} {high}");
    assert!(seen[1] < MEAN_DAYS, "{seen:?}");
}

#[test]
fn missing_column_and_early_breaks_are_rejected() {
    let (_folder, path) = table(EVENTS);
    let odd = EventColumns {
        group: Some("kindd".into()),
        ..EventColumns::default()
    };
    let reason = read_lives(&path, &odd).unwrap_err().to_string();
    assert!(
        reason.contains("'kindd'") && reason.contains("--group"),
        "{reason}"
    );
    let mut early = String::from("age_days,end\n");
    for i in 0..20 {
        early += &format!("{},broken\n700,running\n", 1.0 + f64::from(i * i) / 10.0);
    }
    let (_folder, path) = table(&early);
    let lives = read_lives(&path, &EventColumns::default()).unwrap();
    let report = analyze_lives(&lives, "early");
    let verdict = report.groups[0].replacement.verdict;
    assert_eq!(verdict, ReplacementVerdict::DoesNotHelp);
    let reason = LifePrior::new(&lives, "early", 0.1, 1)
        .unwrap_err()
        .to_string();
    assert!(reason.contains("no reason for replacement"), "{reason}");
    // Two breaks in four lives give no age of replacement.
    let (_folder, path) = table("age_days,end\n300,broken\n340,broken\n250,running\n305,running\n");
    let lives = read_lives(&path, &EventColumns::default()).unwrap();
    let reason = LifePrior::new(&lives, "few", 0.1, 1)
        .unwrap_err()
        .to_string();
    assert!(reason.contains("without further failures"), "{reason}");
}
