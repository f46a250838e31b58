//! Gains and delays against airspeed or over conditions (Figures 3, 4, 6 and 7).

use std::collections::BTreeSet;

use gdcm_method::correction::{Channel, ChannelCorrection};
use gdcm_method::schedule::Schedule;
use gdcm_method::uncertainty::{BandWidths, Bar, Scalar};
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::{Dataset, Pair};
use gdcm_model::number_format::decimals;
use gdcm_model::units::s_to_ms;
use gdcm_study::decisions::choices::ConditionChoice;
use gdcm_study::results::uncertainty::{AirspeedDifference, Uncertainty};
use gdcm_study::{Analysis, ConditionAnalysis};

use super::axis::{Axis, Range};
use super::condition_source::{schedule_words, settings_words};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{
    Bracket, Brackets, Curve, Dot, DotShape, Dots, Envelope, Figure, Intervals, Mark, MarkId,
    Panel, Plot, Rule, Spans,
};
use super::role::Role;

/// Samples of a schedule between its ends.
const SAMPLES: usize = 120;
const NULL: Stroke = Stroke::dashed(Color::DIM, 0.6, Dash::Short);
/// Line of a bar, and of the identification part in it.
const BAR: Stroke = Stroke::solid(Color::of(Hue::Perturbed), 0.6);
const INNER_BAR: Stroke = Stroke::solid(Color::of(Hue::Perturbed).tint(50), 2.4);
/// Maximum extension of the range of the dots by bars, as a fraction of it.
const OF_BARS: f64 = 0.5;
/// Brackets of differences at the same airspeed.
const BRACKET_BEYOND: Stroke = Stroke::solid(Color::of(Hue::Warning), 0.7);
const BRACKET_WITHIN: Stroke = Stroke::solid(Color::DIM, 0.4);
const BEYOND: &str = "significant difference, × expected";
const WITHIN: &str = "difference, not significant";
/// Height of a plot as a fraction of its width, without and with bars and brackets.
const ASPECTS: [f64; 2] = [0.95, 1.3];
/// Background of the bounds.
const BOUNDS: Color = Color::of(Hue::Accent).tint(16);
/// Width of that background over airspeed \[kt\], and over conditions.
const BOUNDS_WIDTHS: [f64; 2] = [3.0, 0.7];

/// Quantity of the dots of a panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// A gain (ratio); no correction is 1.
    #[default]
    Gain,
    /// A delay \[ms\]; no correction is 0.
    Delay,
}

impl Measure {
    /// Formats a value with its unit.
    pub fn text(self, value: f64) -> String {
        match self {
            Self::Gain => decimals(value, 3),
            Self::Delay => format!("{} ms", decimals(value, 1)),
        }
    }

    /// Returns the value without correction.
    pub fn null(self) -> f64 {
        match self {
            Self::Gain => 1.0,
            Self::Delay => 0.0,
        }
    }

    /// Returns the least height of a plot, in the unit of the measure.
    pub fn least_height(self) -> f64 {
        match self {
            Self::Gain => 0.1,
            Self::Delay => 10.0,
        }
    }

    /// Returns the schedule, if it has values of this measure over this axis.
    pub fn schedule_of(self, analysis: &Analysis, across: Across) -> Option<&Schedule> {
        let has_values = |schedule: &&Schedule| self == Self::Gain || schedule.has_delays();
        analysis
            .schedule
            .as_ref()
            .ok()
            .filter(|_| across == Across::Airspeed)
            .filter(has_values)
    }

    /// Returns the axis label for values of a channel.
    pub fn axis_label(self) -> &'static str {
        match self {
            Self::Gain => "Gain [-]",
            Self::Delay => "Delay [ms]",
        }
    }
}

/// Quantity on the horizontal axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Across {
    /// True airspeed \[kt\].
    #[default]
    Airspeed,
    /// Conditions in file order, at the places 0, 1, 2, …
    Conditions,
}

