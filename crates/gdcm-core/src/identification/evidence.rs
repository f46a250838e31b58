//! What models are made from and judged by, in scaled units.

use super::identification_caution::IdentificationCaution;
use super::likelihood::{Likelihood, Lines};
use super::local_polynomial::is_measurable;
use super::steps::Steps;
use super::{
    CutOff, FlightRecord, IdentificationError, LocalPolynomialError, MeasuredResponse, NoiseCovariance, Options, Piece,
    RecordUse, Role, Scales, Signal, Spectrum, local_polynomial, log_spaced, prepare, spectra,
};
use crate::executor::Executor;
use nalgebra::DMatrix;

/// Points of the measured response.
const MEASURED_POINTS: usize = 40;
/// Lines for the measured response reach this factor beyond those used, at both ends.
const BEYOND: f64 = 1.3;
/// Condition number of the inputs' correlations above which one is a copy of the others.
const COPY: f64 = 1e9;

/// Records, prepared, transformed and weighed.
pub(super) struct PreparedData<'a> {
    /// What was used of every record.
    pub(super) record_uses: Vec<RecordUse>,
    /// Units of the records over scaled units.
    pub(super) scales: Scales,
    /// Pieces to fit, low-passed for the projections.
    pub(super) pieces: Vec<Piece>,
    /// Held-out pieces in the units of the records.
    pub(super) held_out_pieces: Vec<Piece>,
    /// Lines to fit.
    pub(super) spectra: Vec<Spectrum>,
    /// The response without a model.
    pub(super) measured: MeasuredResponse,
    /// The noise that it leaves.
    pub(super) noise: NoiseCovariance,
    /// The cost over the records of the fit.
    pub(super) likelihood: Likelihood<'a>,
    /// The cost over the held-out records.
    pub(super) held_out: Likelihood<'a>,
    /// What speaks against the records.
    pub(super) cautions: Vec<IdentificationCaution>,
}

impl<'a> PreparedData<'a> {
    /// Prepares the records, measures the response and the noise, and filters for the projections (M14, sections 1 and 2).
    pub(super) fn new(
        records: &[FlightRecord],
        options: &Options,
        executor: &'a dyn Executor,
        steps: &Steps,
    ) -> Result<Self, IdentificationError> {
        if let Some(&record) = options.held_out.iter().find(|record| **record >= records.len()) {
            return Err(IdentificationError::HeldOutMissing { record, records: records.len() });
        }
        let prepared = prepare(records, &options.preparation, executor)?;
        check_sampling(&prepared.pieces, options)?;
        let (held_out_pieces, pieces): (Vec<Piece>, Vec<Piece>) =
            prepared.pieces.into_iter().partition(|piece| options.held_out.contains(&piece.record));
        if pieces.is_empty() {
            return Err(IdentificationError::NothingToFit);
        }
        let scales = Scales::of(&pieces)?;
        let scaled = |pieces: &[Piece]| pieces.iter().map(|piece| scales.scaled(piece)).collect::<Vec<_>>();
        let pieces = scaled(&pieces);
        check_inputs(&pieces, options)?;

        steps.next(0.02, "measured response")?;
        let (lowest, highest) = (options.lowest(), options.highest());
        let between = |pieces: &[Piece], highest: f64| {
            let lines =
                spectra(pieces, highest, executor).into_iter().map(|lines| lines.between(lowest / BEYOND, highest));
            lines.filter(|lines| !lines.omega.is_empty()).collect::<Vec<_>>()
        };
        let wide = between(&pieces, BEYOND * highest);
        let omegas = log_spaced(lowest, highest, MEASURED_POINTS);
        let measured = local_polynomial(&wide, &omegas, executor).map_err(|why| unmeasured(why, &wide, &omegas))?;
        let noise = NoiseCovariance::of(&measured).ok_or(IdentificationError::OutputsDepend)?;
        let likelihood = |spectra: &[Spectrum]| {
            let pieces: Option<_> = spectra.iter().map(|lines| Lines::new(lines, &noise)).collect();
            pieces.map(|pieces| Likelihood { pieces, executor }).ok_or(IdentificationError::OutputsDepend)
        };
        let narrow: Vec<Spectrum> = wide.iter().map(|lines| lines.between(lowest, highest)).collect();
        let (fit, held_out) = (likelihood(&narrow)?, likelihood(&between(&scaled(&held_out_pieces), highest))?);

        steps.next(0.07, "low-pass")?;
        let cut_off = CutOff::choose(&pieces, highest, executor);
        let mut cautions: Vec<_> = prepared.cautions.into_iter().map(IdentificationCaution::Records).collect();
        cautions.extend(vibration_cautions(&cut_off, options));
        cautions.extend(excitation_cautions(&measured, options));
        cautions.extend(band_caution(&measured, options));
        Ok(Self {
            record_uses: prepared.records,
            scales,
            pieces: cut_off.apply(&pieces, executor),
            held_out_pieces,
            spectra: narrow,
            measured,
            noise,
            likelihood: fit,
            held_out,
            cautions,
        })
    }

