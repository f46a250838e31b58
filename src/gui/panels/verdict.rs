//! Verdict: whether the corrected model holds, and the next step if it does not.

use gdcm_method::correction::LeadPrice;
use gdcm_method::correction::conflict::ConflictKind;
use gdcm_method::correction::remedy::Remedy;
use gdcm_method::schedule::ScheduleCaution;
use gdcm_model::dataset::{BundleKind, ConditionId, Pair};
use gdcm_model::number_format::with_minus_sign;
use gdcm_model::statistics::median;
use gdcm_model::units::{number, s_to_ms, signed, six_digits, telling, told_apart};
use gdcm_study::decisions::setting;
use gdcm_study::decisions::setting_row::Value;
use gdcm_study::decisions::signs::SignRole;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::results::couplings_assessment::CouplingCost;
use gdcm_study::{ConditionAnalysis, CouplingCorrection, Edit, PhaseCorrection};
use gdcm_words::caution::failure_text;
use gdcm_words::couplings::coupling_cautions;
use gdcm_words::remark::RemarkKind;

use super::explanation::turn_entry;
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::{offered_couplings, used_couplings};

/// Verdict on gain and phase of the constrained responses, here and in every condition, with the
/// next steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Condition of the verdict.
    pub condition: ConditionId,
    /// Gains, phases.
    pub rows: [VerdictRow; 2],
    /// Recommended step, followed by the alternatives.
    pub steps: Vec<Step>,
    /// Note beside the steps.
    pub note: String,
    /// Caution before the result is used: "Price: +21 dB above 12 rad/s".
    pub caution: Option<String>,
    /// Number of poles of kept physics models, in all conditions, that the couplings in use make
    /// unstable within the band.
    pub unstable_in_band: usize,
    /// Number of sentences in the list of reasons.
    pub reasons: usize,
}

/// Gains or phases of the constrained responses.
#[derive(Clone, Debug, PartialEq)]
pub struct VerdictRow {
    /// "Gain" or "Phase".
    pub name: &'static str,
    /// Matched constrained responses, and their total; `None` without a result.
    pub here: Option<[usize; 2]>,
    /// The same over all conditions with a result.
    pub everywhere: Option<[usize; 2]>,
    /// "matched", "lags by ≈ 66 ms".
    pub words: String,
    /// Whether all requests are met.
    pub is_met: bool,
}

/// Possible action.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Text of the button.
    pub label: String,
    pub command: Command,
}

impl Step {
    fn new(label: impl Into<String>, command: impl Into<Command>) -> Self {
        Self {
            label: label.into(),
            command: command.into(),
        }
    }

    /// Returns the step to the reasons for the result.
    fn reasons(label: &str) -> Self {
        Self::new(
            label,
            Command::Layout(LayoutCommand::ShowSheet(Some(Sheet::Reasons))),
        )
    }
}

impl VerdictRow {
    fn without_result(name: &'static str, words: String) -> Self {
        Self {
            name,
            here: None,
            everywhere: None,
            words,
            is_met: false,
        }
    }

    /// "5 of 5".
    pub fn count(counts: Option<[usize; 2]>) -> String {
        counts.map_or("–".to_owned(), |[met, held]| format!("{met} of {held}"))
    }

    /// Returns the verdict as a sentence for screen readers.
    pub fn sentence(&self) -> String {
        let [here, everywhere] = [self.here, self.everywhere].map(Self::count);
        format!(
            "{}: {here} {}, of all conditions {everywhere}",
            self.name, self.words
        )
    }
}

