//! Contradictions between the values in a file and those in its name.
//!
//! A *trim offset* is the difference between the trim at which a model is linearised and its
//! condition's, by coordinate: "roll_deg", 5.

use std::collections::BTreeMap;

use super::condition_numbers::has_several_airspeeds;
use super::found_model::FoundModel;
use super::row::NameContradiction;
use crate::dataset::model::Origin;
use crate::names::NameFacts;

/// Maximum difference \[kt\] between an airspeed in a file and the rounded airspeed in its name.
const AIRSPEED_TOLERANCE_KT: f64 = 1.0;
/// Maximum relative difference between an altitude, mass or trim offset in a file and the rounded
/// value in its name; condition numbers must be equal.
const RELATIVE_TOLERANCE: f64 = 0.01;

/// Compares the values in a file with the rounded values in its name and folder names. If a file
/// contains models at several airspeeds, only trim offsets are compared, because the other values
/// in the names cannot apply to all its models. Datasets written by this program are not compared.
pub(super) fn name_contradictions(
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

/// A quantity as given by a file, and as given by the file's name.
struct Comparison {
    /// The quantity's key in the rules.
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

/// Returns the trim offsets stated in the file, by coordinate; empty for an identified model, or if
/// the file states none.
pub(super) fn trim_offsets(origin: &Origin) -> BTreeMap<String, f64> {
    match origin {
        Origin::Nominal { perturbation } | Origin::Perturbed { perturbation } => {
            perturbation.clone().unwrap_or_default()
        }
        Origin::Identified { .. } => BTreeMap::new(),
    }
}
