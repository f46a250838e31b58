//! Long computations, and computations that fail.

use gdcm::gui::commands::form::FormCommand;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, Once};

use gdcm::gui::app::faults;
use gdcm::gui::commands::output::OutputCommand;
use gdcm::gui::state::view::View;
use gdcm_method::correction::{Outcome, ProofBudget};
use gdcm_model::dataset::Condition;
use gdcm_model::executor::{Executor, Task};
use gdcm_model::progress::Unobserved;
use gdcm_study::stages::engine::LIVE_PROOF;
use gdcm_study::{Engine, Study};

use super::views::give;
use super::views::show;
use super::*;

/// Executor that works like the program's, but on request panics inside a task or keeps the tasks
/// waiting.
#[derive(Clone, Default)]
struct Trap {
    panics: Arc<AtomicBool>,
    closed: Arc<(Mutex<bool>, Condvar)>,
}

impl Trap {
    fn setup(&self) -> Setup {
        let trap = self.clone();
        Setup {
            engine: Arc::new(move || Engine::with_executor(Box::new(trap.clone()))),
            ..Setup::default()
        }
    }

    /// Like [`Trap::setup`], but with results of the example already cached, so that no background
    /// job runs into the trap before the first results.
    fn warm_setup(&self) -> Setup {
        let trap = self.clone();
        Setup {
            engine: Arc::new(move || WARM.fork(Box::new(trap.clone()))),
            ..Setup::default()
        }
    }

    fn close(&self) -> Closed<'_> {
        *self.closed.0.lock().unwrap() = true;
        Closed(self)
    }
}

/// Opens the trap when dropped, even if the test fails, because waiting tasks occupy threads that
/// other tests need.
struct Closed<'a>(&'a Trap);

impl Drop for Closed<'_> {
    fn drop(&mut self) {
        *self.0.closed.0.lock().unwrap() = false;
        self.0.closed.1.notify_all();
    }
}

impl Executor for Trap {
    fn carry_out(&self, mut tasks: Vec<Task<'_>>) {
        drop(
            self.closed
                .1
                .wait_while(self.closed.0.lock().unwrap(), |closed| *closed),
        );
        if self.panics.swap(false, Ordering::Relaxed) {
            tasks.push(Box::new(|| panic!("a pivot that cannot be")));
        }
        Pool.carry_out(tasks);
    }
}

/// Records the locations of panics, as the program does, in addition to the panic handler of the
/// tests. Every test that panics on purpose calls it first: the records are found by their message,
/// so a panic without a record would take that of another test.
fn note_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            faults::record_panic(panic);
            before(panic);
        }));
    });
}

fn set_alpha(window: &mut Window, alpha: f64) {
    slide(window, "α gains", alpha);
    window.run_steps(2);
}

/// Draws frames until the error bars are available too and nothing runs, so that the next task
/// belongs to the live analysis. Error bars are requested only once the results are drawn, so
/// [`wait_for_background`] alone may return before.
fn wait_for_idle(window: &mut Window) {
    wait_for_bars(window);
    wait_for_background(window);
}

