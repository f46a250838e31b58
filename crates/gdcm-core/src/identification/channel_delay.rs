//! Delays of single channels, told by errors of phase that are linear in frequency (M14, section 10).
//!
//! ```text
//! an output logged d late:  Y = e^(-j omega d) Y_true      dE/dd = -j omega e_o Y_o
//! an input logged d late:   U = e^(-j omega d) U_true      dE/dd =  j omega G_j U_j
//! 1  of each channel: d = a'e / a'a over the lines of a record, a = W dE/dd with the transient taken off; the cost falls by d^2 a'a
//! 2  the channel with which it falls most is shifted back by d, and step 1 is repeated for it alone
//! ```
//!
//! The model is one that has not seen the record; a delay of all records alike cannot be told from dynamics.

use super::blocks::BlockModel;
use super::likelihood::{DEPENDENT, Lines, pseudo_inverse_root};
use super::{NoiseCovariance, Role, Spectrum};
use nalgebra::{Complex, DMatrix, DVector};

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
    pub(super) role: Role,
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
    let first = Sums::of(&shifted, noise, model)?;
    let gain = |channel: usize| first.product[channel].powi(2) / first.square[channel];
    let channel =
        (0..channels).filter(|&channel| gain(channel).is_finite()).max_by(|&a, &b| gain(a).total_cmp(&gain(b)))?;
    let mut delay_s = 0.0;
    let mut last = first.clone();
    for _ in 0..STEPS {
        let step = last.product[channel] / last.square[channel];
        delay_s += step;
        for spectrum in &mut shifted {
            advance(spectrum, channel, step);
        }
        last = Sums::of(&shifted, noise, model)?;
    }
    let share = 1.0 - last.cost / first.cost;
    let ratio = delay_s.abs() * last.square[channel].sqrt();
    let (role, index) = if channel < inputs { (Role::Input, channel) } else { (Role::Output, channel - inputs) };
    let told = delay_s.is_finite() && share >= LEAST_SHARE && ratio >= LEAST_RATIO;
    told.then_some(ChannelDelay { role, index, delay_s, gain: first.cost - last.cost })
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

/// `a'e` and `a'a` of every channel, and the cost.
#[derive(Clone)]
struct Sums {
    product: DVector<f64>,
    square: DVector<f64>,
    cost: f64,
}

impl Sums {
    fn of(spectra: &[Spectrum], noise: &NoiseCovariance, model: &BlockModel) -> Option<Self> {
        let channels = model.b.ncols() + model.c.nrows();
        let mut sums = Self { product: DVector::zeros(channels), square: DVector::zeros(channels), cost: 0.0 };
        for spectrum in spectra {
            let part = Lines::new(spectrum, noise)?.cost(model)?;
            let residual =
                DVector::from_iterator(2 * part.residual.len(), part.residual.iter().flat_map(|e| [e.re, e.im]));
            let columns = columns(spectrum, noise, model)?;
            let (delays, transient) = columns.columns_range_pair(0..channels, channels..);
            let root = pseudo_inverse_root(transient.transpose() * transient, DEPENDENT)?;
            let basis = transient * root;
            let free = delays - &basis * (basis.transpose() * delays);
            sums.product += free.transpose() * residual;
            sums.square += DVector::from_iterator(channels, free.column_iter().map(|column| column.norm_squared()));
            sums.cost += part.cost;
        }
        Some(sums)
    }
}

/// `W dE/dd` of every channel, then the transient's columns; two rows, real and imaginary, for each output of each line.
fn columns(spectrum: &Spectrum, noise: &NoiseCovariance, model: &BlockModel) -> Option<DMatrix<f64>> {
    let (order, inputs, outputs) = (model.order(), model.b.ncols(), model.c.nrows());
    let count = inputs + outputs + order + 2 * outputs;
    let mut columns = DMatrix::zeros(2 * outputs * spectrum.omega.len(), count);
    for (k, &omega) in spectrum.omega.iter().enumerate() {
        let weight = noise.weight(omega)?.map(Complex::from);
        let turn = Complex::new(0.0, omega);
        let mut vectors = DMatrix::<Complex<f64>>::zeros(outputs, count);
        let response = model.response(omega);
        for j in 0..inputs {
            vectors.set_column(j, &(response.column(j) * (turn * spectrum.inputs[(j, k)])));
        }
        for o in 0..outputs {
            vectors[(o, inputs + o)] = -turn * spectrum.outputs[(o, k)];
            vectors[(o, inputs + outputs + order + o)] = Complex::from(1.0);
            vectors[(o, inputs + 2 * outputs + order + o)] = 1.0 / turn;
        }
        let states = &mut vectors.as_mut_slice()[(inputs + outputs) * outputs..(inputs + outputs + order) * outputs];
        model.output_resolvent(omega, states);
        let white = weight * vectors;
        for o in 0..outputs {
            for (column, value) in white.row(o).iter().enumerate() {
                (columns[(2 * (k * outputs + o), column)], columns[(2 * (k * outputs + o) + 1, column)]) =
                    (value.re, value.im);
            }
        }
    }
    Some(columns)
}
