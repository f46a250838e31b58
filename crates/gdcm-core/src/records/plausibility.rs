//! What samples can be in a unit, and what they cannot.

use crate::assembly::{ChannelRule, Dimension, PhysicalUnit, conversion_factor};

use super::layout_problem::{LayoutCaution, LayoutProblem};
use super::record_layout::ColumnUse;
use super::record_table::RecordTable;

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
/// A rate \[deg/s\] or a part of travel \[%\] that varies by less than this in a whole manoeuvre may be in another unit.
const LEAST_RANGE: f64 = 1.5;

/// The fault of a channel whose samples cannot be in its unit.
pub(super) fn magnitude(table: &RecordTable, rule: &ChannelRule, used: ColumnUse) -> Option<LayoutProblem> {
    let column = table.columns.get(used.column)?;
    let (least, most) = column.range()?;
    let value = least.abs().max(most.abs()) * used.factor.abs();
    let unit = PhysicalUnit::of(&rule.unit)?;
    let (_, limit, of) = MOST.into_iter().find(|(dimension, ..)| *dimension == unit.dimension)?;
    let limit = limit * conversion_factor(of, &rule.unit)?;
    if value <= limit {
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
        most: limit,
        unit: rule.unit.clone(),
        hint: hint.to_owned(),
    })
}

/// Channels whose unit the file does not say, and that vary so little that they may be in another.
pub(super) fn perhaps_other_units(
    table: &RecordTable,
    inputs: &[(&ChannelRule, ColumnUse)],
    outputs: &[(&ChannelRule, ColumnUse)],
) -> Vec<LayoutCaution> {
    // The greatest range of those channels of a dimension that have no unit in the file.
    let most = |channels: &[(&ChannelRule, ColumnUse)], dimension: Dimension, unit: &str| -> Option<f64> {
        let range = |(rule, used): &(&ChannelRule, ColumnUse)| {
            let column = table.columns.get(used.column).filter(|column| column.unit.is_none())?;
            let (least, most) = column.range()?;
            let is_it = PhysicalUnit::of(&rule.unit).is_some_and(|unit| unit.dimension == dimension);
            is_it.then_some((most - least) * used.factor.abs() * conversion_factor(&rule.unit, unit)?)
        };
        channels.iter().filter_map(range).reduce(f64::max)
    };
    let is_small = |range: &f64| *range > 0.0 && *range < LEAST_RANGE;
    let rates = most(outputs, Dimension::AngularRate, "deg/s").filter(is_small);
    let parts = most(inputs, Dimension::Part, "%").filter(is_small);
    let radians = rates.map(|most| LayoutCaution::PerhapsRadians { most, unit: "deg/s".to_owned() });
    let fractions = parts.map(|most| LayoutCaution::PerhapsFractions { most });
    radians.into_iter().chain(fractions).collect()
}
