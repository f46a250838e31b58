//! Cautions about the identified models, each in two lines. A button beside them applies the first
//! remedy (`caution_remedies`), if there is any; further remedies are in a menu.

use std::sync::Arc;

use egui::containers::menu::MenuButton;
use egui::{Button, Rect, RichText, Role, Sense, Ui, UiBuilder, vec2};

use gdcm_model::dataset::BundleKind;
use gdcm_model::units::s_to_ms;
use gdcm_study::results::channel_time_skew::ChannelTimeSkew;
use gdcm_words::channel_time_skew::time_skew_text;
use gdcm_words::flight_plan::caution_with_advice;
use gdcm_words::identification_caution::short_caution;

use super::caution_remedies::{Remedy, caution_remedies, remove_common_delay};
use super::frame_cache::{Source, cached};
use super::next_flight::planned_channels;
use super::page::Page;
use crate::gui::commands::command::Command;
use crate::gui::widgets::controls::{Asks, hint_left_of, named};
use crate::gui::widgets::elision::{elided, text_width};
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, SMALL_SIZE, body, medium, small};

/// Heading height \[pt\].
const HEADING: f32 = 20.0;
/// Caution height \[pt\].
const ENTRY: f32 = 36.0;
/// Width reserved for the caution sign \[pt\].
const SIGN: f32 = 20.0;
/// Width of the button that opens the menu with further remedies \[pt\].
const MENU: f32 = 20.0;
const BUTTON_HEIGHT: f32 = 22.0;

/// Caution with its remedies.
struct Entry {
    title: String,
    detail: String,
    /// Complete text, shown as a tooltip.
    text: String,
    remedies: Vec<Remedy>,
}

/// Lists the cautions. Cautions about outdated models remain, since several remedies may be applied
/// one after another.
pub(super) fn caution_list_ui(ui: &mut Ui, page: Page<'_>, commands: &mut Vec<Command>) {
    let palette = page.palette;
    let entries = entries(ui, page);
    let size = vec2(ui.available_width(), HEADING);
    let (heading, _) = ui.allocate_exact_size(size, Sense::hover());
    painted_text(
        ui,
        heading,
        0.0,
        "Cautions",
        medium(BODY_SIZE),
        palette.text,
    );
    let count = match page.records.identification() {
        Some(_) if page.is_outdated() => format!("{}, outdated", entries.len()),
        Some(_) => entries.len().to_string(),
        None => "–".to_owned(),
    };
    painted_text(ui, heading, AT_RIGHT_END, &count, small(), palette.dim_text);
    for (number, entry) in entries.iter().enumerate() {
        entry_ui(ui, page, entry, number, commands);
    }
}

/// Collects the cautions about the latest identification.
fn entries(ui: &Ui, page: Page<'_>) -> Vec<Entry> {
    let Some(found) = page.records.identification() else {
        return Vec::new();
    };
    let channels = planned_channels(page.state.dataset());
    let mut entries = Vec::new();
    for caution in &found.cautions {
        let short = short_caution(caution);
        entries.push(Entry {
            title: short.title,
            detail: short.detail,
            text: caution_with_advice(caution, &found.advice, &channels),
            remedies: caution_remedies(ui, page.records, caution),
        });
    }
    entries.extend(late_channel(ui, page));
    entries
}

/// Returns a caution about a channel that is delayed equally in all records, which only a
/// comparison with a physics model can reveal.
fn late_channel(ui: &Ui, page: Page<'_>) -> Option<Entry> {
    let Page { state, records, .. } = page;
    let (job, outcome) = records.found.as_ref()?;
    let found = outcome.as_ref().ok()?;
    let condition = state.condition();
    let physics = condition
        .bundle(BundleKind::Physics)
        .get(condition.nominal())?;
    let sources: [Source; 2] = [Arc::clone(found) as _, Arc::clone(condition) as _];
    let late = cached(ui, "late channel", &sources, (), || {
        ChannelTimeSkew::of_condition(&found.measured, job.request.options.band, condition)
    });
    let late = (*late)?;
    let signal = late.signal(state.dataset())?;
    Some(Entry {
        title: format!("{} late by {:.0} ms", signal.name, s_to_ms(late.delay_s)),
        detail: format!("in all records, against {}", physics.name),
        text: time_skew_text(&late, &signal.name, &physics.name),
        remedies: vec![remove_common_delay(records, &signal, late.delay_s)],
    })
}

