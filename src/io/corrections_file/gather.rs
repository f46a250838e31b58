//! From an analysis to what its corrections file says.

use crate::correction::{GainObjective, Outcome};
use crate::dataset::{BundleKind, Condition, PairTable};
use crate::fidelity::{Cost, CostAverage};
use crate::io::by_name::ByName;
use crate::schedule::{Regression, Schedule, ScheduleKind, ScheduledQuantity};
use crate::study::{Analysis, Assessed, ConditionAnalysis, ConditionFailure, Settings};

use super::channel_names::{ChannelNames, rows};
use super::explanation::Explanation;
use super::schema::{
    Assessment, Channels, ConditionAssessment, ConditionCorrections, Corrections, CostTable, CostTables, DatasetLabel,
    DelayOutcome, GainOutcome, NetGain, ScheduleUsed, ScheduledDelays, ScheduledGains, SettingsUsed,
    UnmatchedDelayEntry, UnmatchedGainEntry, WithoutResult,
};
use super::{NAME, VERSION};

impl Corrections {
    /// The results of the chosen conditions (by index), with the schedule of the whole study.
    ///
    /// `sha256` is that of the dataset's file. An index that the dataset does not have is passed over.
    pub fn of(analysis: &Analysis, sha256: &str, chosen: &[usize]) -> Self {
        let dataset = &analysis.study.dataset;
        let gather = Gather { analysis, names: ChannelNames::of(dataset) };
        let mut corrections = Corrections {
            format: NAME.to_owned(),
            version: VERSION,
            software: concat!("gdcm ", env!("CARGO_PKG_VERSION")).to_owned(),
            dataset: DatasetLabel { name: dataset.name().to_owned(), sha256: sha256.to_owned() },
            settings: gather.settings(&analysis.study.settings),
            conditions: Vec::new(),
            failed: Vec::new(),
            schedule: analysis.schedule.as_ref().ok().map(|schedule| gather.schedule(schedule)),
            assessment: Assessment { conditions: Vec::new(), left_out: Vec::new() },
        };
        for &index in chosen {
            if let (Some(condition), Some(result)) = (dataset.conditions().get(index), analysis.conditions.get(index)) {
                gather.add(&mut corrections, index, condition, result);
            }
        }
        corrections
    }
}

struct Gather<'a> {
    analysis: &'a Analysis,
    names: ChannelNames,
}

