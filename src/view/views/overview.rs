//! Every response, small.

use egui::Ui;
use gdcm_core::dataset::Pair;

use super::View;
use super::frequency::{bode_curves, wished};
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{BodeCurve, CurveId, OverviewCell, OverviewEvent, OverviewScene, overview_ui};
use crate::view::state::State;

/// Every response of the condition shown; a click brings it into focus.
pub fn overview_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let pairs: Vec<Pair> = state.dataset().on_axis().pairs().collect();
    let curves: Vec<Vec<BodeCurve>> = pairs.iter().map(|&pair| visible_curves(state, pair)).collect();
    let cells: Vec<OverviewCell<'_>> = pairs
        .iter()
        .zip(&curves)
        .map(|(&pair, curves)| OverviewCell {
            pair,
            curves,
            constrained: state.study.settings.constrained[pair],
            selected: pair == state.display.pair,
            note: cost_note(state, pair),
        })
        .collect();
    let (inputs, outputs) = state.dataset().names_of_channels();
    let band = state.study.settings.band;
    let scene = OverviewScene {
        inputs: &inputs,
        outputs: &outputs,
        cells: &cells,
        band: (band.min(), band.max()),
        message: Some(state.results.absence()),
    };
    for event in overview_ui(ui, &scene, &mut state.display.overview, palette) {
        match event {
            OverviewEvent::PairClicked(pair) => {
                commands.push(Command::FocusPair(pair));
                commands.push(Command::ShowView(View::Bode));
            }
            OverviewEvent::Hovered(CurveId::Model(id)) => commands.push(Command::Hover(id)),
            OverviewEvent::Told(words) => commands.push(Command::Tell(words)),
            OverviewEvent::Isolated(CurveId::Model(id)) => commands.push(Command::Isolate(id)),
            OverviewEvent::Wished(id, wish) => commands.extend(wished(state, id, wish)),
            OverviewEvent::Hovered(_) | OverviewEvent::Isolated(_) => {}
        }
    }
}

/// The curves of a response that are not hidden.
fn visible_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    let mut curves = bode_curves(state, pair);
    curves.retain(|curve| !curve.hidden);
    curves
}

/// "J 75→61": of the physics representative as it is, and of the corrected one with all that is done to it.
fn cost_note(state: &State, pair: Pair) -> String {
    let cost = state.shown().and_then(|shown| {
        shown.before_couplings().representative.cost[pair].zip(shown.cost[pair].map(|change| change.corrected))
    });
    cost.map_or(String::new(), |(before, after)| format!("J {:.0}→{:.0}", before.total(), after.total()))
}
