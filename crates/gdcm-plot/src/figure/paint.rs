//! Painting of a figure: shapes and texts at their places.

use super::axis::{Axis, Range};
use super::drawing::{Anchor, Area, Color, Dash, Drawing, PT_PER_MM, Shape, Stroke, Text};
use super::figure::{Figure, Panel};
use super::figure_format::ColumnWidth;
use super::label_places::{LabelledDot, Surroundings, place_labels};
use super::layout::{
    LABEL_LINE, LABEL_PT, Layout, Placed, SMALL_LINE, SMALL_PT, Side, TICK, width, wrapped,
};
use super::legend::{Entry, Sample};
use super::marks::{
    Along, Bars, Bracket, Brackets, Curve, DotShape, Dots, Envelope, Guide, Intervals, Mark, Note,
    Place, Rule, Spans,
};
use super::thinning::{Pixel, thinned};

/// Font size of the title \[pt\].
const TITLE_PT: f64 = 8.5;
/// Height of a line of the title \[pt\].
const TITLE_LINE: f64 = 11.0;
/// Margin around everything \[pt\].
const MARGIN: f64 = 3.0;
/// Maximum distance of a line from its original points \[pt\]: a tenth of the thinnest line.
const TOLERANCE: f64 = 0.04;
const FINEST: Pixel = Pixel {
    width: TOLERANCE,
    tolerance: TOLERANCE,
};
/// Distance from the middle of a line of text down to its base line, relative to the font size.
const HALF_HEIGHT: f64 = 0.34;
const FRAME: Stroke = Stroke::solid(Color::DIM, 0.6);
const GRID: Stroke = Stroke::solid(Color::GRID, 0.4);
/// Leader from a dot to a label away from it.
const LEADER: Stroke = Stroke::solid(Color::DIM.tint(60), 0.4);
const GUIDE: Stroke = Stroke::solid(Color::DIM.tint(40), 0.4);
/// Half the width of a dot \[pt\].
const DOT: f64 = 2.1;
/// Distance of a bracket from its values, and length of its ends \[pt\].
const BRACKET: f64 = 5.0;
const HOOK: f64 = 1.8;
/// Height of a line of digits relative to the font size: they have no descenders.
const FIGURE_HEIGHT: f64 = 0.74;
/// Line width of an open dot, of a cross and of a plus \[pt\].
const DOT_LINE: f64 = 0.9;
/// Width of the line sample in the legend \[pt\].
const SAMPLE: f64 = 22.0;

impl Figure {
    /// Lays the figure out on paper of this width.
    pub fn drawing(&self, width: ColumnWidth) -> Drawing {
        let width_pt = width.mm() * PT_PER_MM;
        let inner = width_pt - 2.0 * MARGIN;
        let mut shapes = Vec::new();
        let mut y = lines(
            &mut shapes,
            &self.title,
            MARGIN,
            inner,
            (TITLE_PT, TITLE_LINE, Color::INK),
        );
        let layout = Layout::of(self, inner, y);
        let mut left_out = 0;
        for placed in layout.panels {
            let frame = Area {
                left: placed.frame.left + MARGIN,
                ..placed.frame
            };
            let (panel, without_label) = panel_shapes(&Placed { frame, ..placed });
            shapes.extend(panel);
            left_out += without_label;
        }
        y = legend(&mut shapes, &self.legend(), layout.bottom + 3.0, inner);
        let caption = match left_out {
            0 => self.caption.clone(),
            count => format!(
                "{} Without room, and left out: {count} of the labels.",
                self.caption
            ),
        };
        y = lines(
            &mut shapes,
            &caption,
            y + 1.0,
            inner,
            (SMALL_PT, SMALL_LINE, Color::DIM),
        );
        Drawing {
            title: self.title.clone(),
            size: [width_pt, y + MARGIN],
            shapes,
        }
    }
}

