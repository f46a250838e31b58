//! Remarks on the result of a condition, in the engineer's words, identical in the window and in a
//! terminal.

use gdcm_method::correction::sensitivity::{Sensitivity, kkt_residual, sensitivities};
use gdcm_method::correction::{Channel, Solution};
use gdcm_method::schedule::Schedule;
use gdcm_model::dataset::Pair;
use gdcm_model::units::{number, s_to_ms, telling, told_apart};

use super::analysis::ConditionAnalysis;
use super::caution::Caution;
use crate::decisions::changed_models::SignRole;
use crate::decisions::settings::PhaseCorrection;
use crate::decisions::study::Study;
use crate::stages::lead_compensation::lead_remarks;

/// Kind of a remark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemarkKind {
    /// The request was fulfilled.
    Good,
    /// The request was fulfilled, with a caution.
    Caution,
    /// The request could not be fulfilled.
    Trouble,
}

/// One remark on the result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    pub kind: RemarkKind,
    /// One or two sentences.
    pub text: String,
    /// The response to consider ignoring in the objective.
    pub ignore: Option<Pair>,
    /// The correction of the phase to consider instead of the present one.
    pub phase: Option<PhaseCorrection>,
    /// The channel whose sign can be reversed, or restored (`None` as the role), at once.
    pub turn: Option<(Channel, Option<SignRole>)>,
    /// Content for one common table, where many conditions have the remark.
    pub repeated: Option<Repeated>,
}

/// A remark that most conditions of a study share, with its numbers, so that many of them form one
/// table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Repeated {
    /// Constrained responses need lead, with the lead of each \[ms\].
    NeedsLead(Vec<(Pair, String)>),
    /// All constrained responses need about the same lead \[ms\].
    CommonLead(String),
    /// Constrained responses are farther from flight than without a correction.
    Farther(Vec<Pair>),
    /// Greatest gain increase within the band by the lead filters \[dB\], and its response.
    RaisedGain(String, Pair),
    /// Mean J of the constrained responses without leads, and with them.
    LeadsOffered([String; 2]),
}

impl Remark {
    /// Creates a remark without an offer.
    pub fn new(kind: RemarkKind, text: String) -> Self {
        Self {
            kind,
            text,
            ignore: None,
            phase: None,
            turn: None,
            repeated: None,
        }
    }

    /// Marks the remark as one that many conditions share.
    pub(crate) fn repeated(self, repeated: Repeated) -> Self {
        Self {
            repeated: Some(repeated),
            ..self
        }
    }
}

/// Collects the remarks: which constrained gains and delays were matched, which were not and why,
/// and the cautions of the condition and of the schedule.
pub fn remarks(
    study: &Study,
    result: &ConditionAnalysis,
    schedule: Option<&Schedule>,
) -> Vec<Remark> {
    let mut remarks = sign_remarks(study, result);
    remarks.extend(gain_remarks(study, result));
    if study.settings.phase == PhaseCorrection::Delay {
        remarks.extend(delay_remarks(study, result));
    }
    remarks.extend(lead_remarks(study, result));
    remarks.extend(agreement_remarks(study, result));
    remarks.extend(coherence_remark(result));
    remarks.extend(worse_remark(study, result));
    remarks.extend(others_worse_remark(study, result));
    if !study.choice(result.condition.id()).scheduled {
        let text =
            "This condition is left out of the schedule: its gains do not count in it.".to_owned();
        remarks.push(Remark::new(RemarkKind::Caution, text));
    }
    let pair_name = |pair| study.dataset.pair_name(pair);
    remarks.extend(result.cautions.iter().map(|caution| Remark {
        ignore: caution.offers_to_ignore(),
        ..Remark::new(RemarkKind::Caution, caution.words(pair_name))
    }));
    if let Some(schedule) = schedule {
        let (inputs, outputs) = study.dataset.names_of_channels();
        let cautions = schedule
            .cautions
            .iter()
            .filter(|caution| caution.concerns(result.condition.id()));
        let words =
            cautions.map(|caution| format!("Schedule: {}.", caution.words(&inputs, &outputs)));
        remarks.extend(words.map(|text| Remark::new(RemarkKind::Caution, text)));
    }
    remarks
}

