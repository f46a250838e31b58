//! Requirements: the questions of a qualification beyond J, for physics, corrected, scheduled and
//! identified models side by side (M17).

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Button, CollapsingHeader, Label, Panel, ScrollArea, Ui, Vec2, vec2};

use gdcm_method::fidelity::ACCEPTABLE;
use gdcm_method::requirements::{AttitudeOutput, LevelBoundaries, ModeVerdict};
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::units::{s_to_ms, telling};
use gdcm_plot::figure::drawing::Hue;
use gdcm_plot::figure::requirements::{bandwidth_pairs, bandwidth_place};
use gdcm_plot::figure::{Color, Figure, MarkId};
use gdcm_study::decisions::requirement_settings::RequirementSettings;
use gdcm_study::jobs::requirement_jobs::{RequirementsJob, TimeHistoriesJob};
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::Table;
use gdcm_words::requirements::{
    RequirementsOverview, bandwidth_table, mode_table, mode_verdict_words, summary_of_row,
    summary_table,
};

use super::figures::figure_of;
use super::histories::histories_ui;
use super::need::Need;
use super::over_time::{current, over_time_need};
use super::requirement_limits::{decided, mode_tolerances_ui, overview_limits_ui};
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

/// Text at the top of every page.
pub(super) const NO_QUALIFICATION: &str = "Of the models, not of the aircraft: these numbers are no qualification. Sources in docs/requirements.md.";
/// Least size of a plot \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 150.0);
/// Initial share of the height taken by the table.
const TABLE_PART: f32 = 0.34;

/// Draws the tabs of the pages, from right to left.
pub fn requirements_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.judging.requirements_page;
    let pages = [
        (
            RequirementsPage::Summary,
            "summary",
            "Corrected against identified in every condition; mean J, shares inside the MUAD envelopes, errors over time",
        ),
        (
            RequirementsPage::Modes,
            "modes",
            "Modes of the condition, against their tolerances",
        ),
        (
            RequirementsPage::Histories,
            "in time",
            "Flight records within tolerances, or answers to a step or a doublet",
        ),
        (
            RequirementsPage::Bandwidth,
            "bandwidth",
            "Bandwidth and phase delay of the attitudes (ADS-33E-PRF)",
        ),
    ];
    for (page, name, purpose) in pages {
        let (_, is_clicked) = page_tab_ui(ui, page == shown, name, (name, purpose));
        commands
            .extend(is_clicked.then_some(Command::Display(DisplayCommand::ShowRequirements(page))));
    }
}

/// Returns the job of the displayed requirements; `None` until there is an analysis.
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
    match state.display.judging.requirements_page {
        RequirementsPage::Histories => over_time_need(state).into_iter().collect(),
        page => {
            let of_records =
                time_histories_job(state).filter(|_| page == RequirementsPage::Summary);
            let asked = requirements_job(state).map(Need::Requirements);
            asked
                .into_iter()
                .chain(of_records.map(Need::TimeHistories))
                .collect()
        }
    }
}

/// Returns the job of all models' responses to all records; `None` without records.
fn time_histories_job(state: &State) -> Option<TimeHistoriesJob> {
    let analysis = current(state)?;
    let records = state.records.history_records();
    let tolerances = state.study.requirements.tolerances.clone();
    (!records.is_empty()).then_some(TimeHistoriesJob {
        analysis: analysis.into(),
        records,
        tolerances,
    })
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
        return drop(ui.label(palette.dim(state.results.absence())));
    };
    known_ui(ui, &requirements, palette);
    match state.display.judging.requirements_page {
        RequirementsPage::Bandwidth => asked_ui(ui, state, palette, commands),
        RequirementsPage::Modes => {
            let title =
                CollapsingHeader::new("Tolerances of modes").id_salt("edited tolerances of modes");
            title.show(ui, |ui| mode_tolerances_ui(ui, state, palette, commands));
            return requirements_tables_ui(ui, state, &requirements, palette, commands);
        }
        RequirementsPage::Histories | RequirementsPage::Summary => {
            let title = CollapsingHeader::new("Limits of the overview")
                .id_salt("edited limits of the overview");
            title.show(ui, |ui| overview_limits_ui(ui, state, palette, commands));
            return requirements_tables_ui(ui, state, &requirements, palette, commands);
        }
    }
    restore_panel_size(ui, "requirements");
    let size = TABLE_PART * ui.available_height();
    let panel = Panel::bottom("requirements")
        .resizable(true)
        .default_size(size)
        .min_size(60.0);
    panel.show(ui, |ui| {
        requirements_tables_ui(ui, state, &requirements, palette, commands)
    });
    plots_ui(ui, state, &requirements, palette, commands);
}

