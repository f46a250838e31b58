//! Net gains over airspeed: one small plot for each constrained pair, with the schedule.

use egui::Ui;

use super::gain_group::{GainEvent, GainView, gain_group_ui};
use super::gain_panel::{GainPanel, SharedRanges};
use super::message::message_ui;
use crate::view::palette::Palette;

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
