//! Header for the net-gain view: description, switches, displayed responses, and the menu with the
//! schedule form.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, Grid, Label, PopupCloseBehavior, RichText, Role, Ui, WidgetInfo, vec2};

use gdcm_plot::figure::caption_words::schedule_words;
use gdcm_study::decisions::setting_table;
use gdcm_words::setting_words::setting_words;

use super::error_bars::error_bars_switch_ui;
use super::setting_controls::SettingControls;
use super::variant_analyses::overlaid_analysis;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::{Toggle, choice_ui};
use crate::gui::widgets::controls::named;
use crate::gui::widgets::palette::Palette;

/// Width of the explanation of the control under the pointer \[pt\].
const HELP_WIDTH: f32 = 300.0;
/// Height of the explanation, two lines \[pt\].
const HELP_HEIGHT: f32 = 30.0;
/// Width that the controls need in a single line \[pt\].
pub const NET_GAIN_CONTROLS: f32 = 410.0;

/// Returns the text beside the title: plotted quantity, displayed responses and error bars.
pub fn net_gain_words(state: &State) -> String {
    let level = 100.0 * state.study.settings.uncertainty.level;
    let bars = if state.display.gains.hide_bars {
        String::new()
    } else {
        format!(", {level:.0} % error bars")
    };
    let responses = match state.display.gains.net_gain_pairs {
        PairSet::Focused => "response in focus".to_owned(),
        set => format!("{} responses", set.name()),
    };
    format!("output k times input k, {responses}{bars}")
}

/// Draws, from right to left: the switches for evidence and error bars, the overlaid variant, the
/// menu with the schedule form, and the selector for the responses.
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
        let name = format!("Remove the overlay of variant {variant}");
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

/// Draws the selector for the displayed responses; for picked responses, also the button that adds
/// the response in focus or removes it.
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

/// Draws the schedule settings that apply to the chosen form, line by line, and below them the
/// explanation of the one under the pointer.
fn schedule_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let settings = [
        &setting_table::SCHEDULE,
        &setting_table::SCHEDULED_QUANTITY,
        &setting_table::SECOND_VARIABLE,
        &setting_table::SCHEDULE_DELAYS,
        &setting_table::TAU_DEGREE,
        &setting_table::AIRSPEED_TOLERANCE,
    ];
    let mut help = None;
    Grid::new("form of the schedule")
        .num_columns(2)
        .spacing([12.0, 6.0])
        .show(ui, |ui| {
            for setting in settings {
                if !(setting.control.applies)(&state.study) {
                    continue;
                }
                ui.label(palette.dim(setting_words(setting).label));
                let mut controls = SettingControls {
                    ui,
                    state,
                    palette,
                    commands,
                    help: &mut help,
                };
                controls.control_ui(setting);
                ui.end_row();
            }
        });
    // Two lines stay reserved, so that the list does not jump when the pointer moves over it.
    let size = vec2(HELP_WIDTH, HELP_HEIGHT);
    ui.allocate_ui(size, |ui| {
        ui.set_min_size(size);
        ui.add(Label::new(palette.small(help.unwrap_or_default())).wrap());
    });
}
