//! Drawer with details about the selected requirement: three cards side by side in a wide window,
//! one card with its numbers in a narrow window.
//!
//! A requirement asks that a property of the corrected model agrees with the identified model, or
//! with a held-out record, within a limit; the *grid* has a cell for each requirement and condition
//! (M17: docs/requirements.md).

use egui::{Rect, Ui, UiBuilder, vec2};

use gdcm_study::decisions::setting_table;
use gdcm_study::results::grid_cell::CellVerdict;
use gdcm_study::results::grid_requirement::Requirement;
use gdcm_study::results::requirement_grid::RequirementGrid;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::requirement_grid::{value_with_unit_text, verdict_text};

use super::bandwidth::{bandwidth_detail_ui, bandwidth_numbers_ui, bode_commands};
use super::offered_couplings;
use super::requirement_cards::{CardHeading, card_ui};
use super::requirement_grid_layout::FULL_WIDTH;
use super::requirement_histories::{
    record_choice_ui, time_detail_ui, time_numbers_ui, time_subject,
};
use super::requirement_modes::modes_detail_ui;
use super::requirement_selection::{SelectedCell, requirement_names, selected_cell};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::requirements_display::{RequirementDetail, RequirementsDisplay};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::PageWords;
use crate::gui::widgets::controls::Asks;
use crate::gui::widgets::drawer::{Drawer, drawer_ui};
use crate::gui::widgets::page_switch::{PageTab, page_switch_ui};
use crate::gui::widgets::palette::Palette;

/// Default drawer height \[pt\], also the minimum, which is half the view height in a low view.
const HEIGHT: f32 = 250.0;
/// Distance between cards \[pt\].
const CARD_GAP: f32 = 16.0;
/// Widths of the cards in the order of [`RequirementDetail::ALL`], as shares of the drawer width
/// without gaps.
const CARD_SHARES: [f32; 3] = [0.25, 0.37, 0.38];
/// Width for the numbers beside a single card \[pt\].
const NUMBERS: f32 = 250.0;

/// Draws the drawer at the bottom of the view; Escape or its button closes it.
pub(super) fn details_ui(
    ui: &mut Ui,
    state: &mut State,
    grid: &RequirementGrid,
    requirements: &Requirements,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(selected) = selected_cell(state, grid) else {
        return;
    };
    let title = title(state, &selected);
    let verdict = verdict(&selected);
    let drawer = Drawer {
        name: "requirement details",
        title: &title,
        verdict: &verdict,
        is_warning: selected
            .cell
            .is_some_and(|cell| cell.corrected.verdict == CellVerdict::Outside),
        default_height: HEIGHT,
        min_height: HEIGHT.min(0.5 * ui.available_height()),
    };
    let requirement = selected.row.requirement;
    let is_wide = ui.ctx().content_rect().width() >= FULL_WIDTH;
    let bar = DetailsBar::new(state, &selected, requirements);
    let mut bar_commands = Vec::new();
    let details = Details {
        requirements,
        requirement,
        palette,
    };
    let is_closed = drawer_ui(
        ui,
        drawer,
        palette,
        |ui| bar.ui(ui, is_wide, palette, &mut bar_commands),
        |ui| {
            if is_wide {
                details.cards_ui(ui, state, commands);
            } else {
                details.card_with_numbers_ui(ui, state, commands);
            }
        },
    );
    commands.extend(bar_commands);
    if is_closed {
        let display = closed(state.display.judging.requirements);
        commands.push(DisplayCommand::ShowRequirements(display).into());
    }
}

/// Returns the display after Escape or the drawer's button: an open limit editor is closed before
/// the drawer.
fn closed(display: RequirementsDisplay) -> RequirementsDisplay {
    if display.edited_limit.is_some() {
        return RequirementsDisplay {
            edited_limit: None,
            ..display
        };
    }
    RequirementsDisplay {
        are_details_hidden: true,
        ..display
    }
}

/// Returns "Yaw bandwidth, condition 3".
fn title(state: &State, selected: &SelectedCell<'_>) -> String {
    let name = requirement_names(state).name(selected.row.requirement);
    format!("{name}, condition {}", selected.condition)
}

/// Returns "−12 %, outside ±10 %; physics −14 %"; if the corrected model has no value, only the
/// verdict.
fn verdict(selected: &SelectedCell<'_>) -> String {
    let row = selected.row;
    let Some(cell) = selected.cell else {
        return "the condition has no result".to_owned();
    };
    let requirement = row.requirement;
    let verdict = verdict_text(requirement, &row.limit, &cell.corrected);
    if cell.corrected.value.is_none() {
        return verdict;
    }
    let value = value_with_unit_text(requirement, &cell.corrected);
    let physics = value_with_unit_text(requirement, &cell.physics);
    format!("{value}, {verdict}; physics {physics}")
}

/// Controls in the drawer's title bar.
struct DetailsBar {
    display: RequirementsDisplay,
    /// Command for the link to couplings, if they are worthwhile.
    use_couplings: Option<Command>,
    /// Commands for the link to the Bode view; empty unless a bandwidth, a phase delay or a level
    /// is selected.
    show_in_bode: Vec<Command>,
}

impl DetailsBar {
    fn new(state: &State, selected: &SelectedCell<'_>, requirements: &Requirements) -> Self {
        let display = state.display.judging.requirements;
        let use_couplings = offered_couplings(state)
            .map(|(assessment, _)| setting_table::COUPLINGS.to(assessment.couplings).into());
        let show_in_bode = match selected.row.requirement {
            Requirement::Bandwidth(pair)
            | Requirement::PhaseDelay(pair)
            | Requirement::Level(pair) => {
                bode_commands(requirements, selected.condition, pair, display.role())
            }
            _ => Vec::new(),
        };
        Self {
            display,
            use_couplings,
            show_in_bode,
        }
    }

