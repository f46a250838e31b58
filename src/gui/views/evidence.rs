//! Sources of the scatter of the net gains, significant differences, and the required form of the
//! schedule.

use std::sync::Arc;

use egui::{
    Align2, Color32, FontId, Grid, Rect, RichText, ScrollArea, Sense, Ui, WidgetInfo, pos2, vec2,
};

use gdcm_method::schedule::ScheduleKind;
use gdcm_method::schedule::form_comparison::{FormComparison, FormFit, LeadDegreeFit, LeadFit};
use gdcm_method::uncertainty::VarianceDecomposition;
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::number_format::with_minus_sign;
use gdcm_model::units::{s_to_ms, signed};
use gdcm_study::decisions::setting;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_words::Table;
use gdcm_words::uncertainty::{
    difference_table, difference_verdict, differences_summary, second_variable_table,
};

use super::gain_plots::net_gain_pairs;
use crate::gui::commands::command::Command;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::state::evidence_cache::CachedEvidence;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{BODY_SIZE, Palette, SMALL_SIZE, medium};
use crate::gui::widgets::tables::{Sorting, TableLook, table_ui};

/// Height of the bar of a scatter \[pt\].
const BAR_HEIGHT: f32 = 15.0;
/// Greatest height of a table, which scrolls by itself beyond it \[pt\].
const MOST_TABLE: f32 = 330.0;
/// Width of the labels before the bars, and of the text behind them \[pt\].
const LABELS: [f32; 2] = [170.0, 400.0];

/// Draws the paper's question on a single screen: is the scatter at a given airspeed due to trim,
/// to identification, or real?
pub fn evidence_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let Some(uncertainty) = state.uncertainty().cloned() else {
        ui.label(RichText::new(state.results.absence_of_bars()).color(palette.dim_text));
        return;
    };
    let mut sorting = state.display.gains.evidence_tables;
    ui.label(RichText::new(differences_summary(&uncertainty)).font(medium(BODY_SIZE)));
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        answer_ui(ui, state, &uncertainty, palette);
        scatter_ui(ui, state, &uncertainty, palette);
        tables_ui(ui, state, &uncertainty, (&mut sorting, palette), commands);
    });
    state.display.gains.evidence_tables = sorting;
}

/// Draws the significant differences in aligned columns, and a note if no response needs a second
/// variable.
fn answer_ui(ui: &mut Ui, state: &State, uncertainty: &Uncertainty, palette: &Palette) {
    let beyond: Vec<_> = uncertainty
        .differences
        .iter()
        .filter(|of| of.is_significant(uncertainty.level))
        .collect();
    if let Some(of) = beyond.first() {
        let verdict = difference_verdict(of, uncertainty.level);
        ui.label(palette.small(format!(
            "{verdict}; expected: from trim and identification uncertainty"
        )));
    }
    Grid::new("significant differences")
        .num_columns(4)
        .spacing([16.0, 1.0])
        .min_row_height(16.0)
        .show(ui, |ui| {
            for of in beyond {
                let [first, second] = of.conditions;
                let difference = &of.difference;
                let ratio = difference
                    .ratio()
                    .map_or_else(String::new, |ratio| format!("{ratio:.1} × expected"));
                for words in [
                    state.dataset().pair_name(of.pair),
                    format!("conditions {first} and {second} ({:.0} kt)", of.airspeed_kt),
                    format!("{:.0} %", 100.0 * difference.delta.abs()),
                    ratio,
                ] {
                    ui.label(RichText::new(words).size(SMALL_SIZE));
                }
                ui.end_row();
            }
        });
    if let Some(variable) = state.study.settings.schedule.second {
        let tests = uncertainty
            .second_variables
            .iter()
            .filter(|test| test.variable == variable);
        if !tests.clone().any(|test| test.needed) {
            let words = "though no response is found to need it";
            ui.label(palette.small_warning(format!(
                "The schedule is one of airspeed and {variable}, {words}."
            )));
        }
    }
    ui.add_space(4.0);
}

