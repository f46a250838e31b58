//! Computes an analysis's uncertainty from model swaps (M13).
//!
//! ```text
//! 1  error bar of every gain and delay, from swaps and standard errors             (M13.2, M13.3)
//! 2  differences of net gains between conditions at equal airspeed, Holm's correction    (M13.4)
//! 3  components of the scatter over the scheduled conditions                             (M13.5)
//! 4  confidence bands of the schedule                                                    (M13.6)
//! 5  tests for a second scheduling variable, Holm's correction                           (M13.7)
//! ```
//!
//! Steps 3 to 5 need a schedule and the error bars of every scheduled condition. Holm's correction
//! adjusts probabilities for the number of tests. A *swap* repeats the analysis of a condition with
//! another kept model instead of a representative (M13.1); the scatter is the variation of a net
//! gain over the conditions. A `pair` is a response: an output and an input. A `Scalar` names a
//! value with an error bar, such as the net gain of a pair.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::schedule::airspeeds::airspeed_indicators;
use gdcm_method::schedule::{Schedule, ScheduledQuantity, SecondVariable};
use gdcm_method::uncertainty::condition_bars::{BarSource, bars};
use gdcm_method::uncertainty::second_variable_effect::SecondVariableError;
use gdcm_method::uncertainty::{
    Bar, Design, Difference, Scalar, ScheduleBand, SecondVariableDesign, VarianceDecomposition,
    holm,
};
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::{Condition, ConditionId, Dataset, Pair, PairTable};
use gdcm_model::statistics::quantile;

use super::model_swaps::representative_figures;
use crate::results::analysis::{Analysis, ConditionAnalysis};
use crate::results::model_swap::ConditionSwaps;
use crate::results::reported_error::{LN_DB, ReportedErrors};
use crate::results::uncertainty::{
    AirspeedDifference, ConditionUncertainty, EQUAL_AIRSPEED_KT, PairScatter, ScheduleBands,
    SecondVariableTest, Uncertainty,
};

/// Maximum number of differences; with more, none is computed. They grow with the square of the
/// number of conditions at equal airspeed, and are listed one by one.
const MOST_DIFFERENCES: usize = 20_000;

impl Uncertainty {
    /// Computes the uncertainty from the conditions' swaps (steps 1 to 5).
    pub(crate) fn new(analysis: &Analysis, swaps: &[(ConditionId, ConditionSwaps)]) -> Self {
        let study = &analysis.study;
        let level = study.settings.uncertainty.level;
        let pairs: Vec<Pair> = study.dataset.measuring_pairs().marked().collect();
        // Step 1.
        let conditions = condition_bars(analysis, swaps);
        // Step 2.
        let (differences, too_many_differences) =
            match airspeed_differences(&study.dataset, &conditions, &pairs) {
                Ok(differences) => (differences, None),
                Err(count) => (Vec::new(), Some(count)),
            };
        let evidence = ScheduleEvidence::new(analysis, &conditions);
        Self {
            level,
            differences,
            too_many_differences,
            // Step 3.
            scatter: evidence.scatter(&pairs),
            // Step 4.
            bands: evidence.bands(level),
            // Step 5.
            second_variables: evidence.second_variables(&pairs, level),
            conditions,
        }
    }
}

/// Computes the error bars in every condition with swaps.
fn condition_bars(
    analysis: &Analysis,
    swaps: &[(ConditionId, ConditionSwaps)],
) -> BTreeMap<ConditionId, ConditionUncertainty> {
    let mut analysed: Vec<(&ConditionAnalysis, &ConditionSwaps)> = Vec::new();
    for (id, swaps) in swaps {
        if let Some(result) = analysis.condition(*id) {
            analysed.push((result, swaps));
        }
    }
    let sources: Vec<BarSource<'_>> = analysed
        .iter()
        .map(|(result, swaps)| bar_source(analysis, result, swaps))
        .collect();
    let bars = bars(&sources, analysis.study.settings.uncertainty.prior_degrees);
    let mut conditions = BTreeMap::new();
    for ((result, swaps), bars) in analysed.into_iter().zip(bars) {
        let condition = ConditionUncertainty {
            bars,
            left_in_band: left_in_band(result),
            swaps: swaps.clone(),
        };
        conditions.insert(result.condition.id(), condition);
    }
    conditions
}

