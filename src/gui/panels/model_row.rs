//! Row in a bundle's list: box, star, trim or name, discontinuity ratio or order.
//!
//! A bundle is all physics models, or all identified models, in a condition. The star marks its
//! representative, which stands for it in comparisons: the medoid, the model with the lowest mean
//! distance to the others, or the model that the engineer has chosen. A physics model whose
//! discontinuity ratio is high is suggested as an outlier (M5: docs/method.md).

use egui::{Checkbox, Grid, Rect, RichText, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{BundleKind, Model, ModelId};
use gdcm_study::{ConditionAnalysis, Edit};
use gdcm_words::caution::caution_text;
use gdcm_words::derivation::ExplainTarget;

use super::derivation_sheet::question_menu_ui;
use super::trim_columns::{TRIM_ENDS, TrimColumns, trim_words};
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, entries_ui, named, named_switch, tooltip_right_of};
use crate::gui::widgets::elision::elided_among;
use crate::gui::widgets::list_row::ROW_HEIGHT;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, painted_text, row_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, body, medium};

/// Discontinuity ratio at which the bar has its full length.
const FULL_RATIO: f64 = 4.0;
/// Full bar length \[pt\].
const FULL_BAR: f32 = 38.0;

/// Returns the bar length for a discontinuity ratio \[pt\].
fn bar_length(ratio: f64) -> f32 {
    FULL_BAR * (ratio / FULL_RATIO).clamp(0.0, 1.0) as f32
}

/// Displayed name, and the names above and below it in the list.
pub(super) struct Neighbours<'a> {
    name: &'a str,
    beside: [Option<&'a str>; 2],
}

impl<'a> Neighbours<'a> {
    /// Returns the name at a position in the list, and its neighbours.
    pub(super) fn new(names: &[&'a str], place: usize) -> Self {
        let above = place.checked_sub(1).map(|above| names[above]);
        let below = names.get(place + 1).copied();
        Self {
            name: names[place],
            beside: [above, below],
        }
    }
}

/// Model in the displayed condition, as its row shows it.
pub(super) struct ModelRow<'a> {
    id: ModelId,
    model: &'a Model,
    shown: Neighbours<'a>,
    /// Whether the model is not rejected.
    kept: bool,
    /// Whether the engineer chose the model as representative.
    pinned: bool,
    /// Whether the model is the representative: the chosen model, or else the medoid.
    represents: bool,
    /// Whether the pointer is over the model, here or in a plot.
    pointed: bool,
    /// Mean distance to the other kept models.
    score: Option<f64>,
    /// Discontinuity ratio, for physics models only: the distance from the other models, relative
    /// to the distance that the perturbation of the trim explains.
    ratio: Option<f64>,
    /// Reason why the model is excluded from the comparison.
    set_aside: Option<String>,
    /// Reason for the rejection, in the engineer's words.
    reason: Option<String>,
}

impl<'a> ModelRow<'a> {
    pub(super) fn new(
        state: &State,
        kind: BundleKind,
        model: &'a Model,
        shown: Neighbours<'a>,
    ) -> Self {
        let id = state.model_id(kind, &model.name);
        let choice = state.study.choice(id.condition);
        let mut row = Self {
            model,
            shown,
            kept: !state.study.is_rejected(&id),
            reason: state.study.reason(&id).map(str::to_owned),
            pinned: choice.bundle(kind).pinned.as_ref() == Some(&id.name),
            represents: false,
            pointed: state.display.selection.hovered.as_ref() == Some(&id),
            score: None,
            ratio: None,
            set_aside: None,
            id,
        };
        if let Some(result) = state.shown() {
            row.add_result(state, result);
        }
        row
    }

