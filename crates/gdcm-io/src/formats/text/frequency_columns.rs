//! Frequency responses among the columns of a table, recognised by column names and units.

use std::f64::consts::TAU;

use crate::formats::text::column_meaning::{ColumnMeaning, KnownUnit, Quantity, ResponseLabel};
use crate::formats::text::columns::TextTable;
use crate::reading_budget::VariableFault;

/// Meaning of the columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrequencyColumns {
    /// The column of frequencies, and its factor to rad/s.
    frequency: (usize, f64),
    /// The responses, in column order.
    pub(crate) responses: Vec<RecognisedResponse>,
    /// Each decision and its reason, in words.
    pub(crate) notes: Vec<String>,
    /// Names of the unused columns, or their numbers if they have no name.
    pub(crate) unused: Vec<String>,
}

/// A frequency response among the columns of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RecognisedResponse {
    /// The output, if the names give it.
    pub(crate) output: Option<String>,
    /// The input, if the names give it.
    pub(crate) input: Option<String>,
    parts: ResponseParts,
    pub(crate) coherence: Option<CoherenceColumn>,
}

/// A column of coherence; multiplication by the factor, then squaring for γ, gives γ² as a fraction
/// of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CoherenceColumn {
    /// The column, from 0.
    column: usize,
    factor: f64,
    is_gamma: bool,
}

impl CoherenceColumn {
    fn squared(self, value: f64) -> f64 {
        let part = self.factor * value;
        if self.is_gamma { part * part } else { part }
    }
}

/// The two columns, counted from 0, of a complex number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ResponseParts {
    Polar {
        magnitude: usize,
        in_db: bool,
        phase: usize,
        in_degrees: bool,
    },
    Rectangular {
        re: usize,
        im: usize,
    },
}

/// A frequency response, point by point.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ResponsePoints {
    /// Frequencies \[rad/s\], strictly increasing.
    pub(crate) omega: Vec<f64>,
    /// Real parts.
    pub(crate) re: Vec<f64>,
    /// Imaginary parts.
    pub(crate) im: Vec<f64>,
    /// Coherence as a fraction of 1, NaN where it is missing.
    pub(crate) coherence: Option<Vec<f64>>,
}

/// A column without a unit whose numbers allow two units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnsaidUnit {
    /// The column, from 0.
    pub column: usize,
    /// The possible units, as written in a heading.
    pub units: [&'static str; 2],
}

/// Reason why a table is not a frequency response, and the missing units that would make it one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unrecognised {
    pub(crate) fault: VariableFault,
    pub(crate) unsaid: Vec<UnsaidUnit>,
}

impl FrequencyColumns {
    /// Recognises the columns by their names and units; ambiguities become questions.
    pub(crate) fn recognise(table: &TextTable) -> Result<Self, Unrecognised> {
        let unit = |index: usize| table.units.get(index).and_then(|unit| unit.as_deref());
        let meaning =
            |index: usize| ColumnMeaning::of(table.name(index).unwrap_or_default(), unit(index));
        let meanings: Vec<ColumnMeaning> = (0..table.columns.len()).map(meaning).collect();
        let mut reading = Recognition {
            table,
            meanings: &meanings,
            notes: Vec::new(),
            unsaid: Vec::new(),
            unused: Vec::new(),
        };
        let frequency = reading.frequency()?;
        let responses = reading.responses();
        if !reading.unsaid.is_empty() {
            let ask = |of: &UnsaidUnit| {
                let [one, other] = of.units;
                format!("{} (write [{one}] or [{other}])", place(table, of.column))
            };
            let asked: Vec<String> = reading.unsaid.iter().map(ask).collect();
            let of_units = unrecognised(&format!("no unit of {}", asked.join(", of ")));
            return Err(Unrecognised {
                unsaid: reading.unsaid,
                ..of_units
            });
        }
        if responses.is_empty() {
            return Err(unrecognised(
                "no magnitude with a phase and no real part with an imaginary part",
            ));
        }
        let Recognition { notes, unused, .. } = reading;
        let mut found = Self {
            frequency,
            responses,
            notes,
            unused,
        };
        if found.falls(table) {
            found
                .notes
                .push("the frequencies fall: taken from the last line to the first".to_owned());
        }
        Ok(found)
    }

