//! From TOML text to a checked [`Mapping`]. Stored types are their own types.

use std::collections::HashMap;

use serde::Deserialize;
use toml::Spanned;

use super::unit::{Dimension, Unit, time_unit_exponent};
use super::{JointMap, Mapping, McapMap, Source, Term, TimeMap, Wrap};
use crate::error::LogError;
use crate::frame::Quantity;
use crate::options::JointEffort;

/// Most bytes a mapping file may have: a mapping is written by hand.
const TEXT_LIMIT_BYTES: usize = 4 << 20;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Root {
    time: Option<Spanned<TimeToml>>,
    temperature: Option<Spanned<SourceToml>>,
    #[serde(default)]
    joints: HashMap<Spanned<String>, JointToml>,
    #[serde(default)]
    mcap: McapToml,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TimeToml {
    column: Option<String>,
    unit: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointToml {
    name: Option<String>,
    motor_name: Option<String>,
    q: Option<Spanned<SourceToml>>,
    theta: Option<Spanned<SourceToml>>,
    dq: Option<Spanned<SourceToml>>,
    tau_el: Option<Spanned<SourceToml>>,
    tau_m: Option<Spanned<SourceToml>>,
    tau_ext: Option<Spanned<SourceToml>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SourceToml {
    column: Option<String>,
    unit: Option<String>,
    scale: Option<f64>,
    gear_ratio: Option<f64>,
    counts_per_turn: Option<f64>,
    torque_constant_nm_per_a: Option<f64>,
    sign: Option<f64>,
    offset: Option<f64>,
    wrap_period: Option<f64>,
    wrap: Option<bool>,
    sum: Option<Vec<Spanned<TermToml>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TermToml {
    column: Option<String>,
    unit: Option<String>,
    scale: Option<f64>,
    gear_ratio: Option<f64>,
    counts_per_turn: Option<f64>,
    torque_constant_nm_per_a: Option<f64>,
    sign: Option<f64>,
    offset: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct McapToml {
    joint_state_topic: Option<String>,
    motor_topic: Option<String>,
    motor_interface: Option<String>,
    motor_effort_interface: Option<String>,
    temperature_interface: Option<String>,
    external_torque_topic: Option<String>,
    joint_effort: Option<Spanned<String>>,
}

struct Context<'a> {
    text: &'a str,
    file: &'a str,
}

impl Context<'_> {
    fn line(&self, byte: usize) -> usize {
        let end = byte.min(self.text.len());
        1 + self.text.as_bytes()[..end]
            .iter()
            .filter(|b| **b == b'\n')
            .count()
    }

    fn error(&self, line: usize, reason: impl Into<String>) -> LogError {
        LogError::Mapping {
            file: self.file.to_owned(),
            line: Some(line),
            reason: reason.into(),
        }
    }
}

pub(crate) fn from_toml(text: &str, file: &str) -> Result<Mapping, LogError> {
    if text.len() > TEXT_LIMIT_BYTES {
        return Err(LogError::Mapping {
            file: file.to_owned(),
            line: None,
            reason: format!(
                "{} bytes long, a mapping may have {TEXT_LIMIT_BYTES}",
                text.len()
            ),
        });
    }
    let context = Context { text, file };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let root: Root = toml::from_str(text).map_err(|error| LogError::Mapping {
        file: file.to_owned(),
        line: error.span().map(|span| context.line(span.start)),
        reason: error.message().trim().replace('\n', "; "),
    })?;

    let time = root.time.map(|time| time_map(&context, time)).transpose()?;
    let temperature = root
        .temperature
        .map(|source| source_map(&context, source, Quantity::Temperature, "temperature"))
        .transpose()?;

    let mut entries: Vec<(Spanned<String>, JointToml)> = root.joints.into_iter().collect();
    entries.sort_by_key(|(name, _)| name.span().start);
    let mut joints = Vec::with_capacity(entries.len());
    for (name, joint) in entries {
        joints.push(joint_map(&context, name, joint)?);
    }

    let mcap = root.mcap;
    let joint_effort = match mcap.joint_effort {
        None => None,
        Some(effort) => Some(match effort.as_ref().as_str() {
            "tau_el" => JointEffort::TauEl,
            "tau_m" => JointEffort::TauM,
            "ignore" => JointEffort::Ignore,
            other => {
                return Err(context.error(
                    context.line(effort.span().start),
                    format!("joint_effort '{other}': known are tau_el, tau_m, ignore"),
                ));
            }
        }),
    };
    Ok(Mapping {
        file: file.to_owned(),
        time,
        temperature,
        joints,
        mcap: McapMap {
            joint_state_topic: mcap.joint_state_topic,
            motor_topic: mcap.motor_topic,
            motor_interface: mcap.motor_interface,
            motor_effort_interface: mcap.motor_effort_interface,
            temperature_interface: mcap.temperature_interface,
            external_torque_topic: mcap.external_torque_topic,
            joint_effort,
        },
    })
}

fn time_map(context: &Context<'_>, time: Spanned<TimeToml>) -> Result<TimeMap, LogError> {
    let time = time.into_inner();
    let exponent = time
        .unit
        .map(|unit| {
            time_unit_exponent(unit.as_ref())
                .map_err(|reason| context.error(context.line(unit.span().start), reason))
        })
        .transpose()?;
    Ok(TimeMap {
        column: time.column,
        exponent,
    })
}

fn joint_map(
    context: &Context<'_>,
    name: Spanned<String>,
    joint: JointToml,
) -> Result<JointMap, LogError> {
    let line = context.line(name.span().start);
    let name = name.into_inner();
    if name.is_empty() {
        return Err(context.error(line, "a joint without a name"));
    }
    let JointToml {
        name: recorded,
        motor_name,
        q,
        theta,
        dq,
        tau_el,
        tau_m,
        tau_ext,
    } = joint;
    let mut sources: [Option<Source>; 6] = Default::default();
    for (quantity, source) in Quantity::PER_JOINT
        .into_iter()
        .zip([q, theta, dq, tau_el, tau_m, tau_ext])
    {
        let Some(source) = source else { continue };
        let key = format!("joints.{name}.{}", quantity.symbol());
        sources[quantity.index()] = Some(source_map(context, source, quantity, &key)?);
    }
    Ok(JointMap {
        name,
        recorded,
        motor_recorded: motor_name,
        sources,
    })
}

fn source_map(
    context: &Context<'_>,
    source: Spanned<SourceToml>,
    quantity: Quantity,
    key: &str,
) -> Result<Source, LogError> {
    let line = context.line(source.span().start);
    let SourceToml {
        column,
        unit,
        scale,
        gear_ratio,
        counts_per_turn,
        torque_constant_nm_per_a,
        sign,
        offset,
        wrap_period,
        wrap,
        sum,
    } = source.into_inner();
    let whole = TermToml {
        column,
        unit,
        scale,
        gear_ratio,
        counts_per_turn,
        torque_constant_nm_per_a,
        sign,
        offset,
    };
    let (mut lengths, mut is_current) = (false, false);
    let terms = match sum {
        None => {
            let (term, unit) = term_map(context, whole, line, quantity, key)?;
            lengths = unit.dimension == Dimension::Length;
            is_current = unit.dimension == Dimension::Current;
            vec![term]
        }
        Some(terms) => {
            let outside = whole.column.is_some()
                || whole.unit.is_some()
                || whole.scale.is_some()
                || whole.gear_ratio.is_some()
                || whole.counts_per_turn.is_some()
                || whole.torque_constant_nm_per_a.is_some()
                || whole.sign.is_some()
                || whole.offset.is_some();
            if outside {
                return Err(context.error(
                    line,
                    format!("{key}: beside 'sum' only wrap and wrap_period may stand; put column, unit and factors into the terms"),
                ));
            }
            if terms.is_empty() {
                return Err(context.error(line, format!("{key}: the sum has no terms")));
            }
            let mut mapped = Vec::with_capacity(terms.len());
            for term in terms {
                let line = context.line(term.span().start);
                let (term, unit) = term_map(context, term.into_inner(), line, quantity, key)?;
                if term.column.is_none() {
                    return Err(context.error(line, format!("{key}: a term without a column")));
                }
                lengths |= unit.dimension == Dimension::Length;
                is_current |= unit.dimension == Dimension::Current;
                mapped.push(term);
            }
            mapped
        }
    };
    let wrap = match (wrap, wrap_period) {
        (Some(false), Some(_)) => {
            return Err(context.error(
                line,
                format!("{key}: wrap = false and a wrap_period exclude each other"),
            ));
        }
        (Some(false), None) => Wrap::Never,
        (_, Some(period)) => {
            if !matches!(quantity, Quantity::Q | Quantity::Theta) {
                return Err(context.error(line, format!("{key}: only positions wrap around")));
            }
            if !(period.is_finite() && period > 0.0) {
                return Err(context.error(
                    line,
                    format!("{key}: wrap_period {period} must be positive"),
                ));
            }
            Wrap::Period(period)
        }
        (None, None) if lengths => Wrap::Never,
        (_, None) => Wrap::default_for(quantity),
    };
    Ok(Source {
        terms,
        wrap,
        is_current,
        line,
    })
}

fn term_map(
    context: &Context<'_>,
    term: TermToml,
    line: usize,
    quantity: Quantity,
    key: &str,
) -> Result<(Term, Unit), LogError> {
    let unit = match &term.unit {
        None => Unit::SI,
        Some(text) => {
            Unit::parse(text).map_err(|reason| context.error(line, format!("{key}: {reason}")))?
        }
    };
    let is_current = unit.dimension == Dimension::Current;
    let constant = term.torque_constant_nm_per_a;
    if is_current != constant.is_some() {
        return Err(context.error(
            line,
            format!(
                "{key}: unit \"A\" (or \"mA\") and torque_constant_nm_per_a, N·m per A at the motor's shaft, need each other"
            ),
        ));
    }
    if is_current && quantity != Quantity::TauM {
        return Err(context.error(
            line,
            format!(
                "{key}: a motor's current can be a tau_m, not a {}",
                quantity.symbol()
            ),
        ));
    }
    if !unit.fits(quantity) && term.scale.is_none() {
        return Err(context.error(
            line,
            format!(
                "{key}: unit '{}' cannot be a {} ({}); give the 'scale' that converts it",
                term.unit.as_deref().unwrap_or(""),
                quantity.symbol(),
                quantity.suffix().trim_start_matches('_'),
            ),
        ));
    }
    let factor = |name: &str, value: Option<f64>, neutral: f64| {
        let value = value.unwrap_or(neutral);
        if value.is_finite() && value != 0.0 {
            Ok(value)
        } else {
            Err(context.error(
                line,
                format!("{key}: {name} {value} must be finite and not zero"),
            ))
        }
    };
    let scale = factor("scale", term.scale, 1.0)?;
    let gear_ratio = factor("gear_ratio", term.gear_ratio, 1.0)?;
    let counts_per_turn = factor("counts_per_turn", term.counts_per_turn, 1.0)?;
    let constant = factor("torque_constant_nm_per_a", constant, 1.0)?;
    if constant < 0.0 {
        return Err(context.error(
            line,
            format!("{key}: torque_constant_nm_per_a {constant} must be above 0; 'sign' turns a motor round"),
        ));
    }
    let sign = factor("sign", term.sign, 1.0)?;
    if sign.abs() != 1.0 {
        return Err(context.error(line, format!("{key}: sign {sign} must be 1 or -1")));
    }
    let offset = term.offset.unwrap_or(0.0);
    if !offset.is_finite() {
        return Err(context.error(line, format!("{key}: offset {offset} must be finite")));
    }
    let is_count = unit.dimension == Dimension::Count;
    if is_count != term.counts_per_turn.is_some() {
        return Err(context.error(
            line,
            format!("{key}: unit \"count\" and counts_per_turn need each other"),
        ));
    }
    let unit_factor = if is_count {
        2.0 * std::f64::consts::PI / counts_per_turn
    } else {
        unit.factor
    };
    // A gear divides what a motor turns by, and multiplies what it pulls with.
    let through_gear = match quantity {
        Quantity::TauEl | Quantity::TauM | Quantity::TauExt => gear_ratio,
        Quantity::Q | Quantity::Theta | Quantity::Dq | Quantity::Temperature => 1.0 / gear_ratio,
    };
    let outer = sign * scale * constant * through_gear;
    let scale = outer * unit_factor;
    let offset = outer * unit.offset + offset;
    if !(scale.is_finite() && scale != 0.0 && offset.is_finite()) {
        return Err(context.error(line, format!("{key}: the factors multiply to {scale}")));
    }
    Ok((
        Term {
            column: term.column,
            scale,
            offset,
            line,
        },
        unit,
    ))
}
