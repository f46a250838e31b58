//! Changes to gain figures for the window: overlays of a variant and of the previous results, room
//! for error bars, and labels of the selected condition alone.
//!
//! A condition's *optimum* is its own correction, to which the schedule over airspeed is fitted. A
//! *variant* is the study with other decisions, kept under a name.

use gdcm_study::results::analysis::Analysis;

use super::axis::Range;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel};
use super::gain_panel::SIGNIFICANT;
use super::gain_quantity::{Across, GainQuantity, placed_results};
use super::marks::{Along, Curve, DotShape, Dots, Mark, MarkId};
use super::role::Role;

/// Dot size for an overlaid variant, relative to the usual dot.
const VARIANT_DOT: f64 = 0.7;
/// Colour of optima and schedule from before the settings changed.
const PREVIOUS: Color = Color::new(Hue::Rejected);
/// Size of the previous optima, relative to the usual dot.
const PREVIOUS_DOT: f64 = 0.5;
/// Share of the dots' range that is reserved for error bars above and below it.
const ROOM_FOR_BARS: f64 = 0.3;

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
        // `GainPanel` includes the value without correction first, and then the ends of error bars.
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
