//! Columns with a latitude or a longitude, whose names resemble those of inputs (LAT, LON).

use gdcm_model::names::channel_alias::folded_name;
use gdcm_model::names::channel_rule::ChannelRule;
use gdcm_model::units::physical_unit::conversion_factor;

use super::record_table::{RecordColumn, RecordTable};

/// Folded column names for a latitude.
const LATITUDE: [&str; 1] = ["lat"];
/// Folded column names for a longitude.
const LONGITUDE: [&str; 3] = ["lon", "long", "lng"];
/// Largest modulus of a latitude or longitude \[deg\].
const LARGEST_ANGLE_DEG: f64 = 180.0;
/// Largest position change in a record \[deg\]; a minute at 140 kt is 0.04 degrees.
const LARGEST_POSITION_CHANGE_DEG: f64 = 0.5;
/// Largest position change in a column without a unit, relative to its largest absolute value.
const LARGEST_RELATIVE_CHANGE: f64 = 0.02;
/// Largest relative position change in a column with exactly the channel's name: any stick moves
/// more in flight.
const LARGEST_RELATIVE_CHANGE_OF_NAMESAKE: f64 = 0.002;

/// Returns whether a column is a latitude or a longitude, whose names resemble input names: an
/// angle that hardly changes. Without a unit in the file, the table must have a latitude and a
/// longitude that are both nearly constant.
pub(super) fn is_position(table: &RecordTable, column: usize, rule: &ChannelRule) -> bool {
    let own = &table.columns[column];
    if !has_folded_name(own, &LATITUDE) && !has_folded_name(own, &LONGITUDE) {
        return false;
    }
    if let Some(unit) = own.unit_in_file() {
        return conversion_factor(unit, "deg").is_some_and(|factor| is_place_angle(own, factor));
    }
    let largest_change = if own.name == rule.name {
        LARGEST_RELATIVE_CHANGE_OF_NAMESAKE
    } else {
        LARGEST_RELATIVE_CHANGE
    };
    has_near_constant_angle(table, &LATITUDE, largest_change)
        && has_near_constant_angle(table, &LONGITUDE, largest_change)
}

fn has_folded_name(column: &RecordColumn, names: &[&str]) -> bool {
    names.contains(&folded_name(&column.name).as_str())
}

/// Returns whether samples, converted to degrees by `factor`, are within ±180° and change little.
fn is_place_angle(column: &RecordColumn, factor: f64) -> bool {
    let Some((least, most)) = column.range() else {
        return false;
    };
    (most - least) * factor < LARGEST_POSITION_CHANGE_DEG
        && least.abs().max(most.abs()) * factor <= LARGEST_ANGLE_DEG
}

/// Returns whether a column with a folded name from `names`, taken to be in degrees, passes
/// [`is_place_angle`] and changes, but by less than `largest_change` relative to its largest
/// absolute value.
fn has_near_constant_angle(table: &RecordTable, names: &[&str], largest_change: f64) -> bool {
    table.columns.iter().any(|column| {
        let Some((least, most)) = column.range() else {
            return false;
        };
        let change = (most - least) / least.abs().max(most.abs());
        has_folded_name(column, names)
            && is_place_angle(column, 1.0)
            && 0.0 < change
            && change < largest_change
    })
}
