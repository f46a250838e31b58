//! Assembles frequency responses from table columns.
//!
//! A response needs two columns: real and imaginary part (rectangular form), or magnitude and phase
//! (polar form). The columns are first grouped by response (`response_group.rs`). A missing unit
//! that the numbers do not reveal is not guessed: it is added to `missing_units`, and the user is
//! asked.
//!
//! `Recognition::frequency` is called before `Recognition::responses`, so that notes and missing
//! units are listed with the frequency first; afterwards, the results are in the public fields.

use std::f64::consts::TAU;

use crate::formats::reading_note::{ColumnReading, ReadingNote};
use crate::formats::reading_reason::UnitReason;
use crate::formats::text::column_meaning::ColumnMeaning;
use crate::formats::text::quantity_words::{KnownUnit, Quantity};
use crate::formats::text::response_columns::{
    CoherenceColumn, RecognisedResponse, ResponseParts, column_name, column_place,
};
use crate::formats::text::response_group::{GroupColumn, PolarColumns, ResponseGroup};
use crate::formats::text::text_table::TextTable;
use crate::formats::text::unrecognised::{UnitNotGiven, Unrecognised, unrecognised};
use crate::variable_fault::found_content::ResponseLack;

/// Maximum difference between a response's rectangular and polar forms, relative to the larger of
/// the two magnitudes; tables are printed with few digits.
const FORM_TOLERANCE: f64 = 0.01;
/// Maximum coherence that counts as a fraction; larger values are in percent. Values slightly above
/// 1 result from rounding and noise.
const LARGEST_COHERENCE: f64 = 1.5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrequencyColumn {
    /// Column index, from 0.
    pub(super) column: usize,
    /// Factor that converts to rad/s.
    pub(super) factor: f64,
}

/// State while the responses in a table are recognised.
pub(super) struct Recognition<'t> {
    table: &'t TextTable,
    meanings: Vec<ColumnMeaning>,
    /// Notes for the user: each choice with its reason.
    pub(super) notes: Vec<ReadingNote>,
    /// Columns whose unit the user must state.
    pub(super) missing_units: Vec<UnitNotGiven>,
    /// Unused columns by name; for example "column 5" for one without a name.
    pub(super) unused: Vec<String>,
}

impl<'t> Recognition<'t> {
    /// Interprets each column by its name and unit.
    pub(super) fn new(table: &'t TextTable) -> Self {
        Self {
            table,
            meanings: column_meanings(table),
            notes: Vec::new(),
            missing_units: Vec::new(),
            unused: Vec::new(),
        }
    }

    /// Finds the frequency column and its unit; unless the unit is rad/s or Hz, the column is added
    /// to `missing_units`, and the factor is 1.
    ///
    /// # Errors
    /// [`Unrecognised`] if there is no frequency column.
    pub(super) fn frequency(&mut self) -> Result<FrequencyColumn, Unrecognised> {
        let named = self
            .meanings
            .iter()
            .position(|meaning| meaning.quantity == Some(Quantity::Frequency));
        let Some(column) = named else {
            return Err(unrecognised(ResponseLack::Frequency));
        };
        let (factor, unit) = match self.meanings[column].unit {
            Some(KnownUnit::Hertz) => (TAU, "Hz"),
            Some(KnownUnit::RadianPerSecond) => (1.0, "rad/s"),
            _ => {
                self.missing_units.push(UnitNotGiven {
                    column,
                    units: ["rad/s", "Hz"],
                });
                return Ok(FrequencyColumn {
                    column,
                    factor: 1.0,
                });
            }
        };
        let reason = match self.table.units.get(column).and_then(Option::as_ref) {
            Some(unit) => UnitReason::Unit(unit.clone()),
            None => UnitReason::Implied,
        };
        self.note(column, ColumnReading::Frequency { unit }, reason);
        Ok(FrequencyColumn { column, factor })
    }

    /// Notes how a column is interpreted and for which reasons.
    fn note(&mut self, column: usize, reading: ColumnReading, unit: UnitReason) {
        self.notes.push(ReadingNote::ReadAs {
            place: column_place(self.table, column),
            reading,
            quantity: self.meanings[column].reason.clone(),
            unit,
        });
    }