impl Verdict {
    /// Returns the verdict on the displayed condition.
    pub fn of(state: &State) -> Self {
        let condition = state.condition().id();
        let nothing = |gain: String, steps: Vec<Step>| Self {
            condition,
            rows: [
                VerdictRow::without_result("Gain", gain),
                VerdictRow::without_result("Phase", String::new()),
            ],
            steps,
            note: String::new(),
            caution: None,
            unstable_in_band: 0,
            reasons: 0,
        };
        match state.outcome() {
            None => nothing(state.results.absence().to_owned(), Vec::new()),
            Some(Err(failure @ ConditionFailure::NoReference)) => {
                let identify = Step::new(
                    "Identify from records",
                    Command::Layout(LayoutCommand::ShowView(View::Records)),
                );
                Self {
                    caution: Some(failure_text(failure, state.dataset())),
                    ..nothing("no reference yet".to_owned(), vec![identify])
                }
            }
            Some(Err(failure)) => Self {
                caution: Some(failure_text(failure, state.dataset())),
                ..nothing("no result".to_owned(), Vec::new())
            },
            Some(Ok(shown)) => Self::of_result(state, shown),
        }
    }

    fn of_result(state: &State, shown: &ConditionAnalysis) -> Self {
        let reasons = super::explanation::remarks_shown(state, shown).len();
        let (steps, note) = steps(state, shown);
        let caution = caution(state, shown);
        let unstable_in_band = unstable_in_band(state);
        Self {
            condition: shown.condition.id(),
            rows: rows(state, shown),
            steps,
            note,
            caution,
            unstable_in_band,
            reasons,
        }
    }

    /// Returns whether gains and phases are met and no pole within the band became unstable.
    pub fn is_met(&self) -> bool {
        self.rows.iter().all(|row| row.is_met) && self.unstable_in_band == 0
    }
}

/// Counts the constrained responses with matched gain and with matched phase, each with the total.
fn counts(shown: &ConditionAnalysis) -> [[usize; 2]; 2] {
    let held = shown.held().marked().count();
    [&shown.gains, &shown.delays].map(|solution| [held - solution.unmatched.len().min(held), held])
}

fn rows(state: &State, shown: &ConditionAnalysis) -> [VerdictRow; 2] {
    let phase = state.study.settings.phase;
    let [gain, delay] = counts(shown);
    let results = state.analysis().map(|analysis| {
        analysis
            .conditions
            .values()
            .filter_map(|of| of.as_ref().ok())
    });
    let everywhere = results.map(|results| {
        let none = [[0; 2]; 2];
        results.map(counts).fold(none, |sum, of| {
            [0, 1].map(|row| [0, 1].map(|at| sum[row][at] + of[row][at]))
        })
    });
    let is_corrected = phase != PhaseCorrection::None;
    let is_any_held = gain[1] > 0;
    let is_phase_met = is_corrected && shown.delays.matched;
    let gains = VerdictRow {
        name: "Gain",
        here: Some(gain),
        everywhere: everywhere.map(|of| of[0]),
        words: if is_any_held {
            gain_words(state, shown)
        } else {
            "fitted, none held".to_owned()
        },
        is_met: is_any_held && shown.gains.matched,
    };
    let phases = VerdictRow {
        name: "Phase",
        here: is_corrected.then_some(delay),
        everywhere: everywhere.map(|of| of[1]).filter(|_| is_corrected),
        words: match (is_corrected, is_any_held) {
            (false, _) => "not corrected".to_owned(),
            (true, false) => "fitted, none held".to_owned(),
            (true, true) if is_phase_met => format!("matched, {}", band_words(state)),
            (true, true) => lag_words(
                &mut shown
                    .delays
                    .unmatched
                    .iter()
                    .map(|missed| s_to_ms(missed.excess))
                    .collect::<Vec<_>>(),
            ),
        },
        is_met: is_any_held && is_phase_met,
    };
    [gains, phases]
}

/// "0.5–12 rad/s".
pub(crate) fn band_words(state: &State) -> String {
    let band = state.study.settings.band;
    format!(
        "{}–{} rad/s",
        six_digits(band.min()),
        six_digits(band.max())
    )
}

