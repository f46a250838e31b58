//! Which columns of a table are a frequency response, and in which units.

use gdcm_core::assembly::PhysicalUnit;

use crate::text::column_guess::guess;
use crate::text::columns::{TextTable, line_fault};
use crate::text::response_columns::{ResponseColumns, place};
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

// What a column of a frequency response holds, from its name and unit.

/// What a column of a frequency response holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Error,
    Coherence,
    Magnitude,
    Phase,
    Real,
    Imaginary,
    Frequency,
}

/// A unit that decides how a column is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KnownUnit {
    RadianPerSecond,
    Hertz,
    Decibel,
    Degree,
    Radian,
    /// Another one: of a magnitude, a real or an imaginary part.
    Other,
}

/// What the name and the unit of a column say.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColumnMeaning {
    pub(super) quantity: Option<Quantity>,
    pub(super) unit: Option<KnownUnit>,
    pub(super) label: ResponseLabel,
    /// Why, in words: "its name says phase".
    pub(super) reason: String,
}

/// Words in the names of columns. A column is the first kind of which its name has a word: "phase error" is an error.
const WORDS: [(Quantity, &[&str]); 7] = [
    (Quantity::Error, &["error", "err", "std", "sigma", "uncertainty", "eps"]),
    (
        Quantity::Coherence,
        &["coherence", "coh", "gamma", "gamma2", "gam", "gam2", "gammasq", "γ", "γ²", "γ2", "cxy", "gxy"],
    ),
    (Quantity::Magnitude, &["magnitude", "mag", "amplitude", "ampl", "amp", "gain", "abs", "modulus"]),
    (Quantity::Phase, &["phase", "phas", "phs", "pha", "angle", "arg"]),
    (Quantity::Real, &["real", "re"]),
    (Quantity::Imaginary, &["imaginary", "imag", "img", "im"]),
    (Quantity::Frequency, &["frequency", "frequencies", "freq", "frq", "omega", "om", "ω"]),
];

/// Units at the end of a name that has none in brackets.
const UNIT_ENDINGS: [(&str, KnownUnit); 10] = [
    ("rad/s", KnownUnit::RadianPerSecond),
    ("rad/sec", KnownUnit::RadianPerSecond),
    ("rad_s", KnownUnit::RadianPerSecond),
    ("rad_sec", KnownUnit::RadianPerSecond),
    ("rads", KnownUnit::RadianPerSecond),
    ("rps", KnownUnit::RadianPerSecond),
    ("hz", KnownUnit::Hertz),
    ("db", KnownUnit::Decibel),
    ("deg", KnownUnit::Degree),
    ("rad", KnownUnit::Radian),
];

/// Whether a word names what a column of a frequency response holds ("re", "phase") or its unit, and so no channel.
pub fn says_quantity(word: &str) -> bool {
    let word = word.to_lowercase();
    let known = |kinds: &[&str]| kinds.contains(&word.as_str());
    WORDS.iter().any(|(_, kinds)| known(kinds)) || UNIT_ENDINGS.iter().any(|(unit, _)| *unit == word)
}

impl ColumnMeaning {
    /// Reads the name and the unit of a column.
    pub(super) fn of(name: &str, unit: Option<&str>) -> Self {
        let (name, unit) = match unit {
            Some(unit) => (name, Some(known_unit(unit))),
            None => unit_at_end(name),
        };
        let lower = name.trim().to_lowercase();
        let sole = match lower.as_str() {
            "w" if !matches!(unit, Some(KnownUnit::Other)) => Some((Quantity::Frequency, KnownUnit::RadianPerSecond)),
            "f" if !matches!(unit, Some(KnownUnit::Other)) => Some((Quantity::Frequency, KnownUnit::Hertz)),
            _ => None,
        };
        if let Some((quantity, usual)) = sole {
            let reason = format!("its name is \"{name}\"");
            return Self {
                quantity: Some(quantity),
                unit: unit.or(Some(usual)),
                label: ResponseLabel::default(),
                reason,
            };
        }
        Self::from_words(name, unit)
    }

