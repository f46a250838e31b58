//! The window: the only place that knows eframe, file dialogs and threads.

mod dialogs;
mod files;
mod launch;
mod shortcuts;
mod update;
mod window;
mod worker;

pub use launch::open;
pub use window::GdcmApp;
