//! Archives of several arrays.

use std::collections::HashSet;
use std::io::Read;

use flate2::bufread::DeflateDecoder;
use rawzip::{CompressionMethod, ZipArchive, ZipFileHeaderRecord, ZipSliceArchive};

use super::array_file::read_npy;
use crate::io::variables::{Meter, Value, Variable, VariableFault};

/// What the name of every array in an archive ends with.
const SUFFIX: &str = ".npy";
/// The most bytes that one byte of deflate (RFC 1951) can become.
const LARGEST_RATIO: u64 = 1032;

/// Reads an `.npz` file of `NumPy`: a zip archive (APPNOTE 6.3) of `.npy` files, stored or deflated, whose names become those of the
/// variables. Other files in it are named as what cannot be read.
pub fn read_npz(bytes: &[u8], meter: &Meter<'_>) -> Result<Vec<Variable>, VariableFault> {
    let archive = ZipArchive::from_slice(bytes).map_err(|_| unreadable(bytes))?;
    let mut entries = archive.entries();
    let (mut names, mut variables) = (HashSet::new(), Vec::new());
    while let Some(entry) =
        entries.next_entry().map_err(|error| damaged("", &error.to_string(), archive.directory_offset()))?
    {
        if entry.is_dir() {
            continue;
        }
        // A few bytes in the archive's directory become a variable, whatever it holds.
        meter.take(1, size_of::<Variable>() as u64, "")?;
        let variable = variable(&archive, &entry, meter)?;
        if !names.insert(variable.name.clone()) {
            return Err(VariableFault::Duplicate { name: variable.name });
        }
        variables.push(variable);
    }
    Ok(variables)
}

fn variable(
    archive: &ZipSliceArchive<&[u8]>,
    entry: &ZipFileHeaderRecord<'_>,
    meter: &Meter<'_>,
) -> Result<Variable, VariableFault> {
    let path = entry.file_path();
    let offset = entry.local_header_offset();
    let file = std::str::from_utf8(path.as_bytes()).map_err(|_| damaged("", "a name is not UTF-8", offset))?;
    let Some(name) = file.strip_suffix(SUFFIX) else {
        let opaque = Value::Opaque { class: "a file".to_owned(), why: "it is no array of NumPy (.npy)".to_owned() };
        return Ok(Variable { name: file.to_owned(), value: opaque });
    };
    let array = unpack(archive, entry, name, meter)?;
    read_npy(&array, name, meter)?.pop().ok_or_else(|| damaged(name, "there is no array", offset))
}

/// Unpacks an entry, and no further than the archive says: a few kilobytes can unpack to gigabytes.
fn unpack(
    archive: &ZipSliceArchive<&[u8]>,
    entry: &ZipFileHeaderRecord<'_>,
    name: &str,
    meter: &Meter<'_>,
) -> Result<Vec<u8>, VariableFault> {
    let offset = entry.local_header_offset();
    let unsupported = |what: String| {
        let remedy = "save it with numpy.savez or numpy.savez_compressed".to_owned();
        VariableFault::Unsupported { variable: name.to_owned(), what, remedy }
    };
    if entry.flags().is_encrypted() {
        return Err(unsupported("an encrypted entry".to_owned()));
    }
    let found = archive.get_entry(entry.wayfinder()).map_err(|error| damaged(name, &error.to_string(), offset))?;
    let (packed, length) = (found.data(), entry.uncompressed_size_hint());
    if length > (packed.len() as u64).saturating_mul(LARGEST_RATIO) {
        return Err(damaged(name, "it claims more bytes than it can unpack to", offset));
    }
    meter.take(length, 1, name)?;
    let unpacked = match entry.compression_method() {
        CompressionMethod::STORE => read_whole(found.verifying_reader(packed), length),
        CompressionMethod::DEFLATE => read_whole(found.verifying_reader(DeflateDecoder::new(packed)), length),
        method => return Err(unsupported(format!("an entry packed by method {}", method.as_u16()))),
    };
    unpacked.map_err(|error| damaged(name, &error.to_string(), offset))
}

/// Reads up to the end, where the length and the check sum are compared, or one byte beyond `length`.
fn read_whole(reader: impl Read, length: u64) -> std::io::Result<Vec<u8>> {
    let mut unpacked = Vec::new();
    reader.take(length.saturating_add(1)).read_to_end(&mut unpacked)?;
    if unpacked.len() as u64 == length {
        Ok(unpacked)
    } else {
        Err(std::io::Error::other("it is not as long as it claims"))
    }
}

