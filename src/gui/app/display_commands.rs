//! Carries out changes to the content of the views.

use super::GdcmApp;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::plot::FigureView;
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::view::View;

impl GdcmApp {
    pub(super) fn carry_out_display(&mut self, command: DisplayCommand) {
        let display = &mut self.state.display;
        match command {
            DisplayCommand::MapCost(mapped) => display.mapped_cost = mapped,
            DisplayCommand::ShowNetGains(pairs) => display.net_gain_pairs = pairs,
            DisplayCommand::PickPair(pair) => {
                display.net_gain_pairs = PairSet::Picked;
                if !display.picked_pairs.remove(&pair) {
                    display.picked_pairs.insert(pair);
                }
            }
            DisplayCommand::ShowChannels(measure, across) => {
                display.channel_values = (measure, across)
            }
            DisplayCommand::ShowZeros(shown) => display.show_zeros = shown,
            DisplayCommand::ShowBars(shown) => display.hide_bars = !shown,
            DisplayCommand::Overlay(variant) => display.overlaid = variant,
            DisplayCommand::ShowEvidence(shown) => display.show_evidence = shown,
            DisplayCommand::ShowAcross(role) => display.across_role = role,
            DisplayCommand::Assess(figures) => display.assessed = figures,
            DisplayCommand::ShowRequirements(page) => {
                (display.requirements_page, display.requirements_sorting) =
                    (page, Default::default());
                // Another page has other plots.
                display.figures.remove(&View::Requirements);
            }
            DisplayCommand::SetFrequencyUnit(unit) => display.unit = unit,
            DisplayCommand::SetLooks(looks) => display.looks = looks,
            DisplayCommand::FitPlots => {
                display.fit_frequency_plots();
                display
                    .figures
                    .values_mut()
                    .for_each(FigureView::request_fit);
            }
            DisplayCommand::ShowTest(shown) => {
                display.shows_test = shown;
                display.figures.remove(&View::Requirements);
            }
        }
    }
}
