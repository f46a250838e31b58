//! A record's column, used as a channel.
//!
//! A *remedy* ([`ChannelRemedy`]) is a correction to a channel in one record, which disagrees with
//! the others without it: a factor on its samples, and a delay to remove (M14.16).

use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::names::signed_name::sign_between;
use gdcm_model::units::physical_unit::conversion_factor;

use super::plausible_units::possible_units;
use super::record_table::{RecordColumn, RecordTable};

/// How a column's unit was determined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitBasis {
    /// By the file, by the samples, or by the user; also for a column used unchanged because no
    /// conversion is possible.
    Known,
    /// Not at all: neither the file nor the samples determine the unit, so that the record cannot
    /// be used.
    Open,
    /// By assumption: the channel's unit, until the user checks it.
    Assumed,
}

/// A record's column, used as a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnUse {
    pub column: usize,
    /// Channel units per column unit; negative for the opposite sign.
    pub factor: f64,
    pub unit: UnitBasis,
    /// Remedy applied in this record only.
    pub remedy: ChannelRemedy,
}

impl ColumnUse {
    /// Uses the column unchanged.
    pub fn as_it_is(column: usize) -> Self {
        Self::times(column, 1.0)
    }

    /// Uses the column times a factor.
    pub fn times(column: usize, factor: f64) -> Self {
        Self {
            column,
            factor,
            unit: UnitBasis::Known,
            remedy: ChannelRemedy::NONE,
        }
    }

    /// Uses a column for a channel with this unit: converted from the unit in the file, if that is
    /// possible; else from the only unit in which its samples are plausible; else, with several
    /// such units and none in the file, with an open unit; else unchanged.
    pub fn by_unit(table: &RecordTable, column: usize, unit: &str) -> Self {
        let Some(samples) = table.columns.get(column) else {
            return Self::as_it_is(column);
        };
        let unit_in_file = samples.unit_in_file();
        if let Some(factor) = unit_in_file.and_then(|from| conversion_factor(from, unit)) {
            return Self::times(column, factor);
        }
        match possible_units(samples, unit).as_slice() {
            [only] => Self::times(column, conversion_factor(only, unit).unwrap_or(1.0)),
            [_, _, ..] if unit_in_file.is_none() => Self {
                unit: UnitBasis::Open,
                ..Self::as_it_is(column)
            },
            _ => Self::as_it_is(column),
        }
    }

    /// Returns the units in which the column's samples are plausible, for a channel with this unit;
    /// empty if the unit is known.
    pub fn open_units<'u>(&self, table: &RecordTable, unit: &'u str) -> Vec<&'u str> {
        match table.columns.get(self.column) {
            Some(column) if self.unit != UnitBasis::Known => possible_units(column, unit),
            _ => Vec::new(),
        }
    }

    /// Converts the column from the unit `from`, given by the user, to the channel's unit `unit`,
    /// and marks the unit as known. The factor is unchanged if there is no conversion.
    #[must_use]
    pub fn in_unit(self, from: &str, unit: &str) -> Self {
        Self {
            factor: self.factor * conversion_factor(from, unit).unwrap_or(1.0),
            unit: UnitBasis::Known,
            ..self
        }
    }

    /// Returns the use without its remedy.
    pub(super) fn without_remedy(self) -> Self {
        Self {
            remedy: ChannelRemedy::NONE,
            ..self
        }
    }

    /// Confirms that the column is in the channel's unit; the factor stays.
    pub(super) fn in_unit_of_channel(self) -> Self {
        Self {
            unit: UnitBasis::Known,
            ..self
        }
    }

    /// Assumes the channel's unit if the unit is open; unlike a confirmed unit, an assumed one
    /// raises a caution.
    pub(super) fn assuming_unit_of_channel(self) -> Self {
        match self.unit {
            UnitBasis::Open => Self {
                unit: UnitBasis::Assumed,
                ..self
            },
            UnitBasis::Known | UnitBasis::Assumed => self,
        }
    }

    /// Returns the total factor, remedy included.
    pub(super) fn gain(&self) -> f64 {
        self.factor * self.remedy.factor
    }

    /// Returns the remedy to store with the dataset, which keeps no layout: the record's remedy,
    /// times the part of [`Self::factor`] that reading the file again does not give, because it
    /// follows neither from the unit (the file's, or else the dataset's) nor from the sign mark in
    /// the column name.
    pub(super) fn kept_remedy(&self, table: &RecordTable, rule: &ChannelRule) -> ChannelRemedy {
        let from_file = match table.columns.get(self.column) {
            Some(column) => factor_from_file(column, rule),
            None => 1.0,
        };
        ChannelRemedy {
            factor: self.remedy.factor * (self.factor / from_file),
            ..self.remedy
        }
    }
}

/// Returns the factor that converts the column's unit and sign convention to the channel's. Units
/// that are unknown or cannot be converted contribute a factor of 1, as does an unknown sign.
fn factor_from_file(column: &RecordColumn, rule: &ChannelRule) -> f64 {
    let mut factor = 1.0;
    if let Some(unit) = column.unit_in_file()
        && !rule.unit.is_empty()
    {
        factor = conversion_factor(unit, &rule.unit).unwrap_or(1.0);
    }
    factor * sign_between(&column.name, &rule.name).unwrap_or(1.0)
}