fn gain_words(state: &State, shown: &ConditionAnalysis) -> String {
    let Some(miss) = shown.gains.unmatched.first() else {
        return "matched".to_owned();
    };
    match miss.why.kind {
        ConflictKind::AboveUpper { .. }
        | ConflictKind::BelowLower { .. }
        | ConflictKind::TooFarApart { .. } => {
            format!(
                "{} stops at a bound",
                joined(&state.dataset().pair_name(miss.pair))
            )
        }
        ConflictKind::Loop { .. } | ConflictKind::Unclear => {
            let missed: Vec<Pair> = shown.gains.unmatched.iter().map(|miss| miss.pair).collect();
            shared_words(state, &missed)
                .unwrap_or_else(|| format!("{} disagree", miss.why.entries.len().max(2)))
        }
    }
}

/// Returns "2 share PED" for responses that conflict because they have an input or output in
/// common.
fn shared_words(state: &State, pairs: &[Pair]) -> Option<String> {
    let [first, rest @ ..] = pairs else {
        return None;
    };
    let inputs = state.dataset().inputs();
    let outputs = state.dataset().outputs();
    let input = rest
        .iter()
        .all(|pair| pair.input == first.input)
        .then(|| &inputs[first.input]);
    let output = || {
        rest.iter()
            .all(|pair| pair.output == first.output)
            .then(|| &outputs[first.output])
    };
    let channel = input.or_else(output).filter(|_| !rest.is_empty())?;
    Some(format!("{} share {}", pairs.len(), channel.name))
}

/// Returns a name that does not break at the end of a line.
pub(crate) fn joined(name: &str) -> String {
    name.replace(' ', "\u{a0}")
}

/// Returns "lags by ≈ 66 ms" if all responses lag about equally, by the criterion of the remark on
/// a common lead, otherwise "lags 20–110 ms"; short enough for the narrowest window.
fn lag_words(left_ms: &mut [f64]) -> String {
    let (least, most) = left_ms
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), at| {
            (a.min(*at), b.max(*at))
        });
    let middle = median(left_ms);
    let verb = if middle >= 0.0 { "lags" } else { "leads" };
    let [low, high] = if middle >= 0.0 {
        [least, most]
    } else {
        [-most, -least]
    }
    .map(|at| with_minus_sign(&telling(at, 0)));
    if low == high {
        format!("{verb} by {low} ms")
    } else if most - least <= 0.5 * middle.abs() {
        format!("{verb} by ≈ {} ms", telling(middle.abs(), 0))
    } else {
        // "-5–60" would read as two signs.
        let to = if least * most < 0.0 { " to " } else { "–" };
        format!("{verb} {low}{to}{high} ms")
    }
}

/// Returns the steps, the recommended step first, and the note beside them.
fn steps(state: &State, shown: &ConditionAnalysis) -> (Vec<Step>, String) {
    let condition = shown.condition.id();
    let alone = |steps: Vec<Step>| (steps, String::new());
    if let Some(channel) = shown.doubts.iter().find_map(|doubt| doubt.turns()) {
        let (label, command) = turn_entry(state, channel, Some(SignRole::Identified));
        return (
            vec![Step::new(label, command), Step::reasons("Why?")],
            "its sign seems to be the other one".to_owned(),
        );
    }
    let open = state.open_suggestions(shown);
    if !open.is_empty() {
        let reject = Step::new(
            format!("Reject {} suggested", open.len()),
            Edit::reject_physics(condition, &open),
        );
        return (
            vec![reject],
            format!(
                "of {} models, first",
                state.condition().bundle(BundleKind::Physics).len()
            ),
        );
    }
    if shown.held().marked().next().is_none() {
        return alone(vec![Step::new(
            "Hold the on-axis responses",
            Edit::ConstrainOnAxis,
        )]);
    }
    if !shown.gains.matched {
        return alone(gain_steps(state, shown));
    }
    match state.study.settings.phase {
        PhaseCorrection::None => alone(vec![Step::new(
            "Use delays",
            setting::PHASE.to(PhaseCorrection::Delay),
        )]),
        PhaseCorrection::Delay if !shown.delays.matched => {
            let leads = Step::new("Use leads", setting::PHASE.to(PhaseCorrection::Lead));
            alone(vec![leads, Step::reasons("Find the cause first")])
        }
        PhaseCorrection::Lead if !shown.delays.matched => {
            let free = shown
                .delays
                .remedy
                .iter()
                .flat_map(|remedy| &remedy.free)
                .next();
            let free = free.map(|pair| free_step(state, *pair));
            alone(free.into_iter().chain([Step::reasons("Why?")]).collect())
        }
        PhaseCorrection::Lead => couplings_steps(state).unwrap_or_else(|| {
            alone(vec![
                Step::new("Export corrections…", export()),
                Step::reasons("Find the cause"),
            ])
        }),
        PhaseCorrection::Delay => couplings_steps(state)
            .unwrap_or_else(|| alone(vec![Step::new("Export corrections…", export())])),
    }
}

