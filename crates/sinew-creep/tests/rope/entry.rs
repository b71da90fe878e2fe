//! From a fit to an entry of the catalogue to a prediction.

use crate::support::bench::{COLD, SIGMA, base, options, records, truth};
use crate::support::seeds;
use sinew_creep::*;
use sinew_rope::law::tested_range::TestedRange;
use sinew_rope::law::{Law as RopeLaw, RopeLoad, State};

#[test]
fn fitted_entry_prediction_covers_truth() {
    use sinew_rope::law::entry::{CatalogueEntry, Origin, Uncertainty};
    use sinew_rope::predict::{Request, Route, predict};
    use sinew_rope::{CatalogueRope, Duty};
    let count = seeds(4);
    let numbers: Vec<u64> = (0..count).collect();
    let true_law = RopeLaw::new(truth()).unwrap();
    let inside = each(
        &numbers,
        |&seed| {
            let base = base();
            let found = fit(
                Law::Rope,
                &records(&COLD, SIGMA, 500 + seed),
                &options(seed),
            )
            .unwrap();
            let from = EntrySource {
                name: "mine".into(),
                data: "made.csv (SHA-256 abc)".into(),
                date: "2026-11-21".into(),
            };
            let entry = rope_entry(&found, &base, &from).unwrap();
            let text = entry.to_toml();
            let read = CatalogueEntry::parse(&text, "mine.toml").unwrap();
            assert_eq!(read, entry, "{text}");
            for (parameter, value) in &read.law {
                let fitted = found.parameter(parameter.name()).is_some();
                assert_eq!(fitted, value.origin == Origin::Fitted, "{parameter:?}");
                if fitted {
                    assert_eq!(value.date.as_deref(), Some("2026-11-21"));
                    assert!(read.sources[&value.source].contains("made.csv"));
                    assert_ne!(value.uncertainty, Uncertainty::NotSpecified);
                }
            }
            // Tested range of the entry: 60 and 240 N of the records, at 23 °C, for their duration.
            let tested_range = read.tested_range.unwrap();
            let shares = [60.0, 240.0].map(|n| n / truth().breaking_load_n);
            for (found, made) in tested_range.load_share.iter().zip(shares) {
                assert!((found / made - 1.0).abs() < 0.01, "{tested_range:?}");
            }
            assert_eq!(tested_range.temperature_c, [23.0, 23.0]);
            let mut rope = CatalogueRope {
                entry: read,
                file: None,
            };
            let asked = |draws| Request {
                duty: Duty::constant(120.0, 23.0),
                route: Route::straight(1.0),
                times_s: vec![0.9 * tested_range.duration_s, 30.0 * 86_400.0],
                read_at: None,
                draws,
                seed,
            };
            // A month is outside the tested range, where the law may be wrong.
            let told = predict(&rope, &asked(400)).unwrap();
            let widths = [0, 1].map(|i| {
                let strain = told.readings[i].strain_ratio;
                (strain.high - strain.low) / strain.value
            });
            assert!(widths[0] < 0.1 && widths[1] > 2.0 * widths[0], "{widths:?}");
            // The fitted law generated these records: only the parameters' part remains, and it
            // alone is compared with the truth below.
            rope.entry.tested_range = Some(TestedRange {
                duration_s: 30.0 * 86_400.0,
                ..tested_range
            });
            // Loads between and within those tested; fixed parameters (flow, λ_t) have the true
            // values.
            [60.0, 120.0]
                .into_iter()
                .flat_map(|tension| {
                    let request = Request {
                        duty: Duty::constant(tension, 23.0),
                        route: Route::straight(1.0),
                        times_s: vec![600.0, 3600.0, 86_400.0, 2_592_000.0],
                        read_at: None,
                        draws: 400,
                        seed,
                    };
                    let told = predict(&rope, &request).unwrap();
                    told.readings
                        .iter()
                        .map(|r| {
                            let load = RopeLoad::celsius(tension, 23.0);
                            let mut s = State::default();
                            true_law.hold(&mut s, load, r.time_s).unwrap();
                            let value = true_law.strain(&s, load).unwrap().total_percent();
                            let i = r.strain_ratio.scaled(100.0);
                            let width = (i.high - i.low) / i.value;
                            (i.low <= value && value <= i.high, width)
                        })
                        .collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
        },
        |_| {},
    );
    let all: Vec<(bool, f64)> = inside.into_iter().flatten().collect();
    let share = all.iter().filter(|i| i.0).count() as f64 / all.len() as f64;
    let width = all.iter().map(|i| i.1).sum::<f64>() / all.len() as f64;
    println!(
        "prediction holds the truth in {:.1} %, mean width {:.1} %",
        100.0 * share,
        100.0 * width
    );
    let least = if count >= 100 { 0.92 } else { 0.7 };
    assert!(share >= least, "{share}");
    // The interval is informative: that of an assumed catalogue value is ten times wider.
    assert!(width < 0.1, "{width}");
}
