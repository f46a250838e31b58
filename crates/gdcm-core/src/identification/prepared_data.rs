//! What models are made from and judged by, in scaled units.

use super::*;
use crate::executor::Executor;
use nalgebra::DMatrix;

/// Points of the measured response.
const MEASURED_POINTS: usize = 40;
/// SpectralLines for the measured response reach this factor beyond those used, at both ends.
const BEYOND: f64 = 1.3;
/// Condition number of the inputs' correlations above which one is a copy of the others.
const COPY: f64 = 1e9;

/// Records, prepared, transformed and weighed.
pub(super) struct PreparedData<'a> {
    /// What was used of every record.
    pub(super) record_uses: Vec<RecordUse>,
    /// Units of the records over scaled units.
    pub(super) scales: Scales,
    /// Segments to fit, low-passed for the projections.
    pub(super) segments: Vec<Segment>,
    /// Held-out segments in the units of the records.
    pub(super) held_out_segments: Vec<Segment>,
    /// SpectralLines to fit.
    pub(super) spectra: Vec<Spectrum>,
    /// The response without a model.
    pub(super) measured: ResponseEstimate,
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
        progress: &Shares,
    ) -> Result<Self, IdentificationError> {
        if let Some(&record) = options.held_out.iter().find(|record| **record >= records.len()) {
            return Err(IdentificationError::HeldOutMissing { record, records: records.len() });
        }
        let prepared = prepare(records, &options.preparation, executor)?;
        check_sampling(&prepared.segments, options)?;
        let (held_out_segments, segments): (Vec<Segment>, Vec<Segment>) =
            prepared.segments.into_iter().partition(|segment| options.held_out.contains(&segment.record));
        if segments.is_empty() {
            return Err(IdentificationError::NothingToFit);
        }
        let scales = Scales::of(&segments)?;
        let scaled = |segments: &[Segment]| segments.iter().map(|segment| scales.scaled(segment)).collect::<Vec<_>>();
        let segments = scaled(&segments);
        check_inputs(&segments, options)?;

        progress.next(0.02, "measured response")?;
        let (lowest, highest) = (options.lowest(), options.highest());
        let between = |segments: &[Segment], highest: f64| {
            let lines =
                spectra(segments, highest, executor).into_iter().map(|lines| lines.between(lowest / BEYOND, highest));
            lines.filter(|lines| !lines.omega.is_empty()).collect::<Vec<_>>()
        };
        let wide = between(&segments, BEYOND * highest);
        let omegas = log_spaced(lowest, highest, MEASURED_POINTS);
        let measured = local_polynomial(&wide, &omegas, executor).map_err(|why| unmeasured(why, &wide, &omegas))?;
        let noise = NoiseCovariance::of(&measured).ok_or(IdentificationError::OutputsDepend)?;
        let likelihood = |spectra: &[Spectrum]| {
            let segments: Option<_> = spectra.iter().map(|lines| SpectralLines::new(lines, &noise)).collect();
            segments.map(|segments| Likelihood { segments, executor }).ok_or(IdentificationError::OutputsDepend)
        };
        let narrow: Vec<Spectrum> = wide.iter().map(|lines| lines.between(lowest, highest)).collect();
        let (fit, held_out) = (likelihood(&narrow)?, likelihood(&between(&scaled(&held_out_segments), highest))?);

        progress.next(0.07, "low-pass")?;
        let cut_off = CutOff::choose(&segments, highest, executor);
        let mut cautions: Vec<_> = prepared.cautions.into_iter().map(IdentificationCaution::Records).collect();
        cautions.extend(vibration_cautions(&cut_off, options));
        cautions.extend(excitation_cautions(&measured, options));
        cautions.extend(band_caution(&measured, options));
        Ok(Self {
            record_uses: prepared.records,
            scales,
            segments: cut_off.apply(&segments, executor),
            held_out_segments,
            spectra: narrow,
            measured,
            noise,
            likelihood: fit,
            held_out,
            cautions,
        })
    }

    /// A model in the units of the records: the response of a pair is its scaled one times output over input.
    pub(super) fn in_units(&self, model: &BlockModel) -> Option<StateSpace> {
        let mut scaled = model.clone();
        for (input, scale) in self.scales.inputs.iter().enumerate() {
            scaled.b.column_mut(input).unscale_mut(*scale);
            scaled.d.column_mut(input).unscale_mut(*scale);
        }
        for (output, scale) in self.scales.outputs.iter().enumerate() {
            scaled.c.row_mut(output).scale_mut(*scale);
            scaled.d.row_mut(output).scale_mut(*scale);
        }
        scaled.state_space()
    }

    /// That no model came of this.
    pub(super) fn no_model(&self) -> IdentificationError {
        IdentificationError::NoModel {
            lines: self.spectra.iter().map(|spectrum| spectrum.omega.len()).sum(),
            seconds: self.spectra.iter().map(|spectrum| spectrum.duration_s).sum(),
        }
    }
}

