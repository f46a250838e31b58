//! Responses over frequency, as in a plot of magnitude above phase: the curves of every model of a
//! condition or of one model of every condition, reference lines, and areas around curves.

use std::sync::Arc;

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Band as BandOfComparison, BundleKind, Dataset, ModelId, Pair};
use gdcm_model::response::frequency_response::{ResponseShape, wrapped_deg};
use gdcm_model::response::{FrequencyResponse, GainDelay};
use gdcm_model::units::signed;
use gdcm_study::jobs::curve_jobs::AcrossCurves;
use gdcm_study::stages::condition_curves::{ConditionCurves, display_band};
use gdcm_study::{AcrossRole, Analysis};
use gdcm_sysid::identification::uncertainty::TWO_SIDED_95;

use super::axis::{PhaseUnit, Range};
use super::bode::BodeOptions;
use super::condition_source::{ConditionSource, CorrectedModel, CurveId};
use super::drawing::{Color, Dash, Hue, Stroke};
use super::role::Role;

/// Height that fitting reserves for values outside the band on either side, as a fraction of the
/// height within it.
const OUTSIDE_PART: f64 = 0.4;

impl ConditionSource<'_> {
    /// Returns every curve of one response, including hidden ones; phases are aligned with the
    /// reference. `cache` keeps their numbers, and their addresses in memory, as long as nothing
    /// changes.
    pub fn response_curves(
        &self,
        pair: Pair,
        options: &BodeOptions,
        cache: &mut ResponseCache,
    ) -> Vec<BodeCurve> {
        cache.refresh(
            self.curves,
            pair,
            self.reference(),
            self.study.settings.band,
        );
        let mut drawn = Vec::new();
        let mut draw = |cache: &ResponseCache, curve: BodeCurve, shape: ResponseShape| {
            let turns = options
                .turns
                .get(&(self.id(), pair, curve.id.clone()))
                .copied()
                .unwrap_or(0);
            let phase_deg = presented(&shape.phase_deg, options.phase, turns);
            drawn.push(moved_by_hand(curve, turns).with(
                &cache.omega,
                &shape.magnitude_db,
                &phase_deg,
            ));
        };
        for kind in BundleKind::BOTH {
            for model in self.models(kind, options) {
                let shape = cache.of_bundle(kind)[model.index].clone();
                draw(cache, self.curve_of(model), shape);
            }
        }
        for CorrectedModel {
            curve,
            result,
            model,
            correction,
        } in self.corrected_models(pair, options)
        {
            let shape = match &result.coupled {
                None => cache.physics[model].corrected(&cache.omega, correction),
                Some(_) => cache
                    .laid(&self.curves.with_couplings(result, model), pair)
                    .corrected(&cache.omega, correction),
            };
            draw(cache, curve, shape);
        }
        drawn
    }
}

/// Notes on a curve that its phase was moved up by `turns`.
fn moved_by_hand(mut curve: BodeCurve, turns: i32) -> BodeCurve {
    if turns != 0 {
        let moved = format!("phase {}°", signed(360.0 * f64::from(turns), 0));
        curve.detail = if curve.detail.is_empty() {
            moved
        } else {
            format!("{moved} · {}", curve.detail)
        };
    }
    curve
}

/// Shapes of every model of the displayed condition for one response, kept as long as neither
/// changes.
#[derive(Debug, Default)]
pub struct ResponseCache {
    made_of: Option<(Arc<ConditionCurves>, Pair, usize)>,
    omega: Arc<[f64]>,
    /// Reference for the phases, and the number of leading frequencies over which it applies.
    reference: Option<(ResponseShape, usize)>,
    physics: Vec<ResponseShape>,
    identified: Vec<ResponseShape>,
}

/// Returns a continuous phase \[deg\] as drawn, moved up by `turns`. A wrapped phase has a gap at
/// its jumps, instead of a line from edge to edge.
fn presented(phase_deg: &Arc<[f64]>, unit: PhaseUnit, turns: i32) -> Arc<[f64]> {
    match (unit, turns) {
        (PhaseUnit::Unwrapped, 0) => Arc::clone(phase_deg),
        (PhaseUnit::Unwrapped, _) => phase_deg
            .iter()
            .map(|phase| phase + 360.0 * f64::from(turns))
            .collect(),
        (PhaseUnit::Wrapped, _) => wrapped_deg(phase_deg).into(),
    }
}

