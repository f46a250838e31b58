//! Stacked bars for the change in J in each condition; `assessment_bar_words` describes them.
//!
//! J is the cost of the difference between a model's response and the identified one (M4:
//! docs/method.md). It is the sum of a magnitude part and a phase part, and so is its change by the
//! correction; each part has a bar.

use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::number_format::decimals;
use gdcm_plot::figure::axis::Axis;
use gdcm_plot::figure::drawing::{Hue, Stroke};
use gdcm_plot::figure::figure::{Bars, Curve, Note, Place, Rule, Spans};
use gdcm_plot::figure::{Color, Panel, Range};
use gdcm_study::AssessmentTable;

use crate::gui::state::window_state::State;

/// Bar width, relative to the distance between conditions.
const BAR: f64 = 0.6;
/// Half-length of the line that marks the sum of both parts, relative to the distance between
/// conditions.
const HALF_TOTAL: f64 = 0.38;
/// Colour strength for the phase part, relative to the magnitude part \[%\].
pub(super) const PHASE_PERCENT: u8 = 45;
/// Space above and below the bars, relative to their height.
const MARGIN: f64 = 0.12;
/// Distance between a value label and its bar, relative to the visible range.
const LABEL_GAP: f64 = 0.05;
/// Labels have no decimals from this magnitude on: 9.95 would be rounded to 10.0.
const WHOLE_FROM: f64 = 9.95;
/// Width of the shading behind a condition without a change, relative to the distance between
/// conditions.
const LEFT_OUT_WIDTH: f64 = 0.7;
/// Colour strength of that shading \[%\].
const LEFT_OUT_PERCENT: u8 = 13;

/// Plots of the change in J, one for each response.
pub(super) struct AssessmentPlots<'a> {
    pub(super) state: &'a State,
    pub(super) table: &'a AssessmentTable,
    pub(super) pairs: Vec<Pair>,
}

/// Change in J at a position on the condition axis.
#[derive(Clone, Copy)]
struct PlacedChange {
    /// The condition's index in the dataset.
    at: f64,
    change: CostChange,
}

/// Part of the change in J with its own bar.
#[derive(Clone, Copy, PartialEq)]
enum BarPart {
    Magnitude,
    Phase,
}

impl PlacedChange {
    fn value(&self, part: BarPart) -> f64 {
        match part {
            BarPart::Magnitude => self.change.magnitude(),
            BarPart::Phase => self.change.phase(),
        }
    }

    /// Returns the value at which a part's bar begins (its foot). The phase part is stacked on the
    /// magnitude part if both have the same sign; otherwise they lie on either side of zero.
    fn foot(&self, part: BarPart) -> f64 {
        let is_stacked =
            part == BarPart::Phase && self.change.magnitude() * self.change.phase() > 0.0;
        if is_stacked {
            self.change.magnitude()
        } else {
            0.0
        }
    }

    /// Returns both parts' end values, and zero.
    fn ends(&self) -> [f64; 3] {
        [
            self.change.magnitude(),
            self.foot(BarPart::Phase) + self.change.phase(),
            0.0,
        ]
    }

    /// Returns the label with the total: above the bar if positive, below if negative.
    fn total_label(&self, range: Range) -> Note {
        let total = self.change.total();
        let further_out = if total > 0.0 { f64::max } else { f64::min };
        let end = self.ends().into_iter().fold(0.0, further_out);
        let gap = LABEL_GAP * range.width();
        let digits = if total.abs() < WHOLE_FROM { 1 } else { 0 };
        Note {
            at: Place::Value {
                x: self.at,
                y: end + gap.copysign(total),
                upright: false,
            },
            text: decimals(total, digits),
        }
    }
}

