//! Decompresses elements (zlib). The decompressed bytes are again an element: its tag, which gives
//! the length, and its data.
//!
//! Source: "MAT-File Format", The MathWorks, "Data Compression"; RFC 1950.

use std::io::{ErrorKind, Read};

use flate2::read::ZlibDecoder;

use crate::formats::mat::cursor::Cursor;
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Maximum ratio of decompressed to compressed bytes, rounded up (RFC 1951: 258 bytes from two
/// bits).
const MOST_EXPANSION: u64 = 1040;
/// Number of bytes decompressed between two checks against the budget.
const CHUNK: u64 = 1 << 20;
/// Length of the tag with which the decompressed bytes begin \[bytes\].
const TAG_BYTES: u64 = 8;

/// Decompresses an element: its tag, and at most as many bytes as the tag announces.
pub(super) fn inflate(
    packed: Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<u8>, VariableFault> {
    let mut inflater = Inflater {
        decoder: ZlibDecoder::new(packed.rest()),
        bytes: Vec::new(),
        packed,
        budget,
    };
    inflater.read_up_to(TAG_BYTES)?;
    let length = inflater.announced_length()?;
    inflater.read_up_to(length)?;
    inflater.check_end()?;
    Ok(inflater.bytes)
}

/// A compressed element and the bytes decompressed so far.
struct Inflater<'b> {
    decoder: ZlibDecoder<&'b [u8]>,
    bytes: Vec<u8>,
    packed: Cursor<'b>,
    budget: &'b ReadingBudget<'b>,
}

impl Inflater<'_> {
    /// Decompresses the next `length` bytes, or fewer if the compressed data end earlier.
    fn read_up_to(&mut self, length: u64) -> Result<(), VariableFault> {
        let packed = self.packed;
        let mut left = length;
        while left > 0 {
            let chunk = left.min(CHUNK);
            // The factor 2: vectors grow by doubling.
            self.budget.take(2 * chunk, 1, "")?;
            let found = self
                .decoder
                .by_ref()
                .take(chunk)
                .read_to_end(&mut self.bytes)
                .map_err(|error| match error.kind() {
                    ErrorKind::UnexpectedEof => packed.damaged(Damage::CompressedDataEnd),
                    _ => packed.damaged(Damage::CompressedData),
                })?;
            if (found as u64) < chunk {
                // Accept fewer bytes, because GNU Octave announces too many; if bytes are really
                // missing, decoding the element fails.
                return Ok(());
            }
            left -= chunk;
        }
        Ok(())
    }

    /// Reads the length from the decompressed tag; rejects a length that the compressed data cannot
    /// reach.
    fn announced_length(&self) -> Result<u64, VariableFault> {
        let packed = self.packed;
        let mut tag = Cursor::unpacked(&self.bytes, packed.order, packed.offset);
        tag.pass(4)?;
        let length = u64::from(tag.read_u32()?);
        if length > (packed.len() as u64).saturating_mul(MOST_EXPANSION) {
            return Err(packed.damaged(Damage::Expansion {
                packed: packed.len(),
                length,
            }));
        }
        Ok(length)
    }

    /// Rejects compressed data that continue after the announced length, or whose checksum is
    /// wrong.
    fn check_end(&mut self) -> Result<(), VariableFault> {
        let packed = self.packed;
        let more = self
            .decoder
            .read(&mut [0])
            .map_err(|_| packed.damaged(Damage::CompressedData))?;
        if more != 0 {
            return Err(packed.damaged(Damage::CompressedDataLength));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;
    use crate::formats::mat::cursor::ByteOrder;

    fn packed(length: u32, data: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(&14_u32.to_le_bytes()).unwrap();
        encoder.write_all(&length.to_le_bytes()).unwrap();
        encoder.write_all(data).unwrap();
        encoder.finish().unwrap()
    }

    fn read(bytes: &[u8], most: u64) -> Result<Vec<u8>, VariableFault> {
        inflate(
            Cursor::file(bytes, ByteOrder::Little),
            &ReadingBudget::new(most),
        )
    }

    #[test]
    fn the_announced_bytes_are_unpacked() {
        for length in [3, 4] {
            assert_eq!(
                read(&packed(length, &[1, 2, 3]), 100).unwrap()[8..],
                [1, 2, 3]
            );
        }
        assert!(matches!(
            read(&packed(2, &[1, 2, 3]), 100),
            Err(VariableFault::Damaged { .. })
        ));
    }

    #[test]
    fn an_element_that_is_too_large_unpacked_is_refused_before_unpacking() {
        let bomb = packed(1 << 22, &vec![0; 1 << 22]);
        assert!(bomb.len() < 1 << 13);
        assert!(matches!(
            read(&bomb, 1 << 20),
            Err(VariableFault::TooLarge { .. })
        ));
        assert!(matches!(
            read(&packed(u32::MAX, &[0; 99]), u64::MAX),
            Err(VariableFault::Damaged { .. })
        ));
    }

    #[test]
    fn changed_bytes_are_found_by_their_checksum() {
        let mut bytes = packed(3, &[1, 2, 3]);
        *bytes.last_mut().unwrap() ^= 1;
        assert!(matches!(
            read(&bytes, 100),
            Err(VariableFault::Damaged { .. })
        ));
    }
}
