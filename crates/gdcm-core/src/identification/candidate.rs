//! Models that CT-PBSID proposes, and the cheapest of them for every order (M14, section 3).
//!
//! ```text
//! 1  R for each Laguerre pole a
//! 2  for each a and past window p: the model of order 18, its cost
//! 3  for the two cheapest (a, p): the models of all orders; of one order the cheaper is kept
//! ```

use super::*;
use crate::executor::{Executor, each};
use nalgebra::Complex;
use std::collections::BTreeMap;

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
        let (Some(&longest), Some(order)) = (pasts.iter().max(), self.ranking_order(segments)) else {
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
            each(executor, pasts, of_past).into_iter().collect::<Result<Vec<_>, IdentificationError>>()
        };
        let all = each(executor, self.poles.iter().enumerate(), of_pole).into_iter().collect::<Result<Vec<_>, _>>()?;
        let mut found: Vec<Candidate> = all.into_iter().flatten().flatten().collect();
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found.truncate(KEPT);
        Ok(found)
    }

    /// For each order the cheaper of the models of `candidates`, with its cost.
    pub(super) fn starts(&self, candidates: &[Candidate], likelihood: &Likelihood) -> BTreeMap<usize, Fit> {
        let cheapest = |&order: &usize| {
            let models = candidates.iter().filter_map(|candidate| self.model(&candidate.subspace, order));
            let fits = models.filter_map(|model| Fit::start(likelihood, model));
            fits.min_by(|a, b| a.cost.total_cmp(&b.cost)).map(|fit| (order, fit))
        };
        each(likelihood.executor, &self.orders, cheapest).into_iter().flatten().collect()
    }

    /// The poles of the models of each order that a candidate proposes.
    pub(super) fn poles_by_order(
        &self,
        candidate: &Candidate,
        executor: &dyn Executor,
    ) -> Vec<(usize, Vec<nalgebra::Complex<f64>>)> {
        let of_order = |&order: &usize| Some((order, poles(&self.slow(&candidate.subspace, order)?)?));
        each(executor, &self.orders, of_order).into_iter().flatten().collect()
    }

    fn projections(&self, pole: f64, past: usize) -> Projections {
        Projections { pole, past, spacing_s: SPACING / self.highest }
    }

    /// The order at which poles and past windows are compared: one that the shortest past window has states for.
    fn ranking_order(&self, segments: &[Segment]) -> Option<usize> {
        let outputs = segments.first()?.outputs.ncols();
        let future = self.pasts.iter().min()?.min(&self.longest_future);
        Some(RANKING_ORDER.min(*self.orders.last()?).min(future * outputs))
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
        let settings = PredictorSettings { longest_future: self.longest_future, ridge: RIDGE };
        let subspace = Subspace::new(factor, pole, channels, past, settings)?;
        let cost = likelihood.cost(&self.model(&subspace, order)?)?;
        Some(Candidate { pole, past, cost, subspace })
    }

    /// The model of an order without modes far above the band.
    fn slow(&self, subspace: &Subspace, order: usize) -> Option<StateSpace> {
        without_fast_modes(&subspace.model(order)?.continuous()?, FASTEST * self.highest)
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
        let before = poles.iter().find(|(other, _)| other + 2 == *order).map(|(_, poles)| poles);
        let point = |pole: Complex<f64>| {
            let near = |other: &Complex<f64>| (other - pole).norm() < STABLE * pole.norm();
            StabilisationPoint { order: *order, pole, stable: before.is_some_and(|before| before.iter().any(near)) }
        };
        own.iter().filter(|pole| pole.im >= 0.0).map(|pole| point(*pole)).collect::<Vec<_>>()
    };
    poles.iter().flat_map(of_order).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pole_is_stable_when_the_order_before_has_it() {
        let pole = |re: f64, im: f64| Complex::new(re, im);
        let orders = [
            (2, vec![pole(-1.0, 2.0), pole(-1.0, -2.0)]),
            (4, vec![pole(-1.0, 2.05), pole(-1.0, -2.05), pole(-3.0, 0.0), pole(-8.0, 0.0)]),
        ];
        let diagram = stabilisation(&orders);
        let stable: Vec<_> = diagram.iter().map(|point| (point.order, point.pole.re, point.stable)).collect();
        assert_eq!(stable, [(2, -1.0, false), (4, -1.0, true), (4, -3.0, false), (4, -8.0, false)]);
    }
}
