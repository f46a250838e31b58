//! Keys of a file that the program does not know.

use std::collections::BTreeMap;

use super::outline::Outline;
use super::place::{Step, location_of};
use gdcm_core::message_text::quoted;

/// Most keys told one by one; a file with more is not one of ours, or made to fill the memory.
const MOST_KEYS: usize = 50;

/// Keys that the program does not know, the same key in the same kind of place counted once.
#[derive(Debug, Default)]
pub(super) struct UnknownKeys {
    /// By the steps without their indices: the first such place, and how many there are.
    found: BTreeMap<Vec<String>, (Vec<Step>, usize)>,
    /// How many are not kept, because there are too many others.
    beyond: usize,
}

impl UnknownKeys {
    /// Notes one key, or one entry, that was passed over.
    pub(super) fn add(&mut self, path: &serde_ignored::Path<'_>) {
        let mut steps = Vec::new();
        collect_steps(path, &mut steps);
        let keys = steps.iter().filter_map(|step| match step {
            Step::Key(key) => Some(key.clone()),
            Step::Entry(_) => None,
        });
        let keys: Vec<String> = keys.collect();
        let is_full = self.found.len() == MOST_KEYS;
        match self.found.get_mut(&keys) {
            Some((_, count)) => *count += 1,
            None if is_full => self.beyond += 1,
            None => drop(self.found.insert(keys, (steps, 1))),
        }
    }

    /// A caution for each, with its place in the text.
    pub(super) fn cautions(&self, text: &[u8]) -> Vec<String> {
        if self.found.is_empty() {
            return Vec::new();
        }
        let outline = Outline::of(text);
        let caution = |(steps, count): &(Vec<Step>, usize)| {
            let more = if *count > 1 { format!(", and {} more like it", count - 1) } else { String::new() };
            match steps.split_last() {
                Some((Step::Key(key), place)) => {
                    let place = location_of(place, &outline).before();
                    format!("{place}the key {} is not known and not used{more}", quoted(key))
                }
                _ => format!("{}this entry is not known and not used{more}", location_of(steps, &outline).before()),
            }
        };
        let beyond = (self.beyond > 0).then(|| format!("{} other keys are not known and not used", self.beyond));
        self.found.values().map(caution).chain(beyond).collect()
    }
}

fn collect_steps(path: &serde_ignored::Path<'_>, steps: &mut Vec<Step>) {
    use serde_ignored::Path as Ignored;
    let (parent, step) = match path {
        Ignored::Root => return,
        Ignored::Seq { parent, index } => (parent, Some(Step::Entry(*index))),
        Ignored::Map { parent, key } => (parent, Some(Step::Key(key.clone()))),
        Ignored::Some { parent } | Ignored::NewtypeStruct { parent } | Ignored::NewtypeVariant { parent } => {
            (parent, None)
        }
    };
    collect_steps(parent, steps);
    steps.extend(step);
}
