//! Flight records of the condition shown, and the models identified from them.

mod bench;
mod channel_rows;
mod fit;
mod histories;
mod inputs;
mod kept;
mod outcome;
mod poles;
mod record_list;
mod records_view;
mod response;
mod simulation;
mod stabilisation;

pub use bench::{ConditionRecords, RecordRow, RecordsBench, RecordsCommand, RecordsPage, RecordsReading};
pub use records_view::{records_header_ui, records_view_ui};
pub use simulation::{TimeModel, simulation_jobs};
