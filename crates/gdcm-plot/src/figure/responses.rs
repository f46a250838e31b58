//! Curves of a response, for every model of a condition or for one model in every condition, and
//! the uncertainty bands about them.

use std::sync::Arc;

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{
    Band as BandOfComparison, BundleKind, ConditionId, Dataset, ModelId, Pair,
};
use gdcm_model::response::frequency_response::{ResponseShape, wrapped_deg};
use gdcm_model::response::{FrequencyResponse, GainDelay};
use gdcm_model::units::signed;
use gdcm_study::jobs::curve_jobs::AcrossCurves;
use gdcm_study::stages::condition_curves::{ConditionCurves, display_band};
use gdcm_study::{AcrossRole, Analysis};
use gdcm_sysid::diagnostics::bands::TWO_SIDED_95;

pub use super::bode_curve::{BodeCurve, LogFrequencies, Pane};
pub use super::reference_line::{Level, ReferenceKind, ReferenceLine};

use super::axis::{PhaseUnit, Range};
use super::bode_curve::CurveId;
use super::bode_options::BodeOptions;
use super::condition_source::ConditionSource;
use super::role::Role;

/// Maximum extension of a fitted range at either end for values outside the band, relative to the
/// range within the band.
const OUTSIDE_PART: f64 = 0.4;

impl ConditionSource<'_> {
    /// Returns every curve of a response, including hidden curves; phases are aligned with the
    /// reference. `cache` keeps the computed slices, at the same address, until their sources
    /// change.
    pub fn response_curves(
        &self,
        pair: Pair,
        options: &BodeOptions,
        cache: &mut ResponseCache,
    ) -> Vec<BodeCurve> {
        let source = ResponseSource {
            curves: Arc::clone(self.curves),
            pair,
            reference: self.reference(),
        };
        cache.refresh(source, self.study.settings.band);
        let presentation = Presentation {
            condition: self.id(),
            pair,
            options,
            omega: &cache.omega,
        };
        let mut drawn = Vec::new();
        for kind in BundleKind::BOTH {
            for model in self.models(kind, options) {
                let shape = &cache.bundle(kind)[model.index];
                drawn.push(presentation.curve(self.curve_of(model), shape));
            }
        }
        for corrected in self.corrected_models(pair, options) {
            let correction = corrected.correction;
            let shape = match &corrected.result.coupled {
                None => cache.physics[corrected.model].corrected(&cache.omega, correction),
                Some(_) => {
                    let curves = self.curves;
                    let coupled = curves.with_couplings(corrected.result, corrected.model);
                    let shape = cache.aligned_shape(&coupled, pair);
                    shape.corrected(&cache.omega, correction)
                }
            };
            drawn.push(presentation.curve(corrected.curve, &shape));
        }
        drawn
    }
}

/// Settings for the display of a response in a condition.
struct Presentation<'a> {
    condition: ConditionId,
    pair: Pair,
    options: &'a BodeOptions,
    /// Frequencies of all shapes \[rad/s\].
    omega: &'a Arc<[f64]>,
}

impl Presentation<'_> {
    /// Returns a curve with the values of a shape; its phase is displayed as chosen, and shifted by
    /// whole turns.
    fn curve(&self, curve: BodeCurve, shape: &ResponseShape) -> BodeCurve {
        let key = (self.condition, self.pair, curve.id.clone());
        let turns = self.options.turns.get(&key).copied().unwrap_or(0);
        let phase_deg = displayed_phase(&shape.phase_deg, self.options.phase, turns);
        noted_turns(curve, turns).with(self.omega, &shape.magnitude_db, &phase_deg)
    }
}

/// Returns the phase \[deg\] as drawn. An unwrapped phase is shifted up by `turns`; a wrapped phase
/// has a gap at each jump, which avoids a line across the plot.
fn displayed_phase(phase_deg: &Arc<[f64]>, unit: PhaseUnit, turns: i32) -> Arc<[f64]> {
    match (unit, turns) {
        (PhaseUnit::Unwrapped, 0) => Arc::clone(phase_deg),
        (PhaseUnit::Unwrapped, _) => phase_deg
            .iter()
            .map(|phase| phase + 360.0 * f64::from(turns))
            .collect(),
        (PhaseUnit::Wrapped, _) => wrapped_deg(phase_deg).into(),
    }
}

