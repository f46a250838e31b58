//! The live answer and the window's other jobs. One table, [`BackgroundJobs::start`], lists every
//! kind of job with its tools, its trigger and the destination of its output.

use std::io;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use gdcm_method::correction::{Outcome, Problem, Solution};
use gdcm_model::dataset::ConditionId;
use gdcm_model::executor::Executor;
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_study::jobs::analysis_jobs::{ProofJob, TogglesJob, UncertaintyJob};
use gdcm_study::jobs::curve_jobs::CurvesJob;
use gdcm_study::jobs::job::Job;
use gdcm_study::results::analysis::ConditionFailure;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, curves_band};
use gdcm_study::stages::condition_responses::KnownModels;
use gdcm_study::stages::engine::WantedFirst;
use gdcm_study::{Analysis, ConditionAnalysis, Engine, Study};

use super::GdcmApp;
use super::job_queue::JobQueue;
use super::threads::{Fault, ReplySender};
use crate::executor::Pool;
use crate::gui::state::results::{Background, FirstResult};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::need::Need;
use crate::gui::views::{are_couplings_judged, couplings_job, overlay_job, view_content};

/// Creates an engine, at the start and after a panic, which may leave its caches inconsistent.
pub type EngineMaker = Arc<dyn Fn() -> Engine + Send + Sync>;

/// One kind of job.
struct JobKind<J: Job> {
    /// Jobs needed by the current display, the most urgent first; jobs no longer needed are
    /// cancelled.
    wanted: fn(&mut GdcmApp) -> Vec<J>,
    /// Stores the output of a job.
    take: fn(&mut GdcmApp, J, J::Output),
    /// Reports running work.
    tell: fn(&JobQueue<J>, &mut Background),
    /// Withdraws the request of a job with its own trigger after a stop or a fault; that trigger,
    /// not "Compute", starts it again.
    withdraw: Option<fn(&mut GdcmApp)>,
}

impl<J: Job> JobKind<J> {
    /// Creates a kind that "Compute" restarts after a stop, and whose jobs count among those that
    /// views wait for.
    fn new(wanted: fn(&mut GdcmApp) -> Vec<J>, take: fn(&mut GdcmApp, J, J::Output)) -> Self {
        let tell = |queue: &JobQueue<J>, background: &mut Background| {
            background.views += queue.unfinished().len()
        };
        Self {
            wanted,
            take,
            tell,
            withdraw: None,
        }
    }
}

/// A kind of job with its queue.
struct Registered<J: Job> {
    kind: JobKind<J>,
    queue: JobQueue<J>,
}

/// Common interface of all kinds of jobs.
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

/// All kinds of jobs, each with its own thread. Dropping it ends the threads without waiting.
pub(super) struct BackgroundJobs {
    kinds: Rc<Vec<Box<dyn AnyKind>>>,
}