/// Reports suspected sign and unit differences first, before other causes are considered; then the
/// reversed channels.
fn sign_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let doubts = result.doubts.iter().map(|doubt| Remark {
        turn: doubt
            .turns()
            .map(|channel| (channel, Some(SignRole::Identified))),
        ..Remark::new(RemarkKind::Caution, doubt.words(&study.dataset))
    });
    let turned = study.signs.iter().map(|(channel, of)| {
        let name = channel.name_in(&study.dataset);
        let of = of.models();
        let text = format!("{name} of {of} is turned: its sign is not that of the file.");
        Remark {
            turn: Some((*channel, None)),
            ..Remark::new(RemarkKind::Good, text)
        }
    });
    doubts.chain(turned).collect()
}

fn gain_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let held = result.held().marked().count();
    if result.gains.matched {
        let text = match held {
            0 => "No gain is held.".to_owned(),
            1 => "The held gain is matched exactly.".to_owned(),
            count if !result.gains.agreeing.is_empty() => {
                format!(
                    "All {count} held gains are matched within {} dB.",
                    number(study.settings.agreement_db)
                )
            }
            count => format!("All {count} held gains are matched exactly."),
        };
        return vec![Remark::new(RemarkKind::Good, text)];
    }
    let (inputs, outputs) = study.dataset.names_of_channels();
    let remedy = result
        .gains
        .remedy
        .iter()
        .map(|remedy| remedy.words(&inputs, &outputs));
    let texts = miss_words(study, &result.gains).chain(remedy.filter(|words| !words.is_empty()));
    texts
        .map(|text| Remark::new(RemarkKind::Trouble, text))
        .collect()
}

/// Describes the actual values of constrained responses that miss their target, then the conflicts
/// that cause it.
pub(crate) fn miss_words(study: &Study, solution: &Solution) -> impl Iterator<Item = String> {
    let (inputs, outputs) = study.dataset.names_of_channels();
    let top = study.settings.band.max();
    let misses: Vec<String> = solution
        .unmatched
        .iter()
        .map(|miss| miss.words(top, &inputs, &outputs))
        .collect();
    let conflicts = solution
        .conflicts
        .iter()
        .map(move |conflict| conflict.words(&inputs, &outputs));
    std::iter::once(misses.join(" ")).chain(conflicts)
}

/// Reports the loops of constrained responses within the agreement tolerance.
fn agreement_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let (inputs, outputs) = study.dataset.names_of_channels();
    let loops = result.gains.agreeing.iter().chain(&result.delays.agreeing);
    loops
        .map(|of| Remark::new(RemarkKind::Good, of.agreement_words(&inputs, &outputs)))
        .collect()
}

/// Reports that coherence weights are used, where they exclude nothing; exclusions are reported by
/// a caution (M4a).
fn coherence_remark(result: &ConditionAnalysis) -> Option<Remark> {
    let mismatches = result.comparison.representative.mismatch.iter();
    let weighed = mismatches
        .filter(|(_, entry)| {
            entry
                .as_ref()
                .is_some_and(|entry| entry.coherence_weights.is_some())
        })
        .count();
    let is_told = result
        .cautions
        .iter()
        .any(|caution| matches!(caution, Caution::NotCoherent { .. }));
    (weighed > 0 && !is_told).then(|| {
        Remark::new(
            RemarkKind::Good,
            format!("Coherence weighs J, G and D of {weighed} responses."),
        )
    })
}

/// Reports the constrained responses that the correction moves away from flight.
fn worse_remark(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    // An increase of J by half a unit is negligible; with leads every increase is reported (M15.6).
    let notable = if study.settings.phase == PhaseCorrection::Lead {
        0.0
    } else {
        0.5
    };
    let worse = result.held().marked().filter_map(|pair| {
        let change = result.cost[pair]?;
        let (before, after) = told_apart(change.uncorrected.total(), change.corrected.total(), 0);
        let words = format!("{} (J {before} → {after})", study.dataset.pair_name(pair));
        (change.total() > notable).then_some((pair, words))
    });
    let (pairs, worse): (Vec<Pair>, Vec<String>) = worse.unzip();
    (!worse.is_empty()).then(|| {
        let text = format!(
            "Held, yet farther from flight than without a correction: {}.",
            worse.join(", ")
        );
        Remark::new(RemarkKind::Caution, text).repeated(Repeated::Farther(pairs))
    })
}

