//! Verdict: whether the corrected model's constrained responses are matched, and the next step if
//! they are not. `gdcm_words::verdict` and `verdict_caution.rs` form its texts, `advice.rs` chooses
//! the steps, `verdict_view.rs` draws it.
//!
//! A held (constrained) response has its net gain matched exactly, its delay as far as possible.
//! Couplings mix the inputs and feed outputs back to them, and may move poles (M16:
//! docs/couplings.md).

use gdcm_model::dataset::ConditionId;
use gdcm_study::ConditionAnalysis;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::results::verdict::{GainVerdict, MatchCount, PhaseVerdict};
use gdcm_words::caution::failure_text;
use gdcm_words::verdict::{gain_verdict_text, match_count_text, phase_verdict_text};

use super::advice::{Advice, Step};
use super::verdict_caution::{caution, unstable_in_band};
use crate::gui::commands::command::Command;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::shown_remarks::remarks_shown;
use crate::message::Message;

/// Verdict on the constrained responses' gain and phase, in the displayed condition and in all
/// conditions, with the next steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Displayed condition.
    pub condition: ConditionId,
    /// Rows for the gains and the phases.
    pub rows: [VerdictRow; 2],
    /// Recommended step, followed by the alternatives.
    pub steps: Vec<Step>,
    /// Note beside the steps.
    pub note: String,
    /// Caution to read before the result is used, such as "Leads: +21 dB above 12 rad/s".
    pub caution: Option<Message>,
    /// Number of poles within the band that the couplings in use make unstable, over all kept
    /// physics models in all conditions.
    pub unstable_in_band: usize,
    /// Number of remarks in the reasons sheet.
    pub reasons: usize,
}

/// Row about the constrained responses' gains or phases.
#[derive(Clone, Debug, PartialEq)]
pub struct VerdictRow {
    /// "Gain" or "Phase".
    pub name: &'static str,
    /// Count in the displayed condition; `None` without a result, and for phases that are not
    /// corrected.
    pub here: Option<MatchCount>,
    /// Count over all conditions with a result; `None` if `here` is, and without an analysis.
    pub everywhere: Option<MatchCount>,
    /// Result in words, such as "matched" or "lags by ≈ 66 ms".
    pub message: Message,
    /// Whether all constrained responses are matched.
    pub is_met: bool,
}

impl VerdictRow {
    fn without_result(name: &'static str, message: Message) -> Self {
        Self {
            name,
            here: None,
            everywhere: None,
            message,
            is_met: false,
        }
    }

    /// Returns the count, such as "5 of 5", or "–" without a result.
    pub fn count_text(count: Option<MatchCount>) -> String {
        match count {
            Some(count) => match_count_text(count),
            None => "–".to_owned(),
        }
    }

    /// Returns the row as a sentence for screen readers.
    pub fn sentence(&self) -> String {
        let words = if self.message.text.is_empty() {
            "–"
        } else {
            self.message.text.as_str()
        };
        let mut sentence = format!("{}: {words}", self.name);
        if let Some(here) = self.here {
            let here = match_count_text(here);
            sentence.push_str(&format!(
                "; held responses matched: {here} in this condition"
            ));
        }
        if let Some(everywhere) = self.everywhere {
            let everywhere = match_count_text(everywhere);
            sentence.push_str(&format!(", {everywhere} in all conditions"));
        }
        sentence
    }
}

impl Verdict {
    /// Judges the displayed condition.
    pub fn new(state: &State) -> Self {
        match state.outcome() {
            None => Self::without_result(state, state.results.absence()),
            Some(Err(failure)) => Self::from_failure(state, failure),
            Some(Ok(shown)) => Self::from_result(state, shown),
        }
    }

    /// Returns the verdict on a condition without a result, with the message `words`.
    fn without_result(state: &State, words: &str) -> Self {
        Self {
            condition: state.condition().id(),
            rows: [
                VerdictRow::without_result("Gain", Message::new("no-result", words)),
                VerdictRow::without_result("Phase", Message::new("no-result", "")),
            ],
            steps: Vec::new(),
            note: String::new(),
            caution: None,
            unstable_in_band: 0,
            reasons: 0,
        }
    }

    fn from_failure(state: &State, failure: &ConditionFailure) -> Self {
        let text = failure_text(failure, state.dataset());
        let caution = Some(Message::new(failure.code(), text));
        if *failure != ConditionFailure::NoReference {
            return Self {
                caution,
                ..Self::without_result(state, "no result")
            };
        }
        let identify = Step::new(
            "Identify from records",
            Command::Layout(LayoutCommand::ShowView(View::Records)),
        );
        Self {
            caution,
            steps: vec![identify],
            ..Self::without_result(state, "no reference yet")
        }
    }