/// The altitude class drawn as circles and the weight class drawn filled ("low", or the first of
/// the names), followed by the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Classes {
    /// The altitude classes, starting with the class drawn as circles.
    pub altitudes: Vec<String>,
    /// The weight classes, starting with the class drawn filled.
    pub weights: Vec<String>,
}

impl Classes {
    /// Collects the classes of a dataset.
    pub fn of(dataset: &Dataset) -> Self {
        let names = |class: fn(&FlightState) -> &Option<String>| -> Vec<String> {
            let states = dataset
                .conditions()
                .iter()
                .map(|condition| condition.flight_state());
            let names: BTreeSet<String> = states.filter_map(|state| class(state).clone()).collect();
            let mut names: Vec<String> = names.into_iter().collect();
            names.sort_by_key(|name| !["low", "light"].contains(&name.as_str()));
            names
        };
        Self {
            altitudes: names(|state| &state.altitude),
            weights: names(|state| &state.weight),
        }
    }

    /// Returns whether a condition is drawn as a circle.
    pub fn is_first_altitude(&self, state: &FlightState) -> bool {
        state.altitude.as_ref() == self.altitudes.first()
    }

    /// Returns whether a condition is drawn filled.
    pub fn is_first_weight(&self, state: &FlightState) -> bool {
        state.weight.as_ref() == self.weights.first()
    }
}

/// Plots the net gain of each of `pairs` at the optimum of each condition, and the schedule
/// (Figures 6 and 7); with confidence intervals and bands if `uncertainty` has them.
pub fn net_gain_figure(
    analysis: &Analysis,
    uncertainty: Option<&Uncertainty>,
    pairs: &[Pair],
) -> Figure {
    let plots = pairs.iter().map(|&pair| {
        let panel = GainQuantity::NetGain(pair).panel(
            analysis,
            uncertainty,
            Across::Airspeed,
            "Net gain [-]",
        );
        Plot::new(analysis.study.dataset.pair_name(pair)).panel(panel)
    });
    let figure = Figure::new("Net gains against airspeed").caption(caption(
        analysis,
        Across::Airspeed,
        Measure::Gain,
    ));
    figure
        .plots(plots)
        .columns(5)
        .shared_x()
        .shared_y()
        .aspect(ASPECTS[usize::from(uncertainty.is_some())])
}

/// Overlays the optima and the schedule of a variant on plots of these quantities, behind the main
/// marks: small open dots, dotted lines.
pub fn add_variant(
    figure: &mut Figure,
    quantities: &[GainQuantity],
    analysis: &Analysis,
    name: &str,
) {
    let role = Role::Variant.stroke(false);
    let across = Across::Airspeed;
    let key = format!("variant {name}");
    for (panel, quantity) in figure
        .plots
        .iter_mut()
        .flat_map(|plot| plot.panels.first_mut())
        .zip(quantities)
    {
        let schedule = quantity.measure().schedule_of(analysis, across);
        let curve = schedule.map(|schedule| {
            Curve::through(
                format!("schedule of {key}"),
                role,
                quantity.samples(schedule),
            )
            .into()
        });
        let of =
            places(analysis, across).map(|(x, _, result)| (x, quantity.of(&result.correction)));
        let empty = Dots {
            size: 0.7,
            ..Dots::new(&key, DotShape::Square, role.color)
                .filled(false)
                .key(&key)
        };
        let dots = Mark::Dots(of.fold(empty, |dots, (x, y)| dots.dot(x, y, "")));
        let behind = panel
            .marks
            .iter()
            .position(|mark| matches!(mark, Mark::Dots(_)))
            .unwrap_or(panel.marks.len());
        panel
            .marks
            .splice(behind..behind, curve.into_iter().chain([dots]));
    }
}

