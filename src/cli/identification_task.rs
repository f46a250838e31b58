//! Identification of models from a condition's flight records: the task, its cautions with the
//! options that remove their causes, and the texts about its result. `identify` creates the tasks;
//! `identifications` and `plan` run them.

use std::path::{Path, PathBuf};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Dataset};
use gdcm_model::message_text::sanitized_path;
use gdcm_model::number_format::counted;
use gdcm_model::simulation::Signal;
use gdcm_study::jobs::identification_jobs::IdentificationRequest;
use gdcm_study::results::channel_time_skew::ChannelTimeSkew;
use gdcm_sysid::identification::{
    CautionNote, Identification, IdentificationCaution, IdentificationError, Preparation,
};
use gdcm_sysid::records::{LaidOutRecord, RecordChannels};
use gdcm_words::channel_time_skew::time_skew_text;
use gdcm_words::flight_plan::{PlannedChannels, PlannedInput, caution_with_advice};

use super::failure::Failure;
use super::receiving_dataset::RecordGroup;

use super::identify_arguments::{IdentifyArguments, RecordArguments};
use super::progress::ProgressReceiver;
use super::record_table::record_table;
use crate::executor::Pool;

/// Number of models that the file contains in addition to [`Identification::bundle`]: the refined
/// and the unrefined one.
const REFINED_AND_UNREFINED: usize = 2;
/// File name for the identified models, except with `--every-condition` (`output_path`).
pub(super) const IDENTIFIED_FILE: &str = "identified.json";

/// Records from which models are identified jointly.
pub(super) struct IdentificationTask {
    /// Condition in the dataset; `None` without a dataset.
    pub(super) condition: Option<ConditionId>,
    pub(super) records: Vec<LaidOutRecord>,
    request: IdentificationRequest,
}

impl IdentificationTask {
    pub(super) fn new(
        group: RecordGroup,
        preparation: &Preparation,
        band: Band,
        arguments: &RecordArguments,
    ) -> Result<Self, Failure> {
        let RecordGroup { condition, records } = group;
        let band_rad_s = [band.min(), band.max()];
        let mut request =
            IdentificationRequest::from_used(records.iter(), preparation.clone(), band_rad_s)
                .map_err(|why| {
                    // All records are held out: a group is not empty, and its records are usable.
                    Failure::option("--hold-out", format!("{}{why}", prefix(condition)))
                })?;
        arguments.search().set(&mut request.options);
        // References are recorded signals that drove the loop from outside, the last inputs.
        request.options.references = arguments.references().len();
        Ok(Self {
            request,
            condition,
            records,
        })
    }

    /// Identifies the models, and reports the progress to `receiver`.
    ///
    /// # Errors
    /// [`Failure::NoModels`] if no model is found; [`Failure::Cancelled`] if the work was stopped.
    pub(super) fn run(&self, receiver: ProgressReceiver<'_>) -> Result<Identification, Failure> {
        let work = match self.condition {
            Some(id) => format!("identifying condition {id}"),
            None => "identifying".to_owned(),
        };
        match self.request.identify(&Pool, &*receiver.begin(&work)) {
            Ok(found) => Ok(found),
            Err(IdentificationError::Stopped(stopped)) => Err(stopped.into()),
            Err(why) => Err(Failure::NoModels {
                reason: format!("no model was identified: {why}"),
            }),
        }
    }

    /// Returns whether a record with this name is among the task's records.
    pub(super) fn has_record(&self, name: &str) -> bool {
        self.records.iter().any(|record| record.table.name == name)
    }

    /// Returns the cautions, each with the options that solve the problem; with a dataset, also a
    /// caution about a channel that lags behind the physics model.
    pub(super) fn cautions(
        &self,
        found: &Identification,
        channels: &RecordChannels,
        dataset: Option<&Dataset>,
    ) -> Vec<CautionNote> {
        let planned = planned_channels(channels);
        let mut cautions = Vec::with_capacity(found.cautions.len());
        for caution in &found.cautions {
            let mut note = caution.note();
            note.text = caution_with_advice(caution, &found.advice, &planned);
            cautions.push(self.with_remedy(note, caution));
        }
        if let Some(dataset) = dataset {
            cautions.extend(self.late_channel(found, dataset));
        }
        cautions
    }

