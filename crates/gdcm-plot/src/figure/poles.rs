//! Poles of every model of one condition in the s-plane, and the effect of couplings on their loop
//! and on the poles (M16.4).

use nalgebra::Complex;

use gdcm_method::couplings::{LoopMargin, PoleShift};
use gdcm_model::dataset::{BundleKind, ConditionId, ModelId, Pair};
use gdcm_model::response::zeros::finite_zeros;
use gdcm_study::jobs::curve_jobs::ConditionModes;
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_words::couplings::couplings_heading;

use super::axis::{Axis, FrequencyUnit, Range, step_above};
use super::bode::BodeOptions;
use super::condition_source::{ConditionSource, SourceModel};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{
    Band, Curve, Dot, DotShape, Dots, Figure, Guide, Mark, MarkId, Panel, Plot, Rule,
};
use super::requirements::{arrow, spanned};
use super::role::Role;

/// Real and imaginary ranges of the slow modes \[rad/s\]: those of the rigid-body modes of a
/// helicopter.
const SLOW: [Range; 2] = [
    Range {
        min: -1.2,
        max: 0.5,
    },
    Range {
        min: -2.2,
        max: 2.2,
    },
];
const DAMPING_RATIOS: [f64; 6] = [0.1, 0.2, 0.4, 0.6, 0.8, 0.95];
/// Length of the rays of constant damping \[rad/s\].
const FAR: f64 = 1e3;
/// Points of an arc of constant frequency.
const ARC_POINTS: usize = 60;
const AXIS: Stroke = Stroke::solid(Color::DIM, 0.6);

/// Zeros of a model for the response whose zeros are shown.
type ZerosOf<'a> = &'a dyn Fn(&ModelId) -> Vec<Complex<f64>>;

