//! Frequency responses in a table, recognised by its column names and units.
//!
//! ```text
//! FrequencyColumns::recognise   names and units -> which columns hold which responses
//!   column_meaning.rs           meaning of a single column
//!   response_group.rs           columns that belong to the same response
//!   response_recognition.rs     responses from several columns
//! FrequencyColumns::values      numbers -> points of each response (response_columns.rs)
//! ```

use crate::formats::reading_note::ReadingNote;
use crate::formats::text::response_columns::{RecognisedResponse, ResponsePoints, column_place};
use crate::formats::text::response_recognition::{FrequencyColumn, Recognition};
use crate::formats::text::text_table::TextTable;
use crate::formats::text::unrecognised::{Unrecognised, units_missing, unrecognised};
use crate::reading_budget::{NO_VARIABLE, VariableFault};
use crate::variable_fault::found_content::ResponseLack;
use crate::variable_fault::line_fault::FrequencyFault;
use crate::variable_fault::line_fault::LineFault;

/// Meaning of the columns in a frequency response table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrequencyColumns {
    frequency: FrequencyColumn,
    /// Frequency responses, in column order.
    pub(crate) responses: Vec<RecognisedResponse>,
    /// Notes for the user: each choice with its reason.
    pub(crate) notes: Vec<ReadingNote>,
    /// Unused columns, by name or, without a name, by number.
    pub(crate) unused: Vec<String>,
}

impl FrequencyColumns {
    /// Recognises the columns by their names and units.
    ///
    /// # Errors
    /// [`Unrecognised`] if no frequency response is found, or the user must be asked about a unit.
    pub(crate) fn recognise(table: &TextTable) -> Result<Self, Unrecognised> {
        let mut recognition = Recognition::new(table);
        let frequency = recognition.frequency()?;
        let responses = recognition.responses();
        // Units that are neither given nor evident: the user must state them.
        if !recognition.missing_units.is_empty() {
            return Err(units_missing(table, recognition.missing_units));
        }
        if responses.is_empty() {
            return Err(unrecognised(ResponseLack::Parts));
        }
        let mut columns = Self {
            frequency,
            responses,
            notes: recognition.notes,
            unused: recognition.unused,
        };
        if columns.is_decreasing(table) {
            columns.notes.push(ReadingNote::DecreasingFrequencies);
        }
        Ok(columns)
    }

    /// Returns each response's points.
    ///
    /// Rows with decreasing frequencies are put in reverse order.
    ///
    /// # Errors
    /// [`VariableFault`] with the line if a frequency is missing, infinite, negative or not above
    /// the preceding frequency, if only one part of a complex number is present, or if a part is
    /// infinite or a magnitude too large.
    pub(crate) fn values(&self, table: &TextTable) -> Result<Vec<ResponsePoints>, VariableFault> {
        if self.is_decreasing(table) {
            self.increasing_values(&reversed(table))
        } else {
            self.increasing_values(table)
        }
    }

    /// Returns whether the frequencies are strictly decreasing.
    fn is_decreasing(&self, table: &TextTable) -> bool {
        let frequencies = &table.columns[self.frequency.column];
        frequencies.len() > 1 && frequencies.is_sorted_by(|above, below| above > below)
    }

    /// Returns each response's points; the frequencies must increase.
    fn increasing_values(&self, table: &TextTable) -> Result<Vec<ResponsePoints>, VariableFault> {
        let omega = self.omega(table)?;
        self.responses
            .iter()
            .map(|response| response.points(table, &omega))
            .collect()
    }

    /// Returns each row's frequency \[rad/s\].
    ///
    /// # Errors
    /// [`VariableFault`] with the line unless the frequencies are finite, not negative and strictly
    /// increasing.
    fn omega(&self, table: &TextTable) -> Result<Vec<f64>, VariableFault> {
        let FrequencyColumn { column, factor } = self.frequency;
        let frequencies = &table.columns[column];
        let mut before = f64::NEG_INFINITY;
        for (&value, &line) in frequencies.iter().zip(&table.lines) {
            if let Some(fault) = frequency_fault(value, before) {
                let place = column_place(table, column);
                return Err(VariableFault::line(
                    NO_VARIABLE,
                    line,
                    LineFault::Frequency { place, fault },
                ));
            }
            before = value;
        }
        Ok(frequencies.iter().map(|value| factor * value).collect())
    }
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

/// Returns the reason why a frequency is invalid; `None` if it is valid. `before` is the preceding
/// frequency.
fn frequency_fault(value: f64, before: f64) -> Option<FrequencyFault> {
    if !value.is_finite() {
        Some(FrequencyFault::NotFinite)
    } else if value < 0.0 {
        Some(FrequencyFault::Negative { value })
    } else if value == before {
        Some(FrequencyFault::Repeated { value })
    } else if value < before {
        Some(FrequencyFault::Decreasing { value, before })
    } else {
        None
    }
}

#[cfg(test)]
mod recognition_tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::formats::reading_note::ColumnReading;
    use crate::formats::reading_reason::{QuantityReason, UnitReason};
    use crate::formats::text::response_columns::{CoherenceColumn, ResponseParts};
    use crate::formats::text::table_reader::read_table;
    use crate::formats::text::unrecognised::UnitNotGiven;
    use crate::reading_budget::ReadingBudget;
    use crate::variable_fault::column_place::ColumnPlace;
    use crate::variable_fault::found_content::{FoundContent, MissingUnit};

    fn recognise(text: &str) -> FrequencyColumns {
        let table = read_table(text, &ReadingBudget::new(1 << 20)).unwrap();
        FrequencyColumns::recognise(&table).unwrap()
    }

