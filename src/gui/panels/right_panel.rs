//! Right side of the window, from top to bottom: verdict, result, constraint matrix, focused
//! response's card, settings line, export.
//!
//! The reasons explain the result (`reasons.rs`). The card lists the required and the remaining
//! corrections of the response in focus.

use egui::{Align2, Button, Frame, Margin, Panel, Rect, RichText, Role, Sense, Ui, pos2, vec2};

use gdcm_method::correction::delta::GainSource;
use gdcm_model::number_format::counted;
use gdcm_model::units::number;
use gdcm_study::PhaseCorrection;
use gdcm_study::decisions::setting::Setting;
use gdcm_study::decisions::setting_table;
use gdcm_words::verdict::band_text;

use super::advice::export;
use super::matrix_panel::MatrixSpace;
use super::reasons::reasons_inspector_ui;
use super::result_panel::OLDER;
use super::verdict::Verdict;
use super::verdict_view::{shown_verdict, verdict_ui};
use super::{matrix_panel, response_card, result_panel};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::window_state::State;
use crate::gui::views::view_content;
use crate::gui::widgets::controls::{Asks, named_switch};
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::escape_key::take_escape;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, chevron, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, medium, small};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Padding at the left and at the right of the panel \[pt\].
const PADDING: f32 = 12.0;
/// Settings line height \[pt\].
const LINE: f32 = 36.0;
/// Export row height \[pt\].
const FOOT: f32 = 48.0;
/// Minimum window height that shows the focused response's card \[pt\].
const LEAST_WITH_CARD: f32 = 860.0;
/// Minimum window height that shows the full result; in lower windows the result takes a single
/// line \[pt\].
const LEAST_WITH_RESULT: f32 = 600.0;

/// Draws the settings line and the export row at the foot, the verdict at the top, and between
/// them: the reasons, if they are open; else what the view in front puts there; else result, matrix
/// and, in a high window, the focused response's card.
pub fn right_panel_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let shown = shown_verdict(ui, state);
    let foot = Frame::new().inner_margin(Margin::ZERO);
    Panel::bottom("export")
        .frame(foot)
        .exact_size(LINE + FOOT)
        .show(ui, |ui| {
            region_ui(ui, Region::Settings, |ui| {
                settings_line_ui(ui, state, palette, commands)
            });
            export_ui(ui, state, &shown.verdict, palette, commands);
        });
    let window = ui.ctx().content_rect().height();
    let frame = Frame::new().inner_margin(Margin {
        left: PADDING as i8,
        right: PADDING as i8,
        top: 8,
        bottom: 4,
    });
    frame.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        // The width is fixed here, so that wide content in one part does not widen the next part.
        let width = ui.available_width();
        let is_wide = state.display.layout.is_wide;
        region_ui(ui, Region::Verdict, |ui| {
            verdict_ui(ui, &shown, is_wide, palette, commands)
        });
        ui.add_space(8.0);
        ui.set_max_width(width);
        if state.display.layout.sheet == Some(Sheet::Reasons) {
            return reasons_inspector_ui(ui, state, palette, commands);
        }
        let view = state.display.layout.arrangement.view();
        if let Some(side_ui) = view_content(view).side {
            return side_ui(ui, state, palette, commands);
        }
        if shown.is_older {
            ui.multiply_opacity(OLDER);
        }
        let is_folded = window < LEAST_WITH_RESULT;
        region_ui(ui, Region::Result, |ui| {
            result_panel::result_ui(ui, state, is_folded, palette, commands)
        });
        ui.add_space(8.0);
        let card = if window >= LEAST_WITH_CARD {
            response_card::CARD_HEIGHT + 12.0
        } else {
            0.0
        };
        let space = MatrixSpace {
            height: ui.available_height() - card,
            has_card: card > 0.0,
        };
        matrix_panel::matrix_ui(ui, state, space, palette, commands);
        if card > 0.0 {
            ui.add_space(12.0);
            response_card::card_ui(ui, state, palette);
        }
    });
}

