//! Display options of the view of physics parameters.

use crate::gui::plot::FigureView;

/// Page of the view in a window that cannot show everything at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhysicsPage {
    /// Every parameter: change, interval, share explained.
    #[default]
    Ranking,
    /// What cannot be told apart.
    Correlation,
    /// The selected parameter in each condition, and the misfit that remains.
    Conditions,
    /// Responses and poles of the condition before and after the parameters.
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

/// Display options of the view of physics parameters.
#[derive(Clone, Debug, Default)]
pub struct PhysicsDisplay {
    /// Name of the selected parameter; `None` selects the first of the ranking.
    pub selected: Option<String>,
    pub page: PhysicsPage,
    /// Responses and poles before and after, as last drawn.
    pub change: FigureView,
    /// Whether the view, as last drawn, had room for everything at once.
    pub shows_everything: bool,
}
