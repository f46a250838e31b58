//! The type [`Setting`], a row in the settings table, and operations on it: setting, checking,
//! formatting and parsing a value. The table itself is in `setting_table.rs`. Two of its rows:
//!
//! ```text
//! name     confidence level                coherence threshold
//! key      error_bars.level                coherence_threshold
//! option   --level 0.95                    --coherence 0.6, --coherence on, --coherence off
//! unit     % shown, factor 100             none
//! kind     number from 0.5 to 0.999        number from 0 to 1, or no value: "off", "not used"
//! control  on its own line, one decimal    on its own line, if the dataset has coherences
//! ```
//!
//! `--coherence on` sets the default threshold (`on` in [`Kind::Optional`]). An option with a value
//! in `bare` may be given without an argument: `--schedule-delays` is `--schedule-delays=always`.

use gdcm_model::dataset::Band;
use gdcm_model::dataset::band::{GREATEST_OMEGA, LEAST_OMEGA};
use gdcm_model::number_format::{number, six_digits};

use super::edit_refusal::EditRefusal;
use super::setting_value::Value;
use super::settings::Settings;
use super::study::Study;

/// One setting: a row in [`SETTINGS`](super::setting_table::SETTINGS).
#[derive(Debug)]
pub struct Setting {
    /// Name in running text: "α of the gains".
    pub name: &'static str,
    /// Key in files; a dot separates keys in nested objects: "lead.n".
    pub key: &'static str,
    /// Command-line option: "--alpha".
    pub option: &'static str,
    /// Value that the option sets without an argument; `None` where an argument is required.
    pub bare: Option<&'static str>,
    pub unit: Unit,
    /// Value type and range.
    pub kind: Kind,
    /// Control in the window.
    pub control: Control,
}

/// A setting's unit in files and on the command line, and its displayed unit.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Unit in files.
    pub file: &'static str,
    /// Displayed unit.
    pub shown: &'static str,
    /// Factor from the file unit to the displayed unit.
    pub scale: f64,
}

/// The words for a value that is not a number.
#[derive(Clone, Copy, Debug)]
pub struct Words {
    /// Word on the command line.
    pub option: &'static str,
    /// Word in a sentence and in the window.
    pub sentence: &'static str,
}

impl Words {
    /// Creates the words on the command line and in a sentence.
    pub const fn new(option: &'static str, sentence: &'static str) -> Self {
        Self { option, sentence }
    }
}

/// A setting's type and range, with access to its field in [`Settings`].
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Number {
        range: [f64; 2],
        whole: bool,
        get: fn(&Settings) -> f64,
        set: fn(&mut Settings, f64),
    },
    /// A number within a range, or no value.
    Optional {
        range: [f64; 2],
        /// The words for no value.
        nothing: Words,
        /// Number that the argument "on" sets; `None` if "on" is not accepted.
        on: Option<f64>,
        get: fn(&Settings) -> Option<f64>,
        set: fn(&mut Settings, Option<f64>),
    },
    /// A lower and an upper number within a range, or no value.
    Range {
        range: [f64; 2],
        /// The words for no value.
        nothing: Words,
        get: fn(&Settings) -> Option<[f64; 2]>,
        set: fn(&mut Settings, Option<[f64; 2]>),
    },
    /// The comparison band, which always has a value. [`Band::new`] checks its ends, and describes
    /// their range in the refusal.
    Band {
        get: fn(&Settings) -> Band,
        set: fn(&mut Settings, Band),
    },
    Flag {
        /// The words in a sentence.
        no: &'static str,
        yes: &'static str,
        get: fn(&Settings) -> bool,
        set: fn(&mut Settings, bool),
    },
    Choice {
        /// The words for each choice.
        words: &'static [Words],
        get: fn(&Settings) -> usize,
        set: fn(&mut Settings, usize),
    },
}

impl Kind {
    /// Returns the range of a number or of both ends; `None` for flags and choices.
    pub fn range(self) -> Option<[f64; 2]> {
        match self {
            Self::Number { range, .. }
            | Self::Optional { range, .. }
            | Self::Range { range, .. } => Some(range),
            Self::Band { .. } => Some([LEAST_OMEGA, GREATEST_OMEGA]),
            Self::Flag { .. } | Self::Choice { .. } => None,
        }
    }
}

