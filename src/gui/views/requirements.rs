//! Requirements in addition to J, as in a qualification, evaluated for the physics, corrected,
//! scheduled and identified models side by side (M17).

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Button, CollapsingHeader, Label, Panel, ScrollArea, Ui, Vec2, vec2};

use gdcm_method::requirements::{AttitudeOutput, LevelBoundaries};
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::units::telling;
use gdcm_plot::figure::requirements::{bandwidth_pairs, bandwidth_place};
use gdcm_plot::figure::{Color, Figure, MarkId};
use gdcm_study::jobs::requirement_jobs::RequirementsJob;
use gdcm_study::results::required_bandwidth::BandwidthFinding;
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::Table;
use gdcm_words::missing_results::{missing_reason_text, reversed_phase_text};

use super::figures::figure_of;
use super::histories::histories_ui;
use super::need::Need;
use super::over_time::{current, over_time_need, time_histories_job};
use super::requirement_limits::{decided, mode_tolerances_ui, overview_limits_ui};
use super::requirement_tables::page_tables;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::canvas::figure_legend_ui;
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::{FigureEvent, FigureScene, FigureWords, figure_ui};
use crate::gui::state::forms::RequirementTable;
use crate::gui::state::requirements_page::RequirementsPage;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::{check_ui, page_tab_ui};
use crate::gui::widgets::controls::{button_ui, restore_panel_size};
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::tables::{TableClick, TableLook, table_grid_ui};

/// Text above every page.
pub(super) const NO_QUALIFICATION: &str =
    "These values describe models and do not replace a qualification (docs/requirements.md)";
/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 150.0);
/// Initial table height, as a share of the view's height.
const TABLE_PART: f32 = 0.34;

/// Draws the page tabs, from right to left.
pub fn requirements_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.judging.requirements_page;
    let pages = [
        (
            RequirementsPage::Summary,
            "summary",
            "Corrected models compared with identified models: mean J, shares of the band inside \
            the MUAD envelopes, deviations over time",
        ),
        (
            RequirementsPage::Modes,
            "modes",
            "Modes of the condition and their tolerances",
        ),
        (
            RequirementsPage::Histories,
            "in time",
            "Flight records with tolerances, or responses to a step or a doublet",
        ),
        (
            RequirementsPage::Bandwidth,
            "bandwidth",
            "Bandwidth and phase delay of the attitudes (ADS-33E-PRF)",
        ),
    ];
    for (page, name, purpose) in pages {
        let (_, is_clicked) = page_tab_ui(ui, page == shown, name, (name, purpose));
        if is_clicked {
            commands.push(DisplayCommand::ShowRequirements(page).into());
        }
    }
}

/// Returns the job for the displayed requirements; `None` until there is an analysis.
pub fn requirements_job(state: &State) -> Option<RequirementsJob> {
    let analysis = current(state)?;
    Some(RequirementsJob {
        analysis: analysis.into(),
        uncertainty: state.uncertainty().cloned().map(Into::into),
        settings: Arc::clone(&state.study.requirements),
        known: state.records.known_poles(),
    })
}

/// Returns the computations needed by the selected page.
pub fn requirements_needs(state: &State) -> Vec<Need> {
    let page = state.display.judging.requirements_page;
    if page == RequirementsPage::Histories {
        return over_time_need(state).into_iter().collect();
    }
    let mut needs = Vec::new();
    needs.extend(requirements_job(state).map(Need::Requirements));
    if page == RequirementsPage::Summary {
        needs.extend(time_histories_job(state).map(Need::TimeHistories));
    }
    needs
}

