//! Parser of TOML text to a checked [`Mapping`].

use sinew_files::{Bound, Budget, Fault, Fields as _, Located, Section, TomlFile, Value};

use super::unit::{self, time_unit_exponent};
use super::{
    ColumnRef, JointEffort, JointMap, Mapping, McapMap, Source, TendonMap, Term, TimeMap, Wrap,
};
use crate::frame::Quantity;
use sinew_files::unit::{Dimension, Unit};

/// Keys of a term other than `column`.
const TERM_KEYS: [&str; 8] = [
    "column",
    "unit",
    "scale",
    "gear_ratio",
    "counts_per_turn",
    "torque_constant_nm_per_a",
    "sign",
    "offset",
];

pub(super) fn from_toml(text: &str, file: &str) -> Result<Mapping, Located> {
    if let Err(problem) = Budget::SETTINGS.memory.check(text.len() as u64) {
        return Err(Located::new(file, Fault::TooLarge, problem));
    }
    TomlFile::parse(text, file)?.root().whole(|s| {
        let joints = s.read("joints", |s| {
            let entries = s.entries().into_iter();
            let read = entries.map(|(name, line, value)| {
                if name.is_empty() {
                    let problem = "a joint without a name";
                    return Err(s.here(Fault::NotAllowed, problem).line(line));
                }
                value.section()?.whole(|s| joint(s, name))
            });
            read.collect::<Result<Vec<_>, Located>>()
        })?;
        let mut joints = joints.unwrap_or_default();
        let motors = s.read("motors", |s| {
            let entries = s.entries().into_iter();
            let read = entries.map(|(name, line, value)| {
                let motor = value.section()?.whole(|s| motor(s, name))?;
                add_motor(&mut joints, motor)
                    .map_err(|problem| s.here(Fault::Contradiction, problem).line(line))
            });
            read.collect::<Result<(), Located>>()
        });
        motors?;
        let tendons = s.read("tendons", |s| {
            let entries = s.entries().into_iter();
            let read = entries.map(|(name, line, value)| {
                if name.is_empty() {
                    let problem = "a tendon without a name";
                    return Err(s.here(Fault::NotAllowed, problem).line(line));
                }
                value.section()?.whole(|s| tendon(s, name))
            });
            read.collect::<Result<Vec<_>, Located>>()
        })?;
        Ok(Mapping {
            file: file.to_owned(),
            time: s.read("time", time)?,
            temperature: s.read("temperature", |s| source(s, Quantity::Temperature))?,
            joints,
            tendons: tendons.unwrap_or_default(),
            mcap: s.read("mcap", mcap)?.unwrap_or_default(),
        })
    })
}

fn time(s: &Section<'_>) -> Result<TimeMap, Located> {
    let exponent = s.value("unit").map(|unit| {
        let exponent = time_unit_exponent(unit.text()?);
        exponent.map_err(|reason| unit.fault(Fault::NotAllowed, reason))
    });
    let rate_hz = s.number("rate_hz", Bound::Positive)?;
    if rate_hz.is_some() && (s.has("column") || s.has("unit")) {
        let problem = "rate_hz is for a table without times; remove it, or column and unit";
        return Err(s.here(Fault::Contradiction, problem));
    }
    Ok(TimeMap {
        column: column(s)?,
        exponent: exponent.transpose()?,
        rate_hz,
    })
}

/// Column of a section, by its name or number.
fn column(s: &Section<'_>) -> Result<Option<ColumnRef>, Located> {
    s.value("column").map(|value| column_of(&value)).transpose()
}

fn column_of(value: &Value<'_>) -> Result<ColumnRef, Located> {
    match (value.text(), value.count()) {
        (Ok(name), _) => Ok(ColumnRef::Name(name.to_owned())),
        (_, Ok(number)) if number > 0 => Ok(ColumnRef::Number(number as usize)),
        _ => Err(value.invalid("the name of a column in quotes, or its number from 1")),
    }
}

fn mcap(s: &Section<'_>) -> Result<McapMap, Located> {
    Ok(McapMap {
        joint_state_topic: s.text("joint_state_topic")?,
        motor_topic: s.text("motor_topic")?,
        motor_interface: s.text("motor_interface")?,
        motor_effort_interface: s.text("motor_effort_interface")?,
        temperature_interface: s.text("temperature_interface")?,
        external_torque_topic: s.text("external_torque_topic")?,
        tension_topic: s.text("tension_topic")?,
        joint_effort: s.one_of(
            "joint_effort",
            &[
                ("tau_el", JointEffort::TauEl),
                ("tau_m", JointEffort::TauM),
                ("ignore", JointEffort::Ignore),
            ],
        )?,
    })
}

