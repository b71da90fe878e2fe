//! Quantity and unit in the name of a column.

use super::quantity::{TestQuantity, TestQuantity as Q, parse_unit};

/// Words of a header, in English and German, and their quantities.
const WORDS: [(TestQuantity, &str); 10] = [
    (
        Q::GaugeLength,
        "l0 gauge gaugelength messlänge einspannlänge",
    ),
    (Q::Area, "area querschnitt fläche"),
    (Q::Humidity, "humidity rh feuchte moisture luftfeuchte"),
    (Q::Temperature, "temperature temp temperatur"),
    (Q::Modulus, "modulus relax modul"),
    (Q::Strain, "strain dehnung epsilon eps ε"),
    (Q::Stress, "stress spannung sigma σ"),
    (
        Q::Elongation,
        "elongation extension displacement travel verlängerung weg standardweg traversenweg dl δl stroke",
    ),
    (Q::Force, "force load kraft standardkraft last f tension"),
    (Q::Time, "time zeit prüfzeit elapsed timestamp t"),
];

/// Headers that name a specimen even if their cells are numbers.
pub(super) const SPECIMEN_WORDS: [&str; 10] = [
    "specimen",
    "sample",
    "set",
    "test",
    "probe",
    "prüfling",
    "rope",
    "seil",
    "experiment",
    "run",
];

/// Words that change the quantity of the word next to them; the last three are ends of an interval,
/// and a force on two strands at the same time.
const STRANGERS: &str = "compliance rate degree velocity speed std error target max min setpoint soll date low high carriage";

/// Units at the end of a name in Sinew's own tables.
const IN_NAMES: [(&str, &str); 8] = [
    ("n", "N"),
    ("kn", "kN"),
    ("pa", "Pa"),
    ("mpa", "MPa"),
    ("ratio", "m/m"),
    ("percent", "%"),
    ("c", "°C"),
    ("k", "K"),
];

/// Splits a header into name and unit: `Force (N)`, `Force [N]`, `F / N`, `force_N`, `force_n`,
/// `Force, N`.
pub(super) fn split(header: &str) -> (String, Option<String>) {
    let header = header.trim();
    let found = |name: &str, unit: &str| (name.trim().to_owned(), Some(unit.trim().to_owned()));
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(body) = header.strip_suffix(close)
            && let Some((name, unit)) = body.rsplit_once(open)
        {
            return found(name, unit);
        }
    }
    // `force_n`, `strain_percent`: only if the unit is possible for the quantity of the name.
    if let Some((name, end)) = header.rsplit_once('_')
        && let Some((_, unit)) = IN_NAMES.iter().find(|(suffix, _)| *suffix == end)
        && let (Some(quantity), Ok(parsed)) = (quantity_of(name, None), parse_unit(unit))
        && quantity.may_be_in(parsed)
    {
        return (name.to_owned(), Some((*unit).to_owned()));
    }
    for separator in [" / ", ", ", " in ", "_", " "] {
        if let Some((name, unit)) = header.rsplit_once(separator)
            && !name.trim().is_empty()
            && parse_unit(unit.trim()).is_ok()
            && !(separator == " " && unit.trim() == "1")
        {
            return found(name, unit);
        }
    }
    (header.to_owned(), None)
}

/// Quantity of a header, if a word of it names one.
pub(super) fn quantity_of(name: &str, unit: Option<&str>) -> Option<TestQuantity> {
    let unit = unit.and_then(|unit| parse_unit(unit).ok());
    // A single letter is interpreted by its case and its unit; with another unit it names a specimen.
    let is_possible = |quantity: TestQuantity| unit.is_none_or(|unit| quantity.may_be_in(unit));
    let letter = match name.trim() {
        "T" if is_possible(Q::Temperature) => Some(Q::Temperature),
        "E" => Some(Q::Modulus),
        "F" | "f" => Some(Q::Force),
        "T" | "t" => Some(Q::Time),
        _ => None,
    };
    if letter.is_some() {
        return letter.filter(|quantity| is_possible(*quantity));
    }
    let lower = name.to_lowercase();
    let is_among = |list: &str| {
        let mut words = lower.split(|c: char| !c.is_alphanumeric());
        words.any(|word| !word.is_empty() && list.split(' ').any(|listed| listed == word))
    };
    if is_among(STRANGERS) {
        return None;
    }
    let found = WORDS.iter().find(|(_, words)| is_among(words));
    found.map(|(quantity, _)| *quantity)
}
