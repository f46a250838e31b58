//! Benefit of the correction, condition by condition.

use egui::{Align, Layout, Rect, RichText, Sense, Ui, Vec2, vec2};

use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{Condition, ConditionId, Dataset, Pair};
use gdcm_model::number_format::decimals;
use gdcm_plot::figure::assessment::change_table;
use gdcm_plot::figure::axis::Axis;
use gdcm_plot::figure::drawing::{Hue, Stroke};
use gdcm_plot::figure::figure::{Bars, Curve, Note, Place, Plot, Rule, Spans};
use gdcm_plot::figure::{Color, Figure, MarkId, Panel, Range};
use gdcm_study::results::assessment_table::AssessedModel;
use gdcm_study::{AssessedCorrection, AssessmentTable};
use gdcm_words::Table;
use gdcm_words::assessment::{
    held_out_verdict, missing_cost_text, not_assessed_text, summary_text,
};
use gdcm_words::derivation::ExplainTarget;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::questions::NamedFigure;
use crate::gui::plot::{FigureEvent, FigureScene, FigureWords, figure_ui};
use crate::gui::state::assessed_figures::{AssessedFigures, AssessedPairs, CostPart};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};
use crate::gui::widgets::tables::{TableLook, table_ui};

/// Draws the selection of the assessed quantity and of its form, from right to left.
pub fn assessment_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.judging.assessed;
    let mut chosen = shown;
    let forms = [
        (false, "bars", "A bar for each condition"),
        (true, "table", "Responses down, conditions across"),
    ];
    choice_ui(ui, "Form of the assessment", &mut chosen.as_table, &forms);
    if chosen.as_table {
        let parts = [CostPart::Total, CostPart::Magnitude, CostPart::Phase];
        let parts = parts.map(|part| (part, part.symbol(), "Change of J, or of a part"));
        choice_ui(ui, "Part of J", &mut chosen.part, &parts);
    }
    choices_ui(ui, &mut chosen);
    if chosen != shown {
        commands.push(DisplayCommand::Assess(chosen).into());
    }
}

fn choices_ui(ui: &mut Ui, chosen: &mut AssessedFigures) {
    let averages = [
        (None, "as set", "Median or mean as the settings say"),
        (
            Some(CostAverage::Median),
            "median",
            "J of medians over frequency (M4)",
        ),
        (Some(CostAverage::Mean), "mean", "J of means over frequency"),
    ];
    choice_ui(
        ui,
        "Average of the assessment",
        &mut chosen.average,
        &averages,
    );
    let corrections = [
        (
            AssessedCorrection::Scheduled,
            "scheduled",
            "The schedule at the condition's airspeed",
        ),
        (
            AssessedCorrection::ScheduleOfOthers,
            "of the others",
            "The schedule of the other conditions, which has not seen this one",
        ),
        (
            AssessedCorrection::ScheduledWithoutLeads,
            "scheduled, no leads",
            "The schedule with its lead filters left out (M15)",
        ),
        (
            AssessedCorrection::Own,
            "own optimum",
            "The condition's own correction",
        ),
    ];
    choice_ui(
        ui,
        "Correction assessed",
        &mut chosen.correction,
        &corrections,
    );
    let models = [
        (
            AssessedModel::Nominal,
            "nominal",
            "The physics model at the condition's own trim",
        ),
        (
            AssessedModel::Representative,
            "representative",
            "The physics model used as representative",
        ),
    ];
    choice_ui(ui, "Model assessed", &mut chosen.model, &models);
    let pairs = [
        (
            AssessedPairs::OnAxis,
            "on-axis",
            "The on-axis responses of the dataset",
        ),
        (AssessedPairs::OffAxis, "off-axis", "All other responses"),
        (
            AssessedPairs::Focused,
            "in focus",
            "The response chosen in the matrix",
        ),
        (AssessedPairs::All, "all", "Every response"),
    ];
    choice_ui(ui, "Responses assessed", &mut chosen.pairs, &pairs);
}