/// Writes a text from `top` down; returns its lower end.
fn lines(
    shapes: &mut Vec<Shape>,
    words: &str,
    top: f64,
    inner: f64,
    (size, line, color): (f64, f64, Color),
) -> f64 {
    let lines = wrapped(words, inner / size);
    let bottom = top + line * lines.len() as f64;
    shapes.extend(lines.into_iter().enumerate().map(|(at, words)| {
        let place = [MARGIN, top + line * (at as f64 + 0.5) + HALF_HEIGHT * size];
        text(place, words, size, Anchor::Start, color)
    }));
    bottom
}

fn text(
    at: [f64; 2],
    words: impl Into<String>,
    size_pt: f64,
    anchor: Anchor,
    color: Color,
) -> Shape {
    Shape::Text(Text {
        at,
        words: words.into(),
        size_pt,
        anchor,
        upright: false,
        color,
    })
}

/// Draws the legend in lines as wide as the figure, from `top` down; returns its lower end.
fn legend(shapes: &mut Vec<Shape>, entries: &[Entry], top: f64, inner: f64) -> f64 {
    let mut x = 0.0;
    let mut y = top + 0.5 * LABEL_LINE;
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
            Sample::Line(stroke) => {
                vec![Shape::line([[start, y], [start + sample, y]], stroke)]
            }
            Sample::Dot {
                shape,
                color,
                filled,
            } => dot_shapes([start + 0.5 * sample, y], (shape, 1.0), color, filled),
            Sample::Ground(color) => vec![Shape::rectangle(
                Area::new(start, y - 3.0, sample, 6.0),
                Some(color),
                None,
            )],
        });
        let place = [start + sample + 4.0, y + HALF_HEIGHT * SMALL_PT];
        shapes.push(text(
            place,
            &entry.text,
            SMALL_PT,
            Anchor::Start,
            Color::INK,
        ));
        x += whole + 10.0;
    }
    if entries.is_empty() {
        top
    } else {
        y + 0.5 * LABEL_LINE
    }
}

/// Returns the shapes of a panel, and the number of labels without room in it.
fn panel_shapes(placed: &Placed<'_>) -> (Vec<Shape>, usize) {
    let frame = placed.frame;
    let mut within = grounds(placed);
    within.extend(grid(placed));
    within.extend(
        placed
            .panel
            .marks
            .iter()
            .flat_map(|mark| lines_of(placed, mark)),
    );
    let mut shapes = vec![Shape::Clipped {
        area: frame,
        shapes: within,
    }];
    shapes.push(Shape::rectangle(frame, None, Some(FRAME)));
    shapes.extend(horizontal(&placed.x, &placed.panel.x, frame));
    shapes.extend(vertical(&placed.y, &placed.panel.y, frame));
    if !placed.title.is_empty() {
        let [x, y] = frame.at(0.5, 1.0);
        shapes.push(text(
            [x, y - 4.0],
            placed.title,
            LABEL_PT,
            Anchor::Middle,
            Color::INK,
        ));
    }
    let left_out = dots_and_words(placed, &mut shapes);
    (shapes, left_out)
}

/// Adds dots and texts, which lie over the lines of a panel and may cross its frame; returns the
/// number of labels without room.
fn dots_and_words(placed: &Placed<'_>, shapes: &mut Vec<Shape>) -> usize {
    let (dots, left_out) = dots_and_labels(placed);
    shapes.extend(dots);
    shapes.extend(
        placed
            .panel
            .marks
            .iter()
            .flat_map(|mark| rule_label(placed, mark)),
    );
    shapes.extend(
        placed
            .panel
            .marks
            .iter()
            .filter_map(|mark| words(placed, mark)),
    );
    left_out
}

