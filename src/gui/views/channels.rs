//! Channels view: each channel's gain or delay over airspeed or over the conditions, inputs above
//! outputs.

use egui::{Align2, FontId, Rect, Ui, pos2, vec2};

use gdcm_plot::figure::gains::{Across, GainAxes, GainQuantity, Measure, channels_figure};
use gdcm_plot::figure::gains_on_screen::{
    add_previous, label_selected_only, reserve_room_for_bars,
};
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::{Figure, all_channels};

use super::PageEntry;
use super::axis_updates::axis_update;
use super::error_bars::{dim_older_bars, error_bars_switch_ui, painted_uncertainty};
use super::gain_plots::{GainPlots, LEAST_PLOT, gain_command};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::plot::figure_view::{figure_within_ui, rows};
use crate::gui::plot::{FigureScene, FigureView, figure_ui};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::{PageOption, PageWords};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Height for the headings "Input channels" and "Output channels" \[pt\].
const HEADING_HEIGHT: f32 = 20.0;
/// Gap below the inputs and below the outputs \[pt\].
const GAP: f32 = 8.0;
/// Whether significant differences are marked: not here, only in the net-gain view.
const SHOWS_DIFFERENCES: bool = false;

pub fn channels_pages(state: &State) -> Vec<PageEntry> {
    let (shown, across) = state.display.gains.channel_values;
    let pages = [
        (
            Measure::Gain,
            "Gains",
            "Gain k with its bounds; 1: no correction",
        ),
        (
            Measure::Delay,
            "Delays",
            "Delay τ [ms] with its bounds; 0: no correction",
        ),
    ];
    let mut entries = Vec::new();
    for (measure, name, purpose) in pages {
        entries.push(PageEntry {
            words: PageWords {
                name,
                short_name: name,
                purpose,
            },
            is_shown: measure == shown,
            command: DisplayCommand::ShowChannels(measure, across).into(),
        });
    }
    entries
}

/// Draws the selector for the horizontal axis (airspeed or conditions) and the error-bar switch,
/// from right to left.
pub fn channels_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let shown = state.display.gains.channel_values;
    let (measure, mut across) = shown;
    let axes = [
        (Across::Airspeed, "airspeed", "With the schedule"),
        (Across::Conditions, "conditions", "In file order"),
    ];
    let option = PageOption {
        name: "Horizontal axis of the channels",
        label: "over",
    };
    option.ui(ui, &mut across, &axes, palette);
    error_bars_switch_ui(ui, state, "error bars of the channels", commands);
    if (measure, across) != shown {
        commands.push(DisplayCommand::ShowChannels(measure, across).into());
    }
}