/// A setting's control in the window.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    pub place: Place,
    /// Change in the displayed value for each point dragged.
    pub step: f64,
    pub digits: Digits,
    /// Whether the setting has an effect in a study.
    pub applies: fn(&Study) -> bool,
}

/// Number format in the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Digits {
    /// Three significant digits.
    Significant,
    /// This number of decimals.
    Decimals(usize),
    /// A gain: three decimals, two if the third is zero; below 0.1, three significant digits.
    Gain,
}

/// Where a setting's control is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Above the settings table, with a slider.
    Slider,
    /// Above the settings table, on its own line.
    Top,
    /// In the settings table, on its own line.
    Line,
    /// On the previous setting's line.
    Beside,
    /// Outside the settings panel, in the view that the setting concerns.
    Elsewhere,
}

impl PartialEq for Setting {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl Setting {
    /// Returns the setting's value in `settings`.
    pub fn value(&self, settings: &Settings) -> Value {
        match self.kind {
            Kind::Number { get, .. } => Value::Number(get(settings)),
            Kind::Optional { get, .. } => get(settings).into(),
            Kind::Range { get, .. } => match get(settings) {
                Some(ends) => Value::Range(ends),
                None => Value::Nothing,
            },
            Kind::Band { get, .. } => get(settings).into(),
            Kind::Flag { get, .. } => Value::Flag(get(settings)),
            Kind::Choice { get, .. } => Value::Choice(get(settings)),
        }
    }

    /// Sets a value, or refuses a value outside its range and leaves the settings unchanged.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub(crate) fn set(&self, settings: &mut Settings, value: Value) -> Result<(), EditRefusal> {
        self.check(value)?;
        match (self.kind, value) {
            (Kind::Number { set, .. }, Value::Number(value)) => set(settings, value),
            (Kind::Optional { set, .. }, Value::Number(value)) => set(settings, Some(value)),
            (Kind::Optional { set, .. }, _) => set(settings, None),
            (Kind::Range { set, .. }, Value::Range(ends)) => set(settings, Some(ends)),
            (Kind::Range { set, .. }, _) => set(settings, None),
            (Kind::Band { set, .. }, Value::Range([min, max])) => {
                set(settings, Band::new(min, max)?);
            }
            (Kind::Flag { set, .. }, Value::Flag(value)) => set(settings, value),
            (Kind::Choice { set, .. }, Value::Choice(index)) => set(settings, index),
            // `check` refuses a value of another type.
            _ => {}
        }
        Ok(())
    }

    /// Checks a value's type and range.
    ///
    /// # Errors
    /// [`EditRefusal`] for a value that the setting does not allow.
    pub fn check(&self, value: Value) -> Result<(), EditRefusal> {
        match (self.kind, value) {
            (Kind::Number { range, whole, .. }, Value::Number(found)) => {
                self.check_number(found, range, whole)
            }
            (Kind::Optional { range, .. }, Value::Number(found)) => {
                self.check_number(found, range, false)
            }
            (Kind::Range { range, .. }, Value::Range(ends)) => self.check_ends(ends, range),
            (Kind::Band { .. }, Value::Range([min, max])) => {
                Band::new(min, max)?;
                Ok(())
            }
            (Kind::Choice { words, .. }, Value::Choice(index)) => {
                let range = [0.0, words.len() as f64 - 1.0];
                self.check_range("a whole number", index as f64, range)
            }
            (Kind::Flag { .. }, Value::Flag(_))
            | (Kind::Optional { .. } | Kind::Range { .. }, Value::Nothing) => Ok(()),
            (Kind::Flag { .. }, _) => Err(EditRefusal::NotAValue {
                setting: self.name,
                expected: "yes or no".to_owned(),
            }),
            _ => Err(EditRefusal::NotAValue {
                setting: self.name,
                expected: self.syntax(),
            }),
        }
    }

