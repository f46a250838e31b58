//! Output and input of a response from the name of its file or variable: `frf_q_delta_lon`,
//! `roll_rate per lat_cyclic run 2`.

use std::collections::BTreeSet;

use super::channel_match::{
    FIELD_INPUTS, SignedName, canonical, field_names, folded_name, same_channel,
};
use super::physical_unit::{Dimension, PhysicalUnit};
use super::rules::ChannelRule;

/// Maximum number of words combined into the name of one channel.
const LONGEST_NAME: usize = 4;
/// Maximum number of words considered in a text.
const MOST_WORDS: usize = 64;

/// Words that describe the content of a file but none of its channels. Words with other numbers and
/// units are ignored too.
const NO_CHANNEL: [&str; 44] = [
    "frf",
    "fr",
    "tf",
    "frd",
    "resp",
    "response",
    "bode",
    "h",
    "g",
    "per",
    "to",
    "from",
    "over",
    "by",
    "due",
    "of",
    "vs",
    "in",
    "out",
    "input",
    "output",
    "axis",
    "run",
    "rec",
    "record",
    "test",
    "flight",
    "flt",
    "sweep",
    "doublet",
    "hover",
    "cruise",
    "meas",
    "measured",
    "id",
    "ident",
    "identified",
    "cond",
    "case",
    "and",
    "at",
    "data",
    "stick",
    "file",
];

/// Words that turn an adjacent channel into a different one: the derivative of q is not q.
const CHANGES_CHANNEL: [&str; 23] = [
    "dot",
    "ddot",
    "deriv",
    "derivative",
    "diff",
    "rate",
    "accel",
    "acceleration",
    "int",
    "integral",
    "cmd",
    "command",
    "commanded",
    "ref",
    "reference",
    "des",
    "desired",
    "demand",
    "err",
    "error",
    "bias",
    "sum",
    "delta",
];

/// An output and an input in the words of the text, as far as the text names them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ResponseName {
    /// The output: "q", "roll_rate".
    pub output: Option<String>,
    /// The input: "delta_lon".
    pub input: Option<String>,
}

/// Why a text does not name one output and one input.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ResponseNameError {
    /// Several outputs, or several inputs.
    #[error("it names several {side}s: {found}")]
    Several {
        /// "output" or "input".
        side: &'static str,
        found: String,
    },
    /// A word beside a channel that may turn it into a different channel.
    #[error("\"{word}\" beside {channel} may make another channel of it")]
    OtherChannel {
        word: String,
        /// The channel in the words of the text.
        channel: String,
    },
}

/// The channels that a text may name.
#[derive(Clone, Copy, Debug)]
pub enum KnownChannels<'r> {
    /// The channels of a dataset, by their names, aliases and synonyms in the field.
    Dataset {
        inputs: &'r [ChannelRule],
        outputs: &'r [ChannelRule],
    },
    /// All channels with a name in the field.
    Field,
}

/// The canonical names of the known channels.
enum KnownNames {
    Dataset {
        inputs: BTreeSet<String>,
        outputs: BTreeSet<String>,
    },
    Field,
}

impl KnownNames {
    fn of(known: KnownChannels<'_>) -> Self {
        let names = |rules: &[ChannelRule]| {
            let each = rules
                .iter()
                .flat_map(|rule| std::iter::once(&rule.name).chain(&rule.aliases));
            each.map(|name| canonical(&SignedName::of(name).name))
                .collect()
        };
        match known {
            KnownChannels::Dataset { inputs, outputs } => Self::Dataset {
                inputs: names(inputs),
                outputs: names(outputs),
            },
            KnownChannels::Field => Self::Field,
        }
    }

    /// Returns whether a name denotes an output, and whether it denotes an input.
    fn sides(&self, name: &str) -> Sides {
        match self {
            Self::Dataset { inputs, outputs } => {
                let name = canonical(name);
                Sides {
                    output: outputs.contains(&name),
                    input: inputs.contains(&name),
                }
            }
            Self::Field => {
                let folded = folded_name(name);
                let row = field_names().position(|mut names| names.any(|known| known == folded));
                Sides {
                    output: row.is_some_and(|row| row >= FIELD_INPUTS),
                    input: row.is_some_and(|row| row < FIELD_INPUTS),
                }
            }
        }
    }
}

/// The sides that have a channel of a given name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sides {
    output: bool,
    input: bool,
}

/// A channel named by one or more words of a text.
struct NamedChannel<'t> {
    /// Half-open range of word indices.
    words: std::ops::Range<usize>,
    text: &'t str,
    sides: Sides,
}

