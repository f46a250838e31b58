//! How well a model is known (M14, section 5).
//!
//! ```text
//! Cov theta = phi G^+,   phi = J / (N - k),   G = sum_r J_r'J_r; eigenvalues below 1e-9 of the greatest are freedoms of scale
//! var Re(dH/H), Im(dH/H) = h' Cov h of the real and imaginary part of the gradient of H_oi over H_oi
//! sd^2 = 2 (sd_GN^2 + sd_order^2) + |G_b/G|^2 / 2,   sd_order = rms over neighbouring orders of the real and imaginary part of ln(H_n'/H_n),
//!        |G_b/G| the share of the response that is fed back (M14.17), where it is more than nothing
//! pole: d lambda = -(d a0 + lambda d a1) / (2 lambda + a1)
//! ```
//!
//! The factor 2 was measured: bands of 95 % then hold 95 % of the true curves.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::executor::{Executor, each};
use gdcm_model::response::pole_estimate::PoleEstimate;
use gdcm_model::units::neper_to_db;

use super::blocks::{Block, BlockModel};
use super::feedback::Feedback;
use super::likelihood::{Likelihood, SegmentCost, pseudo_inverse_root};
use super::normal_system::{NormalSystem, normal_systems};
use super::order::effective_parameters;
use super::refinement::{Fit, damped};

/// Standard deviations that hold 95 %.
pub const TWO_SIDED_95: f64 = 1.96;
/// Share of the greatest eigenvalue below which a direction is a freedom of scale.
const FREEDOM_OF_SCALE: f64 = 1e-9;
/// Factor of the variance that makes bands hold what they say.
const MEASURED_FACTOR: f64 = 2.0;
/// No standard deviation is said to be more than this many times the modulus of the pole and the band: it is not known at all.
const UNKNOWN: f64 = 1e3;

/// The covariance of the parameters of a model.
#[derive(Clone, Debug)]
pub(super) struct ParameterCovariance {
    /// `phi G^+`.
    covariance: DMatrix<f64>,
    /// `G / phi`.
    information: DMatrix<f64>,
}

impl ParameterCovariance {
    /// `phi G^+`; none where an iteration does not end.
    pub(super) fn new(system: &NormalSystem, dispersion: f64) -> Option<Self> {
        let root = pseudo_inverse_root(system.matrix.clone(), FREEDOM_OF_SCALE)?;
        Some(Self {
            covariance: &root * root.transpose() * dispersion,
            information: &system.matrix / dispersion,
        })
    }

    /// That of a fit with these normal systems and this cost, per degree of freedom that the parameters leave; none where they leave none.
    pub(super) fn of(
        likelihood: &Likelihood,
        fit: &Fit,
        systems: &[NormalSystem],
        cost: f64,
    ) -> Option<Self> {
        let freedom = likelihood.freedom(fit.model.order());
        let spare = freedom
            .checked_sub(effective_parameters(fit))
            .filter(|spare| *spare > 0)?;
        Self::new(
            &NormalSystem::sum(fit.model.parameters(), systems),
            cost / spare as f64,
        )
    }

    /// What other lines than those of a fit tell of its model.
    pub(super) fn of_lines(likelihood: &Likelihood, fit: &Fit) -> Option<Self> {
        let parts = likelihood.parts(&fit.model)?;
        let systems = normal_systems(likelihood, &fit.model, &parts)?;
        Self::of(
            likelihood,
            fit,
            &systems,
            parts.iter().map(|part| part.cost).sum(),
        )
    }

    /// The cost over other records where the model may move within its uncertainty (M14.17): `r'r - r'J (G/phi + J'J)^-1 J'r`.
    pub(super) fn moved_cost(
        &self,
        records: &Likelihood,
        model: &BlockModel,
        parts: &[SegmentCost],
    ) -> Option<f64> {
        let system = NormalSystem::sum(model.parameters(), &normal_systems(records, model, parts)?);
        let root = pseudo_inverse_root(&self.information + &system.matrix, FREEDOM_OF_SCALE)?;
        let cost: f64 = parts.iter().map(|part| part.cost).sum();
        Some(cost - root.tr_mul(&system.gradient).norm_squared())
    }

