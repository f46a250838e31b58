//! Named variables in files of other programs; their meaning is determined elsewhere.
//!
//! All readers of such files (MATLAB, NumPy, text) return these values and know nothing of models.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use gdcm_model::message_text::shortened_name;

use crate::formats::MOST_MEMORY;

/// Type of the numbers in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKind {
    /// IEEE 754 numbers of 32 or 64 bits.
    Float,
    /// Signed or unsigned integers.
    Integer,
    /// True and false, as 1 and 0.
    Logical,
}

/// Numbers in an array, the first index running fastest (column by column).
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Number of elements along each dimension, at least two (a scalar is 1 x 1).
    pub shape: Vec<usize>,
    pub kind: ElementKind,
    /// The numbers, or their real parts. NaN and infinities are kept: the user of the numbers
    /// rejects them with their place.
    pub re: Vec<f64>,
    /// Imaginary parts of complex numbers, of the same length.
    pub im: Option<Vec<f64>>,
}

impl Array {
    /// Creates a real matrix from its values by columns.
    pub fn matrix(rows: usize, columns: usize, values: Vec<f64>) -> Self {
        debug_assert_eq!(rows * columns, values.len());
        Self {
            shape: vec![rows, columns],
            kind: ElementKind::Float,
            re: values,
            im: None,
        }
    }

    /// Returns the number of elements.
    pub fn len(&self) -> usize {
        self.re.len()
    }

    /// Returns whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.re.is_empty()
    }
}

/// A value with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub name: String,
    pub value: Value,
}

/// A value from any kind of file.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Numbers; sparse arrays are expanded with zeros.
    Array(Array),
    Text(TextArray),
    /// An array of values of any kind.
    Cell(CellArray),
    /// An array of records with the same fields.
    Struct(StructArray),
    /// An object of a class, as far as it could be decoded.
    Object(Object),
    /// An unreadable value.
    Opaque {
        /// Its class, or a description.
        class: String,
        /// The reason why it cannot be read.
        why: String,
    },
}

/// Texts: the rows of an array of characters, or an array of strings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextArray {
    /// Number of texts along each dimension.
    pub shape: Vec<usize>,
    /// The texts, the first index running fastest. Rows of characters keep their padding blanks.
    pub texts: Vec<String>,
}

/// An array of values, the first index running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct CellArray {
    /// Number of values along each dimension.
    pub shape: Vec<usize>,
    pub values: Vec<Value>,
}

/// An array of records, the first index running fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct StructArray {
    /// Number of records along each dimension.
    pub shape: Vec<usize>,
    /// The fields in order: name, and one value for each record.
    pub fields: Vec<(String, Vec<Value>)>,
}

/// Memory charged for a record besides its fields while files are read, even without fields
/// \[bytes\].
pub(crate) const RECORD: u64 = 64;

/// An object of a class, or an array of objects of the same class.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Class name: "ss", "idss", "string".
    pub class: String,
    pub records: StructArray,
}

impl TextArray {
    /// Creates an array with a single text.
    pub fn one(text: impl Into<String>) -> Self {
        Self {
            shape: vec![1, 1],
            texts: vec![text.into()],
        }
    }
}