impl Panel {
    /// Draws the marks in `frame` with these ranges of both axes and this font size \[pt\]; also
    /// returns the number of labels without room. For canvases that draw axes of their own: areas
    /// with edges are filled.
    pub fn shapes(&self, frame: Area, [x, y]: [Range; 2], letters_pt: f64) -> (Vec<Shape>, usize) {
        let side = |range| Side {
            range,
            ticks: Vec::new(),
            has_numbers: false,
            has_label: false,
            depth: 0.0,
        };
        let placed = Placed {
            panel: self,
            title: "",
            frame,
            x: side(x),
            y: side(y),
            letters_pt,
        };
        let mut within = grounds(&placed);
        for mark in &self.marks {
            match mark {
                Mark::Envelope(of) if of.edge.is_some() => within.extend(envelope(&placed, of)),
                mark => within.extend(lines_of(&placed, mark)),
            }
        }
        let mut shapes = vec![Shape::Clipped {
            area: frame,
            shapes: within,
        }];
        let left_out = dots_and_words(&placed, &mut shapes);
        (shapes, left_out)
    }
}

impl Placed<'_> {
    /// Returns the position of a value on paper; `None` for a value that an axis cannot show.
    fn at(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let x = self.panel.x.fraction(x, self.x.range)?;
        Some(self.frame.at(x, self.panel.y.fraction(y, self.y.range)?))
    }

    /// Returns the line across the frame at a value.
    fn across(&self, along: Along, value: f64) -> Option<[[f64; 2]; 2]> {
        let ends = [0.0, 1.0];
        Some(match along {
            Along::X => {
                let x = self.panel.x.fraction(value, self.x.range)?;
                ends.map(|y| self.frame.at(x, y))
            }
            Along::Y => {
                let y = self.panel.y.fraction(value, self.y.range)?;
                ends.map(|x| self.frame.at(x, y))
            }
        })
    }

    /// Returns a bracket on paper: the ends of its spine and the ends of its hooks; to the right of
    /// its values if there is no room to their left.
    fn bracket(&self, bracket: &Bracket) -> Option<[[[f64; 2]; 2]; 2]> {
        let [from, to] = bracket.ends.map(|end| self.at([bracket.x, end]));
        let ends = [from?, to?];
        let side = if ends[0][0] - BRACKET < self.frame.left + 1.0 {
            1.0
        } else {
            -1.0
        };
        let moved = |by: f64| ends.map(|[x, y]| [x + side * by, y]);
        Some([moved(BRACKET), moved(BRACKET - HOOK)])
    }

    /// Returns whether a place on paper is in the frame, or on its edge up to rounding.
    fn shows(&self, place: [f64; 2]) -> bool {
        self.frame.expanded(0.5).contains(place)
    }
}

/// Draws the backgrounds, which lie below the grid.
fn grounds(placed: &Placed<'_>) -> Vec<Shape> {
    let mut shapes = bands(placed);
    for mark in &placed.panel.marks {
        if let Mark::Spans(Spans {
            color,
            width,
            spans,
            ..
        }) = mark
        {
            let areas = spans.iter().filter_map(|&[x, lower, upper]| {
                let from = placed.at([x - 0.5 * width, lower])?;
                Some(rectangle(
                    from,
                    placed.at([x + 0.5 * width, upper])?,
                    *color,
                    None,
                ))
            });
            shapes.extend(areas);
        }
        if let Mark::Envelope(of) = mark
            && of.edge.is_none()
        {
            shapes.extend(envelope(placed, of));
        }
    }
    shapes
}

/// Draws the area of an envelope, stretch by stretch: along its lower edge, and back along its
/// upper edge.
fn envelope(placed: &Placed<'_>, Envelope { color, points, .. }: &Envelope) -> Vec<Shape> {
    let ends = |&[x, low, high]: &[f64; 3]| Some([placed.at([x, low])?, placed.at([x, high])?]);
    let ends: Vec<Option<[[f64; 2]; 2]>> = points.iter().map(ends).collect();
    let runs = ends.split(Option::is_none).filter(|run| run.len() > 1);
    let area = |run: &[Option<[[f64; 2]; 2]>]| {
        let (lower, upper): (Vec<_>, Vec<_>) = run
            .iter()
            .flatten()
            .map(|[low, high]| (*low, *high))
            .unzip();
        let points = lower.into_iter().chain(upper.into_iter().rev()).collect();
        Shape::Path {
            points,
            closed: true,
            fill: Some(*color),
            stroke: None,
        }
    };
    runs.map(area).collect()
}