#[test]
fn a_panic_while_computing_is_told_with_what_to_send_and_the_study_stays() {
    note_panics();
    let trap = Trap::default();
    let mut window = window_with(example(), trap.warm_setup());
    wait_for_idle(&mut window);
    let before = state(&window).results.received;
    let places = fixed_places(&window);
    trap.panics.store(true, Ordering::Relaxed);
    set_alpha(&mut window, 12.5);
    wait_until(&mut window, "the fault is told", |window| {
        bar_codes(window).contains(&"fault")
    });
    assert_eq!(fixed_places(&window), places, "the fault moves nothing");
    let Some(MessageBar::Fault(report)) = state(&window).notices.bars().next() else {
        panic!("{:?}", bar_codes(&window))
    };
    assert!(
        report.fault.contains("tests/suite/window/computing.rs:"),
        "{report:?}"
    );
    assert_eq!(report.work, "the computation");
    for part in [
        report.fault.as_str(),
        report.version.as_str(),
        report.dataset.as_str(),
    ] {
        window.get_by_label_contains(part);
    }
    assert!(!state(&window).results.is_waiting() && state(&window).results.received == before);
    window.get_by_label_contains(&state(&window).after_stop().text);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.gdcm-study.json");
    save_as(&mut window, &path);
    assert_eq!(
        open_study(&path).unwrap().study.settings.alpha_gain,
        12.5,
        "the study can be saved"
    );
    set_alpha(&mut window, 3.0);
    settle(&mut window);
    assert_eq!(
        state(&window).analysis().unwrap().study.settings.alpha_gain,
        3.0,
        "and edited, with a new engine"
    );
    let bar = state(&window).notices.bars().next().cloned();
    give(
        &mut window,
        FormCommand::CloseBar(bar.expect("the fault is still told")),
    );
    assert!(bar_codes(&window).is_empty());
}

#[test]
fn after_a_panic_the_same_can_be_computed_again() {
    note_panics();
    let trap = Trap::default();
    let mut window = window_with(example(), trap.warm_setup());
    wait_for_idle(&mut window);
    trap.panics.store(true, Ordering::Relaxed);
    set_alpha(&mut window, 12.5);
    wait_until(&mut window, "the fault is told", |window| {
        window.query_by_label("Compute again").is_some()
    });
    click(&mut window, "Compute again");
    assert_eq!(
        state(&window).analysis().unwrap().study.settings.alpha_gain,
        12.5
    );
    assert!(bar_codes(&window).is_empty());
}

#[test]
fn a_panic_over_the_first_results_leaves_a_window_that_can_open_another_file() {
    note_panics();
    let trap = Trap::default();
    trap.panics.store(true, Ordering::Relaxed);
    let build = |creation: &mut eframe::CreationContext<'static>| {
        GdcmApp::with_setup(&creation.egui_ctx, example(), trap.setup())
            .expect("a thread can be started")
    };
    let mut window = Harness::builder()
        .with_size(vec2(1600.0, 1000.0))
        .build_eframe(build);
    wait_until(&mut window, "the fault is told", |window| {
        window.query_by_label("Compute again").is_some()
    });
    window
        .input_mut()
        .dropped_files
        .push(Arc::new(files::Dropped(files::small_dataset())));
    window.run_steps(2);
    settle(&mut window);
    assert_eq!(state(&window).dataset().conditions().len(), 2);
    assert!(state(&window).shown().is_some());
}

#[test]
fn results_of_two_generations_of_settings_are_told_apart() {
    let trap = Trap::default();
    let mut window = window_with(example(), trap.setup());
    assert!(window.query_by_label("from older settings").is_none());
    let closed = trap.close();
    set_alpha(&mut window, 12.5);
    wait_until(&mut window, "the condition shown is ahead", |window| {
        state(window).results.first_is_ahead()
    });
    window.get_by_label("from older settings");
    window.get_by_label_contains("11 · from older settings");
    let scheduled = drawn(&window, CurveRole::Scheduled);
    assert!(
        scheduled.label.ends_with("older settings"),
        "{}",
        scheduled.label
    );
    drop(closed);
    settle(&mut window);
    assert!(window.query_by_label("from older settings").is_none());
    assert!(
        drawn(&window, CurveRole::Scheduled)
            .label
            .ends_with("scheduled")
    );
}

#[test]
fn quitting_does_not_wait_for_what_is_being_computed() {
    let trap = Trap::default();
    let mut window = window_with(example(), trap.setup());
    let closed = trap.close();
    set_alpha(&mut window, 12.5);
    wait_until(&mut window, "it computes", |window| {
        state(window).results.first_is_ahead()
    });
    let start = Instant::now();
    drop(window);
    // Without cancellation, the running computation would never end.
    assert!(start.elapsed() < Duration::from_secs(30));
    drop(closed);
}

