//! How the views share the middle of the window.

use egui::Id;
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

pub use super::views::{Need, View, ViewKind, ViewTitle};

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
