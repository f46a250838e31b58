//! Cautions about the identified models, each in two lines. A *caution* is a finding that makes the
//! models doubtful, a *remedy* a button that removes its cause or shows it (`caution_remedies`).
//! The first remedy is beside the caution, further ones are in a menu.

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
/// Height of a caution's two lines \[pt\].
const CAUTION: f32 = 36.0;
/// Width reserved for the caution sign \[pt\].
const SIGN: f32 = 20.0;
/// Width of the button that opens the menu with further remedies \[pt\].
const MENU: f32 = 20.0;
const BUTTON_HEIGHT: f32 = 22.0;
/// Space at the left and at the right of a button's text \[pt\].
const BUTTON_PADDING: f32 = 8.0;
/// Gap between the button and the menu \[pt\].
const BUTTON_GAP: f32 = 2.0;

/// Caution as listed, with its remedies.
struct ListedCaution {
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
    let cautions = listed_cautions(ui, page);
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
        Some(_) if page.is_outdated() => format!("{}, outdated", cautions.len()),
        Some(_) => cautions.len().to_string(),
        None => "–".to_owned(),
    };
    painted_text(ui, heading, AT_RIGHT_END, &count, small(), palette.dim_text);
    for (number, caution) in cautions.iter().enumerate() {
        caution_ui(ui, page, caution, number, commands);
    }
}

/// Collects the cautions about the latest identification.
fn listed_cautions(ui: &Ui, page: Page<'_>) -> Vec<ListedCaution> {
    let Some(identification) = page.records.identification() else {
        return Vec::new();
    };
    let channels = planned_channels(page.state.dataset());
    let mut listed = Vec::new();
    for caution in &identification.cautions {
        let short = short_caution(caution);
        listed.push(ListedCaution {
            title: short.title,
            detail: short.detail,
            text: caution_with_advice(caution, &identification.advice, &channels),
            remedies: caution_remedies(ui, page.records, caution),
        });
    }
    listed.extend(late_channel_caution(ui, page));
    listed
}

/// Returns a caution about a channel that is delayed equally in all records, which only a
/// comparison with a physics model can reveal.
fn late_channel_caution(ui: &Ui, page: Page<'_>) -> Option<ListedCaution> {
    let Page { state, records, .. } = page;
    let latest = records.latest.as_ref()?;
    let identification = latest.outcome.as_ref().ok()?;
    let condition = state.condition();
    let physics = condition
        .bundle(BundleKind::Physics)
        .get(condition.nominal())?;
    let sources: [Source; 2] = [Arc::clone(identification) as _, Arc::clone(condition) as _];
    let time_skew = cached(ui, "late channel", &sources, (), || {
        ChannelTimeSkew::of_condition(
            &identification.measured,
            latest.job.request.options.band,
            condition,
        )
    });
    let late = (*time_skew)?;
    let signal = late.signal(state.dataset())?;
    Some(ListedCaution {
        title: format!("{} late by {:.0} ms", signal.name, s_to_ms(late.delay_s)),
        detail: format!("in all records, against {}", physics.name),
        text: time_skew_text(&late, &signal.name, &physics.name),
        remedies: vec![remove_common_delay(records, &signal, late.delay_s)],
    })
}

/// Draws a caution in two lines, with its remedies at the right.
fn caution_ui(
    ui: &mut Ui,
    page: Page<'_>,
    caution: &ListedCaution,
    number: usize,
    commands: &mut Vec<Command>,
) {
    let palette = page.palette;
    let size = vec2(ui.available_width(), CAUTION);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    if number > 0 {
        ui.painter().hline(
            rect.x_range(),
            rect.top(),
            egui::Stroke::new(1.0, palette.line),
        );
    }
    let response = named(response, Role::Label, caution.text.clone());
    hint_left_of(response, rect, &caution.text);
    let buttons_width = buttons_width(ui, &caution.remedies);
    let inner = rect.shrink2(vec2(0.0, 1.0));
    let upper = inner.with_max_y(inner.center().y);
    let lower = inner.with_min_y(inner.center().y);
    painted_text(ui, upper, 0.0, "⚠", body(), palette.warning);
    let room = rect.width() - SIGN - buttons_width - 6.0;
    let title = elided(ui, &caution.title, room, BODY_SIZE);
    painted_text(ui, upper, SIGN, &title, body(), palette.text);
    let detail = elided(ui, &caution.detail, room, SMALL_SIZE);
    painted_text(ui, lower, SIGN, &detail, small(), palette.dim_text);
    if buttons_width > 0.0 {
        let place = Rect::from_min_max(
            rect.right_center() - vec2(buttons_width, 0.5 * BUTTON_HEIGHT),
            rect.right_center() + vec2(0.0, 0.5 * BUTTON_HEIGHT),
        );
        ui.scope_builder(UiBuilder::new().max_rect(place).id_salt(number), |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = BUTTON_GAP;
                ui.spacing_mut().button_padding = vec2(BUTTON_PADDING, 2.0);
                remedies_ui(ui, &caution.remedies, commands);
            });
        });
        // The buttons end above the caution's lower edge.
        ui.advance_cursor_after_rect(rect);
    }
}

/// Returns the width that the remedies' buttons need \[pt\]; 0 without any.
fn buttons_width(ui: &Ui, remedies: &[Remedy]) -> f32 {
    let Some((first, others)) = remedies.split_first() else {
        return 0.0;
    };
    let mut width = text_width(ui, &first.short, body()) + (2.0 * BUTTON_PADDING + 2.0);
    if !others.is_empty() {
        width += BUTTON_GAP + MENU;
    }
    width
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
        format!("Alternatives to: {}", first.label),
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