impl AssessmentPlots<'_> {
    /// Returns a response's change in a condition; `None` if the assessment omits the condition or
    /// has no J for the response.
    pub(super) fn change(&self, condition: ConditionId, pair: Pair) -> Option<CostChange> {
        self.table.change(condition, pair)
    }

    /// Returns the value range that all plots share.
    pub(super) fn common_range(&self) -> Range {
        let mut ends = Vec::new();
        for &pair in &self.pairs {
            for condition in self.state.dataset().conditions() {
                if let Some(change) = self.change(condition.id(), pair) {
                    ends.extend(PlacedChange { at: 0.0, change }.ends());
                }
            }
        }
        Range::spanning(ends)
            .unwrap_or(Range::new(-1.0, 1.0))
            .with_margin(MARGIN, 1.0)
    }

    /// Builds a response's panel with the given value range: in each condition a bar with magnitude
    /// and phase part, and a line across the bar at their sum.
    pub(super) fn panel(&self, pair: Pair, range: Range) -> Panel {
        let mut found = Vec::new();
        let mut left_out = Vec::new();
        let mut names = Vec::new();
        for (index, condition) in self.state.dataset().conditions().iter().enumerate() {
            let at = index as f64;
            names.push(condition.id().to_string());
            match self.change(condition.id(), pair) {
                Some(change) => found.push(PlacedChange { at, change }),
                None => left_out.push(at),
            }
        }
        let value_axis = Axis::linear("").showing(Some(range));
        Panel::new(Axis::named("Condition", names), value_axis)
            .with(left_out_shading(&left_out, range))
            .with_all(bars(&found))
            .with(Rule::horizontal(0.0, Stroke::solid(Color::DIM, 0.6)))
            .with(total_lines(&found))
            .with_all(self.total_labels(&found, range))
            .with_all(left_out.iter().map(|at| left_out_note(*at, range)))
    }

    /// Returns the value labels for the displayed condition and, unless the two are neighbours, for
    /// the condition with the largest change. Labels on every bar would overlap; the status line
    /// shows the other values.
    fn total_labels(&self, found: &[PlacedChange], range: Range) -> Vec<Note> {
        let largest = found
            .iter()
            .max_by(|a, b| a.change.total().abs().total_cmp(&b.change.total().abs()))
            .map(|placed| placed.at);
        let displayed = self.state.condition().id();
        let conditions = self.state.dataset().conditions();
        let displayed = conditions
            .iter()
            .position(|condition| condition.id() == displayed)
            .unwrap_or(0) as f64;
        let mut labels = Vec::new();
        for placed in found {
            let is_largest = Some(placed.at) == largest && (placed.at - displayed).abs() > 1.0;
            if placed.at == displayed || is_largest {
                labels.push(placed.total_label(range));
            }
        }
        labels
    }
}

/// Returns the bars for the magnitude part, then for the phase part; of each the improvements, then
/// the deteriorations.
fn bars(found: &[PlacedChange]) -> Vec<Bars> {
    let mut bars = Vec::new();
    for part in [BarPart::Magnitude, BarPart::Phase] {
        for hue in [Hue::Good, Hue::Warning] {
            bars.push(bars_of_hue(found, part, hue));
        }
    }
    bars
}

/// Returns a part's bars in a colour: positive changes of J, which are deteriorations, have the
/// warning colour.
fn bars_of_hue(found: &[PlacedChange], part: BarPart, hue: Hue) -> Bars {
    let mut bars = Vec::new();
    let mut feet = Vec::new();
    for placed in found {
        let value = placed.value(part);
        if (value > 0.0) == (hue == Hue::Warning) {
            bars.push([placed.at, value]);
            feet.push(placed.foot(part));
        }
    }
    let strength = match part {
        BarPart::Magnitude => 100,
        BarPart::Phase => PHASE_PERCENT,
    };
    Bars {
        name: String::new(),
        color: Color::new(hue).tint(strength),
        width: BAR,
        bars,
        feet,
        beside: 0.0,
    }
}

/// Returns a line across each bar at the total; NaN separates the lines.
fn total_lines(found: &[PlacedChange]) -> Curve {
    let points = found.iter().flat_map(|placed| {
        let total = placed.change.total();
        [
            [placed.at - HALF_TOTAL, total],
            [placed.at + HALF_TOTAL, total],
            [f64::NAN, f64::NAN],
        ]
    });
    Curve::through("ΔJ", Stroke::solid(Color::INK, 1.1), points)
}

/// Shades the places of the conditions without a change in J, over the whole height.
fn left_out_shading(left_out: &[f64], range: Range) -> Spans {
    // The visible range may exceed the data range.
    let range = range.with_margin(1.0, 0.0);
    Spans {
        name: String::new(),
        color: Color::new(Hue::Rejected).tint(LEFT_OUT_PERCENT),
        width: LEFT_OUT_WIDTH,
        spans: left_out
            .iter()
            .map(|at| [*at, range.min, range.max])
            .collect(),
    }
}

fn left_out_note(at: f64, range: Range) -> Note {
    Note {
        at: Place::Value {
            x: at,
            y: range.middle(),
            upright: true,
        },
        text: "left out".to_owned(),
    }
}
