//! Net gains over airspeed, with the settings of the schedule.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, Grid, Panel, PopupCloseBehavior, RichText, Role, ScrollArea, Ui, WidgetInfo};

use gdcm_plot::figure::condition_source::schedule_words;
use gdcm_plot::figure::gains::{Across, GainQuantity, add_variant, net_gain_figure, quieten};
use gdcm_plot::figure::{Figure, MarkId};
use gdcm_study::decisions::setting;
use gdcm_words::setting_words::setting_words;

use super::error_bars::{error_bars_switch_ui, shown_uncertainty};
use super::gain_plots::{GainPlots, gain_command};
use super::net_gain_pairs::net_gain_pairs;
use super::schedule_evidence::{FormsTable, coefficient_table, lead_degrees_table, residual_table};
use super::setting_controls::SettingControls;
use super::variants::overlaid_analysis;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::plot::{FigureScene, figure_ui};
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::{Toggle, choice_ui};
use crate::gui::widgets::controls::named;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use crate::gui::widgets::panel_layout::restore_panel_size;
use crate::gui::widgets::tables::{Sorting, TableLook, table_ui};

/// Width of the controls in a single line \[pt\].
pub const NET_GAIN_CONTROLS: f32 = 410.0;

/// Returns the description of the plots in the view's header.
pub fn net_gain_words(state: &State) -> String {
    let level = 100.0 * state.study.settings.uncertainty.level;
    let bars = if state.display.gains.hide_bars {
        String::new()
    } else {
        format!(", {level:.0} % error bars")
    };
    format!(
        "output k times input k, {} responses{bars}",
        state.display.gains.net_gain_pairs.name()
    )
}

/// Draws the controls for responses and schedule, from right to left.
pub fn net_gain_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let shown = state.display.gains.show_evidence;
    let hint = "Evidence for the degree of the schedule: significant differences at equal \
        airspeed, and the error of each form";
    let toggle = Toggle {
        text: "evidence",
        name: "evidence",
        hint,
    };
    if toggle.ui(ui, shown) {
        commands.push(DisplayCommand::ShowEvidence(!shown).into());
    }
    error_bars_switch_ui(ui, state, "error bars", commands);
    if let Some((variant, _)) = overlaid_analysis(state) {
        let button = ui.small_button(
            RichText::new(format!("□ {variant} ×")).color(palette.label_color(palette.corrected)),
        );
        let name = format!("Overlaid variant {variant}");
        let hint = "Hollow squares: net gains of this variant. Click: remove them";
        if named(button, Role::Button, &name)
            .on_hover_text(hint)
            .clicked()
        {
            commands.push(DisplayCommand::Overlay(None).into());
        }
    }
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let form = schedule_words(&state.study.settings.schedule);
    let short_form = form.strip_prefix("polynomial of ").unwrap_or(&form);
    let text = format!("{short_form} \u{25be}");
    let button = MenuButton::from_button(Button::new(text).frame(false)).config(config);
    let (button, _) = button.ui(ui, |ui| schedule_ui(ui, state, palette, commands));
    named(button, Role::Button, "Form of the schedule")
        .on_hover_text("Degree, scheduled quantity, delays and airspeed tolerance");
    pair_set_ui(ui, state, commands);
}

/// Draws the selector of the displayed responses, from right to left.
fn pair_set_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let pair = state.display.selection.pair;
    if state.display.gains.net_gain_pairs == PairSet::Picked {
        let picked = state.display.gains.picked_pairs.contains(&pair);
        let text = if picked { "−" } else { "+" };
        let verb = if picked { "Remove" } else { "Pick" };
        let name = format!("{verb} {}", state.dataset().pair_name(pair));
        let button = ui.small_button(text);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        if button
            .on_hover_text(format!("{name}, the response in focus"))
            .clicked()
        {
            commands.push(DisplayCommand::PickPair(pair).into());
        }
    }
    let mut chosen = state.display.gains.net_gain_pairs;
    let sets = PairSet::ALL.map(|set| (set, set.name(), set.purpose()));
    choice_ui(ui, "Responses of the net-gain plots", &mut chosen, &sets);
    if chosen != state.display.gains.net_gain_pairs {
        commands.push(DisplayCommand::ShowNetGains(chosen).into());
    }
}

/// Draws the net gain of each displayed response over airspeed.
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
            _ => "No response is held: hold one in the matrix",
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
    // The scene borrows the state, so the view is taken out of it while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::NetGain)
        .unwrap_or_default();
    let mut plots = net_gain_plots(state);
    let selected = MarkId::Condition(state.condition().id());
    quieten(
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

/// Draws the evidence for each form of the schedule; a click selects a form.
fn evidence_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let mut cached = std::mem::take(&mut state.display.gains.evidence);
    cached.refresh(state);
    let mut sorting = state.display.gains.evidence_sorting;
    ScrollArea::vertical().show(ui, |ui| {
        let Some(evidence) = cached.evidence() else {
            ui.label(palette.dim(state.results.absence()));
            return;
        };
        let hint = "fit: root mean square residual of ln(net gain); unseen: residuals of each \
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
            let mut unsorted = Sorting::default();
            let look = TableLook::PLAIN;
            table_ui(ui, &table, &mut unsorted, &look, palette, commands);
        }
    });
    state.display.gains.evidence = cached;
    state.display.gains.evidence_sorting = sorting;
}

/// Draws the settings of the schedule, line by line.
fn schedule_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let rows = [
        &setting::SCHEDULE,
        &setting::SCHEDULED_QUANTITY,
        &setting::SECOND_VARIABLE,
        &setting::SCHEDULE_DELAYS,
        &setting::TAU_DEGREE,
        &setting::AIRSPEED_TOLERANCE,
    ];
    Grid::new("form of the schedule")
        .num_columns(2)
        .spacing([12.0, 6.0])
        .show(ui, |ui| {
            for setting in rows {
                if !(setting.control.applies)(&state.study) {
                    continue;
                }
                ui.label(palette.dim(setting_words(setting).label));
                let mut controls = SettingControls {
                    ui,
                    state,
                    palette,
                    commands,
                };
                controls.control_ui(setting);
                ui.end_row();
            }
        });
}

/// Builds a plot for each displayed response: net gain at the optimum of each condition, and the
/// schedule.
pub fn net_gain_plots(state: &State) -> GainPlots<'_> {
    let mut pairs = Vec::new();
    let mut figure = Figure::default();
    if let Some(analysis) = state.analysis() {
        pairs = net_gain_pairs(state);
        figure = net_gain_figure(analysis, shown_uncertainty(state), &pairs);
    }
    let quantities: Vec<GainQuantity> = pairs.iter().copied().map(GainQuantity::NetGain).collect();
    if let Some((name, analysis)) = overlaid_analysis(state) {
        add_variant(&mut figure, &quantities, analysis, name);
    }
    for (plot, pair) in figure.plots.iter_mut().zip(&pairs) {
        if !state.study.settings.constrained[*pair] {
            plot.title = format!("{} (free)", state.dataset().pair_name(*pair));
        }
    }
    GainPlots {
        state,
        figure: figure.with_ranges(),
        quantities,
        across: Across::Airspeed,
    }
}
