//! Contributions to the scatter of net gains (M13.5).
//!
//! The *net gain* of a response is `k_o k_i`, the product of its channels' gains. Its *scatter* is
//! the variance of `ln k_o k_i` between conditions at equal airspeed, or about the schedule. The
//! expected part comes from the bundles: *trim* is the mean square change when another physics
//! model of the bundle replaces the representative, *identification* the same with another
//! identified model (M13.1, M13.2). The rest is *unexplained*.

use gdcm_method::uncertainty::VarianceDecomposition;
use gdcm_model::dataset::Pair;
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::uncertainty::{PairScatter, Uncertainty};
use gdcm_words::uncertainty::differences_summary;

use super::axis::{Axis, Range};
use super::caption_words::{settings_words, used_schedule_words};
use super::drawing::{Color, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Bars, DotShape, Dots, Intervals, Note, Place};

/// Bar width; positions on the axis are 1 apart.
const BAR: f64 = 0.56;
/// Offset between dots at the same axis position.
const APART: f64 = 0.24;
/// Confidence interval for the unexplained part.
const INTERVAL: Stroke = Stroke::solid(Color::new(Hue::Nominal).tint(50), 2.4);
/// Interval ends are shown up to this multiple of the largest scatter.
const MOST_SHOWN: f64 = 4.0;
/// Range shown on the variance axis \[%\]: the shares end at 100, and the ratios are written above.
const SHARE_RANGE: Range = Range {
    min: 0.0,
    max: 118.0,
};
/// Position \[%\] for the ratios above the shares.
const RATIO_HEIGHT: f64 = 109.0;
/// Position \[%\] for the note on a missing decomposition.
const MISSING_HEIGHT: f64 = 50.0;

/// Names of the axis positions: scatter between conditions at equal airspeed, and scatter about the
/// schedule.
const ABOUT: [&str; 2] = ["airspeed", "schedule"];

/// A share of the variance, with its colour; in print, shares differ in darkness.
struct Share {
    name: &'static str,
    hue: Hue,
}

/// Stacking order, from the bottom up; the same as in [`VarianceDecomposition::shares`].
const STACK: [Share; 3] = [
    Share {
        name: "trim",
        hue: Hue::Perturbed,
    },
    Share {
        name: "identification",
        hue: Hue::Identified,
    },
    Share {
        name: "unexplained",
        hue: Hue::Nominal,
    },
];

/// Plots the contributions to the scatter for each pair, at equal airspeed and about the schedule:
/// variance shares as stacked bars; below them, the scatter, its expected value, and the
/// unexplained part with its interval. `None` without error bars, or if no pair has a scatter.
pub fn evidence_figure(analysis: &Analysis, pairs: &[Pair]) -> Option<Figure> {
    let uncertainty = analysis.uncertainty.as_ref()?;
    let mut plots = Vec::new();
    for scatter in &uncertainty.scatter {
        if pairs.contains(&scatter.pair) {
            let title = analysis.study.dataset.pair_name(scatter.pair);
            let plot = Plot::new(title)
                .panel(shares_panel(scatter))
                .panel(deviations_panel(scatter, uncertainty.level));
            plots.push(plot);
        }
    }
    if plots.is_empty() {
        return None;
    }
    let figure = Figure::new("Contributions to the scatter of the net gains")
        .caption(caption(analysis, uncertainty))
        .plots(plots)
        .columns(5)
        .shared_x()
        .shared_y()
        .aspect(1.9);
    Some(figure)
}

/// A decomposed variance, at its position on the axis.
struct PlacedSplit<'a> {
    x: f64,
    split: Option<&'a VarianceDecomposition>,
}

fn placed_splits(scatter: &PairScatter) -> [PlacedSplit<'_>; 2] {
    [
        PlacedSplit {
            x: 0.0,
            split: scatter.same_airspeed.as_ref(),
        },
        PlacedSplit {
            x: 1.0,
            split: scatter.about_schedule.as_ref(),
        },
    ]
}

fn axis() -> Axis {
    Axis::named("Scatter about", ABOUT)
}

