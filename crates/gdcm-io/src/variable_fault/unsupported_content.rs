//! Contents that a format permits but this program does not read, or that it cannot write.

/// Content that the format permits but this program does not read, or that it cannot write.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnsupportedContent {
    /// Another program's file, recognised by its first bytes.
    #[error("{format}")]
    ForeignFile {
        format: &'static str,
        /// How to export the data in another format; `{file}` and `{stem}` represent the file name
        /// with and without its extension.
        remedy: &'static str,
    },
    #[error("a GNU Octave {type_name}")]
    OctaveType { type_name: String },
    #[error("a character array with more than two dimensions")]
    OctavePages,
    #[error("an encrypted file in the archive")]
    EncryptedEntry,
    #[error("a file in the archive, compressed with method {method},")]
    CompressionMethod {
        /// Number of the compression method in the zip format specification.
        method: u16,
    },
    #[error("a ULog of a later version")]
    UlogVersion,
    #[error("a blackbox log of data version \"{version}\" (expected 2)")]
    BlackboxVersion { version: String },
    #[error(
        "a blackbox log whose complete frames (intra frames) are not described, or have an unknown encoding,"
    )]
    BlackboxFields,
    #[error("a dataset with several unlimited dimensions")]
    UnlimitedDimensions,
    #[error("a dataset of this kind ({message})")]
    HdfDataset {
        /// Message from the library that reads HDF5.
        message: String,
    },
    #[error("numbers of type {code}")]
    NumpyNumbers { code: String },
    #[error("dates or times of type {code}")]
    NumpyTimes { code: String },
    #[error("an array of Python objects")]
    PythonObjects,
    #[error("version {version} of the .npy format")]
    NpyVersion { version: u8 },
    #[error("data after the array")]
    DataAfterArray,
    /// A value that is neither numbers nor strings, and is therefore not written into NumPy
    /// archives.
    #[error("{value}")]
    ValueNotWritten {
        /// Description of the value, for the message.
        value: String,
    },
    #[error("a name this long")]
    LongNameNotWritten,
    #[error("an archive this large")]
    LargeArchiveNotWritten,
}

impl UnsupportedContent {
    /// Returns the verb in the message "CONTENT cannot be …": "read" or "written".
    pub(super) fn action(&self) -> &'static str {
        match self {
            Self::ValueNotWritten { .. }
            | Self::LongNameNotWritten
            | Self::LargeArchiveNotWritten => "written",
            _ => "read",
        }
    }

    /// Returns the remedy, usually how to save the data in another way; `{file}` and `{stem}`
    /// represent the file name with and without its extension.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::ForeignFile { remedy, .. } => remedy,
            Self::OctaveType { .. } => "save the file without this variable, or with -v7",
            Self::OctavePages => "save it as a cell array",
            Self::EncryptedEntry => "compress it again without a password",
            Self::CompressionMethod { .. } => "compress it again with deflate",
            Self::UlogVersion => "save its topics as CSV: ulog2csv \"{file}\"",
            Self::BlackboxVersion { .. } | Self::BlackboxFields => {
                "save it as CSV: blackbox_decode \"{file}\""
            }
            Self::UnlimitedDimensions => "write it with a fixed shape",
            // A program that requests the latest HDF5 2.0 format writes a new chunk layout, which
            // is not supported.
            Self::HdfDataset { .. } => {
                "write it with gzip compression or none, in a single file, in the format of HDF5 \
                1.14 or earlier"
            }
            Self::NumpyNumbers { .. } => "save them as float64",
            Self::NumpyTimes { .. } => "save them as float64, with the unit in the name",
            Self::PythonObjects => {
                "save each array under its own name, for example with numpy.savez(file, A=A, B=B)"
            }
            Self::NpyVersion { .. } => "save a plain array with numpy.save",
            Self::DataAfterArray => {
                "save a single array in each .npy file, or several with numpy.savez"
            }
            Self::ValueNotWritten { .. } => "write only arrays and strings",
            Self::LongNameNotWritten => "shorten the name",
            Self::LargeArchiveNotWritten => "write several files",
        }
    }
}
