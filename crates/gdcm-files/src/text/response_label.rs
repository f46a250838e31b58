//! Which output over which input a response is, from the name of a column.

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
mod tests {
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
