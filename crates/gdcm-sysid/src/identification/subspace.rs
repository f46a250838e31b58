//! Models from the triangular factor of the data matrix (M14, section 3, steps 3 to 5).
//!
//! ```text
//! Z0 = [z_0 ... z_{p-1}], Z1 = [z_1 ... z_p], U = u~_p, Y = y~_p, all of them columns of R
//! 1  Theta = argmin |[Z0 U] Theta - Y|^2 + ridge |Theta|^2                             predictor with an exogenous input
//! 2  Gamma K: block row i = the first (p - i) q columns of Theta', placed from column i q;   i = 0 ... f - 1, f = min(p, f_max)
//! 3  Gamma K Z0' = W S V';   T = S_n^-1/2 W_n' Gamma K;   X0 = Z0 T', X1 = Z1 T'        states
//! 4  [Co Do] from Y on [X0 U], residual E;   [Ao Bo Ko] from X1 on [X0 U E]
//! ```
//!
//! Chiuso, "The role of vector autoregressive modeling in predictor-based subspace identification", Automatica 43, 2007.

use std::collections::BTreeMap;

use nalgebra::{Complex, DMatrix, DMatrixView};

use gdcm_model::dataset::StateSpace;
use gdcm_model::executor::{Executor, each};
use gdcm_model::progress::Shares;
use gdcm_model::response::eigenvalues::poles;
use gdcm_model::simulation::Segment;

use super::blocks::BlockModel;
use super::identification_error::IdentificationError;
use super::laguerre::{Projections, TriangularFactor, continuous, least_squares, ridge_solution};
use super::likelihood::Likelihood;
use super::mode_removal::without_fast_modes;
use super::refinement::Fit;
use super::search_extent::SPACING;

/// The states of every order that one pole and one past window propose.
#[derive(Clone, Debug)]
pub(super) struct Subspace {
    pole: f64,
    inputs: usize,
    /// `R`, its leading (p + 1) q columns and rows.
    factor: DMatrix<f64>,
    /// `Gamma K`.
    map: DMatrix<f64>,
    /// `W`.
    left: DMatrix<f64>,
    /// The diagonal of `S`, descending.
    pub(super) singular_values: Vec<f64>,
}

impl Subspace {
    /// What the triangular factor of the data matrix of a pole \[rad/s\] says for the past window `past`; none where the
    /// regressors depend on each other or an iteration does not end. The map to the future has `longest_future` block rows at most, and
    /// the predictor a `ridge` over columns of length one.
    pub(super) fn new(
        factor: &TriangularFactor,
        pole: f64,
        (inputs, outputs): (usize, usize),
        past: usize,
        longest_future: usize,
        ridge: f64,
    ) -> Option<Self> {
        let channels = inputs + outputs;
        let width = past * channels;
        let all = width + channels;
        if factor.matrix().ncols() < all {
            return None;
        }
        let factor = factor.matrix().view((0, 0), (all, all)).into_owned();
        let theta = ridge_solution(factor.as_view(), width + inputs, ridge)?.transpose();
        let future = past.min(longest_future);
        let mut map = DMatrix::zeros(future * outputs, width);
        for row in 0..future {
            let kept = (past - row) * channels;
            map.view_mut((row * outputs, row * channels), (outputs, kept))
                .copy_from(&theta.columns(0, kept));
        }
        // The left factors of the transposed triangular factor of (Gamma K Z0')' are those of Gamma K Z0'.
        let mut transposed = TriangularFactor::empty(future * outputs);
        transposed.append(&(factor.view((0, 0), (width, width)) * map.transpose()));
        let decomposition =
            transposed
                .matrix()
                .transpose()
                .try_svd(true, false, f64::EPSILON, 10_000)?;
        let singular_values: Vec<f64> = decomposition.singular_values.iter().copied().collect();
        let finite = singular_values.iter().all(|value| value.is_finite());
        finite.then_some(Self {
            pole,
            inputs,
            factor,
            map,
            left: decomposition.u?,
            singular_values,
        })
    }

    /// The model of an order in continuous time; none where the data do not hold so many states.
    pub(super) fn model(&self, order: usize) -> Option<StateSpace> {
        let all = self.factor.ncols();
        let inputs = self.inputs;
        let width = self.map.ncols();
        let channels = all - width;
        let outputs = channels - inputs;
        let roots = self
            .singular_values
            .get(..order)?
            .iter()
            .map(|value| value.sqrt());
        let mut states = self.left.columns(0, order).transpose() * &self.map;
        for (mut row, root) in states.row_iter_mut().zip(roots) {
            if root == 0.0 {
                return None;
            }
            row.unscale_mut(root);
        }
        let transposed = states.transpose();
        let before = self.factor.columns(0, width) * &transposed;
        let after = self.factor.columns(channels, width) * &transposed;
        let u = self.factor.columns(width, inputs);
        let y = self.factor.columns(width + inputs, outputs);
        let regressors = side_by_side(&[before.as_view(), u.as_view()]);
        let outputs_of = least_squares(&regressors, &y.into_owned())?;
        let innovation = y - &regressors * &outputs_of;
        let states_of = least_squares(
            &side_by_side(&[regressors.as_view(), innovation.as_view()]),
            &after,
        )?;
        let part = |solution: &DMatrix<f64>, from, count| solution.rows(from, count).transpose();
        let a = part(&states_of, 0, order);
        let b = part(&states_of, order, inputs);
        let c = part(&outputs_of, 0, order);
        let d = part(&outputs_of, order, inputs);
        continuous(self.pole, &StateSpace::new(a, b, c, d).ok()?)
    }
}