    fn check_number(&self, found: f64, range: [f64; 2], whole: bool) -> Result<(), EditRefusal> {
        if !whole {
            return self.check_range(&self.a_number(), found, range);
        }
        if found.fract() != 0.0 {
            return Err(self.out_of_range("a whole number", found, range));
        }
        self.check_range("a whole number", found, range)
    }

    fn check_ends(&self, ends: [f64; 2], range: [f64; 2]) -> Result<(), EditRefusal> {
        let [lower, upper] = ends;
        self.check_range("a lower end", lower, range)?;
        self.check_range("an upper end", upper, [lower, range[1]])
    }

    fn check_range(&self, what: &str, found: f64, range: [f64; 2]) -> Result<(), EditRefusal> {
        let is_within = (range[0]..=range[1]).contains(&found);
        if is_within {
            Ok(())
        } else {
            Err(self.out_of_range(what, found, range))
        }
    }

    fn out_of_range(&self, what: &str, found: f64, [least, most]: [f64; 2]) -> EditRefusal {
        let expected = format!("{what} from {} to {}", number(least), number(most));
        EditRefusal::OutOfRange {
            setting: self.name,
            expected,
            found,
        }
    }

    fn a_number(&self) -> String {
        if self.unit.file.is_empty() {
            "a number".to_owned()
        } else {
            format!("a number of {}", self.unit.file)
        }
    }

    /// Formats the setting's value in `settings`.
    pub fn current_text(&self, settings: &Settings) -> String {
        self.text(self.value(settings))
    }

    /// Formats a value, with at most six significant digits: "20 ms", "by the quantile", "median".
    pub fn text(&self, value: Value) -> String {
        let unit = match self.unit.shown {
            "" => String::new(),
            shown => format!(" {shown}"),
        };
        let shown = |value: f64| six_digits(self.unit.scale * value);
        match (self.kind, value) {
            (_, Value::Number(value)) => format!("{}{unit}", shown(value)),
            (_, Value::Range([lower, upper])) => {
                format!("{} to {}{unit}", shown(lower), shown(upper))
            }
            (Kind::Flag { yes, .. }, Value::Flag(true)) => yes.to_owned(),
            (Kind::Flag { no, .. }, Value::Flag(false)) => no.to_owned(),
            (Kind::Choice { words, .. }, Value::Choice(index)) => words[index].sentence.to_owned(),
            (Kind::Optional { nothing, .. } | Kind::Range { nothing, .. }, _) => {
                nothing.sentence.to_owned()
            }
            _ => String::new(),
        }
    }

    /// Returns the syntax of the option's argument: "none|delay|lead", "off|on|NUMBER".
    pub fn syntax(&self) -> String {
        match self.kind {
            Kind::Number { .. } => "NUMBER".to_owned(),
            Kind::Optional { nothing, on, .. } => {
                let on = if on.is_some() { "|on" } else { "" };
                format!("{}{on}|NUMBER", nothing.option)
            }
            Kind::Range { .. } | Kind::Band { .. } => "LO HI".to_owned(),
            Kind::Flag { .. } => String::new(),
            Kind::Choice { words, .. } => command_line_words(words).join("|"),
        }
    }

    /// Returns the option with its arguments for a value, such that [`Self::read`] returns the value;
    /// `None` for a flag that is not set, which no option expresses, and for a value that the
    /// setting does not allow.
    pub fn option_words(&self, value: Value) -> Option<Vec<String>> {
        let arguments = match (self.kind, value) {
            (Kind::Flag { .. }, Value::Flag(true)) => Vec::new(),
            (Kind::Flag { .. }, _) => return None,
            (_, Value::Number(value)) => vec![value.to_string()],
            (_, Value::Range(ends)) => ends.map(|end| end.to_string()).to_vec(),
            (Kind::Choice { words, .. }, Value::Choice(index)) => {
                vec![words.get(index)?.option.to_owned()]
            }
            (Kind::Optional { nothing, .. } | Kind::Range { nothing, .. }, _) => {
                vec![nothing.option.to_owned()]
            }
            _ => return None,
        };
        // The argument of an option that may stand alone is joined to it.
        if let ([argument], true) = (&arguments[..], self.bare.is_some()) {
            return Some(vec![format!("{}={argument}", self.option)]);
        }
        let mut words = vec![self.option.to_owned()];
        words.extend(arguments);
        Some(words)
    }