impl ResponseName {
    /// Finds the channels that a text names.
    ///
    /// 1. Split the text into words.
    /// 2. From the left, take the longest run of words that together name a known channel.
    /// 3. A name that fits both sides is read as "output input", or as "input to output" where "to"
    ///    separates them.
    ///
    /// # Errors
    /// The text names several outputs or inputs, or a word beside a channel may turn it into a
    /// different one.
    pub fn find(text: &str, known: KnownChannels<'_>) -> Result<Self, ResponseNameError> {
        let words = words_of(text);
        let named = named_channels(text, &words, &KnownNames::of(known));
        let Some(last) = named.last() else {
            return Ok(Self::default());
        };
        let begins = named[0].words.start;
        let ends = last.words.end;
        for (index, word) in words.iter().enumerate() {
            let is_named = named.iter().any(|channel| channel.words.contains(&index));
            if is_named || says_no_channel(word.text) {
                continue;
            }
            let is_between = begins < index && index < ends;
            if is_between || CHANGES_CHANNEL.contains(&word.text.to_lowercase().as_str()) {
                let before = named
                    .iter()
                    .rev()
                    .find(|channel| channel.words.start < index);
                let channel = before.unwrap_or(&named[0]).text.to_owned();
                return Err(ResponseNameError::OtherChannel {
                    word: word.text.to_owned(),
                    channel,
                });
            }
        }
        if let [first, second] = named.as_slice()
            && [first, second]
                .iter()
                .all(|channel| channel.sides.output && channel.sides.input)
        {
            let between = &words[first.words.end..second.words.start];
            let input_first = between
                .iter()
                .any(|word| word.text.eq_ignore_ascii_case("to"));
            let (output, input) = if input_first {
                (second, first)
            } else {
                (first, second)
            };
            return Ok(Self {
                output: Some(output.text.to_owned()),
                input: Some(input.text.to_owned()),
            });
        }
        let outputs: Vec<&NamedChannel<'_>> = named
            .iter()
            .filter(|channel| channel.sides.output)
            .collect();
        let inputs: Vec<&NamedChannel<'_>> =
            named.iter().filter(|channel| channel.sides.input).collect();
        // A name that fits both sides takes the side left open by the others.
        let only = |side: &'static str,
                    of_side: &[&NamedChannel<'_>],
                    is_other: fn(Sides) -> bool| {
            let sure: Vec<&str> = of_side
                .iter()
                .filter(|channel| !is_other(channel.sides))
                .map(|channel| channel.text)
                .collect();
            let open: Vec<&str> = of_side.iter().map(|channel| channel.text).collect();
            let names = if sure.is_empty() { open } else { sure };
            match names.split_first() {
                None => Ok(None),
                Some((first, others)) if others.iter().all(|other| same_channel(first, other)) => {
                    Ok(Some((*first).to_owned()))
                }
                Some(_) => Err(ResponseNameError::Several {
                    side,
                    found: names.join(", "),
                }),
            }
        };
        Ok(Self {
            output: only("output", &outputs, |sides| sides.input)?,
            input: only("input", &inputs, |sides| sides.output)?,
        })
    }
}

/// A word and its start position in the text.
struct Word<'t> {
    start: usize,
    text: &'t str,
}

fn words_of(text: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    let mut start = None;
    for (place, letter) in text.char_indices().chain([(text.len(), ' ')]) {
        let is_inside = place < text.len() && letter.is_alphanumeric();
        match (start, is_inside) {
            (None, true) => start = Some(place),
            (Some(from), false) => {
                words.push(Word {
                    start: from,
                    text: &text[from..place],
                });
                start = None;
            }
            _ => {}
        }
    }
    words.truncate(MOST_WORDS);
    words
}

fn named_channels<'t>(
    text: &'t str,
    words: &[Word<'t>],
    known: &KnownNames,
) -> Vec<NamedChannel<'t>> {
    let mut named = Vec::new();
    let mut first = 0;
    while first < words.len() {
        let longest = (words.len() - first).min(LONGEST_NAME);
        let found = (1..=longest).rev().find_map(|count| {
            let last = &words[first + count - 1];
            let name = &text[words[first].start..last.start + last.text.len()];
            let sides = known.sides(name);
            let words = first..first + count;
            (sides.output || sides.input).then_some(NamedChannel {
                words,
                text: name,
                sides,
            })
        });
        match found {
            Some(channel) => {
                first = channel.words.end;
                named.push(channel);
            }
            None => first += 1,
        }
    }
    named
}

