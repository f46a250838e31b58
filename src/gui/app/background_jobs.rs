//! The window's background jobs: the continuously updated analysis ("live analysis") and all
//! others. The functions called by [`BackgroundJobs::start`] list every kind of job with its tools,
//! its trigger (often in `wanted_jobs.rs`) and its destination. The *tools* are kept from job to
//! job: an engine with its caches, an executor that uses all cores, or nothing.
//!
//! A kind's *report* is its displayed progress. The *withdrawal* of a kind with its own trigger
//! resets the trigger after a stop. A kind with an *own stop* is not stopped with the others while
//! a view in front has a *Stop* for it.
//!
//! The kinds share a thread pool. Order of urgency, and its reasons:
//!
//! | class | kinds                                           | reason                            |
//! |-------|-------------------------------------------------|-----------------------------------|
//! | live  | live analysis                                   | follows every drag                |
//! | short | curves, modes                                   | first picture of the condition    |
//! | short | assessment, across conditions                   | tables and plots in visible views |
//! | short | trade-off of α                                  | plot beside its slider            |
//! | short | requirements                                    | tables and plots in visible views |
//! | short | dry run of an export (`export_plans`)           | list of files in the dialog       |
//! | short | test input (`test_answers`)                     | time responses in visible views   |
//! | short | record history, simulation                      | time responses in visible views   |
//! | long  | costs of constraining and releasing (`toggles`) | seconds; hints beside the matrix  |
//! | long  | variants, proofs                                | complete the displayed results    |
//! | long  | couplings, physics parameters                   | views that show their progress    |
//! | long  | held-out records (`time_histories`)             | a view that shows its progress    |
//! | long  | dry run of a report (`report_contents`)         | requested explicitly; seconds     |
//! | long  | report                                          | requested explicitly; seconds     |
//! | long  | error bars                                      | repeated after every change       |
//! | long  | identification                                  | minutes; keeps a thread longest   |

use std::io;
use std::rc::Rc;
use std::sync::Arc;

use gdcm_model::executor::Executor;
use gdcm_study::Engine;
use gdcm_study::jobs::analysis_jobs::ProofJob;
use gdcm_study::stages::known_models::KnownModels;

use super::GdcmApp;
use super::job_kind::{AnyJobKind, JobKind, JobKinds};
use super::job_pool::{JobPool, LaneClass};
use super::job_queue::JobQueue;
use super::threads::ReplySender;
use super::wanted_jobs::{
    curves_job, keep_wanted, needs, proof_jobs, toggles_job, trade_off_job, uncertainty_job,
};
use crate::executor::Pool;
use crate::gui::state::background::Background;
use crate::gui::state::view::View;
use crate::gui::views::need::Need;

/// Creates an engine: for the first job of a kind, and after a panic, which may leave the old
/// engine's caches inconsistent.
pub type EngineMaker = Arc<dyn Fn() -> Engine + Send + Sync>;

/// Returns the jobs of a kind that the visible views need.
macro_rules! needed_jobs {
    ($app:expr, $kind:ident) => {
        $app.work
            .needs
            .iter()
            .filter_map(|need| {
                if let Need::$kind(job) = need {
                    Some(job.clone())
                } else {
                    None
                }
            })
            .collect::<Vec<_>>()
    };
}

/// All kinds of jobs and their thread pool. Dropping them cancels the running jobs and ends the
/// threads without waiting.
pub(super) struct BackgroundJobs {
    /// Job kinds, the most urgent first.
    kinds: Rc<Vec<Box<dyn AnyJobKind>>>,
    /// Held only because dropping it would end the threads.
    _pool: JobPool,
}

impl BackgroundJobs {
    /// Starts the thread pool, with a queue for each kind of job.
    ///
    /// # Errors
    /// The operating system's reason, if a thread cannot be started.
    pub(super) fn start(make_engine: &EngineMaker, replies: &ReplySender) -> io::Result<Self> {
        let pool = JobPool::start()?;
        let engines = Engines {
            make: Arc::clone(make_engine),
            known: KnownModels::default(),
        };
        let mut kinds = JobKinds::new(&pool, replies);
        add_live_analysis(&mut kinds, &engines);
        add_short_kinds(&mut kinds, &engines);
        add_long_kinds(&mut kinds, &engines);
        let kinds = Rc::new(kinds.into_kinds());
        Ok(Self { kinds, _pool: pool })
    }

