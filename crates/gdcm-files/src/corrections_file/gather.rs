//! From an analysis to what its corrections file says.

use std::collections::BTreeSet;

use gdcm_core::correction::{Outcome, Quantity, kkt_residual};
use gdcm_core::dataset::{BundleKind, Condition, ConditionId, Model, PairTable, Provenance};
use gdcm_core::fidelity::Cost;
use gdcm_core::schedule::{Regression, Schedule, ScheduleKind, ScheduledQuantity};
use gdcm_core::study::{Analysis, Assessed, Caution, ConditionAnalysis, ConditionChoice, lead_cautions};

use super::explanation::Explanation;
use super::names::{ByName, ChannelNames, rows};
use super::schema::{
    Assessment, Channels, ConditionAssessment, ConditionCorrections, Corrections, CostTable, CostTables, DatasetLabel,
    DelayOutcome, GainOutcome, NetGain, ReasonEntry, ScheduleUsed, ScheduledDelays, ScheduledGains, ScheduledSecond,
    ScheduledTaus, SetAsideEntry, SourceEntry, UnmatchedDelayEntry, UnmatchedGainEntry, WithoutResult,
};
use super::uncertainty::{BarEntry, BarsEntry, UncertaintyEntry};
use super::{NAME, VERSION};

impl Corrections {
    /// The results of the chosen conditions, with the schedule of the whole study.
    ///
    /// `sha256` is that of the dataset's file.
    pub fn of(analysis: &Analysis, sha256: &str, chosen: &BTreeSet<ConditionId>) -> Self {
        let dataset = &analysis.study.dataset;
        let gather = Gather { analysis, names: ChannelNames::of(dataset) };
        let mut corrections = Corrections {
            format: NAME.to_owned(),
            version: VERSION,
            software: concat!("gdcm ", env!("CARGO_PKG_VERSION")).to_owned(),
            dataset: DatasetLabel { name: dataset.name().to_owned(), sha256: sha256.to_owned() },
            settings: analysis.study.settings.named(dataset),
            conditions: Vec::new(),
            failed: Vec::new(),
            schedule: analysis.schedule.as_ref().ok().map(|schedule| gather.schedule(schedule)),
            assessment: Assessment { conditions: Vec::new(), left_out: Vec::new() },
            uncertainty: UncertaintyEntry::of(analysis, &gather.names),
        };
        for condition in dataset.conditions().iter().filter(|condition| chosen.contains(&condition.id())) {
            gather.add(&mut corrections, condition);
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
    fn add(&self, corrections: &mut Corrections, condition: &Condition) {
        let id = condition.id();
        let without = |why: String| WithoutResult { id: id.0, why };
        match self.analysis.conditions.get(&id) {
            Some(Ok(result)) => corrections.conditions.push(self.condition(condition, result)),
            Some(Err(failure)) => corrections.failed.push(without(failure.to_string())),
            None => {}
        }
        match self.analysis.assessment.get(&id) {
            None => {}
            Some(Assessed::LeftOut { why }) => corrections.assessment.left_out.push(without(why.clone())),
            Some(Assessed::Nominal(changes)) => corrections.assessment.conditions.push(ConditionAssessment {
                id: id.0,
                model: condition.bundle(BundleKind::Physics)[condition.nominal()].name.clone(),
                total: rows(changes, |change| change.total()),
                magnitude: rows(changes, |change| change.magnitude()),
                phase: rows(changes, |change| change.phase()),
            }),
        }
    }

    fn condition(&self, condition: &Condition, result: &ConditionAnalysis) -> ConditionCorrections {
        let (study, names) = (&self.analysis.study, &self.names);
        let representative = |kind| result.representative_name(kind).to_owned();
        let correction = &result.correction;
        ConditionCorrections {
            id: condition.id().0,
            name: condition.flight_state().name.clone(),
            airspeed_kt: condition.flight_state().airspeed_kt,
            physics_representative: representative(BundleKind::Physics),
            identified_representative: representative(BundleKind::Identified),
            rejected: study.rejected_names(condition.id()).into_iter().map(str::to_owned).collect(),
            reasons: reasons_of(study.choice(condition.id())),
            suggested_outliers: result.suggested(),
            discontinuity: discontinuity_of(condition, result),
            set_aside: self.set_aside(result),
            sources: sources_of(condition),
            scheduled: study.choice(condition.id()).scheduled,
            held_out: study.choice(condition.id()).held_out,
            held: names.marked(result.held()),
            delta_gain: rows(&result.gain_problem.delta, |gain| *gain),
            delta_delay_s: rows(&result.comparison.delta.delay_s, |delay| *delay),
            band_delay_s: rows(&result.comparison.delta.band_delay_s, |delay| *delay),
            gain_bounds: [result.gain_bounds().lower, result.gain_bounds().upper],
            delay_upper_s: result.delay_upper_s(),
            gains: names.channels(&correction.input_gains, &correction.output_gains),
            delays_s: names.channels(&correction.input_delays_s, &correction.output_delays_s),
            lead: correction.leads.as_ref().map(|leads| names.leads(leads)),
            gain_solution: self.gain_outcome(result),
            delay_solution: self.delay_outcome(result),
            net_gains: self.net_gains(result),
            bars: BarsEntry::of(self.analysis, condition.id(), names),
            cost: cost_tables(result),
            cautions: result
                .cautions
                .iter()
                .map(|caution| caution.words(|pair| study.dataset.pair_name(pair)))
                .chain(lead_cautions(study, result))
                .collect(),
        }
    }

    fn set_aside(&self, result: &ConditionAnalysis) -> Vec<SetAsideEntry> {
        let entry = |caution: &Caution| match caution {
            Caution::SetAside { model, .. } => {
                let why = caution.words(|pair| self.analysis.study.dataset.pair_name(pair));
                Some(SetAsideEntry { model: model.name.clone(), why })
            }
            _ => None,
        };
        result.cautions.iter().filter_map(entry).collect()
    }

    fn net_gains(&self, result: &ConditionAnalysis) -> Vec<NetGain> {
        let pairs = result.held().pairs();
        pairs
            .map(|pair| {
                let (output, input) = self.names.pair(pair);
                let bar = BarEntry::of_net_gain(self.analysis, result.condition.id(), pair).unwrap_or_default();
                NetGain { output, input, gain: result.correction.net_gain(pair).value(), bar }
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
        let is_signed = delays.quantity == Quantity::SignedDelay;
        DelayOutcome {
            objective: delays.objective,
            kkt_residual_s: is_signed.then(|| kkt_residual(&result.delay_problem, delays)),
            matched: delays.matched,
            unmatched: unmatched.collect(),
            explanation: Explanation::of(&result.delay_problem, delays, names),
        }
    }

    fn schedule(&self, schedule: &Schedule) -> ScheduleUsed {
        let names = &self.names;
        let airspeeds = &schedule.airspeeds;
        let kind = match schedule.settings.kind {
            ScheduleKind::Polynomial { .. } => "polynomial",
            ScheduleKind::Table => "table",
        };
        let of = match schedule.settings.quantity {
            ScheduledQuantity::LnGain => "ln k",
            ScheduledQuantity::Gain => "k",
        };
        let figures = |regressions: &[Regression]| {
            regressions.iter().map(|regression| regression.figures().to_vec()).collect::<Vec<_>>()
        };
        let table = airspeeds.clusters_kt().into_iter().map(|airspeed_kt| {
            let correction = schedule.at(airspeed_kt);
            let Channels { inputs, outputs } = names.channels(&correction.input_gains, &correction.output_gains);
            let delays_s = schedule
                .delays
                .as_ref()
                .map(|_| names.channels(&correction.input_delays_s, &correction.output_delays_s));
            let lead = correction.leads.as_ref().map(|leads| names.leads(leads));
            ScheduledGains { airspeed_kt, inputs, outputs, delays_s, lead }
        });
        ScheduleUsed {
            kind: kind.to_owned(),
            of: of.to_owned(),
            degree: schedule.degree(),
            airspeed_tolerance_kt: schedule.settings.airspeed_tolerance_kt,
            airspeed_mean_kt: airspeeds.mean_kt,
            airspeed_half_range_kt: airspeeds.half_range_kt,
            airspeed_range_kt: [airspeeds.min_kt, airspeeds.max_kt],
            inputs: names.by_input(figures(&schedule.inputs)),
            outputs: names.by_output(figures(&schedule.outputs)),
            second_variable: schedule.second.as_ref().map(|term| ScheduledSecond {
                variable: term.variable.name().to_owned(),
                unit: term.variable.unit().to_owned(),
                middle: term.middle(),
                half_range: term.half_range(),
                inputs: names.by_input(term.inputs.clone()),
                outputs: names.by_output(term.outputs.clone()),
            }),
            delays_s: schedule.delays.as_ref().map(|delays| ScheduledDelays {
                inputs: names.by_input(figures(&delays.inputs)),
                outputs: names.by_output(figures(&delays.outputs)),
                upper_s: Some(delays.upper_s.figures().to_vec()),
            }),
            tau_s: schedule.leads.as_ref().map(|leads| ScheduledTaus {
                inputs: names.by_input(figures(&leads.inputs)),
                outputs: names.by_output(figures(&leads.outputs)),
                bounds_s: leads.bounds_s,
            }),
            table: table.collect(),
            cautions: schedule.cautions.iter().map(|caution| caution.words(&names.inputs, &names.outputs)).collect(),
        }
    }
}

/// Why models are rejected, the physics bundle first.
fn reasons_of(choice: &ConditionChoice) -> Vec<ReasonEntry> {
    let of_bundle = |kind: BundleKind| {
        let reasons = choice.bundle(kind).reasons.iter();
        reasons.map(move |(model, why)| ReasonEntry {
            bundle: kind.to_string(),
            model: model.clone(),
            why: why.clone(),
        })
    };
    BundleKind::BOTH.into_iter().flat_map(of_bundle).collect()
}

/// Where the models come from, as far as their dataset says.
fn sources_of(condition: &Condition) -> Vec<SourceEntry> {
    let entry = |bundle: BundleKind, model: &Model| {
        let Provenance { file, sha256, variable, made, note, records } = model.source.clone()?;
        let (bundle, model) = (bundle.to_string(), model.name.clone());
        Some(SourceEntry { bundle, model, file, sha256, variable, made, note, records })
    };
    let of_bundle = |kind| condition.bundle(kind).iter().filter_map(move |model| entry(kind, model));
    BundleKind::BOTH.into_iter().flat_map(of_bundle).collect()
}

/// Discontinuity ratios by name, in file order; none where none could be computed.
fn discontinuity_of(condition: &Condition, result: &ConditionAnalysis) -> ByName<Option<f64>> {
    let ratios = result.figures.discontinuity.as_ref().map(|found| found.ratios.clone()).unwrap_or_default();
    let names = condition.bundle(BundleKind::Physics).iter().map(|model| model.name.clone());
    ByName(names.zip(ratios).collect())
}

fn cost_tables(result: &ConditionAnalysis) -> CostTables {
    let table = |costs: &PairTable<Option<Cost>>| CostTable {
        mag: rows(costs, |cost| cost.magnitude),
        phase: rows(costs, |cost| cost.phase),
    };
    let corrected = result.cost.map(|_, change| change.map(|change| change.corrected));
    CostTables { uncorrected: table(&result.comparison.representative.cost), corrected: table(&corrected) }
}
