//! The dataset's physics parameters in the left panel: whether each is fitted, its plausible
//! change, and how many model runs change it in the displayed condition.
//!
//! A *run* is a physics model linearised with one parameter changed; from the runs the diagnosis
//! knows how the models depend on the parameter (M18: docs/physics.md).

use egui::{Button, RichText, ScrollArea, Sense, Ui, vec2};

use gdcm_method::physics::OfferedParameter;
use gdcm_model::dataset::physics_parameter::MovedParameters;
use gdcm_model::units::number;

use super::fit_box::fit_box_ui;
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, button_ui, hint_right_of};
use crate::gui::widgets::list_row::{ROW_HEIGHT, RowLook};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, Room, painted_text, row_text_within};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, body, medium, small};

/// Left edge of the names \[pt\].
const NAME: f32 = 24.0;
/// Width of the "runs" column \[pt\].
const RUNS: f32 = 34.0;
/// Width of the "plausible" column \[pt\].
const PLAUSIBLE: f32 = 62.0;

/// Draws the parameters in dataset order. A click on a row shows the parameter, a click on its box
/// takes it into the fit or out of it.
pub fn parameter_list_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let settings = &state.study.settings.physics_parameters;
    let parameters = settings.parameters(state.dataset());
    let fitted = settings.parameters_on(state.dataset()).len();
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.label(RichText::new("Parameters").font(medium(BODY_SIZE)));
        let count = format!("{fitted} of {} fitted", parameters.len());
        ui.label(palette.small(count));
    });
    ui.horizontal(|ui| {
        let hint = "A run is a physics model linearised with one parameter changed. Import the \
            runs together with the other models; names such as \"Ixx+5%\" are recognised";
        let button = Button::new("Import models…");
        button_ui(ui, button, hint, AssemblingCommand::Open, commands);
        ui.label(palette.small("with runs"));
    });
    ui.add_space(4.0);
    ui.spacing_mut().item_spacing.y = 0.0;
    if parameters.is_empty() {
        return;
    }
    let (headings, _) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    let color = palette.dim_text;
    painted_text(ui, headings, AT_RIGHT_END, "runs", small(), color);
    let column = headings.with_max_x(headings.right() - RUNS);
    painted_text(ui, column, AT_RIGHT_END, "plausible ±", small(), color);
    ScrollArea::vertical()
        .id_salt("parameters")
        .auto_shrink(false)
        .show(ui, |ui| {
            for parameter in &parameters {
                let is_on = !settings.off.contains(&parameter.name);
                row_ui(ui, state, parameter, is_on, palette, commands);
            }
        });
}

fn row_ui(
    ui: &mut Ui,
    state: &State,
    parameter: &OfferedParameter,
    is_on: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let name = &parameter.name;
    let look = RowLook {
        is_selected: is_on && state.display.physics.selected.as_ref() == Some(name),
        is_pointed: false,
        height: ROW_HEIGHT,
    };
    let (row, response) = look.row_ui(ui, palette, &format!("Runs of {name}"));
    hint_right_of(response, row, &parameter.description)
        .asks(DisplayCommand::ShowParameter(name.clone()), commands);
    fit_box_ui(ui, row, row.left() + 4.0, name, is_on, palette, commands);
    let color = if is_on {
        palette.text
    } else {
        palette.dim_text
    };
    let room = Room {
        left: NAME,
        right: row.width() - RUNS - PLAUSIBLE,
    };
    row_text_within(ui, row, room, name, BODY_SIZE, color);
    let column = row.with_max_x(row.right() - RUNS);
    let plausible = format!("{} {}", number(parameter.plausible_sd), parameter.unit);
    painted_text(ui, column, AT_RIGHT_END, &plausible, body(), color);
    let runs = runs_of(state, name);
    let color = if runs == 0 { palette.warning } else { color };
    painted_text(ui, row, AT_RIGHT_END, &runs.to_string(), body(), color);
}

/// Counts the model runs that change a parameter in the displayed condition.
fn runs_of(state: &State, name: &str) -> usize {
    let mut runs = 0;
    for model in state.condition().moved_models() {
        if let MovedParameters::Run(change) = &model.moved
            && change.name == name
        {
            runs += 1;
        }
    }
    runs
}
