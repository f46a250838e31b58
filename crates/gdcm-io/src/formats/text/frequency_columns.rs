//! Frequency responses in a table, recognised by column names and units.

use std::f64::consts::TAU;

use crate::formats::text::column_meaning::{ColumnMeaning, KnownUnit, Quantity};
use crate::formats::text::columns::TextTable;
use crate::formats::text::response_columns::{
    CoherenceColumn, RecognisedResponse, ResponseParts, ResponsePoints, column_name, column_place,
};
use crate::formats::text::response_label::ResponseLabel;
use crate::reading_budget::VariableFault;

/// Largest difference between the rectangular and the polar form of a response, relative to its
/// magnitude: tables have few digits.
const FORM_TOLERANCE: f64 = 0.01;
/// Coherence above this value is in percent; the margin above 1 is for rounding and noise.
const LARGEST_COHERENCE: f64 = 1.5;

/// Meaning of the columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrequencyColumns {
    frequency: FrequencyColumn,
    /// The responses, in column order.
    pub(crate) responses: Vec<RecognisedResponse>,
    /// Each decision with its reason.
    pub(crate) notes: Vec<String>,
    /// Names of the unused columns, or their numbers if they have no name.
    pub(crate) unused: Vec<String>,
}

/// The frequency column.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FrequencyColumn {
    /// The column, from 0.
    column: usize,
    /// Factor to rad/s.
    factor: f64,
}

/// A column without a unit whose numbers allow two units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnsaidUnit {
    /// The column, from 0.
    pub column: usize,
    /// The possible units, as written in a heading.
    pub units: [&'static str; 2],
}

/// Reason why a table is not a frequency response, and the missing units that would complete it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unrecognised {
    pub(crate) fault: VariableFault,
    pub(crate) unsaid: Vec<UnsaidUnit>,
}

impl FrequencyColumns {
    /// Recognises the columns by their names and units; ambiguities become questions.
    pub(crate) fn recognise(table: &TextTable) -> Result<Self, Unrecognised> {
        let meanings = column_meanings(table);
        let mut recognition = Recognition {
            table,
            meanings: &meanings,
            notes: Vec::new(),
            unsaid: Vec::new(),
            unused: Vec::new(),
        };
        let frequency = recognition.frequency()?;
        let responses = recognition.responses();
        if !recognition.unsaid.is_empty() {
            return Err(units_missing(table, recognition.unsaid));
        }
        if responses.is_empty() {
            return Err(unrecognised(
                "no magnitude with a phase and no real part with an imaginary part",
            ));
        }
        let mut columns = Self {
            frequency,
            responses,
            notes: recognition.notes,
            unused: recognition.unused,
        };
        if columns.is_decreasing(table) {
            let note = "the frequencies fall: taken from the last line to the first";
            columns.notes.push(note.to_owned());
        }
        Ok(columns)
    }

    /// Returns the points of every response, in rad/s and as complex numbers.
    ///
    /// Decreasing frequencies are reversed. A frequency that is missing, negative, or not above the
    /// frequency before it is refused with its line, and so is half a complex number.
    pub(crate) fn values(&self, table: &TextTable) -> Result<Vec<ResponsePoints>, VariableFault> {
        if self.is_decreasing(table) {
            self.increasing_values(&reversed(table))
        } else {
            self.increasing_values(table)
        }
    }

    /// Whether the frequencies decrease strictly.
    fn is_decreasing(&self, table: &TextTable) -> bool {
        let frequencies = &table.columns[self.frequency.column];
        frequencies.len() > 1 && frequencies.is_sorted_by(|above, below| above > below)
    }

    fn increasing_values(&self, table: &TextTable) -> Result<Vec<ResponsePoints>, VariableFault> {
        let omega = self.omega(table)?;
        self.responses
            .iter()
            .map(|response| response.points(table, &omega))
            .collect()
    }

