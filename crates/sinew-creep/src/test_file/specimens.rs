//! Rows to specimens.

use super::cells::{Cell, Table};
use super::columns::{Role, column_index, roles, split};
use super::header::{self, Head};
use super::{SourceColumn, TestFile, TestOptions, TestQuantity};
use crate::error::TestFileError;
use sinew_files::names::{list, shorten};
use sinew_files::{Fault, Located};

/// Headers that name a specimen though their cells may be numbers.
const SPECIMEN_WORDS: [&str; 10] = [
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
/// Stands for an attribute that doesn't stay the same over a specimen.
const VARIES: &str = "\u{0}varies";

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
        self.columns[quantity as usize].as_deref()
    }

    /// Sets a column, for specimens that come from a program.
    pub fn set_column(&mut self, quantity: TestQuantity, values: Vec<f64>) {
        self.columns[quantity as usize] = Some(values);
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
        let mut attributes = self.attributes.iter();
        let found = attributes.find(|(key, _)| key.eq_ignore_ascii_case(name));
        found.map(|(_, value)| value.as_str())
    }

    fn add_attributes(&mut self, row: &[Cell], head: &Head, roles: &[Role]) {
        for (index, header) in head.headers.iter().enumerate() {
            if header.is_empty() || roles.iter().any(|role| role.index == index) {
                continue;
            }
            let value = row.get(index).map(Cell::text).unwrap_or_default();
            match self.attributes.iter_mut().find(|(key, _)| key == header) {
                None => self.attributes.push((header.clone(), value)),
                Some((_, held)) if *held != value => *held = VARIES.to_owned(),
                Some(_) => {}
            }
        }
    }
}

/// A row of a table as numbers, one for each role; none of a last line that ends within a word.
fn numbers(
    row: &[Cell],
    roles: &[Role],
    is_last: bool,
    wrong: impl Fn(String, &Role) -> Located,
) -> Result<Option<Vec<f64>>, Located> {
    let mut values = Vec::with_capacity(roles.len());
    for role in roles {
        values.push(match row.get(role.index).unwrap_or(&Cell::Empty) {
            Cell::Empty => f64::NAN,
            Cell::Number(raw) => role.quantity.convert(role.unit, *raw),
            // It says its own unit, whatever the header says.
            Cell::Clock(seconds) if role.quantity == TestQuantity::Time => *seconds,
            Cell::Clock(_) => {
                let name = role.quantity.name();
                return Err(wrong(format!("a date or a time of day is no {name}"), role));
            }
            Cell::Text(_) if is_last => return Ok(None),
            Cell::Text(text) => {
                return Err(wrong("is not a number".to_owned(), role)
                    .value(format!("'{}'", shorten(text, 60)))
                    .cure("empty or nan means not recorded"));
            }
        });
    }
    Ok(Some(values))
}

impl TestFile {
    /// Adds the specimens of a table.
    pub(super) fn add(
        &mut self,
        table: &Table,
        options: &TestOptions,
    ) -> Result<(), TestFileError> {
        let name = self.source.file.clone();
        let refuse = |reason: String| TestFileError::refused(&name, reason);
        let head = header::find(table).map_err(refuse)?;
        let mut notes = table.notes.clone();
        let chosen = &options.columns;
        let roles = roles(&head.headers, &head.units, chosen, &name, &mut notes)?;
        check_roles(&roles, &head, &name)?;
        let keys = key_columns(table, &head, &roles, &options.specimen_columns, &name)?;
        for role in &roles {
            let used = SourceColumn {
                quantity: role.quantity,
                column: head.headers[role.index].clone(),
                unit: role.unit_name.clone(),
            };
            if !self.source.columns.contains(&used) {
                self.source.columns.push(used);
            }
        }
        let start = self.specimens.len();
        let time = roles
            .iter()
            .position(|role| role.quantity == TestQuantity::Time);
        let mut key_open: Option<Vec<String>> = None;
        let (mut first_time, mut last_time) = (f64::NAN, f64::NAN);
        let mut left_out = 0_usize;
        for (index, row) in table.rows.iter().enumerate().skip(head.first_row) {
            if row.iter().all(|cell| matches!(cell, Cell::Empty)) {
                continue;
            }
            let line = table.places[index];
            let wrong = |problem: String, role: &Role| {
                Located::new(&name, Fault::WrongType, problem)
                    .line(line)
                    .column(&head.headers[role.index])
            };
            let is_last = index + 1 == table.rows.len();
            let Some(values) = numbers(row, &roles, is_last, wrong)? else {
                notes.push(format!("the last line ({line}) is cut off and left out"));
                break;
            };
            let at = time.map_or(f64::NAN, |time| values[time]);
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
                if self.specimens.len() - start >= SPECIMEN_LIMIT {
                    return Err(refuse(format!(
                        "more than {SPECIMEN_LIMIT} specimens; name the columns that tell them apart (--specimen)"
                    )));
                }
                self.specimens.push(open(&key, &head, &keys, &roles));
                key_open = Some(key);
                first_time = at;
            }
            last_time = at;
            if let Some(specimen) = self.specimens.last_mut() {
                specimen.lines.push(line);
                for (role, value) in roles.iter().zip(&values) {
                    if let Some(column) = &mut specimen.columns[role.quantity as usize] {
                        column.push(*value);
                    }
                }
                specimen.add_attributes(row, &head, &roles);
            }
        }
        if left_out > 0 {
            notes.push(format!("{left_out} rows without a time are left out"));
        }
        for specimen in &mut self.specimens[start..] {
            // What varies is a signal nobody asked for, not an attribute.
            specimen.attributes.retain(|(_, value)| value != VARIES);
            let samples = specimen.lines.len();
            for &(quantity, value) in &head.constants {
                specimen.columns[quantity as usize].get_or_insert_with(|| vec![value; samples]);
            }
        }
        name_all(&mut self.specimens[start..], &name, &table.title);
        self.source.notes.append(&mut notes);
        Ok(())
    }
}

