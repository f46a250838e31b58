//! Panel for a gain or a delay: the optima in all conditions with their bounds, error bars and
//! differences, and the schedule with its bands.
//!
//! A condition's *optimum* is its own correction; the search for it has *bounds* (M7). The *net
//! gain* of a response is the product of its channels' gains. The confidence band is where the
//! schedule may lie, the scatter band where another condition would fall (M13.6).

use gdcm_method::schedule::Schedule;
use gdcm_method::uncertainty::{BandWidths, Bar};
use gdcm_model::dataset::Pair;
use gdcm_model::units::s_to_ms;
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::uncertainty::{AirspeedDifference, Uncertainty};

use super::axis::{Axis, Range};
use super::condition_classes::{Classes, class_words};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::Panel;
use super::gain_quantity::{Across, GainQuantity, PlacedResult, placed_results};
use super::marks::{
    Bracket, Brackets, Curve, Dot, DotShape, Dots, Envelope, Intervals, MarkId, Rule, Spans,
};
use super::role::Role;

/// Line at the value without correction.
const UNCORRECTED: Stroke = Stroke::dashed(Color::DIM, 0.6, Dash::Short);
/// Error bar.
const BAR: Stroke = Stroke::solid(Color::new(Hue::Perturbed), 0.6);
/// Part of the error bar due to identification alone.
const INNER_BAR: Stroke = Stroke::solid(Color::new(Hue::Perturbed).tint(50), 2.4);
/// Maximum extension of the axis at either end to show error bars, relative to the range of the
/// dots.
const BARS_EXTENSION: f64 = 0.5;
/// Bracket between net gains at the same airspeed that differ significantly.
const SIGNIFICANT_BRACKET: Stroke = Stroke::solid(Color::new(Hue::Warning), 0.7);
/// Bracket between other net gains at the same airspeed.
const OTHER_BRACKET: Stroke = Stroke::solid(Color::DIM, 0.4);
/// Name for brackets at significant differences, in the legend and in the tables.
pub(super) const SIGNIFICANT: &str = "significant difference (n×: n times the expected one)";
/// Name for the other brackets, in the legend and in the tables.
const NOT_SIGNIFICANT: &str = "difference, not significant";
/// Background that marks the bounds.
const BOUNDS: Color = Color::new(Hue::Accent).tint(16);
/// Width of the bounds' background on an airspeed axis \[kt\].
const BOUNDS_WIDTH_KT: f64 = 3.0;
/// Width of the bounds' background on an axis of conditions, which are 1 apart.
const BOUNDS_WIDTH: f64 = 0.7;

/// A gain or a delay from an analysis, with its uncertainty if available.
pub(super) struct GainPanel<'a> {
    pub(super) quantity: GainQuantity,
    pub(super) analysis: &'a Analysis,
    pub(super) uncertainty: Option<&'a Uncertainty>,
    pub(super) across: Across,
}

