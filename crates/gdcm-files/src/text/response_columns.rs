//! Columns of a table put together to responses, by what their names and units say.

use super::columns::TextTable;
use super::frequency_columns::{
    FrequencyColumn, FrequencyUnit, MagnitudeUnit, PhaseUnit, RecognisedResponse, ResponseParts, unrecognised,
};
use crate::text::frequency_columns::ResponseLabel;
use crate::text::frequency_columns::{ColumnMeaning, KnownUnit, Quantity};
use crate::text::frequency_columns::{complex_at, is_increasing};
use crate::variables::VariableFault;

/// What the names and units of the columns say.
pub(super) struct ResponseColumns {
    meanings: Vec<ColumnMeaning>,
}

/// Columns that belong to one response.
#[derive(Default)]
struct Group {
    label: ResponseLabel,
    magnitude: Option<usize>,
    phase: Option<usize>,
    re: Option<usize>,
    im: Option<usize>,
    coherence: Option<usize>,
    error: Option<usize>,
}

impl ResponseColumns {
    /// Reads the names and units of a table.
    pub(super) fn of(table: &TextTable) -> Self {
        let name = |index: usize| table.names.as_ref().and_then(|names| names.get(index)).map_or("", String::as_str);
        let unit = |index: usize| table.units.get(index).and_then(|unit| unit.as_deref());
        let meanings = (0..table.columns.len()).map(|index| ColumnMeaning::of(name(index), unit(index))).collect();
        Self { meanings }
    }

    /// Whether no column but that of the frequency has a meaning.
    pub(super) fn says_nothing(&self) -> bool {
        self.meanings.iter().all(|meaning| matches!(meaning.quantity, None | Some(Quantity::Frequency)))
    }

    /// The column of frequencies: the one named so, or a first column without a meaning whose numbers are positive and increase.
    pub(super) fn frequency(
        &self,
        table: &TextTable,
        notes: &mut Vec<String>,
        certain: &mut bool,
    ) -> Result<FrequencyColumn, VariableFault> {
        let named = self.meanings.iter().position(|meaning| meaning.quantity == Some(Quantity::Frequency));
        let (column, reason) = match (named, self.meanings.first(), table.columns.first()) {
            (Some(column), _, _) => (column, self.meanings[column].reason.clone()),
            (None, Some(first), Some(values)) if first.quantity.is_none() && is_increasing(values) => {
                *certain = false;
                (0, "it is the first, and its numbers increase".to_owned())
            }
            _ => return Err(unrecognised("no frequency")),
        };
        let (unit, words) = match self.meanings[column].unit {
            Some(KnownUnit::Hertz) => (FrequencyUnit::Hertz, "Hz"),
            Some(KnownUnit::RadianPerSecond) => (FrequencyUnit::RadianPerSecond, "rad/s"),
            _ => {
                *certain = false;
                (FrequencyUnit::RadianPerSecond, "rad/s")
            }
        };
        let (known, place) = (self.unit_reason(table, column, "rad/s is taken"), place(table, column));
        notes.push(format!("{place} is read as the frequency in {words}: {reason}, {known}"));
        Ok(FrequencyColumn { column, unit })
    }

    /// The responses, in the order of their first columns.
    pub(super) fn responses(
        &self,
        table: &TextTable,
        notes: &mut Vec<String>,
        certain: &mut bool,
    ) -> Vec<RecognisedResponse> {
        let mut responses = Vec::new();
        for group in self.groups(table, notes) {
            let polar = group.magnitude.zip(group.phase).map(|pair| self.polar(table, pair, notes, certain));
            let parts = match (group.re.zip(group.im), polar) {
                (Some((re, im)), polar) => {
                    let rectangular = ResponseParts::Rectangular { re, im };
                    self.note_rectangular(table, re, im, notes);
                    if let Some(polar) = polar {
                        compare(table, rectangular, polar, notes, certain);
                    }
                    rectangular
                }
                (None, Some(polar)) => polar,
                (None, None) => {
                    note_left_out(table, &group, notes);
                    continue;
                }
            };
            if let Some(column) = group.coherence {
                notes.push(format!("{} is read as coherence: {}", place(table, column), self.meanings[column].reason));
            }
            if group.label.doubtful {
                *certain = false;
            }
            let ResponseLabel { output, input, .. } = group.label;
            responses.push(RecognisedResponse { output, input, parts, coherence: group.coherence });
        }
        responses
    }

