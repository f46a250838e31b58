//! Plots across conditions: the response in focus in every condition, coloured by airspeed, and
//! beside it the schedule error (scheduled minus identified response). The curves are in
//! `across_curves`, the chips in `across_chips`, the values at the pointer in `across_readout`.
//!
//! A *role* says which of a condition's models a curve shows: nominal, identified, scheduled and so
//! on. The *optima* are the conditions' own corrections, before the schedule smooths them over
//! airspeed.

use egui::{Rect, Ui, UiBuilder, pos2, vec2};

use gdcm_model::dataset::ConditionId;
use gdcm_model::number_format::counted;

use super::PageEntry;
use super::across_chips::across_chips_ui;
use super::across_curves::{across_curves, fit_across};
use super::across_readout::AcrossReadout;
use super::model_error;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::bode_event::BodeEvent;
use crate::gui::plot::bode_scene::{GroupName, PaneNote};
use crate::gui::plot::pointed_curve_text::pointed_curve_text;
use crate::gui::plot::quantity::BodeQuantity;
use crate::gui::plot::readout_strip::{STRIP_HEIGHT, readout_strip_ui};
use crate::gui::plot::{BodeCurve, BodeScene, BodeView, CurveId, Pane, bode_ui};
use crate::gui::state::across_display::{AcrossConditions, AcrossPage};
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::{DropDown, PageWords};
use crate::gui::widgets::palette::Palette;

/// Share of the width for the responses, beside the errors.
const RESPONSE_PART: f32 = 0.62;
/// Gap between responses and errors \[pt\].
const GAP: f32 = 8.0;
/// Gap between the read-out and the plots above and below it \[pt\].
const READOUT_GAP: f32 = 6.0;

/// Returns the pages "response" and "schedule error"; none if both plots are shown side by side.
pub fn across_pages(state: &State) -> Vec<PageEntry> {
    if shows_both(state) {
        return Vec::new();
    }
    let shown = state.display.frequency.across_display.page;
    let words = [
        (
            AcrossPage::Response,
            PageWords {
                name: "response",
                short_name: "Response",
                purpose: "Magnitude and phase in every condition",
            },
        ),
        (
            AcrossPage::Error,
            PageWords {
                name: "schedule error",
                short_name: "Error",
                purpose: "Scheduled minus identified response in every condition",
            },
        ),
    ];
    let mut entries = Vec::new();
    for (page, words) in words {
        entries.push(PageEntry {
            words,
            is_shown: page == shown,
            command: DisplayCommand::ShowAcrossPage(page).into(),
        });
    }
    entries
}

/// Returns whether responses and errors are drawn side by side.
fn shows_both(state: &State) -> bool {
    state.display.layout.is_wide && state.display.layout.arrangement.beside().is_none()
}

/// Draws the condition selector.
pub fn across_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let shown = state.display.frequency.across_display.conditions;
    let list = DropDown {
        name: "Conditions in the plots",
        width: 60.0,
        text: shown.name(),
    };
    let choices =
        AcrossConditions::ALL.map(|choice| (choice, choice == shown, choice.name().to_owned()));
    if let Some(conditions) = list.ui(ui, choices) {
        commands.push(DisplayCommand::ShowAcrossConditions(conditions).into());
    }
    ui.label(palette.dim("conditions"));
}

/// Areas of the plots; `None` for a plot that is not drawn.
struct PlotAreas {
    responses: Option<Rect>,
    errors: Option<Rect>,
}

impl PlotAreas {
    /// Divides an area between both plots, side by side if there is room; otherwise the shown
    /// page's plot has it alone.
    fn new(area: Rect, state: &State) -> Self {
        if shows_both(state) {
            let middle = area.left() + RESPONSE_PART * area.width();
            Self {
                responses: Some(area.with_max_x(middle)),
                errors: Some(area.with_min_x(middle + GAP)),
            }
        } else if state.display.frequency.across_display.page == AcrossPage::Error {
            Self {
                responses: None,
                errors: Some(area),
            }
        } else {
            Self {
                responses: Some(area),
                errors: None,
            }
        }
    }
}

