//! What couplings do to J on and off the axis, without and with them (M16.4).

use serde::Serialize;

use crate::dataset::{Pair, PairTable};
use crate::schedule::CostChange;

/// A mean of J on the axis and off it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AxisCost {
    /// Over the on-axis responses; none where none can be compared.
    pub on_axis: Option<f64>,
    /// Over the others.
    pub others: Option<f64>,
}

/// The same without couplings and with them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CouplingCost {
    /// Without couplings.
    pub without: AxisCost,
    /// With couplings.
    pub with: AxisCost,
}

/// J in the mean over the conditions, of each response that can be compared both without and with couplings (M16.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CouplingCosts {
    /// Of the physics representatives as they are.
    pub uncorrected: AxisCost,
    /// Of each condition's own correction.
    pub own: CouplingCost,
    /// Of the schedule at each condition's airspeed.
    pub scheduled: CouplingCost,
    /// Of conditions left out: couplings, channel delays and schedule found without each, in turn; none of fewer than three.
    pub left_out: Option<CouplingCost>,
}

impl CouplingCost {
    /// Off-axis J of what is worth its price, over that without couplings.
    const WORTH: f64 = 0.9;

    /// Whether the off-axis J is at least a tenth less with couplings.
    pub fn is_worth_it(&self) -> bool {
        self.with.others.zip(self.without.others).is_some_and(|(with, without)| with <= Self::WORTH * without)
    }
}

/// Sums of J of the responses of many conditions.
#[derive(Default)]
pub(super) struct CostSums<'a> {
    on_axis: Option<&'a PairTable<bool>>,
    /// Off the axis and on it: number, J before any correction, without couplings, with them.
    sums: [(usize, [f64; 3]); 2],
}

impl<'a> CostSums<'a> {
    pub(super) fn new(on_axis: &'a PairTable<bool>) -> Self {
        Self { on_axis: Some(on_axis), ..Self::default() }
    }

    /// Adds the responses of a condition, without couplings and with them.
    pub(super) fn add(&mut self, without: &PairTable<Option<CostChange>>, with: &PairTable<Option<CostChange>>) {
        let both = |(pair, of): (Pair, &Option<CostChange>)| Some((pair, (*of)?, with[pair]?));
        for (pair, without, with) in without.iter().filter_map(both) {
            let (count, sums) = &mut self.sums[usize::from(self.on_axis.is_some_and(|on_axis| on_axis[pair]))];
            *count += 1;
            let added = [without.uncorrected, without.corrected, with.corrected].map(|cost| cost.total());
            sums.iter_mut().zip(added).for_each(|(sum, cost)| *sum += cost);
        }
    }

    fn mean(&self, which: usize) -> AxisCost {
        let [others, on_axis] = self.sums.map(|(count, sums)| (count > 0).then(|| sums[which] / count as f64));
        AxisCost { on_axis, others }
    }

    /// The mean of J before any correction.
    pub(super) fn uncorrected(&self) -> AxisCost {
        self.mean(0)
    }

    /// The means of J without couplings and with them.
    pub(super) fn corrected(&self) -> CouplingCost {
        CouplingCost { without: self.mean(1), with: self.mean(2) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fidelity::Cost;

    fn change(uncorrected: f64, corrected: f64) -> Option<CostChange> {
        let cost = |magnitude| Cost { magnitude, phase: 0.0 };
        Some(CostChange { uncorrected: cost(uncorrected), corrected: cost(corrected) })
    }

    #[test]
    fn only_responses_that_can_be_compared_both_times_count() {
        let on_axis = PairTable::from_fn(2, 1, |pair| pair.output == 0);
        let mut sums = CostSums::new(&on_axis);
        let table = |values: [Option<CostChange>; 2]| PairTable::from_fn(2, 1, |pair| values[pair.output]);
        sums.add(&table([change(9.0, 4.0), change(50.0, 40.0)]), &table([change(9.0, 2.0), None]));
        sums.add(&table([change(5.0, 2.0), change(70.0, 20.0)]), &table([change(5.0, 2.0), change(70.0, 18.0)]));
        assert_eq!(sums.uncorrected(), AxisCost { on_axis: Some(7.0), others: Some(70.0) });
        let found = sums.corrected();
        assert_eq!(found.without, AxisCost { on_axis: Some(3.0), others: Some(20.0) });
        assert_eq!(found.with, AxisCost { on_axis: Some(2.0), others: Some(18.0) });
        assert!(found.is_worth_it(), "a tenth less");
        assert!(!CouplingCost::default().is_worth_it());
    }
}
