//! Recommended next steps, shown with the verdict.
//!
//! A held (constrained) response has its net gain matched exactly, unless the constraints conflict:
//! no gains within their bounds meet all of them. Its delay is matched as far as possible. A remedy
//! is a single change that resolves a conflict. A doubt is an apparent difference in sign or unit
//! between the physics and the identified models. Couplings mix the inputs and feed outputs back to
//! them (M16: docs/couplings.md).

use gdcm_method::correction::Channel;
use gdcm_method::correction::remedy::Remedy;
use gdcm_model::dataset::{BundleKind, Pair};
use gdcm_model::units::telling;
use gdcm_study::decisions::setting_table;
use gdcm_study::decisions::setting_value::Value;
use gdcm_study::decisions::signs::SignRole;
use gdcm_study::results::correction_costs::AxisCost;
use gdcm_study::{ConditionAnalysis, CouplingCorrection, Edit, PhaseCorrection};
use gdcm_words::verdict::unbroken;

use super::sign_reversal::sign_reversal_entry;
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::forms::FormKind;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::{offered_couplings, used_couplings};

/// Label of the button that uses the worthwhile couplings (`offered_couplings`).
pub(super) const USE_COUPLINGS: &str = "Use couplings";
/// Label of the button that opens the Couplings view.
pub(super) const INSPECT: &str = "Inspect";
/// Label of the button that opens the sheet with the reasons for the result.
const REASONS: &str = "Find the cause";

/// Returns the label of the button that chooses this phase correction.
pub(super) fn phase_step_label(phase: PhaseCorrection) -> &'static str {
    match phase {
        PhaseCorrection::None => "Leave phase uncorrected",
        PhaseCorrection::Delay => "Use delays",
        PhaseCorrection::Lead => "Use leads",
    }
}

/// Recommended or alternative action, drawn as a button.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub label: String,
    pub command: Command,
}

impl Step {
    pub(super) fn new(label: impl Into<String>, command: impl Into<Command>) -> Self {
        Self {
            label: label.into(),
            command: command.into(),
        }
    }

    /// Returns the step that opens the reasons for the result.
    fn reasons() -> Self {
        Self::new(
            REASONS,
            Command::Layout(LayoutCommand::ShowSheet(Some(Sheet::Reasons))),
        )
    }
}

/// Next steps, the recommended step first, and the note beside them.
pub(super) struct Advice {
    pub(super) steps: Vec<Step>,
    pub(super) note: String,
}

impl Advice {
    fn without_note(steps: Vec<Step>) -> Self {
        Self {
            steps,
            note: String::new(),
        }
    }

    /// Recommends the first step that applies. Steps come before those whose result they change: a
    /// sign or another bundle changes every value, a constraint the gains, the gains come before
    /// phases and couplings.
    ///
    /// 1. Reverse a channel whose sign is doubtful.
    /// 2. Reject the physics models that are suggested as outliers.
    /// 3. Constrain responses, if none are constrained.
    /// 4. Resolve a gain conflict.
    /// 5. Correct the phase, if it is not corrected, or if held delays are not matched.
    /// 6. Use worthwhile couplings, or switch couplings off that are not worth it or make poles
    ///    within the band unstable.
    /// 7. Export.
    pub(super) fn new(state: &State, shown: &ConditionAnalysis) -> Self {
        // Step 1.
        let reversed = shown
            .doubts
            .iter()
            .find_map(|doubt| doubt.channel_to_reverse());
        if let Some(channel) = reversed {
            return Self::reverse_channel(state, channel);
        }
        // Step 2.
        let open = state.open_suggestions(shown);
        if !open.is_empty() {
            return Self::reject_suggested(state, &open);
        }
        // Step 3.
        if shown.held().marked().next().is_none() {
            return Self::without_note(vec![Step::new(
                "Hold the on-axis responses",
                Edit::ConstrainOnAxis,
            )]);
        }
        // Step 4.
        if !shown.gains.matched {
            return Self::without_note(gain_steps(state, shown));
        }
        // Step 5.
        let phase = state.study.settings.phase;
        if phase == PhaseCorrection::None || !shown.delays.matched {
            return Self::without_note(phase_steps(state, shown));
        }
        // Step 6.
        if let Some(advice) = Self::on_couplings(state) {
            return advice;
        }
        // Step 7.
        let mut steps = vec![Step::new("Export corrections…", export())];
        if phase == PhaseCorrection::Lead {
            // A lead makes up for a lag, whose possible causes are among the reasons.
            steps.push(Step::reasons());
        }
        Self::without_note(steps)
    }