impl GainPanel<'_> {
    /// Builds the panel, with `label` on the vertical axis. From the lowest mark to the topmost:
    /// bounds, line without correction, schedule with its bands, error bars, brackets, optima.
    pub(super) fn panel(&self, label: &str) -> Panel {
        let measure = self.quantity.measure();
        let bars = self.bars();
        let y = self.value_axis(&bars, label);
        let mut panel = Panel::new(self.horizontal_axis(), y)
            .with_all(self.bounds())
            .with(Rule::horizontal(measure.uncorrected(), UNCORRECTED));
        if let Some(schedule) = measure.schedule_of(self.analysis, self.across) {
            let samples = self.quantity.samples(schedule);
            let line = Role::Scheduled.stroke(false);
            panel = panel
                .with_all(self.bands(schedule, &samples))
                .with(Curve::through("schedule", line, samples).key("schedule"));
        }
        panel
            .with_all(bars)
            .with_all(self.brackets())
            .with_all(self.dots())
    }

    fn horizontal_axis(&self) -> Axis {
        match self.across {
            Across::Airspeed => Axis::linear("Airspeed [kt]").at_least(10.0),
            Across::Conditions => {
                let conditions = self.analysis.study.dataset.conditions();
                let names = conditions
                    .iter()
                    .map(|condition| condition.id().to_string());
                Axis::named("Condition", names)
            }
        }
    }

    /// Returns the vertical axis. Error bars extend it by a limited amount, so that the dots remain
    /// spread out.
    fn value_axis(&self, bars: &[Intervals], label: &str) -> Axis {
        let measure = self.quantity.measure();
        let mut axis = Axis::linear(label)
            .including(measure.uncorrected())
            .at_least(measure.least_height());
        let values = self
            .results()
            .into_iter()
            .map(|placed| self.quantity.value_in(&placed.result.correction));
        let Some(range) = Range::spanning(values) else {
            return axis;
        };
        let spare = BARS_EXTENSION * range.width();
        for [_, low, high] in bars.iter().flat_map(|bars| &bars.ends) {
            for end in [low, high] {
                axis = axis.including(end.clamp(range.min - spare, range.max + spare));
            }
        }
        axis
    }

    fn results(&self) -> Vec<PlacedResult<'_>> {
        placed_results(self.analysis, self.across)
    }

    /// Returns the error bars (M13): thin for all contributions, thick for identification alone.
    fn bars(&self) -> Vec<Intervals> {
        let Some(uncertainty) = self.uncertainty else {
            return Vec::new();
        };
        let level = uncertainty.level;
        let whole = Intervals {
            name: format!("{:.0} % error bar", 100.0 * level),
            stroke: BAR,
            ends: self.bar_ends(uncertainty, Bar::interval),
        };
        let inner = Intervals {
            name: "identification part of the error bar".to_owned(),
            stroke: INNER_BAR,
            ends: self.bar_ends(uncertainty, Bar::inner_interval),
        };
        let mut bars = vec![whole, inner];
        bars.retain(|bars| !bars.ends.is_empty());
        bars
    }

    /// Returns `[x, lower end, upper end]` for each condition with an error bar, in the measure's
    /// unit.
    fn bar_ends(
        &self,
        uncertainty: &Uncertainty,
        interval: fn(&Bar, f64) -> Option<[f64; 2]>,
    ) -> Vec<[f64; 3]> {
        let scalar = self.quantity.scalar();
        let mut ends = Vec::new();
        for placed in self.results() {
            if let Some(bar) = uncertainty.bar(placed.state.id, scalar)
                && let Some(interval) = interval(bar, uncertainty.level)
            {
                // Intervals of gains are stored as logarithms.
                let [low, high] = interval.map(|end| {
                    if scalar.is_delay() {
                        s_to_ms(end)
                    } else {
                        end.exp()
                    }
                });
                ends.push([placed.x, low, high]);
            }
        }
        ends
    }

    /// Returns a bracket for each airspeed, between the two net gains whose difference is largest
    /// relative to its expected value (M13.4); brackets at significant differences come first.
    /// Empty without error bars, for other quantities than net gains, and on an axis of conditions.
    fn brackets(&self) -> Vec<Brackets> {
        let (Some(uncertainty), GainQuantity::NetGain(pair), Across::Airspeed) =
            (self.uncertainty, self.quantity, self.across)
        else {
            return Vec::new();
        };
        let significant = Brackets {
            name: SIGNIFICANT.to_owned(),
            stroke: SIGNIFICANT_BRACKET,
            brackets: self.brackets_of(uncertainty, pair, true),
        };
        let others = Brackets {
            name: NOT_SIGNIFICANT.to_owned(),
            stroke: OTHER_BRACKET,
            brackets: self.brackets_of(uncertainty, pair, false),
        };
        let mut groups = vec![significant, others];
        groups.retain(|group| !group.brackets.is_empty());
        groups
    }

    /// Returns the brackets at either the significant or the other differences.
    fn brackets_of(
        &self,
        uncertainty: &Uncertainty,
        pair: Pair,
        is_significant: bool,
    ) -> Vec<Bracket> {
        uncertainty
            .greatest_differences(pair)
            .into_iter()
            .filter(|difference| difference.is_significant(uncertainty.level) == is_significant)
            .filter_map(|difference| self.bracket(difference, is_significant))
            .collect()
    }

    /// Returns a bracket at a difference, labelled with its ratio if significant; `None` if a
    /// condition has no result.
    fn bracket(
        &self,
        airspeed_difference: &AirspeedDifference,
        is_significant: bool,
    ) -> Option<Bracket> {
        let [first, second] = airspeed_difference.conditions;
        let first = self.analysis.condition(first)?;
        let second = self.analysis.condition(second)?;
        let label = match airspeed_difference.difference.ratio() {
            Some(ratio) if is_significant => format!("{ratio:.1}×"),
            _ => String::new(),
        };
        Some(Bracket {
            x: airspeed_difference.airspeed_kt,
            ends: [
                self.quantity.value_in(&first.correction),
                self.quantity.value_in(&second.correction),
            ],
            label,
        })
    }

    /// Returns the confidence band and the scatter band about samples `[airspeed, value]` from the
    /// schedule; empty if no bands match the schedule and the quantity. Delays never have bands.
    fn bands(&self, schedule: &Schedule, samples: &[[f64; 2]]) -> Vec<Envelope> {
        let Some(bands) = self
            .uncertainty
            .and_then(|uncertainty| uncertainty.bands.as_ref())
        else {
            return Vec::new();
        };
        let scalar = self.quantity.scalar();
        let mut band_samples = Vec::new();
        for &[x, value] in samples {
            if let Some(widths) = bands.at(schedule, scalar, x) {
                band_samples.push(BandSample { x, value, widths });
            }
        }
        if band_samples.is_empty() {
            return Vec::new();
        }
        let color = Role::Scheduled.stroke(false).color;
        let confidence = Envelope {
            name: "confidence band".to_owned(),
            color: color.tint(22),
            edge: Some(Stroke::dashed(color, 0.6, Dash::Long)),
            points: band_points(&band_samples, |widths| widths.confidence),
        };
        let scatter = Envelope {
            name: "scatter band".to_owned(),
            color: color.tint(13),
            edge: Some(Stroke::dashed(color, 0.6, Dash::Dotted)),
            points: band_points(&band_samples, |widths| widths.scatter),
        };
        vec![confidence, scatter]
    }

    /// Returns the search bounds of each optimum; `None` for a quantity without bounds.
    fn bounds(&self) -> Option<Spans> {
        let mut spans = Vec::new();
        for placed in self.results() {
            if let Some([lower, upper]) = self.quantity.bounds(placed.result) {
                spans.push([placed.x, lower, upper]);
            }
        }
        if spans.is_empty() {
            return None;
        }
        let width = match self.across {
            Across::Airspeed => BOUNDS_WIDTH_KT,
            Across::Conditions => BOUNDS_WIDTH,
        };
        Some(Spans {
            name: "bounds".to_owned(),
            color: BOUNDS,
            width,
            spans,
        })
    }

    /// Returns a group of dots for each condition class; held-out conditions and others outside the
    /// schedule have separate groups.
    fn dots(&self) -> Vec<Dots> {
        let classes = Classes::from_dataset(&self.analysis.study.dataset);
        let mut groups: Vec<Dots> = Vec::new();
        for placed in self.results() {
            let name = class_words(placed.state, self.analysis.study.choice(placed.state.id));
            let dot = self.dot(&placed);
            match groups.iter_mut().find(|group| group.name == name) {
                Some(group) => group.dots.push(dot),
                None => {
                    let mut group = self.empty_group(&placed, &classes, &name);
                    group.dots.push(dot);
                    groups.push(group);
                }
            }
        }
        groups.sort_by_key(|group| (group.shape, !group.filled));
        groups
    }

    /// Returns a condition's optimum as a dot, labelled with the condition number unless the axis
    /// shows it.
    fn dot(&self, placed: &PlacedResult<'_>) -> Dot {
        let id = placed.state.id;
        let label = match self.across {
            Across::Airspeed => id.to_string(),
            Across::Conditions => String::new(),
        };
        Dot {
            x: placed.x,
            y: self.quantity.value_in(&placed.result.correction),
            label,
            id: Some(MarkId::Condition(id)),
        }
    }

    /// Returns an empty group in the dot style for a condition's class.
    fn empty_group(&self, placed: &PlacedResult<'_>, classes: &Classes, name: &str) -> Dots {
        let choice = self.analysis.study.choice(placed.state.id);
        let shape = if classes.is_first_altitude(placed.state) {
            DotShape::Circle
        } else {
            DotShape::Diamond
        };
        let hue = if choice.is_in_schedule() {
            Hue::Perturbed
        } else {
            Hue::Rejected
        };
        Dots::new(name, shape, Color::new(hue))
            .filled(classes.is_first_weight(placed.state) && !choice.held_out)
            .key(name)
    }
}

/// Sample from the schedule, with its bands' half-widths.
struct BandSample {
    x: f64,
    value: f64,
    /// Half-widths in the logarithm of the value.
    widths: BandWidths,
}

/// Returns `[x, lower end, upper end]` of a band at each sample.
fn band_points(samples: &[BandSample], half: fn(&BandWidths) -> f64) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for BandSample { x, value, widths } in samples {
        let half = half(widths);
        points.push([*x, value * (-half).exp(), value * half.exp()]);
    }
    points
}