impl Value {
    /// Creates a text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(TextArray::one(text))
    }

    /// Creates a real number.
    pub fn number(number: f64) -> Self {
        Self::Array(Array::matrix(1, 1, vec![number]))
    }

    /// Creates a logical value.
    pub fn truth(truth: bool) -> Self {
        let number = f64::from(u8::from(truth));
        Self::Array(Array {
            kind: ElementKind::Logical,
            ..Array::matrix(1, 1, vec![number])
        })
    }

    /// Creates an array without elements.
    pub fn empty() -> Self {
        Self::Array(Array::matrix(0, 0, Vec::new()))
    }

    /// Creates an unreadable value with the reason.
    pub fn opaque(class: impl Into<String>, why: impl Into<String>) -> Self {
        Self::Opaque {
            class: class.into(),
            why: why.into(),
        }
    }

    /// Iterates over the values inside this value.
    pub(crate) fn inner(&self) -> impl Iterator<Item = &Self> {
        let (values, fields): (&[Self], &[(String, Vec<Self>)]) = match self {
            Self::Cell(cell) => (&cell.values, &[]),
            Self::Struct(records) | Self::Object(Object { records, .. }) => (&[], &records.fields),
            Self::Array(_) | Self::Text(_) | Self::Opaque { .. } => (&[], &[]),
        };
        values
            .iter()
            .chain(fields.iter().flat_map(|(_, values)| values))
    }

    /// Returns its memory, excluding inner values, rounded up \[bytes\].
    pub(crate) fn own_memory(&self) -> u64 {
        let text = |text: &String| size_of::<String>() + text.len();
        let shape = |shape: &[usize]| size_of_val(shape);
        let bytes = match self {
            Self::Array(array) => {
                shape(&array.shape) + array.len() * if array.im.is_some() { 16 } else { 8 }
            }
            Self::Text(texts) => shape(&texts.shape) + texts.texts.iter().map(text).sum::<usize>(),
            Self::Cell(cell) => shape(&cell.shape),
            Self::Struct(records) => {
                shape(&records.shape)
                    + records
                        .fields
                        .iter()
                        .map(|(name, _)| 48 + text(name))
                        .sum::<usize>()
            }
            Self::Object(object) => shape(&object.records.shape) + text(&object.class),
            Self::Opaque { class, why } => text(class) + text(why),
        };
        (size_of::<Self>() + bytes) as u64
    }

    /// Describes the value in a message: "a 3 x 4 array of numbers".
    pub fn words(&self) -> String {
        let by = |shape: &[usize]| {
            shape
                .iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(" x ")
        };
        match self {
            Value::Array(array) if array.im.is_some() => {
                format!("a {} array of complex numbers", by(&array.shape))
            }
            Value::Array(array) => format!("a {} array of numbers", by(&array.shape)),
            Value::Text(text) if text.texts.len() == 1 => "a text".to_owned(),
            Value::Text(text) => format!("{} texts", text.texts.len()),
            Value::Cell(cell) => format!("a {} cell array", by(&cell.shape)),
            Value::Struct(records) => format!("a {} struct array", by(&records.shape)),
            Value::Object(object) => format!(
                "a {} array of {} objects",
                by(&object.records.shape),
                object.class
            ),
            Value::Opaque { class, .. } => format!("{class}, which cannot be read"),
        }
    }
}

impl StructArray {
    /// Creates a single record.
    pub fn one(fields: Vec<(String, Vec<Value>)>) -> Self {
        Self {
            shape: vec![1, 1],
            fields,
        }
    }

    /// Returns the values of a field, one for each record.
    pub fn field(&self, name: &str) -> Option<&[Value]> {
        self.fields
            .iter()
            .find(|(field, _)| field == name)
            .map(|(_, values)| values.as_slice())
    }
}

/// Reason why variables could not be read, and the variable (a path such as "sys.A" or
/// "models{3}.B"; empty if none was begun).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VariableFault {
    /// The file has another format.
    #[error("expected {expected}, found {found}")]
    Format {
        expected: &'static str,
        /// Beginning of the file, in words.
        found: String,
    },
    /// The file ends prematurely.
    #[error("{}the file is cut off (byte {offset}); copy it again", at(variable))]
    CutOff {
        variable: String,
        /// Position in the file \[bytes\].
        offset: u64,
    },
    /// The bytes contradict the format.
    #[error(
        "{}{what} (byte {offset}): the file is damaged; write it again",
        at(variable)
    )]
    Damaged {
        variable: String,
        what: String,
        /// Position in the file \[bytes\].
        offset: u64,
    },
    /// A line of a text is invalid.
    #[error("{}line {line}: {what}", at(variable))]
    Line {
        variable: String,
        /// Line number, from 1.
        line: usize,
        /// The fault and its remedy.
        what: String,
    },
    /// The format permits the content, but this program does not read it.
    #[error("{}{what} cannot be read; {remedy}", at(variable))]
    Unsupported {
        variable: String,
        what: String,
        /// How to obtain the data all the same; `{file}` and `{stem}` represent the file's name
        /// with and without its extension.
        remedy: String,
    },
    /// The file contains, or claims to contain, more than the limit.
    #[error(
        "{}this would take more than {most_mib} MiB of memory, which is the most that is read; split the file",
        at(variable)
    )]
    TooLarge {
        variable: String,
        /// The limit \[MiB\].
        most_mib: u64,
    },
    /// Reading the file would take longer than for any file of data.
    #[error(
        "{}this would take more than {most_millions} million steps of work, which is the most that is read; split the file",
        at(variable)
    )]
    TooMuchWork {
        variable: String,
        /// The limit \[million steps\].
        most_millions: u64,
    },
    /// Values are nested more deeply than the limit, or in a cycle.
    #[error("{}values are nested too deeply, or contain themselves", at(variable))]
    TooDeep { variable: String },
    /// Duplicate name.
    #[error("the name \"{name}\" stands twice; rename one")]
    Duplicate { name: String },
    /// The reader was stopped.
    #[error("stopped")]
    Stopped,
}

