//! Meaning of the columns of a frequency response, from names and units.

use gdcm_model::names::{KnownChannels, ResponseName};
use gdcm_model::units::physical_unit::PhysicalUnit;

/// Quantity in a column of a frequency response.
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
    Percent,
    /// The coherence γ itself, not its square γ².
    Gamma,
    /// The squared coherence γ².
    GammaSquared,
    /// `rps`: radians or revolutions per second, ambiguous.
    Rps,
    /// Another unit, of a magnitude, a real or an imaginary part.
    Other,
}

/// Meaning of the name and the unit of a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColumnMeaning {
    pub(super) quantity: Option<Quantity>,
    pub(super) unit: Option<KnownUnit>,
    pub(super) label: ResponseLabel,
    /// The reason: "its name says phase".
    pub(super) reason: String,
}

/// Words in column names. The first kind with a matching word applies: "phase error" is an error.
const WORDS: [(Quantity, &[&str]); 7] = [
    (
        Quantity::Error,
        &[
            "error",
            "err",
            "std",
            "sd",
            "stdev",
            "stddev",
            "deviation",
            "sigma",
            "uncertainty",
            "eps",
        ],
    ),
    (
        Quantity::Coherence,
        &[
            "coherence",
            "coher",
            "coh",
            "gamma",
            "gamma2",
            "gam",
            "gam2",
            "gammasq",
            "γ",
            "γ²",
            "γ2",
            "cxy",
        ],
    ),
    (
        Quantity::Magnitude,
        &[
            "magnitude",
            "mag",
            "amplitude",
            "ampl",
            "amp",
            "gain",
            "abs",
            "modulus",
        ],
    ),
    (
        Quantity::Phase,
        &["phase", "phas", "phs", "pha", "ph", "angle", "arg"],
    ),
    (Quantity::Real, &["real", "re"]),
    (Quantity::Imaginary, &["imaginary", "imag", "img", "im"]),
    (
        Quantity::Frequency,
        &[
            "frequency",
            "frequencies",
            "freq",
            "frq",
            "omega",
            "om",
            "ω",
        ],
    ),
];

/// Units at the end of a name without brackets.
const UNIT_ENDINGS: [(&str, KnownUnit); 13] = [
    ("rad/s", KnownUnit::RadianPerSecond),
    ("rad/sec", KnownUnit::RadianPerSecond),
    ("rad_s", KnownUnit::RadianPerSecond),
    ("rad_sec", KnownUnit::RadianPerSecond),
    ("rads", KnownUnit::RadianPerSecond),
    ("rps", KnownUnit::Rps),
    ("hz", KnownUnit::Hertz),
    ("db", KnownUnit::Decibel),
    ("deg", KnownUnit::Degree),
    ("rad", KnownUnit::Radian),
    ("percent", KnownUnit::Percent),
    ("pct", KnownUnit::Percent),
    ("%", KnownUnit::Percent),
];

impl ColumnMeaning {
    /// Interprets the name and the unit of a column.
    pub(super) fn of(name: &str, unit: Option<&str>) -> Self {
        let (name, unit) = match unit {
            Some(unit) => (name, Some(known_unit(unit))),
            None => unit_at_end(name),
        };
        let lower = name.trim().to_lowercase();
        let sole = match lower.as_str() {
            "w" if !matches!(unit, Some(KnownUnit::Other)) => {
                Some((Quantity::Frequency, Some(KnownUnit::RadianPerSecond)))
            }
            // In frequency tables f is in Hz as often as in rad/s, so the user is asked for its
            // unit.
            "f" if !matches!(unit, Some(KnownUnit::Other)) => Some((Quantity::Frequency, None)),
            _ => None,
        };
        if let Some((quantity, usual)) = sole {
            let reason = format!("its name is \"{name}\"");
            return Self {
                quantity: Some(quantity),
                unit: unit.or(usual),
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
                known.contains(&word)
                    || known.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit()))
            };
            if let Some((_, word)) = words.iter().find(|(_, word)| is(&word.to_lowercase())) {
                let reason = format!("its name says {}", word.to_lowercase());
                let label = without(name, &words, known);
                let unit = unit.or_else(|| usual_unit(quantity, word, &words));
                return Self {
                    quantity: Some(quantity),
                    unit,
                    label: ResponseLabel::of(&label),
                    reason,
                };
            }
        }
        let strokes =
            name.trim().len() > 2 && name.trim().starts_with('|') && name.trim().ends_with('|');
        let (quantity, reason) = match unit {
            Some(KnownUnit::Decibel) => (Some(Quantity::Magnitude), "its unit is dB"),
            Some(KnownUnit::Degree) => (Some(Quantity::Phase), "its unit is an angle"),
            Some(KnownUnit::Hertz) => (Some(Quantity::Frequency), "its unit is Hz"),
            Some(KnownUnit::RadianPerSecond) if name.trim().is_empty() => {
                (Some(Quantity::Frequency), "its unit is rad/s")
            }
            _ if strokes => (Some(Quantity::Magnitude), "its name stands between strokes"),
            _ if name.contains('∠') => {
                (Some(Quantity::Phase), "its name has the sign of an angle")
            }
            _ => (None, ""),
        };
        Self {
            quantity,
            unit,
            label: ResponseLabel::of(name),
            reason: reason.to_owned(),
        }
    }
}

