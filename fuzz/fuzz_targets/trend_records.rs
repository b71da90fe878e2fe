//! Any text as records of sessions, JSON or CSV: no panic; what is let through is finite, in order, and
//! the trend takes it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_trend::filter::{Prior, Record, Trend, TrendConfig, generic_curves};
use sinew_trend::{records_from_csv, records_from_json, sort};

fuzz_target!(|text: &str| {
    let (kind, text) = text.split_at(text.chars().next().map_or(0, char::len_utf8));
    let records = if kind == "c" {
        records_from_csv(text, "r.csv")
    } else {
        records_from_json(text, "r.json")
    };
    let Ok(sorted) = records.and_then(|r| sort(r, None)) else {
        return;
    };
    for (_, records) in sorted.joints {
        assert!(
            records
                .windows(2)
                .all(|w| w[0].time_utc_s.total_cmp(&w[1].time_utc_s).is_le())
        );
        let mut curves = generic_curves(0.03);
        curves.truncate(2);
        let mut prior = Prior::new(curves);
        prior.noises.truncate(2);
        let mut trend = Trend::new(prior, TrendConfig::default()).expect("a prior");
        let start = records.first().map_or(0.0, |r| r.time_utc_s);
        for r in records.iter().take(40) {
            assert!(
                r.offset_rad
                    .is_none_or(|g| g.mean.is_finite() && g.std > 0.0)
            );
            let record = Record {
                time_s: r.time_utc_s - start + 3600.0,
                offset_rad: r.offset_rad,
                shared: r.systematic_error,
                temperature_c: r.temperature_c,
                reference_c: r.reference_c,
                stiffness: r.stiffness_ratio,
            };
            // Numbers whose squares overflow are refused, not taken.
            if let Ok(added) = trend.add(record) {
                assert!(
                    (0.0..=1.0 + 1e-9).contains(&added.step_probability),
                    "{added:?}"
                );
            }
        }
    }
});
