//! What a correction is worth: the change of J, one bar for each condition or pair.

use egui::{
    Align2, Color32, FontId, Id, Painter, Pos2, Rect, Response, RichText, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    Vec2, WidgetInfo, pos2, vec2,
};
use egui_plot::{Axis, GridInput, GridMark, HLine, Plot, PlotBounds, PlotPoint, PlotTransform};
use gdcm_core::dataset::ConditionId;
use gdcm_core::study::ExplainTarget;
use gdcm_files::figure::{Range, decimals};

use super::axes::{
    LABELLED_HEIGHT, Ladder, axis_hints, caption_font, labelled_mark, message_ui, quiet_plot, tick_font, tick_text,
    use_frame_colors,
};
use super::curve_menu::{NamedFigure, Questions};
use super::readout::tooltip_ui;
use super::tiles::tiles_ui;
use crate::view::palette::{Palette, SMALL_SIZE};

const KEY_HEIGHT: f32 = 20.0;
/// A panel is never smaller \[pt\].
const LEAST_PANEL: Vec2 = vec2(190.0, 150.0);

/// What the assessment shows.
#[derive(Clone, Copy, Debug)]
pub struct AssessmentScene<'a> {
    /// One panel for each pair, with a bar for each condition.
    pub panels: &'a [AssessmentPanel],
    /// What to say where there is nothing to draw.
    pub message: Option<&'a str>,
}

/// What the engineer did in the assessment.
#[derive(Clone, Debug, PartialEq)]
pub enum AssessmentEvent {
    /// A bar was clicked.
    BarClicked {
        /// Index of its panel.
        panel: usize,
        /// Its condition.
        condition: ConditionId,
    },
    /// How a figure was computed is asked.
    Asked(ExplainTarget),
}

/// What the assessment remembers between frames.
#[derive(Clone, Debug, Default)]
pub struct AssessmentView {
    panels: Vec<(Option<PlotTransform>, Vec<ConditionId>)>,
    questions: Questions,
}

impl AssessmentView {
    /// Where a panel was drawn last: x counts bars from 0, y is the change of J.
    pub fn transform(&self, panel: usize) -> Option<&PlotTransform> {
        self.panels.get(panel)?.0.as_ref()
    }

    /// Where the foot of a bar is on the screen.
    pub fn screen_position(&self, panel: usize, condition: ConditionId) -> Option<Pos2> {
        let index = self.panels.get(panel)?.1.iter().position(|known| *known == condition)?;
        Some(self.transform(panel)?.position_from_point(&PlotPoint::new(index as f64, 0.0)))
    }
}

/// Draws the assessment into the space that is left in `ui`.
pub fn assessment_ui(
    ui: &mut Ui,
    scene: &AssessmentScene<'_>,
    view: &mut AssessmentView,
    palette: &Palette,
) -> Vec<AssessmentEvent> {
    let rect = ui.available_rect_before_wrap();
    if scene.panels.iter().all(|panel| panel.bars.is_empty()) {
        message_ui(ui, rect, scene.message.unwrap_or("Nothing to draw"), palette);
        return Vec::new();
    }
    view.panels.resize(scene.panels.len(), (None, Vec::new()));
    let mut events = Vec::new();
    ui.scope_builder(UiBuilder::new().id_salt("assessment").max_rect(rect), |ui| {
        use_frame_colors(ui, palette);
        key_ui(ui, rect, palette);
        let inner = Rect::from_min_max(rect.min + vec2(0.0, KEY_HEIGHT), rect.max);
        tiles_ui(ui, "panels", inner, scene.panels.len(), LEAST_PANEL, |ui, index, rect| {
            let panel = &scene.panels[index];
            let answer = bar_panel_ui(ui, (ui.make_persistent_id(("assessment", index)), rect), panel, palette);
            view.panels[index] = (Some(answer.transform), panel.bars.iter().map(|bar| bar.condition).collect());
            let pointed = answer.hovered.and_then(|bar| panel.bars.get(bar));
            let asked = view.questions.ui(&answer.response, pointed.map_or(&[], |bar| &bar.figures));
            events.extend(asked.map(AssessmentEvent::Asked));
            events.extend(panel_event(index, panel, &answer, palette));
        });
    });
    ui.advance_cursor_after_rect(rect);
    events
}