fn side_by_side(parts: &[DMatrixView<'_, f64>]) -> DMatrix<f64> {
    let rows = parts.first().map_or(0, |part| part.nrows());
    let columns: Vec<_> = parts.iter().flat_map(|part| part.column_iter()).collect();
    DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row])
}

// Models that CT-PBSID proposes, and the cheapest of them for every order (M14, section 3).
//
// ```text
// 1  R for each Laguerre pole a
// 2  for each a and past window p: the model of order 18, its cost
// 3  for the two cheapest (a, p): the models of all orders; of one order the cheaper is kept
// ```

/// Order at which poles and past windows are compared at most.
const RANKING_ORDER: usize = 18;
/// How many poles and past windows propose models of all orders.
const KEPT: usize = 2;
/// Modes beyond this many times the upper end of the band are images of z near -1.
const FASTEST: f64 = 8.0;
/// Share of the whole work that the candidates are.
const SHARE: f64 = 0.2;
/// Ridge of the predictor over columns of length one.
const RIDGE: f64 = 1e-8;

/// What CT-PBSID is run with.
#[derive(Clone, Debug)]
pub(super) struct SubspaceSettings {
    /// Upper end of the band \[rad/s\].
    pub(super) highest: f64,
    /// Laguerre poles \[rad/s\].
    pub(super) poles: Vec<f64>,
    /// Past windows.
    pub(super) pasts: Vec<usize>,
    /// Orders, ascending.
    pub(super) orders: Vec<usize>,
    /// Block rows of the map to the future at most.
    pub(super) longest_future: usize,
}

/// The states that one pole and past window propose.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    /// Laguerre pole \[rad/s\].
    pub(super) pole: f64,
    /// Past window.
    pub(super) past: usize,
    /// Cost at the order of the comparison.
    cost: f64,
    subspace: Subspace,
}

impl SubspaceSettings {
    /// The two cheapest poles and past windows, the cheaper first.
    pub(super) fn candidates(
        &self,
        segments: &[Segment],
        likelihood: &Likelihood,
        progress: &Shares,
    ) -> Result<Vec<Candidate>, IdentificationError> {
        let pasts = &self.pasts;
        let (Some(&longest), Some(order)) = (pasts.iter().max(), self.ranking_order(segments))
        else {
            return Ok(Vec::new());
        };
        let executor = likelihood.executor;
        let share = SHARE / (self.poles.len() * (pasts.len() + 1)) as f64;
        let of_pole = |(k, &pole): (usize, &f64)| {
            let told = format!("pole {} of {}", k + 1, self.poles.len());
            progress.advance(share, &format!("{told}, projections"))?;
            let factor = self.projections(pole, longest).factor(segments, executor);
            let of_past = |&past: &usize| {
                progress.advance(share, &format!("{told}, past {past}"))?;
                Ok(self.candidate(&factor, (pole, past), order, segments, likelihood))
            };
            each(executor, pasts, of_past)
                .into_iter()
                .collect::<Result<Vec<_>, IdentificationError>>()
        };
        let all = each(executor, self.poles.iter().enumerate(), of_pole)
            .into_iter()
            .collect::<Result<Vec<_>, _>>()?;
        let mut found: Vec<Candidate> = all.into_iter().flatten().flatten().collect();
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found.truncate(KEPT);
        Ok(found)
    }

    /// For each order the cheaper of the models of `candidates`, with its cost.
    pub(super) fn starts(
        &self,
        candidates: &[Candidate],
        likelihood: &Likelihood,
    ) -> BTreeMap<usize, Fit> {
        let cheapest = |&order: &usize| {
            let models = candidates
                .iter()
                .filter_map(|candidate| self.model(&candidate.subspace, order));
            let fits = models.filter_map(|model| Fit::start(likelihood, model));
            fits.min_by(|a, b| a.cost.total_cmp(&b.cost))
                .map(|fit| (order, fit))
        };
        each(likelihood.executor, &self.orders, cheapest)
            .into_iter()
            .flatten()
            .collect()
    }

    /// The poles of the models of each order that a candidate proposes.
    pub(super) fn poles_by_order(
        &self,
        candidate: &Candidate,
        executor: &dyn Executor,
    ) -> Vec<(usize, Vec<nalgebra::Complex<f64>>)> {
        let of_order =
            |&order: &usize| Some((order, poles(&self.slow(&candidate.subspace, order)?)?));
        each(executor, &self.orders, of_order)
            .into_iter()
            .flatten()
            .collect()
    }

    fn projections(&self, pole: f64, past: usize) -> Projections {
        Projections {
            pole,
            past,
            spacing_s: SPACING / self.highest,
        }
    }