/// Plots the poles of every model of one condition: all of them, and the window of the slow modes;
/// physics models ×, identified models +. `zeros_of` gives the zeros of a model for the selected
/// response, if any; `shifts` gives the pole shifts of the physics representative due to couplings.
pub fn poles_figure(
    source: &ConditionSource<'_>,
    modes: &ConditionModes,
    options: &BodeOptions,
    (zeros_of, shifts): (ZerosOf<'_>, &[PoleShift]),
) -> Figure {
    let shown = shown_models(source, options);
    let dots = poles(&shown, modes);
    let zeros: Vec<Dots> = options
        .zeros_of
        .map(|pair| zeros(source, &shown, (pair, zeros_of)))
        .unwrap_or_default();
    let moved = if shifts.is_empty() {
        Vec::new()
    } else {
        pole_shift_marks(shifts)
    };
    let values = |of: fn(&Dot) -> f64| {
        Range::of(dots.iter().flat_map(|dots| &dots.dots).map(of)).unwrap_or(Range::new(-1.0, 1.0))
    };
    let real = values(|dot| dot.x);
    let imaginary = values(|dot| dot.y);
    let reach = imaginary.max.abs().max(imaginary.min.abs());
    let whole = [
        real.including(0.0).with_margin(0.06, 1.0),
        Range::new(-reach, reach).with_margin(0.08, 1.0),
    ];
    let plot = |title: &str, [real, imaginary]: [Range; 2]| {
        let x = Axis::linear("Re λ [rad/s]").showing(Some(real));
        let y = Axis::linear("Im λ [rad/s]").showing(Some(imaginary));
        let panel = Panel::new(x, y)
            .with_all(rays())
            .with(Rule::vertical(0.0, AXIS))
            .with_all(dots.clone());
        let panel = panel.with_all(zeros.clone()).with_all(moved.clone());
        Plot::new(title).panel(panel)
    };
    let title = format!("Poles · {}", source.condition_words());
    let figure =
        Figure::new(title).caption(format!("{} Rays: equal damping ratio ζ.", source.caption()));
    figure
        .plot(plot("s-plane", whole))
        .plot(plot("slow modes", SLOW))
        .columns(2)
        .aspect(0.85)
}

/// Returns the visible models, the most important last.
fn shown_models(source: &ConditionSource<'_>, options: &BodeOptions) -> Vec<SourceModel> {
    let models = BundleKind::BOTH
        .into_iter()
        .flat_map(|kind| source.models(kind, options));
    let mut shown: Vec<_> = models.filter(|model| !model.hidden).collect();
    shown.sort_by_key(|model| model.role.layer(model.rejected));
    shown
}

/// Returns one group of dots for each model.
fn poles(shown: &[SourceModel], modes: &ConditionModes) -> Vec<Dots> {
    let group = |model: &SourceModel| {
        let shape = match model.id.bundle {
            BundleKind::Physics => DotShape::Cross,
            BundleKind::Identified => DotShape::Plus,
        };
        let color = model.role.stroke(model.rejected).color;
        let found = modes.bundle(model.id.bundle)[model.index]
            .as_deref()
            .unwrap_or_default();
        let dots = Dots::new(&model.id.name, shape, color).key(model.role.key(model.rejected));
        Dots {
            dots: found
                .iter()
                .map(|mode| pole_dot(model, mode.pole))
                .collect(),
            ..dots
        }
    };
    shown.iter().map(group).collect()
}

fn pole_dot(model: &SourceModel, value: Complex<f64>) -> Dot {
    Dot {
        x: value.re,
        y: value.im,
        label: String::new(),
        id: Some(MarkId::Model(model.id.clone())),
    }
}

/// Returns the finite transmission zeros of a response of a model of the condition.
pub fn zeros_of_model(source: &ConditionSource<'_>, pair: Pair, id: &ModelId) -> Vec<Complex<f64>> {
    let model = source.curves.condition.model(id.bundle, &id.name);
    model
        .map(|model| finite_zeros(&model.dynamics, pair))
        .unwrap_or_default()
}

/// Returns the zeros of one response in the nominal model and in both representatives, as circles;
/// they may lie far out and do not extend the axis range.
fn zeros(
    source: &ConditionSource<'_>,
    shown: &[SourceModel],
    (pair, zeros_of): (Pair, ZerosOf<'_>),
) -> Vec<Dots> {
    let has_zeros = |role| {
        matches!(
            role,
            Role::Nominal | Role::Representative | Role::IdentifiedRepresentative
        )
    };
    let group = |model: &SourceModel| {
        let key = format!(
            "zeros of {}, {}",
            source.dataset().pair_name(pair),
            model.role.key(model.rejected)
        );
        let color = model.role.stroke(model.rejected).color;
        let dots = Dots::new(&model.id.name, DotShape::Circle, color)
            .key(key)
            .filled(false);
        Dots {
            dots: zeros_of(&model.id)
                .into_iter()
                .map(|zero| pole_dot(model, zero))
                .collect(),
            ..dots
        }
    };
    shown
        .iter()
        .filter(|model| has_zeros(model.role))
        .map(group)
        .collect()
}

/// Fractions of the width and height of a plot within which two damping labels would overlap.
const BESIDE: [f64; 2] = [0.11, 0.07];

/// Returns grid lines for a part of the s-plane: rays of constant damping ratio, the upper ones
/// labelled where they leave the part, and arcs of constant frequency.
pub fn damping_grid([real, imaginary]: [Range; 2]) -> impl Iterator<Item = Guide> {
    let reach = [real.min, real.max, imaginary.min, imaginary.max]
        .into_iter()
        .fold(0.0f64, |far, end| far.max(end.abs()));
    let mut named_at: Option<[f64; 2]> = None;
    let rays = DAMPING_RATIOS.into_iter().flat_map(move |ratio| {
        let slope = (1.0 - ratio * ratio).sqrt() / ratio;
        let edge = (-real.min).min(imaginary.max / slope).max(0.0);
        let place = [edge / real.width(), edge * slope / imaginary.width()];
        let is_near =
            |other: [f64; 2]| (0..2).all(|axis| (place[axis] - other[axis]).abs() < BESIDE[axis]);
        let is_named = edge > 0.0 && !named_at.is_some_and(is_near);
        named_at = if is_named { Some(place) } else { named_at };
        [1.0, -1.0].map(|side| Guide {
            points: vec![
                [0.0, 0.0],
                [-edge, side * edge * slope],
                [-2.0 * reach, side * 2.0 * reach * slope],
            ],
            label: if side > 0.0 && is_named {
                format!("ζ {ratio}")
            } else {
                String::new()
            },
        })
    });
    let step = step_above(reach / 4.0);
    let radii = (1..=8)
        .map(move |k| step * f64::from(k))
        .take_while(move |radius| *radius < 2.0 * reach);
    let angle = |k: usize| std::f64::consts::PI * (0.5 + k as f64 / ARC_POINTS as f64);
    let arcs = radii.map(move |radius| Guide {
        points: (0..=ARC_POINTS)
            .map(|k| [radius * angle(k).cos(), radius * angle(k).sin()])
            .collect(),
        label: String::new(),
    });
    rays.chain(arcs)
}

/// Returns rays of constant damping ratio, `Re λ = -ζ |λ|`, above and below the real axis.
fn rays() -> Vec<Mark> {
    let ray = |ratio: f64, sign: f64| -> Mark {
        let far = [-FAR * ratio, sign * FAR * (1.0 - ratio * ratio).sqrt()];
        Guide {
            points: vec![[0.0, 0.0], far],
            label: String::new(),
        }
        .into()
    };
    DAMPING_RATIOS
        .into_iter()
        .flat_map(|ratio| [ray(ratio, 1.0), ray(ratio, -1.0)])
        .collect()
}

const OTHERS: Stroke = Stroke::solid(Color::of(Hue::Perturbed).tint(60), 0.7);
const SHOWN: Stroke = Stroke::solid(Color::of(Hue::Corrected), 1.6);
const WAY: Stroke = Stroke::solid(Color::of(Hue::Corrected), 1.0);
const RINGING: Stroke = Stroke::dashed(Color::of(Hue::Warning), 1.0, Dash::Short);

/// Plots the least singular value of `I - K H` over frequency for every condition, `shown` on top;
/// and the poles of that condition's physics representative without and with couplings. Without a
/// selected condition, the one nearest to ringing.
pub fn couplings_figure(
    assessment: &CouplingsAssessment,
    shown: Option<ConditionId>,
    unit: FrequencyUnit,
) -> Option<Figure> {
    let least = |id: &ConditionId| {
        assessment.conditions[id]
            .margin
            .map_or(f64::INFINITY, |margin| margin.least)
    };
    let nearest = || {
        assessment
            .conditions
            .keys()
            .min_by(|a, b| least(a).total_cmp(&least(b)))
            .copied()
    };
    let shown = shown
        .filter(|id| assessment.conditions.contains_key(id))
        .or_else(nearest)?;
    let title = format!("Couplings: {}", assessment.couplings.name());
    let figure = Figure::new(title)
        .caption(couplings_heading(assessment))
        .columns(2)
        .aspect(0.72);
    Some(
        figure
            .plot(loop_plot(assessment, shown, unit))
            .plot(pole_plot(assessment, shown)),
    )
}

/// Plots the distance of the loop from ringing.
fn loop_plot(assessment: &CouplingsAssessment, shown: ConditionId, unit: FrequencyUnit) -> Plot {
    let omega: Vec<f64> = assessment
        .omega
        .iter()
        .map(|omega| unit.of_omega(*omega))
        .collect();
    let curve = |id: ConditionId, stroke: Stroke, key: String| {
        Curve::new(
            format!("condition {id}"),
            stroke,
            omega.clone(),
            assessment.conditions[&id].singular_values.clone(),
        )
        .key(key)
    };
    let others = assessment.conditions.keys().filter(|id| **id != shown);
    let others = others.map(|id| curve(*id, OTHERS, "other conditions".to_owned()));
    let band = Range::new(
        unit.of_omega(assessment.band.min()),
        unit.of_omega(assessment.band.max()),
    );
    let ground = Band {
        range: band,
        color: Color::of(Hue::Accent).tint(12),
        key: "band".to_owned(),
    };
    let ringing = Rule::horizontal(LoopMargin::CAUTION, RINGING).label("close to ringing");
    let y = Axis::linear("least singular value of I − K H")
        .including(0.0)
        .including(1.0);
    let panel = Panel::new(Axis::logarithmic(unit.axis_label()), y)
        .over(ground)
        .with(ringing)
        .with_all(others);
    Plot::new("Loop at the sticks").panel(panel.with(curve(
        shown,
        SHOWN,
        format!("condition {shown}"),
    )))
}

/// Plots the shifts of the poles.
fn pole_plot(assessment: &CouplingsAssessment, shown: ConditionId) -> Plot {
    let x = Axis::linear("Re λ [rad/s]");
    let y = Axis::linear("Im λ [rad/s]");
    let within = 1.5 * assessment.band.max();
    let poles = assessment.conditions[&shown].poles.iter().flatten();
    let near: Vec<PoleShift> = poles
        .filter(|shift| shift.after.norm() <= within)
        .copied()
        .collect();
    let panel = Panel::new(x.including(0.0), y)
        .with(Rule::vertical(0.0, AXIS))
        .with_all(pole_shift_marks(&near));
    Plot::new(format!("Poles of condition {shown}")).panel(panel)
}

/// Returns the poles without and with couplings, and an arrow from each to its new position.
pub fn pole_shift_marks(shifts: &[PoleShift]) -> Vec<Mark> {
    let place = |pole: Complex<f64>| [pole.re, pole.im];
    let moved: Vec<[[f64; 2]; 2]> = shifts
        .iter()
        .filter_map(|shift| Some([place(shift.before?), place(shift.after)]))
        .collect();
    let spanned = spanned(moved.iter().flatten().copied());
    let ways = moved
        .into_iter()
        .map(|[from, to]| Mark::from(Curve::through("moved", WAY, arrow(from, to, spanned))));
    let dots = |name: &str, shape: DotShape, role: Role, poles: Vec<Complex<f64>>| {
        let empty = Dots::new(name, shape, role.stroke(false).color)
            .key(name)
            .filled(false);
        Mark::from(
            poles
                .into_iter()
                .fold(empty, |dots, pole| dots.dot(pole.re, pole.im, "")),
        )
    };
    let before = shifts.iter().filter_map(|shift| shift.before).collect();
    let after = shifts.iter().map(|shift| shift.after).collect();
    ways.chain([
        dots(
            "without couplings",
            DotShape::Cross,
            Role::Representative,
            before,
        ),
        dots("with couplings", DotShape::Circle, Role::Corrected, after),
    ])
    .collect()
}