impl ResponseCache {
    /// Computes the shapes of `pair`; phases are aligned with the identified model `reference`
    /// around the band. Identified models end beyond that range, where they carry no information.
    fn refresh(
        &mut self,
        curves: &Arc<ConditionCurves>,
        pair: Pair,
        reference: usize,
        band: BandOfComparison,
    ) {
        let same = |(made_of, of_pair, of_reference): &(Arc<ConditionCurves>, Pair, usize)| {
            Arc::ptr_eq(made_of, curves) && *of_pair == pair && *of_reference == reference
        };
        if self.made_of.as_ref().is_some_and(same) {
            return;
        }
        let reference_shape = curves
            .identified
            .get(reference)
            .map(|response| ResponseShape::of(response.curve(pair)));
        // The last frequency of a grid may exceed its end by a rounding error.
        let limit = display_band(band).max() * (1.0 + 1e-9);
        let points = curves.grid.omega().partition_point(|omega| *omega <= limit);
        self.reference = reference_shape.map(|shape| (shape, points));
        let shapes = |kind| {
            curves
                .bundle(kind)
                .iter()
                .map(|response| self.laid(response, pair))
                .collect::<Vec<_>>()
        };
        let physics = shapes(BundleKind::Physics);
        let identified = shapes(BundleKind::Identified);
        self.physics = physics;
        self.identified = identified
            .into_iter()
            .map(|shape| shape.first(points))
            .collect();
        self.omega = curves.grid.omega().into();
        self.made_of = Some((Arc::clone(curves), pair, reference));
    }

    /// Returns the shape of a response, with its phase aligned with the reference.
    fn laid(&self, response: &FrequencyResponse, pair: Pair) -> ResponseShape {
        let shape = ResponseShape::of(response.curve(pair));
        match &self.reference {
            Some((reference, points)) => shape.phase_aligned(reference, *points),
            None => shape,
        }
    }

    fn of_bundle(&self, kind: BundleKind) -> &[ResponseShape] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }
}

/// Returns the 95 % band of every identified model among `curves` that is drawn, is kept, and has
/// an uncertainty.
pub fn uncertainty_bands(dataset: &Dataset, pair: Pair, curves: &[BodeCurve]) -> Vec<BodeBand> {
    let band = |curve: &BodeCurve| {
        let CurveId::Model(id) = &curve.id else {
            return None;
        };
        let is_shown = id.bundle == BundleKind::Identified && !curve.rejected && !curve.hidden;
        let bands = dataset.model(id).filter(|_| is_shown)?.bands.as_ref()?;
        Some(band_around(curve, bands, pair))
    };
    curves.iter().filter_map(band).collect()
}

fn band_around(curve: &BodeCurve, bands: &ModelBands, pair: Pair) -> BodeBand {
    let db = &bands.sd_db()[pair];
    let deg = &bands.sd_deg()[pair];
    let mut band = BodeBand::default();
    for (index, omega) in curve.omega.iter().enumerate() {
        let Some((at, part)) = place(bands.omega(), *omega) else {
            continue;
        };
        let sd =
            |values: &[f64]| TWO_SIDED_95 * (values[at] + part * (values[at + 1] - values[at]));
        let around = |value: f64, half: f64| [value - half, value + half];
        band.omega.push(*omega);
        band.magnitude_db
            .push(around(curve.magnitude_db[index], sd(db)));
        band.phase_deg.push(around(curve.phase_deg[index], sd(deg)));
    }
    band
}

/// Returns the index of the interval of `omegas` that contains a frequency, and the logarithmic
/// fraction within it; `None` outside.
fn place(omegas: &[f64], omega: f64) -> Option<(usize, f64)> {
    let above = omegas.partition_point(|of| *of <= omega);
    let at = above.checked_sub(1)?;
    match omegas.get(above) {
        Some(next) => Some((at, (omega / omegas[at]).ln() / (next / omegas[at]).ln())),
        None if omegas[at] == omega && at > 0 => Some((at - 1, 1.0)),
        None => None,
    }
}

