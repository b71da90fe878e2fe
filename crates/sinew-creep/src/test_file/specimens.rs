//! Conversion of table rows to specimens.

use super::cells::{Cell, Table};
use super::columns::{column_index, roles};
use super::header::{self, Head};
use super::labels::{self, MEASURED};
use super::names::{SPECIMEN_WORDS, split};
use super::role::Role;
use super::{SourceColumn, TestFile, TestOptions, TestQuantity};
use crate::error::TestFileError;
use sinew_files::date::{ClockColumn, is_stamp};
use sinew_files::names::{list, shorten};
use sinew_files::{Fault, Located};
use std::collections::{BTreeSet, HashMap};

/// Maximum number of specimens of one file; more indicate that a column of values names them.
const MAX_SPECIMENS: usize = 20_000;
/// Marker of an attribute that varies over a specimen.
const VARIES: &str = "\u{0}varies";
/// Words of a dimension of a specimen, which is constant.
const DIMENSION_WORDS: [&str; 8] = [
    "diameter",
    "durchmesser",
    "length",
    "länge",
    "width",
    "breite",
    "thickness",
    "dicke",
];

/// Data of one specimen: a column of numbers per quantity, NaN for missing values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Specimen {
    /// Name, unique in its file; the file's stem if the file has one specimen.
    pub name: String,
    /// Cells that are constant over the specimen, and names and values above the header.
    pub attributes: Vec<(String, String)>,
    /// Line, or row of a workbook, of each sample.
    pub lines: Vec<u64>,
    columns: [Option<Vec<f64>>; TestQuantity::ALL.len()],
    /// Last written digit of each column, in its internal unit; 0 if unknown.
    digits: [f64; TestQuantity::ALL.len()],
}

impl Specimen {
    /// Samples of a quantity in its internal unit; `None` if not recorded.
    pub fn column(&self, quantity: TestQuantity) -> Option<&[f64]> {
        self.columns[quantity as usize].as_deref()
    }

    /// Sets a column of a specimen created by a program.
    pub fn set_column(&mut self, quantity: TestQuantity, values: Vec<f64>) {
        self.columns[quantity as usize] = Some(values);
    }

    /// Value of the last digit in which a column is written, in its internal unit; 0 if unknown.
    pub(crate) fn last_digit(&self, quantity: TestQuantity) -> f64 {
        self.digits[quantity as usize]
    }

    /// Value of a quantity that is constant within one part in a million.
    pub fn constant(&self, quantity: TestQuantity) -> Option<f64> {
        let values = self.column(quantity)?;
        let mut finite = values.iter().copied().filter(|value| value.is_finite());
        let first = finite.next()?;
        finite
            .all(|value| (value - first).abs() <= 1e-6 * first.abs())
            .then_some(first)
    }

    /// Value of an attribute by its name, without regard to case.
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

/// Smallest power of ten of which a number, as it is written, is a multiple; 0 for a number that is not finite.
fn last_digit(raw: f64) -> f64 {
    let written = format!("{raw:e}");
    let Some((mantissa, exponent)) = written.split_once('e') else {
        return 0.0;
    };
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len() as i32);
    exponent
        .parse()
        .map_or(0.0, |exponent: i32| 10f64.powi(exponent - decimals))
}

