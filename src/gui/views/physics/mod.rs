//! Physics parameters: which would have to change, and by how much, so that the physics models
//! match flight in all conditions at once (M18, docs/physics.md). A parameter is *fitted* if it is
//! switched on and not set by hand, and *named* if the diagnosis proposes its change.
//!
//! | file | content |
//! |---|---|
//! | `change` | responses and poles of the condition, before and after |
//! | `fit_box` | box that takes a parameter into the fit or out of it |
//! | `parameter_list` | parameters of the dataset, in the left panel |
//! | `ranking` | a row for each parameter |
//! | `correlation` | parameters that cannot be told apart |
//! | `evidence` | the selected parameter, the effect on the correction, cautions |
//! | `use_parameters` | the job, and the control that applies the parameters |

mod change;
mod correlation;
mod evidence;
mod fit_box;
mod parameter_list;
mod ranking;
mod use_parameters;

use std::sync::Arc;

use egui::{Frame, Label, Margin, Rect, RichText, ScrollArea, Ui, UiBuilder, Vec2, vec2};

use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::physics::physics_figure;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::physics_findings::{PhysicsFailure, PhysicsFindings};
use gdcm_words::physics::verdict_text;

use super::PageEntry;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::figure_legend::figure_legend_ui;
use crate::gui::plot::{FigureEvent, FigureScene, figure_ui};
use crate::gui::state::physics_display::PhysicsPage;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::PageWords;
use crate::gui::widgets::palette::{BODY_SIZE, Palette};
use change::change_ui;
use correlation::CorrelationMatrix;
use ranking::Ranking;

pub use evidence::physics_evidence_ui;
pub use parameter_list::parameter_list_ui;
pub use use_parameters::{physics_header_ui, physics_job, unused_named};

/// Height of the verdict's box \[pt\].
const VERDICT_HEIGHT: f32 = 52.0;
/// Margin above and below the verdict \[pt\].
const VERDICT_MARGIN: i8 = 8;
/// Gap between ranking and correlation matrix \[pt\].
const COLUMN_GAP: f32 = 14.0;
/// Gap between the selected parameter's plots and those before and after \[pt\].
const ROW_GAP: f32 = 8.0;
/// Minimum plot size \[pt\].
const LEAST_PLOT: Vec2 = vec2(220.0, 120.0);
/// Width for the correlation matrix, as a share of the view width.
const CORRELATION_PART: f32 = 0.33;
/// Height for the selected parameter's plots, as a share of the height below the ranking; the plots
/// before and after have the rest.
const CONDITIONS_PART: f32 = 0.46;
/// Minimum view height for showing everything at once \[pt\].
const LEAST_HEIGHT_FOR_EVERYTHING: f32 = 640.0;

/// Returns the pages; none in a window that shows everything at once, as [`physics_view_ui`]
/// decided in the last frame.
pub fn physics_pages(state: &State) -> Vec<PageEntry> {
    if state.display.physics.shows_everything {
        return Vec::new();
    }
    let mut pages = Vec::new();
    for page in PhysicsPage::ALL {
        let (name, purpose) = match page {
            PhysicsPage::Ranking => (
                "Ranking",
                "Every parameter: change, interval, explained share of the error",
            ),
            PhysicsPage::Correlation => (
                "Correlation",
                "Parameters that cannot be told apart, and the share of each that gains and \
                    delays can imitate",
            ),
            PhysicsPage::Conditions => (
                "Conditions",
                "The selected parameter in each condition, and the misfit that remains",
            ),
            PhysicsPage::Change => (
                "Before and after",
                "The most improved responses of the condition, and its poles",
            ),
        };
        pages.push(PageEntry {
            words: PageWords {
                name,
                short_name: name,
                purpose,
            },
            is_shown: page == state.display.physics.page,
            command: DisplayCommand::ShowPhysics(page).into(),
        });
    }
    pages
}

/// Draws verdict, ranking, correlation and plots.
///
/// 1. Whether the window is wide and high enough for everything at once.
/// 2. Exits with a message: the diagnosis failed; there is none yet, or the study selects no
///    parameters; all values are set by hand.
/// 3. The verdict, in every window.
/// 4. Everything at once: ranking beside correlation, below them the selected parameter in each
///    condition, at the bottom the plots before and after; else the part on the selected page.
pub fn physics_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // Step 1.
    state.display.physics.shows_everything =
        state.display.layout.is_wide && ui.available_height() >= LEAST_HEIGHT_FOR_EVERYTHING;
    // Step 2.
    let assessment = match state.physics().cloned() {
        Some(Some(Ok(assessment))) => assessment,
        Some(Some(Err(failure))) => return failure_ui(ui, &failure, palette),
        Some(None) => {
            ui.label(palette.dim("No physics parameter is chosen"));
            return;
        }
        None => {
            ui.label(palette.dim(state.results.absence()));
            return;
        }
    };
    let Some(findings) = assessment.applied.findings.clone() else {
        let text = "All values are set by hand: nothing is fitted";
        ui.label(palette.dim(text));
        return;
    };
    // Step 3.
    verdict_ui(ui, &findings, palette);
    let selected = state.selected_parameter(&findings);
    let ranking = Ranking {
        findings: &findings,
        selected,
        has_boxes: state.display.layout.settings_open || !state.display.layout.has_left_panel(),
        palette,
    };
    let matrix = CorrelationMatrix {
        findings: &findings,
        palette,
    };
    // Step 4.
    if state.display.physics.shows_everything {
        let parts = PhysicsParts {
            ranking,
            matrix,
            findings: &findings,
            assessment: &assessment,
            palette,
        };
        parts.ui(ui, state, commands);
        return;
    }
    match state.display.physics.page {
        PhysicsPage::Ranking => {
            let height = ui.available_height();
            ranking_ui(ui, &ranking, height, commands);
        }
        PhysicsPage::Correlation => matrix.ui(ui, commands),
        PhysicsPage::Conditions => {
            conditions_ui(ui, state, &findings, &assessment, palette, commands);
        }
        PhysicsPage::Change => change_ui(ui, state, &assessment, palette),
    }
}

