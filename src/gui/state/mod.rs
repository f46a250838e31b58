//! State of the window: document, display, results.

pub mod curve_display;
pub mod display;
pub mod figures;
pub mod focus;
pub mod window_state;
