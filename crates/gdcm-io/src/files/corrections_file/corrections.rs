//! The text of `corrections.json`: all results of an analysis, key by key.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

use gdcm_method::correction::conflict::{Conflict, ConflictKind};
use gdcm_method::correction::sensitivity::{
    ActiveConstraint, Sensitivity, kkt_residual, sensitivities,
};
use gdcm_method::correction::{
    Channel, ChannelCorrection, Channels, LeadPrice, Outcome, Problem, Quantity, Solution,
};
use gdcm_method::fidelity::Cost;
use gdcm_method::schedule::{
    Regression, Schedule, ScheduleCaution, ScheduleKind, ScheduledQuantity,
};
use gdcm_model::dataset::model::Provenance;
use gdcm_model::dataset::{self, BundleKind, Condition, ConditionId, Model, Pair, PairTable};
use gdcm_study::results::caution::Caution;
use gdcm_study::results::couplings_assessment::{AxisCost, CouplingCost, CouplingsAssessment};
use gdcm_study::{Analysis, ConditionAnalysis};
use gdcm_words::assessment::not_assessed_text;
use gdcm_words::caution::{caution_text, failure_text};
use gdcm_words::convention_doubt::doubt_text;
use gdcm_words::couplings::analysis_coupling_remarks;
use gdcm_words::leads::lead_cautions;

use super::uncertainty::{bars, net_gain_bar, uncertainty};
use super::{NAME, VERSION};
use crate::files::export_contents::ExportContents;

/// Returns all results of the chosen conditions, with the schedule of the whole study, as
/// `corrections.json` contains them. The documentation of file formats describes each key.
///
/// `sha256` is the hash of the dataset's file.
pub fn corrections(analysis: &Analysis, sha256: &str, chosen: &BTreeSet<ConditionId>) -> Value {
    let dataset = &analysis.study.dataset;
    let names = ChannelNames::of(analysis);
    let is_chosen = |condition: &&std::sync::Arc<Condition>| chosen.contains(&condition.id());
    let without = |id: ConditionId, why: &str| json!({"id": id.0, "why": why});
    let mut conditions = Vec::new();
    let mut failed = Vec::new();
    let mut assessed = Vec::new();
    let mut left_out = Vec::new();
    for condition in dataset.conditions().iter().filter(is_chosen) {
        let id = condition.id();
        match analysis.conditions.get(&id) {
            Some(Ok(result)) => conditions.push(names.condition(condition, result)),
            Some(Err(failure)) => {
                let why = failure_text(failure, dataset);
                failed.push(json!({"id": id.0, "code": failure.code(), "why": why}));
            }
            None => {}
        }
        match analysis.assessment.get(&id) {
            None => {}
            Some(Err(why)) => left_out.push(without(id, &not_assessed_text(why, dataset))),
            Some(Ok(changes)) => assessed.push(json!({
                "id": id.0,
                "model": condition.bundle(BundleKind::Physics)[condition.nominal()].name,
                "dJ": rows(changes, |change| change.total()),
                "dJ_mag": rows(changes, |change| change.magnitude()),
                "dJ_phase": rows(changes, |change| change.phase()),
            })),
        }
    }
    let mut settings = analysis.study.settings.named(dataset);
    // Readers of older programs look here for whether the schedule below has delays.
    settings.schedule.delays = analysis
        .schedule
        .as_ref()
        .is_ok_and(|schedule| schedule.delays.is_some());
    let corrections = json!({
        "format": NAME,
        "version": VERSION,
        "software": concat!("gdcm ", env!("CARGO_PKG_VERSION")),
        "dataset": {"name": dataset.name(), "sha256": sha256},
        "inputs": channels(dataset.inputs()),
        "outputs": channels(dataset.outputs()),
        "settings": settings,
        "signs": analysis.study.turned_channels(),
        "contains": ExportContents::of_results(analysis).json(dataset),
        "couplings": couplings(analysis),
        "conditions": conditions,
        "failed": failed,
        "schedule": analysis.schedule.as_ref().ok().map(|schedule| names.schedule(schedule)),
        "assessment": {"conditions": assessed, "left_out": left_out},
        "uncertainty": uncertainty(&names),
    });
    without_empty(corrections, &["signs", "couplings", "uncertainty"])
}

/// Returns names and units of channels, in the order of all lists and tables.
fn channels(channels: &[dataset::Channel]) -> Value {
    channels
        .iter()
        .map(|channel| json!({"name": channel.name, "unit": channel.unit}))
        .collect()
}

