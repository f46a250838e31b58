//! The window: its parts, how it begins and ends, and the steps in a frame ([`eframe::App::ui`]).

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use egui::{Context, Ui, ViewportCommand, Visuals};

use gdcm_io::Opened;
use gdcm_io::files::first_start::is_first_start;
use gdcm_io::files::opened_file::holds_models;

use super::autosave::Autosave;
use super::background_jobs::BackgroundJobs;
use super::background_work::BackgroundWork;
use super::disk_watch::DiskWatch;
use super::document_files::DocumentFiles;
use super::key_order::KeyOrder;
use super::layout_commands::NextFocus;
use super::postponed_actions::{PendingAction, PostponedActions};
use super::readers::Readers;
use super::recovery::{LAST_WAIT, Recovery};
use super::threads::ReplySender;
use super::window_panels::panels_ui;
use super::{Setup, keyboard};
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::panels::{forms, tour};
use crate::gui::state::notices::{Activity, NoticeAction};
use crate::gui::state::opens_with::OpensWith;
use crate::gui::state::preferences::Preferences;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::{escape_key, focus_ring, palette};
use crate::message::Message;

/// Time after which the window is drawn again while results are being computed.
const REPAINT_AFTER: Duration = Duration::from_millis(160);
/// Key for the preferences in eframe's storage.
pub(super) const PREFERENCES: &str = "preferences";

/// The window: the state that its views show, and the parts that use files and threads.
pub struct GdcmApp {
    pub(super) ctx: Context,
    pub(super) state: State,
    pub(super) files: DocumentFiles,
    /// Whether a desktop file dialog is open; there is at most one.
    pub(super) is_dialog_open: bool,
    pub(super) postponed: PostponedActions,
    pub(super) readers: Readers,
    pub(super) work: BackgroundWork,
    pub(super) recovery: Recovery,
    /// Focus target in the next frame.
    pub(super) next_focus: Option<NextFocus>,
    /// Window title that was set last.
    title: String,
}

impl GdcmApp {
    /// Creates the window with a dataset or a study. Nothing is written to disk unless the engineer
    /// asks for it.
    pub fn new(ctx: &Context, opened: Opened) -> std::io::Result<Self> {
        Self::with_setup(ctx, opened, Setup::default())
    }