    /// Parses the value from the command line; a flag is set by its presence.
    ///
    /// The range of a whole number is checked here, so that its message states both type and range;
    /// the other ranges are checked when the value is set ([`Self::check`]).
    ///
    /// # Errors
    /// The expected values and the text found.
    pub fn read(&self, arguments: &[&str]) -> Result<Value, String> {
        match (self.kind, arguments) {
            (Kind::Flag { .. }, _) => Ok(Value::Flag(true)),
            (Kind::Number { range, whole, .. }, [text]) => {
                let number = if whole {
                    read_whole(text, range)?
                } else {
                    read_number(text)?
                };
                Ok(Value::Number(number))
            }
            (Kind::Optional { nothing, on, .. }, [text]) => read_optional(text, nothing.option, on),
            (Kind::Range { nothing, .. }, [word]) if nothing.option == *word => Ok(Value::Nothing),
            (Kind::Range { .. } | Kind::Band { .. }, [lower, upper]) => {
                Ok(Value::Range([read_number(lower)?, read_number(upper)?]))
            }
            (Kind::Choice { words, .. }, [text]) => read_choice(text, words),
            _ => Err(format!(
                "expected {}, found {}",
                self.syntax(),
                arguments.join(" ")
            )),
        }
    }
}

fn read_number(text: &str) -> Result<f64, String> {
    text.trim()
        .parse()
        .map_err(|_| format!("expected a number, found {text}"))
}

fn read_whole(text: &str, range: [f64; 2]) -> Result<f64, String> {
    let [least, most] = range;
    if let Ok(count) = text.trim().parse::<usize>() {
        let count = count as f64;
        if (least..=most).contains(&count) {
            return Ok(count);
        }
    }
    Err(format!(
        "expected a whole number from {least} to {most}, found {text}"
    ))
}

/// Parses a number, the word for no value, or "on" if it stands for a number.
fn read_optional(text: &str, nothing: &str, on: Option<f64>) -> Result<Value, String> {
    if text == nothing {
        return Ok(Value::Nothing);
    }
    if let Some(on) = on
        && text == "on"
    {
        return Ok(Value::Number(on));
    }
    text.trim().parse().map(Value::Number).map_err(|_| {
        let on = if on.is_some() { ", on" } else { "" };
        format!("expected {nothing}{on} or a number, found {text}")
    })
}

fn read_choice(text: &str, words: &[Words]) -> Result<Value, String> {
    let words = command_line_words(words);
    if let Some(index) = words.iter().position(|word| *word == text) {
        return Ok(Value::Choice(index));
    }
    let (last, others) = words.split_last().unwrap_or((&"", &[]));
    let others = others.join(", ");
    Err(format!("expected {others} or {last}, found {text}"))
}

/// Returns the words for the choices on the command line.
fn command_line_words(words: &[Words]) -> Vec<&'static str> {
    words.iter().map(|word| word.option).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decisions::setting_table::{BAND, COHERENCE, DELAY_UPPER};

    #[test]
    fn spaces_around_a_number_are_ignored_also_where_the_number_is_optional() {
        assert_eq!(DELAY_UPPER.read(&[" 0.05 "]), Ok(Value::Number(0.05)));
        assert_eq!(COHERENCE.read(&["0.5 "]), Ok(Value::Number(0.5)));
        assert!(DELAY_UPPER.read(&["0.05 s"]).is_err());
    }

    #[test]
    fn the_band_needs_two_ends() {
        assert!(BAND.check(Value::Range([0.5, 12.0])).is_ok());
        assert!(BAND.check(Value::Range([12.0, 0.5])).is_err());
        assert!(BAND.check(Value::Nothing).is_err());
        assert!(BAND.read(&["auto"]).is_err());
        assert_eq!(BAND.option_words(Value::Nothing), None);
    }
}
