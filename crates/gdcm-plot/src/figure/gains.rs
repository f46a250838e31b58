//! Gains and delays against airspeed or over conditions (Figures 3, 4, 6 and 7).
//!
//! A condition's *optimum* is its own correction, to which the schedule over airspeed is fitted;
//! the *net gain* of a response is the product of its channels' gains. A *variant* is the study
//! with other decisions, kept under a name.

use gdcm_method::correction::Channel;
use gdcm_model::dataset::{Dataset, Pair};
use gdcm_study::results::analysis::Analysis;
use gdcm_study::results::uncertainty::Uncertainty;

pub use super::condition_classes::{Classes, class_names};
pub use super::gain_quantity::{Across, GainAxes, GainQuantity, Measure};

use super::axis::Range;
use super::condition_source::{settings_words, used_schedule_words};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::gain_panel::{GainPanel, SIGNIFICANT};
use super::gain_quantity::placed_results;
use super::marks::{Along, Curve, DotShape, Dots, Mark, MarkId};
use super::role::Role;

/// Ratio of plot height to width without error bars.
const ASPECT: f64 = 0.95;
/// Ratio of plot height to width with error bars, which need more height.
const ASPECT_WITH_BARS: f64 = 1.3;
/// Dot size for an overlaid variant, relative to the usual dot.
const VARIANT_DOT: f64 = 0.7;
/// Colour of optima and schedule from before the settings changed.
const PREVIOUS: Color = Color::new(Hue::Rejected);
/// Size of the previous optima, relative to the usual dot.
const PREVIOUS_DOT: f64 = 0.5;

/// Plots each pair's net gain at every condition's optimum, and the schedule (Figures 6 and 7);
/// with error bars and bands if `uncertainty` contains them.
pub fn net_gain_figure(
    analysis: &Analysis,
    uncertainty: Option<&Uncertainty>,
    pairs: &[Pair],
) -> Figure {
    let across = Across::Airspeed;
    let mut plots = Vec::new();
    for &pair in pairs {
        let contents = GainPanel {
            quantity: GainQuantity::NetGain(pair),
            analysis,
            uncertainty,
            across,
        };
        let title = analysis.study.dataset.pair_name(pair);
        plots.push(Plot::new(title).panel(contents.panel("Net gain [-]")));
    }
    Figure::new("Net gains against airspeed")
        .caption(caption(analysis, across, Measure::Gain))
        .plots(plots)
        .columns(5)
        .shared_x()
        .shared_y()
        .aspect(aspect(uncertainty))
}

/// Plots each channel's gain or delay at every condition's optimum and, against airspeed, the
/// schedule (Figures 3 and 4); with error bars and bands if `uncertainty` contains them.
pub fn channels_figure(
    analysis: &Analysis,
    uncertainty: Option<&Uncertainty>,
    channels: &[Channel],
    axes: GainAxes,
) -> Figure {
    let GainAxes { measure, across } = axes;
    let (inputs, outputs) = analysis.study.dataset.input_and_output_names();
    let mut plots = Vec::new();
    for &channel in channels {
        let contents = GainPanel {
            quantity: GainQuantity::of_channel(channel, measure),
            analysis,
            uncertainty,
            across,
        };
        let title = channel.name(&inputs, &outputs);
        plots.push(Plot::new(title).panel(contents.panel(measure.axis_label())));
    }
    let title = match measure {
        Measure::Gain => "Channel gains",
        Measure::Delay => "Channel delays",
    };
    Figure::new(title)
        .caption(caption(analysis, across, measure))
        .plots(plots)
        .columns(6)
        .shared_x()
        .shared_y()
        .aspect(aspect(uncertainty))
}

fn aspect(uncertainty: Option<&Uncertainty>) -> f64 {
    match uncertainty {
        Some(_) => ASPECT_WITH_BARS,
        None => ASPECT,
    }
}

fn caption(analysis: &Analysis, across: Across, measure: Measure) -> String {
    let study = &analysis.study;
    let mut caption = settings_words(&study.dataset, &study.settings);
    if measure.schedule_of(analysis, across).is_some() {
        let schedule = used_schedule_words(analysis);
        caption.push_str(&format!(" Schedule: {schedule}."));
    }
    if across == Across::Airspeed {
        caption.push_str(" Numbers identify the conditions.");
    }
    caption.push_str(" Dashed: no correction.");
    caption
}

/// Returns all channels, inputs first.
pub fn all_channels(dataset: &Dataset) -> Vec<Channel> {
    let inputs = (0..dataset.inputs().len()).map(Channel::Input);
    let outputs = (0..dataset.outputs().len()).map(Channel::Output);
    inputs.chain(outputs).collect()
}

/// Overlays a variant's optima and schedule on plots against airspeed: small open dots behind the
/// existing dots, and a dotted line. `quantities` contains each plot's quantity, in order.
pub fn add_variant(
    figure: &mut Figure,
    quantities: &[GainQuantity],
    analysis: &Analysis,
    name: &str,
) {
    let panels = figure
        .plots
        .iter_mut()
        .flat_map(|plot| plot.panels.first_mut());
    for (panel, quantity) in panels.zip(quantities) {
        put_behind_dots(panel, variant_marks(*quantity, analysis, name));
    }
}