fn panel_event(
    index: usize,
    panel: &AssessmentPanel,
    answer: &BarAnswer,
    palette: &Palette,
) -> Option<AssessmentEvent> {
    let bar = panel.bars.get(answer.hovered?)?;
    tooltip_ui(&answer.response, |ui| bar_text_ui(ui, panel, bar, palette));
    answer.response.clicked().then_some(AssessmentEvent::BarClicked { panel: index, condition: bar.condition })
}

fn bar_text_ui(ui: &mut Ui, panel: &AssessmentPanel, bar: &AssessmentBar, palette: &Palette) {
    let dim = |text: &str| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
    ui.label(dim(&format!("{} · {} {}", panel.title, panel.axis_label.to_lowercase(), bar.label)));
    match &bar.value {
        BarValue::Change { magnitude, phase } => {
            ui.label(format!("ΔJ {}", decimals(magnitude + phase, 1)));
            ui.label(dim(&format!("magnitude {} · phase {}", decimals(*magnitude, 1), decimals(*phase, 1))));
        }
        BarValue::LeftOut { why } => {
            ui.label(format!("left out: {why}"));
        }
    }
    if !bar.detail.is_empty() {
        ui.label(dim(&bar.detail));
    }
}

/// What the bars mean, at the upper right.
fn key_ui(ui: &Ui, rect: Rect, palette: &Palette) {
    let painter = ui.painter();
    let mut right = rect.right() - 10.0;
    let y = rect.top() + 0.5 * KEY_HEIGHT;
    let mut write = |text: &str| {
        let place = painter.text(pos2(right, y), Align2::RIGHT_CENTER, text, caption_font(), palette.dim_text);
        let sample = Rect::from_center_size(pos2(place.left() - 11.0, y), vec2(12.0, 10.0));
        right = sample.left() - 14.0;
        sample
    };
    let worse = write("worse");
    painter.rect_filled(worse, 1.0, palette.warning);
    let better = write("better");
    painter.rect_filled(better, 1.0, palette.good);
    let total = write("ΔJ");
    painter.hline(total.x_range(), y, Stroke::new(2.0, palette.text));
    let phase = write("ΔJ phase");
    painter.rect_filled(phase, 1.0, palette.dim_text.gamma_multiply(PHASE_FADE));
    let magnitude = write("ΔJ magnitude");
    painter.rect_filled(magnitude, 1.0, palette.dim_text);
}

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

/// How much fainter the phase part of a bar is.
pub(super) const PHASE_FADE: f32 = 0.45;
const TITLE_HEIGHT: f32 = 18.0;
const VALUE_AXIS_WIDTH: f32 = 40.0;
const RIGHT_MARGIN: f32 = 8.0;
const TICK_GAP: f64 = 26.0;
/// Part of the distance between bars that a bar fills.
const BAR_PART: f32 = 0.6;
const VALUE_FONT: FontId = FontId::proportional(10.0);
/// Bars narrower than this have no number \[pt\].
const LEAST_WITH_NUMBER: f32 = 26.0;

/// What a panel found out in a frame.
pub(super) struct BarAnswer {
    pub(super) response: Response,
    pub(super) transform: PlotTransform,
    /// Index of the bar under the pointer.
    pub(super) hovered: Option<usize>,
}

