//! Variants: named sets of decisions, compared with the present decisions.

use egui::{Align, Button, Layout, RichText, Role, Ui};

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::units::signed;
use gdcm_study::decisions::study::Variant;
use gdcm_study::jobs::analysis_jobs::VariantJob;
use gdcm_study::{Analysis, Edit};
use gdcm_words::Table;
use gdcm_words::decisions::decision_differences;

use super::gain_plots::net_gain_pairs;
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::toggle_ui;
use crate::gui::widgets::controls::{is_entered, named, text_field_ui};
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use crate::gui::widgets::tables::{TableLook, table_ui};

/// Draws the variants of the study, their differences from the present decisions, and the effects
/// of these differences.
pub fn compare_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    keep_ui(ui, state, commands);
    if state.study.variants.is_empty() {
        let words = "A variant is a set of decisions under a name. Keep the present ones, go on deciding, and both stand here \
                     side by side, with what differs and what it does to J and to the net gains.";
        ui.label(RichText::new(words).color(palette.dim_text));
        return;
    }
    for variant in state.study.variants.clone() {
        let is_overlaid = state.display.judging.overlaid.as_ref() == Some(&variant.name);
        variant_ui(ui, &variant, is_overlaid, commands);
    }
    ui.add_space(4.0);
    let tables = [difference_table(state), figure_table(state)];
    let half = 0.5 * ui.available_height();
    for (index, table) in tables.iter().enumerate() {
        ui.label(RichText::new(&table.title).size(SMALL_SIZE).strong());
        let room = if index == 0 {
            half
        } else {
            ui.available_height()
        };
        ui.allocate_ui(egui::vec2(ui.available_width(), room), |ui| {
            let mut sorting = state.display.judging.compare_sorting[index];
            table_ui(
                ui,
                table,
                &mut sorting,
                &TableLook::PLAIN,
                palette,
                commands,
            );
            state.display.judging.compare_sorting[index] = sorting;
        });
    }
}

/// Draws the name field and the button that stores the present decisions under that name.
fn keep_ui(ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let name = &mut state.display.judging.variant_name;
        let field = text_field_ui(
            ui,
            "Name of the variant",
            name,
            "name of the variant",
            200.0,
        );
        let entered = is_entered(ui, &field);
        let keep = ui.add_enabled(!name.trim().is_empty(), Button::new("Keep as variant"));
        if keep
            .on_hover_text("Keep the present decisions under this name")
            .clicked()
            || entered
        {
            commands.push(
                Edit::KeepVariant {
                    name: std::mem::take(name),
                }
                .into(),
            );
        }
    });
}

fn variant_ui(ui: &mut Ui, variant: &Variant, is_overlaid: bool, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(&variant.name).strong());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = || variant.name.clone();
            let mut button = |verb: &str, hint: &str, edit: Edit| {
                let button = named(
                    ui.small_button(verb),
                    Role::Button,
                    format!("{verb} variant {}", variant.name),
                );
                if button.on_hover_text(hint).clicked() {
                    commands.push(edit.into());
                }
            };
            let hint = "Forget this variant; undo brings it back";
            button("Remove", hint, Edit::RemoveVariant { name: name() });
            let hint = "Its decisions become the present ones; undo brings those back";
            button("Take", hint, Edit::TakeVariant { name: name() });
            let label = format!("Overlay variant {}", variant.name);
            let hint =
                "Its corrected model in Bode, and its net gains, dotted beside the present ones";
            if toggle_ui(ui, ("Overlay", &label), is_overlaid, hint) {
                commands.push(DisplayCommand::Overlay((!is_overlaid).then(name)).into());
            }
        });
    });
}

/// Returns the analyses needed by the comparison.
pub fn variant_jobs(state: &State) -> Vec<VariantJob> {
    let studies = state
        .study
        .variants
        .iter()
        .filter_map(|variant| state.study.of_variant(&variant.name));
    studies.map(|study| VariantJob { study }).collect()
}

/// Returns the analysis of a variant, if available.
pub fn variant_analysis<'a>(state: &'a State, variant: &Variant) -> Option<&'a Analysis> {
    let job = VariantJob {
        study: state.study.of_variant(&variant.name)?,
    };
    state
        .results
        .variants
        .iter()
        .find(|(known, _)| *known == job)
        .map(|(_, analysis)| analysis.as_ref())
}