    /// The poles of the model with their standard deviations; `lowest` is the lower end of the band \[rad/s\].
    pub(super) fn poles(&self, model: &BlockModel, lowest: f64) -> Vec<PoleEstimate> {
        let mut place = 0;
        let mut estimates = Vec::new();
        for block in &model.blocks {
            for pole in block.poles() {
                let (re, im) = match block {
                    Block::Single(_) => (self.covariance[(place, place)], 0.0),
                    Block::Pair { a1, .. } => {
                        let factor = -1.0 / (2.0 * pole + a1);
                        self.variances(&[place, place + 1], &[factor, factor * pole])
                    }
                };
                let most = UNKNOWN * pole.norm().max(lowest);
                let sd = |variance: f64| {
                    if variance.is_finite() {
                        variance.max(0.0).sqrt().min(most)
                    } else {
                        most
                    }
                };
                let sd_re = sd(re);
                let sd_im = sd(im);
                let determined = pole.norm() >= lowest && sd_re.hypot(sd_im) <= 0.5 * pole.norm();
                estimates.push(PoleEstimate {
                    pole,
                    sd_re,
                    sd_im,
                    determined,
                });
            }
            place += block.size();
        }
        estimates
    }

    /// Variances of the real and the imaginary part of `sum_k gradient_k d theta_k` over the parameters `places`.
    fn variances(&self, places: &[usize], gradient: &[Complex<f64>]) -> (f64, f64) {
        let mut re = 0.0;
        let mut im = 0.0;
        for (p, x) in places.iter().zip(gradient) {
            for (q, y) in places.iter().zip(gradient) {
                re += self.covariance[(*p, *q)] * x.re * y.re;
                im += self.covariance[(*p, *q)] * x.im * y.im;
            }
        }
        (re, im)
    }

    /// Standard deviations of the response of `model` at `omegas`, those of the neighbouring orders and what is fed back included;
    /// none where there are fewer than two frequencies.
    pub(super) fn bands(
        &self,
        model: &BlockModel,
        neighbours: &[&BlockModel],
        feedback: Option<&Feedback>,
        omegas: &[f64],
        executor: &dyn Executor,
    ) -> Option<ModelBands> {
        let outputs = model.c.nrows();
        let inputs = model.b.ncols();
        let at: Vec<_> = omegas
            .iter()
            .map(|&omega| Gradients::new(model, neighbours, omega))
            .collect();
        // Of each pair over frequency: dB and degrees.
        let of_pair = |pair: usize| {
            let output = pair % outputs;
            let input = pair / outputs;
            let fed_back = |omega: &f64| {
                feedback.map_or(0.0, |of| 0.5 * of.ratio(*omega, (output, input)).powi(2))
            };
            self.pair_bands(
                model,
                &at,
                &omegas.iter().map(fed_back).collect::<Vec<_>>(),
                (output, input),
            )
        };
        let all: Vec<Vec<(f64, f64)>> = each(executor, 0..outputs * inputs, of_pair);
        let of = |part: fn(&(f64, f64)) -> f64| {
            let curve = |pair: Pair| {
                all[pair.input * outputs + pair.output]
                    .iter()
                    .map(part)
                    .collect()
            };
            PairTable::from_fn(outputs, inputs, curve)
        };
        ModelBands::new(omegas.to_vec(), of(|sd| sd.0), of(|sd| sd.1)).ok()
    }

    fn pair_bands(
        &self,
        model: &BlockModel,
        at: &[Gradients],
        fed_back: &[f64],
        (output, input): (usize, usize),
    ) -> Vec<(f64, f64)> {
        let order = model.order();
        let places: Vec<usize> = (0..order)
            .chain((0..order).map(|state| model.place_of_b(state, input)))
            .chain((0..order).map(|state| model.place_of_c(output, state)))
            .chain([model.place_of_d(output, input)])
            .collect();
        let covariance = DMatrix::from_fn(places.len(), places.len(), |row, column| {
            self.covariance[(places[row], places[column])]
        });
        // Real parts, then imaginary parts, one column a frequency.
        let mut gradients = DMatrix::zeros(places.len(), 2 * at.len());
        for (k, gradient) in at.iter().enumerate() {
            for (row, value) in gradient
                .of_pair(model, output, input)
                .into_iter()
                .enumerate()
            {
                (gradients[(row, k)], gradients[(row, at.len() + k)]) = (value.re, value.im);
            }
        }
        let products = covariance * &gradients;
        let variance = |column: usize| {
            products
                .column(column)
                .dot(&gradients.column(column))
                .max(0.0)
        };
        let sd = |column: usize, order: f64| {
            (MEASURED_FACTOR * (variance(column) + order) + fed_back[column % at.len()])
                .sqrt()
                .min(UNKNOWN)
        };
        let bands = |(k, gradients): (usize, &Gradients)| {
            let order = gradients.order_variance[(output, input)];
            (
                neper_to_db(sd(k, order.re)),
                sd(at.len() + k, order.im).to_degrees(),
            )
        };
        at.iter().enumerate().map(bands).collect()
    }
}

