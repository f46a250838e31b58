//! The thread that answers, with a mailbox that keeps only the newest request, and the jobs beside it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use super::fault::{Fault, caught};
use super::lane::{AnyLane, CANCEL_GRACE, Ending, JobQueue};
use super::pool::Pool;
use super::report::ReportJob;
use crate::view::results::{Background, FirstResult};
use gdcm_core::correction::{Outcome, Problem, Solution};
use gdcm_core::dataset::ConditionId;
use gdcm_core::executor::Executor;
use gdcm_core::identification::{Identification, IdentificationError, Validation};
use gdcm_core::study::{
    AcrossCurves, AcrossJob, Analysis, AssessmentJob, AssessmentTable, CURVE_POINTS, ConditionAnalysis,
    ConditionCurves, ConditionFailure, ConditionModes, CurvesJob, Engine, IdentifyJob, Job, ModesJob, Progress,
    ProofJob, SimulationJob, Study, Toggles, TogglesJob, Uncertainty, UncertaintyJob, VariantJob, display_band,
};
use gdcm_files::FileError;

/// What is to be computed. All of it is shared, so that a request costs next to nothing.
#[derive(Clone, Debug)]
pub struct Request {
    /// Its number; the newest has the greatest.
    pub generation: u64,
    /// The study to analyse.
    pub study: Study,
    /// The condition shown, whose result and curves are wanted first.
    pub condition: ConditionId,
}

impl Request {
    /// Whether it needs the same responses and distances, and the same first.
    fn compares_the_same(&self, other: &Request) -> bool {
        let settings = |request: &Request| (request.study.settings.band, request.study.settings.points);
        let same_models = Arc::ptr_eq(&self.study.dataset, &other.study.dataset);
        same_models && self.condition == other.condition && settings(self) == settings(other)
    }
}

/// What was computed.
#[derive(Debug)]
pub enum Reply {
    /// How far the analysis is.
    Progress {
        /// Number of the request.
        generation: u64,
        /// Steps done.
        done: usize,
        /// Of how many.
        total: usize,
    },
    /// The result of the condition shown, ahead of the others'.
    First(FirstResult),
    /// The analysis of a request; once more with the same number when a proof has been added to it.
    Analysis {
        /// Number of the request.
        generation: u64,
        /// The result.
        analysis: Arc<Analysis>,
        /// Time it took \[ms\].
        elapsed_ms: f64,
    },
    /// What holding or freeing each response of a condition would cost.
    Toggles(TogglesJob, Arc<Toggles>),
    /// Responses of one condition for drawing.
    Curves(CurvesJob, Arc<ConditionCurves>),
    /// Modes of the models of one condition.
    Modes(ModesJob, Arc<ConditionModes>),
    /// An assessment.
    Assessment(AssessmentJob, Arc<AssessmentTable>),
    /// Responses of one model of each condition.
    Across(AcrossJob, Arc<AcrossCurves>),
    /// The analysis of a variant.
    Variant(VariantJob, Arc<Analysis>),
    /// How sure the figures of an analysis are.
    Uncertainty(UncertaintyJob, Arc<Uncertainty>),
    /// What came of writing a report.
    Report(ReportJob, Result<(), FileError>),
    /// What was identified from flight records.
    Identified(IdentifyJob, Result<Arc<Identification>, IdentificationError>),
    /// A model against a record in time; or, in words, why that cannot be had.
    Simulated(SimulationJob, Result<Arc<Validation>, String>),
    /// Computing panicked.
    Fault {
        /// Number of the request that has no answer for it; none for a job.
        generation: Option<u64>,
        /// The panic.
        fault: Fault,
    },
}

/// In place of the newest request's number where nothing is wanted any more.
const NOTHING: u64 = u64::MAX;

/// Called after each reply: wakes the window.
pub(super) type Wake = Arc<dyn Fn() + Send + Sync>;
/// Makes an engine, at the start and anew after a panic, which may leave its caches half made.
pub type EngineMaker = Arc<dyn Fn() -> Engine + Send + Sync>;

/// A proof that a job has completed.
type Proof = (Arc<Problem>, Arc<Solution>);

#[derive(Default)]
struct Mailbox {
    request: Option<Request>,
    proofs: Vec<Proof>,
    closed: bool,
}

