//! Plot over frequency in the displayed condition, shared by the Bode and the error view: cursors,
//! values and chips, and the commands for events.

use std::fmt::Write as _;

use egui::Ui;

use gdcm_model::dataset::{Band, ModelId};
use gdcm_study::Edit;
use gdcm_study::decisions::setting_table;

use super::cursor_readout::ReadoutSource;
use super::curve_chips::CurveChips;
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::plot::bode_event::{BodeEvent, CurveAction};
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::drawn_curves::PANES;
use crate::gui::plot::pointed_curve_text::pointed_curve_text;
use crate::gui::plot::quantity::BodeQuantity;
use crate::gui::plot::{BodeCurve, BodeScene, BodeView, CurveId, bode_ui};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

pub(super) struct FrequencyPlot<'a> {
    pub(super) state: &'a State,
    /// Scene without cursors, values and chips, which [`Self::ui`] adds.
    pub(super) scene: BodeScene<'a>,
    pub(super) view: &'a mut BodeView,
    pub(super) palette: &'a Palette,
}

impl FrequencyPlot<'_> {
    /// Draws the plot with cursors, chips and, if switched on, the listed values. Pushes the
    /// resulting commands, and a description for the element under the pointer.
    pub(super) fn ui(self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let Self {
            state,
            scene,
            view,
            palette,
        } = self;
        let display = &state.display.curves;
        let quantity = scene.quantity;
        let curves = scene.curves;
        let unit = display.unit;
        let mut readout = None;
        if display.lists_values {
            let source = ReadoutSource {
                curves,
                quantity,
                unit,
                band: scene.band,
            };
            readout = source.readout(display.cursor, &display.pinned);
        }
        let chips = CurveChips::new(state);
        let scene = BodeScene {
            cursor: display.cursor,
            pinned: &display.pinned,
            crossings: &display.crossings,
            readout: readout.as_ref(),
            hidden_roles: Some(&display.hidden_roles),
            raised: display.raised,
            names_roles: state.display.layout.is_wide && quantity.is_of_condition(),
            command_chips: &chips.chips,
            unit,
            stale: state.results.is_stale(ui.input(|input| input.time)),
            ..scene
        };
        for event in bode_ui(ui, &scene, view, palette) {
            match event {
                BodeEvent::ActionChosen(id, CurveAction::CopyValues) => {
                    if let Some(curve) = curves.iter().find(|curve| curve.id == id) {
                        commands.push(OutputCommand::CopyText(values_text(quantity, curve)).into());
                    }
                }
                BodeEvent::CommandChipClicked(index) => {
                    commands.extend(chips.commands.get(index).cloned());
                }
                other => commands.extend(event_command(state, other)),
            }
        }
        if let Some(CurveId::Model(id)) = &view.hovered {
            commands.push(SelectionCommand::Hover(id.clone()).into());
        }
        if let Some(words) = pointed_curve_text(view, curves, quantity, unit) {
            commands.push(SelectionCommand::ShowStatus(words).into());
        }
        if let Some(omega) = view.pointed_omega {
            commands.push(CurveCommand::PointAt(omega).into());
        }
    }
}

/// Returns the command for an event; `None` if it needs none or [`FrequencyPlot::ui`] handles it,
/// and for a band limit dragged beyond the other limit.
///
/// A double click isolates a model, but its first click has already rejected or restored that
/// model. `ClickUndone` therefore forgets this edit: a model that is rejected now was rejected by
/// it.
fn event_command(state: &State, event: BodeEvent) -> Option<Command> {
    match event {
        BodeEvent::Clicked(CurveId::Model(id)) => Some(reject_or_restore(state, id)),
        BodeEvent::ClickUndone(CurveId::Model(id)) => {
            let edit = if state.study.is_rejected(&id) {
                Edit::Reject(id)
            } else {
                Edit::Restore(id)
            };
            Some(StudyCommand::Forget(edit).into())
        }
        BodeEvent::Isolated(CurveId::Model(id)) => Some(SelectionCommand::Isolate(id).into()),
        BodeEvent::BandDragged { min, max } => {
            // A dragged band limit beyond the other limit is ignored.
            let band = Band::new(min, max).ok()?;
            Some(setting_table::BAND.to(band).into())
        }
        BodeEvent::BandReleased => Some(StudyCommand::EndEdit.into()),
        BodeEvent::Display(command) => Some(command.into()),
        BodeEvent::RejectedBecause(CurveId::Model(model), reason) => {
            Some(Edit::RejectBecause { model, reason }.into())
        }
        BodeEvent::ActionChosen(id, action) => action_command(state, id, action),
        BodeEvent::Boxed(curves) => {
            let models = curves.into_iter().filter_map(model_of_curve).collect();
            Some(CurveCommand::Select(models).into())
        }
        BodeEvent::Hovered(_)
        | BodeEvent::Clicked(_)
        | BodeEvent::ClickUndone(_)
        | BodeEvent::Isolated(_)
        | BodeEvent::RejectedBecause(..)
        | BodeEvent::CommandChipClicked(_) => None,
    }
}

fn model_of_curve(curve: CurveId) -> Option<ModelId> {
    match curve {
        CurveId::Model(id) => Some(id),
        _ => None,
    }
}

fn reject_or_restore(state: &State, id: ModelId) -> Command {
    if state.study.is_rejected(&id) {
        Edit::Restore(id).into()
    } else {
        Edit::Reject(id).into()
    }
}

/// Returns the command for an entry in a curve's menu; `None` if the entry concerns models but the
/// curve is not a model, and for *Copy values*, which [`FrequencyPlot::ui`] handles.
pub(super) fn action_command(state: &State, id: CurveId, action: CurveAction) -> Option<Command> {
    match (action, id) {
        (CurveAction::Turn(turns), curve) => Some(
            CurveCommand::Turn {
                condition: state.condition().id(),
                pair: state.display.selection.pair,
                curve,
                turns,
            }
            .into(),
        ),
        (CurveAction::RejectOrRestore, CurveId::Model(id)) => Some(reject_or_restore(state, id)),
        (CurveAction::Pin, CurveId::Model(id)) => Some(Edit::Pin(id).into()),
        (CurveAction::Isolate, CurveId::Model(id)) => Some(SelectionCommand::Isolate(id).into()),
        (CurveAction::Hide, CurveId::Model(id)) => Some(CurveCommand::HideModel(id).into()),
        _ => None,
    }
}

/// Formats a curve's values as text: its label, the column headings, and a tab-separated line for
/// each frequency.
fn values_text(quantity: BodeQuantity<'_>, curve: &BodeCurve) -> String {
    let [magnitude, phase] = PANES.map(|pane| quantity.drawn_label(pane));
    let mut text = format!("{}\nω [rad/s]\t{magnitude}\t{phase}\n", curve.label);
    let values = curve.magnitude_db.iter().zip(curve.phase_deg.iter());
    for (omega, (magnitude, phase)) in curve.omega.iter().zip(values) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{omega}\t{magnitude}\t{phase}");
    }
    text
}
