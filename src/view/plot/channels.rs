//! Gains or delays of the channels: one small plot for each input and each output, with the schedule.

use egui::{Align2, Rect, Ui, Vec2, pos2, vec2};

use super::axes::caption_font;
use super::gain_group::{GainEvent, GainView, gain_group_ui, group_rows};
use super::gain_panel::{GainPanel, Measure, SharedRanges};
use super::message::message_ui;
use crate::view::palette::Palette;

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