    /// Returns the responses in the order of their first columns.
    ///
    /// 1. Group the columns by response; columns without a known quantity are unused.
    /// 2. In each group, note a column with standard deviations as unused.
    /// 3. Find the two columns with the complex number; a group without them is unused, with a
    ///    note.
    /// 4. Read the coherence, if a column holds it.
    pub(super) fn responses(&mut self) -> Vec<RecognisedResponse> {
        let mut responses = Vec::new();
        // Step 1
        for group in self.groups() {
            // Step 2
            if let Some(column) = group.column(Quantity::Error) {
                self.note(
                    column,
                    ColumnReading::StandardDeviation,
                    UnitReason::NotNeeded,
                );
                self.unused.push(column_name(self.table, column));
            }
            // Step 3
            let Some(parts) = self.parts(&group) else {
                self.note_incomplete(&group);
                continue;
            };
            // Step 4
            let mut coherence = None;
            if let Some(column) = group.column(Quantity::Coherence) {
                coherence = Some(self.read_coherence(column));
            }
            responses.push(RecognisedResponse {
                output: group.label.output,
                input: group.label.input,
                parts,
                coherence,
            });
        }
        responses
    }

    /// Returns the columns that give a group's complex numbers; real and imaginary parts are
    /// preferred to magnitude and phase, which then serve as a check. Returns `None` if a part is
    /// missing.
    fn parts(&mut self, group: &ResponseGroup) -> Option<ResponseParts> {
        let polar_columns = group.polar_columns();
        if let Some(re) = group.column(Quantity::Real)
            && let Some(im) = group.column(Quantity::Imaginary)
        {
            let parts = ResponseParts::Rectangular { re, im };
            self.note(re, ColumnReading::Real, UnitReason::NotNeeded);
            self.note(im, ColumnReading::Imaginary, UnitReason::NotNeeded);
            if let Some(polar_columns) = polar_columns {
                let polar = self.read_polar(polar_columns);
                // Do not ask for missing units: they are needed only for the check.
                if polar.missing_units.is_empty() {
                    self.note_agreement(parts, polar.parts);
                }
            }
            return Some(parts);
        }
        let polar = self.read_polar(polar_columns?);
        self.missing_units.extend(polar.missing_units);
        Some(polar.parts)
    }

    /// Notes that a group's columns are not used because one part of the complex number is missing.
    fn note_incomplete(&mut self, group: &ResponseGroup) {
        for member in &group.columns {
            // A column with standard deviations has already been noted.
            if member.quantity == Quantity::Error {
                continue;
            }
            let place = column_place(self.table, member.column);
            self.notes.push(ReadingNote::HalfResponse { place });
            self.unused.push(column_name(self.table, member.column));
        }
    }

    /// Interprets a coherence column. It is in percent if its unit is % or a number exceeds
    /// `LARGEST_COHERENCE`. If its unit is missing (a column called gamma), the user is asked
    /// whether it holds γ or γ².
    fn read_coherence(&mut self, column: usize) -> CoherenceColumn {
        let unit = self.meanings[column].unit;
        if unit.is_none() {
            self.missing_units.push(UnitNotGiven {
                column,
                units: ["gamma2", "gamma"],
            });
        }
        let mut factor = 1.0;
        let mut reading = ColumnReading::Coherence;
        let mut reason = UnitReason::NotNeeded;
        let numbers = &self.table.columns[column];
        if unit == Some(KnownUnit::Percent) {
            factor = 0.01;
            reading = ColumnReading::CoherenceInPercent;
            reason = UnitReason::Unit("%".to_owned());
        } else if numbers.iter().any(|value| *value > LARGEST_COHERENCE) {
            factor = 0.01;
            reading = ColumnReading::CoherenceInPercent;
            reason = UnitReason::NumbersAboveOne;
        }
        let is_gamma = unit == Some(KnownUnit::Gamma);
        if is_gamma {
            reason = UnitReason::NotSquared;
        }
        self.note(column, reading, reason);
        CoherenceColumn {
            column,
            factor,
            is_gamma,
        }
    }

