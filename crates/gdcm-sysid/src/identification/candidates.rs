//! Compares Laguerre poles and past windows by the cost of their models (M14.3, M14.7).
//!
//! CT-PBSID projects the signals on Laguerre functions, whose time scale is the *Laguerre pole*
//! (`laguerre`). The *past window* is how many projections predict the next (`ct_pbsid`). A
//! *candidate* is a pair of both, and proposes a model of each order.

use std::collections::BTreeMap;

use gdcm_model::dataset::StateSpace;
use gdcm_model::executor::{Executor, each};
use gdcm_model::progress::{Cancelled, Shares};
use gdcm_model::response::mode::poles;
use gdcm_model::simulation::Segment;

use crate::likelihood::cost::Likelihood;
use crate::likelihood::descent::Fit;
use crate::likelihood::schur_model::SchurModel;
use crate::subspace::ct_pbsid::{Subspace, SubspaceShape};
use crate::subspace::data_matrix::Projections;
use crate::subspace::fast_modes::without_fast_modes;
use crate::subspace::stabilisation::PolesOfOrder;
use crate::subspace::triangular_factor::TriangularFactor;
use crate::subspace::tried_orders::SPACING;

/// Highest order at which poles and past windows are compared (M14.3, M14.13).
const RANKING_ORDER: usize = 18;
/// Number of pairs (pole, past window) that propose models of all orders (M14.3).
const BEST_CANDIDATES: usize = 2;
/// Modes faster than this many times the upper end of the band are artefacts: they come from
/// eigenvalues near -1 of the matrix that advances the Laguerre projections (`continuous_model`).
const FASTEST: f64 = 8.0;
/// The candidates' share of the total progress.
const SHARE: f64 = 0.2;
/// Ridge for the predictor, whose columns are scaled to unit length.
const RIDGE: f64 = 1e-8;

/// CT-PBSID settings.
#[derive(Clone, Debug)]
pub(crate) struct SubspaceSettings {
    /// Upper band end \[rad/s\].
    pub(crate) highest: f64,
    /// Laguerre poles \[rad/s\].
    pub(crate) poles: Vec<f64>,
    /// Past windows \[Laguerre projections\].
    pub(crate) pasts: Vec<usize>,
    /// Orders, ascending.
    pub(crate) orders: Vec<usize>,
    /// Maximum number of block rows in the map to the future.
    pub(crate) longest_future: usize,
}

/// States proposed with a Laguerre pole and a past window, and their model's cost.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    /// Laguerre pole \[rad/s\].
    pub(crate) pole: f64,
    /// Past window \[Laguerre projections\].
    pub(crate) past: usize,
    /// Cost of the model at the order at which candidates are compared.
    cost: f64,
    subspace: Subspace,
}

impl SubspaceSettings {
    /// Returns the two cheapest pairs (pole, past window), the cheapest first.
    ///
    /// ```text
    /// 1  the triangular factor of the projections for each Laguerre pole a
    /// 2  for each a and past window p: the model of order 18, or of the highest order that is
    ///    listed and that every past window allows; its cost
    /// 3  the two cheapest (a, p)
    /// ```
    pub(crate) fn candidates(
        &self,
        segments: &[Segment],
        likelihood: &Likelihood,
        progress: &Shares,
    ) -> Result<Vec<Candidate>, Cancelled> {
        // Steps 1 and 2, pole by pole.
        let Some(ranking) = Ranking::new(self, segments, likelihood, progress) else {
            return Ok(Vec::new());
        };
        let numbers = 0..self.poles.len();
        let mut candidates = Vec::new();
        for candidates_of_pole in each(likelihood.executor, numbers, |k| ranking.rank_pole(k)) {
            candidates.extend(candidates_of_pole?);
        }
        // Step 3.
        candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        candidates.truncate(BEST_CANDIDATES);
        Ok(candidates)
    }

    /// Returns the cheapest model from the candidates at each order; orders without a model are
    /// left out.
    pub(crate) fn starts(
        &self,
        candidates: &[Candidate],
        likelihood: &Likelihood,
    ) -> BTreeMap<usize, Fit> {
        let cheapest = each(likelihood.executor, &self.orders, |&order| {
            candidates
                .iter()
                .filter_map(|candidate| self.evaluated_model(&candidate.subspace, order))
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

    /// Returns the poles that a candidate proposes at each order, without fast modes; orders
    /// without a model are left out.
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

    /// Returns the candidate's model with `order` states, less its modes far above the band.
    fn slow_model(&self, subspace: &Subspace, order: usize) -> Option<StateSpace> {
        without_fast_modes(&subspace.model(order)?, FASTEST * self.highest)
    }

    /// Returns [`Self::slow_model`] as a [`SchurModel`], for computing costs; `None` if no mode
    /// remains.
    fn evaluated_model(&self, subspace: &Subspace, order: usize) -> Option<SchurModel> {
        SchurModel::from_state_space(&self.slow_model(subspace, order)?)
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
    /// Share of the total progress per step.
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

    /// Computes a candidate for every past window with the pole at this index (steps 1 and 2).
    fn rank_pole(&self, number: usize) -> Result<Vec<Candidate>, Cancelled> {
        let executor = self.likelihood.executor;
        let poles = &self.settings.poles;
        let step = format!("Laguerre pole {} of {}", number + 1, poles.len());
        self.progress
            .advance(self.share, &format!("{step}, projections"))?;
        let projections = Projections {
            pole: poles[number],
            past: self.longest_past,
            spacing_s: SPACING / self.settings.highest,
        };
        let factor = projections.factor(self.segments, executor);
        let mut candidates = Vec::new();
        let candidates_of_pasts = each(executor, &self.settings.pasts, |&past| {
            self.progress
                .advance(self.share, &format!("{step}, past window {past}"))?;
            Ok::<_, Cancelled>(self.candidate(&factor, poles[number], past))
        });
        for candidate in candidates_of_pasts {
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
        let model = self.settings.evaluated_model(&subspace, self.order)?;
        let cost = self.likelihood.cost(&model)?;
        Some(Candidate {
            pole,
            past,
            cost,
            subspace,
        })
    }
}
