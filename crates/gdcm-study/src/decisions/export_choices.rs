//! Choices in the export dialog, remembered in the study. No result depends on them, and the undo
//! history ignores them.

use std::collections::BTreeSet;

use gdcm_model::dataset::ConditionId;

/// Choices in the last export: formats, contents and destination.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportChoices {
    /// Formats, named as on the command line: "json", "m".
    pub formats: BTreeSet<String>,
    /// Exported conditions; all if `None`, also those that a later dataset adds.
    pub conditions: Option<BTreeSet<ConditionId>>,
    /// Whether corrected models get their condition's own correction, not the schedule.
    pub per_condition: bool,
    /// Physics model for each condition: "nominal", "representative", or a model name.
    pub model: String,
    /// Airspeeds in lookup tables \[kt\]; the scheduled conditions' airspeeds if `None`.
    pub breakpoints_kt: Option<Vec<f64>>,
    /// Padé order for delays.
    pub pade_order: usize,
    /// Folder as typed or chosen; `None` before the first export.
    pub folder: Option<String>,
    /// Beginning of every file name; derived from the study's name if `None`.
    pub prefix: Option<String>,
    /// Whether existing files are replaced; otherwise the new files get a number.
    pub replaces: bool,
}

impl ExportChoices {
    /// Model at the condition's own trim.
    pub const NOMINAL: &'static str = "nominal";
    /// Model that represents the bundle.
    pub const REPRESENTATIVE: &'static str = "representative";
}

impl Default for ExportChoices {
    fn default() -> Self {
        Self {
            formats: ["json", "csv", "assessment"].map(str::to_owned).into(),
            conditions: None,
            per_condition: false,
            model: Self::NOMINAL.to_owned(),
            breakpoints_kt: None,
            pade_order: 2,
            folder: None,
            prefix: None,
            replaces: false,
        }
    }
}
