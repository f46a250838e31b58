//! Models identified from flight records, in memory.

use std::ffi::OsString;
use std::path::Path;

use gdcm_io::files::identified_models::{add_identified, identified_json};
use gdcm_io::output_set::OutputSet;
use gdcm_model::dataset::Model;
use gdcm_model::message_text::sanitized;
use gdcm_model::progress::Progress;
use gdcm_study::decisions::adopted_models::AdoptedModels;
use gdcm_sysid::identification::Identification;
use gdcm_sysid::records::record_table::shortened_list;

use super::opened::OpenedData;
use super::options::parsed;
use super::{CallError, Called, Responses, called, response_of};
use crate::cli::dataset_lookup::condition_of;
use crate::cli::existing;
use crate::cli::failure::Failure;
use crate::cli::identifications::{DescribedIdentification, IdentificationBasis, Identifications};
use crate::cli::identify::{IdentificationTasks, identification_tasks};
use crate::cli::identify_arguments::{IdentifyArguments, OfferedChoice};
use crate::cli::progress::ProgressReceiver;
use crate::cli::requested_channels::{requested_band, requested_channels};

/// Models identified from flight records, with their description.
pub struct IdentifiedRecords {
    found: Identification,
    described: DescribedIdentification,
}

/// Identifies models from flight records with the options of `gdcm identify`, without a dataset.
///
/// # Errors
/// An option is wrong, the records cannot be used or identify no input, or the work was stopped.
pub fn identify(
    options: Vec<OsString>,
    progress: &dyn Progress,
) -> Result<Called<IdentifiedRecords>, CallError> {
    called(|| {
        let arguments: IdentifyArguments = parsed(options)?;
        let source = &arguments.source;
        let band = requested_band(source, None)?;
        let mut channels = requested_channels(source, None, band)?;
        let tasks = identification_tasks(source, None, &mut channels, band)?;
        let IdentificationTasks {
            tasks,
            reading,
            duplicates,
            ..
        } = &tasks;
        // Without a dataset, all records are one task.
        let [task] = &tasks[..] else {
            return Err(Failure::nothing_in(&source.records, "record"));
        };
        let basis = IdentificationBasis {
            arguments: &arguments,
            channels: &channels,
            reading,
            duplicates,
        };
        let found = task.run(ProgressReceiver::Program(progress))?;
        let outputs = OutputSet::new(existing(false), Vec::new());
        let mut identifications = Identifications::new(basis, None, outputs);
        let described = identifications.describe(task, &found);
        match identifications.without_input() {
            None => Ok(IdentifiedRecords { found, described }),
            Some(failure) => Err(failure),
        }
    })
}

impl IdentifiedRecords {
    /// Returns the results as the text of `identified.json`.
    ///
    /// # Errors
    /// The results cannot be written.
    pub fn json(&self) -> Result<Vec<u8>, CallError> {
        let text = called(|| {
            identified_json(&self.described.models(&self.found)).map_err(|error| {
                Failure::NoResult {
                    reason: error.to_string(),
                }
            })
        });
        Ok(text?.value)
    }

    /// Returns a model's response at the frequencies `omega` \[rad/s\], by output and input;
    /// without a name, the recommended model's.
    ///
    /// # Errors
    /// There is no model with this name.
    pub fn response(&self, model: Option<&str>, omega: &[f64]) -> Result<Responses, CallError> {
        let response = called(|| Ok(response_of(&self.model(model)?.dynamics, omega)));
        Ok(response?.value)
    }

    fn model(&self, name: Option<&str>) -> Result<&Model, Failure> {
        let Some(name) = name else {
            return Ok(&self.found.refined);
        };
        let models = [&self.found.refined, &self.found.unrefined].into_iter();
        for model in models.chain(&self.found.bundle) {
            if model.name == name {
                return Ok(model);
            }
        }
        let mut names = vec![
            self.found.refined.name.as_str(),
            self.found.unrefined.name.as_str(),
        ];
        names.extend(self.found.bundle.iter().map(|model| model.name.as_str()));
        let reason = sanitized(&format!(
            "there is no identified model \"{name}\"; models are {}",
            shortened_list(&names)
        ));
        Err(Failure::coded_option("--model", "unknown-model", reason))
    }

    /// Writes the text of `identified.json` to a file.
    ///
    /// # Errors
    /// The file exists and is not to be replaced, or cannot be written.
    pub fn save(&self, path: &Path, may_replace: bool) -> Result<(), CallError> {
        let mut outputs = OutputSet::new(existing(may_replace), Vec::new());
        called(|| {
            outputs.check(&[path])?;
            add_identified(&self.described.models(&self.found), path, &mut outputs)?;
            outputs.persist()?;
            Ok(())
        })?;
        Ok(())
    }

    /// Returns a dataset in which these models are the identified models in a condition: the
    /// recommended model, those of neighbouring orders and those without one record each
    /// ("refined"), these and the unrefined one ("with-unrefined"), or the measured response
    /// ("measured").
    ///
    /// # Errors
    /// The dataset has no such condition or other channels, `take` is none of these words, or the
    /// models do not fit the condition.
    pub fn put_into(
        &self,
        data: &OpenedData,
        condition: i64,
        take: &str,
    ) -> Result<Called<OpenedData>, CallError> {
        called(|| {
            let dataset = data.dataset();
            let id = condition_of(dataset, condition)?;
            let choice = <OfferedChoice as clap::ValueEnum>::from_str(take, false)
                .map_err(|reason| Failure::option("--take", reason))?;
            self.check_channels(data)?;
            let records = self.described.records.clone();
            let models = AdoptedModels::from_identification(&self.found, choice.offered(), records);
            let extended = models
                .put_into(dataset, id)
                .map_err(|refusal| Failure::NoModels {
                    reason: format!("the models cannot be added to the dataset: {refusal}"),
                })?;
            OpenedData::from_dataset(&extended, &format!("({})", sanitized(extended.name())))
        })
    }

    /// Checks that the models have a dataset's channels, in its order and units.
    fn check_channels(&self, data: &OpenedData) -> Result<(), Failure> {
        let dataset = data.dataset();
        let channels = &self.described.channels;
        let sides = [
            ("--inputs", &channels.inputs, dataset.inputs()),
            ("--outputs", &channels.outputs, dataset.outputs()),
        ];
        for (option, found, expected) in sides {
            let found: Vec<String> = found
                .iter()
                .map(|rule| format!("{} [{}]", rule.name, rule.unit))
                .collect();
            let expected: Vec<String> = expected
                .iter()
                .map(|channel| format!("{} [{}]", channel.name, channel.unit))
                .collect();
            if found != expected {
                let reason = format!(
                    "the dataset has {}, the models have {}",
                    expected.join(", "),
                    found.join(", ")
                );
                let reason = sanitized(&reason);
                return Err(Failure::coded_option(option, "other-channels", reason));
            }
        }
        Ok(())
    }
}