/// Stacks the variance shares due to trim, identification and unexplained causes; above, the ratio
/// between scatter and expected value.
fn shares_panel(scatter: &PairScatter) -> Panel {
    let mut stack = STACK.map(|share| Bars {
        name: share.name.to_owned(),
        color: Color::new(share.hue),
        width: BAR,
        bars: Vec::new(),
        feet: Vec::new(),
        beside: 0.0,
    });
    let mut ratios = Vec::new();
    let mut missing = Vec::new();
    for PlacedSplit { x, split } in placed_splits(scatter) {
        let Some(split) = split else {
            missing.push(note(
                x,
                MISSING_HEIGHT,
                "no degrees of freedom".to_owned(),
                true,
            ));
            continue;
        };
        if let Some(shares) = split.shares() {
            let mut foot = 0.0;
            for (bars, share) in stack.iter_mut().zip(shares) {
                let percent = 100.0 * share;
                bars.bars.push([x, percent]);
                bars.feet.push(foot);
                foot += percent;
            }
        }
        if let Some(ratio) = split.ratio() {
            ratios.push(note(x, RATIO_HEIGHT, format!("{ratio:.1}×"), false));
        }
    }
    let y = Axis::linear("Variance [%]").showing(Some(SHARE_RANGE));
    Panel::new(axis(), y)
        .with_all(stack)
        .with_all(ratios)
        .with_all(missing)
}

fn note(x: f64, y: f64, text: String, upright: bool) -> Note {
    Note {
        at: Place::Value { x, y, upright },
        text,
    }
}

/// Plots standard deviations of `ln k_o k_i` in percent: the scatter, its expected value, and the
/// unexplained part with its interval at the confidence level `level`.
fn deviations_panel(scatter: &PairScatter, level: f64) -> Panel {
    let mut total = empty_dots("scatter", DotShape::Circle, Color::INK);
    let mut expected = empty_dots("expected", DotShape::Diamond, Color::new(Hue::Perturbed));
    expected.filled = false;
    let mut unexplained = empty_dots("unexplained", DotShape::Square, Color::new(Hue::Nominal));
    let mut ends = Vec::new();
    let mut most = 0.0;
    for PlacedSplit { x, split } in placed_splits(scatter) {
        let Some(split) = split else {
            continue;
        };
        total = total.dot(x - APART, percent(split.scatter), "");
        expected = expected.dot(x, percent(split.explained()), "");
        unexplained = unexplained.dot(x + APART, percent(split.unexplained()), "");
        if let Some([low, high]) = split.unexplained_interval(level) {
            ends.push([x + APART, 100.0 * low, 100.0 * high]);
        }
        most = f64::max(most, MOST_SHOWN * percent(split.scatter));
    }
    let mut y = Axis::linear("Scatter [%]").including(0.0).at_least(1.0);
    for [_, _, high] in &ends {
        y = y.including(high.min(most));
    }
    let mut panel = Panel::new(axis(), y);
    if !ends.is_empty() {
        panel = panel.with(Intervals {
            name: format!("unexplained, {:.0} % interval", 100.0 * level),
            stroke: INTERVAL,
            ends,
        });
    }
    panel.with_all([total, expected, unexplained])
}

fn empty_dots(name: &str, shape: DotShape, color: Color) -> Dots {
    Dots::new(name, shape, color).key(name)
}

/// Converts a variance in `ln k_o k_i` to a standard deviation \[%\].
fn percent(variance: f64) -> f64 {
    100.0 * variance.sqrt()
}

/// Summarises the differences at equal airspeed, explains the plot, and describes the schedule and
/// the settings.
fn caption(analysis: &Analysis, uncertainty: &Uncertainty) -> String {
    let settings = &analysis.study.settings;
    format!(
        "{} Scatter of ln(k_o k_i) about the mean at each airspeed, and about the schedule ({}): \
        shares of the variance, and standard deviations. Trim and identification: expected from \
        the bundles; unexplained: the remainder. Above the bars: ratio of the scatter to its \
        expected value. {}",
        differences_summary(uncertainty),
        used_schedule_words(analysis),
        settings_words(&analysis.study.dataset, settings)
    )
}
