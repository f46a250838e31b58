//! Searches the columns that may hold a channel, by name, documentation and unit.
//!
//! Steps 1 to 3 are tried in turn until one finds columns, and so are the rules N (by name) and A
//! (by alias) in step 1; step 4 reduces the columns found:
//!
//! ```text
//! 1   a channel without aliases, by its name         channel -> column in the file
//!     N1  exactly                                    az -> az
//!     N2  apart from sign marks                      az -> -az, az (down)
//!     N3  as a synonym, apart from sign marks        NZ -> load factor
//!     a channel with aliases, by these instead       alias -> column in the file
//!     A1  exactly                                    elev_yoke1 -> elev_yoke1
//!     A2  the first that RecordTable::find resolves:
//!           without regard to case                   Elev_Yoke1 -> elev_yoke1
//!           by its column number, from 1             #3 -> the third column
//!           by its index in a matrix                 xyz[0] or xyz(1) -> xyz_1
//!         a column number that does not exist ends step 1
//!     A3  folded: without case, marks and blanks     elev_yoke1 -> elev,yoke1
//!     A4  folded, apart from sign marks              az_b -> az b (down)
//!     A5  as a synonym, apart from sign marks        elevator -> pitch stick
//! 2   by the logging system's documentation          P -> vehicle_angular_velocity.xyz[0]
//! 3   as a topic's field, exactly                    az -> IMU.az
//! 4   without aliases, latitudes and longitudes are removed; of several columns, the only one
//!     whose unit can be converted to the channel's; otherwise all, and the user must choose
//! ```
//!
//! From N2 and A2 on, names and aliases are also tried without their own sign marks. Step 1 skips
//! columns that the file assigns to the other side (inputs or outputs), except in A2, in which the
//! user's word selects a single column.

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::names::channel_alias::{folded_name, same_channel};
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::names::signed_name::SignedName;
use gdcm_model::units::physical_unit::conversion_factor;

use super::position_columns::is_position;
use super::record_table::{RecordColumn, RecordTable};

/// Returns the columns that may hold this channel (steps 1 to 4).
pub(super) fn candidates(table: &RecordTable, rule: &ChannelRule, side: ChannelSide) -> Vec<usize> {
    let search = ColumnSearch { table, rule, side };
    let spellings = search.spellings();
    // Steps 1 to 3.
    let mut found = if rule.aliases.is_empty() {
        search.by_name()
    } else {
        search.by_aliases(&spellings)
    };
    if found.is_empty() {
        found = search.by_documentation(&spellings);
    }
    if found.is_empty() && search.may_be_field() {
        found = search.by_field(&spellings);
    }
    // Step 4. "lat" and "lon" are also synonyms of the lateral and the longitudinal stick; an alias
    // is the user's choice, and its column is kept.
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

/// A channel, and the table in which its column is searched.
struct ColumnSearch<'r> {
    table: &'r RecordTable,
    rule: &'r ChannelRule,
    side: ChannelSide,
}

impl ColumnSearch<'_> {
    /// Returns the aliases, or else the channel's name, each as given and without its sign mark.
    fn spellings(&self) -> Vec<String> {
        let names = if self.rule.aliases.is_empty() {
            std::slice::from_ref(&self.rule.name)
        } else {
            self.rule.aliases.as_slice()
        };
        let mut spellings = Vec::with_capacity(2 * names.len());
        for name in names {
            spellings.push(name.clone());
            spellings.push(without_sign_mark(name));
        }
        spellings
    }

    /// Returns the columns whose names are accepted by `is_wanted`, without those that the file
    /// assigns to the other side.
    fn own_side(&self, is_wanted: impl Fn(&str) -> bool) -> Vec<usize> {
        self.any_side(|column| {
            let has_other_side = column.side.is_some_and(|side| side != self.side);
            !has_other_side && is_wanted(&column.name)
        })
    }

    /// Returns the columns accepted by `is_wanted`, on any side.
    fn any_side(&self, is_wanted: impl Fn(&RecordColumn) -> bool) -> Vec<usize> {
        let mut found = Vec::new();
        for (index, column) in self.table.columns.iter().enumerate() {
            if is_wanted(column) {
                found.push(index);
            }
        }
        found
    }

    /// Returns the columns with the channel's name (step 1, rules N1 to N3).
    fn by_name(&self) -> Vec<usize> {
        let name = &self.rule.name;
        // N1.
        let exact = self.own_side(|column| column == name);
        if !exact.is_empty() {
            return exact;
        }
        // N2.
        let unmarked = without_sign_mark(name);
        let marked = self.own_side(|column| without_sign_mark(column) == unmarked);
        if !marked.is_empty() {
            return marked;
        }
        // N3.
        self.own_side(|column| same_channel(&without_sign_mark(column), &unmarked))
    }

    /// Returns the columns that the aliases denote (step 1, rules A1 to A5). The `spellings` are
    /// the aliases with and without their sign marks; A1 takes the aliases only as given, so that
    /// "-az" prefers a column "-az" to a column "az".
    fn by_aliases(&self, spellings: &[String]) -> Vec<usize> {
        // A1.
        let exact = self.own_side(|column| self.rule.aliases.iter().any(|alias| alias == column));
        if !exact.is_empty() {
            return exact;
        }
        // A2.
        if let Some(column) = spellings.iter().find_map(|alias| self.table.find(alias)) {
            return vec![column];
        }
        if spellings.iter().any(|alias| is_column_number(alias)) {
            return Vec::new();
        }
        // A3.
        let folded_spellings: Vec<String> =
            spellings.iter().map(|alias| folded_name(alias)).collect();
        let folded = self.own_side(|column| folded_spellings.contains(&folded_name(column)));
        if !folded.is_empty() {
            return folded;
        }
        // A4.
        let marked = self
            .own_side(|column| folded_spellings.contains(&folded_name(&without_sign_mark(column))));
        if !marked.is_empty() {
            return marked;
        }
        // A5.
        self.own_side(|column| {
            let unmarked = without_sign_mark(column);
            spellings.iter().any(|alias| same_channel(&unmarked, alias))
        })
    }

    /// Returns the columns that the logging system's documentation assigns to the channel (step 2),
    /// on any side: logs assign no sides.
    fn by_documentation(&self, spellings: &[String]) -> Vec<usize> {
        self.any_side(|column| match column.meaning {
            Some(meaning) => spellings.iter().any(|name| same_channel(meaning, name)),
            None => false,
        })
    }

    /// Returns whether step 3 applies: the user named the field, or the log has no documented
    /// columns. In a documented log, a field with the channel's name is another quantity (PIDR.P is
    /// a controller term, not a roll rate).
    fn may_be_field(&self) -> bool {
        if !self.rule.aliases.is_empty() {
            return true;
        }
        let mut columns = self.table.columns.iter();
        let has_documented = columns.any(|column| column.meaning.is_some());
        !has_documented
    }

    /// Returns the columns whose name within their topic is in `spellings` (step 3), as a last
    /// resort on any side; without topics, whole column names are compared.
    fn by_field(&self, spellings: &[String]) -> Vec<usize> {
        self.any_side(|column| spellings.iter().any(|name| column.field() == *name))
    }

    /// Returns the columns whose unit can be converted to the channel's unit (step 4).
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

