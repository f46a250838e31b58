//! Uncertainty of the figures of an analysis, components of their scatter over the conditions, and
//! conclusions for the schedule (M13).

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use gdcm_method::schedule::airspeeds::airspeed_indicators;
use gdcm_method::schedule::{Schedule, ScheduledQuantity, SecondVariable};
use gdcm_method::uncertainty::least_squares::{SecondVariableEffect, SecondVariableError};
use gdcm_method::uncertainty::spread::{BarSource, ScalarTable, bars};
use gdcm_method::uncertainty::{
    BandWidths, Bar, Design, Difference, Scalar, ScheduleBand, SecondVariableDesign,
    VarianceDecomposition, holm,
};
use gdcm_model::dataset::condition::FlightState;
use gdcm_model::dataset::{Condition, ConditionId, Dataset, Pair, PairTable};

use super::substitutions::{ConditionSubstitutions, bar_source, left_in_band};
use crate::results::analysis::{Analysis, ConditionAnalysis};

/// Uncertainty of the figures of an analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Level of every error bar, interval and test.
    pub level: f64,
    /// Each analysed condition.
    pub conditions: BTreeMap<ConditionId, ConditionUncertainty>,
    /// Differences of the on-axis net gains between every two conditions at equal airspeed,
    /// response by response.
    pub differences: Vec<AirspeedDifference>,
    /// Number of differences where they are too many to compare; none is stored then.
    pub too_many_differences: Option<usize>,
    /// Components of the scatter of each on-axis net gain.
    pub scatter: Vec<PairScatter>,
    /// Confidence bands of the schedule, where it is a schedule of `ln k` with degrees of freedom
    /// left.
    pub bands: Option<ScheduleBands>,
    /// Test for a second scheduling variable, for each on-axis response and each variable.
    pub second_variables: Vec<SecondVariableTest>,
}

/// Uncertainty of the figures of one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionUncertainty {
    /// Error bar of each figure that exists.
    pub bars: ScalarTable<Option<Bar>>,
    /// `(Q84 - Q16) / 2` over the band of `ln |H_ref| / |H_sim|` of the representatives: the
    /// mismatch that a single gain leaves.
    pub left_in_band: PairTable<Option<f64>>,
    /// Substitutions behind the error bars.
    pub substitutions: ConditionSubstitutions,
}

/// Components of the scatter of one on-axis net gain (M13.5).
#[derive(Clone, Debug, PartialEq)]
pub struct PairScatter {
    pub pair: Pair,
    /// Scatter at equal airspeed; `None` where no two conditions share an airspeed.
    pub same_airspeed: Option<VarianceDecomposition>,
    /// Scatter about the schedule; `None` where it passes through every condition.
    pub about_schedule: Option<VarianceDecomposition>,
}

/// Test for a second scheduling variable of one on-axis net gain (M13.7).
#[derive(Clone, Debug, PartialEq)]
pub struct SecondVariableTest {
    pub pair: Pair,
    pub variable: SecondVariable,
    /// Its effect, or why it cannot be determined.
    pub effect: Result<SecondVariableEffect, SecondVariableError>,
    /// Probability of an effect at least as large under the null hypothesis, after Holm's
    /// correction over all responses and variables.
    pub p_holm: Option<f64>,
    pub needed: bool,
}

impl fmt::Display for SecondVariableTest {
    /// Writes the test in words: "from the lowest to the highest altitude −7 % ± 6 %: not needed;
    /// an effect smaller than ± 6 % could not have been seen".
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let variable = self.variable.name();
        let effect = match &self.effect {
            Ok(effect) => effect,
            Err(error) => return write!(formatter, "{variable}: {error}"),
        };
        let percent = 100.0 * effect.effect;
        let visible = 100.0 * effect.visible;
        let verdict = if self.needed { "needed" } else { "not needed" };
        let sign = if percent < 0.0 { "−" } else { "+" };
        write!(
            formatter,
            "from the lowest to the highest {variable} {sign}{:.1} %: {verdict}; an effect smaller than ± {visible:.1} % could not have been seen",
            percent.abs()
        )
    }
}

/// Confidence bands of a schedule of `ln k` (M13.6).
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduleBands {
    of: Vec<(Scalar, ScheduleBand)>,
}

