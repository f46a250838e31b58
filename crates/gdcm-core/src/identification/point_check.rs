//! The model against its own measured points (M14.17).
//!
//! ```text
//! at the points of the measured response inside the band whose window is no wider than 0.6 omega
//! G_model  what the local polynomials give of Y = G_model U on the same lines: a peak within a window is flattened alike
//! T = mean over five points of |G_model - G|^2 / var G,   D = mean over the same of |G_model / G - 1|
//! the model leaves them where T > 12 and D > 0.12 (1 dB or 7 degrees)
//! ```

use super::*;
use nalgebra::{Complex, DMatrix};

/// Half width of a window over its centre up to which a point shows one frequency.
pub const NARROW_WINDOW: f64 = 0.6;
/// Points of a mean.
const POINTS: usize = 5;
/// `T` and `D` above which the model leaves the points.
const LEAVES: (f64, f64) = (12.0, 0.12);

/// A response that leaves its measured points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Departure {
    /// Output and input.
    pub(super) pair: (usize, usize),
    /// Where \[rad/s\].
    pub(super) band: [f64; 2],
    /// The greatest `T`.
    pub(super) strength: f64,
}

/// What the model gives at the measured points, seen as these are: through the local polynomials where no reference stands between.
pub(super) fn model_at_points(
    model: &BlockModel,
    data: &PreparedData<'_>,
    options: &Options,
) -> Vec<DMatrix<Complex<f64>>> {
    let omegas: Vec<f64> = data.measured.points.iter().map(|point| point.omega).collect();
    let predicted = data.spectra.iter().map(|lines| {
        let mut outputs = lines.outputs.clone();
        for (mut column, (omega, inputs)) in
            outputs.column_iter_mut().zip(lines.omega.iter().zip(lines.inputs.column_iter()))
        {
            column.copy_from(&(model.response(*omega) * inputs));
        }
        Spectrum { outputs, ..lines.clone() }
    });
    let predicted: Vec<Spectrum> = predicted.filter(|_| options.references == 0).collect();
    match local_polynomial(&predicted, &omegas, data.likelihood.executor) {
        Ok(seen) => seen.points.into_iter().map(|point| point.response).collect(),
        Err(_) => omegas.into_iter().map(|omega| model.response(omega)).collect(),
    }
}

/// The greatest `T` of a response, and where it leaves its points; `model` is the model at each of them.
pub(super) fn departure(
    model: &[DMatrix<Complex<f64>>],
    measured: &ResponseEstimate,
    band: [f64; 2],
    pair: (usize, usize),
) -> (f64, Option<Departure>) {
    let is_tested = |(point, _): &(&EstimatePoint, &DMatrix<Complex<f64>>)| {
        (band[0]..=band[1]).contains(&point.omega) && point.half_width <= NARROW_WINDOW * point.omega
    };
    let of_point = |(point, model): (&EstimatePoint, &DMatrix<Complex<f64>>)| {
        let (own, found) = (model[pair], point.response[pair]);
        let distance = (own - found).norm_sqr() / point.variance[pair].max(f64::MIN_POSITIVE);
        (point.omega, distance, (own / found - 1.0).norm())
    };
    let tested: Vec<(f64, f64, f64)> = measured.points.iter().zip(model).filter(is_tested).map(of_point).collect();
    let (mut greatest, mut left) = (0.0_f64, None::<Departure>);
    for near in tested.windows(POINTS) {
        let mean = |part: fn(&(f64, f64, f64)) -> f64| near.iter().map(part).sum::<f64>() / POINTS as f64;
        let (t, d) = (mean(|of| of.1), mean(|of| of.2));
        greatest = greatest.max(t);
        if t > LEAVES.0 && d > LEAVES.1 {
            let (from, to) = (near[0].0, near[POINTS - 1].0);
            let before = left.map_or((from, 0.0), |of| (of.band[0], of.strength));
            left = Some(Departure { pair, band: [before.0, to], strength: t.max(before.1) });
        }
    }
    (greatest, left)
}

impl Diagnostics<'_> {
    /// The responses that leave their measured points, in words.
    pub(super) fn departures(&self) -> Vec<IdentificationCaution> {
        let (outputs, inputs) = self.fit.model.d.shape();
        let pairs = (0..inputs).flat_map(|input| (0..outputs).map(move |output| (output, input)));
        let model = model_at_points(&self.fit.model, self.data, self.options);
        let left = pairs.filter_map(|pair| departure(&model, &self.data.measured, self.options.band, pair).1);
        let caution = |of: Departure| IdentificationCaution::LeavesPoints {
            output: self.options.signal(ChannelSide::Output, of.pair.0),
            input: self.options.signal(ChannelSide::Input, of.pair.1),
            band: of.band,
            strength: of.strength,
        };
        left.map(caution).collect()
    }
}
