//! What speaks against the recommended model, record by record and channel by channel (M14, section 10).

use super::*;
use crate::response::median;
use nalgebra::Complex;
use std::ops::Range;

/// Cost per degree of freedom above which a model is not adequate.
const ADEQUATE: f64 = 1.5;
/// Cost per degree of freedom of a record over that of all above which it is unlike the others.
const UNLIKE: f64 = 1.5;
/// Cost per degree of freedom of held-out records over that of the fit, at most.
const HELD_OUT: f64 = 1.15;
/// Distance of a model without a record over the median of the others above which the record is named.
const DECISIVE: f64 = 10.0;
/// Models without a record among which one can stand out.
const COMPARED: usize = 5;

/// The recommended model and what it is examined with.
pub(super) struct Diagnostics<'a> {
    /// For their names.
    pub(super) records: &'a [FlightRecord],
    /// For names of channels.
    pub(super) options: &'a Options,
    /// What the model was made from.
    pub(super) data: &'a PreparedData<'a>,
    /// The model.
    pub(super) fit: &'a Fit,
    /// The models without each record.
    pub(super) without: &'a [WithoutRecord],
}

impl Diagnostics<'_> {
    /// The name of a record.
    pub(super) fn record_name(&self, record: usize) -> String {
        self.records.get(record).map_or_else(String::new, |record| record.name.clone())
    }

    /// What the costs say.
    pub(super) fn adequacy(&self, fits: &RecordFits) -> Vec<IdentificationCaution> {
        let cost = fits.cost;
        let mut cautions = Vec::new();
        let fitted = || fits.records.iter().filter(|fit| !fit.held_out);
        let worst = fitted().max_by(|a, b| a.cost.total_cmp(&b.cost));
        let output = fits.outputs.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(output, _)| output);
        if let Some(worst) = worst.filter(|_| cost > ADEQUATE) {
            let (record, signal) = (self.record_name(worst.record), self.options.signal(ChannelSide::Output, output));
            cautions.push(IdentificationCaution::Inadequate { cost, record, signal });
        }
        for fit in fitted().filter(|fit| fit.cost > ADEQUATE.max(UNLIKE * cost)) {
            let name = self.record_name(fit.record);
            cautions.push(IdentificationCaution::UnlikeRecord { record: fit.record, name, cost: fit.cost });
        }
        if let Some(ratio) = fits.held_out_cost.map(|held_out| held_out / cost).filter(|ratio| *ratio > HELD_OUT) {
            cautions.push(IdentificationCaution::HeldOut { ratio });
        }
        cautions
    }

    /// Records without which the model is another.
    pub(super) fn decisive_records(&self, omegas: &[f64], left_out: &[(usize, usize)]) -> Vec<IdentificationCaution> {
        let (outputs, inputs) = self.fit.model.d.shape();
        let pairs = (0..inputs).flat_map(|input| (0..outputs).map(move |output| (output, input)));
        let pairs: Vec<_> = pairs.filter(|pair| !left_out.contains(pair)).collect();
        let of = |one: &WithoutRecord| distance(&one.model, &self.fit.model, omegas, &pairs);
        let distances: Vec<f64> = self.without.iter().map(of).collect();
        if distances.len() < COMPARED {
            return Vec::new();
        }
        let caution = |(k, one): (usize, &WithoutRecord)| {
            let others = distances.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, distance)| *distance);
            let ratio = distances[k] / median(&mut others.collect::<Vec<f64>>());
            let (record, name) = (one.record, self.record_name(one.record));
            let stands_out = ratio.is_finite() && ratio > DECISIVE;
            stands_out.then_some(IdentificationCaution::DecisiveRecord { record, name, ratio })
        };
        self.without.iter().enumerate().filter_map(caution).collect()
    }

    /// The channel that seems to be late in a record that the model does not fit, of several the one that explains most: it
    /// spoils the models for the others.
    pub(super) fn late_channel(&self, fits: &[RecordFit]) -> Option<IdentificationCaution> {
        let fitted = fits.iter().filter(|fit| !fit.held_out);
        let least = fitted.map(|fit| fit.cost).fold(f64::INFINITY, f64::min);
        let late = |fit: &RecordFit| {
            let spectra: Vec<&Spectrum> =
                self.data.spectra.iter().filter(|spectrum| spectrum.record == fit.record).collect();
            let model = &self.without.iter().find(|one| one.record == fit.record)?.model;
            Some((fit.record, channel_delay(&spectra, &self.data.noise, model)?))
        };
        let unlike = fits.iter().filter(|fit| !fit.held_out && fit.cost > UNLIKE * least);
        let (record, late) = unlike.filter_map(late).max_by(|a, b| a.1.gain.total_cmp(&b.1.gain))?;
        let (name, signal) = (self.record_name(record), self.options.signal(late.role, late.index));
        Some(IdentificationCaution::Late { record, name, signal, delay_s: late.delay_s })
    }

    /// Responses that are not identified, in words.
    pub(super) fn unidentified_pairs(&self, pairs: &[(usize, usize)]) -> Option<IdentificationCaution> {
        let named = |&(output, input): &(usize, usize)| {
            [self.options.signal(ChannelSide::Output, output), self.options.signal(ChannelSide::Input, input)]
        };
        (!pairs.is_empty())
            .then(|| IdentificationCaution::PairsNotIdentified { pairs: pairs.iter().map(named).collect() })
    }
}