/// Reports the number of unconstrained responses that leads move away from flight (M15.6).
fn others_worse_remark(study: &Study, result: &ConditionAnalysis) -> Option<Remark> {
    let others = result.cost.iter().filter(|(pair, _)| !result.held()[*pair]);
    let changes: Vec<f64> = others
        .filter_map(|(_, change)| Some(change.as_ref()?.total()))
        .collect();
    let worse = changes.iter().filter(|change| **change > 0.0).count();
    (study.settings.phase == PhaseCorrection::Lead && worse > 0).then(|| {
        let text = format!(
            "{worse} of the {} responses that are not held are farther from flight than without.",
            changes.len()
        );
        Remark::new(RemarkKind::Caution, text)
    })
}

fn delay_remarks(study: &Study, result: &ConditionAnalysis) -> Vec<Remark> {
    let held = result.held().marked().count();
    let unmatched = &result.delays.unmatched;
    if unmatched.is_empty() {
        let how = if result.delays.agreeing.is_empty() {
            "exactly"
        } else {
            "as far as can be told"
        };
        let text = format!("All {held} held delays are matched {how}.");
        return if held == 0 {
            Vec::new()
        } else {
            vec![Remark::new(RemarkKind::Good, text)]
        };
    }
    let needed = unmatched.iter().filter(|unmatched| unmatched.delta < 0.0);
    let needed: Vec<(Pair, String)> = needed
        .map(|unmatched| (unmatched.pair, telling(-s_to_ms(unmatched.delta), 0)))
        .collect();
    let lead: Vec<String> = needed
        .iter()
        .map(|(pair, lead_ms)| format!("{} {lead_ms} ms", study.dataset.pair_name(*pair)))
        .collect();
    let mut remarks = Vec::new();
    if !lead.is_empty() {
        let who = match (lead.len(), held) {
            (1, 1) => "The held response needs".to_owned(),
            (1, _) => format!("1 of {held} held responses needs"),
            (count, _) if count == held => format!("All {held} held responses need"),
            (count, _) => format!("{count} of {held} held responses need"),
        };
        let text = format!(
            "{who} lead, because the physics model lags: {}. A delay cannot give it.",
            lead.join(", ")
        );
        remarks.push(Remark::new(RemarkKind::Caution, text).repeated(Repeated::NeedsLead(needed)));
    }
    let (inputs, outputs) = study.dataset.names_of_channels();
    let top = study.settings.band.max();
    let others = unmatched.iter().filter(|unmatched| unmatched.delta >= 0.0);
    remarks.extend(others.map(|unmatched| {
        Remark::new(RemarkKind::Caution, unmatched.words(top, &inputs, &outputs))
    }));
    remarks
}

/// Lists the details of the solution: other minima, the error at the top of the band due to each
/// missed delay, and the cost of the constrained responses and the active bounds.
pub fn details(study: &Study, result: &ConditionAnalysis) -> Vec<String> {
    /// Share of the objective below which the cost of a constraint is negligible.
    const NOTABLE: f64 = 1e-3;
    let (inputs, outputs) = study.dataset.names_of_channels();
    let mut details = vec![result.gains.proof.outcome.words()];
    details.extend(result.gains.proof.local_minima.iter().skip(1).map(|other| {
        let worse = 100.0 * (other.objective / result.gains.objective - 1.0);
        let figures = |names: &[String], gains: &[f64]| {
            names
                .iter()
                .zip(gains)
                .map(|(name, gain)| format!("{name} {gain:.3}"))
                .collect::<Vec<_>>()
                .join(", ")
        };
        let of_inputs = figures(&inputs, &other.inputs);
        let of_outputs = figures(&outputs, &other.outputs);
        format!("Another set of gains is only {worse:.2} % worse: {of_inputs}; {of_outputs}.")
    }));
    let top = study.settings.band.max();
    if study.settings.phase == PhaseCorrection::Lead {
        let residual_s = kkt_residual(&result.delay_problem, &result.delays);
        details.push(format!(
            "The program of delays and leads is convex: KKT residual {residual_s:.0e} s, which proves its optimum."
        ));
    }
    details.extend(
        result
            .delays
            .unmatched
            .iter()
            .map(|unmatched| unmatched.words(top, &inputs, &outputs)),
    );
    let notable = |sensitivity: &Sensitivity| sensitivity.share_per_unit.abs() > NOTABLE;
    for (problem, solution) in [
        (&result.gain_problem, &result.gains),
        (&result.delay_problem, &result.delays),
    ] {
        let all = sensitivities(problem, solution).into_iter().filter(notable);
        details.extend(all.map(|sensitivity| sensitivity.words(&inputs, &outputs)));
    }
    details
}