/// Keeps in plots of net gain only the number of the condition `selected`, and if differences are
/// shown, those of significantly different pairs with their brackets; on the screen, the others
/// appear under the pointer.
pub fn quieten(figure: &mut Figure, selected: &MarkId, shows_differences: bool) {
    for panel in figure.plots.iter_mut().flat_map(|plot| &mut plot.panels) {
        panel.marks.retain(|mark| match mark {
            Mark::Brackets(brackets) => shows_differences && brackets.name == BEYOND,
            _ => true,
        });
        let differ: Vec<[f64; 2]> = panel
            .marks
            .iter()
            .filter_map(|mark| {
                if let Mark::Brackets(brackets) = mark {
                    Some(&brackets.brackets)
                } else {
                    None
                }
            })
            .flat_map(|brackets| {
                brackets
                    .iter()
                    .flat_map(|of| of.ends.map(|end| [of.x, end]))
            })
            .collect();
        let dots = panel.marks.iter_mut().filter_map(|mark| {
            if let Mark::Dots(dots) = mark {
                Some(dots)
            } else {
                None
            }
        });
        for dot in dots.flat_map(|dots| &mut dots.dots) {
            if dot.id.as_ref() != Some(selected) && !differ.contains(&[dot.x, dot.y]) {
                dot.label.clear();
            }
        }
    }
}

/// Plots gain or delay of each of `channels` at the optimum of each condition, and the schedule
/// (Figures 3 and 4).
pub fn channels_figure(
    analysis: &Analysis,
    uncertainty: Option<&Uncertainty>,
    channels: &[Channel],
    (measure, across): (Measure, Across),
) -> Figure {
    let (inputs, outputs) = analysis.study.dataset.names_of_channels();
    let plots = channels.iter().map(|&channel| {
        let quantity = GainQuantity::of_channel(channel, measure);
        let panel = quantity.panel(analysis, uncertainty, across, measure.axis_label());
        Plot::new(channel.name(&inputs, &outputs)).panel(panel)
    });
    let title = match measure {
        Measure::Gain => "Channel gains",
        Measure::Delay => "Channel delays",
    };
    let figure = Figure::new(title)
        .caption(caption(analysis, across, measure))
        .plots(plots);
    figure
        .columns(6)
        .shared_x()
        .shared_y()
        .aspect(ASPECTS[usize::from(uncertainty.is_some())])
}

/// Returns all channels, inputs first.
pub fn all_channels(dataset: &Dataset) -> Vec<Channel> {
    let inputs = (0..dataset.inputs().len()).map(Channel::Input);
    inputs
        .chain((0..dataset.outputs().len()).map(Channel::Output))
        .collect()
}

fn caption(analysis: &Analysis, across: Across, measure: Measure) -> String {
    let study = &analysis.study;
    let mut caption = settings_words(&study.dataset, &study.settings);
    if measure.schedule_of(analysis, across).is_some() {
        caption.push_str(&format!(
            " Schedule: {}.",
            schedule_words(&study.settings.schedule)
        ));
    }
    if across == Across::Airspeed {
        caption.push_str(" Numbers are those of the conditions.");
    }
    caption.push_str(" Dashed: no correction.");
    caption
}

/// A quantity of the correction of each condition and of the schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GainQuantity {
    /// Net gain of a response.
    NetGain(Pair),
    /// Gain of a channel.
    Gain(Channel),
    /// Delay of a channel.
    Delay(Channel),
}

impl GainQuantity {
    /// Creates the gain or delay of a channel.
    pub fn of_channel(channel: Channel, measure: Measure) -> Self {
        match measure {
            Measure::Gain => Self::Gain(channel),
            Measure::Delay => Self::Delay(channel),
        }
    }

    /// Returns its measure.
    pub fn measure(self) -> Measure {
        if matches!(self, Self::Delay(_)) {
            Measure::Delay
        } else {
            Measure::Gain
        }
    }

    /// Returns its value in a correction, in the unit of the measure.
    pub fn of(self, correction: &ChannelCorrection) -> f64 {
        match self {
            Self::NetGain(pair) => correction.net_gain(pair),
            Self::Gain(channel) => correction.gain(channel),
            Self::Delay(channel) => s_to_ms(correction.delay_s(channel)),
        }
    }