    fn from_result(state: &State, shown: &ConditionAnalysis) -> Self {
        let advice = Advice::new(state, shown);
        Self {
            condition: shown.condition.id(),
            rows: [gain_row(state, shown), phase_row(state, shown)],
            steps: advice.steps,
            note: advice.note,
            caution: caution(state, shown),
            unstable_in_band: unstable_in_band(state),
            reasons: remarks_shown(state, shown).len(),
        }
    }

    pub fn caution_text(&self) -> Option<&str> {
        match &self.caution {
            Some(caution) => Some(&caution.text),
            None => None,
        }
    }

    /// Returns whether gains and phases are matched and no pole within the band is made unstable.
    pub fn is_met(&self) -> bool {
        self.rows.iter().all(|row| row.is_met) && self.unstable_in_band == 0
    }
}

fn gain_row(state: &State, shown: &ConditionAnalysis) -> VerdictRow {
    let verdict = GainVerdict::new(shown);
    let text = gain_verdict_text(verdict, state.dataset());
    VerdictRow {
        name: "Gain",
        here: Some(MatchCount::of_gains(shown)),
        everywhere: everywhere(state, MatchCount::of_gains),
        message: Message::new(verdict.code(), text),
        is_met: verdict == GainVerdict::Matched,
    }
}

fn phase_row(state: &State, shown: &ConditionAnalysis) -> VerdictRow {
    let verdict = PhaseVerdict::new(&state.study, shown);
    let message = Message::new(verdict.code(), phase_verdict_text(verdict, &state.study));
    if verdict == PhaseVerdict::NotCorrected {
        return VerdictRow::without_result("Phase", message);
    }
    VerdictRow {
        name: "Phase",
        here: Some(MatchCount::of_phases(shown)),
        everywhere: everywhere(state, MatchCount::of_phases),
        message,
        is_met: verdict == PhaseVerdict::Matched,
    }
}