/// Draws the missing answers, and the reservations about the others.
fn known_ui(ui: &mut Ui, requirements: &Requirements, palette: &Palette) {
    let missing = requirements.missing.iter().map(|missing| {
        let condition = missing
            .condition
            .map_or_else(String::new, |id| format!("Condition {id}: "));
        format!("{condition}no {}: {}", missing.what, missing.why)
    });
    let cautions = requirements
        .cautions
        .iter()
        .map(|of| format!("⚠ Condition {}: {}", of.condition, of.text));
    for words in missing.chain(cautions) {
        ui.add(Label::new(palette.small_warning(&words)).truncate())
            .on_hover_text(words);
    }
}

/// Draws the inputs of the bandwidths: the sticks that command an attitude, and the engineer's
/// levels.
fn asked_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let settings = &state.study.requirements;
    let decided = |what, change: &dyn Fn(&mut RequirementSettings)| decided(state, what, change);
    ui.horizontal_wrapped(|ui| {
        ui.label(palette.small("attitude command:"));
        let outputs = state.dataset().measuring_pairs().marked().map(|pair| pair.output).collect::<BTreeSet<_>>();
        for output in outputs {
            let name = &state.dataset().outputs()[output].name;
            if AttitudeOutput::of(&state.dataset().outputs()[output]).is_err() {
                continue;
            }
            let is_on = settings.attitude_command.contains(name);
            let hint =
                "The stick commands the attitude, not its rate: the bandwidth is then that of the phase margin alone";
            if let Some(is_on) = check_ui(ui, is_on, format!("attitude of {name}"), hint) {
                commands.push(decided("attitude command", &|settings| {
                    if is_on {
                        settings.attitude_command.insert(name.clone());
                    } else {
                        settings.attitude_command.remove(name);
                    }
                }));
            }
        }
        ui.separator();
        let levels = settings.levels.all().len();
        ui.label(palette.small(if levels == 0 { "levels: none".to_owned() } else { format!("levels: {levels}") }));
        if levels > 0 && ui.small_button("Remove levels").clicked() {
            commands.push(decided("levels", &|settings| settings.levels = LevelBoundaries::default()));
        }
        let hint = "Take the levels of a file: none is built in, for they depend on the task and the category (docs/requirements.md)";
        let ask = Command::File(FileCommand::AskRequirementTable(RequirementTable::Levels));
        button_ui(ui, Button::new("Levels…").small(), hint, ask, commands);
    });
}

fn plots_ui(
    ui: &mut Ui,
    state: &mut State,
    requirements: &Requirements,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let figure: Figure = figure_of(state, View::Requirements).unwrap_or_default();
    let pairs = bandwidth_pairs(requirements);
    figure_legend_ui(ui, &figure, palette);
    let mut view = state
        .display
        .figures
        .remove(&View::Requirements)
        .unwrap_or_default();
    let message = "No on-axis response is of an angle or its rate, or none crosses −135° and −180°: the table says why";
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
        if let FigureEvent::Clicked(plot, MarkId::Condition(id), _) = event
            && let Some(pair) = pairs.get(plot)
        {
            let role = view
                .pointed_at()
                .and_then(|at| role_at(requirements, (*pair, id), at));
            commands.extend(marked_in_bode(
                requirements,
                (*pair, id),
                role.unwrap_or(RequirementRole::Corrected),
            ));
        }
    }
    state.display.figures.insert(View::Requirements, view);
}

/// Returns the model whose mark is at a place of a plot.
fn role_at(
    requirements: &Requirements,
    (pair, id): (Pair, ConditionId),
    at: [f64; 2],
) -> Option<RequirementRole> {
    let is_at = |role: &RequirementRole| {
        requirements
            .bandwidth_of(id, pair, *role)
            .and_then(bandwidth_place)
            .is_some_and(|place| place == at)
    };
    // Of marks at the same place, the topmost.
    RequirementRole::ALL.into_iter().rev().find(is_at)
}

