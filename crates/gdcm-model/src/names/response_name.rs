//! Output and input of a response, read from its file or variable name: `frf_q_delta_lon`,
//! `roll_rate per lat_cyclic run 2`. The channels in the name are found in `named_channel.rs`.

pub use super::named_channel::KnownChannels;

use super::channel_alias::same_channel;
use super::named_channel::{NamedChannel, Word, named_channels, split_words};
use crate::dataset::channel::ChannelSide;
use crate::units::physical_unit::{Dimension, PhysicalUnit};

/// Output and input named in a text, in its spelling; `None` if the text does not name them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ResponseName {
    /// "q", "roll_rate".
    pub output: Option<String>,
    /// "delta_lon".
    pub input: Option<String>,
}

/// Error for a text that does not name one output and one input unambiguously.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ResponseNameError {
    #[error("it names several {side}s ({found})")]
    Several {
        /// "output" or "input".
        side: &'static str,
        /// Channels as spelt in the text, separated by commas.
        found: String,
    },
    #[error("the word \"{word}\" next to {channel} may change the meaning of {channel}")]
    OtherChannel {
        word: String,
        /// Channel as spelt in the text.
        channel: String,
    },
}

impl ResponseNameError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Several { .. } => "several-channels",
            Self::OtherChannel { .. } => "other-channel",
        }
    }
}

impl ResponseName {
    /// Finds the channels named in a text.
    ///
    /// 1. Split the text into words.
    /// 2. From the left, take the longest sequence of words that names a known channel.
    /// 3. Reject a word that may change what a channel name means: a modifier such as "dot"
    ///    anywhere, or an unknown word between two names.
    /// 4. If both of two names can be input or output, read them as "output input", or as "input to
    ///    output".
    /// 5. Otherwise prefer, for each side, a name that belongs only to this side over a name that
    ///    may belong to either; reject several different channels, and leave a side open without
    ///    any.
    ///
    /// # Errors
    /// The text names several outputs or inputs, or a word may change what a channel name means.
    pub fn find(text: &str, known: KnownChannels<'_>) -> Result<Self, ResponseNameError> {
        // Steps 1 and 2.
        let words = split_words(text);
        let named = named_channels(text, &words, known);
        // Step 3.
        reject_modifiers(&words, &named)?;
        // Step 4.
        if let [first, second] = named.as_slice()
            && first.sides.are_both()
            && second.sides.are_both()
        {
            return Ok(Self::from_order(&words, first, second));
        }
        // Step 5.
        Ok(Self {
            output: only_channel(ChannelSide::Output, &named)?,
            input: only_channel(ChannelSide::Input, &named)?,
        })
    }

    /// Assigns two channels by their order: "output input", or "input to output".
    fn from_order(words: &[Word<'_>], first: &NamedChannel<'_>, second: &NamedChannel<'_>) -> Self {
        let input_first = words[first.words.end..second.words.start]
            .iter()
            .any(|word| word.text.eq_ignore_ascii_case("to"));
        let [output, input] = if input_first {
            [second, first]
        } else {
            [first, second]
        };
        Self {
            output: Some(output.text.to_owned()),
            input: Some(input.text.to_owned()),
        }
    }
}

/// Returns an error if a word may change what a channel name means: a modifier anywhere, or any
/// unknown word between the names.
fn reject_modifiers(
    words: &[Word<'_>],
    named: &[NamedChannel<'_>],
) -> Result<(), ResponseNameError> {
    let [first, ..] = named else {
        return Ok(());
    };
    let begin = first.words.start;
    let end = named[named.len() - 1].words.end;
    for (index, word) in words.iter().enumerate() {
        let is_named = named.iter().any(|channel| channel.words.contains(&index));
        if is_named || is_filler(word.text) {
            continue;
        }
        let is_between = begin < index && index < end;
        if is_between || MODIFIERS.contains(&word.text.to_lowercase().as_str()) {
            let before = named
                .iter()
                .rev()
                .find(|channel| channel.words.start < index);
            return Err(ResponseNameError::OtherChannel {
                word: word.text.to_owned(),
                channel: before.unwrap_or(first).text.to_owned(),
            });
        }
    }
    Ok(())
}

/// Returns the channel named for a side; `None` if the text names none. A name that belongs only to
/// this side takes precedence over a name that may belong to either.
///
/// # Errors
/// The text names several different channels for this side.
fn only_channel(
    side: ChannelSide,
    named: &[NamedChannel<'_>],
) -> Result<Option<String>, ResponseNameError> {
    let mut fitting = Vec::new();
    let mut certain = Vec::new();
    for channel in named {
        if channel.sides.has(side) {
            fitting.push(channel.text);
            if !channel.sides.are_both() {
                certain.push(channel.text);
            }
        }
    }
    let names = if certain.is_empty() { fitting } else { certain };
    let Some((first, others)) = names.split_first() else {
        return Ok(None);
    };
    if others.iter().all(|other| same_channel(first, other)) {
        return Ok(Some((*first).to_owned()));
    }
    Err(ResponseNameError::Several {
        side: side.pick("input", "output"),
        found: names.join(", "),
    })
}

/// Returns whether a word is a number, with at most one letter beside it ("v2"); a unit for speed,
/// length, level or frequency ("60kt"); or a filler ("run2").
fn is_filler(word: &str) -> bool {
    let word = word.to_lowercase();
    let plain = word.trim_matches(|letter: char| letter.is_ascii_digit());
    let is_unit = PhysicalUnit::parse(plain).is_some_and(|unit| {
        matches!(
            unit.dimension,
            Dimension::Speed | Dimension::Length | Dimension::Level | Dimension::Frequency
        )
    });
    let is_number = plain.len() < word.len() && plain.len() <= 1;
    plain.is_empty() || is_number || is_unit || FILLERS.contains(&plain)
}

/// Words in file names that do not name a channel. [`is_filler`] also ignores numbers and some
/// units.
const FILLERS: [&str; 44] = [
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

/// Words that change what a channel name in the same text means: "q dot" is not q.
const MODIFIERS: [&str; 23] = [
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::names::ChannelRule;

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
    fn file_names_give_output_and_input() {
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
    fn ambiguous_names_are_errors() {
        for text in ["frf_q_dot_lon", "q_lon_cmd", "q_imu_lon"] {
            assert!(
                matches!(read(text), Err(ResponseNameError::OtherChannel { .. })),
                "{text}: {:?}",
                read(text)
            );
        }
        for (text, side) in [("p_q_lon", "output"), ("q_lon_lat", "input")] {
            assert!(
                matches!(read(text), Err(ResponseNameError::Several { side: found, .. }) if found == side),
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
    fn aliases_are_known_and_order_decides_between_sides() {
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
        let name = ResponseName::find("mag roll_rate xb", KnownChannels::AliasTable).unwrap();
        assert_eq!(
            (name.output.as_deref(), name.input.as_deref()),
            (Some("roll_rate"), Some("xb"))
        );
    }
}