    /// That no model came of this.
    pub(super) fn no_model(&self) -> IdentificationError {
        IdentificationError::NoModel {
            lines: self.spectra.iter().map(|spectrum| spectrum.omega.len()).sum(),
            seconds: self.spectra.iter().map(|spectrum| spectrum.duration_s).sum(),
        }
    }
}

fn check_sampling(pieces: &[Piece], options: &Options) -> Result<(), IdentificationError> {
    let sample_time_s = pieces.iter().map(|piece| piece.sample_time_s).fold(0.0, f64::max);
    let seen = std::f64::consts::PI / sample_time_s;
    if options.highest() <= seen {
        return Ok(());
    }
    Err(IdentificationError::SampledTooSlowly { highest: options.band[1], sample_time_s, limit: 0.75 * seen })
}

/// That there is no measured response; where that is because the records are too short, with the lower end of the band that would do:
/// the lowest of `omegas` from which on there are lines enough, of those that belong to it.
fn unmeasured(why: LocalPolynomialError, spectra: &[Spectrum], omegas: &[f64]) -> IdentificationError {
    let is_enough = |from: usize| {
        let lines: Vec<Spectrum> =
            spectra.iter().map(|lines| lines.between(omegas[from] / BEYOND, f64::INFINITY)).collect();
        omegas[from..].iter().all(|omega| is_measurable(&lines, *omega))
    };
    // Lines are used from half the lower end of the band on; the windows of another band lie a little differently.
    const MARGIN: f64 = 1.05;
    let lowest = |from: usize| 2.0 * MARGIN * omegas[from];
    let widest = omegas.last().map_or(0.0, |highest| 0.5 * highest);
    match why {
        LocalPolynomialError::TooFewLines { .. } => (0..omegas.len())
            .find(|from| is_enough(*from))
            .map(lowest)
            .filter(|lowest| *lowest < widest)
            .map_or(IdentificationError::Measurement(why), |lowest| IdentificationError::TooShort { why, lowest }),
        _ => IdentificationError::Measurement(why),
    }
}

/// Refuses inputs of which one is a sum of others, by the condition of their correlations.
fn check_inputs(pieces: &[Piece], options: &Options) -> Result<(), IdentificationError> {
    let inputs = options.preparation.inputs.len();
    let mut gram = DMatrix::<f64>::zeros(inputs, inputs);
    for piece in pieces {
        let mut centred = piece.inputs.clone();
        for mut column in centred.column_iter_mut() {
            let mean = column.mean();
            column.add_scalar_mut(-mean);
        }
        gram += centred.transpose() * centred;
    }
    let scales = gram.diagonal().map(f64::sqrt);
    let correlation = gram.component_div(&(&scales * scales.transpose()));
    let eigen = correlation.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    if eigen.eigenvalues[least] * COPY > eigen.eigenvalues.max() {
        return Ok(());
    }
    let vector = eigen.eigenvectors.column(least);
    let involved = (0..inputs).filter(|&input| vector[input].abs() > 0.1 * vector.amax());
    let signals = involved.map(|input| options.signal(Role::Input, input)).collect();
    Err(IdentificationError::InputsDepend { signals })
}

fn vibration_cautions(cut_off: &CutOff, options: &Options) -> Vec<IdentificationCaution> {
    let caution = |&(output, share): &(usize, f64)| IdentificationCaution::Vibration {
        signal: options.signal(Role::Output, output),
        percent: 100.0 * share,
        cut_off: cut_off.omega,
    };
    cut_off.vibrating.iter().map(caution).collect()
}

fn band_caution(measured: &MeasuredResponse, options: &Options) -> Option<IdentificationCaution> {
    let shown = measured.shown_band(options.band)?;
    Some(IdentificationCaution::BandNotShown { band: options.band, shown })
}

fn excitation_cautions(measured: &MeasuredResponse, options: &Options) -> Vec<IdentificationCaution> {
    let excitation = measured.excitation();
    let signal = |input| -> Signal { options.signal(Role::Input, input) };
    let not_swept = |input| IdentificationCaution::NotSwept {
        signal: signal(input),
        partial_coherence: excitation.partial_coherence[input],
    };
    let mut cautions: Vec<_> = excitation.not_identified().map(not_swept).collect();
    if excitation.moved_together() {
        cautions.push(IdentificationCaution::MovedTogether { condition: excitation.condition });
    }
    cautions
}
