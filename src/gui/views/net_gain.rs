//! Net-gain view: plots of net gains (output gain times input gain) over airspeed, and beside them
//! the evidence for the schedule form. The header is in `net_gain_header`.

use egui::{Panel, RichText, ScrollArea, Ui};

use gdcm_plot::figure::Figure;
use gdcm_plot::figure::gains::{Across, GainQuantity, net_gain_figure};
use gdcm_plot::figure::gains_on_screen::{
    add_previous, add_variant, label_selected_only, reserve_room_for_bars,
};
use gdcm_plot::figure::marks::MarkId;

use super::axis_updates::axis_update;
use super::error_bars::{dim_older_bars, painted_uncertainty};
use super::gain_plots::{GainPlots, gain_command};
use super::net_gain_pairs::net_gain_pairs;
use super::schedule_tables::{FormsTable, coefficient_table, lead_degrees_table, residual_table};
use super::variant_analyses::overlaid_analysis;
use crate::gui::commands::command::Command;
use crate::gui::plot::{FigureScene, figure_ui};
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use crate::gui::widgets::panel_layout::restore_panel_size;
use crate::gui::widgets::tables::{TableLook, table_block_ui};

/// Draws each displayed response's net gain over airspeed and, if switched on, the evidence beside
/// the plots.
pub fn net_gain_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let message = if state.analysis().is_none() {
        state.results.absence()
    } else {
        match state.display.gains.net_gain_pairs {
            PairSet::Picked => "No response is picked: select one in the matrix, then click +",
            PairSet::Held => "No response is held: hold one in the matrix",
            _ => "These responses have no net gain to plot",
        }
    };
    if state.display.gains.show_evidence {
        let width = ui.available_width();
        restore_panel_size(ui, "evidence");
        let panel = Panel::right("evidence")
            .resizable(true)
            .default_size(0.36 * width)
            .min_size(120.0);
        panel.show(ui, |ui| evidence_ui(ui, state, palette, commands));
    }
    // The scene borrows the state: take the view out while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::NetGain)
        .unwrap_or_default();
    let mut plots = net_gain_plots(state);
    view.keep_axis_ranges(&mut plots.figure, axis_update(ui, state));
    let selected = MarkId::Condition(state.condition().id());
    label_selected_only(
        &mut plots.figure,
        &selected,
        state.display.gains.show_evidence,
    );
    let accented = net_gain_pairs(state)
        .iter()
        .position(|pair| *pair == state.display.selection.pair);
    let scene = FigureScene {
        is_compact: true,
        accented,
        ..plots.scene("net gain", &plots.figure, 0, message)
    };
    let events = figure_ui(ui, &scene, &mut view, palette);
    for event in events {
        commands.extend(gain_command(state, event));
    }
    state.display.figures.insert(View::NetGain, view);
}

/// Draws the error of each schedule form, a click on which selects the form; below it the errors of
/// each degree of the leads, the residuals and the coefficients.
fn evidence_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    // The tables borrow the state: take the cache out while they are drawn.
    let mut cached = std::mem::take(&mut state.display.gains.evidence);
    cached.refresh(state);
    let mut sorting = state.display.gains.evidence_sorting;
    ScrollArea::vertical().show(ui, |ui| {
        let Some(evidence) = cached.evidence() else {
            ui.label(palette.dim(state.results.absence()));
            return;
        };
        let hint = "fit: root mean square residual of ln(net gain); left out: residuals of each \
            condition from the schedule fitted without it";
        ui.label(
            RichText::new("Error of each form [% of the net gain]")
                .size(SMALL_SIZE)
                .strong(),
        )
        .on_hover_text(hint);
        let forms = FormsTable {
            state,
            forms: evidence.forms,
            palette,
        };
        forms.ui(ui, &mut sorting, commands);
        let tables = [
            lead_degrees_table(state, &cached.leads),
            residual_table(state, evidence),
            coefficient_table(state),
        ];
        for table in tables.into_iter().flatten() {
            ui.label(RichText::new(&table.title).size(SMALL_SIZE).strong());
            table_block_ui(ui, &table, &TableLook::PLAIN, palette, commands);
        }
    });
    state.display.gains.evidence = cached;
    state.display.gains.evidence_sorting = sorting;
}

/// Builds a plot for each displayed response.
///
/// 1. Net gain at each condition's optimum with error bars, and the schedule; bars from earlier
///    settings are dim.
/// 2. In grey, the previous analysis; as hollow squares, the overlaid variant.
/// 3. Titles of responses that are not constrained end in "(free)".
/// 4. Axis ranges with room for the bars.
pub fn net_gain_plots(state: &State) -> GainPlots<'_> {
    // Step 1.
    let mut pairs = Vec::new();
    let mut figure = Figure::default();
    if let Some(analysis) = state.analysis() {
        pairs = net_gain_pairs(state);
        figure = net_gain_figure(analysis, painted_uncertainty(state), &pairs);
        dim_older_bars(state, &mut figure);
    }
    let quantities: Vec<GainQuantity> = pairs.iter().copied().map(GainQuantity::NetGain).collect();
    // Step 2.
    if let Some(previous) = state.previous_analysis() {
        add_previous(&mut figure, &quantities, previous);
    }
    if let Some((name, analysis)) = overlaid_analysis(state) {
        add_variant(&mut figure, &quantities, analysis, name);
    }
    // Step 3.
    for (plot, pair) in figure.plots.iter_mut().zip(&pairs) {
        if !state.study.settings.constrained[*pair] {
            plot.title = format!("{} (free)", state.dataset().pair_name(*pair));
        }
    }
    // Step 4.
    reserve_room_for_bars(&mut figure);
    GainPlots {
        state,
        figure: figure.with_ranges(),
        quantities,
        across: Across::Airspeed,
    }
}
