//! Channel gains against airspeed.

use egui::Ui;

use crate::view::command::Command;
use crate::view::net_gain_scene::channel_panels;
use crate::view::palette::Palette;
use crate::view::plot::{Across, ChannelsScene, Measure, channels_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

use super::net_gain::{bars_switch_ui, gain_command};

/// Gains or delays, over airspeed or over conditions. Laid out from right to left.
pub fn channels_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.channel_figure;
    let (mut measure, mut across) = shown;
    let axes = [
        (Across::Airspeed, "over airspeed", "With the schedule"),
        (Across::Conditions, "over conditions", "Conditions side by side, in file order"),
    ];
    choice_ui(ui, "Horizontal axis of the channels", &mut across, &axes);
    let figures = [
        (Measure::Gain, "gains", "Gain k of every channel, its bounds, and 1: no correction"),
        (Measure::Delay, "delays", "Delay τ of every channel [ms], its bounds, and 0: no correction"),
    ];
    choice_ui(ui, "Figure of the channels", &mut measure, &figures);
    bars_switch_ui(ui, state, "bars of the channels", commands);
    if (measure, across) != shown {
        commands.push(Command::ShowChannels(measure, across));
    }
}

/// Gain or delay of every channel against airspeed (Figures 3 and 4).
pub fn channels_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let (measure, across) = state.display.channel_figure;
    let (inputs, outputs) = channel_panels(state, measure, across);
    let scene = ChannelsScene { inputs: &inputs, outputs: &outputs, message: Some(state.results.absence()) };
    let events = channels_ui(ui, &scene, &mut state.display.channels, palette);
    commands.extend(events.into_iter().filter_map(|event| gain_command(state, event)));
}
