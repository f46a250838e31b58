//! Bundles in the displayed condition: kept models, representatives, suspected outliers.
//!
//! A bundle is all physics models, or all identified models, in a condition; its representative
//! stands for it in comparisons. Outliers are suggested by their discontinuity ratio (M5:
//! docs/method.md), and only the engineer rejects models.

use egui::{Align, Label, Layout, Role, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2};

use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_model::dataset::{BundleKind, Model};
use gdcm_model::number_format::counted;
use gdcm_study::Edit;

use super::model_row::{ModelRow, Neighbours, method};
use super::table_menu::{TableHeading, table_menu_ui};
use super::trim_columns::{TRIM_ENDS, TrimColumns};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::panel_tables::TableKind;
use crate::gui::state::window_state::State;
use crate::gui::widgets::controls::{Asks, named, named_switch};
use crate::gui::widgets::list_row::ROW_HEIGHT;
use crate::gui::widgets::painted_text::{AT_RIGHT_END, chevron, painted_text};
use crate::gui::widgets::palette::{BODY_SIZE, Palette, medium, small};
use crate::gui::widgets::window_regions::{Region, region_ui};

/// Draws the displayed condition's bundles in the left panel: the physics models above, the
/// identified models in a foldable part below.
pub fn models_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    region_ui(ui, Region::Models, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let is_open = state.display.layout.identified_open;
        let room = ui.available_height();
        let models = state.condition().bundle(BundleKind::Identified).len();
        // A bundle without models takes one row, with a message.
        let rows = models.max(1) as f32;
        let height = if is_open {
            (FOLD + ROW_HEIGHT * rows + 8.0).min(0.5 * room)
        } else {
            FOLD
        };
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
    // No heading is drawn here: the sheet has its own.
    region_ui(ui, Region::Models, |ui| {
        if kind == BundleKind::Physics {
            all_models_ui(ui, state, palette, commands);
        }
        rows_ui(ui, state, palette, kind, commands);
    });
}

/// Height of the line that folds the identified models \[pt\].
const FOLD: f32 = 36.0;

fn physics_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let kind = BundleKind::Physics;
    let title = format!("Physics models, condition {}", state.condition().id());
    let heading = TableHeading {
        title: &title,
        value: &state.kept_words(kind),
        kind: TableKind::of_bundle(kind),
    };
    heading.ui(ui, palette, commands);
    all_models_ui(ui, state, palette, commands);
    rows_ui(ui, state, palette, kind, commands);
}

