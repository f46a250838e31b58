//! Uncertainty of an analysis's results, components of their scatter over the conditions, and
//! consequences for the schedule (M13).
//!
//! A *swap* repeats the analysis of a condition with another kept model instead of a representative
//! (M13.1). A net gain is the product of a response's output and input gain, `k_o k_i`; *scatter*
//! is its variation over the conditions. The second variable is altitude or mass, besides airspeed.
//! A *confidence band* encloses the schedule over airspeed, an *error bar* a single value.

use std::collections::BTreeMap;

use gdcm_method::schedule::{Schedule, SecondVariable};
use gdcm_method::uncertainty::scalar::ScalarTable;
use gdcm_method::uncertainty::second_variable_effect::{SecondVariableEffect, SecondVariableError};
use gdcm_method::uncertainty::{
    BandWidths, Bar, Difference, Scalar, ScheduleBand, VarianceDecomposition,
};
use gdcm_model::dataset::{ConditionId, Pair, PairTable};

use super::model_swap::ConditionSwaps;

/// Maximum difference between airspeeds that count as equal \[kt\] (M13.4).
pub(crate) const EQUAL_AIRSPEED_KT: f64 = 1.0;

/// Uncertainty of an analysis's results.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Confidence level for all error bars, intervals and tests.
    pub level: f64,
    /// Error bars in each analysed condition.
    pub conditions: BTreeMap<ConditionId, ConditionUncertainty>,
    /// Differences in on-axis net gain between every two conditions at equal airspeed.
    pub differences: Vec<AirspeedDifference>,
    /// Number of differences, if it exceeds the maximum; no differences are then computed.
    pub too_many_differences: Option<usize>,
    /// Scatter components for each on-axis net gain.
    pub scatter: Vec<PairScatter>,
    /// Confidence bands of the schedule, where it schedules `ln k` and has degrees of freedom left.
    pub bands: Option<ScheduleBands>,
    /// Test for each second scheduling variable and each on-axis response.
    pub second_variables: Vec<SecondVariableTest>,
}

impl Uncertainty {
    /// Returns, for each airspeed, the difference in a net gain that is largest relative to the
    /// expected difference; empty where the differences have no spread.
    pub fn greatest_differences(&self, pair: Pair) -> Vec<&AirspeedDifference> {
        let mut greatest: Vec<&AirspeedDifference> = Vec::new();
        for found in &self.differences {
            if found.pair != pair || found.difference.ratio().is_none() {
                continue;
            }
            let at_same_airspeed = greatest
                .iter_mut()
                .find(|known| (known.airspeed_kt - found.airspeed_kt).abs() <= EQUAL_AIRSPEED_KT);
            match at_same_airspeed {
                Some(known) if known.difference.ratio() < found.difference.ratio() => {
                    *known = found;
                }
                Some(_) => {}
                None => greatest.push(found),
            }
        }
        greatest
    }

    /// Returns a value's error bar in a condition.
    pub fn bar(&self, condition: ConditionId, scalar: Scalar) -> Option<&Bar> {
        self.conditions.get(&condition)?.bars[scalar].as_ref()
    }
}

/// Uncertainty of a condition's results.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionUncertainty {
    /// Error bar for each value that exists.
    pub bars: ScalarTable<Option<Bar>>,
    /// Half-width `(Q84 - Q16) / 2` of `ln |H_ref| / |H_sim|` between the representatives, over the
    /// frequency band: the mismatch that remains after a gain correction.
    pub left_in_band: PairTable<Option<f64>>,
    /// Swaps from which the error bars are computed.
    pub swaps: ConditionSwaps,
}

/// Scatter components of an on-axis net gain (M13.5).
#[derive(Clone, Debug, PartialEq)]
pub struct PairScatter {
    pub pair: Pair,
    /// Scatter at equal airspeed; `None` where no two conditions share an airspeed.
    pub same_airspeed: Option<VarianceDecomposition>,
    /// Scatter about the schedule; `None` where it passes through every condition.
    pub about_schedule: Option<VarianceDecomposition>,
}

/// Test whether an on-axis net gain depends on a second variable (M13.7).
#[derive(Clone, Debug, PartialEq)]
pub struct SecondVariableTest {
    pub pair: Pair,
    pub variable: SecondVariable,
    /// The variable's effect, or why it cannot be determined.
    pub effect: Result<SecondVariableEffect, SecondVariableError>,
    /// Probability that the effect is at least as large under the null hypothesis, after Holm's
    /// correction over all responses and variables.
    pub p_holm: Option<f64>,
    pub needed: bool,
}

/// Confidence bands where `ln k` is scheduled (M13.6).
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduleBands {
    /// Confidence band about each scheduled value.
    pub(crate) bands: Vec<(Scalar, ScheduleBand)>,
}

impl ScheduleBands {
    /// Returns the half-widths about a scheduled value (`ln k` of a channel or net gain) at an
    /// airspeed \[kt\]; `None` without a band, and for a schedule with another number of terms than
    /// the bands have.
    pub fn at(&self, schedule: &Schedule, scalar: Scalar, airspeed_kt: f64) -> Option<BandWidths> {
        let (_, band) = self.bands.iter().find(|(known, _)| *known == scalar)?;
        let widths = band.at(&schedule.design_row(airspeed_kt));
        if widths.confidence.is_finite() && widths.scatter.is_finite() {
            Some(widths)
        } else {
            None
        }
    }
}

/// Difference in on-axis net gain between two conditions at equal airspeed (M13.4).
#[derive(Clone, Debug, PartialEq)]
pub struct AirspeedDifference {
    pub pair: Pair,
    pub conditions: [ConditionId; 2],
    /// The two conditions' mean airspeed \[kt\].
    pub airspeed_kt: f64,
    /// The difference in `ln k_o k_i`.
    pub difference: Difference,
    /// Probability that a difference is at least as large under the null hypothesis, after Holm's
    /// correction over all differences; `None` where the bundles have no spread.
    pub p_holm: Option<f64>,
}

impl AirspeedDifference {
    /// Returns whether the difference is larger than trim and identification uncertainty explain.
    pub fn is_significant(&self, level: f64) -> bool {
        self.p_holm.is_some_and(|p| p < 1.0 - level)
    }
}