    /// Allows stopped jobs to start again.
    pub(super) fn resume(&self) {
        for kind in self.kinds.iter() {
            kind.resume();
        }
    }

    /// Returns the progress of the running and waiting jobs.
    pub(super) fn running_work(&self) -> Background {
        let mut background = Background::default();
        for kind in self.kinds.iter() {
            kind.report(&mut background);
        }
        background
    }
}

/// Makes the engines for the kinds of jobs that need one.
struct Engines {
    make: EngineMaker,
    known: KnownModels,
}

impl Engines {
    /// Returns an engine maker for kinds of jobs that work on the current study; their engines
    /// share each model's responses.
    fn sharing(&self) -> impl Fn() -> Engine + Send + Sync + 'static + use<> {
        let make = Arc::clone(&self.make);
        let known = self.known.clone();
        move || make().sharing(&known)
    }

    /// Returns an engine maker for variants: their engines share no responses, since the band may
    /// differ.
    fn separate(&self) -> impl Fn() -> Engine + Send + Sync + 'static + use<> {
        let make = Arc::clone(&self.make);
        move || make()
    }
}

/// Returns the tools for jobs without an engine that use all cores.
fn cores() -> Box<dyn Executor> {
    Box::new(Pool)
}

/// Returns the tools for jobs that need none and use a single core.
fn no_tools() {}

/// Adds the live analysis, the most urgent kind.
fn add_live_analysis(kinds: &mut JobKinds<'_>, engines: &Engines) {
    let analyses = JobKind::new(
        |app| app.work.live_job.iter().cloned().collect(),
        GdcmApp::show_analysis,
    )
    .with_report(|queue, background| background.analysis = queue.progress())
    .with_withdrawal(GdcmApp::live_analysis_stopped);
    kinds.add(LaneClass::Live, engines.sharing(), analyses);
}

/// Adds the kinds whose jobs usually end within a second, the most urgent first.
fn add_short_kinds(kinds: &mut JobKinds<'_>, engines: &Engines) {
    let curves = JobKind::new(|app| vec![curves_job(&app.state)], GdcmApp::take_curves)
        .with_report(|queue, background| background.curves = queue.progress());
    kinds.add(LaneClass::Short, engines.sharing(), curves);
    let modes = JobKind::new(
        |app| needed_jobs!(app, Modes),
        |app, job, modes| app.state.results.modes = Some((job, modes)),
    );
    kinds.add(LaneClass::Short, no_tools, modes);
    let assessments = JobKind::new(
        |app| needed_jobs!(app, Assessment),
        |app, job, table| app.state.results.assessment = Some((job, table)),
    );
    kinds.add(LaneClass::Short, no_tools, assessments);
    let across = JobKind::new(
        |app| needed_jobs!(app, Across),
        |app, job, curves| app.state.results.across = Some((job, curves)),
    );
    kinds.add(LaneClass::Short, no_tools, across);
    let trade_offs = JobKind::new(
        |app| trade_off_job(&app.state).into_iter().collect(),
        |app, job, trade_off| app.state.results.trade_off = Some((job, trade_off)),
    )
    .without_report();
    kinds.add(LaneClass::Short, no_tools, trade_offs);
    let requirements = JobKind::new(
        |app| needed_jobs!(app, Requirements),
        |app, job, tables| app.state.results.requirements = Some((job, tables)),
    );
    kinds.add(LaneClass::Short, cores, requirements);
    let export_plans = JobKind::new(
        |app| app.state.export_plan_job().into_iter().collect(),
        GdcmApp::take_export_plan,
    )
    .without_report();
    kinds.add(LaneClass::Short, no_tools, export_plans);
    let test_answers = JobKind::new(
        |app| needed_jobs!(app, TestAnswers),
        |app, job, answers| app.state.results.test_answers = Some((job, answers)),
    );
    kinds.add(LaneClass::Short, cores, test_answers);
    let record_history = JobKind::new(
        |app| needed_jobs!(app, RecordHistory),
        |app, job, history| app.state.results.record_history = Some((job, history)),
    );
    kinds.add(LaneClass::Short, cores, record_history);
    let simulations = JobKind::new(
        |app| {
            let jobs = needed_jobs!(app, Simulation);
            keep_wanted(&mut app.state.results.simulations, &jobs);
            jobs
        },
        |app, job, outcome| app.state.results.simulations.push((job, outcome)),
    );
    kinds.add(LaneClass::Short, cores, simulations);
}

