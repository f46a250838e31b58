//! The window: its state, the compute threads, and the dialogs.

use std::path::PathBuf;
use std::sync::mpsc::Receiver;
use std::sync::{Arc, OnceLock};

use egui::{
    CentralPanel, Context, Frame, Margin, Panel, Rect, ScrollArea, Ui, UiBuilder, ViewportCommand,
    Visuals,
};

use gdcm_io::files::study_file::holds_models;
use gdcm_io::files::user_state::{LostStudy, is_first_start};
use gdcm_io::{Existing, LoadedDataset, Opened};
use gdcm_method::correction::Solution;
use gdcm_method::correction::problem::ProblemError;
use gdcm_model::dataset::{BundleKind, ConditionId};
use gdcm_study::jobs::analysis_jobs::ProofJob;
use gdcm_study::jobs::curve_jobs::CurvesJob;
use gdcm_study::stages::condition_curves::ConditionCurves;
use gdcm_study::{Analysis, Study};

use super::Setup;
use super::background_jobs::{AnalysisJob, BackgroundJobs, Proof};
use super::files::{PendingAction, SavedStudy};
use super::keyboard::{self, KeyOrder};
use super::outputs::ReportJob;
use super::record_import::DatasetOfRecords;
use super::recovery::{Autosave, LAST_WAIT};
use super::reload::DiskWatch;
use super::threads::{Fault, Reader, Reply, ReplySender};
use super::update::NextFocus;
use crate::gui::commands::command::Command;
use crate::gui::panels::bars::Bar;
use crate::gui::panels::explanation::{Sheet, sheet_ui};
use crate::gui::panels::start_page::OpensWith;
use crate::gui::panels::{
    answer_panel, bars, centre, conditions_panel, explanation, forms, help, models_panel,
    start_page,
};
use crate::gui::state::display::Preferences;
use crate::gui::state::focus;
use crate::gui::state::window_state::State;
use crate::gui::views::assembling::{AssemblingCommand, assembling_ui};
use crate::gui::views::records::RecordsCommand;
use crate::gui::views::{Need, View};
use crate::gui::widgets::controls::restore_panel_size;
use crate::gui::widgets::palette::{self, Palette};

/// The program's window.
pub struct GdcmApp {
    pub(super) ctx: Context,
    pub(super) state: State,
    pub(super) loaded: LoadedDataset,
    pub(super) saved: SavedStudy,
    /// Last requested live answer.
    pub(super) asked: Option<AnalysisJob>,
    pub(super) jobs: BackgroundJobs,
    /// Proofs that the results do not contain yet.
    proven: Vec<Proof>,
    /// Jobs needed by the visible views, beside the live answer.
    pub(super) needs: Vec<Need>,
    pub(super) replies: ReplySender,
    /// Replies from threads.
    received: Receiver<Reply>,
    pub(super) dialog_open: bool,
    /// Reads imported models.
    pub(super) models: Reader,
    /// Reads opened files.
    pub(super) opener: Reader,
    pub(super) record_reader: Reader,
    /// Dataset most recently made from records.
    pub(super) made_of_records: Option<DatasetOfRecords>,
    /// Action waiting for the answer whether unsaved decisions may be lost.
    pub(super) postponed: Option<PendingAction>,
    /// Whether the postponed action is carried out after saving.
    pub(super) goes_on_once_saved: bool,
    /// Command waiting for the answer whether to overwrite files.
    pub(super) overwriting: Option<Command>,
    /// Treatment of existing files: they are replaced only during the command that the engineer
    /// confirmed.
    pub(super) existing: Existing,
    pub(super) closing: bool,
    /// Report being written.
    pub(super) reporting: Option<ReportJob>,
    /// Datasets open before a reload, or after a reload that was undone.
    pub(super) earlier: Vec<LoadedDataset>,
    pub(super) autosave: Autosave,
    /// Set once the window has drawn a frame; gives the caller that opened the window access to the
    /// autosave.
    pub(super) drawn: Arc<OnceLock<Autosave>>,
    /// Lost studies by the number of the offer, until restored or discarded.
    pub(super) offers: Vec<Option<LostStudy>>,
    pub(super) disk: DiskWatch,
    /// Directory of the list of recent files; without it the list is not kept.
    pub(super) directory: Option<PathBuf>,
    /// Expansion of `~` in typed paths.
    pub(super) home: Option<PathBuf>,
    /// Target of the focus in the next frame.
    pub(super) next_focus: Option<NextFocus>,
    /// Last window title set.
    title: String,
    /// Study and condition of the newest request.
    requested: Option<(Study, ConditionId)>,
}

