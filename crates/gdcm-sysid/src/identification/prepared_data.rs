//! What models are made from and judged by, in scaled units.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use gdcm_model::dataset::StateSpace;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::Executor;
use gdcm_model::progress::Shares;
use gdcm_model::response::frequency_response::log_spaced;
use gdcm_model::simulation::{FlightRecord, Segment, centred};

use super::blocks::BlockModel;
use super::cautions::IdentificationCaution;
use super::identify::{IdentificationError, Options};
use super::instrument::Instrument;
use super::likelihood::{Likelihood, SpectralLines};
use super::local_polynomial::{NoiseCovariance, ResponseEstimate, local_polynomial};
use super::order::{Extent, parameters_of_order};
use super::preparation::{RecordUse, prepare};
use super::record_cautions::RecordCaution;
use super::spectrum::{CutOff, Spectrum, spectra};
use super::subspace::SubspaceSettings;

/// Points of the measured response.
const MEASURED_POINTS: usize = 40;
/// Spectral lines for the measured response reach this factor above those used.
const BEYOND: f64 = 1.3;
/// Lines of a segment are used from its second one up: the first holds its drift (M14.12).
const FIRST_LINE: f64 = 1.5;
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
    /// The same as they are.
    pub(super) unfiltered: Vec<Segment>,
    /// Which lines the measured response is made of.
    pub(super) lines: LineRange,
    /// Held-out segments in the units of the records.
    pub(super) held_out_segments: Vec<Segment>,
    /// Spectral lines to fit.
    pub(super) spectra: Vec<Spectrum>,
    /// The response without a model.
    pub(super) measured: ResponseEstimate,
    /// The cost over the records of the fit.
    pub(super) likelihood: Likelihood<'a>,
    /// The same of the lines as they were logged, where those of the fit are seen by way of a reference (M14.15).
    pub(super) direct: Option<Likelihood<'a>>,
    /// The cost over the held-out records.
    pub(super) held_out: Likelihood<'a>,
    /// Highest line used \[rad/s\].
    pub(super) highest: f64,
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
        if let Some(&record) = options
            .held_out
            .iter()
            .find(|record| **record >= records.len())
        {
            return Err(IdentificationError::HeldOutMissing {
                record,
                records: records.len(),
            });
        }
        let prepared = prepare(records, &options.preparation, executor)?;
        check_sampling(&prepared.segments, options)?;
        let (mut held_out_segments, mut segments): (Vec<Segment>, Vec<Segment>) = prepared
            .segments
            .into_iter()
            .partition(|segment| options.held_out.contains(&segment.record));
        held_out_segments
            .iter_mut()
            .for_each(|segment| drop(split_references(segment, options.references)));
        let references: Vec<DMatrix<f64>> = segments
            .iter_mut()
            .map(|segment| split_references(segment, options.references))
            .collect();
        if segments.is_empty() {
            return Err(IdentificationError::NothingToFit);
        }
        let scales = Scales::of(&segments)?;
        let scaled = |segments: &[Segment]| {
            segments
                .iter()
                .map(|segment| scales.scaled(segment))
                .collect::<Vec<_>>()
        };
        let segments = scaled(&segments);
        check_inputs(&segments, options)?;

        progress.next(0.02, "measured response")?;
        let lowest = options.lowest();
        let highest = options.highest();
        let lines = LineRange {
            lowest,
            highest: BEYOND * highest,
        };
        let wide = lines.of(&segments, executor);
        let narrow: Vec<Spectrum> = wide
            .iter()
            .map(|lines| lines.between(lowest, highest))
            .collect();
        let too_short = checked_length(&segments, &narrow, options)?;
        let first = wide
            .iter()
            .filter_map(|lines| lines.omega.first().copied())
            .fold(highest, f64::min);
        let logged = || {
            local_polynomial(
                &wide,
                &log_spaced(first, highest, MEASURED_POINTS),
                executor,
            )
        };
        let likelihood = |spectra: &[Spectrum], measured: &ResponseEstimate| {
            let noise = NoiseCovariance::of(measured).ok_or(IdentificationError::OutputsDepend)?;
            let segments: Option<_> = spectra
                .iter()
                .map(|lines| SpectralLines::new(lines, &noise))
                .collect();
            segments
                .map(|segments| Likelihood { segments, executor })
                .ok_or(IdentificationError::OutputsDepend)
        };
        let (measured, narrow, direct) = if options.references == 0 {
            (logged()?, narrow, None)
        } else {
            let driven = segments
                .iter()
                .zip(references)
                .map(|(segment, reference)| driven(segment, reference));
            let driven: Vec<Segment> = driven.collect();
            let scales = Scales::of(&driven)?;
            let seen = lines.of(
                &driven
                    .iter()
                    .map(|segment| scales.scaled(segment))
                    .collect::<Vec<_>>(),
                executor,
            );
            let outputs = options.preparation.outputs.len();
            let instrument = Instrument::of(&seen, [lowest, highest], outputs, executor)?;
            (
                instrument.measured,
                instrument.spectra,
                Some(likelihood(&narrow, &logged()?)?),
            )
        };
        let fit = likelihood(&narrow, &measured)?;
        let held_out = likelihood(
            &LineRange { lowest, highest }.of(&scaled(&held_out_segments), executor),
            &measured,
        )?;

        progress.next(0.07, "low-pass")?;
        let cut_off = CutOff::choose(&segments, highest, executor);
        let is_of_model = |caution: &RecordCaution| match caution {
            // A reference may well move as an input does.
            RecordCaution::MovedTogether { signals, .. } => {
                signals.iter().all(|signal| signal.index < options.inputs())
            }
            RecordCaution::Copy { of, .. } => {
                of.role == ChannelSide::Output || of.index < options.inputs()
            }
            _ => true,
        };
        let of_records = prepared.cautions.into_iter().filter(is_of_model);
        let mut cautions: Vec<_> = of_records.map(IdentificationCaution::Records).collect();
        cautions.extend(too_short);
        cautions.extend(vibration_cautions(&cut_off, options));
        cautions.extend(excitation_cautions(&measured, options));
        let shown = measured.shown_band(options.band);
        cautions.extend(shown.map(|shown| IdentificationCaution::BandNotShown {
            band: options.band,
            shown,
        }));
        Ok(Self {
            record_uses: prepared.records,
            scales,
            segments: cut_off.apply(&segments, executor),
            unfiltered: segments,
            lines,
            held_out_segments,
            spectra: narrow,
            measured,
            likelihood: fit,
            direct,
            held_out,
            highest,
            cautions,
        })
    }

    /// What CT-PBSID is run with: what the options say, and where they say nothing what the records can carry (M14.13).
    pub(super) fn subspace_settings(&self, options: &Options) -> SubspaceSettings {
        let inputs = self.scales.inputs.len();
        let outputs = self.scales.outputs.len();
        let lines: usize = self
            .spectra
            .iter()
            .map(|spectrum| spectrum.omega.len())
            .sum();
        let seconds: f64 = self
            .spectra
            .iter()
            .map(|spectrum| spectrum.duration_s)
            .sum();
        let figures = 2 * outputs * lines.saturating_sub(self.spectra.len());
        let extent = Extent {
            inputs,
            outputs,
            figures,
            radians: seconds * options.band[1],
        };
        let pasts = options.pasts.clone().unwrap_or_else(|| extent.pasts());
        let longest = pasts.iter().copied().max().unwrap_or_default();
        let mut orders = options
            .orders
            .clone()
            .unwrap_or_else(|| extent.orders(longest));
        orders.sort_unstable();
        orders.dedup();
        SubspaceSettings {
            highest: options.band[1],
            poles: options
                .poles
                .iter()
                .map(|pole| pole * options.band[1])
                .collect(),
            pasts,
            orders,
            longest_future: extent.longest_future(),
        }
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
            lines: self
                .spectra
                .iter()
                .map(|spectrum| spectrum.omega.len())
                .sum(),
            seconds: self
                .spectra
                .iter()
                .map(|spectrum| spectrum.duration_s)
                .sum(),
        }
    }
}