/// Adds a note on the phase shift by `turns` to the detail of a curve.
fn noted_turns(mut curve: BodeCurve, turns: i32) -> BodeCurve {
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

/// Data from which the shapes of a response are computed.
#[derive(Debug)]
struct ResponseSource {
    curves: Arc<ConditionCurves>,
    pair: Pair,
    /// Index of the identified model with which phases are aligned.
    reference: usize,
}

impl ResponseSource {
    fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.curves, &other.curves)
            && self.pair == other.pair
            && self.reference == other.reference
    }
}

/// Response with which phases are aligned.
#[derive(Debug)]
struct PhaseReference {
    shape: ResponseShape,
    /// Number of leading frequencies over which phases are compared.
    points: usize,
}

/// Shapes of a response for every model of a condition, kept until their source changes.
#[derive(Debug, Default)]
pub struct ResponseCache {
    source: Option<ResponseSource>,
    omega: Arc<[f64]>,
    reference: Option<PhaseReference>,
    physics: Vec<ResponseShape>,
    identified: Vec<ResponseShape>,
}

impl ResponseCache {
    /// Computes the shapes of a response. Phases are aligned with the reference up to the limit of
    /// the displayed band. The curves of identified models end there, because they carry no
    /// information beyond.
    fn refresh(&mut self, source: ResponseSource, band: BandOfComparison) {
        if let Some(known) = &self.source
            && known.is_same(&source)
        {
            return;
        }
        let curves = &source.curves;
        // The last frequency of a grid may exceed its limit by a rounding error.
        let limit = display_band(band).max() * (1.0 + 1e-9);
        let points = curves.grid.omega().partition_point(|omega| *omega <= limit);
        self.reference = curves
            .identified
            .get(source.reference)
            .map(|response| PhaseReference {
                shape: ResponseShape::new(response.curve(source.pair)),
                points,
            });
        self.physics = self.aligned_shapes(&source, BundleKind::Physics);
        self.identified = self
            .aligned_shapes(&source, BundleKind::Identified)
            .into_iter()
            .map(|shape| shape.first(points))
            .collect();
        self.omega = curves.grid.omega().into();
        self.source = Some(source);
    }

    fn aligned_shapes(&self, source: &ResponseSource, kind: BundleKind) -> Vec<ResponseShape> {
        source
            .curves
            .bundle(kind)
            .iter()
            .map(|response| self.aligned_shape(response, source.pair))
            .collect()
    }

    /// Returns the shape of a response, with its phase aligned with the reference.
    fn aligned_shape(&self, response: &FrequencyResponse, pair: Pair) -> ResponseShape {
        let shape = ResponseShape::new(response.curve(pair));
        match &self.reference {
            Some(reference) => shape.phase_aligned(&reference.shape, reference.points),
            None => shape,
        }
    }

    fn bundle(&self, kind: BundleKind) -> &[ResponseShape] {
        match kind {
            BundleKind::Physics => &self.physics,
            BundleKind::Identified => &self.identified,
        }
    }
}

/// Uncertainty band about a curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodeBand {
    /// Frequencies \[rad/s\], ascending.
    pub omega: Vec<f64>,
    /// Lower and upper magnitude \[dB\].
    pub magnitude_db: Vec<[f64; 2]>,
    /// Lower and upper phase \[deg\].
    pub phase_deg: Vec<[f64; 2]>,
}

/// Returns the 95 % band of every identified model among `curves` that is visible, kept, and has an
/// uncertainty.
pub fn uncertainty_bands(dataset: &Dataset, pair: Pair, curves: &[BodeCurve]) -> Vec<BodeBand> {
    let mut bands = Vec::new();
    for curve in curves {
        if let CurveId::Model(id) = &curve.id
            && id.bundle == BundleKind::Identified
            && !curve.rejected
            && !curve.hidden
            && let Some(model) = dataset.model(id)
            && let Some(deviations) = &model.bands
        {
            bands.push(band_about(curve, deviations, pair));
        }
    }
    bands
}