impl VariableFault {
    /// Creates the error for a file with another format.
    pub(crate) fn format(expected: &'static str, found: impl Into<String>) -> Self {
        Self::Format {
            expected,
            found: found.into(),
        }
    }

    /// Creates the error for a file with another format, from its bytes.
    pub(crate) fn other_bytes(expected: &'static str, bytes: &[u8]) -> Self {
        Self::format(
            expected,
            if bytes.is_empty() {
                "nothing"
            } else {
                "other bytes"
            },
        )
    }

    /// Creates the error for a file that ends prematurely.
    pub(crate) fn cut_off(variable: &str, offset: usize) -> Self {
        Self::CutOff {
            variable: variable.to_owned(),
            offset: offset as u64,
        }
    }

    /// Creates the error for bytes that contradict the format.
    pub(crate) fn damaged(variable: &str, what: impl Into<String>, offset: u64) -> Self {
        Self::Damaged {
            variable: variable.to_owned(),
            what: what.into(),
            offset,
        }
    }

    /// Creates the error for an invalid line of a text.
    pub(crate) fn line(variable: &str, line: usize, what: impl Into<String>) -> Self {
        Self::Line {
            variable: variable.to_owned(),
            line,
            what: what.into(),
        }
    }

    /// Creates the error for content that the format permits but this program does not read.
    pub(crate) fn unsupported(
        variable: &str,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Unsupported {
            variable: variable.to_owned(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }

    /// Creates the error for values nested more deeply than the limit.
    pub(crate) fn too_deep(variable: &str) -> Self {
        Self::TooDeep {
            variable: variable.to_owned(),
        }
    }

    /// Adds the affected value, unless the error names one already.
    #[must_use]
    pub(crate) fn of(mut self, name: impl FnOnce() -> String) -> Self {
        match &mut self {
            Self::CutOff { variable, .. }
            | Self::Damaged { variable, .. }
            | Self::Unsupported { variable, .. }
            | Self::TooLarge { variable, .. }
            | Self::TooMuchWork { variable, .. }
            | Self::Line { variable, .. }
            | Self::TooDeep { variable } => {
                if variable.is_empty() {
                    *variable = name();
                }
            }
            Self::Format { .. } | Self::Duplicate { .. } | Self::Stopped => {}
        }
        self
    }

    /// Returns whether the budget ends the reading: no other attempt with the file should follow.
    pub fn is_of_the_budget(&self) -> bool {
        matches!(
            self,
            Self::TooLarge { .. } | Self::TooMuchWork { .. } | Self::Stopped
        )
    }
}

fn at(variable: &str) -> String {
    if variable.is_empty() {
        String::new()
    } else {
        format!("variable {}: ", shortened_name(variable))
    }
}

// Limits of a reader, and its cancellation.

/// Maximum work for reading one file \[steps\]: bytes of a text, elements of an array, values,
/// comparisons of names.
pub(crate) const MOST_WORK: u64 = 4_000_000_000;

/// Counts the memory and the work of a reader: anything beyond the limits is rejected before it is
/// allocated, and a cancelled reader stops. Every reader asks in its inner loops, even for elements
/// without content: a file of a few bytes may claim 10^18 of them.
pub struct ReadingBudget<'p> {
    most_memory: u64,
    most_work: u64,
    memory: Cell<u64>,
    work: Cell<u64>,
    stop: Arc<AtomicBool>,
    tell: &'p dyn Fn(u64),
}

impl ReadingBudget<'static> {
    /// Creates a budget for at most `most` bytes of memory.
    pub fn new(most: u64) -> Self {
        let zero = || Cell::new(0);
        let stop = Arc::default();
        Self {
            most_memory: most,
            most_work: MOST_WORK,
            memory: zero(),
            work: zero(),
            stop,
            tell: &|_| (),
        }
    }
}

impl Default for ReadingBudget<'static> {
    /// Creates the budget of a single file, without cancellation.
    fn default() -> Self {
        Self::new(MOST_MEMORY)
    }
}