/// Shapes of one response of several models, kept as long as both stay the same.
#[derive(Debug, Default)]
pub struct AirspeedCache {
    made_of: Option<(Arc<AcrossCurves>, Pair)>,
    omega: Arc<[f64]>,
    shapes: Vec<(ModelId, ResponseShape)>,
}

impl AirspeedCache {
    /// Computes the shapes of `pair`; phases are aligned with the first model.
    fn refresh(&mut self, curves: &Arc<AcrossCurves>, pair: Pair) {
        if self
            .made_of
            .as_ref()
            .is_some_and(|(of, at)| Arc::ptr_eq(of, curves) && *at == pair)
        {
            return;
        }
        let mut first: Option<ResponseShape> = None;
        let shape = |(id, response): &(ModelId, Arc<FrequencyResponse>)| {
            let shape = ResponseShape::of(response.curve(pair));
            let shape = match &first {
                Some(first) => shape.phase_aligned(first, usize::MAX),
                None => shape,
            };
            first.get_or_insert_with(|| shape.clone());
            (id.clone(), shape)
        };
        self.shapes = curves.responses.iter().map(shape).collect();
        self.omega = curves.grid.omega().into();
        self.made_of = Some((Arc::clone(curves), pair));
    }
}

/// Returns one response of one model of each condition, in the colour of its airspeed, under the
/// correction of `role`; conditions without such a model are skipped.
pub fn airspeed_curves(
    (dataset, analysis): (&Dataset, Option<&Analysis>),
    role: AcrossRole,
    pair: Pair,
    curves: &Arc<AcrossCurves>,
    cache: &mut AirspeedCache,
) -> Vec<BodeCurve> {
    cache.refresh(curves, pair);
    let curve = |(id, shape): &(ModelId, ResponseShape)| {
        let state = dataset.condition(id.condition)?.flight_state();
        let correction = role.correction(id.condition, pair, analysis)?;
        let is_as_it_is = correction == GainDelay::NONE;
        let shape = if is_as_it_is {
            shape.clone()
        } else {
            shape.corrected(&cache.omega, correction)
        };
        let of_airspeed = Role::of_airspeed(state.airspeed_kt, dataset.airspeed_range_kt());
        let curve = BodeCurve {
            label: format!("condition {} · {:.0} kt", id.condition, state.airspeed_kt),
            detail: format!("{} · {}", state.name, id.name),
            ..BodeCurve::new(CurveId::Model(id.clone()), of_airspeed)
        };
        Some(curve.with(&cache.omega, &shape.magnitude_db, &shape.phase_deg))
    };
    cache.shapes.iter().filter_map(curve).collect()
}

/// Returns the range to show: all values within the band, and those outside it as far as they leave
/// room for the former.
pub fn fitted_values(curves: &[BodeCurve], pane: Pane, (min, max): (f64, f64)) -> Option<Range> {
    let points = || {
        curves
            .iter()
            .flat_map(|curve| curve.omega.iter().zip(curve.values(pane)))
    };
    let all = Range::of(points().map(|(_, value)| *value))?;
    let within = points().filter(|(omega, _)| (min..=max).contains(*omega));
    let Some(within) = Range::of(within.map(|(_, value)| *value)) else {
        return Some(all);
    };
    let room = within.with_margin(OUTSIDE_PART, 0.0);
    Some(Range::new(all.min.max(room.min), all.max.min(room.max)))
}

/// One of the two stacked plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pane {
    /// Upper pane \[dB\].
    Magnitude,
    /// Lower pane \[deg\].
    Phase,
}