/// Draws a panel into `rect`.
pub(super) fn bar_panel_ui(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    panel: &AssessmentPanel,
    palette: &Palette,
) -> BarAnswer {
    let plot_rect = Rect::from_min_max(rect.min + vec2(0.0, TITLE_HEIGHT), rect.max - vec2(RIGHT_MARGIN, 0.0));
    let (response, transform) = frame_ui(ui, (id, plot_rect), panel, palette);
    let frame = *transform.frame();
    let title_place = pos2(frame.center().x, rect.top() + 0.5 * TITLE_HEIGHT);
    ui.painter().text(title_place, Align2::CENTER_CENTER, &panel.title, caption_font(), palette.text);
    let hovered = response.hover_pos().and_then(|pointer| bar_at(panel, &transform, pointer));
    let painter = ui.painter().with_clip_rect(frame.intersect(ui.clip_rect()));
    for (index, bar) in panel.bars.iter().enumerate() {
        let slot = slot(&transform, index);
        if bar.selected || hovered == Some(index) {
            let strength = if bar.selected { 0.6 } else { 0.35 };
            painter.rect_filled(slot, 0.0, palette.selected.gamma_multiply(strength));
        }
        match &bar.value {
            BarValue::Change { magnitude, phase } => {
                paint_change(&painter, slot, &transform, (*magnitude, *phase), palette)
            }
            BarValue::LeftOut { .. } => paint_left_out(&painter, slot, palette),
        }
    }
    BarAnswer { response, transform, hovered }
}

fn frame_ui(
    ui: &mut Ui,
    (id, rect): (Id, Rect),
    panel: &AssessmentPanel,
    palette: &Palette,
) -> (Response, PlotTransform) {
    let values = panel.values();
    let bounds = PlotBounds::from_min_max([-0.5, values.min], [panel.bars.len() as f64 - 0.5, values.max]);
    let widest = panel.bars.iter().map(|bar| text_width(ui, &bar.label)).fold(0.0, f32::max);
    let plot = bar_plot((id, rect.size()), panel, widest, palette);
    let shown = ui.scope_builder(UiBuilder::new().id_salt(id).max_rect(rect), |ui| {
        plot.show(ui, |plot| {
            plot.set_plot_bounds(bounds);
            plot.hline(HLine::new("", 0.0).color(palette.dim_text).width(1.0));
        })
    });
    let response = shown.inner.response;
    let description = format!("Change of J, {}: {}", panel.title, in_words(panel));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, description.clone()));
    (response, shown.inner.transform)
}

fn bar_plot<'a>((id, size): (Id, Vec2), panel: &AssessmentPanel, widest: f32, palette: &Palette) -> Plot<'a> {
    let count = panel.bars.len();
    let labels: Vec<String> = panel.bars.iter().map(|bar| bar.label.clone()).collect();
    let label = move |mark: GridMark| labels.get(mark.value.round() as usize).cloned().unwrap_or_default();
    quiet_plot(id, palette)
        .sense(Sense::click())
        .width(size.x)
        .height(size.y)
        .show_grid([false, true])
        .x_grid_spacer(move |input| bar_marks(&input, count, widest))
        .y_grid_spacer(Ladder::Decimal.spacer(TICK_GAP))
        .custom_x_axes(vec![axis_hints(Axis::X, &panel.axis_label, LABELLED_HEIGHT, palette, label)])
        .custom_y_axes(vec![axis_hints(Axis::Y, "", VALUE_AXIS_WIDTH, palette, tick_text)])
}

/// One mark under each bar; where the labels are too wide, under every second, third … one.
fn bar_marks(input: &GridInput, count: usize, widest: f32) -> Vec<GridMark> {
    /// Least space between two labels \[pt\].
    const SPACE: f64 = 6.0;
    let every = ((f64::from(widest) + SPACE) * input.base_step_size).ceil().max(1.0);
    (0..count).step_by(every as usize).map(|index| labelled_mark(index as f64, input.base_step_size)).collect()
}

fn text_width(ui: &Ui, text: &str) -> f32 {
    ui.painter().layout_no_wrap(text.to_owned(), tick_font(), Color32::PLACEHOLDER).size().x
}

