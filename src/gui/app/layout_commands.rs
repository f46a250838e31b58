//! Commands that change the layout and the focus.
//!
//! The *arrangement* says which views are shown: in front, beside the front view and in the dock. A
//! *sheet* is drawn over the views until it is closed. A *region* is a part of the window, such as
//! a panel; F6 moves the focus from one to the next.

use super::GdcmApp;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::state::view::View;
use crate::gui::state::view_arrangement::Arrangement;
use crate::gui::views::compare::VARIANT_NAME;
use crate::gui::views::view_content;
use crate::gui::widgets::number_field::focus_field;
use crate::gui::widgets::page_switch::neighbouring_page;
use crate::gui::widgets::window_regions::leave_region;

/// Target of a requested focus change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NextFocus {
    /// The field with this name.
    Field {
        name: &'static str,
        /// Number of frames to wait for a field that has not been drawn yet.
        frames: u8,
    },
    /// The next or the previous window region.
    Region { forward: bool },
}

impl NextFocus {
    /// Number of frames within which a newly opened section draws its fields; if the field is
    /// still missing then, the focus stays where it is.
    const FRAMES: u8 = 3;

    fn field(name: &'static str) -> Self {
        Self::Field {
            name,
            frames: Self::FRAMES,
        }
    }
}

impl GdcmApp {
    pub(super) fn carry_out_layout(&mut self, command: LayoutCommand) {
        let display = &mut self.state.display;
        match command {
            LayoutCommand::ShowView(view) => {
                self.state.on_start_page = false;
                self.state.display.layout.arrangement.show(view);
            }
            LayoutCommand::TurnPage { forward } => self.turn_page(forward),
            LayoutCommand::ShowGroup(group) => display.layout.arrangement.show_group(group),
            LayoutCommand::ShowBeside(view) => display.layout.arrangement.show_beside(view),
            LayoutCommand::ShowInDock(view) => display.layout.arrangement.dock_view(view),
            LayoutCommand::OpenDock(is_open) => display.layout.arrangement.open_dock(is_open),
            LayoutCommand::EnlargeDock(is_enlarged) => {
                display.layout.arrangement.enlarge_dock(is_enlarged);
            }
            LayoutCommand::ResetLayout => {
                display.layout.arrangement = Arrangement::default();
                // The left panel follows the window's width again.
                display.layout.left_open = None;
                self.ctx.memory_mut(|memory| memory.reset_areas());
            }
            LayoutCommand::ShowLeft(is_open) => display.layout.left_open = Some(is_open),
            LayoutCommand::ShowSheet(sheet) => display.layout.show_sheet(sheet),
            LayoutCommand::ShowSettings(is_open) => display.layout.show_settings(is_open),
            LayoutCommand::ShowAdvanced(is_open) => display.layout.advanced_open = is_open,
            LayoutCommand::ShowIdentified(is_open) => display.layout.identified_open = is_open,
            LayoutCommand::SetTheme(theme) => self.ctx.set_theme(theme),
            LayoutCommand::FocusField(name) => {
                // Open the collapsed sections: a hidden field cannot receive the focus.
                display.layout.show_settings(true);
                display.layout.advanced_open = true;
                self.focus_next(NextFocus::field(name));
            }
            LayoutCommand::NameVariant => {
                display.layout.arrangement.show(View::Compare);
                self.focus_next(NextFocus::field(VARIANT_NAME));
            }
            LayoutCommand::LeaveRegion { forward } => {
                self.focus_next(NextFocus::Region { forward })
            }
            LayoutCommand::StartTour => self.state.tour = Some(0),
            LayoutCommand::ShowTourStep(step) => self.state.tour = step,
            LayoutCommand::ShowStart(is_shown) => self.state.on_start_page = is_shown,
            LayoutCommand::BeginWith(first_content) => display.layout.opens_with = first_content,
        }
    }

    /// Shows the page after or before the shown page in the front view, wrapping around, if the
    /// view has several pages.
    fn turn_page(&mut self, forward: bool) {
        let view = self.state.display.layout.arrangement.view();
        let pages = (view_content(view).pages)(&self.state);
        let shown: Vec<bool> = pages.iter().map(|page| page.is_shown).collect();
        let by = if forward { 1 } else { -1 };
        if let Some(index) = neighbouring_page(&shown, by) {
            self.carry_out(vec![pages[index].command.clone()]);
        }
    }

    /// Moves the focus before the next frame is drawn, so that the widget can react to being newly
    /// focused.
    fn focus_next(&mut self, next: NextFocus) {
        self.next_focus = Some(next);
        self.ctx.request_repaint();
    }

    /// Moves the focus to a field; if it is not drawn yet, as in a section that has just been
    /// opened, tries again in up to `frames` further frames.
    fn focus_field_within(&mut self, name: &'static str, frames: u8) {
        if !focus_field(&self.ctx, name) && frames > 0 {
            let frames = frames - 1;
            self.focus_next(NextFocus::Field { name, frames });
        }
    }

    /// Moves the focus to the requested target; waits while a form or another modal layer is open.
    pub(super) fn move_focus(&mut self) {
        if self.state.forms.shown.is_some()
            || self.ctx.memory(|memory| memory.top_modal_layer().is_some())
        {
            return;
        }
        match self.next_focus.take() {
            Some(NextFocus::Field { name, frames }) => self.focus_field_within(name, frames),
            Some(NextFocus::Region { forward }) => leave_region(&self.ctx, forward),
            None => {}
        }
    }
}