/// Why there is no archive at all: a file begun as one has lost its end, where the directory stands.
fn unreadable(bytes: &[u8]) -> VariableFault {
    if bytes.starts_with(b"PK\x03\x04") {
        return VariableFault::CutOff { variable: String::new(), offset: bytes.len() as u64 };
    }
    let found = if bytes.is_empty() { "nothing" } else { "other bytes" };
    VariableFault::Format { expected: "an archive of NumPy (.npz)", found: found.to_owned() }
}

fn damaged(name: &str, what: &str, offset: u64) -> VariableFault {
    VariableFault::Damaged { variable: name.to_owned(), what: what.to_owned(), offset }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::variables::Array;

    fn file(name: &str) -> Vec<u8> {
        std::fs::read(format!("{}/tests/data/npy/{name}.npz", env!("CARGO_MANIFEST_DIR"))).unwrap()
    }

    fn read(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        read_npz(bytes, &Meter::new(1 << 20, &|_| false))
    }

    #[test]
    fn arrays_come_under_their_names_stored_or_packed() {
        for name in ["stored", "compressed"] {
            let variables = read(&file(name)).unwrap();
            let names: Vec<_> = variables.iter().map(|variable| variable.name.as_str()).collect();
            assert_eq!(names, ["A", "b", "names"]);
            assert_eq!(variables[0].value, Value::Array(Array::matrix(2, 2, vec![1.0, 3.0, 2.0, 4.0])));
        }
    }

    #[test]
    fn other_files_in_the_archive_are_named() {
        let variables = read(&file("with_text")).unwrap();
        assert_eq!((variables.len(), variables[1].name.as_str()), (2, "readme.txt"));
        assert!(matches!(variables[1].value, Value::Opaque { .. }));
    }

    #[test]
    fn a_name_that_stands_twice_is_refused() {
        assert_eq!(read(&file("duplicate")), Err(VariableFault::Duplicate { name: "a".to_owned() }));
    }

    #[test]
    fn an_archive_that_unpacks_to_more_than_is_allowed_is_refused_before_it_is_unpacked() {
        // 8 MB of zeros in 8 kB.
        assert_eq!(read(&file("bomb")), Err(VariableFault::TooLarge { variable: "zeros".to_owned(), most_mib: 1 }));
    }

    #[test]
    fn encrypted_entries_and_other_methods_are_refused_plainly() {
        let flags = |bytes: &mut Vec<u8>, local: usize, central: usize, value: u8| {
            let directory = bytes.windows(4).position(|four| four == b"PK\x01\x02").unwrap();
            bytes[local] = value;
            bytes[directory + central] = value;
        };
        let mut encrypted = file("stored");
        flags(&mut encrypted, 6, 8, 1);
        assert!(read(&encrypted).unwrap_err().to_string().contains("an encrypted entry cannot be read"));
        let mut other = file("stored");
        flags(&mut other, 8, 10, 12);
        assert!(read(&other).unwrap_err().to_string().contains("an entry packed by method 12 cannot be read"));
    }

    #[test]
    fn a_wrong_check_sum_is_damage() {
        let mut bytes = file("stored");
        let place = bytes.windows(8).position(|eight| eight == 4f64.to_le_bytes()).unwrap();
        bytes[place + 5] ^= 1;
        assert!(matches!(read(&bytes), Err(VariableFault::Damaged { variable, .. }) if variable == "A"));
    }

    #[test]
    fn what_is_no_archive_is_named() {
        assert!(matches!(read(b""), Err(VariableFault::Format { .. })));
        assert!(matches!(read(b"\x93NUMPY"), Err(VariableFault::Format { .. })));
        assert!(matches!(read(&file("stored")[..200]), Err(VariableFault::CutOff { .. })));
    }

    #[test]
    fn damage_anywhere_is_a_fault_and_never_a_panic() {
        for name in ["stored", "compressed"] {
            let whole = file(name);
            for length in 0..whole.len() {
                assert!(read(&whole[..length]).is_err(), "{name} cut to {length}");
            }
            for place in 0..whole.len() {
                for bit in 0..8 {
                    let mut bytes = whole.clone();
                    bytes[place] ^= 1 << bit;
                    let _ = read(&bytes);
                }
            }
        }
    }
}