    fn from_words(name: &str, unit: Option<KnownUnit>) -> Self {
        let words = words_of(name);
        for (quantity, known) in WORDS {
            let is = |word: &str| {
                known.contains(&word) || known.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit()))
            };
            if let Some((_, word)) = words.iter().find(|(_, word)| is(&word.to_lowercase())) {
                let reason = format!("its name says {}", word.to_lowercase());
                let label = without(name, &words, known);
                let usual = matches!(word.to_lowercase().as_str(), "omega" | "om" | "ω");
                let unit = unit.or(usual.then_some(KnownUnit::RadianPerSecond));
                return Self { quantity: Some(quantity), unit, label: ResponseLabel::of(&label), reason };
            }
        }
        let strokes = name.trim().len() > 2 && name.trim().starts_with('|') && name.trim().ends_with('|');
        let (quantity, reason) = match unit {
            Some(KnownUnit::Decibel) => (Some(Quantity::Magnitude), "its unit is dB"),
            Some(KnownUnit::Degree) => (Some(Quantity::Phase), "its unit is an angle"),
            Some(KnownUnit::Hertz) => (Some(Quantity::Frequency), "its unit is Hz"),
            Some(KnownUnit::RadianPerSecond) if name.trim().is_empty() => {
                (Some(Quantity::Frequency), "its unit is rad/s")
            }
            _ if strokes => (Some(Quantity::Magnitude), "its name stands between strokes"),
            _ if name.contains('∠') => (Some(Quantity::Phase), "its name has the sign of an angle"),
            _ => (None, ""),
        };
        Self { quantity, unit, label: ResponseLabel::of(name), reason: reason.to_owned() }
    }
}

fn known_unit(unit: &str) -> KnownUnit {
    match unit.trim().to_lowercase().replace([' ', '.'], "").as_str() {
        // Of a column of frequencies, that is.
        "1/s" | "rads" | "rads^-1" | "rads-1" => return KnownUnit::RadianPerSecond,
        "1/sec" => return KnownUnit::Hertz,
        _ => {}
    }
    match PhysicalUnit::of(unit).map(|unit| unit.name) {
        Some("rad/s") => KnownUnit::RadianPerSecond,
        Some("Hz") => KnownUnit::Hertz,
        Some("dB") => KnownUnit::Decibel,
        Some("deg") => KnownUnit::Degree,
        Some("rad") => KnownUnit::Radian,
        _ => KnownUnit::Other,
    }
}

/// Cuts a unit off the end of a name: "mag_dB", "freqHz", "w_rad_s".
fn unit_at_end(name: &str) -> (&str, Option<KnownUnit>) {
    let name = name.trim();
    for (ending, unit) in UNIT_ENDINGS {
        let cut = name.len().checked_sub(ending.len()).filter(|&at| name.is_char_boundary(at));
        let Some((front, end)) = cut.map(|at| name.split_at(at)) else { continue };
        if !end.eq_ignore_ascii_case(ending) {
            continue;
        }
        let between = front.is_empty() || front.ends_with(['_', ' ', '-', '.', '/', ',']);
        let word = front.to_lowercase();
        let glued = WORDS.iter().any(|(_, known)| known.iter().any(|known| known.len() > 1 && word.ends_with(known)));
        if between || glued {
            return (front.trim_end_matches(['_', ' ', '-', '.', '/', ',']), Some(unit));
        }
    }
    (name, None)
}

/// The words of a name and where they begin.
fn words_of(name: &str) -> Vec<(usize, &str)> {
    let mut words = Vec::new();
    let mut from = None;
    for (at, character) in name.char_indices().chain([(name.len(), ' ')]) {
        let inside = at < name.len() && (character.is_alphanumeric() || character == '²');
        match (from, inside) {
            (None, true) => from = Some(at),
            (Some(start), false) => {
                words.push((start, &name[start..at]));
                from = None;
            }
            _ => {}
        }
    }
    words
}

/// A name without the words of one kind; the digits behind such a word stay, as in "re1".
fn without(name: &str, words: &[(usize, &str)], known: &[&str]) -> String {
    let mut label = String::with_capacity(name.len());
    let mut from = 0;
    for (start, word) in words {
        let stem = word.trim_end_matches(|c: char| c.is_ascii_digit());
        let length =
            match (known.contains(&word.to_lowercase().as_str()), known.contains(&stem.to_lowercase().as_str())) {
                (true, _) => word.len(),
                (_, true) => stem.len(),
                _ => continue,
            };
        label.push_str(&name[from..*start]);
        from = start + length;
    }
    label.push_str(&name[from..]);
    label
}

// The numbers of a frequency response, out of the columns of a table.

/// A frequency response, point by point.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponsePoints {
    /// Frequencies \[rad/s\], strictly increasing.
    pub omega: Vec<f64>,
    /// Real parts.
    pub re: Vec<f64>,
    /// Imaginary parts.
    pub im: Vec<f64>,
    /// Coherence as it stands in the table, NaN where it is missing.
    pub coherence: Option<Vec<f64>>,
    /// Rows in which this response has no numbers at all, as others in the table do; they are left out.
    pub left_out: usize,
}