/// Sums the counts over all conditions with a result; `None` without an analysis.
fn everywhere(state: &State, count: fn(&ConditionAnalysis) -> MatchCount) -> Option<MatchCount> {
    Some(MatchCount::over_conditions(state.analysis()?, count))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::Complex;

    use gdcm_model::dataset::Pair;
    use gdcm_model::progress::Unobserved;
    use gdcm_study::decisions::setting_table;
    use gdcm_study::decisions::setting_value::Value;
    use gdcm_study::results::couplings_assessment::UnstablePole;
    use gdcm_study::{CouplingCorrection, Edit, Engine, PhaseCorrection, Study};

    use super::super::advice::export;
    use super::*;
    use crate::gui::commands::study::StudyCommand;
    use crate::gui::state::sheet::Sheet;
    use crate::gui::views::couplings_job;

    fn state_of(decide: &[Edit]) -> State {
        let mut study = Study::new(
            gdcm_io::embedded_example()
                .expect("it is in the program")
                .dataset,
        );
        for edit in decide {
            study.apply(edit).expect("the example takes it");
        }
        let mut state = State::new(study.clone(), String::new(), Vec::new());
        state.display.selection.condition = ConditionId(10);
        let analysis = Engine::default()
            .analyze(&study, &Unobserved)
            .expect("nothing stops it");
        state.results.analysis = Some(Arc::new(analysis));
        state
    }

    fn reject() -> Edit {
        let state = state_of(&[]);
        let shown = state.shown().expect("condition 10 has a result");
        Edit::reject_physics(ConditionId(10), &state.open_suggestions(shown))
    }

    fn count(matched: usize, held: usize) -> Option<MatchCount> {
        Some(MatchCount { matched, held })
    }

    fn commands(verdict: &Verdict) -> Vec<&Command> {
        verdict.steps.iter().map(|step| &step.command).collect()
    }

    fn codes(verdict: &Verdict) -> [&'static str; 2] {
        verdict.rows.each_ref().map(|row| row.message.code)
    }

    #[test]
    fn suggested_models_are_to_be_rejected_before_anything_else() {
        let verdict = Verdict::new(&state_of(&[]));
        assert_eq!(commands(&verdict), [&Command::from(reject())]);
        let Edit::RejectEach(models) = reject() else {
            panic!("several models are rejected")
        };
        assert_eq!(models.len(), 3);
        assert!(verdict.note.contains(" 19 "), "{}", verdict.note);
    }

    #[test]
    fn gains_alone_do_not_make_a_verdict_good() {
        let verdict = Verdict::new(&state_of(&[reject()]));
        let [gain, phase] = &verdict.rows;
        assert_eq!(
            (gain.here, gain.everywhere, gain.message.code),
            (count(5, 5), count(55, 55), "matched")
        );
        assert_eq!((phase.here, phase.everywhere), (count(0, 5), count(0, 55)));
        // The constrained responses of the example need leads of 57 to 71 ms in condition 10
        // (medians of D).
        assert_eq!(phase.message.code, "lag-remains");
        assert!(
            phase.message.text.contains(" 67 "),
            "{}",
            phase.message.text
        );
        assert!(!verdict.is_met() && verdict.caution.is_none());
        let leads = setting_table::PHASE.to(PhaseCorrection::Lead).into();
        let reasons = LayoutCommand::ShowSheet(Some(Sheet::Reasons)).into();
        assert_eq!(commands(&verdict), [&leads, &reasons]);
    }

    #[test]
    fn leads_are_met_and_say_their_price() {
        let verdict = Verdict::new(&state_of(&[
            reject(),
            setting_table::PHASE.to(PhaseCorrection::Lead),
        ]));
        assert!(verdict.is_met(), "{verdict:?}");
        let caution = verdict.caution.clone().expect("leads have a price");
        assert_eq!(caution.code, "lead-price");
        assert!(caution.text.contains(" 12 rad/s"), "{}", caution.text);
        assert_eq!(verdict.steps[0].command, export());
    }

    #[test]
    fn poles_that_couplings_make_unstable_in_the_band_keep_the_verdict_from_being_good() {
        let couplings = setting_table::COUPLINGS.to(CouplingCorrection::MixingAndFeedback);
        let mut state = state_of(&[
            reject(),
            setting_table::PHASE.to(PhaseCorrection::Lead),
            couplings,
        ]);
        let study = state.study.clone();
        let mut engine = Engine::default();
        let assessed =
            engine.assess_couplings(&study, CouplingCorrection::MixingAndFeedback, &Unobserved);
        let assessed = assessed
            .expect("nothing stops it")
            .expect("it asks for some")
            .expect("there are some");
        let mut verdict_with = |poles: &[(f64, bool)]| {
            let mut changed = (*assessed).clone();
            changed.unstable = poles
                .iter()
                .map(|(real, is_in_band)| UnstablePole {
                    condition: ConditionId(4),
                    model: "nominal".to_owned(),
                    is_representative: false,
                    pole: Complex::from(*real),
                    is_in_band: *is_in_band,
                })
                .collect();
            let job = couplings_job(&state);
            state.results.couplings = Some((job, Ok(Arc::new(changed))));
            Verdict::new(&state)
        };
        let sound = verdict_with(&[]);
        assert!(sound.is_met() && sound.unstable_in_band == 0, "{sound:?}");
        let beyond = verdict_with(&[(90.0, false)]);
        assert!(
            beyond.is_met() && beyond.unstable_in_band == 0,
            "{beyond:?}"
        );
        let within = verdict_with(&[(2.0, true), (90.0, false), (3.0, true)]);
        assert!(
            !within.is_met() && within.unstable_in_band == 2,
            "{within:?}"
        );
        assert!(
            within.rows.iter().all(|row| row.is_met),
            "gains and phases are met all the same"
        );
        assert!(
            within
                .caution
                .as_ref()
                .is_some_and(|caution| caution.code == "unstable-in-band"),
            "{within:?}"
        );
        assert_eq!(
            within.steps[0].command,
            setting_table::COUPLINGS.to(CouplingCorrection::None).into()
        );
    }

    #[test]
    fn on_axis_responses_are_offered_while_none_are_held() {
        let pairs: Vec<Pair> = state_of(&[]).dataset().on_axis().marked().collect();
        let release: Vec<Edit> = pairs
            .into_iter()
            .map(|pair| Edit::Hold(pair, false))
            .chain([reject()])
            .collect();
        let verdict = Verdict::new(&state_of(&release));
        assert_eq!(codes(&verdict), ["none-held"; 2]);
        assert_eq!(commands(&verdict), [&Command::from(Edit::ConstrainOnAxis)]);
        assert!(!verdict.is_met());
    }

    #[test]
    fn a_bound_that_is_in_the_way_can_be_widened() {
        let bounds = setting_table::GAIN_BOUNDS.to(Value::Range([0.99, 1.01]));
        let verdict = Verdict::new(&state_of(&[reject(), bounds]));
        assert!(
            !verdict.rows[0].is_met && verdict.rows[0].message.code == "stops-at-bound",
            "{verdict:?}"
        );
        let Command::Study(StudyCommand::Edit(widen)) = &verdict.steps[0].command else {
            panic!("{verdict:?}")
        };
        let bounds = setting_table::GAIN_BOUNDS.to(Value::Range([0.99, 1.01]));
        assert!(Verdict::new(&state_of(&[reject(), bounds, widen.clone()])).rows[0].is_met);
    }
}