/// Draws the selected page below the notes that concern all pages.
pub fn requirements_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    if state.display.judging.requirements_page == RequirementsPage::Histories {
        return histories_ui(ui, state, palette, commands);
    }
    let Some(requirements) = state.requirements().cloned() else {
        ui.label(palette.dim(state.results.absence()));
        return;
    };
    let view = RequirementsView {
        requirements: &requirements,
        palette,
    };
    view.reservations_ui(ui, state.dataset());
    match state.display.judging.requirements_page {
        RequirementsPage::Bandwidth => {
            bandwidth_inputs_ui(ui, state, palette, commands);
            restore_panel_size(ui, "requirements");
            let size = TABLE_PART * ui.available_height();
            let panel = Panel::bottom("requirements")
                .resizable(true)
                .default_size(size)
                .min_size(60.0);
            panel.show(ui, |ui| view.tables_ui(ui, state, commands));
            view.plots_ui(ui, state, commands);
        }
        RequirementsPage::Modes => {
            let title =
                CollapsingHeader::new("Tolerances of modes").id_salt("edited tolerances of modes");
            title.show(ui, |ui| mode_tolerances_ui(ui, state, palette, commands));
            view.tables_ui(ui, state, commands);
        }
        RequirementsPage::Histories | RequirementsPage::Summary => {
            let title = CollapsingHeader::new("Limits of the overview")
                .id_salt("edited limits of the overview");
            title.show(ui, |ui| overview_limits_ui(ui, state, palette, commands));
            view.tables_ui(ui, state, commands);
        }
    }
}

/// Draws the settings of the bandwidth requirements: which attitudes are commanded by a stick, and
/// the engineer's levels.
fn bandwidth_inputs_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.label(palette.small("attitude command:"));
        attitude_commands_ui(ui, state, commands);
        ui.separator();
        levels_ui(ui, state, palette, commands);
    });
}

/// Draws a check box for each attitude that may be commanded by a stick.
fn attitude_commands_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut outputs = BTreeSet::new();
    for pair in state.dataset().measuring_pairs().marked() {
        outputs.insert(pair.output);
    }
    for output in outputs {
        let channel = &state.dataset().outputs()[output];
        if AttitudeOutput::of(channel).is_err() {
            continue;
        }
        let name = &channel.name;
        let is_on = state.study.requirements.attitude_command.contains(name);
        let hint = "The stick commands the attitude instead of its rate; the phase margin alone then determines the bandwidth";
        if let Some(is_on) = check_ui(ui, is_on, format!("attitude of {name}"), hint) {
            commands.push(decided(state, "attitude command", |settings| {
                if is_on {
                    settings.attitude_command.insert(name.clone());
                } else {
                    settings.attitude_command.remove(name);
                }
            }));
        }
    }
}

/// Draws the number of level boundaries, and the buttons that remove them or read them from a file.
fn levels_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let levels = state.study.requirements.levels.all().len();
    let text = if levels == 0 {
        "levels: none".to_owned()
    } else {
        format!("levels: {levels}")
    };
    ui.label(palette.small(text));
    if levels > 0 && ui.small_button("Remove levels").clicked() {
        commands.push(decided(state, "levels", |settings| {
            settings.levels = LevelBoundaries::default();
        }));
    }
    let hint = "Reads levels from a file. None are built in, because they depend on the task and the category (docs/requirements.md)";
    let ask = FileCommand::AskRequirementTable(RequirementTable::Levels);
    button_ui(ui, Button::new("Levels…").small(), hint, ask, commands);
}

/// Context for drawing the computed requirements.
struct RequirementsView<'a> {
    requirements: &'a Requirements,
    palette: &'a Palette,
}

