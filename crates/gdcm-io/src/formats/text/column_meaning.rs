//! Meaning of the columns in a frequency response table, from their names and units.
//!
//! For each column, in this order:
//!
//! 1. Separate a unit at the end of the name, such as "mag_dB", unless the unit is already known.
//! 2. The names "w" and "f" denote the frequency, unless the unit is none that this module knows,
//!    such as m/s.
//! 3. Otherwise a word in the name gives the quantity, such as "phase" in "phase P/LAT"; what
//!    remains of the name is the label of the response: its output P and its input LAT.
//! 4. Otherwise the unit, or a sign such as ∠, gives the quantity.
//! 5. A missing unit may be implied by the word, such as rad/s by "omega" or "w".

use gdcm_model::units::physical_unit::PhysicalUnit;

use crate::formats::reading_reason::QuantityReason;
use crate::formats::text::quantity_words::{
    ABSOLUTE, BEFORE_UNIT, KnownUnit, Quantity, UNIT_ENDINGS, WORDS,
};
use crate::formats::text::response_label::ResponseLabel;

/// Meaning of a column, according to its name and unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColumnMeaning {
    /// Quantity; `None` if neither name nor unit gives it.
    pub(super) quantity: Option<Quantity>,
    /// Unit; `None` if it is neither given nor implied.
    pub(super) unit: Option<KnownUnit>,
    pub(super) label: ResponseLabel,
    pub(super) reason: QuantityReason,
}

/// Word in a column name.
#[derive(Clone, Copy)]
struct Word<'n> {
    /// Offset in the name \[bytes\].
    start: usize,
    text: &'n str,
}

impl ColumnMeaning {
    /// Interprets a column by its name and its unit; without a given unit, the name may end in one.
    pub(super) fn interpret(name: &str, unit: Option<&str>) -> Self {
        // Step 1
        let (name, unit) = match unit {
            Some(unit) => (name, Some(known_unit(unit))),
            None => split_unit(name),
        };
        // Step 2: with another unit, such as m/s, these letters denote other quantities.
        if unit != Some(KnownUnit::Other) {
            match name.trim().to_lowercase().as_str() {
                "w" => {
                    let unit = unit.or(Some(KnownUnit::RadianPerSecond));
                    return Self::frequency_letter(name, unit);
                }
                // In frequency tables, f is in Hz as often as in rad/s: ask the user for a missing
                // unit.
                "f" => return Self::frequency_letter(name, unit),
                _ => {}
            }
        }
        Self::from_words(name, unit)
    }

    /// Returns the meaning of a column whose name is a letter for the frequency.
    fn frequency_letter(name: &str, unit: Option<KnownUnit>) -> Self {
        Self {
            quantity: Some(Quantity::Frequency),
            unit,
            label: ResponseLabel::default(),
            reason: QuantityReason::Name(name.to_owned()),
        }
    }

    /// Interprets a name by the words in it (step 3), and adds the unit that they imply (step 5);
    /// by its unit if it contains no word from `WORDS`.
    fn from_words(name: &str, unit: Option<KnownUnit>) -> Self {
        let words = words_of(name);
        for (quantity, known) in WORDS {
            if let Some(word) = words.iter().find(|word| word.is_known(known)) {
                let lower = word.text.to_lowercase();
                return Self {
                    quantity: Some(quantity),
                    unit: unit.or_else(|| usual_unit(quantity, &lower, &words)),
                    label: ResponseLabel::parse(&without_words(name, &words, known)),
                    reason: QuantityReason::WordInName(lower),
                };
            }
        }
        Self::from_unit_or_signs(name, unit)
    }

    /// Interprets a name that contains no word from `WORDS` by its unit, by vertical bars around
    /// it, or by the sign ∠ (step 4).
    fn from_unit_or_signs(name: &str, unit: Option<KnownUnit>) -> Self {
        let bare = name.trim();
        let has_strokes = bare.len() > 2 && bare.starts_with('|') && bare.ends_with('|');
        let (quantity, reason) = match unit {
            Some(KnownUnit::Decibel) => (Some(Quantity::Magnitude), QuantityReason::Unit("dB")),
            Some(KnownUnit::Degree) => (Some(Quantity::Phase), QuantityReason::UnitOfAngle),
            Some(KnownUnit::Hertz) => (Some(Quantity::Frequency), QuantityReason::Unit("Hz")),
            Some(KnownUnit::RadianPerSecond) if bare.is_empty() => {
                (Some(Quantity::Frequency), QuantityReason::Unit("rad/s"))
            }
            _ if has_strokes => (Some(Quantity::Magnitude), QuantityReason::VerticalBars),
            _ if name.contains('∠') => (Some(Quantity::Phase), QuantityReason::AngleSign),
            _ => (None, QuantityReason::Unknown),
        };
        Self {
            quantity,
            unit,
            label: ResponseLabel::parse(name),
            reason,
        }
    }
}

