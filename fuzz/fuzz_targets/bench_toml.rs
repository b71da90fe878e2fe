//! Any text as a bench: no panic; one that is let through runs, or the rope breaks.
#![no_main]

use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;
use sinew_rope::bench::{Bench, simulate};
use sinew_rope::law::Law;
use sinew_rope::{Catalogue, Draws};

fn law() -> &'static Law {
    static LAW: OnceLock<Law> = OnceLock::new();
    LAW.get_or_init(|| {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        Draws::new(rope, 0, 1).expect("complete").nominal
    })
}

fuzz_target!(|text: &str| {
    let Ok(bench) = Bench::parse(text, "bench.toml") else {
        return;
    };
    if bench.phases.len() > 20 {
        return;
    }
    if let Ok(run) = simulate(law(), &bench, Some(1.5e-3), bench.duration_s() / 3.0) {
        assert_eq!(run.time_s.len(), run.strain_percent.len());
        assert!(run.time_s.windows(2).all(|w| w[0] <= w[1]));
        assert!(
            run.strain_percent.iter().all(|s| s.is_finite()),
            "{bench:?}"
        );
        assert!(run.irreversible_percent.iter().all(|s| *s >= -1e-9));
    }
});
