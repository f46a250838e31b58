//! A frequency response as the Bode plot draws it.

use std::ops::RangeInclusive;
use std::sync::Arc;

use egui::{Color32, Pos2, Shape, Ui};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};
pub use gdcm_files::figure::{BodeCurve, CurveId, LogFrequencies, Pane};

use super::curve_style::CurveStyle;

/// Splits points into runs that are finite throughout and come within `margin` of `view`, a part of its size.
///
/// A point that is not finite makes debug builds of egui_plot panic, and a curve that runs far outside the view costs time in
/// proportion to its points, and where it is dashed, to its length on the screen.
pub fn runs_in_view(points: impl Iterator<Item = [f64; 2]>, view: &PlotBounds, margin: f64) -> Vec<Vec<[f64; 2]>> {
    let near = enlarged(view, margin);
    let mut runs: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut run: Vec<[f64; 2]> = Vec::new();
    let mut previous: Option<[f64; 2]> = None;
    for point in points {
        let point = point.iter().all(|c| c.is_finite()).then_some(point);
        match (previous, point) {
            (Some(from), Some(to)) if touches(from, to, &near) => {
                if run.is_empty() {
                    run.push(from);
                }
                run.push(to);
            }
            _ => runs.extend(take_filled(&mut run)),
        }
        previous = point;
    }
    runs.extend(take_filled(&mut run));
    runs
}

fn take_filled(run: &mut Vec<[f64; 2]>) -> Option<Vec<[f64; 2]>> {
    (!run.is_empty()).then(|| std::mem::take(run))
}

fn enlarged(view: &PlotBounds, margin: f64) -> PlotBounds {
    let (min, max) = (view.min(), view.max());
    let (width, height) = (margin * view.width(), margin * view.height());
    PlotBounds::from_min_max([min[0] - width, min[1] - height], [max[0] + width, max[1] + height])
}

/// Whether the rectangle spanned by two points meets `bounds`.
fn touches(a: [f64; 2], b: [f64; 2], bounds: &PlotBounds) -> bool {
    (0..2).all(|axis| a[axis].max(b[axis]) >= bounds.min()[axis] && a[axis].min(b[axis]) <= bounds.max()[axis])
}

/// The curve of a physics model with this number for a name.
#[cfg(test)]
pub(super) fn numbered(number: u64) -> CurveId {
    use gdcm_core::dataset::{BundleKind, ConditionId, ModelId};
    CurveId::Model(ModelId::new(ConditionId(1), BundleKind::Physics, number.to_string()))
}

/// A curve of three values, an octave apart, the same in both panes.
#[cfg(test)]
pub(super) fn sample_curve(id: u64, values: &[f64]) -> BodeCurve {
    let curve = BodeCurve::new(numbered(id), gdcm_files::figure::Role::Perturbed);
    curve.with(&vec![1.0, 2.0, 4.0].into(), &values.into(), &values.into())
}

/// The numbers that a pane showed of a curve.
#[derive(Clone, Debug)]
pub(super) struct CurveNumbers {
    omega: Arc<[f64]>,
    values: Arc<[f64]>,
}

impl CurveNumbers {
    /// Those of a curve.
    pub(super) fn of(curve: &BodeCurve, pane: Pane) -> Self {
        Self { omega: Arc::clone(&curve.omega), values: Arc::clone(curve.shared_values(pane)) }
    }

    /// Whether `curve` still has them: mostly they are in the same place in memory.
    pub(super) fn are_of(&self, curve: &BodeCurve, pane: Pane) -> bool {
        let same = |one: &Arc<[f64]>, other: &Arc<[f64]>| {
            // Gaps are not numbers: they are the same by their bits.
            let bits = |values: &Arc<[f64]>| {
                values.iter().map(|value| value.to_bits()).eq(other.iter().map(|value| value.to_bits()))
            };
            Arc::ptr_eq(one, other) || bits(one)
        };
        same(&self.values, curve.shared_values(pane)) && same(&self.omega, &curve.omega)
    }
}

/// What a curve of one or more runs of points is drawn of, in screen coordinates.
pub(super) fn curve_lines(
    runs: &[Vec<PlotPoint>],
    look: CurveStyle,
    transform: &PlotTransform,
    shapes: &mut Vec<Shape>,
) {
    for run in runs {
        let path: Vec<Pos2> = run.iter().map(|point| transform.position_from_point(point)).collect();
        look.add_shapes(path, shapes);
    }
}

/// Adds the shapes of something to those of a plot.
type Drawing<'a> = Box<dyn Fn(&PlotTransform, &mut Vec<Shape>) + 'a>;

/// Shapes among the items of a plot, which nobody points at: that is not egui_plot's business.
pub(super) struct DrawnItem<'a> {
    base: PlotItemBase,
    draw: Drawing<'a>,
}

impl<'a> DrawnItem<'a> {
    /// What `draw` adds to the shapes of the plot.
    pub(super) fn new(draw: impl Fn(&PlotTransform, &mut Vec<Shape>) + 'a) -> Self {
        Self { base: PlotItemBase::new(String::new()), draw: Box::new(draw) }
    }
}

impl PlotItem for DrawnItem<'_> {
    fn shapes(&self, _: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        (self.draw)(transform, shapes);
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        Color32::TRANSPARENT
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const UNIT: [[f64; 2]; 2] = [[0.0, 0.0], [1.0, 1.0]];

    fn unit_view() -> PlotBounds {
        PlotBounds::from_min_max(UNIT[0], UNIT[1])
    }

    proptest! {
        #[test]
        fn no_line_leads_across_a_gap(
            values in prop::collection::vec(prop_oneof![4 => 0.0..1.0f64, 1 => Just(f64::NAN), 1 => Just(f64::INFINITY)], 0..60)
        ) {
            let points: Vec<[f64; 2]> = values.iter().enumerate().map(|(k, value)| [k as f64 / 60.0, *value]).collect();
            let stretches = points.split(|point| !point[1].is_finite());
            // A single point between two gaps makes no line.
            let expected: Vec<Vec<[f64; 2]>> = stretches.filter(|run| run.len() > 1).map(<[_]>::to_vec).collect();
            prop_assert_eq!(runs_in_view(points.into_iter(), &unit_view(), 0.0), expected);
        }
    }

    #[test]
    fn a_gap_splits_a_curve_into_two() {
        let points = [0.1, 0.2, f64::NAN, 0.3, 0.4, f64::INFINITY].map(|x| [x, 0.5]);
        let runs = runs_in_view(points.into_iter(), &unit_view(), 0.0);
        assert_eq!(runs, [vec![[0.1, 0.5], [0.2, 0.5]], vec![[0.3, 0.5], [0.4, 0.5]]]);
    }

    #[test]
    fn what_is_far_outside_the_view_is_not_drawn() {
        let points = (-100..100).map(|k| [f64::from(k), 0.5]);
        for (margin, count) in [(0.0, 4), (1.0, 6)] {
            let runs = runs_in_view(points.clone(), &unit_view(), margin);
            assert_eq!(runs.len(), 1);
            assert_eq!(runs[0].len(), count, "those within, and one on either side to lead there");
        }
    }
}