/// Draws a stacked bar for each response, at equal airspeed and about the schedule.
fn scatter_ui(ui: &mut Ui, state: &State, uncertainty: &Uncertainty, palette: &Palette) {
    ui.horizontal(|ui| {
        ui.label(
            RichText::new("What the scatter is made of")
                .size(SMALL_SIZE)
                .strong(),
        );
        for (name, color) in ["trim", "identification", "unexplained"]
            .into_iter()
            .zip(colors(palette))
        {
            let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, color);
            ui.label(RichText::new(name).size(SMALL_SIZE).color(palette.dim_text));
        }
    });
    for scatter in &uncertainty.scatter {
        let name = state.dataset().pair_name(scatter.pair);
        for (about, split) in [
            ("at equal airspeed", &scatter.same_airspeed),
            ("about the schedule", &scatter.about_schedule),
        ] {
            split_ui(
                ui,
                &format!("{name} {about}"),
                split.as_ref(),
                uncertainty.level,
                palette,
            );
        }
        ui.add_space(3.0);
    }
    ui.add_space(6.0);
}

fn colors(palette: &Palette) -> [Color32; 3] {
    [palette.perturbed, palette.identified, palette.nominal]
}

fn split_ui(
    ui: &mut Ui,
    name: &str,
    split: Option<&VarianceDecomposition>,
    level: f64,
    palette: &Palette,
) {
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), BAR_HEIGHT + 3.0), Sense::hover());
    let words = split.map_or_else(
        || "no degrees of freedom".to_owned(),
        |split| split_words(split, level),
    );
    response
        .widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, format!("{name}: {words}")));
    let painter = ui.painter();
    let font = FontId::proportional(SMALL_SIZE);
    painter.text(
        rect.left_center(),
        Align2::LEFT_CENTER,
        name,
        font.clone(),
        palette.dim_text,
    );
    let [left, right] = [
        rect.left() + LABELS[0],
        (rect.right() - LABELS[1]).max(rect.left() + LABELS[0] + 60.0),
    ];
    painter.text(
        pos2(right + 8.0, rect.center().y),
        Align2::LEFT_CENTER,
        &words,
        font,
        palette.text,
    );
    let mut from = left;
    for (share, color) in split
        .and_then(VarianceDecomposition::shares)
        .unwrap_or_default()
        .into_iter()
        .zip(colors(palette))
    {
        let to = from + (right - left) * share as f32;
        let part =
            Rect::from_x_y_ranges(from..=to, rect.top() + 1.0..=rect.top() + 1.0 + BAR_HEIGHT);
        painter.rect_filled(part, 0.0, color);
        from = to;
    }
    response.on_hover_text(format!("{name}: {words}"));
}

/// "scatter 6.2 % (sd); 2.7 × expected; unexplained 5.8 % (90 %: 3.6 to 11.6)".
fn split_words(split: &VarianceDecomposition, level: f64) -> String {
    let percent = |variance: f64| 100.0 * variance.sqrt();
    let times = split
        .ratio()
        .map_or_else(String::new, |ratio| format!("; {ratio:.1} × expected"));
    let interval = split.unexplained_interval(level).map(|[low, high]| {
        format!(
            " ({:.0} %: {:.1} to {:.1})",
            100.0 * level,
            100.0 * low,
            100.0 * high
        )
    });
    format!(
        "scatter {:.1} % (sd){times}; unexplained {:.1} %{}",
        percent(split.scatter),
        percent(split.unexplained()),
        interval.unwrap_or_default()
    )
}

/// Draws the differences, the second variables, and the prediction error of each form of the
/// schedule for left-out conditions.
fn tables_ui(
    ui: &mut Ui,
    state: &mut State,
    uncertainty: &Uncertainty,
    (sorting, palette): (&mut [Sorting; 3], &Palette),
    commands: &mut Vec<Command>,
) {
    let heading = |ui: &mut Ui, text: &str| ui.label(RichText::new(text).size(SMALL_SIZE).strong());
    let (table, differences) = difference_table(state.dataset(), uncertainty);
    heading(ui, &table.title);
    let color = |row: usize, column: usize| {
        let beyond = differences
            .get(row)
            .is_some_and(|of| of.is_significant(uncertainty.level));
        (column == 6 && beyond).then_some(palette.warning)
    };
    let look = TableLook {
        color: &color,
        ..TableLook::PLAIN
    };
    let click = rows_high(ui, table.rows.len(), |ui| {
        table_ui(ui, &table, &mut sorting[0], &look, palette, commands)
    });
    if let Some(click) = click
        && let Some(of) = differences.get(click.row)
    {
        commands.push(SelectionCommand::SelectCondition(of.conditions[0]).into());
        commands.push(SelectionCommand::FocusPair(of.pair).into());
    }
    let table = second_variable_table(state.dataset(), uncertainty);
    heading(ui, &table.title);
    rows_high(ui, table.rows.len(), |ui| {
        table_ui(
            ui,
            &table,
            &mut sorting[1],
            &TableLook::PLAIN,
            palette,
            commands,
        )
    });
    let mut cached = std::mem::take(&mut state.display.gains.evidence);
    cached.refresh(state);
    if let Some((_, evidence)) = cached.found() {
        heading(
            ui,
            "Error of each form of the schedule, fitted and of a condition it has not seen [% of the net gain]",
        );
        let rows = evidence.kinds.len();
        rows_high(ui, rows, |ui| {
            forms_ui(ui, state, evidence, (&mut sorting[2], palette), commands)
        });
    }
    state.display.gains.evidence = cached;
}

