//! Rows to specimens.

use super::cells::{Cell, Table};
use super::columns::{ColumnUse, Role, roles, split};
use super::header::{self, Head};
use super::{TestFile, TestOptions, TestQuantity};
use crate::error::LogError;
use sinew_files::names::{hint, list, shorten};
use sinew_files::{Fault, Located};

/// Headers that name a specimen though their cells may be numbers.
const SPECIMEN_WORDS: &[&str] = &[
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
/// Most specimens of one file: more means that a column of values names them.
const SPECIMEN_LIMIT: usize = 20_000;

/// One specimen: a column of numbers per quantity, NaN where nothing was recorded.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Specimen {
    /// Name, unique in its file; the file's stem where the file has one specimen.
    pub name: String,
    /// Cells that stay the same over the specimen, and names and values above the header.
    pub attributes: Vec<(String, String)>,
    /// Line, or row of a workbook, of each sample.
    pub lines: Vec<u64>,
    columns: [Option<Vec<f64>>; TestQuantity::ALL.len()],
}

impl Specimen {
    /// Samples of a quantity in the unit it is kept in; `None`: not recorded.
    pub fn column(&self, quantity: TestQuantity) -> Option<&[f64]> {
        self.columns[slot(quantity)].as_deref()
    }

    /// Sets a column, for specimens that come from a program.
    pub fn set_column(&mut self, quantity: TestQuantity, values: Vec<f64>) {
        self.columns[slot(quantity)] = Some(values);
    }

    /// The only value of a quantity, where it doesn't change by more than one part in a million.
    pub fn constant(&self, quantity: TestQuantity) -> Option<f64> {
        let values = self.column(quantity)?;
        let mut finite = values.iter().copied().filter(|value| value.is_finite());
        let first = finite.next()?;
        finite
            .all(|value| (value - first).abs() <= 1e-6 * first.abs())
            .then_some(first)
    }

    /// An attribute by its name, without regard to case.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|(key, _)| key.eq_ignore_ascii_case(name))
            .map(|(_, value)| value.as_str())
    }
}

fn slot(quantity: TestQuantity) -> usize {
    TestQuantity::ALL
        .iter()
        .position(|known| *known == quantity)
        .unwrap_or(0)
}

/// Adds the specimens of a table.
pub(super) fn take(
    table: &Table,
    name: &str,
    options: &TestOptions,
    file: &mut TestFile,
) -> Result<(), LogError> {
    let refuse = |reason: String| LogError::refused(name, reason);
    let head = header::find(table).map_err(refuse)?;
    let mut notes = table.notes.clone();
    let roles = roles(
        &head.headers,
        &head.units,
        &options.columns,
        name,
        &mut notes,
    )?;
    check_roles(&roles, &head, name)?;
    let keys = key_columns(table, &head, &roles, &options.specimen_columns, name)?;
    for role in &roles {
        let used = ColumnUse {
            quantity: role.quantity,
            column: head.headers[role.index].clone(),
            unit: role.unit_name.clone(),
        };
        if !file.columns.contains(&used) {
            file.columns.push(used);
        }
    }

    let start = file.specimens.len();
    let time = roles
        .iter()
        .find(|role| role.quantity == TestQuantity::Time);
    let wrong = |problem: &str, line, role: &Role| {
        Located::new(name, Fault::WrongType, problem)
            .line(line)
            .column(&head.headers[role.index])
    };
    let mut key_open: Option<Vec<String>> = None;
    let (mut first_time, mut last_time) = (f64::NAN, f64::NAN);
    let mut left_out = 0_usize;
    for (index, row) in table.rows.iter().enumerate().skip(head.first_row) {
        if row.iter().all(|cell| matches!(cell, Cell::Empty)) {
            continue;
        }
        let line = table.places[index];
        let last = index + 1 == table.rows.len();
        let mut values = Vec::with_capacity(roles.len());
        let mut cut_off = false;
        for role in &roles {
            match row.get(role.index).unwrap_or(&Cell::Empty) {
                Cell::Empty => values.push(f64::NAN),
                Cell::Number(raw) => values.push(role.unit.convert(role.quantity, *raw)),
                // It says its own unit, whatever the header says.
                Cell::Clock(seconds) if role.quantity == TestQuantity::Time => {
                    values.push(*seconds);
                }
                Cell::Clock(_) => {
                    let problem = format!("a date or a time of day is no {}", role.quantity.name());
                    return Err(wrong(&problem, line, role).into());
                }
                Cell::Text(_) if last => cut_off = true,
                Cell::Text(text) => {
                    return Err(wrong("is not a number", line, role)
                        .value(format!("'{}'", shorten(text, 60)))
                        .cure("empty or nan means not recorded")
                        .into());
                }
            }
        }
        if cut_off {
            notes.push(format!("the last line ({line}) is cut off and left out"));
            break;
        }
        let at = time.map_or(f64::NAN, |time| {
            let place = roles.iter().position(|role| role.index == time.index);
            place.map_or(f64::NAN, |place| values[place])
        });
        if at.is_nan() {
            left_out += 1;
            continue;
        }
        let key: Vec<String> = keys
            .iter()
            .map(|key| row.get(*key).map(Cell::text).unwrap_or_default())
            .collect();
        // A clock that falls back to its start by more than half of what has passed is another
        // specimen; a smaller step back is a fault of the recording, for the analysis to judge.
        // (Some programs write the latest reading first: that is no new start.)
        let anew = last_time > first_time
            && at < last_time
            && at - first_time < 0.5 * (last_time - first_time);
        if key_open.as_ref() != Some(&key) || anew {
            if file.specimens.len() - start >= SPECIMEN_LIMIT {
                return Err(LogError::refused(
                    name,
                    format!(
                        "more than {SPECIMEN_LIMIT} specimens; name the columns that tell them apart (--specimen)"
                    ),
                ));
            }
            file.specimens.push(open(&key, &head, &keys, &roles));
            key_open = Some(key);
            first_time = at;
        }
        last_time = at;
        if let Some(specimen) = file.specimens.last_mut() {
            specimen.lines.push(line);
            for (role, value) in roles.iter().zip(&values) {
                if let Some(column) = &mut specimen.columns[slot(role.quantity)] {
                    column.push(*value);
                }
            }
            attributes(specimen, row, &head, &roles);
        }
    }
    if left_out > 0 {
        notes.push(format!("{left_out} rows without a time are left out"));
    }
    for specimen in &mut file.specimens[start..] {
        // What varies is a signal nobody asked for, not an attribute.
        specimen.attributes.retain(|(_, value)| value != VARIES);
        for &(quantity, value) in &head.constants {
            let samples = specimen.lines.len();
            let column = &mut specimen.columns[slot(quantity)];
            if column.is_none() {
                *column = Some(vec![value; samples]);
            }
        }
    }
    name_all(&mut file.specimens[start..], name, &table.title);
    file.notes.append(&mut notes);
    Ok(())
}

