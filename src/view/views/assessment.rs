//! What the correction is worth, condition by condition.

use egui::{RichText, Ui};
use gdcm_core::dataset::{Condition, ConditionId, Pair};
use gdcm_core::fidelity::CostAverage;
use gdcm_core::schedule::CostChange;
use gdcm_core::study::{
    AssessedCorrection, AssessedModel, AssessmentChoice, AssessmentTable, ExplainTarget, Table, held_out_verdict,
};
use gdcm_core::units::signed;

use crate::view::command::Command;
use crate::view::palette::{Palette, SMALL_SIZE};
use crate::view::plot::{AssessmentBar, AssessmentEvent, AssessmentPanel, AssessmentScene, BarValue, assessment_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;
use crate::view::table_view::{TableLook, table_ui};

/// What is assessed, and how it is shown. Laid out from right to left.
pub fn assessment_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.assessed;
    let mut chosen = shown;
    choice_ui(
        ui,
        "Form of the assessment",
        &mut chosen.as_table,
        &[(false, "bars", "A bar for each condition"), (true, "table", "Responses down, conditions across")],
    );
    if chosen.as_table {
        let parts = [CostPart::Total, CostPart::Magnitude, CostPart::Phase];
        choice_ui(
            ui,
            "Part of J",
            &mut chosen.part,
            &parts.map(|part| (part, part.symbol(), "Change of J, or of a part")),
        );
    }
    choices_ui(ui, &mut chosen);
    if chosen != shown {
        commands.push(Command::Assess(chosen));
    }
}

fn choices_ui(ui: &mut Ui, chosen: &mut AssessedFigures) {
    let averages = [
        (None, "as set", "Median or mean as the settings say"),
        (Some(CostAverage::Median), "median", "J of medians over frequency (M4)"),
        (Some(CostAverage::Mean), "mean", "J of means over frequency"),
    ];
    choice_ui(ui, "Average of the assessment", &mut chosen.average, &averages);
    let corrections = [
        (AssessedCorrection::Scheduled, "scheduled", "The schedule at the condition's airspeed"),
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
        (AssessedCorrection::Own, "own optimum", "The condition's own correction"),
    ];
    choice_ui(ui, "Correction assessed", &mut chosen.correction, &corrections);
    let models = [
        (AssessedModel::Nominal, "nominal", "The physics model at the condition's own trim"),
        (AssessedModel::Representative, "representative", "The physics model that represents its bundle"),
    ];
    choice_ui(ui, "Model assessed", &mut chosen.model, &models);
    let pairs = [
        (AssessedPairs::OnAxis, "on-axis", "The on-axis responses of the dataset"),
        (AssessedPairs::OffAxis, "off-axis", "All other responses"),
        (AssessedPairs::Focused, "in focus", "The response chosen in the matrix"),
        (AssessedPairs::All, "all", "Every response"),
    ];
    choice_ui(ui, "Responses assessed", &mut chosen.pairs, &pairs);
}

/// The change of J of the responses chosen in every condition (Figures 8 to 19), summed up in a sentence.
pub fn assessment_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let Some(table) = state.assessment().cloned() else {
        let scene = AssessmentScene { panels: &[], message: Some(state.results.absence()) };
        assessment_ui(ui, &scene, &mut state.display.assessment, palette);
        return;
    };
    let sentences = assessment_sentences(state, &table).join(" · ");
    let text = RichText::new(&sentences).size(SMALL_SIZE).color(palette.text);
    ui.add(egui::Label::new(text).truncate()).on_hover_text(&sentences);
    if state.display.assessed.as_table {
        return text_table_ui(ui, state, &table, palette, commands);
    }
    let (pairs, panels) = assessment_panels(state, &table);
    let scene = AssessmentScene { panels: &panels, message: Some("No response of this kind: choose others above") };
    let events = assessment_ui(ui, &scene, &mut state.display.assessment, palette);
    for event in events {
        match event {
            AssessmentEvent::BarClicked { panel, condition } => {
                commands.push(Command::SelectCondition(condition));
                commands.extend(pairs.get(panel).map(|&pair| Command::FocusPair(pair)));
            }
            AssessmentEvent::Asked(figure) => commands.push(Command::Explain(Some(figure))),
        }
    }
}

/// The table: green where J falls, amber where it rises. A click shows its response and its condition.
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
        Some('\u{2212}') => Some(palette.good),
        _ => None,
    };
    let look = TableLook { color: &color, selected: &|row| pairs.get(row) == Some(&state.display.pair) };
    let mut sorting = state.display.assessment_sorting;
    let clicked = table_ui(ui, &text, &mut sorting, &look, palette, commands);
    if let Some(click) = clicked {
        commands.extend(pairs.get(click.row).map(|&pair| Command::FocusPair(pair)));
        let condition = click.column.checked_sub(1).and_then(|column| state.dataset().conditions().get(column));
        commands.extend(condition.map(|condition| Command::SelectCondition(condition.id())));
    }
    state.display.assessment_sorting = sorting;
}

/// Which responses an assessment shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AssessedPairs {
    /// The on-axis responses (Figures 8 to 12).
    #[default]
    OnAxis,
    /// All others (Figures 13 to 19).
    OffAxis,
    /// The response in focus.
    Focused,
    /// Every response.
    All,
}

