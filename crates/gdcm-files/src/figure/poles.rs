//! Poles of every model of one condition in the s-plane.

use gdcm_core::dataset::{BundleKind, Pair};
use gdcm_core::response::finite_zeros;
use gdcm_core::study::{ConditionModes, Unobserved};

use super::axis::{Axis, Range};
use super::bode::BodeOptions;
use super::condition_source::{ConditionSource, SourceModel};
use super::drawing::{Color, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::mark::{DotShape, Dots, Guide, Mark, Rule};
use super::role::Role;

/// Real and imaginary parts in the window of the slow modes \[rad/s\]: the rigid-body modes of a helicopter lie there.
const SLOW: [Range; 2] = [Range { min: -1.2, max: 0.5 }, Range { min: -2.2, max: 2.2 }];
const DAMPING_RATIOS: [f64; 6] = [0.1, 0.2, 0.4, 0.6, 0.8, 0.95];
/// How far the rays of equal damping reach \[rad/s\].
const FAR: f64 = 1e3;
const ZERO: Stroke = Stroke::solid(Color::DIM, 0.6);

/// Poles of every model of one condition: all of them, and the window of the slow modes; physics models ×, identified ones +.
pub fn poles_figure(source: &ConditionSource<'_>, options: &BodeOptions) -> Option<Figure> {
    let modes = ConditionModes::of(&source.curves.condition, &Unobserved).ok()?;
    let shown = shown_models(source, options);
    let dots = poles(&shown, &modes);
    let zeros: Vec<Dots> = options.zeros_of.map(|pair| zeros(source, &shown, pair)).unwrap_or_default();
    let values = |of: fn(&super::mark::Dot) -> f64| {
        Range::of(dots.iter().flat_map(|dots| &dots.dots).map(of)).unwrap_or(Range::new(-1.0, 1.0))
    };
    let (real, imaginary) = (values(|dot| dot.x), values(|dot| dot.y));
    let reach = imaginary.max.abs().max(imaginary.min.abs());
    let whole = [real.including(0.0).with_margin(0.06, 1.0), Range::new(-reach, reach).with_margin(0.08, 1.0)];
    let plot = |title: &str, [real, imaginary]: [Range; 2]| {
        let x = Axis::linear("Re λ [rad/s]").showing(Some(real));
        let y = Axis::linear("Im λ [rad/s]").showing(Some(imaginary));
        let panel = Panel::new(x, y).with_all(rays()).with(Rule::vertical(0.0, ZERO)).with_all(dots.clone());
        let panel = panel.with_all(zeros.clone());
        Plot::new(title).panel(panel)
    };
    let title = format!("Poles · {}", source.condition_words());
    let figure = Figure::new(title).caption(format!("{} Rays: equal damping ratio ζ.", source.caption()));
    Some(figure.plot(plot("s-plane", whole)).plot(plot("slow modes", SLOW)).columns(2).aspect(0.85))
}

/// The models that are shown, what matters most last.
fn shown_models(source: &ConditionSource<'_>, options: &BodeOptions) -> Vec<SourceModel> {
    let models = BundleKind::BOTH.into_iter().flat_map(|kind| source.models(kind, options));
    let mut shown: Vec<_> = models.filter(|model| !model.hidden).collect();
    shown.sort_by_key(|model| model.role.layer(model.rejected));
    shown
}

/// One group of dots for each model.
fn poles(shown: &[SourceModel], modes: &ConditionModes) -> Vec<Dots> {
    let group = |model: &SourceModel| {
        let shape = match model.id.bundle {
            BundleKind::Physics => DotShape::Cross,
            BundleKind::Identified => DotShape::Plus,
        };
        let color = model.role.stroke(model.rejected).color;
        let found = modes.bundle(model.id.bundle)[model.index].as_deref().unwrap_or_default();
        let dots = Dots::new(&model.id.name, shape, color).key(model.role.key(model.rejected));
        found.iter().fold(dots, |dots, mode| dots.dot(mode.pole.re, mode.pole.im, ""))
    };
    shown.iter().map(group).collect()
}

/// Zeros of one response in the nominal model and in both representatives, as circles; they may lie far out, and widen no range.
fn zeros(source: &ConditionSource<'_>, shown: &[SourceModel], pair: Pair) -> Vec<Dots> {
    let has_zeros = |role| matches!(role, Role::Nominal | Role::Representative | Role::IdentifiedRepresentative);
    let group = |model: &SourceModel| {
        let found = source.curves.condition.model(model.id.bundle, &model.id.name)?;
        let zeros = finite_zeros(&found.dynamics, pair);
        let key = format!("zeros of {}, {}", source.dataset().pair_name(pair), model.role.key(model.rejected));
        let dots = Dots::new(&model.id.name, DotShape::Circle, model.role.stroke(model.rejected).color).key(key);
        Some(zeros.iter().fold(dots.filled(false), |dots, zero| dots.dot(zero.re, zero.im, "")))
    };
    shown.iter().filter(|model| has_zeros(model.role)).filter_map(group).collect()
}

/// Rays of equal damping ratio, `Re λ = -ζ |λ|`, above and below the real axis.
fn rays() -> Vec<Mark> {
    let ray = |ratio: f64, sign: f64| -> Mark {
        let far = [-FAR * ratio, sign * FAR * (1.0 - ratio * ratio).sqrt()];
        Guide { points: vec![[0.0, 0.0], far], label: String::new() }.into()
    };
    DAMPING_RATIOS.into_iter().flat_map(|ratio| [ray(ratio, 1.0), ray(ratio, -1.0)]).collect()
}
