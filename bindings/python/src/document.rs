//! Result of Sinew: JSON, text, page, tables.

use crate::failure::Failure;
use crate::table::Table;
use crate::work::work;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use sinew_figure::{Page, glance};
use sinew_files::JsonDocument;
use sinew_log::Table as Rows;
use sinew_report::Message;
use std::path::PathBuf;
use std::sync::Arc;

type Of<D, T> = Box<dyn Fn(&D) -> T + Send + Sync>;

/// Subject of a warning; each has its own category in Python.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Concern {
    /// The robot's description.
    Robot,
    /// The recording or the records of an analysis.
    Recording,
    /// The result: what could not be separated, and what was assumed.
    Result,
}

impl Concern {
    /// Category of the package.
    fn category(self) -> &'static str {
        match self {
            Self::Robot => "RobotWarning",
            Self::Recording => "RecordingWarning",
            Self::Result => "ResultWarning",
        }
    }

    /// Warnings with this concern, from texts without a code.
    pub(crate) fn texts(self, texts: impl IntoIterator<Item = String>) -> Vec<Notice> {
        let message = |text| Message {
            code: String::new(),
            text,
        };
        texts.into_iter().map(|t| (self, message(t))).collect()
    }
}

/// Warning that the command prints on stderr.
pub(crate) type Notice = (Concern, Message);

/// Category, code and text of a warning.
type NoticeParts = (String, String, String);

/// Document with its text, page and tables.
pub(crate) struct Shown<D> {
    document: D,
    words: Of<D, String>,
    page: Option<Of<D, Page>>,
    tables: Vec<(&'static str, Of<D, Rows>)>,
    warnings: Vec<Notice>,
    is_lossy: bool,
}

impl<D> Shown<D> {
    /// Wraps a result with its text form.
    pub(crate) fn new(document: D, words: impl Fn(&D) -> String + Send + Sync + 'static) -> Self {
        Self {
            document,
            words: Box::new(words),
            page: None,
            tables: Vec::new(),
            warnings: Vec::new(),
            is_lossy: false,
        }
    }

    /// Adds the HTML page.
    pub(crate) fn page(mut self, page: impl Fn(&D) -> Page + Send + Sync + 'static) -> Self {
        self.page = Some(Box::new(page));
        self
    }

    /// Adds a table; the first table is the default.
    pub(crate) fn table(
        mut self,
        name: &'static str,
        table: impl Fn(&D) -> Rows + Send + Sync + 'static,
    ) -> Self {
        self.tables.push((name, Box::new(table)));
        self
    }

    /// Adds the warnings that the command prints on stderr.
    pub(crate) fn warnings(mut self, warnings: Vec<Notice>) -> Self {
        self.warnings = warnings;
        self
    }

    /// Whether the command would end with exit code 3.
    pub(crate) fn lossy(mut self, is_lossy: bool) -> Self {
        self.is_lossy = is_lossy;
        self
    }
}

/// Operations of every result.
trait Answer: Send + Sync {
    fn json(&self) -> Result<String, Failure>;
    fn words(&self) -> String;
    fn html(&self) -> Option<String>;
    fn glance(&self) -> Option<String>;
    fn table_names(&self) -> Vec<String>;
    fn table(&self, name: &str) -> Option<Result<Table, Failure>>;
    fn warnings(&self) -> Vec<NoticeParts>;
    fn is_lossy(&self) -> bool;
}

impl<D: JsonDocument + Send + Sync> Answer for Shown<D> {
    fn json(&self) -> Result<String, Failure> {
        Ok(self.document.to_json()?)
    }

    fn words(&self) -> String {
        (self.words)(&self.document)
    }

    fn html(&self) -> Option<String> {
        self.page.as_ref().map(|page| page(&self.document).html())
    }

    fn glance(&self) -> Option<String> {
        self.page.as_ref().map(|page| glance(&page(&self.document)))
    }

    fn table_names(&self) -> Vec<String> {
        self.tables.iter().map(|(name, _)| (*name).into()).collect()
    }

    fn table(&self, name: &str) -> Option<Result<Table, Failure>> {
        let found = self.tables.iter().find(|(known, _)| *known == name);
        found.map(|(_, table)| Table::of(&table(&self.document)))
    }

    fn warnings(&self) -> Vec<NoticeParts> {
        let parts = |(concern, message): &Notice| {
            let category = concern.category().to_owned();
            (category, message.code.clone(), message.text.clone())
        };
        self.warnings.iter().map(parts).collect()
    }

    fn is_lossy(&self) -> bool {
        self.is_lossy
    }
}

/// A result as pickle keeps it: everything that is shown, already made.
struct Kept {
    json: String,
    words: String,
    html: Option<String>,
    glance: Option<String>,
    tables: Vec<(String, Table)>,
    warnings: Vec<NoticeParts>,
    is_lossy: bool,
}

impl Answer for Kept {
    fn json(&self) -> Result<String, Failure> {
        Ok(self.json.clone())
    }