impl<'p> ReadingBudget<'p> {
    /// Returns the budget with another limit of work \[steps\].
    pub fn with_work(self, most: u64) -> Self {
        Self {
            most_work: most,
            ..self
        }
    }

    /// Returns the budget with a flag that stops the reader when set.
    pub fn stopped_by(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// Returns the budget with a callback that receives the number of bytes whenever memory is
    /// taken.
    pub fn telling<'q>(self, tell: &'q dyn Fn(u64)) -> ReadingBudget<'q> {
        let Self {
            most_memory,
            most_work,
            memory,
            work,
            stop,
            ..
        } = self;
        ReadingBudget {
            most_memory,
            most_work,
            memory,
            work,
            stop,
            tell,
        }
    }

    /// Returns the flag that stops the reader when set.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    /// Counts `count` elements of `size` bytes that `variable` is about to take; each is also a
    /// step of work.
    pub fn take(&self, count: u64, size: u64, variable: &str) -> Result<(), VariableFault> {
        let memory = self.memory.get().saturating_add(count.saturating_mul(size));
        if memory > self.most_memory {
            self.work(0, variable)?;
            return Err(VariableFault::TooLarge {
                variable: variable.to_owned(),
                most_mib: self.most_memory >> 20,
            });
        }
        self.work(count, variable)?;
        self.memory.set(memory);
        (self.tell)(memory);
        Ok(())
    }

    /// Stops a cancelled reader among elements that are already counted; called for each element,
    /// it checks now and then.
    pub fn go_on(&self, element: usize) -> Result<(), VariableFault> {
        /// Elements that take less than a hundredth of a second.
        const BETWEEN: usize = 1 << 14;
        let stops = element.is_multiple_of(BETWEEN) && self.stop.load(Ordering::Relaxed);
        if stops {
            Err(VariableFault::Stopped)
        } else {
            Ok(())
        }
    }

    /// Counts steps of work that `variable` is about to take.
    pub fn work(&self, steps: u64, variable: &str) -> Result<(), VariableFault> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(VariableFault::Stopped);
        }
        // The caller has done some work since its last call.
        let work = self.work.get().saturating_add(steps.max(1));
        if work > self.most_work {
            let most_millions = self.most_work / 1_000_000;
            return Err(VariableFault::TooMuchWork {
                variable: variable.to_owned(),
                most_millions,
            });
        }
        self.work.set(work);
        Ok(())
    }
}

#[cfg(test)]
mod budget_tests {
    use super::*;

    #[test]
    fn memory_and_work_are_refused_beyond_their_limits_and_not_before() {
        let budget = ReadingBudget::new(2 << 20).with_work(5_000_000);
        assert_eq!(budget.take(1 << 20, 2, "x"), Ok(()));
        let memory = budget.take(1, 1, "x").unwrap_err();
        let words = "variable x: this would take more than 2 MiB of memory, which is the most that is read; split the file";
        assert_eq!(memory.to_string(), words);
        assert_eq!(budget.work(3_000_000, ""), Ok(()));
        let work = budget.work(1_000_000, "").unwrap_err();
        let words = "this would take more than 5 million steps of work, which is the most that is read; split the file";
        assert_eq!(work.to_string(), words);
        assert!(memory.is_of_the_budget() && work.is_of_the_budget());
    }

    #[test]
    fn a_number_beyond_what_can_be_counted_is_beyond_the_limit() {
        let budget = ReadingBudget::new(1 << 20);
        assert!(matches!(
            budget.take(u64::MAX, 8, ""),
            Err(VariableFault::TooLarge { .. })
        ));
        assert!(matches!(
            budget.take(u64::MAX, 0, ""),
            Err(VariableFault::TooMuchWork { .. })
        ));
    }

    #[test]
    fn whoever_holds_the_flag_stops_the_reader_and_the_listener_hears_what_is_taken() {
        let stop = Arc::new(AtomicBool::new(false));
        let heard = Cell::new(0);
        let tell = |taken| heard.set(taken);
        let budget = ReadingBudget::new(1 << 20)
            .stopped_by(Arc::clone(&stop))
            .telling(&tell);
        assert_eq!((budget.take(3, 8, ""), heard.get()), (Ok(()), 24));
        stop.store(true, Ordering::Relaxed);
        assert_eq!(budget.take(u64::MAX, 1, ""), Err(VariableFault::Stopped));
        assert_eq!(budget.work(0, ""), Err(VariableFault::Stopped));
    }
}

