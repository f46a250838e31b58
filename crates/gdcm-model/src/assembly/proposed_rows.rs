//! Proposal of each model's place in the dataset (condition, role, name and trim), from the file,
//! its name and the rules.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

use super::found_model::{FoundModel, path_without_extension};
use super::row::{NameContradiction, Row};
use super::rules::Rules;
use crate::dataset::model::Origin;
use crate::names::RowRole;
use crate::names::name_facts::NameFacts;
use crate::names::name_pattern::{read_name, unread_offsets};

/// Maximum difference \[kt\] between an airspeed in a file and the rounded airspeed in its name.
const AIRSPEED_TOLERANCE_KT: f64 = 1.0;
/// Maximum relative difference between another value in a file and the rounded value in its name.
const RELATIVE_TOLERANCE: f64 = 0.01;

/// Proposes a row for each model.
///
/// 1. Read the facts in the file and in its name.
/// 2. Number the conditions if no name does.
/// 3. Propose the nominal model of each condition.
/// 4. Apply the rules for single models.
pub(super) fn proposed_rows(models: &[FoundModel], rules: &Rules) -> Vec<Row> {
    let mut rows: Vec<Row> = models
        .iter()
        .map(|model| proposed_row(model, models, rules))
        .collect();
    if rows.iter().all(|row| row.condition.is_none()) {
        number_conditions(models, &mut rows);
    }
    propose_nominal(&mut rows);
    for (model, row) in models.iter().zip(&mut rows) {
        if let Some(rule) = rules.rows.get(&model.key()) {
            rule.apply(row);
        }
    }
    rows
}

/// Proposes a row from the contents and the name of a file; the contents take precedence.
fn proposed_row(model: &FoundModel, models: &[FoundModel], rules: &Rules) -> Row {
    let facts = &model.facts;
    let offsets = trim_offsets(&model.draft.origin);
    let path = path_without_extension(model.file());
    let name = if model.variable().is_empty() {
        path.clone()
    } else {
        format!("{path}#{}", model.variable())
    };
    let from_name = read_name(&name, &rules.patterns);
    let contradictions = name_contradictions(model, models, &from_name);
    let mut row = Row {
        left_out: false,
        condition: facts.condition.or(from_name.condition),
        role: file_role(model).or(from_name.role),
        name: from_name.name,
        airspeed_kt: facts.airspeed_kt.or(from_name.airspeed_kt),
        altitude: from_name.altitude,
        altitude_ft: facts.altitude_ft.or(from_name.altitude_ft),
        weight: from_name.weight,
        mass_kg: facts.mass_kg.or(from_name.mass_kg),
        method: from_name.method,
        perturbation: offsets.clone(),
        unread: Vec::new(),
        contradictions,
    };
    for (coordinate, offset) in from_name.perturbation {
        row.perturbation.entry(coordinate).or_insert(offset);
    }
    // `unread_offsets`: only look for misspelled offsets in names that contain a trim offset; in
    // others, a hyphen and a number ("rev-3") mean something else.
    if offsets.is_empty() && !row.perturbation.is_empty() {
        let last_part = name.rsplit('/').next().unwrap_or(&name);
        row.unread = unread_offsets(last_part, &rules.patterns);
    }
    if let Origin::Identified { method, .. } = &model.draft.origin
        && row.method.is_none()
    {
        row.method.clone_from(method);
    }
    if row.role.is_none() {
        row.role = implied_role(model, &row);
    }
    if row.name.is_empty() {
        row.name = default_name(model, models, rules, &path);
    }
    row
}

/// Returns the role of a physics model stated in its file; `None` if the file does not state it.
/// The origin "perturbed" is also the default, and counts only in a file of this program.
fn file_role(model: &FoundModel) -> Option<RowRole> {
    match &model.draft.origin {
        Origin::Nominal { .. } => Some(RowRole::Nominal),
        Origin::Perturbed { .. } if model.facts.is_of_dataset => Some(RowRole::Perturbed),
        Origin::Identified { .. } | Origin::Perturbed { .. } => None,
    }
}

/// Returns the role implied by the model: measured data is identified, a trim offset makes a
/// perturbed model; otherwise `None`.
fn implied_role(model: &FoundModel, row: &Row) -> Option<RowRole> {
    let is_identified = matches!(model.draft.origin, Origin::Identified { .. });
    if is_identified || model.response().is_some() {
        return Some(RowRole::Identified);
    }
    if row.perturbation.values().any(|offset| *offset != 0.0) {
        return Some(RowRole::Perturbed);
    }
    None
}

/// Returns the trim offsets stated in the file, by coordinate.
fn trim_offsets(origin: &Origin) -> BTreeMap<String, f64> {
    match origin {
        Origin::Nominal { perturbation } | Origin::Perturbed { perturbation } => {
            perturbation.clone().unwrap_or_default()
        }
        Origin::Identified { .. } => BTreeMap::new(),
    }
}

