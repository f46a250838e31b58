//! Bundles of the displayed condition: kept models, representatives, suspected outliers.

use std::collections::BTreeMap;

use egui::{
    Align, Checkbox, Grid, Layout, Rect, RichText, Role, ScrollArea, Sense, Ui, UiBuilder,
    WidgetInfo, pos2, vec2,
};

use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{BundleKind, Model, ModelId};
use gdcm_model::number_format::compact;
use gdcm_study::Edit;
use gdcm_words::ExplainTarget;
use gdcm_words::caution::caution_text;

use super::explanation::question_menu_ui;
use super::table_menu::{table_heading_ui, table_menu_ui};
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::tables::TableKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{
    Asks, ROW_HEIGHT, chevron, elided_among, entries_ui, named, named_switch, painted_text,
    row_text,
};
use crate::gui::widgets::focus::{Region, region_ui};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, medium, small};

/// Draws the bundles of the displayed condition in the left panel: the physics models above, the
/// identified models folded at its foot.
pub fn models_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    region_ui(ui, Region::Models, |ui| {
        let is_open = state.display.layout.identified_open;
        let room = ui.available_height();
        // A single line reports the absence of models.
        let models = state
            .condition()
            .bundle(BundleKind::Identified)
            .len()
            .max(1) as f32;
        let height = if is_open {
            (FOLD + ROW_HEIGHT * models + 8.0).min(0.5 * room)
        } else {
            FOLD
        };
        ui.spacing_mut().item_spacing.y = 0.0;
        let (above, below) = ui
            .available_rect_before_wrap()
            .split_top_bottom_at_y(ui.max_rect().bottom() - height);
        ui.scope_builder(
            UiBuilder::new().id_salt("physics models").max_rect(above),
            |ui| {
                physics_ui(ui, state, palette, commands);
            },
        );
        ui.scope_builder(
            UiBuilder::new()
                .id_salt("identified models")
                .max_rect(below),
            |ui| {
                fold_ui(ui, state, is_open, palette, commands);
                if is_open {
                    rows_ui(ui, state, palette, BundleKind::Identified, commands);
                }
            },
        );
    });
}

/// Draws a bundle in a sheet beside the rail.
pub fn bundle_sheet_ui(
    ui: &mut Ui,
    state: &State,
    kind: BundleKind,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    ui.spacing_mut().item_spacing.y = 0.0;
    // The sheet has its own heading.
    region_ui(ui, Region::Models, |ui| {
        if kind == BundleKind::Physics {
            at_once_ui(ui, state, palette, commands);
        }
        rows_ui(ui, state, palette, kind, commands);
    });
}

/// Height of the line that folds the identified models \[pt\].
const FOLD: f32 = 36.0;

fn physics_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let kind = BundleKind::Physics;
    let title = format!("Physics models of {}", state.condition().id());
    table_heading_ui(
        ui,
        palette,
        (&title, &state.kept_words(kind)),
        TableKind::of_bundle(kind),
        commands,
    );
    at_once_ui(ui, state, palette, commands);
    rows_ui(ui, state, palette, kind, commands);
}

/// Draws the actions on all models at once, above the list and always within reach.
fn at_once_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let choice = state.study.choice(condition);
    let rejected = choice.physics.rejected.len();
    let open = state
        .shown()
        .map(|shown| state.open_suggestions(shown))
        .unwrap_or_default();
    ui.allocate_ui_with_layout(vec2(ui.available_width(), 28.0), Layout::left_to_right(Align::Center), |ui| {
        let words = match (open.len(), rejected) {
            (0, 0) => "none suggested".to_owned(),
            (0, rejected) => format!("{rejected} rejected"),
            (open, 0) => format!("{open} suggested"),
            (open, rejected) => format!("{open} suggested, {rejected} rejected"),
        };
        ui.label(if open.is_empty() { palette.small(words) } else { palette.small_warning(words) });
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if rejected > 0 || !choice.identified.rejected.is_empty() {
                let restore = ui.button("Restore all");
                restore
                    .on_hover_text("Put every rejected model of this condition back")
                    .asks(Edit::RestoreAll { condition }, commands);
            }
            if !open.is_empty() {
                let button = named(ui.button("Reject suggested"), Role::Button, "Reject suggested models");
                let hint = format!("Reject every model whose discontinuity ratio exceeds {SUGGESTION_RATIO} (Ctrl+R)");
                button.on_hover_text(hint).asks(Edit::reject_physics(condition, &open), commands);
            }
        });
    });
}