/// Draws the counts of suggested and rejected physics models, and the actions on all at once, above
/// the list so that they do not scroll: *Restore all*, if a model in either bundle is rejected, and
/// *Reject* for suggested outliers, if the verdict recommends to reverse a doubtful sign first.
fn all_models_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let condition = state.condition().id();
    let choice = state.study.choice(condition);
    let open = match state.shown() {
        Some(shown) => state.open_suggestions(shown),
        None => Vec::new(),
    };
    let has_doubtful_sign = match state.shown() {
        Some(shown) => shown
            .doubts
            .iter()
            .any(|doubt| doubt.channel_to_reverse().is_some()),
        None => false,
    };
    let size = vec2(ui.available_width(), 28.0);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        let rejected = choice.physics.rejected.len();
        let words = match (open.len(), rejected) {
            (0, 0) if state.shown().is_none() => "no result, so no outliers suggested".to_owned(),
            (0, 0) => "no outliers suggested".to_owned(),
            (0, rejected) => format!("{rejected} rejected"),
            (open, 0) => format!("{} suggested", counted(open, "outlier")),
            (open, rejected) => format!("{open} suggested, {rejected} rejected"),
        };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if rejected > 0 || !choice.identified.rejected.is_empty() {
                ui.button("Restore all")
                    .on_hover_text("Physics and identified models of this condition")
                    .asks(Edit::RestoreAll { condition }, commands);
            }
            // The verdict has this button, unless a doubtful sign comes first.
            if !open.is_empty() && has_doubtful_sign {
                let hint = format!("Discontinuity ratio above {SUGGESTION_RATIO} (Ctrl+R)");
                named(ui.button("Reject"), Role::Button, "Reject suggested models")
                    .on_hover_text(hint)
                    .asks(Edit::reject_physics(condition, &open), commands);
            }
            // The text takes the width that the buttons leave.
            let text = if open.is_empty() {
                palette.small(&words)
            } else {
                palette.small_warning(&words)
            };
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(text).truncate());
            });
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
    let mut words = if state.condition().bundle(BundleKind::Identified).is_empty() {
        "none yet".to_owned()
    } else {
        state.kept_words(BundleKind::Identified)
    };
    let order = representative_order(state);
    if let Some(order) = order {
        words = format!("order {order} · {words}");
    }
    let place = painted_text(ui, row, AT_RIGHT_END, &words, small(), palette.dim_text);
    if order.is_some() {
        let star = row.with_max_x(place.left() - 3.0);
        painted_text(ui, star, AT_RIGHT_END, "★", small(), palette.identified);
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

/// Returns the identified representative's order; `None` without a result, or for a measured
/// response.
fn representative_order(state: &State) -> Option<usize> {
    let name = state.shown()?.representative_name(BundleKind::Identified);
    let models = state.condition().bundle(BundleKind::Identified);
    models.iter().find(|model| model.name == name)?.order()
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
        let words = match kind {
            BundleKind::Physics => "No physics models in this condition",
            BundleKind::Identified => "No identified models yet; identify them from flight records",
        };
        ui.add(Label::new(palette.small(words)).wrap());
        return;
    }
    let mut trims = None;
    if kind == BundleKind::Physics {
        trims = TrimColumns::new(models);
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
                let neighbours = Neighbours::new(&names, place);
                let row = ModelRow::new(state, kind, model, neighbours);
                row.ui(ui, trims.as_ref(), palette, commands);
            }
        });
}

fn heads_ui(ui: &mut Ui, trims: Option<&TrimColumns>, palette: &Palette) {
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    if let Some(trims) = trims {
        for (head, end) in trims.heads.iter().zip(TRIM_ENDS) {
            let upto = row.with_max_x(row.left() + end);
            painted_text(ui, upto, AT_RIGHT_END, head, small(), palette.dim_text);
        }
    }
    painted_text(ui, row, -1.0, "discontinuity", small(), palette.dim_text);
}

/// Removes the shortest method name from the names if all of them begin with it: "CT-PBSID" and
/// "CT-PBSID, refined" become "CT-PBSID" and "refined".
fn short_names(models: &[Model]) -> Vec<&str> {
    let repeated = models
        .iter()
        .filter_map(method)
        .min_by_key(|method| method.len())
        .unwrap_or_default();
    let mut names = Vec::new();
    for model in models {
        let Some(rest) = model.name.strip_prefix(repeated) else {
            return models.iter().map(|model| model.name.as_str()).collect();
        };
        let rest = rest.trim_start_matches([',', ' ']);
        names.push(if rest.is_empty() { &model.name } else { rest });
    }
    names
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use gdcm_model::dataset::model::Origin;
    use gdcm_model::dataset::{Dynamics, StateSpace};

    use super::*;

    /// Returns a first-order model with every matrix equal to 1.
    fn model(name: &str, method: &str) -> Model {
        let origin = Origin::Identified {
            method: Some(method.to_owned()),
            order: None,
        };
        let ones = DMatrix::from_element(1, 1, 1.0);
        let dynamics = StateSpace::new(ones.clone(), ones.clone(), ones.clone(), ones).unwrap();
        Model::new(name, origin, Dynamics::StateSpace(dynamics))
    }

    #[test]
    fn names_are_shown_without_the_method_that_all_of_them_repeat() {
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
