//! Zip archives and the files in them: a NumPy array (`.npy`) becomes a variable, a file in another
//! known format is read with that format's importer, and any other file, or an archive within the
//! archive, is ignored with a message.

use std::collections::HashSet;
use std::io::Read;
use std::path::Path;

use flate2::bufread::DeflateDecoder;
use rawzip::{CompressionMethod, ZipArchive, ZipFileHeaderRecord, ZipSliceArchive};

use crate::file_error::FileError;
use crate::formats::npy::read_npy;
use crate::formats::variables::Variable;
use crate::formats::{Contents, Importer, importer_of, is_known};
use crate::reading_budget::{NO_VARIABLE, ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Maximum ratio of decompressed to compressed bytes in deflate (RFC 1951).
const LARGEST_RATIO: u64 = 1032;

/// Number of bytes decompressed between two checks for cancellation.
const CHUNK: u64 = 1 << 20;

/// File name ending for NumPy arrays.
const ARRAY_ENDING: &str = ".npy";

/// Importer for zip archives: NumPy archives (`.npz`), and archives with files in any other format.
pub(crate) const ZIP: Importer = Importer {
    name: "a zip archive",
    endings: &["npz", "zip"],
    recognises: |bytes, _| matches!(bytes, [b'P', b'K', 3 | 5, ..]),
    read: |bytes, path, budget| {
        read_archive(bytes, budget).map_err(|fault| FileError::variables(path, fault))
    },
};

/// Reads the arrays and the other files in an archive. Nested archives and unsupported formats are
/// ignored with a message.
///
/// # Errors
/// [`VariableFault`] for a damaged archive, an entry that cannot be decompressed, an invalid or
/// duplicate array, or an exhausted budget. Any other error in a file is stored with this file.
pub(crate) fn read_archive(
    bytes: &[u8],
    budget: &ReadingBudget<'_>,
) -> Result<Contents, VariableFault> {
    let mut reading = ArchiveReading::default();
    visit_files(bytes, |file| reading.add(file, budget))?;
    Ok(Contents::Archive {
        variables: reading.variables,
        files: reading.files,
        ignored: reading.ignored,
    })
}

/// State while an archive is read.
#[derive(Default)]
struct ArchiveReading {
    /// Array names so far, to detect duplicates.
    names: HashSet<String>,
    variables: Vec<Variable>,
    files: Vec<(String, Result<Contents, FileError>)>,
    ignored: Vec<String>,
}

impl ArchiveReading {
    /// Reads a file in the archive: an array, a file in another known format, or one to be ignored.
    fn add(
        &mut self,
        file: &ZipFile<'_, '_>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        // Each entry needs memory for a variable or a file, whereas a few bytes in the archive's
        // directory suffice to create it.
        let overhead = size_of::<Variable>() + size_of::<Contents>() + file.path.len();
        budget.take(1, overhead as u64, NO_VARIABLE)?;
        if let Some(name) = file.path.strip_suffix(ARRAY_ENDING) {
            return self.add_array(file, name, budget);
        }
        let path = Path::new(file.path);
        let reason = if is_known(path) {
            let bytes = file.unpack(file.path, budget)?;
            let importer = importer_of(&bytes, path);
            if importer.name != ZIP.name {
                return self.add_contents(file, (importer.read)(&bytes, path, budget));
            }
            "an archive within the archive"
        } else {
            "an unsupported format"
        };
        self.ignored
            .push(format!("{}: not read ({reason})", file.path));
        Ok(())
    }

    /// Reads an array, which becomes the variable `name`.
    fn add_array(
        &mut self,
        file: &ZipFile<'_, '_>,
        name: &str,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        if !self.names.insert(name.to_owned()) {
            return Err(VariableFault::Duplicate {
                name: name.to_owned(),
            });
        }
        let bytes = file.unpack(name, budget)?;
        self.variables.extend(read_npy(&bytes, name, budget)?);
        Ok(())
    }

    /// Stores a file's contents, or the error from reading it.
    ///
    /// # Errors
    /// Only an exhausted budget or a cancellation.
    fn add_contents(
        &mut self,
        file: &ZipFile<'_, '_>,
        contents: Result<Contents, FileError>,
    ) -> Result<(), VariableFault> {
        match contents {
            Err(FileError::Variables { fault, .. }) if fault.is_of_the_budget() => Err(fault),
            contents => {
                self.files.push((file.path.to_owned(), contents));
                Ok(())
            }
        }
    }
}

/// A file in a zip archive (APPNOTE 6.3).
struct ZipFile<'z, 'b> {
    path: &'z str,
    /// Offset of the file in the archive \[bytes\].
    offset: u64,
    archive: &'z ZipSliceArchive<&'b [u8]>,
    entry: &'z ZipFileHeaderRecord<'b>,
}

/// Passes each file in an archive to `visit`, in archive order.
fn visit_files(
    bytes: &[u8],
    mut visit: impl FnMut(&ZipFile<'_, '_>) -> Result<(), VariableFault>,
) -> Result<(), VariableFault> {
    let archive = ZipArchive::from_slice(bytes).map_err(|_| unreadable(bytes))?;
    let mut entries = archive.entries();
    loop {
        let entry = entries.next_entry().map_err(|error| {
            VariableFault::damaged(
                NO_VARIABLE,
                library_damage(&error),
                archive.directory_offset(),
            )
        })?;
        let Some(entry) = entry else {
            return Ok(());
        };
        if entry.is_dir() {
            continue;
        }
        let path = entry.file_path();
        let offset = entry.local_header_offset();
        let path = std::str::from_utf8(path.as_bytes())
            .map_err(|_| VariableFault::damaged(NO_VARIABLE, Damage::FileNameNotUtf8, offset))?;
        visit(&ZipFile {
            path,
            offset,
            archive: &archive,
            entry: &entry,
        })?;
    }
}

impl ZipFile<'_, '_> {
    /// Decompresses the file, up to the size stated in the archive, because a few kilobytes can
    /// expand to gigabytes; `name` is the variable or file name in errors.
    fn unpack(&self, name: &str, budget: &ReadingBudget<'_>) -> Result<Vec<u8>, VariableFault> {
        if self.entry.flags().is_encrypted() {
            return Err(VariableFault::unsupported(
                name,
                UnsupportedContent::EncryptedEntry,
            ));
        }
        let stored = self
            .archive
            .get_entry(self.entry.wayfinder())
            .map_err(|error| self.damaged(name, library_damage(&error)))?;
        let packed = stored.data();
        let length = self.entry.uncompressed_size_hint();
        if length > (packed.len() as u64).saturating_mul(LARGEST_RATIO) {
            return Err(self.damaged(name, Damage::ArchiveExpansion));
        }
        budget.take(length, 1, name)?;
        let unpacked = match self.entry.compression_method() {
            CompressionMethod::STORE => {
                read_whole(stored.verifying_reader(packed), length, budget)?
            }
            CompressionMethod::DEFLATE => read_whole(
                stored.verifying_reader(DeflateDecoder::new(packed)),
                length,
                budget,
            )?,
            method => {
                return Err(VariableFault::unsupported(
                    name,
                    UnsupportedContent::CompressionMethod {
                        method: method.as_u16(),
                    },
                ));
            }
        };
        unpacked.map_err(|error| self.damaged(name, library_damage(&error)))
    }

    /// Returns the error for a damaged entry.
    fn damaged(&self, name: &str, damage: Damage) -> VariableFault {
        VariableFault::damaged(name, damage, self.offset)
    }
}

/// Returns the damage that the library reports.
fn library_damage(error: &impl ToString) -> Damage {
    Damage::Library {
        message: error.to_string(),
    }
}

/// Reads a whole entry and compares its length; stops at the first byte beyond `length`. The
/// archive reader compares the checksum at the end.
///
/// # Errors
/// The inner error if the entry is damaged, the outer error if the reading is cancelled.
fn read_whole(
    reader: impl Read,
    length: u64,
    budget: &ReadingBudget<'_>,
) -> Result<std::io::Result<Vec<u8>>, VariableFault> {
    let mut reader = reader.take(length.saturating_add(1));
    let mut unpacked = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    loop {
        // No work step, but an error if the reading is cancelled.
        budget.work(0, NO_VARIABLE)?;
        match reader.by_ref().take(CHUNK).read_to_end(&mut unpacked) {
            Ok(0) if unpacked.len() as u64 == length => return Ok(Ok(unpacked)),
            Ok(0) => {
                return Ok(Err(std::io::Error::other(
                    "its length differs from the stated length",
                )));
            }
            Ok(_) => {}
            Err(error) => return Ok(Err(error)),
        }
    }
}

/// Returns the error for an archive that cannot be opened. If it begins like an archive, its end
/// with the directory is missing.
fn unreadable(bytes: &[u8]) -> VariableFault {
    if bytes.starts_with(b"PK\x03\x04") {
        return VariableFault::cut_off(NO_VARIABLE, bytes.len());
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
