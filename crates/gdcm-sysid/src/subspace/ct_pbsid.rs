//! CT-PBSID: models of all orders from the data matrix's triangular factor (M14.3).
//!
//! ```text
//! Z0 = [z_0 ... z_{p-1}], Z1 = [z_1 ... z_p], U = u~_p, Y = y~_p, columns of R
//! 1  Theta = argmin |[Z0 U] Theta - Y|^2 + ridge |Theta|^2     predictor with an exogenous input
//! 2  Gamma K: block row i = Theta' columns 1 to (p - i) q, placed from column i q
//!    i = 0 ... f - 1, f = min(p, f_max)
//! 3  Gamma K Z0' = W S V';   T = S_n^-1/2 W_n' Gamma K;   states X0 = Z0 T', X1 = Z1 T'
//! 4  [Co Do] from Y on [X0 U], residual E;   [Ao Bo Ko] from X1 on [X0 U E]
//! ```
//!
//! A. Chiuso, "The role of vector autoregressive modeling in predictor-based subspace
//! identification", Automatica 43, 2007.

use std::collections::BTreeMap;

use nalgebra::{Complex, DMatrix, DMatrixView};

use gdcm_model::dataset::StateSpace;
use gdcm_model::executor::{Executor, each};
use gdcm_model::progress::Shares;
use gdcm_model::response::eigenvalues::poles;
use gdcm_model::simulation::Segment;

use super::fast_modes::without_fast_modes;
use super::laguerre::{Projections, continuous};
use super::search_extent::SPACING;
use super::triangular_factor::{TriangularFactor, least_squares, ridge_solution};
use crate::identification_error::IdentificationError;
use crate::likelihood::blocks::BlockModel;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::refinement::Fit;

/// Highest order at which poles and past windows are compared.
const RANKING_ORDER: usize = 18;
/// Poles and past windows that propose models for all orders.
const KEPT: usize = 2;
/// Modes beyond this many times the upper band end are images of z near -1.
const FASTEST: f64 = 8.0;
/// Share of the whole work that the candidates take.
const SHARE: f64 = 0.2;
/// Ridge of the predictor over unit columns.
const RIDGE: f64 = 1e-8;
/// Relative distance up to which a pole is stable between orders.
const STABLE: f64 = 0.05;

/// Dimensions for a data matrix and its map to the future.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SubspaceShape {
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    /// Past window p.
    pub(crate) past: usize,
    /// Most block rows in the map to the future, `f_max`.
    pub(crate) longest_future: usize,
}

/// The states that a Laguerre pole and a past window propose, for every order.
#[derive(Clone, Debug)]
pub(crate) struct Subspace {
    pole: f64,
    inputs: usize,
    /// `R`, its leading (p + 1) q columns and rows.
    factor: DMatrix<f64>,
    /// `Gamma K`.
    map: DMatrix<f64>,
    /// `W`.
    left: DMatrix<f64>,
    /// The diagonal of `S`, descending.
    pub(crate) singular_values: Vec<f64>,
}

impl Subspace {
    /// Computes the states (steps 1 to 3) from the triangular factor at a Laguerre pole \[rad/s\];
    /// `ridge` is over unit columns.
    ///
    /// Returns `None` if the regressors depend on each other or an iteration does not converge.
    pub(crate) fn new(
        factor: &TriangularFactor,
        pole: f64,
        shape: SubspaceShape,
        ridge: f64,
    ) -> Option<Self> {
        let SubspaceShape {
            inputs,
            outputs,
            past,
            longest_future,
        } = shape;
        let channels = inputs + outputs;
        let width = past * channels;
        let size = width + channels;
        if factor.matrix().ncols() < size {
            return None;
        }
        let factor = factor.matrix().view((0, 0), (size, size)).into_owned();
        let theta = ridge_solution(factor.as_view(), width + inputs, ridge)?.transpose();
        let future = past.min(longest_future);
        let mut map = DMatrix::zeros(future * outputs, width);
        for row in 0..future {
            let kept = (past - row) * channels;
            map.view_mut((row * outputs, row * channels), (outputs, kept))
                .copy_from(&theta.columns(0, kept));
        }
        // The transposed triangular factor of (Gamma K Z0')' shares its left factors with Gamma K
        // Z0'.
        let mut transposed = TriangularFactor::empty(future * outputs);
        transposed.append(&(factor.view((0, 0), (width, width)) * map.transpose()));
        let decomposition =
            transposed
                .matrix()
                .transpose()
                .try_svd(true, false, f64::EPSILON, 10_000)?;
        let singular_values: Vec<f64> = decomposition.singular_values.iter().copied().collect();
        if !singular_values.iter().all(|value| value.is_finite()) {
            return None;
        }
        Some(Self {
            pole,
            inputs,
            factor,
            map,
            left: decomposition.u?,
            singular_values,
        })
    }

