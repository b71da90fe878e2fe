//! Quantity and unit of a column from its header.

use super::header::Head;
use super::labels;
use super::names::{quantity_of, split};
use super::quantity::{TestQuantity as Q, parse_unit};
use super::role::Role;
use super::{ColumnChoice, TestQuantity};
use crate::error::TestFileError;
use sinew_files::names::{hint, list};
use sinew_files::unit::Dimension as D;
use sinew_files::{Fault, Located};

/// Words of a header of clock times or dates, which are the time where no other column is.
const CLOCK_WORDS: [&str; 6] = [
    "uhrzeit",
    "zeitstempel",
    "zeitpunkt",
    "datetime",
    "date",
    "datum",
];

/// Index of a requested column by its header, exactly, without regard to case, or (with `bare`)
/// without its unit.
pub(super) fn column_index(
    headers: &[String],
    wanted: &str,
    bare: bool,
    file: &str,
) -> Result<usize, TestFileError> {
    let exact = headers.iter().position(|header| header == wanted);
    let near = |header: &String| {
        header.eq_ignore_ascii_case(wanted) || bare && split(header).0.eq_ignore_ascii_case(wanted)
    };
    exact
        .or_else(|| headers.iter().position(near))
        .ok_or_else(|| {
            let (hint, list) = (hint(wanted, headers), list(headers));
            TestFileError::Request {
                file: file.to_owned(),
                reason: format!("column '{wanted}' not found{hint} columns are {list}"),
            }
        })
}