/// Draws the response in focus and the schedule error in every condition; a click selects a
/// condition.
///
/// 1. Curves; for another response, condition, set of roles or of conditions, the value axes are
///    fitted again.
/// 2. Chips above the plots.
/// 3. Both scenes. The cursor is where the pointer was in either plot in the last frame. The error
///    scene is the response scene with other curves and optima, and without names at curve ends.
/// 4. Plots that have an area; a plot that is not drawn forgets the pointer.
/// 5. If both are drawn, the errors take over the frequency range of the responses.
/// 6. Values at the cursor, or without one at the largest error within the band, in a strip below
///    the magnitudes if there is room.
pub fn across_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // Step 1.
    let curves = across_curves(state);
    fit_across(state);
    // Step 2.
    let area = ui.available_rect_before_wrap();
    let chips_height = across_chips_ui(ui, area, state, palette, commands);
    let plots = area.with_min_y(area.top() + chips_height);
    // Step 3.
    let frequency = &mut state.display.frequency;
    let pointed = frequency
        .across
        .pointed_omega
        .or(frequency.across_error.pointed_omega);
    // The scenes borrow the state: take the views out while the plots are drawn.
    let mut responses = std::mem::take(&mut frequency.across);
    let mut errors = std::mem::take(&mut frequency.across_error);
    let band = state.study.settings.band;
    let title = state.dataset().pair_name(state.display.selection.pair);
    let names = group_names(state, &curves.responses);
    let is_nothing_chosen =
        curves.responses.is_empty() && state.across().is_some() && !state.results.is_behind();
    let message = if is_nothing_chosen {
        "No curve is chosen: choose models and conditions above"
    } else {
        state.results.absence()
    };
    let response_scene = BodeScene {
        quantity: BodeQuantity::RESPONSE_OF_EVERY_CONDITION,
        unit: state.display.curves.unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: Some(message),
        cursor: pointed,
        group_names: &names,
        reserves_readout: true,
        ..BodeScene::new(&title, &curves.responses, (band.min(), band.max()))
    };
    let optima_note = PaneNote {
        cost: "green: range of errors at the optima".to_owned(),
        ..PaneNote::default()
    };
    let shown_note = if curves.optima.is_some() {
        Some(&optima_note)
    } else {
        None
    };
    let error_message = error_message(state);
    let error_scene = BodeScene {
        quantity: BodeQuantity::ScheduleError,
        curves: &curves.errors,
        optima_range: curves.optima.as_ref(),
        notes: [shown_note, None],
        message: Some(&error_message),
        group_names: &[],
        ..response_scene
    };
    // Step 4.
    let areas = PlotAreas::new(plots, state);
    let mut readout_strip = None;
    if let Some(area) = areas.responses {
        let plot = AcrossPlot {
            state,
            scene: response_scene,
            palette,
        };
        plot.ui(ui, area, &mut responses, commands);
        readout_strip = readout_area(&responses, readout_strip);
    } else {
        responses.pointed_omega = None;
    }
    if let Some(area) = areas.errors {
        let plot = AcrossPlot {
            state,
            scene: error_scene,
            palette,
        };
        plot.ui(ui, area, &mut errors, commands);
        readout_strip = readout_area(&errors, readout_strip);
    } else {
        errors.pointed_omega = None;
    }
    // Step 5.
    if areas.responses.is_some() && areas.errors.is_some() {
        errors.share_frequencies(&responses);
    }
    // Step 6.
    let source = AcrossReadout {
        curves: &curves,
        condition: state.condition().id(),
        band: (band.min(), band.max()),
        unit: state.display.curves.unit,
    };
    if let (Some(strip), Some(readout)) = (readout_strip, source.readout(pointed)) {
        readout_strip_ui(ui, strip, &readout, palette);
    }
    ui.advance_cursor_after_rect(area);
    state.display.frequency.across = responses;
    state.display.frequency.across_error = errors;
}

/// Returns the message shown where the schedule-error curves are missing: no analysis, no schedule,
/// or nothing to compare.
fn error_message(state: &State) -> String {
    let Some(analysis) = state.analysis() else {
        return state.results.absence().to_owned();
    };
    match &analysis.schedule {
        Err(error) => error.to_string(),
        Ok(_) => model_error::error_message(state, state.display.selection.pair),
    }
}

