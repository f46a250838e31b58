//! Decisions of the engineer: settings, rejections, constraints, signs, and the edits that change them.

pub mod changed_models;
pub mod differences;
pub mod edit;
pub mod setting;
pub mod setting_row;
pub mod settings;
pub mod study;
