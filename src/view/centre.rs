//! The middle of the window: the views in tabs that can be dragged, split and resized.

use egui::{Align, Color32, FontId, Frame, Id, Layout, Margin, Response, RichText, Stroke, Ui, Visuals, WidgetText};
use egui_tiles::{
    Behavior, Container, LinearDir, SimplificationOptions, TabState, Tabs, Tile, TileId, Tiles, Tree, UiResponse,
};

use super::{BODY_SIZE, Command, Palette, Region, State, View, ViewTitle, entries_ui, figure_button_ui, region_ui};

/// Height of a row of tabs \[pt\].
const TAB_HEIGHT: f32 = 26.0;
/// Space left and right of the name on a tab \[pt\].
const TAB_MARGIN: f32 = 9.0;
/// Space that the row of tabs needs besides the tabs, so that it does not scroll \[pt\].
const TAB_SLACK: f32 = 28.0;
/// A title is not narrower \[pt\].
const LEAST_TITLE: f32 = 60.0;
/// Least size of a view \[pt\].
const LEAST_VIEW: f32 = 150.0;

/// Everything between the side panels.
pub fn centre_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let mut tree = std::mem::replace(&mut state.display.arrangement.tree, Tree::empty(Id::unique("views")));
    tree.ui(&mut Views { state, palette, commands, below: Vec::new() }, ui);
    state.display.arrangement.tree = tree;
}

/// What the tiles show.
struct Views<'a> {
    state: &'a mut State,
    palette: &'a Palette,
    commands: &'a mut Vec<Command>,
    /// Views whose header has no room beside the tabs: it stands below them.
    below: Vec<View>,
}

impl Views<'_> {
    fn header_ui(&mut self, ui: &mut Ui, view: View) {
        let (state, palette, kind) = (&*self.state, self.palette, view.kind());
        if kind.figure.is_some() && kind.tools_width > 0.0 {
            figure_button_ui(ui, view, self.commands);
        }
        (kind.tools)(ui, state, palette, self.commands);
        title_ui(ui, state, kind.title, palette);
        if kind.is_of_all_conditions {
            older_ui(ui, state, palette);
        }
    }
}

/// Which response and which condition a view shows.
fn title_ui(ui: &mut Ui, state: &State, title: ViewTitle, palette: &Palette) {
    let condition = state.condition();
    let of_condition = format!("condition {} · {}", condition.id(), condition.flight_state().name);
    let title = match title {
        ViewTitle::Response => format!("{} · {of_condition}", state.dataset().pair_name(state.display.pair)),
        ViewTitle::Condition => of_condition,
        ViewTitle::None => return,
    };
    // A title of a few letters says nothing.
    if ui.available_width() > LEAST_TITLE {
        let text = palette.small(&title);
        ui.add(egui::Label::new(text).truncate());
    }
}

/// Says that what stands beside is of older settings than the result of the condition shown.
fn older_ui(ui: &mut Ui, state: &State, palette: &Palette) {
    if state.others_are_older() {
        let text = palette.small_warning("of older settings");
        ui.label(text).on_hover_text("The condition shown is computed anew already; the others are on their way");
    }
}

/// Whether a tile is the one shown of its tabs.
fn is_in_front(tiles: &Tiles<View>, tile: TileId) -> bool {
    let parent = tiles.parent_of(tile).and_then(|parent| tiles.get(parent));
    matches!(parent, Some(Tile::Container(Container::Tabs(tabs))) if tabs.active == Some(tile))
}

impl Behavior<View> for Views<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, view: &mut View) -> UiResponse {
        if self.below.contains(view) && view.kind().tools_width > 0.0 {
            let layout = Layout::right_to_left(Align::Center).with_main_wrap(true);
            let size = egui::vec2(ui.available_width(), TAB_HEIGHT);
            ui.allocate_ui_with_layout(size, layout, |ui| self.header_ui(ui, *view));
        }
        let frame = Frame::new().inner_margin(Margin { top: 4, ..Margin::ZERO });
        let (state, palette) = (&mut *self.state, self.palette);
        let commands = &mut *self.commands;
        let draw = view.kind().draw;
        frame.show(ui, |ui| region_ui(ui, Region::Plots, |ui| draw(ui, state, palette, commands)));
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, view: &View) -> WidgetText {
        RichText::new(view.name()).size(BODY_SIZE).into()
    }

    fn on_tab_button(&mut self, tiles: &mut Tiles<View>, tile: TileId, tab: Response) -> Response {
        let Some(view) = tiles.get_pane(&tile).copied() else { return tab };
        if is_in_front(tiles, tile) {
            let line = tab.rect.with_max_y(tab.rect.top() + 2.0);
            tab.ctx.layer_painter(tab.layer_id).with_clip_rect(tab.interact_rect).rect_filled(
                line,
                0.0,
                self.palette.accent,
            );
        }
        tab.context_menu(|ui| {
            let places = [
                ("Put beside the others", Command::SplitView(view, LinearDir::Horizontal)),
                ("Put below the others", Command::SplitView(view, LinearDir::Vertical)),
            ];
            entries_ui(ui, places, self.commands);
        });
        tab.on_hover_text(format!("{}. Drag the tab to split the plots; right-click: more", view.kind().purpose))
    }

    fn top_bar_right_ui(&mut self, tiles: &Tiles<View>, ui: &mut Ui, _tile: TileId, tabs: &Tabs, _scroll: &mut f32) {
        let names = tabs.children.iter().filter_map(|child| tiles.get_pane(child)).map(|view| view.name());
        let font = FontId::proportional(BODY_SIZE);
        let width = |name: &str| {
            ui.fonts_mut(|fonts| fonts.layout_no_wrap(name.to_owned(), font.clone(), Color32::PLACEHOLDER).size().x)
        };
        let of_tabs: f32 = names.map(|name| width(name) + 2.0 * TAB_MARGIN).sum();
        let active = tabs.active.and_then(|active| tiles.get_pane(&active)).copied();
        let Some(view) = active else { return };
        // The tabs come first: what is left is the header's.
        let room = (ui.available_width() - of_tabs - TAB_SLACK).max(0.0);
        if room < view.kind().tools_width {
            self.below.push(view);
            return;
        }
        let size = egui::vec2(room, ui.available_height());
        ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
            ui.set_max_width(room);
            ui.add_space(4.0);
            self.header_ui(ui, view);
        });
    }

    fn tab_bar_height(&self, _style: &egui::Style) -> f32 {
        TAB_HEIGHT
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        4.0
    }

    fn min_size(&self) -> f32 {
        LEAST_VIEW
    }

    fn simplification_options(&self) -> SimplificationOptions {
        // Every view keeps its tab, alone too: it can be dragged by it.
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }

    fn tab_title_spacing(&self, _visuals: &Visuals) -> f32 {
        TAB_MARGIN
    }

    fn tab_bar_color(&self, _visuals: &Visuals) -> Color32 {
        self.palette.panel
    }

    fn tab_bg_color(&self, _visuals: &Visuals, _tiles: &Tiles<View>, _tile: TileId, state: &TabState) -> Color32 {
        if state.active { self.palette.background } else { Color32::TRANSPARENT }
    }

    fn tab_outline_stroke(&self, _visuals: &Visuals, _tiles: &Tiles<View>, _tile: TileId, _state: &TabState) -> Stroke {
        Stroke::NONE
    }

    fn tab_text_color(&self, _visuals: &Visuals, _tiles: &Tiles<View>, _tile: TileId, state: &TabState) -> Color32 {
        if state.active { self.palette.text } else { self.palette.dim_text }
    }
}
