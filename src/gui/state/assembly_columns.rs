//! Table columns for imported models.
//!
//! A part ([`Part`]) is a model found in a file (`found`) with its row in the rules (`row`): the
//! condition, the role and the perturbation of the trim that the model gets in the dataset.

use gdcm_model::assembly::part::Part;
use gdcm_model::units::number;

/// Column in the table that lists imported models.
pub struct Column {
    pub heading: &'static str,
    /// Column width, as a share of the table's width.
    pub share: f32,
    /// Returns the cell text; `None` if the value is still to be entered.
    pub cell: fn(&Part) -> Option<String>,
}

impl Column {
    /// Returns the cell text; "?" if the value is still to be entered.
    pub fn text(&self, part: &Part) -> String {
        (self.cell)(part).unwrap_or_else(|| "?".to_owned())
    }
}

/// The columns: condition, properties and source file for each model.
pub const COLUMNS: [Column; 9] = [
    Column {
        heading: "condition",
        share: 0.07,
        cell: |part| Some(part.row.condition?.to_string()),
    },
    Column {
        heading: "role",
        share: 0.08,
        cell: role_text,
    },
    Column {
        heading: "name",
        share: 0.16,
        cell: |part| Some(part.row.name.clone()),
    },
    Column {
        heading: "airspeed",
        share: 0.08,
        cell: |part| part.row.airspeed_words(),
    },
    Column {
        heading: "altitude",
        share: 0.07,
        cell: |part| Some(part.row.altitude_words()),
    },
    Column {
        heading: "weight",
        share: 0.07,
        cell: |part| Some(part.row.weight_words()),
    },
    Column {
        heading: "trim",
        share: 0.16,
        cell: |part| Some(trim_text(part)),
    },
    Column {
        heading: "model",
        share: 0.13,
        cell: |part| Some(part.found.words()),
    },
    Column {
        heading: "file",
        share: 0.18,
        cell: |part| Some(part.found.key()),
    },
];

/// Formats trim offsets: "roll_deg +5, airspeed_kt -10"; empty for a model without offsets.
fn trim_text(part: &Part) -> String {
    let mut offsets = Vec::new();
    for (coordinate, offset) in &part.row.perturbation {
        let sign = if *offset > 0.0 { "+" } else { "" };
        offsets.push(format!("{coordinate} {sign}{}", number(*offset)));
    }
    offsets.join(", ")
}

/// Returns the role, or "not included" for a model that is left out; `None` if the role is still to
/// be entered.
fn role_text(part: &Part) -> Option<String> {
    if part.row.left_out {
        return Some("not included".to_owned());
    }
    Some(part.row.role?.word().to_owned())
}