    /// Creates the window with a dataset or a study; starts the threads that compute, keep unsaved
    /// decisions and watch the disk.
    pub fn with_setup(ctx: &Context, opened: Opened, setup: Setup) -> std::io::Result<Self> {
        palette::apply(ctx);
        ctx.add_plugin(KeyOrder::default());
        let (replies, reply_receiver) = ReplySender::new(ctx);
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
            files: DocumentFiles {
                loaded,
                saved,
                replaced_datasets: Vec::new(),
                made_of_records: None,
                last_folder: None,
                disk,
                directory: setup.directory,
                home: setup.home,
            },
            is_dialog_open: false,
            postponed: PostponedActions::new(),
            readers: Readers::default(),
            work: BackgroundWork {
                live_job: None,
                jobs,
                new_proofs: Vec::new(),
                needs: Vec::new(),
                newest_request: None,
                report_job: None,
                report_number: 0,
                replies,
                reply_receiver,
            },
            recovery: Recovery {
                autosave,
                autosave_once_drawn: Arc::default(),
                offers: Vec::new(),
            },
            next_focus: None,
            title: String::new(),
        };
        app.show_first_page(setup.trouble, setup.offers_tour);
        app.list_open_file_as_recent();
        Ok(app)
    }

    /// Shows a problem found at the start, or else the start page if the preferences ask for it; at
    /// the first start also the guided tour.
    fn show_first_page(&mut self, trouble: Option<Message>, offers_tour: bool) {
        self.state.on_start_page = self.state.example.is_some()
            && self.state.display.layout.opens_with == OpensWith::StartPage
            && trouble.is_none();
        if let Some(trouble) = trouble {
            let remedy = Some(NoticeAction::OpenAnother);
            self.notify_error_of(Activity::Opening, trouble, remedy);
        }
        if offers_tour
            && let Some(directory) = &self.files.directory
            && is_first_start(directory)
        {
            self.state.tour = Some(0);
        }
    }

    pub fn state(&self) -> &State {
        &self.state
    }

    /// Returns the time \[s\] on the window's clock.
    pub(super) fn now(&self) -> f64 {
        self.ctx.input(|input| input.time)
    }

    /// Opens or imports the files dropped on the window, by the first rule that applies:
    ///
    /// 1. while models are imported, everything is added to the import;
    /// 2. a single dataset or study is opened;
    /// 3. while the Records view is shown, the files are added as records;
    /// 4. several files, a folder, and files from other programs are imported as models.
    fn take_dropped_files(&mut self, commands: &mut Vec<Command>) {
        let dropped = self.ctx.input(|input| input.raw.dropped_files.clone());
        let paths: Vec<PathBuf> = dropped
            .iter()
            .map(|file| file.path().to_path_buf())
            .collect();
        let is_importing = self.state.assembling.is_some();
        let arrangement = &self.state.display.layout.arrangement;
        let command: Command = match paths.as_slice() {
            [] => return,
            // Rule 1.
            _ if is_importing => AssemblingCommand::Add(paths).into(),
            // Rule 2.
            [path] if !holds_models(path) => FileCommand::Open(path.clone()).into(),
            // Rule 3.
            _ if arrangement.is_shown(View::Records) => RecordsCommand::Add(paths).into(),
            // Rule 4.
            _ => AssemblingCommand::Add(paths).into(),
        };
        commands.push(command);
    }

    /// Asks for confirmation before closing the window loses unsaved decisions.
    fn guard_closing(&mut self) {
        if self.ctx.input(|input| input.viewport().close_requested())
            && self.state.unsaved
            && !self.postponed.closing
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
}

impl Drop for GdcmApp {
    /// Saves the latest decisions to the recovery file, even if the window panics.
    fn drop(&mut self) {
        self.recovery.autosave.close(LAST_WAIT);
    }
}

impl eframe::App for GdcmApp {
    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(
            storage,
            PREFERENCES,
            &Preferences::from_display(&self.state.display),
        );
    }

    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        Palette::from_visuals(visuals)
            .background
            .to_normalized_gamma_f32()
    }

    fn logic(&mut self, _: &Context, _frame: &mut eframe::Frame) {
        self.receive_replies();
        self.pass_time_of_toasts();
        self.look_for_records();
        self.watch_disk();
        self.guard_closing();
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        let palette =
            Palette::from_visuals(ui.visuals()).with_looks(self.state.display.curves.looks);
        // 1. Keys, dropped files, panels and forms push commands.
        self.move_focus();
        let mut commands = keyboard::pressed(&ctx, &self.state);
        self.take_dropped_files(&mut commands);
        panels_ui(ui, &mut self.state, &palette, &mut commands);
        forms::forms_ui(&ctx, &mut self.state, &palette, &mut commands);
        tour::tour_ui(&ctx, &self.state, &palette, &mut commands);
        focus_ring::focus_ring_ui(&ctx, &palette);
        escape_key::note_focus(&ctx);
        // The first frame hands the autosave over to `launch.rs`.
        self.recovery
            .autosave_once_drawn
            .get_or_init(|| self.recovery.autosave.clone());
        // 2. The commands change the state.
        self.carry_out(commands);
        self.name_window();
        // 3. The changed state requests new results; `logic` receives them before a later frame.
        self.request_results();
        self.want_jobs();
        // Jobs that wait until the first results are on the screen start in the next frame.
        if !self.state.results.is_painted && self.state.results.analysis.is_some() {
            self.state.results.is_painted = true;
            ctx.request_repaint();
        }
        if self.state.results.is_waiting() || self.state.results.background_since.is_some() {
            // Repaint later without an event: the marks for stale results and running work appear
            // after a delay.
            ctx.request_repaint_after(REPAINT_AFTER);
        }
    }
}
