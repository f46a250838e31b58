//! Interaction with the overview.

use egui::vec2;
use egui_kittest::kittest::Queryable;

use gdcm_model::dataset::Pair;

use gdcm_plot::figure::axis::FrequencyUnit;

use super::*;
use crate::gui::plot::overview::overview_ui;
use crate::gui::plot::overview_response::OverviewCell;
use crate::gui::plot::overview_scene::{OverviewEvent, OverviewScene, OverviewView};
use crate::gui::plot::steady_range::AxisUpdate;
use crate::gui::widgets::palette;
use crate::gui::widgets::palette::Palette;

/// Test state: an overview that shows the same curves in every cell, and the events so far.
#[derive(Default)]
struct PlotState {
    curves: Vec<BodeCurve>,
    overview: OverviewView,
    events: Vec<OverviewEvent>,
}

fn overview_harness(curves: Vec<BodeCurve>) -> Harness<'static, PlotState> {
    let state = PlotState {
        curves,
        ..PlotState::default()
    };
    let mut harness = Harness::builder()
        .with_size(vec2(800.0, 600.0))
        .with_context_setup(palette::apply)
        .build_ui_state(
            |ui, state: &mut PlotState| {
                let inputs = ["LON", "LAT", "PED", "COL"].map(String::from);
                let outputs = ["P", "Q", "R", "NX", "NY", "NZ"].map(String::from);
                let cell = |k: usize| OverviewCell {
                    pair: Pair::new(k / 4, k % 4),
                    curves: &state.curves,
                    constrained: k == 1,
                    selected: k == 4,
                    note: "J 75".to_owned(),
                };
                let cells: Vec<_> = (0..24).map(cell).collect();
                let scene = OverviewScene {
                    inputs: &inputs,
                    outputs: &outputs,
                    cells: &cells,
                    band: (0.5, 12.0),
                    unit: FrequencyUnit::RadPerSecond,
                    cursor: None,
                    update: AxisUpdate::Complete,
                    message: None,
                };
                let palette = Palette::from_visuals(ui.visuals());
                let events = overview_ui(ui, &scene, &mut state.overview, &palette);
                state.events.extend(events);
            },
            state,
        );
    harness.run();
    harness
}

#[test]
fn a_click_on_a_small_plot_names_its_pair() {
    let mut harness = overview_harness(vec![lag(1, 0.0, 1.0, Role::Nominal)]);
    let at = harness
        .state()
        .overview
        .screen_position(Pair::new(4, 2))
        .unwrap();
    click(&mut harness, at);
    assert!(
        harness
            .state()
            .events
            .contains(&OverviewEvent::PairClicked(Pair::new(4, 2)))
    );
}

#[test]
fn a_small_plot_is_found_by_its_name() {
    let mut harness = overview_harness(vec![lag(1, 0.0, 1.0, Role::Nominal)]);
    harness.get_by_label("LON → Q: J 75").click();
    harness.run();
    assert!(
        harness
            .state()
            .events
            .contains(&OverviewEvent::PairClicked(Pair::new(1, 0)))
    );
}

#[test]
fn an_overview_without_curves_has_a_message() {
    overview_harness(Vec::new()).get_by_label("Nothing to draw");
}
