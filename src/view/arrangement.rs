//! Which views there are, what each needs, and how they share the middle of the window.

use std::sync::Arc;

use egui::{Button, Id, Role, Ui, WidgetInfo};
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

use gdcm_core::study::{AcrossJob, AssessmentJob, ModesJob, SimulationJob, VariantJob};
use gdcm_files::figure::FigureKind;

use super::views::across_job;
use super::views::assessment_choice;
use super::views::variant_jobs;
use super::{Command, Palette, State};
use super::{records, views};

/// One of the plots between the side panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum View {
    /// The focused response: magnitude and phase.
    Bode,
    /// What the fit sees of it.
    Error,
    /// Every response, small.
    Overview,
    /// One response in every condition.
    Across,
    /// Poles and modes of every model of the condition.
    Poles,
    /// Channel gains against airspeed (Figures 3 and 4).
    Channels,
    /// What the correction is worth (Figures 8 to 19).
    Assessment,
    /// What the scatter of the gains is made of, and what speaks for the schedule.
    Evidence,
    /// Decisions kept under names, beside the present ones.
    Compare,
    /// Net gains against airspeed (Figures 6 and 7).
    NetGain,
    /// Flight records of the condition, and models identified from them.
    Records,
}

impl View {
    /// Every view, in the order of the menu.
    pub const ALL: [Self; 11] = [
        Self::Bode,
        Self::Overview,
        Self::Across,
        Self::Poles,
        Self::Records,
        Self::Channels,
        Self::Assessment,
        Self::Evidence,
        Self::Compare,
        Self::NetGain,
        Self::Error,
    ];

    /// What its tab says.
    pub fn name(self) -> &'static str {
        self.kind().name
    }

    /// All that the window knows of it: tabs, menus, the palette, background jobs and figures read this list.
    pub fn kind(self) -> ViewKind {
        match self {
            Self::Bode => ViewKind {
                title: ViewTitle::Response,
                tools: |ui, _, _, commands| fit_ui(ui, "Fit", commands),
                tools_width: 90.0,
                figure: Some(FigureKind::Bode),
                ..ViewKind::new("Bode", "Magnitude and phase of the response in focus", views::bode_view_ui)
            },
            Self::Error => ViewKind {
                title: ViewTitle::Response,
                tools: |ui, state, _, commands| {
                    fit_ui(ui, "Fit the errors", commands);
                    views::error_header_ui(ui, state, commands);
                },
                tools_width: 260.0,
                is_lower: true,
                figure: Some(FigureKind::Error),
                ..ViewKind::new(
                    "Error",
                    "What the fit sees: the ratio and the phase difference of the response in focus, and G, D and bounds",
                    views::error_view_ui,
                )
            },
            Self::Overview => ViewKind {
                title: ViewTitle::Condition,
                tools_width: 90.0,
                figure: Some(FigureKind::Overview),
                ..ViewKind::new("Overview", "Every response of the condition, small", views::overview_view_ui)
            },
            Self::Across => ViewKind {
                tools: views::across_header_ui,
                tools_width: 330.0,
                needs: |state| vec![Need::Across(across_job(state))],
                figure: Some(FigureKind::Airspeeds),
                ..ViewKind::new(
                    "Airspeeds",
                    "The response in focus in every condition, coloured by airspeed",
                    views::across_view_ui,
                )
            },
            Self::Poles => ViewKind {
                title: ViewTitle::Condition,
                tools: |ui, state, _, commands| views::poles_header_ui(ui, state, commands),
                tools_width: 180.0,
                needs: |state| {
                    let condition = state.dataset().condition(state.condition().id());
                    condition.map(|of| Need::Modes(ModesJob { condition: Arc::clone(of) })).into_iter().collect()
                },
                figure: Some(FigureKind::Poles),
                ..ViewKind::new(
                    "Poles",
                    "Poles of every model of the condition in the s-plane, and the modes in a table",
                    views::poles_view_ui,
                )
            },
            Self::Records => ViewKind {
                title: ViewTitle::Condition,
                tools: |ui, state, _, commands| records::records_header_ui(ui, state, commands),
                tools_width: 380.0,
                needs: |state| records::simulation_jobs(state).into_iter().map(Need::Simulation).collect(),
                ..ViewKind::new(
                    "Records",
                    "Flight records of the condition, and models identified from them",
                    records::records_view_ui,
                )
            },
            Self::Channels => ViewKind {
                tools: |ui, state, _, commands| views::channels_header_ui(ui, state, commands),
                tools_width: 410.0,
                is_of_all_conditions: true,
                figure: Some(FigureKind::Channels),
                ..ViewKind::new("Channels", "Gain of every channel against airspeed", views::channels_view_ui)
            },
            Self::Assessment => ViewKind {
                tools: |ui, state, _, commands| views::assessment_header_ui(ui, state, commands),
                tools_width: 640.0,
                is_of_all_conditions: true,
                needs: |state| {
                    let analysis = state.results.analysis.as_ref().filter(|_| state.analysis().is_some());
                    let choice = assessment_choice(state);
                    let job = analysis.map(|analysis| AssessmentJob { analysis: Arc::clone(analysis), choice });
                    job.map(Need::Assessment).into_iter().collect()
                },
                figure: Some(FigureKind::Assessment),
                ..ViewKind::new(
                    "Assessment",
                    "What the correction is worth, condition by condition",
                    views::assessment_view_ui,
                )
            },
            // The button of its figure stands in its first line: it has no tools.
            Self::Evidence => ViewKind {
                is_of_all_conditions: true,
                figure: Some(FigureKind::Evidence),
                ..ViewKind::new(
                    "Evidence",
                    "What the scatter of the net gains is made of, which differences are significant, and what the schedule needs",
                    views::evidence_view_ui,
                )
            },
            Self::Compare => ViewKind {
                needs: |state| variant_jobs(state).into_iter().map(Need::Variant).collect(),
                ..ViewKind::new(
                    "Compare",
                    "Variants: decisions kept under names, beside the present ones",
                    views::compare_view_ui,
                )
            },
            Self::NetGain => ViewKind {
                tools: views::net_gain_header_ui,
                tools_width: views::NET_GAIN_CONTROLS,
                is_of_all_conditions: true,
                is_lower: true,
                figure: Some(FigureKind::NetGain),
                ..ViewKind::new(
                    "Net gain",
                    "Net gain of the held responses against airspeed, with the schedule",
                    views::net_gain_view_ui,
                )
            },
        }
    }
}

