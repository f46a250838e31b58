//! Requirements: the questions of a qualification after J, of physics, corrected, scheduled and identified models side by side (M17).

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Button, Color32, Label, Panel, Ui, Vec2, vec2};
use gdcm_core::dataset::{ConditionId, Pair};
use gdcm_core::requirements::{AttitudeOutput, LevelBoundaries, ModeVerdict};
use gdcm_core::study::{
    Edit, HistoryRecords, RequirementRole, RequirementSettings, Requirements, RequirementsJob, Table, TimeHistoriesJob,
};
use gdcm_core::units::{s_to_ms, telling};
use gdcm_files::figure::{Figure, FigureKind, MarkId, bandwidth_pairs};

use super::{Need, View, histories_ui, over_time_need};
use crate::view::CurveCommand;
use crate::view::command::{Command, RequirementTable};
use crate::view::controls::{button_ui, check_ui, page_tab_ui, restore_panel_size};
use crate::view::figures::figure_of;
use crate::view::palette::Palette;
use crate::view::plot::{FigureEvent, FigureScene, FigureWords, figure_legend_ui, figure_ui};
use crate::view::records::ConditionRecords;
use crate::view::state::State;
use crate::view::table_view::{TableLook, table_ui};

/// What stands over every page.
pub(super) const NO_QUALIFICATION: &str =
    "Of the models, not of the aircraft: these numbers are no qualification. Sources in docs/requirements.md.";
/// A plot is never smaller \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 150.0);
/// Part of the height that the table has at first.
const TABLE_PART: f32 = 0.34;

/// Which question is answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RequirementsPage {
    /// Bandwidth and phase delay of every response, condition and model.
    #[default]
    Bandwidth,
    /// What the models of the condition shown answer over time.
    Histories,
    /// Modes of the condition shown.
    Modes,
    /// Mean J and shares of the band of every condition and model.
    Summary,
}

/// Which question is answered. Laid out from right to left.
pub fn requirements_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.requirements_page;
    let pages = [
        (
            RequirementsPage::Summary,
            "summary",
            "Mean J, shares of the band inside the MUAD envelopes, errors over time",
        ),
        (RequirementsPage::Modes, "modes", "Modes of the condition, against their tolerances"),
        (RequirementsPage::Histories, "in time", "Flight records within tolerances, or answers to a step or a doublet"),
        (RequirementsPage::Bandwidth, "bandwidth", "Bandwidth and phase delay of the attitudes (ADS-33E-PRF)"),
    ];
    for (page, name, purpose) in pages {
        let (_, is_clicked) = page_tab_ui(ui, page == shown, name, (name, purpose));
        commands.extend(is_clicked.then_some(Command::ShowRequirements(page)));
    }
}

/// The job of what is shown; none until there is an analysis.
pub fn requirements_job(state: &State) -> Option<RequirementsJob> {
    let analysis = state.results.analysis.clone().filter(|_| state.analysis().is_some())?;
    Some(RequirementsJob {
        analysis,
        uncertainty: state.uncertainty().cloned(),
        settings: Arc::clone(&state.study.requirements),
    })
}

/// What the page that is chosen has to have computed.
pub fn requirements_needs(state: &State) -> Vec<Need> {
    match state.display.requirements_page {
        RequirementsPage::Histories => over_time_need(state).into_iter().collect(),
        page => {
            let of_records = time_histories_job(state).filter(|_| page == RequirementsPage::Summary);
            let asked = requirements_job(state).map(Need::Requirements);
            asked.into_iter().chain(of_records.map(Need::TimeHistories)).collect()
        }
    }
}

/// The flight records of every condition that are used.
pub fn all_records(state: &State) -> Vec<HistoryRecords> {
    let of_condition = |(id, records): (&ConditionId, &ConditionRecords)| {
        HistoryRecords::of(*id, &records.rows, records.preparation())
    };
    let all = state.records.conditions.iter().map(of_condition);
    all.filter(|of| !of.records.is_empty()).collect()
}

/// The answers of all models to all records; none where there are none.
fn time_histories_job(state: &State) -> Option<TimeHistoriesJob> {
    let analysis = state.results.analysis.clone().filter(|_| state.analysis().is_some())?;
    let records = all_records(state);
    let tolerances = state.study.requirements.tolerances.clone();
    (!records.is_empty()).then_some(TimeHistoriesJob { analysis, records, tolerances })
}

