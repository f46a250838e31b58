//! Couplings: input mixing and output feedback, their benefit, and their effect on the loop.

use std::sync::Arc;

use egui::{Label, Panel, RichText, ScrollArea, Ui, vec2};

use gdcm_method::couplings::LEAST_CONDITIONS;
use gdcm_model::dataset::Dataset;
use gdcm_model::number_format::with_minus_sign;
use gdcm_model::units::telling;
use gdcm_study::decisions::setting;
use gdcm_study::jobs::analysis_jobs::CouplingsJob;
use gdcm_study::results::couplings_assessment::{CouplingCost, CouplingsAssessment};
use gdcm_study::{CouplingCorrection, PhaseCorrection};
use gdcm_words::Table;
use gdcm_words::couplings::{
    coupling_cost_table, coupling_matrix_tables, coupling_remarks, pole_table,
};
use gdcm_words::remark::RemarkKind;

use super::figures::request;
use super::frequency::condition_source;
use crate::gui::commands::command::Command;
use crate::gui::plot::canvas::figure_legend_ui;
use crate::gui::plot::{FigureScene, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::controls::restore_panel_size;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::gui::widgets::tables::{Sorting, TableLook, table_grid_ui};

/// Share of the width taken by words and tables.
const WORDS_PART: f32 = 0.56;

/// Draws the selection of the fitted couplings.
pub fn couplings_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.study.settings.couplings;
    let mut chosen = shown;
    let choices = [
        (
            CouplingCorrection::None,
            "none",
            "Gains, delays and leads of the channels alone (the paper)",
        ),
        (
            CouplingCorrection::Mixing,
            "mixing",
            "Each input takes constant shares of the others (M16)",
        ),
        (
            CouplingCorrection::MixingAndFeedback,
            "mixing and feedback",
            "Inputs take shares of inputs and outputs (M16)",
        ),
    ];
    choice_ui(ui, "Couplings of the physics models", &mut chosen, &choices);
    if chosen != shown {
        commands.push(setting::COUPLINGS.to(chosen).into());
    }
}

/// Returns the job that assesses the couplings.
pub fn couplings_job(state: &State) -> CouplingsJob {
    CouplingsJob {
        study: state.study.clone(),
        couplings: state.assessed_couplings(),
    }
}

/// Returns whether couplings are assessed in every view: couplings in use, for their cost; unused
/// couplings, once delays are matched or leads are requested and there are enough conditions (three
/// or more), because they may be worth an offer.
pub fn are_couplings_judged(state: &State) -> bool {
    let settings = &state.study.settings;
    let Some(analysis) = state.analysis().filter(|_| !state.results.is_behind()) else {
        return false;
    };
    let results = || analysis.conditions.values().flatten();
    let is_left = match settings.phase {
        PhaseCorrection::None => false,
        PhaseCorrection::Delay => results().all(|result| result.delays.matched),
        PhaseCorrection::Lead => true,
    };
    settings.couplings != CouplingCorrection::None
        || is_left && results().count() >= LEAST_CONDITIONS
}

/// Returns the off-axis benefit of unused couplings, if worthwhile by J of left-out conditions.
pub fn offered_couplings(state: &State) -> Option<(&Arc<CouplingsAssessment>, CouplingCost)> {
    let is_used = state.study.settings.couplings != CouplingCorrection::None;
    let assessment = state
        .couplings()
        .filter(|_| !is_used && are_couplings_judged(state))?
        .as_ref()
        .ok()?;
    Some((
        assessment,
        assessment
            .costs
            .left_out
            .filter(CouplingCost::is_worth_it)?,
    ))
}

/// Returns the assessment of the couplings in use, once known.
pub fn used_couplings(state: &State) -> Option<&Arc<CouplingsAssessment>> {
    let is_used = state.study.settings.couplings != CouplingCorrection::None;
    state.couplings().filter(|_| is_used)?.as_ref().ok()
}

/// Draws words and tables at the left, the loop and the poles at the right.
pub fn couplings_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let found = state.couplings().cloned();
    let assessment = match found {
        Some(Ok(assessment)) => assessment,
        Some(Err(why)) => {
            let why = why.words(&state.dataset().names_of_channels().0);
            return drop(ui.add(Label::new(palette.dim(format!("No couplings: {why}."))).wrap()));
        }
        None => return drop(ui.label(palette.dim(state.results.absence()))),
    };
    restore_panel_size(ui, "couplings");
    let width = WORDS_PART * ui.available_width();
    let panel = Panel::left("couplings")
        .resizable(true)
        .default_size(width)
        .min_size(260.0);
    panel.show(ui, |ui| {
        ScrollArea::vertical()
            .id_salt("couplings in words")
            .auto_shrink(false)
            .show(ui, |ui| {
                use_ui(ui, state, &assessment, palette, commands);
                // The deciding figures come first.
                let costs = Table {
                    title: "J, mean over the conditions".to_owned(),
                    ..coupling_cost_table(&assessment)
                };
                table_part_ui(ui, &costs, TableLook::PLAIN.color, palette, commands);
                words_ui(ui, state, &assessment, palette);
                tables_ui(ui, state, &assessment, palette, commands);
            });
    });
    let request = request(state, View::Couplings);
    let figure = request
        .and_then(|request| request.figure(None, condition_source(state).as_ref()))
        .unwrap_or_default();
    let mut view = state
        .display
        .figures
        .remove(&View::Couplings)
        .unwrap_or_default();
    let scene = FigureScene::new(
        "couplings",
        &figure,
        vec2(220.0, 150.0),
        state.results.absence(),
        &figure,
    );
    let scene = FigureScene {
        zooms: true,
        ..scene
    };
    figure_legend_ui(ui, &figure, palette);
    figure_ui(ui, &scene, &mut view, palette);
    state.display.figures.insert(View::Couplings, view);
}

