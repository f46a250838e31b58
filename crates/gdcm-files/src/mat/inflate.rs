//! Packed arrays.
//!
//! Source: "MAT-File Format", The MathWorks, "Data Compression"; RFC 1950.

use std::io::{ErrorKind, Read};

use flate2::read::ZlibDecoder;

use super::cursor::Cursor;
use crate::variables::{MemoryBudget, VariableFault};

/// How many bytes one packed byte can become at most, rounded up (RFC 1951: 258 bytes from two bits).
const MOST_EXPANSION: u64 = 1040;
/// How many bytes are unpacked before the meter is asked again.
const CHUNK: u64 = 1 << 20;

/// The bytes of a packed element: its tag, which says how many follow, and those.
pub(super) fn unpacked(packed: Cursor<'_>, meter: &MemoryBudget<'_>) -> Result<Vec<u8>, VariableFault> {
    let mut decoder = ZlibDecoder::new(packed.rest());
    let mut bytes = Vec::new();
    read(&mut decoder, 8, &mut bytes, packed, meter)?;
    let mut tag = Cursor::unpacked(&bytes, packed.order, packed.offset);
    tag.pass(4)?;
    let length = u64::from(tag.u32()?);
    if length > (packed.len() as u64).saturating_mul(MOST_EXPANSION) {
        return Err(packed.damaged(format!("{} packed bytes that claim to hold {length}", packed.len())));
    }
    read(&mut decoder, length, &mut bytes, packed, meter)?;
    // At the end lies a checksum, which is compared when the end is looked for.
    let more = decoder.read(&mut [0]).map_err(|_| packed.damaged("the packed bytes were changed"))?;
    if more != 0 {
        return Err(packed.damaged("more packed bytes than they say themselves"));
    }
    Ok(bytes)
}

fn read(
    decoder: &mut impl Read,
    length: u64,
    bytes: &mut Vec<u8>,
    packed: Cursor<'_>,
    meter: &MemoryBudget<'_>,
) -> Result<(), VariableFault> {
    let mut left = length;
    while left > 0 {
        let chunk = left.min(CHUNK);
        // Vectors grow by doubling.
        meter.take(2 * chunk, 1, "")?;
        let found = decoder.by_ref().take(chunk).read_to_end(bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => packed.damaged("the packed bytes end too early"),
            _ => packed.damaged("the packed bytes were changed"),
        })?;
        if (found as u64) < chunk {
            // GNU Octave counts too many bytes; whether too few are left is found out when they are read.
            return Ok(());
        }
        left -= chunk;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::super::cursor::ByteOrder;
    use super::*;

    fn packed(length: u32, data: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(&14_u32.to_le_bytes()).unwrap();
        encoder.write_all(&length.to_le_bytes()).unwrap();
        encoder.write_all(data).unwrap();
        encoder.finish().unwrap()
    }

    fn read(bytes: &[u8], most: u64) -> Result<Vec<u8>, VariableFault> {
        unpacked(Cursor::file(bytes, ByteOrder::Little), &MemoryBudget::new(most, &|_| false))
    }

    #[test]
    fn as_much_is_unpacked_as_the_tag_says() {
        for length in [3, 4] {
            assert_eq!(read(&packed(length, &[1, 2, 3]), 100).unwrap()[8..], [1, 2, 3]);
        }
        assert!(matches!(read(&packed(2, &[1, 2, 3]), 100), Err(VariableFault::Damaged { .. })));
    }

    #[test]
    fn what_unpacks_to_too_much_is_refused_before_it_is_unpacked() {
        let bomb = packed(1 << 22, &vec![0; 1 << 22]);
        assert!(bomb.len() < 1 << 13);
        assert!(matches!(read(&bomb, 1 << 20), Err(VariableFault::TooLarge { .. })));
        assert!(matches!(read(&packed(u32::MAX, &[0; 99]), u64::MAX), Err(VariableFault::Damaged { .. })));
    }

    #[test]
    fn changed_bytes_are_found_by_their_checksum() {
        let mut bytes = packed(3, &[1, 2, 3]);
        *bytes.last_mut().unwrap() ^= 1;
        assert!(matches!(read(&bytes, 100), Err(VariableFault::Damaged { .. })));
    }
}
