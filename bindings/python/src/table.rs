//! Tables as an Arrow C stream, without a copy of the columns.

use crate::failure::Failure;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator,
    StringArray,
};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use numpy::PyArray1;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyList};
use sinew_log::{Cell, CellKind, Table as Rows};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Reconstruction of an object by `pickle`: the function that restores it, and its arguments.
pub(crate) type Reduced<'py, T> = (Bound<'py, PyAny>, T);

/// A table of named columns.
#[pyclass(frozen, from_py_object, module = "pysinew._core")]
#[derive(Clone)]
pub(crate) struct Table(RecordBatch);

/// A column as pickle keeps it: its name, and its values in the place of its type.
type KeptColumn = (
    String,
    Option<Vec<Option<f64>>>,
    Option<Vec<Option<i64>>>,
    Option<Vec<Option<String>>>,
    Option<Vec<Option<bool>>>,
);

fn failure(error: ArrowError) -> Failure {
    Failure::new(error.to_string())
}

impl Table {
    /// Columns of one length; numbers that are NaN are null.
    pub(crate) fn new(columns: Vec<(String, ArrayRef)>) -> Result<Self, Failure> {
        let field = |(name, column): &(String, ArrayRef)| {
            let field = Field::new(name, column.data_type().clone(), true);
            match sinew_files::bound::unit_of(name) {
                "" => field,
                unit => field.with_metadata(HashMap::from([("unit".into(), unit.into())])),
            }
        };
        let schema = Schema::new(Vec::from_iter(columns.iter().map(field)));
        let columns = columns.into_iter().map(|(_, column)| column).collect();
        let batch = RecordBatch::try_new(Arc::new(schema), columns);
        batch.map(Self).map_err(failure)
    }

    /// A table of the library, column by column.
    pub(crate) fn of(rows: &Rows) -> Result<Self, Failure> {
        let columns = rows.columns.iter().enumerate();
        let columns = columns.map(|(i, (name, kind))| {
            let cells = rows.rows.iter().map(|row| row.get(i));
            (name.clone(), column(*kind, cells))
        });
        Self::new(columns.collect())
    }

    fn column(&self, name: &str) -> PyResult<&ArrayRef> {
        self.0.column_by_name(name).ok_or_else(|| {
            let names = self.column_names();
            let hint = sinew_files::names::hint(name, &names);
            let columns = sinew_files::names::list(&names);
            PyKeyError::new_err(format!("no column '{name}'{hint} columns are {columns}"))
        })
    }
}

fn column<'a>(kind: CellKind, cells: impl Iterator<Item = Option<&'a Cell>>) -> ArrayRef {
    match kind {
        CellKind::Number => Arc::new(Float64Array::from_iter(cells.map(|cell| match cell {
            Some(Cell::Number(value)) if value.is_finite() => Some(*value),
            _ => None,
        }))),
        CellKind::Integer => Arc::new(Int64Array::from_iter(cells.map(|cell| match cell {
            Some(Cell::Integer(value)) => Some(*value),
            _ => None,
        }))),
        CellKind::Text => Arc::new(StringArray::from_iter(cells.map(|cell| match cell {
            Some(Cell::Text(text)) => Some(text.as_str()),
            _ => None,
        }))),
        CellKind::Flag => Arc::new(BooleanArray::from_iter(cells.map(|cell| match cell {
            Some(Cell::Flag(flag)) => Some(*flag),
            _ => None,
        }))),
    }
}

#[pymethods]
impl Table {
    /// Arrow C stream interface. The stream refers to the memory of this table; a requested schema is ignored.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A producer may answer with its own types.
        drop(requested_schema);
        let schema = self.0.schema();
        let batches = RecordBatchIterator::new([Ok(self.0.clone())], schema);
        let stream = FFI_ArrowArrayStream::new(Box::new(batches));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    /// The Arrow C schema interface.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(&*self.0.schema()).map_err(failure)?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    /// Unit of every column that has one, by name; the `unit` of its field in Arrow.
    #[getter]
    fn units(&self) -> HashMap<String, String> {
        let schema = self.0.schema();
        let unit = |field: &Arc<Field>| {
            let unit = field.metadata().get("unit")?;
            Some((field.name().clone(), unit.clone()))
        };
        schema.fields().iter().filter_map(unit).collect()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.0 == other.0
    }

