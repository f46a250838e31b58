//! Reads files within limits: their bytes, their decompressed text without a byte order mark, and
//! the SHA-256 of the bytes. A [`ReadingBudget`] limits memory and work, and can cancel the
//! reading.

use std::borrow::Cow;
use std::fs;
use std::fs::{File, FileType};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;
use sha2::{Digest, Sha256};

use gdcm_model::dataset::limits::LARGEST_TEXT;

use crate::file_error::FileError;
use crate::gzip::{GZIP_MAGIC, check_length, unpack};
use crate::reading_budget::ReadingBudget;

/// UTF-8 byte order mark, which some editors put before a text.
const BYTE_ORDER_MARK: [u8; 3] = [0xef, 0xbb, 0xbf];

/// Number of bytes read or hashed between two checks for cancellation.
const CHUNK: usize = 1 << 16;

/// A file's text and the hash of its bytes.
#[derive(Debug)]
pub(super) struct Source<'b> {
    /// SHA-256 of the stored bytes, in lower-case hexadecimal.
    pub(super) sha256: String,
    text: Cow<'b, [u8]>,
}

impl Source<'static> {
    /// Reads a file within a budget, decompressing it if necessary.
    pub(super) fn read(path: &Path, budget: &ReadingBudget<'_>) -> Result<Self, FileError> {
        let bytes = read_bytes(path, LARGEST_TEXT, budget)?;
        let sha256 = sha256(&bytes, path, budget)?;
        let unpacked = match text_of(&bytes, path, budget)? {
            Cow::Owned(unpacked) => Some(unpacked),
            Cow::Borrowed(_) => None,
        };
        Ok(Source {
            sha256,
            text: Cow::Owned(unpacked.unwrap_or(bytes)),
        })
    }
}

impl<'b> Source<'b> {
    /// Creates a source from bytes in memory; errors name it by `path`.
    pub(super) fn from_bytes(
        bytes: &'b [u8],
        path: &Path,
        budget: &ReadingBudget<'_>,
    ) -> Result<Self, FileError> {
        Ok(Source {
            sha256: sha256(bytes, path, budget)?,
            text: text_of(bytes, path, budget)?,
        })
    }

    /// Returns the text, decompressed and without a byte order mark.
    pub(super) fn text(&self) -> &[u8] {
        without_mark(&self.text)
    }
}

/// Removes a byte order mark from a text.
pub(super) fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(&BYTE_ORDER_MARK).unwrap_or(text)
}

/// Opens a file for reading and returns its length \[bytes\].
///
/// # Errors
/// The path is missing, or does not lead to a file and is therefore not opened: opening a pipe
/// would wait for a writer, and some systems permit opening a directory.
fn open_file(path: &Path) -> Result<(File, u64), FileError> {
    let failed = |error: std::io::Error| FileError::reading(path, &error);
    let metadata = fs::metadata(path).map_err(failed)?;
    if metadata.is_dir() {
        return Err(FileError::Directory {
            path: path.to_owned(),
        });
    }
    if let Some(kind) = special_file_kind(metadata.file_type()) {
        return Err(FileError::NotAFile {
            path: path.to_owned(),
            kind,
        });
    }
    Ok((File::open(path).map_err(failed)?, metadata.len()))
}

/// Returns a reader for the text in a file, decompressed if necessary.
pub(super) fn text_reader(path: &Path) -> Result<Box<dyn Read>, FileError> {
    let mut file = BufReader::with_capacity(CHUNK, open_file(path)?.0);
    let begin = file
        .fill_buf()
        .map_err(|error| FileError::reading(path, &error))?;
    if begin.starts_with(&GZIP_MAGIC) {
        Ok(Box::new(MultiGzDecoder::new(file)))
    } else {
        Ok(Box::new(file))
    }
}

