//! Completes a single measured response's channel names from its variable name or file name.

use super::found_model::{ChannelLabel, FoundModel, path_without_extension};
use crate::names::response_name::ResponseNameError;
use crate::names::{KnownChannels, ResponseName};

impl FoundModel {
    /// Returns the channel names. For a single measured response, missing names are taken from the
    /// variable name, or else from the file name, as far as these contain `known` channel names.
    pub fn labels_with_name(&self, known: KnownChannels<'_>) -> NamedLabels {
        let mut named = NamedLabels {
            labels: [self.inputs.clone(), self.outputs.clone()],
            ambiguous: None,
        };
        if self.response().is_none() || self.inputs.len() != 1 || self.outputs.len() != 1 {
            return named;
        }
        let path = path_without_extension(self.file());
        let stem = path.rsplit('/').next().unwrap_or_default();
        for text in [self.variable(), stem] {
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

    /// Fills in missing channel names. If a name in the text is in the alias table but not in the
    /// dataset, it is kept, so that no other channel takes its place.
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