    /// Computes an order's continuous-time model (step 4); `None` if the data do not hold so
    /// many states.
    pub(crate) fn model(&self, order: usize) -> Option<StateSpace> {
        let inputs = self.inputs;
        let width = self.map.ncols();
        let channels = self.factor.ncols() - width;
        let outputs = channels - inputs;
        let states = self.state_map(order)?.transpose();
        let x0 = self.factor.columns(0, width) * &states;
        let x1 = self.factor.columns(channels, width) * &states;
        let u = self.factor.columns(width, inputs);
        let y = self.factor.columns(width + inputs, outputs);
        let regressors = side_by_side(&[x0.as_view(), u.as_view()]);
        let output_solution = least_squares(&regressors, &y.into_owned())?;
        let innovation = y - &regressors * &output_solution;
        let regressors = side_by_side(&[regressors.as_view(), innovation.as_view()]);
        let state_solution = least_squares(&regressors, &x1)?;
        let a = state_solution.rows(0, order).transpose();
        let b = state_solution.rows(order, inputs).transpose();
        let c = output_solution.rows(0, order).transpose();
        let d = output_solution.rows(order, inputs).transpose();
        continuous(self.pole, &StateSpace::new(a, b, c, d).ok()?)
    }

    /// Computes `T = S_n^-1/2 W_n' Gamma K`.
    fn state_map(&self, order: usize) -> Option<DMatrix<f64>> {
        let singular_values = self.singular_values.get(..order)?;
        let mut map = self.left.columns(0, order).transpose() * &self.map;
        for (mut row, value) in map.row_iter_mut().zip(singular_values) {
            let root = value.sqrt();
            if root == 0.0 {
                return None;
            }
            row.unscale_mut(root);
        }
        Some(map)
    }
}

/// Joins matrices side by side.
fn side_by_side(parts: &[DMatrixView<'_, f64>]) -> DMatrix<f64> {
    let rows = parts.first().map_or(0, |part| part.nrows());
    let columns: Vec<_> = parts.iter().flat_map(|part| part.column_iter()).collect();
    DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row])
}

/// CT-PBSID settings.
#[derive(Clone, Debug)]
pub(crate) struct SubspaceSettings {
    /// Upper band end \[rad/s\].
    pub(crate) highest: f64,
    /// Laguerre poles \[rad/s\].
    pub(crate) poles: Vec<f64>,
    /// Past windows.
    pub(crate) pasts: Vec<usize>,
    /// Ascending.
    pub(crate) orders: Vec<usize>,
    /// Most block rows in the map to the future.
    pub(crate) longest_future: usize,
}

/// The states that a Laguerre pole and a past window propose.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Laguerre pole \[rad/s\].
    pub(crate) pole: f64,
    /// Past window.
    pub(crate) past: usize,
    /// Cost at the compared order.
    cost: f64,
    subspace: Subspace,
}

/// The poles of an order's model.
pub(crate) struct PolesOfOrder {
    pub(crate) order: usize,
    /// \[rad/s\].
    pub(crate) poles: Vec<Complex<f64>>,
}

