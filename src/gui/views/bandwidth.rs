//! Plots of phase delay over bandwidth; a click on a mark, or on a row of the table, shows the
//! response in the Bode view.

use egui::{Ui, Vec2, vec2};

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::units::telling;
use gdcm_plot::figure::Figure;
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::requirements::{bandwidth_pairs, bandwidth_place};
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;

use super::figures::figure_of;
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::figure_legend::figure_legend_ui;
use crate::gui::plot::{FigureEvent, FigureScene, FigureWords, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 150.0);

/// Draws phase delay over bandwidth; a click on a mark shows the response in the Bode view.
pub(super) fn bandwidth_plots_ui(
    ui: &mut Ui,
    state: &mut State,
    requirements: &Requirements,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let figure: Figure = figure_of(state, View::Requirements).unwrap_or_default();
    let pairs = bandwidth_pairs(requirements);
    figure_legend_ui(ui, &figure, palette);
    // The scene borrows the state, so the view is taken out of it while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::Requirements)
        .unwrap_or_default();
    let message = "No on-axis response is an angle or an angular rate, or none crosses −135° \
        and −180°. The table lists the reasons";
    let words = BandwidthWords {
        state,
        requirements,
        pairs: &pairs,
    };
    let scene = FigureScene {
        selected: Some(MarkId::Condition(state.condition().id())),
        zooms: true,
        accented: pairs
            .iter()
            .position(|pair| *pair == state.display.selection.pair),
        ..FigureScene::new("requirements", &figure, LEAST_PLOT, message, &words)
    };
    for event in figure_ui(ui, &scene, &mut view, palette) {
        if let FigureEvent::Clicked(plot, MarkId::Condition(condition), _) = event
            && let Some(pair) = pairs.get(plot)
        {
            let mut model = BandwidthModel {
                condition,
                pair: *pair,
                role: RequirementRole::Corrected,
            };
            // Several marks of a condition have the same id; the position distinguishes them.
            if let Some(place) = view.pointed_at()
                && let Some(role) = role_at(requirements, model, place)
            {
                model.role = role;
            }
            commands.extend(bode_commands(requirements, model));
        }
    }
    state.display.figures.insert(View::Requirements, view);
}

/// Returns the commands for a click on a row of the bandwidth table.
pub(super) fn bandwidth_row_commands(requirements: &Requirements, row: usize) -> Vec<Command> {
    match requirements.bandwidth.get(row) {
        Some(finding) => bode_commands(requirements, BandwidthModel::new(finding)),
        None => Vec::new(),
    }
}

/// Model with a bandwidth, given by condition, response and role.
#[derive(Clone, Copy)]
struct BandwidthModel {
    condition: ConditionId,
    pair: Pair,
    role: RequirementRole,
}

impl BandwidthModel {
    fn new(finding: &BandwidthFinding) -> Self {
        Self {
            condition: finding.condition,
            pair: finding.pair,
            role: finding.role,
        }
    }

    fn finding(self, requirements: &Requirements) -> Option<&BandwidthFinding> {
        requirements.bandwidth_of(self.condition, self.pair, self.role)
    }
}

/// Returns the role of the mark at a position \[rad/s, ms\] in the plot of a response; of several
/// marks there, the topmost.
fn role_at(
    requirements: &Requirements,
    model: BandwidthModel,
    place: [f64; 2],
) -> Option<RequirementRole> {
    for role in RequirementRole::ALL.into_iter().rev() {
        let finding = BandwidthModel { role, ..model }.finding(requirements);
        if finding.and_then(bandwidth_place) == Some(place) {
            return Some(role);
        }
    }
    None
}

/// Returns the commands that show the response in the Bode view, with marks at the frequencies that
/// define its bandwidth and phase delay.
fn bode_commands(requirements: &Requirements, model: BandwidthModel) -> Vec<Command> {
    let mut commands: Vec<Command> = vec![
        SelectionCommand::SelectCondition(model.condition).into(),
        SelectionCommand::FocusPair(model.pair).into(),
        CurveCommand::UnpinCursors.into(),
    ];
    if let Some(finding) = model.finding(requirements) {
        let mut crossings = Vec::new();
        for (name, omega) in [
            ("ω_phase", finding.omega_phase_rad_s),
            ("ω_gain", finding.omega_gain_rad_s),
            ("ω180", finding.omega_180_rad_s),
        ] {
            if let Some(omega) = omega {
                crossings.push((name, omega));
            }
        }
        commands.push(CurveCommand::MarkCrossings(crossings).into());
    }
    commands.push(LayoutCommand::ShowView(View::Bode).into());
    commands
}

/// Accessible names of the bandwidth plots, and descriptions of their marks.
struct BandwidthWords<'a> {
    state: &'a State,
    requirements: &'a Requirements,
    pairs: &'a [Pair],
}

impl FigureWords for BandwidthWords<'_> {
    fn plot_name(&self, plot: usize) -> String {
        let name = match self.pairs.get(plot) {
            Some(pair) => self.state.dataset().pair_name(*pair),
            None => String::new(),
        };
        format!("Phase delay over bandwidth of {name}")
    }

    fn status_text(&self, plot: usize, id: &MarkId, _: [f64; 2]) -> Option<String> {
        let pair = self.pairs.get(plot)?;
        let MarkId::Condition(id) = id else {
            return None;
        };
        let mut words = vec![format!("condition {id}")];
        for role in RequirementRole::ALL {
            let finding = self.requirements.bandwidth_of(*id, *pair, role);
            if let Some([bandwidth_rad_s, delay_ms]) = finding.and_then(bandwidth_place) {
                words.push(format!(
                    "{} {} rad/s, {} ms",
                    role.name(),
                    telling(bandwidth_rad_s, 2),
                    telling(delay_ms, 0)
                ));
            }
        }
        words.push("click: show in Bode".to_owned());
        Some(words.join(" · "))
    }
}
