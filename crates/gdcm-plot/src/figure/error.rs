//! The errors that the fit sees: distance of a response from its reference, frequency by frequency
//! (M6).

use std::sync::Arc;

use gdcm_method::fidelity::{CoherenceWeights, Mismatch, Muad, leaves};
use gdcm_model::dataset::{BundleKind, Pair};
use gdcm_model::number_format::with_minus_sign;
use gdcm_model::response::curve_values::quantile;
use gdcm_model::response::frequency_response::PolarCurve;
use gdcm_model::response::{FrequencyResponse, GainDelay, wrap};
use gdcm_model::units::{ratio_to_db, s_to_ms};
use gdcm_study::ConditionAnalysis;
use gdcm_study::stages::condition_curves::ConditionCurves;

use super::axis::{Axis, PhaseErrorUnit};
use super::bode::{BodeOptions, FrequencyPanels, figure_of_pairs};
use super::condition_source::{ConditionSource, CorrectedModel, CurveId};
use super::figure::{Figure, Plot};
use super::responses::{BodeCurve, Level, Pane, ReferenceKind, ReferenceLine};
use super::role::Role;

/// Plots the errors that the fit sees for `pairs`: those of every kept physics model and of the
/// representative before and after its correction, with G, D and the bounds.
pub fn error_figure(source: &ConditionSource<'_>, pairs: &[Pair], options: &BodeOptions) -> Figure {
    figure_of_pairs(source, pairs, "Error", |pair| {
        let curves = source.error_curves(pair, options, &mut ErrorCache::default());
        let references = source.error_references(pair, options, &curves);
        let strips = noticed(&curves, options);
        let panels = FrequencyPanels {
            curves: &curves,
            references: &references,
            bands: &[],
            strips: &strips,
            options,
        };
        let ratio = Axis::linear("|ident.| / |model| [dB]")
            .including(0.0)
            .at_least(1.0)
            .showing(options.values[0]);
        let phase = match options.phase_error {
            PhaseErrorUnit::Degree => Axis::degrees("Δφ [deg]"),
            PhaseErrorUnit::Millisecond => Axis::linear("Δφ/ω [ms]"),
        };
        let phase = phase
            .including(0.0)
            .at_least(5.0)
            .showing(options.values[1]);
        Plot::default()
            .panel(panels.panel(Pane::Magnitude, ratio))
            .panel(panels.panel(Pane::Phase, phase))
    })
}

