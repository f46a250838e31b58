//! A frequency response as the Bode plot draws it.

use std::ops::RangeInclusive;
use std::sync::Arc;

use egui::{Color32, Pos2, Shape, Ui};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};
pub use gdcm_files::figure::CurveId;

use super::curve_style::{CurveStyle, Role};

/// Which of the two stacked plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pane {
    /// Magnitude \[dB\], above.
    Magnitude,
    /// Phase \[deg\], below.
    Phase,
}

/// A frequency response with its name and its role.
#[derive(Clone, Debug)]
pub struct BodeCurve {
    /// How events name this curve.
    pub id: CurveId,
    /// The name that hovering shows.
    pub label: String,
    /// A second line for hovering: what the caller wants to say about it, and what a click does. May be empty.
    pub detail: String,
    /// What the curve stands for.
    pub role: Role,
    /// Whether the model is left out.
    pub rejected: bool,
    /// Whether another view points at it.
    pub highlighted: bool,
    /// Whether the engineer does not want to see it; the legend names its role all the same.
    pub hidden: bool,
    /// Frequencies \[rad/s\], ascending.
    pub omega: Arc<[f64]>,
    /// Magnitude \[dB\] at each frequency; a value that is not finite leaves a gap.
    pub magnitude_db: Arc<[f64]>,
    /// Phase \[deg\] at each frequency; a value that is not finite leaves a gap.
    pub phase_deg: Arc<[f64]>,
}

impl BodeCurve {
    /// What a pane shows of this curve.
    pub fn values(&self, pane: Pane) -> &[f64] {
        self.shared_values(pane)
    }

    /// [`Self::values`] with their owner: whoever holds it can tell later whether they are still the same.
    pub(super) fn shared_values(&self, pane: Pane) -> &Arc<[f64]> {
        match pane {
            Pane::Magnitude => &self.magnitude_db,
            Pane::Phase => &self.phase_deg,
        }
    }

    /// The points of a pane in plot coordinates, `[log10 omega, value]`; gaps are points that are not finite.
    pub fn points(&self, pane: Pane) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.omega.iter().zip(self.values(pane)).map(|(omega, value)| [omega.log10(), *value])
    }

    /// [`Self::points`], with logarithms taken once for all the curves on the same frequencies.
    pub(super) fn points_on<'a>(
        &'a self,
        axis: &'a mut LogFrequencies,
        pane: Pane,
    ) -> impl Iterator<Item = [f64; 2]> + 'a {
        axis.of(&self.omega).iter().zip(self.values(pane)).map(|(log_omega, value)| [*log_omega, *value])
    }

    /// Those of [`Self::points_on`] from `low` to `high` in `log10 omega`, and one on either side.
    pub(super) fn points_between<'a>(
        &'a self,
        axis: &'a mut LogFrequencies,
        pane: Pane,
        (low, high): (f64, f64),
    ) -> impl Iterator<Item = [f64; 2]> + 'a {
        let log_omega = axis.of(&self.omega);
        let from = log_omega.partition_point(|at| *at < low).saturating_sub(1);
        let count = log_omega[from..].partition_point(|at| *at <= high) + 1;
        let points = log_omega.iter().zip(self.values(pane)).skip(from).take(count);
        points.map(|(log_omega, value)| [*log_omega, *value])
    }

    /// The value at `omega` \[rad/s\], linear in `log10 omega` between points; nothing outside them or beside a gap.
    pub fn value_at(&self, pane: Pane, omega: f64) -> Option<f64> {
        let values = self.values(pane);
        let after = self.omega.partition_point(|at| *at < omega);
        let value = if self.omega.get(after) == Some(&omega) {
            *values.get(after)?
        } else {
            let before = after.checked_sub(1)?;
            let (start, end) = (self.omega.get(before)?, self.omega.get(after)?);
            let fraction = (omega / start).ln() / (end / start).ln();
            let (from, to) = (values.get(before)?, values.get(after)?);
            from + fraction * (to - from)
        };
        value.is_finite().then_some(value)
    }
}

/// The logarithms of the frequencies asked for last: the curves of a scene mostly share theirs.
#[derive(Clone, Debug, Default)]
pub(super) struct LogFrequencies {
    omega: Arc<[f64]>,
    log_omega: Vec<f64>,
}

