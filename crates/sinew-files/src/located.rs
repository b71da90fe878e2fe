//! The one error of a text file: TOML, CSV, URDF.

use crate::Bound;
use std::fmt;
use std::ops::Deref;

/// Problem at one location of a file, with its remedy.
///
/// Displayed as one line: `robot.toml, line 6: joints.elbow.stiffness_nm_per_rad = -4 (N·m/rad):
/// must be above 0 N·m/rad`.
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
    /// Unit of the value.
    pub unit: Option<&'static str>,
    /// Kind of the problem.
    pub fault: Fault,
    /// Description of the problem, or the requirement on the value.
    pub problem: String,
    /// Remedy, if there is one.
    pub cure: Option<String>,
}

/// Location in a file.
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
    /// The system cannot read the file.
    Unreadable,
    /// More bytes or entries than such a file has.
    TooLarge,
    /// No text, or not in the file's language.
    Syntax,
    /// Unknown key or column.
    UnknownKey,
    /// A key or column that is needed.
    MissingKey,
    /// Wrong type, such as a text instead of a number.
    WrongType,
    /// Value outside the permitted range, or not one of the permitted words.
    NotAllowed,
    /// Name of a missing joint, link or source.
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

    /// Adds the remedy.
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
    /// Returns the number at `key`, if there is one.
    ///
    /// # Errors
    /// Returns an error if the value is not a number or outside the bound.
    fn number(&self, key: &'static str, bound: Bound) -> Result<Option<f64>, Located>;

    /// Returns the error for the value at `key`, with the requirement; a missing-key error if there
    /// is no value.
    fn invalid(&self, key: &'static str, must: &str) -> Located;

    /// Returns the error for the missing key `key`, with its purpose.
    fn missing(&self, key: &'static str, reason: &str) -> Located;

    /// A number that has to be there.
    ///
    /// # Errors
    /// Returns the errors of [`Fields::number`], and [`Fields::missing`] with `why`.
    fn need(&self, key: &'static str, bound: Bound, reason: &str) -> Result<f64, Located> {
        self.number(key, bound)?
            .ok_or_else(|| self.missing(key, reason))
    }

    /// A number, or `plain` where there is none.
    ///
    /// # Errors
    /// Returns the errors of [`Fields::number`].
    fn number_or(&self, key: &'static str, bound: Bound, plain: f64) -> Result<f64, Located> {
        Ok(self.number(key, bound)?.unwrap_or(plain))
    }
}