/// Draws the line that folds and unfolds the identified models.
fn fold_ui(
    ui: &mut Ui,
    state: &State,
    is_open: bool,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), FOLD), Sense::click());
    ui.painter().hline(
        row.expand2(vec2(12.0, 0.0)).x_range(),
        row.top(),
        ui.visuals().widgets.noninteractive.bg_stroke,
    );
    chevron(ui, pos2(row.left() + 6.0, row.center().y), is_open, palette);
    painted_text(
        ui,
        row,
        16.0,
        "Identified models",
        medium(BODY_SIZE),
        palette.text,
    );
    let models = state.condition().bundle(BundleKind::Identified);
    let mut words = state.kept_words(BundleKind::Identified);
    if models.is_empty() {
        words = "none yet".to_owned();
    }
    let name = state
        .shown()
        .map(|shown| shown.representative_name(BundleKind::Identified));
    let order = models
        .iter()
        .find(|model| Some(model.name.as_str()) == name)
        .and_then(Model::order);
    if let Some(order) = order {
        words = format!("order {order} · {words}");
    }
    let place = painted_text(ui, row, -0.01, &words, small(), palette.dim_text);
    if order.is_some() {
        let star = row.with_max_x(place.left() - 3.0);
        painted_text(ui, star, -0.01, "★", small(), palette.identified);
    }
    table_menu_ui(
        ui,
        &response,
        TableKind::of_bundle(BundleKind::Identified),
        commands,
    );
    let response = named_switch(response, Role::Button, is_open, "Identified models");
    response.asks(LayoutCommand::ShowIdentified(!is_open), commands);
}

fn rows_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    kind: BundleKind,
    commands: &mut Vec<Command>,
) {
    let models = state.condition().bundle(kind);
    if models.is_empty() {
        ui.add(
            egui::Label::new(
                palette.small("No identified models yet: identify them from flight records"),
            )
            .wrap(),
        );
        return;
    }
    let trims = TrimColumns::of(models).filter(|_| kind == BundleKind::Physics);
    if kind == BundleKind::Physics {
        heads_ui(ui, trims.as_ref(), palette);
    }
    let names = short_names(models);
    // Controls must not be higher than the row.
    ui.spacing_mut().interact_size.y = 16.0;
    ScrollArea::vertical()
        .id_salt(kind)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for (place, model) in models.iter().enumerate() {
                let neighbours =
                    [place.checked_sub(1), Some(place + 1)].map(|place| names.get(place?).copied());
                let row = ModelRow::of(state, (kind, model), names[place], neighbours);
                row.ui(ui, trims.as_ref(), palette, commands);
            }
        });
}

fn heads_ui(ui: &mut Ui, trims: Option<&TrimColumns>, palette: &Palette) {
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    for (head, end) in trims
        .iter()
        .flat_map(|trims| trims.heads.iter().zip(TRIM_ENDS))
    {
        painted_text(
            ui,
            row.with_max_x(row.left() + end),
            -0.01,
            head,
            small(),
            palette.dim_text,
        );
    }
    painted_text(ui, row, -1.0, "discontinuity", small(), palette.dim_text);
}

/// Right edges of the trim columns \[pt from the row's left edge\].
const TRIM_ENDS: [f32; 3] = [70.0, 114.0, 154.0];

/// Coordinates of the perturbed trims, as columns.
struct TrimColumns {
    keys: Vec<String>,
    heads: Vec<String>,
}

impl TrimColumns {
    /// Returns `None` if a model has no trim, or if there are more coordinates than columns.
    fn of(models: &[Model]) -> Option<Self> {
        let mut keys: Vec<String> = Vec::new();
        for model in models {
            for key in model.perturbation()?.keys() {
                if !keys.contains(key) {
                    keys.push(key.clone());
                }
            }
        }
        let heads = keys.iter().map(|key| trim_head(key)).collect();
        (!keys.is_empty() && keys.len() <= TRIM_ENDS.len()).then_some(Self { keys, heads })
    }