/// One kind of view: what it shows, which background results it needs, and its tools.
#[derive(Clone, Copy)]
pub struct ViewKind {
    /// What its tab says.
    pub name: &'static str,
    /// What it shows, in a sentence.
    pub purpose: &'static str,
    /// Draws it.
    pub draw: fn(&mut Ui, &mut State, &Palette, &mut Vec<Command>),
    /// What its header says besides.
    pub title: ViewTitle,
    /// The controls in its header, laid out from right to left.
    pub tools: fn(&mut Ui, &State, &Palette, &mut Vec<Command>),
    /// The width that they need \[pt\]; the title takes what is left. A view without has no header.
    pub tools_width: f32,
    /// What has to be computed for it beside the live answer.
    pub needs: fn(&State) -> Vec<Need>,
    /// Whether it shows results of every condition: it is said where those are of older settings.
    pub is_of_all_conditions: bool,
    /// Whether it stands in the second group of tabs at first.
    pub is_lower: bool,
    /// What it is on paper. Variants are tables, which are saved as such; of records what is identified is saved.
    pub figure: Option<FigureKind>,
}

impl ViewKind {
    fn new(
        name: &'static str,
        purpose: &'static str,
        draw: fn(&mut Ui, &mut State, &Palette, &mut Vec<Command>),
    ) -> Self {
        Self {
            name,
            purpose,
            draw,
            title: ViewTitle::None,
            tools: |_, _, _, _| {},
            tools_width: 0.0,
            needs: |_| Vec::new(),
            is_of_all_conditions: false,
            is_lower: false,
            figure: None,
        }
    }
}

/// What the header of a view says of what is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewTitle {
    /// Nothing.
    None,
    /// The condition.
    Condition,
    /// The response in focus, and the condition.
    Response,
}

/// What a view has to have computed beside the live answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// Modes of the models of the condition.
    Modes(ModesJob),
    /// An assessment.
    Assessment(AssessmentJob),
    /// One model of each condition.
    Across(AcrossJob),
    /// The analysis of a variant.
    Variant(VariantJob),
    /// A model against a record in time.
    Simulation(SimulationJob),
}

/// Brings every curve back into view; the button has this accessible name.
fn fit_ui(ui: &mut Ui, name: &str, commands: &mut Vec<Command>) {
    let fit = ui.add(Button::new("Fit").small());
    let enabled = ui.is_enabled();
    fit.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    if fit.on_hover_text("Bring every curve into view (F, or double click)").clicked() {
        commands.push(Command::FitPlots);
    }
}

/// Ready arrangements of the views.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// The plots of one condition above, what changes with airspeed below.
    Stacked,
    /// The same two groups side by side.
    SideBySide,
    /// One group of tabs.
    Single,
}

impl Preset {
    /// Every preset, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Stacked, Self::SideBySide, Self::Single];

    /// What its menu entry says.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stacked => "Plots above one another",
            Self::SideBySide => "Plots side by side",
            Self::Single => "One plot at a time",
        }
    }
}

/// How the views share the middle of the window: tabs that can be dragged, split and resized.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arrangement {
    /// The tiles.
    pub(super) tree: Tree<View>,
}

impl Default for Arrangement {
    fn default() -> Self {
        Self::of(Preset::Stacked)
    }
}

/// Part of the room that the first group gets.
const UPPER_PART: f32 = 0.66;