/// Returns the steps to use worthwhile couplings, or to remove couplings that are not worthwhile.
fn couplings_steps(state: &State) -> Option<(Vec<Step>, String)> {
    let words = |cost: CouplingCost| {
        let others = cost.without.others.zip(cost.with.others);
        others.map_or(String::new(), |(without, with)| {
            format!("off-axis J {}→{}", telling(without, 0), telling(with, 0))
        })
    };
    let look = || {
        Step::new(
            "Look first",
            Command::Layout(LayoutCommand::ShowView(View::Couplings)),
        )
    };
    if let Some((assessment, cost)) = offered_couplings(state) {
        let use_them = Step::new("Use couplings", setting::COUPLINGS.to(assessment.couplings));
        return Some((vec![use_them, look()], words(cost)));
    }
    let used = used_couplings(state)?;
    let cost = used.deciding_cost();
    let leave_them = Step::new(
        "Switch couplings off",
        setting::COUPLINGS.to(CouplingCorrection::None),
    );
    let is_doubtful = !cost.is_worth_it() || used.unstable_in_band() > 0;
    is_doubtful.then(|| (vec![leave_them, look()], words(cost)))
}

/// Counts the poles within the band that the couplings in use make unstable.
fn unstable_in_band(state: &State) -> usize {
    used_couplings(state).map_or(0, |used| used.unstable_in_band())
}

/// Returns the command that opens the export form.
pub(crate) fn export() -> Command {
    Command::Form(FormCommand::ShowForm(Some(FormKind::Export)))
}

fn free_step(state: &State, pair: Pair) -> Step {
    Step::new(
        format!("Free {}", joined(&state.dataset().pair_name(pair))),
        Edit::Hold(pair, false),
    )
}

/// Returns the bound that would be sufficient, if any, then the response to release.
fn gain_steps(state: &State, shown: &ConditionAnalysis) -> Vec<Step> {
    let Some(remedy) = &shown.gains.remedy else {
        return vec![Step::reasons("Why?")];
    };
    let widen = widened(remedy, shown)
        .map(|range| Step::new("Widen the bound", setting::GAIN_BOUNDS.to(range)));
    let free = remedy.free.first().map(|pair| free_step(state, *pair));
    widen
        .into_iter()
        .chain(free)
        .chain([Step::reasons("Why?")])
        .collect()
}

fn widened(remedy: &Remedy, shown: &ConditionAnalysis) -> Option<Value> {
    let bounds = shown.gain_bounds();
    let upper = remedy.upper.map(|upper| [bounds.lower, upper]);
    upper
        .or(remedy.lower.map(|lower| [lower, bounds.upper]))
        .map(Value::Range)
}

/// Returns the caution: missing couplings although some are requested, or the effect of couplings
/// on poles and loop; else the price of the leads; else the cost of the schedule in this condition.
fn caution(state: &State, shown: &ConditionAnalysis) -> Option<String> {
    let of_couplings = coupling_caution(state);
    let is_trouble = of_couplings
        .as_ref()
        .is_some_and(|(kind, _)| *kind == RemarkKind::Trouble);
    let words = of_couplings.map(|(_, words)| words);
    if is_trouble {
        words
    } else {
        lead_caution(shown)
            .or(words)
            .or_else(|| schedule_caution(state, shown))
    }
}

