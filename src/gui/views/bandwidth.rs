//! Phase delay over bandwidth for a response, in the requirement details; a click on a mark selects
//! its condition. Bandwidth and phase delay are those of ADS-33E-PRF (M17.1: docs/requirements.md).
//! A *finding* holds both for a model, or why a value is absent.

use egui::{Grid, Ui, Vec2, vec2};

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::number_format::{decimals_or_dash, with_minus_sign};
use gdcm_model::units::{s_to_ms, telling};
use gdcm_plot::figure::bandwidth_detail::{BandwidthDetail, bandwidth_detail_figure};
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::requirements::{bandwidth_pairs, bandwidth_place};
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::missing_results::no_bandwidth_text;
use gdcm_words::requirement_grid::level_text;

use super::requirement_cards::role_color;
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::{FigureEvent, FigureScene, FigureWords, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(120.0, 80.0);

/// Draws phase delay over bandwidth for the response in focus, or why it has no bandwidth.
pub(super) fn bandwidth_detail_ui(
    ui: &mut Ui,
    state: &mut State,
    requirements: &Requirements,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pair = state.display.selection.pair;
    let condition = state.condition().id();
    if !bandwidth_pairs(requirements).contains(&pair) {
        ui.label(palette.dim(absence_text(state, requirements, pair)));
        return;
    }
    let role = state.display.judging.requirements.role();
    let settings = &state.study.requirements;
    let detail = BandwidthDetail {
        requirements,
        levels: &settings.levels,
        pair,
        condition,
        role,
        bandwidth_tolerance: settings.overview.bandwidth,
        phase_delay_tolerance_s: settings.overview.phase_delay_s,
    };
    let figure = bandwidth_detail_figure(&detail, state.dataset());
    // The scene borrows the state: take the view out while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::Requirements)
        .unwrap_or_default();
    view.fit_if_subject_changed(&figure.title);
    let words = BandwidthWords {
        state,
        requirements,
        pair,
    };
    let scene = FigureScene {
        selected: Some(MarkId::Condition(condition)),
        zooms: true,
        ..FigureScene::new("requirements", &figure, LEAST_PLOT, "", &words)
    };
    for event in figure_ui(ui, &scene, &mut view, palette) {
        match event {
            FigureEvent::Clicked(_, MarkId::Condition(id), _) => {
                commands.push(SelectionCommand::SelectCondition(id).into());
            }
            FigureEvent::StatusText(words) => {
                commands.push(SelectionCommand::ShowStatus(words).into())
            }
            FigureEvent::Pointed(MarkId::Condition(id)) => {
                commands.push(SelectionCommand::HoverCondition(id).into());
            }
            _ => {}
        }
    }
    state.display.figures.insert(View::Requirements, view);
}

/// Returns why the response in focus has no bandwidth to plot.
fn absence_text(state: &State, requirements: &Requirements, pair: Pair) -> String {
    let name = state.dataset().pair_name(pair);
    let condition = state.condition().id();
    let finding = RequirementRole::ALL
        .into_iter()
        .find_map(|role| requirements.bandwidth_of(condition, pair, role));
    let Some(finding) = finding else {
        return if matches!(state.outcome(), Some(Ok(_))) {
            format!("{name} has no bandwidth, because the response is not on-axis")
        } else {
            format!("{name} has no bandwidth, because condition {condition} has no result")
        };
    };
    let why = finding
        .absent
        .get("omega_bw_rad_s")
        .or_else(|| finding.absent.get("phase_delay_s"));
    match why {
        Some(why) => format!("{name}: {}", no_bandwidth_text(why)),
        None => format!("{name}: no model has both a bandwidth and a phase delay"),
    }
}

/// Draws every model's bandwidth, phase delay and, if boundaries exist for the axis, level in the
/// displayed condition.
pub(super) fn bandwidth_numbers_ui(
    ui: &mut Ui,
    state: &State,
    requirements: &Requirements,
    palette: &Palette,
) {
    let condition = state.condition().id();
    let pair = state.display.selection.pair;
    let levels = &state.study.requirements.levels;
    let has_levels = levels.assesses(&state.dataset().outputs()[pair.output].name);
    Grid::new("bandwidths of the response")
        .num_columns(4)
        .show(ui, |ui| {
            for heading in ["", "bandwidth, rad/s", "phase delay, ms"] {
                ui.label(palette.small(heading));
            }
            if has_levels {
                ui.label(palette.small("level"));
            }
            ui.end_row();
            for role in RequirementRole::ALL {
                let Some(finding) = requirements.bandwidth_of(condition, pair, role) else {
                    continue;
                };
                ui.colored_label(role_color(palette, role), role.name());
                ui.label(decimals_or_dash(finding.omega_bw_rad_s, 2));
                ui.label(decimals_or_dash(finding.phase_delay_s.map(s_to_ms), 0));
                if has_levels {
                    ui.label(level_text(finding.level(levels)));
                }
                ui.end_row();
            }
        });
}

/// Returns the commands that show a response in a condition in the Bode view; marks at the
/// frequencies that define bandwidth and phase delay of the model in `role` replace pinned cursors.
pub(super) fn bode_commands(
    requirements: &Requirements,
    condition: ConditionId,
    pair: Pair,
    role: RequirementRole,
) -> Vec<Command> {
    let mut commands: Vec<Command> = vec![
        SelectionCommand::SelectCondition(condition).into(),
        SelectionCommand::FocusPair(pair).into(),
        CurveCommand::RemoveFrequencyMarks.into(),
    ];
    if let Some(finding) = requirements.bandwidth_of(condition, pair, role) {
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

/// Accessible name for the bandwidth plot, and descriptions of its marks.
struct BandwidthWords<'a> {
    state: &'a State,
    requirements: &'a Requirements,
    pair: Pair,
}

impl FigureWords for BandwidthWords<'_> {
    fn plot_name(&self, _: usize) -> String {
        let name = self.state.dataset().pair_name(self.pair);
        format!("Phase delay over bandwidth of {name}")
    }

    /// Describes a condition, whichever of its marks is pointed at: for each role with a bandwidth
    /// and a phase delay both values, and the level if boundaries give one.
    fn status_text(&self, _: usize, id: &MarkId, _: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = id else {
            return None;
        };
        let mut words = vec![format!("condition {id}")];
        for role in RequirementRole::ALL {
            let Some(finding) = self.requirements.bandwidth_of(*id, self.pair, role) else {
                continue;
            };
            if let Some([bandwidth_rad_s, delay_ms]) = bandwidth_place(finding) {
                let mut text = format!(
                    "{} {} rad/s, {} ms",
                    role.name(),
                    telling(bandwidth_rad_s, 2),
                    with_minus_sign(&telling(delay_ms, 0))
                );
                if let Some(level) = finding.level(&self.state.study.requirements.levels) {
                    text += &format!(", Level {}", level_text(Some(level)));
                }
                words.push(text);
            }
        }
        Some(words.join(" · "))
    }
}
