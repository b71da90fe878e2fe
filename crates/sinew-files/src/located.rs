//! The one error of a text file: TOML, CSV, URDF.

use crate::Bound;
use std::fmt;
use std::ops::Deref;

/// What is wrong at one place of a file, and what to do.
///
/// Read as one line: `robot.toml, line 6: joints.elbow.stiffness_nm_per_rad = -4 (N·m/rad): must be
/// above 0 N·m/rad`.
#[derive(Debug, Clone, PartialEq)]
pub struct Located(Box<Details>);

/// The parts of a [`Located`].
#[derive(Debug, Clone, PartialEq)]
pub struct Details {
    /// File as the user named it.
    pub file: String,
    /// Line, from 1; row of a workbook.
    pub line: Option<u64>,
    /// Key or column.
    pub place: Place,
    /// Value found, as written.
    pub value: Option<String>,
    /// Its unit.
    pub unit: Option<&'static str>,
    /// What kind of fault it is.
    pub fault: Fault,
    /// What is wrong, or what it must be.
    pub problem: String,
    /// What to do.
    pub cure: Option<String>,
}

/// Where in a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Place {
    /// Nowhere in particular.
    #[default]
    Whole,
    /// Section and key: `joints.elbow.tendon.length_mm`.
    Key(String),
    /// Column of a table by its header.
    Column(String),
    /// Element of an XML file: `joint 'elbow'`.
    Element(String),
}

/// Kinds of fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// The system can't read the file.
    Unreadable,
    /// More bytes or entries than such a file has.
    TooLarge,
    /// No text, or not in the file's language.
    Syntax,
    /// A key or column that means nothing here.
    UnknownKey,
    /// A key or column that is needed.
    MissingKey,
    /// Of another type than needed: text for a number.
    WrongType,
    /// Outside what the quantity allows, or none of the words there are.
    NotAllowed,
    /// A name of something that isn't there: joint, link, source.
    UnknownName,
    /// Two values that exclude each other.
    Contradiction,
}

impl Located {
    /// A fault of a file as a whole; the other methods add to it.
    pub fn new(file: &str, fault: Fault, problem: impl Into<String>) -> Self {
        Self(Box::new(Details {
            file: file.to_owned(),
            line: None,
            place: Place::Whole,
            value: None,
            unit: None,
            fault,
            problem: problem.into(),
            cure: None,
        }))
    }

    /// On a line, from 1; 0: unknown.
    #[must_use]
    pub fn line(mut self, line: u64) -> Self {
        self.0.line = Some(line).filter(|line| *line > 0);
        self
    }

    /// At a key.
    #[must_use]
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.0.place = Place::Key(key.into());
        self
    }

    /// In a column.
    #[must_use]
    pub fn column(mut self, column: impl Into<String>) -> Self {
        self.0.place = Place::Column(column.into());
        self
    }

    /// At an XML element: `joint 'elbow'`.
    #[must_use]
    pub fn element(mut self, element: impl Into<String>) -> Self {
        self.0.place = Place::Element(element.into());
        self
    }

    /// With the value found.
    #[must_use]
    pub fn value(mut self, value: impl fmt::Display) -> Self {
        self.0.value = Some(value.to_string());
        self
    }

    /// With the unit of the value, where it has one.
    #[must_use]
    pub fn unit(mut self, unit: &'static str) -> Self {
        self.0.unit = Some(unit).filter(|unit| !unit.is_empty());
        self
    }

    /// With what to do.
    #[must_use]
    pub fn cure(mut self, cure: impl Into<String>) -> Self {
        self.0.cure = Some(cure.into());
        self
    }
}

impl Deref for Located {
    type Target = Details;

    fn deref(&self) -> &Details {
        &self.0
    }
}

impl std::error::Error for Located {}

impl fmt::Display for Located {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        match &self.place {
            Place::Whole => {}
            Place::Key(at) | Place::Element(at) => write!(f, ": {at}")?,
            Place::Column(column) => write!(f, ", column '{column}'")?,
        }
        if let Some(value) = &self.value {
            write!(f, " = {value}")?;
            if let Some(unit) = self.unit {
                write!(f, " ({unit})")?;
            }
        }
        write!(f, ": {}", self.problem)?;
        match &self.cure {
            Some(cure) => write!(f, "; {cure}"),
            None => Ok(()),
        }
    }
}

/// A place with named values: a section of a TOML file, a row of a table.
pub trait Fields {
    /// A number, if there is one of that name.
    ///
    /// # Errors
    /// What stands there is no number, or not within the bound.
    fn number(&self, key: &'static str, bound: Bound) -> Result<Option<f64>, Located>;

    /// Refuses what stands at `key`, with what it must be; as missing where nothing does.
    fn refuse(&self, key: &'static str, must: &str) -> Located;

    /// Refuses the place for lack of `key`, with what it is for.
    fn missing(&self, key: &'static str, why: &str) -> Located;

    /// A number that has to be there.
    ///
    /// # Errors
    /// As [`Fields::number`], and [`Fields::missing`] with `why`.
    fn need(&self, key: &'static str, bound: Bound, why: &str) -> Result<f64, Located> {
        self.number(key, bound)?
            .ok_or_else(|| self.missing(key, why))
    }

    /// A number, or `plain` where there is none.
    ///
    /// # Errors
    /// As [`Fields::number`].
    fn number_or(&self, key: &'static str, bound: Bound, plain: f64) -> Result<f64, Located> {
        Ok(self.number(key, bound)?.unwrap_or(plain))
    }
}