/// A frequency response with its name and role.
#[derive(Clone, Debug)]
pub struct BodeCurve {
    /// Identifies the curve in events.
    pub id: CurveId,
    /// Name shown under the pointer.
    pub label: String,
    /// Second line shown under the pointer: details from the caller, and the effect of a click. May
    /// be empty.
    pub detail: String,
    pub role: Role,
    pub rejected: bool,
    /// Whether another view points at it.
    pub highlighted: bool,
    /// Whether the engineer hides it; the legend names its role all the same.
    pub hidden: bool,
    /// Frequencies \[rad/s\], ascending.
    pub omega: Arc<[f64]>,
    /// Magnitude \[dB\] at each frequency; a value that is not finite leaves a gap.
    pub magnitude_db: Arc<[f64]>,
    /// Phase \[deg\] at each frequency; a value that is not finite leaves a gap.
    pub phase_deg: Arc<[f64]>,
}

impl BodeCurve {
    /// Creates a curve of this role, without texts and numbers yet.
    pub fn new(id: CurveId, role: Role) -> Self {
        let label = String::new();
        let detail = String::new();
        let none = Arc::<[f64]>::default();
        let magnitude_db = Arc::clone(&none);
        let phase_deg = Arc::clone(&none);
        let rejected = false;
        let highlighted = false;
        let hidden = false;
        Self {
            id,
            label,
            detail,
            role,
            rejected,
            highlighted,
            hidden,
            omega: none,
            magnitude_db,
            phase_deg,
        }
    }

    /// Returns the curve with these numbers.
    pub fn with(
        self,
        omega: &Arc<[f64]>,
        magnitude_db: &Arc<[f64]>,
        phase_deg: &Arc<[f64]>,
    ) -> Self {
        let omega = Arc::clone(omega);
        let magnitude_db = Arc::clone(magnitude_db);
        let phase_deg = Arc::clone(phase_deg);
        Self {
            omega,
            magnitude_db,
            phase_deg,
            ..self
        }
    }

    /// Returns the values of this curve in a pane.
    pub fn values(&self, pane: Pane) -> &[f64] {
        self.shared_values(pane)
    }

    /// Returns [`Self::values`] with their owner, by which a holder can tell later whether they are
    /// unchanged.
    pub fn shared_values(&self, pane: Pane) -> &Arc<[f64]> {
        match pane {
            Pane::Magnitude => &self.magnitude_db,
            Pane::Phase => &self.phase_deg,
        }
    }

    /// Iterates over the points of a pane in plot coordinates, `[log10 omega, value]`; gaps are
    /// points that are not finite.
    pub fn points(&self, pane: Pane) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.omega
            .iter()
            .zip(self.values(pane))
            .map(|(omega, value)| [omega.log10(), *value])
    }

    /// Returns [`Self::points`], with logarithms computed once for all curves on the same
    /// frequencies.
    pub fn points_on<'a>(
        &'a self,
        axis: &'a mut LogFrequencies,
        pane: Pane,
    ) -> impl Iterator<Item = [f64; 2]> + 'a {
        axis.of(&self.omega)
            .iter()
            .zip(self.values(pane))
            .map(|(log_omega, value)| [*log_omega, *value])
    }

    /// Returns the points of [`Self::points_on`] from `low` to `high` in `log10 omega`, and one
    /// more on either side.
    pub fn points_between<'a>(
        &'a self,
        axis: &'a mut LogFrequencies,
        pane: Pane,
        (low, high): (f64, f64),
    ) -> impl Iterator<Item = [f64; 2]> + 'a {
        let log_omega = axis.of(&self.omega);
        let from = log_omega.partition_point(|at| *at < low).saturating_sub(1);
        let count = log_omega[from..].partition_point(|at| *at <= high) + 1;
        let points = log_omega
            .iter()
            .zip(self.values(pane))
            .skip(from)
            .take(count);
        points.map(|(log_omega, value)| [*log_omega, *value])
    }

    /// Returns the value at `omega` \[rad/s\], linear in `log10 omega` between points; `None`
    /// outside them or beside a gap.
    pub fn value_at(&self, pane: Pane, omega: f64) -> Option<f64> {
        let values = self.values(pane);
        let after = self.omega.partition_point(|at| *at < omega);
        let value = if self.omega.get(after) == Some(&omega) {
            *values.get(after)?
        } else {
            let before = after.checked_sub(1)?;
            let start = self.omega.get(before)?;
            let end = self.omega.get(after)?;
            let fraction = (omega / start).ln() / (end / start).ln();
            let from = values.get(before)?;
            let to = values.get(after)?;
            from + fraction * (to - from)
        };
        value.is_finite().then_some(value)
    }
}