/// Draws the change of J of the selected responses in every condition (Figures 8 to 19), with a
/// summary in a sentence.
pub fn assessment_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(table) = state.assessment().cloned() else {
        ui.label(RichText::new(state.results.absence()).color(palette.dim_text));
        return;
    };
    let sentences = assessment_sentences(state, &table).join(" · ");
    let text = RichText::new(&sentences)
        .size(SMALL_SIZE)
        .color(palette.text);
    ui.add(egui::Label::new(text).truncate())
        .on_hover_text(&sentences);
    if state.display.judging.assessed.as_table {
        return text_table_ui(ui, state, &table, palette, commands);
    }
    key_ui(ui, palette);
    let mut view = state
        .display
        .figures
        .remove(&View::Assessment)
        .unwrap_or_default();
    let plots = AssessmentPlots {
        state,
        table: &table,
        pairs: assessed_pairs(state),
    };
    let ids: Vec<MarkId> = state
        .dataset()
        .conditions()
        .iter()
        .map(|of| MarkId::Condition(of.id()))
        .collect();
    let figure = plots
        .pairs
        .iter()
        .map(|&pair| Plot::new(state.dataset().pair_name(pair)).panel(plots.panel(pair)));
    let figure = Figure::default().plots(figure);
    let message = "No response of this kind: choose others above";
    let scene = FigureScene {
        selected: Some(MarkId::Condition(state.condition().id())),
        columns: &ids,
        ..FigureScene::new("assessment", &figure, LEAST_PLOT, message, &plots)
    };
    for event in figure_ui(ui, &scene, &mut view, palette) {
        match event {
            FigureEvent::Clicked(plot, MarkId::Condition(condition), _) => {
                commands.push(SelectionCommand::SelectCondition(condition).into());
                commands.extend(
                    plots
                        .pairs
                        .get(plot)
                        .map(|&pair| Command::Selection(SelectionCommand::FocusPair(pair))),
                );
            }
            FigureEvent::Asked(figure) => {
                commands.push(SelectionCommand::Explain(Some(figure)).into())
            }
            FigureEvent::Told(words) => commands.push(SelectionCommand::Tell(words).into()),
            FigureEvent::Clicked(..) | FigureEvent::Pointed(_) => {}
        }
    }
    state.display.figures.insert(View::Assessment, view);
}

/// Least size of a plot \[pt\].
const LEAST_PLOT: Vec2 = vec2(190.0, 150.0);
/// Width of a bar, in units of the distance between conditions.
const BAR: f64 = 0.6;
/// Colour strength of the phase part of a bar, relative to the magnitude part \[%\].
const PHASE_PERCENT: u8 = 45;
/// Space above and below the bars as a share of their height, and distance of a number from its
/// bar.
const MARGINS: [f64; 2] = [0.12, 0.05];

/// Draws the key of the bars, from right to left.
fn key_ui(ui: &mut Ui, palette: &Palette) {
    let faint = palette
        .dim_text
        .gamma_multiply(0.01 * f32::from(PHASE_PERCENT));
    let parts = [
        ("worse", palette.warning, 10.0),
        ("better", palette.good, 10.0),
        ("ΔJ", palette.text, 2.0),
        ("ΔJ phase", faint, 10.0),
        ("ΔJ magnitude", palette.dim_text, 10.0),
    ];
    ui.allocate_ui_with_layout(
        vec2(ui.available_width(), 16.0),
        Layout::right_to_left(Align::Center),
        |ui| {
            for (name, color, height) in parts {
                ui.label(RichText::new(name).size(SMALL_SIZE).color(palette.dim_text));
                let (rect, _) = ui.allocate_exact_size(vec2(12.0, 10.0), Sense::hover());
                ui.painter().rect_filled(
                    Rect::from_center_size(rect.center(), vec2(12.0, height)),
                    1.0,
                    color,
                );
            }
        },
    );
}

/// Change of J of each displayed response, as bars.
struct AssessmentPlots<'a> {
    state: &'a State,
    table: &'a AssessmentTable,
    pairs: Vec<Pair>,
}