impl GdcmApp {
    /// Creates the window on a dataset or a study. Nothing is written to disk unless the engineer
    /// asks for it.
    pub fn new(ctx: &Context, opened: Opened) -> std::io::Result<Self> {
        Self::with(ctx, opened, Setup::default())
    }

    /// Creates the window on a dataset or a study; starts the compute threads and the threads that
    /// watch the disk.
    pub fn with(ctx: &Context, opened: Opened, setup: Setup) -> std::io::Result<Self> {
        palette::apply(ctx);
        ctx.add_plugin(KeyOrder::default());
        let (replies, received) = ReplySender::new(ctx);
        let jobs = BackgroundJobs::start(&setup.engine, &replies)?;
        let autosave = Autosave::start(
            setup.directory.as_deref(),
            setup.keep_after,
            replies.clone(),
        )?;
        let disk = DiskWatch::start(setup.look_every, replies.clone())?;
        let (mut state, loaded, saved) = Self::parts_of(opened);
        setup.preferences.apply(&mut state.display);
        let mut app = Self {
            ctx: ctx.clone(),
            state,
            loaded,
            saved,
            asked: None,
            jobs,
            proven: Vec::new(),
            needs: Vec::new(),
            replies,
            received,
            dialog_open: false,
            models: Reader::default(),
            opener: Reader::default(),
            record_reader: Reader::default(),
            made_of_records: None,
            postponed: None,
            goes_on_once_saved: false,
            overwriting: None,
            existing: Existing::Keep,
            closing: false,
            reporting: None,
            earlier: Vec::new(),
            autosave,
            drawn: Arc::default(),
            offers: Vec::new(),
            disk,
            directory: setup.directory,
            home: setup.home,
            next_focus: None,
            title: String::new(),
            requested: None,
        };
        let begins_there =
            app.state.is_example && app.state.display.opens_with == OpensWith::StartPage;
        app.state.on_start_page = begins_there && setup.trouble.is_none();
        setup
            .trouble
            .into_iter()
            .for_each(|words| app.notify_error(words));
        let is_first = setup.offers_tour && app.directory.as_deref().is_some_and(is_first_start);
        app.state.tour = is_first.then_some(0);
        app.look_for_recent();
        Ok(app)
    }

    /// Returns the state shown by the window.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Returns the time \[s\] on the window's clock.
    fn now(&self) -> f64 {
        self.ctx.input(|input| input.time)
    }

    /// Requests the results for the current study and condition, unless already requested.
    fn request(&mut self) {
        let now = self.now();
        let study = &self.state.study;
        let condition = self.state.condition().id();
        if self
            .requested
            .as_ref()
            .is_some_and(|(of, at)| *at == condition && asks_the_same(of, study))
        {
            return;
        }
        self.requested = Some((study.clone(), condition));
        let results = &mut self.state.results;
        results.requested += 1;
        results.stopped = false;
        results.waiting_since.get_or_insert(now);
        self.ask();
    }

    /// Sends the newest request with all available proofs.
    fn ask(&mut self) {
        let Some((study, condition)) = self.requested.clone() else {
            return;
        };
        let number = self.asked.as_ref().map_or(0, |job| job.number + 1);
        let generation = self.state.results.requested;
        let proofs = self.proven.clone();
        let replies = self.replies.clone();
        self.asked = Some(AnalysisJob {
            number,
            generation,
            study,
            condition,
            proofs,
            replies,
        });
    }

