//! Long random walk through the window: nothing panics, and the displayed results equal the results
//! of a new computation.

use gdcm::gui::commands::command::Command as Action;
use gdcm::gui::commands::command_table::every_command;
use gdcm::gui::commands::computing::ComputingCommand;
use gdcm::gui::commands::file::FileCommand;
use gdcm::gui::commands::form::FormCommand;
use gdcm::gui::commands::layout::LayoutCommand;
use gdcm::gui::commands::output::OutputCommand;
use gdcm::gui::commands::study::StudyCommand;
use gdcm::gui::state::view::View;
use gdcm_model::progress::Unobserved;
use gdcm_study::Engine;
use gdcm_study::decisions::setting_table;

use super::*;
use crate::synthetic::tries;

/// Number of steps between frames, and between comparisons.
const STEPS_OF_A_FRAME: usize = 4;
const STEPS_OF_A_COMPARISON: usize = 100;

/// Reproducible pseudo-random numbers: the 64-bit linear congruential generator of Knuth's MMIX.
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound
    }
}

/// Returns whether a command stays within the window: it does not access files or the desktop, and
/// does not close the window.
pub(super) fn stays_within(command: &Action) -> bool {
    !matches!(
        command,
        Action::File(FileCommand::Quit)
            | Action::File(FileCommand::Open(_))
            | Action::File(FileCommand::OpenExample(_))
            | Action::File(FileCommand::OpenStudyOf(..))
            | Action::File(FileCommand::SaveStudy)
            | Action::File(FileCommand::AskOpen)
            | Action::Assembling(_)
            | Action::Records(_)
            | Action::File(FileCommand::AskSaveStudy)
            | Action::Output(OutputCommand::AskSaveTable(_))
            | Action::Output(OutputCommand::AskSaveShownTable(_))
            | Action::Output(OutputCommand::AskExportFolder)
            | Action::Computing(ComputingCommand::StopComputing)
            | Action::Layout(LayoutCommand::SetTheme(_))
    )
}

fn random_command(window: &Window, dice: &mut Dice) -> Option<Action> {
    match dice.below(12) {
        0 => Some(
            setting_table::ALPHA_GAIN
                .to(10f64.powi(dice.below(5) as i32 - 2))
                .into(),
        ),
        1 => Some(setting_table::POINTS.to(20 + dice.below(60)).into()),
        2 => Some(Action::Study(StudyCommand::Undo)),
        3 => Some(Action::Study(StudyCommand::Redo)),
        _ => {
            let mut entries = every_command(state(window));
            entries.retain(|entry| entry.enabled && stays_within(&entry.command));
            let chosen = dice.below(entries.len().max(1));
            entries.into_iter().nth(chosen).map(|entry| entry.command)
        }
    }
}

fn assert_fresh(window: &Window, step: usize) {
    let shown = state(window).analysis().expect("there are results");
    let fresh = Engine::default()
        .analyze(&state(window).study, &Unobserved)
        .unwrap();
    assert_eq!(shown.study, state(window).study, "step {step}");
    for (id, outcome) in &fresh.conditions {
        match (outcome, &shown.conditions[id]) {
            (Ok(fresh), Ok(shown)) => {
                assert_eq!(
                    fresh.comparison, shown.comparison,
                    "step {step}, condition {id}"
                );
                // A later optimality proof gives the same optimum or a better value, within this
                // tolerance.
                let same = (fresh.gains.objective - shown.gains.objective).abs()
                    <= 1e-6 * (1.0 + fresh.gains.objective);
                assert!(
                    same,
                    "step {step}, condition {id}: {} {}",
                    fresh.gains.objective, shown.gains.objective
                );
                assert_eq!(fresh.delays, shown.delays, "step {step}, condition {id}");
            }
            (Err(fresh), Err(shown)) => assert_eq!(fresh, shown, "step {step}, condition {id}"),
            _ => panic!("step {step}, condition {id}: a result on one side only"),
        }
    }
}

#[test]
fn random_commands_never_panic_and_leave_what_a_fresh_computation_gives() {
    let mut window = window();
    let mut dice = Dice(20_261_122);
    for step in 1..=tries(400, 2000) {
        if let Some(command) = random_command(&window, &mut dice) {
            window.state_mut().dispatch(command);
        }
        // Close any form, which would block the other controls.
        window.state_mut().dispatch(FormCommand::ShowForm(None));
        if step % STEPS_OF_A_FRAME == 0 {
            window.run_steps(1);
        }
        if step % STEPS_OF_A_COMPARISON == 0 {
            // Show the Bode view, because plots compute their curves only while they are visible.
            window
                .state_mut()
                .dispatch(LayoutCommand::ShowView(View::Bode));
            settle(&mut window);
            assert_fresh(&window, step);
        }
    }
}