/// Draws the evidence for every form of the schedule; a click on a form selects it.
pub(super) fn forms_ui(
    ui: &mut Ui,
    state: &State,
    evidence: &FormComparison,
    (sorting, palette): (&mut Sorting, &Palette),
    commands: &mut Vec<Command>,
) {
    let (table, kinds) = evidence_table(state, evidence);
    let kind = state.study.settings.schedule.kind;
    let look = TableLook {
        selected: &|row| kinds.get(row) == Some(&kind),
        ..TableLook::PLAIN
    };
    let click = table_ui(ui, &table, sorting, &look, palette, commands);
    let taken = click.and_then(|click| kinds.get(click.row));
    commands.extend(taken.map(|&kind| setting::SCHEDULE.to(kind).into()));
}

/// Draws a table among others in a scrolling area, with the height of its rows.
fn rows_high<R>(ui: &mut Ui, rows: usize, add: impl FnOnce(&mut Ui) -> R) -> R {
    let row = ui.spacing().interact_size.y + 3.0;
    let bar = ui.spacing().scroll.allocated_width();
    let height = (row * (rows + 1) as f32 + bar + 4.0).min(MOST_TABLE);
    ui.allocate_ui(vec2(ui.available_width(), height), add)
        .inner
}

impl CachedEvidence {
    /// Recomputes the evidence for another analysis.
    pub fn refresh(&mut self, state: &State) {
        let Some(analysis) = state
            .results
            .analysis
            .as_ref()
            .filter(|_| state.analysis().is_some())
        else {
            *self = Self::default();
            return;
        };
        if !self
            .analysis
            .as_ref()
            .is_some_and(|known| Arc::ptr_eq(known, analysis))
        {
            self.leads = analysis.compare_lead_degrees();
            self.found = analysis
                .compare_forms()
                .ok()
                .map(|evidence| (analysis.scheduled(), evidence));
            self.analysis = Some(Arc::clone(analysis));
        }
    }

    /// Returns the evidence for each degree of the signed delays.
    pub fn leads(&self) -> &[LeadDegreeFit] {
        &self.leads
    }

    /// Returns the conditions of the schedule, and the evidence in their order.
    pub fn found(&self) -> Option<(&[ConditionId], &FormComparison)> {
        self.found
            .as_ref()
            .map(|(conditions, evidence)| (conditions.as_slice(), evidence))
    }
}

/// Builds the table of the residuals and of the prediction errors for left-out conditions of each
/// displayed response, for each degree of the scheduled signed delays; `None` without leads.
pub fn lead_evidence_table(state: &State, evidence: &[LeadDegreeFit]) -> Option<Table> {
    let pairs = net_gain_pairs(state);
    let names = pairs.iter().flat_map(|pair| {
        let name = state.dataset().pair_name(*pair);
        [format!("{name}, fit [ms]"), format!("{name}, unseen [ms]")]
    });
    let columns = std::iter::once("signed delays".to_owned()).chain(names);
    let mut table = Table::new("Errors of each degree of the signed delays", columns);
    for of in evidence {
        let figure = |error_s: Option<f64>| {
            error_s.map_or("–".to_owned(), |error_s| {
                format!("{:.2}", s_to_ms(error_s))
            })
        };
        let cells = pairs.iter().flat_map(|pair| {
            let LeadFit {
                rms_s,
                left_out_rms_s,
            } = of.pairs[*pair];
            [figure(Some(rms_s)), figure(left_out_rms_s)]
        });
        table.row(
            std::iter::once(kind_name(ScheduleKind::Polynomial { degree: of.degree })).chain(cells),
        );
    }
    (!evidence.is_empty()).then_some(table)
}