    /// Returns the offsets of a model, "·" for zero; `None` if the model has no offsets.
    fn offsets(&self, model: &Model) -> Option<Vec<String>> {
        let trim = model
            .perturbation()
            .filter(|trim| trim.values().any(|offset| *offset != 0.0))?;
        let offset = |key: &String| trim.get(key).copied().filter(|offset| *offset != 0.0);
        Some(
            self.keys
                .iter()
                .map(|key| offset(key).map_or("·".to_owned(), signed_compact))
                .collect(),
        )
    }
}

/// Returns "V kt" for "airspeed_kt": a name of at most three letters, with its unit if there is
/// room.
fn trim_head(key: &str) -> String {
    match key {
        "airspeed_kt" => "V kt".to_owned(),
        "rate_of_climb_fpm" => "climb".to_owned(),
        "roll_deg" => "roll °".to_owned(),
        "pitch_deg" => "pitch °".to_owned(),
        "yaw_deg" | "heading_deg" => "yaw °".to_owned(),
        other => other
            .split('_')
            .next()
            .unwrap_or(other)
            .chars()
            .take(6)
            .collect(),
    }
}

/// Discontinuity ratio that fills its bar.
const FULL_RATIO: f64 = 4.0;

struct ModelRow<'a> {
    id: ModelId,
    model: &'a Model,
    /// Displayed name.
    name: &'a str,
    /// Names of the models above and below.
    neighbours: [Option<&'a str>; 2],
    kept: bool,
    pinned: bool,
    represents: bool,
    pointed: bool,
    score: Option<f64>,
    ratio: Option<f64>,
    /// Reason why the model is excluded from the comparison.
    set_aside: Option<String>,
    /// Reason of the rejection, in the engineer's words.
    reason: Option<String>,
}