    fn reverse_channel(state: &State, channel: Channel) -> Self {
        let (label, command) = sign_reversal_entry(state, channel, Some(SignRole::Identified));
        let (inputs, outputs) = state.dataset().input_and_output_names();
        let name = channel.name(&inputs, &outputs);
        Self {
            steps: vec![Step::new(label, command), Step::reasons()],
            note: format!("sign of {name} seems reversed"),
        }
    }

    fn reject_suggested(state: &State, open: &[String]) -> Self {
        let condition = state.condition();
        let models = condition.bundle(BundleKind::Physics).len();
        Self {
            steps: vec![Step::new(
                format!("Reject {} suggested", open.len()),
                Edit::reject_physics(condition.id(), open),
            )],
            note: format!("of {models} models, as a first step"),
        }
    }

    /// Recommends using worthwhile couplings, or switching off couplings that are not worth it or
    /// make poles within the band unstable; `None` if neither applies.
    fn on_couplings(state: &State) -> Option<Self> {
        let inspect = Step::new(
            INSPECT,
            Command::Layout(LayoutCommand::ShowView(View::Couplings)),
        );
        if let Some((assessment, cost)) = offered_couplings(state) {
            let use_them = Step::new(
                USE_COUPLINGS,
                setting_table::COUPLINGS.to(assessment.couplings),
            );
            return Some(Self {
                steps: vec![use_them, inspect],
                note: off_axis_note(cost.without, cost.with),
            });
        }
        let used = used_couplings(state)?;
        let cost = used.deciding_cost();
        if cost.is_worth_it() && used.unstable_in_band() == 0 {
            return None;
        }
        let switch_off = Step::new(
            "Switch couplings off",
            setting_table::COUPLINGS.to(CouplingCorrection::None),
        );
        Some(Self {
            steps: vec![switch_off, inspect],
            note: off_axis_note(cost.with, cost.without),
        })
    }
}

/// Formats the mean J of the off-axis responses before and after the step, as "off-axis J 41→12";
/// empty if it is undefined.
fn off_axis_note(before: AxisCost, after: AxisCost) -> String {
    match (before.others, after.others) {
        (Some(before), Some(after)) => {
            format!("off-axis J {}→{}", telling(before, 0), telling(after, 0))
        }
        _ => String::new(),
    }
}

/// Returns the command that opens the export form.
pub(super) fn export() -> Command {
    Command::Form(FormCommand::ShowForm(Some(FormKind::Export)))
}

fn release_step(state: &State, pair: Pair) -> Step {
    Step::new(
        format!("Release {}", unbroken(&state.dataset().pair_name(pair))),
        Edit::Hold(pair, false),
    )
}

/// Returns the steps that resolve a gain conflict: widen a bound, release a response, or show the
/// reasons.
fn gain_steps(state: &State, shown: &ConditionAnalysis) -> Vec<Step> {
    let mut steps = Vec::new();
    if let Some(remedy) = &shown.gains.remedy {
        if let Some(range) = widened(remedy, shown) {
            steps.push(Step::new(
                "Widen the bound",
                setting_table::GAIN_BOUNDS.to(range),
            ));
        }
        // `free` lists the responses whose release alone resolves the conflict.
        if let Some(pair) = remedy.free.first() {
            steps.push(release_step(state, *pair));
        }
    }
    steps.push(Step::reasons());
    steps
}

/// Returns the gain bounds with the upper or the lower bound replaced by the remedy; `None` if the
/// remedy changes neither.
fn widened(remedy: &Remedy, shown: &ConditionAnalysis) -> Option<Value> {
    let bounds = shown.gain_bounds();
    if let Some(upper) = remedy.upper {
        return Some(Value::Range([bounds.lower, upper]));
    }
    let lower = remedy.lower?;
    Some(Value::Range([lower, bounds.upper]))
}

fn phase_step(phase: PhaseCorrection) -> Step {
    Step::new(phase_step_label(phase), setting_table::PHASE.to(phase))
}

/// Returns the steps to take while the phase is uncorrected or not matched.
fn phase_steps(state: &State, shown: &ConditionAnalysis) -> Vec<Step> {
    match state.study.settings.phase {
        PhaseCorrection::None => vec![phase_step(PhaseCorrection::Delay)],
        PhaseCorrection::Delay => vec![phase_step(PhaseCorrection::Lead), Step::reasons()],
        PhaseCorrection::Lead => {
            let mut steps = Vec::new();
            if let Some(remedy) = &shown.delays.remedy
                && let Some(pair) = remedy.free.first()
            {
                steps.push(release_step(state, *pair));
            }
            steps.push(Step::reasons());
            steps
        }
    }
}
