//! The type [`Setting`], a row in the settings table: reading, setting and checking its value. The
//! table itself is in `setting_table.rs`, a value's texts are in `setting_text.rs`. Two rows:
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
use gdcm_model::number_format::number;

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
            format!("a number in {}", self.unit.file)
        }
    }
}