impl<'a> ModelRow<'a> {
    fn of(
        state: &State,
        (kind, model): (BundleKind, &'a Model),
        name: &'a str,
        neighbours: [Option<&'a str>; 2],
    ) -> Self {
        let id = state.model_id(kind, &model.name);
        let shown = state.shown();
        Self {
            model,
            name,
            neighbours,
            kept: !state.study.is_rejected(&id),
            reason: state.study.reason(&id).map(str::to_owned),
            pinned: state
                .study
                .choice(id.condition)
                .bundle(kind)
                .pinned
                .as_ref()
                == Some(&id.name),
            represents: shown.is_some_and(|shown| shown.representative_name(kind) == id.name),
            pointed: state.display.selection.hovered.as_ref() == Some(&id),
            score: shown.and_then(|shown| shown.score(kind, &id.name)),
            ratio: shown
                .filter(|_| kind == BundleKind::Physics)
                .and_then(|shown| shown.discontinuity_ratio(&id.name)),
            set_aside: shown.and_then(|shown| {
                let caution = shown
                    .cautions
                    .iter()
                    .find(|caution| caution.is_set_aside(kind, &model.name))?;
                Some(caution_text(caution, |pair| {
                    state.dataset().pair_name(pair)
                }))
            }),
            id,
        }
    }

    fn ui(
        &self,
        ui: &mut Ui,
        trims: Option<&TrimColumns>,
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let width = ui.available_width();
        // Not focusable by Tab: its actions are on the box, on the star, and in the palette.
        let (rect, response) = ui.allocate_exact_size(vec2(width, ROW_HEIGHT), Sense::CLICK);
        let response = named(
            response,
            Role::Label,
            format!("{} model {}", self.id.bundle, self.model.name),
        );
        if self.pointed || response.contains_pointer() {
            ui.painter().rect_filled(rect, 3.0, palette.raised);
        }
        self.keep_ui(ui, rect, commands);
        self.star_ui(ui, rect, palette, commands);
        // Of a thousand rows only a few are visible.
        if ui.is_rect_visible(rect) {
            let value_width = self.paint_value(ui, rect, palette);
            match trims.and_then(|trims| trims.offsets(self.model)) {
                Some(offsets) => self.paint_offsets(ui, rect, &offsets, palette),
                None => self.paint_name(ui, rect, value_width, palette),
            }
        }
        if response.contains_pointer() {
            commands.push(SelectionCommand::Hover(self.id.clone()).into());
        }
        response.context_menu(|ui| self.menu_ui(ui, commands));
        response.on_hover_ui(|ui| self.tooltip_ui(ui, palette));
    }

    fn menu_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let id = &self.id;
        let decisions = if self.kept {
            [
                ("Reject", Edit::Reject(id.clone()).into()),
                (
                    "Reject with a reason…",
                    Command::Form(FormCommand::AskReason(id.clone())),
                ),
            ]
        } else {
            [
                ("Restore", Edit::Restore(id.clone()).into()),
                (
                    "Say why it is rejected…",
                    Command::Form(FormCommand::AskReason(id.clone())),
                ),
            ]
        };
        entries_ui(ui, decisions, commands);
        entries_ui(
            ui,
            [(
                "Copy its name",
                Command::Output(OutputCommand::CopyText(self.model.name.clone())),
            )],
            commands,
        );
        let ratio = self.ratio.map(|_| {
            (
                "Discontinuity ratio",
                ExplainTarget::DiscontinuityRatio(id.clone()),
            )
        });
        let score = self
            .score
            .map(|_| ("Mean distance", ExplainTarget::Score(id.clone())));
        let values: Vec<_> = ratio
            .into_iter()
            .chain(score)
            .map(|(name, asked)| (name.to_owned(), asked))
            .collect();
        if !values.is_empty() {
            question_menu_ui(ui, values, commands);
        }
    }

    fn keep_ui(&self, ui: &mut Ui, rect: Rect, commands: &mut Vec<Command>) {
        let mut kept = self.kept;
        let place = Rect::from_min_size(rect.min + vec2(3.0, 0.0), vec2(18.0, rect.height()));
        let checkbox = ui.put(place, Checkbox::without_text(&mut kept));
        let name = format!("Keep {} model {}", self.id.bundle, self.model.name);
        let checkbox = named_switch(checkbox, Role::CheckBox, self.kept, name);
        if checkbox.changed() {
            commands.push(
                if kept {
                    Edit::Restore(self.id.clone())
                } else {
                    Edit::Reject(self.id.clone())
                }
                .into(),
            );
        }
        checkbox.on_hover_text(if self.kept {
            "Reject this model"
        } else {
            "Restore this model"
        });
    }

    /// Draws the star of the representative: a click chooses the model, or returns to the medoid.
    fn star_ui(&self, ui: &mut Ui, rect: Rect, palette: &Palette, commands: &mut Vec<Command>) {
        let place = Rect::from_min_size(
            pos2(rect.left() + 24.0, rect.top()),
            vec2(16.0, rect.height()),
        );
        let id = ui.scope_id().with(("star", &self.id));
        let can_represent = self.pinned || (self.kept && self.set_aside.is_none());
        let sense = if can_represent {
            Sense::click()
        } else {
            Sense::hover()
        };
        let response = ui.interact(place, id, sense);
        let name = format!(
            "Use {} model {} as representative",
            self.id.bundle, self.model.name
        );
        response.widget_info(|| {
            WidgetInfo::selected(Role::CheckBox, can_represent, self.pinned, &name)
        });
        let visible = self.represents || response.hovered() || response.has_focus();
        if visible && can_represent {
            let color = if self.represents {
                palette.accent
            } else {
                palette.dim_text
            };
            let symbol = if self.represents { "★" } else { "☆" };
            row_text(ui, rect, 25.0, symbol, BODY_SIZE, color);
        }
        if self.pinned {
            ui.painter().circle_filled(
                pos2(place.right() + 1.0, rect.top() + 5.0),
                1.8,
                palette.warning,
            );
        }
        let condition = self.id.condition;
        let bundle = self.id.bundle;
        let edit = if self.pinned {
            Edit::Unpin { condition, bundle }
        } else {
            Edit::Pin(self.id.clone())
        };
        response.asks(edit, commands);
        let hint = match (self.pinned, self.represents) {
            _ if !can_represent => "Cannot be the representative: rejected or set aside",
            (true, _) if self.set_aside.is_some() => {
                "Chosen as representative, but set aside; click: use the medoid"
            }
            (true, _) => "Representative, chosen by hand; click: use the medoid again",
            (false, true) => "Representative (medoid); click: keep it as representative",
            (false, false) => "Click: use as representative",
        };
        response.on_hover_text(hint);
    }

    /// Paints the ratio with its bar, or the order; returns the width taken on the right.
    fn paint_value(&self, ui: &Ui, rect: Rect, palette: &Palette) -> f32 {
        let dim = if self.kept {
            palette.text
        } else {
            palette.quiet_text
        };
        if self.set_aside.is_some() {
            row_text(ui, rect, -5.0, "set aside", SMALL_SIZE, palette.warning);
            return 60.0;
        }
        if let Some(ratio) = self.ratio {
            row_text(ui, rect, -1.0, &format!("{ratio:.2}"), BODY_SIZE, dim);
            let full = 38.0;
            let bar = Rect::from_min_size(
                pos2(rect.right() - 74.0, rect.center().y - 2.0),
                vec2(full, 4.0),
            );
            ui.painter().rect_filled(bar, 2.0, palette.line);
            let at = |ratio: f64| full * (ratio / FULL_RATIO).clamp(0.0, 1.0) as f32;
            let color = if self.is_suspect() && self.kept {
                palette.warning
            } else {
                palette.quiet_mark
            };
            ui.painter().rect_filled(
                Rect::from_min_size(bar.min, vec2(at(ratio), 4.0)),
                2.0,
                color,
            );
            let tick = bar.left() + at(SUGGESTION_RATIO);
            ui.painter().vline(
                tick,
                bar.expand(2.0).y_range(),
                egui::Stroke::new(1.0, palette.dim_text),
            );
            return 80.0;
        }
        if self.id.bundle == BundleKind::Identified {
            let words = self
                .model
                .order()
                .map_or("measured".to_owned(), |order| format!("order {order}"));
            row_text(ui, rect, -5.0, &words, SMALL_SIZE, palette.dim_text);
            return 60.0;
        }
        5.0
    }

    /// Paints the offsets of the trim, struck out if the model is rejected.
    fn paint_offsets(&self, ui: &Ui, rect: Rect, offsets: &[String], palette: &Palette) {
        for (offset, end) in offsets.iter().zip(TRIM_ENDS) {
            let color = if !self.kept || offset == "·" {
                palette.quiet_text
            } else {
                palette.text
            };
            let upto = rect.with_max_x(rect.left() + end);
            let place = painted_text(ui, upto, -0.01, offset, body(), color);
            if !self.kept && offset != "·" {
                ui.painter().hline(
                    place.x_range(),
                    place.center().y,
                    egui::Stroke::new(1.0, color),
                );
            }
        }
    }

    fn paint_name(&self, ui: &Ui, rect: Rect, value_width: f32, palette: &Palette) {
        let color = if self.kept {
            palette.text
        } else {
            palette.quiet_text
        };
        let left = rect.left() + 42.0;
        let room = rect.right() - value_width - left;
        let name = elided_among(ui, self.name, self.neighbours, room, BODY_SIZE);
        let mut job = egui::text::LayoutJob::simple_singleline(name, body(), color);
        if !self.kept {
            job.sections[0].format.strikethrough = egui::Stroke::new(1.0, color);
        }
        let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
        ui.painter().galley(
            pos2(left, rect.center().y - 0.5 * galley.size().y),
            galley,
            color,
        );
    }

    /// Draws the name above four aligned rows; the rest is available through
    /// [`QUESTION`](crate::gui::widgets::controls::QUESTION) in the menu.
    fn tooltip_ui(&self, ui: &mut Ui, palette: &Palette) {
        ui.label(RichText::new(&self.model.name).font(medium(BODY_SIZE)));
        Grid::new("model")
            .num_columns(2)
            .spacing([16.0, 2.0])
            .show(ui, |ui| {
                for (name, value) in self.tooltip_rows() {
                    ui.label(palette.dim(name));
                    ui.label(value);
                    ui.end_row();
                }
            });
    }

    fn tooltip_rows(&self) -> Vec<(&'static str, String)> {
        let verdict = if self.is_suspect() {
            ", suggested as an outlier"
        } else {
            ""
        };
        let out = self.set_aside.clone().map(|why| ("set aside", why));
        let rows = [
            self.model
                .perturbation()
                .map(|trim| ("trim", trim_words(trim))),
            method(self.model).map(|method| ("identified by", method.to_owned())),
            self.ratio
                .map(|ratio| ("discontinuity ratio", format!("{ratio:.3}{verdict}"))),
            self.score.map(|score| {
                (
                    "mean distance",
                    format!("{score:.3} to the others that are kept"),
                )
            }),
            out.or(self.reason.clone().map(|reason| ("rejected", reason))),
        ];
        rows.into_iter().flatten().collect()
    }

    fn is_suspect(&self) -> bool {
        self.ratio.is_some_and(|ratio| ratio > SUGGESTION_RATIO)
    }
}

/// "airspeed_kt +5, roll_deg −3".
fn trim_words(trim: &BTreeMap<String, f64>) -> String {
    let offsets = trim.iter().filter(|(_, offset)| **offset != 0.0);
    let offsets: Vec<String> = offsets
        .map(|(name, offset)| format!("{name} {}", signed_compact(*offset)))
        .collect();
    if offsets.is_empty() {
        "that of the condition".to_owned()
    } else {
        offsets.join(", ")
    }
}

/// "+5", "−3".
fn signed_compact(value: f64) -> String {
    format!("{}{}", if value > 0.0 { "+" } else { "" }, compact(value))
}

/// Returns the names without the method that every model of an identified bundle repeats: without
/// "CT-PBSID" if some names contain "CT-PBSID" and the others "CT-PBSID, refined".
fn short_names(models: &[Model]) -> Vec<&str> {
    let repeated = models
        .iter()
        .filter_map(method)
        .min_by_key(|method| method.len())
        .unwrap_or_default();
    let is_repeated = models.iter().all(|model| model.name.starts_with(repeated));
    let names = models.iter().map(|model| {
        let rest = model.name.strip_prefix(repeated).filter(|_| is_repeated);
        let rest = rest
            .map(|rest| rest.trim_start_matches([',', ' ']))
            .filter(|rest| !rest.is_empty());
        rest.unwrap_or(&model.name)
    });
    names.collect()
}

fn method(model: &Model) -> Option<&str> {
    match &model.origin {
        Origin::Identified { method, .. } => method.as_deref(),
        Origin::Nominal { .. } | Origin::Perturbed { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use gdcm_model::dataset::{Dynamics, StateSpace};

    use super::*;

    #[test]
    fn names_are_shown_without_the_method_that_all_of_them_repeat() {
        let gain = || DMatrix::from_element(1, 1, 1.0);
        let model = |name: &str, method: &str| {
            let origin = Origin::Identified {
                method: Some(method.to_owned()),
                order: None,
            };
            Model::new(
                name,
                origin,
                Dynamics::StateSpace(StateSpace::new(gain(), gain(), gain(), gain()).unwrap()),
            )
        };
        let refined = "CT-PBSID, refined";
        let of_refined = [
            model("CT-PBSID, refined, order 16", refined),
            model("CT-PBSID, refined, without LON 1", refined),
        ];
        assert_eq!(short_names(&of_refined), ["order 16", "without LON 1"]);
        let of_both = [
            model("CT-PBSID, refined, order 16", refined),
            model("CT-PBSID, order 16", "CT-PBSID"),
        ];
        assert_eq!(short_names(&of_both), ["refined, order 16", "order 16"]);
        let others = [
            model("CT-PBSID n=12 sweeps A", "CT-PBSID"),
            model("by hand", "CT-PBSID"),
        ];
        assert_eq!(short_names(&others), ["CT-PBSID n=12 sweeps A", "by hand"]);
        assert_eq!(short_names(&[model("CT-PBSID", "CT-PBSID")]), ["CT-PBSID"]);
    }
}
