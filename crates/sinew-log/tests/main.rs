//! All tests of the reader in one binary.

mod ahead;
mod arrays;
mod axes;
mod damage;
#[cfg(feature = "db3")]
mod db3;
mod encode;
mod given;
mod independent;
mod joining;
mod lerobot;
mod live;
mod mapping;
mod messages;
#[cfg(feature = "numpy")]
mod numpy;
mod parquet;
mod parts;
mod roundtrip;
mod shared;
#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
mod sources;
mod support;
mod table_write;
mod tables;
mod trust;