/// Draws each channel's gain or delay over airspeed or conditions (Figures 3 and 4): inputs above,
/// outputs below, on the same axes.
///
/// 1. Plots for all channels, on axes that do not move with every update.
/// 2. Copies for the inputs and for the outputs, after step 1, because both have common axes.
/// 3. Over airspeed, condition numbers only at the displayed condition; over conditions the axis
///    has them.
/// 4. Without plots, the message that says why.
/// 5. The area divided in proportion to the rows of both halves, and both drawn.
pub fn channels_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // The scenes borrow the state: take the view out while the figures are drawn.
    let mut view = std::mem::take(&mut state.display.gains.channels);
    // Step 1.
    let mut plots = channel_plots(state);
    let update = axis_update(ui, state);
    let (measure, across) = state.display.gains.channel_values;
    view.inputs
        .fit_if_subject_changed(&format!("{measure:?} {across:?}"));
    view.inputs.keep_axis_ranges(&mut plots.figure, update);
    // Step 2.
    let mut inputs = plots.figure.clone();
    let mut outputs = plots.figure.clone();
    inputs.plots.truncate(state.dataset().inputs().len());
    outputs.plots.drain(..inputs.plots.len());
    // Step 3.
    if plots.across == Across::Airspeed {
        let selected = MarkId::Condition(state.condition().id());
        for figure in [&mut inputs, &mut outputs] {
            label_selected_only(figure, &selected, SHOWS_DIFFERENCES);
        }
    }
    // Step 4.
    if plots.figure.plots.is_empty() {
        let scene = plots.scene("channels", &plots.figure, 0, state.results.absence());
        figure_ui(ui, &scene, &mut view.inputs, palette);
    }
    // Step 5.
    let rect = ui.available_rect_before_wrap();
    // Each half gets the height that its rows need.
    let half = vec2(rect.width(), 0.5 * rect.height());
    let [above, below] = [&inputs, &outputs].map(|figure| rows(figure, half, LEAST_PLOT) as f32);
    let middle = rect.top() + rect.height() * above / (above + below).max(1.0);
    let (upper, lower) = rect.split_top_bottom_at_y(middle);
    let first_output = inputs.plots.len();
    let halves = [
        ChannelPlots {
            name: "Input channels",
            rect: upper,
            figure: inputs,
            first_plot: 0,
            view: &mut view.inputs,
        },
        ChannelPlots {
            name: "Output channels",
            rect: lower,
            figure: outputs,
            first_plot: first_output,
            view: &mut view.outputs,
        },
    ];
    for half in halves {
        if !half.figure.plots.is_empty() {
            commands.extend(half.ui(ui, &plots, palette));
        }
    }
    ui.advance_cursor_after_rect(rect);
    state.display.gains.channels = view;
}

/// Plots for all inputs, or for all outputs.
struct ChannelPlots<'a> {
    name: &'static str,
    rect: Rect,
    figure: Figure,
    /// Index of the first of these plots among all channel plots.
    first_plot: usize,
    view: &'a mut FigureView,
}

impl ChannelPlots<'_> {
    /// Draws the plots below their heading; returns the resulting commands.
    fn ui(self, ui: &mut Ui, plots: &GainPlots<'_>, palette: &Palette) -> Vec<Command> {
        let place = pos2(
            self.rect.left() + 2.0,
            self.rect.top() + 0.5 * HEADING_HEIGHT,
        );
        ui.painter().text(
            place,
            Align2::LEFT_CENTER,
            self.name,
            FontId::proportional(SMALL_SIZE),
            palette.dim_text,
        );
        let inner = Rect::from_min_max(
            self.rect.min + vec2(0.0, HEADING_HEIGHT),
            self.rect.max - vec2(0.0, GAP),
        );
        let message = plots.state.results.absence();
        let scene = FigureScene {
            is_compact: plots.across == Across::Airspeed,
            ..plots.scene(self.name, &self.figure, self.first_plot, message)
        };
        let mut commands = Vec::new();
        for event in figure_within_ui(ui, inner, &scene, self.view, palette) {
            commands.extend(gain_command(plots.state, event));
        }
        commands
    }
}

/// Builds a plot for each channel, inputs first: gain or delay at each condition's optimum, and the
/// schedule.
pub fn channel_plots(state: &State) -> GainPlots<'_> {
    let (measure, across) = state.display.gains.channel_values;
    let mut figure = Figure::default();
    let mut quantities = Vec::new();
    if let Some(analysis) = state.analysis() {
        let channels = all_channels(state.dataset());
        let uncertainty = painted_uncertainty(state);
        let axes = GainAxes { measure, across };
        figure = channels_figure(analysis, uncertainty, &channels, axes);
        dim_older_bars(state, &mut figure);
        for channel in channels {
            quantities.push(GainQuantity::of_channel(channel, measure));
        }
        if across == Across::Airspeed
            && let Some(previous) = state.previous_analysis()
        {
            add_previous(&mut figure, &quantities, previous);
        }
    }
    reserve_room_for_bars(&mut figure);
    GainPlots {
        state,
        figure: figure.with_ranges(),
        quantities,
        across,
    }
}
