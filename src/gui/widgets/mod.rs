//! Widgets, tables, colours.

pub mod choices;
pub mod controls;
pub mod focus;
pub mod palette;
pub mod tables;
