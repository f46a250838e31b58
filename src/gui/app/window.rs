//! The window: its state, the compute threads, and the dialogs.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{
    CentralPanel, Context, Frame, Margin, Panel, Rect, ScrollArea, Ui, UiBuilder, ViewportCommand,
    Visuals,
};

use gdcm_io::Opened;
use gdcm_io::files::first_start::is_first_start;
use gdcm_io::files::opened_file::holds_models;
use gdcm_model::dataset::BundleKind;

use super::autosave::Autosave;
use super::background_jobs::BackgroundJobs;
use super::computation::Computation;
use super::dialogs::{Dialogs, PendingAction};
use super::disk_watch::DiskWatch;
use super::document_files::DocumentFiles;
use super::keyboard::KeyOrder;
use super::layout_commands::NextFocus;
use super::readers::Readers;
use super::recovery::{LAST_WAIT, Recovery};
use super::threads::ReplySender;
use super::{Setup, keyboard};
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::commands::file::FileCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::panels::explanation::sheet_ui;
use crate::gui::panels::{
    answer_panel, bars, centre, conditions_panel, explanation, forms, help, models_panel, reasons,
    start_page, status_bar,
};
use crate::gui::state::opens_with::OpensWith;
use crate::gui::state::preferences::Preferences;
use crate::gui::state::sheet::Sheet;
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::views::assembling::assembling_ui;
use crate::gui::widgets::controls::restore_panel_size;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::{focus, palette};

/// The program's window.
pub struct GdcmApp {
    pub(super) ctx: Context,
    pub(super) state: State,
    pub(super) files: DocumentFiles,
    pub(super) dialogs: Dialogs,
    pub(super) readers: Readers,
    pub(super) work: Computation,
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
        Self::with(ctx, opened, Setup::default())
    }

    /// Creates the window with a dataset or a study; starts the compute threads and the thread that
    /// watches the disk.
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
            files: DocumentFiles {
                loaded,
                saved,
                earlier: Vec::new(),
                made_of_records: None,
                disk,
                directory: setup.directory,
                home: setup.home,
            },
            dialogs: Dialogs::new(),
            readers: Readers::default(),
            work: Computation {
                asked: None,
                jobs,
                proven: Vec::new(),
                needs: Vec::new(),
                requested: None,
                reporting: None,
                replies,
                received,
            },
            recovery: Recovery {
                autosave,
                drawn: Arc::default(),
                offers: Vec::new(),
            },
            next_focus: None,
            title: String::new(),
        };
        app.state.on_start_page = app.state.is_example
            && app.state.display.layout.opens_with == OpensWith::StartPage
            && setup.trouble.is_none();
        if let Some(trouble) = setup.trouble {
            app.notify_error(trouble);
        }
        if setup.offers_tour
            && let Some(directory) = &app.files.directory
            && is_first_start(directory)
        {
            app.state.tour = Some(0);
        }
        app.look_for_recent();
        Ok(app)
    }

    /// Returns the state shown by the window.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Opens or imports the files dropped on the window.
    fn take_dropped_files(&mut self, commands: &mut Vec<Command>) {
        let dropped = self.ctx.input(|input| input.raw.dropped_files.clone());
        let paths: Vec<PathBuf> = dropped
            .iter()
            .map(|file| file.path().to_path_buf())
            .collect();
        // A single dataset or study is opened; several files, a folder, and files from other
        // programs are imported as models.
        let is_importing = self.state.assembling.is_some();
        let arrangement = &self.state.display.layout.arrangement;
        match paths.as_slice() {
            [] => {}
            [path] if !is_importing && !holds_models(path) => {
                commands.push(FileCommand::Open(path.clone()).into())
            }
            // While a condition's records are shown, dropped files are added to them.
            _ if !is_importing && arrangement.is_shown(View::Records) => {
                commands.push(RecordsCommand::Add(paths).into());
            }
            _ => commands.push(AssemblingCommand::Add(paths).into()),
        }
    }

    /// Asks for confirmation before closing the window loses unsaved decisions.
    fn guard_closing(&mut self) {
        if self.ctx.input(|input| input.viewport().close_requested())
            && self.state.unsaved
            && !self.dialogs.closing
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

    /// Draws the bars, the side panels and the middle, or the page that covers them.
    fn panels_ui(&mut self, ui: &mut Ui, palette: &Palette, commands: &mut Vec<Command>) {
        let bar = Frame::new()
            .fill(palette.panel)
            .inner_margin(Margin::symmetric(12, 0));
        let state = &mut self.state;
        state.display.layout.is_wide = ui.ctx().content_rect().width() >= WIDE;
        let top = Panel::top("menu bar").frame(bar).exact_size(36.0);
        top.show(ui, |ui| bars::menu_bar_ui(ui, state, palette, commands));
        if !state.bars.is_empty() {
            let frame = bar.inner_margin(Margin::symmetric(12, 4));
            Panel::top("bars")
                .frame(frame)
                .show(ui, |ui| bars::bars_ui(ui, &state.bars, palette, commands));
        }
        let status = Panel::bottom("status bar").frame(bar).exact_size(24.0);
        status.show(ui, |ui| {
            status_bar::status_bar_ui(ui, state, palette, commands)
        });
        if let Some(bench) = &mut state.assembling {
            return assembling_ui(ui, bench, palette, commands);
        }
        if state.on_start_page {
            CentralPanel::default()
                .frame(Frame::new())
                .show(ui, |ui| start_page::start_ui(ui, state, palette, commands));
            return;
        }
        left_ui(ui, state, palette, commands);
        right_ui(ui, state, palette, commands);
        let middle = Frame::new();
        let centre = ui.available_rect_before_wrap();
        CentralPanel::default()
            .frame(middle)
            .show(ui, |ui| centre::centre_ui(ui, state, palette, commands));
        sheets_ui(ui, centre, state, palette, commands);
    }
}