impl SubspaceSettings {
    /// Returns the two cheapest poles and past windows, the cheaper first.
    ///
    /// ```text
    /// 1  R for each Laguerre pole a
    /// 2  for each a and past window p: the model of order 18, its cost
    /// 3  the two cheapest (a, p)
    /// ```
    pub(crate) fn candidates(
        &self,
        segments: &[Segment],
        likelihood: &Likelihood,
        progress: &Shares,
    ) -> Result<Vec<Candidate>, IdentificationError> {
        let Some(ranking) = Ranking::new(self, segments, likelihood, progress) else {
            return Ok(Vec::new());
        };
        let numbers = 0..self.poles.len();
        let mut candidates = Vec::new();
        for of_pole in each(likelihood.executor, numbers, |k| ranking.rank_pole(k)) {
            candidates.extend(of_pole?);
        }
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        candidates.truncate(KEPT);
        Ok(candidates)
    }

    /// Returns each order's cheapest model from `candidates`, with its cost.
    pub(crate) fn starts(
        &self,
        candidates: &[Candidate],
        likelihood: &Likelihood,
    ) -> BTreeMap<usize, Fit> {
        let cheapest = each(likelihood.executor, &self.orders, |&order| {
            candidates
                .iter()
                .filter_map(|candidate| self.block_model(&candidate.subspace, order))
                .filter_map(|model| Fit::start(likelihood, model))
                .min_by(|a, b| a.cost.total_cmp(&b.cost))
        });
        let mut starts = BTreeMap::new();
        for (order, fit) in self.orders.iter().zip(cheapest) {
            if let Some(fit) = fit {
                starts.insert(*order, fit);
            }
        }
        starts
    }

    /// Returns the poles that a candidate proposes, for all orders.
    pub(crate) fn poles_by_order(
        &self,
        candidate: &Candidate,
        executor: &dyn Executor,
    ) -> Vec<PolesOfOrder> {
        each(executor, &self.orders, |&order| {
            let model = self.slow_model(&candidate.subspace, order)?;
            let poles = poles(&model)?;
            Some(PolesOfOrder { order, poles })
        })
        .into_iter()
        .flatten()
        .collect()
    }

    /// Returns an order's model without modes far above the band.
    fn slow_model(&self, subspace: &Subspace, order: usize) -> Option<StateSpace> {
        without_fast_modes(&subspace.model(order)?, FASTEST * self.highest)
    }

    /// Returns the same in blocks; `None` if all its modes are far above the band.
    fn block_model(&self, subspace: &Subspace, order: usize) -> Option<BlockModel> {
        BlockModel::from_state_space(&self.slow_model(subspace, order)?)
    }
}

/// Compares Laguerre poles and past windows.
struct Ranking<'r> {
    settings: &'r SubspaceSettings,
    segments: &'r [Segment],
    likelihood: &'r Likelihood<'r>,
    progress: &'r Shares<'r>,
    inputs: usize,
    outputs: usize,
    longest_past: usize,
    /// Order at which models are compared.
    order: usize,
    /// Share of the whole work that is reported for a step.
    share: f64,
}

impl<'r> Ranking<'r> {
    /// Chooses an order for which the shortest past window has states; `None` without orders, past
    /// windows or segments.
    fn new(
        settings: &'r SubspaceSettings,
        segments: &'r [Segment],
        likelihood: &'r Likelihood<'r>,
        progress: &'r Shares<'r>,
    ) -> Option<Self> {
        let segment = segments.first()?;
        let outputs = segment.outputs.ncols();
        let future = settings.pasts.iter().min()?.min(&settings.longest_future);
        let steps = settings.poles.len() * (settings.pasts.len() + 1);
        Some(Self {
            settings,
            segments,
            likelihood,
            progress,
            inputs: segment.inputs.ncols(),
            outputs,
            longest_past: *settings.pasts.iter().max()?,
            order: RANKING_ORDER
                .min(*settings.orders.last()?)
                .min(future * outputs),
            share: SHARE / steps as f64,
        })
    }

