//! The parameters that a dataset's runs move, with the changes that the engineer considers
//! plausible (M18.1).

use gdcm_model::dataset::physics_parameter::ParameterChange;
use gdcm_model::dataset::{Dataset, PhysicsParameter};

/// A parameter with runs.
#[derive(Clone, Debug, PartialEq)]
pub struct OfferedParameter {
    pub name: String,
    /// Unit for the changes.
    pub unit: String,
    /// Plausible change, one standard deviation, in `unit`; `z` counts in multiples of it.
    pub plausible_sd: f64,
    /// The parameter's meaning; empty if unknown.
    pub description: String,
}

impl OfferedParameter {
    /// Lists the parameters with at least one run in their unit: first those that the dataset
    /// declares, in its order, then the others by their first run.
    ///
    /// If the dataset does not state the plausible standard deviation, the largest step magnitude
    /// among the parameter's runs in its unit is used.
    pub fn list(dataset: &Dataset) -> Vec<Self> {
        let runs: Vec<&ParameterChange> = dataset
            .conditions()
            .iter()
            .flat_map(|condition| condition.moved_models())
            .filter_map(|moved| moved.run())
            .collect();
        let mut declared: Vec<PhysicsParameter> = dataset.parameters().to_vec();
        for run in &runs {
            if declared.iter().all(|parameter| parameter.name != run.name) {
                declared.push(PhysicsParameter {
                    name: run.name.clone(),
                    unit: run.unit.clone(),
                    plausible_sd: None,
                    description: String::new(),
                });
            }
        }
        let mut offered = Vec::new();
        for parameter in declared {
            let largest_step = runs
                .iter()
                .filter(|run| run.name == parameter.name && run.unit == parameter.unit)
                .map(|run| run.delta.abs())
                .fold(0.0, f64::max);
            if largest_step > 0.0 {
                offered.push(Self {
                    name: parameter.name,
                    unit: parameter.unit,
                    plausible_sd: parameter.plausible_sd.unwrap_or(largest_step),
                    description: parameter.description,
                });
            }
        }
        offered
    }
}