/// Returns a caution if the schedule leaves more than twice the J of the condition's own correction
/// (M12).
fn schedule_caution(state: &State, shown: &ConditionAnalysis) -> Option<String> {
    let schedule = state.analysis()?.schedule.as_ref().ok()?;
    for caution in &schedule.cautions {
        if let ScheduleCaution::CostsMore(cost) = caution
            && cost.condition == shown.condition.id()
        {
            let (scheduled, own) = told_apart(cost.scheduled, cost.own, 0);
            return Some(format!("Scheduled: J {scheduled}, own {own}"));
        }
    }
    None
}

/// Returns the most serious remark on the couplings in use in a few words; the list of reasons has
/// all of them.
fn coupling_caution(state: &State) -> Option<(RemarkKind, String)> {
    if state.analysis()?.asked_couplings().is_err() {
        return Some((
            RemarkKind::Trouble,
            "No couplings could be found".to_owned(),
        ));
    }
    let cautions = coupling_cautions(used_couplings(state)?, state.dataset());
    match (unstable_in_band(state), cautions.len()) {
        (0, 0) => None,
        (1, _) => Some((
            RemarkKind::Trouble,
            "Couplings: 1 pole unstable in the band".to_owned(),
        )),
        (count @ 2.., _) => Some((
            RemarkKind::Trouble,
            format!("Couplings: {count} poles unstable in the band"),
        )),
        (0, 1) => Some((RemarkKind::Caution, "Couplings: 1 caution".to_owned())),
        (0, count) => Some((RemarkKind::Caution, format!("Couplings: {count} cautions"))),
    }
}

