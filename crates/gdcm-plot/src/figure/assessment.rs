//! Change in J due to the correction in each condition (M12, Figures 8 to 19).
//!
//! J is a response's cost: the weighted squares of its differences from the identified reference in
//! magnitude and phase, averaged over frequency (M4). ΔJ is J after the correction less J before
//! it.

use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{Dataset, Pair};
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::assessment_table::{
    AssessedCorrection, AssessedModel, AssessmentChoice, AssessmentTable,
};
use gdcm_words::assessment::not_assessed_text;

pub use super::cost_change_table::{ChangeColumn, ChangeTable};
pub use super::evidence::evidence_figure;

use super::axis::Axis;
use super::caption_words::{settings_words, used_schedule_words};
use super::drawing::{Color, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Bars, Note, Place, Rule};

/// Line at no change.
const ZERO: Stroke = Stroke::solid(Color::DIM, 0.6);
/// Bar width; neighbouring conditions are 1 apart on the axis.
const BAR: f64 = 0.27;

/// A part of ΔJ and its bar style; in print, parts differ in darkness.
struct Part {
    name: &'static str,
    color: Color,
    value: fn(CostChange) -> f64,
    /// Offset between a bar and its condition's position on the axis.
    beside: f64,
}

const PARTS: [Part; 3] = [
    Part {
        name: "ΔJ",
        color: Color::INK,
        value: CostChange::total,
        beside: -BAR,
    },
    Part {
        name: "ΔJ magnitude",
        color: Color::DIM,
        value: CostChange::magnitude,
        beside: 0.0,
    },
    Part {
        name: "ΔJ phase",
        color: Color::DIM.tint(45),
        value: CostChange::phase,
        beside: BAR,
    },
];

/// Plots ΔJ and its parts over the conditions, for each of `pairs`; negative values are
/// improvements.
pub fn assessment_figure(analysis: &Analysis, pairs: &[Pair], choice: AssessmentChoice) -> Figure {
    let table = AssessmentTable::assess(analysis, choice);
    let dataset = &analysis.study.dataset;
    let mut plots = Vec::new();
    for &pair in pairs {
        let panel = change_panel(dataset, &table, pair);
        plots.push(Plot::new(dataset.pair_name(pair)).panel(panel));
    }
    let model = match choice.model {
        AssessedModel::Nominal => "nominal",
        AssessedModel::Representative => "representative",
    };
    let correction = match choice.correction {
        AssessedCorrection::Scheduled => "the schedule",
        AssessedCorrection::ScheduledWithoutLeads => "the schedule without its leads",
        AssessedCorrection::ScheduleOfOthers => "the schedule of the other conditions",
        AssessedCorrection::Own => "each condition's own optimum",
    };
    let title = format!("Change in J of the {model} model under {correction}");
    Figure::new(title)
        .caption(caption(analysis, &table))
        .plots(plots)
        .columns(3)
        .aspect(0.62)
}

/// Returns the choice used in Figures 8 to 19: nominal model, scheduled correction, and the average
/// from the settings.
pub fn usual_choice(analysis: &Analysis) -> AssessmentChoice {
    AssessmentChoice {
        model: AssessedModel::Nominal,
        correction: AssessedCorrection::Scheduled,
        average: analysis.study.settings.cost_average,
    }
}

/// Draws a response's ΔJ as bars over the conditions; conditions without an available ΔJ are
/// labelled "left out".
fn change_panel(dataset: &Dataset, table: &AssessmentTable, pair: Pair) -> Panel {
    let conditions = dataset.conditions();
    let names = conditions
        .iter()
        .map(|condition| condition.id().to_string());
    let x = Axis::named("Condition", names);
    let y = Axis::linear("ΔJ [-]").including(0.0).at_least(1.0);
    let mut bar_groups = PARTS.map(|part| Bars {
        name: part.name.to_owned(),
        color: part.color,
        width: BAR,
        bars: Vec::new(),
        feet: Vec::new(),
        beside: part.beside,
    });
    let mut left_out = Vec::new();
    for (index, condition) in conditions.iter().enumerate() {
        let x = index as f64;
        match table.change(condition.id(), pair) {
            Some(change) => {
                for (part, group) in PARTS.iter().zip(&mut bar_groups) {
                    group.bars.push([x, (part.value)(change)]);
                }
            }
            None => left_out.push(left_out_note(x)),
        }
    }
    Panel::new(x, y)
        .with_all(bar_groups)
        .with(Rule::horizontal(0.0, ZERO))
        .with_all(left_out)
}

fn left_out_note(x: f64) -> Note {
    Note {
        at: Place::Value {
            x,
            y: 0.0,
            upright: true,
        },
        text: "left out".to_owned(),
    }
}

/// Returns `the median` or `the mean`.
pub fn average_word(average: CostAverage) -> &'static str {
    match average {
        CostAverage::Median => "the median",
        CostAverage::Mean => "the mean",
    }
}

/// Describes the settings, the schedule (unless the conditions' own optima are assessed) and the
/// average in J, and lists the excluded conditions with reasons.
fn caption(analysis: &Analysis, table: &AssessmentTable) -> String {
    let study = &analysis.study;
    let mut caption = settings_words(&study.dataset, &study.settings);
    if table.choice.correction != AssessedCorrection::Own {
        let schedule = used_schedule_words(analysis);
        caption.push_str(&format!(" Schedule: {schedule}."));
    }
    let average = average_word(table.choice.average);
    caption.push_str(&format!(
        " J is based on {average} over frequency; negative changes are improvements."
    ));
    for left_out in &table.left_out {
        caption.push_str(&format!(
            " Condition {} is left out: {}.",
            left_out.condition,
            not_assessed_text(&left_out.why, &study.dataset)
        ));
    }
    caption
}