#[derive(Default)]
struct Shared {
    mailbox: Mutex<Mailbox>,
    filled: Condvar,
    /// Number of the newest request: work for an older one is given up.
    newest: AtomicU64,
}

impl Shared {
    fn mailbox(&self) -> MutexGuard<'_, Mailbox> {
        // A panic while the lock was held leaves a mailbox that is still whole.
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a request, for proofs or for both; none once the worker is dropped.
    fn take(&self) -> Option<(Option<Request>, Vec<Proof>)> {
        let mut mailbox = self.mailbox();
        loop {
            if mailbox.closed {
                return None;
            }
            if mailbox.request.is_some() || !mailbox.proofs.is_empty() {
                return Some((mailbox.request.take(), std::mem::take(&mut mailbox.proofs)));
            }
            mailbox = self.filled.wait(mailbox).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// The long work beside the live answer, a thread for each kind.
struct Lanes {
    curves: JobQueue<CurvesJob>,
    toggles: JobQueue<TogglesJob>,
    proofs: JobQueue<ProofJob>,
    modes: JobQueue<ModesJob>,
    assessments: JobQueue<AssessmentJob>,
    across: JobQueue<AcrossJob>,
    variants: JobQueue<VariantJob>,
    uncertainties: JobQueue<UncertaintyJob>,
    reports: JobQueue<ReportJob>,
    identifications: JobQueue<IdentifyJob>,
    simulations: JobQueue<SimulationJob>,
}

/// What the views that are shown need beside the live answer; a job that is not wanted any more is given up.
#[derive(Clone, Debug, Default)]
pub struct BackgroundJobs {
    /// Modes of the condition shown.
    pub modes: Option<ModesJob>,
    /// The assessment shown.
    pub assessment: Option<AssessmentJob>,
    /// One model of each condition.
    pub across: Option<AcrossJob>,
    /// The variants.
    pub variants: Vec<VariantJob>,
    /// How sure the figures shown are.
    pub uncertainty: Option<UncertaintyJob>,
    /// The report that is being written.
    pub report: Option<ReportJob>,
    /// Models to be identified, the first first.
    pub identifications: Vec<IdentifyJob>,
    /// Models against a record in time.
    pub simulations: Vec<SimulationJob>,
}

/// The threads that compute. Dropping it ends them, and waits for none.
pub struct Worker {
    shared: Arc<Shared>,
    lanes: Arc<Lanes>,
    replies: Receiver<Reply>,
}

/// Where replies go to.
#[derive(Clone)]
struct ReplySender {
    sender: Sender<Reply>,
    wake: Wake,
}

impl ReplySender {
    fn send(&self, reply: Reply) {
        // The window is gone when nobody listens; the threads end soon after.
        let _ = self.sender.send(reply);
        (self.wake)();
    }

    /// Sends the reply that a job ends in.
    fn deliver<J: Job>(&self, ending: Ending<J>, reply: impl FnOnce(J::Output) -> Option<Reply>) {
        let reply = match ending {
            Ok(output) => reply(output),
            Err(fault) => Some(Reply::Fault { generation: None, fault }),
        };
        // Without a reply too: the job is not under way any more.
        reply.map_or_else(|| (self.wake)(), |reply| self.send(reply));
    }
}

impl Worker {
    /// Starts the threads; `wake` is called after each reply.
    pub fn start(make_engine: EngineMaker, wake: Wake) -> std::io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (sender, replies) = channel();
        let outbox = ReplySender { sender, wake };
        let lanes = Arc::new(Lanes::start(&shared, &make_engine, &outbox)?);
        let desk = AnalysisThread { shared: Arc::clone(&shared), lanes: Arc::clone(&lanes), outbox, make_engine };
        std::thread::Builder::new().name("analysis".to_owned()).spawn(move || desk.work())?;
        Ok(Self { shared, lanes, replies })
    }

    /// Asks for a computation in place of any that is not done yet.
    pub fn request(&self, request: Request) {
        let grid = (display_band(request.study.settings.band), CURVE_POINTS);
        let dataset = Arc::clone(&request.study.dataset);
        self.lanes.curves.want(vec![CurvesJob { dataset, condition: request.condition, grid }]);
        // The answer has both cores: bars of the answer before are of no use.
        self.lanes.uncertainties.want(Vec::new());
        self.shared.newest.store(request.generation, Ordering::Release);
        self.shared.mailbox().request = Some(request);
        self.shared.filled.notify_one();
    }

    /// Asks for what the views shown need, and for nothing else of its kind.
    pub fn want_beside(&self, beside: BackgroundJobs) {
        self.lanes.modes.want(beside.modes.into_iter().collect());
        self.lanes.assessments.want(beside.assessment.into_iter().collect());
        self.lanes.across.want(beside.across.into_iter().collect());
        self.lanes.variants.want(beside.variants);
        self.lanes.uncertainties.want(beside.uncertainty.into_iter().collect());
        self.lanes.reports.want(beside.report.into_iter().collect());
        self.lanes.identifications.want(beside.identifications);
        self.lanes.simulations.want(beside.simulations);
    }

    /// Gives up the request under way, the one that waits, and every job.
    pub fn stop(&self) {
        self.shared.newest.store(NOTHING, Ordering::Release);
        self.shared.mailbox().request = None;
        self.lanes.all().iter().for_each(|lane| lane.stop());
    }

    /// Lets the jobs that were stopped be begun again.
    pub fn resume(&self) {
        self.lanes.all().iter().for_each(|lane| lane.resume());
    }

    /// Lets the identifications that were stopped be begun again.
    pub fn resume_identifications(&self) {
        self.lanes.identifications.resume();
    }

    /// Whether a report was stopped that is still asked for.
    pub fn is_report_stopped(&self) -> bool {
        self.lanes.reports.is_stopped()
    }

    /// What is under way beside the live answer.
    pub fn background(&self) -> Background {
        let lanes = &self.lanes;
        let told = |lane: &dyn AnyLane| (lane.left() > 0).then(|| lane.progress().unwrap_or((0, 0)));
        Background {
            proofs: lanes.proofs.unfinished().into_iter().map(|job| job.problem).collect(),
            toggles: lanes.toggles.left() > 0,
            curves: told(&lanes.curves),
            bars: told(&lanes.uncertainties),
            views: lanes.of_views().iter().map(|lane| lane.left()).sum(),
            report: told(&lanes.reports),
            identification: told(&lanes.identifications),
            stopped: lanes.computing().iter().any(|lane| lane.is_stopped()),
        }
    }

    /// The next reply, if one is there.
    pub fn reply(&self) -> Option<Reply> {
        self.replies.try_recv().ok()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.shared.newest.store(NOTHING, Ordering::Release);
        self.shared.mailbox().closed = true;
        self.shared.filled.notify_one();
        self.stop();
    }
}

impl Lanes {
    fn start(shared: &Arc<Shared>, make_engine: &EngineMaker, outbox: &ReplySender) -> std::io::Result<Self> {
        let [for_curves, for_variants, for_bars, for_reports] = std::array::from_fn(|_| Arc::clone(make_engine));
        Ok(Self {
            curves: lane("curves", move || for_curves(), outbox, |job, curves| Some(Reply::Curves(job, curves?)))?,
            toggles: lane("toggles", || (), outbox, |job, toggles| Some(Reply::Toggles(job, Arc::new(toggles?))))?,
            modes: lane("modes", || (), outbox, |job, modes| Some(Reply::Modes(job, modes)))?,
            assessments: lane("assessment", || (), outbox, |job, table| Some(Reply::Assessment(job, table)))?,
            across: lane("conditions", || (), outbox, |job, curves| Some(Reply::Across(job, curves)))?,
            variants: lane("variants", move || for_variants(), outbox, |job, found| Some(Reply::Variant(job, found)))?,
            uncertainties: lane("error bars", move || for_bars(), outbox, |job, of| Some(Reply::Uncertainty(job, of)))?,
            reports: lane("report", move || for_reports(), outbox, |job, outcome| Some(Reply::Report(job, outcome)))?,
            identifications: lane(
                "identification",
                || -> Box<dyn Executor> { Box::new(Pool) },
                outbox,
                |job, found| Some(Reply::Identified(job, found)),
            )?,
            simulations: lane("simulation", pool, outbox, |job, outcome| Some(Reply::Simulated(job, outcome)))?,
            proofs: proofs_lane(shared, outbox)?,
        })
    }

    /// What only the views shown wait for.
    fn of_views(&self) -> [&dyn AnyLane; 5] {
        [&self.modes, &self.assessments, &self.across, &self.variants, &self.simulations]
    }

    /// What computing anew begins again: all but what is asked for by a button of its own.
    fn computing(&self) -> Vec<&dyn AnyLane> {
        let live: [&dyn AnyLane; 4] = [&self.curves, &self.toggles, &self.proofs, &self.uncertainties];
        live.into_iter().chain(self.of_views()).collect()
    }

    /// Every lane.
    fn all(&self) -> Vec<&dyn AnyLane> {
        let with_buttons: [&dyn AnyLane; 2] = [&self.reports, &self.identifications];
        self.computing().into_iter().chain(with_buttons).collect()
    }
}

/// The pool as the tool of a job.
fn pool() -> Box<dyn Executor> {
    Box::new(Pool)
}

/// A lane whose outputs become replies.
fn lane<J: Job>(
    name: &str,
    tools: impl Fn() -> J::Tools + Send + 'static,
    outbox: &ReplySender,
    reply: impl Fn(J, J::Output) -> Option<Reply> + Send + 'static,
) -> std::io::Result<JobQueue<J>> {
    let out = outbox.clone();
    JobQueue::start(name, tools, move |job: J, ending| out.deliver::<J>(ending, |output| reply(job, output)))
}

/// The lane of proofs, which go to the thread that answers.
fn proofs_lane(shared: &Arc<Shared>, outbox: &ReplySender) -> std::io::Result<JobQueue<ProofJob>> {
    let shared = Arc::clone(shared);
    lane(
        "proofs",
        || (),
        outbox,
        move |job: ProofJob, solution| {
            // A problem without an answer has been told by the live answer.
            shared.mailbox().proofs.push((job.problem, solution.ok()?));
            shared.filled.notify_one();
            None
        },
    )
}

/// What the thread that answers works with.
struct AnalysisThread {
    shared: Arc<Shared>,
    lanes: Arc<Lanes>,
    outbox: ReplySender,
    make_engine: EngineMaker,
}

impl AnalysisThread {
    fn work(&self) {
        let mut engine = None;
        let mut newest: Option<Request> = None;
        while let Some((request, proofs)) = self.shared.take() {
            newest = request.or(newest);
            let Some(request) = &newest else { continue };
            let answered = caught(|| {
                let engine = engine.get_or_insert_with(|| (self.make_engine)());
                proofs.into_iter().for_each(|(problem, solution)| engine.take_gains(&problem, &solution));
                self.answer(request, engine)
            });
            if let Err(fault) = answered {
                engine = None;
                self.outbox.send(Reply::Fault { generation: Some(request.generation), fault });
            }
        }
    }

    /// Sends the analysis and asks for the jobs that it leaves; nothing where a newer request came first.
    fn answer(&self, request: &Request, engine: &mut Engine) {
        let start = Instant::now();
        let progress = RequestProgress { desk: self, request, started: start, compared: AtomicBool::new(false) };
        let Ok(analysis) = engine.analyze(&request.study, &progress) else {
            return;
        };
        let analysis = Arc::new(analysis);
        let elapsed_ms = 1e3 * start.elapsed().as_secs_f64();
        self.post_jobs(request, &analysis);
        self.outbox.send(Reply::Analysis { generation: request.generation, analysis, elapsed_ms });
    }

    /// Asks for the costs of the condition shown, and for what is not proven, the condition shown first.
    fn post_jobs(&self, request: &Request, analysis: &Analysis) {
        let shown = analysis.condition(request.condition);
        self.lanes
            .toggles
            .want(shown.map(|condition| TogglesJob { condition: condition.clone() }).into_iter().collect());
        let others = analysis.conditions.values().filter_map(|outcome| outcome.as_ref().ok());
        let open =
            shown.into_iter().chain(others).filter(|of| matches!(of.gains.proof.outcome, Outcome::NotProven { .. }));
        let mut proofs: Vec<ProofJob> = Vec::new();
        for condition in open {
            let job = ProofJob { problem: Arc::clone(&condition.gain_problem) };
            if !proofs.contains(&job) {
                proofs.push(job);
            }
        }
        self.lanes.proofs.want(proofs);
    }
}

struct RequestProgress<'a> {
    desk: &'a AnalysisThread,
    request: &'a Request,
    started: Instant,
    /// Whether all responses and distances are there: what is left depends on more than they do.
    compared: AtomicBool,
}

impl RequestProgress<'_> {
    /// Whether the request that waits needs the very responses and distances that are being computed.
    fn is_of_use(&self) -> bool {
        let mailbox = self.desk.shared.mailbox();
        !self.compared.load(Ordering::Relaxed)
            && mailbox.request.as_ref().is_some_and(|newer| newer.compares_the_same(self.request))
    }
}