    /// Returns the corresponding scalar of the uncertainty analysis.
    pub fn scalar(self) -> Scalar {
        match self {
            Self::NetGain(pair) => Scalar::NetGain(pair),
            Self::Gain(channel) => Scalar::ChannelGain(channel),
            Self::Delay(channel) => Scalar::ChannelDelay(channel),
        }
    }

    /// Returns the search bounds of the optimum of a condition; `None` for a net gain, which has no
    /// bounds of its own.
    pub fn bounds(self, result: &ConditionAnalysis) -> Option<[f64; 2]> {
        match self {
            Self::NetGain(_) => None,
            Self::Gain(_) => Some([result.gain_bounds().lower, result.gain_bounds().upper]),
            Self::Delay(_) => Some(result.delay_bounds_s().map(s_to_ms)),
        }
    }

    fn panel(
        self,
        analysis: &Analysis,
        uncertainty: Option<&Uncertainty>,
        across: Across,
        label: &str,
    ) -> Panel {
        let conditions = analysis.study.dataset.conditions();
        let x = match across {
            Across::Airspeed => Axis::linear("Airspeed [kt]").at_least(10.0),
            Across::Conditions => Axis::named(
                "Condition",
                conditions
                    .iter()
                    .map(|condition| condition.id().to_string()),
            ),
        };
        let bars = uncertainty
            .map(|of| self.bars(analysis, of, across))
            .unwrap_or_default();
        let brackets = uncertainty
            .map(|of| self.brackets(analysis, of, across))
            .unwrap_or_default();
        let y = self.value_axis(analysis, &bars, label);
        let schedule = self.measure().schedule_of(analysis, across);
        let samples: Vec<[f64; 2]> = schedule
            .map(|schedule| self.samples(schedule))
            .unwrap_or_default();
        let bands = schedule.zip(uncertainty.and_then(|of| of.bands.as_ref()));
        let bands = bands.map(|(schedule, bands)| {
            self.bands(&samples, |at| bands.at(schedule, self.scalar(), at))
        });
        let curve = schedule.map(|_| {
            Curve::through("schedule", Role::Scheduled.stroke(false), samples).key("schedule")
        });
        let panel = Panel::new(x, y).with_all(self.spans(analysis, across));
        let panel = panel
            .with(Rule::horizontal(self.measure().null(), NULL))
            .with_all(bands.into_iter().flatten());
        let panel = panel.with_all(curve).with_all(bars).with_all(brackets);
        panel.with_all(self.dots(analysis, across))
    }

    /// Samples the scheduled quantity from the lowest to the highest airspeed of the conditions:
    /// airspeed \[kt\] and value.
    fn samples(self, schedule: &Schedule) -> Vec<[f64; 2]> {
        let from = schedule.airspeeds.min_kt;
        let to = schedule.airspeeds.max_kt;
        let airspeed = |sample: usize| from + (to - from) * sample as f64 / SAMPLES as f64;
        (0..=SAMPLES)
            .map(airspeed)
            .map(|at| [at, self.of(&schedule.at(at))])
            .collect()
    }

    /// Returns the bar of each condition with one: thin for the unknown trim, thick for the model
    /// choice (M13).
    fn bars(
        self,
        analysis: &Analysis,
        uncertainty: &Uncertainty,
        across: Across,
    ) -> Vec<Intervals> {
        let told = |end: f64| {
            if self.scalar().is_delay() {
                s_to_ms(end)
            } else {
                end.exp()
            }
        };
        let ends = |of: &dyn Fn(&Bar) -> Option<[f64; 2]>| -> Vec<[f64; 3]> {
            let bar = |(x, state, _): (f64, &FlightState, &ConditionAnalysis)| {
                let [low, high] = of(uncertainty.bar(state.id, self.scalar())?)?.map(told);
                Some([x, low, high])
            };
            places(analysis, across).filter_map(bar).collect()
        };
        let level = uncertainty.level;
        let whole = format!("bar of {:.0} %", 100.0 * level);
        let inner = ends(&|bar| bar.inner_interval(level));
        let inner = Intervals {
            name: "identification in it".to_owned(),
            stroke: INNER_BAR,
            ends: inner,
        };
        let outer = Intervals {
            name: whole,
            stroke: BAR,
            ends: ends(&|bar| bar.interval(level)),
        };
        [outer, inner]
            .into_iter()
            .filter(|bars| !bars.ends.is_empty())
            .collect()
    }

