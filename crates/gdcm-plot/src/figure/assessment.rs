//! Value of the correction: the change of J in each condition (M12, Figures 8 to 19), and the
//! contributions to the scatter of the net gains (M13.5).

use gdcm_method::fidelity::CostAverage;
use gdcm_method::schedule::CostChange;
use gdcm_method::uncertainty::VarianceDecomposition;
use gdcm_model::dataset::{ConditionId, Dataset, Pair};
use gdcm_model::units::signed;
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice};
use gdcm_study::results::uncertainty::{PairScatter, Uncertainty};
use gdcm_study::{Analysis, AssessedCorrection, AssessmentTable};
use gdcm_words::Table;
use gdcm_words::assessment::not_assessed_text;
use gdcm_words::uncertainty::differences_summary;

use super::axis::{Axis, Range};
use super::condition_source::{schedule_words, settings_words};
use super::drawing::{Color, Hue, Stroke};
use super::figure::{Bars, DotShape, Dots, Figure, Intervals, Note, Panel, Place, Plot, Rule};

const ZERO: Stroke = Stroke::solid(Color::DIM, 0.6);
/// Width of a bar; conditions are 1 apart.
const BAR: f64 = 0.27;

/// A part of the change of J and the style of its bars; in print, parts differ in darkness.
struct Part {
    name: &'static str,
    color: Color,
    of: fn(CostChange) -> f64,
}

const PARTS: [Part; 3] = [
    Part {
        name: "ΔJ",
        color: Color::INK,
        of: CostChange::total,
    },
    Part {
        name: "ΔJ magnitude",
        color: Color::DIM,
        of: CostChange::magnitude,
    },
    Part {
        name: "ΔJ phase",
        color: Color::DIM.tint(45),
        of: CostChange::phase,
    },
];

/// Plots ΔJ and its parts for each of `pairs` in each condition; negative values are improvements.
pub fn assessment_figure(analysis: &Analysis, pairs: &[Pair], choice: AssessmentChoice) -> Figure {
    let table = AssessmentTable::of(analysis, choice);
    let title = |pair| analysis.study.dataset.pair_name(pair);
    let plots = pairs
        .iter()
        .map(|&pair| Plot::new(title(pair)).panel(panel(analysis, &table, pair)));
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
    let figure = Figure::new(format!(
        "Change of J of the {model} model under {correction}"
    ));
    figure
        .caption(caption(analysis, &table))
        .plots(plots)
        .columns(3)
        .aspect(0.62)
}

/// Returns the paper's choice: the nominal model under the schedule, with the average from the
/// settings.
pub fn usual_choice(analysis: &Analysis) -> AssessmentChoice {
    let average = analysis.study.settings.cost_average;
    AssessmentChoice {
        model: AssessedModel::Nominal,
        correction: AssessedCorrection::Scheduled,
        average,
    }
}

fn panel(analysis: &Analysis, table: &AssessmentTable, pair: Pair) -> Panel {
    let conditions = analysis.study.dataset.conditions();
    let changes: Vec<Option<CostChange>> = conditions
        .iter()
        .map(|condition| table.change(condition.id(), pair))
        .collect();
    let bars = PARTS
        .into_iter()
        .zip([-BAR, 0.0, BAR])
        .map(|(part, beside)| {
            let value = |(index, change): (usize, &Option<CostChange>)| {
                Some([index as f64, (part.of)((*change)?)])
            };
            let bars = changes.iter().enumerate().filter_map(value).collect();
            Bars {
                name: part.name.to_owned(),
                color: part.color,
                width: BAR,
                bars,
                feet: Vec::new(),
                beside,
            }
        });
    let left_out = changes
        .iter()
        .enumerate()
        .filter(|(_, change)| change.is_none())
        .map(|(index, _)| Note {
            at: Place::Value {
                x: index as f64,
                y: 0.0,
                upright: true,
            },
            text: "left out".to_owned(),
        });
    let x = Axis::named(
        "Condition",
        conditions
            .iter()
            .map(|condition| condition.id().to_string()),
    );
    let panel = Panel::new(x, Axis::linear("ΔJ [-]").including(0.0).at_least(1.0));
    panel
        .with_all(bars)
        .with(Rule::horizontal(0.0, ZERO))
        .with_all(left_out)
}