    fn add_result(&mut self, state: &State, result: &ConditionAnalysis) {
        let kind = self.id.bundle;
        let name = &self.id.name;
        self.represents = result.representative_name(kind) == name;
        self.score = result.score(kind, name);
        if kind == BundleKind::Physics {
            self.ratio = result.discontinuity_ratio(name);
        }
        let caution = result
            .cautions
            .iter()
            .find(|caution| caution.is_set_aside(kind, name));
        if let Some(caution) = caution {
            self.set_aside = Some(caution_text(caution, |pair| {
                state.dataset().pair_name(pair)
            }));
        }
    }

    pub(super) fn ui(
        &self,
        ui: &mut Ui,
        trims: Option<&TrimColumns>,
        palette: &Palette,
        commands: &mut Vec<Command>,
    ) {
        let width = ui.available_width();
        // `Sense::CLICK` is not reachable by Tab: the actions are on the box, on the star, and in
        // the command palette.
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
        // A bundle may contain a thousand models, so rows out of view are not painted.
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
        tooltip_right_of(&response, rect, |ui| self.tooltip_ui(ui, palette));
    }

    fn menu_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let id = &self.id;
        let (decide, edit, ask) = if self.kept {
            ("Reject", Edit::Reject(id.clone()), "Reject with a reason…")
        } else {
            (
                "Restore",
                Edit::Restore(id.clone()),
                "Give the reason for the rejection…",
            )
        };
        let entries = [
            (decide, edit.into()),
            (ask, Command::Form(FormCommand::AskReason(id.clone()))),
            (
                "Copy the name",
                Command::Output(OutputCommand::CopyText(self.model.name.clone())),
            ),
        ];
        entries_ui(ui, entries, commands);
        let mut values = Vec::new();
        if self.ratio.is_some() {
            values.push((
                "Discontinuity ratio".to_owned(),
                ExplainTarget::DiscontinuityRatio(id.clone()),
            ));
        }
        if self.score.is_some() {
            values.push(("Mean distance".to_owned(), ExplainTarget::Score(id.clone())));
        }
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
            let edit = if kept {
                Edit::Restore(self.id.clone())
            } else {
                Edit::Reject(self.id.clone())
            };
            commands.push(edit.into());
        }
        checkbox.on_hover_text(if self.kept {
            "Reject this model"
        } else {
            "Restore this model"
        });
    }

    /// Draws the star, visible at the representative, and while it has the pointer or the focus: a
    /// click makes the model the representative, or returns to the medoid. A dot marks a
    /// representative chosen by the engineer.
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
        response.on_hover_text(self.star_hint(can_represent));
    }

    fn star_hint(&self, can_represent: bool) -> &'static str {
        if !can_represent && self.set_aside.is_some() {
            "Cannot be the representative, because the model is set aside"
        } else if !can_represent {
            "Cannot be the representative, because the model is rejected; restore the model first"
        } else if self.pinned && self.set_aside.is_some() {
            "Chosen as representative, but set aside; click to use the medoid"
        } else if self.pinned {
            "Representative, chosen by hand; click to use the medoid again"
        } else if self.represents {
            "Representative (medoid); click to keep it as representative"
        } else {
            "Click to use as representative"
        }
    }

    /// Paints "set aside"; else, for a physics model, the discontinuity ratio with its bar, if it
    /// is computed; else, for an identified model, the order ("measured" without an order). Returns
    /// the occupied width on the right \[pt\].
    fn paint_value(&self, ui: &Ui, rect: Rect, palette: &Palette) -> f32 {
        if self.set_aside.is_some() {
            row_text(ui, rect, -5.0, "set aside", SMALL_SIZE, palette.warning);
            return 60.0;
        }
        if let Some(ratio) = self.ratio {
            self.paint_ratio(ui, rect, ratio, palette);
            return 80.0;
        }
        if self.id.bundle == BundleKind::Identified {
            let words = match self.model.order() {
                Some(order) => format!("order {order}"),
                None => "measured".to_owned(),
            };
            row_text(ui, rect, -5.0, &words, SMALL_SIZE, palette.dim_text);
            return 60.0;
        }
        5.0
    }

    /// Paints the discontinuity ratio and its bar, with a tick at the threshold for suggested
    /// outliers.
    fn paint_ratio(&self, ui: &Ui, rect: Rect, ratio: f64, palette: &Palette) {
        let text_color = if self.kept {
            palette.text
        } else {
            palette.quiet_text
        };
        row_text(
            ui,
            rect,
            -1.0,
            &format!("{ratio:.2}"),
            BODY_SIZE,
            text_color,
        );
        let bar = Rect::from_min_size(
            pos2(rect.right() - 74.0, rect.center().y - 2.0),
            vec2(FULL_BAR, 4.0),
        );
        ui.painter().rect_filled(bar, 2.0, palette.line);
        let color = if self.is_suspect() && self.kept {
            palette.warning
        } else {
            palette.quiet_mark
        };
        let filled = Rect::from_min_size(bar.min, vec2(bar_length(ratio), 4.0));
        ui.painter().rect_filled(filled, 2.0, color);
        let tick = bar.left() + bar_length(SUGGESTION_RATIO);
        ui.painter().vline(
            tick,
            bar.expand(2.0).y_range(),
            Stroke::new(1.0, palette.dim_text),
        );
    }

    /// Paints the trim offsets, struck out if the model is rejected.
    fn paint_offsets(&self, ui: &Ui, rect: Rect, offsets: &[String], palette: &Palette) {
        for (offset, end) in offsets.iter().zip(TRIM_ENDS) {
            let color = if !self.kept || offset == "·" {
                palette.quiet_text
            } else {
                palette.text
            };
            let upto = rect.with_max_x(rect.left() + end);
            let place = painted_text(ui, upto, AT_RIGHT_END, offset, body(), color);
            if !self.kept && offset != "·" {
                ui.painter()
                    .hline(place.x_range(), place.center().y, Stroke::new(1.0, color));
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
        let name = elided_among(ui, self.shown.name, self.shown.beside, room, BODY_SIZE);
        let mut job = egui::text::LayoutJob::simple_singleline(name, body(), color);
        if !self.kept {
            job.sections[0].format.strikethrough = Stroke::new(1.0, color);
        }
        let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
        ui.painter().galley(
            pos2(left, rect.center().y - 0.5 * galley.size().y),
            galley,
            color,
        );
    }

    /// Draws the name above at most five aligned rows. The submenu
    /// [`QUESTION`](crate::gui::plot::derivation_menu::QUESTION) in the row's menu leads to the
    /// derivations of the discontinuity ratio and the mean distance.
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
        let mut rows = Vec::new();
        if let Some(trim) = self.model.perturbation() {
            rows.push(("trim", trim_words(trim)));
        }
        if let Some(method) = method(self.model) {
            rows.push(("identified by", method.to_owned()));
        }
        if let Some(ratio) = self.ratio {
            let verdict = if self.is_suspect() {
                ", suggested as an outlier"
            } else {
                ""
            };
            rows.push(("discontinuity ratio", format!("{ratio:.3}{verdict}")));
        }
        if let Some(score) = self.score {
            let words = format!("{score:.3} to the other kept models");
            rows.push(("mean distance", words));
        }
        if let Some(why) = &self.set_aside {
            rows.push(("set aside", why.clone()));
        } else if let Some(reason) = &self.reason {
            rows.push(("rejected", reason.clone()));
        }
        rows
    }

    fn is_suspect(&self) -> bool {
        self.ratio.is_some_and(|ratio| ratio > SUGGESTION_RATIO)
    }
}

/// Returns the identification method; `None` if it is not stated, and for physics models.
pub(super) fn method(model: &Model) -> Option<&str> {
    match &model.origin {
        Origin::Identified { method, .. } => method.as_deref(),
        Origin::Nominal { .. } | Origin::Perturbed { .. } => None,
    }
}
