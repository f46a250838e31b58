//! Poles of every model of one condition in the s-plane.

use crate::dataset::BundleKind;
use crate::study::{ConditionModes, Unobserved};

use super::axis::Axis;
use super::bode::BodeOptions;
use super::condition_source::ConditionSource;
use super::figure::Figure;
use super::mark::{DotShape, Dots, Guide, Mark, Rule};
use super::panel::{Panel, Plot};
use super::range::Range;
use super::stroke::{Color, Stroke};

/// Real and imaginary parts in the window of the slow modes \[rad/s\]: the rigid-body modes of a helicopter lie there.
const SLOW: [Range; 2] = [Range { min: -1.2, max: 0.5 }, Range { min: -2.2, max: 2.2 }];
const DAMPING_RATIOS: [f64; 6] = [0.1, 0.2, 0.4, 0.6, 0.8, 0.95];
/// How far the rays of equal damping reach \[rad/s\].
const FAR: f64 = 1e3;
const ZERO: Stroke = Stroke::solid(Color::DIM, 0.6);

/// Poles of every model of one condition: all of them, and the window of the slow modes; physics models ×, identified ones +.
pub fn poles_figure(source: &ConditionSource<'_>, options: &BodeOptions) -> Option<Figure> {
    let modes = ConditionModes::of(&source.curves.condition, &Unobserved).ok()?;
    let dots = poles(source, &modes, options);
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
        Plot::new(title).panel(panel)
    };
    let title = format!("Poles · {}", source.condition_words());
    let figure = Figure::new(title).caption(format!("{} Rays: equal damping ratio ζ.", source.caption()));
    Some(figure.plot(plot("s-plane", whole)).plot(plot("slow modes", SLOW)).columns(2).aspect(0.85))
}

/// One group of dots for each model, what matters most last.
fn poles(source: &ConditionSource<'_>, modes: &ConditionModes, options: &BodeOptions) -> Vec<Dots> {
    let models = BundleKind::BOTH.into_iter().flat_map(|kind| source.models(kind));
    let mut shown: Vec<_> = models
        .filter(|model| options.shows_model(model) && !options.hidden.contains(&model.role.shown(model.rejected)))
        .collect();
    shown.sort_by_key(|model| model.role.layer(model.rejected));
    let group = |model: super::condition_source::SourceModel| {
        let shape = match model.id.bundle {
            BundleKind::Physics => DotShape::Cross,
            BundleKind::Identified => DotShape::Plus,
        };
        let color = model.role.stroke(model.rejected).color;
        let found = modes.bundle(model.id.bundle)[model.index].as_deref().unwrap_or_default();
        let dots = Dots::new(&model.id.name, shape, color).key(model.role.key(model.rejected));
        found.iter().fold(dots, |dots, mode| dots.dot(mode.pole.re, mode.pole.im, ""))
    };
    shown.into_iter().map(group).collect()
}

/// Rays of equal damping ratio, `Re λ = -ζ |λ|`, above and below the real axis.
fn rays() -> Vec<Mark> {
    let ray = |ratio: f64, sign: f64| -> Mark {
        let far = [-FAR * ratio, sign * FAR * (1.0 - ratio * ratio).sqrt()];
        Guide { points: vec![[0.0, 0.0], far], label: String::new() }.into()
    };
    DAMPING_RATIOS.into_iter().flat_map(|ratio| [ray(ratio, 1.0), ray(ratio, -1.0)]).collect()
}
