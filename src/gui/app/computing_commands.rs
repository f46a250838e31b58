//! Commands that stop and resume the computation.

use super::GdcmApp;
use crate::gui::commands::computing::ComputingCommand;

impl GdcmApp {
    pub(super) fn carry_out_computing(&mut self, command: ComputingCommand) {
        match command {
            ComputingCommand::StopComputing => self.stop_work(),
            ComputingCommand::Compute => self.compute_again(),
        }
    }
}