/// Reads a whole file into memory.
///
/// # Errors
/// As `open_file`; the file is longer than `most` bytes, or the reading is cancelled.
pub(super) fn read_bytes(
    path: &Path,
    most: u64,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<u8>, FileError> {
    let failed = |error: std::io::Error| FileError::reading(path, &error);
    let (file, length) = open_file(path)?;
    // A byte more than permitted shows that the file is too long.
    let mut file = file.take(most + 1);
    let mut bytes = Vec::with_capacity(usize::try_from(length.min(most)).unwrap_or(0));
    loop {
        let mut chunk = file.by_ref().take(CHUNK as u64);
        if chunk.read_to_end(&mut bytes).map_err(failed)? == 0 {
            break;
        }
        // A work step per byte.
        budget
            .work(CHUNK as u64, "")
            .map_err(|fault| FileError::variables(path, fault))?;
    }
    check_length(bytes.len() as u64, most, path)?;
    Ok(bytes)
}

/// Describes a path that is neither a file nor a directory; `None` for files, directories and
/// links.
pub(super) fn special_file_kind(file_type: FileType) -> Option<&'static str> {
    if file_type.is_file() || file_type.is_dir() || file_type.is_symlink() {
        return None;
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if file_type.is_fifo() {
            return Some("a named pipe");
        }
        if file_type.is_socket() {
            return Some("a socket");
        }
        if file_type.is_char_device() || file_type.is_block_device() {
            return Some("a device");
        }
    }
    Some("a special file")
}

/// Returns the text in `bytes`, decompressed if necessary; memory for decompressed text is taken
/// from the budget.
pub(super) fn text_of<'b>(
    bytes: &'b [u8],
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<Cow<'b, [u8]>, FileError> {
    if bytes.starts_with(&GZIP_MAGIC) {
        return unpack(bytes, path, budget).map(Cow::Owned);
    }
    check_length(bytes.len() as u64, LARGEST_TEXT, path)?;
    Ok(Cow::Borrowed(bytes))
}

/// Computes the SHA-256 of bytes, in lower-case hexadecimal.
pub(super) fn sha256(
    bytes: &[u8],
    path: &Path,
    budget: &ReadingBudget<'_>,
) -> Result<String, FileError> {
    let mut hash = Sha256::new();
    for chunk in bytes.chunks(CHUNK) {
        // Only check for cancellation: the bytes were counted when they were read.
        budget
            .work(0, "")
            .map_err(|fault| FileError::variables(path, fault))?;
        hash.update(chunk);
    }
    let digest = hash.finalize();
    Ok(digest.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Computes the SHA-256 of the stored bytes in a file, in lower-case hexadecimal.
///
/// # Errors
/// The file cannot be read, exceeds the size limit, or has damaged gzip data.
pub fn file_sha256(path: &Path) -> Result<String, FileError> {
    Ok(Source::read(path, &ReadingBudget::default())?.sha256)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_agrees_with_the_published_example() {
        // Source of the example: FIPS 180-2, appendix B.1.
        let hash = sha256(b"abc", Path::new("x"), &ReadingBudget::new(0)).unwrap();
        assert_eq!(
            hash,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }

    #[test]
    fn members_are_joined_and_zeros_after_the_last_are_skipped() {
        use std::io::Write;
        let member = |text: &[u8]| {
            let mut encoder =
                flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
            encoder.write_all(text).unwrap();
            encoder.finish().unwrap()
        };
        let packed = [member(b"{"), member(b""), member(b"}"), vec![0; 700]].concat();
        let source = |bytes| Source::from_bytes(bytes, Path::new("x"), &ReadingBudget::default());
        assert_eq!(source(&packed).unwrap().text(), b"{}");
        let strange = [member(b"{}"), b"\0\0something else".to_vec()].concat();
        assert!(matches!(source(&strange), Err(FileError::Gzip { .. })));
        let cut = [member(b"{"), member(b"}")[..12].to_vec()].concat();
        assert!(matches!(source(&cut), Err(FileError::GzipCutOff { .. })));
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_text() {
        let source =
            Source::from_bytes(b"\xef\xbb\xbf{}", Path::new("x"), &ReadingBudget::default())
                .unwrap();
        assert_eq!(source.text(), b"{}");
    }
}
