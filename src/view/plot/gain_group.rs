//! A group of small plots of gains over airspeed, with ranges in common: net gains of pairs, or gains of channels.

use egui::{Align2, FontId, Pos2, Rect, RichText, Ui, UiBuilder, Vec2, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform};
use gdcm_core::dataset::ConditionId;
use gdcm_core::study::ExplainTarget;

use super::axes::{caption_font, message_ui, use_frame_colors};
use super::curve_menu::Questions;
use super::dot::{Dot, PlacedLabels};
use super::gain_panel::{GainPanel, Measure, PanelAnswer, SharedRanges, gain_panel_ui};
use super::readout::tooltip_ui;
use super::tiles::{Tiles, tiles_ui};
use crate::view::palette::{Palette, SMALL_SIZE};

/// Width of the strip at the left with the label of the gain axes \[pt\].
const LABEL_STRIP: f32 = 16.0;
/// A panel is never smaller \[pt\].
const LEAST_PANEL: Vec2 = vec2(122.0, 120.0);

/// What the engineer did in the plots of gains over airspeed.
#[derive(Clone, Debug, PartialEq)]
pub enum GainEvent {
    /// The pointer came to mean another condition, or none.
    ConditionHovered(Option<ConditionId>),
    /// A condition's dot was clicked.
    ConditionClicked(ConditionId),
    /// A condition's dot was clicked with the key for commands held: into the schedule, or out of it.
    ScheduleToggled(ConditionId),
    /// How a figure was computed is asked.
    Asked(ExplainTarget),
}

/// What the plots of gains over airspeed remember between frames.
#[derive(Clone, Debug, Default)]
pub struct GainView {
    hovered: Option<ConditionId>,
    highlighted: Option<ConditionId>,
    transforms: Vec<Option<PlotTransform>>,
    dots: Vec<Vec<(ConditionId, [f64; 2])>>,
    labels: Vec<PlacedLabels>,
    questions: Questions,
}

impl GainView {
    /// The condition under the pointer.
    pub fn hovered(&self) -> Option<ConditionId> {
        self.hovered
    }

    /// Emphasises a condition that another view points at.
    pub fn highlight(&mut self, condition: Option<ConditionId>) {
        self.highlighted = condition;
    }

    /// Whether a number has no room and is only told where its dot is pointed at.
    pub fn leaves_numbers_out(&self) -> bool {
        self.labels.iter().any(PlacedLabels::leaves_some_out)
    }

    fn emphasized(&self) -> Option<ConditionId> {
        self.hovered.or(self.highlighted)
    }

    /// Where a panel was drawn last: x as its [`super::Across`] says, y as its [`super::Measure`] does.
    pub fn transform(&self, panel: usize) -> Option<&PlotTransform> {
        self.transforms.get(panel)?.as_ref()
    }

    /// Where the dot of a condition is on the screen.
    pub fn screen_position(&self, panel: usize, condition: ConditionId) -> Option<Pos2> {
        let (_, [x, value]) = self.dots.get(panel)?.iter().find(|(id, _)| *id == condition)?;
        Some(self.transform(panel)?.position_from_point(&PlotPoint::new(*x, *value)))
    }

    fn remember(&mut self, index: usize, panel: &GainPanel, answer: &PanelAnswer) {
        if let Some(transform) = self.transforms.get_mut(index) {
            *transform = Some(answer.transform);
        }
        if let Some(dots) = self.dots.get_mut(index) {
            *dots = panel.dots.iter().map(|dot| (dot.condition, [dot.x, dot.value])).collect();
        }
    }
}

/// How many rows `count` panels take in an area of `size`.
pub(super) fn group_rows(count: usize, size: Vec2) -> usize {
    Tiles::arrange(count, size - vec2(LABEL_STRIP, 0.0), LEAST_PANEL).rows
}

