//! A figure becomes shapes and texts at their places.

use super::axis::Axis;
use super::dot_labels::places;
use super::drawing::{Anchor, Area, Drawing, PT_PER_MM, Shape, Text};
use super::figure::{ColumnWidth, Figure};
use super::layout::{LABEL_LINE, LABEL_PT, Layout, Placed, SMALL_LINE, SMALL_PT, Side, TICK};
use super::legend::{Entry, Sample};
use super::letters::{width, wrapped};
use super::mark::{Along, Bars, Curve, DotShape, Dots, Guide, Mark, Note, Place, Rule, Spans};
use super::range::Range;
use super::simplify::simplified;
use super::stroke::{Color, Stroke};

/// Size of the title \[pt\].
const TITLE_PT: f64 = 8.5;
/// Height of a line of the title \[pt\].
const TITLE_LINE: f64 = 11.0;
/// Space around everything \[pt\].
const MARGIN: f64 = 3.0;
/// How far a line may be from the points that it stands for \[pt\]: a tenth of the finest line.
const TOLERANCE: f64 = 0.04;
/// From the middle of a line of letters down to its base, as a part of their size.
const HALF_HEIGHT: f64 = 0.34;
const FRAME: Stroke = Stroke::solid(Color::DIM, 0.6);
const GRID: Stroke = Stroke::solid(Color::GRID, 0.4);
const GUIDE: Stroke = Stroke::solid(Color::new(0xb4, 0xba, 0xc4), 0.4);
/// Half the width of a dot \[pt\].
const DOT: f64 = 2.1;
/// Width of the line of an open dot, of a cross and of a plus \[pt\].
const DOT_LINE: f64 = 0.9;
/// Width of the piece of line in the legend \[pt\].
const SAMPLE: f64 = 22.0;

impl Figure {
    /// The figure laid out on paper of this width.
    pub fn drawing(&self, width: ColumnWidth) -> Drawing {
        let width_pt = width.mm() * PT_PER_MM;
        let inner = width_pt - 2.0 * MARGIN;
        let mut shapes = Vec::new();
        let mut y = lines(&mut shapes, &self.title, MARGIN, inner, (TITLE_PT, TITLE_LINE, Color::INK));
        let layout = Layout::of(self, inner, y);
        let moved = |placed: Placed<'_>| {
            let frame = Area { left: placed.frame.left + MARGIN, ..placed.frame };
            panel_shapes(&Placed { frame, ..placed })
        };
        shapes.extend(layout.panels.into_iter().flat_map(moved));
        y = legend(&mut shapes, &self.legend(), layout.bottom + 3.0, inner);
        y = lines(&mut shapes, &self.caption, y + 1.0, inner, (SMALL_PT, SMALL_LINE, Color::DIM));
        Drawing { title: self.title.clone(), size: [width_pt, y + MARGIN], shapes }
    }
}

/// Writes a text from `top` down; gives where it ends.
fn lines(shapes: &mut Vec<Shape>, words: &str, top: f64, inner: f64, (size, line, color): (f64, f64, Color)) -> f64 {
    let lines = wrapped(words, inner / size);
    let bottom = top + line * lines.len() as f64;
    shapes.extend(lines.into_iter().enumerate().map(|(at, words)| {
        let place = [MARGIN, top + line * (at as f64 + 0.5) + HALF_HEIGHT * size];
        text(place, words, size, Anchor::Start, color)
    }));
    bottom
}

fn text(at: [f64; 2], words: impl Into<String>, size_pt: f64, anchor: Anchor, color: Color) -> Shape {
    Shape::Text(Text { at, words: words.into(), size_pt, anchor, upright: false, color })
}

/// Draws the legend in lines as wide as the figure, from `top` down; gives where it ends.
fn legend(shapes: &mut Vec<Shape>, entries: &[Entry], top: f64, inner: f64) -> f64 {
    let (mut x, mut y) = (0.0, top + 0.5 * LABEL_LINE);
    for entry in entries {
        let sample = match entry.sample {
            Sample::Line(_) => SAMPLE,
            Sample::Dot { .. } | Sample::Ground(_) => 9.0,
        };
        let whole = sample + 4.0 + SMALL_PT * width(&entry.text);
        if x > 0.0 && x + whole > inner {
            (x, y) = (0.0, y + LABEL_LINE);
        }
        let start = MARGIN + x;
        shapes.extend(match entry.sample {
            Sample::Line(stroke) => vec![Shape::line([[start, y], [start + sample, y]], stroke)],
            Sample::Dot { shape, color, filled } => dot([start + 0.5 * sample, y], shape, color, filled),
            Sample::Ground(color) => vec![Shape::rectangle(Area::new(start, y - 3.0, sample, 6.0), Some(color), None)],
        });
        let place = [start + sample + 4.0, y + HALF_HEIGHT * SMALL_PT];
        shapes.push(text(place, &entry.text, SMALL_PT, Anchor::Start, Color::INK));
        x += whole + 10.0;
    }
    if entries.is_empty() { top } else { y + 0.5 * LABEL_LINE }
}