/// Parts of the view that are drawn at once in a large window.
struct PhysicsParts<'a> {
    ranking: Ranking<'a>,
    matrix: CorrelationMatrix<'a>,
    findings: &'a Arc<PhysicsFindings>,
    assessment: &'a PhysicsAssessment,
    palette: &'a Palette,
}

impl PhysicsParts<'_> {
    /// Draws, from top to bottom: the ranking with the correlation at its right, at most half as
    /// high as the view; the selected parameter in each condition; the plots before and after.
    fn ui(&self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
        ui.add_space(6.0);
        let height = self.ranking.height().min(0.5 * ui.available_height());
        let room = ui.available_rect_before_wrap();
        let top = room.with_max_y(room.top() + height);
        let middle = top.right() - CORRELATION_PART * top.width();
        draw_within(ui, top.with_max_x(middle), |ui| {
            ranking_ui(ui, &self.ranking, height, commands);
        });
        draw_within(ui, top.with_min_x(middle + COLUMN_GAP), |ui| {
            self.matrix.ui(ui, commands);
        });
        ui.advance_cursor_after_rect(top);
        ui.add_space(6.0);
        let below = ui.available_rect_before_wrap();
        let middle = below.top() + CONDITIONS_PART * below.height();
        draw_within(ui, below.with_max_y(middle), |ui| {
            let palette = self.palette;
            conditions_ui(ui, state, self.findings, self.assessment, palette, commands);
        });
        draw_within(ui, below.with_min_y(middle + ROW_GAP), |ui| {
            change_ui(ui, state, self.assessment, self.palette);
        });
        ui.advance_cursor_after_rect(below);
    }
}

/// Draws with `add` into an area.
fn draw_within(ui: &mut Ui, area: Rect, add: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().max_rect(area), add);
}

fn ranking_ui(ui: &mut Ui, ranking: &Ranking<'_>, height: f32, commands: &mut Vec<Command>) {
    ScrollArea::vertical()
        .id_salt("ranking of parameters")
        .max_height(height)
        .auto_shrink([false, true])
        .show(ui, |ui| ranking.ui(ui, commands));
}

/// Draws the verdict in a box with constant height.
fn verdict_ui(ui: &mut Ui, findings: &PhysicsFindings, palette: &Palette) {
    let frame = Frame::new()
        .fill(palette.raised)
        .corner_radius(6.0)
        .inner_margin(Margin::symmetric(12, VERDICT_MARGIN));
    frame.show(ui, |ui| {
        let height = VERDICT_HEIGHT - 2.0 * f32::from(VERDICT_MARGIN);
        ui.set_min_size(vec2(ui.available_width(), height));
        ui.set_max_height(height);
        let text = verdict_text(findings);
        let label = Label::new(RichText::new(&text).size(BODY_SIZE)).wrap();
        ui.add(label).on_hover_text(text);
    });
}

/// Draws why there is no diagnosis; without model runs, also how to supply them.
fn failure_ui(ui: &mut Ui, failure: &PhysicsFailure, palette: &Palette) {
    ui.add_space(8.0);
    ui.add(Label::new(RichText::new(failure.to_string()).size(BODY_SIZE)).wrap());
    if matches!(failure, PhysicsFailure::NoRuns) {
        let text = "Rerun the linearisation with one named parameter changed, once or twice for \
            each parameter and condition, and import the models: names such as \"Ixx+5%\" are \
            recognised. \"Find the cause\" suggests reruns for the errors of this condition \
            (docs/physics.md).";
        ui.add(Label::new(palette.dim(text)).wrap());
    }
}

/// Draws the selected parameter in each condition, and the misfit that remains.
fn conditions_ui(
    ui: &mut Ui,
    state: &mut State,
    findings: &Arc<PhysicsFindings>,
    assessment: &PhysicsAssessment,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let selected = state.selected_parameter(findings);
    // The scene borrows the state: take the view out while the figure is drawn.
    let figure =
        physics_figure(findings, state.dataset(), assessment.level, selected).unwrap_or_default();
    let mut view = state
        .display
        .figures
        .remove(&View::Physics)
        .unwrap_or_default();
    view.fit_if_subject_changed(&figure.title);
    let scene = FigureScene {
        zooms: true,
        highlighted: Some(MarkId::Condition(state.condition().id())),
        ..FigureScene::new(
            "physics parameters",
            &figure,
            LEAST_PLOT,
            state.results.absence(),
            &figure,
        )
    };
    figure_legend_ui(ui, &figure, palette);
    for event in figure_ui(ui, &scene, &mut view, palette) {
        match event {
            FigureEvent::Clicked(_, MarkId::Condition(id), _) => {
                commands.push(SelectionCommand::SelectCondition(id).into());
            }
            FigureEvent::StatusText(words) => {
                commands.push(SelectionCommand::ShowStatus(words).into())
            }
            _ => {}
        }
    }
    state.display.figures.insert(View::Physics, view);
}