    fn groups(&self, table: &TextTable, notes: &mut Vec<String>) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::new();
        for (column, meaning) in self.meanings.iter().enumerate() {
            let Some(quantity) = meaning.quantity else {
                if column > 0 {
                    notes.push(format!("{} is left out: its name says nothing known", place(table, column)));
                }
                continue;
            };
            if quantity == Quantity::Frequency {
                continue;
            }
            let unnamed = meaning.label.output.is_none() && meaning.label.input.is_none();
            let free = |group: &Group| group.slot(quantity).is_none();
            // Most of an error's name says of what it is an error.
            let beside = unnamed || quantity == Quantity::Error;
            let known = match groups.last() {
                Some(last) if beside && free(last) => Some(groups.len() - 1),
                _ => groups.iter().rposition(|group| group.label == meaning.label && free(group)),
            };
            let index = known.unwrap_or(groups.len());
            if known.is_none() {
                groups.push(Group { label: meaning.label.clone(), ..Group::default() });
            }
            groups[index].set(quantity, column);
        }
        groups
    }

    fn polar(
        &self,
        table: &TextTable,
        (magnitude, phase): (usize, usize),
        notes: &mut Vec<String>,
        certain: &mut bool,
    ) -> ResponseParts {
        let (magnitude_unit, said) = match self.meanings[magnitude].unit {
            Some(KnownUnit::Decibel) => (MagnitudeUnit::Decibel, "its unit says dB"),
            Some(_) => (MagnitudeUnit::Absolute, "its unit is not dB"),
            None => magnitude_by_numbers(&table.columns[magnitude], certain),
        };
        let words = if magnitude_unit == MagnitudeUnit::Decibel { "magnitude in dB" } else { "absolute magnitude" };
        let reason = &self.meanings[magnitude].reason;
        notes.push(format!("{} is read as {words}: {reason}, {said}", place(table, magnitude)));
        let (phase_unit, said) = match self.meanings[phase].unit {
            Some(KnownUnit::Degree) => (PhaseUnit::Degree, "its unit says deg"),
            Some(KnownUnit::Radian) => (PhaseUnit::Radian, "its unit says rad"),
            _ => phase_by_numbers(&table.columns[phase], certain),
        };
        let words = if phase_unit == PhaseUnit::Degree { "deg" } else { "rad" };
        notes.push(format!(
            "{} is read as phase in {words}: {}, {said}",
            place(table, phase),
            self.meanings[phase].reason
        ));
        ResponseParts::Polar { magnitude, magnitude_unit, phase, phase_unit }
    }

    fn note_rectangular(&self, table: &TextTable, re: usize, im: usize, notes: &mut Vec<String>) {
        for (column, words) in [(re, "real"), (im, "imaginary")] {
            notes.push(format!("{} is read as {words} part: {}", place(table, column), self.meanings[column].reason));
        }
    }

    fn unit_reason(&self, table: &TextTable, column: usize, otherwise: &str) -> String {
        match (self.meanings[column].unit, table.units.get(column).and_then(Option::as_ref)) {
            (Some(KnownUnit::Other), Some(unit)) => format!("its unit \"{unit}\" is not known: {otherwise}"),
            (_, Some(unit)) => format!("its unit says {unit}"),
            (Some(_), None) => "and with it the unit".to_owned(),
            (None, None) => format!("its unit is not said: {otherwise}"),
        }
    }
}

impl Group {
    fn slot(&self, quantity: Quantity) -> Option<usize> {
        match quantity {
            Quantity::Magnitude => self.magnitude,
            Quantity::Phase => self.phase,
            Quantity::Real => self.re,
            Quantity::Imaginary => self.im,
            Quantity::Coherence => self.coherence,
            Quantity::Error | Quantity::Frequency => self.error,
        }
    }

    fn set(&mut self, quantity: Quantity, column: usize) {
        let slot = match quantity {
            Quantity::Magnitude => &mut self.magnitude,
            Quantity::Phase => &mut self.phase,
            Quantity::Real => &mut self.re,
            Quantity::Imaginary => &mut self.im,
            Quantity::Coherence => &mut self.coherence,
            Quantity::Error | Quantity::Frequency => &mut self.error,
        };
        *slot = Some(column);
    }
}

/// A column in words: its number from 1, and its name.
pub(super) fn place(table: &TextTable, column: usize) -> String {
    match table.names.as_ref().and_then(|names| names.get(column)) {
        Some(name) => format!("column {} (\"{name}\")", column + 1),
        None => format!("column {}", column + 1),
    }
}

fn note_left_out(table: &TextTable, group: &Group, notes: &mut Vec<String>) {
    for column in [group.magnitude, group.phase, group.re, group.im, group.coherence].into_iter().flatten() {
        notes.push(format!("{} is left out: its other half is missing", place(table, column)));
    }
}

pub(super) fn magnitude_by_numbers(values: &[f64], certain: &mut bool) -> (MagnitudeUnit, &'static str) {
    *certain = false;
    if values.iter().any(|&value| value < 0.0) {
        (MagnitudeUnit::Decibel, "some of its numbers are negative")
    } else {
        (MagnitudeUnit::Absolute, "none of its numbers is negative, but it could be dB all the same")
    }
}

/// Beyond one turn in radians nearly every column of phases is in degrees.
pub(super) fn phase_by_numbers(values: &[f64], certain: &mut bool) -> (PhaseUnit, &'static str) {
    *certain = false;
    if values.iter().any(|&value| value.abs() > 1.01 * std::f64::consts::TAU) {
        (PhaseUnit::Degree, "some of its numbers are larger than a turn in radians")
    } else {
        (PhaseUnit::Radian, "none of its numbers is larger than a turn in radians")
    }
}

/// Compares a response that is given twice, to a hundredth of its magnitude: tables are printed with few digits.
fn compare(
    table: &TextTable,
    rectangular: ResponseParts,
    polar: ResponseParts,
    notes: &mut Vec<String>,
    certain: &mut bool,
) {
    let ResponseParts::Polar { magnitude, phase, .. } = polar else { return };
    let differs = |row: &usize| {
        let ((a, b), (c, d)) = (complex_at(table, rectangular, *row), complex_at(table, polar, *row));
        (a - c).hypot(b - d) > 0.01 * a.hypot(b).max(c.hypot(d))
    };
    let columns = format!("magnitude and phase in columns {} and {}", magnitude + 1, phase + 1);
    match (0..table.lines.len()).find(differs) {
        None => notes.push(format!("{columns} agree with the real and imaginary parts, which are taken")),
        Some(row) => {
            *certain = false;
            let line = table.lines[row];
            notes.push(format!("{columns} differ from the real and imaginary parts, which are taken (line {line})"));
        }
    }
}