    /// Computes a pole's candidates, by its number.
    fn rank_pole(&self, number: usize) -> Result<Vec<Candidate>, IdentificationError> {
        let executor = self.likelihood.executor;
        let poles = &self.settings.poles;
        let step = format!("pole {} of {}", number + 1, poles.len());
        self.progress
            .advance(self.share, &format!("{step}, projections"))?;
        let projections = Projections {
            pole: poles[number],
            past: self.longest_past,
            spacing_s: SPACING / self.settings.highest,
        };
        let factor = projections.factor(self.segments, executor);
        let mut candidates = Vec::new();
        let of_pasts = each(executor, &self.settings.pasts, |&past| {
            self.progress
                .advance(self.share, &format!("{step}, past {past}"))?;
            Ok::<_, IdentificationError>(self.candidate(&factor, poles[number], past))
        });
        for candidate in of_pasts {
            candidates.extend(candidate?);
        }
        Ok(candidates)
    }

    /// Computes the candidate for a pole and a past window; `None` if it proposes no model.
    fn candidate(&self, factor: &TriangularFactor, pole: f64, past: usize) -> Option<Candidate> {
        let shape = SubspaceShape {
            inputs: self.inputs,
            outputs: self.outputs,
            past,
            longest_future: self.settings.longest_future,
        };
        let subspace = Subspace::new(factor, pole, shape, RIDGE)?;
        let model = self.settings.block_model(&subspace, self.order)?;
        let cost = self.likelihood.cost(&model)?;
        Some(Candidate {
            pole,
            past,
            cost,
            subspace,
        })
    }
}

/// An unrefined model's pole, for the stabilisation diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilisationPoint {
    /// Model order.
    pub order: usize,
    /// Pole \[rad/s\] with a non-negative imaginary part: the upper pole in a pair.
    pub pole: Complex<f64>,
    /// Whether the model with two states less has a pole within 5 %, relative to its modulus.
    pub stable: bool,
}

/// Finds the poles that stay in place while the order rises; `orders` are ascending.
pub(crate) fn stabilisation(orders: &[PolesOfOrder]) -> Vec<StabilisationPoint> {
    let mut points = Vec::new();
    for own in orders {
        let before = orders
            .iter()
            .find(|other| other.order + 2 == own.order)
            .map_or(&[][..], |other| other.poles.as_slice());
        for &pole in own.poles.iter().filter(|pole| pole.im >= 0.0) {
            points.push(StabilisationPoint {
                order: own.order,
                pole,
                stable: before
                    .iter()
                    .any(|other| (other - pole).norm() < STABLE * pole.norm()),
            });
        }
    }
    points
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
        let dt = number(&known["dt"]);
        let shape = SubspaceShape {
            inputs: inputs.ncols(),
            outputs: outputs.ncols(),
            past: number(&known["p"]) as usize,
            longest_future: 2,
        };
        let segment = Segment {
            record: 0,
            start_s: 0.0,
            sample_time_s: dt,
            inputs,
            outputs,
        };
        let projections = Projections {
            pole: number(&known["a"]),
            past: shape.past,
            spacing_s: dt,
        };
        let rows = projections.rows(&segment);
        let mut factor = TriangularFactor::empty(rows.ncols());
        factor.append(&rows);
        let subspace = Subspace::new(&factor, projections.pole, shape, 0.0).unwrap();
        // Independent numpy code; the tolerances are stated in its file.
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
        let orders = [
            PolesOfOrder {
                order: 2,
                poles: vec![Complex::new(-1.0, 2.0), Complex::new(-1.0, -2.0)],
            },
            PolesOfOrder {
                order: 4,
                poles: vec![
                    Complex::new(-1.0, 2.05),
                    Complex::new(-1.0, -2.05),
                    Complex::new(-3.0, 0.0),
                    Complex::new(-8.0, 0.0),
                ],
            },
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
