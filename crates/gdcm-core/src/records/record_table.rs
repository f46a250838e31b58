//! A record as its file has it: columns of samples.

/// On which side of the aircraft a file says that a column is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnSide {
    /// What goes in: a stick, a pedal.
    Input,
    /// What comes out: a rate, an acceleration.
    Output,
}

/// A column of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordColumn {
    /// Its name; "column 3" where the file has none.
    pub name: String,
    /// Its unit, where the file says it.
    pub unit: Option<String>,
    /// Its side, where the file says it.
    pub side: Option<ColumnSide>,
    /// Samples, in the file's unit; not a number where one is missing.
    pub values: Vec<f64>,
}

impl RecordColumn {
    /// A column of which nothing but its name is known.
    pub fn new(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self { name: name.into(), unit: None, side: None, values }
    }

    /// Least and greatest of the samples that are numbers; none where there are none.
    pub fn range(&self) -> Option<(f64, f64)> {
        let finite = self.values.iter().copied().filter(|value| value.is_finite());
        let (least, most) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)));
        (least <= most).then_some((least, most))
    }
}

/// Where a record comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordSource {
    /// The file.
    pub file: String,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// Which record of the file, or which variable; none where the file holds one.
    pub variable: Option<String>,
}

/// A record as its file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordTable {
    /// Its name, for people.
    pub name: String,
    /// Its columns, all of one length.
    pub columns: Vec<RecordColumn>,
    /// Whether the file names the columns.
    pub named: bool,
    /// Sample time \[s\], where the file says it other than by a column.
    pub sample_time_s: Option<f64>,
    /// Where it comes from.
    pub source: RecordSource,
    /// How it was read, in words.
    pub notes: Vec<String>,
}

impl RecordTable {
    /// Number of samples.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The column of this name, as it is written, else without case.
    pub fn find(&self, name: &str) -> Option<usize> {
        let position = |is_it: &dyn Fn(&str) -> bool| self.columns.iter().position(|column| is_it(&column.name));
        position(&|column| column == name).or_else(|| position(&|column| column.eq_ignore_ascii_case(name.trim())))
    }

    /// The name of a column in quotation marks.
    pub(super) fn quoted(&self, column: usize) -> String {
        self.columns
            .get(column)
            .map_or_else(|| format!("column {}", column + 1), |column| format!("\"{}\"", column.name))
    }

    /// The names of all columns, no more than a message can bear.
    pub(super) fn column_names(&self) -> String {
        /// Enough to see what went wrong.
        const SHOWN: usize = 20;
        let names: Vec<&str> = self.columns.iter().take(SHOWN).map(|column| column.name.as_str()).collect();
        let rest = self.columns.len() - names.len();
        let more = if rest == 0 { String::new() } else { format!(" and {rest} more") };
        format!("{}{more}", names.join(", "))
    }
}
