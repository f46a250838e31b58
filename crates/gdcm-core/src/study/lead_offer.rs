//! What leads would buy where delays are asked for (M15).

use std::sync::Arc;

use crate::correction::{
    Bounds, ChannelLeads, DELAY_AGREEMENT_S, LeadDesign, LeadSettings, Problem, ProblemError, ProofBudget, Quantity,
    solve,
};
use crate::dataset::{Pair, PairTable};
use crate::fidelity::CostAverage;
use crate::response::GainDelay;
use crate::schedule::CostChange;

use super::comparison::Comparison;
use super::led::LeadCompensated;
use super::settings::Settings;

/// The mean J of the held responses, all of which want lead: as corrected, and with leads too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadOffer {
    /// Under the present correction.
    pub without: f64,
    /// With a lead filter in each channel that wants one: the same gains, of which such filters take little.
    pub with: f64,
}

/// What an offer depends on, besides the comparison of the representatives.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OfferKey {
    held: PairTable<bool>,
    fitted: PairTable<bool>,
    upper_s: f64,
    lead: LeadSettings,
}

impl OfferKey {
    pub(super) fn of(settings: &Settings, held: &PairTable<bool>, upper_s: f64) -> Self {
        Self { held: held.clone(), fitted: settings.fitted.clone(), upper_s, lead: settings.lead }
    }

    /// J_phase of each response that leads would leave; none where not all held responses want lead.
    ///
    /// The weight of the regularisation is 1 whatever delays are asked with: it decides on shares, not on what is held.
    pub(super) fn phase_left(
        &self,
        comparison: &Comparison,
        (omega, average): (&[f64], CostAverage),
        stop: &dyn Fn() -> bool,
    ) -> Result<Option<Arc<PairTable<Option<f64>>>>, ProblemError> {
        let delta_s = &comparison.delta.band_delay_s;
        let mut held_s = self.held.marked().map(|pair| delta_s[pair].unwrap_or_default()).peekable();
        if held_s.peek().is_none() || !held_s.all(|delay_s| delay_s < 0.0) {
            return Ok(None);
        }
        let design = Arc::new(LeadDesign::new(self.lead, omega.into()));
        let problem = Problem {
            quantity: Quantity::SignedDelay,
            delta: delta_s.clone(),
            constrained: self.held.clone(),
            fitted: self.fitted.clone(),
            bounds: Bounds { lower: design.lower_s(), upper: self.upper_s },
            alpha: 1.0,
            agreement: DELAY_AGREEMENT_S,
        };
        let solution = solve(&problem, ProofBudget::default(), stop)?;
        let leads = ChannelLeads::new(design, solution.inputs, solution.outputs);
        let [inputs_s, outputs_s] = leads.delays_s();
        let held =
            comparison.representative.mismatch.map(|pair, mismatch| mismatch.clone().filter(|_| self.held[pair]));
        let delay = |pair: Pair| GainDelay::new(1.0, inputs_s[pair.input] + outputs_s[pair.output]);
        let left = LeadCompensated::of(&held, &leads).cost(|pair| Some(delay(pair)), omega, average);
        Ok(Some(Arc::new(left.map(|_, cost| cost.map(|cost| cost.phase)))))
    }
}

impl LeadOffer {
    /// The offer, where leads would leave J at least a tenth less.
    pub(super) fn of(phase_left: &PairTable<Option<f64>>, cost: &PairTable<Option<CostChange>>) -> Option<Self> {
        const WORTH: f64 = 0.9;
        let of_both = |(pair, left): (Pair, &Option<f64>)| {
            let (left, now) = ((*left)?, cost[pair]?.corrected);
            Some([now.total(), now.magnitude + left])
        };
        let both: Vec<[f64; 2]> = phase_left.iter().filter_map(of_both).collect();
        let mean = |at: usize| both.iter().map(|of| of[at]).sum::<f64>() / both.len() as f64;
        let offer = Self { without: mean(0), with: mean(1) };
        (!both.is_empty() && offer.with < WORTH * offer.without).then_some(offer)
    }
}
