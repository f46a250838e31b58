//! Every model's poles in the s-plane, for one condition, and the zeros of a response.
//!
//! A bundle's *representative* is the physics or identified model closest to the others, or the
//! engineer's choice (M5).

use nalgebra::Complex;

use gdcm_method::couplings::PoleShift;
use gdcm_model::dataset::{BundleKind, ModelId, Pair};
use gdcm_model::response::zeros::finite_zeros;
use gdcm_study::jobs::curve_jobs::ConditionModes;

pub use super::couplings::couplings_figure;
pub use super::damping_grid::damping_grid;

use super::axis::{Axis, Range};
use super::bode_options::BodeOptions;
use super::condition_source::{ConditionSource, SourceModel};
use super::couplings::AXIS;
use super::damping_grid::rays;
use super::figure::{Figure, Panel, Plot};
use super::marks::{Dot, DotShape, Dots, Mark, MarkId, Rule};
use super::pole_shift::{PoleShiftNames, pole_shift_marks};
use super::role::Role;

/// Real and imaginary ranges \[rad/s\] in the plot of slow modes: a helicopter's rigid-body modes.
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
/// Margins in the plot of all poles, along the real and the imaginary axis, relative to the range.
const MARGINS: [f64; 2] = [0.06, 0.08];
/// Minimum width and height in the plot of all poles \[rad/s\].
const LEAST: f64 = 1.0;

/// Function that returns a model's zeros \[rad/s\] in the selected response.
type ZerosOf<'a> = &'a dyn Fn(&ModelId) -> Vec<Complex<f64>>;

/// Computed contents for the pole figure.
#[derive(Clone, Copy)]
pub struct PoleContents<'a> {
    pub modes: &'a ConditionModes,
    /// Returns a model's zeros in the response [`BodeOptions::zeros_of`]; called only if such a
    /// response is selected.
    pub zeros_of: ZerosOf<'a>,
    /// Shifts that couplings cause in the physics representative's poles.
    pub shifts: &'a [PoleShift],
}

/// Plots the poles of every model in a condition, in the whole s-plane and in the region of the
/// slow modes; × marks physics models, + identified models. Zeros are drawn if the options select a
/// response.
pub fn poles_figure(
    source: &ConditionSource<'_>,
    contents: PoleContents<'_>,
    options: &BodeOptions,
) -> Figure {
    let shown = shown_models(source, options);
    let poles: Vec<Dots> = shown
        .iter()
        .map(|model| pole_dots(model, contents.modes))
        .collect();
    let whole = whole_plane(&poles);
    let mut marks: Vec<Mark> = poles.into_iter().map(Mark::from).collect();
    if let Some(pair) = options.zeros_of {
        let pair_name = source.dataset().pair_name(pair);
        for model in shown.iter().filter(|model| has_zeros(model.role)) {
            marks.push(zero_dots(model, &pair_name, contents.zeros_of).into());
        }
    }
    if !contents.shifts.is_empty() {
        marks.extend(pole_shift_marks(
            contents.shifts,
            &PoleShiftNames::COUPLINGS,
        ));
    }
    Figure::new(format!("Poles · {}", source.condition_words()))
        .caption(format!(
            "{} Rays: constant damping ratio ζ.",
            source.caption()
        ))
        .plot(plane_plot("s-plane", whole, marks.clone()))
        .plot(plane_plot("slow modes", SLOW, marks))
        .columns(2)
        .aspect(0.85)
}

/// Plots a part of the s-plane with these real and imaginary ranges.
fn plane_plot(title: &str, [real, imaginary]: [Range; 2], marks: Vec<Mark>) -> Plot {
    let x = Axis::linear("Re λ [rad/s]").showing(Some(real));
    let y = Axis::linear("Im λ [rad/s]").showing(Some(imaginary));
    let panel = Panel::new(x, y)
        .with_all(rays())
        .with(Rule::vertical(0.0, AXIS))
        .with_all(marks);
    Plot::new(title).panel(panel)
}

/// Returns the real and imaginary ranges that show all poles and the origin, symmetric about the
/// real axis.
fn whole_plane(poles: &[Dots]) -> [Range; 2] {
    let dots: Vec<&Dot> = poles.iter().flat_map(|group| &group.dots).collect();
    let empty = Range::new(-1.0, 1.0);
    let real = Range::spanning(dots.iter().map(|dot| dot.x)).unwrap_or(empty);
    let imaginary = Range::spanning(dots.iter().map(|dot| dot.y)).unwrap_or(empty);
    let reach = imaginary.max.abs().max(imaginary.min.abs());
    [
        real.including(0.0).with_margin(MARGINS[0], LEAST),
        Range::new(-reach, reach).with_margin(MARGINS[1], LEAST),
    ]
}

/// Returns the visible models in drawing order, the most important last.
fn shown_models(source: &ConditionSource<'_>, options: &BodeOptions) -> Vec<SourceModel> {
    let mut shown = Vec::new();
    for kind in BundleKind::BOTH {
        let models = source.models(kind, options).into_iter();
        shown.extend(models.filter(|model| !model.hidden));
    }
    shown.sort_by_key(|model| model.role.layer(model.rejected));
    shown
}

/// Returns a model's poles as dots; empty if they could not be computed.
fn pole_dots(model: &SourceModel, modes: &ConditionModes) -> Dots {
    let shape = match model.id.bundle {
        BundleKind::Physics => DotShape::Cross,
        BundleKind::Identified => DotShape::Plus,
    };
    let color = model.role.stroke(model.rejected).color;
    let mut dots = Dots::new(&model.id.name, shape, color).key(model.role.key(model.rejected));
    let model_modes = modes.bundle(model.id.bundle)[model.index].as_deref();
    for mode in model_modes.unwrap_or_default() {
        dots.dots.push(model_dot(model, mode.pole));
    }
    dots
}

fn model_dot(model: &SourceModel, value: Complex<f64>) -> Dot {
    Dot {
        x: value.re,
        y: value.im,
        label: String::new(),
        id: Some(MarkId::Model(model.id.clone())),
    }
}

/// Returns the finite transmission zeros of a model's response in the condition; empty if the
/// condition does not have the model.
pub fn zeros_of_model(source: &ConditionSource<'_>, pair: Pair, id: &ModelId) -> Vec<Complex<f64>> {
    match source.curves.condition.model(id.bundle, &id.name) {
        Some(model) => finite_zeros(&model.dynamics, pair),
        None => Vec::new(),
    }
}

/// Returns whether a model's zeros are shown: only for the nominal model and both representatives.
fn has_zeros(role: Role) -> bool {
    matches!(
        role,
        Role::Nominal | Role::Representative | Role::IdentifiedRepresentative
    )
}

/// Returns a model's zeros as circles; they may lie outside the displayed ranges.
fn zero_dots(model: &SourceModel, pair_name: &str, zeros_of: ZerosOf<'_>) -> Dots {
    let key = format!("zeros of {pair_name}, {}", model.role.key(model.rejected));
    let color = model.role.stroke(model.rejected).color;
    let mut dots = Dots::new(&model.id.name, DotShape::Circle, color)
        .key(key)
        .filled(false);
    for zero in zeros_of(&model.id) {
        dots.dots.push(model_dot(model, zero));
    }
    dots
}
