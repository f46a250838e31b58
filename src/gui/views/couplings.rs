//! Couplings: constant shares of the other inputs (mixing) and of the outputs (feedback) that are
//! added to each input (M16, docs/couplings.md); their benefit, their matrices, and their effect on
//! the loop of the model with its feedback.

use egui::{Frame, Label, Margin, Panel, RichText, ScrollArea, Ui, Vec2, vec2};

use gdcm_model::number_format::with_minus_sign;
use gdcm_model::units::telling;
use gdcm_plot::figure::Figure;
use gdcm_study::CouplingCorrection;
use gdcm_study::decisions::setting_table;
use gdcm_study::results::coupling_remark_search::coupling_remarks;
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::remark_kind::RemarkKind;
use gdcm_words::Table;
use gdcm_words::coupling_error::coupling_error_text;
use gdcm_words::coupling_remark::{coupling_remark_text, no_poles_text};
use gdcm_words::couplings::{
    NARROW_COST_COLUMNS, coupling_cost_table, coupling_matrix_tables, pole_table,
};

use super::PageEntry;
use super::axis_updates::axis_update;
use super::couplings_use::are_couplings_used;
use super::figures::figure_request;
use super::frequency_curves::condition_source;
use crate::gui::commands::command::Command;
use crate::gui::plot::figure_legend::figure_legend_ui;
use crate::gui::plot::{FigureScene, figure_ui};
use crate::gui::state::view::View;
use crate::gui::state::view_pages::{CouplingsPage, ViewPage};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::PageOption;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium};
use crate::gui::widgets::panel_layout::restore_panel_size;
use crate::gui::widgets::tables::{TableLook, table_block_ui};

/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 150.0);
/// Initial width of texts and tables, as a share of the view width.
const WORDS_PART: f32 = 0.56;

pub fn couplings_pages(state: &State) -> Vec<PageEntry> {
    let shown = state.display.pages.couplings;
    [
        CouplingsPage::Benefit,
        CouplingsPage::Matrices,
        CouplingsPage::Loop,
    ]
    .map(|page| PageEntry::new(ViewPage::Couplings(page), page == shown))
    .into()
}

/// Draws the selector for the coupling correction: none, mixing, or mixing and feedback.
pub fn couplings_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let shown = state.study.settings.couplings;
    let mut chosen = shown;
    let choices = [
        (
            CouplingCorrection::None,
            "none",
            "Gains, delays and leads of the channels alone",
        ),
        (
            CouplingCorrection::Mixing,
            "mixing",
            "Constant shares of the other inputs are added to each input (docs/couplings.md)",
        ),
        (
            CouplingCorrection::MixingAndFeedback,
            "mixing and feedback",
            "Constant shares of inputs and outputs are added to each input (docs/couplings.md)",
        ),
    ];
    let option = PageOption {
        name: "Couplings of the physics models",
        label: "couplings",
    };
    option.ui(ui, &mut chosen, &choices, palette);
    if chosen != shown {
        commands.push(setting_table::COUPLINGS.to(chosen).into());
    }
}

/// Draws the page's texts and tables on the left, the loop and the poles on the right; the matrices
/// take the whole width.
pub fn couplings_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let assessment = match state.couplings().cloned() {
        Some(Ok(assessment)) => assessment,
        Some(Err(why)) => {
            let why = coupling_error_text(&why, state.dataset());
            ui.add(Label::new(palette.dim(format!("No couplings: {why}"))).wrap());
            return;
        }
        None => {
            ui.label(palette.dim(state.results.absence()));
            return;
        }
    };
    let page = state.display.pages.couplings;
    if page == CouplingsPage::Matrices {
        let words = CouplingsWords {
            state,
            assessment: &assessment,
            palette,
        };
        return words.ui(ui, page, commands);
    }
    restore_panel_size(ui, "couplings");
    let width = WORDS_PART * ui.available_width();
    let panel = Panel::left("couplings")
        .resizable(true)
        .default_size(width)
        .min_size(260.0);
    panel.show(ui, |ui| {
        let words = CouplingsWords {
            state,
            assessment: &assessment,
            palette,
        };
        words.ui(ui, page, commands);
    });
    let beside = Frame::new().inner_margin(Margin {
        left: 10,
        ..Margin::ZERO
    });
    beside.show(ui, |ui| couplings_figure_ui(ui, state, palette));
}

/// Draws the figure of the loop and the poles below its legend; empty until its curves are
/// available.
fn couplings_figure_ui(ui: &mut Ui, state: &mut State, palette: &Palette) {
    let mut figure = Figure::default();
    if let Some(request) = figure_request(state, View::Couplings)
        && let Some(drawn) = request.figure(None, condition_source(state).as_ref())
    {
        figure = drawn;
    }
    // The scene borrows the state: take the view out while the figure is drawn.
    let mut view = state
        .display
        .figures
        .remove(&View::Couplings)
        .unwrap_or_default();
    view.keep_axis_ranges(&mut figure, axis_update(ui, state));
    let scene = FigureScene {
        zooms: true,
        ..FigureScene::new(
            "couplings",
            &figure,
            LEAST_PLOT,
            state.results.absence(),
            &figure,
        )
    };
    figure_legend_ui(ui, &figure, palette);
    figure_ui(ui, &scene, &mut view, palette);
    state.display.figures.insert(View::Couplings, view);
}

/// Texts and tables about the couplings.
struct CouplingsWords<'a> {
    state: &'a State,
    assessment: &'a CouplingsAssessment,
    palette: &'a Palette,
}

