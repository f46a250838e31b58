//! The window: the only place that knows eframe, file dialogs and threads.

mod assembling;
mod autosave;
mod beside;
mod dialogs;
mod disk_watch;
mod exports;
pub mod fault;
mod figures;
mod files;
mod key_order;
mod lane;
mod launch;
mod pool;
mod recent;
mod records;
mod recovery;
mod reload;
mod report;
mod setup;
mod shortcuts;
mod update;
mod window;
mod worker;

pub use launch::open;
pub use pool::Pool;
pub use setup::Setup;
pub use window::GdcmApp;
pub use worker::EngineMaker;
