//! Named variables in files of other programs; their meaning is determined elsewhere.
//!
//! All readers of such files (MATLAB, NumPy, text) return these values and know nothing of models.

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

// Limits of a reader, and its cancellation.

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::limits;
    use gdcm_model::dataset::limits::{
        LARGEST_TEXT, MOST_CHANNELS, MOST_CONDITIONS, MOST_COORDINATES, MOST_FREQUENCIES,
        MOST_MODELS, MOST_MODELS_IN_ALL, MOST_STATES,
    };
    use gdcm_model::dataset::state_space::GREATEST_CHANNEL_DELAY_S;
    use gdcm_model::units::number;
    use gdcm_study::decisions::setting::SETTINGS;
    use gdcm_study::decisions::setting_row::Kind;

    use crate::files::study_file::MOST_VARIANTS;
    use crate::formats::recorded_columns::MOST_RECORDS;
    use crate::formats::{DEEPEST, LARGEST_FILE, MOST_FILES};
    use crate::import::recognise::{DEEPEST as DEEPEST_VALUE, MOST_FOUND};
    use crate::reading_budget::{MOST_MEMORY, MOST_WORK};

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
