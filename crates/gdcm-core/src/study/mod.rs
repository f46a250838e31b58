//! What the engineer does: settings, rejections, pins; and the analysis of it all, in cached stages.

mod across_job;
mod across_role;
mod airspeed_difference;
mod analysis;
mod assessment_table;
mod bar_source;
mod carry_over;
mod caution;
mod comparison;
mod condition_analysis;
mod condition_modes;
mod condition_responses;
mod condition_stages;
mod curves;
mod decision_difference;
mod derivation;
mod document;
mod edit;
mod engine;
mod execution;
mod export_format;
mod export_request;
mod history;
mod identified_bundle;
mod identify_job;
mod inventory;
mod job;
mod late_channel;
mod lead_offer;
mod lead_remark;
mod led;
mod memo;
mod progress;
mod remark;
mod setting;
mod settings;
mod simulation_job;
mod swaps;
mod table;
mod taken_models;
mod toggles;
mod uncertainty;
mod uncertainty_job;
mod uncertainty_tables;
mod variant;
mod variant_job;

pub use across_job::{AcrossCurves, AcrossJob};
pub use across_role::AcrossRole;
pub use airspeed_difference::AirspeedDifference;
pub use analysis::{Analysis, Assessed};
pub use assessment_table::{
    AssessedCondition, AssessedCorrection, AssessedModel, AssessmentChoice, AssessmentJob, AssessmentSummary,
    AssessmentTable, LeftOut, held_out_verdict,
};
pub use carry_over::{Decisions, Difference};
pub use caution::{BundleModel, Caution, NotFinite, Undefined};
pub use comparison::{BundleMetrics, Comparison, cautions_of_models};
pub use condition_analysis::{ConditionAnalysis, ConditionFailure};
pub use condition_modes::{ConditionModes, ModelModes};
pub use condition_responses::ConditionResponses;
pub use curves::{CURVE_POINTS, ConditionCurves, display_band};
pub use decision_difference::{DecisionDifference, decision_differences};
pub use derivation::{Derivation, ExplainTarget, derivation};
pub use document::{BundleChoice, ConditionChoice, Study};
pub use edit::{Edit, EditRefusal, LONGEST_REASON};
pub use engine::{Engine, LIVE_PROOF};
pub use execution::Execution;
pub use export_format::ExportFormat;
pub use export_request::{ExportRequest, ExportedRole};
pub use history::History;
pub use identified_bundle::{OfferedModels, identified_bundle, pieces_used};
pub use identify_job::{IdentificationNews, IdentifyJob};
pub use inventory::{ConditionInventory, Inventory};
pub use job::{CurvesJob, Job, ModesJob, ProofJob, TogglesJob};
pub use late_channel::ChannelTimeSkew;
pub use lead_offer::LeadOffer;
pub use lead_remark::{lead_cautions, lead_words, servo_words};
pub use led::LeadCompensated;
pub use progress::{Cancelled, Progress, Unobserved};
pub use remark::{Remark, RemarkKind, details, remarks};
pub use setting::Setting;
pub use settings::{
    DEFAULT_AGREEMENT_DB, DEFAULT_COHERENCE, DelayFrom, GREATEST_AGREEMENT_DB, GREATEST_DELAY_S, GREATEST_GAIN,
    GREATEST_QUANTILE, LARGEST_ALPHA, LEAD_LIMITS, LEAD_POLES, LEAST_GAIN, LEAST_POINTS, MOST_POINTS, PhaseCorrection,
    Settings,
};
pub use simulation_job::SimulationJob;
pub use swaps::ConditionSwaps;
pub use table::Table;
pub use taken_models::{AdoptedModels, Taken};
pub use toggles::Toggles;
pub use uncertainty::{ConditionUncertainty, PairScatter, ScheduleBands, SecondVariableTest, Uncertainty};
pub use uncertainty_job::UncertaintyJob;
pub use uncertainty_tables::{bar_table, difference_table, scatter_table, second_variable_table};
pub use variant::{LONGEST_VARIANT_NAME, Variant};
pub use variant_job::VariantJob;
