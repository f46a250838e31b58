//! What couplings are worth and what they cost: how sure their entries are, J without and with them and of conditions left out, the poles
//! that move, how near the loop is to ringing, what it does above the band (M16.4).

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Complex, DMatrix};

use crate::correction::{ABOVE_BAND, Pade};
use crate::couplings::{
    CouplingBars, CouplingError, LEAST_CONDITIONS, LeftOutFit, LoopMargin, PoleShift, relative_change_db,
};
use crate::dataset::{Band, BundleKind, ConditionId, Model, Pair, PairTable};
use crate::executor::{Sequential, each};
use crate::progress::{Shares, Untold};
use crate::response::{FrequencyGrid, PreparedModel, log_spaced};
use crate::schedule::CostChange;

use super::condition_stages::SUBSTITUTION_PROOF;
use super::{
    Analysis, AssessedCorrection, AssessedModel, AssessmentChoice, Cancelled, ConditionAnalysis, CostSums,
    CouplingCorrection, CouplingCost, CouplingCosts, Edit, Engine, FittedCouplings, Job, Progress, Study, VariantJob,
    assessed,
};

/// Frequencies of the singular values below the band, and from its lower end to ten times its top: 2 % apart over the example's band.
const MARGIN_POINTS: [usize; 2] = [60, 300];

/// An entry of `M~` or of `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingEntry {
    /// The entry.
    pub value: f64,
    /// Half-width of its bar; none of fewer than three conditions.
    pub half_width: Option<f64>,
    /// Its standard deviation by the jackknife.
    pub deviation: Option<f64>,
    /// Whether it is not told from that of no coupling.
    pub is_within_bar: bool,
}

/// What couplings do to one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionCouplings {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Poles of the physics representative before and after, or why they are not known.
    pub poles: Result<Vec<PoleShift>, String>,
    /// The least singular value of `I - K H` at [`CouplingsAssessment::omega`].
    pub singular_values: Vec<f64>,
    /// The least of them from the lower end of the band to ten times its top.
    pub margin: Option<LoopMargin>,
    /// `20 log10 |H~ - H| / |H|` of each response at ten times the band.
    pub above_band_db: PairTable<Option<f64>>,
    /// J of the condition left out, on the axis and off it; none where it is in no fit.
    pub left_out: Option<CouplingCost>,
    /// Kept physics models with matrices, other than the representative, whose loop cannot be closed, and why.
    pub refused: Vec<(String, String)>,
}

/// A pole of a kept physics model with a positive real part that it has not without the couplings.
#[derive(Clone, Debug, PartialEq)]
pub struct UnstablePole {
    /// The condition.
    pub condition: ConditionId,
    /// The physics model.
    pub model: String,
    /// Whether it represents its bundle.
    pub is_representative: bool,
    /// The pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Whether its frequency lies in the band of comparison.
    pub is_in_band: bool,
}

/// What couplings are worth and what they cost (M16.4). What follows in words: [`CouplingsAssessment::remarks`].
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingsAssessment {
    /// Which couplings.
    pub couplings: CouplingCorrection,
    /// What was found.
    pub fitted: Arc<FittedCouplings>,
    /// Level of the bars.
    pub level: f64,
    /// The band of comparison.
    pub band: Band,
    /// The fits without each condition in turn; none of fewer than three conditions.
    pub left_out_fits: Vec<LeftOutFit>,
    /// J without and with them.
    pub costs: CouplingCosts,
    /// Frequencies of the singular values \[rad/s\]: from a tenth of the band to ten times it.
    pub omega: Arc<[f64]>,
    /// Each condition that was analysed.
    pub conditions: BTreeMap<ConditionId, ConditionCouplings>,
    /// Poles that are newly unstable, of every kept physics model.
    pub unstable: Vec<UnstablePole>,
    /// Number of conditions all of whose held responses want lead that no channel gives: a feedback then takes its place.
    pub want_leads: usize,
}

impl CouplingsAssessment {
    /// The airspeed at which mixing is told where one has to be chosen: the mean of the conditions' \[kt\].
    pub fn mean_airspeed_kt(&self) -> f64 {
        self.fitted.matrices().airspeeds().mean_kt
    }

    fn bars(&self, airspeed_kt: f64) -> Option<CouplingBars> {
        CouplingBars::of(&self.left_out_fits, airspeed_kt, self.level).ok()
    }

    /// `M~`, m x m, at an airspeed, with its bars.
    pub fn mixing(&self, airspeed_kt: f64) -> DMatrix<CouplingEntry> {
        let (values, bars) = (self.fitted.matrices().normalised_mixing(airspeed_kt), self.bars(airspeed_kt));
        entries(&values, bars.as_ref().map(|bars| (&bars.mixing, bars.quantile)), |to, from| to == from)
    }