/// Which part of J the table of an assessment shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CostPart {
    /// `Delta J`.
    #[default]
    Total,
    /// `Delta J_mag`.
    Magnitude,
    /// `Delta J_phase`.
    Phase,
}

impl CostPart {
    /// Its symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Total => "ΔJ",
            Self::Magnitude => "ΔJ mag",
            Self::Phase => "ΔJ phase",
        }
    }

    fn of(self, change: CostChange) -> f64 {
        match self {
            Self::Total => change.total(),
            Self::Magnitude => change.magnitude(),
            Self::Phase => change.phase(),
        }
    }
}

/// What the assessment shows, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AssessedFigures {
    /// Which physics model.
    pub model: AssessedModel,
    /// Under which correction.
    pub correction: AssessedCorrection,
    /// How squared errors are averaged; as the settings say where it is none.
    pub average: Option<CostAverage>,
    /// Which responses.
    pub pairs: AssessedPairs,
    /// Whether it is a table in place of bars.
    pub as_table: bool,
    /// Which part of J the table shows.
    pub part: CostPart,
}

/// What is to be assessed, and how.
pub fn assessment_choice(state: &State) -> AssessmentChoice {
    let AssessedFigures { model, correction, average, .. } = state.display.assessed;
    AssessmentChoice { model, correction, average: average.unwrap_or(state.study.settings.cost_average) }
}

/// The responses that the assessment shows, in the order of the matrix.
pub fn assessed_pairs(state: &State) -> Vec<Pair> {
    let measuring = state.dataset().measuring_pairs();
    let is_in = |pair: &Pair| match state.display.assessed.pairs {
        AssessedPairs::OnAxis => measuring[*pair],
        AssessedPairs::OffAxis => !measuring[*pair],
        AssessedPairs::Focused => *pair == state.display.pair,
        AssessedPairs::All => true,
    };
    measuring.pairs().filter(is_in).collect()
}

/// One panel for each response shown: the change of J in each condition.
pub fn assessment_panels(state: &State, table: &AssessmentTable) -> (Vec<Pair>, Vec<AssessmentPanel>) {
    let pairs = assessed_pairs(state);
    let panel = |&pair: &Pair| AssessmentPanel {
        title: state.dataset().pair_name(pair),
        axis_label: "Condition".to_owned(),
        bars: state.dataset().conditions().iter().map(|condition| bar(state, table, pair, condition)).collect(),
    };
    let panels = pairs.iter().map(panel).collect();
    (pairs, panels)
}

fn bar(state: &State, table: &AssessmentTable, pair: Pair, condition: &Condition) -> AssessmentBar {
    let id = condition.id();
    let (value, detail) = match (table.change(id, pair), why_not(table, id, pair)) {
        (Some(change), _) => (
            BarValue::Change { magnitude: change.magnitude(), phase: change.phase() },
            format!("J {:.1} → {:.1}", change.uncorrected.total(), change.corrected.total()),
        ),
        (None, why) => (BarValue::LeftOut { why }, String::new()),
    };
    let asked = ("Change of J".to_owned(), ExplainTarget::CostChange(id, pair, assessment_choice(state)));
    let figures = match value {
        BarValue::Change { .. } => vec![asked],
        BarValue::LeftOut { .. } => Vec::new(),
    };
    AssessmentBar {
        condition: id,
        label: id.to_string(),
        value,
        selected: id == state.condition().id(),
        detail,
        figures,
    }
}

/// Why a response of a condition has no change of J.
fn why_not(table: &AssessmentTable, condition: ConditionId, pair: Pair) -> String {
    let left_out = table.left_out.iter().find(|left_out| left_out.condition == condition);
    let assessed = table.conditions.iter().find(|assessed| assessed.condition == condition);
    let missing = assessed.and_then(|assessed| assessed.missing.iter().find(|(missing, _)| *missing == pair));
    let why = left_out.map(|left_out| left_out.why.as_str()).or(missing.map(|(_, why)| why.as_str()));
    why.unwrap_or("not computed").to_owned()
}

/// The responses shown down, the conditions across, with the change of J in each cell; signed.
pub fn assessment_text_table(state: &State, table: &AssessmentTable) -> Table {
    let part = state.display.assessed.part;
    let conditions = state.dataset().conditions();
    let headings = conditions.iter().map(|condition| condition.id().to_string());
    let title = format!("{} of each response in each condition", part.symbol());
    let mut text = Table::new(title, std::iter::once("response".to_owned()).chain(headings));
    for pair in assessed_pairs(state) {
        let cell = |condition: &std::sync::Arc<Condition>| {
            let change = table.change(condition.id(), pair);
            change.map_or_else(|| "–".to_owned(), |change| signed(part.of(change), 1))
        };
        text.row(std::iter::once(state.dataset().pair_name(pair)).chain(conditions.iter().map(cell)));
    }
    text
}

/// The assessment in sentences: how much came closer, and what was left out.
pub fn assessment_sentences(state: &State, table: &AssessmentTable) -> Vec<String> {
    let pairs = assessed_pairs(state);
    let marked = state.dataset().on_axis().map(|pair, _| pairs.contains(&pair));
    let mut sentences = vec![table.summary(&marked).words(state.dataset())];
    let verdict = state.analysis().and_then(|analysis| held_out_verdict(analysis, table.choice));
    sentences.extend(verdict);
    for left_out in &table.left_out {
        sentences.push(format!("condition {} is left out: {}", left_out.condition, left_out.why));
    }
    sentences
}
