//! Effect that couplings have on the loop `I - K H` that they close, and on the poles (M16.4). H is
//! the response of the physics representative, K the feedback from outputs to inputs; near a
//! singular `I - K H` the closed loop rings.

use gdcm_method::couplings::{LoopMargin, PoleShift};
use gdcm_model::dataset::ConditionId;
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_words::couplings::couplings_heading;

use super::axis::{Axis, FrequencyUnit, Range};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::marks::{Curve, Rule, Strip};
use super::pole_shift::{PoleShiftNames, pole_shift_marks};

/// Loop curves for the other conditions.
const OTHERS: Stroke = Stroke::solid(Color::new(Hue::Perturbed).tint(60), 0.7);
/// Loop curve for the condition shown.
const SHOWN: Stroke = Stroke::solid(Color::new(Hue::Corrected), 1.6);
/// Line at the singular value below which the loop is close to ringing.
const RINGING: Stroke = Stroke::dashed(Color::new(Hue::Warning), 1.0, Dash::Short);
/// Background of the comparison band.
const BAND: Color = Color::new(Hue::Accent).tint(12);
/// Imaginary axis in plots of poles.
pub(super) const AXIS: Stroke = Stroke::solid(Color::DIM, 0.6);
/// Magnitude up to which poles are displayed, relative to the band's upper end: poles far above the
/// band would squeeze those within it.
const SHOWN_POLES: f64 = 1.5;

/// Plots the minimum singular value of `I - K H` over frequency for every condition, and the
/// physics representative's poles without and with couplings for the condition `shown`, whose curve
/// is drawn on top. If `shown` is `None` or was not assessed, uses the condition with the smallest
/// [`LoopMargin`]. Returns `None` if there are no conditions.
pub fn couplings_figure(
    assessment: &CouplingsAssessment,
    shown: Option<ConditionId>,
    unit: FrequencyUnit,
) -> Option<Figure> {
    let shown = match shown {
        Some(id) if assessment.conditions.contains_key(&id) => id,
        _ => nearest_to_ringing(assessment)?,
    };
    let title = format!("Couplings: {}", assessment.couplings.name());
    let figure = Figure::new(title)
        .caption(couplings_heading(assessment))
        .columns(2)
        .aspect(0.72)
        .plot(loop_plot(assessment, shown, unit))
        .plot(pole_plot(assessment, shown));
    Some(figure)
}

/// Returns the condition with the smallest [`LoopMargin`]; a missing margin counts as infinite.
/// `None` if there are no conditions.
fn nearest_to_ringing(assessment: &CouplingsAssessment) -> Option<ConditionId> {
    let ids = assessment.conditions.keys().copied();
    ids.min_by(|a, b| least_margin(assessment, *a).total_cmp(&least_margin(assessment, *b)))
}

fn least_margin(assessment: &CouplingsAssessment, id: ConditionId) -> f64 {
    match assessment.conditions[&id].margin {
        Some(margin) => margin.least,
        None => f64::INFINITY,
    }
}

/// Plots the loop's minimum singular value over frequency, for every condition.
fn loop_plot(assessment: &CouplingsAssessment, shown: ConditionId, unit: FrequencyUnit) -> Plot {
    let frequencies: Vec<f64> = assessment
        .omega
        .iter()
        .map(|omega| unit.of_omega(*omega))
        .collect();
    let band = Strip {
        range: Range::new(
            unit.of_omega(assessment.band.min()),
            unit.of_omega(assessment.band.max()),
        ),
        color: BAND,
        key: "comparison band".to_owned(),
    };
    let ringing = Rule::horizontal(LoopMargin::CAUTION, RINGING).label("close to ringing");
    let y = Axis::linear("minimum singular value of I − K H")
        .including(0.0)
        .including(1.0);
    let mut panel = Panel::new(Axis::logarithmic(unit.axis_label()), y)
        .with_ground(band)
        .with(ringing);
    for (id, condition) in &assessment.conditions {
        if *id != shown {
            let values = condition.singular_values.clone();
            let name = format!("condition {id}");
            let curve = Curve::new(name, OTHERS, frequencies.clone(), values);
            panel = panel.with(curve.key("other conditions"));
        }
    }
    let name = format!("condition {shown}");
    let values = assessment.conditions[&shown].singular_values.clone();
    let curve = Curve::new(&name, SHOWN, frequencies, values).key(&name);
    Plot::new("Coupling loop at the inputs").panel(panel.with(curve))
}

/// Plots the poles without and with couplings, up to [`SHOWN_POLES`] times the band's upper end.
fn pole_plot(assessment: &CouplingsAssessment, shown: ConditionId) -> Plot {
    let most_rad_s = SHOWN_POLES * assessment.band.max();
    let mut near: Vec<PoleShift> = Vec::new();
    for shift in assessment.conditions[&shown].poles.iter().flatten() {
        if shift.after.norm() <= most_rad_s {
            near.push(*shift);
        }
    }
    let x = Axis::linear("Re λ [rad/s]").including(0.0);
    let y = Axis::linear("Im λ [rad/s]");
    let panel = Panel::new(x, y)
        .with(Rule::vertical(0.0, AXIS))
        .with_all(pole_shift_marks(&near, &PoleShiftNames::COUPLINGS));
    Plot::new(format!("Poles of condition {shown}")).panel(panel)
}