/// Draws whether the couplings are used, and the link that uses them, or removes them if they are
/// not worthwhile.
fn use_ui(
    ui: &mut Ui,
    state: &State,
    assessment: &CouplingsAssessment,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let is_used = state.study.settings.couplings != CouplingCorrection::None;
    let (label, couplings) = if is_used {
        (
            "Switch the couplings off".to_owned(),
            CouplingCorrection::None,
        )
    } else {
        let name = assessment.couplings.name();
        ui.label(palette.dim(format!("None are used. What {name} would do:")));
        (format!("Use {name}"), assessment.couplings)
    };
    if is_used && assessment.deciding_cost().is_worth_it() {
        return;
    }
    if ui
        .button(label)
        .on_hover_text("In every condition; undo takes it back")
        .clicked()
    {
        commands.push(setting::COUPLINGS.to(couplings).into());
    }
}

fn words_ui(ui: &mut Ui, state: &State, assessment: &CouplingsAssessment, palette: &Palette) {
    ui.add_space(6.0);
    for remark in coupling_remarks(assessment, state.dataset()) {
        let words = match remark.kind {
            RemarkKind::Good => RichText::new(&remark.text).color(palette.text),
            _ => RichText::new(format!("⚠ {}", remark.text)).color(palette.warning),
        };
        let words = if remark.kind == RemarkKind::Trouble {
            words.font(medium(BODY_SIZE))
        } else {
            words
        };
        ui.add_space(2.0);
        ui.add(Label::new(words).wrap());
    }
    if let Err(why) = assessment
        .conditions
        .get(&state.condition().id())
        .map_or(Ok(()), |of| of.poles.as_ref().map(drop))
    {
        ui.add(Label::new(palette.dim(format!("Poles of this condition: {why}"))).wrap());
    }
}

fn tables_ui(
    ui: &mut Ui,
    state: &State,
    assessment: &CouplingsAssessment,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    for table in coupling_matrix_tables(assessment, state.dataset()) {
        // Values within their error bar are indistinguishable from zero.
        let dim = |row: usize, column: usize| {
            table.rows[row][column]
                .starts_with('(')
                .then_some(palette.dim_text)
        };
        table_part_ui(ui, &table, &dim, palette, commands);
    }
    let others = [
        above_band_table(state.dataset(), assessment),
        poles_of_condition(state, assessment),
    ];
    for table in others.iter().filter(|table| !table.rows.is_empty()) {
        table_part_ui(ui, table, TableLook::PLAIN.color, palette, commands);
    }
}

fn table_part_ui(
    ui: &mut Ui,
    table: &Table,
    color: &dyn Fn(usize, usize) -> Option<egui::Color32>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.add_space(10.0);
    ui.add(Label::new(RichText::new(&table.title).font(medium(BODY_SIZE))).wrap());
    let look = TableLook {
        color,
        ..TableLook::PLAIN
    };
    ScrollArea::horizontal()
        .id_salt(("couplings", &table.title))
        .show(ui, |ui| {
            ui.spacing_mut().interact_size.y = 16.0;
            table_grid_ui(ui, table, &mut Sorting::default(), &look, palette, commands);
        });
}

/// Builds the table of the couplings' effect at ten times the band on the constrained responses of
/// each condition, with the least singular value of its loop.
fn above_band_table(dataset: &Dataset, assessment: &CouplingsAssessment) -> Table {
    let columns = [
        "condition",
        "least singular value",
        "at [rad/s]",
        "above the band [dB]",
        "of",
    ];
    let mut table = Table::new("The loop of each condition", columns);
    for (id, of) in &assessment.conditions {
        let margin = of
            .margin
            .map(|margin| [telling(margin.least, 2), telling(margin.omega_rad_s, 1)]);
        let [least, at] = margin.unwrap_or_default();
        let most = of.most_changed_above_band(dataset.on_axis());
        let (change, pair) = most.map_or((String::new(), String::new()), |(pair, change_db)| {
            (
                with_minus_sign(&telling(change_db, 1)),
                dataset.pair_name(pair),
            )
        });
        table.row([id.to_string(), least, at, change, pair]);
    }
    table
}

/// Returns the pole table's rows of the displayed condition.
fn poles_of_condition(state: &State, assessment: &CouplingsAssessment) -> Table {
    let id = state.condition().id().to_string();
    let mut table = pole_table(assessment);
    table.rows.retain(|row| row[0] == id);
    table.rows.iter_mut().for_each(|row| drop(row.remove(0)));
    table.columns.remove(0);
    Table {
        title: format!("Poles of the physics representative of condition {id}"),
        ..table
    }
}
