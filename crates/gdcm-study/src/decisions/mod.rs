//! The engineer's decisions: settings, rejections, constraints, signs, and the edits that change
//! them.

pub mod adopted_models;
pub mod changed_models;
pub mod choices;
pub mod dataset_differences;
pub mod edit;
pub mod edit_refusal;
pub mod export_choices;
pub mod history;
pub mod named_decisions;
pub mod physics_settings;
pub mod requirement_settings;
pub mod setting;
pub mod setting_table;
mod setting_text;
pub mod setting_value;
pub mod settings;
pub mod signs;
pub mod study;
pub mod variants;
