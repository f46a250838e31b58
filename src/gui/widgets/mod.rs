//! Widgets, tables and colours.

pub mod choices;
pub mod controls;
pub mod elision;
pub mod fields;
pub mod focus;
pub mod palette;
pub mod tables;