/// Draws `panels` into `rect` and reports what was done in them.
pub(super) fn gain_group_ui(
    ui: &mut Ui,
    (name, rect): (&str, Rect),
    panels: &[GainPanel],
    (ranges, gain_label): (SharedRanges, &str),
    view: &mut GainView,
    palette: &Palette,
) -> Vec<GainEvent> {
    let mut events = Vec::new();
    view.transforms.resize(panels.len(), None);
    view.dots.resize(panels.len(), Vec::new());
    view.labels.resize(panels.len(), PlacedLabels::default());
    ui.scope_builder(UiBuilder::new().id_salt(name).max_rect(rect), |ui| {
        use_frame_colors(ui, palette);
        gain_label_ui(ui, rect, gain_label, palette);
        let inner = Rect::from_min_max(rect.min + vec2(LABEL_STRIP, 0.0), rect.max);
        let mut hovered = None;
        tiles_ui(ui, "panels", inner, panels.len(), LEAST_PANEL, |ui, index, rect| {
            let panel = &panels[index];
            let id = ui.make_persistent_id((name, index));
            let remembered = (view.emphasized(), &mut view.labels[index]);
            let answer = gain_panel_ui(ui, (id, rect), panel, ranges, remembered, palette);
            view.remember(index, panel, &answer);
            hovered = hovered.or(answer.hovered);
            events.extend(panel_events(panel, answer, &mut view.questions, palette));
        });
        if view.hovered != hovered {
            view.hovered = hovered;
            events.push(GainEvent::ConditionHovered(hovered));
            ui.ctx().request_repaint();
        }
    });
    events
}

fn panel_events(
    panel: &GainPanel,
    answer: PanelAnswer,
    questions: &mut Questions,
    palette: &Palette,
) -> impl Iterator<Item = GainEvent> {
    let pointed = panel.dots.iter().find(|dot| answer.hovered == Some(dot.condition));
    let asked = questions.ui(&answer.response, pointed.map_or(&[], |dot| &dot.figures));
    if let Some(dot) = pointed {
        dot_tooltip_ui(&answer, panel, dot, palette);
        answer.response.on_hover_cursor(egui::CursorIcon::PointingHand);
    }
    let clicked = answer.clicked.map(|(condition, with_command)| match with_command {
        true => GainEvent::ScheduleToggled(condition),
        false => GainEvent::ConditionClicked(condition),
    });
    clicked.into_iter().chain(asked.map(GainEvent::Asked))
}

fn dot_tooltip_ui(answer: &PanelAnswer, panel: &GainPanel, dot: &Dot, palette: &Palette) {
    tooltip_ui(&answer.response, |ui| {
        let dim = |text: String| RichText::new(text).size(SMALL_SIZE).color(palette.dim_text);
        ui.label(dim(format!("condition {} · {:.0} kt", dot.label, dot.airspeed_kt)));
        let scheduled = match panel.scheduled(dot.x) {
            Some(value) => format!(" · scheduled {}", panel.measure.text(value)),
            None => String::new(),
        };
        ui.label(format!("{} {}{scheduled}", panel.title, panel.measure.text(dot.value)));
        if let Some([lower, upper]) = dot.bounds {
            ui.label(dim(format!("bounds {} to {}", panel.measure.text(lower), panel.measure.text(upper))));
        }
        if dot.held_out {
            ui.label(dim("held out of the schedule, to judge it".to_owned()));
        } else if !dot.chosen {
            ui.label(dim("not in the schedule".to_owned()));
        }
        for sentence in &dot.sentences {
            ui.label(RichText::new(sentence).size(SMALL_SIZE));
        }
        if !dot.detail.is_empty() {
            ui.label(dim(dot.detail.clone()));
        }
        ui.label(dim(
            "click: show the condition · Ctrl+click: into the schedule, or out of it · secondary click: ask".to_owned()
        ));
    });
}

/// The label of all the gain axes, upright at the left edge.
fn gain_label_ui(ui: &Ui, rect: Rect, label: &str, palette: &Palette) {
    let galley = ui.painter().layout_no_wrap(label.to_owned(), FontId::proportional(SMALL_SIZE), palette.dim_text);
    let place = pos2(rect.left() + 1.0, rect.center().y + 0.5 * galley.size().x);
    let text = egui::epaint::TextShape::new(place, galley, palette.dim_text);
    ui.painter().add(text.with_angle(-std::f32::consts::FRAC_PI_2));
}