/// Words for magnitudes that are not in decibels.
const ABSOLUTE: [&str; 6] = ["abs", "absolute", "lin", "linear", "ratio", "modulus"];

/// Returns the unit implied by the words of a name; `word` is the word that gives the quantity.
fn usual_unit(quantity: Quantity, word: &str, words: &[(usize, &str)]) -> Option<KnownUnit> {
    let word = word.to_lowercase();
    match quantity {
        Quantity::Frequency if matches!(word.as_str(), "omega" | "om" | "ω") => {
            Some(KnownUnit::RadianPerSecond)
        }
        Quantity::Magnitude
            if words
                .iter()
                .any(|(_, word)| ABSOLUTE.contains(&word.to_lowercase().as_str())) =>
        {
            Some(KnownUnit::Other)
        }
        // Programs call both γ and γ² gamma.
        Quantity::Coherence if !matches!(word.as_str(), "gamma" | "gam" | "γ") => {
            Some(KnownUnit::GammaSquared)
        }
        _ => None,
    }
}

fn known_unit(unit: &str) -> KnownUnit {
    match unit.trim().to_lowercase().replace([' ', '.'], "").as_str() {
        "gamma" | "γ" => return KnownUnit::Gamma,
        "gamma2" | "gamma^2" | "γ²" | "γ2" | "γ^2" => return KnownUnit::GammaSquared,
        "rps" => return KnownUnit::Rps,
        "rev/s" | "rev/sec" => return KnownUnit::Hertz,
        // Only for columns of frequencies.
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
        Some("%") => KnownUnit::Percent,
        _ => KnownUnit::Other,
    }
}

/// Splits a unit off the end of a name: "mag_dB", "freqHz", "w_rad_s".
fn unit_at_end(name: &str) -> (&str, Option<KnownUnit>) {
    let name = name.trim();
    for (ending, unit) in UNIT_ENDINGS {
        let cut = name
            .len()
            .checked_sub(ending.len())
            .filter(|&at| name.is_char_boundary(at));
        let Some((front, end)) = cut.map(|at| name.split_at(at)) else {
            continue;
        };
        if !end.eq_ignore_ascii_case(ending) {
            continue;
        }
        let between = front.is_empty() || front.ends_with(['_', ' ', '-', '.', '/', ',']);
        let word = front.to_lowercase();
        let glued = WORDS.iter().any(|(_, known)| {
            known
                .iter()
                .any(|known| known.len() > 1 && word.ends_with(known))
        });
        if between || glued {
            return (
                front.trim_end_matches(['_', ' ', '-', '.', '/', ',']),
                Some(unit),
            );
        }
    }
    (name, None)
}

/// Returns the words of a name and their offsets.
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

