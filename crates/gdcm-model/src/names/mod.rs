//! Names in files: channel aliases and signs, response names, file name patterns.

pub mod channel_alias;
pub mod channel_rule;
pub mod name_facts;
pub mod name_pattern;
mod named_channel;
pub mod on_axis;
pub mod response_name;
mod row_role;
pub mod signed_name;
pub mod standard_patterns;
pub mod time_name;

pub use channel_rule::ChannelRule;
pub use name_facts::NameFacts;
pub use name_pattern::NamePattern;
pub use response_name::{KnownChannels, ResponseName};
pub use row_role::RowRole;
pub use signed_name::SignedName;
pub use standard_patterns::standard_patterns;
