//! Benefit and cost of couplings: the uncertainty of their entries, J without and with them and of
//! conditions left out, moved poles, stability margin of the loop, effect above the band (M16.4).

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Complex, DMatrix};
use serde::Serialize;

use gdcm_method::correction::Pade;
use gdcm_method::correction::lead_price::ABOVE_BAND;
use gdcm_method::couplings::coupling_effects::relative_change_db;
use gdcm_method::couplings::problem::CouplingError;
use gdcm_method::couplings::{CouplingBars, LEAST_CONDITIONS, LeftOutFit, LoopMargin, PoleShift};
use gdcm_method::schedule::CostChange;
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Model, Pair, PairTable};
use gdcm_model::executor::{Sequential, each};
use gdcm_model::progress::{Cancelled, Portion, Progress, Shares};
use gdcm_model::response::frequency_response::log_spaced;
use gdcm_model::response::{FrequencyGrid, PreparedModel};

use super::analysis::{Analysis, ConditionAnalysis};
use super::assessment_table::{AssessedCorrection, AssessedModel, AssessmentChoice, assessed};
use crate::decisions::edit::Edit;
use crate::decisions::settings::CouplingCorrection;
use crate::decisions::study::Study;
use crate::jobs::job::{Job, VariantJob};
use crate::stages::condition_stages::SUBSTITUTION_PROOF;
use crate::stages::engine::Engine;
use crate::stages::fitted_couplings::FittedCouplings;

/// Name of the step in progress reports.
const LEAVING_OUT: &str = "couplings without each condition";

/// Number of frequencies of the singular values below the band, and from its lower end to ten times
/// its top: 2 % apart over the example's band.
const MARGIN_POINTS: [usize; 2] = [60, 300];

/// An entry of `M~` or of `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingEntry {
    pub value: f64,
    /// Half-width of its error bar; `None` with fewer than three conditions.
    pub half_width: Option<f64>,
    /// Jackknife standard deviation.
    pub deviation: Option<f64>,
    /// Whether the value is not distinguishable from the value without coupling.
    pub is_within_bar: bool,
}

/// Effect of the couplings on one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionCouplings {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Poles of the physics representative before and after, or why they are unknown.
    pub poles: Result<Vec<PoleShift>, String>,
    /// The least singular value of `I - K H` at [`CouplingsAssessment::omega`].
    pub singular_values: Vec<f64>,
    /// Least singular value from the lower end of the band to ten times its top.
    pub margin: Option<LoopMargin>,
    /// `20 log10 |H~ - H| / |H|` of each response at ten times the band.
    pub above_band_db: PairTable<Option<f64>>,
    /// J of the condition when left out, on-axis and off-axis; `None` where it is in no fit.
    pub left_out: Option<CouplingCost>,
    /// Kept physics models with matrices, other than the representative, whose loop cannot be
    /// closed, with the reason.
    pub refused: Vec<(String, String)>,
}

/// A pole of a kept physics model with a positive real part that is absent without the couplings.
#[derive(Clone, Debug, PartialEq)]
pub struct UnstablePole {
    pub condition: ConditionId,
    pub model: String,
    /// Whether it represents its bundle.
    pub is_representative: bool,
    /// The pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Whether its frequency lies in the band of comparison.
    pub is_in_band: bool,
}

/// Benefit and cost of couplings (M16.4). Conclusions in words: [`CouplingsAssessment::remarks`].
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingsAssessment {
    pub couplings: CouplingCorrection,
    pub fitted: Arc<FittedCouplings>,
    /// Level of the error bars.
    pub level: f64,
    pub band: Band,
    /// The fits without each condition in turn; empty with fewer than three conditions.
    pub left_out_fits: Vec<LeftOutFit>,
    /// J without and with the couplings.
    pub costs: CouplingCosts,
    /// Frequencies of the singular values \[rad/s\]: from a tenth of the band to ten times it.
    pub omega: Arc<[f64]>,
    /// Each analysed condition.
    pub conditions: BTreeMap<ConditionId, ConditionCouplings>,
    /// Newly unstable poles of every kept physics model.
    pub unstable: Vec<UnstablePole>,
    /// Number of conditions where all constrained responses want lead that no channel provides: a
    /// feedback then acts as a substitute.
    pub want_leads: usize,
}

impl CouplingsAssessment {
    /// Returns the mean airspeed of the conditions \[kt\], at which the mixing is reported where a
    /// single airspeed is needed.
    pub fn mean_airspeed_kt(&self) -> f64 {
        self.fitted.matrices().airspeeds().mean_kt
    }

    fn bars(&self, airspeed_kt: f64) -> Option<CouplingBars> {
        CouplingBars::of(&self.left_out_fits, airspeed_kt, self.level).ok()
    }

