//! Widgets, tables, colours.

pub mod controls;
pub mod palette;
pub mod tables;
