//! Display options for poles, zeros and modes.

use super::modes_cache::CachedModes;
use crate::gui::widgets::tables::Sorting;

/// Options for displaying poles.
#[derive(Debug, Default)]
pub struct PolesDisplay {
    /// Whether the focused response's zeros are shown among the poles.
    pub show_zeros: bool,
    /// Modes and zeros, cached between frames.
    pub modes: CachedModes,
    pub modes_sorting: Sorting,
}