impl AssessmentPlots<'_> {
    /// Returns the change in each condition; `None` for excluded conditions.
    fn changes(&self, pair: Pair) -> impl Iterator<Item = (ConditionId, Option<CostChange>)> + '_ {
        self.state
            .dataset()
            .conditions()
            .iter()
            .map(move |of| (of.id(), self.table.change(of.id(), pair)))
    }

    /// Builds the panel of a response. The two parts of a change are stacked if they have the same
    /// sign, otherwise they lie on either side of zero; a line across marks their sum.
    fn panel(&self, pair: Pair) -> Panel {
        let found: Vec<(f64, CostChange)> = self
            .changes(pair)
            .enumerate()
            .filter_map(|(at, (_, change))| Some((at as f64, change?)))
            .collect();
        let foot = |change: &CostChange, is_phase: bool| {
            let is_stacked = is_phase && change.magnitude() * change.phase() > 0.0;
            if is_stacked { change.magnitude() } else { 0.0 }
        };
        let ends =
            |change: &CostChange| [change.magnitude(), foot(change, true) + change.phase(), 0.0];
        let range = Range::of(found.iter().flat_map(|(_, change)| ends(change)));
        let range = range
            .unwrap_or(Range::new(-1.0, 1.0))
            .with_margin(MARGINS[0], 1.0);
        let parts = [
            (false, Hue::Good),
            (false, Hue::Warning),
            (true, Hue::Good),
            (true, Hue::Warning),
        ];
        let bars = parts.map(|(is_phase, hue)| {
            let value = |change: &CostChange| {
                if is_phase {
                    change.phase()
                } else {
                    change.magnitude()
                }
            };
            let of_hue = found
                .iter()
                .filter(|(_, change)| (value(change) > 0.0) == (hue == Hue::Warning));
            let (bars, feet) = of_hue
                .map(|(at, change)| ([*at, value(change)], foot(change, is_phase)))
                .unzip();
            let color = Color::of(hue).tint(if is_phase { PHASE_PERCENT } else { 100 });
            Bars {
                name: String::new(),
                color,
                width: BAR,
                bars,
                feet,
                beside: 0.0,
            }
        });
        let total = |(at, change): &(f64, CostChange)| {
            [
                [at - 0.38, change.total()],
                [at + 0.38, change.total()],
                [f64::NAN, f64::NAN],
            ]
        };
        let totals = Curve::through(
            "ΔJ",
            Stroke::solid(Color::INK, 1.1),
            found.iter().flat_map(total),
        );
        let number = |(at, change): &(f64, CostChange)| {
            let total = change.total();
            let by = MARGINS[1] * range.width();
            let end = ends(change)
                .into_iter()
                .fold(0.0, if total > 0.0 { f64::max } else { f64::min });
            let at = Place::Value {
                x: *at,
                y: end + by.copysign(total),
                upright: false,
            };
            Note {
                at,
                text: decimals(total, usize::from(total.abs() < 9.95)),
            }
        };
        let is_left_out =
            |(_, (_, change)): &(usize, (ConditionId, Option<CostChange>))| change.is_none();
        let left_out: Vec<f64> = self
            .changes(pair)
            .enumerate()
            .filter(is_left_out)
            .map(|(at, _)| at as f64)
            .collect();
        let ground = Spans {
            name: String::new(),
            color: Color::of(Hue::Rejected).tint(13),
            width: 0.7,
            spans: left_out
                .iter()
                .map(|at| [*at, range.min, range.max])
                .collect(),
        };
        let words = |x: f64| {
            let at = Place::Value {
                x,
                y: range.middle(),
                upright: true,
            };
            Note {
                at,
                text: "left out".to_owned(),
            }
        };
        let names = Axis::named(
            "Condition",
            self.changes(pair).map(|(id, _)| id.to_string()),
        );
        let panel = Panel::new(names, Axis::linear("").showing(Some(range)))
            .with(ground)
            .with_all(bars);
        let panel = panel.with(Rule::horizontal(0.0, Stroke::solid(Color::DIM, 0.6)));
        let panel = panel.with(totals);
        // Numbers on every bar would overlap; the status line shows the others.
        let most = found
            .iter()
            .max_by(|a, b| a.1.total().abs().total_cmp(&b.1.total().abs()))
            .map(|(at, _)| *at);
        let id = self.state.condition().id();
        let shown = self
            .state
            .dataset()
            .conditions()
            .iter()
            .position(|of| of.id() == id)
            .unwrap_or(0) as f64;
        let is_told = |(at, _): &&(f64, CostChange)| {
            *at == shown || (Some(*at) == most && (at - shown).abs() > 1.0)
        };
        panel
            .with_all(found.iter().filter(is_told).map(number))
            .with_all(left_out.into_iter().map(words))
    }
}

impl FigureWords for AssessmentPlots<'_> {
    fn plot(&self, plot: usize) -> String {
        let pair = self.pairs[plot];
        let text = |(id, change): (ConditionId, Option<CostChange>)| match change {
            Some(change) => format!("{id} {}", decimals(change.total(), 1)),
            None => format!("{id} left out"),
        };
        let words: Vec<String> = self.changes(pair).map(text).collect();
        format!(
            "Change of J, {}: {}",
            self.state.dataset().pair_name(pair),
            words.join(", ")
        )
    }

    fn pointed(&self, plot: usize, id: &MarkId, _: [f64; 2]) -> Option<String> {
        let (MarkId::Condition(id), pair) = (id, self.pairs[plot]) else {
            return None;
        };
        let of = format!("{}, condition {id}", self.state.dataset().pair_name(pair));
        let Some(change) = self.table.change(*id, pair) else {
            return Some(format!(
                "{of} · left out: {}",
                why_not(self.state.dataset(), self.table, *id, pair)
            ));
        };
        let [total, magnitude, phase] =
            [change.total(), change.magnitude(), change.phase()].map(|part| decimals(part, 1));
        let [before, after] =
            [change.uncorrected, change.corrected].map(|cost| decimals(cost.total(), 1));
        Some(format!(
            "{of} · ΔJ {total}: magnitude {magnitude}, phase {phase} · J {before} → {after}"
        ))
    }

    fn questions(&self, plot: usize, id: &MarkId) -> Vec<NamedFigure> {
        let (&MarkId::Condition(id), pair) = (id, self.pairs[plot]) else {
            return Vec::new();
        };
        let asked = ExplainTarget::CostChange(id, pair, self.table.choice);
        self.table
            .change(id, pair)
            .map(|_| ("Change of J".to_owned(), asked))
            .into_iter()
            .collect()
    }
}