/// Collects a condition's results with their spread over the swaps, and with the identified
/// representative's standard errors.
fn bar_source<'a>(
    analysis: &Analysis,
    result: &ConditionAnalysis,
    swaps: &'a ConditionSwaps,
) -> BarSource<'a> {
    let figures = representative_figures(result);
    let reported = ReportedErrors::new(analysis, result);
    let reported = figures.map(|scalar, _| reported.of_scalar(result, scalar));
    BarSource {
        figures,
        spread: &swaps.spread,
        reported,
        delay_bounds_s: [
            result.delay_problem.bounds.lower,
            result.delay_problem.bounds.upper,
        ],
    }
}

/// Returns the half-width `(Q84 - Q16) / 2` of `ln |H_ref| / |H_sim|` over the band, the difference
/// that no constant gain removes; it is the standard deviation if the values are normal.
fn left_in_band(result: &ConditionAnalysis) -> PairTable<Option<f64>> {
    let mismatches = &result.comparison.representative.mismatch;
    mismatches.map(|_, mismatch| {
        let mut errors_db: Vec<f64> = mismatch.as_ref()?.magnitude_db.clone();
        let width_db = quantile(&mut errors_db, 0.84) - quantile(&mut errors_db, 0.16);
        Some(0.5 * LN_DB * width_db)
    })
}

/// The schedule with its conditions' error bars.
struct ScheduleEvidence<'a> {
    /// `None` where there is no schedule, or a scheduled condition has no error bars.
    schedule: Option<&'a Schedule>,
    conditions: Vec<&'a ConditionUncertainty>,
    states: Vec<&'a FlightState>,
}

impl<'a> ScheduleEvidence<'a> {
    fn new(
        analysis: &'a Analysis,
        conditions: &'a BTreeMap<ConditionId, ConditionUncertainty>,
    ) -> Self {
        let scheduled = analysis.scheduled();
        let with_bars: Vec<&ConditionUncertainty> = scheduled
            .iter()
            .filter_map(|id| conditions.get(id))
            .collect();
        let is_complete = with_bars.len() == scheduled.len();
        let dataset = &analysis.study.dataset;
        Self {
            schedule: match &analysis.schedule {
                Ok(schedule) if is_complete => Some(schedule),
                _ => None,
            },
            conditions: with_bars,
            states: scheduled
                .iter()
                .filter_map(|id| Some(dataset.condition(*id)?.flight_state()))
                .collect(),
        }
    }

    /// Returns a value's error bars in the scheduled conditions; `None` if one is missing.
    fn bars(&self, scalar: Scalar) -> Option<Vec<Bar>> {
        self.conditions
            .iter()
            .map(|condition| condition.bars[scalar])
            .collect()
    }

    /// Splits each net gain's scatter into components, at equal airspeed and about the schedule.
    fn scatter(&self, pairs: &[Pair]) -> Vec<PairScatter> {
        let same_airspeed = self.schedule.and_then(|schedule| {
            let airspeeds_kt = schedule.airspeeds.values_kt.clone();
            Design::new(&airspeed_indicators(airspeeds_kt, EQUAL_AIRSPEED_KT))
        });
        let about_schedule = self
            .schedule
            .and_then(|schedule| Design::new(&schedule.design()));
        pairs
            .iter()
            .map(|&pair| {
                let bars = self.bars(Scalar::NetGain(pair));
                let decomposition = |design: &Option<Design>| {
                    VarianceDecomposition::new(design.as_ref()?, bars.as_ref()?)
                };
                PairScatter {
                    pair,
                    same_airspeed: decomposition(&same_airspeed),
                    about_schedule: decomposition(&about_schedule),
                }
            })
            .collect()
    }

    /// Computes confidence bands where `ln k` is scheduled.
    fn bands(&self, level: f64) -> Option<ScheduleBands> {
        let schedule = self.schedule?;
        if schedule.settings.quantity != ScheduledQuantity::LnGain {
            return None;
        }
        let design = Arc::new(Design::new(&schedule.design())?);
        let mut bands = Vec::new();
        for (scalar, _) in self.conditions.first()?.bars.iter() {
            if !matches!(scalar, Scalar::NetGain(_) | Scalar::ChannelGain(_)) {
                continue;
            }
            let decomposition = self
                .bars(scalar)
                .and_then(|bars| VarianceDecomposition::new(&design, &bars));
            if let Some(decomposition) = decomposition {
                bands.push((scalar, ScheduleBand::new(&design, &decomposition, level)));
            }
        }
        Some(ScheduleBands { bands })
    }

