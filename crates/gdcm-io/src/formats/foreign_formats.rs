//! Unsupported formats recognised by their first bytes: names and export instructions.

use crate::file_error::FileError;
use crate::formats::Importer;
use crate::reading_budget::VariableFault;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// An unsupported format, with export instructions.
struct Foreign {
    /// Alternative first bytes by which the format is recognised.
    signatures: &'static [&'static [u8]],
    name: &'static str,
    /// How to export the data; `{file}` and `{stem}` represent the file name with and without its
    /// extension.
    remedy: &'static str,
}

const AS_TABLE: &str = "save it as text in columns (CSV)";
const UNPACK: &str = "decompress it, or compress it as .zip or .gz";
const FROM_FEATHER: &str = "save it as CSV: pandas.read_feather(\"{file}\").to_csv(\"{stem}.csv\")";
const FROM_PARQUET: &str = "save it as CSV: pandas.read_parquet(\"{file}\").to_csv(\"{stem}.csv\")";
const FROM_PICKLE: &str = "save its arrays: numpy.savez(\"{stem}.npz\", A=A, B=B, C=C, D=D)";
const FROM_NETCDF: &str =
    "save it as CSV or as netCDF-4, which is HDF5: nccopy -k nc4 \"{file}\" \"{stem}.h5\"";
const AS_CSV: &str = "save it as a CSV or MATLAB file";

/// All recognised formats that are not supported.
const FOREIGN: [Foreign; 13] = [
    Foreign {
        signatures: &[b"PAR1"],
        name: "a Parquet file",
        remedy: FROM_PARQUET,
    },
    Foreign {
        signatures: &[b"ARROW1"],
        name: "an Arrow or Feather file",
        remedy: FROM_FEATHER,
    },
    Foreign {
        signatures: &[b"FEA1"],
        name: "a Feather file",
        remedy: FROM_FEATHER,
    },
    Foreign {
        signatures: &[b"\x80\x02", b"\x80\x03", b"\x80\x04", b"\x80\x05"],
        name: "a Python pickle",
        remedy: FROM_PICKLE,
    },
    Foreign {
        signatures: &[b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"],
        name: "an Excel workbook or another Microsoft Office document",
        remedy: AS_TABLE,
    },
    Foreign {
        signatures: &[b"SQLite format 3"],
        name: "an SQLite database",
        remedy: AS_TABLE,
    },
    Foreign {
        signatures: &[b"CDF\x01", b"CDF\x02"],
        name: "a netCDF file",
        remedy: FROM_NETCDF,
    },
    Foreign {
        signatures: &[b"MDF     "],
        name: "an MDF measurement file",
        remedy: AS_CSV,
    },
    Foreign {
        signatures: &[b"TDSm"],
        name: "a LabVIEW TDMS file",
        remedy: AS_CSV,
    },
    Foreign {
        signatures: &[b"%PDF-"],
        name: "a PDF document",
        remedy: AS_TABLE,
    },
    Foreign {
        signatures: &[b"\x89PNG"],
        name: "a picture",
        remedy: "save the numbers that it shows as text in columns",
    },
    Foreign {
        signatures: &[b"7z\xbc\xaf\x27"],
        name: "a 7-Zip archive",
        remedy: UNPACK,
    },
    Foreign {
        signatures: &[b"\xfd7zXZ"],
        name: "an xz-compressed file",
        remedy: UNPACK,
    },
];

/// Importer that recognises unsupported formats and rejects them with export instructions.
pub(super) const FOREIGN_FORMAT: Importer = Importer {
    name: "a file of an unsupported format",
    // Tables and arrays saved from Python. Only with a known extension is a file in a folder not
    // skipped silently, but rejected with instructions.
    endings: &["parquet", "feather", "pkl"],
    recognises: |bytes, _| find_foreign(bytes).is_some(),
    read: |bytes, path, _| Err(FileError::variables(path, unsupported(bytes))),
};

/// Returns the error for a file in an unsupported format.
fn unsupported(bytes: &[u8]) -> VariableFault {
    match find_foreign(bytes) {
        Some(Foreign { name, remedy, .. }) => foreign_file(name, remedy),
        // Not reached through `importer_of`, which chooses this importer by a signature.
        None => foreign_file("a file", AS_TABLE),
    }
}

fn foreign_file(format: &'static str, remedy: &'static str) -> VariableFault {
    VariableFault::unsupported("", UnsupportedContent::ForeignFile { format, remedy })
}

/// Returns the unsupported format with whose signature the bytes begin.
fn find_foreign(bytes: &[u8]) -> Option<&'static Foreign> {
    FOREIGN.iter().find(|format| {
        format
            .signatures
            .iter()
            .any(|signature| bytes.starts_with(signature))
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::reading_budget::ReadingBudget;

    #[test]
    fn unsupported_formats_are_named_with_export_instructions() {
        let read = (FOREIGN_FORMAT.read)(
            b"PAR1\x15\x04",
            Path::new("logs/flight 7.parquet"),
            &ReadingBudget::new(1 << 20),
        );
        let Err(FileError::Variables {
            fault: VariableFault::Unsupported { content, .. },
            ..
        }) = read
        else {
            panic!("a Parquet file is read")
        };
        let parquet = UnsupportedContent::ForeignFile {
            format: "a Parquet file",
            remedy: FROM_PARQUET,
        };
        assert_eq!(content, parquet);
        assert!(!(FOREIGN_FORMAT.recognises)(b"omega,re,im\n", "csv"));
    }
}