/// Returns whether a member is empty: null, false, or an empty list.
pub(super) fn says_nothing(value: &Value) -> bool {
    matches!(value, Value::Null | Value::Bool(false))
        || value.as_array().is_some_and(|list| list.is_empty())
}

/// Returns an object without those of the named members that are empty.
pub(crate) fn without_empty(mut object: Value, members: &[&str]) -> Value {
    if let Value::Object(all) = &mut object {
        all.retain(|name, value| !(members.contains(&name.as_str()) && says_nothing(value)));
    }
    object
}

/// Returns a table as rows of outputs; values that are not finite become null, since JSON has no
/// such numbers.
fn rows<T>(table: &PairTable<Option<T>>, figure: impl Fn(&T) -> f64) -> Value {
    rows_of(table.outputs(), table.inputs(), |pair| {
        table[pair].as_ref().map(&figure).into()
    })
}

/// Returns a table as rows of outputs.
pub(super) fn rows_of(outputs: usize, inputs: usize, entry: impl Fn(Pair) -> Value) -> Value {
    let row = |output| {
        (0..inputs)
            .map(|input| entry(Pair { output, input }))
            .collect::<Value>()
    };
    (0..outputs).map(row).collect()
}

/// An analysis with the channel names of its dataset.
pub(super) struct ChannelNames<'a> {
    pub(super) analysis: &'a Analysis,
    pub(super) inputs: Vec<String>,
    pub(super) outputs: Vec<String>,
}

impl<'a> ChannelNames<'a> {
    fn of(analysis: &'a Analysis) -> Self {
        let (inputs, outputs) = analysis.study.dataset.names_of_channels();
        Self {
            analysis,
            inputs,
            outputs,
        }
    }

    /// Returns the names of a response, output first.
    fn pair(&self, pair: Pair) -> (String, String) {
        self.analysis.study.dataset.channel_names(pair)
    }

    fn pairs(&self, pairs: impl IntoIterator<Item = Pair>) -> Vec<(String, String)> {
        pairs.into_iter().map(|pair| self.pair(pair)).collect()
    }

    /// Returns the entries of a response, preceded by the names of its output and its input.
    pub(super) fn of_pair(&self, pair: Pair, entries: Value) -> Value {
        let (output, input) = self.pair(pair);
        let mut members = Map::from_iter([
            ("output".to_owned(), output.into()),
            ("input".to_owned(), input.into()),
        ]);
        if let Value::Object(entries) = entries {
            members.extend(entries);
        }
        Value::Object(members)
    }

    /// Returns a value for each channel, by its name.
    pub(super) fn by_channel<T: Into<Value>>(&self, value: impl Fn(Channel) -> T) -> Value {
        let named = |names: &[String], channel: fn(usize) -> Channel| -> Value {
            names
                .iter()
                .enumerate()
                .map(|(at, name)| (name.clone(), value(channel(at)).into()))
                .collect()
        };
        json!({"inputs": named(&self.inputs, Channel::Input), "outputs": named(&self.outputs, Channel::Output)})
    }

    /// Returns the coefficients of the regression of each channel.
    fn figures(&self, of: &Channels<Regression>) -> Value {
        self.by_channel(|channel| of[channel].figures().to_vec())
    }

    fn gains(&self, correction: &ChannelCorrection) -> Value {
        self.by_channel(|channel| correction.gain(channel))
    }

    fn delays_s(&self, correction: &ChannelCorrection) -> Value {
        self.by_channel(|channel| correction.pure_delay_s(channel))
    }

    /// Returns the signed delay and the lead filter of each channel (M15), if any.
    fn leads(&self, correction: &ChannelCorrection) -> Option<Value> {
        let leads = correction.leads.as_ref()?;
        let price = LeadPrice::of(leads);
        Some(self.by_channel(|channel| {
            let filter = leads.filters()[channel];
            json!({
                "tau_s": leads.taus_s[channel],
                "lead_s": filter.map(|filter| filter.lead_s()),
                "zero_rad_s": filter.map(|filter| filter.zero_rad_s()),
                "lag_rad_s": filter.map(|filter| filter.lag_rad_s()),
                "gain_at_infinity_db": filter.map(|filter| filter.gain_at_infinity_db()),
                "gain_above_band_db": price.as_ref().map(|price| price.gains_db[channel]),
                "not_valid_above_rad_s": price.as_ref().map(|price| price.limit_rad_s),
            })
        }))
    }