/// Takes the last `references` inputs off a segment, and gives them.
fn split_references(segment: &mut Segment, references: usize) -> DMatrix<f64> {
    let inputs = segment.inputs.ncols().saturating_sub(references);
    let taken = segment
        .inputs
        .columns(inputs, segment.inputs.ncols() - inputs)
        .into_owned();
    segment.inputs = segment.inputs.columns(0, inputs).into_owned();
    taken
}

/// A segment with the references as what drives it, and outputs and inputs as what comes of that.
fn driven(segment: &Segment, reference: DMatrix<f64>) -> Segment {
    let both: Vec<_> = segment
        .outputs
        .column_iter()
        .chain(segment.inputs.column_iter())
        .collect();
    Segment {
        inputs: reference,
        outputs: DMatrix::from_columns(&both),
        ..segment.clone()
    }
}

/// Which lines of the segments are used.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineRange {
    /// \[rad/s\].
    pub(super) lowest: f64,
    /// \[rad/s\].
    pub(super) highest: f64,
}

impl LineRange {
    /// The lines of the segments that have any here, from the second of each on.
    pub(super) fn of(self, segments: &[Segment], executor: &dyn Executor) -> Vec<Spectrum> {
        let used = |lines: Spectrum| {
            lines.between(
                self.lowest.max(FIRST_LINE * TAU / lines.duration_s),
                self.highest,
            )
        };
        let lines = spectra(segments, self.highest, executor)
            .into_iter()
            .map(used);
        lines.filter(|lines| !lines.omega.is_empty()).collect()
    }
}

