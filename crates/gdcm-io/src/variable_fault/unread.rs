//! Reasons why a single value could not be read, although the file as a whole could: an opaque
//! value ([`Value::Opaque`](crate::formats::variables::Value::Opaque)) holds such a reason.

use crate::variable_fault::VariableFault;
use crate::variable_fault::damage::Damage;
use crate::variable_fault::matlab_value_fault::MatlabFault;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Reason why a value could not be read; the message contains its remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unread {
    /// An assignment in MATLAB or Octave statements.
    #[error("line {line}, column {column}: {fault}")]
    Statement {
        /// Line number, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        fault: MatlabFault,
    },
    /// A field is assigned to a variable that is not a struct.
    #[error("field {field} is set in {value}, which cannot have fields; use different names")]
    FieldOfOtherValue {
        field: String,
        /// Description of the variable's value.
        value: String,
    },
    /// An object of a MATLAB class.
    #[error("{fault}; in MATLAB, save its data: {command}")]
    Object {
        fault: ObjectFault,
        /// MATLAB command that exports the object's data.
        command: String,
    },
    /// An object of another class system, such as Java.
    #[error(
        "objects of classes other than MATLAB's cannot be read; in MATLAB, save their data as \
        numbers or text"
    )]
    ClassSystem,
    /// The file's object part, to which all objects refer, cannot be read.
    #[error("{0}")]
    ObjectPart(VariableFault),
    #[error("the data of this object are missing from the file; in MATLAB, save them as matrices")]
    NoObjectPart,
    #[error("the reference to the data in the file is damaged; save the file again")]
    DamagedReference,
    #[error("enumerations are not supported; in MATLAB, save them as text or numbers")]
    Enumeration,
    #[error("functions cannot be read; in MATLAB, save the values that they return")]
    Function,
    #[error("empty objects cannot be read; in MATLAB, remove the variable, or save [] instead")]
    Empty,
    #[error("expected an HDF5 dataset or group; save the values as a dataset")]
    NeitherDatasetNorGroup,
    #[error("expected numbers or strings in an HDF5 dataset; save the values as one of these")]
    NeitherNumbersNorStrings,
    /// A field in the records of an HDF5 dataset that is neither a number nor a string of fixed
    /// length.
    #[error("expected a number or a string of fixed length; save the field as one of these")]
    RecordField,
    #[error("cannot be read; {}", .0.remedy())]
    Unsupported(UnsupportedContent),
    /// The length of an unsupported value is unknown, so that later values cannot be found.
    #[error("this value and all later values cannot be read; {}", .0.remedy())]
    UnsupportedEnd(UnsupportedContent),
    /// A value of an unsupported type in an HDF5 file of GNU Octave.
    #[error("cannot be read; save the file in Octave with -v7")]
    OctaveType,
}

/// Reason why an object of a MATLAB class could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ObjectFault {
    #[error("values of this class are not supported")]
    Class,
    #[error("the object contains itself")]
    Cycle,
    #[error("the values of the object are nested too deeply")]
    TooDeep,
    #[error("the object is nested inside another object, which is not supported")]
    Nested,
    #[error("the strings are stored in an unknown form")]
    Strings,
    #[error("the members of the enumeration cannot be decoded")]
    Enumeration,
    #[error("the reference to the object is damaged")]
    DamagedReference,
    #[error("the reference points to no object")]
    NoTarget,
    #[error("{0}")]
    Damaged(Damage),
    #[error("the objects of this file cannot be read: {}", reason(.0))]
    ObjectPart(Box<VariableFault>),
}

impl Unread {
    /// Returns the stable code by which scripts and tests distinguish the reasons.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Statement { fault, .. } => fault.code(),
            Self::FieldOfOtherValue { .. } => "field-of-other-value",
            Self::Object { fault, .. } => fault.code(),
            Self::ClassSystem => "class-system",
            Self::ObjectPart(fault) => fault.code(),
            Self::NoObjectPart => "no-object-part",
            Self::DamagedReference => "damaged-reference",
            Self::Enumeration => "enumeration",
            Self::Function => "function",
            Self::Empty => "empty-object",
            Self::NeitherDatasetNorGroup => "neither-dataset-nor-group",
            Self::NeitherNumbersNorStrings => "neither-numbers-nor-strings",
            Self::RecordField => "record-field",
            Self::Unsupported(_) | Self::UnsupportedEnd(_) | Self::OctaveType => {
                "unsupported-content"
            }
        }
    }
}

impl ObjectFault {
    fn code(&self) -> &'static str {
        match self {
            Self::Class => "object-class",
            Self::Cycle => "object-cycle",
            Self::TooDeep => "object-too-deep",
            Self::Nested => "nested-object",
            Self::Strings => "packed-strings",
            Self::Enumeration => "enumeration-members",
            Self::DamagedReference => "damaged-reference",
            Self::NoTarget => "reference-without-target",
            Self::Damaged(_) => "damaged-object",
            Self::ObjectPart(_) => "unread-object-part",
        }
    }
}

/// Returns the message for a fault; for damaged bytes only the damage, without variable, position
/// and remedy.
fn reason(fault: &VariableFault) -> String {
    match fault {
        VariableFault::Damaged { damage, .. } => damage.to_string(),
        fault => fault.to_string(),
    }
}
