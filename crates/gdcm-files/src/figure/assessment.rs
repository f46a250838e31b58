//! What the correction is worth: the change of J in each condition (M12, Figures 8 to 19).

use gdcm_core::dataset::Pair;
use gdcm_core::fidelity::CostAverage;
use gdcm_core::schedule::CostChange;
use gdcm_core::study::{Analysis, AssessedCorrection, AssessedModel, AssessmentChoice, AssessmentTable};

use super::axis::Axis;
use super::condition_source::{schedule_words, settings_words};
use super::drawing::{Color, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::mark::{Bars, Note, Place, Rule};

const ZERO: Stroke = Stroke::solid(Color::DIM, 0.6);
/// Width of a bar, where conditions are 1 apart.
const BAR: f64 = 0.27;

/// A part of the change of J, and how its bars look; in print they differ by how dark they are.
struct Part {
    name: &'static str,
    color: Color,
    of: fn(CostChange) -> f64,
}

const PARTS: [Part; 3] = [
    Part { name: "ΔJ", color: Color::INK, of: CostChange::total },
    Part { name: "ΔJ magnitude", color: Color::DIM, of: CostChange::magnitude },
    Part { name: "ΔJ phase", color: Color::DIM.tint(45), of: CostChange::phase },
];

/// ΔJ and its parts in each condition, of each of `pairs`; below 0 is better.
pub fn assessment_figure(analysis: &Analysis, pairs: &[Pair], choice: AssessmentChoice) -> Figure {
    let table = AssessmentTable::of(analysis, choice);
    let title = |pair| analysis.study.dataset.pair_name(pair);
    let plots = pairs.iter().map(|&pair| Plot::new(title(pair)).panel(panel(analysis, &table, pair)));
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
    let figure = Figure::new(format!("Change of J of the {model} model under {correction}"));
    figure.caption(caption(analysis, &table)).plots(plots).columns(3).aspect(0.62)
}

/// What the paper assesses: the nominal model under the schedule, with the average of the settings.
pub fn usual_choice(analysis: &Analysis) -> AssessmentChoice {
    let average = analysis.study.settings.cost_average;
    AssessmentChoice { model: AssessedModel::Nominal, correction: AssessedCorrection::Scheduled, average }
}

fn panel(analysis: &Analysis, table: &AssessmentTable, pair: Pair) -> Panel {
    let conditions = analysis.study.dataset.conditions();
    let changes: Vec<Option<CostChange>> =
        conditions.iter().map(|condition| table.change(condition.id(), pair)).collect();
    let bars = PARTS.into_iter().zip([-BAR, 0.0, BAR]).map(|(part, beside)| {
        let value = |(index, change): (usize, &Option<CostChange>)| Some([index as f64, (part.of)((*change)?)]);
        let bars = changes.iter().enumerate().filter_map(value).collect();
        Bars { name: part.name.to_owned(), color: part.color, width: BAR, bars, feet: Vec::new(), beside }
    });
    let left_out = changes.iter().enumerate().filter(|(_, change)| change.is_none()).map(|(index, _)| Note {
        at: Place::Value { x: index as f64, y: 0.0, upright: true },
        text: "left out".to_owned(),
    });
    let x = Axis::named("Condition", conditions.iter().map(|condition| condition.id().to_string()));
    let panel = Panel::new(x, Axis::linear("ΔJ [-]").including(0.0).at_least(1.0));
    panel.with_all(bars).with(Rule::horizontal(0.0, ZERO)).with_all(left_out)
}

/// The settings, the schedule, and which conditions are left out and why.
fn caption(analysis: &Analysis, table: &AssessmentTable) -> String {
    let study = &analysis.study;
    let mut caption = settings_words(&study.dataset, &study.settings);
    if table.choice.correction != AssessedCorrection::Own {
        caption.push_str(&format!(" Schedule: {}.", schedule_words(&study.settings.schedule)));
    }
    caption.push_str(match table.choice.average {
        CostAverage::Median => " J takes the median over frequency; below 0 is better.",
        CostAverage::Mean => " J takes the mean over frequency; below 0 is better.",
    });
    for left_out in &table.left_out {
        caption.push_str(&format!(" Condition {} is left out: {}.", left_out.condition, left_out.why));
    }
    caption
}
