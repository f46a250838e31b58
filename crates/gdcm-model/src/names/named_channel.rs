//! Known channels named in a text, found word by word.

use std::collections::BTreeSet;
use std::ops::Range;

use super::channel_alias::{canonical_name, is_known_input, is_known_output};
use super::channel_rule::ChannelRule;
use super::signed_name::SignedName;
use crate::dataset::channel::ChannelSide;

/// Maximum number of words in a channel name.
const LONGEST_NAME: usize = 4;
/// Maximum number of words that are read; further words are ignored.
const MOST_WORDS: usize = 64;

/// Channels that can be recognised in a text.
#[derive(Clone, Copy, Debug)]
pub enum KnownChannels<'r> {
    /// Dataset channels, by their names and aliases.
    Dataset {
        inputs: &'r [ChannelRule],
        outputs: &'r [ChannelRule],
    },
    /// All channels in the alias table, whether or not the dataset has them.
    AliasTable,
}

/// Canonical names of the [`KnownChannels`], one for all aliases of a channel (`channel_alias.rs`);
/// computed once for all words in a text.
enum KnownNames {
    Dataset {
        inputs: BTreeSet<String>,
        outputs: BTreeSet<String>,
    },
    AliasTable,
}

impl KnownNames {
    fn new(known: KnownChannels<'_>) -> Self {
        match known {
            KnownChannels::Dataset { inputs, outputs } => Self::Dataset {
                inputs: canonical_names(inputs),
                outputs: canonical_names(outputs),
            },
            KnownChannels::AliasTable => Self::AliasTable,
        }
    }

    /// Returns whether an input, an output or both are called `name`.
    fn sides(&self, name: &str) -> Sides {
        match self {
            Self::Dataset { inputs, outputs } => {
                let name = canonical_name(name);
                Sides {
                    output: outputs.contains(&name),
                    input: inputs.contains(&name),
                }
            }
            Self::AliasTable => Sides {
                output: is_known_output(name),
                input: is_known_input(name),
            },
        }
    }
}

/// Returns the canonical forms of channel names and their aliases, without sign marks.
fn canonical_names(rules: &[ChannelRule]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for rule in rules {
        for name in std::iter::once(&rule.name).chain(&rule.aliases) {
            names.insert(canonical_name(&SignedName::parse(name).name));
        }
    }
    names
}

/// Whether an output, and whether an input, has a given name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sides {
    output: bool,
    input: bool,
}

impl Sides {
    /// Returns whether both an input and an output have the name.
    pub(super) fn are_both(self) -> bool {
        self.output && self.input
    }

    pub(super) fn has(self, side: ChannelSide) -> bool {
        side.pick(self.input, self.output)
    }
}

/// A channel named by consecutive words in a text.
pub(super) struct NamedChannel<'t> {
    /// Word indices.
    pub(super) words: Range<usize>,
    /// The words as spelt in the text.
    pub(super) text: &'t str,
    pub(super) sides: Sides,
}

/// A word and its first byte's index in the text.
pub(super) struct Word<'t> {
    start: usize,
    pub(super) text: &'t str,
}

/// Splits a text into words, which consist of letters and digits; at most [`MOST_WORDS`] are
/// returned.
pub(super) fn split_words(text: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    let mut start = None;
    for (place, letter) in text.char_indices().chain([(text.len(), ' ')]) {
        let is_inside = place < text.len() && letter.is_alphanumeric();
        match (start, is_inside) {
            (None, true) => start = Some(place),
            (Some(from), false) => {
                words.push(Word {
                    start: from,
                    text: &text[from..place],
                });
                start = None;
            }
            _ => {}
        }
    }
    words.truncate(MOST_WORDS);
    words
}

/// Finds the known channels in a text from left to right; if several begin at the same word, the
/// longest.
pub(super) fn named_channels<'t>(
    text: &'t str,
    words: &[Word<'t>],
    known: KnownChannels<'_>,
) -> Vec<NamedChannel<'t>> {
    let known = KnownNames::new(known);
    let mut named = Vec::new();
    let mut first = 0;
    while first < words.len() {
        match longest_channel(text, words, first, &known) {
            Some(channel) => {
                first = channel.words.end;
                named.push(channel);
            }
            None => first += 1,
        }
    }
    named
}

/// Returns the longest known channel name that begins at word `first`.
fn longest_channel<'t>(
    text: &'t str,
    words: &[Word<'t>],
    first: usize,
    known: &KnownNames,
) -> Option<NamedChannel<'t>> {
    let longest = (words.len() - first).min(LONGEST_NAME);
    for count in (1..=longest).rev() {
        let last = &words[first + count - 1];
        let name = &text[words[first].start..last.start + last.text.len()];
        let sides = known.sides(name);
        if sides.output || sides.input {
            return Some(NamedChannel {
                words: first..first + count,
                text: name,
                sides,
            });
        }
    }
    None
}