/// Returns the price of the leads: the greatest magnitude that the filters of a constrained
/// response add above the band (M15.6).
fn lead_caution(shown: &ConditionAnalysis) -> Option<String> {
    let price = LeadPrice::of(&shown.compensated.as_ref()?.leads)?;
    let most_db = shown
        .held()
        .marked()
        .map(|pair| price.of_pair_db(pair))
        .fold(0.0, f64::max);
    let top = number(price.limit_rad_s);
    (most_db > 0.05).then(|| format!("Price: {} dB above {top} rad/s", signed(most_db, 0)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::Complex;

    use gdcm_model::progress::Unobserved;
    use gdcm_study::results::couplings_assessment::UnstablePole;
    use gdcm_study::{Engine, Study};

    use super::*;
    use crate::gui::commands::study::StudyCommand;
    use crate::gui::views::couplings_job;

    fn state_of(decide: &[Edit]) -> State {
        let mut study = Study::new(
            gdcm_io::embedded_example()
                .expect("it is in the program")
                .dataset,
        );
        decide
            .iter()
            .for_each(|edit| study.apply(edit).expect("the example takes it"));
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

    fn labels(verdict: &Verdict) -> Vec<&str> {
        verdict
            .steps
            .iter()
            .map(|step| step.label.as_str())
            .collect()
    }

    #[test]
    fn suggested_models_are_to_be_rejected_before_anything_else() {
        let verdict = Verdict::of(&state_of(&[]));
        assert_eq!(labels(&verdict), ["Reject 3 suggested"]);
        assert_eq!(verdict.note, "of 19 models, first");
    }

    #[test]
    fn gains_alone_do_not_make_a_verdict_good() {
        let verdict = Verdict::of(&state_of(&[reject()]));
        let [gain, phase] = &verdict.rows;
        assert_eq!(
            (gain.here, gain.everywhere, gain.words.as_str()),
            (Some([5, 5]), Some([55, 55]), "matched")
        );
        assert_eq!(
            (phase.here, phase.everywhere),
            (Some([0, 5]), Some([0, 55]))
        );
        // The medians of D of the example's constrained responses in condition 10: 56 to 72 ms of
        // lead.
        assert_eq!(phase.words, "lags by ≈ 66 ms");
        assert!(!verdict.is_met() && verdict.caution.is_none());
        assert_eq!(labels(&verdict), ["Use leads", "Find the cause first"]);
    }

    #[test]
    fn leads_are_met_and_say_their_price() {
        let verdict = Verdict::of(&state_of(&[
            reject(),
            setting::PHASE.to(PhaseCorrection::Lead),
        ]));
        assert!(verdict.is_met(), "{verdict:?}");
        let caution = verdict.caution.as_deref().unwrap_or_default();
        assert!(
            caution.starts_with("Price: +") && caution.ends_with(" dB above 12 rad/s"),
            "{caution}"
        );
        assert_eq!(verdict.steps[0].command, export());
    }

    #[test]
    fn poles_that_couplings_make_unstable_in_the_band_keep_the_verdict_from_being_good() {
        let couplings = setting::COUPLINGS.to(CouplingCorrection::MixingAndFeedback);
        let mut state = state_of(&[
            reject(),
            setting::PHASE.to(PhaseCorrection::Lead),
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
            Verdict::of(&state)
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
                .is_some_and(|words| words.contains("2 poles")),
            "{within:?}"
        );
        assert_eq!(
            within.steps[0].command,
            setting::COUPLINGS.to(CouplingCorrection::None).into()
        );
    }

    #[test]
    fn where_nothing_is_held_the_on_axis_responses_are_offered() {
        let pairs: Vec<Pair> = state_of(&[]).dataset().on_axis().marked().collect();
        let release: Vec<Edit> = pairs
            .into_iter()
            .map(|pair| Edit::Hold(pair, false))
            .chain([reject()])
            .collect();
        let verdict = Verdict::of(&state_of(&release));
        assert_eq!(verdict.rows[0].words, "fitted, none held");
        assert_eq!(labels(&verdict), ["Hold the on-axis responses"]);
        assert!(!verdict.is_met());
    }

    #[test]
    fn responses_that_have_a_channel_in_common_are_told_by_it() {
        let state = state_of(&[]);
        let words = |pairs: &[(usize, usize)]| {
            let pairs: Vec<Pair> = pairs
                .iter()
                .map(|(output, input)| Pair::new(*output, *input))
                .collect();
            shared_words(&state, &pairs)
        };
        assert_eq!(words(&[(2, 2), (4, 2)]).as_deref(), Some("2 share PED"));
        assert_eq!(
            words(&[(1, 0), (1, 3), (1, 2)]).as_deref(),
            Some("3 share Q")
        );
        assert_eq!(
            (words(&[(2, 2), (5, 3)]), words(&[(2, 2)]), words(&[])),
            (None, None, None)
        );
    }

    #[test]
    fn what_phases_lag_by_is_one_number_or_two() {
        assert_eq!(lag_words(&mut [60.0]), "lags by 60 ms");
        assert_eq!(lag_words(&mut [60.0, 70.0, 64.0]), "lags by ≈ 64 ms");
        assert_eq!(lag_words(&mut [40.0, 106.0, 62.0]), "lags 40–106 ms");
        assert_eq!(lag_words(&mut [-5.0, 106.0, 62.0]), "lags −5 to 106 ms");
        assert_eq!(lag_words(&mut [-90.0, -10.0, -30.0]), "leads 10–90 ms");
    }

    #[test]
    fn a_bound_that_is_in_the_way_can_be_widened() {
        let bounds = setting::GAIN_BOUNDS.to(Value::Range([0.99, 1.01]));
        let verdict = Verdict::of(&state_of(&[reject(), bounds]));
        assert!(
            !verdict.rows[0].is_met && verdict.rows[0].words.ends_with("stops at a bound"),
            "{verdict:?}"
        );
        assert_eq!(labels(&verdict)[0], "Widen the bound");
        let Command::Study(StudyCommand::Edit(widen)) = &verdict.steps[0].command else {
            panic!("{verdict:?}")
        };
        let bounds = setting::GAIN_BOUNDS.to(Value::Range([0.99, 1.01]));
        assert!(Verdict::of(&state_of(&[reject(), bounds, widen.clone()])).rows[0].is_met);
    }
}