// Delays of single channels, told by errors of phase that are linear in frequency (M14, section 10).
//
// ```text
// an output logged d late:  Y = e^(-j omega d) Y_true      dE/dd = -j omega e_o Y_o
// an input logged d late:   U = e^(-j omega d) U_true      dE/dd =  j omega G_j U_j
// 1  of each channel: d = a'e / a'a over the lines of a record, a = W dE/dd with the transient taken off; the cost falls by d^2 a'a
// 2  the channel with which it falls most is shifted back by d, and step 1 is repeated for it alone
// ```
//
// The model is one that has not seen the record; a delay of all records alike cannot be told from dynamics.

/// Steps of the iteration.
const STEPS: usize = 4;
/// Least share of the cost that a delay explains.
const LEAST_SHARE: f64 = 0.2;
/// Least delay over its standard deviation.
const LEAST_RATIO: f64 = 6.0;

/// A channel that seems to be logged late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ChannelDelay {
    /// Input or output.
    pub(super) role: ChannelSide,
    /// Which, counted from 0.
    pub(super) index: usize,
    /// How late \[s\]; negative when it is early.
    pub(super) delay_s: f64,
    /// By how much it lowers the cost.
    pub(super) gain: f64,
}

/// The channel of a record whose delay explains most of what `model` leaves of its spectra; none where no delay explains much.
pub(super) fn channel_delay(
    spectra: &[&Spectrum],
    noise: &NoiseCovariance,
    model: &BlockModel,
) -> Option<ChannelDelay> {
    let inputs = model.b.ncols();
    let channels = inputs + model.c.nrows();
    let mut shifted: Vec<Spectrum> = spectra.iter().map(|&spectrum| spectrum.clone()).collect();
    let first = Sums::of(&shifted, noise, model, 0..channels)?;
    let gain = |channel: usize| first.product[channel].powi(2) / first.square[channel];
    let channel =
        (0..channels).filter(|&channel| gain(channel).is_finite()).max_by(|&a, &b| gain(a).total_cmp(&gain(b)))?;
    let (mut delay_s, mut step) = (0.0, first.product[channel] / first.square[channel]);
    let (mut cost, mut square) = (first.cost, first.square[channel]);
    for _ in 0..STEPS {
        delay_s += step;
        for spectrum in &mut shifted {
            advance(spectrum, channel, step);
        }
        let last = Sums::of(&shifted, noise, model, channel..channel + 1)?;
        (cost, square, step) = (last.cost, last.square[0], last.product[0] / last.square[0]);
    }
    let share = 1.0 - cost / first.cost;
    let ratio = delay_s.abs() * square.sqrt();
    let (role, index) =
        if channel < inputs { (ChannelSide::Input, channel) } else { (ChannelSide::Output, channel - inputs) };
    let told = delay_s.is_finite() && share >= LEAST_SHARE && ratio >= LEAST_RATIO;
    told.then_some(ChannelDelay { role, index, delay_s, gain: first.cost - cost })
}

/// Moves a channel `seconds` earlier.
fn advance(spectrum: &mut Spectrum, channel: usize, seconds: f64) {
    let inputs = spectrum.inputs.nrows();
    for (k, omega) in spectrum.omega.iter().enumerate() {
        let turn = Complex::cis(omega * seconds);
        if channel < inputs {
            spectrum.inputs[(channel, k)] *= turn;
        } else {
            spectrum.outputs[(channel - inputs, k)] *= turn;
        }
    }
}

/// `a'e` and `a'a` of some channels, and the cost.
struct Sums {
    product: Vec<f64>,
    square: Vec<f64>,
    cost: f64,
}