    /// `K`, m x p, with its bars.
    pub fn feedback(&self) -> DMatrix<CouplingEntry> {
        let bars = self.bars(self.mean_airspeed_kt());
        let values = self.fitted.matrices().feedback();
        entries(values, bars.as_ref().map(|bars| (&bars.feedback, bars.quantile)), |_, _| false)
    }

    /// What couplings are worth by what decides: J of conditions left out, or of the schedule where none is left out.
    pub fn deciding_cost(&self) -> CouplingCost {
        self.costs.left_out.unwrap_or(self.costs.scheduled)
    }
}

/// Values with the half-widths of their bars and Student's quantile; `is_fixed` says which of them are no unknowns.
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
            deviation: half_width.zip(bars).map(|(half_width, (_, quantile))| half_width / quantile),
            is_within_bar: !is_fixed(row, column) && (value == 0.0 || half_width.is_some_and(|bar| value.abs() <= bar)),
        }
    })
}

/// What comes of an assessment: why there are no couplings is told by the fit.
pub type AssessedCouplings = Result<Arc<CouplingsAssessment>, CouplingError>;

/// What couplings would do to a study, or do, beside the live answer.
#[derive(Clone, Debug)]
pub struct CouplingsJob {
    /// The study; what it says of couplings does not count.
    pub study: Study,
    /// The couplings.
    pub couplings: CouplingCorrection,
}

impl CouplingsJob {
    fn variant(&self) -> VariantJob {
        VariantJob { study: with_couplings(&self.study, self.couplings) }
    }
}

impl PartialEq for CouplingsJob {
    fn eq(&self, other: &Self) -> bool {
        self.variant() == other.variant()
    }
}

impl Job for CouplingsJob {
    /// An engine that keeps what is common to all fits.
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
    /// What couplings do to a study; none where none are asked for.
    ///
    /// # Errors
    /// [`Cancelled`] soon after `progress` says so.
    pub fn assess_couplings(
        &mut self,
        study: &Study,
        couplings: CouplingCorrection,
        progress: &dyn Progress,
    ) -> Result<Option<AssessedCouplings>, Cancelled> {
        let shares = Shares::new(progress);
        let told = |share: f64| shares.advance(share, "couplings without each condition");
        let without = self.analyze(&with_couplings(study, CouplingCorrection::None), &Untold(progress))?;
        told(0.1)?;
        let with = self.analyze(&with_couplings(study, couplings), &Untold(progress))?;
        told(0.1)?;
        let fitted = match &with.couplings {
            None => return Ok(None),
            Some(Err(error)) => return Ok(Some(Err(error.clone()))),
            Some(Ok(fitted)) => Arc::clone(fitted),
        };
        let left_out = self.left_out(&with, (&without, &fitted), (progress, &shares))?;
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
            want_leads: without.conditions.values().flatten().filter(|result| result.offer.is_some()).count(),
            left_out_fits: Vec::new(),
        };
        let results: Vec<&ConditionAnalysis> =
            with.conditions.values().filter_map(|outcome| outcome.as_ref().ok()).collect();
        let place = |at: usize| of_condition(&with.study, results[at], &grid, progress);
        let share = 0.2 / results.len().max(1) as f64;
        let looked_at = each(self.executor(), 0..results.len(), |at| {
            let found = place(at)?;
            told(share)?;
            Ok::<_, Cancelled>(found)
        });
        for (result, looked_at) in results.iter().zip(looked_at) {
            let (mut condition, unstable) = looked_at?;
            let id = result.condition.id();
            condition.left_out = left_out.iter().find(|of| of.fit.condition == id).map(|of| of.cost);
            assessment.conditions.insert(id, condition);
            assessment.unstable.extend(unstable);
        }
        assessment.left_out_fits = left_out.into_iter().map(|of| of.fit).collect();
        Ok(Some(Ok(Arc::new(assessment))))
    }

    /// Each condition of the fit without what it brings to it and to the schedule: none of fewer than three.
    fn left_out(
        &self,
        with: &Analysis,
        (without, fitted): (&Analysis, &FittedCouplings),
        (progress, shares): (&dyn Progress, &Shares<'_>),
    ) -> Result<Vec<LeftOutCondition>, Cancelled> {
        let ids: Vec<ConditionId> = fitted.problem.conditions.iter().map(|of| of.id).collect();
        if ids.len() < LEAST_CONDITIONS {
            return Ok(Vec::new());
        }
        let share = 0.6 / ids.len() as f64;
        let of_condition = |id: ConditionId| {
            let mut study = with.study.clone();
            if study.apply(&Edit::SetHeldOut { condition: id, held_out: true }).is_err() {
                return Ok(None);
            }
            let mut engine = self.fork(Box::new(Sequential)).with_proofs_within(SUBSTITUTION_PROOF);
            let analysis = engine.analyze(&study, &Untold(progress))?;
            shares.advance(share, "couplings without each condition")?;
            Ok(LeftOutCondition::of(id, &analysis, without))
        };
        let found = each(self.executor(), ids, of_condition);
        Ok(found.into_iter().collect::<Result<Vec<_>, Cancelled>>()?.into_iter().flatten().collect())
    }
}