/// Shows the response in focus in Bode, with marks at the frequencies that define the bandwidth and
/// phase delay of a model.
fn marked_in_bode(
    requirements: &Requirements,
    (pair, id): (Pair, ConditionId),
    role: RequirementRole,
) -> Vec<Command> {
    let mut commands = vec![
        Command::Selection(SelectionCommand::SelectCondition(id)),
        Command::Selection(SelectionCommand::FocusPair(pair)),
        CurveCommand::UnpinCursors.into(),
    ];
    if let Some(of) = requirements.bandwidth_of(id, pair, role) {
        let crossings = [
            ("ω_phase", of.omega_phase_rad_s),
            ("ω_gain", of.omega_gain_rad_s),
            ("ω180", of.omega_180_rad_s),
        ];
        let known = crossings
            .into_iter()
            .filter_map(|(name, omega)| Some((name, omega?)));
        commands.push(CurveCommand::MarkCrossings(known.collect()).into());
    }
    commands.push(LayoutCommand::ShowView(View::Bode).into());
    commands
}

/// Table of the displayed page, with the colours of its cells.
struct ShownTable<'a> {
    table: Table,
    color: Box<dyn Fn(usize, usize) -> Option<Hue> + 'a>,
}

/// Returns the tables of the displayed page.
fn page_tables<'a>(state: &State, requirements: &'a Requirements) -> Vec<ShownTable<'a>> {
    let dataset = state.dataset();
    match state.display.judging.requirements_page {
        RequirementsPage::Bandwidth => {
            let table = bandwidth_table(requirements, dataset);
            vec![ShownTable {
                table,
                color: Box::new(|row, column| bandwidth_look(requirements, (row, column))),
            }]
        }
        RequirementsPage::Modes => {
            let table = mode_table(requirements, state.condition().id());
            let of_table = table.clone();
            vec![ShownTable {
                table,
                color: Box::new(move |row, column| mode_look(&of_table, (row, column))),
            }]
        }
        RequirementsPage::Histories | RequirementsPage::Summary => {
            let histories = state
                .time_histories()
                .filter(|_| time_histories_job(state).is_some())
                .map(Arc::as_ref);
            let overview = RequirementsOverview::new(
                requirements,
                dataset,
                histories,
                &state.study.requirements.overview,
            );
            let is_outside = {
                let overview = overview.clone();
                move |row, column| overview.is_outside(row, column).then_some(Hue::Warning)
            };
            let table = summary_table(requirements, histories);
            let of_table = table.clone();
            let of_summary =
                move |row, column| summary_look(requirements, &of_table, (row, column));
            vec![
                ShownTable {
                    table: overview.table,
                    color: Box::new(is_outside),
                },
                ShownTable {
                    table,
                    color: Box::new(of_summary),
                },
            ]
        }
    }
}

/// Returns the tables of the displayed page if it has no figure; `None` if it has a figure, or if
/// nothing is known yet.
pub fn requirement_tables(state: &State) -> Option<Vec<Table>> {
    let is_table = matches!(
        state.display.judging.requirements_page,
        RequirementsPage::Modes | RequirementsPage::Summary
    );
    let requirements = state.requirements().filter(|_| is_table)?;
    Some(
        page_tables(state, requirements)
            .into_iter()
            .map(|shown| shown.table)
            .collect(),
    )
}

fn requirements_tables_ui(
    ui: &mut Ui,
    state: &mut State,
    requirements: &Requirements,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let id = state.condition().id();
    let mut sorting = state.display.judging.requirements_sorting;
    ScrollArea::both()
        .id_salt("requirement tables")
        .auto_shrink(false)
        .show(ui, |ui| {
            for (ShownTable { table, color }, sorting) in page_tables(state, requirements)
                .into_iter()
                .zip(&mut sorting)
            {
                ui.add(Label::new(palette.small(&table.title)).extend());
                if table.rows.is_empty() {
                    let page = state.display.judging.requirements_page;
                    let why = requirements
                        .no_modes(id)
                        .filter(|_| page == RequirementsPage::Modes);
                    ui.label(palette.dim(why.unwrap_or("Nothing: no condition has a result.")));
                    continue;
                }
                let color = |row: usize, column: usize| {
                    color(row, column).map(|hue| palette.color(Color::of(hue)))
                };
                let selected = |row: usize| {
                    table.columns[0] == "condition" && table.rows[row][0] == id.to_string()
                };
                let look = TableLook {
                    color: &color,
                    selected: &selected,
                };
                if let Some(click) = table_grid_ui(ui, &table, sorting, &look, palette, commands) {
                    commands.extend(went_to(state, requirements, (&table, click)));
                }
                ui.add_space(8.0);
            }
        });
    state.display.judging.requirements_sorting = sorting;
}