fn panel_shapes(placed: &Placed<'_>) -> Vec<Shape> {
    let frame = placed.frame;
    let mut within = grounds(placed);
    within.extend(grid(placed));
    within.extend(placed.panel.marks.iter().flat_map(|mark| lines_of(placed, mark)));
    let mut shapes = vec![Shape::Clipped { area: frame, shapes: within }];
    shapes.push(Shape::rectangle(frame, None, Some(FRAME)));
    shapes.extend(horizontal(&placed.x, &placed.panel.x, frame));
    shapes.extend(vertical(&placed.y, &placed.panel.y, frame));
    if !placed.title.is_empty() {
        let [x, y] = frame.at(0.5, 1.0);
        shapes.push(text([x, y - 4.0], placed.title, LABEL_PT, Anchor::Middle, Color::INK));
    }
    shapes.extend(dots_and_labels(placed));
    shapes.extend(placed.panel.marks.iter().flat_map(|mark| rule_label(placed, mark)));
    shapes.extend(placed.panel.marks.iter().filter_map(|mark| words(placed, mark)));
    shapes
}

impl Placed<'_> {
    /// Where a value is on paper; nowhere for what an axis cannot show.
    fn at(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let x = self.panel.x.fraction(x, self.x.range)?;
        Some(self.frame.at(x, self.panel.y.fraction(y, self.y.range)?))
    }

    /// The line across the frame at a value.
    fn across(&self, along: Along, value: f64) -> Option<[[f64; 2]; 2]> {
        Some(match along {
            Along::X => {
                let x = self.panel.x.fraction(value, self.x.range)?;
                [self.frame.at(x, 0.0), self.frame.at(x, 1.0)]
            }
            Along::Y => {
                let y = self.panel.y.fraction(value, self.y.range)?;
                [self.frame.at(0.0, y), self.frame.at(1.0, y)]
            }
        })
    }

    /// Whether a place on paper is in the frame, or on its edge up to rounding.
    fn shows(&self, [x, y]: [f64; 2]) -> bool {
        let slack = 0.5;
        let Area { left, top, width, height } = self.frame;
        Area::new(left - slack, top - slack, width + 2.0 * slack, height + 2.0 * slack).contains([x, y])
    }
}

/// Grounds lie below the grid.
fn grounds(placed: &Placed<'_>) -> Vec<Shape> {
    let mut shapes = bands(placed);
    for mark in &placed.panel.marks {
        if let Mark::Spans(Spans { color, width, spans, .. }) = mark {
            let areas = spans.iter().filter_map(|&[x, lower, upper]| {
                let from = placed.at([x - 0.5 * width, lower])?;
                Some(rectangle(from, placed.at([x + 0.5 * width, upper])?, *color, None))
            });
            shapes.extend(areas);
        }
    }
    shapes
}

/// The rectangle between two corners.
fn rectangle(from: [f64; 2], to: [f64; 2], color: Color, stroke: Option<Stroke>) -> Shape {
    let points = vec![from, [from[0], to[1]], to, [to[0], from[1]]];
    Shape::Path { points, closed: true, fill: Some(color), stroke }
}

fn bands(placed: &Placed<'_>) -> Vec<Shape> {
    let band = |mark: &Mark| {
        let Mark::Band(band) = mark else { return None };
        let Range { min, max } = band.range;
        let ([from, to], [far_from, far_to]) = (placed.across(band.along, min)?, placed.across(band.along, max)?);
        Some(Shape::Path {
            points: vec![from, to, far_to, far_from],
            closed: true,
            fill: Some(band.color),
            stroke: None,
        })
    };
    placed.panel.marks.iter().filter_map(band).collect()
}

fn grid(placed: &Placed<'_>) -> Vec<Shape> {
    let is_named = |axis: &Axis| axis.names.is_some();
    let lines = |along: Along, side: &Side, axis: &Axis| -> Vec<Shape> {
        let ticks = side.ticks.iter().filter(|_| !is_named(axis));
        ticks.filter_map(|tick| Some(Shape::line(placed.across(along, tick.value)?, GRID))).collect()
    };
    let mut shapes = lines(Along::X, &placed.x, &placed.panel.x);
    shapes.extend(lines(Along::Y, &placed.y, &placed.panel.y));
    shapes
}