impl Sums {
    /// By differences of residuals, in which the transient is taken off.
    fn of(spectra: &[Spectrum], noise: &NoiseCovariance, model: &BlockModel, channels: Range<usize>) -> Option<Self> {
        /// Of 100 rad/s it turns a line by 1e-5: neither rounding nor curvature count.
        const SMALL_S: f64 = 1e-7;
        let cost = |spectrum: &Spectrum| SpectralLines::new(spectrum, noise)?.cost(model);
        let mut sums = Self { product: vec![0.0; channels.len()], square: vec![0.0; channels.len()], cost: 0.0 };
        for spectrum in spectra {
            let here = cost(spectrum)?;
            for (k, channel) in channels.clone().enumerate() {
                let mut earlier = spectrum.clone();
                advance(&mut earlier, channel, SMALL_S);
                let slope = (&here.residual - cost(&earlier)?.residual) / Complex::from(SMALL_S);
                sums.product[k] += slope.dotc(&here.residual).re;
                sums.square[k] += slope.norm_squared();
            }
            sums.cost += here.cost;
        }
        Some(sums)
    }
}

// How well a model fits each record and each output.

/// How well the recommended model fits a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordFit {
    /// Which record, counted from 0.
    pub record: usize,
    /// `J` per degree of freedom; 1 is adequate.
    pub cost: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Whether the record was held out.
    pub held_out: bool,
}

/// How well a model fits all records, each record and each output.
pub(super) struct RecordFits {
    /// The fit of every record that has degrees of freedom, in the order of the records.
    pub(super) records: Vec<RecordFit>,
    /// `J` per degree of freedom of each output over the records of the fit.
    pub(super) outputs: Vec<f64>,
    /// `J` per degree of freedom over the records of the fit.
    pub(super) cost: f64,
    /// The same over the held-out records, where there are any.
    pub(super) held_out_cost: Option<f64>,
}

impl RecordFits {
    /// The fits of a model; none where a cost is not finite or nothing has degrees of freedom.
    pub(super) fn of(data: &PreparedData, model: &BlockModel) -> Option<Self> {
        let (fitted, held_out) = (data.likelihood.parts(model)?, data.held_out.parts(model)?);
        let outputs = output_costs(&data.likelihood, model, &fitted);
        let mut records = fits_of_records(&data.likelihood, model, &fitted, false);
        let held_out = fits_of_records(&data.held_out, model, &held_out, true);
        let (cost, held_out_cost) = (mean_cost(&records)?, mean_cost(&held_out));
        records.extend(held_out);
        records.sort_by_key(|fit| fit.record);
        Some(Self { records, outputs, cost, held_out_cost })
    }
}

/// The fit of each record that has degrees of freedom, by record.
pub(super) fn fits_of_records(
    likelihood: &Likelihood,
    model: &BlockModel,
    parts: &[SegmentCost],
    held_out: bool,
) -> Vec<RecordFit> {
    let of_record = |record: usize| {
        let segments = || likelihood.segments.iter().zip(parts).filter(move |(segment, _)| segment.record == record);
        let freedom = segments().map(|(segment, _)| segment.freedom(model.order())).sum();
        let cost = segments().map(|(_, part)| part.cost).sum::<f64>() / freedom as f64;
        (freedom > 0).then_some(RecordFit { record, cost, freedom, held_out })
    };
    likelihood.records().into_iter().filter_map(of_record).collect()
}

/// `J` per degree of freedom over records; none where they have none.
fn mean_cost(fits: &[RecordFit]) -> Option<f64> {
    let freedom: f64 = fits.iter().map(|fit| fit.freedom as f64).sum();
    let cost: f64 = fits.iter().map(|fit| fit.cost * fit.freedom as f64).sum();
    (freedom > 0.0).then(|| cost / freedom)
}

/// `J` per degree of freedom of each output by itself: `sum |E_o|^2 / (Cv_oo / 2)` over its share of the degrees of freedom.
fn output_costs(likelihood: &Likelihood, model: &BlockModel, parts: &[SegmentCost]) -> Vec<f64> {
    let outputs = model.c.nrows();
    let freedom = likelihood.freedom(model.order()) as f64 / outputs as f64;
    let mut sums = vec![0.0; outputs];
    for (segment, part) in likelihood.segments.iter().zip(parts) {
        for (weight, residual) in segment.weights.iter().zip(part.residual.column_iter()) {
            // The Cholesky factor of Cv / 2, by which the residual goes back to its outputs.
            let Some(factor) = weight.solve_lower_triangular(&nalgebra::DMatrix::identity(outputs, outputs)) else {
                continue;
            };
            for (o, sum) in sums.iter_mut().enumerate() {
                let back: nalgebra::Complex<f64> = (0..=o).map(|k| residual[k] * factor[(o, k)]).sum();
                *sum += back.norm_sqr() / factor.row(o).norm_squared();
            }
        }
    }
    sums.into_iter().map(|sum| if freedom > 0.0 { sum / freedom } else { 0.0 }).collect()
}