/// Compares the values in a file with the rounded values in its name and folder names. If a file
/// holds models at several airspeeds, only trim offsets are compared, because the other values in
/// the names cannot apply to all its models.
fn name_contradictions(
    model: &FoundModel,
    models: &[FoundModel],
    from_name: &NameFacts,
) -> Vec<NameContradiction> {
    let facts = &model.facts;
    let mut contradictions = Vec::new();
    if facts.is_of_dataset {
        return contradictions;
    }
    if !has_several_airspeeds(models, model.file()) {
        let comparisons = [
            Comparison {
                field: "condition".to_owned(),
                of_file: facts.condition.map(|id| id as f64),
                of_name: from_name.condition.map(|id| id as f64),
                tolerance: 0.0,
            },
            Comparison {
                field: "airspeed_kt".to_owned(),
                of_file: facts.airspeed_kt,
                of_name: from_name.airspeed_kt,
                tolerance: AIRSPEED_TOLERANCE_KT,
            },
            Comparison::relative("altitude_ft", facts.altitude_ft, from_name.altitude_ft),
            Comparison::relative("mass_kg", facts.mass_kg, from_name.mass_kg),
        ];
        for comparison in comparisons {
            contradictions.extend(comparison.contradiction());
        }
    }
    for (coordinate, offset) in trim_offsets(&model.draft.origin) {
        let of_name = from_name.perturbation.get(&coordinate).copied();
        let field = format!("perturbation, {coordinate}");
        let comparison = Comparison::relative(&field, Some(offset), of_name);
        contradictions.extend(comparison.contradiction());
    }
    contradictions
}

/// A quantity as given by a file, and as given by the name of the file.
struct Comparison {
    /// Key of the quantity in the rules.
    field: String,
    of_file: Option<f64>,
    of_name: Option<f64>,
    /// Maximum difference attributed to rounding.
    tolerance: f64,
}

impl Comparison {
    /// Creates a comparison with the relative tolerance.
    fn relative(field: &str, of_file: Option<f64>, of_name: Option<f64>) -> Self {
        Self {
            field: field.to_owned(),
            of_file,
            of_name,
            tolerance: RELATIVE_TOLERANCE * of_file.unwrap_or(0.0).abs(),
        }
    }

    fn contradiction(self) -> Option<NameContradiction> {
        let of_file = self.of_file?;
        let of_name = self.of_name?;
        if (of_file - of_name).abs() <= self.tolerance {
            return None;
        }
        Some(NameContradiction {
            field: self.field,
            of_file,
            of_name,
        })
    }
}

/// Returns whether a file holds models at several airspeeds, and thus several conditions.
fn has_several_airspeeds(models: &[FoundModel], file: &str) -> bool {
    let mut airspeeds = models
        .iter()
        .filter(|model| model.file() == file)
        .filter_map(|model| model.facts.airspeed_kt);
    let first = airspeeds.next();
    airspeeds.any(|airspeed| Some(airspeed) != first)
}

/// Returns the default name of a model: "measured" for a part of a measured model; otherwise the
/// name in the file, the variable if the file has several models, or the file name.
fn default_name(model: &FoundModel, models: &[FoundModel], rules: &Rules, path: &str) -> String {
    let is_part =
        model.inputs.len() * model.outputs.len() < rules.inputs.len() * rules.outputs.len();
    if model.response().is_some() && is_part {
        return "measured".to_owned();
    }
    if let Some(name) = &model.facts.name {
        return name.clone();
    }
    let in_file = models
        .iter()
        .filter(|other| other.file() == model.file())
        .count();
    if in_file > 1 && !model.variable().is_empty() {
        return model.variable().to_owned();
    }
    let stem = path.rsplit('/').next().unwrap_or(path);
    if stem.is_empty() {
        model.draft.name.clone()
    } else {
        stem.to_owned()
    }
}

/// Numbers the conditions: one per flight point if any file holds models at several airspeeds,
/// otherwise one per folder in alphabetical order.
fn number_conditions(models: &[FoundModel], rows: &mut [Row]) {
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

/// Returns the folder of a model's file; empty if the path has no folder.
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

/// Proposes the nominal role in each condition without a nominal model, if exactly one model there
/// has no role yet.
fn propose_nominal(rows: &mut [Row]) {
    let conditions: BTreeSet<i64> = rows.iter().filter_map(|row| row.condition).collect();
    for condition in conditions {
        let mut has_nominal = false;
        let mut without_role = Vec::new();
        for (index, row) in rows.iter().enumerate() {
            if row.condition == Some(condition) {
                match row.role {
                    Some(RowRole::Nominal) => has_nominal = true,
                    Some(RowRole::Perturbed | RowRole::Identified) => {}
                    None => without_role.push(index),
                }
            }
        }
        if let [only] = without_role.as_slice()
            && !has_nominal
        {
            rows[*only].role = Some(RowRole::Nominal);
        }
    }
}