    /// Records that the live answer was stopped, by hand or by a fault; the displayed results stay.
    pub(super) fn answer_stopped(&mut self) {
        self.proven.clear();
        let results = &mut self.state.results;
        results.stopped = results.is_behind();
        results.waiting_since = None;
    }

    /// Requests the stopped computation again.
    pub(super) fn compute_again(&mut self) {
        self.requested = None;
        self.state
            .bars
            .retain(|bar| !matches!(bar, Bar::Fault { .. }));
        self.jobs.resume();
    }

    /// Applies the replies of the threads.
    fn receive(&mut self) {
        while let Ok(reply) = self.received.try_recv() {
            reply(self);
        }
        let now = self.now();
        let results = &mut self.state.results;
        results.background = self.jobs.told();
        results
            .background
            .proofs
            .extend(self.proven.iter().map(|(problem, _)| Arc::clone(problem)));
        results.background_since = results
            .background
            .is_busy()
            .then(|| results.background_since.unwrap_or(now));
    }

    /// Shows an analysis and requests the jobs that it leaves open.
    pub(super) fn answered(
        &mut self,
        job: AnalysisJob,
        (analysis, elapsed_ms): (Arc<Analysis>, f64),
    ) {
        let now = self.now();
        let results = &mut self.state.results;
        // A job repeated with a proof has the request number of the original job and took no time.
        if results.received != job.generation {
            results.elapsed_ms = elapsed_ms;
        }
        results.received = job.generation;
        results.analysis = Some(analysis);
        results.first = None;
        results.stopped &= results.is_behind();
        results.waiting_since = results.is_waiting().then_some(now);
        self.proven
            .retain(|(of, _)| !job.proofs.iter().any(|(proven, _)| Arc::ptr_eq(of, proven)));
        self.want_jobs();
    }

    /// Repeats the newest request with a proof. The live answer has already reported a problem
    /// without a solution.
    pub(super) fn take_proof(&mut self, job: ProofJob, proof: Result<Arc<Solution>, ProblemError>) {
        if let Ok(solution) = proof {
            self.proven.push((job.problem, solution));
            self.ask();
        }
    }

    /// Stores the curves of a condition if they belong to the displayed condition and dataset.
    pub(super) fn take_curves(&mut self, job: CurvesJob, curves: Option<Arc<ConditionCurves>>) {
        let Some(curves) = curves else { return };
        let study = &self.state.study;
        if Arc::ptr_eq(&job.dataset, &study.dataset) && job.condition == self.state.condition().id()
        {
            self.state.results.curves = Some((job, curves));
        }
    }

    /// Reports a panic: its effect, the decisions kept, and the details to send.
    pub(super) fn tell_fault(&mut self, ended: &str, fault: &Fault) {
        let sentence = format!(
            "A fault in the program ended {ended}; your decisions are kept and can be saved: please send this message, the \
             saved study and the dataset {} to the program's authors (gdcm {}: {}).",
            self.loaded.origin,
            env!("CARGO_PKG_VERSION"),
            fault.words(),
        );
        self.state
            .bars
            .retain(|bar| !matches!(bar, Bar::Fault { .. }));
        self.state.bars.push(Bar::Fault { sentence });
    }

    fn take_dropped_files(&mut self, commands: &mut Vec<Command>) {
        let dropped = self.ctx.input(|input| input.raw.dropped_files.clone());
        let paths: Vec<PathBuf> = dropped
            .iter()
            .map(|file| file.path().to_path_buf())
            .collect();
        // A single dataset or study is opened; several files, a folder, and files of other programs
        // are imported as models.
        match paths.as_slice() {
            [] => {}
            [path] if self.state.assembling.is_none() && !holds_models(path) => {
                commands.push(Command::Open(path.clone()))
            }
            // While the records of a condition are shown, dropped files are added to them.
            _ if self.state.assembling.is_none()
                && self.state.display.arrangement.is_shown(View::Records) =>
            {
                commands.push(RecordsCommand::Add(paths).into());
            }
            _ => commands.push(AssemblingCommand::Add(paths).into()),
        }
    }

