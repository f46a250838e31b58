//! Flight records of the condition shown, and the models identified from them.

mod advanced;
mod condition_table;
mod histories;
mod outcome;
mod record_list;
mod records_state;
mod records_view;
mod response;
mod simulation;
mod wanted_dataset;

pub use condition_table::condition_table;
pub use records_state::{ConditionRecords, RecordsCommand, RecordsPage, RecordsReading, RecordsState};
pub use records_view::{records_header_ui, records_view_ui};
pub use simulation::{TimeModel, simulation_jobs};
pub use wanted_dataset::WantedDataset;

use advanced::{ORDERS, REFERENCES, advanced_ui, possible_references};
use condition_table::condition_table_ui;
use histories::{Source, histories_ui, inputs_ui, kept};
use outcome::{offered_menu_ui, outcome_ui};
use record_list::{BAD, CHI_SQUARED, columns_ui, cost_text, record_list_ui};
use records_state::Page;
use response::{identified_poles_ui, response_ui, stabilisation_ui};
use simulation::{fit_ui, simulated, time_models_ui};
