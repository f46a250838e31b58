//! Roles of curves, and their appearance in every figure.
//!
//! A *bundle* contains a condition's physics models, or its identified models; its *representative*
//! is the model closest to the others, or the engineer's choice (M5).

use serde::{Deserialize, Serialize};

use gdcm_model::dataset::BundleKind;

use super::drawing::{Color, Dash, Hue, Stroke};

/// Meaning of a curve in a figure; it determines the style.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Role {
    /// Physics model at the unperturbed trim.
    Nominal,
    /// Physics model at a perturbed trim that does not represent its bundle.
    Perturbed,
    /// Physics model other than the nominal one that represents its bundle.
    Representative,
    /// Identified model that does not represent its bundle.
    Identified,
    /// Identified model that represents its bundle.
    IdentifiedRepresentative,
    /// Representative physics model with the condition's own correction.
    Corrected,
    /// Representative physics model with the scheduled correction.
    Scheduled,
    /// Representative physics model with the condition's own correction, without its lead filters.
    WithoutLeads,
    /// Representative physics model with couplings alone: no gain, delay or lead in a channel.
    Coupled,
    /// Representative physics model in a study variant with that variant's correction, overlaid for
    /// comparison.
    Variant,
    /// Rejected model, other than the nominal model.
    Rejected,
    /// Model in one of several conditions: its airspeed, from 0 at the lowest to 255 at the
    /// highest, and its line.
    OfAirspeed(u8, AirspeedLine),
}

/// Model that is drawn in its airspeed's colour; it determines width and pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum AirspeedLine {
    Identified,
    Scheduled,
    Corrected,
    Representative,
    Nominal,
}

impl AirspeedLine {
    /// Returns the line style in this colour.
    fn stroke(self, color: Color) -> Stroke {
        match self {
            Self::Identified => Stroke::solid(color, 1.5),
            Self::Scheduled => Stroke::dashed(color, 1.6, Dash::Long),
            Self::Corrected => Stroke::solid(color, 0.8),
            Self::Representative => Stroke::dashed(color, 1.2, Dash::Dotted),
            Self::Nominal => Stroke::dashed(color, 1.0, Dash::ShortDashDot),
        }
    }
}

impl Role {
    /// Roles that occur in a single condition, in legend order.
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

    /// Returns where an airspeed \[kt\] lies in the range, from 0 at the lowest airspeed to 255 at
    /// the highest.
    pub fn airspeed_step(airspeed_kt: f64, range_kt: (f64, f64)) -> u8 {
        let (slowest_kt, fastest_kt) = range_kt;
        let part = if fastest_kt > slowest_kt {
            (airspeed_kt - slowest_kt) / (fastest_kt - slowest_kt)
        } else {
            0.0
        };
        (255.0 * part.clamp(0.0, 1.0)).round() as u8
    }

    /// Returns an uncorrected model's role; `represents` states whether it represents its bundle.
    /// Whether the model is rejected is for [`Self::shown`].
    pub fn of_model(kind: BundleKind, is_nominal: bool, represents: bool) -> Self {
        match (kind, is_nominal, represents) {
            (BundleKind::Physics, true, _) => Self::Nominal,
            (BundleKind::Physics, false, true) => Self::Representative,
            (BundleKind::Physics, false, false) => Self::Perturbed,
            (BundleKind::Identified, _, true) => Self::IdentifiedRepresentative,
            (BundleKind::Identified, _, false) => Self::Identified,
        }
    }

    /// Returns the name displayed in the window's legend.
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
            Self::OfAirspeed(..) => "condition",
        }
    }

    /// Returns the name as a single word, for commands. "identified" means [`Self::Identified`],
    /// whereas in the legend it names [`Self::IdentifiedRepresentative`].
    pub fn word(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::IdentifiedRepresentative => "identified-representative",
            Self::WithoutLeads => "without-leads",
            Self::Coupled => "couplings-alone",
            _ => self.name(),
        }
    }

    /// Returns the displayed role: `Rejected` for a rejected curve, except that the nominal model
    /// stays nominal.
    pub fn shown(self, rejected: bool) -> Self {
        if rejected && self != Self::Nominal {
            Self::Rejected
        } else {
            self
        }
    }

    /// Returns the line style in the window. Dashes and widths distinguish the roles without
    /// colour. A rejected nominal model stays red, but dotted.
    pub fn line(self, rejected: bool) -> Stroke {
        let nominal = Color::new(Hue::Nominal);
        let perturbed = Color::new(Hue::Perturbed);
        let identified = Color::new(Hue::Identified);
        let corrected = Color::new(Hue::Corrected);
        match self.shown(rejected) {
            Self::Nominal if rejected => Stroke::dashed(nominal, 1.3, Dash::Dotted),
            Self::Nominal => Stroke::dashed(nominal, 1.8, Dash::DashDot),
            Self::Perturbed => Stroke::solid(perturbed.tint(80), 0.8),
            Self::Representative => Stroke::solid(perturbed, 1.4),
            Self::Identified => Stroke::dashed(identified, 1.2, Dash::Short),
            // Wide, so that it is visible below the corrected curve, which should coincide with it.
            Self::IdentifiedRepresentative => Stroke::solid(identified, 4.0),
            Self::Corrected => Stroke::solid(corrected, 2.0),
            Self::Scheduled => Stroke::dashed(corrected, 1.6, Dash::Long),
            Self::WithoutLeads => Stroke::dashed(corrected, 1.4, Dash::ShortDashDot),
            Self::Coupled => Stroke::dashed(perturbed, 2.0, Dash::ShortDashDot),
            Self::Variant => Stroke::dashed(corrected, 1.8, Dash::Dotted),
            Self::Rejected => Stroke::dashed(Color::new(Hue::Rejected), 1.0, Dash::Dotted),
            Self::OfAirspeed(step, line) => line.stroke(Color::new(Hue::OfAirspeed(step))),
        }
    }

    /// Returns the line style on paper: as in the window, but thinner.
    pub fn stroke(self, rejected: bool) -> Stroke {
        self.line(rejected).printed()
    }

    /// Returns the text in a figure's legend.
    pub fn key(self, rejected: bool) -> &'static str {
        match self.shown(rejected) {
            Self::Nominal if rejected => "nominal (rejected)",
            shown => shown.name(),
        }
    }

    /// Returns the rank in the drawing order: the most important roles have the highest rank and
    /// are drawn on top.
    pub fn layer(self, rejected: bool) -> usize {
        match self.shown(rejected) {
            Self::Rejected => 0,
            Self::Perturbed | Self::OfAirspeed(..) => 1,
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

#[cfg(test)]
mod tests {
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
            (Color::new(Hue::Nominal), Dash::Dotted)
        );
        assert_eq!(Role::Nominal.key(true), "nominal (rejected)");
        assert_eq!(Role::Perturbed.key(true), "rejected");
    }
}
