//! Labelled lines across a pane: what a figure of the fit is at every frequency.

use egui::{Align2, FontId, Rect, Ui, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform};

use super::curve::Pane;
use super::line_look::{LineLook, LinePattern};
use crate::view::palette::Palette;

/// How a figure depends on the frequency.
#[derive(Clone, Debug, PartialEq)]
pub enum Level {
    /// It is this everywhere.
    Constant(f64),
    /// It is this times omega \[rad/s\]: what a delay takes from the phase.
    PerOmega(f64),
    /// It is what it is at each of these frequencies: omega \[rad/s\], rising, and value.
    Sampled(Vec<[f64; 2]>),
}

impl Level {
    /// The points of the line between two frequencies: `log10 omega` and value.
    fn points(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let log_omega = (0..=POINTS).map(|point| from + (to - from) * point as f64 / POINTS as f64);
        match self {
            Self::Constant(value) => vec![[from, *value], [to, *value]],
            Self::PerOmega(slope) => log_omega.map(|x| [x, slope * 10f64.powf(x)]).collect(),
            Self::Sampled(points) => points.iter().map(|[omega, value]| [omega.log10(), *value]).collect(),
        }
    }
}

/// What a rule stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RuleKind {
    /// What the fit asks for: G, D.
    Delta,
    /// A bound of the channels: LB, UB.
    Bound,
    /// A quantile over the band.
    Quantile,
    /// What a pilot does not notice.
    Envelope,
}

impl RuleKind {
    fn look(self, palette: &Palette) -> LineLook {
        let (color, width, pattern) = match self {
            Self::Delta => (palette.text, 0.9, LinePattern::Dotted { spacing: 4.0 }),
            Self::Bound => (palette.warning, 1.0, LinePattern::DashDotted { length: 9.0 }),
            Self::Quantile => (palette.dim_text, 0.9, LinePattern::Dashed { length: 3.0 }),
            Self::Envelope => (palette.good, 1.0, LinePattern::Solid),
        };
        LineLook { color, width: width * palette.line_width, pattern }
    }
}

/// A labelled line across a pane.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// The pane it lies in.
    pub pane: Pane,
    /// What it stands for.
    pub kind: RuleKind,
    /// What stands on it: "G 0.83 (−1.7 dB)".
    pub label: String,
    /// Where it lies.
    pub level: Level,
}

/// Points of a rule that is no straight line.
const POINTS: usize = 80;
/// Font of the labels.
const FONT: FontId = FontId::proportional(10.5);
/// Least distance between two labels \[pt\].
const LABEL_GAP: f32 = 12.0;

/// Draws the rules of a pane into the plot that was drawn as `transform` says, with their labels at the left, below one another where
/// the lines are close.
pub(super) fn rules_ui(ui: &Ui, rules: &[Rule], pane: Pane, transform: &PlotTransform, palette: &Palette) {
    let frame = *transform.frame();
    let painter = ui.painter().with_clip_rect(frame.shrink(1.0));
    let mut shapes = Vec::new();
    let mut labels = Vec::new();
    for rule in rules.iter().filter(|rule| rule.pane == pane) {
        let path = path(&rule.level, transform);
        let left = frame.left() + LABEL_LEFT;
        let at = path.iter().find(|at| at.x >= left).or(path.first());
        let look = rule.kind.look(palette);
        if let Some(at) = at.filter(|at| frame.y_range().contains(at.y)) {
            labels.push((at.y, rule.label.as_str(), look.color));
        }
        look.add_shapes(path, &mut shapes);
    }
    painter.extend(shapes);
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut free = frame.top();
    for (y, label, color) in labels {
        let galley = painter.layout_no_wrap(label.to_owned(), FONT, color);
        let bottom = (y - 1.0).max(free + LABEL_GAP).min(frame.bottom());
        free = bottom;
        let place: Rect = Align2::LEFT_BOTTOM.anchor_size(pos2(frame.left() + LABEL_LEFT, bottom), galley.size());
        painter.rect_filled(place.expand(1.0), 2.0, palette.background.gamma_multiply(0.75));
        painter.galley(place.min, galley, color);
    }
}

/// Distance of the labels from the left edge \[pt\].
const LABEL_LEFT: f32 = 8.0;

fn path(level: &Level, transform: &PlotTransform) -> Vec<egui::Pos2> {
    let points = level.points(transform.bounds().min()[0], transform.bounds().max()[0]);
    let position = |[x, y]: [f64; 2]| transform.position_from_point(&PlotPoint::new(x, y));
    // Far outside the frame a line is not drawn; so long a way in dashes would take its time.
    let frame = transform.frame();
    let is_near = |at: &egui::Pos2| (at.y - frame.center().y).abs() < 2.0 * frame.height();
    points.into_iter().map(position).filter(is_near).collect()
}

/// Draws the frequencies of `ranges` \[rad/s\] as strips along the lower edge of a plot.
pub(super) fn strips_ui(ui: &Ui, ranges: &[(f64, f64)], transform: &PlotTransform, palette: &Palette) {
    let frame = *transform.frame();
    let x = |omega: f64| transform.position_from_point_x(omega.log10());
    for (from, to) in ranges {
        let strip = Rect::from_x_y_ranges(x(*from)..=x(*to), frame.bottom() - STRIP_HEIGHT..=frame.bottom());
        ui.painter().with_clip_rect(frame).rect_filled(strip.shrink2(vec2(0.0, 1.0)), 0.0, palette.warning);
    }
}

/// Height of a strip along the lower edge \[pt\].
const STRIP_HEIGHT: f32 = 5.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_takes_phase_in_proportion_to_frequency() {
        assert_eq!(Level::Constant(3.0).points(0.0, 1.0), [[0.0, 3.0], [1.0, 3.0]]);
        let points = Level::PerOmega(-2.0).points(0.0, 1.0);
        assert_eq!((points[0], points[POINTS]), ([0.0, -2.0], [1.0, -20.0]));
        assert_eq!(Level::Sampled(vec![[100.0, 5.0]]).points(0.0, 1.0), [[2.0, 5.0]]);
    }
}