impl Word<'_> {
    /// Returns whether the word is in the list `known`, with or without its final digits, as in
    /// "re1".
    fn is_known(&self, known: &[&str]) -> bool {
        let lower = self.text.to_lowercase();
        known.contains(&lower.as_str()) || known.contains(&without_digits(&lower))
    }

    /// Returns whether the word indicates a ratio.
    fn is_absolute(&self) -> bool {
        ABSOLUTE.contains(&self.text.to_lowercase().as_str())
    }
}

/// Returns a word without the digits at its end.
fn without_digits(word: &str) -> &str {
    word.trim_end_matches(|c: char| c.is_ascii_digit())
}

/// Returns the unit implied by the words in a name; `None` if the words imply none. `word` is the
/// word that indicates the quantity, in lower case.
fn usual_unit(quantity: Quantity, word: &str, words: &[Word<'_>]) -> Option<KnownUnit> {
    match quantity {
        Quantity::Frequency if matches!(word, "omega" | "om" | "ω") => {
            Some(KnownUnit::RadianPerSecond)
        }
        Quantity::Magnitude if words.iter().any(Word::is_absolute) => Some(KnownUnit::Other),
        // Exclude gamma and γ: programs use both names for γ and for γ².
        Quantity::Coherence if !matches!(word, "gamma" | "gam" | "γ") => {
            Some(KnownUnit::GammaSquared)
        }
        _ => None,
    }
}

/// Returns the meaning of a given unit.
fn known_unit(unit: &str) -> KnownUnit {
    match unit.trim().to_lowercase().replace([' ', '.'], "").as_str() {
        "gamma" | "γ" => return KnownUnit::Gamma,
        "gamma2" | "gamma^2" | "γ²" | "γ2" | "γ^2" => return KnownUnit::GammaSquared,
        "rps" => return KnownUnit::Rps,
        "rev/s" | "rev/sec" => return KnownUnit::Hertz,
        // These units have this meaning only in frequency columns.
        "1/s" | "1/sec" | "rads" | "rads^-1" | "rads-1" => return KnownUnit::RadianPerSecond,
        _ => {}
    }
    match PhysicalUnit::parse(unit).map(|unit| unit.name) {
        Some("rad/s") => KnownUnit::RadianPerSecond,
        Some("Hz") => KnownUnit::Hertz,
        Some("dB") => KnownUnit::Decibel,
        Some("deg") => KnownUnit::Degree,
        Some("rad") => KnownUnit::Radian,
        Some("%") => KnownUnit::Percent,
        _ => KnownUnit::Other,
    }
}

/// Splits a name into its front part and the unit at its end: "mag_dB", "freqHz", "w_rad_s".
fn split_unit(name: &str) -> (&str, Option<KnownUnit>) {
    let name = name.trim();
    for (ending, unit) in UNIT_ENDINGS {
        let Some(front) = without_ending(name, ending) else {
            continue;
        };
        let is_separate = front.is_empty() || front.ends_with(BEFORE_UNIT);
        if is_separate || ends_with_known_word(front) {
            return (front.trim_end_matches(BEFORE_UNIT), Some(unit));
        }
    }
    (name, None)
}

/// Removes an ending from a name, ignoring case; `None` if the name does not have the ending.
fn without_ending<'n>(name: &'n str, ending: &str) -> Option<&'n str> {
    let at = name.len().checked_sub(ending.len())?;
    let (front, end) = name.split_at_checked(at)?;
    if end.eq_ignore_ascii_case(ending) {
        Some(front)
    } else {
        None
    }
}

/// Returns whether a name ends in an entry of `WORDS`, such as "freq", the front part of "freqHz".
/// Ignores single-byte words.
fn ends_with_known_word(name: &str) -> bool {
    let name = name.to_lowercase();
    WORDS
        .iter()
        .flat_map(|(_, known)| known.iter())
        .any(|word| word.len() > 1 && name.ends_with(word))
}

/// Splits a name into words, which consist of letters, digits and "²".
fn words_of(name: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    // Offset where the current word began.
    let mut begun = None;
    for (at, character) in name.char_indices() {
        let is_inside = character.is_alphanumeric() || character == '²';
        match (begun, is_inside) {
            (None, true) => begun = Some(at),
            (Some(start), false) => {
                words.push(Word {
                    start,
                    text: &name[start..at],
                });
                begun = None;
            }
            _ => {}
        }
    }
    if let Some(start) = begun {
        words.push(Word {
            start,
            text: &name[start..],
        });
    }
    words
}

