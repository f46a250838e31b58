//! Window state: the study, how it is displayed, and its results.
//!
//! Begin with [`window_state`]; its `State` contains everything else. [`shown_results`] says which
//! results are shown, [`display`] holds the display options for all views.

pub mod across_display;
pub mod assembling;
pub mod assembly_columns;
pub mod assessment_display;
pub mod background;
pub mod channels_view;
pub mod column_groups;
pub mod computed_results;
pub mod condition_fit;
mod condition_identification;
pub mod condition_records;
pub mod curve_display;
pub mod dataset_form;
pub mod display;
pub mod evidence_cache;
pub mod excited_input;
pub mod export_form;
pub mod export_plan;
pub mod forms;
pub mod frequency_plots;
pub mod gain_display;
pub mod judging_display;
pub mod layout;
pub mod mapped_cost;
pub mod modes_cache;
pub mod notices;
pub mod opens_with;
pub mod pair_set;
pub mod panel_tables;
pub mod physics_display;
pub mod poles_display;
pub mod preferences;
pub mod record_change;
mod record_parts;
pub mod records;
pub mod records_page;
pub mod report_contents;
pub mod requirements_display;
pub mod selection;
pub mod settings_changes;
pub mod settings_session;
pub mod sheet;
pub mod shown_results;
pub mod time_role;
pub mod value_uncertainty;
pub mod view;
pub mod view_arrangement;
pub mod view_pages;
pub mod window_state;
