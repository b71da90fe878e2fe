//! Tables: one row is one instant, columns are named signals.

mod columns;
mod csv_read;
mod decimal;
mod parquet_read;

pub(crate) use csv_read::CsvReader;
pub(crate) use decimal::parse_cell;
pub(crate) use parquet_read::ParquetReader;
