//! What the result of a condition says, in the engineer's words.

use std::collections::BTreeSet;

use crate::correction::{Channel, Sensitivity, sensitivities};
use crate::dataset::Pair;
use crate::study::ConditionAnalysis;
use crate::units::s_to_ms;

use super::state::State;

/// How a remark is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemarkKind {
    /// What was asked for was done.
    Good,
    /// It was done, but the engineer has to know something.
    Caution,
    /// It could not be done.
    Trouble,
}

/// One remark on the result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// How it is meant.
    pub kind: RemarkKind,
    /// One or two sentences.
    pub text: String,
    /// The response that the engineer may want to ignore in the objective.
    pub ignore: Option<Pair>,
}

impl Remark {
    /// A remark that offers nothing.
    pub fn new(kind: RemarkKind, text: String) -> Self {
        Self { kind, text, ignore: None }
    }
}

/// Which held gains and delays were matched, which were not and why, and the cautions of the condition and of the schedule.
pub fn remarks(state: &State, shown: &ConditionAnalysis) -> Vec<Remark> {
    let mut remarks = gain_remarks(state, shown);
    remarks.extend(delay_remarks(state, shown));
    let pair_name = |pair| state.dataset().pair_name(pair);
    remarks.extend(shown.cautions.iter().map(|caution| Remark {
        kind: RemarkKind::Caution,
        text: caution.words(pair_name),
        ignore: caution.offers_to_ignore(),
    }));
    if let Some(Ok(schedule)) = state.analysis().map(|analysis| &analysis.schedule) {
        let (inputs, outputs) = channel_names(state);
        let words = schedule.cautions.iter().map(|caution| format!("Schedule: {}.", caution.words(&inputs, &outputs)));
        remarks.extend(words.map(|text| Remark::new(RemarkKind::Caution, text)));
    }
    remarks
}

fn gain_remarks(state: &State, shown: &ConditionAnalysis) -> Vec<Remark> {
    let held = shown.held().marked().count();
    if shown.gains.matched {
        let text = match held {
            0 => "No gain is held.".to_owned(),
            1 => "The held gain is matched exactly.".to_owned(),
            count => format!("All {count} held gains are matched exactly."),
        };
        return vec![Remark::new(RemarkKind::Good, text)];
    }
    let (inputs, outputs) = channel_names(state);
    let gains = &shown.gains;
    let top = state.study.settings.band.max();
    let misses: Vec<String> = gains.unmatched.iter().map(|unmatched| unmatched.words(top, &inputs, &outputs)).collect();
    let conflicts = gains.conflicts.iter().map(|conflict| conflict.words(&inputs, &outputs));
    let remedy = gains.remedy.iter().map(|remedy| remedy.words(&inputs, &outputs)).filter(|words| !words.is_empty());
    let texts = std::iter::once(misses.join(" ")).chain(conflicts).chain(remedy);
    texts.map(|text| Remark::new(RemarkKind::Trouble, text)).collect()
}

fn delay_remarks(state: &State, shown: &ConditionAnalysis) -> Vec<Remark> {
    let (held, unmatched) = (shown.held().marked().count(), &shown.delays.unmatched);
    if unmatched.is_empty() {
        let text = format!("All {held} held delays are matched exactly.");
        return if held == 0 { Vec::new() } else { vec![Remark::new(RemarkKind::Good, text)] };
    }
    let lead: Vec<String> = unmatched
        .iter()
        .filter(|unmatched| unmatched.delta < 0.0)
        .map(|unmatched| format!("{} {:.0} ms", state.dataset().pair_name(unmatched.pair), -s_to_ms(unmatched.delta)))
        .collect();
    let mut remarks = Vec::new();
    if !lead.is_empty() {
        let who = match (lead.len(), held) {
            (1, 1) => "The held response needs".to_owned(),
            (1, _) => format!("1 of {held} held responses needs"),
            (count, _) if count == held => format!("All {held} held responses need"),
            (count, _) => format!("{count} of {held} held responses need"),
        };
        let text = format!("{who} lead, because the physics model lags: {}. A delay cannot give it.", lead.join(", "));
        remarks.push(Remark::new(RemarkKind::Caution, text));
    }
    let (inputs, outputs) = channel_names(state);
    let top = state.study.settings.band.max();
    let others = unmatched.iter().filter(|unmatched| unmatched.delta >= 0.0);
    remarks.extend(others.map(|unmatched| Remark::new(RemarkKind::Caution, unmatched.words(top, &inputs, &outputs))));
    remarks
}

/// What the outcome leaves to say, entry by entry: other minima, what each missed delay leaves at the top of the band, and what
/// the held responses and the active bounds cost.
pub fn details(state: &State, shown: &ConditionAnalysis) -> Vec<String> {
    /// A share of the objective below which a restraint costs nothing worth reading.
    const NOTABLE: f64 = 1e-3;
    let (inputs, outputs) = channel_names(state);
    let mut details = vec![shown.gains.proof.outcome.words()];
    details.extend(shown.gains.proof.local_minima.iter().skip(1).map(|other| {
        let worse = 100.0 * (other.objective / shown.gains.objective - 1.0);
        let figures = |names: &[String], gains: &[f64]| {
            names.iter().zip(gains).map(|(name, gain)| format!("{name} {gain:.3}")).collect::<Vec<_>>().join(", ")
        };
        let (of_inputs, of_outputs) = (figures(&inputs, &other.inputs), figures(&outputs, &other.outputs));
        format!("Another set of gains is only {worse:.2} % worse: {of_inputs}; {of_outputs}.")
    }));
    let top = state.study.settings.band.max();
    details.extend(shown.delays.unmatched.iter().map(|unmatched| unmatched.words(top, &inputs, &outputs)));
    let notable = |sensitivity: &Sensitivity| sensitivity.share_per_unit.abs() > NOTABLE;
    for (problem, solution) in [(&shown.gain_problem, &shown.gains), (&shown.delay_problem, &shown.delays)] {
        let all = sensitivities(problem, solution).into_iter().filter(notable);
        details.extend(all.map(|sensitivity| sensitivity.words(&inputs, &outputs)));
    }
    details
}

/// The responses and the channels that are in each other's way, of the gains.
pub fn gain_conflict_marks(shown: &ConditionAnalysis) -> (BTreeSet<Pair>, BTreeSet<Channel>) {
    let conflicts = &shown.gains.conflicts;
    let pairs = conflicts.iter().flat_map(|conflict| conflict.entries.iter().copied()).collect();
    (pairs, conflicts.iter().flat_map(|conflict| conflict.channels()).collect())
}

/// What holding or freeing a response would cost, in words; nothing until the table of all toggles of this very result is computed.
pub fn toggle_costs(state: &State, pair: Pair) -> Vec<String> {
    let Some(toggles) = state.toggles() else {
        return Vec::new();
    };
    let (inputs, outputs) = channel_names(state);
    let (gain, delay) = toggles.of_pair(pair);
    let gain = gain.map(|toggle| format!("Gains: {}", toggle.words(&inputs, &outputs)));
    let delay = delay.map(|toggle| format!("Delays: {}", toggle.words(&inputs, &outputs)));
    gain.into_iter().chain(delay).collect()
}

/// Names of the inputs and of the outputs.
pub fn channel_names(state: &State) -> (Vec<String>, Vec<String>) {
    let names = |channels: &[crate::dataset::Channel]| channels.iter().map(|channel| channel.name.clone()).collect();
    (names(state.dataset().inputs()), names(state.dataset().outputs()))
}
