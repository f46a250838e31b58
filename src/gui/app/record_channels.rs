//! Channels expected in a condition's flight records, and the topics' sample rate.

use gdcm_model::dataset::ConditionId;
use gdcm_model::names::ChannelRule;
use gdcm_sysid::records::RecordChannels;

use super::GdcmApp;

impl GdcmApp {
    /// Returns the channels expected in a condition's records: the dataset's channels, with the
    /// names and units in the files if the dataset was made from records. Topics are resampled as
    /// the identification band requires.
    pub(super) fn record_channels(&self, condition: ConditionId) -> RecordChannels {
        let mut channels = RecordChannels::of_dataset(&self.state.study.dataset);
        let [_, end] = self.state.identified_band(condition);
        channels.resampling.band_end = Some(end);
        let Some(made) = self.made_of_records() else {
            return channels;
        };
        let specified = [&made.channels.inputs, &made.channels.outputs];
        let specified: Vec<&ChannelRule> = specified.into_iter().flatten().collect();
        for rule in channels.inputs.iter_mut().chain(&mut channels.outputs) {
            if let Some(source) = specified.iter().find(|source| source.name == rule.name) {
                rule.aliases.clone_from(&source.aliases);
                rule.unit_in_files.clone_from(&source.unit_in_files);
            }
        }
        channels
    }

    /// Resamples a condition's topics if its identification band has changed and requires another
    /// sample rate.
    pub(super) fn follow_band(&mut self, condition: ConditionId) {
        let [_, end] = self.state.identified_band(condition);
        let Some(records) = self.state.records.conditions.get(&condition) else {
            return;
        };
        if records.clock_band_end == Some(end) {
            return;
        }
        let channels = self.record_channels(condition);
        if let Some(records) = self.state.records.conditions.get_mut(&condition) {
            records.follow_band(&channels);
        }
    }
}
