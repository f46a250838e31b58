//! Names in files: channel aliases and signs, response names, patterns of file names.

pub mod channel_alias;
pub mod channel_rule;
pub mod name_facts;
pub mod name_pattern;
pub mod on_axis;
pub mod response_name;
pub mod signed_name;
pub mod time_name;

pub use channel_rule::ChannelRule;
pub use name_facts::{NameFacts, RowRole};
pub use name_pattern::{NamePattern, standard_patterns};
pub use response_name::{KnownChannels, ResponseName};
pub use signed_name::SignedName;