impl ConditionSource<'_> {
    /// Returns the errors over the band: of every kept physics model, of the representative after
    /// its own and after the scheduled correction, and the reference as the line at zero. `cache`
    /// keeps their numbers as long as nothing changes.
    pub fn error_curves(
        &self,
        pair: Pair,
        options: &BodeOptions,
        cache: &mut ErrorCache,
    ) -> Vec<BodeCurve> {
        let band = self.study.settings.band;
        let coherence = self.study.settings.coherence_threshold;
        let reference = self.reference();
        let unit = options.phase_error;
        let curves = Arc::clone(self.curves);
        cache.refresh(Made {
            curves,
            pair,
            reference,
            band: (band.min(), band.max()),
            coherence,
            unit,
        });
        let mut drawn = Vec::new();
        for model in self
            .models(BundleKind::Physics, options)
            .into_iter()
            .filter(|model| !model.rejected)
        {
            if let Some((_, error)) = &cache.errors[model.index] {
                drawn.push(self.curve_of(model).with(
                    &cache.omega,
                    &error.magnitude_db,
                    &error.phase,
                ));
            }
        }
        if !drawn.is_empty() {
            let identified = self.models(BundleKind::Identified, options).into_iter();
            let of_reference = identified.filter(|model| model.index == reference);
            drawn.extend(of_reference.map(|model| {
                self.curve_of(model)
                    .with(&cache.omega, &cache.zero, &cache.zero)
            }));
        }
        for CorrectedModel {
            curve,
            result,
            model,
            correction,
        } in self.corrected_models(pair, options)
        {
            let coupled = result
                .coupled
                .as_ref()
                .map(|_| cache.shape(&self.curves.with_couplings(result, model)));
            let shape = coupled
                .unwrap_or_else(|| cache.errors[model].as_ref().map(|(shape, _)| shape.clone()));
            if let Some(shape) = shape {
                let error = shape.drawn(correction, &cache.omega, unit);
                drawn.push(curve.with(&cache.omega, &error.magnitude_db, &error.phase));
            }
        }
        drawn
    }

    /// Returns G and D, the bounds of the channels, and quantiles of the representative's error
    /// among `drawn`, hidden or not: the values that the fit derives from it (M6, M7).
    pub fn error_references(
        &self,
        pair: Pair,
        options: &BodeOptions,
        drawn: &[BodeCurve],
    ) -> Vec<ReferenceLine> {
        let Some(analysis) = self.analysis else {
            return Vec::new();
        };
        let unit = options.phase_error;
        let mut lines = delta_rules(analysis, pair, unit);
        lines.extend(bound_rules(analysis, unit));
        let name = analysis.representative_name(BundleKind::Physics);
        let is_representative = |curve: &&BodeCurve| matches!(&curve.id, CurveId::Model(id) if id.bundle == BundleKind::Physics && id.name == name);
        if let Some(curve) = drawn.iter().find(is_representative) {
            lines.extend(quantile_rules(curve, self.study.settings.quantile, unit));
        }
        if let Some(curve) = drawn.first().filter(|_| options.shows_muad) {
            lines.extend(muad_rules(&curve.omega, unit));
        }
        lines
    }
}

/// Distance of one response from the reference, with the phase on its branch.
#[derive(Clone, Debug)]
struct ErrorShape {
    /// `20 log10 |H_sim| / |H_ref|`.
    mismatch_db: Vec<f64>,
    /// `Delta phi(H_sim, H_ref)` \[rad\] (M3, M6b): never a difference of two separately unwrapped
    /// phases.
    phase: Vec<f64>,
}

/// The error as drawn: `20 log10 |H_ref| / |H_sim|`, and `Delta phi` in degrees or `Delta phi /
/// omega` in milliseconds.
#[derive(Clone, Debug)]
struct DrawnError {
    magnitude_db: Arc<[f64]>,
    phase: Arc<[f64]>,
}

impl ErrorShape {
    /// Computes the error at the frequencies that count; NaN at the others (M4a). `None` if no
    /// frequency counts.
    fn of(
        simulated: &PolarCurve,
        reference: &PolarCurve,
        omega: &[f64],
        coherence_weights: Option<&CoherenceWeights>,
    ) -> Option<Self> {
        let mismatch = Mismatch::new(simulated, reference).coherence_weighted(coherence_weights)?;
        let phase = mismatch.on_grid(mismatch.phase_difference(omega), omega.len());
        Some(Self {
            phase,
            mismatch_db: mismatch.on_grid(mismatch.magnitude_db.clone(), omega.len()),
        })
    }

    /// Returns the drawn error after a gain and a delay of the simulated response (M10), which
    /// leave it on its branch.
    fn drawn(&self, correction: GainDelay, omega: &[f64], unit: PhaseErrorUnit) -> DrawnError {
        let phase = correction.phases(&self.phase, omega).zip(omega);
        DrawnError {
            magnitude_db: correction
                .magnitudes_db(&self.mismatch_db, omega)
                .map(|db| -db)
                .collect(),
            phase: match unit {
                PhaseErrorUnit::Degree => phase.map(|(phase, _)| phase.to_degrees()).collect(),
                PhaseErrorUnit::Millisecond => {
                    phase.map(|(phase, omega)| s_to_ms(phase / omega)).collect()
                }
            },
        }
    }
}

/// Sources of the errors.
#[derive(Clone, Debug)]
struct Made {
    curves: Arc<ConditionCurves>,
    pair: Pair,
    reference: usize,
    band: (f64, f64),
    /// Least coherence that counts.
    coherence: Option<f64>,
    unit: PhaseErrorUnit,
}

