//! Bode axes: names and units, and the limits typed by the engineer.
//!
//! A place on an axis is the coordinate in which curves are drawn: `log10 omega`, or the value, in
//! decibels even if ratios are displayed. Typed limits are in the displayed unit.

use gdcm_model::number_format::compact;
use gdcm_plot::figure::Range;

use super::bode_scene::BodeScene;
use super::drawn_curves::Pane;
use super::ticks::Ticks;
use crate::message::Message;

/// Message about typed limits that do not increase.
pub(super) const NOT_INCREASING: &str = "the lower limit must be below the upper limit";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BodeAxis {
    /// Frequency axis, shared by both panes.
    Frequency,
    /// A pane's vertical axis.
    Values(Pane),
}

impl BodeAxis {
    /// Returns the accessible name, such as "Frequency axis, magnitude plot"; `pane` is the one
    /// beside which the axis is drawn.
    pub(super) fn name(self, scene: &BodeScene<'_>, pane: Pane) -> String {
        let kind = match self {
            Self::Frequency => "Frequency",
            Self::Values(_) => "Value",
        };
        format!("{kind} axis, {}", scene.quantity.name_in_sentence(pane))
    }

    /// Returns the unit in brackets after a space, to be appended to a name; empty without a unit.
    pub(super) fn unit(self, scene: &BodeScene<'_>) -> String {
        let symbol = match self {
            Self::Frequency => scene.unit.symbol(),
            Self::Values(pane) => scene.quantity.unit(pane).suffix().trim(),
        };
        if symbol.is_empty() {
            String::new()
        } else {
            format!(" [{symbol}]")
        }
    }

    fn ticks(self, scene: &BodeScene<'_>) -> Ticks {
        match self {
            Self::Frequency => Ticks::Frequency(scene.unit),
            Self::Values(pane) => scene.quantity.unit(pane).ticks(),
        }
    }

    /// Formats both limits as editable text.
    pub(super) fn texts(self, scene: &BodeScene<'_>, range: Range) -> [String; 2] {
        [range.min, range.max].map(|place| compact(self.ticks(scene).number(place)))
    }

    /// Parses the range between two typed limits, or returns the reason why it cannot be shown.
    pub(super) fn range(
        self,
        scene: &BodeScene<'_>,
        texts: &[String; 2],
    ) -> Result<Range, Message> {
        let min = self.place(scene, &texts[0])?;
        let max = self.place(scene, &texts[1])?;
        if min < max {
            Ok(Range { min, max })
        } else {
            Err(Message::new("limits-not-increasing", NOT_INCREASING))
        }
    }

    /// Returns the message about typed limits that are not within the values `ends` of the axis.
    pub(super) fn beyond_ends(self, scene: &BodeScene<'_>, ends: Range) -> Message {
        let [least, most] = self.texts(scene, ends);
        let unit = self.unit(scene);
        let words = format!("the axis{unit} shows nothing outside {least} to {most}");
        Message::new("limits-beyond-axis", words)
    }

    /// Converts a typed number, with an ASCII or a typographic minus sign, to an axis coordinate.
    fn place(self, scene: &BodeScene<'_>, text: &str) -> Result<f64, Message> {
        let text = text.trim();
        let kind = match self {
            Self::Frequency => "frequency",
            Self::Values(_) => "value",
        };
        let refusal = || {
            Message::new(
                "not-on-axis",
                format!("expected a {kind} on this axis, found \"{text}\""),
            )
        };
        let number: f64 = text
            .replace('\u{2212}', "-")
            .parse()
            .map_err(|_| refusal())?;
        let place = self.ticks(scene).place(number);
        if place.is_finite() {
            Ok(place)
        } else {
            Err(refusal())
        }
    }
}

#[cfg(test)]
mod tests {
    use gdcm_plot::figure::axis::FrequencyUnit;

    use super::*;

    fn texts(min: &str, max: &str) -> [String; 2] {
        [min.to_owned(), max.to_owned()]
    }

    #[test]
    fn typed_frequencies_are_places_on_the_logarithmic_axis() {
        let scene = BodeScene::new("", &[], (0.5, 12.0));
        let range = BodeAxis::Frequency
            .range(&scene, &texts("0.1", " 100 "))
            .unwrap();
        assert_eq!(
            range,
            Range {
                min: -1.0,
                max: 2.0
            }
        );
        assert_eq!(
            BodeAxis::Frequency.texts(&scene, range),
            texts("0.1", "100")
        );
        let hertz = BodeScene {
            unit: FrequencyUnit::Hertz,
            ..scene
        };
        let range = BodeAxis::Frequency.range(&hertz, &texts("1", "2")).unwrap();
        assert!((10f64.powf(range.min) - std::f64::consts::TAU).abs() < 1e-12);
    }

    #[test]
    fn invalid_limits_are_refused_with_a_message() {
        let scene = BodeScene::new("", &[], (0.5, 12.0));
        let frequencies = |min, max| {
            BodeAxis::Frequency
                .range(&scene, &texts(min, max))
                .unwrap_err()
        };
        assert_eq!(frequencies("3", "2").code, "limits-not-increasing");
        assert_eq!(frequencies("2", "2").code, "limits-not-increasing");
        for (refusal, text) in [
            (frequencies("0", "2"), "\"0\""),
            (frequencies("1", "two"), "\"two\""),
        ] {
            assert_eq!(refusal.code, "not-on-axis");
            assert!(refusal.text.contains(text), "{refusal:?}");
        }
        let values = BodeAxis::Values(Pane::Magnitude);
        assert_eq!(
            values.range(&scene, &texts("\u{2212}20", "5")),
            Ok(Range {
                min: -20.0,
                max: 5.0
            })
        );
        assert!(values.range(&scene, &texts("NaN", "5")).is_err());
    }
}
