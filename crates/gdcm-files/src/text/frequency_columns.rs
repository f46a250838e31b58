//! Which columns of a table are a frequency response, and in which units.

use super::column_guess::guess;
use super::columns::TextTable;
use super::response_columns::ResponseColumns;
use crate::variables::VariableFault;

/// Unit of a column of frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrequencyUnit {
    /// rad/s.
    RadianPerSecond,
    /// Hz, cycles per second.
    Hertz,
}

/// Unit of a column of magnitudes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MagnitudeUnit {
    /// dB: 20 log10 of the magnitude.
    Decibel,
    /// The magnitude itself.
    Absolute,
}

/// Unit of a column of phases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseUnit {
    /// Degrees.
    Degree,
    /// Radians.
    Radian,
}

/// The column of frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrequencyColumn {
    /// The column, from 0.
    pub column: usize,
    /// Its unit.
    pub unit: FrequencyUnit,
}

/// The two columns, from 0, that are a complex number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResponseParts {
    /// Magnitude and phase.
    Polar {
        /// Column of the magnitude.
        magnitude: usize,
        /// Its unit.
        magnitude_unit: MagnitudeUnit,
        /// Column of the phase.
        phase: usize,
        /// Its unit.
        phase_unit: PhaseUnit,
    },
    /// Real and imaginary part.
    Rectangular {
        /// Column of the real part.
        re: usize,
        /// Column of the imaginary part.
        im: usize,
    },
}

/// A frequency response among the columns of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecognisedResponse {
    /// The output, where the names say it.
    pub output: Option<String>,
    /// The input, where the names say it.
    pub input: Option<String>,
    /// The columns of its numbers.
    pub parts: ResponseParts,
    /// The column, from 0, of its coherence, as it stands there: whether it is squared, the engineer says.
    pub coherence: Option<usize>,
}

/// What the columns of a table mean; everything can be corrected before the values are taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrequencyColumns {
    /// The column of frequencies.
    pub frequency: FrequencyColumn,
    /// The responses, in the order of their columns.
    pub responses: Vec<RecognisedResponse>,
    /// Each decision and its reason, in words.
    pub notes: Vec<String>,
    /// Whether names and units said all that was decided.
    pub certain: bool,
}

impl FrequencyColumns {
    /// Recognises the columns by their names and units, and by their numbers where those say nothing.
    pub fn recognise(table: &TextTable) -> Result<Self, VariableFault> {
        let named = ResponseColumns::of(table);
        if named.says_nothing() {
            return guess(table);
        }
        let mut notes = Vec::new();
        let mut certain = true;
        let frequency = named.frequency(table, &mut notes, &mut certain)?;
        let responses = named.responses(table, &mut notes, &mut certain);
        if responses.is_empty() {
            return Err(unrecognised("no magnitude with a phase and no real part with an imaginary part"));
        }
        Ok(Self { frequency, responses, notes, certain })
    }
}

/// No frequency response: what is missing, in words.
pub(super) fn unrecognised(found: &str) -> VariableFault {
    let found = format!("a table with {found} among its columns; say what each column holds");
    VariableFault::Format { expected: "a frequency response in columns", found }
}

#[cfg(test)]
mod tests {
    use super::super::columns::read_table;
    use super::*;
    use crate::variables::MemoryBudget;

    fn recognise(text: &str) -> FrequencyColumns {
        let table = read_table(text, &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        FrequencyColumns::recognise(&table).unwrap()
    }

    fn fault(text: &str) -> String {
        let table = read_table(text, &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        FrequencyColumns::recognise(&table).unwrap_err().to_string()
    }

    const POLAR: ResponseParts = ResponseParts::Polar {
        magnitude: 1,
        magnitude_unit: MagnitudeUnit::Decibel,
        phase: 2,
        phase_unit: PhaseUnit::Degree,
    };

    #[test]
    fn names_and_units_say_it_all() {
        let found = recognise("omega [rad/s],mag P/LAT [dB],phase P/LAT [deg],coh P/LAT\n1,0,-90,1\n2,-6,-100,.9\n");
        assert_eq!(found.frequency, FrequencyColumn { column: 0, unit: FrequencyUnit::RadianPerSecond });
        let [response] = found.responses.as_slice() else { panic!("one response") };
        assert_eq!((response.output.as_deref(), response.input.as_deref()), (Some("P"), Some("LAT")));
        assert_eq!((response.parts, response.coherence), (POLAR, Some(3)));
        assert!(found.certain);
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
        let found = recognise("f,P/LAT re,P/LAT im,re(PED->R),im(PED->R)\n1,2,3,4,5\n2,3,4,5,6\n");
        assert_eq!(found.frequency.unit, FrequencyUnit::Hertz);
        let names: Vec<_> = found.responses.iter().map(|r| (r.output.as_deref(), r.input.as_deref())).collect();
        assert_eq!(names, [(Some("P"), Some("LAT")), (Some("R"), Some("PED"))]);
        assert_eq!(found.responses[1].parts, ResponseParts::Rectangular { re: 3, im: 4 });
    }

    #[test]
    fn columns_of_cifer_are_read() {
        let text =
            "FREQUENCY MAGNITUDE(DB) PHASE(DEG) COHERENCE ERROR REAL IMAG\n 1 0 -90 .9 .1 0 -1\n 2 0 180 .9 .1 -1 0\n";
        let found = recognise(text);
        assert_eq!(found.responses[0].parts, ResponseParts::Rectangular { re: 5, im: 6 });
        assert_eq!(found.responses[0].coherence, Some(3));
        assert!(!found.certain, "the unit of the frequency is not said");
        assert!(found.notes.iter().any(|note| note.contains("magnitude and phase in columns 2 and 3 agree")));
    }

    #[test]
    fn two_ways_that_disagree_are_not_certain() {
        let found = recognise("w,mag_db,phase_deg,re,im\n1,0,-90,0,1\n2,0,-90,0,1\n");
        assert!(!found.certain);
        assert!(found.notes.iter().any(|note| note.contains("differ")));
    }

    #[test]
    fn units_that_are_not_said_are_told_by_the_numbers() {
        let found = recognise("omega,mag,phase\n1,3,-90\n2,-6,-100\n");
        assert_eq!(found.responses[0].parts, POLAR);
        assert!(!found.certain);
        let absolute = recognise("omega,mag,phase\n1,3,-1\n2,0.5,-2\n");
        let expected = ResponseParts::Polar {
            magnitude: 1,
            magnitude_unit: MagnitudeUnit::Absolute,
            phase: 2,
            phase_unit: PhaseUnit::Radian,
        };
        assert_eq!(absolute.responses[0].parts, expected);
    }

    #[test]
    fn half_a_response_is_noted_and_none_is_refused() {
        let found = recognise("w,re,im,mag X/Y\n1,2,3,1\n2,3,4,1\n");
        assert_eq!(found.responses.len(), 1);
        assert!(found.notes.iter().any(|note| note.contains("column 4 (\"mag X/Y\") is left out")));
        assert!(fault("w,mag\n1,2\n2,3\n").contains("no magnitude with a phase"));
        assert!(fault("mag,phase\n1,2\n2,1\n").contains("no frequency"));
    }
}