impl Made {
    fn is_same(&self, other: &Self) -> bool {
        let key = |made: &Self| {
            (
                made.pair,
                made.reference,
                made.band,
                made.coherence,
                made.unit,
            )
        };
        Arc::ptr_eq(&self.curves, &other.curves) && key(self) == key(other)
    }

    /// Returns the response of a model in the band; `None` if it is zero or not finite somewhere in
    /// it.
    fn polar(&self, response: &FrequencyResponse) -> Option<PolarCurve> {
        PolarCurve::of(response.curve(self.pair).get(self.within())?)
    }

    /// Computes the error of a response of the condition over `omega`, the band.
    fn shape(&self, response: &FrequencyResponse, omega: &[f64]) -> Option<ErrorShape> {
        let reference = self.polar(self.curves.identified.get(self.reference)?)?;
        ErrorShape::of(
            &self.polar(response)?,
            &reference,
            omega,
            self.coherence_weights(omega).as_ref(),
        )
    }

    /// Returns the frequencies among `omega` that count by the reference's coherence.
    fn coherence_weights(&self, omega: &[f64]) -> Option<CoherenceWeights> {
        let flight = &self
            .curves
            .condition
            .bundle(BundleKind::Identified)
            .get(self.reference)?
            .dynamics;
        Some(CoherenceWeights::of_model(flight, omega, self.coherence)?[self.pair].clone())
    }

    /// Returns the indices of the frequencies in the band.
    fn within(&self) -> std::ops::Range<usize> {
        let omega = self.curves.grid.omega();
        omega.partition_point(|omega| *omega < self.band.0)
            ..omega.partition_point(|omega| *omega <= self.band.1)
    }
}

/// Errors of every physics model of the displayed condition for one response, kept as long as
/// nothing changes.
#[derive(Debug, Default)]
pub struct ErrorCache {
    made: Option<Made>,
    omega: Arc<[f64]>,
    /// Zero at each frequency: the reference itself.
    zero: Arc<[f64]>,
    /// In the order of the physics models.
    errors: Vec<Option<(ErrorShape, DrawnError)>>,
}

impl ErrorCache {
    fn refresh(&mut self, made: Made) {
        if self
            .made
            .as_ref()
            .is_some_and(|before| before.is_same(&made))
        {
            return;
        }
        self.omega = made.curves.grid.omega()[made.within()].into();
        self.zero = vec![0.0; self.omega.len()].into();
        let error = |response: &Arc<FrequencyResponse>| {
            let shape = made.shape(response, &self.omega)?;
            let drawn = shape.drawn(GainDelay::NONE, &self.omega, made.unit);
            Some((shape, drawn))
        };
        self.errors = made.curves.physics.iter().map(error).collect();
        self.made = Some(made);
    }

    /// Computes the error of a response other than that of an unchanged model.
    fn shape(&self, response: &FrequencyResponse) -> Option<ErrorShape> {
        self.made.as_ref()?.shape(response, &self.omega)
    }
}

/// Returns the envelopes of unnoticeable added dynamics over the frequencies of an error
/// (MIL-STD-1797A). The envelopes are defined for model over reference: the drawn mismatch is the
/// inverse of that ratio, the drawn phase error is not.
fn muad_rules(omega: &[f64], unit: PhaseErrorUnit) -> Vec<ReferenceLine> {
    let phase = |omega: f64, degrees: f64| match unit {
        PhaseErrorUnit::Degree => degrees,
        PhaseErrorUnit::Millisecond => s_to_ms(degrees.to_radians() / omega),
    };
    let ends = [(0, "unnoticed below, MUAD"), (1, "unnoticed above, MUAD")];
    let rules = |(end, label): (usize, &str)| {
        [
            muad_line(Pane::Magnitude, label, omega, |_, omega| {
                -Muad::at(omega).magnitude_db[end]
            }),
            muad_line(Pane::Phase, label, omega, |_, omega| {
                phase(omega, Muad::at(omega).phase_deg[end])
            }),
        ]
    };
    ends.into_iter().flat_map(rules).collect()
}