fn joint(s: &Section<'_>, name: &str) -> Result<JointMap, Located> {
    let mut sources: [Option<Source>; 6] = Default::default();
    for quantity in Quantity::PER_JOINT {
        sources[quantity.index()] = s.read(quantity.symbol(), |s| source(s, quantity))?;
    }
    Ok(JointMap {
        name: name.to_owned(),
        recorded: s.text("name")?,
        motor_recorded: s.text("motor_name")?,
        sources,
    })
}

/// A tendon whose tension is measured: a column's name, or a source as that of a torque.
fn tendon(s: &Section<'_>, name: &str) -> Result<TendonMap, Located> {
    let tension = match s.value("tension") {
        None => None,
        Some(value) if value.is_table() => {
            let read = |s: &Section<'_>| source(s, Quantity::Tension);
            Some(value.section()?.whole(read)?)
        }
        Some(value) => Some(Source::of_column(column_of(&value)?, value.line())),
    };
    Ok(TendonMap {
        name: name.to_owned(),
        recorded: s.text("name")?,
        tension,
        line: s.line(),
    })
}

/// Motor with a name of its own, as in `[motors]` of robot.toml.
fn motor(s: &Section<'_>, name: &str) -> Result<JointMap, Located> {
    let mut sources: [Option<Source>; 6] = Default::default();
    for quantity in [Quantity::Theta, Quantity::TauM] {
        sources[quantity.index()] = s.read(quantity.symbol(), |s| source(s, quantity))?;
    }
    Ok(JointMap {
        name: name.to_owned(),
        recorded: None,
        motor_recorded: s.text("name")?,
        sources,
    })
}

/// Adds a motor to the joints, or to the joint of its name.
fn add_motor(joints: &mut Vec<JointMap>, motor: JointMap) -> Result<(), String> {
    let Some(joint) = joints.iter_mut().find(|joint| joint.name == motor.name) else {
        joints.push(motor);
        return Ok(());
    };
    for quantity in [Quantity::Theta, Quantity::TauM] {
        let (to, from) = (
            &mut joint.sources[quantity.index()],
            &motor.sources[quantity.index()],
        );
        if to.is_some() && from.is_some() {
            let (symbol, name) = (quantity.symbol(), &motor.name);
            return Err(format!(
                "{symbol} of '{name}' is in both [joints.{name}] and [motors.{name}]: remove one"
            ));
        }
        *to = to.take().or_else(|| from.clone());
    }
    joint.motor_recorded = joint.motor_recorded.take().or(motor.motor_recorded);
    Ok(())
}

fn source(s: &Section<'_>, quantity: Quantity) -> Result<Source, Located> {
    let contradiction = |problem: &str| Err(s.here(Fault::Contradiction, problem));
    let mut terms = s.each("sum", |s| {
        s.needed(
            column(s)?,
            "column",
            "term without a column",
            ColumnRef::Number(1),
        );
        term(s, quantity)
    })?;
    let has_term_keys = TERM_KEYS.map(|key| s.has(key)).contains(&true);
    if !s.has("sum") {
        terms.push(term(s, quantity)?);
    } else if has_term_keys {
        return contradiction(
            "only wrap and wrap_period are valid with 'sum'; move column, unit and factors into the terms",
        );
    } else if terms.is_empty() {
        return contradiction("the sum has no terms");
    }
    let is_a = |dimension| terms.iter().any(|(_, unit)| unit.dimension == dimension);
    let wraps = s.flag_or("wrap", true)?;
    let wrap = match (wraps, s.number("wrap_period", Bound::Positive)?) {
        (false, Some(_)) => {
            return contradiction("wrap = false conflicts with wrap_period");
        }
        (false, None) => Wrap::Never,
        (true, Some(_)) if !matches!(quantity, Quantity::Q | Quantity::Theta) => {
            return contradiction("only positions wrap around");
        }
        (true, Some(period)) => Wrap::Period(period),
        (true, None) if is_a(Dimension::Length) && !s.has("wrap") => Wrap::Never,
        (true, None) => match counted_turn(&terms, s) {
            Some(turn) => Wrap::Period(turn),
            None => Wrap::default_for(quantity),
        },
    };
    Ok(Source {
        wrap,
        is_current: is_a(Dimension::Current),
        terms: terms.into_iter().map(|(term, _)| term).collect(),
        line: s.line(),
    })
}