fn check_sampling(segments: &[Segment], options: &Options) -> Result<(), IdentificationError> {
    let sample_time_s = segments.iter().map(|segment| segment.sample_time_s).fold(0.0, f64::max);
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
    // SpectralLines are used from half the lower end of the band on; the windows of another band lie a little differently.
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
fn check_inputs(segments: &[Segment], options: &Options) -> Result<(), IdentificationError> {
    let inputs = options.preparation.inputs.len();
    let mut gram = DMatrix::<f64>::zeros(inputs, inputs);
    for segment in segments {
        let centred = centred(segment.inputs.clone());
        gram += centred.tr_mul(&centred);
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
    let signals = involved.map(|input| options.signal(ChannelSide::Input, input)).collect();
    Err(IdentificationError::InputsDepend { signals })
}

fn vibration_cautions(cut_off: &CutOff, options: &Options) -> Vec<IdentificationCaution> {
    let caution = |&(output, share): &(usize, f64)| IdentificationCaution::Vibration {
        signal: options.signal(ChannelSide::Output, output),
        percent: 100.0 * share,
        cut_off: cut_off.omega,
    };
    cut_off.vibrating.iter().map(caution).collect()
}

fn band_caution(measured: &ResponseEstimate, options: &Options) -> Option<IdentificationCaution> {
    let shown = measured.shown_band(options.band)?;
    Some(IdentificationCaution::BandNotShown { band: options.band, shown })
}

fn excitation_cautions(measured: &ResponseEstimate, options: &Options) -> Vec<IdentificationCaution> {
    let excitation = measured.excitation();
    let signal = |input| -> Signal { options.signal(ChannelSide::Input, input) };
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

// The scale of every channel: its rms about the mean.

/// A channel whose rms about the mean is below this share of its greatest modulus is constant: what is left is rounding.
const CONSTANT: f64 = 1e-12;

/// The scale of every channel, in the units of the file: its rms about the mean of each segment, over all segments (M14, 1.6).
///
/// ```text
/// s_c = sqrt( sum_r sum_n (x_c[n] - mean_r x_c)^2 / sum_r N_r )
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// Scale of each input, greater than 0.
    pub inputs: Vec<f64>,
    /// Scale of each output, greater than 0.
    pub outputs: Vec<f64>,
}

/// Why the segments have no scales.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScalingError {
    /// There is nothing to scale.
    #[error("there are no flight records")]
    NoSegments,
    /// A segment has other channels than the first.
    #[error("piece {} of the flight records has another number of channels than the first", segment + 1)]
    ChannelsDiffer {
        /// Which, counted from 0.
        segment: usize,
    },
    /// A segment holds a sample that is not finite, or one whose square is not.
    #[error("piece {} of the flight records holds values that are not finite or absurdly large", segment + 1)]
    NotFinite {
        /// Which, counted from 0.
        segment: usize,
    },
    /// A channel is constant in every segment.
    #[error("{role} {} does not move in any record: leave it out", index + 1)]
    Constant {
        /// Input or output.
        role: ChannelSide,
        /// Which, counted from 0.
        index: usize,
    },
}

impl Scales {
    /// The scales of the channels of `segments`.
    ///
    /// # Errors
    /// No segments, differing numbers of channels, values that are not finite, a constant channel.
    pub fn of(segments: &[Segment]) -> Result<Self, ScalingError> {
        let first = segments.first().ok_or(ScalingError::NoSegments)?;
        let channels = |segment: &Segment| (segment.inputs.ncols(), segment.outputs.ncols());
        if let Some(segment) = segments.iter().position(|p| channels(p) != channels(first)) {
            return Err(ScalingError::ChannelsDiffer { segment });
        }
        let scales = |role, side: fn(&Segment) -> &DMatrix<f64>| {
            let scales = rms(segments, side)?.into_iter().enumerate();
            let moved = |(index, scale): (usize, Option<f64>)| scale.ok_or(ScalingError::Constant { role, index });
            scales.map(moved).collect::<Result<Vec<f64>, _>>()
        };
        Ok(Self {
            inputs: scales(ChannelSide::Input, |segment| &segment.inputs)?,
            outputs: scales(ChannelSide::Output, |segment| &segment.outputs)?,
        })
    }

    /// `segment` in scaled units: every channel divided by its scale. Channels beyond those of the scales are not touched.
    #[must_use]
    pub fn scaled(&self, segment: &Segment) -> Segment {
        let mut scaled = segment.clone();
        for (samples, scales) in [(&mut scaled.inputs, &self.inputs), (&mut scaled.outputs, &self.outputs)] {
            for (mut column, scale) in samples.column_iter_mut().zip(scales) {
                column /= *scale;
            }
        }
        scaled
    }

    /// What a response `[output, input]` in scaled units is multiplied with to be in the units of the file.
    #[must_use]
    pub fn of_response(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.outputs.len(), self.inputs.len(), |o, i| self.outputs[o] / self.inputs[i])
    }
}

/// The rms of each channel about its mean in each segment, over all segments; none for a constant channel.
fn rms(segments: &[Segment], side: fn(&Segment) -> &DMatrix<f64>) -> Result<Vec<Option<f64>>, ScalingError> {
    let channels = segments.first().map_or(0, |segment| side(segment).ncols());
    let (mut squares, mut greatest, mut samples) = (vec![0.0; channels], vec![0.0_f64; channels], 0);
    for (index, segment) in segments.iter().enumerate() {
        let rows = side(segment).nrows();
        samples += rows;
        for (c, column) in side(segment).column_iter().enumerate() {
            let mean = if rows == 0 { 0.0 } else { column.sum() / rows as f64 };
            squares[c] += column.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            if !squares[c].is_finite() {
                return Err(ScalingError::NotFinite { segment: index });
            }
            greatest[c] = greatest[c].max(column.amax());
        }
    }
    let scale = |(square, greatest): (&f64, &f64)| {
        let rms = if samples == 0 { 0.0 } else { (square / samples as f64).sqrt() };
        (rms > 0.0 && rms > CONSTANT * greatest).then_some(rms)
    };
    Ok(squares.iter().zip(&greatest).map(scale).collect())
}
