//! Compares a flight record with simulations of its condition's models, for plots with tolerance
//! corridors about the measured outputs (M17.2). A role is a version of the model: physics,
//! corrected, scheduled or identified.

use gdcm_method::requirements::tolerance_check::ToleranceError;
use gdcm_method::requirements::{RecordCheck, Tolerance, ToleranceTable};
use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::Executor;
use gdcm_model::simulation::{FlightRecord, Segment, Validation, ValidationError, validate};
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::spectra::preparation::segments_of;
use gdcm_sysid::spectra::preparation_settings::PreparationError;

use super::analysis::{Analysis, NoResult};
use super::missing_finding::NoRoleModel;
use super::record_comparison::{RecordComparison, common_windows, comparison_preparation};
use super::requirement_role::RequirementRole;
use super::time_histories::HistoryRecord;
use crate::shared::Shared;

/// A quantity in a flight record: measured, and simulated with each model.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantityHistory {
    pub tolerance: Tolerance,
    /// Output from which the quantity is computed.
    pub output: usize,
    /// The compared quantity's unit.
    pub unit: String,
    /// Whether the output is on-axis to the input with the largest variation; `None` where that
    /// input cannot be determined.
    pub on_axis: Option<bool>,
    /// Each model's result, in the same windows for all models.
    pub models: Vec<(RequirementRole, RecordCheck)>,
}

/// A record and its simulations, with tolerances.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordHistory {
    pub condition: ConditionId,
    pub record: String,
    /// Whether the record was excluded from the models' identification.
    pub held_out: bool,
    /// The record, in the units of the dataset's channels.
    pub flight: Shared<FlightRecord>,
    /// Input with the largest variation; `None` where the inputs have different units.
    pub moved_input: Option<usize>,
    /// Result for each applicable tolerance row.
    pub quantities: Vec<QuantityHistory>,
    /// Why other models or quantities are not compared.
    pub missing: Vec<NotInHistory>,
}

/// Why a record comparison lacks a model or a quantity.
#[derive(Clone, Debug, PartialEq)]
pub enum NotInHistory {
    NoRoleModel(NoRoleModel),
    NotSimulated {
        role: RequirementRole,
        why: ValidationError,
    },
    /// A tolerance row is not applicable.
    ToleranceNotApplied(ToleranceError),
}

impl NotInHistory {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoRoleModel(_) => "no-role-model",
            Self::NotSimulated { .. } => "not-simulated",
            Self::ToleranceNotApplied(_) => "tolerance-not-applied",
        }
    }
}

/// Why a record is not compared with a condition's models.
#[derive(Clone, Debug, PartialEq)]
pub enum NoRecordHistory {
    NoResult(NoResult),
    NotPrepared(PreparationError),
}

impl NoRecordHistory {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoResult(why) => why.code(),
            Self::NotPrepared(_) => "record-not-prepared",
        }
    }
}

/// A record to compare with a condition's models.
pub(crate) struct ComparedRecord<'a> {
    pub(crate) condition: ConditionId,
    pub(crate) record: &'a HistoryRecord,
    pub(crate) preparation: &'a Preparation,
    pub(crate) tolerances: &'a ToleranceTable,
}

impl RecordHistory {
    /// Simulates the condition's models with the record, and checks the results against the
    /// tolerances.
    ///
    /// # Errors
    /// [`NoRecordHistory`] without a result for the condition, and if the record cannot be
    /// prepared.
    pub(crate) fn new(
        analysis: &Analysis,
        compared: &ComparedRecord<'_>,
        executor: &dyn Executor,
    ) -> Result<Self, NoRecordHistory> {
        let result = analysis
            .result(compared.condition)
            .map_err(NoRecordHistory::NoResult)?;
        let record = compared.record;
        let preparation = comparison_preparation(compared.preparation);
        let segments =
            segments_of(&record.flight, &preparation).map_err(NoRecordHistory::NotPrepared)?;
        let mut missing = Vec::new();
        let mut models = Vec::new();
        for role in RequirementRole::ALL {
            match analysis.role_model(result, role) {
                Ok(model) => models.push((role, model)),
                Err(why) => missing.push(NotInHistory::NoRoleModel(NoRoleModel { role, why })),
            }
        }
        let settings = common_windows(models.iter().map(|(_, model)| model), &segments);
        let mut validations = Vec::new();
        for (role, model) in &models {
            match validate(model, &segments, &settings, executor) {
                Ok(validation) => validations.push((*role, validation)),
                Err(why) => missing.push(NotInHistory::NotSimulated { role: *role, why }),
            }
        }
        let comparison = RecordComparison::new(&analysis.study.dataset, compared.tolerances);
        for why in &comparison.not_applied {
            missing.push(NotInHistory::ToleranceNotApplied(why.clone()));
        }
        Ok(Self {
            condition: compared.condition,
            record: record.flight.name.clone(),
            held_out: record.held_out,
            flight: record.flight.clone(),
            moved_input: comparison.moved_input(&segments),
            quantities: quantities(&comparison, &segments, &validations),
            missing,
        })
    }
}

/// Checks each role's simulation against every tolerance row.
fn quantities(
    comparison: &RecordComparison<'_>,
    segments: &[Segment],
    validations: &[(RequirementRole, Validation)],
) -> Vec<QuantityHistory> {
    let moved = comparison.moved_input(segments);
    let mut quantities = Vec::new();
    for row in &comparison.rows {
        let mut models = Vec::new();
        for (role, validation) in validations {
            // All windows are from one record, which has a single check. A role without a check
            // is absent from the plot.
            if let Ok(checks) = RecordCheck::of_windows(&validation.windows, &row.channel)
                && let Some(check) = checks.into_iter().next()
            {
                models.push((*role, check));
            }
        }
        quantities.push(QuantityHistory {
            tolerance: row.tolerance.clone(),
            output: row.channel.output,
            unit: row.channel.unit.clone(),
            on_axis: comparison.is_on_axis(row.channel.output, moved),
            models,
        });
    }
    quantities
}