impl FrequencyColumns {
    /// The points of every response, in rad/s and as complex numbers.
    ///
    /// A frequency that is missing, negative, or not above the one before is refused with its line, and so is half a number.
    pub fn values(&self, table: &TextTable) -> Result<Vec<ResponsePoints>, VariableFault> {
        let omega = self.omega(table)?;
        self.responses.iter().map(|response| points(table, response, &omega)).collect()
    }

    fn omega(&self, table: &TextTable) -> Result<Vec<f64>, VariableFault> {
        let column = column(table, self.frequency.column)?;
        let place = place(table, self.frequency.column);
        let mut before = f64::NEG_INFINITY;
        for (&value, &line) in column.iter().zip(&table.lines) {
            let fault = |what: &str| Err(line_fault(line, format!("the frequency in {place} {what}")));
            if !value.is_finite() {
                return fault("is missing or infinite; complete it or take the line out");
            }
            if value < 0.0 {
                return fault(&format!("is negative ({value}); take the line out"));
            }
            if value == before {
                return fault(&format!("stands twice ({value}); take one of the lines out"));
            }
            if value < before {
                return fault(&format!(
                    "is below the one before ({value} after {before}); sort the lines by frequency"
                ));
            }
            before = value;
        }
        let factor = match self.frequency.unit {
            FrequencyUnit::RadianPerSecond => 1.0,
            FrequencyUnit::Hertz => std::f64::consts::TAU,
        };
        Ok(column.iter().map(|value| factor * value).collect())
    }
}

/// A column that a person may have chosen.
fn column(table: &TextTable, index: usize) -> Result<&[f64], VariableFault> {
    table.columns.get(index).map(Vec::as_slice).ok_or_else(|| unrecognised(&format!("no column {}", index + 1)))
}

fn points(table: &TextTable, response: &RecognisedResponse, omega: &[f64]) -> Result<ResponsePoints, VariableFault> {
    let (first, second) = response.parts.columns();
    let (first_values, second_values) = (column(table, first)?, column(table, second)?);
    let coherence = response.coherence.map(|index| column(table, index)).transpose()?;
    let mut points = ResponsePoints {
        omega: Vec::with_capacity(omega.len()),
        re: Vec::with_capacity(omega.len()),
        im: Vec::with_capacity(omega.len()),
        coherence: coherence.map(|_| Vec::with_capacity(omega.len())),
        left_out: 0,
    };
    for (row, (&omega, &line)) in omega.iter().zip(&table.lines).enumerate() {
        if first_values[row].is_nan() && second_values[row].is_nan() {
            points.left_out += 1;
            continue;
        }
        for (value, index) in [(first_values[row], first), (second_values[row], second)] {
            if !value.is_finite() {
                let what =
                    format!("{} has no finite number; complete it or empty its other half too", place(table, index));
                return Err(line_fault(line, what));
            }
        }
        let (re, im) = complex_at(table, response.parts, row);
        if !(re.is_finite() && im.is_finite()) {
            let what = format!("{} is too large for a magnitude; is it in dB?", place(table, first));
            return Err(line_fault(line, what));
        }
        points.omega.push(omega);
        points.re.push(re);
        points.im.push(im);
        if let (Some(all), Some(values)) = (&mut points.coherence, coherence) {
            all.push(values[row]);
        }
    }
    Ok(points)
}

impl ResponseParts {
    fn columns(self) -> (usize, usize) {
        match self {
            ResponseParts::Polar { magnitude, phase, .. } => (magnitude, phase),
            ResponseParts::Rectangular { re, im } => (re, im),
        }
    }
}

/// Real and imaginary part in a row of a table that has the columns.
pub(super) fn complex_at(table: &TextTable, parts: ResponseParts, row: usize) -> (f64, f64) {
    let at = |column: usize| table.columns[column][row];
    match parts {
        ResponseParts::Rectangular { re, im } => (at(re), at(im)),
        ResponseParts::Polar { magnitude, magnitude_unit, phase, phase_unit } => {
            let size = match magnitude_unit {
                MagnitudeUnit::Decibel => 10_f64.powf(at(magnitude) / 20.0),
                MagnitudeUnit::Absolute => at(magnitude),
            };
            let angle = match phase_unit {
                PhaseUnit::Degree => at(phase).to_radians(),
                PhaseUnit::Radian => at(phase),
            };
            (size * angle.cos(), size * angle.sin())
        }
    }
}

