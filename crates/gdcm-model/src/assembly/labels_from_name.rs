//! Completes a single measured response's channel names from its variable name or file name.

use super::found_model::{ChannelLabel, FoundModel, path_without_extension};
use crate::names::response_name::ResponseNameError;
use crate::names::{KnownChannels, ResponseName};

impl FoundModel {
    /// Returns the channel names, completed for a model that is a single measured response:
    ///
    /// 1. Missing names are taken from the variable name, as far as it contains `known` channel
    ///    names.
    /// 2. Names that are still missing are taken from the file name likewise.
    /// 3. If a name is missing in the end and step 1 or 2 met an ambiguous text, that is reported.
    pub fn labels_with_name(&self, known: KnownChannels<'_>) -> NamedLabels {
        let mut named = NamedLabels {
            labels: [self.inputs.clone(), self.outputs.clone()],
            ambiguous: None,
        };
        if self.response().is_none() || self.inputs.len() != 1 || self.outputs.len() != 1 {
            return named;
        }
        let path = path_without_extension(self.file());
        let file_name = path.rsplit('/').next().unwrap_or_default();
        // Steps 1 and 2
        for text in [self.variable(), file_name] {
            if named.are_complete() {
                break;
            }
            match ResponseName::find(text, known) {
                Ok(found) => named.fill(found, text),
                Err(error) => {
                    let name = text.to_owned();
                    let ambiguous = AmbiguousName { name, error };
                    named.ambiguous.get_or_insert(ambiguous);
                }
            }
        }
        // Step 3
        if named.are_complete() {
            named.ambiguous = None;
        }
        named
    }

    /// Returns the model with missing channel names taken from the variable name or file name, by
    /// the alias table.
    pub fn with_names_of_file(mut self) -> Self {
        [self.inputs, self.outputs] = self.labels_with_name(KnownChannels::AliasTable).labels;
        self
    }
}

/// A model's channel names, completed from its variable or file name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedLabels {
    /// Inputs and outputs.
    pub labels: [Vec<ChannelLabel>; 2],
    /// First variable or file name that is ambiguous; `None` if no channel name is missing in the
    /// end.
    pub ambiguous: Option<AmbiguousName>,
}

/// A variable or file name from which a response's channels cannot be determined.
#[derive(Clone, Debug, PartialEq)]
pub struct AmbiguousName {
    pub name: String,
    pub error: ResponseNameError,
}

impl NamedLabels {
    /// Returns whether the only input and the only output have names.
    fn are_complete(&self) -> bool {
        self.labels.iter().all(|labels| labels[0].name.is_some())
    }

    /// Fills in missing channel names with those `found` in the text.
    ///
    /// For a side that `found` lacks, a name from the alias table is taken, although the dataset
    /// has no such channel: the text "r_lon" names the output R, and a dataset without R must not
    /// get the response under the name of another output.
    fn fill(&mut self, found: ResponseName, text: &str) {
        let aliased = ResponseName::find(text, KnownChannels::AliasTable).unwrap_or_default();
        let input = found.input.or(aliased.input);
        let output = found.output.or(aliased.output);
        for (labels, name) in self.labels.iter_mut().zip([input, output]) {
            if labels[0].name.is_none() {
                labels[0].name = name;
            }
        }
    }
}
