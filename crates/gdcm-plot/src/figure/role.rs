//! Role of a curve, and its appearance on paper: the same in every figure.

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::BundleKind;
use gdcm_study::results::requirement_role::RequirementRole;

use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{DotShape, Mark};

/// Role of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Role {
    /// Physics model at the trim itself.
    Nominal,
    /// Physics model at a perturbed trim.
    Perturbed,
    /// Physics model that represents its bundle.
    Representative,
    /// Model identified from flight.
    Identified,
    /// Identified model that represents its bundle.
    IdentifiedRepresentative,
    /// Representative physics model with the condition's own correction.
    Corrected,
    /// Physics model with the scheduled correction.
    Scheduled,
    /// Representative physics model with the condition's own correction, without its lead filters.
    WithoutLeads,
    /// Representative physics model with couplings alone: no gain, delay or lead of a channel.
    Coupled,
    /// Physics model with the correction of a variant of the study, overlaid for comparison.
    Variant,
    /// Excluded model of any kind.
    Rejected,
    /// A model of one of several conditions, from 0 for the slowest to 255 for the fastest.
    OfAirspeed(u8),
}

impl Role {
    /// All roles of one condition, in the order of a legend.
    pub const ALL: [Self; 11] = [
        Self::Nominal,
        Self::Perturbed,
        Self::Representative,
        Self::Identified,
        Self::IdentifiedRepresentative,
        Self::Corrected,
        Self::Scheduled,
        Self::WithoutLeads,
        Self::Coupled,
        Self::Variant,
        Self::Rejected,
    ];

    /// Returns the role of a model of a condition at an airspeed \[kt\], between the slowest and
    /// the fastest condition.
    pub fn of_airspeed(airspeed_kt: f64, (least, most): (f64, f64)) -> Self {
        let part = if most > least {
            (airspeed_kt - least) / (most - least)
        } else {
            0.0
        };
        Self::OfAirspeed((255.0 * part.clamp(0.0, 1.0)).round() as u8)
    }

    /// Returns the role of an unchanged model.
    pub fn of_model(kind: BundleKind, is_nominal: bool, represents: bool) -> Self {
        match (kind, is_nominal, represents) {
            (BundleKind::Physics, true, _) => Self::Nominal,
            (BundleKind::Physics, false, true) => Self::Representative,
            (BundleKind::Physics, false, false) => Self::Perturbed,
            (BundleKind::Identified, _, true) => Self::IdentifiedRepresentative,
            (BundleKind::Identified, _, false) => Self::Identified,
        }
    }

    /// Returns the name in a legend.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Perturbed => "perturbed",
            Self::Representative => "representative",
            Self::Identified => "other identified",
            Self::IdentifiedRepresentative => "identified",
            Self::Corrected => "corrected",
            Self::Scheduled => "scheduled",
            Self::WithoutLeads => "without leads",
            Self::Coupled => "couplings alone",
            Self::Variant => "variant",
            Self::Rejected => "rejected",
            Self::OfAirspeed(_) => "condition",
        }
    }

    /// Returns the name as one word of a command.
    pub fn word(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::IdentifiedRepresentative => "identified-representative",
            Self::WithoutLeads => "without-leads",
            Self::Coupled => "couplings-alone",
            _ => self.name(),
        }
    }

    /// Returns the displayed role of a curve: `Rejected` for a rejected curve, except that the
    /// nominal model stays nominal.
    pub fn shown(self, rejected: bool) -> Self {
        if rejected && self != Self::Nominal {
            Self::Rejected
        } else {
            self
        }
    }

    /// Returns the line in the window. Dashes and widths distinguish the roles without colours. A
    /// rejected nominal model stays red, but dotted.
    pub fn line(self, rejected: bool) -> Stroke {
        let line = |hue, width_pt, dash| Stroke {
            color: Color::of(hue),
            width_pt,
            dash,
        };
        match self.shown(rejected) {
            Self::Nominal if rejected => line(Hue::Nominal, 1.3, Dash::Dotted),
            Self::Nominal => line(Hue::Nominal, 1.8, Dash::DashDot),
            Self::Perturbed => Stroke::solid(Color::of(Hue::Perturbed).tint(80), 0.8),
            Self::Representative => line(Hue::Perturbed, 1.4, Dash::Solid),
            Self::Identified => line(Hue::Identified, 1.2, Dash::Short),
            // Wide: visible below the corrected curve that should lie on it.
            Self::IdentifiedRepresentative => line(Hue::Identified, 4.0, Dash::Solid),
            Self::Corrected => line(Hue::Corrected, 2.0, Dash::Solid),
            Self::Scheduled => line(Hue::Corrected, 1.6, Dash::Long),
            Self::WithoutLeads => line(Hue::Corrected, 1.4, Dash::ShortDashDot),
            Self::Coupled => line(Hue::Perturbed, 2.0, Dash::ShortDashDot),
            Self::Variant => line(Hue::Corrected, 1.8, Dash::Dotted),
            Self::Rejected => line(Hue::Rejected, 1.0, Dash::Dotted),
            Self::OfAirspeed(step) => line(Hue::OfAirspeed(step), 1.8, Dash::Solid),
        }
    }

    /// Returns the line on paper: the window's line, thinned for print.
    pub fn stroke(self, rejected: bool) -> Stroke {
        self.line(rejected).printed()
    }

    /// Returns the entry in the legend of a figure.
    pub fn key(self, rejected: bool) -> &'static str {
        match self.shown(rejected) {
            Self::Nominal if rejected => "nominal (rejected)",
            shown => shown.name(),
        }
    }

    /// Returns the place in the drawing order: the most important roles are drawn last, on top.
    pub fn layer(self, rejected: bool) -> usize {
        match self.shown(rejected) {
            Self::Rejected => 0,
            Self::Perturbed | Self::OfAirspeed(_) => 1,
            Self::Identified => 2,
            Self::Nominal => 3,
            Self::Representative => 4,
            Self::IdentifiedRepresentative => 5,
            Self::WithoutLeads | Self::Coupled => 6,
            Self::Variant => 7,
            Self::Scheduled => 8,
            Self::Corrected => 9,
        }
    }
}

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub text: String,
    pub sample: Sample,
}