/// Row of a table as numbers, one for each role; `None` for a last line that ends within a word.
fn numbers(
    row: &[Cell],
    roles: &[Role],
    is_last: bool,
    clock: &mut ClockColumn,
    wrong: impl Fn(String, &Role) -> Located,
) -> Result<Option<Vec<f64>>, Located> {
    let mut values = Vec::with_capacity(roles.len());
    for role in roles {
        values.push(match row.get(role.index).unwrap_or(&Cell::Empty) {
            Cell::Empty => f64::NAN,
            Cell::Number(raw) => role.quantity.convert(role.unit, *raw),
            // A clock cell has its own unit, independent of the header.
            Cell::Clock(seconds) if role.quantity == TestQuantity::Time => *seconds,
            Cell::Clock(_) => {
                let name = role.quantity.name();
                return Err(wrong(format!("a date or a time of day is no {name}"), role));
            }
            Cell::Text(text) if role.quantity == TestQuantity::Time && is_stamp(text) => {
                clock.read(text).map_or(f64::NAN, |ns| ns as f64 * 1e-9)
            }
            Cell::Text(_) if is_last => return Ok(None),
            Cell::Text(text) => {
                return Err(wrong("is not a number".to_owned(), role)
                    .value(format!("'{}'", shorten(text, 60)))
                    .cure("leave it empty or use nan for a missing value"));
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
        let invalid = |reason: String| TestFileError::invalid(&name, reason);
        let head = header::find(table).map_err(invalid)?;
        let mut notes = table.notes.clone();
        let roles = roles(&head, &options.columns, &name, &mut notes)?;
        let labels = labels::specimens_of(&roles);
        for label in &labels {
            check_roles(&labels::of_specimen(&roles, label.as_deref()), &head, &name)?;
        }
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
        for label in &labels {
            self.add_rows(table, &head, &roles, label.as_deref(), &keys, &mut notes)?;
        }
        note_mixed(&self.specimens[start..], table, &head, &roles, &mut notes);
        for specimen in &mut self.specimens[start..] {
            // A varying attribute is an unused signal.
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

    /// Adds the specimens of the rows of a table.
    ///
    /// * `label`: specimen whose columns are read; `None` if the table has one specimen per row.
    fn add_rows(
        &mut self,
        table: &Table,
        head: &Head,
        all: &[Role],
        label: Option<&str>,
        keys: &[usize],
        notes: &mut Vec<String>,
    ) -> Result<(), TestFileError> {
        let name = self.source.file.clone();
        let roles = labels::of_specimen(all, label);
        let label = label.map(|label| shown_label(label, &roles, head));
        let start = self.specimens.len();
        let time = roles
            .iter()
            .position(|role| role.quantity == TestQuantity::Time);
        // Rows of a specimen that a column names continue it, also after rows of another one.
        let are_named = keys.iter().all(|key| names_specimen(&head.headers[*key]));
        let mut open: Option<Run> = None;
        let mut closed: HashMap<Vec<String>, Run> = HashMap::new();
        let mut ignored = 0_usize;
        let mut clock = ClockColumn::default();
        for (index, row) in table.rows.iter().enumerate().skip(head.first_row) {
            if header::is_remark(row) || row.iter().all(|cell| matches!(cell, Cell::Empty)) {
                continue;
            }
            let line = table.places[index];
            let wrong = |problem: String, role: &Role| {
                Located::new(&name, Fault::WrongType, problem)
                    .line(line)
                    .column(&head.headers[role.index])
            };
            let is_last = index + 1 == table.rows.len();
            let Some(values) = numbers(row, &roles, is_last, &mut clock, wrong)? else {
                notes.push(format!("the last line ({line}) is incomplete and ignored"));
                break;
            };
            let is_measured =
                |(role, value): (&Role, &f64)| MEASURED.contains(&role.quantity) && !value.is_nan();
            // Tests next to each other end at different rows.
            if label.is_some() && !roles.iter().zip(&values).any(is_measured) {
                continue;
            }
            let at = time.map_or(f64::NAN, |time| values[time]);
            if at.is_nan() {
                ignored += 1;
                continue;
            }
            let key: Vec<String> = keys
                .iter()
                .map(|key| row.get(*key).map(Cell::text).unwrap_or_default())
                .collect();
            let run = match open.take() {
                Some(run) if run.key == key && !run.is_restarted(at) => Some(run),
                Some(run) => {
                    closed.insert(run.key.clone(), run);
                    let earlier = closed.remove(&key).filter(|_| are_named);
                    earlier.filter(|run| at >= run.last_s)
                }
                None => None,
            };
            let mut run = match run {
                Some(run) => run,
                None => {
                    if self.specimens.len() - start >= MAX_SPECIMENS {
                        return Err(TestFileError::invalid(
                            &name,
                            format!(
                                "more than {MAX_SPECIMENS} specimens; name the columns that identify a specimen (--specimen)"
                            ),
                        ));
                    }
                    let words = key.iter().chain(&label).cloned().collect::<Vec<_>>();
                    self.specimens
                        .push(new_specimen(&words, head, keys, &roles));
                    Run {
                        key,
                        specimen: self.specimens.len() - 1,
                        first_s: at,
                        last_s: at,
                    }
                }
            };
            run.last_s = at;
            let specimen = &mut self.specimens[run.specimen];
            specimen.lines.push(line);
            for (role, value) in roles.iter().zip(&values) {
                if let Some(column) = &mut specimen.columns[role.quantity as usize] {
                    column.push(*value);
                }
                if let Some(Cell::Number(raw)) = row.get(role.index)
                    && *raw != 0.0
                {
                    let digit = role.unit.factor * last_digit(*raw);
                    let least = &mut specimen.digits[role.quantity as usize];
                    *least = if *least > 0.0 {
                        least.min(digit)
                    } else {
                        digit
                    };
                }
            }
            specimen.add_attributes(row, head, all);
            open = Some(run);
        }
        if ignored > 0 {
            notes.push(format!("{ignored} rows without a time are ignored"));
        }
        Ok(())
    }
}

/// Rows of one specimen while a table is read.
struct Run {
    /// Cells that identify the specimen.
    key: Vec<String>,
    /// Index of the specimen.
    specimen: usize,
    /// First and last time, s.
    first_s: f64,
    last_s: f64,
}

impl Run {
    /// Whether a time starts another specimen: a clock that returns towards its start by more than half of the elapsed
    /// time. A smaller step back is an artefact of the recording, which the analysis handles. (Some programs write
    /// the latest sample first: that is no restart.)
    fn is_restarted(&self, at_s: f64) -> bool {
        self.last_s > self.first_s
            && at_s < self.last_s
            && at_s - self.first_s < 0.5 * (self.last_s - self.first_s)
    }
}

/// Label of a specimen as its name: a number needs the word before it.
fn shown_label(label: &str, roles: &[Role], head: &Head) -> String {
    let is_own = |role: &&Role| role.label.is_some() && MEASURED.contains(&role.quantity);
    match roles.iter().find(is_own) {
        Some(role) if label.parse::<f64>().is_ok() => split(&head.headers[role.index]).0,
        _ => label.to_owned(),
    }
}

/// New specimen with the cells that name it.
fn new_specimen(words: &[String], head: &Head, keys: &[usize], roles: &[Role]) -> Specimen {
    let words: Vec<&str> = words
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

/// Assigns unique names; a single nameless specimen gets the name of its file.
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
    let mut seen: HashMap<String, usize> = HashMap::new();
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
        "no column is a time; set it, for example time=COLUMN:s"
    } else if !has(&[Elongation, Strain, Modulus]) {
        "no column is an elongation, strain or modulus; set one, for example elongation=COLUMN:mm"
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
        let rows = table.rows[head.first_row..].iter();
        let mut cells = rows
            .filter(|row| !header::is_remark(row))
            .filter_map(|row| row.get(*index));
        // A date or a clock next to the time names no specimen.
        names_specimen(&head.headers[*index])
            || cells.any(|cell| cell.is_text() && !cell.is_clock())
    };
    Ok((0..head.headers.len())
        .filter(|index| !roles.iter().any(|role| role.index == *index))
        .filter(names_specimens)
        .collect())
}

/// Whether a word of a header names a specimen.
fn names_specimen(header: &str) -> bool {
    contains_word(header, &SPECIMEN_WORDS)
}

fn contains_word(header: &str, listed: &[&str]) -> bool {
    let lower = split(header).0.to_lowercase();
    let mut words = lower.split(|c: char| !c.is_alphanumeric());
    words.any(|word| listed.contains(&word))
}

/// Notes columns that show that rows of several specimens are mixed: names of specimens, and dimensions, with several
/// values in one specimen.
fn note_mixed(
    specimens: &[Specimen],
    table: &Table,
    head: &Head,
    roles: &[Role],
    notes: &mut Vec<String>,
) {
    /// Minimum mean number of rows of one value: a name or a dimension repeats, a signal does not.
    const MIN_ROWS_OF_VALUE: usize = 5;
    for (index, header) in head.headers.iter().enumerate() {
        let role = roles.iter().find(|role| role.index == index);
        let is_dimension = match role.map(|role| role.quantity) {
            Some(TestQuantity::GaugeLength | TestQuantity::Area) => true,
            Some(_) => false,
            None => contains_word(header, &DIMENSION_WORDS),
        };
        if !is_dimension && (role.is_some() || !names_specimen(header)) {
            continue;
        }
        let is_mixed = |specimen: &&Specimen| match role {
            Some(role) => specimen.constant(role.quantity).is_none(),
            None => specimen.attribute(header) == Some(VARIES),
        };
        let Some(specimen) = specimens.iter().find(is_mixed) else {
            continue;
        };
        let cells = table.rows[head.first_row..].iter();
        let cells = cells.filter_map(|row| row.get(index));
        let cells = cells.filter(|cell| !matches!(cell, Cell::Empty));
        let cells: Vec<String> = cells.map(Cell::text).collect();
        let values: BTreeSet<&String> = cells.iter().collect();
        if values.len() < 2 || values.len() * MIN_ROWS_OF_VALUE > cells.len() {
            continue;
        }
        notes.push(format!(
            "column '{header}' has {} values, but its rows are one specimen, '{}': specimens are mixed; separate them with --specimen \"{header}\"",
            values.len(),
            if specimen.name.is_empty() { "the file" } else { &specimen.name },
        ));
    }
}