/// The page that is chosen, below what has to be known of all of them.
pub fn requirements_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    if state.display.requirements_page == RequirementsPage::Histories {
        return histories_ui(ui, state, palette, commands);
    }
    let Some(requirements) = state.requirements().cloned() else {
        return drop(ui.label(palette.dim(state.results.absence())));
    };
    known_ui(ui, &requirements, palette);
    if state.display.requirements_page != RequirementsPage::Bandwidth {
        return requirements_table_ui(ui, state, &requirements, palette, commands);
    }
    asked_ui(ui, state, palette, commands);
    restore_panel_size(ui, "requirements");
    let size = TABLE_PART * ui.available_height();
    let panel = Panel::bottom("requirements").resizable(true).default_size(size).min_size(60.0);
    panel.show(ui, |ui| requirements_table_ui(ui, state, &requirements, palette, commands));
    plots_ui(ui, state, &requirements, palette, commands);
}

/// What has no answer, and what has to be known of the answers.
fn known_ui(ui: &mut Ui, requirements: &Requirements, palette: &Palette) {
    for missing in &requirements.missing {
        let condition = missing.condition.map_or_else(String::new, |id| format!("Condition {id}: "));
        ui.add(
            Label::new(palette.small_warning(format!("{condition}no {}: {}", missing.what, missing.why))).truncate(),
        );
    }
    for caution in &requirements.cautions {
        let words = format!("⚠ Condition {}: {}", caution.condition, caution.text);
        ui.add(Label::new(palette.small_warning(&words)).truncate()).on_hover_text(words);
    }
}

/// What bandwidths are asked with: which sticks command an attitude, and the engineer's levels.
fn asked_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let settings = &state.study.requirements;
    let decided = |what: &'static str, change: &dyn Fn(&mut RequirementSettings)| {
        let mut changed = RequirementSettings::clone(settings);
        change(&mut changed);
        Command::from(Edit::SetRequirements(what, Arc::new(changed)))
    };
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
        let ask = Command::AskRequirementTable(RequirementTable::Levels);
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
    let mut view = state.display.figures.remove(&View::Requirements).unwrap_or_default();
    let scene = FigureScene {
        name: "requirements",
        figure: &figure,
        selected: Some(MarkId::Condition(state.condition().id())),
        highlighted: None,
        columns: &[],
        zooms: true,
        is_compact: false,
        accented: pairs.iter().position(|pair| *pair == state.display.pair),
        least: LEAST_PLOT,
        message: "No on-axis response is of an angle or its rate, or none crosses −135° and −180°: the table says why",
        words: (&BandwidthWords { state, requirements, pairs: &pairs }, 0),
    };
    for event in figure_ui(ui, &scene, &mut view, palette) {
        if let FigureEvent::Clicked(plot, MarkId::Condition(id), _) = event
            && let Some(pair) = pairs.get(plot)
        {
            commands.extend(marked_in_bode(requirements, *pair, id));
        }
    }
    state.display.figures.insert(View::Requirements, view);
}

/// The response in focus in Bode, with the frequencies marked that its bandwidth and phase delay are read at.
fn marked_in_bode(requirements: &Requirements, pair: Pair, id: ConditionId) -> Vec<Command> {
    let mut commands = vec![Command::SelectCondition(id), Command::FocusPair(pair), CurveCommand::UnpinCursors.into()];
    if let Some(of) = requirements.bandwidth_of(id, pair, RequirementRole::Corrected) {
        let crossings =
            [("ω_phase", of.omega_phase_rad_s), ("ω_gain", of.omega_gain_rad_s), ("ω180", of.omega_180_rad_s)];
        let known = crossings.into_iter().filter_map(|(name, omega)| Some((name, omega?)));
        commands.push(CurveCommand::MarkCrossings(known.collect()).into());
    }
    commands.push(Command::ShowView(View::Bode));
    commands
}

fn requirements_table_ui(
    ui: &mut Ui,
    state: &mut State,
    requirements: &Requirements,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let id = state.condition().id();
    let (table, color) = match state.display.requirements_page {
        RequirementsPage::Bandwidth => (requirements.bandwidth_table(state.dataset()), CellColor::None),
        RequirementsPage::Modes => (requirements.mode_table(id), CellColor::Modes),
        RequirementsPage::Histories | RequirementsPage::Summary => {
            let histories = state.time_histories().filter(|_| time_histories_job(state).is_some());
            (requirements.summary_table(histories.map(Arc::as_ref)), CellColor::Summary)
        }
    };
    ui.add(Label::new(palette.small(&table.title)).truncate());
    if table.rows.is_empty() {
        return drop(ui.label(palette.dim("Nothing: one of the two models has no matrices, or was not analysed.")));
    }
    let color = |row: usize, column: usize| color.of(requirements, &table, (row, column), palette);
    let selected = |row: usize| table.columns[0] == "condition" && table.rows[row][0] == id.to_string();
    let look = TableLook { color: &color, selected: &selected };
    let mut sorting = state.display.requirements_sorting;
    if let Some(click) = table_ui(ui, &table, &mut sorting, &look, palette, commands) {
        commands.extend(went_to(state, requirements, (&table, click.row)));
    }
    state.display.requirements_sorting = sorting;
}

