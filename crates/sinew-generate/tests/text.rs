//! Content of the generated files.

use crate::robots::{biorob_like, models};
use sinew_generate::{GenerateError, Language, Precision, generate};
use sinew_model::offset::{Comparison, OffsetConfig, VelocityFilter};

fn config() -> OffsetConfig {
    let velocity = VelocityFilter::StateVariable {
        cutoff_rad_per_s: 40.0,
    };
    OffsetConfig {
        gain_per_s: 20.0,
        velocity,
        ..OffsetConfig::default()
    }
}

#[test]
fn generated_c_has_no_loop_and_no_dependency() {
    for robot in std::iter::once(biorob_like()).chain(models()) {
        for language in [Language::C, Language::Rust] {
            for file in generate(&robot, &config(), language, Precision::Double)
                .unwrap()
                .files
            {
                for line in file.text.lines().map(str::trim) {
                    let comment =
                        line.starts_with("//") || line.starts_with('*') || line.starts_with("/*");
                    let repeats = ["for ", "for(", "while ", "while(", "loop "].iter();
                    let repeats = repeats
                        .filter(|_| !comment)
                        .any(|word| line.starts_with(word));
                    assert!(!repeats, "{}: {line}", file.name);
                    assert!(!line.contains('@'), "{}: {line}", file.name);
                    if let Some(header) = line.strip_prefix("#include <") {
                        assert!(["math.h>", "stddef.h>"].contains(&header), "{line}");
                    }
                }
            }
        }
    }
}

#[test]
fn generated_code_is_deterministic() {
    for language in [Language::C, Language::Rust] {
        let write = || generate(&biorob_like(), &config(), language, Precision::Double).unwrap();
        assert_eq!(write(), write());
    }
}

#[test]
fn unsupported_robot_returns_error() {
    let paper = OffsetConfig {
        comparison: Comparison::Paper,
        ..config()
    };
    let refused = generate(&biorob_like(), &paper, Language::C, Precision::Double).unwrap_err();
    assert!(matches!(refused, GenerateError::Source), "{refused}");
    let gain = OffsetConfig {
        gain_per_s: -1.0,
        ..config()
    };
    let refused = generate(&biorob_like(), &gain, Language::C, Precision::Double).unwrap_err();
    assert!(matches!(refused, GenerateError::Config(_)), "{refused}");
}

#[test]
fn fixed_structure_reduces_operation_count() {
    // Seven joints with orthogonal and parallel axes: as every common arm.
    let serial7 = models().nth(1).unwrap();
    let counted = generate(&serial7, &config(), Language::C, Precision::Double)
        .unwrap()
        .operations;
    println!("serial7: {counted:?}");
    assert_eq!(serial7.arm.dof(), 7);
    assert!(counted.turns <= 7);
    // The generic pass takes some 110 products and 90 sums a joint.
    assert!(
        counted.products < 7 * 70 && counted.sums < 7 * 70,
        "{counted:?}"
    );
}