    /// Returns the points of every response, in rad/s and as complex numbers.
    ///
    /// Decreasing frequencies are reversed. A frequency that is missing, negative, or not above the
    /// frequency before it is refused with its line, and so is half a complex number.
    pub(crate) fn values(&self, table: &TextTable) -> Result<Vec<ResponsePoints>, VariableFault> {
        let falls = self.falls(table).then(|| {
            let mut table = table.clone();
            table.columns.iter_mut().for_each(|column| column.reverse());
            table.lines.reverse();
            table
        });
        let table = falls.as_ref().unwrap_or(table);
        let omega = self.omega(table)?;
        self.responses
            .iter()
            .map(|response| points(table, response, &omega))
            .collect()
    }

    /// Whether the frequencies decrease strictly.
    fn falls(&self, table: &TextTable) -> bool {
        let column = &table.columns[self.frequency.0];
        column.len() > 1 && column.is_sorted_by(|one, next| one > next)
    }

    fn omega(&self, table: &TextTable) -> Result<Vec<f64>, VariableFault> {
        let (index, factor) = self.frequency;
        let column = &table.columns[index];
        let place = place(table, index);
        let mut before = f64::NEG_INFINITY;
        for (&value, &line) in column.iter().zip(&table.lines) {
            let what = if !value.is_finite() {
                "is missing or infinite; complete it or take the line out".to_owned()
            } else if value < 0.0 {
                format!("is negative ({value}); take the line out")
            } else if value == before {
                format!("stands twice ({value}); take one of the lines out")
            } else if value < before {
                format!(
                    "is below the one before ({value} after {before}); sort the lines by frequency"
                )
            } else {
                before = value;
                continue;
            };
            return Err(VariableFault::line(
                "",
                line,
                format!("the frequency in {place} {what}"),
            ));
        }
        Ok(column.iter().map(|value| factor * value).collect())
    }
}