    /// Returns, for each airspeed, the difference with the largest ratio to its expected value
    /// (M13.4).
    fn brackets(
        self,
        analysis: &Analysis,
        uncertainty: &Uncertainty,
        across: Across,
    ) -> Vec<Brackets> {
        let (Self::NetGain(pair), Across::Airspeed) = (self, across) else {
            return Vec::new();
        };
        let level = uncertainty.level;
        let of = |beyond: bool| {
            let found = uncertainty.greatest_differences(pair).into_iter();
            let bracket = |difference: &AirspeedDifference| {
                let value = |id| Some(self.of(&analysis.condition(id)?.correction));
                let [one, other] = difference.conditions.map(value);
                let label = difference
                    .difference
                    .ratio()
                    .filter(|_| beyond)
                    .map(|ratio| format!("{ratio:.1}×"));
                Some(Bracket {
                    x: difference.airspeed_kt,
                    ends: [one?, other?],
                    label: label.unwrap_or_default(),
                })
            };
            found
                .filter(|of| of.is_significant(level) == beyond)
                .filter_map(bracket)
                .collect::<Vec<Bracket>>()
        };
        let within = Brackets {
            name: WITHIN.to_owned(),
            stroke: BRACKET_WITHIN,
            brackets: of(false),
        };
        let beyond = Brackets {
            name: BEYOND.to_owned(),
            stroke: BRACKET_BEYOND,
            brackets: of(true),
        };
        [beyond, within]
            .into_iter()
            .filter(|brackets| !brackets.brackets.is_empty())
            .collect()
    }

    /// Returns the value axis; bars extend it only as far as the dots keep their room.
    fn value_axis(self, analysis: &Analysis, bars: &[Intervals], label: &str) -> Axis {
        let axis = Axis::linear(label)
            .including(self.measure().null())
            .at_least(self.measure().least_height());
        let values =
            places(analysis, Across::Airspeed).map(|(.., result)| self.of(&result.correction));
        let Some(range) = Range::of(values) else {
            return axis;
        };
        let spare = OF_BARS * range.width();
        let ends = bars
            .iter()
            .flat_map(|bars| &bars.ends)
            .flat_map(|[_, low, high]| [low, high]);
        ends.fold(axis, |axis, end| {
            axis.including(end.clamp(range.min - spare, range.max + spare))
        })
    }

    /// Builds both bands about the samples of the schedule, with half-widths from `widths` at an
    /// airspeed \[kt\].
    fn bands(
        self,
        samples: &[[f64; 2]],
        widths: impl Fn(f64) -> Option<BandWidths>,
    ) -> Vec<Envelope> {
        let widths: Vec<_> = samples
            .iter()
            .filter_map(|[x, value]| Some((*x, *value, widths(*x)?)))
            .collect();
        let color = Role::Scheduled.stroke(false).color;
        let of = |name: &str, dash: Dash, percent: u8, half: fn(&BandWidths) -> f64| {
            let end = |(x, value, widths): &(f64, f64, BandWidths)| {
                [
                    *x,
                    value * (-half(widths)).exp(),
                    value * half(widths).exp(),
                ]
            };
            let name = name.to_owned();
            let points = widths.iter().map(end).collect();
            let edge = Some(Stroke::dashed(color, 0.6, dash));
            Envelope {
                name,
                color: color.tint(percent),
                edge,
                points,
            }
        };
        let confidence = of("confidence band", Dash::Long, 22, |widths| {
            widths.confidence
        });
        let scatter = of("scatter band", Dash::Dotted, 13, |widths| widths.scatter);
        if widths.is_empty() {
            Vec::new()
        } else {
            vec![confidence, scatter]
        }
    }