fn open(key: &[String], head: &Head, keys: &[usize], roles: &[Role]) -> Specimen {
    let words: Vec<&str> = key
        .iter()
        .map(String::as_str)
        .filter(|w| !w.is_empty())
        .collect();
    let mut specimen = Specimen {
        name: words.join(" / "),
        attributes: head.words.clone(),
        ..Specimen::default()
    };
    if let [index] = keys
        && specimen.name.parse::<f64>().is_ok()
    {
        specimen.name = format!("{} {}", head.headers[*index], specimen.name);
    }
    for role in roles {
        specimen.columns[role.quantity as usize] = Some(Vec::new());
    }
    specimen
}

/// Unique names; a file of one nameless specimen gives its own name.
fn name_all(specimens: &mut [Specimen], file: &str, sheet: &str) {
    let stem = std::path::Path::new(file).file_stem();
    let stem = stem.map_or_else(|| file.into(), |stem| stem.to_string_lossy());
    let stem = format!("{stem} {sheet}");
    for specimen in specimens.iter_mut().filter(|s| s.name.is_empty()) {
        let own = specimen
            .attribute("specimen")
            .or_else(|| specimen.attribute("sample"));
        specimen.name = own.unwrap_or(stem.trim_end()).to_owned();
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

fn check_roles(roles: &[Role], head: &Head, file: &str) -> Result<(), TestFileError> {
    use TestQuantity::{Elongation, Modulus, Strain, Time};
    let has = |quantities: &[TestQuantity]| roles.iter().any(|r| quantities.contains(&r.quantity));
    let problem = if !has(&[Time]) {
        "no column is a time; say which, such as time=COLUMN:s"
    } else if !has(&[Elongation, Strain, Modulus]) {
        "no column is an elongation, strain or modulus; say which, such as elongation=COLUMN:mm"
    } else {
        return Ok(());
    };
    let columns = format!("columns are {}", list(&head.headers));
    Err(Located::new(file, Fault::MissingKey, problem)
        .cure(columns)
        .into())
}

fn key_columns(
    table: &Table,
    head: &Head,
    roles: &[Role],
    wanted: &[String],
    file: &str,
) -> Result<Vec<usize>, TestFileError> {
    if !wanted.is_empty() {
        let index = |column: &String| column_index(&head.headers, column, false, file);
        return wanted.iter().map(index).collect();
    }
    let names_specimens = |index: &usize| {
        let lower = split(&head.headers[*index]).0.to_lowercase();
        let mut words = lower.split(|c: char| !c.is_alphanumeric());
        let mut cells = table.rows[head.first_row..]
            .iter()
            .filter_map(|row| row.get(*index));
        words.any(|word| SPECIMEN_WORDS.contains(&word)) || cells.any(Cell::is_text)
    };
    Ok((0..head.headers.len())
        .filter(|index| !roles.iter().any(|role| role.index == *index))
        .filter(names_specimens)
        .collect())
}