/// Returns the same envelopes about the identified representative among `drawn`, hidden or not: a
/// pilot cannot tell a response within both from it. Empty unless requested.
pub fn muad_about(drawn: &[BodeCurve], options: &BodeOptions) -> Vec<ReferenceLine> {
    let identified = drawn
        .iter()
        .find(|curve| curve.role == Role::IdentifiedRepresentative);
    let Some(curve) = identified.filter(|_| options.shows_muad) else {
        return Vec::new();
    };
    let omega = &curve.omega;
    let magnitude_db = &curve.magnitude_db;
    let phase_deg = &curve.phase_deg;
    let ends = [(0, "unnoticed above, MUAD"), (1, "unnoticed below, MUAD")];
    let lines = |(end, label): (usize, &str)| {
        [
            muad_line(Pane::Magnitude, label, omega, |k, omega| {
                magnitude_db[k] + Muad::at(omega).magnitude_db[end]
            }),
            muad_line(Pane::Phase, label, omega, |k, omega| {
                phase_deg[k] + Muad::at(omega).phase_deg[end]
            }),
        ]
    };
    ends.into_iter().flat_map(lines).collect()
}

/// Draws an envelope over `omega` \[rad/s\]; `value` receives the index of a frequency and the
/// frequency.
fn muad_line(
    pane: Pane,
    label: &str,
    omega: &[f64],
    value: impl Fn(usize, f64) -> f64,
) -> ReferenceLine {
    let level = Level::Sampled(
        omega
            .iter()
            .enumerate()
            .map(|(k, &omega)| [omega, value(k, omega)])
            .collect(),
    );
    ReferenceLine::new(pane, ReferenceKind::Envelope, label, level)
}

/// Returns the frequency ranges \[rad/s\] in which the remaining mismatch of the corrected curve
/// among `drawn` would be noticed; empty unless requested.
pub fn noticed(drawn: &[BodeCurve], options: &BodeOptions) -> Vec<(f64, f64)> {
    let corrected = drawn
        .iter()
        .find(|curve| curve.id == CurveId::Corrected)
        .filter(|_| options.shows_muad);
    let Some(curve) = corrected else {
        return Vec::new();
    };
    let errors = curve
        .omega
        .iter()
        .zip(curve.magnitude_db.iter().zip(curve.phase_deg.iter()));
    let mut omega = Vec::new();
    let mut error_db = Vec::new();
    let mut principal_deg = Vec::new();
    // Frequencies that do not count have no error.
    for (&at, (&db, &phase)) in errors.filter(|(_, (db, _))| db.is_finite()) {
        let radians = match options.phase_error {
            PhaseErrorUnit::Degree => phase.to_radians(),
            PhaseErrorUnit::Millisecond => 1e-3 * phase * at,
        };
        omega.push(at);
        error_db.push(-db);
        principal_deg.push(wrap(radians).to_degrees());
    }
    leaves(&omega, &error_db, &principal_deg)
}

/// Draws a delay as a line in the pane of phase errors.
fn delay_rule(
    kind: ReferenceKind,
    label: String,
    delay_s: f64,
    unit: PhaseErrorUnit,
) -> ReferenceLine {
    let level = match unit {
        PhaseErrorUnit::Degree => Level::PerOmega(delay_s.to_degrees()),
        PhaseErrorUnit::Millisecond => Level::Constant(s_to_ms(delay_s)),
    };
    ReferenceLine::new(Pane::Phase, kind, label, level)
}

fn gain_rule(kind: ReferenceKind, label: String, gain: f64) -> ReferenceLine {
    ReferenceLine::new(
        Pane::Magnitude,
        kind,
        label,
        Level::Constant(ratio_to_db(gain)),
    )
}

