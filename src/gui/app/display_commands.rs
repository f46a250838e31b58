//! Commands that change the content of views.

use super::GdcmApp;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::view::View;

impl GdcmApp {
    pub(super) fn carry_out_display(&mut self, command: DisplayCommand) {
        let display = &mut self.state.display;
        match command {
            DisplayCommand::MapCost(mapped) => display.judging.mapped_cost = mapped,
            DisplayCommand::ShowNetGains(pairs) => display.gains.net_gain_pairs = pairs,
            DisplayCommand::PickPair(pair) => {
                display.gains.net_gain_pairs = PairSet::Picked;
                if !display.gains.picked_pairs.remove(&pair) {
                    display.gains.picked_pairs.insert(pair);
                }
            }
            DisplayCommand::ShowChannels(measure, across) => {
                display.gains.channel_values = (measure, across)
            }
            DisplayCommand::ShowZeros(shown) => display.poles.show_zeros = shown,
            DisplayCommand::ShowBars(shown) => display.gains.hide_bars = !shown,
            DisplayCommand::Overlay(variant) => display.judging.overlaid = variant,
            DisplayCommand::ShowEvidence(shown) => display.gains.show_evidence = shown,
            DisplayCommand::ShowAcross(role) => display.frequency.across_role = role,
            DisplayCommand::Assess(figures) => display.judging.assessed = figures,
            DisplayCommand::ShowParameter(name) => display.physics.selected = Some(name),
            DisplayCommand::ShowPhysics(page) => display.physics.page = page,
            DisplayCommand::ShowRequirements(page) => {
                display.judging.requirements_page = page;
                display.judging.requirements_sorting = Default::default();
                // Discard the zoom: another page has other plots.
                display.figures.remove(&View::Requirements);
            }
            DisplayCommand::SetFrequencyUnit(unit) => display.curves.unit = unit,
            DisplayCommand::SetLooks(looks) => display.curves.looks = looks,
            DisplayCommand::FitPlots => {
                display.frequency.fit();
                for figure in display.figures.values_mut() {
                    figure.request_fit();
                }
            }
            DisplayCommand::ShowTest(shown) => {
                display.judging.shows_test = shown;
                display.figures.remove(&View::Requirements);
            }
        }
    }
}