/// Where a click on a row goes.
fn went_to(state: &State, requirements: &Requirements, (table, row): (&Table, usize)) -> Vec<Command> {
    match state.display.requirements_page {
        RequirementsPage::Bandwidth => {
            let of = requirements.bandwidth.get(row);
            of.map(|of| marked_in_bode(requirements, of.pair, of.condition)).unwrap_or_default()
        }
        RequirementsPage::Histories | RequirementsPage::Summary => {
            let id = table.rows.get(row).and_then(|cells| cells[0].parse().ok());
            id.map(|id| Command::SelectCondition(ConditionId(id))).into_iter().collect()
        }
        RequirementsPage::Modes => vec![Command::ShowView(View::Poles)],
    }
}

/// How the cells of a table are coloured.
#[derive(Clone, Copy)]
enum CellColor {
    None,
    /// Beyond the tolerance: warning; within it: good.
    Modes,
    /// Mean J above 100, the limit of what is acceptable (M4): warning.
    Summary,
}

impl CellColor {
    fn of(
        self,
        requirements: &Requirements,
        table: &Table,
        (row, column): (usize, usize),
        palette: &Palette,
    ) -> Option<Color32> {
        let heading = table.columns[column].as_str();
        match self {
            Self::None => {
                let of = requirements.bandwidth.get(row)?;
                let name =
                    ["omega_bw_rad_s", "omega_phase_rad_s", "omega_gain_rad_s", "omega_180_rad_s", "phase_delay_s"];
                let rests = |name: &&&str| of.rests_above(name);
                name.get(column.checked_sub(4)?).filter(rests).map(|_| palette.dim_text)
            }
            Self::Modes if heading.ends_with(": tolerance") => {
                let cell = &table.rows[row][column];
                let is = |verdict: ModeVerdict| cell.starts_with(verdict.words());
                let color = if is(ModeVerdict::Within) { palette.good } else { palette.dim_text };
                Some(if is(ModeVerdict::Outside) { palette.warning } else { color })
            }
            Self::Summary if heading.starts_with('J') => {
                let of = requirements.summary_of(&table.rows[row])?;
                let cost = if heading == "J on-axis" { of.mean_j_on_axis } else { of.mean_j_all };
                cost.map(|cost| if cost > ACCEPTABLE { palette.warning } else { palette.good })
            }
            _ => None,
        }
    }
}

/// J up to which a model is acceptable (M4).
const ACCEPTABLE: f64 = 100.0;

/// What the plots of bandwidth say.
struct BandwidthWords<'a> {
    state: &'a State,
    requirements: &'a Requirements,
    pairs: &'a [Pair],
}

impl FigureWords for BandwidthWords<'_> {
    fn plot(&self, plot: usize) -> String {
        let name = self.pairs.get(plot).map_or_else(String::new, |pair| self.state.dataset().pair_name(*pair));
        format!("Phase delay over bandwidth of {name}")
    }

    fn pointed(&self, plot: usize, id: &MarkId, _: [f64; 2]) -> Option<String> {
        let (MarkId::Condition(id), pair) = (id, self.pairs.get(plot)?) else { return None };
        let of_role = |role: RequirementRole| {
            let of = self.requirements.bandwidth_of(*id, *pair, role)?;
            let (bandwidth, delay_s) = of.omega_bw_rad_s.zip(of.phase_delay_s)?;
            Some(format!("{} {} rad/s, {} ms", role.name(), telling(bandwidth, 2), telling(s_to_ms(delay_s), 0)))
        };
        let roles: Vec<String> = RequirementRole::ALL.into_iter().filter_map(of_role).collect();
        Some(format!("condition {id} · {} · click: marked in Bode", roles.join(" · ")))
    }
}

/// The requirements for a figure.
pub fn shown_requirements(state: &State, kind: FigureKind) -> Option<Arc<Requirements>> {
    state.requirements().filter(|_| kind == FigureKind::Requirements).cloned()
}