    fn guard_closing(&mut self) {
        if self.ctx.input(|input| input.viewport().close_requested())
            && self.state.unsaved
            && !self.closing
        {
            self.ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.ask_to_lose(PendingAction::Quit);
        }
    }

    /// Updates the window's title if it has changed.
    fn name_window(&mut self) {
        let title = self.state.window_title();
        if title != self.title {
            self.ctx
                .send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    fn panels_ui(&mut self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let bar = Frame::new()
            .fill(palette.panel)
            .inner_margin(Margin::symmetric(12, 0));
        let state = &mut self.state;
        state.display.is_wide = ui.ctx().content_rect().width() >= WIDE;
        let top = Panel::top("menu bar").frame(bar).exact_size(36.0);
        top.show(ui, |ui| bars::menu_bar_ui(ui, state, palette, commands));
        if !state.bars.is_empty() {
            let frame = bar.inner_margin(Margin::symmetric(12, 4));
            Panel::top("bars")
                .frame(frame)
                .show(ui, |ui| bars::bars_ui(ui, &state.bars, palette, commands));
        }
        let status = Panel::bottom("status bar").frame(bar).exact_size(24.0);
        status.show(ui, |ui| bars::status_bar_ui(ui, state, palette, commands));
        if let Some(bench) = &mut state.assembling {
            return assembling_ui(ui, bench, palette, commands);
        }
        if state.on_start_page {
            CentralPanel::default()
                .frame(Frame::new())
                .show(ui, |ui| start_page::start_ui(ui, state, palette, commands));
            return;
        }
        let is_wide = state.display.is_wide;
        left_ui(ui, state, palette, commands);
        // The panel's name distinguishes the window widths for which its width was dragged.
        let (name, width) = if is_wide {
            ("answer", 352.0)
        } else {
            ("answer beside the rail", 320.0)
        };
        let side = Frame::new().fill(palette.panel);
        restore_panel_size(ui, name);
        let panel = Panel::right(name)
            .frame(side)
            .default_size(width)
            .size_range(300.0..=520.0);
        panel.show(ui, |ui| {
            steady_ui(ui, |ui| {
                answer_panel::answer_ui(ui, state, palette, commands)
            })
        });
        let middle = Frame::new();
        let centre = ui.available_rect_before_wrap();
        CentralPanel::default()
            .frame(middle)
            .show(ui, |ui| centre::centre_ui(ui, state, palette, commands));
        sheets_ui(ui, centre, state, palette, commands);
    }
}

/// Window width \[pt\] from which names and the full left panel fit.
const WIDE: f32 = 1400.0;

/// Draws conditions and models, in full or as a rail.
fn left_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let side = Frame::new().fill(palette.panel);
    if !state.display.left_open.unwrap_or(state.display.is_wide) {
        let frame = side.inner_margin(Margin {
            left: 4,
            right: 2,
            top: 2,
            bottom: 4,
        });
        let panel = Panel::left("rail").frame(frame).exact_size(104.0);
        panel.show(ui, |ui| {
            ScrollArea::vertical()
                .id_salt("rail")
                .auto_shrink(false)
                .show(ui, |ui| {
                    ui.set_width(ui.available_width());
                    conditions_panel::rail_ui(ui, state, palette, commands);
                });
        });
        return;
    }
    restore_panel_size(ui, "conditions and models");
    let panel = Panel::left("conditions and models")
        .frame(side)
        .default_size(272.0)
        .size_range(240.0..=420.0);
    panel.show(ui, |ui| {
        steady_ui(ui, |ui| {
            let frame = Frame::new().inner_margin(Margin {
                left: 12,
                right: 12,
                top: 4,
                bottom: 0,
            });
            frame.show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                let most = 0.45 * ui.available_height();
                ScrollArea::vertical()
                    .id_salt("conditions")
                    .max_height(most)
                    .auto_shrink([false, true])
                    .show(ui, |ui| {
                        conditions_panel::conditions_ui(ui, state, palette, commands);
                    });
                ui.separator();
                models_panel::models_ui(ui, state, palette, commands);
            });
        });
    });
}

