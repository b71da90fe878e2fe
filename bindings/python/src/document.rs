//! Result of Sinew: JSON, text, page, tables.

use crate::failure::Failure;
use crate::table::Table;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use sinew_figure::{Page, glance};
use sinew_files::JsonDocument;
use sinew_log::Table as Rows;
use std::path::PathBuf;
use std::sync::Arc;

type Of<D, T> = Box<dyn Fn(&D) -> T + Send + Sync>;

/// Document with its text, page and tables.
pub(crate) struct Shown<D> {
    document: D,
    words: Of<D, String>,
    page: Option<Of<D, Page>>,
    tables: Vec<(&'static str, Of<D, Rows>)>,
    warnings: Vec<String>,
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
    pub(crate) fn warnings(mut self, warnings: Vec<String>) -> Self {
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
    fn json(&self) -> Result<String, serde_json::Error>;
    fn words(&self) -> String;
    fn page(&self) -> Option<Page>;
    fn table_names(&self) -> Vec<&'static str>;
    fn table(&self, name: &str) -> Option<Rows>;
    fn warnings(&self) -> &[String];
    fn is_lossy(&self) -> bool;
}

impl<D: JsonDocument + Send + Sync> Answer for Shown<D> {
    fn json(&self) -> Result<String, serde_json::Error> {
        self.document.to_json()
    }

    fn words(&self) -> String {
        (self.words)(&self.document)
    }

    fn page(&self) -> Option<Page> {
        self.page.as_ref().map(|page| page(&self.document))
    }

    fn table_names(&self) -> Vec<&'static str> {
        self.tables.iter().map(|(name, _)| *name).collect()
    }

    fn table(&self, name: &str) -> Option<Rows> {
        let found = self.tables.iter().find(|(known, _)| *known == name);
        found.map(|(_, table)| table(&self.document))
    }

    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn is_lossy(&self) -> bool {
        self.is_lossy
    }
}

/// Result of Sinew, as seen by Python.
#[pyclass(frozen, module = "pysinew._core")]
pub(crate) struct Document(Arc<dyn Answer>);

impl<D: JsonDocument + Send + Sync + 'static> From<Shown<D>> for Document {
    fn from(shown: Shown<D>) -> Self {
        Self(Arc::new(shown))
    }
}

#[pymethods]
impl Document {
    /// JSON document that the command prints.
    fn json(&self) -> PyResult<String> {
        Ok(self.0.json().map_err(Failure::from)?)
    }

    /// Text that the command prints.
    fn words(&self) -> String {
        self.0.words()
    }

    /// Page as one HTML file; `None` if the result has no page.
    fn html(&self) -> Option<String> {
        self.0.page().map(|page| page.html())
    }

    /// Short form of the page, for notebooks.
    fn glance(&self) -> Option<String> {
        self.0.page().map(|page| glance(&page))
    }

    /// Writes the page; false if the result has none.
    fn write_html(&self, path: PathBuf) -> PyResult<bool> {
        let Some(page) = self.0.page() else {
            return Ok(false);
        };
        sinew_files::write_file(&path, page.html().as_bytes()).map_err(Failure::from)?;
        Ok(true)
    }

    /// Names of the tables.
    fn table_names(&self) -> Vec<&'static str> {
        self.0.table_names()
    }

    /// Table of a name; without a name the first table.
    #[pyo3(signature = (name=None))]
    fn table(&self, name: Option<&str>) -> PyResult<Table> {
        let names = self.0.table_names();
        let wanted = name.or(names.first().copied()).unwrap_or_default();
        let found = self.0.table(wanted);
        found
            .map(|rows| Table::of(&rows))
            .transpose()?
            .ok_or_else(|| {
                PyKeyError::new_err(match names.is_empty() {
                    true => "this result has no table".to_owned(),
                    false => format!("no table '{wanted}'; available: {}", names.join(", ")),
                })
            })
    }

    /// Warnings that the command prints on stderr.
    fn warnings(&self) -> Vec<String> {
        self.0.warnings().to_vec()
    }

    /// Whether the command would end with exit code 3.
    fn is_lossy(&self) -> bool {
        self.0.is_lossy()
    }
}