/// Draws a caution in two lines, with its remedies at the right.
fn entry_ui(
    ui: &mut Ui,
    page: Page<'_>,
    entry: &Entry,
    number: usize,
    commands: &mut Vec<Command>,
) {
    let palette = page.palette;
    let size = vec2(ui.available_width(), ENTRY);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    if number > 0 {
        ui.painter().hline(
            rect.x_range(),
            rect.top(),
            egui::Stroke::new(1.0, palette.line),
        );
    }
    let response = named(response, Role::Label, entry.text.clone());
    hint_left_of(response, rect, &entry.text);
    let mut buttons = 0.0;
    if let Some(first) = entry.remedies.first() {
        buttons = text_width(ui, &first.short, body()) + 18.0;
        if entry.remedies.len() > 1 {
            buttons += MENU + 2.0;
        }
    }
    let inner = rect.shrink2(vec2(0.0, 1.0));
    let upper = inner.with_max_y(inner.center().y);
    let lower = inner.with_min_y(inner.center().y);
    painted_text(ui, upper, 0.0, "⚠", body(), palette.warning);
    let room = rect.width() - SIGN - buttons - 6.0;
    let title = elided(ui, &entry.title, room, BODY_SIZE);
    painted_text(ui, upper, SIGN, &title, body(), palette.text);
    let detail = elided(ui, &entry.detail, room, SMALL_SIZE);
    painted_text(ui, lower, SIGN, &detail, small(), palette.dim_text);
    if buttons > 0.0 {
        let place = Rect::from_min_max(
            rect.right_center() - vec2(buttons, 0.5 * BUTTON_HEIGHT),
            rect.right_center() + vec2(0.0, 0.5 * BUTTON_HEIGHT),
        );
        ui.scope_builder(UiBuilder::new().max_rect(place).id_salt(number), |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                ui.spacing_mut().button_padding = vec2(8.0, 2.0);
                remedies_ui(ui, &entry.remedies, commands);
            });
        });
        // The buttons end above the entry's lower edge.
        ui.advance_cursor_after_rect(rect);
    }
}

/// Draws the first remedy as a button, and the others in a menu beside it.
fn remedies_ui(ui: &mut Ui, remedies: &[Remedy], commands: &mut Vec<Command>) {
    let Some((first, others)) = remedies.split_first() else {
        return;
    };
    remedy_ui(ui, first, commands);
    if others.is_empty() {
        return;
    }
    let button = Button::new(RichText::new("▾")).min_size(vec2(MENU, BUTTON_HEIGHT));
    ui.spacing_mut().button_padding.x = 2.0;
    let (response, _) = MenuButton::from_button(button).ui(ui, |ui| {
        for remedy in others {
            if ui.button(&remedy.label).clicked() {
                commands.push(remedy.command.clone());
                ui.close();
            }
        }
    });
    named(
        response,
        Role::Button,
        format!("Instead of: {}", first.label),
    );
}

/// Draws a remedy as a small button, with its whole label as the accessible name.
pub(super) fn remedy_ui(ui: &mut Ui, remedy: &Remedy, commands: &mut Vec<Command>) {
    let button = Button::new(&remedy.short).min_size(vec2(0.0, BUTTON_HEIGHT));
    let response = named(ui.add(button), Role::Button, remedy.label.clone());
    let response = if remedy.label == remedy.short {
        response
    } else {
        response.on_hover_text(&remedy.label)
    };
    response.asks(remedy.command.clone(), commands);
}
