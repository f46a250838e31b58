//! The axes of a Bode plot, and numbers on them as they are typed.

use super::bode::BodeScene;
use super::curve::Pane;
use super::number::compact;
use super::range::Range;

/// One axis of a Bode plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlotAxis {
    /// That of the frequencies, which both panes share.
    Frequency,
    /// The vertical one of a pane.
    Values(Pane),
}

/// Why typed limits are not shown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum LimitRefusal {
    /// The text is no number of this axis.
    #[error("\"{text}\" is no {what}")]
    NoNumber {
        /// What was typed.
        text: String,
        /// What was expected.
        what: &'static str,
    },
    /// The lower limit is not below the upper one.
    #[error("the lower limit has to be below the upper one")]
    NotAscending,
}

impl PlotAxis {
    /// "Frequency axis, magnitude plot".
    pub(super) fn name(self, scene: &BodeScene<'_>, pane: Pane) -> String {
        let kind = match self {
            Self::Frequency => "Frequency",
            Self::Values(_) => "Value",
        };
        format!("{kind} axis, {}", scene.quantity.place(pane))
    }

    /// The unit in brackets, empty where there is none.
    pub(super) fn unit(self, scene: &BodeScene<'_>) -> String {
        let symbol = match self {
            Self::Frequency => scene.unit.symbol(),
            Self::Values(pane) => scene.quantity.unit(pane).suffix().trim(),
        };
        if symbol.is_empty() { String::new() } else { format!(" [{symbol}]") }
    }

    /// A place on the axis as its number.
    fn number(self, scene: &BodeScene<'_>, place: f64) -> f64 {
        match self {
            Self::Frequency => scene.unit.of_omega(10f64.powf(place)),
            Self::Values(pane) => scene.quantity.unit(pane).of_drawn(place),
        }
    }

    /// The ends of a range as they are typed.
    pub(super) fn texts(self, scene: &BodeScene<'_>, range: Range) -> [String; 2] {
        [range.min, range.max].map(|place| compact(self.number(scene, place)))
    }

    /// The range between two numbers as they are typed, or why it cannot be shown.
    pub(super) fn range(self, scene: &BodeScene<'_>, texts: &[String; 2]) -> Result<Range, LimitRefusal> {
        let [min, max] = [self.place(scene, &texts[0])?, self.place(scene, &texts[1])?];
        if min < max { Ok(Range { min, max }) } else { Err(LimitRefusal::NotAscending) }
    }

    /// The place on the axis of a number as it is typed, with either minus sign.
    fn place(self, scene: &BodeScene<'_>, text: &str) -> Result<f64, LimitRefusal> {
        let number = text.trim().replace('\u{2212}', "-").parse::<f64>().ok();
        let (place, what) = match self {
            Self::Frequency => {
                let omega = number.map(|number| number / scene.unit.of_omega(1.0));
                (omega.filter(|omega| *omega > 0.0).map(f64::log10), "frequency")
            }
            Self::Values(pane) => (number.and_then(|number| scene.quantity.unit(pane).to_drawn(number)), "value"),
        };
        let finite = place.filter(|place| place.is_finite());
        finite.ok_or_else(|| LimitRefusal::NoNumber { text: text.trim().to_owned(), what })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::plot::log_axis::FrequencyUnit;

    fn texts(min: &str, max: &str) -> [String; 2] {
        [min.to_owned(), max.to_owned()]
    }

    #[test]
    fn typed_frequencies_are_places_on_the_logarithmic_axis() {
        let scene = BodeScene::of("", &[], (0.5, 12.0));
        let range = PlotAxis::Frequency.range(&scene, &texts("0.1", " 100 ")).unwrap();
        assert_eq!(range, Range { min: -1.0, max: 2.0 });
        assert_eq!(PlotAxis::Frequency.texts(&scene, range), texts("0.1", "100"));
        let hertz = BodeScene { unit: FrequencyUnit::Hertz, ..scene };
        let range = PlotAxis::Frequency.range(&hertz, &texts("1", "2")).unwrap();
        assert!((10f64.powf(range.min) - std::f64::consts::TAU).abs() < 1e-12);
    }

    #[test]
    fn limits_that_are_none_are_refused_with_a_word() {
        let scene = BodeScene::of("", &[], (0.5, 12.0));
        let frequencies = |min, max| PlotAxis::Frequency.range(&scene, &texts(min, max)).unwrap_err().to_string();
        assert_eq!(frequencies("3", "2"), "the lower limit has to be below the upper one");
        assert_eq!(frequencies("2", "2"), "the lower limit has to be below the upper one");
        assert_eq!(frequencies("0", "2"), "\"0\" is no frequency");
        assert_eq!(frequencies("1", "two"), "\"two\" is no frequency");
        let values = PlotAxis::Values(Pane::Magnitude);
        assert_eq!(values.range(&scene, &texts("\u{2212}20", "5")), Ok(Range { min: -20.0, max: 5.0 }));
        assert!(values.range(&scene, &texts("NaN", "5")).is_err());
    }
}