    /// Returns a caution if a channel in the measured responses lags behind the condition's nominal
    /// physics model; it names the option that removes the delay, with a value that includes the
    /// delay already removed.
    fn late_channel(&self, found: &Identification, dataset: &Dataset) -> Option<CautionNote> {
        let condition = dataset.condition(self.condition?)?;
        let options = &self.request.options;
        let late = ChannelTimeSkew::of_condition(&found.measured, options.band, condition)?;
        let signal = late.signal(dataset)?;
        let known_s = options.preparation.channel(&signal)?.delay_s;
        let physics = condition.bundle(BundleKind::Physics);
        let nominal = physics.get(condition.nominal())?;
        let words = time_skew_text(&late, &signal.name, &nominal.name);
        let delay_s = known_s + late.delay_s;
        let text = format!("{words} (--delay {}={delay_s:.3})", signal.name);
        Some(CautionNote {
            code: "time-skew",
            channel: Some(signal.name),
            text,
            ..CautionNote::default()
        })
    }

    /// Appends to a caution's note the options that remove its cause. Only a contradiction between
    /// records has such options: for each record with an identified fault, a channel's delay, or a
    /// factor other than 1.
    fn with_remedy(&self, mut note: CautionNote, caution: &IdentificationCaution) -> CautionNote {
        let IdentificationCaution::Contradiction { records, .. } = caution else {
            return note;
        };
        let outputs = self.outputs();
        // Two records that contradict each other are alternatives: it is unknown which is wrong.
        // A record's options belong together.
        let mut remedies: Vec<String> = Vec::new();
        for record in records {
            let Some(fault) = &record.fault else {
                continue;
            };
            let mut options: Vec<String> = Vec::new();
            for (signal, remedy) in fault.remedies(&outputs) {
                let name = &record.name;
                options.push(match remedy.factor {
                    1.0 => format!("--delay {name}:{signal}={:.3}", remedy.delay_s),
                    factor => format!("--factor {name}:{signal}={factor:.2}"),
                });
            }
            remedies.push(options.join(" "));
        }
        let remedies = remedies.join(" or ");
        if !remedies.is_empty() {
            note.text += &format!(" ({remedies})");
        }
        note
    }

    fn outputs(&self) -> Vec<Signal> {
        let channels = self.request.options.preparation.outputs.iter().enumerate();
        channels
            .map(|(index, channel)| Signal {
                role: ChannelSide::Output,
                index,
                name: channel.name.clone(),
            })
            .collect()
    }

    /// Returns a table with a line for each record; with a dataset, under a heading with the
    /// condition.
    pub(super) fn table(&self) -> String {
        match self.condition {
            Some(id) => format!("condition {id}\n{}", record_table(&self.records, 2)),
            None => record_table(&self.records, 0),
        }
    }

    /// Returns the path for the identified models; with `--every-condition`, the file name contains
    /// the condition.
    pub(super) fn output_path(&self, arguments: &IdentifyArguments) -> PathBuf {
        match self.condition {
            Some(id) if arguments.source.every_condition => arguments
                .out
                .join(format!("identified-condition-{id}.json")),
            _ => arguments.out.join(IDENTIFIED_FILE),
        }
    }

    /// Returns a line with the result and the path to its file. In it, chi2/dof is the mean squared
    /// residual relative to the noise, 1 if the model explains everything but the noise (M14).
    pub(super) fn outcome(&self, file: &Path, found: &Identification) -> String {
        let held_out = match found.held_out_cost {
            Some(cost) => format!(", {cost:.2} for the held-out records"),
            None => String::new(),
        };
        format!(
            "{}{}: {}; order {}, chi2/dof {:.2}{held_out}\n",
            prefix(self.condition),
            sanitized_path(file),
            counted(REFINED_AND_UNREFINED + found.bundle.len(), "model"),
            found.refined.order().unwrap_or_default(),
            found.cost,
        )
    }
}

/// Returns the channels' names, and the inputs' units, in the same order as in the records.
pub(super) fn planned_channels(channels: &RecordChannels) -> PlannedChannels {
    let mut planned = PlannedChannels::default();
    for input in &channels.inputs {
        planned.inputs.push(PlannedInput {
            name: input.name.clone(),
            unit: input.unit.clone(),
        });
    }
    for output in &channels.outputs {
        planned.outputs.push(output.name.clone());
    }
    planned
}

/// Returns the prefix for messages about a condition; empty without a condition.
pub(super) fn prefix(condition: Option<ConditionId>) -> String {
    match condition {
        Some(id) => format!("condition {id}: "),
        None => String::new(),
    }
}