    /// Tests every net gain for dependence on every second variable.
    fn second_variables(&self, pairs: &[Pair], level: f64) -> Vec<SecondVariableTest> {
        let Some(schedule) = self.schedule else {
            return Vec::new();
        };
        let rows = schedule.airspeed_design();
        let designs = SecondVariable::BOTH.map(|variable| {
            let values = variable
                .values(&self.states)
                .ok_or(SecondVariableError::NotVaried)?;
            SecondVariableDesign::new(&rows, &values)
        });
        let mut tests = Vec::new();
        for &pair in pairs {
            let Some(bars) = self.bars(Scalar::NetGain(pair)) else {
                continue;
            };
            let net_gains: Vec<f64> = bars.iter().map(|bar| bar.value).collect();
            for (variable, design) in SecondVariable::BOTH.into_iter().zip(&designs) {
                let effect = match design {
                    Ok(design) => Ok(design.effect(&net_gains, level)),
                    Err(error) => Err(*error),
                };
                tests.push(SecondVariableTest {
                    pair,
                    variable,
                    effect,
                    p_holm: None,
                    needed: false,
                });
            }
        }
        judge_together(&mut tests, level);
        tests
    }
}

/// Applies Holm's correction over all tests, and decides which second variables are needed.
fn judge_together(tests: &mut [SecondVariableTest], level: f64) {
    let probabilities: Vec<Option<f64>> = tests
        .iter()
        .map(|test| Some(test.effect.as_ref().ok()?.p))
        .collect();
    for (test, p) in tests.iter_mut().zip(holm_where_known(&probabilities)) {
        test.p_holm = p;
        if let (Ok(effect), Some(p)) = (&test.effect, p) {
            test.needed = effect.is_needed(p, level);
        }
    }
}

/// Computes the differences in these net gains between all pairs of conditions at equal airspeed.
///
/// # Errors
/// The number of differences, if it exceeds the maximum.
fn airspeed_differences(
    dataset: &Dataset,
    conditions: &BTreeMap<ConditionId, ConditionUncertainty>,
    pairs: &[Pair],
) -> Result<Vec<AirspeedDifference>, usize> {
    let analysed: Vec<(&Condition, &ConditionUncertainty)> = dataset
        .conditions()
        .iter()
        .filter_map(|condition| Some((condition.as_ref(), conditions.get(&condition.id())?)))
        .collect();
    let airspeeds_kt: Vec<f64> = analysed
        .iter()
        .map(|(condition, _)| condition.flight_state().airspeed_kt)
        .collect();
    let count = pairs.len() * pairs_at_equal_airspeed(airspeeds_kt);
    if count > MOST_DIFFERENCES {
        return Err(count);
    }
    let mut differences = Vec::new();
    for &pair in pairs {
        for (index, (first, bars_of_first)) in analysed.iter().enumerate() {
            for (second, bars_of_second) in &analysed[index + 1..] {
                let a_kt = first.flight_state().airspeed_kt;
                let b_kt = second.flight_state().airspeed_kt;
                if (a_kt - b_kt).abs() > EQUAL_AIRSPEED_KT {
                    continue;
                }
                let scalar = Scalar::NetGain(pair);
                if let (Some(a), Some(b)) =
                    (bars_of_first.bars[scalar], bars_of_second.bars[scalar])
                {
                    differences.push(AirspeedDifference {
                        pair,
                        conditions: [first.id(), second.id()],
                        airspeed_kt: 0.5 * (a_kt + b_kt),
                        difference: Difference::between(&a, &b),
                        p_holm: None,
                    });
                }
            }
        }
    }
    let probabilities: Vec<Option<f64>> = differences
        .iter()
        .map(|difference| difference.difference.p())
        .collect();
    for (difference, p) in differences.iter_mut().zip(holm_where_known(&probabilities)) {
        difference.p_holm = p;
    }
    Ok(differences)
}

/// Counts the pairs of conditions at equal airspeed.
fn pairs_at_equal_airspeed(mut airspeeds_kt: Vec<f64>) -> usize {
    airspeeds_kt.sort_by(f64::total_cmp);
    airspeeds_kt
        .iter()
        .enumerate()
        .map(|(index, low)| {
            airspeeds_kt.partition_point(|high| high - low <= EQUAL_AIRSPEED_KT) - index - 1
        })
        .sum()
}

/// Applies Holm's correction to the available probabilities.
fn holm_where_known(probabilities: &[Option<f64>]) -> Vec<Option<f64>> {
    let known: Vec<f64> = probabilities.iter().flatten().copied().collect();
    let mut corrected = holm(&known).into_iter();
    probabilities
        .iter()
        .map(|p| p.and_then(|_| corrected.next()))
        .collect()
}