/// Returns the command of a click on a row.
fn went_to(
    state: &State,
    requirements: &Requirements,
    (table, click): (&Table, TableClick),
) -> Vec<Command> {
    let TableClick { row, column } = click;
    match state.display.judging.requirements_page {
        RequirementsPage::Bandwidth => {
            let of = requirements.bandwidth.get(row);
            of.map(|of| marked_in_bode(requirements, (of.pair, of.condition), of.role))
                .unwrap_or_default()
        }
        RequirementsPage::Histories | RequirementsPage::Summary => {
            // Conditions are columns of the overview and rows of the other table.
            let of_row = table.rows.get(row).and_then(|cells| cells[0].parse().ok());
            let id = of_row.or_else(|| table.columns[column].parse().ok());
            id.map(|id| Command::Selection(SelectionCommand::SelectCondition(ConditionId(id))))
                .into_iter()
                .collect()
        }
        RequirementsPage::Modes => vec![Command::Layout(LayoutCommand::ShowView(View::Poles))],
    }
}

/// Returns grey for values that depend on the model above the band.
fn bandwidth_look(requirements: &Requirements, (row, column): (usize, usize)) -> Option<Hue> {
    let names = [
        "omega_bw_rad_s",
        "omega_phase_rad_s",
        "omega_gain_rad_s",
        "omega_180_rad_s",
        "phase_delay_s",
    ];
    let name = column.checked_sub(4).and_then(|at| names.get(at));
    let (name, of) = name.zip(requirements.bandwidth.get(row))?;
    of.rests_above(name).then_some(Hue::DimText)
}

/// Returns the colour of a mode inside or outside its tolerance; grey without a verdict.
fn mode_look(table: &Table, (row, column): (usize, usize)) -> Option<Hue> {
    if !table.columns[column].ends_with(": tolerance") {
        return None;
    }
    let is =
        |verdict: ModeVerdict| table.rows[row][column].starts_with(mode_verdict_words(verdict));
    Some(match (is(ModeVerdict::Within), is(ModeVerdict::Outside)) {
        (true, _) => Hue::Good,
        (_, true) => Hue::Warning,
        _ => Hue::DimText,
    })
}

/// Returns the colour of a mean J beyond the acceptable limit; there is no limit for the rms error.
fn summary_look(
    requirements: &Requirements,
    table: &Table,
    (row, column): (usize, usize),
) -> Option<Hue> {
    let of = summary_of_row(requirements, &table.rows[row]);
    let cost = match table.columns[column].as_str() {
        "J on-axis" => of.and_then(|of| of.mean_j_on_axis),
        "J of all" => of.and_then(|of| of.mean_j_all),
        _ => None,
    };
    cost.map(|cost| {
        if cost > ACCEPTABLE {
            Hue::Warning
        } else {
            Hue::Good
        }
    })
}

/// Descriptions of the bandwidth plots.
struct BandwidthWords<'a> {
    state: &'a State,
    requirements: &'a Requirements,
    pairs: &'a [Pair],
}

impl FigureWords for BandwidthWords<'_> {
    fn plot(&self, plot: usize) -> String {
        let name = self
            .pairs
            .get(plot)
            .map_or_else(String::new, |pair| self.state.dataset().pair_name(*pair));
        format!("Phase delay over bandwidth of {name}")
    }

    fn pointed(&self, plot: usize, id: &MarkId, _: [f64; 2]) -> Option<String> {
        let (MarkId::Condition(id), pair) = (id, self.pairs.get(plot)?) else {
            return None;
        };
        let of_role = |role: RequirementRole| {
            let of = self.requirements.bandwidth_of(*id, *pair, role)?;
            let (bandwidth, delay_s) = of.omega_bw_rad_s.zip(of.phase_delay_s)?;
            Some(format!(
                "{} {} rad/s, {} ms",
                role.name(),
                telling(bandwidth, 2),
                telling(s_to_ms(delay_s), 0)
            ))
        };
        let roles: Vec<String> = RequirementRole::ALL
            .into_iter()
            .filter_map(of_role)
            .collect();
        Some(format!(
            "condition {id} · {} · click: marked in Bode",
            roles.join(" · ")
        ))
    }
}
