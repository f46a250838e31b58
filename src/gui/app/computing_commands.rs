//! Commands that stop and resume the computation.

use gdcm_model::dataset::ConditionId;

use super::GdcmApp;
use crate::gui::commands::computing::ComputingCommand;
use crate::message::Message;

impl GdcmApp {
    pub(super) fn carry_out_computing(&mut self, command: ComputingCommand) {
        match command {
            ComputingCommand::StopComputing => self.stop_work(),
            ComputingCommand::Compute => self.compute_again(),
        }
    }

    /// Stops the work shown next to the Stop button: the reading of a file and of records, or, if
    /// nothing is being read, the computation.
    pub(super) fn stop_work(&mut self) {
        let opening = self.state.opening.take();
        let records = self.state.records.reading.take();
        let Some(name) = opening.or_else(|| records.clone()) else {
            return self.stop_jobs();
        };
        self.readers.opener.give_up();
        self.readers.record_reader.give_up();
        if records.is_some() {
            // Create entries, even without records, to prevent another automatic search for
            // records.
            let ids: Vec<ConditionId> = self.state.study.dataset.ids().collect();
            for id in ids {
                self.records_of(id);
            }
        }
        let text = format!("stopped reading {name}; the open study is unchanged");
        self.notify_done(Message::new("reading-stopped", text));
    }
}