    fn words(&self) -> String {
        self.words.clone()
    }

    fn html(&self) -> Option<String> {
        self.html.clone()
    }

    fn glance(&self) -> Option<String> {
        self.glance.clone()
    }

    fn table_names(&self) -> Vec<String> {
        self.tables.iter().map(|(name, _)| name.clone()).collect()
    }

    fn table(&self, name: &str) -> Option<Result<Table, Failure>> {
        let found = self.tables.iter().find(|(known, _)| known == name);
        found.map(|(_, table)| Ok(table.clone()))
    }

    fn warnings(&self) -> Vec<NoticeParts> {
        self.warnings.clone()
    }

    fn is_lossy(&self) -> bool {
        self.is_lossy
    }
}

/// Everything that a result shows, in the order of `Kept`.
type State = (
    String,
    String,
    Option<String>,
    Option<String>,
    Vec<(String, Table)>,
    Vec<NoticeParts>,
    bool,
);

/// Result of Sinew, as seen by Python.
#[pyclass(frozen, module = "pysinew._core")]
pub(crate) struct Document(Arc<dyn Answer>);

impl<D: JsonDocument + Send + Sync + 'static> From<Shown<D>> for Document {
    fn from(shown: Shown<D>) -> Self {
        Self(Arc::new(shown))
    }
}

impl Document {
    /// Computes a form of the result; some forms are computed on first use, on all processors.
    fn form<T: Send + 'static>(
        &self,
        py: Python<'_>,
        form: impl FnOnce(&dyn Answer) -> Result<T, Failure> + Send + 'static,
    ) -> PyResult<T> {
        let answer = self.0.clone();
        work(py, "formatting", None, move |_| form(&*answer))
    }
}

#[pymethods]
impl Document {
    /// JSON document that the command prints.
    fn json(&self) -> PyResult<String> {
        Ok(self.0.json()?)
    }

    /// Text that the command prints.
    fn words(&self) -> String {
        self.0.words()
    }

    /// Page as one HTML file; `None` if the result has no page.
    fn html(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.form(py, |answer| Ok(answer.html()))
    }

    /// Short form of the page, for notebooks.
    fn glance(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.form(py, |answer| Ok(answer.glance()))
    }

    /// Writes the page; false if the result has none.
    fn write_html(&self, py: Python<'_>, path: PathBuf) -> PyResult<bool> {
        let Some(html) = self.html(py)? else {
            return Ok(false);
        };
        sinew_files::write_file(&path, html.as_bytes()).map_err(Failure::from)?;
        Ok(true)
    }

    /// Names of the tables.
    fn table_names(&self) -> Vec<String> {
        self.0.table_names()
    }

    /// Table of a name; without a name the first table.
    #[pyo3(signature = (name=None))]
    fn table(&self, py: Python<'_>, name: Option<&str>) -> PyResult<Table> {
        let names = self.0.table_names();
        let first = names.first().map(String::as_str);
        let wanted = name.or(first).unwrap_or_default().to_owned();
        if !names.contains(&wanted) {
            return Err(PyKeyError::new_err(match names.is_empty() {
                true => "this result has no table".to_owned(),
                false => format!("no table '{wanted}'; available: {}", names.join(", ")),
            }));
        }
        self.form(py, move |answer| {
            let none = || Err(Failure::new("this result has no table"));
            answer.table(&wanted).unwrap_or_else(none)
        })
    }

    /// Category, code and text of the warnings that the command prints on stderr.
    fn warnings(&self) -> Vec<NoticeParts> {
        self.0.warnings()
    }

    /// Whether the command would end with exit code 3.
    fn is_lossy(&self) -> bool {
        self.0.is_lossy()
    }

    /// A result from what `__reduce__` keeps.
    #[staticmethod]
    #[pyo3(name = "_restore")]
    fn restore(state: State) -> Self {
        let (json, words, html, glance, tables, warnings, is_lossy) = state;
        Self(Arc::new(Kept {
            json,
            words,
            html,
            glance,
            tables,
            warnings,
            is_lossy,
        }))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (State,))> {
        let state = self.form(py, |answer| {
            let table = |name: String| {
                let none = || Err(Failure::new("this result has no table"));
                let table = answer.table(&name).unwrap_or_else(none)?;
                Ok::<_, Failure>((name, table))
            };
            let tables = answer.table_names().into_iter().map(table);
            Ok((
                answer.json()?,
                answer.words(),
                answer.html(),
                answer.glance(),
                tables.collect::<Result<Vec<_>, _>>()?,
                answer.warnings(),
                answer.is_lossy(),
            ))
        })?;
        let class: Bound<'py, PyType> = py.get_type::<Self>();
        Ok((class.getattr("_restore")?, (state,)))
    }
}