/// Creates the rectangle between two corners.
fn rectangle(from: [f64; 2], to: [f64; 2], color: Color, stroke: Option<Stroke>) -> Shape {
    let points = vec![from, [from[0], to[1]], to, [to[0], from[1]]];
    Shape::Path {
        points,
        closed: true,
        fill: Some(color),
        stroke,
    }
}

fn bands(placed: &Placed<'_>) -> Vec<Shape> {
    let band = |mark: &Mark| {
        let Mark::Band(band) = mark else { return None };
        let [from, _] = placed.across(Along::X, band.range.min)?;
        let [_, far] = placed.across(Along::X, band.range.max)?;
        Some(rectangle(from, far, band.color, None))
    };
    placed.panel.marks.iter().filter_map(band).collect()
}

fn grid(placed: &Placed<'_>) -> Vec<Shape> {
    let is_named = |axis: &Axis| axis.names.is_some();
    let lines = |along: Along, side: &Side, axis: &Axis| -> Vec<Shape> {
        let ticks = side.ticks.iter().filter(|_| !is_named(axis));
        ticks
            .filter_map(|tick| Some(Shape::line(placed.across(along, tick.value)?, GRID)))
            .collect()
    };
    let mut shapes = lines(Along::X, &placed.x, &placed.panel.x);
    shapes.extend(lines(Along::Y, &placed.y, &placed.panel.y));
    shapes
}

/// Draws the part of a mark that is clipped to the frame.
fn lines_of(placed: &Placed<'_>, mark: &Mark) -> Vec<Shape> {
    match mark {
        Mark::Curve(curve) => curve_lines(placed, curve),
        Mark::Bars(bars) => bar_shapes(placed, bars),
        Mark::Rule(Rule {
            along, at, stroke, ..
        }) => placed
            .across(*along, *at)
            .map(|ends| Shape::line(ends, *stroke))
            .into_iter()
            .collect(),
        Mark::Guide(Guide { points, .. }) => {
            let points: Vec<[f64; 2]> = points
                .iter()
                .filter_map(|point| placed.at(*point))
                .collect();
            vec![Shape::line(points, GUIDE)]
        }
        Mark::Intervals(Intervals { stroke, ends, .. }) => {
            let ends = ends
                .iter()
                .filter_map(|&[x, low, high]| Some([placed.at([x, low])?, placed.at([x, high])?]));
            ends.map(|ends| Shape::line(ends, *stroke)).collect()
        }
        Mark::Brackets(Brackets {
            stroke, brackets, ..
        }) => {
            let places = brackets
                .iter()
                .filter_map(|bracket| placed.bracket(bracket));
            places
                .map(|[spine, hooks]| bracket_line(spine, hooks, *stroke))
                .collect()
        }
        Mark::Envelope(of) => of
            .edges()
            .iter()
            .flat_map(|edge| curve_lines(placed, edge))
            .collect(),
        Mark::Dots(_) | Mark::Band(_) | Mark::Spans(_) | Mark::Note(_) => Vec::new(),
    }
}

/// Draws a curve without the parts outside the frame, so that no invisible parts are drawn.
fn curve_lines(placed: &Placed<'_>, curve: &Curve) -> Vec<Shape> {
    let points: Vec<Option<[f64; 2]>> = curve
        .points()
        .map(|point| {
            placed
                .at(point)
                .filter(|place| place.iter().all(|c| c.abs() < 1e6))
        })
        .collect();
    let runs = points
        .split(Option::is_none)
        .map(|run| run.iter().copied().flatten().collect::<Vec<[f64; 2]>>());
    let lines = runs.filter(|run| run.len() > 1);
    lines
        .map(|run| Shape::line(thinned(&run, FINEST), curve.stroke))
        .collect()
}

