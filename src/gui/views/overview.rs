//! Overview: all responses in the displayed condition as a table of small plots.
//!
//! J, in each plot's note, is the cost of the difference between a model's response and the
//! identified one (M4: docs/method.md).

use egui::Ui;

use gdcm_model::dataset::Pair;

use super::PageEntry;
use super::axis_updates::axis_update;
use super::frequency_curves::bode_curves;
use super::frequency_plot::action_command;
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::overview::overview_ui;
use crate::gui::plot::overview_response::OverviewCell;
use crate::gui::plot::overview_scene::{OverviewEvent, OverviewScene};
use crate::gui::plot::{BodeCurve, CurveId};
use crate::gui::state::view::View;
use crate::gui::state::view_pages::ViewPage;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

pub fn overview_pages(state: &State) -> Vec<PageEntry> {
    let shown = state.display.frequency.overview.show_phase;
    [false, true]
        .map(|has_phases| PageEntry::new(ViewPage::Overview { has_phases }, has_phases == shown))
        .into()
}

/// Draws every response in the displayed condition; a click shows a response in the Bode view.
pub fn overview_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pairs: Vec<Pair> = state.dataset().on_axis().pairs().collect();
    let mut curves: Vec<Vec<BodeCurve>> = Vec::new();
    for &pair in &pairs {
        let mut drawn = bode_curves(state, pair);
        drawn.retain(|curve| !curve.hidden);
        curves.push(drawn);
    }
    let cells: Vec<OverviewCell<'_>> = pairs
        .iter()
        .zip(&curves)
        .map(|(&pair, curves)| OverviewCell {
            pair,
            curves,
            constrained: state.study.settings.constrained[pair],
            selected: pair == state.display.selection.pair,
            note: cost_note(state, pair),
        })
        .collect();
    let (inputs, outputs) = state.dataset().input_and_output_names();
    let band = state.study.settings.band;
    let scene = OverviewScene {
        inputs: &inputs,
        outputs: &outputs,
        cells: &cells,
        band: (band.min(), band.max()),
        unit: state.display.curves.unit,
        cursor: state.display.curves.cursor,
        update: axis_update(ui, state),
        message: Some(state.results.absence()),
    };
    for event in overview_ui(ui, &scene, &mut state.display.frequency.overview, palette) {
        match event {
            OverviewEvent::PairClicked(pair) => {
                commands.push(SelectionCommand::FocusPair(pair).into());
                commands.push(LayoutCommand::ShowView(View::Bode).into());
            }
            OverviewEvent::Hovered(CurveId::Model(id)) => {
                commands.push(SelectionCommand::Hover(id).into())
            }
            OverviewEvent::PointedAt(omega) => commands.push(CurveCommand::PointAt(omega).into()),
            OverviewEvent::StatusText(words) => {
                commands.push(SelectionCommand::ShowStatus(words).into())
            }
            OverviewEvent::Isolated(CurveId::Model(id)) => {
                commands.push(SelectionCommand::Isolate(id).into())
            }
            OverviewEvent::ActionChosen(id, action) => {
                commands.extend(action_command(state, id, action))
            }
            OverviewEvent::Hovered(_) | OverviewEvent::Isolated(_) => {}
        }
    }
}

/// Returns "J 75→61": J for the uncorrected physics representative, and for the fully corrected
/// model. Empty unless both are available.
fn cost_note(state: &State, pair: Pair) -> String {
    let Some(shown) = state.shown() else {
        return String::new();
    };
    let before = shown.before_couplings().representative.cost[pair];
    match (before, shown.cost[pair]) {
        (Some(before), Some(change)) => {
            format!("J {:.0}→{:.0}", before.total(), change.corrected.total())
        }
        _ => String::new(),
    }
}