/// Role of every column that has one.
pub(super) fn roles(
    head: &Head,
    choices: &[ColumnChoice],
    file: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<Role>, TestFileError> {
    let invalid =
        |reason: String| TestFileError::from(Located::new(file, Fault::NotAllowed, reason));
    let headers = &head.headers;
    let below = |index: usize| {
        head.units
            .get(index)
            .filter(|unit| !unit.is_empty())
            .cloned()
    };
    // The unit of clock times is their own, independent of the header, such as hh:mm:ss.
    let clock = |index: usize| {
        head.clocks
            .get(index)
            .is_some_and(|is| *is)
            .then(|| "s".to_owned())
    };
    let mut roles: Vec<Role> = Vec::new();
    for choice in choices {
        let index = column_index(headers, &choice.column, true, file)?;
        let header = &headers[index];
        let stated = choice.unit.clone().or_else(|| clock(index));
        let stated = stated.or_else(|| split(header).1);
        let unit = stated.or_else(|| below(index));
        roles.push(role(choice.quantity, index, header, unit, notes).map_err(invalid)?);
    }
    label_choices(&mut roles, headers).map_err(invalid)?;
    // Columns of a quantity that another column has already.
    let mut others: Vec<Role> = Vec::new();
    // Clock times last: a time in seconds next to them has the finer resolution.
    let mut order: Vec<usize> = (0..headers.len()).collect();
    order.sort_by_key(|index| clock(*index).is_some());
    for index in order {
        let header = &headers[index];
        if roles.iter().any(|role| role.index == index) {
            continue;
        }
        let (name, unit) = split(header);
        let unit = clock(index).or(unit).or_else(|| below(index));
        let Some(quantity) = quantity_of(&name, unit.as_deref()) else {
            continue;
        };
        if roles.iter().any(|role| role.quantity == quantity) {
            if !choices.iter().any(|choice| choice.quantity == quantity) {
                match role(quantity, index, header, unit, &mut Vec::new()) {
                    Ok(other) => others.push(other),
                    Err(reason) => notes.push(format!("column not used: {reason}")),
                }
            }
            continue;
        }
        match role(quantity, index, header, unit, notes) {
            Ok(found) => roles.push(found),
            // Without these no test can be read correctly; any other column is ignored with a note.
            Err(reason) if matches!(quantity, Q::Time | Q::Force | Q::Elongation | Q::Strain) => {
                return Err(invalid(reason));
            }
            Err(reason) => notes.push(format!("column not used: {reason}")),
        }
    }
    for other in labels::assign(&mut roles, others, headers) {
        let first = roles.iter().find(|role| role.quantity == other.quantity);
        notes.push(format!(
            "column '{}' is not used: '{}' is the {} already",
            headers[other.index],
            first.map_or("", |first| &headers[first.index]),
            other.quantity.name()
        ));
    }
    let is_measured = |role: &Role| labels::MEASURED.contains(&role.quantity);
    if !roles.iter().any(is_measured) {
        add_unnamed(&mut roles, head, notes).map_err(invalid)?;
    }
    labels::leave_shared(&mut roles, headers, notes);
    if !roles.iter().any(|role| role.quantity == Q::Time) {
        let is_named = |index: usize, word: &str| {
            let name = headers[index].to_lowercase();
            name.split(|c: char| !c.is_alphanumeric())
                .any(|w| w == word)
        };
        let named = |word| (0..headers.len()).find(|i| clock(*i).is_some() && is_named(*i, word));
        if let Some(index) = CLOCK_WORDS.into_iter().find_map(named) {
            let unit = clock(index);
            roles.push(role(Q::Time, index, &headers[index], unit, notes).map_err(invalid)?);
        }
    }
    Ok(roles)
}

/// Assigns columns that the user specified for one quantity to specimens.
fn label_choices(roles: &mut [Role], headers: &[String]) -> Result<(), String> {
    for quantity in Q::ALL {
        let of = roles.iter().filter(|role| role.quantity == quantity);
        let names: Vec<String> = of.map(|role| split(&headers[role.index]).0).collect();
        if names.len() < 2 {
            continue;
        }
        if !labels::MEASURED.contains(&quantity) {
            return Err(format!(
                "the {} is set by {} columns; set one",
                quantity.name(),
                names.len()
            ));
        }
        let found = labels::labels(&names).unwrap_or(names);
        labels::label(roles, quantity, &found);
    }
    Ok(())
}

/// Adds columns that only a specimen and a unit name, such as `A_mm`, `B_mm`: a length is an elongation, a ratio a
/// strain.
fn add_unnamed(roles: &mut Vec<Role>, head: &Head, notes: &mut Vec<String>) -> Result<(), String> {
    for (quantity, dimension) in [(Q::Elongation, D::Length), (Q::Strain, D::Ratio)] {
        let mut found: Vec<(usize, String, String)> = Vec::new();
        for (index, header) in head.headers.iter().enumerate() {
            let (name, unit) = split(header);
            let below = head.units.get(index).filter(|unit| !unit.is_empty());
            let Some(unit) = unit.or_else(|| below.cloned()) else {
                continue;
            };
            let is_free = !roles.iter().any(|role| role.index == index);
            if is_free && parse_unit(&unit).is_ok_and(|unit| unit.dimension == dimension) {
                found.push((index, name, unit));
            }
        }
        let names: Vec<String> = found.iter().map(|column| column.1.clone()).collect();
        if names.len() < 2 {
            continue;
        }
        let Some(labels) = labels::labels_alone(&names) else {
            continue;
        };
        for (index, _, unit) in found {
            let header = &head.headers[index];
            roles.push(role(quantity, index, header, Some(unit), notes)?);
        }
        labels::label(roles, quantity, &labels);
        return Ok(());
    }
    Ok(())
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
        None if quantity == Q::Strain => {
            notes.push(format!(
                "column '{header}' has no unit: interpreted as a ratio (m/m); set strain={header}:% if it is in percent"
            ));
            "1".to_owned()
        }
        None => {
            return Err(format!(
                "column '{header}' ({name}) has no unit; set it, for example {name}={header}:{}",
                quantity.customary_unit()
            ));
        }
    };
    let unit = parse_unit(&unit_name).map_err(|error| format!("column '{header}': {error}"))?;
    if !quantity.may_be_in(unit) {
        return Err(format!(
            "column '{header}' is interpreted as {name}, but {unit_name} is not a unit of it; set its quantity, for example elongation={header}:mm"
        ));
    }
    Ok(Role {
        quantity,
        index,
        unit,
        unit_name,
        label: None,
    })
}