impl ScheduleBands {
    /// Returns the half-widths about the scheduled figure, the logarithm of a channel's gain or of
    /// a net gain, at an airspeed \[kt\].
    pub fn at(&self, schedule: &Schedule, figure: Scalar, airspeed_kt: f64) -> Option<BandWidths> {
        let (_, band) = self.of.iter().find(|(scalar, _)| *scalar == figure)?;
        let widths = band.at(&schedule.design_row(airspeed_kt));
        (widths.confidence.is_finite() && widths.scatter.is_finite()).then_some(widths)
    }

    fn of(schedule: &Schedule, conditions: &[&ConditionUncertainty], level: f64) -> Option<Self> {
        if schedule.settings.quantity != ScheduledQuantity::LnGain {
            return None;
        }
        let design = Arc::new(Design::new(&schedule.design())?);
        let scalars = conditions.first()?.bars.iter().map(|(scalar, _)| scalar);
        let scheduled =
            scalars.filter(|scalar| matches!(scalar, Scalar::NetGain(_) | Scalar::ChannelGain(_)));
        let band = |scalar| {
            let bars = bars_of(conditions, scalar)?;
            Some((
                scalar,
                ScheduleBand::of(&design, &VarianceDecomposition::of(&design, &bars)?, level),
            ))
        };
        Some(Self {
            of: scheduled.filter_map(band).collect(),
        })
    }
}

impl Uncertainty {
    /// Computes the uncertainty from the substitutions of an analysis's conditions.
    pub(crate) fn of(
        analysis: &Analysis,
        substitutions: &[(ConditionId, ConditionSubstitutions)],
    ) -> Self {
        let study = &analysis.study;
        let level = analysis.study.settings.uncertainty.level;
        let analysed: Vec<(&ConditionAnalysis, &ConditionSubstitutions)> = substitutions
            .iter()
            .filter_map(|(id, substitutions)| Some((analysis.condition(*id)?, substitutions)))
            .collect();
        let sources: Vec<BarSource<'_>> = analysed
            .iter()
            .map(|(result, substitutions)| bar_source(analysis, result, substitutions))
            .collect();
        let made = bars(&sources, study.settings.uncertainty.prior_degrees);
        let conditions = analysed
            .iter()
            .zip(made)
            .map(|(&(result, substitutions), bars)| {
                let left_in_band = left_in_band(result);
                let substitutions = substitutions.clone();
                (
                    result.condition.id(),
                    ConditionUncertainty {
                        bars,
                        left_in_band,
                        substitutions,
                    },
                )
            });
        let conditions: BTreeMap<ConditionId, ConditionUncertainty> = conditions.collect();
        let scheduled = analysis.scheduled();
        let of_schedule: Vec<&ConditionUncertainty> = scheduled
            .iter()
            .filter_map(|id| conditions.get(id))
            .collect();
        let schedule = analysis
            .schedule
            .as_ref()
            .ok()
            .filter(|_| of_schedule.len() == scheduled.len());
        let pairs: Vec<Pair> = study.dataset.measuring_pairs().marked().collect();
        let airspeeds = schedule.map(|schedule| schedule.airspeeds.values_kt.clone());
        let same_airspeed =
            airspeeds.and_then(|of| Design::new(&airspeed_indicators(of, EQUAL_AIRSPEED_KT)));
        let about_schedule = schedule.and_then(|schedule| Design::new(&schedule.design()));
        let scatter = |&pair: &Pair| {
            let bars = bars_of(&of_schedule, Scalar::NetGain(pair));
            let split = |design: &Option<Design>| {
                VarianceDecomposition::of(design.as_ref()?, bars.as_ref()?)
            };
            PairScatter {
                pair,
                same_airspeed: split(&same_airspeed),
                about_schedule: split(&about_schedule),
            }
        };
        let compared = differences(&study.dataset, &conditions, &pairs);
        Self {
            level,
            too_many_differences: compared.as_ref().err().copied(),
            differences: compared.unwrap_or_default(),
            scatter: pairs.iter().map(scatter).collect(),
            bands: schedule.and_then(|schedule| ScheduleBands::of(schedule, &of_schedule, level)),
            second_variables: schedule.map_or_else(Vec::new, |schedule| {
                let states: Vec<&FlightState> = scheduled
                    .iter()
                    .filter_map(|id| Some(study.dataset.condition(*id)?.flight_state()))
                    .collect();
                second_variables(schedule, &states, &of_schedule, &pairs, level)
            }),
            conditions,
        }
    }

