//! Differences of net gains at equal airspeed: in earnest, or within what the bundles can make (M13.4).

use std::collections::BTreeMap;

use crate::dataset::{Condition, ConditionId, Dataset, Pair};
use crate::uncertainty::{Difference, Scalar, holm};

use super::uncertainty::ConditionUncertainty;

/// Differences that are compared at most.
const MOST_DIFFERENCES: usize = 20_000;
/// Conditions whose airspeeds differ by no more \[kt\] fly at equal airspeed (M13.4).
pub(super) const EQUAL_AIRSPEED_KT: f64 = 1.0;

/// The difference of an on-axis net gain between two conditions at equal airspeed (M13.4).
#[derive(Clone, Debug, PartialEq)]
pub struct AirspeedDifference {
    /// The response.
    pub pair: Pair,
    /// The two conditions, in the dataset's order.
    pub conditions: [ConditionId; 2],
    /// Their airspeed \[kt\], the mean of both.
    pub airspeed_kt: f64,
    /// The difference of `ln k_o k_i`.
    pub difference: Difference,
    /// Its probability where there is none, after Holm's correction over all that are shown; none where the bundles have no spread.
    pub p_holm: Option<f64>,
}

impl AirspeedDifference {
    /// Whether it is more than the bundles of both conditions explain.
    pub fn is_beyond(&self, level: f64) -> bool {
        self.p_holm.is_some_and(|p| p < 1.0 - level)
    }

    /// The difference in words: "conditions 3 and 5 (45 kt) differ by 13 %, 5.4 times what the bundles explain: real, or model form".
    pub fn words(&self, level: f64) -> String {
        let [first, second] = self.conditions;
        let (airspeed, percent) = (self.airspeed_kt, 100.0 * self.difference.delta.abs());
        let differ = format!("conditions {first} and {second} ({airspeed:.0} kt) differ by {percent:.0} %");
        let Some(ratio) = self.difference.ratio() else {
            return format!("{differ}; their bundles have no spread to compare that with");
        };
        let verdict = if self.is_beyond(level) { "real, or model form" } else { "within what they can make" };
        format!("{differ}, {ratio:.1} times what the bundles explain: {verdict}")
    }
}

/// The differences of these net gains of every two conditions at equal airspeed.
///
/// # Errors
/// How many there are, where they are too many to compare.
pub(super) fn differences(
    dataset: &Dataset,
    conditions: &BTreeMap<ConditionId, ConditionUncertainty>,
    pairs: &[Pair],
) -> Result<Vec<AirspeedDifference>, usize> {
    let analysed: Vec<(&Condition, &ConditionUncertainty)> = dataset
        .conditions()
        .iter()
        .filter_map(|condition| Some((condition.as_ref(), conditions.get(&condition.id())?)))
        .collect();
    let airspeed = |condition: &Condition| condition.flight_state().airspeed_kt;
    let mut rising: Vec<f64> = analysed.iter().map(|(condition, _)| airspeed(condition)).collect();
    rising.sort_by(f64::total_cmp);
    let near = |(place, low): (usize, &f64)| rising.partition_point(|high| high - low <= EQUAL_AIRSPEED_KT) - place - 1;
    let count = pairs.len() * rising.iter().enumerate().map(near).sum::<usize>();
    if count > MOST_DIFFERENCES {
        return Err(count);
    }
    let mut found = Vec::new();
    for &pair in pairs {
        for (place, (first, of_first)) in analysed.iter().enumerate() {
            for (second, of_second) in &analysed[place + 1..] {
                let (a, b) = (airspeed(first), airspeed(second));
                let bars = of_first.bars[Scalar::NetGain(pair)].zip(of_second.bars[Scalar::NetGain(pair)]);
                if let Some((one, other)) = bars.filter(|_| (a - b).abs() <= EQUAL_AIRSPEED_KT) {
                    let conditions = [first.id(), second.id()];
                    let difference = Difference::of(&one, &other);
                    found.push(AirspeedDifference {
                        pair,
                        conditions,
                        airspeed_kt: 0.5 * (a + b),
                        difference,
                        p_holm: None,
                    });
                }
            }
        }
    }
    let corrected = holm_where_known(&found.iter().map(|of| of.difference.p()).collect::<Vec<_>>());
    found.iter_mut().zip(corrected).for_each(|(difference, p)| difference.p_holm = p);
    Ok(found)
}

/// Holm's correction over those that there are.
pub(super) fn holm_where_known(probabilities: &[Option<f64>]) -> Vec<Option<f64>> {
    let known: Vec<f64> = probabilities.iter().flatten().copied().collect();
    let mut corrected = holm(&known).into_iter();
    probabilities.iter().map(|p| p.and_then(|_| corrected.next())).collect()
}