#[cfg(test)]
mod limits_tests {
    use gdcm_model::dataset::limits;
    use gdcm_model::dataset::limits::{
        LARGEST_TEXT, MOST_CHANNELS, MOST_CONDITIONS, MOST_COORDINATES, MOST_FREQUENCIES,
        MOST_MODELS, MOST_MODELS_IN_ALL, MOST_STATES,
    };
    use gdcm_model::dataset::state_space::GREATEST_CHANNEL_DELAY_S;
    use gdcm_model::units::number;
    use gdcm_study::decisions::setting::SETTINGS;
    use gdcm_study::decisions::setting_row::Kind;

    use super::MOST_WORK;
    use crate::files::study_file::MOST_VARIANTS;
    use crate::formats::{DEEPEST, LARGEST_FILE, MOST_FILES, MOST_MEMORY};
    use crate::import::recognise::{DEEPEST as DEEPEST_VALUE, MOST_FOUND};
    use crate::import::record_files::MOST_RECORDS;

    fn of_files() -> String {
        let mib = |bytes: u64| format!("{} MiB", bytes >> 20);
        let rows = [
            ("a file of other programs", mib(LARGEST_FILE)),
            ("text of a file, unpacked", mib(LARGEST_TEXT)),
            (
                "memory for what a file holds, beside a copy of the models or records found in it",
                mib(MOST_MEMORY),
            ),
            (
                "work on a file: bytes of text, elements of arrays, values, names compared",
                format!("{} million steps", MOST_WORK / 1_000_000),
            ),
            (
                "files of the folders that are given",
                MOST_FILES.to_string(),
            ),
            ("folders inside one another", DEEPEST.to_string()),
            (
                "models among the variables of a file; values inside one another",
                format!("{MOST_FOUND}; {DEEPEST_VALUE}"),
            ),
            ("records of an archive", MOST_RECORDS.to_string()),
            ("inputs, outputs", format!("{MOST_CHANNELS} each")),
            ("conditions", MOST_CONDITIONS.to_string()),
            (
                "models of a bundle; of a file",
                format!("{MOST_MODELS}; {MOST_MODELS_IN_ALL}"),
            ),
            ("records of a condition", limits::MOST_RECORDS.to_string()),
            ("states of a model", MOST_STATES.to_string()),
            (
                "frequencies of a measured response",
                MOST_FREQUENCIES.to_string(),
            ),
            (
                "coordinates of a perturbation",
                MOST_COORDINATES.to_string(),
            ),
            ("variants of a study", MOST_VARIANTS.to_string()),
            (
                "delay of a model's channel",
                format!("{} s", number(GREATEST_CHANNEL_DELAY_S)),
            ),
        ];
        rows.map(|(what, most)| format!("| {what} | {most} |\n"))
            .concat()
    }

    fn of_settings() -> String {
        let row = |setting: &&gdcm_study::decisions::setting_row::Setting| {
            let ([least, greatest], whole) = match setting.kind {
                Kind::Number { range, whole, .. } => (range, whole),
                Kind::Optional { range, .. } | Kind::Range { range, .. } => (range, false),
                _ => return None,
            };
            let kind = if whole { ", a whole number" } else { "" };
            let unit = if setting.unit.file.is_empty() {
                String::new()
            } else {
                format!(" {}", setting.unit.file)
            };
            let option = setting.option;
            let name = setting.name;
            Some(format!(
                "| {name}{kind} | `{option}` | {}{unit} | {}{unit} |\n",
                number(least),
                number(greatest)
            ))
        };
        SETTINGS.iter().filter_map(row).collect()
    }

    #[test]
    fn the_limits_of_the_documentation_are_those_of_the_program() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/limits.md");
        let text = std::fs::read_to_string(path).unwrap();
        let mut parts: Vec<&str> = text.split_inclusive("|---|\n").collect();
        let [_, files, settings] = parts.as_mut_slice() else {
            panic!("two tables")
        };
        let end = |part: &str| {
            part.lines()
                .take_while(|line| line.starts_with('|'))
                .map(|line| line.len() + 1)
                .sum::<usize>()
        };
        let files = &files[..end(files)];
        let settings = &settings[..end(settings)];
        if std::env::var_os("GDCM_WRITE_FILES").is_some() {
            std::fs::write(
                path,
                text.replace(files, &of_files())
                    .replace(settings, &of_settings()),
            )
            .unwrap();
            return;
        }
        assert_eq!(files, of_files());
        assert_eq!(settings, of_settings());
    }
}
