//! Modes in the displayed condition, as a card in the requirement details: the modes of the
//! identified model, each compared with its counterpart in the judged model, which is the physics
//! representative with the displayed correction (M17.3: docs/requirements.md).

use egui::{Align2, Rect, Role, ScrollArea, Sense, Ui, pos2, vec2};

use gdcm_method::requirements::ModeVerdict;
use gdcm_model::number_format::decimals;
use gdcm_study::results::grid_requirement::Requirement;
use gdcm_study::results::required_modes::{ModeFinding, ModeNumbers};
use gdcm_study::results::requirement_role::RequirementRole;
use gdcm_study::results::requirements::Requirements;
use gdcm_words::missing_results::missing_reason_text;
use gdcm_words::requirement_grid::NOT_DETERMINED_SIGN;
use gdcm_words::requirements::mode_verdict_words;

use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::named;
use crate::gui::widgets::elision::elided;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, small};

/// Row height \[pt\].
const ROW: f32 = 19.0;
/// Right edges of the judged model's modulus and damping ratio, as shares of the width.
const JUDGED_EDGES: [f32; 2] = [0.42, 0.515];
/// Right edges of the identified model's modulus and damping ratio, as shares of the width.
const IDENTIFIED_EDGES: [f32; 2] = [0.635, 0.73];
/// Gap between the last number and the verdict \[pt\].
const VERDICT_GAP: f32 = 8.0;
/// Right edge of the name column, as a share of the width.
const NAME_EDGE: f32 = 0.32;

/// Draws the modes in the displayed condition, without horizontal scrolling: name, modulus and
/// damping ratio for the judged and the identified model, verdict. A click shows the poles.
pub(super) fn modes_detail_ui(
    ui: &mut Ui,
    state: &State,
    requirements: &Requirements,
    selected: Option<Requirement>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let condition = state.condition().id();
    if let Some(why) = requirements.missing_modes_reason(condition) {
        ui.label(palette.dim(missing_reason_text(why)));
        return;
    }
    let role = state.display.judging.requirements.role();
    let mut modes: Vec<&ModeFinding> = Vec::new();
    for mode in &requirements.modes {
        if mode.condition == condition {
            modes.push(mode);
        }
    }
    // Gains, delays and leads move no pole: only with couplings, the corrected model has modes of
    // its own.
    let is_coupled = modes.iter().any(|mode| mode.corrected_verdict.is_some());
    let width = ui.available_width();
    let (head, _) = ui.allocate_exact_size(vec2(width, ROW), Sense::hover());
    let model = if is_coupled { "corrected" } else { "physics" };
    paint_headings(ui, head, model, palette);
    ScrollArea::vertical()
        .id_salt("modes of the condition")
        .auto_shrink(false)
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let width = ui.available_width();
            for mode in modes {
                let (area, _) = ui.allocate_exact_size(vec2(width, ROW), Sense::hover());
                // A mode without a name has no requirement.
                let is_selected = match mode.name {
                    Some(name) => selected == Some(Requirement::ModeFrequency(name)),
                    None => false,
                };
                let row = ModeRow {
                    mode,
                    role,
                    is_selected,
                    palette,
                };
                row.ui(ui, area, commands);
            }
            let note = if is_coupled {
                "Couplings move poles; gains, delays and leads do not"
            } else {
                "Unchanged by gains, delays and leads; only couplings and changes to the physics \
                    model move poles"
            };
            ui.label(palette.small(note));
        });
}

fn paint_headings(ui: &Ui, row: Rect, model: &str, palette: &Palette) {
    let painter = ui.painter();
    for (edge, text) in [
        (JUDGED_EDGES[1], format!("{model} \u{3c9} [rad/s], \u{3b6}")),
        (IDENTIFIED_EDGES[1], "ident. \u{3c9}, \u{3b6}".to_owned()),
    ] {
        let at = pos2(row.left() + edge * row.width(), row.center().y);
        painter.text(at, Align2::RIGHT_CENTER, text, small(), palette.dim_text);
    }
}

