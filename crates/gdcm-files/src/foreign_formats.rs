//! Files of formats that are known by their first bytes and not read: what they are, and how to save their numbers otherwise.

use std::path::Path;

use crate::file_error::FileError;
use crate::importer::{Contents, Importer};
use crate::variables::{ReadingBudget, VariableFault};

/// A format that is not read: what its files begin with, its name, and what to do.
struct Foreign(&'static [u8], &'static str, &'static str);

const AS_TABLE: &str = "save it as text in columns (CSV)";
const UNPACK: &str = "unpack it, or pack it as .zip or .gz";

const FOREIGN: [Foreign; 17] = [
    Foreign(b"PAR1", "a Parquet file", "save it as CSV: pandas.read_parquet(\"{file}\").to_csv(\"{stem}.csv\")"),
    Foreign(
        b"ARROW1",
        "an Arrow or Feather file",
        "save it as CSV: pandas.read_feather(\"{file}\").to_csv(\"{stem}.csv\")",
    ),
    Foreign(b"FEA1", "a Feather file", "save it as CSV: pandas.read_feather(\"{file}\").to_csv(\"{stem}.csv\")"),
    Foreign(b"\x80\x02", "a pickle of Python", "save its arrays: numpy.savez(\"{stem}.npz\", A=A, B=B, C=C, D=D)"),
    Foreign(b"\x80\x03", "a pickle of Python", "save its arrays: numpy.savez(\"{stem}.npz\", A=A, B=B, C=C, D=D)"),
    Foreign(b"\x80\x04", "a pickle of Python", "save its arrays: numpy.savez(\"{stem}.npz\", A=A, B=B, C=C, D=D)"),
    Foreign(b"\x80\x05", "a pickle of Python", "save its arrays: numpy.savez(\"{stem}.npz\", A=A, B=B, C=C, D=D)"),
    Foreign(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an Excel workbook or another document of Microsoft Office", AS_TABLE),
    Foreign(b"SQLite format 3", "a database of SQLite", AS_TABLE),
    Foreign(
        b"CDF\x01",
        "a netCDF file",
        "save it as CSV or as netCDF-4, which is HDF5: nccopy -k nc4 \"{file}\" \"{stem}.h5\"",
    ),
    Foreign(
        b"CDF\x02",
        "a netCDF file",
        "save it as CSV or as netCDF-4, which is HDF5: nccopy -k nc4 \"{file}\" \"{stem}.h5\"",
    ),
    Foreign(b"MDF     ", "an MDF file of measurements", "save it as CSV or MATLAB"),
    Foreign(b"TDSm", "a TDMS file of LabVIEW", "save it as CSV or MATLAB"),
    Foreign(b"%PDF-", "a PDF document", AS_TABLE),
    Foreign(b"\x89PNG", "a picture", "save its numbers, not what they look like"),
    Foreign(b"7z\xbc\xaf\x27", "an archive of 7-Zip", UNPACK),
    Foreign(b"\xfd7zXZ", "a file packed by xz", UNPACK),
];

/// What other formats look like.
pub(crate) struct ForeignFormat;

impl Importer for ForeignFormat {
    fn name(&self) -> &'static str {
        "a file of a format that is not read"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["parquet", "feather", "pkl"]
    }

    fn recognises(&self, bytes: &[u8], _: &str) -> bool {
        foreign(bytes).is_some()
    }

    fn read(&self, bytes: &[u8], path: &Path, _: &ReadingBudget<'_>) -> Result<Contents, FileError> {
        let (what, remedy) = foreign(bytes).map_or(("a file", AS_TABLE), |Foreign(_, what, remedy)| (*what, *remedy));
        let (what, remedy) = (what.to_owned(), remedy.to_owned());
        Err(FileError::variables(path, VariableFault::Unsupported { variable: String::new(), what, remedy }))
    }
}

fn foreign(bytes: &[u8]) -> Option<&'static Foreign> {
    FOREIGN.iter().find(|Foreign(mark, ..)| bytes.starts_with(mark))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_another_format_is_named_with_the_way_to_save_it_otherwise() {
        let read =
            ForeignFormat.read(b"PAR1\x15\x04", Path::new("logs/flight 7.parquet"), &ReadingBudget::new(1 << 20));
        let words = read.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(words.contains("a Parquet file cannot be read; save it as CSV"), "{words}");
        assert!(words.ends_with("pandas.read_parquet(\"flight 7.parquet\").to_csv(\"flight 7.csv\")"), "{words}");
        assert!(!ForeignFormat.recognises(b"omega,re,im\n", "csv"));
    }
}