/// Returns the reason why there is no frequency response, with a remedy.
fn unrecognised(found: &str) -> Unrecognised {
    let found = format!(
        "a table with {found} among its columns; say what each column holds in its first line, by --headings, or under \
         \"headings\" in the rules: \"omega [rad/s]\", \"mag Q/LON [dB]\", \"phase Q/LON [deg]\""
    );
    let fault = VariableFault::format("a frequency response in columns", found);
    Unrecognised {
        fault,
        unsaid: Vec::new(),
    }
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

/// Columns of one response, by quantity.
#[derive(Default)]
struct Group {
    label: ResponseLabel,
    columns: Vec<(Quantity, usize)>,
}

impl Group {
    fn column(&self, quantity: Quantity) -> Option<usize> {
        self.columns
            .iter()
            .find(|(known, _)| *known == quantity)
            .map(|(_, column)| *column)
    }
}

impl Recognition<'_> {
    fn frequency(&mut self) -> Result<(usize, f64), Unrecognised> {
        let named = self
            .meanings
            .iter()
            .position(|meaning| meaning.quantity == Some(Quantity::Frequency));
        let column = named.ok_or_else(|| unrecognised("no frequency"))?;
        let meaning = &self.meanings[column];
        let (factor, words) = match meaning.unit {
            Some(KnownUnit::Hertz) => (TAU, "Hz"),
            Some(KnownUnit::RadianPerSecond) => (1.0, "rad/s"),
            _ => {
                self.unsaid.push(UnsaidUnit {
                    column,
                    units: ["rad/s", "Hz"],
                });
                return Ok((column, 1.0));
            }
        };
        let known = match self.table.units.get(column).and_then(Option::as_ref) {
            Some(unit) => format!("its unit says {unit}"),
            None => "and with it the unit".to_owned(),
        };
        self.note(
            column,
            &format!("the frequency in {words}"),
            &format!(", {known}"),
        );
        Ok((column, factor))
    }

    /// Notes the interpretation of a column and its reason.
    fn note(&mut self, column: usize, what: &str, more: &str) {
        let reason = &self.meanings[column].reason;
        self.notes.push(format!(
            "{} is read as {what}: {reason}{more}",
            place(self.table, column)
        ));
    }

    /// Returns the responses, in the order of their first columns.
    fn responses(&mut self) -> Vec<RecognisedResponse> {
        let mut responses = Vec::new();
        for group in self.groups() {
            if let Some(column) = group.column(Quantity::Error) {
                self.note(column, "a standard deviation, which is not used", "");
                self.unused.push(name_of(self.table, column));
            }
            let rectangular = group
                .column(Quantity::Real)
                .zip(group.column(Quantity::Imaginary));
            let polar = group
                .column(Quantity::Magnitude)
                .zip(group.column(Quantity::Phase));
            let parts = match (rectangular, polar) {
                (Some((re, im)), polar) => {
                    let parts = ResponseParts::Rectangular { re, im };
                    self.note(re, "real part", "");
                    self.note(im, "imaginary part", "");
                    // Missing units are not needed here.
                    match polar.map(|columns| self.polar(columns)) {
                        Some((polar, unsaid)) if unsaid.is_empty() => self.compare(parts, polar),
                        _ => {}
                    }
                    parts
                }
                (None, Some(columns)) => {
                    let (parts, unsaid) = self.polar(columns);
                    self.unsaid.extend(unsaid);
                    parts
                }
                (None, None) => {
                    let halves = group
                        .columns
                        .iter()
                        .filter(|(quantity, _)| *quantity != Quantity::Error);
                    for (_, column) in halves {
                        let place = place(self.table, *column);
                        self.notes
                            .push(format!("{place} is left out: its other half is missing"));
                        self.unused.push(name_of(self.table, *column));
                    }
                    continue;
                }
            };
            let coherence = group
                .column(Quantity::Coherence)
                .map(|column| self.coherence(column));
            let ResponseLabel { output, input } = group.label;
            responses.push(RecognisedResponse {
                output,
                input,
                parts,
                coherence,
            });
        }
        responses
    }

    /// Interprets a column of coherence: percent if its unit or its numbers above 1 require it. For
    /// a column called gamma, γ or γ² is a question to the user.
    fn coherence(&mut self, column: usize) -> CoherenceColumn {
        /// Limit above 1 for coherence, for rounding and noise.
        const MOST: f64 = 1.5;
        let unit = self.meanings[column].unit;
        if unit.is_none() {
            self.unsaid.push(UnsaidUnit {
                column,
                units: ["gamma2", "gamma"],
            });
        }
        let is_gamma = unit == Some(KnownUnit::Gamma);
        let said = unit == Some(KnownUnit::Percent);
        let above = self.table.columns[column].iter().any(|value| *value > MOST);
        let (what, why, factor) = match (said, above) {
            (true, _) => ("coherence in percent", ", its unit says %", 0.01),
            (false, true) => (
                "coherence in percent",
                ", some of its numbers are above 1",
                0.01,
            ),
            (false, false) => ("coherence", "", 1.0),
        };
        let why = if is_gamma {
            ", its unit says γ: squared"
        } else {
            why
        };
        self.note(column, what, why);
        CoherenceColumn {
            column,
            factor,
            is_gamma,
        }
    }

    fn groups(&mut self) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::new();
        for (column, meaning) in self.meanings.iter().enumerate() {
            let Some(quantity) = meaning.quantity else {
                let place = place(self.table, column);
                self.notes
                    .push(format!("{place} is left out: its name says nothing known"));
                self.unused.push(name_of(self.table, column));
                continue;
            };
            if quantity == Quantity::Frequency {
                continue;
            }
            let unnamed = meaning.label == ResponseLabel::default();
            let free = |group: &Group| group.column(quantity).is_none();
            // The other words of an error's name give the quantity in error.
            let beside = unnamed || quantity == Quantity::Error;
            let known = match groups.last() {
                Some(last) if beside && free(last) => Some(groups.len() - 1),
                _ => groups
                    .iter()
                    .rposition(|group| group.label == meaning.label && free(group)),
            };
            let index = known.unwrap_or(groups.len());
            if known.is_none() {
                groups.push(Group {
                    label: meaning.label.clone(),
                    columns: Vec::new(),
                });
            }
            groups[index].columns.push((quantity, column));
        }
        groups
    }

    /// Interprets a magnitude and a phase; also returns the columns whose units are neither given
    /// nor evident.
    fn polar(&mut self, (magnitude, phase): (usize, usize)) -> (ResponseParts, Vec<UnsaidUnit>) {
        let mut unsaid = Vec::new();
        let mut ask = |column: usize, units: [&'static str; 2]| {
            unsaid.push(UnsaidUnit { column, units });
            false
        };
        // A gain may be a level in dB, or a signed ratio.
        let is_gain = self
            .table
            .name(magnitude)
            .is_some_and(|name| name.to_lowercase().contains("gain"));
        let is_negative = !is_gain
            && self.table.columns[magnitude]
                .iter()
                .any(|value| *value < 0.0);
        let (in_db, said) = match self.meanings[magnitude].unit {
            Some(KnownUnit::Decibel) => (true, "its unit says dB"),
            Some(_) => (false, "its unit is not dB"),
            None if is_negative => (true, "some of its numbers are negative"),
            None => (ask(magnitude, ["dB", "abs"]), ""),
        };
        let in_degrees = match self.meanings[phase].unit {
            Some(KnownUnit::Degree) => true,
            Some(KnownUnit::Radian) => false,
            _ => ask(phase, ["deg", "rad"]),
        };
        if unsaid.is_empty() {
            let size = if in_db {
                "magnitude in dB"
            } else {
                "absolute magnitude"
            };
            self.note(magnitude, size, &format!(", {said}"));
            let angle = if in_degrees { "deg" } else { "rad" };
            self.note(
                phase,
                &format!("phase in {angle}"),
                &format!(", its unit says {angle}"),
            );
        }
        (
            ResponseParts::Polar {
                magnitude,
                in_db,
                phase,
                in_degrees,
            },
            unsaid,
        )
    }

    /// Compares a response given in both forms, to a hundredth of its magnitude: tables have few
    /// digits.
    fn compare(&mut self, rectangular: ResponseParts, polar: ResponseParts) {
        let table = self.table;
        let differs = |row: &usize| {
            let (a, b) = rectangular.complex(table, *row);
            let (c, d) = polar.complex(table, *row);
            (a - c).hypot(b - d) > 0.01 * a.hypot(b).max(c.hypot(d))
        };
        let (magnitude, phase) = polar.columns();
        let columns = format!(
            "magnitude and phase in columns {} and {}",
            magnitude + 1,
            phase + 1
        );
        let taken = "the real and imaginary parts, which are taken";
        self.notes.push(match (0..table.lines.len()).find(differs) {
            None => format!("{columns} agree with {taken}"),
            Some(row) => format!("{columns} differ from {taken} (line {})", table.lines[row]),
        });
    }
}