/// Logarithms of the most recent frequencies: the curves of a scene mostly share theirs.
#[derive(Clone, Debug, Default)]
pub struct LogFrequencies {
    omega: Arc<[f64]>,
    log_omega: Vec<f64>,
}

impl LogFrequencies {
    /// Returns `log10` of each of `omega`.
    fn of(&mut self, omega: &Arc<[f64]>) -> &[f64] {
        if !Arc::ptr_eq(&self.omega, omega) {
            self.omega = Arc::clone(omega);
            self.log_omega = omega.iter().map(|omega| omega.log10()).collect();
        }
        &self.log_omega
    }
}

/// Frequency dependence of a reference line.
#[derive(Clone, Debug, PartialEq)]
pub enum Level {
    /// The same value everywhere.
    Constant(f64),
    /// Proportional to omega \[rad/s\]: the phase of a delay.
    PerOmega(f64),
    /// Samples: omega \[rad/s\] (ascending) and value.
    Sampled(Vec<[f64; 2]>),
}

impl Level {
    /// Points of a line that is not straight.
    const POINTS: usize = 80;

    /// Returns the value at omega \[rad/s\]; for a sampled level the value of the sample, NaN
    /// elsewhere.
    pub fn at(&self, omega: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::PerOmega(slope) => slope * omega,
            Self::Sampled(points) => points
                .iter()
                .find(|[at, _]| *at == omega)
                .map_or(f64::NAN, |[_, value]| *value),
        }
    }

    /// Returns the points of the line between two frequencies: `log10 omega` and value.
    pub fn points(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let log_omega =
            (0..=Self::POINTS).map(|point| from + (to - from) * point as f64 / Self::POINTS as f64);
        match self {
            Self::Constant(value) => vec![[from, *value], [to, *value]],
            Self::PerOmega(slope) => log_omega.map(|x| [x, slope * 10f64.powf(x)]).collect(),
            Self::Sampled(points) => points
                .iter()
                .map(|[omega, value]| [omega.log10(), *value])
                .collect(),
        }
    }
}

/// Meaning of a reference line, in the order in which labels are placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReferenceKind {
    /// Targets of the fit: G, D.
    Delta,
    /// A bound of the channels: LB, UB.
    Bound,
    /// A quantile over the band.
    Quantile,
    /// Envelope of unnoticeable added dynamics.
    Envelope,
}

impl ReferenceKind {
    /// Returns its style in the window.
    pub fn line(self) -> Stroke {
        match self {
            Self::Delta => Stroke::dashed(Color::INK, 0.9, Dash::Dotted),
            Self::Bound => Stroke::dashed(Color::of(Hue::Warning), 1.0, Dash::DashDot),
            Self::Quantile => Stroke::dashed(Color::DIM, 0.9, Dash::Short),
            Self::Envelope => Stroke::solid(Color::of(Hue::Good), 1.0),
        }
    }

    /// Returns its entry in the legend of a figure, for a line without a label there.
    pub fn key(self) -> &'static str {
        match self {
            Self::Delta => "delta gain, delta delay",
            Self::Bound => "bounds",
            Self::Quantile => "quantiles",
            Self::Envelope => "unnoticed within, MUAD",
        }
    }
}

/// A labelled line across a pane, for reading curves against it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceLine {
    pub pane: Pane,
    pub kind: ReferenceKind,
    /// Its label: "G 0.83 (−1.7 dB)".
    pub label: String,
    /// Additional text, shown if there is room: ", median over the band". May be empty.
    pub note: String,
    pub level: Level,
}

impl ReferenceLine {
    /// Creates a line with a label only.
    pub(super) fn new(
        pane: Pane,
        kind: ReferenceKind,
        label: impl Into<String>,
        level: Level,
    ) -> Self {
        Self {
            pane,
            kind,
            label: label.into(),
            note: String::new(),
            level,
        }
    }
}

