//! Legend: an entry for each distinct key among a figure's marks.
//!
//! A *mark* is an element of a panel: a curve, dots, bars, a shaded range, a line or a note
//! (`marks.rs`); its *key* is its text in the legend.

use gdcm_study::results::requirement_role::RequirementRole;

use super::drawing::{Color, Stroke};
use super::marks::{DotShape, Mark};
use super::role::Role;

/// A legend entry: a sample and a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub text: String,
    pub sample: Sample,
}

/// Sample in the style of the mark that it explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    Line(Stroke),
    Dot {
        shape: DotShape,
        color: Color,
        filled: bool,
    },
    /// A shaded patch.
    Ground(Color),
}

/// Returns an entry for each distinct key among `marks`: roles as ordered in [`Role::ALL`], then
/// the other keys as they appear.
pub(super) fn entries<'m>(marks: impl Iterator<Item = &'m Mark>) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for entry in marks.filter_map(entry) {
        if entries.iter().all(|known| known.text != entry.text) {
            entries.push(entry);
        }
    }
    // The sort is stable: entries without a role keep their order.
    entries.sort_by_key(|entry| rank(&entry.text));
    entries
}

/// Returns a mark's entry; `None` for a mark without a key.
fn entry(mark: &Mark) -> Option<Entry> {
    match mark {
        Mark::Curve(curve) => Some(Entry {
            text: curve.key.clone()?,
            sample: Sample::Line(curve.stroke),
        }),
        Mark::Dots(dots) => Some(Entry {
            text: dots.key.clone()?,
            sample: Sample::Dot {
                shape: dots.shape,
                color: dots.color,
                filled: dots.filled,
            },
        }),
        Mark::Bars(bars) => Some(Entry {
            text: bars.name.clone(),
            sample: Sample::Ground(bars.color),
        }),
        Mark::Spans(spans) => Some(Entry {
            text: spans.name.clone(),
            sample: Sample::Ground(spans.color),
        }),
        Mark::Envelope(envelope) => Some(Entry {
            text: envelope.name.clone(),
            sample: match envelope.edge {
                Some(stroke) => Sample::Line(stroke),
                None => Sample::Ground(envelope.color),
            },
        }),
        Mark::Intervals(intervals) => Some(Entry {
            text: intervals.name.clone(),
            sample: Sample::Line(intervals.stroke),
        }),
        Mark::Brackets(brackets) => Some(Entry {
            text: brackets.name.clone(),
            sample: Sample::Line(brackets.stroke),
        }),
        Mark::Strip(strip) => Some(Entry {
            text: strip.key.clone(),
            sample: Sample::Ground(strip.color),
        }),
        Mark::Rule(_) | Mark::Guide(_) | Mark::Note(_) => None,
    }
}

/// Returns an entry's rank in the legend; texts that do not name a role come after all roles.
fn rank(text: &str) -> usize {
    // The single physics model in a requirement figure has the nominal model's rank.
    let text = if text == RequirementRole::Physics.name() {
        Role::Nominal.key(false)
    } else {
        text
    };
    Role::ALL
        .iter()
        .position(|role| names_role(text, *role))
        .unwrap_or(Role::ALL.len())
}

/// Returns whether a text names a role. A rejected nominal model has a separate entry, ranked as
/// the nominal role; all other rejected models share the entry of the rejected role.
fn names_role(text: &str, role: Role) -> bool {
    text == role.key(false) || (role == Role::Nominal && text == role.key(true))
}

#[cfg(test)]
mod tests {
    use super::super::marks::Curve;
    use super::*;

    fn curve(role: Role, rejected: bool) -> Mark {
        Curve::new("", role.stroke(rejected), [0.0], [0.0])
            .key(role.key(rejected))
            .into()
    }

    #[test]
    fn a_legend_has_one_entry_for_each_role_present_in_their_order() {
        let marks = [
            curve(Role::Corrected, false),
            curve(Role::Perturbed, false),
            curve(Role::Perturbed, true),
            curve(Role::Perturbed, false),
            curve(Role::Nominal, true),
        ];
        let texts: Vec<String> = entries(marks.iter())
            .into_iter()
            .map(|entry| entry.text)
            .collect();
        assert_eq!(
            texts,
            ["nominal (rejected)", "perturbed", "corrected", "rejected"]
        );
    }
}
