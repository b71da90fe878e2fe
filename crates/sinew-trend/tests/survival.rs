//! Lives of ropes from tables of ropes and of events.

use sinew_files::JsonDocument as _;
use sinew_files::date::{day_of, parse_utc_s};
use sinew_report::trend::survival::{format_note, html, render_table};
use sinew_trend::survival::{
    AgeUnit, EventColumns, LifeEnd, LifePrior, SurvivalNote, SurvivalReport, Wear, analyze_lives,
    read_lives,
};
use std::path::PathBuf;

/// A table in a folder of its own.
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
fn events_at_places_are_lives_of_ropes() {
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
        "first breaks",
    ] {
        assert!(
            notes.iter().any(|n| n.contains(words)),
            "{words}: {notes:?}"
        );
    }
    // Watched until the last event of the same kind, or until a day.
    let of = |columns: EventColumns| read_lives(&path, &columns).unwrap().lives[2].age / 86_400.0;
    let by_kind = EventColumns {
        watched: Some("kind".into()),
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
fn a_row_a_rope_is_read_in_days_hours_and_cycles() {
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
fn wrong_tables_are_refused_with_the_place_and_the_cure() {
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
        &["line 2", "no date", "spring"],
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
        &["2023-01-01", "after the end of the watch"],
    );
}

/// Ages at which ropes of a Weibull law break, evenly over its quantiles; every fourth is replaced at 0.7 of it.
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
fn what_age_says_is_told_apart() {
    for (text, wear, words) in [
        (ropes(2.5, 40), Wear::WearsOut, "replacing in time helps"),
        (ropes(0.5, 40), Wear::BreaksEarly, "better than a new one"),
        (ropes(1.0, 20), Wear::AgeSaysNothing, "as good as a new one"),
        (
            "age_days,end\n5,broken\n9,running\n".into(),
            Wear::CannotTell,
            "too few",
        ),
    ] {
        let (_folder, path) = table(&text);
        let lives = read_lives(&path, &EventColumns::default()).unwrap();
        let report = analyze_lives(&lives, "ropes.csv");
        let [group] = report.groups.as_slice() else {
            panic!("{:?}", report.groups);
        };
        assert_eq!(group.wear, wear, "{group:?}");
        let shown = render_table(&report);
        let one_line = shown.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(one_line.contains(words), "{shown}");
        assert!(shown.lines().all(|l| l.chars().count() <= 80), "{shown}");
        let page = html(&report);
        assert!(page.contains("<svg") && !page.contains("NaN"), "{wear:?}");
        // Results are data: they are read as they were written.
        let read: SurvivalReport = serde_json::from_str(&report.to_json().unwrap()).unwrap();
        assert_eq!(read.groups.len(), 1);
    }
}

#[test]
fn groups_are_counted_apart_and_a_law_that_does_not_fit_says_so() {
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
    assert!(render_table(&report).contains("leaves the curve's band"));
    let late = &report.groups[2];
    assert_eq!(late.wear, Wear::WearsOut);
    assert!(
        (late.median.age.unwrap() / 86_400.0 - 342.0).abs() < 4.0,
        "{:?}",
        late.median
    );
}

#[test]
fn a_word_that_is_denied_or_part_of_another_ends_no_life() {
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
    // What else may have broken is read aloud.
    let (_folder, path) = table(
        "date,unit,event\n2024-01-01,a,installed\n2024-02-01,a,housing broken\n2024-03-01,a,broken\n",
    );
    let notes = read_lives(&path, &EventColumns::default()).unwrap().notes;
    assert!(notes.contains(&SurvivalNote::TakenForBroken {
        events: 1,
        words: vec!["housing broken".into()],
    }));
}

/// A break and the rope that was put in for it stand on one day in most logs, in either order.
#[test]
fn a_break_and_its_new_rope_on_one_day_are_one_life_each() {
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
    // The first row of a log: a rope of unknown age broke, and another was put in. It didn't break on that day.
    let text = "2024-12-01,a,broken\n2024-12-01,a,installed\n2025-01-01,a,seen\n";
    assert_eq!(ends(text), [(31.0, LifeEnd::Whole)]);
    let text = "2024-12-01,a,installed\n2024-12-01,a,broken\n2025-01-01,z,seen\n";
    assert_eq!(ends(text), [(0.5, LifeEnd::Broke)]);
    // It stood without a rope for 19 days: that is no life.
    let text =
        "2024-01-01,a,installed\n2024-06-01,a,broken\n2024-06-20,a,installed\n2024-07-20,a,seen\n";
    assert_eq!(
        ends(text),
        [(152.0, LifeEnd::Broke), (30.0, LifeEnd::Whole)]
    );
}

/// Between a break and the end of the watch there may have been no rope at all: a life that nobody lived makes ropes look
/// stronger than they are.
#[test]
fn a_place_that_got_no_new_rope_is_out_of_observation_from_the_break_on() {
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
    // Another was put in, as is said.
    let installed = "2024-02-01,a,broken\n2024-02-11,a,installed\n";
    let whole = (325.0, LifeEnd::Whole);
    assert_eq!(of(installed), (vec![broke, whole], None));
    // Nobody says so, but there was one to be tensioned: whole until then.
    let seen = "2024-02-01,a,broken\n2024-02-21,a,tensioned again\n";
    assert_eq!(of(seen), (vec![broke, (20.0, LifeEnd::Whole)], None));
    // One that broke again was there; since then there is none.
    let again = "2024-02-01,a,broken\n2024-03-02,a,broken\n";
    assert_eq!(of(again), (vec![broke, (30.0, LifeEnd::Broke)], Some(1)));
}

/// Where every break was repaired, a log of breaks has the short lives only: those that ended by another break. Ropes that were
/// put in and lasted must count, or ropes look weaker than they are.
#[test]
fn ropes_put_in_after_a_break_count_where_every_place_was_repaired() {
    const MEAN_DAYS: f64 = 1000.0;
    let begin = parse_utc_s("2024-01-01").unwrap();
    // Quantiles of lives at a constant risk, a hundred places on their first day, each with another.
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
fn a_column_that_is_not_there_and_ropes_that_break_early_are_refused() {
    let (_folder, path) = table(EVENTS);
    let odd = EventColumns {
        group: Some("kindd".into()),
        ..EventColumns::default()
    };
    let why = read_lives(&path, &odd).unwrap_err().to_string();
    assert!(why.contains("'kindd'") && why.contains("--group"), "{why}");
    let mut early = String::from("age_days,end\n");
    for i in 0..20 {
        early += &format!("{},broken\n700,running\n", 1.0 + f64::from(i * i) / 10.0);
    }
    let (_folder, path) = table(&early);
    let lives = read_lives(&path, &EventColumns::default()).unwrap();
    let report = analyze_lives(&lives, "early");
    assert_eq!(report.groups[0].wear, Wear::BreaksEarly);
    let why = LifePrior::new(&lives, "early", 0.1, 1)
        .unwrap_err()
        .to_string();
    assert!(why.contains("no reason to replace"), "{why}");
}
