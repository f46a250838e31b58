//! Commands that change what views show.

use super::GdcmApp;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::pair_set::PairSet;
use crate::gui::state::view::View;
use crate::gui::state::view_pages::ViewPage;

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
            DisplayCommand::ShowAcross(role, is_shown) => {
                display.frequency.across_display.show(role, is_shown);
            }
            DisplayCommand::ShowAcrossAlone(role) => {
                display.frequency.across_display.roles = vec![role];
            }
            DisplayCommand::ShowAcrossConditions(conditions) => {
                display.frequency.across_display.conditions = conditions;
            }
            DisplayCommand::ShowAcrossPage(page) => display.frequency.across_display.page = page,
            DisplayCommand::Assess(figures) => display.judging.assessed = figures,
            DisplayCommand::ShowParameter(name) => display.physics.selected = Some(name),
            DisplayCommand::ShowPhysics(page) => display.physics.page = page,
            DisplayCommand::ShowRequirements(requirements) => {
                if display.judging.requirements.selected != requirements.selected {
                    // Discard the zoom: another requirement has other plots.
                    display.figures.remove(&View::Requirements);
                    display.judging.history_figure = Default::default();
                }
                display.judging.requirements = requirements;
            }
            DisplayCommand::ShowPage(page) => match page {
                ViewPage::Overview { has_phases } => {
                    display.frequency.overview.show_phase = has_phases;
                }
                ViewPage::Poles(page) => display.pages.poles = page,
                ViewPage::Couplings(page) => display.pages.couplings = page,
                ViewPage::Evidence(page) => display.pages.evidence = page,
                ViewPage::Compare(page) => display.pages.compare = page,
            },
            DisplayCommand::SetFrequencyUnit(unit) => display.curves.unit = unit,
            DisplayCommand::SetLooks(looks) => display.curves.looks = looks,
            DisplayCommand::FitPlots => {
                display.frequency.fit();
                for figure in display.figures.values_mut() {
                    figure.request_fit();
                }
                display.judging.history_figure.request_fit();
            }
            DisplayCommand::ShowTest(shown) => {
                display.judging.shows_test = shown;
                display.judging.history_figure = Default::default();
            }
        }
    }
}
