//! What a header says: quantity and unit.

use super::{ColumnChoice, TestQuantity, unit};
use crate::error::LogError;
use crate::unit::Unit;
use sinew_files::names::{hint, list};
use sinew_files::{Fault, Located};

/// Which column was taken for what.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnUse {
    /// What it measures.
    pub quantity: TestQuantity,
    /// Its header.
    pub column: String,
    /// Its unit as found, said or assumed.
    pub unit: String,
}

/// A column with its meaning.
#[derive(Debug, Clone)]
pub(super) struct Role {
    pub(super) quantity: TestQuantity,
    pub(super) index: usize,
    pub(super) unit: Unit,
    pub(super) unit_name: String,
}

/// Words of a header, in English and German, and what they mean.
const WORDS: &[(TestQuantity, &[&str])] = &[
    (
        TestQuantity::GaugeLength,
        &["l0", "gauge", "gaugelength", "messlänge", "einspannlänge"],
    ),
    (TestQuantity::Area, &["area", "querschnitt", "fläche"]),
    (
        TestQuantity::Humidity,
        &["humidity", "rh", "feuchte", "moisture", "luftfeuchte"],
    ),
    (
        TestQuantity::Temperature,
        &["temperature", "temp", "temperatur"],
    ),
    (TestQuantity::Modulus, &["modulus", "relax", "modul"]),
    (
        TestQuantity::Strain,
        &["strain", "dehnung", "epsilon", "eps", "ε"],
    ),
    (TestQuantity::Stress, &["stress", "spannung", "sigma", "σ"]),
    (
        TestQuantity::Elongation,
        &[
            "elongation",
            "extension",
            "displacement",
            "travel",
            "verlängerung",
            "weg",
            "standardweg",
            "traversenweg",
            "dl",
            "δl",
            "stroke",
        ],
    ),
    (
        TestQuantity::Force,
        &[
            "force",
            "load",
            "kraft",
            "standardkraft",
            "last",
            "f",
            "tension",
        ],
    ),
    (
        TestQuantity::Time,
        &["time", "zeit", "prüfzeit", "elapsed", "timestamp", "t"],
    ),
];

/// Words that make another quantity of the one beside them.
const STRANGERS: &[&str] = &[
    "compliance",
    "rate",
    "degree",
    "velocity",
    "speed",
    "std",
    "error",
    "target",
    "max",
    "min",
    "setpoint",
    "soll",
    "date",
    // Ends of an interval, and what pulls two strands at once.
    "low",
    "high",
    "carriage",
];

/// Units at the end of a name as Sinew's own tables write them.
const IN_NAMES: &[(&str, &str)] = &[
    ("n", "N"),
    ("kn", "kN"),
    ("pa", "Pa"),
    ("mpa", "MPa"),
    ("ratio", "m/m"),
    ("percent", "%"),
    ("c", "°C"),
    ("k", "K"),
];

/// Header split into name and unit: `Force (N)`, `Force [N]`, `F / N`, `force_N`, `force_n`, `Force, N`.
pub(super) fn split(header: &str) -> (String, Option<String>) {
    let header = header.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(body) = header.strip_suffix(close)
            && let Some((name, unit)) = body.rsplit_once(open)
        {
            return (name.trim().to_owned(), Some(unit.trim().to_owned()));
        }
    }
    // `force_n`, `strain_percent`: only where the unit can be one of what the name says.
    if let Some((name, end)) = header.rsplit_once('_')
        && let Some((_, unit)) = IN_NAMES.iter().find(|(known, _)| *known == end)
        && let (Some(quantity), Ok(parsed)) = (quantity_of(name, None), unit::parse(unit))
        && parsed.fits(quantity)
    {
        return (name.to_owned(), Some((*unit).to_owned()));
    }
    for separator in [" / ", ", ", " in ", "_", " "] {
        if let Some((name, unit)) = header.rsplit_once(separator)
            && !name.trim().is_empty()
            && unit::parse(unit.trim()).is_ok()
            && !(separator == " " && unit.trim() == "1")
        {
            return (name.trim().to_owned(), Some(unit.trim().to_owned()));
        }
    }
    (header.to_owned(), None)
}