/// Draws the table, with a warning if J rises. A click selects the response and the condition.
fn text_table_ui(
    ui: &mut Ui,
    state: &mut State,
    table: &AssessmentTable,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let text = assessment_text_table(state, table);
    let pairs: Vec<Pair> = assessed_pairs(state);
    let color = |row: usize, column: usize| match text.rows[row][column].chars().next() {
        Some('+') if column > 0 => Some(palette.warning),
        _ => None,
    };
    let look = TableLook {
        color: &color,
        selected: &|row| pairs.get(row) == Some(&state.display.selection.pair),
    };
    let mut sorting = state.display.judging.assessment_sorting;
    let clicked = table_ui(ui, &text, &mut sorting, &look, palette, commands);
    if let Some(click) = clicked {
        commands.extend(
            pairs
                .get(click.row)
                .map(|&pair| Command::Selection(SelectionCommand::FocusPair(pair))),
        );
        let condition = click
            .column
            .checked_sub(1)
            .and_then(|column| state.dataset().conditions().get(column));
        commands.extend(condition.map(|condition| {
            Command::Selection(SelectionCommand::SelectCondition(condition.id()))
        }));
    }
    state.display.judging.assessment_sorting = sorting;
}

/// Returns the assessed responses, in the order of the matrix.
pub fn assessed_pairs(state: &State) -> Vec<Pair> {
    let measuring = state.dataset().measuring_pairs();
    let is_in = |pair: &Pair| match state.display.judging.assessed.pairs {
        AssessedPairs::OnAxis => measuring[*pair],
        AssessedPairs::OffAxis => !measuring[*pair],
        AssessedPairs::Focused => *pair == state.display.selection.pair,
        AssessedPairs::All => true,
    };
    measuring.pairs().filter(is_in).collect()
}

/// Returns the reason why a response of a condition has no change of J.
fn why_not(
    dataset: &Dataset,
    table: &AssessmentTable,
    condition: ConditionId,
    pair: Pair,
) -> String {
    let left_out = table
        .left_out
        .iter()
        .find(|left_out| left_out.condition == condition);
    let assessed = table
        .conditions
        .iter()
        .find(|assessed| assessed.condition == condition);
    let missing = assessed.and_then(|assessed| {
        assessed
            .missing
            .iter()
            .find(|(missing, _)| *missing == pair)
    });
    match (left_out, missing) {
        (Some(left_out), _) => not_assessed_text(&left_out.why, dataset),
        (None, Some((_, why))) => missing_cost_text(*why),
        (None, None) => "not computed".to_owned(),
    }
}

/// Builds the table with the responses in rows, the conditions in columns, and the signed change of
/// J in each cell.
pub fn assessment_text_table(state: &State, table: &AssessmentTable) -> Table {
    let part = state.display.judging.assessed.part;
    let condition = |of: &std::sync::Arc<Condition>| (of.id(), of.id().to_string());
    let conditions: Vec<(ConditionId, String)> =
        state.dataset().conditions().iter().map(condition).collect();
    let title = format!("{} of each response in each condition", part.symbol());
    change_table(
        title,
        (state.dataset(), table),
        &assessed_pairs(state),
        &conditions,
        part.of(),
    )
}

/// Summarises the assessment in sentences: number of improved responses, and omissions.
pub fn assessment_sentences(state: &State, table: &AssessmentTable) -> Vec<String> {
    let pairs = assessed_pairs(state);
    let marked = state
        .dataset()
        .on_axis()
        .map(|pair, _| pairs.contains(&pair));
    let mut sentences = vec![summary_text(&table.summary(&marked), state.dataset())];
    let verdict = state
        .analysis()
        .and_then(|analysis| held_out_verdict(analysis, table.choice));
    sentences.extend(verdict);
    for left_out in &table.left_out {
        sentences.push(format!(
            "condition {} is left out: {}",
            left_out.condition,
            not_assessed_text(&left_out.why, state.dataset())
        ));
    }
    sentences
}