    /// Returns `M~`, m x m, at an airspeed, with its error bars.
    pub fn mixing(&self, airspeed_kt: f64) -> DMatrix<CouplingEntry> {
        let values = self.fitted.matrices().normalised_mixing(airspeed_kt);
        let bars = self.bars(airspeed_kt);
        entries(
            &values,
            bars.as_ref().map(|bars| (&bars.mixing, bars.quantile)),
            |to, from| to == from,
        )
    }

    /// Returns `K`, m x p, with its error bars.
    pub fn feedback(&self) -> DMatrix<CouplingEntry> {
        let bars = self.bars(self.mean_airspeed_kt());
        let values = self.fitted.matrices().feedback();
        entries(
            values,
            bars.as_ref().map(|bars| (&bars.feedback, bars.quantile)),
            |_, _| false,
        )
    }

    /// Returns the number of newly unstable poles whose frequency lies in the band of comparison,
    /// over all kept physics models.
    pub fn unstable_in_band(&self) -> usize {
        self.unstable.iter().filter(|of| of.is_in_band).count()
    }

    /// Returns the decisive costs: J of conditions left out, or of the schedule where none is left
    /// out.
    pub fn deciding_cost(&self) -> CouplingCost {
        self.costs.left_out.unwrap_or(self.costs.scheduled)
    }
}

/// Builds entries from values, half-widths of their error bars and Student's quantile; `is_fixed`
/// marks the values that are not unknowns.
fn entries(
    values: &DMatrix<f64>,
    bars: Option<(&DMatrix<f64>, f64)>,
    is_fixed: impl Fn(usize, usize) -> bool,
) -> DMatrix<CouplingEntry> {
    DMatrix::from_fn(values.nrows(), values.ncols(), |row, column| {
        let value = values[(row, column)];
        let half_width = bars.map(|(half_widths, _)| half_widths[(row, column)]);
        CouplingEntry {
            value,
            half_width,
            deviation: half_width
                .zip(bars)
                .map(|(half_width, (_, quantile))| half_width / quantile),
            is_within_bar: !is_fixed(row, column)
                && (value == 0.0 || half_width.is_some_and(|bar| value.abs() <= bar)),
        }
    })
}

/// Result of an assessment; without couplings, the error of the fit.
pub type AssessedCouplings = Result<Arc<CouplingsAssessment>, CouplingError>;

/// Job that assesses couplings for a study, beside the live answer.
#[derive(Clone, Debug)]
pub struct CouplingsJob {
    /// The study; its own setting of couplings is ignored.
    pub study: Study,
    pub couplings: CouplingCorrection,
}

impl CouplingsJob {
    fn variant(&self) -> VariantJob {
        VariantJob {
            study: with_couplings(&self.study, self.couplings),
        }
    }
}

impl PartialEq for CouplingsJob {
    fn eq(&self, other: &Self) -> bool {
        self.variant() == other.variant()
    }
}

impl Job for CouplingsJob {
    /// An engine that caches the results common to all fits.
    type Tools = Engine;
    type Output = Option<AssessedCouplings>;

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        engine.assess_couplings(&self.study, self.couplings, progress)
    }
}

fn with_couplings(study: &Study, couplings: CouplingCorrection) -> Study {
    let mut study = study.clone();
    study.settings.couplings = couplings;
    study
}

impl Engine {
    /// Assesses the couplings of a study; `None` where it requests none.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` requests it.
    pub fn assess_couplings(
        &mut self,
        study: &Study,
        couplings: CouplingCorrection,
        progress: &dyn Progress,
    ) -> Result<Option<AssessedCouplings>, Cancelled> {
        let shares = Shares::new(progress);
        let portion = Portion::new(&shares, 0.1, LEAVING_OUT);
        let without = self.analyze(&with_couplings(study, CouplingCorrection::None), &portion)?;
        portion.finish()?;
        let portion = Portion::new(&shares, 0.1, LEAVING_OUT);
        let with = self.analyze(&with_couplings(study, couplings), &portion)?;
        portion.finish()?;
        let fitted = match &with.couplings {
            None => return Ok(None),
            Some(Err(error)) => return Ok(Some(Err(error.clone()))),
            Some(Ok(fitted)) => Arc::clone(fitted),
        };
        let left_out = self.left_out(&with, (&without, &fitted), &shares)?;
        let settings = &study.settings;
        let grid = margin_grid(settings.band);
        let mut assessment = CouplingsAssessment {
            couplings,
            fitted,
            level: settings.uncertainty.level,
            band: settings.band,
            costs: costs(&without, &with, &left_out),
            omega: grid.omega().into(),
            conditions: BTreeMap::new(),
            unstable: Vec::new(),
            want_leads: without
                .conditions
                .values()
                .flatten()
                .filter(|result| result.offer.is_some())
                .count(),
            left_out_fits: Vec::new(),
        };
        let results: Vec<&ConditionAnalysis> = with.conditions.values().flatten().collect();
        let share = 0.2 / results.len().max(1) as f64;
        let looked_at = each(self.executor(), &results, |result| {
            let found = of_condition(&with.study, result, &grid, progress)?;
            shares.advance(share, LEAVING_OUT)?;
            Ok::<_, Cancelled>(found)
        });
        for (result, looked_at) in results.iter().zip(looked_at) {
            let (mut condition, unstable) = looked_at?;
            let id = result.condition.id();
            condition.left_out = left_out
                .iter()
                .find(|of| of.fit.condition == id)
                .map(|of| of.cost);
            assessment.conditions.insert(id, condition);
            assessment.unstable.extend(unstable);
        }
        assessment.left_out_fits = left_out.into_iter().map(|of| of.fit).collect();
        Ok(Some(Ok(Arc::new(assessment))))
    }