/// Returns the read-out's area: the strip between this plot's magnitudes and phases, if it is high
/// enough, united with the strip in the other plot, if that is drawn too. `None` if neither exists,
/// or if this plot has not been laid out.
fn readout_area(view: &BodeView, other_strip: Option<Rect>) -> Option<Rect> {
    let magnitude = *view.transform(Pane::Magnitude)?.frame();
    let phase = *view.transform(Pane::Phase)?.frame();
    let top = magnitude.bottom() + READOUT_GAP;
    if phase.top() - magnitude.bottom() < STRIP_HEIGHT + 2.0 * READOUT_GAP {
        return other_strip;
    }
    let strip = Rect::from_min_size(
        pos2(magnitude.left(), top),
        vec2(magnitude.width(), STRIP_HEIGHT),
    );
    Some(match other_strip {
        Some(other_strip) => other_strip.union(strip),
        None => strip,
    })
}

/// Plot of magnitude above phase, with a curve for each condition and role.
struct AcrossPlot<'a> {
    state: &'a State,
    scene: BodeScene<'a>,
    palette: &'a Palette,
}

impl AcrossPlot<'_> {
    /// Draws the plot into an area, and pushes the commands for clicks and for the curve under the
    /// pointer.
    fn ui(self, ui: &mut Ui, area: Rect, view: &mut BodeView, commands: &mut Vec<Command>) {
        let scene = self.scene;
        let builder = UiBuilder::new().max_rect(area);
        let events = ui
            .scope_builder(builder, |ui| bode_ui(ui, &scene, view, self.palette))
            .inner;
        for event in events {
            if let BodeEvent::Clicked(CurveId::OfCondition(condition, _)) = event {
                commands.push(SelectionCommand::SelectCondition(condition).into());
            }
        }
        if let Some(CurveId::OfCondition(condition, _)) = view.hovered {
            commands.push(SelectionCommand::HoverCondition(condition).into());
        }
        let unit = self.state.display.curves.unit;
        if let Some(words) = pointed_curve_text(view, scene.curves, scene.quantity, unit) {
            commands.push(SelectionCommand::ShowStatus(words).into());
        }
    }
}

/// Conditions at the same airspeed, whose curves share a name.
struct AirspeedGroup {
    airspeed_kt: f64,
    conditions: Vec<ConditionId>,
    name: GroupName,
}

/// Returns the names in the right margin, where the curves end: one for each airspeed, in
/// increasing order, with the condition count if it has several: "140 kt × 2". A name has the
/// colour of its first curve.
fn group_names(state: &State, curves: &[BodeCurve]) -> Vec<GroupName> {
    let mut groups: Vec<AirspeedGroup> = Vec::new();
    for curve in curves {
        let CurveId::OfCondition(id, _) = curve.id else {
            continue;
        };
        let Some(condition) = state.dataset().condition(id) else {
            continue;
        };
        let airspeed_kt = condition.flight_state().airspeed_kt;
        let known = groups
            .iter()
            .position(|group| group.airspeed_kt == airspeed_kt);
        let group_index = known.unwrap_or_else(|| {
            groups.push(AirspeedGroup {
                airspeed_kt,
                conditions: Vec::new(),
                name: GroupName {
                    text: String::new(),
                    role: curve.role,
                    curves: Vec::new(),
                },
            });
            groups.len() - 1
        });
        let group = &mut groups[group_index];
        if !group.conditions.contains(&id) {
            group.conditions.push(id);
        }
        group.name.curves.push(curve.id.clone());
    }
    groups.sort_by(|a, b| a.airspeed_kt.total_cmp(&b.airspeed_kt));
    let mut names = Vec::new();
    for AirspeedGroup {
        airspeed_kt,
        conditions,
        mut name,
    } in groups
    {
        name.text = match conditions.len() {
            1 => format!("{airspeed_kt:.0} kt"),
            count => format!("{airspeed_kt:.0} kt × {count}"),
        };
        names.push(name);
    }
    names
}

/// Returns the text beside the title: "all 11 conditions", or "9 of 11 conditions" if only those in
/// the schedule are shown.
pub fn across_context(state: &State) -> String {
    let count = state.dataset().conditions().len();
    let shown = state.display.frequency.across_display.conditions;
    match shown {
        AcrossConditions::All => format!("all {}", counted(count, "condition")),
        AcrossConditions::InSchedule => {
            format!(
                "{} of {}",
                shown.of_study(&state.study).len(),
                counted(count, "condition")
            )
        }
    }
}