fn signed(value: f64) -> String {
    with_minus_sign(&format!("{value:.1}"))
}

fn delta_rules(shown: &ConditionAnalysis, pair: Pair, unit: PhaseErrorUnit) -> Vec<ReferenceLine> {
    let gain = shown.wanted_gain(pair).map(|gain| {
        let label = format!("G {gain:.3} ({} dB)", signed(ratio_to_db(gain)));
        let note = ", median over the band".to_owned();
        ReferenceLine {
            note,
            ..gain_rule(ReferenceKind::Delta, label, gain)
        }
    });
    let delay = shown.wanted_delay_s(pair).map(|delay_s| {
        let meaning = if delay_s < 0.0 {
            ": lead is missing"
        } else {
            ""
        };
        let label = format!("D {} ms", signed(s_to_ms(delay_s)));
        ReferenceLine {
            note: meaning.to_owned(),
            ..delay_rule(ReferenceKind::Delta, label, delay_s, unit)
        }
    });
    gain.into_iter().chain(delay).collect()
}

fn bound_rules(shown: &ConditionAnalysis, unit: PhaseErrorUnit) -> Vec<ReferenceLine> {
    let bounds = shown.gain_bounds();
    let delay_s = shown.delay_upper_s();
    vec![
        gain_rule(
            ReferenceKind::Bound,
            format!("LB {:.3}", bounds.lower),
            bounds.lower,
        ),
        gain_rule(
            ReferenceKind::Bound,
            format!("UB {:.3}", bounds.upper),
            bounds.upper,
        ),
        delay_rule(
            ReferenceKind::Bound,
            format!("UB {} ms", signed(s_to_ms(delay_s))),
            delay_s,
            unit,
        ),
    ]
}