/// Returns the name of a column, or "column 5" if it has none.
fn name_of(table: &TextTable, column: usize) -> String {
    table
        .name(column)
        .map_or_else(|| format!("column {}", column + 1), str::to_owned)
}

/// Describes a column by its number, from 1, and its name.
fn place(table: &TextTable, column: usize) -> String {
    match table.name(column) {
        Some(name) => format!("column {} (\"{name}\")", column + 1),
        None => format!("column {}", column + 1),
    }
}

/// Returns the points of a response, without the rows in which it has no numbers.
fn points(
    table: &TextTable,
    response: &RecognisedResponse,
    omega: &[f64],
) -> Result<ResponsePoints, VariableFault> {
    let (first, second) = response.parts.columns();
    let coherence = response.coherence;
    let mut points = ResponsePoints {
        omega: Vec::with_capacity(omega.len()),
        re: Vec::with_capacity(omega.len()),
        im: Vec::with_capacity(omega.len()),
        coherence: coherence.map(|_| Vec::with_capacity(omega.len())),
    };
    for (row, (&omega, &line)) in omega.iter().zip(&table.lines).enumerate() {
        let values = [first, second].map(|index| (table.columns[index][row], index));
        if values.iter().all(|(value, _)| value.is_nan()) {
            continue;
        }
        if let Some((_, index)) = values.iter().find(|(value, _)| !value.is_finite()) {
            let place = place(table, *index);
            let what =
                format!("{place} has no finite number; complete it or empty its other half too");
            return Err(VariableFault::line("", line, what));
        }
        let (re, im) = response.parts.complex(table, row);
        if !(re.is_finite() && im.is_finite()) {
            let what = format!(
                "{} is too large for a magnitude; is it in dB?",
                place(table, first)
            );
            return Err(VariableFault::line("", line, what));
        }
        points.omega.push(omega);
        points.re.push(re);
        points.im.push(im);
        if let (Some(all), Some(of)) = (&mut points.coherence, coherence) {
            all.push(of.squared(table.columns[of.column][row]));
        }
    }
    Ok(points)
}