struct ModeRow<'a> {
    mode: &'a ModeFinding,
    role: RequirementRole,
    /// Whether the selected requirement concerns this mode.
    is_selected: bool,
    palette: &'a Palette,
}

impl ModeRow<'_> {
    fn ui(&self, ui: &Ui, row: Rect, commands: &mut Vec<Command>) {
        let palette = self.palette;
        let id = ui.scope_id().with(("mode", self.mode.number));
        let response = ui.interact(row, id, Sense::click());
        let painter = ui.painter();
        if self.is_selected {
            painter.rect_filled(row, 3.0, palette.selected);
        } else if response.hovered() || response.has_focus() {
            painter.rect_filled(row, 3.0, palette.raised);
        }
        let judged = self.mode.of_role(self.role);
        let name = self.name();
        let left = row.left() + 6.0;
        let shown = elided(ui, &name, NAME_EDGE * row.width() - 8.0, BODY_SIZE);
        let at = pos2(left, row.center().y);
        painter.text(at, Align2::LEFT_CENTER, shown, body(), palette.text);
        self.paint_numbers(ui, row, JUDGED_EDGES, judged.numbers);
        let identified = Some(&self.mode.identified);
        self.paint_numbers(ui, row, IDENTIFIED_EDGES, identified);
        let color = match judged.verdict {
            ModeVerdict::Outside => palette.warning,
            _ => palette.dim_text,
        };
        let room = (1.0 - IDENTIFIED_EDGES[1]) * row.width() - VERDICT_GAP;
        let verdict = verdict_words(judged.verdict);
        let shown = elided(ui, verdict, room, SMALL_SIZE);
        let at = pos2(
            row.left() + IDENTIFIED_EDGES[1] * row.width() + VERDICT_GAP,
            row.center().y,
        );
        painter.text(at, Align2::LEFT_CENTER, shown, small(), color);
        let words = match self.mode.name {
            Some(_) => format!("Mode {name}: {}", mode_verdict_words(judged.verdict)),
            None => format!("{name}: {}", mode_verdict_words(judged.verdict)),
        };
        let response = named(response, Role::Button, words);
        if response.clicked() {
            commands.push(LayoutCommand::ShowView(View::Poles).into());
        }
    }

    /// Returns the mode's name with a capital letter, else its number.
    fn name(&self) -> String {
        match self.mode.name {
            Some(name) => {
                let name = name.to_string();
                let mut letters = name.chars();
                match letters.next() {
                    Some(first) => first.to_uppercase().chain(letters).collect(),
                    None => name,
                }
            }
            None => format!("Mode {}", self.mode.number),
        }
    }

    /// Draws modulus and damping ratio, right-aligned; a real mode has no damping ratio.
    fn paint_numbers(&self, ui: &Ui, row: Rect, edges: [f32; 2], numbers: Option<&ModeNumbers>) {
        let mut texts = [NOT_DETERMINED_SIGN.to_owned(), String::new()];
        if let Some(numbers) = numbers {
            texts[0] = decimals(numbers.modulus_rad_s(), 2);
            if numbers.values.period_s.is_some()
                && let Some(damping) = numbers.values.damping_ratio
            {
                texts[1] = decimals(damping, 2);
            }
        }
        for (edge, text) in edges.into_iter().zip(texts) {
            let at = pos2(row.left() + edge * row.width(), row.center().y);
            let color = self.palette.text;
            ui.painter()
                .text(at, Align2::RIGHT_CENTER, text, small(), color);
        }
    }
}

/// Returns the verdict's text, short enough for its column.
fn verdict_words(verdict: ModeVerdict) -> &'static str {
    match verdict {
        ModeVerdict::Within => "met",
        ModeVerdict::NotDetermined => "not determined",
        _ => mode_verdict_words(verdict),
    }
}