    /// Repeats the fit and the schedule without each condition in turn; empty with fewer than three
    /// conditions.
    fn left_out(
        &self,
        with: &Analysis,
        (without, fitted): (&Analysis, &FittedCouplings),
        shares: &Shares<'_>,
    ) -> Result<Vec<LeftOutCondition>, Cancelled> {
        let ids: Vec<ConditionId> = fitted.problem.conditions.iter().map(|of| of.id).collect();
        if ids.len() < LEAST_CONDITIONS {
            return Ok(Vec::new());
        }
        let share = 0.6 / ids.len() as f64;
        let of_condition = |id: ConditionId| {
            let mut study = with.study.clone();
            if study
                .apply(&Edit::SetHeldOut {
                    condition: id,
                    held_out: true,
                })
                .is_err()
            {
                return Ok(None);
            }
            let mut engine = self
                .fork(Box::new(Sequential))
                .with_proofs_within(SUBSTITUTION_PROOF);
            let portion = Portion::new(shares, share, LEAVING_OUT);
            let analysis = engine.analyze(&study, &portion)?;
            portion.finish()?;
            Ok(LeftOutCondition::of(id, &analysis, without))
        };
        each(self.executor(), ids, of_condition)
            .into_iter()
            .filter_map(Result::transpose)
            .collect()
    }
}

/// A condition left out of the fit and of the schedule.
struct LeftOutCondition {
    fit: LeftOutFit,
    cost: CouplingCost,
    changes: [PairTable<Option<CostChange>>; 2],
}

impl LeftOutCondition {
    /// Returns `None` where the other conditions give no couplings or schedule, or the condition
    /// cannot be assessed.
    fn of(condition: ConditionId, held_out: &Analysis, without: &Analysis) -> Option<Self> {
        let fit = LeftOutFit {
            condition,
            fit: held_out.fitted_couplings()?.fit.clone(),
        };
        let changes = [
            (without, AssessedCorrection::ScheduleOfOthers),
            (held_out, AssessedCorrection::Scheduled),
        ];
        let [before, after] = changes.map(|(analysis, correction)| {
            Some(
                assessed(analysis, condition, choice(analysis, correction))
                    .ok()?
                    .changes,
            )
        });
        let changes = [before?, after?];
        let mut sums = CostSums::new(without.study.dataset.on_axis());
        sums.add(&changes[0], &changes[1]);
        Some(Self {
            fit,
            cost: sums.corrected(),
            changes,
        })
    }
}

/// Returns the choice that assesses the representatives under a correction.
fn choice(analysis: &Analysis, correction: AssessedCorrection) -> AssessmentChoice {
    AssessmentChoice {
        model: AssessedModel::Representative,
        correction,
        average: analysis.study.settings.cost_average,
    }
}

fn costs(without: &Analysis, with: &Analysis, left_out: &[LeftOutCondition]) -> CouplingCosts {
    let on_axis = without.study.dataset.on_axis();
    let of = |correction: AssessedCorrection| {
        let mut sums = CostSums::new(on_axis);
        for &id in without.conditions.keys() {
            let changes = |analysis| assessed(analysis, id, choice(analysis, correction));
            if let (Ok(without), Ok(with)) = (changes(without), changes(with)) {
                sums.add(&without.changes, &with.changes);
            }
        }
        sums
    };
    let own = of(AssessedCorrection::Own);
    let scheduled = of(AssessedCorrection::Scheduled);
    let mut unseen = CostSums::new(on_axis);
    left_out.iter().for_each(
        |LeftOutCondition {
             changes: [without, with],
             ..
         }| unseen.add(without, with),
    );
    CouplingCosts {
        uncorrected: own.uncorrected(),
        own: own.corrected(),
        scheduled: scheduled.corrected(),
        left_out: (!left_out.is_empty()).then(|| unseen.corrected()),
    }
}