fn check_sampling(segments: &[Segment], options: &Options) -> Result<(), IdentificationError> {
    let sample_time_s = segments
        .iter()
        .map(|segment| segment.sample_time_s)
        .fold(0.0, f64::max);
    let seen = std::f64::consts::PI / sample_time_s;
    if options.highest() <= seen {
        return Ok(());
    }
    Err(IdentificationError::SampledTooSlowly {
        highest: options.band[1],
        sample_time_s,
        limit: 0.75 * seen,
    })
}

/// Periods of the lower end of the band that the longest record lasts at least, and that it should last (M14.12).
const PERIODS: (f64, f64) = (1.5, 5.0);
/// The same for each of several inputs that are moved in one record.
const PERIODS_AN_INPUT: f64 = 3.0;
/// Real figures that there are at least for each unknown of a model (M14.13).
pub(super) const FIGURES_AN_UNKNOWN: usize = 5;

/// Refuses records that show nothing of the lower end of the band, or too little for a model of the first order; says where they are
/// shorter than they should be (M14.12).
fn checked_length(
    segments: &[Segment],
    lines: &[Spectrum],
    options: &Options,
) -> Result<Option<IdentificationCaution>, IdentificationError> {
    let lowest = options.band[0];
    let period_s = TAU / options.band[0];
    let length_s = |segment: &Segment| segment.sample_time_s * segment.inputs.nrows() as f64;
    let longest_s = segments.iter().map(length_s).fold(0.0, f64::max);
    let of_inputs = if segments.len() == 1 {
        options.inputs() as f64 * PERIODS_AN_INPUT
    } else {
        0.0
    };
    let better_s = PERIODS.1.max(of_inputs) * period_s;
    let needed_s = PERIODS.0 * TAU / lowest;
    if longest_s < needed_s {
        let enough = PERIODS.0 * TAU / longest_s;
        return Err(IdentificationError::TooShort {
            longest_s,
            lowest,
            needed_s,
            better_s,
            enough,
        });
    }
    let (inputs, outputs) = lines
        .first()
        .map_or((0, 0), |of| (of.inputs.nrows(), of.outputs.nrows()));
    let count: usize = lines.iter().map(|of| of.omega.len()).sum();
    let figures = (2 * outputs * count).saturating_sub(2 * outputs * segments.len());
    let unknowns = parameters_of_order(1, inputs, outputs);
    let needed = FIGURES_AN_UNKNOWN * unknowns;
    if figures < needed {
        return Err(IdentificationError::TooFewFigures {
            figures,
            needed,
            unknowns,
        });
    }
    let periods = longest_s * lowest / TAU;
    Ok(
        (periods < PERIODS.1).then_some(IdentificationCaution::Short {
            longest_s,
            lowest,
            periods,
            better_s,
        }),
    )
}

