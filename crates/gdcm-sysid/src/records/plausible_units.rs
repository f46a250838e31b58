//! Units in which a column's samples are plausible for a helicopter.

use gdcm_model::units::physical_unit::{Dimension, PhysicalUnit, conversion_factor};

use super::record_table::RecordColumn;

/// Largest value of a quantity that is plausible for a helicopter.
struct PlausibleLimit {
    dimension: Dimension,
    value: f64,
    unit: &'static str,
}

const fn limit(dimension: Dimension, value: f64, unit: &'static str) -> PlausibleLimit {
    PlausibleLimit {
        dimension,
        value,
        unit,
    }
}

const LIMITS: [PlausibleLimit; 7] = [
    limit(Dimension::AngularRate, 400.0, "deg/s"),
    limit(Dimension::Angle, 3600.0, "deg"),
    limit(Dimension::AngularAcceleration, 5000.0, "deg/s^2"),
    limit(Dimension::Acceleration, 15.0, "g"),
    limit(Dimension::Speed, 500.0, "kt"),
    limit(Dimension::Part, 3.0, "1"),
    limit(Dimension::Length, 50_000.0, "m"),
];

/// Units used in logs.
const LOGGED: [&str; 21] = [
    "rad/s", "deg/s", "rad", "deg", "rad/s^2", "deg/s^2", "g", "m/s^2", "ft/s^2", "m/s", "ft/s",
    "kt", "%", "1", "m", "cm", "mm", "ft", "in", "N", "lb",
];

/// Returns the largest value that is plausible for a helicopter in this unit; `None` if there is no
/// limit.
pub(super) fn largest_plausible(unit: &str) -> Option<f64> {
    let dimension = PhysicalUnit::parse(unit)?.dimension;
    let limit = LIMITS
        .into_iter()
        .find(|limit| limit.dimension == dimension)?;
    Some(limit.value * conversion_factor(limit.unit, unit)?)
}

/// Returns the units in which a column's samples are plausible for a channel with this unit: the
/// channel's unit first, then units used in logs with the same dimension, without those whose
/// largest plausible value is below the largest sample. Empty also if the samples are all zero or
/// missing, or the channel's unit is unknown.
pub(super) fn possible_units<'u>(column: &RecordColumn, unit: &'u str) -> Vec<&'u str> {
    let Some(peak) = column.peak() else {
        return Vec::new();
    };
    if peak <= 0.0 {
        return Vec::new();
    }
    let mut units = Vec::new();
    if PhysicalUnit::parse(unit).is_some() {
        units.push(unit);
    }
    for other in LOGGED {
        if conversion_factor(other, unit).is_some_and(|factor| factor != 1.0) {
            units.push(other);
        }
    }
    units.retain(|unit| largest_plausible(unit).is_none_or(|limit| peak <= limit));
    units
}
