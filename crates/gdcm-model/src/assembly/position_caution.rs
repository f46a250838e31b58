//! Cautions about models whose channels were matched by position.

use super::assembly::Assembly;
use super::indexed_part::parts_in_use;
use crate::dataset::channel::ChannelSide;

/// Caution about models whose channels were matched by position, because their files do not name
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionCaution {
    /// Inputs, outputs or both.
    pub sides: Vec<ChannelSide>,
    /// Model indices in [`Assembly::parts`].
    pub parts: Vec<usize>,
}

impl PositionCaution {
    /// Returns a stable code for scripts and tests.
    pub fn code(&self) -> &'static str {
        "channels-by-position"
    }
}

impl Assembly {
    /// Returns a caution for each combination of sides (inputs, outputs) that were matched by
    /// position in some model. Unlike problems, cautions do not keep the dataset from being built.
    pub fn cautions(&self) -> Vec<PositionCaution> {
        let mut cautions: Vec<PositionCaution> = Vec::new();
        for part in parts_in_use(self.parts()) {
            let sides = part.part.sides_by_position();
            if sides.is_empty() {
                continue;
            }
            match cautions.iter_mut().find(|caution| caution.sides == sides) {
                Some(known) => known.parts.push(part.index),
                None => cautions.push(PositionCaution {
                    sides,
                    parts: vec![part.index],
                }),
            }
        }
        cautions
    }

    /// Describes a caution: which channels were assumed, and up to three model files.
    pub fn caution_words(&self, caution: &PositionCaution) -> String {
        const MOST_FILES: usize = 3;
        let mut files: Vec<String> = Vec::new();
        for part in caution.parts.iter().take(MOST_FILES) {
            files.push(self.parts()[*part].found.key());
        }
        if caution.parts.len() > MOST_FILES {
            files.push(format!("{} more", caution.parts.len() - MOST_FILES));
        }
        let mut sides: Vec<String> = Vec::new();
        for side in &caution.sides {
            let channels = side.pick(&self.rules().inputs, &self.rules().outputs);
            let names: Vec<&str> = channels
                .iter()
                .map(|channel| channel.name.as_str())
                .collect();
            sides.push(format!("{side}s taken as {}", names.join(", ")));
        }
        format!(
            "channels without names in the file: {}, by their position in the dataset; check the \
            order, or name the channels under \"models\" in the rules (files: {})",
            sides.join(" and "),
            files.join(", ")
        )
    }
}