/// Revolution of an encoder whose counts start at zero with each revolution, in SI at the joint: 2π / gear ratio.
/// `None` for other units and for sums.
fn counted_turn(terms: &[(Term, Unit)], s: &Section<'_>) -> Option<f64> {
    let [(term, unit)] = terms else {
        return None;
    };
    let counts_per_turn = s.number("counts_per_turn", Bound::NotZero).ok()??;
    let is_count = unit.dimension == Dimension::Count;
    is_count.then_some((counts_per_turn * term.scale).abs())
}

fn term(s: &Section<'_>, quantity: Quantity) -> Result<(Term, Unit), Located> {
    let factor = |key| s.number(key, Bound::NotZero);
    let scale = factor("scale")?;
    let gear_ratio = factor("gear_ratio")?.unwrap_or(1.0);
    let counts_per_turn = factor("counts_per_turn")?;
    let constant = factor("torque_constant_nm_per_a")?;
    let sign = factor("sign")?.unwrap_or(1.0);
    let offset = s.number_or("offset", Bound::Any, 0.0)?;
    let unit = match s.value("unit") {
        None => Unit::SI,
        Some(text) => {
            unit::parse(text.text()?).map_err(|reason| text.fault(Fault::NotAllowed, reason))?
        }
    };
    if quantity == Quantity::Tension && s.has("gear_ratio") {
        let problem = "a tension is measured at the tendon, without a gear; use 'scale' instead";
        return Err(s.here(Fault::Contradiction, problem));
    }
    let symbol = quantity.symbol();
    let is_current = unit.dimension == Dimension::Current;
    if is_current != constant.is_some() {
        let problem = "unit \"A\" (or \"mA\") requires torque_constant_nm_per_a, N·m per A at the motor's shaft, and vice versa";
        return Err(s.here(Fault::Contradiction, problem));
    }
    if is_current && quantity != Quantity::TauM {
        let problem = format!("a motor's current can be a tau_m, not a {symbol}");
        return Err(s.here(Fault::Contradiction, problem));
    }
    if !unit::fits(unit, quantity) && scale.is_none() {
        let si = quantity.suffix().trim_start_matches('_');
        let must = format!("a unit of {symbol} ({si}), or set the 'scale' that converts it");
        return Err(s.invalid("unit", &must));
    }
    if constant.is_some_and(|constant| constant < 0.0) {
        let must = "above 0; 'sign' reverses a motor";
        return Err(s.invalid("torque_constant_nm_per_a", must));
    }
    if sign.abs() != 1.0 {
        return Err(s.invalid("sign", "1 or -1"));
    }
    let is_count = unit.dimension == Dimension::Count;
    if is_count != counts_per_turn.is_some() {
        let problem = "unit \"count\" requires counts_per_turn, and vice versa";
        return Err(s.here(Fault::Contradiction, problem));
    }
    let unit_factor = match counts_per_turn {
        Some(counts_per_turn) => 2.0 * std::f64::consts::PI / counts_per_turn,
        None => unit.factor,
    };
    // A gear divides what a motor turns by, and multiplies what it pulls with.
    let through_gear = match quantity {
        Quantity::TauEl | Quantity::TauM | Quantity::TauExt => gear_ratio,
        Quantity::Q | Quantity::Theta | Quantity::Dq | Quantity::Temperature => 1.0 / gear_ratio,
        Quantity::Tension => 1.0,
    };
    let outer = sign * scale.unwrap_or(1.0) * constant.unwrap_or(1.0) * through_gear;
    let scale = outer * unit_factor;
    let offset = outer * unit.offset + offset;
    if !(scale.is_finite() && scale != 0.0 && offset.is_finite()) {
        let problem = format!("the factors multiply to {scale}");
        return Err(s.here(Fault::NotAllowed, problem));
    }
    let term = Term {
        column: column(s)?,
        scale,
        offset,
        line: s.line(),
    };
    Ok((term, unit))
}
