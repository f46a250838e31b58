//! What the window has done beside the live answer: every kind of job stands in one table, [`BackgroundJobs::start`], with what it
//! works with, when it is asked for and where its output goes.

use std::io;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::Context;
use gdcm_core::correction::Outcome;
use gdcm_core::executor::Executor;
use gdcm_core::study::{
    AssessmentJob, CURVE_POINTS, CurvesJob, Engine, Job, ModesJob, ProofJob, TogglesJob, UncertaintyJob, display_band,
};

use super::fault::{Fault, caught};
use super::job_queue::JobQueue;
use super::window::GdcmApp;
use crate::executor::Pool;
use crate::view::across_scene::across_job;
use crate::view::arrangement::View;
use crate::view::assessment_scene::assessment_choice;
use crate::view::compare_scene::variant_jobs;
use crate::view::records::simulation_jobs;
use crate::view::results::{Background, Results};
use crate::view::state::State;

/// Makes an engine, at the start and anew after a panic, which may leave its caches half made.
pub type EngineMaker = Arc<dyn Fn() -> Engine + Send + Sync>;

/// What a thread has the window do with what it made.
pub(super) type Reply = Box<dyn FnOnce(&mut GdcmApp) + Send>;

/// Where threads send their replies; the window wakes for each.
#[derive(Clone)]
pub(super) struct ReplySender {
    sender: Sender<Reply>,
    ctx: Context,
}

impl ReplySender {
    pub(super) fn new(ctx: &Context) -> (Self, Receiver<Reply>) {
        let (sender, receiver) = channel();
        (Self { sender, ctx: ctx.clone() }, receiver)
    }

    pub(super) fn send(&self, reply: impl FnOnce(&mut GdcmApp) + Send + 'static) {
        // The window is gone when nobody listens; the threads end soon after.
        let _ = self.sender.send(Box::new(reply));
        self.ctx.request_repaint();
    }

    /// Does a single piece of work in a thread of its own, and has the window take what comes of it.
    pub(super) fn in_thread<T: Send + 'static>(
        &self,
        name: &str,
        work: impl FnOnce() -> T + Send + 'static,
        take: impl FnOnce(&mut GdcmApp, Result<T, Fault>) + Send + 'static,
    ) -> io::Result<()> {
        let replies = self.clone();
        let work = move || {
            let made = caught(work);
            replies.send(move |app| take(app, made));
        };
        std::thread::Builder::new().name(name.to_owned()).spawn(work).map(drop)
    }
}

/// One kind of job.
struct JobKind<J: Job> {
    /// The jobs that what is shown needs now, the most urgent first; one that is not needed any more is given up.
    wanted: fn(&mut GdcmApp) -> Vec<J>,
    /// Takes what a job has made.
    take: fn(&mut GdcmApp, J, J::Output),
    /// Tells what is under way.
    tell: fn(&JobQueue<J>, &mut Background),
    /// What a stop or a fault does to what a button of its own asked for: that button, not "Compute", begins it again.
    withdraw: Option<fn(&mut GdcmApp)>,
}

impl<J: Job> Clone for JobKind<J> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<J: Job> Copy for JobKind<J> {}

/// A kind with its queue.
struct Registered<J: Job> {
    kind: JobKind<J>,
    queue: JobQueue<J>,
}

/// The same, whatever the job.
trait AnyKind {
    fn want(&self, app: &mut GdcmApp);
    fn stop(&self, app: &mut GdcmApp);
    fn resume(&self);
    fn tell(&self, background: &mut Background);
}

impl<J: Job> AnyKind for Registered<J> {
    fn want(&self, app: &mut GdcmApp) {
        self.queue.want((self.kind.wanted)(app));
    }

    fn stop(&self, app: &mut GdcmApp) {
        self.queue.stop();
        self.kind.withdraw.iter().for_each(|withdraw| withdraw(app));
    }

    fn resume(&self) {
        self.queue.resume();
    }

    fn tell(&self, background: &mut Background) {
        (self.kind.tell)(&self.queue, background);
        background.stopped |= self.kind.withdraw.is_none() && self.queue.is_stopped();
    }
}

/// All kinds, each with a thread of its own. Dropping it ends them, and waits for none.
pub(super) struct BackgroundJobs {
    kinds: Rc<Vec<Box<dyn AnyKind>>>,
}