/// Returns a name without the words in `known`; keeps digits that end such a word, as in "re1".
fn without_words(name: &str, words: &[Word<'_>], known: &[&str]) -> String {
    let mut label = String::with_capacity(name.len());
    let mut from = 0;
    for Word { start, text } in words {
        let stem = without_digits(text);
        let length = if known.contains(&text.to_lowercase().as_str()) {
            text.len()
        } else if known.contains(&stem.to_lowercase().as_str()) {
            stem.len()
        } else {
            continue;
        };
        label.push_str(&name[from..*start]);
        from = start + length;
    }
    label.push_str(&name[from..]);
    label
}

#[cfg(test)]
mod column_meaning_tests {
    use super::*;

    fn meaning(name: &str, unit: &str) -> (Option<Quantity>, Option<KnownUnit>, String, String) {
        let meaning = ColumnMeaning::interpret(name, Some(unit).filter(|unit| !unit.is_empty()));
        let ResponseLabel { output, input } = meaning.label;
        (
            meaning.quantity,
            meaning.unit,
            output.unwrap_or_default(),
            input.unwrap_or_default(),
        )
    }

    fn expected(
        quantity: Quantity,
        unit: Option<KnownUnit>,
        output: &str,
        input: &str,
    ) -> (Option<Quantity>, Option<KnownUnit>, String, String) {
        (Some(quantity), unit, output.to_owned(), input.to_owned())
    }

    #[test]
    fn frequencies_have_many_names() {
        let radians = expected(
            Quantity::Frequency,
            Some(KnownUnit::RadianPerSecond),
            "",
            "",
        );
        for (name, unit) in [
            ("omega", ""),
            ("w", ""),
            ("Frequency", "rad/s"),
            ("w_rad_s", ""),
            ("freq rad/s", ""),
            ("ω", ""),
        ] {
            assert_eq!(meaning(name, unit), radians, "{name}");
        }
        let hertz = expected(Quantity::Frequency, Some(KnownUnit::Hertz), "", "");
        for (name, unit) in [
            ("f_Hz", ""),
            ("freqHz", ""),
            ("Freq", "Hz"),
            ("f", "Hz"),
            ("f", "rev/s"),
        ] {
            assert_eq!(meaning(name, unit), hertz, "{name}");
        }
        for name in ["f", "freq"] {
            assert_eq!(
                meaning(name, ""),
                expected(Quantity::Frequency, None, "", ""),
                "{name}"
            );
        }
        let open = expected(Quantity::Frequency, Some(KnownUnit::Rps), "", "");
        for (name, unit) in [("freq_rps", ""), ("omega", "rps"), ("f", "rps")] {
            assert_eq!(meaning(name, unit), open, "{name}");
        }
        assert_eq!(meaning("w", "m/s").0, None);
    }

    #[test]
    fn the_response_is_read_from_the_other_words() {
        let decibel = Some(KnownUnit::Decibel);
        assert_eq!(
            meaning("mag P/LAT", "dB"),
            expected(Quantity::Magnitude, decibel, "P", "LAT")
        );
        assert_eq!(
            meaning("P_LAT_re", ""),
            expected(Quantity::Real, None, "P", "LAT")
        );
        assert_eq!(
            meaning("re(LAT->P)", ""),
            expected(Quantity::Real, None, "P", "LAT")
        );
        assert_eq!(
            meaning("P/LAT_mag_dB", ""),
            expected(Quantity::Magnitude, decibel, "P", "LAT")
        );
        assert_eq!(
            meaning("P/LAT", "deg"),
            expected(Quantity::Phase, Some(KnownUnit::Degree), "P", "LAT")
        );
        assert_eq!(
            meaning("phasedeg", ""),
            expected(Quantity::Phase, Some(KnownUnit::Degree), "", "")
        );
        assert_eq!(
            meaning("Im1", ""),
            expected(Quantity::Imaginary, None, "1", "")
        );
        assert_eq!(
            meaning("|P/LAT|", ""),
            expected(Quantity::Magnitude, None, "P", "LAT")
        );
        assert_eq!(
            meaning("|H|", "dB"),
            expected(Quantity::Magnitude, decibel, "", ""),
            "the file names the response"
        );
        assert_eq!(
            meaning("ph", "deg"),
            expected(Quantity::Phase, Some(KnownUnit::Degree), "", "")
        );
        let squared = expected(Quantity::Coherence, Some(KnownUnit::GammaSquared), "", "");
        for (name, unit) in [
            ("Gamma2", ""),
            ("COHER", ""),
            ("γ²", ""),
            ("coherence", ""),
            ("gamma", "gamma2"),
        ] {
            assert_eq!(meaning(name, unit), squared, "{name}");
        }
        assert_eq!(
            meaning("gamma", ""),
            expected(Quantity::Coherence, None, "", ""),
            "γ or γ²"
        );
        assert_eq!(
            meaning("gamma", "gamma"),
            expected(Quantity::Coherence, Some(KnownUnit::Gamma), "", "")
        );
        assert_eq!(
            meaning("gain Q/LON", ""),
            expected(Quantity::Magnitude, None, "Q", "LON"),
            "dB or a ratio"
        );
        for name in ["mag_abs", "abs", "gain_abs", "|H| abs"] {
            assert_eq!(meaning(name, "").1, Some(KnownUnit::Other), "{name}");
        }
        for (name, unit) in [
            ("sd_mag_dB", KnownUnit::Decibel),
            ("sd_phase_deg", KnownUnit::Degree),
        ] {
            assert_eq!(
                (meaning(name, "").0, meaning(name, "").1),
                (Some(Quantity::Error), Some(unit)),
                "{name}"
            );
        }
        assert_eq!(
            meaning("phase error", "deg"),
            expected(Quantity::Error, Some(KnownUnit::Degree), "phase", "")
        );
    }

    #[test]
    fn unknown_names_have_no_meaning() {
        assert_eq!(meaning("torque", "%").0, None);
        assert_eq!(meaning("grad", "").0, None);
    }
}