impl BackgroundJobs {
    /// Starts the threads.
    pub(super) fn start(make_engine: &EngineMaker, replies: &ReplySender) -> io::Result<Self> {
        // Kinds that work on the current study share one response of each model; a variant may use
        // another band.
        let known = KnownModels::default();
        let engine = || {
            let make = Arc::clone(make_engine);
            let known = known.clone();
            move || make().sharing(&known)
        };
        let answers = JobKind {
            tell: |queue, background| background.analysis = queue.progress(),
            withdraw: Some(GdcmApp::answer_stopped),
            ..JobKind::new(
                |app| app.work.asked.iter().cloned().collect(),
                GdcmApp::answered,
            )
        };
        let curves = JobKind {
            tell: |queue, background| background.curves = queue.progress(),
            ..JobKind::new(|app| vec![curves_job(&app.state)], GdcmApp::take_curves)
        };
        let toggles = JobKind {
            tell: |queue, background| background.toggles = queue.progress().is_some(),
            ..JobKind::new(
                |app| toggles_job(&app.state).into_iter().collect(),
                |app, job, toggles| {
                    app.state.results.toggles = toggles.map(|toggles| (job, Arc::new(toggles)))
                },
            )
        };
        let proofs = JobKind {
            tell: |queue: &JobQueue<ProofJob>, background| {
                background.proofs = queue
                    .unfinished()
                    .into_iter()
                    .map(|job| job.problem)
                    .collect();
            },
            ..JobKind::new(|app| proof_jobs(&app.state), GdcmApp::take_proof)
        };
        let bars = JobKind {
            tell: |queue, background| background.bars = queue.progress(),
            ..JobKind::new(
                |app| uncertainty_job(&app.state).into_iter().collect(),
                |app, job, uncertainty| app.state.results.uncertainty = Some((job, uncertainty)),
            )
        };
        let modes = JobKind::new(
            |app| {
                needed(app, |need| {
                    if let Need::Modes(job) = need {
                        Some(job)
                    } else {
                        None
                    }
                })
            },
            |app, job, modes| app.state.results.modes = Some((job, modes)),
        );
        let assessments = JobKind::new(
            |app| {
                needed(app, |need| {
                    if let Need::Assessment(job) = need {
                        Some(job)
                    } else {
                        None
                    }
                })
            },
            |app, job, table| app.state.results.assessment = Some((job, table)),
        );
        let across = JobKind::new(
            |app| {
                needed(app, |need| {
                    if let Need::Across(job) = need {
                        Some(job)
                    } else {
                        None
                    }
                })
            },
            |app, job, curves| app.state.results.across = Some((job, curves)),
        );
        let couplings = JobKind {
            tell: |queue, background| background.couplings = queue.progress(),
            ..JobKind::new(
                |app| {
                    needed(app, |need| {
                        if let Need::Couplings(job) = need {
                            Some(job)
                        } else {
                            None
                        }
                    })
                },
                |app, job, assessed| {
                    app.state.results.couplings = assessed.map(|assessed| (job, assessed))
                },
            )
        };
        let requirements = JobKind::new(
            |app| {
                needed(app, |need| {
                    if let Need::Requirements(job) = need {
                        Some(job)
                    } else {
                        None
                    }
                })
            },
            |app, job, found| app.state.results.requirements = Some((job, found)),
        );
        let test_answers = JobKind::new(
            |app| {
                needed(app, |need| {
                    if let Need::TestAnswers(job) = need {
                        Some(job)
                    } else {
                        None
                    }
                })
            },
            |app, job, found| app.state.results.test_answers = Some((job, found)),
        );
        let record_history = JobKind::new(
            |app| {
                needed(app, |need| {
                    if let Need::RecordHistory(job) = need {
                        Some(job)
                    } else {
                        None
                    }
                })
            },
            |app, job, found| app.state.results.record_history = Some((job, found)),
        );
        let time_histories = JobKind {
            tell: |queue, background| background.time_histories = queue.progress(),
            ..JobKind::new(
                |app| {
                    needed(app, |need| {
                        if let Need::TimeHistories(job) = need {
                            Some(job)
                        } else {
                            None
                        }
                    })
                },
                |app, job, found| app.state.results.time_histories = Some((job, found)),
            )
        };
        let variants = JobKind::new(
            |app| {
                let jobs = needed(app, |need| {
                    if let Need::Variant(job) = need {
                        Some(job)
                    } else {
                        None
                    }
                });
                keep(&mut app.state.results.variants, jobs)
            },
            |app, job, analysis| app.state.results.variants.push((job, analysis)),
        );
        let simulations = JobKind::new(
            |app| {
                let jobs = needed(app, |need| {
                    if let Need::Simulation(job) = need {
                        Some(job)
                    } else {
                        None
                    }
                });
                keep(&mut app.state.results.simulations, jobs)
            },
            |app, job, outcome| app.state.results.simulations.push((job, outcome)),
        );
        let reports = JobKind {
            tell: |queue, background| background.report = queue.progress(),
            withdraw: Some(GdcmApp::give_up_report),
            ..JobKind::new(
                |app| app.work.reporting.iter().cloned().collect(),
                GdcmApp::report_written,
            )
        };
        let identifications = JobKind {
            tell: |queue, background| background.identification = queue.progress(),
            withdraw: Some(|app| app.stop_identifying()),
            ..JobKind::new(
                |app| app.state.records.by_urgency(app.state.condition().id()),
                GdcmApp::identified,
            )
        };
        let make = Arc::clone(make_engine);
        let engine_of_variants = move || make();
        let kinds = vec![
            started("analysis", engine(), answers, replies)?,
            started("curves", engine(), curves, replies)?,
            started("toggles", || (), toggles, replies)?,
            started("proofs", || (), proofs, replies)?,
            started("error bars", engine(), bars, replies)?,
            started("modes", || (), modes, replies)?,
            started("assessment", || (), assessments, replies)?,
            started("conditions", || (), across, replies)?,
            started("couplings", engine(), couplings, replies)?,
            started("requirements", pool, requirements, replies)?,
            started("test input", pool, test_answers, replies)?,
            started("record in time", pool, record_history, replies)?,
            started("answers to records", pool, time_histories, replies)?,
            started("variants", engine_of_variants, variants, replies)?,
            started("simulation", pool, simulations, replies)?,
            started("report", engine(), reports, replies)?,
            started("identification", pool, identifications, replies)?,
        ];
        Ok(Self {
            kinds: Rc::new(kinds),
        })
    }