impl BackgroundJobs {
    /// Starts the threads.
    pub(super) fn start(make_engine: &EngineMaker, replies: &ReplySender) -> io::Result<Self> {
        let mut kinds = Registry { kinds: Vec::new(), replies };
        let engine = || {
            let make = Arc::clone(make_engine);
            move || make()
        };
        kinds.add(
            "curves",
            engine(),
            JobKind {
                wanted: |app| vec![curves_job(&app.state)],
                take: |app, job, curves| app.take_curves(job, curves),
                tell: |queue, background| background.curves = queue.progress(),
                withdraw: None,
            },
        )?;
        kinds.add(
            "toggles",
            || (),
            JobKind {
                wanted: |app| toggles_job(&app.state).into_iter().collect(),
                take: |app, job, toggles| {
                    app.state.results.toggles = toggles.map(|toggles| (job, Arc::new(toggles)));
                },
                tell: |queue, background| background.toggles = queue.progress().is_some(),
                withdraw: None,
            },
        )?;
        kinds.add(
            "proofs",
            || (),
            JobKind {
                wanted: |app| proof_jobs(&app.state),
                // A problem without an answer has been told by the live answer.
                take: |app, job: ProofJob, solution| {
                    solution
                        .into_iter()
                        .for_each(|solution| app.analysis.take_proof(Arc::clone(&job.problem), solution));
                },
                tell: |queue, background| {
                    background.proofs = queue.unfinished().into_iter().map(|job| job.problem).collect();
                },
                withdraw: None,
            },
        )?;
        kinds.add(
            "error bars",
            engine(),
            JobKind {
                wanted: |app| uncertainty_job(&app.state).into_iter().collect(),
                take: |app, job, uncertainty| app.state.results.uncertainty = Some((job, uncertainty)),
                tell: |queue, background| background.bars = queue.progress(),
                withdraw: None,
            },
        )?;
        kinds.add(
            "modes",
            || (),
            JobKind {
                wanted: |app| shown_in(app, View::Poles, |state| ModesJob { condition: Arc::clone(state.condition()) }),
                take: |app, job, modes| app.state.results.modes = Some((job, modes)),
                tell: tell_view,
                withdraw: None,
            },
        )?;
        kinds.add(
            "assessment",
            || (),
            JobKind {
                wanted: |app| assessment_job(&app.state).into_iter().collect(),
                take: |app, job, table| app.state.results.assessment = Some((job, table)),
                tell: tell_view,
                withdraw: None,
            },
        )?;
        kinds.add(
            "conditions",
            || (),
            JobKind {
                wanted: |app| shown_in(app, View::Across, across_job),
                take: |app, job, curves| app.state.results.across = Some((job, curves)),
                tell: tell_view,
                withdraw: None,
            },
        )?;
        kinds.add(
            "variants",
            engine(),
            JobKind {
                wanted: |app| all_shown_in(app, View::Compare, variant_jobs, |results| &mut results.variants),
                take: |app, job, analysis| app.state.results.variants.push((job, analysis)),
                tell: tell_view,
                withdraw: None,
            },
        )?;
        kinds.add(
            "simulation",
            pool,
            JobKind {
                wanted: |app| all_shown_in(app, View::Records, simulation_jobs, |results| &mut results.simulations),
                take: |app, job, outcome| app.state.results.simulations.push((job, outcome)),
                tell: tell_view,
                withdraw: None,
            },
        )?;
        kinds.add(
            "report",
            engine(),
            JobKind {
                wanted: |app| app.reporting.clone().into_iter().collect(),
                take: |app, job, outcome| app.report_written(job, outcome),
                tell: |queue, background| background.report = queue.progress(),
                withdraw: Some(GdcmApp::give_up_report),
            },
        )?;
        kinds.add(
            "identification",
            pool,
            JobKind {
                wanted: |app| app.state.records.by_urgency(app.state.condition().id()),
                take: |app, job, found| app.identified(job, found),
                tell: |queue, background| background.identification = queue.progress(),
                withdraw: Some(|app| app.state.records.running.clear()),
            },
        )?;
        Ok(Self { kinds: Rc::new(kinds.kinds) })
    }

    /// Lets the jobs that were stopped be begun again.
    pub(super) fn resume(&self) {
        self.kinds.iter().for_each(|kind| kind.resume());
    }

    /// What is under way.
    pub(super) fn told(&self) -> Background {
        let mut background = Background::default();
        self.kinds.iter().for_each(|kind| kind.tell(&mut background));
        background
    }
}