/// Uncertainty band of a response about its curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeBand {
    /// Frequencies \[rad/s\], ascending.
    pub omega: Vec<f64>,
    /// Lower and upper magnitude \[dB\].
    pub magnitude_db: Vec<[f64; 2]>,
    /// Lower and upper phase \[deg\].
    pub phase_deg: Vec<[f64; 2]>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrapped_phase_stays_within_half_a_turn_and_has_a_gap_where_it_jumps() {
        let wrapped = presented(
            &vec![-100.0, -170.0, -190.0, -200.0].into(),
            PhaseUnit::Wrapped,
            0,
        );
        // Two rounding errors of angles below 360.
        assert!((wrapped[1] + 170.0).abs() < 1e-12 && (wrapped[3] - 160.0).abs() < 1e-12);
        assert!(wrapped[2].is_nan(), "{wrapped:?}");
    }

    #[test]
    fn a_turn_by_hand_moves_a_phase_by_360_degrees() {
        let up = presented(&vec![-100.0, f64::NAN].into(), PhaseUnit::Unwrapped, 1);
        assert!(up[0] == 260.0 && up[1].is_nan());
    }

    #[test]
    fn a_frequency_lies_between_two_by_its_logarithm_and_nowhere_outside() {
        let omegas = [1.0, 10.0, 100.0];
        assert_eq!(place(&omegas, 10.0), Some((1, 0.0)));
        let (at, part) = place(&omegas, 10f64.powf(1.5)).unwrap();
        assert!(at == 1 && (part - 0.5).abs() < 1e-12);
        assert_eq!(
            place(&omegas, 100.0),
            Some((1, 1.0)),
            "the last one belongs to the band"
        );
        assert_eq!((place(&omegas, 0.9), place(&omegas, 101.0)), (None, None));
    }

    fn fitted(magnitude_db: &[f64]) -> Option<Range> {
        let omega = vec![0.3, 0.5, 1.0, 10.0, 20.0].into();
        let curve = BodeCurve::new(CurveId::Corrected, Role::Perturbed);
        let curve = curve.with(&omega, &magnitude_db.into(), &magnitude_db.into());
        fitted_values(&[curve], Pane::Magnitude, (0.5, 12.0))
    }

    #[test]
    fn fitting_shows_all_that_is_within_the_band_and_what_is_near_it() {
        assert_eq!(
            fitted(&[2.0, 0.0, -5.0, -10.0, -12.0]),
            Some(Range::new(-12.0, 2.0))
        );
    }

    #[test]
    fn a_peak_outside_the_band_does_not_flatten_what_is_within() {
        assert_eq!(
            fitted(&[90.0, 0.0, -5.0, -10.0, -12.0]),
            Some(Range::new(-12.0, 10.0 * OUTSIDE_PART))
        );
    }

    #[test]
    fn without_values_in_the_band_all_are_shown() {
        assert_eq!(
            fitted(&[3.0, f64::NAN, f64::NAN, f64::NAN, -50.0]),
            Some(Range::new(-50.0, 3.0))
        );
        assert_eq!(fitted(&[f64::NAN; 5]), None);
    }

    fn curve(magnitude_db: &[f64]) -> BodeCurve {
        let omega: Vec<f64> = (0..magnitude_db.len())
            .map(|k| 10f64.powi(k as i32))
            .collect();
        let curve = BodeCurve::new(CurveId::Corrected, Role::Corrected);
        curve.with(&omega.into(), &magnitude_db.into(), &magnitude_db.into())
    }

    #[test]
    fn a_delay_takes_phase_in_proportion_to_frequency() {
        assert_eq!(
            Level::Constant(3.0).points(0.0, 1.0),
            [[0.0, 3.0], [1.0, 3.0]]
        );
        let points = Level::PerOmega(-2.0).points(0.0, 1.0);
        assert_eq!(
            (points.first(), points.last()),
            (Some(&[0.0, -2.0]), Some(&[1.0, -20.0]))
        );
        assert_eq!(
            Level::Sampled(vec![[100.0, 5.0]]).points(0.0, 1.0),
            [[2.0, 5.0]]
        );
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
            curve
                .points_between(&mut axis, Pane::Magnitude, (low, high))
                .map(|[x, _]| x)
                .collect()
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