/// Minimum window width \[pt\] for full names and the full left panel.
const WIDE: f32 = 1400.0;

/// Draws the left panel with conditions and models, in full or as a narrow rail.
fn left_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let side = Frame::new().fill(palette.panel);
    let layout = &state.display.layout;
    if !layout.left_open.unwrap_or(layout.is_wide) {
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

/// Draws the right panel: verdict, result, matrix, and export.
fn right_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    // Panel widths are stored by name: with two names, wide and narrow windows keep separate
    // widths.
    let (name, width) = if state.display.layout.is_wide {
        ("answer", 352.0)
    } else {
        ("answer beside the rail", 320.0)
    };
    restore_panel_size(ui, name);
    let panel = Panel::right(name)
        .frame(Frame::new().fill(palette.panel))
        .default_size(width)
        .size_range(300.0..=520.0);
    panel.show(ui, |ui| {
        steady_ui(ui, |ui| {
            answer_panel::answer_ui(ui, state, palette, commands)
        })
    });
}

/// Draws content within the available space without growing it, so that a panel keeps its dragged
/// width.
fn steady_ui(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let room = ui.available_rect_before_wrap();
    let mut content = ui.new_child(UiBuilder::new().max_rect(room).layout(*ui.layout()));
    content.set_clip_rect(room.intersect(ui.clip_rect()));
    add(&mut content);
    ui.advance_cursor_after_rect(room);
}

/// Draws the open sheet, if any, over the views.
fn sheets_ui(ui: &Ui, centre: Rect, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let sheet = if state.display.selection.asked.is_some() {
        Sheet::Derivation
    } else if let Some(sheet) = state.display.layout.sheet {
        sheet
    } else {
        return;
    };
    let is_closed = sheet_ui(ui, centre, sheet, palette, |ui| match sheet {
        Sheet::Derivation => explanation::derivation_sheet_ui(ui, state, palette, commands),
        Sheet::Reasons => reasons::reasons_ui(ui, state, palette, commands),
        Sheet::Models => {
            models_panel::bundle_sheet_ui(ui, state, BundleKind::Physics, palette, commands)
        }
        Sheet::Identified => {
            models_panel::bundle_sheet_ui(ui, state, BundleKind::Identified, palette, commands)
        }
    });
    // A click outside closes the sheet, unless it asks for the derivation of another value.
    let asks = commands
        .iter()
        .any(|command| matches!(command, Command::Selection(SelectionCommand::Explain(_))));
    if is_closed && !asks {
        let close = if sheet == Sheet::Derivation {
            Command::Selection(SelectionCommand::Explain(None))
        } else {
            Command::Layout(LayoutCommand::ShowSheet(None))
        };
        commands.push(close);
    }
}

impl Drop for GdcmApp {
    /// Saves the latest decisions to the recovery file, even if the window panics.
    fn drop(&mut self) {
        self.recovery.autosave.close(LAST_WAIT);
    }
}

pub(super) const PREFERENCES: &str = "preferences";

impl eframe::App for GdcmApp {
    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(
            storage,
            PREFERENCES,
            &Preferences::from_display(&self.state.display),
        );
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
        let palette = Palette::of(ui.visuals()).with_looks(self.state.display.curves.looks);
        self.move_focus();
        let mut commands = keyboard::pressed(&ctx, &self.state);
        self.take_dropped_files(&mut commands);
        self.panels_ui(ui, &palette, &mut commands);
        forms::forms_ui(&ctx, &mut self.state, &palette, &mut commands);
        help::tour_ui(&ctx, &self.state, &palette, &mut commands);
        focus::focus_ring_ui(&ctx, &palette);
        self.recovery
            .drawn
            .get_or_init(|| self.recovery.autosave.clone());
        self.carry_out(commands);
        self.name_window();
        self.request();
        self.want_jobs();
        // Jobs that wait until the first results are on the screen start in the next frame.
        if !self.state.results.is_painted && self.state.results.analysis.is_some() {
            self.state.results.is_painted = true;
            ctx.request_repaint();
        }
        if self.state.results.is_waiting() || self.state.results.background_since.is_some() {
            // Repaint later without an event: the marks of stale results and of running work appear
            // after a delay.
            ctx.request_repaint_after(std::time::Duration::from_millis(160));
        }
    }
}
