//! Searches the columns that may hold a channel, by name, documentation and unit.
//!
//! ```text
//! 1  names: the exact name; else the name beside a sign mark (-az); else a synonym
//!    aliases replace the name: exactly as given; else the first column that an alias finds without
//!    regard to case, by its number or by its index (RecordTable::find); else, unless an alias is a
//!    number, in folded spelling, then beside a sign mark, then a synonym
//!    only columns that the file does not assign to the other side, except in RecordTable::find
//! 2  if none: columns that the logging system's documentation assigns to the channel
//! 3  if none: fields of topics with the exact name (`xyz` in TOPIC.xyz); without aliases, this
//!    step is left out in logs with documented columns
//! 4  without aliases: latitudes and longitudes are removed
//! 5  if several: the only column whose unit can be converted, if there is just one
//! ```

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::channel_alias::{folded_name, same_channel};
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::names::signed_name::SignedName;
use gdcm_model::units::physical_unit::conversion_factor;

use super::position_columns::is_position;
use super::record_table::{RecordColumn, RecordTable};

/// Returns the columns that may hold this channel (steps 1 to 5).
pub(super) fn candidates(table: &RecordTable, rule: &ChannelRule, side: ChannelSide) -> Vec<usize> {
    let search = ColumnSearch { table, rule, side };
    let names = search.wanted_names();
    let mut found = if rule.aliases.is_empty() {
        search.by_name()
    } else {
        search.by_aliases(&names)
    };
    if found.is_empty() {
        found = search.by_documentation(&names);
    }
    if found.is_empty() && search.may_be_field() {
        found = search.by_field(&names);
    }
    if rule.aliases.is_empty() {
        found.retain(|column| !is_position(table, *column, rule));
    }
    if found.len() > 1 {
        let convertible = search.convertible(&found);
        if convertible.len() == 1 {
            return convertible;
        }
    }
    found
}

/// Returns a name without its sign marks: "-az" and "az (down)" become "az".
pub(super) fn without_sign_mark(name: &str) -> String {
    SignedName::parse(name).name
}

/// Searches a channel's column.
struct ColumnSearch<'r> {
    table: &'r RecordTable,
    rule: &'r ChannelRule,
    side: ChannelSide,
}

impl ColumnSearch<'_> {
    /// Returns the channel's name, or its aliases, each also without its sign mark.
    fn wanted_names(&self) -> Vec<String> {
        if self.rule.aliases.is_empty() {
            return vec![self.rule.name.clone()];
        }
        let mut names = Vec::new();
        for alias in &self.rule.aliases {
            names.push(alias.clone());
            names.push(without_sign_mark(alias));
        }
        names
    }

    /// Returns the columns accepted by `is_wanted`, without those that the file assigns to the
    /// other side.
    fn named(&self, is_wanted: impl Fn(&str) -> bool) -> Vec<usize> {
        let mut found = Vec::new();
        for (index, column) in self.table.columns.iter().enumerate() {
            let has_other_side = column.side.is_some_and(|side| side != self.side);
            if !has_other_side && is_wanted(&column.name) {
                found.push(index);
            }
        }
        found
    }

    /// Returns the columns with the channel's name: exactly, else beside a sign mark, else as a
    /// synonym.
    fn by_name(&self) -> Vec<usize> {
        let name = &self.rule.name;
        let exact = self.named(|column| column == name);
        if !exact.is_empty() {
            return exact;
        }
        let wanted = without_sign_mark(name);
        let marked = self.named(|column| without_sign_mark(column) == wanted);
        if !marked.is_empty() {
            return marked;
        }
        self.named(|column| same_channel(&without_sign_mark(column), &wanted))
    }

    /// Returns the columns that the user's aliases denote, in the order of step 1. In folded
    /// spelling "elev_yoke1" is "elev,yoke1". If an alias is a column number that does not exist,
    /// no names are tried.
    fn by_aliases(&self, aliases: &[String]) -> Vec<usize> {
        let exact = self.named(|column| self.rule.aliases.iter().any(|alias| alias == column));
        if !exact.is_empty() {
            return exact;
        }
        if let Some(column) = aliases.iter().find_map(|alias| self.table.find(alias)) {
            return vec![column];
        }
        if aliases.iter().any(|alias| alias.starts_with('#')) {
            return Vec::new();
        }
        let folded = self.named(|column| {
            let column = folded_name(column);
            aliases.iter().any(|alias| column == folded_name(alias))
        });
        if !folded.is_empty() {
            return folded;
        }
        let marked = self.named(|column| {
            let column = folded_name(&without_sign_mark(column));
            aliases.iter().any(|alias| column == folded_name(alias))
        });
        if !marked.is_empty() {
            return marked;
        }
        self.named(|column| {
            let column = without_sign_mark(column);
            aliases.iter().any(|alias| same_channel(&column, alias))
        })
    }

    /// Returns the columns accepted by `is_wanted`, on any side.
    fn columns(&self, is_wanted: impl Fn(&RecordColumn) -> bool) -> Vec<usize> {
        let mut found = Vec::new();
        for (index, column) in self.table.columns.iter().enumerate() {
            if is_wanted(column) {
                found.push(index);
            }
        }
        found
    }

    /// Returns the columns that the logging system's documentation assigns to the channel (step 2).
    fn by_documentation(&self, names: &[String]) -> Vec<usize> {
        self.columns(|column| match column.meaning {
            Some(meaning) => names.iter().any(|name| same_channel(meaning, name)),
            None => false,
        })
    }

    /// Returns whether a topic's field may be the channel because it has the same name. In logs
    /// with documented columns such a field has another meaning, unless the user names it: "PIDR.P"
    /// is not a roll rate.
    fn may_be_field(&self) -> bool {
        let is_documented = self
            .table
            .columns
            .iter()
            .any(|column| column.meaning.is_some());
        !self.rule.aliases.is_empty() || !is_documented
    }

    /// Returns the columns whose name within their topic is in `names` (step 3).
    fn by_field(&self, names: &[String]) -> Vec<usize> {
        self.columns(|column| names.iter().any(|name| column.field() == *name))
    }

    /// Returns the columns whose unit can be converted to the channel's unit.
    fn convertible(&self, columns: &[usize]) -> Vec<usize> {
        let mut found = Vec::new();
        for column in columns {
            let unit = self.table.columns[*column].unit.as_deref();
            if unit.is_some_and(|unit| conversion_factor(unit, &self.rule.unit).is_some()) {
                found.push(*column);
            }
        }
        found
    }
}
