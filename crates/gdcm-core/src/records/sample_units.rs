//! In which units the samples of a channel can be, and in which they cannot.

use super::{ColumnUse, LayoutProblem, RecordColumn, RecordTable};
use crate::assembly::{ChannelRule, Dimension, PhysicalUnit, conversion_factor, sign_between};
use crate::dataset::ChannelRemedy;

/// The most that a helicopter has of a dimension, in a unit of that dimension.
const MOST: [(Dimension, f64, &str); 7] = [
    (Dimension::AngularRate, 400.0, "deg/s"),
    (Dimension::Angle, 3600.0, "deg"),
    (Dimension::AngularAcceleration, 5000.0, "deg/s^2"),
    (Dimension::Acceleration, 15.0, "g"),
    (Dimension::Speed, 500.0, "kt"),
    (Dimension::Part, 3.0, "1"),
    (Dimension::Length, 50_000.0, "m"),
];

/// The units that channels are logged in.
const LOGGED: [&str; 21] = [
    "rad/s", "deg/s", "rad", "deg", "rad/s^2", "deg/s^2", "g", "m/s^2", "ft/s^2", "m/s", "ft/s", "kt", "%", "1", "m",
    "cm", "mm", "ft", "in", "N", "lb",
];

/// The most that a helicopter has of what a unit measures, in that unit.
fn most(unit: &str) -> Option<f64> {
    let dimension = PhysicalUnit::of(unit)?.dimension;
    let (_, limit, of) = MOST.into_iter().find(|(of, ..)| *of == dimension)?;
    Some(limit * conversion_factor(of, unit)?)
}

/// The greatest sample without its sign.
fn peak(column: &RecordColumn) -> Option<f64> {
    column.range().map(|(least, most)| least.abs().max(most.abs()))
}

/// The units that the samples of a column can be in, for a channel of this unit, which stands first: those of the same dimension in
/// which no helicopter has less than the greatest sample. Samples that are all zero, and a unit that is not known, leave nothing open.
pub(super) fn possible_units<'u>(column: &RecordColumn, unit: &'u str) -> Vec<&'u str> {
    let Some(peak) = peak(column).filter(|peak| *peak > 0.0) else { return Vec::new() };
    let is_other = |other: &&str| conversion_factor(other, unit).is_some_and(|factor| factor != 1.0);
    let units = std::iter::once(unit).filter(|unit| PhysicalUnit::of(unit).is_some());
    let units = units.chain(LOGGED.into_iter().filter(is_other));
    units.filter(|unit| most(unit).is_none_or(|most| peak <= most)).collect()
}

/// The problem of a channel whose unit neither its file nor its samples say.
pub(super) fn unsaid_unit(table: &RecordTable, rule: &ChannelRule, used: ColumnUse) -> Option<LayoutProblem> {
    let units = used.open_units(table, &rule.unit);
    let (last, rest) = units.split_last()?;
    Some(LayoutProblem::UnsaidUnit {
        channel: rule.name.clone(),
        column: table.quoted(used.column),
        unit: rule.unit.clone(),
        units: format!("{} or {last}", rest.join(", ")),
    })
}

/// The fault of a channel whose samples cannot be in its unit.
pub(super) fn magnitude(table: &RecordTable, rule: &ChannelRule, used: ColumnUse) -> Option<LayoutProblem> {
    // What a system's documentation says of its columns is no guess, and quadrotors turn faster than helicopters.
    let column = table.columns.get(used.column).filter(|column| column.meaning.is_none())?;
    let value = peak(column)? * used.gain().abs();
    let (unit, most) = (PhysicalUnit::of(&rule.unit)?, most(&rule.unit)?);
    if value <= most {
        return None;
    }
    let hint = match unit.dimension {
        Dimension::AngularRate if column.unit.as_deref().is_some_and(|unit| unit.contains("rad")) => {
            "; its samples look like deg/s"
        }
        Dimension::Part if rule.unit != "%" => "; its samples look like %",
        _ => "",
    };
    Some(LayoutProblem::Magnitude {
        channel: rule.name.clone(),
        column: table.quoted(used.column),
        value,
        most,
        unit: rule.unit.clone(),
        hint: hint.to_owned(),
    })
}

impl ColumnUse {
    /// A column for a channel of this unit, by the unit that the file says or else by the only one that its samples can be in; the unit
    /// is open where they can be in several.
    pub fn by_unit(table: &RecordTable, column: usize, unit: &str) -> Self {
        let Some(of) = table.columns.get(column) else { return Self::as_it_is(column) };
        let said = of.said_unit().and_then(|said| conversion_factor(said, unit));
        match (said, possible_units(of, unit).as_slice()) {
            (Some(factor), _) => Self::times(column, factor),
            (None, [only]) => Self::times(column, conversion_factor(only, unit).unwrap_or(1.0)),
            (None, [_, _, ..]) if of.said_unit().is_none() => Self { is_unit_open: true, ..Self::as_it_is(column) },
            _ => Self::as_it_is(column),
        }
    }

    /// The units among which one is still to be said, for a channel of this unit; none where nothing is open.
    pub fn open_units<'u>(&self, table: &RecordTable, unit: &'u str) -> Vec<&'u str> {
        let column = table.columns.get(self.column).filter(|_| self.is_unit_open);
        column.map_or_else(Vec::new, |column| possible_units(column, unit))
    }

    /// The column in a unit that is said, for a channel of another.
    #[must_use]
    pub fn in_unit(self, said: &str, unit: &str) -> Self {
        Self { factor: self.factor * conversion_factor(said, unit).unwrap_or(1.0), is_unit_open: false, ..self }
    }

    /// What is put right in this record, and whatever else was said of the column: what takes it from its file, in the dataset's units
    /// where that says none, to the samples that are used. Whoever reads the record again by the dataset knows nothing else.
    pub(super) fn kept_remedy(&self, table: &RecordTable, rule: &ChannelRule) -> ChannelRemedy {
        let of_file = table.columns.get(self.column).map_or(1.0, |column| {
            let unit = column.said_unit().filter(|_| !rule.unit.is_empty());
            let factor = unit.and_then(|unit| conversion_factor(unit, &rule.unit)).unwrap_or(1.0);
            factor * sign_between(&column.name, &rule.name).unwrap_or(1.0)
        });
        let besides = if self.factor == of_file { 1.0 } else { self.factor / of_file };
        ChannelRemedy { factor: self.remedy.factor * besides, ..self.remedy }
    }
}
