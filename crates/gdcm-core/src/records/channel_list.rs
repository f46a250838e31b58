//! Channels as an engineer writes them in one line: "LON, Q [deg/s]=pitch_rate".

use std::fmt;
use std::str::FromStr;

use crate::assembly::ChannelRule;

/// Channels by name, each with its unit and the column that it is where these are said.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChannelList {
    /// The channels, in order.
    pub channels: Vec<SaidChannel>,
}

/// A channel as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SaidChannel {
    /// The name.
    pub name: String,
    /// The unit; empty where none is said.
    pub unit: String,
    /// The column that it is: its name, `TOPIC.FIELD`, or `#3` for the third.
    pub column: Option<String>,
}

/// Why a text is no list of channels.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChannelListError {
    /// A part of it is no channel.
    #[error("expected CHANNEL or CHANNEL=COLUMN, as P or P [deg/s]=roll_rate, found \"{found}\"")]
    NoChannel {
        /// The part.
        found: String,
    },
    /// A channel stands twice.
    #[error("{name} stands twice")]
    Twice {
        /// The channel.
        name: String,
    },
}

impl SaidChannel {
    /// What is said of where the channel is found, and in which unit.
    pub fn rule(&self) -> ChannelRule {
        ChannelRule {
            unit: self.unit.clone(),
            unit_in_files: Some(self.unit.clone()).filter(|unit| !unit.is_empty()),
            aliases: self.column.iter().cloned().collect(),
            ..ChannelRule::named(self.name.clone())
        }
    }
}

impl FromStr for SaidChannel {
    type Err = ChannelListError;

    fn from_str(text: &str) -> Result<Self, ChannelListError> {
        let (name, column) = match text.split_once('=') {
            Some((name, column)) => (name.trim(), Some(column.trim().trim_matches('"'))),
            None => (text.trim(), None),
        };
        // `xyz[0]` is an index.
        let is_index = |unit: &str| unit.bytes().all(|byte| byte.is_ascii_digit());
        let bracket = name.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')).filter(|(_, unit)| !is_index(unit));
        let (name, unit) = bracket.map_or((name, ""), |(name, unit)| (name.trim(), unit.trim()));
        if name.is_empty() || column.is_some_and(str::is_empty) {
            return Err(ChannelListError::NoChannel { found: text.to_owned() });
        }
        Ok(Self { name: name.to_owned(), unit: unit.to_owned(), column: column.map(str::to_owned) })
    }
}

impl FromStr for ChannelList {
    type Err = ChannelListError;

    fn from_str(text: &str) -> Result<Self, ChannelListError> {
        let channels: Vec<SaidChannel> =
            split_outside_quotes(text).into_iter().map(str::parse).collect::<Result<_, _>>()?;
        let is_again = |at: &usize| channels[..*at].iter().any(|other| other.name == channels[*at].name);
        match (0..channels.len()).find(is_again) {
            Some(at) => Err(ChannelListError::Twice { name: channels[at].name.clone() }),
            None => Ok(Self { channels }),
        }
    }
}

impl fmt::Display for ChannelList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, SaidChannel { name, unit, column }) in self.channels.iter().enumerate() {
            f.write_str(if at == 0 { "" } else { ", " })?;
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

/// The parts of a list between commas that stand in no quotation marks.
fn split_outside_quotes(text: &str) -> Vec<&str> {
    let mut quoted = false;
    let is_comma = |c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    };
    text.split(is_comma).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &str) -> Result<ChannelList, ChannelListError> {
        text.parse()
    }

    #[test]
    fn channels_may_say_their_columns_and_their_units() {
        let said = list("LON, P=roll rate,LAT=\"elev, yoke\",Q [deg/s]=#30,xyz[0]").unwrap();
        let channel = |name: &str, unit: &str, column: Option<&str>| SaidChannel {
            name: name.into(),
            unit: unit.into(),
            column: column.map(Into::into),
        };
        let expected = [
            channel("LON", "", None),
            channel("P", "", Some("roll rate")),
            channel("LAT", "", Some("elev, yoke")),
            channel("Q", "deg/s", Some("#30")),
            channel("xyz[0]", "", None),
        ];
        assert_eq!(said.channels, expected);
        assert_eq!(list(&said.to_string()), Ok(said), "it is read as it is written");
    }

    #[test]
    fn what_is_no_channel_is_refused() {
        assert!(list("").is_err() && list("P=").is_err() && list("P,,Q").is_err() && list("[deg/s]").is_err());
        assert_eq!(list("P,Q,P").unwrap_err().to_string(), "P stands twice");
    }
}
