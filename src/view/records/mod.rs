//! Flight records of the condition shown, and the models identified from them.

mod histories;
mod outcome;
mod record_list;
mod records_state;
mod records_view;
mod response;
mod simulation;

pub use records_state::{ConditionRecords, RecordsCommand, RecordsPage, RecordsReading, RecordsState};
pub use records_view::{records_header_ui, records_view_ui};
pub use simulation::{TimeModel, simulation_jobs};