/// Draws the settings in a single line, the changed ones in the text colour; a click opens and
/// closes the settings at the left, Escape closes them.
fn settings_line_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let is_open = state.display.layout.settings_open;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::click());
    ui.painter().hline(
        rect.x_range(),
        rect.top(),
        ui.visuals().widgets.noninteractive.bg_stroke,
    );
    if response.hovered() {
        ui.painter()
            .rect_filled(rect.shrink2(vec2(0.0, 1.0)), 0.0, palette.raised);
    }
    let inner = rect.shrink2(vec2(PADDING, 0.0));
    let title = painted_text(ui, inner, 0.0, "Settings", medium(BODY_SIZE), palette.text);
    let parts = settings_parts(state);
    let mut x = title.right() - inner.left() + 10.0;
    for (place, part) in parts.iter().enumerate() {
        if place > 0 {
            let dot = painted_text(ui, inner, x, " · ", small(), palette.dim_text);
            x = dot.right() - inner.left();
        }
        let room = inner.width() - x - 22.0;
        let shown = elided(ui, &part.text, room, SMALL_SIZE);
        let color = if part.is_changed {
            palette.text
        } else {
            palette.dim_text
        };
        x = painted_text(ui, inner, x, &shown, small(), color).right() - inner.left();
        if shown != part.text {
            break;
        }
    }
    let end = pos2(inner.right() - 5.0, inner.center().y);
    if is_open {
        let color = palette.dim_text;
        ui.painter()
            .text(end, Align2::CENTER_CENTER, "×", body(), color);
    } else {
        chevron(ui, end, is_open, palette);
    }
    let response = named_switch(response, Role::Button, is_open, "Settings");
    if response.clicked() || (is_open && take_escape(ui.ctx())) {
        commands.push(LayoutCommand::ShowSettings(!is_open).into());
    }
    let texts: Vec<&str> = parts.iter().map(|part| part.text.as_str()).collect();
    let action = if is_open { "Close" } else { "Open" };
    let words = texts.join(" · ");
    response.on_hover_text(format!("{words}\n{action} with Ctrl+comma"));
}

struct LinePart {
    text: String,
    /// Whether any of the part's settings has changed since the settings were opened.
    is_changed: bool,
}

impl LinePart {
    /// Creates the part for `settings`, and removes these from the `changed` settings.
    fn new(text: String, settings: &[&Setting], changed: &mut Vec<&'static Setting>) -> Self {
        let before = changed.len();
        changed.retain(|setting| !settings.contains(setting));
        Self {
            text,
            is_changed: changed.len() < before,
        }
    }
}

/// Returns the count of changed settings that have no part of their own, if there are any, and the
/// parts "α 1", "0.5–12 rad/s", "delays", "representatives". α is the weight of the output gains'
/// deviation from 1; the last part says from which models the gains follow. A narrow window omits
/// it, unless gains are means over pairs, which is not the default.
fn settings_parts(state: &State) -> Vec<LinePart> {
    let settings = &state.study.settings;
    let gains = number(settings.alpha_gain);
    let delays = number(settings.alpha_delay);
    let alpha = if gains == delays {
        format!("α {gains}")
    } else {
        format!("α {gains}, {delays}")
    };
    let phase = match settings.phase {
        PhaseCorrection::None => "gains only",
        PhaseCorrection::Delay => "delays",
        PhaseCorrection::Lead => "leads",
    };
    let mut changed = state.changed_settings();
    let mut parts = vec![
        LinePart::new(
            alpha,
            &[&setting_table::ALPHA_GAIN, &setting_table::ALPHA_DELAY],
            &mut changed,
        ),
        LinePart::new(
            band_text(&state.study),
            &[&setting_table::BAND],
            &mut changed,
        ),
        LinePart::new(phase.to_owned(), &[&setting_table::PHASE], &mut changed),
    ];
    if settings.gain_source == GainSource::MeanOfPairs || state.display.layout.is_wide {
        let source = setting_table::GAIN_SOURCE.text(setting_table::GAIN_SOURCE.value(settings));
        parts.push(LinePart::new(
            source,
            &[&setting_table::GAIN_SOURCE],
            &mut changed,
        ));
    }
    if !changed.is_empty() {
        parts.insert(
            0,
            LinePart {
                text: format!("{} changed", counted(changed.len(), "other")),
                is_changed: true,
            },
        );
    }
    parts
}

/// Draws the export button, which is always visible, and primary if no other step is left.
fn export_ui(
    ui: &mut Ui,
    state: &State,
    verdict: &Verdict,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), FOOT), Sense::hover());
    ui.painter().hline(
        rect.x_range(),
        rect.top(),
        ui.visuals().widgets.noninteractive.bg_stroke,
    );
    let inner = rect.shrink2(vec2(PADDING, 10.0));
    let is_ready = state.analysis().is_some();
    let is_primary = verdict
        .steps
        .first()
        .is_some_and(|step| step.command == export());
    let color = if is_primary {
        palette.on_accent()
    } else {
        palette.text
    };
    let button = Button::new(
        RichText::new("Export corrections…")
            .font(medium(BODY_SIZE))
            .color(color),
    );
    let button = if is_primary {
        button.fill(palette.accent)
    } else {
        button
    };
    let place = Rect::from_min_size(inner.min, vec2(140.0, 28.0));
    region_ui(ui, Region::Export, |ui| {
        ui.scope_builder(egui::UiBuilder::new().max_rect(place), |ui| {
            let export_button = ui.add_enabled(is_ready, button.min_size(place.size()));
            let hint = "Choose formats, conditions and folder; nothing is written until you export (Ctrl+E)";
            export_button.on_hover_text(hint).asks(export(), commands);
        });
    });
    let count = state.dataset().conditions().len();
    let mut content = counted(count, "condition");
    let has_schedule = state
        .analysis()
        .is_some_and(|analysis| analysis.schedule.is_ok());
    if has_schedule {
        content.push_str(", schedule");
    }
    painted_text(ui, inner, AT_RIGHT_END, &content, body(), palette.dim_text);
}
