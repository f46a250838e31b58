//! The bars of an assessment: changes of J, side by side.

use gdcm_core::dataset::ConditionId;

use super::questions::NamedFigure;
use super::range::Range;

/// What a bar says.
#[derive(Clone, Debug, PartialEq)]
pub enum BarValue {
    /// The change of J: negative is better.
    Change {
        /// Of its magnitude part.
        magnitude: f64,
        /// Of its phase part.
        phase: f64,
    },
    /// Not assessed.
    LeftOut {
        /// Why not: "its nominal model is rejected".
        why: String,
    },
}

/// One bar.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessmentBar {
    /// Its condition.
    pub condition: ConditionId,
    /// The text below it: the condition's number.
    pub label: String,
    /// Its value.
    pub value: BarValue,
    /// Whether it is the condition in focus.
    pub selected: bool,
    /// A further line for hovering, such as J before and after. May be empty.
    pub detail: String,
    /// The figures that can be asked about here.
    pub figures: Vec<NamedFigure>,
}

/// Bars side by side: one pair in every condition.
#[derive(Clone, Debug, PartialEq)]
pub struct AssessmentPanel {
    /// The pair.
    pub title: String,
    /// What the labels of the bars are: "Condition", "Pair".
    pub axis_label: String,
    /// The bars, from left to right.
    pub bars: Vec<AssessmentBar>,
}

impl AssessmentPanel {
    /// The values in view: all parts of all bars, and zero.
    pub(super) fn values(&self) -> Range {
        let parts = self.bars.iter().flat_map(|bar| match bar.value {
            BarValue::Change { magnitude, phase } => {
                let [from_magnitude, from_phase] = stacked(magnitude, phase);
                vec![from_magnitude[1], from_phase[1]]
            }
            BarValue::LeftOut { .. } => Vec::new(),
        });
        Range::of(parts.chain([0.0])).unwrap_or(Range::new(-1.0, 1.0)).with_margin(0.12, 1.0)
    }
}

/// Both parts as `[from, to]`: of one sign they stand on one another, of two signs on either side of zero.
pub(super) fn stacked(magnitude: f64, phase: f64) -> [[f64; 2]; 2] {
    let foot = if magnitude * phase > 0.0 { magnitude } else { 0.0 };
    [[0.0, magnitude], [foot, foot + phase]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_one_sign_stand_on_one_another() {
        assert_eq!(stacked(-30.0, -10.0), [[0.0, -30.0], [-30.0, -40.0]]);
        assert_eq!(stacked(-30.0, 10.0), [[0.0, -30.0], [0.0, 10.0]]);
    }

    #[test]
    fn zero_is_in_view_even_where_everything_got_better() {
        let bar = |id, magnitude| AssessmentBar {
            condition: ConditionId(id),
            label: id.to_string(),
            value: BarValue::Change { magnitude, phase: 0.0 },
            selected: false,
            detail: String::new(),
            figures: Vec::new(),
        };
        let panel =
            AssessmentPanel { title: "a".into(), axis_label: "b".into(), bars: vec![bar(1, -40.0), bar(2, -90.0)] };
        assert!(panel.values().contains(0.0) && panel.values().contains(-90.0));
    }
}