/// Adds the optima and the schedule from before the settings changed to plots against airspeed, in
/// grey behind the existing schedule and dots. `quantities` contains each plot's quantity, in
/// order.
pub fn add_previous(figure: &mut Figure, quantities: &[GainQuantity], analysis: &Analysis) {
    let panels = figure
        .plots
        .iter_mut()
        .flat_map(|plot| plot.panels.first_mut());
    for (panel, quantity) in panels.zip(quantities) {
        let marks = previous_marks(*quantity, analysis);
        let first_curve = panel
            .marks
            .iter()
            .position(|mark| matches!(mark, Mark::Curve(_) | Mark::Dots(_)))
            .unwrap_or(panel.marks.len());
        panel.marks.splice(first_curve..first_curve, marks);
    }
}

/// Inserts marks before a panel's first dots, so that the dots cover them.
fn put_behind_dots(panel: &mut Panel, marks: Vec<Mark>) {
    let first_dots = panel
        .marks
        .iter()
        .position(|mark| matches!(mark, Mark::Dots(_)))
        .unwrap_or(panel.marks.len());
    panel.marks.splice(first_dots..first_dots, marks);
}

/// Returns the optima and the schedule, if any, from before the settings changed, as marks.
fn previous_marks(quantity: GainQuantity, analysis: &Analysis) -> Vec<Mark> {
    let across = Across::Airspeed;
    let mut marks = Vec::new();
    if let Some(schedule) = quantity.measure().schedule_of(analysis, across) {
        let samples = quantity.samples(schedule);
        let stroke = Stroke::dashed(PREVIOUS, 0.9, Dash::Long);
        marks.push(Curve::through("previous schedule", stroke, samples).into());
    }
    let mut dots = Dots::new("previous", DotShape::Circle, PREVIOUS);
    dots.size = PREVIOUS_DOT;
    for placed in placed_results(analysis, across) {
        dots = dots.dot(placed.x, quantity.value_in(&placed.result.correction), "");
    }
    marks.push(Mark::Dots(dots));
    marks
}

/// Returns a variant's schedule, if any, and its optima, as marks.
fn variant_marks(quantity: GainQuantity, analysis: &Analysis, name: &str) -> Vec<Mark> {
    let across = Across::Airspeed;
    let stroke = Role::Variant.stroke(false);
    let key = format!("variant {name}");
    let mut marks = Vec::new();
    if let Some(schedule) = quantity.measure().schedule_of(analysis, across) {
        let samples = quantity.samples(schedule);
        let curve = Curve::through(format!("schedule of {key}"), stroke, samples);
        marks.push(Mark::Curve(curve));
    }
    let mut dots = Dots::new(&key, DotShape::Square, stroke.color)
        .filled(false)
        .key(&key);
    dots.size = VARIANT_DOT;
    for placed in placed_results(analysis, across) {
        let y = quantity.value_in(&placed.result.correction);
        dots = dots.dot(placed.x, y, "");
    }
    marks.push(Mark::Dots(dots));
    marks
}

/// Share of the dots' range that is reserved for error bars above and below it.
const ROOM_FOR_BARS: f64 = 0.3;

/// Sets value ranges that do not depend on the error bars, for the screen, where the bars appear
/// later than the dots and must not move them. Longer bars end at the frame.
pub fn reserve_room_for_bars(figure: &mut Figure) {
    for panel in figure.plots.iter_mut().flat_map(|plot| &mut plot.panels) {
        let mut values = Vec::new();
        for mark in &panel.marks {
            if matches!(mark, Mark::Curve(_) | Mark::Dots(_)) {
                values.extend(mark.values(Along::Y));
            }
        }
        // The first value to be included is that without correction; the others are bar ends.
        values.extend(panel.y.including.first());
        if let Some(range) = Range::spanning(values) {
            panel.y.range = Some(range.with_margin(ROOM_FOR_BARS, panel.y.least));
        }
    }
}

/// Removes labels and brackets from net-gain plots for the screen, where labels appear under the
/// pointer. The label for the condition `selected`, whose dot has a ring, remains; if
/// `shows_differences` is set, so do the brackets at significant differences with the labels on the
/// dots at their ends.
pub fn label_selected_only(figure: &mut Figure, selected: &MarkId, shows_differences: bool) {
    for panel in figure.plots.iter_mut().flat_map(|plot| &mut plot.panels) {
        panel.marks.retain(|mark| match mark {
            Mark::Brackets(brackets) => shows_differences && brackets.name == SIGNIFICANT,
            _ => true,
        });
        let ends = bracket_ends(panel);
        for mark in &mut panel.marks {
            let Mark::Dots(group) = mark else {
                continue;
            };
            group.ringed = Some(selected.clone());
            for dot in &mut group.dots {
                if dot.id.as_ref() != Some(selected) && !ends.contains(&[dot.x, dot.y]) {
                    dot.label.clear();
                }
            }
        }
    }
}

/// Returns `[x, y]` at both ends of every bracket.
fn bracket_ends(panel: &Panel) -> Vec<[f64; 2]> {
    let mut ends = Vec::new();
    for mark in &panel.marks {
        if let Mark::Brackets(group) = mark {
            for bracket in &group.brackets {
                ends.extend(bracket.ends.map(|end| [bracket.x, end]));
            }
        }
    }
    ends
}
