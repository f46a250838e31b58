//! Likeness between channel names in files and in the dataset: from the same name to any other name
//! that the alias table knows for the channel.

use crate::names::channel_alias::same_channel;
use crate::names::{ChannelRule, SignedName};

/// Likeness between a name in a file and a dataset channel's name or alias.
#[derive(Clone, Copy)]
pub(super) enum Likeness {
    /// Same as the channel's name.
    Name,
    /// Same as an alias from the rules.
    Alias,
    /// Same as the name or an alias from the rules, apart from sign marks.
    SameButForSign,
    /// Same channel, by the alias table, as the name or an alias from the rules.
    Channel,
}

impl Likeness {
    pub(super) const CLOSEST_FIRST: [Self; 4] =
        [Self::Name, Self::Alias, Self::SameButForSign, Self::Channel];

    /// Returns whether a name in a file and a dataset channel have this likeness.
    pub(super) fn holds(self, name: &str, rule: &ChannelRule) -> bool {
        match self {
            Self::Name => name == rule.name,
            Self::Alias => rule.aliases.iter().any(|alias| alias == name),
            Self::SameButForSign => {
                let unsigned = unsigned_name(name);
                unsigned == unsigned_name(&rule.name)
                    || rule
                        .aliases
                        .iter()
                        .any(|alias| unsigned_name(alias) == unsigned)
            }
            Self::Channel => {
                let unsigned = unsigned_name(name);
                same_channel(&unsigned, &unsigned_name(&rule.name))
                    || rule
                        .aliases
                        .iter()
                        .any(|alias| same_channel(&unsigned, &unsigned_name(alias)))
            }
        }
    }
}

fn unsigned_name(name: &str) -> String {
    SignedName::parse(name).name
}

/// Returns the channel's name or alias that equals a name in a file; otherwise the first alias that
/// equals it apart from sign marks, or else the channel's name.
pub(super) fn matched_name<'r>(name: &str, rule: &'r ChannelRule) -> &'r str {
    if name == rule.name {
        return &rule.name;
    }
    if let Some(alias) = rule.aliases.iter().find(|alias| *alias == name) {
        return alias;
    }
    let unsigned = unsigned_name(name);
    for alias in &rule.aliases {
        if unsigned_name(alias) == unsigned {
            return alias;
        }
    }
    &rule.name
}
