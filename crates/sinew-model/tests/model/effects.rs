//! The book's page of effects says what the code does.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-model --test model effects::` writes it anew.

use sinew_model::arm::{ArmBuilder, BodyInertia, BodySpec, JointKind, Pose};
use sinew_model::offset::effects::{ALL, Lifetime, Parameter};
use sinew_model::offset::{Payload, Prior, UNKNOWN_OFFSET_RAD};
use sinew_model::tolerances::Tolerances;
use sinew_model::transmission::{Tendon, Transmission};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

const HEAD: &str = "\
# Effects

The [absolute offset](absolute.md) is estimated together with every other effect that moves the measurements. This page is generated
from the code: it lists the terms of each effect, its parameters and their priors.

An effect adds its terms to sums in the [equations of a block](absolute.md#the-equations-of-a-block). All signals have passed the
low-pass `LP`. The number after ± is a standard deviation. Keys in the column *prior* are those of
[tolerances](../reference/robot.md#tolerances). *Engineering judgement* marks starting values for light rope-driven arms that
no measurement supports.

The column *default* is the prior where robot.toml states no more than a stiffness of 50 N·m/rad and an antagonistic pair. The body
there has 1 kg in a point 0.1 m from its joint.

The column *ages* says how long a value holds:

- *recording*: for one recording.
- *tensioning*: until the rope is tensioned again.
- *days*: the standard deviation grows with the square root of time, by a tenth of the prior's in a day, up to the prior's.
- *months*: the same, by a hundredth in a day.
";

/// Priors of a joint and a body about which robot.toml says nothing else.
fn defaults() -> HashMap<String, String> {
    let body = BodySpec {
        name: "body".into(),
        parent: None,
        kind: JointKind::Revolute,
        axis: [0.0, 0.0, 1.0],
        placement: Pose::IDENTITY,
        body: BodyInertia::point(1.0, [0.1, 0.0, 0.0]),
    };
    let arm = ArmBuilder::new().body(body).build().unwrap();
    let joint = Transmission {
        tendon: Some(Tendon {
            antagonistic: true,
            ..Tendon::default()
        }),
        ..Transmission::spring(50.0)
    };
    let tolerances = Tolerances::default();
    let prior = Prior::new(&arm, &[Some(joint)], 0, [0.0; 3], tolerances);
    let belief = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let mut out = HashMap::new();
    for k in 0..prior.dimension() {
        let (of, entry) = (prior.parameter(k).unwrap(), belief.entry(k));
        out.insert(
            of.name.to_owned(),
            in_unit([entry.mean, entry.deviation], of.unit),
        );
    }
    let arm = in_unit([0.0, tolerances.moment_arm], "");
    out.insert("moment arm error".into(), arm);
    let force = in_unit([0.0, tolerances.external_force_n], "N");
    let place = in_unit([0.0, tolerances.payload_reach_m], "m");
    for axis in ["x", "y", "z"] {
        out.insert(format!("external force {axis}"), force.clone());
        out.insert(format!("place of the force {axis}"), place.clone());
    }
    out
}

/// The unit that the page shows, and how many of it a unit of the state is.
fn shown(unit: &str) -> (String, f64) {
    match unit {
        "rad" | "rad/K" => (format!("m{unit}"), 1e3),
        "" => ("–".into(), 1.0),
        _ => (unit.into(), 1.0),
    }
}

/// Mean and standard deviation, to two digits.
fn in_unit([mean, deviation]: [f64; 2], unit: &str) -> String {
    /// What is held fixed has less.
    const FIXED: f64 = 1e-8;
    let (_, factor) = shown(unit);
    let number = |x: f64| -> f64 { format!("{:.1e}", factor * x).parse().unwrap() };
    if deviation < FIXED {
        return format!("{}, fixed", number(mean));
    }
    format!("{} ± {}", number(mean), number(deviation))
}

fn row(parameter: &Parameter, defaults: &HashMap<String, String>) -> String {
    let lifetime = match parameter.lifetime {
        Lifetime::Recording => "recording",
        Lifetime::Tensioning => "tensioning",
        Lifetime::Days => "days",
        Lifetime::Months => "months",
    };
    let Parameter {
        name,
        symbol,
        prior_text,
        source,
        ..
    } = parameter;
    let (unit, _) = shown(parameter.unit);
    let default = &defaults[*name];
    format!("| {name} | `{symbol}` | {unit} | {prior_text} | {default} | {source} | {lifetime} |\n")
}

#[test]
fn effects_page_is_up_to_date() {
    let defaults = defaults();
    let mut page = String::from(HEAD);
    for effect in ALL {
        write!(page, "\n## {}\n\n{}\n\n", effect.title, effect.text).unwrap();
        for line in effect.equation.lines() {
            writeln!(page, "    {line}").unwrap();
        }
        page += "\n| parameter | symbol | unit | prior | default | source of the numbers | ages |\n|---|---|---|---|---|---|---|\n";
        page.extend(effect.parameters.iter().map(|p| row(p, &defaults)));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/science/effects.md");
    if std::env::var_os("SINEW_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == page,
        "{}: not what the code says; write it with SINEW_WRITE=1",
        path.display()
    );
}

#[test]
fn effects_name_every_parameter_once() {
    let mut names: Vec<&str> = ALL
        .iter()
        .flat_map(|e| e.parameters)
        .map(|p| p.name)
        .collect();
    let all = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), all);
}