    fn condition(&self, condition: &Condition, result: &ConditionAnalysis) -> Value {
        let study = &self.analysis.study;
        let choice = study.choice(condition.id());
        let correction = &result.correction;
        let words = |caution: &Caution| caution_text(caution, |pair| study.dataset.pair_name(pair));
        let set_aside = result.cautions.iter().filter_map(|caution| match caution {
            Caution::SetAside { model, .. } => {
                Some(json!({"model": model.name, "why": words(caution)}))
            }
            _ => None,
        });
        let reasons = BundleKind::BOTH.into_iter().flat_map(|kind| {
            let reasons = choice.bundle(kind).reasons.iter();
            reasons.map(
                move |(model, why)| json!({"bundle": kind.to_string(), "model": model, "why": why}),
            )
        });
        let doubts = result
            .doubts
            .iter()
            .map(|doubt| doubt_text(doubt, &study.dataset));
        let cautions = doubts
            .chain(result.cautions.iter().map(words))
            .chain(lead_cautions(study, result));
        let corrected = result
            .cost
            .map(|_, change| change.map(|change| change.corrected));
        let costs = |table: &PairTable<Option<Cost>>| json!({"mag": rows(table, |cost| cost.magnitude), "phase": rows(table, |cost| cost.phase)});
        let found = json!({
            "id": condition.id().0,
            "name": condition.flight_state().name,
            "airspeed_kt": condition.flight_state().airspeed_kt,
            "physics_representative": result.representative_name(BundleKind::Physics),
            "identified_representative": result.representative_name(BundleKind::Identified),
            "rejected": study.rejected_names(condition.id()),
            "reasons": reasons.collect::<Value>(),
            "suggested_outliers": result.suggested(),
            "discontinuity": discontinuity(condition, result),
            "set_aside": set_aside.collect::<Value>(),
            "sources": sources(condition),
            "scheduled": choice.scheduled,
            "held_out": choice.held_out,
            "held": self.pairs(result.held().marked()),
            "G": rows(&result.gain_problem.delta, |gain| *gain),
            "D_s": rows(&result.comparison.delta.delay_s, |delay| *delay),
            "D_band_s": rows(&result.comparison.delta.band_delay_s, |delay| *delay),
            "gain_bounds": [result.gain_bounds().lower, result.gain_bounds().upper],
            "delay_upper_s": result.delay_upper_s(),
            "gains": self.gains(correction),
            "delays_s": self.delays_s(correction),
            "lead": self.leads(correction),
            "gain_solution": self.gain_solution(result),
            "delay_solution": self.delay_solution(result),
            "net_gains": result.held().pairs().map(|pair| {
                let mut entries = json!({"gain": correction.net_gain(pair)});
                let bar = net_gain_bar(self.analysis, condition.id(), pair);
                if let (Value::Object(entries), Some(Value::Object(bar))) = (&mut entries, bar) {
                    entries.extend(bar);
                }
                self.of_pair(pair, entries)
            }).collect::<Value>(),
            "bars": bars(self, condition.id()),
            "couplings": condition_couplings(self.analysis, result),
            "J": {"uncorrected": costs(&result.comparison.representative.cost), "corrected": costs(&corrected)},
            "cautions": cautions.collect::<Value>(),
        });
        without_empty(
            found,
            &[
                "reasons",
                "sources",
                "held_out",
                "lead",
                "bars",
                "couplings",
            ],
        )
    }

    fn gain_solution(&self, result: &ConditionAnalysis) -> Value {
        let gains = &result.gains;
        let unmatched = gains.unmatched.iter().map(|entry| {
            let why = entry.why.words(&self.inputs, &self.outputs);
            let figures = json!({"target": entry.target, "wanted": entry.delta, "short_db": entry.excess, "why": why});
            self.of_pair(entry.pair, figures)
        });
        json!({
            "objective": gains.objective,
            "lower_bound": gains.proof.lower_bound,
            "proven": matches!(gains.proof.outcome, Outcome::Proven { .. }),
            "gap": gains.proof.outcome.gap(),
            "local_minima": gains.proof.local_minima.len(),
            "matched": gains.matched,
            "unmatched": unmatched.collect::<Value>(),
            "explanation": self.explanation(&result.gain_problem, gains),
        })
    }