/// Returns the grid from a tenth of the band to ten times it, with both ends of the lower part of
/// the band included.
fn margin_grid(band: Band) -> FrequencyGrid {
    let [below, above] = MARGIN_POINTS;
    let mut omega = log_spaced(band.min() / ABOVE_BAND, band.min(), below);
    omega.pop();
    omega.extend(log_spaced(band.min(), ABOVE_BAND * band.max(), above));
    FrequencyGrid::at(omega)
}

/// Computes the effect of the couplings on a condition, and the newly unstable poles of its kept
/// physics models.
fn of_condition(
    study: &Study,
    result: &ConditionAnalysis,
    grid: &FrequencyGrid,
    progress: &dyn Progress,
) -> Result<(ConditionCouplings, Vec<UnstablePole>), Cancelled> {
    let id = result.condition.id();
    let airspeed_kt = result.condition.flight_state().airspeed_kt;
    let physics = result.condition.bundle(BundleKind::Physics);
    let chosen = result.comparison.physics.model;
    let Some(coupled) = &result.coupled else {
        return Err(Cancelled);
    };
    let matrices = coupled.fitted.matrices();
    let shifts = |model: &Model| match model.state_space() {
        None => {
            Err("the physics representative is a measured response: it has no poles".to_owned())
        }
        Some(of) => matrices
            .pole_shifts(of, airspeed_kt, Pade::default())
            .map_err(|error| error.to_string()),
    };
    let response = PreparedModel::of(&physics[chosen].dynamics).response(grid);
    let singular_values = matrices.least_singular_values(&response);
    let from_band = grid
        .omega()
        .partition_point(|omega| *omega < study.settings.band.min());
    let above_band_db = relative_change_db(
        &response,
        &result.coupled_response(&response),
        grid.len() - 1,
    );
    let mut unstable = Vec::new();
    let mut refused = Vec::new();
    let mut poles = Err(String::new());
    for (index, model) in physics.iter().enumerate() {
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let is_representative = index == chosen;
        if study.choice(id).physics.rejected.contains(&model.name) && !is_representative {
            continue;
        }
        let found = shifts(model);
        let newly = found
            .iter()
            .flatten()
            .filter(|shift| shift.is_newly_unstable());
        unstable.extend(newly.map(|shift| {
            UnstablePole {
                condition: id,
                model: model.name.clone(),
                is_representative,
                pole: shift.after,
                is_in_band: (study.settings.band.min()..=study.settings.band.max())
                    .contains(&shift.after.norm()),
            }
        }));
        match found {
            found if is_representative => poles = found,
            Err(why) if model.state_space().is_some() => refused.push((model.name.clone(), why)),
            _ => {}
        }
    }
    let margin = LoopMargin::of(&singular_values[from_band..], &grid.omega()[from_band..]);
    let left_out = None;
    Ok((
        ConditionCouplings {
            airspeed_kt,
            poles,
            singular_values,
            margin,
            above_band_db,
            left_out,
            refused,
        },
        unstable,
    ))
}

impl ConditionCouplings {
    /// Returns the marked response that couplings change most above the band, and the change
    /// \[dB\].
    pub fn most_changed_above_band(&self, marked: &PairTable<bool>) -> Option<(Pair, f64)> {
        let known = marked
            .marked()
            .filter_map(|pair| Some((pair, self.above_band_db[pair]?)));
        known.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Mean J on-axis and off-axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AxisCost {
    /// Over the on-axis responses; `None` where none can be compared.
    pub on_axis: Option<f64>,
    /// Over the off-axis responses.
    pub others: Option<f64>,
}

/// Mean J without and with couplings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CouplingCost {
    pub without: AxisCost,
    pub with: AxisCost,
}

/// Mean J over the conditions, of each response that can be compared both without and with
/// couplings (M16.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CouplingCosts {
    /// Of the uncorrected physics representatives.
    pub uncorrected: AxisCost,
    /// Of each condition's own correction.
    pub own: CouplingCost,
    /// Of the schedule at each condition's airspeed.
    pub scheduled: CouplingCost,
    /// Of conditions left out: couplings, channel delays and schedule found without each condition
    /// in turn; `None` with fewer than three.
    pub left_out: Option<CouplingCost>,
}

impl CouplingCost {
    /// Greatest off-axis J, relative to that without couplings, at which couplings are worthwhile.
    const WORTH: f64 = 0.9;