    /// Returns, for each airspeed, the difference of a net gain that is the largest multiple of the
    /// expected difference; empty where the differences have no spread.
    pub fn greatest_differences(&self, pair: Pair) -> Vec<&AirspeedDifference> {
        let mut greatest: Vec<&AirspeedDifference> = Vec::new();
        let compared =
            |of: &&AirspeedDifference| of.pair == pair && of.difference.ratio().is_some();
        for found in self.differences.iter().filter(compared) {
            let at_its_airspeed = |of: &&mut &AirspeedDifference| {
                (of.airspeed_kt - found.airspeed_kt).abs() <= EQUAL_AIRSPEED_KT
            };
            match greatest.iter_mut().find(at_its_airspeed) {
                Some(known) if known.difference.ratio() < found.difference.ratio() => {
                    *known = found
                }
                Some(_) => {}
                None => greatest.push(found),
            }
        }
        greatest
    }

    /// Summarises the differences at equal airspeed in a sentence.
    pub fn differences_in_words(&self) -> String {
        let beyond = self
            .differences
            .iter()
            .filter(|of| of.is_significant(self.level))
            .count();
        match (self.differences.len(), beyond) {
            (0, _) => self.too_many_differences.map_or_else(
                || "No two conditions fly at equal airspeed.".to_owned(),
                |count| format!("{count} differences at equal airspeed are too many to compare."),
            ),
            (all, 0) => format!(
                "None of the {all} pairs of conditions at equal airspeed has significantly different net gains."
            ),
            (all, found) => {
                format!(
                    "{found} of {all} pairs of conditions at equal airspeed have significantly different net gains."
                )
            }
        }
    }

    /// Returns the error bar of one figure of one condition.
    pub fn bar(&self, condition: ConditionId, figure: Scalar) -> Option<&Bar> {
        self.conditions.get(&condition)?.bars[figure].as_ref()
    }
}

/// Returns the error bars of one figure in several conditions; `None` where a condition has none.
fn bars_of(conditions: &[&ConditionUncertainty], scalar: Scalar) -> Option<Vec<Bar>> {
    conditions
        .iter()
        .map(|condition| condition.bars[scalar])
        .collect()
}

fn second_variables(
    schedule: &Schedule,
    states: &[&FlightState],
    conditions: &[&ConditionUncertainty],
    pairs: &[Pair],
    level: f64,
) -> Vec<SecondVariableTest> {
    let rows = schedule.airspeed_design();
    let designs = SecondVariable::BOTH.map(|variable| {
        let values = variable
            .values(states)
            .ok_or(SecondVariableError::NotVaried);
        values.and_then(|values| SecondVariableDesign::of(&rows, &values))
    });
    let mut tests = Vec::new();
    for &pair in pairs {
        let Some(bars) = bars_of(conditions, Scalar::NetGain(pair)) else {
            continue;
        };
        let figures: Vec<f64> = bars.iter().map(|bar| bar.value).collect();
        for (variable, design) in SecondVariable::BOTH.into_iter().zip(&designs) {
            let effect = design
                .as_ref()
                .map(|design| design.effect(&figures, level))
                .map_err(|error| *error);
            tests.push(SecondVariableTest {
                pair,
                variable,
                effect,
                p_holm: None,
                needed: false,
            });
        }
    }
    let probabilities: Vec<Option<f64>> = tests
        .iter()
        .map(|test| Some(test.effect.as_ref().ok()?.p))
        .collect();
    for (test, p) in tests.iter_mut().zip(holm_where_known(&probabilities)) {
        test.p_holm = p;
        test.needed = test
            .effect
            .as_ref()
            .ok()
            .zip(p)
            .is_some_and(|(effect, p)| effect.is_needed(p, level));
    }
    tests
}

/// Greatest number of differences that are compared.
const MOST_DIFFERENCES: usize = 20_000;
/// Greatest difference of airspeeds that count as equal \[kt\] (M13.4).
pub(crate) const EQUAL_AIRSPEED_KT: f64 = 1.0;