    fn delay_solution(&self, result: &ConditionAnalysis) -> Value {
        let delays = &result.delays;
        let top = self.analysis.study.settings.band.max();
        let unmatched = delays.unmatched.iter().map(|entry| {
            let mut why = entry.words(top, &self.inputs, &self.outputs);
            // A single response that needs lead has already been reported.
            if !entry.why.is_lone_lead() {
                why = format!("{why} {}", entry.why.words(&self.inputs, &self.outputs));
            }
            let phase_left_deg = entry.phase_left_deg(top);
            let target_s = entry.target;
            let wanted_s = entry.delta;
            let figures = json!({
                "target_s": target_s, "wanted_s": wanted_s, "phase_left_deg": phase_left_deg, "why": why,
            });
            self.of_pair(entry.pair, figures)
        });
        let is_signed = delays.quantity == Quantity::SignedDelay;
        let solution = json!({
            "objective": delays.objective,
            "kkt_residual_s": is_signed.then(|| kkt_residual(&result.delay_problem, delays)),
            "matched": delays.matched,
            "unmatched": unmatched.collect::<Value>(),
            "explanation": self.explanation(&result.delay_problem, delays),
        });
        without_empty(solution, &["kkt_residual_s"])
    }

    /// Explains why the gains, or the delays, are not matched, what would help, and the cost of the
    /// constraints.
    fn explanation(&self, problem: &Problem, solution: &Solution) -> Value {
        let conflict = |of: &Conflict| self.conflict(of, of.words(&self.inputs, &self.outputs));
        let agreement =
            |of: &Conflict| self.conflict(of, of.agreement_words(&self.inputs, &self.outputs));
        let remedy = solution.remedy.as_ref().map(|remedy| {
            let free = self.pairs(remedy.free.iter().copied());
            json!({"upper": remedy.upper, "lower": remedy.lower, "free": free})
        });
        let sensitivities = sensitivities(problem, solution);
        let explanation = json!({
            "conflicts": solution.conflicts.iter().map(conflict).collect::<Value>(),
            "agreeing": solution.agreeing.iter().map(agreement).collect::<Value>(),
            "remedy": remedy,
            "sensitivities": sensitivities.iter().map(|of| self.sensitivity(of)).collect::<Value>(),
        });
        without_empty(explanation, &["agreeing"])
    }

    fn conflict(&self, conflict: &Conflict, words: String) -> Value {
        let (kind, figure, upper, lower) = match conflict.kind {
            ConflictKind::AboveUpper { asked, upper, .. } => {
                ("upper_bound", Some(asked), Some(upper), None)
            }
            ConflictKind::BelowLower {
                asked, lower: None, ..
            } => ("lead", Some(-asked), None, None),
            ConflictKind::BelowLower { asked, lower, .. } => {
                ("lower_bound", Some(asked), None, lower)
            }
            ConflictKind::TooFarApart {
                asked,
                upper,
                lower,
                ..
            } => ("both_bounds", Some(asked), Some(upper), lower),
            ConflictKind::Loop { mismatch } => ("loop", Some(mismatch), None, None),
            ConflictKind::Unclear => ("unclear", None, None, None),
        };
        let channels = conflict
            .channels()
            .into_iter()
            .map(|channel| channel.name(&self.inputs, &self.outputs));
        json!({
            "kind": kind,
            "entries": self.pairs(conflict.entries.iter().copied()),
            "channels": channels.collect::<Value>(),
            "figure": figure,
            "upper": upper,
            "lower": lower,
            "words": words,
        })
    }

    fn sensitivity(&self, sensitivity: &Sensitivity) -> Value {
        let (restraint, entry, channel) = match sensitivity.restraint {
            ActiveConstraint::Held(pair) => ("held", Some(self.pair(pair)), None),
            ActiveConstraint::LowerBound(channel) => ("lower_bound", None, Some(channel)),
            ActiveConstraint::UpperBound(channel) => ("upper_bound", None, Some(channel)),
        };
        json!({
            "restraint": restraint,
            "entry": entry,
            "channel": channel.map(|channel| channel.name(&self.inputs, &self.outputs)),
            "per_unit": sensitivity.per_unit,
            "share_per_unit": sensitivity.share_per_unit,
        })
    }

