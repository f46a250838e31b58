//! What the engineer does: settings, rejections, pins; and the analysis of it all, in cached stages.

mod analysis;
mod carry_over;
mod caution;
mod comparison;
mod condition_analysis;
mod condition_responses;
mod condition_stages;
mod curves;
mod document;
mod edit;
mod engine;
mod executor;
mod history;
mod inventory;
mod job;
mod memo;
mod progress;
mod remark;
mod setting;
mod settings;
mod table;
mod toggles;

pub use analysis::{Analysis, Assessed};
pub use carry_over::{Decisions, Difference};
pub use caution::{BundleModel, Caution, NotFinite, Undefined};
pub use comparison::{BundleFigures, Comparison, cautions_of_models};
pub use condition_analysis::{ConditionAnalysis, ConditionFailure};
pub use condition_responses::ConditionResponses;
pub use curves::{ConditionCurves, display_band};
pub use document::{BundleChoice, ConditionChoice, Study};
pub use edit::{Edit, EditRefusal};
pub use engine::{Engine, LIVE_PROOF};
pub use executor::{Execution, Executor, Sequential, Task};
pub use history::History;
pub use inventory::{ConditionInventory, Inventory};
pub use job::{CurvesJob, Job, ProofJob, TogglesJob};
pub use progress::{Cancelled, Progress, Unobserved};
pub use remark::{Remark, RemarkKind, details, remarks};
pub use setting::Setting;
pub use settings::{
    GREATEST_DELAY_S, GREATEST_GAIN, GREATEST_QUANTILE, LARGEST_ALPHA, LEAST_GAIN, LEAST_POINTS, MOST_POINTS, Settings,
};
pub use table::Table;
pub use toggles::Toggles;