/// Returns the quantiles of one response's error: the values of M7 if there were no other
/// responses.
fn quantile_rules(curve: &BodeCurve, q: f64, unit: PhaseErrorUnit) -> Vec<ReferenceLine> {
    let delays = curve
        .omega
        .iter()
        .zip(curve.phase_deg.iter())
        .map(|(omega, phase)| match unit {
            PhaseErrorUnit::Degree => phase.to_radians() / omega,
            PhaseErrorUnit::Millisecond => 1e-3 * phase,
        });
    // Frequencies that do not count have no error.
    let finite = |values: &mut dyn Iterator<Item = f64>| {
        values
            .filter(|value| value.is_finite())
            .collect::<Vec<f64>>()
    };
    let mut ratios_db = finite(&mut curve.magnitude_db.iter().copied());
    let mut delays_s = finite(&mut { delays });
    let label = |q: f64| format!("{:.0} % quantile", 100.0 * q);
    [q, 1.0 - q]
        .into_iter()
        .flat_map(|q| {
            let level = Level::Constant(quantile(&mut ratios_db, q));
            [
                ReferenceLine::new(Pane::Magnitude, ReferenceKind::Quantile, label(q), level),
                delay_rule(
                    ReferenceKind::Quantile,
                    label(q),
                    quantile(&mut delays_s, q),
                    unit,
                ),
            ]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// Computes the error of a gain \[dB\] and a lead \[s\] over a reference response of 1.
    fn error(omega: &[f64], gain_db: f64, lead_s: f64) -> ErrorShape {
        let polar = |gain_db: f64, lead_s: f64| PolarCurve {
            magnitude_db: vec![gain_db; omega.len()],
            phase: omega.iter().map(|omega| wrap(omega * lead_s)).collect(),
        };
        ErrorShape::of(&polar(gain_db, lead_s), &polar(0.0, 0.0), omega, None).unwrap()
    }

    #[test]
    fn the_right_gain_and_delay_bring_an_error_to_zero_on_its_branch() {
        // At 12 rad/s the lead is 1.15 turns: the phases themselves wrap.
        let omega: Vec<f64> = (1..=120).map(|k| 0.1 * f64::from(k)).collect();
        let error = error(&omega, 2.0, 0.6);
        let before = error.drawn(GainDelay::NONE, &omega, PhaseErrorUnit::Millisecond);
        // Rounding of angles of a turn, divided by 0.1 rad/s.
        assert!(
            before
                .phase
                .iter()
                .all(|delay| (delay - 600.0).abs() < 1e-9)
                && omega[119] * 0.6 > TAU
        );
        assert_eq!(
            before.magnitude_db[0], -2.0,
            "the model is to be made smaller"
        );
        let after = error.drawn(
            GainDelay::new(10f64.powf(-0.1), 0.6),
            &omega,
            PhaseErrorUnit::Degree,
        );
        let values = after.magnitude_db.iter().chain(after.phase.iter());
        assert!(values.into_iter().all(|value| value.abs() < 1e-10));
    }

    #[test]
    fn frequencies_that_do_not_count_are_gaps() {
        let omega = [1.0, 2.0, 3.0];
        let polar = PolarCurve {
            magnitude_db: vec![1.0; 3],
            phase: vec![0.1; 3],
        };
        let coherence_weights = CoherenceWeights::of(&omega, &[0.9, 0.2, 0.9], 0.6, None);
        let shape = ErrorShape::of(&polar, &polar, &omega, Some(&coherence_weights)).unwrap();
        assert!(shape.mismatch_db[1].is_nan() && shape.phase[1].is_nan());
        assert_eq!((shape.mismatch_db[0], shape.phase[2]), (0.0, 0.0));
        let nothing = CoherenceWeights::of(&omega, &[0.0; 3], 0.6, None);
        assert!(ErrorShape::of(&polar, &polar, &omega, Some(&nothing)).is_none());
    }

    #[test]
    fn a_delay_is_a_ray_in_degrees_and_level_in_milliseconds() {
        let level = |unit| delay_rule(ReferenceKind::Delta, String::new(), 0.1, unit).level;
        assert_eq!(
            level(PhaseErrorUnit::Degree),
            Level::PerOmega(0.1f64.to_degrees())
        );
        assert_eq!(level(PhaseErrorUnit::Millisecond), Level::Constant(100.0));
    }

    #[test]
    fn the_envelopes_about_a_response_are_those_of_model_over_reference() {
        let omega: Arc<[f64]> = [2.0].into();
        let curve = BodeCurve::new(CurveId::Corrected, Role::IdentifiedRepresentative);
        let drawn = [curve.with(&omega, &[-6.0].into(), &[-90.0].into())];
        let options = BodeOptions {
            shows_muad: true,
            ..BodeOptions::default()
        };
        let muad = Muad::at(2.0);
        let expected: Vec<Level> = [0, 1]
            .into_iter()
            .flat_map(|end| [-6.0 + muad.magnitude_db[end], -90.0 + muad.phase_deg[end]])
            .map(|value| Level::Sampled(vec![[2.0, value]]))
            .collect();
        let lines = muad_about(&drawn, &options);
        assert_eq!(
            lines
                .iter()
                .map(|line| line.level.clone())
                .collect::<Vec<_>>(),
            expected
        );
        assert!(
            muad_about(&drawn, &BodeOptions::default()).is_empty(),
            "on wish"
        );
    }

    #[test]
    fn the_envelopes_of_model_over_reference_are_mirrored_where_the_inverse_is_drawn() {
        let muad = Muad::at(2.0);
        let rules = muad_rules(&[2.0], PhaseErrorUnit::Degree);
        let of = |pane| {
            rules
                .iter()
                .filter(move |rule| rule.pane == pane)
                .map(|rule| rule.level.clone())
        };
        let sampled = |value: f64| Level::Sampled(vec![[2.0, value]]);
        let expected = muad.magnitude_db.map(|db| sampled(-db));
        assert_eq!(of(Pane::Magnitude).collect::<Vec<_>>(), expected);
        assert_eq!(
            of(Pane::Phase).collect::<Vec<_>>(),
            muad.phase_deg.map(sampled)
        );
    }
}