    /// Returns the gains as functions of airspeed.
    fn schedule(&self, schedule: &Schedule) -> Value {
        let airspeeds = &schedule.airspeeds;
        let figures = self.figures(&schedule.gains);
        let table = airspeeds.clusters_kt().into_iter().map(|airspeed_kt| {
            let correction = schedule.at(airspeed_kt);
            let gains = self.gains(&correction);
            let row = json!({
                "airspeed_kt": airspeed_kt,
                "inputs": gains["inputs"],
                "outputs": gains["outputs"],
                "delays_s": schedule.delays.is_some().then(|| self.delays_s(&correction)),
                "lead": self.leads(&correction),
            });
            without_empty(row, &["delays_s", "lead"])
        });
        let used = json!({
            "kind": match schedule.settings.kind {
                ScheduleKind::Polynomial { .. } => "polynomial",
                ScheduleKind::Table => "table",
            },
            "of": match schedule.settings.quantity {
                ScheduledQuantity::LnGain => "ln k",
                ScheduledQuantity::Gain => "k",
            },
            "degree": schedule.degree(),
            "airspeed_tolerance_kt": schedule.settings.airspeed_tolerance_kt,
            "airspeed_mean_kt": airspeeds.mean_kt,
            "airspeed_half_range_kt": airspeeds.half_range_kt,
            "airspeed_range_kt": [airspeeds.min_kt, airspeeds.max_kt],
            "inputs": figures["inputs"],
            "outputs": figures["outputs"],
            "second_variable": schedule.second.as_ref().map(|term| {
                let slopes = self.by_channel(|channel| term.slopes[channel]);
                json!({
                    "variable": term.variable.name(),
                    "unit": term.variable.unit(),
                    "middle": term.middle(),
                    "half_range": term.half_range(),
                    "inputs": slopes["inputs"],
                    "outputs": slopes["outputs"],
                })
            }),
            "delays_s": schedule.delays.as_ref().map(|delays| {
                let mut figures = self.figures(&delays.taus_s);
                figures["upper_s"] = delays.upper_s.figures().into();
                figures
            }),
            "tau_s": schedule.leads.as_ref().map(|leads| {
                let mut figures = self.figures(&leads.taus_s);
                figures["bounds_s"] = json!(leads.bounds_s);
                figures
            }),
            "table": table.collect::<Value>(),
            "cautions": schedule.cautions.iter().map(|of| of.words(&self.inputs, &self.outputs)).collect::<Value>(),
            "caution_notes": schedule.cautions.iter().map(|of| self.schedule_caution(of)).collect::<Value>(),
        });
        without_empty(used, &["second_variable", "tau_s", "caution_notes"])
    }

    /// Returns a caution about the schedule by its code, with its numbers if it concerns a single
    /// condition.
    fn schedule_caution(&self, caution: &ScheduleCaution) -> Value {
        let text = caution.words(&self.inputs, &self.outputs);
        match caution {
            ScheduleCaution::CostsMore(cost) => json!({
                "code": caution.code(),
                "condition": cost.condition.0,
                "model": cost.model,
                "value": cost.scheduled,
                "own": cost.own,
                "unit": "J",
                "text": text,
            }),
            ScheduleCaution::SignedDelayApart {
                channel,
                condition,
                tau_s,
                elsewhere_s,
            } => json!({
                "code": caution.code(),
                "condition": condition.0,
                "channel": channel.name(&self.inputs, &self.outputs),
                "value": tau_s,
                "elsewhere": elsewhere_s,
                "unit": "s",
                "text": text,
            }),
            ScheduleCaution::DegreeLowered { .. }
            | ScheduleCaution::Overshoot { .. }
            | ScheduleCaution::NotPositive => {
                json!({"code": caution.code(), "text": text})
            }
        }
    }
}

/// Returns the sources of the models, as far as their dataset records them.
fn sources(condition: &Condition) -> Value {
    let entry = |bundle: BundleKind, model: &Model| {
        let Provenance {
            file,
            sha256,
            variable,
            made,
            note,
            records,
            unused,
            ..
        } = model.source.as_ref()?;
        let source = json!({
            "bundle": bundle.to_string(),
            "model": model.name,
            "file": file,
            "sha256": sha256,
            "variable": variable,
            "made": made,
            "note": note,
            "records": records,
            "unused": unused,
        });
        Some(without_empty(source, &["records", "unused"]))
    };
    let of_bundle = |kind| {
        condition
            .bundle(kind)
            .iter()
            .filter_map(move |model| entry(kind, model))
    };
    BundleKind::BOTH.into_iter().flat_map(of_bundle).collect()
}

/// Returns discontinuity ratios by name, in file order; null if none could be computed.
fn discontinuity(condition: &Condition, result: &ConditionAnalysis) -> Value {
    let ratios = result
        .figures
        .discontinuity
        .as_ref()
        .map(|found| found.ratios.as_slice())
        .unwrap_or_default();
    let models = condition.bundle(BundleKind::Physics).iter();
    Value::Object(
        models
            .zip(ratios)
            .map(|(model, ratio)| (model.name.clone(), json!(ratio)))
            .collect(),
    )
}