/// Returns the band about a curve, at the frequencies within the grid of the deviations.
fn band_about(curve: &BodeCurve, deviations: &ModelBands, pair: Pair) -> BodeBand {
    let sd_db = &deviations.sd_db()[pair];
    let sd_deg = &deviations.sd_deg()[pair];
    let mut band = BodeBand::default();
    for (index, omega) in curve.omega.iter().enumerate() {
        let Some(place) = GridPlace::find(deviations.omega(), *omega) else {
            continue;
        };
        let db = curve.magnitude_db[index];
        let half_db = TWO_SIDED_95 * place.interpolate(sd_db);
        let deg = curve.phase_deg[index];
        let half_deg = TWO_SIDED_95 * place.interpolate(sd_deg);
        band.omega.push(*omega);
        band.magnitude_db.push([db - half_db, db + half_db]);
        band.phase_deg.push([deg - half_deg, deg + half_deg]);
    }
    band
}

/// Position of a frequency between two neighbouring grid points.
#[derive(Clone, Copy, Debug, PartialEq)]
struct GridPlace {
    /// Index of the lower neighbour.
    lower: usize,
    /// Distance from the lower neighbour in `log omega`, as a fraction of the grid interval.
    part: f64,
}

impl GridPlace {
    /// Finds `omega` in a grid of ascending frequencies; `None` outside the grid.
    fn find(grid: &[f64], omega: f64) -> Option<Self> {
        let upper = grid.partition_point(|at| *at <= omega);
        let lower = upper.checked_sub(1)?;
        match grid.get(upper) {
            Some(next) => Some(Self {
                lower,
                part: (omega / grid[lower]).ln() / (next / grid[lower]).ln(),
            }),
            // The last frequency of the grid counts as the end of the last interval.
            None if grid[lower] == omega && lower > 0 => Some(Self {
                lower: lower - 1,
                part: 1.0,
            }),
            None => None,
        }
    }

    /// Interpolates linearly between values given on the grid.
    fn interpolate(self, values: &[f64]) -> f64 {
        let low = values[self.lower];
        low + self.part * (values[self.lower + 1] - low)
    }
}

/// Shape of a response of a model, in one of the conditions.
#[derive(Debug)]
struct ModelShape {
    id: ModelId,
    shape: ResponseShape,
}

/// Data from which the shapes of a response in several conditions are computed.
#[derive(Debug)]
struct AirspeedSource {
    curves: Arc<AcrossCurves>,
    pair: Pair,
}

/// Shapes of a response of one model in each condition, kept until their source changes.
#[derive(Debug, Default)]
pub struct AirspeedCache {
    source: Option<AirspeedSource>,
    omega: Arc<[f64]>,
    shapes: Vec<ModelShape>,
}

impl AirspeedCache {
    /// Computes the shapes of a response; phases are aligned with the first model.
    fn refresh(&mut self, curves: &Arc<AcrossCurves>, pair: Pair) {
        if let Some(known) = &self.source
            && Arc::ptr_eq(&known.curves, curves)
            && known.pair == pair
        {
            return;
        }
        self.shapes.clear();
        for (id, response) in &curves.responses {
            let mut shape = ResponseShape::new(response.curve(pair));
            if let Some(first) = self.shapes.first() {
                shape = shape.phase_aligned(&first.shape, usize::MAX);
            }
            self.shapes.push(ModelShape {
                id: id.clone(),
                shape,
            });
        }
        self.omega = curves.grid.omega().into();
        self.source = Some(AirspeedSource {
            curves: Arc::clone(curves),
            pair,
        });
    }
}

