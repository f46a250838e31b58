//! Paints dots, and the labels beside dots and brackets.

use super::dot_style::{DOT, DotStyle};
use super::drawing::{Area, Color, Dash, Shape, Stroke, Text};
use super::label_places::{LabelledDot, Surroundings, place_labels};
use super::letters::width;
use super::marks::{Brackets, Curve, Dots, Mark, RING_PT};
use super::placed::{HOOK, Placed};

/// Line between a dot and a label that is not next to it.
const LEADER: Stroke = Stroke::solid(Color::DIM.tint(60), 0.4);
/// Added to the ring's radius \[pt\], so that labels stay clear of its line, which is about 0.8 pt
/// wide.
const RING_MARGIN: f64 = 0.5;
/// Digit height, relative to the font size; digits have no descenders.
const DIGIT_HEIGHT: f64 = 0.74;

/// Painted dots and labels.
pub(super) struct PaintedDots {
    pub(super) shapes: Vec<Shape>,
    /// Number of labels omitted for lack of room.
    pub(super) labels_left_out: usize,
}

/// A label to be placed, with its dot or bracket.
struct Label<'m> {
    dot: LabelledDot,
    words: &'m str,
    color: Color,
}

/// Paints the dots whose centres are in the frame, without clipping them, and the labels beside
/// dots and brackets.
///
/// 1. Paint the dots; collect the labels of dots and brackets. A dot without text is kept as a label
///    without words, because it is an obstacle to the others.
/// 2. Place the labels (`label_places.rs`), clear of the obstacles in the panel.
/// 3. Paint the labels with their leaders: leaders below the dots, texts above.
pub(super) fn dots_and_labels(placed: &Placed<'_>) -> PaintedDots {
    // Step 1.
    let mut dots = Vec::new();
    let mut labels = Vec::new();
    for mark in &placed.panel.marks {
        match mark {
            Mark::Dots(group) => add_dots(placed, group, &mut dots, &mut labels),
            Mark::Brackets(group) => add_bracket_labels(placed, group, &mut labels),
            _ => {}
        }
    }
    // Step 2.
    let labelled: Vec<LabelledDot> = labels.iter().map(|label| label.dot).collect();
    let places = place_labels(&labelled, &surroundings(placed));
    // Step 3.
    let mut leaders = Vec::new();
    let mut texts = Vec::new();
    let mut labels_left_out = 0;
    for (place, label) in places.into_iter().zip(labels) {
        let Some(place) = place else {
            labels_left_out += usize::from(!label.words.is_empty());
            continue;
        };
        if let Some(end) = place.leader {
            leaders.push(Shape::line([label.dot.center, end], LEADER));
        }
        let at = [place.area.left, place.area.bottom()];
        let text = Text::new(at, label.words, placed.font_size_pt).colored(label.color);
        texts.push(Shape::Text(text));
    }
    PaintedDots {
        shapes: leaders.into_iter().chain(dots).chain(texts).collect(),
        labels_left_out,
    }
}

/// Adds a group's visible dots, and their labels.
fn add_dots<'m>(
    placed: &Placed<'_>,
    group: &'m Dots,
    shapes: &mut Vec<Shape>,
    labels: &mut Vec<Label<'m>>,
) {
    let style = DotStyle::of_group(group);
    for dot in &group.dots {
        if let Some(center) = placed.at([dot.x, dot.y])
            && placed.shows(center)
        {
            shapes.extend(style.shapes(center));
            let radius = if dot.id.is_some() && dot.id == group.ringed {
                RING_PT + RING_MARGIN
            } else {
                DOT
            };
            labels.push(Label {
                dot: labelled_dot(placed, center, radius, &dot.label),
                words: &dot.label,
                color: Color::DIM,
            });
        }
    }
}