fn bar_shapes(placed: &Placed<'_>, bars: &Bars) -> Vec<Shape> {
    let bar = |(&[x, _], [foot, top]): (&[f64; 2], [f64; 2])| {
        let left = x + bars.beside - 0.5 * bars.width;
        let foot = placed.at([left, foot])?;
        let top = placed.at([left + bars.width, top])?;
        Some(rectangle(
            foot,
            top,
            bars.color,
            Some(Stroke::solid(Color::DIM, 0.3)),
        ))
    };
    bars.bars.iter().zip(bars.ends()).filter_map(bar).collect()
}

/// Draws a bracket as one line: from the end of one hook along the spine to the end of the other.
fn bracket_line([from, to]: [[f64; 2]; 2], [near, far]: [[f64; 2]; 2], stroke: Stroke) -> Shape {
    Shape::line([near, from, to, far], stroke)
}

/// Draws whole dots if their centre is in the frame, with their labels around them and those of
/// brackets beside these; also returns the number of labels without room.
fn dots_and_labels(placed: &Placed<'_>) -> (Vec<Shape>, usize) {
    let mut shapes = Vec::new();
    let mut labels = Vec::new();
    for mark in &placed.panel.marks {
        match mark {
            Mark::Dots(Dots {
                shape,
                color,
                filled,
                size,
                dots,
                ..
            }) => {
                for one in dots {
                    let Some(center) = placed
                        .at([one.x, one.y])
                        .filter(|center| placed.shows(*center))
                    else {
                        continue;
                    };
                    shapes.extend(dot_shapes(center, (*shape, *size), *color, *filled));
                    labels.push((
                        labelled(placed, center, DOT, &one.label),
                        &one.label,
                        Color::DIM,
                    ));
                }
            }
            Mark::Brackets(Brackets {
                stroke, brackets, ..
            }) => {
                for bracket in brackets {
                    let Some([[from, to], _]) = placed.bracket(bracket) else {
                        continue;
                    };
                    let middle = [from[0], 0.5 * (from[1] + to[1])];
                    let label = labelled(placed, middle, 0.5 * stroke.width_pt, &bracket.label);
                    labels.push((label, &bracket.label, stroke.color));
                }
            }
            _ => {}
        }
    }
    let dots: Vec<LabelledDot> = labels.iter().map(|(dot, ..)| *dot).collect();
    let mut leaders = Vec::new();
    let mut texts = Vec::new();
    let mut left_out = 0;
    for (place, (dot, label, color)) in place_labels(&dots, &surroundings(placed))
        .into_iter()
        .zip(labels)
    {
        let Some(place) = place else {
            left_out += usize::from(!label.is_empty());
            continue;
        };
        leaders.extend(
            place
                .leader
                .map(|end| Shape::line([dot.center, end], LEADER)),
        );
        texts.push(text(
            [place.area.left, place.area.bottom()],
            label,
            placed.letters_pt,
            Anchor::Start,
            color,
        ));
    }
    (
        leaders.into_iter().chain(shapes).chain(texts).collect(),
        left_out,
    )
}

fn labelled(placed: &Placed<'_>, center: [f64; 2], radius: f64, label: &str) -> LabelledDot {
    LabelledDot {
        center,
        radius,
        size: [width(label), FIGURE_HEIGHT].map(|part| placed.letters_pt * part),
    }
}

