//! Unpacks one chunk, with every length checked before memory is taken.

use std::io::Read;

use mcap::records::ChunkHeader;

/// Most a zstd or lz4 stream can expand: a run-length block of 4 bytes gives
/// 128 KiB (zstd, RFC 8878), a length byte gives 255 bytes (lz4).
const ZSTD_EXPANSION: u64 = 32 << 10;
const LZ4_EXPANSION: u64 = 255;
/// Headers and the first block are not covered by the ratio.
const EXPANSION_SLACK: u64 = 128 << 10;

/// Keeps the decompression contexts between chunks.
pub(super) struct Unpacker {
    zstd: Option<zstd::bulk::Decompressor<'static>>,
    limit: usize,
}

impl Unpacker {
    pub(super) fn new(limit: usize) -> Self {
        Unpacker { zstd: None, limit }
    }

    /// Unpacks a whole chunk into `out` and checks its checksum.
    pub(super) fn unpack(
        &mut self,
        header: &ChunkHeader,
        packed: &[u8],
        out: &mut Vec<u8>,
    ) -> Result<(), String> {
        let size = self.check_size(header, packed.len() as u64)?;
        match header.compression.as_str() {
            "zstd" => {
                out.clear();
                out.reserve_exact(size);
                let context = match &mut self.zstd {
                    Some(context) => context,
                    none => none.insert(
                        zstd::bulk::Decompressor::new().map_err(|error| error.to_string())?,
                    ),
                };
                context
                    .decompress_to_buffer(packed, out)
                    .map_err(|error| format!("zstd: {error}"))?;
            }
            "lz4" => {
                let mut decoder =
                    lz4::Decoder::new(packed).map_err(|error| format!("lz4: {error}"))?;
                // Chunks are of about one size: growing zeroes once, not per chunk.
                out.resize(size, 0);
                let mut filled = 0;
                while filled < size {
                    match decoder.read(&mut out[filled..]) {
                        Ok(0) => break,
                        Ok(read) => filled += read,
                        Err(error) => return Err(format!("lz4: {error}")),
                    }
                }
                out.truncate(filled);
            }
            other => {
                return Err(format!(
                    "unsupported compression '{}': zstd, lz4 and none are supported",
                    sinew_files::names::shorten(other, 40)
                ));
            }
        }
        check_records(header, out)
    }

    /// Checks an uncompressed chunk, which is used in place.
    pub(super) fn check_plain(&self, header: &ChunkHeader, records: &[u8]) -> Result<(), String> {
        self.check_size(header, records.len() as u64)?;
        check_records(header, records)
    }

    /// Decompresses the complete blocks of a truncated chunk; its checksum cannot be verified.
    pub(super) fn salvage(&mut self, header: &ChunkHeader, packed: &[u8], out: &mut Vec<u8>) {
        out.clear();
        // The header's sizes belong to the whole chunk, so only the limit is checked.
        let limit = (self.limit as u64).min(header.uncompressed_size);
        // Each reader returns an error at the cut; what came before it is in `out`.
        let _cut = match header.compression.as_str() {
            "" => {
                out.extend_from_slice(&packed[..packed.len().min(limit as usize)]);
                Ok(0)
            }
            "zstd" => zstd::stream::read::Decoder::new(packed)
                .and_then(|decoder| decoder.take(limit).read_to_end(out)),
            "lz4" => {
                lz4::Decoder::new(packed).and_then(|decoder| decoder.take(limit).read_to_end(out))
            }
            _ => Ok(0),
        };
    }

    fn check_size(&self, header: &ChunkHeader, packed: u64) -> Result<usize, String> {
        let size = header.uncompressed_size;
        let possible = match header.compression.as_str() {
            "zstd" => packed.saturating_mul(ZSTD_EXPANSION) + EXPANSION_SLACK,
            "lz4" => packed.saturating_mul(LZ4_EXPANSION) + EXPANSION_SLACK,
            _ => packed,
        };
        if size > possible {
            return Err(format!(
                "chunk of {packed} packed bytes claims {size} bytes unpacked"
            ));
        }
        if size > self.limit as u64 {
            return Err(format!(
                "chunk of {size} bytes is over the limit of {} bytes",
                self.limit
            ));
        }
        Ok(size as usize)
    }
}

/// Compares length and checksum of the unpacked records with the header's.
fn check_records(header: &ChunkHeader, records: &[u8]) -> Result<(), String> {
    let (held, size) = (records.len(), header.uncompressed_size);
    if held as u64 != size {
        return Err(format!(
            "chunk has {held} bytes, expected {size} by its header"
        ));
    }
    let saved = header.uncompressed_crc;
    // Zero means "not calculated" in the format.
    if saved != 0 {
        let calculated = crc32fast::hash(records);
        if calculated != saved {
            return Err(format!(
                "chunk checksum is {calculated:08x}, expected {saved:08x} by its header"
            ));
        }
    }
    Ok(())
}