#[test]
fn the_costs_of_toggles_stay_where_nothing_that_they_depend_on_changes() {
    let mut window = window();
    wait_for_toggles(&mut window);
    let costs = |window: &Window| {
        state(window)
            .results
            .toggles
            .as_ref()
            .map(|(_, toggles)| Arc::clone(toggles))
            .unwrap()
    };
    let before = costs(&window);
    click(&mut window, "Edit");
    window
        .get_by_label_contains("Leave this condition out of the schedule")
        .click();
    settle(&mut window);
    assert!(state(&window).toggles().is_some() && Arc::ptr_eq(&costs(&window), &before));
    set_alpha(&mut window, 12.5);
    settle(&mut window);
    wait_for_toggles(&mut window);
    assert!(
        !Arc::ptr_eq(&costs(&window), &before),
        "those of other problems are others"
    );
}

#[test]
fn a_long_computation_can_be_stopped_and_taken_up_again() {
    let trap = Trap::default();
    let mut window = window_with(example(), trap.warm_setup());
    let before = state(&window).results.received;
    unfold_settings(&mut window, true);
    // The closed trap prevents any computation before the click, even on a fast machine.
    let closed = trap.close();
    window
        .get_by_role_and_label(Role::SpinButton, "Frequencies in the band")
        .set_value_accesskit(2000.0);
    window.run_steps(3);
    window.get_by_label("Stop").click();
    window.run_steps(3);
    assert!(state(&window).results.stopped && state(&window).results.received == before);
    window.get_by_label_contains(&state(&window).after_stop().text);
    assert!(
        state(&window).analysis().is_some(),
        "the results there were are still shown"
    );
    drop(closed);
    click(&mut window, "Compute");
    assert!(!state(&window).results.is_behind());
    assert_eq!(
        state(&window)
            .analysis()
            .map(|analysis| analysis.omega.len()),
        Some(2000)
    );
}

#[test]
fn error_bars_tell_how_far_they_are_and_can_be_stopped_and_taken_up_again() {
    fn counts(window: &Window) -> Option<(usize, usize)> {
        let steps = state(window).results.background.error_bars?;
        Some((steps.done, steps.total))
    }

    fn bundles(of: &Condition) -> usize {
        of.bundle(BundleKind::Physics).len() + of.bundle(BundleKind::Identified).len()
    }

    fn copied(window: &mut Window) -> &'static str {
        window
            .state_mut()
            .dispatch(OutputCommand::CopyFigure(View::NetGain));
        state(window).notices.newest().unwrap().code
    }

    let trap = Trap::default();
    let mut window = window_with(example(), trap.setup());
    show(&mut window, View::Evidence);
    unfold_settings(&mut window, true);
    // Five times the usual number of frequencies: the computation lasts longer than the frames
    // until its first progress is visible.
    window
        .get_by_role_and_label(Role::SpinButton, "Frequencies in the band")
        .set_value_accesskit(1000.0);
    settle(&mut window);
    let models: usize = state(&window)
        .dataset()
        .conditions()
        .iter()
        .map(|of| bundles(of))
        .sum();
    wait_until(&mut window, "a part of the error bars", |window| {
        counts(window).is_some_and(|(done, total)| done > 0 && total == 2 * models)
    });
    // With the trap closed, only computations already begun are completed before the click, even on
    // a fast machine.
    let closed = trap.close();
    wait_until(&mut window, "the button", |window| {
        window.query_by_label("Stop").is_some()
    });
    let told = window
        .query_all_by_label_contains(&format!(" of {} steps …", 2 * models))
        .count();
    assert_eq!(told, 2, "in the view that waits for them, and below");
    assert_eq!(copied(&mut window), "numbers-copied-before-error-bars");
    window.get_by_label("Stop").click();
    window.run_steps(3);
    assert!(state(&window).uncertainty().is_none() && counts(&window).is_none());
    assert_eq!(copied(&mut window), "numbers-copied-without-error-bars");
    drop(closed);
    let stopped = state(&window).results.absence_of_error_bars();
    window.get_by_label(&stopped);
    click(&mut window, "Compute");
    wait_for_bars(&mut window);
    assert!(window.query_by_label(&stopped).is_none());
    assert_eq!(copied(&mut window), "numbers-copied");
}