impl CouplingsWords<'_> {
    fn ui(&self, ui: &mut Ui, page: CouplingsPage, commands: &mut Vec<Command>) {
        ScrollArea::vertical()
            .id_salt(("couplings in words", page as usize))
            .auto_shrink(false)
            .show(ui, |ui| match page {
                CouplingsPage::Benefit => {
                    self.use_ui(ui, commands);
                    // The costs come first, because the decision depends on them.
                    self.costs_ui(ui, commands);
                    self.remarks_ui(ui);
                }
                CouplingsPage::Matrices => self.matrices_ui(ui, commands),
                CouplingsPage::Loop => self.loop_ui(ui, commands),
            });
    }

    /// Draws the button that uses the couplings, or the button that removes them if they are in use
    /// but not worthwhile: judged by J in conditions left out of their fit or, without any, by J
    /// under the schedule.
    fn use_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        if !are_couplings_used(self.state) {
            let name = self.assessment.couplings.name();
            let words = format!("Not in use. Effect of {name}:");
            ui.label(self.palette.dim(words));
            self.switch_ui(
                ui,
                &format!("Use {name}"),
                self.assessment.couplings,
                commands,
            );
        } else if !self.assessment.deciding_cost().is_worth_it() {
            let label = "Switch the couplings off";
            self.switch_ui(ui, label, CouplingCorrection::None, commands);
        }
    }

    fn switch_ui(
        &self,
        ui: &mut Ui,
        label: &str,
        couplings: CouplingCorrection,
        commands: &mut Vec<Command>,
    ) {
        let button = ui.button(label);
        if button
            .on_hover_text("In every condition; can be undone")
            .clicked()
        {
            commands.push(setting_table::COUPLINGS.to(couplings).into());
        }
    }

    fn costs_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let costs = Table {
            title: "J, mean over the conditions".to_owned(),
            columns: NARROW_COST_COLUMNS.map(str::to_owned).to_vec(),
            ..coupling_cost_table(self.assessment)
        };
        self.table_ui(ui, &costs, TableLook::PLAIN, commands);
    }

    /// Draws the remarks in three steps of emphasis: good ones plain, the others as warnings,
    /// troubles also in a stronger font; below them, if the displayed condition has no poles, why.
    fn remarks_ui(&self, ui: &mut Ui) {
        ui.add_space(6.0);
        for remark in coupling_remarks(self.assessment, self.state.dataset()) {
            let text = coupling_remark_text(&remark, self.state.dataset());
            let words = match remark.kind() {
                RemarkKind::Good => RichText::new(text).color(self.palette.text),
                _ => RichText::new(format!("⚠ {text}")).color(self.palette.warning),
            };
            let words = match remark.kind() {
                RemarkKind::Trouble => words.font(medium(BODY_SIZE)),
                _ => words,
            };
            ui.add_space(2.0);
            ui.add(Label::new(words).wrap());
        }
        if let Some(condition) = self.assessment.conditions.get(&self.state.condition().id())
            && let Err(why) = &condition.poles
        {
            let words = format!("No poles for this condition: {}", no_poles_text(why));
            ui.add(Label::new(self.palette.dim(words)).wrap());
        }
    }

    fn matrices_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        for table in coupling_matrix_tables(self.assessment, self.state.dataset()) {
            // Values in parentheses are smaller than their error bar, so they are not
            // distinguishable from zero.
            let look = TableLook {
                color: &|row, column| {
                    if table.rows[row][column].starts_with('(') {
                        Some(self.palette.dim_text)
                    } else {
                        None
                    }
                },
                ..TableLook::PLAIN
            };
            self.table_ui(ui, &table, look, commands);
        }
    }

    /// Draws the loop table and the pole table.
    fn loop_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        for table in [self.loop_table(), self.pole_table()] {
            if !table.rows.is_empty() {
                self.table_ui(ui, &table, TableLook::PLAIN, commands);
            }
        }
    }

    /// Draws a table below its title, as high as its rows.
    fn table_ui(
        &self,
        ui: &mut Ui,
        table: &Table,
        look: TableLook<'_>,
        commands: &mut Vec<Command>,
    ) {
        ui.add_space(10.0);
        ui.add(Label::new(RichText::new(&table.title).font(medium(BODY_SIZE))).wrap());
        table_block_ui(ui, table, &look, self.palette, commands);
    }

    /// Builds the loop table: in each condition, the minimum singular value of `I - K H` (feedback
    /// K, physics responses H; M16) with its frequency, and the on-axis response that the couplings
    /// change most above the band, with that change.
    fn loop_table(&self) -> Table {
        let dataset = self.state.dataset();
        let columns = [
            "condition",
            "minimum singular value of I − K H",
            "at [rad/s]",
            "change above the band [dB]",
            "response",
        ];
        let mut table = Table::new("Coupling loop in each condition", columns);
        for (id, condition) in &self.assessment.conditions {
            let mut least = String::new();
            let mut at = String::new();
            if let Some(margin) = condition.margin {
                least = telling(margin.least, 2);
                at = telling(margin.omega_rad_s, 1);
            }
            let mut change = String::new();
            let mut response = String::new();
            if let Some((pair, change_db)) = condition.most_changed_above_band(dataset.on_axis()) {
                change = with_minus_sign(&telling(change_db, 1));
                response = dataset.pair_name(pair);
            }
            table.row([id.to_string(), least, at, change, response]);
        }
        table
    }

    /// Builds the pole table for the displayed condition.
    fn pole_table(&self) -> Table {
        let id = self.state.condition().id().to_string();
        let mut table = pole_table(self.assessment);
        table.title = format!("Poles of the physics representative of condition {id}");
        table.rows.retain(|row| row[0] == id);
        // Remove the condition column, because all rows have the same condition.
        for row in &mut table.rows {
            row.remove(0);
        }
        table.columns.remove(0);
        table
    }
}