    #[staticmethod]
    #[pyo3(name = "_restore")]
    fn restore(columns: Vec<KeptColumn>) -> PyResult<Self> {
        let column = |(name, numbers, integers, texts, flags): KeptColumn| {
            let column: ArrayRef = match (numbers, integers, texts, flags) {
                (Some(numbers), ..) => Arc::new(Float64Array::from_iter(numbers)),
                (_, Some(integers), ..) => Arc::new(Int64Array::from_iter(integers)),
                (_, _, Some(texts), _) => Arc::new(StringArray::from_iter(texts)),
                (_, _, _, flags) => Arc::new(BooleanArray::from(flags.unwrap_or_default())),
            };
            (name, column)
        };
        Ok(Self::new(columns.into_iter().map(column).collect())?)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, (Vec<KeptColumn>,)>> {
        let columns = self.column_names().into_iter().zip(self.0.columns());
        let kept = columns.map(|(name, column)| {
            let any = column.as_any();
            let numbers = any.downcast_ref::<Float64Array>();
            let integers = any.downcast_ref::<Int64Array>();
            let texts = any.downcast_ref::<StringArray>();
            let flags = any.downcast_ref::<BooleanArray>();
            (
                name,
                numbers.map(|column| column.iter().collect()),
                integers.map(|column| column.iter().collect()),
                texts.map(|column| column.iter().map(|text| text.map(str::to_owned)).collect()),
                flags.map(|column| column.iter().collect()),
            )
        });
        let restore = py.get_type::<Self>().getattr("_restore")?;
        Ok((restore, (kept.collect(),)))
    }

    /// Names of the columns, in order.
    #[getter]
    fn column_names(&self) -> Vec<String> {
        let schema = self.0.schema();
        schema.fields().iter().map(|f| f.name().clone()).collect()
    }

    fn __len__(&self) -> usize {
        self.0.num_rows()
    }

    /// A column: a NumPy array of numbers or flags (null: NaN), a list of texts (null: `None`).
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let column = self.column(name)?;
        let any = column.as_any();
        let valid = |i: usize| column.is_valid(i);
        if let Some(numbers) = any.downcast_ref::<Float64Array>() {
            let all = (0..numbers.len()).map(|i| match valid(i) {
                true => numbers.value(i),
                false => f64::NAN,
            });
            return Ok(PyArray1::from_iter(py, all).into_any());
        }
        if let Some(numbers) = any.downcast_ref::<Int64Array>() {
            if numbers.null_count() == 0 {
                return Ok(PyArray1::from_slice(py, numbers.values()).into_any());
            }
            let all = (0..numbers.len()).map(|i| match valid(i) {
                true => numbers.value(i) as f64,
                false => f64::NAN,
            });
            return Ok(PyArray1::from_iter(py, all).into_any());
        }
        if let Some(flags) = any.downcast_ref::<BooleanArray>() {
            if flags.null_count() == 0 {
                let all = (0..flags.len()).map(|i| flags.value(i));
                return Ok(PyArray1::from_iter(py, all).into_any());
            }
            let all = flags.iter().collect::<Vec<_>>();
            return Ok(PyList::new(py, all)?.into_any());
        }
        match any.downcast_ref::<StringArray>() {
            Some(texts) => Ok(PyList::new(py, texts.iter())?.into_any()),
            None => Err(PyKeyError::new_err(format!(
                "column '{name}' has an unsupported type"
            ))),
        }
    }

    /// Writes a file: Parquet if the name ends in ``.parquet``, otherwise CSV; it is complete or absent.
    ///
    /// Parameters
    /// ----------
    /// path
    ///     File to write.
    ///
    /// Raises
    /// ------
    /// SinewError
    ///     If it cannot be written.
    fn write(&self, path: PathBuf) -> PyResult<()> {
        Ok(rows_of(&self.0).write(&path).map_err(Failure::from)?)
    }

    fn __repr__(&self) -> String {
        let (rows, columns) = (self.0.num_rows(), self.0.num_columns());
        format!("<pysinew.Table: {rows} rows, {columns} columns>")
    }

    /// The first rows as HTML.
    fn _repr_html_(&self) -> String {
        const MAX_SHOWN_ROWS: usize = 12;
        let rows = rows_of(&self.0.slice(0, self.0.num_rows().min(MAX_SHOWN_ROWS)));
        let text = |cell: &Cell| match cell {
            Cell::Empty => "–".to_owned(),
            Cell::Number(value) => sinew_figure::rounded(*value, 6),
            Cell::Integer(value) => value.to_string(),
            Cell::Text(text) => text.clone(),
            Cell::Flag(flag) => flag.to_string(),
        };
        let body = rows.rows.iter().map(|row| row.iter().map(text).collect());
        let head: Vec<&str> = rows.columns.iter().map(|(n, _)| n.as_str()).collect();
        let more = self.0.num_rows().saturating_sub(MAX_SHOWN_ROWS);
        let caption = match more {
            0 => String::new(),
            more => format!(
                "the first {MAX_SHOWN_ROWS} of {} rows",
                MAX_SHOWN_ROWS + more
            ),
        };
        sinew_figure::Table::new(&head, body)
            .captioned(caption)
            .html()
    }
}

/// Converts a batch to rows for writing and printing.
fn rows_of(batch: &RecordBatch) -> Rows {
    let schema = batch.schema();
    let columns = schema.fields().iter().map(|field| {
        let kind = match field.data_type() {
            DataType::Int64 => CellKind::Integer,
            DataType::Utf8 => CellKind::Text,
            DataType::Boolean => CellKind::Flag,
            _ => CellKind::Number,
        };
        (field.name().clone(), kind)
    });
    let mut rows = Rows {
        columns: columns.collect(),
        rows: Vec::new(),
    };
    for row in 0..batch.num_rows() {
        let cell = |column: &ArrayRef| {
            let any = column.as_any();
            if column.is_null(row) {
                return Cell::Empty;
            }
            if let Some(numbers) = any.downcast_ref::<Float64Array>() {
                return Cell::Number(numbers.value(row));
            }
            if let Some(numbers) = any.downcast_ref::<Int64Array>() {
                return Cell::Integer(numbers.value(row));
            }
            if let Some(texts) = any.downcast_ref::<StringArray>() {
                return Cell::Text(texts.value(row).to_owned());
            }
            let flags = any.downcast_ref::<BooleanArray>();
            flags.map_or(Cell::Empty, |flags| Cell::Flag(flags.value(row)))
        };
        rows.push(batch.columns().iter().map(cell).collect());
    }
    rows
}
