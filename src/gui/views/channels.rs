//! Channel gains over airspeed.

use egui::{Align2, FontId, Rect, Ui, pos2, vec2};

use gdcm_plot::figure::gains::{Across, GainQuantity, Measure, channels_figure, quieten};
use gdcm_plot::figure::{MarkId, all_channels};

use super::gain_plots::{GainPlots, LEAST_PLOT, bars_switch_ui, gain_command, shown_uncertainty};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::plot::figure_view::{figure_within_ui, rows};
use crate::gui::plot::{FigureScene, figure_ui};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Draws the selection of gains or delays and of airspeed or conditions, from right to left.
pub fn channels_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.gains.channel_values;
    let (mut measure, mut across) = shown;
    let axes = [
        (Across::Airspeed, "over airspeed", "With the schedule"),
        (
            Across::Conditions,
            "over conditions",
            "Conditions side by side, in file order",
        ),
    ];
    choice_ui(ui, "Horizontal axis of the channels", &mut across, &axes);
    let figures = [
        (
            Measure::Gain,
            "gains",
            "Gain k of every channel, its bounds, and 1: no correction",
        ),
        (
            Measure::Delay,
            "delays",
            "Delay τ of every channel [ms], its bounds, and 0: no correction",
        ),
    ];
    choice_ui(ui, "Figure of the channels", &mut measure, &figures);
    bars_switch_ui(ui, state, ("bars", "bars of the channels"), commands);
    if (measure, across) != shown {
        commands.push(DisplayCommand::ShowChannels(measure, across).into());
    }
}

const HEADING_HEIGHT: f32 = 20.0;
const GAP: f32 = 8.0;

/// Draws gain or delay of every channel over airspeed (Figures 3 and 4): inputs above, outputs
/// below, on the same axes.
pub fn channels_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut view = std::mem::take(&mut state.display.gains.channels);
    let plots = channel_plots(state);
    let mut inputs = plots.figure.clone();
    let mut outputs = plots.figure.clone();
    inputs.plots.truncate(state.dataset().inputs().len());
    outputs.plots.drain(..inputs.plots.len());
    let is_compact = plots.across == Across::Airspeed;
    if is_compact {
        let selected = MarkId::Condition(state.condition().id());
        [&mut inputs, &mut outputs]
            .into_iter()
            .for_each(|figure| quieten(figure, &selected, false));
    }
    if plots.figure.plots.is_empty() {
        let scene = plots.scene("channels", &plots.figure, state.results.absence());
        figure_ui(ui, &scene, &mut view.inputs, palette);
    }
    let rect = ui.available_rect_before_wrap();
    // Each half gets the height required by its rows.
    let half = vec2(rect.width(), 0.5 * rect.height());
    let [above, below] = [&inputs, &outputs].map(|figure| rows(figure, half, LEAST_PLOT) as f32);
    let (upper, lower) =
        rect.split_top_bottom_at_y(rect.top() + rect.height() * above / (above + below).max(1.0));
    for (name, rect, figure, first, view) in [
        ("Input channels", upper, &inputs, 0, &mut view.inputs),
        (
            "Output channels",
            lower,
            &outputs,
            inputs.plots.len(),
            &mut view.outputs,
        ),
    ] {
        if figure.plots.is_empty() {
            continue;
        }
        let place = pos2(rect.left() + 2.0, rect.top() + 0.5 * HEADING_HEIGHT);
        ui.painter().text(
            place,
            Align2::LEFT_CENTER,
            name,
            FontId::proportional(SMALL_SIZE),
            palette.dim_text,
        );
        let inner = Rect::from_min_max(
            rect.min + vec2(0.0, HEADING_HEIGHT),
            rect.max - vec2(0.0, GAP),
        );
        let scene = plots.scene(name, figure, state.results.absence());
        let scene = FigureScene {
            is_compact,
            words: &plots,
            first_plot: first,
            ..scene
        };
        let events = figure_within_ui(ui, inner, &scene, view, palette);
        commands.extend(
            events
                .into_iter()
                .filter_map(|event| gain_command(state, event)),
        );
    }
    ui.advance_cursor_after_rect(rect);
    state.display.gains.channels = view;
}

/// Builds a plot for each channel, inputs first: gain or delay in each condition's optimum, and the
/// schedule.
pub fn channel_plots(state: &State) -> GainPlots<'_> {
    let (measure, across) = state.display.gains.channel_values;
    let channels = if state.analysis().is_some() {
        all_channels(state.dataset())
    } else {
        Vec::new()
    };
    let figure = state
        .analysis()
        .map(|analysis| {
            channels_figure(
                analysis,
                shown_uncertainty(state),
                &channels,
                (measure, across),
            )
        })
        .unwrap_or_default();
    let quantities = channels
        .into_iter()
        .map(|channel| GainQuantity::of_channel(channel, measure))
        .collect();
    GainPlots {
        state,
        figure: figure.with_ranges(),
        quantities,
        across,
    }
}