/// What a header measures, if a word of it says so.
pub(super) fn quantity_of(name: &str, unit: Option<&str>) -> Option<TestQuantity> {
    let unit = unit.and_then(|unit| unit::parse(unit).ok());
    // One letter means what its unit or its case says.
    match name.trim() {
        "T" if unit.is_none_or(|unit| unit.fits(TestQuantity::Temperature)) => {
            return Some(TestQuantity::Temperature);
        }
        "E" => return Some(TestQuantity::Modulus),
        _ => {}
    }
    let lower = name.to_lowercase();
    let words: Vec<&str> = lower
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    if words.iter().any(|word| STRANGERS.contains(word)) {
        return None;
    }
    WORDS
        .iter()
        .find(|(_, known)| words.iter().any(|word| known.contains(word)))
        .map(|(quantity, _)| *quantity)
}

/// Meaning of every column that has one.
pub(super) fn roles(
    headers: &[String],
    units: &[String],
    choices: &[ColumnChoice],
    file: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<Role>, LogError> {
    let refuse = |reason: String| LogError::from(Located::new(file, Fault::NotAllowed, reason));
    let mut roles: Vec<Role> = Vec::new();
    for choice in choices {
        let index = headers
            .iter()
            .position(|header| *header == choice.column)
            .or_else(|| {
                headers.iter().position(|header| {
                    header.eq_ignore_ascii_case(&choice.column)
                        || split(header).0.eq_ignore_ascii_case(&choice.column)
                })
            })
            .ok_or_else(|| {
                let hint = hint(&choice.column, headers);
                LogError::request(
                    file,
                    format!(
                        "no column '{}'{hint} columns are {}",
                        choice.column,
                        list(headers)
                    ),
                )
            })?;
        let said = choice
            .unit
            .clone()
            .or_else(|| split(&headers[index]).1)
            .or_else(|| units.get(index).filter(|unit| !unit.is_empty()).cloned());
        roles.push(role(choice.quantity, index, &headers[index], said, notes).map_err(refuse)?);
    }
    for (index, header) in headers.iter().enumerate() {
        if roles.iter().any(|role| role.index == index) {
            continue;
        }
        let (name, unit) = split(header);
        let unit = unit.or_else(|| units.get(index).filter(|unit| !unit.is_empty()).cloned());
        let Some(quantity) = quantity_of(&name, unit.as_deref()) else {
            continue;
        };
        if let Some(first) = roles.iter().find(|role| role.quantity == quantity) {
            if !choices.iter().any(|choice| choice.quantity == quantity) {
                notes.push(format!(
                    "column '{header}' is not used: '{}' is the {} already",
                    headers[first.index],
                    quantity.name()
                ));
            }
            continue;
        }
        match role(quantity, index, header, unit, notes) {
            Ok(found) => roles.push(found),
            // Without these no test can be read right; anything else is left out, and said.
            Err(reason)
                if matches!(
                    quantity,
                    TestQuantity::Time
                        | TestQuantity::Force
                        | TestQuantity::Elongation
                        | TestQuantity::Strain
                ) =>
            {
                return Err(refuse(reason));
            }
            Err(reason) => notes.push(format!("column not used: {reason}")),
        }
    }
    Ok(roles)
}

fn role(
    quantity: TestQuantity,
    index: usize,
    header: &str,
    unit: Option<String>,
    notes: &mut Vec<String>,
) -> Result<Role, String> {
    let name = quantity.name();
    let unit_name = match unit {
        Some(unit) => unit,
        None if quantity == TestQuantity::Strain => {
            notes.push(format!(
                "column '{header}' has no unit: taken as a ratio (m/m); say strain={header}:% if it is in percent"
            ));
            "1".to_owned()
        }
        None => {
            return Err(format!(
                "column '{header}' ({name}) has no unit; say it, such as {name}={header}:{}",
                match quantity {
                    TestQuantity::Elongation | TestQuantity::GaugeLength => "mm",
                    TestQuantity::Area => "mm2",
                    TestQuantity::Stress | TestQuantity::Modulus => "MPa",
                    other => other.unit(),
                }
            ));
        }
    };
    let unit = unit::parse(&unit_name).map_err(|error| format!("column '{header}': {error}"))?;
    if !unit.fits(quantity) {
        return Err(format!(
            "column '{header}' is taken as {name}, but its unit {unit_name} can't be one; say what it is, such as elongation={header}:mm"
        ));
    }
    Ok(Role {
        quantity,
        index,
        unit,
        unit_name,
    })
}
