//! Any text as a rope: no panic; what is let through is written and read again the same, and its
//! law gives finite strains that never come back where they are irreversible.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_rope::law::entry::CatalogueEntry;
use sinew_rope::law::{Law, RopeLoad, State};

fuzz_target!(|text: &str| {
    let Ok(entry) = CatalogueEntry::parse(text, "rope.toml") else {
        return;
    };
    let again =
        CatalogueEntry::parse(&entry.to_toml(), "again.toml").expect("what is written is read");
    assert_eq!(entry, again);
    let Ok(parameters) = entry.parameters() else {
        return;
    };
    let Ok(law) = Law::new(parameters) else {
        return;
    };
    let load = RopeLoad::celsius(0.1 * parameters.breaking_load_n, 30.0);
    let mut state = State::default();
    let mut last: f64 = 0.0;
    for seconds in [1.0, 1e3, 1e7] {
        law.hold(&mut state, load, seconds)
            .expect("a tenth of the breaking load");
        let strain = law.strain(&state, load).expect("the same");
        assert!(strain.total_percent().is_finite(), "{strain:?}");
        assert!(strain.irreversible_percent() >= last - 1e-9 * last.abs());
        last = strain.irreversible_percent();
    }
});
