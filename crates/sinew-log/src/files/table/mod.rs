//! Tables: one row is one instant, columns are named signals.

mod columns;
mod csv_read;
mod decimal;
#[cfg(feature = "parquet")]
mod parquet_read;

pub(crate) use csv_read::CsvReader;
#[cfg(feature = "parquet")]
pub(crate) use parquet_read::ParquetReader;
