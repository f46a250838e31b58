//! Trim-offset columns in the list of physics models, and the same offsets in words.
//!
//! A trim offset is the difference of a perturbed model's trim from the nominal trim, in one
//! coordinate such as the airspeed.

use std::collections::BTreeMap;

use gdcm_model::dataset::Model;
use gdcm_model::number_format::compact;

/// Right edges of the trim columns \[pt from the row's left edge\].
pub(super) const TRIM_ENDS: [f32; 3] = [70.0, 114.0, 154.0];

/// Trim coordinates that have a column each, and their headings.
pub(super) struct TrimColumns {
    coordinates: Vec<String>,
    pub(super) heads: Vec<String>,
}

impl TrimColumns {
    /// Creates the columns; `None` if a model has no trim, if there are no coordinates, or if there
    /// are more coordinates than columns.
    pub(super) fn new(models: &[Model]) -> Option<Self> {
        let mut coordinates: Vec<String> = Vec::new();
        for model in models {
            for coordinate in model.perturbation()?.keys() {
                if !coordinates.contains(coordinate) {
                    coordinates.push(coordinate.clone());
                }
            }
        }
        if coordinates.is_empty() || coordinates.len() > TRIM_ENDS.len() {
            return None;
        }
        let heads = coordinates
            .iter()
            .map(|coordinate| trim_head(coordinate))
            .collect();
        Some(Self { coordinates, heads })
    }

    /// Returns a model's offsets, "·" for zero; `None` if all are zero or the model has no trim.
    pub(super) fn offsets(&self, model: &Model) -> Option<Vec<String>> {
        let trim = model.perturbation()?;
        if trim.values().all(|offset| *offset == 0.0) {
            return None;
        }
        let mut offsets = Vec::new();
        for coordinate in &self.coordinates {
            offsets.push(match trim.get(coordinate) {
                Some(offset) if *offset != 0.0 => signed_compact(*offset),
                _ => "·".to_owned(),
            });
        }
        Some(offsets)
    }
}

/// Returns a short heading: "V kt" for "airspeed_kt".
fn trim_head(coordinate: &str) -> String {
    match coordinate {
        "airspeed_kt" => "V kt".to_owned(),
        "rate_of_climb_fpm" => "climb".to_owned(),
        "roll_deg" => "roll °".to_owned(),
        "pitch_deg" => "pitch °".to_owned(),
        "yaw_deg" | "heading_deg" => "yaw °".to_owned(),
        other => other
            .split('_')
            .next()
            .unwrap_or(other)
            .chars()
            .take(6)
            .collect(),
    }
}

/// Formats the offsets other than zero, such as "airspeed_kt +5, roll_deg −3"; "no perturbation" if
/// there are none.
pub(super) fn trim_words(trim: &BTreeMap<String, f64>) -> String {
    let offsets = trim.iter().filter(|(_, offset)| **offset != 0.0);
    let offsets: Vec<String> = offsets
        .map(|(name, offset)| format!("{name} {}", signed_compact(*offset)))
        .collect();
    if offsets.is_empty() {
        "no perturbation".to_owned()
    } else {
        offsets.join(", ")
    }
}

/// Formats with a sign, such as "+5" or "−3".
fn signed_compact(value: f64) -> String {
    let sign = if value > 0.0 { "+" } else { "" };
    format!("{sign}{}", compact(value))
}
