//! Files in zip archives.

use std::collections::HashSet;
use std::io::Read;
use std::path::Path;

use flate2::bufread::DeflateDecoder;
use rawzip::{CompressionMethod, ZipArchive, ZipFileHeaderRecord, ZipSliceArchive};

use super::variables::Variable;
use crate::file_error::FileError;
use crate::formats::npy::read_npy;
use crate::formats::{Contents, Importer, importer_of, is_known};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// Largest ratio of unpacked to packed bytes in deflate (RFC 1951).
const LARGEST_RATIO: u64 = 1032;

/// Number of bytes unpacked between two checks of the budget.
const CHUNK: u64 = 1 << 20;

/// Name ending of NumPy arrays.
const ARRAY: &str = ".npy";

/// Zip archives: NumPy arrays (`.npz`), and files of any other format.
pub(crate) const ZIP: Importer = Importer {
    name: "a zip archive",
    endings: &["npz", "zip"],
    recognises: |bytes, _| matches!(bytes, [b'P', b'K', 3 | 5, ..]),
    read: |bytes, path, budget| {
        read_archive(bytes, budget).map_err(|fault| FileError::variables(path, fault))
    },
};

/// Reads the arrays and the other files of an archive; nested archives are not read.
pub(crate) fn read_archive(
    bytes: &[u8],
    budget: &ReadingBudget<'_>,
) -> Result<Contents, VariableFault> {
    let mut names = HashSet::new();
    let mut variables = Vec::new();
    let mut files = Vec::new();
    let mut ignored = Vec::new();
    visit_files(bytes, |file| {
        // A few bytes in the archive's directory create a variable or a file, regardless of its
        // contents.
        budget.take(
            1,
            (size_of::<Variable>() + size_of::<Contents>() + file.path.len()) as u64,
            "",
        )?;
        let path = Path::new(file.path);
        if let Some(name) = file.path.strip_suffix(ARRAY) {
            if !names.insert(name.to_owned()) {
                return Err(VariableFault::Duplicate {
                    name: name.to_owned(),
                });
            }
            variables.extend(read_npy(&file.unpack(name, budget)?, name, budget)?);
            return Ok(());
        }
        let unpacked = if is_known(path) {
            Some(file.unpack(file.path, budget)?)
        } else {
            None
        };
        let importer = unpacked
            .as_deref()
            .map(|bytes| (importer_of(bytes, path), bytes));
        match importer.filter(|(importer, _)| importer.name != ZIP.name) {
            None => ignored.push(format!("{}: no file of a known kind", file.path)),
            Some((importer, bytes)) => match (importer.read)(bytes, path, budget) {
                Err(FileError::Variables { fault, .. }) if fault.is_of_the_budget() => {
                    return Err(fault);
                }
                contents => files.push((file.path.to_owned(), contents)),
            },
        }
        Ok(())
    })?;
    Ok(Contents::Archive {
        variables,
        files,
        ignored,
    })
}

/// A packed file in a zip archive (APPNOTE 6.3).
pub(super) struct ZipFile<'z, 'b> {
    /// Path in the archive.
    pub(super) path: &'z str,
    /// Offset of the file \[bytes\].
    pub(super) offset: u64,
    archive: &'z ZipSliceArchive<&'b [u8]>,
    entry: &'z ZipFileHeaderRecord<'b>,
}

/// Passes every file of an archive to `visit`, in archive order.
pub(super) fn visit_files(
    bytes: &[u8],
    mut visit: impl FnMut(&ZipFile<'_, '_>) -> Result<(), VariableFault>,
) -> Result<(), VariableFault> {
    let archive = ZipArchive::from_slice(bytes).map_err(|_| unreadable(bytes))?;
    let mut entries = archive.entries();
    while let Some(entry) = entries.next_entry().map_err(|error| {
        VariableFault::damaged("", error.to_string(), archive.directory_offset())
    })? {
        if entry.is_dir() {
            continue;
        }
        let path = entry.file_path();
        let offset = entry.local_header_offset();
        let path = std::str::from_utf8(path.as_bytes())
            .map_err(|_| VariableFault::damaged("", "a name is not UTF-8", offset))?;
        visit(&ZipFile {
            path,
            offset,
            archive: &archive,
            entry: &entry,
        })?;
    }
    Ok(())
}

impl ZipFile<'_, '_> {
    /// Unpacks the file up to the size given by the archive: a few kilobytes can unpack to
    /// gigabytes. `name` is the name of the file in faults.
    pub(super) fn unpack(
        &self,
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<Vec<u8>, VariableFault> {
        let unsupported = |what: &str| {
            VariableFault::unsupported(name, what, "pack it again by deflate, without a password")
        };
        if self.entry.flags().is_encrypted() {
            return Err(unsupported("an encrypted entry"));
        }
        let found = self.archive.get_entry(self.entry.wayfinder());
        let found =
            found.map_err(|error| VariableFault::damaged(name, error.to_string(), self.offset))?;
        let packed = found.data();
        let length = self.entry.uncompressed_size_hint();
        if length > (packed.len() as u64).saturating_mul(LARGEST_RATIO) {
            return Err(VariableFault::damaged(
                name,
                "it claims more bytes than it can unpack to",
                self.offset,
            ));
        }
        budget.take(length, 1, name)?;
        let unpacked = match self.entry.compression_method() {
            CompressionMethod::STORE => read_whole(found.verifying_reader(packed), length, budget)?,
            CompressionMethod::DEFLATE => read_whole(
                found.verifying_reader(DeflateDecoder::new(packed)),
                length,
                budget,
            )?,
            method => {
                return Err(unsupported(&format!(
                    "an entry packed by method {}",
                    method.as_u16()
                )));
            }
        };
        unpacked.map_err(|error| VariableFault::damaged(name, error.to_string(), self.offset))
    }
}

/// Reads up to the end, where the length and the checksum are compared, or one byte beyond
/// `length`, unless the reading is stopped.
fn read_whole(
    reader: impl Read,
    length: u64,
    budget: &ReadingBudget<'_>,
) -> Result<std::io::Result<Vec<u8>>, VariableFault> {
    let mut reader = reader.take(length.saturating_add(1));
    let mut unpacked = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    loop {
        budget.work(0, "")?;
        match reader.by_ref().take(CHUNK).read_to_end(&mut unpacked) {
            Ok(0) if unpacked.len() as u64 == length => return Ok(Ok(unpacked)),
            Ok(0) => return Ok(Err(std::io::Error::other("it is not as long as it claims"))),
            Ok(_) => {}
            Err(error) => return Ok(Err(error)),
        }
    }
}

/// Returns the fault for an unreadable archive: a file with the signature of an archive has lost
/// its end, which holds the directory.
fn unreadable(bytes: &[u8]) -> VariableFault {
    if bytes.starts_with(b"PK\x03\x04") {
        return VariableFault::cut_off("", bytes.len());
    }
    VariableFault::other_bytes("a zip archive (.npz, .zip)", bytes)
}

#[cfg(test)]
pub(crate) fn read_npz(
    bytes: &[u8],
    budget: &ReadingBudget<'_>,
) -> Result<Vec<Variable>, VariableFault> {
    match read_archive(bytes, budget)? {
        Contents::Archive { variables, .. } => Ok(variables),
        _ => Ok(Vec::new()),
    }
}
