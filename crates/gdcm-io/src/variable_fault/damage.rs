//! Contradictions between a file's bytes and its format. To each message,
//! [`VariableFault::Damaged`](super::VariableFault::Damaged) adds the variable, usually the
//! position, and the remedy.

use gdcm_model::number_format::counted;

use crate::variable_fault::octave_fault::OctaveFault;

/// Contradiction between a file's bytes and its format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    #[error("the number of elements is too large")]
    ElementCount,
    #[error("the number of elements in the shape is too large")]
    ShapeElementCount,
    #[error("the sparse matrix is inconsistent")]
    SparseMatrix,
    #[error("a field has more or fewer values than there are records")]
    FieldLength,
    #[error("an element is outside the matrix")]
    ElementOutsideMatrix,
    // MATLAB files up to version 7.
    #[error("{found} at the expected start of a matrix")]
    NoMatrix {
        /// Contradiction at this start, for example "a negative size".
        found: &'static str,
    },
    #[error("the sparse matrix is inconsistent")]
    SparseNumbers,
    #[error("a sparse array that is not a matrix")]
    SparseArrayNotMatrix,
    #[error("a sparse matrix whose columns do not match its numbers")]
    SparseColumns,
    #[error("an element is outside the matrix")]
    ElementOutsideSparse,
    #[error("{} in {}", counted(*count, "value"), counted(*bytes, "byte"))]
    ValueCount { count: usize, bytes: usize },
    #[error("a struct without a length for its field names")]
    FieldNamesWithoutLength,
    #[error("field names that do not match their length")]
    FieldNamesLength,
    #[error("{} instead of {expected}", counted(*found, "number"))]
    NumberCount { found: usize, expected: usize },
    #[error("{} instead of {expected}", counted(*found, "character"))]
    CharacterCount { found: usize, expected: usize },
    #[error("sizes that are not stored as 32-bit integers")]
    SizesNotIntegers,
    #[error("a negative size")]
    NegativeSize,
    #[error("an array instead of numbers")]
    ArrayForNumbers,
    #[error("numbers instead of a name")]
    NumbersForName,
    #[error("another element instead of an array")]
    ElementForArray,
    #[error("{length} bytes for numbers of {width} bytes each")]
    NumberWidth { length: usize, width: usize },
    #[error("an element of unknown data type {number}")]
    UnknownDataType { number: u32 },
    #[error("an element is longer than the element that contains it")]
    ElementLength,
    #[error("an array without flags")]
    ArrayWithoutFlags,
    #[error("an array of unknown class {number}")]
    UnknownArrayClass { number: u32 },
    #[error("the compressed data end too early")]
    CompressedDataEnd,
    #[error("the compressed data are corrupt")]
    CompressedData,
    #[error("more compressed data than the file announces")]
    CompressedDataLength,
    #[error("{packed} compressed bytes that claim to expand to {length} bytes")]
    Expansion { packed: usize, length: u64 },
    // MATLAB class objects.
    #[error("the file has no object part")]
    NoObjectPart,
    #[error("the object part has no header")]
    ObjectPartHeader,
    #[error("the class systems are not in a record")]
    ClassSystemsRecord,
    #[error("the class systems do not include MCOS")]
    ClassSystemMissing,
    #[error("the class system MCOS has no FileWrapper__")]
    FileWrapperMissing,
    #[error("the FileWrapper__ has no cells")]
    FileWrapperCells,
    #[error("the directory of objects is missing")]
    DirectoryMissing,
    #[error("the directory of objects does not consist of bytes")]
    DirectoryBytes,
    #[error("the directory of objects is cut off")]
    DirectoryCutOff,
    #[error("the directory of objects has the unknown version {version}")]
    DirectoryVersion { version: u32 },
    #[error("the directory of objects exceeds its cell")]
    DirectoryLength,
    #[error("the names of objects are cut off")]
    ObjectNamesCutOff,
    #[error("the properties of an object are cut off")]
    PropertiesCutOff,
    #[error("class {class} has no object with number {object}")]
    NoSuchObject { class: u32, object: u32 },
    #[error("a property has no name")]
    PropertyWithoutName,
    #[error("a property has no value")]
    PropertyWithoutValue,
    // HDF5 files, including those that MATLAB or GNU Octave wrote.
    #[error("a part begins or ends beyond the end of the file")]
    PartBeyondEnd,
    #[error("the chunks have no valid size")]
    ChunkSize,
    #[error("a chunk is longer than its shape allows")]
    ChunkShape,
    #[error("a chunk is outside the dataset")]
    ChunkOutside,
    #[error("the dataset does not match its shape")]
    DatasetShape,
    #[error("the shape of an empty array is wrong")]
    EmptyArrayShape,
    #[error("strings are missing")]
    StringsMissing,
    #[error("the elements of a sparse matrix are not numbers")]
    SparseElements,
    #[error("the indices of a sparse matrix are not integers")]
    SparseIndices,
    #[error("a group lacks a type or a value")]
    GroupParts,
    #[error("a range lacks its base, limit or step")]
    RangeParts,
    #[error("the number of values in a cell array does not match its dimensions")]
    CellCount,
    #[error("an object has no class")]
    ObjectWithoutClass,
    #[error("an object has no fields")]
    ObjectWithoutFields,
    // NumPy arrays.
    #[error("the element type is neither a string nor a list")]
    ElementTypeForm,
    #[error("\"{}\" is not an element type", code.escape_default())]
    ElementTypeCode { code: String },
    #[error("a record is too large")]
    RecordSize,
    #[error("a field of the records lacks a name or a type")]
    RecordField,
    #[error("the header does not have exactly the keys descr, fortran_order and shape")]
    HeaderKeys,
    #[error("fortran_order is neither True nor False")]
    FortranOrder,
    #[error("the shape is not a tuple of integers")]
    ShapeTuple,
    #[error("the header is not UTF-8")]
    HeaderNotUtf8,
    #[error("the header is not a dictionary of strings, numbers and tuples")]
    HeaderLiteral,
    #[error("a string in the header is not closed")]
    HeaderStringOpen,
    #[error("the header contains an escape sequence, which is not supported")]
    HeaderEscape,
    #[error("the header contains an unknown word")]
    HeaderWord,
    // Zip archives.
    #[error("a file name is not UTF-8")]
    FileNameNotUtf8,
    #[error("a file in the archive claims to expand to more bytes than is possible")]
    ArchiveExpansion,
    // Autopilot logs.
    #[error("the log has no message with a time stamp and numbers")]
    NoTimedMessage,
    #[error("the log has no flight with at least {fewest} frames")]
    NoFlight { fewest: usize },
    #[error("the layout of \"{name}\" is missing")]
    LayoutMissing { name: String },
    #[error("\"{name}\" is not a field")]
    LayoutField { name: String },
    #[error("\"{name}\" has no valid length")]
    LayoutFieldLength { name: String },
    #[error("the field \"{name}\" is empty or too long")]
    LayoutFieldSize { name: String },
    // GNU Octave files.
    #[error(transparent)]
    Octave(#[from] OctaveFault),
    // Any format.
    /// Message from the library that reads the format.
    #[error("{message}")]
    Library { message: String },
}

impl Damage {
    /// Returns the end of the message: `offset`, the position in the file \[bytes\], and the
    /// remedy. The messages about logs have no position: a log without usable data calls for
    /// another log, a damaged layout for a new copy from the vehicle.
    pub(super) fn remedy(&self, offset: u64) -> String {
        match self {
            Self::NoTimedMessage | Self::NoFlight { .. } => "; choose another log".to_owned(),
            Self::LayoutMissing { .. }
            | Self::LayoutField { .. }
            | Self::LayoutFieldLength { .. }
            | Self::LayoutFieldSize { .. } => {
                ": the log is damaged; copy it again from the vehicle".to_owned()
            }
            Self::HeaderEscape => {
                ": use field names without quotation marks, backslashes and control characters"
                    .to_owned()
            }
            _ => format!(" (byte {offset}): the file is damaged; write it again"),
        }
    }
}
