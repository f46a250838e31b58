//! Assigns condition numbers that neither files nor names give: by flight point, or by folder.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::found_model::{FoundModel, path_without_extension};
use super::row::Row;

/// Numbers the conditions: one per flight point if any file contains models at several airspeeds,
/// otherwise one per folder in alphabetical order.
pub(super) fn number_conditions(models: &[FoundModel], rows: &mut [Row]) {
    let files: BTreeSet<&str> = models.iter().map(FoundModel::file).collect();
    let by_airspeed = files
        .into_iter()
        .any(|file| has_several_airspeeds(models, file));
    if by_airspeed {
        number_flight_points(rows);
    } else {
        number_folders(models, rows);
    }
}

fn number_folders(models: &[FoundModel], rows: &mut [Row]) {
    let folders: BTreeSet<String> = models.iter().map(folder).collect();
    for (model, row) in models.iter().zip(rows) {
        let own = folder(model);
        let place = folders.iter().position(|folder| *folder == own);
        row.condition = place.map(|place| place as i64 + 1);
    }
}

/// Returns the folder that contains a model's file; empty if the path has no folder.
fn folder(model: &FoundModel) -> String {
    match path_without_extension(model.file()).rsplit_once('/') {
        Some((folder, _)) => folder.to_owned(),
        None => String::new(),
    }
}

/// Numbers the distinct flight points in ascending order from 1; models without an airspeed get no
/// condition.
fn number_flight_points(rows: &mut [Row]) {
    let mut points: Vec<[f64; 3]> = rows.iter().filter_map(flight_point).collect();
    points.sort_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
    points.dedup();
    for row in rows {
        row.condition = None;
        if let Some(own) = flight_point(row) {
            let place = points.iter().position(|point| *point == own);
            row.condition = place.map(|place| place as i64 + 1);
        }
    }
}

/// Returns airspeed \[kt\], altitude \[ft\] and mass \[kg\]; `None` without an airspeed. An unknown
/// altitude or mass sorts before all known values.
fn flight_point(row: &Row) -> Option<[f64; 3]> {
    Some([
        row.airspeed_kt?,
        row.altitude_ft.unwrap_or(f64::MIN),
        row.mass_kg.unwrap_or(f64::MIN),
    ])
}

/// Returns whether a file contains models at several airspeeds, and thus several conditions.
pub(super) fn has_several_airspeeds(models: &[FoundModel], file: &str) -> bool {
    let mut airspeeds = models
        .iter()
        .filter(|model| model.file() == file)
        .filter_map(|model| model.facts.airspeed_kt);
    let first = airspeeds.next();
    airspeeds.any(|airspeed| Some(airspeed) != first)
}