/// What the plots of net gain show.
#[derive(Clone, Copy, Debug)]
pub struct NetGainScene<'a> {
    /// One panel for each pair.
    pub panels: &'a [GainPanel],
    /// What to say where there is nothing to draw.
    pub message: Option<&'a str>,
}

/// Draws the plots of net gain into the space that is left in `ui`.
pub fn net_gain_ui(ui: &mut Ui, scene: &NetGainScene<'_>, view: &mut GainView, palette: &Palette) -> Vec<GainEvent> {
    let rect = ui.available_rect_before_wrap();
    let Some(ranges) = SharedRanges::of(scene.panels) else {
        message_ui(ui, rect, scene.message.unwrap_or("Nothing to draw"), palette);
        return Vec::new();
    };
    let events = gain_group_ui(ui, ("net gain", rect), scene.panels, (ranges, "Net gain [-]"), view, palette);
    ui.advance_cursor_after_rect(rect);
    events
}

const HEADING_HEIGHT: f32 = 20.0;
const GAP: f32 = 8.0;

/// What the plots of channel gains show.
#[derive(Clone, Copy, Debug)]
pub struct ChannelsScene<'a> {
    /// One panel for each input channel.
    pub inputs: &'a [GainPanel],
    /// One panel for each output channel.
    pub outputs: &'a [GainPanel],
    /// What to say where there is nothing to draw.
    pub message: Option<&'a str>,
}

/// What the plots of channel gains remember between frames.
#[derive(Clone, Debug, Default)]
pub struct ChannelsView {
    /// Of the input channels.
    pub inputs: GainView,
    /// Of the output channels.
    pub outputs: GainView,
}

/// Draws the plots of channel gains into the space that is left in `ui`: inputs above, outputs below.
pub fn channels_ui(
    ui: &mut Ui,
    scene: &ChannelsScene<'_>,
    view: &mut ChannelsView,
    palette: &Palette,
) -> Vec<GainEvent> {
    let rect = ui.available_rect_before_wrap();
    let both = [SharedRanges::of(scene.inputs), SharedRanges::of(scene.outputs)];
    let Some(ranges) = both.into_iter().flatten().reduce(SharedRanges::union) else {
        message_ui(ui, rect, scene.message.unwrap_or("Nothing to draw"), palette);
        return Vec::new();
    };
    let middle = rect.top() + rect.height() * inputs_part(scene, rect.size());
    let (upper, lower) = rect.split_top_bottom_at_y(middle);
    let groups = [
        ("Input channels", upper, scene.inputs, &mut view.inputs),
        ("Output channels", lower, scene.outputs, &mut view.outputs),
    ];
    let label = match scene.inputs.iter().chain(scene.outputs).next().map(|panel| panel.measure) {
        Some(Measure::Delay) => "Delay [ms]",
        _ => "Gain [-]",
    };
    let mut events = Vec::new();
    for (name, rect, panels, view) in groups.into_iter().filter(|(_, _, panels, _)| !panels.is_empty()) {
        let place = pos2(rect.left() + 2.0, rect.top() + 0.5 * HEADING_HEIGHT);
        ui.painter().text(place, Align2::LEFT_CENTER, name, caption_font(), palette.dim_text);
        let rect = Rect::from_min_max(rect.min + vec2(0.0, HEADING_HEIGHT), rect.max - vec2(0.0, GAP));
        events.extend(gain_group_ui(ui, (name, rect), panels, (ranges, label), view, palette));
    }
    ui.advance_cursor_after_rect(rect);
    events
}

/// Part of the height that the inputs get: as much as their rows need beside those of the outputs.
fn inputs_part(scene: &ChannelsScene<'_>, size: Vec2) -> f32 {
    let half = vec2(size.x, 0.5 * size.y);
    let [inputs, outputs] = [scene.inputs, scene.outputs].map(|panels| match panels.len() {
        0 => 0.0,
        count => group_rows(count, half) as f32,
    });
    inputs / (inputs + outputs).max(1.0)
}