impl RequirementsView<'_> {
    /// Draws a line for each kind of missing result, and the reservations about the available
    /// results.
    fn reservations_ui(&self, ui: &mut Ui, dataset: &Dataset) {
        let mut lines = Vec::new();
        for missing in &self.requirements.missing {
            let condition = match missing.condition {
                Some(id) => format!("Condition {id}: "),
                None => String::new(),
            };
            let why = missing_reason_text(&missing.why);
            lines.push(format!("{condition}no {}: {why}", missing.what));
        }
        for caution in &self.requirements.cautions {
            lines.push(format!(
                "⚠ Condition {}: {}",
                caution.condition,
                reversed_phase_text(caution, dataset)
            ));
        }
        for line in lines {
            ui.add(Label::new(self.palette.small_warning(&line)).truncate())
                .on_hover_text(line);
        }
    }

    /// Draws phase delay over bandwidth; a click on a mark shows the response in the Bode view.
    fn plots_ui(&self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
        let figure: Figure = figure_of(state, View::Requirements).unwrap_or_default();
        let pairs = bandwidth_pairs(self.requirements);
        figure_legend_ui(ui, &figure, self.palette);
        let mut view = state
            .display
            .figures
            .remove(&View::Requirements)
            .unwrap_or_default();
        let message = "No on-axis response is an angle or an angular rate, or none crosses −135° \
            and −180°. The table lists the reasons";
        let words = BandwidthWords {
            state,
            requirements: self.requirements,
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
        for event in figure_ui(ui, &scene, &mut view, self.palette) {
            if let FigureEvent::Clicked(plot, MarkId::Condition(condition), _) = event
                && let Some(pair) = pairs.get(plot)
            {
                let mut model = BandwidthModel {
                    condition,
                    pair: *pair,
                    role: RequirementRole::Corrected,
                };
                if let Some(place) = view.pointed_at()
                    && let Some(role) = role_at(self.requirements, model, place)
                {
                    model.role = role;
                }
                commands.extend(bode_commands(self.requirements, model));
            }
        }
        state.display.figures.insert(View::Requirements, view);
    }

    /// Draws the tables of the page; a click on a row shows its response or condition.
    fn tables_ui(&self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
        let condition = state.condition().id();
        let mut sortings = state.display.judging.requirements_sorting;
        ScrollArea::both()
            .id_salt("requirement tables")
            .auto_shrink(false)
            .show(ui, |ui| {
                let pages = page_tables(state, self.requirements);
                for (page, sorting) in pages.into_iter().zip(&mut sortings) {
                    let table = &page.table;
                    ui.add(Label::new(self.palette.small(&table.title)).extend());
                    if table.rows.is_empty() {
                        ui.label(self.palette.dim(self.absence_of_rows(state)));
                        continue;
                    }
                    let look = TableLook {
                        color: &|row, column| {
                            let hue = page.hue(row, column)?;
                            Some(self.palette.color(Color::of(hue)))
                        },
                        selected: &|row| {
                            table.columns[0] == "condition"
                                && table.rows[row][0] == condition.to_string()
                        },
                    };
                    let click = table_grid_ui(ui, table, sorting, &look, self.palette, commands);
                    if let Some(click) = click {
                        commands.extend(self.click_commands(state, table, click));
                    }
                    ui.add_space(8.0);
                }
            });
        state.display.judging.requirements_sorting = sortings;
    }

    /// Returns why a table has no rows.
    fn absence_of_rows(&self, state: &State) -> String {
        if state.display.judging.requirements_page == RequirementsPage::Modes
            && let Some(why) = self.requirements.no_modes(state.condition().id())
        {
            return missing_reason_text(why);
        }
        "No condition has a result".to_owned()
    }

    /// Returns the commands for a click on a row.
    fn click_commands(&self, state: &State, table: &Table, click: TableClick) -> Vec<Command> {
        match state.display.judging.requirements_page {
            RequirementsPage::Bandwidth => match self.requirements.bandwidth.get(click.row) {
                Some(finding) => bode_commands(self.requirements, BandwidthModel::new(finding)),
                None => Vec::new(),
            },
            RequirementsPage::Histories | RequirementsPage::Summary => {
                match clicked_condition(table, click) {
                    Some(id) => vec![SelectionCommand::SelectCondition(id).into()],
                    None => Vec::new(),
                }
            }
            RequirementsPage::Modes => vec![LayoutCommand::ShowView(View::Poles).into()],
        }
    }
}

/// Returns the clicked condition, which is a row in the summary and a column in the overview.
fn clicked_condition(table: &Table, click: TableClick) -> Option<ConditionId> {
    if let Some(cells) = table.rows.get(click.row)
        && let Ok(id) = cells[0].parse()
    {
        return Some(ConditionId(id));
    }
    table.columns[click.column].parse().ok().map(ConditionId)
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
    fn plot(&self, plot: usize) -> String {
        let name = match self.pairs.get(plot) {
            Some(pair) => self.state.dataset().pair_name(*pair),
            None => String::new(),
        };
        format!("Phase delay over bandwidth of {name}")
    }

    fn pointed(&self, plot: usize, id: &MarkId, _: [f64; 2]) -> Option<String> {
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
