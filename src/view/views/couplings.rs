//! Couplings: what mixes the inputs and feeds outputs back, what that is worth, and what it does to the loop.

use std::sync::Arc;

use egui::{Label, Panel, RichText, ScrollArea, Ui, vec2};
use gdcm_core::dataset::Dataset;
use gdcm_core::study::{
    AssessedCouplings, CouplingCorrection, CouplingsAssessment, CouplingsJob, PhaseCorrection, RemarkKind, Table,
    setting,
};
use gdcm_core::units::telling;
use gdcm_files::figure::{Figure, FigureRequest};

use super::View;
use super::frequency::condition_source;
use crate::view::command::Command;
use crate::view::controls::restore_panel_size;
use crate::view::figures::request;
use crate::view::palette::{BODY_SIZE, Palette, medium};
use crate::view::plot::{FigureScene, FigureWords, figure_legend_ui, figure_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;
use crate::view::table_view::{Sorting, TableLook, table_grid_ui};

/// Part of the width that words and tables take.
const WORDS_PART: f32 = 0.56;

/// Which couplings are fitted.
pub fn couplings_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.study.settings.couplings;
    let mut chosen = shown;
    let choices = [
        (CouplingCorrection::None, "none", "Gains, delays and leads of the channels alone (the paper)"),
        (CouplingCorrection::Mixing, "mixing", "Each input takes constant shares of the others (M16)"),
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

/// What the couplings do that the study asks for; where it asks for none, what mixing and feedback would do.
pub fn couplings_job(state: &State) -> CouplingsJob {
    let couplings = match state.study.settings.couplings {
        CouplingCorrection::None => CouplingCorrection::MixingAndFeedback,
        asked => asked,
    };
    CouplingsJob { study: state.study.clone(), couplings }
}

/// The job that finds out whether couplings are to be offered: once leads do what a channel can, of three conditions or more.
pub fn offered_couplings_job(state: &State) -> Option<CouplingsJob> {
    let settings = &state.study.settings;
    let is_left = settings.couplings == CouplingCorrection::None && settings.phase == PhaseCorrection::Lead;
    let analysis = state.analysis().filter(|_| is_left && !state.results.is_behind())?;
    (analysis.conditions.len() > 2).then(|| couplings_job(state))
}

/// What couplings would bring off the axis, where they are not used and that is worth it: J of conditions left out without and with.
pub fn offered_couplings(state: &State) -> Option<(CouplingCorrection, [f64; 2])> {
    let job = offered_couplings_job(state)?;
    let Ok(assessment) = state.couplings(&job)?.as_ref() else { return None };
    let cost = assessment.deciding_cost();
    let others = [cost.without.others?, cost.with.others?];
    cost.is_worth_it().then_some((job.couplings, others))
}

/// Words and tables at the left, the loop and the poles at the right.
pub fn couplings_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let found = state.couplings(&couplings_job(state)).cloned();
    let assessment = match found {
        Some(Ok(assessment)) => assessment,
        Some(Err(why)) => return drop(ui.add(Label::new(palette.dim(format!("No couplings: {why}."))).wrap())),
        None => return drop(ui.label(palette.dim(state.results.absence()))),
    };
    restore_panel_size(ui, "couplings");
    let width = WORDS_PART * ui.available_width();
    let panel = Panel::left("couplings").resizable(true).default_size(width).min_size(260.0);
    panel.show(ui, |ui| {
        ScrollArea::vertical().id_salt("couplings in words").auto_shrink(false).show(ui, |ui| {
            words_ui(ui, state, &assessment, palette, commands);
            tables_ui(ui, state, &assessment, palette, commands);
        });
    });
    let figure = figure(state).unwrap_or_default();
    let mut view = state.display.figures.remove(&View::Couplings).unwrap_or_default();
    let scene = FigureScene {
        name: "couplings",
        figure: &figure,
        selected: None,
        highlighted: None,
        columns: &[],
        zooms: true,
        is_compact: false,
        accented: None,
        least: vec2(220.0, 150.0),
        message: state.results.absence(),
        words: (&LoopWords(&figure), 0),
    };
    figure_legend_ui(ui, &figure, palette);
    figure_ui(ui, &scene, &mut view, palette);
    state.display.figures.insert(View::Couplings, view);
}

/// The figure of the condition shown; none until the couplings are assessed.
fn figure(state: &State) -> Option<Figure> {
    let request: FigureRequest = request(state, View::Couplings)?;
    request.figure(None, condition_source(state).as_ref())
}

/// The assessment that the view shows.
pub fn shown_couplings(state: &State) -> Option<Arc<CouplingsAssessment>> {
    let assessed: &AssessedCouplings = state.couplings(&couplings_job(state))?;
    assessed.as_ref().ok().cloned()
}

fn words_ui(
    ui: &mut Ui,
    state: &State,
    assessment: &CouplingsAssessment,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    if state.study.settings.couplings == CouplingCorrection::None {
        let words = format!("None are used. What {} would do:", assessment.couplings.name());
        ui.label(palette.dim(words));
        let used = format!("Use {}", assessment.couplings.name());
        if ui.button(used).on_hover_text("In every condition; undo takes it back").clicked() {
            commands.push(setting::COUPLINGS.to(assessment.couplings).into());
        }
    }
    for remark in assessment.remarks(state.dataset()) {
        let words = match remark.kind {
            RemarkKind::Good => RichText::new(&remark.text).color(palette.text),
            RemarkKind::Caution => RichText::new(format!("⚠ {}", remark.text)).color(palette.warning),
            RemarkKind::Trouble => {
                RichText::new(format!("⚠ {}", remark.text)).font(medium(BODY_SIZE)).color(palette.warning)
            }
        };
        ui.add_space(2.0);
        ui.add(Label::new(words).wrap());
    }
    if let Err(why) =
        assessment.conditions.get(&state.condition().id()).map_or(Ok(()), |of| of.poles.as_ref().map(drop))
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
    let costs = Table { title: "J, mean over the conditions".to_owned(), ..assessment.cost_table() };
    let plain = |_: usize, _: usize| None;
    table_part_ui(ui, &costs, &plain, palette, commands);
    for table in assessment.matrix_tables(state.dataset()) {
        // What is within its bar is not told from nothing.
        let dim = |row: usize, column: usize| table.rows[row][column].starts_with('(').then_some(palette.dim_text);
        table_part_ui(ui, &table, &dim, palette, commands);
    }
    let above = above_band_table(state.dataset(), assessment);
    if !above.rows.is_empty() {
        table_part_ui(ui, &above, &plain, palette, commands);
    }
    let poles = poles_of_condition(state, assessment);
    if !poles.rows.is_empty() {
        table_part_ui(ui, &poles, &plain, palette, commands);
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
    let look = TableLook { color, selected: &|_| false };
    ScrollArea::horizontal().id_salt(("couplings", &table.title)).show(ui, |ui| {
        ui.spacing_mut().interact_size.y = 16.0;
        table_grid_ui(ui, table, &mut Sorting::default(), &look, palette, commands);
    });
}

/// What couplings do at ten times the band to the held responses of each condition, and how near its loop is to ringing.
fn above_band_table(dataset: &Dataset, assessment: &CouplingsAssessment) -> Table {
    let columns = ["condition", "least singular value", "at [rad/s]", "above the band [dB]", "of"];
    let mut table = Table::new("The loop of each condition", columns);
    for (id, of) in &assessment.conditions {
        let margin = of.margin.map(|margin| [telling(margin.least, 2), telling(margin.omega_rad_s, 1)]);
        let [least, at] = margin.unwrap_or_default();
        let most = of.most_changed_above_band(dataset.on_axis());
        let (change, pair) = most.map_or((String::new(), String::new()), |(pair, change_db)| {
            (telling(change_db, 1).replace('-', "\u{2212}"), dataset.pair_name(pair))
        });
        table.row([id.to_string(), least, at, change, pair]);
    }
    table
}

/// The rows of the condition shown in the table of poles.
fn poles_of_condition(state: &State, assessment: &CouplingsAssessment) -> Table {
    let id = state.condition().id().to_string();
    let mut table = assessment.pole_table();
    table.rows.retain(|row| row[0] == id);
    table.rows.iter_mut().for_each(|row| drop(row.remove(0)));
    table.columns.remove(0);
    Table { title: format!("Poles of the physics representative of condition {id}"), ..table }
}

/// What the plots say to who does not see them.
struct LoopWords<'a>(&'a Figure);

impl FigureWords for LoopWords<'_> {
    fn plot(&self, plot: usize) -> String {
        self.0.plots[plot].title.clone()
    }
}
