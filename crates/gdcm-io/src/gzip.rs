//! Decompresses gzip files (RFC 1952) within limits on length and memory.

use std::io::{ErrorKind, Read};
use std::path::Path;

use flate2::bufread::GzDecoder;

use gdcm_model::dataset::limits::LARGEST_TEXT;

use crate::file_error::FileError;
use crate::reading_budget::{NO_VARIABLE, ReadingBudget};

/// First two bytes in every gzip file (RFC 1952, section 2.3.1).
pub(super) const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
/// Number of bytes decompressed between two budget queries.
const CHUNK: usize = 1 << 16;

/// Decompresses incrementally, and no further than the limit: a few kilobytes can expand to
/// gigabytes.
///
/// A file may have several members (RFC 1952), and trailing zeros, with which tape drives and copy
/// programs fill their blocks.
pub(super) fn unpack(
    bytes: &[u8],
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<u8>, FileError> {
    let mut text = Vec::new();
    let mut rest = bytes;
    // Until only the zeros of the padding remain.
    while rest.iter().any(|&byte| byte != 0) {
        let mut member = GzDecoder::new(rest);
        while unpack_chunk(&mut member, &mut text, path, budget)? > 0 {}
        rest = member.into_inner();
    }
    Ok(text)
}

/// Appends the next decompressed bytes to `text` and returns their number, which is 0 at the end of
/// a member.
fn unpack_chunk(
    member: &mut GzDecoder<&[u8]>,
    text: &mut Vec<u8>,
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<usize, FileError> {
    // Two bytes for each: a vector that grows may have up to twice the necessary capacity.
    budget
        .take(CHUNK as u64, 2, NO_VARIABLE)
        .map_err(|fault| FileError::variables(path, fault))?;
    let unpacked = member.take(CHUNK as u64).read_to_end(text);
    check_length(text.len() as u64, LARGEST_TEXT, path)?;
    unpacked.map_err(|error| {
        let path = path.to_owned();
        match error.kind() {
            ErrorKind::UnexpectedEof => FileError::GzipCutOff { path },
            _ => FileError::Gzip { path },
        }
    })
}

/// Rejects content with more than `most` bytes.
pub(super) fn check_length(length: u64, most: u64, path: &Path) -> Result<(), FileError> {
    if length > most {
        return Err(FileError::TooLarge {
            path: path.to_owned(),
            most_mib: most >> 20,
        });
    }
    Ok(())
}
