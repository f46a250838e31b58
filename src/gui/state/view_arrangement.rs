//! Arrangement of the views between the side panels: the view in front of its group, a second view
//! beside it, and the dock below.

use serde::{Deserialize, Serialize};

use super::view::{View, ViewGroup};

/// Arrangement of the views between the side panels.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Arrangement {
    /// Group in front.
    group: ViewGroup,
    /// View shown by each group, indexed by `ViewGroup as usize`. The name is part of the stored
    /// preferences.
    of_groups: [View; 4],
    /// View beside the view in front.
    beside: Option<View>,
    /// View in the dock.
    dock: View,
    /// Whether the dock is unfolded; `None` follows the window height.
    dock_open: Option<bool>,
}

impl Default for Arrangement {
    fn default() -> Self {
        Self {
            group: ViewGroup::Response,
            of_groups: [View::Bode, View::Poles, View::Channels, View::Assessment],
            beside: None,
            dock: View::NetGain,
            dock_open: None,
        }
    }
}

impl Arrangement {
    /// Returns the group in front.
    pub fn group(&self) -> ViewGroup {
        self.group
    }

    /// Returns the view in front.
    pub fn view(&self) -> View {
        self.of_groups[self.group as usize]
    }

    /// Returns the view beside the view in front.
    pub fn beside(&self) -> Option<View> {
        self.beside.filter(|beside| *beside != self.view())
    }

    /// Returns the view in the dock; `None` if the view in front takes the space of the dock, or if
    /// the docked view is shown above.
    pub fn dock(&self) -> Option<View> {
        let is_shown_above = self.view() == self.dock || self.beside() == Some(self.dock);
        if self.view().facts().takes_dock || is_shown_above {
            return None;
        }
        Some(self.dock)
    }

    /// Returns whether the dock is unfolded, given whether the window has room for it.
    pub fn is_dock_open(&self, has_room: bool) -> bool {
        self.dock_open.unwrap_or(has_room)
    }

    /// Folds or unfolds the dock, whatever the window height.
    pub fn open_dock(&mut self, is_open: bool) {
        self.dock_open = Some(is_open);
    }

    /// Brings a group to the front, with the view that it showed last.
    pub fn show_group(&mut self, group: ViewGroup) {
        self.group = group;
    }

    /// Brings a view and its group to the front; the view is then no longer shown beside.
    pub fn show(&mut self, view: View) {
        let group = view.facts().group;
        self.group = group;
        self.of_groups[group as usize] = view;
        if self.beside == Some(view) {
            self.beside = None;
        }
    }

    /// Shows a view in the dock, and unfolds the dock.
    pub fn dock_view(&mut self, view: View) {
        self.dock = view;
        self.dock_open = Some(true);
    }

    /// Shows a view beside the view in front; with `None`, or with the view in front itself, shows
    /// none.
    pub fn show_beside(&mut self, view: Option<View>) {
        self.beside = view.filter(|view| *view != self.view());
    }

    /// Returns the view `by` places further in the group in front, wrapping around.
    pub fn neighbour(&self, by: isize) -> View {
        let views: Vec<View> = self.group.views().collect();
        let here = views
            .iter()
            .position(|view| *view == self.view())
            .unwrap_or(0);
        views[(here as isize + by).rem_euclid(views.len() as isize) as usize]
    }

    /// Returns whether a view is visible: in front, beside, or in the dock.
    pub fn is_shown(&self, view: View) -> bool {
        self.view() == view || self.beside() == Some(view) || self.dock() == Some(view)
    }

    /// Returns this stored arrangement; `None` unless every group shows one of its own views, which
    /// may have changed between versions.
    pub fn if_valid(self) -> Option<Self> {
        for group in ViewGroup::ALL {
            if self.of_groups[group as usize].facts().group != group {
                return None;
            }
        }
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_belongs_to_one_group_and_every_group_has_views() {
        let views: Vec<View> = ViewGroup::ALL
            .into_iter()
            .flat_map(ViewGroup::views)
            .collect();
        assert_eq!(views.len(), View::ALL.len());
        assert!(
            ViewGroup::ALL
                .into_iter()
                .all(|group| group.views().count() > 1)
        );
    }

    #[test]
    fn a_group_remembers_its_view() {
        let mut arrangement = Arrangement::default();
        arrangement.show(View::Overview);
        arrangement.show_group(ViewGroup::Judge);
        assert_eq!(arrangement.view(), View::Assessment);
        arrangement.show_group(ViewGroup::Response);
        assert_eq!(arrangement.view(), View::Overview);
        assert_eq!(
            (arrangement.neighbour(1), arrangement.neighbour(-1)),
            (View::Across, View::Error)
        );
    }

    #[test]
    fn a_view_is_never_shown_twice() {
        let mut arrangement = Arrangement::default();
        assert_eq!(arrangement.dock(), Some(View::NetGain));
        arrangement.show(View::NetGain);
        assert_eq!(arrangement.dock(), None);
        arrangement.show(View::Bode);
        arrangement.show_beside(Some(View::NetGain));
        assert_eq!(
            (arrangement.dock(), arrangement.beside()),
            (None, Some(View::NetGain))
        );
        arrangement.show_beside(Some(View::Poles));
        arrangement.show(View::Poles);
        assert_eq!(arrangement.beside(), None);
        arrangement.show(View::Records);
        assert_eq!(arrangement.dock(), None, "it takes the room of the dock");
    }

    #[test]
    fn a_stored_arrangement_is_restored_unless_it_mixes_the_groups_up() {
        let mut arrangement = Arrangement::default();
        arrangement.show(View::Evidence);
        arrangement.show_beside(Some(View::Bode));
        let text = serde_json::to_string(&arrangement).unwrap();
        assert_eq!(
            serde_json::from_str::<Arrangement>(&text)
                .unwrap()
                .if_valid(),
            Some(arrangement)
        );
        let mixed = Arrangement {
            of_groups: [View::Poles; 4],
            ..Arrangement::default()
        };
        assert_eq!(mixed.if_valid(), None);
    }
}
