//! Options for displaying the physics parameters.

use crate::gui::plot::FigureView;

/// Page shown in a window that has no room for the whole view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhysicsPage {
    /// Every parameter: change, interval, share explained.
    #[default]
    Ranking,
    /// Parameters that cannot be told apart.
    Correlation,
    /// The selected parameter in each condition, and the misfit that remains.
    Conditions,
    /// The condition's responses and poles before and after the parameters.
    Change,
}

impl PhysicsPage {
    /// All pages, in display order.
    pub const ALL: [Self; 4] = [
        Self::Ranking,
        Self::Correlation,
        Self::Conditions,
        Self::Change,
    ];
}

#[derive(Clone, Debug, Default)]
pub struct PhysicsDisplay {
    /// Name of the selected parameter; `None` selects the first in the ranking.
    pub selected: Option<String>,
    pub page: PhysicsPage,
    /// Responses and poles before and after, as last drawn.
    pub change: FigureView,
    /// Whether the view, as last drawn, had room for everything at once.
    pub shows_everything: bool,
}
