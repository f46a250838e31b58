//! Arrangement of the views between the side panels: the view in front from each group, a second
//! view beside it, and the dock below.

use serde::{Deserialize, Serialize};

use super::view::{View, ViewGroup};

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Arrangement {
    /// Group in front.
    group: ViewGroup,
    /// View shown by each group, indexed by `ViewGroup as usize`. The name of this field is part of
    /// the preferences file.
    of_groups: [View; 4],
    /// View beside the view in front.
    beside: Option<View>,
    /// View in the dock.
    dock: View,
    /// Whether the dock is unfolded; `None` follows the window height.
    dock_open: Option<bool>,
    /// Whether the dock has twice its usual height.
    is_dock_enlarged: bool,
}

/// Views that the groups show first, indexed by `ViewGroup as usize`.
const FIRST_VIEWS: [View; 4] = [View::Bode, View::Poles, View::Channels, View::Assessment];

impl Default for Arrangement {
    fn default() -> Self {
        Self {
            group: ViewGroup::Response,
            of_groups: FIRST_VIEWS,
            beside: None,
            dock: View::NetGain,
            dock_open: None,
            is_dock_enlarged: false,
        }
    }
}

impl Arrangement {
    pub fn group(&self) -> ViewGroup {
        self.group
    }

    pub fn view(&self) -> View {
        self.of_groups[self.group as usize]
    }

    pub fn beside(&self) -> Option<View> {
        self.beside.filter(|beside| *beside != self.view())
    }