/// Returns whether a word is a number, a unit with or without a number, or a description of the
/// file's content: "run2", "60kt", "v2".
fn says_no_channel(word: &str) -> bool {
    let word = word.to_lowercase();
    let plain = word.trim_matches(|letter: char| letter.is_ascii_digit());
    let is_unit = PhysicalUnit::of(plain).is_some_and(|unit| {
        matches!(
            unit.dimension,
            Dimension::Speed | Dimension::Length | Dimension::Level | Dimension::Frequency
        )
    });
    let is_number = plain.len() < word.len() && plain.len() <= 1;
    plain.is_empty() || is_number || is_unit || NO_CHANNEL.contains(&plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(names: &[&str]) -> Vec<ChannelRule> {
        names.iter().map(|name| ChannelRule::named(*name)).collect()
    }

    fn read(text: &str) -> Result<(String, String), ResponseNameError> {
        let inputs = rules(&["LON", "LAT", "PED", "COL"]);
        let outputs = rules(&["P", "Q", "R", "NZ"]);
        let name = ResponseName::find(
            text,
            KnownChannels::Dataset {
                inputs: &inputs,
                outputs: &outputs,
            },
        )?;
        Ok((
            name.output.unwrap_or_default(),
            name.input.unwrap_or_default(),
        ))
    }

    #[test]
    fn names_of_files_are_matched_against_the_channels_longest_first() {
        for (text, output, input) in [
            ("frf_q_delta_lon", "q", "delta_lon"),
            ("q_per_lon", "q", "lon"),
            ("frf_q_lon_run2", "q", "lon"),
            ("frf_roll_rate_lat_cyclic", "roll_rate", "lat_cyclic"),
            ("frf LAT to P", "P", "LAT"),
            ("Q_LON", "Q", "LON"),
            ("c03-60kt-nz-col-v2", "nz", "col"),
            ("sweepA_q_lon", "q", "lon"),
            ("p_60kt_theta0", "p", "theta0"),
            ("q_over_xb_lon", "q", "xb"),
            ("frf_yaw_rate", "yaw_rate", ""),
            ("delta_lon", "", "delta_lon"),
            ("broken", "", ""),
            ("", "", ""),
        ] {
            assert_eq!(
                read(text),
                Ok((output.to_owned(), input.to_owned())),
                "{text}"
            );
        }
    }

    #[test]
    fn what_names_another_or_several_channels_is_asked_about() {
        for text in ["frf_q_dot_lon", "q_lon_cmd", "q_imu_lon"] {
            assert!(
                matches!(read(text), Err(ResponseNameError::OtherChannel { .. })),
                "{text}: {:?}",
                read(text)
            );
        }
        for (text, side) in [("p_q_lon", "output"), ("q_lon_lat", "input")] {
            assert!(
                matches!(read(text), Err(ResponseNameError::Several { side: of, .. }) if of == side),
                "{text}"
            );
        }
        assert_eq!(
            read("q_Q_lon"),
            Ok(("q".to_owned(), "lon".to_owned())),
            "one channel named twice"
        );
    }

    #[test]
    fn names_and_aliases_of_the_rules_are_known_and_order_tells_what_can_be_both() {
        let inputs = [ChannelRule {
            aliases: vec!["boost lon".into()],
            ..ChannelRule::named("u1")
        }];
        let outputs = [ChannelRule::named("y_2")];
        let find = |text, inputs, outputs| {
            ResponseName::find(text, KnownChannels::Dataset { inputs, outputs }).unwrap()
        };
        let name = find("frf_y_2_boost_lon", &inputs[..], &outputs[..]);
        assert_eq!(
            (name.output.as_deref(), name.input.as_deref()),
            (Some("y_2"), Some("boost_lon"))
        );
        let both = rules(&["roll", "pitch"]);
        let name = find("roll_pitch", &both[..], &both[..]);
        assert_eq!(
            (name.output.as_deref(), name.input.as_deref()),
            (Some("roll"), Some("pitch"))
        );
        let name = find("roll to pitch", &both[..], &both[..]);
        assert_eq!(
            (name.output.as_deref(), name.input.as_deref()),
            (Some("pitch"), Some("roll"))
        );
        let name = ResponseName::find("mag roll_rate xb", KnownChannels::Field).unwrap();
        assert_eq!(
            (name.output.as_deref(), name.input.as_deref()),
            (Some("roll_rate"), Some("xb"))
        );
    }
}
