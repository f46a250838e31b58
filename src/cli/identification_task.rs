//! One identification: the records of a condition, and what is asked of them.

use std::path::{Path, PathBuf};

use crate::executor::Pool;
use gdcm_core::assembly::ChannelRule;
use gdcm_core::dataset::{Band, BundleKind, ConditionId, ConditionRecord, Dataset};
use gdcm_core::identification::{
    ChannelPreparation, FlightRecord, Identification, IdentificationError, Options, Preparation, Role, identify,
};
use gdcm_core::records::{RecordChannels, RecordTable};
use gdcm_core::study::{ChannelTimeSkew, pieces_used};
use gdcm_files::IdentifiedModels;

use super::destination::Group;
use super::failure::Failure;
use super::identification_outcome::identified_models;
use super::identify_arguments::ChannelDelay;
use super::read_record::{ReadRecord, record_table};
use super::terminal::TerminalProgress;

/// Models are to be identified from these records.
pub(super) struct IdentificationTask {
    /// The condition of the dataset; none without one.
    pub(super) condition: Option<ConditionId>,
    records: Vec<ReadRecord>,
    flights: Vec<FlightRecord>,
    options: Options,
}

impl IdentificationTask {
    /// The task of a group of records.
    pub(super) fn new(
        (condition, records): Group,
        channels: &RecordChannels,
        preparation: &Preparation,
        band: Band,
    ) -> Result<Self, Failure> {
        let held_out = records.iter().enumerate().filter(|(_, record)| record.guess.held_out);
        let held_out: Vec<usize> = held_out.map(|(index, _)| index).collect();
        if held_out.len() == records.len() {
            let of = condition.map_or_else(String::new, |id| format!("condition {id}: "));
            let reason = format!("{of}every record is held out; at least one has to be left to identify from");
            return Err(Failure::Option { option: "--hold-out", reason });
        }
        let flight = |record: &ReadRecord| {
            let flight = record.layout.flight_record(&record.table, channels);
            flight.map_err(|_| Failure::Records { wrong: 1, of: records.len() })
        };
        let flights = records.iter().map(flight).collect::<Result<_, _>>()?;
        let options = Options { held_out, ..Options::new([band.min(), band.max()], preparation.clone()) };
        Ok(Self { condition, records, flights, options })
    }

    /// Identification proper, with a word about how far it is on a terminal.
    pub(super) fn run(&self) -> Result<Identification, IdentificationError> {
        let doing = self.condition.map_or_else(|| "identifying".to_owned(), |id| format!("identifying condition {id}"));
        identify(&self.flights, &self.options, &Pool, &TerminalProgress::new(&doing))
    }

    /// What was found, as its file says it.
    pub(super) fn models(&self, found: &Identification, channels: &RecordChannels) -> IdentifiedModels {
        let tables = self.records.iter().map(|record| &record.table);
        let with_tables: Vec<(&FlightRecord, &RecordTable)> = self.flights.iter().zip(tables).collect();
        identified_models(found, &self.options, &with_tables, channels)
    }

    /// A channel that is late in all records by what the nominal physics model of the condition says, and the option that takes its
    /// delay out.
    pub(super) fn late_channel(&self, found: &Identification, dataset: &Dataset) -> Option<String> {
        let condition = dataset.condition(self.condition?)?;
        let late = ChannelTimeSkew::of_condition(&found.measured, self.options.band, condition)?;
        let signal = late.signal(dataset)?;
        let Preparation { inputs, outputs, .. } = &self.options.preparation;
        let known = if late.role == Role::Input { inputs } else { outputs }.get(late.index)?.delay_s;
        let words = late.words(&signal.name, &condition.bundle(BundleKind::Physics).get(condition.nominal())?.name);
        Some(format!("{words} (--delay {}={:.3})", signal.name, known + late.delay_s))
    }

    /// What the dataset at `dataset` says of the records.
    pub(super) fn entries(&self, found: &Identification, asked: &[PathBuf], dataset: &Path) -> Vec<ConditionRecord> {
        let used = self.flights.iter().zip(&found.record_uses).map(|(flight, used)| pieces_used(flight, used));
        let records = self.records.iter().map(|record| record.entry(asked, dataset));
        records.zip(used).map(|(entry, used_s)| ConditionRecord { used_s, ..entry }).collect()
    }

    /// A line a record, below the condition where there is one.
    pub(super) fn table(&self) -> String {
        match self.condition {
            Some(id) => format!("condition {id}\n{}", record_table(&self.records, 2)),
            None => record_table(&self.records, 0),
        }
    }

    /// What stands before words about it.
    pub(super) fn label(&self) -> String {
        self.condition.map_or_else(String::new, |id| format!("condition {id}: "))
    }
}

/// How the channels are prepared: their known delays are taken out.
pub(super) fn preparation(channels: &RecordChannels, delays: &[ChannelDelay]) -> Result<Preparation, Failure> {
    let is_known =
        |delay: &ChannelDelay| channels.inputs.iter().chain(&channels.outputs).any(|rule| rule.name == delay.channel);
    if let Some(unknown) = delays.iter().find(|delay| !is_known(delay)) {
        let reason = format!("{} is none of the channels", unknown.channel);
        return Err(Failure::Option { option: "--delay", reason });
    }
    let prepared = |rule: &ChannelRule| {
        let delay = delays.iter().rfind(|delay| delay.channel == rule.name);
        ChannelPreparation {
            delay_s: delay.map_or(0.0, |delay| delay.delay_s),
            ..ChannelPreparation::named(rule.name.clone())
        }
    };
    Ok(Preparation {
        inputs: channels.inputs.iter().map(prepared).collect(),
        outputs: channels.outputs.iter().map(prepared).collect(),
        ..Preparation::of(&[], &[])
    })
}