    /// Groups the columns by response, and notes columns whose meaning is unknown.
    fn groups(&mut self) -> Vec<ResponseGroup> {
        let mut groups: Vec<ResponseGroup> = Vec::new();
        for (column, meaning) in self.meanings.iter().enumerate() {
            let Some(quantity) = meaning.quantity else {
                let place = column_place(self.table, column);
                self.notes.push(ReadingNote::UnknownName { place });
                self.unused.push(column_name(self.table, column));
                continue;
            };
            if quantity == Quantity::Frequency {
                continue;
            }
            let member = GroupColumn { quantity, column };
            ResponseGroup::add_column(&mut groups, member, &meaning.label);
        }
        groups
    }

    /// Interprets a magnitude and a phase column.
    ///
    /// - Magnitude: in dB or a ratio by its unit; without a unit, in dB if it has negative levels,
    ///   else the user is asked.
    /// - Phase: in degrees or radians by its unit; else the user is asked.
    ///
    /// The interpretation is noted only if both units are known.
    fn read_polar(&mut self, columns: PolarColumns) -> PolarReading {
        let PolarColumns { magnitude, phase } = columns;
        let mut missing_units = Vec::new();
        let mut in_db = false;
        let mut reason = UnitReason::NotNeeded;
        match self.meanings[magnitude].unit {
            Some(KnownUnit::Decibel) => {
                in_db = true;
                reason = UnitReason::Unit("dB".to_owned());
            }
            Some(_) => reason = UnitReason::NotDecibel,
            None if self.has_negative_levels(magnitude) => {
                in_db = true;
                reason = UnitReason::NegativeNumbers;
            }
            None => missing_units.push(UnitNotGiven {
                column: magnitude,
                units: ["dB", "abs"],
            }),
        }
        let mut in_degrees = false;
        match self.meanings[phase].unit {
            Some(KnownUnit::Degree) => in_degrees = true,
            Some(KnownUnit::Radian) => {}
            _ => missing_units.push(UnitNotGiven {
                column: phase,
                units: ["deg", "rad"],
            }),
        }
        if missing_units.is_empty() {
            let reading = if in_db {
                ColumnReading::MagnitudeInDb
            } else {
                ColumnReading::AbsoluteMagnitude
            };
            self.note(magnitude, reading, reason);
            let unit = if in_degrees { "deg" } else { "rad" };
            self.note(
                phase,
                ColumnReading::Phase { unit },
                UnitReason::Unit(unit.to_owned()),
            );
        }
        PolarReading {
            parts: ResponseParts::Polar {
                magnitude,
                in_db,
                phase,
                in_degrees,
            },
            missing_units,
        }
    }

    /// Returns whether negative numbers show that a magnitude is in dB. Returns false for a column
    /// called gain, in which negative numbers may also be signed ratios.
    fn has_negative_levels(&self, magnitude: usize) -> bool {
        let name = self.table.name(magnitude).unwrap_or_default();
        let is_gain = name.to_lowercase().contains("gain");
        !is_gain
            && self.table.columns[magnitude]
                .iter()
                .any(|&value| value < 0.0)
    }

    /// Notes whether a response's rectangular and polar forms agree within `FORM_TOLERANCE`.
    fn note_agreement(&mut self, rectangular: ResponseParts, polar: ResponseParts) {
        let table = self.table;
        let differing = (0..table.lines.len()).find(|&row| {
            let (re, im) = rectangular.complex(table, row);
            let (polar_re, polar_im) = polar.complex(table, row);
            let difference = (re - polar_re).hypot(im - polar_im);
            difference > FORM_TOLERANCE * re.hypot(im).max(polar_re.hypot(polar_im))
        });
        let [magnitude, phase] = polar.columns();
        let magnitude = magnitude + 1;
        let phase = phase + 1;
        self.notes.push(match differing {
            None => ReadingNote::FormsAgree { magnitude, phase },
            Some(row) => ReadingNote::FormsDiffer {
                magnitude,
                phase,
                line: table.lines[row],
            },
        });
    }
}

/// Interpretation of a magnitude and a phase column.
struct PolarReading {
    parts: ResponseParts,
    /// Columns among these two whose unit the user must state.
    missing_units: Vec<UnitNotGiven>,
}

fn column_meanings(table: &TextTable) -> Vec<ColumnMeaning> {
    let mut meanings = Vec::with_capacity(table.columns.len());
    for column in 0..table.columns.len() {
        let name = table.name(column).unwrap_or_default();
        let unit = table.units.get(column).and_then(Option::as_deref);
        meanings.push(ColumnMeaning::interpret(name, unit));
    }
    meanings
}