#[test]
fn couplings_tell_how_far_they_are_and_can_be_stopped_and_taken_up_again() {
    fn steps(window: &Window) -> Option<(usize, usize)> {
        let steps = state(window).results.background.couplings?;
        Some((steps.done, steps.total))
    }

    let trap = Trap::default();
    let mut window = window_with(example(), trap.setup());
    settle(&mut window);
    show(&mut window, View::Couplings);
    wait_until(&mut window, "a part of the assessment", |window| {
        steps(window).is_some_and(|(done, _)| done > 0)
    });
    // With the trap closed, the steps after the fits without each condition are not computed before
    // the click, even on a fast machine.
    let closed = trap.close();
    wait_until(&mut window, "the button", |window| {
        window.query_by_label("Stop").is_some()
    });
    assert!(
        state(&window).couplings().is_none()
            && steps(&window).is_some_and(|(done, total)| done < total)
    );
    window.get_by_label("Stop").click();
    wait_until(&mut window, "the end of the work", |window| {
        steps(window).is_none() && state(window).results.background.stopped
    });
    drop(closed);
    click(&mut window, "Compute");
    wait_until(&mut window, "what couplings do", |window| {
        state(window).couplings().is_some()
    });
}

#[test]
fn gains_that_the_answer_leaves_open_are_proven_beside_it() {
    fn is_open(outcome: Outcome) -> bool {
        matches!(outcome, Outcome::NotProven { .. })
    }

    let hasty = ProofBudget {
        work: 0,
        listing: 0,
        ..ProofBudget::default()
    };
    let engine = move || Engine::default().with_proofs_within(hasty);
    let study = Study::new(crate::EXAMPLE.dataset.clone());
    let open = engine().analyze(&study, &Unobserved).unwrap();
    assert!(
        open.conditions
            .values()
            .flatten()
            .any(|condition| is_open(condition.gains.proof.outcome)),
        "nothing to prove"
    );

    let mut window = window_with(
        example(),
        Setup {
            engine: Arc::new(engine),
            ..Setup::default()
        },
    );
    wait_until(&mut window, "every proof", |window| {
        !state(window).results.background.is_busy()
    });
    settle(&mut window);
    window.get_by_label("global optimum ✓");
    let proven = Engine::default().analyze(&study, &Unobserved).unwrap();
    let shown = state(&window).analysis().unwrap();
    for (condition, (beside, alone)) in shown
        .conditions
        .values()
        .zip(proven.conditions.values())
        .enumerate()
    {
        let beside = beside.as_ref().unwrap();
        let alone = alone.as_ref().unwrap();
        assert!(
            !is_open(beside.gains.proof.outcome),
            "condition {condition}"
        );
        assert!(
            !is_open(alone.gains.proof.outcome) && beside.correction == alone.correction,
            "condition {condition}"
        );
    }
    assert_eq!(
        shown.schedule, proven.schedule,
        "what is made from the gains follows them"
    );
}

#[test]
fn the_example_needs_no_proof_beside_the_answer() {
    let study = Study::new(crate::EXAMPLE.dataset.clone());
    let analysis = Engine::default()
        .with_proofs_within(LIVE_PROOF)
        .analyze(&study, &Unobserved)
        .unwrap();
    let proven = analysis
        .conditions
        .values()
        .flatten()
        .filter(|of| matches!(of.gains.proof.outcome, Outcome::Proven { .. }));
    assert_eq!(proven.count(), 11);
}