    /// Returns whether couplings reduce the off-axis J by at least a tenth.
    pub fn is_worth_it(&self) -> bool {
        self.with
            .others
            .zip(self.without.others)
            .is_some_and(|(with, without)| with <= Self::WORTH * without)
    }
}

/// Sums of J over the responses of many conditions.
pub(crate) struct CostSums<'a> {
    on_axis: &'a PairTable<bool>,
    /// Off-axis and on-axis: count, then J before any correction, without couplings, with
    /// couplings.
    sums: [(usize, [f64; 3]); 2],
}

impl<'a> CostSums<'a> {
    pub(crate) fn new(on_axis: &'a PairTable<bool>) -> Self {
        Self {
            on_axis,
            sums: Default::default(),
        }
    }

    /// Adds the responses of a condition, without and with couplings.
    pub(crate) fn add(
        &mut self,
        without: &PairTable<Option<CostChange>>,
        with: &PairTable<Option<CostChange>>,
    ) {
        let both = |(pair, of): (Pair, &Option<CostChange>)| Some((pair, (*of)?, with[pair]?));
        for (pair, without, with) in without.iter().filter_map(both) {
            let (count, sums) = &mut self.sums[usize::from(self.on_axis[pair])];
            *count += 1;
            let added =
                [without.uncorrected, without.corrected, with.corrected].map(|cost| cost.total());
            sums.iter_mut()
                .zip(added)
                .for_each(|(sum, cost)| *sum += cost);
        }
    }

    fn mean(&self, which: usize) -> AxisCost {
        let [others, on_axis] = self
            .sums
            .map(|(count, sums)| (count > 0).then(|| sums[which] / count as f64));
        AxisCost { on_axis, others }
    }

    /// Returns the mean of J before any correction.
    pub(crate) fn uncorrected(&self) -> AxisCost {
        self.mean(0)
    }

