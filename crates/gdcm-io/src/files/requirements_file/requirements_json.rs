//! `requirements.json`: the serialised findings, in which sentences replace the codes for missing
//! values, cautions get a sentence and bandwidths their level; and a requirement grid per role.
//!
//! A *finding* holds the values for one of four questions (bandwidth, modes, summary costs, time
//! histories) in a condition. The *grid* has the value and the verdict for each requirement and
//! condition, for the physics model alone and for the corrected model in a *role*: under the
//! condition's own correction, or under the schedule (M17).

use std::collections::BTreeMap;
use std::io;

use serde::Serialize;
use serde_json::Value;

use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_study::decisions::requirement_settings::RequirementSettings;
use gdcm_study::results::grid_requirement::Requirement;
use gdcm_study::results::grid_source::GridSource;
use gdcm_study::results::requirement_grid::{GridCount, GridRow, RequirementGrid};
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::results::time_histories::TimeHistories;
use gdcm_words::missing_results::{
    missing_reason_text, no_bandwidth_text, no_mode_value_text, no_summary_text,
    reversed_phase_text,
};

use crate::software::software;

const NAME: &str = "gdcm-requirements";
const VERSION: u64 = 1;

/// Findings on the requirements, with the dataset to which they apply.
#[derive(Clone, Copy)]
pub struct RequirementResults<'a> {
    pub requirements: &'a Requirements,
    pub time_histories: &'a TimeHistories,
    pub dataset: &'a Dataset,
    /// Level boundaries, tolerances and limits for the grid.
    pub settings: &'a RequirementSettings,
    /// SHA-256 of the dataset file.
    pub sha256: &'a str,
}

impl RequirementResults<'_> {
    /// Returns the requirement grid for a role of the corrected model.
    pub fn grid(&self, role: RequirementRole) -> RequirementGrid {
        RequirementGrid::new(&GridSource {
            requirements: self.requirements,
            histories: Some(self.time_histories),
            dataset: self.dataset,
            settings: self.settings,
            role,
        })
    }
}

/// Returns the content of `requirements.json`.
pub(super) fn requirements_json(results: RequirementResults<'_>) -> io::Result<Value> {
    let document = RequirementsDocument {
        format: NAME,
        version: VERSION,
        software: software(),
        dataset: DatasetName {
            name: results.dataset.name(),
            sha256: results.sha256,
        },
        requirements: results.requirements,
        time_histories: results.time_histories,
        grid: [RequirementRole::Corrected, RequirementRole::Scheduled]
            .map(|role| GridDocument::new(&results.grid(role), results))
            .into(),
    };
    with_sentences(&document, results)
}

/// Content of `requirements.json`: the dataset, the findings, the requirement grids.
#[derive(Serialize)]
struct RequirementsDocument<'a> {
    format: &'static str,
    version: u64,
    software: String,
    dataset: DatasetName<'a>,
    #[serde(flatten)]
    requirements: &'a Requirements,
    time_histories: &'a TimeHistories,
    grid: Vec<GridDocument>,
}

/// The grid for a role of the corrected model: counts, and the values by requirement and condition.
#[derive(Serialize)]
struct GridDocument {
    role: RequirementRole,
    #[serde(flatten)]
    count: GridCount,
    conditions: Vec<ConditionId>,
    rows: Vec<GridRowDocument>,
}

/// A requirement in all conditions; its values are fractions, seconds, costs or level numbers.
#[derive(Serialize)]
struct GridRowDocument {
    requirement: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    input: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    quantity: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mode: Option<String>,
    values: Vec<Option<f64>>,
    verdicts: Vec<&'static str>,
    physics_values: Vec<Option<f64>>,
    physics_verdicts: Vec<&'static str>,
}

impl GridDocument {
    fn new(grid: &RequirementGrid, results: RequirementResults<'_>) -> Self {
        Self {
            role: grid.role,
            count: grid.count(),
            conditions: grid
                .conditions
                .iter()
                .map(|condition| condition.id)
                .collect(),
            rows: grid
                .rows
                .iter()
                .map(|row| GridRowDocument::new(row, results))
                .collect(),
        }
    }
}

