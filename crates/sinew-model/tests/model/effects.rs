//! Tests that the book's page of effects matches the code.
//!
//! `SINEW_WRITE=1 cargo test -p sinew-model --test model effects::` regenerates it.

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

The [absolute offset](absolute.md) is estimated jointly with all other effects that influence the measurements. This page is generated from the
code and lists the terms, parameters and priors of each effect.

An effect adds its terms to the sums in the [block equations](absolute.md#block-equations). All signals have passed the low-pass `LP`. Numbers
after ± are standard deviations. The column *prior* names the keys of [tolerances](../reference/robot.md#tolerances). *Engineering judgement* marks
default values for light rope-driven arms that no measurement supports.

The column *default* is the prior for a stiffness of 50 N·m/rad, an antagonistic pair and a point mass of 1 kg at 0.1 m from the joint. The column
*ages* states the validity of a value:

- *recording*: valid for one recording.
- *tensioning*: valid until the rope is re-tensioned.
- *days*: the standard deviation grows with the square root of time, by a tenth of the prior in one day, up to that of the prior.
- *months*: the same growth, by a hundredth of the prior in one day.
";

/// Returns the priors of a joint and a body with the default tolerances of robot.toml.
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
    let state_estimate = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let mut out = HashMap::new();
    for k in 0..prior.dimension() {
        let (of, entry) = (prior.parameter(k).unwrap(), state_estimate.entry(k));
        out.insert(
            of.name.to_owned(),
            in_unit([entry.mean, entry.std], of.unit),
        );
    }
    let arm = in_unit([0.0, tolerances.moment_arm], "");
    out.insert("moment arm error".into(), arm);
    let more = [
        ("joint spring stiffness", tolerances.spring, ""),
        (
            "joint spring rest position",
            tolerances.spring_rest_rad,
            "rad",
        ),
        ("tension sensor gain", tolerances.tension_sensor, ""),
    ];
    for (name, std, unit) in more {
        out.insert(name.into(), in_unit([0.0, std], unit));
    }
    let of_sensor = tolerances.tension_sensor * 0.02 * 50.0;
    out.insert(
        "tension sensor zero".into(),
        in_unit([0.0, of_sensor], "N·m"),
    );
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
fn in_unit([mean, std]: [f64; 2], unit: &str) -> String {
    /// Standard deviation below which a parameter is fixed.
    const FIXED: f64 = 1e-8;
    let (_, factor) = shown(unit);
    let number = |x: f64| -> f64 { format!("{:.1e}", factor * x).parse().unwrap() };
    if std < FIXED {
        return format!("{}, fixed", number(mean));
    }
    format!("{} ± {}", number(mean), number(std))
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