/// What is drawn within the frame of a mark.
fn lines_of(placed: &Placed<'_>, mark: &Mark) -> Vec<Shape> {
    match mark {
        Mark::Curve(curve) => curve_lines(placed, curve),
        Mark::Bars(bars) => bar_shapes(placed, bars),
        Mark::Rule(Rule { along, at, stroke, .. }) => {
            placed.across(*along, *at).map(|ends| Shape::line(ends, *stroke)).into_iter().collect()
        }
        Mark::Guide(Guide { points, .. }) => {
            let points: Vec<[f64; 2]> = points.iter().filter_map(|point| placed.at(*point)).collect();
            vec![Shape::line(points, GUIDE)]
        }
        Mark::Dots(_) | Mark::Band(_) | Mark::Spans(_) | Mark::Note(_) => Vec::new(),
    }
}

/// A curve without what lies outside the frame: what is drawn is no longer than what is seen.
fn curve_lines(placed: &Placed<'_>, curve: &Curve) -> Vec<Shape> {
    let points: Vec<Option<[f64; 2]>> =
        curve.points().map(|point| placed.at(point).filter(|place| place.iter().all(|c| c.abs() < 1e6))).collect();
    let runs = points.split(Option::is_none).map(|run| run.iter().copied().flatten().collect::<Vec<[f64; 2]>>());
    let lines = runs.filter(|run| run.len() > 1);
    lines.map(|run| Shape::line(simplified(&run, TOLERANCE), curve.stroke)).collect()
}

fn bar_shapes(placed: &Placed<'_>, bars: &Bars) -> Vec<Shape> {
    let bar = |(&[x, _], [foot, top]): (&[f64; 2], [f64; 2])| {
        let left = x + bars.beside - 0.5 * bars.width;
        let (foot, top) = (placed.at([left, foot])?, placed.at([left + bars.width, top])?);
        Some(rectangle(foot, top, bars.color, Some(Stroke::solid(Color::DIM, 0.3))))
    };
    bars.bars.iter().zip(bars.ends()).filter_map(bar).collect()
}

/// Dots are drawn whole where their middle is in the frame, with their texts around them.
fn dots_and_labels(placed: &Placed<'_>) -> Vec<Shape> {
    let groups = placed.panel.marks.iter().filter_map(|mark| match mark {
        Mark::Dots(dots) => Some(dots),
        _ => None,
    });
    let (mut shapes, mut labels) = (Vec::new(), Vec::new());
    for Dots { shape, color, filled, dots, .. } in groups {
        for one in dots {
            let Some(center) = placed.at([one.x, one.y]).filter(|center| placed.shows(*center)) else { continue };
            shapes.extend(dot(center, *shape, *color, *filled));
            labels.push((center, one.label.as_str()));
        }
    }
    for (area, (_, label)) in places(&labels, &placed.frame).into_iter().zip(&labels) {
        if !label.is_empty() {
            shapes.push(text([area.left, area.bottom()], *label, SMALL_PT, Anchor::Start, Color::DIM));
        }
    }
    shapes
}