/// What the gradients of all responses at one frequency are made of.
struct Gradients {
    response: DMatrix<Complex<f64>>,
    /// `C R`, outputs x n.
    outputs: DMatrix<Complex<f64>>,
    /// `R B`, n x inputs.
    states: DMatrix<Complex<f64>>,
    /// Mean squares of the real and imaginary parts of `ln(H_n'/H_n)`.
    order_variance: DMatrix<Complex<f64>>,
}

impl Gradients {
    fn new(model: &BlockModel, neighbours: &[&BlockModel], omega: f64) -> Self {
        let response = model.response(omega);
        let mut outputs = DMatrix::zeros(model.c.nrows(), model.order());
        model.output_resolvent(omega, outputs.as_mut_slice());
        let mut states = model.b.map(Complex::from);
        for mut column in states.column_iter_mut() {
            model.resolve(omega, column.as_mut_slice());
        }
        let mut order_variance = DMatrix::zeros(response.nrows(), response.ncols());
        for neighbour in neighbours {
            order_variance += neighbour.response(omega).zip_map(&response, |other, own| {
                let ratio = (other / own).ln();
                let finite = |part: f64| {
                    if part.is_finite() {
                        part * part
                    } else {
                        UNKNOWN
                    }
                };
                Complex::new(finite(ratio.re), finite(ratio.im)) / neighbours.len() as f64
            });
        }
        Self {
            response,
            outputs,
            states,
            order_variance,
        }
    }

    /// The gradient of `ln H` of a pair: by the blocks, its column of `B`, its row of `C`, its entry of `D`.
    fn of_pair(&self, model: &BlockModel, output: usize, input: usize) -> Vec<Complex<f64>> {
        let cr = self.outputs.row(output);
        let x = self.states.column(input);
        let mut gradient = Vec::with_capacity(3 * model.order() + 1);
        for (first, block) in model.rows() {
            match block {
                Block::Pair { .. } => {
                    gradient.extend([-cr[first + 1] * x[first], -cr[first + 1] * x[first + 1]])
                }
                Block::Single(_) => gradient.push(cr[first] * x[first]),
            }
        }
        gradient.extend(cr.iter());
        gradient.extend(x.iter());
        gradient.push(Complex::from(1.0));
        let response = self.response[(output, input)];
        let finite = |value: Complex<f64>| {
            if value.re.is_finite() && value.im.is_finite() {
                value
            } else {
                Complex::from(UNKNOWN)
            }
        };
        gradient
            .into_iter()
            .map(|value| finite(value / response))
            .collect()
    }
}

// The bundle of models: the chosen order, its neighbours, and one model without each record (M14, section 5).

/// Damping at the beginning of a step that leaves a record out.
const FIRST_DAMPING: f64 = 1e-4;