/// Whether numbers can be frequencies: none negative, each above the one before.
pub(super) fn is_increasing(values: &[f64]) -> bool {
    values.first().is_some_and(|&first| first >= 0.0) && values.windows(2).all(|pair| pair[0] < pair[1])
}

// Which output over which input a response is, from the name of a column.

/// An output and an input, as far as a name says them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ResponseLabel {
    /// The output.
    pub(super) output: Option<String>,
    /// The input.
    pub(super) input: Option<String>,
    /// Whether an underscore was taken for the stroke between output and input.
    pub(super) doubtful: bool,
}

/// What stands between an input and the output that follows it.
const FORWARD: [&str; 5] = ["->", "→", "=>", ">", " to "];
/// What stands between an output and its input.
const BACKWARD: [&str; 6] = ["<-", "←", "/", " due to ", " from ", " over "];

impl ResponseLabel {
    /// Reads "P/LAT", "LAT->P", "LAT to P", "P_LAT"; anything else names the output.
    pub(super) fn of(text: &str) -> Self {
        let text = clean(text);
        let part = |part: &str| Some(clean(part).to_owned()).filter(|part| !part.is_empty());
        for sign in BACKWARD {
            if let Some((output, input)) = text.split_once(sign) {
                return Self { output: part(output), input: part(input), doubtful: false };
            }
        }
        for sign in FORWARD {
            if let Some((input, output)) = text.split_once(sign) {
                return Self { output: part(output), input: part(input), doubtful: false };
            }
        }
        match text.split_once('_') {
            Some((output, input)) if !input.contains('_') => {
                Self { output: part(output), input: part(input), doubtful: true }
            }
            _ => Self { output: part(text), input: None, doubtful: false },
        }
    }
}

/// A text without the brackets, strokes and blanks around it.
fn clean(text: &str) -> &str {
    text.trim_matches(|c: char| c.is_whitespace() || "_-.,:;(){}[]|∠=\"'".contains(c))
}

#[cfg(test)]
mod frequency_columns_tests {
    use crate::text::columns::read_table;
    use crate::variables::MemoryBudget;

    use super::*;

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

#[cfg(test)]
mod column_meaning_tests {
    use super::*;

    fn of(name: &str, unit: &str) -> (Option<Quantity>, Option<KnownUnit>, String, String) {
        let meaning = ColumnMeaning::of(name, Some(unit).filter(|unit| !unit.is_empty()));
        let ResponseLabel { output, input, .. } = meaning.label;
        (meaning.quantity, meaning.unit, output.unwrap_or_default(), input.unwrap_or_default())
    }

    fn is(
        quantity: Quantity,
        unit: Option<KnownUnit>,
        output: &str,
        input: &str,
    ) -> (Option<Quantity>, Option<KnownUnit>, String, String) {
        (Some(quantity), unit, output.to_owned(), input.to_owned())
    }

    #[test]
    fn frequencies_are_named_in_many_ways() {
        let radians = is(Quantity::Frequency, Some(KnownUnit::RadianPerSecond), "", "");
        for (name, unit) in
            [("omega", ""), ("w", ""), ("Frequency", "rad/s"), ("w_rad_s", ""), ("freq rad/s", ""), ("ω", "")]
        {
            assert_eq!(of(name, unit), radians, "{name}");
        }
        let hertz = is(Quantity::Frequency, Some(KnownUnit::Hertz), "", "");
        for (name, unit) in [("f", ""), ("freqHz", ""), ("Freq", "Hz"), ("f", "Hz")] {
            assert_eq!(of(name, unit), hertz, "{name}");
        }
        assert_eq!(of("freq", ""), is(Quantity::Frequency, None, "", ""));
        assert_eq!(of("w", "m/s").0, None);
    }

    #[test]
    fn the_response_is_read_from_what_is_left_of_the_name() {
        let decibel = Some(KnownUnit::Decibel);
        assert_eq!(of("mag P/LAT", "dB"), is(Quantity::Magnitude, decibel, "P", "LAT"));
        assert_eq!(of("P_LAT_re", ""), is(Quantity::Real, None, "P", "LAT"));
        assert_eq!(of("re(LAT->P)", ""), is(Quantity::Real, None, "P", "LAT"));
        assert_eq!(of("P/LAT_mag_dB", ""), is(Quantity::Magnitude, decibel, "P", "LAT"));
        assert_eq!(of("P/LAT", "deg"), is(Quantity::Phase, Some(KnownUnit::Degree), "P", "LAT"));
        assert_eq!(of("phasedeg", ""), is(Quantity::Phase, Some(KnownUnit::Degree), "", ""));
        assert_eq!(of("Im1", ""), is(Quantity::Imaginary, None, "1", ""));
        assert_eq!(of("|P/LAT|", ""), is(Quantity::Magnitude, None, "P", "LAT"));
        assert_eq!(of("Gamma2", ""), is(Quantity::Coherence, None, "", ""));
        assert_eq!(of("phase error", "deg"), is(Quantity::Error, Some(KnownUnit::Degree), "phase", ""));
    }