    /// Returns the means of J without and with couplings.
    pub(crate) fn corrected(&self) -> CouplingCost {
        CouplingCost {
            without: self.mean(1),
            with: self.mean(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, LazyLock};

    use nalgebra::DMatrix;

    use gdcm_method::couplings::{CouplingMatrices, Unknown};
    use gdcm_method::schedule::Airspeeds;
    use gdcm_model::dataset::condition::FlightState;
    use gdcm_model::dataset::dataset::DatasetHeader;
    use gdcm_model::dataset::model::Origin;
    use gdcm_model::dataset::{Channel, *};
    use gdcm_model::progress::Unobserved;

    use super::*;
    use crate::decisions::setting;
    use crate::decisions::settings::PhaseCorrection;
    use crate::results::couplings_tests::{
        COUPLED, EXAMPLE, REFERENCE, assert_close, engine, list, number, numbers, own_and_scheduled,
    };
    use crate::results::remark::RemarkKind;

    /// The assessment of mixing and feedback of the reference dataset.
    static ASSESSED: LazyLock<Arc<CouplingsAssessment>> = LazyLock::new(|| {
        let job = CouplingsJob {
            study: EXAMPLE.analysis.study.clone(),
            couplings: CouplingCorrection::MixingAndFeedback,
        };
        job.run(&mut engine(), &Unobserved)
            .unwrap()
            .unwrap()
            .unwrap()
    });

    fn both(of: AxisCost) -> Vec<f64> {
        vec![of.on_axis.unwrap(), of.others.unwrap()]
    }

    #[test]
    fn costs_without_and_with_couplings_are_those_of_the_two_studies() {
        let costs = &ASSESSED.costs;
        let mean_cost = &REFERENCE["example"]["feedback"]["mean_J"];
        let tolerance = number(&REFERENCE["tolerance"]["mean_J"]);
        assert_close(
            "own",
            &both(costs.own.with),
            &numbers(&mean_cost["own"]),
            tolerance,
        );
        assert_close(
            "scheduled",
            &both(costs.scheduled.with),
            &numbers(&mean_cost["scheduled"]),
            tolerance,
        );
        let [own, scheduled] = own_and_scheduled(&EXAMPLE.analysis);
        // The same sums in another order.
        assert_close("own, without", &both(costs.own.without), &own, 1e-9);
        assert_close(
            "scheduled, without",
            &both(costs.scheduled.without),
            &scheduled,
            1e-9,
        );
    }

    #[test]
    fn a_condition_left_out_is_in_neither_the_fit_nor_the_schedule_that_judge_it() {
        let left_out = ASSESSED.costs.left_out.unwrap();
        let [unseen, seen] =
            [left_out, ASSESSED.costs.scheduled].map(|cost| cost.with.others.unwrap());
        assert!(
            unseen > seen,
            "what was seen is fitted better: {unseen} {seen}"
        );
        assert!(
            left_out.is_worth_it() && unseen < 0.6 * left_out.without.others.unwrap(),
            "{left_out:?}"
        );
        assert_eq!(ASSESSED.left_out_fits.len(), 11);
        let id = ASSESSED.left_out_fits[3].condition;
        let mut study = COUPLED.1.study.clone();
        study
            .apply(&Edit::SetHeldOut {
                condition: id,
                held_out: true,
            })
            .unwrap();
        let analysis = engine().analyze(&study, &Unobserved).unwrap();
        assert_eq!(
            analysis.fitted_couplings().unwrap().fit,
            ASSESSED.left_out_fits[3].fit
        );
        assert!(
            ASSESSED.conditions[&id]
                .left_out
                .unwrap()
                .with
                .others
                .unwrap()
                > 0.0
        );
    }

    #[test]
    fn the_diagnosis_comes_first_and_what_is_within_its_bar_is_not_told() {
        let said = ASSESSED.remarks(&EXAMPLE.dataset);
        let swashplate = said.iter().position(|of| {
            of.text.starts_with("LAT takes ") && of.text.contains("swashplate phase of ")
        });
        let verdict = said.iter().position(|of| {
            of.text
                .starts_with("Off the axis, J of conditions left out is ")
        });
        assert!(swashplate.unwrap() < verdict.unwrap(), "{said:#?}");
        assert!(
            said.iter()
                .all(|of| !of.text.contains("switch the couplings off")),
            "{said:#?}"
        );
        assert!(
            ASSESSED.offer().unwrap().starts_with(
                "With mixing and feedback off-axis J of conditions left out would be "
            )
        );
        let mixing = ASSESSED.mixing(ASSESSED.mean_airspeed_kt());
        for (entry, half_width) in mixing
            .iter()
            .filter_map(|entry| Some((entry, entry.half_width?)))
        {
            assert!(entry.is_within_bar == (entry.value.abs() <= half_width) || entry.value == 1.0);
            assert!(
                entry.deviation.unwrap() <= half_width,
                "Student's quantile of 90 % is over 1"
            );
        }
        assert!(
            mixing
                .diagonal()
                .iter()
                .all(|entry| entry.value == 1.0 && !entry.is_within_bar)
        );
        assert!(ASSESSED.feedback().iter().any(|entry| entry.is_within_bar));
    }

    #[test]
    fn an_unstable_pole_in_the_band_is_told_before_faster_ones_beyond_it() {
        let unstable = |model: &str, real: f64, is_in_band: bool| UnstablePole {
            condition: ConditionId(4),
            model: model.to_owned(),
            is_representative: false,
            pole: nalgebra::Complex::from(real),
            is_in_band,
        };
        let mut assessed = (**ASSESSED).clone();
        assessed.unstable = vec![unstable("fast", 90.0, false), unstable("slow", 2.0, true)];
        assessed.left_out_fits.pop();
        let said = assessed.cautions(&EXAMPLE.dataset);
        let poles = said
            .iter()
            .find(|of| of.text.contains("newly unstable"))
            .unwrap();
        assert_eq!(poles.kind, RemarkKind::Trouble);
        let words = "2 poles of other kept physics models are newly unstable with the couplings: in the band condition 4, slow at 2.000 rad/s; \
                     condition 4, fast at 90.000 rad/s.";
        assert_eq!(poles.text, words);
        assert!(
            said.iter()
                .any(|of| of.text.contains("rest on 10 of 11 conditions")),
            "{said:#?}"
        );
    }

    #[test]
    fn poles_margins_and_what_happens_above_the_band_are_of_every_condition() {
        let band = EXAMPLE.dataset.band();
        assert!((ASSESSED.omega[0] / band.min() - 0.1).abs() < 1e-9);
        for of in ASSESSED.conditions.values() {
            let poles = of.poles.as_ref().unwrap();
            assert!(
                poles
                    .iter()
                    .any(|shift| shift.distance_rad_s().unwrap() > 1e-3),
                "feedback moves poles"
            );
            let margin = of.margin.unwrap();
            // M16.4: 0.87 in the band of another dataset of the same helicopter.
            assert!(
                margin.least > 0.8 && margin.omega_rad_s >= band.min(),
                "{margin:?}"
            );
            let (_, change_db) = of
                .most_changed_above_band(EXAMPLE.dataset.on_axis())
                .unwrap();
            assert!(change_db < 6.0 && change_db > -60.0, "{change_db}");
        }
        assert!(
            ASSESSED
                .unstable
                .iter()
                .all(|of| !of.is_in_band && of.pole.re > 0.0)
        );
    }

    #[test]
    fn without_leads_a_feedback_is_said_to_take_their_place() {
        assert_eq!(ASSESSED.want_leads, 0, "leads are given");
        let mut study = EXAMPLE.analysis.study.clone();
        study
            .apply(&setting::PHASE.to(PhaseCorrection::Delay))
            .unwrap();
        let assess = |couplings| {
            engine()
                .assess_couplings(&study, couplings, &Unobserved)
                .unwrap()
                .unwrap()
                .unwrap()
        };
        let says = |of: &CouplingsAssessment| {
            of.cautions(&EXAMPLE.dataset)
                .iter()
                .any(|of| of.text.ends_with("Correct the phase by leads first."))
        };
        assert!(says(&assess(CouplingCorrection::MixingAndFeedback)) && !says(&ASSESSED));
        assert!(
            !says(&assess(CouplingCorrection::Mixing)),
            "a mixing gives no lead"
        );
    }

    #[test]
    fn mixing_alone_moves_no_pole_and_no_couplings_are_not_assessed() {
        let study = EXAMPLE.analysis.study.clone();
        let run = |couplings| {
            CouplingsJob {
                study: study.clone(),
                couplings,
            }
            .run(&mut engine(), &Unobserved)
            .unwrap()
        };
        assert!(run(CouplingCorrection::None).is_none());
        let mixing = run(CouplingCorrection::Mixing).unwrap().unwrap();
        for of in mixing.conditions.values() {
            assert!(
                of.poles
                    .as_ref()
                    .unwrap()
                    .iter()
                    .all(|shift| shift.distance_rad_s() == Some(0.0))
            );
            assert_eq!(of.margin.unwrap().least, 1.0);
        }
        let mean_cost = &REFERENCE["example"]["mixing"]["mean_J"];
        assert_close(
            "own",
            &both(mixing.costs.own.with),
            &numbers(&mean_cost["own"]),
            1e-3,
        );
        assert_eq!(list(&mean_cost["own"]).len(), 2);
    }

    /// Builds a stable aircraft with this many outputs and inputs; `response` selects the responses
    /// it has.
    fn aircraft(outputs: usize, inputs: usize, response: impl Fn(Pair) -> bool) -> StateSpace {
        let states = outputs * inputs;
        let of = |state: usize| Pair::new(state / inputs, state % inputs);
        let a = DMatrix::from_fn(states, states, |row, column| {
            if row == column {
                -0.8 - 0.3 * row as f64
            } else {
                0.0
            }
        });
        let b = DMatrix::from_fn(states, inputs, |state, input| {
            f64::from(u8::from(of(state).input == input))
        });
        let gain = |pair: Pair| if pair.output == pair.input { 4.0 } else { 0.5 };
        let c = DMatrix::from_fn(outputs, states, |output, state| {
            if of(state).output == output && response(of(state)) {
                gain(of(state))
            } else {
                0.0
            }
        });
        StateSpace::new(a, b, c, DMatrix::zeros(outputs, inputs)).unwrap()
    }

    /// Builds a study of such aircraft, whose flight models add a little mixing and feedback; gains
    /// alone correct the channels.
    fn small_study(
        outputs: usize,
        inputs: usize,
        conditions: i64,
        response: impl Fn(Pair) -> bool,
    ) -> Study {
        let unknowns = [
            Unknown::Mixing {
                to: inputs - 1,
                from: 0,
                power: 0,
            },
            Unknown::Feedback {
                input: 0,
                output: outputs - 1,
            },
        ];
        let airspeeds = || Airspeeds::new(vec![40.0], 2.0).unwrap();
        let flown = CouplingMatrices::none(airspeeds(), inputs, outputs).with(
            &(0..inputs)
                .map(|of| Unknown::Mixing {
                    to: of,
                    from: of,
                    power: 0,
                })
                .chain(unknowns)
                .collect::<Vec<_>>(),
            &vec![1.0; inputs]
                .into_iter()
                .chain([0.08, -0.05])
                .collect::<Vec<_>>(),
        );
        let condition = |id: i64| {
            let physics = aircraft(outputs, inputs, &response);
            let flight = flown.model(&physics, 40.0, Default::default()).unwrap();
            let model = |name: &str, origin, of| Model::new(name, origin, Dynamics::StateSpace(of));
            let nominal = model("nominal", Origin::Nominal { perturbation: None }, physics);
            let flight = model(
                "flight",
                Origin::Identified {
                    method: None,
                    order: None,
                },
                flight,
            );
            let state = FlightState::at(ConditionId(id), 40.0 + 20.0 * id as f64);
            Condition::new(state, vec![nominal], vec![flight]).unwrap()
        };
        let channels = |letter: &str, count: usize, unit: &str| -> Vec<Channel> {
            (1..=count)
                .map(|of| Channel::new(format!("{letter}{of}"), unit))
                .collect()
        };
        let header = DatasetHeader {
            name: "small".into(),
            description: String::new(),
            inputs: channels("U", inputs, "%"),
            outputs: channels("Y", outputs, "deg/s"),
            on_axis: PairTable::from_fn(outputs, inputs, |pair| pair.output == pair.input),
            band: Band::new(0.5, 10.0).unwrap(),
        };
        let mut study = Study::new(Arc::new(
            Dataset::new(header, (1..=conditions).map(condition).collect()).unwrap(),
        ));
        study
            .apply(&setting::PHASE.to(PhaseCorrection::None))
            .unwrap();
        study
            .apply(&setting::COUPLINGS.to(CouplingCorrection::MixingAndFeedback))
            .unwrap();
        study
    }

    #[test]
    fn a_study_with_hardly_anything_to_fit_gets_couplings_in_finite_numbers_or_words() {
        for (outputs, inputs, conditions) in [(2, 2, 1), (1, 1, 2), (1, 3, 3), (3, 2, 4)] {
            let study = small_study(outputs, inputs, conditions, |_| true);
            let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
            let what = format!("{outputs} outputs, {inputs} inputs, {conditions} conditions");
            let fitted = analysis
                .fitted_couplings()
                .unwrap_or_else(|| panic!("{what}: {:?}", analysis.couplings));
            assert!(
                fitted
                    .fit
                    .coefficients
                    .iter()
                    .flatten()
                    .all(|value| value.is_finite()),
                "{what}"
            );
            let assessed = Engine::default()
                .assess_couplings(&study, study.settings.couplings, &Unobserved)
                .unwrap();
            let assessed = assessed.unwrap().unwrap();
            assert_eq!(assessed.costs.left_out.is_some(), conditions >= 3, "{what}");
            let said = assessed.cautions(&study.dataset);
            let has_few = said
                .iter()
                .any(|of| of.text.contains("three are needed for error bars"));
            assert_eq!(has_few, conditions < 3, "{what}: {said:?}");
            let own = assessed.costs.own.with;
            assert!(
                own.on_axis.unwrap() < 1.0 && own.others.is_none_or(|others| others < 1.0),
                "{what}: {own:?}"
            );
        }
    }

    #[test]
    fn a_response_that_nobody_has_is_left_alone_and_the_couplings_of_the_others_come_back() {
        let study = small_study(2, 2, 3, |pair| pair != Pair::new(0, 1));
        let analysis = Engine::default().analyze(&study, &Unobserved).unwrap();
        let matrices = analysis.fitted_couplings().unwrap().matrices();
        // The ridge shifts entries by a thousandth.
        assert!(
            (matrices.normalised_mixing(60.0)[(1, 0)] - 0.08).abs() < 1e-3,
            "{matrices:?}"
        );
        assert!(
            (matrices.feedback()[(0, 1)] + 0.05).abs() < 1e-3,
            "{matrices:?}"
        );
    }

    use gdcm_method::fidelity::Cost;

    fn change(uncorrected: f64, corrected: f64) -> Option<CostChange> {
        let cost = |magnitude| Cost {
            magnitude,
            phase: 0.0,
        };
        Some(CostChange {
            uncorrected: cost(uncorrected),
            corrected: cost(corrected),
        })
    }

    #[test]
    fn only_responses_that_can_be_compared_both_times_count() {
        let on_axis = PairTable::from_fn(2, 1, |pair| pair.output == 0);
        let mut sums = CostSums::new(&on_axis);
        let table =
            |values: [Option<CostChange>; 2]| PairTable::from_fn(2, 1, |pair| values[pair.output]);
        sums.add(
            &table([change(9.0, 4.0), change(50.0, 40.0)]),
            &table([change(9.0, 2.0), None]),
        );
        sums.add(
            &table([change(5.0, 2.0), change(70.0, 20.0)]),
            &table([change(5.0, 2.0), change(70.0, 18.0)]),
        );
        assert_eq!(
            sums.uncorrected(),
            AxisCost {
                on_axis: Some(7.0),
                others: Some(70.0)
            }
        );
        let found = sums.corrected();
        assert_eq!(
            found.without,
            AxisCost {
                on_axis: Some(3.0),
                others: Some(20.0)
            }
        );
        assert_eq!(
            found.with,
            AxisCost {
                on_axis: Some(2.0),
                others: Some(18.0)
            }
        );
        assert!(found.is_worth_it(), "a tenth less");
        assert!(!CouplingCost::default().is_worth_it());
    }
}
