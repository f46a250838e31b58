//! What a correction is worth: the change of J, one bar for each condition or pair.

use egui::{Align2, Pos2, Rect, RichText, Stroke, Ui, UiBuilder, Vec2, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform};

use gdcm_core::dataset::ConditionId;
use gdcm_core::study::ExplainTarget;

use super::axes::{caption_font, use_frame_colors};
use super::bar::{AssessmentBar, AssessmentPanel, BarValue};
use super::bar_panel::{BarAnswer, PHASE_FADE, bar_panel_ui};
use super::message::message_ui;
use super::number::decimals;
use super::questions::Questions;
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
