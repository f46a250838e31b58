//! Keys in a JSON text that the program does not know, for cautions. A *step* is a key or a list
//! index on the path from the top level to a value.

use std::collections::BTreeMap;

use crate::file_caution::FileCaution;
use crate::json_location::location_of;
use crate::json_outline::Outline;
use crate::json_path::Step;

/// Maximum number of keys reported individually: a file with more was written by another program,
/// or was made to fill the memory.
const MOST_KEYS: usize = 50;

/// Keys unknown to the program; keys whose paths differ only in indices are counted together.
#[derive(Debug, Default)]
pub(super) struct UnknownKeys {
    /// First occurrence and count for each key path without indices.
    found: BTreeMap<Vec<String>, UnknownKey>,
    /// Number of further keys beyond [`MOST_KEYS`], which are only counted.
    beyond: usize,
}

/// A key that the program does not know, or an entry that it does not use.
#[derive(Debug)]
struct UnknownKey {
    /// Path to the first such key.
    steps: Vec<Step>,
    count: usize,
}

impl UnknownKeys {
    /// Adds the path to a key or an entry that serde has skipped.
    pub(super) fn add(&mut self, path: &serde_ignored::Path<'_>) {
        let mut steps = Vec::new();
        collect_steps(path, &mut steps);
        let mut keys = Vec::new();
        for step in &steps {
            if let Step::Key(key) = step {
                keys.push(key.clone());
            }
        }
        if let Some(known) = self.found.get_mut(&keys) {
            known.count += 1;
        } else if self.found.len() == MOST_KEYS {
            self.beyond += 1;
        } else {
            self.found.insert(keys, UnknownKey { steps, count: 1 });
        }
    }

    /// Returns a caution for each unknown key, with its place in the text, and one with the number
    /// of further keys.
    pub(super) fn cautions(&self, text: &[u8]) -> Vec<FileCaution> {
        if self.found.is_empty() {
            return Vec::new();
        }
        let outline = Outline::read(text);
        let mut cautions: Vec<FileCaution> = self
            .found
            .values()
            .map(|unknown| unknown.caution(&outline))
            .collect();
        if self.beyond > 0 {
            cautions.push(FileCaution::MoreUnknownKeys { count: self.beyond });
        }
        cautions
    }
}

impl UnknownKey {
    fn caution(&self, outline: &Outline) -> FileCaution {
        match self.steps.split_last() {
            Some((Step::Key(key), parent)) => FileCaution::UnknownKey {
                place: location_of(parent, outline).before(),
                key: key.clone(),
                count: self.count,
            },
            _ => FileCaution::UnknownEntry {
                place: location_of(&self.steps, outline).before(),
                count: self.count,
            },
        }
    }
}

/// Appends the steps of a path, from the top level down.
fn collect_steps(path: &serde_ignored::Path<'_>, steps: &mut Vec<Step>) {
    use serde_ignored::Path as Ignored;
    let (parent, step) = match path {
        Ignored::Root => return,
        Ignored::Seq { parent, index } => (parent, Some(Step::Entry(*index))),
        Ignored::Map { parent, key } => (parent, Some(Step::Key(key.clone()))),
        Ignored::Some { parent }
        | Ignored::NewtypeStruct { parent }
        | Ignored::NewtypeVariant { parent } => (parent, None),
    };
    collect_steps(parent, steps);
    steps.extend(step);
}