/// Returns the name of a form of the schedule in the table.
fn kind_name(kind: ScheduleKind) -> String {
    match kind {
        ScheduleKind::Polynomial { degree: 0 } => "constant".to_owned(),
        ScheduleKind::Polynomial { degree } => format!("degree {degree}"),
        ScheduleKind::Table => "table".to_owned(),
    }
}

/// Converts a root mean square of `ln k` to a share of the gain \[%\].
fn percent(rms_ln: Option<f64>) -> String {
    rms_ln.map_or_else(|| "–".to_owned(), |rms| format!("{:.2}", 100.0 * rms))
}

/// Builds the table of the residuals and of the prediction errors for left-out conditions of each
/// displayed response, for each form of the schedule.
pub fn evidence_table(state: &State, evidence: &FormComparison) -> (Table, Vec<ScheduleKind>) {
    let pairs = net_gain_pairs(state);
    let names = pairs
        .iter()
        .map(|pair| format!("{} [%]", state.dataset().pair_name(*pair)));
    let columns = [
        "schedule".to_owned(),
        "fit [%]".to_owned(),
        "unseen [%]".to_owned(),
    ]
    .into_iter()
    .chain(names);
    let mut table = Table::new("Errors of each form of the schedule", columns);
    let mut kinds = Vec::new();
    for kind in &evidence.kinds {
        let unseen = pairs
            .iter()
            .map(|pair| percent(kind.pairs[*pair].left_out_rms_ln()));
        let whole = [
            kind_name(kind.kind),
            percent(fit(kind, &pairs)),
            percent(kind.left_out_rms_ln(pairs.iter().copied())),
        ];
        table.row(whole.into_iter().chain(unseen));
        kinds.push(kind.kind);
    }
    (table, kinds)
}

/// Computes the root mean square of the residuals over these responses.
fn fit(kind: &FormFit, pairs: &[Pair]) -> Option<f64> {
    let squares = pairs
        .iter()
        .map(|pair| kind.pairs[*pair].rms_ln().map(|rms| rms * rms));
    let squares: Vec<f64> = squares.collect::<Option<_>>()?;
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Builds the table of the residuals of each condition under the present schedule, for each
/// displayed response \[% of the scheduled gain\].
pub fn residual_table(
    state: &State,
    conditions: &[ConditionId],
    evidence: &FormComparison,
) -> Option<Table> {
    let kind = evidence.form(state.study.settings.schedule.kind)?;
    let pairs = net_gain_pairs(state);
    let names = pairs
        .iter()
        .map(|pair| format!("{} [%]", state.dataset().pair_name(*pair)));
    let mut table = Table::new(
        "Residuals of the schedule",
        std::iter::once("condition".to_owned()).chain(names),
    );
    for (index, condition) in conditions.iter().enumerate() {
        let cell = |pair: &Pair| {
            let residual = kind.pairs[*pair].residuals.get(index).copied().flatten();
            residual.map_or_else(|| "–".to_owned(), |residual| signed(residual.percent, 2))
        };
        table.row(std::iter::once(condition.to_string()).chain(pairs.iter().map(cell)));
    }
    Some(table)
}

/// Builds the table of the schedule's coefficients, channel by channel; `None` without a schedule.
pub fn coefficient_table(state: &State) -> Option<Table> {
    let schedule = state.analysis()?.schedule.as_ref().ok()?;
    let (inputs, outputs) = state.dataset().names_of_channels();
    let found = schedule.coefficients(&inputs, &outputs);
    let title = if found.scale.is_empty() {
        "Schedule".to_owned()
    } else {
        format!("Schedule, {}", found.scale)
    };
    let mut table = Table::new(title, std::iter::once("of".to_owned()).chain(found.columns));
    for row in found.rows {
        let figures = row
            .figures
            .iter()
            .map(|figure| with_minus_sign(&format!("{figure:.5}")));
        table.row(std::iter::once(row.name).chain(figures));
    }
    Some(table)
}
