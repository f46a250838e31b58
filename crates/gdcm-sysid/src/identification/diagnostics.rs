//! What speaks against the recommended model, record by record and channel by channel (M14, section 10).

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::simulation::FlightRecord;

use super::blocks::BlockModel;
use super::cautions::IdentificationCaution;
use super::identify::Options;
use super::likelihood::{Likelihood, SegmentCost};
use super::local_polynomial::{EstimatePoint, ResponseEstimate, local_polynomial};
use super::order::parameters_of_order;
use super::prepared_data::PreparedData;
use super::refinement::Fit;
use super::spectrum::Spectrum;
use super::uncertainty::ParameterCovariance;

/// Cost per degree of freedom above which a model is not adequate.
const ADEQUATE: f64 = 1.5;
/// Cost per degree of freedom of a record over that of all above which it is unlike the others.
const UNLIKE: f64 = 1.5;
/// Cost per degree of freedom of held-out records, the model moved within its uncertainty, up to which they are predicted well, and
/// above which they are not (M14.17).
pub const HELD_OUT: [f64; 2] = [1.3, 2.0];

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
}

impl Diagnostics<'_> {
    /// The name of a record.
    pub(super) fn record_name(&self, record: usize) -> String {
        self.records
            .get(record)
            .map_or_else(String::new, |record| record.name.clone())
    }

    /// What the costs say.
    pub(super) fn adequacy(&self, fits: &RecordFits) -> Vec<IdentificationCaution> {
        let cost = fits.cost;
        let mut cautions = Vec::new();
        let fitted = || fits.records.iter().filter(|fit| !fit.held_out);
        let worst = fitted().max_by(|a, b| a.cost.total_cmp(&b.cost));
        let output = fits
            .outputs
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(b.1))
            .map_or(0, |(output, _)| output);
        if let Some(worst) = worst.filter(|_| cost > ADEQUATE) {
            let record = self.record_name(worst.record);
            let signal = self.options.signal(ChannelSide::Output, output);
            cautions.push(IdentificationCaution::Inadequate {
                cost,
                record,
                signal,
            });
        }
        for fit in fitted().filter(|fit| fit.cost > ADEQUATE.max(UNLIKE * cost)) {
            let name = self.record_name(fit.record);
            cautions.push(IdentificationCaution::UnlikeRecord {
                record: fit.record,
                name,
                cost: fit.cost,
            });
        }
        if let Some((raw, normalised)) = fits
            .held_out
            .filter(|(_, normalised)| *normalised > HELD_OUT[1])
        {
            let held_out = fits.records.iter().filter(|fit| fit.held_out);
            let records = held_out.map(|fit| self.record_name(fit.record)).collect();
            cautions.push(IdentificationCaution::HeldOut {
                records,
                raw,
                normalised,
            });
        }
        cautions
    }

    /// Responses that are not identified, in words.
    pub(super) fn unidentified_pairs(
        &self,
        pairs: &[(usize, usize)],
    ) -> Option<IdentificationCaution> {
        let named = |&(output, input): &(usize, usize)| {
            [
                self.options.signal(ChannelSide::Output, output),
                self.options.signal(ChannelSide::Input, input),
            ]
        };
        (!pairs.is_empty())
            .then(|| IdentificationCaution::PairsNotIdentified(pairs.iter().map(named).collect()))
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
    /// Real figures less the transients'.
    pub freedom: usize,
    /// Whether the record was held out.
    pub held_out: bool,
}

/// How well a model fits all records, each record and each output.
pub(super) struct RecordFits {
    /// The fit of every record that has degrees of freedom, in the order of the records. Those of the fit are freed of what the
    /// parameters took: `J_r / dof_r  N / (N - k)` (M14.13).
    pub(super) records: Vec<RecordFit>,
    /// `J` per degree of freedom of each output over the records of the fit.
    pub(super) outputs: Vec<f64>,
    /// `J` per degree of freedom over the records of the fit.
    pub(super) cost: f64,
    /// The same over the held-out records, where there are any, and where the model may move within its own uncertainty.
    pub(super) held_out: Option<(f64, f64)>,
}

impl RecordFits {
    /// The fits of a model; none where a cost is not finite or nothing has degrees of freedom.
    pub(super) fn of(
        data: &PreparedData,
        model: &BlockModel,
        covariance: &ParameterCovariance,
    ) -> Option<Self> {
        let fitted = data.likelihood.parts(model)?;
        let held_out = data.held_out.parts(model)?;
        let moved = covariance.moved_cost(&data.held_out, model, &held_out);
        let all = data.likelihood.freedom(model.order());
        let spare = all.checked_sub(parameters_of_order(
            model.order(),
            model.b.ncols(),
            model.c.nrows(),
        ));
        let share = all as f64 / spare.filter(|spare| *spare > 0)? as f64;
        let outputs = output_costs(&data.likelihood, model, &fitted)
            .into_iter()
            .map(|cost| cost * share)
            .collect();
        let mut records = fits_of_records(&data.likelihood, model, &fitted, false);
        records.iter_mut().for_each(|fit| fit.cost *= share);
        let held_out = fits_of_records(&data.held_out, model, &held_out, true);
        let freedom: usize = held_out.iter().map(|fit| fit.freedom).sum();
        let of_held_out = mean_cost(&held_out)
            .map(|raw| (raw, moved.map_or(raw, |moved| moved / freedom as f64)));
        let cost = mean_cost(&records)?;
        records.extend(held_out);
        records.sort_by_key(|fit| fit.record);
        Some(Self {
            records,
            outputs,
            cost,
            held_out: of_held_out,
        })
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
        let segments = || {
            likelihood
                .segments
                .iter()
                .zip(parts)
                .filter(move |(segment, _)| segment.record == record)
        };
        let freedom = segments()
            .map(|(segment, _)| segment.freedom(model.order()))
            .sum();
        let cost = segments().map(|(_, part)| part.cost).sum::<f64>() / freedom as f64;
        (freedom > 0).then_some(RecordFit {
            record,
            cost,
            freedom,
            held_out,
        })
    };
    likelihood
        .records()
        .into_iter()
        .filter_map(of_record)
        .collect()
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
            let Some(factor) =
                weight.solve_lower_triangular(&nalgebra::DMatrix::identity(outputs, outputs))
            else {
                continue;
            };
            for (o, sum) in sums.iter_mut().enumerate() {
                let back: nalgebra::Complex<f64> =
                    (0..=o).map(|k| residual[k] * factor[(o, k)]).sum();
                *sum += back.norm_sqr() / factor.row(o).norm_squared();
            }
        }
    }
    sums.into_iter()
        .map(|sum| if freedom > 0.0 { sum / freedom } else { 0.0 })
        .collect()
}