    fn lacking(text: &str) -> ResponseLack {
        let table = read_table(text, &ReadingBudget::new(1 << 20)).unwrap();
        match FrequencyColumns::recognise(&table).unwrap_err().fault {
            VariableFault::Format {
                found: FoundContent::NotAResponse { lacking },
                ..
            } => lacking,
            other => panic!("{other:?}"),
        }
    }

    fn missing_unit(number: usize, name: &str, units: [&'static str; 2]) -> MissingUnit {
        MissingUnit {
            place: ColumnPlace {
                number,
                name: Some(name.to_owned()),
            },
            units,
        }
    }

    /// Returns a column that holds γ² as a fraction of 1.
    fn squared(column: usize) -> Option<CoherenceColumn> {
        Some(CoherenceColumn {
            column,
            factor: 1.0,
            is_gamma: false,
        })
    }

    fn asked(text: &str) -> Vec<UnitNotGiven> {
        let table = read_table(text, &ReadingBudget::new(1 << 20)).unwrap();
        FrequencyColumns::recognise(&table).unwrap_err().unsaid
    }

    /// Returns the frequency column, the first column.
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
        let read_as = |number, name: &str, reading, word: &str, unit: &str| ReadingNote::ReadAs {
            place: ColumnPlace {
                number,
                name: Some(name.to_owned()),
            },
            reading,
            quantity: QuantityReason::WordInName(word.to_owned()),
            unit: UnitReason::Unit(unit.to_owned()),
        };
        assert_eq!(
            found.notes[..2],
            [
                read_as(
                    1,
                    "omega",
                    ColumnReading::Frequency { unit: "rad/s" },
                    "omega",
                    "rad/s"
                ),
                read_as(2, "mag P/LAT", ColumnReading::MagnitudeInDb, "mag", "dB")
            ]
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
        assert!(found.notes.contains(&ReadingNote::FormsAgree {
            magnitude: 2,
            phase: 3
        }));
    }

    #[test]
    fn a_bare_f_rps_a_gain_and_gamma_are_asked_for_and_answered_by_a_unit() {
        let question = |column, units| vec![UnitNotGiven { column, units }];
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
        assert!(found.notes.contains(&ReadingNote::FormsDiffer {
            magnitude: 2,
            phase: 3,
            line: 2
        }));
    }

    #[test]
    fn missing_units_are_asked_for() {
        let found = recognise("omega,mag,phase [deg]\n1,3,-90\n2,-6,-100\n");
        assert_eq!(found.responses[0].parts, POLAR, "no magnitude is negative");
        assert_eq!(
            lacking("omega,mag,phase [deg]\n1,3,-90\n2,0.5,-100\n"),
            ResponseLack::Units(vec![missing_unit(2, "mag", ["dB", "abs"])])
        );
        assert_eq!(
            lacking("omega,mag [dB],phase\n1,3,-1\n2,0.5,-2\n"),
            ResponseLack::Units(vec![missing_unit(3, "phase", ["deg", "rad"])])
        );
        let absolute = recognise("omega,mag [abs],phase [rad]\n1,3,-1\n2,0.5,-2\n");
        let expected = ResponseParts::Polar {
            magnitude: 1,
            in_db: false,
            phase: 2,
            in_degrees: false,
        };
        assert_eq!(absolute.responses[0].parts, expected);
        assert_eq!(
            lacking("Frequency,Gain,Phase\n0.5,5.8,-42.7\n0.6,9.8,-24.8\n"),
            ResponseLack::Units(vec![
                missing_unit(1, "Frequency", ["rad/s", "Hz"]),
                missing_unit(2, "Gain", ["dB", "abs"]),
                missing_unit(3, "Phase", ["deg", "rad"]),
            ])
        );
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
        assert_eq!(
            lacking("0.3,10,-90\n1,5,-100\n2,1,-120\n"),
            ResponseLack::Frequency
        );
    }

    #[test]
    fn half_a_response_is_noted_and_none_is_refused() {
        let found = recognise("w,re,im,mag X/Y\n1,2,3,1\n2,3,4,1\n");
        assert_eq!(found.responses.len(), 1);
        assert!(
            found.notes.iter().any(
                |note| matches!(note, ReadingNote::HalfResponse { place } if place.number == 4)
            )
        );
        assert_eq!(lacking("w,mag\n1,2\n2,3\n"), ResponseLack::Parts);
        assert_eq!(lacking("mag,phase\n1,2\n2,1\n"), ResponseLack::Frequency);
    }
}

#[cfg(test)]
mod frequency_values_tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::text::table_reader::read_table;
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
        let frequency_fault = |frequencies: [&str; 3]| {
            let rows: String = frequencies
                .iter()
                .map(|omega| format!("{omega},1,2\n"))
                .collect();
            match values(&format!("omega,re,im\n{rows}")) {
                Err(VariableFault::Line {
                    line,
                    fault: LineFault::Frequency { place, fault },
                    ..
                }) => (line, place.number, fault),
                other => panic!("{other:?}"),
            }
        };
        assert_eq!(
            frequency_fault(["1", "2", "2"]),
            (4, 1, FrequencyFault::Repeated { value: 2.0 })
        );
        let decreasing = FrequencyFault::Decreasing {
            value: 2.0,
            before: 3.0,
        };
        assert_eq!(frequency_fault(["1", "3", "2"]), (4, 1, decreasing));
        assert_eq!(
            frequency_fault(["1", "", "2"]),
            (3, 1, FrequencyFault::NotFinite)
        );
        assert_eq!(
            frequency_fault(["-1", "1", "2"]),
            (2, 1, FrequencyFault::Negative { value: -1.0 })
        );
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
        assert!(matches!(
            values("omega,re,im\n1,1,2\n2,1,\n"),
            Err(VariableFault::Line {
                line: 3,
                fault: LineFault::IncompleteResponse { place },
                ..
            }) if place.number == 3
        ));
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