/// A condition left out of the fit and of the schedule.
struct LeftOutCondition {
    fit: LeftOutFit,
    cost: CouplingCost,
    changes: [PairTable<Option<CostChange>>; 2],
}

impl LeftOutCondition {
    /// None where the others do not make couplings or a schedule, or it cannot be assessed.
    fn of(condition: ConditionId, held_out: &Analysis, without: &Analysis) -> Option<Self> {
        let fit = LeftOutFit { condition, fit: held_out.fitted_couplings()?.fit.clone() };
        let changes = [(without, AssessedCorrection::ScheduleOfOthers), (held_out, AssessedCorrection::Scheduled)];
        let [before, after] = changes.map(|(analysis, correction)| {
            Some(assessed(analysis, condition, choice(analysis, correction)).ok()?.changes)
        });
        let changes = [before?, after?];
        let mut sums = CostSums::new(without.study.dataset.on_axis());
        sums.add(&changes[0], &changes[1]);
        Some(Self { fit, cost: sums.corrected(), changes })
    }
}

/// The representatives under a correction.
fn choice(analysis: &Analysis, correction: AssessedCorrection) -> AssessmentChoice {
    AssessmentChoice { model: AssessedModel::Representative, correction, average: analysis.study.settings.cost_average }
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
    let (own, scheduled) = (of(AssessedCorrection::Own), of(AssessedCorrection::Scheduled));
    let mut unseen = CostSums::new(on_axis);
    left_out.iter().for_each(|LeftOutCondition { changes: [without, with], .. }| unseen.add(without, with));
    CouplingCosts {
        uncorrected: own.uncorrected(),
        own: own.corrected(),
        scheduled: scheduled.corrected(),
        left_out: (!left_out.is_empty()).then(|| unseen.corrected()),
    }
}

/// From a tenth of the band to ten times it, both ends of the band's lower part among the frequencies.
fn margin_grid(band: Band) -> FrequencyGrid {
    let [below, above] = MARGIN_POINTS;
    let mut omega = log_spaced(band.min() / ABOVE_BAND, band.min(), below);
    omega.pop();
    omega.extend(log_spaced(band.min(), ABOVE_BAND * band.max(), above));
    FrequencyGrid::at(omega)
}

/// What the couplings do to a condition, and the newly unstable poles of its kept physics models.
fn of_condition(
    study: &Study,
    result: &ConditionAnalysis,
    grid: &FrequencyGrid,
    progress: &dyn Progress,
) -> Result<(ConditionCouplings, Vec<UnstablePole>), Cancelled> {
    let (id, airspeed_kt) = (result.condition.id(), result.condition.flight_state().airspeed_kt);
    let physics = result.condition.bundle(BundleKind::Physics);
    let chosen = result.comparison.physics.model;
    let Some(coupled) = &result.coupled else { return Err(Cancelled) };
    let matrices = coupled.fitted.matrices();
    let shifts = |model: &Model| match model.state_space() {
        None => Err("the physics representative is a measured response: it has no poles".to_owned()),
        Some(of) => matrices.pole_shifts(of, airspeed_kt, Pade::default()).map_err(|error| error.to_string()),
    };
    let response = PreparedModel::of(&physics[chosen].dynamics).response(grid);
    let singular_values = matrices.least_singular_values(&response);
    let from_band = grid.omega().partition_point(|omega| *omega < study.settings.band.min());
    let above_band_db = relative_change_db(&response, &result.coupled_response(&response), grid.len() - 1);
    let (mut unstable, mut refused) = (Vec::new(), Vec::new());
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
        let newly = found.iter().flatten().filter(|shift| shift.is_newly_unstable());
        unstable.extend(newly.map(|shift| UnstablePole {
            condition: id,
            model: model.name.clone(),
            is_representative,
            pole: shift.after,
            is_in_band: (study.settings.band.min()..=study.settings.band.max()).contains(&shift.after.norm()),
        }));
        match found {
            found if is_representative => poles = found,
            Err(why) if model.state_space().is_some() => refused.push((model.name.clone(), why)),
            _ => {}
        }
    }
    let margin = LoopMargin::of(&singular_values[from_band..], &grid.omega()[from_band..]);
    let left_out = None;
    Ok((ConditionCouplings { airspeed_kt, poles, singular_values, margin, above_band_db, left_out, refused }, unstable))
}

impl ConditionCouplings {
    /// The response among the marked ones that couplings change most above the band, and by how much \[dB\].
    pub fn most_changed_above_band(&self, marked: &PairTable<bool>) -> Option<(Pair, f64)> {
        let known = marked.marked().filter_map(|pair| Some((pair, self.above_band_db[pair]?)));
        known.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}