/// Sample before the text of an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    Line(Stroke),
    Dot {
        shape: DotShape,
        color: Color,
        filled: bool,
    },
    /// A patch of background.
    Ground(Color),
}

/// Returns one entry for each key among `marks`: roles in their order, then the others in order of
/// appearance.
pub(super) fn entries<'m>(marks: impl Iterator<Item = &'m Mark>) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for mark in marks {
        if let Some(entry) =
            entry(mark).filter(|entry| entries.iter().all(|known| known.text != entry.text))
        {
            entries.push(entry);
        }
    }
    // Stable: entries without a role keep their order.
    entries.sort_by_key(|entry| place(&entry.text));
    entries
}

fn entry(mark: &Mark) -> Option<Entry> {
    let (text, sample) = match mark {
        Mark::Curve(curve) => (curve.key.clone()?, Sample::Line(curve.stroke)),
        Mark::Dots(dots) => (
            dots.key.clone()?,
            Sample::Dot {
                shape: dots.shape,
                color: dots.color,
                filled: dots.filled,
            },
        ),
        Mark::Bars(bars) => (bars.name.clone(), Sample::Ground(bars.color)),
        Mark::Spans(spans) => (spans.name.clone(), Sample::Ground(spans.color)),
        Mark::Envelope(of) => (
            of.name.clone(),
            of.edge.map_or(Sample::Ground(of.color), Sample::Line),
        ),
        Mark::Intervals(of) => (of.name.clone(), Sample::Line(of.stroke)),
        Mark::Brackets(of) => (of.name.clone(), Sample::Line(of.stroke)),
        Mark::Band(band) => (band.key.clone(), Sample::Ground(band.color)),
        Mark::Rule(_) | Mark::Guide(_) | Mark::Note(_) => return None,
    };
    Some(Entry { text, sample })
}

fn place(text: &str) -> usize {
    // A single physics model takes the place of the nominal one.
    let text = if text == RequirementRole::Physics.name() {
        Role::Nominal.key(false)
    } else {
        text
    };
    // Rejected models share the entry of the rejected role, except the nominal one, which has its
    // own.
    let of_role =
        |role: &Role| role.key(false) == text || (*role == Role::Nominal && role.key(true) == text);
    Role::ALL
        .iter()
        .position(of_role)
        .unwrap_or(Role::ALL.len())
}

#[cfg(test)]
mod tests {
    use super::super::figure::Curve;
    use super::*;

    #[test]
    fn roles_differ_without_their_colours() {
        for a in Role::ALL {
            for b in Role::ALL.into_iter().filter(|b| *b != a) {
                let a = a.stroke(false);
                let b = b.stroke(false);
                assert!(
                    a.dash != b.dash || (a.width_pt - b.width_pt).abs() > 0.3,
                    "{a:?} {b:?}"
                );
            }
        }
    }

    #[test]
    fn a_rejected_nominal_model_stays_red_but_is_dotted() {
        let stroke = Role::Nominal.stroke(true);
        assert_eq!(
            (stroke.color, stroke.dash),
            (Color::of(Hue::Nominal), Dash::Dotted)
        );
        assert_eq!(Role::Nominal.key(true), "nominal (rejected)");
        assert_eq!(Role::Perturbed.key(true), "rejected");
    }

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