    /// Returns the frequencies \[rad/s\], which must increase strictly.
    fn omega(&self, table: &TextTable) -> Result<Vec<f64>, VariableFault> {
        let FrequencyColumn { column, factor } = self.frequency;
        let frequencies = &table.columns[column];
        let mut before = f64::NEG_INFINITY;
        for (&value, &line) in frequencies.iter().zip(&table.lines) {
            if let Some(fault) = frequency_fault(value, before) {
                let place = column_place(table, column);
                let what = format!("the frequency in {place} {fault}");
                return Err(VariableFault::line("", line, what));
            }
            before = value;
        }
        Ok(frequencies.iter().map(|value| factor * value).collect())
    }
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

/// Returns a table with its rows in reverse order.
fn reversed(table: &TextTable) -> TextTable {
    let mut table = table.clone();
    for column in &mut table.columns {
        column.reverse();
    }
    table.lines.reverse();
    table
}

/// Describes the fault of a frequency that follows `before`.
fn frequency_fault(value: f64, before: f64) -> Option<String> {
    if !value.is_finite() {
        Some("is missing or infinite; complete it or take the line out".to_owned())
    } else if value < 0.0 {
        Some(format!("is negative ({value}); take the line out"))
    } else if value == before {
        Some(format!(
            "occurs on two lines ({value}); take one of the lines out"
        ))
    } else if value < before {
        Some(format!(
            "is below the frequency before it ({value} after {before}); sort the lines by frequency"
        ))
    } else {
        None
    }
}

/// Returns the reason why there is no frequency response, with a remedy.
fn unrecognised(found: &str) -> Unrecognised {
    let found = format!(
        "a table with {found} among its columns; name the content of each column in the first line, by --headings, or under \
         \"headings\" in the rules: \"omega [rad/s]\", \"mag Q/LON [dB]\", \"phase Q/LON [deg]\""
    );
    Unrecognised {
        fault: VariableFault::format("a frequency response in columns", found),
        unsaid: Vec::new(),
    }
}

/// Asks for units that are neither given nor evident.
fn units_missing(table: &TextTable, unsaid: Vec<UnsaidUnit>) -> Unrecognised {
    let mut questions = Vec::with_capacity(unsaid.len());
    for UnsaidUnit { column, units } in &unsaid {
        let place = column_place(table, *column);
        questions.push(format!("{place} (write [{}] or [{}])", units[0], units[1]));
    }
    let Unrecognised { fault, .. } =
        unrecognised(&format!("no unit of {}", questions.join(", of ")));
    Unrecognised { fault, unsaid }
}

/// A table during the assembly of its responses.
struct Recognition<'t> {
    table: &'t TextTable,
    meanings: &'t [ColumnMeaning],
    notes: Vec<String>,
    /// Columns without a unit whose numbers allow several.
    unsaid: Vec<UnsaidUnit>,
    /// Names of the unused columns.
    unused: Vec<String>,
}

/// Columns that belong to one response.
#[derive(Default)]
struct Group {
    label: ResponseLabel,
    columns: Vec<GroupColumn>,
}

struct GroupColumn {
    quantity: Quantity,
    column: usize,
}

/// Columns of a response in polar form.
#[derive(Clone, Copy)]
struct PolarColumns {
    magnitude: usize,
    phase: usize,
}

/// Interpretation of a magnitude and a phase.
struct PolarReading {
    parts: ResponseParts,
    /// Columns whose units are neither given nor evident.
    unsaid: Vec<UnsaidUnit>,
}

impl Group {
    fn column(&self, quantity: Quantity) -> Option<usize> {
        let found = self.columns.iter().find(|known| known.quantity == quantity);
        found.map(|known| known.column)
    }

    fn polar(&self) -> Option<PolarColumns> {
        Some(PolarColumns {
            magnitude: self.column(Quantity::Magnitude)?,
            phase: self.column(Quantity::Phase)?,
        })
    }
}