/// Adds bracket labels, to be placed around the middle of each bracket's line.
fn add_bracket_labels<'m>(placed: &Placed<'_>, group: &'m Brackets, labels: &mut Vec<Label<'m>>) {
    for bracket in &group.brackets {
        if let Some(ends) = placed.bracket(bracket) {
            let [from, to] = ends.spine;
            let middle = [from[0], 0.5 * (from[1] + to[1])];
            let radius = 0.5 * group.stroke.width_pt;
            labels.push(Label {
                dot: labelled_dot(placed, middle, radius, &bracket.label),
                words: &bracket.label,
                color: group.stroke.color,
            });
        }
    }
}

fn labelled_dot(placed: &Placed<'_>, center: [f64; 2], radius: f64, label: &str) -> LabelledDot {
    LabelledDot {
        center,
        radius,
        size: [
            placed.font_size_pt * width(label),
            placed.font_size_pt * DIGIT_HEIGHT,
        ],
    }
}

/// Collects the obstacles to labels: the curve on which the dots lie, error bars and brackets.
fn surroundings(placed: &Placed<'_>) -> Surroundings {
    let mut path = Vec::new();
    let mut bars = Vec::new();
    for mark in &placed.panel.marks {
        match mark {
            Mark::Curve(curve) if path.is_empty() && is_subject_of_dots(curve) => {
                path = curve
                    .points()
                    .filter_map(|point| placed.at(point))
                    .collect();
            }
            Mark::Intervals(intervals) => {
                for ends in &intervals.ends {
                    if let Some(ends) = placed.vertical(*ends) {
                        bars.push(upright_bar(ends, intervals.stroke.width_pt));
                    }
                }
            }
            Mark::Brackets(group) => {
                for bracket in &group.brackets {
                    if let Some(ends) = placed.bracket(bracket) {
                        bars.push(upright_bar(ends.spine, HOOK));
                    }
                }
            }
            _ => {}
        }
    }
    Surroundings {
        bounds: placed.frame,
        path,
        bars,
    }
}

/// Returns whether a curve is one on which dots may lie: a solid line with an entry in the legend.
fn is_subject_of_dots(curve: &Curve) -> bool {
    curve.key.is_some() && curve.stroke.dash == Dash::Solid
}

/// Returns the area that a vertical line covers \[pt\].
fn upright_bar([from, to]: [[f64; 2]; 2], width: f64) -> Area {
    let top = from[1].min(to[1]);
    let bottom = from[1].max(to[1]);
    Area::new(from[0] - 0.5 * width, top, width, bottom - top)
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::ConditionId;

    use super::super::axis::Axis;
    use super::super::figure::Panel;
    use super::super::marks::{DotShape, MarkId};
    use super::super::range::Range;
    use super::*;

    #[test]
    fn the_label_of_a_ringed_dot_is_outside_its_ring() {
        const LETTERS_PT: f64 = 6.0;
        let mut panel = Panel::new(Axis::linear("x"), Axis::linear("y"));
        let mut dots = Dots::new("dots", DotShape::Circle, Color::DIM).dot(0.5, 0.5, "10");
        let id = MarkId::Condition(ConditionId(10));
        dots.dots[0].id = Some(id.clone());
        dots.ringed = Some(id);
        panel.marks.push(Mark::Dots(dots));
        let unit = Range { min: 0.0, max: 1.0 };
        let painted = panel.shapes(Area::new(0.0, 0.0, 100.0, 60.0), [unit, unit], LETTERS_PT);
        let center: [f64; 2] = [50.0, 30.0];
        let mut labels = 0;
        for shape in painted.shapes {
            let Shape::Text(text) = shape else {
                continue;
            };
            labels += 1;
            let [left, bottom] = text.at;
            let top = bottom - DIGIT_HEIGHT * LETTERS_PT;
            let right = left + LETTERS_PT * width("10");
            let dx = center[0] - center[0].clamp(left, right);
            let dy = center[1] - center[1].clamp(top, bottom);
            assert!(dx.hypot(dy) > RING_PT, "{left} {bottom}");
        }
        assert_eq!(labels, 1);
    }
}