/// Tabulates the signed change of J of each of `pairs`, or a part of it, in each condition under
/// these headings.
pub fn change_table(
    title: impl Into<String>,
    (dataset, found): (&Dataset, &AssessmentTable),
    pairs: &[Pair],
    conditions: &[(ConditionId, String)],
    part: fn(CostChange) -> f64,
) -> Table {
    let headings = conditions.iter().map(|(_, heading)| heading.clone());
    let mut table = Table::new(
        title,
        std::iter::once("response".to_owned()).chain(headings),
    );
    for &pair in pairs {
        let change = |(id, _): &(ConditionId, String)| {
            found
                .change(*id, pair)
                .map(|change| signed(part(change), 1))
        };
        let cells = conditions
            .iter()
            .map(|condition| change(condition).unwrap_or("–".to_owned()));
        table.row(std::iter::once(dataset.pair_name(pair)).chain(cells));
    }
    table
}

/// Returns `the median` or `the mean`.
pub fn average_word(average: CostAverage) -> &'static str {
    match average {
        CostAverage::Median => "the median",
        CostAverage::Mean => "the mean",
    }
}

/// Describes the settings, the schedule, and the excluded conditions with reasons.
fn caption(analysis: &Analysis, table: &AssessmentTable) -> String {
    let study = &analysis.study;
    let mut caption = settings_words(&study.dataset, &study.settings);
    if table.choice.correction != AssessedCorrection::Own {
        caption.push_str(&format!(
            " Schedule: {}.",
            schedule_words(&study.settings.schedule)
        ));
    }
    let average = average_word(table.choice.average);
    caption.push_str(&format!(
        " J takes {average} over frequency; below 0 is better."
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

/// Width of a stacked bar; places are 1 apart.
const STACK: f64 = 0.56;
/// Spacing of the dots at the same place.
const APART: f64 = 0.24;
/// Interval of the unexplained rest.
const INTERVAL: Stroke = Stroke::solid(Color::of(Hue::Nominal).tint(50), 2.4);
/// Intervals are shown up to this multiple of the scatter.
const MOST_SEEN: f64 = 4.0;
/// The shares end at 100 %; the numbers above them need the rest \[%\].
const SHARES: Range = Range {
    min: 0.0,
    max: 118.0,
};
/// Position of those numbers \[%\].
const ABOVE: f64 = 109.0;

/// Reference of each scatter, in the order of the places on the axis.
const ABOUT: [&str; 2] = ["airspeed", "schedule"];
/// Parts of a scatter, from the bottom up; in print they differ in darkness.
const SHARED: [(&str, Hue); 3] = [
    ("trim", Hue::Perturbed),
    ("identification", Hue::Identified),
    ("unexplained", Hue::Nominal),
];

/// Plots the split of the scatter of each of `pairs`, at equal airspeed and about the schedule:
/// shares of the variance as stacked bars; below them the scatter, its expected value, and the
/// unexplained rest with its interval. `None` without confidence intervals, or if no pair has a
/// scatter.
pub fn evidence_figure(analysis: &Analysis, pairs: &[Pair]) -> Option<Figure> {
    let uncertainty = analysis.uncertainty.as_ref()?;
    let of_pairs = uncertainty
        .scatter
        .iter()
        .filter(|scatter| pairs.contains(&scatter.pair));
    let plot = |scatter: &PairScatter| {
        let title = analysis.study.dataset.pair_name(scatter.pair);
        Plot::new(title)
            .panel(shares(scatter))
            .panel(deviations(scatter, uncertainty.level))
    };
    let plots: Vec<Plot> = of_pairs.map(plot).collect();
    let figure = Figure::new("What the scatter of the net gains is made of")
        .caption(evidence_caption(analysis, uncertainty));
    (!plots.is_empty()).then(|| {
        figure
            .plots(plots)
            .columns(5)
            .shared_x()
            .shared_y()
            .aspect(1.9)
    })
}

/// Returns the available splits with their places.
fn splits(scatter: &PairScatter) -> impl Iterator<Item = (f64, &VarianceDecomposition)> {
    let both = [
        scatter.same_airspeed.as_ref(),
        scatter.about_schedule.as_ref(),
    ];
    both.into_iter()
        .zip([0.0, 1.0])
        .filter_map(|(split, x)| Some((x, split?)))
}

fn axis() -> Axis {
    Axis::named("Scatter about", ABOUT)
}

/// Plots the shares of trim, identification and rest in the variance, stacked.
fn shares(scatter: &PairScatter) -> Panel {
    let mut feet = [0.0; 2];
    let bars = (0..SHARED.len()).map(|part| {
        let share =
            |(x, split): (f64, &VarianceDecomposition)| Some([x, 100.0 * split.shares()?[part]]);
        let bars: Vec<[f64; 2]> = splits(scatter).filter_map(share).collect();
        let on: Vec<f64> = bars.iter().map(|[x, _]| feet[*x as usize]).collect();
        bars.iter()
            .for_each(|[x, share]| feet[*x as usize] += share);
        let (name, hue) = SHARED[part];
        Bars {
            name: name.to_owned(),
            color: Color::of(hue),
            width: STACK,
            bars,
            feet: on,
            beside: 0.0,
        }
    });
    let bars: Vec<Bars> = bars.collect();
    let note = |x: f64, y: f64, text: String, upright: bool| Note {
        at: Place::Value { x, y, upright },
        text,
    };
    let times = splits(scatter)
        .filter_map(|(x, split)| Some(note(x, ABOVE, format!("{:.1}×", split.ratio()?), false)));
    let missing = [&scatter.same_airspeed, &scatter.about_schedule]
        .into_iter()
        .zip([0.0, 1.0]);
    let missing = missing.filter(|(split, _)| split.is_none());
    let missing = missing.map(|(_, x)| note(x, 50.0, "no freedom".to_owned(), true));
    let y = Axis::linear("Variance [%]").showing(Some(SHARES));
    Panel::new(axis(), y)
        .with_all(bars)
        .with_all(times)
        .with_all(missing)
}

/// Plots the standard deviations of `ln k_o k_i` in percent, and the interval of the rest.
fn deviations(scatter: &PairScatter, level: f64) -> Panel {
    let percent = |variance: f64| 100.0 * variance.sqrt();
    let scatter_of: fn(&VarianceDecomposition) -> f64 = |split| split.scatter;
    let figures = [
        ("scatter", DotShape::Circle, Color::INK, scatter_of),
        (
            "expected",
            DotShape::Diamond,
            Color::of(Hue::Perturbed),
            VarianceDecomposition::explained,
        ),
        (
            "unexplained",
            DotShape::Square,
            Color::of(Hue::Nominal),
            VarianceDecomposition::unexplained,
        ),
    ];
    let dots =
        figures
            .into_iter()
            .zip([-APART, 0.0, APART])
            .map(|((name, shape, color, of), beside)| {
                let dots = Dots::new(name, shape, color)
                    .key(name)
                    .filled(shape != DotShape::Diamond);
                splits(scatter).fold(dots, |dots, (x, split)| {
                    dots.dot(x + beside, percent(of(split)), "")
                })
            });
    let interval = |(x, split): (f64, &VarianceDecomposition)| {
        let [low, high] = split.unexplained_interval(level)?;
        Some([x + APART, 100.0 * low, 100.0 * high])
    };
    let ends: Vec<[f64; 3]> = splits(scatter).filter_map(interval).collect();
    let y = Axis::linear("Scatter [%]").including(0.0).at_least(1.0);
    let most = splits(scatter)
        .map(|(_, split)| MOST_SEEN * percent(split.scatter))
        .fold(0.0, f64::max);
    let y = ends
        .iter()
        .fold(y, |y, [_, _, high]| y.including(high.min(most)));
    let name = format!("unexplained, interval of {:.0} %", 100.0 * level);
    let intervals = (!ends.is_empty()).then_some(Intervals {
        name,
        stroke: INTERVAL,
        ends,
    });
    Panel::new(axis(), y).with_all(intervals).with_all(dots)
}

/// Describes the size of the differences, their parts, the schedule and the settings.
fn evidence_caption(analysis: &Analysis, uncertainty: &Uncertainty) -> String {
    let settings = &analysis.study.settings;
    format!(
        "{} Of ln(k_o k_i), about the mean of each airspeed and about the schedule ({}): shares of the variance, and standard \
         deviations. Trim, identification: expected from the bundles; unexplained: what neither makes. Above the bars: scatter, × expected. {}",
        differences_summary(uncertainty),
        schedule_words(&settings.schedule),
        settings_words(&analysis.study.dataset, settings)
    )
}