impl Recognition<'_> {
    /// Finds the frequency column and its unit.
    fn frequency(&mut self) -> Result<FrequencyColumn, Unrecognised> {
        let named = self
            .meanings
            .iter()
            .position(|meaning| meaning.quantity == Some(Quantity::Frequency));
        let Some(column) = named else {
            return Err(unrecognised("no frequency"));
        };
        let (factor, unit) = match self.meanings[column].unit {
            Some(KnownUnit::Hertz) => (TAU, "Hz"),
            Some(KnownUnit::RadianPerSecond) => (1.0, "rad/s"),
            _ => {
                self.unsaid.push(UnsaidUnit {
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
            Some(unit) => format!(", its unit says {unit}"),
            None => ", and with it the unit".to_owned(),
        };
        self.note(column, &format!("the frequency in {unit}"), &reason);
        Ok(FrequencyColumn { column, factor })
    }

    /// Notes the interpretation of a column and its reason; `more` is added to the reason.
    fn note(&mut self, column: usize, interpretation: &str, more: &str) {
        let place = column_place(self.table, column);
        let reason = &self.meanings[column].reason;
        self.notes.push(format!(
            "{place} is read as {interpretation}: {reason}{more}"
        ));
    }

    /// Returns the responses, in the order of their first columns.
    fn responses(&mut self) -> Vec<RecognisedResponse> {
        let mut responses = Vec::new();
        for group in self.groups() {
            if let Some(column) = group.column(Quantity::Error) {
                self.note(column, "a standard deviation, which is not used", "");
                self.unused.push(column_name(self.table, column));
            }
            let Some(parts) = self.parts(&group) else {
                self.leave_out(&group);
                continue;
            };
            let coherence = group
                .column(Quantity::Coherence)
                .map(|column| self.coherence(column));
            responses.push(RecognisedResponse {
                output: group.label.output,
                input: group.label.input,
                parts,
                coherence,
            });
        }
        responses
    }

    /// Finds the columns of the complex numbers; real and imaginary parts go before magnitude and
    /// phase.
    fn parts(&mut self, group: &Group) -> Option<ResponseParts> {
        let re = group.column(Quantity::Real);
        let im = group.column(Quantity::Imaginary);
        let polar = group.polar();
        if let (Some(re), Some(im)) = (re, im) {
            let parts = ResponseParts::Rectangular { re, im };
            self.note(re, "real part", "");
            self.note(im, "imaginary part", "");
            if let Some(columns) = polar {
                let polar = self.polar(columns);
                // Missing units of the second form are not asked for.
                if polar.unsaid.is_empty() {
                    self.compare(parts, polar.parts);
                }
            }
            return Some(parts);
        }
        let polar = self.polar(polar?);
        self.unsaid.extend(polar.unsaid);
        Some(polar.parts)
    }

    /// Notes that the columns of a group are unused because half of the response is missing.
    fn leave_out(&mut self, group: &Group) {
        for known in &group.columns {
            if known.quantity == Quantity::Error {
                continue;
            }
            let place = column_place(self.table, known.column);
            self.notes
                .push(format!("{place} is left out: its other half is missing"));
            self.unused.push(column_name(self.table, known.column));
        }
    }

    /// Interprets a coherence column: percent if its unit or its numbers above 1 require it. For a
    /// column called gamma, γ or γ² is a question to the user.
    fn coherence(&mut self, column: usize) -> CoherenceColumn {
        let unit = self.meanings[column].unit;
        if unit.is_none() {
            self.unsaid.push(UnsaidUnit {
                column,
                units: ["gamma2", "gamma"],
            });
        }
        let mut factor = 1.0;
        let mut interpretation = "coherence";
        let mut reason = "";
        let numbers = &self.table.columns[column];
        if unit == Some(KnownUnit::Percent) {
            factor = 0.01;
            interpretation = "coherence in percent";
            reason = ", its unit says %";
        } else if numbers.iter().any(|value| *value > LARGEST_COHERENCE) {
            factor = 0.01;
            interpretation = "coherence in percent";
            reason = ", some of its numbers are above 1";
        }
        let is_gamma = unit == Some(KnownUnit::Gamma);
        if is_gamma {
            reason = ", its unit says γ: squared";
        }
        self.note(column, interpretation, reason);
        CoherenceColumn {
            column,
            factor,
            is_gamma,
        }
    }

    /// Collects the columns of each response, and notes columns of unknown meaning.
    fn groups(&mut self) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::new();
        for (column, meaning) in self.meanings.iter().enumerate() {
            let Some(quantity) = meaning.quantity else {
                let place = column_place(self.table, column);
                self.notes
                    .push(format!("{place} is left out: its name is not known"));
                self.unused.push(column_name(self.table, column));
                continue;
            };
            if quantity == Quantity::Frequency {
                continue;
            }
            let member = GroupColumn { quantity, column };
            match group_for(&groups, quantity, &meaning.label) {
                Some(index) => groups[index].columns.push(member),
                None => groups.push(Group {
                    label: meaning.label.clone(),
                    columns: vec![member],
                }),
            }
        }
        groups
    }

    /// Interprets a magnitude and a phase.
    fn polar(&mut self, columns: PolarColumns) -> PolarReading {
        let PolarColumns { magnitude, phase } = columns;
        let mut unsaid = Vec::new();
        let mut in_db = false;
        let mut reason = "";
        match self.meanings[magnitude].unit {
            Some(KnownUnit::Decibel) => {
                in_db = true;
                reason = "its unit says dB";
            }
            Some(_) => reason = "its unit is not dB",
            None if self.has_negative_levels(magnitude) => {
                in_db = true;
                reason = "some of its numbers are negative";
            }
            None => unsaid.push(UnsaidUnit {
                column: magnitude,
                units: ["dB", "abs"],
            }),
        }
        let mut in_degrees = false;
        match self.meanings[phase].unit {
            Some(KnownUnit::Degree) => in_degrees = true,
            Some(KnownUnit::Radian) => {}
            _ => unsaid.push(UnsaidUnit {
                column: phase,
                units: ["deg", "rad"],
            }),
        }
        if unsaid.is_empty() {
            let interpretation = if in_db {
                "magnitude in dB"
            } else {
                "absolute magnitude"
            };
            self.note(magnitude, interpretation, &format!(", {reason}"));
            let unit = if in_degrees { "deg" } else { "rad" };
            self.note(
                phase,
                &format!("phase in {unit}"),
                &format!(", its unit says {unit}"),
            );
        }
        PolarReading {
            parts: ResponseParts::Polar {
                magnitude,
                in_db,
                phase,
                in_degrees,
            },
            unsaid,
        }
    }

    /// Whether negative numbers show that a magnitude is in dB. A gain may be a level in dB, or a
    /// signed ratio.
    fn has_negative_levels(&self, magnitude: usize) -> bool {
        let name = self.table.name(magnitude).unwrap_or_default();
        let is_gain = name.to_lowercase().contains("gain");
        !is_gain
            && self.table.columns[magnitude]
                .iter()
                .any(|&value| value < 0.0)
    }

    /// Notes whether the two forms of a response agree.
    fn compare(&mut self, rectangular: ResponseParts, polar: ResponseParts) {
        let table = self.table;
        let differing = (0..table.lines.len()).find(|&row| {
            let (re, im) = rectangular.complex(table, row);
            let (polar_re, polar_im) = polar.complex(table, row);
            let difference = (re - polar_re).hypot(im - polar_im);
            difference > FORM_TOLERANCE * re.hypot(im).max(polar_re.hypot(polar_im))
        });
        let [magnitude, phase] = polar.columns();
        let columns = format!(
            "magnitude and phase in columns {} and {}",
            magnitude + 1,
            phase + 1
        );
        let taken = "the real and imaginary parts, which are taken";
        self.notes.push(match differing {
            None => format!("{columns} agree with {taken}"),
            Some(row) => format!("{columns} differ from {taken} (line {})", table.lines[row]),
        });
    }
}

/// Returns the group to which a column belongs: the last group for a column without a label, else
/// the last group with the same label; only groups that lack the quantity are considered.
fn group_for(groups: &[Group], quantity: Quantity, label: &ResponseLabel) -> Option<usize> {
    // The other words in an error's name give the quantity in error.
    let joins_last = *label == ResponseLabel::default() || quantity == Quantity::Error;
    if joins_last
        && let Some(last) = groups.last()
        && last.column(quantity).is_none()
    {
        return Some(groups.len() - 1);
    }
    groups
        .iter()
        .rposition(|group| group.label == *label && group.column(quantity).is_none())
}

#[cfg(test)]
mod frequency_columns_tests {
    use super::*;
    use crate::formats::text::columns::read_table;
    use crate::reading_budget::ReadingBudget;

    fn recognise(text: &str) -> FrequencyColumns {
        let table = read_table(text, &ReadingBudget::new(1 << 20)).unwrap();
        FrequencyColumns::recognise(&table).unwrap()
    }

    fn fault(text: &str) -> String {
        let table = read_table(text, &ReadingBudget::new(1 << 20)).unwrap();
        FrequencyColumns::recognise(&table)
            .unwrap_err()
            .fault
            .to_string()
    }

    /// γ² in this column, as a fraction of 1.
    fn squared(column: usize) -> Option<CoherenceColumn> {
        Some(CoherenceColumn {
            column,
            factor: 1.0,
            is_gamma: false,
        })
    }

    fn asked(text: &str) -> Vec<UnsaidUnit> {
        let table = read_table(text, &ReadingBudget::new(1 << 20)).unwrap();
        FrequencyColumns::recognise(&table).unwrap_err().unsaid
    }

    /// The first column as the frequency.
    fn frequency(factor: f64) -> FrequencyColumn {
        FrequencyColumn { column: 0, factor }
    }

    const POLAR: ResponseParts = ResponseParts::Polar {
        magnitude: 1,
        in_db: true,
        phase: 2,
        in_degrees: true,
    };

    #[test]
    fn names_and_units_identify_a_response() {
        let found = recognise(
            "omega [rad/s],mag P/LAT [dB],phase P/LAT [deg],coh P/LAT\n1,0,-90,1\n2,-6,-100,.9\n",
        );
        assert_eq!(found.frequency, frequency(1.0));
        let [response] = found.responses.as_slice() else {
            panic!("one response")
        };
        assert_eq!(
            (response.output.as_deref(), response.input.as_deref()),
            (Some("P"), Some("LAT"))
        );
        assert_eq!((response.parts, response.coherence), (POLAR, squared(3)));
        assert_eq!(
            found.notes[0],
            "column 1 (\"omega\") is read as the frequency in rad/s: its name says omega, its unit says rad/s"
        );
        assert_eq!(
            found.notes[1],
            "column 2 (\"mag P/LAT\") is read as magnitude in dB: its name says mag, its unit says dB"
        );
    }

    #[test]
    fn several_responses_are_side_by_side() {
        let found =
            recognise("f_Hz,P/LAT re,P/LAT im,re(PED->R),im(PED->R)\n1,2,3,4,5\n2,3,4,5,6\n");
        assert_eq!(found.frequency, frequency(TAU));
        let names: Vec<_> = found
            .responses
            .iter()
            .map(|r| (r.output.as_deref(), r.input.as_deref()))
            .collect();
        assert_eq!(names, [(Some("P"), Some("LAT")), (Some("R"), Some("PED"))]);
        assert_eq!(
            found.responses[1].parts,
            ResponseParts::Rectangular { re: 3, im: 4 }
        );
    }

    #[test]
    fn columns_of_cifer_are_read() {
        let text = "FREQUENCY(RAD/S) MAGNITUDE(DB) PHASE(DEG) COHERENCE ERROR REAL IMAG\n 1 0 -90 .9 .1 0 -1\n 2 0 180 .9 .1 -1 0\n";
        let found = recognise(text);
        assert_eq!(
            found.responses[0].parts,
            ResponseParts::Rectangular { re: 5, im: 6 }
        );
        assert_eq!(found.responses[0].coherence, squared(3));
        assert!(
            found
                .notes
                .iter()
                .any(|note| note.contains("magnitude and phase in columns 2 and 3 agree"))
        );
    }

    #[test]
    fn a_bare_f_rps_a_gain_and_gamma_are_asked_for_and_answered_by_a_unit() {
        let question = |column, units| vec![UnsaidUnit { column, units }];
        assert_eq!(
            asked("f,re,im\n1,1,2\n2,3,4\n"),
            question(0, ["rad/s", "Hz"])
        );
        assert_eq!(
            asked("freq_rps,re,im\n1,1,2\n2,3,4\n"),
            question(0, ["rad/s", "Hz"])
        );
        assert_eq!(
            asked("w,gain,phase_deg\n1,-3,-90\n2,-6,-100\n"),
            question(1, ["dB", "abs"])
        );
        assert_eq!(
            asked("w,re,im,gamma\n1,1,2,0.9\n2,3,4,0.8\n"),
            question(3, ["gamma2", "gamma"])
        );
        let coherence = |unit: &str| {
            let text = format!("w,re,im,gamma [{unit}]\n1,1,2,0.9\n2,3,4,0.8\n");
            let table = read_table(&text, &ReadingBudget::new(1 << 20)).unwrap();
            let found = FrequencyColumns::recognise(&table).unwrap();
            found.values(&table).unwrap().remove(0).coherence.unwrap()
        };
        assert_eq!(coherence("gamma2"), [0.9, 0.8]);
        assert_eq!(coherence("gamma"), [0.9 * 0.9, 0.8 * 0.8]);
    }

    #[test]
    fn standard_deviations_are_unused_and_listed() {
        let found = recognise(
            "w,mag_abs,phase_deg,COHER,sd_mag_dB,sd_phase_deg,torque\n1,0.5,-90,0.9,0.1,1,7\n2,0.4,-99,0.8,0.1,1,8\n",
        );
        let parts = ResponseParts::Polar {
            magnitude: 1,
            in_db: false,
            phase: 2,
            in_degrees: true,
        };
        let [response] = found.responses.as_slice() else {
            panic!("one response")
        };
        assert_eq!((response.parts, response.coherence), (parts, squared(3)));
        let mut unused = found.unused;
        unused.sort();
        assert_eq!(unused, ["sd_mag_dB", "sd_phase_deg", "torque"]);
    }

    #[test]
    fn differing_forms_are_noted() {
        let found = recognise("w,mag_db,phase_deg,re,im\n1,0,-90,0,1\n2,0,-90,0,1\n");
        assert!(found.notes.iter().any(|note| note.contains("differ")));
    }

    #[test]
    fn missing_units_are_asked_for() {
        let found = recognise("omega,mag,phase [deg]\n1,3,-90\n2,-6,-100\n");
        assert_eq!(found.responses[0].parts, POLAR, "no magnitude is negative");
        let size = fault("omega,mag,phase [deg]\n1,3,-90\n2,0.5,-100\n");
        assert!(
            size.contains("no unit of column 2 (\"mag\") (write [dB] or [abs])"),
            "{size}"
        );
        let angle = fault("omega,mag [dB],phase\n1,3,-1\n2,0.5,-2\n");
        assert!(
            angle.contains("no unit of column 3 (\"phase\") (write [deg] or [rad])"),
            "{angle}"
        );
        let absolute = recognise("omega,mag [abs],phase [rad]\n1,3,-1\n2,0.5,-2\n");
        let expected = ResponseParts::Polar {
            magnitude: 1,
            in_db: false,
            phase: 2,
            in_degrees: false,
        };
        assert_eq!(absolute.responses[0].parts, expected);
        let all = fault("Frequency,Gain,Phase\n0.5,5.8,-42.7\n0.6,9.8,-24.8\n");
        for unit in [
            "[rad/s] or [Hz]",
            "[dB] or [abs]",
            "[deg] or [rad]",
            "--headings",
        ] {
            assert!(all.contains(unit), "{all}");
        }
        let table = read_table(
            "Frequency,Gain,Phase\n0.5,5.8,-42.7\n0.6,9.8,-24.8\n",
            &ReadingBudget::new(1 << 20),
        )
        .unwrap();
        let unsaid = FrequencyColumns::recognise(&table).unwrap_err().unsaid;
        assert_eq!(
            unsaid.iter().map(|of| of.column).collect::<Vec<_>>(),
            [0, 1, 2]
        );
        let nothing = fault("0.3,10,-90\n1,5,-100\n2,1,-120\n");
        assert!(
            nothing.contains("no frequency") && nothing.contains("headings"),
            "{nothing}"
        );
    }

    #[test]
    fn half_a_response_is_noted_and_none_is_refused() {
        let found = recognise("w,re,im,mag X/Y\n1,2,3,1\n2,3,4,1\n");
        assert_eq!(found.responses.len(), 1);
        assert!(
            found
                .notes
                .iter()
                .any(|note| note.contains("column 4 (\"mag X/Y\") is left out"))
        );
        assert!(fault("w,mag\n1,2\n2,3\n").contains("no magnitude with a phase"));
        assert!(fault("mag,phase\n1,2\n2,1\n").contains("no frequency"));
    }
}

#[cfg(test)]
mod frequency_values_tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::text::columns::read_table;
    use crate::reading_budget::ReadingBudget;

    fn values(text: &str) -> Result<Vec<ResponsePoints>, VariableFault> {
        let table = read_table(text, &ReadingBudget::new(1 << 20)).unwrap();
        FrequencyColumns::recognise(&table).unwrap().values(&table)
    }

    #[test]
    fn hertz_decibels_and_degrees_become_complex_numbers_over_radians_per_second() {
        let points = values("f [Hz],mag [dB],phase [deg],coh\n1,20,-90,0.5\n2,0,180,1\n")
            .unwrap()
            .remove(0);
        assert_eq!(
            points.omega,
            [std::f64::consts::TAU, 2.0 * std::f64::consts::TAU]
        );
        assert!((points.im[0] + 10.0).abs() < 1e-14 && points.re[0].abs() < 1e-14);
        assert!((points.re[1] + 1.0).abs() < 1e-14);
        assert_eq!(points.coherence.unwrap(), [0.5, 1.0]);
    }

    #[test]
    fn frequencies_out_of_order_are_refused_with_their_line() {
        let message = |frequencies: [&str; 3]| {
            let rows: String = frequencies
                .iter()
                .map(|omega| format!("{omega},1,2\n"))
                .collect();
            values(&format!("omega,re,im\n{rows}"))
                .unwrap_err()
                .to_string()
        };
        let start = "the frequency in column 1 (\"omega\")";
        assert_eq!(
            message(["1", "2", "2"]),
            format!("line 4: {start} occurs on two lines (2); take one of the lines out")
        );
        assert!(message(["1", "3", "2"]).starts_with(&format!(
            "line 4: {start} is below the frequency before it (2 after 3)"
        )));
        assert!(message(["1", "", "2"]).starts_with(&format!("line 3: {start} is missing")));
        assert!(message(["-1", "1", "2"]).starts_with(&format!("line 2: {start} is negative")));
    }

    #[test]
    fn decreasing_frequencies_are_reversed() {
        let points = values("omega [rad/s],re,im\n3,1,2\n2,3,4\n1,5,6\n")
            .unwrap()
            .remove(0);
        assert_eq!(
            (points.omega, points.re, points.im),
            (
                vec![1.0, 2.0, 3.0],
                vec![5.0, 3.0, 1.0],
                vec![6.0, 4.0, 2.0]
            )
        );
    }

    #[test]
    fn coherence_in_percent_becomes_a_fraction() {
        for text in [
            "w,re,im,coh [%]\n1,1,2,97\n2,3,4,1\n",
            "w,re,im,coh\n1,1,2,97\n2,3,4,1\n",
        ] {
            let coherence = values(text).unwrap().remove(0).coherence.unwrap();
            assert!(
                coherence
                    .iter()
                    .zip([0.97, 0.01])
                    .all(|(a, b)| (a - b).abs() < 1e-12),
                "{coherence:?}"
            );
        }
    }

    #[test]
    fn a_response_may_miss_rows_but_not_half_a_number() {
        let points = values("omega,re a,im a,re b,im b\n1,1,2,,\n2,1,2,3,4\n").unwrap();
        assert_eq!(
            (points[0].omega.as_slice(), points[1].omega.as_slice()),
            (&[1.0, 2.0][..], &[2.0][..])
        );
        let half = values("omega,re,im\n1,1,2\n2,1,\n")
            .unwrap_err()
            .to_string();
        assert!(
            half.starts_with("line 3: column 3 (\"im\") has no finite number"),
            "{half}"
        );
    }

    proptest! {
        #[test]
        fn rectangular_numbers_come_back_to_the_last_digit(numbers in prop::collection::vec((-1e9..1e9, -1e9..1e9), 2..20)) {
            let rows: String =
                numbers.iter().enumerate().map(|(row, (re, im))| format!("{};{re:e};{im:e}\n", row + 1)).collect();
            let points = values(&format!("w;Re;Im\n{rows}")).unwrap().remove(0);
            let back: Vec<(f64, f64)> = points.re.iter().copied().zip(points.im.iter().copied()).collect();
            prop_assert_eq!(back, numbers);
        }
    }
}