/// Returns the overlaid variant and its analysis, if available.
pub fn overlaid_analysis(state: &State) -> Option<(&str, &Analysis)> {
    let variant = state
        .study
        .variant(state.display.judging.overlaid.as_deref()?)?;
    Some((&variant.name, variant_analysis(state, variant)?))
}

/// Returns the job of the overlaid analysis.
pub fn overlay_job(state: &State) -> Option<VariantJob> {
    Some(VariantJob {
        study: state
            .study
            .of_variant(state.display.judging.overlaid.as_deref()?)?,
    })
}

/// Builds the table of the decisions in which a variant differs from the present decisions.
pub fn difference_table(state: &State) -> Table {
    let mut table = Table::new(
        "What differs",
        ["variant", "decision", "in the variant", "now"],
    );
    for variant in &state.study.variants {
        let Some(study) = state.study.of_variant(&variant.name) else {
            continue;
        };
        let differences = decision_differences(&study, &state.study);
        if differences.is_empty() {
            table.row([variant.name.as_str(), "nothing: the same decisions"]);
        }
        for difference in differences {
            table.row([
                variant.name.clone(),
                difference.what,
                difference.before,
                difference.after,
            ]);
        }
    }
    table
}

/// Builds the table of effects, now and in each variant: net gain and J of the responses of the
/// net-gain plots in the displayed condition, and the mean change of J of the scheduled correction
/// over all conditions.
pub fn figure_table(state: &State) -> Table {
    let condition = state.condition().id();
    let title =
        format!("What it does: condition {condition}, and the schedule over all conditions");
    let names = state
        .study
        .variants
        .iter()
        .map(|variant| variant.name.clone());
    let mut table = Table::new(
        title,
        ["value".to_owned(), "now".to_owned()]
            .into_iter()
            .chain(names),
    );
    let analyses: Vec<Option<&Analysis>> = std::iter::once(state.analysis())
        .chain(
            state
                .study
                .variants
                .iter()
                .map(|variant| variant_analysis(state, variant)),
        )
        .collect();
    let mut row = |name: String, figure: &dyn Fn(&Analysis) -> Option<String>| {
        let cell = |analysis: &Option<&Analysis>| match analysis {
            Some(analysis) => figure(analysis).unwrap_or_else(|| "–".to_owned()),
            None => "…".to_owned(),
        };
        table.row(std::iter::once(name).chain(analyses.iter().map(cell)));
    };
    for pair in net_gain_pairs(state) {
        let name = state.dataset().pair_name(pair);
        row(format!("net gain {name}"), &|analysis| {
            Some(format!(
                "{:.4}",
                analysis.condition(condition)?.correction.net_gain(pair)
            ))
        });
        row(format!("J {name}"), &|analysis| {
            cost(analysis, condition, pair)
        });
    }
    row("objective of the gains".to_owned(), &|analysis| {
        analysis
            .condition(condition)
            .map(|result| format!("{:.4}", result.gains.objective))
    });
    row("mean ΔJ on-axis, scheduled".to_owned(), &|analysis| {
        mean_change(state, analysis)
    });
    table
}

fn cost(analysis: &Analysis, condition: ConditionId, pair: Pair) -> Option<String> {
    let cost = analysis.condition(condition)?.cost[pair]?;
    Some(format!(
        "{:.1} → {:.1}",
        cost.uncorrected.total(),
        cost.corrected.total()
    ))
}

/// Returns the mean change of J of the nominal models' on-axis responses under the schedule, over
/// the assessed conditions.
fn mean_change(state: &State, analysis: &Analysis) -> Option<String> {
    let measuring = state.dataset().measuring_pairs();
    let changes: Vec<f64> = analysis
        .assessment
        .values()
        .flatten()
        .flat_map(|changes| {
            measuring
                .marked()
                .filter_map(|pair| Some(changes[pair]?.total()))
        })
        .collect();
    let mean = changes.iter().sum::<f64>() / changes.len() as f64;
    mean.is_finite().then(|| signed(mean, 2))
}
