//! A response's curves for every model in a condition, and the range that fits them. Cached from
//! one drawn frame to the next.
//!
//! A [`ConditionSource`] holds the condition's models and results. The *representative* of the
//! physics or identified models is the one closest to the others, or the engineer's choice (M5).

use std::sync::Arc;

use gdcm_model::dataset::{Band, BundleKind, ConditionId, Pair};
use gdcm_model::response::FrequencyResponse;
use gdcm_model::response::response_shape::{ResponseShape, wrapped_deg};
use gdcm_model::units::signed;
use gdcm_study::stages::condition_curves::{ConditionCurves, display_band};

pub use super::airspeed_curves::{AirspeedCache, AirspeedCurves, AirspeedResponse, line_of};
pub use super::bode_curve::{BodeCurve, LogFrequencies, Pane};
pub use super::reference_line::{Level, ReferenceKind, ReferenceLine};
pub use super::uncertainty_band::{BodeBand, uncertainty_bands};

use super::axis::{PhaseUnit, Range};
use super::bode_options::BodeOptions;
use super::condition_source::ConditionSource;

/// How far a fitted range may extend at either end for values outside the band, relative to the
/// range within the band.
const OUTSIDE_PART: f64 = 0.4;

impl ConditionSource<'_> {
    /// Returns every curve for a response, including hidden curves: all models, then the
    /// representative physics model after each correction. Phases are aligned with the reference,
    /// the representative identified model. `cache` keeps the computed slices, at the same address,
    /// until their sources change.
    pub fn response_curves(
        &self,
        pair: Pair,
        options: &BodeOptions,
        cache: &mut ResponseCache,
    ) -> Vec<BodeCurve> {
        let source = ResponseSource {
            curves: Arc::clone(self.curves),
            pair,
            reference: self.reference_index(),
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
            let shape = if corrected.result.has_changed_physics() {
                let curves = self.curves;
                let coupled = curves.with_couplings(corrected.result, corrected.model);
                let shape = cache.aligned_shape(&coupled, pair);
                shape.corrected(&cache.omega, correction)
            } else {
                cache.physics[corrected.model].corrected(&cache.omega, correction)
            };
            drawn.push(presentation.curve(corrected.curve, &shape));
        }
        drawn
    }
}

/// Settings that affect how a condition's response is displayed.
struct Presentation<'a> {
    condition: ConditionId,
    pair: Pair,
    options: &'a BodeOptions,
    /// Frequencies common to all shapes \[rad/s\].
    omega: &'a Arc<[f64]>,
}

impl Presentation<'_> {
    /// Returns a curve with the values from a shape; its phase is wrapped, or unwrapped and shifted
    /// by whole turns, as chosen.
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

/// Puts the phase shift by `turns`, if any, before a curve's detail.
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

/// Data from which a response's shapes are computed.
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
    /// Leading frequencies over which phases are compared.
    points: usize,
}

/// A response's shapes for every model in a condition, kept until their source changes.
#[derive(Debug, Default)]
pub struct ResponseCache {
    source: Option<ResponseSource>,
    omega: Arc<[f64]>,
    reference: Option<PhaseReference>,
    physics: Vec<ResponseShape>,
    identified: Vec<ResponseShape>,
}

impl ResponseCache {
    /// Returns whether the shapes were computed from these curves. A cache keeps its curves in
    /// memory.
    pub fn is_from(&self, curves: &Arc<ConditionCurves>) -> bool {
        match &self.source {
            Some(source) => Arc::ptr_eq(&source.curves, curves),
            None => false,
        }
    }

    /// Computes a response's shapes, unless they are known. Phases are aligned with the reference
    /// up to the limit of the displayed band. The identified models' curves end at this limit,
    /// because they carry no information beyond it.
    fn refresh(&mut self, source: ResponseSource, band: Band) {
        if let Some(known) = &self.source
            && known.is_same(&source)
        {
            return;
        }
        let curves = &source.curves;
        // A grid's last frequency may exceed its limit by a rounding error.
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
            .map(|shape| shape.first_points(points))
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

    /// Returns a response's shape, with its phase aligned with the reference.
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

/// Returns a range that contains all values within the frequency band `band` \[rad/s\]. It is
/// extended to values outside the band, by at most 40 % of its height at either end. If no value
/// lies in the band, all values are fitted; `None` without finite values.
pub fn fitted_values(curves: &[BodeCurve], pane: Pane, band: Range) -> Option<Range> {
    let mut everywhere = Vec::new();
    let mut inside = Vec::new();
    for curve in curves {
        for (omega, value) in curve.omega.iter().zip(curve.values(pane)) {
            everywhere.push(*value);
            if band.contains(*omega) {
                inside.push(*value);
            }
        }
    }
    let everywhere = Range::spanning(everywhere)?;
    let Some(inside) = Range::spanning(inside) else {
        return Some(everywhere);
    };
    let room = inside.with_margin(OUTSIDE_PART, 0.0);
    Some(Range::new(
        everywhere.min.max(room.min),
        everywhere.max.min(room.max),
    ))
}

#[cfg(test)]
mod tests {
    use super::super::bode_curve::CurveId;
    use super::super::role::Role;
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

    fn fitted(magnitude_db: &[f64]) -> Option<Range> {
        let omega = vec![0.3, 0.5, 1.0, 10.0, 20.0].into();
        let curve = BodeCurve::new(CurveId::Corrected, Role::Perturbed);
        let curve = curve.with(&omega, &magnitude_db.into(), &magnitude_db.into());
        fitted_values(&[curve], Pane::Magnitude, Range::new(0.5, 12.0))
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