/// The number of each record, counted from 0, and the model without it, by one damped step with the systems that are there already.
///
/// ```text
/// (G - G_r + lambda diag) d = g - g_r;  lambda = 1e-4, times 8 until the cost over the other records falls
/// ```
///
/// An undamped step runs away in weak directions. With one record there is none.
pub(super) fn without_each_record(
    likelihood: &Likelihood,
    fit: &Fit,
    systems: &[NormalSystem],
) -> Vec<(usize, BlockModel)> {
    let records = likelihood.records();
    if records.len() < 2 {
        return Vec::new();
    }
    let all = NormalSystem::sum(fit.model.parameters(), systems);
    let without = |&record: &usize| {
        let system = all.without(&likelihood.system_of(record, systems));
        let segments = likelihood.segments.iter().zip(&fit.parts);
        let cost = segments
            .filter(|(segment, _)| segment.record != record)
            .map(|(_, part)| part.cost)
            .sum();
        // Where no step lowers the cost the full model is the best without the record as well.
        let stepped = damped(
            &likelihood.without(record),
            &fit.model,
            &system,
            cost,
            FIRST_DAMPING,
        );
        (
            record,
            stepped.map_or_else(|| fit.model.clone(), |(model, ..)| model),
        )
    };
    each(likelihood.executor, &records, without)
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use gdcm_model::executor::Sequential;
    use gdcm_model::progress::{Shares, Unobserved};
    use gdcm_model::response::frequency_response::log_spaced;
    use gdcm_model::simulation::FlightRecord;

    use super::*;
    use crate::identification::identify::Options;
    use crate::identification::known_answers_tests::{answers, matrix, number, numbers};
    use crate::identification::likelihood::SpectralLines;
    use crate::identification::local_polynomial::{NoiseCovariance, local_polynomial};
    use crate::identification::preparation::Preparation;
    use crate::identification::prepared_data::PreparedData;
    use crate::identification::spectrum::{Spectrum, spectra};
    use crate::identification::subspace::SubspaceSettings;

    /// Turns the second of two real modes of a block around, which a model does not show but the path of its refinement does.
    fn turned(model: &BlockModel) -> BlockModel {
        let Block::Pair { a0, a1 } = model.blocks[0] else {
            panic!("a pair")
        };
        let poles = model.blocks[0].poles();
        // alpha + beta F has the eigenvalues 1 and -1.
        let beta = 2.0 / (poles[0].re - poles[1].re);
        let alpha = 1.0 - beta * poles[0].re;
        let turn = dmatrix![alpha, beta; -beta * a0, alpha - beta * a1];
        let mut turned = model.clone();
        turned
            .b
            .copy_from(&(turn.clone().try_inverse().unwrap() * &model.b));
        turned.c.copy_from(&(&model.c * turn));
        let ratio = (turned.c.norm() / turned.b.norm()).sqrt();
        turned.b *= ratio;
        turned.c /= ratio;
        turned
    }

    #[test]
    fn bands_are_those_of_independent_code() {
        let known = &answers()["noisy"];
        let records: Vec<FlightRecord> = known["records"]
            .as_array()
            .unwrap()
            .iter()
            .map(|known| {
                let inputs = matrix(&known["u"]);
                let outputs = matrix(&known["y"]);
                let time_s = (0..inputs.nrows())
                    .map(|sample| sample as f64 * number(&known["dt"]))
                    .collect();
                FlightRecord {
                    name: String::new(),
                    time_s,
                    inputs,
                    outputs,
                }
            })
            .collect();
        let band = numbers(&known["band"]);
        let preparation = Preparation::of(&["U1", "U2"], &["Y1", "Y2"]);
        let options = Options {
            held_out: vec![4],
            ..Options::new([band[0], band[1]], preparation)
        };
        let progress = Shares::new(&Unobserved);
        let data = PreparedData::new(&records, &options, &Sequential, &progress).unwrap();
        // Those figures are of all lines around the band, the first of a record too (M14, 2), which does not count any more (M14.12).
        let [lowest, highest] = [0.5 * band[0], 4.0 / 3.0 * band[1]];
        let between = |lines: Spectrum| lines.between(lowest / 1.3, 1.3 * highest);
        let wide: Vec<Spectrum> = spectra(&data.unfiltered, 1.3 * highest, &Sequential)
            .into_iter()
            .map(between)
            .collect();
        let measured =
            local_polynomial(&wide, &log_spaced(lowest, highest, 40), &Sequential).unwrap();
        let noise = NoiseCovariance::of(&measured).unwrap();
        let whitened =
            |lines: &Spectrum| SpectralLines::new(&lines.between(lowest, highest), &noise).unwrap();
        let likelihood = &Likelihood {
            segments: wide.iter().map(whitened).collect(),
            executor: &Sequential,
        };
        let whole = |name: &str| {
            numbers(&known[name])
                .into_iter()
                .map(|value| value as usize)
                .collect::<Vec<_>>()
        };
        let poles = numbers(&known["poles_a"]);
        let pasts = whole("pasts");
        let orders = whole("orders");
        let settings = SubspaceSettings {
            highest: band[1],
            poles,
            pasts,
            orders,
            longest_future: 12,
        };
        let candidates = settings
            .candidates(&data.segments, likelihood, &progress)
            .unwrap();
        let starts = settings.starts(&candidates, likelihood);
        let refined = |model: BlockModel, count| {
            Fit::start(likelihood, model)
                .unwrap()
                .refined(likelihood, count, 1e-3, &progress)
        };
        let fit = refined(starts[&4].model.clone(), 8).unwrap();
        let below = refined(turned(&starts[&2].model), 3).unwrap();
        let above = refined(starts[&6].model.clone(), 3).unwrap();

        let system = NormalSystem::sum(fit.model.parameters(), &fit.systems(likelihood).unwrap());
        let spare = likelihood.freedom(4) - effective_parameters(&fit);
        let covariance = ParameterCovariance::new(&system, fit.cost / spare as f64).unwrap();
        let expected = &known["expected"];
        let bands = covariance
            .bands(
                &fit.model,
                &[&below.model, &above.model],
                None,
                &numbers(&expected["w"]),
                &Sequential,
            )
            .unwrap();
        let tolerance = number(&expected["sd_tolerance_relative"]);
        for (found, name) in [(bands.sd_db(), "sd_db"), (bands.sd_deg(), "sd_deg")] {
            for (Pair { output, input }, found) in found.iter() {
                for (k, found) in found.iter().enumerate() {
                    let expected = matrix(&expected[name][k])[(output, input)];
                    // Independent numpy code; the tolerance stands in its file.
                    assert!(
                        (found / expected - 1.0).abs() < tolerance,
                        "{name} {k}: {found}, not {expected}"
                    );
                }
            }
        }
    }
}