/// Returns the obstacles for the labels of a panel.
fn surroundings(placed: &Placed<'_>) -> Surroundings {
    let mut path = Vec::new();
    let mut bars = Vec::new();
    let mut upright = |from: [f64; 2], to: [f64; 2], width: f64| {
        let top = from[1].min(to[1]);
        let bottom = from[1].max(to[1]);
        bars.push(Area::new(from[0] - 0.5 * width, top, width, bottom - top));
    };
    for mark in &placed.panel.marks {
        match mark {
            // The first curve with an entry in the legend is the one to which the dots refer.
            Mark::Curve(curve)
                if path.is_empty() && curve.key.is_some() && curve.stroke.dash == Dash::Solid =>
            {
                path = curve
                    .points()
                    .filter_map(|point| placed.at(point))
                    .collect();
            }
            Mark::Intervals(Intervals { stroke, ends, .. }) => {
                let ends = ends.iter().filter_map(|&[x, low, high]| {
                    Some((placed.at([x, low])?, placed.at([x, high])?))
                });
                ends.for_each(|(from, to)| upright(from, to, stroke.width_pt));
            }
            Mark::Brackets(Brackets { brackets, .. }) => {
                let spines = brackets
                    .iter()
                    .filter_map(|bracket| placed.bracket(bracket));
                spines.for_each(|[[from, to], _]| upright(from, to, HOOK));
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

/// Draws a dot with this shape and a size relative to the default; all shapes have about the same
/// area.
pub fn dot_shapes(
    [x, y]: [f64; 2],
    (shape, part): (DotShape, f64),
    color: Color,
    filled: bool,
) -> Vec<Shape> {
    let line = Stroke::solid(color, DOT_LINE * part.sqrt());
    let radius = DOT * part;
    let (fill, stroke, size) = if filled {
        (Some(color), None, radius)
    } else {
        (Some(Color::WHITE), Some(line), radius - 0.5 * DOT_LINE)
    };
    let corners = |corners: &[[f64; 2]]| {
        let points = corners
            .iter()
            .map(|[dx, dy]| [x + size * dx, y + size * dy])
            .collect();
        vec![Shape::Path {
            points,
            closed: true,
            fill,
            stroke,
        }]
    };
    // Two lines: a line that turns back over the middle has no direction there, and its corner no
    // place on the screen.
    let strokes = |ends: [[[f64; 2]; 2]; 2]| {
        let place = |[dx, dy]: [f64; 2]| [x + radius * dx, y + radius * dy];
        ends.map(|ends| Shape::line(ends.map(place).to_vec(), line))
            .to_vec()
    };
    match shape {
        DotShape::Circle => vec![Shape::Circle {
            center: [x, y],
            radius: size,
            fill,
            stroke,
        }],
        DotShape::Diamond => corners(&[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]]),
        DotShape::Square => corners(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        DotShape::Triangle => corners(&[[0.0, -1.3], [1.2, 0.9], [-1.2, 0.9]]),
        DotShape::Cross => strokes([[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [1.0, -1.0]]]),
        DotShape::Plus => strokes([[[-1.3, 0.0], [1.3, 0.0]], [[0.0, -1.3], [0.0, 1.3]]]),
    }
}

/// Draws the text beside a line across the frame, on white, so that curves may run behind it.
fn rule_label(placed: &Placed<'_>, mark: &Mark) -> Vec<Shape> {
    let Mark::Rule(Rule {
        along, at, label, ..
    }) = mark
    else {
        return Vec::new();
    };
    let Some([_, [x, y]]) = placed
        .across(*along, *at)
        .filter(|[_, end]| !label.is_empty() && placed.shows(*end))
    else {
        return Vec::new();
    };
    let [x, y] = match along {
        Along::Y => [x - 2.0, y - 2.0],
        Along::X => [x - 2.0, y + SMALL_LINE],
    };
    let length = SMALL_PT * width(label);
    let ground = Area::new(
        x - length - 1.0,
        y - 0.75 * SMALL_PT,
        length + 2.0,
        0.8 * SMALL_PT,
    );
    let words = text([x, y], label, SMALL_PT, Anchor::End, Color::DIM);
    vec![Shape::rectangle(ground, Some(Color::WHITE), None), words]
}

/// Draws the text of a mark.
fn words(placed: &Placed<'_>, mark: &Mark) -> Option<Shape> {
    let size_pt = placed.letters_pt;
    let small = |at, words: &str, anchor| text(at, words, size_pt, anchor, Color::DIM);
    match mark {
        Mark::Guide(Guide { points, label }) if !label.is_empty() => {
            let visible = points
                .iter()
                .rev()
                .filter_map(|point| placed.at(*point))
                .find(|place| placed.shows(*place));
            visible.map(|[x, y]| small([x + 1.5, y + size_pt], label, Anchor::Start))
        }
        Mark::Note(Note { at, text: words }) => match at {
            Place::Value { x, y, upright } => {
                // Texts about a name on an axis need room beside those of the next.
                let slot = placed.frame.width / placed.x.range.width();
                let is_named = placed.panel.x.names.is_some();
                if is_named && !upright && size_pt * width(words) > slot {
                    return None;
                }
                let [x, y] = placed.at([*x, *y])?;
                let (at, upright) = if *upright {
                    ([x + HALF_HEIGHT * size_pt, y], true)
                } else {
                    ([x, y + HALF_HEIGHT * size_pt], false)
                };
                let words = words.clone();
                let anchor = Anchor::Middle;
                Some(Shape::Text(Text {
                    at,
                    words,
                    size_pt,
                    anchor,
                    upright,
                    color: Color::DIM,
                }))
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

/// Draws ticks, numbers and label below a frame.
fn horizontal(side: &Side, axis: &Axis, frame: Area) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for tick in &side.ticks {
        let Some(fraction) = axis.fraction(tick.value, side.range) else {
            continue;
        };
        let [x, y] = frame.at(fraction, 0.0);
        let length = if tick.label.is_some() {
            TICK
        } else {
            0.6 * TICK
        };
        shapes.push(Shape::line([[x, y], [x, y + length]], FRAME));
        if let Some(label) = tick.label.as_ref().filter(|_| side.has_numbers) {
            shapes.push(text(
                [x, y + TICK + SMALL_PT],
                label,
                SMALL_PT,
                Anchor::Middle,
                Color::INK,
            ));
        }
    }
    if side.has_label {
        let is_wide = LABEL_PT * width(&axis.label) > frame.width;
        let (part, anchor) = if is_wide {
            (0.0, Anchor::Start)
        } else {
            (0.5, Anchor::Middle)
        };
        let [x, y] = frame.at(part, 0.0);
        shapes.push(text(
            [x, y + side.depth + LABEL_PT - 0.5],
            &axis.label,
            LABEL_PT,
            anchor,
            Color::INK,
        ));
    }
    shapes
}

/// Draws ticks, numbers and label at the left of a frame.
fn vertical(side: &Side, axis: &Axis, frame: Area) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for tick in &side.ticks {
        let Some(fraction) = axis.fraction(tick.value, side.range) else {
            continue;
        };
        let [x, y] = frame.at(0.0, fraction);
        shapes.push(Shape::line([[x - TICK, y], [x, y]], FRAME));
        if let Some(label) = tick.label.as_ref().filter(|_| side.has_numbers) {
            let place = [x - TICK - 1.5, y + HALF_HEIGHT * SMALL_PT];
            shapes.push(text(place, label, SMALL_PT, Anchor::End, Color::INK));
        }
    }
    if side.has_label {
        let [x, y] = frame.at(0.0, 0.5);
        let words = axis.label.clone();
        let at = [x - side.depth - 2.5, y];
        let anchor = Anchor::Middle;
        let color = Color::INK;
        shapes.push(Shape::Text(Text {
            at,
            words,
            size_pt: LABEL_PT,
            anchor,
            upright: true,
            color,
        }));
    }
    shapes
}