impl Arrangement {
    /// A ready arrangement.
    pub fn of(preset: Preset) -> Self {
        let mut tiles = Tiles::default();
        let (upper, lower): (Vec<View>, Vec<View>) = View::ALL.into_iter().partition(|view| !view.kind().is_lower);
        let root = match preset {
            Preset::Single => tabs(&mut tiles, upper.into_iter().chain(lower)),
            Preset::Stacked | Preset::SideBySide => {
                let groups = [tabs(&mut tiles, upper), tabs(&mut tiles, lower)];
                let (direction, part) = match preset {
                    Preset::SideBySide => (LinearDir::Horizontal, 0.5),
                    _ => (LinearDir::Vertical, UPPER_PART),
                };
                tiles.insert_container(Linear::new_binary(direction, groups, part))
            }
        };
        Self { tree: Tree::new(Id::unique("views"), root, tiles) }
    }

    /// Brings a view to the front of its tabs.
    pub fn show(&mut self, view: View) {
        self.tree.make_active(|_, tile| matches!(tile, Tile::Pane(pane) if *pane == view));
    }

    /// Whether a view can be seen.
    pub fn is_shown(&self, view: View) -> bool {
        self.tree.active_tiles().into_iter().any(|tile| self.tree.tiles.get_pane(&tile) == Some(&view))
    }

    /// Gives a view a place of its own beside everything else, in the given direction.
    pub fn split_off(&mut self, view: View, direction: LinearDir) {
        let (Some(root), Some(tile)) = (self.tree.root(), self.tree.tiles.find_pane(&view)) else { return };
        let parent = self.tree.tiles.parent_of(tile);
        let siblings =
            parent.and_then(|parent| self.tree.tiles.get_container(parent)).map_or(0, Container::num_children);
        if siblings < 2 {
            return;
        }
        if let Some(Tile::Container(container)) = parent.and_then(|parent| self.tree.tiles.get_mut(parent)) {
            container.remove_child(tile);
        }
        let group = self.tree.tiles.insert_tab_tile(vec![tile]);
        let whole = self.tree.tiles.insert_container(Linear::new_binary(direction, [root, group], 0.5));
        self.tree.root = Some(whole);
    }

    /// This arrangement, kept from another day, where it holds every view once.
    pub fn if_whole(self) -> Option<Self> {
        let reachable = reachable(&self.tree)?;
        let once = |view: &View| reachable.iter().filter(|found| *found == view).count() == 1;
        (reachable.len() == View::ALL.len() && View::ALL.iter().all(once)).then_some(self)
    }
}

fn tabs(tiles: &mut Tiles<View>, views: impl IntoIterator<Item = View>) -> TileId {
    let panes = views.into_iter().map(|view| tiles.insert_pane(view)).collect();
    tiles.insert_tab_tile(panes)
}

/// The views below the root; nothing where a tile is missing, or stands below itself.
fn reachable(tree: &Tree<View>) -> Option<Vec<View>> {
    let mut views = Vec::new();
    let mut open = vec![tree.root()?];
    let mut visited = 0;
    while let Some(tile) = open.pop() {
        visited += 1;
        if visited > tree.tiles.len() {
            return None;
        }
        match tree.tiles.get(tile)? {
            Tile::Pane(view) => views.push(*view),
            Tile::Container(container) => open.extend(container.children()),
        }
    }
    Some(views)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(arrangement: &Arrangement) -> Arrangement {
        let text = serde_json::to_string(arrangement).unwrap();
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn every_preset_holds_every_view_once_and_can_be_kept() {
        for preset in Preset::ALL {
            let arrangement = Arrangement::of(preset);
            assert_eq!(kept(&arrangement).if_whole(), Some(arrangement), "{preset:?}");
        }
    }

    #[test]
    fn an_arrangement_that_lacks_a_view_is_not_whole() {
        let mut tiles = Tiles::default();
        let root = tabs(&mut tiles, [View::Bode, View::Overview]);
        let tree = Tree::new(Id::unique("views"), root, tiles);
        assert_eq!(Arrangement { tree }.if_whole(), None);
        assert_eq!(Arrangement { tree: Tree::empty(Id::unique("views")) }.if_whole(), None);
    }

    #[test]
    fn a_view_that_is_shown_is_in_front() {
        let mut arrangement = Arrangement::default();
        assert!(arrangement.is_shown(View::Bode) && !arrangement.is_shown(View::Channels));
        arrangement.show(View::Channels);
        assert!(!arrangement.is_shown(View::Bode) && arrangement.is_shown(View::Channels));
        assert!(arrangement.is_shown(View::NetGain), "the other group is as it was");
    }

    #[test]
    fn a_view_that_is_split_off_stands_beside_the_rest() {
        let mut arrangement = Arrangement::of(Preset::Single);
        arrangement.split_off(View::Channels, LinearDir::Horizontal);
        assert!(arrangement.is_shown(View::Bode) && arrangement.is_shown(View::Channels));
        assert_eq!(arrangement.clone().if_whole(), Some(arrangement.clone()), "no view is lost");
        let before = arrangement.clone();
        arrangement.split_off(View::Channels, LinearDir::Vertical);
        assert_eq!(arrangement, before, "it stands alone already");
    }
}