impl Gather<'_> {
    /// Adds what the analysis says of one condition.
    fn add(
        &self,
        corrections: &mut Corrections,
        index: usize,
        condition: &Condition,
        result: &Result<ConditionAnalysis, ConditionFailure>,
    ) {
        let id = condition.id();
        let without = |why: String| WithoutResult { id, why };
        match result {
            Ok(result) => corrections.conditions.push(self.condition(index, condition, result)),
            Err(failure) => corrections.failed.push(without(failure.to_string())),
        }
        match &self.analysis.assessment[index] {
            Assessed::LeftOut { why } => corrections.assessment.left_out.push(without(why.clone())),
            Assessed::Nominal(changes) => corrections.assessment.conditions.push(ConditionAssessment {
                id,
                model: condition.bundle(BundleKind::Physics)[condition.nominal()].name.clone(),
                total: rows(changes, |change| change.total()),
                magnitude: rows(changes, |change| change.magnitude()),
                phase: rows(changes, |change| change.phase()),
            }),
        }
    }

    fn settings(&self, settings: &Settings) -> SettingsUsed {
        let ignored = settings.fitted.map(|_, fitted| !fitted);
        SettingsUsed {
            band_rad_s: [settings.band.min(), settings.band.max()],
            points: settings.points,
            alpha_gain: settings.alpha_gain,
            alpha_delay: settings.alpha_delay,
            quantile: settings.quantile,
            constrained: self.names.marked(&settings.constrained),
            ignored: self.names.marked(&ignored),
            cost_average: match settings.cost_average {
                CostAverage::Median => "median",
                CostAverage::Mean => "mean",
            }
            .to_owned(),
            gain_objective: match settings.gain_objective {
                GainObjective::Ratio => "ratio",
                GainObjective::Decibel => "dB",
            }
            .to_owned(),
            gain_bounds: settings.gain_bounds.map(|bounds| [bounds.lower, bounds.upper]),
            delay_upper_s: settings.delay_upper_s,
        }
    }

    fn condition(&self, index: usize, condition: &Condition, result: &ConditionAnalysis) -> ConditionCorrections {
        let (study, names) = (&self.analysis.study, &self.names);
        let model = |kind, model: usize| condition.bundle(kind)[model].name.clone();
        let correction = &result.correction;
        ConditionCorrections {
            id: condition.id(),
            name: condition.flight_state().name.clone(),
            airspeed_kt: condition.flight_state().airspeed_kt,
            physics_representative: model(BundleKind::Physics, result.comparison.physics.model),
            identified_representative: model(BundleKind::Identified, result.comparison.identified.model),
            rejected: study.rejected_names(index).into_iter().map(str::to_owned).collect(),
            suggested_outliers: result.suggested().into_iter().map(|at| model(BundleKind::Physics, at)).collect(),
            discontinuity: discontinuity_of(condition, result),
            scheduled: study.choices[index].scheduled,
            held: names.marked(result.held()),
            delta_gain: rows(&result.comparison.delta.gain, |gain| *gain),
            delta_delay_s: rows(&result.comparison.delta.delay_s, |delay| *delay),
            gain_bounds: [result.gain_bounds().lower, result.gain_bounds().upper],
            delay_upper_s: result.delay_upper_s(),
            gains: names.channels(&correction.input_gains, &correction.output_gains),
            delays_s: names.channels(&correction.input_delays_s, &correction.output_delays_s),
            gain_solution: self.gain_outcome(result),
            delay_solution: self.delay_outcome(result),
            net_gains: self.net_gains(result),
            cost: cost_tables(result),
            cautions: result
                .cautions
                .iter()
                .map(|caution| caution.words(|pair| study.dataset.pair_name(pair)))
                .collect(),
        }
    }

    fn net_gains(&self, result: &ConditionAnalysis) -> Vec<NetGain> {
        let pairs = result.held().pairs();
        pairs
            .map(|pair| {
                let (output, input) = self.names.pair(pair);
                NetGain { output, input, gain: result.correction.net_gain(pair).value() }
            })
            .collect()
    }

    fn gain_outcome(&self, result: &ConditionAnalysis) -> GainOutcome {
        let (gains, names) = (&result.gains, &self.names);
        let unmatched = gains.unmatched.iter().map(|entry| {
            let (output, input) = names.pair(entry.pair);
            let why = entry.why.words(&names.inputs, &names.outputs);
            let (target, wanted, short_db) = (entry.target, entry.delta, entry.excess);
            UnmatchedGainEntry { output, input, target, wanted, short_db, why }
        });
        GainOutcome {
            objective: gains.objective,
            lower_bound: Some(gains.proof.lower_bound).filter(|bound| bound.is_finite()),
            proven: matches!(gains.proof.outcome, Outcome::Proven { .. }),
            gap: gains.proof.outcome.gap(),
            local_minima: gains.proof.local_minima.len(),
            matched: gains.matched,
            unmatched: unmatched.collect(),
            explanation: Explanation::of(&result.gain_problem, gains, names),
        }
    }

    fn delay_outcome(&self, result: &ConditionAnalysis) -> DelayOutcome {
        let (delays, names) = (&result.delays, &self.names);
        let top = self.analysis.study.settings.band.max();
        let unmatched = delays.unmatched.iter().map(|entry| {
            let (output, input) = names.pair(entry.pair);
            let mut why = entry.words(top, &names.inputs, &names.outputs);
            // A lone response that needs lead has said so already.
            if !entry.why.is_lone_lead() {
                why = format!("{why} {}", entry.why.words(&names.inputs, &names.outputs));
            }
            UnmatchedDelayEntry {
                output,
                input,
                target_s: entry.target,
                wanted_s: entry.delta,
                phase_left_deg: entry.phase_left_deg(top),
                why,
            }
        });
        DelayOutcome {
            objective: delays.objective,
            matched: delays.matched,
            unmatched: unmatched.collect(),
            explanation: Explanation::of(&result.delay_problem, delays, names),
        }
    }

    fn schedule(&self, schedule: &Schedule) -> ScheduleUsed {
        let names = &self.names;
        let airspeeds = &schedule.airspeeds;
        let (kind, degree) = match schedule.settings.kind {
            ScheduleKind::Polynomial { degree } => ("polynomial", Some(degree)),
            ScheduleKind::Table => ("table", None),
        };
        let of = match schedule.settings.quantity {
            ScheduledQuantity::LnGain => "ln k",
            ScheduledQuantity::Gain => "k",
        };
        let figures = |regressions: &[Regression]| regressions.iter().map(figures_of).collect::<Vec<_>>();
        let table = airspeeds.distinct_kt().into_iter().map(|airspeed_kt| {
            let Channels { inputs, outputs } = {
                let correction = schedule.at(airspeed_kt);
                names.channels(&correction.input_gains, &correction.output_gains)
            };
            ScheduledGains { airspeed_kt, inputs, outputs }
        });
        ScheduleUsed {
            kind: kind.to_owned(),
            of: of.to_owned(),
            degree,
            airspeed_mean_kt: airspeeds.mean_kt,
            airspeed_half_range_kt: airspeeds.half_range_kt,
            airspeed_range_kt: [airspeeds.min_kt, airspeeds.max_kt],
            inputs: names.by_input(figures(&schedule.inputs)),
            outputs: names.by_output(figures(&schedule.outputs)),
            delays_s: schedule.delays.as_ref().map(|(inputs, outputs)| ScheduledDelays {
                inputs: names.by_input(figures(inputs)),
                outputs: names.by_output(figures(outputs)),
            }),
            table: table.collect(),
        }
    }
}

/// Discontinuity ratios by name, in file order; none where none could be computed.
fn discontinuity_of(condition: &Condition, result: &ConditionAnalysis) -> ByName<Option<f64>> {
    let ratios = result.figures.discontinuity.as_ref().map(|found| found.ratios.clone()).unwrap_or_default();
    let names = condition.bundle(BundleKind::Physics).iter().map(|model| model.name.clone());
    ByName(names.zip(ratios).collect())
}

fn figures_of(regression: &Regression) -> Vec<f64> {
    match regression {
        Regression::Polynomial { coefficients } => coefficients.clone(),
        Regression::Table { values, .. } => values.clone(),
    }
}

fn cost_tables(result: &ConditionAnalysis) -> CostTables {
    let table = |costs: &PairTable<Option<Cost>>| CostTable {
        mag: rows(costs, |cost| cost.magnitude),
        phase: rows(costs, |cost| cost.phase),
    };
    let corrected = result.cost.map(|_, change| change.map(|change| change.corrected));
    CostTables { uncorrected: table(&result.comparison.representative.cost), corrected: table(&corrected) }
}