impl GdcmApp {
    /// Asks for the jobs that what is shown needs, and for no others.
    pub(super) fn want_jobs(&mut self) {
        let kinds = Rc::clone(&self.jobs.kinds);
        kinds.iter().for_each(|kind| kind.want(self));
    }

    /// Gives up every job.
    pub(super) fn stop_jobs(&mut self) {
        let kinds = Rc::clone(&self.jobs.kinds);
        kinds.iter().for_each(|kind| kind.stop(self));
    }
}

/// The kinds so far, and where their replies go.
struct Registry<'a> {
    kinds: Vec<Box<dyn AnyKind>>,
    replies: &'a ReplySender,
}

impl Registry<'_> {
    /// Starts the queue of a kind. `tools` makes what its jobs work with.
    fn add<J: Job>(
        &mut self,
        name: &str,
        tools: impl Fn() -> J::Tools + Send + 'static,
        kind: JobKind<J>,
    ) -> io::Result<()> {
        let replies = self.replies.clone();
        let deliver = move |job: J, ending: Result<J::Output, Fault>| {
            replies.send(move |app| match ending {
                Ok(output) => (kind.take)(app, job, output),
                Err(fault) => {
                    kind.withdraw.iter().for_each(|withdraw| withdraw(app));
                    app.tell_fault("the computation", &fault);
                }
            });
        };
        let queue = JobQueue::start(name, tools, deliver)?;
        self.kinds.push(Box::new(Registered { kind, queue }));
        Ok(())
    }
}

/// The processor's cores as the tool of a job.
fn pool() -> Box<dyn Executor> {
    Box::new(Pool)
}

/// Of what the views shown wait for, only the number of jobs is told.
fn tell_view<J: Job>(queue: &JobQueue<J>, background: &mut Background) {
    background.views += queue.unfinished().len();
}

/// The job of a view, while that is shown.
fn shown_in<J: Job>(app: &GdcmApp, view: View, job: fn(&State) -> J) -> Vec<J> {
    app.state.display.arrangement.is_shown(view).then(|| job(&app.state)).into_iter().collect()
}

/// The jobs of a view, while that is shown; outputs of others are not kept.
fn all_shown_in<J: Job>(
    app: &mut GdcmApp,
    view: View,
    jobs: fn(&State) -> Vec<J>,
    kept: fn(&mut Results) -> &mut Vec<(J, J::Output)>,
) -> Vec<J> {
    let jobs = if app.state.display.arrangement.is_shown(view) { jobs(&app.state) } else { Vec::new() };
    kept(&mut app.state.results).retain(|(known, _)| jobs.contains(known));
    jobs
}

fn curves_job(state: &State) -> CurvesJob {
    let dataset = Arc::clone(&state.study.dataset);
    let grid = (display_band(state.study.settings.band), CURVE_POINTS);
    CurvesJob { dataset, condition: state.condition().id(), grid }
}

/// The costs of holding and freeing, of the condition shown.
fn toggles_job(state: &State) -> Option<TogglesJob> {
    let condition = state.analysis()?.condition(state.condition().id())?.clone();
    Some(TogglesJob { condition })
}

/// What is not proven, the condition shown first.
fn proof_jobs(state: &State) -> Vec<ProofJob> {
    let Some(analysis) = state.analysis() else { return Vec::new() };
    let shown = analysis.condition(state.condition().id());
    let others = analysis.conditions.values().flatten();
    let mut jobs: Vec<ProofJob> = Vec::new();
    for condition in shown.into_iter().chain(others) {
        let job = ProofJob { problem: Arc::clone(&condition.gain_problem) };
        if matches!(condition.gains.proof.outcome, Outcome::NotProven { .. }) && !jobs.contains(&job) {
            jobs.push(job);
        }
    }
    jobs
}

/// The error bars of what is shown; while that is computed anew, the answer has all cores.
fn uncertainty_job(state: &State) -> Option<UncertaintyJob> {
    state.analysis().filter(|_| !state.results.is_behind())?;
    state.results.analysis.clone().map(|analysis| UncertaintyJob { analysis })
}

fn assessment_job(state: &State) -> Option<AssessmentJob> {
    state.analysis().filter(|_| state.display.arrangement.is_shown(View::Assessment))?;
    let analysis = state.results.analysis.clone()?;
    Some(AssessmentJob { analysis, choice: assessment_choice(state) })
}
