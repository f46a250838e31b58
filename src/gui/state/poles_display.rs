//! Display of poles, zeros and modes.

use super::modes_cache::CachedModes;
use crate::gui::widgets::tables::Sorting;

/// Content of the view of the poles.
#[derive(Debug, Default)]
pub struct PolesDisplay {
    /// Whether the zeros of the response in focus are shown among the poles.
    pub show_zeros: bool,
    /// Modes and zeros, cached between frames.
    pub modes: CachedModes,
    pub modes_sorting: Sorting,
}