    /// The order at which poles and past windows are compared: one that the shortest past window has states for.
    fn ranking_order(&self, segments: &[Segment]) -> Option<usize> {
        let outputs = segments.first()?.outputs.ncols();
        let future = self.pasts.iter().min()?.min(&self.longest_future);
        Some(
            RANKING_ORDER
                .min(*self.orders.last()?)
                .min(future * outputs),
        )
    }

    fn candidate(
        &self,
        factor: &TriangularFactor,
        (pole, past): (f64, usize),
        order: usize,
        segments: &[Segment],
        likelihood: &Likelihood,
    ) -> Option<Candidate> {
        let segment = segments.first()?;
        let channels = (segment.inputs.ncols(), segment.outputs.ncols());
        let subspace = Subspace::new(factor, pole, channels, past, self.longest_future, RIDGE)?;
        let cost = likelihood.cost(&self.model(&subspace, order)?)?;
        Some(Candidate {
            pole,
            past,
            cost,
            subspace,
        })
    }

    /// The model of an order without modes far above the band.
    fn slow(&self, subspace: &Subspace, order: usize) -> Option<StateSpace> {
        without_fast_modes(&subspace.model(order)?, FASTEST * self.highest)
    }

    /// The same in blocks; none where all its modes are far above the band.
    fn model(&self, subspace: &Subspace, order: usize) -> Option<BlockModel> {
        BlockModel::of(&self.slow(subspace, order)?)
    }
}

// The stabilisation diagram: which poles stay where they are while the order rises (M14, section 3).

/// Greatest relative distance of a stable pole from one of the order before.
const STABLE: f64 = 0.05;

/// A pole of the unrefined model of an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilisationPoint {
    /// Order of the model.
    pub order: usize,
    /// Pole \[rad/s\], imaginary part not negative: of a pair the upper one.
    pub pole: Complex<f64>,
    /// Whether a model of the order two less has a pole within 5 % of its modulus.
    pub stable: bool,
}

/// The diagram from the poles of each order, ascending.
pub(super) fn stabilisation(poles: &[(usize, Vec<Complex<f64>>)]) -> Vec<StabilisationPoint> {
    let of_order = |(order, own): &(usize, Vec<Complex<f64>>)| {
        let before = poles
            .iter()
            .find(|(other, _)| other + 2 == *order)
            .map(|(_, poles)| poles);
        let point = |pole: Complex<f64>| {
            let near = |other: &Complex<f64>| (other - pole).norm() < STABLE * pole.norm();
            StabilisationPoint {
                order: *order,
                pole,
                stable: before.is_some_and(|before| before.iter().any(near)),
            }
        };
        own.iter()
            .filter(|pole| pole.im >= 0.0)
            .map(|pole| point(*pole))
            .collect::<Vec<_>>()
    };
    poles.iter().flat_map(of_order).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::known_answers_tests::{
        answers, matrix, number, numbers, response, response_at,
    };

    #[test]
    fn a_system_without_noise_comes_back() {
        let known = &answers()["pbsid_noise_free"];
        let inputs = matrix(&known["u"]);
        let outputs = matrix(&known["y"]);
        let channels = (inputs.ncols(), outputs.ncols());
        let dt = number(&known["dt"]);
        let past = number(&known["p"]) as usize;
        let segment = Segment {
            record: 0,
            start_s: 0.0,
            sample_time_s: dt,
            inputs,
            outputs,
        };
        let projections = Projections {
            pole: number(&known["a"]),
            past,
            spacing_s: dt,
        };
        let rows = projections.rows(&segment);
        let mut factor = TriangularFactor::empty(rows.ncols());
        factor.append(&rows);
        let subspace = Subspace::new(&factor, projections.pole, channels, past, 2, 0.0).unwrap();
        // Independent numpy code; the tolerances stand in its file.
        for (found, expected) in subspace
            .singular_values
            .iter()
            .zip(numbers(&known["singular_values"]))
        {
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
        let model = subspace.model(4).unwrap();
        for (omega, expected) in numbers(&known["w"]).into_iter().zip(response(&known["H"])) {
            assert!((response_at(&model, omega) - expected).camax() < 1e-6);
        }
    }

    #[test]
    fn a_pole_is_stable_when_the_order_before_has_it() {
        let pole = |re: f64, im: f64| Complex::new(re, im);
        let orders = [
            (2, vec![pole(-1.0, 2.0), pole(-1.0, -2.0)]),
            (
                4,
                vec![
                    pole(-1.0, 2.05),
                    pole(-1.0, -2.05),
                    pole(-3.0, 0.0),
                    pole(-8.0, 0.0),
                ],
            ),
        ];
        let diagram = stabilisation(&orders);
        let stable: Vec<_> = diagram
            .iter()
            .map(|point| (point.order, point.pole.re, point.stable))
            .collect();
        assert_eq!(
            stable,
            [
                (2, -1.0, false),
                (4, -1.0, true),
                (4, -3.0, false),
                (4, -8.0, false)
            ]
        );
    }
}
