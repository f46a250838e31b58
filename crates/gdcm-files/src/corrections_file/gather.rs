//! From an analysis to what its corrections file says.

use std::collections::BTreeSet;

use gdcm_core::correction::{
    ActiveConstraint, Channel, ChannelLeads, Conflict, ConflictKind, Outcome, Problem, Quantity, Sensitivity, Solution,
    kkt_residual, sensitivities,
};
use gdcm_core::dataset::{self, BundleKind, Condition, ConditionId, Dataset, Model, Pair, PairTable, Provenance};
use gdcm_core::fidelity::Cost;
use gdcm_core::response::LeadFilter;
use gdcm_core::schedule::{Regression, Schedule, ScheduleKind, ScheduledQuantity};
use gdcm_core::study::{
    AirspeedDifference, Analysis, Assessed, Caution, ConditionAnalysis, ConditionChoice, ConditionUncertainty,
    PairScatter, SecondVariableTest, Uncertainty, lead_cautions,
};
use gdcm_core::uncertainty::{Bar, Scalar, VarianceDecomposition};

use super::schema::*;
use super::{ByName, NAME, VERSION};

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
            signs: analysis.study.turned_channels(),
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
        let doubts = result.doubts.iter().map(|doubt| doubt.words(&study.dataset));
        let cautions = result.cautions.iter().map(|caution| caution.words(|pair| study.dataset.pair_name(pair)));
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
            cautions: doubts.chain(cautions).chain(lead_cautions(study, result)).collect(),
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
                NetGain { output, input, gain: result.correction.net_gain(pair), bar }
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
            inputs: by_name(&names.inputs, figures(&schedule.gains.inputs)),
            outputs: by_name(&names.outputs, figures(&schedule.gains.outputs)),
            second_variable: schedule.second.as_ref().map(|term| ScheduledSecond {
                variable: term.variable.name().to_owned(),
                unit: term.variable.unit().to_owned(),
                middle: term.middle(),
                half_range: term.half_range(),
                inputs: by_name(&names.inputs, term.slopes.inputs.clone()),
                outputs: by_name(&names.outputs, term.slopes.outputs.clone()),
            }),
            delays_s: schedule.delays.as_ref().map(|delays| ScheduledDelays {
                inputs: by_name(&names.inputs, figures(&delays.taus_s.inputs)),
                outputs: by_name(&names.outputs, figures(&delays.taus_s.outputs)),
                upper_s: Some(delays.upper_s.figures().to_vec()),
            }),
            tau_s: schedule.leads.as_ref().map(|leads| ScheduledTaus {
                inputs: by_name(&names.inputs, figures(&leads.taus_s.inputs)),
                outputs: by_name(&names.outputs, figures(&leads.taus_s.outputs)),
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

/// The names of a dataset's channels.
struct ChannelNames {
    inputs: Vec<String>,
    outputs: Vec<String>,
}

impl ChannelNames {
    fn of(dataset: &Dataset) -> Self {
        let names = |channels: &[dataset::Channel]| channels.iter().map(|channel| channel.name.clone()).collect();
        Self { inputs: names(dataset.inputs()), outputs: names(dataset.outputs()) }
    }

    /// The names of a pair, output first.
    fn pair(&self, pair: Pair) -> (String, String) {
        (self.outputs[pair.output].clone(), self.inputs[pair.input].clone())
    }

    /// The name of a channel of the correction.
    fn channel(&self, channel: Channel) -> String {
        channel.name(&self.inputs, &self.outputs)
    }

    /// The names of the marked pairs.
    fn marked(&self, table: &PairTable<bool>) -> Vec<(String, String)> {
        table.marked().map(|pair| self.pair(pair)).collect()
    }

    /// A value for each channel.
    fn by_channel<T>(&self, inputs: impl IntoIterator<Item = T>, outputs: impl IntoIterator<Item = T>) -> Channels<T> {
        Channels { inputs: by_name(&self.inputs, inputs), outputs: by_name(&self.outputs, outputs) }
    }

    /// A number for each channel.
    fn channels(&self, inputs: &[f64], outputs: &[f64]) -> Channels {
        self.by_channel(inputs.iter().copied(), outputs.iter().copied())
    }

    /// The signed delay and the filter of each channel.
    fn leads(&self, leads: &ChannelLeads) -> Channels<LeadEntry> {
        let entry = |(&tau_s, filter): (&f64, &Option<LeadFilter>)| LeadEntry {
            tau_s,
            lead_s: filter.map(LeadFilter::lead_s),
            zero_rad_s: filter.map(LeadFilter::zero_rad_s),
            lag_rad_s: filter.map(LeadFilter::lag_rad_s),
            gain_at_infinity_db: filter.map(LeadFilter::gain_at_infinity_db),
        };
        let filters = leads.filters();
        self.by_channel(
            leads.taus_s.inputs.iter().zip(&filters.inputs).map(entry),
            leads.taus_s.outputs.iter().zip(&filters.outputs).map(entry),
        )
    }
}

fn by_name<T>(names: &[String], values: impl IntoIterator<Item = T>) -> ByName<T> {
    ByName(names.iter().cloned().zip(values).collect())
}

/// A table as rows of outputs; what is not finite is left empty, for JSON has no such numbers.
fn rows<T>(table: &PairTable<Option<T>>, figure: impl Fn(&T) -> f64) -> Table {
    let entry = |output, input| {
        let entry = table[Pair { output, input }].as_ref().map(&figure);
        entry.filter(|value| value.is_finite())
    };
    (0..table.outputs()).map(|output| (0..table.inputs()).map(|input| entry(output, input)).collect()).collect()
}

impl Explanation {
    /// The explanation of the gains or of the delays.
    fn of(problem: &Problem, solution: &Solution, names: &ChannelNames) -> Self {
        let sensitivities = sensitivities(problem, solution);
        Self {
            conflicts: solution.conflicts.iter().map(|conflict| ConflictEntry::of(conflict, names)).collect(),
            agreeing: solution.agreeing.iter().map(|agreement| ConflictEntry::of_agreement(agreement, names)).collect(),
            remedy: solution.remedy.as_ref().map(|remedy| RemedyEntry {
                upper: remedy.upper,
                lower: remedy.lower,
                free: remedy.free.iter().map(|&pair| names.pair(pair)).collect(),
            }),
            sensitivities: sensitivities.iter().map(|sensitivity| SensitivityEntry::of(sensitivity, names)).collect(),
        }
    }
}

impl ConflictEntry {
    fn of(conflict: &Conflict, names: &ChannelNames) -> Self {
        let (kind, figure, upper, lower) = match conflict.kind {
            ConflictKind::AboveUpper { asked, upper, .. } => ("upper_bound", Some(asked), Some(upper), None),
            ConflictKind::BelowLower { asked, lower: None, .. } => ("lead", Some(-asked), None, None),
            ConflictKind::BelowLower { asked, lower, .. } => ("lower_bound", Some(asked), None, lower),
            ConflictKind::TooFarApart { asked, upper, lower, .. } => ("both_bounds", Some(asked), Some(upper), lower),
            ConflictKind::Loop { mismatch } => ("loop", Some(mismatch), None, None),
            ConflictKind::Unclear => ("unclear", None, None, None),
        };
        Self {
            kind: kind.to_owned(),
            entries: conflict.entries.iter().map(|&pair| names.pair(pair)).collect(),
            channels: conflict.channels().into_iter().map(|channel| names.channel(channel)).collect(),
            figure,
            upper,
            lower,
            words: conflict.words(&names.inputs, &names.outputs),
        }
    }

    fn of_agreement(agreement: &Conflict, names: &ChannelNames) -> Self {
        Self { words: agreement.agreement_words(&names.inputs, &names.outputs), ..Self::of(agreement, names) }
    }
}

impl SensitivityEntry {
    fn of(sensitivity: &Sensitivity, names: &ChannelNames) -> Self {
        let (restraint, entry, channel) = match sensitivity.restraint {
            ActiveConstraint::Held(pair) => ("held", Some(names.pair(pair)), None),
            ActiveConstraint::LowerBound(channel) => ("lower_bound", None, Some(names.channel(channel))),
            ActiveConstraint::UpperBound(channel) => ("upper_bound", None, Some(names.channel(channel))),
        };
        Self {
            restraint: restraint.to_owned(),
            entry,
            channel,
            per_unit: sensitivity.per_unit,
            share_per_unit: sensitivity.share_per_unit,
        }
    }
}

impl BarEntry {
    fn of(scalar: Scalar, bar: &Bar, level: f64) -> Self {
        let told = |interval: Option<[f64; 2]>| {
            interval.map(|ends| ends.map(|end| if scalar.is_delay() { end } else { end.exp() }))
        };
        Self {
            interval: told(bar.interval(level)),
            interval_identification: told(bar.inner_interval(level)),
            u_physics: bar.trim.map(|part| part.variance.sqrt()),
            u_identification: bar.identification.map(|part| part.variance.sqrt()),
            degrees_of_freedom: bar.degrees_of_freedom().filter(|degrees| degrees.is_finite()),
            left_in_band: None,
            remarks: bar.remarks().into_iter().map(str::to_owned).collect(),
        }
    }

    /// The bar of a net gain, with what one gain leaves over in the band.
    fn of_net_gain(analysis: &Analysis, condition: ConditionId, pair: Pair) -> Option<Self> {
        let uncertainty = analysis.uncertainty.as_ref()?;
        let bar = uncertainty.bar(condition, Scalar::NetGain(pair))?;
        let left_in_band = uncertainty.conditions.get(&condition)?.left_in_band[pair];
        Some(Self { left_in_band, ..Self::of(Scalar::NetGain(pair), bar, uncertainty.level) })
    }
}

impl BarsEntry {
    /// The bars of a condition's other figures.
    fn of(analysis: &Analysis, condition: ConditionId, names: &ChannelNames) -> Option<Self> {
        let uncertainty = analysis.uncertainty.as_ref()?;
        let of: &ConditionUncertainty = uncertainty.conditions.get(&condition)?;
        let entry = |scalar| of.bars[scalar].as_ref().map(|bar| BarEntry::of(scalar, bar, uncertainty.level));
        let table = |scalar: fn(Pair) -> Scalar| -> Vec<Vec<Option<BarEntry>>> {
            let (outputs, inputs) = (names.outputs.len(), names.inputs.len());
            let row = |output| (0..inputs).map(|input| entry(scalar(Pair::new(output, input)))).collect();
            (0..outputs).map(row).collect()
        };
        let channels = |scalar: fn(Channel) -> Scalar| {
            let inputs = (0..names.inputs.len()).map(|input| entry(scalar(Channel::Input(input))));
            let outputs = (0..names.outputs.len()).map(|output| entry(scalar(Channel::Output(output))));
            names.by_channel(inputs.collect::<Vec<_>>(), outputs.collect::<Vec<_>>())
        };
        let asks_band_delays = analysis.condition(condition)?.asks_band_delays();
        Some(Self {
            delta_gain: table(Scalar::Gain),
            delta_delay_s: table(Scalar::Delay),
            band_delay_s: if asks_band_delays { table(Scalar::BandDelay) } else { Vec::new() },
            gains: channels(Scalar::ChannelGain),
            delays_s: channels(Scalar::ChannelDelay),
        })
    }
}

impl SplitEntry {
    fn of(split: &VarianceDecomposition, level: f64) -> Self {
        Self {
            degrees_of_freedom: split.freedom,
            scatter: split.scatter.sqrt(),
            physics: split.trim.sqrt(),
            identification: split.identification.sqrt(),
            rest: split.unexplained().sqrt(),
            rest_interval: split.unexplained_interval(level),
            shares: split.shares(),
            ratio: split.ratio(),
            p: split.p(),
        }
    }
}

impl UncertaintyEntry {
    /// What follows from the bars of an analysis, where they are there.
    fn of(analysis: &Analysis, names: &ChannelNames) -> Option<Self> {
        let uncertainty = analysis.uncertainty.as_ref()?;
        Some(Self {
            level: uncertainty.level,
            differences: differences(uncertainty, names),
            scatter: scatter(uncertainty, names),
            schedule_band: bands(analysis, uncertainty, names),
            second_variable: second_variables(uncertainty, names),
        })
    }
}

fn differences(uncertainty: &Uncertainty, names: &ChannelNames) -> Vec<DifferenceEntry> {
    let entry = |of: &AirspeedDifference| {
        let (output, input) = names.pair(of.pair);
        DifferenceEntry {
            output,
            input,
            conditions: of.conditions.map(|id| id.0),
            airspeed_kt: of.airspeed_kt,
            delta: of.difference.delta,
            u: of.difference.deviation,
            degrees_of_freedom: of.difference.degrees_of_freedom.filter(|degrees| degrees.is_finite()),
            ratio: of.difference.ratio(),
            p: of.difference.p(),
            p_holm: of.p_holm,
            words: of.words(uncertainty.level),
        }
    };
    uncertainty.differences.iter().map(entry).collect()
}

fn scatter(uncertainty: &Uncertainty, names: &ChannelNames) -> Vec<ScatterEntry> {
    let entry = |of: &PairScatter| {
        let (output, input) = names.pair(of.pair);
        let split = |split: &Option<VarianceDecomposition>| {
            split.as_ref().map(|split| SplitEntry::of(split, uncertainty.level))
        };
        ScatterEntry {
            output,
            input,
            same_airspeed: split(&of.same_airspeed),
            about_schedule: split(&of.about_schedule),
        }
    };
    uncertainty.scatter.iter().map(entry).collect()
}

fn bands(analysis: &Analysis, uncertainty: &Uncertainty, names: &ChannelNames) -> Vec<ScheduleBandEntry> {
    let (Ok(schedule), Some(bands)) = (&analysis.schedule, &uncertainty.bands) else { return Vec::new() };
    let airspeed_kt = schedule.airspeeds.clusters_kt();
    let pairs: PairTable<bool> = analysis.study.dataset.measuring_pairs();
    let entry = |pair: Pair| {
        let (output, input) = names.pair(pair);
        let widths = airspeed_kt.iter().map(|&airspeed| bands.at(schedule, Scalar::NetGain(pair), airspeed));
        let widths: Vec<_> = widths.collect::<Option<_>>()?;
        Some(ScheduleBandEntry {
            output,
            input,
            fit: airspeed_kt.iter().map(|&airspeed| schedule.at(airspeed).net_gain(pair).ln()).collect(),
            confidence: widths.iter().map(|widths| widths.confidence).collect(),
            scatter: widths.iter().map(|widths| widths.scatter).collect(),
            airspeed_kt: airspeed_kt.clone(),
        })
    };
    pairs.marked().filter_map(entry).collect()
}

fn second_variables(uncertainty: &Uncertainty, names: &ChannelNames) -> Vec<SecondVariableEntry> {
    let entry = |of: &SecondVariableTest| {
        let (output, input) = names.pair(of.pair);
        let effect = of.effect.as_ref().ok();
        SecondVariableEntry {
            output,
            input,
            variable: of.variable.name().to_owned(),
            effect: effect.map(|effect| effect.effect),
            visible: effect.map(|effect| effect.visible),
            p: effect.map(|effect| effect.p),
            p_holm: of.p_holm,
            left_out_without: effect.and_then(|effect| effect.left_out_without),
            left_out_with: effect.and_then(|effect| effect.left_out_with),
            needed: of.needed,
            words: of.to_string(),
        }
    };
    uncertainty.second_variables.iter().map(entry).collect()
}