/// Returns a name without the words of one kind; digits after such a word are kept, as in "re1".
fn without(name: &str, words: &[(usize, &str)], known: &[&str]) -> String {
    let mut label = String::with_capacity(name.len());
    let mut from = 0;
    for (start, word) in words {
        let stem = word.trim_end_matches(|c: char| c.is_ascii_digit());
        let length = match (
            known.contains(&word.to_lowercase().as_str()),
            known.contains(&stem.to_lowercase().as_str()),
        ) {
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

/// Output and input of a response, as far as its name gives them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ResponseLabel {
    pub(super) output: Option<String>,
    pub(super) input: Option<String>,
}

/// Response names that identify no channel.
const ANY_RESPONSE: [&str; 9] = [
    "h", "g", "frf", "tf", "fr", "resp", "response", "h(jw)", "g(jw)",
];
/// Separators between an input and the following output.
const FORWARD: [&str; 5] = ["->", "→", "=>", ">", " to "];
/// Separators between an output and its input.
const BACKWARD: [&str; 6] = ["<-", "←", "/", " due to ", " from ", " over "];

impl ResponseLabel {
    /// Parses "P/LAT", "LAT->P", "LAT to P", "P_LAT"; any other text names the output.
    pub(super) fn of(text: &str) -> Self {
        let text = clean(text);
        if ANY_RESPONSE.contains(&text.to_lowercase().as_str()) {
            return Self::default();
        }
        let part = |part: &str| Some(clean(part).to_owned()).filter(|part| !part.is_empty());
        for sign in BACKWARD {
            if let Some((output, input)) = text.split_once(sign) {
                return Self {
                    output: part(output),
                    input: part(input),
                };
            }
        }
        for sign in FORWARD {
            if let Some((input, output)) = text.split_once(sign) {
                return Self {
                    output: part(output),
                    input: part(input),
                };
            }
        }
        // Common names in the field: "q_delta_lon", "roll_rate".
        let known = ResponseName::find(text, KnownChannels::Field).unwrap_or_default();
        let is_whole = |name: &Option<String>| name.as_deref() == Some(text);
        if known.output.is_some() && known.input.is_some()
            || is_whole(&known.output)
            || is_whole(&known.input)
        {
            return Self {
                output: known.output,
                input: known.input,
            };
        }
        match text.split_once('_') {
            Some((output, input)) if !input.contains('_') => Self {
                output: part(output),
                input: part(input),
            },
            _ => Self {
                output: part(text),
                input: None,
            },
        }
    }
}

/// Returns a text without surrounding brackets, strokes and blanks.
fn clean(text: &str) -> &str {
    text.trim_matches(|c: char| c.is_whitespace() || "_-.,:;(){}[]|∠=\"'".contains(c))
}

#[cfg(test)]
mod column_meaning_tests {
    use super::*;

    fn of(name: &str, unit: &str) -> (Option<Quantity>, Option<KnownUnit>, String, String) {
        let meaning = ColumnMeaning::of(name, Some(unit).filter(|unit| !unit.is_empty()));
        let ResponseLabel { output, input } = meaning.label;
        (
            meaning.quantity,
            meaning.unit,
            output.unwrap_or_default(),
            input.unwrap_or_default(),
        )
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
        let radians = is(
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
            assert_eq!(of(name, unit), radians, "{name}");
        }
        let hertz = is(Quantity::Frequency, Some(KnownUnit::Hertz), "", "");
        for (name, unit) in [
            ("f_Hz", ""),
            ("freqHz", ""),
            ("Freq", "Hz"),
            ("f", "Hz"),
            ("f", "rev/s"),
        ] {
            assert_eq!(of(name, unit), hertz, "{name}");
        }
        for name in ["f", "freq"] {
            assert_eq!(
                of(name, ""),
                is(Quantity::Frequency, None, "", ""),
                "{name}"
            );
        }
        let open = is(Quantity::Frequency, Some(KnownUnit::Rps), "", "");
        for (name, unit) in [("freq_rps", ""), ("omega", "rps"), ("f", "rps")] {
            assert_eq!(of(name, unit), open, "{name}");
        }
        assert_eq!(of("w", "m/s").0, None);
    }

    #[test]
    fn the_response_is_read_from_what_is_left_of_the_name() {
        let decibel = Some(KnownUnit::Decibel);
        assert_eq!(
            of("mag P/LAT", "dB"),
            is(Quantity::Magnitude, decibel, "P", "LAT")
        );
        assert_eq!(of("P_LAT_re", ""), is(Quantity::Real, None, "P", "LAT"));
        assert_eq!(of("re(LAT->P)", ""), is(Quantity::Real, None, "P", "LAT"));
        assert_eq!(
            of("P/LAT_mag_dB", ""),
            is(Quantity::Magnitude, decibel, "P", "LAT")
        );
        assert_eq!(
            of("P/LAT", "deg"),
            is(Quantity::Phase, Some(KnownUnit::Degree), "P", "LAT")
        );
        assert_eq!(
            of("phasedeg", ""),
            is(Quantity::Phase, Some(KnownUnit::Degree), "", "")
        );
        assert_eq!(of("Im1", ""), is(Quantity::Imaginary, None, "1", ""));
        assert_eq!(of("|P/LAT|", ""), is(Quantity::Magnitude, None, "P", "LAT"));
        assert_eq!(
            of("|H|", "dB"),
            is(Quantity::Magnitude, decibel, "", ""),
            "the file says whose it is"
        );
        assert_eq!(
            of("ph", "deg"),
            is(Quantity::Phase, Some(KnownUnit::Degree), "", "")
        );
        let squared = is(Quantity::Coherence, Some(KnownUnit::GammaSquared), "", "");
        for (name, unit) in [
            ("Gamma2", ""),
            ("COHER", ""),
            ("γ²", ""),
            ("coherence", ""),
            ("gamma", "gamma2"),
        ] {
            assert_eq!(of(name, unit), squared, "{name}");
        }
        assert_eq!(
            of("gamma", ""),
            is(Quantity::Coherence, None, "", ""),
            "γ or γ²"
        );
        assert_eq!(
            of("gamma", "gamma"),
            is(Quantity::Coherence, Some(KnownUnit::Gamma), "", "")
        );
        assert_eq!(
            of("gain Q/LON", ""),
            is(Quantity::Magnitude, None, "Q", "LON"),
            "dB or a ratio"
        );
        for name in ["mag_abs", "abs", "gain_abs", "|H| abs"] {
            assert_eq!(of(name, "").1, Some(KnownUnit::Other), "{name}");
        }
        for (name, unit) in [
            ("sd_mag_dB", KnownUnit::Decibel),
            ("sd_phase_deg", KnownUnit::Degree),
        ] {
            assert_eq!(
                (of(name, "").0, of(name, "").1),
                (Some(Quantity::Error), Some(unit)),
                "{name}"
            );
        }
        assert_eq!(
            of("phase error", "deg"),
            is(Quantity::Error, Some(KnownUnit::Degree), "phase", "")
        );
    }

    #[test]
    fn a_name_that_says_nothing_has_no_meaning() {
        assert_eq!(of("torque", "%").0, None);
        assert_eq!(of("grad", "").0, None);
    }
}

#[cfg(test)]
mod response_label_tests {
    use super::*;

    #[test]
    fn the_ways_of_naming_a_response_are_read() {
        let read = |text| {
            let ResponseLabel { output, input } = ResponseLabel::of(text);
            (output.unwrap_or_default(), input.unwrap_or_default())
        };
        let expected = ("P".to_owned(), "LAT".to_owned());
        for text in [
            "P/LAT",
            "(LAT->P)",
            "LAT → P",
            "LAT to P",
            "P <- LAT",
            "P due to LAT",
            "|P / LAT|",
        ] {
            assert_eq!(read(text), expected, "{text}");
        }
        assert_eq!(read("P_LAT"), expected);
        assert_eq!(
            read("q_delta_lon"),
            ("q".to_owned(), "delta_lon".to_owned())
        );
        assert_eq!(read("q per lon"), ("q".to_owned(), "lon".to_owned()));
        assert_eq!(read("roll_rate"), ("roll_rate".to_owned(), String::new()));
        assert_eq!(read("delta_lon"), (String::new(), "delta_lon".to_owned()));
        assert_eq!(read(" P_"), ("P".to_owned(), String::new()));
        assert_eq!(read("a_b_c").0, "a_b_c");
        assert_eq!(ResponseLabel::of("()"), ResponseLabel::default());
    }
}