    /// Returns the search range of each optimum.
    fn spans(self, analysis: &Analysis, across: Across) -> Option<Spans> {
        let width = match across {
            Across::Airspeed => BOUNDS_WIDTHS[0],
            Across::Conditions => BOUNDS_WIDTHS[1],
        };
        let span = |(x, _, result): (f64, &FlightState, &ConditionAnalysis)| {
            let [lower, upper] = self.bounds(result)?;
            Some([x, lower, upper])
        };
        let spans: Vec<[f64; 3]> = places(analysis, across).filter_map(span).collect();
        (!spans.is_empty()).then(|| Spans {
            name: "bounds".to_owned(),
            color: BOUNDS,
            width,
            spans,
        })
    }

    /// Returns a group of dots for each class of conditions, and a group for those not in the
    /// schedule.
    fn dots(self, analysis: &Analysis, across: Across) -> Vec<Dots> {
        let classes = Classes::of(&analysis.study.dataset);
        let mut groups: Vec<Dots> = Vec::new();
        for (x, state, result) in places(analysis, across) {
            let choice = analysis.study.choice(state.id);
            let chosen = choice.is_in_schedule();
            let name = class_words(state, choice);
            // Over conditions the axis shows their numbers.
            let label = if across == Across::Airspeed {
                state.id.to_string()
            } else {
                String::new()
            };
            let dot = Dot {
                x,
                y: self.of(&result.correction),
                label,
                id: Some(MarkId::Condition(state.id)),
            };
            match groups.iter_mut().find(|group| group.name == name) {
                Some(group) => group.dots.push(dot),
                None => {
                    let shape = if classes.is_first_altitude(state) {
                        DotShape::Circle
                    } else {
                        DotShape::Diamond
                    };
                    let color = Color::of(if chosen {
                        Hue::Perturbed
                    } else {
                        Hue::Rejected
                    });
                    let group = Dots::new(&name, shape, color)
                        .filled(classes.is_first_weight(state) && !choice.held_out)
                        .key(&name);
                    groups.push(Dots {
                        dots: vec![dot],
                        ..group
                    });
                }
            }
        }
        groups.sort_by_key(|group| (group.shape, !group.filled));
        groups
    }
}

/// Returns each condition with a result: its place on the horizontal axis, its state, its result.
fn places(
    analysis: &Analysis,
    across: Across,
) -> impl Iterator<Item = (f64, &FlightState, &ConditionAnalysis)> {
    let conditions = analysis.study.dataset.conditions().iter().enumerate();
    conditions.filter_map(move |(index, condition)| {
        let state = condition.flight_state();
        let x = match across {
            Across::Airspeed => state.airspeed_kt,
            Across::Conditions => index as f64,
        };
        Some((x, state, analysis.condition(condition.id())?))
    })
}

/// Returns `low altitude` and `high weight`, if a condition has these classes.
pub fn class_names(state: &FlightState) -> [Option<String>; 2] {
    let class =
        |name: &Option<String>, what: &str| name.as_ref().map(|name| format!("{name} {what}"));
    [
        class(&state.altitude, "altitude"),
        class(&state.weight, "weight"),
    ]
}

/// Returns `low altitude, high weight`; `optimum` for a condition without classes.
fn class_words(state: &FlightState, choice: &ConditionChoice) -> String {
    let mut words: Vec<String> = class_names(state).into_iter().flatten().collect();
    if words.is_empty() {
        words.push("optimum".to_owned());
    }
    if choice.held_out {
        words.push("held out".to_owned());
    } else if !choice.scheduled {
        words.push("not in the schedule".to_owned());
    }
    words.join(", ")
}