fn in_words(panel: &AssessmentPanel) -> String {
    let text = |bar: &AssessmentBar| match bar.value {
        BarValue::Change { magnitude, phase } => format!("{} {}", bar.label, decimals(magnitude + phase, 1)),
        BarValue::LeftOut { .. } => format!("{} left out", bar.label),
    };
    panel.bars.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// The column of the plot that belongs to a bar.
fn slot(transform: &PlotTransform, index: usize) -> Rect {
    let x = |offset: f64| transform.position_from_point_x(index as f64 + offset);
    Rect::from_x_y_ranges(x(-0.5)..=x(0.5), transform.frame().y_range())
}

fn bar_at(panel: &AssessmentPanel, transform: &PlotTransform, pointer: Pos2) -> Option<usize> {
    let index = transform.value_from_position(pointer).x.round();
    (index >= 0.0 && (index as usize) < panel.bars.len()).then_some(index as usize)
}

fn paint_change(
    painter: &Painter,
    slot: Rect,
    transform: &PlotTransform,
    (magnitude, phase): (f64, f64),
    palette: &Palette,
) {
    let total = magnitude + phase;
    if !total.is_finite() {
        return;
    }
    let color = |change: f64| if change > 0.0 { palette.warning } else { palette.good };
    let y = |value: f64| transform.position_from_point_y(value);
    let half = 0.5 * BAR_PART * slot.width();
    let columns = slot.center().x - half..=slot.center().x + half;
    let [of_magnitude, of_phase] = stacked(magnitude, phase);
    let part = |[from, to]: [f64; 2]| Rect::from_x_y_ranges(columns.clone(), y(from).min(y(to))..=y(from).max(y(to)));
    painter.rect_filled(part(of_magnitude), 0.0, color(magnitude));
    let faint = color(phase).gamma_multiply(PHASE_FADE);
    painter.rect(part(of_phase), 0.0, faint, Stroke::new(1.0, color(phase).gamma_multiply(0.7)), StrokeKind::Inside);
    let overhang = 0.08 * slot.width();
    let mark = columns.start() - overhang..=columns.end() + overhang;
    painter.hline(mark, y(total), Stroke::new(2.0, palette.text));
    if slot.width() >= LEAST_WITH_NUMBER {
        let ends = [of_magnitude[1], of_phase[1], 0.0];
        let count = if total.abs() < 9.95 { 1 } else { 0 };
        let (align, end, offset) = if total > 0.0 {
            (Align2::CENTER_BOTTOM, ends.into_iter().fold(0.0, f64::max), -3.0)
        } else {
            (Align2::CENTER_TOP, ends.into_iter().fold(0.0, f64::min), 3.0)
        };
        let place = pos2(slot.center().x, y(end) + offset);
        painter.text(place, align, decimals(total, count), VALUE_FONT, palette.dim_text);
    }
}

fn paint_left_out(painter: &Painter, slot: Rect, palette: &Palette) {
    painter.rect_filled(slot.shrink2(vec2(0.15 * slot.width(), 0.0)), 0.0, palette.rejected.gamma_multiply(0.13));
    let galley = painter.layout_no_wrap("left out".to_owned(), VALUE_FONT, palette.dim_text);
    if galley.size().y > slot.width() || galley.size().x > slot.height() {
        return;
    }
    let corner = slot.center() + vec2(-0.5 * galley.size().y, 0.5 * galley.size().x);
    let text = egui::epaint::TextShape::new(corner, galley, palette.dim_text);
    painter.add(text.with_angle(-std::f32::consts::FRAC_PI_2));
}

#[cfg(test)]
mod tests {
    use super::super::assessment::*;

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

#[cfg(test)]
mod tests2 {
    use super::super::assessment::*;

    #[test]
    fn wide_labels_are_thinned_until_they_fit() {
        // Eleven bars on 110 points: 10 points each.
        let input = GridInput { bounds: (-0.5, 10.5), base_step_size: 0.1 };
        assert_eq!(bar_marks(&input, 11, 4.0).len(), 11);
        assert_eq!(bar_marks(&input, 11, 12.0).len(), 6);
        assert_eq!(bar_marks(&input, 11, 30.0).len(), 3);
    }
}