/// Adds the kinds whose jobs take seconds to minutes, the most urgent first.
fn add_long_kinds(kinds: &mut JobKinds<'_>, engines: &Engines) {
    add_long_kinds_of_results(kinds, engines);
    let couplings = JobKind::new(
        |app| needed_jobs!(app, Couplings),
        |app, job, assessed| {
            app.state.results.couplings = assessed.map(|assessed| (job, assessed));
        },
    )
    .with_report(|queue, background| background.couplings = queue.progress());
    kinds.add(LaneClass::Long, engines.sharing(), couplings);
    let physics = JobKind::new(
        |app| needed_jobs!(app, Physics),
        |app, job, assessed| app.state.results.physics = Some((job, assessed)),
    )
    .with_report(|queue, background| background.physics = queue.progress());
    kinds.add(LaneClass::Long, engines.sharing(), physics);
    let time_histories = JobKind::new(
        |app| needed_jobs!(app, TimeHistories),
        |app, job, histories| app.state.results.time_histories = Some((job, histories)),
    )
    .with_report(|queue, background| background.time_histories = queue.progress());
    kinds.add(LaneClass::Long, cores, time_histories);
    let report_contents = JobKind::new(
        |app| app.report_contents_job().into_iter().collect(),
        GdcmApp::take_report_contents,
    )
    .with_report(|queue, background| background.report_contents = queue.progress());
    kinds.add(LaneClass::Long, engines.sharing(), report_contents);
    let reports = JobKind::new(
        |app| app.work.report_job.iter().cloned().collect(),
        GdcmApp::report_written,
    )
    .with_report(|queue, background| background.report = queue.progress())
    .with_withdrawal(GdcmApp::give_up_report);
    kinds.add(LaneClass::Long, engines.sharing(), reports);
    let bars = JobKind::new(
        |app| uncertainty_job(&app.state).into_iter().collect(),
        |app, job, uncertainty| app.state.results.uncertainty = Some((job, uncertainty)),
    )
    .with_report(|queue, background| background.error_bars = queue.progress());
    kinds.add(LaneClass::Long, engines.sharing(), bars);
    let identifications = JobKind::new(
        |app| app.state.records.by_urgency(app.state.condition().id()),
        GdcmApp::identified,
    )
    .with_report(|queue, background| background.identification = queue.progress())
    .with_withdrawal(GdcmApp::stop_identifying)
    .with_own_stop(|app| app.state.shows_view(View::Records));
    kinds.add(LaneClass::Long, cores, identifications);
}

/// Adds the long kinds that complete the displayed results, the most urgent first.
fn add_long_kinds_of_results(kinds: &mut JobKinds<'_>, engines: &Engines) {
    let toggles = JobKind::new(
        |app| toggles_job(&app.state).into_iter().collect(),
        |app, job, toggles| {
            app.state.results.toggles = toggles.map(|toggles| (job, Arc::new(toggles)));
        },
    )
    .with_report(|queue, background| background.toggles = queue.progress().is_some());
    kinds.add(LaneClass::Long, no_tools, toggles);
    let variants = JobKind::new(
        |app| {
            let jobs = needed_jobs!(app, Variant);
            keep_wanted(&mut app.state.results.variants, &jobs);
            jobs
        },
        |app, job, analysis| app.state.results.variants.push((job, analysis)),
    );
    kinds.add(LaneClass::Long, engines.separate(), variants);
    let proofs =
        JobKind::new(|app| proof_jobs(&app.state), GdcmApp::take_proof).with_report(report_proofs);
    kinds.add(LaneClass::Long, no_tools, proofs);
}

fn report_proofs(queue: &JobQueue<ProofJob>, background: &mut Background) {
    let unproven = queue.unfinished().into_iter();
    background.proofs = unproven.map(|job| job.problem).collect();
}

impl GdcmApp {
    /// Requests exactly the jobs that the current display needs.
    pub(super) fn want_jobs(&mut self) {
        self.work.needs = needs(&self.state);
        let kinds = Rc::clone(&self.work.jobs.kinds);
        for kind in kinds.iter() {
            kind.want(self);
        }
    }

    /// Stops every job, except those with their own *Stop* in a view in front.
    pub(super) fn stop_jobs(&mut self) {
        let kinds = Rc::clone(&self.work.jobs.kinds);
        for kind in kinds.iter() {
            kind.stop(self);
        }
    }
}
