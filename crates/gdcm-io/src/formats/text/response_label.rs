//! A response's output and input, as named in a column heading: in "phase P/LAT", output P and
//! input LAT.

use gdcm_model::names::response_name::{KnownChannels, ResponseName};

/// A response's output and input, where its name gives them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ResponseLabel {
    pub(super) output: Option<String>,
    pub(super) input: Option<String>,
}

/// Names that denote a response without naming its channels.
const ANY_RESPONSE: [&str; 9] = [
    "h", "g", "frf", "tf", "fr", "resp", "response", "h(jw)", "g(jw)",
];
/// Separators between an input and the output that follows it.
const FORWARD: [&str; 5] = ["->", "→", "=>", ">", " to "];
/// Separators between an output and the input that follows it.
const BACKWARD: [&str; 6] = ["<-", "←", "/", " due to ", " from ", " over "];

impl ResponseLabel {
    /// Parses a response name. The first that applies:
    ///
    /// 1. "frf" and similar words (`ANY_RESPONSE`): no channel;
    /// 2. output and input, as in "P/LAT" (`BACKWARD`);
    /// 3. input and output, as in "LAT->P" or "LAT to P" (`FORWARD`);
    /// 4. a name that is common in flight dynamics, such as "roll_rate";
    /// 5. output and input around a single underscore, as in "P_LAT";
    /// 6. anything else: an output name.
    pub(super) fn parse(text: &str) -> Self {
        let text = clean(text);
        if ANY_RESPONSE.contains(&text.to_lowercase().as_str()) {
            return Self::default();
        }
        for separator in BACKWARD {
            if let Some((output, input)) = text.split_once(separator) {
                return Self::from_parts(output, input);
            }
        }
        for separator in FORWARD {
            if let Some((input, output)) = text.split_once(separator) {
                return Self::from_parts(output, input);
            }
        }
        if let Some(label) = Self::from_field_name(text) {
            return label;
        }
        match text.split_once('_') {
            Some((output, input)) if !input.contains('_') => Self::from_parts(output, input),
            _ => Self::from_parts(text, ""),
        }
    }

    /// Creates a label from output and input texts, either of which may be empty.
    fn from_parts(output: &str, input: &str) -> Self {
        Self {
            output: channel(output),
            input: channel(input),
        }
    }

    /// Parses a name that is common in flight dynamics, such as "q_delta_lon" or "roll_rate";
    /// `None` for any other name.
    fn from_field_name(text: &str) -> Option<Self> {
        let ResponseName { output, input } =
            ResponseName::find(text, KnownChannels::AliasTable).ok()?;
        let names_both = output.is_some() && input.is_some();
        let is_channel = output.as_deref() == Some(text) || input.as_deref() == Some(text);
        if names_both || is_channel {
            Some(Self { output, input })
        } else {
            None
        }
    }
}

/// Returns the channel in a name part; `None` if only brackets, punctuation and blanks remain.
fn channel(part: &str) -> Option<String> {
    let channel = clean(part);
    if channel.is_empty() {
        None
    } else {
        Some(channel.to_owned())
    }
}

/// Removes brackets, punctuation and blanks at both ends of a text.
fn clean(text: &str) -> &str {
    text.trim_matches(|c: char| c.is_whitespace() || "_-.,:;(){}[]|∠=\"'".contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn response_names_are_parsed() {
        let read = |text| {
            let ResponseLabel { output, input } = ResponseLabel::parse(text);
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
        assert_eq!(ResponseLabel::parse("()"), ResponseLabel::default());
    }
}