    /// Draws the controls from right to left: links, and the switch between the details if only one
    /// fits.
    fn ui(&self, ui: &mut Ui, is_wide: bool, palette: &Palette, commands: &mut Vec<Command>) {
        ui.add_space(8.0);
        if !self.show_in_bode.is_empty() {
            let link = ui
                .link("Show in Bode")
                .on_hover_text("Marks the frequencies that define bandwidth and phase delay");
            if link.clicked() {
                commands.extend(self.show_in_bode.iter().cloned());
            }
            ui.add_space(8.0);
        }
        let link = ui
            .link("Physics parameters…")
            .on_hover_text("Parameters of the physics model that could explain the difference");
        link.asks(LayoutCommand::ShowView(View::Physics), commands);
        ui.add_space(8.0);
        if let Some(command) = &self.use_couplings {
            let link = ui
                .link("Use couplings")
                .on_hover_text("Couplings reduce off-axis errors, and move poles");
            link.asks(command.clone(), commands);
            ui.add_space(8.0);
        }
        if !is_wide {
            self.switch_ui(ui, palette, commands);
        }
    }

    fn switch_ui(&self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let tabs = RequirementDetail::ALL.map(|detail| PageTab {
            words: detail_words(detail),
            is_shown: detail == self.display.detail,
        });
        if let Some(clicked) = page_switch_ui(ui, &tabs, palette) {
            let display = RequirementsDisplay {
                detail: RequirementDetail::ALL[clicked],
                ..self.display
            };
            commands.push(DisplayCommand::ShowRequirements(display).into());
        }
    }
}

fn detail_words(detail: RequirementDetail) -> PageWords {
    match detail {
        RequirementDetail::Frequency => PageWords {
            name: "frequency",
            short_name: "Frequency",
            purpose: "Phase delay over bandwidth in all conditions (ADS-33E-PRF)",
        },
        RequirementDetail::Time => PageWords {
            name: "time",
            short_name: "Time",
            purpose: "A flight record with its tolerances, or the responses to a step or a doublet",
        },
        RequirementDetail::Modes => PageWords {
            name: "modes",
            short_name: "Modes",
            purpose: "Modes of the condition and their tolerances",
        },
    }
}

struct Details<'a> {
    requirements: &'a Requirements,
    requirement: Requirement,
    palette: &'a Palette,
}

impl Details<'_> {
    /// Draws the three cards side by side.
    fn cards_ui(&self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
        let room = ui.available_rect_before_wrap();
        let width = room.width() - 2.0 * CARD_GAP;
        let mut left = room.left();
        for (detail, share) in RequirementDetail::ALL.into_iter().zip(CARD_SHARES) {
            let size = vec2(share * width, room.height());
            let area = Rect::from_min_size(room.min + vec2(left - room.left(), 0.0), size);
            left = area.right() + CARD_GAP;
            self.card_ui(ui, area, detail, state, commands);
        }
        ui.advance_cursor_after_rect(room);
    }

    /// Draws the chosen card, with its numbers at the right; the card about modes is a table
    /// already and takes the whole width.
    fn card_with_numbers_ui(&self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
        let detail = state.display.judging.requirements.detail;
        let room = ui.available_rect_before_wrap();
        if detail == RequirementDetail::Modes {
            self.card_ui(ui, room, detail, state, commands);
        } else {
            let card = room.with_max_x(room.right() - NUMBERS - CARD_GAP);
            self.card_ui(ui, card, detail, state, commands);
            let numbers = room.with_min_x(card.right() + CARD_GAP);
            let builder = UiBuilder::new().id_salt("numbers").max_rect(numbers);
            ui.scope_builder(builder, |ui| match detail {
                RequirementDetail::Time => {
                    time_numbers_ui(ui, state, Some(self.requirement), self.palette);
                }
                _ => bandwidth_numbers_ui(ui, state, self.requirements, self.palette),
            });
        }
        ui.advance_cursor_after_rect(room);
    }

    /// Draws a card: its heading, accented if the card explains the selected requirement; on the
    /// card about time the selector of the record; and the content, clipped to the card.
    fn card_ui(
        &self,
        ui: &mut Ui,
        area: Rect,
        detail: RequirementDetail,
        state: &mut State,
        commands: &mut Vec<Command>,
    ) {
        let selected = Some(self.requirement);
        let subject = match detail {
            RequirementDetail::Frequency => {
                let pair = state.dataset().pair_name(state.display.selection.pair);
                format!("{pair}, all conditions")
            }
            RequirementDetail::Time => time_subject(state, selected),
            RequirementDetail::Modes => format!("condition {}", state.condition().id()),
        };
        let heading = CardHeading {
            title: detail_words(detail).short_name,
            subject: &subject,
            is_accented: RequirementDetail::of_group(self.requirement.group()) == Some(detail),
        };
        let content_area = card_ui(ui, area, &heading, self.palette, |ui| {
            if detail == RequirementDetail::Time {
                record_choice_ui(ui, state, commands);
            }
        });
        let builder = UiBuilder::new()
            .id_salt(heading.title)
            .max_rect(content_area);
        ui.scope_builder(builder, |ui| {
            ui.set_clip_rect(content_area.intersect(ui.clip_rect()));
            let palette = self.palette;
            match detail {
                RequirementDetail::Frequency => {
                    bandwidth_detail_ui(ui, state, self.requirements, palette, commands);
                }
                RequirementDetail::Time => {
                    time_detail_ui(ui, state, selected, palette, commands);
                }
                RequirementDetail::Modes => {
                    modes_detail_ui(ui, state, self.requirements, selected, palette, commands);
                }
            }
        });
    }
}