// The model against its own measured points (M14.17).
//
// ```text
// at the points of the measured response inside the band whose window is no wider than 0.6 omega
// G_model  what the local polynomials give of Y = G_model U on the same lines: a peak within a window is flattened alike
// T = mean over five points of |G_model - G|^2 / var G,   D = mean over the same of |G_model / G - 1|
// the model leaves them where T > 12 and D > 0.12 (1 dB or 7 degrees)
// ```

/// Half width of a window over its centre up to which a point shows one frequency.
pub const NARROW_WINDOW: f64 = 0.6;
/// Points of a mean.
const POINTS: usize = 5;
/// `T` and `D` above which the model leaves the points.
const LEAVES: (f64, f64) = (12.0, 0.12);

/// What the model gives at the measured points, seen as these are: through the local polynomials where no reference stands between.
pub(super) fn model_at_points(
    model: &BlockModel,
    data: &PreparedData<'_>,
    options: &Options,
) -> Vec<DMatrix<Complex<f64>>> {
    let omegas: Vec<f64> = data
        .measured
        .points
        .iter()
        .map(|point| point.omega)
        .collect();
    let predicted = data.spectra.iter().map(|lines| {
        let mut outputs = lines.outputs.clone();
        for (mut column, (omega, inputs)) in outputs
            .column_iter_mut()
            .zip(lines.omega.iter().zip(lines.inputs.column_iter()))
        {
            column.copy_from(&(model.response(*omega) * inputs));
        }
        Spectrum {
            outputs,
            ..lines.clone()
        }
    });
    let predicted: Vec<Spectrum> = predicted.filter(|_| options.references == 0).collect();
    match local_polynomial(&predicted, &omegas, data.likelihood.executor) {
        Ok(seen) => seen
            .points
            .into_iter()
            .map(|point| point.response)
            .collect(),
        Err(_) => omegas
            .into_iter()
            .map(|omega| model.response(omega))
            .collect(),
    }
}

/// The greatest `T` of a response, and where \[rad/s\] it leaves its points with which greatest `T` there; `model` is the model at each
/// of them.
pub(super) fn departure(
    model: &[DMatrix<Complex<f64>>],
    measured: &ResponseEstimate,
    band: [f64; 2],
    pair: (usize, usize),
) -> (f64, Option<([f64; 2], f64)>) {
    let is_tested = |(point, _): &(&EstimatePoint, &DMatrix<Complex<f64>>)| {
        (band[0]..=band[1]).contains(&point.omega)
            && point.half_width <= NARROW_WINDOW * point.omega
    };
    let of_point = |(point, model): (&EstimatePoint, &DMatrix<Complex<f64>>)| {
        let own = model[pair];
        let found = point.response[pair];
        let distance = (own - found).norm_sqr() / point.variance[pair].max(f64::MIN_POSITIVE);
        (point.omega, distance, (own / found - 1.0).norm())
    };
    let tested: Vec<(f64, f64, f64)> = measured
        .points
        .iter()
        .zip(model)
        .filter(is_tested)
        .map(of_point)
        .collect();
    let mut greatest = 0.0_f64;
    let mut left = None;
    for near in tested.windows(POINTS) {
        let mean =
            |part: fn(&(f64, f64, f64)) -> f64| near.iter().map(part).sum::<f64>() / POINTS as f64;
        let t = mean(|of| of.1);
        let d = mean(|of| of.2);
        greatest = greatest.max(t);
        if t > LEAVES.0 && d > LEAVES.1 {
            let from = near[0].0;
            let to = near[POINTS - 1].0;
            let before = left.map_or((from, 0.0), |([from, _], strength): ([f64; 2], f64)| {
                (from, strength)
            });
            left = Some(([before.0, to], t.max(before.1)));
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
        let caution = |(output, input)| {
            let (band, strength) = departure(
                &model,
                &self.data.measured,
                self.options.band,
                (output, input),
            )
            .1?;
            let output = self.options.signal(ChannelSide::Output, output);
            let input = self.options.signal(ChannelSide::Input, input);
            Some(IdentificationCaution::LeavesPoints {
                output,
                input,
                band,
                strength,
            })
        };
        pairs.filter_map(caution).collect()
    }
}
