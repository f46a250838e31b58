//! The legend of a figure: one entry for each key among its marks.

use super::mark::{DotShape, Mark};
use super::role::Role;
use super::stroke::{Color, Stroke};

/// One entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its words.
    pub text: String,
    /// What stands before them.
    pub sample: Sample,
}

/// What stands before the words of an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    /// A piece of line.
    Line(Stroke),
    /// A dot.
    Dot {
        /// Its outline.
        shape: DotShape,
        /// Its colour.
        color: Color,
        /// Filled or open.
        filled: bool,
    },
    /// A piece of ground.
    Ground(Color),
}

/// One entry for each key among `marks`: roles in their order, then the others in the order in which they come.
pub(super) fn entries<'m>(marks: impl Iterator<Item = &'m Mark>) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for mark in marks {
        if let Some(entry) = entry(mark).filter(|entry| entries.iter().all(|known| known.text != entry.text)) {
            entries.push(entry);
        }
    }
    // Stable: what is no role keeps its order.
    entries.sort_by_key(|entry| place(&entry.text));
    entries
}

fn entry(mark: &Mark) -> Option<Entry> {
    let (text, sample) = match mark {
        Mark::Curve(curve) => (curve.key.clone()?, Sample::Line(curve.stroke)),
        Mark::Dots(dots) => {
            (dots.key.clone()?, Sample::Dot { shape: dots.shape, color: dots.color, filled: dots.filled })
        }
        Mark::Bars(bars) => (bars.name.clone(), Sample::Ground(bars.color)),
        Mark::Spans(spans) => (spans.name.clone(), Sample::Ground(spans.color)),
        Mark::Intervals(of) => (of.name.clone(), Sample::Line(of.stroke)),
        Mark::Brackets(of) => (of.name.clone(), Sample::Line(of.stroke)),
        Mark::Band(band) => (band.key.clone()?, Sample::Ground(band.color)),
        Mark::Rule(_) | Mark::Guide(_) | Mark::Note(_) => return None,
    };
    Some(Entry { text, sample })
}

fn place(text: &str) -> usize {
    // A rejected model has the entry of its own role: all but the nominal one have that of the rejected.
    let of_role = |role: &Role| role.key(false) == text || (*role == Role::Nominal && role.key(true) == text);
    Role::ALL.iter().position(of_role).unwrap_or(Role::ALL.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::mark::Curve;

    fn curve(role: Role, rejected: bool) -> Mark {
        Curve::new("", role.stroke(rejected), [0.0], [0.0]).key(role.key(rejected)).into()
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
        let texts: Vec<String> = entries(marks.iter()).into_iter().map(|entry| entry.text).collect();
        assert_eq!(texts, ["nominal (rejected)", "perturbed", "corrected", "rejected"]);
    }
}