impl GridRowDocument {
    fn new(row: &GridRow, results: RequirementResults<'_>) -> Self {
        let mut document = Self {
            requirement: row.requirement.code(),
            output: None,
            input: None,
            quantity: None,
            mode: None,
            values: Vec::new(),
            verdicts: Vec::new(),
            physics_values: Vec::new(),
            physics_verdicts: Vec::new(),
        };
        match row.requirement {
            Requirement::Bandwidth(pair)
            | Requirement::PhaseDelay(pair)
            | Requirement::Level(pair) => {
                document.set_response(pair, results.dataset);
            }
            Requirement::PeakError(index) => {
                let tolerance = results.settings.tolerances.rows().get(index);
                document.quantity = tolerance.map(|tolerance| tolerance.quantity.clone());
            }
            Requirement::ModeFrequency(name) => document.mode = Some(name.to_string()),
            Requirement::MeanJOnAxis | Requirement::MeanJAll | Requirement::MuadShareOnAxis => {}
        }
        for cell in &row.cells {
            document.values.push(cell.corrected.value);
            document.verdicts.push(cell.corrected.verdict.code());
            document.physics_values.push(cell.physics.value);
            document.physics_verdicts.push(cell.physics.verdict.code());
        }
        document
    }

    fn set_response(&mut self, pair: Pair, dataset: &Dataset) {
        self.output = Some(dataset.outputs()[pair.output].name.clone());
        self.input = Some(dataset.inputs()[pair.input].name.clone());
    }
}

#[derive(Serialize)]
struct DatasetName<'a> {
    name: &'a str,
    sha256: &'a str,
}

/// Converts the findings to the content of `requirements.json`, adds levels to the bandwidths,
/// replaces codes for missing values by sentences, and adds sentences to the cautions.
fn with_sentences(
    document: &RequirementsDocument<'_>,
    results: RequirementResults<'_>,
) -> io::Result<Value> {
    let mut value = serde_json::to_value(document)?;
    for (index, finding) in results.requirements.bandwidth.iter().enumerate() {
        let entry = &mut value["bandwidth"][index];
        if let Some(level) = finding.level(&results.settings.levels) {
            entry["level"] = level.number().into();
        }
        replace_absent(entry, &finding.absent, no_bandwidth_text);
    }
    for (index, finding) in results.requirements.modes.iter().enumerate() {
        let models = [
            ("identified", Some(&finding.identified)),
            ("physics", finding.physics.as_ref()),
            ("corrected", finding.corrected.as_ref()),
        ];
        for (role, numbers) in models {
            if let Some(numbers) = numbers {
                let entry = &mut value["modes"][index][role];
                replace_absent(entry, &numbers.absent, |why| no_mode_value_text(*why));
            }
        }
    }
    for (index, finding) in results.requirements.summary.iter().enumerate() {
        let entry = &mut value["summary"][index];
        replace_absent(entry, &finding.absent, |why| no_summary_text(*why));
    }
    for (index, missing) in results.requirements.missing.iter().enumerate() {
        value["missing"][index]["why"] = missing_reason_text(&missing.why).into();
    }
    for (index, phase) in results.requirements.cautions.iter().enumerate() {
        value["cautions"][index]["text"] = reversed_phase_text(phase, results.dataset).into();
    }
    for (index, missing) in results.time_histories.missing.iter().enumerate() {
        let why = missing_reason_text(&missing.why);
        value["time_histories"]["missing"][index]["why"] = why.into();
    }
    Ok(value)
}

/// Replaces the codes for a finding's missing values by sentences.
fn replace_absent<T, S: Into<Value>>(
    entry: &mut Value,
    absent: &BTreeMap<&'static str, T>,
    text: impl Fn(&T) -> S,
) {
    for (name, why) in absent {
        entry["absent"][*name] = text(why).into();
    }
}