/// Draws content that fills the available space without growing it, so that a panel keeps its
/// dragged width.
fn steady_ui(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let room = ui.available_rect_before_wrap();
    let mut content = ui.new_child(UiBuilder::new().max_rect(room).layout(*ui.layout()));
    content.set_clip_rect(room.intersect(ui.clip_rect()));
    add(&mut content);
    ui.advance_cursor_after_rect(room);
}

/// Draws the sheets over the middle of the window.
fn sheets_ui(ui: &Ui, centre: Rect, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let asked = state.display.asked.as_ref().map(|_| Sheet::Derivation);
    let Some(sheet) = asked.or(state.display.sheet) else {
        return;
    };
    let is_closed = sheet_ui(ui, centre, sheet, palette, |ui| match sheet {
        Sheet::Derivation => explanation::derivation_sheet_ui(ui, state, palette, commands),
        Sheet::Reasons => explanation::reasons_ui(ui, state, palette, commands),
        Sheet::Models => {
            models_panel::bundle_sheet_ui(ui, state, BundleKind::Physics, palette, commands)
        }
        Sheet::Identified => {
            models_panel::bundle_sheet_ui(ui, state, BundleKind::Identified, palette, commands)
        }
    });
    // A click outside may ask about another value, which is then shown.
    let asks = commands
        .iter()
        .any(|command| matches!(command, Command::Explain(_)));
    if is_closed && !asks {
        commands.push(if sheet == Sheet::Derivation {
            Command::Explain(None)
        } else {
            Command::ShowSheet(None)
        });
    }
}

impl Drop for GdcmApp {
    /// Keeps the latest decisions, even if the window panics.
    fn drop(&mut self) {
        self.autosave.close(LAST_WAIT);
    }
}

/// Returns whether two studies need the same results for the identical dataset. Datasets are
/// compared by pointer: comparing values would take time in every frame, and results belong to one
/// dataset even if another is equal.
fn asks_the_same(a: &Study, b: &Study) -> bool {
    Arc::ptr_eq(&a.dataset, &b.dataset) && a.settings == b.settings && a.choices == b.choices
}

/// Storage key of the preferences.
pub(super) const PREFERENCES: &str = "preferences";

impl eframe::App for GdcmApp {
    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, PREFERENCES, &Preferences::of(&self.state.display));
    }

    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        Palette::of(visuals).background.to_normalized_gamma_f32()
    }

    fn logic(&mut self, _: &Context, _frame: &mut eframe::Frame) {
        self.receive();
        self.look_for_records();
        self.watch_disk();
        self.guard_closing();
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        let palette = Palette::of(ui.visuals()).with_looks(self.state.display.looks);
        self.move_focus();
        let mut commands = keyboard::pressed(&ctx, &self.state);
        self.take_dropped_files(&mut commands);
        self.panels_ui(ui, &palette, &mut commands);
        forms::forms_ui(&ctx, &mut self.state, &palette, &mut commands);
        help::tour_ui(&ctx, &self.state, &palette, &mut commands);
        focus::focus_ring_ui(&ctx, &palette);
        self.drawn.get_or_init(|| self.autosave.clone());
        self.carry_out(commands);
        self.name_window();
        self.request();
        self.want_jobs();
        // Jobs that wait for the first picture start in the next frame, once this frame is on the
        // screen.
        if !self.state.results.is_painted && self.state.results.analysis.is_some() {
            self.state.results.is_painted = true;
            ctx.request_repaint();
        }
        if self.state.results.is_waiting() || self.state.results.background_since.is_some() {
            // The markers for stale results and for work under way appear by the clock, not by an
            // event.
            ctx.request_repaint_after(std::time::Duration::from_millis(160));
        }
    }
}