const VARIES: &str = "\u{0}varies";

fn open(key: &[String], head: &Head, keys: &[usize], roles: &[Role]) -> Specimen {
    let mut specimen = Specimen {
        name: key
            .iter()
            .filter(|word| !word.is_empty())
            .cloned()
            .collect::<Vec<_>>()
            .join(" / "),
        attributes: head.words.clone(),
        ..Specimen::default()
    };
    if let ([_], [index]) = (key, keys)
        && specimen.name.parse::<f64>().is_ok()
    {
        specimen.name = format!("{} {}", head.headers[*index], specimen.name);
    }
    for role in roles {
        specimen.columns[slot(role.quantity)] = Some(Vec::new());
    }
    specimen
}

fn attributes(specimen: &mut Specimen, row: &[Cell], head: &Head, roles: &[Role]) {
    for (index, header) in head.headers.iter().enumerate() {
        if header.is_empty() || roles.iter().any(|role| role.index == index) {
            continue;
        }
        let value = row.get(index).map(Cell::text).unwrap_or_default();
        match specimen
            .attributes
            .iter_mut()
            .find(|(key, _)| key == header)
        {
            None => specimen.attributes.push((header.clone(), value)),
            Some((_, held)) if *held != value && held != VARIES => *held = VARIES.to_owned(),
            Some(_) => {}
        }
    }
}

/// Unique names; a file of one nameless specimen gives its own name.
fn name_all(specimens: &mut [Specimen], file: &str, sheet: &str) {
    let stem = std::path::Path::new(file).file_stem().map_or_else(
        || file.to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    let stem = if sheet.is_empty() {
        stem
    } else {
        format!("{stem} {sheet}")
    };
    for specimen in specimens.iter_mut().filter(|s| s.name.is_empty()) {
        specimen.name = specimen
            .attribute("specimen")
            .or_else(|| specimen.attribute("sample"))
            .unwrap_or(&stem)
            .to_owned();
    }
    let mut seen: std::collections::HashMap<String, usize> = std::collections::HashMap::new();
    for specimen in specimens {
        let count = seen.entry(specimen.name.clone()).or_insert(0);
        *count += 1;
        if *count > 1 {
            specimen.name = format!("{} #{count}", specimen.name);
        }
    }
}

fn check_roles(roles: &[Role], head: &Head, file: &str) -> Result<(), LogError> {
    let has = |quantity| roles.iter().any(|role| role.quantity == quantity);
    let refuse = |reason: String| {
        Err(Located::new(file, Fault::MissingKey, reason)
            .cure(format!("columns are {}", list(&head.headers)))
            .into())
    };
    if !has(TestQuantity::Time) {
        return refuse("no column is a time; say which, such as time=COLUMN:s".to_owned());
    }
    if ![
        TestQuantity::Elongation,
        TestQuantity::Strain,
        TestQuantity::Modulus,
    ]
    .into_iter()
    .any(has)
    {
        return refuse(
            "no column is an elongation, strain or modulus; say which, such as elongation=COLUMN:mm"
                .to_owned(),
        );
    }
    Ok(())
}

fn key_columns(
    table: &Table,
    head: &Head,
    roles: &[Role],
    wanted: &[String],
    file: &str,
) -> Result<Vec<usize>, LogError> {
    if !wanted.is_empty() {
        return wanted
            .iter()
            .map(|column| {
                head.headers
                    .iter()
                    .position(|header| header.eq_ignore_ascii_case(column))
                    .ok_or_else(|| {
                        let hint = hint(column, &head.headers);
                        LogError::request(
                            file,
                            format!(
                                "no column '{column}'{hint} columns are {}",
                                list(&head.headers)
                            ),
                        )
                    })
            })
            .collect();
    }
    Ok((0..head.headers.len())
        .filter(|index| !roles.iter().any(|role| role.index == *index))
        .filter(|&index| {
            let (bare, _) = split(&head.headers[index]);
            let lower = bare.to_lowercase();
            let named = lower
                .split(|c: char| !c.is_alphanumeric())
                .any(|word| SPECIMEN_WORDS.contains(&word));
            let text = table.rows[head.first_row..]
                .iter()
                .filter_map(|row| row.get(index))
                .any(Cell::is_text);
            named || text
        })
        .collect())
}
