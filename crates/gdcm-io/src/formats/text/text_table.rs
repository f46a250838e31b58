//! Table of numbers in columns, with the names and units that a text gives, or the engineer's rules
//! for the import of files.

use crate::formats::reading_note::ReadingNote;
use crate::formats::text::heading_units::name_and_unit;
use crate::formats::text::lines::NumberedLine;
use crate::formats::text::separator::Separator;
use crate::reading_budget::VariableFault;
use crate::variable_fault::found_content::FoundContent;

/// Table of numbers in columns.
#[derive(Clone, Debug, PartialEq)]
pub struct TextTable {
    /// Column names; `None` if neither the text nor the rules give any.
    pub names: Option<Vec<String>>,
    /// Each column's unit, where the text or the rules give it.
    pub units: Vec<Option<String>>,
    /// Numbers by column. A missing number is NaN; code that needs the number reports its position.
    pub columns: Vec<Vec<f64>>,
    /// Each row's line number, counted from 1.
    pub lines: Vec<usize>,
    pub separator: Separator,
    pub decimal_comma: bool,
    /// Lines that are not rows, such as comments and headings.
    pub skipped: Vec<NumberedLine>,
    /// Notes for the user on how ambiguous parts were read.
    pub notes: Vec<ReadingNote>,
}

impl TextTable {
    /// Returns a column's name, if it has one.
    pub(super) fn name(&self, column: usize) -> Option<&str> {
        self.names.as_ref()?.get(column).map(String::as_str)
    }

    /// Returns the column headings, with units such as "omega \[rad/s\]"; empty strings for columns
    /// with neither name nor unit.
    pub fn headings(&self) -> Vec<String> {
        (0..self.units.len())
            .map(|column| self.heading(column))
            .collect()
    }

    fn heading(&self, column: usize) -> String {
        let name = self.name(column).unwrap_or_default();
        match &self.units[column] {
            Some(unit) => format!("{name} [{unit}]").trim().to_owned(),
            None => name.to_owned(),
        }
    }

    /// Replaces all column names and units by those in `headings`, written as in
    /// [`TextTable::headings`], and notes that they come from the rules.
    ///
    /// # Errors
    /// [`VariableFault`] if the number of headings differs from the number of columns.
    pub fn with_headings(mut self, headings: &[String]) -> Result<Self, VariableFault> {
        if headings.len() != self.columns.len() {
            let found = FoundContent::HeadingCount {
                headings: headings.len(),
                columns: self.columns.len(),
            };
            return Err(VariableFault::format("one heading for each column", found));
        }
        let mut names = Vec::with_capacity(headings.len());
        self.units.clear();
        for heading in headings {
            let (name, unit) = name_and_unit(heading);
            names.push(name);
            self.units.push(unit);
        }
        self.names = Some(names);
        self.notes.push(ReadingNote::HeadingsFromRules);
        Ok(self)
    }
}
