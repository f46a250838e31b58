//! Archives of several arrays.

use std::collections::HashSet;

use super::array_file::read_npy;
use crate::variables::{MemoryBudget, Value, Variable, VariableFault};
use crate::zip_files::{ZipFile, damaged, visit_files};

/// What the name of every array in an archive ends with.
const SUFFIX: &str = ".npy";

/// Reads an `.npz` file of `NumPy`: a zip archive of `.npy` files, stored or deflated, whose names become those of the variables.
/// Other files in it are named as what cannot be read.
pub fn read_npz(bytes: &[u8], meter: &MemoryBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    let (mut names, mut variables) = (HashSet::new(), Vec::new());
    visit_files(bytes, |file| {
        // A few bytes in the archive's directory become a variable, whatever it holds.
        meter.take(1, size_of::<Variable>() as u64, "")?;
        let variable = variable(file, meter)?;
        if !names.insert(variable.name.clone()) {
            return Err(VariableFault::Duplicate { name: variable.name });
        }
        variables.push(variable);
        Ok(())
    })?;
    Ok(variables)
}

fn variable(file: &ZipFile<'_, '_>, meter: &MemoryBudget<'_>) -> Result<Variable, VariableFault> {
    let Some(name) = file.path.strip_suffix(SUFFIX) else {
        let opaque = Value::Opaque { class: "a file".to_owned(), why: "it is no array of NumPy (.npy)".to_owned() };
        return Ok(Variable { name: file.path.to_owned(), value: opaque });
    };
    let array = file.unpack(name, meter)?;
    read_npy(&array, name, meter)?.pop().ok_or_else(|| damaged(name, "there is no array", file.offset))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variables::Array;

    fn file(name: &str) -> Vec<u8> {
        std::fs::read(format!("{}/../../tests/data/npy/{name}.npz", env!("CARGO_MANIFEST_DIR"))).unwrap()
    }

    fn read(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        read_npz(bytes, &MemoryBudget::new(1 << 20, &|_| false))
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