    #[test]
    fn a_name_that_says_nothing_has_no_meaning() {
        assert_eq!(of("torque", "%").0, None);
        assert_eq!(of("grad", "").0, None);
    }
}

#[cfg(test)]
mod frequency_values_tests {
    use proptest::prelude::*;

    use crate::text::columns::read_table;
    use crate::variables::MemoryBudget;

    use super::*;

    fn values(text: &str) -> Result<Vec<ResponsePoints>, VariableFault> {
        let table = read_table(text, &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        FrequencyColumns::recognise(&table).unwrap().values(&table)
    }

    #[test]
    fn hertz_decibels_and_degrees_become_complex_numbers_over_radians_per_second() {
        let points = values("f [Hz],mag [dB],phase [deg],coh\n1,20,-90,0.5\n2,0,180,1\n").unwrap().remove(0);
        assert_eq!(points.omega, [std::f64::consts::TAU, 2.0 * std::f64::consts::TAU]);
        assert!((points.im[0] + 10.0).abs() < 1e-14 && points.re[0].abs() < 1e-14);
        assert!((points.re[1] + 1.0).abs() < 1e-14);
        assert_eq!(points.coherence.unwrap(), [0.5, 1.0]);
    }

    #[test]
    fn frequencies_out_of_order_are_refused_with_their_line() {
        let message = |frequencies: [&str; 3]| {
            let rows: String = frequencies.iter().map(|omega| format!("{omega},1,2\n")).collect();
            values(&format!("omega,re,im\n{rows}")).unwrap_err().to_string()
        };
        let start = "the frequency in column 1 (\"omega\")";
        assert_eq!(message(["1", "2", "2"]), format!("line 4: {start} stands twice (2); take one of the lines out"));
        assert!(message(["1", "3", "2"]).starts_with(&format!("line 4: {start} is below the one before (2 after 3)")));
        assert!(message(["1", "", "2"]).starts_with(&format!("line 3: {start} is missing")));
        assert!(message(["-1", "1", "2"]).starts_with(&format!("line 2: {start} is negative")));
    }

    #[test]
    fn a_response_may_miss_rows_but_not_half_a_number() {
        let points = values("omega,re a,im a,re b,im b\n1,1,2,,\n2,1,2,3,4\n").unwrap();
        assert_eq!((points[0].left_out, points[1].left_out), (0, 1));
        assert_eq!(points[1].omega, [2.0]);
        let half = values("omega,re,im\n1,1,2\n2,1,\n").unwrap_err().to_string();
        assert!(half.starts_with("line 3: column 3 (\"im\") has no finite number"), "{half}");
    }

    #[test]
    fn a_chosen_column_that_is_not_there_is_refused() {
        let table = read_table("omega,re,im\n1,1,2\n2,1,2\n", &MemoryBudget::new(1 << 20, &|_| false)).unwrap();
        let mut columns = FrequencyColumns::recognise(&table).unwrap();
        columns.frequency.column = 7;
        assert!(columns.values(&table).unwrap_err().to_string().contains("no column 8"));
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

#[cfg(test)]
mod response_label_tests {
    use super::*;

    #[test]
    fn the_ways_of_naming_a_response_are_read() {
        let read = |text| {
            let ResponseLabel { output, input, doubtful } = ResponseLabel::of(text);
            (output.unwrap_or_default(), input.unwrap_or_default(), doubtful)
        };
        let is = |doubtful| ("P".to_owned(), "LAT".to_owned(), doubtful);
        for text in ["P/LAT", "(LAT->P)", "LAT → P", "LAT to P", "P <- LAT", "P due to LAT", "|P / LAT|"] {
            assert_eq!(read(text), is(false), "{text}");
        }
        assert_eq!(read("P_LAT"), is(true));
        assert_eq!(read(" P_"), ("P".to_owned(), String::new(), false));
        assert_eq!(read("a_b_c").0, "a_b_c");
        assert_eq!(ResponseLabel::of("()"), ResponseLabel::default());
    }
}