/// A dot of a shape; all shapes cover about the same area.
fn dot([x, y]: [f64; 2], shape: DotShape, color: Color, filled: bool) -> Vec<Shape> {
    let line = Stroke::solid(color, DOT_LINE);
    let (fill, stroke, size) =
        if filled { (Some(color), None, DOT) } else { (Some(Color::WHITE), Some(line), DOT - 0.5 * DOT_LINE) };
    let corners = |corners: &[[f64; 2]]| {
        let points = corners.iter().map(|[dx, dy]| [x + size * dx, y + size * dy]).collect();
        vec![Shape::Path { points, closed: true, fill, stroke }]
    };
    // Both strokes as one line, over the middle.
    let strokes = |[a, b, c, d]: [[f64; 2]; 4]| {
        let points: Vec<[f64; 2]> = [a, b, [0.0, 0.0], c, d].map(|[dx, dy]| [x + DOT * dx, y + DOT * dy]).into();
        vec![Shape::line(points, line)]
    };
    match shape {
        DotShape::Circle => vec![Shape::Circle { center: [x, y], radius: size, fill, stroke }],
        DotShape::Diamond => corners(&[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]]),
        DotShape::Square => corners(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        DotShape::Triangle => corners(&[[0.0, -1.3], [1.2, 0.9], [-1.2, 0.9]]),
        DotShape::Cross => strokes([[-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [1.0, -1.0]]),
        DotShape::Plus => strokes([[-1.3, 0.0], [1.3, 0.0], [0.0, -1.3], [0.0, 1.3]]),
    }
}

/// The words beside a line across the frame, on white, so that curves may run behind them.
fn rule_label(placed: &Placed<'_>, mark: &Mark) -> Vec<Shape> {
    let Mark::Rule(Rule { along, at, label, .. }) = mark else { return Vec::new() };
    let Some([_, [x, y]]) = placed.across(*along, *at).filter(|[_, end]| !label.is_empty() && placed.shows(*end))
    else {
        return Vec::new();
    };
    let [x, y] = match along {
        Along::Y => [x - 2.0, y - 2.0],
        Along::X => [x - 2.0, y + SMALL_LINE],
    };
    let length = SMALL_PT * width(label);
    let ground = Area::new(x - length - 1.0, y - 0.75 * SMALL_PT, length + 2.0, 0.8 * SMALL_PT);
    let words = text([x, y], label, SMALL_PT, Anchor::End, Color::DIM);
    vec![Shape::rectangle(ground, Some(Color::WHITE), None), words]
}

/// The words that belong to a mark.
fn words(placed: &Placed<'_>, mark: &Mark) -> Option<Shape> {
    let small = |at, words: &str, anchor| text(at, words, SMALL_PT, anchor, Color::DIM);
    match mark {
        Mark::Guide(Guide { points, label }) if !label.is_empty() => {
            let visible = points.iter().rev().filter_map(|point| placed.at(*point)).find(|place| placed.shows(*place));
            visible.map(|[x, y]| small([x + 1.5, y + SMALL_PT], label, Anchor::Start))
        }
        Mark::Note(Note { at, text: words }) => match at {
            Place::Value { x, y, upright } => {
                let [x, y] = placed.at([*x, *y])?;
                let (at, upright) = if *upright {
                    ([x + HALF_HEIGHT * SMALL_PT, y], true)
                } else {
                    ([x, y + HALF_HEIGHT * SMALL_PT], false)
                };
                let (words, anchor) = (words.clone(), Anchor::Middle);
                Some(Shape::Text(Text { at, words, size_pt: SMALL_PT, anchor, upright, color: Color::DIM }))
            }
            Place::UpperRight => {
                let [x, y] = placed.frame.at(1.0, 1.0);
                Some(small([x - 2.0, y + SMALL_LINE - 1.0], words, Anchor::End))
            }
            Place::LowerLeft => {
                let [x, y] = placed.frame.at(0.0, 0.0);
                Some(small([x + 2.0, y - 2.5], words, Anchor::Start))
            }
        },
        _ => None,
    }
}

/// Ticks, numbers and label below a frame.
fn horizontal(side: &Side, axis: &Axis, frame: Area) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for tick in &side.ticks {
        let Some(fraction) = axis.fraction(tick.value, side.range) else { continue };
        let [x, y] = frame.at(fraction, 0.0);
        let length = if tick.label.is_some() { TICK } else { 0.6 * TICK };
        shapes.push(Shape::line([[x, y], [x, y + length]], FRAME));
        if let Some(label) = tick.label.as_ref().filter(|_| side.has_numbers) {
            shapes.push(text([x, y + TICK + SMALL_PT], label, SMALL_PT, Anchor::Middle, Color::INK));
        }
    }
    if side.has_label {
        let is_wide = LABEL_PT * width(&axis.label) > frame.width;
        let (part, anchor) = if is_wide { (0.0, Anchor::Start) } else { (0.5, Anchor::Middle) };
        let [x, y] = frame.at(part, 0.0);
        shapes.push(text([x, y + side.depth + LABEL_PT - 0.5], &axis.label, LABEL_PT, anchor, Color::INK));
    }
    shapes
}

/// Ticks, numbers and label at the left of a frame.
fn vertical(side: &Side, axis: &Axis, frame: Area) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for tick in &side.ticks {
        let Some(fraction) = axis.fraction(tick.value, side.range) else { continue };
        let [x, y] = frame.at(0.0, fraction);
        shapes.push(Shape::line([[x - TICK, y], [x, y]], FRAME));
        if let Some(label) = tick.label.as_ref().filter(|_| side.has_numbers) {
            let place = [x - TICK - 1.5, y + HALF_HEIGHT * SMALL_PT];
            shapes.push(text(place, label, SMALL_PT, Anchor::End, Color::INK));
        }
    }
    if side.has_label {
        let [x, y] = frame.at(0.0, 0.5);
        let (words, at) = (axis.label.clone(), [x - side.depth - 2.5, y]);
        let (anchor, color) = (Anchor::Middle, Color::INK);
        shapes.push(Shape::Text(Text { at, words, size_pt: LABEL_PT, anchor, upright: true, color }));
    }
    shapes
}