/// Refuses inputs of which one is a sum of others, by the condition of their correlations.
fn check_inputs(segments: &[Segment], options: &Options) -> Result<(), IdentificationError> {
    let inputs = options.inputs();
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
    let signals = involved
        .map(|input| options.signal(ChannelSide::Input, input))
        .collect();
    Err(IdentificationError::InputsDepend(signals))
}

fn vibration_cautions(cut_off: &CutOff, options: &Options) -> Vec<IdentificationCaution> {
    let caution = |&(output, share): &(usize, f64)| IdentificationCaution::Vibration {
        signal: options.signal(ChannelSide::Output, output),
        percent: 100.0 * share,
        cut_off: cut_off.omega,
    };
    cut_off.vibrating.iter().map(caution).collect()
}

fn excitation_cautions(
    measured: &ResponseEstimate,
    options: &Options,
) -> Vec<IdentificationCaution> {
    let excitation = measured.excitation();
    let not_swept = |input| IdentificationCaution::NotSwept {
        signal: options.signal(ChannelSide::Input, input),
        partial_coherence: excitation.partial_coherence[input],
    };
    let mut cautions: Vec<_> = excitation.not_identified().map(not_swept).collect();
    if excitation.moved_together() {
        cautions.push(IdentificationCaution::MovedTogether {
            condition: excitation.condition,
        });
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
    /// A segment has other channels than the first; which, counted from 0.
    #[error("piece {} of the flight records has another number of channels than the first", .0 + 1)]
    ChannelsDiffer(usize),
    /// A segment holds a sample that is not finite, or one whose square is not; which, counted from 0.
    #[error("piece {} of the flight records holds values that are not finite or absurdly large", .0 + 1)]
    NotFinite(usize),
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
            return Err(ScalingError::ChannelsDiffer(segment));
        }
        let scales = |role, side: fn(&Segment) -> &DMatrix<f64>| {
            let scales = rms(segments, side)?.into_iter().enumerate();
            let moved = |(index, scale): (usize, Option<f64>)| {
                scale.ok_or(ScalingError::Constant { role, index })
            };
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
        for (samples, scales) in [
            (&mut scaled.inputs, &self.inputs),
            (&mut scaled.outputs, &self.outputs),
        ] {
            for (mut column, scale) in samples.column_iter_mut().zip(scales) {
                column /= *scale;
            }
        }
        scaled
    }

    /// What a response `[output, input]` in scaled units is multiplied with to be in the units of the file.
    #[must_use]
    pub fn of_response(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.outputs.len(), self.inputs.len(), |o, i| {
            self.outputs[o] / self.inputs[i]
        })
    }
}

/// The rms of each channel about its mean in each segment, over all segments; none for a constant channel.
fn rms(
    segments: &[Segment],
    side: fn(&Segment) -> &DMatrix<f64>,
) -> Result<Vec<Option<f64>>, ScalingError> {
    let channels = segments.first().map_or(0, |segment| side(segment).ncols());
    let mut squares = vec![0.0; channels];
    let mut greatest = vec![0.0_f64; channels];
    let mut samples = 0;
    for (index, segment) in segments.iter().enumerate() {
        let rows = side(segment).nrows();
        samples += rows;
        for (c, column) in side(segment).column_iter().enumerate() {
            let mean = if rows == 0 {
                0.0
            } else {
                column.sum() / rows as f64
            };
            squares[c] += column.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            if !squares[c].is_finite() {
                return Err(ScalingError::NotFinite(index));
            }
            greatest[c] = greatest[c].max(column.amax());
        }
    }
    let scale = |(square, greatest): (&f64, &f64)| {
        let rms = if samples == 0 {
            0.0
        } else {
            (square / samples as f64).sqrt()
        };
        (rms > 0.0 && rms > CONSTANT * greatest).then_some(rms)
    };
    Ok(squares.iter().zip(&greatest).map(scale).collect())
}