/// Returns a response in each condition, coloured by airspeed; `role` selects the model and its
/// correction. Conditions without the model or the correction are skipped.
pub fn airspeed_curves(
    (dataset, analysis): (&Dataset, Option<&Analysis>),
    role: AcrossRole,
    pair: Pair,
    curves: &Arc<AcrossCurves>,
    cache: &mut AirspeedCache,
) -> Vec<BodeCurve> {
    cache.refresh(curves, pair);
    let mut drawn = Vec::new();
    for ModelShape { id, shape } in &cache.shapes {
        let Some(condition) = dataset.condition(id.condition) else {
            continue;
        };
        let Some(correction) = role.correction(id.condition, pair, analysis) else {
            continue;
        };
        let shape = if correction == GainDelay::NONE {
            shape.clone()
        } else {
            shape.corrected(&cache.omega, correction)
        };
        let state = condition.flight_state();
        let (slowest_kt, fastest_kt) = dataset.airspeed_range_kt();
        let color_role = Role::of_airspeed(state.airspeed_kt, slowest_kt, fastest_kt);
        let curve = BodeCurve {
            label: format!("condition {} · {:.0} kt", id.condition, state.airspeed_kt),
            detail: format!("{} · {}", state.name, id.name),
            ..BodeCurve::new(CurveId::Model(id.clone()), color_role)
        };
        drawn.push(curve.with(&cache.omega, &shape.magnitude_db, &shape.phase_deg));
    }
    drawn
}

/// Returns a range that contains all values within the frequency band \[rad/s\]. It is extended to
/// values outside the band, by at most 40 % of its height at either end. If no value lies in the
/// band, all values are fitted; `None` without finite values.
pub fn fitted_values(curves: &[BodeCurve], pane: Pane, (min, max): (f64, f64)) -> Option<Range> {
    let mut all = Vec::new();
    let mut inside = Vec::new();
    for curve in curves {
        for (omega, value) in curve.omega.iter().zip(curve.values(pane)) {
            all.push(*value);
            if (min..=max).contains(omega) {
                inside.push(*value);
            }
        }
    }
    let all = Range::of(all)?;
    let Some(inside) = Range::of(inside) else {
        return Some(all);
    };
    let room = inside.with_margin(OUTSIDE_PART, 0.0);
    Some(Range::new(all.min.max(room.min), all.max.min(room.max)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrapped_phase_stays_within_half_a_turn_and_has_a_gap_at_a_jump() {
        let wrapped = displayed_phase(
            &vec![-100.0, -170.0, -190.0, -200.0].into(),
            PhaseUnit::Wrapped,
            0,
        );
        // Tolerance: two rounding errors of angles below 360 degrees.
        assert!((wrapped[1] + 170.0).abs() < 1e-12 && (wrapped[3] - 160.0).abs() < 1e-12);
        assert!(wrapped[2].is_nan(), "{wrapped:?}");
    }

    #[test]
    fn a_turn_by_hand_moves_a_phase_by_360_degrees() {
        let up = displayed_phase(&vec![-100.0, f64::NAN].into(), PhaseUnit::Unwrapped, 1);
        assert!(up[0] == 260.0 && up[1].is_nan());
    }

    #[test]
    fn a_frequency_lies_between_two_by_its_logarithm_and_nowhere_outside() {
        let grid = [1.0, 10.0, 100.0];
        let exact = GridPlace {
            lower: 1,
            part: 0.0,
        };
        assert_eq!(GridPlace::find(&grid, 10.0), Some(exact));
        let between = GridPlace::find(&grid, 10f64.powf(1.5)).unwrap();
        assert!(between.lower == 1 && (between.part - 0.5).abs() < 1e-12);
        let last = GridPlace {
            lower: 1,
            part: 1.0,
        };
        assert_eq!(GridPlace::find(&grid, 100.0), Some(last));
        assert_eq!(GridPlace::find(&grid, 0.9), None);
        assert_eq!(GridPlace::find(&grid, 101.0), None);
    }

    fn fitted(magnitude_db: &[f64]) -> Option<Range> {
        let omega = vec![0.3, 0.5, 1.0, 10.0, 20.0].into();
        let curve = BodeCurve::new(CurveId::Corrected, Role::Perturbed);
        let curve = curve.with(&omega, &magnitude_db.into(), &magnitude_db.into());
        fitted_values(&[curve], Pane::Magnitude, (0.5, 12.0))
    }

    #[test]
    fn fitting_shows_all_values_within_the_band_and_those_near_them() {
        assert_eq!(
            fitted(&[2.0, 0.0, -5.0, -10.0, -12.0]),
            Some(Range::new(-12.0, 2.0))
        );
    }

    #[test]
    fn a_peak_outside_the_band_does_not_flatten_the_values_within() {
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
}