impl Progress for RequestProgress<'_> {
    /// During a steady drag every answer is worth having: without that only the condition shown would keep up with the hand.
    fn cancelled(&self) -> bool {
        match self.desk.shared.newest.load(Ordering::Acquire) {
            NOTHING => true,
            newest => newest != self.request.generation && self.started.elapsed() > CANCEL_GRACE && !self.is_of_use(),
        }
    }

    fn advanced(&self, done: usize, total: usize) {
        // The last step of each condition is its optimum.
        let compared = done + self.request.study.dataset.conditions().len() >= total;
        self.compared.fetch_or(compared, Ordering::Relaxed);
        if self.started.elapsed() > CANCEL_GRACE {
            self.desk.outbox.send(Reply::Progress { generation: self.request.generation, done, total });
        }
    }

    fn wanted_first(&self) -> Option<ConditionId> {
        Some(self.request.condition)
    }

    fn first_result(&self, outcome: &Result<ConditionAnalysis, ConditionFailure>) {
        let (dataset, condition) = (Arc::clone(&self.request.study.dataset), self.request.condition);
        let generation = self.request.generation;
        self.desk.outbox.send(Reply::First(FirstResult { generation, dataset, condition, outcome: outcome.clone() }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gdcm_core::dataset::{Band, BundleKind, ModelId};
    use gdcm_core::identification::{FlightRecord, Options, Preparation};
    use gdcm_files::embedded_example;
    use nalgebra::DMatrix;

    /// One model of every condition at so many frequencies that it takes its time.
    fn long_across() -> AcrossJob {
        let dataset = embedded_example().unwrap().dataset;
        let nominal = |condition: &Arc<gdcm_core::dataset::Condition>| {
            ModelId::new(
                condition.id(),
                BundleKind::Physics,
                &condition.bundle(BundleKind::Physics)[condition.nominal()].name,
            )
        };
        let models = dataset.conditions().iter().map(nominal).collect();
        AcrossJob { dataset, models, grid: (Band::new(0.5, 12.0).unwrap(), 30_000) }
    }

    /// An identification that does not end at once: 400 s at 50 Hz.
    fn long_identification() -> IdentifyJob {
        let wave = |rate: f64| move |sample: usize, _: usize| (rate * (sample as f64).powf(1.3)).sin();
        let record = FlightRecord {
            name: "long".to_owned(),
            time_s: (0..20_000).map(|sample| 0.02 * sample as f64).collect(),
            inputs: DMatrix::from_fn(20_000, 1, wave(1e-3)),
            outputs: DMatrix::from_fn(20_000, 1, wave(2e-3)),
        };
        let options = Options::new([0.5, 12.0], Preparation::of(&["LON"], &["Q"]));
        IdentifyJob::new(ConditionId(1), vec![record].into(), options)
    }

    #[test]
    fn identifying_anew_begins_nothing_else_again_that_was_stopped() {
        let worker = Worker::start(Arc::new(Engine::default), Arc::new(|| ())).unwrap();
        let (across, identifications) = (Some(long_across()), vec![long_identification()]);
        worker.want_beside(BackgroundJobs { across, identifications, ..BackgroundJobs::default() });
        worker.stop();
        assert!(worker.background().stopped && worker.background().identification.is_none());
        worker.resume_identifications();
        assert!(worker.background().identification.is_some(), "it is begun again");
        assert!(worker.background().stopped && worker.background().views == 0, "what a view waits for is not");
        worker.resume();
        assert!(!worker.background().stopped && worker.background().views == 1);
    }
}