/// The difference of an on-axis net gain between two conditions at equal airspeed (M13.4).
#[derive(Clone, Debug, PartialEq)]
pub struct AirspeedDifference {
    pub pair: Pair,
    pub conditions: [ConditionId; 2],
    /// Mean airspeed of the two conditions \[kt\].
    pub airspeed_kt: f64,
    /// The difference of `ln k_o k_i`.
    pub difference: Difference,
    /// Probability of such a difference under the null hypothesis, after Holm's correction over all
    /// displayed differences; `None` where the bundles have no spread.
    pub p_holm: Option<f64>,
}

impl AirspeedDifference {
    /// Returns whether the difference exceeds the expectation from trim and identification
    /// uncertainty.
    pub fn is_significant(&self, level: f64) -> bool {
        self.p_holm.is_some_and(|p| p < 1.0 - level)
    }

    /// Returns the verdict of the test.
    pub fn verdict(&self, level: f64) -> &'static str {
        match (self.p_holm, self.is_significant(level)) {
            (None, _) => "no spread",
            (_, true) => "significant: a physical effect, or a model-form error",
            (_, false) => "not significant",
        }
    }

    /// Describes the difference: "conditions 3 and 5 (45 kt) differ by 13 %, 5.4 × expected from
    /// trim and identification uncertainty; significant: a physical effect, or a model-form error".
    pub fn words(&self, level: f64) -> String {
        let [first, second] = self.conditions;
        let airspeed = self.airspeed_kt;
        let percent = 100.0 * self.difference.delta.abs();
        let differ =
            format!("conditions {first} and {second} ({airspeed:.0} kt) differ by {percent:.0} %");
        let Some(ratio) = self.difference.ratio() else {
            return format!("{differ}; their bundles have no spread to compare that with");
        };
        format!(
            "{differ}, {ratio:.1} × expected from trim and identification uncertainty; {}",
            self.verdict(level)
        )
    }
}

/// Computes the differences of these net gains between every two conditions at equal airspeed.
///
/// # Errors
/// The number of differences, where they are too many to compare.
pub(crate) fn differences(
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
    let mut rising: Vec<f64> = analysed
        .iter()
        .map(|(condition, _)| airspeed(condition))
        .collect();
    rising.sort_by(f64::total_cmp);
    let near = |(place, low): (usize, &f64)| {
        rising.partition_point(|high| high - low <= EQUAL_AIRSPEED_KT) - place - 1
    };
    let count = pairs.len() * rising.iter().enumerate().map(near).sum::<usize>();
    if count > MOST_DIFFERENCES {
        return Err(count);
    }
    let mut found = Vec::new();
    for &pair in pairs {
        for (place, (first, of_first)) in analysed.iter().enumerate() {
            for (second, of_second) in &analysed[place + 1..] {
                let a = airspeed(first);
                let b = airspeed(second);
                let bars =
                    of_first.bars[Scalar::NetGain(pair)].zip(of_second.bars[Scalar::NetGain(pair)]);
                if let Some((one, other)) = bars.filter(|_| (a - b).abs() <= EQUAL_AIRSPEED_KT) {
                    let conditions = [first.id(), second.id()];
                    let airspeed_kt = 0.5 * (a + b);
                    let difference = Difference::of(&one, &other);
                    found.push(AirspeedDifference {
                        pair,
                        conditions,
                        airspeed_kt,
                        difference,
                        p_holm: None,
                    });
                }
            }
        }
    }
    let corrected = holm_where_known(&found.iter().map(|of| of.difference.p()).collect::<Vec<_>>());
    found
        .iter_mut()
        .zip(corrected)
        .for_each(|(difference, p)| difference.p_holm = p);
    Ok(found)
}

/// Applies Holm's correction to the known probabilities.
pub(crate) fn holm_where_known(probabilities: &[Option<f64>]) -> Vec<Option<f64>> {
    let known: Vec<f64> = probabilities.iter().flatten().copied().collect();
    let mut corrected = holm(&known).into_iter();
    probabilities
        .iter()
        .map(|p| p.and_then(|_| corrected.next()))
        .collect()
}
