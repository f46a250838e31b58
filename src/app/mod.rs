//! The window: the only place that knows eframe, file dialogs and threads.

mod dialogs;
mod files;
mod launch;
mod pool;
mod shortcuts;
mod update;
mod window;
mod worker;

pub use launch::open;
pub use pool::Pool;
pub use window::GdcmApp;