    /// Returns the page in the dock; `None` if the view in front takes its space.
    pub fn dock(&self) -> Option<View> {
        if self.view().facts().takes_dock {
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

    pub fn is_dock_enlarged(&self) -> bool {
        self.is_dock_enlarged
    }

    /// Doubles the dock's height and unfolds it, or restores its usual height.
    pub fn enlarge_dock(&mut self, is_enlarged: bool) {
        self.is_dock_enlarged = is_enlarged;
        if is_enlarged {
            self.dock_open = Some(true);
        }
    }

    /// Brings a group to the front, with the view that it showed last.
    pub fn show_group(&mut self, group: ViewGroup) {
        self.group = group;
    }

    /// Brings a view and its group to the front; the view is then no longer shown beside. A dock
    /// page is shown in the dock.
    pub fn show(&mut self, view: View) {
        let Some(group) = view.facts().group else {
            self.dock_view(view);
            return;
        };
        self.group = group;
        self.of_groups[group as usize] = view;
        if self.beside == Some(view) {
            self.beside = None;
        }
    }

    /// Shows a page in the dock, and unfolds the dock. If the view in front takes its space, the
    /// Bode view comes to the front.
    pub fn dock_view(&mut self, view: View) {
        self.dock = view;
        self.dock_open = Some(true);
        if self.view().facts().takes_dock {
            self.show(View::Bode);
        }
    }

    /// Shows a view beside the view in front; with `None`, or with the view in front itself, shows
    /// none. A dock page is shown in the dock.
    pub fn show_beside(&mut self, view: Option<View>) {
        match view {
            Some(page) if page.is_dock_page() => self.dock_view(page),
            Some(view) if view == self.view() => self.beside = None,
            _ => self.beside = view,
        }
    }

    /// Returns the view `steps` places further in the group in front, wrapping around.
    pub fn neighbour(&self, steps: isize) -> View {
        let views: Vec<View> = self.group.views().collect();
        let here = views
            .iter()
            .position(|view| *view == self.view())
            .unwrap_or(0);
        views[(here as isize + steps).rem_euclid(views.len() as isize) as usize]
    }

    /// Returns whether a view is in front, beside the view in front, or in the dock, whether or not
    /// the dock is unfolded.
    pub fn is_shown(&self, view: View) -> bool {
        self.view() == view || self.beside() == Some(view) || self.dock() == Some(view)
    }

    /// Adapts a stored arrangement, which an older version of the program may have written:
    ///
    /// 1. a view beside that is now a dock page is shown in the dock;
    /// 2. a group that shows what is now a dock page shows its first view; if it was in front, the
    ///    dock shows the page, and the first group comes to the front;
    /// 3. a group that shows a view that is now in another group makes the arrangement unusable:
    ///    `None`;
    /// 4. a dock that shows no dock page shows the net gain.
    pub fn adapted(mut self) -> Option<Self> {
        // Step 1.
        if let Some(page) = self.beside
            && page.is_dock_page()
        {
            self.beside = None;
            self.dock = page;
        }
        for group in ViewGroup::ALL {
            let index = group as usize;
            let view = self.of_groups[index];
            // Step 2.
            if view.is_dock_page() {
                self.of_groups[index] = FIRST_VIEWS[index];
                if self.group == group {
                    self.dock = view;
                    self.group = ViewGroup::Response;
                }
            } else if view.facts().group != Some(group) {
                // Step 3.
                return None;
            }
        }
        // Step 4.
        if !self.dock.is_dock_page() {
            self.dock = View::NetGain;
        }
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use gdcm_study::PhaseCorrection;

    use super::*;

    #[test]
    fn every_view_belongs_to_a_group_or_to_the_dock() {
        let views: Vec<View> = ViewGroup::ALL
            .into_iter()
            .flat_map(ViewGroup::views)
            .collect();
        let pages = View::docked(PhaseCorrection::Lead);
        assert_eq!(views.len() + pages.count(), View::ALL.len());
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
        arrangement.show(View::Leads);
        assert_eq!(
            (arrangement.view(), arrangement.dock()),
            (View::Bode, Some(View::Leads))
        );
        arrangement.show_beside(Some(View::NetGain));
        assert_eq!(
            (arrangement.dock(), arrangement.beside()),
            (Some(View::NetGain), None)
        );
        arrangement.show_beside(Some(View::Poles));
        arrangement.show(View::Poles);
        assert_eq!(arrangement.beside(), None);
        arrangement.show(View::Records);
        assert_eq!(arrangement.dock(), None, "it takes the room of the dock");
        arrangement.show(View::Channels);
        assert_eq!(arrangement.dock(), None, "its plots contain the net gains");
        arrangement.show(View::NetGain);
        assert_eq!(
            (arrangement.view(), arrangement.dock()),
            (View::Bode, Some(View::NetGain))
        );
    }

    #[test]
    fn an_enlarged_dock_is_unfolded() {
        let mut arrangement = Arrangement::default();
        arrangement.open_dock(false);
        arrangement.enlarge_dock(true);
        assert!(arrangement.is_dock_enlarged() && arrangement.is_dock_open(false));
        arrangement.enlarge_dock(false);
        assert!(!arrangement.is_dock_enlarged() && arrangement.is_dock_open(false));
    }

    #[test]
    fn an_arrangement_of_an_older_version_shows_its_views_in_the_dock() {
        let text = r#"{"group": "Schedule", "of_groups": ["Bode", "Records", "Leads", "Compare"],
            "beside": "NetGain", "dock": "NetGain", "dock_open": false}"#;
        let stored: Arrangement = serde_json::from_str(text).unwrap();
        let read = stored.adapted().expect("each view has its place");
        assert_eq!((read.view(), read.beside()), (View::Bode, None));
        assert_eq!(read.dock(), Some(View::Leads));
        let text = r#"{"group": "Judge", "of_groups": ["Error", "Poles", "NetGain", "Compare"]}"#;
        let stored: Arrangement = serde_json::from_str(text).unwrap();
        let mut read = stored.adapted().expect("each view has its place");
        assert_eq!(read.view(), View::Compare);
        read.show_group(ViewGroup::Schedule);
        assert_eq!(read.view(), View::Channels);
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
                .adapted(),
            Some(arrangement)
        );
        let mixed = Arrangement {
            of_groups: [View::Poles; 4],
            ..Arrangement::default()
        };
        assert_eq!(mixed.adapted(), None);
    }
}