impl LogFrequencies {
    /// `log10` of each of `omega`.
    fn of(&mut self, omega: &Arc<[f64]>) -> &[f64] {
        if !Arc::ptr_eq(&self.omega, omega) {
            self.omega = Arc::clone(omega);
            self.log_omega = omega.iter().map(|omega| omega.log10()).collect();
        }
        &self.log_omega
    }
}

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
    BodeCurve {
        id: numbered(id),
        label: String::new(),
        detail: String::new(),
        role: Role::Perturbed,
        rejected: false,
        highlighted: false,
        hidden: false,
        omega: vec![1.0, 2.0, 4.0].into(),
        magnitude_db: values.into(),
        phase_deg: values.into(),
    }
}

/// The numbers that a pane showed of a curve. They are held, so that no others can take their place in memory.
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

    /// Whether `curve` still has them: without looking at any.
    pub(super) fn are_of(&self, curve: &BodeCurve, pane: Pane) -> bool {
        Arc::ptr_eq(&self.values, curve.shared_values(pane)) && Arc::ptr_eq(&self.omega, &curve.omega)
    }
}

/// A curve of one or more runs of points, drawn as its look says. Pointing at it is not egui_plot's business.
pub(super) struct CurveItem<'a> {
    base: PlotItemBase,
    runs: &'a [Vec<PlotPoint>],
    look: CurveStyle,
}

impl<'a> CurveItem<'a> {
    /// The curve through each of `runs`.
    pub(super) fn new(runs: &'a [Vec<PlotPoint>], look: CurveStyle) -> Self {
        Self { base: PlotItemBase::new(String::new()), runs, look }
    }

    /// What it is drawn of, in screen coordinates.
    pub(super) fn lines(&self, transform: &PlotTransform) -> Vec<Shape> {
        let mut shapes = Vec::new();
        for run in self.runs {
            let path: Vec<Pos2> = run.iter().map(|point| transform.position_from_point(point)).collect();
            self.look.add_shapes(path, &mut shapes);
        }
        shapes
    }
}

impl PlotItem for CurveItem<'_> {
    fn shapes(&self, _: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        shapes.append(&mut self.lines(transform));
    }

    fn initialize(&mut self, _: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        self.look.color
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

    fn curve(magnitude_db: &[f64]) -> BodeCurve {
        let omega: Vec<f64> = (0..magnitude_db.len()).map(|k| 10f64.powi(k as i32)).collect();
        BodeCurve { omega: omega.into(), ..sample_curve(1, magnitude_db) }
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

    #[test]
    fn values_between_points_follow_the_logarithm_of_the_frequency() {
        let curve = curve(&[0.0, -20.0, -40.0]);
        let value = |omega| curve.value_at(Pane::Magnitude, omega);
        assert_eq!(value(10.0), Some(-20.0));
        assert!(value(10f64.sqrt()).is_some_and(|db| (db + 10.0).abs() < 1e-12));
        assert_eq!(value(0.5), None);
        assert_eq!(value(101.0), None);
    }

    #[test]
    fn points_between_two_frequencies_lead_to_both() {
        let curve = curve(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let mut axis = LogFrequencies::default();
        let mut between = |low, high| -> Vec<f64> {
            curve.points_between(&mut axis, Pane::Magnitude, (low, high)).map(|[x, _]| x).collect()
        };
        assert_eq!(between(1.5, 2.5), [1.0, 2.0, 3.0]);
        assert_eq!(between(2.0, 3.0), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(between(-9.0, 0.5), [0.0, 1.0]);
        assert_eq!(between(4.5, 9.0), [4.0, 5.0]);
        assert_eq!(between(7.0, 9.0), [5.0]);
    }

    #[test]
    fn there_is_no_value_beside_a_gap() {
        let curve = curve(&[0.0, f64::NAN, 3.0]);
        assert_eq!(curve.value_at(Pane::Phase, 10.0), None);
        assert_eq!(curve.value_at(Pane::Phase, 30.0), None);
        assert_eq!(curve.value_at(Pane::Phase, 100.0), Some(3.0));
    }
}