impl ResponseParts {
    fn columns(self) -> (usize, usize) {
        match self {
            ResponseParts::Polar {
                magnitude, phase, ..
            } => (magnitude, phase),
            ResponseParts::Rectangular { re, im } => (re, im),
        }
    }

    /// Returns real and imaginary part in a row of the table.
    fn complex(self, table: &TextTable, row: usize) -> (f64, f64) {
        let at = |column: usize| table.columns[column][row];
        match self {
            ResponseParts::Rectangular { re, im } => (at(re), at(im)),
            ResponseParts::Polar {
                magnitude,
                in_db,
                phase,
                in_degrees,
            } => {
                let size = if in_db {
                    10_f64.powf(at(magnitude) / 20.0)
                } else {
                    at(magnitude)
                };
                let angle = if in_degrees {
                    at(phase).to_radians()
                } else {
                    at(phase)
                };
                (size * angle.cos(), size * angle.sin())
            }
        }
    }
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

    const POLAR: ResponseParts = ResponseParts::Polar {
        magnitude: 1,
        in_db: true,
        phase: 2,
        in_degrees: true,
    };

    #[test]
    fn names_and_units_say_it_all() {
        let found = recognise(
            "omega [rad/s],mag P/LAT [dB],phase P/LAT [deg],coh P/LAT\n1,0,-90,1\n2,-6,-100,.9\n",
        );
        assert_eq!(found.frequency, (0, 1.0));
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
    fn several_responses_stand_side_by_side() {
        let found =
            recognise("f_Hz,P/LAT re,P/LAT im,re(PED->R),im(PED->R)\n1,2,3,4,5\n2,3,4,5,6\n");
        assert_eq!(found.frequency, (0, TAU));
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
        let one = |column, units| vec![UnsaidUnit { column, units }];
        assert_eq!(asked("f,re,im\n1,1,2\n2,3,4\n"), one(0, ["rad/s", "Hz"]));
        assert_eq!(
            asked("freq_rps,re,im\n1,1,2\n2,3,4\n"),
            one(0, ["rad/s", "Hz"])
        );
        assert_eq!(
            asked("w,gain,phase_deg\n1,-3,-90\n2,-6,-100\n"),
            one(1, ["dB", "abs"])
        );
        assert_eq!(
            asked("w,re,im,gamma\n1,1,2,0.9\n2,3,4,0.8\n"),
            one(3, ["gamma2", "gamma"])
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
    fn standard_deviations_are_no_magnitude_and_no_phase_and_what_is_not_used_is_listed() {
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
    fn two_ways_that_disagree_are_told() {
        let found = recognise("w,mag_db,phase_deg,re,im\n1,0,-90,0,1\n2,0,-90,0,1\n");
        assert!(found.notes.iter().any(|note| note.contains("differ")));
    }

    #[test]
    fn what_names_and_units_do_not_say_is_asked_for() {
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
            format!("line 4: {start} stands twice (2); take one of the lines out")
        );
        assert!(message(["1", "3", "2"]).starts_with(&format!(
            "line 4: {start} is below the one before (2 after 3)"
        )));
        assert!(message(["1", "", "2"]).starts_with(&format!("line 3: {start} is missing")));
        assert!(message(["-1", "1", "2"]).starts_with(&format!("line 2: {start} is negative")));
    }

    #[test]
    fn frequencies_that_fall_are_turned_round() {
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
    fn coherence_in_percent_becomes_a_part_of_one() {
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