// Couplings of the physics models, and their value (M16).

/// Returns mixing and feedback of the study, in the dataset's units; null without couplings.
pub(super) fn couplings(analysis: &Analysis) -> Value {
    let fitted = match &analysis.couplings {
        None => return Value::Null,
        Some(Err(error)) => {
            return json!({"why": error.words(&analysis.study.dataset.names_of_channels().0)});
        }
        Some(Ok(fitted)) => fitted,
    };
    let feedback = fitted.matrices().feedback();
    let (inputs, outputs) = feedback.shape();
    let assessment = analysis.coupling_assessment.as_deref();
    let deviations = assessment.map(CouplingsAssessment::feedback);
    // Each row belongs to the receiving input.
    let rows = |entry: &dyn Fn(usize, usize) -> Value| {
        rows_of(inputs, outputs, |at: Pair| entry(at.output, at.input))
    };
    let costs = assessment.map(|assessment| &assessment.costs);
    let found = json!({
        "conditions": fitted.problem.conditions.iter().map(|of| of.id.0).collect::<Value>(),
        "feedback": rows(&|input, output| feedback[(input, output)].into()),
        "feedback_sd": deviations.map(|of| rows(&|input, output| of[(input, output)].deviation.into())),
        "residual": fitted.fit.residual,
        "uncorrected": costs.map(|costs| axis_cost(costs.uncorrected)),
        "own": costs.map(|costs| coupling_cost(costs.own)),
        "scheduled": costs.map(|costs| coupling_cost(costs.scheduled)),
        "left_out": costs.and_then(|costs| costs.left_out).map(coupling_cost),
        "words": analysis_coupling_remarks(analysis).into_iter().map(|remark| remark.text).collect::<Value>(),
    });
    without_empty(
        found,
        &[
            "feedback_sd",
            "uncorrected",
            "own",
            "scheduled",
            "left_out",
            "words",
        ],
    )
}

fn axis_cost(of: AxisCost) -> Value {
    json!({"on_axis": of.on_axis, "others": of.others})
}

fn coupling_cost(of: CouplingCost) -> Value {
    json!({
        "on_axis": of.with.on_axis,
        "others": of.with.others,
        "without_on_axis": of.without.on_axis,
        "without_others": of.without.others,
    })
}

/// Returns the mixing of a condition, with ones on its diagonal, and the effect of the couplings on
/// its physics representative; null without couplings.
pub(super) fn condition_couplings(analysis: &Analysis, result: &ConditionAnalysis) -> Value {
    let Some(coupled) = &result.coupled else {
        return Value::Null;
    };
    let airspeed_kt = result.condition.flight_state().airspeed_kt;
    let mixing = coupled.fitted.matrices().normalised_mixing(airspeed_kt);
    let assessment = analysis.coupling_assessment.as_deref();
    let deviations = assessment.map(|assessment| assessment.mixing(airspeed_kt));
    let of = assessment.and_then(|assessment| assessment.conditions.get(&result.condition.id()));
    let rows = |entry: &dyn Fn(usize, usize) -> Value| {
        rows_of(mixing.nrows(), mixing.ncols(), |at: Pair| {
            entry(at.output, at.input)
        })
    };
    let poles = of.and_then(|of| of.poles.as_ref().ok()).map(|shifts| {
        let pole = |shift: &gdcm_method::couplings::PoleShift| {
            json!({
                "before_real_rad_s": shift.before.map(|before| before.re),
                "before_imaginary_rad_s": shift.before.map(|before| before.im),
                "after_real_rad_s": shift.after.re,
                "after_imaginary_rad_s": shift.after.im,
            })
        };
        shifts.iter().map(pole).collect::<Value>()
    });
    let found = json!({
        "mixing": rows(&|to, from| mixing[(to, from)].into()),
        "mixing_sd": deviations.map(|of| rows(&|to, from| of[(to, from)].deviation.into())),
        "poles_moved": poles,
        "least_singular_value": of.and_then(|of| of.margin).map(|margin| {
            json!({"value": margin.least, "omega_rad_s": margin.omega_rad_s})
        }),
        "left_out": of.and_then(|of| of.left_out).map(coupling_cost),
    });
    without_empty(
        found,
        &[
            "mixing_sd",
            "poles_moved",
            "least_singular_value",
            "left_out",
        ],
    )
}
