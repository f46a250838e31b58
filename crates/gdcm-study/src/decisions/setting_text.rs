//! A setting's value as text: in a sentence and in the window, and as a command-line option.

use gdcm_model::number_format::six_digits;

use super::setting::{Kind, Setting, Words};
use super::setting_value::Value;
use super::settings::Settings;

impl Setting {
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

    /// Returns the option with its arguments for a value, such that [`Self::read`] returns the
    /// value; `None` for a flag that is not set, which no option expresses, and for a value that
    /// the setting does not allow.
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