    /// Allows stopped jobs to start again.
    pub(super) fn resume(&self) {
        self.kinds.iter().for_each(|kind| kind.resume());
    }

    /// Returns the running work.
    pub(super) fn told(&self) -> Background {
        let mut background = Background::default();
        self.kinds
            .iter()
            .for_each(|kind| kind.tell(&mut background));
        background
    }
}

impl GdcmApp {
    /// Requests exactly the jobs that the current display needs.
    pub(super) fn want_jobs(&mut self) {
        let state = &self.state;
        let shown = View::ALL
            .into_iter()
            .filter(|view| state.display.layout.arrangement.is_shown(*view));
        let of_views = shown.flat_map(|view| (view_content(view).needs)(state));
        let judged = are_couplings_judged(state).then(|| Need::Couplings(couplings_job(state)));
        self.work.needs = of_views
            .chain(overlay_job(state).map(Need::Variant))
            .chain(judged)
            .collect();
        let kinds = Rc::clone(&self.work.jobs.kinds);
        kinds.iter().for_each(|kind| kind.want(self));
    }

    /// Stops every job.
    pub(super) fn stop_jobs(&mut self) {
        let kinds = Rc::clone(&self.work.jobs.kinds);
        kinds.iter().for_each(|kind| kind.stop(self));
    }
}

/// Starts a thread and a queue for a kind of job. `tools` creates the tools of its jobs.
fn started<J: Job>(
    name: &str,
    tools: impl Fn() -> J::Tools + Send + 'static,
    kind: JobKind<J>,
    replies: &ReplySender,
) -> io::Result<Box<dyn AnyKind>> {
    let replies = replies.clone();
    let take = kind.take;
    let withdraw = kind.withdraw;
    let deliver = move |job: J, ending: Result<J::Output, Fault>| {
        replies.send(move |app| match ending {
            Ok(output) => take(app, job, output),
            Err(fault) => {
                withdraw.iter().for_each(|withdraw| withdraw(app));
                app.tell_fault("the computation", &fault);
            }
        });
    };
    let queue = JobQueue::start(name, tools, deliver)?;
    Ok(Box::new(Registered { kind, queue }))
}

/// Returns the processor's cores as the tool of a job.
fn pool() -> Box<dyn Executor> {
    Box::new(Pool)
}

/// Returns the jobs of one kind needed by the visible views.
fn needed<J: Clone>(app: &GdcmApp, of: fn(&Need) -> Option<&J>) -> Vec<J> {
    app.work.needs.iter().filter_map(of).cloned().collect()
}

/// Drops the kept outputs of jobs that are not in `jobs`; returns `jobs`.
fn keep<J: Job>(kept: &mut Vec<(J, J::Output)>, jobs: Vec<J>) -> Vec<J> {
    kept.retain(|(known, _)| jobs.contains(known));
    jobs
}

fn curves_job(state: &State) -> CurvesJob {
    let dataset = Arc::clone(&state.study.dataset);
    let grid = (curves_band(&state.study.settings), CURVE_POINTS);
    CurvesJob {
        dataset: dataset.into(),
        condition: state.condition().id(),
        grid,
    }
}

