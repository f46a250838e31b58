//! What couplings do to the loop they make: how near it is to ringing over frequency, and where the poles of one condition go (M16.4).

use gdcm_core::couplings::{LoopMargin, PoleShift};
use gdcm_core::dataset::ConditionId;
use gdcm_core::study::CouplingsAssessment;
use nalgebra::Complex;

use super::axis::{Axis, Range};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::mark::{Along, Band, Curve, Dot, DotShape, Dots, Mark, Rule};
use super::requirements::{arrow, spanned};
use super::role::Role;
use super::units::FrequencyUnit;

const OTHERS: Stroke = Stroke::solid(Color::of(Hue::Perturbed).tint(60), 0.7);
const SHOWN: Stroke = Stroke::solid(Color::of(Hue::Corrected), 1.6);
const WAY: Stroke = Stroke::solid(Color::of(Hue::Corrected), 1.0);
const RINGING: Stroke = Stroke::dashed(Color::of(Hue::Warning), 1.0, Dash::Short);
const AXIS: Stroke = Stroke::solid(Color::DIM, 0.6);

/// The least singular value of `I - K H` over frequency, of every condition, `shown` on top; and the poles of that condition's physics
/// representative without couplings and with them. Without a condition the one that is nearest to ringing.
pub fn couplings_figure(
    assessment: &CouplingsAssessment,
    shown: Option<ConditionId>,
    unit: FrequencyUnit,
) -> Option<Figure> {
    let least = |id: &ConditionId| assessment.conditions[id].margin.map_or(f64::INFINITY, |margin| margin.least);
    let nearest = || assessment.conditions.keys().min_by(|a, b| least(a).total_cmp(&least(b))).copied();
    let shown = shown.filter(|id| assessment.conditions.contains_key(id)).or_else(nearest)?;
    let title = format!("Couplings: {}", assessment.couplings.name());
    let figure = Figure::new(title).caption(assessment.heading()).columns(2).aspect(0.72);
    Some(figure.plot(loop_plot(assessment, shown, unit)).plot(pole_plot(assessment, shown)))
}

/// How near the loop is to ringing.
fn loop_plot(assessment: &CouplingsAssessment, shown: ConditionId, unit: FrequencyUnit) -> Plot {
    let omega: Vec<f64> = assessment.omega.iter().map(|omega| unit.of_omega(*omega)).collect();
    let curve = |id: ConditionId, stroke: Stroke, key: String| {
        Curve::new(format!("condition {id}"), stroke, omega.clone(), assessment.conditions[&id].singular_values.clone())
            .key(key)
    };
    let others = assessment.conditions.keys().filter(|id| **id != shown);
    let others = others.map(|id| curve(*id, OTHERS, "other conditions".to_owned()));
    let band = Range::new(unit.of_omega(assessment.band.min()), unit.of_omega(assessment.band.max()));
    let ground =
        Band { along: Along::X, range: band, color: Color::of(Hue::Accent).tint(12), key: Some("band".to_owned()) };
    let ringing = Rule::horizontal(LoopMargin::CAUTION, RINGING).label("close to ringing");
    let y = Axis::linear("least singular value of I − K H").including(0.0).including(1.0);
    let panel = Panel::new(Axis::logarithmic(unit.axis_label()), y).over(ground).with(ringing).with_all(others);
    Plot::new("Loop at the sticks").panel(panel.with(curve(shown, SHOWN, format!("condition {shown}"))))
}

/// Where the poles go.
fn pole_plot(assessment: &CouplingsAssessment, shown: ConditionId) -> Plot {
    let (x, y) = (Axis::linear("Re λ [rad/s]"), Axis::linear("Im λ [rad/s]"));
    let within = 1.5 * assessment.band.max();
    let poles = assessment.conditions[&shown].poles.iter().flatten();
    let near: Vec<PoleShift> = poles.filter(|shift| shift.after.norm() <= within).copied().collect();
    let panel = Panel::new(x.including(0.0), y).with(Rule::vertical(0.0, AXIS)).with_all(pole_shift_marks(&near));
    Plot::new(format!("Poles of condition {shown}")).panel(panel)
}

/// Poles without couplings, those with them, and an arrow from each to where it goes.
pub fn pole_shift_marks(shifts: &[PoleShift]) -> Vec<Mark> {
    let place = |pole: Complex<f64>| [pole.re, pole.im];
    let moved: Vec<[[f64; 2]; 2]> =
        shifts.iter().filter_map(|shift| Some([place(shift.before?), place(shift.after)])).collect();
    let spanned = spanned(moved.iter().flatten().copied());
    let ways = moved.into_iter().map(|[from, to]| {
        let (x, y): (Vec<f64>, Vec<f64>) = arrow(from, to, spanned).into_iter().map(|[x, y]| (x, y)).unzip();
        Mark::from(Curve::new("moved", WAY, x, y))
    });
    let dots = |name: &str, shape: DotShape, role: Role, places: Vec<[f64; 2]>| {
        let dots = places.into_iter().map(|[x, y]| Dot { x, y, label: String::new(), id: None }).collect();
        Mark::from(Dots { dots, ..Dots::new(name, shape, role.stroke(false).color).key(name).filled(false) })
    };
    let before = shifts.iter().filter_map(|shift| shift.before).map(|pole| [pole.re, pole.im]).collect();
    let after = shifts.iter().map(|shift| [shift.after.re, shift.after.im]).collect();
    ways.chain([
        dots("without couplings", DotShape::Cross, Role::Representative, before),
        dots("with couplings", DotShape::Circle, Role::Corrected, after),
    ])
    .collect()
}
