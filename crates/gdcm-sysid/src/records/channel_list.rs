//! Channels as written in one line: `LON, Q [deg/s]=pitch_rate`.

use std::fmt;
use std::str::FromStr;

use gdcm_model::names::channel_rule::ChannelRule;

/// Channels by name, each with an optional unit and column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelList {
    pub channels: Vec<RequestedChannel>,
}

/// A channel as specified in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RequestedChannel {
    pub name: String,
    /// Unit; empty if not given.
    pub unit: String,
    /// Column: its name, `TOPIC.FIELD`, or `#3` (the third column); `None` if not given.
    pub column: Option<String>,
}

/// Reasons why a string is not a channel list.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChannelListError {
    /// Text between commas that is not a channel.
    #[error(
        "expected CHANNEL or CHANNEL=COLUMN, for example P or P [deg/s]=roll_rate, found \
        \"{0}\""
    )]
    NoChannel(String),
    /// A channel name that occurs twice.
    #[error("duplicate channel {0}; remove one")]
    Twice(String),
}

impl ChannelListError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoChannel(..) => "no-channel",
            Self::Twice(..) => "given-twice",
        }
    }
}

impl RequestedChannel {
    /// Returns the rule for this channel: its column becomes an alias, and a file without units is
    /// taken to be in its unit.
    pub fn rule(&self) -> ChannelRule {
        ChannelRule {
            unit: self.unit.clone(),
            unit_in_files: Some(self.unit.clone()).filter(|unit| !unit.is_empty()),
            aliases: self.column.iter().cloned().collect(),
            ..ChannelRule::named(self.name.clone())
        }
    }
}

/// Parses `NAME`, `NAME [UNIT]`, `NAME=COLUMN` or `NAME [UNIT]=COLUMN`, the column with or without
/// quotation marks. Digits in the bracket are an index, which belongs to the name.
impl FromStr for RequestedChannel {
    type Err = ChannelListError;

    fn from_str(text: &str) -> Result<Self, ChannelListError> {
        let mut name = text.trim();
        let mut column = None;
        if let Some((before, after)) = text.split_once('=') {
            name = before.trim();
            column = Some(after.trim().trim_matches('"'));
        }
        let mut unit = "";
        if let Some((before, inside)) = name
            .strip_suffix(']')
            .and_then(|rest| rest.rsplit_once('['))
            && !is_index(inside)
        {
            name = before.trim();
            unit = inside.trim();
        }
        if name.is_empty() || column.is_some_and(str::is_empty) {
            return Err(ChannelListError::NoChannel(text.to_owned()));
        }
        Ok(Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
            column: column.map(str::to_owned),
        })
    }
}

/// Returns whether the text in a bracket is an index, as in `xyz[0]`, and not a unit.
fn is_index(inside: &str) -> bool {
    inside.bytes().all(|byte| byte.is_ascii_digit())
}

impl FromStr for ChannelList {
    type Err = ChannelListError;

    fn from_str(text: &str) -> Result<Self, ChannelListError> {
        let mut channels: Vec<RequestedChannel> = Vec::new();
        for part in split_outside_quotes(text) {
            channels.push(part.parse()?);
        }
        for (index, channel) in channels.iter().enumerate() {
            let earlier = &channels[..index];
            if earlier.iter().any(|other| other.name == channel.name) {
                return Err(ChannelListError::Twice(channel.name.clone()));
            }
        }
        Ok(Self { channels })
    }
}

impl fmt::Display for ChannelList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, RequestedChannel { name, unit, column }) in self.channels.iter().enumerate() {
            if index > 0 {
                f.write_str(", ")?;
            }
            f.write_str(name)?;
            if !unit.is_empty() {
                write!(f, " [{unit}]")?;
            }
            match column {
                Some(column) if column.contains(',') => write!(f, "=\"{column}\"")?,
                Some(column) => write!(f, "={column}")?,
                None => {}
            }
        }
        Ok(())
    }
}

/// Splits a list at the commas outside quotation marks.
fn split_outside_quotes(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut start = 0;
    let mut is_quoted = false;
    for (at, letter) in text.char_indices() {
        if letter == '"' {
            is_quoted = !is_quoted;
        } else if letter == ',' && !is_quoted {
            parts.push(&text[start..at]);
            start = at + 1;
        }
    }
    parts.push(&text[start..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &str) -> Result<ChannelList, ChannelListError> {
        text.parse()
    }

    fn channel(name: &str, unit: &str, column: Option<&str>) -> RequestedChannel {
        RequestedChannel {
            name: name.into(),
            unit: unit.into(),
            column: column.map(Into::into),
        }
    }

    #[test]
    fn channels_may_have_columns_and_units() {
        let written = list("LON, P=roll rate,LAT=\"elev, yoke\",Q [deg/s]=#30,xyz[0]").unwrap();
        let expected = [
            channel("LON", "", None),
            channel("P", "", Some("roll rate")),
            channel("LAT", "", Some("elev, yoke")),
            channel("Q", "deg/s", Some("#30")),
            channel("xyz[0]", "", None),
        ];
        assert_eq!(written.channels, expected);
        assert_eq!(
            list(&written.to_string()),
            Ok(written),
            "the printed list is parsed to the same channels"
        );
    }

    #[test]
    fn incomplete_and_duplicate_channels_are_refused() {
        for (text, part) in [("", ""), ("P=", "P="), ("P,,Q", ""), ("[deg/s]", "[deg/s]")] {
            let expected = ChannelListError::NoChannel(part.to_owned());
            assert_eq!(list(text), Err(expected), "{text}");
        }
        let duplicate = ChannelListError::Twice("P".to_owned());
        assert_eq!(list("P,Q,P"), Err(duplicate));
    }
}