/// Returns the job that computes the costs of constraining and releasing entries, for the displayed
/// condition.
fn toggles_job(state: &State) -> Option<TogglesJob> {
    let condition = state.analysis()?.condition(state.condition().id())?.clone();
    Some(TogglesJob { condition })
}

/// Returns the unproven problems, those of the displayed condition first.
fn proof_jobs(state: &State) -> Vec<ProofJob> {
    let Some(analysis) = state.analysis() else {
        return Vec::new();
    };
    let shown = analysis.condition(state.condition().id());
    let others = analysis.conditions.values().flatten();
    let mut jobs: Vec<ProofJob> = Vec::new();
    for condition in shown.into_iter().chain(others) {
        let job = ProofJob {
            problem: Arc::clone(&condition.gain_problem),
        };
        if matches!(condition.gains.proof.outcome, Outcome::NotProven { .. })
            && !jobs.contains(&job)
        {
            jobs.push(job);
        }
    }
    jobs
}

/// Returns the job for the error bars of the displayed results. While these are recomputed, or
/// drawn for the first time, the live answer has all cores.
fn uncertainty_job(state: &State) -> Option<UncertaintyJob> {
    let results = &state.results;
    state.analysis().filter(|_| {
        !results.is_behind() && (results.is_painted || results.uncertainty.is_some())
    })?;
    results.analysis.clone().map(|analysis| UncertaintyJob {
        analysis: analysis.into(),
    })
}

/// A problem with its gains, proven optimal by another job.
pub(super) type Proof = (Arc<Problem>, Arc<Solution>);

/// Live answer to the current study and condition. All parts are shared, so a request is cheap.
#[derive(Clone)]
pub(super) struct AnalysisJob {
    /// Number of the job: a proof that arrives later creates another job for the same request.
    pub(super) number: u64,
    /// Number of the request; the newest is the greatest.
    pub(super) generation: u64,
    pub(super) study: Study,
    /// The displayed condition, whose result and curves come first.
    pub(super) condition: ConditionId,
    /// Problems proven since the last answer.
    pub(super) proofs: Vec<Proof>,
    /// Receives the result of the displayed condition, ahead of the others.
    pub(super) replies: ReplySender,
}

impl PartialEq for AnalysisJob {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Job for AnalysisJob {
    type Tools = Engine;
    /// The analysis and its computing time \[ms\].
    type Output = (Arc<Analysis>, f64);

    fn run(&self, engine: &mut Engine, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let started = Instant::now();
        self.proofs
            .iter()
            .for_each(|(problem, solution)| engine.take_gains(problem, solution));
        let tell = |outcome: &Result<ConditionAnalysis, ConditionFailure>| {
            let dataset = Arc::clone(&self.study.dataset);
            let condition = self.condition;
            let first = FirstResult {
                generation: self.generation,
                dataset,
                condition,
                outcome: outcome.clone(),
            };
            self.replies
                .send(move |app| app.state.results.first = Some(first));
        };
        let first = WantedFirst {
            condition: self.condition,
            tell: &tell,
        };
        let analysis = engine.analyze_first(&self.study, Some(first), progress)?;
        Ok((Arc::new(analysis), 1e3 * started.elapsed().as_secs_f64()))
    }

    /// Returns whether this job should continue although a newer one waits. A job with the same
    /// request number does. So does a job whose responses and distances are still being computed if
    /// the newer job needs the same; otherwise only the displayed condition would keep up with a
    /// steady drag.
    fn serves(&self, newer: &Self, done: usize, total: usize) -> bool {
        // The last step of each condition is its optimum, which depends on other settings too.
        let is_compared = total > 0 && done + self.study.dataset.conditions().len() >= total;
        let compared = |job: &Self| {
            (
                job.condition,
                job.study.settings.band,
                job.study.settings.points,
            )
        };
        let same_models = Arc::ptr_eq(&self.study.dataset, &newer.study.dataset);
        self.generation == newer.generation
            || !is_compared && same_models && compared(self) == compared(newer)
    }
}