/// Returns whether an alias is a column number, such as `#3`.
fn is_column_number(alias: &str) -> bool {
    alias.starts_with('#')
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::record_table::TopicClock;
    use super::*;

    fn table(names: &[&str]) -> RecordTable {
        let columns = names
            .iter()
            .map(|name| RecordColumn::new(*name, vec![0.0, 1.0]))
            .collect();
        RecordTable::new("flight", columns)
    }

    fn rule(name: &str, aliases: &[&str]) -> ChannelRule {
        ChannelRule {
            aliases: aliases.iter().map(ToString::to_string).collect(),
            ..ChannelRule::named(name)
        }
    }

    #[test]
    fn a_name_is_found_by_the_first_rule_that_applies() {
        for (name, columns, expected) in [
            ("az", ["-az", "az"], 1),
            ("az", ["load factor", "az (down)"], 1),
            ("NZ", ["P", "load factor"], 1),
        ] {
            let found = candidates(&table(&columns), &rule(name, &[]), ChannelSide::Output);
            assert_eq!(found, [expected], "{name} in {columns:?}");
        }
    }

    #[test]
    fn an_alias_is_found_by_the_first_rule_that_applies() {
        for (alias, columns, expected) in [
            ("elev_yoke1", ["elev,yoke1", "elev_yoke1"], 1),
            ("Elev_Yoke1", ["elev,yoke1", "elev_yoke1"], 1),
            ("#2", ["xyz_1", "xyz_2"], 1),
            ("xyz[0]", ["xyz_1", "xyz_2"], 0),
            ("xyz(2)", ["xyz_1", "xyz_2"], 1),
            ("elev_yoke1", ["pitch stick", "elev,yoke1"], 1),
            ("az_b", ["load factor", "az b (down)"], 1),
            ("elevator", ["roll stick", "pitch stick"], 1),
        ] {
            let found = candidates(&table(&columns), &rule("X", &[alias]), ChannelSide::Input);
            assert_eq!(found, [expected], "{alias} in {columns:?}");
        }
    }

    #[test]
    fn a_column_number_that_does_not_exist_leaves_out_the_folded_spelling() {
        let other = candidates(
            &table(&["az", "X"]),
            &rule("X", &["#9", "AZ (down)"]),
            ChannelSide::Output,
        );
        assert_eq!(other, [0], "rule A2 resolves the other alias");
        let missing = candidates(
            &table(&["a z", "X"]),
            &rule("X", &["#9", "az"]),
            ChannelSide::Output,
        );
        assert!(missing.is_empty(), "{missing:?}");
    }

    #[test]
    fn a_channel_with_a_sign_mark_is_found_as_a_field() {
        let mut table = table(&["IMU.az", "IMU.ay"]);
        let clock = Arc::new(TopicClock {
            name: "IMU".to_owned(),
            time_s: vec![0.0, 0.1],
        });
        for column in &mut table.columns {
            column.topic = Some(Arc::clone(&clock));
        }
        for name in ["az", "-az", "az (down)"] {
            let found = candidates(&table, &rule(name, &[]), ChannelSide::Output);
            assert_eq!(found, [0], "{name}");
        }
    }
}
