//! Corrupt ropes, duties and benches as text, in thousands of variants: an error with the file name, or a
//! valid result. `fuzz/` tests the same with coverage guidance; `SINEW_ROUNDS=100` runs a hundred times as
//! many variants here.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sinew_rope::bench::{Bench, simulate};
use sinew_rope::law::entry::CatalogueEntry;
use sinew_rope::law::{Law, RopeLoad, State};
use sinew_rope::{Catalogue, Draws, Duty};

const DUTY: &str = include_str!("../../../fuzz/seeds/duty/toml");
const TABLE: &str = include_str!("../../../fuzz/seeds/duty/csv");
const BENCH: &str = include_str!("../../../fuzz/seeds/bench_toml/two.toml");
const ROPE: &str = include_str!("../ropes/liros-dc000-0301.toml");

const NUMBERS: [&str; 12] = [
    "-1", "0", "-0.0", "nan", "inf", "-inf", "1e308", "1e-308", "1e5", "0.5", "true", "\"x\"",
];

/// Corrupts a text in one to three places: a number, a line, a character.
fn corrupted(text: &str, rng: &mut ChaCha8Rng) -> String {
    let mut out = text.to_owned();
    for _ in 0..rng.random_range(1..4) {
        let mut lines: Vec<String> = out.lines().map(str::to_owned).collect();
        if lines.is_empty() {
            return out;
        }
        let at = rng.random_range(0..lines.len());
        match rng.random_range(0..5) {
            0 => {
                lines.remove(at);
            }
            1 => lines.insert(at, lines[rng.random_range(0..lines.len())].clone()),
            2 => {
                let mut chars: Vec<char> = lines[at].chars().collect();
                if !chars.is_empty() {
                    let k = rng.random_range(0..chars.len());
                    chars[k] = ['=', '.', '9', '-', 'e', '"', '[', 'µ'][rng.random_range(0..8)];
                }
                lines[at] = chars.into_iter().collect();
            }
            _ => {
                // One of the line's numbers.
                let digit = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
                let starts: Vec<usize> = lines[at]
                    .char_indices()
                    .filter(|(i, c)| c.is_ascii_digit() && !lines[at][..*i].ends_with(digit))
                    .map(|(i, _)| i)
                    .collect();
                if !starts.is_empty() {
                    let from = starts[rng.random_range(0..starts.len())];
                    let rest = &lines[at][from..];
                    let to = from + rest.find(|c| !digit(c)).unwrap_or(rest.len());
                    let number = NUMBERS[rng.random_range(0..NUMBERS.len())];
                    lines[at] = format!("{}{number}{}", &lines[at][..from], &lines[at][to..]);
                }
            }
        }
        out = lines.join("\n");
    }
    out
}

/// Runs `check` on corrupt texts; it returns whether the text was accepted. Both results must be frequent.
fn often(text: &str, rounds: usize, mut check: impl FnMut(&str) -> bool) {
    let factor = std::env::var("SINEW_ROUNDS").ok();
    let rounds = rounds * factor.and_then(|f| f.parse().ok()).unwrap_or(1);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    assert!(check(text), "the sound text is read");
    let read = (0..rounds)
        .filter(|_| check(&corrupted(text, &mut rng)))
        .count();
    assert!(
        read > rounds / 20 && read < rounds * 19 / 20,
        "{read} of {rounds} were read"
    );
}

#[track_caller]
fn named<T, E: std::fmt::Display>(result: Result<T, E>, file: &str) -> Option<T> {
    result
        .map_err(|e| {
            let text = e.to_string();
            assert!(text.contains(file), "{text}");
        })
        .ok()
}

#[test]
fn duties() {
    let check = |duty: Option<Duty>| {
        let Some(duty) = duty else { return false };
        assert!(duty.stretches.iter().all(|s| s.duration_s > 0.0));
        let sum = duty.summary();
        let slack = 1e-9 * (1.0 + sum.tension_max_n);
        assert!(sum.tension_min_n >= 0.0);
        assert!(sum.tension_min_n - slack <= sum.tension_mean_n);
        assert!(sum.tension_mean_n <= sum.tension_max_n + slack, "{sum:?}");
        true
    };
    // The first letter is the fuzzer's.
    often(&DUTY[1..], 4000, |t| {
        check(named(Duty::from_toml(t, "d.toml"), "d.toml"))
    });
    often(&TABLE[1..], 4000, |t| {
        check(named(Duty::from_csv(t, "d.csv"), "d.csv"))
    });
}

#[test]
fn ropes() {
    often(ROPE, 1500, |t| {
        let Some(entry) = named(CatalogueEntry::parse(t, "r.toml"), "r.toml") else {
            return false;
        };
        let again =
            CatalogueEntry::parse(&entry.to_toml(), "again.toml").expect("what is written is read");
        assert_eq!(again, entry);
        let Some(law) = entry.parameters().ok().and_then(|p| Law::new(p).ok()) else {
            return true;
        };
        let load = RopeLoad::celsius(0.1 * law.parameters().breaking_load_n, 30.0);
        let mut state = State::default();
        law.hold(&mut state, load, 1e7).expect("a tenth of it");
        let strain = law.strain(&state, load).expect("the same");
        assert!(strain.total_percent().is_finite(), "{strain:?}");
        true
    });
}

#[test]
fn benches() {
    let catalogue = Catalogue::shipped().expect("shipped");
    let rope = catalogue.find("liros-dc000-0301").expect("there");
    let law = Draws::new(rope, 0, 1).expect("complete").nominal;
    often(BENCH, 600, |t| {
        let Some(bench) = named(Bench::parse(t, "b.toml"), "b.toml") else {
            return false;
        };
        // A rope that breaks is an answer too.
        if let Ok(run) = simulate(&law, &bench, Some(1.5e-3), bench.duration_s() / 3.0) {
            assert!(run.time_s.windows(2).all(|w| w[0] <= w[1]));
            assert!(run.strain_percent.iter().all(|s| s.is_finite()), "{t}");
        }
        true
    });
}
