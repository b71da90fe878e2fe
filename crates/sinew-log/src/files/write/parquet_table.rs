//! A table as Parquet.

use super::{Cell, CellKind, Column, SchemaColumn, TableSchema, write_error};
use crate::error::LogError;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;
use sinew_files::AtomicFile;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of rows per row group, which is kept in memory.
const GROUP_ROWS: usize = 1 << 16;

/// Values of a column, and the definition level of every row.
struct Buffer<T> {
    values: Vec<T>,
    levels: Vec<i16>,
}

impl<T> Buffer<T> {
    const EMPTY: Self = Self {
        values: Vec::new(),
        levels: Vec::new(),
    };

    fn push(&mut self, value: Option<T>) {
        self.levels.push(i16::from(value.is_some()));
        self.values.extend(value);
    }

    /// Writes it as the group's next column.
    fn write<D: DataType<T = T>>(
        &mut self,
        group: &mut SerializedRowGroupWriter<'_, AtomicFile>,
    ) -> Result<(), ParquetError> {
        if let Some(mut column) = group.next_column()? {
            let typed = column.typed::<D>();
            typed.write_batch(&self.values, Some(&self.levels), None)?;
            column.close()?;
        }
        self.values.clear();
        self.levels.clear();
        Ok(())
    }
}

/// A column not yet written.
enum Pending {
    Number(Buffer<f64>),
    Integer(Buffer<i64>),
    Text(Buffer<ByteArray>),
    Flag(Buffer<bool>),
}

impl Pending {
    fn new(kind: CellKind) -> Self {
        match kind {
            CellKind::Number => Self::Number(Buffer::EMPTY),
            CellKind::Integer => Self::Integer(Buffer::EMPTY),
            CellKind::Text => Self::Text(Buffer::EMPTY),
            CellKind::Flag => Self::Flag(Buffer::EMPTY),
        }
    }

    fn push(&mut self, cell: &Cell) {
        match (self, cell) {
            (Self::Number(b), Cell::Number(x)) => b.push(Some(*x).filter(|x| x.is_finite())),
            (Self::Integer(b), Cell::Integer(x)) => b.push(Some(*x)),
            (Self::Text(b), Cell::Text(x)) => b.push(Some(x.as_str().into())),
            (Self::Flag(b), Cell::Flag(x)) => b.push(Some(*x)),
            (Self::Number(b), _) => b.push(None),
            (Self::Integer(b), _) => b.push(None),
            (Self::Text(b), _) => b.push(None),
            (Self::Flag(b), _) => b.push(None),
        }
    }

    fn write(
        &mut self,
        group: &mut SerializedRowGroupWriter<'_, AtomicFile>,
    ) -> Result<(), ParquetError> {
        match self {
            Self::Number(b) => b.write::<DoubleType>(group),
            Self::Integer(b) => b.write::<Int64Type>(group),
            Self::Text(b) => b.write::<ByteArrayType>(group),
            Self::Flag(b) => b.write::<BoolType>(group),
        }
    }
}

/// A Parquet table being written, packed with zstd; every column may hold nulls.
pub(super) struct ParquetTable {
    writer: SerializedFileWriter<AtomicFile>,
    path: PathBuf,
    columns: Vec<Pending>,
    rows: usize,
}

impl ParquetTable {
    pub(super) fn create(
        path: &Path,
        columns: &[Column],
        about: Option<&TableSchema<'_>>,
    ) -> Result<Self, LogError> {
        let fail = |error: ParquetError| write_error(path, error.to_string());
        let fields = columns.iter().map(|(name, kind)| {
            let (physical, logical) = match kind {
                CellKind::Number => (Physical::DOUBLE, None),
                CellKind::Integer => (Physical::INT64, None),
                CellKind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
                CellKind::Flag => (Physical::BOOLEAN, None),
            };
            let field = Type::primitive_type_builder(name, physical)
                .with_repetition(Repetition::OPTIONAL)
                .with_logical_type(logical);
            field.build().map(Arc::new)
        });
        let fields = fields.collect::<Result<Vec<_>, _>>().map_err(fail)?;
        let schema = Type::group_type_builder("table").with_fields(fields);
        let schema = Arc::new(schema.build().map_err(fail)?);
        let properties = WriterProperties::builder()
            .set_created_by("sinew".into())
            .set_key_value_metadata(Some(metadata(about)))
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .build();
        let file = AtomicFile::create(path)?;
        let writer = SerializedFileWriter::new(file, schema, Arc::new(properties));
        Ok(Self {
            writer: writer.map_err(fail)?,
            path: path.to_path_buf(),
            columns: columns.iter().map(|(_, k)| Pending::new(*k)).collect(),
            rows: 0,
        })
    }

    pub(super) fn row(&mut self, cells: &[Cell]) -> Result<(), LogError> {
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            column.push(cell);
        }
        self.rows += 1;
        match self.rows == GROUP_ROWS {
            true => self.flush(),
            false => Ok(()),
        }
    }

    fn flush(&mut self) -> Result<(), LogError> {
        self.rows = 0;
        let group = self.writer.next_row_group();
        let written = group.and_then(|mut group| {
            for column in &mut self.columns {
                column.write(&mut group)?;
            }
            group.close().map(|_| ())
        });
        written.map_err(|error| write_error(&self.path, error.to_string()))
    }

    pub(super) fn finish(mut self) -> Result<(), LogError> {
        if self.rows > 0 {
            self.flush()?;
        }
        let file = self.writer.into_inner();
        let file = file.map_err(|error| write_error(&self.path, error.to_string()))?;
        Ok(file.finish()?)
    }
}

/// Metadata of a file: version of the program; name of the schema, and unit and meaning of its columns.
fn metadata(about: Option<&TableSchema<'_>>) -> Vec<KeyValue> {
    let of = |key: &str, value: String| KeyValue::new(key.to_owned(), value);
    let mut out = vec![of("sinew_version", env!("CARGO_PKG_VERSION").to_owned())];
    if let Some(schema) = about {
        let column = |c: &SchemaColumn| {
            let about = serde_json::json!({ "unit": c.unit, "meaning": c.meaning });
            (c.name.to_owned(), about)
        };
        let columns: serde_json::Map<_, _> = schema.columns.iter().map(column).collect();
        out.push(of("sinew_schema", schema.name.to_owned()));
        out.push(of(
            "sinew_columns",
            serde_json::Value::from(columns).to_string(),
        ));
    }
    out
}
